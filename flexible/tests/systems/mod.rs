//! Matrices with known properties for the tests of the solver.

use eng_flexible::sparse::SymmetricMatrix;

/// Numbers without pattern, the same in every run (xorshift).
pub struct Numbers(u64);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Numbers(seed.wrapping_mul(2).wrapping_add(1))
    }

    pub fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % bound
    }

    /// Uniform in −1…1.
    pub fn symmetric(&mut self) -> f64 {
        self.below(2_000_001) as f64 / 1e6 - 1.0
    }
}

pub fn matrix(size: usize, entries: &[(u32, u32, f64)]) -> SymmetricMatrix {
    SymmetricMatrix::from_triplets(size, entries).unwrap()
}

pub fn diagonal(values: &[f64]) -> SymmetricMatrix {
    let entries: Vec<_> = values
        .iter()
        .enumerate()
        .map(|(row, &value)| (row as u32, row as u32, value))
        .collect();
    matrix(values.len(), &entries)
}

/// Finite differences of −Δ on a grid with zero values outside, unit spacing.
pub fn laplacian(sides: [u32; 3]) -> SymmetricMatrix {
    let node = |at: [u32; 3]| (at[2] * sides[1] + at[1]) * sides[0] + at[0];
    let directions = sides.iter().filter(|side| **side > 1).count();
    let mut entries = Vec::new();
    for z in 0..sides[2] {
        for y in 0..sides[1] {
            for x in 0..sides[0] {
                let own = node([x, y, z]);
                entries.push((own, own, 2.0 * directions as f64));
                for (axis, at) in [x, y, z].into_iter().enumerate() {
                    if at + 1 < sides[axis] {
                        let mut next = [x, y, z];
                        next[axis] += 1;
                        entries.push((node(next), own, -1.0));
                    }
                }
            }
        }
    }
    matrix(sides.iter().product::<u32>() as usize, &entries)
}

/// Its eigenvalues, ascending: Σ 4 sin²(π k / (2 (n + 1))) over the directions.
pub fn laplacian_eigenvalues(sides: [u32; 3]) -> Vec<f64> {
    let axis = |side: u32| -> Vec<f64> {
        if side == 1 {
            return vec![0.0];
        }
        (1..=side)
            .map(|k| {
                let half = std::f64::consts::PI * f64::from(k) / (2.0 * f64::from(side + 1));
                4.0 * half.sin().powi(2)
            })
            .collect()
    };
    let mut values = Vec::new();
    for x in axis(sides[0]) {
        for y in axis(sides[1]) {
            for z in axis(sides[2]) {
                values.push(x + y + z);
            }
        }
    }
    values.sort_by(f64::total_cmp);
    values
}

/// Stiffness of a free chain of springs.
pub fn chain(masses: usize, stiffness: f64) -> SymmetricMatrix {
    matrix(masses, &chain_entries(masses, stiffness, 0))
}

pub fn chain_entries(masses: usize, stiffness: f64, first: u32) -> Vec<(u32, u32, f64)> {
    (first..first + masses as u32 - 1)
        .flat_map(|one| {
            [
                (one, one, stiffness),
                (one + 1, one + 1, stiffness),
                (one + 1, one, -stiffness),
            ]
        })
        .collect()
}

/// Eigenvalues of a free chain of equal masses, ascending: 4 k/m sin²(π j / (2 n)), j = 0….
pub fn chain_eigenvalues(masses: usize, stiffness: f64, mass: f64) -> Vec<f64> {
    (0..masses)
        .map(|j| {
            let half = std::f64::consts::PI * j as f64 / (2.0 * masses as f64);
            4.0 * stiffness / mass * half.sin().powi(2)
        })
        .collect()
}

/// Stiffness and consistent mass of a box of equal 8-node cubes of isotropic elasticity (edge 1 m, E = 2.1e11 N/m²,
/// ν = 0.3, ρ = 7800 kg/m³), integrated at 2×2×2 points; three freedoms for each node, x running fastest. Nothing is
/// supported.
pub fn elastic_box(elements: [u32; 3]) -> (SymmetricMatrix, SymmetricMatrix) {
    let (stiffness, mass) = cube_element();
    let nodes = elements.map(|count| count + 1);
    let size = 3 * nodes.iter().product::<u32>() as usize;
    let (mut k, mut m) = (Vec::new(), Vec::new());
    for z in 0..elements[2] {
        for y in 0..elements[1] {
            for x in 0..elements[0] {
                let place = |local: usize| -> u32 {
                    let (corner, freedom) = (local / 3, (local % 3) as u32);
                    let [dx, dy, dz] = corner_of(corner);
                    3 * (((z + dz) * nodes[1] + y + dy) * nodes[0] + x + dx) + freedom
                };
                for i in 0..24 {
                    for j in 0..24 {
                        let (row, column) = (place(i), place(j));
                        if row >= column {
                            k.push((row, column, stiffness[i][j]));
                            if i % 3 == j % 3 {
                                m.push((row, column, mass[i / 3][j / 3]));
                            }
                        }
                    }
                }
            }
        }
    }
    (matrix(size, &k), matrix(size, &m))
}

fn corner_of(corner: usize) -> [u32; 3] {
    [corner & 1, corner >> 1 & 1, corner >> 2 & 1].map(|bit| bit as u32)
}

fn cube_element() -> ([[f64; 24]; 24], [[f64; 8]; 8]) {
    let (young, poisson, density) = (2.1e11, 0.3, 7800.0);
    let lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let shear = young / (2.0 * (1.0 + poisson));
    let (mut stiffness, mut mass) = ([[0.0; 24]; 24], [[0.0; 8]; 8]);
    let point = 0.5 / 3.0f64.sqrt();
    for gauss in 0..8 {
        let at = corner_of(gauss).map(|bit| 0.5 + (2.0 * f64::from(bit) - 1.0) * point);
        let mut shape = [0.0; 8];
        let mut gradient = [[0.0; 3]; 8];
        for corner in 0..8 {
            let bits = corner_of(corner);
            let one = |axis: usize| {
                if bits[axis] == 1 {
                    at[axis]
                } else {
                    1.0 - at[axis]
                }
            };
            let slope = |axis: usize| if bits[axis] == 1 { 1.0 } else { -1.0 };
            shape[corner] = one(0) * one(1) * one(2);
            gradient[corner] = [
                slope(0) * one(1) * one(2),
                one(0) * slope(1) * one(2),
                one(0) * one(1) * slope(2),
            ];
        }
        for a in 0..8 {
            for b in 0..8 {
                mass[a][b] += density * shape[a] * shape[b] / 8.0;
                let inner: f64 = (0..3).map(|i| gradient[a][i] * gradient[b][i]).sum();
                for i in 0..3 {
                    for j in 0..3 {
                        let mut value = lame * gradient[a][i] * gradient[b][j]
                            + shear * gradient[a][j] * gradient[b][i];
                        if i == j {
                            value += shear * inner;
                        }
                        stiffness[3 * a + i][3 * b + j] += value / 8.0;
                    }
                }
            }
        }
    }
    (stiffness, mass)
}

/// A random sparse symmetric matrix; `lift` is added to the diagonal in units of the row's absolute sum
/// (above 1: positive definite).
pub fn random_sparse(size: usize, a_row: usize, lift: f64, seed: u64) -> SymmetricMatrix {
    let mut numbers = Numbers::new(seed);
    let mut entries = Vec::new();
    let mut sums = vec![0.0; size];
    for row in 0..size {
        for _ in 0..a_row {
            let column = numbers.below(size);
            if column != row {
                let value = numbers.symmetric();
                entries.push((row.max(column) as u32, row.min(column) as u32, value));
                sums[row] += value.abs();
                sums[column] += value.abs();
            }
        }
    }
    for (row, sum) in sums.iter().enumerate() {
        entries.push((
            row as u32,
            row as u32,
            lift * sum + 0.15 + 0.1 * numbers.symmetric(),
        ));
    }
    matrix(size, &entries)
}

/// Dense copy, by columns.
pub fn dense(matrix: &SymmetricMatrix) -> faer::Mat<f64> {
    let mut full = faer::Mat::zeros(matrix.size(), matrix.size());
    for column in 0..matrix.size() {
        let (rows, values) = matrix.column(column);
        for (&row, &value) in rows.iter().zip(values) {
            full[(row as usize, column)] = value;
            full[(column, row as usize)] = value;
        }
    }
    full
}

/// All eigenvalues of `K x = λ M x` with positive definite `M`, ascending, by a dense method of its own.
pub fn dense_eigenvalues(stiffness: &SymmetricMatrix, mass: &SymmetricMatrix) -> Vec<f64> {
    let factor = dense(mass).llt(faer::Side::Lower).unwrap();
    let lower = factor.L().to_owned();
    let mut half = dense(stiffness);
    faer::linalg::triangular_solve::solve_lower_triangular_in_place(
        lower.as_ref(),
        half.as_mut(),
        faer::Par::Seq,
    );
    let mut both = half.transpose().to_owned();
    faer::linalg::triangular_solve::solve_lower_triangular_in_place(
        lower.as_ref(),
        both.as_mut(),
        faer::Par::Seq,
    );
    both.self_adjoint_eigenvalues(faer::Side::Lower).unwrap()
}
