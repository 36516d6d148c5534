//! Summaries of outputs: the number that tables of results take from an output.

use super::Checker;
use super::describe::kind_word;
use super::member::Member;
use super::types::Type;
use crate::codes;
use crate::program::DefinitionId;
use crate::resolve::suggest::nearest;
use crate::typed::lineage::{Level, levels};
use eng_grammar::Diagnostic;
use eng_grammar::ast::{Binding, BindingKind, Declaration, ItemKind, Kind, Name};
use eng_system::system::summary::Statistic;

/// The outputs with a summary in a text.
fn summarised<'p>(level: Level<'p>) -> impl Iterator<Item = (&'p Binding, &'p Name)> {
    let items = level.block.items.iter();
    items.filter_map(|item| match &item.kind {
        ItemKind::Binding(binding) => binding.summary.as_ref().map(|word| (binding, word)),
        _ => None,
    })
}

impl<'p> Checker<'p> {
    /// Checks the summaries of a definition: each belongs to an output of an interface that is one number.
    pub(super) fn summaries(&mut self, id: DefinitionId, declaration: &'p Declaration) {
        let Some(block) = declaration.block() else {
            return;
        };
        let own = Level {
            definition: id,
            declaration,
            block,
        };
        for (output, word) in summarised(own) {
            if declaration.kind != Kind::Interface {
                self.summary_of_no_interface(own, output, word);
                continue;
            }
            if Statistic::of(&word.text).is_none() {
                self.unknown_summary(word);
            }
            let member = Member::Binding(output);
            let ty = self.member_type(id, &output.name.text, member, output.name.span);
            if !matches!(ty, Type::Scalar(_) | Type::Error) || !output.index.is_empty() {
                self.summary_of_several(output, word, &ty);
            }
            let elders = levels(self.program, id);
            let elder = elders
                .into_iter()
                .filter(|level| level.definition != id)
                .flat_map(summarised)
                .find(|(other, _)| other.name.text == output.name.text);
            if let Some((_, first)) = elder {
                self.report(
                    Diagnostic::error(
                        codes::SUMMARY,
                        format!(
                            "`{}` has a summary in its interface already",
                            output.name.text
                        ),
                    )
                    .at(word.span, "again here")
                    .also(first.span, "first here")
                    .with_help("remove this one"),
                );
            }
        }
    }

    fn summary_of_no_interface(&mut self, own: Level<'p>, output: &Binding, word: &Name) {
        let name = &output.name.text;
        let of = format!(
            "{} `{}`",
            kind_word(own.declaration.kind),
            own.declaration.name.text
        );
        let message = Diagnostic::error(
            codes::SUMMARY,
            format!("no interface of the {of} has the output `{name}`"),
        )
        .at(
            word.span,
            "a table has a row for each element of an interface",
        );
        let elder = levels(self.program, own.definition)
            .into_iter()
            .filter(|level| level.definition != own.definition)
            .find_map(|level| {
                let mut items = level.block.items.iter();
                items.find_map(|item| match &item.kind {
                    ItemKind::Binding(asked)
                        if asked.kind == BindingKind::Output && asked.name.text == *name =>
                    {
                        Some((level, asked))
                    }
                    _ => None,
                })
            });
        let message = match elder {
            Some((level, asked)) => {
                let interface = &level.declaration.name.text;
                let message = Diagnostic::error(
                    codes::SUMMARY,
                    format!("the summary of `{name}` belongs in its interface `{interface}`"),
                )
                .at(word.span, "here it would hold for one class only")
                .also(asked.name.span, "the output of the interface");
                match (level.definition.module == self.program.root(), &asked.summary) {
                    (_, Some(stated)) => message.with_help(format!(
                        "remove it: the tables show the {} value of every class of `{interface}`",
                        stated.text
                    )),
                    (true, None) => message.with_help(format!(
                        "write `summary {}` at the output of `{interface}`",
                        word.text
                    )),
                    (false, None) => message.with_help(
                        "remove it; a table of your own needs an interface of your own",
                    ),
                }
            }
            None if matches!(own.declaration.kind, Kind::Model | Kind::Component) => message
                .with_help(format!(
                    "remove it; a `report` shows such a number: `value {name} = {}`",
                    match Statistic::of(&word.text) {
                        Some(Statistic::Least) => format!("minimum(run.{name})"),
                        Some(Statistic::Mean) => format!("mean(run.{name})"),
                        _ => format!("maximum(run.{name})"),
                    }
                )),
            None => message.with_help(format!(
                "state the output in an interface that the {} fills: `interface Name {{ … output {name}: … summary {} }}`",
                kind_word(own.declaration.kind),
                word.text
            )),
        };
        self.report(message);
    }

    fn unknown_summary(&mut self, word: &Name) {
        let words = Statistic::ALL.map(|(word, _)| word);
        let message = Diagnostic::error(
            codes::SUMMARY,
            format!("there is no summary `{}`", word.text),
        )
        .at(word.span, "not known");
        // words for the same thing in reports and mathematics
        let meant = match word.text.as_str() {
            "minimum" | "min" | "smallest" => Some("least"),
            "maximum" | "max" | "peak" | "greatest" => Some("largest"),
            "average" => Some("mean"),
            other => nearest(other, words),
        };
        self.report(match meant {
            Some(near) => message.meant(word.span, near),
            None => message.with_help("a summary is `least`, `largest` or `mean`"),
        });
    }

    fn summary_of_several(&mut self, output: &Binding, word: &Name, ty: &Type) {
        let name = &output.name.text;
        let message = Diagnostic::error(
            codes::SUMMARY,
            format!("the summary of `{name}` needs a single number"),
        );
        let message = if output.index.is_empty() {
            let found = self.describe(ty);
            message.at(word.span, format!("`{name}` is {found}"))
        } else {
            message.at(word.span, format!("`{name}` has an index"))
        };
        let help = match ty {
            Type::Vector { .. } | Type::List { .. } if output.index.is_empty() => format!(
                "add an output of one number: `output {name}_size: … = norm({name}, floor: …) summary {}`",
                word.text
            ),
            _ => "a table has one number for each element: add an output of one number".to_owned(),
        };
        self.report(message.with_help(help));
    }
}
