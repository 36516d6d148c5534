//! Beams and rods: `CBAR`, `CBEAM`, `CROD`, `CTUBE`, `CONROD`, with orientation, offsets and released
//! freedoms.

use super::card::Card;
use super::elements::{Elements, Extra, Family};
use super::frames::Systems;
use super::grids::{GridCard, Lookup};
use super::lines::At;
use super::number;
use super::properties::{PropertyCard, rod};
use super::unread::UnreadCards;
use super::vector::{beam_axes, norm, rotate, unit};
use crate::error::FileProblem;
use crate::fe::vector::{add, cross, subtract};
use crate::mesh::{BeamAxes, Carries, ElementKind, Node};

/// The orientation of a section about its beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Orientation {
    /// A vector from end A.
    Vector([f64; 3]),
    /// A grid point (`G0`).
    Grid(u64),
    /// Any orientation: the section of a rod is round.
    Any,
}

/// The axes of a vector in the deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axes {
    /// The analysis frame of the end's grid point.
    Analysis,
    /// The basic frame.
    Basic,
    /// The element's own, before offsets.
    Element,
}

/// The data of a beam besides its grid points and property.
#[derive(Clone, Debug)]
pub(super) struct BeamCard {
    orientation: Orientation,
    orientation_axes: Axes,
    offsets: [[f64; 3]; 2],
    offset_axes: [Axes; 2],
    released: [u8; 2],
}

/// Defaults of `BAROR` and `BEAMOR`.
#[derive(Clone, Debug, Default)]
pub(super) struct BeamDefaults {
    property: Option<u64>,
    orientation: Option<[String; 3]>,
    axes: String,
}

impl BeamDefaults {
    /// Reads `BAROR` or `BEAMOR`.
    pub fn read(card: &Card) -> Result<Self, FileProblem> {
        let orientation = [4, 5, 6].map(|i| card.text(i).to_string());
        Ok(BeamDefaults {
            property: card.optional_id(1, "PID")?.filter(|id| *id > 0),
            orientation: orientation
                .iter()
                .any(|field| !field.is_empty())
                .then_some(orientation),
            axes: card.text(7).to_string(),
        })
    }
}

/// Beams and rods in the order of the deck.
#[derive(Debug, Default)]
pub(super) struct Beams {
    /// Their data besides nodes and property.
    pub cards: Vec<BeamCard>,
    /// Sections of `CONROD`.
    pub sections: Vec<PropertyCard>,
}

impl Beams {
    /// Reads `CBAR` or `CBEAM`: `EID PID GA GB X1|G0 X2 X3 OFFT / PA PB W1A W2A W3A W1B W2B W3B`.
    pub fn beam(
        &mut self,
        card: &Card,
        defaults: Option<&BeamDefaults>,
        elements: &mut Elements,
        unread: &mut UnreadCards,
    ) -> Result<(), FileProblem> {
        let id = card.id(0, "EID")?;
        let property = card
            .optional_id(1, "PID")?
            .filter(|id| *id > 0)
            .or(defaults.and_then(|defaults| defaults.property))
            .unwrap_or(id);
        let grids = [card.id(2, "GA")?, card.id(3, "GB")?];
        let mut fields = [4, 5, 6].map(|i| card.text(i).to_string());
        if fields.iter().all(String::is_empty)
            && let Some(default) = defaults.and_then(|defaults| defaults.orientation.clone())
        {
            fields = default;
        }
        let orientation = orientation(card, &fields)?;
        let mut flag = card.text(7);
        if flag.is_empty() {
            flag = defaults.map_or("", |defaults| &defaults.axes);
        }
        let (orientation_axes, offset_axes) = offset_flag(card, flag)?;
        let released = [
            card.optional_components(8, "PA")?.unwrap_or(0),
            card.optional_components(9, "PB")?.unwrap_or(0),
        ];
        let offsets = [card.vector(10, "W A")?, card.vector(13, "W B")?];
        if card.name == "CBEAM" && !(card.is_blank(16) && card.is_blank(17)) {
            unread.note("CBEAM warping", &card.at, Carries::Structure);
        }
        let beam = BeamCard {
            orientation,
            orientation_axes,
            offsets,
            offset_axes,
            released,
        };
        self.push(card, id, Family::Beam, property, grids, beam, elements)
    }

    /// Reads `CROD` or `CTUBE`: `EID PID G1 G2`.
    pub fn rod(&mut self, card: &Card, elements: &mut Elements) -> Result<(), FileProblem> {
        let id = card.id(0, "EID")?;
        let property = card
            .optional_id(1, "PID")?
            .filter(|id| *id > 0)
            .unwrap_or(id);
        let grids = [card.id(2, "G1")?, card.id(3, "G2")?];
        self.push(card, id, Family::Rod, property, grids, ROD, elements)
    }

    /// Reads `CONROD`: `EID G1 G2 MID A J C NSM`.
    pub fn conrod(&mut self, card: &Card, elements: &mut Elements) -> Result<(), FileProblem> {
        let id = card.id(0, "EID")?;
        let grids = [card.id(1, "G1")?, card.id(2, "G2")?];
        let section = rod(
            card.real_or_zero(4, "A")?,
            card.real_or_zero(5, "J")?,
            card.real_or_zero(7, "NSM")?,
        );
        let index = index(self.sections.len(), card)?;
        self.sections.push(PropertyCard::line(
            format!("CONROD {id}"),
            card.id(3, "MID")?,
            section,
            &card.at,
        ));
        let beam = self.keep(card, ROD)?;
        elements.push(
            card,
            id,
            ElementKind::Beam2,
            Family::Rod,
            0,
            &grids,
            Extra::Rod(beam, index),
        );
        Ok(())
    }

    #[allow(clippy::too_many_arguments, reason = "the fields of a beam, each once")]
    fn push(
        &mut self,
        card: &Card,
        id: u64,
        family: Family,
        property: u64,
        grids: [u64; 2],
        beam: BeamCard,
        elements: &mut Elements,
    ) -> Result<(), FileProblem> {
        let index = self.keep(card, beam)?;
        elements.push(
            card,
            id,
            ElementKind::Beam2,
            family,
            property,
            &grids,
            Extra::Beam(index),
        );
        Ok(())
    }

    fn keep(&mut self, card: &Card, beam: BeamCard) -> Result<u32, FileProblem> {
        let index = index(self.cards.len(), card)?;
        self.cards.push(beam);
        Ok(index)
    }
}

const ROD: BeamCard = BeamCard {
    orientation: Orientation::Any,
    orientation_axes: Axes::Basic,
    offsets: [[0.0; 3]; 2],
    offset_axes: [Axes::Basic; 2],
    released: [0; 2],
};

fn index(count: usize, card: &Card) -> Result<u32, FileProblem> {
    u32::try_from(count).map_err(|_| card.problem("too many elements", "divide the model"))
}

/// An integer alone in the first field is a grid point, anything else a vector.
pub(super) fn orientation(card: &Card, fields: &[String; 3]) -> Result<Orientation, FileProblem> {
    let [first, second, third] = fields;
    let grid = number::integer(first).and_then(|id| u64::try_from(id).ok());
    if let Some(grid) = grid
        && grid > 0
        && second.is_empty()
        && third.is_empty()
    {
        return Ok(Orientation::Grid(grid));
    }
    let mut vector = [0.0; 3];
    for (value, field) in vector.iter_mut().zip(fields) {
        if !field.is_empty() {
            *value = number::real(field).ok_or_else(|| {
                card.problem(
                    &format!("a component of the orientation vector is \"{field}\", not a number"),
                    "give three numbers, or the number of one grid point",
                )
            })?;
        }
    }
    if vector == [0.0; 3] {
        return Err(card.problem(
            "the orientation vector is missing",
            "give X1 X2 X3 or the grid point G0, in this card or in BAROR or BEAMOR",
        ));
    }
    Ok(Orientation::Vector(vector))
}

/// `OFFT`: axes of the orientation vector and of both offsets; `GGG` where blank.
fn offset_flag(card: &Card, flag: &str) -> Result<(Axes, [Axes; 2]), FileProblem> {
    let unknown = || {
        card.problem(
            &format!("field OFFT is \"{flag}\""),
            "write three letters: G or B for the vector, then G or O for each offset",
        )
    };
    let offset = |letter: u8| match letter {
        b'G' => Ok(Axes::Analysis),
        b'O' => Ok(Axes::Element),
        _ => Err(unknown()),
    };
    match *flag.as_bytes() {
        // old decks distinguish vector and grid point by 1 and 2
        [] | [b'1' | b'2'] => Ok((Axes::Analysis, [Axes::Analysis; 2])),
        [vector, first, second] => {
            let vector = match vector {
                b'G' => Axes::Analysis,
                b'B' => Axes::Basic,
                _ => return Err(unknown()),
            };
            Ok((vector, [offset(first)?, offset(second)?]))
        }
        _ => Err(unknown()),
    }
}

/// The data that decide the axes of a beam.
pub(super) struct Around<'a> {
    /// Nodes of the mesh.
    pub nodes: &'a [Node],
    /// Cards of the nodes.
    pub grids: &'a [GridCard],
    /// Coordinate systems.
    pub systems: &'a Systems,
    /// Numbers of the nodes.
    pub lookup: &'a Lookup,
}

impl Around<'_> {
    /// The place of a node.
    pub fn position(&self, node: u32) -> [f64; 3] {
        self.nodes
            .get(node as usize)
            .map_or([0.0; 3], |node| node.position)
    }

    /// The direction of an orientation at node `a`, in the basic frame; zero if any will do.
    pub fn direction(
        &self,
        orientation: &Orientation,
        a: u32,
        user: &dyn Fn() -> String,
        at: &At,
    ) -> Result<[f64; 3], FileProblem> {
        match *orientation {
            Orientation::Vector(vector) => self.basic_of(a, vector, user, at),
            Orientation::Grid(grid) => {
                let grid = self.lookup.require(grid, user, at)?;
                Ok(subtract(self.position(grid), self.position(a)))
            }
            Orientation::Any => Ok([0.0; 3]),
        }
    }

    /// A vector given in the analysis frame of a node, in the basic frame.
    fn basic_of(
        &self,
        node: u32,
        vector: [f64; 3],
        user: &dyn Fn() -> String,
        at: &At,
    ) -> Result<[f64; 3], FileProblem> {
        let system = self
            .grids
            .get(node as usize)
            .and_then(|grid| grid.analysis)
            .unwrap_or(0);
        let axes = self
            .systems
            .axes_at(system, self.position(node), user, at)?;
        Ok(rotate(&axes, vector))
    }
}

/// Orientation and offsets of a beam in the basic frame.
pub(super) fn axes(
    beam: &BeamCard,
    id: u64,
    [a, b]: [u32; 2],
    around: &Around,
    at: &At,
) -> Result<BeamAxes, FileProblem> {
    let user = || format!("element {id}");
    let along = subtract(around.position(b), around.position(a));
    let orientation = match beam.orientation {
        Orientation::Vector(vector) if beam.orientation_axes == Axes::Basic => vector,
        Orientation::Any => across(along),
        ref given => around.direction(given, a, &user, at)?,
    };
    let mut offsets = [[0.0; 3]; 2];
    let ends = beam.offsets.into_iter().zip(beam.offset_axes).zip([a, b]);
    for (into, ((offset, given), node)) in offsets.iter_mut().zip(ends) {
        if offset == [0.0; 3] {
            continue;
        }
        *into = match given {
            Axes::Basic => offset,
            Axes::Analysis => around.basic_of(node, offset, &user, at)?,
            Axes::Element => match beam_axes(along, orientation) {
                Some(axes) => rotate(&axes, offset),
                None => return Err(no_axes(id, along, at)),
            },
        };
    }
    let [first, second] = offsets;
    let along = subtract(add(along, second), first);
    if beam_axes(along, orientation).is_none() {
        return Err(no_axes(id, along, at));
    }
    Ok(BeamAxes {
        centroid: [0.0; 2],
        orientation,
        offsets,
        released: beam.released,
    })
}

fn no_axes(id: u64, along: [f64; 3], at: &At) -> FileProblem {
    if norm(along) > 0.0 {
        at.problem(
            format!("element {id}: its orientation vector lies along the beam"),
            "choose a vector across the beam",
        )
    } else {
        at.problem(
            format!("element {id} has no length"),
            "move one of its ends; with their offsets, both are at the same place",
        )
    }
}

/// A vector perpendicular to another: the perpendicular part of the basic axis with the smallest component
/// along it.
pub(super) fn across(along: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = along.map(f64::abs);
    let axis = if x <= y && x <= z {
        [1.0, 0.0, 0.0]
    } else if y <= z {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    unit(cross(along, cross(axis, along))).unwrap_or(axis)
}
