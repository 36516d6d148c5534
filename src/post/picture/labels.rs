//! Words of figures: letters of journals, names of axes, and quantities.

use crate::machine::JournalGeometry;
use crate::results::Results;
use eng_report::figure::journal_letter;

/// A text that begins with a capital.
pub(crate) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Letters of the journals, as in a paper, each with the axes of its forces.
pub(super) fn letters(results: &Results, journals: &[JournalGeometry]) -> Vec<(String, String)> {
    let all: Vec<(String, String)> = journals
        .iter()
        .enumerate()
        .filter_map(|(index, journal)| {
            let frame = results.column(&journal.force[0])?.frame.clone();
            Some((frame, journal_letter(index)))
        })
        .collect();
    // axes shared by several journals identify none of them
    let alone = |frame: &str| all.iter().filter(|(other, _)| other == frame).count() == 1;
    all.iter()
        .filter(|(frame, _)| alone(frame))
        .cloned()
        .collect()
}

/// One name for the frames of several curves: `block.main[1…5]` if they differ in one number.
pub fn common_frame(frames: &[&str]) -> String {
    let mut distinct: Vec<&str> = Vec::new();
    for frame in frames {
        if !distinct.contains(frame) {
            distinct.push(frame);
        }
    }
    let (Some(first), Some(last)) = (distinct.first(), distinct.last()) else {
        return String::new();
    };
    if distinct.len() == 1 {
        return (*first).to_owned();
    }
    let around = |frame: &str| {
        let (head, rest) = frame.rsplit_once('[')?;
        let (index, tail) = rest.split_once(']')?;
        Some((head.to_owned(), index.to_owned(), tail.to_owned()))
    };
    match (around(first), around(last)) {
        (Some((head, from, tail)), Some((_, to, _)))
            if distinct
                .iter()
                .all(|f| around(f).is_some_and(|(h, _, t)| h == head && t == tail)) =>
        {
            format!("{head}[{from}…{to}]{tail}")
        }
        _ => distinct.join(", "),
    }
}
