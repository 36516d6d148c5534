//! Rotation vectors, quaternions and matrices.

use eng_runtime::rotation::{
    M3, V3, exponential, inverse_tangent, logarithm, matrix, product, quaternion, tangent,
    turn_between,
};

#[test]
fn small_turns_keep_their_digits_and_signs_of_quaternions_do_not_count() {
    let of = |angle: f64| [libm::cos(0.5 * angle), 0.0, 0.0, libm::sin(0.5 * angle)];
    for turn in [1e-12, 1e-5, 0.7, 3.0] {
        let (a, b) = (of(0.4), of(0.4 + turn));
        assert!(
            (turn_between(&a, &b).norm() / turn - 1.0).abs() < 1e-3,
            "{turn}"
        );
        assert!((turn_between(&a, &b.map(|x| -x)).norm() / turn - 1.0).abs() < 1e-3);
    }
}

#[test]
fn tangent_is_the_derivative_of_the_exponential() {
    for theta in [
        V3::new(0.3, -0.4, 0.2),
        V3::new(0.01, 0.02, -0.03),
        V3::new(0.0, 0.0, 0.0),
        V3::new(1.5, 1.0, -1.2),
    ] {
        let direction = V3::new(0.2, -0.7, 0.4);
        let step = 1e-5;
        let inverse = {
            let q = exponential(&theta);
            [q[0], -q[1], -q[2], -q[3]]
        };
        let ahead = product(&inverse, &exponential(&(theta + direction * step)));
        let behind = product(&inverse, &exponential(&(theta - direction * step)));
        let difference = (logarithm(&ahead) - logarithm(&behind)) / (2.0 * step);
        let exact = tangent(&theta) * direction;
        assert!((difference - exact).norm() < 1e-9, "{difference} {exact}");
        let back = inverse_tangent(&theta) * exact;
        assert!((back - direction).norm() < 1e-13);
    }
}

#[test]
fn matrix_and_quaternion_agree() {
    for theta in [
        V3::new(3.0, 0.1, 0.2),
        V3::new(0.1, 3.0, -0.2),
        V3::new(-0.2, 0.3, 3.1),
        V3::new(0.1, 0.1, 0.1),
    ] {
        let q = exponential(&theta);
        let a = matrix(&q);
        assert!((a * a.transpose() - M3::identity()).norm() < 1e-14);
        assert!((matrix(&quaternion(&a)) - a).norm() < 1e-14);
        let axis = theta.normalize();
        assert!((a * axis - axis).norm() < 1e-14);
    }
}
