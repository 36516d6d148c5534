//! Elastic surfaces: a film whose surface yields to its pressure.
//!
//! The radial deflection is a sum of the film's shapes. Their amplitudes follow the generalised forces of the
//! pressure at once, `b = C f` with a compliance C, which is symmetric and positive semi-definite. Within a step of
//! length Δ the rates of the amplitudes are `(b − b_n)/Δ`, with b_n at its beginning; in a steady film they are
//! zero. Newton's method solves
//!
//! ```text
//! g(b) = b − C f(b, ḃ) = 0        G = I − C J        J = ∂f/∂b + (1/Δ) ∂f/∂ḃ
//! dy/dx = ∂y/∂x + (∂y/∂b + (1/Δ) ∂y/∂ḃ) G⁻¹ C ∂f/∂x
//! ```
//!
//! with the exact derivatives of the film. G of an earlier iteration serves as long as it contracts.

use crate::error::{FilmError, SourceError};
use crate::film::{Film, Work};
use crate::inputs::{SHAPE_FORCE, SUPPLY};

/// Most rounds of Newton's method.
const ROUNDS: usize = 60;
/// Largest change of an amplitude that ends the rounds, as a share of the clearance.
const GOAL: f64 = 1e-13;
/// Largest ratio of two residuals that keeps G.
const CONTRACTION: f64 = 0.1;
/// Largest change of an amplitude in a round, as a share of the clearance: a larger one could close the gap.
const LONGEST: f64 = 0.5;

/// A film with a compliance of its shapes.
#[derive(Clone, Debug)]
pub struct Elastic {
    film: Film,
    /// C, row by row, m/N.
    compliance: Vec<f64>,
}

/// Memory for solutions of an elastic film.
#[derive(Clone, Debug)]
pub struct ElasticWork {
    /// Memory of the film, with its last solution.
    pub film: Work,
    inputs: Vec<f64>,
    outputs: Vec<f64>,
    slopes: Vec<f64>,
    /// Factors of G, and the order of its rows.
    matrix: Vec<f64>,
    order: Vec<usize>,
    factored: bool,
    /// Amplitudes of the last solution, and at the beginning of its step.
    amplitudes: Vec<f64>,
    before: Vec<f64>,
    step: Option<f64>,
    residual: Vec<f64>,
    column: Vec<f64>,
    /// Rounds of the last solution.
    pub rounds: usize,
}

impl Elastic {
    /// A film whose shapes have a compliance (m/N), `shapes × shapes` numbers row by row.
    ///
    /// # Errors
    /// If the compliance is not square or not symmetric, or has a negative number on its diagonal.
    pub fn new(film: Film, compliance: Vec<f64>) -> Result<Elastic, SourceError> {
        let count = film.source().shapes.len();
        let refuse = |value: f64, range: &'static str| SourceError::Range {
            name: "compliance of the surface",
            value,
            range,
        };
        if compliance.len() != count * count {
            return Err(refuse(
                compliance.len() as f64,
                "a square of the number of shapes",
            ));
        }
        let size = compliance.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
        for row in 0..count {
            let own = compliance[row * count + row];
            if !(own >= 0.0 && own.is_finite()) {
                return Err(refuse(own, "at least zero for each shape"));
            }
            for column in 0..row {
                let skew = compliance[row * count + column] - compliance[column * count + row];
                if skew.is_nan() || skew.abs() > 1e-6 * size {
                    return Err(refuse(skew, "the same for both orders of two shapes"));
                }
            }
        }
        Ok(Elastic { film, compliance })
    }

    /// Compliance of a thin ring that bends in its plane and stretches, for shapes without a change across (m/N; others
    /// zero). E modulus (Pa), A and I area (m²) and second moment of area (m⁴) of its section, R its radius (m):
    ///
    /// ```text
    /// C_0 = R/(2π E A)        C_k = R³/(π E I (k² − 1)²), k ≥ 2
    /// ```
    ///
    /// The pressure acts as the line load `q = ∫ p dz`, whose wave k deflects an inextensible ring by `q_k R⁴/(E I (k² −
    /// 1)²)` (Timoshenko & Gere, Theory of Elastic Stability, 1961, section 7.1). The wave k = 1 moves the ring as a whole,
    /// which is the motion of the shell.
    #[must_use]
    pub fn ring(film: &Film, radius: f64, modulus: f64, area: f64, inertia: f64) -> Vec<f64> {
        let shapes = &film.source().shapes;
        let count = shapes.len();
        let mut compliance = vec![0.0; count * count];
        for (at, shape) in shapes.iter().enumerate() {
            let waves = f64::from(shape.around);
            let bend = (waves * waves - 1.0) * (waves * waves - 1.0);
            compliance[at * count + at] = match (shape.around, shape.across) {
                (0, 0) => radius / (std::f64::consts::TAU * modulus * area),
                (2.., 0) => {
                    radius * radius * radius / (std::f64::consts::PI * modulus * inertia * bend)
                }
                _ => 0.0,
            };
        }
        compliance
    }

    /// The film.
    #[must_use]
    pub fn film(&self) -> &Film {
        &self.film
    }

    fn shapes(&self) -> usize {
        self.film.source().shapes.len()
    }

    /// Number of inputs: those of the film without amplitudes and their rates.
    #[must_use]
    pub fn inputs(&self) -> usize {
        SUPPLY + self.film.source().openings.len()
    }

    /// Count of numbers in the memory: the content of the film's cells and the amplitudes.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.film.memory() + self.shapes()
    }

    /// Memory for solutions.
    #[must_use]
    pub fn work(&self) -> ElasticWork {
        let count = self.shapes();
        ElasticWork {
            film: self.film.work(),
            inputs: vec![0.0; self.film.inputs()],
            outputs: vec![0.0; self.film.outputs()],
            slopes: vec![0.0; self.film.outputs() * self.film.inputs()],
            matrix: vec![0.0; count * count],
            order: vec![0; count],
            factored: false,
            amplitudes: vec![0.0; count],
            before: vec![0.0; count],
            step: None,
            residual: vec![0.0; count],
            column: vec![0.0; count],
            rounds: 0,
        }
    }

    /// Solves the film and its surface, and writes force, moment and torque. `step` and `memory` are those of
    /// [`Film::solve`], with the amplitudes behind the content.
    ///
    /// # Errors
    /// As [`Film::solve`], or if the surface finds no balance with the film.
    pub fn solve(
        &self,
        inputs: &[f64],
        step: Option<f64>,
        memory: &[f64],
        work: &mut ElasticWork,
        outputs: &mut [f64],
    ) -> Result<(), FilmError> {
        let (count, own) = (self.shapes(), self.inputs());
        let (content, before) = memory.split_at(memory.len().min(self.film.memory()));
        work.inputs[..own].copy_from_slice(inputs);
        work.step = step;
        if step.is_some() && work.before != before {
            // the search depends on the beginning of the step alone, so a run that continues from a checkpoint has
            // the same bits
            work.before.copy_from_slice(before);
            work.amplitudes.copy_from_slice(before);
            work.factored = false;
        }
        if count == 0 {
            self.evaluate(content, work)?;
            outputs.copy_from_slice(&work.outputs[..SHAPE_FORCE]);
            return Ok(());
        }
        let clearance = self.film.source().clearance;
        let mut last = f64::INFINITY;
        for round in 1..=ROUNDS {
            let solved = self.evaluate(content, work);
            if let Err(error) = solved {
                // the next search begins without factors
                work.factored = false;
                work.amplitudes.copy_from_slice(&work.before);
                return Err(error);
            }
            let size = work
                .residual
                .iter()
                .fold(0.0_f64, |size, g| size.max(g.abs()));
            if size > CONTRACTION * last {
                work.factored = false;
            }
            if !work.factored {
                self.factor(work)?;
            }
            last = size;
            solve_factored(
                &work.matrix,
                &work.order,
                &mut work.residual,
                &mut work.column,
            );
            let longest = work
                .residual
                .iter()
                .fold(0.0_f64, |size, g| size.max(g.abs()));
            if !longest.is_finite() {
                break;
            }
            if longest <= GOAL * clearance {
                work.rounds = round;
                outputs.copy_from_slice(&work.outputs[..SHAPE_FORCE]);
                return Ok(());
            }
            let share = (LONGEST * clearance / longest).min(1.0);
            for (amplitude, change) in work.amplitudes.iter_mut().zip(&work.residual) {
                *amplitude -= share * change;
            }
        }
        work.factored = false;
        work.amplitudes[..count].copy_from_slice(&work.before);
        Err(FilmError::NoSurface { rounds: ROUNDS })
    }

    /// Solves the film at the present amplitudes, and g there.
    fn evaluate(&self, content: &[f64], work: &mut ElasticWork) -> Result<(), FilmError> {
        let (count, own) = (self.shapes(), self.inputs());
        let (amplitudes, rates) = work.inputs[own..].split_at_mut(count);
        amplitudes.copy_from_slice(&work.amplitudes);
        for (rate, (now, before)) in rates
            .iter_mut()
            .zip(work.amplitudes.iter().zip(&work.before))
        {
            *rate = work.step.map_or(0.0, |step| (now - before) / step);
        }
        let (film, x) = (&mut work.film, &work.inputs);
        self.film
            .solve(x, work.step, content, film, &mut work.outputs)?;
        let forces = &work.outputs[SHAPE_FORCE..];
        for (row, residual) in work.residual.iter_mut().enumerate() {
            let line = &self.compliance[row * count..(row + 1) * count];
            let yields: f64 = line.iter().zip(forces).map(|(c, f)| c * f).sum();
            *residual = work.amplitudes[row] - yields;
        }
        Ok(())
    }

    /// Derivative of an output of the film by an amplitude, along with its rate.
    fn along(&self, work: &ElasticWork, output: usize, shape: usize) -> f64 {
        let row = &work.slopes[output * self.film.inputs()..][..self.film.inputs()];
        let (count, own) = (self.shapes(), self.inputs());
        row[own + shape]
            + work
                .step
                .map_or(0.0, |step| row[own + count + shape] / step)
    }

    /// Makes G at the film's last solution, and factors it.
    fn factor(&self, work: &mut ElasticWork) -> Result<(), FilmError> {
        let count = self.shapes();
        self.film.tangent(&mut work.film, &mut work.slopes);
        for row in 0..count {
            for column in 0..count {
                let mut sum = if row == column { 1.0 } else { 0.0 };
                for shape in 0..count {
                    let compliance = self.compliance[row * count + shape];
                    if compliance != 0.0 {
                        sum -= compliance * self.along(work, SHAPE_FORCE + shape, column);
                    }
                }
                work.matrix[row * count + column] = sum;
            }
        }
        match factor(&mut work.matrix, &mut work.order) {
            true => {
                work.factored = true;
                Ok(())
            }
            false => Err(FilmError::NoSurface { rounds: ROUNDS }),
        }
    }

    /// Derivatives of force, moment and torque by the inputs at the last solution, output by output.
    ///
    /// # Errors
    /// If the surface is unstable there.
    pub fn tangent(&self, work: &mut ElasticWork, dy_dx: &mut [f64]) -> Result<(), FilmError> {
        let (count, own) = (self.shapes(), self.inputs());
        if count == 0 {
            self.film.tangent(&mut work.film, dy_dx);
            return Ok(());
        }
        self.factor(work)?;
        let inputs = self.film.inputs();
        for (output, row) in dy_dx.chunks_exact_mut(own).enumerate() {
            row.copy_from_slice(&work.slopes[output * inputs..output * inputs + own]);
        }
        for input in 0..own {
            for row in 0..count {
                let line = &self.compliance[row * count..(row + 1) * count];
                let forces = line
                    .iter()
                    .enumerate()
                    .map(|(shape, c)| c * work.slopes[(SHAPE_FORCE + shape) * inputs + input]);
                work.residual[row] = forces.sum();
            }
            solve_factored(
                &work.matrix,
                &work.order,
                &mut work.residual,
                &mut work.column,
            );
            for output in 0..SHAPE_FORCE {
                let moved = (0..count).map(|k| self.along(work, output, k) * work.residual[k]);
                dy_dx[output * own + input] += moved.sum::<f64>();
            }
        }
        Ok(())
    }

    /// Writes the content and the amplitudes of the last solution to the memory.
    pub fn accept(&self, work: &ElasticWork, memory: &mut [f64]) {
        let (content, amplitudes) = memory.split_at_mut(self.film.memory());
        self.film.accept(&work.film, content);
        amplitudes.copy_from_slice(&work.amplitudes);
    }

    /// Largest change of the gap by the surface in the middle of a cell (m).
    #[must_use]
    pub fn deflection(&self, work: &ElasticWork) -> f64 {
        self.film.deflection(&work.film)
    }

    /// Share of the waves with the highest number around in the deflection of all waves that change around. A large
    /// share shows that more waves are necessary.
    #[must_use]
    pub fn last_waves(&self, work: &ElasticWork) -> f64 {
        let shapes = &self.film.source().shapes;
        let most = shapes.iter().map(|shape| shape.around).max().unwrap_or(0);
        let (mut last, mut all) = (0.0, 0.0);
        for (shape, amplitude) in shapes.iter().zip(&work.amplitudes) {
            if shape.around == 0 {
                continue;
            }
            all += amplitude.abs();
            if shape.around == most {
                last += amplitude.abs();
            }
        }
        if all > 0.0 { last / all } else { 0.0 }
    }
}

/// Replaces a square matrix, row by row, by its factors with exchanged rows; `false` if it is singular.
fn factor(matrix: &mut [f64], order: &mut [usize]) -> bool {
    let count = order.len();
    for (at, place) in order.iter_mut().enumerate() {
        *place = at;
    }
    for column in 0..count {
        let mut pivot = column;
        for row in column + 1..count {
            if matrix[row * count + column].abs() > matrix[pivot * count + column].abs() {
                pivot = row;
            }
        }
        let value = matrix[pivot * count + column];
        if value == 0.0 || !value.is_finite() {
            return false;
        }
        if pivot != column {
            order.swap(pivot, column);
            for at in 0..count {
                matrix.swap(pivot * count + at, column * count + at);
            }
        }
        for row in column + 1..count {
            let factor = matrix[row * count + column] / value;
            matrix[row * count + column] = factor;
            if factor == 0.0 {
                continue;
            }
            for at in column + 1..count {
                matrix[row * count + at] -= factor * matrix[column * count + at];
            }
        }
    }
    true
}

/// Replaces the right-hand side by the solution.
fn solve_factored(matrix: &[f64], order: &[usize], side: &mut [f64], room: &mut [f64]) {
    let count = order.len();
    for (place, row) in room.iter_mut().zip(order) {
        *place = side[*row];
    }
    for row in 0..count {
        let done: f64 = (0..row).map(|at| matrix[row * count + at] * room[at]).sum();
        room[row] -= done;
    }
    for row in (0..count).rev() {
        let done: f64 = (row + 1..count)
            .map(|at| matrix[row * count + at] * room[at])
            .sum();
        room[row] = (room[row] - done) / matrix[row * count + row];
    }
    side.copy_from_slice(room);
}
