//! Tables: functions of given points.

use super::mismatch::Due;
use super::scope::Scope;
use super::types::{FunctionParameter, Kind, Quantity, Signature, Type};
use super::{Checker, Progress};
use crate::codes;
use crate::resolve::suggest::nearest;
use eng_grammar::ast::{Expr, ExprKind, Name, Table};
use eng_grammar::{Diagnostic, Span};
use std::sync::Arc;

const OPTIONS: [&str; 4] = ["columns", "periodic", "interpolation", "extrapolation"];

impl<'p> Checker<'p> {
    /// Checks a table once, and gives its signature.
    pub(super) fn table(&mut self, scope: &Scope<'p>, table: &'p Table) -> Arc<Signature> {
        let key = table.name.span;
        if let Some(Progress::Done(signature)) = self.signatures.get(&key) {
            return signature.clone();
        }
        let argument = match table.parameters.as_slice() {
            [parameter] => {
                let ty = self.parameter(scope, parameter);
                self.number_of_table(ty, parameter.ty.span)
            }
            _ => {
                self.bad_table(
                    table.name.span,
                    "a table has one argument",
                    &format!("it has {}", table.parameters.len()),
                    "for instance `table lift(theta: CrankAngle) -> Length = …`",
                );
                Type::Error
            }
        };
        let result = match &table.result {
            Some(ty) => {
                let found = self.ty(scope, ty);
                self.number_of_table(found, ty.span)
            }
            None => {
                self.bad_table(
                    table.name.span,
                    "a table says what it gives",
                    "no `->` after its argument",
                    "for instance `table lift(theta: CrankAngle) -> Length = …`",
                );
                Type::Error
            }
        };
        self.source_of_table(scope, table, &argument, &result);
        let parameters = match table.parameters.first() {
            Some(parameter) if table.parameters.len() == 1 => vec![FunctionParameter {
                name: parameter.name.text.clone(),
                ty: argument,
                optional: false,
                span: parameter.name.span,
            }],
            _ => Vec::new(),
        };
        let broken = parameters.is_empty();
        let signature = Arc::new(Signature {
            name: table.name.text.clone(),
            parameters,
            result: if broken { Type::Error } else { result },
        });
        self.signatures
            .insert(key, Progress::Done(signature.clone()));
        signature
    }

    fn bad_table(&mut self, span: Span, title: &str, label: &str, help: &str) {
        self.report(
            Diagnostic::error(codes::TABLE, title)
                .at(span, label)
                .with_help(help),
        );
    }

    fn number_of_table(&mut self, ty: Type, span: Span) -> Type {
        match ty {
            Type::Scalar(_) | Type::Error => ty,
            Type::Int => Type::one(),
            other => {
                let found = self.describe(&other);
                self.bad_table(
                    span,
                    "a table maps a number to a number",
                    &format!("this is {found}"),
                    "several values need several tables",
                );
                Type::Error
            }
        }
    }

    fn source_of_table(
        &mut self,
        scope: &Scope<'p>,
        table: &Table,
        argument: &Type,
        result: &Type,
    ) {
        if matches!(table.source.kind, ExprKind::Error) {
            return;
        }
        let call = match &table.source.kind {
            ExprKind::Call { callee, arguments } => match &callee.kind {
                ExprKind::Name(name) if name == "csv" || name == "points" => {
                    Some((name.as_str(), arguments))
                }
                _ => None,
            },
            _ => None,
        };
        let Some((source, arguments)) = call else {
            self.bad_table(
                table.source.span,
                "a table takes its numbers from `csv(…)` or `points(…)`",
                "this is neither",
                "for instance `points([0, 10] mm, [0, 3] kN)` or `csv(\"gas.csv\", columns: [\"theta [deg]\", \"p [bar]\"])`",
            );
            return;
        };
        let mut plain: Vec<&Expr> = Vec::new();
        let mut seen: Vec<&Name> = Vec::new();
        for given in arguments {
            let Some(name) = &given.name else {
                plain.push(&given.value);
                continue;
            };
            if let Some(first) = seen.iter().find(|n| n.text == name.text) {
                let first = first.span;
                self.report(
                    Diagnostic::error(
                        codes::ARGUMENT_TWICE,
                        format!("`{}` is given twice", name.text),
                    )
                    .at(name.span, "again here")
                    .also(first, "first here"),
                );
            }
            seen.push(name);
            self.option_of_table(scope, source, name, &given.value, argument);
        }
        match (source, plain.as_slice()) {
            ("csv", [file]) => {
                self.expect(scope, file, &Type::Text, &Due::new("the file of `csv`"));
                if !seen.iter().any(|name| name.text == "columns") {
                    self.bad_table(
                        table.source.span,
                        "`csv` must say which columns it reads",
                        "`columns:` is missing",
                        "for instance `columns: [\"theta [deg]\", \"p [bar]\"]`, as in the file's header",
                    );
                }
            }
            ("points", [xs, ys]) => {
                let of = |ty: &Type| match ty {
                    Type::Error => Type::Error,
                    ty => Type::list(ty.clone(), None),
                };
                let name = &table.name;
                let due = Due::new(format!("the list of arguments of `{}`", name.text))
                    .declared(name.span, "the table");
                let x = self.expect(scope, xs, &of(argument), &due);
                let due = Due::new(format!("the list of values of `{}`", name.text))
                    .declared(name.span, "the table");
                let y = self.expect(scope, ys, &of(result), &due);
                if let (
                    Type::List {
                        length: Some(m), ..
                    },
                    Type::List {
                        length: Some(n), ..
                    },
                ) = (&x, &y)
                    && m != n
                {
                    self.report(
                        Diagnostic::error(
                            codes::LIST_LENGTH,
                            format!("`{}` has {m} arguments and {n} values", name.text),
                        )
                        .at(ys.span, format!("{n} values"))
                        .also(xs.span, format!("{m} arguments")),
                    );
                }
            }
            ("csv", _) => self.bad_table(
                table.source.span,
                "`csv` takes one file",
                &format!("{} arguments without a name", plain.len()),
                "for instance `csv(\"gas.csv\", columns: [\"theta [deg]\", \"p [bar]\"])`",
            ),
            _ => self.bad_table(
                table.source.span,
                "`points` takes a list of arguments and a list of values",
                &format!("{} lists", plain.len()),
                "for instance `points([0, 10] mm, [0, 3] kN)`",
            ),
        }
    }

    fn option_of_table(
        &mut self,
        scope: &Scope<'p>,
        source: &str,
        name: &Name,
        value: &Expr,
        argument: &Type,
    ) {
        let choice = |value: &Expr| match &value.kind {
            ExprKind::Name(word) => Some(word.clone()),
            _ => None,
        };
        match name.text.as_str() {
            "columns" if source == "csv" => {
                let due = Due::new("`columns`");
                self.expect(scope, value, &Type::list(Type::Text, Some(2)), &due);
            }
            "periodic" => {
                let Some(quantity) = argument.quantity() else {
                    return;
                };
                let period = Type::Scalar(Quantity {
                    kind: Kind::Any,
                    ..quantity
                });
                self.expect(scope, value, &period, &Due::new("the period of this table"));
            }
            "interpolation" | "extrapolation" => {
                let allowed: &[&str] = if name.text == "interpolation" {
                    &["cubic", "monotone"]
                } else {
                    &["hold", "linear"]
                };
                let word = choice(value);
                if word.as_deref().is_some_and(|word| allowed.contains(&word)) {
                    return;
                }
                let mut message = Diagnostic::error(
                    codes::TABLE,
                    format!("there is no such {} of a table", name.text),
                )
                .at(value.span, format!("`{}` or `{}`", allowed[0], allowed[1]));
                if let Some(near) = word
                    .as_deref()
                    .and_then(|word| nearest(word, allowed.iter().copied()))
                {
                    message = message.with_fix(format!("write `{near}`"), value.span, near);
                }
                self.report(message);
            }
            other => {
                let mut message = Diagnostic::error(
                    codes::UNKNOWN_ARGUMENT,
                    format!("`{source}` has no parameter `{other}`"),
                )
                .at(name.span, "no parameter of this name");
                if let Some(near) = nearest(other, OPTIONS) {
                    message = message.meant(name.span, near);
                } else {
                    message = message.with_note(
                        "it takes `columns` (of a file), `periodic`, `interpolation` and `extrapolation`",
                    );
                }
                self.report(message);
            }
        }
    }
}
