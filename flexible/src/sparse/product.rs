//! A sparse symmetric matrix times several vectors.

use super::SymmetricMatrix;
use faer::traits::pulp::{Arch, Simd, WithSimd};

/// Vectors taken together: their entries of one row fill a cache line.
pub(crate) const TOGETHER: usize = 8;

/// Entries of one row of vectors taken together.
pub(crate) type Lanes = [f64; TOGETHER];

/// `y = A x` for vectors stored one after the other; reads the matrix once for eight vectors. `x` and `y`
/// have the same length, a multiple of the matrix's size.
pub(crate) fn multiply(matrix: &SymmetricMatrix, x: &[f64], y: &mut [f64]) {
    let size = matrix.size();
    if size == 0 {
        return;
    }
    let mut packed = vec![[0.0f64; TOGETHER]; size];
    let mut product = vec![[0.0f64; TOGETHER]; size];
    for (x, y) in x.chunks(size * TOGETHER).zip(y.chunks_mut(size * TOGETHER)) {
        pack(x, &mut packed);
        product.fill([0.0; TOGETHER]);
        Arch::new().dispatch(Product {
            matrix,
            x: &packed,
            y: &mut product,
        });
        unpack(&product, y);
    }
}

/// Copies vectors that are stored one after the other to vectors side by side.
pub(crate) fn pack(x: &[f64], packed: &mut [Lanes]) {
    for (lane, x) in x.chunks_exact(packed.len()).enumerate().take(TOGETHER) {
        for (packed, &x) in packed.iter_mut().zip(x) {
            packed[lane] = x;
        }
    }
}

/// The reverse copy.
pub(crate) fn unpack(packed: &[Lanes], y: &mut [f64]) {
    for (lane, y) in y.chunks_exact_mut(packed.len()).enumerate().take(TOGETHER) {
        for (y, packed) in y.iter_mut().zip(packed) {
            *y = packed[lane];
        }
    }
}

/// A product, with the widest vectors that the processor has: the same operations in the same order, whatever
/// their width.
struct Product<'a> {
    matrix: &'a SymmetricMatrix,
    x: &'a [Lanes],
    y: &'a mut [Lanes],
}

impl WithSimd for Product<'_> {
    type Output = ();

    // only inlined code is compiled for the processor
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        accumulate(self.matrix, self.x, self.y);
    }
}

#[inline(always)]
fn accumulate(matrix: &SymmetricMatrix, x: &[Lanes], product: &mut [Lanes]) {
    let size = matrix.size();
    let mut column = 0;
    while column < size {
        if let Some((rows, values)) = three_alike(matrix, column) {
            accumulate_three(column, rows, values, x, product);
            column += 3;
        } else {
            accumulate_one(matrix, column, x, product);
            column += 1;
        }
    }
}

/// Rows below three columns whose rows are the same, as the freedoms of a node mostly are, and the values of
/// each.
#[inline(always)]
fn three_alike(matrix: &SymmetricMatrix, column: usize) -> Option<(&[u32], [&[f64]; 3])> {
    if column + 2 >= matrix.size() {
        return None;
    }
    let [one, two, three] = [column, column + 1, column + 2].map(|column| matrix.column(column));
    let (&[first, second, third, ref below @ ..], rows_of_two, rows_of_three) =
        (one.0, two.0, three.0)
    else {
        return None;
    };
    let column = column as u32;
    let alike = [first, second, third] == [column, column + 1, column + 2]
        && rows_of_two.len() == below.len() + 2
        && rows_of_three.len() == below.len() + 1
        && rows_of_two[..2] == [second, third]
        && rows_of_three[0] == third
        && rows_of_two[2..] == *below
        && rows_of_three[1..] == *below;
    alike.then_some((below, [one.1, two.1, three.1]))
}

#[inline(always)]
fn accumulate_three(
    column: usize,
    rows: &[u32],
    [one, two, three]: [&[f64]; 3],
    x: &[Lanes],
    product: &mut [Lanes],
) {
    let own = [x[column], x[column + 1], x[column + 2]];
    let mut sum = [[0.0f64; TOGETHER]; 3];
    let diagonal = [
        [one[0], 0.0, 0.0],
        [one[1], two[0], 0.0],
        [one[2], two[1], three[0]],
    ];
    for lane in 0..TOGETHER {
        // in the order of the columns, as for single columns
        let [a, b, c] = [own[0][lane], own[1][lane], own[2][lane]];
        sum[0][lane] = diagonal[0][0] * a + diagonal[1][0] * b + diagonal[2][0] * c;
        sum[1][lane] = diagonal[1][1] * b + diagonal[2][1] * c;
        sum[2][lane] = diagonal[2][2] * c;
        product[column + 1][lane] += diagonal[1][0] * a;
        product[column + 2][lane] += diagonal[2][0] * a;
        product[column + 2][lane] += diagonal[2][1] * b;
    }
    let values = one[3..].iter().zip(&two[2..]).zip(&three[1..]);
    for (&row, ((&one, &two), &three)) in rows.iter().zip(values) {
        let other = &x[row as usize];
        let target = &mut product[row as usize];
        for lane in 0..TOGETHER {
            sum[0][lane] += one * other[lane];
            sum[1][lane] += two * other[lane];
            sum[2][lane] += three * other[lane];
            target[lane] =
                target[lane] + one * own[0][lane] + two * own[1][lane] + three * own[2][lane];
        }
    }
    for (target, sum) in product[column..column + 3].iter_mut().zip(&sum) {
        for (target, sum) in target.iter_mut().zip(sum) {
            *target += sum;
        }
    }
}

#[inline(always)]
fn accumulate_one(matrix: &SymmetricMatrix, column: usize, x: &[Lanes], product: &mut [Lanes]) {
    let (rows, values) = matrix.column(column);
    let own = x[column];
    let mut sum = [0.0f64; TOGETHER];
    for (&row, &value) in rows.iter().zip(values) {
        let row = row as usize;
        let other = &x[row];
        for lane in 0..TOGETHER {
            sum[lane] += value * other[lane];
        }
        if row != column {
            let target = &mut product[row];
            for lane in 0..TOGETHER {
                target[lane] += value * own[lane];
            }
        }
    }
    for (target, sum) in product[column].iter_mut().zip(sum) {
        *target += sum;
    }
}
