//! Mode shapes from a file as vectors over free freedoms.

use crate::error::FlexibleError;
use crate::fe::{FreedomMap, Reduction};
use crate::foreign::GivenModes;
use crate::mesh::Mesh;
use crate::read::matrix::ShapeFrame;
use crate::solve::{Analysis, Definiteness, Factorization};
use crate::sparse::SymmetricMatrix;
use std::sync::Arc;

/// A shape that ties and supports change by more than this part of its length belongs to another structure. A
/// choice: shapes of the same structure change by the digits of their file, and those of another one in part
/// or wholly.
const FOREIGN: f64 = 0.1;
/// Nodes that a message names. A choice: as many fit in a message and show a pattern.
const NAMED: usize = 10;

/// Shapes over the free freedoms.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// One after the other.
    pub vectors: Vec<f64>,
    /// For each shape the misfit with the ties and supports of the structure, ‖T x − u‖ / ‖u‖ over the given
    /// freedoms.
    pub misfits: Vec<f64>,
    /// Rounding of their entries, of the largest.
    pub noise: f64,
}

/// The free freedoms x for which the full ones T x come nearest to the given shapes u, by least squares over
/// the freedoms that the file gives. So a node that ties join to others follows them, and the nodes of a
/// rigid tie give the motion of its centre. Rotations are taken as given only where the file has any.
///
/// # Errors
/// Nodes of the file that the mesh does not hold; freedoms that the shapes don't determine; shapes that the
/// structure can't take.
pub fn fit(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    reduction: &Reduction,
    given: &GivenModes,
) -> Result<Fitted, FlexibleError> {
    let (file, modes) = (&given.modes.file, &given.modes.modes);
    let rows = given_rows(mesh, given)?;
    let turns = modes.iter().flat_map(|mode| &mode.shape).any(|values| {
        let [_, _, _, rotations @ ..] = values;
        rotations.iter().any(|x| *x != 0.0)
    });
    let size = freedoms.size();
    let mut known: Vec<(u32, u32, f64)> = Vec::new();
    for (node, _) in &rows {
        let range = freedoms.of(*node);
        let count = if turns {
            range.len()
        } else {
            range.len().min(3)
        };
        known.extend(range.take(count).map(|f| (f as u32, f as u32, 1.0)));
    }
    let full = full_shapes(freedoms, given, &rows)?;
    let weights = SymmetricMatrix::from_triplets(size, &known)?;
    let matrix = reduction.reduce(&weights)?;
    determined(file, reduction, &matrix)?;
    // rotations that the file does not give must not pull
    let mut masked = vec![0.0; full.len()];
    for (masked, full) in masked
        .chunks_exact_mut(size.max(1))
        .zip(full.chunks_exact(size.max(1)))
    {
        for (freedom, _, _) in &known {
            if let (Some(to), Some(from)) = (
                masked.get_mut(*freedom as usize),
                full.get(*freedom as usize),
            ) {
                *to = *from;
            }
        }
    }
    let mut vectors = reduction.gather(modes.len(), &masked);
    let analysis = Arc::new(Analysis::fill_reducing(&matrix)?);
    let factor = Factorization::new(&analysis, &matrix, Definiteness::Positive).map_err(
        |error| match error {
            FlexibleError::Singular { row, .. } => undetermined(file, reduction, &[row]),
            other => other,
        },
    )?;
    let right = vectors.clone();
    factor.solve_refined(&matrix, &right, &mut vectors, 1)?;
    let back = reduction.expand(modes.len(), &vectors);
    let misfits = misfits(size, &known, &masked, &back);
    let worst = modes
        .iter()
        .zip(&misfits)
        .find(|(_, misfit)| **misfit > FOREIGN);
    if let Some((mode, misfit)) = worst {
        return Err(FlexibleError::structure(
            format!(
                "{file}: ties and supports of the body remove {:.0} % of mode {}",
                100.0 * misfit,
                mode.number
            ),
            "give modes of the same structure, with the same supports, and nodes in the same units",
        ));
    }
    Ok(Fitted {
        vectors,
        misfits,
        noise: libm::exp10(-f64::from(given.modes.digits.min(16))),
    })
}

/// A row of each shape in a file: its node, and the axes of the node if the values are in an analysis frame.
type GivenRow = (u32, Option<[[f64; 3]; 3]>);

/// # Errors
/// Nodes that the mesh does not hold.
fn given_rows(mesh: &Mesh, given: &GivenModes) -> Result<Vec<GivenRow>, FlexibleError> {
    let index = mesh.node_index();
    let nodes = given.modes.nodes.iter();
    let mut unknown = nodes.clone().filter(|node| !index.contains_key(node));
    if let Some(first) = unknown.next() {
        return Err(FlexibleError::structure(
            format!(
                "{} gives shapes at {} nodes that are not in the mesh: {first}, …",
                given.modes.file,
                unknown.count() + 1
            ),
            "give the mesh of the run that wrote the shapes",
        ));
    }
    let row = |node: &u32| {
        let frame = mesh
            .nodes
            .get(*node as usize)
            .and_then(|node| node.frame)
            .and_then(|frame| mesh.frames.get(frame as usize))
            .filter(|_| given.modes.frame == ShapeFrame::Analysis);
        (*node, frame.map(|frame| frame.rotation))
    };
    Ok(nodes.filter_map(|id| index.get(id)).map(row).collect())
}

/// The given shapes over the full freedoms in SI, along the mesh's axes, one after the other; zero where the
/// file gives nothing.
///
/// # Errors
/// Shapes with values missing or not finite.
fn full_shapes(
    freedoms: &FreedomMap,
    given: &GivenModes,
    rows: &[GivenRow],
) -> Result<Vec<f64>, FlexibleError> {
    let size = freedoms.size();
    let modes = &given.modes.modes;
    let mut full = vec![0.0; size * modes.len()];
    for (mode, full) in modes.iter().zip(full.chunks_exact_mut(size.max(1))) {
        if mode.shape.len() != rows.len() || mode.shape.iter().flatten().any(|x| !x.is_finite()) {
            return Err(FlexibleError::structure(
                format!(
                    "{}: mode {} has values missing or not finite",
                    given.modes.file, mode.number
                ),
                "write or copy the file again; it is damaged",
            ));
        }
        for ((node, axes), values) in rows.iter().zip(&mode.shape) {
            let [x, y, z, rx, ry, rz] = *values;
            let length = given.units.length;
            let parts = [[x * length, y * length, z * length], [rx, ry, rz]];
            let turned = parts.map(|part| match axes {
                Some(axes) => axes.map(|row| row.iter().zip(part).map(|(a, b)| a * b).sum()),
                None => part,
            });
            let values = turned.as_flattened();
            for (freedom, value) in freedoms.of(*node).zip(values) {
                if let Some(entry) = full.get_mut(freedom) {
                    *entry = *value;
                }
            }
        }
    }
    Ok(full)
}

/// ‖found − given‖ / ‖given‖ of each shape over the known freedoms, of `size` in all; zero for a shape
/// without any motion.
fn misfits(size: usize, known: &[(u32, u32, f64)], given: &[f64], found: &[f64]) -> Vec<f64> {
    let shapes = given.chunks_exact(size.max(1));
    let pairs = shapes.zip(found.chunks_exact(size.max(1)));
    let misfit = |(given, found): (&[f64], &[f64])| {
        let (mut rest, mut whole) = (0.0, 0.0);
        for (freedom, ..) in known {
            let at = *freedom as usize;
            rest += (given[at] - found[at]) * (given[at] - found[at]);
            whole += given[at] * given[at];
        }
        if whole > 0.0 {
            libm::sqrt(rest / whole)
        } else {
            0.0
        }
    };
    pairs.map(misfit).collect()
}

/// Refuses shapes that leave free freedoms open.
fn determined(
    file: &str,
    reduction: &Reduction,
    matrix: &SymmetricMatrix,
) -> Result<(), FlexibleError> {
    let open: Vec<usize> = (0..matrix.size())
        .filter(|column| {
            let (rows, values) = matrix.column(*column);
            let own = rows
                .iter()
                .zip(values)
                .find(|(row, _)| **row as usize == *column);
            own.is_none_or(|(_, value)| *value <= 0.0)
        })
        .collect();
    if open.is_empty() {
        Ok(())
    } else {
        Err(undetermined(file, reduction, &open))
    }
}

fn undetermined(file: &str, reduction: &Reduction, open: &[usize]) -> FlexibleError {
    let names: Vec<String> = open
        .iter()
        .take(NAMED)
        .filter_map(|free| reduction.name(*free))
        .collect();
    FlexibleError::structure(
        format!(
            "{file}: the shapes have no values for {} freedoms of the body: {}{}",
            open.len(),
            names.join(", "),
            if open.len() > NAMED { ", …" } else { "" }
        ),
        "write the shapes of all nodes, with rotations at nodes that turn",
    )
}
