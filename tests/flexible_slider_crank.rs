//! The slider-crank with an elastic connecting rod of the literature: the rod as a beam of finite elements in
//! the multibody model, against the published equations, whose integration here is held to the published
//! figures.

use crate::support::{outcome, program_of};
use eng::Results;
use nalgebra::{Matrix4, SMatrix, SVector, Vector4};
use serde_json::Value;
use std::f64::consts::PI;
use std::fmt::Write;

fn reference() -> Value {
    serde_json::from_str(include_str!("reference/flexible_slider_crank.json")).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn four(value: &Value) -> Vector4<f64> {
    Vector4::from_fn(|i, _| number(&value[i]))
}

/// The mechanism's constants (SI).
#[derive(Clone, Copy)]
struct Mechanism {
    crank_inertia: f64,
    rod_mass: f64,
    rod_inertia: f64,
    slider_mass: f64,
    throw: f64,
    length: f64,
    side: f64,
    young: f64,
    density: f64,
    speed: f64,
}

impl Mechanism {
    fn new(reference: &Value) -> Mechanism {
        let get = |key: &str| number(&reference["parameters"][key]);
        assert_eq!(get("B"), get("H"));
        Mechanism {
            crank_inertia: get("J1"),
            rod_mass: get("M2"),
            rod_inertia: get("J2"),
            slider_mass: get("M3"),
            throw: get("L1"),
            length: get("L2"),
            side: get("B"),
            young: get("E"),
            density: get("rho"),
            speed: get("Omega"),
        }
    }
}

/// Rod angle (rad), place of the slider (m), amplitudes of both sines and displacements along the rod (m).
#[derive(Clone, Copy, Debug)]
struct Place {
    angle: f64,
    slider: f64,
    q: Vector4<f64>,
}

/// Mass of the quadratic element along the rod, middle, middle with end, end, of the rod's mass:
/// `∫ N_i N_j dx/L`; and as the published equations have it, without the division by 15.
const CONSISTENT: [f64; 3] = [8.0 / 15.0, 1.0 / 15.0, 2.0 / 15.0];
const PUBLISHED: [f64; 3] = [8.0, 1.0, 2.0];

/// Simeon's equations: the rod's deflection by two sines, its stretch by a quadratic element (middle and
/// end), seen from the line through crank pin and slider.
struct Simeon {
    m: Mechanism,
    /// The strain energy is `EA/2 ∫ (u' + ½ w'²)² dx`. The published equations have its product of stretch and slope
    /// squared, and leave out the fourth power of the slope. Without this power the shortening of a bent rod counts
    /// as pressure in it. Here the power is included, as far as stretches that the quadratic element does not have do
    /// not even it out along the rod.
    stiffened: bool,
    /// Damping matrix over stiffness matrix (s).
    damping: f64,
    mass: Matrix4<f64>,
    stiffness: Matrix4<f64>,
    /// B, and c1, c2, c12, c21 of the paper.
    gyroscopic: Matrix4<f64>,
    along: Vector4<f64>,
    across: Vector4<f64>,
    along_arm: Vector4<f64>,
    across_arm: Vector4<f64>,
}

impl Simeon {
    fn new(m: Mechanism, stiffened: bool, axial_mass: [f64; 3]) -> Simeon {
        let (area, slender) = (m.side * m.side, m.side / m.length);
        let volume = area * m.length;
        let mut mass = Matrix4::zeros();
        mass[(0, 0)] = 0.5;
        mass[(1, 1)] = 0.5;
        let mut stiffness = Matrix4::zeros();
        stiffness[(0, 0)] = PI.powi(4) / 24.0 * slender * slender;
        stiffness[(1, 1)] = PI.powi(4) * 2.0 / 3.0 * slender * slender;
        for (matrix, [middle, mixed, end]) in [
            (&mut mass, axial_mass),
            (&mut stiffness, [16.0 / 3.0, -8.0 / 3.0, 7.0 / 3.0]),
        ] {
            matrix[(2, 2)] = middle;
            matrix[(2, 3)] = mixed;
            matrix[(3, 2)] = mixed;
            matrix[(3, 3)] = end;
        }
        let mut gyroscopic = Matrix4::zeros();
        for (i, j, x) in [
            (0, 2, -16.0 / PI.powi(3)),
            (0, 3, 8.0 / PI.powi(3) - 1.0 / PI),
            (1, 3, 0.5 / PI),
        ] {
            gyroscopic[(i, j)] = x;
            gyroscopic[(j, i)] = -x;
        }
        Simeon {
            m,
            stiffened,
            damping: 0.0,
            mass: mass * (m.density * volume),
            stiffness: stiffness * (m.young * area / m.length),
            gyroscopic: gyroscopic * volume,
            along: Vector4::new(0.0, 0.0, 2.0 / 3.0, 1.0 / 6.0) * volume,
            across: Vector4::new(2.0 / PI, 0.0, 0.0, 0.0) * volume,
            along_arm: Vector4::new(0.0, 0.0, 1.0 / 3.0, 1.0 / 6.0) * (volume * m.length),
            across_arm: Vector4::new(1.0 / PI, -0.5 / PI, 0.0, 0.0) * (volume * m.length),
        }
    }

    /// Angles and slider that the constraints give.
    fn place(&self, time: f64, q: &Vector4<f64>) -> Place {
        let crank = self.m.speed * time;
        let length = self.m.length + q[3];
        let angle = -(self.m.throw * crank.sin() / length).asin();
        Place {
            angle,
            slider: self.m.throw * crank.cos() + length * angle.cos(),
            q: *q,
        }
    }

    /// q̈ (m/s²), from the equations of motion with their three constraints.
    fn acceleration(&self, time: f64, q: &Vector4<f64>, rate: &Vector4<f64>) -> Vector4<f64> {
        let m = &self.m;
        let (throw, density) = (m.throw, m.density);
        let (first, length) = (m.speed * time, m.length + q[3]);
        let second = self.place(time, q).angle;
        let (s1, c1, s2, c2) = (first.sin(), first.cos(), second.sin(), second.cos());
        let (s, c) = ((first - second).sin(), (first - second).cos());
        let w1 = m.speed;
        let w2 = -(throw * c1 * w1 + rate[3] * s2) / (length * c2);

        let mut a = SMatrix::<f64, 10, 10>::zeros();
        let mut f = SVector::<f64, 10>::zeros();
        a[(0, 0)] = m.crank_inertia + m.rod_mass * throw * throw;
        a[(0, 1)] = 0.5 * throw * m.length * m.rod_mass * c
            + density * throw * (s * self.across.dot(q) + c * self.along.dot(q));
        a[(1, 0)] = a[(0, 1)];
        a[(1, 1)] = m.rod_inertia + q.dot(&(self.mass * q)) + 2.0 * density * self.along_arm.dot(q);
        a[(2, 2)] = m.slider_mass;
        let by_crank = (self.across * c - self.along * s) * (density * throw);
        let by_rod = (self.across_arm + self.gyroscopic.transpose() * q) * density;
        for i in 0..4 {
            for (row, x) in [(0, by_crank[i]), (1, by_rod[i])] {
                a[(row, 3 + i)] = x;
                a[(3 + i, row)] = x;
            }
            for j in 0..4 {
                a[(3 + i, 3 + j)] = self.mass[(i, j)];
            }
        }
        let half = 0.5 * throw * m.length * m.rod_mass;
        f[0] = -half * w2 * w2 * s
            + density * throw * w2 * w2 * (c * self.across.dot(q) - s * self.along.dot(q))
            - 2.0 * density * throw * w2 * (c * self.along.dot(rate) + s * self.across.dot(rate));
        f[1] = half * w1 * w1 * s
            + density * throw * w1 * w1 * (s * self.along.dot(q) - c * self.across.dot(q))
            - 2.0 * density * w2 * self.along_arm.dot(rate)
            - 2.0 * w2 * rate.dot(&(self.mass * q));
        let centrifugal = self.along_arm * (w2 * w2)
            + (self.along * c + self.across * s) * (throw * w1 * w1)
            + self.gyroscopic * rate * (2.0 * w2);
        let mut elastic = self.mass * q * (w2 * w2) + centrifugal * density
            - self.stiffness * (q + rate * self.damping);
        if self.stiffened {
            let factor = 0.5 * m.young * m.side * m.side * PI * PI / (m.length * m.length);
            let share = 80.0 / (9.0 * PI * PI);
            let uneven = -4.0 * q[2] + 2.0 * q[3];
            elastic -= Vector4::new(
                q[0] * q[3] - share * q[1] * uneven,
                4.0 * q[1] * q[3] - share * q[0] * uneven,
                4.0 * share * q[0] * q[1],
                0.5 * q[0] * q[0] + 2.0 * q[1] * q[1] - 2.0 * share * q[0] * q[1],
            ) * factor;
            // ∂/∂q of EAL/8 (C² + D²), C and D the mean and the uneven part of the slope squared
            let bend = PI * PI / (m.length * m.length);
            let uneven_bend = 80.0 * 3f64.sqrt() / (9.0 * m.length * m.length);
            let mean = bend * (0.5 * q[0] * q[0] + 2.0 * q[1] * q[1]);
            let skew = uneven_bend * q[0] * q[1];
            let stretch = 0.25 * m.young * m.side * m.side * m.length;
            elastic[0] -= stretch * (mean * bend * q[0] + skew * uneven_bend * q[1]);
            elastic[1] -= stretch * (mean * bend * 4.0 * q[1] + skew * uneven_bend * q[0]);
        }
        f.fixed_rows_mut::<4>(3).copy_from(&elastic);
        // constraints: the slider stays on its line, at the rod's end; the crank turns
        for (column, x) in [(0, throw * c1), (1, length * c2), (6, s2)] {
            a[(7, column)] = x;
            a[(column, 7)] = x;
        }
        for (column, x) in [(0, throw * s1), (1, length * s2), (2, 1.0), (6, -c2)] {
            a[(8, column)] = x;
            a[(column, 8)] = x;
        }
        a[(9, 0)] = 1.0;
        a[(0, 9)] = 1.0;
        f[7] = throw * s1 * w1 * w1 + length * s2 * w2 * w2 - 2.0 * c2 * rate[3] * w2;
        f[8] = -throw * c1 * w1 * w1 - length * c2 * w2 * w2 - 2.0 * s2 * rate[3] * w2;
        let found = a.lu().solve(&f).expect("regular");
        Vector4::new(found[3], found[4], found[5], found[6])
    }

    /// Places every `sample` seconds from 0, by the classical Runge–Kutta method.
    fn run(
        &self,
        mut q: Vector4<f64>,
        mut v: Vector4<f64>,
        sample: f64,
        count: usize,
    ) -> Vec<Place> {
        const STEPS: usize = 1000;
        let h = sample / STEPS as f64;
        let mut places = vec![self.place(0.0, &q)];
        for k in 0..count * STEPS {
            let t = k as f64 * h;
            let a1 = self.acceleration(t, &q, &v);
            let v2 = v + a1 * (0.5 * h);
            let a2 = self.acceleration(t + 0.5 * h, &(q + v * (0.5 * h)), &v2);
            let v3 = v + a2 * (0.5 * h);
            let a3 = self.acceleration(t + 0.5 * h, &(q + v2 * (0.5 * h)), &v3);
            let v4 = v + a3 * h;
            let a4 = self.acceleration(t + h, &(q + v3 * h), &v4);
            q += (v + v2 * 2.0 + v3 * 2.0 + v4) * (h / 6.0);
            v += (a1 + a2 * 2.0 + a3 * 2.0 + a4) * (h / 6.0);
            if (k + 1) % STEPS == 0 {
                places.push(self.place((k + 1) as f64 * h, &q));
            }
        }
        places
    }
}

/// Our integration of the equations, with their mass along the rod, gives the published state.
#[test]
fn the_published_equations_give_the_published_figures() {
    let reference = reference();
    let simeon = Simeon::new(Mechanism::new(&reference), false, PUBLISHED);
    let initial = &reference["initial"];
    let places = simeon.run(four(&initial["q"]), four(&initial["rate"]), 1e-3, 100);
    let last = places.last().expect("a place");
    let published = &reference["at_0.1_s"];
    // the published run took π with eight digits, and its slider starts where nine digits put it: 2e-10 m off
    for (name, found, tolerance) in [
        ("phi2", last.angle, 1e-10),
        ("x3", last.slider, 3e-10),
        ("q1", last.q[0], 1e-10),
        ("q2", last.q[1], 1e-10),
        ("q3", last.q[2], 1e-10),
        ("q4", last.q[3], 1e-10),
    ] {
        let wanted = number(&published[name]);
        println!("{name}: {found:.12e}, published {wanted:.12e}");
        assert!(
            (found - wanted).abs() < tolerance,
            "{name}: {found} {wanted}"
        );
    }
}

/// The rod as 24 beams along x that neither shear nor have inertia of their sections, as in the published equations.
fn deck(m: &Mechanism) -> String {
    let pieces = 24;
    let (area, moment) = (m.side * m.side, m.side.powi(4) / 12.0);
    let mut deck = format!(
        "BEGIN BULK\nMAT1,1,{:e},,0.3,0.\nPBAR,1,1,{area:.9e},{moment:.9e},{moment:.9e},{:.9e},{:.9e}\nGRID,1,,0.,0.,0.\n",
        m.young,
        1.69 * moment,
        m.density * area
    );
    for piece in 1..=pieces {
        let x = m.length * f64::from(piece) / f64::from(pieces);
        writeln!(deck, "GRID,{},,{x:.9},0.,0.", piece + 1).expect("a line");
        writeln!(deck, "CBAR,{piece},1,{piece},{},0.,0.,1.", piece + 1).expect("a line");
    }
    // about its axis the rod would have no inertia
    for node in 1..=pieces + 1 {
        write!(deck, "CONM2,{},{node},,1.e-9\n,4.e-8\n", 100 + node).expect("lines");
    }
    deck + "ENDDATA\n"
}

/// Damping over stiffness (s) of both from rest. The start makes the stretch ring at 3 kHz; this has decayed after a
/// millisecond, and the bending keeps ringing.
const DAMPING: f64 = 1e-5;

fn text(m: &Mechanism, stiffened: bool) -> String {
    format!(
        "use std.joints.{{Revolute, PointOnLine, Translational}}
         use std.drives.ConstantSpeed
         model SliderCrank {{
             gravity = [0, 0, 0] m/s^2
             marker rail = at([0, 0, 0] mm, z: [1, 0, 0])
             body crank {{
                 mass = 0.36 kg
                 inertia = [1, 1, {crank}] kg*m^2
                 marker pin = [{throw}, 0, 0] m
             }}
             flexible rod {{
                 mesh = nastran(\"m.bdf\", units: m_kg_s)
                 modes = constraint(at: [big, small]) + normal(16, fixed: [big, small])
                 damping = rayleigh(mass: 0 s^-1, stiffness: {DAMPING:e} s)
                 geometric_stiffness = {stiffened}
                 marker big = node(1)
                 marker quarter = node(7)
                 marker middle = node(13)
                 marker last = node(19)
                 marker small = node(25)
                 start position = [{throw}, 0, 0] m
             }}
             body slider {{
                 mass = {slider} kg
                 inertia = [1, 1, 1] g*m^2
                 marker slide = at(origin, z: [1, 0, 0])
             }}
             drive turn = ConstantSpeed(crank.origin, ground, speed: {speed} rad/s)
             joint big_end = Revolute(rod.big, crank.pin)
             joint small_end = PointOnLine(rod.small, slider.origin)
             joint guide = Translational(slider.slide, rail)
             output big = rod.big.origin - ground.origin in ground
             output quarter = rod.quarter.origin - ground.origin in ground
             output middle = rod.middle.origin - ground.origin in ground
             output last = rod.last.origin - ground.origin in ground
             output small = rod.small.origin - ground.origin in ground
         }}
         analysis turn = transient(SliderCrank(), duration: 100 ms, sample: 1 ms, step: 5 us, rho: 0.9, start: assembled)",
        crank = m.crank_inertia,
        throw = m.throw,
        slider = m.slider_mass,
        speed = m.speed,
    )
}

/// The rod's places every millisecond, read from its markers.
fn run(m: &Mechanism, stiffened: bool) -> Vec<Place> {
    let program = program_of(&[("m.eng", &text(m, stiffened)), ("m.bdf", &deck(m))]);
    let outcome = outcome(&program, "turn");
    let energy = outcome.summary.expect("a summary").energy;
    println!("energy: {:e} of {:e} J", energy.imbalance(), energy.kinetic);
    let results: Results = outcome.results;
    let column = |name: &str, axis: &str| {
        let path = format!("{name}.{axis}");
        let found = results.column(&path);
        found
            .unwrap_or_else(|| panic!("no column {path}"))
            .values
            .clone()
    };
    let markers = ["big", "quarter", "middle", "last", "small"]
        .map(|name| [column(name, "x"), column(name, "y")]);
    (0..markers[0][0].len())
        .map(|k| {
            let [big, quarter, middle, last, small] =
                std::array::from_fn(|i| [markers[i][0][k], markers[i][1][k]]);
            let chord = [small[0] - big[0], small[1] - big[1]];
            let length = chord[0].hypot(chord[1]);
            let direction = chord.map(|x| x / length);
            let seen = |p: [f64; 2]| {
                let d = [p[0] - big[0], p[1] - big[1]];
                [
                    d[0] * direction[0] + d[1] * direction[1],
                    d[1] * direction[0] - d[0] * direction[1],
                ]
            };
            let [a, b, c] = [quarter, middle, last].map(|p| seen(p)[1]);
            Place {
                angle: direction[1].atan2(direction[0]),
                slider: small[0],
                // the third sine goes out of the first
                q: Vector4::new(
                    0.5 * (b + (a + c) / 2f64.sqrt()),
                    0.5 * (a - c),
                    seen(middle)[0] - 0.5 * m.length,
                    length - m.length,
                ),
            }
        })
        .collect()
}

/// Largest difference and largest size of a number of all places.
fn compare(found: &[Place], wanted: &[Place], get: impl Fn(&Place) -> f64) -> (f64, f64) {
    assert_eq!(found.len(), wanted.len());
    let pairs = found.iter().zip(wanted);
    pairs.fold((0.0, 0.0), |(worst, size): (f64, f64), (a, b)| {
        (worst.max((get(a) - get(b)).abs()), size.max(get(b).abs()))
    })
}

/// Some turns from rest against the published equations with the element's own mass along the rod, without
/// and with the stiffening by the rod's force, which changes the bending by a tenth.
#[test]
fn an_elastic_rod_moves_as_the_published_equations_say() {
    let m = Mechanism::new(&reference());
    let rest = Vector4::zeros();
    let wanted = [false, true].map(|stiffened| {
        Simeon {
            damping: DAMPING,
            ..Simeon::new(m, stiffened, CONSISTENT)
        }
        .run(rest, rest, 1e-3, 100)
    });
    let (apart, size) = compare(&wanted[0], &wanted[1], |p| p.q[0]);
    println!("stiffening changes the bending by {:.2}", apart / size);
    assert!(apart > 0.1 * size, "{apart} {size}");
    for (stiffened, wanted) in [false, true].into_iter().zip(&wanted) {
        let found = run(&m, stiffened);
        for (name, share, get) in [
            ("angle", 1e-5, (|p| p.angle) as fn(&Place) -> f64),
            ("slider", 1e-5, |p| p.slider),
            ("q1", 0.01, |p| p.q[0]),
            ("q2", 0.05, |p| p.q[1]),
            ("q4", 0.05, |p| p.q[3]),
        ] {
            let (worst, size) = compare(&found, wanted, get);
            println!(
                "{stiffened} {name}: {worst:.2e} of {size:.2e}, {:.1e}",
                worst / size
            );
            assert!(worst < share * size, "{stiffened} {name}: {worst} {size}");
        }
    }
}
