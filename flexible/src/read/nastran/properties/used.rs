//! The properties and materials that elements use, made of their cards.

use super::anisotropic::{AxesTold, SolidConstants};
use super::{Constants, Kind, LaminateCard, Properties, PropertyCard};
use crate::error::FileProblem;
use crate::mesh::{
    BeamSection, Layer, Layup, Material, Property, Section, SheetElasticity, ShellSection,
    SolidElasticity, Station,
};
use crate::read::builder::Once;
use crate::read::nastran::elements::Family;
use crate::read::nastran::frames::Systems;
use crate::read::nastran::lines::At;

/// The role of a material in a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Use {
    /// Of a solid or a beam.
    Body,
    /// Membrane and bending of a shell.
    Sheet,
    /// Shear across a shell.
    Across,
}

/// The form of a material for a kind of section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// As its card states it.
    Stated,
    /// `MAT1` of a line: G counts, and NU is E/(2 G) − 1.
    Shear,
    /// `MAT1` of a sheet with its own G.
    Sheet,
    /// `MAT2` or `MAT8` of the shear across a shell.
    Across,
    /// `MAT9` or `MAT11` in the axes of a coordinate system.
    InSystem(u64),
}

/// The name of a material whose G is not that of an isotropic solid.
const ODD_SHEAR: &str = "MAT1 of solids with G other than E/(2 (1+NU))";

/// The name of a material without G and NU of anything but a line that only stretches and bends.
const NO_SHEAR: &str = "MAT1 without G and NU of solids, shells or beams with shear";

/// Properties and materials of a mesh, each made when an element first uses it.
pub struct UsedProperties<'d> {
    cards: &'d Properties,
    systems: &'d Systems,
    mass_scale: f64,
    /// Properties in the order of their first use, by family, number, a shell's own thickness and mass that other cards
    /// add.
    pub properties: Once<(Family, u64, Option<u64>, u64), Property>,
    /// Materials in the order of their first use, by number and form.
    pub materials: Once<(u64, Form), Material>,
    /// Uses of materials whose shear Eng does not know: the name of the content, and the card.
    pub odd_shear: Vec<(&'static str, At)>,
    /// Layers, by the order of the deck's laminates.
    pub laminates: Once<usize, Vec<Layer>>,
    /// Sections of tapered beams, by the order of the deck's.
    pub tapers: Once<(usize, u64), Vec<Station>>,
    /// What to say about the axes of materials.
    pub axes_told: AxesTold,
}

impl<'d> UsedProperties<'d> {
    /// Begins without properties and materials. `mass_scale` multiplies every density and added mass
    /// (`PARAM,WTMASS`).
    pub fn new(cards: &'d Properties, systems: &'d Systems, mass_scale: f64) -> Self {
        UsedProperties {
            cards,
            systems,
            mass_scale,
            properties: Once::default(),
            materials: Once::default(),
            odd_shear: Vec::new(),
            laminates: Once::default(),
            tapers: Once::default(),
            axes_told: AxesTold::default(),
        }
    }

    /// Index of the property that an element uses, with a shell's own thickness if it has one, and with an added mass per
    /// area or length.
    pub fn property(
        &mut self,
        (family, id): (Family, u64),
        (thickness, added): (Option<f64>, f64),
        element: u64,
        at: &At,
    ) -> Result<u32, FileProblem> {
        let key = (family, id, thickness.map(f64::to_bits), added.to_bits());
        if let Some(index) = self.properties.find(&key) {
            return Ok(index);
        }
        let Some(card) = self.cards.properties.get(&(family, id)) else {
            let kind = match family {
                Family::Solid => "PSOLID",
                Family::Shell => "PSHELL",
                Family::Beam => "PBAR or PBEAM",
                Family::Rod => "PROD",
            };
            return Err(at.problem(
                format!("element {element} uses property {id}, which is missing"),
                format!("add a {kind} card, or INCLUDE the file that holds it"),
            ));
        };
        let property = self.made(card, id.to_string(), (thickness, added), element, at)?;
        Ok(self.properties.add(key, property))
    }

    /// Index of a property that no other element shares.
    pub fn own(
        &mut self,
        card: &PropertyCard,
        (name, added): (String, f64),
        element: u64,
        at: &At,
    ) -> Result<u32, FileProblem> {
        let property = self.made(card, name, (None, added), element, at)?;
        Ok(self.properties.push(property))
    }

    fn made(
        &mut self,
        card: &PropertyCard,
        name: String,
        (own_thickness, added): (Option<f64>, f64),
        element: u64,
        at: &At,
    ) -> Result<Property, FileProblem> {
        let scale = self.mass_scale;
        let section = match card.kind {
            Kind::Solid(..) => Section::Solid,
            Kind::Shell(plate) => {
                let thickness = match own_thickness.or(plate.thickness) {
                    Some(thickness) => thickness,
                    None if card.material.is_none() => 0.0,
                    None => {
                        return Err(at.problem(
                            format!("element {element} has no thickness"),
                            format!("give T in {}, or T1 to T4 in the element", card.name),
                        ));
                    }
                };
                let [bending, shear] = plate.apart.unwrap_or_default();
                let made = [(bending, Use::Sheet), (shear, Use::Across)]
                    .map(|(id, usage)| id.map(|id| self.material(id, card, usage)).transpose());
                let [bending, shear] = made;
                let section = plate.section(thickness, scale, [bending?, shear?]);
                Section::Shell(ShellSection {
                    mass_per_area: section.mass_per_area + added * scale,
                    ..section
                })
            }
            Kind::Laminate(index) => self.laminate(index, card, added)?,
            Kind::Line(line) => {
                let soft = self.is_without_shear(card);
                if soft && line.shear != [0.0; 2] {
                    self.note_shear(NO_SHEAR, card);
                }
                Section::Beam(BeamSection {
                    mass_per_length: (line.mass_per_length + added) * scale,
                    torsion: if soft { 0.0 } else { line.torsion },
                    ..line
                })
            }
            Kind::Tapered(index) => {
                if self.is_without_shear(card) {
                    self.note_shear(NO_SHEAR, card);
                }
                Section::Tapered(self.taper(index, added))
            }
            Kind::Unreadable => {
                return Err(card.at.problem(
                    format!(
                        "element {element} uses {}, and Eng does not read this kind of property for it",
                        card.name
                    ),
                    "give solids a PSOLID of a structure, and beams PBAR, PBEAM, or PBARL and PBEAML with a known shape",
                ));
            }
        };
        let usage = match section {
            Section::Shell(_) => Use::Sheet,
            _ => Use::Body,
        };
        let material = match card.material {
            Some(id) => Some(self.material(id, card, usage)?),
            None => None,
        };
        Ok(Property {
            name,
            material,
            section,
        })
    }

    /// Whether the material of a property has E alone.
    fn is_without_shear(&self, card: &PropertyCard) -> bool {
        let material = card.material.and_then(|id| self.cards.materials.get(&id));
        material.is_some_and(|card| matches!(card.constants, Constants::Stretch(_)))
    }

    /// Notes that a material's shear is not known for a property that uses it.
    fn note_shear(&mut self, name: &'static str, user: &PropertyCard) {
        let material = user.material.and_then(|id| self.cards.materials.get(&id));
        let at = material.map_or(&user.at, |card| &card.at);
        if !self
            .odd_shear
            .iter()
            .any(|known| known.0 == name && known.1 == *at)
        {
            self.odd_shear.push((name, at.clone()));
        }
    }

    /// Index of the stations of a tapered beam of the deck.
    fn taper(&mut self, index: usize, added: f64) -> u32 {
        let key = (index, added.to_bits());
        if let Some(made) = self.tapers.find(&key) {
            return made;
        }
        let mut stations = self.cards.tapers.get(index).cloned().unwrap_or_default();
        for station in &mut stations {
            let own = &mut station.section.mass_per_length;
            *own = (*own + added) * self.mass_scale;
        }
        self.tapers.add(key, stations)
    }

    /// The section of a laminate of the deck, with its layers.
    fn laminate(
        &mut self,
        index: usize,
        card: &PropertyCard,
        added: f64,
    ) -> Result<Section, FileProblem> {
        let Some(laminate) = self.cards.laminates.get(index) else {
            return Ok(Section::Solid); // never: indices come from the list
        };
        let made = match self.laminates.find(&index) {
            Some(made) => made,
            None => {
                let mut layers = Vec::with_capacity(laminate.layers.len());
                for (id, thickness, degrees) in &laminate.layers {
                    layers.push(Layer {
                        material: self.material(*id, card, Use::Sheet)?,
                        thickness: *thickness,
                        angle: degrees.to_radians(),
                    });
                }
                self.laminates.add(index, layers)
            }
        };
        Ok(Section::Shell(ShellSection {
            mass_per_area: (laminate.mass_per_area + added) * self.mass_scale,
            layup: Layup::Layers(made),
            ..ShellSection::plate(laminate.thickness())
        }))
    }

    /// The thickness of a shell's property, the distance of its middle surface from its reference plane, and
    /// whether elements may have thicknesses of their own.
    pub fn plate(&self, id: u64) -> (Option<f64>, f64, bool) {
        let card = self.cards.properties.get(&(Family::Shell, id));
        match card.map(|card| card.kind) {
            Some(Kind::Shell(plate)) => (plate.thickness, 0.0, true),
            Some(Kind::Laminate(index)) => {
                let laminate = self.cards.laminates.get(index);
                let offset = laminate.map_or(0.0, |laminate| laminate.offset);
                (laminate.map(LaminateCard::thickness), offset, false)
            }
            _ => (None, 0.0, true),
        }
    }

    /// Whether a property has axes: an isotropic one has none.
    pub fn is_directed(&self, property: u32) -> bool {
        let property = self.properties.all.get(property as usize);
        let materials = property.map(|property| property.materials(&self.laminates.all));
        materials.into_iter().flatten().any(|index| {
            let material = self.materials.all.get(index as usize);
            material.is_some_and(|material| material.sheet.is_some())
        })
    }

    /// Index of the material of a property. A line uses E and G separately, so any NU is valid for it.
    fn material(&mut self, id: u64, user: &PropertyCard, usage: Use) -> Result<u32, FileProblem> {
        let Some(card) = self.cards.materials.get(&id) else {
            return Err(user.at.problem(
                format!("{} uses material {id}, which is missing", user.name),
                "add its MAT1 card, or INCLUDE the file that holds it",
            ));
        };
        if let Constants::Solid(own) = &card.constants {
            return self.anisotropic(id, own, user);
        }
        let line = matches!(user.kind, Kind::Line(_) | Kind::Tapered(_));
        let (young, poisson, density, sheet, form) = match (&card.constants, usage) {
            (Constants::Isotropic([young, poisson, density], shear), _) => {
                let (young, stated, density) = (*young, *poisson, *density);
                // a choice: constants of one isotropic material are rounded to two or three digits; beyond a
                // per cent the card means another law
                let odd = shear.filter(|g| (young - 2.0 * (1.0 + stated) * g).abs() > 0.01 * young);
                let sheet = odd.and_then(|shear| {
                    SheetElasticity::orthotropic([young, young, stated, shear], [shear, shear])
                });
                match (shear, usage) {
                    (Some(shear), Use::Body) if line => (
                        young,
                        young / (2.0 * shear) - 1.0,
                        density,
                        None,
                        Form::Shear,
                    ),
                    (_, Use::Sheet | Use::Across) if sheet.is_some() => {
                        (young, stated, density, sheet, Form::Sheet)
                    }
                    _ => {
                        if odd.is_some() {
                            self.note_shear(ODD_SHEAR, user);
                        }
                        (young, stated, density, None, Form::Stated)
                    }
                }
            }
            (Constants::Stretch([young, density]), _) => {
                if !line {
                    self.note_shear(NO_SHEAR, user);
                }
                (*young, 0.0, *density, None, Form::Stated)
            }
            (Constants::Sheet(own), Use::Sheet) => {
                let sheet = Some(own.plane);
                (own.young, own.poisson, own.density, sheet, Form::Stated)
            }
            (Constants::Sheet(own), Use::Across) => {
                let sheet = Some(own.across);
                (own.young, own.poisson, own.density, sheet, Form::Across)
            }
            _ => {
                return Err(card.at.problem(
                    format!("{}, used by {}, is not isotropic", card.name, user.name),
                    "use MAT1, for shells MAT2 or MAT8, for solids MAT9 or MAT11; otherwise read the matrices of the other code",
                ));
            }
        };
        // the constants of a sheet are checked by its card
        let solid = poisson > -1.0 && (poisson < 0.5 || line);
        let elastic = young >= 0.0 && (solid || sheet.is_some());
        if !(elastic && density >= 0.0) {
            return Err(card.at.problem(
                format!(
                    "{}, used by {}: no elastic material has E = {young}, NU = {poisson} and RHO = {density:?}",
                    card.name, user.name
                ),
                "E and RHO must not be negative, and NU must lie between -1 and 0.5; a blank NU is E/(2 G) - 1",
            ));
        }
        let by = (id, form);
        if let Some(index) = self.materials.find(&by) {
            return Ok(index);
        }
        let material = Material {
            name: id.to_string(),
            young,
            poisson,
            density: density * self.mass_scale,
            sheet,
            solid: None,
        };
        Ok(self.materials.add(by, material))
    }

    /// Index of an anisotropic material in the axes of a solid's property.
    fn anisotropic(
        &mut self,
        id: u64,
        own: &SolidConstants,
        user: &PropertyCard,
    ) -> Result<u32, FileProblem> {
        let card = self.cards.materials.get(&id);
        let (at, name) = card.map_or((&user.at, ""), |card| (&card.at, card.name.as_str()));
        let Kind::Solid(_, axes) = user.kind else {
            return Err(at.problem(
                format!("{name}, used by {}, is only for solids", user.name),
                "use MAT1, or for shells MAT2 or MAT8",
            ));
        };
        let placed = axes.placed(user, self.systems)?;
        self.axes_told.note(axes, &placed, user);
        let by = (id, Form::InSystem(axes.system()));
        if let Some(index) = self.materials.find(&by) {
            return Ok(index);
        }
        let solid = SolidElasticity {
            stiffness: own.stiffness,
            axes: placed,
        };
        if let Some(fault) = solid.fault() {
            return Err(at.problem(
                format!("{name}, used by {}, has {fault}", user.name),
                "check its constants, and the order of its fields",
            ));
        }
        if own.density.is_nan() || own.density < 0.0 {
            return Err(at.problem(
                format!("{name}, used by {}, has RHO = {:?}", user.name, own.density),
                "give a density that is not negative",
            ));
        }
        let [young, poisson] = solid.first_constants();
        let material = Material {
            name: id.to_string(),
            young,
            poisson,
            density: own.density * self.mass_scale,
            sheet: None,
            solid: Some(solid),
        };
        Ok(self.materials.add(by, material))
    }
}
