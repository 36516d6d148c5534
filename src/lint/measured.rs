//! A lint of forces with axes of their own: the markers of an axis and of the part on it are in each other's places.

use super::Finding;
use super::assembled::Start;
use crate::codes;
use eng_runtime::loose::loaded;
use eng_system::lint;

impl Start<'_> {
    /// The finding of a force whose first two markers are in each other's places, so that it loads the guide and measures the
    /// part. Such a force acts between a part in its guide and a shaft in its bearing, as between a tappet and its cam. It has
    /// the markers part, guide, shaft and bearing, and measures the angle of the shaft in the bearing. Guide and bearing are on
    /// one body, and take no load. So the mistake has three signs: the first marker is on the body of the bearing, the second
    /// one is on another body, and this marker takes no load.
    pub(super) fn measured_and_loaded(&self, element: usize) -> Option<Finding> {
        let system = &self.model.compiled.system;
        let class = self.model.class(element);
        let &[part, guide, shaft, bearing] = self.model.elements[element].markers.as_slice() else {
            return None;
        };
        let rotations = &system.elements[element].rotations;
        let of_shaft = !rotations.is_empty()
            && rotations
                .iter()
                .all(|rotation| [rotation.turning, rotation.reference] == [2, 3]);
        if !class.rows.is_empty() || !class.facts.applies_load || !of_shaft {
            return None;
        }
        let body = |marker: usize| self.model.markers[marker].body;
        let swapped = body(part) == body(bearing)
            && body(guide) != body(bearing)
            && body(guide) != body(shaft)
            && body(shaft) != body(bearing);
        if !swapped {
            return None;
        }
        // if it cannot be evaluated, the run reports the error
        let loads = loaded(self.model, self.state, element).ok()?;
        if loads.get(1).copied() != Some(false) || loads.first().copied() != Some(true) {
            return None;
        }
        let message = format!(
            "the load acts on {} and not on {}, which gives the direction alone: are these two markers swapped?",
            self.path(part),
            self.path(guide)
        );
        let mut finding = self.finding(codes::SWAPPED, lint::SWAPPED, element, message);
        finding.help =
            "the first marker is on the part that moves, the second one is its guide on the body of the bearing"
                .to_owned();
        Some(finding)
    }
}
