//! Lints of the turning machine: gas that fires at no dead centre, bores and strokes, pistons on the wrong side.
//!
//! The machine is turned once through its cycle by its geometry ([`eng_runtime::assembly::turn`]). Of each cylinder, an element that
//! fires, it is watched how far its piston is from its head along the bore.

use super::{Finding, short};
use crate::codes;
use crate::local::at;
use eng_runtime::assembly::rows;
use eng_runtime::assembly::turn::{Place, turn};
use eng_runtime::model::Model;
use eng_runtime::rotation::V3;
use eng_system::code::{Bound, Compiled};
use eng_system::lint;
use eng_system::system::{FiringInfo, Origin};
use std::f64::consts::{PI, TAU};

/// Most that a firing angle may be off its dead centre; offset and inclined bores move it by some degrees.
const OFF: f64 = 25.0 * PI / 180.0;
/// Bore over stroke of engines: from slow marine two-strokes to racing engines.
const BORE_TO_STROKE: std::ops::Range<f64> = 0.6..1.7;
/// Shortest stroke (m) that is one.
const NO_STROKE: f64 = 1e-3;
/// Share of the other's way below which a body stands.
const STANDS: f64 = 0.1;

/// What one cylinder does in a turn.
struct Watched<'s> {
    firing: &'s FiringInfo,
    angle: f64,
    bore: f64,
    /// Markers: piston and head.
    markers: [usize; 2],
    /// Cycle angle (rad) and place of the piston along the head's axis (m).
    travel: Vec<(f64, f64)>,
    /// Where piston and head were first, and the farthest they have been from there (m).
    begin: Option<[V3; 2]>,
    ways: [f64; 2],
    /// Whether the rod stands beyond the piston, seen from the head, when the piston is highest; with that height.
    beyond: Option<(f64, bool)>,
}

/// What is probably wrong in the cylinders of a model; nothing where it has none, does not turn, or locks, which is told elsewhere.
pub(super) fn turned(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    bound: &Bound,
) -> Vec<Finding> {
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
            beyond: None,
        })
        .collect();
    if cylinders.is_empty() {
        return Vec::new();
    }
    let found = turn(compiled, overrides, &mut |place| {
        for cylinder in &mut cylinders {
            cylinder.look(place);
        }
        Ok(())
    });
    if !matches!(found, Ok(true)) {
        return Vec::new();
    }
    cylinders
        .iter()
        .flat_map(|cylinder| cylinder.doubts(compiled))
        .collect()
}

/// The distance of two angles on a circle of a turn (rad).
fn apart(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(TAU);
    d.min(TAU - d)
}

fn deg(x: f64) -> String {
    short(libm::round(x.to_degrees() * 10.0) / 10.0, 4)
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

    /// The centre of mass of the body that carries the piston: joined to it, and not the head's.
    fn rod(&self, model: &Model, place: &Place<'_>) -> Option<V3> {
        let of = |marker: usize| model.markers[marker].body;
        let [piston, head] = self.markers.map(of);
        let mut elements = model.elements.iter().enumerate();
        let rod = elements.find_map(|(index, element)| {
            let joins = element.dynamic && !model.class(index).rows.is_empty();
            let bodies = || element.markers.iter().map(|m| of(*m));
            (joins && bodies().any(|b| b == piston))
                .then(|| bodies().find(|b| *b != piston && *b != head && b.is_some()))
                .flatten()
        })??;
        let body = &model.bodies[rod];
        let frame = body.frame(&place.state.pose);
        Some(frame.position + frame.rotation * body.center())
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
            label: "of this cylinder".to_owned(),
            help: help.to_owned(),
            decided_by: Vec::new(),
        }
    }

    fn doubts(&self, compiled: &Compiled) -> Vec<Finding> {
        let mut found = Vec::new();
        let highest = self.travel.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let lowest = self.travel.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let (Some((dead_center, high)), Some((_, low))) = (highest, lowest) else {
            return found;
        };
        let stroke = high - low;
        if self.ways[0] < STANDS * self.ways[1] {
            let message = "the head moves and the piston stands: are they swapped?".to_owned();
            found.push(self.finding(
                compiled,
                lint::SWAPPED,
                message,
                "the first marker is the piston's",
            ));
            return found;
        }
        if stroke < NO_STROKE {
            return found;
        }
        if apart(self.angle, *dead_center) > OFF {
            let message = format!(
                "it fires at {} deg, its dead centre is at {} deg",
                deg(self.angle),
                deg(dead_center.rem_euclid(TAU))
            );
            found.push(self.finding(
                compiled,
                lint::FIRING,
                message,
                "give `firing:` the cycle angle of this cylinder's firing dead centre",
            ));
        }
        let ratio = self.bore / stroke;
        if !BORE_TO_STROKE.contains(&ratio) {
            let message = format!(
                "a bore of {} mm for a stroke of {} mm",
                short(1e3 * self.bore, 4),
                short(1e3 * stroke, 4)
            );
            found.push(self.finding(
                compiled,
                lint::BORE,
                message,
                "bore over stroke is 0.6 to 1.7 in most engines: is a radius or a stroke given for a diameter or a throw?",
            ));
        }
        if matches!(self.beyond, Some((_, true))) {
            let message = "the rod stands between piston and head: gas pulls it".to_owned();
            found.push(self.finding(
                compiled,
                lint::MIRRORED,
                message,
                "is the `branch` of the liner, or the head's z axis, the wrong way round?",
            ));
        }
        found
    }
}
