//! Placing bodies one by one along the joints that lead to placed ones.

use super::closing::{bodies_of, close};
use super::rows::{self, Centred, Rows};
use super::{at, is_closed, violated_branches};
use crate::error::RuntimeError;
use crate::model::Model;
use crate::rotation::{M3, V3, quaternion};
use crate::state::State;

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

/// Places every body without a stated place that rows connect to placed bodies or ground. The order is that of most rows
/// to what is placed, then of the bodies; bodies which nothing reaches keep their place and count as placed.
pub fn place(
    model: &Model,
    elements: &[usize],
    state: &mut State,
    stated: &[bool],
) -> Result<(), RuntimeError> {
    let cubes = cube_rotations();
    let wishes = rows::wishes(model);
    // Stated bodies first obey what ties them to ground alone, say a start angle, from where they are stated.
    let mut placed = vec![false; model.bodies.len()];
    for body in (0..model.bodies.len()).filter(|b| stated[*b]) {
        place_one(
            model,
            elements,
            body,
            &Known {
                stated,
                placed: &placed,
                wishes: &wishes,
            },
            &cubes,
            state,
        )?;
    }
    placed.copy_from_slice(stated);
    loop {
        let mut next: Option<(usize, usize)> = None;
        for body in (0..model.bodies.len()).filter(|b| !placed[*b]) {
            let rows: usize = connecting(model, elements, body, &placed)
                .iter()
                .map(|e| model.class(*e).rows.len())
                .sum();
            // films place a body as joints do: a crank before the rods that would hang anywhere
            let wishes = wished(model, &wishes, &[body], &placed).len();
            let rows = rows + rows::CENTRED_ROWS * wishes;
            if rows > 0 && next.is_none_or(|(most, _)| rows > most) {
                next = Some((rows, body));
            }
        }
        let Some((_, body)) = next else {
            // Nothing leads on: the first body that others could be placed from stands where it is.
            match (0..model.bodies.len()).find(|b| !placed[*b]) {
                Some(b) => {
                    placed[b] = true;
                    continue;
                }
                None => return Ok(()),
            }
        };
        place_one(
            model,
            elements,
            body,
            &Known {
                stated,
                placed: &placed,
                wishes: &wishes,
            },
            &cubes,
            state,
        )?;
        placed[body] = true;
    }
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

/// Wishes between a body of `moving` and what is placed, or another of them.
fn wished(model: &Model, wishes: &[Centred], moving: &[usize], placed: &[bool]) -> Vec<Centred> {
    let stands = |m: usize| model.markers[m].body.is_none_or(|b| placed[b]);
    let moves = |m: usize| model.markers[m].body.is_some_and(|b| moving.contains(&b));
    let between = |a: usize, b: usize| moves(a) && (stands(b) || moves(b));
    wishes
        .iter()
        .copied()
        .filter(|wish| between(wish.pin, wish.shell) || between(wish.shell, wish.pin))
        .collect()
}

/// Places a body on what is placed. Where that alone leaves it open or on a wrong branch, its placed neighbours without a
/// stated place move with it: a rod finds its piston by pushing it along the liner.
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
    // a body that is placed by the text follows no wish
    let wishes_of = |moving: &[usize]| match known.stated[body] {
        true => Vec::new(),
        false => wished(model, known.wishes, moving, known.placed),
    };
    let wishes = wishes_of(&alone);
    if near.is_empty() && wishes.is_empty() {
        return Ok(());
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
    for wish in &wishes {
        let of_pin = model.markers[wish.pin].body == Some(body);
        partners.push(if of_pin {
            (wish.pin, wish.shell)
        } else {
            (wish.shell, wish.pin)
        });
    }
    let rows = Wanted {
        elements: &near,
        wishes: &wishes,
    };
    let mut best = search(model, &rows, &partners, body, &alone, cubes, state)?;
    if best.key != DONE {
        let films = wishes.iter().flat_map(|wish| [wish.pin, wish.shell]);
        let films = films.filter_map(|m| model.markers[m].body);
        let mut moving: Vec<usize> = near
            .iter()
            .flat_map(|e| bodies_of(model, *e))
            .chain(films)
            .filter(|b| *b != body && !known.stated[*b])
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
            let wishes = wishes_of(&moving);
            let rows = Wanted {
                elements: &around,
                wishes: &wishes,
            };
            let together = search(model, &rows, &partners, body, &moving, cubes, state)?;
            if together.key < best.key {
                best = together;
            }
        }
    }
    *state = best.state;
    Ok(())
}

/// Which bodies have a place: stated in the text, or found by now.
struct Known<'a> {
    stated: &'a [bool],
    placed: &'a [bool],
    wishes: &'a [Centred],
}

/// What a place is looked for with.
struct Wanted<'a> {
    elements: &'a [usize],
    wishes: &'a [Centred],
}

/// The key of a trial with nothing left to wish.
const DONE: (bool, bool, bool) = (false, false, false);

/// A trial place: (open, wrong branch, a pin outside of its shell), largest scaled row.
struct Trial {
    key: (bool, bool, bool),
    size: f64,
    state: State,
}

/// Looks for a place of `body` where the rows of `wanted` close, while the bodies of `moving` move, from where it stands
/// and from the `partners` of its markers.
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
    let wishes = wanted.wishes;
    let with_wishes = rows.clone().with(model, wishes);
    let info = &model.bodies[body];
    let mut mobility = vec![0.0; model.velocities];
    for b in moving {
        let moved = &model.bodies[*b];
        super::closing::set_mobility(moved, 1.0, &mut mobility);
    }
    let consider = |mut trial: State| -> Result<Trial, RuntimeError> {
        if !wishes.is_empty() {
            close(model, &with_wishes, &mobility, &mut trial, 40)?;
        }
        let size = close(model, &rows, &mobility, &mut trial, 40)?;
        let open = !is_closed(size);
        let wrong = !violated_branches(model, wanted.elements, &trial)?.is_empty();
        let outside = wishes
            .iter()
            .any(|wish| !wish.is_fulfilled(model, &at(&trial)));
        Ok(Trial {
            key: (open, wrong, outside),
            size,
            state: trial,
        })
    };
    let mut best = consider(state.clone())?;
    for (own, partner) in partners {
        let target = rows::marker(model, *partner, &state.pose, &state.velocity);
        let own = &model.markers[*own];
        // A joint that lets the body slide may ask by a branch for a place to one side: look there too. A film lets none slide.
        let places = offsets(model.length);
        let places = if wishes.is_empty() {
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
                let found = consider(trial)?;
                let better = found.key < best.key
                    || (found.key == best.key
                        && found.key.0
                        && found.size < best.size * (1.0 - 1e-6));
                if better {
                    best = found;
                }
            }
        }
    }
    Ok(best)
}

/// Where to look around a partner marker, along its axes (m): on it first, then a model's length to each side.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_has_24_rotations() {
        let cubes = cube_rotations();
        assert_eq!(cubes.len(), 24);
        assert_eq!(cubes[0], M3::identity());
        for (i, a) in cubes.iter().enumerate() {
            assert!((a.determinant() - 1.0).abs() < 1e-15);
            assert!(cubes[..i].iter().all(|b| b != a));
        }
    }
}
