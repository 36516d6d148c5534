//! The places at all angles of a period, and Newton's method for all of them.

use super::super::{Balance, Place, Stop};
use super::derivative::{PeriodicDerivative, refined};
use super::krylov::gmres;
use super::path::{Path, turn_between};
use super::tangent::Tangent;
use super::{NoOrbit, Orbit, singular};
use crate::model::Model;
use crate::start::motion::SteadyMotion;
use crate::start::picking::{split, unit_rows};
use crate::start::{Equilibrium, Turning};
use crate::state::{State, move_pose};
use nalgebra::{DMatrix, DVector};

/// Rounds of Newton's method.
const ROUNDS: usize = 25;
/// Part of the residual to which a round solves its linear system.
const GOAL: f64 = 1e-10;
/// Products with the matrix in a round. The preconditioner leaves an eigenvalue `1 − (mΩ/ω)²` to each shape
/// of frequency ω and each order m below N/2: some hundreds that differ where a residual has all orders, as
/// that of a fine grid.
const PRODUCTS: usize = 400;
/// Part of the residual up to which a round has solved its system: its step tells how far off the places are.
const SOLVED: f64 = 1e-4;
/// Part of the residual from which on a round does not help. Between, its step is taken, and the next round
/// goes on from there.
const STALLED: f64 = 0.5;
/// Part of the first residual below which there is nothing but rounding.
const ROUNDING: f64 = 1e-11;
/// The same where a system of it is not solved.
const NEARLY: f64 = 1e-9;
/// Where bodies are free to move at a whole order of the period (a disc that wobbles as it turns, a shape
/// whose frequency is met and which no load of that order excites), the matrix has nearly no inverse along
/// that motion. There a residual of rounding asks for a step of any size, each round for another, and the
/// places before are as good an answer. Such a step shows by its size: below this part of the first residual,
/// where only rounding is left to solve for …
const SMALL: f64 = 1e-8;
/// … it is so many times larger for its residual than the first step was for its own. A step of a sound
/// matrix keeps the proportion of stiffest to softest shape that the first one had, within a few decades.
const BEYOND: f64 = 1e4;
/// Scaled step beyond which loads meet a shape that nothing damps: far beyond all bending.
const FAR: f64 = 1.0;

/// One of the angles.
#[derive(Clone, Debug)]
pub(super) struct Angle {
    pub place: Place,
    /// Rows of what is held, in scaled velocities; the first angle has those of the balance.
    pub held: Option<DMatrix<f64>>,
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
}

impl AsRef<[f64]> for Angle {
    fn as_ref(&self) -> &[f64] {
        &self.velocity
    }
}

/// All of them.
#[derive(Clone, Debug)]
pub(super) struct Angles {
    pub list: Vec<Angle>,
    pub derivative: PeriodicDerivative,
    /// The rows that velocities keep.
    pub motion: SteadyMotion,
    /// Which candidates are held at all angles but the first.
    chosen: Vec<usize>,
    /// Size of the residual with which Newton's method began, a number of it, and of its first step.
    load: f64,
    reach: f64,
}

/// Rows of what could be held at a place: what moves first, for what is stated of places may be at a dead centre elsewhere.
fn candidates(balance: &mut Balance, state: &State) -> Result<DMatrix<f64>, Stop> {
    let n = balance.model.velocities;
    let (moving, _) = balance.what_moves(state)?;
    let (_, stated) = balance.holds(state)?;
    let count = stated.nrows() - balance.fixed.nrows();
    let mut rows = DMatrix::zeros(moving.nrows() + count, n);
    rows.rows_mut(0, moving.nrows()).copy_from(&moving);
    rows.rows_mut(moving.nrows(), count)
        .copy_from(&stated.rows(0, count));
    unit_rows(&mut rows, 1e-12);
    Ok(rows)
}

/// Those of them that do not follow from others.
fn chosen(balance: &mut Balance, state: &State) -> Result<Vec<usize>, NoOrbit> {
    let rows = candidates(balance, state)?;
    let mut free = balance.motion.free.clone();
    let mut chosen = Vec::new();
    for i in 0..rows.nrows() {
        let left = split(&(rows.rows(i, 1) * &free))
            .ok_or_else(|| NoOrbit::Told("its rows are no numbers".to_owned()))?;
        if left.pick.nrows() > 0 {
            chosen.push(i);
            free *= left.free;
        }
    }
    Ok(chosen)
}

fn held_at(
    balance: &mut Balance,
    chosen: &[usize],
    state: &State,
) -> Result<DMatrix<f64>, NoOrbit> {
    let rows = candidates(balance, state)?;
    if chosen.iter().any(|i| *i >= rows.nrows()) {
        return Err(NoOrbit::Told(
            "what is stated differs from angle to angle".to_owned(),
        ));
    }
    let (count, neutral) = (chosen.len(), balance.neutral.nrows());
    let mut all = DMatrix::zeros(count + neutral, rows.ncols());
    all.rows_mut(0, count).copy_from(&rows.select_rows(chosen));
    all.rows_mut(count, neutral).copy_from(&balance.neutral);
    Ok(all)
}

impl Angles {
    /// Every `stride`-th place of a path.
    pub fn along(
        balance: &mut Balance,
        path: &Path,
        stride: usize,
        first: &Place,
    ) -> Result<Angles, NoOrbit> {
        let model = balance.model;
        let states: Vec<&State> = path.states.iter().step_by(stride).collect();
        let derivative = PeriodicDerivative::new(states.len(), path.period);
        let chosen = chosen(balance, &first.state)?;
        let motion = SteadyMotion::along_path(model, &first.state).map_err(singular)?;
        let mut list: Vec<Angle> = Vec::with_capacity(states.len());
        for (j, state) in states.iter().enumerate() {
            let (place, held) = if j == 0 {
                (first.clone(), None)
            } else {
                let held = held_at(balance, &chosen, state)?;
                let place = Place {
                    state: (*state).clone(),
                    efforts: DVector::zeros(held.nrows()),
                };
                (place, Some(held))
            };
            list.push(Angle {
                place,
                held,
                velocity: state.velocity.clone(),
                acceleration: vec![0.0; model.velocities],
            });
        }
        Ok(Angles {
            list,
            derivative,
            motion,
            chosen,
            load: 0.0,
            reach: 0.0,
        })
    }

    /// The same at twice as many angles of a path that has them all.
    pub fn refined(&self, balance: &mut Balance, path: &Path) -> Result<Angles, NoOrbit> {
        let model = balance.model;
        let off: Vec<Vec<f64>> = self
            .list
            .iter()
            .zip(path.states.iter().step_by(2))
            .map(|(angle, base)| {
                let mut off = vec![0.0; model.velocities];
                let (pose, base) = (&angle.place.state.pose, &base.pose);
                for body in &model.bodies {
                    let (p, v) = (body.pose, body.velocity);
                    for i in 0..3 {
                        off[v + i] = pose[p + i] - base[p + i];
                    }
                    let turn = turn_between(&base[p + 3..p + 7], &pose[p + 3..p + 7]);
                    off[v + 3..v + 6].copy_from_slice(turn.as_slice());
                    for i in 0..body.modes() {
                        off[v + 6 + i] = pose[p + 7 + i] - base[p + 7 + i];
                    }
                }
                off.extend(&angle.place.state.multipliers);
                off
            })
            .collect();
        let mut list = Vec::with_capacity(path.states.len());
        for (j, (off, base)) in refined(&off).iter().zip(&path.states).enumerate() {
            if j % 2 == 0
                && let Some(known) = self.list.get(j / 2)
            {
                list.push(known.clone());
                continue;
            }
            let held = held_at(balance, &self.chosen, base)?;
            let mut state = base.clone();
            move_pose(
                model,
                &base.pose,
                &off[..model.velocities],
                1.0,
                &mut state.pose,
            );
            state.multipliers.copy_from_slice(&off[model.velocities..]);
            list.push(Angle {
                place: Place {
                    state,
                    efforts: DVector::zeros(held.nrows()),
                },
                held: Some(held),
                velocity: base.velocity.clone(),
                acceleration: vec![0.0; model.velocities],
            });
        }
        Ok(Angles {
            derivative: PeriodicDerivative::new(list.len(), path.period),
            list,
            motion: self.motion.clone(),
            chosen: self.chosen.clone(),
            load: self.load,
            reach: self.reach,
        })
    }

    /// Newton's method for all angles.
    pub fn solve(&mut self, balance: &mut Balance, found: &mut Equilibrium) -> Result<(), NoOrbit> {
        let n = balance.model.velocities;
        let goal = balance.goal();
        let mut last = f64::INFINITY;
        for _ in 0..ROUNDS {
            let tangent = Tangent::new(balance, self)?;
            let wanted: Vec<f64> = tangent.residual.iter().map(|r| -r).collect();
            let squares = wanted.iter().map(|r| r * r).sum::<f64>() / wanted.len() as f64;
            let left = libm::sqrt(squares);
            self.load = self.load.max(left);
            // where a free motion has a whole order, nothing decides its size, and steps do not become small
            if left <= ROUNDING * self.load {
                return Ok(());
            }
            let solution = gmres(
                |x| tangent.multiply(balance, self, x),
                |x| tangent.precondition(x),
                &wanted,
                GOAL,
                PRODUCTS,
            )?;
            found.iterations += 1;
            let steps = tangent.parts(&solution.x);
            let size = steps
                .iter()
                .map(|s| s.rows(0, n).amax())
                .fold(0.0_f64, f64::max);
            if self.reach == 0.0 {
                self.reach = size;
            }
            if left <= SMALL * self.load && size * self.load > BEYOND * left * self.reach {
                return Ok(());
            }
            let solved = solution.residual <= SOLVED;
            if (size > FAR || !solved) && left <= NEARLY * self.load {
                return Ok(());
            }
            if size > FAR {
                return Err(NoOrbit::Told(self.resonance(balance, &steps)));
            }
            if solution.residual > STALLED {
                return Err(NoOrbit::Told(format!(
                    "the equations of all angles are not solved: {} products leave {:.0} % of what is out of balance",
                    solution.products,
                    100.0 * solution.residual
                )));
            }
            let factor = self.advance(balance, &steps, size);
            if factor == 1.0 && solved {
                if size <= goal || (size <= 1e4 * goal && size >= 0.5 * last) {
                    Tangent::velocities(balance, self)?;
                    return Ok(());
                }
                last = size;
            } else {
                last = f64::INFINITY;
            }
        }
        Err(NoOrbit::Told(
            "Newton's method finds no motion that repeats".to_owned(),
        ))
    }

    /// Moves all places by a step of Newton's method as far as each allows; gives that part of it.
    fn advance(&mut self, balance: &mut Balance, steps: &[DVector<f64>], size: f64) -> f64 {
        let model = balance.model;
        let n = model.velocities;
        let scales = balance.motion.scales();
        let mut factor = 1.0_f64;
        for (angle, step) in self.list.iter().zip(steps) {
            let increment: Vec<f64> = (0..n).map(|i| step[i] * scales[i]).collect();
            let pose = &angle.place.state.pose;
            factor = factor.min(balance.allowed(pose, &increment, size, &mut pose.clone()));
        }
        for (angle, step) in self.list.iter_mut().zip(steps) {
            balance.shift(&mut angle.place, step, factor);
        }
        factor
    }

    /// Which shape answers most in a step that solves nothing, and at which order.
    fn resonance(&self, balance: &Balance, steps: &[DVector<f64>]) -> String {
        let model = balance.model;
        let modal = model
            .bodies
            .iter()
            .flat_map(|body| (0..body.modes()).map(move |k| (body, k, body.velocity + 6 + k)));
        let size = |at: usize| steps.iter().map(|s| s[at] * s[at]).sum::<f64>();
        let Some((body, shape, at)) = modal.reduce(|best, next| {
            if size(next.2) > size(best.2) {
                next
            } else {
                best
            }
        }) else {
            return "its loads meet a frequency of its supports".to_owned();
        };
        let count = steps.len();
        let share = |order: usize| {
            let (mut re, mut im) = (0.0, 0.0);
            for (j, step) in steps.iter().enumerate() {
                let angle = std::f64::consts::TAU * ((order * j) % count) as f64 / count as f64;
                re += step[at] * libm::cos(angle);
                im += step[at] * libm::sin(angle);
            }
            re * re + im * im
        };
        let order = (0..count / 2).fold(0, |best, m| if share(m) > share(best) { m } else { best });
        let turn = &self.list[0].velocity[body.velocity + 3..body.velocity + 6];
        let speed = libm::sqrt(turn.iter().map(|x| x * x).sum());
        let order = order as f64 * std::f64::consts::TAU / (self.period() * speed);
        format!(
            "shape {} of {} is in resonance at {:.1} rpm with loads of order {order:.3} in its axes (0: they turn with it, 1: they \
             are still)",
            shape + 1,
            body.origin.path,
            speed * 60.0 / std::f64::consts::TAU,
        )
    }

    fn period(&self) -> f64 {
        let times = self.list.get(1).map_or(0.0, |a| a.place.state.time)
            - self.list.first().map_or(0.0, |a| a.place.state.time);
        times * self.list.len() as f64
    }

    /// Largest change of the first place's shapes and their rates from another grid, as a share of the largest.
    pub fn change(&self, model: &Model, other: &Angles) -> f64 {
        let (Some(here), Some(there)) = (self.list.first(), other.list.first()) else {
            return f64::NAN;
        };
        let scales = model.velocity_scales();
        let pace = std::f64::consts::TAU / self.period();
        let (mut change, mut size) = (0.0_f64, 0.0_f64);
        for body in &model.bodies {
            for k in 0..body.modes() {
                let (p, v) = (body.pose + 7 + k, body.velocity + 6 + k);
                let pairs = [
                    (here.place.state.pose[p], there.place.state.pose[p]),
                    (here.velocity[v] / pace, there.velocity[v] / pace),
                ];
                for (a, b) in pairs {
                    change = change.max((a - b).abs() / scales[v]);
                    size = size.max(a.abs() / scales[v]);
                }
            }
        }
        if size > 0.0 { change / size } else { 0.0 }
    }

    /// The first place. What nothing holds is loaded by the mean over the period.
    pub fn first(mut self, balance: &Balance, period: f64, change: f64) -> Orbit {
        let count = self.list.len();
        let neutral = balance.neutral.nrows();
        let means: Vec<f64> = (0..neutral)
            .map(|k| {
                let all = self.list.iter().map(|angle| {
                    let efforts = &angle.place.efforts;
                    efforts[efforts.len() - neutral + k]
                });
                all.sum::<f64>() / count as f64
            })
            .collect();
        let mut first = self.list.swap_remove(0);
        let own = first.place.efforts.len() - neutral;
        for (k, mean) in means.into_iter().enumerate() {
            first.place.efforts[own + k] = mean;
        }
        Orbit {
            place: first.place,
            velocity: first.velocity,
            acceleration: first.acceleration,
            told: Turning::Repeating {
                angles: count,
                period,
                change,
            },
        }
    }
}
