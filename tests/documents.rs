//! What the README shows is true.

use std::path::Path;

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
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/language.md");
    let document = std::fs::read_to_string(path).expect("the document");
    let blocks = document.split("```eng\n").skip(1);
    let models =
        blocks.filter_map(|block| block.split("```").next().filter(|b| b.contains("\nmodel ")));
    let mut run = 0;
    for text in models {
        let sources = eng::Sources::from_text("model.eng", text.to_owned());
        let checked = eng::check(&sources, "model.eng");
        assert!(
            checked.report().diagnostics().is_empty(),
            "{}",
            checked.report()
        );
        let program = checked
            .into_program()
            .unwrap_or_else(|report| panic!("{report}"));
        for line in text.lines() {
            let Some(rest) = line.strip_prefix("analysis ") else {
                continue;
            };
            let name = rest.split([' ', '[']).next().expect("a name");
            let analysis = program
                .analysis(name)
                .unwrap_or_else(|error| panic!("{error}"));
            analysis
                .run(&mut |_| {})
                .unwrap_or_else(|failed| panic!("{}", failed.error));
            run += 1;
        }
    }
    assert!(run > 0);
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
        "use std.journals.Impedance\nmodel Engine {{\n gravity = [0, 0, 0] m/s^2\n marker shell[j in 1..5] = [0, 0, 92*(j - 3)] mm\n {block}\n \
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
