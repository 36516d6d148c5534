//! Element classes built by hand and states to evaluate them at, shared by the tests and the benchmark.
#![allow(dead_code, missing_docs, clippy::expect_used)]

pub mod magnitudes;

use eng_compiler::ir::{ClassBody, Graph, Node};
use eng_system::code::{ElementCode, Function, Pair};
use eng_system::elementary::Elementary;
use eng_system::layout::InputLayout;
use eng_system::table::{Argument, End, Ends, Extrapolation, Interpolation, Table};

pub type Vector = [Node; 3];

/// Vector algebra over a class's inputs.
pub struct Builder {
    pub g: Graph,
    pub layout: InputLayout,
}

impl Builder {
    pub fn new(layout: InputLayout, plain: bool) -> Self {
        let g = if plain { Graph::plain() } else { Graph::new() };
        Builder { g, layout }
    }
    pub fn c(&mut self, value: f64) -> Node {
        self.g.constant(value)
    }
    pub fn constant_input(&mut self, i: u32) -> Node {
        self.g.input(self.layout.constant(i))
    }
    fn three(&mut self, first: u32, step: u32) -> Vector {
        [0, 1, 2].map(|i| self.g.input(first + step * i))
    }
    pub fn origin(&mut self, marker: u32) -> Vector {
        self.three(self.layout.marker(marker), 1)
    }
    pub fn axis(&mut self, marker: u32, axis: u32) -> Vector {
        self.three(self.layout.marker(marker) + 3 + axis, 3)
    }
    pub fn velocity(&mut self, marker: u32) -> Vector {
        self.three(self.layout.marker(marker) + 12, 1)
    }
    /// Angular velocity in the marker's axes.
    pub fn spin(&mut self, marker: u32) -> Vector {
        self.three(self.layout.marker(marker) + 15, 1)
    }
    pub fn dot(&mut self, a: Vector, b: Vector) -> Node {
        let x = self.g.multiply(a[0], b[0]);
        let y = self.g.multiply(a[1], b[1]);
        let z = self.g.multiply(a[2], b[2]);
        let s = self.g.add(x, y);
        self.g.add(s, z)
    }
    pub fn cross(&mut self, a: Vector, b: Vector) -> Vector {
        [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let p = self.g.multiply(a[j], b[k]);
            let q = self.g.multiply(a[k], b[j]);
            self.g.subtract(p, q)
        })
    }
    pub fn plus(&mut self, a: Vector, b: Vector) -> Vector {
        [0, 1, 2].map(|i| self.g.add(a[i], b[i]))
    }
    pub fn minus(&mut self, a: Vector, b: Vector) -> Vector {
        [0, 1, 2].map(|i| self.g.subtract(a[i], b[i]))
    }
    pub fn negative(&mut self, a: Vector) -> Vector {
        a.map(|n| self.g.negate(n))
    }
    /// Components along a marker's axes.
    pub fn local(&mut self, v: Vector, marker: u32) -> Vector {
        [0, 1, 2].map(|i| {
            let axis = self.axis(marker, i);
            self.dot(v, axis)
        })
    }
    /// The vector of components along a marker's axes.
    pub fn inertial(&mut self, c: Vector, marker: u32) -> Vector {
        let zero = self.g.constant(0.0);
        let mut sum = [zero; 3];
        for (i, c) in (0..).zip(c) {
            let term = self.axis(marker, i).map(|a| self.g.multiply(a, c));
            sum = self.plus(sum, term);
        }
        sum
    }
    pub fn body(
        self,
        name: &str,
        rows: Vec<Node>,
        loads: Vec<[Node; 6]>,
        rates: Vec<Node>,
        outputs: Vec<Node>,
    ) -> ClassBody {
        ClassBody {
            name: name.into(),
            layout: self.layout,
            graph: self.g,
            rows,
            loads,
            rates,
            outputs,
            conditions: Vec::new(),
            rotations: Vec::new(),
            drives: Vec::new(),
            turns: Vec::new(),
            changing: Vec::new(),
            bound_kinks: Vec::new(),
            wraps: Vec::new(),
            stops: Vec::new(),
        }
    }
}

/// Five rows: the origins coincide, a.z is perpendicular to b.x and b.y.
pub fn revolute(plain: bool) -> ClassBody {
    let layout = InputLayout {
        markers: 2,
        rows: 5,
        rotations: 1,
        ..InputLayout::default()
    };
    let mut b = Builder::new(layout, plain);
    let (xa, xb) = (b.origin(0), b.origin(1));
    let e = b.minus(xa, xb);
    let mut rows = b.local(e, 1).to_vec();
    let az = b.axis(0, 2);
    for axis in [0, 1] {
        let side = b.axis(1, axis);
        rows.push(b.dot(az, side));
    }
    let (ax, bx, by) = (b.axis(0, 0), b.axis(1, 0), b.axis(1, 1));
    let (sine, cosine) = (b.dot(ax, by), b.dot(ax, bx));
    // unwrapped: the reference plus the principal difference
    let reference = b.g.input(layout.rotation(0));
    let (sr, cr) = (
        b.g.unary(Elementary::Sin, reference),
        b.g.unary(Elementary::Cos, reference),
    );
    let (p, q) = (b.g.multiply(sine, cr), b.g.multiply(cosine, sr));
    let s = b.g.subtract(p, q);
    let (p, q) = (b.g.multiply(cosine, cr), b.g.multiply(sine, sr));
    let c = b.g.add(p, q);
    let step = b.g.atan2(s, c);
    let angle = b.g.add(reference, step);
    let zero = b.c(0.0);
    let bz = b.axis(1, 2);
    let aligned = b.dot(az, bz);
    let multiplier = b.g.input(layout.multiplier(0));
    let acceleration = b.g.input(layout.acceleration(0));
    let mut body = b.body(
        "Revolute",
        rows,
        vec![[zero; 6]; 2],
        vec![],
        vec![angle, multiplier, acceleration],
    );
    body.conditions = vec![aligned];
    body.rotations = vec![angle];
    body
}

/// Rows with time, root, angle and table: a rod whose length breathes, a drive, a cam.
pub fn cam(plain: bool) -> ClassBody {
    let layout = InputLayout {
        markers: 2,
        rows: 3,
        constants: 3,
        ..InputLayout::default()
    };
    let mut b = Builder::new(layout, plain);
    let (xa, xb) = (b.origin(0), b.origin(1));
    let e = b.minus(xa, xb);
    let time = b.g.input(InputLayout::TIME);
    let (speed, length, table) = (
        b.constant_input(0),
        b.constant_input(1),
        b.constant_input(2),
    );
    let phase = b.g.multiply(speed, time);
    let square = b.dot(e, e);
    let distance = b.g.sqrt(square);
    let (one, tenth) = (b.c(1.0), b.c(0.1));
    let sine = b.g.unary(Elementary::Sin, phase);
    let breath = b.g.multiply(tenth, sine);
    let breath = b.g.add(one, breath);
    let wanted = b.g.multiply(length, breath);
    let first = b.g.subtract(distance, wanted);
    let (ax, bx, by) = (b.axis(0, 0), b.axis(1, 0), b.axis(1, 1));
    let (s, c) = (b.dot(ax, by), b.dot(ax, bx));
    let angle = b.g.atan2(s, c);
    let error = b.g.subtract(angle, phase);
    let second = b.g.unary(Elementary::Sin, error);
    let lift = b.g.table(table, &[angle]);
    let bz = b.axis(1, 2);
    let height = b.dot(e, bz);
    let third = b.g.subtract(height, lift);
    let zero = b.c(0.0);
    b.body(
        "Cam",
        vec![first, second, third],
        vec![[zero; 6]; 2],
        vec![],
        vec![angle],
    )
}

/// A film law in the shape of Childs' impedance on a short bearing: root, arcus, powers, a cap and a floor.
/// Pin (0) in shell (1); constants: radial clearance (m), viscosity · length³ · radius / clearance² (N s/m).
pub fn film(plain: bool) -> ClassBody {
    let layout = InputLayout {
        markers: 2,
        constants: 2,
        ..InputLayout::default()
    };
    let mut b = Builder::new(layout, plain);
    let (clearance, size) = (b.constant_input(0), b.constant_input(1));
    let (xa, xb) = (b.origin(0), b.origin(1));
    let arm = b.minus(xa, xb);
    let d = b.local(arm, 1);
    let (va, vb) = (b.velocity(0), b.velocity(1));
    let v = b.minus(va, vb);
    let v = b.local(v, 1);
    let shell_spin = b.spin(1);
    let turning = b.cross(shell_spin, d);
    let rate = b.minus(v, turning);
    let pin_spin = b.spin(0);
    let pin_spin = b.inertial(pin_spin, 0);
    let bz = b.axis(1, 2);
    let pin_spin = b.dot(pin_spin, bz);
    let half = b.c(0.5);
    let slip = b.g.subtract(pin_spin, shell_spin[2]);
    let mean = b.g.multiply(half, slip);
    let p = b.g.multiply(mean, d[1]);
    let vx = b.g.add(rate[0], p);
    let p = b.g.multiply(mean, d[0]);
    let vy = b.g.subtract(rate[1], p);
    // |v| with a floor, components of e/c along and across it
    let floor = b.c(1e-12);
    let (vxx, vyy) = (b.g.multiply(vx, vx), b.g.multiply(vy, vy));
    let vv = b.g.add(vxx, vyy);
    let vv = b.g.add(vv, floor);
    let speed = b.g.sqrt(vv);
    let scale = b.g.multiply(speed, clearance);
    let (p, q) = (b.g.multiply(vx, d[0]), b.g.multiply(vy, d[1]));
    let along = b.g.add(p, q);
    let along = b.g.divide(along, scale);
    let (p, q) = (b.g.multiply(vx, d[1]), b.g.multiply(vy, d[0]));
    let across = b.g.subtract(p, q);
    let across = b.g.divide(across, scale);
    let one = b.c(1.0);
    let cap = b.c(0.999);
    let across = b.g.minimum(across, cap);
    let (p, q) = (b.g.multiply(along, along), b.g.multiply(across, across));
    let left = b.g.subtract(one, q);
    let gap = b.g.subtract(left, p);
    let least = b.c(0.002);
    let gap = b.g.maximum(gap, least);
    let root = b.g.sqrt(left);
    let arc = b.g.unary(Elementary::Asin, across);
    let turn = b.g.atan2(along, root);
    let power = b.c(1.5);
    let power = b.g.power(gap, power);
    let bend = b.g.multiply(arc, turn);
    let factor = b.g.add(one, bend);
    let magnitude = b.g.divide(factor, power);
    let magnitude = b.g.multiply(magnitude, size);
    // the force leans from −v by the angle
    let (sine, cosine) = (
        b.g.unary(Elementary::Sin, arc),
        b.g.unary(Elementary::Cos, arc),
    );
    let (p, q) = (b.g.multiply(cosine, vx), b.g.multiply(sine, vy));
    let fx = b.g.subtract(q, p);
    let (p, q) = (b.g.multiply(sine, vx), b.g.multiply(cosine, vy));
    let fy = b.g.add(p, q);
    let fx = b.g.multiply(fx, magnitude);
    let fy = b.g.multiply(fy, magnitude);
    let fy = b.g.negate(fy);
    let zero = b.c(0.0);
    let force = b.inertial([fx, fy, zero], 1);
    let opposite = b.negative(force);
    // the same point of the shell's body: the moment of the opposite force about the shell's origin
    let moment = b.cross(arm, opposite);
    let friction = b.g.divide(slip, root);
    let small = b.c(1e-6);
    let friction = b.g.multiply(friction, small);
    let friction = b.g.multiply(friction, size);
    let couple = bz.map(|z| b.g.multiply(z, friction));
    let moment = b.plus(moment, couple);
    let on_pin = b.negative(couple);
    let on_pin = b.local(on_pin, 0);
    let on_shell = b.local(moment, 1);
    let loads = vec![
        [
            force[0], force[1], force[2], on_pin[0], on_pin[1], on_pin[2],
        ],
        [
            opposite[0],
            opposite[1],
            opposite[2],
            on_shell[0],
            on_shell[1],
            on_shell[2],
        ],
    ];
    let power_loss = b.g.multiply(magnitude, vv);
    b.body("Film", vec![], loads, vec![], vec![fx, fy, power_loss])
}

/// Every other operation, own states, and branches whose unused side is not finite.
pub fn bushing(plain: bool) -> ClassBody {
    let layout = InputLayout {
        markers: 2,
        states: 2,
        constants: 2,
        ..InputLayout::default()
    };
    let mut b = Builder::new(layout, plain);
    let (stiffness, table) = (b.constant_input(0), b.constant_input(1));
    let (xa, xb) = (b.origin(0), b.origin(1));
    let e = b.minus(xa, xb);
    let d = b.local(e, 1);
    let (va, vb) = (b.velocity(0), b.velocity(1));
    let v = b.minus(va, vb);
    let v = b.local(v, 1);
    let (y0, y1) = (b.g.input(layout.state(0)), b.g.input(layout.state(1)));
    let zero = b.c(0.0);
    // a spring that pulls only: root of a negative number on the other side
    let root = b.g.sqrt(d[0]);
    let deep = b.g.unary(Elementary::Log, d[0]);
    let deep = b.g.multiply(root, deep);
    let positive = b.g.less(zero, d[0]);
    let pull = b.g.select(positive, deep, zero);
    let pull = b.g.multiply(pull, stiffness);
    let a1 = b.g.unary(Elementary::Tanh, v[1]);
    let a2 = b.g.unary(Elementary::Tan, d[1]);
    let a2 = b.g.unary(Elementary::Atan, a2);
    let a2 = b.g.multiply(a1, a2);
    let two = b.c(2.0);
    let quotient = b.g.divide(d[2], two);
    let quotient = b.g.unary(Elementary::Tanh, quotient);
    let arc = b.g.unary(Elementary::Acos, quotient);
    let grown = b.g.unary(Elementary::Exp, v[0]);
    let side = b.g.abs(v[2]);
    let third = b.c(1.3);
    let stiff = b.g.power(side, third);
    let bent = b.g.power(grown, quotient);
    let looked = b.g.table(table, &[d[1]]);
    let lower = b.g.less_equal(d[1], d[2]);
    let fast = b.g.less(v[0], v[1]);
    let same = b.g.equal(v[0], v[2]);
    let not = b.g.not(same);
    let both = b.g.and(lower, fast);
    let any = b.g.or(both, not);
    let picked = b.g.select(any, bent, looked);
    let only = b.g.select(both, looked, y1);
    let fx = b.g.add(pull, a2);
    let fy = b.g.multiply(arc, stiff);
    let fz = b.g.add(picked, only);
    let fz = b.g.multiply(fz, y0);
    let force = b.inertial([fx, fy, fz], 1);
    let opposite = b.negative(force);
    let moment = b.cross(e, opposite);
    let moment = b.local(moment, 1);
    let r0 = b.g.subtract(d[0], y0);
    let p = b.g.multiply(y0, y1);
    let r1 = b.g.add(p, v[1]);
    let r1 = b.g.maximum(r1, y1);
    let loads = vec![
        [force[0], force[1], force[2], zero, zero, zero],
        [
            opposite[0],
            opposite[1],
            opposite[2],
            moment[0],
            moment[1],
            moment[2],
        ],
    ];
    b.body("Bushing", vec![], loads, vec![r0, r1], vec![fx, fy, fz])
}

pub fn tables() -> Vec<Table> {
    let x: Vec<f64> = (0..12)
        .map(|i| f64::from(i) * core::f64::consts::TAU / 12.0)
        .collect();
    let y: Vec<f64> = x
        .iter()
        .map(|x| 0.3 + 0.1 * libm::sin(*x) + 0.02 * libm::cos(3.0 * x))
        .collect();
    let period = Some(core::f64::consts::TAU);
    let ramp = vec![-1.0, -0.3, 0.1, 0.9, 2.0];
    let values = vec![0.0, 0.5, 0.4, 2.0, 2.5];
    vec![
        Table::new("lift", x, y, Interpolation::Cubic, None, period).expect("valid points"),
        Table::new(
            "ramp",
            ramp,
            values,
            Interpolation::Cubic,
            Some(Extrapolation::Linear),
            None,
        )
        .expect("valid points"),
        surface(&[]),
        surface(&[-1.1, -0.2, 0.4, 1.2]),
    ]
}

/// A table with a period in its first argument and mirrors in its second, and a third argument if it has points.
fn surface(third: &[f64]) -> Table {
    use core::f64::consts::{FRAC_PI_2, TAU};
    let argument = |name: &str, points: Vec<f64>, ends| Argument {
        name: name.to_owned(),
        points,
        ends,
    };
    let x: Vec<f64> = (0..9).map(|i| TAU * f64::from(i) / 9.0).collect();
    let y: Vec<f64> = (0..7).map(|i| FRAC_PI_2 * f64::from(i) / 6.0).collect();
    let over = if third.is_empty() { &[0.0] } else { third };
    let mut values = Vec::new();
    for x in &x {
        for y in &y {
            values.extend(over.iter().map(|z| {
                let bend = 0.2 * libm::sin(*x) * libm::cos(3.0 * y) * (1.0 + z * z);
                libm::cos(*y) * (1.0 + 0.3 * libm::cos(*x)) + bend
            }));
        }
    }
    let mut arguments = vec![
        argument("x", x, Ends::Periodic(TAU)),
        argument("y", y, Ends::Each([End::Even, End::Odd])),
    ];
    if !third.is_empty() {
        let ends = Ends::Each([End::Hold, End::Linear]);
        arguments.push(argument("z", third.to_vec(), ends));
    }
    Table::grid("surface", arguments, values).expect("a grid")
}

/// Splitmix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// A number evenly distributed in (−1, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    pub fn rotation(&mut self) -> [f64; 9] {
        let v = [self.unit(), self.unit(), self.unit()].map(|x| 3.0 * x);
        rotation(v)
    }
}

/// exp(v~), row-major (Rodrigues).
pub fn rotation(v: [f64; 3]) -> [f64; 9] {
    let angle = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let (s, c) = if angle < 1e-4 {
        let q = angle * angle;
        (
            1.0 - q / 6.0 + q * q / 120.0,
            0.5 - q / 24.0 + q * q / 720.0,
        )
    } else {
        let half = libm::sin(0.5 * angle);
        (
            libm::sin(angle) / angle,
            2.0 * half * half / (angle * angle),
        )
    };
    let w = [0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0];
    let ww = product(&w, &w);
    let mut r = [0.0; 9];
    for i in 0..9 {
        r[i] = s * w[i] + c * ww[i] + if i % 4 == 0 { 1.0 } else { 0.0 };
    }
    r
}

pub fn product(a: &[f64; 9], b: &[f64; 9]) -> [f64; 9] {
    let mut r = [0.0; 9];
    for i in 0..3 {
        for j in 0..3 {
            r[3 * i + j] = (0..3).map(|k| a[3 * i + k] * b[3 * k + j]).sum();
        }
    }
    r
}

/// Random inputs of a layout (one lane). `film` keeps the pin inside the clearance of 0.1 m.
pub fn state(layout: &InputLayout, random: &mut Random, film: bool) -> Vec<f64> {
    let mut s: Vec<f64> = (0..layout.outputs_len()).map(|_| random.unit()).collect();
    for marker in 0..layout.markers {
        let m = layout.marker(marker) as usize;
        s[m + 3..m + 12].copy_from_slice(&random.rotation());
    }
    if film {
        let (a, b) = (layout.marker(0) as usize, layout.marker(1) as usize);
        let eccentricity = 0.045 * (1.0 + random.unit());
        let angle = 3.2 * random.unit();
        let d = [
            eccentricity * libm::cos(angle),
            eccentricity * libm::sin(angle),
            0.01 * random.unit(),
        ];
        for i in 0..3 {
            s[a + i] = s[b + i] + (0..3).map(|k| s[b + 3 + 3 * i + k] * d[k]).sum::<f64>();
        }
    }
    s
}

pub struct Case {
    pub name: &'static str,
    pub build: fn(bool) -> ClassBody,
    /// Sets constants.
    pub prepare: fn(&InputLayout, &mut [f64]),
    pub film: bool,
}

pub fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "Revolute",
            build: revolute,
            prepare: |_, _| {},
            film: false,
        },
        Case {
            name: "Cam",
            build: cam,
            prepare: |l, s| {
                s[l.constant(0) as usize] = 2.5;
                s[l.constant(1) as usize] = 0.7;
                s[l.constant(2) as usize] = 0.0;
            },
            film: false,
        },
        Case {
            name: "Film",
            build: film,
            prepare: |l, s| {
                s[l.constant(0) as usize] = 0.1;
                s[l.constant(1) as usize] = 3.0;
            },
            film: true,
        },
        Case {
            name: "Bushing",
            build: bushing,
            prepare: |l, s| {
                s[l.constant(0) as usize] = 5.0;
                s[l.constant(1) as usize] = 1.0;
            },
            film: false,
        },
    ]
}

impl Case {
    pub fn state(&self, layout: &InputLayout, random: &mut Random) -> Vec<f64> {
        let mut s = state(layout, random, self.film);
        (self.prepare)(layout, &mut s);
        s
    }
}

/// Calls a function; lane 0 of the result.
pub fn call(
    code: &dyn ElementCode,
    function: Function,
    inputs: &[f64],
    tables: &[Table],
) -> Vec<f64> {
    let inputs: Vec<Pair> = inputs.iter().map(|x| [*x, *x]).collect();
    let mut outputs = vec![[f64::NAN; 2]; code.shape(function).1];
    assert!(code.call(function, &inputs, &mut outputs, tables));
    outputs.iter().map(|p| p[0]).collect()
}
