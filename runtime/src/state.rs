//! The state on R³ × SO(3) × Rⁿ with its rates.

use crate::body::BodyModel;
use crate::model::Model;
use crate::rotation::{Quaternion, V3, exponential, normalized, product, turn_between};

/// A point of the motion.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct State {
    /// Time (s).
    pub time: f64,
    /// r (m), unit quaternion, modal amplitudes of each body.
    pub pose: Vec<f64>,
    /// ṙ (m/s), ω (rad/s, body axes), modal rates of each body.
    pub velocity: Vec<f64>,
    /// Rates of the velocities.
    pub acceleration: Vec<f64>,
    /// States of elements (SI).
    pub states: Vec<f64>,
    /// Their rates.
    pub rates: Vec<f64>,
    /// Multipliers (N for lengths, N m for directions).
    pub multipliers: Vec<f64>,
    /// Unwrapped angle of each rotation at the last accepted state (rad).
    pub rotations: Vec<f64>,
}

impl State {
    /// The rate (1/s) at which the motion covers the scale of a velocity, which is the model's length or a
    /// radian: the largest scaled velocity, or the root of the largest scaled acceleration if that is larger.
    pub fn motion_rate(&self, model: &Model) -> f64 {
        let acceleration = model.largest(&self.acceleration);
        model.largest(&self.velocity).max(libm::sqrt(acceleration))
    }

    /// The highest angular speed of a body (rad/s).
    pub fn fastest_turn(&self, model: &Model) -> f64 {
        let speed = |body: &BodyModel| {
            let turning = &self.velocity[body.velocity + 3..body.velocity + 6];
            libm::sqrt(turning.iter().map(|x| x * x).sum::<f64>())
        };
        model.bodies.iter().map(speed).fold(0.0, f64::max)
    }

    /// All bodies at the origin, at rest.
    pub fn new(model: &Model) -> State {
        let mut pose = vec![0.0; model.poses];
        for body in &model.bodies {
            pose[body.pose + 3] = 1.0;
        }
        State {
            time: 0.0,
            pose,
            velocity: vec![0.0; model.velocities],
            acceleration: vec![0.0; model.velocities],
            states: vec![0.0; model.states],
            rates: vec![0.0; model.states],
            multipliers: vec![0.0; model.rows],
            rotations: vec![0.0; model.rotations],
        }
    }

    /// Copies without allocation.
    pub fn copy_from(&mut self, other: &State) {
        self.time = other.time;
        self.pose.copy_from_slice(&other.pose);
        self.velocity.copy_from_slice(&other.velocity);
        self.acceleration.copy_from_slice(&other.acceleration);
        self.states.copy_from_slice(&other.states);
        self.rates.copy_from_slice(&other.rates);
        self.multipliers.copy_from_slice(&other.multipliers);
        self.rotations.copy_from_slice(&other.rotations);
    }
}

/// `out = pose ∘ exp(factor · increment)`: r and modal amplitudes add, rotations turn in body axes.
pub fn move_pose(model: &Model, pose: &[f64], increment: &[f64], factor: f64, out: &mut [f64]) {
    for body in &model.bodies {
        let (p, v) = (body.pose, body.velocity);
        for i in 0..3 {
            out[p + i] = pose[p + i] + factor * increment[v + i];
        }
        let theta = V3::new(increment[v + 3], increment[v + 4], increment[v + 5]) * factor;
        let old: Quaternion = [pose[p + 3], pose[p + 4], pose[p + 5], pose[p + 6]];
        let new = normalized(&product(&old, &exponential(&theta)));
        out[p + 3..p + 7].copy_from_slice(&new);
        for i in 0..body.modes() {
            out[p + 7 + i] = pose[p + 7 + i] + factor * increment[v + 6 + i];
        }
    }
}

/// The increment from one position to another, the inverse of [`move_pose`].
pub fn offset(model: &Model, from: &[f64], to: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; model.velocities];
    offset_into(model, from, to, &mut out);
    out
}

/// [`offset`] without a new list.
pub fn offset_into(model: &Model, from: &[f64], to: &[f64], out: &mut [f64]) {
    for body in &model.bodies {
        let (p, v) = (body.pose, body.velocity);
        for i in 0..3 {
            out[v + i] = to[p + i] - from[p + i];
        }
        let turn = turn_between(&from[p + 3..p + 7], &to[p + 3..p + 7]);
        out[v + 3..v + 6].copy_from_slice(turn.as_slice());
        for i in 0..body.modes() {
            out[v + 6 + i] = to[p + 7 + i] - from[p + 7 + i];
        }
    }
}
