//! Elimination by dense blocks along a tree.

use super::dissection::Dissection;
use super::front::{Front, Work};
use super::probe::Probe;
use super::{LinearError, LinearSolver, Pattern, SparseLu};

/// Entries of the matrix that lie below each other in it and in a front.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// First entry of the pattern.
    entry: usize,
    length: usize,
    /// Place of the first in the front, as planned.
    row: usize,
    column: usize,
}

/// The contents of a front.
#[derive(Clone, Debug)]
struct Recipe {
    /// Unknowns: those to be eliminated, then the border.
    unknowns: Vec<usize>,
    pivots: usize,
    runs: Vec<Run>,
    /// The fronts that leave their borders to this one, and the planned positions of these borders in it.
    children: Vec<(usize, Vec<usize>)>,
    root: bool,
}

/// LU by a tree of dense blocks; see [`super::dissection`].
///
/// Rows are exchanged inside a block. A column without an acceptable pivot is left to the parent. So the
/// order is fixed for a sound matrix and adapts to another. If the factors fail the probe, or a root has no
/// pivots, [`SparseLu`] factors the matrix. No operation is fused, and the order of operations is fixed, so
/// the same values give the same bits on every machine.
#[derive(Debug)]
pub struct BlockLu {
    pattern: Pattern,
    recipes: Vec<Recipe>,
    fronts: Vec<Front>,
    work: Work,
    places: Vec<usize>,
    local: Vec<f64>,
    solution: Vec<f64>,
    probe: Probe,
    general: Option<SparseLu>,
    state: State,
    fallbacks: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Empty,
    Blocks,
    General,
}

impl BlockLu {
    /// Plans the elimination of a pattern.
    pub fn new(pattern: &Pattern) -> BlockLu {
        let plan = Dissection::new(pattern);
        let n = pattern.size();
        let mut owner = vec![0; n];
        for (index, front) in plan.fronts().iter().enumerate() {
            for unknown in &front.pivots {
                owner[*unknown] = index;
            }
        }
        let mut recipes: Vec<Recipe> = plan
            .fronts()
            .iter()
            .map(|front| Recipe {
                unknowns: front.pivots.iter().chain(&front.border).copied().collect(),
                pivots: front.pivots.len(),
                runs: Vec::new(),
                children: Vec::new(),
                root: front.parent.is_none(),
            })
            .collect();
        // Places of the unknowns in one front after the other.
        let mut place = vec![usize::MAX; n];
        let mut largest = 0;
        for index in 0..recipes.len() {
            let recipe = &mut recipes[index];
            largest = largest.max(recipe.unknowns.len());
            for (i, unknown) in recipe.unknowns.iter().enumerate() {
                place[*unknown] = i;
            }
            let recipe = &mut recipes[index];
            for (j, column) in recipe.unknowns.iter().enumerate() {
                let mut last: Option<Run> = None;
                for entry in pattern.columns[*column]..pattern.columns[*column + 1] {
                    let row = pattern.rows[entry];
                    // an entry belongs to the front that first eliminates its row or its column
                    if owner[row].min(owner[*column]) != index {
                        continue;
                    }
                    let i = place[row];
                    match &mut last {
                        Some(run)
                            if run.entry + run.length == entry
                                && run.row + run.length == i
                                && i != recipe.pivots =>
                        {
                            run.length += 1;
                        }
                        _ => {
                            recipe.runs.extend(last.take());
                            last = Some(Run {
                                entry,
                                length: 1,
                                row: i,
                                column: j,
                            });
                        }
                    }
                }
                recipe.runs.extend(last);
            }
            let children = plan.fronts()[..index]
                .iter()
                .enumerate()
                .filter(|(_, front)| front.parent == Some(index))
                .map(|(child, front)| {
                    let places = front.border.iter().map(|unknown| place[*unknown]);
                    (child, places.collect())
                })
                .collect();
            recipes[index].children = children;
        }
        BlockLu {
            pattern: pattern.clone(),
            fronts: vec![Front::default(); recipes.len()],
            recipes,
            work: Work::default(),
            places: Vec::new(),
            local: vec![0.0; largest],
            solution: vec![0.0; n],
            probe: Probe::new(pattern),
            general: None,
            state: State::Empty,
            fallbacks: 0,
        }
    }

    /// Makes the fronts; `false` if a root has no pivots.
    fn eliminate(&mut self, values: &[f64]) -> bool {
        for (index, recipe) in self.recipes.iter().enumerate() {
            let (done, rest) = self.fronts.split_at_mut(index);
            let Some(front) = rest.first_mut() else {
                return false;
            };
            // own unknowns, unknowns that children could not eliminate, border
            front.rows.clear();
            front.columns.clear();
            let (own, border) = recipe.unknowns.split_at(recipe.pivots);
            front.rows.extend_from_slice(own);
            front.columns.extend_from_slice(own);
            for (child, _) in &recipe.children {
                let child = &done[*child];
                let delayed = child.eliminated..child.eliminated + child.delayed();
                front.rows.extend_from_slice(&child.rows[delayed.clone()]);
                front.columns.extend_from_slice(&child.columns[delayed]);
            }
            let candidates = front.rows.len();
            let shift = candidates - recipe.pivots;
            front.rows.extend_from_slice(border);
            front.columns.extend_from_slice(border);
            front.clear(candidates);
            let shifted = |place: usize| {
                if place < recipe.pivots {
                    place
                } else {
                    place + shift
                }
            };
            for run in &recipe.runs {
                let row = shifted(run.row);
                front.column_mut(shifted(run.column))[row..row + run.length]
                    .copy_from_slice(&values[run.entry..run.entry + run.length]);
            }
            let mut before = recipe.pivots;
            for (child, planned) in &recipe.children {
                let child = &done[*child];
                self.places.clear();
                self.places.extend(before..before + child.delayed());
                before += child.delayed();
                self.places.extend(planned.iter().map(|p| shifted(*p)));
                front.add(child, &self.places);
            }
            front.eliminate(&mut self.work);
            if recipe.root && front.delayed() > 0 {
                return false;
            }
        }
        true
    }

    fn solve_by_blocks(
        fronts: &[Front],
        rhs: &mut [f64],
        solution: &mut [f64],
        local: &mut Vec<f64>,
    ) {
        let largest = fronts.iter().map(Front::size).max().unwrap_or(0);
        if local.len() < largest {
            local.resize(largest, 0.0);
        }
        for front in fronts {
            front.forward(rhs, local);
        }
        for front in fronts.iter().rev() {
            front.backward(rhs, solution, local);
        }
        rhs.copy_from_slice(solution);
    }

    /// The general factorisation of values that blocks could not factor.
    fn fall_back(&mut self, values: &[f64]) -> Result<(), LinearError> {
        self.fallbacks += 1;
        if self.general.is_none() {
            self.general = Some(SparseLu::new(&self.pattern)?);
        }
        if let Some(general) = &mut self.general {
            general.factor(values)?;
            self.state = State::General;
        }
        Ok(())
    }
}

impl LinearSolver for BlockLu {
    fn factor(&mut self, values: &[f64]) -> Result<(), LinearError> {
        self.state = State::Empty;
        if values.len() != self.pattern.rows.len() || values.iter().any(|v| !v.is_finite()) {
            return Err(LinearError::Singular);
        }
        if self.eliminate(values) {
            let rhs = self.probe.begin(values);
            Self::solve_by_blocks(&self.fronts, rhs, &mut self.solution, &mut self.local);
            if self.probe.passes(values) {
                self.state = State::Blocks;
                return Ok(());
            }
        }
        self.fall_back(values)
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        match (self.state, &mut self.general) {
            (State::Blocks, _) => {
                Self::solve_by_blocks(&self.fronts, rhs, &mut self.solution, &mut self.local);
            }
            (State::General, Some(general)) => general.solve(rhs),
            _ => rhs.fill(f64::NAN),
        }
    }

    fn fallbacks(&self) -> u64 {
        self.fallbacks
    }
}
