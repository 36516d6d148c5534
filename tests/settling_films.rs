//! Periodic analyses of films at a kept speed: the first cycle has wider steps, and the next one fewer samples.

use eng::{Outcome, Program, Sources};
use std::path::Path;

/// The concept engine on films at some speeds (rpm): `soon` with the first cycle for the films, and `plain` without it, because so
/// few cycles are permitted.
fn concept() -> Program {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/concept");
    let text = std::fs::read_to_string(folder.join("concept.eng")).expect("the example");
    let (model, _) = text
        .split_once("analysis fired")
        .expect("its first analysis");
    let analyses = "
analysis soon = periodic(Concept(speed: 2000 rpm), change: 1 %)
analysis plain = periodic(Concept(speed: 2000 rpm), change: 1 %, cycles: 11)
";
    let sources = Sources::from_text("concept.eng", format!("{model}{analyses}"));
    eng::check(&sources, "concept.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
}

fn run(program: &Program, analysis: &str) -> Outcome {
    program
        .analysis(analysis)
        .unwrap_or_else(|error| panic!("{error}"))
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error))
}

fn steps(outcome: &Outcome) -> u64 {
    outcome.summary.as_ref().expect("a run").statistics.steps
}

/// The films of an engine forget the wider steps of the first cycle, so the last cycle is that of a run without them. It has all of
/// its samples, and the second one a quarter.
#[test]
fn wider_steps_of_the_first_cycle_leave_no_trace() {
    let program = concept();
    let (soon, plain) = (run(&program, "soon"), run(&program, "plain"));
    for outcome in [&soon, &plain] {
        let periodic = outcome.periodic.as_ref().expect("a periodic analysis");
        assert!(periodic.repeats && periodic.cycles == 3, "{periodic:?}");
        assert_eq!(outcome.results.samples(), 1441);
    }
    let (few, many) = (steps(&soon), steps(&plain));
    println!("{few} steps in place of {many}");
    assert!((few as f64) < 0.93 * many as f64, "{few} of {many}");
    let samples = |outcome: &Outcome| outcome.summary.as_ref().expect("a run").samples;
    // 72 in the first cycle, 360 in the second, 1440 in the last, and the start
    assert_eq!((samples(&soon), samples(&plain)), (1873, 4321));
    let mut worst = (0.0_f64, String::new());
    for column in soon.results.columns() {
        let path = &column.path;
        if !(path.ends_with("radial_load") || path.ends_with("minimum_film")) {
            continue;
        }
        let due = &plain.results.column(path).expect("the same channel").values;
        let most = |x: &[f64]| x.iter().fold(f64::MIN, |w, x| w.max(*x));
        let least = |x: &[f64]| x.iter().fold(f64::MAX, |w, x| w.min(*x));
        let off = column.values.iter().zip(due);
        let off = off.fold(0.0_f64, |w, (x, y)| w.max((x - y).abs()));
        let share = off / (most(due) - least(due));
        if share > worst.0 {
            worst = (share, path.clone());
        }
    }
    println!("{worst:?}");
    assert!(worst.0 < 5e-3, "{worst:?}");
}
