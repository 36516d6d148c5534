//! The moving bodies of an analysis: flexible ones with their shapes and stresses, rigid ones as simple solids.

use super::describe::{BodyPicture, Matter, Spot};
use super::surface::{Thinned, thin};
use super::{Entry, ReportError, stress};
use crate::motion::{BodyMotion, moments};
use crate::results::Results;
use eng_flexible::store::StoredBody;
use eng_report::animation::{
    Animation, FlexibleBody, ModeShape, NodeField, Part, Pose, RigidBody, Surface,
};
use eng_report::page::Table;

/// Modes that move no node by more than this share of what the largest one does are left out of pictures.
const MOVES: f64 = 1e-3;
/// Largest displacement as shown, as a share of the scene's size.
const SHOWN: f64 = 0.04;
/// Radius above which a disc is drawn as an outline, as a share of the flexible bodies' reach.
const LARGE: f64 = 0.3;
/// Seconds in which a cycle is played.
const PLAYED: f64 = 8.0;
/// Bytes of a page a node and mode: three floats of single precision in base64.
const BYTES: usize = 16;

/// The animation of an analysis with what is to be said about it.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub animation: Animation,
    /// Flexible bodies that are held, which hide what moves within them.
    pub held: Vec<String>,
    /// What was thinned or left out, a sentence each.
    pub notes: Vec<String>,
    /// Largest stresses, a table a flexible body.
    pub maxima: Vec<Table>,
}

/// The motion of an analysis that has one; pictures of flexible bodies take no more than about `budget` bytes of a page.
pub(super) fn scene(entry: &Entry, motion: &Results, budget: usize) -> Result<Scene, ReportError> {
    let (times, angles) = moments(motion);
    let angles: Vec<f64> = shifted(angles.unwrap_or_default(), entry.described.cycle_period)
        .iter()
        .map(|a| a.to_degrees())
        .collect();
    let (mut flexible, mut rigid) = (Vec::new(), Vec::new());
    let (mut notes, mut maxima, mut held) = (Vec::new(), Vec::new(), Vec::new());
    let all: usize = entry.described.bodies.iter().map(surface_nodes).sum();
    for body in &entry.described.bodies {
        let motion = BodyMotion::of(motion, &body.path)?;
        let poses = poses(&motion);
        match &body.matter {
            Matter::Flexible(reduction) => {
                let share = budget as f64 * surface_nodes(body) as f64 / all.max(1) as f64;
                let made = deforming(
                    body,
                    &reduction.stored,
                    &motion,
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
    let largest = flexible
        .iter()
        .map(FlexibleBody::largest_displacement)
        .fold(0.0, f64::max);
    let length = flexible
        .iter()
        .flat_map(|b| &b.surface.nodes)
        .flatten()
        .fold(0.0f64, |most, x| most.max(x.abs()));
    for body in &mut rigid {
        let parts = body.parts.drain(..);
        body.parts = parts
            .flat_map(|part| outlined(part, LARGE * length))
            .collect();
    }
    let duration = match (times.first(), times.last()) {
        (Some(first), Some(last)) if last > first => last - first,
        _ => PLAYED,
    };
    if let Some(text) = motion.metadata().get("motion") {
        notes.push(format!("The motion is that of {text}."));
    }
    Ok(Scene {
        animation: Animation {
            title: format!("Motion, {}", entry.outcome.results.analysis()),
            times,
            angles,
            up: entry.described.up,
            scale: if largest > 0.0 {
                round(2.0 * SHOWN * length / largest).max(1.0)
            } else {
                1.0
            },
            slowdown: round(PLAYED / duration),
            flexible,
            rigid,
        },
        held,
        notes,
        maxima,
    })
}

impl Scene {
    /// The animation, or two where held bodies hide others: of what moves, and of what is held.
    pub fn views(&self) -> Vec<Animation> {
        let whole = &self.animation;
        let (held, free): (Vec<_>, Vec<_>) = whole
            .flexible
            .iter()
            .cloned()
            .partition(|body| self.held.contains(&body.name));
        if held.is_empty() || (free.is_empty() && whole.rigid.is_empty()) {
            return vec![whole.clone()];
        }
        let view = |name: &str, flexible: Vec<FlexibleBody>, rigid: Vec<RigidBody>| Animation {
            title: format!("{}: {name}", whole.title),
            flexible,
            rigid,
            ..whole.clone()
        };
        vec![
            view("moving parts", free, whole.rigid.clone()),
            view(&self.held.join(", "), held, Vec::new()),
        ]
    }
}

/// Angles less whole cycles, so that the first lies in the first cycle.
pub(crate) fn shifted(mut angles: Vec<f64>, period: Option<f64>) -> Vec<f64> {
    if let (Some(period), Some(first)) = (period.filter(|p| *p > 0.0), angles.first().copied()) {
        let whole = period * ((first + 1e-6) / period).floor();
        angles.iter_mut().for_each(|angle| *angle -= whole);
    }
    angles
}

/// The nearest below of 1, 2 and 5 times a power of ten.
fn round(x: f64) -> f64 {
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
        cell,
    } = thin(
        &stored.surface.triangles,
        &|node| place(stored, node),
        (most as usize).max(100),
    );
    if cell > 0.0 {
        notes.push(format!(
            "{path}: {} of the {} nodes of the surface are shown, one a cell of {:.1} mm.",
            kept.len(),
            nodes.len(),
            1e3 * cell
        ));
    }
    if moving.len() < modes {
        notes.push(format!(
            "{path}: {} of {modes} modes are shown; the others move no node by more than {MOVES} of what the largest does.",
            moving.len()
        ));
    }
    if !stored.surface.lines.is_empty() {
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
    let mut fields = Vec::new();
    if !peaks.is_empty() {
        let values = stress::by_place(&peaks, &stands_for, kept.len());
        fields.push(NodeField {
            name: "von Mises, largest over the motion".to_owned(),
            unit: "MPa".to_owned(),
            values: values.into_iter().map(|v| 1e-6 * v).collect(),
        });
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
    })
}

/// The modes that move some node by more than a thousandth of what the largest one does.
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

/// Bars from the first marker to the others; where all markers lie in one place, a cylinder or box of the body's mass and diagonal
/// inertia: `J_axis = m r²/2`, `J_across = m (3r² + h²)/12`, and for a box `a² = 6 (J_b + J_c − J_a)/m`.
fn solid(mass: f64, center: [f64; 3], inertia: [f64; 3], markers: &[Spot]) -> Vec<Part> {
    let between =
        |a: [f64; 3], b: [f64; 3]| libm::sqrt((0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum());
    let mut places: Vec<[f64; 3]> = Vec::new();
    for marker in markers {
        if places.iter().all(|p| between(*p, marker.place) > 1e-6) {
            places.push(marker.place);
        }
    }
    if let Some((first, others)) = places.split_first()
        && !others.is_empty()
    {
        return others
            .iter()
            .map(|to| Part::Cylinder {
                from: *first,
                to: *to,
                radius: 0.06 * between(*first, *to),
            })
            .collect();
    }
    let side = |i: usize| {
        let [own, one, other] = [inertia[i], inertia[(i + 1) % 3], inertia[(i + 2) % 3]];
        libm::sqrt((6.0 * (one + other - own) / mass).max(0.0))
    };
    let round = (0..3).find(|axis| {
        let (a, b) = (inertia[(axis + 1) % 3], inertia[(axis + 2) % 3]);
        (a - b).abs() <= 0.02 * a.max(b)
    });
    let part = match round {
        Some(axis) => {
            let across = inertia[(axis + 1) % 3];
            let square = 2.0 * inertia[axis] / mass;
            let radius = libm::sqrt(square.max(0.0));
            let height = libm::sqrt((12.0 * across / mass - 3.0 * square).max(0.0));
            // a disc without thickness would not be seen from its side
            let half = 0.5 * height.max(0.04 * radius);
            let (mut from, mut to) = (center, center);
            from[axis] -= half;
            to[axis] += half;
            Part::Cylinder { from, to, radius }
        }
        None => Part::Box {
            center,
            size: [side(0), side(1), side(2)],
        },
    };
    let finite = match &part {
        Part::Cylinder { radius, .. } => radius.is_finite() && *radius > 0.0,
        Part::Box { size, .. } => size.iter().all(|s| s.is_finite()),
        _ => true,
    };
    if finite { vec![part] } else { Vec::new() }
}

/// A cylinder as its two rims and four lines along it where its radius (m) is larger, so that it hides nothing.
fn outlined(part: Part, larger: f64) -> Vec<Part> {
    let Part::Cylinder { from, to, radius } = part else {
        return vec![part];
    };
    let axis = (0..3).find(|i| from[*i] != to[*i]);
    let along = (0..3).filter(|i| from[*i] != to[*i]).count() == 1;
    let Some(axis) = axis.filter(|_| along && larger > 0.0 && radius > larger) else {
        return vec![Part::Cylinder { from, to, radius }];
    };
    let at = |center: [f64; 3], side: u32| {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * f64::from(side) / 48.0);
        let mut point = center;
        point[(axis + 1) % 3] += radius * cosine;
        point[(axis + 2) % 3] += radius * sine;
        point
    };
    let rim = |center| Part::Line {
        points: (0..=48).map(|side| at(center, side)).collect(),
    };
    let mut lines = vec![rim(from), rim(to)];
    lines.extend([0, 12, 24, 36].map(|side| Part::Line {
        points: vec![at(from, side), at(to, side)],
    }));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solid_has_the_bodys_mass_and_inertia() {
        // a disc of 11 kg: radius 0.15, height 0.02
        let (mass, radius, height) = (11.0, 0.15, 0.02);
        let across = mass * (3.0 * radius * radius + height * height) / 12.0;
        let inertia = [across, across, 0.5 * mass * radius * radius];
        match solid(mass, [0.0, 0.0, 0.01], inertia, &[]).as_slice() {
            [
                Part::Cylinder {
                    from,
                    to,
                    radius: r,
                },
            ] => {
                assert!((r - radius).abs() < 1e-12);
                assert!((from[2]).abs() < 1e-12 && (to[2] - 0.02).abs() < 1e-12);
            }
            other => panic!("{other:?}"),
        }
        let [a, b, c] = [0.1, 0.2, 0.3];
        let box_inertia = [b * b + c * c, a * a + c * c, a * a + b * b].map(|s| s / 12.0);
        match solid(1.0, [0.0; 3], box_inertia, &[]).as_slice() {
            [Part::Box { size, .. }] => {
                assert!(
                    size.iter()
                        .zip([a, b, c])
                        .all(|(x, y)| (x - y).abs() < 1e-12)
                );
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn large_discs_are_outlines_of_their_size() {
        let disc = |radius| Part::Cylinder {
            from: [0.0, 0.0, -0.01],
            to: [0.0, 0.0, 0.01],
            radius,
        };
        assert_eq!(outlined(disc(0.05), 0.1), [disc(0.05)]);
        let lines = outlined(disc(0.15), 0.1);
        assert_eq!(lines.len(), 6);
        for line in lines {
            let Part::Line { points } = line else {
                panic!("{line:?}");
            };
            for [x, y, z] in points {
                assert!((libm::hypot(x, y) - 0.15).abs() < 1e-12 && z.abs() == 0.01);
            }
        }
        // a bar that lies askew stays a bar
        let askew = Part::Cylinder {
            from: [0.0; 3],
            to: [1.0, 1.0, 0.0],
            radius: 0.2,
        };
        assert_eq!(outlined(askew.clone(), 0.1), [askew]);
    }

    #[test]
    fn scales_are_round_numbers() {
        assert_eq!(
            [999.0, 200.0, 7.0, 0.3].map(round),
            [500.0, 200.0, 5.0, 0.2]
        );
        assert_eq!(round(f64::NAN), 1.0);
    }
}
