//! Builds the syntax tree from the recogniser's pairs.

pub(crate) mod diagnose;
mod expressions;
pub(crate) mod items;
mod types;
mod units;

use crate::ast::{Item, ItemKind, Name};
use crate::codes;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::grammar::Rule;
use crate::span::{SourceId, Span};
use crate::tokens::{Token, last_end, tokens};
use pest::iterators::{Pair, Pairs};
use std::collections::BTreeSet;

/// Greatest depth of a tree. Every later stage walks trees by recursion, so this limits the stack of all of
/// them. An operator, a bracket, a call or a field is one level. The number is a choice: texts have some ten
/// levels.
pub(crate) const MAX_DEPTH: usize = 256;

/// Greatest nesting of brackets in a text. A choice: texts have some ten.
pub(crate) const MAX_NESTING: usize = 100;

/// Most mistakes in one text that get a message. A choice: nobody reads more at once, and later ones often
/// follow from earlier ones.
const MAX_MISTAKES: usize = 100;

/// Makes one tree from one text.
pub(crate) struct Builder<'t, 'd> {
    pub text: &'t str,
    pub tokens: Vec<Token>,
    source: SourceId,
    offset: usize,
    diagnostics: &'d mut Diagnostics,
    mistakes: usize,
    /// Number of declarations without their `{`. The same number of `}` is then too many.
    headless: usize,
    /// Whether the depth of the present item was reported.
    deep: bool,
    /// The `{` that a missing `}` belongs to, if one is missing.
    pub open_brace: Option<Token>,
    /// The place of the present items.
    pub place_of_items: diagnose::Place,
    /// Whether a word is a unit. Without it every word after a number counts as one.
    pub is_unit: Option<&'d dyn Fn(&str) -> bool>,
    /// The words among the factors after numbers that are no units.
    pub unknown_units: BTreeSet<String>,
    /// The factors after the unit of the value that was built last.
    factors: Vec<expressions::Part<'t>>,
}

/// A run of text in a block, before it becomes items.
enum Piece<'t> {
    Good {
        pair: Pair<'t, Rule>,
        start: usize,
        end: usize,
    },
    Bad {
        docs: Vec<String>,
        start: usize,
        end: usize,
        /// Number of open `(` and `[` at its end.
        open: usize,
    },
}

impl Piece<'_> {
    fn end(&self) -> usize {
        match self {
            Piece::Good { end, .. } | Piece::Bad { end, .. } => *end,
        }
    }
}

/// The first child that a rule made.
fn child<'t>(pair: &Pair<'t, Rule>, rule: Rule) -> Option<Pair<'t, Rule>> {
    pair.clone()
        .into_inner()
        .find(|inner| inner.as_rule() == rule)
}

/// Whether `last` is a binding without a value, and `next` seems to be the rest of it:
/// `param x Length = 5 mm`.
fn unfinished(last: &Piece<'_>, next: &Pair<'_, Rule>) -> bool {
    let Piece::Good { pair, .. } = last else {
        return false;
    };
    child(next, Rule::attribute).is_some()
        && child(pair, Rule::binding).is_some_and(|binding| {
            binding
                .into_inner()
                .all(|part| part.as_rule() != Rule::expression)
        })
}

impl<'t, 'd> Builder<'t, 'd> {
    /// A builder for `text`, which begins at byte `offset` of `source`.
    pub fn new(
        text: &'t str,
        source: SourceId,
        offset: usize,
        diagnostics: &'d mut Diagnostics,
    ) -> Self {
        Builder {
            text,
            tokens: tokens(text),
            source,
            offset,
            diagnostics,
            mistakes: 0,
            headless: 0,
            deep: false,
            open_brace: None,
            place_of_items: diagnose::Place::File,
            is_unit: None,
            unknown_units: BTreeSet::new(),
            factors: Vec::new(),
        }
    }

    /// A span of the source from bytes of this text.
    pub fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.source, self.offset + start, self.offset + end)
    }

    /// The place of a pair without the white space that the recogniser took at its end.
    fn place(&self, pair: &Pair<'_, Rule>) -> Span {
        let (start, end) = self.range(pair);
        self.span(start, end)
    }

    fn range(&self, pair: &Pair<'_, Rule>) -> (usize, usize) {
        let span = pair.as_span();
        (
            span.start(),
            last_end(&self.tokens, span.start(), span.end()),
        )
    }

    fn name(&self, pair: &Pair<'_, Rule>) -> Name {
        Name {
            text: pair.as_str().to_string(),
            span: self.place(pair),
        }
    }

    /// The next name. The grammar guarantees it; a missing one would give an empty name.
    fn next_name(&self, pairs: &mut Pairs<'_, Rule>) -> Name {
        match pairs.next() {
            Some(pair) => self.name(&pair),
            None => Name {
                text: String::new(),
                span: self.span(0, 0),
            },
        }
    }

    /// Reports a message, up to [`MAX_MISTAKES`].
    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.mistakes += 1;
        if self.mistakes <= MAX_MISTAKES {
            self.diagnostics.push(diagnostic);
        } else if self.mistakes == MAX_MISTAKES + 1 {
            self.diagnostics.push(Diagnostic::note(
                codes::TOO_MANY,
                format!("more than {MAX_MISTAKES} mistakes; the others are not shown"),
            ));
        }
    }

    fn too_deep(&mut self, span: Span) {
        if std::mem::replace(&mut self.deep, true) {
            return;
        }
        self.report(
            Diagnostic::error(codes::NESTED, "this is nested too deep")
                .at(
                    span,
                    format!("more than {MAX_DEPTH} levels: each bracket and each operator is one"),
                )
                .with_help("name parts of it with `let`"),
        );
    }

    /// The items among the pairs of a file or a block.
    pub fn items(&mut self, pairs: Pairs<'t, Rule>, depth: usize) -> Vec<Item> {
        let mut pieces: Vec<Piece<'t>> = Vec::new();
        let mut stray = Vec::new();
        for pair in pairs {
            match pair.as_rule() {
                Rule::item => {
                    let start = pair
                        .clone()
                        .into_inner()
                        .find(|inner| inner.as_rule() != Rule::doc)
                        .map_or(pair.as_span().start(), |inner| inner.as_span().start());
                    let (_, end) = self.range(&pair);
                    if let Some(last) = pieces.last()
                        && !self.parted(last.end(), start)
                    {
                        if unfinished(last, &pair) {
                            self.add_bad(&mut pieces, &pair);
                            continue;
                        }
                        let last_end = last.end();
                        self.two_on_a_line(last_end, start, end);
                    }
                    pieces.push(Piece::Good { pair, start, end });
                }
                Rule::bad_item => self.add_bad(&mut pieces, &pair),
                Rule::stray_brace => stray.push(self.place(&pair)),
                _ => {}
            }
        }
        let mut items = Vec::with_capacity(pieces.len());
        for piece in pieces {
            match piece {
                Piece::Good { pair, .. } => {
                    self.deep = false;
                    items.push(self.item(pair, depth));
                }
                Piece::Bad {
                    docs, start, end, ..
                } => self.bad(docs, start, end, depth, &mut items),
            }
        }
        for span in stray.into_iter().skip(self.headless) {
            self.report(
                Diagnostic::error(codes::UNPAIRED, "this `}` closes nothing")
                    .at(span, "no block is open here")
                    .with_help("remove it, or look for a `}` too many above"),
            );
        }
        items
    }

    /// Whether a line end or a `;` is between two places.
    fn parted(&self, end: usize, start: usize) -> bool {
        self.text
            .get(end..start)
            .is_none_or(|between| between.contains(['\n', ';']))
    }

    fn two_on_a_line(&mut self, last_end: usize, start: usize, end: usize) {
        let first_line = self.text.get(start..end).unwrap_or("");
        let shown = first_line.split_whitespace().next().unwrap_or("");
        let diagnostic = Diagnostic::error(codes::TWO_ITEMS, "two items are on one line")
            .at(
                self.span(start, start + shown.len()),
                "a second item begins here",
            )
            .with_help("an item ends at the line's end or at `;`")
            .with_fix("separate them", self.span(last_end, last_end), ";");
        self.report(diagnostic);
    }

    /// Joins unreadable text to its beginning: the item before on the same line, or the unreadable line that
    /// it continues.
    fn add_bad(&self, pieces: &mut Vec<Piece<'t>>, pair: &Pair<'t, Rule>) {
        let mut docs = Vec::new();
        let mut start = pair.as_span().start();
        for inner in pair.clone().into_inner() {
            match inner.as_rule() {
                Rule::doc => docs.push(items::doc_text(inner.as_str())),
                _ => start = inner.as_span().start(),
            }
        }
        let (_, end) = self.range(pair);
        let joins = match pieces.last() {
            Some(Piece::Good { end: last, .. }) => {
                !self.parted(*last, start)
                    && !self
                        .text
                        .get(..*last)
                        .is_some_and(|before| before.ends_with('}'))
            }
            Some(Piece::Bad {
                end: last, open, ..
            }) => {
                let between = self.text.get(*last..start).unwrap_or("");
                *open > 0
                    || !between.contains(['\n', ';'])
                    || (!between.contains(';')
                        && diagnose::continues(self.text, &self.tokens, start))
            }
            None => false,
        };
        let mut piece = (docs, start, 0, start);
        if joins {
            piece = match pieces.pop() {
                Some(Piece::Good { pair, start, .. }) => (items::docs(&pair), start, 0, start),
                Some(Piece::Bad {
                    docs,
                    start,
                    end,
                    open,
                }) => (docs, start, open, end),
                None => piece,
            };
        }
        let (docs, start, open, from) = piece;
        pieces.push(Piece::Bad {
            docs,
            start,
            end,
            open: diagnose::open_brackets(self.text, &self.tokens, from, end, open),
        });
    }

    /// Reports the mistake in a piece. Readable text after the mistake still becomes items.
    fn bad(
        &mut self,
        docs: Vec<String>,
        start: usize,
        end: usize,
        depth: usize,
        items: &mut Vec<Item>,
    ) {
        self.headless += usize::from(diagnose::lacks_brace(self.text, &self.tokens, start, end));
        let mut bad_end = end;
        let mut rest = None;
        if self.mistakes <= MAX_MISTAKES
            && let Some(finding) = diagnose::item(self, start, end)
        {
            self.report(finding.diagnostic);
            if let Some(split) = finding.rest {
                bad_end = last_end(&self.tokens, start, split);
                rest = Some(split);
            }
        }
        items.push(Item {
            docs,
            span: self.span(start, bad_end),
            kind: ItemKind::Error,
        });
        if let Some(split) = rest
            && let Some(slice) = self.text.get(split..end)
            && let Some(pairs) = diagnose::item_list(slice)
        {
            let mut inner = Builder::new(
                slice,
                self.source,
                self.offset + split,
                &mut *self.diagnostics,
            );
            inner.mistakes = self.mistakes;
            inner.place_of_items = self.place_of_items;
            inner.is_unit = self.is_unit;
            items.extend(inner.items(pairs, depth));
            self.mistakes = inner.mistakes;
            self.headless += inner.headless;
            let unknown = std::mem::take(&mut inner.unknown_units);
            self.unknown_units.extend(unknown);
        }
    }
}
