//! Types of the functions of functions: `slope`, `curvature`, `period`.

use super::Checker;
use super::scope::Scope;
use super::types::{Kind, Quantity, Type};
use crate::functions::BuiltIn;
use eng_grammar::Span;
use eng_grammar::ast::Argument;

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
        let found = self.infer(scope, &first.value);
        let signature = match &found {
            Type::Function(signature) if signature.parameters.len() == 1 => signature.clone(),
            Type::Error => {
                for argument in rest {
                    self.infer(scope, &argument.value);
                }
                return Type::Error;
            }
            other => {
                let what = format!("the first argument of `{}`", function.name);
                let wanted = "a table or function of one argument, by its name";
                return self.not_a(&first.value, &other.clone(), &what, wanted);
            }
        };
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
        let by = of_parameter.filter(|quantity| quantity.dim.variables.is_empty());
        let by = by.or_else(|| argument.and_then(|ty| ty.quantity()));
        let (Some(of), Some(by)) = (value.quantity(), by) else {
            let what = format!("the first argument of `{}`", function.name);
            return self.not_a(
                &first.value,
                &found,
                &what,
                "a function of a number that gives a number",
            );
        };
        let mut slope = of.over(&by);
        if function.name == "curvature" {
            slope = slope.over(&by);
        }
        // like `der`: an angle may be dropped from a computed value
        Type::Scalar(Quantity {
            soft: true,
            kind: Kind::Any,
            ..slope
        })
    }
}
