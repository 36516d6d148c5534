//! Elastic surfaces: a film whose surface yields to its pressure.
//!
//! The radial deflection is a sum of the film's shapes. Their amplitudes are those of the moving body that carries the
//! surface, a, which are inputs, and a part that follows the generalised forces of the pressure at once, `β = C f` with a
//! compliance C, which is symmetric and positive semi-definite. Within a step of length Δ the rates of the second part are
//! `(β − β_n)/Δ`, with β_n at its begin; a steady film has none. Newton's method solves
//!
//! ```text
//! g(β) = β − C f(a + β, ȧ + β̇) = 0        G = I − C J        J = ∂f/∂b + (1/Δ) ∂f/∂ḃ
//! dy/dx = ∂y/∂x + (∂y/∂b + (1/Δ) ∂y/∂ḃ) G⁻¹ C ∂f/∂x
//! ```
//!
//! with the exact derivatives of the film, for each input x, a and ȧ among them. G of an earlier iteration serves as long as
//! it contracts.

use crate::error::{FilmError, SourceError};
use crate::film::{Film, Work};
use crate::inputs::{ECCENTRICITY, FORCE, RATE, SHAPE_FORCE, SPIN, SUPPLY, TILT_RATE};

/// Most rounds of Newton's method.
const ROUNDS: usize = 200;
/// Largest change of an amplitude that ends the rounds, as a share of the clearance.
const GOAL: f64 = 1e-13;
/// Largest ratio of two residuals that keeps G.
const CONTRACTION: f64 = 0.1;
/// Largest change of an amplitude in a round, as a share of the way that it may go: a longer one could close the gap.
const LONGEST: f64 = 0.5;
/// Least speed of the surfaces that a search counts with (m/s).
const LEAST_SPEED: f64 = 1e-3;
/// Growth of the changes beyond which a shorter one is tried.
const GROWTH: f64 = 1.5;
/// Least share of a change that a search tries.
const LEAST_SHARE: f64 = 0.05;

/// A film with a compliance of its shapes.
#[derive(Clone, Debug)]
pub struct Elastic {
    film: Film,
    /// C, row by row, m/N.
    compliance: Vec<f64>,
    /// Whether the body that carries the surface moves it: a and ȧ are inputs, and the forces of the shapes outputs.
    carried: bool,
}

/// Memory for solutions of an elastic film.
#[derive(Clone, Debug)]
pub struct ElasticWork {
    /// Memory of the film, with its last solution.
    pub film: Work,
    /// The inputs of the film at the last solution, and their given part.
    inputs: Vec<f64>,
    given: Vec<f64>,
    outputs: Vec<f64>,
    slopes: Vec<f64>,
    /// Factors of G, and the order of its rows.
    matrix: Vec<f64>,
    order: Vec<usize>,
    factored: bool,
    /// The part of the amplitudes that follows the forces: at the last solution, and at the begin of its step.
    amplitudes: Vec<f64>,
    before: Vec<f64>,
    step: Option<f64>,
    /// g at the last evaluation, and the change before it.
    missed: Vec<f64>,
    taken: Vec<f64>,
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
        Self::of(film, compliance, false)
    }

    /// A film on a surface that a moving body carries: amplitudes and their rates follow the openings among the inputs, and
    /// the forces of the shapes follow the torque among the outputs.
    ///
    /// # Errors
    /// As [`Elastic::new`].
    pub fn carried(film: Film, compliance: Vec<f64>) -> Result<Elastic, SourceError> {
        Self::of(film, compliance, true)
    }

    fn of(film: Film, compliance: Vec<f64>, carried: bool) -> Result<Elastic, SourceError> {
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
        Ok(Elastic {
            film,
            compliance,
            carried,
        })
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

    /// Number of inputs: those of the film. Without a body that carries the surface there are no amplitudes and rates among
    /// them.
    #[must_use]
    pub fn inputs(&self) -> usize {
        match self.carried {
            true => self.film.inputs(),
            false => self.plain_inputs(),
        }
    }

    /// Number of outputs: force, moment and torque, and the forces of the shapes of a surface that a body carries.
    #[must_use]
    pub fn outputs(&self) -> usize {
        match self.carried {
            true => self.film.outputs(),
            false => SHAPE_FORCE,
        }
    }

    /// Number of shapes whose amplitudes are inputs.
    #[must_use]
    pub fn carried_shapes(&self) -> usize {
        match self.carried {
            true => self.shapes(),
            false => 0,
        }
    }

    /// Number of inputs before the amplitudes.
    fn plain_inputs(&self) -> usize {
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
            given: vec![0.0; self.film.inputs()],
            outputs: vec![0.0; self.film.outputs()],
            slopes: vec![0.0; self.film.outputs() * self.film.inputs()],
            matrix: vec![0.0; count * count],
            order: vec![0; count],
            factored: false,
            amplitudes: vec![0.0; count],
            before: vec![0.0; count],
            step: None,
            missed: vec![0.0; count],
            taken: vec![0.0; count],
            residual: vec![0.0; count],
            column: vec![0.0; count],
            rounds: 0,
        }
    }

    /// Solves the film and its surface, and writes the outputs. `step` and `memory` are those of
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
        let (count, own, answers) = (self.shapes(), self.inputs(), self.outputs());
        let (content, before) = memory.split_at(memory.len().min(self.film.memory()));
        work.given[..own].copy_from_slice(inputs);
        Self::begin(work, step, before);
        if count == 0 {
            self.evaluate(content, work)?;
            outputs.copy_from_slice(&work.outputs[..answers]);
            return Ok(());
        }
        let clearance = self.film.source().clearance;
        let reach = self.reach(work);
        // length of the last change, and the share of it that was made
        let (mut last, mut share) = (f64::INFINITY, 1.0);
        for round in 1..=ROUNDS {
            let solved = self.evaluate(content, work);
            if let Err(error) = solved {
                // the next search begins without factors
                work.factored = false;
                work.amplitudes.copy_from_slice(&work.before);
                return Err(error);
            }
            let mut longest = self.change(work)?;
            if longest > GROWTH * last && share > LEAST_SHARE {
                // cells change sides on the way: a shorter one reduces the residual
                share /= 2.0;
                for (amplitude, change) in work.amplitudes.iter_mut().zip(&work.taken) {
                    *amplitude += share * change;
                }
                continue;
            }
            if longest > CONTRACTION * last {
                work.factored = false;
                longest = self.change(work)?;
            }
            if !longest.is_finite() {
                break;
            }
            if longest <= GOAL * clearance {
                work.rounds = round;
                outputs.copy_from_slice(&work.outputs[..answers]);
                return Ok(());
            }
            (last, share) = (longest, (reach / longest).min(1.0));
            work.taken.copy_from_slice(&work.residual);
            for (amplitude, change) in work.amplitudes.iter_mut().zip(&work.taken) {
                *amplitude -= share * change;
            }
        }
        work.factored = false;
        work.amplitudes[..count].copy_from_slice(&work.before);
        Err(FilmError::NoSurface { rounds: ROUNDS })
    }

    /// The amplitudes at which the search begins. It depends on the beginning of the step alone, so a run that continues from a
    /// checkpoint has the same bits. For another length of the step the rates of the last solution remain, not its amplitudes:
    /// a shorter step would ask for faster surfaces.
    fn begin(work: &mut ElasticWork, step: Option<f64>, before: &[f64]) {
        let earlier = std::mem::replace(&mut work.step, step);
        let Some(step) = step else { return };
        let share = match earlier {
            Some(earlier) if work.before == before => step / earlier,
            _ => 0.0,
        };
        if share == 1.0 {
            return;
        }
        work.before.copy_from_slice(before);
        for (amplitude, before) in work.amplitudes.iter_mut().zip(before) {
            *amplitude = before + share * (*amplitude - before);
        }
        work.factored = false;
    }

    /// The largest change of an amplitude in a round (m): a share of the clearance, and within a step the same share of the way of
    /// surfaces with these velocities if it is shorter. A larger change asks for rates that leave the film behind.
    fn reach(&self, work: &ElasticWork) -> f64 {
        let source = self.film.source();
        let x = &work.given;
        let speed = |first: usize| libm::hypot(x[first], x[first + 1]);
        let approach = speed(RATE) + speed(TILT_RATE) * source.width / 2.0;
        let swept = x[SPIN].abs() * source.clearance;
        let step = work.step.unwrap_or(f64::INFINITY);
        let way = step * (swept + approach).max(LEAST_SPEED);
        LONGEST * source.clearance.min(way)
    }

    /// Newton's change of the amplitudes at the last evaluation, in place of g, and its length (m).
    fn change(&self, work: &mut ElasticWork) -> Result<f64, FilmError> {
        if !work.factored {
            self.factor(work)?;
        }
        work.residual.copy_from_slice(&work.missed);
        solve_factored(
            &work.matrix,
            &work.order,
            &mut work.residual,
            &mut work.column,
        );
        let longest = work.residual.iter().map(|change| change.abs());
        Ok(longest.fold(0.0, f64::max))
    }

    /// Solves the film at the present amplitudes, and g there.
    fn evaluate(&self, content: &[f64], work: &mut ElasticWork) -> Result<(), FilmError> {
        let (count, own) = (self.shapes(), self.plain_inputs());
        work.inputs.copy_from_slice(&work.given);
        let (amplitudes, rates) = work.inputs[own..].split_at_mut(count);
        for (sum, amplitude) in amplitudes.iter_mut().zip(&work.amplitudes) {
            *sum += amplitude;
        }
        for (rate, (now, before)) in rates
            .iter_mut()
            .zip(work.amplitudes.iter().zip(&work.before))
        {
            *rate += work.step.map_or(0.0, |step| (now - before) / step);
        }
        let (film, x) = (&mut work.film, &work.inputs);
        self.film
            .solve(x, work.step, content, film, &mut work.outputs)?;
        let forces = &work.outputs[SHAPE_FORCE..];
        for (row, residual) in work.missed.iter_mut().enumerate() {
            let line = &self.compliance[row * count..(row + 1) * count];
            let yields: f64 = line.iter().zip(forces).map(|(c, f)| c * f).sum();
            *residual = work.amplitudes[row] - yields;
        }
        Ok(())
    }

    /// Derivative of an output of the film by an amplitude, along with its rate.
    fn along(&self, work: &ElasticWork, output: usize, shape: usize) -> f64 {
        let row = &work.slopes[output * self.film.inputs()..][..self.film.inputs()];
        let (count, own) = (self.shapes(), self.plain_inputs());
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

    /// Derivatives of the outputs by the inputs at the last solution, output by output.
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
            for output in 0..self.outputs() {
                let moved = (0..count).map(|k| self.along(work, output, k) * work.residual[k]);
                dy_dx[output * own + input] += moved.sum::<f64>();
            }
        }
        Ok(())
    }

    /// Stiffness and damping for slow motions of the pin about the last solution: minus the slopes of the force by e and by ė
    /// (xx, xy, yx, yy each), where the surface follows at once. With `b = B_e e + B_v ė` to the first order of the motion,
    ///
    /// ```text
    /// B_e = G⁻¹ C ∂f/∂e      B_v = G⁻¹ C (∂f/∂ė + ∂f/∂ḃ B_e)      G = I − C ∂f/∂b
    /// −K = ∂F/∂e + ∂F/∂b B_e      −D = ∂F/∂ė + ∂F/∂b B_v + ∂F/∂ḃ B_e
    /// ```
    ///
    /// so they do not depend on the length of a step. A body that carries the surface is taken as at rest. The content of a
    /// film with memory follows within its last step.
    ///
    /// # Errors
    /// If the surface is unstable there.
    pub fn stiffness_and_damping(&self, work: &mut ElasticWork) -> Result<[f64; 8], FilmError> {
        let (count, inputs) = (self.shapes(), self.film.inputs());
        self.film.tangent(&mut work.film, &mut work.slopes);
        let step = work.step.take();
        let factored = self.factor(work);
        work.step = step;
        work.factored = false;
        factored?;
        let (amplitude, rate) = (self.plain_inputs(), self.plain_inputs() + count);
        let mut found = [0.0; 8];
        let mut follows = vec![0.0; 2 * count];
        for axis in 0..2 {
            let (by_place, by_rate) = follows.split_at_mut(count);
            let slope = |output: usize, input: usize| work.slopes[output * inputs + input];
            let along = |output: usize, first: usize, changes: &[f64]| -> f64 {
                let terms = changes.iter().enumerate();
                terms.map(|(k, x)| slope(output, first + k) * x).sum()
            };
            for (sum, row) in by_place.iter_mut().zip(0..) {
                *sum = self.yields(row, |shape| slope(SHAPE_FORCE + shape, ECCENTRICITY + axis));
            }
            solve_factored(&work.matrix, &work.order, by_place, &mut work.column);
            for (sum, row) in by_rate.iter_mut().zip(0..) {
                *sum = self.yields(row, |shape| {
                    let output = SHAPE_FORCE + shape;
                    slope(output, RATE + axis) + along(output, rate, by_place)
                });
            }
            solve_factored(&work.matrix, &work.order, by_rate, &mut work.column);
            for force in 0..2 {
                let output = FORCE + force;
                let place = slope(output, ECCENTRICITY + axis) + along(output, amplitude, by_place);
                found[2 * force + axis] = -place;
                let moved = along(output, amplitude, by_rate) + along(output, rate, by_place);
                found[4 + 2 * force + axis] = -slope(output, RATE + axis) - moved;
            }
        }
        Ok(found)
    }

    /// A row of C times forces of the shapes.
    fn yields(&self, row: usize, force: impl Fn(usize) -> f64) -> f64 {
        let count = self.shapes();
        let line = self.compliance[row * count..(row + 1) * count].iter();
        line.enumerate().map(|(shape, c)| c * force(shape)).sum()
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
        for (shape, amplitude) in shapes.iter().zip(&work.inputs[self.plain_inputs()..]) {
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
