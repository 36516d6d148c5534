//! Descriptors of elements (field 2 of dataset 2412).

use crate::mesh::{Carries, ElementKind};

/// The use of elements of a descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    /// A solid.
    Solid(ElementKind),
    /// A line or a surface: a beam or shell, or the edge or face of a solid.
    Thin,
    /// A rigid bar or element.
    Rigid,
    /// Not read.
    Other(Carries),
}

use Class::{Other, Rigid, Thin};

const STRUCTURE: Class = Other(Carries::Structure);

/// Descriptors with their names, numbers of nodes (zero: any number) and classes. Solids are in the table of
/// elements.
const KNOWN: &[(u32, &str, usize, Class)] = &[
    (11, "rod", 2, Thin),
    (21, "linear beam", 2, Thin),
    (22, "tapered beam", 0, Thin),
    (23, "curved beam", 0, Thin),
    (24, "parabolic beam", 3, Thin),
    (41, "plane stress, linear triangle", 3, Thin),
    (42, "plane stress, parabolic triangle", 6, Thin),
    (44, "plane stress, linear quadrilateral", 4, Thin),
    (45, "plane stress, parabolic quadrilateral", 8, Thin),
    (51, "plane strain, linear triangle", 3, Thin),
    (52, "plane strain, parabolic triangle", 6, Thin),
    (54, "plane strain, linear quadrilateral", 4, Thin),
    (55, "plane strain, parabolic quadrilateral", 8, Thin),
    (61, "plate, linear triangle", 3, Thin),
    (62, "plate, parabolic triangle", 6, Thin),
    (64, "plate, linear quadrilateral", 4, Thin),
    (65, "plate, parabolic quadrilateral", 8, Thin),
    (71, "membrane, linear quadrilateral", 4, Thin),
    (72, "membrane, parabolic triangle", 6, Thin),
    (74, "membrane, linear triangle", 3, Thin),
    (75, "membrane, parabolic quadrilateral", 8, Thin),
    (91, "thin shell, linear triangle", 3, Thin),
    (92, "thin shell, parabolic triangle", 6, Thin),
    (94, "thin shell, linear quadrilateral", 4, Thin),
    (95, "thin shell, parabolic quadrilateral", 8, Thin),
    (101, "thick shell, linear wedge", 6, STRUCTURE),
    (102, "thick shell, parabolic wedge", 15, STRUCTURE),
    (104, "thick shell, linear brick", 8, STRUCTURE),
    (105, "thick shell, parabolic brick", 20, STRUCTURE),
    (114, "solid, cubic wedge", 0, STRUCTURE),
    (117, "solid, cubic brick", 0, STRUCTURE),
    (121, "rigid bar", 2, Rigid),
    (122, "rigid element", 0, Rigid),
    (136, "spring between nodes", 2, STRUCTURE),
    (137, "rotational spring between nodes", 2, STRUCTURE),
    (138, "spring to the ground", 0, STRUCTURE),
    (139, "rotational spring to the ground", 0, STRUCTURE),
    (141, "damper between nodes", 2, Other(Carries::Nothing)),
    (142, "damper to the ground", 0, Other(Carries::Nothing)),
    (151, "gap between nodes", 2, STRUCTURE),
    (152, "gap to the ground", 0, STRUCTURE),
    (161, "lumped mass", 1, STRUCTURE),
    (181, "constraint", 0, STRUCTURE),
];

fn known(descriptor: u32) -> Option<&'static (u32, &'static str, usize, Class)> {
    KNOWN.iter().find(|(known, ..)| *known == descriptor)
}

/// The class of a descriptor.
pub(super) fn class(descriptor: u32) -> Class {
    match ElementKind::of_universal(descriptor) {
        Some(kind) => Class::Solid(kind),
        None => known(descriptor).map_or(Other(Carries::Unknown), |(.., class)| *class),
    }
}

/// The name of a descriptor, for messages and for `ignore`.
pub(super) fn name(descriptor: u32) -> String {
    match known(descriptor) {
        Some((_, name, ..)) => format!("element {descriptor} ({name})"),
        None => format!("element {descriptor}"),
    }
}

/// The number of nodes of a descriptor, if it is always the same.
pub(super) fn node_count(descriptor: u32) -> Option<usize> {
    let solid = ElementKind::of_universal(descriptor).map(ElementKind::node_count);
    let other = || known(descriptor).map(|(_, _, count, _)| *count);
    solid.or_else(other).filter(|count| *count > 0)
}

/// Whether its elements have a line with the orientation and the sections before their nodes.
pub(super) fn is_beam(descriptor: u32) -> bool {
    matches!(descriptor, 11 | 21..=24)
}
