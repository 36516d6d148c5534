//! The data of the machine behind results that tables and figures need: journals, cycle, firing order.

use eng_report::figure::Upright;
use eng_system::code::Bound;
use eng_system::system::{AnalysisKind, Rows, Slot, System};

/// A machine with the parameters of an analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Journals in the order of the text.
    pub journals: Vec<JournalGeometry>,
    /// The cycle's period (rad), if the model has a cycle.
    pub cycle_period: Option<f64>,
    /// Whether the analysis asks for one cycle that repeats.
    pub periodic: bool,
    /// The shell axis that is drawn upwards.
    pub upright: Upright,
    /// Firing dead centres: number of the cylinder, if it has one, and angle of the cycle (rad).
    pub firing: Vec<(Option<usize>, f64)>,
}

/// A journal for tables and figures. Columns are named by the journal's path: `main[1].force.x` and `.y` (N),
/// `main[1].eccentricity.x` and `.y` (m, pin's centre from the shell's along the shell's axes),
/// `main[1].minimum_film` (m), `main[1].power_loss` (W). A table or figure leaves out a column that is
/// absent.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalGeometry {
    /// `main[1]`.
    pub path: String,
    /// Diameter (m).
    pub diameter: f64,
    /// Width (m).
    pub width: f64,
    /// Radial clearance (m).
    pub radial_clearance: f64,
}

impl Machine {
    /// From a model with its numbers, as an analysis of this kind runs it.
    pub(crate) fn new(system: &System, bound: &Bound, kind: &AnalysisKind) -> Machine {
        Machine {
            journals: journals(system, bound),
            cycle_period: cycle_period(system, bound),
            periodic: kind.rows() == Rows::Cycle,
            upright: upright(system, bound),
            firing: firing(system, bound),
        }
    }
}

/// The value of a slot (SI).
pub(crate) fn at(bound: &Bound, slot: Slot) -> f64 {
    // the compiler gives each slot its place; a missing one would be a fault of the compiler and shows as NaN
    bound
        .slots
        .get(slot.0 as usize)
        .copied()
        .unwrap_or(f64::NAN)
}

/// The period of the cycle (rad), if the model has one.
pub(crate) fn cycle_period(system: &System, bound: &Bound) -> Option<f64> {
    let cycle = system.cycle.as_ref()?;
    bound.slots.get(cycle.period.0 as usize).copied()
}

fn journals(system: &System, bound: &Bound) -> Vec<JournalGeometry> {
    system
        .journals
        .iter()
        .map(|j| JournalGeometry {
            path: system
                .elements
                .get(j.element as usize)
                .map(|e| e.origin.path.clone())
                .unwrap_or_default(),
            diameter: at(bound, j.diameter),
            width: at(bound, j.width),
            radial_clearance: at(bound, j.radial_clearance),
        })
        .collect()
}

/// Orbits are drawn with gravity downwards.
fn upright(system: &System, bound: &Bound) -> Upright {
    let gravity = system.gravity.map(|slot| at(bound, slot));
    if gravity[0].abs() > gravity[1].abs() {
        Upright::X
    } else {
        Upright::Y
    }
}

/// The firing angles of gas forces such as `gas[3]`, by the interface that their classes fill.
fn firing(system: &System, bound: &Bound) -> Vec<(Option<usize>, f64)> {
    system
        .firings
        .iter()
        .filter(|_| system.cycle.is_some())
        .filter_map(|firing| {
            let element = system.elements.get(firing.element as usize)?;
            let index = (element.origin.path)
                .strip_suffix(']')
                .and_then(|owner| owner.rsplit_once('['))
                .and_then(|(_, index)| index.parse().ok());
            Some((index, at(bound, firing.angle)))
        })
        .collect()
}
