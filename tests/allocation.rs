//! After the first steps, a step allocates no memory.

use eng::Sources;
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
