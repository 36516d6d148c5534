//! Point masses in a floating frame: their rotary inertia turns with the node, and a mass beside its node
//! moves around the node.
//!
//! The constants of [`crate::invariants`] let the mass matrix act on nodal velocities in body axes. This is
//! exact for mass that is equal in all directions. The inertia J of a point mass is constant in the axes of
//! its node. The angular velocity of the node in these axes is
//!
//! ```text
//! ω_n = ω + θ̇ + ω × θ + ½ θ × (θ × ω) − ½ θ × θ̇ + …
//! ```
//!
//! The mass matrix contains the terms of first order. In `½ ω_n·J ω_n` the terms of second order multiply the
//! frame's own ω, so they belong to the same order of the energy. Without them a spinning disc has a wrong
//! gyroscopic moment. With the rows `Φ` of the node's rotation and the rows `J_k` of J they add
//!
//! ```text
//! H_kl += ½ sym(Φᵀ J_k Φ_l + Φᵀ J_l Φ_k) − J_kl ΦᵀΦ        G_k −= ½ Φᵀ J_k~ Φ
//! ```
//!
//! to the centrifugal and the Coriolis blocks. The rotary inertia of beam sections has no such terms here.

use crate::fe::FreedomMap;
use crate::mesh::{Mesh, Node, PointMass, Tie};
use eng_system::reduced::Invariants;

/// Pairs of axes of the centrifugal blocks.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// Largest part of a mass matrix that counts as rounding. A choice above the rounding of sums, and below what
/// a card with few digits can state.
const ROUNDING: f64 = 1e-12;

/// Moves each mass beside its node to a new node at its centre, with its inertia about this centre. A rigid
/// tie connects the new node to the old one. Mass and stiffness of the structure do not change, but the mass
/// now moves with its own position. Masses that differ with the direction are left as they are.
pub fn split_offsets(mesh: &mut Mesh) {
    let mut id = mesh.nodes.iter().map(|node| node.id).max().unwrap_or(0);
    let mut number = mesh.point_masses.iter().map(|p| p.id).max().unwrap_or(0);
    let mut added = Vec::new();
    for point in &mut mesh.point_masses {
        let Some((mass, offset, inertia)) = rigid_body(&point.matrix) else {
            continue;
        };
        let Some(place) = mesh.nodes.get(point.node as usize).map(|n| n.position) else {
            continue;
        };
        id = id.saturating_add(1);
        number = number.saturating_add(1);
        let node = mesh.nodes.len() as u32;
        mesh.nodes.push(Node {
            id,
            position: [0, 1, 2].map(|k: usize| place[k] + offset[k]),
            frame: None,
        });
        mesh.ties.push(Tie::Rigid {
            id: point.id,
            independent: point.node,
            dependent: vec![(node, 0b111)],
        });
        let mut own = [[0.0; 6]; 6];
        for (k, row) in own.iter_mut().enumerate().take(3) {
            row[k] = mass;
        }
        added.push(PointMass {
            id: number,
            node,
            matrix: own,
        });
        point.matrix = [[0.0; 6]; 6];
        for (i, row) in inertia.iter().enumerate() {
            for (j, x) in row.iter().enumerate() {
                point.matrix[3 + i][3 + j] = *x;
            }
        }
    }
    mesh.point_masses.extend(added);
}

/// Mass, offset and central inertia of the mass matrix of a rigid body about a point beside its centre,
/// `[m I, −m c~; m c~, J]`. `None` for another matrix.
fn rigid_body(matrix: &[[f64; 6]; 6]) -> Option<(f64, [f64; 3], [[f64; 3]; 3])> {
    let mass = matrix[0][0];
    let alike = (0..3).all(|i| {
        (0..3).all(|j| {
            let expected = if i == j { mass } else { 0.0 };
            (matrix[i][j] - expected).abs() <= ROUNDING * mass
        })
    });
    // the entries (1, 2), (2, 0), (0, 1) of the block −m c~ above the diagonal are m c
    let moment = [matrix[1][5], matrix[2][3], matrix[0][4]];
    let [x, y, z] = moment;
    let coupling = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let size = x.abs().max(y.abs()).max(z.abs());
    let skew = (0..3).all(|i| {
        (0..3).all(|j| (matrix[i][3 + j] + coupling[i][j]).abs() <= ROUNDING.sqrt() * size)
    });
    if !(alike && skew && mass > 0.0 && size > 0.0) {
        return None;
    }
    let c = moment.map(|x| x / mass);
    let square: f64 = c.iter().map(|x| x * x).sum();
    let most = (0..3).map(|i| matrix[3 + i][3 + i]).fold(0.0, f64::max);
    let inertia: [[f64; 3]; 3] = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let own = if i == j { square } else { 0.0 };
            let central = matrix[3 + i][3 + j] - mass * (own - c[i] * c[j]);
            if central.abs() <= ROUNDING * most {
                0.0
            } else {
                central
            }
        })
    });
    // an inertia below that of the mass alone about the node belongs to no rigid body
    (0..3)
        .all(|i| inertia[i][i] >= 0.0)
        .then_some((mass, c, inertia))
}

/// Adds the second-order terms of the rotary inertia of point masses: see the head of this module.
pub fn add_turning(
    constants: &mut Invariants,
    points: &[PointMass],
    freedoms: &FreedomMap,
    shapes: &[f64],
) {
    let n = constants.modes;
    let size = freedoms.size();
    for point in points {
        let inertia: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| point.matrix[3 + i][3 + j]));
        if inertia.as_flattened().iter().all(|x| *x == 0.0) || !freedoms.has_rotation(point.node) {
            continue;
        }
        let row = |component: u8| -> Vec<f64> {
            let freedom = freedoms.freedom(point.node, component);
            (0..n)
                .map(|mode| {
                    let value = freedom.and_then(|f| shapes.get(mode * size + f));
                    value.copied().unwrap_or(0.0)
                })
                .collect()
        };
        let turn = [row(3), row(4), row(5)];
        // J_k Φ
        let moment: [Vec<f64>; 3] = std::array::from_fn(|k| {
            (0..n)
                .map(|mode| (0..3).map(|m| inertia[k][m] * turn[m][mode]).sum())
                .collect()
        });
        for (p, (k, l)) in PAIRS.into_iter().enumerate() {
            for (i, line) in constants.centrifugal[p]
                .chunks_exact_mut(n.max(1))
                .enumerate()
            {
                for (j, x) in line.iter_mut().enumerate() {
                    let both = moment[k][i] * turn[l][j]
                        + moment[k][j] * turn[l][i]
                        + moment[l][i] * turn[k][j]
                        + moment[l][j] * turn[k][i];
                    let square: f64 = turn.iter().map(|t| t[i] * t[j]).sum();
                    *x += 0.25 * both - inertia[k][l] * square;
                }
            }
        }
        for (k, block) in constants.coriolis.iter_mut().enumerate() {
            let [a, b, c] = inertia[k];
            for (i, line) in block.chunks_exact_mut(n.max(1)).enumerate() {
                for (j, x) in line.iter_mut().enumerate() {
                    // Φ_i · (J_k × Φ_j)
                    let crossed = turn[0][i] * (b * turn[2][j] - c * turn[1][j])
                        + turn[1][i] * (c * turn[0][j] - a * turn[2][j])
                        + turn[2][i] * (a * turn[1][j] - b * turn[0][j]);
                    *x -= 0.5 * crossed;
                }
            }
        }
    }
}
