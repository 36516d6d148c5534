//! Types of the functions of functions: `slope`, `curvature`, `period`, `solve`.

use super::Checker;
use super::scope::Scope;
use super::types::{Kind, Quantity, Signature, Type};
use crate::codes;
use crate::functions::BuiltIn;
use crate::resolve::suggest::listing;
use eng_grammar::ast::{Argument, Expr};
use eng_grammar::{Diagnostic, Span};
use std::sync::Arc;

impl<'p> Checker<'p> {
    /// The type of a call whose first argument is a function of one argument.
    pub(super) fn of_function(
        &mut self,
        scope: &Scope<'p>,
        function: &BuiltIn,
        span: Span,
        arguments: &[Argument],
    ) -> Type {
        let given = self.bound(function, arguments, span, false).is_some();
        let Some((first, rest)) = arguments.split_first().filter(|_| given) else {
            for argument in arguments {
                self.infer(scope, &argument.value);
            }
            return Type::Error;
        };
        let Some(signature) = self.function_of_one(scope, function, &first.value) else {
            for argument in rest {
                self.infer(scope, &argument.value);
            }
            return Type::Error;
        };
        let found = Type::Function(signature.clone());
        let of_parameter = signature.parameters.first().and_then(|p| p.ty.quantity());
        if function.name == "period" {
            return match of_parameter {
                Some(quantity) => Type::Scalar(Quantity {
                    kind: Kind::Any,
                    ..quantity
                }),
                None => self.not_a(
                    &first.value,
                    &found,
                    "the argument of `period`",
                    "a function of a number",
                ),
            };
        }
        let value = self.call_of_function(scope, span, &signature, rest);
        if value.is_error() {
            return Type::Error;
        }
        let argument = rest.first().map(|x| self.infer(scope, &x.value));
        if function.name == "solve" {
            let declared = signature.parameters.first().map(|p| p.ty.clone());
            let known = declared.filter(|ty| each(ty).is_some_and(|q| q.dim.is_known()));
            return match (is_solvable(&value), known.or(argument)) {
                (true, Some(unknown)) if is_solvable(&unknown) => unknown,
                _ => {
                    let what = "the first argument of `solve`";
                    let wanted = "a function of a number that gives a number, or of a list that gives a list";
                    self.not_a(&first.value, &found, what, wanted)
                }
            };
        }
        let by = of_parameter.filter(|quantity| quantity.dim.is_known());
        let by = by.or_else(|| argument.and_then(|ty| ty.quantity()));
        match (value.quantity(), by) {
            (Some(of), Some(by)) => derivative_type(function, &of, &by),
            _ => self.no_number(function, &first.value, &found),
        }
    }

    /// The signature of the function of one argument that is the first argument of a call.
    fn function_of_one(
        &mut self,
        scope: &Scope<'p>,
        function: &BuiltIn,
        first: &Expr,
    ) -> Option<Arc<Signature>> {
        match self.infer_function(scope, first) {
            Type::Function(signature) if takes_one(&signature) => Some(signature),
            Type::Error => None,
            Type::Function(signature) if signature.parameters.len() > 1 => {
                let shown = self.sources.text(first.span).to_owned();
                let names = signature.parameters.iter().map(|p| p.name.as_str());
                let others: Vec<String> =
                    names.clone().skip(1).map(|n| format!("{n}: …")).collect();
                let message = Diagnostic::error(
                    codes::WRONG_TYPE,
                    format!("`{}` takes a function of one argument", function.name),
                )
                .at(first.span, format!("it takes {}", listing(names, 12)));
                let message = if function.name == "solve" {
                    message.with_note(
                        "several unknowns are one list: `fn f(x: Length[2]) -> Length[2] = …`",
                    )
                } else {
                    message
                };
                self.report(message.with_help(format!(
                    "state the others by their names: `{}({shown}({}), …)`",
                    function.name,
                    others.join(", ")
                )));
                None
            }
            other => {
                let what = format!("the first argument of `{}`", function.name);
                let wanted = "a table or function of one argument, by its name";
                self.not_a(first, &other, &what, wanted);
                None
            }
        }
    }

    fn no_number(&mut self, function: &BuiltIn, first: &Expr, found: &Type) -> Type {
        let what = format!("the first argument of `{}`", function.name);
        let wanted = "a function of a number that gives a number";
        self.not_a(first, found, &what, wanted)
    }

    /// The type of `slope(lift)` where a function is due. With an argument the call gives a number.
    pub(super) fn derivative_as_function(
        &mut self,
        scope: &Scope<'p>,
        function: &BuiltIn,
        span: Span,
        arguments: &[Argument],
    ) -> Type {
        let [Argument { name: None, value }] = arguments else {
            return self.of_function(scope, function, span, arguments);
        };
        if matches!(function.name, "period" | "solve") {
            return self.of_function(scope, function, span, arguments);
        }
        let Some(signature) = self.function_of_one(scope, function, value) else {
            return Type::Error;
        };
        let parameter = signature.parameters.first();
        let by = parameter.and_then(|parameter| parameter.ty.quantity());
        let quantities = signature.result.quantity().zip(by);
        let Some((of, by)) = quantities.filter(|(_, by)| by.dim.is_known()) else {
            return self.no_number(function, value, &Type::Function(signature));
        };
        self.findings.bound.insert(span);
        Type::Function(Arc::new(Signature {
            name: format!("{} of {}", function.name, signature.name),
            parameters: signature.parameters.iter().take(1).cloned().collect(),
            result: derivative_type(function, &of, &by),
        }))
    }
}

/// The quantity of a number, or of each number in a list.
fn each(ty: &Type) -> Option<Quantity> {
    match ty {
        Type::List { element, .. } => element.quantity(),
        other => other.quantity(),
    }
}

/// Whether `solve` takes values of a type as unknowns or equations.
fn is_solvable(ty: &Type) -> bool {
    matches!(ty, Type::Scalar(_) | Type::Int | Type::List { .. }) && each(ty).is_some()
}

/// Whether one argument is enough for a function.
fn takes_one(signature: &Signature) -> bool {
    let mut parameters = signature.parameters.iter();
    parameters.next().is_some() && parameters.all(|parameter| parameter.optional)
}

fn derivative_type(function: &BuiltIn, of: &Quantity, by: &Quantity) -> Type {
    let mut slope = of.over(by);
    if function.name == "curvature" {
        slope = slope.over(by);
    }
    // like `der`: an angle may be dropped from a computed value
    Type::Scalar(Quantity {
        soft: true,
        kind: Kind::Any,
        ..slope
    })
}
