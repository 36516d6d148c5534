//! Slow motions among fast ones: eigenvalues far below the largest, and true zeros.
//!
//! The computed eigenvalues of `A` have errors of the rounding of the largest one, and double zeros have
//! errors of its root. A slow motion, such as `λ = −k/c` of a spring behind a heavy damper, may lie far below
//! these errors. The matrix
//!
//! ```text
//! (A − σ)⁻¹,   of x, y, z:   [K + σC + σ², −S; R + σT, U − σ] [x; z] = …,   y = σx + …
//! ```
//!
//! has these slow eigenvalues as its largest, `1/(λ − σ)`. K is not lost beside C, because σC is as small as
//! K if σ is as slow as the wanted motion. The shift σ decreases in steps of the root of the rounding error
//! until no eigenvalue is left.
//!
//! **Zeros** are decided by the forces of a motion and not by its rate. The zero of a free motion (a train of discs
//! that turns as a whole) is double, `y = λ x` with one vector for both. A relative perturbation ε of the matrix moves
//! such a λ by the root of ε times the size of the matrix, with any sign, so the sign of a computed λ says nothing about
//! growth there. Its forces are of the order ε, and not of its root: `x*(K x − S z)` of the vector is second order in
//! its error. If they and `R x + U z` are no larger than the rounding of their terms, nothing holds the motion, and its
//! λ is zero. A slow motion that truly grows has such forces: `x*K x = −λ²` far above this rounding, or for a state
//! with the rate λ the term `U z`. The exception is a damped free motion: its second eigenvalue `λ = −c` has an inertia
//! that balances its damping.

use super::eigen::{Eigenpair, spectrum};
use super::energies::parts;
use super::equations::Equations;
use crate::error::RuntimeError;
use nalgebra::{Complex, DMatrix, DVector};

/// Number of shifts. Each is eight decades below the one before, so they lead below [`SLOWEST`] for every
/// machine.
const SHIFTS: usize = 4;
/// Rate (1/s) below which a motion counts as none: it does not change in the age of the universe.
const SLOWEST: f64 = 1e-18;

/// The slowest eigenvalues of a system.
pub(super) struct Slow {
    /// The nonzero ones, with one for each conjugate pair.
    pub pairs: Vec<Eigenpair>,
    /// Count of zeros.
    pub zeros: usize,
}

fn count(pair: &Eigenpair) -> usize {
    if pair.value.im > 0.0 { 2 } else { 1 }
}

/// `(A − σ)⁻¹` of the first-order system; `None` if it does not exist.
fn inverse(equations: &Equations, shift: f64) -> Option<DMatrix<f64>> {
    let (p, s) = (equations.freedoms(), equations.rates_by_states.nrows());
    let e = equations;
    let mut place = DMatrix::zeros(p + s, p + s);
    let own = &e.stiffness + &e.damping * shift + DMatrix::identity(p, p) * (shift * shift);
    place.view_mut((0, 0), (p, p)).copy_from(&own);
    place.view_mut((0, p), (p, s)).copy_from(&-&e.by_states);
    place
        .view_mut((p, 0), (s, p))
        .copy_from(&(&e.rates_by_place + &e.rates_by_velocity * shift));
    place
        .view_mut((p, p), (s, s))
        .copy_from(&(&e.rates_by_states - DMatrix::identity(s, s) * shift));
    // rows are scaled to one size, because K and 1/s of states may differ by many decades
    let mut right = DMatrix::zeros(p + s, 2 * p + s);
    right
        .view_mut((0, 0), (p, p))
        .copy_from(&-(&e.damping + DMatrix::identity(p, p) * shift));
    right
        .view_mut((0, p), (p, p))
        .copy_from(&-DMatrix::identity(p, p));
    right
        .view_mut((p, 0), (s, p))
        .copy_from(&-&e.rates_by_velocity);
    right
        .view_mut((p, 2 * p), (s, s))
        .copy_from(&DMatrix::identity(s, s));
    for i in 0..p + s {
        let size = place.row(i).amax();
        if size > 0.0 && size.is_finite() {
            place.row_mut(i).scale_mut(1.0 / size);
            right.row_mut(i).scale_mut(1.0 / size);
        }
    }
    let solved = place.full_piv_lu().solve(&right)?;
    let mut out = DMatrix::zeros(2 * p + s, 2 * p + s);
    out.view_mut((0, 0), (p, 2 * p + s))
        .copy_from(&solved.rows(0, p));
    out.view_mut((p, 0), (p, 2 * p + s))
        .copy_from(&(solved.rows(0, p) * shift));
    for i in 0..p {
        out[(p + i, i)] += 1.0;
    }
    out.view_mut((2 * p, 0), (s, 2 * p + s))
        .copy_from(&solved.rows(p, s));
    out.iter().all(|x| x.is_finite()).then_some(out)
}

/// The reason for an eigenvalue near zero.
enum Kind {
    /// Springs, films or states hold the motion. The eigenvalue is right as computed.
    Held,
    /// Nothing holds the motion. The eigenvalue is zero.
    Free,
    /// Nothing holds the motion, and its inertia balances only its damping, at this λ.
    Damped(Complex<f64>),
}

/// The reason for the eigenvalue of a pair, from the work of its forces along itself. In this work a rounding
/// error of x in a stiff direction counts only with its square.
fn kind(equations: &Equations, pair: &Eigenpair) -> Kind {
    let e = equations;
    let p = e.freedoms();
    let x = pair.vector.rows(0, p).into_owned();
    let z = pair
        .vector
        .rows(2 * p, pair.vector.len() - 2 * p)
        .into_owned();
    let product = |matrix: &DMatrix<f64>, x: &DVector<Complex<f64>>| {
        let [re, im] = parts(x);
        (matrix * re).zip_map(&(matrix * im), Complex::new)
    };
    let sizes = |x: &DVector<Complex<f64>>| x.map(|x| x.norm());
    let (size_x, size_z) = (sizes(&x), sizes(&z));
    let square = size_x.norm_squared();
    let rounding = (2 * p + z.len()) as f64 * f64::EPSILON;
    let held = x.dotc(&(product(&e.stiffness, &x) - product(&e.by_states, &z)));
    let terms = size_x.dot(&(&e.stiffness_terms * &size_x + e.by_states.abs() * &size_z));
    if held.norm() > rounding * (terms + e.own_terms * square) {
        return Kind::Held;
    }
    // a state with a law of its own, such as the lag of a rubber, is zero in a free motion. The computed one is rounding
    // of the rates T x that motions of this size give to it
    let size = size_x.norm();
    let rows = |matrix: &DMatrix<f64>| {
        DVector::from_fn(matrix.nrows(), |i, _| matrix.row(i).norm() * size)
    };
    let changed = product(&e.rates_by_place, &x) + product(&e.rates_by_states, &z);
    let terms =
        rows(&e.rates_by_place) + e.rates_by_states.abs() * (size_z + rows(&e.rates_by_velocity));
    let mut rates = changed.iter().zip(&terms);
    if rates.any(|(changed, terms)| changed.norm() > rounding * terms) {
        return Kind::Held;
    }
    let damped = x.dotc(&product(&e.damping, &x));
    let terms = size_x.dot(&(&e.damping_terms * &size_x));
    if damped.norm() > rounding * (terms + libm::sqrt(e.own_terms) * square) {
        Kind::Damped(-damped / square)
    } else {
        Kind::Free
    }
}

/// The `wanted` slowest eigenvalues, all of them below `resolution` (rad/s).
pub(super) fn resolve(
    equations: &Equations,
    mut wanted: usize,
    mut resolution: f64,
) -> Result<Slow, RuntimeError> {
    let mut found = Slow {
        pairs: Vec::new(),
        zeros: 0,
    };
    for _ in 0..SHIFTS {
        if wanted == 0 || resolution <= SLOWEST {
            break;
        }
        let Some(matrix) = inverse(equations, resolution) else {
            break;
        };
        let mut pairs: Vec<Eigenpair> = spectrum(matrix)?
            .pairs
            .into_iter()
            .map(|pair| {
                let value = Complex::new(resolution, 0.0) + pair.value.inv();
                // the inverse changes the sign of the imaginary part
                if value.im < 0.0 {
                    Eigenpair {
                        value: value.conj(),
                        vector: pair.vector.map(|x| x.conj()),
                    }
                } else {
                    Eigenpair { value, ..pair }
                }
            })
            // an eigenvalue 0 of the inverse belongs to no slow motion
            .filter(|pair| pair.value.norm().is_finite())
            .collect();
        pairs.sort_by(|a, b| a.value.norm().total_cmp(&b.value.norm()));
        let finer = resolution * libm::sqrt(equations.first_order_size() as f64 * f64::EPSILON);
        let finer = finer.max(SLOWEST);
        let mut left = 0;
        let mut taken = 0;
        for pair in pairs {
            if taken >= wanted {
                break;
            }
            taken += count(&pair);
            if pair.value.norm() <= finer {
                left += count(&pair);
                continue;
            }
            match kind(equations, &pair) {
                Kind::Held => found.pairs.push(pair),
                Kind::Free => found.zeros += count(&pair),
                Kind::Damped(pole) if (pair.value - pole).norm() <= 0.5 * pole.norm() => {
                    found.pairs.push(pair);
                }
                // rounding has made a conjugate pair of the zero and the nonzero eigenvalue of one direction
                Kind::Damped(pole) if count(&pair) == 2 => {
                    found.zeros += 1;
                    found.pairs.push(Eigenpair {
                        value: Complex::new(pole.re, 0.0),
                        ..pair
                    });
                }
                Kind::Damped(_) => found.zeros += 1,
            }
        }
        // a slower shift finds the remaining ones, or they are zero
        wanted = left + wanted.saturating_sub(taken);
        resolution = finer;
    }
    found.zeros += wanted;
    Ok(found)
}
