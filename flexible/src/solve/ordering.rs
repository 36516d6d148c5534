//! Orders of elimination that keep the triangular factor sparse.

use super::dissection::dissect;
use super::elimination::eliminate;
use super::graph::{Compressed, Graph};
use crate::error::FlexibleError;
use crate::sparse::SymmetricMatrix;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

/// The method that found an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Approximate minimum degree (Amestoy, Davis, Duff 1996).
    MinimumDegree,
    /// Multilevel nested dissection, its leaves by minimum degree.
    NestedDissection,
}

/// An order of elimination of a matrix's rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Ordering {
    forward: Vec<u32>,
    inverse: Vec<u32>,
    entries: f64,
    operations: f64,
    method: Method,
}

/// Nested dissection is tried if a factorisation in the order of minimum degree takes more multiplications
/// per vertex than this. Below it, the search for a better order takes longer than two factorisations would
/// gain.
const WORTH_DISSECTION: f64 = 5e5;

impl Ordering {
    /// The order of minimum degree, or for large problems nested dissection if it takes fewer operations.
    /// Rows with the same pattern (the freedoms of one node) stay together.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn fill_reducing(matrix: &SymmetricMatrix) -> Result<Ordering, FlexibleError> {
        let compressed = Compressed::new(matrix);
        let degree = Ordering::by(&compressed, Method::MinimumDegree)?;
        if degree.operations <= WORTH_DISSECTION * compressed.graph.vertices() as f64 {
            return Ok(degree);
        }
        let nested = Ordering::by(&compressed, Method::NestedDissection)?;
        Ok(if nested.operations < degree.operations {
            nested
        } else {
            degree
        })
    }

    /// The order by a given method.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn with_method(
        matrix: &SymmetricMatrix,
        method: Method,
    ) -> Result<Ordering, FlexibleError> {
        Ordering::by(&Compressed::new(matrix), method)
    }

    fn by(compressed: &Compressed, method: Method) -> Result<Ordering, FlexibleError> {
        let graph = &compressed.graph;
        let order = match method {
            Method::MinimumDegree => minimum_degree_of(graph)?,
            Method::NestedDissection => dissect(graph)?,
        };
        let tree = eliminate(graph, &order);
        let forward = compressed.expand(&tree.order);
        let mut inverse = vec![0u32; forward.len()];
        for (index, &row) in forward.iter().enumerate() {
            inverse[row as usize] = index as u32;
        }
        Ok(Ordering {
            forward,
            inverse,
            entries: tree.entries,
            operations: tree.operations,
            method,
        })
    }

    /// The rows in the order of their elimination.
    pub fn forward(&self) -> &[u32] {
        &self.forward
    }

    /// The position of each row in the order of elimination.
    pub fn inverse(&self) -> &[u32] {
        &self.inverse
    }

    /// Number of entries of the triangular factor, with the diagonal. It is an f64, because it easily exceeds
    /// 2³².
    pub fn entries(&self) -> f64 {
        self.entries
    }

    /// Sum of the squares of the factor's column lengths: multiplications of a factorisation.
    pub fn operations(&self) -> f64 {
        self.operations
    }

    /// The method that found it.
    pub fn method(&self) -> Method {
        self.method
    }
}

/// The order of minimum degree on a graph, in which every vertex counts as one row.
///
/// # Errors
/// When memory runs out.
pub(crate) fn minimum_degree_of(graph: &Graph) -> Result<Vec<u32>, FlexibleError> {
    let count = graph.vertices();
    let (mut start, mut row) = (Vec::with_capacity(count + 1), Vec::new());
    start.push(0u32);
    for vertex in 0..count as u32 {
        row.extend(
            graph
                .neighbours(vertex as usize)
                .iter()
                .filter(|&&other| other < vertex),
        );
        start.push(u32::try_from(row.len()).map_err(|_| too_large())?);
    }
    let pattern =
        SymbolicSparseColMatRef::<'_, u32>::new_unsorted_checked(count, count, &start, None, &row);
    let mut memory = MemBuffer::try_new(amd::order_maybe_unsorted_scratch::<u32>(count, row.len()))
        .map_err(|_| out_of_memory())?;
    let (mut order, mut inverse) = (vec![0u32; count], vec![0u32; count]);
    amd::order_maybe_unsorted(
        &mut order,
        &mut inverse,
        pattern,
        amd::Control::default(),
        MemStack::new(&mut memory),
    )
    .map_err(|_| too_large())?;
    Ok(order)
}

pub(crate) fn out_of_memory() -> FlexibleError {
    FlexibleError::Numerical {
        problem: "not enough memory for the factor of a sparse matrix".into(),
        advice: "take a coarser mesh, which needs less".into(),
    }
}

pub(crate) fn too_large() -> FlexibleError {
    FlexibleError::Numerical {
        problem: "a sparse matrix has too many entries for 32-bit indices".into(),
        advice: "take a coarser mesh, which has fewer".into(),
    }
}
