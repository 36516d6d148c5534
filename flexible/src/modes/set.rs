//! Makes a sum of modes an orthonormal set.

use super::{Structure, applied, products};
use crate::error::FlexibleError;
use crate::solve::dense::{subtract, symmetric_eigen};
use crate::sparse::SymmetricOperator;
use crate::sparse::product::TOGETHER;
use eng_system::dense::largest;
use serde::{Deserialize, Serialize};

/// Part of a vector's K-norm below which it is dropped, if earlier vectors leave no more of it. It is about
/// the root of the rounding unit: the energy that is left then has no digits.
const DEPENDENCE: f64 = 1e-8;

/// Share of a vector's energy below which the vector is projected again, because rounding is then large: of
/// the sixteen digits of the vector two are lost, and four of its energy. A choice.
const SHRUNK: f64 = 1e-4;

/// Part of a vector's largest component below which the vector is rigid, if no more is left without its rigid
/// motion. A choice between the rounding of the projection and the bending of a stiff body under its loads.
const RIGID: f64 = 1e-9;

/// A computed or given mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// `static main[2].x`, `normal 3`.
    pub label: String,
    /// The vector over the free freedoms.
    pub vector: Vec<f64>,
    /// Rounding of its entries, as a share of the largest. It is zero for computed modes. A remainder within
    /// ten times this rounding is noise.
    pub noise: f64,
}

/// A dropped mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dropped {
    /// Its label.
    pub label: String,
    /// The part of its K-norm outside the span of the others. Zero for a mode that does not strain the
    /// structure.
    pub remains: f64,
}

/// An orthonormal set of modes: `ΦᵀMΦ = I`, `ΦᵀKΦ = diag(ω²)`.
#[derive(Clone, Debug, Default)]
pub struct ModeSet {
    /// Φ over the free freedoms, one mode after the other, the largest component positive.
    pub vectors: Vec<f64>,
    /// ω² (rad²/s²), ascending.
    pub eigenvalues: Vec<f64>,
    /// The computed ΦᵀKΦ (rad²/s²) by rows: diagonal except for rounding.
    pub stiffness: Vec<f64>,
    /// Labels of the modes in the set.
    pub sources: Vec<String>,
    /// For each mode one row of its amplitudes in the sources: φ = Σ cⱼ vⱼ. Mode and sources have unit strain
    /// energy. The squares of a row sum to one if the sources are orthogonal in K.
    pub amplitudes: Vec<f64>,
    /// The dropped modes.
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

    /// Makes the set that spans the candidates. In a free structure rigid motion is removed first. Each
    /// candidate is scaled to unit strain energy and made orthogonal in K to those before it, twice against
    /// rounding. It is dropped if nothing remains. Its frequency never decides, because stiff static modes
    /// are needed for exact static answers. A small eigenproblem of the mass then gives the set.
    ///
    /// # Errors
    /// When a vector has another length than the structure has freedoms, or is not finite.
    pub fn new(
        structure: &Structure,
        candidates: Vec<Candidate>,
    ) -> Result<ModeSet, FlexibleError> {
        let size = structure.size().max(1);
        let mut basis = Basis::default();
        let mut set = ModeSet::default();
        let mut candidates = candidates.into_iter();
        loop {
            let group: Vec<Candidate> = candidates.by_ref().take(TOGETHER).collect();
            if group.is_empty() {
                break;
            }
            basis.add_group(structure, group, &mut set)?;
        }
        let count = set.sources.len();
        // m y = μ y in a basis where k = I: ω² = 1/μ
        let reduced = products(
            size,
            &basis.vectors,
            &applied(structure.mass, &basis.vectors),
        );
        let (values, vectors) = symmetric_eigen(count, reduced)?;
        let mut coefficients = Vec::with_capacity(count * count);
        for (value, small) in values.iter().zip(vectors.chunks_exact(count.max(1))).rev() {
            if *value <= 0.0 {
                return Err(FlexibleError::Structure {
                    problem: "a mode moves no mass".into(),
                    advice: "give some mass to the parts that this static mode moves".into(),
                });
            }
            let scale = 1.0 / libm::sqrt(*value);
            coefficients.extend(small.iter().map(|x| x * scale));
            set.amplitudes.extend(in_sources(&basis.triangle, small));
            set.eigenvalues.push(1.0 / value);
        }
        let negative: Vec<f64> = coefficients.iter().map(|x| -x).collect();
        set.vectors = vec![0.0; size * count];
        subtract(size, &basis.vectors, &negative, &mut set.vectors);
        let strain = products(size, &basis.vectors, &basis.forces);
        let half = products(count, &strain, &coefficients);
        set.stiffness = products(count, &coefficients, &half);
        for (index, mode) in set.vectors.chunks_exact_mut(size).enumerate() {
            let largest = mode.iter().fold(0.0_f64, |w, x| {
                // of components that differ by rounding alone, as in symmetric modes, the first decides the
                // sign on every machine
                if x.abs() > w.abs() * (1.0 + 1e-6) {
                    *x
                } else {
                    w
                }
            });
            if largest < 0.0 {
                mode.iter_mut().for_each(|x| *x = -*x);
                for other in (0..count).filter(|other| *other != index) {
                    for place in [index * count + other, other * count + index] {
                        if let Some(x) = set.stiffness.get_mut(place) {
                            *x = -*x;
                        }
                    }
                }
            }
        }
        Ok(set)
    }
}

/// A growing basis of K-orthonormal vectors.
#[derive(Default)]
struct Basis {
    vectors: Vec<f64>,
    /// Products of the vectors with K.
    forces: Vec<f64>,
    /// Each source at unit energy, as amplitudes in the basis up to itself.
    triangle: Vec<Vec<f64>>,
}

/// A candidate for the basis.
struct Entering {
    label: String,
    noise: f64,
    /// Largest entry at unit energy.
    largest: f64,
    /// Amplitudes along the basis.
    along: Vec<f64>,
}

impl Basis {
    /// Adds a group of candidates to the basis, in their order. Products with K and with the basis are
    /// computed for the whole group at once. Forces are updated together with the vectors, as long as enough
    /// of the vectors remains.
    fn add_group(
        &mut self,
        structure: &Structure,
        group: Vec<Candidate>,
        set: &mut ModeSet,
    ) -> Result<(), FlexibleError> {
        let size = structure.size().max(1);
        let (mut entering, mut vectors) = elastic(structure, group, set)?;
        let mut forces = applied(structure.stiffness, &vectors);
        scale_to_unit_energy(size, &mut entering, &mut vectors, &mut forces, set);
        for _ in 0..2 {
            let coefficients = products(size, &self.forces, &vectors);
            subtract(size, &self.vectors, &coefficients, &mut vectors);
            subtract(size, &self.forces, &coefficients, &mut forces);
            let known = self.triangle.len();
            for (entering, own) in entering
                .iter_mut()
                .zip(coefficients.chunks_exact(known.max(1)))
            {
                add_to(&mut entering.along, own);
            }
        }
        let first = self.triangle.len();
        let columns = vectors
            .chunks_exact_mut(size)
            .zip(forces.chunks_exact_mut(size));
        for (mut entering, (vector, force)) in entering.into_iter().zip(columns) {
            self.project(size, first, vector, force, &mut entering.along);
            let mut left = energy(vector, force);
            if left < SHRUNK {
                // the remainder may be rounding of the removed part, so it is projected again against all
                structure.stiffness.apply(1, vector, force);
                self.project(size, 0, vector, force, &mut entering.along);
                structure.stiffness.apply(1, vector, force);
                left = energy(vector, force);
            }
            let remains = libm::sqrt(left);
            let Entering {
                label,
                noise,
                largest: whole,
                mut along,
            } = entering;
            // a remainder of less than ten times the noise of the file's digits says nothing. A choice
            if remains.is_nan() || remains < DEPENDENCE || largest(vector) <= 10.0 * noise * whole {
                set.dropped.push(Dropped { label, remains });
                continue;
            }
            self.vectors.extend(vector.iter().map(|x| x / remains));
            self.forces.extend(force.iter().map(|x| x / remains));
            along.push(remains);
            self.triangle.push(along);
            set.sources.push(label);
        }
        Ok(())
    }

    /// Removes from a vector and its force the part along the basis from `first` on, twice against rounding.
    fn project(
        &self,
        size: usize,
        first: usize,
        vector: &mut [f64],
        force: &mut [f64],
        along: &mut Vec<f64>,
    ) {
        along.resize(self.triangle.len(), 0.0);
        let (Some(vectors), Some(forces)) = (
            self.vectors.get(first * size..),
            self.forces.get(first * size..),
        ) else {
            return;
        };
        for _ in 0..2 {
            let coefficients = products(size, forces, vector);
            subtract(size, vectors, &coefficients, vector);
            subtract(size, forces, &coefficients, force);
            if let Some(along) = along.get_mut(first..) {
                for (sum, x) in along.iter_mut().zip(&coefficients) {
                    *sum += x;
                }
            }
        }
    }
}

/// Candidates without their rigid motion, one after the other. Purely rigid ones are dropped.
fn elastic(
    structure: &Structure,
    group: Vec<Candidate>,
    set: &mut ModeSet,
) -> Result<(Vec<Entering>, Vec<f64>), FlexibleError> {
    let size = structure.size();
    let mut vectors = Vec::with_capacity(group.len() * size);
    let mut entering = Vec::with_capacity(group.len());
    for Candidate {
        label,
        vector,
        noise,
    } in group
    {
        if vector.len() != size || vector.iter().any(|x| !x.is_finite()) {
            return Err(FlexibleError::Matrix {
                problem: format!("the mode {label} is not finite or of another size"),
                advice: String::new(),
            });
        }
        entering.push(Entering {
            label,
            noise,
            largest: largest(&vector),
            along: Vec::new(),
        });
        vectors.extend(vector);
    }
    if let Some(rigid) = &structure.rigid {
        rigid.remove(&mut vectors);
        keep(
            size,
            &mut entering,
            &mut vectors,
            set,
            |entering, vector| {
                // the remainder of a rigid motion is rounding
                largest(vector) > RIGID.max(10.0 * entering.noise) * entering.largest
            },
        );
    }
    Ok((entering, vectors))
}

/// Scales vectors and their forces to unit strain energy. Vectors that do not strain the structure are
/// dropped.
fn scale_to_unit_energy(
    size: usize,
    entering: &mut Vec<Entering>,
    vectors: &mut Vec<f64>,
    forces: &mut Vec<f64>,
    set: &mut ModeSet,
) {
    let mut kept = Vec::with_capacity(forces.len());
    let mut every = forces.chunks_exact(size);
    keep(size, entering, vectors, set, |entering, vector| {
        let Some(force) = every.next() else {
            return false;
        };
        let length = libm::sqrt(energy(vector, force));
        if length > 0.0 {
            vector.iter_mut().for_each(|x| *x /= length);
            kept.extend(force.iter().map(|x| x / length));
            entering.largest = largest(vector);
        }
        length > 0.0
    });
    *forces = kept;
}

/// Keeps the candidates (with their vectors, in their order) that pass a test. The others are dropped with
/// zero remains.
fn keep(
    size: usize,
    entering: &mut Vec<Entering>,
    vectors: &mut Vec<f64>,
    set: &mut ModeSet,
    mut test: impl FnMut(&mut Entering, &mut [f64]) -> bool,
) {
    let mut kept = 0;
    let mut index = 0;
    entering.retain_mut(|entering| {
        let own = index * size..(index + 1) * size;
        index += 1;
        let keep = vectors
            .get_mut(own.clone())
            .is_some_and(|vector| test(entering, vector));
        if keep {
            vectors.copy_within(own, kept * size);
            kept += 1;
        } else {
            set.dropped.push(Dropped {
                label: std::mem::take(&mut entering.label),
                remains: 0.0,
            });
        }
        keep
    });
    vectors.truncate(kept * size);
}

/// `x·f`, at least zero. Twice the strain energy (J) for x in m and the forces f in N.
fn energy(vector: &[f64], force: &[f64]) -> f64 {
    let energy: f64 = vector.iter().zip(force).map(|(x, f)| x * f).sum();
    energy.max(0.0)
}

/// `sum += x`, the sum as long as x.
fn add_to(sum: &mut Vec<f64>, x: &[f64]) {
    sum.resize(x.len(), 0.0);
    for (sum, x) in sum.iter_mut().zip(x) {
        *sum += x;
    }
}

/// Solves `T c = y` with an upper triangle by columns. This converts amplitudes in the basis to those in the
/// sources.
fn in_sources(triangle: &[Vec<f64>], y: &[f64]) -> Vec<f64> {
    let mut rest = y.to_vec();
    for (index, column) in triangle.iter().enumerate().rev() {
        let Some((own, above)) = column.split_last() else {
            continue;
        };
        let (before, from) = rest.split_at_mut(index.min(y.len()));
        if let Some(x) = from.first_mut() {
            *x /= own;
            for (rest, t) in before.iter_mut().zip(above) {
                *rest -= t * *x;
            }
        }
    }
    rest
}
