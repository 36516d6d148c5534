//! The assembled models of a program: findings that need an assembly, and the positions of markers.

use crate::analysis::{Analysis, Findings};
use crate::counted::counted;
use crate::lint::{Covered, Finding, accepted, diagnostics, needed, needless, sift};
use crate::program::{Bodies, Program};
use crate::timings::{CheckTimings, Clock};
use crate::{Error, RuntimeError, TopologyReport, codes, render};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap};
use eng_runtime::start::turn::Turned;
use eng_system::lint::Accepted;
use eng_system::system::System;
use serde::Serialize;
use std::sync::Arc;
use std::time::Duration;

/// The findings of an assembly of all models.
#[derive(Clone, Debug, Default)]
pub struct Assembled {
    /// Messages about open loops and repeated equations, with places in the texts of the program.
    pub diagnostics: Diagnostics,
    /// A line for each model (`Inline4: 11 bodies …, 5 journals …`), and a line with the freedoms of each
    /// analysis.
    pub facts: Vec<String>,
    /// Processor time of all phases of the check.
    pub timings: CheckTimings,
}

/// Positions of the markers of an assembled model.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Positions {
    /// The analyses with this start.
    pub analyses: Vec<String>,
    /// All markers that the text states, and the origins of the bodies.
    pub markers: Vec<PlacedMarker>,
}

/// The position of a marker.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PlacedMarker {
    /// Path of its body; `ground`.
    pub body: String,
    /// Its path: `crank.pin[2]`.
    pub marker: String,
    /// Its position in the ground's axes (m).
    pub position: [f64; 3],
}

/// Messages and positions as JSON text: the document of [`render::json`] with one more field `"positions"`,
///
/// ```text
///   "positions": [
///     { "analyses": ["fired"],
///       "markers": [ { "body": "crank", "marker": "crank.pin[1]", "position": [x, y, z] } ] } ]
/// ```
///
/// in metres along the ground's axes.
pub fn json_with_positions(
    diagnostics: &Diagnostics,
    sources: &SourceMap,
    positions: &[Positions],
) -> String {
    #[derive(Serialize)]
    struct WithPositions<'a> {
        #[serde(flatten)]
        messages: render::Document<'a>,
        positions: &'a [Positions],
    }
    render::text(&WithPositions {
        messages: render::document(diagnostics, sources),
        positions,
    })
}

impl Program {
    /// Assembles all models at the start of their analyses, with rigid bodies in place of flexible ones.
    /// Counts their freedoms.
    ///
    /// # Errors
    /// Failures that no change of the text can repair: no memory for code.
    pub fn assemble(&self) -> Result<Assembled, Error> {
        let mut clock = Clock::new();
        let mut found = Assembled {
            timings: self.timings(),
            ..Assembled::default()
        };
        for name in self.models() {
            match self.outlined(name) {
                Ok(model) => found.facts.push(model.summary()),
                // a readable mesh may still be no structure
                Err(Error::Report(report)) => {
                    found.diagnostics.extend(report.diagnostics().clone());
                }
                Err(other) => return Err(other),
            }
        }
        found.timings.machine_code += clock.since();
        if found.diagnostics.has_errors() {
            return Ok(found);
        }
        let mut geometries = Vec::new();
        let mut lints = Lints::default();
        let names = self.analyses();
        let analyses = self.analyses_with(&names, Bodies::Rigid);
        found.timings.machine_code += clock.since();
        for (name, analysis) in names.iter().zip(analyses) {
            let analysis = match analysis {
                Ok(analysis) => analysis,
                Err(Error::Report(report)) => {
                    found.diagnostics.extend(report.diagnostics().clone());
                    continue;
                }
                Err(other) => return Err(other),
            };
            // the lints begin with the assembly; they leave out an analysis without one
            let _ = analysis.assembled();
            found.timings.assembly += clock.since();
            let (turned, turning) = lints.collect(&analysis);
            found.timings.dry_turns += turning;
            found.timings.turns += usize::from(turned.is_some());
            found.timings.lints += clock.since().saturating_sub(turning);
            let topology = topology(self, name, &analysis);
            found.timings.assembly += clock.since();
            match topology {
                Ok((report, bends)) => {
                    found.add(bends.iter().filter_map(|bends| bends.doubt.as_ref()));
                    let bends = bends.is_some();
                    // analyses with the same system share one turn without forces; a machine that needs bending has no
                    // turn by geometry
                    let model = Arc::as_ptr(&analysis.model().compiled().system);
                    let geometry = (model, analysis.geometry()?);
                    if !bends && !geometries.contains(&geometry) {
                        geometries.push(geometry);
                        let hanging = analysis.hanging()?;
                        found.add(hanging.iter());
                        // a falling machine tumbles, so a lock in its turn is no sign of wrong lengths
                        found.timings.lints += clock.since();
                        if hanging.is_none() {
                            found.timings.turns += usize::from(turned.is_none());
                            let lock = match turned {
                                Some(turned) => analysis.lock(turned)?,
                                None => analysis.dry_turn()?,
                            };
                            found.add(lock.iter());
                        }
                        found.timings.dry_turns += clock.since();
                    }
                    found.facts.push(assembles(&analysis, &report, bends));
                }
                Err(Error::Run { report, .. } | Error::Report(report)) => {
                    found.add(report.diagnostics().iter());
                }
                Err(other) => return Err(other),
            }
        }
        lints.add_to(&mut found);
        found.timings.lints += clock.since();
        Ok(found)
    }

    /// Positions of the markers at the start of the analyses. Analyses with the same start share an entry.
    ///
    /// # Errors
    /// A model that does not assemble.
    pub fn positions(&self) -> Result<Vec<Positions>, Error> {
        let names = self.analyses();
        let mut found: Vec<Positions> = Vec::new();
        for (name, analysis) in names.iter().zip(self.analyses_with(&names, Bodies::Rigid)) {
            let placed = analysis?.positions()?.into_iter();
            let markers: Vec<PlacedMarker> = placed
                .map(|(body, marker, position)| PlacedMarker {
                    body,
                    marker,
                    position,
                })
                .collect();
            match found.iter_mut().find(|known| known.markers == markers) {
                Some(known) => known.analyses.push((*name).to_owned()),
                None => found.push(Positions {
                    analyses: vec![(*name).to_owned()],
                    markers,
                }),
            }
        }
        Ok(found)
    }
}

impl Assembled {
    /// Adds messages, each mistake once, because all analyses of one model have it.
    fn add<'d>(&mut self, messages: impl Iterator<Item = &'d eng_grammar::Diagnostic>) {
        for message in messages {
            if !self.diagnostics.iter().any(|known| known == message) {
                self.diagnostics.push(message.clone());
            }
        }
    }
}

/// The line about an assembled analysis.
fn assembles(analysis: &Analysis, report: &TopologyReport, bends: bool) -> String {
    let name = analysis.name();
    let equations = counted(
        report.equations,
        "constraint equation",
        "constraint equations",
    );
    match bends {
        false => format!(
            "{name}: assembles; {}, {equations}, {}{}",
            counted(report.velocities, "velocity", "velocities"),
            counted(report.freedom, "freedom", "freedoms"),
            analysis.model().besides(),
        ),
        true => {
            format!("{name}: assembles if its flexible bodies bend as the joints ask; {equations}")
        }
    }
}

/// A machine that assembles only if its flexible bodies bend.
struct Bends {
    /// The warning if they also have to vibrate from the start.
    doubt: Option<Diagnostic>,
}

/// Assembles an analysis with rigid bodies in place of flexible ones. If this fails, it assembles it with
/// movable markers on these bodies, because joints may hold more directions of a flexible body than of a
/// rigid one.
fn topology(
    program: &Program,
    name: &str,
    analysis: &Analysis,
) -> Result<(TopologyReport, Option<Bends>), Error> {
    match analysis.topology() {
        Ok(report) => Ok((report, None)),
        Err(Error::Run { cause, report }) if analysis.model().is_outlined() => {
            let mut loose = program.analyses_with(&[name], Bodies::Loose);
            let Some(loose) = loose.pop() else {
                return Ok((analysis.topology()?, None));
            };
            let stated = report.diagnostics().iter().next();
            let doubt = match (cause.as_ref(), stated) {
                (RuntimeError::StartVelocity { .. }, Some(stated)) => Some(vibrates(stated)),
                _ => None,
            };
            Ok((loose?.topology()?, Some(Bends { doubt })))
        }
        Err(other) => Err(other),
    }
}

/// The warning for start velocities that contradict each other for rigid bodies.
fn vibrates(stated: &Diagnostic) -> Diagnostic {
    let title = format!(
        "{}, unless flexible bodies vibrate from the start",
        stated.title
    );
    let mut message = Diagnostic::warning(codes::BENDING_START, title);
    message.labels.clone_from(&stated.labels);
    message.with_help("state the speed of a shaft once, and give a drive the same speed")
}

/// The lints of all analyses of a program.
#[derive(Default)]
struct Lints {
    /// The lints that no text accepts.
    reported: Vec<Finding>,
    /// For each model with its constants: the system, and the used acceptances with their findings.
    models: Vec<(Arc<System>, Vec<Covered>)>,
    /// The acceptances of models of which some lints could not run, because the machine does not assemble or does not
    /// turn.
    undecided: Vec<Accepted>,
}

impl Lints {
    /// Collects the findings of an analysis. Returns its turn without forces if a lint made one, and the time of this
    /// turn. Another stage reports unusable parameters.
    fn collect(&mut self, analysis: &Analysis) -> (Option<Result<Turned, RuntimeError>>, Duration) {
        let found = analysis.findings();
        let system = &analysis.model().compiled().system;
        let complete = analysis.assembled().is_ok()
            && matches!(&found, Ok(found) if !matches!(found.turned, Some(Err(_))));
        if !complete {
            self.undecided.extend(system.accepted.iter().cloned());
        }
        let Ok(Findings {
            list: mut findings,
            turned,
            turning,
        }) = found
        else {
            return (None, Duration::ZERO);
        };
        findings.extend(analysis.findings_of_start());
        let sifted = sift(findings, system);
        // analyses before this one may have found the same with other numbers; within this one an indexed
        // condition fails for several indices
        let earlier = self.reported.len();
        for finding in sifted.reported {
            let known =
                |other: &Finding| other.like(&finding) && other.origin.path == finding.origin.path;
            if !self.reported[..earlier].iter().any(known) {
                self.reported.push(finding);
            }
        }
        match self.models.iter_mut().find(|(known, _)| known == system) {
            Some((_, covered)) => {
                for found in sifted.accepted {
                    if !covered.contains(&found) {
                        covered.push(found);
                    }
                }
            }
            None => self.models.push((Arc::clone(system), sifted.accepted)),
        }
        (turned, turning)
    }

    /// Adds each finding once, and the list of acceptances.
    fn add_to(&self, assembled: &mut Assembled) {
        for diagnostic in diagnostics(&self.reported) {
            assembled.diagnostics.push(diagnostic);
        }
        let mut places: Vec<(&Accepted, bool)> = Vec::new();
        for (system, covered) in &self.models {
            for line in accepted(system, covered) {
                let line = format!("accepted: {line}");
                if !assembled.facts.contains(&line) {
                    assembled.facts.push(line);
                }
            }
            // an acceptance is needed if one instance or one model needs it
            for (accepted, needed) in needed(system, covered) {
                let needed = needed || self.undecided.contains(accepted);
                match places.iter_mut().find(|(known, _)| known.at == accepted.at) {
                    Some((_, known)) => *known |= needed,
                    None => places.push((accepted, needed)),
                }
            }
        }
        for (accepted, _) in places.iter().filter(|(_, needed)| !needed) {
            assembled.diagnostics.push(needless(accepted));
        }
    }
}
