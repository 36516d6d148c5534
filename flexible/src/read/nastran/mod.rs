//! Nastran bulk data (`.bdf`, `.dat`, `.nas`): grid points, elements, properties, masses, ties, supports and
//! sets become a [`Mesh`].
//!
//! The reader accepts free, small and large field in any mixture, continuations next to their card or
//! anywhere by name, and `INCLUDE`. It skips executive and case control, except `SPC =`, `MPC =`, `NSM =`,
//! `BGSET =`, `BCONTACT =` and the temperatures of materials. Without `SPC =` or `MPC =` all sets apply. Sets of
//! the mesh have the names `set:3` (`SET1`, `SET3`) and `pid:3` (elements with property 3). `PARAM,WTMASS`
//! multiplies densities and masses here. Without a positive `PARAM,COUPMASS` the mesh has lumped masses, and without
//! `PARAM,AUTOSPC,NO` freedoms without stiffness are held.
//!
//! ```text
//! lines ─▶ sections ─▶ continuation ─▶ card ─▶ grids, elements, … (cards) ─▶ mesh
//! ```
//!
//! Cards may refer to later cards. So the reader keeps all cards in short form and makes the mesh at the end
//! of the deck.

mod beams;
mod bushes;
mod card;
mod continuation;
mod elements;
mod frames;
mod glue;
mod grids;
pub(crate) mod lines;
mod masses;
mod matrices;
mod nonstructural;
mod panels;
mod plates;
mod properties;
mod replication;
mod rigid;
pub(crate) mod sections;
mod sets;
pub(crate) mod shapes;
mod spline;
mod supports;
mod ties;
mod unread;
mod weight;

use crate::error::{FileProblem, FlexibleError};
use crate::fe::surface;
use crate::fe::vector::{add, subtract};
use crate::mesh::{ABSENT, Carries, Code, ElementKind, Mesh, Variant};
use crate::read::builder::{NewElement, add_element};
use crate::read::held::HoldingCards;
use crate::read::{Files, number, vector};
use beams::{Around, BeamDefaults, Beams};
use bushes::Bushes;
use card::{Card, IdRange};
use elements::{ElementCard, Elements, Extra};
use frames::{Shape, SystemCard, Systems};
use glue::Glue;
use grids::{GridCard, GridDefaults, Lookup};
use lines::{At, whole};
use masses::{Masses, distinct};
pub use matrices::read_dmig;
use nonstructural::NonStructural;
use panels::Panels;
use plates::Thickness;
use properties::{Properties, UsedProperties};
use sections::{CaseControl, read_cards};
use sets::Sets;
use supports::Supports;
use ties::Ties;
use unread::UnreadCards;

/// Reads a deck of bulk data with its included files. Values keep the units of the file.
///
/// # Errors
/// With file, line and card: a file that can't be read or isn't a deck, text in the place of a number, a
/// lost continuation, a missing or doubled grid point, element, property, material or coordinate system,
/// coordinate systems that refer to each other in a circle, a card that a [`Mesh`] can't hold.
pub fn read_bulk(files: &dyn Files, name: &str) -> Result<Mesh, FlexibleError> {
    let mut deck = Deck {
        mass_scale: 1.0,
        ..Deck::default()
    };
    let case = read_cards(files, name, |card| deck.add(&card))?;
    Ok(deck.mesh(name, &case)?)
}

/// Cards with a continuation in which every value is optional.
const CONTINUATION_WITH_VALUES: [&str; 13] = [
    "MAT1", "PBAR", "PBEAM", "PSHELL", "PSOLID", "PROD", "PTUBE", "CBAR", "CBEAM", "CQUAD4",
    "CTRIA3", "CONM2", "PARAM",
];

/// The cards of a deck in short form.
#[derive(Default)]
struct Deck {
    grids: Vec<GridCard>,
    grid_defaults: GridDefaults,
    scalar: Vec<IdRange>,
    systems: Vec<SystemCard>,
    elements: Elements,
    beams: Beams,
    bar_defaults: Option<BeamDefaults>,
    beam_defaults: Option<BeamDefaults>,
    waiting_beams: Vec<Card>,
    properties: Properties,
    masses: Masses,
    bushes: Bushes,
    panels: Panels,
    non_structural: NonStructural,
    ties: Ties,
    glue: Glue,
    supports: Supports,
    sets: Sets,
    mass_scale: f64,
    coupled: bool,
    /// Whether freedoms without stiffness stay free.
    kept_loose: bool,
    /// Cards of materials that depend on the temperature.
    thermal: Vec<(String, At)>,
    unread: UnreadCards,
    doubts: Vec<String>,
}

impl Deck {
    /// Keeps a card, or counts it as unread. A card may call a missing continuation. Like Nastran, the reader
    /// then reads the card without it and notes a doubt. It refuses the card if the continuation could hold
    /// nodes or whole lists.
    fn add(&mut self, card: &Card) -> Result<(), FileProblem> {
        match (self.read(card), card.lost_problem()) {
            (Err(problem), None) => Err(problem),
            (Err(_), Some(problem)) => Err(problem),
            (Ok(true), Some(_)) if Glue::is_region(&card.name) => Ok(()),
            (Ok(true), Some(problem)) if !CONTINUATION_WITH_VALUES.contains(&&*card.name) => {
                Err(problem)
            }
            (Ok(true), Some(problem)) => {
                // the continuation of `MAT1` can hold only limits of stress
                if card.name != "MAT1" {
                    let place = format!("{}:{}", card.at.file, card.at.line);
                    self.doubts.push(format!(
                        "{place}: {}; the card is read without it",
                        problem.problem
                    ));
                }
                Ok(())
            }
            (Ok(true), None) => Ok(()),
            (Ok(false), _) => {
                self.unread.card(&card.name, &card.at);
                Ok(())
            }
        }
    }

    /// Keeps a card; `false` if Eng does not read this card.
    fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        let name = card.name.as_str();
        if let Some(kinds) = ElementKind::of_nastran(name) {
            match kinds.0.is_solid() {
                true => self.elements.solid(card, kinds)?,
                false => self.elements.shell(card, kinds)?,
            }
            return Ok(true);
        }
        match name {
            "GRID" => self.grids.push(GridCard::read(card)?),
            "GRDSET" => self.grid_defaults = GridDefaults::read(card)?,
            "SPOINT" | "EPOINT" => self.scalar.extend(card.ids(0, card.len(), "ID")?.ranges),
            "CORD2R" => self.by_points(card, Shape::Rectangular)?,
            "CORD2C" => self.by_points(card, Shape::Cylindrical)?,
            "CORD2S" => self.by_points(card, Shape::Spherical)?,
            "CORD1R" => self.by_grids(card, Shape::Rectangular)?,
            "CORD1C" => self.by_grids(card, Shape::Cylindrical)?,
            "CORD1S" => self.by_grids(card, Shape::Spherical)?,
            // the card with their defaults may follow later in the deck
            "CBAR" | "CBEAM" => self.waiting_beams.push(card.clone()),
            "BAROR" => self.bar_defaults = Some(BeamDefaults::read(card)?),
            "BEAMOR" => self.beam_defaults = Some(BeamDefaults::read(card)?),
            "CROD" | "CTUBE" => self.beams.rod(card, &mut self.elements)?,
            "CONROD" => self.beams.conrod(card, &mut self.elements)?,
            "PARAM" => self.parameter(card)?,
            "MATT1" | "MATT2" | "MATT3" | "MATT8" | "MATT9" | "MATT11" => {
                self.thermal.push((card.name.clone(), card.at.clone()));
            }
            _ => {
                return Ok(self.properties.read(card, &mut self.unread)?
                    || self.masses.read(card)?
                    || self.bushes.read(card, &mut self.unread)?
                    || self.panels.read(card)?
                    || self.non_structural.read(card)?
                    || self.supports.read(card)?
                    || self.ties.read(card)?
                    || self.glue.read(card)?
                    || self.sets.read(card)?);
            }
        }
        Ok(true)
    }

    fn by_points(&mut self, card: &Card, shape: Shape) -> Result<(), FileProblem> {
        self.systems.push(frames::read_by_points(card, shape)?);
        Ok(())
    }

    fn by_grids(&mut self, card: &Card, shape: Shape) -> Result<(), FileProblem> {
        self.systems.extend(frames::read_by_grids(card, shape)?);
        Ok(())
    }

    fn parameter(&mut self, card: &Card) -> Result<(), FileProblem> {
        match card.text(0) {
            "WTMASS" => {
                let scale = card.real(1, "value")?;
                if scale <= 0.0 {
                    return Err(card.problem(
                        &format!("WTMASS is {scale}; it must be above zero"),
                        "if the densities are weights, state 1/g in the units of the deck",
                    ));
                }
                self.mass_scale = scale;
            }
            // OptiStruct writes words in place of the number
            "COUPMASS" => {
                self.coupled = match card.text(1) {
                    "YES" => true,
                    "NO" => false,
                    value => number::integer(value).is_some_and(|value| value > 0),
                }
            }
            "AUTOSPC" => self.kept_loose = matches!(card.text(1), "NO" | "N"),
            _ => self.unread.card("PARAM", &card.at),
        }
        Ok(())
    }

    fn mesh(mut self, name: &str, case: &CaseControl) -> Result<Mesh, FileProblem> {
        for card in std::mem::take(&mut self.waiting_beams) {
            let defaults = if card.name == "CBAR" {
                self.bar_defaults.as_ref()
            } else {
                self.beam_defaults.as_ref()
            };
            self.beams
                .beam(&card, defaults, &mut self.elements, &mut self.unread)?;
        }
        let mut grids = std::mem::take(&mut self.grids);
        if grids.is_empty() {
            return Err(whole(
                name,
                "the deck has no grid point",
                "give a deck of Nastran bulk data with GRID cards, or a deck that INCLUDEs them",
            ));
        }
        for grid in &mut grids {
            grid.complete(&self.grid_defaults);
        }
        grids.sort_by_key(|grid| grid.order);
        let lookup = Lookup::new(&mut grids, std::mem::take(&mut self.scalar))?;
        let systems = Systems::place_all(&self.systems, &grids, &lookup)?;
        let (nodes, frames) = grids::nodes(&grids, &systems)?;
        let mut mesh = Mesh {
            code: Code::Nastran,
            lumped: !self.coupled,
            autospc: !self.kept_loose,
            nodes,
            frames,
            ..Mesh::default()
        };
        self.elements.cards.sort_by_key(|element| element.order);
        let properties = self.elements(&mut mesh, &grids, &systems, (&lookup, case))?;
        mesh.sets = self
            .sets
            .sets(&lookup, &mesh, &properties, &mut self.unread);
        mesh.point_masses = self.masses.point_masses(
            &mesh.nodes,
            &mesh.frames,
            &systems,
            &lookup,
            self.mass_scale,
        )?;
        let [springs, inerters] =
            self.masses
                .springs(&lookup, &mut mesh.scalar_points, self.mass_scale)?;
        (mesh.springs, mesh.inerters) = (springs, inerters);
        let around = Around {
            nodes: &mesh.nodes,
            grids: &grids,
            systems: &systems,
            lookup: &lookup,
        };
        let bushes = self.bushes.springs(&around, &mesh.frames)?;
        let (panels, corners) =
            self.panels
                .springs(&around, &self.properties, self.mass_scale, &mesh)?;
        mesh.springs.extend(bushes);
        mesh.springs.extend(panels);
        mesh.point_masses.extend(corners);
        let equations = self.supports.equations(&case.mpc)?;
        let selected = |set: u64| equations.as_ref().is_none_or(|sets| sets.contains(&set));
        mesh.ties = self.ties.ties(
            &lookup,
            (&mesh.nodes, &mesh.frames),
            &selected,
            &mut mesh.scalar_points,
            &mut self.unread,
        )?;
        let (glued, doubts) =
            self.glue
                .ties(&mesh, &properties, &lookup, case, &mut self.unread)?;
        mesh.ties.extend(glued);
        self.doubts.extend(doubts);
        let mut cards = HoldingCards::default();
        mesh.supports = self.supports.supports(
            &grids,
            &lookup,
            &case.spc,
            &mesh.scalar_points,
            &mut cards,
            &mut self.unread,
        )?;
        mesh.support_cards = cards.into_list();
        self.temperatures(case);
        mesh.interface = self.supports.interface(&lookup)?;
        mesh.boundary = self
            .supports
            .boundary(&mesh.interface, &mesh.nodes, &lookup);
        mesh.recovered = self.supports.recovered();
        mesh.weight_check = case.weight.check(&mesh, self.mass_scale);
        mesh.unread = self.unread.into_list();
        mesh.doubts = self.doubts;
        mesh.doubts.extend(case.doubt.clone());
        if case.modes {
            mesh.doubts.extend(self.supports.condensation());
        }
        Ok(mesh)
    }

    /// Cards `MATTi` change the materials only if case control gives them a temperature.
    fn temperatures(&mut self, case: &CaseControl) {
        for (name, at) in &self.thermal {
            if case.temperature {
                self.unread.note(name, at, Carries::Structure);
            }
        }
        if let Some((name, at)) = self.thermal.first()
            && !case.stated
        {
            self.doubts.push(format!(
                "{}:{}: {name} has tables of temperature, and the deck has no case control that gives a temperature: the constants of its materials count",
                at.file, at.line
            ));
        }
    }

    /// Area of a shell, length of a line with its offsets.
    fn size(&self, card: &ElementCard, around: &Around) -> Result<f64, FileProblem> {
        let mut nodes = Vec::new();
        self.elements.nodes(card, around.lookup, &mut nodes)?;
        let beam = match card.extra {
            Extra::Beam(beam) => self.beams.cards.get(beam as usize),
            _ => None,
        };
        if let (Some(beam), &[a, b]) = (beam, nodes.as_slice()) {
            let [first, second] = beams::axes(beam, card.id, [a, b], around, &card.at)?.offsets;
            let along = subtract(around.position(b), around.position(a));
            return Ok(vector::norm(add(along, subtract(second, first))));
        }
        let places: Vec<Option<[f64; 3]>> = (nodes.iter())
            .map(|node| (*node != ABSENT).then(|| around.position(*node)))
            .collect();
        Ok(surface::measure(card.kind, &places))
    }

    /// Makes the elements. Returns the number of each element's property card.
    fn elements(
        &mut self,
        mesh: &mut Mesh,
        grids: &[GridCard],
        systems: &Systems,
        (lookup, case): (&Lookup, &CaseControl),
    ) -> Result<Vec<u64>, FileProblem> {
        let cards = &self.elements.cards;
        distinct("element", cards.iter().map(|card| (card.id, &card.at)))?;
        let mut made = UsedProperties::new(&self.properties, systems, self.mass_scale);
        let around = Around {
            nodes: &mesh.nodes,
            grids,
            systems,
            lookup,
        };
        let (added, doubt) =
            (self.non_structural).added(&case.nsm, cards, &self.properties, &|card| {
                self.size(card, &around)
            })?;
        self.doubts.extend(doubt);
        let (mut nodes, mut numbers) = (Vec::new(), Vec::with_capacity(cards.len()));
        mesh.connectivity.reserve(self.elements.grids.len());
        for (card, added) in cards.iter().zip(added) {
            nodes.clear();
            self.elements.nodes(card, lookup, &mut nodes)?;
            let (shell, beam) = match card.extra {
                Extra::None => (None, None),
                Extra::Shell(fields) => (Some(fields), None),
                Extra::Beam(beam) | Extra::Rod(beam, _) => (None, Some(beam)),
            };
            let (of_property, beside, plain) = made.plate(card.property);
            let mut thickness = match &shell {
                Some(fields) => fields.thickness(of_property, card.id, &card.at)?,
                None => Thickness::OfProperty,
            };
            if !plain && thickness != Thickness::OfProperty {
                let name = "T1 to T4 of a shell with PCOMP";
                self.unread.note(name, &card.at, Carries::Structure);
                thickness = Thickness::OfProperty;
            }
            let own = match thickness {
                Thickness::OfProperty => None,
                Thickness::Own(own) | Thickness::Varying(own, _) => Some(own),
            };
            let property = match card.extra {
                Extra::Rod(_, section) => match self.beams.sections.get(section as usize) {
                    Some(section) => made.own(
                        section,
                        (format!("conrod:{}", card.id), added),
                        card.id,
                        &card.at,
                    )?,
                    None => continue,
                },
                _ => made.property(
                    (card.family, card.property),
                    (own, added),
                    card.id,
                    &card.at,
                )?,
            };
            let shape = match &shell {
                Some(fields) => fields.shape(
                    (thickness, made.is_directed(property), beside),
                    systems,
                    (card.id, &card.at),
                    &mut self.unread,
                )?,
                None => None,
            };
            let beam = beam.and_then(|i| self.beams.cards.get(i as usize));
            let axes = match (beam, nodes.as_slice()) {
                (Some(beam), &[a, b]) => {
                    let around = Around {
                        nodes: &mesh.nodes,
                        grids,
                        systems,
                        lookup,
                    };
                    let mut axes = beams::axes(beam, card.id, [a, b], &around, &card.at)?;
                    axes.centroid = self.properties.neutral(card.family, card.property);
                    let placed = self
                        .properties
                        .has_place_of_mass(card.family, card.property);
                    if placed && added != 0.0 {
                        let name = "added mass of a CBEAM with N1, N2, M1 or M2";
                        self.unread.note(name, &card.at, Carries::Structure);
                    }
                    Some(axes)
                }
                _ => None,
            };
            let new = NewElement {
                id: card.id,
                kind: card.kind,
                variant: match card.variant {
                    Variant::Plain => self.properties.variant(card.family, card.property),
                    named => named,
                },
                property,
                shell: shape,
            };
            add_element(mesh, new, &nodes, axes).map_err(|e| e.at(&card.at))?;
            numbers.push(card.property);
        }
        for (name, at) in &made.odd_shear {
            self.unread.note(name, at, Carries::Structure);
        }
        self.doubts.extend(made.axes_told.into_doubts());
        mesh.properties = made.properties.all;
        mesh.materials = made.materials.all;
        mesh.laminates = made.laminates.all;
        mesh.tapers = made.tapers.all;
        Ok(numbers)
    }
}
