//! Properties and materials: `PSOLID`, `PSHELL`, `PBAR`, `PBARL`, `PBEAM`, `PBEAML`, `PROD`, `PTUBE`, `PCOMP`,
//! `PCOMPG`, `MAT1`, `MAT2`, `MAT8`.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use super::card::Card;
use super::elements::Family;
use super::lines::At;
use super::plates::{LaminateCard, PlateCard, SheetConstants};
use super::shapes;
use super::unread::UnreadCards;
use crate::error::FileProblem;
use crate::mesh::{
    BeamSection, Carries, Layer, Layup, Material, Property, Section, SheetElasticity, ShellSection,
    Station, Variant,
};
use crate::read::builder::Once;

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
    Solid(Variant),
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
    /// A material that can't be expressed.
    Unreadable,
}

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
pub(super) enum Form {
    /// As its card states it.
    Stated,
    /// `MAT1` of a line: G counts, and NU is E/(2 G) − 1.
    Shear,
    /// `MAT1` of a sheet with its own G.
    Sheet,
    /// `MAT2` or `MAT8` of the shear across a shell.
    Across,
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
            Some(Kind::Solid(variant)) => variant,
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
            "MAT3" | "MAT9" | "MAT10" | "MAT11" | "MATHE" | "MATORT" => {
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
            _ => Kind::Solid(network(card)?),
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

/// The name of a material whose G is not that of an isotropic solid.
const ODD_SHEAR: &str = "MAT1 of solids with G other than E/(2 (1+NU))";

/// The name of a material without G and NU of anything but a line that only stretches and bends.
const NO_SHEAR: &str = "MAT1 without G and NU of solids, shells or beams with shear";

/// Properties and materials of a mesh, each made when an element first uses it.
pub(super) struct Made<'d> {
    cards: &'d Properties,
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
}

impl<'d> Made<'d> {
    /// Begins without properties and materials. `mass_scale` multiplies every density and added mass
    /// (`PARAM,WTMASS`).
    pub fn new(cards: &'d Properties, mass_scale: f64) -> Self {
        Made {
            cards,
            mass_scale,
            properties: Once::default(),
            materials: Once::default(),
            odd_shear: Vec::new(),
            laminates: Once::default(),
            tapers: Once::default(),
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
            Kind::Solid(_) => Section::Solid,
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
                    "use MAT1, or for shells MAT2 or MAT8; otherwise read the matrices of the other code",
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
        };
        Ok(self.materials.add(by, material))
    }
}
