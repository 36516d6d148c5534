//! Cards that repeat the one before (MSC Nastran Quick Reference Guide, "Replication").
//! | field | meaning |
//! | --- | --- |
//! | `=` | the same field of the card before; in the first field its name |
//! | `==` | this and all further fields of the card before |
//! | `*(d)`, `*d` | that field plus d |
//! | `=(n)`, `=n` in the first field, alone | n more cards, each with the additions of the card before |

use super::card::Piece;
use super::lines::Line;
use super::number;
use crate::error::FileProblem;

/// A repetition of more cards than this is a mistake. A choice: no deck writes as many with one card, and
/// they would fill the memory.
const MOST: i64 = 1_000_000;

/// The card that others may repeat.
#[derive(Clone, Debug, Default)]
pub(super) struct Repeated {
    /// The card, if it has one line; `None` before the first card, and after a card of several lines.
    card: Option<Piece>,
    /// The additions to its fields.
    added: Vec<Option<String>>,
}

impl Repeated {
    /// The cards that a line represents.
    pub fn cards(&mut self, line: &Line, piece: Piece) -> Result<Vec<Piece>, FileProblem> {
        if !piece.repeats() {
            self.added.clear();
            self.card = Some(piece.clone());
            return Ok(vec![piece]);
        }
        let Some(before) = self.card.clone() else {
            return Err(problem(
                line,
                "repeats the card before, but that card has several lines or is missing",
            ));
        };
        let count = piece
            .head
            .strip_prefix('=')
            .map(bracketed)
            .filter(|n| !n.is_empty());
        if let Some(count) = count {
            let count = number::integer(count).filter(|n| (1..=MOST).contains(n));
            let (Some(count), false) = (count, self.added.is_empty()) else {
                return Err(problem(
                    line,
                    "repeats the card before several times, but no line before it states the increments of the fields",
                ));
            };
            let mut made = Vec::new();
            let mut last = before;
            for _ in 0..count {
                for (field, added) in last.fields.iter_mut().zip(&self.added) {
                    if let Some(added) = added {
                        *field = sum(field, added).ok_or_else(|| not_added(line, field))?;
                    }
                }
                made.push(last.clone());
            }
            self.card = Some(last);
            return Ok(made);
        }
        let mut made = piece.clone();
        if made.head == "=" {
            made.head.clone_from(&before.head);
        }
        self.added = vec![None; before.fields.len()];
        made.fields
            .resize(before.fields.len().max(made.fields.len()), String::new());
        for (i, field) in made.fields.iter_mut().enumerate() {
            let earlier = before.fields.get(i).map_or("", String::as_str);
            if field == "=" {
                *field = earlier.to_string();
            } else if let Some(added) = addition(field) {
                let added = added.to_string();
                *field = sum(earlier, &added).ok_or_else(|| not_added(line, earlier))?;
                if let Some(kept) = self.added.get_mut(i) {
                    *kept = Some(added);
                }
            }
        }
        if let Some(from) = made.fields.iter().position(|field| field == "==") {
            for (i, field) in made.fields.iter_mut().enumerate().skip(from) {
                *field = before.fields.get(i).cloned().unwrap_or_default();
            }
        }
        made.tail = String::new();
        self.card = Some(made.clone());
        Ok(vec![made])
    }

    /// Notes that a continuation follows. Then the card cannot be repeated.
    pub fn continued(&mut self) {
        self.card = None;
    }
}

fn problem(line: &Line, what: &str) -> FileProblem {
    line.at.problem(
        format!("\"{}\" {what}", line.text.trim()),
        "write each repeated card in full",
    )
}

fn not_added(line: &Line, field: &str) -> FileProblem {
    problem(
        line,
        &format!("adds a number to \"{field}\", which is no number"),
    )
}

/// The text without brackets around it.
fn bracketed(text: &str) -> &str {
    let inner = text
        .strip_prefix('(')
        .and_then(|text| text.strip_suffix(')'));
    inner.unwrap_or(text).trim()
}

/// The addition d of a field `*(d)`.
fn addition(field: &str) -> Option<&str> {
    let added = bracketed(field.strip_prefix('*')?);
    number::real(added).map(|_| added)
}

/// Sum of two numbers as text. The sum of whole numbers is written as a whole number.
fn sum(value: &str, added: &str) -> Option<String> {
    if let (Some(value), Some(added)) = (number::integer(value), number::integer(added)) {
        return Some(value.checked_add(added)?.to_string());
    }
    let sum = number::real(value)? + number::real(added)?;
    sum.is_finite().then(|| format!("{sum:?}"))
}
