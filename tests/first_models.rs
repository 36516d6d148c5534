//! `eng new` writes models that check, run and agree with closed forms; files for shells and `man` name all commands.

use crate::support::column;
use eng::Results;
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("a folder");
        Folder(folder)
    }

    fn eng(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_eng"))
            .current_dir(&self.0)
            .args(arguments)
            .output()
            .expect("the command starts")
    }

    /// Makes the model, and shows that it has the form of `eng fmt` and no message.
    fn model(&self, kind: &str) {
        let made = self.eng(&["new", "first", "--from", kind]);
        assert_eq!(made.status.code(), Some(0), "{made:?}");
        let form = self.eng(&["fmt", "--check", "first.eng"]);
        assert_eq!(form.status.code(), Some(0), "{kind}: {form:?}");
        let checked = text(&self.eng(&["check", "first.eng"]).stdout);
        assert!(
            checked.ends_with("no errors, no warnings\n"),
            "{kind}: {checked}"
        );
    }

    /// Runs analyses; returns the printed text.
    fn run(&self, analyses: &[&str]) -> String {
        let mut arguments = vec!["run", "first.eng", "--no-plots"];
        arguments.extend(analyses.iter().flat_map(|name| ["--analysis", name]));
        let output = self.eng(&arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        text(&output.stdout)
    }

    fn results(&self, analysis: &str) -> Results {
        let file = format!("results/first/{analysis}.parquet");
        Results::read(self.0.join(file)).expect("results")
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn mean(values: &[f64]) -> f64 {
    // both ends of the cycle are samples
    values[1..].iter().sum::<f64>() / (values.len() - 1) as f64
}

/// The work of a cycle, ∮ p dV in J, of pressures in Pa and volumes in m³.
fn work(pressure: &[f64], volume: &[f64]) -> f64 {
    let steps = pressure.windows(2).zip(volume.windows(2));
    steps
        .map(|(p, v)| 0.5 * (p[0] + p[1]) * (v[1] - v[0]))
        .sum()
}

/// The bob swings up again to its first height, and its lowest point is the length below the pivot. The frequency
/// is that of a physical pendulum.
#[test]
fn the_pendulum_swings_as_its_closed_form() {
    let folder = Folder::new("first_pendulum");
    folder.model("pendulum");
    let said = folder.run(&[]);
    let swing = folder.results("swing");
    let height = column(&swing, "height");
    let highest = height.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = height.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((highest + 0.4 * (PI / 6.0).cos()).abs() < 1e-5, "{highest}");
    assert!((lowest + 0.4).abs() < 5e-4, "{lowest}");
    let frequency = (1.2_f64 * 9.81 * 0.4 / (2e-3 + 1.2 * 0.4 * 0.4)).sqrt() / TAU;
    assert!(
        said.contains(&format!(" {frequency:.3} ")),
        "{frequency} in\n{said}"
    );
}

/// The drive takes the work of the gas, less the heat of the films.
#[test]
fn the_engine_gives_the_work_of_its_gas() {
    let folder = Folder::new("first_engine");
    folder.model("engine");
    let said = folder.run(&["fired"]);
    assert!(said.contains("Least film"), "{said}");
    let fired = folder.results("fired");
    let speed = 3000.0 * TAU / 60.0;
    let taken = -mean(column(&fired, "drive_torque")) * speed;
    let area = PI / 4.0 * 86e-3 * 86e-3;
    // the volume grows as the piston travels down
    let cycle = -area
        * work(
            column(&fired, "gas.gauge_pressure"),
            column(&fired, "liner.travel"),
        );
    let indicated = cycle * speed / (2.0 * TAU);
    let heat: f64 = (1..=2)
        .map(|j| mean(column(&fired, &format!("main[{j}].power_loss"))))
        .sum();
    println!("indicated {indicated} W, heat {heat} W, taken {taken} W");
    assert!(((indicated - heat) / taken - 1.0).abs() < 2e-3);
}

/// The drive gives the work of the gas. The mass that comes in goes out: the volume that the ideal cycle leaves for
/// suction, V₁ − V₄ with V₄ = V₃ (p₂/p₁)^(1/n), less the losses of the valves.
#[test]
fn the_compressor_takes_the_work_of_its_gas() {
    let folder = Folder::new("first_compressor");
    folder.model("compressor");
    folder.run(&["running"]);
    let running = folder.results("running");
    let given = mean(column(&running, "drive_torque")) * TAU;
    let taken = -work(
        column(&running, "gas.pressure"),
        column(&running, "gas.displaced"),
    );
    println!("a turn: drive {given} J, gas {taken} J");
    assert!((given / taken - 1.0).abs() < 5e-3);
    let area = PI / 4.0 * 80e-3 * 80e-3;
    let (dead, swept) = (area * 2e-3, area * 70e-3);
    let ratio = 8.0_f64;
    let sucked = swept + dead - dead * ratio.powf(1.0 / 1.3);
    let ideal = 1.3 / 0.3 * 1e5 * sucked * (ratio.powf(0.3 / 1.3) - 1.0);
    println!("ideal {ideal} J");
    assert!(taken > ideal && taken < 1.15 * ideal);
}

#[test]
fn a_file_that_exists_is_not_replaced() {
    let folder = Folder::new("first_exists");
    std::fs::write(folder.0.join("mine.eng"), "my text").expect("a file");
    for name in ["mine", "mine.eng"] {
        let output = folder.eng(&["new", name]);
        assert_eq!(output.status.code(), Some(2));
        let said = text(&output.stderr);
        assert!(
            said.contains("mine.eng: exists and is not replaced"),
            "{said}"
        );
    }
    let kept = std::fs::read_to_string(folder.0.join("mine.eng")).expect("the file");
    assert_eq!(kept, "my text");
    let lost = folder.eng(&["new", "no_folder/mine"]);
    assert_eq!(lost.status.code(), Some(2));
    // the end of a version is no ending of a file
    let version = folder.eng(&["new", "v1.2"]);
    assert_eq!(version.status.code(), Some(0), "{version:?}");
    assert!(folder.0.join("v1.2.eng").is_file());
    let other = folder.eng(&["new", "two words", "--from", "pendulum"]);
    assert!(
        text(&other.stdout).contains("eng run    \"two words.eng\""),
        "{other:?}"
    );
}

#[test]
fn shells_and_the_manual_know_all_commands() {
    let folder = Folder::new("first_shells");
    let commands = ["run", "check", "report", "fmt", "explain", "new"];
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = folder.eng(&["completions", shell]);
        assert_eq!(output.status.code(), Some(0), "{shell}");
        let script = text(&output.stdout);
        for word in commands.iter().chain(&["no-plots"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    let output = folder.eng(&["manual", "--out", "man/man1"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    for page in std::iter::once("eng".to_owned()).chain(commands.map(|c| format!("eng-{c}"))) {
        let path = folder.0.join(format!("man/man1/{page}.1"));
        let written = std::fs::read_to_string(&path).expect("a page");
        assert!(
            written.contains(&format!(".TH {page} 1")),
            "{page}: {written}"
        );
    }
}
