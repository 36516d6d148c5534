//! A sum of modes as an orthonormal set.

use super::{Structure, applied, products, subtract};
use crate::error::FlexibleError;
use crate::solve::dense::symmetric_eigen;
use crate::sparse::SymmetricOperator;

/// A vector is dropped when what the vectors before it leave of it has less than this part of its K-norm.
const DEPENDENCE: f64 = 1e-8;

/// A vector is rigid when no more than this part of its largest component is left without its rigid motion.
const RIGID: f64 = 1e-9;

/// A mode as it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// `static main[2].x`, `normal 3`.
    pub label: String,
    /// Over the free freedoms.
    pub vector: Vec<f64>,
    /// Rounding of its entries, of the largest: zero for computed ones. What is left of it within ten times that is noise.
    pub noise: f64,
}

/// A mode that is left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Dropped {
    /// Its label.
    pub label: String,
    /// The part of its K-norm that the others leave; zero for one that does not strain the structure.
    pub remains: f64,
}

/// An orthonormal set of modes: `ΦᵀMΦ = I`, `ΦᵀKΦ = diag(ω²)`.
#[derive(Clone, Debug, Default)]
pub struct ModeSet {
    /// Φ over the free freedoms, one mode after the other, the largest component positive.
    pub vectors: Vec<f64>,
    /// ω² (rad²/s²), ascending.
    pub eigenvalues: Vec<f64>,
    /// Labels of the modes that went into the set.
    pub sources: Vec<String>,
    /// For each mode and each source (one row a mode) their cosine in the K-norm: the square is the share of the mode's strain energy
    /// that the source alone holds. Sources are not orthogonal, so that a row's squares don't add to one.
    pub shares: Vec<f64>,
    /// What was left out.
    pub dropped: Vec<Dropped>,
}

impl ModeSet {
    /// Number of modes.
    pub fn len(&self) -> usize {
        self.eigenvalues.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.eigenvalues.is_empty()
    }

    /// Frequencies (Hz).
    pub fn frequencies(&self) -> Vec<f64> {
        self.eigenvalues
            .iter()
            .map(|x| libm::sqrt(x.max(0.0)) / (2.0 * std::f64::consts::PI))
            .collect()
    }

    /// Makes the set that spans the candidates. Rigid motion is taken out of those of a free structure. Each is scaled to unit strain
    /// energy, made orthogonal in K to those before it (twice, for the digits) and dropped where nothing is left: never by frequency,
    /// which would destroy what static modes are for. A small eigenproblem of the mass then gives the set.
    ///
    /// # Errors
    /// When a vector has another length than the structure has freedoms, or is not finite.
    pub fn new(
        structure: &Structure,
        candidates: Vec<Candidate>,
    ) -> Result<ModeSet, FlexibleError> {
        let size = structure.size();
        let mut set = ModeSet::default();
        // K-orthonormal vectors and their products with K
        let (mut basis, mut forces): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        // each source at unit energy, in the basis up to itself
        let mut triangle: Vec<Vec<f64>> = Vec::new();
        for Candidate {
            label,
            mut vector,
            noise,
        } in candidates
        {
            let largest = |vector: &[f64]| vector.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
            if vector.len() != size || vector.iter().any(|x| !x.is_finite()) {
                return Err(FlexibleError::Matrix {
                    problem: format!("the mode {label} is not finite or of another size"),
                    advice: String::new(),
                });
            }
            if let Some(rigid) = &structure.rigid {
                let before = largest(&vector);
                rigid.remove(&mut vector);
                // what is left of a rigid motion is rounding
                if largest(&vector) <= RIGID.max(10.0 * noise) * before {
                    set.dropped.push(Dropped {
                        label,
                        remains: 0.0,
                    });
                    continue;
                }
            }
            let mut force = vec![0.0; size];
            let norm = |vector: &[f64], force: &mut [f64]| -> f64 {
                structure.stiffness.apply(1, vector, force);
                let energy: f64 = vector.iter().zip(force.iter()).map(|(x, f)| x * f).sum();
                libm::sqrt(energy.max(0.0))
            };
            let first = norm(&vector, &mut force);
            if first == 0.0 {
                set.dropped.push(Dropped {
                    label,
                    remains: 0.0,
                });
                continue;
            }
            vector.iter_mut().for_each(|x| *x /= first);
            let before = largest(&vector);
            let mut along = vec![0.0; set.sources.len()];
            for _ in 0..2 {
                let coefficients = products(size, &forces, &vector);
                subtract(size, &basis, &coefficients, &mut vector);
                for (sum, x) in along.iter_mut().zip(&coefficients) {
                    *sum += x;
                }
            }
            let remains = norm(&vector, &mut force);
            if remains < DEPENDENCE || largest(&vector) <= 10.0 * noise * before {
                set.dropped.push(Dropped { label, remains });
                continue;
            }
            vector.iter_mut().for_each(|x| *x /= remains);
            force.iter_mut().for_each(|x| *x /= remains);
            basis.extend(vector);
            forces.extend(force);
            along.push(remains);
            triangle.push(along);
            set.sources.push(label);
        }
        let count = set.sources.len();
        // m y = μ y in a basis where k = I: ω² = 1/μ
        let reduced = products(size, &basis, &applied(structure.mass, &basis));
        let (values, vectors) = symmetric_eigen(count, reduced)?;
        for (value, small) in values.iter().zip(vectors.chunks_exact(count.max(1))).rev() {
            if *value <= 0.0 {
                return Err(FlexibleError::Structure {
                    problem: "a mode moves no mass".into(),
                    advice: "a static mode of massless parts needs some mass there".into(),
                });
            }
            let mut mode = vec![0.0; size];
            let scale = -1.0 / libm::sqrt(*value);
            let coefficients: Vec<f64> = small.iter().map(|x| x * scale).collect();
            subtract(size, &basis, &coefficients, &mut mode);
            let largest = mode.iter().fold(0.0_f64, |w, x| {
                if x.abs() > w.abs() * (1.0 + 1e-6) {
                    *x
                } else {
                    w
                }
            });
            if largest < 0.0 {
                mode.iter_mut().for_each(|x| *x = -*x);
            }
            let shares = triangle
                .iter()
                .map(|along| -> f64 { along.iter().zip(small).map(|(x, y)| x * y).sum() });
            set.shares.extend(shares);
            set.eigenvalues.push(1.0 / value);
            set.vectors.extend(mode);
        }
        Ok(set)
    }
}
