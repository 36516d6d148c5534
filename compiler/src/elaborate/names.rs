//! Names of inputs, channels and parameters in the arguments of an analysis: `outputs: [speed, main[1..5].force]`.

use super::binding::span_of;
use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, body::index_text, location};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Expr, ExprKind, IndexArgument};
use eng_grammar::{Diagnostic, Diagnostics};
use eng_system::analysis::{Named, Names};
use eng_system::system::{Analysis, System};

/// Most names that a message lists. A choice: they fit in a line or two.
const SHOWN_PATHS: usize = 12;

impl<'a> Elaborator<'a, '_> {
    /// The names of a list, or a single name without a list.
    pub(super) fn names_of_channels(
        &mut self,
        expr: &'a Expr,
        scope: ScopeId,
        found: &mut Vec<Named>,
    ) -> Eval<()> {
        if let ExprKind::List { items, unit: None } = &expr.kind {
            for item in items {
                self.names_of_channels(item, scope, found)?;
            }
            return Ok(());
        }
        for path in self.paths_of(expr, scope)? {
            found.push(Named {
                path,
                at: location(expr.span),
            });
        }
        Ok(())
    }

    /// The paths of a name: several if an index is a range or a list.
    fn paths_of(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<Vec<String>> {
        match &expr.kind {
            ExprKind::Name(name) => Ok(vec![name.clone()]),
            ExprKind::Field { base, name } => {
                let bases = self.paths_of(base, scope)?.into_iter();
                Ok(bases.map(|base| format!("{base}.{}", name.text)).collect())
            }
            ExprKind::Index { base, indices } => {
                let bases = self.paths_of(base, scope)?;
                if let [IndexArgument::All(_)] = indices.as_slice() {
                    return Ok(bases.into_iter().map(|base| format!("{base}[*]")).collect());
                }
                let mut places: Vec<Vec<usize>> = vec![Vec::new()];
                for index in indices {
                    let numbers = self.indices_of(index, scope)?;
                    let next = places.iter().flat_map(|place| {
                        let longer = |number: &usize| [place.as_slice(), &[*number]].concat();
                        numbers.iter().map(longer)
                    });
                    places = next.collect();
                }
                let texts: Vec<String> = places.iter().map(|place| index_text(place)).collect();
                let all = bases.iter().flat_map(|base| {
                    let indexed = move |text: &String| format!("{base}{text}");
                    texts.iter().map(indexed)
                });
                Ok(all.collect())
            }
            _ => self.checked(None, expr.span, "no name of a channel"),
        }
    }

    fn indices_of(&mut self, index: &'a IndexArgument, scope: ScopeId) -> Eval<Vec<usize>> {
        let at = match index {
            IndexArgument::At(at) => at,
            IndexArgument::All(span) => return self.checked(None, *span, "one `*` of several"),
        };
        let items = match self.evaluate(at, scope)? {
            Value::List(items) => items,
            one => vec![one],
        };
        let mut numbers = Vec::with_capacity(items.len());
        for item in items {
            let number = self.whole_number(item, at.span)?;
            // a negative index names nothing, and neither does zero
            numbers.push(usize::try_from(number).unwrap_or(0));
        }
        Ok(numbers)
    }
}

/// Checks the names of inputs, channels and parameters that an analysis states against its model.
pub(crate) fn check_names(analysis: &Analysis, system: &System, diagnostics: &mut Diagnostics) {
    for (argument, names, stated) in analysis.kind.named() {
        let paths = system.paths_of(names);
        let Err(misnamed) = names.indices(stated, &paths) else {
            continue;
        };
        let Some(name) = stated.get(misnamed.index) else {
            continue;
        };
        let place = span_of(name.at);
        if misnamed.again {
            let title = format!("`{argument}` has `{}` twice", name.path);
            diagnostics.push(
                Diagnostic::error(codes::NO_CHANNEL_OF_ANALYSIS, title)
                    .at(place, "an earlier name of the list already includes it"),
            );
            continue;
        }
        let kind = match names {
            Names::Inputs => "input",
            Names::Channels => "channel",
            Names::Parameters => "parameter",
        };
        let title = format!("`{}` has no {kind} `{}`", system.name, name.path);
        let message = Diagnostic::error(codes::NO_CHANNEL_OF_ANALYSIS, title);
        let message = message.at(place, format!("no {kind} of this name"));
        // a name with an index may stand for several, and only one of them is wrong
        let whole = !name.path.contains('[');
        let message = match nearest(&name.path, paths.iter().copied()) {
            Some(near) if whole => message.meant(place, near),
            _ => message,
        };
        let parameter = system
            .parameters
            .iter()
            .find(|p| p.origin.path == name.path);
        diagnostics.push(match (names, parameter, paths.is_empty()) {
            (Names::Inputs, Some(parameter), _) => {
                let message = message.also_if(parameter.origin.used_at.map(span_of), "a parameter");
                message.with_help("declare it as `input`: only inputs change while a model runs")
            }
            (Names::Inputs, None, true) => message
                .with_help("the model has no input; declare one: `input brake: Torque = 0 N*m`"),
            _ => message.with_note(format!(
                "{kind}s are {}",
                listing(paths.iter().copied(), SHOWN_PATHS)
            )),
        });
    }
}
