//! Eng: state on the manifold, kinematic chain, solvers, analyses, results
