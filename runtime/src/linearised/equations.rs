//! The linearised equations of motion in as many coordinates as there are freedoms.
//!
//! See the head of [`super`] for the formulas. All terms are exact except for rounding: blocks of Newton's
//! matrix, the rate of the constraint gradients by polarisation of γ (a quadratic form of the velocities),
//! and the rate of the mass matrix by differences of a quadratic form.

use super::axes::GroundAxes;
use super::outputs::Direction;
use crate::acceleration::AccelerationSystem;
use crate::body::{BodyFrame, Weights};
use crate::dynamics::Dynamics;
use crate::dynamics::MatrixPlan;
use crate::elements::Replaced;
use crate::error::{Moment, RuntimeError};
use crate::flexible::Work;
use crate::linear::Pattern;
use crate::model::Model;
use crate::state::State;
use crate::topology::undetermined;
use eng_system::dense::{largest, largest_scaled};
use eng_system::field::FieldKernel;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Weight of velocities (rad/s) for separating the blocks of Newton's matrix. It is about the fastest mode of
/// a static set, so that neither stiffness nor damping is lost in rounding. A power of two causes no rounding
/// itself.
const PACE: f64 = 131_072.0;
/// Share of a unit row below which a pivot counts as zero. A choice: the state is projected to 1e-12, and
/// elimination adds some digits of rounding.
const RANK_LIMIT: f64 = 1e-10;

/// `ẍ = −K x − C ẋ + S z`, `ż = R x + T ẋ + U z` about a state, x as many as there are freedoms.
#[derive(Clone, Debug)]
pub struct Equations {
    /// N (velocities × freedoms): moves of the bodies that no constraint prevents, with rotations in ground
    /// axes. `NᵀMN = 1`.
    pub basis: DMatrix<f64>,
    /// Ṅ along the motion.
    pub basis_rate: DMatrix<f64>,
    /// M of all bodies, rotations in ground axes.
    pub mass: DMatrix<f64>,
    /// K (1/s²).
    pub stiffness: DMatrix<f64>,
    /// C (1/s).
    pub damping: DMatrix<f64>,
    /// S.
    pub by_states: DMatrix<f64>,
    /// R.
    pub rates_by_place: DMatrix<f64>,
    /// T.
    pub rates_by_velocity: DMatrix<f64>,
    /// U.
    pub rates_by_states: DMatrix<f64>,
    /// Rate (rad/s) of the motion that the largest terms of K and C, or the state's own motion and weight,
    /// would cause alone. If they cancel, their rounding remains.
    pub rate_scale: f64,
    /// Sums of the absolute terms of K (1/s²) and C (1/s). The uncertainty of the entries is n roundings of
    /// these sums.
    pub stiffness_terms: DMatrix<f64>,
    /// See `stiffness_terms`.
    pub damping_terms: DMatrix<f64>,
    /// The terms of K (1/s²) from the motion and the weight of the state itself.
    pub own_terms: f64,
    /// Derivatives of elements at kinks, by which those at the state were replaced (see `sides`).
    pub(super) replaced: Replaced,
    axes: GroundAxes,
}

/// Blocks of Newton's matrix; rotations and torques in ground axes.
struct Blocks {
    mass: DMatrix<f64>,
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// G.
    gradients: DMatrix<f64>,
    /// ∂/∂z of the equations of motion.
    forces_by_states: DMatrix<f64>,
    /// ∂f/∂q, ∂f/∂v, ∂f/∂z of ż = f.
    rates_by_place: DMatrix<f64>,
    rates_by_velocity: DMatrix<f64>,
    rates_by_states: DMatrix<f64>,
}

fn dense(pattern: &Pattern, values: &[f64]) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(pattern.size(), pattern.size());
    for (row, column, value) in pattern.entries(values) {
        out[(row, column)] = value;
    }
    out
}

impl Blocks {
    /// The blocks at the evaluated state of the dynamics.
    fn new(
        model: &Model,
        dynamics: &mut Dynamics,
        state: &State,
        axes: &GroundAxes,
    ) -> Result<Blocks, RuntimeError> {
        let plan = MatrixPlan::new(model);
        let still = vec![0.0; model.velocities];
        let mut values = vec![0.0; plan.pattern.count()];
        let mut filled = |acceleration: f64, velocity: f64| {
            let weights = Weights {
                acceleration,
                velocity,
            };
            let (v, a) = (&state.velocity, &state.acceleration);
            plan.fill(model, dynamics, v, a, &still, weights, 0.0, &mut values)?;
            Ok::<_, RuntimeError>(dense(&plan.pattern, &values))
        };
        let mut place = filled(0.0, 0.0)?;
        let mut velocity = (filled(0.0, PACE)? - &place) / PACE;
        let mut acceleration = (filled(PACE * PACE, 0.0)? - &place) / (PACE * PACE);
        for matrix in [&mut place, &mut velocity, &mut acceleration] {
            axes.columns(matrix);
        }
        let (n, s, m) = (model.velocities, model.states, model.rows);
        let view =
            |matrix: &DMatrix<f64>, row: usize, column: usize, rows: usize, columns: usize| {
                matrix.view((row, column), (rows, columns)).into_owned()
            };
        let gradients = view(&place, n + s, 0, m, n);
        let rates_by_place = -view(&place, n, 0, s, n);
        let rates_by_velocity = -view(&velocity, n, 0, s, n);
        let rates_by_states = -view(&place, n, n, s, s);
        for matrix in [&mut place, &mut velocity, &mut acceleration] {
            axes.rows(matrix);
        }
        let mass = view(&acceleration, 0, 0, n, n);
        let damping = view(&velocity, 0, 0, n, n) - axes.times_turning(&mass);
        Ok(Blocks {
            stiffness: view(&place, 0, 0, n, n),
            forces_by_states: view(&place, 0, n, n, s),
            mass,
            damping,
            gradients,
            rates_by_place,
            rates_by_velocity,
            rates_by_states,
        })
    }
}

/// Mass-orthonormal basis of the moves with `G x = 0`. Shape: velocities × freedoms.
fn allowed(
    model: &Model,
    mass: &DMatrix<f64>,
    gradients: &DMatrix<f64>,
    moment: Moment,
) -> Result<DMatrix<f64>, RuntimeError> {
    let (n, m) = (model.velocities, model.rows);
    let scales = model.velocity_scales();
    let singular = || {
        let scaled = DMatrix::from_fn(m, n, |i, j| gradients[(i, j)] * scales[j]);
        undetermined(model, &scaled, moment)
    };
    if m > n {
        return Err(singular());
    }
    // rows of G as columns, as angles, of unit length; zeros make the matrix square, so that Q is whole
    let mut turned = DMatrix::zeros(n, n);
    for i in 0..m {
        let row = DVector::from_fn(n, |j, _| gradients[(i, j)] * scales[j]);
        let size = row.norm();
        if size > 0.0 {
            turned.set_column(i, &(row / size));
        }
    }
    let decomposition = turned.col_piv_qr();
    let corner = decomposition.r();
    if (0..m).any(|i| corner[(i, i)].abs() < RANK_LIMIT) {
        return Err(singular());
    }
    let mut free = decomposition.q().columns(m, n - m).into_owned();
    for (i, scale) in scales.iter().enumerate() {
        free.row_mut(i).scale_mut(*scale);
    }
    let own = free.transpose() * mass * &free;
    let root = ((&own + own.transpose()) * 0.5)
        .cholesky()
        .ok_or_else(&singular)?;
    // N Lᵀ = Z
    let basis = root
        .l()
        .solve_lower_triangular(&free.transpose())
        .ok_or_else(&singular)?;
    Ok(basis.transpose())
}

/// Adds Ṁ of the bodies' change of shape, rotations in ground axes. M is quadratic in the amplitudes: a
/// central difference is exact.
fn add_reshaping(
    model: &Model,
    dynamics: &Dynamics,
    state: &State,
    axes: &GroundAxes,
    out: &mut DMatrix<f64>,
) {
    let mut change = DMatrix::zeros(out.nrows(), out.ncols());
    let mut work = Work::default();
    for (index, body) in model.bodies.iter().enumerate() {
        let first = body.velocity;
        let rates = &state.velocity[first + 6..first + body.width()];
        let fastest = largest(rates);
        if fastest == 0.0 {
            continue;
        }
        let frame = dynamics.frame(model, index);
        let width = body.width();
        let bent = largest(frame.amplitudes);
        let reach = if bent > 0.0 { bent } else { 1.0 } / fastest;
        let mut at = |sign: f64| {
            let amplitudes: Vec<f64> = frame
                .amplitudes
                .iter()
                .zip(rates)
                .map(|(a, rate)| a + sign * reach * rate)
                .collect();
            let moved = BodyFrame {
                amplitudes: &amplitudes,
                ..frame
            };
            let mut block = vec![0.0; width * width];
            body.add_mass(&moved, &mut work, &mut block);
            DMatrix::from_row_slice(width, width, &block)
        };
        let rate = (at(1.0) - at(-1.0)) / (2.0 * reach);
        change
            .view_mut((first, first), (width, width))
            .copy_from(&rate);
    }
    axes.columns(&mut change);
    axes.rows(&mut change);
    *out += change;
}

/// `Ġ N` in ground axes, rows × freedoms.
///
/// γ is minus a quadratic form of the velocities. Its polarisation along u gives a sum of two terms:
/// `Ġ u`, with the rate of the gradient along the motion, and `∂Φ̇/∂q u`. In body axes the two differ
/// by G of the bracket `ω × u`. In ground axes `Ġ N` is the second one.
fn gradient_rates(
    model: &Model,
    dynamics: &mut Dynamics,
    state: &State,
    axes: &GroundAxes,
    gradients: &DMatrix<f64>,
    basis: &DMatrix<f64>,
) -> Result<DMatrix<f64>, RuntimeError> {
    let scales = model.velocity_scales();
    let size = |x: &[f64]| largest_scaled(x, &scales);
    let rate_scale = match size(&state.velocity) {
        0.0 => 1.0,
        speed => speed,
    };
    dynamics.constraint_gradients(model)?;
    let mut out = DMatrix::zeros(model.rows, basis.ncols());
    let mut bracket = vec![0.0; model.velocities];
    for k in 0..basis.ncols() {
        let mut along = basis.column(k).into_owned();
        axes.bracket(along.as_slice(), &mut bracket);
        axes.to_body(along.as_view_mut());
        let factor = match size(along.as_slice()) {
            0.0 => continue,
            length => rate_scale / length,
        };
        let mut gamma = |sign: f64| {
            let velocity: Vec<f64> = state
                .velocity
                .iter()
                .zip(along.iter())
                .map(|(v, u)| v + sign * factor * u)
                .collect();
            dynamics.place(model, state.time, &state.pose, &velocity);
            dynamics.gather(model, &state.states, &[], &state.rotations);
            dynamics.velocity_level(model, &velocity)?;
            Ok::<_, RuntimeError>(dynamics.constraint_accelerations().to_vec())
        };
        let (ahead, behind) = (gamma(1.0)?, gamma(-1.0)?);
        // the bracket is in body axes, G in ground axes
        let mut turned = DVector::from_column_slice(&bracket);
        axes.to_ground(turned.as_view_mut());
        let by_bracket = gradients * turned;
        for i in 0..model.rows {
            let sum = -(ahead[i] - behind[i]) / (2.0 * factor);
            out[(i, k)] = 0.5 * (sum - by_bracket[i]);
        }
    }
    Ok(out)
}

impl Equations {
    /// About a state on the constraints, with its accelerations and multipliers. An element at a kink has the
    /// derivatives of one side; [`Equations::of_both_sides`] has those of both.
    ///
    /// # Errors
    /// When an element's numbers are not finite there, or the constraints depend on each other.
    pub fn new(model: &Model, state: &State, moment: Moment) -> Result<Equations, RuntimeError> {
        Equations::with(model, state, moment, Replaced::new())
    }

    /// The same with derivatives of elements that replace those at the state.
    pub(super) fn with(
        model: &Model,
        state: &State,
        moment: Moment,
        replaced: Replaced,
    ) -> Result<Equations, RuntimeError> {
        let remembers =
            |kernels: &Vec<Arc<dyn FieldKernel>>| kernels.iter().any(|k| k.memory() > 0);
        if let Some(element) = model.kernels.iter().position(remembers) {
            let origin = &model.compiled.system.elements[element].origin;
            return Err(RuntimeError::Remembers {
                origin: Box::new(origin.clone()),
            });
        }
        let mut dynamics = Dynamics::new(model);
        dynamics.set_state(model, state, &state.multipliers);
        dynamics.evaluate(model)?;
        if let Some(element) = dynamics.undecided() {
            let origin = &model.compiled.system.elements[element].origin;
            return Err(RuntimeError::Undecided {
                origin: Box::new(origin.clone()),
                moment,
            });
        }
        dynamics.replace(&replaced);
        let axes = GroundAxes::new(model, &dynamics, &state.velocity);
        let blocks = Blocks::new(model, &mut dynamics, state, &axes)?;
        let basis = allowed(model, &blocks.mass, &blocks.gradients, moment)?;
        let freedoms = basis.ncols();

        // Ṅ: G Ṅ = −Ġ N, normal to the allowed moves in the mass norm
        let rates = gradient_rates(
            model,
            &mut dynamics,
            state,
            &axes,
            &blocks.gradients,
            &basis,
        )?;
        let mut basis_rate = DMatrix::zeros(model.velocities, freedoms);
        if model.rows > 0 {
            let mut system = AccelerationSystem::new(model)?;
            let mut same = state.clone();
            system.accelerations(model, &mut dynamics, &mut same, moment)?;
            let mut column = vec![0.0; model.velocities];
            for k in 0..freedoms {
                let wanted: Vec<f64> = rates.column(k).iter().map(|x| -x).collect();
                system.normal(model, &wanted, &mut column);
                let mut moved = DVector::from_column_slice(&column);
                axes.to_ground(moved.as_view_mut());
                basis_rate.set_column(k, &moved);
            }
        }
        dynamics.place(model, state.time, &state.pose, &state.velocity);
        let mut mass_rate = axes.turned(&blocks.mass);
        add_reshaping(model, &dynamics, state, &axes, &mut mass_rate);

        let scales = model.velocity_scales();
        let sizes = basis.abs();
        let terms = |left: &DMatrix<f64>, block: &DMatrix<f64>, right: &DMatrix<f64>| {
            left.transpose() * block.abs() * right
        };
        let rates_of_sizes = basis_rate.abs();
        let stiffness_terms = terms(&sizes, &blocks.stiffness, &sizes)
            + terms(&sizes, &blocks.damping, &rates_of_sizes)
            + terms(&rates_of_sizes, &blocks.mass, &rates_of_sizes)
            + terms(&sizes, &mass_rate, &rates_of_sizes);
        let of_damping = terms(&sizes, &blocks.damping, &sizes);
        // the forces that hold the state itself have the rounding errors of its motion
        let own = |x: &[f64]| {
            let scaled = x.iter().zip(&scales).map(|(x, s)| (x / s).abs());
            scaled.fold(0.0_f64, f64::max)
        };
        let held = own(&state.acceleration) + model.gravity.norm() / model.length;
        let turning = own(&state.velocity);
        let largest = |matrix: &DMatrix<f64>| matrix.iter().fold(0.0_f64, |w, x| w.max(*x));
        let rate_scale = largest(&of_damping)
            .max(libm::sqrt(largest(&stiffness_terms) + held))
            .max(turning);
        // the damping block is separated from the stiffness with the weight `PACE`, so it has a share of its
        // rounding
        let damping_terms = of_damping + terms(&sizes, &blocks.stiffness, &sizes) / PACE;
        let across = basis.transpose();
        let damping = &across * &blocks.damping * &basis;
        let stiffness = &across * &blocks.stiffness * &basis
            + &across * &blocks.damping * &basis_rate
            - basis_rate.transpose() * &blocks.mass * &basis_rate
            - &across * &mass_rate * &basis_rate;
        Ok(Equations {
            by_states: -(&across * &blocks.forces_by_states),
            rates_by_place: &blocks.rates_by_place * &basis
                + &blocks.rates_by_velocity * &basis_rate,
            rates_by_velocity: &blocks.rates_by_velocity * &basis,
            rates_by_states: blocks.rates_by_states,
            mass: blocks.mass,
            basis,
            basis_rate,
            stiffness,
            damping,
            rate_scale,
            stiffness_terms,
            damping_terms,
            own_terms: held + turning * turning,
            replaced,
            axes,
        })
    }

    /// Freedoms.
    pub fn freedoms(&self) -> usize {
        self.basis.ncols()
    }

    /// Numbers of ξ.
    pub fn first_order_size(&self) -> usize {
        2 * self.freedoms() + self.rates_by_states.nrows()
    }

    /// The system without constraints, `ξ̇ = A ξ` with `ξ = (x, ẋ, z)`. Shape: square, twice the freedoms and
    /// the states.
    pub fn first_order(&self) -> DMatrix<f64> {
        let (p, s) = (self.freedoms(), self.rates_by_states.nrows());
        let mut out = DMatrix::zeros(2 * p + s, 2 * p + s);
        out.view_mut((0, p), (p, p))
            .copy_from(&DMatrix::identity(p, p));
        out.view_mut((p, 0), (p, p)).copy_from(&-&self.stiffness);
        out.view_mut((p, p), (p, p)).copy_from(&-&self.damping);
        out.view_mut((p, 2 * p), (p, s)).copy_from(&self.by_states);
        out.view_mut((2 * p, 0), (s, p))
            .copy_from(&self.rates_by_place);
        out.view_mut((2 * p, p), (s, p))
            .copy_from(&self.rates_by_velocity);
        out.view_mut((2 * p, 2 * p), (s, s))
            .copy_from(&self.rates_by_states);
        out
    }

    /// The move that belongs to one coordinate of ξ.
    pub(super) fn direction(&self, k: usize) -> Direction {
        let (p, n) = (self.freedoms(), self.basis.nrows());
        let none = || DVector::zeros(n);
        let (place, velocity) = if k < p {
            let basis = self.basis.column(k).into_owned();
            (basis, self.basis_rate.column(k).into_owned())
        } else if k < 2 * p {
            (none(), self.basis.column(k - p).into_owned())
        } else {
            (none(), none())
        };
        let mut states = vec![0.0; self.rates_by_states.nrows()];
        if let Some(moved) = k.checked_sub(2 * p).and_then(|z| states.get_mut(z)) {
            *moved = 1.0;
        }
        Direction {
            place: self.in_body_axes(place).data.into(),
            velocity: self.in_body_axes(velocity).data.into(),
            states,
        }
    }

    /// Converts a vector of the runtime's moves or rates (rotations in body axes) to ground axes.
    pub fn in_ground_axes(&self, mut x: DVector<f64>) -> DVector<f64> {
        self.axes.to_ground(x.as_view_mut());
        x
    }

    /// Converts a vector of moves or rates in ground axes to the runtime's form (rotations in body axes).
    pub fn in_body_axes(&self, mut x: DVector<f64>) -> DVector<f64> {
        self.axes.to_body(x.as_view_mut());
        x
    }
}
