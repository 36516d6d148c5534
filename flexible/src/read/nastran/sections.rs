//! The sections of a deck: executive and case control are skipped, except for the entries that select
//! supports and equations; a deck of cards alone has none of them.

use super::card::{Card, cut};
use super::continuation::Assembler;
use super::lines::{At, Line, Lines, whole};
use crate::error::FileProblem;
use crate::read::Files;

/// Lines before the first card.
const LONGEST_HEAD: usize = 100_000;

/// The entries of case control that select parts of the mesh.
#[derive(Debug, Default)]
pub(super) struct CaseControl {
    /// The set of supports it selects first.
    pub spc: Option<(u64, At)>,
    /// The set of equations it selects first.
    pub mpc: Option<(u64, At)>,
}

/// Reads a deck and hands over its cards, those with scattered continuations last.
pub(super) fn read_cards(
    files: &dyn Files,
    name: &str,
    mut give: impl FnMut(Card) -> Result<(), FileProblem>,
) -> Result<CaseControl, FileProblem> {
    let mut lines = Lines::open(files, name)?;
    let mut case = CaseControl::default();
    let mut cards = Assembler::default();
    let mut head = Some(Head::default());
    while let Some(line) = lines.next_line()? {
        let word = first_word(&line.text);
        if word == "ENDDATA" {
            if lines.end_file() {
                continue;
            }
            break;
        }
        let Some(before) = &mut head else {
            if word == "BEGIN" {
                return Err(line.at.problem(
                    format!("\"{}\" begins a second part of the deck", line.text.trim()),
                    "put each superelement into its own deck; one whole deck can be included before the other cards",
                ));
            }
            for card in cards.push(&line)? {
                give(card)?;
            }
            continue;
        };
        let begins = word == "BEGIN";
        if !begins && !is_card(&word, &line.text) {
            before.control |= CONTROL.contains(&word.as_str());
            if before.lines.len() >= LONGEST_HEAD {
                return Err(line.at.problem(
                    format!("the first {LONGEST_HEAD} lines contain no card of bulk data"),
                    "give a deck of Nastran bulk data",
                ));
            }
            before.lines.push(line);
            continue;
        }
        for earlier in head
            .take()
            .into_iter()
            .flat_map(|head| head.cards(begins, &mut case))
        {
            for card in cards.push(&earlier)? {
                give(card)?;
            }
        }
        if !begins {
            for card in cards.push(&line)? {
                give(card)?;
            }
        }
    }
    if let Some(before) = head {
        if before.control {
            return Err(whole(
                name,
                "the deck has no BEGIN BULK",
                "write the bulk data between BEGIN BULK and ENDDATA; the file may have been cut",
            ));
        }
        for earlier in before.cards(false, &mut case) {
            for card in cards.push(&earlier)? {
                give(card)?;
            }
        }
    }
    for card in cards.finish()? {
        give(card)?;
    }
    Ok(case)
}

/// Lines before it is known whether the deck begins with control sections.
#[derive(Default)]
struct Head {
    lines: Vec<Line>,
    control: bool,
}

impl Head {
    /// The lines of these that are cards: all of them in a deck without control sections, `PARAM` alone in
    /// others.
    fn cards(self, begins: bool, case: &mut CaseControl) -> Vec<Line> {
        if !begins && !self.control {
            return self.lines;
        }
        self.lines
            .into_iter()
            .filter(|line| {
                select(&line.text, "SPC", &mut case.spc, &line.at);
                select(&line.text, "MPC", &mut case.mpc, &line.at);
                first_word(&line.text) == "PARAM" && !line.text.contains('=')
            })
            .collect()
    }
}

/// Reads `SPC = 3`; the first selection holds.
fn select(text: &str, name: &str, selected: &mut Option<(u64, At)>, at: &At) {
    let text = text.trim().to_ascii_uppercase();
    let number = text
        .strip_prefix(name)
        .and_then(|rest| rest.trim_start().strip_prefix('='))
        .and_then(|number| number.trim().parse::<u64>().ok());
    if let Some(number) = number
        && selected.is_none()
    {
        *selected = Some((number, at.clone()));
    }
}

/// The first word of a line, in upper case, up to a comma, bracket or asterisk.
fn first_word(text: &str) -> String {
    text.trim_start()
        .split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
        .next()
        .unwrap_or("")
        .to_ascii_uppercase()
}

/// Words of the executive and file management sections.
const CONTROL: [&str; 12] = [
    "CEND", "SOL", "NASTRAN", "ASSIGN", "INIT", "TIME", "DIAG", "APP", "ID", "SUBCASE", "TITLE",
    "ECHO",
];

/// Cards that occur in no control section.
const CARDS: [&str; 44] = [
    "GRID", "GRDSET", "SPOINT", "CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S",
    "CTETRA", "CHEXA", "CPENTA", "CPYRAM", "CPYRA", "CBAR", "CBEAM", "CONROD", "CROD", "CTUBE",
    "CQUAD4", "CQUAD8", "CQUADR", "CTRIA3", "CTRIA6", "CTRIAR", "CELAS1", "CELAS2", "CONM1",
    "CONM2", "RBE2", "RBE3", "RBAR", "SPC1", "ASET1", "ASET", "MAT1", "PSOLID", "PSHELL", "PBAR",
    "PBARL", "PBEAM", "PBEAML", "EIGRL", "CBUSH",
];

/// Whether a line certainly is a card.
fn is_card(word: &str, text: &str) -> bool {
    CARDS.contains(&word)
        && !text.contains('=')
        && cut(&Line {
            text: text.to_string(),
            at: At {
                file: "".into(),
                line: 0,
            },
            order: 0,
        })
        .is_ok_and(|piece| piece.head.trim_end_matches('*').trim_end() == word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cards_and_control_lines_are_distinguished() {
        assert!(is_card("GRID", "GRID*   1"));
        assert!(is_card("GRID", "grid,1,,0.,0.,0."));
        assert!(!is_card("SPC", "SPC = 3"));
        assert!(!is_card("PARAM", "PARAM,POST,-1"));
        assert_eq!(first_word("spc(2)=3"), "SPC");
        assert_eq!(first_word("  disp(plot) = all"), "DISP");
    }
}
