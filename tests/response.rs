//! Frequency responses against closed forms, the modes of the same model, and its motion in time.

use crate::support::{column as values, outcome, program};
use eng::post::{self, Run, evaluate};
use eng::{Program, Results, RuntimeError};
use eng_report::figure::Figure;
use std::f64::consts::{PI, TAU};

fn run(program: &Program, analysis: &str) -> Results {
    outcome(program, analysis).results
}

/// Two masses between a wall and a force, the second one behind a Maxwell element.
const TWO: &str = "
    use std.joints.Translational
    use std.forces.LinearSpring
    force Push(a: Marker, b: Marker, load: Force) { apply force load*b.z on a against b }
    force Maxwell(a: Marker, b: Marker, stiffness: Stiffness, damping: Damping) {
        state slip: Length = 0 mm scale 1 mm
        let x = dot(a.origin - b.origin, b.z)
        let load = stiffness*(x - slip)
        der(slip) = load/damping
        apply force -load*b.z on a against b
    }
    model Two {
        param damping: Damping = 30 N*s/m
        input push: Force = 0 N
        gravity = [0, 0, 0] m/s^2
        marker wall = [0, 0, 0] mm
        body first { mass = 2 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
        body second { mass = 0.5 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
        joint near = Translational(first.eye, wall)
        joint far = Translational(second.eye, wall)
        force spring = LinearSpring(first.eye, wall, stiffness: 8 N/mm, damping: damping, free_length: 100 mm)
        force soft = Maxwell(second.eye, first.eye, stiffness: 3 N/mm, damping: 40 N*s/m)
        force between = LinearSpring(second.eye, first.eye, stiffness: 2 N/mm, damping: 1 N*s/m, free_length: 100 mm)
        force drive = Push(second.eye, wall, load: push)
        start near.travel = 100 mm
        start far.travel = 200 mm
        output place = dot(second.eye.origin - wall.origin, ground.z) as mm
        output acceleration = dot(second.eye.acceleration, ground.z)
    }
    analysis shaken = response(Two(), to: push, of: [place, acceleration, spring.tension], from: 1 Hz, up_to: 100 Hz)";

/// H of place and of the force in the first spring, by dynamic stiffness.
fn two(f: f64, damping: f64) -> [nalgebra::Complex<f64>; 2] {
    type C = nalgebra::Complex<f64>;
    let s = C::new(0.0, TAU * f);
    let wall = s * damping + 8e3;
    let maxwell = (s * 40.0) * 3e3 / (s * 40.0 + 3e3);
    let link = s + 2e3 + maxwell;
    // [2 s² + wall + link, −link; −link, 0.5 s² + link] [x₁; x₂] = [0; 1]
    let (a, d) = (s * s * 2.0 + wall + link, s * s * 0.5 + link);
    let determinant = a * d - link * link;
    [a / determinant, wall * link / determinant]
}

#[test]
fn two_masses_and_a_maxwell_element() {
    let program = program(TWO);
    let results = run(&program, "shaken");
    let frequency = values(&results, "frequency");
    assert!(frequency.len() > 200 && frequency[0] == 1.0);
    assert_eq!(frequency.last(), Some(&100.0));
    assert!(frequency.windows(2).all(|pair| pair[0] < pair[1]));
    let mut worst = 0.0_f64;
    for (row, f) in frequency.iter().enumerate() {
        let [place, tension] = two(*f, 30.0);
        let s = nalgebra::Complex::new(0.0, TAU * f);
        // an acceleration at low frequency is the small difference of the push over the mass and the pull of the springs
        for (path, due, size) in [
            ("place", place, 0.0),
            ("acceleration", s * s * place, 2.0),
            ("spring.tension", tension, 0.0),
        ] {
            let found = nalgebra::Complex::from_polar(
                values(&results, path)[row],
                values(&results, &format!("{path}.phase"))[row],
            );
            let miss = (found - due).norm() / due.norm().max(size);
            worst = worst.max(miss);
            assert!(miss < 1e-7, "{path} at {f} Hz: {found} instead of {due}");
        }
    }
    println!("largest error {worst:.1e}");
    let column = results.column("place").expect("a column");
    assert_eq!(column.display.symbol, "mm/N");
    assert_eq!(
        results
            .column("spring.tension")
            .expect("a column")
            .display
            .symbol,
        "1"
    );
}

/// A damping of 1e-5: without points of its own the peak would lie between two frequencies.
#[test]
fn narrow_resonances_are_not_missed() {
    let text = TWO
        .replace(
            "stiffness: 3 N/mm, damping: 40 N*s/m",
            "stiffness: 0 N/mm, damping: 40 N*s/m",
        )
        .replace("damping: 1 N*s/m", "damping: 0.001 N*s/m")
        .replace("= 30 N*s/m", "= 0.01 N*s/m");
    let program = program(&text);
    let results = run(&program, "shaken");
    let due = |f: f64| {
        let s = nalgebra::Complex::new(0.0, TAU * f);
        let (wall, link) = (s * 0.01 + 8e3, s * 0.001 + 2e3);
        let (a, d) = (s * s * 2.0 + wall + link, s * s * 0.5 + link);
        (a / (a * d - link * link)).norm()
    };
    // the peaks by a search of the closed form
    let frequency = values(&results, "frequency");
    let place = values(&results, "place");
    for modes in [6.0..9.5, 9.5..14.0] {
        let within = frequency
            .iter()
            .zip(place)
            .filter(|(f, _)| modes.contains(*f));
        let (at, found) = within.fold((0.0, 0.0), |(at, most), (f, size)| {
            if *size > most {
                (*f, *size)
            } else {
                (at, most)
            }
        });
        let (mut low, mut high) = (at * (1.0 - 1e-4), at * (1.0 + 1e-4));
        for _ in 0..200 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if due(a) < due(b) { low = a } else { high = b }
        }
        let peak = due(low);
        println!("peak {found} for {peak} at {low} Hz");
        assert!(
            (found / peak - 1.0).abs() < 1e-3,
            "{found} instead of {peak} at {low}"
        );
        assert!(peak > 100.0 * due(0.98 * low), "a narrow resonance");
    }
}

/// The amplitude and phase of the settled motion under a sinusoid in time.
#[test]
fn the_motion_in_time_settles_to_the_response() {
    let text = format!(
        "{TWO}
        fn shake(t: Time) -> Force = 5 N*cos(2*pi*9 Hz*t)
        analysis moved = transient(Two(push: shake), duration: 4 s, sample: 1 ms, tolerance: 1e-3)"
    );
    let results = run(&program(&text), "moved");
    let (time, place) = (values(&results, "time"), values(&results, "place"));
    // nine whole periods at the end
    let last: Vec<(f64, f64)> = time
        .iter()
        .copied()
        .zip(place.iter().copied())
        .skip(3000)
        .take(1000)
        .collect();
    let (mut re, mut im) = (0.0, 0.0);
    for (t, x) in &last {
        let angle = TAU * 9.0 * t;
        re += 2e-3 * x * angle.cos();
        im -= 2e-3 * x * angle.sin();
    }
    let found = nalgebra::Complex::new(re, im) / 5.0;
    let [due, _] = two(9.0, 30.0);
    println!("{found} for {due}");
    assert!(
        (found - due).norm() < 1e-4 * due.norm(),
        "{found} instead of {due}"
    );
}

#[test]
fn a_report_reads_a_response() {
    let text = format!(
        "{TWO}
        report shaking {{
            value peak = maximum(shaken.place) as um/N
            value at = maximum_at(shaken.place)
            value twenty = at_frequency(shaken.place, 20 Hz)
            value behind = at_frequency(shaken.place.phase, 20 Hz) as deg
            figure both = bode(shaken.place)
            figure circle = xy(shaken.place*cos(shaken.place.phase), shaken.place*sin(shaken.place.phase))
            require peak > 100 um/N else \"the peak is {{peak as um/N}}\"
        }}"
    );
    let program = program(&text);
    let analysis = program.analysis("shaken").expect("an analysis");
    let outcome = analysis.run(&mut |_| {}).expect("a response");
    let machine = analysis.machine().expect("a machine");
    let run = Run::new(&outcome.results, &machine);
    let made = evaluate(&program.reports()[0], &[run]);
    assert!(!made.fails(), "the peak is above its limit");
    let value = |name: &str| made.values(name).expect("a value")[0].value;
    let frequency = values(&outcome.results, "frequency");
    let place = values(&outcome.results, "place");
    let peak = place.iter().copied().fold(0.0, f64::max);
    assert_eq!(value("peak"), peak);
    let row = place.iter().position(|x| *x == peak).expect("a row");
    assert!((value("at") / frequency[row] - 1.0).abs() < 0.02);
    let [due, _] = two(20.0, 30.0);
    println!(
        "{} for {}, {} for {}",
        value("twenty"),
        due.norm(),
        value("behind"),
        due.arg()
    );
    assert!((value("twenty") / due.norm() - 1.0).abs() < 1e-5);
    assert!((value("behind") - due.arg()).abs() < 1e-5);
    for entry in &made.entries {
        let drawn = match &entry.outcome {
            Ok(post::Outcome::Figure(figure)) => figure,
            Ok(_) => continue,
            Err(error) => panic!("{}: {error}", entry.name),
        };
        match (&**drawn, entry.name.as_str()) {
            (Figure::Bode(bode), "both") => {
                assert_eq!(bode.curves[0].frequency.len(), frequency.len());
                assert_eq!(bode.ordinate.unit, "mm/N");
            }
            (Figure::Xy(_), "circle") => {}
            (_, other) => panic!("{other}"),
        }
    }
}

/// A negative damper: the motion settles nowhere.
#[test]
fn an_unstable_state_has_no_response() {
    let program = program(&TWO.replace("= 30 N*s/m", "= -300 N*s/m"));
    let failed = program
        .analysis("shaken")
        .expect("an analysis")
        .run(&mut |_| {});
    let error = *failed.expect_err("it grows").error;
    match error {
        eng::Error::Run { cause, .. } => {
            assert!(matches!(*cause, RuntimeError::Grows { growth, .. } if growth > 0.0));
        }
        other => panic!("{other}"),
    }
}

/// A rotor that nothing holds: 1/(J ω²) at half a turn.
#[test]
fn a_free_rotor_turns_against_its_torque() {
    let text = "
        use std.joints.Revolute
        force Turn(a: Marker, b: Marker, torque: Torque) { apply torque torque*b.z on a against b }
        model Free {
            input brake: Torque = 0 N*m
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body rotor { mass = 3 kg; inertia = [3, 3, 4] g*m^2; marker hub = origin }
            joint pin = Revolute(rotor.hub, wall)
            force drive = Turn(rotor.hub, wall, torque: brake)
            output angle = rotation(rotor.hub, wall) as deg
        }
        analysis free = response(Free(), to: brake, of: angle, from: 10 Hz, up_to: 1 kHz, points: 10)";
    let results = run(&program(text), "free");
    let frequency = values(&results, "frequency");
    assert_eq!(frequency.len(), 21);
    for (row, f) in frequency.iter().enumerate() {
        let due = 1.0 / (4e-3 * (TAU * f).powi(2));
        assert!((values(&results, "angle")[row] / due - 1.0).abs() < 1e-7);
        assert!((values(&results, "angle.phase")[row].abs() - PI).abs() < 1e-7);
    }
    let unit = &results.column("angle").expect("a column").display.symbol;
    assert_eq!(unit, "deg/(N*m)");
}
