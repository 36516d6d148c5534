//! Block elimination of a ring of cells, against products with the dense matrix.

use eng_film::internals::{EAST, HIGH, LOW, OWN, RingMatrix, WEST};

const LANES: usize = 3;

/// A ring whose couplings are numbers without pattern.
struct Case {
    around: usize,
    across: usize,
    border: usize,
    eastwards: bool,
    symmetric: bool,
    /// Whether a cell is a row of the identity, and no other row holds it.
    single: fn(usize, usize) -> bool,
}

impl Case {
    /// Solves with A and its transposed, and multiplies the solutions with the dense matrix.
    fn check(&self) {
        let (around, across) = (self.around, self.across);
        let count = around * across;
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 40) as f64 / (1_u64 << 24) as f64
        };
        let single = |cell: usize| (self.single)(cell / across, cell % across);
        let mut matrix = RingMatrix::new(around, across, 1);
        let mut dense = vec![0.0; count * count];
        for cell in 0..count {
            let (column, row) = (cell / across, cell % across);
            matrix.rows[cell][OWN] = 1.0;
            dense[cell * count + cell] = 1.0;
            if single(cell) {
                continue;
            }
            matrix.rows[cell][OWN] = 5.0 + random();
            dense[cell * count + cell] = matrix.rows[cell][OWN];
            let east = (column + 1) % around * across + row;
            let high = (row + 1 < across).then_some(cell + 1);
            for (other, there, back) in [(Some(east), EAST, WEST), (high, HIGH, LOW)] {
                let Some(other) = other.filter(|other| !single(*other)) else {
                    continue;
                };
                let number = -random();
                let mirrored = if self.symmetric { number } else { -random() };
                matrix.rows[cell][there] = number;
                matrix.rows[other][back] = mirrored;
                dense[cell * count + other] = number;
                dense[other * count + cell] = mirrored;
            }
        }
        matrix.factor(self.border, self.eastwards, self.symmetric);
        let given: Vec<[f64; LANES]> = (0..count)
            .map(|_| [0; LANES].map(|_| random() - 0.5))
            .collect();
        let mut x: Vec<f64> = given.iter().map(|lanes| lanes[0]).collect();
        let mut y = given.clone();
        matrix.solve(&mut x);
        matrix.solve_transposed(&mut y, &mut vec![[0.0; LANES]; 2 * across]);
        for (cell, given) in given.iter().enumerate() {
            let row: f64 = (0..count)
                .map(|other| dense[cell * count + other] * x[other])
                .sum();
            assert!((row - given[0]).abs() < 1e-13, "{row} and {}", given[0]);
            for (lane, given) in given.iter().enumerate() {
                let column: f64 = (0..count)
                    .map(|other| dense[other * count + cell] * y[other][lane])
                    .sum();
                assert!((column - given).abs() < 1e-13, "{column} and {given}");
            }
        }
    }
}

/// A ring without single cells; with a column of them; with one cell left in each column; with patches.
const SINGLE: [fn(usize, usize) -> bool; 4] = [
    |_, _| false,
    |column, _| column == 2,
    |column, row| (column == 1 || column == 2) && row != 0,
    |column, row| (column + 2 * row) % 5 < 2,
];

#[test]
fn inverses_solve_the_ring_and_its_transposed() {
    for (around, across) in [(4, 1), (4, 4), (7, 1), (9, 3), (12, 5), (8, 13), (6, 33)] {
        for border in [0, 1, 2, around - 1] {
            for single in SINGLE {
                for (eastwards, symmetric) in
                    [(true, false), (false, false), (true, true), (false, true)]
                {
                    Case {
                        around,
                        across,
                        border,
                        eastwards,
                        symmetric,
                        single,
                    }
                    .check();
                }
            }
        }
    }
}

#[test]
fn a_column_of_single_cells_cuts_the_ring() {
    let case = |border| {
        let mut matrix = RingMatrix::new(6, 3, 0);
        for (cell, row) in matrix.rows.iter_mut().enumerate() {
            let column = cell / 3;
            *row = [4.0, -1.0, -1.0, 0.0, 0.0];
            for (place, other) in [(WEST, 5), (EAST, 1)] {
                if column == 0 || column == other {
                    row[if column == 0 {
                        place
                    } else {
                        WEST + EAST - place
                    }] = 0.0;
                }
            }
        }
        matrix.factor(border, true, true);
        matrix.coupled.len()
    };
    assert_eq!(case(0), 0);
    assert_eq!(case(3), 3);
}
