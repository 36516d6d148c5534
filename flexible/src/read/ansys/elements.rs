//! Solids and shells of the mesh, with their materials and sections.

use std::collections::BTreeMap;

use super::deck::{Deck, ELASTIC, Row, SectionRow};
use super::shapes::{Family, NO_NODE, name, shape, variant};
use crate::error::FileProblem;
use crate::mesh::{
    Carries, Layer, Layup, Material, Mesh, Property, Section, Set, ShellAxis, ShellSection,
    ShellShape, Variant,
};
use crate::read::builder::{NewElement, Once, add_element};
use crate::read::labels::Labels;

/// Type, material, constants and section of elements that share a property.
type Key = [i64; 4];

/// Makes elements and the materials and sections that they use.
struct Making<'d> {
    deck: &'d Deck,
    materials: Once<i64, Material>,
    properties: Once<Key, Property>,
    laminates: Vec<Vec<Layer>>,
}

/// Makes the elements of a mesh. Returns the index of each element by its number, and the rows of masses and
/// springs.
pub(super) fn make(
    deck: &mut Deck,
    mesh: &mut Mesh,
    labels: &Labels,
) -> Result<(Labels, Vec<(Family, Row)>), FileProblem> {
    let rows = std::mem::take(&mut deck.rows);
    let mut unread = std::mem::take(&mut deck.unread);
    let mut making = Making {
        deck,
        materials: Once::default(),
        properties: Once::default(),
        laminates: Vec::new(),
    };
    let mut indices = Vec::new();
    let mut points = Vec::new();
    let mut parts: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    for row in rows {
        let Some(kind) = making.deck.types.get(&row.kind) else {
            return Err(row.at.problem(
                format!(
                    "element {} has the type {}, which does not exist",
                    row.id, row.kind
                ),
                "write the whole model by CDWRITE, with the ET of its types",
            ));
        };
        let family = match Family::of(kind.number) {
            Some(family) => family,
            None => {
                unread.note(&name(kind.number), &row.at, Carries::Structure);
                continue;
            }
        };
        match family {
            Family::Facet => {
                unread.note(&name(kind.number), &row.at, Carries::Nothing);
                continue;
            }
            Family::Mass | Family::Spring => {
                points.push((family, row));
                continue;
            }
            _ => {}
        }
        let index = making.element(&row, family, mesh, labels)?;
        indices.push((row.id, index));
        for part in [
            format!("type:{}", row.kind),
            format!("material:{}", row.material),
        ] {
            parts.entry(part).or_default().push(index);
        }
    }
    let indices = Labels::new(indices);
    mesh.materials = making.materials.all;
    mesh.properties = making.properties.all;
    mesh.laminates = making.laminates;
    for (part, elements) in parts {
        let set = Set::new(mesh.nodes_of_all(&elements), elements);
        mesh.sets.insert(part, set);
    }
    deck.unread = unread;
    Ok((indices, points))
}

impl Making<'_> {
    fn element(
        &mut self,
        row: &Row,
        family: Family,
        mesh: &mut Mesh,
        labels: &Labels,
    ) -> Result<u32, FileProblem> {
        let Some(kind) = self.deck.types.get(&row.kind) else {
            return Err(row.at.problem("a type is missing", "write the type by ET"));
        };
        let title = format!("element {} ({})", row.id, name(kind.number));
        let Some((shape, nodes)) = shape(family, &row.nodes) else {
            return Err(row.at.problem(
                format!(
                    "{title}: its {} nodes make no shape of this element",
                    row.nodes.len()
                ),
                "repeat nodes as ANSYS does: K = L and O = P in a wedge, M = N = O = P in a pyramid, both in a tetrahedron, K = L in a triangle",
            ));
        };
        let mut indices = Vec::with_capacity(nodes.len());
        for node in nodes {
            indices.push(match (node, labels.find(node)) {
                (0, _) => NO_NODE,
                (_, Some(index)) => index,
                (_, None) => {
                    return Err(row.at.problem(
                        format!("{title} uses node {node}, which is missing"),
                        "write the whole mesh with all its nodes",
                    ));
                }
            });
        }
        let refused = |option: i64, meaning: &str| {
            row.at.problem(
                format!(
                    "{title}: KEYOPT({option}) = {} is {meaning}",
                    kind.option(option)
                ),
                "set this option of the type to 0 and write the archive again",
            )
        };
        let solid = matches!(family, Family::Solid8 | Family::Solid20);
        if solid && kind.option(3) == 1 {
            return Err(refused(3, "a layered solid, which Eng does not read"));
        }
        if kind.option(6) != 0 && (solid || family == Family::Tetrahedron10) {
            return Err(refused(
                6,
                "a mixed formulation with pressures, which Eng does not compute",
            ));
        }
        let shell = matches!(family, Family::Shell4 | Family::Shell8);
        if shell && kind.option(1) > 1 {
            return Err(refused(
                1,
                "a shell without stiffness or of another kind, which Eng does not read",
            ));
        }
        if shell && kind.option(9) != 0 {
            return Err(refused(9, "a thickness from a user's routine"));
        }
        let (property, shell) = match shell {
            true => self.shell(row, kind.option(1) == 1)?,
            false => (self.solid(row)?, None),
        };
        let new = NewElement {
            id: row.id,
            kind: shape,
            variant: match shell {
                Some(_) => Variant::Plain,
                None => variant(kind.number, kind.option(2)),
            },
            property,
            shell,
        };
        add_element(mesh, new, &indices, None).map_err(|e| e.at(&row.at))
    }

    fn key(row: &Row) -> (Key, String) {
        let key = [row.kind, row.material, row.real, row.section];
        (key, key.map(|number| number.to_string()).join(":"))
    }

    /// A property of solids.
    fn solid(&mut self, row: &Row) -> Result<u32, FileProblem> {
        let (key, name) = Self::key(row);
        if let Some(made) = self.properties.find(&key) {
            return Ok(made);
        }
        let material = self.material(row.material, row)?;
        let property = Property {
            name,
            material,
            section: Section::Solid,
        };
        Ok(self.properties.add(key, property))
    }

    /// A material; `None` if the archive has none at all, and the body states it.
    fn material(&mut self, number: i64, row: &Row) -> Result<Option<u32>, FileProblem> {
        if let Some(made) = self.materials.find(&number) {
            return Ok(Some(made));
        }
        let elastic = |values: &BTreeMap<String, f64>| {
            ELASTIC.iter().any(|label| values.contains_key(*label))
        };
        if !self.deck.materials.values().any(elastic) {
            return Ok(None);
        }
        let none = BTreeMap::new();
        let values = self.deck.materials.get(&number).unwrap_or(&none);
        let wrong = |problem: &str, advice: &str| {
            row.at.problem(
                format!("material {number} of element {}: {problem}", row.id),
                advice,
            )
        };
        let value = |label: &str| values.get(label).copied();
        let Some(young) = value("EX").filter(|young| *young > 0.0) else {
            return Err(wrong(
                "EX is missing",
                "add MP,EX, or leave all materials out of the archive and state `material` at the body",
            ));
        };
        let poisson = match (value("NUXY"), value("PRXY")) {
            (Some(one), Some(other)) if one != other => {
                return Err(wrong("NUXY differs from PRXY", "state PRXY alone"));
            }
            (Some(one), _) | (None, Some(one)) => one,
            (None, None) => {
                return Err(wrong(
                    "Poisson's ratio is missing",
                    "add MP,PRXY; ANSYS' own default differs between its versions",
                ));
            }
        };
        if !(poisson > -1.0 && poisson < 0.5) {
            return Err(wrong(
                &format!("Poisson's ratio is {poisson}"),
                "give a ratio above -1 and below 0.5",
            ));
        }
        let shear = young / (2.0 * (1.0 + poisson));
        let same = |labels: &[&str], wanted: f64| {
            let mut given = labels.iter().filter_map(|label| value(label));
            // six digits of a file: constants that are equal to them are those of an isotropic material
            given.all(|given| (given / wanted - 1.0).abs() < 1e-6 || given == wanted)
        };
        let isotropic = same(&["EY", "EZ"], young)
            && same(&["NUYZ", "NUXZ", "PRYZ", "PRXZ"], poisson)
            && same(&["GXY", "GYZ", "GXZ"], shear);
        if !isotropic {
            return Err(wrong(
                "it is not isotropic",
                "state EX, PRXY and DENS alone, if the body allows it",
            ));
        }
        let material = Material {
            name: number.to_string(),
            young,
            poisson,
            density: value("DENS").unwrap_or(0.0),
            sheet: None,
            solid: None,
        };
        Ok(Some(self.materials.add(number, material)))
    }

    /// A property of shells by their section or constants, and the place and thickness of an element.
    fn shell(
        &mut self,
        row: &Row,
        membrane: bool,
    ) -> Result<(u32, Option<ShellShape>), FileProblem> {
        let sections = &self.deck.sections;
        if let Some(section) = sections.get(&row.section).filter(|s| !s.layers.is_empty()) {
            return self.sectioned(row, &section.clone(), membrane);
        }
        let none = Vec::new();
        let values = self.deck.reals.get(&row.real).unwrap_or(&none);
        let value = |i: usize| values.get(i).copied().unwrap_or(0.0);
        let first = value(0);
        if first <= 0.0 {
            return Err(row.at.problem(
                format!("the shell {} has no thickness", row.id),
                "add SECTYPE, SHELL with SECDATA, or a set of constants (R)",
            ));
        }
        if (6..values.len()).any(|i| value(i) != 0.0) {
            return Err(row.at.problem(
                format!("the shell {} has transverse shear or drilling of its own (constants 7 to 12), which Eng does not read", row.id),
                "leave these constants out",
            ));
        }
        let corners = [1, 2, 3].map(|i| if value(i) > 0.0 { value(i) } else { first });
        let [second, third, fourth] = corners;
        let thickness = [first, second, third, fourth];
        let added = value(5);
        let material = self.material(row.material, row)?;
        let section = ShellSection {
            mass_per_area: added,
            ..ShellSection::plate(first)
        };
        let property = self.plate(row, section, material, membrane);
        let shape = ShellShape {
            thickness: (corners != [first; 3]).then_some(thickness),
            ..ShellShape::default()
        };
        Ok((property, Some(shape)))
    }

    fn plate(
        &mut self,
        row: &Row,
        section: ShellSection,
        material: Option<u32>,
        membrane: bool,
    ) -> u32 {
        let (key, name) = Self::key(row);
        if let Some(made) = self.properties.find(&key) {
            return made;
        }
        let layup = match (membrane, section.layup) {
            (true, Layup::One) => Layup::Apart {
                bending: None,
                shear: None,
            },
            (_, layup) => layup,
        };
        let property = Property {
            name,
            material,
            section: Section::Shell(ShellSection { layup, ..section }),
        };
        self.properties.add(key, property)
    }

    fn sectioned(
        &mut self,
        row: &Row,
        section: &SectionRow,
        membrane: bool,
    ) -> Result<(u32, Option<ShellShape>), FileProblem> {
        let wrong = |problem: &str, advice: &str| {
            section
                .at
                .problem(format!("section {}: {problem}", row.section), advice)
        };
        let mut layers = Vec::with_capacity(section.layers.len());
        for (thickness, material, angle) in &section.layers {
            if *thickness <= 0.0 {
                return Err(wrong(
                    "a layer has no thickness",
                    "give each layer a thickness above zero",
                ));
            }
            let number = if *material == 0 {
                row.material
            } else {
                *material
            };
            layers.push((*thickness, self.material(number, row)?, *angle));
        }
        let thickness: f64 = layers.iter().map(|(thickness, ..)| thickness).sum();
        let plate = ShellSection::plate(thickness);
        let (material, layup) = match layers.as_slice() {
            [(_, material, _)] => (*material, Layup::One),
            _ if membrane => {
                return Err(wrong(
                    "a membrane of several layers",
                    "give the section one layer, or set KEYOPT(1) = 0",
                ));
            }
            several => {
                let made = several.iter().map(|(thickness, material, angle)| {
                    material.map(|material| Layer {
                        material,
                        thickness: *thickness,
                        angle: angle.to_radians(),
                    })
                });
                let Some(made) = made.collect::<Option<Vec<Layer>>>() else {
                    return Err(wrong(
                        "its layers have no material",
                        "add MP of the materials",
                    ));
                };
                let first = made.first().map(|layer| layer.material);
                let (key, _) = Self::key(row);
                let index = self.laminates.len() as u32; // fewer than elements
                if self.properties.find(&key).is_none() {
                    self.laminates.push(made);
                }
                (first, Layup::Layers(index))
            }
        };
        // the nodes lie on this surface
        let offset = match section.offset.get(..3).unwrap_or("MID") {
            "MID" => 0.0,
            "TOP" => -0.5 * thickness,
            "BOT" => 0.5 * thickness,
            _ => {
                return Err(wrong(
                    &format!("SECOFFSET,{} is not read", section.offset),
                    "write SECOFFSET with MID, TOP or BOT",
                ));
            }
        };
        let property = self.plate(row, ShellSection { layup, ..plate }, material, membrane);
        let shape = ShellShape {
            offsets: [offset; 4],
            axis: ShellAxis::Side(0.0),
            ..ShellShape::default()
        };
        Ok((property, Some(shape)))
    }
}
