//! Orbits and polar diagrams.

use super::labels::capital;
use super::{Drawer, degrees};
use crate::cycle::last_cycle;
use crate::post::PostError;
use crate::post::track::{Track, distinct_names};
use eng_report::figure::{
    Figure, FixedTo, Orbit, Orbits, Polar, PolarCurve, Upright, journal_letter,
};
use eng_report::readable_unit;
use eng_system::expression::{Expression, Part};
use eng_system::figure as plan;

impl Drawer<'_> {
    pub(super) fn orbit(&self, orbit: &plan::Orbit) -> Result<Figure, PostError> {
        let plan::Orbit { journals, cycles } = orbit;
        let names = distinct_names(journals.iter().map(|(a, p)| (a.as_str(), p.as_str())));
        let mut orbits = Vec::new();
        for ((analysis, path), name) in journals.iter().zip(names) {
            let run = self.evaluator.run(analysis)?;
            let geometry = run
                .machine
                .journals
                .iter()
                .find(|journal| journal.path == *path)
                .ok_or_else(|| PostError::NoJournal {
                    analysis: analysis.clone(),
                    path: path.clone(),
                })?;
            let [x, y] = geometry.eccentricity.each_ref();
            let frame = run
                .results
                .column(x)
                .map_or("", |column| column.frame.as_str());
            let [x, y] = [x, y].map(|path| Expression::Channel {
                analysis: analysis.clone(),
                path: path.clone(),
            });
            let (x, y) = self.plane(&x, &y, *cycles)?;
            let place = run.machine.journals.iter().position(|j| j.path == *path);
            orbits.push(Orbit {
                name: match place.filter(|_| run.machine.journals.len() > 1) {
                    Some(place) => format!("{} {name}", journal_letter(place)),
                    None => name,
                },
                frame: frame.to_owned(),
                clearance: geometry.clearance,
                angle: degrees(&x),
                last_cycle: begin_of_last_cycle(&x),
                x: x.values,
                y: y.values,
            });
        }
        let analyses: Vec<&str> = journals.iter().map(|(a, _)| a.as_str()).collect();
        let (period, upright) = self.view(&analyses)?;
        Ok(Orbits {
            title: self.title.to_owned(),
            subtitle: format!("{}{}, not filtered", self.about(&analyses)?, part(*cycles)),
            period,
            upright,
            orbits,
        }
        .into())
    }

    pub(super) fn polar(&self, polar: &plan::Polar) -> Result<Figure, PostError> {
        let plan::Polar { vectors, cycles } = polar;
        let names = distinct_names(
            vectors
                .iter()
                .map(|v| (v.analysis.as_str(), v.path.as_str())),
        );
        let display = self.display();
        let mut fixed_to = FixedTo::Housing;
        let mut curves = Vec::new();
        for (vector, name) in vectors.iter().zip(names) {
            let (x, y) = self.plane(&vector.x, &vector.y, *cycles)?;
            let mut curve = PolarCurve {
                name: match self.letter(&vector.x).filter(|_| vectors.len() > 1) {
                    Some(letter) => format!("{letter} {name}"),
                    None => name,
                },
                frame: self.frame([&vector.x]),
                angle: degrees(&x),
                last_cycle: begin_of_last_cycle(&x),
                // a vector has no shifted zero
                x: x.values.iter().map(|v| v / display.scale).collect(),
                y: y.values.iter().map(|v| v / display.scale).collect(),
            };
            if let Some(turned_by) = &vector.turned_by {
                let turn = self.part(turned_by, *cycles)?;
                if let Some(detail) = x.samples.differ(&turn.samples) {
                    return Err(PostError::Samples {
                        first: x.samples.analysis.clone(),
                        second: turn.samples.analysis.clone(),
                        detail,
                    }
                    .of(&vector.x, turned_by));
                }
                let turn: Vec<f64> = turn.values.iter().map(|v| v.to_degrees()).collect();
                let frame = match self.frame([turned_by]) {
                    turning if turning.is_empty() => format!("{}, turned about z", curve.frame),
                    turning => turning,
                };
                curve = curve.turned(&turn, frame);
                fixed_to = FixedTo::Journal;
            }
            curves.push(curve);
        }
        let analyses: Vec<&str> = vectors.iter().map(|v| v.analysis.as_str()).collect();
        let (period, upright) = self.view(&analyses)?;
        let convention = if vectors.iter().any(|vector| vector.load) {
            "load of the pins on their shells: the tip points at the side that carries it"
        } else {
            "as recorded: forces of joints and journals are those on the first marker"
        };
        Ok(Polar {
            title: self.title.to_owned(),
            subtitle: format!(
                "{}{}, not filtered; {convention}",
                self.about(&analyses)?,
                part(*cycles)
            ),
            quantity: capital(&self.figure.quantity),
            unit: readable_unit(&display.symbol),
            fixed_to,
            period,
            upright,
            limit: None,
            curves,
        }
        .into())
    }

    /// A signal, or its last cycles.
    fn part(&self, expression: &Expression, cycles: Option<u32>) -> Result<Track, PostError> {
        let track = self.evaluator.track(expression)?;
        match cycles {
            Some(count) => self.evaluator.last(Part::Cycles(count), track),
            None => Ok(track),
        }
    }

    pub(super) fn plane(
        &self,
        x: &Expression,
        y: &Expression,
        cycles: Option<u32>,
    ) -> Result<(Track, Track), PostError> {
        Ok((self.part(x, cycles)?, self.part(y, cycles)?))
    }

    /// The period (°) and the upward axis of the first run; 360° without a cycle.
    fn view(&self, analyses: &[&str]) -> Result<(f64, Upright), PostError> {
        let first = analyses.first().copied().unwrap_or_default();
        let machine = self.evaluator.run(first)?.machine;
        let period = machine.cycle_period.map_or(360.0, f64::to_degrees);
        Ok((period, machine.upright))
    }
}

/// Index of the first sample of the last whole cycle; 0 without one.
fn begin_of_last_cycle(track: &Track) -> usize {
    let samples = &track.samples;
    last_cycle(samples.angle.as_deref(), samples.period).unwrap_or(0)
}

/// The part of the results that is drawn, after the name of the analysis.
pub(super) fn part(cycles: Option<u32>) -> String {
    match cycles {
        None => String::new(),
        Some(1) => ", last cycle".to_owned(),
        Some(count) => format!(", last {count} cycles"),
    }
}
