//! Half-speed whirl of journals: motion of the pin at about half the shaft's speed that does not repeat with
//! the cycle.
//!
//! Let `z = e_x + i e_y` be the complex eccentricity (shell's axes). In the differences of successive cycles,
//! sample by sample, the repeating part cancels. Their part at half the speed is
//! `d_k = mean over cycle k of (z_{k+1} − z_k) exp(∓i θ/2)`, in the sense with the larger whirl. A whirl of
//! radius a and order ν turns it by `φ = ±(ν − ½) P` in a cycle of P rad, which gives ν, and
//! `|d| = a |exp(iνP) − 1|`, which gives a.

/// Least turn per cycle (rad) that distinguishes a whirl from a repeating motion. A choice: it limits the
/// factor by which the error of a difference enters the radius to a hundred.
const LEAST_GAP: f64 = 0.01;
/// Least number of cycles that show a whirl. A choice: three differences are one more than the fit of growth
/// and turn needs.
const FEWEST: usize = 4;

/// The orbits of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbits {
    /// Cycle angle of each sample (rad).
    pub angles: Vec<f64>,
    /// Whether the cycle turns in the positive sense.
    pub forward: bool,
    /// e of each journal (m) at each sample.
    pub eccentricities: Vec<Vec<[f64; 2]>>,
}

/// The whirl of one journal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whirl {
    /// Index of the journal.
    pub journal: usize,
    /// Radius of the part at about half speed that does not repeat (m).
    pub radius: f64,
    /// Its speed over the shaft's.
    pub order: f64,
    /// Its growth factor from cycle to cycle. Below 1 it decays.
    pub growth: f64,
}

/// Finds whirl in successive cycles of one period (rad) with equal samples; empty if there are too few.
pub fn find(cycles: &[Orbits], period: f64) -> Vec<Whirl> {
    let Some(first) = cycles.first().filter(|_| cycles.len() >= FEWEST) else {
        return Vec::new();
    };
    let samples = first.angles.len();
    let alike = |c: &&Orbits| c.angles.len() == samples && c.eccentricities.len() == samples;
    let cycles: Vec<&Orbits> = cycles.iter().filter(alike).collect();
    let journals = first.eccentricities.first().map_or(0, Vec::len);
    (0..journals)
        .filter_map(|journal| whirl_of(&cycles, journal, period))
        .collect()
}

/// The whirl in the sense with the larger amplitude. Both are tried, because the cycle's angle need not be
/// about the shell's z.
fn whirl_of(cycles: &[&Orbits], journal: usize, period: f64) -> Option<Whirl> {
    let along = in_sense(cycles, journal, period, 1.0)?;
    let against = in_sense(cycles, journal, period, -1.0)?;
    let found = if against.radius > along.radius {
        against
    } else {
        along
    };
    (found.radius > 0.0).then_some(found)
}

fn in_sense(cycles: &[&Orbits], journal: usize, period: f64, sense: f64) -> Option<Whirl> {
    let count = cycles.len() as f64;
    let samples = cycles.first()?.angles.len();
    let at = |c: &Orbits, i: usize| {
        c.eccentricities
            .get(i)
            .and_then(|e| e.get(journal))
            .copied()
            .unwrap_or_default()
    };
    // the repeating part cancels in the differences
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for pair in cycles.windows(2) {
        let mut step = [0.0; 2];
        for (i, angle) in pair[0].angles.iter().enumerate() {
            let (a, b) = (at(pair[0], i), at(pair[1], i));
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            let half = -0.5 * sense * angle;
            let (s, c) = (libm::sin(half), libm::cos(half));
            step[0] += (x * c - y * s) / samples as f64;
            step[1] += (x * s + y * c) / samples as f64;
        }
        steps.push(step);
    }
    let square = |p: &[f64; 2]| p[0] * p[0] + p[1] * p[1];
    let size = libm::sqrt(steps.iter().map(square).sum::<f64>() / (count - 1.0));
    // Σ d_{k+1} conj(d_k)
    let (mut real, mut imaginary, mut before) = (0.0, 0.0, 0.0);
    for pair in steps.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        real += b[0] * a[0] + b[1] * a[1];
        imaginary += b[1] * a[0] - b[0] * a[1];
        before += square(&a);
    }
    let turn = libm::atan2(imaginary, real);
    let growth = if before > 0.0 {
        libm::hypot(real, imaginary) / before
    } else {
        0.0
    };
    let forward = if cycles.first()?.forward { 1.0 } else { -1.0 };
    let whole = turn + 0.5 * sense * forward * period;
    let gap = libm::hypot(growth * libm::cos(whole) - 1.0, growth * libm::sin(whole));
    let radius = size / gap.max(LEAST_GAP);
    Some(Whirl {
        journal,
        radius,
        order: 0.5 + sense * forward * turn / period,
        growth,
    })
}

/// Orders between which a whirl is at about half speed. A choice: oil whirl has orders of 0.4 to 0.5, and the
/// limits leave room for the error of a few cycles.
const HALF_SPEED: (f64, f64) = (0.35, 0.55);
/// A motion that does not repeat is no whirl if it is below this share of the clearance. A choice: the error
/// of an orbit at the usual tolerance is about as large, and no gap changes by less.
const LEAST_SHARE: f64 = 2e-3;

impl Whirl {
    /// Whether it is larger than the error of an orbit in a journal with this clearance (m).
    pub fn is_seen(&self, clearance: f64) -> bool {
        self.radius > LEAST_SHARE * clearance
    }

    /// Whether it is at about half speed and does not decay fast.
    pub fn is_sustained(&self) -> bool {
        // a choice: with this factor a tenth of the whirl is left after some twenty cycles
        (HALF_SPEED.0..=HALF_SPEED.1).contains(&self.order) && self.growth > 0.9
    }
}
