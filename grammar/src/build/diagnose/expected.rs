//! The mistake at the place where the recogniser stopped.

use super::{is_item_word, is_reserved};
use crate::build::Builder;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::grammar::Rule;
use crate::tokens::{Token, TokenKind};

const EXPONENT: &str = "the exponent of a unit is a whole number or a ratio: `m^2`, `m^(1/2)`";

/// The farthest place of the recogniser, the tokens around it, and the rules that it tried there.
pub(super) struct Failure<'b> {
    builder: &'b Builder<'b, 'b>,
    text: &'b str,
    tokens: &'b [Token],
    /// Index of the first token that it did not accept; past the end if the text is too short.
    at: usize,
    /// `None` when the recogniser ran out of stack.
    rules: Option<Vec<Rule>>,
}

impl<'b> Failure<'b> {
    /// `position` is in bytes of the builder's text.
    pub fn new(
        builder: &'b Builder<'_, '_>,
        tokens: &'b [Token],
        position: usize,
        rules: Option<Vec<Rule>>,
    ) -> Failure<'b> {
        Failure {
            builder,
            text: builder.text,
            tokens,
            at: tokens.partition_point(|token| token.end <= position),
            rules,
        }
    }

    fn token(&self, index: usize) -> Option<&'b Token> {
        self.tokens.get(index)
    }

    fn word(&self, index: usize) -> &'b str {
        self.token(index).map_or("", |token| token.text(self.text))
    }

    fn found(&self) -> &'b str {
        self.word(self.at)
    }

    fn before(&self) -> Option<&'b Token> {
        self.at.checked_sub(1).and_then(|at| self.token(at))
    }

    fn before_text(&self) -> &'b str {
        self.before().map_or("", |token| token.text(self.text))
    }

    fn tried(&self, rules: &[Rule]) -> bool {
        self.rules
            .as_ref()
            .is_some_and(|tried| tried.iter().any(|rule| rules.contains(rule)))
    }

    /// The place of the mistake: the token found, or the end of the last one.
    fn span(&self) -> crate::span::Span {
        match (self.token(self.at), self.before()) {
            (Some(token), _) => self.builder.span(token.start, token.end),
            (None, Some(token)) => self.builder.span(token.start, token.end),
            (None, None) => self.builder.span(0, self.text.len()),
        }
    }

    /// The message.
    pub fn describe(&self) -> Diagnostic {
        if self.rules.is_none() {
            return Diagnostic::error(codes::NESTED, "this is nested too deep")
                .at(self.span(), "in here")
                .with_help("name parts of it with `let`");
        }
        self.comma_in_number()
            .or_else(|| self.dot_in_unit())
            .or_else(|| self.colon_in_range())
            .or_else(|| self.index_without_binder())
            .or_else(|| self.malformed_number())
            .or_else(|| self.strange())
            .or_else(|| self.foreign_operator())
            .or_else(|| self.unit_of_condition())
            .or_else(|| self.equals())
            .or_else(|| self.spaced_bracket())
            .or_else(|| self.reserved_name())
            .or_else(|| self.conditional())
            .or_else(|| self.doc_comment())
            .or_else(|| self.lost_value())
            .unwrap_or_else(|| self.expected())
    }

    /// `1.`, `.5`, `1_000`, `m^0.5`, `1.2.3`.
    fn malformed_number(&self) -> Option<Diagnostic> {
        let here = self.token(self.at)?;
        if self.before_text() == "^" && here.kind == TokenKind::Number {
            return Some(
                Diagnostic::error(codes::NUMBER, "this exponent cannot be used")
                    .at(self.span(), "not a whole number")
                    .with_help(EXPONENT),
            );
        }
        let touches = |a: &Token, b: &Token| a.end == b.start;
        let next = self.token(self.at + 1);
        if let Some(before) = self.before()
            && touches(before, here)
        {
            let number = before.kind == TokenKind::Number;
            if number && (here.text(self.text) == "." || here.kind == TokenKind::Number) {
                let end = next.filter(|next| touches(here, next)).unwrap_or(here).end;
                let whole = self.builder.span(before.start, end);
                return Some(
                    Diagnostic::error(codes::NUMBER, "this number is malformed")
                        .at(whole, "not a number")
                        .with_help("write digits on both sides of the point: `1.0`, `0.5`"),
                );
            }
            if number && here.text(self.text).starts_with('_') {
                let digits: String = self
                    .text
                    .get(before.start..here.end)
                    .unwrap_or("")
                    .chars()
                    .filter(|character| *character != '_')
                    .collect();
                let whole = self.builder.span(before.start, here.end);
                return Some(
                    Diagnostic::error(codes::NUMBER, "this number is malformed")
                        .at(whole, "digits are not grouped")
                        .with_fix("join the digits", whole, digits),
                );
            }
        }
        if here.text(self.text) == "."
            && let Some(next) = next
            && next.kind == TokenKind::Number
            && touches(here, next)
        {
            let whole = self.builder.span(here.start, next.end);
            return Some(
                Diagnostic::error(codes::NUMBER, "this number is malformed")
                    .at(whole, "no digit before the point")
                    .with_fix(
                        "write the zero",
                        self.builder.span(here.start, here.start),
                        "0",
                    ),
            );
        }
        None
    }

    /// The token at the place with both neighbours, if no blank separates the three.
    fn joined(&self) -> Option<[&'b Token; 3]> {
        let (before, here) = (self.before()?, self.token(self.at)?);
        let next = self.token(self.at + 1)?;
        (before.end == here.start && here.end == next.start).then_some([before, here, next])
    }

    /// `0,62 kg`.
    fn comma_in_number(&self) -> Option<Diagnostic> {
        let [before, here, next] = self.joined()?;
        let numbers = before.kind == TokenKind::Number && next.kind == TokenKind::Number;
        (self.found() == "," && numbers).then(|| {
            Diagnostic::error(codes::NUMBER, "a decimal fraction is written with a point")
                .at(self.builder.span(before.start, next.end), "not a number")
                .with_fix(
                    "write a point",
                    self.builder.span(here.start, here.end),
                    ".",
                )
        })
    }

    /// `4 N.m`.
    fn dot_in_unit(&self) -> Option<Diagnostic> {
        let [before, here, next] = self.joined()?;
        let words = before.kind == TokenKind::Word && next.kind == TokenKind::Word;
        if self.found() != "." || !words {
            return None;
        }
        // search back over the unit for its number, list or parenthesis
        let first = (0..self.at).rev().find(|index| {
            let token = self.token(*index);
            let text = self.word(*index);
            let of_unit = token.is_some_and(|token| token.kind == TokenKind::Word)
                || matches!(text, "*" | "/" | "^");
            !of_unit
        })?;
        let scaled = self
            .token(first)
            .is_some_and(|token| token.kind == TokenKind::Number)
            || matches!(self.word(first), ")" | "]");
        (scaled && self.word(first + 1) != "*" && self.word(first + 1) != "/").then(|| {
            Diagnostic::error(codes::NUMBER, "a product of units is written with `*`")
                .at(self.span(), "not in a unit")
                .with_fix("write `*`", self.builder.span(here.start, here.end), "*")
        })
    }

    /// `i in 1:4`.
    fn colon_in_range(&self) -> Option<Diagnostic> {
        let here = self.token(self.at)?;
        let (open, sign) = self.inside()?;
        let binds = self
            .tokens
            .iter()
            .take(self.at)
            .any(|token| token.start > open.start && token.text(self.text) == "in");
        (self.found() == ":" && (sign == "[" || (sign == "(" && binds))).then(|| {
            Diagnostic::error(codes::UNEXPECTED, "a range is written with `..`")
                .at(self.span(), "for instance `1..4`")
                .with_fix("write `..`", self.builder.span(here.start, here.end), "..")
        })
    }

    /// `marker main[4] = …`.
    fn index_without_binder(&self) -> Option<Diagnostic> {
        let here = self.token(self.at)?;
        if self.before_text() != "[" || !self.tried(&[Rule::name, Rule::binder]) {
            return None;
        }
        let diagnostic = Diagnostic::error(
            codes::UNEXPECTED,
            "an index of a declaration names a variable and its values",
        )
        .at(self.span(), "expected, for instance, `i in 1..4`");
        let counts = here.kind == TokenKind::Number && self.word(self.at + 1) == "]";
        Some(if counts {
            let whole = self.builder.span(here.start, here.end);
            diagnostic.with_fix(
                format!("for {} of them", self.found()),
                whole,
                format!("i in 1..{}", self.found()),
            )
        } else {
            diagnostic
        })
    }

    /// A character that is no part of the language.
    fn strange(&self) -> Option<Diagnostic> {
        let token = self.token(self.at)?;
        if token.kind != TokenKind::Strange {
            return None;
        }
        let shown = token.text(self.text);
        let span = self.span();
        let invisible = shown
            .chars()
            .all(|c| !matches!(c, '\'' | '"' | '\\') && c.escape_debug().len() > 1);
        let name = match invisible {
            true => format!("the invisible character {}", shown.escape_debug()),
            false => format!("`{shown}`"),
        };
        let diagnostic = Diagnostic::error(codes::UNEXPECTED, format!("{name} is not used in Eng"))
            .at(span, "not expected here");
        Some(match shown {
            _ if invisible && shown.chars().all(char::is_whitespace) => {
                diagnostic.with_fix("write a plain space", span, " ")
            }
            _ if invisible => diagnostic.with_fix("remove it", span, ""),
            "\u{b5}" | "\u{3bc}" => diagnostic
                .with_help("micro is written `u`: `um`, `us`")
                .with_fix("write `u`", span, "u"),
            "\u{b0}" => diagnostic.with_help("degrees are `deg` (angle) and `degC` (temperature)"),
            "\u{d7}" | "\u{b7}" | "\u{22c5}" => diagnostic.with_fix("multiply with `*`", span, "*"),
            "\u{2212}" | "\u{2013}" => diagnostic.with_fix("write a minus sign", span, "-"),
            "\u{b2}" => diagnostic.with_fix("write `^2`", span, "^2"),
            "\u{b3}" => diagnostic.with_fix("write `^3`", span, "^3"),
            "\u{201c}" | "\u{201d}" | "'" | "`" => diagnostic.with_help("write a text in `\"`"),
            "!" => diagnostic.with_help("write `not`"),
            "&" => diagnostic.with_help("write `and`"),
            "|" => diagnostic.with_help("write `or`"),
            "#" => diagnostic.with_help("a comment begins with `//`"),
            "?" => diagnostic.with_help("a value of two cases is `if condition then a else b`"),
            _ => diagnostic.with_help("names use the letters a to z, digits and `_`"),
        })
    }

    /// `**`, `+=`.
    fn foreign_operator(&self) -> Option<Diagnostic> {
        let span = self.span();
        if self.found() == "**" {
            return Some(
                Diagnostic::error(codes::UNEXPECTED, "`**` is not used in Eng")
                    .at(span, "a power is written `^`")
                    .with_fix("write `^`", span, "^"),
            );
        }
        let sign = |text: &str| matches!(text, "+" | "-" | "*" | "/");
        let assigns = (self.found() == "=" && sign(self.before_text()))
            || (sign(self.found()) && self.word(self.at + 1) == "=");
        assigns.then(|| {
            Diagnostic::error(codes::UNEXPECTED, "a name keeps its value in Eng")
                .at(span, "not expected here")
                .with_help("give each value its own name")
        })
    }

    /// `constrain a = b`, `mass == 3 kg`.
    fn equals(&self) -> Option<Diagnostic> {
        let span = self.span();
        let first = self
            .tokens
            .iter()
            .find(|token| token.kind != TokenKind::Doc)
            .map_or("", |token| token.text(self.text));
        if self.found() == "="
            && (matches!(first, "constrain" | "branch" | "require" | "advise")
                || self.inside().is_some_and(|(_, sign)| sign != "{"))
        {
            let named = self.inside().is_some_and(|(_, sign)| sign == "(")
                && first != "constrain"
                && first != "require"
                && first != "branch"
                && first != "advise";
            return Some(if named {
                Diagnostic::error(codes::UNEXPECTED, "a named argument is written with `:`")
                    .at(span, "expected `:`")
                    .with_fix("write `:`", span, ":")
            } else {
                Diagnostic::error(codes::UNEXPECTED, "a comparison is written `==`")
                    .at(span, "`=` gives a name its value")
                    .with_fix("compare", span, "==")
            });
        }
        (self.found() == "==" && self.tried(&[Rule::assign])).then(|| {
            Diagnostic::error(codes::UNEXPECTED, "a value is given with `=`")
                .at(span, "`==` compares")
                .with_fix("write `=`", span, "=")
        })
    }

    /// `f (x)`, `a [1]`.
    fn spaced_bracket(&self) -> Option<Diagnostic> {
        let sign = self.found();
        let before = self.before()?;
        let here = self.token(self.at)?;
        let gap = self.text.get(before.end..here.start)?;
        let callable = before.kind == TokenKind::Word && !is_reserved(self.before_text())
            || matches!(self.before_text(), ")" | "]");
        if !matches!(sign, "(" | "[") || gap.is_empty() || !callable {
            return None;
        }
        let what = if sign == "(" { "a call" } else { "an index" };
        Some(
            Diagnostic::error(
                codes::SPACE_BEFORE_BRACKET,
                format!("a space before the `{sign}` of {what}"),
            )
            .at(self.span(), format!("must touch `{}`", self.before_text()))
            .with_fix(
                "remove the space",
                self.builder.span(before.end, here.start),
                "",
            ),
        )
    }

    /// `param in = …`.
    fn reserved_name(&self) -> Option<Diagnostic> {
        let found = self.found();
        let name_due = self.tried(&[
            Rule::name,
            Rule::unit_def_name,
            Rule::binder,
            Rule::parameter,
            Rule::field,
        ]);
        let after = self.before_text();
        (is_reserved(found) && name_due && (is_item_word(after) || matches!(after, "." | "for")))
            .then(|| {
                Diagnostic::error(codes::UNEXPECTED, format!("`{found}` cannot be a name"))
                    .at(self.span(), "a word of the language")
            })
    }

    /// The words and signs before the mistake, without comments.
    fn read(&self) -> impl Iterator<Item = &'b str> + use<'_, 'b> {
        let tokens = self.tokens.iter().take(self.at);
        tokens
            .filter(|token| token.kind != TokenKind::Doc)
            .map(|token| token.text(self.text))
    }

    /// `marker z if l > 2 mm = …`: the unit does not end before `=`. `part x if a and = …`: half of a condition.
    fn unit_of_condition(&self) -> Option<Diagnostic> {
        if self.found() != "=" || self.read().any(|word| word == "=" || word == "then") {
            return None;
        }
        let start = self
            .tokens
            .iter()
            .position(|token| token.text(self.text) == "if")?;
        let (first, last) = (self.token(start + 1)?, self.before()?);
        if start + 1 >= self.at || last.kind != TokenKind::Word {
            return None;
        }
        let word = self.before_text();
        if matches!(word, "and" | "or" | "not") {
            return Some(self.say("a condition"));
        }
        if is_reserved(word) || !self.ends_with_unit() {
            return None;
        }
        let condition = self.builder.span(first.start, last.end);
        let written = self.text.get(first.start..last.end).unwrap_or_default();
        Some(
            Diagnostic::error(
                codes::UNEXPECTED,
                "a condition that ends with a unit needs parentheses",
            )
            .at(condition, "without them the end of the unit is not clear")
            .with_fix("add the parentheses", condition, format!("({written})")),
        )
    }

    /// Whether a number or a bracket and then only the words and signs of a unit stand before the mistake: `2 N*m`.
    fn ends_with_unit(&self) -> bool {
        let before = self.tokens.iter().take(self.at).rev();
        let mut before = before.skip_while(|token| {
            token.kind == TokenKind::Word && !is_reserved(token.text(self.text))
                || matches!(token.text(self.text), "*" | "/" | "^")
        });
        before.next().is_some_and(|token| {
            token.kind == TokenKind::Number || matches!(token.text(self.text), ")" | "]")
        })
    }

    /// `a + if …`, `if` without `then` or `else`, `require` without `else`.
    fn conditional(&self) -> Option<Diagnostic> {
        let span = self.span();
        if self.found() == "if" && !self.read().any(|word| word == "=") {
            let item = self.read().next().unwrap_or_default();
            let values = [
                "output", "let", "const", "param", "input", "state", "table", "analysis",
            ];
            if values.contains(&item) {
                let message = Diagnostic::error(codes::UNEXPECTED, "only parts have a condition")
                    .at(span, format!("`{item}` has none"))
                    .with_help(
                        "bodies, markers, joints, forces, journals, drives and parts may have one",
                    );
                return Some(match item {
                    "output" => message.with_help("an output of parts that may be absent takes an index over a range that may be empty: `output x[k in 1..count] = …`"),
                    _ => message,
                });
            }
        }
        if self.found() == "if" {
            return Some(
                Diagnostic::error(
                    codes::UNEXPECTED,
                    "an `if` inside a larger value needs parentheses",
                )
                .at(span, "expected `(if … then … else …)`"),
            );
        }
        let ends = self.token(self.at).is_none() || self.new_line();
        if self.tried(&[Rule::word_then]) {
            return Some(self.say("`then`"));
        }
        if self.tried(&[Rule::word_else]) && ends {
            let first = self.word(0);
            return Some(
                if matches!(first, "require" | "advise") && self.inside().is_none() {
                    self.say("`else \"…\"`")
                        .with_help("write the message that is shown if the condition does not hold")
                } else {
                    self.say("`else`")
                        .with_help("`if` is a value, so it needs both sides")
                },
            );
        }
        None
    }

    /// A `///` at a place without an item to document.
    fn doc_comment(&self) -> Option<Diagnostic> {
        let token = self.token(self.at)?;
        (token.kind == TokenKind::Doc).then(|| {
            Diagnostic::error(codes::UNEXPECTED, "this comment documents no item")
                .at(self.span(), "not before an item or a parameter")
                .with_help("`//` begins a plain comment; `//!` is for the head of the file")
                .with_fix(
                    "make it a plain comment",
                    self.builder.span(token.start, token.start + 3),
                    "//",
                )
        })
    }

    /// A function's block without a value at its end.
    fn lost_value(&self) -> Option<Diagnostic> {
        let complete = self.before().is_some_and(|before| {
            before.kind != TokenKind::Sign || matches!(self.before_text(), ")" | "]" | "}" | "{")
        });
        (complete && self.word(0) == "fn" && self.found() == "}" && self.tried_value()).then(|| {
            Diagnostic::error(codes::UNEXPECTED, "a function's block ends with its value")
                .at(self.span(), "expected a value before this")
                .with_help(
                    "a line that begins with `-` or `[` continues the line before; end that one with `;`",
                )
        })
    }

    fn new_line(&self) -> bool {
        match (self.before(), self.token(self.at)) {
            (Some(before), Some(here)) => self
                .text
                .get(before.end..here.start)
                .is_some_and(|between| between.contains('\n')),
            _ => false,
        }
    }

    /// The innermost bracket that is open at the place.
    fn inside(&self) -> Option<(&'b Token, &'b str)> {
        let mut open = Vec::new();
        for token in self.tokens.iter().take(self.at) {
            let sign = token.text(self.text);
            match sign {
                "(" | "[" | "{" => open.push((token, sign)),
                ")" | "]" | "}" => {
                    open.pop();
                }
                _ => {}
            }
        }
        open.pop()
    }

    fn tried_value(&self) -> bool {
        self.tried(&[
            Rule::expression,
            Rule::conditional,
            Rule::postfix,
            Rule::quantity,
            Rule::scaled_list,
            Rule::scaled_paren,
            Rule::number,
            Rule::list,
            Rule::paren,
            Rule::boolean,
            Rule::argument,
            Rule::place,
        ])
    }

    /// The tried rules, in words.
    fn expected(&self) -> Diagnostic {
        if self.tried_value() {
            return self.say("a value");
        }
        if self.tried(&[
            Rule::type_expression,
            Rule::type_product,
            Rule::type_power,
            Rule::type_one,
            Rule::function_type,
            Rule::type_generic,
        ]) {
            return self.say("a type");
        }
        if self.tried(&[
            Rule::unit,
            Rule::unit_name,
            Rule::unit_factor,
            Rule::display_unit,
        ]) && self.before_text() == "as"
        {
            return self.say("a unit");
        }
        if self.tried(&[Rule::exponent, Rule::integer, Rule::digits]) && self.before_text() == "^" {
            return self.say("a whole number or a ratio in parentheses");
        }
        if self.word(0) == "der" && self.at < 5 && matches!(self.found(), "(" | ".") {
            return Diagnostic::error(
                codes::UNEXPECTED,
                "`der( )` on the left takes the name of a state",
            )
            .at(self.span(), "expected `der(name) = …`");
        }
        if self.tried(&[Rule::wrench_kind]) {
            return self.say("`force` or `torque`");
        }
        if self.tried(&[Rule::close_angle, Rule::close_brace]) && self.tried(&[Rule::comma]) {
            return self.say(if self.tried(&[Rule::close_angle]) {
                "`,` or `>`"
            } else {
                "`,` or `}`"
            });
        }
        if let Some((_, sign)) = self.inside()
            && sign != "{"
            && self.tried(&[Rule::comma, Rule::infix])
        {
            let close = if sign == "(" { ")" } else { "]" };
            return self.say(&format!("`,` or `{close}`"));
        }
        let mut words: Vec<&str> = Vec::new();
        let known: [(Rule, &str); 20] = [
            (Rule::parameters, "`(`"),
            (Rule::colon, "`:`"),
            (Rule::arrow, "`->`"),
            (Rule::assign, "`=`"),
            (Rule::block, "`{`"),
            (Rule::plain_form, "`{`"),
            (Rule::class_form, "`(`"),
            (Rule::instance_form, "`=`"),
            (Rule::function_block, "`{`"),
            (Rule::word_in, "`in`"),
            (Rule::word_on, "`on`"),
            (Rule::word_then, "`then`"),
            (Rule::word_else, "`else`"),
            (Rule::string, "a text in quotes"),
            (Rule::name, "a name"),
            (Rule::binder, "`name in range`"),
            (Rule::unit_def_name, "a name"),
            (Rule::parameter, "`name: Type`"),
            (Rule::use_list, "`{`"),
            (Rule::use_all, "`*`"),
        ];
        for (rule, word) in known {
            let optional = rule == Rule::word_in && self.tried(&[Rule::assign, Rule::word_as]);
            if self.tried(&[rule]) && !words.contains(&word) && !optional {
                words.push(word);
            }
        }
        // If an operator was possible, the item could also have ended.
        let complete = self.tried(&[Rule::infix, Rule::EOI]);
        match words.as_slice() {
            [] => self.unexpected(),
            _ if complete && !self.tried(&[Rule::word_in, Rule::word_on, Rule::assign]) => {
                self.unexpected()
            }
            [one] => self.say(one),
            [first @ .., last] => self.say(&format!("{} or {last}", first.join(", "))),
        }
    }

    fn unexpected(&self) -> Diagnostic {
        match self.token(self.at) {
            Some(token) => {
                let sign = self.found();
                let after_name = self
                    .before()
                    .is_some_and(|before| before.kind == TokenKind::Word);
                let diagnostic = Diagnostic::error(
                    codes::UNEXPECTED,
                    format!("unexpected `{}`", shortened(sign)),
                )
                .at(self.span(), "cannot be here");
                if matches!(sign, "(" | "[") {
                    diagnostic.with_help(format!(
                        "the `{sign}` of a call or an index follows its name on the same line, without a space"
                    ))
                } else if after_name && token.kind == TokenKind::Word && !self.new_line() {
                    diagnostic.with_help(
                        "a unit follows a number, a list or a parenthesis: `(width) mm`; an item ends at the line's end or at `;`",
                    )
                } else {
                    diagnostic.with_help("an item ends at the line's end or at `;`")
                }
            }
            None => Diagnostic::error(codes::UNEXPECTED, "this item is not complete")
                .at(self.span(), "it ends here"),
        }
    }

    /// The message "expected …", with the text that is there instead.
    fn say(&self, what: &str) -> Diagnostic {
        let after = match self.before() {
            Some(before) => format!(" after `{}`", shortened(before.text(self.text))),
            None => String::new(),
        };
        let label = match self.token(self.at) {
            Some(token) => format!("found `{}`", shortened(token.text(self.text))),
            None => "nothing follows".to_string(),
        };
        Diagnostic::error(codes::UNEXPECTED, format!("expected {what}{after}"))
            .at(self.span(), label)
    }
}

/// A token's text, cut to a length that fits a title.
fn shortened(text: &str) -> String {
    // a choice: the title then still fits in a line
    const LONGEST: usize = 24;
    if text.chars().count() <= LONGEST {
        text.to_string()
    } else {
        let head: String = text.chars().take(LONGEST).collect();
        format!("{head}…")
    }
}
