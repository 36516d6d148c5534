//! The message about text that the grammar does not accept.
//!
//! The recogniser knows only the farthest place that it reached and the rules that it tried there. A reader
//! needs the mistake behind this. So the tokens around that place are first compared with the likely
//! mistakes. Only if none fits, the message names the tried rules.

mod expected;
mod place;

use super::items::KINDS;
use super::{Builder, MAX_NESTING};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::grammar::{EngGrammar, Rule};
use crate::nearest::nearest_within;
use crate::span::Span;
use crate::tokens::{Token, TokenKind};
use expected::Failure;
use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};
use pest::iterators::Pairs;
pub(crate) use place::Place;

/// The message for a bad piece, and the place in it where good items begin again.
pub(crate) struct Finding {
    pub diagnostic: Diagnostic,
    pub rest: Option<usize>,
}

/// The number of line ends of a bad piece that are tried as the end of the mistake. A choice: each is parsed
/// again, and a mistake rarely reaches over more lines.
const MAX_SPLITS: usize = 8;

/// Words that begin an item and are not kinds.
pub const ITEM_WORDS: [&str; 27] = [
    "use",
    "dimension",
    "unit",
    "choice",
    "const",
    "param",
    "input",
    "let",
    "state",
    "field",
    "output",
    "fn",
    "table",
    "constrain",
    "branch",
    "start",
    "guess",
    "apply",
    "require",
    "advise",
    "accept",
    "resolve",
    "place",
    "der",
    "report",
    "figure",
    "value",
];

/// Whether this word can begin an item as more than a name.
fn is_item_word(word: &str) -> bool {
    ITEM_WORDS.contains(&word) || KINDS.iter().any(|(kind, _)| *kind == word)
}

/// Words that cannot be names.
fn is_reserved(word: &str) -> bool {
    matches!(
        word,
        "use"
            | "let"
            | "if"
            | "then"
            | "else"
            | "for"
            | "in"
            | "by"
            | "as"
            | "and"
            | "or"
            | "not"
            | "true"
            | "false"
    )
}

/// The tokens between two bytes.
fn tokens_of(tokens: &[Token], start: usize, end: usize) -> &[Token] {
    let first = tokens.partition_point(|token| token.start < start);
    let last = tokens.partition_point(|token| token.start < end);
    tokens.get(first..last).unwrap_or(&[])
}

/// Whether the token at `start` cannot begin an item, so that it must continue the item before.
pub(crate) fn continues(text: &str, tokens: &[Token], start: usize) -> bool {
    let Some(token) = tokens_of(tokens, start, text.len()).first() else {
        return false;
    };
    match token.kind {
        TokenKind::Word => {
            let word = token.text(text);
            is_reserved(word) && word != "use" && word != "let"
        }
        TokenKind::Doc => false,
        _ => true,
    }
}

/// The number of open `(` and `[` after `start..end`, if `open` are open before it.
pub(crate) fn open_brackets(
    text: &str,
    tokens: &[Token],
    start: usize,
    end: usize,
    open: usize,
) -> usize {
    tokens_of(tokens, start, end)
        .iter()
        .fold(open, |open, token| match token.text(text) {
            "(" | "[" => open + 1,
            ")" | "]" => open.saturating_sub(1),
            _ => open,
        })
}

/// Whether `start..end` is the head of a declaration or a function whose `{` is missing.
pub(crate) fn lacks_brace(text: &str, tokens: &[Token], start: usize, end: usize) -> bool {
    let tokens = tokens_of(tokens, start, end);
    let first = tokens.first().map_or("", |token| token.text(text));
    if first != "fn" && !KINDS.iter().any(|(kind, _)| *kind == first) {
        return false;
    }
    let mut depth = 0usize;
    for token in tokens {
        match token.text(text) {
            "(" | "[" => depth += 1,
            ")" | "]" => depth = depth.saturating_sub(1),
            "{" => return false,
            "=" if depth == 0 => return false,
            _ => {}
        }
    }
    true
}

/// The message for brackets nested past the limit.
pub(crate) fn nesting(builder: &Builder<'_, '_>) -> Option<Diagnostic> {
    let mut depth = 0usize;
    for token in &builder.tokens {
        match token.text(builder.text) {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MAX_NESTING {
            return Some(
                Diagnostic::error(codes::NESTED, "brackets are nested too deep")
                    .at(
                        builder.span(token.start, token.end),
                        format!("more than {MAX_NESTING} are open here"),
                    )
                    .with_help("name parts of it with `let`"),
            );
        }
    }
    None
}

/// Looks for a `{` without `}` in the whole text, and gives its message.
pub(crate) fn braces(builder: &mut Builder<'_, '_>) {
    let text = builder.text;
    let mut open: Vec<Token> = Vec::new();
    let mut suspect = None;
    for token in &builder.tokens {
        match token.text(text) {
            "{" => open.push(*token),
            "}" => {
                if let Some(opening) = open.pop()
                    && suspect.is_none()
                    && first_on_line(text, token.start)
                    && indent(text, token.start) < indent(text, opening.start)
                {
                    // A `}` further left than the line it closes was meant for an outer block.
                    suspect = Some((opening, *token));
                }
            }
            _ => {}
        }
    }
    let Some(innermost) = open.last().copied() else {
        return;
    };
    let (opening, closing) = match suspect {
        Some((opening, closing)) => (opening, Some(closing)),
        None => (innermost, None),
    };
    builder.open_brace = Some(innermost);
    let mut diagnostic = Diagnostic::error(codes::UNPAIRED, "this `{` is not closed").at(
        builder.span(opening.start, opening.end),
        "a `}` for this one is missing",
    );
    if let Some(closing) = closing {
        diagnostic = diagnostic.also(
            builder.span(closing.start, closing.end),
            "this one seems to belong to a block around it",
        );
    }
    builder.report(diagnostic);
}

fn line_start(text: &str, at: usize) -> usize {
    text.get(..at)
        .and_then(|before| before.rfind('\n'))
        .map_or(0, |newline| newline + 1)
}

fn first_on_line(text: &str, at: usize) -> bool {
    text.get(line_start(text, at)..at)
        .is_some_and(|before| before.trim().is_empty())
}

fn indent(text: &str, at: usize) -> usize {
    let line = text.get(line_start(text, at)..).unwrap_or("");
    line.len() - line.trim_start_matches([' ', '\t']).len()
}

/// The items of a slice that has nothing but items.
pub(crate) fn item_list(slice: &str) -> Option<Pairs<'_, Rule>> {
    let pairs = EngGrammar::parse(Rule::item_list, slice).ok()?;
    pairs.into_iter().next().map(|list| list.into_inner())
}

/// The mistake in the text `start..end`, which is no item.
pub(crate) fn item(builder: &Builder<'_, '_>, start: usize, end: usize) -> Option<Finding> {
    let text = builder.text;
    let tokens = tokens_of(&builder.tokens, start, end);
    let found = |diagnostic| {
        Some(Finding {
            diagnostic,
            rest: None,
        })
    };
    if let Some(diagnostic) = open_text(builder, tokens) {
        return found(diagnostic);
    }
    if let Some(brace) = builder.open_brace
        && (start..end).contains(&brace.start)
    {
        // This text already has its message.
        return None;
    }
    if continues_comment(text, start) {
        // So has this one, at the first of its lines.
        return None;
    }
    if let Some(diagnostic) = brackets(builder, tokens) {
        return found(diagnostic);
    }
    for line in line_starts(text, tokens).take(MAX_SPLITS) {
        let tail = text.get(line..end).unwrap_or("");
        let head = text.get(start..line).unwrap_or("");
        if EngGrammar::parse(Rule::item_list, tail).is_ok()
            && let Some(diagnostic) = item_failure(builder, start, head, tokens)
        {
            return Some(Finding {
                diagnostic,
                rest: Some(line),
            });
        }
    }
    let whole = text.get(start..end).unwrap_or("");
    if let Some(diagnostic) = item_failure(builder, start, whole, tokens) {
        return found(diagnostic);
    }
    let (from, to) = tokens
        .first()
        .map_or((start, end), |token| (token.start, token.end));
    found(
        Diagnostic::error(codes::UNEXPECTED, "this cannot be here")
            .at(builder.span(from, to), "no item begins like this"),
    )
}

/// Whether `//!` at `start` is a further line of such a comment, which is not at the head of the file.
fn continues_comment(text: &str, start: usize) -> bool {
    let before = text.get(..start).unwrap_or("").trim_end();
    let line = before.rfind('\n').map_or(0, |end| end + 1);
    let is_of_file =
        |part: Option<&str>| part.is_some_and(|part| part.trim_start().starts_with("//!"));
    is_of_file(text.get(start..)) && is_of_file(before.get(line..))
}

/// The first bytes of lines that begin outside of brackets, without the first line.
fn line_starts<'a>(text: &'a str, tokens: &'a [Token]) -> impl Iterator<Item = usize> + 'a {
    let mut depth = 0i32;
    tokens.windows(2).filter_map(move |pair| {
        let [before, here] = pair else { return None };
        match before.text(text) {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        let newline = text
            .get(before.end..here.start)
            .is_some_and(|between| between.contains('\n'));
        (depth == 0 && newline && here.kind == TokenKind::Word).then_some(here.start)
    })
}

/// A text without its second quote.
fn open_text(builder: &Builder<'_, '_>, tokens: &[Token]) -> Option<Diagnostic> {
    let token = tokens
        .iter()
        .find(|token| token.kind == TokenKind::OpenText)?;
    let end = token.start + token.text(builder.text).trim_end().len();
    Some(
        Diagnostic::error(codes::TEXT, "this text is not closed")
            .at(
                builder.span(token.start, end),
                "no `\"` before the end of the line",
            )
            .with_help("a text ends on its line; `\\n` is a line end in it"),
    )
}

/// A bracket without a partner.
fn brackets(builder: &Builder<'_, '_>, tokens: &[Token]) -> Option<Diagnostic> {
    let mut open: Vec<(&Token, &str)> = Vec::new();
    let unclosed = |token: &Token, sign: &str| {
        Diagnostic::error(codes::UNPAIRED, format!("this `{sign}` is not closed")).at(
            builder.span(token.start, token.end),
            format!("a `{}` for this one is missing", partner(sign)),
        )
    };
    for token in tokens {
        let sign = token.text(builder.text);
        match sign {
            "(" | "[" | "{" => open.push((token, sign)),
            ")" | "]" | "}" => match open.pop() {
                Some((_, opening)) if partner(opening) == sign => {}
                Some((opening, opening_sign)) => {
                    return Some(unclosed(opening, opening_sign).also(
                        builder.span(token.start, token.end),
                        format!("found `{sign}`"),
                    ));
                }
                None => {
                    return Some(
                        Diagnostic::error(codes::UNPAIRED, format!("this `{sign}` closes nothing"))
                            .at(
                                builder.span(token.start, token.end),
                                format!("no `{}` is open here", partner(sign)),
                            ),
                    );
                }
            },
            _ => {}
        }
    }
    let (opening, sign) = open.first()?;
    Some(unclosed(opening, sign))
}

fn partner(sign: &str) -> &'static str {
    match sign {
        "(" => ")",
        "[" => "]",
        "{" => "}",
        ")" => "(",
        "]" => "[",
        _ => "{",
    }
}

/// Reads `slice`, which begins at `start`, as one item, and gives the place where reading fails.
fn item_failure(
    builder: &Builder<'_, '_>,
    start: usize,
    slice: &str,
    tokens: &[Token],
) -> Option<Diagnostic> {
    let slice = slice.trim_end();
    let error = EngGrammar::parse(Rule::single_item, slice).err()?;
    let end = start + slice.len();
    let count = tokens.partition_point(|token| token.start < end);
    let tokens = tokens.get(..count).unwrap_or(tokens);
    if let Some(diagnostic) = first_word(builder, tokens) {
        return Some(diagnostic);
    }
    Some(Failure::new(builder, tokens, start + position(&error), rules(&error)).describe())
}

/// The reason why an expression could not be read. `rule` is the entry of the grammar that was used.
pub(crate) fn expression(builder: &Builder<'_, '_>, rule: Rule) -> Diagnostic {
    let text = builder.text;
    let tokens = &builder.tokens;
    if let Some(diagnostic) = open_text(builder, tokens).or_else(|| brackets(builder, tokens)) {
        return diagnostic;
    }
    match EngGrammar::parse(rule, text) {
        Err(error) => Failure::new(builder, tokens, position(&error), rules(&error)).describe(),
        Ok(_) => Diagnostic::error(codes::UNEXPECTED, "this is not an expression")
            .at(builder.span(0, text.len()), "here"),
    }
}

fn position(error: &pest::error::Error<Rule>) -> usize {
    match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    }
}

/// The rules tried at the place of the error; `None` if the guard of the stack stopped the parse.
fn rules(error: &pest::error::Error<Rule>) -> Option<Vec<Rule>> {
    match &error.variant {
        ErrorVariant::ParsingError { positives, .. } => Some(positives.clone()),
        ErrorVariant::CustomError { .. } => None,
    }
}

/// A first word that begins no item.
fn first_word(builder: &Builder<'_, '_>, tokens: &[Token]) -> Option<Diagnostic> {
    let mut tokens = tokens.iter().filter(|token| token.kind != TokenKind::Doc);
    let first = tokens.next()?;
    if first.kind != TokenKind::Word {
        return None;
    }
    let word = first.text(builder.text);
    let span = builder.span(first.start, first.end);
    if is_reserved(word) {
        let diagnostic =
            Diagnostic::error(codes::UNEXPECTED, format!("no item begins with `{word}`"))
                .at(span, "not expected here");
        return match word {
            "use" | "let" => None,
            "for" => Some(diagnostic.with_help(
                "repetition follows a name, `body rod[i in 1..4]`, or inside a list or a call",
            )),
            "if" => Some(diagnostic.with_help("`if` is a value: `let x = if c then a else b`")),
            _ => Some(diagnostic),
        };
    }
    if is_item_word(word) {
        return None;
    }
    let second = tokens.next()?;
    let same_line = builder
        .text
        .get(first.end..second.start)
        .is_some_and(|between| !between.is_empty() && !between.contains('\n'));
    let close = likely(word).is_some();
    let another_item = matches!(second.kind, TokenKind::Word | TokenKind::Text)
        && !is_reserved(second.text(builder.text));
    let value_follows = matches!(second.text(builder.text), "-" | "(" | "[" | "{")
        || second.kind == TokenKind::Number;
    (same_line && (another_item || (close && value_follows)))
        .then(|| unknown_kind(word, span, builder.place_of_items))
}

/// The item word that the user probably meant by `word`. Fewer letters may differ than in a name, because the words
/// are short, and the parser takes a text with such a word as an item.
fn nearest(word: &str) -> Option<&'static str> {
    let known = KINDS.iter().map(|(kind, _)| *kind).chain(ITEM_WORDS);
    nearest_within(&word.to_ascii_lowercase(), known, (word.len() / 3).max(1))
}

/// The item word behind another language's word or a slip.
fn likely(word: &str) -> Option<&'static str> {
    match word {
        "import" | "include" => Some("use"),
        "parameter" => Some("param"),
        "constant" => Some("const"),
        "function" | "def" => Some("fn"),
        "variable" | "var" => Some("let"),
        "ensure" | "assert" => Some("require"),
        "class" | "type" => Some("record"),
        _ => nearest(word),
    }
}

/// The message for a word in the place of a kind.
pub(crate) fn unknown_kind(word: &str, span: Span, place: Place) -> Diagnostic {
    if word == "der" {
        return Diagnostic::error(codes::UNEXPECTED, "expected `(` after `der`")
            .at(span, "needs a state in parentheses")
            .with_help("the rate of a state `x` is given by `der(x) = …`");
    }
    let diagnostic = Diagnostic::error(
        codes::NO_SUCH_KIND,
        format!("there is no kind of item `{word}`"),
    )
    .at(span, "not a kind");
    match likely(word) {
        Some(known) => diagnostic.meant(span, known),
        None => {
            let words: Vec<String> = place
                .words()
                .iter()
                .map(|word| format!("`{word}`"))
                .collect();
            diagnostic.with_help(format!(
                "{} an item begins with {}",
                place.text(),
                words.join(", ")
            ))
        }
    }
}
