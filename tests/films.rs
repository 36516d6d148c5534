//! Films that are solved on cells, against the table of solved films, the kernel itself and the power that a
//! drive needs.

use arrow_array::{Array, FixedSizeListArray, Float32Array};
use eng::Sources;
use eng_film::{Cavitation, Feed, Film, FilmSource, Inputs, Opening, Part};
use eng_report::figure::{Figure, FilmMap, FilmPanel};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

/// A rotor of 200 kg with an unbalance in one bearing; it does not tilt.
fn rotor(law: &str) -> String {
    format!(
        "use std.journals.{{Film, Reynolds}}
use std.joints.{{PointOnPlane, ParallelAxes}}
use std.drives.PrescribedRotation
model Rotor {{
    gravity = [0, -9.81, 0] m/s^2
    param speed: AngularVelocity = 3000 rpm
    marker seat = origin
    body rotor {{
        mass = 200 kg
        inertia = [1, 1, 1] kg*m^2
        center_of_mass = [50, 0, 0] um
        marker mid = origin
        start angular_velocity = [0, 0, 1]*speed
    }}
    joint thrust = PointOnPlane(rotor.mid, seat)
    joint flat = ParallelAxes(rotor.mid, seat)
    drive turn = PrescribedRotation(rotor.mid, seat, speed: speed)
    journal main = {law}
    cycle angle = rotation(rotor.mid, seat) {{ period = 360 deg }}
}}
analysis run = transient(Rotor(), duration: 3 rev, sample: 10 deg)
"
    )
}

const BEARING: &str = "diameter: 54 mm, width: 24 mm, radial_clearance: 27 um, viscosity: 8 mPa*s";

struct Run(eng::Outcome);

impl Run {
    fn of(text: &str) -> Run {
        let sources = Sources::from_text("m.eng", text);
        let program = match eng::check(&sources, "m.eng").into_program() {
            Ok(program) => program,
            Err(report) => panic!("{report}"),
        };
        let analysis = program.analysis("run").expect("an analysis");
        let outcome = analysis.run(&mut |_| {});
        Run(outcome.unwrap_or_else(|failed| panic!("{}", failed.error)))
    }

    /// The values of a column (SI) in the last of three turns.
    fn last_turn(&self, path: &str) -> Vec<f64> {
        let values = &self.0.results.column(path).expect("a column").values;
        values[values.len() - 36..].to_vec()
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// A solver gives the derivatives of those answers that the motion follows, and of no other: loads read
/// force, moment and torque, and the temperature of a film its loss and its side flow, too. `step_jacobian`
/// has their numbers.
#[test]
fn derivatives_are_of_answers_that_the_motion_reads() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/good");
    let loads = [true, true, true, true, true, false, false];
    for (file, read) in [("films.eng", loads), ("thermal.eng", [true; 7])] {
        let sources = Sources::folder(&folder).expect("the folder");
        let program = eng::check(&sources, file)
            .into_program()
            .unwrap_or_else(|report| panic!("{report}"));
        let analysis = program.analysis("run").expect("an analysis");
        let simulation = analysis.model().simulation().start();
        let mut simulation = simulation.expect("a start");
        let classes = &simulation.runtime().model().compiled.system.classes;
        let mut films = classes.iter().filter(|class| class.layout.answers > 0);
        let film = films.next().expect("a class with a film");
        assert_eq!(film.facts.differentiated, read, "{file}: {}", film.name);
        assert!(films.all(|film| film.facts.differentiated == read));
    }
}

/// The table comes from solutions extrapolated to infinitely many cells. So twice as many cells are nearer to it,
/// with nearly the second order.
#[test]
fn more_cells_come_nearer_to_the_table() {
    let ratio = |law: &str| mean(&Run::of(&rotor(law)).last_turn("main.film_ratio"));
    let table = ratio(&format!("Reynolds(rotor.mid, seat, {BEARING})"));
    let error =
        |cells: &str| ratio(&format!("Film(rotor.mid, seat, {BEARING}, {cells})")) / table - 1.0;
    let (coarse, fine) = (
        error("around: 36, across: 7"),
        error("around: 72, across: 13"),
    );
    println!("film ratio {table:.5}; off by {coarse:.2e} and {fine:.2e}");
    // the table itself is 2e-4 off
    assert!(coarse.abs() < 5e-4 && fine.abs() < 3e-4, "{coarse} {fine}");
}

/// The step keeps its matrix nearly as long as with a closed formula: its derivatives hold between the cells' changes of sides, too.
#[test]
fn the_step_keeps_its_matrix() {
    let counts = |law: &str| {
        let text = rotor(&format!("{law}(rotor.mid, seat, {BEARING})"));
        let run = Run::of(&text.replace("{Film, Reynolds}", &format!("{{{law}}}")));
        let counts = run.0.summary.expect("a summary").statistics;
        let a_step = |count: u64| count as f64 / counts.steps as f64;
        let found = [a_step(counts.factorizations), a_step(counts.iterations)];
        println!("{law}: {} steps, {found:.3?}", counts.steps);
        found
    };
    let (formula, film) = (counts("Impedance"), counts("Film"));
    for (formula, film) in formula.iter().zip(film) {
        assert!(film < 2.0 * formula, "{formula} {film}");
    }
}

/// In a steady orbit the power of the drive equals the heat.
#[test]
fn the_drive_gives_what_the_film_loses() {
    let law = format!("Film(rotor.mid, seat, {BEARING})");
    let run = Run::of(&rotor(&law));
    let lost = mean(&run.last_turn("main.power_loss"));
    let given = mean(&run.last_turn("turn.torque.z")) * 3000.0 * std::f64::consts::TAU / 60.0;
    println!("{given:.3} W given, {lost:.3} W lost");
    assert!((given / lost - 1.0).abs() < 5e-3, "{given} {lost}");
}

/// A shell that turns at 300 rad/s about a pin at rest: tilted, beside the middle of the shell, and above mid width.
/// The shell has a groove, and its ends are under pressure.
fn turning(more: &str, settings: &str) -> String {
    format!(
        "use std.journals.{{Film, axial_groove}}
use std.joints.{{Fixed, Revolute}}
use std.drives.PrescribedRotation
model Turning {{
    gravity = [0, 0, 0] m/s^2
    body pin {{
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker foot = origin
        marker neck = at([0.012, -0.005, 3] mm, z: [4e-4, -2e-4, 1])
    }}
    body shell {{
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker bore = origin
        start angular_velocity = [0, 0, 300] rad/s
    }}
    joint weld = Fixed(pin.foot, ground)
    joint hold = Revolute(shell.bore, ground)
    drive turn = PrescribedRotation(shell.bore, ground, speed: 300 rad/s)
    journal film = Film(pin.neck, shell.bore, diameter: 54 mm, width: 24 mm, radial_clearance: 27 um, viscosity: 8 mPa*s,
        openings: [axial_groove(at: 100 deg, length: 14 mm, width: 9 mm, diameter: 54 mm, pressure: 4 bar)], end_pressure: 0.3 bar,
        around: 36, across: 8{more})
}}
analysis run = transient(Turning(), duration: 10 ms, {settings})
"
    )
}

/// The film of the turning shell.
fn film_of_turning(rule: Cavitation) -> Film {
    let half = 9e-3 / 54e-3;
    let source = FilmSource {
        openings: vec![Opening {
            on: Part::Shell,
            around: [100_f64.to_radians() - half, 100_f64.to_radians() + half],
            across: [-7e-3, 7e-3],
            feed: Feed::Pressure,
        }],
        ..FilmSource::plain(27e-3, 24e-3, 27e-6, rule, [36, 8])
    };
    Film::new(source).expect("a film")
}

/// Inputs of the film from the pin as seen in the turning shell, at a time (s).
fn seen_by_the_shell(time: f64) -> Vec<f64> {
    seen_with(&[4e5], time)
}

/// The same for openings with these pressures (Pa).
fn seen_with(supply: &[f64], time: f64) -> Vec<f64> {
    let spin = 300.0;
    let (sin, cos) = (spin * time).sin_cos();
    // a vector that stands, as the turning shell sees it, and its rate there
    let seen = |v: [f64; 2]| {
        let seen = [cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]];
        (seen, [spin * seen[1], -spin * seen[0]])
    };
    let (eccentricity, rate) = seen(PIERCES);
    let (tilt, tilt_rate) = seen([4e-4, -2e-4]);
    Inputs {
        eccentricity,
        rate,
        tilt,
        tilt_rate,
        spin: -spin,
        turn: -spin * time,
        end_pressure: 0.3e5,
        supply,
        ..Inputs::still(8e-3)
    }
    .write()
}

/// The point at which the pin's axis pierces the middle of the shell (m).
const PIERCES: [f64; 2] = [0.012e-3 - 3e-3 * 4e-4, -0.005e-3 + 3e-3 * 2e-4];

/// Force, moment and torque are those of the kernel at the place, rates and spin that the shell sees; the
/// weld of the pin holds them.
#[test]
fn a_turning_shell_sees_the_kernels_loads() {
    let film = film_of_turning(Cavitation::Reynolds);
    has_the_kernels_loads(&turning("", "sample: 1 ms"), &film, &seen_by_the_shell);
}

/// A hole of the pin passes over the turning shell.
#[test]
fn a_hole_of_the_pin_turns_over_the_shell() {
    let hole = "hole(on: pin, at: -40 deg, hole_diameter: 7 mm, diameter: 54 mm, pressure: 9 bar, offset: 2 mm)";
    let text = turning("", "sample: 1 ms")
        .replace("pressure: 4 bar)]", &format!("pressure: 4 bar), {hole}]"))
        .replace("{Film, axial_groove}", "{Film, axial_groove, hole}");
    let mut source = film_of_turning(Cavitation::Reynolds).source().clone();
    let mut hole = Opening::hole(-40_f64.to_radians(), 2e-3, 7e-3, 27e-3, Feed::Pressure);
    hole.on = Part::Pin;
    source.openings.push(hole);
    let film = Film::new(source).expect("a film");
    has_the_kernels_loads(&text, &film, &|time| seen_with(&[4e5, 9e5], time));
    // the hole matters
    let (mut work, mut y) = (film.work(), [vec![0.0; 7], vec![0.0; 7]]);
    for (pressure, y) in [9e5, 0.0].into_iter().zip(&mut y) {
        film.solve(&seen_with(&[4e5, pressure], 2e-3), None, &[], &mut work, y)
            .expect("a solution");
    }
    assert!((y[0][0] - y[1][0]).hypot(y[0][1] - y[1][1]) > 0.01 * y[0][0].hypot(y[0][1]));
}

/// A starved opening that no film can have is refused with its reason: it is on the pin, or has a pressure.
#[test]
fn a_starved_opening_is_refused_with_its_reason() {
    for (opening, reason) in [
        (
            "on: pin, pressure: 0 bar",
            "opening 2 is on the pin and starved",
        ),
        (
            "on: pin, pressure: 2 bar",
            "opening 2 is on the pin and starved",
        ),
        (
            "pressure: 2 bar",
            "state `pressure: 0 bar` instead of 2 bar",
        ),
    ] {
        let hole = format!(
            "hole({opening}, content: 50 %, at: 40 deg, hole_diameter: 7 mm, diameter: 54 mm)"
        );
        let text = turning(", cavitation: mass_conserving", "sample: 1 ms")
            .replace("pressure: 4 bar)]", &format!("pressure: 4 bar), {hole}]"))
            .replace("{Film, axial_groove}", "{Film, axial_groove, hole}");
        let program = match eng::check(&Sources::from_text("m.eng", text), "m.eng").into_program() {
            Ok(program) => program,
            Err(report) => panic!("{report}"),
        };
        let run = program
            .analysis("run")
            .and_then(|analysis| analysis.run(&mut |_| {}).map_err(|failed| *failed.error));
        let error = run.expect_err("a refusal").to_string();
        assert!(error.contains(reason), "{opening}: {error}");
    }
}

/// A run of [`turning`] has force, moment and torque of a film at inputs, and so has the weld.
fn has_the_kernels_loads(text: &str, film: &Film, inputs: &dyn Fn(f64) -> Vec<f64>) {
    let run = Run::of(text);
    let column = |path: &str| run.0.results.column(path).expect("a column").values.clone();
    let (mut work, mut due) = (film.work(), vec![0.0; film.outputs()]);
    let time = column("time");
    for (at, time) in time.iter().enumerate() {
        let (sin, cos) = (300.0 * time).sin_cos();
        film.solve(&inputs(*time), None, &[], &mut work, &mut due)
            .expect("a solution");
        let size = due[0].hypot(due[1]);
        for (path, number) in [
            ("film.force.x", due[0]),
            ("film.force.y", due[1]),
            ("film.moment.x", due[2]),
            ("film.moment.y", due[3]),
            ("film.friction_torque", due[4]),
        ] {
            let found = column(path)[at];
            assert!(
                (found - number).abs() < 1e-7 * size,
                "{path}: {found} {number}"
            );
        }
        // the weld holds the pin against the film, about the ground's origin
        let back = |v: [f64; 2]| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]];
        let (force, moment) = (back([due[0], due[1]]), back([due[2], due[3]]));
        let arm = PIERCES[0] * force[1] - PIERCES[1] * force[0];
        for (path, number) in [
            ("weld.force.x", -force[0]),
            ("weld.force.y", -force[1]),
            ("weld.torque.x", -moment[0]),
            ("weld.torque.y", -moment[1]),
            ("weld.torque.z", due[4] - arm),
        ] {
            let found = column(path)[at];
            assert!(
                (found - number).abs() < 1e-7 * size,
                "{path}: {found} {number}"
            );
        }
    }
}

/// The oil in the cavity of the turning shell: with the steps of the run, the kernel alone reaches the same forces.
#[test]
fn oil_goes_on_from_step_to_step() {
    let settings = "sample: 0.1 ms, step: 0.1 ms";
    let run = Run::of(&turning(", cavitation: mass_conserving", settings));
    let column = |path: &str| run.0.results.column(path).expect("a column").values.clone();
    let film = film_of_turning(Cavitation::MassConserving);
    let (mut work, mut due) = (film.work(), vec![0.0; film.outputs()]);
    let mut memory = vec![0.0; film.memory()];
    film.start(&seen_by_the_shell(0.0), &mut work, &mut memory)
        .expect("a steady film");
    let mut turned = 0.0_f64;
    let steady = column("film.content")[0];
    for (at, time) in column("time").into_iter().enumerate() {
        let x = seen_by_the_shell(time);
        let step = (at > 0).then_some(1e-4);
        film.solve(&x, step, &memory, &mut work, &mut due)
            .expect("a solution");
        film.accept(&work, &mut memory);
        let size = due[0].hypot(due[1]);
        for (path, number) in [
            ("film.force.x", due[0]),
            ("film.force.y", due[1]),
            ("film.moment.x", due[2]),
            ("film.friction_torque", due[4]),
            ("film.content", film.summary(&work).content * size),
        ] {
            let scale = if path == "film.content" { size } else { 1.0 };
            let found = column(path)[at] * scale;
            let error = (found - number).abs() / size;
            assert!(error < 1e-6, "{path} at {time}: {found} {number}");
        }
        turned = turned.max((column("film.content")[at] - steady).abs());
    }
    // the groove passes the cavity: its oil does change
    assert!(turned > 0.01, "{turned}");
}

const FED: &str = "cavitation: mass_conserving, around: 36, across: 8, \
    openings: [axial_groove(at: 90 deg, length: 14 mm, width: 9 mm, diameter: 54 mm, pressure: 1 bar)]";

fn fed_rotor() -> String {
    let text = rotor(&format!("Film(rotor.mid, seat, {BEARING}, {FED})"));
    text.replace("{Film, Reynolds}", "{Film, axial_groove}")
}

/// A run that continues from a checkpoint has the oil of the run that was never stopped, to the last bit.
#[test]
fn a_checkpoint_holds_the_oil() {
    let sources = Sources::from_text("m.eng", fed_rotor());
    let program = eng::check(&sources, "m.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let model = program.model("Rotor").expect("a model");
    let mut through = model.simulation().start().expect("a start");
    for _ in 0..40 {
        through.step().expect("a step");
    }
    let saved = through.checkpoint();
    let mut resumed = model.simulation().resume(&saved).expect("a checkpoint");
    for _ in 0..40 {
        through.step().expect("a step");
        resumed.step().expect("a step");
    }
    for path in ["main.force.x", "main.content", "main.unexplained_flow"] {
        let channel = model.channel(path).expect("a channel");
        let both = [&mut through, &mut resumed].map(|s| s.value(channel).expect("a value"));
        assert_eq!(both[0].to_bits(), both[1].to_bits(), "{path}");
        assert!(both[0] != 0.0, "{path}");
    }
}

/// Ten times finer steps change the orbit and the oil little, and the usual steps lose almost none of it.
#[test]
fn finer_steps_change_the_oil_little() {
    let usual = Run::of(&fed_rotor());
    let finer = fed_rotor().replace("sample: 10 deg", "sample: 10 deg, tolerance: 0.03");
    let finer = Run::of(&finer);
    for (path, limit) in [("main.film_ratio", 1e-3), ("main.content", 1e-3)] {
        let [usual, finer] = [&usual, &finer].map(|run| mean(&run.last_turn(path)));
        println!("{path}: {usual:.5} {finer:.5}");
        assert!((usual / finer - 1.0).abs() < limit, "{path}");
    }
    let flow = mean(&usual.last_turn("main.side_flow"));
    let lost = |run: &Run| -> [f64; 2] {
        let flows = run.last_turn("main.unexplained_flow");
        let squares: Vec<f64> = flows.iter().map(|flow| flow * flow).collect();
        [mean(&flows).abs() / flow, mean(&squares).sqrt() / flow]
    };
    let [usual, finer] = [&usual, &finer].map(lost);
    println!("unexplained oil, mean and rms: {usual:.5?}, in finer steps {finer:.5?} of the flow");
    assert!(usual[0] < 0.02 && finer[0] < 0.02);
    // flows of both signs may cancel in the mean: their size shows the order of the step
    assert!(finer[1] < 0.6 * usual[1] && finer[1] > 0.0);
}

/// At low speed asperities carry a part of the load and brake. The power of the drive equals the heat.
#[test]
fn asperities_carry_and_brake() {
    let law = format!(
        "Film(rotor.mid, seat, {BEARING}, around: 72, across: 8, roughness: Roughness(sigma: 1 um, asperity: 2e-3, modulus: 100 GPa, \
         boundary_friction: 0.1), thinning: Thinning(second: 0.5, rate: 1e5 s^-1))"
    );
    let text = rotor(&law)
        .replace("{Film, Reynolds}", "{Film, Roughness, Thinning}")
        .replace("3000 rpm", "60 rpm")
        .replace("200 kg", "600 kg");
    let run = Run::of(&text);
    let share = mean(&run.last_turn("main.asperity_share"));
    let lost = mean(&run.last_turn("main.power_loss"));
    let rubbed = mean(&run.last_turn("main.boundary_power"));
    let given = mean(&run.last_turn("turn.torque.z")) * 60.0 * std::f64::consts::TAU / 60.0;
    println!(
        "share {share:.3}, {given:.4} W given, {lost:.4} W lost, {rubbed:.4} W of it by asperities"
    );
    assert!(share > 0.02 && share < 0.98, "{share}");
    assert!(rubbed > 0.1 * lost, "{rubbed} {lost}");
    assert!((given / lost - 1.0).abs() < 1e-2, "{given} {lost}");
    let load = mean(&run.last_turn("main.force.y"));
    assert!((load / (600.0 * 9.81) - 1.0).abs() < 1e-3, "{load}");
}

/// In an eye so thin that its pin passes the circle of the clearance, a quasi-static start finds the load of
/// a rigid eye.
#[test]
fn a_start_passes_the_circle_of_the_clearance() {
    let text = include_str!("../examples/big_end/big_end.eng");
    let (model, _) = text
        .split_once("analysis rigid")
        .expect("its first analysis");
    let coarse = model.replace("around: 72, across: 9", "around: 36, across: 5");
    let analyses = "analysis rigid = transient(BigEnd(), duration: 4 deg, sample: 2 deg)
        analysis elastic = transient(BigEnd(waves: 10, thickness: 9 mm), duration: 4 deg, sample: 2 deg)";
    let pressure = include_str!("../examples/big_end/pressure.csv");
    let coarse = format!("{coarse}\n{analyses}");
    let texts = [("big_end.eng", coarse.as_str()), ("pressure.csv", pressure)];
    let sources = Sources::from_texts(texts.map(|(name, text)| (name.to_owned(), text.to_owned())));
    let program = eng::check(&sources, "big_end.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let [(load, ratio), (elastic_load, elastic_ratio)] = ["rigid", "elastic"].map(|name| {
        let outcome = program
            .analysis(name)
            .expect("an analysis")
            .run(&mut |_| {});
        let outcome = outcome.unwrap_or_else(|failed| panic!("{}", failed.error));
        assert!(
            matches!(outcome.start, Some(eng::StartReport::QuasiStatic(_))),
            "{name}: {:?}",
            outcome.start
        );
        let first = |path: &str| outcome.results.column(path).expect("a column").values[0];
        (first("big_end.radial_load"), first("big_end.film_ratio"))
    });
    println!(
        "rigid: {load:.0} N at {ratio:.3}; elastic: {elastic_load:.0} N at {elastic_ratio:.3}"
    );
    assert!(
        ratio < 1.0 && elastic_ratio > 1.05,
        "{ratio} {elastic_ratio}"
    );
    assert!(
        (elastic_load / load - 1.0).abs() < 5e-3,
        "{load} {elastic_load}"
    );
}

/// The example of the elastic big end on a coarse grid. Under the same load an elastic eye has a lower pressure and a
/// thicker film, and the pin goes beyond the circle of the clearance.
#[test]
fn an_elastic_eye_spreads_the_load() {
    let text = include_str!("../examples/big_end/big_end.eng");
    let coarse = text.replace("around: 72, across: 9", "around: 36, across: 5");
    assert_ne!(text, coarse);
    let pressure = include_str!("../examples/big_end/pressure.csv");
    let texts = [("big_end.eng", coarse.as_str()), ("pressure.csv", pressure)];
    let sources = Sources::from_texts(texts.map(|(name, text)| (name.to_owned(), text.to_owned())));
    let program = eng::check(&sources, "big_end.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let [rigid, elastic] = ["rigid", "elastic"].map(|name| {
        let analysis = program.analysis(name).expect("an analysis");
        let outcome = analysis.run(&mut |_| {});
        let results = outcome
            .unwrap_or_else(|failed| panic!("{}", failed.error))
            .results;
        // the first eighth of the run is the start
        move |path: &str| {
            let values = &results.column(path).expect("a column").values;
            values[values.len() / 9..].to_vec()
        }
    });
    let most = |values: Vec<f64>| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let least = |values: Vec<f64>| values.into_iter().fold(f64::INFINITY, f64::min);
    let ratio = |path: &str| most(elastic(path)) / most(rigid(path));
    let (load, pressure) = (
        ratio("big_end.radial_load"),
        ratio("big_end.maximum_pressure"),
    );
    let film = least(elastic("big_end.minimum_film")) / least(rigid("big_end.minimum_film"));
    let reach = most(elastic("big_end.film_ratio"));
    println!("load {load:.4}, pressure {pressure:.3}, film {film:.3}, ratio {reach:.3}");
    assert!((load - 1.0).abs() < 1e-2, "{load}");
    assert!(pressure < 0.75, "{pressure}");
    assert!(film > 1.05 && film < 2.0, "{film}");
    assert!(reach > 1.0 && reach < 1.2, "{reach}");
    assert!(most(rigid("big_end.film_ratio")) < 1.0);
    assert!(most(elastic("big_end.deflection")) > 5e-6);
}

/// A fed rotor with three maps, in a run or in a cycle that repeats.
fn mapped(rule: &str, analysis: &str) -> String {
    let law = format!(
        "Film(rotor.mid, seat, {BEARING}, around: 36, across: 8, cavitation: {rule},
        openings: [axial_groove(at: 350 deg, length: 14 mm, width: 20 mm, diameter: 54 mm, pressure: 4 bar)])"
    );
    let text = rotor(&law).replace("{Film, Reynolds}", "{Film, axial_groove}");
    let (model, _) = text.split_once("analysis").expect("an analysis");
    format!(
        "{model}analysis run = {analysis}
report maps {{
    figure pressed = film(run.main, pressure, at: 200 deg)
    figure least = film(run.main, gap, at: minimum_at(last_cycle(run.main.minimum_film)))
    figure oil = film(run.main, content, at: minimum_at(last_cycle(run.main.minimum_film)))
    figure late = film(run.main, asperity_pressure, at: 9 s)
}}
"
    )
}

/// The results of a run, and the maps of its report.
fn maps(text: &str) -> (eng::Results, Vec<Result<FilmMap, String>>) {
    maps_of(&Sources::from_text("m.eng", text))
}

/// Results of the analysis `run` of the text `m.eng`, and the maps of its report.
pub(crate) fn maps_of(sources: &Sources) -> (eng::Results, Vec<Result<FilmMap, String>>) {
    let program = match eng::check(sources, "m.eng").into_program() {
        Ok(program) => program,
        Err(report) => panic!("{report}"),
    };
    let run = program.analysis("run").expect("an analysis");
    let outcome = run.run(&mut |_| {});
    let outcome = outcome.unwrap_or_else(|failed| panic!("{}", failed.error));
    let machine = run.machine().expect("its machine");
    let of = |motion| {
        let runs = [eng::post::Run::new(&outcome.results, &machine).with_motion(motion)];
        let made = eng::post::evaluate(&program.reports()[0], &runs);
        let entries = made.entries.into_iter().map(|entry| match entry.outcome {
            Ok(eng::post::Outcome::Figure(figure)) => match *figure {
                Figure::FilmMap(map) => Ok(map),
                other => panic!("{}", other.title()),
            },
            Ok(other) => panic!("{other:?}"),
            Err(error) => Err(error.to_string()),
        });
        entries.collect::<Vec<_>>()
    };
    let untold = |map: &Result<FilmMap, String>| {
        let told = map.as_ref().err();
        told.is_some_and(|told| told.contains("the results have no motion"))
    };
    assert!(of(None).iter().all(untold));
    let maps = of(Some(&outcome.motion));
    (outcome.results, maps)
}

/// The map of a film is solved again from the numbers that the motion keeps. Its pressure carries the
/// recorded force, and its largest and least cells are next to the recorded extremes.
#[test]
fn a_map_carries_the_recorded_force() {
    let transient = "transient(Rotor(), duration: 3 rev, sample: 10 deg)";
    let periodic = "periodic(Rotor(), cycles: 60, sample: 10 deg)";
    for (rule, analysis) in [
        ("reynolds", transient),
        ("mass_conserving", transient),
        ("mass_conserving", periodic),
    ] {
        let (results, maps) = maps(&mapped(rule, analysis));
        let [pressed, least, oil, late] = maps.as_slice() else {
            panic!("{} maps", maps.len());
        };
        let told = late.as_ref().expect_err("no such moment");
        assert!(told.contains("no moment at 9 s"), "{told}");
        let of = |map: &Result<FilmMap, String>| map.clone().expect("a map");
        let (pressed, least, oil) = (of(pressed), of(least), of(oil));
        let column = |path: &str| results.column(path).expect("a column").values.clone();
        let angles = column("cycle.angle");
        // the same angle in the last turn
        let last = angles.last().expect("samples");
        let wanted = 200_f64.to_radians();
        let wanted =
            wanted + std::f64::consts::TAU * ((last - wanted) / std::f64::consts::TAU).floor();
        let sample = angles.iter().position(|a| (a - wanted).abs() < 1e-6);
        let sample = sample.expect("a sample at the angle");
        let panel = &pressed.panels[0];
        assert_eq!(
            (pressed.unit.as_str(), panel.frame.as_str()),
            ("MPa", "seat")
        );
        let force = force_of(panel);
        for (found, path) in force.iter().zip(["main.force.x", "main.force.y"]) {
            let recorded = column(path)[sample];
            let size = column("main.radial_load")[sample];
            assert!(
                (found - recorded).abs() < 1e-9 * size,
                "{rule} {analysis}: {found} {recorded}"
            );
        }
        let highest = panel.values.iter().copied().fold(0.0, f64::max);
        let recorded = column("main.maximum_pressure")[sample] / 1e6;
        assert!(
            highest <= recorded && highest > 0.95 * recorded,
            "{highest} {recorded}"
        );
        assert_eq!(
            panel.openings,
            [[
                [
                    350.0 - 1.0_f64.to_degrees() * 20.0 / 54.0,
                    350.0 + 1.0_f64.to_degrees() * 20.0 / 54.0,
                ],
                [-7.0, 7.0]
            ]]
        );
        let thinnest = least.panels[0]
            .values
            .iter()
            .copied()
            .fold(f64::MAX, f64::min);
        let recorded = column("main.minimum_film");
        let recorded = recorded[recorded.len() - 36..]
            .iter()
            .copied()
            .fold(f64::MAX, f64::min)
            * 1e6;
        assert!(
            thinnest >= recorded && thinnest < 1.1 * recorded,
            "{thinnest} {recorded}"
        );
        let content = &oil.panels[0].values;
        assert!(content.iter().all(|share| (0.0..=1.0).contains(share)));
        assert_eq!(
            content.iter().any(|share| *share < 0.9),
            rule == "mass_conserving"
        );
    }
}

/// `-int p n dA` of a panel (N).
fn force_of(panel: &FilmPanel) -> [f64; 2] {
    let rows = panel.across.len() - 1;
    let mut force = [0.0; 2];
    for (column, sides) in panel.values.chunks(rows).zip(panel.around.windows(2)) {
        let [from, to] = [sides[0], sides[1]].map(f64::to_radians);
        for (pressure, ends) in column.iter().zip(panel.across.windows(2)) {
            let load = 1e6 * pressure * 27e-3 * 1e-3 * (ends[1] - ends[0]);
            force[0] -= load * (to.sin() - from.sin());
            force[1] += load * (to.cos() - from.cos());
        }
    }
    force
}

/// The stated error of the cells is that against the table of `Reynolds`, which comes from extrapolated
/// solutions: of the steady film the load is fixed, so the pin is too near to the middle by it.
#[test]
fn the_error_of_the_cells_is_told() {
    let sources = |law: &str| {
        let text = rotor(&format!("{law}(rotor.mid, seat, {BEARING})"))
            .replace("center_of_mass = [50, 0, 0] um", "");
        Sources::from_text("m.eng", text)
    };
    let of = |law: &str| {
        let program = eng::check(&sources(law), "m.eng").into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let analysis = program.analysis("run").expect("an analysis");
        let ran = eng::run::run(&analysis, true, &mut |_| {});
        ran.unwrap_or_else(|failed| panic!("{}", failed.error))
    };
    let film = of("Film");
    let table = of("Reynolds");
    let last = |run: &eng::run::RunOutcome| {
        *run.results
            .column("main.minimum_film")
            .expect("a film")
            .values
            .last()
            .expect("samples")
    };
    let off = 1e6 * (last(&film) - last(&table));
    let told: Vec<&String> = film
        .facts
        .iter()
        .filter(|fact| fact.starts_with("cells of main"))
        .collect();
    println!("{off:.4} µm off; {told:?}");
    let [told] = told.as_slice() else {
        panic!("{:?}", film.facts);
    };
    let (_, end) = told.split_once("the least film of ").expect("a film");
    let words: Vec<&str> = end.split_whitespace().collect();
    let [_, "µm", "is", stated, "µm", "too", "thin"] = words.as_slice() else {
        panic!("{end}");
    };
    let stated = -stated.parse::<f64>().expect("a number");
    assert!((stated / off - 1.0).abs() < 0.15, "{stated} {off}");
    assert!(
        told.starts_with(
            "cells of main, 72 × 13: compared with twice as many cells in both directions (at the "
        ) && told.contains(
            " most critical of 20 moments), the load at the same position of the pin is up to"
        ) && told.contains("% too low; at the same load the highest pressure is up to"),
        "{told}"
    );
    assert!(table.facts.iter().all(|fact| !fact.starts_with("cells")));
}

/// The stated error is that at the same load, against an extrapolation from twice and four times as many cells both ways.
#[test]
fn the_error_of_the_pressure_is_that_at_the_same_load() {
    let of = |cells: [u32; 2]| {
        let [around, across] = cells;
        let law = format!("Film(rotor.mid, seat, {BEARING}, around: {around}, across: {across})");
        let text = rotor(&law)
            .replace("center_of_mass = [50, 0, 0] um", "")
            .replace("viscosity: 8 mPa*s", "viscosity: 10 mPa*s")
            .replace("mass = 200 kg", "mass = 1000 kg")
            .replace("3 rev, sample: 10", "10 deg, sample: 5");
        let program = eng::check(&Sources::from_text("m.eng", text), "m.eng").into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let analysis = program.analysis("run").expect("an analysis");
        let run = eng::run::run(&analysis, true, &mut |_| {});
        let run = run.unwrap_or_else(|failed| panic!("{}", failed.error));
        let column = |path: &str| run.results.column(path).expect("a column").values[0];
        let numbers = ["main.maximum_pressure", "main.minimum_film"].map(column);
        let facts = run.facts.iter();
        let told = facts.filter(|fact| fact.starts_with("cells of main"));
        (numbers, told.cloned().collect::<String>())
    };
    let ((own, told), (half, _), (quarter, _)) = (of([36, 7]), of([72, 14]), of([144, 28]));
    let exact = [0, 1].map(|k| quarter[k] + (quarter[k] - half[k]) / 3.0);
    let pressure = 100.0 * (own[0] / exact[0] - 1.0);
    let film = 1e6 * (own[1] - exact[1]);
    println!("{pressure:.3} %, {film:.4} µm; {told}");
    let number = |before: &str, after: &str| -> f64 {
        let (_, rest) = told.split_once(before).unwrap_or_else(|| panic!("{told}"));
        let (number, _) = rest.split_once(after).unwrap_or_else(|| panic!("{told}"));
        number
            .parse()
            .unwrap_or_else(|_| panic!("{number} of {told}"))
    };
    let stated = number("the highest pressure is up to ", " % too high");
    assert!(
        (stated - pressure).abs() < 0.15 * pressure.abs(),
        "{stated} {pressure}"
    );
    let (_, film_told) = told.split_once("the least film of ").expect("a film");
    let stated: f64 = film_told
        .split(' ')
        .nth(3)
        .expect("a word")
        .parse()
        .expect("a number");
    // errors of the cells around do not fall with a clean square: the stated error of the film is 21 % too large here
    assert!((-stated - film).abs() < 0.3 * film.abs(), "{stated} {film}");
}

/// The film of a turning shell about a pin at rest is that of a turning pin in a shell at rest, and so are the stated errors
/// of its cells. At each sample the shell has turned by a whole cell.
#[test]
fn the_error_at_the_same_load_does_not_depend_on_the_part_that_turns() {
    let told = |of_pin: u32, of_shell: u32| {
        let text = format!(
            "use std.journals.Film
use std.joints.Revolute
use std.drives.PrescribedRotation
model Turning {{
    gravity = [0, 0, 0] m/s^2
    param of_pin: AngularVelocity = {of_pin} rpm
    param of_shell: AngularVelocity = {of_shell} rpm
    marker middle = at([0.012, -0.018, 0] mm)
    body pin {{
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker hold = at([0.012, -0.018, 0] mm)
        start angular_velocity = [0, 0, 1]*of_pin
    }}
    body shell {{
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker hold = origin
        start angular_velocity = [0, 0, 1]*of_shell
    }}
    joint pivot = Revolute(pin.hold, middle)
    joint bearing = Revolute(shell.hold, ground)
    drive turn_pin = PrescribedRotation(pin.hold, middle, speed: of_pin)
    drive turn_shell = PrescribedRotation(shell.hold, ground, speed: of_shell)
    journal film = Film(pin.hold, shell.hold, {BEARING}, around: 36, across: 6)
}}
analysis run = transient(Turning(), duration: 10 ms, sample: 10 ms/18)
"
        );
        let program = eng::check(&Sources::from_text("m.eng", text), "m.eng").into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let analysis = program.analysis("run").expect("an analysis");
        let run = eng::run::run(&analysis, true, &mut |_| {});
        let run = run.unwrap_or_else(|failed| panic!("{}", failed.error));
        let mut facts = run.facts.iter();
        let told = facts.find_map(|fact| Some(fact.split_once("at the same load")?.1.to_owned()));
        told.unwrap_or_else(|| panic!("{:?}", run.facts))
    };
    assert_eq!(told(3000, 0), told(0, 3000));
}

/// A film that keeps its oil has a line that says why no error is known. With little pressure at the ends the oil does not fill
/// the outermost cells of the diverging gap, and the line says so.
#[test]
fn a_film_with_memory_says_that_its_error_is_not_known() {
    let told = |pressure: &str| {
        let law = format!(
            "Film(rotor.mid, seat, {BEARING}, around: 36, across: 8, cavitation: mass_conserving, end_pressure: {pressure})"
        );
        let text = rotor(&law).replace("3 rev, sample: 10", "20 deg, sample: 5");
        let program = eng::check(&Sources::from_text("m.eng", text), "m.eng").into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let analysis = program.analysis("run").expect("an analysis");
        let run = eng::run::run(&analysis, true, &mut |_| {});
        let run = run.unwrap_or_else(|failed| panic!("{}", failed.error));
        let mut facts = run.facts.into_iter();
        facts
            .find(|fact| fact.starts_with("cells of main, 36 × 8"))
            .expect("a line")
    };
    for (pressure, unfilled) in [("0.1 bar", true), ("30 bar", false)] {
        let told = told(pressure);
        println!("{told}");
        assert!(
            told.contains("the error of the cells is not known"),
            "{told}"
        );
        assert_eq!(told.contains("of the flooded ends"), unfilled, "{told}");
    }
}

/// A hole of the pin fills cell after cell, so the places of extremes, the cavity and the slopes of the film never repeat
/// exactly. The motion repeats, and `periodic` ends without doubt about the noise of its steps.
#[test]
fn what_jumps_from_cell_to_cell_need_not_repeat() {
    let law = format!(
        "Film(rotor.mid, seat, {BEARING}, around: 36, across: 8, cavitation: mass_conserving, openings: [hole(at: 90 deg, \
         hole_diameter: 8 mm, diameter: 54 mm, pressure: 4 bar, on: pin)])"
    );
    let text = rotor(&law)
        .replace("std.journals.{", "std.journals.{hole, ")
        .replace(
            "transient(Rotor(), duration: 3 rev, sample: 10 deg)",
            "periodic(Rotor(), sample: 1 deg)",
        );
    let program = eng::check(&Sources::from_text("m.eng", text), "m.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let analysis = program.analysis("run").expect("an analysis");
    let outcome = analysis.run(&mut |_| {});
    let outcome = outcome.unwrap_or_else(|failed| panic!("{}", failed.error));
    let found = outcome.periodic.expect("a periodic analysis");
    assert!(found.repeats && found.noise.is_none(), "{found:?}");
}

/// The file of the cells has a list of all cells at each moment, and its pressure is highest where the run
/// has its highest.
#[test]
fn a_file_has_the_cells_of_all_moments() {
    let text = mapped(
        "reynolds",
        "transient(Rotor(), duration: 3 rev, sample: 10 deg)",
    );
    let sources = Sources::from_text("m.eng", &text);
    let program = eng::check(&sources, "m.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let run = program.analysis("run").expect("an analysis");
    let outcome = run.run(&mut |_| {});
    let outcome = outcome.unwrap_or_else(|failed| panic!("{}", failed.error));
    let mut described = program.describe(&[&outcome.results]).expect("the model");
    let (results, motion) = (outcome.results, outcome.motion);
    let moments = motion.samples();
    let highest = results.column("main.maximum_pressure").expect("a column");
    let last = &highest.values[highest.values.len() - moments..];
    let highest = last.iter().copied().fold(0.0, f64::max) / 1e6;
    let entry = eng::report::Entry::new(results, Some(motion), described.remove(0), Vec::new());
    let folder = std::env::temp_dir().join(format!("eng-cells-{}", std::process::id()));
    let path = eng::report::write_fields(&entry, &folder)
        .expect("films")
        .expect("a file");
    assert!(path.ends_with("run.fields.parquet"));
    let file = std::fs::File::open(&path).expect("the file");
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).expect("a table");
    let field = reader
        .schema()
        .field_with_name("main.pressure")
        .expect("a column")
        .clone();
    let about = |key: &str| field.metadata().get(key).map(String::as_str);
    assert_eq!(
        (about("unit"), about("frame"), about("rows")),
        (Some("MPa"), Some("seat"), Some("8"))
    );
    let batches: Vec<_> = reader
        .build()
        .expect("rows")
        .collect::<Result<_, _>>()
        .expect("rows");
    assert_eq!(batches.iter().map(|b| b.num_rows()).sum::<usize>(), moments);
    let mut most = 0.0_f32;
    for batch in &batches {
        let column = batch.column_by_name("main.pressure").expect("a column");
        let lists = column
            .as_any()
            .downcast_ref::<FixedSizeListArray>()
            .expect("lists");
        assert_eq!(lists.value_length(), 36 * 8);
        let values = lists
            .values()
            .as_any()
            .downcast_ref::<Float32Array>()
            .expect("numbers");
        most = values.values().iter().copied().fold(most, f32::max);
    }
    let most = f64::from(most);
    assert!(most <= highest && most > 0.95 * highest, "{most} {highest}");
    std::fs::remove_dir_all(&folder).expect("removed");
}
