//! Elements of ANSYS by their numbers, and the shapes that repeated nodes make of them.

use crate::mesh::{ABSENT, ElementKind, Variant};

/// A kind of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// Solids of 8 nodes: SOLID185.
    Solid8,
    /// Solids of 20 nodes: SOLID186.
    Solid20,
    /// SOLID187.
    Tetrahedron10,
    /// SOLID285.
    MixedTetrahedron4,
    /// SHELL181.
    Shell4,
    /// SHELL281.
    Shell8,
    /// MASS21.
    Mass,
    /// COMBIN14.
    Spring,
    /// Without stiffness and mass: MESH200.
    Facet,
}

/// The elements that Eng reads.
const READ: &[(u32, Family)] = &[
    (185, Family::Solid8),
    (186, Family::Solid20),
    (187, Family::Tetrahedron10),
    (285, Family::MixedTetrahedron4),
    (181, Family::Shell4),
    (281, Family::Shell8),
    (21, Family::Mass),
    (14, Family::Spring),
    (200, Family::Facet),
];

/// Names of elements, for messages.
const NAMES: &[(&str, &[u32])] = &[
    (
        "SOLID",
        &[
            45, 46, 62, 65, 70, 72, 73, 92, 95, 164, 168, 185, 186, 187, 226, 227, 285,
        ],
    ),
    ("SOLSH", &[190]),
    (
        "SHELL",
        &[
            28, 41, 43, 63, 91, 93, 99, 131, 132, 157, 163, 181, 208, 209, 281,
        ],
    ),
    ("BEAM", &[3, 4, 23, 24, 44, 54, 161, 188, 189]),
    ("PIPE", &[16, 18, 20, 59, 60, 288, 289]),
    ("ELBOW", &[290]),
    ("LINK", &[1, 8, 10, 11, 68, 160, 167, 180]),
    ("PLANE", &[25, 42, 82, 83, 182, 183, 223]),
    ("COMBIN", &[7, 14, 37, 39, 40]),
    ("COMBI", &[165, 214, 250]),
    ("MATRIX", &[27, 50]),
    ("MPC", &[184]),
    ("TARGE", &[169, 170]),
    ("CONTA", &[171, 172, 173, 174, 175, 176, 177, 178]),
    ("PRETS", &[179]),
    ("SURF", &[151, 152, 153, 154, 155, 156, 159]),
    ("FOLLW", &[201]),
    ("MASS", &[21, 71, 166]),
    ("MESH", &[200]),
    ("REINF", &[263, 264, 265]),
    ("INTER", &[192, 193, 194, 195, 202, 203, 204, 205]),
    ("FLUID", &[29, 30, 38, 79, 80, 116, 220, 221]),
];

impl Family {
    /// The family of an element.
    pub fn of(number: u32) -> Option<Family> {
        let found = READ.iter().find(|(known, _)| *known == number);
        found.map(|(_, family)| *family)
    }
}

/// The name of an element.
pub(super) fn name(number: u32) -> String {
    let known = NAMES.iter().find(|(_, numbers)| numbers.contains(&number));
    format!("{}{number}", known.map_or("element ", |(name, _)| *name))
}

/// The variant of an element, by the options of its type.
pub(super) fn variant(number: u32, technology: i64) -> Variant {
    Variant::Technology {
        element: u16::try_from(number).unwrap_or(0),
        option: u8::try_from(technology).unwrap_or(u8::MAX),
    }
}

/// Shapes of a solid of 20 nodes by repeated corners K = L, M = N, O = P and M = O: the kind, and the places
/// of its nodes in the file. The first nodes are those of the solid of 8 nodes (ANSYS Element Reference,
/// SOLID185, SOLID186).
fn solid_places(corners: &[u64]) -> Option<(ElementKind, &'static [usize])> {
    let &[_, _, k, l, m, n, o, p] = corners else {
        return None;
    };
    let repeated = [k == l, m == n, o == p, n == o];
    let (kind, places): (_, &[usize]) = match repeated {
        [false, false, false, false] => (
            ElementKind::Hexahedron20,
            &[
                0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19,
            ],
        ),
        [true, false, true, false] => (
            ElementKind::Wedge15,
            &[0, 1, 2, 4, 5, 6, 8, 9, 11, 12, 13, 15, 16, 17, 18],
        ),
        [false, true, true, true] => (
            ElementKind::Pyramid13,
            &[0, 1, 2, 3, 4, 8, 9, 10, 11, 16, 17, 18, 19],
        ),
        [true, true, true, true] => (
            ElementKind::Tetrahedron10,
            &[0, 1, 2, 4, 8, 9, 11, 16, 17, 18],
        ),
        _ => return None,
    };
    Some((kind, places))
}

/// The kind and the nodes of an element from those of the file; zero stands for an absent mid-side node.
/// `None` for nodes that make no shape of the family.
pub(super) fn shape(family: Family, nodes: &[u64]) -> Option<(ElementKind, Vec<u64>)> {
    let take = |kind: ElementKind, places: &[usize]| {
        let wanted = places.get(..kind.node_count())?;
        // mid-side nodes at the end of the list may be left out
        let found = wanted
            .iter()
            .map(|place| nodes.get(*place).copied().unwrap_or(0));
        let found: Vec<u64> = found.collect();
        let corners = found.get(..kind.corner_count())?;
        let others = |at: usize| corners.iter().skip(at + 1);
        let mut sound = (corners.iter().enumerate())
            .map(|(at, node)| *node > 0 && others(at).all(|other| other != node));
        sound.all(|sound| sound).then_some((kind, found))
    };
    match family {
        Family::Solid8 => {
            let (kind, places) = solid_places(nodes.get(..8)?)?;
            take(kind.linear(), places)
        }
        Family::Solid20 => {
            let (kind, places) = solid_places(nodes.get(..8)?)?;
            take(kind, places)
        }
        Family::Tetrahedron10 => take(ElementKind::Tetrahedron10, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]),
        Family::MixedTetrahedron4 => take(ElementKind::Tetrahedron4, &[0, 1, 2, 3]),
        Family::Shell4 | Family::Shell8 => {
            let triangle = nodes.len() == 3 || nodes.get(2)? == nodes.get(3)?;
            match (family, triangle) {
                (Family::Shell4, true) => take(ElementKind::Triangle3, &[0, 1, 2]),
                (Family::Shell4, false) => take(ElementKind::Quadrilateral4, &[0, 1, 2, 3]),
                (_, true) => take(ElementKind::Triangle6, &[0, 1, 2, 4, 5, 7]),
                (_, false) => take(ElementKind::Quadrilateral8, &[0, 1, 2, 3, 4, 5, 6, 7]),
            }
        }
        Family::Mass | Family::Spring | Family::Facet => None,
    }
}

/// The place of an absent node.
pub(super) const NO_NODE: u32 = ABSENT;
