//! Common parts of the tests of the checker: a host over texts, a run, a plain renderer.

use eng_compiler::check::{check, reports};
use eng_compiler::elaborate::{analyses, elaborate};
use eng_compiler::library::LIBRARY;
use eng_compiler::models::SharedModels;
use eng_compiler::program::{DefinitionId, Program};
use eng_compiler::resolve::resolve;
use eng_compiler::typed::TypedProgram;
use eng_grammar::ast::{ItemKind, Kind};
use eng_grammar::{Diagnostic, Diagnostics, Severity, SourceMap, Span};
use eng_system::host::{Host, HostError};
use std::path::PathBuf;

/// The root's text, and the files of a folder beside it.
pub struct Folder {
    pub root: String,
    pub text: String,
    pub folder: PathBuf,
}

impl Host for Folder {
    fn read_text(&self, path: &str) -> Result<String, HostError> {
        if path == self.root {
            return Ok(self.text.clone());
        }
        std::fs::read_to_string(self.folder.join(path))
            .map_err(|_| HostError::NotFound(path.to_owned()))
    }
}

/// All results of a run.
#[allow(dead_code)]
pub struct Run {
    pub sources: SourceMap,
    pub typed: TypedProgram,
    pub diagnostics: Diagnostics,
}

pub fn run_in(folder: &str, root: &str, text: &str) -> Run {
    run_stages(folder, root, text, false)
}

/// The same run. Without an error it also elaborates the analyses and every model of the root.
#[allow(dead_code)]
pub fn elaborated_in(folder: &str, root: &str, text: &str) -> Run {
    run_stages(folder, root, text, true)
}

fn run_stages(folder: &str, root: &str, text: &str, elaborated: bool) -> Run {
    let host = Folder {
        root: root.to_owned(),
        text: text.to_owned(),
        folder: PathBuf::from(folder),
    };
    let mut sources = SourceMap::new();
    let mut diagnostics = Diagnostics::new();
    let program = resolve(root, &host, LIBRARY, &mut sources, &mut diagnostics);
    let typed = check(program, &sources, &mut diagnostics);
    if elaborated && !diagnostics.has_errors() {
        let plans = analyses(&typed, &mut sources, &host, &mut diagnostics);
        for model in models(&typed.program) {
            elaborate(&typed, &mut sources, &host, model, &[], &mut diagnostics);
        }
        if !diagnostics.has_errors() {
            let models = SharedModels::default();
            models.names(&typed, &mut sources, &host, &plans, &mut diagnostics);
            reports(&typed, &sources, &host, &plans, &models, &mut diagnostics);
        }
    }
    Run {
        sources,
        typed,
        diagnostics,
    }
}

fn models(program: &Program) -> Vec<DefinitionId> {
    let module = program.root();
    let Some(root) = program.modules.get(module as usize) else {
        return Vec::new();
    };
    let items = root.file.items.iter().enumerate();
    items
        .filter(|(_, item)| matches!(&item.kind, ItemKind::Declaration(d) if d.kind == Kind::Model))
        .map(|(item, _)| DefinitionId {
            module,
            item: item as u32,
        })
        .collect()
}

#[allow(dead_code)]
pub fn run(text: &str) -> Run {
    run_in("no such folder", "test.eng", text)
}

/// All messages as plain text.
pub fn render(run: &Run) -> String {
    let texts: Vec<String> = run
        .diagnostics
        .iter()
        .map(|diagnostic| render_one(&run.sources, diagnostic))
        .collect();
    texts.join("\n")
}

fn place(sources: &SourceMap, span: Span) -> String {
    let name = sources
        .get(span.source)
        .map_or("?", |source| source.name.as_str());
    match sources.line_column(span.source, span.start) {
        Some((line, column)) => format!("{name}:{line}:{column}"),
        None => name.to_owned(),
    }
}

fn quoted(sources: &SourceMap, span: Span) -> String {
    let Some(source) = sources.get(span.source) else {
        return String::new();
    };
    let start = (span.start as usize).min(source.text.len());
    let first = source.text[..start].rfind('\n').map_or(0, |at| at + 1);
    let last = source.text[start..]
        .find('\n')
        .map_or(source.text.len(), |at| start + at);
    let end = (span.end as usize).clamp(start, last);
    let before = source.text[first..start].chars().count();
    let marked = source.text[start..end].chars().count().max(1);
    format!(
        "    | {}\n    | {}{}",
        &source.text[first..last],
        " ".repeat(before),
        "^".repeat(marked)
    )
}

fn render_one(sources: &SourceMap, diagnostic: &Diagnostic) -> String {
    let severity = match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let at = diagnostic.labels.first().map_or(String::new(), |label| {
        format!("{}: ", place(sources, label.span))
    });
    let mut text = format!("{at}{severity}[{}] {}\n", diagnostic.code, diagnostic.title);
    for label in &diagnostic.labels {
        let arrow = if label.primary { "-->" } else { "..." };
        text.push_str(&format!(
            "  {arrow} {}\n{} {}\n",
            place(sources, label.span),
            quoted(sources, label.span),
            label.message
        ));
    }
    for note in &diagnostic.notes {
        text.push_str(&format!("  note: {note}\n"));
    }
    for help in &diagnostic.help {
        text.push_str(&format!("  help: {help}\n"));
    }
    for fix in &diagnostic.fixes {
        text.push_str(&format!(
            "  fix: {}: {} `{}` -> `{}`\n",
            fix.title,
            place(sources, fix.span),
            sources.text(fix.span),
            fix.replacement
        ));
    }
    text
}
