//! Lints of numbers alone: gravity, masses and inertias, tables against the cycle.

use super::{Finding, short};
use crate::codes;
use crate::local::at;
use eng_system::code::Bound;
use eng_system::lint;
use eng_system::system::{BodyInertia, BodyRef, Origin, System};

/// Gravity on earth, with what people round it to (m/s²).
const EARTH: std::ops::Range<f64> = 9.7..10.1;
/// Density of the heaviest metals (kg/m³).
const HEAVIEST: f64 = 20_000.0;
/// Share of the inertia radius of a ball of the heaviest metal below which a body has a mistake in its unit, and no rounded number.
const NO_BALL: f64 = 0.3;
/// Radius of gyration over the way to the farthest marker, from the centre of mass: uniform rods have 0.58, cranks 0.5, webs 1.
const USUAL: std::ops::Range<f64> = 0.13..2.6;
/// Share of the farthest way by which markers on the other side of the centre of mass make a body a long one.
const OTHER_SIDE: f64 = 0.05;
/// Distances below this (m) are no measure of a machine.
const NO_MEASURE: f64 = 0.02;

/// What is probably wrong in the numbers of a model.
pub(super) fn numbers(system: &System, bound: &Bound) -> Vec<Finding> {
    let mut found = Vec::new();
    found.extend(gravity(system, bound));
    let bodies = bodies(system, bound);
    let reach = bodies.iter().map(|body| body.farthest).fold(0.0, f64::max);
    found.extend(bodies.iter().filter_map(|body| size(system, body, reach)));
    found.extend(periods(system, bound));
    found.extend(one_firing(system, bound));
    found
}

/// A finding about an attribute, at its place in the text.
fn about(
    system: &System,
    code: &'static str,
    name: &str,
    path: &str,
    attribute: &str,
    message: String,
) -> Finding {
    let stated = match path {
        "" => system.stated.get(attribute),
        path => system.stated.get(&format!("{path}.{attribute}")),
    };
    Finding {
        code,
        name: name.to_owned(),
        origin: Origin {
            path: path.to_owned(),
            used_at: stated.copied(),
            defined_at: None,
        },
        message,
        label: format!("this {attribute}"),
        help: String::new(),
        decided_by: Vec::new(),
    }
}

fn gravity(system: &System, bound: &Bound) -> Option<Finding> {
    let [x, y, z] = system.gravity.map(|slot| at(bound, slot));
    let size = libm::sqrt(x * x + y * y + z * z);
    if size == 0.0 || EARTH.contains(&size) {
        return None;
    }
    let text = short(size, 4);
    let message = format!("a gravity of {text} m/s^2 is neither 0 nor that of the earth, 9.81");
    let code = codes::GRAVITY;
    let mut finding = about(system, code, lint::GRAVITY, "", "gravity", message);
    finding.help = "check its unit and its components".to_owned();
    Some(finding)
}

/// A rigid body as its numbers have it.
struct Solid<'s> {
    path: &'s str,
    mass: f64,
    /// The largest entry on the diagonal of the inertia (kg m²).
    inertia: f64,
    /// Way from the centre of mass to the farthest marker that the text states (m).
    farthest: f64,
    /// Whether it has markers at two places.
    spread: bool,
    /// Whether it has markers on opposite sides of its centre of mass.
    both_sides: bool,
}

fn bodies<'s>(system: &'s System, bound: &Bound) -> Vec<Solid<'s>> {
    let bodies = system.bodies.iter().enumerate();
    bodies
        .filter_map(|(index, body)| {
            let BodyInertia::Rigid {
                mass,
                center_of_mass,
                inertia,
            } = &body.inertia
            else {
                return None;
            };
            let center = center_of_mass.map(|slot| at(bound, slot));
            let own = system.markers.iter().filter(|marker| {
                marker.body == BodyRef::Body(index as u32) && marker.origin.used_at.is_some()
            });
            let arms: Vec<[f64; 3]> = own
                .map(|marker| {
                    let place = marker.position.map(|slot| at(bound, slot));
                    [0, 1, 2].map(|i| place[i] - center[i])
                })
                .collect();
            let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let square = arms.iter().map(|arm| dot(arm, arm)).fold(0.0, f64::max);
            let pairs = || arms.iter().flat_map(|a| arms.iter().map(move |b| (a, b)));
            let apart = |(a, b): (&[f64; 3], &[f64; 3])| {
                let between = [0, 1, 2].map(|i| a[i] - b[i]);
                dot(&between, &between) > OTHER_SIDE * square
            };
            Some(Solid {
                path: &body.origin.path,
                mass: at(bound, *mass),
                inertia: [0, 1, 2]
                    .map(|i| at(bound, inertia[i]))
                    .into_iter()
                    .fold(0.0, f64::max),
                farthest: libm::sqrt(square),
                spread: pairs().any(apart),
                both_sides: pairs().any(|(a, b)| dot(a, b) < -OTHER_SIDE * square),
            })
        })
        .collect()
}

/// A body whose inertia does not fit its mass and its markers. `reach` is the farthest marker of all bodies from its centre of mass.
fn size(system: &System, body: &Solid<'_>, reach: f64) -> Option<Finding> {
    let radius = libm::sqrt(body.inertia / body.mass);
    // I = 2/5 m r², m = 4/3 π r³ ρ
    let ball = libm::cbrt(0.75 * body.mass / (std::f64::consts::PI * HEAVIEST));
    let least = libm::sqrt(0.4) * ball;
    let long = body.spread && body.farthest > NO_MEASURE;
    let ratio = radius / body.farthest;
    let mm = |x: f64| short(1e3 * x, 3);
    let told = format!(
        "its mass of {} kg and its inertia of {} kg*m^2 make a radius of gyration of {} mm",
        short(body.mass, 4),
        short(body.inertia, 4),
        mm(radius)
    );
    let message = if radius < NO_BALL * least {
        format!(
            "{told}; even a ball of tungsten of this mass has {} mm",
            mm(least)
        )
    } else if long && (ratio > USUAL.end || body.both_sides && ratio < USUAL.start) {
        format!(
            "{told}, but its markers reach {} mm from its centre of mass",
            mm(body.farthest)
        )
    } else if radius > USUAL.end * reach && reach > NO_MEASURE {
        format!(
            "{told}, but no marker of the model is farther than {} mm from a centre of mass",
            mm(reach)
        )
    } else {
        return None;
    };
    let (code, name) = (codes::INERTIA, lint::INERTIA);
    let mut finding = about(system, code, name, body.path, "inertia", message);
    finding.help =
        "check the units of mass, inertia and places: `g*m^2`, `kg*m^2`, `mm`".to_owned();
    let mass = format!("{}.mass", body.path);
    finding
        .decided_by
        .extend(system.stated.get(&mass).map(|at| Origin {
            path: mass.clone(),
            used_at: Some(*at),
            defined_at: None,
        }));
    Some(finding)
}

/// Periodic tables of angles of which no whole number fills the cycle.
fn periods(system: &System, bound: &Bound) -> Vec<Finding> {
    let Some(cycle) = &system.cycle else {
        return Vec::new();
    };
    let period = at(bound, cycle.period);
    let deg = |x: f64| short(x.to_degrees(), 4);
    system
        .tables
        .iter()
        .filter_map(|table| {
            let of_table = table.period_of_angle()?;
            let times = period / of_table;
            let whole = libm::round(times);
            if whole >= 1.0 && (times - whole).abs() < 1e-6 * whole {
                return None;
            }
            Some(Finding {
                code: codes::PERIOD,
                name: lint::PERIOD.to_owned(),
                origin: cycle.origin.clone(),
                message: format!(
                    "the cycle repeats every {} deg, the table `{}` every {} deg",
                    deg(period),
                    table.name(),
                    deg(of_table)
                ),
                label: "its period".to_owned(),
                help: "720 deg are the cycle of a four-stroke engine, 360 deg that of a two-stroke"
                    .to_owned(),
                decided_by: vec![Origin {
                    path: table.name().to_owned(),
                    used_at: table.stated_at(),
                    defined_at: None,
                }],
            })
        })
        .collect()
}

/// All cylinders of a machine that fire at one angle: an order that was forgotten.
fn one_firing(system: &System, bound: &Bound) -> Option<Finding> {
    let (first, others) = system.firings.split_first()?;
    let angle = at(bound, first.angle);
    if others.is_empty() || others.iter().any(|other| at(bound, other.angle) != angle) {
        return None;
    }
    let element = system.elements.get(first.element as usize)?;
    Some(Finding {
        code: codes::CYLINDER,
        name: lint::FIRING.to_owned(),
        origin: Origin {
            defined_at: None,
            ..element.origin.clone()
        },
        message: format!(
            "all {} cylinders fire at {} deg",
            system.firings.len(),
            short(angle.to_degrees(), 4)
        ),
        label: "of this cylinder".to_owned(),
        help: "give each its `firing:`".to_owned(),
        decided_by: Vec::new(),
    })
}
