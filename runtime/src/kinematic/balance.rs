//! Reactions by inverse dynamics, the channels that contain them, and the reactions that equations share.

use super::mechanism::Mechanism;
use crate::assembly::closing::Numbers;
use crate::error::{Moment, RuntimeError};
use crate::outputs::{Outputs, Watch};
use crate::simulation::{FAILS, Warning};
use crate::state::State;
use eng_system::recorded::channels_of_motion;
use eng_system::system::{ConditionKind, Origin, Role};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;

/// Entry of the projector on idle reactions below which a reaction has no part in them. A choice: rounding is
/// far below, and a real part, such as one of two equal joints, far above.
const IDLE: f64 = 1e-6;
/// Share of a channel's answer to all reactions that idle ones may have. A choice, as for [`IDLE`].
const ANSWERS: f64 = 1e-6;
/// Rounding of a channel, as a share of its value and of the answers beside it. A choice: reactions are
/// solutions with twelve digits or more.
const ROUNDING: f64 = 1e-10;
/// Share of the largest effect of an equation on the rate of the cycle below which a drive does not turn it.
/// A choice above the rounding of a solution.
const TURNS: f64 = 1e-9;
/// Seed of the reactions with which channels are tried. Any number serves; it is fixed so that each run gives
/// the same result.
const SEED: u64 = 23;

/// Elements whose reactions hold the same motions, so that the balance does not divide a load between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// The elements, in the order of the text.
    pub elements: Vec<Origin>,
}

/// The reactions of a state.
pub(super) struct Balanced {
    /// Torque on the cycle (N m), positive in the sense of its angle; `None` without a cycle.
    pub torque: Option<f64>,
    /// Values of all channels; NaN for those that are not recorded.
    pub channels: Vec<f64>,
}

/// What examined states tell about the reactions.
pub(super) struct Examined {
    /// Whether a channel contains shared reactions.
    unknown: Vec<bool>,
    /// For each equation, whether its reaction is shared.
    idle: Vec<bool>,
    /// Pairs of elements that share reactions.
    pairs: BTreeSet<(usize, usize)>,
}

/// Solves the balance and evaluates outputs.
pub(super) struct Balance {
    outputs: Outputs,
    /// Channels that may be recorded.
    channels: Vec<usize>,
    /// For each journal with a force: its channels along x and y of the shell, and its place among the pins.
    forces: Vec<(usize, usize)>,
    watch: Watch,
    advised: BTreeSet<(usize, usize)>,
    warnings: Vec<Warning>,
}

impl Balance {
    pub fn new(mechanism: &Mechanism) -> Result<Balance, RuntimeError> {
        let model = &mechanism.model;
        let system = &model.compiled.system;
        let channels = channels_of_motion(system);
        let place = |element: u32| {
            let mut pins = mechanism.pins.iter();
            pins.position(|pin| pin.element == element as usize)
        };
        let forces: Vec<(usize, usize)> = (system.journals.iter())
            .filter_map(|journal| Some((journal.force as usize, place(journal.element)?)))
            .collect();
        let is_force = |channel: usize| {
            (forces.iter()).any(|(force, _)| channel == *force || channel == *force + 1)
        };
        let elements = channels.iter().filter(|channel| !is_force(**channel));
        let elements = elements.map(|channel| system.channels[*channel].element as usize);
        let roles: Vec<Role> = system.elements.iter().map(|e| e.role).collect();
        let films: Vec<usize> = mechanism.pins.iter().map(|pin| pin.element).collect();
        Ok(Balance {
            outputs: Outputs::of_elements(model, elements)?,
            watch: Watch::new(model, |e| {
                matches!(roles[e], Role::Dynamic | Role::Output) && !films.contains(&e)
            }),
            channels,
            forces,
            advised: BTreeSet::new(),
            warnings: Vec::new(),
        })
    }

    /// Failed `advise`s since the last call, each once.
    pub fn take_warnings(&mut self) -> Vec<Warning> {
        std::mem::take(&mut self.warnings)
    }

    /// Reactions, torque and channels at a completed state, which takes the multipliers.
    pub fn balance(
        &mut self,
        mechanism: &mut Mechanism,
        state: &mut State,
    ) -> Result<Balanced, RuntimeError> {
        let moment = mechanism.moment(state)?;
        let reactions = reactions(mechanism, state)?;
        set_multipliers(mechanism, &reactions, state);
        state.rates.copy_from_slice(mechanism.dynamics.rates());
        self.conditions(mechanism, state, moment)?;
        let cycle = mechanism.cycle(state)?;
        let torque = match cycle {
            Some(_) => Some(torque(mechanism, &reactions, state)?),
            None => None,
        };
        let channels = self.values(mechanism, &reactions, state)?;
        Ok(Balanced { torque, channels })
    }

    /// Values of the channels with given reactions.
    fn values(
        &mut self,
        mechanism: &mut Mechanism,
        reactions: &DVector<f64>,
        state: &State,
    ) -> Result<Vec<f64>, RuntimeError> {
        let (model, dynamics) = (&mechanism.model, &mut mechanism.dynamics);
        dynamics.place(model, state.time, &state.pose, &state.velocity);
        self.outputs.evaluate(model, dynamics, state)?;
        let mut values = self.outputs.values.clone();
        for (force, pin) in &self.forces {
            for i in 0..2 {
                let row = mechanism.constraints + 4 * pin + i;
                // the gradient of the eccentricity is along x or y of the shell, and the force on the pin
                // opposes it
                values[force + i] = -mechanism.reaction(reactions, row);
            }
        }
        Ok(values)
    }

    /// Refuses a failed `require`, and notes a failed `advise`.
    fn conditions(
        &mut self,
        mechanism: &mut Mechanism,
        state: &State,
        moment: Moment,
    ) -> Result<(), RuntimeError> {
        let (model, dynamics) = (&mechanism.model, &mut mechanism.dynamics);
        dynamics.set_state(model, state, &state.multipliers);
        let (advised, warnings) = (&mut self.advised, &mut self.warnings);
        let mut failed = None;
        self.watch.violations(
            model,
            &dynamics.inputs_at(state),
            dynamics.batches(),
            |kind| matches!(kind, ConditionKind::Require | ConditionKind::Advise),
            |violation, values| {
                let condition = &model.class(violation.element).conditions[violation.condition];
                let element = super::origin_of(model, violation.element);
                let origin = Origin {
                    defined_at: condition.defined_at.or(element.defined_at),
                    ..element
                };
                if condition.kind == ConditionKind::Advise {
                    if advised.insert((violation.element, violation.condition)) {
                        warnings.push(Warning {
                            name: condition.name.clone(),
                            origin,
                            message: condition.message_with(values),
                            label: FAILS,
                            moment,
                        });
                    }
                } else if failed.is_none() {
                    failed = Some(RuntimeError::Require {
                        origin: Box::new(origin),
                        message: condition.message_with(values),
                        moment,
                        value: violation.value,
                        dimension: condition.dimension,
                    });
                }
            },
        )?;
        match failed {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }

    /// Nothing examined yet.
    pub fn examination(&self, mechanism: &Mechanism) -> Examined {
        Examined {
            unknown: vec![false; mechanism.model.compiled.system.channels.len()],
            idle: vec![false; mechanism.chosen.len()],
            pairs: BTreeSet::new(),
        }
    }

    /// Examines the reactions of a state. A channel contains shared reactions if it changes with those that
    /// load nothing.
    pub fn examine(
        &mut self,
        mechanism: &mut Mechanism,
        state: &mut State,
        examined: &mut Examined,
    ) -> Result<(), RuntimeError> {
        let found = reactions(mechanism, state)?;
        let Some(equations) = &mechanism.equations else {
            return Ok(());
        };
        let projector = equations.idle_projector();
        let idle: Vec<usize> = (0..mechanism.chosen.len())
            .filter(|i| projector[(*i, *i)] > IDLE)
            .collect();
        if idle.is_empty() {
            return Ok(());
        }
        for i in &idle {
            examined.idle[*i] = true;
        }
        pair(mechanism, &projector, &idle, &mut examined.pairs);
        for channel in self.dependent(mechanism, &found, state)? {
            examined.unknown[channel] = true;
        }
        Ok(())
    }

    /// Refuses a sample at which a recorded channel contains a shared reaction, though it did not at the
    /// examined moments: an output behind a condition.
    pub fn refuse_shared(
        &mut self,
        mechanism: &mut Mechanism,
        state: &mut State,
        recorded: &[usize],
    ) -> Result<(), RuntimeError> {
        let moment = mechanism.moment(state)?;
        let found = reactions(mechanism, state)?;
        let dependent = self.dependent(mechanism, &found, state)?;
        set_multipliers(mechanism, &found, state);
        let Some(channel) = dependent.iter().find(|channel| recorded.contains(channel)) else {
            return Ok(());
        };
        let channel = &mechanism.model.compiled.system.channels[*channel];
        Err(mechanism.refused(
            Some(super::origin_of(&mechanism.model, channel.element as usize)),
            format!(
                "{} contains a shared reaction at {moment}, though not at other moments",
                channel.path
            ),
            "leave this output out: a kinematic analysis does not divide a load between joints that hold the same motion",
        ))
    }

    /// Channels that change with reactions that load nothing, at a state with the reactions `found`.
    fn dependent(
        &mut self,
        mechanism: &mut Mechanism,
        found: &DVector<f64>,
        state: &mut State,
    ) -> Result<Vec<usize>, RuntimeError> {
        let Some(equations) = &mechanism.equations else {
            return Ok(Vec::new());
        };
        let mut numbers = Numbers::new(SEED);
        let size = found
            .amax()
            .max(mechanism.model.mass * mechanism.model.length);
        // between one and two sizes: no reaction is zero, and no sum of them is by chance
        let any = DVector::from_fn(found.len(), |_, _| size * (1.5 + 0.5 * numbers.draw()));
        let unloading = equations.idle(&any);
        let mut try_with = |reactions: &DVector<f64>, balance: &mut Balance| {
            set_multipliers(mechanism, reactions, state);
            balance.values(mechanism, reactions, state)
        };
        let plain = try_with(found, self)?;
        let changed = try_with(&(found + unloading), self)?;
        let moved = try_with(&(found + any), self)?;
        let system = &mechanism.model.compiled.system;
        let answer = |c: usize| (moved[c] - plain[c]).abs();
        // the largest answer of the same element and dimension: a component beside others is zero to their
        // rounding
        let beside = |c: usize| {
            let own = &system.channels[c];
            let channels = self.channels.iter().filter(|other| {
                let other = &system.channels[**other];
                other.element == own.element && other.dimension == own.dimension
            });
            channels.fold(0.0_f64, |most, other| most.max(answer(*other)))
        };
        let depends = |c: &usize| {
            let idle = (changed[*c] - plain[*c]).abs();
            idle > ANSWERS * answer(*c) + ROUNDING * beside(*c).max(plain[*c].abs())
        };
        Ok(self.channels.iter().copied().filter(depends).collect())
    }

    /// The channels with a value, and those without.
    pub fn channels(&self, examined: &Examined) -> (Vec<usize>, Vec<usize>) {
        let channels = self.channels.iter().copied();
        channels.partition(|channel| !examined.unknown[*channel])
    }

    /// The groups of elements that share reactions.
    pub fn shared(&self, mechanism: &Mechanism, examined: &Examined) -> Vec<Shared> {
        let mut groups: Vec<BTreeSet<usize>> = Vec::new();
        let owners = (0..mechanism.chosen.len()).filter(|i| examined.idle[*i]);
        let alone = owners.map(|i| (mechanism.owner(i), mechanism.owner(i)));
        for (a, b) in examined.pairs.iter().copied().chain(alone) {
            let mut joined = BTreeSet::from([a, b]);
            groups.retain(|group| {
                let meets = !group.is_disjoint(&joined);
                if meets {
                    joined.extend(group);
                }
                !meets
            });
            groups.push(joined);
        }
        groups.sort_by_key(|group| group.first().copied());
        let origins = |group: &BTreeSet<usize>| Shared {
            elements: (group.iter())
                .map(|element| super::origin_of(&mechanism.model, *element))
                .collect(),
        };
        groups.iter().map(origins).collect()
    }
}

/// Adds the pairs of elements that share reactions.
fn pair(
    mechanism: &Mechanism,
    projector: &DMatrix<f64>,
    idle: &[usize],
    pairs: &mut BTreeSet<(usize, usize)>,
) {
    for (n, i) in idle.iter().enumerate() {
        for j in &idle[..n] {
            let (a, b) = (mechanism.owner(*i), mechanism.owner(*j));
            if a != b && projector[(*i, *j)].abs() > IDLE {
                pairs.insert((a.min(b), a.max(b)));
            }
        }
    }
}

/// The scaled reactions of the equations at a completed state: `Bᵀ μ = Q − M v̇`. It leaves the loads' powers
/// in the dynamics, with multipliers zero.
fn reactions(mechanism: &mut Mechanism, state: &State) -> Result<DVector<f64>, RuntimeError> {
    let (model, dynamics) = (&mechanism.model, &mut mechanism.dynamics);
    dynamics.set_state(model, state, &[]);
    dynamics.evaluate(model)?;
    // M v̇ − Q
    let mut forces = vec![0.0; model.velocities];
    dynamics.add_forces(model, -1.0, &mut forces);
    dynamics.add_inertia(model, &state.velocity, &state.acceleration, &mut forces);
    let columns = &mechanism.columns;
    let wanted = DVector::from_fn(columns.len(), |i, _| {
        -forces[columns[i]] * mechanism.scales[columns[i]]
    });
    match &mechanism.equations {
        Some(equations) => Ok(equations.reactions(&wanted)),
        None => Err(RuntimeError::Malformed {
            what: "a kinematic state without equations".into(),
        }),
    }
}

/// Gives a state the multipliers of its constraints.
fn set_multipliers(mechanism: &Mechanism, reactions: &DVector<f64>, state: &mut State) {
    state.multipliers.fill(0.0);
    for (element, local, row) in mechanism.constraint_rows() {
        let at = mechanism.model.elements[element].row + local;
        state.multipliers[at] = mechanism.reaction(reactions, row);
    }
}

/// The torque (N m) on the cycle that moves the mechanism. If the analysis turns the cycle, it is the effort
/// of the equation of its angle.
///
/// Otherwise drives turn it. A required rate d of the equation `Φ(q, t)` of a drive changes the rate of the
/// cycle by `-s d`, with s from `Bᵀ s = ∂α̇/∂v`. Its multiplier λ has the power `λ d`. So one drive with `s ≠ 0`
/// has the torque `-λ/s`, also at rest. Several such drives have their power over the rate of the cycle,
/// `Σ λ d/(-Σ s d)`; at rest it is zero. Both sums have the same rates d, so the quotient is exact near rest, too.
/// Drives that do not turn the cycle take no part.
fn torque(
    mechanism: &mut Mechanism,
    reactions: &DVector<f64>,
    state: &State,
) -> Result<f64, RuntimeError> {
    let count = mechanism.chosen.len();
    if mechanism.is_turned() {
        return Ok(-reactions[count]);
    }
    let row = mechanism.cycle_row(state)?;
    let (Some(row), Some(equations)) = (row, &mechanism.equations) else {
        return Ok(0.0);
    };
    let turns = equations.reactions(&row);
    let least = TURNS * turns.amax();
    let drives: Vec<usize> = (0..count)
        .filter(|i| mechanism.driven[*i] && turns[*i].abs() > least)
        .collect();
    // multipliers and required rates are scaled inversely
    if let [drive] = drives.as_slice() {
        return Ok(-reactions[*drive] / turns[*drive]);
    }
    let sum = |of: &dyn Fn(usize) -> f64| drives.iter().map(|i| of(*i)).sum::<f64>();
    let rate = -sum(&|i| turns[i] * mechanism.demanded[i]);
    let largest = sum(&|i| (turns[i] * mechanism.demanded[i]).abs());
    // drives that cancel each other leave the rounding of their rates
    if rate.abs() <= TURNS * largest {
        return Ok(0.0);
    }
    Ok(sum(&|i| reactions[i] * mechanism.demanded[i]) / rate)
}

impl Mechanism {
    /// The reaction of one of all rows (N or N m) among scaled ones; zero of a row that takes no part.
    fn reaction(&self, reactions: &DVector<f64>, row: usize) -> f64 {
        let place = self.chosen.iter().position(|chosen| *chosen == row);
        place.map_or(0.0, |place| reactions[place] / self.scale(row))
    }

    /// The element of an equation.
    fn owner(&self, equation: usize) -> usize {
        let row = self.chosen[equation];
        match row.checked_sub(self.constraints) {
            Some(film) => self.pins[film / 4].element,
            None => self.owner_of(row),
        }
    }
}
