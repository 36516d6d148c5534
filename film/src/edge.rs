//! Faces between a cell and a place with fixed pressure: open ends, and edges of openings.
//!
//! With one cell the slope of the pressure at such a face is known to first order alone, and a parabola across n
//! cells, as in a short bearing, has a force that is too large by 2/n². So the pressure behind the face is taken as a
//! parabola through the fixed value and the means of the two cells behind it, of widths a and b. With `u` as the
//! q of a cell less that of the fixed place, the flow out of the first cell is
//!
//! ```text
//! k w [(1 + s) u₁ − s u₂]      w = 2 (2a + b)/(a (a + b)) l      s = a²/((a + b)(2a + b))
//! ```
//!
//! with the length l of the face; for equal cells w is 3 l/a and s is 1/6. A parabola across is exact then.
//!
//! Where the film ruptures near an end, the parabola would draw oil out of a place that has none. So at ends, and at
//! openings that are full in part, the second cell counts no more than a limit that depends on the first one and on the
//! fixed q:
//!
//! ```text
//! k w [(1 + s) u₁ − s min(u₂, ρ q₁ − r q_fixed)]      r = (2a + b)/a      ρ = r/4 + 3/4 (1 + 1/s)
//! ```
//!
//! With a cavity in the first cell, q₁ = 0, the limited flow is that of a straight line. For equal cells r is 3 and ρ is
//! 6. A full film is far from the limit, so its equations stay linear. The flow rises with q₁, as ρ is below `1 + 1/s`,
//! falls with q₂, and has no jump. So the solution stays unique.

/// An edge with two cells behind it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// Number of its link.
    pub link: usize,
    /// The cell at the fixed place, and the next one.
    pub cells: [usize; 2],
    /// Number of the fixed place.
    pub fixed: usize,
    /// Sign of the link's flow, from a to b, where it leaves the first cell.
    pub outward: f64,
    /// Place of the second cell in the row of the first.
    pub toward: usize,
    /// Whether the second cell has a limit.
    limited: bool,
    /// s.
    bend: f64,
    /// r and ρ.
    limit: [f64; 2],
}

impl Edge {
    /// w over `2 l/a` of a cell whose neighbour is its mirror image. For equal widths `(2a + b)/(a + b)` is
    /// 3/2.
    pub(crate) const MIRRORED: f64 = 1.5;

    /// The edge of a link from `sides[0]` to `sides[1]`, of which one is the fixed place, with the widths of both
    /// cells across the face; and w over `2 l/a`, the weight of one cell alone.
    pub(crate) fn new(
        link: usize,
        sides: [usize; 2],
        own: usize,
        inner: usize,
        toward: usize,
        widths: [f64; 2],
        limited: bool,
    ) -> (Self, f64) {
        let [a, b] = widths;
        let first = sides[0] == own;
        let bend = a * a / ((a + b) * (2.0 * a + b));
        let straight = (2.0 * a + b) / a;
        let edge = Edge {
            link,
            cells: [own, inner],
            fixed: if first { sides[1] } else { sides[0] },
            outward: if first { 1.0 } else { -1.0 },
            toward,
            limited,
            bend,
            limit: [straight, straight / 4.0 + 0.75 * (1.0 + 1.0 / bend)],
        };
        (edge, (2.0 * a + b) / (a + b))
    }

    /// Factors of q in the first cell, in the second one and at the fixed place, which the flow has beside
    /// u₁: those of the parabola, or of the limit. Dimensionless.
    pub(crate) fn factors(&self, at_limit: bool) -> [f64; 3] {
        let [r, rho] = self.limit;
        match at_limit {
            true => [self.bend * (1.0 - rho), 0.0, self.bend * (r - 1.0)],
            false => [self.bend, -self.bend, 0.0],
        }
    }

    /// The places that the factors belong to.
    pub(crate) fn places(&self) -> [usize; 3] {
        [self.cells[0], self.cells[1], self.fixed]
    }

    /// Drop of q that the flow from a to b has beside that between its sides. In Pa, positive from a to b.
    pub(crate) fn drop(&self, at_limit: bool, q: impl Fn(usize) -> f64) -> f64 {
        let parts = self.places().into_iter().zip(self.factors(at_limit));
        self.outward * parts.map(|(place, factor)| factor * q(place)).sum::<f64>()
    }

    /// Whether the limit counts at the present q. Within `near` of a change the present state stays.
    pub(crate) fn is_at_limit(&self, present: bool, near: f64, q: impl Fn(usize) -> f64) -> bool {
        // pressures below zero become a cavity
        let [first, second] = self.cells.map(|cell| q(cell).max(0.0));
        let [r, rho] = self.limit;
        let beyond = second - (rho * first + (1.0 - r) * q(self.fixed));
        self.limited
            && if beyond.abs() <= near {
                present
            } else {
                beyond > 0.0
            }
    }
}
