//! A mesh of plane sections stacked along an axis, without a file.
//!
//! ```text
//! outlines ──arrange──▶ common vertices and edges ──triangulate──▶ one plane ──extrude──▶ wedges of 15 nodes
//! ```
//!
//! All outlines are divided where they meet. One planar triangulation has all their edges, so elements of neighbouring
//! sections have common nodes where the outlines overlap. Edges along arcs are quadratic and have their middle on the
//! arc. Where this would invert a triangle, because outlines nearly touch, the edge is straight.

mod arrangement;
mod error;
mod extrude;
pub(crate) mod outline;
mod piece;
mod plane;

pub use error::StackError;

use crate::mesh::Mesh;
use eng_system::stack::Stack;
use outline::{Outline, outline};
use piece::Piece;
use plane::Plane;
use std::collections::BTreeSet;

/// Most nodes of a mesh. A choice: parts of engines need far fewer, so a larger mesh is probably a mistake in
/// the size.
const MOST_NODES: usize = 1_000_000;
/// Most elements along the axis in all sections. A choice: a limit for sections with hardly an area, whose
/// nodes are few.
const MOST_LAYERS: f64 = 100_000.0;
/// How often edges that cannot follow their arcs are halved. A choice: they are a sixteenth then, and after
/// this some stay straight.
const HALVINGS: usize = 4;
/// Largest relative difference of a section's area from that of its outline. A choice: mass and stiffness of
/// the section change by as much, less than by a tolerance of its dimensions.
const AREA: f64 = 2e-3;

/// The mesh of a stack, in SI, with one property for each section, named by its number, and without a material.
///
/// # Errors
/// If a number is not finite or not positive, an outline crosses itself or has no area, neighbours have no common
/// area, the size is larger than a section is wide, outlines run too close to each other for elements between them,
/// or there would be too many nodes.
pub fn stack_mesh(stack: &Stack) -> Result<Mesh, StackError> {
    numbers(stack)?;
    let mut outlines: Vec<Outline> = Vec::new();
    let mut different: Vec<(usize, Vec<Piece>)> = Vec::new();
    // number of each section's outline among the different ones
    let mut outline_of: Vec<usize> = Vec::with_capacity(stack.sections.len());
    for (index, section) in stack.sections.iter().enumerate() {
        let same = |(first, _): &(usize, Vec<Piece>)| {
            let first = stack.sections.get(*first);
            first.is_some_and(|first| first.corners == section.corners)
        };
        let known = different.iter().position(same);
        let number = match known {
            Some(number) => number,
            None => {
                let outline = outline(section, index + 1)?;
                different.push((index, outline.pieces.clone()));
                outlines.push(outline);
                outlines.len() - 1
            }
        };
        outline_of.push(number);
    }
    sizes(stack, &outlines, &outline_of)?;
    let neighbours: BTreeSet<[usize; 2]> = outline_of
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] if a != b => Some([*a.min(b), *a.max(b)]),
            _ => None,
        })
        .collect();
    let plane = plane(&different, &neighbours, stack.size)?;
    for (number, (section, _)) in different.iter().enumerate() {
        let section = section + 1;
        plane.thin(number, section, stack.size)?;
        let triangles = plane.inside.get(number).into_iter().flatten();
        let area: f64 = triangles.map(|triangle| plane.area(*triangle)).sum();
        let share = outlines
            .get(number)
            .map_or(0.0, |outline| area / outline.area);
        if share.is_nan() || (share - 1.0).abs() > AREA {
            return Err(StackError::Faceted { section, share });
        }
    }
    together(&plane, &outline_of)?;
    Ok(extrude::extrude(stack, &plane, &outline_of))
}

/// The triangulation of different outlines. Edges that cannot follow their arcs are halved while they are long.
fn plane(
    different: &[(usize, Vec<Piece>)],
    neighbours: &BTreeSet<[usize; 2]>,
    size: f64,
) -> Result<Plane, StackError> {
    let mut division = arrangement::divide(different, neighbours, size)?;
    let mut plane = plane::triangulate(&division.arranged(), size)?;
    for _ in 0..HALVINGS {
        if !division.halve(&plane.straightened) {
            break;
        }
        plane = plane::triangulate(&division.arranged(), size)?;
    }
    Ok(plane)
}

/// Refuses numbers that make no body.
fn numbers(stack: &Stack) -> Result<(), StackError> {
    if stack.sections.is_empty() {
        return Err(StackError::Empty);
    }
    let wrong = |what: String, due: &'static str, value: f64, section: Option<usize>| {
        Err(StackError::Number {
            what,
            due,
            value: format!("{} mm", crate::error::mm(value)),
            section,
        })
    };
    if !(stack.size > 0.0 && stack.size.is_finite()) {
        return wrong("the size".into(), "positive", stack.size, None);
    }
    if !stack.begin.is_finite() {
        return wrong("the beginning".into(), "finite", stack.begin, None);
    }
    for (index, section) in stack.sections.iter().enumerate() {
        if !(section.length > 0.0 && section.length.is_finite()) {
            return wrong(
                format!("section {}: the length", index + 1),
                "positive",
                section.length,
                Some(index + 1),
            );
        }
    }
    Ok(())
}

/// Number of elements of a section along the axis.
fn layers(length: f64, size: f64) -> f64 {
    // a length of a whole number of sizes must not get one layer more by rounding
    libm::ceil(length / size * (1.0 - 1e-9)).max(1.0)
}

/// Refuses sizes that are too large for a section, or make too many nodes.
fn sizes(stack: &Stack, outlines: &[Outline], outline_of: &[usize]) -> Result<(), StackError> {
    let size = stack.size;
    let (mut nodes, mut all_layers) = (0.0, 0.0);
    for (index, (section, outline)) in stack.sections.iter().zip(outline_of).enumerate() {
        let Some(outline) = outlines.get(*outline) else {
            continue;
        };
        let width = 4.0 * outline.area / outline.circumference;
        // rounding of a stated width, such as that of a square, does not count
        if size > width * (1.0 + 1e-9) {
            return Err(StackError::Coarse {
                section: index + 1,
                size,
                width,
            });
        }
        // five nodes for each corner: itself and its three edges in the plane, and the middle along the axis
        let corners =
            outline.area / (0.75_f64.sqrt() * size * size) + 0.5 * outline.circumference / size;
        nodes += 5.0 * corners * layers(section.length, size);
        all_layers += layers(section.length, size);
    }
    if !(nodes <= MOST_NODES as f64 && all_layers <= MOST_LAYERS) {
        return Err(StackError::Large {
            nodes: nodes.max(all_layers),
            most: MOST_NODES,
        });
    }
    Ok(())
}

/// Refuses neighbours without a common triangle.
fn together(plane: &Plane, outline_of: &[usize]) -> Result<(), StackError> {
    let inside = |outline: usize| plane.inside.get(outline).map(Vec::as_slice).unwrap_or(&[]);
    for (index, pair) in outline_of.windows(2).enumerate() {
        let [below, above] = [pair[0], pair[1]];
        let above = inside(above);
        let common = inside(below).iter().any(|t| above.binary_search(t).is_ok());
        if !common {
            return Err(StackError::Apart { first: index + 1 });
        }
    }
    Ok(())
}
