//! The films of an analysis as surfaces for the animation and for ParaView.

use super::describe::MarkerAxes;
use super::scene::poses;
use super::{Entry, ReportError};
use crate::motion::BodyMotion;
use crate::recorded_field::RecordedField;
use crate::results::Results;
use eng_report::animation::{FilmSurface, Films, Pose, Surface};
use eng_report::readable_unit;
use eng_system::Dimension;
use eng_system::field::{CellQuantity, FieldGrid};
use eng_system::significant::significant;

/// Height of the hill of the highest pressure, as a share of the largest radius of a film. A choice for the
/// eye.
const HILL: f64 = 0.5;
/// Bytes in a page for each node and moment: three floats of single precision, deflated to about half, in base64.
const BYTES: usize = 9;
/// Fewest moments of a film, if the motion has as many. A choice for the eye: 15° of a turn.
const FEWEST: usize = 24;

/// A film's surface on its shell, before its pressures are known.
pub(super) struct Shell<'e> {
    pub field: &'e RecordedField,
    /// Path of the body that carries the shell; none on the ground.
    pub body: Option<&'e str>,
    /// In the axes of this body, or of the ground.
    pub surface: Surface,
    pub outward: Vec<[f64; 3]>,
    pub poses: Vec<Pose>,
    grid: FieldGrid,
}

/// The films of an analysis, the bodies that carry them, and a sentence for each fact that a reader needs.
#[derive(Default)]
pub struct Pictured {
    /// The films.
    pub films: Films,
    /// Paths of the bodies that carry them.
    pub shells: Vec<String>,
    /// The sentences.
    pub notes: Vec<String>,
}

/// A quantity, and its values at the nodes for each sample (SI).
type AtNodes = (&'static CellQuantity, Vec<Vec<f64>>);

/// The dimension of the quantity that is drawn.
pub(super) fn pressure() -> Dimension {
    Dimension::FORCE
        .over(Dimension::LENGTH)
        .over(Dimension::LENGTH)
}

/// The films that can be drawn, and a sentence for each of the others.
pub(super) fn shells<'e>(
    entry: &'e Entry,
    motion: &Results,
) -> Result<(Vec<Shell<'e>>, Vec<String>), ReportError> {
    let machine = &entry.described.machine;
    let (mut found, mut notes) = (Vec::new(), Vec::new());
    for field in &machine.fields {
        let path = &field.path;
        let journals = machine.journals.iter().zip(&entry.described.axes);
        let of_path = journals.clone().find(|(journal, _)| journal.path == *path);
        let Some((shell, place)) =
            of_path.and_then(|(_, axes)| Some((&axes.shell, axes.shell.place?)))
        else {
            notes.push(format!(
                "{path}: its film is not drawn, because the place of its shell is not known."
            ));
            continue;
        };
        if field.columns_of(motion).is_none() {
            notes.push(format!("{path}: its film is not drawn, because the results do not have it; run the model again."));
            continue;
        }
        let poses = match &shell.body {
            Some(body) => poses(&BodyMotion::of(motion, body)?),
            None => vec![Pose::HOME],
        };
        let grid = field.grid();
        let (surface, outward) = cylinder(&grid, shell, place);
        found.push(Shell {
            field,
            body: shell.body.as_deref(),
            surface,
            outward,
            poses,
            grid,
        });
    }
    Ok((found, notes))
}

/// Nodes in the middles of the cells around, and across in the middles and at both edges; all triangles between
/// them; and the direction away from the axis at each node.
pub fn cylinder(grid: &FieldGrid, shell: &MarkerAxes, place: [f64; 3]) -> (Surface, Vec<[f64; 3]>) {
    let [around, middles] = grid.middles();
    let edges = [grid.across.first(), grid.across.last()];
    let [low, high] = edges.map(|edge| edge.copied().unwrap_or_default());
    let across: Vec<f64> = [low].into_iter().chain(middles).chain([high]).collect();
    let turned = |local: [f64; 3]| {
        let row = |i: usize| {
            (0..3)
                .map(|j| shell.orientation[3 * i + j] * local[j])
                .sum::<f64>()
        };
        [row(0), row(1), row(2)]
    };
    let (mut surface, mut outward) = (Surface::default(), Vec::new());
    for angle in &around {
        let (cos, sin) = (libm::cos(*angle), libm::sin(*angle));
        for z in &across {
            let local = turned([grid.radius * cos, grid.radius * sin, *z]);
            surface.nodes.push([0, 1, 2].map(|i| place[i] + local[i]));
            outward.push(turned([cos, sin, 0.0]));
        }
    }
    let (columns, rows) = (around.len() as u32, across.len() as u32);
    for column in 0..columns {
        let next = (column + 1) % columns;
        for row in 1..rows {
            let [a, b] = [column, next].map(|column| column * rows + row - 1);
            surface.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
    (surface, outward)
}

/// Numbers at the nodes from those of the cells: at the edges on the straight line through the last two cells, not
/// below `least` if the last cell is not.
pub fn at_nodes(grid: &FieldGrid, cells: &[f64], least: f64) -> Vec<f64> {
    let [_, middles] = grid.middles();
    let ends = [grid.across.first(), grid.across.last()];
    let [low, high] = ends.map(|end| end.copied().unwrap_or_default());
    let beyond = |end: f64, last: usize, before: usize, column: &[f64]| -> f64 {
        let (Some(own), Some(z)) = (column.get(last), middles.get(last)) else {
            return 0.0;
        };
        let slope = match (column.get(before), middles.get(before)) {
            (Some(value), Some(place)) if place != z => (own - value) / (z - place),
            _ => 0.0,
        };
        (own + slope * (end - z)).max(least.min(*own))
    };
    let last = middles.len().saturating_sub(1);
    let columns = cells.chunks(middles.len().max(1));
    let all = columns.flat_map(|column| {
        let first = beyond(low, 0, 1, column);
        let end = beyond(high, last, last.wrapping_sub(1), column);
        let inner = column.iter().copied();
        [first].into_iter().chain(inner).chain([end])
    });
    all.collect()
}

impl Shell<'_> {
    /// The first quantity of a dimension at the nodes at some samples of a motion (SI); `None` if the film has no such
    /// quantity.
    pub fn quantity(
        &self,
        dimension: Dimension,
        least: f64,
        motion: &Results,
        samples: &[usize],
    ) -> Result<Option<AtNodes>, ReportError> {
        let Some((number, quantity)) = self.field.quantity(dimension) else {
            return Ok(None);
        };
        let mut cells = vec![0.0; self.grid.cells()];
        let mut found = Vec::with_capacity(samples.len());
        let solved = self.field.each_solved(motion, samples, &mut |solver| {
            solver.cells(number, &mut cells);
            found.push(at_nodes(&self.grid, &cells, least));
        });
        match solved {
            Ok(true) => Ok(Some((quantity, found))),
            Ok(false) => Ok(None),
            Err(source) => Err(ReportError::Film {
                path: self.field.path.clone(),
                source,
            }),
        }
    }
}

/// The films of an analysis as hills of pressure. All of them take about `budget` bytes of a page.
pub fn films(
    entry: &Entry,
    motion: &Results,
    budget: usize,
    (times, angles): (&[f64], &[f64]),
) -> Result<Pictured, ReportError> {
    let (shells, notes) = shells(entry, motion)?;
    let mut pictured = Pictured {
        notes,
        ..Pictured::default()
    };
    let nodes: usize = shells.iter().map(|shell| shell.surface.nodes.len()).sum();
    let most = (budget / (BYTES * nodes.max(1))).max(FEWEST);
    let samples: Vec<usize> = (0..times.len())
        .step_by(times.len().div_ceil(most).max(1))
        .collect();
    let radius = shells
        .iter()
        .map(|shell| shell.grid.radius)
        .fold(0.0, f64::max);
    let mut highest: Option<(f64, String, usize)> = None;
    for shell in shells {
        let found = shell.quantity(pressure(), 0.0, motion, &samples)?;
        let Some((quantity, mut pressures)) = found else {
            continue;
        };
        let (unit, scale) = quantity.unit;
        pictured.films.unit = readable_unit(unit);
        for (sample, values) in samples.iter().zip(&mut pressures) {
            for value in values {
                *value /= scale;
                if highest.as_ref().is_none_or(|(most, ..)| *value > *most) {
                    highest = Some((*value, shell.field.path.clone(), *sample));
                }
            }
        }
        pictured.shells.extend(shell.body.map(str::to_owned));
        pictured.films.surfaces.push(FilmSurface {
            name: shell.field.path.clone(),
            surface: shell.surface,
            outward: shell.outward,
            poses: shell.poses,
            moments: samples.clone(),
            pressures,
        });
    }
    pictured.films.height = HILL * radius;
    if let Some((most, path, sample)) = highest {
        let moment = match (angles.get(sample), times.get(sample)) {
            (Some(angle), _) => format!("{angle:.0} °CA"),
            (None, time) => format!("{:.3} ms", 1e3 * time.copied().unwrap_or_default()),
        };
        pictured.notes.push(format!(
            "The hill on a bearing surface is the pressure of its film. All hills have one scale: {} {} ({path}, {moment}) is {} mm high. \
             The pressures of {} of {} moments are drawn, with straight lines between them.",
            significant(most, 3),
            pictured.films.unit,
            significant(1e3 * pictured.films.height, 3),
            samples.len(),
            times.len()
        ));
    }
    Ok(pictured)
}
