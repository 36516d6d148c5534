//! A card: its name and fields, independent of the format of its lines, and the fields as numbers.

use super::lines::{At, Line};
use super::number;
use crate::error::FileProblem;

/// One line of a card, cut into fields.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// First field, upper case; blank or beginning with `+` or `*` on a continuation.
    pub head: String,
    /// Data fields: 8, or 4 of a large-field line; more on a long line in free field.
    pub fields: Vec<String>,
    /// Last field: the name of the continuation.
    pub tail: String,
    /// Whether it is in free field, in which columns have no meaning.
    pub free: bool,
}

impl Piece {
    /// Whether this continues a card.
    pub fn continues(&self) -> bool {
        self.head.is_empty() || self.head.starts_with(['+', '*'])
    }

    /// Whether this repeats the card before, in all or some fields.
    pub fn repeats(&self) -> bool {
        self.head.starts_with('=')
            || self
                .fields
                .iter()
                .any(|field| field.starts_with('=') || field.starts_with("*("))
    }
}

/// Cuts a line into fields. A line with a comma is in free field; other lines have columns. An asterisk in
/// the first field means large field.
pub(super) fn cut(line: &Line) -> Result<Piece, FileProblem> {
    let text = expand_tabs(&line.text).to_ascii_uppercase();
    let piece = if text.contains(',') {
        let mut tokens = text.split(',').map(|token| token.trim().to_string());
        let head = tokens.next().unwrap_or_default();
        let mut fields = tokens.collect::<Vec<_>>();
        while fields.last().is_some_and(String::is_empty) {
            fields.pop();
        }
        let count = if head.contains('*') { 4 } else { 8 };
        // data may continue beyond the eighth field; a name there calls the continuation, on a short line
        // also in an earlier field
        let repeats = head.starts_with('=');
        let called = !repeats && fields.last().is_some_and(|last| is_call(last));
        let long = fields
            .get(count)
            .is_some_and(|next| number::real(next).is_some());
        let mut tail = String::new();
        if called || (fields.len() == count + 1 && !long) {
            tail = fields.pop().unwrap_or_default();
        }
        // the commas of an equation are those of its functions
        if fields.len() > count
            && !long
            && !is_equation(&head)
            && let Some(extra) = fields
                .get(count..)
                .and_then(|rest| rest.iter().find(|f| !f.is_empty()))
        {
            return Err(line.at.problem(
                format!(
                    "\"{extra}\" is one field too many in \"{}\"",
                    line.text.trim()
                ),
                format!(
                    "a line in free format holds the name of the card, {count} fields and the name of its \
continuation; write further fields on a new line that begins with a comma"
                ),
            ));
        }
        fields.resize(
            fields.len().next_multiple_of(count).max(count),
            String::new(),
        );
        Piece {
            head,
            fields,
            tail,
            free: true,
        }
    } else {
        let column = |from: usize, to: usize| {
            let to = to.min(text.len());
            text.get(from.min(to)..to).unwrap_or("").trim().to_string()
        };
        let head = column(0, 8);
        let (count, width) = if head.contains('*') { (4, 16) } else { (8, 8) };
        Piece {
            fields: (0..count)
                .map(|i| column(8 + i * width, 8 + (i + 1) * width))
                .collect(),
            tail: column(72, 80),
            head,
            free: false,
        }
    };
    Ok(piece)
}

/// Whether a line begins an equation.
pub(super) fn is_equation(line: &str) -> bool {
    let head = line.get(..6);
    head.is_some_and(|head| head.eq_ignore_ascii_case("DEQATN"))
}

/// Whether a field can only be the name of a continuation.
fn is_call(field: &str) -> bool {
    field.starts_with(['+', '*']) && number::real(field).is_none()
}

/// Replaces a tab by blanks up to the next column that is a multiple of eight.
fn expand_tabs(text: &str) -> String {
    let mut expanded = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if c == '\t' {
            expanded.push(' ');
            while !expanded.len().is_multiple_of(8) {
                expanded.push(' ');
            }
        } else {
            expanded.push(c);
        }
    }
    expanded
}

/// A card with all its lines.
#[derive(Clone, Debug)]
pub(super) struct Card {
    /// Name, upper case, without asterisk.
    pub name: String,
    /// Its unchanged first line.
    pub first_line: String,
    /// Place of its first line.
    pub at: At,
    /// Its number in the deck as a whole.
    pub order: u64,
    /// The missing continuation that it calls.
    pub lost: Option<String>,
    fields: Vec<String>,
}

impl Card {
    /// Begins a card.
    pub fn new(line: &Line, piece: Piece) -> Self {
        Card {
            name: piece
                .head
                .split([' ', '*'])
                .next()
                .unwrap_or("")
                .to_string(),
            first_line: line.text.trim().to_string(),
            at: line.at.clone(),
            order: line.order,
            lost: None,
            fields: piece.fields,
        }
    }

    /// Adds the fields of a continuation. A single large-field line is half a line. The next
    /// continuation begins a new line.
    pub fn append(&mut self, fields: Vec<String>) {
        let whole = if fields.len().is_multiple_of(8) { 8 } else { 4 };
        self.fields
            .resize(self.fields.len().next_multiple_of(whole), String::new());
        self.fields.extend(fields);
    }

    /// Number of fields up to the last that isn't blank.
    pub fn len(&self) -> usize {
        let blank = self
            .fields
            .iter()
            .rev()
            .take_while(|field| field.is_empty());
        self.fields.len() - blank.count()
    }

    /// Text of data field `i`, from 0; blank beyond the end.
    pub fn text(&self, i: usize) -> &str {
        self.fields.get(i).map_or("", String::as_str)
    }

    /// Whether a field is blank.
    pub fn is_blank(&self, i: usize) -> bool {
        self.text(i).is_empty()
    }

    /// A problem of this card.
    pub fn problem(&self, problem: &str, advice: impl Into<String>) -> FileProblem {
        self.at.problem(
            format!("{}: {problem}, in \"{}\"", self.name, self.first_line),
            advice,
        )
    }

    /// The problem of a lost continuation, if the card has one.
    pub fn lost_problem(&self) -> Option<FileProblem> {
        let name = self.lost.as_ref()?;
        Some(self.problem(
            &format!("its continuation \"{name}\" is missing"),
            "add the line that begins with this name; if no line follows, leave the last field of \
the card blank",
        ))
    }

    fn missing(&self, i: usize, field: &str) -> FileProblem {
        if i >= self.len() {
            self.problem(
                &format!("the card ends before its field {field}"),
                "add the missing fields; the line may have been cut, or its continuation lost",
            )
        } else {
            self.problem(&format!("field {field} is blank"), "give it a value")
        }
    }

    fn wrong(&self, i: usize, field: &str, what: &str) -> FileProblem {
        self.problem(
            &format!("field {field} is \"{}\", not {what}", self.text(i)),
            "check that each field is in its columns and that no number contains a blank",
        )
    }

    /// A required identification number.
    pub fn id(&self, i: usize, field: &str) -> Result<u64, FileProblem> {
        match self.optional_id(i, field)? {
            Some(0) => Err(self.wrong(i, field, "a positive integer")),
            Some(id) => Ok(id),
            None => Err(self.missing(i, field)),
        }
    }

    /// An identification number or zero; `None` for a blank field.
    pub fn optional_id(&self, i: usize, field: &str) -> Result<Option<u64>, FileProblem> {
        let text = self.text(i);
        if text.is_empty() {
            return Ok(None);
        }
        number::integer(text)
            .and_then(|id| u64::try_from(id).ok())
            .map(Some)
            .ok_or_else(|| self.wrong(i, field, "a positive integer"))
    }

    /// A required real.
    pub fn real(&self, i: usize, field: &str) -> Result<f64, FileProblem> {
        self.optional_real(i, field)?
            .ok_or_else(|| self.missing(i, field))
    }

    /// A real; `None` for a blank field.
    pub fn optional_real(&self, i: usize, field: &str) -> Result<Option<f64>, FileProblem> {
        let text = self.text(i);
        if text.is_empty() {
            return Ok(None);
        }
        number::real(text)
            .map(Some)
            .ok_or_else(|| self.wrong(i, field, "a number"))
    }

    /// A real; zero for a blank field.
    pub fn real_or_zero(&self, i: usize, field: &str) -> Result<f64, FileProblem> {
        Ok(self.optional_real(i, field)?.unwrap_or(0.0))
    }

    /// Three reals from field `i`; zero for a blank field.
    pub fn vector(&self, i: usize, field: &str) -> Result<[f64; 3], FileProblem> {
        let part = |k: usize| self.real_or_zero(i + k, &format!("{field}{}", k + 1));
        Ok([part(0)?, part(1)?, part(2)?])
    }

    /// Required freedoms 1…6 as bits.
    pub fn components(&self, i: usize, field: &str) -> Result<u8, FileProblem> {
        self.optional_components(i, field)?
            .ok_or_else(|| self.missing(i, field))
    }

    /// Freedoms 1…6 as bits; `None` for a blank field.
    pub fn optional_components(&self, i: usize, field: &str) -> Result<Option<u8>, FileProblem> {
        if self.is_blank(i) {
            return Ok(None);
        }
        number::components(self.text(i))
            .map(Some)
            .ok_or_else(|| self.wrong(i, field, "freedoms 1 to 6"))
    }

    /// One freedom, written 1…6, counted from 0; `None` for a blank field or zero (a scalar point).
    pub fn freedom(&self, i: usize, field: &str) -> Result<Option<u8>, FileProblem> {
        match self.text(i) {
            "" | "0" => Ok(None),
            "1" => Ok(Some(0)),
            "2" => Ok(Some(1)),
            "3" => Ok(Some(2)),
            "4" => Ok(Some(3)),
            "5" => Ok(Some(4)),
            "6" => Ok(Some(5)),
            _ => Err(self.wrong(i, field, "one freedom 1 to 6")),
        }
    }

    /// Identification numbers from field `from` up to (not including) `to`, with `THRU`, `BY` and `EXCEPT`.
    pub fn ids(&self, from: usize, to: usize, field: &str) -> Result<Ids, FileProblem> {
        let mut ids = Ids::default();
        let mut i = from;
        let mut excepting = false;
        while i < to {
            match self.text(i) {
                "" => {}
                "THRU" => {
                    i += 1;
                    let end = self.id(i, field)?;
                    let Some(range) = ids.ranges.last_mut().filter(|range| range.from <= end)
                    else {
                        return Err(self.problem(
                            &format!("THRU {end} has no lower number before it"),
                            "write the list as \"first THRU last\" with the smaller number first",
                        ));
                    };
                    range.to = end;
                    range.listed = false;
                    excepting = false;
                }
                "BY" => {
                    i += 1;
                    let step = self.id(i, field)?;
                    if let Some(range) = ids.ranges.last_mut() {
                        range.step = step;
                    }
                }
                "EXCEPT" => excepting = true,
                _ => {
                    let id = self.id(i, field)?;
                    excepting &= ids.ranges.last().is_some_and(|range| id <= range.to);
                    if excepting {
                        ids.except.push(id);
                    } else {
                        ids.ranges.extend(Ids::one(id).ranges);
                    }
                }
            }
            i += 1;
        }
        Ok(ids)
    }
}

/// A range of identification numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct IdRange {
    /// First.
    pub from: u64,
    /// Last.
    pub to: u64,
    /// Distance.
    pub step: u64,
    /// Whether the card names it singly, so that it must exist. Numbers inside a `THRU` need not exist.
    pub listed: bool,
}

impl IdRange {
    fn holds(&self, id: u64) -> bool {
        (self.from..=self.to).contains(&id) && (id - self.from).is_multiple_of(self.step.max(1))
    }
}

/// A list of identification numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Ids {
    /// Ranges in the order of the card.
    pub ranges: Vec<IdRange>,
    /// Excluded numbers.
    pub except: Vec<u64>,
}

impl Ids {
    /// Whether a number is among them.
    pub fn holds(&self, id: u64) -> bool {
        self.ranges.iter().any(|range| range.holds(id)) && !self.except.contains(&id)
    }

    /// How often the list has a number.
    pub fn times(&self, id: u64) -> usize {
        match self.holds(id) {
            true => self.ranges.iter().filter(|range| range.holds(id)).count(),
            false => 0,
        }
    }

    /// A list of one number.
    pub fn one(id: u64) -> Self {
        Ids {
            ranges: vec![IdRange {
                from: id,
                to: id,
                step: 1,
                listed: true,
            }],
            except: Vec::new(),
        }
    }
}
