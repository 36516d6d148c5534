//! Properties and materials: `PSOLID`, `PSHELL`, `PBAR`, `PBARL`, `PBEAM`, `PBEAML`, `PROD`, `PTUBE`, `PCOMP`,
//! `PCOMPG`, `MAT1`, `MAT2`, `MAT8`, `MAT9`, `MAT11`.

mod anisotropic;
mod used;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use super::card::Card;
use super::elements::Family;
use super::lines::At;
use super::plates::{LaminateCard, PlateCard, SheetConstants};
use super::shapes;
use super::unread::UnreadCards;
use crate::error::FileProblem;
use crate::mesh::{BeamSection, Carries, Station, Variant};

use anisotropic::{Axes, SolidConstants};
pub(super) use used::UsedProperties;

/// A rod: only area, torsion constant and added mass per length.
pub(super) fn rod(area: f64, torsion: f64, mass_per_length: f64) -> BeamSection {
    BeamSection {
        area,
        torsion,
        mass_per_length,
        ..BeamSection::default()
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A solid, and the axes of its material.
    Solid(Variant, Axes),
    Shell(PlateCard),
    /// A laminate: index into the deck's.
    Laminate(usize),
    Line(BeamSection),
    /// A tapered beam: index into the deck's.
    Tapered(usize),
    /// A property that can't be expressed.
    Unreadable,
}

/// A property card.
#[derive(Clone, Debug)]
pub(super) struct PropertyCard {
    /// `PSOLID 3`.
    name: String,
    material: Option<u64>,
    kind: Kind,
    at: At,
}

impl PropertyCard {
    /// A property of a rod with its own section.
    pub fn line(name: String, material: u64, section: BeamSection, at: &At) -> Self {
        PropertyCard {
            name,
            material: Some(material),
            kind: Kind::Line(section),
            at: at.clone(),
        }
    }
}

#[derive(Clone, Debug)]
enum Constants {
    /// Young's modulus, Poisson's ratio, density, and the shear modulus if the card states all three.
    Isotropic([f64; 3], Option<f64>),
    /// Young's modulus and density of a card without G and NU: both are zero.
    Stretch([f64; 2]),
    /// The constants of a sheet.
    Sheet(Box<SheetConstants>),
    /// Those of an anisotropic solid.
    Solid(Box<SolidConstants>),
    /// A material that can't be expressed.
    Unreadable,
}

/// A material card.
#[derive(Clone, Debug)]
struct MaterialCard {
    constants: Constants,
    name: String,
    at: At,
}

/// Property and material cards of a deck.
#[derive(Debug, Default)]
pub(super) struct Properties {
    properties: BTreeMap<(Family, u64), PropertyCard>,
    laminates: Vec<LaminateCard>,
    tapers: Vec<Vec<Station>>,
    materials: BTreeMap<u64, MaterialCard>,
    /// N1 and N2 of `PBEAM`: from the shear centre to the neutral axis.
    neutral: BTreeMap<u64, [f64; 2]>,
    /// `PBEAM` whose added mass is beside its nodes (M1, M2).
    beside: BTreeSet<u64>,
}

impl Properties {
    fn insert(
        &mut self,
        card: &Card,
        family: Family,
        material: Option<u64>,
        kind: Kind,
    ) -> Result<(), FileProblem> {
        let id = card.id(0, "PID")?;
        let property = PropertyCard {
            name: format!("{} {id}", card.name),
            material,
            kind,
            at: card.at.clone(),
        };
        match self.properties.insert((family, id), property) {
            Some(first) => Err(card.at.problem(
                format!(
                    "{} {id}: this property is defined twice, first by {} in {}, line {}",
                    card.name, first.name, first.at.file, first.at.line
                ),
                "renumber or remove one of them",
            )),
            None => Ok(()),
        }
    }

    /// From the shear centre of a beam to its neutral axis, along y and z.
    pub fn neutral(&self, family: Family, id: u64) -> [f64; 2] {
        match family {
            Family::Beam => self.neutral.get(&id).copied().unwrap_or_default(),
            _ => [0.0; 2],
        }
    }

    /// Whether a beam has a place for added mass that Eng does not know: beside the shear centre.
    pub fn has_place_of_mass(&self, family: Family, id: u64) -> bool {
        family == Family::Beam && (self.neutral.contains_key(&id) || self.beside.contains(&id))
    }

    /// The name of the card of a property, without the letters of its form: `PBARL` is `PBAR`, laminates are `PSHELL`.
    pub fn group(&self, family: Family, id: u64) -> Option<&'static str> {
        let name = self.properties.get(&(family, id))?.name.as_str();
        let groups = [
            ("PSHELL", "PSHELL"),
            ("PCOMP", "PSHELL"),
            ("PBAR", "PBAR"),
            ("PBEAM", "PBEAM"),
            ("PROD", "PROD"),
            ("PTUBE", "PTUBE"),
        ];
        let found = groups
            .into_iter()
            .find(|(begin, _)| name.starts_with(begin));
        found.map(|(_, group)| group)
    }

    /// The integration of the solids of a property.
    pub fn variant(&self, family: Family, id: u64) -> Variant {
        match self.properties.get(&(family, id)).map(|card| card.kind) {
            Some(Kind::Solid(variant, _)) => variant,
            _ => Variant::Plain,
        }
    }

    /// Young's modulus, Poisson's ratio, shear modulus and density of the material of a shear panel.
    pub fn shear_of(&self, id: u64, user: &At) -> Result<[f64; 4], FileProblem> {
        let no_shear = || {
            user.problem(
                format!("the shear panel's material {id} has no positive shear modulus, or a negative density"),
                "give E and NU, or G, above zero in its MAT1",
            )
        };
        match self.materials.get(&id).map(|card| &card.constants) {
            Some(Constants::Isotropic([young, poisson, density], own)) => {
                let shear = own.unwrap_or(young / (2.0 * (1.0 + poisson)));
                if shear > 0.0 && *poisson > -1.0 && *density >= 0.0 {
                    return Ok([*young, *poisson, shear, *density]);
                }
                Err(no_shear())
            }
            Some(Constants::Stretch(_)) => Err(no_shear()),
            Some(_) => Err(user.problem(
                format!("the shear panel's material {id} is not isotropic"),
                "use MAT1",
            )),
            None => Err(user.problem(
                format!("the shear panel's material {id} is missing"),
                "add its MAT1 card, or INCLUDE the file that holds it",
            )),
        }
    }

    /// Reads a property or material card; `false` for an unknown one.
    pub fn read(&mut self, card: &Card, unread: &mut UnreadCards) -> Result<bool, FileProblem> {
        match card.name.as_str() {
            "PSOLID" => self.solid(card)?,
            "PSHELL" => {
                let (material, plate) = PlateCard::read(card, unread)?;
                self.insert(card, Family::Shell, material, Kind::Shell(plate))?;
            }
            "PBAR" => self.bar(card)?,
            "PBARL" => self.bar_shape(card)?,
            "PBEAM" => self.beam(card, unread)?,
            "PBEAML" => self.beam_shape(card, unread)?,
            "PROD" => {
                let section = rod(
                    card.real_or_zero(2, "A")?,
                    card.real_or_zero(3, "J")?,
                    card.real_or_zero(5, "NSM")?,
                );
                let material = card.id(1, "MID")?;
                self.insert(card, Family::Rod, Some(material), Kind::Line(section))?;
            }
            "PTUBE" => self.tube(card)?,
            "MAT1" => self.isotropic(card)?,
            // an unread property is an error only if an element uses it
            "PLSOLID" | "PCOMPS" => {
                self.insert(card, Family::Solid, None, Kind::Unreadable)?;
            }
            "PBRSECT" | "PBMSECT" | "PBCOMP" => {
                self.insert(card, Family::Beam, None, Kind::Unreadable)?;
            }
            "PCOMP" | "PCOMPG" => {
                let laminate = LaminateCard::read(card, unread)?;
                let material = laminate.layers.first().map(|(material, ..)| *material);
                let kind = Kind::Laminate(self.laminates.len());
                self.laminates.push(laminate);
                self.insert(card, Family::Shell, material, kind)?;
            }
            "MAT2" => {
                let sheet = SheetConstants::anisotropic(card)?;
                self.material(card, Constants::Sheet(Box::new(sheet)))?;
            }
            "MAT8" => {
                let sheet = SheetConstants::orthotropic(card)?;
                self.material(card, Constants::Sheet(Box::new(sheet)))?;
            }
            "MAT9" => {
                let solid = SolidConstants::anisotropic(card)?;
                self.material(card, Constants::Solid(Box::new(solid)))?;
            }
            "MAT11" => {
                let solid = SolidConstants::orthotropic(card)?;
                self.material(card, Constants::Solid(Box::new(solid)))?;
            }
            "MAT3" | "MAT10" | "MATHE" | "MATORT" => {
                self.material(card, Constants::Unreadable)?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// `PSOLID PID MID CORDM IN STRESS ISOP FCTN`.
    fn solid(&mut self, card: &Card) -> Result<(), FileProblem> {
        let kind = match card.text(6) {
            "PFLUID" | "FFLUID" => Kind::Unreadable,
            _ => Kind::Solid(network(card)?, Axes::read(card)),
        };
        let material = card.id(1, "MID")?;
        self.insert(card, Family::Solid, Some(material), kind)
    }

    /// `PBAR PID MID A I1 I2 J NSM / C1…F2 / K1 K2 I12`. Blank shear factors: no shear flexibility.
    fn bar(&mut self, card: &Card) -> Result<(), FileProblem> {
        let section = BeamSection {
            area: card.real_or_zero(2, "A")?,
            moment_z: card.real_or_zero(3, "I1")?,
            moment_y: card.real_or_zero(4, "I2")?,
            torsion: card.real_or_zero(5, "J")?,
            mass_per_length: card.real_or_zero(6, "NSM")?,
            shear: [card.real_or_zero(16, "K1")?, card.real_or_zero(17, "K2")?],
            product: card.real_or_zero(18, "I12")?,
        };
        let material = card.id(1, "MID")?;
        self.insert(card, Family::Beam, Some(material), Kind::Line(section))
    }

    /// `PBARL PID MID GROUP TYPE / DIM1 … NSM`.
    fn bar_shape(&mut self, card: &Card) -> Result<(), FileProblem> {
        let material = card.id(1, "MID")?;
        let kind = match shapes::dimension_count(card.text(3)) {
            Some(count) => Kind::Line(shaped(card, 8, count)?),
            None => Kind::Unreadable,
        };
        self.insert(card, Family::Beam, Some(material), kind)
    }

    /// The kind of a beam with its sections at both ends and between them. Equal ones make a uniform beam.
    fn tapered(&mut self, card: &Card, mut stations: Vec<Station>) -> Result<Kind, FileProblem> {
        stations.sort_by(|a, b| a.place.total_cmp(&b.place));
        let (Some(first), Some(last)) = (stations.first(), stations.last()) else {
            return Ok(Kind::Unreadable); // never: end A is a station
        };
        if stations.len() > 1 && last.place != 1.0 {
            return Err(card.problem(
                &format!("the last station is at X/XB = {}", last.place),
                "state the section of end B, with X/XB = 1.0",
            ));
        }
        if let Some(pair) = stations
            .windows(2)
            .find(|pair| pair[0].place == pair[1].place)
        {
            return Err(card.problem(
                &format!("two stations are at X/XB = {}", pair[0].place),
                "give each station a place of its own above 0, and end B the place 1.0",
            ));
        }
        if stations
            .iter()
            .all(|station| station.section == first.section)
        {
            return Ok(Kind::Line(first.section));
        }
        self.tapers.push(stations);
        Ok(Kind::Tapered(self.tapers.len() - 1))
    }

    /// `PBEAML PID MID GROUP TYPE / DIM1 … NSM [SO X/XB DIM1 … NSM]…`. The nodes of a CBEAM lie at the shear
    /// centre. A section whose centroid is beside it is listed.
    fn beam_shape(&mut self, card: &Card, unread: &mut UnreadCards) -> Result<(), FileProblem> {
        let material = card.id(1, "MID")?;
        let kind = match shapes::dimension_count(card.text(3)) {
            Some(count) => {
                let mut stations = vec![Station {
                    place: 0.0,
                    section: shaped(card, 8, count)?,
                }];
                let mut at = 8 + count + 1;
                while card.text(at).starts_with(['Y', 'N']) {
                    let station = at + 2;
                    if (station..station + count).any(|i| !card.is_blank(i)) {
                        stations.push(Station {
                            place: card.optional_real(at + 1, "X/XB")?.unwrap_or(1.0),
                            section: shaped(card, station, count)?,
                        });
                    }
                    at = station + count + 1;
                }
                let dimensions = (0..count)
                    .map(|i| card.real(8 + i, "DIM"))
                    .collect::<Result<Vec<_>, _>>()?;
                if !shapes::is_centred(card.text(3), &dimensions) {
                    let name = "PBEAML with its shear centre beside its centroid";
                    unread.note(name, &card.at, Carries::Structure);
                }
                self.tapered(card, stations)?
            }
            None => Kind::Unreadable,
        };
        self.insert(card, Family::Beam, Some(material), kind)
    }

    /// `PBEAM PID MID A I1 I2 I12 J NSM / C1…F2 / [SO X/XB A I1 I2 I12 J NSM / C1…F2]… / K1 K2 S1 S2 NSI(A)
    /// NSI(B) CW(A) CW(B) / M1(A) M2(A) M1(B) M2(B) N1(A) N2(A) N1(B) N2(B)`. Blank shear factors are 1. N1 and
    /// N2 lead from the shear centre, where the ends are, to the neutral axis (y, z). Added mass has a place of
    /// its own, M1 and M2. S1 and S2 relieve the shear of tapers alone. CW acts between the scalar points SA and
    /// SB of `CBEAM`; without these a beam twists freely.
    fn beam(&mut self, card: &Card, unread: &mut UnreadCards) -> Result<(), FileProblem> {
        let material = card.id(1, "MID")?;
        card.real(2, "A")?;
        let (mut stations, line) = stations(card)?;
        let shear = [
            card.optional_real(line, "K1")?.unwrap_or(1.0),
            card.optional_real(line + 1, "K2")?.unwrap_or(1.0),
        ];
        for station in &mut stations {
            station.section.shear = shear;
        }
        let mut last = [0.0; 14];
        for (i, value) in last.iter_mut().enumerate() {
            *value = card.real_or_zero(line + 2 + i, "S1…N2(B)")?;
        }
        let [
            s1,
            s2,
            inertia,
            inertia_b,
            _,
            _,
            places @ ..,
            n1,
            n2,
            n1_b,
            n2_b,
        ] = last;
        let alike =
            (n1 == n1_b || card.is_blank(line + 14)) && (n2 == n2_b || card.is_blank(line + 15));
        let beside = [n1, n2] != [0.0; 2];
        let massive = places.iter().any(|x| *x != 0.0);
        let heavy = stations
            .iter()
            .any(|station| station.section.mass_per_length != 0.0);
        let kind = self.tapered(card, stations)?;
        let relieved = [s1, s2] != [0.0; 2] && matches!(kind, Kind::Tapered(_));
        if relieved || [inertia, inertia_b] != [0.0; 2] || !alike || ((beside || massive) && heavy)
        {
            let name = "PBEAM with S1, S2, NSI, or an axis or added mass beside its nodes";
            unread.note(name, &card.at, Carries::Structure);
        }
        if massive {
            self.beside.insert(card.id(0, "PID")?);
        }
        if beside {
            self.neutral.insert(card.id(0, "PID")?, [n1, n2]);
        }
        self.insert(card, Family::Beam, Some(material), kind)
    }

    /// `PTUBE PID MID OD T NSM OD2`: a blank or zero wall is a solid bar.
    fn tube(&mut self, card: &Card) -> Result<(), FileProblem> {
        let material = card.id(1, "MID")?;
        let outer = 0.5 * card.real(2, "OD")?;
        let wall = card.real_or_zero(3, "T")?;
        let inner = if wall == 0.0 { 0.0 } else { outer - wall };
        if !(0.0..outer).contains(&inner) {
            return Err(card.problem(
                "OD and T make no tube",
                "the outer diameter OD must be above zero, and the wall T at most OD/2; for a solid bar, leave T blank",
            ));
        }
        let (o, i) = (outer * outer, inner * inner);
        let section = rod(
            PI * (o - i),
            0.5 * PI * (o * o - i * i),
            card.real_or_zero(4, "NSM")?,
        );
        self.insert(card, Family::Rod, Some(material), Kind::Line(section))
    }

    /// `MAT1 MID E G NU RHO`. Of E, G and ν one may be blank: E = 2 (1 + ν) G. If all are stated, G resists the
    /// shear of lines and shells, whatever E and ν. If G and ν are blank, both are zero: lines have no stiffness in
    /// torsion (MSC Nastran, Quick Reference Guide, MAT1).
    fn isotropic(&mut self, card: &Card) -> Result<(), FileProblem> {
        let young = card.optional_real(1, "E")?;
        let shear = card.optional_real(2, "G")?;
        let poisson = card.optional_real(3, "NU")?;
        let density = card.real_or_zero(4, "RHO")?;
        let own = shear.filter(|shear| *shear > 0.0 && young.is_some() && poisson.is_some());
        let (young, poisson) = match (young, shear, poisson) {
            (Some(young), _, Some(poisson)) => (young, poisson),
            (None, Some(shear), Some(poisson)) => (2.0 * (1.0 + poisson) * shear, poisson),
            (Some(young), Some(shear), None) if shear != 0.0 => {
                (young, young / (2.0 * shear) - 1.0)
            }
            (Some(young), _, None) => {
                return self.material(card, Constants::Stretch([young, density]));
            }
            _ => {
                return Err(card.problem(
                    "E is blank, and so is G or NU",
                    "two of E, G and NU are needed: give E and NU",
                ));
            }
        };
        self.material(card, Constants::Isotropic([young, poisson, density], own))
    }

    fn material(&mut self, card: &Card, constants: Constants) -> Result<(), FileProblem> {
        let id = card.id(0, "MID")?;
        let material = MaterialCard {
            constants,
            name: format!("{} {id}", card.name),
            at: card.at.clone(),
        };
        match self.materials.insert(id, material) {
            Some(first) => Err(card.at.problem(
                format!(
                    "{} {id}: this material is defined twice, first by {} in {}, line {}",
                    card.name, first.name, first.at.file, first.at.line
                ),
                "renumber or remove one of them",
            )),
            None => Ok(()),
        }
    }
}

/// The stations of a `PBEAM` in the order of the card, and the field of K1. A blank field of end B is that of end A, one
/// between the ends is linear between both (MSC Nastran, Quick Reference Guide, PBEAM, remark 7).
fn stations(card: &Card) -> Result<(Vec<Station>, usize), FileProblem> {
    let fields = |line: usize| {
        let mut values = [None; 6];
        for (i, (value, name)) in values
            .iter_mut()
            .zip(["A", "I1", "I2", "I12", "J", "NSM"])
            .enumerate()
        {
            *value = card.optional_real(line + 2 + i, name)?;
        }
        Ok::<_, FileProblem>(values)
    };
    let first = fields(0)?.map(|value| value.unwrap_or(0.0));
    let is_station = |line: usize| matches!(card.text(line), "YES" | "YESA" | "NO");
    let mut line = if is_station(8) { 8 } else { 16 };
    let mut stated = vec![(0.0, first.map(Some))];
    while is_station(line) {
        let place = card.optional_real(line + 1, "X/XB")?.unwrap_or(1.0);
        stated.push((place, fields(line)?));
        line += if card.text(line) == "YES" { 16 } else { 8 };
    }
    let end = stated.iter().find(|(place, _)| *place == 1.0);
    let last = end.map_or(first, |(_, values)| {
        [0, 1, 2, 3, 4, 5].map(|i: usize| values[i].unwrap_or(first[i]))
    });
    let stations = stated.into_iter().map(|(place, values)| {
        let [area, moment_z, moment_y, product, torsion, mass_per_length] = [0, 1, 2, 3, 4, 5]
            .map(|i: usize| values[i].unwrap_or(first[i] + place * (last[i] - first[i])));
        Station {
            place,
            section: BeamSection {
                area,
                moment_z,
                moment_y,
                product,
                torsion,
                shear: [1.0; 2],
                mass_per_length,
            },
        }
    });
    Ok((stations.collect(), line))
}

/// `IN` and `ISOP` of `PSOLID`: blank or 0 is the default of both.
fn network(card: &Card) -> Result<Variant, FileProblem> {
    let points = match card.text(3) {
        "" | "0" | "1" | "BUBBLE" => 0,
        "2" | "TWO" => 2,
        "3" | "THREE" => 3,
        other => {
            return Err(card.problem(
                &format!("IN is \"{other}\", which is no rule of integration"),
                "write BUBBLE, TWO or THREE, or leave the field blank",
            ));
        }
    };
    let full = match card.text(5) {
        "" | "0" | "REDUCED" => false,
        "1" | "FULL" => true,
        other => {
            return Err(card.problem(
                &format!("ISOP is \"{other}\", which is no rule of integration"),
                "write REDUCED or FULL, or leave the field blank",
            ));
        }
    };
    Ok(match (points, full) {
        (0, false) => Variant::Plain,
        _ => Variant::Network { points, full },
    })
}

/// Dimensions and added mass from field `from`.
fn shaped(card: &Card, from: usize, count: usize) -> Result<BeamSection, FileProblem> {
    let mut dimensions = Vec::with_capacity(count);
    for i in 0..count {
        dimensions.push(card.real(from + i, &format!("DIM{}", i + 1))?);
    }
    let mass = card.real_or_zero(from + count, "NSM")?;
    let shape = card.text(3);
    match shapes::section(shape, &dimensions) {
        Some(section) => Ok(BeamSection {
            mass_per_length: mass,
            ..section
        }),
        None => Err(card.problem(
            &format!("no {shape} has the dimensions {dimensions:?}"),
            "compare the dimensions with the drawing of the shape; walls must fit into the section, and no dimension may be negative",
        )),
    }
}
