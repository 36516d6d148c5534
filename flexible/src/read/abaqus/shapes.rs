//! Types of elements.

use crate::mesh::{ElementKind, VARIANT_LETTERS, Variant};

/// The shape of an element type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A solid.
    Solid(ElementKind, Variant),
    /// A shell.
    Shell(ElementKind),
    /// A membrane.
    Membrane(ElementKind),
    /// A surface without stiffness, or a plane element, which has none here.
    Facet(ElementKind),
    /// `B31`, `B32` (two beams), `B33`: number of nodes, and whether it bends under shear.
    Beam {
        /// Two, or three with the second in the middle.
        nodes: usize,
        /// Timoshenko's beam.
        shear: bool,
    },
    /// `T3D2`.
    Truss,
    /// `MASS`.
    Mass,
    /// `ROTARYI`.
    Rotary,
    /// `DCOUP3D`: the reference node of a `*DISTRIBUTING COUPLING`.
    Distributing,
    /// `SPRING1`, `SPRING2`, `SPRINGA`.
    Spring(SpringKind),
}

/// Kind of a spring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringKind {
    /// From a freedom to the ground.
    Ground,
    /// Between two freedoms.
    Freedoms,
    /// Along the line between two nodes.
    Axial,
}

impl Shape {
    /// The shape of a type (capitals).
    pub fn of(name: &str) -> Option<Shape> {
        let fixed = match name {
            "MASS" => Some(Shape::Mass),
            "ROTARYI" => Some(Shape::Rotary),
            "DCOUP3D" => Some(Shape::Distributing),
            "SPRING1" => Some(Shape::Spring(SpringKind::Ground)),
            "SPRING2" => Some(Shape::Spring(SpringKind::Freedoms)),
            "SPRINGA" => Some(Shape::Spring(SpringKind::Axial)),
            "T3D2" | "T3D2H" => Some(Shape::Truss),
            "B31" | "B31H" | "B31R" => Some(Shape::Beam {
                nodes: 2,
                shear: true,
            }),
            "B32" | "B32H" | "B32R" => Some(Shape::Beam {
                nodes: 3,
                shear: true,
            }),
            "B33" | "B33H" => Some(Shape::Beam {
                nodes: 2,
                shear: false,
            }),
            _ => ElementKind::of_abaqus(name)
                .filter(|kind| !kind.is_solid())
                .map(Shape::Shell),
        };
        if fixed.is_some() {
            return fixed;
        }
        if let Some(rest) = name.strip_prefix("C3D") {
            let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let (plain, variant) = name.split_at_checked("C3D".len() + digits)?;
            let mut letters = 0;
            for letter in variant.chars() {
                // with temperatures: the same mechanics
                if letter != 'T' {
                    letters |= 1 << VARIANT_LETTERS.find(letter)?;
                }
            }
            let kind = ElementKind::of_abaqus(plain)?;
            let variant = match letters {
                0 => Variant::Plain,
                letters => Variant::Letters(letters),
            };
            return Some(Shape::Solid(kind, variant));
        }
        if let Some(rest) = name.strip_prefix("M3D") {
            return ElementKind::of_abaqus_facet(rest).map(Shape::Membrane);
        }
        let plane = ["SFM3D", "R3D", "CPS", "CPE", "CAX", "DS"];
        let rest = plane.iter().find_map(|start| name.strip_prefix(start))?;
        ElementKind::of_abaqus_facet(rest).map(Shape::Facet)
    }

    /// Number of nodes in the file.
    pub fn node_count(self) -> usize {
        match self {
            Shape::Solid(kind, _)
            | Shape::Shell(kind)
            | Shape::Membrane(kind)
            | Shape::Facet(kind) => kind.node_count(),
            Shape::Beam { nodes, .. } => nodes,
            Shape::Truss | Shape::Spring(SpringKind::Freedoms | SpringKind::Axial) => 2,
            Shape::Mass
            | Shape::Rotary
            | Shape::Distributing
            | Shape::Spring(SpringKind::Ground) => 1,
        }
    }
}
