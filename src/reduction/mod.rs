//! Flexible bodies between the compiler and the runtime: `check` reads their meshes, and a run reduces
//! them.

mod cache;
mod comparison;
mod hand_over;
mod inspection;
mod plausibility;
mod request;
pub(crate) mod table;

pub use hand_over::{BodyFile, BodyFormat, HandOverError};
pub(crate) use inspection::Inspections;

use crate::Sources;
use crate::codes;
use crate::places::span;
use eng_flexible::mesh::Mesh;
use eng_flexible::modes::Dropped;
use eng_flexible::read::{ShellGroups, read_mesh_with_shells};
use eng_flexible::reduce::{Report, Served};
use eng_flexible::stack::{StackError, stack_mesh};
use eng_flexible::store::{Key, StoredBody};
use eng_flexible::units::MeshUnits;
use eng_flexible::{Files, FlexibleError, Part, read_mesh};
use eng_grammar::Diagnostic;
use eng_system::flexible::{FlexibleSource, MatrixSource, MeshFile, MeshSource, StackSource};
use eng_system::reduced::ReducedBody;
use eng_system::system::Location;
use std::io::Read;
use std::sync::{Arc, Mutex, PoisonError};

/// A flexible body that has been reduced.
#[derive(Clone, Debug)]
pub struct Reduction {
    /// Path of the body.
    path: String,
    /// The data of the runtime, with damping.
    pub(crate) body: Arc<ReducedBody>,
    /// The stored body, with the mesh and its shapes.
    pub(crate) stored: Arc<StoredBody>,
    /// Place of its mode set in the text.
    at: Location,
    /// A note if its mass differs from that of the code of its file because the text states no rules.
    own_mass: Option<&'static str>,
    /// Seconds of the unit of time of its mesh file.
    time: f64,
}

impl Reduction {
    /// The warnings about the reduction.
    pub(crate) fn doubts(&self) -> impl Iterator<Item = Diagnostic> + '_ {
        let warnings = self.stored.report.warnings.iter().map(|text| {
            Diagnostic::warning(codes::REDUCED, format!("{}: {text}", self.path))
                .at(span(self.at), "found while this was reduced")
        });
        warnings.chain(self.without_mode())
    }

    /// The message if the set has no mode at all, or if no constraint mode remained.
    fn without_mode(&self) -> Option<Diagnostic> {
        let report = &self.stored.report;
        let empty = self.body.invariants.modes == 0;
        let rigid = rigid_loads(report);
        if !empty && rigid.is_empty() {
            return None;
        }
        let mut message = if empty {
            let title = format!("{} has no mode: it moves as a rigid body", self.path);
            Diagnostic::warning(eng_compiler::codes::UNSERVED, title).at(
                span(self.at),
                "without static modes the body is too stiff under its loads",
            )
        } else {
            eng_compiler::elaborate::without_static_mode(&self.path, span(self.at))
        };
        if !rigid.is_empty() {
            message = message.with_note(format!(
                "constraint modes that add nothing, because they are rigid motions of a free body: {}",
                rigid.join(", ")
            ));
        }
        Some(message.with_help(
            "add `static(at: …)` with the loaded markers; a `support` makes constraint modes of one interface, too",
        ))
    }
}

/// Freedoms whose constraint modes are rigid motions, if no other mode serves their loads.
fn rigid_loads(report: &Report) -> Vec<&str> {
    let at = |served: &Served| (served.marker, served.component);
    let vanished = |mode: &str| {
        let same = |dropped: &Dropped| dropped.label == mode && dropped.remains == 0.0;
        report.dropped.iter().any(same)
    };
    report
        .served
        .iter()
        .filter(|served| vanished(&served.mode))
        .filter(|served| !report.served.iter().any(|s| s.kept && at(s) == at(served)))
        .filter_map(|served| served.mode.strip_prefix("constraint "))
        .collect()
}

impl Reduction {
    /// Keeps the stored body in the cache of sources.
    pub(crate) fn save(&self, sources: &Sources) -> std::io::Result<()> {
        cache::save(sources, &*self.stored)
    }

    /// The key of the reduction: the hash of request and files.
    pub(crate) fn key(&self) -> String {
        self.stored.key.text()
    }
}

impl Files for Sources {
    fn open(&self, name: &str) -> std::io::Result<Box<dyn Read>> {
        self.open_data(name).map_err(|error| match error {
            eng_system::host::HostError::NotFound(_) => {
                std::io::Error::new(std::io::ErrorKind::NotFound, "there is no such file")
            }
            other => std::io::Error::other(other.to_string()),
        })
    }
}

/// The error of sections that make no mesh, at the section that causes it.
fn stack_failed(error: &StackError, source: &StackSource) -> Box<Diagnostic> {
    let section = error.section().and_then(|number| number.checked_sub(1));
    let at = section.and_then(|index| source.sections.get(index));
    let message = Diagnostic::error(codes::STACK, error.to_string())
        .at(span(at.copied().unwrap_or(source.at)), "of these sections")
        .with_help(error.advice());
    Box::new(message)
}

/// Reads a mesh in SI, and returns the units of its file.
fn mesh_of_file(files: &dyn Files, file: &MeshFile) -> Result<(Mesh, MeshUnits), Box<Diagnostic>> {
    let wrong = |e| failed(codes::MESH, &e, file.at, "this mesh");
    let read = match &file.shells {
        None => read_mesh(files, &file.file, file.format),
        Some(shells) => {
            let unit = file.units.map_or(1.0, |units| units.length);
            let shells = ShellGroups {
                groups: &shells.groups,
                thickness: shells.thickness / unit,
            };
            read_mesh_with_shells(files, &file.file, file.format, shells)
        }
    };
    let mut mesh = read.map_err(wrong)?;
    let units = plausibility::units(&mut mesh, file).map_err(wrong)?;
    mesh.convert(&units);
    Ok((mesh, units))
}

/// Reads or makes a mesh in SI, with its material, and returns the units of its files.
fn mesh_of(
    files: &dyn Files,
    source: &FlexibleSource,
) -> Result<(Mesh, MeshUnits), Box<Diagnostic>> {
    let (mut mesh, units) = match &source.mesh {
        MeshSource::File(file) => mesh_of_file(files, file)?,
        MeshSource::Stack(stack) => {
            let mesh = stack_mesh(&stack.stack).map_err(|error| stack_failed(&error, stack))?;
            (mesh, MeshUnits::SI)
        }
    };
    if let Some(material) = &source.material {
        mesh.set_material(material.young, material.poisson, material.density)
            .map_err(|e| failed(codes::MESH, &e, material.at, "this material"))?;
    }
    Ok((mesh, units))
}

/// Reduces each body of a program once, however many models and analyses use it.
#[derive(Debug, Default)]
pub(crate) struct Reducer {
    known: Mutex<Vec<(Key, Arc<StoredBody>)>>,
}

/// Bodies that are reduced side by side. A thread more would need the memory of a third body, and the solution of each
/// uses several threads itself.
const TOGETHER: usize = 2;

/// A body to be reduced, with its place in the list of a model and whether an element turns each of its markers.
pub(crate) type Asked<'a> = (usize, &'a FlexibleSource, Vec<bool>);

/// The reductions in the order of the list.
type Made = Mutex<Vec<(usize, Result<Reduction, Box<Diagnostic>>)>>;

impl Reducer {
    /// Reduces the bodies of a model, two at a time. The result has their order. A thread reduces equal bodies one after
    /// the other, so that the second one takes the result of the first.
    pub(crate) fn reduce_all(
        &self,
        sources: &Sources,
        bodies: Vec<Asked<'_>>,
    ) -> Vec<Result<Reduction, Box<Diagnostic>>> {
        let mut groups: Vec<(String, Vec<Asked<'_>>)> = Vec::new();
        for asked in bodies {
            let text = request::text(asked.1);
            match groups.iter_mut().find(|(known, _)| *known == text) {
                Some((_, group)) => group.push(asked),
                None => groups.push((text, vec![asked])),
            }
        }
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let threads = threads.min(TOGETHER).min(groups.len());
        let made = Made::default();
        let groups = Mutex::new(groups.into_iter());
        let work = || {
            loop {
                let next = groups.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some((_, group)) = next else { return };
                for (index, source, turned) in group {
                    let reduction = self.reduce(sources, source, &turned);
                    let mut made = made.lock().unwrap_or_else(PoisonError::into_inner);
                    made.push((index, reduction));
                }
            }
        };
        if threads < 2 {
            work();
        } else {
            std::thread::scope(|scope| {
                for _ in 0..threads {
                    scope.spawn(work);
                }
            });
        }
        let mut made = made.into_inner().unwrap_or_else(PoisonError::into_inner);
        made.sort_by_key(|(index, _)| *index);
        made.into_iter().map(|(_, reduction)| reduction).collect()
    }

    /// Reduces a body, or takes the kept one. `turned` states for each marker whether an element turns it.
    pub(crate) fn reduce(
        &self,
        sources: &Sources,
        source: &FlexibleSource,
        turned: &[bool],
    ) -> Result<Reduction, Box<Diagnostic>> {
        let text = request::text(source);
        let key = cache::key(sources, &text, &request::files(source));
        let known = key.and_then(|key| self.known(&key)).or_else(|| {
            let stored: Arc<StoredBody> = Arc::new(cache::load(sources, &key?)?);
            self.keep(&stored);
            Some(stored)
        });
        let stored = match known {
            Some(stored) => stored,
            None => {
                let stored = Arc::new(reduced(sources, source, key, text)?);
                self.keep(&stored);
                stored
            }
        };
        let turns = stored
            .body
            .markers
            .iter()
            .map(plausibility::turns)
            .collect::<Vec<_>>();
        plausibility::bare_markers(&turns, source, turned)?;
        let mut body = stored.body.clone();
        body.damp(&source.damping);
        let by_default = source.element_rules.is_none() && source.stiffness.is_none();
        let units = source.mesh.file().and_then(|file| file.units);
        Ok(Reduction {
            time: units.map_or(1.0, |units| units.time),
            own_mass: by_default
                .then(|| plausibility::own_mass(&stored.mesh))
                .flatten(),
            path: source.origin.path.clone(),
            body: Arc::new(body),
            stored,
            at: source.modes_at,
        })
    }

    fn known(&self, key: &Key) -> Option<Arc<StoredBody>> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known
            .iter()
            .find(|(k, _)| k == key)
            .map(|(_, stored)| Arc::clone(stored))
    }

    fn keep(&self, stored: &Arc<StoredBody>) {
        self.known
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push((stored.key, Arc::clone(stored)));
    }
}

/// Reduces from the files.
fn reduced(
    sources: &Sources,
    source: &FlexibleSource,
    key: Option<Key>,
    text: String,
) -> Result<StoredBody, Box<Diagnostic>> {
    let files = cache::Recorded::new(sources);
    let (mut mesh, units) = mesh_of(&files, source)?;
    if let Some(refusal) = plausibility::refusal(&mesh, source) {
        return Err(refusal);
    }
    let request = request::request(source, &files, &mut mesh, units)?;
    let reduced =
        eng_flexible::reduce::reduce(mesh, &request).map_err(|e| reduction_failed(&e, source))?;
    let mut provenance = files.read_files();
    provenance.push(("request".to_owned(), text));
    // a file that can be read once and not again has no key, and is not kept
    let stored = StoredBody::new(
        reduced,
        request.rules,
        key.unwrap_or(Key([0; 32])),
        provenance,
    );
    if key.is_some() {
        // without it the next run reduces again
        let _ = cache::save(sources, &stored);
    }
    Ok(stored)
}

/// The error of a failed reduction, at the marker or the matrix that it concerns, else at the mode set.
fn reduction_failed(error: &FlexibleError, source: &FlexibleSource) -> Box<Diagnostic> {
    let marker = |index: usize| source.markers.get(index).map(|marker| marker.at);
    let matrix = |matrix: &Option<MatrixSource>| matrix.as_ref().map(|matrix| matrix.at);
    let recovery = || source.recovery.as_ref().map(|recovery| recovery.matrix.at);
    let (code, at, label) = match error.part() {
        Some(Part::Marker(index)) => (codes::MESH_MARKER, marker(index), "this marker"),
        Some(Part::Stiffness) => (codes::REDUCTION, matrix(&source.stiffness), "this matrix"),
        Some(Part::Mass) => (codes::REDUCTION, matrix(&source.mass), "this matrix"),
        Some(Part::Recovery) => (codes::REDUCTION, recovery(), "this matrix"),
        None => (codes::REDUCTION, None, ""),
    };
    match at {
        Some(at) => failed(code, error, at, label),
        None => failed(
            codes::REDUCTION,
            error,
            source.modes_at,
            "while these modes were computed",
        ),
    }
}

fn failed(code: &'static str, error: &FlexibleError, at: Location, label: &str) -> Box<Diagnostic> {
    let message = Diagnostic::error(code, error.to_string()).at(span(at), label);
    match error.advice() {
        "" => Box::new(message),
        advice => Box::new(message.with_help(advice)),
    }
}
