//! Integration of the linearised equations along a motion, together with their coordinates.
//!
//! Radau IIA of three stages has order 5 and is L-stable. So motions that decay fast compared with the step
//! (films, static modes) vanish. Gauss' or the trapezoidal rule would leave false multipliers near 1 (E.
//! Hairer, G. Wanner, Solving Ordinary Differential Equations II, 1996, IV.5).
//!
//! **Coordinates.** At every stage the equations have coordinates of their own, `u = N_s x_s` with
//! `N_sᵀMN_s = 1`. The coordinates of the integration follow the same stages: `Ṅ = Ṅ_s P`, `N = N_s P`,
//! `P = N_sᵀMN`, which keeps N tangent. The matrices of `ẍ + C ẋ + K x = S z` become `P⁻¹CP`, `P⁻¹KP`,
//! `P⁻¹S`. P is not orthogonal, because NᵀMN changes with the mass matrix, for example of a turning body of
//! unequal inertia. If N were made orthonormal on the way, its rate would differ from the Ṅ in the equations.

use super::super::equations::Equations;
use nalgebra::DMatrix;

/// Most iterations for N. Each reduces the error by about the angle of a step. A choice: with 256 steps a
/// turn that angle is 0.025, and ten rounds reach rounding.
const ROUNDS: usize = 60;
/// Change of P that counts as rounding: some rounding units.
const SETTLED: f64 = 1e-15;

/// Stages c, the matrix a, and a².
pub struct Tableau {
    /// Positions of the stages in the step; the last is 1.
    pub places: [f64; 3],
    once: [[f64; 3]; 3],
    twice: [[f64; 3]; 3],
}

/// Radau IIA of three stages.
pub fn radau() -> Tableau {
    let root = libm::sqrt(6.0);
    let once = [
        [
            (88.0 - 7.0 * root) / 360.0,
            (296.0 - 169.0 * root) / 1800.0,
            (3.0 * root - 2.0) / 225.0,
        ],
        [
            (296.0 + 169.0 * root) / 1800.0,
            (88.0 + 7.0 * root) / 360.0,
            (-2.0 - 3.0 * root) / 225.0,
        ],
        [(16.0 - root) / 36.0, (16.0 + root) / 36.0, 1.0 / 9.0],
    ];
    let twice = std::array::from_fn(|i: usize| {
        std::array::from_fn(|k: usize| (0..3).map(|j| once[i][j] * once[j][k]).sum())
    });
    Tableau {
        places: [(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0],
        once,
        twice,
    }
}

/// `ẍ + C ẋ + K x = S z`, `ż = R x + T ẋ + U z` at a stage, in the coordinates of the integration.
pub struct Stage {
    /// K.
    pub stiffness: DMatrix<f64>,
    /// C.
    pub damping: DMatrix<f64>,
    /// S.
    pub by_states: DMatrix<f64>,
    /// R.
    pub rates_by_place: DMatrix<f64>,
    /// T.
    pub rates_by_velocity: DMatrix<f64>,
    /// U.
    pub rates_by_states: DMatrix<f64>,
}

impl Stage {
    /// A stage from equations with `x_s = P x`; `None` if P has no inverse.
    fn turned(equations: &Equations, turn: &DMatrix<f64>) -> Option<Stage> {
        let back = turn.clone().try_inverse()?;
        Some(Stage {
            stiffness: &back * &equations.stiffness * turn,
            damping: &back * &equations.damping * turn,
            by_states: &back * &equations.by_states,
            rates_by_place: &equations.rates_by_place * turn,
            rates_by_velocity: &equations.rates_by_velocity * turn,
            rates_by_states: equations.rates_by_states.clone(),
        })
    }
}

/// P at the three stages for N (velocities × freedoms) at the beginning of a step h (s).
fn carried(
    tableau: &Tableau,
    basis: &DMatrix<f64>,
    stages: [&Equations; 3],
    h: f64,
) -> [DMatrix<f64>; 3] {
    let across = stages.map(|e| e.basis.transpose() * &e.mass);
    let mut turns: [DMatrix<f64>; 3] = std::array::from_fn(|j| &across[j] * basis);
    if stages.iter().any(|e| e.basis_rate.amax() > 0.0) {
        for _ in 0..ROUNDS {
            let rates: [DMatrix<f64>; 3] =
                std::array::from_fn(|k| &stages[k].basis_rate * &turns[k] * h);
            let next: [DMatrix<f64>; 3] = std::array::from_fn(|j| {
                let [a, b, c] = tableau.once[j];
                &across[j] * (basis + &rates[0] * a + &rates[1] * b + &rates[2] * c)
            });
            let change = (0..3).fold(0.0_f64, |most, j| most.max((&next[j] - &turns[j]).amax()));
            turns = next;
            if change <= SETTLED {
                break;
            }
        }
    }
    turns
}

/// One step h (s) of `ξ̇ = A ξ` for all columns of ξ = (x, ẋ, z); `None` without a solution.
///
/// The unknowns are the slopes of ẋ and z at the stages. x follows by integrating twice.
pub fn step(
    tableau: &Tableau,
    stages: &[Stage; 3],
    start: &DMatrix<f64>,
    h: f64,
) -> Option<DMatrix<f64>> {
    let p = stages[0].stiffness.nrows();
    let s = stages[0].rates_by_states.nrows();
    let q = p + s;
    let columns = start.ncols();
    let x = start.rows(0, p);
    let y = start.rows(p, p);
    let z = start.rows(2 * p, s);
    let mut matrix = DMatrix::identity(3 * q, 3 * q);
    let mut right = DMatrix::zeros(3 * q, columns);
    for (j, stage) in stages.iter().enumerate() {
        let moved = x + y * (h * tableau.places[j]);
        let load = &stage.by_states * z - &stage.stiffness * &moved - &stage.damping * y;
        right.view_mut((j * q, 0), (p, columns)).copy_from(&load);
        let rate = &stage.rates_by_place * &moved
            + &stage.rates_by_velocity * y
            + &stage.rates_by_states * z;
        right
            .view_mut((j * q + p, 0), (s, columns))
            .copy_from(&rate);
        for k in 0..3 {
            let (one, two) = (h * tableau.once[j][k], h * h * tableau.twice[j][k]);
            let mut add = |row: usize, column: usize, block: DMatrix<f64>| {
                let mut view = matrix.view_mut((j * q + row, k * q + column), block.shape());
                view += block;
            };
            add(0, 0, &stage.stiffness * two + &stage.damping * one);
            add(0, p, &stage.by_states * -one);
            add(
                p,
                0,
                &stage.rates_by_place * -two + &stage.rates_by_velocity * -one,
            );
            add(p, p, &stage.rates_by_states * -one);
        }
    }
    let slopes = matrix.lu().solve(&right)?;
    let mut end = start.clone();
    let mut whole = end.view_mut((0, 0), (p, columns));
    whole += y * h;
    for k in 0..3 {
        let slope = slopes.view((k * q, 0), (p, columns));
        let mut place = end.view_mut((0, 0), (p, columns));
        place += slope * (h * h * tableau.twice[2][k]);
        let mut rate = end.view_mut((p, 0), (p, columns));
        rate += slope * (h * tableau.once[2][k]);
        let of_states = slopes.view((k * q + p, 0), (s, columns));
        let mut states = end.view_mut((2 * p, 0), (s, columns));
        states += of_states * (h * tableau.once[2][k]);
    }
    end.iter().all(|x| x.is_finite()).then_some(end)
}

/// The state of the integration: the present N, and ξ of all unit starts since the beginning of the segment.
pub(super) struct March {
    tableau: Tableau,
    /// N.
    pub basis: DMatrix<f64>,
    /// P: `N = N_s P` with the N_s of the equations there.
    pub turn: DMatrix<f64>,
    /// X: columns are ξ for unit starts at the beginning of the segment.
    pub solution: DMatrix<f64>,
    /// X of the finished segments.
    pub segments: Vec<DMatrix<f64>>,
}

impl March {
    /// The state at the beginning of the motion.
    pub fn new(start: &Equations) -> March {
        let size = start.first_order_size();
        March {
            tableau: radau(),
            basis: start.basis.clone(),
            turn: DMatrix::identity(start.freedoms(), start.freedoms()),
            solution: DMatrix::identity(size, size),
            segments: Vec::new(),
        }
    }

    /// A step h (s) with the equations at its three stages; `None` without a solution.
    pub fn step(&mut self, stages: [&Equations; 3], h: f64) -> Option<()> {
        let turns = carried(&self.tableau, &self.basis, stages, h);
        let own = [
            Stage::turned(stages[0], &turns[0])?,
            Stage::turned(stages[1], &turns[1])?,
            Stage::turned(stages[2], &turns[2])?,
        ];
        self.solution = step(&self.tableau, &own, &self.solution, h)?;
        let [_, _, turn] = turns;
        self.basis = &stages[2].basis * &turn;
        self.turn = turn;
        Some(())
    }

    /// Ends a segment and begins the next.
    pub fn end_segment(&mut self) {
        let size = self.solution.nrows();
        let done = std::mem::replace(&mut self.solution, DMatrix::identity(size, size));
        self.segments.push(done);
    }

    /// Ends the last segment, which ends at the beginning of the motion. There N returns as N(0) Q,
    /// `Q = N(0)ᵀ M N(T)`.
    pub fn close(&mut self, start: &Equations) {
        self.end_segment();
        let p = start.freedoms();
        let turn = start.basis.transpose() * &start.mass * &self.basis;
        if let Some(last) = self.segments.last_mut() {
            for first in [0, p] {
                let turned = &turn * last.rows(first, p);
                last.rows_mut(first, p).copy_from(&turned);
            }
        }
    }
}
