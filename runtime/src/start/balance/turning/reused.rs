//! Steps along a motion that take over the work of earlier steps.
//!
//! Without films on cells a matrix and its factors cost as much as ten evaluations or more. In films on cells
//! the solution of the fields takes most of the time of an evaluation, and their derivatives take as long
//! again. So a step has few of both. The factors of one matrix serve for many steps, with the secants of
//! earlier corrections ([`Secants`]), and are made anew when they contract slowly. The search begins where
//! the scheme extrapolates to, corrected by the error that this extrapolation had at the same step of the
//! period before. The searches of the fields begin where they ended there. And as long as a period changes
//! much, its steps need not be exact.

use eng_system::secants::Secants;

/// Contraction above which the matrix is made anew, within a step or at the beginning of the next. With films
/// on cells a new one takes about as long as two evaluations; without them a larger limit gains little.
const SLOW: f64 = 0.3;
/// Least contraction that is expected. A ratio of two corrections may be small by chance; without this floor
/// a step would then end at a correction far above its goal.
const LEAST: f64 = 0.1;
/// Iterations with earlier factors, after which each has a new matrix. A choice: at a contraction of 0.3 six
/// iterations win three digits, and a step that needs more is nearer to its end with a matrix of its own.
const KEPT: usize = 6;
/// Change over the last period at which steps have their usual goal; above it the goal grows with the change.
/// It is ten times the change of a motion that repeats, so that the last periods, which decide the end, are
/// exact.
const FINE: f64 = 2e-3;
/// Change over a period below which a search of a field begins where it ended a period before, and not a step
/// before. A choice: below it the cavity of the period before is expected to be nearer than that of the step
/// before.
const NEAR: f64 = 0.05;
/// Largest factor on the goal. A choice: steps of the first periods then end at 0.03 of the position
/// tolerance, and an iteration saves no more than that.
const ROUGH: f64 = 30.0;

/// What steps take over from earlier ones.
pub(super) struct Reused {
    size: usize,
    secants: Secants,
    /// Whether there are factors.
    factored: bool,
    /// The largest contraction in the last step in which one was seen.
    contraction: f64,
    /// Factor on the goal of a step.
    rough: f64,
    /// Errors of the extrapolations of a period, step after step, and the place of the next step.
    errors: Vec<f64>,
    next: usize,
    /// Where the searches of the fields ended at these steps.
    found: Vec<Vec<f64>>,
    /// Whether the last period came so near to the one before that these searches begin there.
    near: bool,
    /// The extrapolation of the present step.
    extrapolated: Vec<f64>,
    /// The correction by the factors alone before the last move, this move, and whether both are there.
    before: Vec<f64>,
    moved: Vec<f64>,
    paired: bool,
    /// Size of the last correction in this step with the present factors, and whether its contraction requires others.
    last: Option<f64>,
    slow: bool,
}

/// The end of an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    Iterate,
    Solved,
}

impl Reused {
    /// Nothing yet, for this number of unknowns and of steps in a period.
    pub fn new(size: usize, steps: usize) -> Reused {
        Reused {
            size,
            secants: Secants::new(size),
            factored: false,
            contraction: 0.0,
            rough: ROUGH,
            errors: vec![0.0; size * steps],
            next: 0,
            found: vec![Vec::new(); steps],
            near: false,
            extrapolated: vec![0.0; size],
            before: vec![0.0; size],
            moved: vec![0.0; size],
            paired: false,
            last: None,
            slow: false,
        }
    }

    /// Takes the change over a period, as a share of a clearance or of the largest bending.
    pub fn changed(&mut self, change: f64) {
        self.rough = (change / FINE).clamp(1.0, ROUGH);
        self.near = change < NEAR;
    }

    /// Factor on the goal of a step.
    pub fn rough(&self) -> f64 {
        self.rough
    }

    /// The errors of the extrapolation at this step of the period before.
    fn errors(&mut self) -> &mut [f64] {
        &mut self.errors[self.next * self.size..(self.next + 1) * self.size]
    }

    /// Where the searches of the fields ended at this step of the period before, if that was near.
    pub fn found(&self) -> Option<&[f64]> {
        let found = self.found.get(self.next)?;
        (self.near && !found.is_empty()).then_some(found)
    }

    /// Room for the ends of these searches.
    pub fn found_mut(&mut self) -> Option<&mut Vec<f64>> {
        self.found.get_mut(self.next)
    }

    /// Begins a step at an extrapolation, which it corrects.
    pub fn begin(&mut self, trial: &mut [f64]) {
        self.extrapolated.copy_from_slice(trial);
        for (x, error) in trial.iter_mut().zip(self.errors()) {
            *x += *error;
        }
        (self.paired, self.last, self.slow) = (false, None, false);
    }

    /// Ends a step.
    pub fn end(&mut self, trial: &[f64]) {
        let first = self.next * self.size;
        let errors = &mut self.errors[first..first + self.size];
        for (error, (x, begin)) in errors.iter_mut().zip(trial.iter().zip(&self.extrapolated)) {
            *error = x - begin;
        }
        self.next += 1;
        if self.next * self.size >= self.errors.len() {
            self.next = 0;
        }
    }

    /// Whether an iteration of a step needs a new matrix.
    pub fn renews(&self, iteration: usize) -> bool {
        let worn = iteration == 0 && self.contraction.max(self.secants.missed()) > SLOW;
        !self.factored || worn || self.slow || iteration >= KEPT
    }

    /// Takes the success of a factorisation.
    pub fn factored(&mut self, regular: bool) {
        self.secants.clear();
        (self.factored, self.contraction) = (regular, 0.0);
        (self.paired, self.last, self.slow) = (false, None, false);
    }

    /// Improves a correction of the factors.
    pub fn improve(&mut self, correction: &mut [f64]) {
        if self.paired {
            self.secants.add(&self.moved, &self.before, correction);
        }
        self.before.copy_from_slice(correction);
        self.secants.improve(correction);
    }

    /// Takes the part of a correction of this size that is applied. With the contraction of the factors it
    /// shows whether the error that is left is below a goal.
    pub fn applied(&mut self, correction: &[f64], part: f64, size: f64, goal: f64) -> Next {
        for (moved, x) in self.moved.iter_mut().zip(correction) {
            *moved = part * x;
        }
        self.paired = true;
        if part < 1.0 {
            self.last = None;
            return Next::Iterate;
        }
        if let Some(rate) = self.last.map(|last| size / last) {
            self.slow = rate > SLOW;
            self.contraction = rate;
        }
        self.last = Some(size);
        let expected = self.contraction.max(LEAST);
        // the rest of a geometric series; above a ratio of 0.9, a choice, the iteration has no ratio to
        // extrapolate with
        match expected < 0.9 && size * expected / (1.0 - expected) <= goal {
            true => Next::Solved,
            false => Next::Iterate,
        }
    }
}
