//! README, tutorial, guides and reference are true: their models run, and their commands print the shown lines.

mod page;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The first block of Eng text in a document.
fn first_model(document: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(document);
    let text = std::fs::read_to_string(path).expect("the document");
    let (_, rest) = text.split_once("```eng\n").expect("a block of Eng");
    let (model, _) = rest.split_once("```").expect("its end");
    model.to_owned()
}

#[test]
fn the_readme_model_runs() {
    let text = first_model("README.md");
    let checked = eng::check(&eng::Sources::from_text("swing.eng", text), "swing.eng");
    assert!(
        checked.report().diagnostics().is_empty(),
        "{}",
        checked.report()
    );
    let program = checked
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let outcome = program
        .analysis("swing")
        .unwrap_or_else(|error| panic!("{error}"))
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    assert_eq!(outcome.results.samples(), 501);
    let height = &outcome.results.column("height").expect("an output").values;
    // it hangs 400 mm below the pivot at its lowest
    let lowest = height.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((lowest + 0.4).abs() < 1e-4, "{lowest}");
}

#[test]
fn mistakes_named_in_the_readme_are_told() {
    let text = first_model("README.md");
    for (right, wrong, code) in [
        ("400 mm in", "400 mn in", "E0206"),
        ("start pin.angle", "start pin.angel", "E0211"),
        ("mass = 1.2 kg", "mass = 1.2 m", "E0302"),
    ] {
        let broken = text.replace(right, wrong);
        assert_ne!(broken, text);
        let checked = eng::check(&eng::Sources::from_text("swing.eng", broken), "swing.eng");
        let report = checked.report();
        let codes: Vec<&str> = report.diagnostics().iter().map(|d| d.code).collect();
        assert_eq!(codes, [code], "{report}");
    }
}

/// Every whole model of the reference is right and its analyses run.
#[test]
fn the_models_of_the_reference_run() {
    let document = std::fs::read_to_string(root().join("docs/language.md")).expect("the document");
    let blocks = document.split("```eng\n").skip(1);
    let models =
        blocks.filter_map(|block| block.split("```").next().filter(|b| b.contains("\nmodel ")));
    let run: usize = models.map(page::run_all).sum();
    assert!(run > 0);
}

#[test]
fn the_first_model_of_the_tutorial_is_true() {
    page::follow("docs/tutorial.md", Some("1. An arm on a spring"));
}

#[test]
fn the_second_model_of_the_tutorial_is_true() {
    page::follow("docs/tutorial.md", Some("2. A single-cylinder engine"));
}

#[test]
fn the_third_model_of_the_tutorial_is_true() {
    page::follow(
        "docs/tutorial.md",
        Some("3. A flexible crankshaft in a flexible block"),
    );
}

#[test]
fn the_guides_are_true() {
    for guide in pages("docs/guides") {
        page::follow(&guide, None);
    }
}

#[test]
fn the_page_of_sweeps_is_true() {
    page::follow("docs/sweeps.md", None);
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The pages in a folder of the project, as paths from its root.
fn pages(folder: &str) -> Vec<String> {
    let mut found: Vec<String> = std::fs::read_dir(root().join(folder))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .map(|path| {
            let name = path.file_name().expect("a name").to_string_lossy();
            format!("{folder}/{name}")
        })
        .collect();
    found.sort();
    found
}

/// Every link of a page leads to a file of the project, and to a heading of it. Every page is linked from the README.
#[test]
fn the_documents_lead_to_each_other() {
    let mut all = pages("docs");
    all.extend(pages("docs/guides"));
    let mut wrong = Vec::new();
    let mut of_readme = BTreeSet::new();
    for page in std::iter::once("README.md".to_owned()).chain(all.iter().cloned()) {
        let text = std::fs::read_to_string(root().join(&page)).expect("a page");
        let folder = Path::new(&page).parent().expect("a folder");
        for link in page::links(&text) {
            if link.contains("://") {
                continue;
            }
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let place = match file {
                "" => PathBuf::from(&page),
                _ => page::joined(folder, file),
            };
            let Ok(there) = std::fs::metadata(root().join(&place)) else {
                wrong.push(format!("{page}: {link}"));
                continue;
            };
            if page == "README.md" {
                of_readme.insert(place.to_string_lossy().into_owned());
            }
            if there.is_file() && !heading.is_empty() {
                let text = std::fs::read_to_string(root().join(&place)).expect("a page");
                if !page::headings(&text).contains(heading) {
                    wrong.push(format!("{page}: {link}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "links to nothing: {wrong:#?}");
    let missing: Vec<&String> = all.iter().filter(|p| !of_readme.contains(*p)).collect();
    assert!(missing.is_empty(), "the README does not name {missing:?}");
}

/// All but the mesh is right: the block of the reference in a model of its own.
#[test]
fn the_flexible_body_of_the_reference_is_one() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/language.md");
    let text = std::fs::read_to_string(path).expect("the document");
    let mut blocks = text
        .split("```eng\n")
        .filter_map(|block| block.split("```").next());
    let block = blocks
        .find(|block| block.starts_with("flexible "))
        .expect("a flexible body");
    let text = format!(
        "use std.journals.Impedance\nmodel Engine {{\n accept unloaded\n gravity = [0, 0, 0] m/s^2\n marker shell[j in 1..5] = [0, 0, 92*(j - 3)] mm\n {block}\n \
         journal main[j in 1..5] = Impedance(pin: crank.main[j], shell: shell[j], diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 10 mPa*s)\n \
         output turn = dot(crank.flange.angular_velocity, ground.z)\n output pins[i in 1..4] = dot(crank.pin[i].velocity, ground.x)\n}}"
    );
    let checked = eng::check(&eng::Sources::from_text("engine.eng", text), "engine.eng");
    let report = checked.report();
    let codes: Vec<&str> = report.diagnostics().iter().map(|d| d.code).collect();
    assert_eq!(codes, ["E0730"], "{report}");
}

/// The models in the chapter of the reference about interfaces give the loads that follow from their energy.
#[test]
fn the_interfaces_of_the_reference_run() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/language.md");
    let reference = std::fs::read_to_string(path).expect("the reference");
    let (_, rest) = reference
        .split_once("### Interfaces\n")
        .expect("the chapter");
    let (chapter, _) = rest.split_once("\n## ").expect("its end");
    let mut results = Vec::new();
    for block in chapter.split("```eng\n").skip(1) {
        let (text, _) = block.split_once("```").expect("its end");
        let checked = eng::check(&eng::Sources::from_text("model.eng", text), "model.eng");
        let report = checked.report();
        assert!(report.diagnostics().is_empty(), "{report}");
        let program = checked
            .into_program()
            .unwrap_or_else(|report| panic!("{report}"));
        let name = program.analyses()[0];
        let outcome = program
            .analysis(name)
            .unwrap_or_else(|error| panic!("{error}"))
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{}", failed.error));
        results.push(outcome.results);
    }
    let [stop, wheel, shaft, plug, bounce] = results.as_slice() else {
        panic!("{} models", results.len());
    };
    // it falls 4 mm in 28.6 ms; the energy m g (4 mm + d) = k (d^2/2 + d^4/(4 full^2)) gives d = 2.6389 mm at
    // the turning point, and the load there
    let load = &stop.column("stop.load").expect("an output").values;
    assert!(load.iter().take(280).all(|load| *load == 0.0), "{load:?}");
    let most = load.iter().copied().fold(0.0, f64::max);
    assert!((most - 144.661).abs() < 0.2, "{most}");
    // the wheel sinks at the speed v at which the dampers carry it, m g = c v + k v^2: v = 0.294868 m/s
    let last = |path: &str| {
        let values = &wheel.column(path).expect("an output").values;
        values[values.len() - 1]
    };
    let v = 0.294_868;
    for (path, due) in [("soft.load", 400.0 * v), ("hard.load", 900.0 * v * v)] {
        assert!(
            (last(path) / due - 1.0).abs() < 1e-3,
            "{path}: {}",
            last(path)
        );
    }
    // the gas takes the energy of the plug, 6.25 J = p0 V0/0.4 ((V0/V)^0.4 - 1) - p0 (V0 - V): V/V0 = 0.403634
    let pressure = &plug.column("gas.net_pressure").expect("an output").values;
    let most = pressure.iter().copied().fold(0.0, f64::max);
    assert!((most / 2.561_369e5 - 1.0).abs() < 1e-3, "{most}");
    // m v dv/dd = -k d^1.5 (1 + loss v) gives v - ln(1 + loss v)/loss the same value at v = 2 m/s, when the ball
    // comes, and at v = -1.577078 m/s, when it leaves, whatever the stiffness
    let speed = &bounce.column("speed").expect("an output").values;
    let leaves = speed[speed.len() - 1];
    assert!((leaves / 1.577_078 - 1.0).abs() < 1e-4, "{leaves}");
    // both films carry the shaft, the grooved one by a fifth less at the same eccentricity
    let film = |path: &str| {
        let column = shaft.column(&format!("{path}.minimum_film"));
        let values = &column.expect("a film").values;
        values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let (left, right) = (film("left"), film("right.film"));
    assert!(right < left && right > 0.0, "{left} {right}");
}

/// The reference names every kind of analysis and each of its arguments.
#[test]
fn the_reference_names_all_analyses_and_their_arguments() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/language.md");
    let text = std::fs::read_to_string(path).expect("the reference");
    let (_, rest) = text.split_once("\n## Analyses\n").expect("its section");
    let (section, _) = rest.split_once("\n## ").expect("its end");
    for kind in eng_system::analysis::KINDS {
        let name = kind.name;
        assert!(section.contains(&format!("{name}(")), "{name}");
        for argument in kind.arguments {
            let shown = [
                format!("`{}`", argument.name),
                format!("{}:", argument.name),
            ];
            let named = shown.iter().any(|shown| section.contains(shown));
            assert!(named, "`{}` of `{name}`", argument.name);
        }
    }
}
