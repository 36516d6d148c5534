//! `eng watch` as a process: a save begins a round, Ctrl-C ends the command.

use crate::support::Temporary;
use eng::results::Results;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

const MODEL: &str = "
use std.joints.Revolute
model Swing {
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = 1 kg; inertia = [2, 2, 2] g*m^2; marker top = [0, 400, 0] mm }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 30 deg
}
analysis one = transient(Swing(), duration: 20 ms, sample: 10 ms)
analysis two = transient(Swing(), duration: 30 ms, sample: 10 ms)
";

/// A command that runs, and the lines of its output.
struct Watched {
    child: Child,
    lines: Receiver<String>,
}

impl Watched {
    fn start(folder: &Temporary) -> Watched {
        let mut child = Command::new(env!("CARGO_BIN_EXE_eng"))
            .current_dir(folder)
            .args([
                "watch",
                "swing.eng",
                "--quiet",
                "--no-plots",
                "--out",
                "out",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let output = BufReader::new(child.stdout.take().unwrap());
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in output.lines().map_while(Result::ok) {
                // the test has ended
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Watched { child, lines }
    }

    /// The words of the next round.
    fn round(&self) -> String {
        let line = self.lines.recv_timeout(Duration::from_secs(60)).unwrap();
        let (_, words) = line.split_once(" s: ").unwrap();
        words.to_owned()
    }

    /// Sends the signal of Ctrl-C and waits for the end.
    #[cfg(unix)]
    fn interrupt(&mut self) -> ExitStatus {
        let send = format!("kill -INT {}", self.child.id());
        let sent = Command::new("sh").args(["-c", &send]).status().unwrap();
        assert!(sent.success());
        self.child.wait().unwrap()
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        // it has ended, unless the test has failed
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[cfg(unix)]
#[test]
fn a_save_begins_a_round_and_an_interrupt_ends_it() {
    use std::os::unix::process::ExitStatusExt;
    let folder = Temporary::new("watch");
    let path = folder.join("swing.eng");
    std::fs::write(&path, MODEL).unwrap();
    let mut watched = Watched::start(&folder);
    assert_eq!(watched.round(), "ran one, two; watching 1 file");
    // as editors save: a new file in the place of the old one
    let longer = MODEL.replace("20 ms", "50 ms");
    std::fs::write(folder.join("new"), &longer).unwrap();
    std::fs::rename(folder.join("new"), &path).unwrap();
    assert_eq!(watched.round(), "ran one; kept two; watching 1 file");
    std::fs::write(&path, longer.replace("50 ms", "50 mm")).unwrap();
    assert_eq!(watched.round(), "not done: see the messages above");
    std::fs::write(&path, MODEL).unwrap();
    assert_eq!(watched.round(), "ran one; kept two; watching 1 file");
    let ended = watched.interrupt();
    assert_eq!((ended.code(), ended.signal()), (None, Some(2)));
    let mut files: Vec<_> = std::fs::read_dir(folder.join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    files.sort();
    let due = ["one.motion", "one", "two.motion", "two"].map(|stem| format!("{stem}.parquet"));
    assert_eq!(files, due.map(std::ffi::OsString::from));
    let one = Results::read_parquet(folder.join("out/one.parquet")).unwrap();
    assert_eq!(one.samples(), 3);
}

#[test]
fn wrong_words_end_the_command() {
    let folder = Temporary::new("watch-words");
    std::fs::write(folder.join("swing.eng"), MODEL).unwrap();
    for (words, message) in [
        ("none.eng", "none.eng"),
        ("swing.eng --step 1mm", "a step is a time"),
        ("swing.eng --last 1kg", "--last 1kg"),
        ("swing.eng --set load=1 --set load=2", "twice"),
        ("swing.eng --check --csv", "cannot be used with"),
        ("swing.eng --slice 1/2", "unexpected argument"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_eng"))
            .current_dir(&folder)
            .arg("watch")
            .args(words.split(' '))
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words}: {errors}");
        assert!(errors.contains(message), "{words}: {errors}");
    }
}
