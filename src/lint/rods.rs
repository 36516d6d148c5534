//! Connecting rods whose centre of mass is not between their ends.

use super::{Finding, short};
use crate::codes;
use crate::machine::at;
use eng_runtime::joint;
use eng_system::code::Bound;
use eng_system::lint;
use eng_system::system::{BodyInertia, BodyRef, Marker, Origin, Role, System};

/// Share of a rod's length by which its centre of mass may be beyond an end. With a heavy big end it reaches
/// the pin's middle, and never passes it. A choice with room for that.
const BEYOND: f64 = 0.2;
/// Length (m) below which a rod is not checked. A choice: two markers at one place with a rounding are no
/// rod.
const SHORTEST: f64 = 0.01;

/// A joint of a body: the body's own marker, and the body it leads to.
struct Joint<'s> {
    own: &'s Marker,
    leads_to: BodyRef,
}

/// The findings of rigid bodies with two joints, one to a sliding body and one to another body, whose ends
/// are both on one side of the centre of mass.
pub(super) fn rods(system: &System, bound: &Bound) -> Vec<Finding> {
    let bodies = (0..system.bodies.len() as u32).map(BodyRef::Body);
    bodies.filter_map(|body| rod(system, bound, body)).collect()
}

fn rod(system: &System, bound: &Bound, body: BodyRef) -> Option<Finding> {
    let BodyRef::Body(index) = body else {
        return None;
    };
    let info = system.bodies.get(index as usize)?;
    let BodyInertia::Rigid { center_of_mass, .. } = &info.inertia else {
        return None;
    };
    let found = joints(system, body);
    let [a, b] = found.as_slice() else {
        return None;
    };
    let on_ground = [a, b].iter().any(|joint| joint.leads_to == BodyRef::Ground);
    let one_slides = slides(system, a.leads_to) != slides(system, b.leads_to);
    if on_ground || !one_slides || a.leads_to == b.leads_to {
        return None;
    }
    let place = |marker: &Marker| marker.position.map(|slot| at(bound, slot));
    let center = center_of_mass.map(|slot| at(bound, slot));
    let [from, to] = [a, b].map(|joint| place(joint.own));
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let less = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let along = less(to, from);
    let length = libm::sqrt(dot(along, along));
    // 0 at one end, 1 at the other
    let share = dot(less(center, from), along) / (length * length);
    if length < SHORTEST || (-BEYOND..1.0 + BEYOND).contains(&share) {
        return None;
    }
    let way = |end: [f64; 3]| {
        let arm = less(end, center);
        short(1e3 * libm::sqrt(dot(arm, arm)), 3)
    };
    let path = &info.origin.path;
    let mut finding = Finding {
        code: codes::INERTIA,
        name: lint::INERTIA.to_owned(),
        origin: Origin {
            defined_at: None,
            ..info.origin.clone()
        },
        message: format!(
            "both ends of the rod are on one side of its centre of mass, {} mm and {} mm from it",
            way(from),
            way(to)
        ),
        label: "this rod".to_owned(),
        help: "the centre of mass of a rod is between its ends: check the signs of its markers"
            .to_owned(),
        ..Finding::default()
    };
    let stated = format!("{path}.center_of_mass");
    let stated = system.stated.get(&stated).map(|at| Origin {
        path: stated.clone(),
        used_at: Some(*at),
        defined_at: None,
    });
    let ends = [a, b].map(|joint| joint.own.origin.clone());
    super::decide(&mut finding, stated.into_iter().chain(ends).collect());
    Some(finding)
}

/// The joints of a body: elements with equations, and films.
fn joints(system: &System, body: BodyRef) -> Vec<Joint<'_>> {
    let elements = system.elements.iter().enumerate();
    let joining = elements.filter(|(index, element)| {
        let film = |journal: &eng_system::system::JournalInfo| journal.element as usize == *index;
        let class = system.classes.get(element.class as usize);
        let joins =
            class.is_some_and(|class| !class.rows.is_empty()) || system.journals.iter().any(film);
        element.role == Role::Dynamic && joins
    });
    joining
        .filter_map(|(_, element)| {
            let &[a, b] = element.markers.as_slice() else {
                return None;
            };
            let [a, b] = [a, b].map(|marker| system.markers.get(marker as usize));
            let (a, b) = (a?, b?);
            let (own, other) = match (a.body == body, b.body == body) {
                (true, false) => (a, b),
                (false, true) => (b, a),
                _ => return None,
            };
            Some(Joint {
                own,
                leads_to: other.body,
            })
        })
        .collect()
}

/// Whether a guide holds a body so that it moves along a line, without turning: a piston, a crosshead.
fn slides(system: &System, body: BodyRef) -> bool {
    system.elements.iter().any(|element| {
        let on = |marker: &u32| {
            system
                .markers
                .get(*marker as usize)
                .is_some_and(|m| m.body == body)
        };
        let class = system.classes.get(element.class as usize);
        let guides = class.is_some_and(|class| joint::Joint::of(class) == joint::Joint::Guide);
        element.role == Role::Dynamic
            && guides
            // the first marker moves along the second's axis
            && element.markers.first().is_some_and(on)
    })
}
