//! The places of a mode's energy and of its losses.
//!
//! For a mode with moves x (complex) and eigenvalue λ there are three shares, each relative to the sum of
//! magnitudes over all parts:
//!
//! - **kinetic**: `Re x̄_i (M x)_i`, summed over the rigid motion of a body, and for each of its modes. These
//!   shares sum to one.
//! - **potential**: for a flexible body `Re āᵀ k a`; for an element `−Re m̄ · ∂W/∂m m` with the moves m of
//!   its markers and its wrenches W at frozen velocities. For a spring this is the strain energy, for a film
//!   the energy that its stiffness, symmetric or not, stores.
//! - **lost**: power taken out of the mode: for a flexible body `Re ā̇ᵀ c ȧ`, for an element
//!   `−Re (λ m)¯ · δW` with the whole δW. It is negative if an element feeds the mode, like a film whose
//!   cross stiffness drives whirl.
//!
//! Constraints have no potential and no losses, so the wrench of an element excludes its multipliers.

use super::equations::Equations;
use crate::body::BodyKind;
use crate::chain::{self, CURVED_REACH, Motion, Placed};
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::state::State;
use eng_system::dense::dot;
use nalgebra::{Complex, DMatrix, DVector};

/// A complex vector as its real and imaginary part.
type Parts = [DVector<f64>; 2];

/// The real and the imaginary part.
pub(super) fn parts(x: &DVector<Complex<f64>>) -> Parts {
    [x.map(|x| x.re), x.map(|x| x.im)]
}

/// A part that moves: the rigid motion of a body, or one of its modes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Index of the body.
    pub body: usize,
    /// Its path.
    pub path: String,
    /// Mode of a flexible body, from 1; `None` for its rigid motion.
    pub mode: Option<usize>,
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.mode {
            Some(mode) => write!(f, "{} mode {mode}", self.path),
            None => f.write_str(&self.path),
        }
    }
}

/// Shares of one mode, in the order of `Ledger::parts` and `Ledger::stores`.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Shares {
    /// Kinetic energy of each part.
    pub kinetic: Vec<f64>,
    /// Potential energy of each store.
    pub potential: Vec<f64>,
    /// Power lost in each store.
    pub lost: Vec<f64>,
}

/// A load with its derivatives at the state.
#[derive(Clone, Debug)]
struct Load {
    markers: Vec<usize>,
    /// ∂W/∂(moves of the markers), and along their twists.
    by_pose: DMatrix<f64>,
    by_twist: DMatrix<f64>,
}

/// Names and derivatives for the shares of any mode about one state.
#[derive(Debug)]
pub struct Ledger {
    /// The parts that move.
    pub parts: Vec<Part>,
    /// Paths of the stores of energy: flexible bodies, then elements with loads.
    pub stores: Vec<String>,
    loads: Vec<Load>,
    /// Index of each flexible body.
    flexible: Vec<usize>,
    dynamics: Dynamics,
    velocity: Vec<f64>,
}

/// The parts that move in a model, in the order of its velocities.
pub fn parts_of(model: &Model) -> Vec<Part> {
    let mut parts = Vec::new();
    for (index, body) in model.bodies.iter().enumerate() {
        let part = |mode| Part {
            body: index,
            path: body.origin.path.clone(),
            mode,
        };
        parts.push(part(None));
        parts.extend((1..=body.modes()).map(|k| part(Some(k))));
    }
    parts
}

/// Indices of the bodies and elements that store or lose energy.
fn stores_of(model: &Model) -> (Vec<usize>, Vec<usize>) {
    let bodies = (0..model.bodies.len()).filter(|b| model.bodies[*b].modes() > 0);
    let elements = (0..model.elements.len())
        .filter(|e| model.elements[*e].dynamic && model.class(*e).facts.applies_load);
    (bodies.collect(), elements.collect())
}

/// Paths of the stores of energy: flexible bodies, then elements with loads.
pub fn stores(model: &Model) -> Vec<String> {
    let (bodies, elements) = stores_of(model);
    let bodies = bodies.iter().map(|b| &model.bodies[*b].origin.path);
    let elements = elements
        .iter()
        .map(|e| &model.compiled.system.elements[*e].origin.path);
    bodies.chain(elements).cloned().collect()
}

/// Real part of the scalar product of two complex vectors, the first conjugated.
fn real_product(a: &[f64], x: &[f64], b: &[f64], y: &[f64]) -> f64 {
    dot(a, b) + dot(x, y)
}

/// Values as shares of the sum of magnitudes; zeros if all are zero.
fn shared(mut values: Vec<f64>) -> Vec<f64> {
    let sum: f64 = values.iter().map(|x| x.abs()).sum();
    if sum > 0.0 {
        values.iter_mut().for_each(|x| *x /= sum);
    }
    values
}

impl Ledger {
    /// The ledger at a state, with the derivatives of its equations.
    pub fn new(
        model: &Model,
        state: &State,
        equations: &Equations,
    ) -> Result<Ledger, RuntimeError> {
        let (flexible, loaded) = stores_of(model);
        let mut dynamics = Dynamics::new(model);
        dynamics.set_state(model, state, &[]);
        dynamics.replace(&equations.replaced);
        let mut loads: Vec<Option<Load>> = vec![None; model.elements.len()];
        dynamics.load_derivatives(model, |index, by_pose, by_twist| {
            loads[index] = Some(Load {
                markers: model.elements[index].markers.clone(),
                by_pose,
                by_twist,
            });
        })?;
        Ok(Ledger {
            parts: parts_of(model),
            stores: stores(model),
            loads: loaded
                .iter()
                .filter_map(|e| loads.get_mut(*e).and_then(Option::take))
                .collect(),
            flexible,
            dynamics,
            velocity: state.velocity.clone(),
        })
    }

    /// Moves of an element's markers, and the change of their twists, for moves and rates of the bodies
    /// (runtime's increments).
    fn markers(
        &self,
        model: &Model,
        load: &Load,
        place: &DVector<f64>,
        rate: &DVector<f64>,
    ) -> (DVector<f64>, DVector<f64>) {
        let count = 6 * load.markers.len();
        let (mut moves, mut twists) = (DVector::zeros(count), DVector::zeros(count));
        for (k, marker) in load.markers.iter().enumerate() {
            let of_model = &model.markers[*marker];
            let Some(b) = of_model.body else { continue };
            let body = &model.bodies[b];
            let range = body.velocity..body.velocity + body.width();
            let (x, rate) = (
                &place.as_slice()[range.clone()],
                &rate.as_slice()[range.clone()],
            );
            let along = self.dynamics.marker_along(model, *marker, x);
            let mut twist = self.dynamics.marker_along(model, *marker, rate);
            let frame = self.dynamics.frame(model, b);
            let placed = Placed::new(&frame, of_model);
            let reach = placed.reach();
            let velocity = &self.velocity[range];
            let mut block = [0.0; 6 * CURVED_REACH];
            let block = &mut block[..6 * reach];
            let motion = Motion::new(&frame, of_model, velocity);
            chain::twist_by_pose(&frame.rotation, &placed, &motion, block);
            let mut shape = Vec::new();
            if let Some(of_marker) = &of_model.shape {
                shape.resize(of_marker.length(), 0.0);
                of_marker.fill_rows(frame.amplitudes, &velocity[6..], &mut shape);
            }
            let mut rows = vec![0.0; 6 * body.width()];
            chain::expand(&shape, block, reach, body.width(), &mut rows);
            for (t, row) in twist.iter_mut().zip(rows.chunks_exact(body.width())) {
                *t += dot(row, x);
            }
            for i in 0..6 {
                moves[6 * k + i] = along[i];
                twists[6 * k + i] = twist[i];
            }
        }
        (moves, twists)
    }

    /// Shares of a mode with moves `place`, their rates `rate` (rotations in ground axes) and λ `value`.
    pub fn shares(
        &self,
        model: &Model,
        equations: &Equations,
        place: &DVector<Complex<f64>>,
        rate: &DVector<Complex<f64>>,
        value: Complex<f64>,
    ) -> Shares {
        let [x, y] = parts(place);
        let (mx, my) = (&equations.mass * &x, &equations.mass * &y);
        let mut kinetic = Vec::with_capacity(self.parts.len());
        for body in &model.bodies {
            let first = body.velocity;
            let own = |range: std::ops::Range<usize>| {
                real_product(
                    &x.as_slice()[range.clone()],
                    &y.as_slice()[range.clone()],
                    &mx.as_slice()[range.clone()],
                    &my.as_slice()[range],
                )
            };
            kinetic.push(own(first..first + 6));
            kinetic.extend((first + 6..first + body.width()).map(|i| own(i..i + 1)));
        }
        let (mut potential, mut lost) = (Vec::new(), Vec::new());
        for index in &self.flexible {
            let body = &model.bodies[*index];
            let BodyKind::Flexible(flexible) = &body.kind else {
                continue;
            };
            let n = body.modes();
            let range = body.velocity + 6..body.velocity + 6 + n;
            let quadratic = |block: &[f64]| {
                let product = |a: &[f64]| -> f64 {
                    // a body without modes has no rows
                    block
                        .chunks_exact(n.max(1))
                        .zip(a)
                        .map(|(row, ai)| ai * dot(row, a))
                        .sum()
                };
                product(&x.as_slice()[range.clone()]) + product(&y.as_slice()[range.clone()])
            };
            potential.push(quadratic(&flexible.constants.stiffness));
            lost.push(value.norm_sqr() * quadratic(&flexible.constants.damping));
        }
        let places = parts(place).map(|x| equations.in_body_axes(x));
        let rates = parts(rate).map(|x| equations.in_body_axes(x));
        for load in &self.loads {
            let (mx, tx) = self.markers(model, load, &places[0], &rates[0]);
            let (my, ty) = self.markers(model, load, &places[1], &rates[1]);
            let (px, py) = (&load.by_pose * &mx, &load.by_pose * &my);
            potential.push(-(mx.dot(&px) + my.dot(&py)));
            let (wx, wy) = (px + &load.by_twist * tx, py + &load.by_twist * ty);
            // λ m
            let rx = &mx * value.re - &my * value.im;
            let ry = &mx * value.im + &my * value.re;
            lost.push(-(rx.dot(&wx) + ry.dot(&wy)));
        }
        Shares {
            kinetic: shared(kinetic),
            potential: shared(potential),
            lost: shared(lost),
        }
    }
}
