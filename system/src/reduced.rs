//! A flexible body after reduction.
//!
//! A time step uses its constants and no node.
//!
//! With the mass matrix M of the finite-element model, the shapes Φ (nodal vectors, n of them), the rigid
//! motions `R_t` (unit translations) and `R_r` (unit rotations about the body frame's origin), and `E_k`, the
//! infinitesimal rotation of a nodal vector about axis k (`e_k ×` on translations and on rotations of every
//! node), the nodal velocities in body axes are `w = R_t v + R_r ω + Σ ω_k E_k Φ a + Φ ȧ` and the kinetic
//! energy is `½ wᵀ M w`. Its constants are the fields of [`Invariants`]. For a solid, whose M acts alike on
//! x, y and z, they are exact; sources: A. A. Shabana, Dynamics of Multibody Systems, 4th ed. (2013), chapter
//! 5; A. Zwölfer, J. Gerstmayr, Acta Mechanica 232 (2021) 149 (consistent mass from the nodal matrices).
//!
//! Matrices are row-major. Lengths are metres, masses kilograms, amplitudes carry the unit that makes Φa a
//! displacement.

use crate::flexible::Damping;
use crate::surface::SurfaceShapes;
use serde::{Deserialize, Serialize};

/// A square matrix of the modes, or three rows of them, row-major.
pub type Block = Vec<f64>;

/// The constants of a flexible body's inertia, stiffness and damping.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Invariants {
    /// Number of modes, n.
    pub modes: usize,
    /// `m`: mass (kg).
    pub mass: f64,
    /// `Σ m s`: first moment about the frame's origin (kg m).
    pub first_moment: [f64; 3],
    /// `R_rᵀ M R_r`: inertia about the frame's origin (kg m²), row-major.
    pub inertia: [[f64; 3]; 3],
    /// `R_tᵀ M Φ` (3 × n): momentum of the modal rates.
    pub translation: Block,
    /// `R_rᵀ M Φ` (3 × n): angular momentum of the modal rates about the frame's origin.
    pub rotation: Block,
    /// `R_rᵀ M E_k Φ` (3 × n) for k = x, y, z.
    pub rotation_by_shape: [Block; 3],
    /// `Φᵀ M E_k Φ` (n × n) for k = x, y, z.
    pub coriolis: [Block; 3],
    /// The symmetric part of `Φᵀ E_jᵀ M E_k Φ` (n × n) for jk = xx, yy, zz, xy, yz, zx.
    pub centrifugal: [Block; 6],
    /// `Φᵀ M Φ` (n × n).
    pub modal_mass: Block,
    /// `Φᵀ K Φ` (n × n).
    pub stiffness: Block,
    /// Damping (n × n).
    pub damping: Block,
    /// The geometric stiffness from stresses of spin, acceleration and loads; `None` if the text does not ask
    /// for it.
    pub geometric: Option<Geometric>,
}

/// Geometric stiffness in modes: `Φᵀ K_σ Φ` (n × n, symmetric) with the initial-stress matrix `K_σ` of the
/// static stress σ under a unit of each load on the body. The modal equation has the sum of load factor times
/// block times `a` on the side of the elastic force.
///
/// To the same order a displacement `Φa` causes a second displacement `u₂(a)` with
/// `f·u₂ = −½ aᵀ(Φᵀ K_σ(f) Φ) a` for every load f, such as the shortening of a bent beam. So the blocks are
/// also the second-order parts of the body's first moment, inertia and angular momentum. The equations that
/// follow from these keep energy and momentum. (O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method,
/// vol. 2, initial-stress matrix; O. Wallrapp, R. Schwertassek, Dynamik flexibler Mehrkörpersysteme, 1998,
/// section 5.4, for the reference loads.)
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Geometric {
    /// Blocks of the centrifugal loads per `ω_j ω_k` (N/(rad/s)²), for jk = xx, yy, zz, xy, yz, zx.
    pub spin: [Block; 6],
    /// Blocks of the loads `−M R_r` per unit of angular acceleration `ω̇_k` (body axes).
    pub turn: [Block; 3],
    /// Blocks of the loads `−M R_t` per unit of `Aᵀ(r̈ − g)` (body axes).
    pub acceleration: [Block; 3],
    /// Blocks of a unit force (N) or torque (N m) at a marker.
    pub loads: Vec<MarkerStiffness>,
}

/// Geometric stiffness of a load at a marker.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct MarkerStiffness {
    /// Index of the marker.
    pub marker: usize,
    /// Component 0…5 of force and torque (body axes).
    pub component: u8,
    /// n × n, per N or N m.
    pub stiffness: Block,
}

/// A marker of a flexible body.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct ReducedMarker {
    /// Its name in the model: `main[2]`.
    pub name: String,
    /// Position of the undeformed marker in the body frame (m).
    pub position: [f64; 3],
    /// Displacement per unit of each amplitude (3 × n).
    pub translation: Block,
    /// Rotation per unit of each amplitude (rad; 3 × n).
    pub rotation: Block,
}

/// A reduced body.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct ReducedBody {
    /// The constants.
    pub invariants: Invariants,
    /// Undamped frequency of each mode (Hz), for tables and for the cut-off of the error control.
    pub frequencies: Vec<f64>,
    /// Markers.
    pub markers: Vec<ReducedMarker>,
    /// Elastic surfaces of its markers.
    pub surfaces: Vec<ReducedSurface>,
}

/// The elastic surface of a marker: its radial deflection relative to the marker's own rigid motion, in K shapes.
///
/// The amplitudes b (m, positive away from the axis) and the generalised forces `f_j = ∫ p ψ_j dA` (N) of a pressure p
/// belong together: their product is work. A load that the modes of the body see deflects the surface by
/// `Ψ a`; the rest of the static deflection follows the force at once:
///
/// ```text
/// b = Ψ a + C f        modal force Ψᵀ f        C = Ψ_static − Ψ k⁻¹ Ψᵀ
/// ```
///
/// with `Ψ_static` the amplitudes under unit forces and k the stiffness of the modes. C is symmetric and positive
/// semi-definite.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct ReducedSurface {
    /// Index of the marker.
    pub marker: usize,
    /// Its shapes.
    pub shapes: SurfaceShapes,
    /// Radius of the surface (m).
    pub radius: f64,
    /// Its width (m): ζ is −1 and 1 at its ends.
    pub width: f64,
    /// Ψ: amplitudes per unit of each mode's amplitude (K × n).
    pub content: Block,
    /// C (m/N; K × K).
    pub compliance: Block,
    /// `Ψ_static` (m/N; K × K): the deflection by slow loads, which the modes follow, too.
    pub static_compliance: Block,
}

impl ReducedBody {
    /// Sets the damping of the modes: `2 ζ ω m` on the diagonal for a ratio, `α m + β k` for Rayleigh's. A
    /// ratio needs diagonal modal mass and stiffness, which the orthonormal modes of a set have.
    pub fn damp(&mut self, damping: &Damping) {
        let constants = &mut self.invariants;
        let n = constants.modes;
        match damping {
            Damping::Modal { ratio, up_to } => {
                constants.damping = vec![0.0; n * n];
                for (i, frequency) in self.frequencies.iter().enumerate().take(n) {
                    // above the limit the ratio rises with the frequency, to one at five times the limit
                    let share = if frequency > up_to {
                        ((frequency - up_to) / (4.0 * up_to)).min(1.0)
                    } else {
                        0.0
                    };
                    let own = ratio + share * (1.0 - ratio).max(0.0);
                    let omega = 2.0 * std::f64::consts::PI * frequency;
                    let at = i * n + i;
                    constants.damping[at] = 2.0 * own * omega * constants.modal_mass[at];
                }
            }
            Damping::Rayleigh { mass, stiffness } => {
                constants.damping = constants
                    .modal_mass
                    .iter()
                    .zip(&constants.stiffness)
                    .map(|(m, k)| mass * m + stiffness * k)
                    .collect();
            }
        }
    }
}

impl Geometric {
    /// All blocks zero, no loads.
    pub fn zero(modes: usize) -> Geometric {
        let square = || vec![0.0; modes * modes];
        Geometric {
            spin: std::array::from_fn(|_| square()),
            turn: std::array::from_fn(|_| square()),
            acceleration: std::array::from_fn(|_| square()),
            loads: Vec::new(),
        }
    }

    /// Its blocks with their names.
    fn blocks(&self) -> impl Iterator<Item = (&'static str, &Block)> {
        let named = |name: &'static str| move |block| (name, block);
        let spin = self.spin.iter().map(named("spin stiffness"));
        let turn = self.turn.iter().map(named("turn stiffness"));
        let acceleration = self.acceleration.iter();
        let loads = self.loads.iter().map(|load| &load.stiffness);
        spin.chain(turn)
            .chain(acceleration.map(named("acceleration stiffness")))
            .chain(loads.map(named("load stiffness")))
    }
}

impl Invariants {
    /// Constants of a body without modes or with n of them, all zero.
    pub fn zero(modes: usize) -> Invariants {
        let square = || vec![0.0; modes * modes];
        let rows = || vec![0.0; 3 * modes];
        Invariants {
            modes,
            mass: 0.0,
            first_moment: [0.0; 3],
            inertia: [[0.0; 3]; 3],
            translation: rows(),
            rotation: rows(),
            rotation_by_shape: [rows(), rows(), rows()],
            coriolis: [square(), square(), square()],
            centrifugal: std::array::from_fn(|_| square()),
            modal_mass: square(),
            stiffness: square(),
            damping: square(),
            geometric: None,
        }
    }

    /// The first inconsistency, if there is one: lengths of blocks, numbers that are not finite, a mass that
    /// is not positive.
    pub fn defect(&self) -> Option<String> {
        let n = self.modes;
        let Some(square) = n.checked_mul(n) else {
            return Some(format!("{n} modes are too many"));
        };
        let rows = [
            ("translation", &self.translation),
            ("rotation", &self.rotation),
        ]
        .into_iter()
        .chain(
            self.rotation_by_shape
                .iter()
                .map(|b| ("rotation by shape", b)),
        )
        .map(|(name, block)| (name, block, 3 * n));
        let squares = self
            .coriolis
            .iter()
            .map(|b| ("Coriolis", b))
            .chain(self.centrifugal.iter().map(|b| ("centrifugal", b)))
            .chain([
                ("modal mass", &self.modal_mass),
                ("stiffness", &self.stiffness),
                ("damping", &self.damping),
            ])
            .chain(self.geometric.iter().flat_map(Geometric::blocks))
            .map(|(name, block)| (name, block, square));
        for (name, block, length) in rows.chain(squares) {
            if block.len() != length {
                return Some(format!(
                    "the {name} block has {} numbers, not {length}",
                    block.len()
                ));
            }
            if block.iter().any(|x| !x.is_finite()) {
                return Some(format!("the {name} block has numbers that are not finite"));
            }
        }
        let rigid = self.inertia.as_flattened().iter().chain(&self.first_moment);
        if !(self.mass > 0.0 && self.mass.is_finite()) || rigid.into_iter().any(|x| !x.is_finite())
        {
            return Some("the mass is not a positive number, or the first moment or the inertia is not finite".into());
        }
        None
    }
}
