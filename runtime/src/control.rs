//! Control of the size of steps.

/// Least and largest growth of one step relative to the one before. A choice, usual for controllers: an
/// estimate of the error is local, so a step that grows more than twofold may meet another motion, and one
/// that shrinks more than fivefold reacts to an estimate far above its series.
const GROWTH: (f64, f64) = (0.2, 2.0);
/// Growth below which the step is not changed, so that the factors of its matrix serve longer. A choice:
/// steps are then up to 13 % shorter than the error allows.
const KEEP: f64 = 1.15;

/// The root of a number, of an order. The cube root has its own function, which is exact to the last bit.
fn root(x: f64, order: f64) -> f64 {
    if order == 3.0 {
        libm::cbrt(x)
    } else {
        libm::pow(x, 1.0 / order)
    }
}

/// PI controller for a local error of the order p (Gustafsson 1991; exponents 0.7/p and 0.4/p).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepSize {
    /// Next step (s).
    pub step: f64,
    /// Error over tolerance of the last accepted step.
    before: f64,
}

impl StepSize {
    /// A control that begins with a step.
    pub fn new(step: f64) -> StepSize {
        StepSize { step, before: 1.0 }
    }
    /// The control from a checkpoint.
    pub fn from_numbers(numbers: [f64; 2]) -> StepSize {
        StepSize {
            step: numbers[0],
            before: numbers[1],
        }
    }
    /// The numbers of the control, for a checkpoint.
    pub fn numbers(&self) -> [f64; 2] {
        [self.step, self.before]
    }
    /// Sets the next step (s), where the motion changes its character.
    pub fn renewed(&mut self, step: f64) {
        *self = StepSize::new(step);
    }
    /// Limits the next step (s).
    pub fn limit(&mut self, limit: f64) {
        self.step = self.step.min(limit);
    }
    /// Called after an accepted step h with its error over tolerance, of the order `order` in h. A step that was cut short does not
    /// shrink the next one.
    ///
    /// The factor 0.9 aims below the tolerance, because a little more error would reject the next step. The
    /// least errors, 1e-8 and 1e-4, bound the powers. The second power is 0.29 or more. A step within a
    /// thousandth of the planned one was not cut short: the difference is the rounding of times.
    pub fn accepted(&mut self, h: f64, error: f64, order: f64) {
        let error = error.max(1e-8);
        let factor = 0.9 * libm::pow(error, -0.7 / order) * libm::pow(self.before, 0.4 / order);
        self.before = error.max(1e-4);
        let factor = factor.clamp(GROWTH.0, GROWTH.1);
        let proposed = if (1.0..KEEP).contains(&factor) {
            h
        } else {
            h * factor
        };
        let cut = h < 0.999 * self.step;
        self.step = if cut {
            proposed.max(self.step.min(h * GROWTH.1))
        } else {
            proposed
        };
    }
    /// Called after a step h whose error exceeds the tolerance.
    pub fn rejected(&mut self, h: f64, error: f64, order: f64) {
        let factor = if error.is_finite() {
            // at most 0.8, a choice: the error is above the tolerance, and a repeated step that is hardly
            // shorter may fail again
            (0.9 * root(1.0 / error, order)).clamp(GROWTH.0, 0.8)
        } else {
            GROWTH.0
        };
        self.step = h * factor;
    }
    /// Called after a step h without solution.
    pub fn halved(&mut self, h: f64) {
        self.step = 0.5 * h;
    }
}

/// Deepest halving of a fixed step, to a 64th. A choice: a step that still fails shows a motion far faster
/// than the stated step.
const DEEPEST: u64 = 6;

/// Fixed steps. Times are multiples of the step from an origin, without accumulated rounding. A failed step
/// is halved, and whole steps return when the halves meet the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FixedGrid {
    /// Time of the beginning (s).
    origin: f64,
    /// Whole steps since then.
    whole: u64,
    /// Parts of the present whole step, of which there are `2^level`.
    part: u64,
    /// Number of halvings of a whole step.
    level: u64,
}

impl FixedGrid {
    /// A grid from a time (s) on.
    pub fn new(origin: f64) -> FixedGrid {
        FixedGrid {
            origin,
            ..FixedGrid::default()
        }
    }
    /// The numbers of the grid, for a checkpoint.
    pub fn parts(&self) -> (f64, [u64; 3]) {
        (self.origin, [self.whole, self.part, self.level])
    }
    /// The grid from a checkpoint.
    pub fn from_parts(origin: f64, [whole, part, level]: [u64; 3]) -> FixedGrid {
        FixedGrid {
            origin,
            whole,
            part,
            level: level.min(DEEPEST),
        }
    }
    /// Next step (s) and the time of its end.
    pub fn next(&self, nominal: f64) -> (f64, f64) {
        let pieces = (1_u64 << self.level) as f64;
        let count = self.whole as f64 + (self.part + 1) as f64 / pieces;
        (nominal / pieces, self.origin + count * nominal)
    }
    /// The time (s) of whole steps that is nearest to another one, with the bits that [`FixedGrid::next`] gives.
    pub fn point_near(&self, time: f64, nominal: f64) -> f64 {
        self.origin + libm::round((time - self.origin) / nominal) * nominal
    }
    /// Called after an accepted step.
    pub fn advance(&mut self) {
        self.part += 1;
        while self.level > 0 && self.part.is_multiple_of(2) {
            self.part /= 2;
            self.level -= 1;
        }
        if self.level == 0 {
            self.whole += self.part;
            self.part = 0;
        }
    }
    /// Called after a failed step; `false` if it cannot be halved again.
    pub fn halve(&mut self) -> bool {
        if self.level == DEEPEST {
            return false;
        }
        self.level += 1;
        self.part *= 2;
        true
    }
}
