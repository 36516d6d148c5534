//! Elements whose class fills an interface that the results use: film laws, the gas in a cylinder, and the interfaces
//! with summaries.
//!
//! This code names no member of an interface. The first marker of an interface moves, and the second is its
//! reference. The other members are known by their types. The clearance of a film is the length that its interface
//! resolves.

use super::super::scalar::Stage;
use super::super::value::{ScopeId, Value};
use super::super::{Elaborator, Eval};
use super::{Class, ClassScope};
use crate::codes;
use crate::program::DefinitionId;
use crate::typed::lineage::{self, ClassParameter, Level, levels};
use crate::typed::types::Type;
use eng_grammar::Diagnostic;
use eng_grammar::ast::{Binding, BindingKind, ItemKind, Kind, Statement};
use eng_system::Dimension;
use eng_system::system::summary::{
    Statistic, Summary, SummaryColumn, SummaryParameter, SummaryRow,
};
use eng_system::system::{FiringInfo, JournalInfo, Slot};

/// Data of an element for the results, besides its channels. The element has no index and no channels yet.
#[derive(Default)]
pub(super) struct Known {
    journal: Option<JournalInfo>,
    firing: Option<FiringInfo>,
    /// The place of the summary among those of the model, and the values of the interface's parameters.
    summary: Option<(usize, Vec<Option<Slot>>)>,
}

/// An output that an interface states, with its comment.
struct Promise<'a> {
    binding: &'a Binding,
    docs: &'a [String],
}

/// The outputs in the text of an interface.
fn outputs<'a>(level: &Level<'a>) -> impl Iterator<Item = Promise<'a>> {
    let items = level.block.items.iter();
    items.filter_map(|item| match &item.kind {
        ItemKind::Binding(binding) if binding.kind == BindingKind::Output => Some(Promise {
            binding,
            docs: &item.docs,
        }),
        _ => None,
    })
}

/// The summary that an output has.
fn statistic(output: &Promise<'_>) -> Option<Statistic> {
    let word = output.binding.summary.as_ref()?;
    Statistic::of(&word.text)
}

impl<'a> Elaborator<'a, '_> {
    /// The role of an element by the interfaces that its class fills.
    pub(super) fn by_interface(
        &mut self,
        class: &Class<'a>,
        scope: &ClassScope<'a>,
    ) -> Eval<Known> {
        let fills = |interface: &DefinitionId| self.program.fills(class.definition, *interface);
        let film = self.program.journal_law().filter(fills);
        let gas = self.program.gas_law().filter(fills);
        Ok(Known {
            journal: match film {
                Some(interface) => Some(self.film(class, interface, scope)?),
                None => None,
            },
            firing: match gas {
                Some(interface) => Some(self.gas(class, interface, scope.own)?),
                None => None,
            },
            summary: self.summary_of(class, scope.own)?,
        })
    }

    fn film(
        &mut self,
        class: &Class<'a>,
        interface: DefinitionId,
        scope: &ClassScope<'a>,
    ) -> Eval<JournalInfo> {
        let span = class.declaration.name.span;
        let [pin, shell] = self.two_markers(class, interface, scope.own)?;
        let of_law = class.levels.iter().zip(&scope.texts);
        let resolved = of_law
            .filter(|(level, _)| level.definition == interface)
            .flat_map(|(_, (items, scope))| items.iter().map(|item| (item, *scope)))
            .find_map(|(item, scope)| match &item.kind {
                ItemKind::Statement(Statement::Resolve(length)) => Some((length, scope)),
                _ => None,
            });
        let (length, scope) = self.checked(resolved, span, "a film that resolves no length")?;
        let value = self.evaluate(length, scope)?;
        let written = self.sources.text(length.span).to_owned();
        Ok(JournalInfo {
            element: 0,
            clearance: self.read_once(class, scope, &written, value)?,
            pin,
            shell,
            force: 0,
            eccentricity: 0,
        })
    }

    fn gas(
        &mut self,
        class: &Class<'a>,
        interface: DefinitionId,
        own: ScopeId,
    ) -> Eval<FiringInfo> {
        let [piston, head] = self.two_markers(class, interface, own)?;
        let bore = self.parameter_of(class, interface, Dimension::LENGTH)?;
        let angle = self.parameter_of(class, interface, Dimension::ANGLE)?;
        Ok(FiringInfo {
            element: 0,
            angle: self.measure(class, own, &angle.name.text)?,
            stated_as: angle.name.text.clone(),
            bore: self.measure(class, own, &bore.name.text)?,
            piston,
            head,
        })
    }

    /// Stores the data of an element with its index. Its channels exist now.
    pub(super) fn note(&mut self, known: Known, class: &Class<'a>, element: u32) -> Eval<()> {
        if let Some(film) = known.journal {
            let vector = |ty: &Type| matches!(ty, Type::Vector { .. });
            let plane = |ty: &Type| {
                matches!(
                    ty,
                    Type::List {
                        length: Some(2),
                        ..
                    }
                )
            };
            let force = self.channel_of_type(class, element, vector, Dimension::FORCE)?;
            let eccentricity = self.channel_of_type(class, element, plane, Dimension::LENGTH)?;
            self.draft.journals.push(JournalInfo {
                element,
                force,
                eccentricity,
                ..film
            });
        }
        let firing = known.firing;
        self.draft
            .firings
            .extend(firing.map(|info| FiringInfo { element, ..info }));
        if let Some((place, parameters)) = known.summary {
            self.summarise(place, parameters, class, element)?;
        }
        Ok(())
    }

    /// The parameter of an interface that is a number of a dimension. The library has one of each.
    fn parameter_of(
        &mut self,
        class: &Class<'a>,
        interface: DefinitionId,
        dimension: Dimension,
    ) -> Eval<ClassParameter<'a>> {
        let mut found = None;
        for parameter in lineage::parameters(self.program, interface) {
            let ty = self.type_at(parameter.ty.span)?;
            if let Type::Scalar(quantity) = ty
                && quantity.dim.base == dimension
            {
                found = found.or(Some(parameter));
            }
        }
        let span = class.declaration.name.span;
        self.checked(found, span, "an interface without this parameter")
    }

    /// The first channel of the output that an interface of films has of a type.
    fn channel_of_type(
        &mut self,
        class: &Class<'a>,
        element: u32,
        shape: impl Fn(&Type) -> bool,
        dimension: Dimension,
    ) -> Eval<u32> {
        let law = self.program.journal_law();
        let mut channel = None;
        for level in law.into_iter().flat_map(|law| levels(self.program, law)) {
            for Promise { binding, .. } in outputs(&level) {
                let Some(written) = &binding.ty else {
                    continue;
                };
                let ty = self.type_at(written.span)?;
                let each = ty.each().unwrap_or_default();
                if shape(&ty) && each.dim.base == dimension {
                    channel = channel.or(self.channel_of(element, &binding.name.text));
                }
            }
        }
        let span = class.declaration.name.span;
        self.checked(channel, span, "a film without this output")
    }

    /// The first channel of an output of an element.
    fn channel_of(&self, element: u32, output: &str) -> Option<u32> {
        let draft = self.draft.elements.get(element as usize)?;
        let shape = draft.outputs.iter().find(|shape| shape.name == output)?;
        Some(draft.first_channel + shape.first)
    }

    /// The summary of a class, and the values of the parameters of its interface. The interface is the eldest one
    /// with outputs that have a summary.
    fn summary_of(
        &mut self,
        class: &Class<'a>,
        own: ScopeId,
    ) -> Eval<Option<(usize, Vec<Option<Slot>>)>> {
        let of_interface = |level: &&Level<'a>| level.declaration.kind == Kind::Interface;
        let mut interfaces = class.levels.iter().filter(of_interface);
        let Some(eldest) =
            interfaces.find(|level| outputs(level).any(|output| statistic(&output).is_some()))
        else {
            return Ok(None);
        };
        let mut numbers = Vec::new();
        for parameter in lineage::parameters(self.program, eldest.definition) {
            if let Type::Scalar(quantity) = self.type_at(parameter.ty.span)? {
                numbers.push((parameter, quantity.dim.base));
            }
        }
        let mut values = Vec::with_capacity(numbers.len());
        for (parameter, _) in &numbers {
            let value = self.entry(own, &parameter.name.text, parameter.span)?;
            let number = self.as_scalar(value, parameter.span)?;
            let known = number.stage == Stage::Bind;
            values.push(known.then(|| self.slot(number.node)));
        }
        let place = self
            .draft
            .summaries
            .iter()
            .position(|(definition, _)| *definition == eldest.definition);
        if let Some(place) = place {
            return Ok(Some((place, values)));
        }
        let mut parameters = Vec::with_capacity(numbers.len());
        for (parameter, dimension) in numbers {
            parameters.push(SummaryParameter {
                name: parameter.name.text.clone(),
                dimension,
                display: match parameter.display {
                    Some(unit) => self.unit(unit)?.into(),
                    None => self.natural_unit(dimension),
                },
            });
        }
        let summary = Summary {
            interface: eldest.declaration.name.text.clone(),
            parameters,
            columns: Vec::new(),
            rows: Vec::new(),
        };
        self.draft.summaries.push((eldest.definition, summary));
        Ok(Some((self.draft.summaries.len() - 1, values)))
    }

    /// Adds the row of an element to a summary, and the columns that its interfaces add.
    fn summarise(
        &mut self,
        place: usize,
        parameters: Vec<Option<Slot>>,
        class: &Class<'a>,
        element: u32,
    ) -> Eval<()> {
        let mut read = Vec::new();
        for level in class.levels.iter() {
            for output in outputs(level) {
                let Some(statistic) = statistic(&output) else {
                    continue;
                };
                let name = &output.binding.name;
                let channel = self.channel_of(element, &name.text);
                let channel = self.checked(channel, name.span, "an output without a channel")?;
                let column = SummaryColumn {
                    output: name.text.clone(),
                    about: output.docs.join(" "),
                    statistic,
                };
                read.push((column, channel));
            }
        }
        let Some((_, summary)) = self.draft.summaries.get_mut(place) else {
            return Ok(());
        };
        let mut row = SummaryRow {
            element,
            parameters,
            channels: vec![None; summary.columns.len()],
        };
        for (column, channel) in read {
            let same = |other: &SummaryColumn| {
                (&other.output, other.statistic) == (&column.output, column.statistic)
            };
            match summary.columns.iter().position(same) {
                Some(at) => row.channels[at] = Some(channel),
                None => {
                    summary.columns.push(column);
                    row.channels.push(Some(channel));
                }
            }
        }
        summary.rows.push(row);
        Ok(())
    }

    /// The summaries of the model. Rows of classes without a column get an empty cell.
    pub fn finished_summaries(&mut self) -> Vec<Summary> {
        let summaries = std::mem::take(&mut self.draft.summaries).into_iter();
        let finished = summaries.map(|(_, mut summary)| {
            for row in &mut summary.rows {
                row.channels.resize(summary.columns.len(), None);
            }
            summary
        });
        finished.collect()
    }

    /// A number that the results read once, by the name that its interface gives it.
    fn measure(&mut self, class: &Class<'a>, own: ScopeId, name: &str) -> Eval<Slot> {
        let value = self.entry(own, name, class.declaration.name.span)?;
        self.read_once(class, own, name, value)
    }

    fn read_once(
        &mut self,
        class: &Class<'a>,
        own: ScopeId,
        name: &str,
        value: Value<'a>,
    ) -> Eval<Slot> {
        let class_name = &class.declaration.name;
        let number = self.as_scalar(value, class_name.span)?;
        if number.stage == Stage::Bind {
            return Ok(self.slot(number.node));
        }
        let path = self.scope(own).path.clone();
        Err(self.report(
            Diagnostic::error(
                codes::MOTION,
                format!("`{path}.{name}` depends on the motion"),
            )
            .at(
                class_name.span,
                format!("its interface requires `{name}` as a number that stays the same"),
            )
            .with_help("compute it from parameters; the law reads the motion from its markers"),
        ))
    }

    /// The first two markers of an interface, by their indices in the element.
    fn two_markers(
        &mut self,
        class: &Class<'a>,
        interface: DefinitionId,
        own: ScopeId,
    ) -> Eval<[u32; 2]> {
        let span = class.declaration.name.span;
        let mut found = Vec::new();
        for parameter in lineage::parameters(self.program, interface) {
            if self.type_at(parameter.ty.span)? == Type::Marker {
                let value = self.entry(own, &parameter.name.text, span)?;
                let marker = self.as_marker(value, span)?;
                found.push(self.local_marker(marker, Some(span))?);
            }
        }
        let two = <[u32; 2]>::try_from(found).ok();
        self.checked(two, span, "an interface with other than two markers")
    }
}
