//! Solids and shells: cards, and their nodes in the order of the mesh.

use super::card::Card;
use super::grids::Lookup;
use super::lines::At;
use super::plates::ShellFields;
use crate::error::FileProblem;
use crate::mesh::{ABSENT, ElementKind, Variant};

/// The family of an element's property. Properties of different families may share a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Family {
    /// `PSOLID`.
    Solid,
    /// `PSHELL`.
    Shell,
    /// `PBAR`, `PBARL`, `PBEAM`, `PBEAML`.
    Beam,
    /// `PROD`, `PTUBE`.
    Rod,
}

/// Data of an element beside its nodes and property.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Extra {
    /// Nothing.
    None,
    /// A shell.
    Shell(ShellFields),
    /// A beam or rod: index of its card.
    Beam(u32),
    /// A rod with its own section: index of its card and of its section.
    Rod(u32, u32),
}

/// An element as the deck gives it.
#[derive(Clone, Debug)]
pub(super) struct ElementCard {
    /// Number in the deck.
    pub order: u64,
    /// Identification number.
    pub id: u64,
    /// Shape.
    pub kind: ElementKind,
    /// Family of its property.
    pub family: Family,
    /// Number of its property.
    pub property: u64,
    /// The start of its grid points in the list of all.
    pub first: usize,
    /// Fields of a shell, beam.
    pub extra: Extra,
    /// The variant that the card names; that of a solid is in its property.
    pub variant: Variant,
    /// Place of the card.
    pub at: At,
}

/// Solids and shells in the order of the deck.
#[derive(Debug, Default)]
pub(super) struct Elements {
    /// The cards.
    pub cards: Vec<ElementCard>,
    /// Their grid points, zero if one is absent, in the order of the mesh.
    pub grids: Vec<u64>,
}

impl Elements {
    /// Reads a solid: `EID PID G1…`. Mid-side nodes may be blank, each or all.
    pub fn solid(
        &mut self,
        card: &Card,
        (linear, quadratic): (ElementKind, ElementKind),
    ) -> Result<(), FileProblem> {
        let (id, property) = (card.id(0, "EID")?, card.id(1, "PID")?);
        let (kind, mut grids) = grid_fields(card, linear, quadratic)?;
        if let Some(order) = kind.description().names.nastran_order {
            let placed = order.iter().filter_map(|place| grids.get(*place).copied());
            grids = placed.collect();
        }
        self.push(card, id, kind, Family::Solid, property, &grids, Extra::None);
        Ok(())
    }

    /// Reads a shell: `EID PID G1…`, then angle, offset and corner thicknesses, whose places depend on the
    /// card.
    pub fn shell(
        &mut self,
        card: &Card,
        (linear, quadratic): (ElementKind, ElementKind),
    ) -> Result<(), FileProblem> {
        let id = card.id(0, "EID")?;
        let property = card
            .optional_id(1, "PID")?
            .filter(|id| *id > 0)
            .unwrap_or(id);
        let (kind, grids) = grid_fields(card, linear, quadratic)?;
        let extra = Extra::Shell(ShellFields::read(card, linear.node_count())?);
        self.push(card, id, kind, Family::Shell, property, &grids, extra);
        Ok(())
    }

    /// Adds an element.
    #[allow(
        clippy::too_many_arguments,
        reason = "the fields of an element, each once"
    )]
    pub fn push(
        &mut self,
        card: &Card,
        id: u64,
        kind: ElementKind,
        family: Family,
        property: u64,
        grids: &[u64],
        extra: Extra,
    ) {
        let first = self.grids.len();
        self.grids.extend_from_slice(grids);
        self.cards.push(ElementCard {
            order: card.order,
            id,
            kind,
            family,
            property,
            first,
            extra,
            variant: match card.name.as_str() {
                "CTRIAR" | "CQUADR" => Variant::Drilling,
                "CBEAM" => Variant::Beam,
                _ => Variant::Plain,
            },
            at: card.at.clone(),
        });
    }

    /// Node indices of an element; [`ABSENT`] if a mid-side node is blank.
    pub fn nodes(
        &self,
        element: &ElementCard,
        lookup: &Lookup,
        into: &mut Vec<u32>,
    ) -> Result<(), FileProblem> {
        let grids = self
            .grids
            .get(element.first..element.first + element.kind.node_count())
            .unwrap_or(&[]);
        for &grid in grids {
            into.push(if grid == 0 {
                ABSENT
            } else {
                lookup.require(grid, &|| format!("element {}", element.id), &element.at)?
            });
        }
        Ok(())
    }
}

/// Grid points from field 2: corners must be there, mid-side nodes may be blank or zero.
fn grid_fields(
    card: &Card,
    linear: ElementKind,
    quadratic: ElementKind,
) -> Result<(ElementKind, Vec<u64>), FileProblem> {
    let corners = linear.node_count();
    let mut grids = Vec::with_capacity(quadratic.node_count());
    for i in 0..quadratic.node_count() {
        let name = format!("G{}", i + 1);
        grids.push(if i < corners {
            card.id(2 + i, &name)?
        } else {
            card.optional_id(2 + i, &name)?.unwrap_or(0)
        });
    }
    if grids.iter().skip(corners).all(|grid| *grid == 0) {
        grids.truncate(corners);
        return Ok((linear, grids));
    }
    Ok((quadratic, grids))
}
