//! The statements of the paper's figures, as numbers of the example's runs with the paper's own film law.
//! docs/paper.md shows the figures.

use crate::support::{column, outcome};
use eng::{Outcome, Program, Results, Sources, StartReport};
use std::path::Path;
use std::sync::OnceLock;

/// The film law of the example, and the one of the paper.
const LAWS: [&str; 2] = [
    "const law: JournalLaw = Reynolds",
    "const law: JournalLaw = Impedance",
];

/// Runs beside those of the example, with whose numbers its figures are compared.
const ANALYSES: &str = "
analysis steady = periodic(PaperEngine())
analysis quasi_static = transient(PaperEngine(), duration: 90 deg, sample: 0.5 deg)
analysis assembled = transient(PaperEngine(), duration: 90 deg, sample: 0.5 deg, start: assembled)
analysis cycle = linear(PaperEngine(), after: 16 rev, over: 2 rev, number: 12)
analysis drive_line = transient(PaperEngine(), duration: 24 rev, sample: 720 deg)
analysis fired_start = transient(PaperEngine(combustion: 1), duration: 1 deg, sample: 0.5 deg)
";

fn program() -> &'static Program {
    static PROGRAM: OnceLock<Program> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/paper");
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("paper_figures");
        std::fs::create_dir_all(folder.join("mesh")).expect("a folder");
        for file in ["pressure.csv", "mesh/crank.bdf.gz", "mesh/block.inp.gz"] {
            std::fs::copy(example.join(file), folder.join(file)).expect("a file of the example");
        }
        let text = std::fs::read_to_string(example.join("paper.eng")).expect("the example");
        // the paper's law is the impedance method
        let [own, of_the_paper] = LAWS;
        assert_eq!(text.matches(own).count(), 1);
        let text = text.replace(own, of_the_paper).replace(
            "use std.journals.{Reynolds, JournalLaw}",
            "use std.journals.{Impedance, JournalLaw}",
        );
        std::fs::write(folder.join("paper.eng"), format!("{text}\n{ANALYSES}")).expect("a text");
        let cache = folder.join("reductions");
        let sources = Sources::folder(folder)
            .expect("the folder")
            .with_cache(cache);
        let program = eng::check(&sources, "paper.eng")
            .into_program()
            .unwrap_or_else(|report| panic!("{report}"));
        // reduces both bodies before several tests ask for them
        program.model("PaperEngine").expect("the engine");
        program
    })
}

fn run(analysis: &str) -> Outcome {
    outcome(program(), analysis)
}

/// The repeating cycle of the unfired engine, both ends among its samples.
fn steady() -> &'static Outcome {
    static STEADY: OnceLock<Outcome> = OnceLock::new();
    STEADY.get_or_init(|| run("steady"))
}

/// The last cycle in samples of 0.5 degrees, without its end.
fn last_cycle<'r>(results: &'r Results, path: &str) -> &'r [f64] {
    let values = column(results, path);
    &values[values.len() - 1441..values.len() - 1]
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    (values.map(|x| x * x).sum::<f64>() / count).sqrt()
}

/// rms of the difference of two channels.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    rms(a.iter().zip(b).map(|(a, b)| a - b))
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// The flexible engine begins in balance, and its journals as in the repeating cycle. From an assembled start it
/// rings.
#[test]
fn the_start_does_not_ring() {
    let off = |outcome: &Outcome| {
        let mut worst = 0.0_f64;
        for journal in 1..=5 {
            for axis in ["x", "y"] {
                let path = format!("engine.main[{journal}].force.{axis}");
                let here = column(&outcome.results, &path);
                let cycle = column(&steady().results, &path);
                assert_eq!((here.len(), cycle.len()), (181, 1441));
                let swing = cycle.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x))
                    - cycle.iter().fold(f64::INFINITY, |m, x| m.min(*x));
                for (a, b) in here.iter().zip(cycle) {
                    worst = worst.max((a - b).abs() / swing);
                }
            }
        }
        worst
    };
    // a film answers a wrong rate of its pin at once, and forgets it within a sample of 0.5°
    let jolt = |outcome: &Outcome| {
        let (mut jump, mut most) = (0.0_f64, 0.0_f64);
        for (journal, axis) in (1..=5).flat_map(|j| [(j, "x"), (j, "y")]) {
            let force = column(
                &outcome.results,
                &format!("engine.main[{journal}].force.{axis}"),
            );
            jump = jump.max((force[1] - force[0]).abs());
            most = most.max(force[0].abs());
        }
        jump / most
    };
    for analysis in ["quasi_static", "fired_start"] {
        let outcome = run(analysis);
        let Some(StartReport::QuasiStatic(found)) = &outcome.start else {
            panic!("{analysis}: {:?}", outcome.start);
        };
        assert_eq!(found.journals.len(), 5);
        let jolt = jolt(&outcome);
        println!("{analysis}: in half a degree, of the largest force: {jolt:.3}");
        assert!(jolt < 0.06, "{analysis}: {jolt}");
        if analysis == "quasi_static" {
            let (begun, assembled) = (off(&outcome), off(&run("assembled")));
            println!("first quarter turn, of the swing: {begun:.3}, as assembled {assembled:.3}");
            assert!(
                begun < 0.1 && assembled > 5.0 * begun,
                "{begun} {assembled}"
            );
        }
    }
}

/// Figure 4: the flywheel loads journal 5 in another way than journal 1; a crank without flywheel loads both in the
/// same way.
#[test]
fn figure_4_journal_5_differs_from_1_by_the_flywheel() {
    let without = run("no_flywheel");
    let apart = |results: &Results| {
        let (first, fifth) = (
            last_cycle(results, "vertical[1]"),
            last_cycle(results, "vertical[5]"),
        );
        distance(first, fifth) / peak(first)
    };
    let (with, without) = (apart(&steady().results), apart(&without.results));
    println!("journal 5 against 1, of the peak: {with:.4}, without flywheel {without:.4}");
    assert!(with > 0.2, "{with}");
    assert!(without < 0.05, "{without}");
}

/// Figures 5 and 6: the second and then the fourth order lead the acceleration of the block at journal 5, the
/// first and second the force.
#[test]
fn figures_5_and_6_orders_at_journal_5() {
    let strongest = |path: &str| {
        let values = last_cycle(&steady().results, path);
        let mut harmonics = eng_report::signal::harmonics(values, 720.0, 40)
            .unwrap_or_else(|error| panic!("{error}"));
        harmonics.retain(|h| h.order > 0.0);
        harmonics.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        for h in &harmonics[..6] {
            println!("{path}: order {} {:.4}", h.order, h.amplitude);
        }
        [harmonics[0].order, harmonics[1].order]
    };
    assert_eq!(strongest("shell_acceleration[5]"), [2.0, 4.0]);
    assert_eq!(strongest("vertical[5]"), [1.0, 2.0]);
}

/// Figure 9: in the vertical forces static modes alone (A) are near static and normal modes (C); normal modes alone
/// (B) are not. Figure 9 does not show the accelerations of the block. There A and B are about equally far from C
/// once the motion repeats; the test prints them.
#[test]
fn figure_9_static_modes_carry_the_journals() {
    let [a, b, c] = [1, 2, 3].map(|k| run(&format!("figure9[{k}]")).results);
    let apart = |path: &str| {
        let [a, b, c] = [&a, &b, &c].map(|results| last_cycle(results, path));
        let size = rms(c.iter().copied());
        let found = [distance(a, c), distance(a, b), distance(b, c)].map(|x| x / size);
        let [static_modes, between, normal_modes] = found;
        println!("{path}: A-C {static_modes:.4}, A-B {between:.4}, B-C {normal_modes:.4} of C");
        found
    };
    for journal in 1..=5 {
        let [static_modes, between, normal_modes] = apart(&format!("vertical[{journal}]"));
        assert!(normal_modes > 1.15 * static_modes, "{journal}");
        assert!(between > 1.3 * static_modes, "{journal}");
        apart(&format!("shell_acceleration[{journal}]"));
    }
}

/// The flexible crank lies on its films, the block on its mounts.
#[test]
fn nothing_of_the_engine_hangs() {
    let analysis = program()
        .analysis("quasi_static")
        .unwrap_or_else(|error| panic!("{error}"));
    let found = analysis.hanging().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found, None);
}

/// The modes of the engine over a cycle of two turns: all decay, and none is neutral, because the dynamometer holds
/// the phase. The slowest, the torsion of the drive line, decays from cycle to cycle as in the transient. Pitching
/// and heaving have the frequencies of the frozen coefficients.
#[test]
fn the_engine_over_a_cycle() {
    let outcome = run("cycle");
    let found = outcome.modes.expect("modes");
    let orbit = found.orbit.as_ref().expect("an orbit");
    assert!((orbit.period / 30e-3 - 1.0).abs() < 1e-9 && orbit.gap <= 1.0);
    assert_eq!(found.zeros, 0);
    assert!(found.modes.iter().all(|mode| !mode.grows()));
    let torsion = found
        .modes
        .iter()
        .max_by(|a, b| a.value.re.total_cmp(&b.value.re))
        .expect("a mode");
    // |μ| and angle of an oscillation sampled once a cycle: y(k+2) = s y(k+1) − p y(k)
    let results = run("drive_line").results;
    let swing: Vec<f64> = column(&results, "engine.coupling.torque")[3..]
        .windows(2)
        .map(|w| w[1] - w[0])
        .collect();
    let sum = |term: &dyn Fn(&[f64]) -> f64| swing.windows(3).map(term).sum::<f64>();
    let (aa, ab, bb) = (
        sum(&|w| w[1] * w[1]),
        -sum(&|w| w[1] * w[0]),
        sum(&|w| w[0] * w[0]),
    );
    let (ay, by) = (sum(&|w| w[1] * w[2]), -sum(&|w| w[0] * w[2]));
    let det = aa * bb - ab * ab;
    let (s, p) = ((ay * bb - by * ab) / det, (aa * by - ab * ay) / det);
    let decay = 0.5 * p.ln() / orbit.period;
    let turn = (0.5 * s / p.sqrt()).acos();
    let multiplier = (torsion.value * orbit.period).exp();
    println!(
        "{orbit:?}: slowest {} 1/s of {} Hz, in time {decay}; turn a cycle {}, in time {turn}",
        torsion.value.re,
        torsion.frequency(),
        multiplier.arg()
    );
    assert!((torsion.value.re / decay - 1.0).abs() < 5e-3, "{decay}");
    assert!((multiplier.arg().abs() - turn).abs() < 5e-3, "{turn}");
    for due in [162.3, 227.2] {
        let near = found
            .oscillations()
            .any(|mode| (mode.frequency() / due - 1.0).abs() < 5e-3);
        assert!(near, "{due} Hz");
    }
}
