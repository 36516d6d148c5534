//! Bodies that nothing holds: a block without mounts. Here films hold their pins; [`crate::loose`] finds single motions of
//! the whole model, and asks films for their load.
//!
//! A direction is free if no constraint, film, force or elasticity responds to a motion along it. The free
//! directions are the null space of four matrices together: the constraints' gradients, the pins' positions
//! in their shells, the derivatives of all loads between two bodies, and the shapes. A body is unconstrained if its
//! free motions reach every direction of space.

use super::motion::SteadyMotion;
use crate::assembled::Assembled;
use crate::assembly::at;
use crate::assembly::independent::Independent;
use crate::assembly::rows::{Along, Rows, pins};
use crate::error::RuntimeError;
use crate::model::Model;
use crate::singular::decompose;
use eng_system::system::Origin;
use nalgebra::DMatrix;

/// Singular value of unit rows below which a combination holds nothing. A choice above the rounding of the
/// decomposition, about 1e-15 for each row. A larger limit would report a body that a short lever holds.
const HOLDS: f64 = 1e-8;
/// Part of a free motion below which a body counts as still. A choice: in the directions left free, the parts
/// of bodies that are held are rounding, about 1e-15 over [`HOLDS`].
const MOVES: f64 = 1e-6;

/// Bodies that are joined to each other and to nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct Hanging {
    /// The heaviest of them.
    pub origin: Origin,
    /// Paths of the others.
    pub others: Vec<String>,
}

/// The bodies of a model that nothing holds in its assembled state, although some element joins them to
/// others. `None` if all are held. The compiler reports bodies without a path to the ground.
pub fn hanging(assembled: &Assembled) -> Result<Option<Hanging>, RuntimeError> {
    let (model, state) = (assembled.model(), assembled.state());
    let pins = pins(model);
    let film = |e: usize| pins.iter().any(|pin| pin.element == e);
    let with_rows = |e: &usize| !model.class(*e).rows.is_empty();
    let acts = |e: &usize| with_rows(e) || model.class(*e).facts.applies_load;
    let dynamic: Vec<usize> = (0..model.elements.len())
        .filter(|e| model.elements[*e].dynamic && acts(e))
        .collect();
    if model.bodies.is_empty() {
        return Ok(None);
    }
    let rows = Rows::new(model, dynamic.iter().copied().filter(with_rows).collect());
    let rows = rows.with(model, &pins);
    let (mut values, mut matrix) = rows.gradients(model, &at(state), Along::Pose)?;
    rows.scale_gradients(model, &mut values, &mut matrix);
    let responds = |e: &usize| {
        model.class(*e).facts.applies_load && !film(*e) && model.elements[*e].markers.len() > 1
    };
    if model.velocities == 6 * model.bodies.len()
        && !dynamic.iter().any(responds)
        && let Some(factor) = Independent::alone(&matrix)
    {
        let moves = |body: usize| {
            let own = factor.projected(6 * body, 3);
            let squares = own.fixed_view::<3, 3>(6 * body, 0).symmetric_eigenvalues();
            squares.min() > MOVES * MOVES
        };
        let loose: Vec<bool> = (0..model.bodies.len()).map(moves).collect();
        return Ok(group_of(model, &dynamic, &[], &loose));
    }
    let Ok(motion) = SteadyMotion::new(model, state) else {
        return Ok(None);
    };
    let mut parts = vec![matrix.dense(), shapes(model)];
    // a load without a response here, such as an open contact, may hold the body at another position
    let mut asleep = Vec::new();
    for e in dynamic.iter().copied() {
        if !responds(&e) {
            continue;
        }
        let mut derivatives = motion.load_derivatives(model, state, e)?;
        if derivatives.iter().all(|matrix| matrix.amax() == 0.0) {
            asleep.push(e);
        }
        for matrix in &mut derivatives {
            for (mut column, scale) in matrix.column_iter_mut().zip(motion.scales()) {
                column.scale_mut(*scale);
            }
        }
        parts.extend(derivatives);
    }
    let Some(free) = null_space(&parts, model.velocities) else {
        return Ok(None);
    };
    let loose: Vec<bool> = model
        .bodies
        .iter()
        .map(|body| {
            let moves = free.rows(body.velocity, 3).into_owned();
            moves.ncols() > 0 && decompose(moves).is_some_and(|svd| svd.rank(MOVES) == 3)
        })
        .collect();
    Ok(group_of(model, &dynamic, &asleep, &loose))
}

/// The bodies that an element acts on. Further markers, such as those of the cycle's angle, are only read.
fn bodies_of(model: &Model, element: usize) -> impl Iterator<Item = Option<usize>> + '_ {
    let markers = model.elements[element].markers.iter().take(2);
    markers.map(|m| model.markers[*m].body)
}

/// The first group of unconstrained bodies that elements join to others. Elements that are asleep hold a group.
fn group_of(model: &Model, dynamic: &[usize], asleep: &[usize], loose: &[bool]) -> Option<Hanging> {
    // groups of unconstrained bodies that elements join
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut seen = vec![false; model.bodies.len()];
    for first in 0..model.bodies.len() {
        if !loose[first] || seen[first] {
            continue;
        }
        let mut group = Vec::new();
        let mut open = vec![first];
        while let Some(body) = open.pop() {
            if std::mem::replace(&mut seen[body], true) {
                continue;
            }
            group.push(body);
            let joins = |e: &&usize| bodies_of(model, **e).any(|b| b == Some(body));
            let joined = dynamic
                .iter()
                .filter(joins)
                .flat_map(|e| bodies_of(model, *e));
            open.extend(joined.flatten().filter(|b| loose[*b]));
        }
        group.sort_unstable();
        groups.push(group);
    }
    let linked = |group: &[usize], elements: &[usize]| {
        elements.iter().any(|e| {
            let inside = |b: Option<usize>| b.is_some_and(|b| group.contains(&b));
            bodies_of(model, *e).any(inside) && bodies_of(model, *e).any(|b| !inside(b))
        })
    };
    let origin = |body: usize| &model.bodies[body].origin;
    let mass = |body: usize| model.bodies[body].mass();
    groups
        .into_iter()
        .filter(|group| linked(group, dynamic) && !linked(group, asleep))
        .filter_map(|group| {
            let heaviest = group
                .iter()
                .copied()
                .max_by(|a, b| mass(*a).total_cmp(&mass(*b)).then(b.cmp(a)))?;
            let others = group.iter().filter(|b| **b != heaviest);
            Some(Hanging {
                origin: origin(heaviest).clone(),
                others: others.map(|b| origin(*b).path.clone()).collect(),
            })
        })
        .next()
}

/// Rows of the amplitudes of all flexible bodies, because elasticity responds to every shape. Without these
/// rows a body could seem to move by bending while its pins remain in place.
fn shapes(model: &Model) -> DMatrix<f64> {
    let columns: Vec<usize> = model
        .bodies
        .iter()
        .flat_map(|body| (body.velocity..).take(body.width()).skip(6))
        .collect();
    DMatrix::from_fn(columns.len(), model.velocities, |row, column| {
        f64::from(column == columns[row])
    })
}

/// An orthonormal basis of the directions that rows leave free; `None` if numbers are not finite.
fn null_space(parts: &[DMatrix<f64>], columns: usize) -> Option<DMatrix<f64>> {
    // rows of zeros complete the right vectors to a basis
    let count: usize = parts.iter().map(DMatrix::nrows).sum();
    let mut all = DMatrix::zeros(count.max(columns), columns);
    let rows = parts.iter().flat_map(|part| part.row_iter());
    for (i, row) in rows.enumerate() {
        let size = row.norm();
        if !size.is_finite() {
            return None;
        }
        if size > 0.0 {
            all.row_mut(i).copy_from(&(row / size));
        }
    }
    let svd = decompose(all)?;
    let right = svd.v_t?;
    let weak: Vec<usize> = (0..columns)
        .filter(|i| svd.singular_values[*i] < HOLDS)
        .collect();
    Some(DMatrix::from_fn(columns, weak.len(), |i, j| {
        right[(weak[j], i)]
    }))
}
