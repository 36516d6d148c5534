//! After the first steps, a step allocates no memory.

use eng::Sources;
use std::num::NonZeroUsize;
use std::path::Path;

#[test]
fn a_step_of_the_engine_allocates_nothing() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
    let sources = Sources::folder(&folder).expect("the example's folder");
    let model = eng::check(&sources, "inline4.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .model("Inline4")
        .unwrap_or_else(|error| panic!("{error}"));
    let mut simulation = model
        .simulation()
        .fixed_step(2e-5)
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    let mut channels = vec![0.0; model.channels().len()];
    let mut advance = |steps: usize| {
        for _ in 0..steps {
            simulation.step().unwrap_or_else(|error| panic!("{error}"));
            simulation
                .runtime()
                .evaluate_channels(&mut channels)
                .unwrap_or_else(|error| panic!("{error}"));
        }
    };
    // storage of the factors grows with the first factorisations
    advance(100);
    let counted = allocation_counter::measure(|| advance(100));
    assert_eq!(
        (counted.count_total, counted.bytes_max),
        (0, 0),
        "100 steps with outputs allocate {} times",
        counted.count_total
    );
}

/// Nor does a step of Radau IIA under error control, with its audit of energy.
#[test]
fn a_step_of_radau_allocates_nothing() {
    let text = include_str!("benchmarks/coasting.eng");
    let model = eng::check(&Sources::from_text("m.eng", text), "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .model("Coasting")
        .unwrap_or_else(|error| panic!("{error}"));
    let simulation = model.simulation().method(eng::Method::Radau);
    let mut simulation = simulation
        .tolerance(1.0)
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    let mut channels = vec![0.0; model.channels().len()];
    let mut advance = |steps: usize| {
        for _ in 0..steps {
            simulation.step().unwrap_or_else(|error| panic!("{error}"));
            simulation
                .runtime()
                .evaluate_channels(&mut channels)
                .unwrap_or_else(|error| panic!("{error}"));
        }
        // the error of a failed trial is allocated
        simulation.statistics().failed
    };
    let before = advance(100);
    let mut after = before;
    let counted = allocation_counter::measure(|| after = advance(100));
    assert_eq!(after, before, "a trial of the counted steps failed");
    assert_eq!(
        counted.count_total, 0,
        "100 steps with outputs allocate {} times",
        counted.count_total
    );
}

/// Nor does a step with films of every kind, nor their way to other threads and back.
#[test]
fn a_step_of_films_on_threads_allocates_nothing() {
    let kinds = [
        "",
        ", cavitation: mass_conserving",
        ", eye: Ring(waves: 6, thickness: 6 mm, width: 18 mm, modulus: 210 GPa)",
        ", piezo: 15 GPa^-1, roughness: Roughness(sigma: 0.5 um, asperity: 0.001, modulus: 100 GPa, boundary_friction: 0.02)",
    ];
    for (kind, threads) in kinds.into_iter().zip([2, 1, 1, 1]) {
        films_allocate_nothing(kind, threads);
    }
    films_allocate_nothing("", 1);
}

fn films_allocate_nothing(kind: &str, threads: usize) {
    let text = format!(
        "use std.journals.{{Film, Ring, Roughness, hole}}
model Rotor {{
    gravity = [0, -9.81, 0] m/s^2
    marker seats[k in 1..2] = [0, 0, [-50, 50][k]] mm
    body rotor {{
        mass = 20 kg
        inertia = [0.2, 0.2, 0.05] kg*m^2
        marker pins[k in 1..2] = [0, 0, [-50, 50][k]] mm
        start angular_velocity = [0, 0, 300] rad/s
    }}
    journal main[k in 1..2] = Film(rotor.pins[k], seats[k], diameter: 40 mm, width: 18 mm, radial_clearance: 20 um,
                                   viscosity: 10 mPa*s, around: 48, across: 9{kind},
                                   openings: [hole(at: 90 deg, hole_diameter: 6 mm, diameter: 40 mm, pressure: 2 bar)])
}}
"
    );
    let model = eng::check(&Sources::from_text("m.eng", &text), "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .model("Rotor")
        .unwrap_or_else(|error| panic!("{error}"));
    let threads = NonZeroUsize::new(threads).expect("not zero");
    let simulation = model.clone().threads(threads).simulation();
    let mut simulation = simulation
        .fixed_step(2e-5)
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    let mut channels = vec![0.0; model.channels().len()];
    let mut advance = |steps: usize| {
        for _ in 0..steps {
            simulation.step().unwrap_or_else(|error| panic!("{error}"));
            simulation
                .runtime()
                .evaluate_channels(&mut channels)
                .unwrap_or_else(|error| panic!("{error}"));
        }
    };
    advance(100);
    let counted = allocation_counter::measure(|| advance(100));
    assert_eq!(counted.count_total, 0, "{threads} threads{kind}");
}
