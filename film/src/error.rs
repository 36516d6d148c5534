//! Errors of film models and of their solution.

use crate::inputs::SUPPLY;
use thiserror::Error;

/// A place in the film: angle from the shell's x about its z, and distance across from mid width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Angle, rad, in [0, 2π).
    pub angle: f64,
    /// Distance from mid width along the axis, m.
    pub across: f64,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (degrees, millimetres) = (self.angle.to_degrees(), self.across * 1e3);
        write!(f, "{degrees:.1}° and {millimetres:.2} mm from mid width")
    }
}

/// A number with the unit in which texts state numbers of this name.
fn shown(name: &str, si: f64) -> String {
    let (unit, size) = match name {
        "radius" | "width" | "width of the shapes" | "across" => (" mm", 1e-3),
        "radial clearance" | "floor of the gap" | "roughness" | "gap" => (" um", 1e-6),
        "viscosity" => (" mPa*s", 1e-3),
        "pressure of an opening or end" => (" bar", 1e5),
        "pressure coefficient" => (" GPa^-1", 1e-9),
        "modulus of the asperities" => (" GPa", 1e9),
        "shear rate" => (" s^-1", 1.0),
        "step" => (" s", 1.0),
        "around" => (" deg", std::f64::consts::PI / 180.0),
        _ => ("", 1.0),
    };
    // twelve digits: the rest is the rounding of the unit
    let rounded: f64 = format!("{:.11e}", si / size).parse().unwrap_or(si / size);
    format!("{rounded}{unit}")
}

/// Name of an input.
fn input_name(input: usize) -> &'static str {
    const NAMES: [&str; SUPPLY] = [
        "eccentricity (x)",
        "eccentricity (y)",
        "rate of the eccentricity (x)",
        "rate of the eccentricity (y)",
        "tilt (x)",
        "tilt (y)",
        "rate of the tilt (x)",
        "rate of the tilt (y)",
        "spin",
        "turn",
        "viscosity",
        "pressure at the ends",
    ];
    NAMES
        .get(input)
        .copied()
        .unwrap_or("pressure of an opening, or the deflection,")
}

/// A film that cannot be made of its data.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SourceError {
    /// A number out of its range.
    #[error("the {name} of a film is {}: it must be {range}", shown(name, *value))]
    Range {
        /// Name of the number.
        name: &'static str,
        /// Its value, SI.
        value: f64,
        /// The allowed range.
        range: &'static str,
    },
    /// Fewer cells than the grid needs.
    #[error("a film has {cells} cells {direction}, but its openings need at least {needed}")]
    TooFewCells {
        /// `around` or `across`.
        direction: &'static str,
        /// Stated number.
        cells: usize,
        /// Least number.
        needed: usize,
    },
    /// Fewer lines than the grid needs.
    #[error("a film has {lines} lines {direction}, but needs at least {needed}")]
    TooFewLines {
        /// `around` or `across`.
        direction: &'static str,
        /// Stated number.
        lines: usize,
        /// Least number.
        needed: usize,
    },
    /// A line at a wrong place.
    #[error("a line {direction} of a film is at {}: it must be {range}", shown(direction, *at))]
    Line {
        /// `around` or `across`.
        direction: &'static str,
        /// Its place, rad or m.
        at: f64,
        /// The allowed place.
        range: &'static str,
    },
    /// An opening between the lines.
    #[error("an opening of a film has an edge at {} {direction}, where the film has no line", shown(direction, *edge))]
    NoLineAtEdge {
        /// `around` or `across`.
        direction: &'static str,
        /// The edge, rad or m.
        edge: f64,
    },
    /// An opening without reach.
    #[error(
        "opening {opening} of a film reaches from {} to {} {direction}: the second must lie above the first{}",
        shown(direction, *from),
        shown(direction, *to),
        if *direction == "around" { ", by 360 deg at most" } else { "" }
    )]
    EmptyOpening {
        /// Number of the opening, from 1.
        opening: usize,
        /// `around` or `across`.
        direction: &'static str,
        /// First edge, rad or m.
        from: f64,
        /// Second edge.
        to: f64,
    },
    /// An opening beside the bearing.
    #[error(
        "opening {opening} of a film lies beyond the ends of the bearing, whose width is {}",
        shown("width", *width)
    )]
    BesideBearing {
        /// Number of the opening, from 1.
        opening: usize,
        /// Width of the bearing, m.
        width: f64,
    },
    /// A profile that closes the gap.
    #[error(
        "the profile of a film closes its gap: {} from mid width the mean gap is {}, so the surfaces touch at every place of \
         the pin; positive numbers of a profile open the gap",
        shown("across", *across),
        shown("gap", *gap)
    )]
    Closed {
        /// The mean gap around, m.
        gap: f64,
        /// Distance from mid width, m.
        across: f64,
    },
    /// An opening of the pin that is a line, or starved.
    #[error(
        "opening {opening} of a film is on the pin: it must reach around, and be full of oil at a pressure"
    )]
    PinOpening {
        /// Number of the opening, from 1.
        opening: usize,
    },
    /// Openings everywhere.
    #[error(
        "the openings of a film cover the whole bearing, so no film is left and nothing carries the pin: make them narrower than its \
         width of {}",
        shown("width", *width)
    )]
    AllOpen {
        /// Width of the bearing, m.
        width: f64,
    },
    /// Two openings at the same place.
    #[error("openings {first} and {second} of a film overlap: join them, or move one")]
    Overlap {
        /// Number of the one, from 1.
        first: usize,
        /// Number of the other.
        second: usize,
    },
    /// Data of a half bearing that are not symmetric.
    #[error("a film of half width needs {part} symmetric about mid width")]
    NotSymmetric {
        /// `openings`, `profiles` or `shapes`.
        part: &'static str,
    },
}

/// A film that has no solution at its inputs, or no reliable one.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FilmError {
    /// An input that is no number.
    #[error("the {} of a film is {value}, which is not a finite number", input_name(*input))]
    NotFinite {
        /// Place of the input.
        input: usize,
        /// Its value.
        value: f64,
    },
    /// An input out of its range.
    #[error("the {name} of a film is {}: it must be {range}", shown(name, *value))]
    Range {
        /// Name of the input.
        name: &'static str,
        /// Its value, SI.
        value: f64,
        /// The allowed range.
        range: &'static str,
    },
    /// Surfaces that touch.
    #[error("the surfaces touch: the gap is {} at {place}", shown("gap", *gap))]
    NoGap {
        /// The gap, m.
        gap: f64,
        /// The place.
        place: Place,
    },
    /// A mass-conserving film without supply.
    #[error(
        "a mass-conserving film needs oil: it has no opening that holds oil, and no end above the cavitation pressure, so the film \
         runs dry and its steady state is not unique; state an opening or flooded ends, or use the rule `reynolds`"
    )]
    NoOil,
    /// A pressure at which the viscosity by Barus' law is more than fifty times that without
    /// pressure.
    #[error(
        "the pressure at {place} is too high for Barus' law: the viscosity would exceed fifty times its value without pressure \
         (α q is {reached}, the limit 0.98); lower the load, or state a smaller pressure coefficient"
    )]
    Piezo {
        /// Value of α q.
        reached: f64,
        /// The place.
        place: Place,
    },
    /// Tilt at a half film.
    #[error("a film of half width has no tilt: state the full width")]
    TiltOfHalf,
    /// A search for the cavity that does not end.
    #[error(
        "the edge of the cavity is not found within {rounds} rounds: it still moves at {place}; take a shorter step"
    )]
    NotConverged {
        /// Rounds of the active set.
        rounds: usize,
        /// A cell that still changes sides.
        place: Place,
    },
    /// An elastic surface that finds no balance with the film.
    #[error(
        "film and elastic surface find no balance within {rounds} rounds: the surface may be too soft for the load, or the step too long"
    )]
    NoSurface {
        /// Rounds of Newton's method.
        rounds: usize,
    },
    /// A singular matrix of film and surface: the film yields as fast as the surface pushes.
    #[error(
        "the deflection of the elastic surface is not determined: there the film gives way as fast as the surface presses on it; \
         make the surface stiffer, or take a shorter step"
    )]
    SurfaceUnstable,
    /// Data of which no film can be made.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// Numbers beyond the range of floating point.
    #[error(
        "the pressure of a film is too large for a number: check its radial clearance and its viscosity"
    )]
    Overflow,
}
