//! Lines: where they end, how far they are indented, where their comments begin.

use super::marks::{Bracket, Marks};
use super::pieces::{Piece, PieceKind};

/// Most characters of a line, if it has a place to end. A choice: the library's elements have names of parts
/// with units on one line.
const WIDTH: usize = 140;
/// Blanks of one step of indentation.
const STEP: usize = 4;
/// Blanks between a line and its comment.
const BEFORE_COMMENT: usize = 2;

/// One line.
struct Line {
    /// Empty lines before it, 0 or 1.
    empty_before: bool,
    indent: usize,
    /// Without its indent; empty for a line of a comment alone.
    code: String,
    /// Characters of `code`.
    width: usize,
    /// A comment after the code, or below such a comment.
    comment: Option<String>,
}

/// A bracket that is open at some place.
struct Open {
    bracket: Bracket,
    /// Indent of the line that opens it.
    line_indent: usize,
    /// Indent of the item around it.
    item_indent: usize,
    /// Columns of its first piece, here and as written, if this piece is in the same line.
    first: Option<(usize, usize)>,
    /// Whether its lines begin below its first piece, as the first line that the author began in it.
    aligned: bool,
}

/// The text of all pieces.
pub(super) fn text(pieces: &[Piece<'_>], marks: &Marks<'_>) -> String {
    let mut layout = Layout {
        pieces,
        marks,
        ends: ends(pieces, marks),
        open: Vec::new(),
        item_indent: 0,
        lines: Vec::new(),
    };
    let mut at = 0;
    while at < pieces.len() {
        at = layout.line(at);
    }
    joined(&layout.lines)
}

/// Lines with their comments aligned.
fn joined(lines: &[Line]) -> String {
    let mut out = String::new();
    let mut at = 0;
    while at < lines.len() {
        let has_comment = |line: &&Line| line.comment.is_some();
        let more = lines[at + 1..]
            .iter()
            .take_while(|line| has_comment(line) && !line.empty_before)
            .count();
        let group = match lines[at].comment {
            Some(_) => &lines[at..=at + more],
            None => &lines[at..=at],
        };
        let width = |line: &Line| {
            if line.code.is_empty() {
                0
            } else {
                line.indent + line.width
            }
        };
        let column = group.iter().map(width).max().unwrap_or(0) + BEFORE_COMMENT;
        for line in group {
            if line.empty_before {
                out.push('\n');
            }
            if !line.code.is_empty() {
                out.push_str(&" ".repeat(line.indent));
                out.push_str(&line.code);
            }
            if let Some(comment) = &line.comment {
                out.push_str(&" ".repeat(column - width(line)));
                out.push_str(comment);
            }
            out.push('\n');
        }
        at += group.len();
    }
    out
}

/// For each piece, whether a line must end before it.
fn ends(pieces: &[Piece<'_>], marks: &Marks<'_>) -> Vec<bool> {
    let is_block = |piece: &Piece<'_>| match piece.kind {
        PieceKind::Token(token) => marks.opens(token) == Some(Bracket::Block),
        _ => false,
    };
    let mut ends: Vec<bool> = pieces
        .iter()
        .enumerate()
        .map(|(i, piece)| {
            let before = i.checked_sub(1).and_then(|before| pieces.get(before));
            let Some(before) = before else {
                return false;
            };
            match piece.kind {
                _ if before.ends_line() => true,
                PieceKind::Doc(_) => true,
                PieceKind::Comment => piece.breaks > 0,
                PieceKind::Token(token) => {
                    let joins =
                        is_block(piece) || marks.is_sign(token, ",") || marks.is_sign(token, ";");
                    piece.breaks > 0 && !joins
                }
            }
        })
        .collect();
    // a block of several lines has its braces at the end of a line and in a line
    let mut open: Vec<(usize, usize)> = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        let Some(token) = piece.token() else { continue };
        if is_block(piece) {
            open.push((i, marks.partner(token)));
        }
        if let Some(&(opened, close)) = open.last()
            && close == token
        {
            open.pop();
            if ends[opened + 1..=i].contains(&true) {
                ends[i] = true;
                // a comment after the brace stays there
                if pieces[opened + 1].kind != PieceKind::Comment {
                    ends[opened + 1] = true;
                }
            }
        }
    }
    ends
}

struct Layout<'a, 't> {
    pieces: &'a [Piece<'t>],
    marks: &'a Marks<'t>,
    ends: Vec<bool>,
    open: Vec<Open>,
    /// Indent of the item that continues here.
    item_indent: usize,
    lines: Vec<Line>,
}

impl Layout<'_, '_> {
    /// Adds the line that begins with a piece. Returns the first piece of the next line.
    fn line(&mut self, start: usize) -> usize {
        let mut end = (start + 1..self.pieces.len())
            .find(|&i| self.ends[i])
            .unwrap_or(self.pieces.len());
        let indent = self.indent(start);
        let trailing = end > start + 1 && self.pieces[end - 1].kind == PieceKind::Comment;
        let mut code_end = if trailing { end - 1 } else { end };
        if self.width(start, code_end) + indent > WIDTH
            && let Some(earlier) = self.place_to_end(start, code_end, indent)
        {
            end = earlier;
            code_end = earlier;
        }
        let empty_before = self.empty_before(start);
        if self.below_a_comment(start) {
            self.lines.push(Line {
                empty_before,
                indent,
                code: String::new(),
                width: 0,
                comment: Some(self.pieces[start].text.to_owned()),
            });
            return end;
        }
        let code = self.pass(start, code_end, indent);
        self.lines.push(Line {
            empty_before,
            indent,
            width: code.chars().count(),
            code,
            comment: (code_end < end).then(|| self.pieces[code_end].text.to_owned()),
        });
        end
    }

    /// Whether this piece is a comment that continues a comment at the end of the line above.
    fn below_a_comment(&self, start: usize) -> bool {
        let (Some(before), piece) = (start.checked_sub(1), &self.pieces[start]) else {
            return false;
        };
        let before = &self.pieces[before];
        let last = self.lines.last();
        piece.kind == PieceKind::Comment
            && piece.breaks == 1
            && before.kind == PieceKind::Comment
            && before.column == piece.column
            && last.is_some_and(|line| line.comment.is_some())
    }

    /// Whether an empty line is before this piece.
    fn empty_before(&self, start: usize) -> bool {
        let Some(before) = start.checked_sub(1).map(|before| &self.pieces[before]) else {
            return false;
        };
        let piece = &self.pieces[start];
        if piece.breaks < 2 {
            return false;
        }
        if let PieceKind::Doc(_) = before.kind {
            // docs belong to the item below them; those of a file do not
            return before.text.starts_with("//!") || piece.kind == PieceKind::Comment;
        }
        let opened = before
            .token()
            .is_some_and(|token| self.marks.opens(token).is_some());
        let closes = piece.token().is_some_and(|token| self.marks.closes(token));
        let inside = self
            .open
            .last()
            .is_some_and(|open| open.bracket != Bracket::Block);
        let begins =
            piece.ends_line() || piece.token().is_some_and(|token| self.marks.begins(token));
        !opened && !closes && (inside || begins)
    }

    /// The characters of pieces `from..to` in one line.
    fn width(&self, from: usize, to: usize) -> usize {
        (from..to)
            .map(|i| self.pieces[i].text.chars().count() + usize::from(i > from && self.blank(i)))
            .sum()
    }

    fn blank(&self, piece: usize) -> bool {
        self.pieces[piece]
            .token()
            .is_none_or(|token| self.marks.blank_before(token))
    }

    /// The piece before which a line that is too long ends: the last one that fits, among those inside of the fewest
    /// brackets that join the least. A line without such a piece stays too long.
    fn place_to_end(&self, start: usize, end: usize, indent: usize) -> Option<usize> {
        let mut best: Option<(usize, usize, usize)> = None;
        let (mut depth, mut block) = (0usize, 0usize);
        let mut column = indent;
        for i in start..end {
            let piece = &self.pieces[i];
            let Some(token) = piece.token() else { continue };
            if i > start && column <= WIDTH && block == 0 {
                let rest = self.item_indent + STEP + self.width(i, end);
                if let Some(rank) = self.rank(token, depth, rest)
                    && best.is_none_or(|(found, least, _)| (depth, rank) <= (found, least))
                {
                    best = Some((depth, rank, i));
                }
            }
            column += piece.text.chars().count() + usize::from(i > start && self.blank(i));
            match self.marks.opens(token) {
                Some(Bracket::Block) => block += 1,
                Some(_) => depth += 1,
                None if !self.marks.closes(token) => {}
                None if block > 0 && self.marks.is_sign(token, "}") => block -= 1,
                None => depth = depth.saturating_sub(1),
            }
        }
        best.map(|(_, _, place)| place)
    }

    /// How closely this token and the one before belong together, if a line that is too long may end between them.
    /// `rest` is the width of the line that would begin here.
    fn rank(&self, token: usize, depth: usize, rest: usize) -> Option<usize> {
        let marks = self.marks;
        let before = token.checked_sub(1)?;
        if marks.is_sign(before, ",") && !marks.closes(token) {
            return Some(0);
        }
        if depth == 0 && marks.word(before) == "else" && marks.is_text(token) {
            return Some(0);
        }
        if depth == 0 && marks.is_sign(before, "=") && rest <= WIDTH {
            return Some(1);
        }
        match marks.word(token) {
            "and" | "or" if marks.infix(token) && depth <= 1 => Some(2),
            "+" | "-" if marks.infix(token) && depth == 0 => Some(3),
            _ => None,
        }
    }

    /// The indent of the line that begins with this piece.
    fn indent(&self, start: usize) -> usize {
        // a comment has the indent that the token after it would have at the beginning of a line
        let token = self.pieces[start..]
            .iter()
            .find_map(|piece| match piece.kind {
                PieceKind::Comment => None,
                _ => piece.token(),
            });
        let own = self.pieces[start].kind != PieceKind::Comment;
        let item_indent = self.item_indent;
        let begins = match token {
            Some(token) => {
                let doc = matches!(self.pieces[start].kind, PieceKind::Doc(_));
                doc || self.begins_or_is_doc(token)
            }
            None => true,
        };
        let closes = token.is_some_and(|token| self.marks.closes(token));
        let Some(open) = self.open.last() else {
            let block = token.is_some_and(|token| self.marks.opens(token) == Some(Bracket::Block));
            return if begins || (own && block) {
                0
            } else {
                item_indent + STEP
            };
        };
        if open.bracket == Bracket::Block {
            return match (closes, own, begins) {
                (true, true, _) => open.item_indent,
                (true, false, _) | (_, _, true) => open.item_indent + STEP,
                _ => item_indent + STEP,
            };
        }
        if closes && own {
            return open.line_indent;
        }
        let inner = start.checked_sub(1).is_some_and(|before| {
            let before = &self.pieces[before];
            before.token().is_some_and(|token| {
                !self.marks.is_sign(token, ",")
                    && self.marks.opens(token).is_none()
                    && !matches!(before.kind, PieceKind::Doc(_))
            })
        });
        let piece = &self.pieces[start];
        let exact = piece.breaks > 0
            && open
                .first
                .is_some_and(|(_, written)| written == piece.column);
        let extra = if inner && !closes && !exact { STEP } else { 0 };
        match open.first {
            Some((column, _)) if open.aligned => column + extra,
            _ => open.line_indent + STEP + extra,
        }
    }

    /// Whether the lines inside of the bracket at this piece begin below its first piece.
    fn aligned(&self, opened: usize, bracket: Bracket) -> bool {
        let Some(first) = self
            .pieces
            .get(opened + 1)
            .filter(|first| first.breaks == 0)
        else {
            return false;
        };
        let mut depth = 0usize;
        for piece in &self.pieces[opened + 1..] {
            let Some(token) = piece.token() else { continue };
            if depth == 0 && piece.breaks > 0 {
                return bracket == Bracket::Parameters || piece.column == first.column;
            }
            if self.marks.opens(token).is_some() {
                depth += 1;
            } else if self.marks.closes(token) {
                match depth.checked_sub(1) {
                    Some(outer) => depth = outer,
                    None => break,
                }
            }
        }
        bracket == Bracket::Parameters
    }

    fn begins_or_is_doc(&self, token: usize) -> bool {
        self.marks.begins(token) || self.marks.word(token).starts_with("//")
    }

    /// Whether this piece opens a bracket.
    fn opened_by(&self, piece: usize) -> bool {
        let token = self.pieces[piece].token();
        token.is_some_and(|token| self.marks.opens(token).is_some())
    }

    /// The characters of a line; it notes the brackets that open and close in it.
    fn pass(&mut self, start: usize, end: usize, indent: usize) -> String {
        let mut code = String::new();
        let mut column = indent;
        for i in start..end {
            let piece = &self.pieces[i];
            if i > start && self.blank(i) {
                code.push(' ');
                column += 1;
            }
            if i > start
                && self.opened_by(i - 1)
                && let Some(open) = self.open.last_mut()
            {
                open.first = Some((column, piece.column));
            }
            code.push_str(piece.text);
            column += piece.text.chars().count();
            let Some(token) = piece.token() else { continue };
            let in_items = self
                .open
                .last()
                .is_none_or(|open| open.bracket == Bracket::Block);
            if in_items && self.marks.begins(token) && !matches!(piece.kind, PieceKind::Doc(_)) {
                self.item_indent = indent;
            }
            if let Some(bracket) = self.marks.opens(token) {
                let aligned = self.aligned(i, bracket);
                self.open.push(Open {
                    bracket,
                    line_indent: indent,
                    item_indent: self.item_indent,
                    first: None,
                    aligned,
                });
            } else if self.marks.closes(token)
                && let Some(open) = self.open.pop()
            {
                self.item_indent = open.item_indent;
            }
        }
        code
    }
}
