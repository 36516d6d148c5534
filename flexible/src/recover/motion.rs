//! Motion of nodes from the motion of the body's frame and the amplitudes.
//!
//! With the place `s` of a node, `u = Φt a`, `p = s + u`, the frame at `r` with the orientation `A` (body →
//! inertial):
//!
//! ```text
//! x = r + A p      ẋ = ṙ + A (ω × p + u̇)      ẍ = r̈ + A (ω̇ × p + ω × (ω × p) + 2 ω × u̇ + ü)
//! ```

use super::{Recovery, check_length, wrong};
use crate::error::FlexibleError;
use crate::fe::vector::{Vector, add, cross, scale};

/// Motion of a body's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameMotion {
    /// Origin (m, inertial).
    pub position: [f64; 3],
    /// Body → inertial, by rows.
    pub rotation: [[f64; 3]; 3],
    /// Velocity of the origin (m/s, inertial).
    pub velocity: [f64; 3],
    /// Angular velocity (rad/s, body axes).
    pub angular_velocity: [f64; 3],
    /// Acceleration of the origin (m/s², inertial).
    pub acceleration: [f64; 3],
    /// Rate of the angular velocity (rad/s², body axes).
    pub angular_acceleration: [f64; 3],
}

impl FrameMotion {
    /// At rest at the origin.
    pub const REST: FrameMotion = FrameMotion {
        position: [0.0; 3],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        velocity: [0.0; 3],
        angular_velocity: [0.0; 3],
        acceleration: [0.0; 3],
        angular_acceleration: [0.0; 3],
    };

    /// A vector in body axes as one in inertial axes.
    pub fn to_inertial(&self, x: [f64; 3]) -> [f64; 3] {
        self.rotation
            .map(|row| row.iter().zip(x).map(|(r, x)| r * x).sum())
    }

    /// A vector in inertial axes as one in body axes.
    pub fn to_body(&self, x: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.rotation;
        let along = |axis: usize| a[axis] * x[0] + b[axis] * x[1] + c[axis] * x[2];
        [along(0), along(1), along(2)]
    }
}

/// Amplitudes of the modes with their rates.
#[derive(Clone, Copy, Debug)]
pub struct Amplitudes<'a> {
    /// a.
    pub value: &'a [f64],
    /// ȧ.
    pub rate: &'a [f64],
    /// ä.
    pub second: &'a [f64],
}

/// A vector in body axes and in inertial ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Both {
    /// In body axes.
    pub body: [f64; 3],
    /// In inertial axes.
    pub inertial: [f64; 3],
}

/// Motion of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeMotion {
    /// Displacement u from its place in the undeformed body (m).
    pub displacement: Both,
    /// Its small rotation Φr a (rad, body axes), if the node has a rotation: a beam's, a spider's centre.
    pub rotation: Option<[f64; 3]>,
    /// Its position (m, inertial).
    pub position: [f64; 3],
    /// Its velocity against the inertial frame (m/s).
    pub velocity: Both,
    /// Its acceleration against the inertial frame (m/s²).
    pub acceleration: Both,
}

/// Some nodes with their rows of the shapes, for many moments.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeShapes {
    modes: usize,
    /// Places in the undeformed body (m, body axes).
    places: Vec<[f64; 3]>,
    /// For each node 6 × n: translation, then rotation (zero if the node has no rotation).
    rows: Vec<f64>,
    turns: Vec<bool>,
}

impl Recovery<'_> {
    /// The shapes' rows of nodes, given by index.
    ///
    /// # Errors
    /// An index that the mesh does not have.
    pub fn nodes(&self, nodes: &[u32]) -> Result<NodeShapes, FlexibleError> {
        let modes = self.modes();
        let size = self.freedoms.size();
        let mut found = NodeShapes {
            modes,
            places: Vec::with_capacity(nodes.len()),
            rows: Vec::with_capacity(6 * modes * nodes.len()),
            turns: Vec::with_capacity(nodes.len()),
        };
        for &node in nodes {
            let Some(place) = self.mesh.nodes.get(node as usize) else {
                return Err(wrong(format!("the mesh has no node of index {node}")));
            };
            found.places.push(place.position);
            found.turns.push(self.freedoms.has_rotation(node));
            for component in 0..6 {
                let freedom = self.freedoms.freedom(node, component);
                found.rows.extend((0..modes).map(|mode| {
                    freedom
                        .and_then(|f| self.shapes.get(mode * size + f))
                        .copied()
                        .unwrap_or(0.0)
                }));
            }
        }
        Ok(found)
    }
}

impl NodeShapes {
    /// For each node six rows of the modes: translation, then rotation (zero if the node has no rotation).
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// Motion of the nodes.
    ///
    /// # Errors
    /// Another number of amplitudes, rates or second rates than modes.
    pub fn motion(
        &self,
        frame: &FrameMotion,
        amplitudes: &Amplitudes,
    ) -> Result<Vec<NodeMotion>, FlexibleError> {
        for x in [amplitudes.value, amplitudes.rate, amplitudes.second] {
            check_length(self.modes, x)?;
        }
        let n = self.modes;
        let (omega, alpha) = (frame.angular_velocity, frame.angular_acceleration);
        let both = |body: Vector, base: Vector| {
            let inertial = add(base, frame.to_inertial(body));
            Both {
                body: add(frame.to_body(base), body),
                inertial,
            }
        };
        Ok(self
            .places
            .iter()
            .enumerate()
            .map(|(index, place)| {
                let along = |first: usize, x: &[f64]| {
                    let row = |component: usize| -> f64 {
                        let at = (6 * index + first + component) * n;
                        let row = self.rows.get(at..at + n).unwrap_or(&[]);
                        row.iter().zip(x).map(|(r, x)| r * x).sum()
                    };
                    [row(0), row(1), row(2)]
                };
                let displacement = along(0, amplitudes.value);
                let rate = along(0, amplitudes.rate);
                let second = along(0, amplitudes.second);
                let p = add(*place, displacement);
                let centripetal = cross(omega, cross(omega, p));
                let coriolis = scale(2.0, cross(omega, rate));
                let turns = self.turns.get(index) == Some(&true);
                NodeMotion {
                    displacement: both(displacement, [0.0; 3]),
                    rotation: turns.then(|| along(3, amplitudes.value)),
                    position: add(frame.position, frame.to_inertial(p)),
                    velocity: both(add(cross(omega, p), rate), frame.velocity),
                    acceleration: both(
                        add(add(cross(alpha, p), centripetal), add(coriolis, second)),
                        frame.acceleration,
                    ),
                }
            })
            .collect())
    }
}
