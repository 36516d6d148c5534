//! The values of the shapes of an elastic surface at the cells of a film.
//!
//! A shape is a wave around times a polynomial across. So a sum over all shapes is taken at each angle over
//! the waves, and at each place of this angle over the degrees: the cost of a place does not depend on the
//! number of waves.

use crate::block::add_lanes as add;
use eng_system::surface::SurfaceShape;
use std::ops::Range;

/// Most degrees across. A choice: sums keep this many numbers on the stack, and a film has fewer cells across
/// than polynomials of higher degrees need.
pub(crate) const DEGREES: usize = 16;

/// The shapes at places of a grid that come angle by angle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Waves {
    /// Degree across of each shape, and one more than the highest.
    degree: Vec<usize>,
    degrees: usize,
    /// Shapes that follow each other with the same degree, and this degree.
    equal: Vec<(Range<usize>, usize)>,
    /// First place of each angle, and the number of all places.
    runs: Vec<usize>,
    /// Values of the waves, angle by angle.
    around: Vec<f64>,
    /// Values of the polynomials, place by place.
    across: Vec<f64>,
}

/// Sums of the places of one angle, degree by degree, of several outputs.
pub(crate) type RunSums<const N: usize> = [[f64; N]; DEGREES];

impl Waves {
    /// The shapes at places with angle (rad) and ζ. `factor` scales the waves of a number at the places of an angle.
    pub fn new(
        shapes: &[SurfaceShape],
        places: impl Iterator<Item = (f64, f64)>,
        factor: impl Fn(u32, usize) -> f64,
    ) -> Waves {
        let mut waves = Waves {
            degree: shapes.iter().map(|shape| shape.across as usize).collect(),
            degrees: shapes
                .iter()
                .map(|shape| shape.across as usize + 1)
                .max()
                .unwrap_or(0),
            ..Waves::default()
        };
        if shapes.is_empty() {
            return waves;
        }
        let mut first = 0;
        for equal in waves.degree.chunk_by(|a, b| a == b) {
            waves.equal.push((first..first + equal.len(), equal[0]));
            first += equal.len();
        }
        let (mut angle_before, mut count) = (f64::NAN, 0);
        for (place, (angle, zeta)) in places.enumerate() {
            if angle != angle_before {
                angle_before = angle;
                waves.runs.push(place);
                waves.around.extend(shapes.iter().map(|shape| {
                    let wave = SurfaceShape {
                        across: 0,
                        ..*shape
                    };
                    wave.value(angle, 0.0) * factor(shape.around, place)
                }));
            }
            waves.across.extend((0..waves.degrees as u32).map(|across| {
                let polynomial = SurfaceShape {
                    around: 0,
                    sine: false,
                    across,
                };
                polynomial.value(0.0, zeta)
            }));
            count = place + 1;
        }
        waves.runs.push(count);
        waves
    }

    /// The places of each angle.
    pub fn runs(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.runs.windows(2).map(|ends| ends[0]..ends[1])
    }

    /// Values of the waves at an angle.
    fn waves(&self, run: usize) -> &[f64] {
        let count = self.degree.len();
        &self.around[run * count..(run + 1) * count]
    }

    /// Values of the polynomials at a place.
    fn polynomials(&self, place: usize) -> &[f64] {
        &self.across[place * self.degrees..(place + 1) * self.degrees]
    }

    /// The value of a shape at a place of a run. Dimensionless.
    pub fn value(&self, run: usize, place: usize, shape: usize) -> f64 {
        self.waves(run)[shape] * self.polynomials(place)[self.degree[shape]]
    }

    /// `out += Σ amplitude ψ`.
    pub fn add_sum(&self, amplitudes: &[f64], out: &mut [f64]) {
        self.for_each(amplitudes, |place, sum| out[place] += sum);
    }

    /// The largest magnitude of `Σ amplitude ψ`. In the unit of the amplitudes.
    pub fn largest(&self, amplitudes: &[f64]) -> f64 {
        let mut most = 0.0_f64;
        self.for_each(amplitudes, |_, sum| most = most.max(sum.abs()));
        most
    }

    /// Calls `put(place, Σ amplitude ψ)` for all places.
    pub fn for_each(&self, amplitudes: &[f64], mut put: impl FnMut(usize, f64)) {
        for (run, places) in self.runs().enumerate() {
            let factors = self.factors(run, amplitudes);
            for place in places {
                put(place, dot(self.polynomials(place), &factors));
            }
        }
    }

    /// The sums over the waves at an angle, degree by degree.
    fn factors(&self, run: usize, amplitudes: &[f64]) -> [f64; DEGREES] {
        let mut factors = [0.0; DEGREES];
        let waves = self.waves(run);
        for (shapes, degree) in &self.equal {
            factors[*degree] +=
                dot_side_by_side(&waves[shapes.clone()], &amplitudes[shapes.clone()]);
        }
        factors
    }

    /// `out += ∫ load ψ`, with the loads of the places. In the unit of the loads.
    pub fn add_moments(&self, load: impl Fn(usize) -> f64, out: &mut [f64]) {
        for (run, places) in self.runs().enumerate() {
            let mut sums: RunSums<1> = [[0.0]; DEGREES];
            for place in places {
                self.gather(place, &[load(place)], &mut sums);
            }
            let waves = self.waves(run).iter().zip(&self.degree);
            for (sum, (wave, degree)) in out.iter_mut().zip(waves) {
                *sum += wave * sums[*degree][0];
            }
        }
    }

    /// Adds the derivatives by the value at a place to the sums of its angle.
    pub fn gather<const N: usize>(&self, place: usize, by_value: &[f64; N], sums: &mut RunSums<N>) {
        for (sum, polynomial) in sums.iter_mut().zip(self.polynomials(place)) {
            add(sum, *polynomial, by_value);
        }
    }

    /// Adds the sums of an angle to the derivatives by the amplitudes, and empties them.
    pub fn spread<const N: usize>(
        &self,
        run: usize,
        sums: &mut RunSums<N>,
        slopes: &mut [[f64; N]],
    ) {
        for (slope, (wave, degree)) in slopes
            .iter_mut()
            .zip(self.waves(run).iter().zip(&self.degree))
        {
            add(slope, *wave, &sums[*degree]);
        }
        for sum in sums.iter_mut().take(self.degrees) {
            *sum = [0.0; N];
        }
    }
}

/// `Σ a b`, as long as the shorter one.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `Σ a b` of slices of equal length, as four sums side by side: one sum waits for each of its additions.
fn dot_side_by_side(a: &[f64], b: &[f64]) -> f64 {
    let ((fours, rest), (others, other)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (x, y) in fours.iter().zip(others) {
        for (sum, (x, y)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *sum += x * y;
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + dot(rest, other)
}
