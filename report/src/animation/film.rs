//! The pressure of fluid films on the surfaces that carry them: a hill over each surface, in colours.
//!
//! A film of pressure p on a node with the outward direction n is drawn at `s + H (p − low)/(high − low) n`. H
//! (m), low and high are the same for all films of an animation, so the hills can be compared.

use super::{AnimationError, NodeField, Pose, Surface, check_count, check_finite};
use super::{check_poses, check_surface};

/// A film on a surface of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSurface {
    /// As in the model: `main[3]`.
    pub name: String,
    /// The surface in the axes of its body.
    pub surface: Surface,
    /// One direction of unit length for each node, in which its hill is drawn.
    pub outward: Vec<[f64; 3]>,
    /// Poses of the body: one for each time; a single pose for a body at rest.
    pub poses: Vec<Pose>,
    /// The times with known pressures (indices, increasing). Pressures between them lie on straight lines.
    pub moments: Vec<usize>,
    /// For each of the moments, the pressure at each node.
    pub pressures: Vec<Vec<f64>>,
}

/// The films of an animation with their common scale.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Films {
    /// The films.
    pub surfaces: Vec<FilmSurface>,
    /// Unit of the pressures: `MPa`.
    pub unit: String,
    /// Height of the hill of the highest pressure (m).
    pub height: f64,
}

impl Films {
    /// Lowest and highest pressure of all films; zero and zero without films.
    pub(crate) fn range(&self) -> [f64; 2] {
        let all = || {
            self.surfaces
                .iter()
                .flat_map(|film| &film.pressures)
                .flatten()
        };
        if all().next().is_none() {
            return [0.0; 2];
        }
        [
            all().copied().fold(f64::INFINITY, f64::min),
            all().copied().fold(f64::NEG_INFINITY, f64::max),
        ]
    }

    /// Displacements of a film's nodes for its pressures at one of its moments (m).
    pub(crate) fn hill(&self, film: &FilmSurface, pressures: &[f64]) -> Vec<[f64; 3]> {
        let [low, high] = self.range();
        let per_unit = if high > low {
            self.height / (high - low)
        } else {
            0.0
        };
        let nodes = film.outward.iter().zip(pressures);
        nodes
            .map(|(n, p)| n.map(|n| n * per_unit * (p - low)))
            .collect()
    }

    pub(super) fn check(&self, times: usize) -> Result<(), AnimationError> {
        let drawn = self.height > 0.0 && (self.height as f32).is_finite();
        if !self.surfaces.is_empty() && !drawn {
            return Err(AnimationError::Range {
                what: "the height of films",
                range: "a finite number above 0",
                value: self.height,
            });
        }
        self.surfaces.iter().try_for_each(|film| film.check(times))
    }
}

impl FilmSurface {
    /// Shares of the moments in the pressures at a time (index).
    pub(super) fn shares(&self, time: usize) -> Vec<f64> {
        let mut shares = vec![0.0; self.moments.len()];
        let after = self.moments.partition_point(|moment| *moment <= time);
        let last = self.moments.len().saturating_sub(1);
        let (from, to) = (after.saturating_sub(1).min(last), after.min(last));
        let (Some(first), Some(second)) = (self.moments.get(from), self.moments.get(to)) else {
            return shares;
        };
        let part = match second.checked_sub(*first) {
            Some(width) if width > 0 => (time as f64 - *first as f64) / width as f64,
            _ => 0.0,
        };
        shares[from] += 1.0 - part;
        shares[to] += part;
        shares
    }

    /// Pressures at a time (index) as a field.
    pub(crate) fn field(&self, time: usize, unit: &str) -> NodeField {
        let mut values = vec![0.0; self.surface.nodes.len()];
        for (share, pressures) in self.shares(time).iter().zip(&self.pressures) {
            for (value, pressure) in values.iter_mut().zip(pressures) {
                *value += share * pressure;
            }
        }
        NodeField {
            name: PRESSURE.to_owned(),
            unit: unit.to_owned(),
            values,
        }
    }

    /// Refuses shapes, moments and pressures that do not fit.
    pub(crate) fn check(&self, times: usize) -> Result<(), AnimationError> {
        let name = &self.name;
        check_surface(name, &self.surface)?;
        check_poses(name, &self.poses, times)?;
        let nodes = self.surface.nodes.len();
        check_count(name, "directions of nodes", self.outward.len(), nodes)?;
        check_finite(name, "a direction", self.outward.iter().flatten().copied())?;
        check_count(
            name,
            "sets of pressures",
            self.pressures.len(),
            self.moments.len(),
        )?;
        for pressures in &self.pressures {
            check_count(name, "pressures at a moment", pressures.len(), nodes)?;
            check_finite(name, "a pressure", pressures.iter().copied())?;
        }
        let rising = self.moments.windows(2).all(|pair| pair[0] < pair[1]);
        let last = self.moments.last();
        match last.filter(|last| rising && **last < times) {
            Some(_) => Ok(()),
            None => Err(AnimationError::Range {
                what: "a moment of a film",
                range: "the index of a time above the one before",
                value: last.map_or(f64::NAN, |last| *last as f64),
            }),
        }
    }
}

/// The name of the choice of colours.
pub(super) const PRESSURE: &str = "pressure of films";
