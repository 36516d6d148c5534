//! Flexible bodies of a model that is only checked: their files are read, not reduced.

use super::cache::{self, Kept, Recorded};
use super::{failed, mesh_of, plausibility, reduction_failed, request};
use crate::{Sources, codes};
use eng_flexible::markers::{numbered, select};
use eng_flexible::mesh::{Material, Mesh, SupportCards, Unread};
use eng_flexible::reduce::{Outline, outline};
use eng_flexible::store::Key;
use eng_flexible::units::MeshUnits;
use eng_grammar::{Diagnostic, Severity};
use eng_system::flexible::{FlexibleSource, MarkerPlace, ModeTerm};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The answers of a body's files to the questions of a check. Only bodies without an error have one.
#[derive(Debug, Serialize, Deserialize)]
struct Inspection {
    key: Key,
    /// Name and hash of each file that was read.
    files: Vec<(String, String)>,
    facts: MeshFacts,
    outline: Outline,
}

/// The facts of a mesh in SI that decide its warnings.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct MeshFacts {
    /// Largest extent along an axis (m).
    pub size: f64,
    pub materials: Vec<Material>,
    pub support_cards: Vec<SupportCards>,
    pub unread: Vec<Unread>,
    pub doubts: Vec<String>,
}

impl MeshFacts {
    fn of(mesh: &Mesh) -> MeshFacts {
        let extent = |axis: usize| {
            let places = || mesh.nodes.iter().filter_map(|node| node.position.get(axis));
            let low = places().fold(f64::INFINITY, |low, x| low.min(*x));
            let high = places().fold(f64::NEG_INFINITY, |high, x| high.max(*x));
            high - low
        };
        MeshFacts {
            size: (0..3).map(extent).fold(0.0, f64::max),
            materials: mesh.materials.clone(),
            support_cards: mesh.support_cards.clone(),
            unread: mesh.unread.clone(),
            doubts: mesh.doubts.clone(),
        }
    }
}

impl Kept for Inspection {
    const ENDING: &str = "look";

    fn key(&self) -> Key {
        self.key
    }

    fn files(&self) -> &[(String, String)] {
        &self.files
    }
}

/// Inspections of the bodies of a program. Each is made once, however many models and analyses have it, and kept in
/// the cache: the matrices of a mesh cost more than all the rest of a check.
#[derive(Debug, Default)]
pub(crate) struct Inspections {
    known: Mutex<Vec<Arc<Inspection>>>,
}

impl Inspections {
    /// The errors and doubts of mesh and markers.
    pub(crate) fn inspect(&self, sources: &Sources, source: &FlexibleSource) -> Vec<Diagnostic> {
        let key = key(sources, source);
        if let Some(inspection) = key.and_then(|key| self.find(sources, &key)) {
            let mut found = plausibility::doubts(&inspection.facts, source);
            found.extend(
                plausibility::unread(&inspection.facts.unread, source).map(|refusal| *refusal),
            );
            return found;
        }
        let files = Recorded::new(sources);
        let (mesh, units) = match mesh_of(&files, source) {
            Ok(made) => made,
            Err(diagnostic) => return vec![*diagnostic],
        };
        let mut found = plausibility::doubts(&MeshFacts::of(&mesh), source);
        found.extend(plausibility::refusal(&mesh, source).map(|refusal| *refusal));
        // markers may use nodes that a matrix recovers, which the compilation of the model reads
        if source.recovery.is_none() {
            found.extend(wrong_markers(&mesh, source));
        }
        if !found.iter().any(|d| d.severity == Severity::Error) {
            // the compilation of the model reports an error of the matrices
            let _ = self.make(key, &files, (mesh, units), source);
        }
        found
    }

    /// The outline of a body. `turned` marks those of its markers that an element turns.
    pub(crate) fn outline(
        &self,
        sources: &Sources,
        source: &FlexibleSource,
        turned: &[bool],
    ) -> Result<Outline, Box<Diagnostic>> {
        let key = key(sources, source);
        let inspection = match key.and_then(|key| self.find(sources, &key)) {
            Some(inspection) => inspection,
            None => {
                let files = Recorded::new(sources);
                let (mesh, units) = mesh_of(&files, source)?;
                if let Some(refusal) = plausibility::refusal(&mesh, source) {
                    return Err(refusal);
                }
                self.make(key, &files, (mesh, units), source)?
            }
        };
        plausibility::bare_markers(inspection.outline.turns(), source, turned)?;
        Ok(inspection.outline.clone())
    }

    /// Keeps all inspections in the cache of sources.
    pub(crate) fn save(&self, sources: &Sources) -> std::io::Result<()> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known
            .iter()
            .try_for_each(|inspection| cache::save(sources, &**inspection))
    }

    /// Whether the program has no flexible body.
    pub(crate) fn is_empty(&self) -> bool {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.is_empty()
    }

    /// The hashes of the meshes and matrices that were read, in hexadecimal digits, by their names.
    pub(crate) fn files(&self) -> BTreeMap<String, String> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known
            .iter()
            .flat_map(|inspection| cache::named(&inspection.files))
            .collect()
    }

    fn find(&self, sources: &Sources, key: &Key) -> Option<Arc<Inspection>> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known
            .iter()
            .find(|inspection| inspection.key == *key)
            .map(Arc::clone);
        drop(known);
        found.or_else(|| Some(self.remember(cache::load(sources, key)?)))
    }

    fn make(
        &self,
        key: Option<Key>,
        files: &Recorded,
        (mut mesh, units): (Mesh, MeshUnits),
        source: &FlexibleSource,
    ) -> Result<Arc<Inspection>, Box<Diagnostic>> {
        let facts = MeshFacts::of(&mesh);
        let request = request::request(source, files, &mut mesh, units)?;
        let outline = outline(mesh, &request).map_err(|e| reduction_failed(&e, source))?;
        let inspection = |key, files| Inspection {
            key,
            files,
            facts,
            outline,
        };
        // a file that can be read once and not again has no key, and its inspection is not kept
        let Some(key) = key else {
            return Ok(Arc::new(inspection(Key([0; 32]), Vec::new())));
        };
        let inspection = self.remember(inspection(key, files.read_files()));
        // without it the next check reads the mesh again
        let _ = cache::save(files.sources(), &*inspection);
        Ok(inspection)
    }

    fn remember(&self, inspection: Inspection) -> Arc<Inspection> {
        let inspection = Arc::new(inspection);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.push(Arc::clone(&inspection));
        inspection
    }
}

/// The key of an inspection: modes are not computed, so bodies that differ in computed modes alone share one.
fn key(sources: &Sources, source: &FlexibleSource) -> Option<Key> {
    let mut looked = source.clone();
    looked
        .modes
        .retain(|term| matches!(term, ModeTerm::Given { .. }));
    cache::key(sources, &request::text(&looked), &request::files(source))
}

/// Markers whose nodes the mesh does not have.
fn wrong_markers(mesh: &Mesh, source: &FlexibleSource) -> Vec<Diagnostic> {
    let index = mesh.node_index();
    let markers = source.markers.iter().filter_map(|marker| {
        let error = match &marker.place {
            MarkerPlace::Node(id) => numbered(&index, &marker.name, *id).err()?,
            MarkerPlace::Gathered { nodes, .. } => select(mesh, &marker.name, nodes).err()?,
        };
        Some(*failed(
            codes::MESH_MARKER,
            &error,
            marker.at,
            "this marker",
        ))
    });
    markers.collect()
}
