//! The examples: each has a README with a picture and is in the gallery, and the numbers of the READMEs are
//! those of the reports.

use eng::post::{Run, evaluate};
use eng::{Machine, Quantity, Results, Sources};
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Folders of `examples`.
fn examples() -> Vec<PathBuf> {
    let folder = std::fs::read_dir(root().join("examples")).expect("the examples");
    let mut found: Vec<PathBuf> = folder
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_dir())
        .collect();
    found.sort();
    found
}

#[test]
fn every_example_says_where_to_look() {
    let gallery = read(&root().join("docs/gallery.md"));
    assert!(examples().len() >= 8);
    for folder in examples() {
        let name = folder.file_name().expect("a name").to_string_lossy();
        assert!(
            gallery.contains(&format!("(../examples/{name}/README.md)")),
            "docs/gallery.md has no {name}"
        );
        let page = read(&folder.join("README.md"));
        let pictures: Vec<&str> = page
            .split("![")
            .skip(1)
            .filter_map(|rest| rest.split_once("](")?.1.split_once(')'))
            .map(|(path, _)| path)
            .collect();
        // the pictures of the paper's engine are on its page
        assert!(
            !pictures.is_empty() || name == "paper",
            "{name} has no picture"
        );
        for picture in pictures {
            assert!(folder.join(picture).is_file(), "{name}: {picture}");
        }
        let models = std::fs::read_dir(&folder).expect("a folder").any(|entry| {
            let path = entry.expect("an entry").path();
            path.extension().is_some_and(|e| e == "eng")
                && page.contains(&*path.file_name().expect("a name").to_string_lossy())
        });
        assert!(models, "{name} does not name its model");
    }
}

/// The rows "| `name[2]` | words | 24.7 kN |" of a page: name, place in its list, number.
fn numbers(page: &str) -> Vec<(String, usize, Quantity)> {
    page.lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line
                .strip_prefix("| `")?
                .strip_suffix(" |")?
                .split(" | ")
                .collect();
            let [name, _, number] = cells[..] else {
                return None;
            };
            let name = name.strip_suffix('`')?;
            let (name, place) = match name.split_once('[') {
                Some((name, place)) => (name, place.strip_suffix(']')?.parse().ok()?),
                None => (name, 1),
            };
            let number: Quantity = number.parse().expect("a number with its unit");
            Some((name.to_owned(), place, number))
        })
        .collect()
}

/// The numbers of a README are the values of the report, to half of their last of three digits.
fn compare(name: &str, analyses: &[&str], due: usize) {
    let page = read(&root().join("examples").join(name).join("README.md"));
    compare_page(name, name, &page, analyses, due);
}

/// The numbers of a page, or of a part of it, and the report of a file of this folder.
fn compare_page(folder: &str, name: &str, page: &str, analyses: &[&str], due: usize) {
    let folder = root().join("examples").join(folder);
    let sources = Sources::folder(&folder).expect("a folder");
    let program = eng::check(&sources, &format!("{name}.eng")).into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let runs: Vec<(Results, Machine)> = analyses
        .iter()
        .map(|name| {
            let analysis = program
                .analysis(name)
                .unwrap_or_else(|error| panic!("{error}"));
            let outcome = analysis.run(&mut |_| {});
            let outcome = outcome.unwrap_or_else(|failed| panic!("{}", failed.error));
            (outcome.results, analysis.machine().expect("its numbers"))
        })
        .collect();
    let runs: Vec<Run<'_>> = runs.iter().map(|(r, m)| Run::new(r, m)).collect();
    let report = evaluate(&program.reports()[0], &runs);
    let rows = numbers(page);
    assert_eq!(rows.len(), due, "{name}: {rows:?}");
    for (value, place, number) in rows {
        let found = report
            .values(&value)
            .unwrap_or_else(|error| panic!("{name}: {value}: {error}"));
        let (found, stated) = (found[place - 1].value, number.value());
        println!("{name}: {value}[{place}] {found} for {stated}");
        assert!(
            (found / stated - 1.0).abs() < 5e-3,
            "{name}: {value}[{place}] is {found}, the README says {stated}"
        );
    }
}

#[test]
fn the_inline_four_has_its_numbers() {
    compare("inline4", &["fired", "unfired", "settled"], 5);
}

#[test]
fn the_concept_has_its_numbers() {
    let page = read(&root().join("examples/concept/README.md"));
    let (films, quick) = page
        .split_once("\n## ")
        .expect("a part of the quick engine");
    compare_page("concept", "concept", films, &["fired"], 4);
    let speeds = ["quick[1]", "quick[7]", "quick[13]"];
    compare_page("concept", "quick", quick, &speeds, 5);
}

#[test]
fn the_v6_has_its_numbers() {
    compare("v6", &["fired"], 3);
}

#[test]
fn the_compressor_has_its_numbers() {
    compare("compressor", &["running"], 7);
}

#[test]
fn the_six_has_its_numbers() {
    let analyses = [
        "bare[13]",
        "bare[19]",
        "damped[8]",
        "damped[13]",
        "viscous[4]",
        "viscous[7]",
        "tuned[2]",
        "tuned[7]",
        "tuned[10]",
    ];
    compare("torsion_six", &analyses, 9);
}

#[test]
fn the_start_of_the_fan_has_its_numbers() {
    compare("start_up", &["direct", "star"], 5);
}

#[test]
fn the_mounts_have_their_numbers() {
    let analyses = [
        "rubber[3]",
        "rubber[13]",
        "hydraulic[3]",
        "hydraulic[13]",
        "rubber_pushed",
        "fluid_pushed",
    ];
    compare("mounts", &analyses, 8);
}

#[test]
fn the_balanced_single_has_its_numbers() {
    compare("single_balanced", &["bare", "half", "balanced"], 4);
}

#[test]
fn the_v_twins_have_their_numbers() {
    compare("v_twin", &["twin[1]", "twin[2]", "twin[3]"], 5);
}

#[test]
fn the_valve_train_has_its_numbers() {
    let page = read(&root().join("examples/valvetrain/README.md"));
    let (valve, finger) = page.split_once("\n## ").expect("a part of the finger");
    let rides = ["ride[1]", "ride[2]", "ride[3]"];
    compare_page("valvetrain", "valvetrain", valve, &rides, 5);
    let turns = ["hot[1]", "hot[2]", "cold"];
    compare_page("valvetrain", "finger", finger, &turns, 5);
}

#[test]
fn the_drive_line_has_its_numbers() {
    let analyses = [
        "dual[1]", "dual[7]", "solid[1]", "solid[7]", "quiet", "launch",
    ];
    compare("driveline", &analyses, 7);
}

#[test]
fn the_boxer_twin_has_its_numbers() {
    compare("boxer_twin", &["bare", "half"], 4);
}

#[test]
fn the_split_v6_has_its_numbers() {
    compare("v6_split", &["common", "split"], 3);
}

#[test]
fn the_slapping_piston_has_its_numbers() {
    compare("piston_slap", &["slap[1]", "slap[2]", "slap[3]"], 5);
}

#[test]
fn the_thrust_bearing_has_its_numbers() {
    compare("thrust", &["press[1]", "press[2]", "press[3]"], 5);
}

#[test]
fn the_balancer_has_its_numbers() {
    compare("balancer", &["bare", "level", "raised"], 4);
}

#[test]
fn the_chain_has_its_numbers() {
    compare("timing", &["soft[4]", "firm[4]"], 5);
}

#[test]
fn the_squeezer_has_its_numbers() {
    compare("squeezer", &["squeeze"], 4);
}

#[test]
fn the_swing_has_its_numbers() {
    compare("swing", &["release[1]", "release[2]", "release[3]"], 5);
}

#[test]
fn the_big_end_has_its_numbers() {
    compare("big_end", &["rigid", "elastic"], 12);
}
