//! The closed chain of bodies that a joint belongs to, for messages about geometry.

use super::at;
use super::rows;
use crate::error::{Chain, ChainBody};
use crate::model::Model;
use crate::rotation::V3;
use crate::state::State;
use eng_system::Dimension;
use std::collections::VecDeque;

/// Difference of axes (1 − cosine) below which they are parallel: 2.6°. A choice: axes of one chain are
/// parallel but for small stated errors, which a message about lengths should not show.
const PARALLEL: f64 = 1e-3;

/// A joint or film between two bodies: element, and its markers on the bodies.
#[derive(Clone, Copy, Debug)]
struct Edge {
    element: usize,
    markers: [usize; 2],
}

/// The shortest closed chain of joints and films through an element; `None` without one.
///
/// The length of a body is the distance between the markers of its two joints across the axis that most
/// joints of the chain share (m). If both are ball or cardan joints, it is the distance in space, because the
/// body may then tilt.
pub fn through(model: &Model, element: usize, state: &State) -> Option<Chain> {
    let ground = model.bodies.len();
    let node = |marker: usize| model.markers[marker].body.unwrap_or(ground);
    let edges = edges(model, ground);
    let own = *edges.iter().find(|edge| edge.element == element)?;
    let [from, to] = own.markers.map(node);
    let mut reached: Vec<Option<Edge>> = vec![None; ground + 1];
    let mut queue = VecDeque::from([from]);
    while let Some(here) = queue.pop_front() {
        if here == to {
            break;
        }
        for edge in edges.iter().filter(|edge| edge.element != element) {
            for [a, b] in [edge.markers, [edge.markers[1], edge.markers[0]]] {
                if node(a) == here && node(b) != from && reached[node(b)].is_none() {
                    reached[node(b)] = Some(Edge {
                        element: edge.element,
                        markers: [a, b],
                    });
                    queue.push_back(node(b));
                }
            }
        }
    }
    let mut path = Vec::new();
    let mut here = to;
    while here != from {
        let edge = reached[here]?;
        path.push(edge);
        here = node(edge.markers[0]);
    }
    path.reverse();
    let axis = shared_axis(model, &path, state);
    let place = |marker: usize| rows::marker(model, marker, &state.pose, &state.velocity).position;
    // the two markers of each body of the chain: to the element before and to the element after
    let mut spans = Vec::new();
    let mut entered = (element, own.markers[0]);
    for edge in &path {
        spans.push([entered, (edge.element, edge.markers[0])]);
        entered = (edge.element, edge.markers[1]);
    }
    spans.push([entered, (element, own.markers[1])]);
    let origins = &model.compiled.system;
    let mut ground = None;
    let bodies = spans
        .into_iter()
        .filter_map(|ends| {
            let tilts = ends.iter().all(|(joint, _)| is_point(model, *joint));
            let axis = axis.filter(|_| !tilts);
            let markers = ends.map(|(_, marker)| marker);
            let along = place(markers[1]) - place(markers[0]);
            let across = axis.map_or(along, |n| along - n * along.dot(&n));
            let Some(body) = model.markers[markers[0]].body else {
                ground = Some(across.norm());
                return None;
            };
            // coordinates along the axis do not count for the length
            let rotation = model.bodies[body].frame(&state.pose).rotation;
            let axis = axis.map(|n| rotation.transpose() * n);
            let along = |i: usize| axis.is_some_and(|n| n[i].abs() > 1.0 - PARALLEL);
            let mut parameters: Vec<u32> = markers
                .iter()
                .filter_map(|m| origins.markers.get(*m))
                .flat_map(|marker| (0..3).filter(|i| !along(*i)).map(|i| marker.position[i]))
                .flat_map(|slot| model.compiled.bind.parameters_of(slot))
                .collect();
            parameters.sort_unstable();
            parameters.dedup();
            Some(ChainBody {
                origin: origins.bodies[body].origin.clone(),
                length: across.norm(),
                parameters,
                markers: markers.map(|m| origins.markers[m].origin.clone()),
            })
        })
        .collect();
    let joints = path
        .iter()
        .map(|edge| edge.element)
        .chain([element])
        .map(|e| {
            let reference = model.elements[e].markers.get(1).copied();
            let axis = reference.map(|m| {
                rows::marker(model, m, &state.pose, &state.velocity)
                    .rotation
                    .column(2)
                    .into_owned()
            });
            (origins.elements[e].origin.clone(), axis.map(Into::into))
        })
        .collect();
    let mut elements = path.iter().map(|edge| edge.element).chain([element]);
    Some(Chain {
        joints,
        bodies,
        ground,
        of_points: elements.all(|element| held_lengths(model, element) == 3),
    })
}

/// Number of equations of a joint that are lengths.
pub(super) fn held_lengths(model: &Model, element: usize) -> usize {
    let rows = model.class(element).rows.iter();
    rows.filter(|row| row.dimension == Dimension::LENGTH)
        .count()
}

/// Whether a joint holds a point, or a point and one angle: a ball or cardan joint.
fn is_point(model: &Model, element: usize) -> bool {
    held_lengths(model, element) == 3 && model.class(element).rows.len() < 5
}

/// Joints with equations and films between two bodies, or a body and the ground.
fn edges(model: &Model, ground: usize) -> Vec<Edge> {
    let node = |marker: usize| model.markers[marker].body.unwrap_or(ground);
    let mut edges = Vec::new();
    let pins = rows::pins(model);
    for (index, element) in model.elements.iter().enumerate() {
        let film = pins.iter().any(|pin| pin.element == index);
        if !element.dynamic || (model.class(index).rows.is_empty() && !film) {
            continue;
        }
        if let [a, b, ..] = element.markers[..]
            && node(a) != node(b)
        {
            edges.push(Edge {
                element: index,
                markers: [a, b],
            });
        }
    }
    edges
}

/// The direction of the z axes of most joints of a chain whose two markers agree in it.
fn shared_axis(model: &Model, path: &[Edge], state: &State) -> Option<V3> {
    let at = at(state);
    let axis = |marker: usize| -> V3 {
        rows::marker(model, marker, at.pose, at.velocity)
            .rotation
            .column(2)
            .into_owned()
    };
    let same = |a: &V3, b: &V3| a.dot(b).abs() > 1.0 - PARALLEL;
    let axes: Vec<V3> = path
        .iter()
        .map(|edge| edge.markers.map(axis))
        .filter(|[a, b]| same(a, b))
        .map(|[_, b]| b)
        .collect();
    let votes = |n: &V3| axes.iter().filter(|other| same(n, other)).count();
    // among equal ones the first
    let mut best: Option<(usize, V3)> = None;
    for n in &axes {
        let count = votes(n);
        if best.is_none_or(|(most, _)| count > most) {
            best = Some((count, *n));
        }
    }
    best.map(|(_, n)| n)
}
