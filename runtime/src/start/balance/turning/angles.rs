//! The positions at all angles of a period, and Newton's method for all of them together.

use super::super::{Balance, Place, Stop};
use super::derivative::{PeriodicDerivative, refined};
use super::krylov::gmres;
use super::path::Path;
use super::tangent::Tangent;
use super::{NoOrbit, Orbit, singular};
use crate::model::Model;
use crate::start::motion::SteadyMotion;
use crate::start::picking::{split, unit_rows};
use crate::start::{Equilibrium, Turning};
use crate::state::{State, move_pose, offset};
use nalgebra::{DMatrix, DVector};

/// Most rounds of Newton's method. A choice: near the motion a few rounds serve, but rounds whose linear
/// system is only partly solved make slow progress, and a round of many products is the dearest part of a
/// start.
const ROUNDS: usize = 25;
/// Part of the residual at which a round's linear system is solved. A choice: a round then loses nothing of
/// the speed of Newton's method.
const GOAL: f64 = 1e-10;
/// Most products with the matrix in a round. With the preconditioner each shape of frequency ω and each order
/// m below N/2 has an eigenvalue `1 − (mΩ/ω)²`. A residual with all orders, such as that of a fine grid, has
/// some hundreds of different ones.
const PRODUCTS: usize = 400;
/// Part of the residual below which a round has solved its system, so that its step measures the error of the
/// positions. A choice: then the step has four right digits, more than the comparison of two steps needs.
const SOLVED: f64 = 1e-4;
/// Part of the residual above which a round is useless. Between [`SOLVED`] and this, its step is taken, and
/// the next round continues from there. A choice: with less progress than a factor of two the rounds would
/// end before the motion is found.
const STALLED: f64 = 0.5;
/// Part of the first residual below which only rounding is left. A choice, some decades above the rounding
/// unit because loads cancel in a residual.
const ROUNDING: f64 = 1e-11;
/// Part of the first residual below which only rounding is left, if its linear system cannot be solved. It is
/// a hundred times [`ROUNDING`]: near a free motion the matrix is nearly singular, and the last digits of a
/// residual are lost in it.
const NEARLY: f64 = 1e-9;
/// Bodies may be free to move at a whole order of the period: a wobbling disc, or a shape at its frequency
/// that no load of that order excites. Along this motion the matrix is nearly singular. There a residual of
/// rounding gives a step of arbitrary size, different in each round, and the earlier positions are an equally
/// good answer. Such a step is recognised below this part of the first residual, where only rounding is left
/// …
const SMALL: f64 = 1e-8;
/// … by its size relative to its residual, which is this many times that of the first step. With a sound
/// matrix this ratio changes by a few decades at most, because the ratio of the stiffest to the softest shape
/// is the same.
const BEYOND: f64 = 1e4;
/// Scaled step above which a load meets an undamped shape. One is the model's length or a radian, far beyond
/// all bending.
const FAR: f64 = 1.0;

/// One of the angles.
#[derive(Clone, Debug)]
pub(super) struct Angle {
    pub place: Place,
    /// Rows of held directions, in scaled velocities. The first angle has those of the balance.
    pub held: Option<DMatrix<f64>>,
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
}

impl AsRef<[f64]> for Angle {
    fn as_ref(&self) -> &[f64] {
        &self.velocity
    }
}

/// All angles.
#[derive(Clone, Debug)]
pub(super) struct Angles {
    pub list: Vec<Angle>,
    pub derivative: PeriodicDerivative,
    /// The conditions on velocities.
    pub motion: SteadyMotion,
    /// Indices of the candidates that are held at all angles except the first.
    chosen: Vec<usize>,
    /// Size per number of the first residual of Newton's method, and of its first step.
    load: f64,
    reach: f64,
}

/// Rows of directions that could be held at a position. Moving rows come first, because stated positions may
/// be at a dead centre at another angle.
fn candidates(balance: &mut Balance, state: &State) -> Result<DMatrix<f64>, Stop> {
    let n = balance.model.velocities;
    let (moving, _) = balance.what_moves(state)?;
    let (_, stated) = balance.holds(state)?;
    let count = stated.nrows() - balance.fixed.nrows();
    let mut rows = DMatrix::zeros(moving.nrows() + count, n);
    rows.rows_mut(0, moving.nrows()).copy_from(&moving);
    rows.rows_mut(moving.nrows(), count)
        .copy_from(&stated.rows(0, count));
    // rows have a length of about one in scaled velocities: a shorter one is rounding
    unit_rows(&mut rows, 1e-12);
    Ok(rows)
}

/// The independent ones among the candidates.
fn chosen(balance: &mut Balance, state: &State) -> Result<Vec<usize>, NoOrbit> {
    let rows = candidates(balance, state)?;
    let mut free = balance.motion.free.clone();
    let mut chosen = Vec::new();
    for i in 0..rows.nrows() {
        let left = split(&(rows.rows(i, 1) * &free))
            .ok_or_else(|| NoOrbit::Reason("its rows are no numbers".to_owned()))?;
        if left.pick.nrows() > 0 {
            chosen.push(i);
            free *= left.free;
        }
    }
    Ok(chosen)
}

/// The rows of the chosen candidates at a state, and those of directions that nothing holds (rows ×
/// velocities, scaled).
fn held_at(
    balance: &mut Balance,
    chosen: &[usize],
    state: &State,
) -> Result<DMatrix<f64>, NoOrbit> {
    let rows = candidates(balance, state)?;
    if chosen.iter().any(|i| *i >= rows.nrows()) {
        return Err(NoOrbit::Reason(
            "the stated values differ from angle to angle".to_owned(),
        ));
    }
    let (count, neutral) = (chosen.len(), balance.neutral.nrows());
    let mut all = DMatrix::zeros(count + neutral, rows.ncols());
    all.rows_mut(0, count).copy_from(&rows.select_rows(chosen));
    all.rows_mut(count, neutral).copy_from(&balance.neutral);
    Ok(all)
}

impl Angles {
    /// The angles at every `stride`-th position of a path.
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

    /// The solution at twice as many angles, which the path has.
    pub fn refined(&self, balance: &mut Balance, path: &Path) -> Result<Angles, NoOrbit> {
        let model = balance.model;
        let off: Vec<Vec<f64>> = self
            .list
            .iter()
            .zip(path.states.iter().step_by(2))
            .map(|(angle, base)| {
                let mut off = offset(model, &base.pose, &angle.place.state.pose);
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
            // the size of a free motion at a whole order is undetermined, so steps need not become small
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
                return Err(NoOrbit::Reason(self.resonance(balance, &steps)));
            }
            if solution.residual > STALLED {
                return Err(NoOrbit::Reason(format!(
                    "the search for the motion over a turn does not converge: after {} products with the matrix {:.0} % of the unbalanced load is left",
                    solution.products,
                    100.0 * solution.residual
                )));
            }
            let factor = self.advance(balance, &steps, size);
            if factor == 1.0 && solved {
                // below a tenth of the position tolerance, steps that are not even halved are rounding: it
                // adds up over all angles, so the limit is ten times that of one balance. A choice
                if size <= goal || (size <= 1e4 * goal && size >= 0.5 * last) {
                    Tangent::velocities(balance, self)?;
                    return Ok(());
                }
                last = size;
            } else {
                last = f64::INFINITY;
            }
        }
        Err(NoOrbit::Reason(
            "Newton's method finds no motion that repeats".to_owned(),
        ))
    }

    /// Moves all positions by a step of Newton's method, as far as each allows. Returns the part of the step.
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

    /// The shape with the largest response in a useless step, and its order.
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
            return "its loads excite a natural frequency of its supports".to_owned();
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
            "loads of order {order:.3} in the axes of {} (order 0 turns with it, order 1 stands still) are in resonance with its \
             shape {} at {:.1} rpm",
            body.origin.path,
            shape + 1,
            speed * 60.0 / std::f64::consts::TAU,
        )
    }

    /// The period (s).
    fn period(&self) -> f64 {
        let times = self.list.get(1).map_or(0.0, |a| a.place.state.time)
            - self.list.first().map_or(0.0, |a| a.place.state.time);
        times * self.list.len() as f64
    }

    /// Largest change of the first position's shapes and their rates from another grid, as a share of the
    /// largest.
    pub fn change(&self, model: &Model, other: &Angles) -> f64 {
        let (Some(here), Some(there)) = (self.list.first(), other.list.first()) else {
            return f64::NAN;
        };
        let scales = model.velocity_scales();
        let frequency = std::f64::consts::TAU / self.period();
        let (mut change, mut size) = (0.0_f64, 0.0_f64);
        for body in &model.bodies {
            for k in 0..body.modes() {
                let (p, v) = (body.pose + 7 + k, body.velocity + 6 + k);
                let pairs = [
                    (here.place.state.pose[p], there.place.state.pose[p]),
                    (here.velocity[v] / frequency, there.velocity[v] / frequency),
                ];
                for (a, b) in pairs {
                    change = change.max((a - b).abs() / scales[v]);
                    size = size.max(a.abs() / scales[v]);
                }
            }
        }
        if size > 0.0 { change / size } else { 0.0 }
    }

    /// The start at the first position. Directions that nothing holds get the mean load over the period.
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
            turning: Turning::Repeating {
                angles: count,
                period,
                change,
            },
        }
    }
}
