//! Lints that need only numbers, and no assembly: gravity, masses and inertias, tables against the
//! cycle.

use super::{Finding, degrees, short};
use crate::codes;
use crate::machine::at;
use eng_system::code::{Bound, Compiled};
use eng_system::lint;
use eng_system::system::{
    BodyInertia, BodyRef, Cycle, Element, FiringInfo, Location, Origin, Slot, System,
};

/// Gravity on earth (m/s²), with the usual rounded values. Gravity is 9.78 to 9.83 at sea level.
const EARTH: std::ops::Range<f64> = 9.7..10.1;
/// Density of the heaviest metals (kg/m³): tungsten and gold have 19 300.
const HEAVIEST: f64 = 20_000.0;
/// A body has a mistake in its unit, and not only a rounded number, if its radius of gyration is below this
/// share of that of a ball of the heaviest metal. A choice: a unit wrong by a factor of a thousand in the
/// inertia shortens the radius to a thirtieth, rounding by far less than to a third.
const NO_BALL: f64 = 0.3;
/// Usual ratios of the radius of gyration to the distance of the farthest marker from the centre of mass.
/// Uniform rods have 0.58, cranks 0.5, webs 1. The limits are a choice.
const USUAL: std::ops::Range<f64> = 0.13..2.6;
/// A body may be larger than its markers, as discs and rims are, up to this ratio of its radius of gyration
/// to the radius of a steel ball of the same mass. A choice: a steel disc with a diameter of twenty
/// thicknesses has 1.7.
const COMPACT: f64 = 3.0;
/// No part of a machine is so slender that this ratio is larger. A steel bar of a hundred diameters has 11,
/// and so has a tube of thirty diameters. A choice above these.
const SLENDER: f64 = 20.0;
/// Markers at least this far apart (m) count as two places of a body. A choice: markers nearer to each other
/// are one place with rounding.
const TWO_PLACES: f64 = 1e-3;
/// The centre of mass of a body has probably lost its unit if two ratios are large. This is the first limit:
/// the distance to the nearest marker over the largest distance of two markers. Both limits are choices.
const FAR_IN_SPANS: f64 = 2.0;
/// The second limit: the distance to the farthest marker over the same distance of all other bodies.
const FAR_IN_REACHES: f64 = 3.0;
/// Density of steel (kg/m³).
const STEEL: f64 = 7_800.0;
/// Two markers are on opposite sides of the centre of mass if the product of their arms is below minus this
/// share of the square of the farthest arm. A choice: a marker almost at the centre, or almost square to the
/// other arm, says little about where the centre should be.
const OTHER_SIDE: f64 = 0.02;
/// An analysis removes a mass if it sets less than this share of the stated mass. A choice: a variation of a
/// mass stays far above it, and an analysis that removes a mass mostly sets a number near zero.
const TAKEN_AWAY: f64 = 0.01;
/// Markers are on one line if at most this share of their sum of squares is across it. A choice: it allows an
/// offset of about a third of the distance along the line.
const BESIDE_LINE: f64 = 0.1;
/// The moments of a body are in the wrong order if two conditions hold. The first: its mass extends along the
/// line of its markers (root of the mean square) by less than this share of the distance to the farthest
/// marker. A choice: a rod between two markers at its ends has 0.58.
const ALONG_LINE: f64 = 0.3;
/// The second: the moment about the line is larger than this multiple of the smallest moment across it. The
/// limit is that of a thin disc.
const ABOUT_LINE: f64 = 2.0;
/// Firing angles closer than this (rad) count as equal. They are stated in degrees, so that only rounding
/// differs.
const SAME_ANGLE: f64 = 1e-6;
/// Distances below this (m) are no measure of the size of a machine. A choice: machines of two centimetres
/// have other shapes.
const NO_MEASURE: f64 = 0.02;

/// The probable mistakes in the numbers of a model.
pub(super) fn numbers(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    bound: &Bound,
) -> Vec<Finding> {
    let system = &compiled.system;
    let mut found = Vec::new();
    found.extend(gravity(system, bound));
    let bodies = bodies(system, bound);
    let farthest = |bodies: &mut dyn Iterator<Item = &Solid<'_>>| {
        bodies.map(|body| body.farthest).fold(0.0, f64::max)
    };
    let reach = farthest(&mut bodies.iter());
    // bodies of one declaration share its mistake, so they do not count as other bodies
    let of_others = |body: &Solid<'_>| {
        farthest(
            &mut bodies
                .iter()
                .filter(|other| other.declared != body.declared),
        )
    };
    // if an analysis removes a mass, the remaining inertia does not fit it
    let text = compiled.bind.bind(&[], &system.tables);
    let taken_away = |body: &Solid<'_>| {
        let set = overrides.iter().any(Option::is_some);
        let stated = text
            .as_ref()
            .map_or(f64::NAN, |text| at(text, body.slots[0]));
        set && body.mass < TAKEN_AWAY * stated
    };
    let kept = bodies.iter().filter(|body| !taken_away(body));
    found.extend(kept.filter_map(|body| {
        let doubt = (size(body, reach).or_else(|| order(body)))
            .or_else(|| far_center(body, of_others(body)))?;
        Some(of_inertia(compiled, body, doubt))
    }));
    found.extend(super::rods::rods(system, bound));
    found.extend(whole_turns(system, bound));
    found.extend(periods(system, bound));
    found.extend(one_firing(system, bound));
    found.extend(without_gas(system));
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
        ..Finding::default()
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

/// The numbers of a rigid body.
struct Solid<'s> {
    path: &'s str,
    mass: f64,
    /// The largest entry on the diagonal of the inertia (kg m²).
    inertia: f64,
    /// Distance from the centre of mass to the farthest marker that the text states (m).
    farthest: f64,
    /// Whether it has markers at two places.
    spread: bool,
    /// Distance from the centre of mass to the nearest marker, and largest distance of two markers (m).
    nearest: f64,
    span: f64,
    /// Place of its declaration.
    declared: Option<Location>,
    /// Whether it has markers on opposite sides of its centre of mass, or the centre of mass is far from all
    /// markers.
    both_sides: bool,
    /// Slots of the mass and of the largest moment.
    slots: [Slot; 2],
    /// Index of the farthest marker.
    farthest_marker: Option<usize>,
    /// The moments about the body's axes (kg m²).
    moments: [f64; 3],
    /// Sums of squares of the markers' distances along the body's axes (m²).
    spans: [f64; 3],
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
            let own: Vec<usize> = (0..system.markers.len())
                .filter(|m| {
                    let marker = &system.markers[*m];
                    marker.body == BodyRef::Body(index as u32) && marker.origin.used_at.is_some()
                })
                .collect();
            let arms: Vec<[f64; 3]> = own
                .iter()
                .map(|m| {
                    let marker = &system.markers[*m];
                    let place = marker.position.map(|slot| at(bound, slot));
                    [0, 1, 2].map(|i| place[i] - center[i])
                })
                .collect();
            let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let square = arms.iter().map(|arm| dot(arm, arm)).fold(0.0, f64::max);
            let least = arms.iter().map(|arm| dot(arm, arm));
            let least = least.fold(f64::INFINITY, f64::min);
            let pairs = || arms.iter().flat_map(|a| arms.iter().map(move |b| (a, b)));
            let between = |(a, b): (&[f64; 3], &[f64; 3])| {
                let way = [0, 1, 2].map(|i| a[i] - b[i]);
                dot(&way, &way)
            };
            let span = pairs().map(between).fold(0.0, f64::max);
            let moments = [0, 1, 2].map(|i| at(bound, inertia[i]));
            let largest = (0..3).fold(0, |best, i| match moments[i] > moments[best] {
                true => i,
                false => best,
            });
            let farthest = (0..own.len()).max_by(|a, b| {
                let [x, y] = [*a, *b].map(|i| dot(&arms[i], &arms[i]));
                x.total_cmp(&y).then(b.cmp(a))
            });
            Some(Solid {
                path: &body.origin.path,
                mass: at(bound, *mass),
                inertia: moments[largest],
                slots: [*mass, inertia[largest]],
                farthest_marker: farthest.map(|i| own[i]),
                moments,
                spans: [0, 1, 2].map(|i| arms.iter().map(|arm| arm[i] * arm[i]).sum()),
                farthest: libm::sqrt(square),
                spread: span > OTHER_SIDE * square,
                nearest: libm::sqrt(least),
                span: libm::sqrt(span),
                declared: body.origin.used_at,
                // or the nearest marker is farther away than half the markers' distance from each other; this
                // distance must exceed a fifth of the farthest arm, because two hinges close together say
                // nothing about a length
                both_sides: pairs().any(|(a, b)| dot(a, b) < -OTHER_SIDE * square)
                    || (span > 0.04 * square && least > 0.25 * span),
            })
        })
        .collect()
}

/// A message about a body's inertia. `marker`: whether a marker is part of the reason.
struct Doubt {
    message: String,
    marker: bool,
}

/// A body whose inertia does not fit its mass and its markers. `reach` is the farthest marker of all bodies
/// from its centre of mass.
fn size(body: &Solid<'_>, reach: f64) -> Option<Doubt> {
    let radius = libm::sqrt(body.inertia / body.mass);
    // I = 2/5 m r², m = 4/3 π r³ ρ
    let ball = |density: f64| libm::cbrt(0.75 * body.mass / (std::f64::consts::PI * density));
    let least = libm::sqrt(0.4) * ball(HEAVIEST);
    let wide = radius > COMPACT * ball(STEEL);
    let long = body.spread && body.farthest > NO_MEASURE;
    let ratio = radius / body.farthest;
    let mm = |x: f64| short(1e3 * x, 3);
    let numbers = format!(
        "its mass of {} kg and its inertia of {} kg*m^2 make a radius of gyration of {} mm",
        short(body.mass, 4),
        short(body.inertia, 4),
        mm(radius)
    );
    let (message, marker) = if radius < NO_BALL * least {
        let ball = mm(least);
        (
            format!(
                "{numbers}; even a ball of tungsten of this mass has a radius of gyration of {ball} mm"
            ),
            false,
        )
    } else if long && (wide && ratio > USUAL.end || body.both_sides && ratio < USUAL.start) {
        let reach = mm(body.farthest);
        let message =
            format!("{numbers}, but its markers reach {reach} mm from its centre of mass");
        (message, true)
    } else if wide && radius > USUAL.end * reach && reach > NO_MEASURE {
        let message = format!(
            "{numbers}, but no marker of the model is farther than {} mm from a centre of mass",
            mm(reach)
        );
        (message, false)
    } else if body.span > TWO_PLACES
        // a point mass with an inertia of its own has one marker, so it gets no message
        && radius > SLENDER * ball(STEEL)
        && radius > USUAL.end * body.farthest
    {
        let ball = mm(ball(STEEL));
        let message =
            format!("{numbers}, but a ball of steel of this mass has a radius of {ball} mm");
        (message, false)
    } else {
        return None;
    };
    Some(Doubt { message, marker })
}

/// A centre of mass that is far from the markers of its body, compared with other bodies. `of_others` is the
/// farthest marker of the other bodies. A pendulum gets no message: it has one hinge, or it is as large as
/// its support.
fn far_center(body: &Solid<'_>, of_others: f64) -> Option<Doubt> {
    let radius = libm::sqrt(body.inertia / body.mass);
    let far = body.span > TWO_PLACES
        && body.nearest > FAR_IN_SPANS * body.span
        && body.farthest > FAR_IN_REACHES * of_others
        && of_others > NO_MEASURE
        && radius < USUAL.start * body.farthest;
    let mm = |x: f64| short(1e3 * x, 3);
    far.then(|| Doubt {
        message: format!(
            "its centre of mass is {} mm from its nearest marker, but its markers are {} mm apart, and its radius of gyration is {} mm: is the unit of its places right?",
            mm(body.nearest),
            mm(body.span),
            mm(radius)
        ),
        marker: true,
    })
}

/// A body with all markers along one of its axes, but with little inertia across that line and much about it.
fn order(body: &Solid<'_>) -> Option<Doubt> {
    let whole: f64 = body.spans.iter().sum();
    let line = (0..3).find(|i| body.spans[*i] > (1.0 - BESIDE_LINE) * whole)?;
    let across = (0..3).filter(|i| *i != line).map(|i| body.moments[i]);
    let least = across.fold(f64::INFINITY, f64::min);
    // ∫ z² dm = (J_x + J_y − J_z)/2 for the axis z along the line
    let along = 0.5 * body.moments.iter().sum::<f64>() - body.moments[line];
    let wrong = body.spread
        && body.farthest > NO_MEASURE
        && along < ALONG_LINE * ALONG_LINE * body.farthest * body.farthest * body.mass
        && body.moments[line] > ABOUT_LINE * least;
    wrong.then(|| Doubt {
        message: format!(
            "its markers are along its {} axis, but its moment about that axis, {} kg*m^2, is more than twice the moment about an axis across it, {} kg*m^2: are the moments in the right order?",
            ["x", "y", "z"][line],
            short(body.moments[line], 4),
            short(least, 4)
        ),
        marker: false,
    })
}

/// A doubt about an inertia, with the places that decide it.
fn of_inertia(compiled: &Compiled, body: &Solid<'_>, doubt: Doubt) -> Finding {
    let system = &compiled.system;
    let (code, name) = (codes::INERTIA, lint::INERTIA);
    let mut finding = about(system, code, name, body.path, "inertia", doubt.message);
    finding.help =
        "check the units of mass, inertia and places: `g*m^2`, `kg*m^2`, `mm`".to_owned();
    let mut places = Vec::new();
    let parameters = |slot: Slot| compiled.bind.parameters_of(slot).into_iter();
    let stated = |index: u32| Some(system.parameters.get(index as usize)?.origin.clone());
    let [mass, inertia] = body.slots.map(parameters);
    let of_marker = body.farthest_marker.filter(|_| doubt.marker);
    let of_marker = of_marker.map(|m| &system.markers[m]);
    places.extend(inertia.filter_map(stated));
    let center = format!("{}.center_of_mass", body.path);
    places.extend(system.stated.get(&center).map(|at| Origin {
        path: center.clone(),
        used_at: Some(*at),
        defined_at: None,
    }));
    let attribute = format!("{}.mass", body.path);
    places.extend(system.stated.get(&attribute).map(|at| Origin {
        path: attribute.clone(),
        used_at: Some(*at),
        defined_at: None,
    }));
    if let Some(marker) = of_marker {
        let slots = marker.position.iter();
        places.extend(slots.flat_map(|slot| parameters(*slot)).filter_map(stated));
        places.push(marker.origin.clone());
    }
    places.extend(mass.filter_map(stated).filter(|p| p.path != attribute));
    super::decide(&mut finding, places);
    finding
}

/// Pistons without gas, while other bodies of the same declaration have gas.
fn without_gas(system: &System) -> Vec<Finding> {
    // two pistons may face each other in one bore
    let bodies_of = |firing: &FiringInfo| {
        let element = system.elements.get(firing.element as usize)?;
        let body = |local: u32| {
            let marker = *element.markers.get(local as usize)?;
            match system.markers.get(marker as usize)?.body {
                BodyRef::Body(body) => Some((body as usize, element)),
                BodyRef::Ground => None,
            }
        };
        Some([firing.piston, firing.head].map(body))
    };
    let firings = system.firings.iter().filter_map(bodies_of);
    let fired: Vec<(usize, &Element)> = firings.flatten().flatten().collect();
    let mut found = Vec::new();
    for (index, body) in system.bodies.iter().enumerate() {
        let alike = |other: usize| {
            system.bodies[other].origin.used_at == body.origin.used_at && other != index
        };
        let Some((like, element)) = fired.iter().find(|(other, _)| alike(*other)) else {
            continue;
        };
        if fired.iter().any(|(other, _)| *other == index) || body.origin.used_at.is_none() {
            continue;
        }
        let message = format!(
            "{} has no gas, although {} has",
            body.origin.path, system.bodies[*like].origin.path
        );
        found.push(Finding {
            code: codes::CYLINDER,
            name: lint::FIRING.to_owned(),
            origin: Origin {
                defined_at: None,
                ..element.origin.clone()
            },
            message,
            label: "the gas of another cylinder".to_owned(),
            help: "give each cylinder its gas; `scale: 0` switches it off".to_owned(),
            decided_by: vec![body.origin.clone()],
            ..Finding::default()
        });
    }
    found
}

/// A cycle whose period is no whole number of half turns. The usual reason: a number in degrees was read as
/// rad.
fn whole_turns(system: &System, bound: &Bound) -> Option<Finding> {
    let cycle = system.cycle.as_ref()?;
    let period = at(bound, cycle.period);
    let halves = period / std::f64::consts::PI;
    let whole = libm::round(halves);
    // a number in degrees, or a pi with seven digits
    if whole >= 1.0 && (halves - whole).abs() < 1e-6 * whole {
        return None;
    }
    let message = format!(
        "the cycle repeats every {}, which is no whole number of half turns: is its unit right?",
        degrees(period, 5)
    );
    Some(wrong_period(cycle, message, Vec::new()))
}

fn wrong_period(cycle: &Cycle, message: String, decided_by: Vec<Origin>) -> Finding {
    Finding {
        code: codes::PERIOD,
        name: lint::PERIOD.to_owned(),
        origin: cycle.origin.clone(),
        message,
        label: "its period".to_owned(),
        help: "the cycle of a four-stroke engine has 720 deg, that of a two-stroke engine 360 deg"
            .to_owned(),
        decided_by,
        ..Finding::default()
    }
}

/// Periodic tables over angles whose period does not divide the cycle.
fn periods(system: &System, bound: &Bound) -> Vec<Finding> {
    let Some(cycle) = &system.cycle else {
        return Vec::new();
    };
    let period = at(bound, cycle.period);
    let deg = |x: f64| degrees(x, 4);
    system
        .tables
        .iter()
        .flat_map(|table| table.periods_of_angles().map(move |period| (table, period)))
        .filter_map(|(table, of_table)| {
            let times = period / of_table;
            let whole = libm::round(times);
            // a number in degrees, or a pi with seven digits
            if whole >= 1.0 && (times - whole).abs() < 1e-6 * whole {
                return None;
            }
            let message = format!(
                "the cycle repeats every {}, the table `{}` every {}",
                deg(period),
                table.name(),
                deg(of_table)
            );
            let table = Origin {
                path: table.name().to_owned(),
                used_at: table.stated_at(),
                defined_at: None,
            };
            Some(wrong_period(cycle, message, vec![table]))
        })
        .collect()
}

/// Cylinders that fire at the same angle. If all of them do, the firing order was forgotten. If some do and
/// others fire alone, an angle is wrong. An engine whose cylinders all fire in pairs gets no message.
fn one_firing(system: &System, bound: &Bound) -> Option<Finding> {
    let period = system
        .cycle
        .as_ref()
        .map_or(f64::INFINITY, |cycle| at(bound, cycle.period));
    let angle = |firing: &FiringInfo| at(bound, firing.angle).rem_euclid(period);
    let together = |a: &FiringInfo, b: &FiringInfo| {
        let apart = (angle(a) - angle(b)).abs();
        apart.min(period - apart) < SAME_ANGLE
    };
    let all = &system.firings;
    let with = |one: &FiringInfo| all.iter().filter(|other| together(one, other)).count();
    let most = all.iter().max_by_key(|one| with(one)).map(with)?;
    let least = all.iter().min_by_key(|one| with(one)).map(with)?;
    if most == 1 || most == least && most < all.len() {
        return None;
    }
    let first = all.iter().find(|one| with(one) == most)?;
    let group = all.iter().filter(|other| together(first, other));
    let group: Vec<&FiringInfo> = group.collect();
    let origin = |firing: &FiringInfo| Some(&system.elements.get(firing.element as usize)?.origin);
    let shown = degrees(at(bound, first.angle), 4);
    let (message, help) = match most == all.len() {
        true => (
            format!("all {most} cylinders fire at {shown}"),
            format!("give each its `{}:`", first.stated_as),
        ),
        false => {
            let others = group.iter().skip(1).filter_map(|firing| origin(firing));
            let others: Vec<&str> = others.map(|origin| origin.path.as_str()).collect();
            (
                format!(
                    "it fires at {shown} together with {}, and other cylinders do not fire together",
                    super::listed(&others)
                ),
                "each cylinder fires at an angle of its own: one of two dead centres of a four-stroke cycle, 360 deg apart".to_owned(),
            )
        }
    };
    let mut finding = Finding {
        code: codes::CYLINDER,
        name: lint::FIRING.to_owned(),
        origin: Origin {
            defined_at: None,
            ..origin(first)?.clone()
        },
        message,
        label: "the gas of this cylinder".to_owned(),
        help,
        ..Finding::default()
    };
    if most < all.len() {
        let stated = group.iter().filter_map(|firing| {
            let path = format!("{}.{}", origin(firing)?.path, firing.stated_as);
            Some(Origin {
                used_at: Some(*system.stated.get(&path)?),
                path,
                defined_at: None,
            })
        });
        let elements = group.iter().filter_map(|firing| origin(firing));
        let elements = elements.map(|origin| Origin {
            defined_at: None,
            ..origin.clone()
        });
        super::decide(&mut finding, stated.chain(elements).collect());
    }
    Some(finding)
}
