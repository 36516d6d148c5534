//! Results of a periodic analysis state whether its cycle repeats, also if `--resume` finds it
//! complete.

use crate::support::Temporary;
use eng::results::Results;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A part of the wave decays: fast at one point of the sweep, too slowly at the other.
const MODEL: &str = "
use std.joints.Revolute
model Spin {
    param rate: Frequency = 1 Hz
    gravity = [0, 0, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body disc { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 1]*(600 rpm) }
    joint pin = Revolute(disc.hub, pivot)
    cycle angle = rotation(disc.hub, pivot) { period = 360 deg }
    output wave: Force = 1 N * (cos(cycle.angle) + exp(-rate*time)) as N
}
analysis sw[r in [1, 40] Hz] = periodic(Spin(rate: r), sample: 10 deg, cycles: 6, start: assembled)
";

struct Place(Temporary);

impl Place {
    fn new(name: &str) -> Place {
        let folder = Temporary::new(&format!("periodic-{name}"));
        std::fs::write(folder.join("spin.eng"), MODEL).expect("written");
        Place(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn run(&self, more: &[&str]) -> (String, String) {
        let mut command = eng("run");
        command
            .arg(self.path("spin.eng"))
            .args(["--analysis", "sw", "--no-plots", "--out"])
            .arg(self.path("out"))
            .args(more);
        told(command.output().expect("eng runs"))
    }
}

fn eng(verb: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_eng"));
    command.arg(verb);
    command
}

/// Output and messages of a command that succeeds.
fn told(output: Output) -> (String, String) {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    let (said, errors) = (text(output.stdout), text(output.stderr));
    assert!(output.status.success(), "{errors}");
    (said, errors)
}

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).expect("a file")
}

#[test]
fn a_resumed_sweep_has_the_same_table_and_tells_the_same() {
    let place = Place::new("sweep");
    let (said, errors) = place.run(&[]);
    assert!(errors.contains("W0713"), "{errors}");
    assert!(errors.contains("after 6 cycles: wave"), "{errors}");
    let table = read(&place.path("out/sw.parquet"));
    let kept = Results::read_parquet(place.path("out/sw.parquet")).expect("the table");
    let column = |path: &str| kept.column(path).expect(path).values.clone();
    // the fast one falls by 1/55 a cycle, below 1e-3 of the swing of 2 N after a few
    assert_eq!(column("repeats"), [0.0, 1.0]);
    assert_eq!(column("cycles")[0], 6.0);
    assert!((3.0..6.0).contains(&column("cycles")[1]), "{said}");

    let (again, errors_again) = place.run(&["--resume"]);
    assert!(again.contains("was complete"), "{again}");
    assert!(again.contains("does not repeat after 6 cycles"), "{again}");
    assert_eq!(errors, errors_again);
    assert!(read(&place.path("out/sw.parquet")) == table);
}

#[test]
fn what_does_not_repeat_is_listed_and_on_the_page() {
    let place = Place::new("listed");
    place.run(&[]);
    let mut results = eng("results");
    results.arg(place.path("out/sw[1].parquet"));
    let (said, _) = told(results.output().expect("eng runs"));
    let line = "does not repeat after 6 cycles; the last differs by ";
    assert!(said.contains(line), "{said}");
    assert!(
        said.contains("of the peak-to-peak value of wave\n"),
        "{said}"
    );
    let mut report = eng("report");
    report
        .arg(place.path("spin.eng"))
        .arg("--results")
        .arg(place.path("out"));
    let (_, errors) = told(report.output().expect("eng runs"));
    assert!(errors.contains(&format!("sw[1]: {line}")), "{errors}");
    let page = String::from_utf8(read(&place.path("out/report.html"))).expect("UTF-8");
    assert!(page.contains(line), "the summary's warning");
    assert!(page.contains("does not repeat after 6<"), "the table");
    assert!(page.contains("repeats after "), "the table");
}
