//! Follows a page as a reader does: writes its files, runs its commands, makes its mistakes.
//!
//! | on the page | done here |
//! | --- | --- |
//! | a block `eng arm.eng` | the file `arm.eng` |
//! | a block `eng arm.eng, in the model` | the lines are added at the end of the file's model |
//! | a block `eng arm.eng, at the end` | the lines are added at the end of the file |
//! | a block `eng` | a text of its own: it has no message, and its analyses run |
//! | a block `csv design.csv` | the file `design.csv` |
//! | a block `console` | its lines that begin with `eng` are run, up to a `>` |
//! | a block `python` | nothing: CI runs it |
//! | a block `text` after it | each line is a line of the output. `…` is any words, and numbers agree within 1 % |
//! | a row of a table `right`, `wrong`, `message` | in the last file, the first place of `right` becomes `wrong`, and `eng check` gives the message |

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Largest relative difference of a number on the page from the printed one: pages shall not change with every
/// change of the last digits.
const AGREEMENT: f64 = 0.01;

/// A part of a page that says something about the program.
enum Piece<'a> {
    Block {
        info: &'a str,
        text: &'a str,
    },
    Mistake {
        right: &'a str,
        wrong: &'a str,
        message: &'a str,
    },
}

/// The pieces of a page with their line numbers.
fn pieces(page: &str) -> Vec<(usize, Piece<'_>)> {
    let mut found = Vec::new();
    let mut block: Option<(usize, &str, usize)> = None;
    let mut in_table = false;
    let mut at = 0;
    for (index, line) in page.split_inclusive('\n').enumerate() {
        let begin = at;
        at += line.len();
        let line = line.trim_end();
        match block {
            Some((first, info, start)) => {
                if line == "```" {
                    let text = &page[start..begin];
                    found.push((first, Piece::Block { info, text }));
                    block = None;
                }
            }
            None => {
                if let Some(info) = line.strip_prefix("```") {
                    block = Some((index + 1, info, at));
                } else if line.starts_with("| right | wrong |") {
                    in_table = true;
                } else if !line.starts_with('|') {
                    in_table = false;
                } else if in_table && !line.starts_with("| ---") {
                    let cells: Vec<&str> = line.trim_matches('|').split('|').collect();
                    let [right, wrong, message] = cells.as_slice() else {
                        panic!("line {}: {} cells", index + 1, cells.len());
                    };
                    let right = right.trim().trim_matches('`');
                    assert!(!right.is_empty(), "line {}: nothing to replace", index + 1);
                    let wrong = wrong.trim().trim_matches('`');
                    let message = message.trim();
                    found.push((
                        index + 1,
                        Piece::Mistake {
                            right,
                            wrong,
                            message,
                        },
                    ));
                }
            }
        }
    }
    found
}

/// Whether the words of a page are those of a printed line.
fn fits(words: &[&str], printed: &[&str]) -> bool {
    match (words, printed) {
        ([], []) => true,
        (["…", rest @ ..], _) => {
            (0..=printed.len()).any(|skipped| fits(rest, &printed[skipped..]))
        }
        ([word, words @ ..], [other, printed @ ..]) => {
            let same = word == other
                || match (word.parse::<f64>(), other.parse::<f64>()) {
                    (Ok(a), Ok(b)) => (a - b).abs() <= AGREEMENT * a.abs(),
                    _ => false,
                };
            same && fits(words, printed)
        }
        _ => false,
    }
}

/// A reader's folder.
struct Desk {
    page: String,
    folder: PathBuf,
    files: BTreeMap<String, String>,
    /// The file that was written last.
    file: String,
    /// The output of the last commands.
    printed: String,
}

impl Desk {
    fn new(page: &str, chapter: Option<&str>) -> Desk {
        let name: String = format!("{page} {}", chapter.unwrap_or_default())
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
            .collect();
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        match std::fs::remove_dir_all(&folder) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => panic!("{error}"),
            _ => std::fs::create_dir_all(&folder).expect("a folder"),
        }
        Desk {
            page: page.to_owned(),
            folder,
            files: BTreeMap::new(),
            file: String::new(),
            printed: String::new(),
        }
    }

    /// The output of `eng` with these arguments.
    fn eng(&self, arguments: &[&str]) -> String {
        let made = Command::new(env!("CARGO_BIN_EXE_eng"))
            .args(arguments)
            .current_dir(&self.folder)
            .env(
                "ENG_CACHE",
                Path::new(env!("CARGO_TARGET_TMPDIR")).join("pages-cache"),
            )
            .output()
            .expect("the command");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        text(&made.stdout) + "\n" + &text(&made.stderr)
    }

    fn write(&mut self, target: &str, text: &str) {
        let (name, place) = target.split_once(", ").unwrap_or((target, ""));
        let file = self.files.entry(name.to_owned()).or_default();
        match place {
            "" => text.clone_into(file),
            "at the end" => file.push_str(text),
            "in the model" => {
                let model = file.find("\nmodel ").expect("a model in the file");
                let end = file[model..].find("\n}").expect("its end") + model + 1;
                file.insert_str(end, text);
            }
            _ => panic!("{}: a block {place}", self.page),
        }
        std::fs::write(self.folder.join(name), file).expect("a file");
        name.clone_into(&mut self.file);
    }

    /// Each line of the page is one of the output.
    fn compare(&self, line: usize, text: &str) {
        let printed: Vec<Vec<&str>> = self
            .printed
            .lines()
            .map(|line| line.split_whitespace().collect())
            .collect();
        for shown in text.lines() {
            let words: Vec<&str> = shown.split_whitespace().collect();
            assert!(
                printed.iter().any(|printed| fits(&words, printed)),
                "{} after line {line}: `{shown}` is not printed:\n{}",
                self.page,
                self.printed
            );
        }
    }

    fn mistake(&self, line: usize, right: &str, wrong: &str, message: &str) {
        let place = format!("{} line {line}", self.page);
        let text = self.files.get(&self.file).expect("a file");
        assert!(
            text.contains(right),
            "{place}: `{right}` is not in the text"
        );
        std::fs::write(
            self.folder.join("mistake.eng"),
            text.replacen(right, wrong, 1),
        )
        .expect("a file");
        let printed = self.eng(&["check", "mistake.eng"]);
        let expected = match message.split_once(": ") {
            Some((code, message)) => format!("[{code}]: {message}"),
            None if message == "no errors" => "no errors, no warnings".to_owned(),
            None => format!("[{message}]"),
        };
        assert!(
            printed.contains(&expected),
            "{place}: {expected}:\n{printed}"
        );
    }
}

/// Does all that a page shows, or one of its chapters.
pub fn follow(page: &str, chapter: Option<&str>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let whole = std::fs::read_to_string(root.join(page)).expect("a page");
    let text = match chapter {
        None => whole.as_str(),
        Some(name) => {
            let (_, rest) = whole
                .split_once(&format!("\n## {name}\n"))
                .expect("the chapter");
            rest.split("\n## ").next().expect("its text")
        }
    };
    let mut desk = Desk::new(page, chapter);
    if text.contains("mesh/") {
        std::fs::create_dir(desk.folder.join("mesh")).expect("a folder");
        for mesh in ["mesh/crank.bdf.gz", "mesh/block.inp.gz"] {
            let from = root.join("examples/paper").join(mesh);
            std::fs::copy(from, desk.folder.join(mesh)).expect("a mesh");
        }
    }
    let mut done = 0;
    for (line, piece) in pieces(text) {
        match piece {
            Piece::Block { info: "eng", text } => {
                run_all(text);
            }
            Piece::Block {
                info: "console",
                text,
            } => {
                desk.printed.clear();
                for command in text.lines() {
                    if let Some(arguments) = command.strip_prefix("eng ") {
                        let (arguments, _) = arguments.split_once(" > ").unwrap_or((arguments, ""));
                        let arguments: Vec<&str> = arguments.split_whitespace().collect();
                        let printed = desk.eng(&arguments);
                        desk.printed.push_str(&printed);
                    }
                }
            }
            Piece::Block { info: "text", text } => {
                desk.compare(line, text);
                done += 1;
            }
            Piece::Block { info: "python", .. } => {}
            Piece::Block { info, text } => {
                let target = info.strip_prefix("eng ").or(info.strip_prefix("csv "));
                match target {
                    Some(target) => desk.write(target, text),
                    None => panic!("{page}: a block `{info}`"),
                }
            }
            Piece::Mistake {
                right,
                wrong,
                message,
            } => {
                desk.mistake(line, right, wrong, message);
                done += 1;
            }
        }
    }
    assert!(done > 0, "{page} shows nothing");
}

/// Checks a text, which must give no message if it has a model, and runs its analyses. Returns their number.
pub fn run_all(text: &str) -> usize {
    let sources = eng::Sources::from_text("model.eng", text.to_owned());
    let checked = eng::check(&sources, "model.eng");
    let report = checked.report();
    assert!(report.diagnostics().is_empty(), "{report}");
    if !text.contains("\nmodel ") {
        return 0;
    }
    let program = checked
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let mut run = 0;
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
    run
}

/// The targets of the links of a page.
pub fn links(page: &str) -> Vec<&str> {
    let starts = page.match_indices("](").map(|(at, found)| at + found.len());
    starts
        .filter_map(|at| page[at..].find(')').map(|end| &page[at..at + end]))
        .collect()
}

/// The names under which links reach the headings of a page: small letters, blanks as `-`, without punctuation.
pub fn headings(page: &str) -> BTreeSet<String> {
    let mut fenced = false;
    let mut found = BTreeSet::new();
    for line in page.lines() {
        if line.starts_with("```") {
            fenced = !fenced;
        } else if !fenced && line.starts_with('#') {
            let name = line.trim_start_matches('#').trim().to_lowercase();
            let name = name.replace(' ', "-");
            let kept = |c: &char| c.is_alphanumeric() || *c == '-' || *c == '_';
            found.insert(name.chars().filter(kept).collect());
        }
    }
    found
}

/// A path from a folder, without `..`.
pub fn joined(folder: &Path, file: &str) -> PathBuf {
    let mut place = folder.to_owned();
    for part in file.split('/') {
        match part {
            ".." => {
                place.pop();
            }
            "." | "" => {}
            part => place.push(part),
        }
    }
    place
}
