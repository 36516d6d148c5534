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

use crate::results::{CellColumn, Column, Results, display_unit};
use eng_runtime::model::Model;
use eng_system::Dimension;
use eng_system::field::{
    Accuracy, CellQuantity, FieldError, FieldGrid, FieldKernel, FieldSolver, KERNELS, Kernel, Past,
    Takes, drives,
};
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

/// Fields are equal if their names and sizes are: these decide which numbers belong to a field.
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
                display: display_unit(quantity.unit.0, quantity.unit.1),
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

/// The solution of a field at a moment.
#[derive(Clone)]
pub(crate) struct Solution {
    kernel: &'static Kernel,
    with: SolvedWith,
    answers: Vec<f64>,
    readings: Vec<f64>,
}

impl Solution {
    /// The numbers of a result by its name; `None` if the kernel has no such result.
    pub fn result<const N: usize>(&self, name: &str) -> Option<[f64; N]> {
        let (_, first, answer) = self.kernel.result(name)?;
        let numbers = match answer {
            true => &self.answers,
            false => &self.readings,
        };
        let place = first as usize..first as usize + N;
        numbers.get(place)?.try_into().ok()
    }

    /// Solves the field again with a solver; readings with slopes cost more.
    fn solve(&mut self, solver: &mut dyn FieldSolver, slopes: bool) -> Result<(), FieldError> {
        let Solution { with, answers, .. } = self;
        solver.solve(&with.drives, with.past(), Accuracy::Full, answers)?;
        solver.read(&mut self.readings, slopes);
        Ok(())
    }

    /// Turns and scales the place e of the pin and its rate ė by the same complex factor until the force is the wanted one. An
    /// orbit `c e(t)` with a constant c has the rate `c ė(t)`. This holds in every frame that turns about the shell's axis, so
    /// the result does not depend on the part that turns. A rate that is held would depend on it: a pin under a load at rest in
    /// space moves against a turning shell, and faster where it is farther from the middle.
    ///
    /// Newton's method takes the stiffness and the damping of the film, and keeps them while they serve. The
    /// solver must have solved this field, and its readings must have slopes. A move is a third of the least
    /// film at most, so the film stays open. `None` if no such place was found.
    fn at_force(
        mut self,
        wanted: [f64; 2],
        gap_name: &str,
        solver: &mut dyn FieldSolver,
    ) -> Option<Solution> {
        let size = libm::hypot(wanted[0], wanted[1]);
        // the eccentricity and its rate are the first drives of a film
        let [place, rate] =
            [0, 2].map(|at| Some([*self.with.drives.get(at)?, *self.with.drives.get(at + 1)?]));
        let (place, rate) = (place?, rate?);
        let turned = |[x, y]: [f64; 2]| [-y, x];
        let mut factor = [1.0, 0.0];
        let mut before = f64::INFINITY;
        for _ in 0..LOAD_ROUNDS {
            let (force, [gap]) = (self.result::<2>("force")?, self.result::<1>(gap_name)?);
            let missed = [0, 1].map(|axis| force[axis] - wanted[axis]);
            let miss = libm::hypot(missed[0], missed[1]);
            if miss <= SAME_LOAD * size {
                return Some(self);
            }
            if miss > SERVES * before {
                solver.read(&mut self.readings, true);
            }
            before = miss;
            let (stiffness, damping) =
                (self.result::<4>("stiffness")?, self.result::<4>("damping")?);
            // the force that is lost per change of the factor's real and imaginary part
            let lost = |place: [f64; 2], rate: [f64; 2]| {
                [0, 2].map(|row| {
                    stiffness[row] * place[0]
                        + stiffness[row + 1] * place[1]
                        + damping[row] * rate[0]
                        + damping[row + 1] * rate[1]
                })
            };
            let (real, imaginary) = (lost(place, rate), lost(turned(place), turned(rate)));
            let determinant = real[0] * imaginary[1] - real[1] * imaginary[0];
            let change = [
                (imaginary[1] * missed[0] - imaginary[0] * missed[1]) / determinant,
                (real[0] * missed[1] - real[1] * missed[0]) / determinant,
            ];
            let moved = libm::hypot(change[0], change[1]) * libm::hypot(place[0], place[1]);
            let share = (gap / 3.0 / moved).min(1.0);
            factor = [0, 1].map(|part| factor[part] + share * change[part]);
            let scaled =
                |v: [f64; 2]| [0, 1].map(|axis| factor[0] * v[axis] + factor[1] * turned(v)[axis]);
            let orbit = [scaled(place), scaled(rate)];
            for (drive, number) in self.with.drives.iter_mut().zip(orbit.as_flattened()) {
                *drive = *number;
            }
            self.solve(solver, false).ok()?;
        }
        None
    }
}

/// A field at a moment, on its own grid and on one of twice as many cells in both directions.
pub(crate) struct OnBothGrids {
    /// On its own grid.
    pub own: Solution,
    /// On the finer grid.
    pub finer: Solution,
    /// On the finer grid where its force is that of the own grid, on a scaled orbit; `None` if no such place
    /// was found.
    pub at_load: Option<Solution>,
}

/// Most rounds of the search for a place with a given force. A choice: Newton's method needs a few, and with
/// one matrix some more.
const LOAD_ROUNDS: usize = 20;
/// Largest error of that force, as a share of it. A choice: far below the error of the cells that is sought.
const SAME_LOAD: f64 = 1e-6;
/// Share of the error that a move may leave. If it leaves more, the stiffness is computed again. A choice: a
/// larger share would let rounds pass with a stiffness that no longer serves, a smaller one would compute it
/// in almost every round.
const SERVES: f64 = 0.1;

impl RecordedField {
    /// The field at moments of a motion. Moments that its kernel does not solve are left out.
    pub(crate) fn solved(&self, motion: &Results, samples: &[usize]) -> Vec<Solution> {
        let mut solver = self.own.solver(&[]);
        let numbers = self.columns_of(motion).unwrap_or_default();
        let moments = samples.iter().filter_map(|at| self.at(&numbers, *at));
        let solved = moments.filter_map(|with| {
            let mut solution = Solution {
                kernel: self.kernel,
                with,
                answers: vec![0.0; self.answer_count()],
                readings: vec![0.0; self.kernel.reading_count() as usize],
            };
            solution.solve(solver.as_mut(), false).ok()?;
            Some(solution)
        });
        solved.collect()
    }

    /// The field on twice as many cells in both directions.
    ///
    /// # Errors
    /// The reason for which its solution at a moment would not show the error of the cells.
    pub(crate) fn refined(&self) -> Result<Arc<dyn FieldKernel>, FieldError> {
        self.own.refined()
    }

    /// Whether it keeps numbers from step to step, such as the oil in its cells.
    pub(crate) fn has_memory(&self) -> bool {
        self.own.memory() > 0
    }

    /// The largest share, over these moments, of the cells at flooded ends that are not full of oil. `None` without
    /// flooded ends.
    ///
    /// # Errors
    /// Those of the kernel.
    pub(crate) fn unfilled_ends(
        &self,
        motion: &Results,
        moments: &[usize],
    ) -> Result<Option<f64>, FieldError> {
        let pressure = format!("{}.end_pressure", self.name);
        let flooded = |at: &usize| {
            let column = motion.columns().iter().find(|c| c.path == pressure);
            column
                .and_then(|c| c.values.get(*at))
                .is_some_and(|p| *p > 0.0)
        };
        let moments: Vec<usize> = moments.iter().copied().filter(flooded).collect();
        let content = self
            .kernel
            .cells
            .iter()
            .position(|cell| cell.name == "content");
        let Some(content) = content.filter(|_| !moments.is_empty()) else {
            return Ok(None);
        };
        let grid = self.grid();
        let across = grid.across.len().saturating_sub(1).max(1);
        let mut values = vec![0.0; grid.cells()];
        let mut most = 0.0_f64;
        self.each_solved(motion, &moments, &mut |solver| {
            solver.cells(content, &mut values);
            let columns = values.chunks(across);
            let ends = columns
                .flat_map(|column| [column.first(), column.last()])
                .flatten();
            let unfilled = ends.clone().filter(|content| **content < 1.0).count();
            most = most.max(unfilled as f64 / ends.count() as f64);
        })?;
        Ok(Some(most))
    }

    /// These solutions beside the solutions of the finer field. Moments that the finer grid does not solve
    /// are left out. `gap_name` is the name of the result with the least gap.
    pub(crate) fn on_both_grids(
        &self,
        finer: &dyn FieldKernel,
        solved: Vec<Solution>,
        gap_name: &str,
    ) -> Vec<OnBothGrids> {
        let mut solver = finer.solver(&[]);
        let both = solved.into_iter().filter_map(|own| {
            let mut finer = own.clone();
            finer.solve(solver.as_mut(), true).ok()?;
            let wanted = own.result::<2>("force")?;
            let at_load = finer.clone().at_force(wanted, gap_name, solver.as_mut());
            Some(OnBothGrids {
                own,
                finer,
                at_load,
            })
        });
        both.collect()
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
