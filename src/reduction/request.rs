//! Turns the block of a flexible body into a request to the crate `flexible`.

use super::plausibility;
use eng_flexible::fe::Rules;
use eng_flexible::foreign::{ForeignMatrices, GivenModes, MatrixFile, RecoveryMatrix};
use eng_flexible::markers::MarkerRequest;
use eng_flexible::mesh::Mesh;
use eng_flexible::read::matrix::read_modes;
use eng_flexible::reduce::{Interface, Request, SurfaceRequest, Term};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_flexible::{Files, Part};
use eng_grammar::Diagnostic;
use eng_system::flexible as text;
use eng_system::mesh_files::ElementRules;

/// The request for a source. It reads the matrices and shapes of other codes, which have the units of the
/// mesh. A deck's own matrices leave its mesh.
pub(super) fn request(
    source: &text::FlexibleSource,
    files: &dyn Files,
    mesh: &mut Mesh,
    units: MeshUnits,
) -> Result<Request, Box<Diagnostic>> {
    let all = |marker: &u32| Interface {
        marker: *marker as usize,
        components: text::ALL_FREEDOMS,
    };
    let some = |held: &text::Interface| Interface {
        marker: held.marker as usize,
        components: held.freedoms,
    };
    let mut terms = Vec::with_capacity(source.modes.len());
    for part in &source.modes {
        terms.push(term(part, files, units)?);
    }
    let matrices = match (&source.stiffness, &source.mass) {
        (Some(stiffness), Some(mass)) => Some(matrices(stiffness, mass, files, units)?),
        _ => match mesh.matrices.take() {
            Some(own) => Some(ForeignMatrices::of_deck(&own, units).map_err(|e| {
                super::failed(crate::codes::REDUCTION, &e, source.mesh.at(), "this mesh")
            })?),
            None => None,
        },
    };
    let recovery = match &source.recovery {
        Some(stated) => Some(recovery(stated, files, units)?),
        None => None,
    };
    Ok(Request {
        rules: rules(source.element_rules),
        markers: source.markers.iter().map(marker).collect(),
        support: source
            .support
            .iter()
            .map(all)
            .chain(source.support_freedoms.iter().map(some))
            .collect(),
        held_nodes: source
            .support
            .iter()
            .map(|marker| *marker as usize)
            .filter(|marker| {
                let source = source.markers.get(*marker);
                source.is_some_and(|marker| !marker.tied)
            })
            .collect(),
        support_of_deck: source.support_of_deck,
        terms,
        // damping is no part of a reduction: it is added afterwards
        damping_ratio: 0.0,
        damping_up_to: f64::INFINITY,
        geometric_stiffness: source.geometric_stiffness,
        matrices,
        recovery,
        surfaces: (0..)
            .zip(&source.markers)
            .filter_map(|(marker, source)| {
                let shapes = source.surface?;
                Some(SurfaceRequest { marker, shapes })
            })
            .collect(),
        asked: Vec::new(),
    })
}

/// All data that decide a reduction, except the contents of files, as text. Places in the model and damping
/// do not count.
pub(super) fn text(source: &text::FlexibleSource) -> String {
    let markers: Vec<_> = source
        .markers
        .iter()
        .map(|m| (&m.name, &m.place, m.tied, m.axes, m.surface))
        .collect();
    let matrix =
        |m: &text::MatrixSource| (m.format, m.matrix.clone(), m.freedoms.clone(), m.per_node);
    let recovery = source.recovery.as_ref();
    let modes: Vec<String> = source
        .modes
        .iter()
        .map(|term| match term {
            // its file is among the files
            text::ModeTerm::Given { format, .. } => format!("given {format:?}"),
            other => format!("{other:?}"),
        })
        .collect();
    format!(
        "{:?}",
        (
            mesh_text(&source.mesh),
            source.stiffness.as_ref().map(matrix),
            source.mass.as_ref().map(matrix),
            recovery.map(|own| (matrix(&own.matrix), file_text(&own.nodes), own.tolerance)),
            source.material.map(|m| (m.young, m.poisson, m.density)),
            &source.element_rules,
            markers,
            (
                &source.support,
                &source.support_freedoms,
                source.support_of_deck,
            ),
            modes,
            source.geometric_stiffness,
        )
    )
}

/// The data of a mesh that its file does not hold.
fn mesh_text(source: &text::MeshSource) -> String {
    match source {
        text::MeshSource::File(mesh) => file_text(mesh),
        // each number has all its digits
        text::MeshSource::Stack(stack) => format!("{:?}", stack.stack),
    }
}

/// The same of a mesh in a file.
fn file_text(mesh: &text::MeshFile) -> String {
    let data = (
        &mesh.format,
        &mesh.units,
        plausibility::units_are_ignored(mesh),
        &mesh.shells,
    );
    format!("{data:?}")
}

/// The files that the text names.
pub(super) fn files(source: &text::FlexibleSource) -> Vec<&str> {
    let mut files: Vec<&str> = Vec::new();
    files.extend(source.mesh.file().map(|mesh| mesh.file.as_str()));
    let recovery = source.recovery.as_ref();
    let recovering = recovery.map(|recovery| &recovery.matrix);
    for matrix in source
        .stiffness
        .iter()
        .chain(&source.mass)
        .chain(recovering)
    {
        files.push(&matrix.file);
        files.extend(matrix.freedoms.as_deref());
    }
    files.extend(recovery.map(|recovery| recovery.nodes.file.as_str()));
    for term in &source.modes {
        if let text::ModeTerm::Given { file, .. } = term {
            files.push(file);
        }
    }
    files
}

fn matrices(
    stiffness: &text::MatrixSource,
    mass: &text::MatrixSource,
    files: &dyn Files,
    units: MeshUnits,
) -> Result<ForeignMatrices, Box<Diagnostic>> {
    let files_of = (matrix_file(stiffness), matrix_file(mass));
    let per_node = stiffness.per_node.or(mass.per_node);
    ForeignMatrices::read(files, files_of.0, files_of.1, per_node, units).map_err(|e| {
        let at = match e.part() {
            Some(Part::Mass) => mass.at,
            _ => stiffness.at,
        };
        super::failed(crate::codes::REDUCTION, &e, at, "this matrix")
    })
}

/// The matrix that recovers nodes, in the units of the mesh.
fn recovery(
    stated: &text::RecoverySource,
    files: &dyn Files,
    units: MeshUnits,
) -> Result<RecoveryMatrix, Box<Diagnostic>> {
    let (nodes, _) = super::mesh_of_file(files, &stated.nodes)?;
    let file = matrix_file(&stated.matrix);
    let per_node = stated.matrix.per_node;
    RecoveryMatrix::read(files, file, per_node, (nodes, units), stated.tolerance)
        .map_err(|e| super::failed(crate::codes::REDUCTION, &e, stated.matrix.at, "this matrix"))
}

fn matrix_file(source: &text::MatrixSource) -> MatrixFile<'_> {
    MatrixFile {
        file: &source.file,
        format: source.format,
        name: source.matrix.as_deref().unwrap_or_default(),
        freedoms: source.freedoms.as_deref(),
    }
}

pub(super) fn rules(stated: Option<ElementRules>) -> Rules {
    match stated {
        Some(ElementRules::Exact) => Rules::exact(),
        Some(ElementRules::CalculiX) => Rules::calculix(),
        Some(ElementRules::Abaqus) => Rules::abaqus(),
        Some(ElementRules::Nastran) => Rules::nastran(),
        None => Rules::default(),
    }
}

pub(super) fn marker(source: &text::MarkerSource) -> MarkerRequest {
    MarkerRequest {
        name: source.name.clone(),
        place: source.place.clone(),
        axes: source.axes,
    }
}

fn term(
    term: &text::ModeTerm,
    files: &dyn Files,
    units: MeshUnits,
) -> Result<Term, Box<Diagnostic>> {
    let at = |interfaces: &[text::Interface]| -> Vec<Interface> {
        interfaces
            .iter()
            .map(|i| Interface {
                marker: i.marker as usize,
                components: i.freedoms,
            })
            .filter(|i| i.components != 0)
            .collect()
    };
    Ok(match term {
        text::ModeTerm::Static(interfaces) => Term::Static(at(interfaces)),
        text::ModeTerm::Constraint(interfaces) => Term::Constraint(at(interfaces)),
        text::ModeTerm::Normal { count, fixed } => Term::Normal {
            modes: match count {
                text::ModeCount::Number(n) => Modes::Count(*n as usize),
                text::ModeCount::UpTo(frequency) => {
                    Modes::UpTo(angular(*frequency) * angular(*frequency))
                }
            },
            fixed: at(fixed),
        },
        text::ModeTerm::Given {
            format,
            file,
            at: place,
        } => {
            let modes = read_modes(files, file, *format)
                .map_err(|e| super::failed(crate::codes::REDUCTION, &e, *place, "these shapes"))?;
            Term::Given(GivenModes { modes, units })
        }
    })
}

/// Angular frequency of a frequency in Hz.
fn angular(frequency: f64) -> f64 {
    2.0 * std::f64::consts::PI * frequency
}
