//! The table of finite elements.
//!
//! All other modules of the crate take the properties of an element from it.
//!
//! A row is a `Description`: nodes, edges, faces, shape functions, integration rules, and the element's
//! name and order of nodes in each code. The row is beside the shape functions in the file of its family, and
//! `ElementKind::description` finds it. Readers use its names, the kernel its points, recovery and pictures
//! its faces. So a new element is a file with its row and a line of the list here.
//! [`crate::fe::form`] decides which rules belong to an element of a certain code.
//!
//! Nodes are in the order of VTK and Abaqus: corners, then mid-side nodes in the order of the edges.

mod faces;
mod hexahedron;
mod line;
mod pyramid;
pub mod quadrature;
mod shape;
mod simplex;
mod wedge;

pub use faces::ABSENT;
pub(crate) use faces::{around, facets};
pub use shape::{MOST_NODES, Shape};

use quadrature::Point;
use serde::{Deserialize, Serialize};

/// 2/√3: times the sine of a corner of a triangle of equal sides it is 1.
pub(crate) const TRIANGLE: f64 = 1.154_700_538_379_251_5;

/// Defines the elements of the table: each has a variant and its row.
macro_rules! elements {
    ($($(#[$about:meta])* $kind:ident: $row:path;)*) => {
        /// Shape and order of nodes of an element. Files of reduced bodies hold the position in this list.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum ElementKind {
            $($(#[$about])* $kind,)*
        }

        impl ElementKind {
            /// All of them.
            pub const ALL: [ElementKind; [$(stringify!($kind)),*].len()] = [$(ElementKind::$kind),*];

            /// Its row.
            pub(crate) const fn description(self) -> &'static Description {
                match self {
                    $(ElementKind::$kind => &$row,)*
                }
            }
        }
    };
}

elements! {
    /// 4-node tetrahedron.
    Tetrahedron4: simplex::TETRAHEDRON4;
    /// 10-node tetrahedron: mid-side nodes 12 23 31 14 24 34.
    Tetrahedron10: simplex::TETRAHEDRON10;
    /// 8-node hexahedron.
    Hexahedron8: hexahedron::HEXAHEDRON8;
    /// 20-node hexahedron: mid-side nodes bottom, top, vertical.
    Hexahedron20: hexahedron::HEXAHEDRON20;
    /// 6-node wedge.
    Wedge6: wedge::WEDGE6;
    /// 15-node wedge: mid-side nodes bottom, top, vertical.
    Wedge15: wedge::WEDGE15;
    /// 5-node pyramid.
    Pyramid5: pyramid::PYRAMID5;
    /// 13-node pyramid: base edges, then edges to the apex.
    Pyramid13: pyramid::PYRAMID13;
    /// 3-node shell or facet.
    Triangle3: simplex::TRIANGLE3;
    /// 6-node shell or facet.
    Triangle6: simplex::TRIANGLE6;
    /// 4-node shell or facet.
    Quadrilateral4: hexahedron::QUADRILATERAL4;
    /// 8-node shell or facet.
    Quadrilateral8: hexahedron::QUADRILATERAL8;
    /// 2-node beam.
    Beam2: line::BEAM2;
}

impl ElementKind {
    /// The element of a face with so many corners, with or without mid-side nodes.
    pub(crate) const fn of_face(corners: usize, curved: bool) -> Option<ElementKind> {
        match (corners, curved) {
            (3, false) => Some(ElementKind::Triangle3),
            (3, true) => Some(ElementKind::Triangle6),
            (4, false) => Some(ElementKind::Quadrilateral4),
            (4, true) => Some(ElementKind::Quadrilateral8),
            _ => None,
        }
    }
}

/// A row of the table.
#[derive(Clone, Copy)]
pub(crate) struct Description {
    /// Number of nodes.
    nodes: usize,
    /// Number of corner nodes; they come first.
    corners: usize,
    /// Dimension of its shape: 3 for a volume.
    dimension: u8,
    /// The element with the same corners and no mid-side nodes.
    linear: ElementKind,
    /// The corners of each edge, in the order of the mid-side nodes.
    pub(crate) edges: &'static [[usize; 2]],
    /// The corners of each face, in the order S1, S2, … of Abaqus. The corners of a solid's face are in
    /// the order that an observer inside sees. A shell is one face.
    pub(crate) faces: &'static [&'static [usize]],
    /// Tetrahedra, triangles or a line that fill the element between its corners.
    pub(crate) simplices: &'static [&'static [usize]],
    /// For each corner of a solid at which three edges meet, the other ends of these edges, right-handed. The number
    /// multiplies the triple product of the edges' directions to 1 for corners of a regular element.
    pub(crate) corner_edges: (&'static [[usize; 3]], f64),
    /// The middle of the reference domain.
    pub(crate) centre: [f64; 3],
    /// Writes its functions at a point of the reference domain into a zeroed shape.
    shape: fn(&mut Shape, [f64; 3]),
    /// Points that give a solid's stiffness its full rank; none for other elements.
    pub(crate) stiffness: fn() -> Vec<Point>,
    /// The points of its reduced variant; without such a variant, those of the full one.
    pub(crate) reduced: fn() -> Vec<Point>,
    /// Points that integrate N_a N_b det J exactly for any positions of the nodes. The area element of a
    /// surface is a root, so these points are exact for flat surfaces with straight edges; a quadrilateral
    /// may have any corners.
    pub(crate) mass: fn() -> Vec<Point>,
    /// Points at which Abaqus integrates its mass.
    pub(crate) mass_of_abaqus: fn() -> Vec<Point>,
    /// Its names in files.
    pub(crate) names: Names,
}

/// Names of an element in files, and the orders of its nodes that differ from ours.
#[derive(Clone, Copy)]
pub(crate) struct Names {
    /// Cards of Nastran, the usual one first. Quadratic elements without mid-side nodes are linear ones.
    pub(crate) nastran: &'static [&'static str],
    /// Position of each node on the card.
    pub(crate) nastran_order: Option<&'static [usize]>,
    /// Type in Abaqus and CalculiX: the whole name of a shell, and the name of a solid without the letters
    /// of its variant.
    pub(crate) abaqus: &'static [&'static str],
    /// The end of a type's name after the family's name, for surfaces without stiffness and plane elements:
    /// `3` of `SFM3D3`.
    pub(crate) abaqus_facets: &'static [&'static str],
    /// Number of the type in gmsh.
    pub(crate) gmsh: Option<i32>,
    /// Position of each node in a file of gmsh.
    pub(crate) gmsh_order: Option<&'static [usize]>,
    /// Descriptor of the solid in universal files of I-deas.
    pub(crate) universal: Option<u32>,
    /// Position of each node in a universal file.
    pub(crate) universal_order: Option<&'static [usize]>,
    /// Name in MED files. Its corners run around a solid's first face as an observer outside sees them.
    pub(crate) med: Option<&'static str>,
    /// Position of each node in a MED file.
    pub(crate) med_order: Option<&'static [usize]>,
}

impl Names {
    /// No name anywhere.
    const NONE: Names = Names {
        nastran: &[],
        nastran_order: None,
        abaqus: &[],
        abaqus_facets: &[],
        gmsh: None,
        gmsh_order: None,
        universal: None,
        universal_order: None,
        med: None,
        med_order: None,
    };
}

impl ElementKind {
    /// Number of nodes.
    pub const fn node_count(self) -> usize {
        self.description().nodes
    }

    /// Number of corner nodes; they come first.
    pub const fn corner_count(self) -> usize {
        self.description().corners
    }

    /// Dimension of its shape: 1 for a beam, 2 for a shell or facet, 3 for a solid.
    pub const fn dimension(self) -> u8 {
        self.description().dimension
    }

    /// Whether the element has a volume.
    pub const fn is_solid(self) -> bool {
        self.dimension() == 3
    }

    /// The element with the same corners and no mid-side nodes.
    pub const fn linear(self) -> ElementKind {
        self.description().linear
    }

    /// The corners of each mid-side node, in their order; none for a linear element.
    pub const fn midside_edges(self) -> &'static [[usize; 2]] {
        if self.node_count() == self.corner_count() {
            &[]
        } else {
            self.description().edges
        }
    }

    /// The kinds of a card of Nastran, without and with mid-side nodes. A card without mid-side nodes gives
    /// one kind twice.
    pub(crate) fn of_nastran(card: &str) -> Option<(ElementKind, ElementKind)> {
        let named = |kind: &ElementKind| kind.description().names.nastran.contains(&card);
        let kind = Self::ALL
            .into_iter()
            .filter(named)
            .max_by_key(|kind| kind.node_count())?;
        Some((kind.linear(), kind))
    }

    /// The kind of a type of Abaqus and CalculiX, given in capitals and without the letters of a solid's
    /// variant.
    pub(crate) fn of_abaqus(name: &str) -> Option<ElementKind> {
        let named = |kind: &ElementKind| kind.description().names.abaqus.contains(&name);
        Self::ALL.into_iter().find(named)
    }

    /// The facet whose type in Abaqus and CalculiX has this end.
    pub(crate) fn of_abaqus_facet(end: &str) -> Option<ElementKind> {
        let named = |kind: &ElementKind| kind.description().names.abaqus_facets.contains(&end);
        Self::ALL.into_iter().find(named)
    }

    /// The kind of a type of gmsh.
    pub(crate) fn of_gmsh(number: i32) -> Option<ElementKind> {
        let named = |kind: &ElementKind| kind.description().names.gmsh == Some(number);
        Self::ALL.into_iter().find(named)
    }

    /// The kind of a name in MED files.
    pub(crate) fn of_med(name: &str) -> Option<ElementKind> {
        let named = |kind: &ElementKind| kind.description().names.med == Some(name);
        Self::ALL.into_iter().find(named)
    }

    /// The solid of a descriptor of universal files.
    pub(crate) fn of_universal(descriptor: u32) -> Option<ElementKind> {
        let named = |kind: &ElementKind| kind.description().names.universal == Some(descriptor);
        Self::ALL.into_iter().find(named)
    }
}

/// No points, for an element whose stiffness or mass is not integrated in this way.
fn no_points() -> Vec<Point> {
    Vec::new()
}
