//! The modes of the terms of a request.

use super::interface::{MarkerFreedom, MarkerFreedoms, at_marker};
use super::report::{Report, Served, UNSERVED, Unserved};
use super::surfaces::{Answered, Places, Prepared};
use super::{Interface, Term};
use crate::error::FlexibleError;
use crate::fe::Reduction;
use crate::mesh::Mesh;
use crate::modes::interface::Interface as Hold;
use crate::modes::normal::normal_modes;
use crate::modes::statics::{attachment_modes_by, constraint_modes};
use crate::modes::{Boundary, Candidate, Load, ModeSet, Structure, given};
use crate::solve::Shifted;
use std::borrow::Cow;

/// The structure and data for the computation of modes.
pub(super) struct Candidates<'a> {
    pub structure: &'a Structure<'a>,
    pub markers: &'a MarkerFreedoms<'a>,
    pub reduction: &'a Reduction,
    pub mesh: &'a Mesh,
    pub report: &'a mut Report,
}

/// Modes in the order of the terms, and the requested loads.
pub(super) struct Found {
    pub candidates: Vec<Candidate>,
    pub asked: RequestedLoads,
    pub surfaces: Vec<Answered>,
}

/// Requested loads, each with twice its static strain energy (J).
pub(super) struct RequestedLoads {
    loads: Vec<(MarkerFreedom, Load, f64)>,
}

impl RequestedLoads {
    /// The loads whose static answer the set does not span. With orthonormal modes the set has Σ (φᵀf)² / ω²
    /// of the energy fᵀu.
    pub fn unserved(&self, structure: &Structure, set: &ModeSet) -> Vec<Unserved> {
        let size = structure.size().max(1);
        self.loads
            .iter()
            .filter_map(|(freedom, load, energy)| {
                let spanned: f64 = set
                    .vectors
                    .chunks_exact(size)
                    .zip(&set.eigenvalues)
                    .map(|(mode, lambda)| {
                        load.displacement(mode) * load.displacement(mode) / lambda
                    })
                    .sum();
                let missing = 1.0 - spanned / energy;
                (missing > UNSERVED).then(|| Unserved {
                    label: freedom.label.clone(),
                    marker: freedom.marker,
                    component: freedom.component,
                    missing,
                })
            })
            .collect()
    }
}

impl Candidates<'_> {
    /// Computes the modes. All static answers come first and share one factor. Its memory is free before the
    /// normal modes need a factor of their own.
    pub fn find(
        &mut self,
        terms: &[Term],
        asked: &[Interface],
        surfaces: Vec<Prepared>,
    ) -> Result<Found, FlexibleError> {
        let size = self.structure.size().max(1);
        let mut loads = Vec::new();
        let mut jobs = Vec::new();
        for term in terms {
            let (kind, at) = match term {
                Term::Static(at) => ("static ", at),
                Term::Constraint(at) => ("constraint ", at),
                Term::Normal { .. } | Term::Given(_) => {
                    jobs.push(None);
                    continue;
                }
            };
            let (freedoms, rows) = self.markers.loads(kind, at, self.reduction)?;
            let by_loads = kind == "static " || {
                let hold = Hold::new(self.structure, &rows)?;
                hold.plain().is_none()
            };
            let first = loads.len();
            if by_loads {
                loads.extend(rows.iter().cloned());
            }
            jobs.push(Some((freedoms, rows, by_loads.then_some(first))));
        }
        let (asked, asked_loads) = self.markers.loads("", asked, self.reduction)?;
        let first_asked = loads.len();
        loads.extend(asked_loads);
        // one factor serves static and normal modes
        let mut factor = None;
        let shares = terms
            .iter()
            .any(|term| matches!(term, Term::Normal { fixed, .. } if fixed.is_empty()));
        if !surfaces.is_empty() || (shares && !loads.is_empty()) {
            let (stiffness, mass) = (self.structure.stiffness, self.structure.mass);
            // a failure is no error here: the computation that needs this factor reports it
            factor = Shifted::new(stiffness, mass, &self.structure.analysis()?).ok();
        }
        let answers = match loads.is_empty() {
            true => Vec::new(),
            false => attachment_modes_by(&mut factor, self.structure, &loads)?,
        };
        let surfaces = self.surfaces(surfaces, &mut factor)?;
        if !shares {
            factor = None;
        }
        let answer = |index: usize| answers.get(index * size..(index + 1) * size).unwrap_or(&[]);
        let asked = asked
            .into_iter()
            .zip(loads.iter().enumerate().skip(first_asked))
            .map(|(freedom, (index, load))| {
                let energy = load.displacement(answer(index));
                (freedom, load.clone(), energy)
            })
            .filter(|(_, _, energy)| *energy > 0.0)
            .collect();
        let mut candidates = Vec::new();
        for (term, job) in terms.iter().zip(jobs) {
            let Some((freedoms, rows, first)) = job else {
                candidates.extend(self.dynamic(term, &mut factor)?);
                continue;
            };
            let answers_from = |first: usize| {
                let own = first * size..(first + rows.len()) * size;
                answers.get(own).unwrap_or(&[])
            };
            let vectors = match (term, first) {
                (Term::Static(_), Some(first)) => Cow::Borrowed(answers_from(first)),
                (_, Some(first)) => {
                    let hold = Hold::new(self.structure, &rows)
                        .map_err(|error| at_marker(error, &freedoms))?;
                    let modes = hold
                        .constraint_modes(answers_from(first))
                        .map_err(|error| at_marker(error, &freedoms))?;
                    Cow::Owned(modes)
                }
                (_, None) => {
                    let modes = constraint_modes(self.structure, &rows)
                        .map_err(|error| at_marker(error, &freedoms))?;
                    Cow::Owned(modes)
                }
            };
            for (place, (freedom, row)) in freedoms.iter().zip(&rows).enumerate() {
                self.report.served.push(Served {
                    mode: row.label.clone(),
                    marker: freedom.marker,
                    component: freedom.component,
                    flexibility: first.map(|first| row.displacement(answer(first + place))),
                    kept: false,
                });
            }
            let labels = rows.into_iter().map(|row| row.label);
            candidates.extend(named(labels, &vectors, size, 0.0));
        }
        Ok(Found {
            candidates,
            asked: RequestedLoads { loads: asked },
            surfaces,
        })
    }

    /// The static answers of elastic surfaces. Those of one surface need room at a time.
    fn surfaces(
        &self,
        prepared: Vec<Prepared>,
        factor: &mut Option<Shifted>,
    ) -> Result<Vec<Answered>, FlexibleError> {
        let answered = prepared.into_iter().map(|surface| {
            surface.answered(
                self.structure,
                &Places {
                    mesh: self.mesh,
                    markers: self.markers,
                    reduction: self.reduction,
                },
                factor,
            )
        });
        answered.collect()
    }

    /// Normal modes, computed or given.
    fn dynamic(
        &mut self,
        term: &Term,
        factor: &mut Option<Shifted>,
    ) -> Result<Vec<Candidate>, FlexibleError> {
        let size = self.structure.size().max(1);
        match term {
            Term::Static(_) | Term::Constraint(_) => Ok(Vec::new()),
            Term::Normal { modes, fixed } => {
                let (freedoms, rows) = self.markers.loads("", fixed, self.reduction)?;
                let (boundary, kind) = if fixed.is_empty() {
                    (Boundary::AsIs, "normal")
                } else {
                    (Boundary::Fixed(rows), "fixed normal")
                };
                let found = normal_modes(factor.take(), self.structure, *modes, &boundary)
                    .map_err(|error| at_marker(error, &freedoms))?;
                self.report.sturm.push(found.sturm);
                let labels = (1..=found.eigenvalues.len()).map(|i| format!("{kind} {i}"));
                Ok(named(labels, &found.vectors, size, 0.0))
            }
            Term::Given(modes) => {
                let freedoms = self.markers.freedoms;
                let fitted = given::fit(self.mesh, freedoms, self.reduction, modes)?;
                let file = &modes.modes.file;
                self.report
                    .warnings
                    .extend(modes.modes.warnings.iter().cloned());
                for (mode, misfit) in modes.modes.modes.iter().zip(&fitted.misfits) {
                    // a choice: a decade above the digits of the file
                    if *misfit > 10.0 * fitted.noise {
                        self.report.warnings.push(format!(
                            "{file}: ties and supports of the body remove the share {misfit:.1e} of mode {}",
                            mode.number
                        ));
                    }
                }
                let labels = modes.modes.modes.iter();
                let labels = labels.map(|mode| format!("given {}", mode.number));
                Ok(named(labels, &fitted.vectors, size, fitted.noise))
            }
        }
    }
}

/// Vectors one after the other with their labels.
fn named(
    labels: impl Iterator<Item = String>,
    vectors: &[f64],
    size: usize,
    noise: f64,
) -> Vec<Candidate> {
    labels
        .zip(vectors.chunks_exact(size))
        .map(|(label, vector)| Candidate {
            label,
            vector: vector.to_vec(),
            noise,
        })
        .collect()
}
