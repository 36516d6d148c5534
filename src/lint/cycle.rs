//! Lints of the cycle: fixed steps and samples that are too long for its speed, and gas that is read
//! backwards.

use super::assembled::Start;
use super::{Finding, short};
use crate::codes;
use eng_runtime::chain::MarkerKinematics;
use eng_system::lint;
use eng_system::system::{AnalysisKind, Extent, Origin};

/// Largest turn of the cycle in a step (rad): 10°. A choice: gas and films of an engine change within it, and
/// the angle between two bodies still is known.
const LONG_STEP: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Largest turn of the cycle between two samples (rad): 30°. A choice: twelve samples a turn show its orders
/// up to six at most, and no peak of a pressure.
const COARSE: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// Shortest run of a turning machine (rad of its cycle) that gives no warning: 5°. A choice: a shorter one
/// has probably a wrong unit of its time.
const SHORT: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// The finding of a fixed step that turns the cycle too far.
pub(super) fn step(start: &Start<'_>, kind: &AnalysisKind, analysis: &Origin) -> Option<Finding> {
    let step = kind.step()?.fixed()?;
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
            "a degree takes {} s; without `step` error control chooses the steps",
            short(1f64.to_radians() / speed, 2)
        ),
        ..Finding::default()
    })
}

/// The findings of samples too far apart to show a turn, and of a run that ends before the machine has
/// turned.
pub(super) fn sampling(start: &Start<'_>, kind: &AnalysisKind, analysis: &Origin) -> Vec<Finding> {
    let finding = |message: String, label: &str, help: &str| Finding {
        code: codes::SAMPLING,
        name: lint::SAMPLING.to_owned(),
        origin: analysis.clone(),
        message,
        label: label.to_owned(),
        help: help.to_owned(),
        ..Finding::default()
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
    // a run of a few milliseconds may be intended; one of a few degrees is probably a mistake for `4 rev`
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
        let help = "0.5 to 2 deg show forces and films. No step is longer than the sampling interval, so closer samples also keep steps from passing over short loads";
        found.push(finding(message, "its samples", help));
    }
    found
}

impl Start<'_> {
    /// Speed of the cycle at the start (rad/s), if its angle is one between two markers.
    pub(super) fn cycle_speed(&self) -> Option<f64> {
        let (_, rate) = self.cycle_rate()?;
        (rate != 0.0).then(|| rate.abs())
    }

    /// The markers of the cycle's angle (the turning one first), and its rate at the start (rad/s).
    pub(super) fn cycle_rate(&self) -> Option<([usize; 2], f64)> {
        let system = &self.model.compiled.system;
        let element = system.cycle.as_ref()?.element as usize;
        let rotation = system.elements.get(element)?.rotations.first()?;
        let markers = &self.model.elements.get(element)?.markers;
        let turning = *markers.get(rotation.turning as usize)?;
        let reference = *markers.get(rotation.reference as usize)?;
        let rate = self.spin(&self.marker(turning), &self.marker(reference));
        Some(([turning, reference], rate))
    }

    /// The finding of a gas trace that is read backwards, because the cycle's angle decreases.
    pub(super) fn backwards(&self) -> Option<Finding> {
        let system = &self.model.compiled.system;
        let ([turning, reference], _) = self.cycle_rate()?;
        let mut finding = Finding {
            code: codes::CYCLE,
            name: lint::CYCLE.to_owned(),
            origin: system.cycle.as_ref()?.origin.clone(),
            message: "the cycle runs backwards, so the gas pressure is read in reverse order"
                .to_owned(),
            label: "this angle decreases".to_owned(),
            help: "measure the angle the way the crank turns, `rotation(crank.flange, ground)`, with the z axis of the \
                   second marker; or change the sign of the speed at start and drive"
                .to_owned(),
 ..Finding::default()
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
}
