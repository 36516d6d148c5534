//! The model of results: its inputs, journals and bodies with the numbers of the run.

use crate::machine::{Machine, at};
use crate::program::Program;
use crate::{Analysis, Error, Quantity, Reduction, Results};
use eng_grammar::{SourceId, SourceMap};
use eng_report::animation::Up;
use eng_system::DisplayUnit;
use eng_system::code::Bound;
use eng_system::system::{BodyInertia, BodyRef, Location, PointValue, System};
use std::collections::BTreeMap;

/// A parameter with its value and its default (SI).
#[derive(Clone, Debug, PartialEq)]
pub struct InputValue {
    /// `main[5].radial_clearance`.
    pub path: String,
    /// The value of the run.
    pub value: f64,
    /// The default value.
    pub default: f64,
    /// Open limits.
    pub limits: (f64, f64),
    /// The display unit.
    pub display: DisplayUnit,
    /// File and line of its default; empty if they are not known.
    pub stated_at: String,
    /// Whether the default is in the library's text, because the model states none.
    pub of_library: bool,
}

/// The axes of a marker.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerAxes {
    /// Path of the marker.
    pub marker: String,
    /// Path of its body; none on the ground.
    pub body: Option<String>,
    /// Rotation matrix marker → body, row-major.
    pub orientation: [f64; 9],
    /// Its origin in the axes of the body without deflection, or in those of the ground (m); `None` if it follows
    /// another marker.
    pub place: Option<[f64; 3]>,
}

/// Pin and shell of a journal.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalAxes {
    /// The axes of the pin, which turns.
    pub pin: MarkerAxes,
    /// The axes of the shell, in which forces and eccentricities are recorded.
    pub shell: MarkerAxes,
}

/// A place on a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// `big` of `rod[1].big`.
    pub name: String,
    /// Its position in the body's axes (m).
    pub place: [f64; 3],
}

/// The mass and shape of a body.
#[derive(Clone, Debug)]
pub enum Matter {
    /// A rigid body.
    Rigid {
        /// Mass (kg).
        mass: f64,
        /// Centre of mass (m, body axes).
        center: [f64; 3],
        /// Diagonal of the inertia about the centre of mass (kg m²).
        inertia: [f64; 3],
        /// Its markers.
        markers: Vec<Spot>,
    },
    /// A flexible body as it was reduced.
    Flexible(Reduction),
}

/// A body for tables and pictures.
#[derive(Clone, Debug)]
pub struct BodyPicture {
    /// Its path.
    pub path: String,
    /// Its mass and shape.
    pub matter: Matter,
}

/// The data that a report needs from the model of an analysis.
#[derive(Clone, Debug)]
pub struct Described {
    /// Hash of the texts as they are now.
    pub source_hash: String,
    /// Parameters with other values than the text states for the analysis, by `--set` or from another text,
    /// and these values.
    pub set: BTreeMap<String, String>,
    /// Parameters in a fixed order.
    pub inputs: Vec<InputValue>,
    /// The lints that the text accepts, one line for each.
    pub accepted: Vec<String>,
    /// Journals, cycle and firing order.
    pub machine: Machine,
    /// Pins and shells of the journals, in their order.
    pub axes: Vec<JournalAxes>,
    /// Its position in the sweep.
    pub point: Vec<PointValue>,
    /// The ground axis that points up.
    pub up: Up,
    /// Bodies in a fixed order.
    pub bodies: Vec<BodyPicture>,
}

impl Program {
    /// The data that a report needs from the models of results. Parameters have the values of the runs.
    ///
    /// # Errors
    /// The text does not have an analysis, or a model cannot be compiled or bound.
    pub fn describe(&self, results: &[&Results]) -> Result<Vec<Described>, Error> {
        let names: Vec<&str> = results.iter().map(|r| r.analysis()).collect();
        let analyses = self.analyses_of(&names).into_iter().zip(results);
        analyses
            .map(|(analysis, results)| Described::new(analysis?, results.metadata()))
            .collect()
    }
}

impl Described {
    /// The data of an analysis, with the parameters from the metadata of its results.
    pub(super) fn new(
        analysis: Analysis,
        metadata: &BTreeMap<String, String>,
    ) -> Result<Described, Error> {
        let source_hash = analysis.source_hash();
        let stated_values = analysis.bound()?.parameters;
        let analysis = with_parameters(analysis, metadata)?;
        let model = analysis.model().clone();
        let compiled = model.compiled();
        let system = &compiled.system;
        let bound = analysis.bound()?;
        let unset = vec![None; system.parameters.len()];
        let defaults = compiled
            .bind
            .bind(&unset, &system.tables)
            // if the defaults contradict each other, the text must state the parameters
            .map_or_else(|_| vec![f64::NAN; unset.len()], |bound| bound.parameters);
        let inputs = system
            .parameters
            .iter()
            .zip(bound.parameters.iter().zip(defaults))
            .map(|(p, (value, default))| {
                let (stated_at, of_library) = stated(model.texts(), p.origin.used_at);
                InputValue {
                    path: p.origin.path.clone(),
                    value: *value,
                    default,
                    limits: p.limits,
                    display: p.display.clone(),
                    stated_at,
                    of_library,
                }
            })
            .collect();
        let set = system
            .parameters
            .iter()
            .zip(bound.parameters.iter().zip(stated_values))
            .filter(|(_, (value, stated))| differ(**value, *stated))
            .map(|(p, (value, _))| (p.origin.path.clone(), p.display.text(*value)))
            .collect();
        Ok(Described {
            source_hash,
            set,
            inputs,
            accepted: {
                let sifted = crate::lint::sift(analysis.findings()?.list, system);
                crate::lint::accepted(system, &sifted.accepted)
            },
            machine: analysis.machine()?,
            axes: axes(system, &bound),
            point: analysis.point().to_vec(),
            up: up(system, &bound),
            bodies: bodies(system, &bound, model.reductions()),
        })
    }
}

/// File and line of a place, and whether it is the library's.
fn stated(texts: &SourceMap, place: Option<Location>) -> (String, bool) {
    let found = place.and_then(|place| {
        let source = SourceId(place.source);
        let (line, _) = texts.line_column(source, place.start)?;
        Some((texts.get(source)?.name.clone(), line))
    });
    match found {
        Some((name, line)) => (format!("{name}:{line}"), name.starts_with("std/")),
        None => (String::new(), false),
    }
}

fn axes(system: &System, bound: &Bound) -> Vec<JournalAxes> {
    system
        .journals
        .iter()
        .filter_map(|journal| {
            let element = system.elements.get(journal.element as usize)?;
            let marker = |index: u32| {
                let marker = element.markers.get(index as usize)?;
                let marker = system.markers.get(*marker as usize)?;
                Some(MarkerAxes {
                    marker: marker.origin.path.clone(),
                    body: match marker.body {
                        BodyRef::Ground => None,
                        BodyRef::Body(body) => {
                            Some(system.bodies.get(body as usize)?.origin.path.clone())
                        }
                    },
                    orientation: marker.orientation.map(|slot| at(bound, slot)),
                    place: (marker.placed_at.is_none())
                        .then(|| marker.position.map(|slot| at(bound, slot))),
                })
            };
            Some(JournalAxes {
                pin: marker(journal.pin)?,
                shell: marker(journal.shell)?,
            })
        })
        .collect()
}

/// Whether two values differ by more than rounding.
pub(super) fn differ(a: f64, b: f64) -> bool {
    (a - b).abs() > 1e-12 * a.abs().max(b.abs())
}

/// Sets the parameters whose values in the metadata differ from those of the analysis.
fn with_parameters(
    mut analysis: Analysis,
    metadata: &BTreeMap<String, String>,
) -> Result<Analysis, Error> {
    let bound = analysis.bound()?;
    let parameters = analysis.model().parameters();
    for (parameter, now) in parameters.into_iter().zip(bound.parameters) {
        let key = format!("parameter.{}", parameter.path);
        let stated = metadata.get(&key).and_then(|text| {
            let (number, unit) = text.split_once(' ').unwrap_or((text, "1"));
            if unit == parameter.display.symbol {
                return Some(parameter.display.to_si(number.parse().ok()?));
            }
            // written by another version, which showed it in another unit
            let other: Quantity = text.parse().ok()?;
            (other.dimension() == parameter.dimension).then_some(other.value())
        });
        if let Some(value) = stated
            && differ(value, now)
        {
            let handle = analysis.model().parameter(&parameter.path)?;
            analysis = analysis.set(handle, Quantity::si(value, parameter.dimension))?;
        }
    }
    Ok(analysis)
}

/// The axis along which gravity acts most; z without gravity.
fn up(system: &System, bound: &Bound) -> Up {
    let [x, y, z] = system.gravity.map(|slot| at(bound, slot).abs());
    if x > y && x > z {
        Up::X
    } else if y > z {
        Up::Y
    } else {
        Up::Z
    }
}

fn bodies(system: &System, bound: &Bound, reductions: &[Reduction]) -> Vec<BodyPicture> {
    system
        .bodies
        .iter()
        .zip(0u32..)
        .filter_map(|(body, index)| {
            let path = body.origin.path.clone();
            let matter = match &body.inertia {
                BodyInertia::Flexible(reduction) => {
                    Matter::Flexible(reductions.get(*reduction as usize)?.clone())
                }
                BodyInertia::Rigid {
                    mass,
                    center_of_mass,
                    inertia: [xx, yy, zz, ..],
                } => Matter::Rigid {
                    mass: at(bound, *mass),
                    center: center_of_mass.map(|slot| at(bound, slot)),
                    inertia: [*xx, *yy, *zz].map(|slot| at(bound, slot)),
                    markers: system
                        .markers
                        .iter()
                        .filter(|m| m.body == BodyRef::Body(index) && m.placed_at.is_none())
                        .map(|m| Spot {
                            name: m
                                .origin
                                .path
                                .strip_prefix(&path)
                                .map_or(m.origin.path.as_str(), |name| name.trim_start_matches('.'))
                                .to_owned(),
                            place: m.position.map(|slot| at(bound, slot)),
                        })
                        .collect(),
                },
            };
            Some(BodyPicture { path, matter })
        })
        .collect()
}
