//! Joins the lines of cards. A continuation follows its card, or is anywhere in the deck and is found by its
//! name.

use std::collections::BTreeMap;

use super::card::{Card, Piece, cut, is_equation};
use super::lines::{At, Line};
use super::replication::Repeated;
use crate::error::FileProblem;

struct Open {
    card: Card,
    /// Last field of the last line so far.
    tail: String,
    /// Whether the last line so far is in free field.
    free: bool,
}

impl Open {
    /// Whether its last field certainly calls a continuation. Columns 73 to 80 may hold a number without
    /// meaning.
    fn surely_calls(&self) -> bool {
        self.tail.starts_with(['+', '*']) || self.free && !self.tail.is_empty()
    }

    /// The card, with the name of a continuation that it still calls.
    fn done(mut self) -> Card {
        if self.surely_calls() {
            self.card.lost = Some(self.tail);
        }
        self.card
    }
}

struct Orphan {
    name: String,
    lines: Vec<Vec<String>>,
    tail: String,
    free: bool,
    at: At,
    text: String,
    /// The waiting card before it.
    after: Option<usize>,
    used: bool,
}

/// Makes cards of lines. A card without its continuation after it waits until the end of the deck.
#[derive(Default)]
pub(super) struct Assembler {
    open: Option<Open>,
    waiting: Vec<Open>,
    orphans: Vec<Orphan>,
    /// The line before was an orphan. A line without a name of its own continues it.
    in_orphan: bool,
    /// Whether an orphan followed the open card, so that the card has to wait.
    followed: bool,
    /// The card that the next line may repeat.
    repeated: Repeated,
    /// Whether the line belongs to an equation (`DEQATN`).
    in_equation: bool,
}

impl Assembler {
    /// Adds a line. Returns the earlier cards that are now complete.
    pub fn push(&mut self, line: &Line) -> Result<Vec<Card>, FileProblem> {
        // an equation goes on in lines with a blank first field, and the commas of its functions begin no fields
        if self.in_equation && line.text.starts_with("        ") {
            return Ok(Vec::new());
        }
        self.in_equation = is_equation(&line.text);
        let piece = cut(line)?;
        if piece.continues() {
            self.repeated.continued();
            self.continuation(line, piece);
            return Ok(Vec::new());
        }
        let mut done = Vec::new();
        for piece in self.repeated.cards(line, piece)? {
            done.extend(self.close());
            let (tail, free) = (piece.tail.clone(), piece.free);
            self.open = Some(Open {
                card: Card::new(line, piece),
                tail,
                free,
            });
        }
        Ok(done)
    }

    fn continuation(&mut self, line: &Line, piece: Piece) {
        let name = piece.head.get(1..).unwrap_or("").trim().to_string();
        if self.in_orphan
            && let Some(orphan) = self.orphans.last_mut()
        {
            if name.is_empty() || calls(&orphan.tail, &name) {
                orphan.lines.push(piece.fields);
                orphan.tail = piece.tail;
                orphan.free = piece.free;
                return;
            }
        } else if let Some(open) = &mut self.open
            && (name.is_empty() || calls(&open.tail, &name))
        {
            open.card.append(piece.fields);
            open.tail = piece.tail;
            open.free = piece.free;
            return;
        }
        self.in_orphan = true;
        self.followed = self.open.is_some();
        self.orphans.push(Orphan {
            name,
            lines: vec![piece.fields],
            tail: piece.tail,
            free: piece.free,
            at: line.at.clone(),
            text: line.text.trim().to_string(),
            after: self.open.as_ref().map(|_| self.waiting.len()),
            used: false,
        });
    }

    /// Closes the open card. It is complete, waits for its continuation, or has lost it.
    fn close(&mut self) -> Option<Card> {
        let followed = std::mem::take(&mut self.followed);
        self.in_orphan = false;
        let open = self.open.take()?;
        if followed || !key(&open.tail).is_empty() {
            self.waiting.push(open);
            return None;
        }
        Some(open.done())
    }

    /// Ends the deck. Returns the last card and the waiting ones, with the continuations found by name.
    pub fn finish(mut self) -> Result<Vec<Card>, FileProblem> {
        let last = self.close();
        let mut named: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (index, orphan) in self.orphans.iter().enumerate().rev() {
            named.entry(orphan.name.clone()).or_default().push(index);
        }
        for open in &mut self.waiting {
            while let Some(orphan) = Some(key(&open.tail))
                .filter(|key| !key.is_empty())
                .and_then(|key| named.get_mut(key)?.pop())
                .and_then(|index| self.orphans.get_mut(index))
            {
                adopt(open, orphan);
            }
        }
        // a line that no card called belongs to the card before it, unless that card called another line
        for orphan in self.orphans.iter_mut().filter(|orphan| !orphan.used) {
            match orphan.after.and_then(|index| self.waiting.get_mut(index)) {
                Some(open) if key(&open.tail).is_empty() => adopt(open, orphan),
                _ => {
                    return Err(orphan.at.problem(
                        format!("\"{}\" continues no card", orphan.text),
                        "add the card that it continues, or write its name in the last field of that card",
                    ));
                }
            }
        }
        Ok(self
            .waiting
            .into_iter()
            .map(Open::done)
            .chain(last)
            .collect())
    }
}

fn adopt(open: &mut Open, orphan: &mut Orphan) {
    orphan.used = true;
    for fields in orphan.lines.drain(..) {
        open.card.append(fields);
    }
    open.tail = std::mem::take(&mut orphan.tail);
    open.free = orphan.free;
}

/// The name that a last field calls. Its first column doesn't count: `+ABC` and `XABC` both call `+ABC`.
fn key(tail: &str) -> &str {
    tail.get(1..).unwrap_or("").trim()
}

/// Whether a last field calls a continuation of this name.
fn calls(tail: &str, name: &str) -> bool {
    key(tail) == name || tail == name
}
