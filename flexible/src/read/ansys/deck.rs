//! The contents of an archive by their numbers, before the mesh is made of them.

use std::collections::BTreeMap;

use super::lines::{Command, Lines, real};
use crate::error::FileProblem;
use crate::mesh::{Carries, Frame, Node};
use crate::read::Files;
use crate::read::source::At;
use crate::read::unread::{UnreadCards, carries};
use crate::read::vector::{Rotation, from_axes, product};

/// Commands, by their first four letters, that hold stiffness, mass or a constraint which Eng does not read.
const STRUCTURE: &[&str] = &[
    "CERI", "RBE3", "CEIN", "CECY", "CESG", "CPIN", "CPLG", "CPSG", "CPCY", "CPNG", "DSYM", "PSME",
    "SESY", "EN", "E", "EMOR", "CDRE", "SLOA", "JOIN", "SECF", "SECP", "SECJ", "NROT", "DDEL",
    "DCUM",
];
/// Commands without stiffness, mass and constraints: options of solutions and outputs, loads, damping,
/// temperatures, graphics, selections.
const NOTHING: &[&str] = &[
    "ACEL", "ALLS", "ALPH", "ANTY", "AUTO", "BETA", "BF", "BFBL", "BFE", "BFEB", "BFUN", "BFCU",
    "CGLO", "CGOM", "CM", "CMGR", "CMOM", "CMSE", "CMAC", "CNVT", "CONT", "CRPL", "CSCI", "CSYS",
    "CUTC", "DCGO", "DDOP", "DELT", "DMPO", "DMPR", "DMPS", "DOF", "DOME", "EQSL", "ERES", "ESEL",
    "ESYS", "EXTO", "F", "FBLO", "FCUM", "FDEL", "FINI", "FLST", "HARF", "IRLF", "KBC", "KUSE",
    "LNSR", "LOCA", "LSWR", "LUMP", "M", "MAT", "MDAM", "MODC", "MODO", "MPTE", "MXPA", "NCNV",
    "NDIS", "NEQI", "NLGE", "NLHI", "NROP", "NSEL", "NSUB", "NUMO", "OMEG", "OUTP", "OUTR", "PRED",
    "PSTR", "QRDO", "RATE", "REAL", "RESC", "RESU", "SAVE", "SBCT", "SECN", "SECS", "SF", "SFBE",
    "SFCU", "SFE", "SFEB", "SOLC", "SOLO", "SOLV", "SSTI", "STEF", "TBDA", "TBPT", "TBTE", "TIME",
    "TIMI", "TINT", "THOP", "TOFF", "TREF", "TRNO", "TSHA", "TUNI", "TYPE", "UPCO", "VSEL", "WRIT",
    "XMLO", "/AUX", "/COL", "/CON", "/DEV", "/DIS", "/EOF", "/FIL", "/FOC", "/GO", "/GOP", "/GRA",
    "/NOP", "/NUM", "/OUT", "/POS", "/PRE", "/PNU", "/PSY", "/RGB", "/SOL", "/STA", "/VIE", "/WB",
    "/ANG", "/BAT", "/CLE", "/CWD", "/PBC", "/PSF", "/ESH", "/EDG", "/REP", "/SHO", "/TYP", "/VUP",
    "/AUT", "/DSC", "/INQ", "/CPL", "/ERA", "/FAC",
];
/// Behaviour of materials that vibrations of small amplitude do not show, or that carries no stiffness:
/// plasticity, creep, fatigue, damping.
const BEYOND_ELASTIC: &[&str] = &[
    "BISO", "MISO", "BKIN", "MKIN", "KINH", "CHAB", "PLAS", "CREE", "RATE", "NLIS", "SDAM", "DMGI",
    "DMGE", "FLIM", "CTE", "THER",
];

/// Units that `/UNITS` names: metres, kilograms, seconds of each. The mass of `BFT` is the slug, that of
/// `BIN` is lbf s²/in.
const UNITS: &[(&str, [f64; 3])] = &[
    ("SI", [1.0, 1.0, 1.0]),
    ("MKS", [1.0, 1.0, 1.0]),
    ("UMKS", [1e-6, 1.0, 1.0]),
    ("CGS", [1e-2, 1e-3, 1.0]),
    ("MPA", [1e-3, 1e3, 1.0]),
    ("BFT", [0.3048, 14.593_902_937, 1.0]),
    ("BIN", [0.0254, 175.126_835_246, 1.0]),
];

/// A type of elements: `ET` and `KEYOPT`.
#[derive(Clone, Debug)]
pub(super) struct ElementType {
    /// The number of the element in ANSYS: 186 of SOLID186.
    pub number: u32,
    options: BTreeMap<i64, i64>,
}

impl ElementType {
    /// The value of an option; zero unless stated.
    pub fn option(&self, number: i64) -> i64 {
        self.options.get(&number).copied().unwrap_or(0)
    }
}

/// An element, by numbers of the archive.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub id: u64,
    /// Number of its type (`ET`).
    pub kind: i64,
    pub material: i64,
    /// Number of its set of constants (`R`).
    pub real: i64,
    pub section: i64,
    /// Number of its coordinate system.
    pub system: i64,
    /// Numbers of its nodes, in the order of ANSYS.
    pub nodes: Vec<u64>,
    pub at: At,
}

/// The section of a shell.
#[derive(Clone, Debug)]
pub(super) struct SectionRow {
    pub kind: String,
    /// Thickness, number of the material, angle (degrees), from the lower surface to the upper.
    pub layers: Vec<(f64, i64, f64)>,
    /// The place of the nodes: MID, TOP, BOT.
    pub offset: String,
    pub at: At,
}

/// A named list of nodes or elements.
#[derive(Clone, Debug)]
pub(super) struct Component {
    pub name: String,
    /// Whether it has nodes; else elements.
    pub of_nodes: bool,
    /// First and last numbers.
    pub ranges: Vec<(u64, u64)>,
}

/// A node, freedom 0…5, and a coefficient.
pub(super) type Term = (u64, u8, f64);

/// The contents of an archive.
#[derive(Debug, Default)]
pub(super) struct Deck {
    pub nodes: Vec<Node>,
    pub frames: Vec<Frame>,
    pub types: BTreeMap<i64, ElementType>,
    pub rows: Vec<Row>,
    /// Properties of materials, by their labels.
    pub materials: BTreeMap<i64, BTreeMap<String, f64>>,
    pub reals: BTreeMap<i64, Vec<f64>>,
    pub sections: BTreeMap<i64, SectionRow>,
    pub components: Vec<Component>,
    pub equations: BTreeMap<i64, (Vec<Term>, At)>,
    /// Coupled freedoms.
    pub couplings: BTreeMap<i64, (Vec<u8>, Vec<u64>, At)>,
    /// `D`: node, freedoms as bits, and whether it is moved.
    pub supports: Vec<(u64, u8, bool, At)>,
    pub unread: UnreadCards,
    pub doubts: Vec<String>,
    /// Units that the archive names: the word, and metres, kilograms, seconds of its units.
    pub units: Option<(String, [f64; 3])>,
    /// The last section, set of constants and equation, to which further lines belong.
    section: i64,
    real: i64,
    equation: i64,
}

/// The freedoms of a label as bits; `None` for one without structure, such as TEMP.
fn freedoms(label: &str) -> Option<u8> {
    Some(match label.to_ascii_uppercase().as_str() {
        "UX" => 1,
        "UY" => 2,
        "UZ" => 4,
        "ROTX" => 8,
        "ROTY" => 16,
        "ROTZ" => 32,
        "ALL" => 63,
        _ => return None,
    })
}

/// The rotation node → global of `THXY, THYZ, THZX` (degrees): about z, then about the turned x, then about
/// the turned y (ANSYS Commands Reference, `N`).
fn turned(angles: [f64; 3]) -> Rotation {
    let [z, x, y] = angles.map(|angle| libm::sincos(angle.to_radians()));
    let about_z = from_axes([z.1, z.0, 0.0], [-z.0, z.1, 0.0], [0.0, 0.0, 1.0]);
    let about_x = from_axes([1.0, 0.0, 0.0], [0.0, x.1, x.0], [0.0, -x.0, x.1]);
    let about_y = from_axes([y.1, 0.0, -y.0], [0.0, 1.0, 0.0], [y.0, 0.0, y.1]);
    product(&product(&about_z, &about_x), &about_y)
}

impl Deck {
    /// Reads an archive.
    pub fn read(files: &dyn Files, name: &str) -> Result<Deck, FileProblem> {
        let mut lines = Lines::open(files, name)?;
        let mut deck = Deck::default();
        while let Some(command) = lines.command()? {
            deck.take(&command, &mut lines)?;
        }
        Ok(deck)
    }

    /// An option of the type of an element; zero unless stated.
    pub fn option(&self, row: &Row, number: i64) -> i64 {
        let kind = self.types.get(&row.kind);
        kind.map_or(0, |kind| kind.option(number))
    }

    fn take(&mut self, command: &Command, lines: &mut Lines) -> Result<(), FileProblem> {
        match command.key() {
            "NBLO" => self.nodes(command, lines),
            "EBLO" => self.elements(command, lines),
            "ETBL" => self.types(command, lines),
            "CMBL" => self.component(command, lines),
            "RLBL" => self.constants(command, lines),
            "SECB" => self.layers(command, lines),
            "N" => match ["-1", "LOC"].contains(&command.text(1)) || command.text(2) == "-1" {
                true => Ok(()),
                false => Err(command.problem(
                    "Eng reads nodes in blocks alone",
                    "write the archive by CDWRITE with its blocked format (NBLOCK, EBLOCK)",
                )),
            },
            // the end of the elements in the form without blocks
            "EN" if command.text(1) == "ATTR" => Ok(()),
            "ET" => self.element_type(command),
            "KEYO" => self.set_option(command),
            "R" | "RMOR" | "RMOD" => self.constant(command),
            "SECT" => self.section(command),
            "SECD" => self.layer(command),
            "SECO" => {
                if let Some(section) = self.sections.get_mut(&self.section) {
                    section.offset = command.text(0).to_ascii_uppercase();
                }
                Ok(())
            }
            "SECC" => {
                // stiffness across the plate, drilling, and added mass, if stated
                let values = (0..command.len()).map(|i| command.real(i, "a value"));
                let stated = values.collect::<Result<Vec<f64>, _>>()?;
                let carries = match stated.iter().any(|value| *value != 0.0) {
                    true => Carries::Structure,
                    false => Carries::Nothing,
                };
                self.unread.note(&command.name, &command.at, carries);
                Ok(())
            }
            "MP" | "MPDA" => self.material(command),
            "TB" => {
                let behaviour = command.text(0).to_ascii_uppercase();
                let behaviour = behaviour.get(..4).unwrap_or(&behaviour);
                let carries = match BEYOND_ELASTIC.contains(&behaviour) {
                    true => Carries::Nothing,
                    false => Carries::Structure,
                };
                self.unread
                    .note(&format!("TB,{behaviour}"), &command.at, carries);
                Ok(())
            }
            "CE" => self.equation(command),
            "CP" => self.coupling(command),
            "D" => self.support(command),
            "/UNI" => {
                let word = command.text(0).to_ascii_uppercase();
                let found = UNITS.iter().find(|(known, _)| *known == word);
                self.units = found.map(|(_, units)| (word, *units));
                Ok(())
            }
            "*IF" | "*ELS" | "*END" => {
                // CDWRITE itself begins an archive with these lines
                if command.name == "*IF" && command.text(0) != "_CDRDOFF" {
                    self.unread.note("*IF", &command.at, Carries::Unknown);
                }
                Ok(())
            }
            key => {
                let carries = carries(key, STRUCTURE, NOTHING);
                if command.name == "LUMPM" && command.text(0).eq_ignore_ascii_case("ON") {
                    self.doubts.push(
                        "LUMPM,ON: the archive requests lumped masses, and Eng takes the mass of the shape functions".into(),
                    );
                }
                self.unread.note(&command.name, &command.at, carries);
                Ok(())
            }
        }
    }

    /// `NBLOCK, NUMFIELD, Solkey, NDMAX, NDSEL`: number, two numbers of the solid model, x, y, z, three
    /// angles. The short form has the number and x, y, z.
    fn nodes(&mut self, command: &Command, lines: &mut Lines) -> Result<(), FileProblem> {
        let columns = lines.columns(command)?;
        let stated = command.integer(3, "the number of nodes")?;
        let before = self.nodes.len();
        while let Ok((text, at)) = lines.data()? {
            let fields = columns.split(&text);
            let number = fields.first().and_then(|field| field.parse::<u64>().ok());
            let Some(id) = number.filter(|id| *id > 0) else {
                return Err(at.problem(
                    "NBLOCK: the number of the node is missing in the columns of this block",
                    "write the archive again by CDWRITE; columns must keep their width",
                ));
            };
            let mut values = [0.0; 6];
            for (value, field) in values.iter_mut().zip(fields.iter().skip(columns.integers)) {
                *value = real(field, "a coordinate or angle", &at)?;
            }
            let [x, y, z, angles @ ..] = values;
            let frame = (angles != [0.0; 3]).then(|| {
                self.frames.push(Frame {
                    rotation: turned(angles),
                });
                self.frames.len() as u32 - 1 // never more than nodes
            });
            if u32::try_from(self.nodes.len()).is_err() {
                return Err(at.problem("more than 4e9 nodes", "divide the model"));
            }
            self.nodes.push(Node {
                id,
                position: [x, y, z],
                frame,
            });
        }
        let read = (self.nodes.len() - before) as i64; // a count of lines
        complete(command, "nodes", stated, read)
    }

    /// `EBLOCK, 19, SOLID, , count`: material, type, constants, section, coordinate system, three numbers,
    /// the shape flag, the number of nodes, one number, the element, its nodes. Further nodes follow on a
    /// line of their own.
    fn elements(&mut self, command: &Command, lines: &mut Lines) -> Result<(), FileProblem> {
        if !command.text(1).eq_ignore_ascii_case("SOLID") {
            return Err(command.problem(
                "Eng reads elements in the form SOLID alone, which states type and material of each one",
                "write the archive by CDWRITE in ANSYS (EBLOCK,19,SOLID)",
            ));
        }
        let columns = lines.columns(command)?;
        let stated = command.integer(3, "the number of elements")?;
        let before = self.rows.len();
        let closed = loop {
            let (text, at) = match lines.data()? {
                Ok(line) => line,
                Err(closed) => break closed,
            };
            let numbers = columns.integers(&text, &at)?;
            let [
                material,
                kind,
                real,
                section,
                system,
                _,
                _,
                _,
                count,
                _,
                id,
                nodes @ ..,
            ] = numbers.as_slice()
            else {
                return Err(at.problem(
                    format!(
                        "EBLOCK: an element has {} of its first 11 numbers",
                        numbers.len()
                    ),
                    "write the archive again by CDWRITE; the file may be cut",
                ));
            };
            let mut nodes = nodes.to_vec();
            while (nodes.len() as i64) < *count {
                match lines.data()? {
                    Ok((text, at)) => nodes.extend(columns.integers(&text, &at)?),
                    Err(_) => break,
                }
            }
            let whole = |number: &i64| u64::try_from(*number).ok();
            let (Some(id), Some(nodes), true) = (
                whole(id),
                nodes.iter().map(whole).collect::<Option<Vec<u64>>>(),
                nodes.len() as i64 == *count && *count > 0,
            ) else {
                return Err(at.problem(
                    format!(
                        "EBLOCK: the element {id} has {} of {count} nodes",
                        nodes.len()
                    ),
                    "write the archive again by CDWRITE; the file may be cut",
                ));
            };
            self.rows.push(Row {
                id,
                kind: *kind,
                material: *material,
                real: *real,
                section: *section,
                system: *system,
                nodes,
                at,
            });
        };
        let read = (self.rows.len() - before) as i64; // a count of lines
        if !closed {
            return Err(command.problem(
                format!("the block ends after {read} elements without the line -1"),
                "write the archive again by CDWRITE; the file may be cut",
            ));
        }
        complete(command, "elements", stated, read)
    }

    /// `ETBLOCK`: number, element, and its options from the first.
    fn types(&mut self, command: &Command, lines: &mut Lines) -> Result<(), FileProblem> {
        let columns = lines.columns(command)?;
        while let Ok((text, at)) = lines.data()? {
            let numbers = columns.integers(&text, &at)?;
            let [kind, number, options @ ..] = numbers.as_slice() else {
                return Err(at.problem(
                    "ETBLOCK: a type without element",
                    "write the archive again by CDWRITE",
                ));
            };
            let options = (1..).zip(options.iter().copied()).collect();
            let number = u32::try_from(*number).unwrap_or(0);
            self.types.insert(*kind, ElementType { number, options });
        }
        Ok(())
    }

    /// `ET, type, element, KEYOPT(1), …`
    fn element_type(&mut self, command: &Command) -> Result<(), FileProblem> {
        let kind = command.integer(0, "the number of the type")?;
        let text = command.text(1);
        let digits = text.trim_start_matches(|c: char| c.is_ascii_alphabetic());
        let Ok(number) = digits.parse::<u32>() else {
            return Err(command.problem(
                format!("\"{text}\" is no element of ANSYS"),
                "give the name or number of an element, such as SOLID186 or 186",
            ));
        };
        let mut options = BTreeMap::new();
        for place in 2..command.len() {
            let value = command.integer(place, "an option")?;
            options.insert(place as i64 - 1, value); // a few fields
        }
        self.types.insert(kind, ElementType { number, options });
        Ok(())
    }

    /// `KEYOPT, type, number, value`
    fn set_option(&mut self, command: &Command) -> Result<(), FileProblem> {
        let kind = command.integer(0, "the number of the type")?;
        let number = command.integer(1, "the number of the option")?;
        let value = command.integer(2, "the value of the option")?;
        match self.types.get_mut(&kind) {
            Some(found) => {
                found.options.insert(number, value);
                Ok(())
            }
            None => Err(command.problem(
                format!("the type {kind} does not exist"),
                "write ET of this type before its KEYOPT",
            )),
        }
    }

    /// `CMBLOCK, name, NODE or ELEM, count`: numbers; a negative one ends a range that began with the number
    /// before it.
    fn component(&mut self, command: &Command, lines: &mut Lines) -> Result<(), FileProblem> {
        let columns = lines.columns(command)?;
        let kind = command.text(1).to_ascii_uppercase();
        let mut left = command.integer(2, "the number of items")?;
        let mut ranges: Vec<(u64, u64)> = Vec::new();
        while left > 0 {
            let Ok((text, at)) = lines.data()? else {
                return Err(command.problem(
                    format!("the component lacks {left} of its items"),
                    "write the archive again by CDWRITE; the file may be cut",
                ));
            };
            for number in columns.integers(&text, &at)? {
                left -= 1;
                let label = number.unsigned_abs();
                match ranges.last_mut() {
                    Some(range) if number < 0 && range.0 <= label => range.1 = label,
                    _ if number > 0 => ranges.push((label, label)),
                    _ => {
                        return Err(at.problem(
                            format!("CMBLOCK: {number} ends no range"),
                            "write the archive again by CDWRITE",
                        ));
                    }
                }
            }
        }
        match kind.get(..4) {
            Some(word @ ("NODE" | "ELEM")) => {
                self.components.push(Component {
                    name: command.text(0).to_owned(),
                    of_nodes: word == "NODE",
                    ranges,
                });
            }
            _ => self
                .unread
                .note("CMBLOCK of geometry", &command.at, Carries::Nothing),
        }
        Ok(())
    }

    /// `RLBLOCK, sets`: two formats, then each set: number, count, six values, and further lines of seven
    /// values.
    fn constants(&mut self, command: &Command, lines: &mut Lines) -> Result<(), FileProblem> {
        let first = lines.columns(command)?;
        let further = lines.columns(command)?;
        for _ in 0..command.integer(0, "the number of sets")? {
            let cut = || {
                command.problem(
                    "a set of constants is missing",
                    "write the archive again by CDWRITE; the file may be cut",
                )
            };
            let (text, at) = lines.data()?.map_err(|_| cut())?;
            let fields = first.split(&text);
            let whole = |i: usize| fields.get(i).and_then(|field| field.parse::<i64>().ok());
            let (Some(set), Some(count)) = (whole(0), whole(1)) else {
                return Err(cut());
            };
            let mut values = numbers(fields.get(2..).unwrap_or(&[]), &at)?;
            let mut room = first.split(&text).len().max(8) as i64 - 2; // a few columns
            while room < count {
                let (text, at) = lines.data()?.map_err(|_| cut())?;
                values.resize(room as usize, 0.0); // between 6 and the values of a few lines
                values.extend(numbers(&further.split(&text), &at)?);
                room += 7;
            }
            self.reals.insert(set, values);
        }
        Ok(())
    }

    /// `R, set, six values`, `RMORE, six values`.
    fn constant(&mut self, command: &Command) -> Result<(), FileProblem> {
        let more = match command.key() {
            "RMOR" => command.clone(),
            "R" => {
                self.real = command.integer(0, "the number of the set")?;
                self.reals.remove(&self.real);
                command.without(1)
            }
            _ => {
                self.unread
                    .note(&command.name, &command.at, Carries::Structure);
                return Ok(());
            }
        };
        let values = self.reals.entry(self.real).or_default();
        let filled = values.len().next_multiple_of(6);
        values.resize(filled, 0.0);
        for i in 0..more.len().min(6) {
            values.push(more.real(i, "a constant")?);
        }
        Ok(())
    }

    /// `SECTYPE, number, kind`
    fn section(&mut self, command: &Command) -> Result<(), FileProblem> {
        self.section = command.integer(0, "the number of the section")?;
        let section = SectionRow {
            kind: command.text(1).to_ascii_uppercase(),
            layers: Vec::new(),
            offset: "MID".into(),
            at: command.at.clone(),
        };
        self.sections.insert(self.section, section);
        Ok(())
    }

    /// A layer: thickness, material, angle. Sections of other elements are not read, and neither are they
    /// used.
    fn layer(&mut self, command: &Command) -> Result<(), FileProblem> {
        let Some(section) = self.sections.get_mut(&self.section) else {
            return Err(command.problem(
                "no SECTYPE is before it",
                "write the archive again by CDWRITE",
            ));
        };
        if section.kind.starts_with("SHEL") {
            section.layers.push((
                command.real(0, "the thickness of a layer")?,
                command.integer(1, "the material of a layer")?,
                command.real(2, "the angle of a layer")?,
            ));
        }
        Ok(())
    }

    /// `SECBLOCK, layers`: lines `thickness, material, angle, points`.
    fn layers(&mut self, command: &Command, lines: &mut Lines) -> Result<(), FileProblem> {
        let count = command.integer(0, "the number of layers")?;
        let shell = self
            .sections
            .get(&self.section)
            .is_some_and(|section| section.kind.starts_with("SHEL"));
        let mut read = 0;
        while let Ok((text, at)) = lines.data()? {
            read += 1;
            if shell && let Some(layer) = Command::of(&format!("SECDATA,{text}"), &at) {
                self.layer(&layer)?;
            }
            if shell && read == count {
                break;
            }
        }
        match shell && read != count {
            true => Err(command.problem(
                format!("the section has {read} of its {count} layers"),
                "write the archive again by CDWRITE; the file may be cut",
            )),
            false => Ok(()),
        }
    }

    /// `MP, label, material, value, …` or `MPDATA, R5.0, count, label, material, start, values`, for one
    /// temperature or with equal values for all.
    fn material(&mut self, command: &Command) -> Result<(), FileProblem> {
        let table = command.key() == "MPDA";
        // the version of the format, such as R5.0
        let version = |text: &str| text.starts_with("UNBL") || text.contains('.');
        let plain = match table && version(command.text(0)) {
            true => command.without(2),
            false => command.clone(),
        };
        let label = plain.text(0).to_ascii_uppercase();
        let material = plain.integer(1, "the number of the material")?;
        let from = if table { 3 } else { 2 };
        if ["UVID", "UNIT", "KXX", "C", "MU", "EMIS", "HF"].contains(&label.as_str()) {
            return Ok(());
        }
        let mut values = Vec::new();
        for i in from..plain.len() {
            if !plain.text(i).is_empty() {
                values.push(plain.real(i, "the value of the material")?);
            }
        }
        let Some(first) = values.first().copied() else {
            return Ok(());
        };
        let known = self.materials.entry(material).or_default();
        let before = known.insert(label.clone(), first);
        let same = |value: &f64| {
            // further values of MP are coefficients of the temperature
            if table {
                *value == first
            } else {
                *value == 0.0
            }
        };
        let again = table && plain.integer(2, "the first temperature")? > 1;
        let varies = !values.iter().skip(1).all(same) || (again && before != Some(first));
        let elastic = ELASTIC.contains(&label.as_str());
        match varies && elastic {
            true => Err(command.problem(
                format!("{label} of material {material} depends on the temperature"),
                "state one value: a body has one temperature",
            )),
            false => Ok(()),
        }
    }

    /// `CE, R5.0, DEFI, terms, number, constant` and `CE, R5.0, NODE, node, label, coefficient, …`, or `CE,
    /// number, constant, node, label, coefficient, …`.
    fn equation(&mut self, command: &Command) -> Result<(), FileProblem> {
        let written = command.text(0).starts_with(['R', 'r', 'U', 'u']);
        let (number, terms) = match (written, command.text(1).to_ascii_uppercase().as_str()) {
            (true, "DEFI") => {
                let constant = command.real(4, "the constant")?;
                let number = command.integer(3, "the number of the equation")?;
                self.equation_number(number, constant, command)?;
                return Ok(());
            }
            (true, _) => (self.equation, command.without(2)),
            (false, _) => {
                let number = command.integer(0, "the number of the equation")?;
                let constant = command.real(1, "the constant")?;
                self.equation_number(number, constant, command)?;
                (number, command.without(2))
            }
        };
        let Some((known, _)) = self.equations.get_mut(&number) else {
            return Err(command.problem(
                "no DEFI of the equation is before it",
                "write the archive again by CDWRITE",
            ));
        };
        for place in (0..terms.len()).step_by(3) {
            if terms.text(place).is_empty() {
                continue;
            }
            let node = terms.label(place, "the node")?;
            let label = terms.text(place + 1);
            let coefficient = terms.real(place + 2, "the coefficient")?;
            match freedoms(label) {
                Some(bits) if bits.count_ones() == 1 => {
                    known.push((node, bits.trailing_zeros() as u8, coefficient)); // 0 to 5
                }
                _ => {
                    return Err(command.problem(
                        format!("\"{label}\" is no freedom of a structure"),
                        "give UX, UY, UZ, ROTX, ROTY or ROTZ",
                    ));
                }
            }
        }
        Ok(())
    }

    fn equation_number(
        &mut self,
        number: i64,
        constant: f64,
        command: &Command,
    ) -> Result<(), FileProblem> {
        if constant != 0.0 {
            return Err(command.problem(
                format!("the equation {number} has the constant {constant}"),
                "state the constant 0: a body of small motions has no such displacement",
            ));
        }
        let place = || (Vec::new(), command.at.clone());
        self.equations.entry(number).or_insert_with(place);
        self.equation = number;
        Ok(())
    }

    /// `CP, number, label, nodes`: the nodes move alike in this freedom.
    fn coupling(&mut self, command: &Command) -> Result<(), FileProblem> {
        if command
            .text(0)
            .starts_with(|c: char| c.is_ascii_alphabetic())
        {
            self.unread
                .note("CP in another form", &command.at, Carries::Structure);
            return Ok(());
        }
        let number = command.integer(0, "the number of the set")?;
        let label = command.text(1);
        let Some(bits) = freedoms(label) else {
            return Err(command.problem(
                format!("\"{label}\" is no freedom of a structure"),
                "give UX, UY, UZ, ROTX, ROTY, ROTZ or ALL",
            ));
        };
        let mut nodes = Vec::new();
        for i in 2..command.len() {
            if !command.text(i).is_empty() {
                nodes.push(command.label(i, "a node")?);
            }
        }
        let labels = (0..6).filter(|k| bits & (1 << k) != 0).collect();
        let known = self
            .couplings
            .entry(number)
            .or_insert_with(|| (labels, Vec::new(), command.at.clone()));
        known.1.extend(nodes);
        Ok(())
    }

    /// `D, node, label, value`
    fn support(&mut self, command: &Command) -> Result<(), FileProblem> {
        let Some(bits) = freedoms(command.text(1)) else {
            self.unread
                .note("D of other fields", &command.at, Carries::Nothing);
            return Ok(());
        };
        let node = command.label(0, "the node")?;
        let moved = command.real(2, "the value")? != 0.0;
        self.supports.push((node, bits, moved, command.at.clone()));
        Ok(())
    }
}

/// Labels of elasticity and density.
pub(super) const ELASTIC: &[&str] = &[
    "EX", "EY", "EZ", "NUXY", "NUYZ", "NUXZ", "PRXY", "PRYZ", "PRXZ", "GXY", "GYZ", "GXZ", "DENS",
];

fn numbers(fields: &[&str], at: &At) -> Result<Vec<f64>, FileProblem> {
    fields
        .iter()
        .map(|field| real(field, "a constant", at))
        .collect()
}

/// Checks the count of a block.
fn complete(command: &Command, of: &str, stated: i64, read: i64) -> Result<(), FileProblem> {
    if stated > 0 && stated != read {
        return Err(command.problem(
            format!("the block has {read} of {stated} {of}"),
            "write the archive again by CDWRITE; the file may be cut",
        ));
    }
    Ok(())
}
