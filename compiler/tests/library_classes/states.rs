//! Random states of an instance, and motions from them in numbers of twice the precision.

use super::catalogue::Poses;
use super::double::Double;
use super::evaluate::nearest_kink;
use super::instance::Instance;
use crate::support::{Random, product, rotation};
use eng_system::layout::InputLayout;
use eng_system::system::BodyRef;
use std::collections::BTreeMap;

/// Least relative distance from a kink for a comparison.
const KINK: f64 = 1e-4;

/// Pose and twist: x, R (row-major), ẋ, ω in own axes.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    pub x: [f64; 3],
    pub r: [f64; 9],
    pub v: [f64; 3],
    pub w: [f64; 3],
}

pub fn turned(r: &[f64; 9], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|k| r[3 * i + k] * v[k]).sum())
}

pub fn turned_back(r: &[f64; 9], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|k| r[3 * k + i] * v[k]).sum())
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

impl Motion {
    const REST: Motion = Motion {
        x: [0.0; 3],
        r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        v: [0.0; 3],
        w: [0.0; 3],
    };

    fn random(random: &mut Random) -> Motion {
        let mut three = |size: f64| [0; 3].map(|_| size * random.unit());
        let (x, v, w) = (three(0.5), three(5.0), three(150.0));
        Motion {
            x,
            r: random.rotation(),
            v,
            w,
        }
    }

    /// The part of the motion in the plane z = 0 of the ground, at a random angle.
    fn in_plane(&self, random: &mut Random) -> Motion {
        Motion {
            x: [self.x[0], self.x[1], 0.0],
            r: rotation([0.0, 0.0, 3.0 * random.unit()]),
            v: [self.v[0], self.v[1], 0.0],
            w: [0.0, 0.0, self.w[2]],
        }
    }

    /// The motion of a frame at a place of the body.
    fn of_place(&self, position: [f64; 3], orientation: &[f64; 9]) -> Motion {
        let spin = cross(self.w, position);
        Motion {
            x: plus(self.x, turned(&self.r, position)),
            r: product(&self.r, orientation),
            v: plus(self.v, turned(&self.r, spin)),
            w: turned_back(orientation, self.w),
        }
    }

    /// A pin in this shell: eccentricity ratio up to 0.95, tilted by up to a milliradian, with its own small velocity.
    fn pin_within(&self, clearance: f64, random: &mut Random) -> Motion {
        let ratio = 0.95 * random.unit().abs().sqrt();
        let angle = std::f64::consts::PI * random.unit();
        let place = [
            ratio * clearance * libm::cos(angle),
            ratio * clearance * libm::sin(angle),
            2e-3 * random.unit(),
        ];
        let tilt = [1e-3 * random.unit(), 1e-3 * random.unit(), 0.0];
        let turn = [0.0, 0.0, 3.0 * random.unit()];
        let seat = self.of_place(place, &product(&rotation(tilt), &rotation(turn)));
        let mut three = |size: f64| [0; 3].map(|_| size * random.unit());
        let (slip, spin) = (three(0.02), three(1.0));
        let faster = 400.0 * random.unit();
        Motion {
            v: plus(seat.v, turned(&self.r, slip)),
            w: plus(seat.w, [spin[0], spin[1], faster]),
            ..seat
        }
    }

    fn write(&self, inputs: &mut [f64], at: usize) {
        inputs[at..at + 3].copy_from_slice(&self.x);
        inputs[at + 3..at + 12].copy_from_slice(&self.r);
        inputs[at + 12..at + 15].copy_from_slice(&self.v);
        inputs[at + 15..at + 18].copy_from_slice(&self.w);
    }

    pub fn read(inputs: &[f64], at: usize) -> Motion {
        let mut m = Motion::REST;
        m.x.copy_from_slice(&inputs[at..at + 3]);
        m.r.copy_from_slice(&inputs[at + 3..at + 12]);
        m.v.copy_from_slice(&inputs[at + 12..at + 15]);
        m.w.copy_from_slice(&inputs[at + 15..at + 18]);
        m
    }
}

impl Instance {
    /// Inputs of all functions at a random state, with the further inputs of outputs.
    fn draw(&self, random: &mut Random) -> Vec<f64> {
        let layout = &self.layout;
        let mut inputs = vec![0.0; layout.outputs_len() as usize];
        inputs[InputLayout::TIME as usize] = 0.5 * random.unit();
        let mut bodies: BTreeMap<u32, Motion> = BTreeMap::new();
        for (k, place) in (0..).zip(&self.places) {
            let body = match place.body {
                BodyRef::Ground => Motion::REST,
                BodyRef::Body(b) => *bodies.entry(b).or_insert_with(|| Motion::random(random)),
            };
            let motion = if self.case.poses == Poses::Planar && body.w != [0.0; 3] {
                body.in_plane(random)
            } else {
                body.of_place(place.position, &place.orientation)
            };
            motion.write(&mut inputs, layout.marker(k) as usize);
        }
        if let (Poses::Film(clearance), Some(pin), Some(shell)) =
            (self.case.poses, self.marker("a.m"), self.marker("b.m"))
        {
            let at = |k: usize| layout.marker(k as u32) as usize;
            Motion::read(&inputs, at(shell))
                .pin_within(clearance, random)
                .write(&mut inputs, at(pin));
        }
        let mut fill = |first: u32, count: u32, size: f64| {
            for i in first..first + count {
                inputs[i as usize] = size * random.unit();
            }
        };
        fill(layout.state(0), layout.states, 0.05);
        fill(layout.multiplier(0), layout.rows, 500.0);
        fill(layout.rotation(0), layout.rotations, 20.0);
        // numbers that a kernel could give: the classes contain none of its equations
        fill(layout.answer(0), layout.answers, 300.0);
        fill(layout.reading(0), layout.readings, 300.0);
        fill(
            layout.acceleration(0),
            layout.outputs_len() - layout.len(),
            300.0,
        );
        for (i, x) in (0..).zip(&self.constants) {
            inputs[layout.constant(i) as usize] = *x;
        }
        inputs
    }

    /// A random state away from the kinks of all differentiated values.
    pub fn state(&self, random: &mut Random) -> Vec<f64> {
        for _ in 0..200 {
            let inputs = self.draw(random);
            if self.is_smooth(&inputs) {
                return inputs;
            }
        }
        panic!("{}: no smooth state found", self.case.class)
    }

    /// A random state in which a's axes are turned about b.z alone.
    pub fn aligned_state(&self, random: &mut Random) -> Vec<f64> {
        let (Some(a), Some(b)) = (self.marker("a.m"), self.marker("b.m")) else {
            panic!("{}: two markers are needed", self.case.class)
        };
        loop {
            let mut inputs = self.draw(random);
            let at = |k: usize| self.layout.marker(k as u32) as usize;
            let reference = Motion::read(&inputs, at(b));
            let mut moving = Motion::read(&inputs, at(a));
            moving.r = product(&reference.r, &rotation([0.0, 0.0, 3.0 * random.unit()]));
            moving.write(&mut inputs, at(a));
            if self.is_smooth(&inputs) {
                return inputs;
            }
        }
    }

    fn is_smooth(&self, inputs: &[f64]) -> bool {
        let doubles = doubles(inputs);
        [&self.functions.residual, &self.functions.velocity]
            .iter()
            .all(|f| nearest_kink(f, &doubles, &self.tables) > KINK)
    }

    /// Natural sizes of the pose and twist directions of a marker: length, angle, velocity, angular velocity.
    fn scales(&self) -> [f64; 4] {
        match self.case.poses {
            Poses::Any | Poses::Planar => [0.1, 1.0, 1.0, 100.0],
            Poses::Film(clearance) => [clearance, 1.0, 1e-2, 100.0],
        }
    }

    /// The size of a direction of the layout.
    pub fn scale(&self, direction: u32) -> f64 {
        let [length, angle, velocity, spin] = self.scales();
        let poses = 6 * self.layout.markers;
        let turn = direction % 6 >= 3;
        match (direction < poses, direction < 2 * poses) {
            (true, _) => [length, angle][usize::from(turn)],
            (_, true) => [velocity, spin][usize::from(turn)],
            _ => 0.01,
        }
    }

    /// The state after a step along a direction of the layout, on the manifold.
    pub fn moved(&self, state: &[Double], direction: u32, step: Double) -> Vec<Double> {
        let layout = &self.layout;
        let mut s = state.to_vec();
        let poses = 6 * layout.markers;
        if direction >= 2 * poses {
            let place = match direction.checked_sub(layout.answer_direction(0)) {
                Some(answer) => layout.answer(answer),
                None => layout.state(direction - 2 * poses),
            } as usize;
            s[place] = s[place] + step;
            return s;
        }
        let at = layout.marker(direction % poses / 6) as usize;
        let axis = (direction % 6) as usize;
        if direction < poses && axis >= 3 {
            let mut turn = [Double::ZERO; 3];
            turn[axis - 3] = step;
            turn_marker(&mut s[at..], turn);
        } else {
            let place = at + axis + if direction < poses { 0 } else { 12 };
            s[place] = s[place] + step;
        }
        s
    }

    /// Poses and time after t (s) of a motion that has the state's twists at t = 0 and constant accelerations
    /// of the markers: ẍ, and a rotation vector ω t + ω̇ t²/2 in marker axes, whose second rate at t = 0 is
    /// ω̇. States move with their rates.
    pub fn after(
        &self,
        state: &[Double],
        accelerations: &[[f64; 6]],
        rates: &[Double],
        t: Double,
    ) -> Vec<Double> {
        let mut s = state.to_vec();
        s[0] = s[0] + t;
        for (m, acceleration) in (0..).zip(accelerations) {
            let at = self.layout.marker(m) as usize;
            let path = |twist: usize| {
                let second = t * t * Double::from(0.5 * acceleration[twist]);
                t * state[at + 12 + twist] + second
            };
            for i in 0..3 {
                s[at + i] = s[at + i] + path(i);
            }
            turn_marker(&mut s[at..], [path(3), path(4), path(5)]);
        }
        for (i, rate) in (0..).zip(rates) {
            let place = self.layout.state(i) as usize;
            s[place] = s[place] + t * *rate;
        }
        s
    }
}

pub fn doubles(inputs: &[f64]) -> Vec<Double> {
    inputs.iter().map(|x| Double::from(*x)).collect()
}

/// R ← R exp(θ~) of a marker's inputs, θ below 1 rad.
fn turn_marker(marker: &mut [Double], v: [Double; 3]) {
    let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    // sin θ/θ and (1 − cos θ)/θ² by their series
    let (mut s, mut c) = (Double::ZERO, Double::ZERO);
    for k in (1..=14).rev() {
        let k = f64::from(2 * k);
        s = (Double::ONE + s) * -square / (k * (k + 1.0)).into();
        c = (Double::ONE + c) * -square / ((k + 1.0) * (k + 2.0)).into();
    }
    let (s, c) = (s + Double::ONE, (c + Double::ONE) * 0.5.into());
    let [x, y, z] = v;
    let o = Double::ZERO;
    let skew = [[o, -z, y], [z, o, -x], [-y, x, o]];
    let turn = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let second = v[i] * v[j] - if i == j { square } else { o };
            let one = if i == j { Double::ONE } else { o };
            one + s * skew[i][j] + c * second
        })
    });
    let r: Vec<Double> = marker[3..12].to_vec();
    for i in 0..3 {
        for j in 0..3 {
            marker[3 + 3 * i + j] =
                r[3 * i] * turn[0][j] + r[3 * i + 1] * turn[1][j] + r[3 * i + 2] * turn[2][j];
        }
    }
}

/// The derivative of f at 0: central differences with h and h/2, Richardson's extrapolation.
pub fn slope(h: f64, f: impl Fn(Double) -> Vec<Double>) -> Vec<f64> {
    let central = |h: f64| -> Vec<Double> {
        f(h.into())
            .iter()
            .zip(f((-h).into()))
            .map(|(a, b)| (*a - b) / (2.0 * h).into())
            .collect()
    };
    let (coarse, fine) = (central(h), central(0.5 * h));
    coarse
        .iter()
        .zip(&fine)
        .map(|(c, f)| (*f + (*f - *c) / 3.0.into()).high)
        .collect()
}

/// The second derivative of f at 0 in the same manner.
pub fn curvature(h: f64, f: impl Fn(Double) -> Vec<Double>) -> Vec<f64> {
    let here = f(Double::ZERO);
    let second = |h: f64| -> Vec<Double> {
        f(h.into())
            .iter()
            .zip(f((-h).into()))
            .zip(&here)
            .map(|((a, b), c)| (*a - *c + (b - *c)) / Double::from(h) / h.into())
            .collect()
    };
    let (coarse, fine) = (second(h), second(0.5 * h));
    coarse
        .iter()
        .zip(&fine)
        .map(|(c, f)| (*f + (*f - *c) / 3.0.into()).high)
        .collect()
}
