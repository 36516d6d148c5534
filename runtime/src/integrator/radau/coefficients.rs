//! The coefficients of Radau IIA with three stages (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section
//! IV.8), and sums over its stages.

/// √6.
const ROOT: f64 = 2.449_489_742_783_178;
/// A.
pub const A: [[f64; 3]; 3] = [
    [
        (88.0 - 7.0 * ROOT) / 360.0,
        (296.0 - 169.0 * ROOT) / 1800.0,
        (-2.0 + 3.0 * ROOT) / 225.0,
    ],
    [
        (296.0 + 169.0 * ROOT) / 1800.0,
        (88.0 + 7.0 * ROOT) / 360.0,
        (-2.0 - 3.0 * ROOT) / 225.0,
    ],
    [(16.0 - ROOT) / 36.0, (16.0 + ROOT) / 36.0, 1.0 / 9.0],
];
/// A⁻¹.
pub const INVERSE: [[f64; 3]; 3] = [
    [
        2.0 + ROOT / 2.0,
        -1.2 + 29.0 * ROOT / 30.0,
        0.4 - 4.0 * ROOT / 15.0,
    ],
    [
        -1.2 - 29.0 * ROOT / 30.0,
        2.0 - ROOT / 2.0,
        0.4 + 4.0 * ROOT / 15.0,
    ],
    [-1.0 + 8.0 * ROOT / 3.0, -1.0 - 8.0 * ROOT / 3.0, 5.0],
];
/// c: the places of the stages in the step.
pub const NODES: [f64; 3] = [(4.0 - ROOT) / 10.0, (4.0 + ROOT) / 10.0, 1.0];
/// The real eigenvalue μ of A⁻¹.
pub const REAL: f64 = 3.637_834_252_744_496;
/// The complex eigenvalue, α and β.
pub const COMPLEX: [f64; 2] = [2.681_082_873_627_752, 3.050_430_199_247_410_6];
/// The basis B of the eigenvectors: `B⁻¹ A⁻¹ B = [μ; α, −β; β, α]` with the complex eigenvalue α + βi.
pub const BASIS: [[f64; 3]; 3] = [
    [
        0.094_438_762_488_975_24,
        -0.141_255_295_020_954_2,
        -0.030_029_194_105_147_424,
    ],
    [
        0.250_213_122_965_333_3,
        0.204_129_352_293_799_93,
        0.382_942_112_757_261_9,
    ],
    [1.0, 1.0, 0.0],
];
/// B⁻¹.
pub const BASIS_INVERSE: [[f64; 3]; 3] = [
    [
        4.178_718_591_551_905,
        0.327_682_820_761_062_4,
        0.523_376_445_499_449_5,
    ],
    [
        -4.178_718_591_551_905,
        -0.327_682_820_761_062_4,
        0.476_623_554_500_550_45,
    ],
    [
        -0.502_872_634_945_786_9,
        2.571_926_949_855_605,
        -0.596_039_204_828_224_9,
    ],
];
/// d: the weights of the stages in the embedded formula.
pub(super) const EMBEDDED: [f64; 3] = [
    (-13.0 - 7.0 * ROOT) / 3.0,
    (-13.0 + 7.0 * ROOT) / 3.0,
    -1.0 / 3.0,
];

/// Weights of the three stages in the value of their parabola at a place x; the stages are at [`NODES`].
pub(super) fn extrapolation(x: f64) -> [f64; 3] {
    std::array::from_fn(|i| {
        let others = (0..3).filter(|j| *j != i);
        others.fold(1.0, |product, j| {
            product * (x - NODES[j]) / (NODES[i] - NODES[j])
        })
    })
}

/// Sum of weights times values.
pub(super) fn weighted(weights: &[f64; 3], values: [f64; 3]) -> f64 {
    weights.iter().zip(values).map(|(w, x)| w * x).sum()
}
