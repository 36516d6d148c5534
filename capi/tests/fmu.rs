//! FMUs by FMI 3.0: bits, states, descriptions, wrong calls.

use crate::ROTOR;
use crate::importer::{Fmu, Three, command};
use eng::{Quantity, Sources};
use eng_c::fmi::three::*;
use std::path::Path;

/// Torque of the brake in a step.
fn torque(step: usize) -> f64 {
    (0.3 * step as f64).sin().abs() * 12.0
}

/// Communication points of different distances.
fn points() -> Vec<(f64, f64)> {
    let (mut time, mut points) = (0.0, Vec::new());
    for step in 0..60 {
        let length = if step % 3 == 0 { 0.013 } else { 0.01 };
        points.push((time, length));
        time += length;
    }
    points
}

/// Time and speed after each step, as bits, by `Simulation::advance`.
fn advanced(steps: Option<f64>) -> Vec<[u64; 2]> {
    let sources = Sources::from_text("model.eng", ROTOR);
    let program = eng::check(&sources, "model.eng")
        .into_program()
        .expect("a program");
    let (model, builder) = match steps {
        None => {
            let model = program.model("Rotor").expect("a model");
            (model.clone(), model.simulation())
        }
        Some(_) => {
            let analysis = program.analysis("braked").expect("an analysis");
            (
                analysis.model().clone(),
                analysis.simulation().expect("steps"),
            )
        }
    };
    let brake = model.input("brake").expect("an input");
    let inertia = model.parameter("inertia").expect("a parameter");
    let of = |parameter, value| {
        Quantity::si(value, model.describe(parameter).expect("its own").dimension)
    };
    let builder = builder
        .set(inertia, of(inertia, 0.05))
        .expect("a dimension");
    let builder = builder
        .set(brake.parameter(), of(brake.parameter(), torque(0)))
        .expect("a dimension");
    let mut simulation = builder.start().expect("a start");
    let speed = model.channel("speed").expect("a channel");
    let run = points()
        .into_iter()
        .enumerate()
        .map(|(step, (from, length))| {
            simulation
                .set_input(brake, torque(step))
                .expect("within limits");
            simulation.advance(from + length).expect("a step");
            [
                simulation.time().to_bits(),
                simulation.value(speed).expect("a value").to_bits(),
            ]
        });
    run.collect()
}

struct Rotor {
    fmu: Fmu,
    brake: u32,
    inertia: u32,
    speed: u32,
}

impl Rotor {
    fn new(name: &str, words: &[&str]) -> Rotor {
        let fmu = Fmu::of(name, ROTOR, words);
        Rotor {
            brake: fmu.reference("brake"),
            inertia: fmu.reference("inertia"),
            speed: fmu.reference("speed"),
            fmu,
        }
    }

    fn steps(&self, one: &Three, range: std::ops::Range<usize>) -> Vec<[u64; 2]> {
        let points = points();
        let run = range.map(|step| {
            let (from, length) = points[step];
            one.done(one.set(self.brake, torque(step)));
            one.done(one.step(from, length));
            [one.get(0).to_bits(), one.get(self.speed).to_bits()]
        });
        run.collect()
    }

    fn started(&self) -> Three {
        let one = Three::new(&self.fmu);
        one.done(one.set(self.inertia, 0.05));
        one.enter();
        one.done(one.set(self.brake, torque(0)));
        one.exit();
        one
    }
}

#[test]
fn steps_have_the_bits_of_advance() {
    let rotor = Rotor::new("fmu_bits", &[]);
    assert_eq!(rotor.steps(&rotor.started(), 0..60), advanced(None));
    // fixed steps of an analysis, whose grid most points leave
    let braked = Rotor::new("fmu_bits_of_an_analysis", &["--analysis", "braked"]);
    assert_eq!(braked.steps(&braked.started(), 0..60), advanced(Some(1e-3)));
}

#[test]
fn states_continue_with_the_same_bits() {
    let rotor = Rotor::new("fmu_states", &[]);
    let one = rotor.started();
    rotor.steps(&one, 0..20);
    let bytes = one.bytes();
    let whole = rotor.steps(&one, 20..60);
    // another instance, and the same one back in time
    let other = Three::new(&rotor.fmu);
    other.done(other.resume(&bytes));
    assert_eq!(rotor.steps(&other, 20..60), whole);
    one.done(one.resume(&bytes));
    assert_eq!(one.get(rotor.inertia), 0.05);
    assert_eq!(rotor.steps(&one, 20..60), whole);
    // a state before the start
    // SAFETY: the instance lives
    one.done(unsafe { fmi3Reset(one.instance) });
    one.done(one.set(rotor.inertia, 0.05));
    one.done(one.set(rotor.brake, torque(0)));
    let early = one.bytes();
    let third = Three::new(&rotor.fmu);
    third.done(third.resume(&early));
    third.initialize();
    assert_eq!(rotor.steps(&third, 0..60), advanced(None));

    let half = third.refused(third.resume(&bytes[..bytes.len() / 2]));
    assert!(half.contains("damaged"), "{half}");
    let none = third.refused(third.resume(b"something"));
    assert!(none.contains("no state of an FMU"), "{none}");
    let foreign = Rotor::new("fmu_states_foreign", &["--outputs", "speed,hinge.angle"]);
    let foreign = Three::new(&foreign.fmu).bytes();
    let other = third.refused(third.resume(&foreign));
    assert!(other.contains("by another FMU"), "{other}");
}

#[test]
fn wrong_calls_are_refused_with_the_reason() {
    let rotor = Rotor::new("fmu_wrong_calls", &[]);
    let fmu = &rotor.fmu;
    let no = Three::with(fmu, "another");
    assert!(no.instance.is_null());
    assert!(no.messages().join("").contains("tokens differ"));

    let one = Three::new(fmu);
    let refused = |status, wanted: &str| {
        let message = one.refused(status);
        assert!(message.contains(wanted), "{message}\n{wanted}");
    };
    refused(
        one.set(99, 1.0),
        "no variable with the value reference 99: they are below ",
    );
    refused(one.set(rotor.brake, f64::NAN), "brake cannot be NaN");
    refused(one.set(rotor.speed, 1.0), "speed is an output");
    refused(one.set(0, 1.0), "time is not set");
    refused(
        one.step(0.0, 0.1),
        "a step is not possible before the initialization",
    );
    // SAFETY: the instance lives
    let at_two = unsafe { fmi3EnterInitializationMode(one.instance, false, 0.0, 2.0, false, 0.0) };
    refused(at_two, "it cannot begin at 2 s");
    // limits of the text count at the start
    one.done(one.set(rotor.inertia, 2.0));
    one.enter();
    // SAFETY: the instance lives
    refused(
        unsafe { fmi3ExitInitializationMode(one.instance) },
        "inertia = 2000 g*m^2 is outside its limits",
    );
    one.done(one.set(rotor.inertia, 0.05));
    one.exit();
    refused(
        one.set(rotor.inertia, 0.06),
        "inertia is a parameter, which keeps its value from the start on",
    );
    refused(one.set(rotor.brake, 80.0), "outside its limits");
    one.done(one.step(0.0, 0.1));
    refused(
        one.step(0.0, 0.1),
        "a step begins at the present time, 0.1 s, and not at 0 s; to go back, restore a saved state",
    );
    refused(one.step(0.1, 0.0), "a step goes forward");
    refused(one.step(0.1, -0.1), "a step goes forward");
    refused(one.step(f64::NAN, 0.1), "a step goes forward");
    refused(one.step(0.1, 1e-15), "too short for a step");
    let mut number = 0;
    // SAFETY: the instance and the numbers live
    refused(
        unsafe { fmi3GetInt32(one.instance, &0, 1, &mut number, 1) },
        "64-bit floating-point numbers",
    );
    // SAFETY: the instance and the numbers live
    refused(
        unsafe { fmi3GetFloat64(one.instance, &0, 1, &mut 0.0, 2) },
        "2 values for 1 value references",
    );
    // SAFETY: the instance lives
    refused(unsafe { fmi3EnterEventMode(one.instance) }, "no event mode");
    // SAFETY: the instance lives
    refused(
        unsafe { fmi3SetFMUState(one.instance, std::ptr::null_mut()) },
        "null pointer",
    );
    // after all that it still steps
    one.done(one.step(0.1, 0.1));
    // SAFETY: the instance lives
    one.done(unsafe { fmi3Terminate(one.instance) });
    refused(one.step(0.2, 0.1), "after the end");
    // SAFETY: a null pointer is refused
    assert_eq!(
        unsafe {
            fmi3DoStep(
                std::ptr::null_mut(),
                0.0,
                1.0,
                true,
                std::ptr::null_mut(),
                std::ptr::null_mut(),
                std::ptr::null_mut(),
                std::ptr::null_mut(),
            )
        },
        3
    );
}

/// A wheel of 90 g m² falls from 100 rad/s to 900 rpm under 20 N m in `J Δω/T`: the step ends there.
#[test]
fn the_condition_of_an_analysis_ends_the_simulation() {
    let text = ROTOR.replace("step: 1 ms)", "stop: speed < 900 rpm)");
    let fmu = Fmu::of("fmu_stop", &text, &["--analysis", "braked"]);
    let one = Three::new(&fmu);
    one.enter();
    one.done(one.set(fmu.reference("brake"), 20.0));
    one.exit();
    one.done(one.step(0.0, 0.01));
    assert_eq!(one.step(0.01, 0.1), 2);
    let due = 0.09 * (100.0 - 900.0 * std::f64::consts::PI / 30.0) / 20.0;
    let time = one.get(0);
    assert!((time - due).abs() < 1e-9, "{time} {due}");
    let told = one.messages().join("");
    assert!(
        told.contains("ended by its condition speed < 900 rpm at t = 0.0258"),
        "{told}"
    );
    // a state of it stands there, too
    let other = Three::new(&fmu);
    other.done(other.resume(&one.bytes()));
    assert_eq!(other.get(0).to_bits(), time.to_bits());
    let message = one.refused(one.step(time, 0.1));
    assert!(message.contains("has ended the simulation"), "{message}");
}

#[test]
fn a_failed_condition_ends_the_step() {
    let text = ROTOR.replace(
        "apply torque -torque*b.z on a against b",
        "apply torque -torque*b.z on a against b; require dot(a.angular_velocity, b.z) > 50 rad/s else \"the wheel is too slow\"",
    );
    let fmu = Fmu::of("fmu_condition", &text, &[]);
    let one = Three::new(&fmu);
    one.done(one.set(fmu.reference("brake"), 20.0));
    one.initialize();
    let message = one.refused(one.step(0.0, 1.0));
    assert!(
        message.contains("the wheel is too slow") && message.contains("model.eng:"),
        "{message}"
    );
    let later = one.refused(one.step(0.0, 1.0));
    assert!(later.contains("after a failed step"), "{later}");
}

#[test]
fn descriptions_name_variables_and_units() {
    let rotor = Rotor::new("fmu_description", &[]);
    let text = &rotor.fmu.description;
    for wanted in [
        "name=\"inertia\" valueReference=\"1\" causality=\"parameter\" variability=\"fixed\" unit=\"kg*m^2\" displayUnit=\"g*m^2\" min=\"1e-3\" max=\"1e0\" start=\"4e-2\"",
        "name=\"brake\" valueReference=\"3\" causality=\"input\" variability=\"discrete\"",
        "name=\"speed\" valueReference=\"4\" causality=\"output\" variability=\"continuous\" unit=\"rad/s\" displayUnit=\"rpm\"",
        "<Unit name=\"kg*m^2/s^2\">\n      <BaseUnit m=\"2\" kg=\"1\" s=\"-2\"/>",
        "variableNamingConvention=\"structured\"",
    ] {
        assert!(text.contains(wanted), "{text}\n{wanted}");
    }
    // one that is computed from another is listed only if it is chosen
    assert!(!text.contains("name=\"disc\""));
    let chosen = Fmu::of(
        "fmu_chosen",
        ROTOR,
        &["--parameters", "disc,inertia", "--outputs", "hinge.*"],
    );
    assert!(
        chosen.description.contains("name=\"disc\""),
        "{}",
        chosen.description
    );
    assert!(
        chosen.description.contains("name=\"hinge.angle\""),
        "{}",
        chosen.description
    );
    // with the fixed number the disc no longer follows
    let one = Three::new(&chosen);
    one.done(one.set(chosen.reference("inertia"), 0.05));
    assert_eq!(one.get(chosen.reference("disc")), 0.025);
    one.done(one.set(chosen.reference("disc"), 0.01));
    assert_eq!(one.get(chosen.reference("disc")), 0.01);
    let page =
        std::fs::read_to_string(rotor.fmu.folder.join("documentation/index.html")).expect("a page");
    assert!(
        page.contains(
            "<td>brake</td><td>kg*m^2/s^2</td><td>N*m</td><td>0</td><td>-1</td><td>50</td>"
        ),
        "{page}"
    );
}

#[test]
fn a_flexible_body_travels_without_its_mesh() {
    let folder = crate::from_c::folder("fmu_flexible");
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/mesh/bar.bdf");
    std::fs::copy(mesh, folder.join("bar.bdf")).expect("a mesh");
    let text = "
model Free {
    gravity = [0, 0, 0] m/s^2
    flexible bar {
        mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
        modes = normal(2)
        damping = 1 %
        marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        start angular_velocity = [300, 40, 500] rad/s
    }
    output tip_velocity = bar.tip.velocity in ground
}
analysis fly = transient(Free(), duration: 1 ms, sample: 1 ms, step: 8 us)";
    let fmu = Fmu::in_folder(folder, text, &["--analysis", "fly"]);
    let texts: Vec<_> = std::fs::read_dir(fmu.resources().join("texts"))
        .expect("a folder")
        .collect();
    assert_eq!(texts.len(), 1, "{texts:?}");
    let program = eng::open(Path::new(&fmu.folder.with_file_name("model.eng"))).expect("a file");
    let analysis = program
        .program()
        .expect("a program")
        .analysis("fly")
        .expect("an analysis");
    let mut simulation = analysis
        .simulation()
        .expect("steps")
        .start()
        .expect("a start");
    let one = Three::new(&fmu);
    one.initialize();
    one.done(one.step(0.0, 1e-4));
    simulation.advance(1e-4).expect("a step");
    for axis in ["x", "y", "z"] {
        let path = format!("tip_velocity.{axis}");
        let channel = analysis.model().channel(&path).expect("a channel");
        let expected = simulation.value(channel).expect("a value");
        assert_eq!(one.get(fmu.reference(&path)).to_bits(), expected.to_bits());
    }
}

#[test]
fn wrong_choices_are_refused_before_anything_is_written() {
    let folder = crate::from_c::folder("fmu_wrong_choices");
    let model = folder.join("model.eng");
    let two = format!("{ROTOR}\nmodel Empty {{ }}\n");
    let driven = ROTOR.replace("Rotor(inertia: 60 g*m^2)", "Rotor(brake: ramp)")
        + "\ntable ramp(t: Time) -> Torque = points([0, 1] s, [0, 20] N*m)\n";
    let cubic = ROTOR.replace(
        "in (-1 N*m, 50 N*m)",
        "in (-1 N*m, 50 N*m), interpolation: cubic",
    );
    let silent = ROTOR.replace(
        "    output speed = dot(wheel.hub.angular_velocity, ground.z) as rpm\n",
        "",
    );
    let out = folder.join("out.fmu");
    let library = crate::from_c::library();
    let paths = [&model, &out, &library].map(|path| path.to_str().expect("a text"));
    for (text, words, wanted) in [
        (
            ROTOR,
            &["--outputs", "sped"][..],
            "there is no output sped; did you mean speed?",
        ),
        (
            ROTOR,
            &["--inputs", "inertia"],
            "`inertia` is a parameter, which keeps its value during a run",
        ),
        (
            ROTOR,
            &["--inputs", "spokes"],
            "spokes is a `const`, not a parameter",
        ),
        (ROTOR, &["--parameters", "brake"], "brake is an input"),
        (
            ROTOR,
            &["--parameters", "inertja"],
            "there is no parameter inertja; did you mean inertia?",
        ),
        (ROTOR, &["--model", "Motor"], "there is no model Motor"),
        (
            ROTOR,
            &["--analysis", "still"],
            "there is no analysis still",
        ),
        (&two, &[], "the models are: Rotor, Empty"),
        (
            &driven,
            &["--analysis", "braked", "--inputs", "brake"],
            "brake is driven by ramp in the text",
        ),
        (&cubic, &[], "brake has `interpolation: cubic`"),
        (&silent, &[], "the model states no output"),
        ("model Rotor { nothing }", &[], "model.eng:1:"),
    ] {
        std::fs::write(&model, text).expect("a model");
        let mut all = vec![
            "build",
            paths[0],
            "--to",
            "fmu",
            "--out",
            paths[1],
            "--library",
            paths[2],
        ];
        all.extend(words);
        let (code, text) = command(&all);
        assert_ne!(code, 0, "{text}");
        assert!(text.contains(wanted), "{text}\n{wanted}");
        assert!(!out.exists());
    }
    let (code, text) = command(&["build", paths[0], "--to", "fmu", "--library", "no.so"]);
    assert_eq!(
        (code, text.as_str()),
        (2, "error: the library no.so is no file\n")
    );
    let (code, text) = command(&["build", paths[0], "--to", "fmu", "--library", paths[0]]);
    assert_eq!(code, 2);
    assert!(
        text.contains("model.eng is no library of Eng: build it"),
        "{text}"
    );
    let (code, text) = command(&["build", "--to", "fmu", "--library", paths[2]]);
    assert_eq!(code, 2);
    assert!(text.contains("name the model's file"), "{text}");
}

#[test]
fn the_library_for_c_comes_with_its_header() {
    let folder = crate::from_c::folder("library_for_c");
    let library = crate::from_c::library();
    let paths = [&folder, &library].map(|path| path.to_str().expect("a text"));
    let (code, text) = command(&[
        "build",
        "--to",
        "library",
        "--out",
        paths[0],
        "--library",
        paths[1],
    ]);
    assert_eq!(code, 0, "{text}");
    let name = format!(
        "{}eng{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    assert!(folder.join(name).is_file() && folder.join("eng.h").is_file());
}
