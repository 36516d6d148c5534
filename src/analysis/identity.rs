//! The identity of a run: hashes of everything that decides its numbers.

use super::Analysis;
use crate::model::hexadecimal;
use crate::places::without_places;
use std::fmt::Write;

impl Analysis {
    /// The identity of this run for a recording; empty without a folder.
    pub(super) fn identity(&self) -> String {
        match self.recording.folder {
            None => String::new(),
            Some(_) => self.fingerprint(),
        }
    }

    /// SHA-256 of everything that decides its numbers, as hexadecimal digits: program's version, texts, plan, bound
    /// model, reduced bodies, kept channels.
    pub(crate) fn fingerprint(&self) -> String {
        use sha2::Digest;
        let mut text = format!(
            "{} {} {:?} {:?} {}",
            env!("CARGO_PKG_VERSION"),
            self.program.source_hash(),
            self.plan,
            self.recording.channels,
            self.model.system_hash(),
        );
        self.add_values(&mut text);
        hexadecimal(&sha2::Sha256::digest(text.as_bytes()))
    }

    /// [`Analysis::fingerprint`] with the graphs of the model in place of the texts and of the places in them. Two texts give the
    /// same if they differ only in comments, in reports, or in definitions that the analysis does not use. It compares the texts
    /// of one process, so it names no version.
    pub(crate) fn fingerprint_without_texts(&self) -> String {
        use sha2::Digest;
        let mut text = format!(
            "{} {:?} {}",
            without_places(&format!("{:?}", self.plan)),
            self.recording.channels,
            self.model.numbers_hash(),
        );
        self.add_values(&mut text);
        hexadecimal(&sha2::Sha256::digest(text.as_bytes()))
    }

    /// Adds the words of choices, the values of parameters and slots, and the keys of the reduced bodies.
    fn add_values(&self, text: &mut String) {
        for (path, word, _) in &self.chosen {
            // writing to a text cannot fail
            let _ = write!(text, " {path} {word}");
        }
        let values = match self.bound() {
            Ok(bound) => [bound.parameters, bound.slots].concat(),
            // parameters that the model refuses
            Err(_) => self.overrides.iter().flatten().copied().collect(),
        };
        for value in values {
            let _ = write!(text, " {:x}", value.to_bits());
        }
        for reduction in self.model.reductions() {
            let _ = write!(text, " {}", reduction.key());
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Sources, check};

    const MODEL: &str = "
use std.joints.Revolute
force Fan(a: Marker, b: Marker, factor: Torque/AngularVelocity) {
    apply torque -factor*dot(a.angular_velocity - b.angular_velocity, b.z)*b.z on a against b
}
model Rig {
    param air: Torque/AngularVelocity = 2 N*m*s/rad
    gravity = [0, 0, 0] m/s^2
    marker housing = [0, 0, 0] mm
    body rotor { mass = 5 kg; inertia = [20, 20, 40] g*m^2; marker axis = origin }
    joint bearing = Revolute(rotor.axis, housing)
    force fan = Fan(rotor.axis, housing, factor: air)
    start bearing.speed = 3000 rpm
}
analysis coast = transient(Rig(), duration: 20 ms, sample: 1 ms)
analysis brief = transient(Rig(air: 3 N*m*s/rad), duration: 10 ms, sample: 1 ms)
report ends { value slowest = minimum(coast.bearing.speed) as rpm }
";

    /// For both analyses of a text the fingerprint, and that without the texts.
    fn fingerprints(text: &str) -> [(String, String); 2] {
        let checked = check(&Sources::from_text("m.eng", text), "m.eng");
        let program = checked.into_program().expect("a right text");
        ["coast", "brief"].map(|name| {
            let analysis = program.analysis(name).expect("an analysis");
            let own = analysis.fingerprint();
            (own, analysis.fingerprint_without_texts())
        })
    }

    #[test]
    fn a_change_touches_the_analyses_whose_numbers_it_may_change() {
        let before = fingerprints(MODEL);
        assert_eq!(fingerprints(MODEL), before, "the same text");
        for (old, new, texts, due) in [
            // a comment moves all places
            ("\nuse std", "\n// a comment\nuse std", true, [false, false]),
            ("value slowest", "value last", false, [false, false]),
            ("param air", "param  air", true, [false, false]),
            ("20 ms", "30 ms", true, [true, false]),
            ("air: 3 N", "air: 4 N", true, [false, true]),
            ("5 kg", "6 kg", true, [true, true]),
            ("-factor*dot", "-2*factor*dot", true, [true, true]),
            ("3000 rpm", "2000 rpm", true, [true, true]),
        ] {
            let text = MODEL.replace(old, new);
            assert_ne!(text, MODEL);
            let now = fingerprints(&text);
            for ((before, now), due) in before.iter().zip(&now).zip(due) {
                assert_eq!(before.0 != now.0, texts, "{new}");
                assert_eq!(before.1 != now.1, due, "{new}");
            }
        }
    }
}
