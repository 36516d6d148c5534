//! The sections of a deck: executive and case control are skipped, except for the entries that select
//! supports, equations, added mass, glue, contact and the temperature of the materials; a deck of cards alone has none of them. Of
//! several subcases those with a `METHOD` count, which are the ones of the modes, else all.

use super::card::{Card, cut};
use super::continuation::Assembler;
use super::lines::{At, Line, Lines, whole};
use super::weight::WeightTable;
use crate::error::FileProblem;
use crate::read::Files;

/// Most lines before the first card. A choice: a file without a card after as many is no deck.
const LONGEST_HEAD: usize = 100_000;

/// The entries of case control that select parts of the mesh.
#[derive(Debug, Default)]
pub(super) struct CaseControl {
    /// Its supports.
    pub spc: Selection,
    /// Its equations.
    pub mpc: Selection,
    /// Its sets of added mass. Unlike those of supports, they need an entry: a deck with case control and without one
    /// has `Nothing`.
    pub nsm: Selection,
    /// Its sets of glue, which need an entry, too.
    pub bgset: Selection,
    /// Its tables of contact, which need an entry, too.
    pub bcontact: Selection,
    /// Where it lets all bodies touch each other.
    pub all_contact: Option<At>,
    /// Whether the deck has case control at all.
    pub stated: bool,
    /// Whether it gives the materials a temperature.
    pub temperature: bool,
    /// Whether it asks for modes.
    pub modes: bool,
    /// The note about subcases with different supports.
    pub doubt: Option<String>,
    /// The weight check in the comments of the deck.
    pub weight: WeightTable,
}

/// The sets that case control selects.
#[derive(Clone, Debug, Default)]
pub(super) enum Selection {
    /// All: no entry selects any.
    #[default]
    All,
    /// None: only other subcases select some.
    Nothing,
    /// One, with the place of the entry.
    One(u64, At),
}

/// The entries of one subcase, or of all of them.
#[derive(Clone, Debug, Default)]
struct Case {
    /// `subcase 2`.
    name: String,
    spc: Option<(u64, At)>,
    mpc: Option<(u64, At)>,
    nsm: Option<(u64, At)>,
    bgset: Option<(u64, At)>,
    bcontact: Option<(u64, At)>,
    all_contact: Option<At>,
    /// Whether it selects a method for modes.
    method: bool,
}

impl Case {
    /// Keeps the entry of a line; in one case the last entry of a name holds.
    fn entry(&mut self, text: &str, at: &At) {
        if let Some(number) = selected(text, "SPC") {
            self.spc = Some((number, at.clone()));
        } else if let Some(number) = selected(text, "MPC") {
            self.mpc = Some((number, at.clone()));
        } else if let Some(number) = selected(text, "NSM") {
            self.nsm = Some((number, at.clone()));
        } else if let Some(number) = selected(text, "BGSET") {
            self.bgset = Some((number, at.clone()));
        } else if let Some(number) = selected(text, "BCONTACT") {
            self.bcontact = Some((number, at.clone()));
        } else if first_word(text) == "BCONTACT" && text.to_ascii_uppercase().contains("ALL") {
            self.all_contact = Some(at.clone());
        } else {
            self.method |= text.contains('=') && first_word(text) == "METHOD";
        }
    }
}

/// The entries above all subcases, and the subcases.
#[derive(Debug, Default)]
struct Cases {
    above: Case,
    subcases: Vec<Case>,
    /// Whether the deck has control sections at all.
    controlled: bool,
    temperature: bool,
}

impl Cases {
    fn line(&mut self, line: &Line) {
        self.controlled = true;
        self.temperature |= heats_materials(&line.text);
        if first_word(&line.text) == "SUBCASE" {
            self.subcases.push(Case {
                name: line.text.trim().to_ascii_lowercase(),
                ..self.above.clone()
            });
        } else {
            let case = self.subcases.last_mut();
            case.unwrap_or(&mut self.above).entry(&line.text, &line.at);
        }
    }

    /// The selection that holds for the modes.
    ///
    /// # Errors
    /// Subcases of modes with different equations, added mass, glue or contact.
    fn selection(mut self) -> Result<CaseControl, FileProblem> {
        if self.subcases.is_empty() {
            self.subcases.push(self.above);
        }
        let some = [
            self.subcases.iter().any(|case| case.spc.is_some()),
            self.subcases.iter().any(|case| case.mpc.is_some()),
        ];
        let modes = self.subcases.iter().any(|case| case.method);
        if modes {
            self.subcases.retain(|case| case.method);
        }
        let number = |set: &Option<(u64, At)>| set.as_ref().map(|(number, _)| *number);
        let Some(first) = self.subcases.first() else {
            return Ok(CaseControl::default());
        };
        let words = |name: &str, set: &Option<(u64, At)>, case: &Case| match set {
            Some((number, at)) => {
                format!("{} selects {name} = {number} (line {})", case.name, at.line)
            }
            None => format!("{} selects no {name}", case.name),
        };
        let mut doubt = None;
        for case in &self.subcases {
            for (title, name, here, before) in [
                ("equations", "MPC", &case.mpc, &first.mpc),
                ("sets of added mass", "NSM", &case.nsm, &first.nsm),
                ("sets of glue", "BGSET", &case.bgset, &first.bgset),
                (
                    "tables of contact",
                    "BCONTACT",
                    &case.bcontact,
                    &first.bcontact,
                ),
            ] {
                if number(here) != number(before)
                    && let Some((_, at)) = here.as_ref().or(before.as_ref())
                {
                    return Err(at.problem(
                        format!(
                            "the {title} differ: {}, {}",
                            words(name, before, first),
                            words(name, here, case)
                        ),
                        "keep METHOD in the subcase of the wanted modes alone, or leave out the other subcases",
                    ));
                }
            }
            if doubt.is_none()
                && number(&case.spc) != number(&first.spc)
                && let Some((_, at)) = case.spc.as_ref().or(first.spc.as_ref())
            {
                doubt = Some(format!(
                    "{}:{}: the supports differ: {}, {}; the first ones are read. Keep METHOD in the subcase of the wanted modes alone, or leave out the other subcases",
                    at.file,
                    at.line,
                    words("SPC", &first.spc, first),
                    words("SPC", &case.spc, case)
                ));
            }
        }
        let all_contact = self
            .subcases
            .iter()
            .find_map(|case| case.all_contact.clone());
        let [spc, mpc, nsm, bgset, bcontact] = [
            (&first.spc, some[0]),
            (&first.mpc, some[1]),
            (&first.nsm, self.controlled),
            (&first.bgset, self.controlled),
            (&first.bcontact, self.controlled),
        ]
        .map(|(set, some)| match set {
            Some((number, at)) => Selection::One(*number, at.clone()),
            None if some => Selection::Nothing,
            None => Selection::All,
        });
        Ok(CaseControl {
            spc,
            mpc,
            nsm,
            bgset,
            bcontact,
            all_contact,
            stated: self.controlled,
            temperature: self.temperature,
            modes,
            doubt,
            weight: WeightTable::default(),
        })
    }
}

/// Reads a deck and hands over its cards, those with scattered continuations last.
pub(super) fn read_cards(
    files: &dyn Files,
    name: &str,
    mut give: impl FnMut(Card) -> Result<(), FileProblem>,
) -> Result<CaseControl, FileProblem> {
    let mut lines = Lines::open(files, name)?;
    let mut cases = Cases::default();
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
            .flat_map(|head| head.cards(begins, &mut cases))
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
        for earlier in before.cards(false, &mut cases) {
            for card in cards.push(&earlier)? {
                give(card)?;
            }
        }
    }
    for card in cards.finish()? {
        give(card)?;
    }
    Ok(CaseControl {
        weight: lines.weight,
        ..cases.selection()?
    })
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
    fn cards(self, begins: bool, cases: &mut Cases) -> Vec<Line> {
        if !begins && !self.control {
            return self.lines;
        }
        self.lines
            .into_iter()
            .filter(|line| {
                cases.line(line);
                first_word(&line.text) == "PARAM" && !line.text.contains('=')
            })
            .collect()
    }
}

/// The number in `SPC = 3`.
fn selected(text: &str, name: &str) -> Option<u64> {
    let text = text.trim().to_ascii_uppercase();
    text.strip_prefix(name)
        .and_then(|rest| rest.trim_start().strip_prefix('='))
        .and_then(|number| number.trim().parse::<u64>().ok())
}

/// Whether an entry of case control gives the materials a temperature: `TEMPERATURE(MATERIAL)`, `(INITIAL)` or
/// `(BOTH)`, or without a describer, which means `BOTH`. Without such an entry `MATTi` are not used (MSC Nastran, Quick
/// Reference Guide, TEMPERATURE, remark 6).
pub fn heats_materials(text: &str) -> bool {
    let text = text.trim().to_ascii_uppercase();
    let Some((head, _)) = text.split_once('=') else {
        return false;
    };
    let (name, describers) = head.split_once('(').unwrap_or((head, ""));
    let name = name.trim();
    name.len() >= 4
        && "TEMPERATURE".starts_with(name)
        && !describers.trim_start().starts_with("LOAD")
}

/// The first word of a line, in upper case, up to a comma, bracket or asterisk.
pub fn first_word(text: &str) -> String {
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
pub fn is_card(word: &str, text: &str) -> bool {
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
