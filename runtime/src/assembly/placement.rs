//! Placing of bodies one by one, along the joints to placed bodies.

use super::closing::{bodies_of, close};
use super::rows::{self, Preference, Rows};
use super::{at, is_closed, violated_branches};
use crate::error::RuntimeError;
use crate::model::Model;
use crate::rotation::{M3, V3, exponential, normalized, product, quaternion};
use crate::state::State;
use eng_system::Dimension;

/// The 24 rotations of a cube, the identity first.
pub fn cube_rotations() -> Vec<M3> {
    let mut found = Vec::new();
    let axes = [
        (0, 1, 2),
        (1, 2, 0),
        (2, 0, 1),
        (0, 2, 1),
        (1, 0, 2),
        (2, 1, 0),
    ];
    for (x, y, z) in axes {
        for signs in [
            [1.0, 1.0, 1.0],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0],
            [-1.0, -1.0, -1.0],
            [-1.0, 1.0, 1.0],
            [1.0, -1.0, 1.0],
            [1.0, 1.0, -1.0],
        ] {
            let mut m = M3::zeros();
            m[(0, x)] = signs[0];
            m[(1, y)] = signs[1];
            m[(2, z)] = signs[2];
            if m.determinant() > 0.0 {
                found.push(m);
            }
        }
    }
    found
}

/// Positions and orientations of bodies that the text states by `start` or `guess`.
#[derive(Clone, Debug, Default)]
pub struct Stated {
    /// Whether the position is stated, also by a marker that follows it.
    pub(super) position: Vec<bool>,
    /// Whether the orientation is stated.
    pub(super) orientation: Vec<bool>,
}

/// Places every body without a stated position that rows connect to placed bodies or ground. The body with
/// the most rows to placed bodies is next; among equals the order of the bodies decides. Rows of angles alone place no
/// body: a drive between ground and flywheel leaves the place of a carried engine open. Unconnected bodies
/// keep their position and count as placed. A guess is the first position of the search. Its rows are not
/// among `elements`, because they would never close together with the joints.
pub fn place(
    model: &Model,
    elements: &[usize],
    state: &mut State,
    stated: &Stated,
) -> Result<(), RuntimeError> {
    let cubes = cube_rotations();
    let preferences = rows::preferences(model);
    // Stated bodies first satisfy rows to ground alone, such as a start angle, beginning at their stated
    // position.
    let mut placed = vec![false; model.bodies.len()];
    for body in (0..model.bodies.len()).filter(|b| stated.position[*b]) {
        place_one(
            model,
            elements,
            body,
            &Known::of(stated, &placed, &preferences),
            &cubes,
            state,
        )?;
    }
    placed.copy_from_slice(&stated.position);
    loop {
        let mut next: Option<(usize, usize)> = None;
        for body in (0..model.bodies.len()).filter(|b| !placed[*b]) {
            let near = connecting(model, elements, body, &placed);
            let rows: usize = near.iter().map(|e| model.class(*e).rows.len()).sum();
            // preferences place a body like joints: a crank comes before its rods, whose position depends on it
            let preferences = preferred(model, &preferences, &[body], &placed);
            let rows = rows
                + preferences
                    .iter()
                    .map(|preference| preference.range().len())
                    .sum::<usize>();
            let placing = !preferences.is_empty() || near.iter().any(|e| places(model, *e));
            if placing && next.is_none_or(|(most, _)| rows > most) {
                next = Some((rows, body));
            }
        }
        // If no row leads to another body, the first body from which others can be placed keeps its position. It follows
        // rows of angles alone.
        let first = || (0..model.bodies.len()).find(|b| !placed[*b]);
        let Some(body) = next.map(|(_, body)| body).or_else(first) else {
            return Ok(());
        };
        place_one(
            model,
            elements,
            body,
            &Known::of(stated, &placed, &preferences),
            &cubes,
            state,
        )?;
        placed[body] = true;
    }
}

/// Whether an element has other equations than those of angles.
fn places(model: &Model, element: usize) -> bool {
    let of_angles = [Dimension::ONE, Dimension::ANGLE];
    let mut rows = model.class(element).rows.iter();
    rows.any(|row| !of_angles.contains(&row.dimension))
}

fn connecting(model: &Model, elements: &[usize], body: usize, placed: &[bool]) -> Vec<usize> {
    elements
        .iter()
        .copied()
        .filter(|e| {
            let touched = bodies_of(model, *e);
            touched.contains(&body) && touched.iter().all(|b| *b == body || placed[*b])
        })
        .collect()
}

/// Preferences between a body of `moving` and a placed body, or between two bodies of `moving`.
fn preferred(
    model: &Model,
    preferences: &[Preference],
    moving: &[usize],
    placed: &[bool],
) -> Vec<Preference> {
    let stands = |m: usize| model.markers[m].body.is_none_or(|b| placed[b]);
    let moves = |m: usize| model.markers[m].body.is_some_and(|b| moving.contains(&b));
    let between = |a: usize, b: usize| moves(a) && (stands(b) || moves(b));
    preferences
        .iter()
        .copied()
        .filter(|preference| {
            between(preference.pin, preference.shell) || between(preference.shell, preference.pin)
        })
        .collect()
}

/// Places a body on placed bodies. If this leaves it open or on a wrong branch, its placed neighbours without
/// a stated position move with it: a rod pushes its piston along the liner.
fn place_one(
    model: &Model,
    elements: &[usize],
    body: usize,
    known: &Known<'_>,
    cubes: &[M3],
    state: &mut State,
) -> Result<(), RuntimeError> {
    let near = connecting(model, elements, body, known.placed);
    let alone = vec![body];
    // a body with a stated position follows no preference
    let preferences_of = |moving: &[usize]| match known.stated.position[body] {
        true => Vec::new(),
        false => preferred(model, known.preferences, moving, known.placed),
    };
    let preferences = preferences_of(&alone);
    if near.is_empty() && preferences.is_empty() {
        return Ok(());
    }
    if near.is_empty() {
        // nothing else decides the orientation, so the body moves to the height without turning
        let pose = model.bodies[body].pose;
        for preference in &preferences {
            let is_own = model.markers[preference.pin].body == Some(body);
            let way = preference.way_up(model, &at(state)) * if is_own { 1.0 } else { -1.0 };
            for i in 0..3 {
                state.pose[pose + i] += way[i];
            }
        }
    }
    let mut partners = Vec::new();
    for e in &near {
        let markers = &model.elements[*e].markers;
        let of = |own: bool| {
            let mut markers = markers.iter().copied();
            markers.find(|m| (model.markers[*m].body == Some(body)) == own)
        };
        partners.extend(of(true).zip(of(false)));
    }
    for preference in &preferences {
        let of_pin = model.markers[preference.pin].body == Some(body);
        partners.push(if of_pin {
            (preference.pin, preference.shell)
        } else {
            (preference.shell, preference.pin)
        });
    }
    let rows = Wanted {
        elements: &near,
        preferences: &preferences,
        stated: known.stated,
    };
    let mut best = search(model, &rows, &partners, body, &alone, cubes, state)?;
    if best.key != DONE {
        let films = preferences
            .iter()
            .flat_map(|preference| [preference.pin, preference.shell]);
        let films = films.filter_map(|m| model.markers[m].body);
        let mut moving: Vec<usize> = near
            .iter()
            .flat_map(|e| bodies_of(model, *e))
            .chain(films)
            .filter(|b| *b != body && !known.stated.position[*b])
            .collect();
        moving.sort_unstable();
        moving.dedup();
        if !moving.is_empty() {
            moving.push(body);
            let around: Vec<usize> = elements
                .iter()
                .copied()
                .filter(|e| {
                    let touched = bodies_of(model, *e);
                    touched.iter().any(|b| moving.contains(b))
                        && touched.iter().all(|b| *b == body || known.placed[*b])
                })
                .collect();
            let preferences = preferences_of(&moving);
            let rows = Wanted {
                elements: &around,
                preferences: &preferences,
                stated: known.stated,
            };
            let together = search(model, &rows, &partners, body, &moving, cubes, state)?;
            if together.key < best.key {
                best = together;
            }
            if best.key != DONE {
                let turning = Turning {
                    body,
                    near: &near,
                    partners: &partners,
                    moving: &moving,
                    carriers: carriers(model, &around, &preferences, body, &moving),
                };
                best = turn_neighbours(model, &rows, &turning, cubes, state, best)?;
            }
        }
    }
    *state = best.state;
    Ok(())
}

/// A body and the placed neighbours that move with it.
struct Turning<'a> {
    body: usize,
    /// The elements between the body and placed bodies, and their markers: its own, and that of the partner.
    near: &'a [usize],
    partners: &'a [(usize, usize)],
    moving: &'a [usize],
    /// The joints and films that carry each neighbour: the neighbour, its marker, and the marker of the partner.
    carriers: Vec<[usize; 3]>,
}

/// The joints and films between placed neighbours of a body and others.
fn carriers(
    model: &Model,
    elements: &[usize],
    preferences: &[Preference],
    body: usize,
    moving: &[usize],
) -> Vec<[usize; 3]> {
    let joints = elements
        .iter()
        .filter_map(|e| match model.elements[*e].markers[..] {
            [a, b, ..] => Some([a, b]),
            _ => None,
        });
    let films = preferences
        .iter()
        .map(|preference| [preference.pin, preference.shell]);
    let of = |marker: usize| model.markers[marker].body;
    let both = joints.chain(films).flat_map(|[a, b]| [[a, b], [b, a]]);
    let carried = both.filter_map(|[own, partner]| {
        let neighbour = of(own).filter(|b| *b != body && moving.contains(b))?;
        (of(partner) != Some(body) && of(partner) != Some(neighbour))
            .then_some([neighbour, own, partner])
    });
    carried.collect()
}

impl Turning<'_> {
    /// A state in which the body satisfies its rows to bodies that do not move with it: a piston in its bore, wherever
    /// its rod is.
    fn alone(
        &self,
        model: &Model,
        stated: &Stated,
        cubes: &[M3],
        state: &State,
    ) -> Result<State, RuntimeError> {
        let stands = |b: usize| b == self.body || !self.moving.contains(&b);
        let elements: Vec<usize> = (self.near.iter().copied())
            .filter(|e| bodies_of(model, *e).into_iter().all(stands))
            .collect();
        if elements.is_empty() {
            return Ok(state.clone());
        }
        let partners: Vec<(usize, usize)> = (self.partners.iter().copied())
            .filter(|(_, partner)| model.markers[*partner].body.is_none_or(stands))
            .collect();
        let rows = Wanted {
            elements: &elements,
            preferences: &[],
            stated,
        };
        let found = search(
            model,
            &rows,
            &partners,
            self.body,
            &[self.body],
            cubes,
            state,
        )?;
        Ok(found.state)
    }
}

/// Turns the neighbours of a body one after the other about the axes of the joints and films that carry them, and
/// closes the rows from there. A rod that points away from its bore does not come there by small steps: where rod and
/// bore are in line, turning the rod does not move its end along the bore. Returns `best` if nothing is better.
fn turn_neighbours(
    model: &Model,
    wanted: &Wanted<'_>,
    turning: &Turning<'_>,
    cubes: &[M3],
    state: &State,
    mut best: Trial,
) -> Result<Trial, RuntimeError> {
    let from = turning.alone(model, wanted.stated, cubes, state)?;
    for [neighbour, own, partner] in &turning.carriers {
        let axis = rows::marker(model, *partner, &from.pose, &from.velocity).rotation;
        for turn in std::iter::once(0.0).chain(TURNS) {
            let axis: V3 = axis.column(2) * f64::to_radians(turn);
            let trial = turned(model, *neighbour, *own, axis, &from);
            let (body, moving) = (turning.body, turning.moving);
            let found = search(model, wanted, &[], body, moving, cubes, &trial)?;
            if found.key < best.key {
                best = found;
            }
            if best.key == DONE {
                return Ok(best);
            }
        }
    }
    Ok(best)
}

/// The bodies with a position: stated in the text, or found so far.
struct Known<'a> {
    stated: &'a Stated,
    placed: &'a [bool],
    preferences: &'a [Preference],
}

impl<'a> Known<'a> {
    fn of(stated: &'a Stated, placed: &'a [bool], preferences: &'a [Preference]) -> Known<'a> {
        Known {
            stated,
            placed,
            preferences,
        }
    }
}

/// The rows and preferences of a search for a position.
struct Wanted<'a> {
    elements: &'a [usize],
    preferences: &'a [Preference],
    stated: &'a Stated,
}

/// The key of a trial that satisfies rows, branches and preferences.
const DONE: (bool, bool, bool) = (false, false, false);
/// The key of a trial that satisfies all but a preference.
const UNMET: (bool, bool, bool) = (false, false, true);
/// Turns of a stated position about the axis of an angle (°) that are tried. One of them is near enough to
/// the solution of any angle's equation. Steps of 45° are a choice.
const TURNS: [f64; 7] = [45.0, -45.0, 90.0, -90.0, 135.0, -135.0, 180.0];

/// A trial position: (open, wrong branch, a pin outside its shell or a turning axis across), largest scaled
/// row.
struct Trial {
    key: (bool, bool, bool),
    size: f64,
    state: State,
}

/// Searches a position of `body` where the rows of `wanted` close, while the bodies of `moving` move. The
/// search begins at the present position and at the `partners` of its markers.
///
/// A body that lies across or upside down can also satisfy the equation of an angle. So elements that measure
/// angles prefer parallel axes, and a position without them is taken only if there is no better one. The
/// preference takes part in closing only if the rows alone do not satisfy it. A stated orientation is kept as far
/// as a turn about the axis closes the rows.
fn search(
    model: &Model,
    wanted: &Wanted<'_>,
    partners: &[(usize, usize)],
    body: usize,
    moving: &[usize],
    cubes: &[M3],
    state: &State,
) -> Result<Trial, RuntimeError> {
    let rows = Rows::new(model, wanted.elements.to_vec());
    let preferences = wanted.preferences;
    let with_preferences = rows.clone().with(model, preferences);
    let axes = rows::axes(model, wanted.elements);
    let all_preferences = with_preferences.clone().with(model, &axes);
    let info = &model.bodies[body];
    let mut mobility = vec![0.0; model.velocities];
    for b in moving {
        let moved = &model.bodies[*b];
        super::closing::set_mobility(moved, 1.0, &mut mobility);
    }
    let settle =
        |mut trial: State, first: &Rows, axes: &[Preference]| -> Result<Trial, RuntimeError> {
            if first.len() > rows.len() {
                // a choice: a trial that needs more steps began too far away, and there are other trials
                close(model, first, &mobility, &mut trial, 40)?;
            }
            let size = close(model, &rows, &mobility, &mut trial, 40)?;
            let open = !is_closed(size);
            let wrong = !violated_branches(model, wanted.elements, &trial)?.is_empty();
            let outside = preferences
                .iter()
                .chain(axes)
                .any(|preference| !preference.is_fulfilled(model, &at(&trial)));
            Ok(Trial {
                key: (open, wrong, outside),
                size,
                state: trial,
            })
        };
    let consider = |trial: State, axes: &[Preference]| -> Result<Trial, RuntimeError> {
        let found = settle(trial.clone(), &with_preferences, axes)?;
        let lie_across = axes
            .iter()
            .any(|preference| !preference.is_fulfilled(model, &at(&found.state)));
        if found.key == UNMET && lie_across {
            let again = settle(trial, &all_preferences, axes)?;
            if again.key < found.key {
                return Ok(again);
            }
        }
        Ok(found)
    };
    let is_turned = wanted.stated.orientation[body];
    // a stated orientation is intended, even if it is across
    let from_here = if is_turned { &[][..] } else { &axes[..] };
    let mut best = consider(state.clone(), from_here)?;
    if is_turned || wanted.stated.position[body] {
        for preference in &axes {
            for turn in TURNS {
                if best.key == DONE {
                    return Ok(best);
                }
                let is_own = model.markers[preference.pin].body == Some(body);
                let about = if is_own {
                    preference.pin
                } else {
                    preference.shell
                };
                let axis =
                    rows::marker(model, preference.shell, &state.pose, &state.velocity).rotation;
                let rotation: V3 = axis.column(2) * turn.to_radians();
                let trial = turned(model, body, about, rotation, state);
                let found = consider(trial, from_here)?;
                if found.key < best.key {
                    best = found;
                }
            }
        }
    }
    for (own, partner) in partners {
        let target = rows::marker(model, *partner, &state.pose, &state.velocity);
        let own = &model.markers[*own];
        // The branch of a sliding joint may need a position to one side, so the search looks there too. A
        // film allows no slide.
        let places = offsets(model.length);
        let slides = !preferences.iter().any(Preference::is_inside);
        let places = if slides && best.key != UNMET {
            &places[..]
        } else {
            &places[..1]
        };
        for offset in places {
            for cube in cubes {
                if best.key == DONE {
                    return Ok(best);
                }
                let rotation = target.rotation * cube * own.orientation.transpose();
                let position = target.position + target.rotation * offset - rotation * own.position;
                let mut trial = state.clone();
                for i in 0..3 {
                    trial.pose[info.pose + i] = position[i];
                }
                trial.pose[info.pose + 3..info.pose + 7].copy_from_slice(&quaternion(&rotation));
                let found = consider(trial, &axes)?;
                let better = found.key < best.key
                    || (found.key == best.key
                        && found.key.0
                        // rows that are equal but for rounding do not replace an earlier trial
                        && found.size < best.size * (1.0 - 1e-6));
                if better {
                    best = found;
                }
            }
        }
    }
    Ok(best)
}

/// The state with a body turned by a rotation vector (rad) about one of its markers.
fn turned(model: &Model, body: usize, about: usize, rotation: V3, state: &State) -> State {
    let mut trial = state.clone();
    let place = |pose: &[f64]| rows::marker(model, about, pose, &state.velocity).position;
    let turn = exponential(&rotation);
    let pose = model.bodies[body].pose;
    let old = [3, 4, 5, 6].map(|i| state.pose[pose + i]);
    let new = normalized(&product(&turn, &old));
    trial.pose[pose + 3..pose + 7].copy_from_slice(&new);
    let back = place(&state.pose) - place(&trial.pose);
    for i in 0..3 {
        trial.pose[pose + i] += back[i];
    }
    trial
}

/// Offsets of the search from a partner marker, along its axes (m): none first, then a model's length to each
/// side.
fn offsets(length: f64) -> [V3; 7] {
    let along = |x: f64, y: f64, z: f64| V3::new(x, y, z) * length;
    [
        along(0.0, 0.0, 0.0),
        along(0.0, 0.0, 1.0),
        along(0.0, 0.0, -1.0),
        along(1.0, 0.0, 0.0),
        along(-1.0, 0.0, 0.0),
        along(0.0, 1.0, 0.0),
        along(0.0, -1.0, 0.0),
    ]
}
