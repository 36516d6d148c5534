//! Tools with which the readers of all formats build a mesh. They add elements with their nodes and beams
//! with their axes. They make each property and material once, when an element first uses it.

use std::collections::BTreeMap;

use super::source::At;
use crate::element::ElementKind;
use crate::error::FileProblem;
use crate::mesh::{BeamAxes, Element, Mesh, ShellShape, Variant};

/// A list of values that are made once each. A key identifies the source of a value.
#[derive(Clone, Debug)]
pub(super) struct Once<K, T> {
    made: BTreeMap<K, u32>,
    /// All values, in the order in which they were made.
    pub all: Vec<T>,
}

impl<K, T> Default for Once<K, T> {
    fn default() -> Self {
        Once {
            made: BTreeMap::new(),
            all: Vec::new(),
        }
    }
}

impl<K: Ord, T> Once<K, T> {
    /// Index of the value of this key.
    pub fn find(&self, key: &K) -> Option<u32> {
        self.made.get(key).copied()
    }

    /// Adds a value that no other element shares.
    pub fn push(&mut self, value: T) -> u32 {
        self.all.push(value);
        (self.all.len() - 1) as u32 // never more than elements
    }

    /// Adds the value of a key.
    pub fn add(&mut self, key: K, value: T) -> u32 {
        let index = self.push(value);
        self.made.insert(key, index);
        index
    }
}

/// An element without its nodes.
#[derive(Clone, Copy)]
pub(super) struct NewElement {
    /// The file's number.
    pub id: u64,
    /// Shape and order of nodes.
    pub kind: ElementKind,
    /// The variant of integration that the file names.
    pub variant: Variant,
    /// Index of its property.
    pub property: u32,
    /// Position, thickness and axes of a shell, if they differ from the default.
    pub shell: Option<ShellShape>,
}

/// Adds an element to a mesh, and for a beam its axes. Returns the index of the element.
///
/// # Errors
/// If the elements of the mesh have more than 4 billion nodes.
pub(super) fn add_element(
    mesh: &mut Mesh,
    new: NewElement,
    nodes: &[u32],
    axes: Option<BeamAxes>,
) -> Result<u32, TooMany> {
    let first = u32::try_from(mesh.connectivity.len()).map_err(|_| TooMany)?;
    let index = mesh.elements.len() as u32; // fewer than nodes of elements
    mesh.connectivity.extend_from_slice(nodes);
    let beam = axes.map(|axes| {
        mesh.beam_axes.push(axes);
        (mesh.beam_axes.len() - 1) as u32 // never more than elements
    });
    let shell = new.shell.map(|shape| {
        if mesh.shell_shapes.last() != Some(&shape) {
            mesh.shell_shapes.push(shape);
        }
        (mesh.shell_shapes.len() - 1) as u32 // never more than elements
    });
    mesh.elements.push(Element {
        id: new.id,
        kind: new.kind,
        variant: new.variant,
        property: new.property,
        first,
        beam,
        shell,
    });
    Ok(index)
}

/// The error of more elements than a mesh can number.
#[derive(Clone, Copy, Debug)]
pub(super) struct TooMany;

impl TooMany {
    /// The problem and the remedy.
    pub const WORDS: (&'static str, &'static str) = ("too many elements", "divide the model");

    /// As a problem of a line.
    pub fn at(self, at: &At) -> FileProblem {
        let (problem, advice) = Self::WORDS;
        at.problem(problem, advice)
    }
}
