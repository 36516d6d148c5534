//! Forces and the other results of a solution.

use crate::error::{FilmError, Place};
use crate::film::{Film, Level, LevelWork, Work};
use crate::grid::place;
use crate::inputs::{
    ECCENTRICITY, END_PRESSURE, FORCE, LOSS, MOMENT, SHAPE_FORCE, SIDE_FLOW, SPIN, SUPPLY, TILT,
    TORQUE, VISCOSITY,
};
use crate::source::{Cavitation, Ends, Feed};

/// Viscosity of Barus' oil over that at rest, beyond which it rises no more: α q = 1 − 1/50 = 0.98. A choice:
/// the law itself is no good at such pressures, and without a limit q would end at a pole at α q = 1.
pub(crate) const THICKEST: f64 = 50.0;

/// Results of a solution beside its outputs. Flows of the rule [`Cavitation::Half`] are those of its cut pressure
/// and do not conserve oil.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Highest pressure over the cavitation pressure, of a parabola through the highest cell and its
    /// neighbours, Pa.
    pub maximum_pressure: f64,
    /// Place of the highest pressure.
    pub maximum_pressure_at: Place,
    /// Least gap, over cells, faces and ends, m.
    pub minimum_gap: f64,
    /// Place of the least gap.
    pub minimum_gap_at: Place,
    /// Net flow out of the ends at negative and at positive z, m³/s.
    pub end_flow: [f64; 2],
    /// Flow out of both ends where it leaves, m³/s.
    pub outflow: f64,
    /// Flow into both ends where it enters (flooded ends), m³/s.
    pub inflow: f64,
    /// Flow from each opening into the bearing, with the oil that fills the gap over the opening itself,
    /// m³/s.
    pub supply_flow: Vec<f64>,
    /// Torque of the shear alone, `T_c = μ₀ R² ω ∫ ϑ e^(α p)/h dA`, N m.
    pub shear_torque: f64,
    /// Power of the shear, `T_c ω`, W.
    pub shear_power: f64,
    /// Power of the pressure flow, `∫ h³/12μ |∇p|² dA`, W.
    pub pressure_power: f64,
    /// Power of the supply and of flooded ends, `Σ p_s Q_s − p_end Q_end`, W.
    pub pumping_power: f64,
    /// `∫ p_a dA` of the asperities, N.
    pub asperity_load: f64,
    /// Its share of `∫ (p + p_a) dA`.
    pub asperity_share: f64,
    /// Highest pressure of the asperities, at the least gap, Pa. If the least gap is over an opening, it is
    /// the highest one at the middle of a cell.
    pub asperity_pressure: f64,
    /// Power of the friction where asperities touch, W.
    pub boundary_power: f64,
    /// Share of the area in the cavity.
    pub cavitated: f64,
    /// Mean content.
    pub content: f64,
    /// Volume of oil, `∫ ϑ h dA`, m³.
    pub volume: f64,
    /// Rounds of the search for the cavity.
    pub rounds: usize,
}

/// Share of a pressure, or of the clearance, below which two extremes are equal, so that rounding does not
/// choose their place. It is far above the rounding of a solution and far below the height of any extreme
/// that matters.
const TIE: f64 = 1e-9;

/// A field over the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Pressure over the cavitation pressure, Pa.
    Pressure,
    /// Film content.
    Content,
    /// Gap, m.
    Gap,
    /// Pressure of the asperities, Pa.
    Asperities,
}

impl Film {
    /// 2 if the cells are one half of the bearing, else 1.
    pub(crate) fn halves(&self) -> f64 {
        if self.source.half_width { 2.0 } else { 1.0 }
    }

    /// Pressure of cells and fixed places from q. With a floor of the gap, for the iterates of a solver, oil beyond
    /// [`THICKEST`] keeps this viscosity, so its pressure grows linearly with q. Without a floor it is refused.
    pub(crate) fn set_pressure(&self, work: &mut Work) -> Result<(), FilmError> {
        let (piezo, state) = (self.source.piezo, &mut work.levels[0]);
        let limit = 1.0 - 1.0 / THICKEST;
        for (at, (pressure, q)) in state.pressure.iter_mut().zip(&state.q).enumerate() {
            // pressures that the rule `half` cuts have no force and no slope
            *pressure = if *q < 0.0 && self.source.cavitation == Cavitation::Half {
                [0.0, 0.0]
            } else if piezo == 0.0 {
                [*q, 1.0]
            } else if piezo * q < limit {
                [-libm::log1p(-piezo * q) / piezo, 1.0 / (1.0 - piezo * q)]
            } else if self.source.floor > 0.0 {
                let beyond = q - limit / piezo;
                [libm::log(THICKEST) / piezo + THICKEST * beyond, THICKEST]
            } else {
                let grid = &self.levels[0].grid;
                let place = if at < grid.cells.len() {
                    grid.place(at)
                } else {
                    place(0.0, 0.0)
                };
                return Err(FilmError::Piezo {
                    reached: piezo * q,
                    place,
                });
            };
        }
        state.set_bent(&self.levels[0].grid.edges);
        Ok(())
    }

    /// Slope of the logarithm of the viscosity by q, of a place where p has a slope by q. In 1/Pa; `slope` is
    /// ∂p/∂q, dimensionless.
    pub(crate) fn thickening(&self, slope: f64) -> f64 {
        if slope < THICKEST {
            self.source.piezo * slope
        } else {
            0.0
        }
    }

    /// Factor of the shear in a cell, `ϑ exp(α p)`; of rules without content, ϑ is 1, as is usual.
    /// Dimensionless.
    pub(crate) fn shear_factor(&self, state: &LevelWork, cell: usize) -> f64 {
        state.content[cell] * state.pressure[cell][1].max(1.0)
    }

    /// Torque of the asperities' friction over their load, `μ_b R sgn ω` (m) with `sgn ω = ω/√(ω² + (1 rad/s)²)`, and
    /// its slope by ω.
    pub(crate) fn boundary(&self, spin: f64) -> [f64; 2] {
        let Some(rough) = &self.source.rough else {
            return [0.0; 2];
        };
        let arm = rough.friction * self.source.radius;
        let size = libm::sqrt(spin * spin + 1.0);
        [arm * spin / size, arm / (size * size * size)]
    }

    /// Writes the outputs, with p the pressure of the film and p_a that of the asperities:
    ///
    /// ```text
    /// F = −∫ (p + p_a) n dA     M_x = ∫ (p + p_a) z sin θ dA     M_y = −∫ (p + p_a) z cos θ dA
    /// T = μ₀ R² ω ∫ ϑ e^(α p)/h dA − ½ ∫ p ∂h/∂θ dA + ∫ (p + p_a) ∂s_p/∂θ dA + μ_b R sgn ω ∫ p_a dA
    /// loss = ω (μ₀ R² ω ∫ ϑ e^(α p)/h dA + μ_b R sgn ω ∫ p_a dA) + ∫ h³/12μ |∇p|² dA
    /// ```
    ///
    /// The side flow is the sum of the flows through all faces at the ends where the oil leaves.
    ///
    /// The part `−½ ∫ p_a ∂h/∂θ dA` is left out: p_a is a function of h alone, so it vanishes around a closed ring.
    pub(crate) fn integrate(&self, work: &Work, outputs: &mut [f64]) {
        let (level, state, x) = (&self.levels[0], &work.levels[0], &work.inputs);
        outputs.fill(0.0);
        let shear = x[VISCOSITY] * self.source.radius * self.source.radius * x[SPIN];
        let boundary = self.boundary(x[SPIN])[0];
        let [mut fx, mut fy, mut mx, mut my, mut torque] = [0.0; 5];
        let [mut rubbing, mut pressing, mut leaving] = [0.0; 3];
        for (at, cell) in level.grid.cells.iter().enumerate() {
            let touch = state.touching[at][0];
            let load = cell.area * (state.pressure[at][0] + touch);
            let [cos, sin] = cell.mean_normal;
            let (along_x, along_y) = (load * cos, load * sin);
            fx -= along_x;
            fy -= along_y;
            mx += along_y * cell.z;
            my -= along_x * cell.z;
            let rubbed = shear * self.shear_factor(state, at) * cell.area * state.shear[at].value
                + boundary * cell.area * touch;
            rubbing += rubbed;
            torque += rubbed + load * state.pin_slope[at][0];
        }
        // −½ ∫ p ∂h/∂θ dA, summed by parts: the flow that the surfaces carry through a face against the pressure
        let ends = level.grid.ends(&self.source);
        for (at, (link, gap)) in level.grid.links.iter().zip(&state.link_gap).enumerate() {
            let drop = state.pressure[link.a][0] - state.pressure[link.b][0];
            if link.carry > 0.0 {
                torque -= link.carry * gap * drop;
            }
            let pressed = state.pressed(at, link);
            pressing += pressed * drop;
            leaving += link.outward(ends, pressed) * pressed;
        }
        outputs[FORCE..FORCE + 2].copy_from_slice(&[fx, fy]);
        outputs[MOMENT..MOMENT + 2].copy_from_slice(&[mx, my]);
        outputs[TORQUE] = torque;
        outputs[LOSS] = rubbing * x[SPIN] + pressing;
        outputs[SIDE_FLOW] = leaving;
        let load =
            |at: usize| level.grid.cells[at].area * (state.pressure[at][0] + state.touching[at][0]);
        level.shapes[2].add_moments(load, &mut outputs[SHAPE_FORCE..]);
        for output in outputs.iter_mut() {
            *output *= self.halves();
        }
        if self.source.half_width {
            outputs[MOMENT..MOMENT + 2].fill(0.0);
        }
    }

    /// A field of the last solution, cell by cell.
    pub fn field(&self, which: Quantity, work: &Work, out: &mut [f64]) {
        let state = &work.levels[0];
        for (at, out) in out.iter_mut().enumerate() {
            *out = match which {
                Quantity::Pressure => state.pressure[at][0],
                Quantity::Content => state.content[at],
                Quantity::Gap => state.gaps[1][at],
                Quantity::Asperities => state.touching[at][0],
            };
        }
    }

    /// Results of the last solution.
    #[must_use]
    pub fn summary(&self, work: &Work) -> Summary {
        self.summary_in(work, Vec::new())
    }

    /// Results of the last solution. `supply_flow` lends its memory for those of the openings, so nothing is
    /// allocated.
    #[must_use]
    pub fn summary_in(&self, work: &Work, mut supply_flow: Vec<f64>) -> Summary {
        supply_flow.clear();
        supply_flow.resize(self.source.openings.len(), 0.0);
        let (level, state, x) = (&self.levels[0], &work.levels[0], &work.inputs);
        let (maximum_pressure, maximum_pressure_at) = self.highest(level, state, x[END_PRESSURE]);
        let (minimum_gap, minimum_gap_at) = self.thinnest(state, x);
        let mut summary = Summary {
            maximum_pressure,
            maximum_pressure_at,
            minimum_gap,
            minimum_gap_at,
            end_flow: [0.0; 2],
            outflow: 0.0,
            inflow: 0.0,
            supply_flow,
            shear_torque: 0.0,
            shear_power: 0.0,
            pressure_power: 0.0,
            pumping_power: 0.0,
            asperity_load: 0.0,
            asperity_share: 0.0,
            asperity_pressure: 0.0,
            boundary_power: 0.0,
            cavitated: 0.0,
            content: 0.0,
            volume: self.volume(work),
            rounds: work.rounds,
        };
        self.add_flows(&mut summary, level, state, x);
        let shear = x[VISCOSITY] * self.source.radius * self.source.radius * x[SPIN];
        let (mut area, mut load) = (0.0, 0.0);
        // least gaps over cells of the land and over those with an opening
        let mut least = [f64::INFINITY; 2];
        for (at, cell) in level.grid.cells.iter().enumerate() {
            area += cell.area;
            summary.shear_torque +=
                shear * self.shear_factor(state, at) * cell.area * state.shear[at].value;
            let touch = state.touching[at][0];
            summary.asperity_load += cell.area * touch;
            load += cell.area * (touch + state.pressure[at][0]);
            summary.asperity_pressure = summary.asperity_pressure.max(touch);
            let opened = cell.held.is_some() || state.covered[at][0] > 0.0;
            let least = &mut least[usize::from(opened)];
            *least = least.min(state.gaps[1][at]);
            summary.content += cell.area * state.content[at];
            if !state.full[at] || (self.source.cavitation == Cavitation::Half && state.q[at] < 0.0)
            {
                summary.cavitated += cell.area;
            }
        }
        // the pressure of asperities falls by half within a fraction of the roughness, and so within a cell
        if least[0] <= least[1] {
            let touch = self.surfaces.touching(minimum_gap)[0];
            summary.asperity_pressure = summary.asperity_pressure.max(touch);
        }
        summary.cavitated /= area;
        summary.content /= area;
        let halves = self.halves();
        summary.asperity_load *= halves;
        if load > 0.0 {
            summary.asperity_share = summary.asperity_load / (halves * load);
        }
        summary.boundary_power = self.boundary(x[SPIN])[0] * summary.asperity_load * x[SPIN];
        summary.shear_torque *= halves;
        summary.shear_power = summary.shear_torque * x[SPIN];
        summary
    }

    /// Sum of the flows from all openings into the bearing: that of [`Summary::supply_flow`], m³/s.
    #[must_use]
    pub fn supplied(&self, work: &Work) -> f64 {
        let (level, state, x) = (&self.levels[0], &work.levels[0], &work.inputs);
        let openings = level.grid.cells.len()..level.grid.ends(&self.source);
        let mut sum = 0.0;
        for (at, link) in level.grid.links.iter().enumerate() {
            let [from, to] = [link.a, link.b].map(|side| openings.contains(&side));
            if from != to {
                let flow = state.carried(at, link, x[SPIN]) + state.pressed(at, link);
                sum += if from { flow } else { -flow };
            }
        }
        let held = level.grid.cells.iter().enumerate();
        let held = held.filter(|(_, cell)| cell.held.is_some());
        let over: f64 = held
            .map(|(at, cell)| cell.area * state.cell_rate[at] * state.content[at])
            .sum();
        self.halves() * (sum + over)
    }

    fn add_flows(&self, summary: &mut Summary, level: &Level, state: &LevelWork, x: &[f64]) {
        let count = level.grid.cells.len();
        let (ends, halves) = (level.grid.ends(&self.source), self.halves());
        for (at, link) in level.grid.links.iter().enumerate() {
            let pressed = state.pressed(at, link);
            let flow = state.carried(at, link, x[SPIN]) + pressed;
            let drop = state.pressure[link.a][0] - state.pressure[link.b][0];
            summary.pressure_power += halves * pressed * drop;
            for (side, sign) in [(link.a, 1.0), (link.b, -1.0)] {
                let entering = halves * sign * flow;
                if side == ends {
                    let positive = usize::from(level.grid.sites[at].z > 0.0);
                    summary.end_flow[positive] -= entering;
                    summary.outflow += (-entering).max(0.0);
                    summary.inflow += entering.max(0.0);
                } else if side >= count {
                    summary.supply_flow[side - count] += entering;
                }
            }
        }
        for (at, cell) in level.grid.cells.iter().enumerate() {
            if let Some(opening) = cell.held {
                summary.supply_flow[opening] +=
                    halves * cell.area * state.cell_rate[at] * state.content[at];
            }
        }
        if self.source.half_width {
            let flow = summary.end_flow[1] / 2.0;
            summary.end_flow = [flow, flow];
        }
        for (at, opening) in self.source.openings.iter().enumerate() {
            if opening.feed == Feed::Pressure {
                summary.pumping_power += x[SUPPLY + at] * summary.supply_flow[at];
            }
        }
        if self.source.ends == Ends::Open {
            summary.pumping_power -= x[END_PRESSURE] * (summary.end_flow[0] + summary.end_flow[1]);
        }
    }

    /// Highest pressure and its place, by parabolas in both directions through the highest cell and the cells
    /// or edges beside it. In Pa, over the cavitation pressure.
    fn highest(&self, level: &Level, state: &LevelWork, end_pressure: f64) -> (f64, Place) {
        let grid = &level.grid;
        let pressure = |cell: usize| state.pressure[cell][0];
        let count = grid.cells.len();
        let top = (0..count).fold(0, |best, cell| {
            if pressure(cell) > pressure(best) * (1.0 + TIE) {
                cell
            } else {
                best
            }
        });
        let (column, row) = (top / grid.across, top % grid.across);
        let cell = &grid.cells[top];
        let (mut highest, mut at) = (pressure(top), place(cell.angle, cell.z));
        if cell.held.is_some() {
            return (highest, at);
        }
        // a cell has its mean pressure, but at an opening the pressure is known at the edge
        let beside = |next: usize, sign: f64, own: f64, width: f64| match grid.cells[next].held {
            Some(_) => Beside::point(sign * own / 2.0, pressure(next)),
            None => Beside {
                place: sign * (own + width) / 2.0,
                mean: pressure(next),
                width,
            },
        };
        // around, parabolas through the middles are nearer to the exact pressure than those through means
        let around = [(grid.around - 1, -1.0), (1, 1.0)].map(|(step, sign)| {
            let next = (column + step) % grid.around * grid.across + row;
            let beside = beside(next, sign, cell.sector, grid.cells[next].sector);
            Beside {
                width: 0.0,
                ..beside
            }
        });
        let (shift, rise) = vertex(highest, 0.0, around);
        at = place(cell.angle + shift, at.across);
        highest += rise;
        let height = |row: usize| grid.heights[row + 1] - grid.heights[row];
        let own = height(row);
        let end = |sign: f64, mirrored: bool| match mirrored || self.source.ends == Ends::Sealed {
            true => beside(top, sign, own, own),
            false => Beside::point(sign * own / 2.0, end_pressure),
        };
        let low = match row.checked_sub(1) {
            Some(below) => beside(top - 1, -1.0, own, height(below)),
            None => end(-1.0, self.source.half_width),
        };
        let high = match row + 1 < grid.across {
            true => beside(top + 1, 1.0, own, height(row + 1)),
            false => end(1.0, false),
        };
        let (shift, rise) = vertex(pressure(top), own, [low, high]);
        highest += rise;
        at.across += shift;
        // rounding of a film that is the same on both sides
        if at.across.abs() < TIE * self.source.width {
            at.across = 0.0;
        }
        (highest, at)
    }

    /// Least gap and its place: over faces and middles of cells and over both ends, where a tilted pin is
    /// closest. The place of an aligned pin between plain surfaces is at mid width. For plain surfaces both
    /// are exact. In m.
    fn thinnest(&self, state: &LevelWork, x: &[f64]) -> (f64, Place) {
        let grid = &self.levels[0].grid;
        let half = self.source.width / 2.0;
        let plain = self.source.profile.is_empty()
            && self.source.pin_profile.is_empty()
            && self.source.shapes.is_empty();
        if plain {
            let end = |z: f64| {
                let (ex, ey) = (
                    x[ECCENTRICITY] + z * x[TILT],
                    x[ECCENTRICITY + 1] + z * x[TILT + 1],
                );
                (
                    self.source.clearance - libm::hypot(ex, ey),
                    place(libm::atan2(ey, ex), z),
                )
            };
            let (low, high) = (end(-half), end(half));
            let tie = (low.0 - high.0).abs() <= TIE * self.source.clearance;
            return match low.0 < high.0 {
                _ if tie => end(0.0),
                true => low,
                false => high,
            };
        }
        let mut least = (f64::INFINITY, place(0.0, 0.0));
        let mut look = |gap: f64, angle: f64, z: f64| {
            if gap < least.0 - TIE * self.source.clearance {
                least = (gap, place(angle, z));
            }
        };
        for (site, gap) in grid.sites.iter().zip(&state.gaps[0]) {
            look(*gap, site.angle, site.z);
        }
        for (cell, gap) in grid.cells.iter().zip(&state.gaps[1]) {
            look(*gap, cell.angle, cell.z);
        }
        // sealed ends and lines at ends are no links
        let (first, ends) = (SUPPLY + self.source.openings.len(), &self.ends);
        if self.source.shapes.is_empty() {
            for (angle, z) in &ends.places {
                look(self.stiff_gap(x, *angle, *z), *angle, *z);
            }
        }
        let amplitudes = &x[first..][..self.source.shapes.len()];
        ends.shapes.for_each(amplitudes, |at, deflection| {
            if let Some((angle, z)) = ends.places.get(at) {
                look(self.stiff_gap(x, *angle, *z) + deflection, *angle, *z);
            }
        });
        least
    }

    /// Largest magnitude of the deflection by the shapes in the middle of a cell, m.
    pub(crate) fn deflection(&self, work: &Work) -> f64 {
        let level = &self.levels[0];
        let amplitudes = &work.inputs[SUPPLY + self.source.openings.len()..];
        level.shapes[1].largest(&amplitudes[..self.source.shapes.len()])
    }

    /// The gap at any place without the deflection by shapes, m.
    fn stiff_gap(&self, x: &[f64], angle: f64, z: f64) -> f64 {
        let zeta = 2.0 * z / self.source.width;
        let (sin, cos) = libm::sincos(angle);
        let eccentric =
            (x[ECCENTRICITY] + z * x[TILT]) * cos + (x[ECCENTRICITY + 1] + z * x[TILT + 1]) * sin;
        self.source.clearance + self.source.shell_profile(angle, zeta) - eccentric
            + self
                .source
                .pin_profile(angle - x[crate::inputs::TURN], zeta)
                .0
    }
}

/// The pressure beside a cell, at a place that counts from the middle of this cell.
#[derive(Clone, Copy)]
struct Beside {
    place: f64,
    /// Mean over a width about the place.
    mean: f64,
    /// 0 for the pressure at a point.
    width: f64,
}

impl Beside {
    fn point(place: f64, pressure: f64) -> Self {
        Beside {
            place,
            mean: pressure,
            width: 0.0,
        }
    }
}

/// The highest point of the parabola that has the mean of a cell of this width and the means of the sides:
/// its place from the middle of the cell, and its height above the mean.
fn vertex(mean: f64, width: f64, sides: [Beside; 2]) -> (f64, f64) {
    // slope and bend from `slope x + bend (x² + (w² - width²)/12) = mean beside - mean`
    let [before, behind] = sides.map(|side| {
        let square = side.place * side.place + (side.width * side.width - width * width) / 12.0;
        [side.place, square, side.mean - mean]
    });
    let determinant = before[0] * behind[1] - behind[0] * before[1];
    let bend = (before[0] * behind[2] - behind[0] * before[2]) / determinant;
    let slope = (before[2] * behind[1] - behind[2] * before[1]) / determinant;
    if bend >= 0.0 {
        return (0.0, 0.0);
    }
    let shift = (-slope / (2.0 * bend)).clamp(sides[0].place, sides[1].place);
    let over_mean = bend * width * width / 12.0;
    (shift, slope * shift + bend * shift * shift - over_mean)
}
