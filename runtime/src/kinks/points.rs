//! Points of tables as kinks: both ends, and the inner points beside the argument.
//!
//! A table may have hundreds of points. Three functions follow those beside the argument: the nearest one at the beginning of a step
//! and its two neighbours. A step that passes several of them ends at the first one, and then the functions move on.

use crate::model::Model;
use eng_system::system::TableKink;
use eng_system::table::{Corners, POINTS_BESIDE, Table};

/// Number of functions of the ends: a lower and an upper one.
const ENDS: usize = 2;
/// Continuous derivatives at the inner points of every table, at least: a `monotone` table has one, a spline
/// two.
const INNER: u8 = 1;
/// A function that never changes: there is no point.
const NONE: [f64; 2] = [1.0, 0.0];

/// The inner points of one argument of one element's table.
#[derive(Clone, Debug)]
struct Followed {
    /// Index of the first of its functions.
    first: usize,
    kink: TableKink,
    /// Handle of the table, and the argument with its rate, at the last evaluation.
    handle: f64,
    argument: [f64; 2],
    /// The points; NaN without one.
    points: [f64; POINTS_BESIDE],
}

impl Followed {
    /// Values and rates of the functions of its points.
    fn functions(&self) -> [[f64; 2]; POINTS_BESIDE] {
        let [value, rate] = self.argument;
        self.points.map(|point| match point.is_finite() {
            true => [value - point, rate],
            false => NONE,
        })
    }
}

/// The inner points of all tables, in the order of their functions.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    followed: Vec<Followed>,
}

/// The table of a handle.
fn table(model: &Model, handle: f64) -> Option<&Table> {
    let tables = &model.compiled.system.tables;
    tables.get(handle as usize).filter(|_| handle >= 0.0)
}

fn corners(model: &Model, handle: f64, kink: TableKink) -> Corners<'_> {
    table(model, handle).map_or(Corners::default(), |table| {
        table.kinks(usize::from(kink.argument), kink.smooth)
    })
}

impl Points {
    /// Adds an argument whose first function has this index. Returns the number of its functions. Loads that bend at inner points cost
    /// accuracy alone, which the error control keeps; at those of constraints accelerations jump.
    pub fn add(&mut self, first: usize, kink: TableKink, constrains: bool) -> usize {
        if !constrains || kink.smooth <= INNER {
            return ENDS;
        }
        self.followed.push(Followed {
            first,
            kink,
            handle: -1.0,
            argument: [f64::NAN; 2],
            points: [f64::NAN; POINTS_BESIDE],
        });
        ENDS + POINTS_BESIDE
    }

    /// Values and rates of the functions from an index on, for an argument with its value and rate.
    pub fn functions(
        &mut self,
        model: &Model,
        (first, kink): (usize, TableKink),
        handle: f64,
        [value, rate]: [f64; 2],
    ) -> impl Iterator<Item = [f64; 2]> + use<> {
        let [low, high] = corners(model, handle, kink).ends;
        let ends = [
            low.map_or(NONE, |low| [value - low, rate]),
            high.map_or(NONE, |high| [high - value, -rate]),
        ];
        let found = self.followed.binary_search_by_key(&first, |f| f.first);
        let followed = found.ok().and_then(|at| self.followed.get_mut(at));
        let beside = followed.map(|followed| {
            (followed.handle, followed.argument) = (handle, [value, rate]);
            followed.functions()
        });
        ends.into_iter().chain(beside.into_iter().flatten())
    }

    /// Moves on to the points beside the arguments of the last evaluation. Returns the functions that have another point now, with
    /// their values and rates.
    pub fn follow(&mut self, model: &Model) -> Vec<(usize, [f64; 2])> {
        let mut moved = Vec::new();
        for followed in &mut self.followed {
            let beside =
                corners(model, followed.handle, followed.kink).beside(followed.argument[0]);
            let beside = beside.map(|point| point.unwrap_or(f64::NAN));
            let before = std::mem::replace(&mut followed.points, beside);
            let functions = followed.functions();
            for (slot, function) in functions.into_iter().enumerate() {
                if before[slot].to_bits() != beside[slot].to_bits() {
                    moved.push((followed.first + ENDS + slot, function));
                }
            }
        }
        moved
    }

    /// Its numbers for a checkpoint.
    pub fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        self.followed.iter().flat_map(|followed| followed.points)
    }

    /// Sets them from a checkpoint, and returns the others.
    pub fn set_numbers<'a>(&mut self, numbers: &'a [f64]) -> &'a [f64] {
        let (numbers, rest) =
            numbers.split_at((POINTS_BESIDE * self.followed.len()).min(numbers.len()));
        let points = self.followed.iter_mut().flat_map(|f| &mut f.points);
        for (point, number) in points.zip(numbers) {
            *point = *number;
        }
        rest
    }
}
