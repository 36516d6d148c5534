//! The quasi-static start, periodic analyses and sweeps on whole models.

use crate::support::outcome as run;
use eng::run::{Event, run_many};
use eng::{Analysis, Outcome, Program, Sources, StartReport};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;

fn program(sources: Sources, file: &str) -> Program {
    eng::check(&sources, file)
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
}

/// The example engine with other analyses.
fn engine(analyses: &str) -> Program {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
    let text = std::fs::read_to_string(folder.join("inline4.eng")).expect("the example");
    let (model, _) = text
        .split_once("analysis unfired")
        .expect("its first analysis");
    let pressure = std::fs::read_to_string(folder.join("pressure.csv")).expect("the pressure");
    let sources = Sources::from_texts([
        ("engine.eng".to_owned(), format!("{model}\n{analyses}")),
        ("pressure.csv".to_owned(), pressure),
    ]);
    program(sources, "engine.eng")
}

fn swing(values: &[f64]) -> f64 {
    values.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x))
        - values.iter().fold(f64::INFINITY, |m, x| m.min(*x))
}

/// The first 30 degrees of crank angle from a quasi-static start are those of the repeating cycle, except for the way
/// of the pins to their orbits. From the assembled start the forces of the journals are wrong by a third of their
/// swing.
#[test]
fn a_turning_engine_begins_as_its_cycle_goes_on() {
    let program = engine(
        "analysis quasi = transient(Inline4(combustion: 0), duration: 30 deg, sample: 3 deg)
         analysis plain = transient(Inline4(combustion: 0), duration: 30 deg, sample: 3 deg, start: assembled)
         analysis steady = periodic(Inline4(combustion: 0), sample: 3 deg)",
    );
    let steady = run(&program, "steady");
    let periodic = steady.periodic.as_ref().expect("a periodic analysis");
    assert!(periodic.repeats && periodic.cycles < 20, "{periodic:?}");
    // the crank and flywheel against the dynamometer on 2e4 N m/rad, 45 Hz
    let decay = periodic.decay.as_ref().and_then(|d| d.mode);
    let decay = decay.expect("three cycles");
    assert!((0.4..0.6).contains(&decay.factor), "{decay:?}");
    let off = |outcome: &Outcome| {
        let mut worst = 0.0_f64;
        for journal in 1..=5 {
            for axis in ["x", "y"] {
                let path = format!("engine.main[{journal}].force.{axis}");
                let here = &outcome.results.column(&path).expect("a channel").values;
                let cycle = &steady.results.column(&path).expect("a channel").values;
                assert_eq!((here.len(), cycle.len()), (11, 241));
                for (a, b) in here.iter().zip(cycle) {
                    worst = worst.max((a - b).abs() / swing(cycle));
                }
            }
        }
        worst
    };
    let (quasi, plain) = (run(&program, "quasi"), run(&program, "plain"));
    let Some(StartReport::QuasiStatic(found)) = &quasi.start else {
        panic!("{:?}", quasi.start);
    };
    assert_eq!(
        (found.freedoms, found.portions, found.journals.len()),
        (4, 1, 5)
    );
    assert_eq!(plain.start, Some(StartReport::Assembled));
    assert!(off(&quasi) < 0.04, "{}", off(&quasi));
    assert!(off(&plain) > 0.3, "{}", off(&plain));
}

/// The balance by another route: the accelerations with which the integrator begins do not accelerate the crank,
/// which is free in its films, across its axis. The engine is fired at full load, with a pin at 0.88 of its
/// clearance.
#[test]
fn the_crank_is_in_balance_at_the_start() {
    let model = engine("").model("Inline4").expect("the model");
    let mut simulation = model.simulation().start().expect("it starts");
    let StartReport::QuasiStatic(found) = simulation.started().clone() else {
        panic!("{}", simulation.started());
    };
    let largest = found.journals.iter().fold(0.0_f64, |m, j| m.max(j.ratio));
    assert!((0.8..0.95).contains(&largest), "{found:?}");
    let held = found.held.first().expect("the cycle's angle is held");
    assert_eq!((held.origin.path.as_str(), found.held.len()), ("cycle", 1));
    let runtime = simulation.runtime();
    let crank = runtime
        .model()
        .bodies
        .iter()
        .find(|b| b.origin.path == "engine.crank")
        .expect("the crank");
    let first = crank.velocity;
    let (speed, throw) = (4000.0 * std::f64::consts::TAU / 60.0, 0.043);
    let state = runtime.state();
    for i in 0..3 {
        let a = state.acceleration[first + i] / (throw * speed * speed);
        assert!(a.abs() < 1e-7, "along {i}: {a:e}");
    }
    for i in 3..5 {
        let a = state.acceleration[first + i] / (speed * speed);
        assert!(a.abs() < 1e-7, "about {i}: {a:e}");
    }
    // about its axis the holding effort accelerates the inertia: crank and flywheel, 0.154 kg m², and the share of rods
    // and pistons
    let inertia = -held.effort / state.acceleration[first + 5];
    assert!((0.154..0.175).contains(&inertia), "{inertia}");
}

/// A stated place holds exactly, also in a quasi-static start.
#[test]
fn a_stated_place_is_kept() {
    let text = "
        use std.journals.Short
        use std.joints.PointOnPlane
        model Rotor {
            gravity = [0, -9.81, 0] m/s^2
            marker shell = [0, 0, 0] mm
            body rotor {
                mass = 10 kg; inertia = [100, 100, 50] g*m^2; marker pin = origin
                PLACE position = [0, -5, 0] um
                start angular_velocity = [0, 0, 1]*(3000 rpm)
            }
            joint axial = PointOnPlane(rotor.pin, shell)
            journal film = Short(
                pin: rotor.pin, shell: shell, diameter: 50 mm, width: 20 mm, radial_clearance: 25 um, viscosity: 10 mPa*s,
            )
            cycle angle = rotation(rotor.pin, shell) { period = 360 deg }
        }
        analysis run = transient(Rotor(), duration: 1 us)";
    let begun = |word: &str| {
        let sources = Sources::from_text("rotor.eng", text.replace("PLACE", word));
        let outcome = run(&program(sources, "rotor.eng"), "run");
        let e = |axis: &str| {
            outcome
                .results
                .column(&format!("film.eccentricity.{axis}"))
                .expect("a channel")
                .values[0]
        };
        let force = outcome
            .results
            .column("film.force.y")
            .expect("a channel")
            .values[0];
        ([e("x"), e("y")], force, outcome.start.expect("a start"))
    };
    let (place, _, start) = begun("start");
    assert!(
        (place[0].abs() < 1e-15) && (place[1] + 5e-6).abs() < 1e-15,
        "{place:?}"
    );
    let StartReport::QuasiStatic(found) = start else {
        panic!("{start}");
    };
    // the run reports the effort that would hold it there
    assert!(
        found
            .held
            .iter()
            .any(|h| h.is_length && h.effort.abs() > 50.0),
        "{found:?}"
    );
    let (_, force, start) = begun("guess");
    assert!(matches!(start, StartReport::QuasiStatic(e) if e.held.iter().all(|h| !h.is_length)));
    assert!((force / 98.1 - 1.0).abs() < 1e-6, "{force}");
}

/// A forced oscillator on a driven shaft: its decay is that of the closed form.
#[test]
fn the_slowest_decay_is_that_of_the_oscillator() {
    let text = "
        use std.joints.Revolute
        use std.drives.ConstantSpeed
        use std.forces.TorsionSpring
        model Line {
            gravity = [0, -9.81, 0] m/s^2
            marker bearing = [0, 0, 0] mm
            body disc {
                mass = 10 kg; inertia = [60, 60, 100] g*m^2; center_of_mass = [10, 0, 0] mm
                marker hub = origin
            }
            body motor { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }
            joint journal = Revolute(disc.hub, bearing)
            drive turn = ConstantSpeed(motor.hub, bearing, speed: 10 rev/s)
            force coupling = TorsionSpring(disc.hub, motor.hub, stiffness: 250 N*m/rad, damping: 1 N*m*s/rad)
            cycle angle = rotation(motor.hub, bearing) { period = 360 deg }
        }
        analysis run = periodic(Line(), sample: 5 deg, step: 200 us, change: 1e-4)
        analysis soon = periodic(Line(), sample: 5 deg, step: 200 us, cycles: 3, change: 1e-4)";
    let program = program(Sources::from_text("line.eng", text), "line.eng");
    let found = run(&program, "run").periodic.expect("a periodic analysis");
    assert!(found.repeats, "{found:?}");
    let inertia = 0.1 + 10.0 * 0.01 * 0.01;
    let (rate, period) = (1.0 / (2.0 * inertia), 0.1);
    let decay = found.decay.and_then(|d| d.mode).expect("three cycles");
    let expected = f64::exp(-rate * period);
    assert!(
        (decay.factor - expected).abs() < 0.01 * expected,
        "{decay:?}"
    );
    // 4.95 rad a cycle, short of a turn
    let turn = std::f64::consts::TAU - f64::sqrt(250.0 / inertia - rate * rate) * period;
    assert!((decay.turn - turn).abs() < 0.02, "{decay:?} {turn}");
    let soon = run(&program, "soon");
    let found = soon.periodic.expect("a periodic analysis");
    assert!(!found.repeats && found.cycles == 3, "{found:?}");
    // the last cycle is kept
    let angle = &soon.results.column("cycle.angle").expect("a column").values;
    assert_eq!(angle.len(), 73);
    assert!(
        (angle[0].to_degrees() - 720.0).abs() < 1e-6
            && (angle[72].to_degrees() - 1080.0).abs() < 1e-6
    );
}

/// Points of a sweep: one compiled model, the same bits in one thread and in three.
#[test]
fn a_sweep_does_not_depend_on_threads() {
    let text = "
        use std.joints.Revolute
        model Swing {
            param length: Length = 1 m
            gravity = [0, -9.81, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker top = [0 mm, length, 0 mm] }
            joint pin = Revolute(bob.top, wall)
            start pin.angle = 40 deg
            output height = dot(bob.origin.origin, [0, 1, 0]) as mm
        }
        analysis by_length[l in 200 mm .. 600 mm by 200 mm] = transient(Swing(length: l), duration: 200 ms)
        analysis listed[l in [0.3, 0.7] m] = transient(Swing(length: l), duration: 100 ms)";
    let program = eng::check(&Sources::from_text("swing.eng", text), "swing.eng")
        .into_program()
        .expect("a sound text");
    let names = [
        "by_length[1]",
        "by_length[2]",
        "by_length[3]",
        "listed[1]",
        "listed[2]",
    ];
    let runs = |threads: usize| {
        assert_eq!(program.analyses(), names);
        let analyses: Result<Vec<Analysis>, _> = program.analyses_of(&names).into_iter().collect();
        let mut outcomes: Vec<_> = names.iter().map(|_| None).collect();
        let threads = NonZeroUsize::new(threads).expect("not zero");
        run_many(
            &analyses.expect("they compile"),
            false,
            threads,
            &mut |index, event| {
                if let Event::Done(result) = event {
                    outcomes[index] = Some(result.expect("it runs"));
                }
                ControlFlow::Continue(())
            },
        );
        outcomes
            .into_iter()
            .map(|o| o.expect("told"))
            .collect::<Vec<_>>()
    };
    let (one, three) = (runs(1), runs(3));
    for (a, b) in one.iter().zip(&three) {
        assert_eq!(a.results, b.results);
    }
    let points: Vec<String> = one
        .iter()
        .map(|o| {
            o.point
                .iter()
                .map(|p| format!("{} = {}", p.name, p.display.text(p.value)))
                .collect()
        })
        .collect();
    assert_eq!(
        points,
        [
            "l = 200 mm",
            "l = 400 mm",
            "l = 600 mm",
            "l = 0.3 m",
            "l = 0.7 m"
        ]
    );
    assert_eq!(one[0].results.samples(), 1001);
}

/// A stated angle keeps its turns, in every angle between the same markers. An angle that nothing states is within half
/// a turn.
#[test]
fn an_angle_starts_as_it_is_stated() {
    let started = |start: &str| -> Vec<f64> {
        let text = format!(
            "use std.joints.Revolute
             model M {{
                 gravity = [0, 0, 0] m/s^2
                 marker o = [0, 0, 0] mm
                 body q {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker side = at([0, 0, 0] mm, x: [0, 1, 0], z: [0, 0, 1]) }}
                 joint j = Revolute(q.origin, o)
                 {start}
                 cycle angle = rotation(q.origin, o) {{ period = 720 deg }}
                 output same = rotation(q.origin, o) as deg
                 output against = rotation(o, q.origin) as deg
                 output beside = rotation(q.side, o) as deg
             }}"
        );
        let program = program(Sources::from_text("m.eng", &text), "m.eng");
        let model = program.model("M").expect("the model");
        let mut simulation = model.simulation().start().expect("it starts");
        ["j.angle", "same", "against", "beside"]
            .iter()
            .map(|path| {
                let channel = model.channel(path).expect("a channel");
                simulation.value(channel).expect("a value").to_degrees()
            })
            .collect()
    };
    let near = |found: &[f64], wanted: [f64; 4], of: &str| {
        for (a, b) in found.iter().zip(wanted) {
            assert!((a - b).abs() < 1e-6, "{of}: {found:?}");
        }
    };
    for degrees in [
        0.0, 1.0, 90.0, 179.0, 181.0, 200.0, 270.0, 359.0, 400.0, 3000.0, -90.0, -181.0, -720.0,
        -3000.0,
    ] {
        for start in [
            format!("start rotation(q.origin, o) = {degrees} deg"),
            format!("start j.angle = {degrees} deg"),
        ] {
            let wanted = [degrees, degrees, -degrees, degrees + 90.0];
            near(&started(&start), wanted, &start);
        }
        let start = format!("start rotation(o, q.origin) = {degrees} deg");
        near(
            &started(&start),
            [-degrees, -degrees, degrees, 90.0 - degrees],
            &start,
        );
    }
    near(&started(""), [0.0, 0.0, 0.0, 90.0], "nothing");
}

/// The names of points are their values if all are different whole numbers, else their places in the list.
#[test]
fn points_of_a_sweep_have_names_of_their_own() {
    let names = |values: &str| -> Vec<String> {
        let text = format!(
            "model Fall {{
                param share: 1 = 1
                gravity = [0, 0, -9.81] m/s^2
                body ball {{
                    mass = 1 kg
                    inertia = [1, 1, 1] g*m^2
                }}
            }}
            analysis a[x in {values}] = transient(Fall(share: x), duration: 1 ms)"
        );
        program(Sources::from_text("fall.eng", text), "fall.eng")
            .analyses()
            .into_iter()
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(names("[3, 3.125, 3.25]"), ["a[1]", "a[2]", "a[3]"]);
    assert_eq!(names("[4, 7]"), ["a[4]", "a[7]"]);
    assert_eq!(names("[4, 4]"), ["a[1]", "a[2]"]);
    assert_eq!(names("2..4"), ["a[2]", "a[3]", "a[4]"]);
}

/// Loads that are rounding need not repeat. A model without bodies starts as it is.
#[test]
fn nothing_moves_and_rounding_is_no_change() {
    let program = program(
        Sources::from_text(
            "disc.eng",
            "use std.drives.ConstantSpeed
            model Disc {
                gravity = [0, 0, 0] m/s^2
                body disc {
                    mass = 1 kg
                    inertia = [2, 2, 2] g*m^2
                    marker axle = origin
                }
                drive turn = ConstantSpeed(disc.axle, ground, speed: 1000 rpm)
                cycle angle = rotation(disc.axle, ground) { period = 360 deg }
            }
            model Nothing {
                output x: 1 = 2
            }
            analysis steady = periodic(Disc())
            analysis nothing = transient(Nothing(), duration: 1 s, start: quasi_static)
            analysis no_modes = linear(Nothing())",
        ),
        "disc.eng",
    );
    let steady = run(&program, "steady");
    let torque = steady.results.column("turn.torque.z").expect("a channel");
    // of m (m/s)² at the size of the disc, 44.7 mm: 22 N m
    assert!(swing(&torque.values) < 1e-9);
    let periodic = steady.periodic.expect("a periodic analysis");
    assert!(periodic.repeats && periodic.cycles <= 3, "{periodic:?}");
    let nothing = run(&program, "nothing");
    assert_eq!(nothing.start, Some(StartReport::Assembled));
    assert_eq!(
        nothing.results.column("x").expect("a channel").values[0],
        2.0
    );
    assert_eq!(run(&program, "no_modes").results.samples(), 0);
}

/// A pendulum, begun beside its balances: its angle from hanging down.
fn pendulum(begin: f64) -> Outcome {
    pendulum_with(begin, "")
}

/// The same with a line that states its start.
fn pendulum_with(begin: f64, stated: &str) -> Outcome {
    let (x, y) = (300.0 * begin.sin(), -300.0 * begin.cos());
    let program = program(
        Sources::from_text(
            "pendulum.eng",
            format!(
                "use std.joints.Revolute
                model Pendulum {{
                    gravity = [0, -9.81, 0] m/s^2
                    marker pivot = [0, 0, 0] mm
                    body bob {{
                        mass = 1 kg; inertia = [2, 2, 2] g*m^2; marker top = [0, 300, 0] mm
                        guess position = [{x:e}, {y:e}, 0] mm
                        guess rotation = [0 rad, 0 rad, {begin:e} rad]
                    }}
                    joint pin = Revolute(bob.top, pivot)
                    {stated}
                    output angle: Angle = pin.angle
                }}
                analysis balance = transient(Pendulum(), duration: 1 us, sample: 1 us, start: quasi_static)"
            ),
        ),
        "pendulum.eng",
    );
    run(&program, "balance")
}

/// Gravity holds a pendulum although it has no stiffness at the level position. From every position except the top it
/// comes to hang. At the top a warning reports that it is upside down, and how fast it leaves.
#[test]
fn a_pendulum_comes_to_hang_and_is_told_to_stand_upside_down() {
    for degrees in [30.0_f64, 90.0, 100.0, 170.0, -120.0] {
        let found = pendulum(degrees.to_radians());
        let Some(StartReport::QuasiStatic(balance)) = &found.start else {
            panic!("{degrees}: {:?}", found.start);
        };
        assert_eq!(
            (balance.freedoms, &balance.unstable),
            (1, &None),
            "{degrees}"
        );
        let angle = found.results.column("angle").expect("a channel").values[0];
        assert!(angle.abs() < 1e-9, "{degrees}: {angle}");
    }
    for stated in ["", "start pin.angle = 180 deg"] {
        let found = pendulum_with(std::f64::consts::PI, stated);
        let Some(StartReport::QuasiStatic(balance)) = &found.start else {
            panic!("{:?}", found.start);
        };
        let unstable = balance.unstable.as_ref().expect("upside down");
        assert_eq!(unstable.origin.path, "bob");
        // √(J/(m g l))
        let due = ((2e-3 + 0.3 * 0.3) / (9.81 * 0.3_f64)).sqrt();
        assert!(
            (unstable.time / due - 1.0).abs() < 1e-6,
            "{stated}: {}",
            unstable.time
        );
    }
    // held out by its start, and held at the bottom
    for (stated, torque) in [
        ("start pin.angle = 90 deg", true),
        ("start pin.angle = 0 deg", false),
    ] {
        let found = pendulum_with(0.1, stated);
        let Some(StartReport::QuasiStatic(balance)) = &found.start else {
            panic!("{:?}", found.start);
        };
        assert_eq!(
            (!balance.held.is_empty(), &balance.unstable),
            (torque, &None),
            "{stated}"
        );
    }
}

/// Nothing holds a body that falls under gravity, and every search finds this.
#[test]
fn what_falls_is_held_by_nothing() {
    let program = program(
        Sources::from_text(
            "stone.eng",
            "model Stone {
                gravity = [0, 0, -9.81] m/s^2
                body stone { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
            }
            analysis falls = transient(Stone(), duration: 1 us, sample: 1 us, start: quasi_static)",
        ),
        "stone.eng",
    );
    let Some(StartReport::NoBalance(obstacle)) = run(&program, "falls").start else {
        panic!("a balance");
    };
    assert!(
        obstacle.message.contains("nothing holds it"),
        "{obstacle:?}"
    );
}

/// Beside a disc that turns fast a pendulum remains above its pivot for many cycles, and repeats: a warning reports
/// that it is unstable there.
#[test]
fn a_steady_motion_that_is_unstable_is_told() {
    let text = |y: f64, begin: f64| {
        format!(
            "use std.joints.Revolute
            use std.drives.ConstantSpeed
            model Clock {{
                gravity = [0, -9.81, 0] m/s^2
                marker pivot = [0, 0, 0] mm
                body disc {{ mass = 2 kg; inertia = [2, 2, 2] g*m^2; marker axle = origin }}
                body bob {{
                    mass = 1 kg; inertia = [2, 2, 2] g*m^2; marker top = [0, 300, 0] mm
                    guess position = [0, {y:e}, 0] mm
                    guess rotation = [0 rad, 0 rad, {begin:e} rad]
                }}
                drive turn = ConstantSpeed(disc.axle, ground, speed: 3000 rpm)
                joint pin = Revolute(bob.top, pivot)
                start pin.angle = {begin:e} rad
                start pin.speed = 0 rad/s
                cycle angle = rotation(disc.axle, ground) {{ period = 360 deg }}
            }}
            analysis steady = periodic(Clock(), start: assembled, sample: 10 deg)"
        )
    };
    for (y, begin, upright) in [(-300.0, 0.0, false), (300.0, std::f64::consts::PI, true)] {
        let program = program(Sources::from_text("clock.eng", text(y, begin)), "clock.eng");
        let found = run(&program, "steady").periodic.expect("a cycle");
        assert!(found.repeats, "{found:?}");
        assert_eq!(
            found.unstable.as_ref().map(|u| u.origin.path.as_str()),
            upright.then_some("bob"),
            "{found:?}"
        );
    }
}

/// A wheel that turns backwards at 600 rpm: `wrapped` brings its angle into the stated interval, changes it by
/// whole periods only, and has the rate of the angle.
#[test]
fn a_wrapped_angle_keeps_its_interval_its_turns_and_its_rate() {
    let text = "
        use std.joints.Revolute
        use std.drives.PrescribedRotation
        model Rotor {
            param lead: Angle = 90 deg
            param whole: Angle = 720 deg
            gravity = [0, 0, 0] m/s^2
            body wheel { mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker hub = origin }
            joint pin = Revolute(wheel.hub, ground)
            drive turn = PrescribedRotation(wheel.hub, ground, speed: -600 rpm)
            cycle angle = rotation(wheel.hub, ground) { period = 720 deg }
            output four = wrapped(cycle.angle, whole, from: lead)
            output two = wrapped(rotation(wheel.hub, ground), 360 deg)
            output rate = der(wrapped(rotation(wheel.hub, ground), 360 deg)) as rpm
            output upper = wrapped(180 deg, 360 deg)
            output lower = wrapped(-180 deg, 360 deg)
            output many = wrapped(1e9 deg + lead, 360 deg)
            output none = wrapped(lead, whole, from: 0 deg) - lead
        }
        analysis turning = transient(Rotor(), duration: 0.5 s, sample: 1.37 ms)";
    let program = program(Sources::from_text("rotor.eng", text), "rotor.eng");
    let outcome = run(&program, "turning");
    let column = |path: &str| &outcome.results.column(path).expect("an output").values;
    let (turn, right) = (std::f64::consts::TAU, std::f64::consts::FRAC_PI_2);
    for (path, period, from) in [("four", 2.0 * turn, right), ("two", turn, -0.5 * turn)] {
        let mut jumps = 0;
        let mut before = None;
        for (angle, own) in column("cycle.angle").iter().zip(column(path)) {
            assert!((from..from + period).contains(own), "{path}: {own}");
            let count = (angle - own) / period;
            assert!((count - count.round()).abs() < 1e-12, "{path}: {count}");
            jumps += usize::from(before.is_some_and(|before| before != count.round()));
            before = Some(count.round());
        }
        // below -180°, -540°, … -1620°; below -630° and -1350°
        assert_eq!(jumps, if path == "two" { 5 } else { 2 }, "{path}");
    }
    let speed = -10.0 * turn;
    assert!(
        column("rate")
            .iter()
            .all(|rate| (rate - speed).abs() < 1e-9 * speed.abs())
    );
    let of_parameters = |path: &str| column(path)[0];
    // the upper end belongs to the next interval
    assert_eq!(of_parameters("upper"), -0.5 * turn);
    assert_eq!(of_parameters("lower"), -0.5 * turn);
    // 10⁹ = 360·2777777 + 280: 280° + 90° − 360°
    assert!((of_parameters("many") - 10f64.to_radians()).abs() < 1e-8);
    assert_eq!(of_parameters("none"), 0.0);
    // a period that a run sets is checked where it is set
    let analysis = program.analysis("turning").expect("an analysis");
    let whole = analysis.parameter("whole").expect("a parameter");
    let refused = analysis.set(whole, "-720 deg".parse().expect("a quantity"));
    let told = match refused.map(|analysis| analysis.run(&mut |_| {})) {
        Ok(Err(failed)) => format!("{}", failed.error),
        Err(error) => format!("{error}"),
        Ok(Ok(_)) => panic!("it runs"),
    };
    assert!(
        told.contains("the period of `wrapped` must be positive"),
        "{told}"
    );
}

/// A damper and a drive between a wheel and `ground` do not hold the wheel where it would begin: its bolts place it, and the block
/// stays. The ground marker of the damper is where the wheel is.
#[test]
fn a_force_on_the_ground_places_no_body() {
    let text = "
        use std.joints.{Fixed, PointOnPlane}
        use std.drivelines.RotationalDamper
        use std.drives.PrescribedRotation
        use std.journals.Impedance
        model Shaft {
            gravity = [-9.81, 0, 0] m/s^2
            body block { mass = 60 kg; inertia = [2, 2, 2] kg*m^2; marker support = origin; marker shell[k in 1..2] = [0, 0, [-100, 100][k]] mm }
            body shaft { mass = 10 kg; inertia = [40, 40, 20] g*m^2; marker neck[k in 1..2] = [0, 0, [-100, 100][k]] mm; marker end = [0, 0, 230] mm; start angular_velocity = [0, 0, 100] rad/s }
            body wheel { mass = 10 kg; inertia = [50, 50, 100] g*m^2; marker hub = origin }
            joint mounts = Fixed(block.support, ground)
            joint thrust = PointOnPlane(shaft.neck[1], block.shell[1])
            journal film[k in 1..2] = Impedance(shaft.neck[k], block.shell[k], diameter: 50 mm, width: 20 mm, radial_clearance: 25 um, viscosity: 10 mPa*s)
            joint bolts = Fixed(wheel.hub, shaft.end)
            load
            output wheel_at = dot(wheel.hub.origin, ground.z)
            output block_at = dot(block.support.origin, ground.z)
        }
        analysis turn = transient(Shaft(), duration: 1 ms, sample: 1 ms)";
    for load in [
        "force brake = RotationalDamper(wheel.hub, ground, damping: 0.001 N*m*s/rad)",
        "drive turn = PrescribedRotation(wheel.hub, ground, speed: 100 rad/s)",
    ] {
        let text = text.replace("            load\n", &format!("{load}\n"));
        let outcome = run(&crate::support::program(&text), "turn");
        let at = |path: &str| outcome.results.column(path).expect("an output").values[0];
        let (wheel, block) = (at("wheel_at"), at("block_at"));
        assert!((wheel - 0.23).abs() < 1e-6, "{load}: {wheel}");
        assert!(block.abs() < 1e-9, "{load}: {block}");
    }
}

/// A class places its parts: a pin in the middle of a bush, a ball and a sliding block in touch with a plate. Stated
/// positions and guesses have priority, and a stop that cannot be reached has no influence.
#[test]
fn a_class_places_its_parts() {
    let text = "use std.joints.Translational
        use std.contacts.Contact
        force Bush(pin: Marker, shell: Marker) {
            place pin on shell
            apply force -200 N/mm*(pin.origin - shell.origin) on pin against shell
        }
        force Pad() : Contact { fn push(depth: Length, rate: Velocity) -> Force = 1 kN/mm*depth }
        model Placed {
            param tilt: Angle = 30 deg
            param radius: Length = 12 mm
            gravity = [0, 0, -9.81] m/s^2
            marker plate = at([0, 0, 40] mm, z: [sin(tilt), 0, cos(tilt)])
            marker left = [100, 50, 0] mm
            marker right = [300, 50, 0] mm
            marker rail = [500, 0, 0] mm
            marker top = at([500, 0, 200] mm, z: [0, 0, -1])
            body beam { mass = 2 kg; inertia = [1, 8, 8] g*m^2; marker near = [-100, 0, 0] mm; marker far = [100, 0, 0] mm }
            body ball { mass = 1 kg; inertia = [1, 1, 1] g*m^2; guess velocity = [0, 0, 1] m/s }
            body stated { mass = 1 kg; inertia = [1, 1, 1] g*m^2; start position = [0, 7, 90] mm }
            body slide { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker foot = [0, 0, -20] mm; marker head = [0, 0, 20] mm }
            force bush_left = Bush(beam.near, left)
            force bush_right = Bush(beam.far, right)
            force on_plate = Pad(ball.origin, plate, reach: radius)
            force above = Pad(stated.origin, plate, reach: radius)
            joint guide = Translational(slide.origin, rail)
            force below = Pad(slide.foot, rail, reach: 5 mm)
            output beam_at = beam.origin.origin in ground as mm
            output beam_turned = dot(beam.origin.x, ground.x)
            output ball_at = ball.origin.origin in ground as mm
            output ball_turned = dot(ball.origin.z, ground.z)
            output stated_at = stated.origin.origin in ground as mm
            output slide_at = dot(slide.origin.origin, ground.z) as mm
        }
        model Stopped {
            gravity = [0, 0, -9.81] m/s^2
            marker rail = [0, 0, 0] mm
            marker top = at([0, 0, 200] mm, z: [0, 0, -1])
            body slide { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker foot = [0, 0, -20] mm; marker head = [0, 0, 20] mm }
            joint guide = Translational(slide.origin, rail)
            force below = Pad(slide.foot, rail, reach: 5 mm)
            force over = Pad(slide.head, top, reach: 5 mm)
            guess guide.travel = 3 mm
            output slide_at = dot(slide.origin.origin, ground.z) as mm
        }
        analysis placed = assemble(Placed())
        analysis guessed = assemble(Stopped())";
    let sources = Sources::from_texts([("places.eng".to_owned(), text.to_owned())]);
    let program = program(sources, "places.eng");
    let placed = run(&program, "placed").results;
    let at = |path: &str| placed.column(path).expect("a channel").values[0];
    let near = |path: &str, value: f64| {
        assert!(
            (at(path) - value).abs() < 1e-9,
            "{path}: {} {value}",
            at(path)
        );
    };
    near("beam_at.x", 0.2);
    near("beam_at.y", 0.05);
    near("beam_turned", 1.0);
    // the ball goes from the origin along the plate's normal n: n·(p − plate) = radius
    let (normal, below) = (
        [0.5, 30.0_f64.to_radians().cos()],
        0.012 + 0.04 * 30.0_f64.to_radians().cos(),
    );
    near("ball_at.x", normal[0] * below);
    near("ball_at.y", 0.0);
    near("ball_at.z", normal[1] * below);
    near("ball_turned", 1.0);
    near("stated_at.y", 0.007);
    near("stated_at.z", 0.09);
    near("slide_at", 0.025);
    // both stops cannot touch, and the guess decides
    let guessed = run(&program, "guessed").results;
    let slide = guessed.column("slide_at").expect("a channel").values[0];
    assert!((slide - 0.003).abs() < 1e-9, "{slide}");
}

/// Changes of a part give the bits of a text that states the changed values; the outermost change counts, and the value
/// follows the parameters of the text around.
#[test]
fn changes_of_a_part_are_those_of_its_text() {
    let text = |mass: [&str; 2], inertia: &str, angle: &str, arm: &str, pair: &str, more: &str| {
        format!(
            "use std.joints.Revolute
            use std.forces.LinearSpring
            component Arm(foot: Marker, mass: Mass, length: Length = 300 mm) {{
                body bar {{
                    mass = mass
                    inertia = {inertia}
                    marker near = [0, 0, 0] mm
                    marker far = [1, 0, 0]*length
                    start angular_velocity = [0, 0, 0.5] rad/s
                }}
                joint hinge = Revolute(bar.near, foot)
                start hinge.angle = {angle}
            }}
            component Pair(left: Marker, right: Marker, damping: Damping = 3 N*s/m) {{
                part arm[i in 1..2] = Arm([left, right][i], mass: [{}, {}][i]) {arm}
                force tie = LinearSpring(arm[1].bar.far, arm[2].bar.far, stiffness: 2 N/mm, damping: damping, free_length: 500 mm)
            }}
            model Frame {{
                param load: Mass = 2 kg
                gravity = [0, -9.81, 0] m/s^2
                marker left = [0, 0, 0] mm
                marker right = [500, 0, 0] mm
                part pair = Pair(left, right) {pair}
                {more}
                output mass = pair.arm[2].bar.mass
                output turned[i in 1..2] = pair.arm[i].hinge.angle as deg
            }}
            analysis swing = transient(Frame(), duration: 50 ms, sample: 1 ms)
            analysis heavy = transient(Frame(load: 3 kg), duration: 2 ms, sample: 1 ms)",
            mass[0], mass[1],
        )
    };
    let results = |text: String, analysis: &str| {
        let sources = Sources::from_texts([("arms.eng".to_owned(), text)]);
        run(&program(sources, "arms.eng"), analysis).results
    };
    let plain = text(["1 kg", "2 kg"], "[0.1, 9, 9] g*m^2", "40 deg", "", "", "")
        .replace("0.5] rad", "1] rad");
    let changed = text(
        ["3 kg", "3 kg"],
        "[0.1, 7, 7] g*m^2",
        "30 deg",
        "with { bar.mass = [1, 5][i]*1 kg; bar.inertia = [0.1, 9, 9] g*m^2; start hinge.angle = 10 deg }",
        "with { arm[2].bar.mass = load; tie.damping = 3 N*s/m; start arm[1].hinge.angle = 40 deg }",
        "start pair.arm[2].hinge.angle = 40 deg
         start pair.arm[1].bar.angular_velocity = [0, 0, 1] rad/s
         start pair.arm[2].bar.angular_velocity = [0, 0, 1] rad/s",
    );
    let (stated, found) = (results(plain, "swing"), results(changed.clone(), "swing"));
    for path in ["turned[1]", "turned[2]", "mass"] {
        let [column, other] = [&stated, &found].map(|r| r.column(path).expect("a channel"));
        assert_eq!(column.values, other.values, "{path}");
    }
    assert!(
        (stated.column("turned[1]").expect("a channel").values[0] - 40.0_f64.to_radians()).abs()
            < 1e-12
    );
    let heavy = results(changed, "heavy");
    assert_eq!(heavy.column("mass").expect("a channel").values[0], 3.0);
}

/// A crank beside its axis of rotation, which only films hold, starts as assembled about the axis of its
/// shells. About its centre of mass its energy would be less, and the films would have to carry a thousand
/// kilonewtons. A chain beside it changes nothing, although so many rows are solved in another way.
#[test]
fn films_keep_the_axis_of_an_assembled_start() {
    let text = "use std.journals.Impedance
use std.joints.{PointOnPlane, Revolute}
model Crank {
    gravity = [0, -9.81, 0] m/s^2
    marker seat[j in 1..2] = [0, 0, 100*(j - 1.5)] mm
    body crank {
        mass = 8 kg
        inertia = [30, 30, 20] g*m^2
        marker neck[j in 1..2] = [-12, 0, 100*(j - 1.5)] mm
        start angular_velocity = [0, 0, 1]*400 rad/s
    }
    joint thrust = PointOnPlane(crank.neck[1], seat[1])
    journal main[j in 1..2] = Impedance(crank.neck[j], seat[j], diameter: 54 mm, width: 24 mm, radial_clearance: 27 um, viscosity: 10 mPa*s)
    // chain
}
analysis run = transient(Crank(), duration: 0.1 ms, sample: 0.1 ms, start: assembled)
";
    let chain = "body bar[i in 1..40] {
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker begin = [-50, 0, 0] mm
        marker end = [50, 0, 0] mm
        start position = [100*i - 50, 500, 0] mm
    }
    marker pivot = [0, 500, 0] mm
    joint first = Revolute(bar[1].begin, pivot)
    joint next[i in 2..40] = Revolute(bar[i].begin, bar[i - 1].end)";
    let mut energies = Vec::new();
    for text in [text.to_owned(), text.replace("// chain", chain)] {
        let program = program(Sources::from_text("crank.eng", &text), "crank.eng");
        let outcome = run(&program, "run");
        let first = |path: &str| outcome.results.column(path).expect("a column").values[0];
        let due = 0.5 * 400.0 * 400.0 * (20e-3 + 8.0 * 12e-3 * 12e-3);
        let energy = first("energy.kinetic");
        assert!((energy / due - 1.0).abs() < 1e-9, "{energy} {due}");
        for journal in ["main[1].radial_load", "main[2].radial_load"] {
            assert!(first(journal) < 1.0, "{}", first(journal));
        }
        energies.push(energy);
    }
    assert!((energies[1] / energies[0] - 1.0).abs() < 1e-12);
}
