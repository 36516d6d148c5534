//! Scripts that compute the points of a study on a cluster.
//!
//! A script does the same with each scheduler: it reduces flexible bodies once, submits an array of tasks, and collects
//! the table when they have ended. A task that is submitted again goes on where it was killed.

use std::fmt::Write;

/// Most tasks of a study, unless the number of their points is stated: clusters limit the sizes of arrays,
/// often to 1,000. A choice below these, with room for other studies.
pub const MOST_TASKS: usize = 150;

/// A scheduler of tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheduler {
    /// Job arrays of Slurm.
    Slurm,
    /// HyperQueue.
    HyperQueue,
    /// GNU parallel.
    Parallel,
}

/// The parts of a script.
#[derive(Clone, Debug)]
pub struct Script {
    /// The model's file.
    pub model: String,
    /// Name of the analysis.
    pub analysis: String,
    /// Folder of the results.
    pub out: String,
    /// Further words of the command `eng run`.
    pub options: Vec<String>,
    /// Number of points.
    pub points: usize,
    /// Points of a task, if stated.
    pub per_task: Option<usize>,
    /// Points that a task runs at the same time.
    pub threads: usize,
    /// Whether the model has flexible bodies.
    pub flexible: bool,
}

/// A word of a shell.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+%@".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

impl Script {
    /// Number of tasks.
    pub fn tasks(&self) -> usize {
        let each = self
            .per_task
            .unwrap_or_else(|| self.points.div_ceil(MOST_TASKS));
        self.points.div_ceil(each.max(1))
    }

    /// The command of a task, whose number the shell writes as `index`.
    fn task(&self, index: &str) -> String {
        let mut words = vec!["run".to_owned(), quoted(&self.model)];
        words.extend(["--analysis".to_owned(), quoted(&self.analysis)]);
        words.extend(self.options.iter().map(|word| quoted(word)));
        words.push(format!("--slice {index}/{}", self.tasks()));
        words.push(format!("--threads {} --quiet", self.threads));
        words.push(format!("--out {}", quoted(&self.out)));
        format!("\"${{ENG:-eng}}\" {}", words.join(" "))
    }

    /// The text of the script, for a POSIX shell.
    pub fn text(&self, scheduler: Scheduler) -> String {
        let (tasks, threads) = (self.tasks(), self.threads);
        let name = quoted(&self.analysis);
        let (model, out) = (quoted(&self.model), quoted(&self.out));
        let log = quoted(&format!("{}/{}.log", self.out, self.analysis));
        let tool = match scheduler {
            Scheduler::Slurm => "sbatch",
            Scheduler::HyperQueue => "hq submit",
            Scheduler::Parallel => "parallel",
        };
        let mut text = format!(
            "#!/bin/sh
# {} points of {name} in {tasks} tasks, made by `eng plan`. Run it in the folder in which it was made. Its arguments
# go to `{tool}`. ENG names the command `eng` if it is not on the path. Run it again after failures: what is done
# is not computed again. `eng status {out}` shows how far it is.
set -eu
test -f {model} || {{ echo \"there is no {model} here\" >&2; exit 2; }}
mkdir -p {out}
",
            self.points
        );
        let reduce = format!("\"${{ENG:-eng}}\" reduce {model}");
        let collect = format!("\"${{ENG:-eng}}\" collect {out} --analysis {name}");
        let lines = match scheduler {
            Scheduler::Slurm => {
                let wrap = |command: &str| quoted(&format!("exec {command}"));
                let submit = format!(
                    "sbatch --parsable --kill-on-invalid-dep=yes --output={log} --open-mode=append"
                );
                let after = if self.flexible {
                    " --dependency=\"afterok:${bodies%%;*}\""
                } else {
                    ""
                };
                let mut lines = String::new();
                if self.flexible {
                    let _ = writeln!(
                        lines,
                        "bodies=$({submit} --job-name={name}-bodies --wrap {})",
                        wrap(&reduce)
                    );
                }
                let task = wrap(&self.task("$SLURM_ARRAY_TASK_ID"));
                let _ = write!(
                    lines,
                    "points=$({submit} --job-name={name} --array=1-{tasks} --cpus-per-task={threads} --requeue{after} \"$@\" \\
    --wrap {task})
table=$({submit} --job-name={name}-table --dependency=\"afterany:${{points%%;*}}\" --wrap {})
echo \"submitted: points ${{points%%;*}}, table ${{table%%;*}}\"
",
                    wrap(&collect)
                );
                lines
            }
            Scheduler::HyperQueue => {
                let submit = "hq submit --wait --stdout none --stderr none";
                let run = |command: &str| quoted(&format!("exec {command} 2>> {log}"));
                let mut lines = String::new();
                if self.flexible {
                    let _ = writeln!(
                        lines,
                        "{submit} --name {name}-bodies -- sh -c {}",
                        run(&reduce)
                    );
                }
                let _ = write!(
                    lines,
                    "{submit} --name {name} --array 1-{tasks} --cpus {threads} \"$@\" -- \\
    sh -c {} || echo \"tasks failed: see {log}\" >&2
exec {collect}
",
                    run(&self.task("$HQ_TASK_ID"))
                );
                lines
            }
            Scheduler::Parallel => {
                let mut lines = String::new();
                if self.flexible {
                    let _ = writeln!(lines, "{reduce}");
                }
                let jobs = match threads {
                    1 => String::new(),
                    _ => format!(" --jobs {}%", (100 / threads).max(1)),
                };
                let task = quoted(&format!("{} 2>> {log}", self.task("{}")));
                let _ = write!(
                    lines,
                    "seq {tasks} | parallel{jobs} \"$@\" {task} || echo \"tasks failed: see {log}\" >&2
exec {collect}
"
                );
                lines
            }
        };
        text.push_str(&lines);
        text
    }
}
