//! The error of films by their cells: the same moments on twice as many cells in both directions.
//!
//! The error of a film is of second order in the cells, so twice as many leave a quarter of it. The difference of both
//! times 4/3 is the error of the coarser one (Richardson, Phil. Trans. A 210 (1911) 307).
//!
//! A film on few cells may carry too much load at a given place of the pin. At a given load its pin is then
//! too near to the middle, and its film is too thick. So the errors at the same place and those at the same
//! load differ. The load is compared at the same place, the highest pressure and the least film at the same
//! load.
//!
//! Two kinds of films have no such error here. The first are films with memory. The finer film would continue
//! from the memory of the coarser one, and a single step does not show the difference of two films that were
//! apart from the start. The second are films with openings in the pin. These lie over other cells at each
//! moment, so the errors of single moments are no measure of the errors of a run. The text of such films
//! gives the reason. It also states the share of the flooded ends along which the oil fills less than a cell: the
//! cells decide the inflow there.
//!
//! A solution on twice as many cells takes five to thirteen times as long, so only some moments have one. The
//! film on its own cells chooses them: those of the largest loads, of the highest pressures and of the least
//! films. There all errors are largest, because the cells must follow the steepest pressure.

use crate::machine::Machine;
use crate::recorded_field::{OnBothGrids, RecordedField, Solution};
use crate::results::Results;
use eng_system::field::{FieldError, FieldGrid};
use eng_system::significant::significant;

/// Number of moments of the last cycle among which the moments on the finer cells are chosen. A choice: each
/// takes a solution on the cells of the run.
const MOMENTS: usize = 20;
/// Number of moments with the largest loads, of those with the highest pressures, and of those with the least
/// films. A choice: each takes a solution on four times as many cells.
const HARDEST: usize = 3;
/// The error of the coarser film over its difference from the film on twice as many cells: errors of second
/// order fall to a quarter, so the difference is three quarters of the error.
const WHOLE: f64 = 4.0 / 3.0;

/// Share of the flooded ends with unfilled cells above which the text mentions them. A choice: below it the
/// flow through the ends hardly depends on them.
const UNFILLED: f64 = 0.05;
/// Share of the size of `shear` below which a load is rounding, such as that of a centred pin. A choice some
/// decades above the rounding unit.
const NO_LOAD: f64 = 1e-9;
/// Load (N) without meaning at any shear, as in the output `radial_load`. A choice: the weight of a tenth of
/// a milligram.
const LEAST_LOAD: f64 = 1e-6;

/// The error of a film by its cells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GridError {
    /// The element: `main[3]`.
    pub path: String,
    /// Cells around and across.
    pub cells: [usize; 2],
    /// Moments among which those on the finer cells were chosen.
    pub among: usize,
    pub found: Found,
}

/// The findings about the cells of a film.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Found {
    /// The errors at so many moments on the finer cells.
    Errors(usize, LoadErrors),
    /// A film without load.
    NoLoad,
    /// Finer cells at a moment do not show the error.
    Unknown {
        /// The reason.
        reason: String,
        /// Share of the flooded ends of a film with memory whose outermost cell is not full of oil.
        unfilled: Option<f64>,
    },
}

/// The errors of a film that carries a load.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LoadErrors {
    /// Largest error of the load at the same places of the pin, over the largest load of the moments; positive for a load
    /// that is too high.
    pub load: f64,
    /// Largest error of the highest pressure at the same load on a scaled orbit ([`OnBothGrids::at_load`]), over
    /// the largest pressure of the moments. `None` if no place with this load was found.
    pub pressure: Option<f64>,
    /// The least film of the moments (m), and by how much it is too thick (m) at the same load on a scaled orbit.
    /// `None` if no place with this load was found.
    pub film: Option<[f64; 2]>,
}

impl GridError {
    /// The error in words.
    pub fn text(&self) -> String {
        let [around, across] = self.cells;
        let film = format!("cells of {}, {around} × {across}", self.path);
        match &self.found {
            Found::Errors(moments, errors) => {
                let moments = match *moments < self.among {
                    true => format!("the {moments} most critical of {} moments", self.among),
                    false => format!("{} moments", self.among),
                };
                let errors = errors.text();
                format!(
                    "{film}: compared with twice as many cells in both directions (at {moments}), {errors}"
                )
            }
            Found::NoLoad => format!(
                "{film}: no load at {} moments, so the error of the cells is not known",
                self.among
            ),
            Found::Unknown { reason, unfilled } => {
                let known = format!(
                    "{film}: {reason}, so the error of the cells is not known: compare a run on twice as many"
                );
                match unfilled.filter(|share| *share > UNFILLED) {
                    Some(share) => format!(
                        "{known}; the oil fills less than the outermost cell along {} % of the flooded ends, and the cells decide its flow there",
                        significant(100.0 * share, 2)
                    ),
                    None => known,
                }
            }
        }
    }
}

impl LoadErrors {
    fn text(&self) -> String {
        let percent = |share: f64| {
            let side = if share < 0.0 { "low" } else { "high" };
            format!("{} % too {side}", significant(100.0 * share.abs(), 2))
        };
        let mut text = format!(
            "the load at the same position of the pin is up to {}",
            percent(self.load)
        );
        match self.pressure {
            // the highest pressure is then that of an opening, which both grids state
            Some(0.0) => text += "; at the same load both grids have the same highest pressure",
            Some(pressure) => {
                text += &format!(
                    "; at the same load the highest pressure is up to {}",
                    percent(pressure)
                );
            }
            None => (),
        }
        if let Some([film, thicker]) = self.film {
            let side = if thicker < 0.0 { "thin" } else { "thick" };
            text += &format!(
                ", and the least film of {} µm is {} µm too {side}",
                significant(1e6 * film, 3),
                significant(1e6 * thicker.abs(), 2)
            );
        }
        text
    }
}

/// The errors of all films of a run, from its motion.
pub(crate) fn grid_errors(machine: &Machine, motion: &Results) -> Vec<GridError> {
    let count = motion.samples();
    // such as the motion of `linear`, which is a state alone
    if count == 0 {
        return Vec::new();
    }
    let moments: Vec<usize> = match count {
        0..=MOMENTS => (0..count).collect(),
        // a cycle that repeats has one moment at both ends
        _ => (0..MOMENTS)
            .map(|k| (k + 1) * (count - 1) / MOMENTS)
            .collect(),
    };
    let fields = machine.fields.iter();
    fields
        .filter_map(|field| of_field(field, motion, &moments))
        .collect()
}

fn of_field(field: &RecordedField, motion: &Results, moments: &[usize]) -> Option<GridError> {
    let FieldGrid { around, across, .. } = field.grid();
    let cells = [around, across].map(|lines| lines.len().saturating_sub(1));
    let error = |among, found| GridError {
        path: field.path.clone(),
        cells,
        among,
        found,
    };
    let finer = match field.refined() {
        Ok(finer) => finer,
        Err(FieldError(reason)) => {
            let unfilled = match field.has_memory() {
                true => field.unfilled_ends(motion, moments).ok()?,
                false => None,
            };
            return Some(error(moments.len(), Found::Unknown { reason, unfilled }));
        }
    };
    let own = field.solved(motion, moments);
    let among = own.len();
    let solved = field.on_both_grids(finer.as_ref(), most_critical(own)?, "minimum_film");
    let loads = solved
        .iter()
        .map(|both| Some([load(&both.own)?, load(&both.finer)?]));
    let loads: Vec<[f64; 2]> = loads.collect::<Option<_>>()?;
    let at_load = |name| -> Vec<[f64; 2]> {
        let pairs = solved.iter().filter_map(|both| {
            let at_load = both.at_load.as_ref()?;
            Some([number(&both.own, name)?, number(at_load, name)?])
        });
        pairs.collect()
    };
    let pressures = at_load("maximum_pressure");
    let films = at_load("minimum_film").into_iter();
    let thinnest = films.min_by(|a, b| a[0].total_cmp(&b[0]));
    let most = loads.iter().map(|[_, finer]| *finer).fold(0.0, f64::max);
    let loaded = most > LEAST_LOAD && most > NO_LOAD * shear(&solved)?;
    let errors = |load| LoadErrors {
        load,
        pressure: share_of_error(&pressures),
        film: thinnest.map(|[own, finer]| [own, WHOLE * (own - finer)]),
    };
    let found = match share_of_error(&loads).filter(|_| loaded) {
        Some(load) => Found::Errors(solved.len(), errors(load)),
        None => Found::NoLoad,
    };
    Some(error(among, found))
}

fn number(solution: &Solution, name: &str) -> Option<f64> {
    solution.result::<1>(name).map(|[number]| number)
}

fn load(solution: &Solution) -> Option<f64> {
    let force = solution.result::<2>("force")?;
    Some(libm::hypot(force[0], force[1]))
}

/// The solutions with the largest loads, the highest pressures and the least films, in their order in time.
fn most_critical(solved: Vec<Solution>) -> Option<Vec<Solution>> {
    let mut chosen = vec![false; solved.len()];
    for sort in [
        |solution: &Solution| load(solution),
        |solution: &Solution| number(solution, "maximum_pressure"),
        |solution: &Solution| number(solution, "minimum_film").map(|film| -film),
    ] {
        let sizes = solved.iter().map(sort).collect::<Option<Vec<f64>>>()?;
        let mut order: Vec<usize> = (0..solved.len()).collect();
        // of equal ones the first
        order.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
        for at in order.into_iter().take(HARDEST) {
            chosen[at] = true;
        }
    }
    let both = solved.into_iter().zip(chosen);
    Some(
        both.filter_map(|(one, chosen)| chosen.then_some(one))
            .collect(),
    )
}

/// The largest torque of the shear over the least gap (N): the size of a load that the motion of the surfaces makes.
fn shear(solved: &[OnBothGrids]) -> Option<f64> {
    let mut sizes = solved.iter().map(|both| {
        let torque = number(&both.own, "torque")?;
        let gap = number(&both.finer, "minimum_film")?;
        Some(if gap > 0.0 { torque.abs() / gap } else { 0.0 })
    });
    sizes.try_fold(0.0_f64, |most, size| Some(most.max(size?)))
}

/// The largest error of numbers on the own cells, as a share of the largest number on the finer cells. A pair has
/// the own number and the finer one. The error is positive if the own number is too large. `None` if all finer
/// numbers are zero.
fn share_of_error(pairs: &[[f64; 2]]) -> Option<f64> {
    let most = pairs
        .iter()
        .fold(0.0_f64, |most, [_, finer]| most.max(finer.abs()));
    let errors = pairs.iter().map(|[own, finer]| WHOLE * (own - finer));
    let error = errors.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    (most > 0.0).then_some(error / most)
}
