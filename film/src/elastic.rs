//! Elastic surfaces: a film whose surface yields to its pressure.
//!
//! The radial deflection is a sum of the film's shapes. Their amplitudes are those of the moving body that carries the
//! surface, a, which are inputs, and a part that follows the generalised forces of the pressure at once,
//! `β = C f` with a compliance C, which is symmetric and positive semi-definite. Within a step of length Δ
//! the rates of the second part are `(β − β_n)/Δ`, with β_n at its beginning; a steady film has no rates.
//! Newton's method solves
//!
//! ```text
//! g(β) = β − C f(a + β, ȧ + β̇) = 0        G = I − C J        J = ∂f/∂b + (1/Δ) ∂f/∂ḃ
//! dy/dx = ∂y/∂x + (∂y/∂b + (1/Δ) ∂y/∂ḃ) G⁻¹ C ∂f/∂x
//! ```
//!
//! with the exact derivatives of the film, for each input x, a and ȧ among them. G is kept over steps until the rounds
//! are slow, because its derivatives cost as much as ten solutions of the film. Secants of earlier rounds make up for
//! its error.

use crate::error::{FilmError, SourceError};
use crate::feedback::{Feedback, Slopes};
use crate::film::{Film, Work};
use crate::inputs::{ECCENTRICITY, FORCE, MOMENT, RATE, SHAPE_FORCE, SPIN, SUPPLY, TILT_RATE};
use crate::tangent::ALL;
use eng_system::dense::{add_scaled, dot, largest};
use eng_system::field::Accuracy;
use eng_system::surface::SurfaceShape as Shape;

/// Most rounds of Newton's method. A choice: a search that has not ended by then fails, and the step becomes
/// shorter.
const ROUNDS: usize = 200;
/// Largest change of an amplitude that ends the rounds, as a share of the clearance. The outputs follow this last
/// change by their slopes, so its square and the age of the slopes alone are left. With 1e-9 a step takes a seventh
/// fewer solutions, but the outputs have steps of 1e-8, which differences for the matrix of a step show.
const GOAL: f64 = 1e-11;
/// Largest error of the amplitudes for an iterate of Newton's method, as a share of the change since the last
/// solution. With 1e-2 the solutions are a sixth fewer, but the matrix of the outer iteration is renewed more often.
const ITERATE: f64 = 1e-3;
/// Ratio of two changes above which a round was slow, and the number of slow rounds after which G is computed
/// again. Choices: G costs as much as ten solutions of the film. One slow round may come from cells that
/// change between film and cavity, without an old G.
const CONTRACTION: f64 = 0.3;
const SLOW_ROUNDS: usize = 2;
/// Rounds after which the search uses no secants and computes G again after each slow round. If many cells
/// change between film and cavity, secants of earlier rounds are not valid. A choice: usual searches end long
/// before.
const QUICK_ROUNDS: usize = 16;
/// Largest change of an amplitude in a round, as a share of the limit in `Elastic::reach`: a larger one could
/// close the gap. A choice: half of the limit leaves the other half to the sum of all other amplitudes.
const LONGEST: f64 = 0.5;
/// Least speed of the surfaces that a search counts with (m/s). A choice: without it a search at rest could
/// not move at all. In a step of 10 µs it allows changes of 5 nm in a round.
const LEAST_SPEED: f64 = 1e-3;
/// Length of a step in which the oil of a cavity stays in its place (s). A choice: a surface of 50 m/s moves
/// by 50 nm in this time, far less than a cell. In a much shorter step the content over the step has few
/// digits.
const HELD: f64 = 1e-9;
/// Growth of the changes beyond which a shorter one is tried. A choice above one, because a change may grow a
/// little while cells change between film and cavity.
const GROWTH: f64 = 1.5;
/// Least share of a change that a search tries; a change is halved at most five times. A choice: shorter
/// changes would end the search only by standing still.
const LEAST_SHARE: f64 = 0.05;

/// A film with a compliance of its shapes.
#[derive(Clone, Debug)]
pub struct Elastic {
    film: Film,
    /// C, row by row, m/N.
    compliance: Vec<f64>,
    /// The compliance for slow loads, with the part of the body's motion a; C without such a body.
    slow: Vec<f64>,
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
    /// For each output before the forces of the shapes: whether its derivatives are wanted. Those of the
    /// force on the pin always are.
    wanted: [bool; SHAPE_FORCE],
    /// Whether the slopes are those of the last solution of the film.
    current: bool,
    feedback: Feedback,
    /// The film with its oil held; made when stiffness and damping within a step are first read.
    held: Option<Box<Held>>,
    /// G of slow motions.
    slow_feedback: Feedback,
    /// The part of the amplitudes that follows the forces: at the last solution, and at the beginning of its
    /// step.
    amplitudes: Vec<f64>,
    before: Vec<f64>,
    step: Option<f64>,
    /// −g at the last evaluation.
    missed: Vec<f64>,
    /// Change of the amplitudes by G alone, and with the secants.
    plain: Vec<f64>,
    change: Vec<f64>,
    /// The last move of the amplitudes, and the change by G before it.
    moved: Vec<f64>,
    earlier: Vec<f64>,
    /// Change of the given inputs since the last solution, and the change of the forces of the shapes by it.
    given_change: Vec<f64>,
    forces: Vec<f64>,
    /// `C ∂f/∂x`, replaced by the derivatives of the amplitudes by the inputs.
    follows: Vec<f64>,
    /// Rounds of the last solution.
    pub rounds: usize,
}

/// A film in a step so short that the oil of its cavity stays in its place.
#[derive(Clone, Debug)]
struct Held {
    film: Work,
    content: Vec<f64>,
    cavity: Vec<f64>,
    outputs: Vec<f64>,
    slopes: Vec<f64>,
}

impl Elastic {
    /// A film whose shapes have a compliance (m/N), `shapes × shapes` numbers row by row.
    ///
    /// # Errors
    /// If the compliance is not square or not symmetric, or has a negative number on its diagonal.
    pub fn new(film: Film, compliance: Vec<f64>) -> Result<Elastic, SourceError> {
        Self::of(film, compliance.clone(), compliance, false)
    }

    /// A film on a surface that a moving body carries: amplitudes and their rates follow the openings among
    /// the inputs, and the forces of the shapes follow the torque among the outputs. `slow` is the compliance with
    /// the static deflection by the modes of this body.
    ///
    /// # Errors
    /// As [`Elastic::new`], for both compliances.
    pub fn carried(
        film: Film,
        compliance: Vec<f64>,
        slow: Vec<f64>,
    ) -> Result<Elastic, SourceError> {
        Self::of(film, compliance, slow, true)
    }

    fn of(
        film: Film,
        compliance: Vec<f64>,
        slow: Vec<f64>,
        carried: bool,
    ) -> Result<Elastic, SourceError> {
        let count = film.source().shapes.len();
        for compliance in [&compliance, &slow] {
            check_compliance(compliance, count)?;
        }
        Ok(Elastic {
            film,
            compliance,
            slow,
            carried,
        })
    }

    /// The film.
    #[must_use]
    pub fn film(&self) -> &Film {
        &self.film
    }

    fn shapes(&self) -> usize {
        self.film.source().shapes.len()
    }

    /// Number of inputs: those of the film. Without a body that carries the surface there are no amplitudes
    /// and rates among them.
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

    /// Count of numbers in the memory: the content of the film's cells, the amplitudes and their rates.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.film.memory() + 2 * self.shapes()
    }

    /// Memory for solutions.
    #[must_use]
    pub fn work(&self) -> ElasticWork {
        self.work_for(&ALL)
    }

    /// Memory for solutions of which [`Elastic::tangent`] gives only the derivatives of the wanted outputs
    /// and of the forces on the pin and of the shapes. The derivatives of the other outputs are zero. The
    /// values of all outputs are computed. (They follow the last change of an elastic surface by these
    /// derivatives. So outputs without derivatives miss a change of 1e-11 of the clearance.)
    #[must_use]
    pub fn work_for(&self, wanted: &[bool; SHAPE_FORCE]) -> ElasticWork {
        let count = self.shapes();
        let mut wanted = *wanted;
        wanted[FORCE..MOMENT].fill(true);
        ElasticWork {
            film: self.film.work(),
            inputs: vec![0.0; self.film.inputs()],
            given: vec![0.0; self.film.inputs()],
            outputs: vec![0.0; self.film.outputs()],
            slopes: vec![0.0; self.film.outputs() * self.film.inputs()],
            wanted,
            current: false,
            feedback: Feedback::new(count),
            held: None,
            slow_feedback: Feedback::new(count),
            amplitudes: vec![0.0; count],
            before: vec![0.0; count],
            step: None,
            missed: vec![0.0; count],
            plain: vec![0.0; count],
            change: vec![0.0; count],
            moved: vec![0.0; count],
            earlier: vec![0.0; count],
            given_change: vec![0.0; self.inputs()],
            forces: vec![0.0; count],
            follows: vec![0.0; count * self.inputs()],
            rounds: 0,
        }
    }

    /// Solves the film and its surface, and writes the outputs. `step` and `memory` are those of
    /// [`Film::solve`], with the amplitudes and their rates after the content. For an iterate of Newton's method the
    /// amplitudes may have an error of a thousandth of their change since the last solution, or within a new step since its
    /// prediction.
    ///
    /// # Errors
    /// As [`Film::solve`], or if the surface finds no balance with the film.
    pub fn solve(
        &self,
        inputs: &[f64],
        step: Option<f64>,
        memory: &[f64],
        accuracy: Accuracy,
        work: &mut ElasticWork,
        outputs: &mut [f64],
    ) -> Result<(), FilmError> {
        let (count, own, answers) = (self.shapes(), self.inputs(), self.outputs());
        let (content, before) = memory.split_at(memory.len().min(self.film.memory()));
        if count == 0 {
            work.given[..own].copy_from_slice(inputs);
            work.step = step;
            self.evaluate(content, work)?;
            outputs.copy_from_slice(&work.outputs[..answers]);
            return Ok(());
        }
        let followed = match self.begin(work, step, before) {
            true => self.follow(inputs, work),
            false => {
                work.given[..own].copy_from_slice(inputs);
                0.0
            }
        };
        let error = match accuracy {
            Accuracy::Full => 0.0,
            Accuracy::Iterate => ITERATE,
        };
        let found = self.search(content, work, followed, error);
        match found {
            Ok(()) => {
                outputs.copy_from_slice(&work.outputs[..answers]);
                self.correct(work, outputs);
            }
            Err(_) => {
                // the next search starts without the secants and from the beginning of the step
                work.feedback.forget();
                work.amplitudes.copy_from_slice(&work.before);
            }
        }
        found
    }

    /// Searches the amplitudes that are in balance with the film. `followed` is the length (m) by which they
    /// have followed the inputs before. `error` is the share of their change that may be left as an error.
    fn search(
        &self,
        content: &[f64],
        work: &mut ElasticWork,
        followed: f64,
        error: f64,
    ) -> Result<(), FilmError> {
        let mut goal = GOAL * self.film.source().clearance;
        let reach = self.reach(work);
        // length of the last change, the share of it that was made, and slow rounds since G was made
        let (mut last, mut share, mut slow) = (f64::INFINITY, 1.0, 0);
        let mut paired = false;
        for round in 1..=ROUNDS {
            self.evaluate(content, work)?;
            let careful = round > QUICK_ROUNDS;
            let mut longest = self.change(work, paired && !careful)?;
            if round == 1 && followed > 0.0 && longest > followed {
                // the residual is larger than the move: the kept slopes led the amplitudes away, so the
                // move is taken back
                add_scaled(&mut work.amplitudes, -1.0, &work.moved);
                continue;
            }
            if last == f64::INFINITY {
                goal = goal.max(error * longest.max(followed));
            }
            if longest > GROWTH * last && share > LEAST_SHARE {
                // cells change between film and cavity on the way: a shorter change reduces the residual
                share /= 2.0;
                work.moved.iter_mut().for_each(|moved| *moved /= 2.0);
                add_scaled(&mut work.amplitudes, -1.0, &work.moved);
                continue;
            }
            slow += usize::from(longest > CONTRACTION * last);
            if slow >= if careful { 1 } else { SLOW_ROUNDS } {
                slow = 0;
                paired = false;
                work.feedback.forget();
                longest = self.change(work, paired)?;
            }
            if !longest.is_finite() {
                break;
            }
            if longest <= goal {
                work.rounds = round;
                return Ok(());
            }
            (last, share) = (longest, (reach / self::largest(&work.change)).min(1.0));
            for (moved, change) in work.moved.iter_mut().zip(&work.change) {
                *moved = share * change;
            }
            add_scaled(&mut work.amplitudes, 1.0, &work.moved);
            work.earlier.copy_from_slice(&work.plain);
            paired = true;
            if round == QUICK_ROUNDS {
                work.feedback.forget();
            }
        }
        Err(FilmError::NoSurface { rounds: ROUNDS })
    }

    /// The amplitudes at which the search begins, and whether they belong to the step and the inputs of the
    /// last solution. In a new step they move on at the rates of the one before, and nothing is kept but the numbers of
    /// [`Elastic::kept`]: so a run that continues from a checkpoint has the same bits. For another length of the step
    /// the rates of the last solution remain.
    fn begin(&self, work: &mut ElasticWork, step: Option<f64>, memory: &[f64]) -> bool {
        let earlier = std::mem::replace(&mut work.step, step);
        let Some(step) = step else {
            return earlier.is_none() && work.feedback.is_factored(0.0);
        };
        let (before, rates) = memory.split_at(self.shapes());
        match earlier {
            Some(earlier) if work.before == before => {
                let share = step / earlier;
                if share == 1.0 {
                    return work.feedback.is_factored(1.0 / step);
                }
                for (amplitude, before) in work.amplitudes.iter_mut().zip(before) {
                    *amplitude = before + share * (*amplitude - before);
                }
            }
            _ => {
                work.feedback.secants.clear();
                work.before.copy_from_slice(before);
                work.amplitudes.copy_from_slice(before);
                add_scaled(&mut work.amplitudes, step, rates);
            }
        }
        false
    }

    /// Takes new inputs, and lets the amplitudes follow them by the kept slopes, but no further than the
    /// search may go. Returns the length of their change (m).
    fn follow(&self, inputs: &[f64], work: &mut ElasticWork) -> f64 {
        let own = self.inputs();
        let count = self.shapes();
        let changes = &mut work.given_change;
        for (change, (now, before)) in changes.iter_mut().zip(inputs.iter().zip(&work.given)) {
            *change = now - before;
        }
        work.given[..own].copy_from_slice(inputs);
        let rows = work
            .slopes
            .chunks_exact(self.film.inputs())
            .skip(SHAPE_FORCE);
        for (force, row) in work.forces.iter_mut().zip(rows) {
            *force = dot(row, changes);
        }
        let lines = self.compliance.chunks_exact(count);
        for (change, line) in work.change.iter_mut().zip(lines) {
            *change = dot(line, &work.forces);
        }
        work.feedback.solve(&mut work.change, 1);
        work.feedback.secants.improve(&mut work.change);
        let longest = largest(&work.change);
        if longest > self.reach(work) {
            return 0.0;
        }
        work.moved.copy_from_slice(&work.change);
        add_scaled(&mut work.amplitudes, 1.0, &work.moved);
        longest
    }

    /// Adds the last change, which ended the search, to the amplitudes, and its effect to the outputs.
    fn correct(&self, work: &mut ElasticWork, outputs: &mut [f64]) {
        let amplitude = self.plain_inputs();
        let by_step = work.step.map_or(0.0, |step| 1.0 / step);
        let rows = work.slopes.chunks_exact(self.film.inputs());
        for (output, row) in outputs.iter_mut().zip(rows) {
            let (by_amplitude, by_rate) = row[amplitude..].split_at(self.shapes());
            *output += dot(by_amplitude, &work.change) + by_step * dot(by_rate, &work.change);
        }
        add_scaled(&mut work.amplitudes, 1.0, &work.change);
    }

    /// The largest change of an amplitude in a round (m): a share of the clearance, or of the way that the
    /// surfaces move within the step if this is shorter. A larger change needs rates far above those of the
    /// surfaces, and the next iterate would be useless.
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

    /// Newton's change of the amplitudes at the last evaluation. Returns its length without secants (m),
    /// which measures the residual. After a move it makes a pair of the secants.
    fn change(&self, work: &mut ElasticWork, paired: bool) -> Result<f64, FilmError> {
        let kept = work.feedback.is_made();
        self.factor(work)?;
        work.plain.copy_from_slice(&work.missed);
        work.feedback.solve(&mut work.plain, 1);
        if paired && kept {
            let secants = &mut work.feedback.secants;
            secants.add(&work.moved, &work.earlier, &work.plain);
        }
        work.change.copy_from_slice(&work.plain);
        work.feedback.secants.improve(&mut work.change);
        Ok(largest(&work.plain))
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
        work.current = false;
        self.film
            .solve(x, work.step, content, film, &mut work.outputs)?;
        let forces = &work.outputs[SHAPE_FORCE..];
        let lines = self.compliance.chunks_exact(count.max(1));
        for ((missed, line), amplitude) in work.missed.iter_mut().zip(lines).zip(&work.amplitudes) {
            *missed = dot(line, forces) - amplitude;
        }
        Ok(())
    }

    /// Appends the numbers with which another work continues as this one: the cavity of the last solution, its step (0 for
    /// none), the amplitudes at its end and beginning, whether G is kept, and with it the derivatives.
    pub fn kept(&self, work: &ElasticWork, numbers: &mut Vec<f64>) {
        self.film.cavity(&work.film, numbers);
        if self.shapes() == 0 {
            return;
        }
        numbers.push(work.step.unwrap_or_default());
        numbers.extend_from_slice(&work.amplitudes);
        numbers.extend_from_slice(&work.before);
        let made = work.feedback.is_made();
        numbers.push(f64::from(u8::from(made)));
        if made {
            numbers.extend_from_slice(&work.slopes);
            numbers.extend(work.feedback.products());
        }
    }

    /// Takes numbers of [`Elastic::kept`], and returns the numbers after them. If there are too few, the next
    /// search begins as it would without them.
    pub fn keep<'n>(&self, work: &mut ElasticWork, numbers: &'n [f64]) -> &'n [f64] {
        let numbers = self.film.begin_at(&mut work.film, numbers);
        if self.shapes() == 0 {
            return numbers;
        }
        work.feedback.forget();
        self.keep_surface(work, numbers).unwrap_or(&[])
    }

    /// Takes the numbers of [`Elastic::kept`] behind those of the cavity, and returns the numbers after them;
    /// none if there are too few.
    fn keep_surface<'n>(&self, work: &mut ElasticWork, numbers: &'n [f64]) -> Option<&'n [f64]> {
        let (step, others) = numbers.split_first()?;
        let (amplitudes, others) = others.split_at_checked(self.shapes())?;
        let (before, others) = others.split_at_checked(self.shapes())?;
        let (made, others) = others.split_first()?;
        work.step = Some(*step).filter(|step| *step > 0.0);
        work.amplitudes.copy_from_slice(amplitudes);
        work.before.copy_from_slice(before);
        if *made != 1.0 {
            return Some(others);
        }
        let (slopes, others) = others.split_at_checked(work.slopes.len())?;
        let rest = work.feedback.take(others)?;
        work.slopes.copy_from_slice(slopes);
        work.current = false;
        Some(rest)
    }

    /// Makes the derivatives of the film at its last solution.
    fn differentiate(&self, work: &mut ElasticWork) {
        if !work.current {
            self.film
                .tangent_of(&work.wanted, &mut work.film, &mut work.slopes);
            work.current = true;
        }
    }

    /// Makes G of the film's last solution.
    fn renew(&self, work: &mut ElasticWork) {
        self.differentiate(work);
        let slopes = self.rows(&work.slopes);
        work.feedback.make(&self.compliance, &slopes);
    }

    /// The derivatives that G needs, among all derivatives of the film.
    fn rows<'s>(&self, rows: &'s [f64]) -> Slopes<'s> {
        Slopes {
            rows,
            inputs: self.film.inputs(),
            force: SHAPE_FORCE,
            amplitude: self.plain_inputs(),
        }
    }

    /// Factors G. It makes G first if there is none.
    fn factor(&self, work: &mut ElasticWork) -> Result<(), FilmError> {
        if !work.feedback.is_made() {
            self.renew(work);
        }
        let by_step = work.step.map_or(0.0, |step| 1.0 / step);
        match work.feedback.factor(by_step) {
            true => Ok(()),
            false => Err(FilmError::SurfaceUnstable),
        }
    }

    /// Derivatives of the outputs by the inputs at the last solution, output by output; of outputs that the
    /// memory leaves out ([`Elastic::work_for`]) they are zero.
    ///
    /// # Errors
    /// If the surface is unstable there.
    pub fn tangent(&self, work: &mut ElasticWork, dy_dx: &mut [f64]) -> Result<(), FilmError> {
        let (count, own) = (self.shapes(), self.inputs());
        if count == 0 {
            self.film.tangent_of(&work.wanted, &mut work.film, dy_dx);
            return Ok(());
        }
        self.renew(work);
        self.factor(work)?;
        let (inputs, amplitude) = (self.film.inputs(), self.plain_inputs());
        let by_step = work.step.map_or(0.0, |step| 1.0 / step);
        let rows = |output: usize| &work.slopes[output * inputs..][..inputs];
        work.follows.fill(0.0);
        let lines = self.compliance.chunks_exact(count);
        for (sums, line) in work.follows.chunks_exact_mut(own).zip(lines) {
            for (shape, factor) in line.iter().enumerate() {
                add_scaled(sums, *factor, &rows(SHAPE_FORCE + shape)[..own]);
            }
        }
        work.feedback.solve(&mut work.follows, own);
        for (output, sums) in dy_dx.chunks_exact_mut(own).enumerate() {
            let row = rows(output);
            if work.wanted.get(output).is_some_and(|wanted| !wanted) {
                sums.fill(0.0);
                continue;
            }
            sums.copy_from_slice(&row[..own]);
            let (by_amplitude, by_rate) = row[amplitude..].split_at(count);
            let along = by_amplitude.iter().zip(by_rate);
            for ((a, r), follows) in along.zip(work.follows.chunks_exact(own)) {
                add_scaled(sums, a + by_step * r, follows);
            }
        }
        Ok(())
    }

    /// Stiffness and damping for slow motions of the pin about the last solution: minus the slopes of the
    /// force by e and by ė (xx, xy, yx, yy each), where the surface follows at once. With `b = B_e e + B_v ė`
    /// to the first order of the motion,
    ///
    /// ```text
    /// B_e = G⁻¹ C ∂f/∂e      B_v = G⁻¹ C (∂f/∂ė + ∂f/∂ḃ B_e)      G = I − C ∂f/∂b
    /// −K = ∂F/∂e + ∂F/∂b B_e      −D = ∂F/∂ė + ∂F/∂b B_v + ∂F/∂ḃ B_e
    /// ```
    ///
    /// with the compliance C for slow loads. So they depend neither on the length of a step nor on the number of modes of a
    /// body that carries the surface: its static deflection is in C, its inertia and its damping are left out. A
    /// film with memory in balance has the slopes of balances. Within a step the slopes are those of motions that
    /// leave the oil of its cavity no time, the limit of short steps, so they do not depend on the step's length, either.
    ///
    /// # Errors
    /// If the surface is unstable there.
    pub fn stiffness_and_damping(&self, work: &mut ElasticWork) -> Result<[f64; 8], FilmError> {
        let (count, inputs) = (self.shapes(), self.film.inputs());
        let mut forces = [false; SHAPE_FORCE];
        forces[FORCE..MOMENT].fill(true);
        let held = if work.step.is_some() && self.film.memory() > 0 {
            Some(self.hold_oil(&forces, work)?)
        } else if count > 0 {
            self.renew(work);
            None
        } else {
            self.film
                .tangent_of(&forces, &mut work.film, &mut work.slopes);
            None
        };
        let slopes = held.as_ref().map_or(&work.slopes, |held| &held.slopes);
        let feedback = &mut work.slow_feedback;
        feedback.make(&self.slow, &self.rows(slopes));
        if !feedback.factor(0.0) {
            return Err(FilmError::SurfaceUnstable);
        }
        let (amplitude, rate) = (self.plain_inputs(), self.plain_inputs() + count);
        let mut found = [0.0; 8];
        // `follows` lends its memory here
        let mut follows = std::mem::take(&mut work.follows);
        for axis in 0..2 {
            let (by_place, by_rate) = follows[..2 * count].split_at_mut(count);
            let slope = |output: usize, input: usize| slopes[output * inputs + input];
            let along = |output: usize, first: usize, changes: &[f64]| -> f64 {
                let terms = changes.iter().enumerate();
                terms.map(|(k, x)| slope(output, first + k) * x).sum()
            };
            for (sum, row) in by_place.iter_mut().zip(0..) {
                *sum = self.yields(row, |shape| slope(SHAPE_FORCE + shape, ECCENTRICITY + axis));
            }
            feedback.solve(by_place, 1);
            for (sum, row) in by_rate.iter_mut().zip(0..) {
                *sum = self.yields(row, |shape| {
                    let output = SHAPE_FORCE + shape;
                    slope(output, RATE + axis) + along(output, rate, by_place)
                });
            }
            feedback.solve(by_rate, 1);
            for force in 0..2 {
                let output = FORCE + force;
                let place = slope(output, ECCENTRICITY + axis) + along(output, amplitude, by_place);
                found[2 * force + axis] = -place;
                let moved = along(output, amplitude, by_rate) + along(output, rate, by_place);
                found[4 + 2 * force + axis] = -slope(output, RATE + axis) - moved;
            }
        }
        work.follows = follows;
        if held.is_some() {
            work.held = held;
        }
        Ok(found)
    }

    /// The film of the last solution with its oil held, and the derivatives of these outputs and of the forces of the
    /// shapes.
    fn hold_oil(
        &self,
        wanted: &[bool; SHAPE_FORCE],
        work: &mut ElasticWork,
    ) -> Result<Box<Held>, FilmError> {
        let mut held = work.held.take().unwrap_or_else(|| {
            Box::new(Held {
                film: self.film.work(),
                content: vec![0.0; self.film.memory()],
                cavity: Vec::new(),
                outputs: vec![0.0; self.film.outputs()],
                slopes: vec![0.0; self.film.outputs() * self.film.inputs()],
            })
        });
        let Held {
            film,
            content,
            cavity,
            outputs,
            slopes,
        } = &mut *held;
        self.film.accept(&work.film, content);
        cavity.clear();
        self.film.cavity(&work.film, cavity);
        self.film.begin_at(film, cavity);
        let step = work.step.map(|step| step.min(HELD));
        (self.film).solve(&work.inputs, step, content, film, outputs)?;
        self.film.tangent_of(wanted, film, slopes);
        Ok(held)
    }

    /// A row of the slow compliance times forces of the shapes. In m for forces in N.
    fn yields(&self, row: usize, force: impl Fn(usize) -> f64) -> f64 {
        let count = self.shapes();
        let line = self.slow[row * count..(row + 1) * count].iter();
        line.enumerate().map(|(shape, c)| c * force(shape)).sum()
    }

    /// Writes the content, and the amplitudes and their rates, of the last solution to the memory.
    pub fn accept(&self, work: &ElasticWork, memory: &mut [f64]) {
        let (content, surface) = memory.split_at_mut(self.film.memory());
        self.film.accept(&work.film, content);
        let (amplitudes, rates) = surface.split_at_mut(self.shapes());
        let by_step = work.step.map_or(0.0, |step| 1.0 / step);
        for (rate, (now, before)) in rates
            .iter_mut()
            .zip(work.amplitudes.iter().zip(&work.before))
        {
            *rate = by_step * (now - before);
        }
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
        self.last_share(work, |shape| shape.around, |shape| shape.around > 0)
    }

    /// Share of the highest degree across in the deflection of a surface that a body carries. A ring knows no change
    /// across: it has 0.
    ///
    /// A surface that stays straight across cannot show the share of the degrees that it lacks. It has the share
    /// of the degree 1 in its pressure, as if it yielded alike to both. A pressure `p₀ + p₁ ζ` has the force
    /// `|F| ~ 2 p₀` and the moment `|M| ~ p₁ B/3`, so the share is `p₁/(p₀ + p₁) = 6 |M|/(|F| B + 6 |M|)`, with sums
    /// of magnitudes as in the other shares. It is zero for an aligned pin.
    #[must_use]
    pub fn last_degrees(&self, work: &ElasticWork) -> f64 {
        let source = self.film.source();
        if !self.carried {
            return 0.0;
        }
        if source.shapes.iter().any(|shape| shape.across > 0) {
            return self.last_share(work, |shape| shape.across, |_| true);
        }
        let size = |at: usize| work.outputs[at].abs() + work.outputs[at + 1].abs();
        let (even, odd) = (size(FORCE) * source.width, 6.0 * size(MOMENT));
        if odd > 0.0 { odd / (even + odd) } else { 0.0 }
    }

    /// Share of the shapes with the highest number in the sum of those amplitudes that count.
    fn last_share(
        &self,
        work: &ElasticWork,
        number: impl Fn(&Shape) -> u32,
        counts: impl Fn(&Shape) -> bool,
    ) -> f64 {
        let shapes = &self.film.source().shapes;
        let most = shapes.iter().map(&number).max().unwrap_or(0);
        let (mut last, mut all) = (0.0, 0.0);
        for (shape, amplitude) in shapes.iter().zip(&work.inputs[self.plain_inputs()..]) {
            if !counts(shape) {
                continue;
            }
            all += amplitude.abs();
            if number(shape) == most {
                last += amplitude.abs();
            }
        }
        if all > 0.0 { last / all } else { 0.0 }
    }
}

/// Refuses a matrix that is no compliance of this number of shapes.
fn check_compliance(compliance: &[f64], count: usize) -> Result<(), SourceError> {
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
    let size = largest(compliance);
    for row in 0..count {
        let own = compliance[row * count + row];
        if !(own >= 0.0 && own.is_finite()) {
            return Err(refuse(own, "at least zero for each shape"));
        }
        for column in 0..row {
            let skew = compliance[row * count + column] - compliance[column * count + row];
            // a choice: compliances of reductions are symmetric but for rounding, and numbers in a text may
            // have six digits
            if skew.is_nan() || skew.abs() > 1e-6 * size {
                return Err(refuse(skew, "the same for both orders of two shapes"));
            }
        }
    }
    Ok(())
}
