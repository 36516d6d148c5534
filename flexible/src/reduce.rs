//! From a mesh to a reduced body: markers, matrices, modes, constants.

mod candidates;
mod interface;
mod outline;
mod recovered;
mod report;
mod surfaces;

use eng_system::significant::short;
pub use outline::{Outline, outline};
pub use report::{BodyMass, ModeReport, RecoveredNodes, Report, Served, Unserved};
pub use surfaces::SurfaceRequest;

use crate::error::{FlexibleError, Part};
use crate::fe::mass::rigid_motions;
use crate::fe::vector::{cross, norm, subtract};
use crate::fe::{
    self, FreedomMap, Mass, NodalMatrix, Reduction, RigidMass, Rules, assemble, from_matrices,
};
use crate::foreign::{ForeignMatrices, GivenModes, RecoveryMatrix};
use crate::geometric::{Model, geometric};
use crate::invariants::{Full, invariants};
use crate::markers::{MarkerRequest, place};
use crate::mesh::{Code, Mesh, Spring, Support, Tie};
use crate::modes::rigid::residuals;
use crate::modes::{ModeSet, Structure};
use crate::rotary::{add_turning, split_offsets};
use crate::solve::Modes;
use crate::sparse::SymmetricMatrix;
use candidates::Candidates;
use eng_system::flexible::Damping;
use eng_system::reduced::{Invariants, ReducedBody, ReducedMarker};
use interface::MarkerFreedoms;
use recovered::Recovered;
use std::ops::Range;

/// Distance of nodes from a line, by its length, up to which they are on it. A choice: coordinates of a file
/// may have six or seven digits, and a lever of a millionth holds no turn about the line.
const LINE: f64 = 1e-6;

/// Rounding of a stiffness above which a warning reports it. Files of 13 digits have less.
const FEW_DIGITS: f64 = 1e-12;

/// Freedoms of a marker: bits 0…5 are x, y, z and the rotations about them, along the marker's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interface {
    /// Index of the marker.
    pub marker: usize,
    /// Its freedoms.
    pub components: u8,
}

/// A part of a mode set.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    /// Attachment modes: the displacement under each unit load at these freedoms.
    Static(Vec<Interface>),
    /// Constraint modes: the displacement for each unit displacement of these freedoms, with the others held.
    Constraint(Vec<Interface>),
    /// Normal modes, with held freedoms if any are listed.
    Normal {
        /// The selection of modes.
        modes: Modes,
        /// Held besides the supports.
        fixed: Vec<Interface>,
    },
    /// Mode shapes from a file.
    Given(GivenModes),
}

/// A request for a reduction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Integration rules.
    pub rules: Rules,
    /// Markers.
    pub markers: Vec<MarkerRequest>,
    /// Held markers. The tie decides the held motion: an averaging tie holds the mean motion of its nodes.
    /// Without held markers, and without supports of the deck, the body is free and has mean axes.
    pub support: Vec<Interface>,
    /// Markers all of whose nodes are held in all freedoms.
    pub held_nodes: Vec<usize>,
    /// Whether the mesh's own supports are held.
    pub support_of_deck: bool,
    /// The mode set is the sum of these.
    pub terms: Vec<Term>,
    /// Modal damping ratio.
    pub damping_ratio: f64,
    /// The ratio holds up to this frequency (Hz) and rises to one at five times it. Infinite: it holds for
    /// all frequencies.
    pub damping_up_to: f64,
    /// Whether stresses from spin, acceleration and loads at the markers change the stiffness.
    pub geometric_stiffness: bool,
    /// Stiffness and mass of another code in place of those of the elements. The elements then serve for
    /// pictures only.
    pub matrices: Option<ForeignMatrices>,
    /// The motion of further nodes by the freedoms of these matrices. The mesh then is the interface alone.
    pub recovery: Option<RecoveryMatrix>,
    /// Markers with elastic surfaces.
    pub surfaces: Vec<SurfaceRequest>,
    /// Loads at markers. [`Report::unserved`] lists those without a mode in the set.
    pub asked: Vec<Interface>,
}

impl Request {
    /// Whether a support holds the body.
    fn is_held(&self) -> bool {
        !self.support.is_empty() || !self.held_nodes.is_empty() || self.support_of_deck
    }
}

/// A reduction with the data for recovery.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// The body.
    pub body: ReducedBody,
    /// Shapes over the full freedoms, one after the other.
    pub shapes: Vec<f64>,
    /// Numbering of the full freedoms.
    pub freedoms: FreedomMap,
    /// The mesh with the markers' nodes and ties.
    pub mesh: Mesh,
    /// Data for tables and warnings.
    pub report: Report,
}

/// Relative difference of a foreign mass from that of the mesh's volumes above which a warning reports it. A
/// choice: lumped masses, curved surfaces by straight edges and left out parts make some per cent, other
/// units or densities far more.
const MASS_APART: f64 = 0.05;

/// Difference of the masses along x, y and z, as a part of the largest, above which a warning reports it.
/// Files with few digits have less. A choice: a smaller limit would warn about digits, a larger one would
/// pass over a mass that a file left out along one axis.
const DIRECTED: f64 = 1e-4;

/// Most nodes in a message. A choice: as many fit in a line.
const NAMED: usize = 5;

/// Part of the forces of a rigid motion above which they do not cancel, because a support holds the
/// structure. A choice: matrices with seven digits pass.
const RESISTED: f64 = 1e-6;

/// Reduces a mesh in SI.
///
/// # Errors
/// Those of the steps: meshes that are no structure, mechanisms, missing markers, freedoms that a marker does
/// not have, foreign matrices that don't fit the mesh.
pub fn reduce(mut mesh: Mesh, request: &Request) -> Result<Reduced, FlexibleError> {
    if request.geometric_stiffness && request.matrices.is_some() {
        return Err(FlexibleError::Structure {
            problem: "geometric stiffness needs stresses, which matrices of another code do not state".into(),
            advice: "leave geometric stiffness out, or let the elements of the mesh give stiffness and mass".into(),
        });
    }
    let mut report = report_of(&mesh);
    // the rows belong to the mesh before markers add nodes
    let nodal = nodal(&mut mesh, request)?;
    let recovered = nodal.as_ref().and_then(|own| own.recovered.as_ref());
    let equations = recovered.map_or(0..0, |recovered| recovered.equations.clone());
    let places = place(&mut mesh, &request.markers)?;
    let prepared = surfaces::prepare(&mesh, request, &places)?;
    // the mass matrix of another code includes its point masses
    let own = nodal.is_none();
    if own {
        split_offsets(&mut mesh);
    }
    if own && !request.is_held() {
        refuse_grounded_springs(&mesh)?;
    }
    let (mut full, mut held) = matrices(&mesh, request, nodal, &mut report)?;
    let held_by_file = report.supported;
    let marker_freedoms = MarkerFreedoms {
        request,
        places: &places,
        freedoms: &full.freedoms,
    };
    held.extend(stated_supports(&mesh, &marker_freedoms)?);
    report.supported |= request.is_held();
    let (reduction, stiffness) = eliminated(&mesh, &full, held, request, &mut report)?;
    let mass = reduction.reduce_mass(&full.mass)?;
    let motions = rigid_motions(&mesh, &full.freedoms);
    let structure = if report.supported {
        Structure::supported(&stiffness, &mass)
    } else {
        Structure::free(&stiffness, &mass, reduction.restrict(&motions))?
    };
    report.freedoms = structure.size();
    report.rigid_residual = match &structure.rigid {
        Some(rigid) => rigid.residual(),
        None if held_by_file => 0.0,
        // the test needs the stiffness without supports
        None => residuals(&full.stiffness, &motions)
            .into_iter()
            .fold(0.0, f64::max),
    };
    // it is as large as the matrix over free freedoms and not needed any more, so its memory is freed
    full.stiffness = SymmetricMatrix::default();

    let mut candidates = Candidates {
        structure: &structure,
        markers: &marker_freedoms,
        reduction: &reduction,
        mesh: &mesh,
        report: &mut report,
    };
    let found = candidates
        .find(&request.terms, &request.asked, prepared)
        .map_err(|error| at_node(error, &reduction))?;
    let set = ModeSet::new(&structure, found.candidates)?;
    report.sources.clone_from(&set.sources);
    report.dropped.clone_from(&set.dropped);
    for served in &mut report.served {
        served.kept = set.sources.contains(&served.mode);
    }
    report.unserved = found.asked.unserved(&structure, &set);
    warn_of_rounding(request, &structure, &set, &mut report);
    let surfaces = surfaces::beside(&found.surfaces, &structure, &set, &mut report.warnings)?;

    let shapes = reduction.expand(set.len(), &set.vectors);
    let frequencies = set.frequencies();
    let model = Model {
        mesh: &mesh,
        full: &full,
        rules: &request.rules,
        reduction: &reduction,
        structure: &structure,
        motions: &motions,
    };
    let constants = constants(&model, &marker_freedoms, &shapes, &set)?;
    report.body = RigidMass {
        mass: constants.mass,
        first_moment: constants.first_moment,
        inertia: constants.inertia,
    }
    .into();
    // a file with supports lacks the mass of the held rows, so the comparison would be false
    if request.matrices.is_some() && !held_by_file {
        warn_of_mass(&mut report);
    }
    report.modes = mode_reports(&set, &frequencies, &constants, &report.body);
    let markers = reduced_markers(&mesh, &marker_freedoms, &shapes, set.len());
    let mut body = ReducedBody {
        invariants: constants,
        frequencies,
        markers,
        surfaces,
    };
    body.damp(&Damping::Modal {
        ratio: request.damping_ratio,
        up_to: request.damping_up_to,
    });
    // the shapes contain them
    mesh.ties.drain(equations);
    Ok(Reduced {
        body,
        shapes,
        freedoms: full.freedoms,
        mesh,
        report,
    })
}

/// A report with the facts of the mesh alone.
fn report_of(mesh: &Mesh) -> Report {
    Report {
        nodes: mesh.nodes.len(),
        elements: mesh.elements.len(),
        estimate: fe::volume::estimate(mesh).map(BodyMass::from),
        inventory: fe::Inventory::of(mesh),
        weight_check: mesh.weight_check.clone(),
        ..Report::default()
    }
}

/// T with the supports, and the stiffness over free freedoms. With the supports of a deck, freedoms without stiffness
/// are held if its code does so, and a warning names them: all of Nastran, by its `AUTOSPC` (MSC Nastran, Quick
/// Reference Guide, PARAM,AUTOSPC), and those of nodes that ties alone use in CalculiX, where they don't exist.
fn eliminated(
    mesh: &Mesh,
    full: &fe::Assembled,
    mut held: Vec<Support>,
    request: &Request,
    report: &mut Report,
) -> Result<(Reduction, SymmetricMatrix), FlexibleError> {
    let reduction = Reduction::new(mesh, full, &held)?;
    if reduction.size() == 0 {
        return Err(FlexibleError::Structure {
            problem: "the supports hold all freedoms of the body".into(),
            advice: "hold fewer nodes, or make the body rigid".into(),
        });
    }
    let rule = match mesh.code {
        _ if !request.support_of_deck => None,
        Code::CalculiX => {
            Some("and belong to nodes of ties alone, so they don't exist in CalculiX and are held")
        }
        _ if mesh.autospc => Some(
            "and are held, as by Nastran's AUTOSPC (`PARAM,AUTOSPC,NO` in the deck refuses them)",
        ),
        _ => None,
    };
    let Some(rule) = rule else {
        let stiffness = reduction.reduce_stiffness(&full.stiffness)?;
        return Ok((reduction, stiffness));
    };
    let (stiffness, loose) = reduction.reduce_and_search(&full.stiffness)?;
    if loose.is_empty() {
        return Ok((reduction, stiffness));
    }
    let supports = reduction.supports_of(mesh, &full.freedoms, &loose);
    if mesh.code == Code::CalculiX && !only_tied(mesh, &supports) {
        let stiffness = reduction.reduce_stiffness(&full.stiffness)?;
        return Ok((reduction, stiffness));
    }
    report.warnings.push(format!(
        "{} freedoms have no stiffness {rule}: {}",
        loose.len(),
        reduction.listed(&loose)
    ));
    held.extend(supports);
    let reduction = Reduction::new(mesh, full, &held)?;
    let stiffness = reduction.reduce_stiffness(&full.stiffness)?;
    Ok((reduction, stiffness))
}

/// Whether no element, mass or spring uses the nodes of supports.
fn only_tied(mesh: &Mesh, supports: &[Support]) -> bool {
    let mut used = vec![false; mesh.nodes.len()];
    let springs = mesh.springs.iter().chain(&mesh.inerters);
    let nodes = mesh
        .connectivity
        .iter()
        .copied()
        .chain(mesh.point_masses.iter().map(|point| point.node))
        .chain(springs.flat_map(|spring| spring.terms.iter().map(|(node, ..)| *node)));
    for node in nodes {
        if let Some(used) = used.get_mut(node as usize) {
            *used = true;
        }
    }
    supports
        .iter()
        .all(|support| used.get(support.node as usize) == Some(&false))
}

/// Whether the matrices of another code for this mesh are those of a condensation: the mesh has only the
/// nodes of the interface, whose mass is not one of elements, or there are scalar points. The elements beside a recovery are
/// for pictures.
fn is_condensed(mesh: &Mesh, request: &Request, mass: &Mass) -> bool {
    let without_elements = mesh.elements.is_empty() || request.recovery.is_some();
    !mesh.scalar_points.is_empty() || without_elements && !mass.acts_alike()
}

/// The matrices of another code with the freedoms of their rows.
struct Nodal {
    stiffness: NodalMatrix,
    mass: NodalMatrix,
    /// The nodes that they recover.
    recovered: Option<Recovered>,
}

/// The matrices of another code. Their scalar points that the mesh lacks join it, by ascending number, and so do the nodes that
/// they recover.
fn nodal(mesh: &mut Mesh, request: &Request) -> Result<Option<Nodal>, FlexibleError> {
    let Some(foreign) = &request.matrices else {
        return match &request.recovery {
            None => Ok(None),
            Some(recovery) => Err(FlexibleError::Matrix {
                problem: format!(
                    "{} recovers nodes from the freedoms of a stiffness of another code, but the elements of the mesh give the stiffness",
                    recovery.title()
                ),
                advice: "give `stiffness` and `mass` of the same run, or leave `recovery` out".into(),
            }
            .of(Part::Recovery)),
        };
    };
    let (stiffness, mass) = foreign.nodal(mesh)?;
    let rows = stiffness.rows.iter().chain(&mass.rows);
    let mut ids: Vec<u64> = rows
        .filter(|(_, component)| component.is_none())
        .map(|(id, _)| *id)
        .filter(|id| !mesh.scalar_points.contains(id))
        .collect();
    ids.sort_unstable();
    ids.dedup();
    mesh.scalar_points.extend(ids);
    let recovered = match &request.recovery {
        Some(recovery) => {
            if let Some(surface) = request.surfaces.first() {
                return Err(FlexibleError::Structure {
                    problem: format!(
                        "an elastic surface needs the deformation under pressures on it, which the condensed freedoms of {} do not have",
                        recovery.title()
                    ),
                    advice: "leave `surface` of the marker or `recovery` of the body out, or reduce the whole mesh".into(),
                }
                .of(Part::Marker(surface.marker)));
            }
            let attached = recovered::attach(mesh, recovery, &stiffness, &mass);
            Some(attached.map_err(|error| error.of(Part::Recovery))?)
        }
        None => None,
    };
    Ok(Some(Nodal {
        stiffness,
        mass,
        recovered,
    }))
}

/// The invariants of a body with the shapes of a mode set. The terms of turning nodes and those of geometric
/// stiffness come from the elements, so matrices of another code have none.
fn constants(
    model: &Model<'_>,
    markers: &MarkerFreedoms<'_>,
    shapes: &[f64],
    set: &ModeSet,
) -> Result<Invariants, FlexibleError> {
    let request = markers.request;
    let mut constants = invariants(
        &Full {
            freedoms: &model.full.freedoms,
            mass: &model.full.mass,
            rigid: model.motions,
            condensed: request.matrices.is_some()
                && is_condensed(model.mesh, request, &model.full.mass),
        },
        shapes,
        &set.stiffness,
    );
    if request.matrices.is_none() {
        let points = &model.mesh.point_masses;
        add_turning(&mut constants, points, &model.full.freedoms, shapes);
    }
    if request.geometric_stiffness {
        let loads = markers.movable(model.reduction);
        constants.geometric = Some(geometric(model, shapes, &loads)?);
    }
    Ok(constants)
}

/// The freedoms that the request holds: those of markers, of all nodes of markers, and the supports of the
/// deck.
fn stated_supports(
    mesh: &Mesh,
    markers: &MarkerFreedoms<'_>,
) -> Result<Vec<Support>, FlexibleError> {
    let request = markers.request;
    let mut held = Vec::new();
    for support in &request.support {
        held.push(markers.support(support)?);
    }
    for marker in &request.held_nodes {
        held.extend(held_nodes(mesh, markers.places.get(*marker)));
    }
    if request.support_of_deck {
        held.extend(of_deck(mesh)?);
    }
    Ok(held)
}

/// Warns if a foreign mass differs from that of the mesh's volumes.
fn warn_of_mass(report: &mut Report) {
    let Some(estimate) = &report.estimate else {
        return;
    };
    let (mass, volumes) = (report.body.mass, estimate.mass);
    if (mass / volumes - 1.0).abs() > MASS_APART {
        report.warnings.push(format!(
            "the mass matrix has {} kg, but the volumes and densities of the mesh give {} kg: check the units, and look for masses of the run that the mesh lacks",
            short(mass, 5),
            short(volumes, 5)
        ));
    }
}

/// Markers with the rows of the `modes` shapes at their nodes.
fn reduced_markers(
    mesh: &Mesh,
    markers: &MarkerFreedoms<'_>,
    shapes: &[f64],
    modes: usize,
) -> Vec<ReducedMarker> {
    let freedoms = markers.freedoms;
    let reduced = |(marker, node): (&MarkerRequest, &u32)| {
        let rows = |first: u8| -> Vec<f64> {
            (first..first + 3)
                .flat_map(|component| (0..modes).map(move |mode| (component, mode)))
                .map(|(component, mode)| {
                    freedoms
                        .freedom(*node, component)
                        .map_or(0.0, |f| shapes[mode * freedoms.size() + f])
                })
                .collect()
        };
        ReducedMarker {
            name: marker.name.clone(),
            position: mesh.nodes[*node as usize].position,
            translation: rows(0),
            rotation: rows(3),
        }
    };
    let requests = markers.request.markers.iter();
    requests.zip(markers.places).map(reduced).collect()
}

/// All freedoms of the nodes that an averaging tie gathers at a marker's node. (A rigid one holds them by the
/// marker.)
fn held_nodes(mesh: &Mesh, place: Option<&u32>) -> Vec<Support> {
    gathered(mesh, place)
        .map(|node| Support {
            node,
            components: 0b11_1111,
        })
        .collect()
}

/// The nodes that an averaging tie gathers at a marker's node.
fn gathered(mesh: &Mesh, place: Option<&u32>) -> impl Iterator<Item = u32> {
    let tied = mesh.ties.iter().filter_map(move |tie| match tie {
        Tie::Averaging {
            reference,
            independent,
            ..
        } if Some(reference) == place => Some(independent),
        _ => None,
    });
    tied.flatten().map(|(node, ..)| *node)
}

/// The supports of the mesh's file.
fn of_deck(mesh: &Mesh) -> Result<Vec<Support>, FlexibleError> {
    let moved = mesh.support_cards.iter().find_map(|cards| {
        let (file, line) = cards.moved.as_ref()?;
        Some(format!("{} at {file}:{line}", cards.name))
    });
    if let Some(moved) = moved {
        return Err(FlexibleError::Structure {
            problem: format!(
                "{moved} moves or changes a support of the deck, but Eng reads only supports at rest"
            ),
            advice: "remove it from the deck, or hold markers by `support = …`".into(),
        });
    }
    if mesh.supports.is_empty() {
        return Err(FlexibleError::Structure {
            problem: "`support = deck` is stated, but the deck holds no freedom".into(),
            advice: "add SPC or *BOUNDARY to the deck, or hold markers by `support = …`".into(),
        });
    }
    Ok(mesh.supports.clone())
}

/// Stiffness and mass over full freedoms, of the elements or of another code, and the freedoms that the other
/// code holds.
fn matrices(
    mesh: &Mesh,
    request: &Request,
    nodal: Option<Nodal>,
    report: &mut Report,
) -> Result<(fe::Assembled, Vec<Support>), FlexibleError> {
    let Some(Nodal {
        stiffness,
        mass,
        recovered,
    }) = nodal
    else {
        let full = assemble(mesh, &request.rules)?;
        let differences = fe::form::warnings(mesh, &request.rules);
        report.warnings.extend(differences);
        report.warnings.extend(coats(mesh, &full.without_stiffness));
        return Ok((full, Vec::new()));
    };
    let found = match from_matrices(mesh, &stiffness, &mass) {
        Ok(found) => found,
        Err(_) if is_structure(mesh, &mass, &stiffness) => {
            return Err(exchanged(&stiffness, &mass));
        }
        Err(error) => return Err(error),
    };
    let full = &found.structure;
    let resisted = residuals(&full.stiffness, &rigid_motions(mesh, &full.freedoms));
    let held = resisted.iter().any(|share| *share > RESISTED);
    if held && is_structure(mesh, &mass, &stiffness) {
        return Err(exchanged(&stiffness, &mass));
    }
    // the recovered nodes show nothing that the interface does not have
    let joined = recovered.as_ref().map_or(0..0, |own| own.joined.clone());
    if !held && !request.is_held() {
        check_movable(mesh, &found, &joined)?;
    }
    if let Some(recovered) = recovered {
        report.warnings.extend(recovered.note.clone());
        report.recovered = Some(recovered.checked(held)?);
    }
    let (rigid, along) = full.mass.rigid_along(mesh);
    let most = along.into_iter().fold(0.0, f64::max);
    if !held && along.iter().any(|mass| most - mass > DIRECTED * most) {
        let [x, y, z] = along;
        report.warnings.push(format!(
            "{} moves {} kg along x, {} kg along y, {} kg along z: the mass of a body is the same in all directions. It is taken as \
             {} kg, the mean, and its centre and inertia from all three; write masses that act along x, y and z alike",
            mass.title,
            short(x, 5),
            short(y, 5),
            short(z, 5),
            short(rigid.mass, 5)
        ));
    }
    if is_condensed(mesh, request, &full.mass) {
        condensed((mesh, &joined), full, &mass.title, held, request, report)?;
    }
    let partly = found.missing.iter().filter(|s| s.components & 0b111 != 0);
    let absent: Vec<u64> = full
        .unused_nodes
        .iter()
        .chain(partly.map(|support| &support.node))
        .filter_map(|node| mesh.nodes.get(*node as usize))
        .map(|node| node.id)
        .collect();
    if let Some(first) = absent.first() {
        let nodes = format!(
            "{} has no rows of {} nodes or some of their translations (node {first}, …)",
            stiffness.title,
            absent.len()
        );
        report.supported = held;
        report.warnings.push(if report.supported {
            format!(
                "{nodes} and resists rigid motion, so the body is held to the ground there; for a free body, write the matrices without supports"
            )
        } else {
            format!("{nodes}: these nodes do not move in pictures")
        });
    }
    Ok((found.structure, found.missing))
}

/// Checks a condensed body, and warns of its estimated constants. Nodes that `joined` the interface are recovered.
fn condensed(
    (mesh, joined): (&Mesh, &Range<usize>),
    full: &fe::Assembled,
    title: &str,
    held: bool,
    request: &Request,
    report: &mut Report,
) -> Result<(), FlexibleError> {
    let given = request
        .terms
        .iter()
        .any(|term| matches!(term, Term::Given(_)));
    if given && !mesh.scalar_points.is_empty() {
        return Err(FlexibleError::Structure {
            problem: "shapes of a file state no motion of the scalar points of the matrices".into(),
            advice: "leave `shapes(…)` out: `normal(…)` and `static(…)` use the scalar points"
                .into(),
        });
    }
    // a held body does not turn
    if held || request.is_held() {
        return Ok(());
    }
    if !turns(mesh, &full.freedoms, joined) {
        return Err(FlexibleError::Structure {
            problem: format!("{title} does not show how the body turns: its nodes have no rotations and lie on one line"),
            advice: "keep the rotations of a node, or three nodes that are not on one line, in the condensation".into(),
        });
    }
    let scalars = match mesh.scalar_points.len() {
        0 => String::new(),
        1 => " and its modal freedom has no place".to_owned(),
        count => format!(" and its {count} modal freedoms have no place"),
    };
    report.warnings.push(format!(
        "{title} is condensed to {} nodes{scalars}: mass, centre, inertia, momentum and frequencies are exact, but Coriolis forces are \
         those of the nodes, and deformation by its own spin is left out. This matters where the body turns with a notable part of \
         its first frequency",
        mesh.nodes.len() - joined.len()
    ));
    Ok(())
}

/// Whether the freedoms of the nodes other than the `joined` ones follow every rotation of the body.
fn turns(mesh: &Mesh, freedoms: &FreedomMap, joined: &Range<usize>) -> bool {
    let used = (0u32..)
        .zip(&mesh.nodes)
        .filter(|(node, _)| !joined.contains(&(*node as usize)))
        .filter(|(node, _)| !freedoms.of(*node).is_empty());
    let places: Vec<[f64; 3]> = used.clone().map(|(_, node)| node.position).collect();
    let Some(first) = places.first() else {
        return false;
    };
    let arms = places.iter().map(|place| subtract(*place, *first));
    let longest = arms.clone().max_by(|a, b| norm(*a).total_cmp(&norm(*b)));
    let beside = longest.is_some_and(|along| {
        let area = norm(along) * norm(along);
        arms.into_iter()
            .any(|arm| norm(cross(along, arm)) > LINE * area)
    });
    beside
        || used
            .into_iter()
            .any(|(node, _)| freedoms.has_rotation(node))
}

/// The warning about shells that are mass on the mesh and nothing else: their property has no material.
fn coats(mesh: &Mesh, shells: &[u32]) -> Option<String> {
    let first = mesh.elements.get(*shells.first()? as usize)?.id;
    Some(match shells.len() {
        1 => format!(
            "shell element {first} has mass but no stiffness, because its property has no material"
        ),
        count => format!(
            "{count} shell elements have mass but no stiffness, because their properties have no material; the first is {first}"
        ),
    })
}

/// Whether the matrices are those of a structure that rigid motion does not stretch.
fn is_structure(mesh: &Mesh, stiffness: &NodalMatrix, mass: &NodalMatrix) -> bool {
    from_matrices(mesh, stiffness, mass).is_ok_and(|found| {
        let full = &found.structure;
        let resisted = residuals(&full.stiffness, &rigid_motions(mesh, &full.freedoms));
        resisted.iter().all(|share| *share <= RESISTED)
    })
}

/// The error for stiffness and mass in the wrong order.
fn exchanged(stiffness: &NodalMatrix, mass: &NodalMatrix) -> FlexibleError {
    FlexibleError::Matrix {
        problem: format!(
            "{} and {} make no free structure as stiffness and mass, but they do as mass and stiffness",
            stiffness.title, mass.title
        ),
        advice: "exchange the two files: `stiffness` reads the mass, and `mass` the stiffness"
            .into(),
    }
}

/// Refuses a free structure whose matrices lack a whole direction. The `joined` nodes have no rows in them.
fn check_movable(
    mesh: &Mesh,
    found: &fe::ForeignStructure,
    joined: &Range<usize>,
) -> Result<(), FlexibleError> {
    let freedoms = &found.structure.freedoms;
    let missing = |node: u32| -> u8 {
        let own = found.missing.iter().filter(|support| support.node == node);
        own.fold(0, |mask, support| mask | support.components)
    };
    let mut moved = 0u8;
    let mut absent: Vec<(u64, Vec<&str>)> = Vec::new();
    for (index, node) in (0u32..).zip(&mesh.nodes) {
        let count = freedoms.of(index).len();
        if count == 0 || joined.contains(&(index as usize)) {
            continue;
        }
        let missing = missing(index);
        // a node with axes of its own has parts of all directions
        moved |= match node.frame {
            Some(_) if missing & 0b111 != 0b111 => 0b111,
            _ => !missing & 0b111,
        };
        if missing & 0b111 != 0 {
            let names = ["x", "y", "z"].into_iter().enumerate();
            let own = names.filter(|(k, _)| missing & (1 << k) != 0);
            absent.push((node.id, own.map(|(_, name)| name).collect()));
        }
    }
    if moved == 0b111 {
        return Ok(());
    }
    let named: Vec<String> = absent
        .iter()
        .take(NAMED)
        .map(|(node, axes)| format!("{} of node {node}", axes.join(" and ")))
        .collect();
    let more = match absent.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and of {more} more nodes"),
    };
    Err(FlexibleError::Structure {
        problem: format!(
            "freedoms without mass and stiffness: {}{more}: the body can't move there, but a free body must move in all directions",
            named.join(", ")
        ),
        advice: "write matrices of a structure in space; state masses and springs along a line as `body`s and springs"
            .into(),
    })
}

/// An error about a singular row, with the node in place of the row's number.
fn at_node(error: FlexibleError, reduction: &Reduction) -> FlexibleError {
    match error {
        FlexibleError::Singular {
            row,
            problem,
            advice,
        } => match reduction.name(row) {
            Some(name) => FlexibleError::Structure {
                problem: format!("{problem} ({name})"),
                advice,
            },
            None => FlexibleError::Singular {
                row,
                problem,
                advice,
            },
        },
        other => other,
    }
}

/// A body without support moves with its frame, and the ground of its mesh would move with it.
fn refuse_grounded_springs(mesh: &Mesh) -> Result<(), FlexibleError> {
    let grounded = |spring: &&Spring| spring.grounded && spring.stiffness != 0.0;
    match mesh.springs.iter().find(grounded) {
        None => Ok(()),
        Some(spring) => Err(FlexibleError::Structure {
            problem: format!(
                "spring {} of the mesh holds a node to the ground, and the body has no `support`: the ground of the mesh would move with the body",
                spring.id
            ),
            advice: "remove the spring from the mesh and state it as a force of the model, or state a `support`".into(),
        }),
    }
}

/// Warns if the matrices of another code have few digits, with the effect on the first frequency.
fn warn_of_rounding(request: &Request, structure: &Structure, set: &ModeSet, report: &mut Report) {
    // this crate adds up the stiffness of a mesh, so only springs to the ground resist its rigid motion
    if request.matrices.is_none() || report.rigid_residual <= FEW_DIGITS {
        return;
    }
    let digits = -libm::log10(report.rigid_residual);
    let mut text = format!(
        "the stiffness resists rigid motion with {} of its forces: it was written with about {digits:.0} digits",
        short(report.rigid_residual, 2)
    );
    if let (Some(rigid), Some(first)) = (&structure.rigid, set.eigenvalues.first()) {
        // f ~ √λ, so a relative error of λ counts half
        let uncertain = 0.5 * rigid.noise() / first;
        let uncertain = short(uncertain, 1);
        text += &format!(", which makes the first frequency uncertain by about {uncertain}");
    }
    text += "; OP2 and binary OP4 keep all of them";
    report.warnings.push(text);
}

/// Frequencies, origin and effective masses of the modes.
fn mode_reports(
    set: &ModeSet,
    frequencies: &[f64],
    constants: &Invariants,
    body: &BodyMass,
) -> Vec<ModeReport> {
    let (n, c) = (set.len(), body.centre);
    frequencies
        .iter()
        .enumerate()
        .map(|(mode, frequency)| {
            let row =
                |block: &[f64], axis: usize| block.get(axis * n + mode).copied().unwrap_or(0.0);
            let momentum: [f64; 3] = std::array::from_fn(|k| row(&constants.translation, k));
            let moment: [f64; 3] = std::array::from_fn(|k| {
                let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                row(&constants.rotation, k) - c[next] * momentum[last] + c[last] * momentum[next]
            });
            let mut effective_mass = [0.0; 6];
            for (mass, x) in effective_mass
                .iter_mut()
                .zip(momentum.iter().chain(&moment))
            {
                *mass = x * x;
            }
            let count = set.sources.len();
            let own = mode * count..(mode + 1) * count;
            let amplitudes = set.amplitudes.get(own).unwrap_or(&[]);
            let (sources, description) = report::described(&set.sources, amplitudes);
            ModeReport {
                frequency: *frequency,
                description,
                sources,
                effective_mass,
            }
        })
        .collect()
}
