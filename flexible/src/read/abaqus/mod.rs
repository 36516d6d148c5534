//! Input files of Abaqus and CalculiX (`.inp`): nodes, elements, sections, materials, masses, springs, ties,
//! supports and sets become a [`Mesh`].
//!
//! The reader ignores the case of keywords and names, and follows `*INCLUDE`. It places parts as their instances
//! state. Nodes and elements keep the numbers of the file, unless two instances share numbers. Then the k-th
//! instance (from 0; the part outside all instances is last) adds k times the power of ten above all numbers.
//! Sets of an instance are called `Instance.SET`, and also `SET` if no other instance has this name. A surface
//! is the set of its nodes, `surface:NAME`, and also `NAME` if no set has this name.
//!
//! The two codes differ in the dimensions of beam sections and in the rules of elements, whose variants (`R`,
//! `I`, …) the mesh keeps. After `*STEP` only `*BOUNDARY` is read. The supports of the first step count as
//! supports of the model.
//!
//! ```text
//! lines ─▶ deck (parts, instances, scopes) ─▶ model (numbered through) ─▶ sets, surfaces ─▶ elements, points, ties, supports ─▶ mesh
//! ```

mod anisotropic;
mod couplings;
mod deck;
mod distributions;
mod elements;
mod frames;
mod lines;
mod materials;
mod matrices;
mod mean_rotation;
mod model;
mod orientations;
mod points;
mod pretension;
mod rotations;
mod scope;
mod sections;
mod sets;
pub(crate) mod shapes;
mod shells;
mod supports;
pub(crate) mod surfaces;
mod temperature;
mod ties;
mod unread;

use crate::error::FlexibleError;
use crate::mesh::{Code, Mesh};
use crate::read::Files;
use crate::read::held::HoldingCards;
use crate::read::source::whole;
use mean_rotation::MeanRotation;
use model::Model;
use rotations::Rotations;

/// Reads an input file of Abaqus or CalculiX with all included files. Values keep the units of the file.
///
/// # Errors
/// With file, line and keyword: a file that can't be read or isn't an input file, text in the place of a
/// number, an element of too few or too many nodes, a missing or doubled node, element, set, surface, part
/// or material, a keyword that can't be expressed.
pub fn read_inp(files: &dyn Files, name: &str, code: Code) -> Result<Mesh, FlexibleError> {
    let mut deck = deck::read(files, name)?;
    let mut model = Model::new(&mut deck, name)?;
    if model.nodes.is_empty() {
        return Err(whole(
            name,
            "the file has no node",
            "give an input file of Abaqus or CalculiX with *NODE, or with an *INCLUDE of such a file; a part needs an *INSTANCE",
        )
        .into());
    }
    let unread = &mut deck.unread;
    sets::fill(&mut model, unread)?;
    let mut doubts = Vec::new();
    let mut mesh = Mesh {
        code,
        frames: supports::transform(&mut model, code, &mut doubts)?,
        doubts,
        ..Mesh::default()
    };
    surfaces::fill(&mut model, unread)?;
    if deck.materials.depend_on_temperature() {
        let temperature = temperature::initial(&model)?;
        let told = deck.materials.heat(temperature, unread);
        mesh.doubts.extend(told);
    }
    elements::make(&mut model, &mut mesh, &deck.materials, unread)?;
    points::make(&model, &mut mesh, unread)?;
    let means = MeanRotation::all(&model, code)?;
    mesh.scalar_points = means.iter().map(|mean| mean.number(&model)).collect();
    let rotations = Rotations::new(&model, code, &means, unread)?;
    ties::make(&mut model, &mut mesh, (&rotations, &means), unread)?;
    let mut cards = HoldingCards::default();
    mesh.supports = supports::supports(&model, &mut cards, unread)?;
    if code == Code::CalculiX {
        let notes = supports::free_rotations(&model, &mut mesh.supports)?;
        mesh.doubts.extend(notes);
        rotations.hold(&mut mesh.supports);
    }
    mesh.support_cards = cards.into_list();
    pretension::close(&model, &mut mesh, unread)?;
    mesh.sets = sets::sets(&model);
    mesh.nodes = std::mem::take(&mut model.nodes);
    matrices::make(&model, &mut mesh, unread)?;
    if let (Some(mean), Some(_)) = (means.first(), &mesh.matrices) {
        return Err(mean.beside_matrices().into());
    }
    mesh.unread = deck.unread.into_list();
    Ok(mesh)
}
