//! What hangs together: bodies, elements, ground. The rank of the constraints is the runtime's business.

use super::Elaborator;
use eng_grammar::{Diagnostic, SourceId, Span};
use eng_system::system::{BodyRef, Location};

impl Elaborator<'_, '_> {
    /// Lints on bodies that nothing holds and markers that nothing uses.
    pub fn connections(&mut self, model: Span) {
        let ground = self.bodies.len();
        let mut parent: Vec<usize> = (0..=ground).collect();
        let mut touched = vec![false; ground + 1];
        for element in &self.elements {
            if !Self::acts(element.role) {
                continue;
            }
            let bodies: Vec<usize> = element
                .markers
                .iter()
                .map(|m| match self.markers[*m as usize].body {
                    BodyRef::Ground => ground,
                    BodyRef::Body(b) => b as usize,
                })
                .collect();
            for b in &bodies {
                touched[*b] = true;
                let (x, y) = (root(&parent, *b), root(&parent, bodies[0]));
                parent[x] = y;
            }
        }
        let mut found = Vec::new();
        let mut groups: Vec<usize> = Vec::new();
        for (b, body) in self.bodies.iter().enumerate() {
            let origin = &body.origin;
            let Some(place) = origin.used_at else {
                continue;
            };
            let path = &origin.path;
            if !touched[b] {
                found.push(
                    Diagnostic::warning("W0503", format!("body {path} is tied to nothing"))
                        .at(span(place), "no joint, force or journal touches it"),
                );
                continue;
            }
            let r = root(&parent, b);
            if r != root(&parent, ground) && !groups.contains(&r) {
                groups.push(r);
                let members: Vec<&str> = (0..ground)
                    .filter(|c| root(&parent, *c) == r)
                    .map(|c| self.bodies[c].origin.path.as_str())
                    .collect();
                found.push(
                    Diagnostic::warning("W0504", format!("{path} has no path to the ground"))
                        .at(span(place), "it will fall or drift")
                        .with_note(format!("it hangs together with: {}", members.join(", ")))
                        .with_help("tie one of these to `ground` by a joint or a force, if that is not meant"),
                );
            }
        }
        for (marker, used) in self.markers.iter().zip(&self.used_markers) {
            if let (false, Some(place)) = (*used, marker.origin.used_at) {
                found.push(
                    Diagnostic::warning(
                        "W0501",
                        format!("marker {} is not used", marker.origin.path),
                    )
                    .at(span(place), "nothing refers to it"),
                );
            }
        }
        if self.gravity.is_none() && !self.bodies.is_empty() {
            found.push(
                Diagnostic::note("N0501", "no gravity is stated: it is zero")
                    .at(model, "in this model")
                    .with_help(
                        "write `gravity = [0, 0, -9.81] m/s^2`, or zeros to say that it is meant",
                    ),
            );
        }
        for d in found {
            self.diagnostics.push(d);
        }
    }
}

fn root(parent: &[usize], mut i: usize) -> usize {
    while parent[i] != i {
        i = parent[i];
    }
    i
}

fn span(place: Location) -> Span {
    Span {
        source: SourceId(place.source),
        start: place.start,
        end: place.end,
    }
}
