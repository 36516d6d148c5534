//! The results of a reduction for tables and lints.

use crate::fe::{Inventory, RigidMass};
use crate::mesh::WeightCheck;
use crate::modes::Dropped;
use crate::solve::SturmCount;
use serde::{Deserialize, Serialize};

/// The results of a reduction, for tables.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
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
    /// The proofs that no normal mode is missing, one for each term of normal modes.
    pub sturm: Vec<SturmCount>,
    /// Whether the body is held, by the request or because the foreign matrices belong to a held structure.
    pub supported: bool,
    /// The largest part of the forces of a rigid motion, freedom by freedom, that the stiffness does not
    /// cancel. It measures the rounding of the entries: about 1e-16 for own matrices, 1e-14 for files of 14
    /// digits, 1e-10 for files of 10. It is zero for foreign matrices of a held structure, where it is
    /// unknown.
    pub rigid_residual: f64,
    /// Warnings for the user, one sentence each.
    pub warnings: Vec<String>,
    /// The modes, by ascending frequency.
    pub modes: Vec<ModeReport>,
    /// Mass properties of the mass matrix.
    pub body: BodyMass,
    /// Mass properties from the volumes of elements between their corners, their densities and the point
    /// masses. `None` for a mesh without such elements.
    pub estimate: Option<BodyMass>,
    /// The mass that the mesh's file states, by a check of its own code (SI).
    pub weight_check: Option<WeightCheck>,
    /// The contents of the mesh, and the shape of its elements.
    pub inventory: Inventory,
    /// The nodes that a matrix of another code recovers.
    pub recovered: Option<RecoveredNodes>,
    /// The interface motion of each static mode, in the order of the terms.
    pub served: Vec<Served>,
    /// Requested loads without a mode.
    pub unserved: Vec<Unserved>,
}

/// Nodes whose motion a matrix of another code recovers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecoveredNodes {
    /// File and name of the matrix.
    pub title: String,
    /// Number of nodes.
    pub nodes: usize,
    /// The largest share of a rigid motion of the interface that a node misses. `None` for matrices of a held structure, whose
    /// interface does not move rigidly.
    pub deviation: Option<f64>,
}

/// A mode of the orthonormal set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModeReport {
    /// Undamped frequency (Hz).
    pub frequency: f64,
    /// Its sources in words: `normal 3`, or `static main[2].y 81 %, normal 4 17 %`.
    pub description: String,
    /// Its main sources: index into [`Report::sources`] and part of the sum of squared amplitudes, with each
    /// source scaled to the mode's own strain energy.
    pub sources: Vec<(usize, f64)>,
    /// Effective modal masses (kg; kg m² about the centre of mass) in x, y, z and about these: `(Rᵀ M φ)²`.
    /// Over all modes of a held body they sum to the mass and inertia that can move. In the mean axes of a
    /// free body they vanish.
    pub effective_mass: [f64; 6],
}

/// Mass, centre and inertia.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyMass {
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass (m).
    pub centre: [f64; 3],
    /// Inertia about the centre of mass (kg m²).
    pub inertia: [[f64; 3]; 3],
}

impl From<RigidMass> for BodyMass {
    fn from(rigid: RigidMass) -> Self {
        let centre = rigid.centre();
        let mut inertia = rigid.inertia;
        let square: f64 = centre.iter().map(|x| x * x).sum();
        for (i, row) in inertia.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let own = if i == j { square } else { 0.0 };
                *entry -= rigid.mass * (own - centre[i] * centre[j]);
            }
        }
        BodyMass {
            mass: rigid.mass,
            centre,
            inertia,
        }
    }
}

/// A static mode and the motion of a marker that it serves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Served {
    /// Label of the mode: `static main[2].y`.
    pub mode: String,
    /// Index of the marker.
    pub marker: usize,
    /// Component 0…5 in basic axes.
    pub component: u8,
    /// Displacement (m, rad) there under a unit load (N, N m), which the inertia of the body or its supports
    /// balance. `None` for the constraint modes of an interface of freedoms, which are computed without
    /// loads.
    pub flexibility: Option<f64>,
    /// Whether it is in the set. If not, modes before it span it.
    pub kept: bool,
}

/// A load without a mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unserved {
    /// `main[2].rz`.
    pub label: String,
    /// Index of the marker.
    pub marker: usize,
    /// Component 0…5 along the marker's axes.
    pub component: u8,
    /// The part of the load's static strain energy that the set does not span.
    pub missing: f64,
}

/// Part of a load's strain energy above which the set does not serve the load, if this part is missing. A
/// choice: the missing deflection is then below a thousandth in energy norm.
pub(super) const UNSERVED: f64 = 1e-6;

impl Report {
    /// The requested loads ([`super::Request::asked`]) at a marker's components (bits 0…5) without a mode in
    /// the set.
    pub fn unserved(&self, marker: usize, components: u8) -> Vec<&Unserved> {
        self.unserved
            .iter()
            .filter(|load| load.marker == marker && components >> load.component & 1 == 1)
            .collect()
    }
}

/// Sources of a mode with their part of its squared amplitudes, and the description in words.
pub(super) fn described(sources: &[String], amplitudes: &[f64]) -> (Vec<(usize, f64)>, String) {
    let sum: f64 = amplitudes.iter().map(|x| x * x).sum();
    let parts = amplitudes
        .iter()
        .map(|x| x * x / sum.max(f64::MIN_POSITIVE));
    let mut parts: Vec<(usize, f64)> = parts.enumerate().collect();
    parts.sort_by(|a, b| b.1.total_cmp(&a.1)); // stable: the first of equals first
    // a choice: a tenth of the energy is worth a name, and three names fit in a line
    let large = parts.iter().take_while(|(_, part)| *part >= 0.1).count();
    parts.truncate(large.clamp(1, 3));
    let name = |index: usize| sources.get(index).map_or("", String::as_str);
    let words = match parts.as_slice() {
        // it would be printed as 100 %
        [(index, part), ..] if *part > 0.995 => name(*index).to_string(),
        parts => parts
            .iter()
            .map(|(index, part)| format!("{} {:.0} %", name(*index), 100.0 * part))
            .collect::<Vec<_>>()
            .join(", "),
    };
    (parts, words)
}
