//! The layout of a factor: panels of columns with the same rows below them, and the branches of the tree of elimination
//! that threads work on.

use super::ordering::{out_of_memory, too_large};
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use std::ops::Range;

/// Most columns of a panel. Wide panels store a triangle of zeros above their diagonal; narrow ones multiply slowly.
const WIDEST: usize = 256;
/// The tree is cut into branches of at most this share of the multiplications, so that two to eight threads finish
/// at about the same time.
const SHARE: f64 = 1.0 / 24.0;
/// With fewer multiplications a factor is ready before a thread has started.
const SMALL: f64 = 2e7;
const NONE: u32 = u32::MAX;

/// The structure of a factor. Rows and columns have their place in the order of elimination.
#[derive(Debug)]
pub(super) struct Panels {
    /// First column of each panel, and the number of columns.
    columns: Vec<u32>,
    /// Rows below the columns of the panels, ascending, one panel after the other.
    rows: Vec<u32>,
    row_start: Vec<usize>,
    /// First value of each panel, and the number of values.
    places: Vec<usize>,
    /// Earlier panels with rows among the columns of each panel, ascending.
    sources: Vec<u32>,
    source_start: Vec<usize>,
    /// Whole branches of the tree, as ranges of panels, ascending. No two of them have a common row below the diagonal,
    /// except among the panels outside of all branches.
    branches: Vec<Range<usize>>,
}

impl Panels {
    /// The structure of the factor of a matrix, whose rows are eliminated in the order `forward`.
    pub(super) fn new(
        matrix: &SymmetricMatrix,
        forward: &[u32],
        inverse: &[u32],
    ) -> Result<Self, FlexibleError> {
        let size = matrix.size();
        let column_start: Vec<u32> = matrix
            .column_start()
            .iter()
            .map(|&start| u32::try_from(start))
            .collect::<Result<_, _>>()
            .map_err(|_| too_large())?;
        let pattern = SymbolicSparseColMatRef::<'_, u32>::new_checked(
            size,
            size,
            &column_start,
            None,
            matrix.rows(),
        );
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..CholeskySymbolicParams::default()
        };
        let order = SymmetricOrdering::Custom(PermRef::new_checked(forward, inverse, size));
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, order, params)
            .map_err(|_| too_large())?;
        let mut panels = Panels {
            columns: Vec::new(),
            rows: Vec::new(),
            row_start: vec![0],
            places: vec![0],
            sources: Vec::new(),
            source_start: Vec::new(),
            branches: Vec::new(),
        };
        if let SymbolicCholeskyRaw::Supernodal(factor) = symbolic.raw() {
            let blocks = factor.supernode_begin().iter().zip(factor.supernode_end());
            let below = factor
                .col_ptr_for_row_idx()
                .iter()
                .zip(factor.nnz_per_super());
            for ((&begin, &end), (&first, &count)) in blocks.zip(below) {
                let first = first as usize;
                panels.cut(begin, end, &factor.row_idx()[first..first + count as usize]);
            }
        }
        drop(symbolic);
        panels.columns.push(size as u32);
        panels.link(size)?;
        panels.branch();
        Ok(panels)
    }

    /// Adds a block of columns with the same rows below it, as panels of about equal width.
    fn cut(&mut self, begin: u32, end: u32, below: &[u32]) {
        let width = (end - begin) as usize;
        let parts = width.div_ceil(WIDEST);
        for part in 0..parts {
            let first = begin + (width * part / parts) as u32;
            let next = begin + (width * (part + 1) / parts) as u32;
            self.columns.push(first);
            self.rows.extend(next..end);
            self.rows.extend(below);
            let rows = self.rows.len() - self.row_start.last().copied().unwrap_or(0);
            let own = (next - first) as usize;
            let place = self.places.last().copied().unwrap_or(0);
            self.places.push(place + own * (own + rows));
            self.row_start.push(self.rows.len());
        }
    }

    /// Lists the sources of each panel.
    fn link(&mut self, size: usize) -> Result<(), FlexibleError> {
        let count = self.count();
        let owner = self.owners(size);
        // twice the same walk: it counts, and then it lists
        let mut starts = vec![0usize; count + 2];
        self.walk(&owner, |_, target| {
            if let Some(start) = starts.get_mut(target + 2) {
                *start += 1;
            }
        });
        for index in 1..starts.len() {
            starts[index] += starts[index - 1];
        }
        let total = starts.last().copied().unwrap_or(0);
        let mut sources = Vec::new();
        sources
            .try_reserve_exact(total)
            .map_err(|_| out_of_memory())?;
        sources.resize(total, 0);
        self.walk(&owner, |source, target| {
            let place = starts[target + 1];
            sources[place] = source as u32;
            starts[target + 1] += 1;
        });
        starts.pop();
        (self.sources, self.source_start) = (sources, starts);
        Ok(())
    }

    /// The panel of each column.
    fn owners(&self, size: usize) -> Vec<u32> {
        let mut owner = vec![NONE; size];
        for panel in 0..self.count() {
            owner[self.columns(panel)].fill(panel as u32);
        }
        owner
    }

    /// Visits each pair of a panel and a later panel with a row of it among its columns.
    fn walk(&self, owner: &[u32], mut visit: impl FnMut(usize, usize)) {
        for source in 0..self.count() {
            let mut last = NONE;
            for &row in self.rows(source) {
                let target = owner[row as usize];
                if target != last {
                    visit(source, target as usize);
                    last = target;
                }
            }
        }
    }

    /// Multiplications for the columns of a panel.
    fn work(&self, panel: usize) -> f64 {
        let width = self.columns(panel).len() as f64;
        let middle = self.height(panel) as f64 - 0.5 * width;
        width * middle * middle
    }

    /// Chooses the branches: the largest ones are cut at their roots until none has more than its share.
    fn branch(&mut self) {
        let count = self.count();
        let size = self.columns.last().copied().unwrap_or(0) as usize;
        let owner = self.owners(size);
        let mut parent = vec![count; count];
        let mut first: Vec<usize> = (0..count).collect();
        let mut members = vec![1usize; count];
        let mut work: Vec<f64> = (0..count).map(|panel| self.work(panel)).collect();
        let mut total = 0.0;
        let mut roots = Vec::new();
        for panel in 0..count {
            match self.rows(panel).first() {
                Some(&row) => {
                    let above = owner[row as usize] as usize;
                    parent[panel] = above;
                    first[above] = first[above].min(first[panel]);
                    members[above] += members[panel];
                    work[above] += work[panel];
                }
                None => {
                    total += work[panel];
                    roots.push(panel);
                }
            }
        }
        // the order is a postorder, in which branches are contiguous; else one thread does all
        let contiguous = (0..count).all(|panel| panel + 1 - first[panel] == members[panel]);
        if total < SMALL || !contiguous {
            self.branches = Vec::from_iter((count > 0).then_some(0..count));
            return;
        }
        let mut children = vec![Vec::new(); count];
        for (panel, &above) in parent.iter().enumerate() {
            if let Some(children) = children.get_mut(above) {
                children.push(panel);
            }
        }
        while let Some(root) = roots.pop() {
            if work[root] > SHARE * total {
                roots.append(&mut children[root]);
            } else {
                self.branches.push(first[root]..root + 1);
            }
        }
        self.branches.sort_unstable_by_key(|branch| branch.start);
        self.join_small(&work, SHARE * total);
    }

    /// Neighbouring branches with little work become one, so that a thread gets a worthwhile part.
    fn join_small(&mut self, work: &[f64], most: f64) {
        let of = |branch: &Range<usize>| work.get(branch.end - 1).copied().unwrap_or(0.0);
        let mut joined: Vec<(Range<usize>, f64)> = Vec::new();
        for branch in std::mem::take(&mut self.branches) {
            let own = of(&branch);
            match joined.last_mut() {
                Some((last, sum)) if last.end == branch.start && *sum + own <= most => {
                    last.end = branch.end;
                    *sum += own;
                }
                _ => joined.push((branch, own)),
            }
        }
        self.branches = joined.into_iter().map(|(branch, _)| branch).collect();
    }

    /// Number of panels.
    pub(super) fn count(&self) -> usize {
        self.places.len() - 1
    }

    /// Number of values.
    pub(super) fn stored(&self) -> usize {
        self.places.last().copied().unwrap_or(0)
    }

    /// The columns of a panel.
    pub(super) fn columns(&self, panel: usize) -> Range<usize> {
        self.columns[panel] as usize..self.columns[panel + 1] as usize
    }

    /// The rows of a panel below its columns, ascending.
    pub(super) fn rows(&self, panel: usize) -> &[u32] {
        &self.rows[self.row_start[panel]..self.row_start[panel + 1]]
    }

    /// Number of all rows of a panel: its columns, then the rows below.
    pub(super) fn height(&self, panel: usize) -> usize {
        self.columns(panel).len() + self.rows(panel).len()
    }

    /// The places of the values of a panel, by columns.
    pub(super) fn place(&self, panel: usize) -> Range<usize> {
        self.places[panel]..self.places[panel + 1]
    }

    /// Earlier panels with rows among the columns of a panel, ascending.
    pub(super) fn sources(&self, panel: usize) -> &[u32] {
        &self.sources[self.source_start[panel]..self.source_start[panel + 1]]
    }

    /// The branches, ascending.
    pub(super) fn branches(&self) -> &[Range<usize>] {
        &self.branches
    }

    /// The panels outside of all branches, ascending.
    pub(super) fn top(&self) -> Vec<usize> {
        let mut top = Vec::new();
        let mut next = 0;
        for branch in &self.branches {
            top.extend(next..branch.start);
            next = branch.end;
        }
        top.extend(next..self.count());
        top
    }

    /// Rows outside of a branch that its panels have, ascending.
    pub(super) fn above(&self, branch: &Range<usize>) -> Vec<u32> {
        let end = self.columns[branch.end];
        let mut above: Vec<u32> = Vec::new();
        // the last panel of a tree has all rows of its panels beyond it
        let roots = branch.clone().filter(|&panel| {
            let first = self.rows(panel).first();
            first.is_some_and(|&row| row >= end)
        });
        for panel in roots {
            above.extend(self.rows(panel));
        }
        above.sort_unstable();
        above.dedup();
        above
    }

    /// Writes the entries of a matrix to their places. All other values become zero.
    pub(super) fn scatter(&self, matrix: &SymmetricMatrix, inverse: &[u32], values: &mut [f64]) {
        values.fill(0.0);
        let owner = self.owners(matrix.size());
        // the freedoms of a node are neighbours in both orders, so most rows follow the one before
        let mut hint = 0usize;
        for column in 0..matrix.size() {
            let (rows, entries) = matrix.column(column);
            for (&row, &entry) in rows.iter().zip(entries) {
                let (one, two) = (inverse[column], inverse[row as usize]);
                let (low, high) = (one.min(two), one.max(two));
                let panel = owner[low as usize] as usize;
                let columns = self.columns(panel);
                let below = self.rows(panel);
                let local = if (high as usize) < columns.end {
                    high as usize - columns.start
                } else {
                    if below.get(hint) != Some(&high) {
                        hint = below.partition_point(|&row| row < high);
                    }
                    hint += 1;
                    columns.len() + hint - 1
                };
                let height = columns.len() + below.len();
                let place = self.places[panel] + (low as usize - columns.start) * height + local;
                values[place] += entry;
            }
        }
    }
}
