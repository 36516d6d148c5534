//! `*SOLID SECTION`, `*SHELL SECTION`, `*MEMBRANE SECTION`, `*BEAM SECTION`, `*BEAM GENERAL SECTION`: properties and
//! materials of the mesh.

use super::distributions::Distribution;
use super::lines::{self, key};
use super::materials::{Materials, Use};
use super::model::{Model, Row};
use super::orientations::Orientation;
use super::scope::Block;
use super::shapes::Shape;
use super::shells::{self, NodalThickness};
use crate::error::FileProblem;
use crate::mesh::{
    BeamSection, Carries, Code, Layer, Layup, Material, Property, Section, ShellSection, ShellShape,
};
use crate::read::builder::Once;
use crate::read::nastran::shapes;
use crate::read::unread::UnreadCards;

/// The family of an element's section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Family {
    /// A solid.
    Solid,
    /// A shell.
    Shell,
    /// A beam with shear flexibility, or without.
    Beam(bool),
    /// A truss.
    Truss,
    /// A membrane.
    Membrane,
    /// A surface without stiffness.
    Facet,
}

impl Family {
    /// The family of a shape; `None` for a shape that is no element of the mesh.
    pub fn of(shape: Shape) -> Option<Self> {
        match shape {
            Shape::Solid(..) => Some(Family::Solid),
            Shape::Shell(_) => Some(Family::Shell),
            Shape::Membrane(_) => Some(Family::Membrane),
            Shape::Facet(_) => Some(Family::Facet),
            Shape::Beam { shear, .. } => Some(Family::Beam(shear)),
            Shape::Truss => Some(Family::Truss),
            Shape::Mass | Shape::Rotary | Shape::Distributing | Shape::Spring(_) => None,
        }
    }
}

/// The axes of an anisotropic solid: orientation, place and line of the distribution.
type Axes = (String, usize, u32);

/// Sections of the elements, and the properties made of them.
#[derive(Debug)]
pub(super) struct Sections<'m> {
    /// Section blocks with their places.
    blocks: Vec<(usize, &'m Block)>,
    /// For each of them the distribution of the axes of its anisotropic solids, if there is one.
    distributions: Vec<Option<Distribution<'m>>>,
    /// Whose file it is.
    code: Code,
    /// Section of each row.
    of_row: Vec<Option<u32>>,
    nodal_thickness: NodalThickness,
    /// Properties of the mesh, by section, family and line of the distribution.
    pub properties: Once<(Option<u32>, Family, u32), Property>,
    /// Materials of the mesh, by name in capitals; of an anisotropic solid also by orientation, place and line of the
    /// distribution.
    pub materials: Once<(String, Option<Axes>), Material>,
    /// Layers of the composites.
    pub laminates: Vec<Vec<Layer>>,
}

const KEYWORDS: &[&str] = &[
    "SOLIDSECTION",
    "SHELLSECTION",
    "MEMBRANESECTION",
    "BEAMSECTION",
    "BEAMGENERALSECTION",
];

impl<'m> Sections<'m> {
    /// Finds the section of every element.
    pub fn new(
        (model, code): (&'m Model, Code),
        materials: &Materials,
        unread: &mut UnreadCards,
    ) -> Result<Self, FileProblem> {
        let mut sections = Sections {
            code,
            blocks: Vec::new(),
            distributions: Vec::new(),
            of_row: vec![None; model.rows.len()],
            nodal_thickness: NodalThickness::read(model, unread)?,
            properties: Once::default(),
            materials: Once::default(),
            laminates: Vec::new(),
        };
        for (place, block) in model.blocks() {
            let keyword = &block.keyword;
            if !KEYWORDS.contains(&keyword.key.as_str()) {
                continue;
            }
            let index = sections.blocks.len() as u32; // never near 2³² lines
            sections.blocks.push((place, block));
            let material = keyword.get("MATERIAL");
            let directed = material.is_some_and(|name| materials.is_anisotropic(name));
            let solid = keyword.key == "SOLIDSECTION";
            let distribution = match keyword.get("ORIENTATION").filter(|_| solid && directed) {
                Some(name) => Orientation::distribution((model, code), place, name)?,
                None => None,
            };
            sections.distributions.push(distribution);
            let set = keyword.require("ELSET", "ELSET")?;
            for row in model.rows_of(place, set, &keyword.at)? {
                let Some(section) = sections.of_row.get_mut(row as usize) else {
                    continue;
                };
                if section.replace(index).is_some() {
                    let label = model.rows.get(row as usize).map_or(0, |row| row.label);
                    return Err(keyword.problem(
                        &format!("element {label} has two sections"),
                        "remove it from one of the two sets",
                    ));
                }
            }
            let shells = keyword.key == "SHELLSECTION";
            for (parameter, written) in [
                ("SHELLTHICKNESS", "SHELL THICKNESS"),
                ("MEMBRANETHICKNESS", "MEMBRANE THICKNESS"),
            ] {
                if keyword.has(parameter) {
                    let name = format!("*{}, {written}", keyword.name);
                    unread.note(&name, &keyword.at, Carries::Structure);
                }
            }
            for (parameter, written) in
                [("OFFSET", "OFFSET"), ("NODALTHICKNESS", "NODAL THICKNESS")]
            {
                if keyword.has(parameter) && !shells {
                    unread.note(
                        &format!("*{}, {written}", keyword.name),
                        &keyword.at,
                        Carries::Structure,
                    );
                }
            }
        }
        Ok(sections)
    }

    /// The section block of a row.
    pub fn block(&self, row: u32) -> Option<(usize, &'m Block)> {
        let section = (*self.of_row.get(row as usize)?)?;
        self.blocks.get(section as usize).copied()
    }

    /// Index of a material for a kind of section.
    fn material(
        &mut self,
        name: &str,
        user: &Block,
        materials: &Materials,
        of: Use,
    ) -> Result<u32, FileProblem> {
        let material = materials.find(name, user, of)?;
        let by = (key(name), None);
        Ok(match self.materials.find(&by) {
            Some(made) => made,
            None => self.materials.add(by, material),
        })
    }

    /// Index of the material of solids, with the axes of their section if it is anisotropic: those of `ORIENTATION`, with
    /// the points of a line of its distribution if it has one, else the global ones.
    fn material_of_solid(
        &mut self,
        name: &str,
        (place, user): (usize, &Block),
        (number, line): (u32, Option<&lines::Row>),
        (model, materials): (&Model, &Materials),
        unread: &mut UnreadCards,
    ) -> Result<u32, FileProblem> {
        let mut material = materials.find(name, user, Use::Solid)?;
        let Some(solid) = &mut material.solid else {
            return self.material(name, user, materials, Use::Solid);
        };
        let keyword = &user.keyword;
        let by = (
            key(name),
            Some((keyword.choice("ORIENTATION"), place, number)),
        );
        if let Some(made) = self.materials.find(&by) {
            return Ok(made);
        }
        match keyword.get("ORIENTATION").filter(|name| !name.is_empty()) {
            Some(named) => {
                let deck = (model, self.code);
                let found = Orientation::named(deck, place, (named, line), user, unread)?;
                if let Some(found) = found {
                    solid.axes = found.axes().ok_or_else(|| {
                        let at = line.map_or(&keyword.at, |line| &line.at);
                        at.problem(
                            format!(
                                "*{}: the points of the orientation {named} give no axes",
                                keyword.name
                            ),
                            "choose points that form a triangle with the origin, or two different points of a cylinder's axis",
                        )
                    })?;
                }
            }
            None => {
                let placed = model.places.get(place);
                if placed.is_some_and(|placed| placed.motion().turns()) {
                    let name = "anisotropic solids without ORIENTATION in a turned *INSTANCE";
                    unread.note(name, &keyword.at, Carries::Structure);
                }
            }
        }
        Ok(self.materials.add(by, material))
    }

    /// The property of `*SHELL SECTION, COMPOSITE`.
    fn composite(
        &mut self,
        name: String,
        block: &Block,
        materials: &Materials,
        unread: &mut UnreadCards,
    ) -> Result<Property, FileProblem> {
        let mut layers = Vec::new();
        for (thickness, material, angle) in shells::layers(block, unread)? {
            layers.push(Layer {
                material: self.material(material, block, materials, Use::Shell)?,
                thickness,
                angle,
            });
        }
        let thickness = layers.iter().map(|layer| layer.thickness).sum();
        let material = layers.first().map(|layer| layer.material);
        let layup = Layup::Layers(self.laminates.len() as u32); // fewer than lines
        self.laminates.push(layers);
        Ok(Property {
            name,
            material,
            section: Section::Shell(ShellSection {
                layup,
                ..ShellSection::plate(thickness)
            }),
        })
    }

    /// Position and thickness of the shell of a row; `None` if they are those of its section.
    pub fn shape(
        &self,
        index: u32,
        property: u32,
        (row, model): (&Row, &Model),
        unread: &mut UnreadCards,
    ) -> Result<Option<ShellShape>, FileProblem> {
        let property = self.properties.all.get(property as usize);
        let (Some((_, block)), Some(Section::Shell(section))) =
            (self.block(index), property.map(|property| property.section))
        else {
            return Ok(None);
        };
        let materials = property.map(|property| property.materials(&self.laminates));
        let directed = materials.into_iter().flatten().any(|index| {
            let material = self.materials.all.get(index as usize);
            material.is_some_and(|material| material.sheet.is_some())
        });
        let nodes = &self.nodal_thickness;
        let of_section = (section.thickness, directed);
        shells::shape(block, of_section, (row, model), nodes, unread)
    }

    /// The property of a row without section. Solids get one without material, shells and membranes become facets; `None`
    /// for beams and trusses, which need a section.
    fn without_section(row: &Row, family: Family, unread: &mut UnreadCards) -> Option<Property> {
        let name = match family {
            Family::Solid => {
                return Some(Property {
                    name: "without section".into(),
                    material: None,
                    section: Section::Solid,
                });
            }
            Family::Facet => return Some(facets("facets")),
            Family::Shell => "shells without section",
            Family::Membrane => "membranes without section",
            Family::Beam(_) | Family::Truss => return None,
        };
        unread.note(name, &row.at, Carries::Structure);
        Some(facets(name))
    }

    /// Index of the property of a row; `None` for beams and trusses without section.
    pub fn property(
        &mut self,
        row: u32,
        family: Family,
        model: &Model,
        materials: &Materials,
        unread: &mut UnreadCards,
    ) -> Result<Option<u32>, FileProblem> {
        let section = self.of_row.get(row as usize).copied().flatten();
        let distribution = section.and_then(|section| self.distributions.get(section as usize));
        let line = match distribution {
            Some(Some(distribution)) => {
                let (number, line) = distribution.line(row);
                (number, Some(line))
            }
            _ => (0, None),
        };
        let by = (section, family, line.0);
        if let Some(made) = self.properties.find(&by) {
            return Ok(Some(made));
        }
        let block = section.and_then(|section| self.blocks.get(section as usize).copied());
        let Some((place, block)) = block else {
            let row = model.rows.get(row as usize);
            let property = row.and_then(|row| Self::without_section(row, family, unread));
            return Ok(property.map(|property| self.properties.add(by, property)));
        };
        let keyword = &block.keyword;
        let name = match model.places.get(place).map(|placed| placed.name.as_str()) {
            Some(instance) if !instance.is_empty() => {
                format!("{instance}.{}", keyword.get("ELSET").unwrap_or(""))
            }
            _ => keyword.get("ELSET").unwrap_or("").to_string(),
        };
        let section_of = match (family, keyword.key.as_str()) {
            (Family::Solid, "SOLIDSECTION") if !keyword.has("COMPOSITE") => Section::Solid,
            (Family::Shell, "SHELLSECTION") if !keyword.has("COMPOSITE") => {
                let Some(row) = model.rows.get(row as usize) else {
                    return Ok(None);
                };
                let line = block.rows.first();
                match shells::thickness(block, line, (row, model), &self.nodal_thickness)? {
                    Some(thickness) => Section::Shell(ShellSection::plate(thickness)),
                    None => return Err(without_line(block)),
                }
            }
            (Family::Truss, "SOLIDSECTION") => rod(match first_row(block) {
                Ok(row) => row.optional_real(0, "the area")?.unwrap_or(1.0),
                Err(_) => 1.0,
            }),
            (Family::Beam(shear), "BEAMSECTION") => shaped(block, shear, self.code)?,
            (Family::Beam(_), "BEAMGENERALSECTION") => {
                let (section, material) = general(block, &name)?;
                let material = self.materials.push(material);
                let property = Property {
                    name,
                    material: Some(material),
                    section,
                };
                return Ok(Some(self.properties.add(by, property)));
            }
            (Family::Membrane, "MEMBRANESECTION") => membrane(block)?,
            (Family::Facet, _) => {
                unread.note(
                    &format!("*{} of plane or surface elements", keyword.name),
                    &keyword.at,
                    Carries::Structure,
                );
                let property = facets(&name);
                return Ok(Some(self.properties.add(by, property)));
            }
            (Family::Shell, "SHELLSECTION") => {
                let property = self.composite(name, block, materials, unread)?;
                return Ok(Some(self.properties.add(by, property)));
            }
            _ => {
                let label = model.rows.get(row as usize).map_or(0, |row| row.label);
                return Err(keyword.problem(
                    &format!("element {label} needs another kind of section"),
                    "give solids and trusses a *SOLID SECTION, shells a *SHELL SECTION, membranes a *MEMBRANE SECTION, and beams a *BEAM SECTION; only shells can be COMPOSITE",
                ));
            }
        };
        let written = keyword.require("MATERIAL", "MATERIAL")?;
        let material = match family {
            Family::Solid => {
                let section = (place, block);
                self.material_of_solid(written, section, line, (model, materials), unread)?
            }
            Family::Shell => self.material(written, block, materials, Use::Shell)?,
            Family::Beam(_) | Family::Truss | Family::Membrane | Family::Facet => {
                self.material(written, block, materials, Use::Line)?
            }
        };
        let property = Property {
            name,
            material: Some(material),
            section: section_of,
        };
        Ok(Some(self.properties.add(by, property)))
    }
}

/// The direction of the first axis (n1) of a beam section, in the frame of its part; (0, 0, -1) where it
/// isn't given.
pub(super) fn direction(block: &Block) -> Result<[f64; 3], FileProblem> {
    match block.rows.get(1) {
        Some(row) if !row.is_blank() => row.vector(0, "a direction cosine of n1"),
        _ => Ok([0.0, 0.0, -1.0]),
    }
}

fn first_row(block: &Block) -> Result<&lines::Row, FileProblem> {
    block.rows.first().ok_or_else(|| without_line(block))
}

/// Surfaces without stiffness.
fn facets(name: &str) -> Property {
    Property {
        name: name.into(),
        material: None,
        section: Section::Shell(ShellSection::plate(0.0)),
    }
}

fn without_line(block: &Block) -> FileProblem {
    block.keyword.problem(
        "its data line is missing",
        "write its dimensions on the next line",
    )
}

/// `*MEMBRANE SECTION`: the thickness.
fn membrane(block: &Block) -> Result<Section, FileProblem> {
    let thickness = first_row(block)?.real(0, "the thickness")?;
    Ok(Section::Shell(ShellSection {
        layup: Layup::Apart {
            bending: None,
            shear: None,
        },
        ..ShellSection::plate(thickness)
    }))
}

fn rod(area: f64) -> Section {
    Section::Beam(BeamSection {
        area,
        ..BeamSection::default()
    })
}

/// The name of a section's shape. CalculiX compares its first four letters, and three letters of `BOX`.
fn shape_name(written: String, code: Code) -> String {
    if code != Code::CalculiX {
        return written;
    }
    let known = ["RECT", "CIRC", "PIPE", "BOX"];
    match known.iter().find(|known| written.starts_with(**known)) {
        Some(known) => (*known).to_string(),
        None => written,
    }
}

/// `*BEAM SECTION`: `RECT` a, b; `CIRC` r; `PIPE` r, t; `BOX` a, b, t1…t4, with a along n1 and b along n2. The
/// element's y is n1, its z n2. In CalculiX, `CIRC` has the diameters along n1 and n2, and a missing second
/// dimension of `RECT` and `CIRC` equals the first. Shear factors are Abaqus's: 0.85 for `RECT`, 0.89 for
/// `CIRC`, 0.53 for `PIPE`, 0.44 for `BOX`.
fn shaped(block: &Block, shear: bool, code: Code) -> Result<Section, FileProblem> {
    let row = first_row(block)?;
    let keyword = &block.keyword;
    let positive = |i: usize, name: &str| {
        row.real(i, name).and_then(|value| {
            if value > 0.0 {
                return Ok(value);
            }
            Err(row
                .at
                .problem(format!("{name} is {value}"), "give a number above zero"))
        })
    };
    let choice = shape_name(keyword.choice("SECTION"), code);
    // the drawings behind these shapes have y up, along n2, and z to the right, along n1
    let (shape, dimensions, factor) = match choice.as_str() {
        "RECT" => {
            let a = positive(0, "a")?;
            let square = code == Code::CalculiX && row.text(1).is_empty();
            let b = if square { a } else { positive(1, "b")? };
            ("BAR", vec![a, b], 0.85)
        }
        "CIRC" if code == Code::CalculiX => {
            let diameter = positive(0, "the diameter along n1")?;
            if !row.text(1).is_empty() && positive(1, "the diameter along n2")? != diameter {
                return Err(row.at.problem(
                    "the two diameters of CIRC differ, and Eng reads no ellipse",
                    "give one diameter, or mesh the beam with solids",
                ));
            }
            ("ROD", vec![0.5 * diameter], 0.89)
        }
        "CIRC" => ("ROD", vec![positive(0, "the radius")?], 0.89),
        "PIPE" => {
            let (outer, wall) = (positive(0, "the radius")?, positive(1, "the wall")?);
            ("TUBE", vec![outer, outer - wall], 0.53)
        }
        "BOX" => {
            let walls = [
                positive(2, "t1")?,
                positive(3, "t2")?,
                positive(4, "t3")?,
                positive(5, "t4")?,
            ];
            let [t1, t2, t3, t4] = walls;
            if t1 != t3 || t2 != t4 {
                return Err(row.at.problem(
                    "opposite walls of the BOX differ: t1 and t3, or t2 and t4",
                    "give its area and moments of area in *BEAM GENERAL SECTION",
                ));
            }
            // t1 and t3 are the sides, t2 and t4 the lids
            (
                "BOX",
                vec![positive(0, "a")?, positive(1, "b")?, t2, t1],
                0.44,
            )
        }
        other => {
            return Err(keyword.problem(
                &format!("Eng does not read SECTION={other}"),
                "use RECT, CIRC, PIPE or BOX, or give the area and the moments of area in *BEAM GENERAL SECTION",
            ));
        }
    };
    let Some(found) = shapes::section(shape, &dimensions) else {
        return Err(row.at.problem(
            format!("no {choice} has these dimensions"),
            "take thinner walls or a larger section; the walls must fit into it",
        ));
    };
    // up is the element's z here
    Ok(Section::Beam(BeamSection {
        moment_z: found.moment_y,
        moment_y: found.moment_z,
        shear: if shear { [factor; 2] } else { [0.0; 2] },
        ..found
    }))
}

/// `*BEAM GENERAL SECTION, SECTION=GENERAL, DENSITY=ρ`: `A, I11, I12, I22, J`, n1, `E, G`. I11 is for bending
/// about n1, I22 about n2. Poisson's ratio is E / 2 G − 1, without shear flexibility.
fn general(block: &Block, name: &str) -> Result<(Section, Material), FileProblem> {
    let keyword = &block.keyword;
    let choice = keyword.choice("SECTION");
    if !matches!(choice.as_str(), "" | "GENERAL") {
        return Err(keyword.problem(
            &format!("Eng does not read SECTION={choice}"),
            "write SECTION=GENERAL with the area and the moments of area, or use *BEAM SECTION",
        ));
    }
    let row = first_row(block)?;
    let Some(elastic) = block.rows.get(2) else {
        return Err(keyword.problem(
            "its third data line is missing",
            "write three lines: A, I11, I12, I22, J; then n1; then E, G",
        ));
    };
    let (young, shear) = (elastic.real(0, "E")?, elastic.real(1, "G")?);
    if !(young > 0.0 && shear > 0.0) {
        return Err(elastic
            .at
            .problem("E or G is not above zero", "give both moduli"));
    }
    let density = match keyword.get("DENSITY") {
        None => 0.0,
        Some(text) => crate::read::number::real(text).ok_or_else(|| {
            keyword.problem(
                &format!("DENSITY is \"{text}\", not a number"),
                "give the density",
            )
        })?,
    };
    let section = Section::Beam(BeamSection {
        area: row.real(0, "A")?,
        moment_z: row.real_or_zero(3, "I22")?,
        moment_y: row.real_or_zero(1, "I11")?,
        product: row.real_or_zero(2, "I12")?,
        torsion: row.real_or_zero(4, "J")?,
        shear: [0.0; 2],
        mass_per_length: 0.0,
    });
    let material = Material {
        name: name.into(),
        young,
        poisson: young / (2.0 * shear) - 1.0,
        density,
        sheet: None,
        solid: None,
    };
    Ok((section, material))
}
