//! `MASS21`, `COMBIN14`, `CE`, `CP`, `D`.

use std::collections::BTreeMap;

use super::deck::{Deck, Row};
use super::shapes::Family;
use crate::error::FileProblem;
use crate::fe::vector::{norm, scale, subtract};
use crate::mesh::{Mesh, PointMass, Spring, Support, Tie, along_axes};
use crate::read::held::HoldingCards;
use crate::read::labels::Labels;
use crate::read::source::At;

/// Makes the masses and springs of a mesh.
pub(super) fn make(
    deck: &Deck,
    rows: Vec<(Family, Row)>,
    mesh: &mut Mesh,
    labels: &Labels,
) -> Result<(), FileProblem> {
    for (family, row) in rows {
        if family == Family::Mass {
            mass(deck, &row, mesh, labels)?;
        } else {
            spring(deck, &row, mesh, labels)?;
        }
    }
    Ok(())
}

fn find(labels: &Labels, node: u64, what: &str, at: &At) -> Result<u32, FileProblem> {
    labels.find(node).ok_or_else(|| {
        at.problem(
            format!("{what} uses node {node}, which is missing"),
            "write the whole mesh with all its nodes",
        )
    })
}

/// The constants of an element.
fn constants<'d>(deck: &'d Deck, row: &Row, title: &str) -> Result<&'d [f64], FileProblem> {
    deck.reals.get(&row.real).map(Vec::as_slice).ok_or_else(|| {
        row.at.problem(
            format!("{title}: its set of constants {} does not exist", row.real),
            "add the set by R or RLBLOCK",
        )
    })
}

/// Masses along x, y, z and moments of inertia about them (KEYOPT(3) = 0), or one mass (KEYOPT(3) = 2), in
/// the global axes, or in those of the node (KEYOPT(2) = 1).
fn mass(deck: &Deck, row: &Row, mesh: &mut Mesh, labels: &Labels) -> Result<(), FileProblem> {
    let title = format!("element {} (MASS21)", row.id);
    let option = |number: i64| deck.option(row, number);
    let values = constants(deck, row, &title)?;
    let value = |i: usize| values.get(i).copied().unwrap_or(0.0);
    let one = value(0);
    let diagonal = match option(3) {
        0 => [0, 1, 2, 3, 4, 5].map(value),
        2 => [one, one, one, 0.0, 0.0, 0.0],
        _ => {
            return Err(row.at.problem(
                format!("{title}: KEYOPT(3) = {} is a mass in a plane", option(3)),
                "write it with KEYOPT(3) = 0 or 2",
            ));
        }
    };
    let [node] = *row.nodes.as_slice() else {
        return Err(row.at.problem(
            format!("{title} has {} nodes", row.nodes.len()),
            "give it one node",
        ));
    };
    let node = find(labels, node, &title, &row.at)?;
    let turned = mesh
        .nodes
        .get(node as usize)
        .is_some_and(|node| node.frame.is_some());
    let [x, y, z, rx, ry, rz] = diagonal;
    let alike = x == y && y == z && rx == ry && ry == rz;
    if option(1) != 0 || (!alike && (row.system != 0 || (option(2) == 1 && turned))) {
        return Err(row.at.problem(
            format!("{title} has values by volume, or in own axes"),
            "write it with KEYOPT(1) = 0 and the global axes",
        ));
    }
    let mut matrix = [[0.0; 6]; 6];
    for (i, (line, value)) in matrix.iter_mut().zip(diagonal).enumerate() {
        line[i] = value;
    }
    mesh.point_masses.push(PointMass {
        id: row.id,
        node,
        matrix,
    });
    Ok(())
}

/// A spring along the line between its nodes (KEYOPT(2) = 0, KEYOPT(3) = 0; 1: a torsion spring about it), or
/// between freedoms 1 to 6 of the nodes, each in its own frame (KEYOPT(2) = 1 … 6).
fn spring(deck: &Deck, row: &Row, mesh: &mut Mesh, labels: &Labels) -> Result<(), FileProblem> {
    let title = format!("element {} (COMBIN14)", row.id);
    let option = |number: i64| deck.option(row, number);
    let values = constants(deck, row, &title)?;
    let stiffness = values.first().copied().unwrap_or(0.0);
    let [a, b] = *row.nodes.as_slice() else {
        return Err(row.at.problem(
            format!("{title} has {} nodes", row.nodes.len()),
            "give it two nodes",
        ));
    };
    let a = find(labels, a, &title, &row.at)?;
    let b = find(labels, b, &title, &row.at)?;
    if option(1) != 0 {
        return Err(row.at.problem(
            format!("{title}: KEYOPT(1) = {} is a nonlinear spring", option(1)),
            "write it with KEYOPT(1) = 0",
        ));
    }
    let first = match (option(2), option(3)) {
        (freedom @ 1..=6, _) => {
            let freedom = (freedom - 1) as u8; // 0 to 5
            let spring = Spring::between(row.id, stiffness, (a, freedom), Some((b, freedom)));
            mesh.springs.push(spring);
            return Ok(());
        }
        (0, 0) => 0,
        (0, 1) => 3,
        (one, other) => {
            return Err(row.at.problem(
                format!("{title}: KEYOPT(2) = {one}, KEYOPT(3) = {other} is no spring in space"),
                "write it with KEYOPT(2) from 0 to 6 and KEYOPT(3) = 0 or 1",
            ));
        }
    };
    let position = |node: u32| {
        let node = mesh.nodes.get(node as usize);
        node.map_or([0.0; 3], |node| node.position)
    };
    let along = subtract(position(b), position(a));
    let length = norm(along);
    if length == 0.0 {
        return Err(row.at.problem(
            format!("{title} has no length, and so no axis"),
            "move one of its nodes, or give it a freedom by KEYOPT(2)",
        ));
    }
    let axis = scale(1.0 / length, along);
    let mut terms = Vec::with_capacity(6);
    for (node, sign) in [(a, 1.0), (b, -1.0)] {
        let components = along_axes(&mesh.nodes, &mesh.frames, node, axis);
        for (k, factor) in (first..).zip(components) {
            // rounding of cosines
            if factor.abs() > 1e-12 {
                terms.push((node, k, sign * factor));
            }
        }
    }
    mesh.springs.push(Spring {
        id: row.id,
        stiffness,
        terms,
        grounded: false,
    });
    Ok(())
}

/// Constraint equations and coupled freedoms. The first freedom of an equation, and the first node of a
/// coupling, are those that ANSYS removes and keeps.
pub(super) fn ties(deck: &Deck, mesh: &mut Mesh, labels: &Labels) -> Result<(), FileProblem> {
    for (number, (terms, at)) in &deck.equations {
        let title = format!("CE: equation {number}");
        let mut made = Vec::with_capacity(terms.len());
        for (node, freedom, coefficient) in terms {
            if *coefficient != 0.0 {
                made.push((find(labels, *node, &title, at)?, *freedom, *coefficient));
            }
        }
        if made.is_empty() {
            continue;
        }
        mesh.ties.push(Tie::Equation {
            id: number.unsigned_abs(),
            terms: made,
        });
    }
    for (number, (freedoms, nodes, at)) in &deck.couplings {
        let title = format!("CP: set {number}");
        let Some((first, others)) = nodes.split_first() else {
            continue;
        };
        let first = find(labels, *first, &title, at)?;
        for node in others {
            let node = find(labels, *node, &title, at)?;
            for freedom in freedoms {
                mesh.ties.push(Tie::Equation {
                    id: number.unsigned_abs(),
                    terms: vec![(node, *freedom, 1.0), (first, *freedom, -1.0)],
                });
            }
        }
    }
    Ok(())
}

/// The supports of the archive.
pub(super) fn supports(deck: &Deck, mesh: &mut Mesh, labels: &Labels) -> Result<(), FileProblem> {
    let mut held: BTreeMap<u32, u8> = BTreeMap::new();
    let mut cards = HoldingCards::default();
    for (node, bits, moved, at) in &deck.supports {
        let node = find(labels, *node, "D", at)?;
        cards.note("D", at, *moved);
        *held.entry(node).or_default() |= bits;
    }
    let held = held.into_iter();
    mesh.supports = held
        .map(|(node, components)| Support { node, components })
        .collect();
    mesh.support_cards = cards.into_list();
    Ok(())
}
