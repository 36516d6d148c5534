//! Residual and derivatives at all angles. The matrix is only used for products and never stored as a whole.

use super::super::{Balance, Stop};
use super::angles::Angles;
use super::derivative::Repeats;
use super::{NoOrbit, singular};
use crate::body::Weights;
use crate::model::Model;
use crate::rotation::{M3, Quaternion, product};
use crate::start::motion::{Kept, SteadyMotion};
use crate::state::move_pose;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Scaled move of a position for differences of velocities. It is about the cube root of the rounding unit:
/// the errors of a central difference are then 1e-10 or less.
const DIFFERENCE: f64 = 1e-5;

/// Derivatives at an angle.
struct Local {
    kept: Kept,
    /// Derivatives with respect to positions, velocities and accelerations. The pattern is that of the step's
    /// matrix.
    by_place: Vec<f64>,
    by_velocity: Vec<f64>,
    by_acceleration: Vec<f64>,
    held: DMatrix<f64>,
    factors: LU<f64, Dyn, Dyn>,
}

/// Residual and derivatives at all angles.
pub(super) struct Tangent {
    /// Scaled residuals, angle after angle.
    pub residual: Vec<f64>,
    sizes: Vec<usize>,
    locals: Vec<Local>,
    /// Rates of the quaternions of all bodies, angle after angle.
    turning: Vec<Vec<f64>>,
    motion: SteadyMotion,
}

fn quaternion(values: &[f64]) -> Quaternion {
    [values[0], values[1], values[2], values[3]]
}

fn conjugate([w, x, y, z]: Quaternion) -> Quaternion {
    [w, -x, -y, -z]
}

/// Quaternions of all bodies along the angles, without a change of sign between neighbours, and the sign of
/// each after the period.
fn orientations(model: &Model, angles: &Angles) -> (Vec<Vec<f64>>, Vec<Repeats>) {
    let mut all: Vec<Vec<f64>> = Vec::with_capacity(angles.list.len());
    for angle in &angles.list {
        let pose = &angle.place.state.pose;
        let mut own: Vec<f64> = model
            .bodies
            .iter()
            .flat_map(|b| pose[b.pose + 3..b.pose + 7].iter().copied())
            .collect();
        if let Some(last) = all.last() {
            for (q, before) in own.chunks_exact_mut(4).zip(last.chunks_exact(4)) {
                let along: f64 = q.iter().zip(before).map(|(a, b)| a * b).sum();
                if along < 0.0 {
                    q.iter_mut().for_each(|x| *x = -*x);
                }
            }
        }
        all.push(own);
    }
    let repeats = match (all.first(), all.last()) {
        (Some(first), Some(last)) => first
            .chunks_exact(4)
            .zip(last.chunks_exact(4))
            .map(|(a, b)| {
                let along: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                if along < 0.0 {
                    Repeats::Opposite
                } else {
                    Repeats::Same
                }
            })
            .collect(),
        _ => Vec::new(),
    };
    (all, repeats)
}

/// Rates of values, four for each body, with the sign of its repetition.
fn turning_rates(angles: &Angles, values: &[Vec<f64>], repeats: &[Repeats]) -> Vec<Vec<f64>> {
    let width = 4 * repeats.len();
    let mut rates = vec![vec![0.0; width]; values.len()];
    for kind in [Repeats::Same, Repeats::Opposite] {
        if !repeats.contains(&kind) {
            continue;
        }
        let mut own = vec![vec![0.0; width]; values.len()];
        angles.derivative.rates(values, kind, &mut own);
        for (rate, own) in rates.iter_mut().zip(&own) {
            for (b, _) in repeats.iter().enumerate().filter(|(_, r)| **r == kind) {
                rate[4 * b..4 * b + 4].copy_from_slice(&own[4 * b..4 * b + 4]);
            }
        }
    }
    rates
}

/// Positions and shapes of bodies, without orientations, in the order of the velocities. In m and amplitudes;
/// zeros for the orientations.
fn positions(model: &Model, pose: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; model.velocities];
    for body in &model.bodies {
        let (p, v) = (body.pose, body.velocity);
        out[v..v + 3].copy_from_slice(&pose[p..p + 3]);
        out[v + 6..v + body.width()].copy_from_slice(&pose[p + 7..p + 7 + body.modes()]);
    }
    out
}

impl Tangent {
    /// Sets the velocities and accelerations at all angles. Returns the conditions on velocities, and the
    /// quaternions' rates.
    #[allow(clippy::type_complexity)]
    fn rates(
        balance: &Balance,
        motion: &SteadyMotion,
        angles: &mut Angles,
    ) -> Result<(Vec<Kept>, Vec<Vec<f64>>), NoOrbit> {
        let model = balance.model;
        let count = angles.list.len();
        let places: Vec<Vec<f64>> = angles
            .list
            .iter()
            .map(|a| positions(model, &a.place.state.pose))
            .collect();
        let mut rates = vec![vec![0.0; model.velocities]; count];
        angles.derivative.rates(&places, Repeats::Same, &mut rates);
        let (orientations, repeats) = orientations(model, angles);
        let turning = turning_rates(angles, &orientations, &repeats);
        let mut all = Vec::with_capacity(count);
        for (j, angle) in angles.list.iter_mut().enumerate() {
            for (b, body) in model.bodies.iter().enumerate() {
                let own = 4 * b..4 * b + 4;
                let q = quaternion(&orientations[j][own.clone()]);
                let spin = product(&conjugate(q), &quaternion(&turning[j][own]));
                for i in 0..3 {
                    rates[j][body.velocity + 3 + i] = 2.0 * spin[1 + i];
                }
            }
            let (velocity, kept) = motion
                .nearest(model, &angle.place.state, &rates[j])
                .map_err(singular)?;
            angle.velocity = velocity;
            all.push(kept);
        }
        let mut accelerations = vec![vec![0.0; model.velocities]; count];
        angles
            .derivative
            .rates(&angles.list, Repeats::Same, &mut accelerations);
        for (angle, acceleration) in angles.list.iter_mut().zip(accelerations) {
            angle.acceleration = acceleration;
        }
        let turning = turning
            .into_iter()
            .zip(orientations)
            .map(|(mut rate, q)| {
                rate.extend(q);
                rate
            })
            .collect();
        Ok((all, turning))
    }

    /// Velocities and accelerations at all angles.
    pub fn velocities(balance: &Balance, angles: &mut Angles) -> Result<(), NoOrbit> {
        Tangent::rates(balance, &angles.motion.clone(), angles).map(|_| ())
    }

    /// Residual and derivatives at the present positions. It sets their velocities.
    pub fn new(balance: &mut Balance, angles: &mut Angles) -> Result<Tangent, NoOrbit> {
        let motion = angles.motion.clone();
        let (kept, turning) = Tangent::rates(balance, &motion, angles)?;
        let mut residual = Vec::new();
        let mut sizes = Vec::new();
        let mut locals = Vec::new();
        for (angle, kept) in angles.list.iter().zip(kept) {
            let state = &angle.place.state;
            balance.turned = angle.held.clone();
            balance.velocity.copy_from_slice(&angle.velocity);
            balance.acceleration.copy_from_slice(&angle.acceleration);
            let own = balance.imbalance(&angle.place)?;
            let mut filled = |acceleration: f64, velocity: f64| -> Result<Vec<f64>, Stop> {
                balance.fill(Weights {
                    acceleration,
                    velocity,
                })?;
                Ok(balance.values.clone())
            };
            let by_place = filled(0.0, 0.0)?;
            let less = |mut all: Vec<f64>| {
                for (x, y) in all.iter_mut().zip(&by_place) {
                    *x -= y;
                }
                all
            };
            let by_velocity = less(filled(0.0, 1.0)?);
            let by_acceleration = less(filled(1.0, 0.0)?);
            let mut matrix = balance.matrix(state)?;
            balance.add_softening(state, -1.0, &mut matrix);
            let (_, held) = balance.held(state)?;
            residual.extend(own.iter());
            sizes.push(own.len());
            locals.push(Local {
                kept,
                by_place,
                by_velocity,
                by_acceleration,
                held,
                factors: matrix.lu(),
            });
        }
        Ok(Tangent {
            residual,
            sizes,
            locals,
            turning,
            motion,
        })
    }

    /// A vector over all angles, angle by angle.
    pub fn parts(&self, x: &[f64]) -> Vec<DVector<f64>> {
        let mut first = 0;
        self.sizes
            .iter()
            .map(|size| {
                let part = DVector::from_column_slice(&x[first..first + size]);
                first += size;
                part
            })
            .collect()
    }

    /// Applies the preconditioner: the balance of each angle alone.
    pub fn precondition(&self, x: &[f64]) -> Result<Vec<f64>, NoOrbit> {
        let mut out = Vec::with_capacity(x.len());
        for (part, local) in self.parts(x).iter().zip(&self.locals) {
            let solved = local.factors.solve(part).ok_or_else(|| {
                NoOrbit::Reason("its balance has no stiffness at an angle of the turn".to_owned())
            })?;
            out.extend(solved.iter());
        }
        Ok(out)
    }

    /// Changes of the rates along the positions, from increments at all angles. Both in SI, per second for
    /// the rates.
    fn path_rates(&self, model: &Model, angles: &Angles, increments: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let count = angles.list.len();
        let mut rates = vec![vec![0.0; model.velocities]; count];
        angles
            .derivative
            .rates(increments, Repeats::Same, &mut rates);
        let (orientations, repeats) = orientations(model, angles);
        let spins: Vec<Vec<Quaternion>> = increments
            .iter()
            .map(|x| {
                let of = |v: usize| [0.0, 0.5 * x[v + 3], 0.5 * x[v + 4], 0.5 * x[v + 5]];
                model.bodies.iter().map(|b| of(b.velocity)).collect()
            })
            .collect();
        // δq = q ∘ φ/2
        let moved: Vec<Vec<f64>> = orientations
            .iter()
            .zip(&spins)
            .map(|(q, spins)| {
                q.chunks_exact(4)
                    .zip(spins)
                    .flat_map(|(q, half)| product(&quaternion(q), half))
                    .collect()
            })
            .collect();
        let moved_rates = turning_rates(angles, &moved, &repeats);
        for j in 0..count {
            for (b, body) in model.bodies.iter().enumerate() {
                let own = 4 * b..4 * b + 4;
                let back = conjugate(quaternion(&orientations[j][own.clone()]));
                let spin = product(&back, &quaternion(&self.turning[j][own.clone()]));
                let first = product(&conjugate(spins[j][b]), &spin);
                let second = product(&back, &quaternion(&moved_rates[j][own]));
                for i in 0..3 {
                    rates[j][body.velocity + 3 + i] = 2.0 * (first[1 + i] + second[1 + i]);
                }
            }
        }
        rates
    }

    /// The derivative of the residual along a step of all angles, both scaled.
    pub fn multiply(
        &self,
        balance: &Balance,
        angles: &Angles,
        x: &[f64],
    ) -> Result<Vec<f64>, NoOrbit> {
        let model = balance.model;
        let (n, m, s) = (model.velocities, model.rows, model.states);
        let scales = balance.motion.scales();
        let row_scales = model.row_scales();
        let steps = self.parts(x);
        let increments: Vec<Vec<f64>> = steps
            .iter()
            .map(|step| (0..n).map(|i| step[i] * scales[i]).collect())
            .collect();
        let mut velocities = self.path_rates(model, angles, &increments);
        for (j, local) in self.locals.iter().enumerate() {
            self.keep(model, angles, j, local, &steps[j], &mut velocities[j])?;
        }
        let mut accelerations = vec![vec![0.0; n]; steps.len()];
        angles
            .derivative
            .rates(&velocities, Repeats::Same, &mut accelerations);
        let pattern = &balance.plan.pattern;
        let mut out = Vec::with_capacity(x.len());
        let mut room = [
            vec![0.0; n + s + m],
            vec![0.0; n + s + m],
            vec![0.0; n + s + m],
        ];
        for (j, (local, step)) in self.locals.iter().zip(&steps).enumerate() {
            let along = |values: &[f64], x: &[f64], room: &mut Vec<f64>| {
                let mut all = x.to_vec();
                all.resize(n + s + m, 0.0);
                if x.len() == n {
                    pattern.multiply(values, &all, room);
                }
            };
            let mut place = increments[j].clone();
            place.resize(n + s, 0.0);
            place.extend((0..m).map(|i| step[n + i] * balance.unit / row_scales[i]));
            let [by_place, by_velocity, by_acceleration] = &mut room;
            pattern.multiply(&local.by_place, &place, by_place);
            along(&local.by_velocity, &velocities[j], by_velocity);
            along(&local.by_acceleration, &accelerations[j], by_acceleration);
            let efforts = step.rows(n + m, step.len() - n - m);
            let pulled = local.held.tr_mul(&efforts);
            for i in 0..n {
                let force = by_place[i] + by_velocity[i] + by_acceleration[i];
                out.push(force * scales[i] / balance.unit + pulled[i]);
            }
            for i in 0..m {
                out.push(by_place[n + s + i] / row_scales[i]);
            }
            out.extend((&local.held * step.rows(0, n)).iter());
        }
        Ok(out)
    }

    /// Changes of velocities at an angle, from those of the rates along the positions, such that the
    /// conditions hold at the moved position.
    fn keep(
        &self,
        model: &Model,
        angles: &Angles,
        j: usize,
        local: &Local,
        step: &DVector<f64>,
        rates: &mut [f64],
    ) -> Result<(), NoOrbit> {
        let n = model.velocities;
        let scales = self.motion.scales();
        let mut y = DVector::from_fn(n, |i, _| rates[i] / scales[i]);
        let mut missed = DVector::zeros(local.kept.rows.nrows());
        let size = step.rows(0, n).amax();
        if size > 0.0 {
            let part = DIFFERENCE / size;
            let increment: Vec<f64> = (0..n).map(|i| step[i] * scales[i]).collect();
            let angle = &angles.list[j];
            let mut moved = angle.place.state.clone();
            moved.velocity.copy_from_slice(&angle.velocity);
            for sign in [1.0, -1.0] {
                let pose = &angle.place.state.pose;
                move_pose(model, pose, &increment, sign * part, &mut moved.pose);
                missed += self.motion.missed(model, &moved)? * (sign / (2.0 * part));
            }
        }
        missed += &local.kept.rows * &y;
        y -= local.kept.least(&missed).map_err(singular)?;
        for (rate, (y, s)) in rates.iter_mut().zip(y.iter().zip(scales)) {
            *rate = y * s;
        }
        Ok(())
    }
}

impl Balance<'_> {
    /// Adds the centrifugal softening of flexible bodies to a scaled matrix, at the present velocities.
    pub(in crate::start) fn add_softening(
        &self,
        state: &crate::state::State,
        factor: f64,
        matrix: &mut DMatrix<f64>,
    ) {
        let model = self.model;
        let scales = self.motion.scales();
        let mut work = crate::flexible::Work::default();
        let none = Weights {
            acceleration: 0.0,
            velocity: 0.0,
        };
        for body in model.bodies.iter().filter(|b| b.modes() > 0) {
            let (width, v) = (body.width(), body.velocity);
            let frame = body.frame(&state.pose);
            let mut block = |velocity: &[f64]| {
                let mut out = vec![0.0; width * width];
                body.add_inertia_matrix(
                    &frame,
                    velocity,
                    &self.acceleration[v..v + width],
                    &model.gravity,
                    none,
                    &M3::identity(),
                    &mut work,
                    &mut out,
                );
                out
            };
            let turning = block(&self.velocity[v..v + width]);
            let resting = block(&vec![0.0; width]);
            for i in 6..width {
                for j in 6..width {
                    let softening = turning[i * width + j] - resting[i * width + j];
                    matrix[(v + i, v + j)] +=
                        factor * softening * scales[v + i] * scales[v + j] / self.unit;
                }
            }
        }
    }
}
