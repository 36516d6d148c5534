//! Exact derivatives of the outputs, by adjoints on the cavity of the last solution.
//!
//! At a solution `R(u, x) = 0` an output `y = g(u, x)` has `dy/dx = ∂g/∂x − λᵀ ∂R/∂x` with `Aᵀ λ = ∂g/∂u`, `A
//! = ∂R/∂u`. All inputs but the pressures act through the gap, its rate, ω and μ: the sensitivities by gap
//! and rate of each place come first, and are then summed with the weights of the inputs.

use crate::block::add_lanes as add;
use crate::film::{Film, Level, LevelWork, TOGETHER, Work};
use crate::inputs::{
    ECCENTRICITY, END_PRESSURE, FORCE, LOSS, MOMENT, RATE, SHAPE_FORCE, SIDE_FLOW, SPIN, SUPPLY,
    TILT, TILT_RATE, TORQUE, TURN, VISCOSITY,
};
use crate::source::{Cavitation, Feed};
use crate::waves::DEGREES;

/// The set of all outputs before the forces of shapes.
pub(crate) const ALL: [bool; SHAPE_FORCE] = [true; SHAPE_FORCE];

/// The solution at which the derivatives are wanted.
struct Solution<'a> {
    level: &'a Level,
    state: &'a LevelWork,
    x: &'a [f64],
    /// The step and the content before it.
    past: Option<(f64, &'a [f64])>,
}

/// Outputs whose adjoints are solved together.
struct Group<const N: usize> {
    outputs: [Option<usize>; N],
    /// 1 at the torque, else 0.
    torque: [f64; N],
    /// Derivatives of the outputs by the torque of shear and friction: 1 at the torque, ω at the loss.
    rubbing: [f64; N],
    /// 1 at the loss and at the side flow, else 0.
    loss: [f64; N],
    side_flow: [f64; N],
}

impl<const N: usize> Group<N> {
    fn new(outputs: [Option<usize>; N], spin: f64) -> Self {
        let lane = |which: usize| outputs.map(|output| f64::from(u8::from(output == Some(which))));
        let [torque, loss, side_flow] = [TORQUE, LOSS, SIDE_FLOW].map(lane);
        let mut rubbing = torque;
        add(&mut rubbing, spin, &loss);
        Group {
            outputs,
            torque,
            rubbing,
            loss,
            side_flow,
        }
    }

    /// Derivatives of the outputs by the flow that the pressure drives through a face, apart from those by
    /// the pressures.
    fn by_flow(&self, p_drop: f64, outward: f64) -> [f64; N] {
        let mut lanes = self.loss.map(|loss| p_drop * loss);
        add(&mut lanes, outward, &self.side_flow);
        lanes
    }
}

impl Film {
    /// Derivatives of the outputs by the inputs at the last solution of `work`, output by output: `outputs()
    /// × inputs()` numbers.
    ///
    /// They are those of the discrete outputs, except where a cell changes sides: there the derivatives on
    /// both sides differ by the order of a cell, and this is the one of the present set. The content before a
    /// step is constant.
    pub fn tangent(&self, work: &mut Work, dy_dx: &mut [f64]) {
        self.tangent_of(&ALL, work, dy_dx);
    }

    /// The rows of [`Film::tangent`] of the forces of all shapes and of those outputs before them that
    /// `wanted` names; the others are zero. A row does not depend on the set, to the last bit. The time grows
    /// with the number of rows: five of a film without shapes take three quarters of the time of all seven.
    pub fn tangent_of(&self, wanted: &[bool; SHAPE_FORCE], work: &mut Work, dy_dx: &mut [f64]) {
        dy_dx.fill(0.0);
        // a half has no moments
        let skipped = |output: &usize| {
            let unread = wanted.get(*output).is_some_and(|wanted| !wanted);
            unread || self.source.half_width && (MOMENT..TORQUE).contains(output)
        };
        let mut left = (0..self.outputs()).filter(|output| !skipped(output));
        loop {
            match left.clone().count() {
                0 => return,
                1..=2 => self.differentiate::<2>(work, &mut left, dy_dx),
                3..=4 => self.differentiate::<4>(work, &mut left, dy_dx),
                5..=6 => self.differentiate::<6>(work, &mut left, dy_dx),
                _ => self.differentiate::<TOGETHER>(work, &mut left, dy_dx),
            }
        }
    }

    /// Derivatives of the next outputs.
    fn differentiate<const N: usize>(
        &self,
        work: &mut Work,
        left: &mut impl Iterator<Item = usize>,
        dy_dx: &mut [f64],
    ) {
        let outputs = [(); N].map(|()| left.next());
        let group = Group::new(outputs, work.inputs[SPIN]);
        let (level, inputs) = (&self.levels[0], self.inputs());
        let solution = Solution {
            level,
            state: &work.levels[0],
            x: &work.inputs,
            past: work.step.map(|step| (step, work.before.as_slice())),
        };
        let places = level.grid.cells.len() + self.source.openings.len() + 1;
        let adjoint = work.adjoint.as_chunks_mut::<N>().0;
        let (adjoint, columns) = adjoint[..places + 2 * level.grid.across].split_at_mut(places);
        let slopes = &mut work.slopes.as_chunks_mut::<N>().0[..inputs];
        slopes.fill([0.0; N]);
        self.weigh(&solution, &group, adjoint);
        self.direct(&solution, &group, adjoint, slopes);
        self.solve_adjoint(&solution, &group, adjoint, columns);
        self.sum_links(&solution, &group, adjoint, slopes);
        self.sum_cells(&solution, &group, adjoint, slopes);
        for (lane, output) in outputs.iter().enumerate() {
            let Some(output) = output else { continue };
            let row = &mut dy_dx[output * inputs..(output + 1) * inputs];
            for (slope, lanes) in row.iter_mut().zip(slopes.iter()) {
                *slope = self.halves() * lanes[lane];
            }
            if self.source.half_width {
                row[TILT..SPIN].fill(0.0);
            }
        }
    }

    /// Derivatives of the outputs by the pressure of each cell and fixed place, to `adjoint`.
    fn weigh<const N: usize>(
        &self,
        solution: &Solution,
        group: &Group<N>,
        adjoint: &mut [[f64; N]],
    ) {
        let Solution { level, state, .. } = *solution;
        adjoint.fill([0.0; N]);
        let (count, ends) = (level.grid.cells.len(), level.grid.ends(&self.source));
        for (lane, output) in group.outputs.iter().enumerate() {
            let Some(output) = *output else { continue };
            for (at, adjoint) in adjoint[..count].iter_mut().enumerate() {
                adjoint[lane] = self.weight(solution, output, at);
            }
            if output == TORQUE {
                for (link, gap) in level.grid.links.iter().zip(&state.link_gap) {
                    adjoint[link.a][lane] -= link.carry * gap;
                    adjoint[link.b][lane] += link.carry * gap;
                }
            }
            if output == LOSS || output == SIDE_FLOW {
                for (at, link) in level.grid.links.iter().enumerate() {
                    let pressed = state.pressed(at, link);
                    let [own, conducted] = match output {
                        LOSS => [
                            pressed,
                            state.pressure[link.a][0] - state.pressure[link.b][0],
                        ],
                        _ => [0.0, link.outward(ends, pressed)],
                    };
                    for (side, sign) in [(link.a, 1.0), (link.b, -1.0)] {
                        // dq/dp; a pressure that the rule `half` cuts has none
                        let slope = state.pressure[side][1];
                        if slope > 0.0 {
                            adjoint[side][lane] +=
                                sign * (own + state.conductance[at] * conducted / slope);
                        }
                    }
                }
                self.weigh_edges(solution, output, |side, weight| {
                    adjoint[side][lane] += weight
                });
            }
        }
    }

    /// Derivatives of the loss or of the side flow by the pressures that the edges read beside those of their sides.
    fn weigh_edges(&self, solution: &Solution, output: usize, mut weigh: impl FnMut(usize, f64)) {
        let Solution { level, state, .. } = *solution;
        let ends = level.grid.ends(&self.source);
        for (edge, limited) in level.grid.edges.iter().zip(&state.limited) {
            let link = &level.grid.links[edge.link];
            let conducted = match output {
                LOSS => state.pressure[link.a][0] - state.pressure[link.b][0],
                _ => link.outward(ends, state.pressed(edge.link, link)),
            };
            let conducted = edge.outward * state.conductance[edge.link] * conducted;
            for (side, factor) in edge.places().into_iter().zip(edge.factors(*limited)) {
                let slope = state.pressure[side][1];
                if slope > 0.0 {
                    weigh(side, factor * conducted / slope);
                }
            }
        }
    }

    /// Derivative of an output by the pressure of a cell, as part of its load, m².
    fn weight(&self, solution: &Solution, output: usize, at: usize) -> f64 {
        let Solution { level, state, .. } = *solution;
        let cell = &level.grid.cells[at];
        let [cos, sin] = cell.mean_normal;
        let part = match output {
            FORCE => -cos,
            1 => -sin,
            MOMENT => cell.z * sin,
            3 => -cell.z * cos,
            TORQUE => state.pin_slope[at][0],
            LOSS | SIDE_FLOW => 0.0,
            _ => level.shapes[2].value(at / level.grid.across, at, output - SHAPE_FORCE),
        };
        cell.area * part
    }

    /// Torque of the shear in a cell for `ϑ e^(α p) = 1`, N m.
    fn shear(&self, solution: &Solution, cell: usize) -> f64 {
        let Solution {
            level, state, x, ..
        } = *solution;
        let speed = self.source.radius * self.source.radius * x[SPIN];
        x[VISCOSITY] * speed * level.grid.cells[cell].area * state.shear[cell].value
    }

    /// Adds the derivatives by the pressures of openings and ends at fixed pressure in the film.
    fn direct<const N: usize>(
        &self,
        solution: &Solution,
        group: &Group<N>,
        adjoint: &[[f64; N]],
        slopes: &mut [[f64; N]],
    ) {
        let Solution { level, state, .. } = *solution;
        let count = level.grid.cells.len();
        let openings = self.source.openings.len();
        for (at, opening) in self.source.openings.iter().enumerate() {
            if opening.feed == Feed::Pressure {
                add(&mut slopes[SUPPLY + at], 1.0, &adjoint[count + at]);
            }
        }
        add(&mut slopes[END_PRESSURE], 1.0, &adjoint[count + openings]);
        for (at, cell) in level.grid.cells.iter().enumerate() {
            let Some(opening) = cell
                .held
                .filter(|opening| self.source.openings[*opening].feed == Feed::Pressure)
            else {
                continue;
            };
            let slope = &mut slopes[SUPPLY + opening];
            add(slope, 1.0, &adjoint[at]);
            let slope_by_q = state.pressure[at][1];
            let thicker = self.thickening(slope_by_q);
            add(slope, self.shear(solution, at) * thicker, &group.rubbing);
        }
    }

    /// Whether the row of a cell is an equation of the film, and not a fixed number.
    fn is_equation(&self, solution: &Solution, cell: usize) -> bool {
        let Solution { level, state, .. } = *solution;
        let conserving = self.source.cavitation == Cavitation::MassConserving;
        level.grid.cells[cell].held.is_none() && (conserving || state.full[cell])
    }

    /// Replaces the derivatives by pressure in `adjoint` by λ; 0 at fixed places.
    fn solve_adjoint<const N: usize>(
        &self,
        solution: &Solution,
        group: &Group<N>,
        adjoint: &mut [[f64; N]],
        columns: &mut [[f64; N]],
    ) {
        let Solution { level, state, .. } = *solution;
        let count = level.grid.cells.len();
        for (at, own) in adjoint[..count].iter_mut().enumerate() {
            if !self.is_equation(solution, at) {
                *own = [0.0; N];
                continue;
            }
            let slope = state.pressure[at][1];
            let shear = self.shear(solution, at);
            let (by_pressure, by_shear) = if state.full[at] {
                (slope, shear * self.thickening(slope) * slope)
            } else {
                (0.0, shear)
            };
            *own = own.map(|weight| by_pressure * weight);
            add(own, by_shear, &group.rubbing);
        }
        adjoint[count..].fill([0.0; N]);
        state
            .matrix
            .solve_transposed(&mut adjoint[..count], columns);
        for (at, own) in adjoint[..count].iter_mut().enumerate() {
            if !self.is_equation(solution, at) {
                *own = [0.0; N];
            }
        }
    }

    /// Adds the changes by the gap at the links, ω, μ and the fixed pressures.
    fn sum_links<const N: usize>(
        &self,
        solution: &Solution,
        group: &Group<N>,
        adjoint: &[[f64; N]],
        slopes: &mut [[f64; N]],
    ) {
        let Solution {
            level, state, x, ..
        } = *solution;
        let count = level.grid.cells.len();
        let openings = self.source.openings.len();
        let first = SUPPLY + openings;
        let turning = !self.source.pin_profile.is_empty();
        let opened = !level.grid.feedings.is_empty();
        let (mut by_spin, mut by_viscosity) = ([0.0; N], [0.0; N]);
        // sums of a run of links at one angle: by the gap, and by the gap times z
        let (mut normal, mut run) = ([0.0; 2], [[0.0; N]; 2]);
        let (shapes, waves) = (self.source.shapes.len(), &level.shapes[0]);
        let mut shaped = [[0.0; N]; DEGREES];
        let mut ends = waves.runs().map(|places| places.end).enumerate();
        let mut end = ends.next();
        for (at, (link, site)) in level.grid.links.iter().zip(&level.grid.sites).enumerate() {
            if site.normal != normal {
                add_run(slopes, [ECCENTRICITY, TILT], normal, &mut run);
                normal = site.normal;
            }
            let mut drop = adjoint[link.a];
            add(&mut drop, -1.0, &adjoint[link.b]);
            let gap = state.link_gap[at];
            let upwind = if x[SPIN] * link.carry * gap >= 0.0 {
                link.a
            } else {
                link.b
            };
            let carried = link.carry * state.content[upwind];
            let pressed =
                state.conductance[at] * (state.q[link.a] - state.q[link.b] + state.bent[at][0]);
            let p_drop = state.pressure[link.a][0] - state.pressure[link.b][0];
            let slope = state.carried_slope[0][at];
            let [opens, thins] = state.conductance_slope[at];
            let flow = slope * x[SPIN] * carried + opens * pressed;
            let mut by_gap = group
                .torque
                .map(|torque| -slope * link.carry * p_drop * torque);
            let flowing = state.pressed(at, link);
            let by_flow = group.by_flow(p_drop, link.outward(count + openings, flowing));
            add(&mut by_gap, opens * flowing, &by_flow);
            add(&mut by_spin, thins * flowing, &by_flow);
            add(&mut by_viscosity, -flowing, &by_flow);
            add(&mut by_gap, -flow, &drop);
            add(&mut run[0], 1.0, &by_gap);
            add(&mut run[1], site.z, &by_gap);
            add(&mut by_spin, -carried * gap - thins * pressed, &drop);
            add(&mut by_viscosity, pressed, &drop);
            if opened {
                let opens = state.opens_by_turn(at);
                add(&mut slopes[TURN], opens * flowing, &by_flow);
                add(&mut slopes[TURN], -opens * pressed, &drop);
            }
            if turning {
                add(&mut slopes[TURN], state.link_turn[at], &by_gap);
            }
            for (side, sign) in [(link.a, 1.0), (link.b, -1.0)] {
                let Some(fixed) = side.checked_sub(count) else {
                    continue;
                };
                if let Some(place) = self.pressure_input(fixed) {
                    // dq/dp of the fixed place
                    let transform = 1.0 / state.pressure[side][1].max(1.0);
                    let by_pressure = -sign * state.conductance[at] * transform;
                    add(&mut slopes[place], by_pressure, &drop);
                }
            }
            let Some((angle, last)) = end else { continue };
            waves.gather(at, &by_gap, &mut shaped);
            if at + 1 == last {
                waves.spread(angle, &mut shaped, &mut slopes[first..first + shapes]);
                end = ends.next();
            }
        }
        add_run(slopes, [ECCENTRICITY, TILT], normal, &mut run);
        for (edge, limited) in level.grid.edges.iter().zip(&state.limited) {
            let [_, _, fixed] = edge.factors(*limited);
            if let Some(place) = self.pressure_input(edge.fixed - count) {
                let by_pressure = -fixed * state.conductance[edge.link];
                let transform = 1.0 / state.pressure[edge.fixed][1].max(1.0);
                add(
                    &mut slopes[place],
                    by_pressure * transform,
                    &adjoint[edge.cells[0]],
                );
            }
        }
        add(&mut slopes[SPIN], 1.0, &by_spin);
        add(&mut slopes[VISCOSITY], 1.0 / x[VISCOSITY], &by_viscosity);
    }

    /// The input that holds the pressure of a fixed place, of those that have one.
    fn pressure_input(&self, fixed: usize) -> Option<usize> {
        match self.source.openings.get(fixed) {
            None => Some(END_PRESSURE),
            Some(opening) => (opening.feed == Feed::Pressure).then_some(SUPPLY + fixed),
        }
    }

    /// Adds the changes by the gap and its rate in the cells, ω and μ.
    fn sum_cells<const N: usize>(
        &self,
        solution: &Solution,
        group: &Group<N>,
        adjoint: &[[f64; N]],
        slopes: &mut [[f64; N]],
    ) {
        let Solution {
            level,
            state,
            x,
            past,
        } = *solution;
        let shapes = self.source.shapes.len();
        let first = SUPPLY + self.source.openings.len();
        let speed = self.source.radius * self.source.radius;
        let turning = !self.source.pin_profile.is_empty();
        // of the torque alone: shear of μ = ω = 1
        let mut sheared = [0.0; 2];
        let (rough, boundary) = (self.surfaces.is_rough(), self.boundary(x[SPIN]));
        let mut shaped = [[[0.0; N]; DEGREES]; 2];
        for (column, cells) in level.grid.cells.chunks(level.grid.across).enumerate() {
            // sums by the gap, by the rate, and by both times z
            let (mut gaps, mut rates) = ([[0.0; N]; 2], [[0.0; N]; 2]);
            for (row, cell) in cells.iter().enumerate() {
                let at = column * level.grid.across + row;
                let content = state.content[at];
                let [by_own_rate, rate_by_gap] = state.rate_slope[at];
                let by_rate = adjoint[at].map(|number| -number * cell.area * content * by_own_rate);
                let (shear, area) = (&state.shear[at], self.shear_factor(state, at) * cell.area);
                let over = speed * area * shear.value;
                sheared[0] += over;
                sheared[1] += over + x[SPIN] * speed * area * shear.by_spin;
                let thinner = x[VISCOSITY] * x[SPIN] * speed * area * shear.by_gap;
                let mut by_gap = group.rubbing.map(|rubbing| thinner * rubbing);
                add(
                    &mut by_gap,
                    -rate_by_gap * cell.area * content,
                    &adjoint[at],
                );
                if let Some((step, before)) = past {
                    let filled = cell.area * (content - before[at]) / step;
                    add(
                        &mut by_gap,
                        -filled * state.carried_slope[1][at],
                        &adjoint[at],
                    );
                }
                if rough {
                    let [touch, slope] = state.touching[at];
                    // asperities over an opening of the pin do not touch
                    let by_turn = match state.covered[at] {
                        [_, 0.0] => 0.0,
                        [covered, slope] => -touch * slope / (1.0 - covered),
                    };
                    for (lane, output) in group.outputs.iter().enumerate() {
                        if let Some(output) = *output {
                            let weight = self.weight(solution, output, at);
                            by_gap[lane] += slope * weight;
                            slopes[TURN][lane] += by_turn * weight;
                        }
                    }
                    let load = touch * cell.area;
                    let by_turn = boundary[0] * by_turn * cell.area;
                    add(&mut slopes[TURN], by_turn, &group.rubbing);
                    add(&mut by_gap, boundary[0] * slope * cell.area, &group.rubbing);
                    add(&mut slopes[SPIN], boundary[1] * load, &group.rubbing);
                    add(&mut slopes[SPIN], boundary[0] * load, &group.loss);
                }
                add(&mut gaps[0], 1.0, &by_gap);
                add(&mut gaps[1], cell.z, &by_gap);
                add(&mut rates[0], 1.0, &by_rate);
                add(&mut rates[1], cell.z, &by_rate);
                if turning {
                    let [slope, turned_slope] = state.pin_slope[at];
                    let pressure = state.pressure[at][0] + state.touching[at][0];
                    let turned = cell.area * pressure * turned_slope;
                    add(&mut slopes[SPIN], -slope, &by_rate);
                    add(&mut slopes[TURN], turned, &group.torque);
                    add(&mut slopes[TURN], state.cell_turn[at], &by_gap);
                    add(&mut slopes[TURN], -x[SPIN] * turned_slope, &by_rate);
                }
                if shapes > 0 {
                    level.shapes[1].gather(at, &by_gap, &mut shaped[0]);
                    level.shapes[2].gather(at, &by_rate, &mut shaped[1]);
                }
            }
            if shapes > 0 {
                let (by_amplitudes, by_rates) =
                    slopes[first..first + 2 * shapes].split_at_mut(shapes);
                level.shapes[1].spread(column, &mut shaped[0], by_amplitudes);
                level.shapes[2].spread(column, &mut shaped[1], by_rates);
            }
            let angle = &cells[0];
            add_run(slopes, [ECCENTRICITY, TILT], angle.normal, &mut gaps);
            add_run(slopes, [RATE, TILT_RATE], angle.mean_normal, &mut rates);
        }
        // the loss is the torque of the shear times ω, so ω acts twice
        add(&mut slopes[SPIN], x[VISCOSITY] * sheared[1], &group.rubbing);
        add(
            &mut slopes[SPIN],
            x[VISCOSITY] * x[SPIN] * sheared[0],
            &group.loss,
        );
        add(&mut slopes[VISCOSITY], x[SPIN] * sheared[0], &group.rubbing);
    }
}

/// Adds the sums of places at one angle, and those times z, to the derivatives by the components of two
/// vectors of the pin, and empties them. A motion of the pin along n closes the gap.
fn add_run<const N: usize>(
    slopes: &mut [[f64; N]],
    places: [usize; 2],
    normal: [f64; 2],
    sums: &mut [[f64; N]; 2],
) {
    for (place, sums) in places.into_iter().zip(sums) {
        for (component, normal) in normal.into_iter().enumerate() {
            add(&mut slopes[place + component], -normal, sums);
        }
        *sums = [0.0; N];
    }
}
