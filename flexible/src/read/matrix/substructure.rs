//! Matrices of a substructure (`*SUBSTRUCTURE MATRIX OUTPUT` of Abaqus and CalculiX):
//!
//! ```text
//! *USER ELEMENT, NODES=2, LINEAR
//! ** ELEMENT NODES
//! ** 101, 102
//! 1, 2, 3          freedoms of the first node, and of the following ones
//! 2, 1, 2          place in the list of nodes, and the freedoms from there on
//! *MATRIX, TYPE=STIFFNESS
//! lower triangle, one row after the other, broken into lines
//! *MATRIX, TYPE=MASS
//! ```
//!
//! A generalised freedom of a retained eigenmode is a node of its own with the one freedom 1. The stiffness
//! couples it with no other freedom, because the eigenmodes are those of the substructure with held
//! interface. By this the reader knows it as a scalar point.

use super::text::{NUMBERS, Text, count, real};
use super::{ForeignFreedoms, ForeignMatrix, Held, chosen};
use crate::error::FileProblem;
use crate::read::csv::fields;

/// Beginning of the file's first keyword.
const BEGINNING: &str = "*USERELEMENT";

/// Most freedoms of a substructure, whose triangle is dense. It has 1.6 GB then. A choice: more would not fit
/// in the memory of many machines, and a message is better than their end.
const MOST: usize = 20_000;

fn squeezed(line: &str) -> String {
    let letters = line.chars().filter(|c| !c.is_whitespace());
    letters.collect::<String>().to_ascii_uppercase()
}

/// Whether a keyword begins the matrices of a substructure.
pub(super) fn begins(line: &str) -> bool {
    squeezed(line).starts_with(BEGINNING)
}

/// Reads the matrix of this type from the file, whose next line is `*USER ELEMENT`.
///
/// # Errors
/// With file and line: an unsymmetric matrix, nodes or freedoms that are missing or no numbers, a triangle of
/// another size; a type that the file does not contain, with those that it contains.
pub(super) fn read(mut text: Text, file: &str, name: &str) -> Result<ForeignMatrix, FileProblem> {
    let mut rows = freedoms(&mut text)?;
    let mut blocks: Vec<(String, Vec<f64>)> = Vec::new();
    while let Some(line) = text.next_line()? {
        let line = line.trim();
        if line.is_empty() || line.starts_with("**") {
            continue;
        }
        if line.starts_with('*') {
            let keyword = squeezed(line);
            let kind = keyword.strip_prefix("*MATRIX,TYPE=").map(str::to_owned);
            let Some(kind) = kind else {
                return Err(text.wrong(
                    "a matrix of the substructure",
                    "give a file with one substructure, as *SUBSTRUCTURE MATRIX OUTPUT writes it",
                ));
            };
            complete(&text, blocks.last(), rows.len())?;
            blocks.push((kind, Vec::new()));
            continue;
        }
        let values: Option<Vec<f64>> = fields(line).into_iter().map(real).collect();
        match (values, blocks.last_mut()) {
            (Some(values), Some((_, block))) => block.extend(values),
            (None, _) => return Err(text.wrong("a line of finite numbers", NUMBERS)),
            (Some(_), None) => return Err(text.wrong("\"*MATRIX, TYPE=STIFFNESS\"", NUMBERS)),
        }
    }
    complete(&text, blocks.last(), rows.len())?;
    let size = rows.len();
    let held: Vec<Held> = blocks
        .iter()
        .map(|(kind, _)| Held {
            name: kind.clone(),
            size: (size, size),
        })
        .collect();
    let stiffness = blocks.iter().find(|(kind, _)| kind == "STIFFNESS");
    if let Some((_, stiffness)) = stiffness {
        mark_modal(&mut rows, stiffness);
    }
    let wanted = |kind: &str| name.is_empty() || kind.eq_ignore_ascii_case(name);
    let found = blocks.into_iter().rfind(|(kind, _)| wanted(kind));
    let found = found.map(|(kind, values)| ForeignMatrix {
        file: file.into(),
        name: kind,
        rows: size,
        columns: size,
        symmetric: true,
        entries: triangle()
            .zip(values)
            .map(|((i, j), x)| (i, j, x))
            .collect(),
        freedoms: Some(ForeignFreedoms { rows }),
    });
    chosen(file, name, &held, found)
}

/// Row and column of the entries of a lower triangle.
fn triangle() -> impl Iterator<Item = (u32, u32)> {
    (0u32..).flat_map(|row| (0..=row).map(move |column| (row, column)))
}

/// Checks that the matrix before has a whole triangle.
fn complete(
    text: &Text,
    block: Option<&(String, Vec<f64>)>,
    size: usize,
) -> Result<(), FileProblem> {
    let needed = size * (size + 1) / 2;
    match block {
        Some((kind, values)) if values.len() != needed => Err(text.problem(
            format!(
                "the matrix {kind} before this line has {} numbers; the triangle of {size} freedoms has {needed}",
                values.len()
            ),
            "write or copy the file again; it was edited or cut",
        )),
        _ => Ok(()),
    }
}

/// The freedoms of the rows, up to the first matrix.
fn freedoms(text: &mut Text) -> Result<Vec<(u64, u8)>, FileProblem> {
    const NODES: &str = "give the file of *SUBSTRUCTURE MATRIX OUTPUT as it was written, with its comment ** ELEMENT NODES";
    let mut nodes: Vec<u64> = Vec::new();
    let mut listed = false;
    // freedoms by the place of the first node that has them
    let mut from: Vec<(usize, Vec<u8>)> = Vec::new();
    while let Some(line) = text.next_line()? {
        let line = line.trim().to_owned();
        let keyword = squeezed(&line);
        if keyword.starts_with("*MATRIX") {
            text.put_back();
            break;
        }
        if let Some(comment) = keyword.strip_prefix("**") {
            listed |= comment == "ELEMENTNODES";
            let numbers: Option<Vec<u64>> = fields(comment).into_iter().map(count).collect();
            nodes.extend(
                numbers
                    .filter(|_| listed && from.is_empty())
                    .into_iter()
                    .flatten(),
            );
        } else if keyword.starts_with(BEGINNING) {
            if keyword.contains("UNSYMM") {
                return Err(text.problem(
                    "the matrices are not symmetric",
                    "write those of a linear elastic substructure",
                ));
            }
        } else if !keyword.is_empty() {
            let numbers: Option<Vec<u64>> = fields(&line).into_iter().map(count).collect();
            let first = from.is_empty();
            let (place, own) = match numbers.as_deref() {
                Some(own) if first => (1, own),
                Some([place, own @ ..]) => (*place, own),
                _ => (0, &[][..]),
            };
            let own: Option<Vec<u8>> = own
                .iter()
                .map(|f| u8::try_from(*f).ok().filter(|f| (1..=6).contains(f)))
                .collect();
            let place = usize::try_from(place).unwrap_or(usize::MAX);
            match own {
                Some(own) if !own.is_empty() && (1..=nodes.len()).contains(&place) => {
                    from.push((place - 1, own));
                }
                _ if nodes.is_empty() => {
                    return Err(text.problem(
                        "the nodes of the substructure are missing before this line",
                        NODES,
                    ));
                }
                _ => {
                    return Err(text.wrong(
                        "a list of freedoms from 1 to 6, after the place of their node",
                        NODES,
                    ));
                }
            }
        }
    }
    let mut rows = Vec::new();
    for (place, node) in nodes.iter().enumerate() {
        let own = from.iter().rfind(|(first, _)| *first <= place);
        rows.extend(
            own.into_iter()
                .flat_map(|(_, own)| own.iter().map(|f| (*node, *f))),
        );
    }
    match rows.len() {
        0 => Err(text.problem(
            "the nodes of the substructure or their freedoms are missing",
            NODES,
        )),
        size if size > MOST => Err(text.problem(
            format!("the substructure has {size} freedoms"),
            "retain fewer nodes; Eng reads up to 20,000 freedoms of a dense matrix",
        )),
        _ => Ok(rows),
    }
}

/// Makes scalar points of the nodes with the one freedom 1 that the stiffness couples with no other.
fn mark_modal(rows: &mut [(u64, u8)], stiffness: &[f64]) {
    let mut coupled = vec![false; rows.len()];
    for ((i, j), value) in triangle().zip(stiffness) {
        if i != j && *value != 0.0 {
            for k in [i, j] {
                if let Some(coupled) = coupled.get_mut(k as usize) {
                    *coupled = true;
                }
            }
        }
    }
    let alone: Vec<bool> = rows
        .iter()
        .map(|(node, freedom)| {
            *freedom == 1 && rows.iter().filter(|(other, _)| other == node).count() == 1
        })
        .collect();
    for ((row, coupled), alone) in rows.iter_mut().zip(coupled).zip(alone) {
        if alone && !coupled {
            row.1 = 0;
        }
    }
}
