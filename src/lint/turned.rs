//! Lints of the turning machine: gas that fires at no dead centre, bores and strokes, pistons on the wrong
//! side.
//!
//! The machine turns once through its cycle by its geometry ([`eng_runtime::start::turn`]). For each cylinder
//! (an element that fires) the lint follows the distance between piston and head along the bore.

use super::assembled::Start;
use super::{Finding, short};
use crate::codes;
use crate::machine::at;
use eng_runtime::assembly::rows;
use eng_runtime::model::Model;
use eng_runtime::rotation::V3;
use eng_runtime::start::turn::{Place, Turned, turn};
use eng_runtime::start::turn_extremes::Following;
use eng_runtime::{Assembled, RuntimeError};
use eng_system::code::{Bound, Compiled};
use eng_system::system::{Depth, Element, FiringInfo, Origin, Role, Slot, System};
use eng_system::{Dimension, lint};
use std::f64::consts::{PI, TAU};

/// The largest difference (rad) between a firing angle and its dead centre. Offset bores and articulated rods
/// move the dead centre by some degrees. A choice: mistakes in the order of firing or in the angle of a throw
/// are mostly far larger.
const OFF: f64 = 15.0 * PI / 180.0;
/// Bore over stroke of engines: from slow marine two-strokes to racing engines. The limits are a choice.
const BORE_TO_STROKE: std::ops::Range<f64> = 0.6..1.7;
/// Length of rods over the throw: 2.3 in slow marine engines, 3 to 5 in most. The limits are a choice.
const ROD_TO_THROW: std::ops::Range<f64> = 2.0..10.0;
/// A shorter stroke (m) counts as none. A choice: the smallest engines have strokes of some millimetres.
const NO_STROKE: f64 = 1e-3;
/// A body counts as fixed if it moves by less than this share of the other's motion. A choice: a head on a
/// flexible or elastically mounted block moves a little, and two pistons in one bore move alike.
const STANDS: f64 = 0.1;
/// Least cosine of the angle between gravity and the bores (towards the heads) of an engine that is upside
/// down. A choice: 60°, so that engines on their sides have no message.
const UPSIDE_DOWN: f64 = 0.5;
/// Angles (rad) between a bore and the crankshaft that no machine has: an engine's bores are perpendicular to
/// it, those of an axial machine parallel. The limits are a choice, some degrees from both.
const SLANTED: std::ops::Range<f64> = 0.03..1.54;
/// The crankshaft is upright from this share of gravity along it on. A choice, 26°.
const UPRIGHT: f64 = 0.9;

/// The parts that decide the motion of a cylinder and its gas.
enum Where {
    /// The marker of the throw and the parameters that place it.
    Throw,
    /// The markers of the rod.
    Rod,
    /// The marker of the head.
    Head,
    /// The parameters of the bore.
    Bore,
    /// The firing angle.
    Firing,
}

/// The motion of one cylinder during a turn.
struct Watched<'s> {
    firing: &'s FiringInfo,
    angle: f64,
    bore: f64,
    /// Markers: piston and head.
    markers: [usize; 2],
    /// Cycle angle (rad) and position of the piston along the head's axis (m).
    travel: Vec<(f64, f64)>,
    /// First positions of piston and head, and their largest distances from there (m).
    begin: Option<[V3; 2]>,
    ways: [f64; 2],
    /// The bore's direction at the first position, from the crank to the head.
    up: V3,
    /// The marker by which the crank moves the piston's rod.
    throw: Option<usize>,
    /// Length of the rod between piston and crank, across the crankshaft (m), and its markers.
    rod_length: Option<f64>,
    rod_markers: Option<[usize; 2]>,
    /// Whether a joint ties the piston to the head's body, as a liner does.
    guided: bool,
    /// Whether the head is on the body that turns with the cycle and does not guide the piston.
    on_crank: bool,
    /// Whether the rod is beyond the piston, as seen from the head, when the piston is highest; with that
    /// height.
    beyond: Option<(f64, bool)>,
}

/// Probable mistakes in cycle and cylinders of a model, and the angle of its turn. The angle is `None` if the
/// model has neither and did not turn. A lock is no finding here, because the caller has its error.
pub(crate) fn turned(
    assembled: &Assembled,
    bound: &Bound,
) -> (Vec<Finding>, Option<Result<Turned, RuntimeError>>) {
    let compiled = &assembled.model().compiled;
    let system = &compiled.system;
    let of = |firing: &FiringInfo, local: u32| {
        let markers = &system.elements[firing.element as usize].markers;
        markers.get(local as usize).map_or(0, |m| *m as usize)
    };
    let mut cylinders: Vec<Watched<'_>> = system
        .firings
        .iter()
        .map(|firing| Watched {
            firing,
            angle: at(bound, firing.angle),
            bore: at(bound, firing.bore),
            markers: [firing.piston, firing.head].map(|m| of(firing, m)),
            travel: Vec::new(),
            begin: None,
            ways: [0.0; 2],
            up: V3::zeros(),
            throw: None,
            rod_length: None,
            rod_markers: None,
            guided: false,
            on_crank: false,
            beyond: None,
        })
        .collect();
    if cylinders.is_empty() && system.cycle.is_none() && system.followed.is_empty() {
        return (Vec::new(), None);
    }
    // a quantity without a value somewhere in the turn is no reason for a lint
    let mut following = Following::new(assembled.model()).ok().flatten();
    let mut shaft = None;
    // the cycle's angle at the first and the last position, and the finding if it decreases
    let (mut angles, mut backwards): (Option<[f64; 2]>, _) = (None, None);
    let found = turn(assembled, &mut |place| {
        let first = angles.map_or(place.angle, |[first, _]| first);
        if angles.is_none() {
            let (model, state) = (place.model, place.state);
            backwards = Start { model, state }.backwards();
        }
        angles = Some([first, place.angle]);
        shaft = shaft.or_else(|| shaft_axis(place));
        for cylinder in &mut cylinders {
            cylinder.look(place);
        }
        if following.as_mut().is_some_and(|f| f.look(place).is_err()) {
            following = None;
        }
        Ok(())
    });
    match found {
        Ok(Turned::Whole) => {}
        Ok(Turned::Back(angle)) => {
            return (swings(system, angle).into_iter().collect(), Some(found));
        }
        Ok(Turned::Held) => return (held(system).into_iter().collect(), Some(found)),
        Ok(Turned::Not) | Err(_) => return (Vec::new(), Some(found)),
    }
    let of_text = following.map_or(Vec::new(), |following| {
        advice_of_text(assembled.model(), &following)
    });
    if cylinders.is_empty() {
        return (of_text, Some(found));
    }
    let doubts = cylinders.iter().flat_map(|c| c.doubts(compiled));
    let slanted = cylinders.iter().filter_map(|c| c.slanted(compiled, shaft?));
    let falls = angles.is_some_and(|[first, last]| last < first);
    let doubts = doubts
        .chain(slanted)
        .chain(backwards.filter(|_| falls))
        .chain(gravity(system, bound, &cylinders, shaft))
        .chain(of_text);
    (doubts.collect(), Some(found))
}

/// The lints of the text on numbers of the turn.
fn advice_of_text(model: &Model, following: &Following) -> Vec<Finding> {
    let Compiled { system, bind, .. } = &model.compiled;
    let advice = bind.after_turn(&model.overrides, &following.numbers(), &system.tables);
    let mut found: Vec<Finding> = advice.iter().map(Finding::of_parameters).collect();
    for finding in &mut found {
        let follows_a_speed = system.followed.iter().any(|followed| {
            let element = &system.elements[followed.element as usize];
            let output = &system.classes[element.class as usize].outputs[followed.output as usize];
            element.origin.path == finding.origin.path && output.depth == Depth::Velocity
        });
        if follows_a_speed {
            super::decide(finding, stated_speeds(model));
        }
    }
    found
}

/// The angular velocities that drives and starts state.
fn stated_speeds(model: &Model) -> Vec<Origin> {
    let Compiled { system, bind, .. } = &model.compiled;
    let speed = Dimension::ANGLE.over(Dimension::TIME);
    let states = |element: &&Element| match element.role {
        Role::Dynamic => system.classes[element.class as usize].facts.rows_over_time,
        Role::StartVelocity { .. } => true,
        _ => false,
    };
    let slots = system.elements.iter().filter(states);
    let slots = slots.flat_map(|element| &element.constants);
    let parameters = slots.flat_map(|slot| bind.parameters_of(*slot));
    let parameters = parameters.filter_map(|index| system.parameters.get(index as usize));
    parameters
        .filter(|parameter| parameter.dimension == speed)
        .map(|parameter| parameter.origin.clone())
        .collect()
}

/// A cycle whose angle swings and never completes a turn.
fn swings(system: &System, angle: f64) -> Option<Finding> {
    Some(Finding {
        code: codes::CYCLE,
        name: lint::CYCLE.to_owned(),
        origin: system.cycle.as_ref()?.origin.clone(),
        message: format!(
            "the cycle's angle turns back at {} and never completes a turn",
            deg(angle)
        ),
        label: "an angle that oscillates".to_owned(),
        help: "the cycle is the angle of the crank: `rotation(crank.flange, ground)`".to_owned(),
        ..Finding::default()
    })
}

/// A cycle whose angle the joints keep.
fn held(system: &System) -> Option<Finding> {
    Some(Finding {
        code: codes::CYCLE,
        name: lint::CYCLE.to_owned(),
        origin: system.cycle.as_ref()?.origin.clone(),
        message: "the cycle's angle does not change: no motion that the joints allow turns it"
            .to_owned(),
        label: "an angle that the joints hold".to_owned(),
        help: "the cycle is the angle of the crank: `rotation(crank.flange, ground)`; a run over turns of this angle is refused (E0714)".to_owned(),
        ..Finding::default()
    })
}

/// The axis of the cycle's angle (inertial, unit length), if it is an angle between two markers.
fn shaft_axis(place: &Place<'_>) -> Option<V3> {
    let [_, reference] = cycle_markers(place.model)?;
    let marker = rows::marker(
        place.model,
        reference,
        &place.state.pose,
        &place.state.velocity,
    );
    Some(marker.rotation.column(2).into_owned())
}

/// The markers of the cycle's angle: the turning one and the reference.
fn cycle_markers(model: &Model) -> Option<[usize; 2]> {
    let element = model.compiled.system.cycle.as_ref()?.element as usize;
    let rotation = model
        .compiled
        .system
        .elements
        .get(element)?
        .rotations
        .first()?;
    let markers = &model.elements.get(element)?.markers;
    Some([
        *markers.get(rotation.turning as usize)?,
        *markers.get(rotation.reference as usize)?,
    ])
}

/// Gravity towards the heads, or along the crankshaft.
fn gravity(
    system: &System,
    bound: &Bound,
    cylinders: &[Watched<'_>],
    shaft: Option<V3>,
) -> Option<Finding> {
    let down = V3::from(system.gravity.map(|slot| at(bound, slot)));
    let down = (down.norm() > 0.0).then(|| down.normalize())?;
    let mean = cylinders.iter().map(|c| c.up.dot(&down)).sum::<f64>() / cylinders.len() as f64;
    let message = if mean > UPSIDE_DOWN {
        "gravity acts from the crankshaft towards the heads: is its sign right?"
    } else if shaft.is_some_and(|axis| axis.dot(&down).abs() > UPRIGHT) {
        "gravity acts along the crankshaft: is it along the right axis?"
    } else {
        return None;
    };
    Some(Finding {
        code: codes::GRAVITY,
        name: lint::GRAVITY.to_owned(),
        origin: Origin {
            path: String::new(),
            used_at: system.stated.get("gravity").copied(),
            defined_at: None,
        },
        message: message.to_owned(),
        label: "this gravity".to_owned(),
        help: "for an engine that hangs or is upright write `accept gravity` in the model"
            .to_owned(),
        ..Finding::default()
    })
}

/// The distance of two angles on a circle of a turn (rad).
fn apart(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(TAU);
    d.min(TAU - d)
}

/// To a tenth of a degree, with its unit.
fn deg(x: f64) -> String {
    let tenths = libm::round(x.to_degrees() * 10.0) / 10.0;
    match tenths.is_finite() {
        true => format!("{} deg", short(tenths, 4)),
        false => super::degrees(x, 4),
    }
}

impl Watched<'_> {
    fn look(&mut self, place: &Place<'_>) {
        let (model, state) = (place.model, place.state);
        let [piston, head] = self
            .markers
            .map(|m| rows::marker(model, m, &state.pose, &state.velocity));
        let axis = head.rotation.column(2).into_owned();
        let travel = (piston.position - head.position).dot(&axis);
        self.travel.push((place.angle, travel));
        let places = [piston.position, head.position];
        if self.begin.is_none() {
            self.up = axis;
            let throw = self.throw(model);
            self.throw = throw.map(|(marker, _)| marker);
            self.rod_markers = throw.and_then(|(_, rod)| rod);
            self.rod_length = throw.and_then(|(_, rod)| {
                let [from, to] =
                    rod?.map(|m| rows::marker(model, m, &state.pose, &state.velocity).position);
                let shaft = shaft_axis(place)?;
                let along = to - from;
                Some((along - shaft * along.dot(&shaft)).norm())
            });
            let bodies = self.markers.map(|m| model.markers[m].body);
            self.guided = model.elements.iter().enumerate().any(|(e, element)| {
                let on = |body| {
                    element
                        .markers
                        .iter()
                        .any(|m| model.markers[*m].body == body)
                };
                model.constrains(e) && bodies.into_iter().all(on)
            });
            let crank = cycle_markers(model).and_then(|[turning, _]| model.markers[turning].body);
            // in a rotary engine the block turns, and it guides the piston
            self.on_crank = crank.is_some() && bodies[1] == crank && !self.guided;
        }
        let begin = self.begin.get_or_insert(places);
        for i in 0..2 {
            self.ways[i] = self.ways[i].max((places[i] - begin[i]).norm());
        }
        if self.beyond.is_none_or(|(highest, _)| travel > highest)
            && let Some(rod) = self.rod(model, place)
        {
            self.beyond = Some((travel, (rod - piston.position).dot(&axis) > 0.0));
        }
    }

    /// The centre of mass of the body that carries the piston. It is joined to the piston and is not the
    /// head's body.
    fn rod(&self, model: &Model, place: &Place<'_>) -> Option<V3> {
        let of = |marker: usize| model.markers[marker].body;
        let [piston, head] = self.markers.map(of);
        let mut elements = model.elements.iter().enumerate();
        let rod = elements.find_map(|(index, element)| {
            let joins = model.constrains(index);
            let bodies = || element.markers.iter().map(|m| of(*m));
            (joins && bodies().any(|b| b == piston))
                .then(|| bodies().find(|b| *b != piston && *b != head && b.is_some()))
                .flatten()
        })??;
        let body = &model.bodies[rod];
        let frame = body.frame(&place.state.pose);
        Some(frame.position + frame.rotation * body.center())
    }

    /// The marker on the crank (the body that turns with the cycle) to which joints and films lead from the
    /// piston. Also the two markers of the rod, if a single body is between crank and piston.
    fn throw(&self, model: &Model) -> Option<(usize, Option<[usize; 2]>)> {
        let of = |marker: usize| model.markers[marker].body;
        let crank = of(cycle_markers(model)?[0])?;
        let [piston, head] = self.markers.map(of);
        let films = &model.compiled.system.journals;
        let joins = |e: usize| {
            let film = films.iter().any(|journal| journal.element as usize == e);
            model.elements[e].dynamic && (film || !model.class(e).rows.is_empty())
        };
        let piston = piston?;
        // the reached bodies, each with the marker through which the search reached it from the piston
        let mut reached = vec![(piston, None)];
        let mut next = 0;
        while let Some((here, entered)) = reached.get(next).copied() {
            next += 1;
            for e in (0..model.elements.len()).filter(|e| joins(*e)) {
                let &[a, b] = model.elements[e].markers.as_slice() else {
                    continue;
                };
                for (from, to) in [(a, b), (b, a)] {
                    let Some(body) = of(to).filter(|_| of(from) == Some(here)) else {
                        continue;
                    };
                    if body == crank {
                        return Some((to, entered.map(|marker| [marker, from])));
                    }
                    if Some(body) != head && reached.iter().all(|(known, _)| *known != body) {
                        reached.push((body, (here == piston).then_some(to)));
                    }
                }
            }
        }
        None
    }

    /// The finding with the places that decide the motion: the throw, the bore and the constant that states
    /// the firing angle.
    fn with_places(&self, mut finding: Finding, compiled: &Compiled, wanted: &[Where]) -> Finding {
        let system = &compiled.system;
        let path = &system.elements[self.firing.element as usize].origin.path;
        let parameters = |slot: Slot| {
            let own = compiled.bind.parameters_of(slot).into_iter();
            own.filter_map(|index| Some(system.parameters.get(index as usize)?.origin.clone()))
        };
        let mut places = Vec::new();
        for place in wanted {
            match place {
                Where::Throw => {
                    let marker = self.throw.map(|m| &system.markers[m]);
                    let slots = marker.iter().flat_map(|marker| marker.position);
                    places.extend(slots.flat_map(parameters));
                    places.extend(marker.map(|marker| marker.origin.clone()));
                }
                Where::Rod => {
                    let markers = self.rod_markers.into_iter().flatten();
                    places.extend(markers.map(|m| system.markers[m].origin.clone()));
                }
                Where::Head => places.push(system.markers[self.markers[1]].origin.clone()),
                Where::Bore => places.extend(parameters(self.firing.bore)),
                Where::Firing => {
                    let path = format!("{path}.{}", self.firing.stated_as);
                    let stated = system.stated.get(&path).copied();
                    places.extend(stated.map(|at| Origin {
                        path,
                        used_at: Some(at),
                        defined_at: None,
                    }));
                    places.extend(parameters(self.firing.angle));
                }
            }
        }
        super::decide(&mut finding, places);
        finding
    }

    fn finding(&self, compiled: &Compiled, name: &str, message: String, help: &str) -> Finding {
        let element = &compiled.system.elements[self.firing.element as usize];
        Finding {
            code: codes::CYLINDER,
            name: name.to_owned(),
            origin: Origin {
                defined_at: None,
                ..element.origin.clone()
            },
            message,
            label: "the gas of this cylinder".to_owned(),
            help: help.to_owned(),
            ..Finding::default()
        }
    }

    /// A bore that is neither perpendicular to the crankshaft nor parallel to it.
    fn slanted(&self, compiled: &Compiled, shaft: V3) -> Option<Finding> {
        let off = libm::asin(self.up.dot(&shaft).abs().min(1.0));
        SLANTED.contains(&off).then(|| {
            let message = format!(
                "its bore is {} deg off the plane perpendicular to the crankshaft",
                short(off.to_degrees(), 3)
            );
            let help =
                "the z axis of a bore must be perpendicular to the shaft: check the components of the head's marker";
            let finding = self.finding(compiled, lint::BORE, message, help);
            self.with_places(finding, compiled, &[Where::Head])
        })
    }

    /// Gas whose markers are on the wrong bodies.
    fn misplaced(&self, compiled: &Compiled) -> Option<Finding> {
        let [own, other] = self.ways;
        if own < STANDS * other && other > NO_STROKE {
            let message = "the head moves and the piston is at rest: are they swapped?".to_owned();
            let help = "the first marker is the piston's";
            return Some(self.finding(compiled, lint::SWAPPED, message, help));
        }
        self.on_crank.then(|| {
            let message = "the head marker turns with the crank, and does not guide the piston".to_owned();
            let help = "the second marker is that of the head: put it on the block, which guides the piston";
            let finding = self.finding(compiled, lint::SWAPPED, message, help);
            self.with_places(finding, compiled, &[Where::Head])
        })
    }

    /// Gas whose piston and head keep the same distance.
    fn without_stroke(&self, compiled: &Compiled) -> Option<Finding> {
        let [own, other] = self.ways;
        let (message, help) = if own < NO_STROKE && self.throw.is_some() {
            (
                "the piston does not move while the crank turns".to_owned(),
                "is the rod joined to the pin of the crank, and is its throw stated?",
            )
        } else if own > NO_STROKE && other > NO_STROKE && !self.guided {
            (
                format!(
                    "piston and head both move by {} mm, and their distance stays the same: should they move against each other?",
                    short(1e3 * own, 3)
                ),
                "the gas has no stroke: check the gears, throws and axes of both",
            )
        } else {
            return None;
        };
        let finding = self.finding(compiled, lint::BORE, message, help);
        Some(self.with_places(finding, compiled, &[Where::Head, Where::Throw]))
    }

    fn doubts(&self, compiled: &Compiled) -> Vec<Finding> {
        let mut found = Vec::new();
        let highest = self.travel.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let lowest = self.travel.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let (Some((dead_center, high)), Some((_, low))) = (highest, lowest) else {
            return found;
        };
        // two pistons in one bore have a stroke each
        let [own, other] = self.ways;
        let stroke = match other > STANDS * own && !self.guided {
            true => (high - low) * own / (own + other),
            false => high - low,
        };
        if let Some(finding) = self.misplaced(compiled) {
            found.push(finding);
            return found;
        }
        if stroke < NO_STROKE {
            found.extend(self.without_stroke(compiled));
            return found;
        }
        if apart(self.angle, *dead_center) > OFF {
            let message = format!(
                "it fires at {}, its dead centre is at {}",
                deg(self.angle),
                deg(dead_center.rem_euclid(TAU))
            );
            let help = format!(
                "give `{}:` the cycle angle of this cylinder's firing dead centre",
                self.firing.stated_as
            );
            let finding = self.finding(compiled, lint::FIRING, message, &help);
            let places = [Where::Firing, Where::Head, Where::Throw];
            found.push(self.with_places(finding, compiled, &places));
        }
        let ratio = self.bore / stroke;
        if !BORE_TO_STROKE.contains(&ratio) {
            let message = format!(
                "a bore of {} mm for a stroke of {} mm",
                short(1e3 * self.bore, 4),
                short(1e3 * stroke, 4)
            );
            let finding = self.finding(
                compiled,
                lint::BORE,
                message,
                "bore over stroke is 0.6 to 1.7 in most engines: is a radius or a stroke given for a diameter or a throw?",
            );
            found.push(self.with_places(finding, compiled, &[Where::Bore, Where::Throw]));
        }
        if let Some(rod) = self.rod_length
            && !ROD_TO_THROW.contains(&(rod / (0.5 * stroke)))
        {
            let message = format!(
                "a rod of {} mm for a stroke of {} mm",
                short(1e3 * rod, 4),
                short(1e3 * stroke, 4)
            );
            let finding = self.finding(
                compiled,
                lint::BORE,
                message,
                "rods are two to ten times as long as the throw: check the markers of both",
            );
            found.push(self.with_places(finding, compiled, &[Where::Rod, Where::Throw]));
        }
        if matches!(self.beyond, Some((_, true))) {
            let message = "the rod is between piston and head: gas pulls it".to_owned();
            let finding = self.finding(
                compiled,
                lint::MIRRORED,
                message,
                "check the sign in the `branch` of the liner, and the direction of the head's z axis",
            );
            found.push(self.with_places(finding, compiled, &[Where::Head]));
        }
        found
    }
}
