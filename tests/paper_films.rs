//! The step that the paper's authors announce: films solved on cells, in bores of the block that yield.
//! docs/paper.md has the results of whole cycles; here the first degrees of the fired engine show the cause.

use eng::{Results, Sources};
use std::path::Path;

/// The engine on coarse films, fired, with and without the shapes of its bores. The block has few modes,
/// which saves time.
const ANALYSES: &str = "
journal Coarse = Film(around: 36, across: 8)
analysis rigid_bores = transient(
    PaperEngine(law: Coarse, combustion: 1, block_modes: static(at: main, freedoms: [x, y])),
    duration: 4 deg, sample: 0.5 deg, start: assembled)
analysis elastic_bores = transient(
    PaperEngine(law: Coarse, waves: 2, degree: 1, combustion: 1, block_modes: static(at: main, freedoms: [x, y])),
    duration: 4 deg, sample: 0.5 deg, start: assembled)
";

/// Rigid and elastic bores of the block, whose mesh has these units.
fn runs(units: &str) -> [Results; 2] {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/paper");
    let temporary = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let folder = temporary.join(format!("paper_films_{units}"));
    std::fs::create_dir_all(folder.join("mesh")).expect("a folder");
    for file in ["pressure.csv", "mesh/crank.bdf.gz", "mesh/block.inp.gz"] {
        std::fs::copy(example.join(file), folder.join(file)).expect("a file of the example");
    }
    let read = |name: &str| std::fs::read_to_string(example.join(name)).expect("a text");
    let own = "abaqus(\"mesh/block.inp.gz\", units: mm_tonne_s)";
    let engine = read("paper.eng");
    assert_eq!(engine.matches(own).count(), 1);
    let engine = engine.replace(own, &own.replace("mm_tonne_s", units));
    std::fs::write(folder.join("paper.eng"), engine).expect("a text");
    let films = format!("{}\n{ANALYSES}", read("films.eng"));
    std::fs::write(folder.join("films.eng"), films).expect("a text");
    let sources = Sources::folder(folder)
        .expect("the folder")
        // other tests reduce the same crank
        .with_cache(temporary.join("paper_figures/reductions"));
    let program = eng::check(&sources, "films.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    ["rigid_bores", "elastic_bores"].map(|name| {
        program
            .analysis(name)
            .unwrap_or_else(|error| panic!("{error}"))
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{}", failed.error))
            .results
    })
}

/// Largest difference of a channel of the five bearings between two runs, over the largest value.
fn apart([a, b]: &[Results; 2], channel: &str) -> f64 {
    (1..=5).fold(0.0, |worst: f64, journal| {
        let path = format!("engine.main[{journal}].{channel}");
        let [a, b] = [a, b].map(|results| &results.column(&path).expect("a channel").values);
        let largest = b.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let differ = |(a, b): (&f64, &f64)| (a - b).abs();
        worst.max(a.iter().zip(b).map(differ).fold(0.0, f64::max) / largest)
    })
}

/// With a thousandth of the compliance, shapes of the bores change about a thousandth of the least film: they
/// act by the stiffness of the mesh alone. (Forces are no measure here: a stiff block without mass rings from
/// its assembled start.)
#[test]
fn bores_yield_by_the_stiffness_of_the_block() {
    // kg and ms for tonne and s: the numbers of the same file then mean a thousand times the modulus of elasticity
    let stiff = apart(&runs("mm_kg_ms"), "minimum_film");
    let own = apart(&runs("mm_tonne_s"), "minimum_film");
    println!("least film: stiff block {stiff:.1e}, the block of the example {own:.1e}");
    assert!(own > 0.05, "{own:e}");
    assert!(
        stiff < own / 200.0 && stiff > own / 1e4,
        "{stiff:e} {own:e}"
    );
}
