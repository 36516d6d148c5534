//! Choices: `choice End = timing_end | driving_end`, their words, and `if` chains over all words.

use super::Checker;
use super::scope::{Found, Scope};
use super::types::Type;
use crate::codes;
use crate::program::DefinitionId;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{BinaryOp, Choice, Expr, ExprKind, ItemKind, Name};
use eng_grammar::{Diagnostic, Span};

/// A condition that compares one value with words of its choice.
struct Cases {
    /// The text of the value.
    subject: String,
    choice: DefinitionId,
    words: Vec<u32>,
}

impl<'p> Checker<'p> {
    /// The definition of a choice.
    pub(super) fn choice(&self, id: DefinitionId) -> Option<&'p Choice> {
        match &self.program.item(id)?.kind {
            ItemKind::Choice(choice) => Some(choice),
            _ => None,
        }
    }

    /// Checks a definition: two words or more, and each once.
    pub(super) fn choice_definition(&mut self, choice: &'p Choice) {
        for (at, word) in choice.words.iter().enumerate() {
            let first = choice.words.iter().take(at).find(|w| w.text == word.text);
            if let Some(first) = first {
                let message = Diagnostic::error(
                    codes::CHOICE,
                    format!("`{}` has the word `{}` twice", choice.name.text, word.text),
                );
                self.report(
                    message
                        .at(word.span, "again here")
                        .also(first.span, "first here"),
                );
            }
        }
        if choice.words.len() < 2 {
            self.report(
                Diagnostic::error(
                    codes::CHOICE,
                    format!("the choice `{}` has one word", choice.name.text),
                )
                .at(choice.name.span, "nothing to choose")
                .with_help("separate the words by `|`: `choice End = timing_end | driving_end`"),
            );
        }
    }

    /// Refuses a value of a choice that has the name of one of its words: where the choice is due, the name would be
    /// the word.
    pub(super) fn hides_word(&mut self, name: &Name, ty: &Type) {
        let Type::Choice(id) = ty else {
            return;
        };
        let Some(choice) = self.choice(*id) else {
            return;
        };
        let word = choice.words.iter().find(|word| word.text == name.text);
        if let Some(word) = word {
            let (text, of) = (&name.text, &choice.name.text);
            let message = Diagnostic::error(
                codes::CHOICE,
                format!("a value of the choice `{of}` has the name of its word `{text}`"),
            );
            self.report(
                message
                    .at(
                        name.span,
                        "where the choice is expected, this name means the word",
                    )
                    .also(word.span, "the word")
                    .with_help("give the value another name"),
            );
        }
    }

    /// The type of a name that is a word of the choice that is due.
    pub(super) fn due_word(&mut self, name: &str, span: Span) -> Option<Type> {
        let id = self.choice_due?;
        let mut words = self.choice(id)?.words.iter();
        let at = words.position(|word| word.text == name)?;
        self.findings.words.insert(span, (id, at as u32));
        Some(Type::Choice(id))
    }

    /// `End.timing_end`, if `base` is the name of a choice.
    pub(super) fn word_of_choice(
        &mut self,
        scope: &Scope<'p>,
        base: &Expr,
        name: &Name,
    ) -> Option<Type> {
        let ExprKind::Name(of) = &base.kind else {
            return None;
        };
        // the names inside come first, and only a top-level name can be a choice
        let id = self.program.lookup(scope.module, of)?;
        let choice = self.choice(id)?;
        let Some(Found::Top(_)) = self.find(scope, of) else {
            return None;
        };
        let mut words = choice.words.iter();
        Some(match words.position(|word| word.text == name.text) {
            Some(at) => {
                let whole = base.span.to(name.span);
                self.findings.words.insert(whole, (id, at as u32));
                Type::Choice(id)
            }
            None => {
                self.no_word_of_choice(id, &name.text, name.span);
                Type::Error
            }
        })
    }

    /// Reports a word that the choice does not have.
    pub(super) fn no_word_of_choice(&mut self, id: DefinitionId, word: &str, span: Span) {
        let Some(choice) = self.choice(id) else {
            return;
        };
        let words = || choice.words.iter().map(|word| word.text.as_str());
        let message = Diagnostic::error(
            codes::NO_WORD,
            format!("`{word}` is no word of the choice `{}`", choice.name.text),
        )
        .at(span, "not among its words");
        let message = message.meant_if(span, nearest(word, words()));
        self.report(message.with_note(format!("its words are {}", listing(words(), 12))));
    }

    /// The name of a choice in the scope of a module that has this word.
    pub(super) fn choice_with(&self, module: u32, word: &str) -> Option<&'p str> {
        let module = self.program.modules.get(module as usize)?;
        module.scope.values().find_map(|id| {
            let choice = self.choice(*id)?;
            let has = choice.words.iter().any(|known| known.text == word);
            has.then_some(choice.name.text.as_str())
        })
    }

    /// The words of a choice in a sentence.
    pub(super) fn words_of(&self, id: DefinitionId) -> String {
        let words = self.choice(id).into_iter().flat_map(|choice| &choice.words);
        listing(words.map(|word| word.text.as_str()), 12)
    }

    /// The types of the sides of `==` and `!=`. A side that is a word of the other side's choice needs no further
    /// check.
    pub(super) fn sides_of_equality(
        &mut self,
        scope: &Scope<'p>,
        left: &Expr,
        right: &Expr,
    ) -> (Type, Type) {
        let free = match &left.kind {
            ExprKind::Name(name) => {
                !super::scope::BUILT_IN_NAMES.contains(&name.as_str())
                    && self.find(scope, name).is_none()
            }
            _ => false,
        };
        let due = |ty: &Type| match ty {
            Type::Choice(id) => Some(*id),
            _ => None,
        };
        if free {
            let b = self.infer_due(scope, right, None);
            (self.infer_due(scope, left, due(&b)), b)
        } else {
            let a = self.infer_due(scope, left, None);
            let b = self.infer_due(scope, right, due(&a));
            (a, b)
        }
    }

    /// The type of an expression where a choice is due, or none.
    pub(super) fn infer_due(
        &mut self,
        scope: &Scope<'p>,
        expr: &Expr,
        due: Option<DefinitionId>,
    ) -> Type {
        let outer = std::mem::replace(&mut self.choice_due, due);
        let ty = self.infer(scope, expr);
        self.choice_due = outer;
        ty
    }

    /// The type of `if … then … else …`. `before` are the conditions of the chain whose `else` this is.
    pub(super) fn conditional(
        &mut self,
        scope: &Scope<'p>,
        (condition, then, otherwise): (&Expr, &Expr, Option<&Expr>),
        before: &[&Expr],
    ) -> Type {
        self.condition(scope, condition, "the condition of `if`");
        let a = self.infer(scope, then);
        let mut conditions = before.to_vec();
        conditions.push(condition);
        let Some(otherwise) = otherwise else {
            return match self.has_every_case(&conditions) {
                true => a,
                false => Type::Error,
            };
        };
        let b = match &otherwise.kind {
            ExprKind::If {
                condition,
                then,
                otherwise: next,
            } => {
                let parts = (condition.as_ref(), then.as_ref(), next.as_deref());
                let ty = self.conditional(scope, parts, &conditions);
                self.findings.types.insert(otherwise.span, ty.clone());
                ty
            }
            _ => self.infer(scope, otherwise),
        };
        self.join(
            (&a, then.span),
            (&b, otherwise.span),
            "the two values of `if`",
        )
    }

    /// Checks that the conditions of a chain without a last `else` are all words of one choice.
    fn has_every_case(&mut self, conditions: &[&Expr]) -> bool {
        let last = conditions.last().map(|condition| condition.span);
        let Some(last) = last else {
            return false;
        };
        let mut all: Option<Cases> = None;
        for condition in conditions {
            let found = self.cases(condition);
            let fits = match (&all, &found) {
                (None, found) => found.is_some(),
                (Some(all), Some(found)) => {
                    all.subject == found.subject && all.choice == found.choice
                }
                (Some(_), None) => false,
            };
            if !fits {
                self.report(
                    Diagnostic::error(codes::CASES, match conditions.len() {
                        1 => "this `if` has no value if its condition is false",
                        _ => "this `if` has no value if all its conditions are false",
                    })
                    .at(condition.span, match conditions.len() {
                        1 => "no `else` follows",
                        _ => "this compares no word of the choice that the others compare",
                    })
                    .with_note("only a chain that compares one value with every word of its choice needs no `else`")
                    .with_help("add `else …`"),
                );
                return false;
            }
            if let Some(found) = found {
                match &mut all {
                    Some(all) => all.words.extend(found.words),
                    None => all = Some(found),
                }
            }
        }
        let Some(all) = all else {
            return false;
        };
        let words = self.choice(all.choice).into_iter().flat_map(|c| &c.words);
        let missing: Vec<&str> = words
            .enumerate()
            .filter(|(at, _)| !all.words.contains(&(*at as u32)))
            .map(|(_, word)| word.text.as_str())
            .collect();
        if missing.is_empty() {
            return true;
        }
        let missing = listing(missing, 12);
        self.report(
            Diagnostic::error(
                codes::CASES,
                format!("this `if` leaves out {missing} of `{}`", all.subject),
            )
            .at(last, "the last case")
            .with_help("add the missing words, or an `else`"),
        );
        false
    }

    /// The words with which a condition compares a value, if it does nothing else.
    fn cases(&self, condition: &Expr) -> Option<Cases> {
        match &condition.kind {
            ExprKind::Paren { inner, .. } => self.cases(inner),
            ExprKind::Binary {
                op: BinaryOp::Or,
                left,
                right,
                ..
            } => {
                let (mut a, b) = (self.cases(left)?, self.cases(right)?);
                a.words.extend(b.words);
                (a.subject == b.subject && a.choice == b.choice).then_some(a)
            }
            ExprKind::Binary {
                op: BinaryOp::Equal,
                left,
                right,
                ..
            } => {
                let word = |side: &Expr| self.findings.words.get(&side.span).copied();
                let (subject, (choice, at)) = match (word(left), word(right)) {
                    (None, Some(word)) => (left, word),
                    (Some(word), None) => (right, word),
                    _ => return None,
                };
                Some(Cases {
                    subject: self.sources.text(subject.span).to_owned(),
                    choice,
                    words: vec![at],
                })
            }
            _ => None,
        }
    }
}
