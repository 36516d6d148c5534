//! The conditions that a mesh must satisfy before any computation. After [`check`] every index of the mesh is
//! in range, every place is finite, and every element has the section and the constants that it needs. So the
//! kernel uses indices without further tests.

use super::vector::{cross, determinant, norm, subtract};
use crate::error::FlexibleError;
use crate::mesh::{
    ABSENT, BeamSection, Element, ElementKind, Layer, Layup, Material, Mesh, Section,
    SheetElasticity, ShellAxis, ShellSection, ShellShape, Tie,
};

/// Number of ids that a message names.
const NAMED: usize = 10;

/// The first ids, and the number of the others.
pub(super) fn list(ids: impl IntoIterator<Item = String>) -> String {
    let mut ids = ids.into_iter();
    let named: Vec<String> = ids.by_ref().take(NAMED).collect();
    let rest = ids.count();
    if rest == 0 {
        named.join(", ")
    } else {
        format!("{} and {rest} more", named.join(", "))
    }
}

pub(super) fn wrong(problem: String, advice: &str) -> FlexibleError {
    FlexibleError::Structure {
        problem,
        advice: advice.into(),
    }
}

const BROKEN: &str = "the mesh refers to something it does not hold; read it again from its file";

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

/// Section, materials and position of a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sheet<'a> {
    pub section: ShellSection,
    /// The material that stretches.
    pub material: &'a Material,
    /// With [`Layup::Apart`] the material that bends.
    pub bending: Option<&'a Material>,
    /// With [`Layup::Apart`] the material that resists shear across the plate.
    pub shear: Option<&'a Material>,
    /// With [`Layup::Layers`] the layers from the lower surface to the upper.
    pub layers: &'a [Layer],
    /// The materials of the mesh.
    pub materials: &'a [Material],
    pub shape: Option<&'a ShellShape>,
}

impl<'a> Sheet<'a> {
    /// Whether the section has axes: an isotropic one has none.
    pub fn is_directed(&self) -> bool {
        let layers = self.layers.iter();
        let of_layers = layers.filter_map(|layer| self.materials.get(layer.material as usize));
        let mut materials = [Some(self.material), self.bending, self.shear]
            .into_iter()
            .flatten()
            .chain(of_layers);
        materials.any(|material| material.sheet.is_some())
    }

    /// `None` for an index out of range.
    fn new(
        mesh: &'a Mesh,
        element: &Element,
        section: ShellSection,
        material: &'a Material,
    ) -> Option<Self> {
        let named = |index: Option<u32>| match index {
            Some(index) => mesh.materials.get(index as usize).map(Some),
            None => Some(None),
        };
        let (bending, shear, layers) = match section.layup {
            Layup::One => (None, None, &[][..]),
            Layup::Apart { bending, shear } => (named(bending)?, named(shear)?, &[][..]),
            Layup::Layers(index) => {
                let layers = mesh.laminates.get(index as usize)?;
                if layers
                    .iter()
                    .any(|layer| named(Some(layer.material)).is_none())
                {
                    return None;
                }
                (None, None, layers.as_slice())
            }
        };
        let shape = match element.shell {
            Some(index) => Some(mesh.shell_shapes.get(index as usize)?),
            None => None,
        };
        Some(Sheet {
            section,
            material,
            bending,
            shear,
            layers,
            materials: &mesh.materials,
            shape,
        })
    }

    /// Mass per area (kg/m²), with the mean of the thicknesses at `corners` nodes.
    pub fn mass(&self, corners: usize) -> f64 {
        let own = self.shape.and_then(|shape| shape.thickness);
        let thickness = own.map_or(self.section.thickness, |own| {
            own.iter().take(corners).sum::<f64>() / corners as f64
        });
        self.density() * thickness + self.section.mass_per_area
    }

    /// Density (kg/m³), the mean of layers.
    fn density(&self) -> f64 {
        let (mut mass, mut thickness) = (0.0, 0.0);
        for layer in self.layers {
            let material = self.materials.get(layer.material as usize);
            mass += material.map_or(0.0, |material| material.density) * layer.thickness;
            thickness += layer.thickness;
        }
        match self.layers {
            [] => self.material.density,
            _ => mass / thickness,
        }
    }
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
        (ElementKind::Beam2, Section::Beam(_), Some(material)) => Some(Role::Beam(material)),
        (kind, section, material) if !kind.is_solid() && kind != ElementKind::Beam2 => {
            match (section, material) {
                (Section::Shell(section), Some(material)) => {
                    let sheet = Sheet::new(mesh, element, section, material)?;
                    Some(match kind == kind.linear() {
                        true => Role::Shell(sheet),
                        false => Role::Coat(sheet.mass(kind.corner_count())),
                    })
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

fn material_fault(material: &Material) -> Option<String> {
    let (young, poisson, density) = (material.young, material.poisson, material.density);
    if !(young > 0.0 && young.is_finite()) {
        Some(format!("Young's modulus {young} Pa; it must be above zero"))
    } else if !(poisson > -1.0 && poisson < 0.5) {
        Some(format!(
            "Poisson's ratio {poisson}; it must lie between -1 and 0.5, both excluded"
        ))
    } else if !(density >= 0.0 && density.is_finite()) {
        Some(format!("density {density} kg/m³; it can't be negative"))
    } else {
        material.sheet.as_ref().and_then(sheet_fault)
    }
}

/// Both matrices must be symmetric and positive definite.
fn sheet_fault(sheet: &SheetElasticity) -> Option<String> {
    let [[a, b, c], [_, d, e], [_, _, f]] = sheet.plane;
    let symmetric = (0..3).all(|i| (0..i).all(|j| sheet.plane[i][j] == sheet.plane[j][i]));
    let stiff = a > 0.0 && a * d - b * b > 0.0 && determinant(&sheet.plane) > 0.0;
    if !(symmetric && stiff && d.is_finite() && f.is_finite() && c.is_finite() && e.is_finite()) {
        return Some(format!(
            "a plane stiffness (Pa) of {a:.4e} {b:.4e} {c:.4e}, {d:.4e} {e:.4e}, {f:.4e}, which some strain costs nothing"
        ));
    }
    let [[a, b], [c, d]] = sheet.across?;
    let stiff = a > 0.0 && b == c && a * d - b * c > 0.0 && a.is_finite() && d.is_finite();
    (!stiff).then(|| {
        format!("a stiffness (Pa) of {a:.4e} {b:.4e}, {d:.4e} for shear across the sheet, which some shear costs nothing")
    })
}

/// Unsound thickness, position or axes of a shell.
fn shape_fault(mesh: &Mesh, element: &Element, sheet: &Sheet) -> Option<String> {
    let bad = |layer: &&Layer| !(layer.thickness > 0.0 && layer.thickness.is_finite());
    if let Some(layer) = sheet.layers.iter().find(bad) {
        return Some(format!(
            "a layer of {} m; its thickness must be above zero",
            layer.thickness
        ));
    }
    let shape = sheet.shape?;
    let corners = element.kind.corner_count();
    let own = shape.thickness.iter().flatten().take(corners);
    if let Some(thickness) = own.copied().find(|t| !(*t > 0.0 && t.is_finite())) {
        return Some(format!(
            "a thickness of {thickness} m at a node; it must be above zero"
        ));
    }
    let offsets = &shape.offsets[..corners.min(4)];
    if let Some(offset) = offsets.iter().find(|x| !x.is_finite()) {
        return Some(format!("an offset of {offset} m"));
    }
    if sheet.section.is_membrane() && offsets.iter().any(|x| *x != 0.0) {
        return Some("an offset, but a section without bending stiffness: nothing takes the moment of the offset".into());
    }
    let ShellAxis::Direction(direction, _) = shape.axis else {
        return None;
    };
    let place = |node: u32| mesh.nodes.get(node as usize).map(|node| node.position);
    let nodes = mesh.nodes_of(element);
    let (&[first, second, third], rest) = nodes.split_first_chunk()?;
    let last = match rest {
        [last, ..] if corners == 4 => *last,
        _ => first,
    };
    let diagonals = [
        subtract(place(third)?, place(first)?),
        subtract(place(last)?, place(second)?),
    ];
    let normal = cross(diagonals[0], diagonals[1]);
    let within = norm(cross(direction, normal));
    (sheet.is_directed() && !(within > 1e-3 * norm(direction) * norm(normal)))
        .then(|| "a first axis of its material that stands across its surface".into())
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
            "a bending stiffness of {bending} of its plate's; it must be above zero"
        ))
    } else if stiff && !(shear >= 0.0 && shear.is_finite()) {
        Some(format!("a shear factor of {shear}; it can't be negative"))
    } else {
        None
    }
}

fn section_fault(section: &Section, role: Role) -> Option<String> {
    match *section {
        Section::Solid => None,
        Section::Shell(section) => shell_fault(&section, role),
        Section::Beam(BeamSection {
            area,
            moment_z,
            moment_y,
            product,
            torsion,
            shear,
            mass_per_length,
        }) => {
            let moments = [
                moment_z,
                moment_y,
                torsion,
                shear[0],
                shear[1],
                mass_per_length,
            ];
            if !(area > 0.0 && area.is_finite()) {
                Some(format!("an area of {area} m²; it must be above zero"))
            } else if !moments.iter().all(|x| *x >= 0.0 && x.is_finite()) || !product.is_finite() {
                Some("a moment, torsion constant, shear factor or mass a length that is negative or not a number".into())
            } else if product != 0.0 && product * product >= moment_y * moment_z {
                Some(format!(
                    "a product of second moments {product} m⁴ beyond the moments {moment_z} and {moment_y} m⁴"
                ))
            } else {
                None
            }
        }
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
        return Err(wrong(
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
            return Err(wrong(
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
            return Err(wrong(
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
            return Err(wrong(
                format!("element {} has {fault}", element.id),
                "check the element's offset, thicknesses and material direction",
            ));
        }
        if let Some(fault) = section_fault(&property.section, role) {
            return Err(wrong(
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
                return Err(wrong(
                    format!(
                        "element {} is no shell, and its material “{}” is that of a sheet",
                        element.id, material.name
                    ),
                    "give it an isotropic material",
                ));
            }
            if *seen {
                continue;
            }
            if let Some(fault) = material_fault(material) {
                return Err(wrong(
                    format!(
                        "element {}: the material “{}” has {fault}",
                        element.id, material.name
                    ),
                    "check the material and the units",
                ));
            }
            *seen = true;
        }
    }
    Ok(())
}

/// A solid of a property that names no material.
fn without_material(mesh: &Mesh, element: &Element, property: &str) -> FlexibleError {
    let property = match property {
        "" => String::new(),
        name => format!(" of the property “{name}”"),
    };
    if mesh.materials.is_empty() {
        return wrong(
            format!(
                "the mesh has no material: element {}{property} needs one",
                element.id
            ),
            "state it in the body: `material = Steel`, with `use std.materials.Steel`, or a `Solid` of your own",
        );
    }
    wrong(
        format!("element {}{property} has no material", element.id),
        "give it one in the file, as the others have; `material =` of the body is for a mesh without any",
    )
}

fn is_rotation(rotation: &[[f64; 3]; 3]) -> bool {
    (0..3).all(|i| {
        (0..3).all(|j| {
            let product: f64 = (0..3).map(|k| rotation[i][k] * rotation[j][k]).sum();
            (product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-9
        })
    })
}

pub(crate) fn check_element(mesh: &Mesh, element: &Element) -> Result<(), FlexibleError> {
    let first = element.first as usize;
    let count = element.kind.node_count();
    let Some(nodes) = mesh.connectivity.get(first..first + count) else {
        return Err(wrong(
            format!("element {} has no nodes", element.id),
            BROKEN,
        ));
    };
    for (local, &node) in nodes.iter().enumerate() {
        let absent = node == ABSENT && local >= element.kind.corner_count();
        if !absent && node as usize >= mesh.nodes.len() {
            return Err(wrong(
                format!("node {} of element {} is missing", local + 1, element.id),
                "corner nodes must all be there; only mid-side nodes may be left out",
            ));
        }
    }
    if element.property as usize >= mesh.properties.len() {
        return Err(wrong(
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
            return Err(wrong(
                format!("beam {} has no orientation", element.id),
                "give the direction of the section's first axis",
            ));
        }
    }
    Ok(())
}

/// Checks point masses, springs, ties and supports.
///
/// # Errors
/// As [`check`].
pub(super) fn check_attachments(mesh: &Mesh) -> Result<(), FlexibleError> {
    let known = |node: u32| (node as usize) < mesh.nodes.len();
    let missing = |what: &str, id: u64| {
        wrong(
            format!("{what} {id} refers to a node or freedom that is not there"),
            BROKEN,
        )
    };
    for point in &mesh.point_masses {
        if !known(point.node) {
            return Err(missing("point mass", point.id));
        }
        let matrix = &point.matrix;
        let largest = (0..6).map(|i| matrix[i][i].abs()).fold(0.0, f64::max);
        let fits = (0..6).all(|i| {
            matrix[i][i] >= 0.0
                && (0..6).all(|j| {
                    matrix[i][j].is_finite()
                        && (matrix[i][j] - matrix[j][i]).abs() <= 1e-9 * largest
                })
        });
        if !fits {
            return Err(wrong(
                format!(
                    "point mass {} is negative, not symmetric or not a number",
                    point.id
                ),
                "check the mass card",
            ));
        }
    }
    for spring in &mesh.springs {
        let ends = [Some(spring.first), spring.second];
        if !ends
            .iter()
            .flatten()
            .all(|&(node, freedom)| known(node) && freedom < 6)
        {
            return Err(missing("spring", spring.id));
        }
        if !(spring.stiffness >= 0.0 && spring.stiffness.is_finite()) {
            return Err(wrong(
                format!(
                    "spring {} has a stiffness of {}",
                    spring.id, spring.stiffness
                ),
                "a stiffness can't be negative",
            ));
        }
    }
    for tie in &mesh.ties {
        let (id, good) = match tie {
            Tie::Rigid {
                id,
                independent,
                dependent,
            } => (
                *id,
                known(*independent) && dependent.iter().all(|&(node, _)| known(node)),
            ),
            Tie::Averaging {
                id,
                reference,
                independent,
                ..
            } => (
                *id,
                known(*reference)
                    && independent
                        .iter()
                        .all(|&(node, weight, _)| known(node) && weight.is_finite()),
            ),
            Tie::Equation { id, terms } => (
                *id,
                terms.iter().all(|&(node, freedom, coefficient)| {
                    known(node) && freedom < 6 && coefficient.is_finite()
                }),
            ),
        };
        if !good {
            return Err(missing("tie", id));
        }
    }
    if !mesh
        .supports
        .iter()
        .chain(&mesh.interface)
        .all(|support| known(support.node))
    {
        return Err(wrong(
            "a support refers to a node that is not there".into(),
            BROKEN,
        ));
    }
    Ok(())
}
