//! Plain data of a film: geometry, rule, openings, profiles and cells.
//!
//! All numbers are SI.

use crate::error::SourceError;
use crate::surfaces::{Roughness, Thinning};
use crate::waves::DEGREES;
use eng_system::surface::SurfaceShape as Shape;

/// The rule where the pressure of the film would be negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cavitation {
    /// p ≥ 0, and ∂p/∂n = 0 at the edge of the cavity (Swift 1932, Stieber 1933): a linear complementarity
    /// problem. Flow into the cavity is not followed further.
    Reynolds,
    /// The linear equation, whose negative pressures are cut off afterwards (Gümbel 1921). For comparison: it does
    /// not conserve oil.
    Half,
    /// p ≥ 0, ϑ ≤ 1, p (1 − ϑ) = 0 with the film content ϑ (Jakobsson & Floberg 1957, Olsson 1965): oil is
    /// conserved everywhere.
    MassConserving,
}

/// The oil at an opening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feed {
    /// Full of oil at a pressure that is an input.
    Pressure,
    /// Starved: oil at the cavitation pressure fills this share of the gap.
    Content(f64),
}

/// The part of a bearing that has an opening.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// The shell. The edges of the opening become lines of the grid.
    #[default]
    Shell,
    /// The pin. The opening turns with it over the cells: see `film/src/turning.rs`.
    Pin,
}

/// An opening that covers a rectangle of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opening {
    /// The part that has it.
    pub on: Part,
    /// Edges around, rad from the x of this part about the shell's z; the second above the first, by 2π at most. Both
    /// edges of an opening of the shell may be equal: a line.
    pub around: [f64; 2],
    /// Edges across, m from mid width. An edge beyond an end opens the end.
    pub across: [f64; 2],
    /// The oil in it.
    pub feed: Feed,
}

impl Opening {
    /// Whether it goes around the whole part.
    pub(crate) fn all_around(&self) -> bool {
        // a turn, up to the rounding of angles in degrees
        self.around[1] - self.around[0] >= std::f64::consts::TAU * (1.0 - 1e-12)
    }

    /// A groove along the axis: `at` rad, `length` m along the axis about mid width, `width` m around;
    /// `radius` m that of the bearing.
    #[must_use]
    pub fn axial_groove(at: f64, length: f64, width: f64, radius: f64, feed: Feed) -> Self {
        let half = width / (2.0 * radius);
        Opening {
            on: Part::Shell,
            around: [at - half, at + half],
            across: [-length / 2.0, length / 2.0],
            feed,
        }
    }

    /// A groove around, from an angle to another (rad), `width` m across about mid width.
    #[must_use]
    pub fn ring_groove(from: f64, to: f64, width: f64, feed: Feed) -> Self {
        Opening {
            on: Part::Shell,
            around: [from, to],
            across: [-width / 2.0, width / 2.0],
            feed,
        }
    }

    /// A round hole at an angle (rad) and a distance from mid width (m), as a square of the same logarithmic
    /// capacity: the flow around both is the same some diameters away. The capacity of a disc is its radius,
    /// that of a square 0.590170 of its side (Γ(1/4)²/(4 π^(3/2)); Pólya & Szegő, Isoperimetric Inequalities,
    /// 1951), so the side is 0.847213 of the diameter.
    #[must_use]
    pub fn hole(at: f64, offset: f64, diameter: f64, radius: f64, feed: Feed) -> Self {
        let half = 0.847_213_084_793_979 * diameter / 2.0;
        Opening {
            on: Part::Shell,
            around: [at - half / radius, at + half / radius],
            across: [offset - half, offset + half],
            feed,
        }
    }
}

/// One change of the gap; positive numbers open it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// `depth cos²(θ − at)`: an elliptic ("lemon") bore, widest at `at` and opposite of it.
    Lemon {
        /// Opening at the widest place, m.
        depth: f64,
        /// Widest place, rad.
        at: f64,
    },
    /// `distance cos(θ − at)`: a bore beside the axis.
    Offset {
        /// Distance of the centre, m.
        distance: f64,
        /// Direction of the centre, rad.
        at: f64,
    },
    /// `depth (2z/B)²`: a barrel, or rounded ends.
    Barrel {
        /// Opening at both ends, m.
        depth: f64,
    },
    /// `depth 2z/B`: a cone.
    Taper {
        /// Opening at the end with positive z, closing at the other, m.
        depth: f64,
    },
    /// `depth cos²(π (θ − at)/(2 around))` within `around` of `at`, else nothing: relief at a split line.
    Relief {
        /// Opening at its middle, m.
        depth: f64,
        /// Reach to each side, rad.
        around: f64,
        /// Its middle, rad.
        at: f64,
    },
}

impl Profile {
    /// Change of the gap (m) and its slope by θ (m/rad) at an angle and at ζ = 2z/B.
    pub(crate) fn value(&self, angle: f64, zeta: f64) -> (f64, f64) {
        match *self {
            Profile::Lemon { depth, at } => {
                let (sin, cos) = libm::sincos(angle - at);
                (depth * cos * cos, -2.0 * depth * cos * sin)
            }
            Profile::Offset { distance, at } => {
                let (sin, cos) = libm::sincos(angle - at);
                (distance * cos, -distance * sin)
            }
            Profile::Barrel { depth } => (depth * zeta * zeta, 0.0),
            Profile::Taper { depth } => (depth * zeta, 0.0),
            Profile::Relief { depth, around, at } => {
                let turn = std::f64::consts::TAU;
                let turned = (angle - at + turn / 2.0).rem_euclid(turn) - turn / 2.0;
                if turned.abs() >= around {
                    return (0.0, 0.0);
                }
                let rate = std::f64::consts::FRAC_PI_2 / around;
                let (sin, cos) = libm::sincos(rate * turned);
                (depth * cos * cos, -2.0 * depth * rate * cos * sin)
            }
        }
    }

    /// Whether the change is the same in both halves of the bearing.
    pub(crate) fn symmetric(&self) -> bool {
        !matches!(self, Profile::Taper { depth } if *depth != 0.0)
    }
}

/// Mean of a wave of this number around over a sector of cells (rad), as a share of its value in the middle.
pub(crate) fn mean_over(waves: u32, sector: f64) -> f64 {
    mean_of_wave(f64::from(waves) * sector / 2.0)
}

/// `sin x/x`. Its limit 1 at x = 0; x in rad.
pub(crate) fn mean_of_wave(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { libm::sin(x) / x }
}

/// The ends of the bearing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Held at the end pressure, an input.
    Open,
    /// No flow through them: a film without end flow (the "infinitely long" bearing), or seals.
    Sealed,
}

/// The slope of the pressure at faces of cells and places with fixed pressure: ends, and edges of openings of the shell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EdgeSlope {
    /// The slope of a straight line through the middle of one cell, of first order. The damping of the rule
    /// [`Cavitation::Reynolds`] is symmetric to rounding, and openings of both parts have the same equations.
    OneCell,
    /// The slope of a parabola through the means of two cells, of second order.
    #[default]
    TwoCells,
}

/// Cells of one direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Lines {
    /// This number of cells, of equal size between the edges of openings.
    Equal(usize),
    /// Stated lines, rising: around from 0 to 2π (rad), or across from one end to the other (m; of a half
    /// bearing from 0).
    At(Vec<f64>),
}

/// The constant data of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSource {
    /// R, m.
    pub radius: f64,
    /// B, m.
    pub width: f64,
    /// Radial clearance c, m.
    pub clearance: f64,
    /// Rule where the pressure would be negative.
    pub cavitation: Cavitation,
    /// Ends.
    pub ends: Ends,
    /// Openings of both parts. Where one of the pin lies over one of the shell, the shell's holds.
    pub openings: Vec<Opening>,
    /// Sum of changes of the gap that belong to the shell.
    pub profile: Vec<Profile>,
    /// Sum of changes of the gap that turn with the pin; their angles count from the pin's x.
    pub pin_profile: Vec<Profile>,
    /// Radial deflections that are inputs; positive opens the gap.
    pub shapes: Vec<Shape>,
    /// Width of the surface that the shapes belong to, m: their ζ is −1 and 1 at its ends, in the middle of
    /// which is z = 0.
    pub shape_width: f64,
    /// Gap f (m) below which the equation of smooth surfaces has `f²/(2f − h)` instead of the gap h, which stays
    /// positive for every h. Only solutions with a gap above the floor have a meaning. With 0, surfaces that touch
    /// are an error. Rough surfaces have no floor.
    pub floor: f64,
    /// α of Barus' law `μ exp(α p)`, 1/Pa; 0 for oil whose viscosity does not depend on pressure.
    pub piezo: f64,
    /// Roughness of both surfaces; none for smooth ones.
    pub rough: Option<Roughness>,
    /// Thinning of the oil in shear; none for oil whose viscosity does not depend on it.
    pub thinning: Option<Thinning>,
    /// Slope of the pressure at fixed places.
    pub edges: EdgeSlope,
    /// Cells around.
    pub around: Lines,
    /// Cells across; of a half bearing from mid width to its end.
    pub across: Lines,
    /// Solves the half z ≥ 0 of an aligned bearing that is symmetric about mid width.
    pub half_width: bool,
}

impl FilmSource {
    /// A plain bearing with open ends: `radius`, `width`, `clearance` (m) on equal cells around and across.
    #[must_use]
    pub fn plain(
        radius: f64,
        width: f64,
        clearance: f64,
        cavitation: Cavitation,
        cells: [usize; 2],
    ) -> Self {
        FilmSource {
            radius,
            width,
            clearance,
            cavitation,
            ends: Ends::Open,
            openings: Vec::new(),
            profile: Vec::new(),
            pin_profile: Vec::new(),
            shapes: Vec::new(),
            shape_width: width,
            floor: 0.0,
            piezo: 0.0,
            rough: None,
            thinning: None,
            edges: EdgeSlope::TwoCells,
            around: Lines::Equal(cells[0]),
            across: Lines::Equal(cells[1]),
            half_width: false,
        }
    }

    /// Sum of the shell's profile. In m, at an angle (rad) and `zeta` = 2 z/B; positive numbers open the gap.
    pub(crate) fn shell_profile(&self, angle: f64, zeta: f64) -> f64 {
        self.profile
            .iter()
            .map(|profile| profile.value(angle, zeta).0)
            .sum()
    }

    /// Sum of the pin's profile and of its slopes by θ; the angle counts from the pin's x.
    pub(crate) fn pin_profile(&self, angle: f64, zeta: f64) -> (f64, f64) {
        let mut sum = (0.0, 0.0);
        for profile in &self.pin_profile {
            let (value, slope) = profile.value(angle, zeta);
            sum = (sum.0 + value, sum.1 + slope);
        }
        sum
    }

    /// Refuses numbers out of range and openings that no film can have.
    pub(crate) fn check(&self) -> Result<(), SourceError> {
        for (name, value) in [
            ("radius", self.radius),
            ("width", self.width),
            ("radial clearance", self.clearance),
            ("width of the shapes", self.shape_width),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SourceError::Range {
                    name,
                    value,
                    range: "a positive number",
                });
            }
        }
        if !(self.floor >= 0.0 && self.floor < self.clearance) {
            return Err(SourceError::Range {
                name: "floor of the gap",
                value: self.floor,
                range: "0 or a part of the clearance",
            });
        }
        if let Some(shape) = self
            .shapes
            .iter()
            .find(|shape| shape.across as usize >= DEGREES)
        {
            return Err(SourceError::Range {
                name: "degree across of a shape",
                value: f64::from(shape.across),
                range: "0 to 15",
            });
        }
        if !(self.piezo >= 0.0 && self.piezo.is_finite()) {
            return Err(SourceError::Range {
                name: "pressure coefficient",
                value: self.piezo,
                range: "0 or a positive number",
            });
        }
        if let Some(rough) = &self.rough {
            rough.check()?;
        }
        if let Some(thinning) = &self.thinning {
            thinning.check()?;
        }
        self.check_profile()?;
        for (number, opening) in self.openings.iter().enumerate() {
            self.check_opening(number + 1, opening)?;
        }
        for (second, other) in self.openings.iter().enumerate() {
            for (first, opening) in self.openings[..second].iter().enumerate() {
                if opening.on == other.on && overlap(opening, other) {
                    return Err(SourceError::Overlap {
                        first: first + 1,
                        second: second + 1,
                    });
                }
            }
        }
        if !self.half_width {
            return Ok(());
        }
        let mirrored =
            // up to the rounding of stated edges
            |opening: &Opening| (opening.across[0] + opening.across[1]).abs() <= 1e-12 * self.width;
        let part = if !self.openings.iter().all(mirrored) {
            "openings"
        } else if !self
            .profile
            .iter()
            .chain(&self.pin_profile)
            .all(Profile::symmetric)
        {
            "profiles"
        } else if self.shapes.iter().any(|shape| shape.across % 2 == 1) {
            "shapes"
        } else {
            return Ok(());
        };
        Err(SourceError::NotSymmetric { part })
    }

    /// Refuses profiles that leave no gap: around a circle across the axis, a place of the pin changes no mean of the gap.
    fn check_profile(&self) -> Result<(), SourceError> {
        // a choice: degrees, and twenty parts of each half of the width. A mean over a circle of a sum of few
        // waves is exact on a grid as fine.
        const AROUND: u32 = 360;
        const ACROSS: i32 = 20;
        for across in -ACROSS..=ACROSS {
            let zeta = f64::from(across) / f64::from(ACROSS);
            let mean = (0..AROUND)
                .map(|at| std::f64::consts::TAU * f64::from(at) / f64::from(AROUND))
                .map(|angle| self.shell_profile(angle, zeta) + self.pin_profile(angle, zeta).0)
                .sum::<f64>()
                / f64::from(AROUND);
            let gap = self.clearance + mean;
            if gap <= 0.0 {
                let across = zeta * self.width / 2.0;
                return Err(SourceError::Closed { gap, across });
            }
        }
        Ok(())
    }

    fn check_opening(&self, number: usize, opening: &Opening) -> Result<(), SourceError> {
        let [from, to] = opening.around;
        let turn = std::f64::consts::TAU;
        // a turn, up to the rounding of angles in degrees
        if !(to >= from && to - from <= turn * (1.0 + 1e-12) && from.is_finite()) {
            return Err(SourceError::EmptyOpening {
                opening: number,
                direction: "around",
                from,
                to,
            });
        }
        if opening.on == Part::Pin && (to == from || opening.feed != Feed::Pressure) {
            return Err(SourceError::PinOpening { opening: number });
        }
        let [low, high] = opening.across;
        if !(high > low && low.is_finite() && high.is_finite()) {
            return Err(SourceError::EmptyOpening {
                opening: number,
                direction: "across",
                from: low,
                to: high,
            });
        }
        if let Feed::Content(content) = opening.feed
            && !(0.0..=1.0).contains(&content)
        {
            return Err(SourceError::Range {
                name: "content of an opening",
                value: content,
                range: "in 0 to 1",
            });
        }
        let end = self.width / 2.0;
        if high <= -end || low >= end {
            return Err(SourceError::BesideBearing {
                opening: number,
                width: self.width,
            });
        }
        Ok(())
    }

    /// An edge closer than this to another one cannot be distinguished from it after the rounding of a sum, m.
    fn near(&self) -> f64 {
        1e-9 * self.width
    }

    /// Openings at whose corners the edge of another place begins: an open end, or another opening. With different
    /// pressures the flow at such a corner has no limit. A ring around the shell has no corners.
    #[must_use]
    pub fn corners(&self) -> Vec<(usize, Beside)> {
        let mut found = Vec::new();
        for (at, opening) in self.openings.iter().enumerate() {
            let ring = opening.on == Part::Shell && opening.all_around();
            let [low, high] = opening.across;
            let inside = self.width / 2.0 - low.abs().max(high.abs()) >= self.near();
            if self.ends == Ends::Open && !ring && !inside {
                found.push((at, Beside::End));
            }
            let others = self.openings[..at].iter().enumerate();
            let touching = others.filter(|(_, other)| self.land(opening, other) < self.near());
            let touching = touching.filter(|(_, other)| !(ring && other.all_around()));
            found.extend(touching.map(|(other, _)| (at, Beside::Opening(other))));
        }
        found
    }

    /// The narrowest land between an opening and an open end or another opening, m, with both of its sides. Where they
    /// touch there is none.
    #[must_use]
    pub fn narrowest_land(&self) -> Option<(f64, usize, Beside)> {
        let mut least: Option<(f64, usize, Beside)> = None;
        let mut look = |land: f64, at: usize, beside: Beside| {
            if land >= self.near() && least.is_none_or(|(least, ..)| land < least) {
                least = Some((land, at, beside));
            }
        };
        for (at, opening) in self.openings.iter().enumerate() {
            for edge in opening.across.iter().filter(|_| self.ends == Ends::Open) {
                look(self.width / 2.0 - edge.abs(), at, Beside::End);
            }
            for (other, beside) in self.openings[..at].iter().enumerate() {
                look(self.land(opening, beside), at, Beside::Opening(other));
            }
        }
        least
    }

    /// Distance of two openings of one part, m; infinite for those of two parts, which move past each other.
    fn land(&self, one: &Opening, other: &Opening) -> f64 {
        if one.on != other.on {
            return f64::INFINITY;
        }
        let turn = std::f64::consts::TAU;
        let behind = |one: &Opening, other: &Opening| {
            (other.around[0] - one.around[0]).rem_euclid(turn) - (one.around[1] - one.around[0])
        };
        let around = behind(one, other).min(behind(other, one)).max(0.0);
        let across = (other.across[0] - one.across[1]).max(one.across[0] - other.across[1]);
        libm::hypot(self.radius * around, across.max(0.0))
    }
}

/// The other side of a land.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beside {
    /// The nearest open end.
    End,
    /// The opening of this number, from 0.
    Opening(usize),
}

/// Whether two openings share more than an edge.
fn overlap(one: &Opening, other: &Opening) -> bool {
    let turn = std::f64::consts::TAU;
    let across = one.across[0].max(other.across[0]) < one.across[1].min(other.across[1]);
    let around = [-1.0, 0.0, 1.0].iter().any(|turns| {
        let shift = turn * turns + ((one.around[0] - other.around[0]) / turn).round() * turn;
        let (from, to) = (other.around[0] + shift, other.around[1] + shift);
        let shared = one.around[1].min(to) - one.around[0].max(from);
        // a line inside of a rectangle shares nothing but lies in it
        // openings whose edges meet share rounding (rad)
        shared > 1e-12 || (shared >= 0.0 && (to == from || one.around[0] == one.around[1]))
    });
    across && around
}
