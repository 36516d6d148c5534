//! The classes: joints, drive, spring, an element with a state, outputs, start rows.

use super::dual::Scalar;
use super::*;

fn layout(markers: u32, rows: u32, constants: u32) -> InputLayout {
    InputLayout {
        markers,
        rows,
        constants,
        ..InputLayout::default()
    }
}

/// a.origin == b.origin. Outputs: force on a (inertial).
#[derive(Debug)]
pub struct Spherical;
impl Definition for Spherical {
    fn layout(&self) -> InputLayout {
        layout(2, 3, 0)
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        minus(i.m[0].x, i.m[1].x).to_vec()
    }
    fn outputs(&self, i: &In<f64>, _: &[f64]) -> Vec<f64> {
        i.multipliers.iter().map(|x| -x).collect()
    }
    fn describe(&self, class: &mut ElementClass) {
        for axis in ["x", "y", "z"] {
            class.rows.push(row(
                &format!("a.origin - b.origin == 0 ({axis})"),
                Dimension::LENGTH,
            ));
            class.outputs.push(output(&format!("force.{axis}")));
        }
        class.facts.uses_twist = false;
        class.facts.applies_load = false;
    }
}

/// Point and axis. Condition: axes agree.
#[derive(Debug)]
pub struct Revolute;
impl Definition for Revolute {
    fn layout(&self) -> InputLayout {
        layout(2, 5, 0)
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        let (a, b) = (&i.m[0], &i.m[1]);
        let mut rows = minus(a.x, b.x).to_vec();
        rows.push(dot(a.axis(0), b.axis(2)));
        rows.push(dot(a.axis(1), b.axis(2)));
        rows
    }
    fn conditions(&self, i: &In<f64>) -> Vec<f64> {
        vec![dot(i.m[0].axis(2), i.m[1].axis(2))]
    }
    fn describe(&self, class: &mut ElementClass) {
        for axis in ["x", "y", "z"] {
            class.rows.push(row(
                &format!("a.origin - b.origin == 0 ({axis})"),
                Dimension::LENGTH,
            ));
        }
        class.rows.push(row("dot(a.x, b.z) == 0", Dimension::ONE));
        class.rows.push(row("dot(a.y, b.z) == 0", Dimension::ONE));
        class
            .conditions
            .push(condition(ConditionKind::Branch, "dot(a.z, b.z) > 0"));
        class.facts.uses_twist = false;
        class.facts.applies_load = false;
    }
}

/// a slides along b.z without turning. Branch: travel above c0. Outputs: travel, its second rate, force along b.x.
#[derive(Debug)]
pub struct Translational;
impl Definition for Translational {
    fn layout(&self) -> InputLayout {
        layout(2, 5, 1)
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        let (a, b) = (&i.m[0], &i.m[1]);
        let d = minus(a.x, b.x);
        vec![
            dot(d, b.axis(0)),
            dot(d, b.axis(1)),
            dot(a.axis(0), b.axis(1)),
            dot(a.axis(1), b.axis(2)),
            dot(a.axis(2), b.axis(0)),
        ]
    }
    fn outputs(&self, i: &In<f64>, extra: &[f64]) -> Vec<f64> {
        let (a, b) = (&i.m[0], &i.m[1]);
        vec![
            dot(minus(a.x, b.x), b.axis(2)),
            dot([extra[0], extra[1], extra[2]], b.axis(2)),
            -i.multipliers[0],
        ]
    }
    fn conditions(&self, i: &In<f64>) -> Vec<f64> {
        let (a, b) = (&i.m[0], &i.m[1]);
        vec![
            dot(minus(a.x, b.x), b.axis(2)) - i.c[0],
            dot(a.axis(2), b.axis(2)),
            dot(a.axis(0), b.axis(0)),
        ]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.rows = vec![
            row("dot(e, b.x) == 0", Dimension::LENGTH),
            row("dot(e, b.y) == 0", Dimension::LENGTH),
            row("dot(a.x, b.y) == 0", Dimension::ONE),
            row("dot(a.y, b.z) == 0", Dimension::ONE),
            row("dot(a.z, b.x) == 0", Dimension::ONE),
        ];
        class.outputs = vec![output("travel"), output("acceleration"), output("force.x")];
        class.conditions = vec![
            condition(ConditionKind::Branch, "travel > limit"),
            condition(ConditionKind::Branch, "dot(a.z, b.z) > 0"),
            condition(ConditionKind::Branch, "dot(a.x, b.x) > 0"),
        ];
        class.facts.uses_twist = false;
        class.facts.applies_load = false;
    }
}

/// Angle of a about b.z is c0 + c1 t + ½ c2 t². Outputs: torque on a about b.z; angle error.
#[derive(Debug)]
pub struct Drive;
impl Drive {
    fn error<S: Scalar>(i: &In<S>) -> (S, S) {
        let (a, b) = (&i.m[0], &i.m[1]);
        let t = i.time;
        let angle =
            S::constant(i.c[0]) + S::constant(i.c[1]) * t + S::constant(0.5 * i.c[2]) * t * t;
        let (c, s) = (dot(a.axis(0), b.axis(0)), dot(a.axis(0), b.axis(1)));
        (
            s * angle.cos() - c * angle.sin(),
            c * angle.cos() + s * angle.sin(),
        )
    }
}
impl Definition for Drive {
    fn layout(&self) -> InputLayout {
        layout(2, 1, 3)
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        vec![Drive::error(i).0]
    }
    fn outputs(&self, i: &In<f64>, _: &[f64]) -> Vec<f64> {
        let (s, c) = Drive::error(i);
        vec![-i.multipliers[0] * c, libm::atan2(s, c)]
    }
    fn conditions(&self, i: &In<f64>) -> Vec<f64> {
        vec![Drive::error(i).1]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.rows = vec![row("sin(rotation(a, b) - angle) == 0", Dimension::ANGLE)];
        class.outputs = vec![output("torque"), output("error")];
        class.conditions = vec![condition(
            ConditionKind::Branch,
            "cos(rotation(a, b) - angle) > 0",
        )];
        class.facts.rows_over_time = true;
        class.facts.uses_twist = false;
        class.facts.applies_load = false;
    }
}

/// Spring c0 (N/m) of length c1 with damper c2 (N s/m) between the origins. Output: tension. Requires length above c3.
#[derive(Debug)]
pub struct Spring;
impl Spring {
    fn tension<S: Scalar>(i: &In<S>) -> (S, Vec3<S>, S) {
        let e = minus(i.m[0].x, i.m[1].x);
        let length = dot(e, e).sqrt();
        let n = times(e, length.recip());
        let rate = dot(n, minus(i.m[0].v, i.m[1].v));
        (
            S::constant(i.c[0]) * (length - S::constant(i.c[1])) + S::constant(i.c[2]) * rate,
            n,
            length,
        )
    }
}
impl Definition for Spring {
    fn layout(&self) -> InputLayout {
        layout(2, 0, 4)
    }
    fn loads<S: Scalar>(&self, i: &In<S>) -> Vec<[S; 6]> {
        let (t, n, _) = Spring::tension(i);
        let f = times(n, t);
        let o = S::constant(0.0);
        vec![[-f[0], -f[1], -f[2], o, o, o], [f[0], f[1], f[2], o, o, o]]
    }
    fn outputs(&self, i: &In<f64>, _: &[f64]) -> Vec<f64> {
        let (t, _, length) = Spring::tension(i);
        vec![t, length]
    }
    fn conditions(&self, i: &In<f64>) -> Vec<f64> {
        let length = Spring::tension(i).2;
        vec![length - i.c[3], length - 1.1 * i.c[3]]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.outputs = vec![output("tension"), output("length")];
        class.conditions = vec![
            condition(ConditionKind::Require, "the spring is blocked"),
            condition(ConditionKind::Advise, "the spring is nearly blocked"),
        ];
    }
}

/// Bushing with torques, turned axes and twists in everything: F = −c0 e − c1 ė (in b's axes), torque on a in a's axes
/// −c2 (relative rotation, small) − c3 (relative spin), reaction at the same point of b.
#[derive(Debug)]
pub struct Bushing;
impl Definition for Bushing {
    fn layout(&self) -> InputLayout {
        layout(2, 0, 4)
    }
    fn loads<S: Scalar>(&self, i: &In<S>) -> Vec<[S; 6]> {
        let (a, b) = (&i.m[0], &i.m[1]);
        let e = minus(a.x, b.x);
        let rate = minus(minus(a.v, b.v), cross(b.spin(), e));
        let el = b.local(e);
        let rl = b.local(rate);
        let stiff = [1.0, 1.7, 0.6];
        let mut f = [S::constant(0.0); 3];
        for k in 0..3 {
            let c = -(S::constant(i.c[0] * stiff[k]) * el[k] + S::constant(i.c[1]) * rl[k]);
            for (x, axis) in f.iter_mut().zip(b.axis(k)) {
                *x = *x + axis * c;
            }
        }
        let mut turn = [S::constant(0.0); 3];
        for k in 0..3 {
            let c = cross(b.axis(k), a.axis(k));
            for (x, y) in turn.iter_mut().zip(c) {
                *x = *x + S::constant(0.5) * y;
            }
        }
        let spin = minus(a.spin(), b.spin());
        let mut t = [S::constant(0.0); 3];
        for k in 0..3 {
            t[k] = -(S::constant(i.c[2]) * turn[k] + S::constant(i.c[3]) * spin[k]);
        }
        let ta = a.local(t);
        let moment = cross(e, f);
        let tb = b.local([-t[0] - moment[0], -t[1] - moment[1], -t[2] - moment[2]]);
        vec![
            [f[0], f[1], f[2], ta[0], ta[1], ta[2]],
            [-f[0], -f[1], -f[2], tb[0], tb[1], tb[2]],
        ]
    }
    fn describe(&self, _: &mut ElementClass) {}
}

/// Maxwell element: spring c0 in series with a damper, time constant c1; the state is the damper's length.
#[derive(Debug)]
pub struct Maxwell;
impl Definition for Maxwell {
    fn layout(&self) -> InputLayout {
        InputLayout {
            markers: 2,
            states: 1,
            constants: 2,
            ..InputLayout::default()
        }
    }
    fn loads<S: Scalar>(&self, i: &In<S>) -> Vec<[S; 6]> {
        let e = minus(i.m[0].x, i.m[1].x);
        let length = dot(e, e).sqrt();
        let f = times(e, S::constant(i.c[0]) * (length - i.y[0]) * length.recip());
        let o = S::constant(0.0);
        vec![[-f[0], -f[1], -f[2], o, o, o], [f[0], f[1], f[2], o, o, o]]
    }
    fn rates<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        let e = minus(i.m[0].x, i.m[1].x);
        let length = dot(e, e).sqrt();
        vec![(length - i.y[0]) * S::constant(1.0 / i.c[1])]
    }
    fn outputs(&self, i: &In<f64>, extra: &[f64]) -> Vec<f64> {
        vec![i.y[0], extra[12]]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.outputs = vec![output("length"), output("rate")];
    }
}

/// Angle of a about b.z from b.x to a.x, unwrapped, and its rate.
#[derive(Debug)]
pub struct Angle;
pub fn unwrapped(a: &MarkerIn<f64>, b: &MarkerIn<f64>, reference: f64) -> f64 {
    let wrapped = libm::atan2(dot(a.axis(0), b.axis(1)), dot(a.axis(0), b.axis(0)));
    let turn = 2.0 * std::f64::consts::PI;
    wrapped + turn * libm::round((reference - wrapped) / turn)
}
impl Definition for Angle {
    fn layout(&self) -> InputLayout {
        InputLayout {
            markers: 2,
            rotations: 1,
            ..InputLayout::default()
        }
    }
    fn outputs(&self, i: &In<f64>, _: &[f64]) -> Vec<f64> {
        let (a, b) = (&i.m[0], &i.m[1]);
        vec![
            unwrapped(a, b, i.references[0]),
            dot(minus(a.spin(), b.spin()), b.axis(2)),
        ]
    }
    fn rotations(&self, i: &In<f64>) -> Vec<f64> {
        vec![unwrapped(&i.m[0], &i.m[1], i.references[0])]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.outputs = vec![output("angle"), output("rate")];
    }
}

/// Start row: unwrapped angle of a about b.z is c0.
#[derive(Debug)]
pub struct StartAngle;
impl Definition for StartAngle {
    fn layout(&self) -> InputLayout {
        InputLayout {
            markers: 2,
            rows: 1,
            rotations: 1,
            constants: 1,
            ..InputLayout::default()
        }
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        let (a, b) = (&i.m[0], &i.m[1]);
        let wrapped = dot(a.axis(0), b.axis(1)).atan2(dot(a.axis(0), b.axis(0)));
        let turn = 2.0 * std::f64::consts::PI;
        let shift = turn * libm::round((i.references[0] - wrapped.value()) / turn);
        vec![wrapped + S::constant(shift - i.c[0])]
    }
    fn rotations(&self, i: &In<f64>) -> Vec<f64> {
        vec![unwrapped(&i.m[0], &i.m[1], i.references[0])]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.rows = vec![row("rotation(a, b) == angle", Dimension::ANGLE)];
    }
}

/// Start row: angular velocity of a against b about b.z is c0.
#[derive(Debug)]
pub struct StartSpin;
impl Definition for StartSpin {
    fn layout(&self) -> InputLayout {
        layout(2, 1, 1)
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        let (a, b) = (&i.m[0], &i.m[1]);
        vec![dot(minus(a.spin(), b.spin()), b.axis(2)) - S::constant(i.c[0])]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.rows = vec![row(
            "dot(a.angular_velocity, b.z) == speed",
            Dimension::ANGLE,
        )];
    }
}

/// Start row: velocity of a's origin is c0, c1, c2.
#[derive(Debug)]
pub struct StartVelocity;
impl Definition for StartVelocity {
    fn layout(&self) -> InputLayout {
        layout(1, 3, 3)
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        (0..3).map(|k| i.m[0].v[k] - S::constant(i.c[k])).collect()
    }
    fn describe(&self, class: &mut ElementClass) {
        for axis in ["x", "y", "z"] {
            class
                .rows
                .push(row(&format!("velocity ({axis})"), Dimension::ONE));
        }
    }
}

/// Start row: angular velocity of a in its own axes is c0, c1, c2.
#[derive(Debug)]
pub struct StartRotation;
impl Definition for StartRotation {
    fn layout(&self) -> InputLayout {
        layout(1, 3, 3)
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        (0..3).map(|k| i.m[0].w[k] - S::constant(i.c[k])).collect()
    }
    fn describe(&self, class: &mut ElementClass) {
        for axis in ["x", "y", "z"] {
            class
                .rows
                .push(row(&format!("angular_velocity ({axis})"), Dimension::ONE));
        }
    }
}

/// Two rows: a's origin on b's origin in the plane of a.x and a.y; leaves the third direction to the other joints.
#[derive(Debug)]
pub struct InPlane;
impl Definition for InPlane {
    fn layout(&self) -> InputLayout {
        layout(2, 2, 0)
    }
    fn rows<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        let (a, b) = (&i.m[0], &i.m[1]);
        let e = minus(b.x, a.x);
        vec![dot(e, a.axis(0)), dot(e, a.axis(1))]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.rows = vec![
            row("dot(b.origin - a.origin, a.x) == 0", Dimension::LENGTH),
            row("dot(b.origin - a.origin, a.y) == 0", Dimension::LENGTH),
        ];
        class.facts.uses_twist = false;
        class.facts.applies_load = false;
    }
}

/// A barrier at x = c0 (inertial): pushes a back with c1/sqrt(c0 − x) (N); not a number beyond it. Output: gap.
#[derive(Debug)]
pub struct Barrier;
impl Definition for Barrier {
    fn layout(&self) -> InputLayout {
        layout(1, 0, 2)
    }
    fn loads<S: Scalar>(&self, i: &In<S>) -> Vec<[S; 6]> {
        let gap = S::constant(i.c[0]) - i.m[0].x[0];
        let o = S::constant(0.0);
        vec![[-(S::constant(i.c[1]) * gap.sqrt().recip()), o, o, o, o, o]]
    }
    fn outputs(&self, i: &In<f64>, _: &[f64]) -> Vec<f64> {
        vec![i.c[0] - i.m[0].x[0]]
    }
    fn conditions(&self, i: &In<f64>) -> Vec<f64> {
        vec![i.c[0] - i.m[0].x[0]]
    }
    fn describe(&self, class: &mut ElementClass) {
        class.outputs = vec![output("gap")];
        class.conditions = vec![condition(ConditionKind::Require, "beyond the barrier")];
    }
}
