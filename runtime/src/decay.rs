//! How the differences of cycles that follow each other go on.

/// Factor up to which differences that turn count as sustained, not as growing.
pub(crate) const SUSTAINED: f64 = 1.02;

/// After a whole cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleReport {
    /// Cycles so far.
    pub cycles: u32,
    /// Largest change against the cycle before, and what is known of the decay; absent after the first cycle.
    pub slowest: Option<Decay>,
}

/// The channel that changes most.
#[derive(Clone, Debug, PartialEq)]
pub struct Decay {
    /// Index of the channel.
    pub channel: usize,
    /// Largest difference from the last cycle, as a share of the channel's swing within a cycle; that counts as at least the smallest
    /// clearance for a length, and a hundredth of the largest value of the dimension for others.
    pub change: f64,
    /// How such differences go on; from the third cycle on.
    pub mode: Option<Mode>,
}

impl Decay {
    /// Whether the differences are known to grow.
    pub fn grows(&self) -> bool {
        self.mode.is_some_and(|mode| mode.factor > SUSTAINED)
    }

    /// Estimated distance to the limit, as a share of the swing: the sum of all differences to come. Of a sustained beat (factor 1) it is its amplitude.
    /// Infinite for what grows, and where nothing is known yet.
    pub fn distance(&self) -> f64 {
        self.mode
            .map_or(f64::INFINITY, |mode| self.change * mode.reach())
    }
}

/// How differences go on from cycle to cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Factor from one cycle to the next.
    pub factor: f64,
    /// Turn from one cycle to the next (rad, 0…π).
    pub turn: f64,
    /// Share of the last difference, squared, that the differences before do not foretell: about 0 of decays, about 1 of noise.
    pub unforetold: f64,
}

impl Mode {
    /// All differences to come over the last one, `|λ/(1 − λ)|` with `λ = factor·exp(i turn)`; infinite for what grows.
    pub fn reach(&self) -> f64 {
        let (f, turn) = (self.factor, self.turn);
        let gap = libm::hypot(1.0 - f * libm::cos(turn), f * libm::sin(turn));
        if f <= SUSTAINED && gap > 0.0 {
            f / gap
        } else {
            f64::INFINITY
        }
    }
}
