//! Lints of springs that carry weight: they are too soft for it, or push along gravity.

use super::assembled::{Start, mm};
use super::{Finding, short};
use crate::codes;
use eng_runtime::loose::{pushed_down, sag};
use eng_system::Dimension;
use eng_system::lint;
use eng_system::system::Origin;

/// A machine has no effective springs if it sinks under its weight by this share of the model's length, or of
/// the spring's length if that is larger. A choice: no spring of a machine is compressed by half of its
/// length under the weight alone.
const SINKS: f64 = 0.5;

impl Start<'_> {
    /// A spring on which a body sinks by a distance as large as the machine.
    pub(super) fn sinks(&self) -> Option<Finding> {
        // if it cannot be evaluated, the run reports the error
        let (element, way) = sag(self.model, self.state, self.gravity()).ok().flatten()?;
        // the stiffness of a film at rest is no number of the text
        let journals = &self.model.compiled.system.journals;
        if journals.iter().any(|j| j.element as usize == element) {
            return None;
        }
        // the model's length is that of its bodies; a spring may be longer than all of them
        let apart = self.pair(element).map_or(0.0, |markers| {
            let [a, b] = markers.map(|marker| self.marker(marker));
            (a.position - b.position).norm()
        });
        if way < SINKS * self.model.length.max(apart) {
            return None;
        }
        let message = format!(
            "it yields by {} mm under the weight that it carries: is its stiffness in the right unit?",
            mm(way)
        );
        let mut finding = self.finding(codes::SINKS, lint::SAG, element, message);
        finding.help = "1 N/mm are 1000 N/m".to_owned();
        let stiffness = Dimension::MASS.over(Dimension::TIME.times(Dimension::TIME));
        super::decide(&mut finding, self.stated_numbers(element, stiffness));
        Some(finding)
    }

    /// Springs that push a body along gravity with a force of the size of its weight: a preload, or gravity, has the
    /// wrong sign.
    pub(super) fn pushed_down(&self) -> Option<Finding> {
        // if it cannot be evaluated, the run reports the error
        let found = pushed_down(self.model, self.state, self.gravity());
        let pushed = found.ok().flatten()?;
        let system = &self.model.compiled.system;
        let body = system.bodies[pushed.body].origin.path.as_str();
        let [force, carried] = [pushed.force, pushed.carried].map(|force| short(force, 3));
        let message = match pushed.all {
            true => format!(
                "before any motion the springs of {body} push it along gravity with {force} N, and the weight that they carry is {carried} N: has a preload or gravity the wrong sign?"
            ),
            false => format!(
                "before any motion it pushes {body} along gravity, with {force} N in all; in the other direction the springs of {body} would carry its weight of {carried} N: has its preload the wrong sign?"
            ),
        };
        let mut finding = self.finding(codes::SINKS, lint::SAG, pushed.spring, message);
        finding.help =
            "a preload that carries a weight acts on the body against gravity".to_owned();
        let mut places = self.stated_numbers(pushed.spring, Dimension::FORCE);
        places.extend(system.stated.get("gravity").map(|at| Origin {
            path: "gravity".to_owned(),
            used_at: Some(*at),
            defined_at: None,
        }));
        super::decide(&mut finding, places);
        Some(finding)
    }

    /// The parameters of a dimension that decide the constants of an element.
    fn stated_numbers(&self, element: usize, dimension: Dimension) -> Vec<Origin> {
        let system = &self.model.compiled.system;
        let constants = system.elements[element].constants.iter();
        let parameters = constants
            .flat_map(|slot| self.model.compiled.bind.parameters_of(*slot))
            .filter_map(|index| system.parameters.get(index as usize))
            .filter(|parameter| parameter.dimension == dimension);
        parameters
            .map(|parameter| parameter.origin.clone())
            .collect()
    }
}
