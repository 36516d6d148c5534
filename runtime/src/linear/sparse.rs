//! The general factorisation.

use super::probe::Probe;
use super::{LinearError, LinearSolver, Pattern};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};

/// Sparse LU of faer: columns ordered once (COLAMD), rows pivoted at each factorisation.
///
/// Work space is kept. faer's numeric storage is kept as well: it grows with the first factorisations and is
/// then reused.
pub struct SparseLu {
    size: usize,
    entries: usize,
    structure: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
    probe: Probe,
    factored: bool,
}

impl std::fmt::Debug for SparseLu {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "SparseLu({} rows, {} entries)", self.size, self.entries)
    }
}

impl SparseLu {
    /// Analyses a pattern.
    pub fn new(pattern: &Pattern) -> Result<SparseLu, LinearError> {
        let n = pattern.size();
        let structure = SymbolicSparseColMat::new_checked(
            n,
            n,
            pattern.columns.clone(),
            None,
            pattern.rows.clone(),
        );
        let symbolic = factorize_symbolic_lu(structure.as_ref(), LuSymbolicParams::default())
            .map_err(|_| LinearError::TooLarge)?;
        let need = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, faer::Spec::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(need).map_err(|_| LinearError::TooLarge)?;
        Ok(SparseLu {
            size: n,
            entries: pattern.rows.len(),
            structure,
            symbolic,
            numeric: NumericLu::new(),
            memory,
            probe: Probe::new(pattern),
            factored: false,
        })
    }
}

impl SparseLu {
    fn solve_factored(&mut self, rhs: &mut [f64]) {
        let size = rhs.len();
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, size, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

impl LinearSolver for SparseLu {
    fn factor(&mut self, values: &[f64]) -> Result<(), LinearError> {
        self.factored = false;
        if self.size == 0 {
            self.factored = true;
            return Ok(());
        }
        if values.iter().any(|v| !v.is_finite()) {
            return Err(LinearError::Singular);
        }
        let structure: SymbolicSparseColMatRef<'_, usize> = self.structure.as_ref();
        let matrix = SparseColMatRef::new(structure, values);
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                matrix,
                Par::Seq,
                MemStack::new(&mut self.memory),
                faer::Spec::default(),
            )
            .map_err(|_| LinearError::Singular)?;
        let mut probe = std::mem::take(&mut self.probe);
        let solution = probe.begin(values);
        self.solve_factored(solution);
        self.factored = probe.passes(values);
        self.probe = probe;
        if self.factored {
            Ok(())
        } else {
            Err(LinearError::Singular)
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        if self.size == 0 {
            return;
        }
        if self.factored {
            self.solve_factored(rhs);
        } else {
            rhs.fill(f64::NAN);
        }
    }
}
