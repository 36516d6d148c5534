//! Lints of the assembled machine: markers that stand apart, swapped pins and shells, couplings that slip, steps that are too long,
//! bodies that nothing holds.

use super::{Finding, short};
use crate::codes;
use eng_runtime::assembly::rows;
use eng_runtime::chain::MarkerKinematics;
use eng_runtime::joint::Joint;
use eng_runtime::loose::{Loose, loose, sag, springs};
use eng_runtime::model::Model;
use eng_runtime::rotation::V3;
use eng_runtime::state::State;
use eng_system::Dimension;
use eng_system::lint;
use eng_system::system::{AnalysisKind, Extent, Origin, Role, StepControl};

/// Most a step may turn the cycle (rad).
const LONG_STEP: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Share of the speed that a coupling may slip at the start.
const SLIP: f64 = 0.1;
/// A speed below this share of the other is none.
const STANDS: f64 = 1e-3;
/// Share of the shell's speed below which the pin is the one that stands.
const SLOWER: f64 = 0.5;
/// Offset along a line, in radii of gyration, from which two bodies stand beside each other; and in bores for a piston under gas: rods
/// that share a pin stand an eighth of a bore to its sides, and a small end a quarter of a bore wide would touch the pin's bosses.
const BESIDE: f64 = 2.0;
const BESIDE_IN_BORES: f64 = 0.2;
/// Share of the cycle's speed below which a body stands.
const STANDS_STILL: f64 = 0.01;
/// Part of the model's length, or of the spring's if that is longer, by which a machine that sinks on its
/// springs under its weight has none.
const SINKS: f64 = 0.5;
/// Share of gravity along a direction from which a body falls in it.
const FALLS: f64 = 0.1;
/// Most the cycle may turn between two samples (rad).
const COARSE: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// Shortest run of a turning machine (rad of its cycle) that is stated as an angle.
const SHORT: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Distance (m) from which a slide that no text places is told.
const UNPLACED: f64 = 0.01;

/// A model at its start, to be looked at.
pub(super) struct Start<'a> {
    pub model: &'a Model,
    pub state: &'a State,
}

/// What is probably wrong in an assembled model.
pub(super) fn assembled(start: &Start<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    for element in 0..start.model.elements.len() {
        if start.model.elements[element].dynamic {
            found.extend(start.beside(element));
            found.extend(start.unplaced(element));
            found.extend(start.slips(element));
            found.extend(start.between_welded(element));
        }
    }
    found.extend(start.swapped());
    found.extend(start.useless());
    found.extend(start.loose());
    found.extend(start.sinks());
    found.extend(start.backwards());
    found
}

/// A fixed step that turns the cycle too far.
pub(super) fn step(start: &Start<'_>, kind: &AnalysisKind, analysis: &Origin) -> Option<Finding> {
    let Some(StepControl::Fixed(step)) = kind.step() else {
        return None;
    };
    let speed = start.cycle_speed()?;
    let angle = step * speed;
    (angle > LONG_STEP).then(|| Finding {
        code: codes::LONG_STEP,
        name: lint::STEP.to_owned(),
        origin: analysis.clone(),
        message: format!(
            "a step of {} s turns the cycle by {} deg",
            short(step, 3),
            short(angle.to_degrees(), 3)
        ),
        label: "its step".to_owned(),
        help: format!(
            "a degree takes {} s; without `step` the error decides",
            short(1f64.to_radians() / speed, 2)
        ),
        decided_by: Vec::new(),
    })
}

/// Samples so far apart that they show nothing of a turn, and a run that ends before the machine has turned.
pub(super) fn sampling(start: &Start<'_>, kind: &AnalysisKind, analysis: &Origin) -> Vec<Finding> {
    let finding = |message: String, label: &str, help: &str| Finding {
        code: codes::SAMPLING,
        name: lint::SAMPLING.to_owned(),
        origin: analysis.clone(),
        message,
        label: label.to_owned(),
        help: help.to_owned(),
        decided_by: Vec::new(),
    };
    let Some((sample, duration)) = kind.sampling() else {
        return Vec::new();
    };
    if let (Extent::Time(sample), Some(Extent::Time(duration))) = (sample, duration)
        && sample > duration
    {
        let [sample, duration] = [sample, duration].map(|time| short(time, 4));
        let message = format!("the run of {duration} s ends before its first sample at {sample} s");
        return vec![finding(message, "its samples", "are both units right?")];
    }
    let Some(speed) = start.cycle_speed() else {
        return Vec::new();
    };
    let angle = |extent: Extent| match extent {
        Extent::Time(time) => time * speed,
        Extent::Angle(angle) => angle,
    };
    // a few milliseconds may be meant, a few degrees are `4 rev`
    let sample = angle(sample);
    let duration = match duration {
        Some(Extent::Angle(duration)) => Some(duration),
        Some(Extent::Time(_)) | None => None,
    };
    let deg = |angle: f64| short(angle.to_degrees(), 3);
    let mut found = Vec::new();
    if let Some(duration) = duration.filter(|duration| *duration < SHORT) {
        let message = format!("the run ends after {} deg of the cycle", deg(duration));
        found.push(finding(
            message,
            "its duration",
            "`4 rev` are four turns of the cycle's angle",
        ));
    } else if sample > COARSE {
        let message = format!("the cycle turns by {} deg between two samples", deg(sample));
        let help = "0.5 to 2 deg show forces and films; also no step is longer than a sample";
        found.push(finding(message, "its samples", help));
    }
    found
}

fn mm(x: f64) -> String {
    short(1e3 * x, 3)
}

fn rpm(x: f64) -> String {
    // rounding is no motion
    let x = if x.abs() < 1e-6 { 0.0 } else { x };
    short(x * 30.0 / std::f64::consts::PI, 4)
}

/// A direction in words.
fn axis(direction: &V3) -> String {
    let names = ["x", "y", "z"];
    match (0..3).find(|i| direction[*i].abs() > 0.999) {
        Some(i) => names[i].to_owned(),
        None => {
            let [a, b, c] = [0, 1, 2].map(|i| short(direction[i], 2));
            format!("[{a}, {b}, {c}]")
        }
    }
}

impl Start<'_> {
    fn origin(&self, element: usize) -> &Origin {
        &self.model.compiled.system.elements[element].origin
    }

    fn finding(&self, code: &'static str, name: &str, element: usize, message: String) -> Finding {
        Finding {
            code,
            name: name.to_owned(),
            // the class is not to blame
            origin: Origin {
                defined_at: None,
                ..self.origin(element).clone()
            },
            message,
            label: "of this".to_owned(),
            help: String::new(),
            decided_by: Vec::new(),
        }
    }

    fn marker(&self, marker: usize) -> MarkerKinematics {
        rows::marker(self.model, marker, &self.state.pose, &self.state.velocity)
    }

    fn path(&self, marker: usize) -> &str {
        &self.model.compiled.system.markers[marker].origin.path
    }

    /// The two markers of an element of two.
    fn pair(&self, element: usize) -> Option<[usize; 2]> {
        match self.model.elements[element].markers.as_slice() {
            [a, b] => Some([*a, *b]),
            _ => None,
        }
    }

    /// Speed of the cycle at the start (rad/s), if its angle is one between two markers.
    fn cycle_speed(&self) -> Option<f64> {
        let (_, rate) = self.cycle_rate()?;
        (rate != 0.0).then(|| rate.abs())
    }

    /// The markers of the cycle's angle, that which turns first, and its rate at the start (rad/s).
    fn cycle_rate(&self) -> Option<([usize; 2], f64)> {
        let system = &self.model.compiled.system;
        let element = system.cycle.as_ref()?.element as usize;
        let rotation = system.elements.get(element)?.rotations.first()?;
        let markers = &self.model.elements.get(element)?.markers;
        let turning = *markers.get(rotation.turning as usize)?;
        let reference = *markers.get(rotation.reference as usize)?;
        let rate = self.spin(&self.marker(turning), &self.marker(reference));
        Some(([turning, reference], rate))
    }

    /// A gas trace that is read from its end to its beginning.
    fn backwards(&self) -> Option<Finding> {
        let system = &self.model.compiled.system;
        let ([turning, reference], rate) = self.cycle_rate()?;
        let fastest = (0..self.model.bodies.len()).map(|body| self.spin_of(body));
        let fastest = fastest.fold(0.0, f64::max);
        // a shaft that stands or is about to fall over turns nowhere
        if system.firings.is_empty() || rate >= 0.0 || -rate < STANDS_STILL * fastest {
            return None;
        }
        let mut finding = Finding {
            code: codes::CYCLE,
            name: lint::CYCLE.to_owned(),
            origin: system.cycle.as_ref()?.origin.clone(),
            message: format!(
                "the cycle runs backwards, with {} rpm at the start: gas is read from the end of its cycle to the beginning",
                rpm(rate)
            ),
            label: "this angle falls".to_owned(),
            help: "measure the angle the way the crank turns, `rotation(crank.flange, ground)`, with the z axis of the second marker; or change the sign of the speed at start and drive".to_owned(),
            decided_by: Vec::new(),
        };
        let spin = |marker: usize| self.model.markers[marker].body.map(|b| self.spin_of(b));
        let [end, other] = match spin(turning) >= spin(reference) {
            true => [turning, reference],
            false => [reference, turning],
        };
        let mut places = self.what_drives(end);
        places.extend(self.what_turns(end, other));
        super::decide(&mut finding, places);
        Some(finding)
    }

    /// Drives on the shaft of a marker: joints of a single equation on an angle.
    fn what_drives(&self, end: usize) -> Vec<Origin> {
        let system = &self.model.compiled.system;
        let shaft = self.model.markers[end].body;
        let shaft = shaft.map_or(Vec::new(), |body| self.welded_to(body));
        let elements = system.elements.iter().zip(&self.model.elements).enumerate();
        let drives = elements.filter(|(e, (element, own))| {
            let mut bodies = own.markers.iter().map(|m| self.model.markers[*m].body);
            own.dynamic
                && self.model.class(*e).rows.len() == 1
                && !element.rotations.is_empty()
                && bodies.any(|b| b.is_some_and(|b| shaft.contains(&b)))
        });
        let origin = |element: &eng_system::system::Element| Origin {
            defined_at: None,
            ..element.origin.clone()
        };
        drives.map(|(_, (element, _))| origin(element)).collect()
    }

    /// Angular velocity about the second marker's z axis (rad/s).
    fn spin(&self, a: &MarkerKinematics, b: &MarkerKinematics) -> f64 {
        let about = b.rotation.column(2).into_owned();
        (a.rotation * a.angular_velocity - b.rotation * b.angular_velocity).dot(&about)
    }

    /// Radius of gyration of a marker's body (m); none for the ground and flexible bodies.
    fn gyration(&self, marker: usize) -> Option<f64> {
        let body = &self.model.bodies[self.model.markers[marker].body?];
        let about_center =
            body.inertia().diagonal().max() - body.mass() * body.center().norm_squared();
        (body.modes() == 0 && body.mass() > 0.0)
            .then(|| libm::sqrt(about_center.max(0.0) / body.mass()))
    }

    /// A point on a line that stands far from the other marker and never moves along it: a rod beside its piston.
    fn beside(&self, element: usize) -> Option<Finding> {
        let rows = &self.model.class(element).rows;
        let on_line = rows.len() == 2 && rows.iter().all(|row| row.dimension == Dimension::LENGTH);
        let markers = self.pair(element).filter(|_| on_line)?;
        let [a, b] = markers.map(|marker| self.marker(marker));
        let offset = a.position - b.position;
        let size = offset.norm();
        let radius = markers
            .iter()
            .filter_map(|marker| self.gyration(*marker))
            .fold(f64::INFINITY, f64::min);
        let moves = a.velocity.norm() + b.velocity.norm();
        let of_b = b.velocity + (b.rotation * b.angular_velocity).cross(&offset);
        let along = (a.velocity - of_b).dot(&offset).abs() / size;
        let bore = self
            .bore(&markers)
            .map_or(f64::INFINITY, |bore| BESIDE_IN_BORES * bore);
        let far = (BESIDE * radius).min(bore);
        if !(size > far && far > 0.0 && moves > 0.0 && along < STANDS * moves) {
            return None;
        }
        let message = format!(
            "{} stands {} mm beside {}, along the axis of the joint",
            self.path(markers[0]),
            mm(size),
            self.path(markers[1])
        );
        let mut finding = self.finding(codes::APART, lint::APART, element, message);
        finding.help = "are these markers of the same cylinder or bearing?".to_owned();
        let places = markers.map(|m| self.model.compiled.system.markers[m].origin.clone());
        super::decide(&mut finding, places.into());
        Some(finding)
    }

    /// The bore (m) of the gas on a piston that one of the markers is on.
    fn bore(&self, markers: &[usize; 2]) -> Option<f64> {
        let body = |marker: &usize| self.model.markers[*marker].body;
        let firings = &self.model.compiled.system.firings;
        let own = firings.iter().find(|firing| {
            let gas = &self.model.elements[firing.element as usize].markers;
            let piston = gas.get(firing.piston as usize).and_then(body);
            piston.is_some() && markers.iter().any(|marker| body(marker) == piston)
        })?;
        Some(self.model.slot(own.bore))
    }

    /// A slide that nothing but its guide places, and that stands far from the other marker because the text does not say where.
    fn unplaced(&self, element: usize) -> Option<Finding> {
        let system = &self.model.compiled.system;
        let rows = self.model.class(element).rows.len();
        let markers = self.pair(element).filter(|_| (2..6).contains(&rows))?;
        let body = self.model.markers[markers[0]]
            .body
            .or(self.model.markers[markers[1]].body)?;
        let info = system.bodies.get(body)?;
        let touches = |e: usize| {
            (self.model.elements[e].markers.iter())
                .any(|m| self.model.markers[*m].body == Some(body))
        };
        let placed = (0..self.model.elements.len()).any(|e| {
            let of_start = matches!(system.elements[e].role, Role::StartPosition { .. });
            let holds = self.model.elements[e].dynamic && !self.model.class(e).rows.is_empty();
            // a pin begins in the middle of its shell
            let film = system.journals.iter().any(|j| j.element as usize == e);
            e != element && touches(e) && (of_start || holds || film)
        });
        if info.position.is_some() || placed {
            return None;
        }
        let [a, b] = markers.map(|marker| self.marker(marker));
        let offset = (a.position - b.position).norm();
        (offset > UNPLACED).then(|| {
            let message = format!(
                "{} begins {} mm from {}: nothing says where it begins, and where nothing does, a body stands at the origin",
                self.path(markers[0]),
                mm(offset),
                self.path(markers[1])
            );
            let mut finding = self.finding(codes::APART, lint::APART, element, message);
            finding.help = format!("state it: `start position = […] mm` in `{}`, or `guess`", info.origin.path);
            finding
        })
    }

    /// A spring between things that turn against each other: a flywheel that is tied to the ground.
    fn slips(&self, element: usize) -> Option<Finding> {
        let system = &self.model.compiled.system;
        let class = self.model.class(element);
        let markers = self.pair(element)?;
        let turned = system.elements[element]
            .rotations
            .iter()
            .any(|rotation| [rotation.turning, rotation.reference] == [0, 1]);
        if !class.rows.is_empty() || !class.applies_load || !turned {
            return None;
        }
        let [a, b] = markers.map(|marker| self.marker(marker));
        let about = b.rotation.column(2).into_owned();
        let speeds = [a, b].map(|m| (m.rotation * m.angular_velocity).dot(&about));
        let slip = (speeds[0] - speeds[1]).abs();
        if slip <= SLIP * speeds[0].abs().max(speeds[1].abs()) || slip < 1.0 {
            return None;
        }
        // a brake or a damper does not wind up
        if !matches!(springs(self.model, self.state, element), Ok(true)) {
            return None;
        }
        let message = format!(
            "{} turns with {} rpm at the start, {} with {} rpm: it winds up",
            self.path(markers[0]),
            rpm(speeds[0]),
            self.path(markers[1]),
            rpm(speeds[1])
        );
        let mut finding = self.finding(codes::IDLE, lint::IDLE, element, message);
        finding.help = "is each of its markers on the body that is meant, and is that body joined to the shaft?".to_owned();
        let slower = markers[usize::from(speeds[1].abs() < speeds[0].abs())];
        super::decide(&mut finding, self.what_turns(markers[0], slower));
        Some(finding)
    }

    /// A body and all that welds tie to it, the ground left out.
    fn welded_to(&self, body: usize) -> Vec<usize> {
        let mut welded = vec![body];
        let mut next = 0;
        while let Some(here) = welded.get(next).copied() {
            next += 1;
            for (e, element) in self.model.elements.iter().enumerate() {
                let bodies = || {
                    let markers = element.markers.iter();
                    markers.filter_map(|m| self.model.markers[*m].body)
                };
                let holds = element.dynamic && Joint::of(self.model.class(e)) == Joint::Weld;
                if holds && bodies().any(|b| b == here) {
                    let new = bodies().filter(|b| !welded.contains(b));
                    welded.extend(new.collect::<Vec<_>>());
                }
            }
        }
        welded
    }

    /// A spring, film or gas between two rigid bodies that are welded to each other.
    fn between_welded(&self, element: usize) -> Option<Finding> {
        let class = self.model.class(element);
        let markers = self.pair(element)?;
        let [a, b] = markers.map(|m| self.model.markers[m].body);
        let (a, b) = (a?, b?);
        let rigid = [a, b]
            .iter()
            .all(|body| self.model.bodies[*body].modes() == 0);
        if !class.rows.is_empty() || !class.applies_load || a == b || !rigid {
            return None;
        }
        self.welded_to(a).contains(&b).then(|| {
            let bodies = &self.model.compiled.system.bodies;
            let [a, b] = [a, b].map(|body| bodies[body].origin.path.as_str());
            let message =
                format!("{a} and {b} are joined rigidly: it acts between them and moves nothing");
            let mut finding = self.finding(codes::IDLE, lint::IDLE, element, message);
            finding.help = "is the joint, or the element, on the bodies that are meant?".to_owned();
            super::decide(&mut finding, self.welds(&markers));
            finding
        })
    }

    /// The welds on the bodies of markers.
    fn welds(&self, markers: &[usize; 2]) -> Vec<Origin> {
        let body = |m: &usize| self.model.markers[*m].body;
        let on = |e: usize| {
            let own = &self.model.elements[e];
            let touches = |m: &usize| markers.iter().any(|other| body(other) == body(m));
            own.dynamic
                && Joint::of(self.model.class(e)) == Joint::Weld
                && own.markers.iter().any(touches)
        };
        let welds = (0..self.model.elements.len()).filter(|e| on(*e));
        welds
            .map(|e| Origin {
                defined_at: None,
                ..self.origin(e).clone()
            })
            .collect()
    }

    /// Where the start velocities of the shaft behind a coupling's end are stated: of the bodies that joints tie to it, the ground left
    /// out; and where its slower end hangs.
    fn what_turns(&self, end: usize, slower: usize) -> Vec<Origin> {
        let system = &self.model.compiled.system;
        let body_of = |marker: &usize| self.model.markers[*marker].body;
        let shaft = body_of(&end).map_or(Vec::new(), |body| self.welded_to(body));
        let starts = system.elements.iter().enumerate().filter(|(e, element)| {
            let mut bodies = self.model.elements[*e].markers.iter().filter_map(&body_of);
            matches!(element.role, Role::StartVelocity { .. }) && bodies.any(|b| shaft.contains(&b))
        });
        let mut places: Vec<Origin> = starts.map(|(_, element)| element.origin.clone()).collect();
        if places.is_empty() {
            let bodies = shaft.iter().skip(1).chain(&shaft[..shaft.len().min(1)]);
            places.extend(bodies.map(|b| system.bodies[*b].origin.clone()));
        }
        places.extend(body_of(&slower).map(|b| system.bodies[b].origin.clone()));
        places
    }

    /// Journals whose shell turns in a pin that does not.
    fn swapped(&self) -> Vec<Finding> {
        let system = &self.model.compiled.system;
        let mut found = Vec::new();
        for journal in &system.journals {
            let element = journal.element as usize;
            let own = &self.model.elements[element].markers;
            let (Some(pin), Some(shell)) = (
                own.get(journal.pin as usize),
                own.get(journal.shell as usize),
            ) else {
                continue;
            };
            let [a, b] = [*pin, *shell].map(|marker| self.marker(marker));
            let about = b.rotation.column(2).into_owned();
            let [of_pin, of_shell] =
                [a, b].map(|m| (m.rotation * m.angular_velocity).dot(&about).abs());
            if of_pin >= SLOWER * of_shell || of_shell < 1.0 {
                continue;
            }
            let message = format!(
                "the shell {} turns with {} rpm, the pin {} with {} rpm: are pin and shell swapped?",
                self.path(*shell),
                rpm(of_shell),
                self.path(*pin),
                rpm(of_pin)
            );
            found.push(self.finding(codes::SWAPPED, lint::SWAPPED, element, message));
        }
        found
    }

    /// Bodies that are held on the ground and that nothing else touches.
    fn useless(&self) -> Vec<Finding> {
        let system = &self.model.compiled.system;
        let bodies = self.model.bodies.iter().enumerate();
        bodies
            .filter_map(|(index, body)| {
                let mut touching = (0..self.model.elements.len()).filter(|e| {
                    let element = &self.model.elements[*e];
                    let on = |m: &usize| self.model.markers[*m].body == Some(index);
                    element.dynamic && element.markers.iter().any(on)
                });
                let only = touching.next()?;
                let welded = Joint::of(self.model.class(only)) == Joint::Weld
                    && (self.model.elements[only].markers.iter())
                        .any(|m| self.model.markers[*m].body.is_none());
                let range = body.velocity..body.velocity + 6;
                let stands = self.state.velocity[range].iter().all(|v| *v == 0.0);
                if touching.next().is_some() || !welded || !stands || system.bodies.len() < 2 {
                    return None;
                }
                let message = "it is held on the ground, and nothing else touches it".to_owned();
                let mut finding = self.finding(codes::IDLE, lint::IDLE, only, message);
                finding.origin.path.clone_from(&body.origin.path);
                finding.help = "join it to what it should move with, or leave it out".to_owned();
                Some(finding)
            })
            .collect()
    }

    /// Bodies that nothing holds in some direction.
    fn loose(&self) -> Vec<Finding> {
        // what cannot be evaluated is told by the run
        let Ok(found) = loose(self.model, self.state) else {
            return Vec::new();
        };
        let on_ground = self.joined_to_ground();
        found
            .iter()
            .filter(|motion| motion.bodies.iter().all(|b| on_ground[*b]))
            .filter(|motion| self.is_asked_for(motion))
            .map(|motion| self.loose_motion(motion))
            .collect()
    }

    /// A machine with a cycle is held but for its turning; so is a shaft on films.
    fn is_asked_for(&self, motion: &Loose) -> bool {
        let system = &self.model.compiled.system;
        let cycle = self.cycle_speed().is_some();
        // what swings about an axis may be held by its weight or by spin, but not where it stands while the machine turns: a shaft
        // without its gear
        if matches!(motion.about, Some((_, true))) {
            let slow = STANDS_STILL * self.cycle_speed().unwrap_or(0.0);
            return cycle && motion.bodies.iter().all(|body| self.spin_of(*body) < slow);
        }
        // a rotor that turns freely at a speed that its start states coasts, or is driven by a torque
        if motion.about.is_some() && motion.bodies.iter().all(|body| self.spin_of(*body) > 1.0) {
            return false;
        }
        // what moves in all directions hangs on nothing: told as such
        if motion.directions == 3 {
            return false;
        }
        // a shaft that turns and falls along its axis
        if let Some(along) = motion.along
            && along.dot(&self.gravity()).abs() > FALLS * self.gravity().norm()
            && motion.bodies.iter().any(|body| self.spin_of(*body) > 1.0)
        {
            return true;
        }
        let of_film = system.journals.iter().any(|journal| {
            let own = &self.model.elements[journal.element as usize].markers;
            own.iter().any(|m| {
                let body = self.model.markers[*m].body;
                body.is_some_and(|body| motion.bodies.contains(&body))
            })
        });
        of_film || cycle
    }

    /// A spring on which a body sinks farther than the machine is large.
    fn sinks(&self) -> Option<Finding> {
        // what cannot be evaluated is told by the run
        let (element, way) = sag(self.model, self.state, self.gravity()).ok().flatten()?;
        // the model's length is that of its bodies: a spring may be longer than all of them
        let apart = self.pair(element).map_or(0.0, |markers| {
            let [a, b] = markers.map(|marker| self.marker(marker));
            (a.position - b.position).norm()
        });
        if way < SINKS * self.model.length.max(apart) {
            return None;
        }
        let message = format!(
            "under the weight of what it carries it gives way by {} mm: is its stiffness in the right unit?",
            mm(way)
        );
        let mut finding = self.finding(codes::SINKS, lint::SAG, element, message);
        finding.help = "1 N/mm are 1000 N/m".to_owned();
        let system = &self.model.compiled.system;
        let stiffness = Dimension::MASS.over(Dimension::TIME.times(Dimension::TIME));
        let constants = system.elements[element].constants.iter();
        let parameters = constants
            .flat_map(|slot| self.model.compiled.bind.parameters_of(*slot))
            .filter_map(|index| system.parameters.get(index as usize))
            .filter(|parameter| parameter.dimension == stiffness);
        let places = parameters.map(|parameter| parameter.origin.clone());
        super::decide(&mut finding, places.collect());
        Some(finding)
    }

    /// Angular speed of a body at the start (rad/s).
    fn spin_of(&self, body: usize) -> f64 {
        let first = self.model.bodies[body].velocity;
        V3::from_column_slice(&self.state.velocity[first + 3..first + 6]).norm()
    }

    fn gravity(&self) -> V3 {
        V3::from(
            self.model
                .compiled
                .system
                .gravity
                .map(|slot| self.model.slot(slot)),
        )
    }

    fn loose_motion(&self, motion: &Loose) -> Finding {
        let system = &self.model.compiled.system;
        let origin = |body: &usize| &system.bodies[*body].origin;
        let first = origin(&motion.bodies[0]).clone();
        let directions = match (&motion.along, &motion.about, motion.motions) {
            (Some(direction), _, _) => format!("along {}", axis(direction)),
            (_, Some((direction, _)), _) => format!("about {}", axis(direction)),
            (_, _, count) => format!("in {count} directions"),
        };
        let others: Vec<&str> = motion.bodies[1..]
            .iter()
            .map(|body| origin(body).path.as_str())
            .collect();
        let with = match others.as_slice() {
            [] => String::new(),
            others => format!("; with it move {}", super::listed(others)),
        };
        Finding {
            code: codes::LOOSE,
            name: lint::LOOSE.to_owned(),
            origin: first,
            message: format!("nothing holds it {directions}: no joint, spring or film{with}"),
            label: "moves freely".to_owned(),
            help: "hold it by a joint, a spring or a film; a shaft on films has a thrust bearing such as `PointOnPlane`".to_owned(),
            decided_by: Vec::new(),
        }
    }

    /// Whether each body hangs together with the ground; what does not is told by the compiler.
    fn joined_to_ground(&self) -> Vec<bool> {
        let ground = self.model.bodies.len();
        let mut group: Vec<usize> = (0..=ground).collect();
        for element in self.model.elements.iter().filter(|e| e.dynamic) {
            let bodies: Vec<usize> = (element.markers.iter())
                .map(|m| self.model.markers[*m].body.unwrap_or(ground))
                .collect();
            for pair in bodies.windows(2) {
                let (from, to) = (group[pair[0]], group[pair[1]]);
                group
                    .iter_mut()
                    .filter(|g| **g == from)
                    .for_each(|g| *g = to);
            }
        }
        group
            .iter()
            .take(ground)
            .map(|g| *g == group[ground])
            .collect()
    }
}
