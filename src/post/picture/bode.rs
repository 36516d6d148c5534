//! Amplitude and phase of frequency responses.

use super::{Drawer, pairs, shown};
use crate::post::PostError;
use crate::post::track::distinct_names;
use eng_report::figure::{Bode, BodeCurve, Figure};
use eng_system::expression::Member;
use eng_system::figure as plan;

impl Drawer<'_> {
    pub(super) fn bode(&self, bode: &plan::Bode) -> Result<Figure, PostError> {
        let plan::Bode { members, phases } = bode;
        let all: Vec<&Member> = members.iter().collect();
        let mut curves = Vec::new();
        for ((member, phase), name) in members
            .iter()
            .zip(phases)
            .zip(distinct_names(pairs(members)))
        {
            let amplitude = self.evaluator.track(&member.expression)?;
            let phase = self.evaluator.track(phase)?;
            curves.push(BodeCurve {
                name,
                frequency: amplitude.samples.time.clone(),
                amplitude: shown(&amplitude.values, self.display()),
                phase: phase
                    .values
                    .iter()
                    .map(|angle| angle.to_degrees())
                    .collect(),
            });
        }
        let analyses: Vec<&str> = members.iter().map(|m| m.analysis.as_str()).collect();
        Ok(Bode {
            title: self.title.to_owned(),
            subtitle: self.about(&analyses)?,
            ordinate: self.ordinate(&all),
            curves,
        }
        .into())
    }
}
