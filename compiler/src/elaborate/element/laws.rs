//! Elements whose class fills an interface that the results use: film laws, and the gas in a cylinder.

use super::super::scalar::Stage;
use super::super::value::ScopeId;
use super::super::{Elaborator, Eval};
use super::Class;
use crate::codes;
use crate::program::DefinitionId;
use eng_grammar::Diagnostic;
use eng_system::system::{FiringInfo, JournalInfo, Slot};

/// Data of an element for the results, besides its channels. The element has no index yet.
#[derive(Default)]
pub(super) struct Known {
    journal: Option<JournalInfo>,
    firing: Option<FiringInfo>,
}

impl<'a> Elaborator<'a, '_> {
    /// The role of an element by the interface that its class declares. Names are those of the interface.
    pub(super) fn by_interface(&mut self, class: &Class<'a>, own: ScopeId) -> Eval<Known> {
        let fills = |interface: Option<DefinitionId>| {
            interface.is_some_and(|interface| self.program.fills(class.definition, interface))
        };
        let is_film = fills(self.program.journal_law());
        let fires = fills(self.program.gas_law());
        let mut known = Known::default();
        if is_film {
            known.journal = Some(JournalInfo {
                element: 0,
                diameter: self.measure(class, own, "diameter")?,
                width: self.measure(class, own, "width")?,
                radial_clearance: self.measure(class, own, "radial_clearance")?,
                pin: self.marker_of_law(class, own, "pin")?,
                shell: self.marker_of_law(class, own, "shell")?,
            });
        }
        if fires {
            known.firing = Some(FiringInfo {
                element: 0,
                angle: self.measure(class, own, "firing")?,
                bore: self.measure(class, own, "bore")?,
                piston: self.marker_of_law(class, own, "piston")?,
                head: self.marker_of_law(class, own, "head")?,
            });
        }
        Ok(known)
    }

    /// Stores the data of an element with its index.
    pub(super) fn note(&mut self, known: Known, element: u32) {
        let journal = known.journal;
        self.draft
            .journals
            .extend(journal.map(|info| JournalInfo { element, ..info }));
        let firing = known.firing;
        self.draft
            .firings
            .extend(firing.map(|info| FiringInfo { element, ..info }));
    }

    /// A number of the interface.
    fn measure(&mut self, class: &Class<'a>, own: ScopeId, name: &str) -> Eval<Slot> {
        let class_name = &class.declaration.name;
        let value = self.entry(own, name, class_name.span)?;
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
            .at(class_name.span, format!("its interface asks for `{name}`, which the results read once"))
            .with_help("give it a number that follows from parameters; what moves enters the law by its markers"),
        ))
    }

    /// A marker of the interface, by its index in the element.
    fn marker_of_law(&mut self, class: &Class<'a>, own: ScopeId, name: &str) -> Eval<u32> {
        let span = class.declaration.name.span;
        let value = self.entry(own, name, span)?;
        let marker = self.as_marker(value, span)?;
        self.local_marker(marker, Some(span))
    }
}
