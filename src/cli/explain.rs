//! `eng explain`.

use super::arguments::ExplainArguments;
use super::open::open;
use super::terminal::Terminal;
use super::{MODEL_WRONG, Refusal, Stop, USAGE_OR_SYSTEM};
use crate::codes::{self, Code};
use eng_grammar::SourceMap;
use std::path::Path;

/// Width of the text. A choice that fits into usual terminals.
const WIDTH: usize = 96;

pub(super) fn explain(
    arguments: &ExplainArguments,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let Some(asked) = &arguments.code else {
        for code in codes::all() {
            writeln!(console.output, "{}  {}", code.code, code.title)?;
        }
        return Ok(());
    };
    let asked = asked.trim();
    if asked.ends_with(".eng") {
        return part(Path::new(asked), arguments.path.as_deref(), console);
    }
    if let Some(path) = &arguments.path {
        writeln!(
            console.errors,
            "error: {asked} is no file of a model, and {path} is a path in one: `eng explain MODEL.eng {path}`"
        )?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
    }
    let found = codes::find(asked).map(explanation);
    let found = found.or_else(|| kind(asked)).or_else(|| function(asked));
    let found = found.or_else(|| crate::definitions::of_library(asked));
    let found = found.or_else(|| word_or_lint(asked));
    match found.or_else(|| argument(asked)) {
        Some(text) => {
            write!(console.output, "{text}")?;
            Ok(())
        }
        None => {
            write!(
                console.errors,
                "error: `{asked}` is no code, word, function, analysis, figure, lint or name of the library"
            )?;
            match nearest(asked) {
                Some(near) => writeln!(console.errors, "; did you mean {near}?")?,
                None => writeln!(console.errors)?,
            }
            writeln!(
                console.errors,
                "`eng explain` lists all codes; `eng explain MODEL.eng {asked}` looks in a model"
            )?;
            Err(Stop::Code(USAGE_OR_SYSTEM))
        }
    }
}

/// A word of the language, or the lints of a name.
fn word_or_lint(asked: &str) -> Option<String> {
    if let Some(word) = crate::vocabulary::word(asked) {
        return Some(wrapped(&word) + "\n");
    }
    let own = crate::vocabulary::lint(asked).map(|lint| wrapped(&lint) + "\n");
    let parts = [own, crate::definitions::lints_of_library(asked)];
    let found: Vec<String> = parts.into_iter().flatten().collect();
    (!found.is_empty()).then(|| found.join("\n"))
}

/// A part of a model, or a list of its parts.
fn part(model: &Path, path: Option<&str>, console: &mut Terminal<'_>) -> Result<(), Stop> {
    let checked = match open(model) {
        Ok(checked) => checked,
        Err(refusal) => return Err(refusal.show(&SourceMap::new(), console)),
    };
    let Some(program) = checked.program() else {
        let report = checked.report();
        console
            .errors
            .messages(report.diagnostics(), report.texts())?;
        return Err(Stop::Code(MODEL_WRONG));
    };
    let text = match path {
        Some(path) => program.explain(path.trim()),
        None => program.items(),
    };
    match text {
        Ok(text) => Ok(write!(console.output, "{text}")?),
        Err(error) => Err(Refusal::from(error).show(program.texts(), console)),
    }
}

fn explanation(code: &Code) -> String {
    let mut text = format!(
        "{}: {}\n\n{}\n",
        code.code,
        code.title,
        wrapped(code.meaning)
    );
    if !code.wrong.is_empty() {
        text.push_str(&format!(
            "\nwrong:\n{}\nright:\n{}\n",
            indented(code.wrong),
            indented(code.right)
        ));
    }
    text
}

/// The content and the arguments of a kind of analysis or of figure.
fn kind(name: &str) -> Option<String> {
    let mut rows: Vec<(String, &str)> = Vec::new();
    let title = if let Some(row) = eng_system::analysis::kind(name) {
        for argument in row.arguments {
            let unit = match argument.unit {
                "" => String::new(),
                unit => format!(" ({unit})"),
            };
            rows.push((format!("{}{unit}", argument.name), argument.about));
        }
        format!("`{name}` is an analysis: {}", row.about)
    } else {
        let row = eng_system::figure::kind(name)?;
        let arguments = row.arguments.iter();
        rows.extend(arguments.map(|argument| (argument.name.to_owned(), argument.about)));
        format!("`{name}` is a figure: {}", row.about)
    };
    let width = rows.iter().map(|(name, _)| name.chars().count()).max();
    let width = width.unwrap_or_default();
    let mut text = wrapped(&title) + "\n";
    if !rows.is_empty() {
        text.push_str("\narguments:\n");
    }
    for (name, about) in rows {
        let pad = " ".repeat(width - name.chars().count());
        text.push_str(&format!("    {name}{pad}  {about}\n"));
    }
    Some(text)
}

/// An argument of analyses and figures, with its meaning in each of them.
fn argument(name: &str) -> Option<String> {
    let analyses = eng_system::analysis::KINDS.iter().flat_map(|row| {
        let arguments = row.arguments.iter();
        arguments.map(move |argument| ("analysis", row.name, argument.name, argument.about))
    });
    let figures = eng_system::figure::KINDS.iter().flat_map(|row| {
        let arguments = row.arguments.iter();
        arguments.map(move |argument| ("figure", row.name, argument.name, argument.about))
    });
    let own = analyses.chain(figures).filter(|found| found.2 == name);
    let texts: Vec<String> = own
        .map(|(noun, kind, _, about)| {
            wrapped(&format!(
                "`{name}` is an argument of the {noun} `{kind}`: {about}"
            )) + "\n"
        })
        .collect();
    (!texts.is_empty()).then(|| texts.join("\n"))
}

/// The forms and the meaning of a function of the language.
fn function(name: &str) -> Option<String> {
    let (forms, about) = eng_compiler::functions::explained(name)?;
    let forms: Vec<String> = forms
        .split("), ")
        .map(|form| format!("`{})`", form.trim_end_matches(')')))
        .collect();
    Some(wrapped(&format!("{}: {about}", forms.join(", "))) + "\n")
}

fn indented(example: &str) -> String {
    example
        .lines()
        .map(|line| format!("    {line}"))
        .collect::<Vec<_>>()
        .join("\n")
}

fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

/// The nearest code: letters and digits may be mistyped, missing or exchanged. A text with the form of a code
/// must have its digits; only its letter may differ.
fn nearest(asked: &str) -> Option<&'static str> {
    let asked = asked.to_ascii_uppercase();
    let number = |code: &str| {
        let digits = code.get(1..).unwrap_or_default();
        let whole = digits.len() == 4 && digits.bytes().all(|b| b.is_ascii_digit());
        whole.then(|| digits.to_owned())
    };
    let wanted = number(&asked);
    let known = codes::all()
        .into_iter()
        .filter(|code| wanted.is_none() || number(code.code) == wanted);
    eng_grammar::nearest(&asked, known.map(|code| code.code))
}
