//! From full freedoms to free ones: full = T · free, with ties and supports eliminated.

use super::assemble::Assembled;
use super::check::list;
use super::freedoms::{FreedomMap, direction};
use super::mass::Mass;
use super::ties::{Constraints, Sum};
use crate::error::FlexibleError;
use crate::mesh::{Mesh, Support};
use crate::sparse::SymmetricMatrix;

/// The name of a freedom in messages.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FreedomName {
    /// Number of the node, and component 0…5.
    Node(u64, u8),
    /// Number of the scalar point.
    Scalar(u64),
}

impl std::fmt::Display for FreedomName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FreedomName::Node(id, component) => {
                write!(f, "component {} of node {id}", component + 1)
            }
            FreedomName::Scalar(id) => write!(f, "scalar point {id}"),
        }
    }
}

/// The transformation T, by rows.
///
/// Free freedoms are the independent ones in the order of the full ones. At nodes with an analysis frame that
/// a tie or a support names they are in that frame's axes; everywhere else in basic ones. Full vectors always
/// are in basic axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduction {
    /// Index of the full freedom of each free one.
    free: Vec<u32>,
    /// Name of each free freedom, for messages, and its kind: 0 translation, 1 rotation, 2 scalar point;
    /// `None` for inner ones.
    names: Vec<Option<(FreedomName, usize)>>,
    /// Free freedoms in the axes of an analysis frame: the first of the three full ones of their kind there,
    /// and the axis.
    turned: std::collections::BTreeMap<u32, (u32, [f64; 3])>,
    /// Terms of each full freedom.
    start: Vec<usize>,
    column: Vec<u32>,
    coefficient: Vec<f64>,
}

impl Reduction {
    /// Eliminates the ties of the mesh that `structure` was assembled from, with `held` freedoms at zero (the
    /// file's own supports, [`Mesh::supports`], are held only where they are among them).
    ///
    /// # Errors
    /// As [`Constraints::new`].
    pub fn new(
        mesh: &Mesh,
        structure: &Assembled,
        held: &[Support],
    ) -> Result<Self, FlexibleError> {
        let freedoms = &structure.freedoms;
        Self::of_freedoms(mesh, freedoms, held)
    }

    /// As [`Reduction::new`], for freedoms whose matrices come from elsewhere.
    ///
    /// # Errors
    /// As [`Constraints::new`], and freedoms of another mesh.
    pub fn of_freedoms(
        mesh: &Mesh,
        freedoms: &FreedomMap,
        held: &[Support],
    ) -> Result<Self, FlexibleError> {
        if freedoms.node_count() != mesh.nodes.len() {
            return Err(FlexibleError::structure(
                "the freedoms are those of another mesh".into(),
                "take the freedoms of this mesh",
            ));
        }
        let constraints = Constraints::new(mesh, freedoms, held)?;
        let mut index = vec![None; freedoms.size()];
        let (mut free, mut names) = (Vec::new(), Vec::new());
        let mut turned = std::collections::BTreeMap::new();
        for (node, place) in mesh.nodes.iter().enumerate() {
            for (component, freedom) in freedoms.of(node as u32).enumerate() {
                if !constraints.dependent.contains_key(&(freedom as u32)) {
                    index[freedom] = Some(free.len() as u32);
                    if constraints.turned[node] {
                        let first = freedom - component % 3;
                        let axis = direction(mesh, node as u32, component as u8);
                        turned.insert(free.len() as u32, (first as u32, axis));
                    }
                    free.push(freedom as u32);
                    let name = FreedomName::Node(place.id, component as u8);
                    names.push(Some((name, component / 3)));
                }
            }
        }
        // inner freedoms are free
        for freedom in freedoms.inner_freedoms() {
            index[freedom] = Some(free.len() as u32);
            free.push(freedom as u32);
            names.push(None);
        }
        for (freedom, id) in freedoms.scalar_freedoms().zip(&mesh.scalar_points) {
            if !constraints.dependent.contains_key(&(freedom as u32)) {
                index[freedom] = Some(free.len() as u32);
                free.push(freedom as u32);
                names.push(Some((FreedomName::Scalar(*id), 2)));
            }
        }
        let local = |freedom: usize| -> Sum {
            match (index[freedom], constraints.dependent.get(&(freedom as u32))) {
                (Some(free), _) => vec![(free, 1.0)],
                (None, Some(sum)) => sum
                    .iter()
                    .filter_map(|&(f, x)| index[f as usize].map(|free| (free, x)))
                    .collect(),
                (None, None) => Sum::new(),
            }
        };
        let (mut start, mut column, mut coefficient) = (vec![0], Vec::new(), Vec::new());
        for node in 0..mesh.nodes.len() as u32 {
            let range = freedoms.of(node);
            for freedom in range.clone() {
                if !constraints.turned[node as usize] {
                    for (free, x) in local(freedom) {
                        column.push(free);
                        coefficient.push(x);
                    }
                } else {
                    let component = freedom - range.start;
                    let first = component / 3 * 3;
                    let mut sum: std::collections::BTreeMap<u32, f64> = Default::default();
                    for k in first..first + 3 {
                        let axis = direction(mesh, node, k as u8)[component % 3];
                        for (free, x) in local(range.start + k) {
                            *sum.entry(free).or_insert(0.0) += axis * x;
                        }
                    }
                    for (free, x) in sum {
                        if x != 0.0 {
                            column.push(free);
                            coefficient.push(x);
                        }
                    }
                }
                start.push(column.len());
            }
        }
        for freedom in freedoms.inner_freedoms().chain(freedoms.scalar_freedoms()) {
            for (free, x) in local(freedom) {
                column.push(free);
                coefficient.push(x);
            }
            start.push(column.len());
        }
        Ok(Reduction {
            free,
            names,
            turned,
            start,
            column,
            coefficient,
        })
    }

    /// Number of free freedoms.
    pub fn size(&self) -> usize {
        self.free.len()
    }

    /// Number of full freedoms.
    pub fn full_size(&self) -> usize {
        self.start.len() - 1
    }

    /// Index of the full freedom of each free one (in the axes of [`Reduction`]).
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// Name of a free freedom, for messages; `None` for an inner one.
    pub fn name(&self, free: usize) -> Option<String> {
        let (name, _) = self.names.get(free).copied().flatten()?;
        Some(name.to_string())
    }

    /// A full freedom as a sum over free ones: their indices and coefficients. Empty where held, or unknown.
    pub fn row(&self, freedom: usize) -> (&[u32], &[f64]) {
        match (self.start.get(freedom), self.start.get(freedom + 1)) {
            (Some(&first), Some(&end)) => (&self.column[first..end], &self.coefficient[first..end]),
            _ => (&[], &[]),
        }
    }

    /// The free freedom that equals a full one; `None` for a held one and for a sum.
    fn plain(&self, freedom: usize) -> Option<u32> {
        match self.row(freedom) {
            (&[free], &[1.0]) if self.free[free as usize] as usize == freedom => Some(free),
            _ => None,
        }
    }

    /// Full vectors from free ones, T x: `columns` vectors one after the other.
    pub fn expand(&self, columns: usize, free: &[f64]) -> Vec<f64> {
        let mut full = vec![0.0; columns * self.full_size()];
        if self.size() == 0 || full.is_empty() {
            return full;
        }
        for (x, y) in free
            .chunks_exact(self.size())
            .zip(full.chunks_exact_mut(self.full_size()))
        {
            for (freedom, y) in y.iter_mut().enumerate() {
                let (columns, coefficients) = self.row(freedom);
                *y = columns
                    .iter()
                    .zip(coefficients)
                    .map(|(column, c)| c * x[*column as usize])
                    .sum();
            }
        }
        full
    }

    /// The free freedoms of full vectors that satisfy the ties, one vector after the other.
    pub fn restrict(&self, full: &[f64]) -> Vec<f64> {
        let mut free = Vec::with_capacity(full.len() / self.full_size().max(1) * self.size());
        for vector in full.chunks_exact(self.full_size().max(1)) {
            let at = |freedom: usize| vector.get(freedom).copied().unwrap_or(0.0);
            free.extend(self.free.iter().enumerate().map(|(index, freedom)| {
                match self.turned.get(&(index as u32)) {
                    Some((first, axis)) => (0..3).map(|k| axis[k] * at(*first as usize + k)).sum(),
                    None => at(*freedom as usize),
                }
            }));
        }
        free
    }

    /// Forces on free freedoms from forces on full ones, Tᵀ f: `columns` vectors one after the other.
    pub fn gather(&self, columns: usize, full: &[f64]) -> Vec<f64> {
        let mut free = vec![0.0; columns * self.size()];
        if free.is_empty() {
            return free;
        }
        for (f, g) in full
            .chunks_exact(self.full_size())
            .zip(free.chunks_exact_mut(self.size()))
        {
            for (freedom, force) in f.iter().enumerate() {
                let (columns, coefficients) = self.row(freedom);
                for (column, c) in columns.iter().zip(coefficients) {
                    g[*column as usize] += c * force;
                }
            }
        }
        free
    }

    /// Tᵀ A T of a matrix over full freedoms.
    ///
    /// Full freedoms are plain ones p, which are free as they are, and others d = G f, with the n free
    /// freedoms f. The result is A_pp + H G + Gᵀ Hᵀ with H = A_pd + ½ Gᵀ A_dd (n × d). A_pp and A_pd have
    /// rows of zeros for free freedoms that are not plain. So only the result and the two thin matrices G and
    /// H are held.
    ///
    /// # Errors
    /// When the matrix has another size.
    pub fn reduce(&self, matrix: &SymmetricMatrix) -> Result<SymmetricMatrix, FlexibleError> {
        if matrix.size() != self.full_size() {
            return Err(FlexibleError::Matrix {
                problem: format!(
                    "a matrix of {} rows does not fit {} freedoms",
                    matrix.size(),
                    self.full_size()
                ),
                advice: String::new(),
            });
        }
        let plain: Vec<Option<u32>> = (0..self.full_size()).map(|f| self.plain(f)).collect();
        if self.size() == self.full_size() && plain.iter().all(Option::is_some) {
            return Ok(matrix.clone());
        }
        let others: Vec<usize> = (0..plain.len()).filter(|f| plain[*f].is_none()).collect();
        let mut place = vec![u32::MAX; plain.len()];
        for (index, freedom) in others.iter().enumerate() {
            place[*freedom] = index as u32;
        }
        let thin = self.coupling(matrix, &plain, &others, &place);
        let lead = Transposed::new(
            self.size(),
            others.iter().map(|freedom| {
                let (columns, coefficients) = self.row(*freedom);
                columns.iter().copied().zip(coefficients.iter().copied())
            }),
        );
        let back = Transposed::new(self.size(), thin.iter().map(|sum| sum.iter().copied()));
        let mut column_start = Vec::with_capacity(self.size() + 1);
        column_start.push(0usize);
        let entries = matrix.rows().len();
        let (mut row, mut value) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
        let mut sums = vec![0.0; self.size()];
        let mut seen = vec![u32::MAX; self.size()];
        let mut touched: Vec<u32> = Vec::new();
        for (column, &freedom) in self.free.iter().enumerate() {
            let column = column as u32;
            let tied = lead.of(column).next().is_some() || back.of(column).next().is_some();
            if let (false, Some(own)) = (tied, plain[freedom as usize])
                && own == column
            {
                // far from ties the columns are those of the matrix, in the same order
                let (rows, values) = matrix.column(freedom as usize);
                if rows.first() != Some(&freedom) {
                    row.push(column);
                    value.push(0.0);
                }
                for (r, x) in rows.iter().zip(values) {
                    if let Some(r) = plain[*r as usize] {
                        row.push(r);
                        value.push(*x);
                    }
                }
                column_start.push(row.len());
                continue;
            }
            let mut add = |r: u32, x: f64| {
                if r < column {
                    return;
                }
                let at = r as usize;
                if seen[at] != column {
                    seen[at] = column;
                    sums[at] = 0.0;
                    touched.push(r);
                }
                sums[at] += x;
            };
            if plain[freedom as usize] == Some(column) {
                let (rows, values) = matrix.column(freedom as usize);
                for (r, x) in rows.iter().zip(values) {
                    if let Some(r) = plain[*r as usize] {
                        add(r, *x);
                    }
                }
            }
            for (other, g) in lead.of(column) {
                for &(r, h) in &thin[other as usize] {
                    add(r, g * h);
                }
            }
            for (other, h) in back.of(column) {
                let (columns, coefficients) = self.row(others[other as usize]);
                for (r, g) in columns.iter().zip(coefficients) {
                    add(*r, g * h);
                }
            }
            // the diagonal is always stored, because the factorisation expects it
            add(column, 0.0);
            touched.sort_unstable();
            for r in touched.drain(..) {
                row.push(r);
                value.push(sums[r as usize]);
            }
            column_start.push(row.len());
        }
        SymmetricMatrix::from_parts(self.size(), column_start, row, value)
    }

    /// H of [`Reduction::reduce`], a sum over free freedoms for each freedom that isn't plain.
    fn coupling(
        &self,
        matrix: &SymmetricMatrix,
        plain: &[Option<u32>],
        others: &[usize],
        place: &[u32],
    ) -> Vec<Sum> {
        let mut thin: Vec<Sum> = vec![Sum::new(); others.len()];
        let half = |to: &mut Sum, freedom: usize, x: f64| {
            let (columns, coefficients) = self.row(freedom);
            let terms = columns.iter().zip(coefficients);
            to.extend(terms.map(|(column, c)| (*column, 0.5 * x * c)));
        };
        for i in 0..plain.len() {
            let (rows, values) = matrix.column(i);
            for (&j, &x) in rows.iter().zip(values) {
                let j = j as usize;
                if x == 0.0 {
                    continue;
                }
                match (plain[i], plain[j]) {
                    (Some(_), Some(_)) => {}
                    (Some(free), None) => thin[place[j] as usize].push((free, x)),
                    (None, Some(free)) => thin[place[i] as usize].push((free, x)),
                    (None, None) => {
                        half(&mut thin[place[i] as usize], j, x);
                        if i != j {
                            half(&mut thin[place[j] as usize], i, x);
                        }
                    }
                }
            }
        }
        for sum in &mut thin {
            // stable: equal freedoms are added in the order of the matrix
            sum.sort_by_key(|(freedom, _)| *freedom);
            let mut merged: Sum = Sum::with_capacity(sum.len());
            for &(freedom, x) in sum.iter() {
                match merged.last_mut() {
                    Some((last, y)) if *last == freedom => *y += x,
                    _ => merged.push((freedom, x)),
                }
            }
            *sum = merged;
        }
        thin
    }

    /// Stiffness over free freedoms, Tᵀ K T.
    ///
    /// # Errors
    /// Freedoms without any stiffness, by node and component; a matrix of another size.
    pub fn reduce_stiffness(
        &self,
        stiffness: &SymmetricMatrix,
    ) -> Result<SymmetricMatrix, FlexibleError> {
        let (reduced, loose) = self.reduce_and_search(stiffness)?;
        if loose.is_empty() {
            return Ok(reduced);
        }
        Err(FlexibleError::structure(
            format!(
                "{} freedoms have no stiffness: {}",
                loose.len(),
                self.listed(&loose)
            ),
            "tie the node to several others, hold the freedom, or give it a spring; solids do not hold rotations, also not those that a mass beside its node or with rotary inertia (CONM2) needs. Nastran's AUTOSPC holds such freedoms: `support = deck` does the same, also at grid points with axes of their own if these get SPC1 cards",
        ))
    }

    /// The names of free freedoms.
    pub(crate) fn listed(&self, columns: &[u32]) -> String {
        let names = columns
            .iter()
            .filter_map(|column| self.names.get(*column as usize).copied().flatten());
        list(
            names
                .map(|(name, _)| name.to_string())
                .collect::<Vec<String>>(),
        )
    }

    /// Supports of free freedoms without stiffness, as Nastran's `AUTOSPC` makes them. At a node with axes of its own, which
    /// a support would refer to, all three translations or rotations must be without stiffness; others have none here.
    pub(crate) fn supports_of(
        &self,
        mesh: &Mesh,
        freedoms: &FreedomMap,
        columns: &[u32],
    ) -> Vec<Support> {
        let mut found: std::collections::BTreeMap<u32, u8> = Default::default();
        for column in columns {
            let full = self.free.get(*column as usize);
            if let Some((node, component)) = full.and_then(|full| freedoms.owner(*full as usize)) {
                *found.entry(node).or_insert(0) |= 1 << component;
            }
        }
        let has_axes = |node: u32| {
            mesh.nodes
                .get(node as usize)
                .is_some_and(|node| node.frame.is_some())
        };
        for (node, components) in &mut found {
            for kind in [0b00_0111, 0b11_1000] {
                if has_axes(*node) && *components & kind != kind {
                    *components &= !kind;
                }
            }
        }
        let supports = found.into_iter().filter(|(_, components)| *components != 0);
        supports
            .map(|(node, components)| Support { node, components })
            .collect()
    }

    /// Stiffness over free freedoms, and those without any stiffness.
    ///
    /// # Errors
    /// A matrix of another size.
    pub(crate) fn reduce_and_search(
        &self,
        stiffness: &SymmetricMatrix,
    ) -> Result<(SymmetricMatrix, Vec<u32>), FlexibleError> {
        let reduced = self.reduce(stiffness)?;
        let diagonal: Vec<f64> = (0..reduced.size())
            .map(|column| match reduced.column(column) {
                (&[row, ..], &[x, ..]) if row as usize == column => x,
                _ => 0.0,
            })
            .collect();
        // translations, rotations and scalar points have different units, so each is compared with its own kind
        let mut largest = [0.0f64; 3];
        let named = || {
            let named = (0..).zip(diagonal.iter().zip(&self.names));
            named.filter_map(|(column, (x, name))| Some((column, *x, (*name)?.1)))
        };
        for (_, x, kind) in named() {
            largest[kind] = largest[kind].max(x);
        }
        // the frame of a reduced body resists nothing: its stiffness is that of amplitudes alone
        if largest[0] == 0.0 && largest[1] == 0.0 && largest[2] > 0.0 {
            return Ok((reduced, Vec::new()));
        }
        // a stiffness this small is what rounding leaves of terms that cancel
        let loose = named().filter(|(_, x, kind)| x.is_nan() || *x <= 1e-14 * largest[*kind]);
        let loose = loose.map(|(column, ..)| column).collect();
        Ok((reduced, loose))
    }

    /// Mass over free freedoms, Tᵀ M T.
    ///
    /// # Errors
    /// A mass of another size.
    pub fn reduce_mass(&self, mass: &Mass) -> Result<SymmetricMatrix, FlexibleError> {
        self.reduce(&mass.assembled()?)
    }
}

/// A thin matrix by the other index.
struct Transposed {
    start: Vec<usize>,
    entry: Vec<(u32, f64)>,
}

impl Transposed {
    fn new<I>(size: usize, lines: impl Iterator<Item = I> + Clone) -> Self
    where
        I: Iterator<Item = (u32, f64)>,
    {
        let mut start = vec![0usize; size + 1];
        for (free, _) in lines.clone().flatten() {
            start[free as usize + 1] += 1;
        }
        for free in 0..size {
            start[free + 1] += start[free];
        }
        let mut next = start.clone();
        let mut entry = vec![(0, 0.0); start[size]];
        for (index, line) in lines.enumerate() {
            for (free, x) in line {
                entry[next[free as usize]] = (index as u32, x);
                next[free as usize] += 1;
            }
        }
        Transposed { start, entry }
    }

    fn of(&self, free: u32) -> impl Iterator<Item = (u32, f64)> {
        let range = self.start[free as usize]..self.start[free as usize + 1];
        self.entry[range].iter().copied()
    }
}
