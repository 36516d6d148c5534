//! Rotations, and local axes in space: the same everywhere, or those of cylindrical or spherical coordinates at each
//! place.

use serde::{Deserialize, Serialize};

/// A rotation matrix, row-major; its columns are the axes.
pub(crate) type Rotation = [[f64; 3]; 3];

/// No rotation.
pub(crate) const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Frame → basic.
pub(crate) fn rotate(rotation: &Rotation, a: [f64; 3]) -> [f64; 3] {
    rotation.map(|row| row[0] * a[0] + row[1] * a[1] + row[2] * a[2])
}

/// The rotation with these axes as columns.
pub(crate) fn from_axes(x: [f64; 3], y: [f64; 3], z: [f64; 3]) -> Rotation {
    [[x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]]
}

/// First rotation after the second: `a · b`.
pub(crate) fn product(a: &Rotation, b: &Rotation) -> Rotation {
    let column = |j: usize| rotate(a, b.map(|row| row.get(j).copied().unwrap_or(0.0)));
    from_axes(column(0), column(1), column(2))
}

/// Whether a matrix is a rotation.
pub(crate) fn is_rotation(rotation: &[[f64; 3]; 3]) -> bool {
    (0..3).all(|i| {
        (0..3).all(|j| {
            let product: f64 = (0..3).map(|k| rotation[i][k] * rotation[j][k]).sum();
            // a choice above rounding: Eng makes the axes from the vectors of a file
            (product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-9
        })
    })
}

/// Kind of coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Coordinates {
    /// x, y, z.
    Rectangular,
    /// r, θ in degrees, z.
    Cylindrical,
    /// r, θ from +z, φ in degrees.
    Spherical,
}

/// Axes as a function of the place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocalAxes {
    /// Their coordinates: cylindrical axes are radial, tangential and axial, spherical ones radial, polar and azimuthal.
    pub coordinates: Coordinates,
    /// Origin of the coordinates in the basic frame.
    pub origin: [f64; 3],
    /// Rotation coordinates → basic. Its columns are the axes x, y, z of the coordinates.
    pub rotation: [[f64; 3]; 3],
    /// Rotation of the axes within those of the coordinates, the same everywhere.
    pub turn: [[f64; 3]; 3],
}

impl LocalAxes {
    /// Those of the basic frame.
    pub const BASIC: LocalAxes = LocalAxes {
        coordinates: Coordinates::Rectangular,
        origin: [0.0; 3],
        rotation: IDENTITY,
        turn: IDENTITY,
    };

    /// The same axes everywhere, as the columns of a rotation.
    pub const fn fixed(rotation: [[f64; 3]; 3]) -> Self {
        LocalAxes {
            rotation,
            ..LocalAxes::BASIC
        }
    }

    /// Whether they are the same everywhere.
    pub fn is_rectangular(&self) -> bool {
        self.coordinates == Coordinates::Rectangular
    }

    /// The rotation local → basic at a place of the basic frame; its columns are the axes there. On the axis of
    /// curvilinear coordinates the angle counts as zero.
    pub fn at(&self, place: [f64; 3]) -> Rotation {
        let own = match self.is_rectangular() {
            true => self.rotation,
            false => product(&self.rotation, &self.curvilinear(place)),
        };
        match self.turn == IDENTITY {
            true => own,
            false => product(&own, &self.turn),
        }
    }

    /// The axes of cylindrical or spherical coordinates at a place, along x, y, z of the coordinates.
    fn curvilinear(&self, place: [f64; 3]) -> Rotation {
        let length = |a: [f64; 3]| libm::hypot(libm::hypot(a[0], a[1]), a[2]);
        let [ox, oy, oz] = self.origin;
        let d = [place[0] - ox, place[1] - oy, place[2] - oz];
        let [x, y, z] = [0, 1, 2].map(|j: usize| {
            let along = self.rotation.iter().zip(d);
            along.map(|(row, d)| row[j] * d).sum::<f64>()
        });
        let across = libm::hypot(x, y);
        // the rounding error of a place on the axis must not turn the axes
        let (cos, sin) = if across > 1e-12 * length(d).max(length(self.origin)) {
            (x / across, y / across)
        } else {
            (1.0, 0.0)
        };
        if self.coordinates == Coordinates::Spherical {
            let r = libm::hypot(across, z);
            let (s, c) = if r > 0.0 {
                (across / r, z / r)
            } else {
                (0.0, 1.0)
            };
            return from_axes(
                [s * cos, s * sin, c],
                [c * cos, c * sin, -s],
                [-sin, cos, 0.0],
            );
        }
        from_axes([cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0])
    }
}
