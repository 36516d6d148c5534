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

/// Twelve free frequencies of two sizes of one crank: the coarser are at most this much higher (%), printed.
fn converges(coarse: &eng::Reduction, fine: &eng::Reduction, within: f64) {
    assert!((coarse.mass() / fine.mass() - 1.0).abs() < 1e-4);
    for (a, b) in coarse.frequencies().iter().zip(fine.frequencies()) {
        let off = 100.0 * (a / b - 1.0);
        println!("{a:.2} Hz for {b:.2} Hz: {off:.3} %");
        assert!(off > 0.0 && off < within, "{a} {b}");
    }
}

/// A crank with split pins, whose links overlap both pins: a stack against a finer one. The corners between
/// journals and webs have no fillets, so frequencies fall slowly as elements become smaller. The bound was
/// set after the result.
#[test]
fn a_crank_with_split_pins_converges() {
    let (coarse, fine) = (reduced(split(13.0)), reduced(split(9.0)));
    assert_eq!(coarse.frequencies().len(), 12);
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
