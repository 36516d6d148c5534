//! Lints of axes that should be parallel: those of angles and films.

use super::assembled::Start;
use super::{Finding, decide, short};
use crate::codes;
use eng_system::lint;
use eng_system::system::Role;

/// Least angle (rad) between two axes that are not parallel. At 5° an angle differs by up to 0.11°
/// from that of the shaft, by the relation of a universal joint, `tan a' = cos 5° tan a`. Clearances leave
/// the pin of a film less than a tenth of this. The angle is a choice between these.
const ASKEW: f64 = 5.0 * std::f64::consts::PI / 180.0;

impl Start<'_> {
    /// Angles about an axis that is not parallel to the turning one, and pins that are not parallel to their
    /// shells.
    pub(super) fn askew(&self) -> Vec<Finding> {
        let system = &self.model.compiled.system;
        let journals = system.journals.iter().filter_map(|journal| {
            let effect = "the film assumes that pin and shell are parallel";
            self.across(journal.element, [journal.pin, journal.shell], effect)
        });
        let measured = (0..).zip(&system.elements).filter_map(|(index, element)| {
            let measures = matches!(element.role, Role::Dynamic | Role::Output);
            let rotations = element.rotations.iter().filter(|_| measures);
            // an element with several angles has them between the same markers
            rotations
                .map(|rotation| [rotation.turning, rotation.reference])
                .find_map(|pair| self.across(index, pair, "angles are measured about that axis"))
        });
        journals.chain(measured).collect()
    }

    /// The finding for two markers of an element whose z axes are not parallel.
    fn across(&self, element: u32, pair: [u32; 2], effect: &str) -> Option<Finding> {
        let element = element as usize;
        let own = &self.model.elements[element].markers;
        let [first, second] = pair.map(|local| own.get(local as usize).copied());
        let markers = [first?, second?];
        let [a, b] = markers.map(|marker| self.marker(marker).rotation.column(2).into_owned());
        let tilt = libm::atan2(a.cross(&b).norm(), a.dot(&b).abs());
        if tilt.is_nan() || tilt < ASKEW {
            return None;
        }
        let [a, b] = markers.map(|marker| self.path(marker));
        let message = format!(
            "the z axis of {a} is {} deg from the z axis of {b}: {effect}",
            short(tilt.to_degrees(), 3)
        );
        let mut finding = self.finding(codes::ASKEW, lint::ASKEW, element, message);
        finding.label = "between these axes".to_owned();
        finding.help = "turn a marker: `at(…, z: …)` points its z axis".to_owned();
        let places = markers.map(|m| self.model.compiled.system.markers[m].origin.clone());
        decide(&mut finding, places.into());
        Some(finding)
    }
}
