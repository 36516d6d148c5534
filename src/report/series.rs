//! Motion and stresses of flexible bodies, and films, as files for ParaView: a `.vtu` for each body or film and
//! time, and a `.pvd` that names them all.

use super::scene::{place, poses, shapes};
use super::stress::{self, Peak};
use super::{Entry, ReportError, describe::Matter, films};
use crate::motion::{BodyMotion, moments};
use crate::results::{Results, file_stem, replace_file};
use eng_flexible::fe::stress::von_mises;
use eng_flexible::recover::Recovery;
use eng_report::animation::{
    CellKind, FlexibleBody, ModeShape, NodeField, Surface, VtkBody, VtkEncoding, VtkFrame, VtkPart,
    pvd, vtu,
};
use eng_system::Dimension;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Most times of a series. A choice: 20° of a four-stroke cycle each.
const TIMES: usize = 36;

/// Largest von Mises stress over the motion and its time, if every node of the surface has a stress.
fn envelope_of(peaks: &[Peak], nodes: usize) -> Vec<NodeField> {
    if peaks.len() != nodes {
        return Vec::new();
    }
    let field = |name: &str, unit: &str, of: fn(&Peak) -> f64| NodeField {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values: peaks.iter().map(of).collect(),
    };
    vec![
        field("von_mises_envelope", "Pa", |p| p.stress),
        field("time_of_envelope", "s", |p| p.time),
    ]
}

/// Writes the series of an analysis: the whole surface of each flexible body, and each film, at up to 37 times of
/// its last cycle. Returns the path of the `.pvd` file, or `None` without a flexible body and a film.
///
/// # Errors
/// An analysis without motion, bodies that do not fit it, errors of the operating system.
pub fn write_series(entry: &Entry, folder: &Path) -> Result<Option<PathBuf>, ReportError> {
    let Some(motion) = &entry.outcome.motion else {
        return Err(ReportError::NoMotion(entry.name().to_owned()));
    };
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        replace_file(&path, |file: &mut std::fs::File| {
            file.write_all(text.as_bytes())
        })
        .map_err(|source| ReportError::File {
            path: path.clone(),
            source,
        })?;
        Ok::<PathBuf, ReportError>(path)
    };
    let (times, _) = moments(motion);
    let every = times.len().saturating_sub(1).div_ceil(TIMES).max(1);
    let stem = file_stem(entry.name());
    let mut parts = Vec::new();
    for (part, picture) in entry.described.bodies.iter().enumerate() {
        let Matter::Flexible(reduction) = &picture.matter else {
            continue;
        };
        let stored = &reduction.stored;
        let own = BodyMotion::of(motion, &picture.path)?;
        let nodes = stored.surface.nodes();
        let recovery = Recovery::of_stored(stored)?;
        let modal = recovery.stress_at_nodes(&nodes)?;
        let envelope = stress::peaks(stored, &nodes, &times, &own.amplitudes)?;
        let fields = envelope_of(&envelope, nodes.len());
        let triangles = stored
            .surface
            .triangles()
            .iter()
            .map(|t| t.map(|node| nodes.binary_search(&node).map_or(0, |at| at as u32)))
            .collect();
        let body = FlexibleBody {
            name: picture.path.clone(),
            surface: Surface {
                nodes: nodes.iter().map(|node| place(stored, *node)).collect(),
                triangles,
            },
            shapes: shapes(stored, &nodes)
                .into_iter()
                .map(|displacements| ModeShape {
                    name: String::new(),
                    displacements,
                })
                .collect(),
            poses: poses(&own),
            amplitudes: own.amplitudes,
            fields: Vec::new(),
        };
        let mesh = body.vtk();
        let mut found = Vec::new();
        for (index, time) in times.iter().enumerate().step_by(every) {
            let amplitudes = body.amplitudes.get(index).map_or(&[][..], Vec::as_slice);
            modal.stress(amplitudes, &mut found)?;
            // nodes that belong to no solid would show a stress of zero
            let stress = if modal.nodes().len() == nodes.len() {
                &found[..]
            } else {
                &[]
            };
            let equivalent: Vec<f64> = stress.iter().map(von_mises).collect();
            let displacements = body.displacements(index);
            let Some(pose) = body.poses.get(index) else {
                continue;
            };
            let frame = VtkFrame {
                time: *time,
                pose: *pose,
                displacements: &displacements,
                stress,
                von_mises: &equivalent,
                fields: &fields,
            };
            let name = format!(
                "{stem}-{}-{:03}.vtu",
                file_stem(&picture.path),
                index / every
            );
            write(&name, &vtu(&mesh, &frame, VtkEncoding::Base64)?)?;
            parts.push(VtkPart {
                time: *time,
                part,
                file: name,
            });
        }
    }
    let samples: Vec<usize> = (0..times.len()).step_by(every).collect();
    for film in film_files(entry, motion, &times, &samples)? {
        let name = format!("{stem}-{}", film.name);
        write(&name, &film.text)?;
        parts.push(VtkPart {
            time: film.time,
            part: film.part,
            file: name,
        });
    }
    if parts.is_empty() {
        return Ok(None);
    }
    write(&format!("{stem}.pvd"), &pvd(&parts)).map(Some)
}

/// The file of a film at a time.
struct FilmFile {
    /// Its name after that of the analysis.
    name: String,
    time: f64,
    part: usize,
    text: String,
}

/// The films of an analysis at some samples of its motion, with pressure (Pa) and gap (m) at their nodes.
fn film_files(
    entry: &Entry,
    motion: &Results,
    times: &[f64],
    samples: &[usize],
) -> Result<Vec<FilmFile>, ReportError> {
    let (shells, _) = films::shells(entry, motion)?;
    let mut files = Vec::new();
    for (film, part) in shells.iter().zip(entry.described.bodies.len()..) {
        let mesh = VtkBody {
            name: film.field.path.clone(),
            nodes: film.surface.nodes.clone(),
            cells: (film.surface.triangles.iter())
                .map(|nodes| (CellKind::Triangle3, nodes.to_vec()))
                .collect(),
        };
        let mut quantities = Vec::new();
        for (dimension, unit, least) in [
            (films::pressure(), "Pa", 0.0),
            (Dimension::LENGTH, "m", f64::NEG_INFINITY),
        ] {
            let found = film.quantity(dimension, least, motion, samples)?;
            quantities.extend(found.map(|(quantity, values)| (quantity.name, unit, values)));
        }
        for (index, sample) in samples.iter().enumerate() {
            let fields: Vec<NodeField> = (quantities.iter_mut())
                .map(|(name, unit, values)| NodeField {
                    name: (*name).to_owned(),
                    unit: (*unit).to_owned(),
                    values: values
                        .get_mut(index)
                        .map(std::mem::take)
                        .unwrap_or_default(),
                })
                .collect();
            let pose = film.poses.get(*sample).or(film.poses.first());
            let (Some(time), Some(pose)) = (times.get(*sample), pose) else {
                continue;
            };
            let frame = VtkFrame {
                time: *time,
                pose: *pose,
                displacements: &[],
                stress: &[],
                von_mises: &[],
                fields: &fields,
            };
            files.push(FilmFile {
                name: format!("{}-film-{index:03}.vtu", file_stem(&mesh.name)),
                time: *time,
                part,
                text: vtu(&mesh, &frame, VtkEncoding::Base64)?,
            });
        }
    }
    Ok(files)
}
