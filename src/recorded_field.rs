//! Fields at the moments that a motion keeps, solved again by the same kernels.
//!
//! The motion has the numbers with which each field was solved. A film has its pressure, gap and content in its cells.
//!
//! Columns of a motion for a field `F` (`main[3].reynolds`: the element and its kernel), all in SI:
//!
//! | column | meaning |
//! | --- | --- |
//! | `F.eccentricity.x`, `F.spin`, `F.supply[1]`, … | the drives, by the names of the kernel's arguments |
//! | `F.surface[1]`, …, `F.surface_rate[1]`, … | amplitudes of an elastic surface by the modes of its body, and their rates |
//! | `F.step` | time since the beginning of the step; 0 for a field in balance |
//! | `F.memory[1]`, … | the memory of the field at that beginning |

use crate::results::{CellColumn, Column, Results};
use eng_runtime::model::Model;
use eng_system::field::{
    Accuracy, CellQuantity, FieldError, FieldGrid, FieldKernel, FieldSolver, KERNELS, Kernel, Past,
    Takes, drives,
};
use eng_system::{Dimension, DisplayUnit};
use std::collections::HashMap;
use std::sync::Arc;

/// A field of an element with outputs.
#[derive(Clone, Debug)]
pub struct RecordedField {
    /// The element: `main[3]`.
    pub path: String,
    /// Prefix of its columns: `main[3].reynolds`.
    name: String,
    kernel: &'static Kernel,
    openings: u32,
    own: Arc<dyn FieldKernel>,
}

/// Names and sizes decide which numbers belong to a field.
impl PartialEq for RecordedField {
    fn eq(&self, other: &Self) -> bool {
        let sizes = |field: &Self| (field.openings, field.own.memory());
        self.name == other.name && sizes(self) == sizes(other)
    }
}

/// The numbers with which a field was solved at a moment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SolvedWith {
    drives: Vec<f64>,
    step: f64,
    memory: Vec<f64>,
}

impl RecordedField {
    /// The fields of a bound model in the order of [`eng_runtime::Sample::fields`].
    pub(crate) fn all(model: &Model) -> Vec<RecordedField> {
        let system = &model.compiled.system;
        let mut found: Vec<RecordedField> = Vec::new();
        for (at, (element, kernels)) in system.elements.iter().zip(&model.kernels).enumerate() {
            if system.channels.iter().all(|c| c.element as usize != at) {
                continue;
            }
            for (source, own) in element.fields.iter().zip(kernels) {
                let Some(kernel) = KERNELS.get(source.kernel as usize) else {
                    continue;
                };
                let path = &element.origin.path;
                let same = |field: &&RecordedField| {
                    field.path == *path && std::ptr::eq(field.kernel, kernel)
                };
                let name = match found.iter().filter(same).count() {
                    0 => format!("{path}.{}", kernel.name),
                    before => format!("{path}.{}[{}]", kernel.name, before + 1),
                };
                found.push(RecordedField {
                    path: path.clone(),
                    name,
                    kernel,
                    openings: source.openings,
                    own: Arc::clone(own),
                });
            }
        }
        found
    }

    /// Names and dimensions of its columns.
    pub(crate) fn columns(&self) -> Vec<(String, Dimension)> {
        let mut columns = Vec::new();
        let name = &self.name;
        for (argument, count) in drives(self.kernel, self.openings) {
            let path = format!("{name}.{}", argument.name);
            match argument.takes {
                Takes::DrivePair => {
                    columns.extend(["x", "y"].map(|a| (format!("{path}.{a}"), argument.dimension)));
                }
                Takes::Drives => {
                    let all = 1..=count;
                    columns.extend(all.map(|k| (format!("{path}[{k}]"), argument.dimension)));
                }
                _ => columns.push((path, argument.dimension)),
            }
        }
        let speed = Dimension::LENGTH.over(Dimension::TIME);
        for (motion, dimension) in [("surface", Dimension::LENGTH), ("surface_rate", speed)] {
            let shapes = 1..=self.own.shapes();
            columns.extend(shapes.map(|k| (format!("{name}.{motion}[{k}]"), dimension)));
        }
        columns.push((format!("{name}.step"), Dimension::TIME));
        let memory = 1..=self.own.memory();
        columns.extend(memory.map(|k| (format!("{name}.memory[{k}]"), Dimension::ONE)));
        columns
    }

    /// Number of its answers, the forces of an elastic surface among them.
    fn answer_count(&self) -> usize {
        self.kernel.answer_count() as usize + self.own.shapes()
    }

    /// Its cells.
    pub(crate) fn grid(&self) -> FieldGrid {
        self.own.grid()
    }

    /// Its columns in a motion; `None` if the motion does not have them.
    pub(crate) fn columns_of<'m>(&self, motion: &'m Results) -> Option<Vec<&'m Column>> {
        let named: HashMap<&str, &Column> =
            (motion.columns().iter().map(|c| (c.path.as_str(), c))).collect();
        let own = self.columns();
        own.iter()
            .map(|(path, _)| named.get(path.as_str()).copied())
            .collect()
    }

    /// The numbers of a sample in its columns.
    pub(crate) fn at(&self, columns: &[&Column], sample: usize) -> Option<SolvedWith> {
        let values = columns
            .iter()
            .map(|column| column.values.get(sample).copied());
        let mut drives: Vec<f64> = values.collect::<Option<_>>()?;
        let memory = drives.split_off(drives.len().checked_sub(self.own.memory())?);
        let step = drives.pop()?;
        Some(SolvedWith {
            drives,
            step,
            memory,
        })
    }

    /// Solves the field as at a moment.
    ///
    /// # Errors
    /// Those of the kernel.
    pub(crate) fn solve(&self, with: &SolvedWith) -> Result<Box<dyn FieldSolver>, FieldError> {
        let mut solver = self.own.solver(&[]);
        let mut answers = vec![0.0; self.answer_count()];
        solver.solve(&with.drives, with.past(), Accuracy::Full, &mut answers)?;
        Ok(solver)
    }
}

impl RecordedField {
    /// The first quantity of its cells that has a dimension, with its number.
    pub(crate) fn quantity(&self, dimension: Dimension) -> Option<(usize, &'static CellQuantity)> {
        let mut cells = self.kernel.cells.iter().enumerate();
        cells.find(|(_, cell)| cell.dimension == dimension)
    }

    /// Solves the field at samples of a motion, one after the other, and gives each solution to `take`; false if the
    /// motion does not have its numbers.
    ///
    /// # Errors
    /// Those of the kernel.
    pub(crate) fn each_solved(
        &self,
        motion: &Results,
        samples: &[usize],
        take: &mut dyn FnMut(&dyn FieldSolver),
    ) -> Result<bool, FieldError> {
        let Some(numbers) = self.columns_of(motion) else {
            return Ok(false);
        };
        let mut solver = self.own.solver(&[]);
        let mut answers = vec![0.0; self.answer_count()];
        for sample in samples {
            let Some(with) = self.at(&numbers, *sample) else {
                return Ok(false);
            };
            solver.solve(&with.drives, with.past(), Accuracy::Full, &mut answers)?;
            take(solver.as_ref());
        }
        Ok(true)
    }

    /// The quantities of the field in its cells at all moments of a motion; `None` if the motion does not
    /// have its numbers.
    ///
    /// # Errors
    /// Those of the kernel.
    pub(crate) fn cells(
        &self,
        motion: &Results,
        frame: &str,
    ) -> Result<Option<Vec<CellColumn>>, FieldError> {
        let grid = self.grid();
        // only further fields of an element need the kernel in their names
        let first = self.name == format!("{}.{}", self.path, self.kernel.name);
        let begin = if first { &self.path } else { &self.name };
        let mut columns: Vec<CellColumn> = (self.kernel.cells.iter())
            .map(|quantity| CellColumn {
                path: format!("{begin}.{}", quantity.name),
                dimension: quantity.dimension,
                display: DisplayUnit {
                    symbol: quantity.unit.0.to_owned(),
                    scale: quantity.unit.1,
                    offset: 0.0,
                },
                frame: frame.to_owned(),
                grid: grid.clone(),
                values: Vec::with_capacity(grid.cells() * motion.samples()),
            })
            .collect();
        let mut values = vec![0.0; grid.cells()];
        let all: Vec<usize> = (0..motion.samples()).collect();
        let known = self.each_solved(motion, &all, &mut |solver| {
            for (quantity, column) in columns.iter_mut().enumerate() {
                solver.cells(quantity, &mut values);
                let shown = values.iter().map(|x| column.display.from_si(*x) as f32);
                column.values.extend(shown);
            }
        })?;
        Ok(known.then_some(columns))
    }
}

/// A field at a moment, on its own grid and on one of twice as many cells in both directions.
#[derive(Clone)]
pub(crate) struct Twice {
    /// The kernel.
    pub kernel: &'static Kernel,
    /// Answers on its own grid and on the finer one.
    pub answers: [Vec<f64>; 2],
    /// Readings on both; those of the own grid without slopes.
    pub readings: [Vec<f64>; 2],
    /// Readings of the finer grid where its force is that of the own grid, at the same rates; `None` if no such place
    /// was found.
    pub at_load: Option<Vec<f64>>,
}

impl Twice {
    /// Numbers of a result on both grids; `None` if the kernel has no such result.
    pub fn result<const N: usize>(&self, name: &str) -> Option<[[f64; N]; 2]> {
        let (_, first, answer) = self.kernel.result(name)?;
        let [own, finer] = if answer {
            &self.answers
        } else {
            &self.readings
        };
        let of = |numbers: &[f64]| -> Option<[f64; N]> {
            let place = first as usize..first as usize + N;
            numbers.get(place)?.try_into().ok()
        };
        Some([of(own)?, of(finer)?])
    }

    /// A reading of the own grid, and that of the finer one at the same force; `None` if there is none.
    pub fn at_same_load(&self, name: &str) -> Option<[f64; 2]> {
        let (_, first, answer) = self.kernel.result(name)?;
        let finer = self.at_load.as_ref().filter(|_| !answer)?;
        Some([
            *self.readings[0].get(first as usize)?,
            *finer.get(first as usize)?,
        ])
    }

    /// Moves the pin in the finer grid until its force is that of the own grid, by Newton's method with the stiffness
    /// of the film, and keeps the readings there. A move is a third of the least film at most, so the film stays open.
    fn find_same_load(
        &mut self,
        with: &SolvedWith,
        gap_name: &str,
        solver: &mut dyn FieldSolver,
    ) -> Option<Vec<f64>> {
        let [wanted, mut force] = self.result::<2>("force")?;
        let [_, mut stiffness] = self.result::<4>("stiffness")?;
        let [_, [mut gap]] = self.result::<1>(gap_name)?;
        let size = libm::hypot(wanted[0], wanted[1]);
        let mut place = with.drives.clone();
        for _ in 0..LOAD_ROUNDS {
            let missed = [0, 1].map(|axis| force[axis] - wanted[axis]);
            if libm::hypot(missed[0], missed[1]) <= SAME_LOAD * size {
                return Some(self.readings[1].clone());
            }
            let [xx, xy, yx, yy] = stiffness;
            let determinant = xx * yy - xy * yx;
            let moved = [
                (yy * missed[0] - xy * missed[1]) / determinant,
                (xx * missed[1] - yx * missed[0]) / determinant,
            ];
            let share = (gap / 3.0 / libm::hypot(moved[0], moved[1])).min(1.0);
            // the eccentricity is the first drive of a film
            for (drive, moved) in place.iter_mut().zip(moved) {
                *drive += share * moved;
            }
            let [_, answers] = &mut self.answers;
            let solved = solver.solve(&place, with.past(), Accuracy::Full, answers);
            solved.ok()?;
            solver.read(&mut self.readings[1], true);
            force = self.result::<2>("force")?[1];
            stiffness = self.result::<4>("stiffness")?[1];
            gap = self.result::<1>(gap_name)?[1][0];
        }
        None
    }
}

/// Most rounds of the search for a place with a given force, and its error as a share of the force.
const LOAD_ROUNDS: usize = 20;
const SAME_LOAD: f64 = 1e-6;

impl RecordedField {
    /// The field at moments of a motion, on its own cells and on twice as many in both directions. Moments
    /// that the finer grid does not solve are left out. `gap_name` is the reading of the least gap.
    ///
    /// # Errors
    /// If there is no finer grid.
    pub(crate) fn twice(
        &self,
        motion: &Results,
        samples: &[usize],
        gap_name: &str,
    ) -> Result<Vec<Twice>, FieldError> {
        let finer = self.own.refined()?;
        let mut solvers = [self.own.solver(&[]), finer.solver(&[])];
        let mut found = Vec::new();
        let numbers = self.columns_of(motion).unwrap_or_default();
        for with in samples.iter().filter_map(|at| self.at(&numbers, *at)) {
            let blank = |count: usize| [vec![0.0; count], vec![0.0; count]];
            let mut twice = Twice {
                kernel: self.kernel,
                answers: blank(self.answer_count()),
                readings: blank(self.kernel.reading_count() as usize),
                at_load: None,
            };
            // the finer one alone has the slopes
            let both = [false, true].into_iter().zip(&mut solvers);
            let mut both = both.zip(&mut twice.answers).zip(&mut twice.readings);
            let solved = both.try_for_each(|(((slopes, solver), answers), readings)| {
                solver.solve(&with.drives, with.past(), Accuracy::Full, answers)?;
                solver.read(readings, slopes);
                Ok::<(), FieldError>(())
            });
            if solved.is_ok() {
                let mut moved = twice.clone();
                twice.at_load = moved.find_same_load(&with, gap_name, solvers[1].as_mut());
                found.push(twice);
            }
        }
        Ok(found)
    }
}

impl SolvedWith {
    fn past(&self) -> Option<Past<'_>> {
        (self.step > 0.0).then_some(Past {
            step: self.step,
            memory: &self.memory,
        })
    }
}
