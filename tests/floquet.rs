//! Modes of motions that repeat, by Floquet's multipliers, against closed forms.

use crate::support::{decay, outcome, program_with_bar as program, refused};
use eng::{Coefficients, LinearModes, Mode, Program};
use nalgebra::{Complex, DMatrix};
use std::f64::consts::{PI, TAU};

fn modes(program: &Program, analysis: &str) -> LinearModes {
    outcome(program, analysis).modes.expect("modes")
}

#[track_caller]
fn near(found: f64, due: f64, tolerance: f64) {
    assert!(
        (found - due).abs() <= tolerance,
        "{found} instead of {due}: {:.1e}",
        found - due
    );
}

/// Distance of two exponents whose imaginary parts count modulo 2π/T, and up to conjugation.
fn apart(a: Complex<f64>, b: Complex<f64>, period: f64) -> f64 {
    let base = TAU / period;
    [b, b.conj()]
        .into_iter()
        .map(|b| {
            let im = (a.im - b.im).rem_euclid(base);
            (a.re - b.re).hypot(im.min(base - im))
        })
        .fold(f64::INFINITY, f64::min)
}

fn error(mode: &Mode) -> f64 {
    mode.repeating.as_ref().expect("of a period").error
}

const TILT: &str = "
    use std.joints.Spherical
    force AxisSpring(a: Marker, b: Marker, k: TorsionalStiffness) {
        apply torque k*1 rad*cross(a.z, b.z) on a against b
    }
    model Rotor {
        param speed: AngularVelocity = 0 rad/s
        param unequal: MomentOfInertia = 0 g*m^2
        gravity = [0, 0, 0] m/s^2
        marker stand = [0, 0, 0] mm
        body disc {
            mass = 5 kg
            inertia = [20 g*m^2 + unequal, 20 g*m^2 - unequal, 36 g*m^2]
            marker hub = origin
            start angular_velocity = [0, 0, 1]*speed
        }
        joint ball = Spherical(disc.hub, stand)
        force support = AxisSpring(disc.hub, stand, k: 800 N*m/rad)
    }
    analysis round[s in [60, 100, 200, 400] rad/s] = linear(Rotor(speed: s), over: 1 rev)
    analysis constant[s in [60, 100, 200, 400] rad/s] = linear(Rotor(speed: s))
    analysis unequal[s in [100, 200, 230, 400] rad/s] = linear(Rotor(speed: s, unequal: 4 g*m^2), over: 1 rev)
    analysis standing = linear(Rotor(), over: 1 rev)
    analysis third = linear(Rotor(speed: 200 rad/s, unequal: 4 g*m^2), over: 0.3 rev)";

/// Whirl of a round disc over 0.3 to 2 times its frequency at rest, `(I_p Ω ± √(I_p² Ω² + 4 I_d k))/2I_d` seen from
/// the ground: multipliers with their branch, as from the eigenvalues of the constant coefficients. The free turn is
/// neutral.
#[test]
fn a_round_disc_whirls_forwards_and_backwards() {
    let program = program(TILT);
    let (transverse, polar, k) = (20e-3_f64, 36e-3_f64, 800.0_f64);
    let at_rest = (k / transverse).sqrt();
    for (index, speed) in [60.0, 100.0, 200.0, 400.0].into_iter().enumerate() {
        let found = modes(&program, &format!("round[{}]", index + 1));
        assert_eq!(found.coefficients, Coefficients::Periodic);
        assert_eq!((found.modes.len(), found.zeros), (2, 2), "{found:?}");
        let half = polar * speed / (2.0 * transverse);
        let root = (half * half + at_rest * at_rest).sqrt();
        for (mode, due) in found.modes.iter().zip([root - half, root + half]) {
            near(mode.value.im, due, 1e-7 * at_rest);
            near(mode.value.re, 0.0, 1e-7 * at_rest);
            assert!(error(mode) < 1e-4 && !mode.grows(), "{mode:?}");
        }
        // backward below, forward above, both round; the fastest body of all turns about +z
        let whirl = |mode: &Mode| mode.repeating.as_ref().and_then(|r| r.harmonics.whirl);
        for (mode, due) in found.modes.iter().zip([-1.0, 1.0]) {
            near(whirl(mode).expect("a sense"), due, 1e-6);
        }
        let exact = modes(&program, &format!("constant[{}]", index + 1));
        assert_eq!(exact.coefficients, Coefficients::Constant);
        for (mode, due) in found.modes.iter().zip(&exact.modes) {
            near(mode.value.im, due.value.im, 1e-7 * at_rest);
            for (share, due) in mode.shares.kinetic.iter().zip(&due.shares.kinetic) {
                near(*share, *due, 1e-6);
            }
        }
    }
    assert!(refused(&program, "standing").contains("no body turns"));
}

/// A disc of unequal inertia: in axes that turn with it, `I₁(φ̈₁ − Ωφ̇₂) + (I₃ − I₂)Ω(φ̇₂ + Ωφ₁) + kφ₁ = 0` and the
/// other equations have constant coefficients, and the multipliers of a turn are those of the ground. Coefficients
/// frozen in the ground would give others.
#[test]
fn a_disc_of_unequal_inertia() {
    let program = program(TILT);
    let (a, b, c, k) = (24e-3_f64, 16e-3_f64, 36e-3_f64, 800.0_f64);
    let mut unstable = 0;
    for (index, w) in [100.0_f64, 200.0, 230.0, 400.0].into_iter().enumerate() {
        let found = modes(&program, &format!("unequal[{}]", index + 1));
        let rows = [
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [-((c - b) * w * w + k) / a, 0.0, 0.0, w - (c - b) * w / a],
            [0.0, -((c - a) * w * w + k) / b, -w - (a - c) * w / b, 0.0],
        ];
        let matrix = DMatrix::from_fn(4, 4, |i, j| rows[i][j]);
        let due = matrix.complex_eigenvalues();
        let period = TAU / w;
        assert_eq!(found.zeros, 2, "{found:?}");
        assert!(!found.modes.is_empty());
        for mode in &found.modes {
            let off = due
                .iter()
                .map(|x| apart(mode.value, *x, period))
                .fold(f64::INFINITY, f64::min);
            assert!(off < 1e-5, "{w}: {} {due} {off:e}", mode.value);
        }
        let grows = due.iter().any(|x| x.re > 1e-6);
        assert_eq!(found.modes.iter().any(Mode::grows), grows, "{w}");
        unstable += usize::from(grows);
    }
    println!("unstable at {unstable} of 4 speeds");
    let third = refused(&program, "third");
    assert!(
        third.contains("does not repeat") && third.contains("disc"),
        "{third}"
    );
}

const SHAFT: &str = "
    use std.joints.{ParallelAxes, PointOnPlane}
    use std.drives.PrescribedRotation
    force Shaft(a: Marker, b: Marker, first: Stiffness, second: Stiffness, inner: Damping, outer: Damping) {
        let away = a.origin - b.origin
        let rate = a.velocity - b.velocity
        apply force -first*dot(away, a.x)*a.x - second*dot(away, a.y)*a.y
            - inner*(rate - cross(a.angular_velocity, away)) - outer*rate on a against b
    }
    model Rotor {
        param speed: AngularVelocity = 100 rad/s
        param first: Stiffness = 16200 N/m
        param second: Stiffness = 24200 N/m
        param inner: Damping = 0 N*s/m
        param outer: Damping = 0 N*s/m
        gravity = [0, 0, 0] m/s^2
        marker stand = [0, 0, 0] mm
        body disc { mass = 2 kg; inertia = [1, 1, 2] g*m^2; marker pin = origin }
        joint level = ParallelAxes(disc.pin, stand)
        joint thrust = PointOnPlane(disc.pin, stand)
        drive turn = PrescribedRotation(disc.pin, stand, speed: speed)
        force shaft = Shaft(disc.pin, stand, first: first, second: second, inner: inner, outer: outer)
        output place = dot(disc.pin.origin - stand.origin, ground.x) as mm
    }
    analysis unequal[s in [45, 89.9, 90.1, 100, 109.9, 110.1, 180] rad/s] = linear(Rotor(speed: s), over: 1 rev)
    analysis plain = linear(Rotor(speed: 100 rad/s))
    analysis damped[s in [100, 149.985, 150.015, 200] rad/s] = linear(
        Rotor(speed: s, first: 20000 N/m, second: 20000 N/m, inner: 2 N*s/m, outer: 1 N*s/m), over: 1 rev)";

/// A shaft of unequal bending stiffness (90 and 110 rad/s) in rigid bearings without damping: unstable
/// exactly between its two critical speeds, with the growth of
/// `(λ² + ω_u² − Ω²)(λ² + ω_v² − Ω²) + 4Ω²λ² = 0`.
#[test]
fn an_unequal_shaft_is_unstable_between_its_critical_speeds() {
    let program = program(SHAFT);
    let growths = [
        (45.0, 0.0),
        (89.9, 0.0),
        (90.1, 1.402_910),
        (100.0, 9.950_371),
        (109.9, 1.404_299),
        (110.1, 0.0),
        (180.0, 0.0),
    ];
    for (index, (speed, growth)) in growths.into_iter().enumerate() {
        let found = modes(&program, &format!("unequal[{}]", index + 1));
        let largest = found
            .modes
            .iter()
            .map(|m| m.value.re)
            .fold(f64::NEG_INFINITY, f64::max);
        near(largest, growth, 2e-6);
        assert_eq!(
            found.modes.iter().any(Mode::grows),
            growth > 0.0,
            "{speed}: {:?}",
            found.modes
        );
        // λ² of the closed form
        let (u, v, w) = (8100.0_f64, 12100.0_f64, speed * speed);
        let sum = u + v + 2.0 * w;
        let product = (u - w) * (v - w);
        let root = (0.25 * sum * sum - product).sqrt();
        let due: Vec<Complex<f64>> = [-0.5 * sum + root, -0.5 * sum - root]
            .into_iter()
            .flat_map(|square| {
                let root = Complex::new(square, 0.0).sqrt();
                [root, -root]
            })
            .collect();
        for mode in &found.modes {
            let off = due
                .iter()
                .map(|x| apart(mode.value, *x, TAU / speed))
                .fold(f64::INFINITY, f64::min);
            assert!(off < 2e-6, "{speed}: {} {due:?} {off:e}", mode.value);
        }
    }
    assert!(refused(&program, "plain").contains("disc turns"));
}

/// Damping in the shaft drives whirl above `Ω = ω (1 + c_e/c_i)`: here at 150 rad/s. Growth and decay are found 1e-4
/// beside it, with the exponents of `λ² + (c_i + c_e)/m λ + ω² − iΩ c_i/m = 0`.
#[test]
fn damping_in_the_shaft_has_its_threshold() {
    let program = program(SHAFT);
    for (index, speed) in [100.0, 149.985, 150.015, 200.0].into_iter().enumerate() {
        let found = modes(&program, &format!("damped[{}]", index + 1));
        // m = 2 kg, c_i = 2, c_e = 1 N s/m, ω = 100 rad/s
        let half = Complex::new(0.75, 0.0);
        let root = (half * half - Complex::new(1e4, -speed)).sqrt();
        let due = [-half + root, -half - root];
        assert_eq!(found.modes.len(), 2, "{:?}", found.modes);
        for mode in &found.modes {
            let off = due
                .iter()
                .map(|x| apart(mode.value, *x, TAU / speed))
                .fold(f64::INFINITY, f64::min);
            assert!(off < 1e-6, "{speed}: {} {due:?} {off:e}", mode.value);
            near(mode.value.im, 100.0, 1e-2);
            let harmonics = &mode.repeating.as_ref().expect("of a period").harmonics;
            assert!(harmonics.share > 0.999, "{harmonics:?}");
        }
        assert_eq!(
            found.modes.iter().any(Mode::grows),
            speed > 150.0,
            "{speed}"
        );
    }
}

/// Mathieu's equation, `y″ + (a − 2q cos 2t) y = 0`: exponents from the DLMF's characteristic equation.
#[test]
fn mathieus_equation() {
    let text = "
        use std.joints.Translational
        force Beaten(a: Marker, b: Marker, mean: Stiffness, swing: Stiffness) {
            apply force -(mean - swing*cos(2 rad/s * time))*dot(a.origin - b.origin, b.z)*b.z on a against b
        }
        model Mathieu {
            param mean: Stiffness = 1 N/m
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body block { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
            joint rail = Translational(block.eye, wall)
            force spring = Beaten(block.eye, wall, mean: mean, swing: 1 N/m)
        }
        analysis one = linear(Mathieu(), over: 3.141592653589793 s)
        analysis two = linear(Mathieu(mean: 2 N/m), over: 3.141592653589793 s)
        analysis other = linear(Mathieu(), over: 2 s)";
    let program = program(text);
    let found = modes(&program, "one");
    assert_eq!((found.modes.len(), found.zeros), (2, 0), "{found:?}");
    for (mode, growth) in found.modes.iter().zip([-0.243_145_76, 0.243_145_76]) {
        let off = apart(mode.value, Complex::new(growth, 1.0), PI).min(apart(
            mode.value,
            Complex::new(-growth, 1.0),
            PI,
        ));
        assert!(off < 2e-8, "{} {off:e}", mode.value);
        near(mode.value.im, 1.0, 1e-9);
    }
    assert_eq!(found.modes.iter().filter(|m| m.grows()).count(), 1);
    let found = modes(&program, "two");
    assert_eq!((found.modes.len(), found.zeros), (1, 0), "{found:?}");
    let mode = &found.modes[0];
    let off = apart(mode.value, Complex::new(0.0, 0.630_491_43), PI);
    assert!(off < 2e-8, "{} {off:e}", mode.value);
    // the branch near the mean's frequency
    near(mode.value.im, 2.0 - 0.630_491_43, 1e-6);
    assert!(!mode.grows());
    let other = refused(&program, "other");
    assert!(other.contains("another period"), "{other}");
}

const RINGING: &str = "
    use std.joints.{ParallelAxes, PointOnPlane, Translational}
    use std.drives.PrescribedRotation
    force Shaft(a: Marker, b: Marker, first: Stiffness, second: Stiffness, outer: Damping) {
        let away = a.origin - b.origin
        apply force -first*dot(away, a.x)*a.x - second*dot(away, a.y)*a.y - outer*a.velocity on a against b
    }
    force Spring(a: Marker, b: Marker, stiffness: Stiffness) {
        apply force -stiffness*dot(a.origin - b.origin, b.z)*b.z on a against b
    }
    model Rotor {
        gravity = [0, -9.81, 0] m/s^2
        marker stand = [0, 0, 0] mm
        marker wall = at([200, 0, 0] mm, z: [0, 1, 0], x: [1, 0, 0])
        body disc { mass = 2 kg; inertia = [1, 1, 2] g*m^2; marker pin = origin }
        body bob { mass = 0.1 kg; inertia = [1, 1, 1] g*m^2; marker eye = at([0, 0, 0] mm, z: [0, 1, 0], x: [1, 0, 0]) }
        joint level = ParallelAxes(disc.pin, stand)
        joint thrust = PointOnPlane(disc.pin, stand)
        drive turn = PrescribedRotation(disc.pin, stand, speed: 200 rad/s)
        force shaft = Shaft(disc.pin, stand, first: 16200 N/m, second: 24200 N/m, outer: 1 N*s/m)
        joint rail = Translational(bob.eye, wall)
        force held = Spring(bob.eye, wall, stiffness: 1e6 N/m)
    }
    analysis rings = linear(Rotor(), over: 1 rev, start: assembled)
    analysis balanced = linear(Rotor(), over: 1 rev)
    analysis stated = linear(Rotor(), over: 1 rev, start: assembled, step: 0.12 ms)
    analysis other = linear(Rotor(), over: 0.7 rev)";

/// An assembled start lets a bob ring on its spring, faster than the first steps of the march follow: their changes
/// over the period lead the search in the wrong direction. With shorter steps it reaches the motion that a balanced
/// start finds. A stated step is kept, and the message names the start. A message about a wrong period does not name
/// it.
#[test]
fn a_start_that_rings_comes_to_the_motion_that_repeats() {
    let program = program(RINGING);
    let (rings, balanced) = (modes(&program, "rings"), modes(&program, "balanced"));
    assert_eq!(rings.modes.len(), balanced.modes.len());
    for (mode, due) in rings.modes.iter().zip(&balanced.modes) {
        let allowed = 2.0 * error(due) + 1e-6 * due.value.norm();
        assert!(
            (mode.value - due.value).norm() < allowed,
            "{} {}",
            mode.value,
            due.value
        );
        let decrement = -TAU * mode.value.re / mode.value.im;
        near(mode.logarithmic_decrement(), decrement, 1e-15);
    }
    let far = "a motion of this period is near, but the search from the state does not find it";
    let stated = refused(&program, "stated");
    assert!(stated.contains(far) && stated.contains("bob"), "{stated}");
    let other = refused(&program, "other");
    assert!(!other.contains(far), "{other}");
}

/// A point on a thread that circles on a cone of 50°: N returns turned by 231.40°, and `κ = Ω√(1 + 3cos²α)`, modulo Ω
/// ±178.7419° a turn. The phase, the family of cones and the free body are neutral.
#[test]
fn a_pendulum_on_a_cone() {
    let (angle, g, l) = (50f64.to_radians(), 9.81_f64, 0.5_f64);
    let speed = (g / (l * angle.cos())).sqrt();
    let (out, down) = (l * angle.sin(), -l * angle.cos());
    let text = format!(
        "
        use std.joints.Distance
        model Cone {{
            gravity = [0, 0, -9.81] m/s^2
            marker hook = [0, 0, 0] mm
            body bob {{
                mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin
                guess position = [{out:e} m, 0 m, {down:e} m]
                start position = [{out:e} m, 0 m, {down:e} m]
                start velocity = [0 m/s, {v:e} m/s, 0 m/s]
                start angular_velocity = [0, 0, 0] rad/s
            }}
            joint thread = Distance(bob.eye, hook, length: 500 mm)
        }}
        analysis modes = linear(Cone(), over: {period:e} s, start: assembled, tolerance: 0.01)",
        v = out * speed,
        period = TAU / speed
    );
    let found = modes(&program(&text), "modes");
    assert_eq!((found.modes.len(), found.zeros), (1, 8), "{found:?}");
    let turn = (found.modes[0].value.im * TAU / speed)
        .to_degrees()
        .rem_euclid(360.0);
    near(turn.min(360.0 - turn), 178.7419, 1e-3);
    near(found.modes[0].value.re, 0.0, 1e-5 * speed);
    assert!(found.orbit.expect("an orbit").phase.expect("a phase") < 1e-4);
}

/// A square bar in two short bearings, which bends in axes that turn with it. `push` is a bump of a force at
/// both ends, across the load. `brake` holds both ends until 5 ms.
const FLEXIBLE: &str = "
    use std.joints.PointOnPlane
    use std.drives.PrescribedRotation
    use std.journals.Short
    force Bump(a: Marker, b: Marker, size: Force, middle: Time, width: Time) {
        let place = (time - middle)/width
        apply force size*exp(-place*place)*b.y on a against b
    }
    force Brake(a: Marker, b: Marker, coefficient: Damping) {
        let over = (time - 5 ms)/0.5 ms
        apply force -coefficient*(1 - tanh(over))/2*a.velocity on a against b
    }
    model Flexible {
        param speed: AngularVelocity = 1200 rad/s
        param pull: Acceleration = 185 m/s^2
        param push: Force = 0 N
        param moment: Time = 6 ms
        param width: Time = 1.5 ms
        param brake: Damping = 0 N*s/m
        gravity = [1, 0, 0]*pull
        marker near = [0, 0, 0] mm
        marker far = [0, 0, 200] mm
        flexible bar {
            mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
            modes = static(at: foot, freedoms: [x, y]) + static(at: tip, freedoms: [x, y]) + normal(2)
            damping = 10 %
            geometric_stiffness = true
            marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm)
            marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        }
        joint thrust = PointOnPlane(bar.foot, near)
        drive turn = PrescribedRotation(bar.foot, near, speed: speed)
        journal left = Short(pin: bar.foot, shell: near, diameter: 20 mm, width: 10 mm, radial_clearance: 20 um, viscosity: 10 mPa*s)
        journal right = Short(pin: bar.tip, shell: far, diameter: 20 mm, width: 10 mm, radial_clearance: 20 um, viscosity: 10 mPa*s)
        force first = Bump(bar.foot, near, size: push, middle: moment, width: width)
        force second = Bump(bar.tip, far, size: push, middle: moment, width: width)
        force held = Brake(bar.foot, near, coefficient: brake)
        force braked = Brake(bar.tip, far, coefficient: brake)
        output middle = dot(bar.foot.origin + bar.tip.origin - near.origin - far.origin, ground.y)/2 as um
    }
    analysis loaded = linear(Flexible(), over: 1 rev, number: 2)
    analysis frozen = linear(Flexible(), number: 2, frozen: true)
    analysis plain = linear(Flexible(), number: 2)
    analysis light = linear(Flexible(pull: 2 m/s^2), over: 1 rev, number: 2)
    analysis decay = transient(Flexible(push: 0.5 N), duration: 30 ms, sample: 0.25 ms, step: 5 us, start: quasi_static)
    analysis edge[s in [7400, 7800, 8000, 9000] rad/s] = linear(Flexible(speed: s, pull: 200 m/s^2), over: 1 rev, number: 1)
    analysis half = linear(Flexible(pull: 200 m/s^2), over: 1 rev, number: 1)
    analysis whirl[s in [7600, 7680, 8000] rad/s] = transient(
        Flexible(speed: s, pull: 200 m/s^2, push: 0.1 N, moment: 8 ms, width: 0.3 ms, brake: 2000 N*s/m),
        duration: 45 ms, sample: 0.1 ms, step: 2 us, start: quasi_static)";

/// The whirl of a flexible rotor decays in time with its exponent, within 1e-3 |λ|; frozen coefficients have a larger
/// error. Under a small load it whirls at half its speed, about a motion that no transient keeps.
#[test]
fn a_flexible_rotor_on_two_bearings() {
    let program = program(FLEXIBLE);
    // the bump is over
    let due = whirl(&program, "decay", 48, 0.25e-3);
    let nearest = |found: &LinearModes| {
        let off = found
            .modes
            .iter()
            .map(|m| (m.value - due).norm() / due.norm());
        off.fold(f64::INFINITY, f64::min)
    };
    let found = modes(&program, "loaded");
    let frozen = modes(&program, "frozen");
    println!(
        "decay {due}; of a period {:?}, {:.1e}; frozen {:?}, {:.1e}; {:?}",
        found.modes.iter().map(|m| m.value).collect::<Vec<_>>(),
        nearest(&found),
        frozen.modes.iter().map(|m| m.value).collect::<Vec<_>>(),
        nearest(&frozen),
        found.orbit
    );
    assert!(nearest(&found) < 1e-3, "{due}");
    assert!(nearest(&frozen) > 5e-3, "{due}");
    assert!(refused(&program, "plain").contains("bar turns"));
    let light = modes(&program, "light");
    let whirl = light
        .modes
        .iter()
        .find(|m| m.grows())
        .expect("a whirl that grows");
    println!("whirl {} {:?}", whirl.value, light.orbit);
    assert!(
        (0.4..0.55).contains(&(whirl.value.im / 1200.0)),
        "{}",
        whirl.value
    );
}

/// λ of the whirl of a transient of [`FLEXIBLE`], from a sample on.
fn whirl(program: &Program, analysis: &str, from: usize, h: f64) -> Complex<f64> {
    let results = outcome(program, analysis).results;
    let y = &results.column("middle").expect("a column").values;
    // Differences know nothing of where it comes to rest, sums over about a period of the bending nothing of
    // its ring; neither changes an exponent.
    let mut swing: Vec<f64> = y[from..].windows(2).map(|w| w[1] - w[0]).collect();
    for count in [4, 3, 3, 4] {
        swing = swing.windows(count).map(|w| w.iter().sum()).collect();
    }
    let (re, im) = decay(&swing, h);
    Complex::new(re, im)
}

/// The speed at which oil whirl of a flexible rotor begins, by the secant method from multipliers, is the speed at which
/// whirl in transients neither grows nor decays. Beyond it shooting finds the motion that no transient keeps, and
/// whirl grows from it with its exponent.
#[test]
fn the_threshold_of_oil_whirl() {
    let program = program(FLEXIBLE);
    let growth = |found: &LinearModes| found.modes[0].value.re;
    let edge: Vec<LinearModes> = (1..=4)
        .map(|i| modes(&program, &format!("edge[{i}]")))
        .collect();
    assert!(!edge[0].modes[0].grows() && edge[1..].iter().all(|found| found.modes[0].grows()));
    for found in &edge {
        let orbit = found.orbit.as_ref().expect("an orbit");
        assert!(orbit.gap < 1e-2, "{orbit:?}");
    }
    let half = program.analysis("half").expect("an analysis");
    let speed = half.parameter("speed").expect("a parameter");
    let growth_at = |omega: f64| {
        let quantity = format!("{omega} rad/s").parse().expect("a quantity");
        let at = half.clone().set(speed, quantity).expect("a setting");
        let found = at.run(&mut |_| {}).map_err(|f| f.error).expect("modes");
        growth(&found.modes.expect("modes"))
    };
    let (mut last, mut threshold) = (7400.0, 7800.0);
    let (mut growth_of_last, mut growth_of_this) = (growth_at(last), growth_at(threshold));
    assert!(growth_of_last < 0.0 && growth_of_this > 0.0);
    for _ in 0..4 {
        let next =
            threshold - growth_of_this * (threshold - last) / (growth_of_this - growth_of_last);
        (last, growth_of_last) = (threshold, growth_of_this);
        threshold = next;
        if (threshold - last).abs() < 0.5 {
            break;
        }
        growth_of_this = growth_at(threshold);
    }
    assert!((threshold - last).abs() < 0.5, "{last} {threshold}");
    let [slow, fast, beyond] =
        [1, 2, 3].map(|i| whirl(&program, &format!("whirl[{i}]"), 250, 1e-4));
    assert!(slow.re < 0.0 && fast.re > 0.0, "{slow} {fast}");
    let due = 7600.0 - 80.0 * slow.re / (fast.re - slow.re);
    let exponent = edge[2].modes[0].value;
    println!(
        "threshold {threshold}, of transients {due}; beyond it {exponent}, of a transient {beyond}; at 9000 rad/s {}",
        edge[3].modes[0].value
    );
    near(threshold / due, 1.0, 1e-3);
    assert!((exponent - beyond).norm() < 1e-3 * beyond.norm());
    near(exponent.re, beyond.re, 1e-2 * beyond.re);
}
