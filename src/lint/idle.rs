//! Lints of elements and bodies without effect or with an unintended one: couplings that wind up, springs
//! between welded bodies, bodies on the ground.

use super::Finding;
use super::assembled::{Start, rpm};
use crate::codes;
use eng_runtime::joint::Joint;
use eng_runtime::loose::{kinetic_energy, springs, wound};
use eng_system::lint;
use eng_system::system::{Origin, Role};
use std::f64::consts::PI;

/// Largest slip of a coupling at the start, as a share of the speed. A choice: a coupling of parts that were
/// meant to run at one speed slips by rounding.
const SLIP: f64 = 0.1;

impl Start<'_> {
    /// The finding of a spring between bodies that turn against each other, such as a flywheel that is tied
    /// to the ground.
    pub(super) fn slips(&self, element: usize) -> Option<Finding> {
        let system = &self.model.compiled.system;
        let class = self.model.class(element);
        let markers = self.pair(element)?;
        let turned = system.elements[element]
            .rotations
            .iter()
            .any(|rotation| [rotation.turning, rotation.reference] == [0, 1]);
        if !class.rows.is_empty() || !class.facts.applies_load || !turned {
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
        if !matches!(springs(self.model, self.state, element), Ok(true))
            || !self.turns_on(element, markers)
        {
            return None;
        }
        let message = format!(
            "at the start {} turns at {} rpm and {} at {} rpm, so its spring winds up",
            self.path(markers[0]),
            rpm(speeds[0]),
            self.path(markers[1]),
            rpm(speeds[1])
        );
        let mut finding = self.finding(codes::IDLE, lint::IDLE, element, message);
        finding.help =
            "is each of its markers on the intended body, and is that body joined to the shaft?"
                .to_owned();
        let slower = markers[usize::from(speeds[1].abs() < speeds[0].abs())];
        super::decide(&mut finding, self.what_turns(markers[0], slower));
        Some(finding)
    }

    /// Whether the ends of a spring turn against each other by a whole turn or more, and wind it up. A torque over a
    /// wrapped angle repeats with each turn. A disc on a spring to the ground, without a drive, swings back if its
    /// energy is below `π ΔM`, the work of a linear spring in a turn with the torque `ΔM` at its end.
    fn turns_on(&self, element: usize, markers: [usize; 2]) -> bool {
        let Ok(wound) = wound(self.model, self.state, element) else {
            return false;
        };
        let driven = self.model.compiled.system.cycle.is_some()
            || (0..self.model.elements.len()).any(|e| {
                self.model.elements[e].dynamic && self.model.class(e).facts.rows_over_time
            });
        let to_ground = markers
            .iter()
            .any(|m| self.model.markers[*m].body.is_none());
        let swings = !driven && to_ground;
        wound > 0.0 && !(swings && kinetic_energy(self.model, self.state) < PI * wound)
    }

    /// A body and all bodies welded to it, without the ground.
    pub(super) fn welded_to(&self, body: usize) -> Vec<usize> {
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

    /// The finding of a spring, film or gas between two rigid bodies that are welded to each other.
    pub(super) fn between_welded(&self, element: usize) -> Option<Finding> {
        let class = self.model.class(element);
        let markers = self.pair(element)?;
        let [a, b] = markers.map(|m| self.model.markers[m].body);
        let (a, b) = (a?, b?);
        let rigid = [a, b]
            .iter()
            .all(|body| self.model.bodies[*body].modes() == 0);
        if !class.rows.is_empty() || !class.facts.applies_load || a == b || !rigid {
            return None;
        }
        self.welded_to(a).contains(&b).then(|| {
            let bodies = &self.model.compiled.system.bodies;
            let [a, b] = [a, b].map(|body| bodies[body].origin.path.as_str());
            let message = format!("{a} and {b} are joined rigidly, so this element moves nothing");
            let mut finding = self.finding(codes::IDLE, lint::IDLE, element, message);
            finding.help = "is the joint, or the element, on the bodies that are meant?".to_owned();
            super::decide(&mut finding, self.welds(&markers));
            finding
        })
    }

    /// The joints of six rows on the bodies of markers.
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

    /// The places where the text states how fast the ends of a coupling turn. These are the start velocities of
    /// the bodies that joints tie to one end, without the ground, and the support of the slower end.
    pub(super) fn what_turns(&self, end: usize, slower: usize) -> Vec<Origin> {
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

    /// The findings of bodies that are fixed to the ground and have no other element.
    pub(super) fn useless(&self) -> Vec<Finding> {
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
                let message =
                    "the body is fixed to the ground, and no other element acts on it".to_owned();
                let mut finding = self.finding(codes::IDLE, lint::IDLE, only, message);
                finding.origin.path.clone_from(&body.origin.path);
                finding.help =
                    "join it to the part that it should move with, or leave it out".to_owned();
                Some(finding)
            })
            .collect()
    }
}
