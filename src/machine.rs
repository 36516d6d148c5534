//! The data of the machine behind results that tables and figures need: journals, summaries, cycle, firing order.

use crate::recorded_field::RecordedField;
use eng_report::figure::Upright;
use eng_system::code::Bound;
use eng_system::system::summary::{SummaryColumn, SummaryParameter};
use eng_system::system::{AnalysisKind, Rows, Slot, System};

/// A machine with the parameters of an analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Journals in the order of the text.
    pub journals: Vec<JournalGeometry>,
    /// Tables of the elements whose classes fill an interface with summaries.
    pub summaries: Vec<InterfaceSummary>,
    /// The cycle's period (rad), if the model has a cycle.
    pub cycle_period: Option<f64>,
    /// Whether the results are one cycle that repeats.
    pub periodic: bool,
    /// The shell axis that is drawn upwards.
    pub upright: Upright,
    /// Fields of the elements with outputs, in the order of the text.
    pub fields: Vec<RecordedField>,
    /// Firing dead centres: number of the cylinder, if it has one, and angle of the cycle (rad).
    pub firing: Vec<(Option<usize>, f64)>,
}

/// A journal for figures. A figure leaves out a column that is absent.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalGeometry {
    /// `main[1]`.
    pub path: String,
    /// Radial clearance (m).
    pub clearance: f64,
    /// Columns of the force on the pin (N) along x and y of the shell.
    pub force: [String; 2],
    /// Columns of the pin's centre from the shell's (m) along x and y of the shell.
    pub eccentricity: [String; 2],
}

/// The elements whose classes fill one interface, with the columns that its summaries read.
#[derive(Clone, Debug, PartialEq)]
pub struct InterfaceSummary {
    /// Name of the interface.
    pub interface: String,
    /// The parameters of the interface that are numbers.
    pub parameters: Vec<SummaryParameter>,
    /// The outputs with a summary.
    pub columns: Vec<SummaryColumn>,
    /// The elements in the order of the text.
    pub elements: Vec<SummarisedElement>,
}

/// A row of a summary before its numbers are read.
#[derive(Clone, Debug, PartialEq)]
pub struct SummarisedElement {
    /// `main[1]`.
    pub path: String,
    /// The values of the parameters (SI); NaN for one that depends on the motion.
    pub parameters: Vec<f64>,
    /// Names of the columns of results; `None` for an output that the element does not have.
    pub channels: Vec<Option<String>>,
}

impl Machine {
    /// The machine of a model with its numbers, in an analysis of this kind. It is without fields.
    pub(crate) fn new(system: &System, bound: &Bound, kind: &AnalysisKind) -> Machine {
        Machine {
            journals: journals(system, bound),
            summaries: summaries(system, bound),
            cycle_period: cycle_period(system, bound),
            periodic: kind.rows() == Rows::Cycle,
            upright: upright(system, bound),
            fields: Vec::new(),
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
            path: path_of(system, j.element),
            clearance: at(bound, j.clearance),
            force: [j.force, j.force + 1].map(|channel| column_of(system, channel)),
            eccentricity: [j.eccentricity, j.eccentricity + 1]
                .map(|channel| column_of(system, channel)),
        })
        .collect()
}

fn summaries(system: &System, bound: &Bound) -> Vec<InterfaceSummary> {
    let summaries = system.summaries.iter();
    summaries
        .map(|summary| InterfaceSummary {
            interface: summary.interface.clone(),
            parameters: summary.parameters.clone(),
            columns: summary.columns.clone(),
            elements: (summary.rows.iter())
                .map(|row| SummarisedElement {
                    path: path_of(system, row.element),
                    parameters: (row.parameters.iter())
                        .map(|slot| slot.map_or(f64::NAN, |slot| at(bound, slot)))
                        .collect(),
                    channels: (row.channels.iter())
                        .map(|channel| channel.map(|channel| column_of(system, channel)))
                        .collect(),
                })
                .collect(),
        })
        .collect()
}

fn path_of(system: &System, element: u32) -> String {
    let element = system.elements.get(element as usize);
    element.map_or_else(String::new, |element| element.origin.path.clone())
}

fn column_of(system: &System, channel: u32) -> String {
    let channel = system.channels.get(channel as usize);
    channel.map_or_else(String::new, |channel| channel.path.clone())
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

/// The firing angles of gas forces such as `gas[3]` and `cylinder[3].gas`, by the interface that their classes fill.
fn firing(system: &System, bound: &Bound) -> Vec<(Option<usize>, f64)> {
    system
        .firings
        .iter()
        .filter(|_| system.cycle.is_some())
        .filter_map(|firing| {
            let element = system.elements.get(firing.element as usize)?;
            let index = (element.origin.path)
                .rsplit_once('[')
                .and_then(|(_, rest)| rest.split_once(']'))
                .and_then(|(index, _)| index.parse().ok());
            Some((index, at(bound, firing.angle)))
        })
        .collect()
}
