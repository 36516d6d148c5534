//! Flexible bodies of stacked sections, from text to results.

use eng::Sources;
use std::path::Path;

/// The crank of examples/paper as text; `size` and the radius of its pins in mm.
fn paper(size: f64, pin: f64) -> String {
    format!(
        "use std.materials.Solid
use std.sections.disc
use std.cranks.{{Web, crank_sections}}
const Forged = Solid(density: 7850 kg/m^3, young_modulus: 206 GPa, poisson_ratio: 0.29)
const ends = [disc(23 mm, length: 24 mm), disc(40 mm, length: 10 mm)]
model Crank {{
    gravity = [0, 0, 0] m/s^2
    flexible crank {{
        mesh = stack(axis: z, size: {size} mm, begin: -230 mm, sections: crank_sections(
            angles: [0, 180, 180, 0] deg, throw: 43 mm, main: disc(27 mm, length: 24 mm), pin: disc({pin} mm, length: 28 mm),
            web: Web(thickness: 20 mm, pin_radius: 34 mm, waist: [4, 37] mm, counterweight_radius: 73 mm, counterweight_angle: 106 deg),
            front: ends, back: ends))
        material = Forged
        modes = static(at: [main, pin], freedoms: [x, y]) + normal(3)
        damping = 2 %
        marker main[j in 1..5] = ring(center: [0, 0, 92*(j - 3)] mm, axis: z, radius: 27 mm, width: 24 mm)
        marker pin[i in 1..4] = ring(center: [[43, -43, -43, 43][i], 0, 92*(i - 2.5)] mm, axis: z, radius: {pin} mm, width: 28 mm)
    }}
}}
analysis stand = assemble(Crank())
"
    )
}

/// A crank of a V6 with split pins, with the size of its elements.
fn split(size: f64) -> String {
    format!(
        "use std.materials.Steel
use std.sections.disc
use std.cranks.{{Web, split_crank_sections}}
model Crank {{
    gravity = [0, 0, 0] m/s^2
    flexible crank {{
        mesh = stack(axis: z, size: {size} mm, sections: split_crank_sections(
            angles: [0, 120, 240] deg, split: 30 deg, throw: 40 mm, main: disc(32 mm, length: 24 mm), pin: disc(27 mm, length: 20 mm),
            web: Web(thickness: 16 mm, pin_radius: 36 mm, waist: [5, 40] mm, counterweight_radius: 70 mm, counterweight_angle: 104 deg),
            link_thickness: 8 mm, front: [disc(20 mm, length: 40 mm)], back: [disc(45 mm, length: 12 mm)]))
        material = Steel
        modes = normal(12)
        damping = 2 %
    }}
}}
analysis stand = assemble(Crank())
"
    )
}

fn reduced(text: String) -> eng::Reduction {
    let sources = Sources::from_text("crank.eng", text);
    let checked = eng::check(&sources, "crank.eng");
    assert!(
        !checked.report().diagnostics().has_errors(),
        "{}",
        checked.report()
    );
    let program = checked.into_program().expect("a program");
    let (mut bodies, doubts) = program.reduce().unwrap_or_else(|error| panic!("{error}"));
    assert!(doubts.is_empty());
    assert_eq!(bodies.len(), 1);
    bodies.remove(0)
}

/// The library's sections are those of the delivered mesh: mass and frequencies from an independent solution.
#[test]
fn the_library_makes_the_papers_crank() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/paper/mesh/reference.json");
    let text = std::fs::read_to_string(path).expect("the reference");
    let reference: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let body = reduced(paper(16.0, 24.0));
    let mass = reference["crank"]["mass_kg"].as_f64().expect("a mass");
    assert!((body.mass() / mass - 1.0).abs() < 1e-4, "{}", body.mass());
    let known = reference["crank"]["free_hz_exact_mass"][0]
        .as_f64()
        .expect("a frequency");
    let found = body.frequencies()[0];
    assert!((found / known - 1.0).abs() < 0.01, "{found} {known}");
}

/// A crank of three throws whose journals do not overlap, with the size of its elements.
fn three(size: f64) -> String {
    format!(
        "use std.materials.Steel
use std.sections.disc
use std.cranks.{{Web, crank_sections}}
model Crank {{
    gravity = [0, 0, 0] m/s^2
    flexible crank {{
        mesh = stack(axis: z, size: {size} mm, sections: crank_sections(
            angles: [0, 240, 120] deg, throw: 46 mm, main: disc(22 mm, length: 24 mm), pin: disc(19 mm, length: 26 mm),
            web: Web(thickness: 18 mm, pin_radius: 29 mm, waist: [3, 32] mm, counterweight_radius: 66 mm, counterweight_angle: 106 deg),
            front: [disc(18 mm, length: 30 mm)], back: [disc(36 mm, length: 12 mm)]))
        material = Steel
        modes = normal(12)
        damping = 2 %
    }}
}}
analysis stand = assemble(Crank())
"
    )
}

/// Free frequencies (Hz) of the two cranks above, of ten-node tetrahedra with edges of 10 mm, and of 4 mm where sections meet: 46,967 and
/// 64,299 nodes. `.ci/tetrahedra.py` makes the solids of cylinders and prisms with Gmsh 4.15.2, and CalculiX 2.20 computes the frequencies.
const THREE: [f64; 12] = [
    454.0215, 513.4605, 692.6563, 866.921, 987.8298, 1390.915, 1412.162, 1583.284, 1605.996,
    2376.52, 2652.186, 2813.265,
];
const SPLIT: [f64; 12] = [
    565.7433, 626.6821, 1030.475, 1112.821, 1309.425, 1815.694, 1855.604, 2112.263, 2394.593,
    2978.891, 3295.768, 3475.228,
];
/// Volumes (m³) of these solids.
const VOLUMES: [f64; 2] = [1.4375848e-3, 2.0312159e-3];

/// Mass and frequencies of a body against those of tetrahedra, to shares of 1e-4 and 0.3 %.
fn has(body: &eng::Reduction, volume: f64, known: &[f64; 12]) {
    assert!((body.mass() / (7850.0 * volume) - 1.0).abs() < 1e-4);
    assert_eq!(body.frequencies().len(), 12);
    for (found, known) in body.frequencies().iter().zip(known) {
        let off = 100.0 * (found / known - 1.0);
        println!("{found:.2} Hz for {known:.2} Hz: {off:.3} %");
        assert!(off.abs() < 0.3, "{found} {known}");
    }
}

/// Stress grows without limit at corners without fillets, so the frequencies of both kinds of elements fall slowly as these become smaller.
/// The cranks are compared at sizes with about as fine elements at the corners; finer pairs are on the page of validation.
#[test]
fn a_crank_without_overlap_against_its_tetrahedra() {
    has(&reduced(three(9.0)), VOLUMES[0], &THREE);
}

/// Twelve free frequencies of two sizes of one crank: the coarser are at most this much higher (%), printed.
fn converges(coarse: &eng::Reduction, fine: &eng::Reduction, within: f64) {
    assert!((coarse.mass() / fine.mass() - 1.0).abs() < 1e-4);
    for (a, b) in coarse.frequencies().iter().zip(fine.frequencies()) {
        let off = 100.0 * (a / b - 1.0);
        println!("{a:.2} Hz for {b:.2} Hz: {off:.3} %");
        assert!(off > 0.0 && off < within, "{a} {b}");
    }
}

/// A crank with split pins, whose links overlap both pins: a stack against tetrahedra and against a finer stack. The bound of the second
/// comparison was set after the result.
#[test]
fn a_crank_with_split_pins_against_its_tetrahedra() {
    let (coarse, fine) = (reduced(split(13.0)), reduced(split(9.0)));
    has(&coarse, VOLUMES[1], &SPLIT);
    converges(&coarse, &fine, 0.7);
}

/// The reduction is kept by the numbers of the sections: another size of a pin is another body, the same text is not.
#[test]
fn a_kept_stack_follows_its_numbers() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("kept_stacks");
    let _ = std::fs::remove_dir_all(&folder);
    let kept = |ending: &str| {
        let entries = std::fs::read_dir(&folder).into_iter().flatten();
        let names = entries.map(|entry| entry.expect("an entry").path());
        names
            .filter(|path| path.extension().is_some_and(|e| e == ending))
            .count()
    };
    let check = |text: String| {
        let sources = Sources::from_text("crank.eng", text).with_cache(&folder);
        let checked = eng::check(&sources, "crank.eng");
        assert!(
            !checked.report().diagnostics().has_errors(),
            "{}",
            checked.report()
        );
        let program = checked.into_program().expect("a program");
        program.assemble().unwrap_or_else(|error| panic!("{error}"));
    };
    check(paper(20.0, 24.0));
    assert_eq!(kept("look"), 1);
    check(format!("// another line\n{}", paper(20.0, 24.0)));
    assert_eq!(kept("look"), 1);
    check(paper(20.0, 24.001));
    assert_eq!(kept("look"), 2);
}
