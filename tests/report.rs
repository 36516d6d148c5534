//! `eng report`: the page, and its files in other tools.

// some of these are for the other tests
#[allow(dead_code)]
#[path = "../report/tests/report/tools.rs"]
mod tools;

use eng::{InterfaceSummary, Results, Statistic, SummarisedElement, SummaryColumn, SummaryTable};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn eng(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_eng"))
        .args(arguments)
        .current_dir(folder)
        .env("ENG_CACHE", folder.join("cache"))
        .output()
        .expect("the command starts")
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = eng(folder, arguments);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
    errors
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn write(path: PathBuf, text: &str) {
    std::fs::write(path, text).expect("a file");
}

fn captions(page: &str) -> Vec<String> {
    let all = page.split("<figcaption").skip(1);
    all.filter_map(|part| part.split_once("</b> ")?.1.split_once("</figcaption>"))
        .map(|(caption, _)| caption.to_owned())
        .collect()
}

/// The cells of the rows of the table with a caption.
fn table(page: &str, caption: &str) -> Vec<Vec<String>> {
    let (_, after) = page
        .split_once(&format!("<caption>{caption}"))
        .unwrap_or_else(|| panic!("no table {caption}"));
    let (body, _) = after.split_once("</table>").expect("its end");
    let (_, body) = body.split_once("<tbody>").expect("its rows");
    let plain = |cell: &str| {
        let mut text = String::new();
        let mut inside = false;
        for c in cell.chars() {
            match c {
                '<' => inside = true,
                '>' => inside = false,
                c if !inside => text.push(c),
                _ => {}
            }
        }
        text.replace('−', "-")
    };
    body.split("<tr>")
        .skip(1)
        .map(|row| {
            row.split("</td>")
                .flat_map(|part| part.split("</th>"))
                .map(plain)
                .map(|text| text.trim().to_owned())
                .filter(|text| !text.is_empty())
                .collect()
        })
        .collect()
}

fn number(text: &str) -> f64 {
    text.parse()
        .unwrap_or_else(|_| panic!("{text:?} is no number"))
}

#[test]
fn a_report_of_an_engine_shows_what_the_results_hold() {
    let folder = folder("report-inline4");
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
    let text = std::fs::read_to_string(examples.join("by_hand.eng")).expect("the example");
    let (model, _) = text.split_once("analysis unfired").expect("its analyses");
    // two revolutions are a cycle
    let run =
        "analysis short = transient(Inline4(combustion: 0), duration: 2 rev, sample: 2 deg)\n";
    write(folder.join("engine.eng"), &format!("{model}{run}"));
    std::fs::copy(examples.join("pressure.csv"), folder.join("pressure.csv")).expect("a copy");
    done(
        &folder,
        &[
            "run",
            "engine.eng",
            "--no-plots",
            "-q",
            "--set",
            "speed=4200 rpm",
        ],
    );
    done(
        &folder,
        &[
            "report",
            "engine.eng",
            "--gltf",
            "engine.glb",
            "--out",
            "page.html",
        ],
    );
    let page = std::fs::read_to_string(folder.join("page.html")).expect("the page");
    let results =
        Results::read_parquet(folder.join("results/engine/short.parquet")).expect("results");

    let captions = captions(&page);
    for start in [
        "Vertical, short.",
        "Engine speed, short.",
        "Brake torque, short.",
        "Journal force y on the pin, short.",
        "Orbits of the pins in their shells, short",
        "Load of the pins on their shells, short",
        "Spectrum: Journal force y on the pin, short.",
    ] {
        assert!(
            captions.iter().any(|c| c.starts_with(start)),
            "{start} in {captions:?}"
        );
    }
    // the same values are drawn once
    assert!(!captions.iter().any(|c| c.contains("Journal force x")));
    assert!(page.contains("The same as main[1].force.x to main[5].force.x."));
    // a spectrum in orders with the frequencies above
    let spectra = captions
        .iter()
        .filter(|c| c.starts_with("Spectrum: Vertical"))
        .count();
    assert_eq!(spectra, 1, "{captions:?}");
    assert!(page.contains("Hann window, resolution 0.5000 orders"));
    let (_, speed) = page.split_once(">Frequency (Hz) at ").expect("its axis");
    let speed = number(speed.split_once(" rpm").expect("a speed").0);
    assert!((speed / 4200.0 - 1.0).abs() < 0.01, "{speed}");
    // curves have the letters of their journals, cylinders fire where the model says
    assert!(page.contains("data-name=\"E vertical[5]\""));
    for (cylinder, angle) in [(1, 0.0), (3, 180.0), (4, 360.0), (2, 540.0)] {
        let path = format!("gas[{cylinder}].firing");
        let row = table(&page, "Inputs of Inline4")
            .into_iter()
            .find(|row| row[0] == path)
            .expect("an input");
        assert_eq!(number(&row[2]), angle, "{path}");
        assert!(page.contains(&format!(">TDC {cylinder}</text>")));
    }

    let rows = table(&page, "Journal law over the last cycle, short");
    assert_eq!(rows.len(), 5);
    let columns = [
        ("radial_load", Statistic::Largest),
        ("minimum_film", Statistic::Least),
        ("power_loss", Statistic::Mean),
    ];
    let element = |index: usize| {
        let path = format!("main[{}]", index + 1);
        SummarisedElement {
            channels: (columns.iter())
                .map(|(output, _)| Some(format!("{path}.{output}")))
                .collect(),
            parameters: Vec::new(),
            path,
        }
    };
    let films = InterfaceSummary {
        interface: "JournalLaw".to_owned(),
        parameters: Vec::new(),
        columns: (columns.iter())
            .map(|(output, taken)| SummaryColumn {
                output: (*output).to_owned(),
                about: String::new(),
                statistic: *taken,
            })
            .collect(),
        elements: (0..5).map(element).collect(),
    };
    let known = SummaryTable::new(&results, &films, Some(4.0 * PI));
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row[1], format!("main[{}]", index + 1));
        let [load, film, power] = [0, 1, 2].map(|k| known.rows[index][k].expect("a number").value);
        // curve, path, four parameters, then load, its angle, specific load, film, its angle, ratio, power
        for (cell, value) in [
            (2, 54.0),
            (4, 27.0),
            (6, load),
            (8, 1e-6 * load / (0.054 * 0.02)),
            (9, 1e6 * film),
            (12, power),
        ] {
            let rounding = 0.51e-3;
            let shown = number(&row[cell]);
            assert!(
                (shown / value - 1.0).abs() < rounding,
                "{cell}: {shown} {value}"
            );
        }
    }
    // the cylinders have a table, too
    let rows = table(&page, "Gas law over the last cycle, short");
    assert_eq!(rows.len(), 4);
    assert_eq!(rows[3][0], "gas[4]");
    // a parameter set on the command line is an input that differs from its default
    let inputs = table(&page, "Inputs of Inline4");
    let speed = inputs
        .iter()
        .find(|row| row[0] == "speed")
        .expect("the speed");
    assert_eq!((number(&speed[2]), number(&speed[4])), (4000.0, 4200.0));
    let stated = |input: &str| {
        let row = inputs.iter().find(|row| row[0] == input);
        row.map(|row| row[3].clone()).unwrap_or_default()
    };
    assert!(stated("speed").starts_with("engine.eng:"));
    // arguments that the text states for no gas force are defaults of the library
    assert!(
        stated("gas[1].ambient").starts_with("library, "),
        "{}",
        stated("gas[1].ambient")
    );

    let audit = table(&page, "Energy, short");
    let change = |path: &str| {
        let values = &results.column(path).expect("a column").values;
        values[values.len() - 1] - values[0]
    };
    let drives = audit.iter().find(|row| row[0] == "drives").expect("a row");
    let work = change("energy.work_of_drives");
    assert!(
        (number(&drives[2]) / work - 1.0).abs() < 1e-4,
        "{drives:?} {work}"
    );

    let motion =
        Results::read_parquet(folder.join("results/engine/short.motion.parquet")).expect("motion");
    assert_eq!(motion.samples(), 361);
    let square = |sample: usize| -> f64 {
        ["w", "x", "y", "z"]
            .iter()
            .map(|part| {
                let path = format!("crank.orientation.{part}");
                motion.column(&path).expect("a column").values[sample].powi(2)
            })
            .sum()
    };
    assert!((0..361).all(|sample| (square(sample) - 1.0).abs() < 1e-12));
    assert_eq!(
        &std::fs::read(folder.join("engine.glb")).expect("glTF")[..4],
        b"glTF"
    );
    // the first and the last section and nothing from elsewhere
    assert!(page.contains(">Summary</h2>") && page.contains(">Provenance</h2>"));
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"));
    assert!(page.contains(results.metadata().get("source_hash").expect("a hash")));
}

const BAR: &str = "
    force Push(a: Marker, b: Marker, x: Force) {
        apply force x*b.x on a
    }
    model Held {
        param push: Force = 1000 N
        marker wall = [0, 0, 0] mm
        flexible bar {
            mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
            support = foot
            modes = static(at: tip) + normal(2)
            damping = 70 %
            marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm, tie: rigid)
            marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        }
        force load = Push(bar.tip, wall, x: push)
        output deflection: Length = dot(bar.tip.origin - wall.origin, wall.x)
    }
    analysis settle = transient(Held(), duration: 20 ms, sample: 0.1 ms)
    analysis harder = transient(Held(push: 2000 N), duration: 20 ms, sample: 0.1 ms)";

fn bar(name: &str) -> PathBuf {
    let folder = folder(name);
    write(folder.join("bar.eng"), BAR);
    write(folder.join("bar.bdf"), include_str!("mesh/bar.bdf"));
    folder
}

#[test]
fn a_report_of_a_flexible_body_has_its_modes_stresses_and_files() {
    let folder = bar("report-bar");
    done(&folder, &["run", "bar.eng", "--no-plots", "-q"]);
    done(
        &folder,
        &[
            "report",
            "bar.eng",
            "--vtu",
            "series",
            "--stress-at",
            "20 ms",
        ],
    );
    let page = std::fs::read_to_string(folder.join("results/bar/report.html")).expect("the page");

    let text = String::from_utf8(eng(&folder, &["reduce", "bar.eng"]).stdout).expect("text");
    for line in [
        "  read: 8 × CHEXA (20 nodes)\n",
        "  shapes: longest side 1.25 × the shortest (element ",
        "), 0 elements beyond 20 or below 0.2\n",
    ] {
        assert!(text.contains(line), "{text}");
    }
    let (_, lines) = text.split_once("mode  frequency").expect("modes");
    let modes = table(&page, "Modes of bar");
    assert_eq!(modes.len(), 4);
    for (row, line) in modes.iter().zip(lines.lines().skip(1)) {
        let expected = number(line.split_whitespace().nth(1).expect("a frequency"));
        assert!(
            (number(&row[2]) / expected - 1.0).abs() < 5e-4,
            "{row:?} {line}"
        );
        assert_eq!(number(&row[3]), 70.0);
    }
    for wrong in [["--stress-at", "3 mm"], ["--stress-at", "soon"]] {
        let output = eng(&folder, &["report", "bar.eng", wrong[0], wrong[1]]);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
    }
    // twice the load, twice the stress
    let largest: Vec<f64> = page
        .split("<h3")
        .skip(1)
        .filter(|part| part.contains("Motion, "))
        .map(|part| number(&table(part, "bar: largest von Mises stress")[0][1]))
        .collect();
    assert_eq!(largest.len(), 2);
    assert!((largest[1] / largest[0] - 2.0).abs() < 1e-2, "{largest:?}");
    let captions = captions(&page);
    assert!(
        captions
            .iter()
            .any(|c| c == "Deflection: settle, harder. Last cycle."),
        "{captions:?}"
    );

    let list = std::fs::read_to_string(folder.join("series/settle.pvd")).expect("a list");
    let named: Vec<&str> = list
        .split("file=\"")
        .skip(1)
        .filter_map(|part| Some(part.split_once('"')?.0))
        .collect();
    // 200 intervals, every sixth sample
    assert_eq!(named.len(), 34);
    for name in named {
        let file = std::fs::read_to_string(folder.join("series").join(name)).expect("a file");
        for array in ["displacement", "von_mises", "von_mises_envelope (Pa)"] {
            assert!(file.contains(&format!("Name=\"{array}\"")), "{array}");
        }
    }
    in_a_browser(&folder.join("results/bar/report.html"));
}

/// Uses a page in a headless Chromium, if there is one.
fn in_a_browser(page: &Path) {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let browser = tools::find_or("ENG_TEST_CHROMIUM", &names);
    let (Some(browser), Some(node)) = (browser, tools::find(&["node"])) else {
        return tools::skip("Chromium with Node.js");
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/report.mjs");
    let output = tools::run(Command::new(node).arg(script).arg(browser).arg(page));
    assert!(output.status.success(), "{}", output.status);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    eprintln!("{found:#}");
    let text = std::fs::read_to_string(page).expect("the page");
    let count = |what: &str| found[what].as_u64().expect("a count") as usize;
    assert_eq!(
        count("figures"),
        text.matches("<figure class=\"plot\"").count()
    );
    assert_eq!(
        count("animations"),
        text.matches("<figure class=\"animation\"").count()
    );
    assert!(count("figures") > 0 && count("animations") > 0 && count("tables") > 0);
    // every figure wakes, zooms, shows all again, and shows the values at the pointer
    for fault in [
        "errors",
        "requests",
        "asleep",
        "not_zoomed",
        "not_reset",
        "silent",
        "odd_readouts",
    ] {
        assert_eq!(found[fault], serde_json::json!([]), "{fault}");
    }
    for fault in ["tables_without_headers", "unnamed_figures", "dead_links"] {
        assert_eq!(count(fault), 0, "{fault}");
    }
    let ranks: Vec<i64> = found["headings"]
        .as_array()
        .expect("ranks")
        .iter()
        .filter_map(serde_json::Value::as_i64)
        .collect();
    assert!(ranks[0] == 1 && ranks.windows(2).all(|pair| pair[1] <= pair[0] + 1));
    if found["webgl"] == false {
        return tools::skip("WebGL 2 in Chromium");
    }
    for moved in found["moved"].as_array().expect("animations") {
        assert_eq!(*moved, true, "an animation stands still");
    }
    for colours in found["colours"].as_array().expect("animations") {
        let choices = colours["choices"].as_array().expect("choices").len();
        assert!(choices >= 3, "{colours}");
        assert!(colours["pictures"].as_u64() >= Some(3), "{colours}");
    }
}

#[test]
fn a_sweep_over_speed_has_maps_and_curves() {
    let folder = folder("report-sweep");
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
    let text = std::fs::read_to_string(examples.join("by_hand.eng")).expect("the example");
    let (model, _) = text.split_once("analysis unfired").expect("its analyses");
    let run = "analysis runup[s in [2000, 2500, 3000, 3500, 4000] rpm] =
        transient(Inline4(speed: s), duration: 2 rev, sample: 2 deg)\n";
    write(folder.join("engine.eng"), &format!("{model}{run}"));
    std::fs::copy(examples.join("pressure.csv"), folder.join("pressure.csv")).expect("a copy");
    done(&folder, &["run", "engine.eng", "--no-plots", "-q"]);
    done(
        &folder,
        &[
            "report",
            "engine.eng",
            "--out",
            "page.html",
            "--figures",
            "figures",
        ],
    );
    let page = std::fs::read_to_string(folder.join("page.html")).expect("the page");
    let captions = captions(&page);
    for start in [
        "Least minimum film of main, sweep runup.",
        "Largest radial load of main, sweep runup.",
        "Waterfall of vertical[",
        "Campbell diagram of vertical[",
    ] {
        assert!(
            captions.iter().any(|c| c.starts_with(start)),
            "{start} in {captions:?}"
        );
    }
    // four firings in two revolutions: the second order is the first of the main ones
    for order in [2, 4, 6, 8] {
        assert!(page.contains(&format!(">order {order}</text>")));
    }
    let points =
        Results::read_parquet(folder.join("results/engine/runup.parquet")).expect("points");
    let column = points
        .column("main[3].radial_load.largest")
        .expect("a column");
    let rows = table(&page, "Points of runup");
    assert_eq!(rows.len(), points.columns().len());
    let row = rows
        .iter()
        .find(|row| row[0] == "main[3].radial_load.largest");
    let row = row.expect("the largest load");
    for (cell, value) in row[2..].iter().zip(&column.values) {
        assert!((number(cell) / value - 1.0).abs() < 1e-4, "{cell} {value}");
    }
    // each figure as two files, with the page's number
    let figures = page.matches("<b>Figure ").count();
    assert!(figures > 8);
    let mut names: Vec<String> = std::fs::read_dir(folder.join("figures"))
        .expect("a folder")
        .map(|entry| {
            entry
                .expect("a file")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    assert_eq!(names.len(), 2 * figures);
    assert!(
        names[0].starts_with("figure-01-") && names[0].ends_with(".png"),
        "{names:?}"
    );
}

#[test]
fn results_that_are_missing_are_told() {
    let folder = bar("report-missing");
    let output = eng(&folder, &["report", "bar.eng"]);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        errors.contains("has no results of settle, harder; run first: eng run bar.eng"),
        "{errors}"
    );
    assert!(!folder.join("results").exists());

    done(
        &folder,
        &["run", "bar.eng", "--no-plots", "-q", "--analysis", "settle"],
    );
    let output = eng(&folder, &["report", "bar.eng", "--analysis", "harder"]);
    assert_eq!(output.status.code(), Some(2));
    // an analysis that no argument names gives only a note
    done(&folder, &["report", "bar.eng"]);
    let path = folder.join("results/bar/report.html");
    let page = std::fs::read_to_string(path).expect("the page");
    assert!(page.contains("Without results: harder."));

    // the text has changed since
    write(folder.join("bar.eng"), &BAR.replace("= 1000 N", "= 900 N"));
    let errors = done(&folder, &["report", "bar.eng"]);
    assert!(
        errors.contains("settle: the results are of another text of the model"),
        "{errors}"
    );
    // a file that is no result
    write(folder.join("results/bar/settle.parquet"), "no parquet");
    let output = eng(&folder, &["report", "bar.eng"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("settle.parquet"));
}

/// A rotor on two short films, three revolutions at a speed.
const EITHER_WAY: &str = "
use std.joints.PointOnPlane
use std.journals.Short
use std.drives.PrescribedRotation
model Rotor {
    param speed: AngularVelocity = 100 rad/s
    gravity = [-9.81, 0, 0] m/s^2
    marker axis = [0, 0, 0] mm
    marker seat[j in 1..2] = [0 mm, 0 mm, (j - 1.5)*300 mm]
    body rotor {
        mass = 20 kg
        inertia = [300, 300, 40] g*m^2
        marker mid = origin
        marker neck[j in 1..2] = [0 mm, 0 mm, (j - 1.5)*300 mm]
        start angular_velocity = [0, 0, 1]*speed
    }
    joint thrust = PointOnPlane(rotor.mid, axis)
    drive turn = PrescribedRotation(rotor.mid, axis, speed: speed)
    journal b[j in 1..2] = Short(pin: rotor.neck[j], shell: seat[j], diameter: 40 mm, width: 20 mm,
        radial_clearance: 60 um, viscosity: 30 mPa*s)
    cycle angle = rotation(rotor.mid, axis) { period = 360 deg }
}
analysis forwards = transient(Rotor(), duration: 3 rev, sample: 2 deg)
analysis backwards = transient(Rotor(speed: -100 rad/s), duration: 3 rev, sample: 2 deg)
report sense {
    figure one = orbit(forwards.b[1])
    figure other = orbit(backwards.b[1])
}
";

/// Both senses of rotation have a last cycle, and its marks every 90°.
#[test]
fn the_orbit_of_a_shaft_that_turns_backwards_shows_its_last_cycle() {
    use eng_report::figure::Figure;
    let sources = eng::Sources::from_text("m.eng", EITHER_WAY);
    let program = eng::check(&sources, "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let ran = ["forwards", "backwards"].map(|name| {
        let analysis = program.analysis(name).expect("an analysis");
        let outcome = analysis.run(&mut |_| {}).expect("a run");
        (outcome.results, analysis.machine().expect("its numbers"))
    });
    let runs = ran
        .each_ref()
        .map(|(results, machine)| eng::post::Run::new(results, machine));
    let report = eng::post::evaluate(&program.reports()[0], &runs);
    let drawn: Vec<(usize, String)> = report
        .entries
        .iter()
        .map(|entry| match &entry.outcome {
            Ok(eng::post::Outcome::Figure(figure)) => match &**figure {
                Figure::Orbits(orbits) => (orbits.orbits[0].last_cycle, figure.to_svg()),
                other => panic!("{other:?}"),
            },
            other => panic!("{other:?}"),
        })
        .collect();
    for (first, svg) in &drawn {
        // 540 steps of 2° in three revolutions
        assert!((360..=361).contains(first), "{first}");
        assert!(svg.contains(">earlier<") && svg.contains(">last cycle<"));
    }
    // the same rings: both circles of the bearing, and the marks every 90°
    let rings = |svg: &str| svg.matches("<circle").count();
    assert_eq!(rings(&drawn[0].1), rings(&drawn[1].1));
}
