//! Tables: functions of given points.

use super::mismatch::Due;
use super::scope::Scope;
use super::types::{FunctionParameter, Kind, Quantity, Signature, Type};
use super::{Checker, Progress};
use crate::codes;
use crate::resolve::suggest::nearest;
use crate::words::{ENDS_OF_TABLES, end_of_table};
use eng_grammar::ast::{Expr, ExprKind, Name, Table};
use eng_grammar::{Diagnostic, Span};
use eng_system::table::MOST_ARGUMENTS;
use std::sync::Arc;

/// Options of a table of one argument.
const OPTIONS: [&str; 4] = ["columns", "periodic", "interpolation", "extrapolation"];

/// Help on the continuation of a table of several arguments.
const ENDS: &str = "`hold`, `linear`, `even`, `odd`, `periodic(…)`, or two words for the ends: `[even, linear]`; `none` has no value beyond";

impl<'p> Checker<'p> {
    /// Checks a table once, and gives its signature.
    pub(super) fn table(&mut self, scope: &Scope<'p>, table: &'p Table) -> Arc<Signature> {
        let key = table.name.span;
        if let Some(Progress::Done(signature)) = self.signatures.get(&key) {
            return signature.clone();
        }
        let count = table.parameters.len();
        if count == 0 || count > MOST_ARGUMENTS {
            self.bad_table(
                table.name.span,
                "a table has one to three arguments",
                &format!("it has {count}"),
                "for instance `table lift(theta: CrankAngle) -> Length = …`",
            );
        }
        let columns = table.parameters.iter().find(|p| p.name.text == "columns");
        if let Some(parameter) = columns.filter(|_| count > 1) {
            self.bad_table(
                parameter.name.span,
                "an argument of a table has a name that `csv` takes",
                "`columns:` names the columns of a file",
                "another name",
            );
        }
        let mut arguments = Vec::with_capacity(count);
        for parameter in &table.parameters {
            let ty = self.parameter(scope, parameter);
            arguments.push(self.number_of_table(ty, parameter.ty.span));
        }
        let result = match &table.result {
            Some(ty) => {
                let found = self.ty(scope, ty);
                self.number_of_table(found, ty.span)
            }
            None => {
                self.bad_table(
                    table.name.span,
                    "a table states the type of its values",
                    "no `->` after its arguments",
                    "for instance `table lift(theta: CrankAngle) -> Length = …`",
                );
                Type::Error
            }
        };
        let broken = count == 0 || count > MOST_ARGUMENTS;
        if !broken {
            self.source_of_table(scope, table, &arguments, &result);
        }
        let described = table.parameters.iter().zip(arguments);
        let signature = Arc::new(Signature {
            name: table.name.text.clone(),
            parameters: described
                .map(|(parameter, ty)| FunctionParameter {
                    name: parameter.name.text.clone(),
                    ty,
                    optional: false,
                    span: parameter.name.span,
                })
                .collect(),
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
        parameters: &[Type],
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
            self.clash(&seen, name, parameters.len() == 1);
            seen.push(name);
            match parameters {
                [argument] => self.option_of_curve(scope, source, name, &given.value, argument),
                _ => self.option_of_grid(scope, source, name, &given.value, (table, parameters)),
            }
        }
        match (source, plain.as_slice()) {
            ("csv", [file]) => {
                self.expect(scope, file, &Type::Text, &Due::new("the file of `csv`"));
                if !seen.iter().any(|name| name.text == "columns") {
                    self.bad_table(
                        table.source.span,
                        "`csv` must name the columns that it reads",
                        "`columns:` is missing",
                        "for instance `columns: [\"theta [deg]\", \"p [bar]\"]`, as in the file's header: the columns of the arguments, then that of the value",
                    );
                }
            }
            ("points", [xs, ys]) if parameters.len() == 1 => {
                let of = |ty: &Type| match ty {
                    Type::Error => Type::Error,
                    ty => Type::list(ty.clone(), None),
                };
                let name = &table.name;
                let due = Due::new(format!("the list of arguments of `{}`", name.text))
                    .declared(name.span, "the table");
                let argument = parameters.first().cloned().unwrap_or(Type::Error);
                let x = self.expect(scope, xs, &of(&argument), &due);
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
                            format!("the table `{}` has {m} points and {n} values", name.text),
                        )
                        .at(ys.span, format!("{n} values"))
                        .also(xs.span, format!("{m} points")),
                    );
                }
            }
            ("points", lists) if lists.len() == parameters.len() + 1 => {
                self.points_of_grid(scope, table, lists, (parameters, result));
            }
            ("csv", _) => self.bad_table(
                table.source.span,
                "`csv` takes one file",
                &format!("{} arguments without a name", plain.len()),
                "for instance `csv(\"gas.csv\", columns: [\"theta [deg]\", \"p [bar]\"])`",
            ),
            _ if parameters.len() == 1 => self.bad_table(
                table.source.span,
                "`points` takes a list of arguments and a list of values",
                &format!("{} lists", plain.len()),
                "for instance `points([0, 10] mm, [0, 3] kN)`",
            ),
            _ => self.bad_table(
                table.source.span,
                "`points` takes a list for each argument and the values",
                &format!("{} lists for {} arguments", plain.len(), parameters.len()),
                "for instance `points([0, 10] mm, [0, 90] deg, [[0, 3], [1, 4]] kN)`: a row of values for each point of the first argument",
            ),
        }
    }

    /// The lists of `points` of a table of several arguments: values are lists in lists.
    fn points_of_grid(
        &mut self,
        scope: &Scope<'p>,
        table: &Table,
        lists: &[&Expr],
        (parameters, result): (&[Type], &Type),
    ) {
        let name = &table.name;
        let Some((values, points)) = lists.split_last() else {
            return;
        };
        let mut sizes = Vec::with_capacity(points.len());
        for ((list, ty), parameter) in points.iter().zip(parameters).zip(&table.parameters) {
            let argument = &parameter.name.text;
            let due = Due::new(format!("the list of points of `{argument}`"))
                .declared(parameter.name.span, "the argument");
            let found = match ty {
                Type::Error => self.infer(scope, list),
                ty => self.expect(scope, list, &Type::list(ty.clone(), None), &due),
            };
            sizes.push(match found {
                Type::List { length, .. } => length,
                _ => None,
            });
        }
        let mut due_type = result.clone();
        if !matches!(due_type, Type::Error) {
            for size in sizes.into_iter().rev() {
                due_type = Type::list(due_type, size);
            }
        }
        let due = Due::new(format!("the list of values of `{}`", name.text))
            .declared(name.span, "the table");
        self.expect(scope, values, &due_type, &due);
    }

    /// A named argument of the source of a table of several arguments.
    fn option_of_grid(
        &mut self,
        scope: &Scope<'p>,
        source: &str,
        name: &Name,
        value: &Expr,
        (table, parameters): (&Table, &[Type]),
    ) {
        let names = || table.parameters.iter().map(|p| p.name.text.as_str());
        if name.text == "columns" && source == "csv" {
            let texts = Type::list(Type::Text, Some(parameters.len() as u32 + 1));
            self.expect(scope, value, &texts, &Due::new("`columns`"));
            return;
        }
        let argument = names().position(|known| known == name.text);
        let Some(ty) = argument.and_then(|k| parameters.get(k)) else {
            let of_curves = OPTIONS.contains(&name.text.as_str()) && name.text != "columns";
            let mut message = Diagnostic::error(
                codes::UNKNOWN_ARGUMENT,
                format!("`{source}` has no parameter `{}` here", name.text),
            );
            if of_curves {
                let first = names().next().unwrap_or_default();
                message = message
                    .at(name.span, "of tables of one argument")
                    .with_note("a table of several arguments is a cubic spline in each of them")
                    .with_help(format!(
                        "name the argument: `{first}: hold`, `{first}: periodic(360 deg)`"
                    ));
            } else if let Some(near) = nearest(&name.text, names().chain(["columns"])) {
                message = message
                    .at(name.span, "no argument of this name")
                    .meant(name.span, near);
            } else {
                message = message
                    .at(name.span, "no argument of this name")
                    .with_help(format!(
                        "it takes `columns` (of a file) and each argument by its name: {ENDS}"
                    ));
            }
            self.report(message);
            return;
        };
        self.ends_of_argument(scope, value, ty);
    }

    /// The continuation beyond the ends of an argument.
    fn ends_of_argument(&mut self, scope: &Scope<'p>, value: &Expr, argument: &Type) {
        let is_end = |expr: &Expr| matches!(&expr.kind, ExprKind::Name(word) if end_of_table(word).is_some());
        match &value.kind {
            ExprKind::Name(_) if is_end(value) => return,
            ExprKind::List { items, unit: None }
                if items.len() == 2 && items.iter().all(is_end) =>
            {
                return;
            }
            ExprKind::Call { callee, arguments } => {
                if let (ExprKind::Name(word), [period]) = (&callee.kind, arguments.as_slice())
                    && word == "periodic"
                    && period.name.is_none()
                {
                    self.period_of_table(scope, &period.value, argument);
                    return;
                }
            }
            _ => {}
        }
        let near = match &value.kind {
            ExprKind::Name(word) => nearest(word, ENDS_OF_TABLES.iter().map(|(word, _)| *word)),
            _ => None,
        };
        let mut message = Diagnostic::error(codes::TABLE, "this is no continuation of a table")
            .at(value.span, "beyond the ends of this argument");
        message = match near {
            Some(near) => message.with_fix(format!("write `{near}`"), value.span, near),
            None => message.with_help(ENDS),
        };
        self.report(message);
    }

    fn period_of_table(&mut self, scope: &Scope<'p>, value: &Expr, argument: &Type) {
        let Some(quantity) = argument.quantity() else {
            return;
        };
        let period = Type::Scalar(Quantity {
            kind: Kind::Any,
            ..quantity
        });
        self.expect(scope, value, &period, &Due::new("the period of this table"));
    }

    /// Refuses an option that is given twice, and an extrapolation of a periodic table, which has values
    /// everywhere. A table of several arguments states its continuations in another form.
    fn clash(&mut self, seen: &[&Name], name: &Name, of_curve: bool) {
        if let Some(first) = seen.iter().find(|n| n.text == name.text) {
            self.report(
                Diagnostic::error(
                    codes::ARGUMENT_TWICE,
                    format!("`{}` is given twice", name.text),
                )
                .at(name.span, "again here")
                .also(first.span, "first here"),
            );
        }
        let other = match name.text.as_str() {
            "periodic" if of_curve => "extrapolation",
            "extrapolation" if of_curve => "periodic",
            _ => return,
        };
        if let Some(first) = seen.iter().find(|name| name.text == other) {
            self.report(
                Diagnostic::error(codes::TABLE, "a periodic table has no outside")
                    .at(name.span, "contradicts the other")
                    .also(first.span, "stated here")
                    .with_help("leave out `extrapolation:`, or `periodic:`"),
            );
        }
    }

    fn option_of_curve(
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
            "periodic" => self.period_of_table(scope, value, argument),
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
