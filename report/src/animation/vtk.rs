//! VTK XML unstructured grids and their series (Kitware, "VTK File Formats"), as ParaView reads them.

use super::quaternion::{normalised, rotated};
use super::{AnimationError, NodeField, Pose, check_count, check_finite};
use crate::escape::{base64, escaped};
use std::fmt::Write;

/// Kinds of cells, nodes in VTK's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// Bar of 2 nodes.
    Line2,
    /// Triangle of 3 nodes.
    Triangle3,
    /// Triangle of 6 nodes.
    Triangle6,
    /// Quadrilateral of 4 nodes.
    Quadrilateral4,
    /// Quadrilateral of 8 nodes.
    Quadrilateral8,
    /// Tetrahedron of 4 nodes.
    Tetrahedron4,
    /// Tetrahedron of 10 nodes.
    Tetrahedron10,
    /// Wedge of 6 nodes.
    Wedge6,
    /// Wedge of 15 nodes.
    Wedge15,
    /// Hexahedron of 8 nodes.
    Hexahedron8,
    /// Hexahedron of 20 nodes.
    Hexahedron20,
}

impl CellKind {
    /// VTK's number and the count of nodes.
    fn number_and_nodes(self) -> (u8, usize) {
        match self {
            CellKind::Line2 => (3, 2),
            CellKind::Triangle3 => (5, 3),
            CellKind::Triangle6 => (22, 6),
            CellKind::Quadrilateral4 => (9, 4),
            CellKind::Quadrilateral8 => (23, 8),
            CellKind::Tetrahedron4 => (10, 4),
            CellKind::Tetrahedron10 => (24, 10),
            CellKind::Wedge6 => (13, 6),
            CellKind::Wedge15 => (26, 15),
            CellKind::Hexahedron8 => (12, 8),
            CellKind::Hexahedron20 => (25, 20),
        }
    }
}

/// A body's mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct VtkBody {
    /// As in the model.
    pub name: String,
    /// Places of the nodes in the body's axes (m).
    pub nodes: Vec<[f64; 3]>,
    /// Kind and nodes (from 0) of each cell.
    pub cells: Vec<(CellKind, Vec<u32>)>,
}

/// A body at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct VtkFrame<'a> {
    /// Time (s).
    pub time: f64,
    /// The pose of the body.
    pub pose: Pose,
    /// Displacement of each node in the body's axes (m), not scaled; empty for none.
    pub displacements: &'a [[f64; 3]],
    /// Stress at each node (Pa) in the body's axes: xx, yy, zz, xy, yz, xz; empty for none.
    pub stress: &'a [[f64; 6]],
    /// Von Mises' equivalent stress at each node (Pa); empty for none.
    pub von_mises: &'a [f64],
    /// More numbers at the nodes.
    pub fields: &'a [NodeField],
}

/// The encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VtkEncoding {
    /// As text that can be read, with all digits.
    Ascii,
    /// As base64 of little-endian bytes: smaller, and quick to read.
    Base64,
}

/// One file of a series.
#[derive(Clone, Debug, PartialEq)]
pub struct VtkPart {
    /// Time (s).
    pub time: f64,
    /// Index of the body, from 0. Files with one time and different parts are shown together.
    pub part: usize,
    /// Path from the `.pvd` file to the `.vtu` file.
    pub file: String,
}

/// The text of a `.vtu` file: the body moved but not deformed, with the arrays `displacement` (m, inertial
/// axes; "Warp By Vector" shows it at any scale), `stress` (Pa, axes of the body, in VTK's order xx, yy, zz,
/// xy, yz, xz) and `von_mises` (Pa), and the fields by their names and units.
///
/// # Errors
/// Data that don't fit together.
pub fn vtu(
    body: &VtkBody,
    frame: &VtkFrame<'_>,
    encoding: VtkEncoding,
) -> Result<String, AnimationError> {
    let nodes = body.nodes.len();
    check(body, frame)?;
    let rotation = normalised(frame.pose.rotation);
    let points: Vec<f64> = body
        .nodes
        .iter()
        .flat_map(|node| frame.pose.place(*node))
        .collect();
    let mut connectivity = Vec::new();
    let mut offsets = Vec::new();
    let mut kinds = Vec::new();
    for (kind, cell) in &body.cells {
        connectivity.extend(cell.iter().map(|node| i64::from(*node)));
        offsets.push(connectivity.len() as i64);
        kinds.push(kind.number_and_nodes().0);
    }
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n",
    );
    let mut writer = Writer {
        text: &mut text,
        encoding,
    };
    writer.floats("TimeValue", 1, &[frame.time], " NumberOfTuples=\"1\"");
    writer.put(format_args!(
        "</FieldData>\n<Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{}\">\n<Points>\n",
        body.cells.len()
    ));
    writer.floats("Points", 3, &points, "");
    writer.put(format_args!("</Points>\n<Cells>\n"));
    writer.integers("connectivity", &connectivity);
    writer.integers("offsets", &offsets);
    writer.bytes("types", &kinds);
    writer.put(format_args!("</Cells>\n<PointData>\n"));
    if !frame.displacements.is_empty() {
        let moved: Vec<f64> = frame
            .displacements
            .iter()
            .flat_map(|d| rotated(rotation, *d))
            .collect();
        writer.floats("displacement", 3, &moved, "");
    }
    if !frame.stress.is_empty() {
        let all: Vec<f64> = frame.stress.iter().flatten().copied().collect();
        writer.floats("stress", 6, &all, "");
    }
    if !frame.von_mises.is_empty() {
        writer.floats("von_mises", 1, frame.von_mises, "");
    }
    for field in frame.fields {
        let name = format!("{} ({})", field.name, field.unit);
        writer.floats(&name, 1, &field.values, "");
    }
    writer.put(format_args!(
        "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    ));
    Ok(text)
}

fn check(body: &VtkBody, frame: &VtkFrame<'_>) -> Result<(), AnimationError> {
    let name = &body.name;
    let nodes = body.nodes.len();
    check_finite(name, "a node", body.nodes.iter().flatten().copied())?;
    for (kind, cell) in &body.cells {
        check_count(
            name,
            "nodes of a cell",
            cell.len(),
            kind.number_and_nodes().1,
        )?;
        if let Some(node) = cell.iter().find(|node| **node as usize >= nodes) {
            return Err(AnimationError::Node {
                body: name.clone(),
                node: *node,
                nodes,
            });
        }
    }
    if !frame.displacements.is_empty() {
        check_count(name, "displacements", frame.displacements.len(), nodes)?;
    }
    if !frame.stress.is_empty() {
        check_count(name, "stresses", frame.stress.len(), nodes)?;
    }
    if !frame.von_mises.is_empty() {
        check_count(name, "equivalent stresses", frame.von_mises.len(), nodes)?;
    }
    for field in frame.fields {
        check_count(name, "values of a field", field.values.len(), nodes)?;
    }
    Ok(())
}

/// The text of a `.pvd` file: all files of a series with their times.
pub fn pvd(parts: &[VtkPart]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for part in parts {
        // writing to a String cannot fail
        let _ = writeln!(
            text,
            "<DataSet timestep=\"{}\" group=\"\" part=\"{}\" file=\"{}\"/>",
            part.time,
            part.part,
            escaped(&part.file)
        );
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text
}

struct Writer<'a> {
    text: &'a mut String,
    encoding: VtkEncoding,
}

impl Writer<'_> {
    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        // writing to a String cannot fail
        let _ = self.text.write_fmt(text);
    }

    fn array(
        &mut self,
        (kind, name, components, more): (&str, &str, usize, &str),
        values: impl Iterator<Item = String>,
        bytes: impl Iterator<Item = u8>,
    ) {
        let format = match self.encoding {
            VtkEncoding::Ascii => "ascii",
            VtkEncoding::Base64 => "binary",
        };
        self.put(format_args!(
            "<DataArray type=\"{kind}\" Name=\"{}\"",
            escaped(name)
        ));
        if components != 1 {
            self.put(format_args!(" NumberOfComponents=\"{components}\""));
        }
        self.put(format_args!("{more} format=\"{format}\">\n"));
        match self.encoding {
            VtkEncoding::Ascii => {
                for (index, value) in values.enumerate() {
                    let separator = match index {
                        0 => "",
                        i if i % 12 == 0 => "\n",
                        _ => " ",
                    };
                    self.put(format_args!("{separator}{value}"));
                }
            }
            VtkEncoding::Base64 => {
                // a header with the number of bytes comes before them
                let mut all = vec![0; 8];
                all.extend(bytes);
                let count = (all.len() - 8) as u64;
                all.splice(..8, count.to_le_bytes());
                self.text.push_str(&base64(&all));
            }
        }
        self.put(format_args!("\n</DataArray>\n"));
    }

    fn floats(&mut self, name: &str, components: usize, values: &[f64], more: &str) {
        self.array(
            ("Float64", name, components, more),
            values.iter().map(|v| format!("{v:e}")),
            values.iter().flat_map(|v| v.to_le_bytes()),
        );
    }

    fn integers(&mut self, name: &str, values: &[i64]) {
        self.array(
            ("Int64", name, 1, ""),
            values.iter().map(i64::to_string),
            values.iter().flat_map(|v| v.to_le_bytes()),
        );
    }

    fn bytes(&mut self, name: &str, values: &[u8]) {
        self.array(
            ("UInt8", name, 1, ""),
            values.iter().map(u8::to_string),
            values.iter().copied(),
        );
    }
}

impl super::FlexibleBody {
    /// The visible surface of the body, as a mesh of triangles for [`vtu`].
    pub fn vtk(&self) -> VtkBody {
        VtkBody {
            name: self.name.clone(),
            nodes: self.surface.nodes.clone(),
            cells: self
                .surface
                .triangles
                .iter()
                .map(|nodes| (CellKind::Triangle3, nodes.to_vec()))
                .collect(),
        }
    }
}
