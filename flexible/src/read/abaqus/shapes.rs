//! Types of elements.

use crate::mesh::{ElementKind, VARIANT_LETTERS, Variant};

/// The shape of an element type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
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
pub(super) enum SpringKind {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_and_their_variants() {
        for (name, count) in [
            ("C3D4", 4),
            ("C3D10M", 10),
            ("C3D10MH", 10),
            ("C3D20RI", 20),
            ("C3D8IT", 8),
            ("C3D15", 15),
            ("C3D5", 5),
            ("S4R", 4),
            ("B32", 3),
            ("SPRINGA", 2),
            ("CPS6", 6),
        ] {
            assert_eq!(
                Shape::of(name).map(Shape::node_count),
                Some(count),
                "{name}"
            );
        }
        let variant = |name| match Shape::of(name) {
            Some(Shape::Solid(_, variant)) => Some(variant),
            _ => None,
        };
        assert_eq!(variant("C3D8T"), Some(Variant::Plain));
        assert_eq!(variant("C3D8RT"), variant("C3D20R"));
        assert_ne!(variant("C3D8I"), variant("C3D8R"));
        assert!(matches!(Shape::of("M3D4R"), Some(Shape::Membrane(_))));
        assert!(matches!(Shape::of("SFM3D4R"), Some(Shape::Facet(_))));
        for name in [
            "C3D27", "C3D15V", "C3D", "U1", "CONN3D2", "T3D3", "C3Dé", "", "DS",
        ] {
            assert_eq!(Shape::of(name), None, "{name}");
        }
    }
}
