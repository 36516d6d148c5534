//! The facts of the tree that decide gaps and indents, for each token.

use super::range;
use crate::grammar::Rule;
use crate::tokens::{Token, TokenKind};
use pest::iterators::{Pair, Pairs};

/// The kinds of brackets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bracket {
    /// Braces around items.
    Block,
    /// Braces around names of a `use`.
    Names,
    /// Parentheses around the parameters of a class or a function.
    Parameters,
    /// Parentheses and brackets of an expression.
    Group,
}

/// The facts about the tokens of a text.
pub(super) struct Marks<'t> {
    /// The characters of each token.
    words: Vec<&'t str>,
    kinds: Vec<TokenKind>,
    /// Whether a blank is before the token, where the tree decides it.
    blank: Vec<Option<bool>>,
    /// Parts of units.
    unit: Vec<bool>,
    /// First tokens of items, and of the parts of a function's block.
    begins: Vec<bool>,
    /// Operators between two operands.
    infix: Vec<bool>,
    opens: Vec<Option<Bracket>>,
    closes: Vec<bool>,
    /// For an opening bracket the token that closes it.
    partner: Vec<usize>,
}

impl<'t> Marks<'t> {
    pub fn of(text: &'t str, tokens: &[Token], pairs: Pairs<'_, Rule>) -> Marks<'t> {
        let count = tokens.len();
        let mut marks = Marks {
            words: tokens.iter().map(|token| token.text(text)).collect(),
            kinds: tokens.iter().map(|token| token.kind).collect(),
            blank: vec![None; count],
            unit: vec![false; count],
            begins: vec![false; count],
            infix: vec![false; count],
            opens: vec![None; count],
            closes: vec![false; count],
            partner: vec![count; count],
        };
        marks.brackets();
        for pair in pairs.clone().flatten() {
            let span = pair.as_span();
            let (from, to) = range(tokens, span.start(), span.end());
            marks.rule(&pair, from, to, tokens);
        }
        // operators need to know all units
        for pair in pairs.flatten() {
            if pair.as_rule() == Rule::expression {
                marks.operators(pair, tokens);
            }
        }
        marks
    }

    /// Pairs of brackets.
    fn brackets(&mut self) {
        let mut open = Vec::new();
        for token in 0..self.words.len() {
            if self.kinds[token] != TokenKind::Sign {
                continue;
            }
            match self.words[token] {
                "(" | "[" | "{" => {
                    self.opens[token] = Some(Bracket::Group);
                    open.push(token);
                }
                ")" | "]" | "}" => {
                    self.closes[token] = true;
                    if let Some(opened) = open.pop() {
                        self.partner[opened] = token;
                    }
                }
                _ => {}
            }
        }
    }

    fn set(&mut self, token: usize, blank: bool) {
        if let Some(place) = self.blank.get_mut(token) {
            *place = Some(blank);
        }
    }

    fn open(&mut self, token: usize, bracket: Bracket) {
        if let Some(place) = self.opens.get_mut(token) {
            *place = Some(bracket);
        }
    }

    fn begin(&mut self, pair: &Pair<'_, Rule>, tokens: &[Token]) {
        let span = pair.as_span();
        let (from, _) = range(tokens, span.start(), span.end());
        if let Some(place) = self.begins.get_mut(from) {
            *place = true;
        }
    }

    /// The facts that one rule gives about its tokens `from..to`.
    fn rule(&mut self, pair: &Pair<'_, Rule>, from: usize, to: usize, tokens: &[Token]) {
        match pair.as_rule() {
            Rule::item => {
                let parts = pair.clone().into_inner();
                for part in parts.filter(|part| part.as_rule() != Rule::doc) {
                    self.begin(&part, tokens);
                }
            }
            Rule::block => self.open(from, Bracket::Block),
            Rule::function_block => {
                self.open(from, Bracket::Block);
                for part in pair.clone().into_inner() {
                    self.begin(&part, tokens);
                }
            }
            Rule::use_list => {
                self.open(from, Bracket::Names);
                self.set(from + 1, false);
                self.set(to.saturating_sub(1), false);
            }
            Rule::parameters => {
                self.open(from, Bracket::Parameters);
                self.set(from, false);
            }
            Rule::call | Rule::subscript | Rule::index | Rule::type_array => self.set(from, false),
            // `der(`, `fn(`
            Rule::rate | Rule::function_type => self.set(from + 1, false),
            Rule::class_form | Rule::plain_form => {
                let parts = pair.clone().into_inner();
                for colon in parts.filter(|part| part.as_rule() == Rule::colon) {
                    let span = colon.as_span();
                    let (at, _) = range(tokens, span.start(), span.end());
                    self.set(at, true);
                }
            }
            Rule::unit_after | Rule::display_unit => {
                for token in from..to {
                    self.unit[token] = true;
                    if token > from {
                        self.set(token, false);
                    }
                }
            }
            Rule::exponent => {
                // with the `^` before it
                for token in from.saturating_sub(1)..to {
                    self.set(token, false);
                }
            }
            Rule::type_operator => {
                self.set(from, false);
                self.set(from + 1, false);
            }
            Rule::type_generic | Rule::generics => self.angles(pair, from),
            Rule::prefix if self.words.get(from) == Some(&"-") => self.set(from + 1, false),
            _ => {}
        }
    }

    /// `<` and `>` of a list of types or of dimensions.
    fn angles(&mut self, pair: &Pair<'_, Rule>, from: usize) {
        let open = if pair.as_rule() == Rule::generics {
            from
        } else {
            from + 1
        };
        self.set(open, false);
        self.set(open + 1, false);
        let mut depth = 0usize;
        for token in open..self.words.len() {
            match self.words[token] {
                "<" => depth += 1,
                ">" => {
                    depth -= 1;
                    if depth == 0 {
                        self.set(token, false);
                        break;
                    }
                }
                _ => {}
            }
        }
    }

    /// Blanks around the operators of one expression. `*`, `/`, `^` have none, and neither has `..` between plain
    /// bounds. After a unit, blanks around `*`, `/`, `^` mean the end of the unit. There a product stays as written.
    fn operators(&mut self, pair: Pair<'_, Rule>, tokens: &[Token]) {
        let (_, end_of_all) = range(tokens, pair.as_span().start(), pair.as_span().end());
        let operators: Vec<usize> = pair
            .into_inner()
            .filter(|part| part.as_rule() == Rule::infix)
            .map(|part| range(tokens, part.as_span().start(), part.as_span().end()).0)
            .collect();
        let written = |token: usize| {
            let gap = |left: usize, right: usize| match (tokens.get(left), tokens.get(right)) {
                (Some(left), Some(right)) => left.end < right.start,
                _ => false,
            };
            gap(token.saturating_sub(1), token) || gap(token, token + 1)
        };
        let product = |word: &str| matches!(word, "*" | "/" | "^");
        let mut at = 0;
        while let Some(&first) = operators.get(at) {
            self.infix[first] = true;
            let word = self.words[first];
            if !product(word) {
                if word == ".." {
                    let wide = self.wide_range(&operators, at, end_of_all);
                    self.set(first, wide);
                    self.set(first + 1, wide);
                }
                at += 1;
                continue;
            }
            let end = operators[at..]
                .iter()
                .position(|operator| !product(self.words[*operator]))
                .map_or(operators.len(), |length| at + length);
            let chain = &operators[at..end];
            let kept = chain.iter().any(|&operator| {
                let factor = self.kinds.get(operator + 1) == Some(&TokenKind::Word)
                    || self.is_sign(operator + 1, "(")
                    || self.words[operator] == "^";
                operator > 0 && self.unit[operator - 1] && factor && written(operator)
            });
            for &operator in chain {
                let blank = kept && written(operator);
                self.infix[operator] = true;
                self.set(operator, blank);
                self.set(operator + 1, blank);
            }
            at = end;
        }
    }

    /// Whether a bound of the range at this operator ends with a unit.
    fn wide_range(&self, operators: &[usize], at: usize, end_of_all: usize) -> bool {
        let here = operators.get(at).copied().unwrap_or(0);
        let behind = operators.get(at + 1).copied().unwrap_or(end_of_all);
        let unit = |behind: usize| {
            let last = behind.checked_sub(1).and_then(|last| self.unit.get(last));
            last.copied().unwrap_or(false)
        };
        unit(here) || unit(behind)
    }

    /// The word of a token.
    pub fn word(&self, token: usize) -> &'t str {
        self.words.get(token).copied().unwrap_or("")
    }

    pub fn begins(&self, token: usize) -> bool {
        self.begins.get(token).copied().unwrap_or(false) || self.is_sign(token, ";")
    }

    pub fn infix(&self, token: usize) -> bool {
        self.infix.get(token).copied().unwrap_or(false)
    }

    pub fn opens(&self, token: usize) -> Option<Bracket> {
        self.opens.get(token).copied().flatten()
    }

    pub fn closes(&self, token: usize) -> bool {
        self.closes.get(token).copied().unwrap_or(false)
    }

    /// The token that closes this bracket.
    pub fn partner(&self, token: usize) -> usize {
        self.partner.get(token).copied().unwrap_or(self.words.len())
    }

    pub fn is_text(&self, token: usize) -> bool {
        self.kinds.get(token) == Some(&TokenKind::Text)
    }

    pub fn is_sign(&self, token: usize, sign: &str) -> bool {
        self.kinds.get(token) == Some(&TokenKind::Sign) && self.word(token) == sign
    }

    /// Whether a blank is between a token and the one before it.
    pub fn blank_before(&self, token: usize) -> bool {
        let Some(before) = token.checked_sub(1) else {
            return false;
        };
        if let Some(Some(blank)) = self.blank.get(token) {
            return *blank;
        }
        let sign = |token: usize| match self.kinds.get(token) {
            Some(TokenKind::Sign) => self.word(token),
            _ => "",
        };
        let tight = matches!(
            (sign(before), sign(token)),
            ("(" | "[" | ".", _) | (_, ")" | "]" | "." | "," | ";" | ":") | ("{", "}")
        );
        !tight
    }
}
