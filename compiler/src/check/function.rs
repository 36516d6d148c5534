//! Checks functions. A function is checked once, generic over the dimensions of its arguments.

use super::mismatch::Due;
use super::scope::{BUILT_IN_NAMES, Scope};
use super::types::{FunctionParameter, Signature, Type};
use super::{Checker, Progress};
use crate::codes;
use crate::resolve::suggest::nearest;
use crate::typed::lineage::{is_int, word_of_length};
use eng_grammar::Diagnostic;
use eng_grammar::ast::{Function, Kind, Name};
use std::sync::Arc;

impl<'p> Checker<'p> {
    /// Checks a function once, and gives its signature.
    pub(super) fn function(&mut self, outer: &Scope<'p>, function: &'p Function) -> Arc<Signature> {
        let key = function.name.span;
        match self.signatures.get(&key) {
            Some(Progress::Done(signature)) => return signature.clone(),
            Some(Progress::Open) => {
                self.report(
                    Diagnostic::error(
                        codes::VALUE_CIRCLE,
                        format!("the function `{}` calls itself", function.name.text),
                    )
                    .at(function.name.span, "its value leads back to it")
                    .with_note(
                        "the compiler inserts a function at each call, so none can call itself",
                    ),
                );
                return Arc::new(Signature {
                    name: String::new(),
                    parameters: Vec::new(),
                    result: Type::Error,
                });
            }
            None => {}
        }
        if !self.deeper(key) {
            return Arc::new(Signature {
                name: String::new(),
                parameters: Vec::new(),
                result: Type::Error,
            });
        }
        self.signatures.insert(key, Progress::Open);
        self.depth += 1;
        let mut scope = Scope {
            locals: Vec::new(),
            body: None,
            at_use: None,
            output: false,
            ..outer.clone()
        };
        if function.bound {
            let signature = Arc::new(self.bound_function(&scope, function));
            self.depth -= 1;
            let done = Progress::Done(signature.clone());
            self.signatures.insert(key, done);
            return signature;
        }
        for generic in &function.generics {
            let number = self.variables.len() as u32;
            self.variables.push(generic.text.clone());
            scope.generics.push((generic.text.clone(), number));
        }
        // The types of all parameters can use the counts among them: `fn mean(values: Length[n], n: Int)`.
        let mut counted = scope.clone();
        let words = function
            .parameters
            .iter()
            .filter_map(|p| word_of_length(&p.ty));
        for parameter in &function.parameters {
            let name = &parameter.name.text;
            if is_int(&parameter.ty) {
                counted.locals.push((parameter.name.clone(), Type::Int));
            } else if words.clone().any(|(word, _)| word == name) {
                // no count: the length is refused with this type
                let ty = self.ty(&scope, &parameter.ty);
                counted.locals.push((parameter.name.clone(), ty));
            }
        }
        self.counted_lengths(function, &mut counted, &mut scope);
        let mut parameters: Vec<FunctionParameter> = Vec::new();
        for parameter in &function.parameters {
            let ty = self.parameter(&counted, parameter);
            if let Some(first) = parameters.iter().find(|p| p.name == parameter.name.text) {
                let first = first.span;
                self.defined_twice(&parameter.name.text, parameter.name.span, first);
            }
            parameters.push(FunctionParameter {
                name: parameter.name.text.clone(),
                ty: ty.clone(),
                optional: parameter.default.is_some(),
                span: parameter.name.span,
            });
            scope.locals.push((parameter.name.clone(), ty));
        }
        let result = self.result_of(function, &mut scope);
        self.function_needs(&scope, function);
        self.depth -= 1;
        let signature = Arc::new(Signature {
            name: function.name.text.clone(),
            parameters,
            result,
        });
        self.signatures
            .insert(key, Progress::Done(signature.clone()));
        signature
    }

    /// Checks the text of a function, and gives the type of its value.
    fn result_of(&mut self, function: &'p Function, scope: &mut Scope<'p>) -> Type {
        let declared = function.result.as_ref().map(|ty| self.ty(scope, ty));
        self.lets(function, scope);
        for requirement in &function.requirements {
            let word = if requirement.advise {
                "advise"
            } else {
                "require"
            };
            let what = format!("the expression after `{word}`");
            self.condition(scope, &requirement.condition, &what);
            self.message(scope, &requirement.message);
        }
        match declared {
            Some(declared) => {
                let mut due = Due::new(format!("the value of `{}`", function.name.text));
                if let Some(ty) = &function.result {
                    due = due.declared(ty.span, "declared here");
                }
                if let Some(value) = &function.value {
                    self.expect(scope, value, &declared, &due);
                }
                declared
            }
            None => match &function.value {
                Some(value) => self.infer(scope, value),
                None => Type::Error,
            },
        }
    }

    /// Adds the lengths that the arguments decide to the names of a function: `n` of `values: Length[n]` if
    /// nothing else is called `n`. A word that is nearly the name of a count is a misspelt one.
    fn counted_lengths(
        &mut self,
        function: &'p Function,
        counted: &mut Scope<'p>,
        scope: &mut Scope<'p>,
    ) {
        for (word, span) in function
            .parameters
            .iter()
            .filter_map(|p| word_of_length(&p.ty))
        {
            let mut names = function.parameters.iter().map(|p| p.name.text.as_str());
            let counts = function.parameters.iter().filter(|p| is_int(&p.ty));
            let counts = counts.map(|p| p.name.text.as_str());
            let known = self.find(counted, word).is_some()
                || BUILT_IN_NAMES.contains(&word.as_str())
                || names.any(|name| name == word)
                || nearest(word, counts).is_some();
            // the second array of the same length finds the name of the first
            let counted_before = counted.local(word).is_some()
                && !function.parameters.iter().any(|p| p.name.text == *word);
            if !known || counted_before {
                self.findings.lengths.insert(span);
            }
            if !known {
                let name = Name {
                    text: word.clone(),
                    span,
                };
                counted.locals.push((name.clone(), Type::Int));
                scope.locals.push((name, Type::Int));
            }
        }
    }

    /// Checks that a function has a value, or the types with which an interface requires it.
    fn function_needs(&mut self, scope: &Scope<'p>, function: &Function) {
        if function.value.is_some() {
            return;
        }
        let name = &function.name;
        let around = scope.definition.and_then(|id| self.declaration(id));
        let missing = if around.is_none_or(|around| around.kind != Kind::Interface) {
            ("needs a value", format!("write `fn {}(…) = …`", name.text))
        } else if function.result.is_none() {
            (
                "needs a type",
                format!(
                    "state the type of the value: `fn {}(…) -> Length`",
                    name.text
                ),
            )
        } else if !function.generics.is_empty() {
            (
                "needs a value",
                "a function that an interface requires has no dimension variables".to_owned(),
            )
        } else {
            return;
        };
        let (what, help) = missing;
        self.report(
            Diagnostic::error(
                codes::MISSING_VALUE,
                format!("the function `{}` {what}", name.text),
            )
            .at(name.span, what)
            .with_help(help),
        );
    }

    /// Checks the `let`s of a function and adds them to its locals.
    fn lets(&mut self, function: &'p Function, scope: &mut Scope<'p>) {
        for binding in &function.lets {
            self.not_local(scope, &binding.name);
            let ty = self.binding(scope, binding);
            scope.locals.push((binding.name.clone(), ty));
        }
    }
}
