//! Places and directions: `*SYSTEM` and `SYSTEM=` of nodes, `*TRANSFORM`, the motion of instances.

use super::lines::{Keyword, Row};
use crate::error::FileProblem;
use crate::fe::vector::{add, cross, subtract};
use crate::read::source::At;
use crate::read::vector::{IDENTITY, Rotation, from_axes, norm, product, rotate, unit};

const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// A rigid motion: rotation, then shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    /// Rotation.
    pub rotation: Rotation,
    /// Shift.
    pub shift: [f64; 3],
}

/// No motion.
pub(super) const STILL: Motion = Motion {
    rotation: IDENTITY,
    shift: [0.0; 3],
};

impl Motion {
    /// The place of a point after the motion.
    pub fn place(&self, x: [f64; 3]) -> [f64; 3] {
        if *self == STILL {
            return x;
        }
        add(self.shift, rotate(&self.rotation, x))
    }

    /// The origin of a point in the text.
    pub fn back(&self, x: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.rotation;
        rotate(&from_axes(a, b, c), subtract(x, self.shift))
    }

    /// Whether it turns.
    pub fn turns(&self) -> bool {
        self.rotation != IDENTITY
    }

    /// Reads the data lines of `*INSTANCE`: a translation, then an axis (two points) and an angle in degrees.
    /// The rotation is about the axis in the assembly, after the translation.
    pub fn read(rows: &[Row]) -> Result<Motion, FileProblem> {
        let mut rows = rows.iter().filter(|row| !row.is_blank());
        let Some(first) = rows.next() else {
            return Ok(STILL);
        };
        let shift = first.vector(0, "the translation of the instance")?;
        let Some(second) = rows.next() else {
            return Ok(Motion {
                rotation: IDENTITY,
                shift,
            });
        };
        let a = second.vector(0, "the axis of rotation")?;
        let b = second.vector(3, "the axis of rotation")?;
        let angle = second.real(6, "the angle of rotation")?;
        if let Some(more) = rows.next() {
            return Err(more.at.problem(
                "*INSTANCE has a third data line",
                "write the translation on the first line, the rotation on the second, and then the keywords of the instance",
            ));
        }
        if angle == 0.0 {
            return Ok(Motion {
                rotation: IDENTITY,
                shift,
            });
        }
        let Some(axis) = unit(subtract(b, a)) else {
            return Err(second.at.problem(
                "the two points of the axis of rotation coincide",
                "give two different points on the axis, then the angle in degrees",
            ));
        };
        let rotation = about(axis, angle);
        // a + R (x + shift − a)
        let shift = add(a, rotate(&rotation, subtract(shift, a)));
        Ok(Motion { rotation, shift })
    }
}

/// The rotation by an angle in degrees about a unit vector: 1 + sin φ ñ + (1 − cos φ) ñ ñ (Rodrigues). Exact
/// for quarter turns.
pub(super) fn about(axis: [f64; 3], degrees: f64) -> Rotation {
    let turn = degrees.rem_euclid(360.0);
    let (sin, cos) = if turn == 90.0 {
        (1.0, 0.0)
    } else if turn == 180.0 {
        (0.0, -1.0)
    } else if turn == 270.0 {
        (-1.0, 0.0)
    } else {
        (libm::sin(turn * RADIANS), libm::cos(turn * RADIANS))
    };
    let [x, y, z] = axis;
    let tilde = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let square = product(&tilde, &tilde);
    let mut rotation = IDENTITY;
    for ((row, first), second) in rotation.iter_mut().zip(tilde).zip(square) {
        for ((value, first), second) in row.iter_mut().zip(first).zip(second) {
            *value += sin * first + (1.0 - cos) * second;
        }
    }
    rotation
}

/// The coordinates in which nodes are given: those of `*SYSTEM`, and cylindrical ones within them.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeSystem {
    motion: Motion,
    cylindrical: bool,
}

impl NodeSystem {
    /// The system of a `*NODE` under the `*SYSTEM` that holds.
    pub fn of(keyword: &Keyword, motion: Motion) -> Result<Self, FileProblem> {
        let cylindrical = match keyword.choice("SYSTEM").as_str() {
            "" | "R" => false,
            "C" => true,
            other => {
                return Err(keyword.problem(
                    &format!("Eng does not read SYSTEM={other}"),
                    "write the nodes in rectangular (R) or cylindrical (C) coordinates",
                ));
            }
        };
        Ok(NodeSystem {
            motion,
            cylindrical,
        })
    }

    /// The place of given coordinates; angles are in degrees.
    pub fn place(&self, x: [f64; 3]) -> [f64; 3] {
        let local = if self.cylindrical {
            let angle = x[1] * RADIANS;
            [x[0] * libm::cos(angle), x[0] * libm::sin(angle), x[2]]
        } else {
            x
        };
        self.motion.place(local)
    }
}

/// Reads `*SYSTEM`: `a, b / c` with the origin a, b on the x axis, c in the x–y plane. Without data the global
/// system holds again. With a alone, all axes are parallel to those of the global system; without c, the z
/// axis is.
pub(super) fn system(rows: &[Row], at: &At) -> Result<Motion, FileProblem> {
    let mut rows = rows.iter().filter(|row| !row.is_blank());
    let Some(first) = rows.next() else {
        return Ok(STILL);
    };
    let a = first.vector(0, "the origin")?;
    if first.fields().len() <= 3 {
        return Ok(Motion {
            rotation: IDENTITY,
            shift: a,
        });
    }
    let x = subtract(first.vector(3, "the point on the x axis")?, a);
    let (x, z) = match rows.next() {
        Some(second) => {
            let c = second.vector(0, "the point in the x-y plane")?;
            (x, cross(x, subtract(c, a)))
        }
        None => ([x[0], x[1], 0.0], [0.0, 0.0, 1.0]),
    };
    axes(x, z)
        .map(|rotation| Motion { rotation, shift: a })
        .ok_or_else(|| {
            at.problem(
                "*SYSTEM: its points lie on one line",
                "move a point: the origin, the point on the x axis and the point in the x-y plane must form a triangle",
            )
        })
}

/// Axes with x along one vector and z along another, which are perpendicular.
fn axes(x: [f64; 3], z: [f64; 3]) -> Option<Rotation> {
    // a choice above rounding, for points on one line but for the last digits of a file
    if norm(z) <= 1e-10 * norm(x) {
        return None;
    }
    let (x, z) = (unit(x)?, unit(z)?);
    Some(from_axes(x, cross(z, x), z))
}

/// The axes of `*TRANSFORM` at nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transform {
    kind: TransformKind,
    a: [f64; 3],
    b: [f64; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TransformKind {
    Rectangular,
    Cylindrical,
    Spherical,
}

impl Transform {
    /// Reads a `*TRANSFORM`. `R`: a on the x axis, b in the x–y plane (the origin is that of the part); `C`:
    /// axis from a to b, freedoms radial, tangential, axial; `S`: centre a, polar axis to b, freedoms radial,
    /// tangential, meridional.
    pub fn read(keyword: &Keyword, rows: &[Row]) -> Result<Self, FileProblem> {
        let kind = match keyword.choice("TYPE").as_str() {
            "" | "R" => TransformKind::Rectangular,
            "C" => TransformKind::Cylindrical,
            "S" => TransformKind::Spherical,
            other => {
                return Err(keyword.problem(
                    &format!("TYPE={other} is no kind of coordinates"),
                    "write TYPE=R (rectangular), C (cylindrical) or S (spherical)",
                ));
            }
        };
        Self::of_points(kind, keyword, rows)
    }

    fn of_points(
        kind: TransformKind,
        keyword: &Keyword,
        rows: &[Row],
    ) -> Result<Self, FileProblem> {
        let Some(row) = rows.iter().find(|row| !row.is_blank()) else {
            return Err(keyword.problem(
                "its data line is missing",
                "write the coordinates of the points a and b on the next line",
            ));
        };
        Self::of_row(kind, row, 0)
    }

    /// With the points a and b from an entry of a line on.
    fn of_row(kind: TransformKind, row: &Row, first: usize) -> Result<Self, FileProblem> {
        Ok(Transform {
            kind,
            a: row.vector(first, "point a")?,
            b: row.vector(first + 3, "point b")?,
        })
    }

    /// The axes of an `*ORIENTATION`: `SYSTEM=RECTANGULAR` (the default) or `CYLINDRICAL`, with points as in
    /// [`Self::read`]; `None` for another system.
    pub fn of_orientation(keyword: &Keyword, rows: &[Row]) -> Result<Option<Self>, FileProblem> {
        match kind_of_orientation(keyword) {
            Some(kind) => Self::of_points(kind, keyword, rows).map(Some),
            None => Ok(None),
        }
    }

    /// The axes of an `*ORIENTATION` whose points are in a line of its distribution, behind the element.
    pub fn of_distribution(keyword: &Keyword, line: &Row) -> Result<Option<Self>, FileProblem> {
        match kind_of_orientation(keyword) {
            Some(kind) => Self::of_row(kind, line, 1).map(Some),
            None => Ok(None),
        }
    }

    /// With the points a and b counted from this one.
    pub fn counted_from(self, origin: [f64; 3]) -> Self {
        Transform {
            a: subtract(self.a, origin),
            b: subtract(self.b, origin),
            ..self
        }
    }

    /// Point a, the origin of curvilinear coordinates.
    pub fn origin(&self) -> [f64; 3] {
        self.a
    }

    /// Whether all nodes have the same axes.
    pub fn is_rectangular(&self) -> bool {
        self.kind == TransformKind::Rectangular
    }

    /// The axes at a place on the axis of a cylinder, where the radial direction is arbitrary; `None` elsewhere and for
    /// other kinds. The direction is CalculiX': in the x–y plane for an axis along z, else with 1 as its y (or z)
    /// component.
    pub fn axes_on_axis(&self, place: [f64; 3]) -> Option<Rotation> {
        if self.kind != TransformKind::Cylindrical || self.axes_at(place).is_some() {
            return None;
        }
        let [x, y, z] = unit(subtract(self.b, self.a))?;
        // the length below which a component of the axis counts as zero there
        let small = 1e-10;
        let radial = if x.abs() > small {
            [-y / x, 1.0, 0.0]
        } else if y.abs() > small {
            [0.0, -z / y, 1.0]
        } else {
            [1.0, 0.0, -x / z]
        };
        axes(radial, [x, y, z])
    }

    /// The axes at a place; `None` if they are not determined.
    pub fn axes_at(&self, place: [f64; 3]) -> Option<Rotation> {
        match self.kind {
            TransformKind::Rectangular => {
                let z = cross(self.a, self.b);
                // as in [`axes`]
                if norm(z) <= 1e-10 * norm(self.a) * norm(self.b) {
                    return None;
                }
                axes(self.a, z)
            }
            TransformKind::Cylindrical => {
                let z = unit(subtract(self.b, self.a))?;
                across(subtract(place, self.a), z).and_then(|x| axes(x, z))
            }
            TransformKind::Spherical => {
                let x = unit(subtract(place, self.a))?;
                across(subtract(self.b, self.a), x).and_then(|z| axes(x, z))
            }
        }
    }
}

/// The kind of the axes of an `*ORIENTATION`; `None` for a system that Eng does not read.
fn kind_of_orientation(keyword: &Keyword) -> Option<TransformKind> {
    match keyword.choice("SYSTEM").as_str() {
        "" | "RECTANGULAR" => Some(TransformKind::Rectangular),
        "CYLINDRICAL" => Some(TransformKind::Cylindrical),
        _ => None,
    }
}

/// The part of a vector across a unit vector; `None` if it is only rounding.
fn across(a: [f64; 3], along: [f64; 3]) -> Option<[f64; 3]> {
    let length = a.iter().zip(along).map(|(a, b)| a * b).sum::<f64>();
    let across = subtract(a, along.map(|x| x * length));
    // as in [`axes`]
    (norm(across) > 1e-10 * norm(a)).then_some(across)
}
