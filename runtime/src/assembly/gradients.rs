//! Derivatives of rows by velocities, without their zeros: few bodies of a mechanism touch the same row.

use nalgebra::{DMatrix, DVector};

/// Rows of a matrix. Each has its entries in the order of their columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gradients {
    columns: usize,
    rows: Vec<Vec<(usize, f64)>>,
}

impl Gradients {
    /// Rows without entries.
    pub fn new(rows: usize, columns: usize) -> Gradients {
        Gradients {
            columns,
            rows: vec![Vec::new(); rows],
        }
    }

    /// The entries of a matrix that are not zero.
    pub fn of(matrix: &DMatrix<f64>) -> Gradients {
        let mut gradients = Gradients::new(matrix.nrows(), matrix.ncols());
        for (j, column) in matrix.column_iter().enumerate() {
            for (i, x) in column.iter().enumerate().filter(|(_, x)| **x != 0.0) {
                gradients.rows[i].push((j, *x));
            }
        }
        gradients
    }

    /// Number of rows.
    pub fn nrows(&self) -> usize {
        self.rows.len()
    }

    /// Number of columns.
    pub fn ncols(&self) -> usize {
        self.columns
    }

    /// The entries of each row.
    pub fn rows(&self) -> &[Vec<(usize, f64)>] {
        &self.rows
    }

    /// Adds to successive entries of a row from a column on.
    pub fn add(&mut self, row: usize, first: usize, numbers: &[f64]) {
        let entries = &mut self.rows[row];
        for (i, x) in numbers.iter().enumerate() {
            let column = first + i;
            match entries.binary_search_by_key(&column, |(j, _)| *j) {
                Ok(at) => entries[at].1 += x,
                Err(_) if *x == 0.0 => {}
                Err(at) => entries.insert(at, (column, *x)),
            }
        }
    }

    /// The same numbers with zeros.
    pub fn dense(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.rows.len(), self.columns);
        for (i, row) in self.rows.iter().enumerate() {
            for (j, x) in row {
                matrix[(i, *j)] = *x;
            }
        }
        matrix
    }

    /// Some rows.
    pub fn select(&self, rows: &[usize]) -> Gradients {
        Gradients {
            columns: self.columns,
            rows: rows.iter().map(|i| self.rows[*i].clone()).collect(),
        }
    }

    /// Multiplies each entry by a function of its row and column.
    pub fn scale(&mut self, factor: impl Fn(usize, usize) -> f64) {
        for (i, row) in self.rows.iter_mut().enumerate() {
            for (j, x) in row {
                *x *= factor(i, *j);
            }
        }
    }

    /// Some columns in their order, each times a factor.
    pub fn columns(&self, chosen: &[usize], factor: impl Fn(usize) -> f64) -> Gradients {
        let mut places = vec![None; self.columns];
        for (to, from) in chosen.iter().enumerate() {
            places[*from] = Some(to);
        }
        let row = |row: &Vec<(usize, f64)>| {
            let kept = row
                .iter()
                .filter_map(|(j, x)| Some((places[*j]?, x * factor(*j))));
            kept.collect()
        };
        Gradients {
            columns: chosen.len(),
            rows: self.rows.iter().map(row).collect(),
        }
    }

    /// These rows and those of another matrix below them.
    pub fn above(mut self, other: Gradients) -> Gradients {
        self.rows.extend(other.rows);
        self
    }

    /// The Euclidean length of each row.
    pub fn sizes(&self) -> DVector<f64> {
        let size = |row: &Vec<(usize, f64)>| libm::sqrt(row.iter().map(|(_, x)| x * x).sum());
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(size))
    }

    /// The rows divided by their lengths, and the lengths. A row of zeros keeps them, divided by 1.
    pub fn unit_rows(mut self) -> (Gradients, DVector<f64>) {
        let sizes = self.sizes().map(|size| if size > 0.0 { size } else { 1.0 });
        self.scale(|i, _| 1.0 / sizes[i]);
        (self, sizes)
    }

    /// Whether all entries are finite.
    pub fn is_finite(&self) -> bool {
        self.rows.iter().flatten().all(|(_, x)| x.is_finite())
    }

    /// `A x`.
    pub fn times(&self, x: &DVector<f64>) -> DVector<f64> {
        let row = |row: &Vec<(usize, f64)>| row.iter().map(|(j, a)| a * x[*j]).sum();
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(row))
    }

    /// `x += Aᵀ y`.
    pub fn add_transposed(&self, y: &DVector<f64>, x: &mut DVector<f64>) {
        for (row, y) in self.rows.iter().zip(y.iter()) {
            for (j, a) in row {
                x[*j] += a * y;
            }
        }
    }
}
