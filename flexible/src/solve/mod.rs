//! Linear solutions and eigenvalues of large sparse symmetric matrices.
