//! The conditions that a mesh must satisfy before any computation. After [`check`] every index of the mesh is
//! in range, every place is finite, and every element has the section and the constants that it needs. So the
//! kernel uses indices without further tests.

use super::sheet::{Sheet, shape_fault, sheet_fault};
use crate::axes::is_rotation;
use crate::error::FlexibleError;
use crate::mesh::{
    ABSENT, BeamSection, Element, ElementKind, Material, Mesh, Section, ShellSection,
    SolidElasticity, Station, Tie, scalar_index,
};

/// Number of ids that a message names. A choice: as many fit in a message and show a pattern.
const NAMED: usize = 10;

/// The first ids, and the number of the others.
pub(crate) fn list(ids: impl IntoIterator<Item = String>) -> String {
    let mut ids = ids.into_iter();
    let named: Vec<String> = ids.by_ref().take(NAMED).collect();
    let rest = ids.count();
    if rest == 0 {
        named.join(", ")
    } else {
        format!("{} and {rest} more", named.join(", "))
    }
}

const BROKEN: &str = "read the mesh again from its file; it refers to an object that is missing";

/// The role of an element in the assembly of the matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Role<'a> {
    /// Stiffness and mass of a volume.
    Solid(&'a Material),
    /// A shell.
    Shell(Sheet<'a>),
    /// Mass per area (kg/m²), no stiffness.
    Coat(f64),
    /// A beam.
    Beam(&'a Material),
    /// Shape only.
    Facet,
}

/// The role of a checked element; `None` if its property does not fit it.
pub(super) fn role<'a>(mesh: &'a Mesh, element: &Element) -> Option<Role<'a>> {
    let property = mesh.properties.get(element.property as usize)?;
    let material = match property.material {
        Some(index) => Some(mesh.materials.get(index as usize)?),
        None => None,
    };
    match (element.kind, property.section, material) {
        (kind, Section::Solid, Some(material)) if kind.is_solid() => Some(Role::Solid(material)),
        (ElementKind::Beam2, Section::Beam(_) | Section::Tapered(_), Some(material)) => {
            Some(Role::Beam(material))
        }
        (kind, section, material) if !kind.is_solid() && kind != ElementKind::Beam2 => {
            match (section, material) {
                (Section::Shell(section), Some(material)) => {
                    Some(Role::Shell(Sheet::new(mesh, element, section, material)?))
                }
                (Section::Shell(section), None) => Some(match section.mass_per_area {
                    0.0 => Role::Facet,
                    mass => Role::Coat(mass),
                }),
                (Section::Solid, None) => Some(Role::Facet),
                _ => None,
            }
        }
        _ => None,
    }
}

/// The fault of a material, if it has one. `line` states whether lines alone use it: these may have any shear
/// modulus.
fn material_fault(material: &Material, line: bool) -> Option<String> {
    let most = if line { f64::INFINITY } else { 0.5 };
    let (young, poisson, density) = (material.young, material.poisson, material.density);
    if !(young > 0.0 && young.is_finite()) {
        Some(format!("Young's modulus {young} Pa; it must be above zero"))
    } else if !(poisson > -1.0 && poisson < most)
        && material.sheet.is_none()
        && material.solid.is_none()
    {
        Some(format!(
            "Poisson's ratio {poisson}; it must lie between -1 and 0.5, both excluded"
        ))
    } else if !(density >= 0.0 && density.is_finite()) {
        Some(format!("density {density} kg/m³; it can't be negative"))
    } else {
        let sheet = material.sheet.as_ref().and_then(sheet_fault);
        sheet.or_else(|| material.solid.as_ref().and_then(SolidElasticity::fault))
    }
}

fn shell_fault(section: &ShellSection, role: Role) -> Option<String> {
    let ShellSection {
        thickness,
        mass_per_area,
        bending,
        shear,
        layup: _,
    } = *section;
    let stiff = matches!(role, Role::Shell(..));
    let weightless = thickness == 0.0 && mass_per_area > 0.0 && !stiff;
    if !(mass_per_area >= 0.0 && mass_per_area.is_finite()) {
        Some(format!("a mass an area of {mass_per_area} kg/m²"))
    } else if !(weightless || thickness > 0.0 && thickness.is_finite()) {
        Some(format!(
            "a thickness of {thickness} m; it must be above zero"
        ))
    } else if stiff && !(bending > 0.0 && bending.is_finite()) {
        Some(format!(
            "a bending stiffness of {bending} times that of its plate; it must be above zero"
        ))
    } else if stiff && !(shear >= 0.0 && shear.is_finite()) {
        Some(format!("a shear factor of {shear}; it can't be negative"))
    } else {
        None
    }
}

fn section_fault(mesh: &Mesh, section: &Section, role: Role) -> Option<String> {
    match *section {
        Section::Solid => None,
        Section::Shell(section) => shell_fault(&section, role),
        Section::Beam(section) => beam_fault(&section),
        Section::Tapered(_) => taper_fault(&mesh.stations(section)),
    }
}

fn taper_fault(stations: &[Station]) -> Option<String> {
    let ascending = stations
        .windows(2)
        .all(|pair| pair[0].place < pair[1].place);
    let whole = [stations.first(), stations.last()].map(|end| end.map(|end| end.place));
    if !ascending || whole != [Some(0.0), Some(1.0)] {
        return Some("stations that do not ascend from 0 to 1".into());
    }
    if let Some(fault) = stations
        .iter()
        .find_map(|station| beam_fault(&station.section))
    {
        return Some(fault);
    }
    let moments: [fn(&BeamSection) -> f64; 3] =
        [|own| own.moment_z, |own| own.moment_y, |own| own.torsion];
    let vanishes = moments.iter().any(|moment| {
        let some = stations
            .iter()
            .filter(|station| moment(&station.section) > 0.0);
        !matches!(some.count(), count if count == 0 || count == stations.len())
    });
    vanishes
        .then(|| "a second moment or torsion constant that vanishes at one of its stations".into())
}

fn beam_fault(section: &BeamSection) -> Option<String> {
    let BeamSection {
        area,
        moment_z,
        moment_y,
        product,
        torsion,
        shear,
        mass_per_length,
    } = *section;
    let numbers = [
        ("a second moment of area", moment_z, " m⁴"),
        ("a second moment of area", moment_y, " m⁴"),
        ("a torsion constant", torsion, " m⁴"),
        ("a shear factor", shear[0], ""),
        ("a shear factor", shear[1], ""),
        ("a mass per length", mass_per_length, " kg/m"),
    ];
    let bad = numbers
        .iter()
        .find(|(_, x, _)| !(*x >= 0.0 && x.is_finite()));
    if !(area > 0.0 && area.is_finite()) {
        Some(format!("an area of {area} m²; it must be above zero"))
    } else if let Some((quantity, value, unit)) = bad {
        Some(format!(
            "{quantity} of {value}{unit}; it must be a number and not negative"
        ))
    } else if !product.is_finite() {
        Some(format!("a product of area of {product} m⁴"))
    } else if product != 0.0 && product * product >= moment_y * moment_z {
        Some(format!(
            "a product of area of {product} m⁴, whose square must be below the product of its second moments {moment_z} and {moment_y} m⁴"
        ))
    } else {
        None
    }
}

/// Checks a mesh.
///
/// # Errors
/// The first kind of fault, with the ids of its nodes or elements: coordinates that are not numbers; an index
/// out of range; a missing corner; a section or constant that does not suit the element.
pub(super) fn check(mesh: &Mesh) -> Result<(), FlexibleError> {
    check_nodes(mesh)?;
    check_elements(mesh)?;
    check_attachments(mesh)
}

/// Checks places and analysis frames of nodes.
///
/// # Errors
/// As [`check`].
pub(super) fn check_nodes(mesh: &Mesh) -> Result<(), FlexibleError> {
    let bad: Vec<u64> = mesh
        .nodes
        .iter()
        .filter(|node| !node.position.iter().all(|x| x.is_finite()))
        .map(|node| node.id)
        .collect();
    if !bad.is_empty() {
        return Err(FlexibleError::structure(
            format!(
                "coordinates that are not numbers at {} nodes: {}",
                bad.len(),
                list(bad.iter().map(u64::to_string))
            ),
            "check the mesh file",
        ));
    }
    for node in &mesh.nodes {
        let Some(index) = node.frame else { continue };
        let known = mesh.frames.get(index as usize);
        if !known.is_some_and(|frame| is_rotation(&frame.rotation)) {
            return Err(FlexibleError::structure(
                format!("the analysis frame of node {} is not a rotation", node.id),
                BROKEN,
            ));
        }
    }
    Ok(())
}

fn check_elements(mesh: &Mesh) -> Result<(), FlexibleError> {
    let mut seen = vec![false; mesh.materials.len()];
    for element in &mesh.elements {
        check_element(mesh, element)?;
        let property = &mesh.properties[element.property as usize];
        let Some(role) = role(mesh, element) else {
            if element.kind.is_solid()
                && property.section == Section::Solid
                && property.material.is_none()
            {
                return Err(without_material(mesh, element, &property.name));
            }
            let advice = "give solids a solid property, beams a beam section, shells a shell section, each with a material";
            return Err(FlexibleError::structure(
                format!(
                    "element {} ({:?}) has the property “{}”, which does not fit it or names no material",
                    element.id, element.kind, property.name
                ),
                advice,
            ));
        };
        if role == Role::Facet {
            continue;
        }
        if let Role::Shell(sheet) = &role
            && let Some(fault) = shape_fault(mesh, element, sheet)
        {
            return Err(FlexibleError::structure(
                format!("element {} has {fault}", element.id),
                "check the element's offset, thicknesses and material direction",
            ));
        }
        if let Some(fault) = section_fault(mesh, &property.section, role) {
            return Err(FlexibleError::structure(
                format!(
                    "element {}: the property “{}” has {fault}",
                    element.id, property.name
                ),
                "check the section and the units",
            ));
        }
        let of_sheets = matches!(role, Role::Shell(_) | Role::Coat(_));
        for index in property.materials(&mesh.laminates) {
            let (Some(seen), Some(material)) = (
                seen.get_mut(index as usize),
                mesh.materials.get(index as usize),
            ) else {
                continue;
            };
            if !of_sheets && material.sheet.is_some() {
                return Err(FlexibleError::structure(
                    format!(
                        "element {} is no shell, but its material “{}” is only for sheets",
                        element.id, material.name
                    ),
                    "give it an isotropic material",
                ));
            }
            if !matches!(role, Role::Solid(_)) && material.solid.is_some() {
                return Err(FlexibleError::structure(
                    format!(
                        "element {} is no solid, but its material “{}” is only for solids",
                        element.id, material.name
                    ),
                    "give it an isotropic material, or for a shell one of sheets",
                ));
            }
            if *seen {
                continue;
            }
            let line = matches!(role, Role::Beam(_));
            if let Some(fault) = material_fault(material, line) {
                return Err(FlexibleError::structure(
                    format!(
                        "element {}: the material “{}” has {fault}",
                        element.id, material.name
                    ),
                    "check the material and the units",
                ));
            }
            *seen = !line;
        }
    }
    Ok(())
}

/// The error for a solid whose property names no material.
fn without_material(mesh: &Mesh, element: &Element, property: &str) -> FlexibleError {
    let property = match property {
        "" => String::new(),
        name => format!(" of the property “{name}”"),
    };
    if mesh.materials.is_empty() {
        return FlexibleError::structure(
            format!(
                "the mesh has no material: element {}{property} needs one",
                element.id
            ),
            "state it in the body: `material = Steel`, with `use std.materials.Steel`, or a `Solid` of your own",
        );
    }
    FlexibleError::structure(
        format!("element {}{property} has no material", element.id),
        "state its material in the file; `material =` of the body is only for a mesh without materials",
    )
}

/// The fault of a 6 × 6 mass matrix of a node (kg, kg m, kg m²; translations first), if it has one.
fn mass_fault(matrix: &[[f64; 6]; 6]) -> Option<String> {
    let largest = (0..6).map(|i| matrix[i][i].abs()).fold(0.0, f64::max);
    if let Some(i) = (0..6).find(|i| !matrix[*i][*i].is_finite() || matrix[*i][*i] < 0.0) {
        let unit = if i < 3 { "kg" } else { "kg m²" };
        return Some(format!(
            "its mass in freedom {} is {} {unit}; it must be a number and not negative",
            i + 1,
            matrix[i][i]
        ));
    }
    let pairs = (0..6).flat_map(|i| (0..i).map(move |j| (i, j)));
    // rounding of the numbers of a card
    let differs = |(i, j): &(usize, usize)| {
        let difference = (matrix[*i][*j] - matrix[*j][*i]).abs();
        difference.is_nan() || difference > 1e-9 * largest
    };
    pairs.clone().find(differs).map(|(i, j)| {
        format!(
            "the entries ({}, {}) and ({}, {}) of its mass matrix are {} and {}; they must be equal numbers",
            i + 1,
            j + 1,
            j + 1,
            i + 1,
            matrix[i][j],
            matrix[j][i]
        )
    })
}

pub(crate) fn check_element(mesh: &Mesh, element: &Element) -> Result<(), FlexibleError> {
    let first = element.first as usize;
    let count = element.kind.node_count();
    let Some(nodes) = mesh.connectivity.get(first..first + count) else {
        return Err(FlexibleError::structure(
            format!("element {} lacks some of its {count} nodes", element.id),
            BROKEN,
        ));
    };
    for (local, &node) in nodes.iter().enumerate() {
        let absent = node == ABSENT && local >= element.kind.corner_count();
        if !absent && node as usize >= mesh.nodes.len() {
            return Err(FlexibleError::structure(
                format!("node {} of element {} is missing", local + 1, element.id),
                "add the node; only mid-side nodes can be left out",
            ));
        }
    }
    if element.property as usize >= mesh.properties.len() {
        return Err(FlexibleError::structure(
            format!("element {} has no property", element.id),
            "give every element a section and a material",
        ));
    }
    if element.kind == ElementKind::Beam2 {
        let axes = element
            .beam
            .and_then(|index| mesh.beam_axes.get(index as usize));
        let finite = axes.is_some_and(|axes| {
            let offsets = axes.offsets.iter().flatten();
            axes.orientation
                .iter()
                .chain(offsets)
                .all(|x| x.is_finite())
        });
        if !finite {
            return Err(FlexibleError::structure(
                format!("beam {} has no orientation", element.id),
                "give the direction of the section's first axis",
            ));
        }
    }
    Ok(())
}

/// Number of freedoms that a node or scalar point can have.
fn freedoms_of(node: u32) -> u8 {
    scalar_index(node).map_or(6, |_| 1)
}

/// Checks point masses, springs, ties and supports.
///
/// # Errors
/// As [`check`].
pub(super) fn check_attachments(mesh: &Mesh) -> Result<(), FlexibleError> {
    let known = |node: u32| match scalar_index(node) {
        Some(index) => index < mesh.scalar_points.len(),
        None => (node as usize) < mesh.nodes.len(),
    };
    let missing = |what: &str, id: u64| {
        FlexibleError::structure(
            format!("{what} {id} refers to a node or freedom that is not there"),
            BROKEN,
        )
    };
    for point in &mesh.point_masses {
        if !known(point.node) {
            return Err(missing("point mass", point.id));
        }
        if let Some(fault) = mass_fault(&point.matrix) {
            return Err(FlexibleError::structure(
                format!("point mass {}: {fault}", point.id),
                "check the mass card",
            ));
        }
    }
    let springs = mesh
        .springs
        .iter()
        .map(|spring| (spring, ["spring", "stiffness"]));
    let masses = mesh
        .inerters
        .iter()
        .map(|mass| (mass, ["scalar mass", "mass"]));
    for (spring, [name, quantity]) in springs.chain(masses) {
        let sound = |&(node, freedom, factor): &(u32, u8, f64)| {
            known(node) && freedom < freedoms_of(node) && factor.is_finite()
        };
        if !spring.terms.iter().all(sound) {
            return Err(missing(name, spring.id));
        }
        if !(spring.stiffness >= 0.0 && spring.stiffness.is_finite()) {
            return Err(FlexibleError::structure(
                format!(
                    "{name} {} has a {quantity} of {} in SI units; it must be a number and not negative",
                    spring.id, spring.stiffness
                ),
                "check its card",
            ));
        }
    }
    for tie in &mesh.ties {
        let mut good = match tie {
            Tie::Rigid { .. } => true,
            Tie::Averaging { independent, .. } => {
                (independent.iter()).all(|(_, weight, _)| weight.is_finite())
            }
            Tie::Equation { terms, .. } => (terms.iter())
                .all(|(node, freedom, x)| *freedom < freedoms_of(*node) && x.is_finite()),
        };
        tie.each(|node, _| good &= known(node));
        if !good {
            return Err(missing("tie", tie.id()));
        }
    }
    if !mesh
        .supports
        .iter()
        .chain(&mesh.interface)
        .all(|support| known(support.node))
    {
        return Err(FlexibleError::structure(
            "a support refers to a node that is not there".into(),
            BROKEN,
        ));
    }
    Ok(())
}
