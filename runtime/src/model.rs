//! A compiled model bound to one parameter set.
//!
//! Numbers replace slots, and offsets replace references.

mod bind;

use crate::body::{BodyKind, BodyModel};
pub use crate::chain::MarkerModel;
use crate::error::NamedRow;
use crate::rotation::V3;
use crate::surface::SurfaceModel;
use crate::thread_pool::ThreadPool;
use eng_system::code::Compiled;
use eng_system::dense::largest_scaled;
use eng_system::dimension::Dimension;
use eng_system::field::FieldKernel;
use eng_system::system::{ElementClass, Slot};
use std::sync::Arc;

/// Share of the position tolerance that the error of one step may have. Accelerations and small reactions are
/// second derivatives of the positions. In an engine with film bearings this share keeps them right within a
/// per cent of their own swing, and positions far better.
pub const STEP_SHARE: f64 = 0.1;
/// Largest position tolerance as a part of the model's length. A choice: with [`STEP_SHARE`] a step is right to 1e-7 of
/// the length.
pub const TOLERANCE_OF_LENGTH: f64 = 1e-6;
/// Least error of a step, as a share of the model's length, that is distinguishable from rounding: about a
/// hundred rounding units of a position.
pub const LEAST_ERROR: f64 = 1e-14;

/// An element with its numbers and its offsets in the model's vectors.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementModel {
    /// Index of the class.
    pub class: usize,
    /// Indices of its markers.
    pub markers: Vec<usize>,
    /// Values of its constants, at the start of a run.
    pub constants: Vec<f64>,
    /// Its constants that follow the inputs: places among the constants and among the slots that move.
    pub moving: Vec<(usize, usize)>,
    /// First of its states.
    pub state: usize,
    /// First of its multipliers, for dynamic elements.
    pub row: usize,
    /// First of its rotation references.
    pub rotation: usize,
    /// First of its wrench numbers, six for each marker.
    pub wrench: usize,
    /// First of its entries among the constraint gradients, rows × 6 markers.
    pub gradient: usize,
    /// First of the numbers that its fields remember.
    pub memory: usize,
    /// Whether it takes part in the motion.
    pub dynamic: bool,
}

/// A model with numbers.
#[derive(Clone, Debug)]
pub struct Model {
    /// System and code.
    pub compiled: Compiled,
    /// Values of the slots.
    pub slots: Vec<f64>,
    /// Values of the parameters.
    pub parameters: Vec<f64>,
    /// Stated values of the parameters.
    pub overrides: Vec<Option<f64>>,
    /// Values of the bind graph at the start of a run; empty for a system without inputs.
    pub nodes: Vec<eng_system::code::Pair>,
    /// Messages of the bind graph.
    pub advice: Vec<eng_system::code::Advice>,
    /// Bodies.
    pub bodies: Vec<BodyModel>,
    /// Markers.
    pub markers: Vec<MarkerModel>,
    /// Elements.
    pub elements: Vec<ElementModel>,
    /// Kernels of the fields of each element.
    pub kernels: Vec<Vec<Arc<dyn FieldKernel>>>,
    /// Threads that work on them; none if there is one thread.
    pub thread_pool: Option<Arc<ThreadPool>>,
    /// Count of numbers that the fields remember.
    pub memory: usize,
    /// Elastic surfaces that fields press on.
    pub surfaces: Vec<SurfaceModel>,
    /// Gravity (m/s²).
    pub gravity: V3,
    /// Pose numbers.
    pub poses: usize,
    /// Velocities.
    pub velocities: usize,
    /// States of dynamic elements.
    pub states: usize,
    /// Positive scale of each state, against which its errors are measured.
    pub state_scales: Vec<f64>,
    /// Circular frequency (rad/s) of the mode of each velocity; zero without a mode, or if it is unknown.
    pub frequencies: Vec<f64>,
    /// Constraint rows of dynamic elements.
    pub rows: usize,
    /// Rotation references.
    pub rotations: usize,
    /// Wrench numbers.
    pub wrenches: usize,
    /// Constraint gradient numbers.
    pub gradients: usize,
    /// Length of the model (m), which scales positions against angles. It is the largest distance of a marker
    /// from its body's origin or centre of mass, or the largest radius of gyration if that is a hundred times
    /// larger.
    pub length: f64,
    /// Largest mass (kg), which scales forces.
    pub mass: f64,
    /// Position tolerance (m), physical: see [`Model::bind`].
    pub tolerance: f64,
}

impl Model {
    /// The class of an element.
    pub fn class(&self, element: usize) -> &ElementClass {
        &self.compiled.system.classes[self.elements[element].class]
    }

    /// Whether an element constrains: it acts, and its class has constraint equations.
    pub fn constrains(&self, element: usize) -> bool {
        self.elements[element].dynamic && !self.class(element).rows.is_empty()
    }

    /// The elements that constrain, in their order.
    pub fn constraining(&self) -> impl Iterator<Item = usize> {
        (0..self.elements.len()).filter(|element| self.constrains(*element))
    }

    /// The element and the name of a state, by its place among all states.
    pub fn state_named(&self, state: usize) -> Option<(usize, &str)> {
        // elements that do not act have no states
        let acts = |e: &usize| self.elements[*e].dynamic;
        (0..self.elements.len()).filter(acts).find_map(|element| {
            let place = state.checked_sub(self.elements[element].state)?;
            let info = self.class(element).states.get(place)?;
            Some((element, info.name.as_str()))
        })
    }

    /// Value of a slot; 0 for one that does not exist.
    pub fn slot(&self, slot: Slot) -> f64 {
        self.slots.get(slot.0 as usize).copied().unwrap_or(0.0)
    }

    /// Unit of a constraint row in the scaled system: the model's length for a length, else one.
    pub fn row_scale(&self, element: usize, row: usize) -> f64 {
        if self.class(element).rows[row].dimension == Dimension::LENGTH {
            self.length
        } else {
            1.0
        }
    }

    /// Element and row within it of a row of the dynamic system.
    pub fn row_owner(&self, row: usize) -> Option<(usize, usize)> {
        self.elements.iter().enumerate().find_map(|(index, e)| {
            let count = self.compiled.system.classes[e.class].rows.len();
            (e.dynamic && (e.row..e.row + count).contains(&row)).then(|| (index, row - e.row))
        })
    }

    /// A row with its names.
    pub fn named_row(&self, element: usize, row: usize, value: f64) -> NamedRow {
        let info = &self.class(element).rows[row];
        NamedRow {
            origin: self.compiled.system.elements[element].origin.clone(),
            equation: info.text.clone(),
            value,
            is_length: info.dimension == Dimension::LENGTH,
        }
    }

    /// Largest of velocities or accelerations, each over its scale.
    pub fn largest(&self, rates: &[f64]) -> f64 {
        largest_scaled(rates, &self.velocity_scales())
    }

    /// Scale of each velocity: the length for a translation, one for a rotation, and for a modal rate the
    /// amplitude that moves a marker by the length. In m for translations, 1 for rotations, and in the unit
    /// of the amplitude.
    pub fn velocity_scales(&self) -> Vec<f64> {
        let mut scales = vec![1.0; self.velocities];
        for body in &self.bodies {
            scales[body.velocity..body.velocity + 3].fill(self.length);
        }
        // the scale of an amplitude follows from the mean displacement of the body's mass, or of its markers
        // if that is larger
        for body in &self.bodies {
            if let BodyKind::Flexible(flexible) = &body.kind {
                let constants = &flexible.constants;
                let n = constants.modes;
                for i in 0..n {
                    let share = constants.modal_mass[i * n + i] / constants.mass;
                    scales[body.velocity + 6 + i] = self.length / libm::sqrt(share);
                }
            }
        }
        for marker in &self.markers {
            let (Some(b), Some(shape)) = (marker.body, &marker.shape) else {
                continue;
            };
            let (first, n) = (self.bodies[b].velocity + 6, self.bodies[b].modes());
            for (i, x) in shape.rows()[..3 * n].iter().enumerate() {
                let reach = self.length / x.abs();
                let scale = &mut scales[first + i % n];
                *scale = scale.min(reach);
            }
        }
        for scale in &mut scales {
            if !scale.is_finite() {
                *scale = 1.0;
            }
        }
        scales
    }

    /// Scale of each constraint row.
    pub fn row_scales(&self) -> Vec<f64> {
        let mut scales = vec![1.0; self.rows];
        for (index, element) in self.elements.iter().enumerate() {
            if element.dynamic {
                for row in 0..self.class(index).rows.len() {
                    scales[element.row + row] = self.row_scale(index, row);
                }
            }
        }
        scales
    }
}
