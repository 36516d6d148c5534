//! Averaging ties (RBE3, distributing couplings): the reference node moves as the rigid body that fits the
//! motions of the others best.
//!
//! With independent freedoms q_k along directions a_k at places r_k from the reference, a rigid motion (u, θ)
//! of the reference moves them by a·u + (r × a)·θ (translations) and a·θ (rotations). (u, θ) minimises
//!
//! ```text
//! Σ w (q − a·u − (r × a)·θ)²  +  Σ w L² (q − a·θ)²
//!     translations                  rotations
//! ```
//!
//! with L the mean distance of the nodes with weight from the reference (MSC Nastran, Quick Reference Guide, RBE3:
//! rotations count by a length, so that weights are comparable). By duality a force at the reference spreads
//! over the nodes by their weights, with forces that balance its moment. Motions that no node shows (the spin of
//! nodes on a line) are left out of the fit.

use super::freedoms::{FreedomMap, direction};
use super::vector::{cross, norm, subtract};
use crate::error::FlexibleError;
use crate::mesh::Mesh;

/// Share of the largest eigenvalue above which a motion is determined. A choice above the rounding of the eigenvalues:
/// nodes on one line leave zeros.
const RANK: f64 = 1e-10;
/// Part of a component along an undetermined motion above which it is refused. A choice: with a smaller part the nodes
/// determine the component, but for the digits of their places.
const UNDETERMINED: f64 = 1e-6;

/// A freedom of the nodes that lead: freedom in local axes, its line in the fit over (u, L θ), its weight,
/// and the factor of its value (1 or L).
struct Term {
    freedom: u32,
    line: [f64; 6],
    weight: f64,
    scale: f64,
}

/// A freedom of the reference, as a sum over freedoms in local axes.
pub(super) type Follower = (u32, Vec<(u32, f64)>);

/// The reference's freedoms.
///
/// # Errors
/// Negative weights, no node with weight, a component that the nodes don't determine.
pub(super) fn followers(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    id: u64,
    (reference, components): (u32, u8),
    independent: &[(u32, f64, u8)],
) -> Result<Vec<Follower>, FlexibleError> {
    if let Some((node, weight, _)) = independent.iter().find(|(_, weight, _)| *weight < 0.0) {
        return Err(FlexibleError::structure(
            format!(
                "averaging tie {id}: node {} has the weight {weight}",
                mesh.nodes[*node as usize].id
            ),
            "weights can't be negative",
        ));
    }
    if let Some((node, ..)) = independent.iter().find(|(node, ..)| *node == reference) {
        return Err(FlexibleError::structure(
            format!(
                "averaging tie {id}: node {} follows itself",
                mesh.nodes[*node as usize].id
            ),
            "remove the reference node from the nodes that it follows",
        ));
    }
    let origin = mesh.nodes[reference as usize].position;
    let arm = |node: u32| subtract(mesh.nodes[node as usize].position, origin);
    // a node without weight leads nothing
    let leading = || independent.iter().filter(|(_, weight, _)| *weight > 0.0);
    let distance: f64 = leading().map(|(node, ..)| norm(arm(*node))).sum();
    let mean = distance / leading().count().max(1) as f64;
    let length = if mean > 0.0 { mean } else { 1.0 };
    let mut terms = Vec::new();
    for &(node, weight, mask) in leading() {
        for component in (0..6u8).filter(|c| mask >> c & 1 == 1) {
            let Some(freedom) = freedoms.freedom(node, component) else {
                continue;
            };
            let axis = direction(mesh, node, component);
            let (translation, rotation, scale) = if component < 3 {
                (axis, cross(arm(node), axis).map(|x| x / length), 1.0)
            } else {
                ([0.0; 3], axis, length)
            };
            terms.push(Term {
                freedom: freedom as u32,
                line: [
                    translation[0],
                    translation[1],
                    translation[2],
                    rotation[0],
                    rotation[1],
                    rotation[2],
                ],
                weight,
                scale,
            });
        }
    }
    if terms.is_empty() {
        return Err(FlexibleError::structure(
            format!("averaging tie {id} has no node with a weight and a component to follow"),
            "give nodes, weights above zero and components",
        ));
    }
    let mut normal = [[0.0; 6]; 6];
    for term in &terms {
        for (i, row) in normal.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x += term.weight * term.line[i] * term.line[j];
            }
        }
    }
    let (values, vectors) = eigen(normal);
    let largest = values.iter().copied().fold(0.0, f64::max);
    let mut result = Vec::new();
    for component in (0..6u8).filter(|c| components >> c & 1 == 1) {
        let Some(freedom) = freedoms.freedom(reference, component) else {
            continue;
        };
        let axis = direction(mesh, reference, component);
        let rotation = component >= 3;
        let mut target = [0.0; 6];
        for (i, x) in axis.into_iter().enumerate() {
            target[i + if rotation { 3 } else { 0 }] = x;
        }
        // target · N⁺
        let mut solution = [0.0; 6];
        for (k, value) in values.iter().enumerate() {
            let vector: [f64; 6] = std::array::from_fn(|i| vectors[i][k]);
            let share: f64 = vector.iter().zip(target).map(|(x, y)| x * y).sum();
            if *value > RANK * largest {
                for (x, v) in solution.iter_mut().zip(vector) {
                    *x += share / value * v;
                }
            } else if share.abs() > UNDETERMINED {
                return Err(FlexibleError::structure(
                    format!(
                        "averaging tie {id}: its nodes don't determine component {} of node {}",
                        component + 1,
                        mesh.nodes[reference as usize].id
                    ),
                    "choose nodes that do not lie on one line, or remove the component",
                ));
            }
        }
        let back = if rotation { 1.0 / length } else { 1.0 };
        let sum = terms
            .iter()
            .map(|term| {
                let fit: f64 = term.line.iter().zip(solution).map(|(x, y)| x * y).sum();
                (term.freedom, back * fit * term.weight * term.scale)
            })
            .collect();
        result.push((freedom as u32, sum));
    }
    Ok(result)
}

/// Eigenvalues and, by columns, eigenvectors of a symmetric matrix: cyclic Jacobi rotations (G. H. Golub, C.
/// F. Van Loan, Matrix Computations, §8.5).
fn eigen(mut matrix: [[f64; 6]; 6]) -> ([f64; 6], [[f64; 6]; 6]) {
    let mut vectors: [[f64; 6]; 6] =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    for _ in 0..30 {
        let mut rotated = false;
        for p in 0..6 {
            for q in p + 1..6 {
                let off = matrix[p][q];
                let scale = (matrix[p][p] * matrix[q][q]).abs().sqrt();
                // far below the rounding of the diagonal, so that small eigenvalues have all their digits
                if off == 0.0 || off.abs() < 1e-18 * scale {
                    continue;
                }
                rotated = true;
                let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
                let sign = if theta < 0.0 { -1.0 } else { 1.0 };
                let tangent = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
                let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
                let sine = tangent * cosine;
                for row in &mut matrix {
                    let (x, y) = (row[p], row[q]);
                    row[p] = cosine * x - sine * y;
                    row[q] = sine * x + cosine * y;
                }
                let (first, second) = (matrix[p], matrix[q]);
                for k in 0..6 {
                    matrix[p][k] = cosine * first[k] - sine * second[k];
                    matrix[q][k] = sine * first[k] + cosine * second[k];
                }
                matrix[p][q] = 0.0;
                matrix[q][p] = 0.0;
                for row in &mut vectors {
                    let (x, y) = (row[p], row[q]);
                    row[p] = cosine * x - sine * y;
                    row[q] = sine * x + cosine * y;
                }
            }
        }
        if !rotated {
            break;
        }
    }
    (std::array::from_fn(|i| matrix[i][i]), vectors)
}
