//! Decay and growth of the differences between successive cycles.

/// Factor up to which turning differences count as sustained and not as growing. A choice: a beat that
/// neither grows nor decays has a factor near one, not exactly one, because it is fitted to few cycles.
pub(crate) const SUSTAINED: f64 = 1.02;

/// The report after a whole cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleReport {
    /// Cycles so far.
    pub cycles: u32,
    /// Largest change from the cycle before, with its decay; absent after the first cycle.
    pub slowest: Option<Decay>,
}

/// The channel that changes most.
#[derive(Clone, Debug, PartialEq)]
pub struct Decay {
    /// Index of the channel.
    pub channel: usize,
    /// Largest difference from the last cycle, as a share of the channel's swing within a cycle. For a length
    /// the swing counts as at least the smallest length that a class resolves, and for others as at least a
    /// hundredth of the largest value of the dimension.
    pub change: f64,
    /// Factor and turn of such differences; from the third cycle on.
    pub mode: Option<Mode>,
}

impl Decay {
    /// Whether the differences certainly grow.
    pub fn grows(&self) -> bool {
        self.mode.is_some_and(|mode| mode.factor > SUSTAINED)
    }

    /// Estimated distance to the limit, as a share of the swing: the sum of all future differences. For a
    /// sustained beat (factor 1) it is the amplitude. Infinite for growing differences, and before an
    /// estimate exists.
    pub fn distance(&self) -> f64 {
        self.mode
            .map_or(f64::INFINITY, |mode| self.change * mode.reach())
    }
}

/// Factor and turn of differences from cycle to cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Factor from one cycle to the next.
    pub factor: f64,
    /// Turn from one cycle to the next (rad, 0…π).
    pub turn: f64,
    /// Share of the last difference, squared, that does not follow from the earlier ones: about 0 for decays,
    /// about 1 for noise, and 1 if the cycles differ at so few samples that any earlier differences fit.
    pub unpredicted: f64,
}

impl Mode {
    /// Number of cycles until the distance to the limit has fallen to 1, of a last difference `far`.
    pub fn cycles(&self, far: f64) -> f64 {
        libm::log((far * self.reach()).max(1.0)) / -libm::log(self.factor)
    }

    /// Sum of all future differences over the last one, `|λ/(1 − λ)|` with `λ = factor·exp(i turn)`; infinite
    /// for growing ones.
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
