//! Moving bodies in glTF, in a viewer inside a page, and in files for ParaView.
//!
//! All three come from one set of plain data: flexible bodies by their modes, rigid ones by simple parts. Lengths
//! are metres, times seconds.

mod collapse;
mod film;
mod gltf;
pub(crate) mod image;
pub(crate) mod packed;
pub(crate) mod poster;
pub(crate) mod quaternion;
pub(crate) mod solid;
pub(crate) mod viewer;
mod vtk;

pub use collapse::collapsed;
pub use film::{FilmSurface, Films};
pub(crate) use viewer::SCRIPT;
pub use vtk::{CellKind, VtkBody, VtkEncoding, VtkFrame, VtkPart, pvd, vtu};

use quaternion::{normalised, rotated};

/// Triangles between nodes, in the axes of a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Places of the nodes (m).
    pub nodes: Vec<[f64; 3]>,
    /// Three nodes each (from 0), counterclockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// The pose of a body: a point s of the body is at r + A·s with the rotation A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// r, in the inertial axes (m).
    pub position: [f64; 3],
    /// Unit quaternion (w, x, y, z) from the body's to the inertial axes; brought to unit length.
    pub rotation: [f64; 4],
}

impl Pose {
    /// At the origin, not turned.
    pub const HOME: Pose = Pose {
        position: [0.0; 3],
        rotation: [1.0, 0.0, 0.0, 0.0],
    };

    /// Place in the inertial axes of a point of the body.
    fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = rotated(normalised(self.rotation), point);
        [0, 1, 2].map(|i| self.position[i] + turned[i])
    }
}

/// The motion of the nodes for an amplitude of 1.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeShape {
    /// `normal 3, 412 Hz`.
    pub name: String,
    /// One displacement for each node, in the body's axes (m for an amplitude of 1).
    pub displacements: Vec<[f64; 3]>,
}

/// A number for each node that does not change in time, such as the largest stress over a cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeField {
    /// `von Mises, largest over the cycle`.
    pub name: String,
    /// `MPa`.
    pub unit: String,
    /// One for each node, in this unit.
    pub values: Vec<f64>,
}

/// A body that deforms by modes.
#[derive(Clone, Debug, PartialEq)]
pub struct FlexibleBody {
    /// As in the model.
    pub name: String,
    /// Its visible surface or parts.
    pub surface: Surface,
    /// Its modes.
    pub shapes: Vec<ModeShape>,
    /// One pose for each time; a single pose for a body at rest.
    pub poses: Vec<Pose>,
    /// For each time, one amplitude for each mode.
    pub amplitudes: Vec<Vec<f64>>,
    /// Numbers that can colour it, besides the displacement.
    pub fields: Vec<NodeField>,
}

/// A part of a rigid body, in the body's axes (m).
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// With sides along the axes.
    Box {
        /// Its middle.
        center: [f64; 3],
        /// Lengths of its sides.
        size: [f64; 3],
    },
    /// A round bar between two points, such as two markers.
    Cylinder {
        /// Middle of one end.
        from: [f64; 3],
        /// Middle of the other end.
        to: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// A line through points.
    Line {
        /// The points.
        points: Vec<[f64; 3]>,
    },
    /// Any surface.
    Mesh(Surface),
}

/// A body that doesn't deform.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    /// As in the model.
    pub name: String,
    /// Its visible surface or parts.
    pub parts: Vec<Part>,
    /// One pose for each time; a single pose for a body at rest.
    pub poses: Vec<Pose>,
}

/// The inertial axis that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// x.
    X,
    /// y.
    Y,
    /// z.
    Z,
}

/// The bodies of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// Its title.
    pub title: String,
    /// Times (s), increasing.
    pub times: Vec<f64>,
    /// Crank angle at each time (°); empty if there is none.
    pub angles: Vec<f64>,
    /// The axis that points up.
    pub up: Up,
    /// First factor on the displacements.
    pub scale: f64,
    /// Seconds of the animation for one second of motion. An engine's cycle lasts hundredths of a second.
    pub slowdown: f64,
    /// The flexible bodies.
    pub flexible: Vec<FlexibleBody>,
    /// The rigid bodies.
    pub rigid: Vec<RigidBody>,
    /// The fluid films.
    pub films: Films,
}

/// The reason why an animation cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnimationError {
    /// Nothing to show, or no time.
    #[error("the animation has no {0}")]
    Empty(&'static str),
    /// Too few or too many of something.
    #[error("{body}: {found} {what}, but {expected} are needed")]
    Count {
        /// The body, or `the animation`.
        body: String,
        /// The counted items.
        what: &'static str,
        /// Their number.
        found: usize,
        /// The necessary number.
        expected: usize,
    },
    /// A triangle or cell names a node that is not there.
    #[error("{body}: a cell names node {node}, but there are {nodes} nodes, counted from 0")]
    Node {
        /// The body.
        body: String,
        /// The index of the node.
        node: u32,
        /// Their number.
        nodes: usize,
    },
    /// A number that is infinite or no number, or too large for a file of single precision.
    #[error("{body}: {what} holds a number that is not finite in single precision")]
    NotFinite {
        /// The body, or `the animation`.
        body: String,
        /// The place of the number.
        what: &'static str,
    },
    /// A number out of its range.
    #[error("{what} must be {range}, not {value}")]
    Range {
        /// The name of the number.
        what: &'static str,
        /// The allowed range.
        range: &'static str,
        /// The given value.
        value: f64,
    },
    /// More data than a glTF file can hold.
    #[error("the animation needs {bytes} bytes, more than the 4 GiB that a glTF file can hold")]
    TooLarge {
        /// The necessary number of bytes.
        bytes: u64,
    },
}

/// The kind of a body: `piston` for `piston[3]`.
fn kind_of(name: &str) -> &str {
    name.split('[').next().unwrap_or(name)
}

impl Animation {
    /// Kinds of bodies in a fixed order; those of one kind have one colour.
    fn kinds(&self) -> Vec<&str> {
        let flexible = self.flexible.iter().map(|body| body.name.as_str());
        let rigid = self.rigid.iter().map(|body| body.name.as_str());
        let mut kinds: Vec<&str> = Vec::new();
        for kind in flexible.chain(rigid).map(kind_of) {
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        kinds
    }
}

impl FlexibleBody {
    /// Displacements of the nodes at a time (by index), not scaled, in the body's axes (m): Σ
    /// amplitude·shape.
    pub fn displacements(&self, time: usize) -> Vec<[f64; 3]> {
        let mut sum = vec![[0.0; 3]; self.surface.nodes.len()];
        let amplitudes = self.amplitudes.get(time).map_or(&[][..], Vec::as_slice);
        for (shape, amplitude) in self.shapes.iter().zip(amplitudes) {
            for (sum, displacement) in sum.iter_mut().zip(&shape.displacements) {
                for (sum, d) in sum.iter_mut().zip(displacement) {
                    *sum += amplitude * d;
                }
            }
        }
        sum
    }

    /// Largest displacement of any node at any time, not scaled (m).
    pub fn largest_displacement(&self) -> f64 {
        (0..self.amplitudes.len())
            .flat_map(|time| self.displacements(time))
            .map(|[x, y, z]| (x * x + y * y + z * z).sqrt())
            .fold(0.0, f64::max)
    }

    fn check(&self, times: usize) -> Result<(), AnimationError> {
        check_surface(&self.name, &self.surface)?;
        check_poses(&self.name, &self.poses, times)?;
        let nodes = self.surface.nodes.len();
        for shape in &self.shapes {
            self.check_count("displacements of a mode", shape.displacements.len(), nodes)?;
            check_finite(
                &self.name,
                "a mode",
                shape.displacements.iter().flatten().copied(),
            )?;
        }
        if !self.shapes.is_empty() {
            self.check_count("sets of amplitudes", self.amplitudes.len(), times)?;
        }
        for amplitudes in &self.amplitudes {
            self.check_count("amplitudes at a time", amplitudes.len(), self.shapes.len())?;
            check_finite(&self.name, "an amplitude", amplitudes.iter().copied())?;
        }
        for field in &self.fields {
            self.check_count("values of a field", field.values.len(), nodes)?;
            check_finite(&self.name, "a field", field.values.iter().copied())?;
        }
        Ok(())
    }

    fn check_count(
        &self,
        what: &'static str,
        found: usize,
        expected: usize,
    ) -> Result<(), AnimationError> {
        check_count(&self.name, what, found, expected)
    }
}

impl Animation {
    /// Checks that all data fit together. Every function that makes files calls it first.
    ///
    /// # Errors
    /// See [`AnimationError`].
    pub fn check(&self) -> Result<(), AnimationError> {
        let times = self.times.len();
        if times == 0 {
            return Err(AnimationError::Empty("times"));
        }
        if self.flexible.is_empty() && self.rigid.is_empty() && self.films.surfaces.is_empty() {
            return Err(AnimationError::Empty("bodies"));
        }
        self.films.check(times)?;
        let whole = "the animation";
        check_finite(whole, "the times", self.times.iter().copied())?;
        let fault = self.times.windows(2).find_map(|pair| match pair {
            [before, after] if after <= before => Some(*after),
            _ => None,
        });
        if let Some(value) = fault {
            return Err(AnimationError::Range {
                what: "a time",
                range: "above the one before",
                value,
            });
        }
        if !self.angles.is_empty() {
            check_count(whole, "crank angles", self.angles.len(), times)?;
            check_finite(whole, "the crank angles", self.angles.iter().copied())?;
        }
        for (what, value) in [
            ("the scale of displacements", self.scale),
            ("the slowdown", self.slowdown),
        ] {
            if !(value > 0.0 && (value as f32).is_finite()) {
                return Err(AnimationError::Range {
                    what,
                    range: "a finite number above 0",
                    value,
                });
            }
        }
        for body in &self.flexible {
            body.check(times)?;
        }
        for body in &self.rigid {
            check_poses(&body.name, &body.poses, times)?;
            for part in &body.parts {
                check_part(&body.name, part)?;
            }
        }
        Ok(())
    }
}

fn check_part(body: &str, part: &Part) -> Result<(), AnimationError> {
    let finite =
        |values: &[[f64; 3]]| check_finite(body, "a part", values.iter().flatten().copied());
    match part {
        Part::Box { center, size } => finite(&[*center, *size]),
        Part::Cylinder { from, to, radius } => finite(&[*from, *to, [*radius; 3]]),
        Part::Line { points } => finite(points),
        Part::Mesh(surface) => check_surface(body, surface),
    }
}

fn check_surface(body: &str, surface: &Surface) -> Result<(), AnimationError> {
    check_finite(body, "a node", surface.nodes.iter().flatten().copied())?;
    let nodes = surface.nodes.len();
    match surface
        .triangles
        .iter()
        .flatten()
        .find(|node| **node as usize >= nodes)
    {
        Some(node) => Err(AnimationError::Node {
            body: body.to_owned(),
            node: *node,
            nodes,
        }),
        None => Ok(()),
    }
}

fn check_poses(body: &str, poses: &[Pose], times: usize) -> Result<(), AnimationError> {
    if poses.len() != 1 {
        check_count(body, "poses", poses.len(), times)?;
    }
    let numbers = poses
        .iter()
        .flat_map(|pose| pose.position.into_iter().chain(pose.rotation));
    check_finite(body, "a pose", numbers)
}

fn check_count(
    body: &str,
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), AnimationError> {
    if found == expected {
        return Ok(());
    }
    Err(AnimationError::Count {
        body: body.to_owned(),
        what,
        found,
        expected,
    })
}

fn check_finite(
    body: &str,
    what: &'static str,
    mut values: impl Iterator<Item = f64>,
) -> Result<(), AnimationError> {
    if values.all(|value| (value as f32).is_finite()) {
        return Ok(());
    }
    Err(AnimationError::NotFinite {
        body: body.to_owned(),
        what,
    })
}
