//! Placing bodies one by one along the joints that lead to placed ones.

use super::closing::{bodies_of, close};
use super::rows::{self, Rows};
use super::{is_closed, violated_branches};
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
    if near.is_empty() {
        return Ok(());
    }
    let alone = vec![body];
    let mut best = search(model, &near, &near, body, &alone, cubes, state)?;
    if best.key != (false, false) {
        let mut moving: Vec<usize> = near
            .iter()
            .flat_map(|e| bodies_of(model, *e))
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
            let together = search(model, &around, &near, body, &moving, cubes, state)?;
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
}

/// A trial place: (open, wrong branch), largest scaled row.
struct Trial {
    key: (bool, bool),
    size: f64,
    state: State,
}

/// Looks for a place of `body` where the rows of `elements` close, while the bodies of `moving` move, from where it stands
/// and from the partner markers of `near`.
fn search(
    model: &Model,
    elements: &[usize],
    near: &[usize],
    body: usize,
    moving: &[usize],
    cubes: &[M3],
    state: &State,
) -> Result<Trial, RuntimeError> {
    let rows = Rows::new(model, elements.to_vec());
    let info = &model.bodies[body];
    let mut mobility = vec![0.0; model.velocities];
    for b in moving {
        let moved = &model.bodies[*b];
        super::closing::set_mobility(moved, 1.0, &mut mobility);
    }
    let consider = |mut trial: State| -> Result<Trial, RuntimeError> {
        let size = close(model, &rows, &mobility, &mut trial, 40)?;
        let open = !is_closed(size);
        let wrong = !violated_branches(model, elements, &trial)?.is_empty();
        Ok(Trial {
            key: (open, wrong),
            size,
            state: trial,
        })
    };
    let mut best = consider(state.clone())?;
    for e in near {
        let markers = &model.elements[*e].markers;
        let own = markers
            .iter()
            .find(|m| model.markers[**m].body == Some(body));
        let partner = markers
            .iter()
            .find(|m| model.markers[**m].body != Some(body));
        let (Some(own), Some(partner)) = (own, partner) else {
            continue;
        };
        let target = rows::marker(model, *partner, &state.pose, &state.velocity);
        let own = &model.markers[*own];
        // A joint that lets the body slide may ask by a branch for a place to one side: look there too.
        for offset in offsets(model.length) {
            for cube in cubes {
                if best.key == (false, false) {
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
