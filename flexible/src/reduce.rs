//! From a mesh to a reduced body: markers, matrices, modes, constants.

use crate::error::FlexibleError;
use crate::fe::mass::rigid_motions;
use crate::fe::{FreedomMap, Reduction, Rules, assemble};
use crate::geometric::{Model, geometric};
use crate::invariants::{Full, invariants};
use crate::markers::{MarkerRequest, place};
use crate::mesh::{Mesh, Support};
use crate::modes::normal::normal_modes;
use crate::modes::statics::{attachment_modes, constraint_modes};
use crate::modes::{Boundary, Candidate, Dropped, Load, ModeSet, Structure};
use crate::rotary::{add_turning, split_offsets};
use crate::solve::{Modes, SturmCount};
use eng_system::reduced::{ReducedBody, ReducedMarker};

/// Names of a marker's freedoms.
const COMPONENTS: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

/// Freedoms of a marker: bits 0…5 are x, y, z and the rotations about them, basic axes.
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
    /// A displacement under each unit load at these freedoms (attachment modes).
    Static(Vec<Interface>),
    /// A displacement for each unit displacement of these freedoms with the others held (constraint modes).
    Constraint(Vec<Interface>),
    /// Normal modes; with freedoms held where there are any.
    Normal {
        /// Which.
        modes: Modes,
        /// Held besides the supports.
        fixed: Vec<Interface>,
    },
}

/// What is to be reduced, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Integration rules.
    pub rules: Rules,
    /// Markers.
    pub markers: Vec<MarkerRequest>,
    /// Markers that are held; none: a free body with mean axes.
    pub support: Vec<Interface>,
    /// The mode set is the sum of these.
    pub terms: Vec<Term>,
    /// Modal damping ratio.
    pub damping_ratio: f64,
    /// The ratio holds up to this frequency (Hz) and rises to one at five times it; infinite: it holds for all.
    pub damping_up_to: f64,
    /// Whether stresses of spin, acceleration and of loads at the markers of static modes change the stiffness.
    pub geometric_stiffness: bool,
}

/// What a reduction found, for tables.
#[derive(Clone, Debug)]
pub struct Report {
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Elements.
    pub elements: usize,
    /// Free freedoms of the finite-element model.
    pub freedoms: usize,
    /// Labels of the modes that the set spans.
    pub sources: Vec<String>,
    /// Modes left out because others span them.
    pub dropped: Vec<Dropped>,
    /// That no normal mode was missed, one a term of normal modes.
    pub sturm: Vec<SturmCount>,
}

/// A reduction with what recovery needs.
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
    /// For tables.
    pub report: Report,
}

/// Reduces a mesh in SI.
///
/// # Errors
/// As the steps give them: meshes that make no sense, mechanisms, markers that are not there, freedoms that a marker does not have.
pub fn reduce(mut mesh: Mesh, request: &Request) -> Result<Reduced, FlexibleError> {
    let nodes = (mesh.nodes.len(), mesh.elements.len());
    let places = place(&mut mesh, &request.markers)?;
    split_offsets(&mut mesh);
    let full = assemble(&mesh, &request.rules)?;
    let marker_freedoms = MarkerFreedoms {
        request,
        places: &places,
        freedoms: &full.freedoms,
    };
    let mut held = Vec::new();
    for support in &request.support {
        marker_freedoms.freedoms(support)?;
        held.push(Support {
            node: places[support.marker],
            components: support.components,
        });
    }
    let reduction = Reduction::new(&mesh, &full, &held)?;
    let stiffness = reduction.reduce_stiffness(&full.stiffness)?;
    let mass = reduction.reduce_mass(&full.mass)?;
    let motions = rigid_motions(&mesh, &full.freedoms);
    let structure = if held.is_empty() {
        Structure::free(&stiffness, &mass, free_motions(&reduction, &motions))?
    } else {
        Structure::supported(&stiffness, &mass)
    };
    let size = structure.size();

    let (mut candidates, mut sturm) = (Vec::new(), Vec::new());
    let mut add = |labels: Vec<String>, vectors: &[f64]| {
        for (label, vector) in labels.into_iter().zip(vectors.chunks_exact(size.max(1))) {
            candidates.push(Candidate {
                label,
                vector: vector.to_vec(),
            });
        }
    };
    for term in &request.terms {
        match term {
            Term::Static(at) => {
                let mut loads = Vec::new();
                for interface in at {
                    for (label, freedom) in marker_freedoms.freedoms(interface)? {
                        let (rows, factors) = reduction.row(freedom);
                        loads.push(Load {
                            label: format!("static {label}"),
                            entries: rows.iter().copied().zip(factors.iter().copied()).collect(),
                        });
                    }
                }
                let vectors = attachment_modes(&structure, &loads)?;
                add(loads.into_iter().map(|l| l.label).collect(), &vectors);
            }
            Term::Constraint(at) => {
                let (labels, freedoms) = marker_freedoms.free(at, &reduction)?;
                let vectors = constraint_modes(&structure, &freedoms)?;
                let labels = labels.into_iter().map(|l| format!("constraint {l}"));
                add(labels.collect(), &vectors);
            }
            Term::Normal { modes, fixed } => {
                let boundary = if fixed.is_empty() {
                    Boundary::AsIs
                } else {
                    Boundary::Fixed(marker_freedoms.free(fixed, &reduction)?.1)
                };
                let found = normal_modes(&structure, *modes, &boundary)?;
                let labels = (1..=found.eigenvalues.len()).map(|i| format!("normal {i}"));
                add(labels.collect(), &found.vectors);
                sturm.push(found.sturm);
            }
        }
    }
    let set = ModeSet::new(&structure, candidates)?;
    let shapes = reduction.expand(set.len(), &set.vectors);
    let frequencies = set.frequencies();
    let mut constants = invariants(
        &Full {
            freedoms: &full.freedoms,
            mass: &full.mass,
            stiffness: &full.stiffness,
            rigid: &motions,
        },
        &shapes,
    );
    add_turning(&mut constants, &mesh.point_masses, &full.freedoms, &shapes);
    for (i, lambda) in set.eigenvalues.iter().enumerate() {
        let ratio = damping_ratio(request, frequencies[i]);
        constants.damping[i * set.len() + i] = 2.0 * ratio * libm::sqrt(lambda.max(0.0));
    }
    if request.geometric_stiffness {
        let model = Model {
            mesh: &mesh,
            full: &full,
            rules: &request.rules,
            reduction: &reduction,
            structure: &structure,
            motions: &motions,
        };
        let loads = marker_freedoms.loaded()?;
        constants.geometric = Some(geometric(&model, &shapes, &loads)?);
    }
    let n = set.len();
    let markers = request
        .markers
        .iter()
        .zip(&places)
        .map(|(marker, node)| {
            let rows = |first: u8| -> Vec<f64> {
                (first..first + 3)
                    .flat_map(|component| (0..n).map(move |mode| (component, mode)))
                    .map(|(component, mode)| {
                        full.freedoms
                            .freedom(*node, component)
                            .map_or(0.0, |f| shapes[mode * full.freedoms.size() + f])
                    })
                    .collect()
            };
            ReducedMarker {
                name: marker.name.clone(),
                position: mesh.nodes[*node as usize].position,
                translation: rows(0),
                rotation: rows(3),
            }
        })
        .collect();
    let report = Report {
        nodes: nodes.0,
        elements: nodes.1,
        freedoms: size,
        sources: set.sources,
        dropped: set.dropped,
        sturm,
    };
    Ok(Reduced {
        body: ReducedBody {
            invariants: constants,
            frequencies,
            markers,
        },
        shapes,
        freedoms: full.freedoms,
        mesh,
        report,
    })
}

/// The stated ratio up to a frequency, rising with it to one at five times that.
fn damping_ratio(request: &Request, frequency: f64) -> f64 {
    let (ratio, limit) = (request.damping_ratio, request.damping_up_to);
    if frequency <= limit {
        ratio
    } else {
        let share = ((frequency - limit) / (4.0 * limit)).min(1.0);
        ratio + share * (1.0 - ratio).max(0.0)
    }
}

/// Rigid motions over the free freedoms.
fn free_motions(reduction: &Reduction, motions: &[f64]) -> Vec<f64> {
    let size = reduction.full_size();
    motions
        .chunks_exact(size.max(1))
        .flat_map(|motion| reduction.free().iter().map(|f| motion[*f as usize]))
        .collect()
}

struct MarkerFreedoms<'a> {
    request: &'a Request,
    places: &'a [u32],
    freedoms: &'a FreedomMap,
}

impl MarkerFreedoms<'_> {
    /// Labels and full freedoms of an interface.
    fn freedoms(&self, interface: &Interface) -> Result<Vec<(String, usize)>, FlexibleError> {
        let (Some(marker), Some(node)) = (
            self.request.markers.get(interface.marker),
            self.places.get(interface.marker),
        ) else {
            return Err(FlexibleError::Structure {
                problem: format!("there is no marker {}", interface.marker),
                advice: String::new(),
            });
        };
        let mut found = Vec::new();
        for component in (0..6u8).filter(|c| interface.components & (1 << c) != 0) {
            let name = format!("{}.{}", marker.name, COMPONENTS[usize::from(component)]);
            match self.freedoms.freedom(*node, component) {
                Some(freedom) => found.push((name, freedom)),
                None => {
                    return Err(FlexibleError::Structure {
                        problem: format!("{name}: the node of a solid does not turn"),
                        advice:
                            "gather nodes by a ring or a set, tied by a spider: its centre turns"
                                .into(),
                    });
                }
            }
        }
        Ok(found)
    }

    /// The freedoms that static modes load, each once: marker, component, full freedom.
    fn loaded(&self) -> Result<Vec<(usize, u8, usize)>, FlexibleError> {
        let mut loaded = Vec::new();
        let terms = self.request.terms.iter();
        for interface in terms.filter_map(|term| match term {
            Term::Static(at) => Some(at),
            _ => None,
        }) {
            for interface in interface {
                let components = (0..6u8).filter(|c| interface.components & (1 << c) != 0);
                for (component, (_, freedom)) in components.zip(self.freedoms(interface)?) {
                    let load = (interface.marker, component, freedom);
                    if !loaded.contains(&load) {
                        loaded.push(load);
                    }
                }
            }
        }
        Ok(loaded)
    }

    /// Labels and free freedoms of interfaces that are to be held.
    fn free(
        &self,
        at: &[Interface],
        reduction: &Reduction,
    ) -> Result<(Vec<String>, Vec<u32>), FlexibleError> {
        let (mut labels, mut freedoms) = (Vec::new(), Vec::new());
        for interface in at {
            for (label, freedom) in self.freedoms(interface)? {
                match reduction.row(freedom) {
                    ([free], [factor]) if *factor == 1.0 => {
                        freedoms.push(*free);
                        labels.push(label);
                    }
                    _ => {
                        return Err(FlexibleError::Structure {
                            problem: format!("{label} follows other nodes and can't be held"),
                            advice: "hold a rigid spider's centre or a node; at an averaging spider use attachment modes (`static`)".into(),
                        });
                    }
                }
            }
        }
        Ok((labels, freedoms))
    }
}
