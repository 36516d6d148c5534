//! The equations of a prescribed motion, and the states that fulfil them.

use crate::assembled::Assembled;
use crate::assembly::at;
use crate::assembly::rows::{Along, Preference, Rows, pins};
use crate::dynamics::Dynamics;
use crate::elements::Inputs;
use crate::error::{Moment, RuntimeError};
use crate::loose::{Loose, of_motions};
use crate::model::Model;
use crate::outputs::{Outputs, Watch};
use crate::singular::decompose;
use crate::start::picking::{free_of, unit_rows};
use crate::state::{State, move_pose};
use eng_system::code::Compiled;
use eng_system::dense::largest_scaled;
use eng_system::significant::short;
use eng_system::system::Origin;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Share of the largest singular value of unit rows at which the equations are singular. A choice: reactions
/// of a mechanism nearer to a singular position are 1e8 times the loads and have half of their digits.
const SINGULAR: f64 = 1e-8;
/// Part of a unit row that earlier equations leave, above which it takes part. A choice between rounding and
/// rows that differ on purpose, as for quasi-static starts.
const HOLDS: f64 = 1e-6;
/// Length (scaled) below which a row counts as empty. Rows have a length of about one in scaled velocities,
/// so a shorter one is rounding.
const EMPTY: f64 = 1e-12;
/// Size of a scaled equation at which a position counts as reached, and that which ends the search at once.
/// The first is that of an assembly. The second is rounding.
const CLOSED: f64 = 1e-10;
const EXACT: f64 = 1e-14;
/// Factor by which a correction reduces the equations, above which their factors are made again. A choice: the
/// factors of a predicted position reduce them by 1e-5 and less.
const CONTRACTS: f64 = 1e-2;
/// Most corrections of a position. A choice: Newton's method from a prediction needs a few.
const CORRECTIONS: usize = 25;
/// Longest correction, in angles. A choice: half a radian, or half of the model's length, is far beyond the
/// error of a prediction over a step, so the position would be on another branch.
const FARTHEST: f64 = 0.5;
/// Distance of positions for differences of rates, as a share of the time in which the motion covers its
/// size. It is about the fifth root of the rounding unit: the errors of differences of fourth order, its
/// fourth power and 1e-16 over it, are both below 1e-12.
const APART: f64 = 1e-3;
/// Share of the largest rate by which the rates that the equations require may contradict each other. A choice
/// above the rounding of a solution through nearly singular equations.
const CONSISTENT: f64 = 1e-8;

/// Equations with their least-squares factors.
pub(super) struct Equations {
    /// B: equations × velocities that move, scaled.
    pub matrix: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Equations {
    fn new(matrix: DMatrix<f64>) -> Option<Equations> {
        // this product is several times faster than `tr_mul`
        let factor = (matrix.transpose() * &matrix).cholesky()?;
        Some(Equations { matrix, factor })
    }

    /// x with the least |B x − b|, with one correction of its rounding. Scaled velocities or increments, one
    /// for each column of B.
    fn least(&self, wanted: &DVector<f64>) -> DVector<f64> {
        let mut x = self.factor.solve(&self.matrix.tr_mul(wanted));
        for _ in 0..2 {
            let left = wanted - &self.matrix * &x;
            x += self.factor.solve(&self.matrix.tr_mul(&left));
        }
        x
    }

    /// The smallest μ with Bᵀ μ = f. One for each row of B, scaled.
    pub fn reactions(&self, forces: &DVector<f64>) -> DVector<f64> {
        let mut reactions = &self.matrix * self.factor.solve(forces);
        for _ in 0..2 {
            let left = forces - self.matrix.tr_mul(&reactions);
            reactions += &self.matrix * self.factor.solve(&left);
        }
        reactions
    }

    /// The part of reactions that loads nothing: μ − B (BᵀB)⁻¹ Bᵀ μ.
    pub fn idle(&self, reactions: &DVector<f64>) -> DVector<f64> {
        let mut idle = reactions.clone();
        for _ in 0..2 {
            let loads = self.matrix.tr_mul(&idle);
            idle -= &self.matrix * self.factor.solve(&loads);
        }
        idle
    }

    /// The projector I − B (BᵀB)⁻¹ Bᵀ on the reactions that load nothing.
    pub fn idle_projector(&self) -> DMatrix<f64> {
        let rows = self.matrix.nrows();
        let solved = self.factor.solve(&self.matrix.transpose());
        DMatrix::identity(rows, rows) - &self.matrix * solved
    }
}

/// The angle of the cycle and its rate.
struct Cycle {
    outputs: Outputs,
    /// Velocities that may change the rate.
    columns: Vec<usize>,
}

/// The treatment of states of elements along the motion.
pub(super) enum States {
    /// They keep their values.
    Constant,
    /// They follow the motion.
    Followed,
    /// They keep their values, and the list takes each state of the mechanism.
    Traced(Vec<State>),
}

/// A mechanism whose equations determine its motion.
pub(super) struct Mechanism {
    /// Its films exert no load.
    pub model: Model,
    /// Constraints, then four rows of each pin.
    rows: Rows,
    /// The rows of the pins alone.
    films: Rows,
    pub pins: Vec<Preference>,
    /// Number of constraint rows.
    pub constraints: usize,
    /// The rows that take part.
    pub chosen: Vec<usize>,
    /// Velocities that are not modal.
    pub columns: Vec<usize>,
    pub scales: Vec<f64>,
    pub dynamics: Dynamics,
    cycle: Option<Cycle>,
    /// Angle (rad) and time (s) at the start and the speed (rad/s), if the analysis turns the cycle.
    turned: Option<[f64; 3]>,
    watch: Watch,
    pub states: States,
    /// The equations at the state that was completed last.
    pub equations: Option<Equations>,
    /// The rates that the constraints require while nothing moves, scaled, at that state.
    pub demanded: DVector<f64>,
    /// For each equation, whether it has required a rate at any state so far: the equation of a drive.
    pub driven: Vec<bool>,
    /// The fastest motion so far, scaled.
    pub quickest: f64,
}

impl Mechanism {
    /// Assembles a model and brings it to its first state, with velocities and accelerations.
    pub fn new(
        compiled: &Compiled,
        overrides: &[Option<f64>],
    ) -> Result<(Mechanism, State), RuntimeError> {
        let assembled = Assembled::of(Model::bind(compiled, overrides)?)?;
        if assembled.model().bodies.is_empty() {
            return Err(RuntimeError::NotKinematic {
                origin: None,
                message: "a model without bodies has no motion".into(),
                remedy: "state bodies, or run a `transient`",
            });
        }
        let mut model = assembled.model().clone();
        let mut state = assembled.state().clone();
        let pins = pins(&model);
        for pin in &pins {
            model.elements[pin.element].dynamic = false;
        }
        let constraints = Rows::new(&model, model.constraining().collect());
        let cycle = match &model.compiled.system.cycle {
            Some(cycle) => Some(Cycle::new(&model, cycle.element as usize)?),
            None => None,
        };
        let mut mechanism = Mechanism {
            constraints: constraints.len(),
            rows: constraints.with(&model, &pins),
            films: Rows::new(&model, Vec::new()).with(&model, &pins),
            pins,
            chosen: Vec::new(),
            columns: (model.bodies.iter())
                .flat_map(|body| body.velocity..body.velocity + 6)
                .collect(),
            scales: model.velocity_scales(),
            dynamics: Dynamics::new(&model),
            cycle,
            turned: None,
            states: States::Constant,
            watch: Watch::new(&model, |_| true),
            equations: None,
            demanded: DVector::zeros(0),
            driven: Vec::new(),
            quickest: 0.0,
            model,
        };
        mechanism.refuse_fields()?;
        mechanism.choose(&state)?;
        if !mechanism.close(&mut state)? {
            return Err(mechanism.open(&state)?);
        }
        mechanism.unwrap(&mut state)?;
        if let Some(turned) = &mut mechanism.turned {
            // closing moves the crank by less than a film's clearance; the angle of the text remains
            turned[1] = state.time;
        }
        mechanism.complete(&mut state)?;
        Ok((mechanism, state))
    }

    /// A load on cells may remember the past of its film, and has no other element's reaction.
    fn refuse_fields(&self) -> Result<(), RuntimeError> {
        let model = &self.model;
        let mut elements = 0..model.elements.len();
        let solved = elements.find(|e| {
            model.elements[*e].dynamic && !model.compiled.system.elements[*e].fields.is_empty()
        });
        match solved {
            None => Ok(()),
            Some(element) => Err(self.refused(
                Some(super::origin_of(model, element)),
                format!(
                    "{}: its load is solved on cells, and no pin in the middle of a shell replaces it",
                    model.compiled.system.elements[element].origin.path
                ),
                "hold the body by a joint in place of this film, or run a `transient`",
            )),
        }
    }

    /// Element, row within it, and place among all rows, of each constraint row.
    pub fn constraint_rows(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        let owners = self.rows.owners.iter().enumerate();
        owners.map(|(row, (element, local))| (*element, *local, row))
    }

    /// The element of a constraint row.
    pub fn owner_of(&self, row: usize) -> usize {
        self.rows.owners[row].0
    }

    /// The scale of a row.
    pub fn scale(&self, row: usize) -> f64 {
        self.rows.scales[row]
    }

    /// Whether the analysis itself turns the cycle.
    pub fn is_turned(&self) -> bool {
        self.turned.is_some()
    }

    /// Elements whose pins are in the middle.
    pub fn centred(&self) -> Vec<Origin> {
        let pins = self.pins.iter();
        pins.map(|pin| super::origin_of(&self.model, pin.element))
            .collect()
    }

    /// Flexible bodies.
    pub fn rigid(&self) -> Vec<Origin> {
        let bodies = self.model.bodies.iter();
        bodies
            .filter(|body| body.modes() > 0)
            .map(|body| body.origin.clone())
            .collect()
    }

    /// The period of the cycle (rad).
    pub fn period(&self) -> Option<f64> {
        let cycle = self.model.compiled.system.cycle.as_ref()?;
        Some(self.model.slot(cycle.period))
    }

    /// Angle of the cycle (rad) and its rate (rad/s) at a state.
    pub fn cycle(&mut self, state: &State) -> Result<Option<[f64; 2]>, RuntimeError> {
        let Some(cycle) = &mut self.cycle else {
            return Ok(None);
        };
        cycle.at(&self.model, &mut self.dynamics, state).map(Some)
    }

    /// The error of a mechanism without a kinematic analysis. Without an origin it is at the cycle.
    pub fn refused(
        &self,
        origin: Option<Origin>,
        message: String,
        remedy: &'static str,
    ) -> RuntimeError {
        let cycle = self.model.compiled.system.cycle.as_ref();
        RuntimeError::NotKinematic {
            origin: origin
                .or_else(|| cycle.map(|cycle| cycle.origin.clone()))
                .map(Box::new),
            message,
            remedy,
        }
    }

    /// All rows and their derivatives by the velocities that move, scaled.
    fn evaluate(&self, state: &State) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let (mut values, mut matrix) = self.rows.evaluate(&self.model, &at(state), Along::Pose)?;
        self.rows.scale(&self.model, &mut values, &mut matrix);
        Ok((values, matrix.select_columns(&self.columns)))
    }

    /// The derivative of the cycle's rate by the velocities that move, scaled.
    pub fn cycle_row(&mut self, state: &State) -> Result<Option<DVector<f64>>, RuntimeError> {
        let Some(cycle) = &mut self.cycle else {
            return Ok(None);
        };
        let mut rest = state.clone();
        rest.velocity.fill(0.0);
        let still = cycle.at(&self.model, &mut self.dynamics, &rest)?[1];
        let mut row = DVector::zeros(self.columns.len());
        for (i, column) in self.columns.iter().enumerate() {
            if !cycle.columns.contains(column) {
                continue;
            }
            rest.velocity[*column] = self.scales[*column];
            row[i] = cycle.at(&self.model, &mut self.dynamics, &rest)?[1] - still;
            rest.velocity[*column] = 0.0;
        }
        Ok(Some(row))
    }

    /// Chooses the rows that take part, at the assembled state. See the head of [`super`].
    fn choose(&mut self, state: &State) -> Result<(), RuntimeError> {
        let (_, matrix) = self.evaluate(state)?;
        let middle = |row: usize| row < self.constraints || (row - self.constraints) % 4 < 2;
        let (first, axes): (Vec<usize>, Vec<usize>) = (0..matrix.nrows()).partition(|i| middle(*i));
        let mut open = open_after(matrix.select_rows(&first))?;
        self.chosen = first;
        if let Some(row) = self.cycle_row(state)? {
            let mut row = DMatrix::from_rows(&[row.transpose()]);
            unit_rows(&mut row, EMPTY);
            let left = &row * &open;
            if left.norm() > HOLDS {
                let Some([angle, rate]) = self.cycle(state)? else {
                    return Err(RuntimeError::NoCycle);
                };
                self.turned = Some([angle, state.time, rate]);
                open = &open * left_by(&left)?;
            }
        }
        let mut held = matrix.select_rows(&axes);
        unit_rows(&mut held, EMPTY);
        let held = held * &open;
        for (i, row) in axes.iter().enumerate() {
            if held.row(i).norm() > HOLDS {
                self.chosen.push(*row);
            }
        }
        open = &open * left_by(&held)?;
        if open.ncols() > 0 {
            return Err(self.free(state, &open));
        }
        Ok(())
    }

    /// The error for motions that the equations leave free.
    fn free(&self, state: &State, motions: &DMatrix<f64>) -> RuntimeError {
        let found = of_motions(&self.model, state, motions);
        let named: Vec<String> = found.iter().take(3).map(|one| self.named(one)).collect();
        let more = match found.len().saturating_sub(named.len()) {
            0 => String::new(),
            more => format!("; and {more} more"),
        };
        let first = found.first().and_then(|one| one.bodies.first());
        let origin = first.map(|body| self.model.bodies[*body].origin.clone());
        self.refused(
            origin,
            format!(
                "joints, drives and the turning cycle leave motions free: {}{more}",
                named.join("; ")
            ),
            "a kinematic analysis has no forces that decide a motion: hold these motions by joints or drives, or run a `transient`",
        )
    }

    /// A free motion in words.
    fn named(&self, motion: &Loose) -> String {
        let paths: Vec<&str> = (motion.bodies.iter().take(3))
            .map(|body| self.model.bodies[*body].origin.path.as_str())
            .collect();
        let with = match motion.bodies.len() {
            0..=1 => String::new(),
            n if n > 3 => format!(" with {} and {} more", paths[1..].join(", "), n - 3),
            _ => format!(" with {}", paths[1..].join(" and ")),
        };
        let name = paths.first().copied().unwrap_or_default();
        let shown = |axis: &crate::rotation::V3| {
            let rounded = axis.iter().map(|x| libm::round(x * 1e3) / 1e3 + 0.0);
            let parts: Vec<String> = rounded.map(|x| short(x, 2)).collect();
            format!("[{}]", parts.join(", "))
        };
        match (&motion.along, &motion.about) {
            (Some(axis), _) => format!("{name}{with} moves along {}", shown(axis)),
            (_, Some((axis, _))) => format!("{name}{with} turns about {}", shown(axis)),
            _ => format!("{name}{with} has {} free motions", motion.motions),
        }
    }

    /// The equations that take part: values and derivatives.
    fn equations(&mut self, state: &State) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let (values, matrix) = self.evaluate(state)?;
        let values = values.select_rows(&self.chosen);
        let matrix = matrix.select_rows(&self.chosen);
        let Some([first, begun, speed]) = self.turned else {
            return Ok((values, matrix));
        };
        let (Some([angle, _]), Some(row)) = (self.cycle(state)?, self.cycle_row(state)?) else {
            return Err(RuntimeError::NoCycle);
        };
        let count = values.len();
        let mut matrix = matrix.insert_row(count, 0.0);
        matrix.row_mut(count).copy_from(&row.transpose());
        let off = angle - first - speed * (state.time - begun);
        Ok((values.push(off), matrix))
    }

    /// Brings a position onto the equations. Returns whether they close.
    pub(super) fn close(&mut self, state: &mut State) -> Result<bool, RuntimeError> {
        let mut last = f64::INFINITY;
        // near the position the factors of an earlier round serve
        let mut kept: Option<Equations> = None;
        for _ in 0..CORRECTIONS {
            let (values, matrix) = self.equations(state)?;
            let size = values.amax();
            if size <= EXACT || (size <= CLOSED && size > 0.5 * last) {
                return Ok(true);
            }
            let equations = match kept.take() {
                Some(equations) if size < CONTRACTS * last => equations,
                _ => match Equations::new(matrix) {
                    Some(equations) => equations,
                    None => return Ok(false),
                },
            };
            last = size;
            let step = equations.least(&values);
            if step.iter().any(|x| !x.is_finite()) || step.amax() > FARTHEST {
                return Ok(false);
            }
            let mut increment = vec![0.0; self.model.velocities];
            for (x, column) in step.iter().zip(&self.columns) {
                increment[*column] = -x * self.scales[*column];
            }
            let pose = state.pose.clone();
            move_pose(&self.model, &pose, &increment, 1.0, &mut state.pose);
            kept = Some(equations);
        }
        Ok(last <= CLOSED)
    }

    /// The error for a first position that does not close.
    fn open(&mut self, state: &State) -> Result<RuntimeError, RuntimeError> {
        let (values, _) = self.equations(state)?;
        let worst = values.iamax();
        let row = self.chosen.get(worst).copied().unwrap_or(0);
        if row >= self.constraints
            && let Some(pin) = self.pins.get((row - self.constraints) / 4)
        {
            return Ok(self.refused(
                Some(super::origin_of(&self.model, pin.element)),
                format!(
                    "not all pins can be in the middle of their shells at once: that of {} is off by {} mm",
                    super::origin_of(&self.model, pin.element).path,
                    short(1e3 * (values[worst] * self.rows.scales[row]).abs(), 3)
                ),
                "a kinematic analysis centres every pin: check the places of the markers, or hold one of the shells by fewer joints",
            ));
        }
        let model = &self.model;
        let rows = self.rows.owners.get(row);
        Ok(RuntimeError::OpenLoop {
            rows: (rows.iter())
                .map(|(element, local)| {
                    model.named_row(*element, *local, values[worst] * self.rows.scales[row])
                })
                .collect(),
            chain: None,
        })
    }

    pub(super) fn unwrap(&mut self, state: &mut State) -> Result<(), RuntimeError> {
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        let inputs = Inputs {
            multipliers: &[],
            rotations: &state.rotations,
            memory: None,
            ..self.dynamics.inputs_at(state)
        };
        let mut rotations = state.rotations.clone();
        self.watch.unwrap(&self.model, &inputs, &mut rotations)?;
        state.rotations = rotations;
        Ok(())
    }

    /// Velocities and accelerations at a position on the equations.
    pub fn complete(&mut self, state: &mut State) -> Result<(), RuntimeError> {
        let (_, matrix) = self.equations(state)?;
        let Some(equations) = Equations::new(matrix) else {
            return Err(self.singular(state)?);
        };
        if self.is_singular(&equations) {
            return Err(self.singular(state)?);
        }
        let count = self.chosen.len();
        let mut rest = state.clone();
        rest.velocity.fill(0.0);
        let demanded = self.rows.rates(&self.model, &at(&rest))?;
        let scaled = |value: f64, row: usize| value / self.rows.scales[row];
        let own = DVector::from_fn(count, |i, _| {
            let row = self.chosen[i];
            scaled(demanded[row], row)
        });
        let mut wanted = -&own;
        if let Some([_, _, speed]) = self.turned {
            let still = self.cycle(&rest)?.map_or(0.0, |cycle| cycle[1]);
            wanted = wanted.push(speed - still);
        }
        self.driven.resize(count, false);
        for (driven, rate) in self.driven.iter_mut().zip(own.iter()) {
            *driven |= *rate != 0.0;
        }
        self.demanded = own;
        let y = equations.least(&wanted);
        let missed = (&equations.matrix * &y - &wanted).amax();
        if missed > CONSISTENT * wanted.amax().max(y.amax()) {
            return Err(self.refused(
                None,
                "the speeds that drives and the cycle state contradict each other".into(),
                "state the speed of one of them",
            ));
        }
        state.velocity.fill(0.0);
        for (x, column) in y.iter().zip(&self.columns) {
            state.velocity[*column] = x * self.scales[*column];
        }
        let gammas = self.second(state)?;
        let z = equations.least(&gammas);
        state.acceleration.fill(0.0);
        for (x, column) in z.iter().zip(&self.columns) {
            state.acceleration[*column] = x * self.scales[*column];
        }
        self.equations = Some(equations);
        Ok(())
    }

    /// γ of `B v̇ = γ`, scaled: exact for constraints; for pins and the cycle, whose rows depend on positions
    /// alone, minus the change of their rates along the motion, by differences of fourth order.
    fn second(&mut self, state: &State) -> Result<DVector<f64>, RuntimeError> {
        self.dynamics.set_state(&self.model, state, &[]);
        self.dynamics.constraint_gradients(&self.model)?;
        self.dynamics.velocity_level(&self.model, &state.velocity)?;
        let gamma = self.dynamics.constraint_accelerations().to_vec();
        let motion_rate = largest_scaled(&state.velocity, &self.scales);
        let turned = self.turned.is_some();
        let films = 4 * self.pins.len();
        let mut slopes = vec![0.0; films + 1];
        if motion_rate > 0.0 && (films > 0 || turned) {
            let h = APART / motion_rate;
            let mut near = state.clone();
            // f' = (f₋₂ − 8 f₋₁ + 8 f₁ − f₂)/12h
            for (away, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
                near.time = state.time + away * h;
                move_pose(
                    &self.model,
                    &state.pose,
                    &state.velocity,
                    away * h,
                    &mut near.pose,
                );
                let (_, matrix) = self.films.evaluate(&self.model, &at(&near), Along::Pose)?;
                let rates = matrix * DVector::from_column_slice(&state.velocity);
                for (i, rate) in rates.iter().enumerate() {
                    slopes[i] += weight * rate / (12.0 * h);
                }
                if turned && let Some([_, rate]) = self.cycle(&near)? {
                    slopes[films] += weight * rate / (12.0 * h);
                }
            }
        }
        let mut out: Vec<f64> = (self.chosen.iter())
            .map(|row| {
                let value = match row.checked_sub(self.constraints) {
                    Some(film) => -slopes[film],
                    None => {
                        let (element, local) = self.rows.owners[*row];
                        gamma[self.model.elements[element].row + local]
                    }
                };
                value / self.rows.scales[*row]
            })
            .collect();
        if turned {
            out.push(-slopes[films]);
        }
        Ok(DVector::from_vec(out))
    }

    /// Whether the equations leave a motion free here.
    fn is_singular(&self, equations: &Equations) -> bool {
        let factor = equations.factor.l_dirty();
        let pivots = || (0..factor.nrows()).map(|i| factor[(i, i)].abs());
        let (least, most) = (
            pivots().fold(f64::INFINITY, f64::min),
            pivots().fold(0.0, f64::max),
        );
        // a small pivot of the squares may be rounding, so singular values decide
        // pivots of squares: their rounding is 1e-8 of the largest, and a ratio of 1e-4 has singular values
        // about as far apart
        least < 1e-4 * most
            && decompose(equations.matrix.clone())
                .is_none_or(|svd| svd.singular_values.min() <= SINGULAR * svd.singular_values.max())
    }

    /// The error for a position at which the equations leave a motion free.
    fn singular(&mut self, state: &State) -> Result<RuntimeError, RuntimeError> {
        let (_, matrix) = self.equations(state)?;
        let open = open_after(matrix)?;
        let found = of_motions(&self.model, state, &open);
        let named: Vec<String> = found.iter().take(2).map(|one| self.named(one)).collect();
        let moment = self.moment(state)?;
        let first = found.first().and_then(|one| one.bodies.first());
        let origin = first.map(|body| self.model.bodies[*body].origin.clone());
        Ok(self.refused(
            origin,
            format!(
                "at {moment} the mechanism can continue in several ways: {}",
                match named.is_empty() {
                    true => "its equations depend on each other there".to_owned(),
                    false => named.join("; "),
                }
            ),
            "a dead centre of the driven body: begin a few degrees away, end the range before it, or drive another body",
        ))
    }

    /// Time and angle of a state.
    pub fn moment(&mut self, state: &State) -> Result<Moment, RuntimeError> {
        Ok(Moment {
            time: state.time,
            cycle_angle: self.cycle(state)?.map(|cycle| cycle[0]),
        })
    }
}

impl Cycle {
    fn new(model: &Model, element: usize) -> Result<Cycle, RuntimeError> {
        let outputs = Outputs::watching(model, element)?;
        let bodies: Vec<usize> = (outputs.markers().iter())
            .filter_map(|marker| model.markers[*marker].body)
            .collect();
        let columns = (model.bodies.iter().enumerate())
            .filter(|(index, _)| bodies.contains(index))
            .flat_map(|(_, body)| body.velocity..body.velocity + 6)
            .collect();
        Ok(Cycle { outputs, columns })
    }

    /// Angle (rad) and rate (rad/s) at a state.
    fn at(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        state: &State,
    ) -> Result<[f64; 2], RuntimeError> {
        dynamics.place(model, state.time, &state.pose, &state.velocity);
        self.outputs.evaluate(model, dynamics, state)?;
        Ok(self.outputs.watched_values)
    }
}

/// An orthonormal basis of the directions that rows leave open.
fn open_after(mut rows: DMatrix<f64>) -> Result<DMatrix<f64>, RuntimeError> {
    unit_rows(&mut rows, EMPTY);
    left_by(&rows)
}

/// [`open_after`] of parts of unit rows. A small part is rounding, so it is not scaled.
fn left_by(rows: &DMatrix<f64>) -> Result<DMatrix<f64>, RuntimeError> {
    free_of(rows).ok_or_else(|| RuntimeError::Malformed {
        what: "derivatives of constraints are not finite".into(),
    })
}
