//! Messages about connections: unused markers, unconstrained bodies, idle forces. The runtime computes the rank of the
//! constraints.

use super::Elaborator;
use super::binding::span_of;
use crate::codes;
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;
use eng_system::system::{BodyRef, Location, Origin, Role};
use eng_system::{lint, sentence};
use std::collections::BTreeSet;

impl Elaborator<'_, '_> {
    fn unused_markers(&self) -> Vec<(Location, Vec<&str>)> {
        let markers = self.draft.markers.iter().zip(&self.draft.used_markers);
        let mut unused = by_place(
            markers
                .filter(|(_, used)| !**used)
                .map(|(marker, _)| &marker.origin),
        );
        unused.sort_by_key(|(place, _)| (place.source, place.start));
        unused
    }

    /// Warnings about elastic surfaces that no field presses on.
    fn unused_surfaces(&self) -> Vec<Diagnostic> {
        let pressed: BTreeSet<u32> = (self.draft.elements.iter())
            .flat_map(|element| {
                let local = element.fields.iter().filter_map(|field| field.surface);
                local.filter_map(|marker| element.markers.get(marker as usize).copied())
            })
            .collect();
        let bodies = self.draft.flexible.iter().flatten();
        let markers = bodies.flat_map(|body| body.source.markers.iter().zip(&body.markers));
        markers
            .filter(|(source, marker)| source.surface.is_some() && !pressed.contains(marker))
            .filter_map(|(source, marker)| Some((source, self.draft.markers.get(*marker as usize)?)))
            .map(|(source, marker)| {
                Diagnostic::warning(
                    codes::UNUSED_MARKER,
                    format!("the elastic surface of {} is not used", marker.origin.path),
                )
                .at(span_of(source.at), "no film presses on it")
                .with_help("take a law that solves its film on cells, with this marker as its shell; or leave `surface` out")
            })
            .collect()
    }

    /// The message about an element with equations whose markers are all on one rigid body. `bodies` are
    /// those of its markers; the ground has the index after all bodies.
    fn against_itself(
        &self,
        element: &super::ElementDraft<'_>,
        bodies: &[usize],
    ) -> Option<Diagnostic> {
        let (first, others) = bodies.split_first()?;
        let bends = self.draft.flexible.get(*first).is_some_and(Option::is_some);
        if element.meta.rows.is_empty() || bends || others.iter().any(|b| b != first) {
            return None;
        }
        let on = match self.draft.bodies.get(*first) {
            Some(body) => format!("`{}`", body.origin.path),
            None => "the ground".to_owned(),
        };
        let path = &element.origin.path;
        Some(
            Diagnostic::error(
                codes::SAME_BODY,
                format!("`{path}` constrains {on} against itself"),
            )
            .at(element.span, format!("its markers are all on {on}"))
            .with_help(
                "take a marker of each of the two bodies; a marker of the model is on the ground",
            ),
        )
    }

    /// The body or the ground, in words.
    fn named(&self, body: BodyRef) -> String {
        match body {
            BodyRef::Body(body) => format!("`{}`", self.draft.bodies[body as usize].origin.path),
            BodyRef::Ground => "the ground".to_owned(),
        }
    }

    /// Elements between markers of one body, whose loads cancel. Loads without `against` are external and do
    /// not cancel.
    fn idle_elements(&mut self) -> Vec<Diagnostic> {
        let found: Vec<(String, Diagnostic)> = (self.draft.elements.iter())
            .filter(|element| element.role == Role::Dynamic)
            .filter_map(|element| {
                let message = self
                    .loads_itself(element)
                    .or_else(|| self.geared_to_itself(element))?;
                Some((element.origin.path.clone(), message))
            })
            .collect();
        let reported = found
            .into_iter()
            .filter(|(path, _)| !self.accepts(lint::IDLE, path));
        reported.map(|(_, message)| message).collect()
    }

    /// The message about an element whose loads act between a marker and itself, or between markers of one
    /// rigid body.
    fn loads_itself(&self, element: &super::ElementDraft<'_>) -> Option<Diagnostic> {
        let global = |local: &u32| element.markers.get(*local as usize).copied();
        let body = |local: &u32| Some(self.draft.markers.get(global(local)? as usize)?.body);
        let bends = |body: BodyRef| match body {
            BodyRef::Body(b) => self
                .draft
                .flexible
                .get(b as usize)
                .is_some_and(Option::is_some),
            BodyRef::Ground => false,
        };
        let (first, _) = element.applied.first()?;
        let cancels = |(on, against): &(u32, Option<u32>)| {
            let Some(against) = against else {
                return false;
            };
            let own = body(on);
            on == against || own == body(against) && own.is_some_and(|own| !bends(own))
        };
        if !element.meta.rows.is_empty() || !element.applied.iter().all(cancels) {
            return None;
        }
        let path = &element.origin.path;
        let on = self.named(body(first)?);
        let same = element.applied.iter().all(|(a, b)| Some(*a) == *b);
        let label = match (same, global(first)) {
            (true, Some(marker)) => {
                let marker = &self.draft.markers[marker as usize].origin.path;
                format!("from `{marker}` to itself")
            }
            _ => format!("from {on} to itself"),
        };
        Some(
            Diagnostic::warning(
                codes::MOVES_NOTHING,
                format!("`{path}` acts between {on} and itself: it moves nothing"),
            )
            .at(element.span, label)
            .with_help(
                "take a marker of each of the two bodies; a marker of the model is on the ground",
            )
            .acceptable(lint::IDLE),
        )
    }

    /// The message about an equation of angles, such as a gear's, with the same two markers twice.
    fn geared_to_itself(&self, element: &super::ElementDraft<'_>) -> Option<Diagnostic> {
        let arguments = &element.source.as_ref()?.arguments;
        let given = arguments.iter().filter(|(_, argument)| {
            matches!(
                argument,
                super::Argument::Value(super::value::Value::Marker(_))
            )
        });
        let [row] = element.meta.rows.as_slice() else {
            return None;
        };
        let twice = given.count() >= 4 && element.markers.len() == 2;
        if !twice || row.dimension != Dimension::ANGLE || element.rotations.is_empty() {
            return None;
        }
        let path = &element.origin.path;
        let on = element.markers.first()?;
        let on = self.named(self.draft.markers.get(*on as usize)?.body);
        Some(
            Diagnostic::warning(
                codes::MOVES_NOTHING,
                format!("`{path}` couples the rotation of {on} to itself: it does not turn"),
            )
            .at(element.span, "the same two markers twice")
            .with_help("take the markers of both wheels")
            .acceptable(lint::IDLE),
        )
    }

    /// Whether all bodies are meant to fly freely: no element touches the ground, there is no cycle, and the
    /// text states zero gravity or a body begins with a velocity.
    fn flies(&self, grounded: bool) -> bool {
        let graph = &self.graphs.bind.graph;
        let zero = |n: &crate::ir::Node| graph.as_constant(*n) == Some(0.0);
        let weightless = self
            .draft
            .gravity
            .as_ref()
            .is_some_and(|g| g.iter().all(zero));
        let thrown = (self.draft.elements.iter())
            .any(|element| matches!(element.role, Role::StartVelocity { exact: true }));
        !grounded && self.draft.cycle.is_none() && (weightless || thrown)
    }

    /// Lints on bodies that nothing holds and markers that nothing uses.
    pub fn connections(&mut self, model: Span) {
        let ground = self.draft.bodies.len();
        let mut found = Vec::new();
        let mut parent: Vec<usize> = (0..=ground).collect();
        let mut touched = vec![false; ground + 1];
        for element in &self.draft.elements {
            if !Self::acts(element.role) {
                continue;
            }
            let bodies: Vec<usize> = element
                .markers
                .iter()
                .map(|m| match self.draft.markers[*m as usize].body {
                    BodyRef::Ground => ground,
                    BodyRef::Body(b) => b as usize,
                })
                .collect();
            if let Some(message) = self.against_itself(element, &bodies) {
                found.push(message);
            }
            for b in &bodies {
                touched[*b] = true;
                let (x, y) = (root(&parent, *b), root(&parent, bodies[0]));
                parent[x] = y;
            }
        }
        let free = self.flies(touched[ground]);
        let untied: Vec<Origin> = (0..ground)
            .filter(|b| !touched[*b] && !free)
            .map(|b| self.draft.bodies[b].origin.clone())
            .collect();
        let untied: Vec<Origin> = untied
            .into_iter()
            .filter(|origin| !self.accepts(lint::LOOSE, &origin.path))
            .collect();
        for (place, paths) in by_place(untied.iter()) {
            let (noun, verb) = match paths.len() {
                1 => ("body", "is"),
                _ => ("bodies", "are"),
            };
            found.push(
                Diagnostic::warning(
                    codes::UNTIED,
                    format!("{noun} {} {verb} connected to nothing", listed(&paths)),
                )
                .at(
                    span_of(place),
                    "no joint, force, journal or drive acts on it",
                )
                .with_help("connect it to something, or remove it")
                .acceptable(lint::LOOSE),
            );
        }
        let mut groups: Vec<usize> = Vec::new();
        for b in (0..ground).filter(|b| touched[*b] && !free) {
            let origin = self.draft.bodies[b].origin.clone();
            let Some(place) = origin.used_at else {
                continue;
            };
            let path = &origin.path;
            let r = root(&parent, b);
            if r != root(&parent, ground) && !groups.contains(&r) {
                groups.push(r);
                if self.accepts(lint::LOOSE, path) {
                    continue;
                }
                let members: Vec<&str> = (0..ground)
                    .filter(|c| root(&parent, *c) == r)
                    .map(|c| self.draft.bodies[c].origin.path.as_str())
                    .collect();
                found.push(
                    Diagnostic::warning(codes::ADRIFT, format!("{path} is not connected to the ground"))
                        .at(span_of(place), "it will fall or drift")
                        .with_note(format!("it is connected to: {}", members.join(", ")))
                        .with_help("connect one of these to `ground` by a joint or a force, unless you intend that")
                        .acceptable(lint::LOOSE),
                );
            }
        }
        found.extend(self.idle_elements());
        found.extend(self.unused_surfaces());
        for (place, paths) in self.unused_markers() {
            let (noun, verb) = match paths.len() {
                1 => ("marker", "is"),
                _ => ("markers", "are"),
            };
            found.push(
                Diagnostic::warning(
                    codes::UNUSED_MARKER,
                    format!("{noun} {} {verb} not used", listed(&paths)),
                )
                .at(span_of(place), "nothing refers to it"),
            );
        }
        if self.draft.gravity.is_none() && !self.draft.bodies.is_empty() {
            found.push(
                Diagnostic::note(codes::NO_GRAVITY, "no gravity is stated: it is zero")
                    .at(model, "in this model")
                    .with_help(
                        "write `gravity = [0, 0, -9.81] m/s^2`, or zeros if you intend this",
                    ),
            );
        }
        for d in found {
            self.diagnostics.push(d);
        }
    }
}

/// Paths, grouped by their place in the text, in the order of the text.
fn by_place<'o>(origins: impl Iterator<Item = &'o Origin>) -> Vec<(Location, Vec<&'o str>)> {
    let mut places: Vec<(Location, Vec<&str>)> = Vec::new();
    for origin in origins {
        let Some(place) = origin.used_at else {
            continue;
        };
        match places.iter_mut().find(|(known, _)| *known == place) {
            Some((_, paths)) => paths.push(&origin.path),
            None => places.push((place, vec![&origin.path])),
        }
    }
    places
}

/// Paths as a list in a sentence.
pub(super) fn listed(paths: &[&str]) -> String {
    sentence::listed(paths, 5)
}

fn root(parent: &[usize], mut i: usize) -> usize {
    while parent[i] != i {
        i = parent[i];
    }
    i
}
