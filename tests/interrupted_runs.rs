//! Runs that are killed, stopped by the disk, or damaged: their samples are readable, and
//! `--resume` gives the same bits.

use crate::support::Temporary;
use eng::results::Results;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A pendulum on a hinge: some thousand steps of unequal length, more samples than a batch.
const MODEL: &str = "
use std.joints.Revolute

model Swing {
    param load: Mass = 1.2 kg
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = load; inertia = [2, 2, 2] g*m^2; marker top = [0, 400, 0] mm }
    body tip { mass = 0.3 kg; inertia = [1, 1, 1] g*m^2; marker top = [0, 300, 0] mm }
    joint pin = Revolute(bob.top, pivot)
    joint hinge = Revolute(tip.top, bob.origin)
    start pin.angle = 130 deg
    output height = dot(bob.origin.origin, ground.y) as mm
}

analysis swing = transient(Swing(), duration: DURATION, sample: 1 ms)
analysis short = transient(Swing(), duration: 20 ms, sample: 1 ms)
";

struct Place(Temporary);

impl Place {
    fn new(name: &str, duration: &str) -> Place {
        let folder = Temporary::new(&format!("interrupted-{name}"));
        std::fs::write(
            folder.join("swing.eng"),
            MODEL.replace("DURATION", duration),
        )
        .unwrap();
        Place(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_eng"));
        command
            .arg("run")
            .arg(self.path("swing.eng"))
            .args(["--analysis", "swing", "--no-plots", "--quiet", "--out"])
            .arg(self.path(out))
            .args(more)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    fn run(&self, out: &str, more: &[&str]) -> Output {
        self.command(out, more).output().unwrap()
    }

    /// The files in a folder, without the motion of bodies.
    fn files(&self, out: &str) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.path(out))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .filter(|name| !name.contains(".motion."))
            .collect();
        names.sort();
        names
    }
}

fn eng(arguments: &[&str], path: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_eng"))
        .args(arguments)
        .arg(path)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn ok(output: &Output) {
    assert!(output.status.success(), "{}", text(&output.stderr));
}

/// The same sequence of moments in every run of the test (Knuth's generator).
struct Moments(u64);

impl Moments {
    fn next(&mut self, below: u64) -> Duration {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        Duration::from_micros((self.0 >> 33) % below)
    }
}

fn wait_for(path: &Path, child: &mut Child) {
    let began = Instant::now();
    while !path.exists() {
        assert!(
            began.elapsed() < Duration::from_secs(60),
            "{} never came",
            path.display()
        );
        if let Some(status) = child.try_wait().unwrap() {
            panic!("the run ended with {status} before {} came", path.display());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The columns of a run that was killed are the first values of the whole run's, bit by bit.
fn begins_as(left: &Results, expected: &Results) {
    assert_eq!(left.columns().len(), expected.columns().len());
    for (a, b) in left.columns().iter().zip(expected.columns()) {
        assert_eq!(
            (&a.path, &a.display, &a.frame),
            (&b.path, &b.display, &b.frame)
        );
        let same = a
            .values
            .iter()
            .zip(&b.values)
            .all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{}", a.path);
    }
}

#[test]
fn killed_ten_times_it_ends_with_the_same_bytes() {
    let place = Place::new("killed", "40 s");
    let whole = Instant::now();
    ok(&place.run("whole", &[]));
    let whole = whole.elapsed();
    assert_eq!(place.files("whole"), ["swing.parquet"]);
    let expected = Results::read_parquet(place.path("whole/swing.parquet")).unwrap();
    assert_eq!(expected.samples(), 40_001);
    let bytes = |out: &str| {
        ["swing.parquet", "swing.motion.parquet"]
            .map(|name| std::fs::read(place.path(out).join(name)).unwrap())
    };

    let partial = place.path("killed/swing.partial.arrows");
    let motion = place.path("killed/swing.motion.partial.arrows");
    let mut moments = Moments(20);
    let mut killed = 0;
    let (mut longest, mut resumed, mut moved) = (0, 0, 0);
    while killed < 10 {
        let mut child = place.command("killed", &["--resume"]).spawn().unwrap();
        wait_for(&motion, &mut child);
        std::thread::sleep(moments.next((whole.as_micros() / 6) as u64));
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            // the run ended before the kill: its files must be equal, and the next run begins anew
            assert!(bytes("whole") == bytes("killed"), "the files differ");
            std::fs::remove_dir_all(place.path("killed")).unwrap();
            continue;
        }
        killed += 1;
        // at any moment: the samples as far as they went, or all of them
        let path = match partial.exists() {
            true => partial.clone(),
            false => place.path("killed/swing.parquet"),
        };
        // an empty file is that of a run that was killed before it began
        if std::fs::metadata(&path).unwrap().len() > 0 {
            let left = Results::read(&path).unwrap();
            begins_as(&left, &expected);
            longest = longest.max(left.samples());
        }
        resumed += usize::from(place.path("killed/swing.checkpoint").exists());
        if std::fs::metadata(&motion).is_ok_and(|m| m.len() > 0) {
            let left = Results::read(&motion).unwrap();
            moved = moved.max(left.samples());
            assert!(left.column("bob.orientation.w").is_some());
        }
        if std::fs::metadata(&partial).is_ok_and(|m| m.len() > 0) {
            let listed = eng(&["results"], &partial);
            ok(&listed);
            assert!(
                text(&listed.stdout).contains("--resume"),
                "{}",
                text(&listed.stdout)
            );
        }
    }
    assert!(
        longest > 0 && resumed > 0 && moved > 0,
        "{longest} samples, {resumed} checkpoints, {moved} poses"
    );
    ok(&place.run("killed", &["--resume"]));
    assert_eq!(place.files("killed"), ["swing.parquet"]);
    assert!(!motion.exists());
    assert!(bytes("whole") == bytes("killed"), "the files differ");

    // a complete analysis is not run again
    let modified = || {
        ["swing.parquet", "swing.motion.parquet"].map(|name| {
            let file = std::fs::metadata(place.path("killed").join(name)).unwrap();
            file.modified().unwrap()
        })
    };
    let before = modified();
    ok(&place.run("killed", &["--resume"]));
    assert_eq!(modified(), before, "the files were written again");
    assert!(bytes("whole") == bytes("killed"));
}

/// Leaves a killed run with a checkpoint in `out`.
fn interrupt(place: &Place, out: &str) {
    let mut child = place.command(out, &[]).spawn().unwrap();
    wait_for(&place.path(out).join("swing.checkpoint"), &mut child);
    // several batches, whatever else the machine does
    let partial = place.path(out).join("swing.partial.arrows");
    let began = Instant::now();
    while std::fs::metadata(&partial).unwrap().len() < 400_000 {
        assert!(began.elapsed() < Duration::from_secs(60), "no samples come");
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(partial.exists());
}

#[test]
fn damaged_and_foreign_leftovers_are_told_of() {
    let place = Place::new("damaged", "60 s");
    interrupt(&place, "out");
    let (partial, checkpoint) = (
        place.path("out/swing.partial.arrows"),
        place.path("out/swing.checkpoint"),
    );
    let (samples, state) = (
        std::fs::read(&partial).unwrap(),
        std::fs::read(&checkpoint).unwrap(),
    );

    // the end of the stream may be missing anywhere: whole batches remain
    let whole = Results::read(&partial).unwrap().samples();
    let mut seen = usize::MAX;
    for cut in 1..40 {
        let length = samples.len() - cut * samples.len() / 45;
        std::fs::write(&partial, &samples[..length]).unwrap();
        let left = Results::read(&partial).unwrap().samples();
        assert!(left <= seen.min(whole));
        seen = left;
    }
    assert!(seen < whole);
    // fewer samples than the checkpoint counts
    let output = place.run("out", &["--resume"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("run again without --resume"),
        "{}",
        text(&output.stderr)
    );

    std::fs::write(&partial, &samples).unwrap();
    let mut broken = state.clone();
    broken[state.len() / 2] ^= 4;
    std::fs::write(&checkpoint, broken).unwrap();
    let output = place.run("out", &["--resume"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("checkpoint is damaged"),
        "{}",
        text(&output.stderr)
    );

    // another run's leftovers
    std::fs::write(&checkpoint, &state).unwrap();
    for (other, says) in [
        (["--channels", "height"], "it records other channels"),
        (["--set", "load=1kg"], "load was 1.2 kg and is 1 kg"),
    ] {
        let output = place.run("out", &["--resume", other[0], other[1]]);
        assert_eq!(output.status.code(), Some(2), "{other:?}");
        let errors = text(&output.stderr);
        assert!(errors.contains("swing.checkpoint"), "{errors}");
        assert!(errors.contains(says), "{errors}");
    }
    assert_eq!(
        std::fs::read(&partial).unwrap(),
        samples,
        "a refusal changes nothing"
    );

    // samples or motion that are gone: a refusal makes no empty file in their place
    for gone in [
        "out/swing.motion.partial.arrows",
        "out/swing.partial.arrows",
    ] {
        let (gone, aside) = (place.path(gone), place.path("aside"));
        std::fs::rename(&gone, &aside).unwrap();
        let output = place.run("out", &["--resume"]);
        assert_eq!(output.status.code(), Some(2));
        let errors = text(&output.stderr);
        assert!(errors.contains("are not here; run again"), "{errors}");
        assert!(!gone.exists(), "{}", gone.display());
        std::fs::rename(&aside, &gone).unwrap();
    }

    std::fs::write(&partial, b"no stream at all").unwrap();
    let output = eng(&["results"], &place.path("out"));
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("damaged"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn complete_results_of_another_run_are_not_replaced_by_resuming() {
    let place = Place::new("complete", "50 ms");
    ok(&place.run("out", &[]));
    let path = place.path("out/swing.parquet");
    let whole = std::fs::read(&path).unwrap();
    let files = place.files("out");
    let refused = |more: &[&str], says: &str| {
        let output = place.run("out", &[&["--resume"], more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        let errors = text(&output.stderr);
        assert!(errors.contains("swing.parquet"), "{errors}");
        assert!(errors.contains(says), "{errors}");
        assert!(errors.contains("without --resume"), "{errors}");
        assert!(std::fs::read(&path).unwrap() == whole, "{more:?}");
        assert_eq!(place.files("out"), files, "{more:?}");
    };
    refused(&["--set", "load=1kg"], "load was 1.2 kg and is 1 kg");
    refused(&["--channels", "height"], "it records other channels");
    refused(&["--last", "10 ms"], "the recorded part differs");
    ok(&place.run("out", &["--resume"]));
    assert!(std::fs::read(&path).unwrap() == whole);
    let model = place.path("swing.eng");
    let wanted = std::fs::read_to_string(&model).unwrap();
    std::fs::write(&model, wanted.replace("130 deg", "131 deg")).unwrap();
    refused(&[], "the text has changed since");
    // a file that can't be read is no reason to lose it
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let output = place.run("out", &["--resume"]);
    assert_eq!(output.status.code(), Some(2));
    let errors = text(&output.stderr);
    assert!(
        errors.contains("the end of the file is missing"),
        "{errors}"
    );
    ok(&place.run("out", &[]));
    assert!(std::fs::read(&path).unwrap() != whole);
}

#[test]
fn two_runs_do_not_write_one_file() {
    let place = Place::new("two", "60 s");
    let mut child = place.command("out", &[]).spawn().unwrap();
    wait_for(&place.path("out/swing.checkpoint"), &mut child);
    let second = place.run("out", &[]);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(second.status.code(), Some(2));
    assert!(
        text(&second.stderr).contains("another run"),
        "{}",
        text(&second.stderr)
    );
}

#[test]
fn a_full_disk_leaves_no_half_file_and_can_be_gone_on_from() {
    let place = Place::new("full", "8 s");
    ok(&place.run("whole", &[]));
    // the shell's limit on a file's size stands for the disk's
    for blocks in ["8", "300"] {
        let mut limited = Command::new("bash");
        limited
            .args([
                "-c",
                &format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\""),
            ])
            .arg(env!("CARGO_BIN_EXE_eng"))
            .arg("run")
            .arg(place.path("swing.eng"))
            .args(["--analysis", "swing", "--no-plots", "--quiet", "--out"])
            .arg(place.path("out"));
        let output = limited.output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
        assert!(
            text(&output.stderr).contains("swing."),
            "{}",
            text(&output.stderr)
        );
        let files = place.files("out");
        assert!(
            !files
                .iter()
                .any(|f| f.ends_with(".parquet") || f.ends_with(".part")),
            "{files:?}"
        );
    }
    let left = Results::read(place.path("out/swing.partial.arrows"))
        .unwrap()
        .samples();
    assert!(left > 0 && left < 8001, "{left}");
    ok(&place.run("out", &["--resume"]));
    let bytes = |out: &str| std::fs::read(place.path(out).join("swing.parquet")).unwrap();
    assert!(bytes("whole") == bytes("out"));
}

#[test]
fn an_unwritable_folder_is_found_before_the_run() {
    // the run refuses such steps at its start
    let place = Place::new("unwritable", "60 s, step: 1e-11 s");
    let refused = place.run("free", &[]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        text(&refused.stderr).contains("E0701"),
        "{}",
        text(&refused.stderr)
    );
    std::fs::write(place.path("out"), "a file in the way").unwrap();
    let output = place.run("out", &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("out"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn selected_channels_and_the_last_part() {
    let place = Place::new("selected", "100 ms");
    ok(&place.run("all", &[]));
    ok(&place.run(
        "some",
        &["--channels", "height,energy.*", "--last", "20 ms"],
    ));
    let all = Results::read_parquet(place.path("all/swing.parquet")).unwrap();
    let some = Results::read_parquet(place.path("some/swing.parquet")).unwrap();
    assert_eq!((all.samples(), some.samples()), (101, 21));
    let paths: Vec<&str> = some.columns().iter().map(|c| c.path.as_str()).collect();
    assert_eq!(paths[..2], ["time", "height"]);
    // and the seven of the energy audit
    assert_eq!(paths.len(), 9);
    for column in some.columns() {
        assert_eq!(
            column.values,
            all.column(&column.path).unwrap().values[80..]
        );
    }
    for (wrong, says) in [
        (["--channels", "hight"], "did you mean height?"),
        (["--last", "2 rev"], "no cycle"),
        (["--last", "2 kg"], "neither an angle nor a time"),
        (["--last", "often"], "not a number with a unit"),
    ] {
        let output = place.run("wrong", &wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(
            text(&output.stderr).contains(says),
            "{}",
            text(&output.stderr)
        );
    }
}
