//! Decks in memory, and common checks of the tests of the Nastran reader.

use std::collections::BTreeMap;
use std::io::{self, Read};

use eng_flexible::mesh::{ABSENT, Carries, Mesh, Set};
use eng_flexible::read::nastran::read_bulk;
use eng_flexible::{FileProblem, Files, FlexibleError};

/// Files in memory.
#[derive(Default)]
pub struct Memory(pub BTreeMap<String, Vec<u8>>);

impl Memory {
    pub fn new(files: &[(&str, &str)]) -> Self {
        Memory(
            files
                .iter()
                .map(|(name, text)| (name.to_string(), text.as_bytes().to_vec()))
                .collect(),
        )
    }
}

impl Files for Memory {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        match self.0.get(name) {
            Some(bytes) => Ok(Box::new(io::Cursor::new(bytes.clone()))),
            None => Err(io::Error::new(io::ErrorKind::NotFound, "no such file")),
        }
    }
}

/// The mesh of a deck.
pub fn mesh(deck: &str) -> Mesh {
    match read_bulk(&Memory::new(&[("deck.bdf", deck)]), "deck.bdf") {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error} ({})", error.advice()),
    }
}

/// The problem of a deck.
pub fn problem(deck: &str) -> FileProblem {
    problem_of(&Memory::new(&[("deck.bdf", deck)]))
}

/// The problem of the deck `deck.bdf` among files.
pub fn problem_of(files: &Memory) -> FileProblem {
    match read_bulk(files, "deck.bdf") {
        Err(FlexibleError::File(problem)) => problem,
        Err(error) => panic!("no problem of a file: {error}"),
        Ok(mesh) => panic!("read without a problem: {mesh:?}"),
    }
}

/// Positions of the nodes with these numbers.
pub fn position(mesh: &Mesh, id: u64) -> [f64; 3] {
    mesh.nodes
        .iter()
        .find(|node| node.id == id)
        .map(|node| node.position)
        .unwrap_or_else(|| panic!("node {id}"))
}

/// Index of a node.
pub fn index(mesh: &Mesh, id: u64) -> u32 {
    mesh.node_index()[&id]
}

/// Numbers of nodes by index; zero for one that is absent.
pub fn ids(mesh: &Mesh, nodes: &[u32]) -> Vec<u64> {
    nodes
        .iter()
        .map(|node| mesh.nodes.get(*node as usize).map_or(0, |node| node.id))
        .collect()
}

/// Numbers of an element's nodes.
pub fn element_ids(mesh: &Mesh, id: u64) -> Vec<u64> {
    let element = mesh
        .elements
        .iter()
        .find(|element| element.id == id)
        .unwrap_or_else(|| panic!("element {id}"));
    ids(mesh, mesh.nodes_of(element))
}

/// Numbers of a set's nodes.
pub fn set_ids(mesh: &Mesh, name: &str) -> Vec<u64> {
    ids(mesh, set(mesh, name).nodes())
}

/// A set.
pub fn set<'m>(mesh: &'m Mesh, name: &str) -> &'m Set {
    mesh.sets
        .get(name)
        .unwrap_or_else(|| panic!("set {name} of {:?}", mesh.sets.keys()))
}

/// The cards that were not read: name, count, and whether they carry stiffness, mass or
/// constraints.
pub fn unread(mesh: &Mesh) -> Vec<(&str, u64, Carries)> {
    mesh.unread
        .iter()
        .map(|unread| (unread.name.as_str(), unread.count, unread.carries))
        .collect()
}

/// Asserts equality up to rounding of values of order `scale`.
#[track_caller]
pub fn close(found: f64, expected: f64, scale: f64) {
    assert!(
        (found - expected).abs() <= 1e-13 * scale,
        "{found} is not {expected}"
    );
}

/// Asserts equality of vectors up to rounding.
#[track_caller]
pub fn close3(found: [f64; 3], expected: [f64; 3], scale: f64) {
    for (found_one, expected_one) in found.iter().zip(expected) {
        assert!(
            (found_one - expected_one).abs() <= 1e-13 * scale,
            "{found:?} is not {expected:?}"
        );
    }
}

/// Conditions on every mesh.
pub fn is_consistent(mesh: &Mesh) {
    let count = mesh.nodes.len();
    for element in &mesh.elements {
        let nodes = mesh.nodes_of(element);
        assert_eq!(nodes.len(), element.kind.node_count());
        for (place, node) in nodes.iter().enumerate() {
            let absent = *node == ABSENT && place >= element.kind.corner_count();
            assert!(absent || (*node as usize) < count);
        }
        let property = &mesh.properties[element.property as usize];
        assert!(
            property
                .material
                .is_none_or(|m| (m as usize) < mesh.materials.len())
        );
        assert!(
            element
                .beam
                .is_none_or(|b| (b as usize) < mesh.beam_axes.len())
        );
    }
    for node in &mesh.nodes {
        assert!(node.position.iter().all(|x| x.is_finite()));
        assert!(node.frame.is_none_or(|f| (f as usize) < mesh.frames.len()));
    }
    for set in mesh.sets.values() {
        assert!(set.nodes().is_sorted() && set.nodes().iter().all(|n| (*n as usize) < count));
        assert!(set.elements().is_sorted());
        let elements = mesh.elements.len();
        assert!(set.elements().iter().all(|e| (*e as usize) < elements));
    }
}
