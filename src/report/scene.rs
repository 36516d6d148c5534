//! The moving bodies of an analysis: flexible ones with their shapes and stresses, rigid ones as simple
//! solids.

use super::describe::{BodyPicture, Matter};
use super::films::{Pictured, films};
use super::shapes::{outlined, solid};
use super::surface::{Thinned, thin};
use super::{At, stress};
use super::{Entry, ReportError};
use crate::cycle::shifted;
use crate::motion::{BodyMotion, moments};
use crate::results::Results;
use eng_flexible::store::StoredBody;
use eng_report::animation::{
    Animation, Films, FlexibleBody, ModeShape, NodeField, Pose, RigidBody, Surface,
};
use eng_report::page::Table;
use std::collections::BTreeMap;

/// Pictures leave out modes that move no node by more than this share of the largest modal motion. A choice:
/// it is below a pixel.
const MOVES: f64 = 1e-3;
/// Largest displacement as shown, as a share of the scene's size. A choice for the eye: it is seen, and parts
/// still fit together.
const SHOWN: f64 = 0.04;
/// Radius above which a disc is drawn as an outline, as a share of the flexible bodies' reach. A choice: a
/// flywheel would hide them.
const LARGE: f64 = 0.3;
/// Seconds in which a cycle is played. A choice for the eye.
const PLAYED: f64 = 8.0;
/// Bytes of a page for the films of an animation. A choice beside those of the bodies.
const FILMS: usize = 2_000_000;
/// Bytes in a page for each node and mode: three floats of single precision, deflated to about half, in
/// base64.
const BYTES: usize = 9;

/// The animation of an analysis, with notes and warnings.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The bodies and films with their motion.
    pub animation: Animation,
    /// Flexible bodies held on the ground. They hide the parts that move inside them.
    pub held: Vec<String>,
    /// Bodies that carry films.
    pub shells: Vec<String>,
    /// One sentence for each part that was thinned or left out.
    pub notes: Vec<String>,
    /// Requests that cannot be met.
    pub warnings: Vec<String>,
    /// Largest stresses, one table for each flexible body.
    pub maxima: Vec<Table>,
}

/// The scene of an analysis with a motion. Pictures of flexible bodies take at most about `budget` bytes of a page. The scene
/// shows stresses at the moments `at`, at the moment of each body's largest stress, and as an envelope.
pub fn scene(
    entry: &Entry,
    motion: &Results,
    budget: usize,
    at: &[At],
) -> Result<Scene, ReportError> {
    let (times, angles) = moments(motion);
    let angles: Vec<f64> = shifted(
        angles.unwrap_or_default(),
        entry.described.machine.cycle_period,
    )
    .iter()
    .map(|a| a.to_degrees())
    .collect();
    let (mut flexible, mut rigid) = (Vec::new(), Vec::new());
    let (mut notes, mut maxima, mut held) = (Vec::new(), Vec::new(), Vec::new());
    let all: usize = entry.described.bodies.iter().map(surface_nodes).sum();
    let mut warnings = Vec::new();
    let period = entry.described.machine.cycle_period;
    let mut chosen: Vec<usize> = Vec::new();
    for at in at {
        match at.nearest(&times, &angles, period) {
            Some(index) => chosen.push(index),
            None => {
                let (note, warning) = no_moment(*at);
                notes.push(note);
                warnings.push(warning);
            }
        }
    }
    let mut coverings = Vec::new();
    for body in &entry.described.bodies {
        let own = BodyMotion::of(motion, &body.path)?;
        let poses = poses(&own);
        match &body.matter {
            Matter::Flexible(reduction) => {
                let share = budget as f64 * surface_nodes(body) as f64 / all.max(1) as f64;
                let made = deforming(
                    body,
                    &reduction.stored,
                    &own,
                    poses,
                    (&times, share),
                    &mut notes,
                )?;
                let angle = |time: f64| {
                    let at = times.iter().position(|t| *t == time)?;
                    angles.get(at).copied()
                };
                if !made.peaks.is_empty() {
                    maxima.push(stress::table(
                        &format!(
                            "{}: largest von Mises stress at {} nodes of the surface, and when",
                            body.path,
                            made.peaks.len()
                        ),
                        &reduction.stored,
                        &made.peaks,
                        &angle,
                    ));
                }
                if reduction.stored.report.supported {
                    held.push(body.path.clone());
                }
                let largest = made
                    .peaks
                    .iter()
                    .max_by(|a, b| a.stress.total_cmp(&b.stress))
                    .and_then(|peak| times.iter().position(|t| *t == peak.time));
                chosen.extend(largest);
                coverings.push((&*reduction.stored, own.amplitudes, made.covering));
                flexible.push(made.body);
            }
            Matter::Rigid {
                mass,
                center,
                inertia,
                markers,
            } => rigid.push(RigidBody {
                name: body.path.clone(),
                parts: solid(*mass, *center, *inertia, markers),
                poses,
            }),
        }
    }
    chosen.sort_unstable();
    chosen.dedup();
    stresses(&mut flexible, &coverings, &chosen, (&times, &angles))?;
    let length = reach(&flexible);
    outline(&mut rigid, LARGE * length);
    let pictured = films(entry, motion, FILMS, (&times, &angles))?;
    let Pictured {
        films,
        shells,
        notes: of_films,
    } = pictured;
    notes.extend(of_films);
    if let Some(text) = motion.metadata().get("motion") {
        notes.push(format!("The motion is that of {text}."));
    }
    Ok(Scene {
        animation: Animation {
            title: format!("Motion, {}", entry.outcome.results.analysis()),
            angles,
            up: entry.described.up,
            scale: magnification(&flexible, length),
            slowdown: slowdown(&times),
            times,
            flexible,
            rigid,
            films,
        },
        held,
        shells,
        notes,
        warnings,
        maxima,
    })
}

/// Largest coordinate of flexible bodies in their own axes (m).
fn reach(flexible: &[FlexibleBody]) -> f64 {
    let nodes = flexible.iter().flat_map(|b| &b.surface.nodes);
    nodes.flatten().fold(0.0, |most, x| most.max(x.abs()))
}

/// Draws discs above a radius (m) as outlines.
fn outline(rigid: &mut [RigidBody], radius: f64) {
    for body in rigid {
        let parts = body.parts.drain(..);
        body.parts = parts.flat_map(|part| outlined(part, radius)).collect();
    }
}

/// The note and the warning about stresses at a moment that the motion does not have.
fn no_moment(at: At) -> (String, String) {
    (
        format!("Stresses at {at}: the motion has no such moment."),
        format!("no stresses at {at}: the motion has no such moment"),
    )
}

/// A reduced flexible body, its amplitudes at each time, and its drawn surface.
type Covered<'a> = (&'a StoredBody, Vec<Vec<f64>>, Covering);

/// Computes the stresses of each flexible body at the chosen moments, which are indices of samples.
fn stresses(
    flexible: &mut [FlexibleBody],
    coverings: &[Covered<'_>],
    chosen: &[usize],
    (times, angles): (&[f64], &[f64]),
) -> Result<(), ReportError> {
    for (body, (stored, amplitudes, covering)) in flexible.iter_mut().zip(coverings) {
        for index in chosen {
            let Some(amplitudes) = amplitudes.get(*index) else {
                continue;
            };
            let moment = match (angles.get(*index), times.get(*index)) {
                (Some(angle), _) => format!("{angle:.0} °CA"),
                (None, Some(time)) => format!("{:.3} ms", 1e3 * time),
                (None, None) => continue,
            };
            let values = stress::at(stored, &covering.all, amplitudes)?;
            if !values.is_empty() {
                body.fields
                    .push(covering.field(format!("von Mises at {moment}"), &values));
            }
        }
    }
    Ok(())
}

/// The factor by which an animation of these times (s) is slower than the machine.
fn slowdown(times: &[f64]) -> f64 {
    match (times.first(), times.last()) {
        (Some(first), Some(last)) if last > first => round(PLAYED / (last - first)),
        _ => 1.0,
    }
}

/// Factor on displacements that shows the largest one as a share of the scene; never below 1. `length` is the
/// scene's reach (m), half of its size.
fn magnification(flexible: &[FlexibleBody], length: f64) -> f64 {
    let largest = flexible
        .iter()
        .map(FlexibleBody::largest_displacement)
        .fold(0.0, f64::max);
    match largest > 0.0 {
        true => round(2.0 * SHOWN * length / largest).max(1.0),
        false => 1.0,
    }
}

impl Scene {
    /// One animation, or two if held bodies hide others: one of the moving bodies and one of the held bodies. Films
    /// are among the moving bodies. If a flexible one of these would hide a film, the films have an animation
    /// without it.
    pub fn views(&self) -> Vec<Animation> {
        let whole = &self.animation;
        let (held, free): (Vec<_>, Vec<_>) = whole
            .flexible
            .iter()
            .cloned()
            .partition(|body| self.held.contains(&body.name));
        let view =
            |name: &str, flexible: Vec<FlexibleBody>, rigid: Vec<RigidBody>, films: Films| {
                Animation {
                    title: format!("{}: {name}", whole.title),
                    flexible,
                    rigid,
                    films,
                    ..whole.clone()
                }
            };
        let divided = !held.is_empty() && (!free.is_empty() || !whole.rigid.is_empty());
        let first = if divided { &free } else { &whole.flexible };
        let covers = |body: &&FlexibleBody| self.shells.contains(&body.name);
        let hidden = !whole.films.surfaces.is_empty() && first.iter().any(|body| covers(&body));
        let shown = if hidden {
            Films::default()
        } else {
            whole.films.clone()
        };
        let mut views = if divided {
            vec![
                view("moving parts", free.clone(), whole.rigid.clone(), shown),
                view(&self.held.join(", "), held, Vec::new(), Films::default()),
            ]
        } else {
            vec![Animation {
                films: shown,
                ..whole.clone()
            }]
        };
        if hidden {
            let around = free.into_iter().filter(|body| !covers(&body)).collect();
            views.push(view(
                "films",
                around,
                whole.rigid.clone(),
                whole.films.clone(),
            ));
        }
        views
    }
}

/// The largest of 1, 2 and 5 times a power of ten that is not larger.
pub fn round(x: f64) -> f64 {
    if !(x > 0.0 && x.is_finite()) {
        return 1.0;
    }
    let power = libm::pow(10.0, libm::floor(libm::log10(x)));
    let lead = x / power;
    let step = if lead >= 5.0 {
        5.0
    } else if lead >= 2.0 {
        2.0
    } else {
        1.0
    };
    step * power
}

fn surface_nodes(body: &BodyPicture) -> usize {
    match &body.matter {
        Matter::Flexible(reduction) => reduction.stored.surface.nodes().len(),
        Matter::Rigid { .. } => 0,
    }
}

pub(super) fn poses(motion: &BodyMotion) -> Vec<Pose> {
    motion
        .positions
        .iter()
        .zip(&motion.orientations)
        .map(|(position, rotation)| Pose {
            position: *position,
            rotation: *rotation,
        })
        .collect()
}

/// Displacements of nodes for an amplitude of 1 (m), by mode.
pub(super) fn shapes(stored: &StoredBody, nodes: &[u32]) -> Vec<Vec<[f64; 3]>> {
    let size = stored.freedoms.size();
    (0..stored.body.invariants.modes)
        .map(|mode| {
            let along = |node: u32, component: u8| {
                let freedom = stored.freedoms.freedom(node, component);
                let value = freedom.and_then(|f| stored.shapes.get(mode * size + f));
                value.copied().unwrap_or(0.0)
            };
            nodes
                .iter()
                .map(|node| [0, 1, 2].map(|component| along(*node, component)))
                .collect()
        })
        .collect()
}

/// Place of a node in the body's axes (m).
pub(super) fn place(stored: &StoredBody, node: u32) -> [f64; 3] {
    let node = stored.mesh.nodes.get(node as usize);
    node.map_or([0.0; 3], |n| n.position)
}

struct Deforming {
    body: FlexibleBody,
    peaks: Vec<stress::Peak>,
    covering: Covering,
}

/// The kept node that represents each node of a surface.
struct Covering {
    /// Nodes of the whole surface.
    all: Vec<u32>,
    stands_for: BTreeMap<u32, u32>,
    kept: usize,
}

impl Covering {
    /// Stresses (Pa) of nodes as a field (MPa) of the kept ones.
    fn field(&self, name: String, values: &[(u32, f64)]) -> NodeField {
        let values = stress::by_place(values, &self.stands_for, self.kept);
        NodeField {
            name,
            unit: "MPa".to_owned(),
            values: values.into_iter().map(|v| 1e-6 * v).collect(),
        }
    }
}

fn deforming(
    picture: &BodyPicture,
    stored: &StoredBody,
    motion: &BodyMotion,
    poses: Vec<Pose>,
    (times, budget): (&[f64], f64),
    notes: &mut Vec<String>,
) -> Result<Deforming, ReportError> {
    let path = &picture.path;
    let modes = stored.body.invariants.modes;
    if motion.amplitudes.iter().any(|a| a.len() != modes) {
        return Err(ReportError::Modes {
            body: path.clone(),
            expected: modes,
            found: motion.amplitudes.first().map_or(0, Vec::len),
        });
    }
    let nodes = stored.surface.nodes();
    let peaks = stress::peaks(stored, &nodes, times, &motion.amplitudes)?;
    let moving = moving(stored, &nodes, &motion.amplitudes);
    let most = budget / (BYTES * (moving.len() + 3)) as f64;
    let Thinned {
        nodes: kept,
        triangles,
        stands_for,
    } = thin(
        stored.surface.triangles(),
        &|node| place(stored, node),
        // a choice: fewer nodes do not show a form
        (most as usize).max(100),
    );
    if kept.len() < nodes.len() {
        notes.push(format!(
            "{path}: {} of the {} nodes of the surface are shown, those that give its form best.",
            kept.len(),
            nodes.len()
        ));
    }
    if moving.len() < modes {
        notes.push(format!(
            "{path}: {} of {modes} modes are shown; the others move no node by more than {MOVES} of the largest motion.",
            moving.len()
        ));
    }
    if !stored.surface.lines().is_empty() {
        notes.push(format!("{path}: beams are not drawn."));
    }
    let all = shapes(stored, &kept);
    let shapes = moving
        .iter()
        .filter_map(|mode| {
            let report = stored.report.modes.get(*mode);
            Some(ModeShape {
                name: report.map_or_else(
                    || format!("mode {}", mode + 1),
                    |m| {
                        format!(
                            "mode {}, {:.0} Hz: {}",
                            mode + 1,
                            m.frequency,
                            m.description
                        )
                    },
                ),
                displacements: all.get(*mode)?.clone(),
            })
        })
        .collect();
    let covering = Covering {
        kept: kept.len(),
        stands_for,
        all: nodes,
    };
    let mut fields = Vec::new();
    if !peaks.is_empty() {
        let values: Vec<(u32, f64)> = peaks.iter().map(|p| (p.node, p.stress)).collect();
        fields.push(covering.field("von Mises, largest over the motion".to_owned(), &values));
    }
    Ok(Deforming {
        body: FlexibleBody {
            name: path.clone(),
            surface: Surface {
                nodes: kept.iter().map(|node| place(stored, *node)).collect(),
                triangles,
            },
            shapes,
            poses,
            amplitudes: motion
                .amplitudes
                .iter()
                .map(|a| moving.iter().filter_map(|m| a.get(*m).copied()).collect())
                .collect(),
            fields,
        },
        peaks,
        covering,
    })
}

/// The modes that move some node by more than a thousandth of the largest modal motion.
fn moving(stored: &StoredBody, nodes: &[u32], amplitudes: &[Vec<f64>]) -> Vec<usize> {
    let reach: Vec<f64> = shapes(stored, nodes)
        .iter()
        .enumerate()
        .map(|(mode, shape)| {
            let amplitude = amplitudes
                .iter()
                .filter_map(|a| a.get(mode))
                .fold(0.0f64, |most, a| most.max(a.abs()));
            let farthest = shape
                .iter()
                .map(|[x, y, z]| x * x + y * y + z * z)
                .fold(0.0, f64::max);
            amplitude * libm::sqrt(farthest)
        })
        .collect();
    let largest = reach.iter().copied().fold(0.0, f64::max);
    (0..reach.len())
        .filter(|mode| reach.get(*mode).is_some_and(|r| *r > MOVES * largest))
        .collect()
}
