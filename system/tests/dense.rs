//! Products with small dense blocks against their sums.

use eng_system::dense::{add_product, add_product_of_six, add_transposed, dot};

#[test]
fn products_are_the_sums_they_stand_for() {
    let number = |i: usize| f64::from((i as u32 * 7 + 3) % 11) - 5.0;
    for n in 0..11 {
        let x: Vec<f64> = (0..n).map(number).collect();
        let block: Vec<f64> = (0..n * n).map(|i| number(i + 2)).collect();
        let expected: f64 = x.iter().zip(&block).map(|(a, b)| a * b).sum();
        assert_eq!(dot(&x, &block), expected);
        let (mut forward, mut back) = (vec![1.0; n], vec![1.0; n]);
        add_product(&mut forward, 2.0, &block, &x);
        add_transposed(&mut back, &block, &x);
        for i in 0..n {
            let row: f64 = (0..n).map(|j| block[i * n + j] * x[j]).sum();
            let column: f64 = (0..n).map(|j| block[j * n + i] * x[j]).sum();
            assert_eq!((forward[i], back[i]), (1.0 + 2.0 * row, 1.0 + column));
        }
    }
    let (height, width) = (3, 5);
    let left: Vec<f64> = (0..6 * height).map(number).collect();
    let right: Vec<f64> = (0..6 * width).map(|i| number(i + 1)).collect();
    let mut out = vec![0.5; height * width];
    add_product_of_six(&mut out, &left, &right);
    for r in 0..height {
        for c in 0..width {
            let sum: f64 = (0..6)
                .map(|k| left[k * height + r] * right[k * width + c])
                .sum();
            assert_eq!(out[r * width + c], 0.5 + sum);
        }
    }
}
