//! Nodes whose motion a matrix of another code recovers from the freedoms of a condensed body, `u = T q`.
//!
//! The nodes join the mesh. Each of their freedoms is an equation of the freedoms q, which are those of the rows of the
//! stiffness. So stiffness and mass stay as they are, markers can use the nodes, and the shapes contain their motion.
//!
//! A matrix whose columns have another order gives other numbers without a sign of it. So two properties are checked that every
//! condensation has: at nodes of the interface T is the identity, and a rigid motion of the interface moves all nodes rigidly.

use super::report::RecoveredNodes;
use crate::element::around;
use crate::error::{FlexibleError, Part};
use crate::fe::NodalMatrix;
use crate::fe::check::list;
use crate::fe::foreign::{moved, places};
use crate::fe::freedoms::direction;
use crate::fe::vector::{Vector, add, cross, dot, norm, scale, subtract};
use crate::foreign::RecoveryMatrix;
use crate::mesh::{
    ABSENT, Element, ElementKind, Mesh, Node, Property, Section, Tie, Variant, scalar_index,
};
use crate::read::matrix::ForeignMatrix;
use crate::surface::outer_faces;
use eng_system::significant::short;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Largest deviation from the identity at nodes of the interface, as a part of the largest entry of the column. A choice:
/// files of seven digits pass.
const IDENTITY: f64 = 1e-6;

/// Largest distance of the places of one node in two files, as a part of the extent of the nodes. A choice: coordinates of a
/// file may have six or seven digits.
const PLACE: f64 = 1e-5;

/// Most entries. Each takes about eighty bytes while the equations are made. A choice: more than nodes for a picture need.
const MOST: usize = 8_000_000;

/// Name of the property of the cells.
const CELLS: &str = "recovered";

/// The rows of a node by its components 0…5.
type NodeRows = [Option<usize>; 6];

/// A line of T: column and entry, ascending, without zeros.
type Line = Vec<(usize, f64)>;

/// Nodes that have joined a mesh.
#[derive(Clone, Debug)]
pub(super) struct Recovered {
    /// Indices of the nodes that joined.
    pub joined: Range<usize>,
    /// Indices of the equations among the ties of the mesh.
    pub equations: Range<usize>,
    /// A note on nodes and cells without rows.
    pub note: Option<String>,
    found: RecoveredNodes,
    /// The largest deviation in words: its node and motion.
    worst: String,
    tolerance: f64,
}

impl Recovered {
    /// The facts for the report, after the check of rigid motions. A `held` structure has none.
    ///
    /// # Errors
    /// Nodes that miss a rigid motion of the interface by more than the tolerance.
    pub fn checked(self, held: bool) -> Result<RecoveredNodes, FlexibleError> {
        let deviation = self.found.deviation.filter(|_| !held);
        if let Some(deviation) = deviation
            && (deviation.is_nan() || deviation > self.tolerance)
        {
            return Err(wrong(
                format!(
                    "{}: {}: the difference is {} of the motion, and {} is allowed",
                    self.found.title,
                    self.worst,
                    short(deviation, 2),
                    short(self.tolerance, 2)
                ),
                "write the columns in the order of the rows of the stiffness, and give the places of the nodes and the units of \
                 the same run; `tolerance:` accepts more",
            )
            .of(Part::Recovery));
        }
        Ok(RecoveredNodes {
            deviation,
            ..self.found
        })
    }
}

fn wrong(problem: String, advice: &str) -> FlexibleError {
    FlexibleError::Matrix {
        problem,
        advice: advice.into(),
    }
}

/// T with the places of its rows and columns in the mesh.
struct Placed<'a> {
    title: &'a str,
    mesh: &'a Mesh,
    /// Index of the node or scalar point, and component, of each column.
    columns: &'a [(u32, u8)],
    lines: &'a [Line],
    /// Index of the node, and its rows.
    nodes: &'a [(u32, NodeRows)],
    /// Metres of the unit of length of T.
    length: f64,
}

/// Adds the nodes of a recovery matrix to a mesh in SI, with their equations and cells.
///
/// # Errors
/// A mesh with elements of its own; a matrix of another size; rows and nodes that do not belong together; a matrix that is not
/// the identity at nodes of the interface.
pub(super) fn attach(
    mesh: &mut Mesh,
    asked: &RecoveryMatrix,
    stiffness: &NodalMatrix,
    mass: &NodalMatrix,
) -> Result<Recovered, FlexibleError> {
    let title = asked.title();
    if !mesh.elements.is_empty() {
        return Err(wrong(
            format!("{title} recovers nodes of a condensed body, but the mesh has elements"),
            "give the nodes of the interface alone as `mesh`, and the mesh with its elements as `nodes` of the recovery",
        ));
    }
    let columns = places(mesh, stiffness).map_err(|error| error.of(Part::Stiffness))?;
    let heavy = places(mesh, mass).map_err(|error| error.of(Part::Mass))?;
    if asked.matrix.columns != columns.len() {
        return Err(wrong(
            format!(
                "{title} has {} columns, but the stiffness has {} rows",
                asked.matrix.columns,
                columns.len()
            ),
            "write a column for each row of the stiffness, in the same order",
        ));
    }
    let rows = rows_of_nodes(asked, mesh, &title)?;
    let lines = lines(&asked.matrix, &title)?;
    let interface = mesh.nodes.len();
    let (indices, mut note) = join_nodes(mesh, asked, &rows, &title)?;
    let nodes = with_motion(&rows, &indices, &lines);
    let placed = Placed {
        title: &title,
        mesh: &*mesh,
        columns: &columns,
        lines: &lines,
        nodes: &nodes,
        length: asked.units.length,
    };
    placed.check_identity(interface)?;
    let (deviation, worst) = placed.deviation();
    // rows without stiffness and mass are held, as without a recovery
    let masks = moved(mesh, [(stiffness, &columns), (mass, &heavy)]);
    let moves = |(node, component): (u32, u8)| {
        let place = scalar_index(node).map_or(node as usize, |index| mesh.nodes.len() + index);
        masks
            .get(place)
            .is_some_and(|mask| mask & (1 << component) != 0)
    };
    let moving: Vec<bool> = columns.iter().map(|column| moves(*column)).collect();
    let equations = placed.equations(&moving);
    let first = mesh.ties.len();
    mesh.ties.extend(equations);
    let with_places: BTreeMap<u64, u32> = nodes
        .iter()
        .map(|(node, _)| *node)
        .chain(columns.iter().map(|(node, _)| *node))
        .filter_map(|node| Some((mesh.nodes.get(node as usize)?.id, node)))
        .collect();
    let lost = join_cells(mesh, &asked.nodes, &with_places);
    if lost > 0 {
        let cells = format!("{lost} faces of `nodes` have nodes without rows and are not drawn");
        note = Some(match note {
            Some(note) => format!("{note}; {cells}"),
            None => format!("{title}: {cells}"),
        });
    }
    Ok(Recovered {
        joined: interface..mesh.nodes.len(),
        equations: first..mesh.ties.len(),
        note,
        found: RecoveredNodes {
            nodes: nodes.len(),
            deviation: Some(deviation),
            title,
        },
        worst,
        tolerance: asked.tolerance,
    })
}

/// The rows of each node, by its number. Rows of scalar points are left out: they repeat a column.
fn rows_of_nodes(
    asked: &RecoveryMatrix,
    interface: &Mesh,
    title: &str,
) -> Result<BTreeMap<u64, NodeRows>, FlexibleError> {
    let mut rows: BTreeMap<u64, NodeRows> = BTreeMap::new();
    for (row, (id, component)) in asked.rows(interface)?.into_iter().enumerate() {
        let Some(component) = component else { continue };
        let own = rows.entry(id).or_default();
        let before = own
            .get_mut(usize::from(component))
            .map(|own| own.replace(row));
        if before != Some(None) {
            return Err(wrong(
                format!(
                    "{title} has two rows of component {} of node {id}",
                    component + 1
                ),
                "check the order of the rows; each row must be a different freedom",
            ));
        }
    }
    let partly = |own: &[Option<usize>]| own.iter().any(Option::is_none);
    for (id, own) in &rows {
        let (along, about) = own.split_at(3);
        let some_turns = about.iter().any(Option::is_some);
        if partly(along) || (some_turns && partly(about)) {
            let named = own.iter().enumerate().filter(|(_, row)| row.is_some());
            let named: Vec<String> = named.map(|(k, _)| (k + 1).to_string()).collect();
            return Err(wrong(
                format!(
                    "{title} has rows of node {id} for its components {} alone",
                    named.join(", ")
                ),
                "write the rows of the components 1 to 3, or 1 to 6, of each node",
            ));
        }
    }
    if rows.is_empty() {
        return Err(wrong(
            format!("{title} has no row of a node"),
            "ask for displacements in the run that writes it",
        ));
    }
    Ok(rows)
}

/// The lines of T.
fn lines(matrix: &ForeignMatrix, title: &str) -> Result<Vec<Line>, FlexibleError> {
    if matrix.symmetric {
        return Err(wrong(
            format!("{title} holds one triangle of a symmetric matrix, which recovers no nodes"),
            "name the matrix of the displacements; it is rectangular",
        ));
    }
    if matrix.entries.len() > MOST {
        return Err(wrong(
            format!(
                "{title} has {} entries; {MOST} are allowed",
                matrix.entries.len()
            ),
            "recover fewer nodes: those of a picture and of the markers",
        ));
    }
    let mut entries = matrix.entries.clone();
    entries.sort_by_key(|(row, column, _)| (*row, *column));
    let mut lines: Vec<Line> = vec![Vec::new(); matrix.rows];
    for (row, column, value) in entries {
        let inside = (column as usize) < matrix.columns && value.is_finite();
        let Some(line) = lines.get_mut(row as usize).filter(|_| inside) else {
            return Err(wrong(
                format!(
                    "{title} has {value} at row {}, column {}",
                    row + 1,
                    column + 1
                ),
                "write or copy the file again; it is damaged, or the run that wrote it failed",
            ));
        };
        match line.last_mut() {
            Some((known, sum)) if *known == column as usize => *sum += value,
            _ => line.push((column as usize, value)),
        }
    }
    for line in &mut lines {
        line.retain(|(_, value)| *value != 0.0);
    }
    Ok(lines)
}

/// The largest extent of places along an axis.
fn extent<'n>(nodes: impl Iterator<Item = &'n Node> + Clone) -> f64 {
    let along = |axis: usize| {
        let places = nodes
            .clone()
            .filter_map(move |node| node.position.get(axis));
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
        high - low
    };
    (0..3).map(along).fold(0.0, f64::max)
}

/// Adds the nodes with rows that the mesh does not have. Returns the index of each node of the mesh, and a note on nodes of the
/// list without rows.
fn join_nodes(
    mesh: &mut Mesh,
    asked: &RecoveryMatrix,
    rows: &BTreeMap<u64, NodeRows>,
    title: &str,
) -> Result<(BTreeMap<u64, u32>, Option<String>), FlexibleError> {
    let mut indices: BTreeMap<u64, u32> = mesh.node_index();
    let size = extent(mesh.nodes.iter().chain(&asked.nodes.nodes));
    let first_frame = mesh.frames.len() as u32;
    let mut without: Vec<u64> = Vec::new();
    for node in &asked.nodes.nodes {
        if let Some(known) = indices.get(&node.id) {
            let known = mesh.nodes.get(*known as usize).map(|known| known.position);
            let apart = known.map_or(0.0, |known| norm(subtract(known, node.position)));
            if apart > PLACE * size {
                return Err(wrong(
                    format!(
                        "node {} has two places, {} mm apart: one in the mesh of the interface, one in the nodes of {title}",
                        node.id,
                        short(1e3 * apart, 4)
                    ),
                    "give both files with the units and the axes of the same run",
                ));
            }
            continue;
        }
        if !rows.contains_key(&node.id) {
            without.push(node.id);
            continue;
        }
        indices.insert(node.id, mesh.nodes.len() as u32);
        mesh.nodes.push(Node {
            frame: node.frame.map(|frame| first_frame + frame),
            ..*node
        });
    }
    mesh.frames.extend_from_slice(&asked.nodes.frames);
    let lost: Vec<u64> = rows
        .keys()
        .filter(|id| !indices.contains_key(id))
        .copied()
        .collect();
    if !lost.is_empty() {
        return Err(wrong(
            format!(
                "{title} has rows of {} nodes that `nodes` does not have: {}",
                lost.len(),
                list(lost.iter().map(u64::to_string))
            ),
            "add these nodes with their places, or leave their rows out",
        ));
    }
    let listed = || list(without.iter().map(u64::to_string));
    if !without.is_empty() && asked.nodes.elements.is_empty() {
        return Err(wrong(
            format!(
                "{title} has no rows of {} of its nodes: {}",
                without.len(),
                listed()
            ),
            "leave these nodes out of the list, or write their rows",
        ));
    }
    let note = (!without.is_empty()).then(|| {
        format!(
            "{title} has no rows of {} of the nodes in `nodes`: {}",
            without.len(),
            listed()
        )
    });
    Ok((indices, note))
}

/// The nodes with rows, by their indices. Rotations whose rows are zero are those of nodes of solids, which have none.
fn with_motion(
    rows: &BTreeMap<u64, NodeRows>,
    indices: &BTreeMap<u64, u32>,
    lines: &[Line],
) -> Vec<(u32, NodeRows)> {
    let still = |row: &Option<usize>| row.and_then(|row| lines.get(row)).is_none_or(Vec::is_empty);
    let nodes = rows.iter().filter_map(|(id, own)| {
        let mut own = *own;
        if own.iter().skip(3).all(still) {
            own.iter_mut().skip(3).for_each(|row| *row = None);
        }
        Some((*indices.get(id)?, own))
    });
    nodes.collect()
}

impl Placed<'_> {
    /// Component, row and line of each row of a node.
    fn of_node<'s>(&'s self, own: &'s NodeRows) -> impl Iterator<Item = (u8, &'s Line)> {
        let rows = (0u8..).zip(own);
        rows.filter_map(move |(component, row)| Some((component, self.lines.get((*row)?)?)))
    }

    fn id(&self, node: u32) -> u64 {
        self.mesh.nodes.get(node as usize).map_or(0, |node| node.id)
    }

    /// Requires that a freedom of the interface follows itself alone. `interface` is the number of its nodes.
    fn check_identity(&self, interface: usize) -> Result<(), FlexibleError> {
        // the largest entry of each column among translations and among rotations, which have other units
        let mut largest = vec![[0.0f64; 2]; self.columns.len()];
        for (_, own) in self.nodes {
            for (component, line) in self.of_node(own) {
                for (column, x) in line {
                    if let Some(largest) = largest.get_mut(*column) {
                        let kind = usize::from(component / 3);
                        largest[kind] = largest[kind].max(x.abs());
                    }
                }
            }
        }
        let columns: BTreeMap<(u32, u8), usize> =
            (self.columns.iter().copied().zip(0usize..)).collect();
        let inner = self
            .nodes
            .iter()
            .filter(|(node, _)| (*node as usize) < interface);
        for (node, own) in inner {
            for (component, line) in self.of_node(own) {
                let Some(diagonal) = columns.get(&(*node, component)) else {
                    continue;
                };
                let itself = line.iter().find(|(column, _)| column == diagonal);
                let itself = itself.map_or(0.0, |(_, x)| *x);
                let others = line.iter().filter(|(column, _)| column != diagonal);
                let share = |column: usize, x: f64| {
                    let most = largest
                        .get(column)
                        .map_or(1.0, |most| most[usize::from(component / 3)]);
                    x.abs() / most
                };
                let beside = others.map(|(column, x)| (share(*column, *x), *column, *x));
                let first = ((itself - 1.0).abs(), *diagonal, itself);
                let worst = beside.fold(
                    first,
                    |worst, next| {
                        if next.0 > worst.0 { next } else { worst }
                    },
                );
                if worst.0 > IDENTITY {
                    let by = self.columns.get(worst.1).copied().unwrap_or_default();
                    return Err(wrong(
                        format!(
                            "{}: {} is a freedom of the stiffness, but its row has {} in the column of {}",
                            self.title,
                            self.mesh.freedom_name(*node, component),
                            short(worst.2, 6),
                            match by == (*node, component) {
                                true => "itself".to_owned(),
                                false => self.mesh.freedom_name(by.0, by.1),
                            }
                        ),
                        "write the columns in the order of the rows of the stiffness: such a row has 1 in its own column and 0 in \
                         the others",
                    ));
                }
            }
        }
        Ok(())
    }

    /// The equations of all rows whose freedom is no column: `u − Σ T_j q_j = 0` in SI. Columns that do not move are left out.
    fn equations(&self, moving: &[bool]) -> Vec<Tie> {
        let columns: BTreeSet<(u32, u8)> = self.columns.iter().copied().collect();
        let mut equations = Vec::new();
        for (node, own) in self.nodes {
            for (component, line) in self.of_node(own) {
                if columns.contains(&(*node, component)) {
                    continue;
                }
                let mut terms = Vec::with_capacity(line.len() + 1);
                terms.push((*node, component, 1.0));
                for (column, x) in line {
                    if moving.get(*column) == Some(&true)
                        && let Some(by) = self.columns.get(*column)
                    {
                        terms.push((by.0, by.1, -x * self.unit(component, *by)));
                    }
                }
                let id = self.id(*node);
                equations.push(Tie::Equation { id, terms });
            }
        }
        equations
    }

    /// The factor from the units of T to SI of an entry: translations are lengths, rotations and amplitudes of scalar points
    /// are numbers.
    fn unit(&self, row: u8, (node, component): (u32, u8)) -> f64 {
        let is_length = component < 3 && scalar_index(node).is_none();
        match (row < 3, is_length) {
            (true, false) => self.length,
            (false, true) => 1.0 / self.length,
            _ => 1.0,
        }
    }

    /// The largest miss of a rigid motion of the interface, and its node and motion in words. A miss of a unit translation is
    /// a share of it (rotations times the size), that of a unit rotation about the middle of the interface is a rotation
    /// (translations by the size). Scalar points do not move in a rigid motion. The size is the largest distance of a node from
    /// the middle.
    fn deviation(&self) -> (f64, String) {
        let interface = self.columns.iter().map(|(node, _)| *node);
        let ids: BTreeSet<u32> = interface
            .filter(|node| scalar_index(*node).is_none())
            .collect();
        let place = |node: u32| -> Vector {
            let node = self.mesh.nodes.get(node as usize);
            node.map_or([0.0; 3], |node| node.position)
        };
        let sum = ids
            .iter()
            .fold([0.0; 3], |sum, node| add(sum, place(*node)));
        let middle = scale(1.0 / ids.len().max(1) as f64, sum);
        let reach = |node: u32| norm(subtract(place(node), middle));
        let nodes = self.nodes.iter().map(|(node, _)| *node);
        let size = ids
            .iter()
            .copied()
            .chain(nodes)
            .map(reach)
            .fold(0.0, f64::max);
        let size = if size > 0.0 { size } else { 1.0 };
        let rigid = |motion: usize, (node, component): (u32, u8)| -> f64 {
            if scalar_index(node).is_some() {
                return 0.0;
            }
            let along = direction(self.mesh, node, component);
            let axis = [0, 1, 2].map(|k| if k == motion % 3 { 1.0 } else { 0.0 });
            match (motion < 3, component < 3) {
                (true, true) | (false, false) => dot(along, axis),
                (true, false) => 0.0,
                (false, true) => dot(along, cross(axis, subtract(place(node), middle))),
            }
        };
        let (mut worst, mut at) = (0.0f64, (0u32, 0usize));
        for motion in 0..6 {
            let q: Vec<f64> = self.columns.iter().map(|by| rigid(motion, *by)).collect();
            for (node, own) in self.nodes {
                for (component, line) in self.of_node(own) {
                    let by =
                        |column: &usize| self.columns.get(*column).copied().unwrap_or_default();
                    let terms = line.iter().map(|(column, x)| {
                        x * self.unit(component, by(column))
                            * q.get(*column).copied().unwrap_or(0.0)
                    });
                    let miss = (terms.sum::<f64>() - rigid(motion, (*node, component))).abs();
                    let miss = match (motion < 3, component < 3) {
                        (true, false) => miss * size,
                        (false, true) => miss / size,
                        _ => miss,
                    };
                    if miss.is_nan() || miss > worst {
                        (worst, at) = (miss, (*node, motion));
                    }
                }
            }
        }
        let axis = ["x", "y", "z"].get(at.1 % 3).copied().unwrap_or_default();
        let motion = match at.1 < 3 {
            true => "translation along",
            false => "rotation about",
        };
        let text = format!(
            "a rigid {motion} {axis} of the interface does not move node {} rigidly",
            self.id(at.0)
        );
        (worst, text)
    }
}

/// Adds the outer faces of a mesh as facets for pictures. `places` has the index of each node that moves. Returns the number of
/// faces that have other corners. A middle of a side without a place is left out.
fn join_cells(mesh: &mut Mesh, cells: &Mesh, places: &BTreeMap<u64, u32>) -> usize {
    let property = mesh.properties.len() as u32;
    let index = |node: u32| {
        let id = cells.nodes.get(node as usize)?.id;
        places.get(&id).copied()
    };
    let mut lost = 0;
    for (element, face) in outer_faces(cells) {
        let Some(element) = cells.elements.get(element as usize) else {
            continue;
        };
        let faces = element.kind.description().faces;
        let Some(corners) = faces.get(face) else {
            continue;
        };
        let mut ring = around(element.kind, cells.nodes_of(element), corners);
        // the corners of a solid's face are in the order that an observer inside sees
        if faces.len() > 1 {
            ring = turned_over(&ring);
        }
        let corners: Option<Vec<u32>> = ring.iter().map(|(corner, _)| index(*corner)).collect();
        let middles: Vec<Option<u32>> = ring
            .iter()
            .map(|(_, middle)| middle.and_then(index))
            .collect();
        let curved = middles.iter().any(Option::is_some);
        let kind = ElementKind::of_face(ring.len(), curved);
        let (Some(corners), Some(kind)) = (corners, kind) else {
            lost += 1;
            continue;
        };
        mesh.elements.push(Element {
            id: mesh.elements.len() as u64 + 1,
            kind,
            variant: Variant::Plain,
            property,
            first: mesh.connectivity.len() as u32,
            beam: None,
            shell: None,
        });
        mesh.connectivity.extend(corners);
        if curved {
            let middles = middles.into_iter().map(|middle| middle.unwrap_or(ABSENT));
            mesh.connectivity.extend(middles);
        }
    }
    if !mesh.elements.is_empty() {
        mesh.properties.push(Property {
            name: CELLS.into(),
            material: None,
            section: Section::Solid,
        });
    }
    lost
}

/// A ring of corners, each with the middle of the side after it, in the other order.
fn turned_over(ring: &[(u32, Option<u32>)]) -> Vec<(u32, Option<u32>)> {
    let corners = ring.iter().rev().map(|(corner, _)| *corner);
    // the side after the last corner comes first among the others
    let middles = ring.iter().rev().skip(1).chain(ring.last());
    corners.zip(middles.map(|(_, middle)| *middle)).collect()
}
