//! The motion of the bodies: positions, orientations and modal amplitudes over the last cycle, for animation
//! and recovery.
//!
//! Columns beside `time` and `cycle.angle`, for each body `B`:
//!
//! | column | meaning |
//! | --- | --- |
//! | `B.position.x`, `.y`, `.z` | r (m, ground axes): origin of the body's frame |
//! | `B.orientation.w`, `.x`, `.y`, `.z` | unit quaternion from the body's to the ground's axes |
//! | `B.amplitude[1]`, … | modal amplitudes a of a flexible body: a node s is at r + A(s + Φ a) |
//!
//! The columns of oil films follow: see [`crate::RecordedField`].
//!
//! The motion covers the last whole cycle, or the whole run of a model without cycle. If it has more than
//! [`SAMPLES`] intervals, it keeps every k-th sample and the last. The frame of a free flexible body is its
//! mean axes, and that of a held one the axes of its supports.

use crate::results::{CYCLE_ANGLE, Results, ResultsError, TIME};

/// Most intervals that are kept. A choice: two degrees of a four-stroke cycle; an animation needs no more.
pub const SAMPLES: usize = 360;
/// Suffix of the name of an analysis in the name of its motion, and so in the file's name.
pub const SUFFIX: &str = ".motion";
/// The motion of one body, read back.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMotion {
    /// Origin of its frame at each time (m, ground axes).
    pub positions: Vec<[f64; 3]>,
    /// Unit quaternion w, x, y, z at each time, body → ground.
    pub orientations: Vec<[f64; 4]>,
    /// Modal amplitudes at each time; empty lists for a rigid body.
    pub amplitudes: Vec<Vec<f64>>,
}

impl BodyMotion {
    /// Reads the motion of a body, by its path.
    ///
    /// # Errors
    /// The name of a missing column.
    pub fn of(motion: &Results, body: &str) -> Result<BodyMotion, ResultsError> {
        let column = |name: &str| {
            let path = format!("{body}.{name}");
            match motion.column(&path) {
                Some(column) => Ok(column.values.as_slice()),
                None => Err(ResultsError::NoColumn(path)),
            }
        };
        let samples = motion.samples();
        let mut found = BodyMotion {
            positions: vec![[0.0; 3]; samples],
            orientations: vec![[0.0; 4]; samples],
            amplitudes: vec![Vec::new(); samples],
        };
        for (at, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let values = column(&format!("position.{axis}"))?;
            for (position, value) in found.positions.iter_mut().zip(values) {
                position[at] = *value;
            }
        }
        for (at, part) in ["w", "x", "y", "z"].into_iter().enumerate() {
            let values = column(&format!("orientation.{part}"))?;
            for (orientation, value) in found.orientations.iter_mut().zip(values) {
                orientation[at] = *value;
            }
        }
        for mode in 1.. {
            let Ok(values) = column(&format!("amplitude[{mode}]")) else {
                break;
            };
            for (amplitudes, value) in found.amplitudes.iter_mut().zip(values) {
                amplitudes.push(*value);
            }
        }
        Ok(found)
    }
}

/// Times (s) of a motion and, if there is a cycle, its crank angles (rad).
pub fn moments(motion: &Results) -> (Vec<f64>, Option<Vec<f64>>) {
    let values = |path| motion.column(path).map(|c| c.values.clone());
    (values(TIME).unwrap_or_default(), values(CYCLE_ANGLE))
}

/// A moment of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// Crank angle (rad), in any cycle.
    Angle(f64),
    /// Time (s).
    Time(f64),
}

impl At {
    /// Index of the sample of `times` (s) and `angles` (°) that is nearest to the moment. `angles` may be
    /// empty. `None` if the motion does not contain the moment.
    pub(crate) fn nearest(
        self,
        times: &[f64],
        angles: &[f64],
        period: Option<f64>,
    ) -> Option<usize> {
        let (places, wanted, period) = match self {
            At::Angle(angle) => (angles, angle.to_degrees(), period.map(f64::to_degrees)),
            At::Time(time) => (times, time, None),
        };
        let (first, last) = (places.first()?, places.last()?);
        let slack = (last - first) / places.len() as f64;
        let distance = |place: f64| match period.filter(|p| *p > 0.0) {
            Some(period) => {
                let off = place - wanted;
                (off - period * (off / period).round()).abs()
            }
            None => (place - wanted).abs(),
        };
        let (index, near) = places
            .iter()
            .map(|place| distance(*place))
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        (near <= slack.abs()).then_some(index)
    }
}

impl std::fmt::Display for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            At::Angle(angle) => write!(f, "{} °CA", angle.to_degrees()),
            At::Time(time) => write!(f, "{} s", time),
        }
    }
}
