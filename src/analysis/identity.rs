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
