//! Checks names, dimensions and uses.
//!
//! Each definition is checked once, at its own place, for all its uses. Then the arguments of each use are
//! checked against the parameters.
//!
//! The checker works with types. It must not use values, lengths of arrays that depend on parameters, or
//! instances.
//!
//! An expression in error has `types::Type::Error` and causes no further message.

mod analysis;
mod body;
mod bound;
mod builtin;
mod call;
mod change;
mod choice;
mod class;
mod declare;
mod describe;
mod expression;
mod field;
mod flexible;
mod function;
mod input;
mod interface;
mod kernel;
mod level;
mod lint;
mod member;
mod mismatch;
mod names;
mod once;
mod operator;
mod partial;
mod report;
mod scope;
mod signal;
mod slope;
mod state;
mod statement;
mod summary;
mod table;
mod unit;
mod unused;

pub use report::reports;

use crate::codes;
use crate::program::{DefinitionId, Program};
use crate::typed::{Findings, TypedProgram, types};
use eng_grammar::ast::{BindingKind, Expr, Form, Item, ItemKind, Kind};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap, Span};
use eng_system::Dimension;
use member::{ClassTable, Member};
use scope::Scope;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use std::sync::Arc;
use types::{Signature, Type};

/// Most values and functions that build on each other. Elaboration and the stack have room for this depth. A
/// choice: texts have some ten.
const DEEPEST_VALUES: u32 = 100;

/// The progress of the inference of a named value.
#[derive(Clone)]
enum Progress<T> {
    Open,
    Done(T),
}

/// The state of one run.
struct Checker<'p> {
    program: &'p Program,
    sources: &'p SourceMap,
    diagnostics: Diagnostics,
    tables: BTreeMap<DefinitionId, Rc<ClassTable<'p>>>,
    /// Types of members by definition and name; a top-level binding has the empty name.
    values: BTreeMap<(DefinitionId, String), Progress<Type>>,
    signatures: BTreeMap<Span, Progress<Arc<Signature>>>,
    /// Names of dimension variables, by number.
    variables: Vec<String>,
    /// Members that an expression reads, by definition and name.
    used: BTreeSet<(DefinitionId, String)>,
    /// Names of parameters and indices that the current definition reads.
    read_locals: BTreeSet<String>,
    /// Top-level names that each module reads.
    used_top: BTreeSet<(u32, DefinitionId)>,
    /// The dimension that the context of a literal needs.
    wanted: Option<Dimension>,
    /// Whether the context of a call needs a class, so that the call may give it some of its arguments.
    class_due: bool,
    /// Whether the context of a call needs a function, so that the call may give it some of its arguments.
    function_due: bool,
    /// The last name of the target of a `start` or `guess`, while the target is read.
    start_of: Option<Span>,
    /// The choice whose words need no name of the choice before them here.
    choice_due: Option<DefinitionId>,
    /// The component or class that has the number, while a value after `with` is read.
    changed: Option<DefinitionId>,
    /// Values and functions being inferred.
    depth: u32,
    /// Units that each module reads.
    used_units: BTreeSet<(u32, String)>,
    /// Names of lints that a text may accept.
    lints: BTreeSet<&'p str>,
    /// Places of angles with a finished check for turns, so that each gets one message.
    turns_reported: BTreeSet<Span>,
    /// Conditions of analyses that end their runs, with the scope of their names. Their levels are checked with those of models.
    stops: Vec<(scope::Scope<'p>, Expr)>,
    /// The findings for later stages.
    findings: Findings,
}

/// Checks every definition of every module.
pub fn check(program: Program, sources: &SourceMap, diagnostics: &mut Diagnostics) -> TypedProgram {
    let findings = found(&program, sources, diagnostics);
    TypedProgram { program, findings }
}

fn found(program: &Program, sources: &SourceMap, diagnostics: &mut Diagnostics) -> Findings {
    let earlier = diagnostics.has_errors();
    let mut checker = Checker::new(program, sources);
    checker.names_of_lints();
    checker.values_named_like_units();
    for (index, module) in program.modules.iter().enumerate() {
        for (item_index, item) in module.file.items.iter().enumerate() {
            let id = DefinitionId {
                module: index as u32,
                item: item_index as u32,
            };
            checker.item(id, item);
        }
    }
    if !checker.diagnostics.has_errors() {
        level::check(&mut checker);
    }
    if !earlier && !checker.diagnostics.has_errors() {
        unused::warn(&mut checker);
    }
    checker.name_types();
    diagnostics.extend(in_order_of_place(&checker.diagnostics));
    checker.findings
}

/// Messages in the order of their places in the texts.
fn in_order_of_place(diagnostics: &Diagnostics) -> Diagnostics {
    let mut all: Vec<&Diagnostic> = diagnostics.iter().collect();
    all.sort_by_key(|diagnostic| {
        diagnostic
            .labels
            .iter()
            .find(|label| label.primary)
            .map(|label| (label.span.source, label.span.start))
    });
    let mut ordered = Diagnostics::new();
    for diagnostic in all {
        ordered.push(diagnostic.clone());
    }
    ordered
}

impl<'p> Checker<'p> {
    fn new(program: &'p Program, sources: &'p SourceMap) -> Checker<'p> {
        Checker {
            program,
            sources,
            diagnostics: Diagnostics::new(),
            tables: BTreeMap::new(),
            values: BTreeMap::new(),
            signatures: BTreeMap::new(),
            variables: Vec::new(),
            used: BTreeSet::new(),
            read_locals: BTreeSet::new(),
            used_top: BTreeSet::new(),
            used_units: BTreeSet::new(),
            wanted: None,
            class_due: false,
            function_due: false,
            start_of: None,
            choice_due: None,
            changed: None,
            depth: 0,
            lints: program.lints(),
            turns_reported: BTreeSet::new(),
            stops: Vec::new(),
            findings: Findings::default(),
        }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Whether the depth limit allows one more value inside those being inferred. If not, it gives an error
    /// at `span`.
    fn deeper(&mut self, span: Span) -> bool {
        if self.depth < DEEPEST_VALUES {
            return true;
        }
        self.report(
            Diagnostic::error(
                codes::TOO_DEEP,
                format!("more than {DEEPEST_VALUES} values build on each other"),
            )
            .at(span, "here it is too deep")
            .with_help("shorten the chain"),
        );
        false
    }

    /// One item at the top of a file.
    fn item(&mut self, id: DefinitionId, item: &'p Item) {
        let scope = Scope::top(id.module);
        match &item.kind {
            ItemKind::Use(_) | ItemKind::Dimension(_) | ItemKind::Unit(_) | ItemKind::Error => {}
            ItemKind::Choice(choice) => self.choice_definition(choice),
            ItemKind::Binding(binding) => {
                if matches!(
                    binding.kind,
                    BindingKind::Const | BindingKind::Let | BindingKind::Param
                ) {
                    self.top_value(id);
                } else {
                    self.misplaced(
                        binding.name.span,
                        "a state, an input or an output",
                        "at the top of a file",
                        "it belongs in a class or a model",
                    );
                }
            }
            ItemKind::Function(function) => {
                self.function(&scope, function);
            }
            ItemKind::Table(table) => {
                self.table(&scope, table);
            }
            ItemKind::Statement(_) => self.misplaced(
                item.span,
                "this statement",
                "at the top of a file",
                "it belongs in a class or a model",
            ),
            ItemKind::Attribute(attribute) => self.misplaced(
                attribute.name.span,
                "an attribute",
                "at the top of a file",
                "a value that all may use is a `const`",
            ),
            // its expressions are checked against the channels of its analyses, after elaboration: see
            // `report`
            ItemKind::Report(report) => self.names_of_report(id.module, report),
            ItemKind::Entry(entry) => self.misplaced(
                entry.word.to(entry.name.span),
                "a figure or value of results",
                "at the top of a file",
                "it belongs in a block: `report name { … }`",
            ),
            ItemKind::Declaration(declaration) => match (&declaration.form, declaration.kind) {
                (_, Kind::Default) => self.not_built(declaration.kind_span, "`default` blocks"),
                (_, Kind::Analysis) => self.analysis(&scope, declaration),
                (Form::Class { .. }, _)
                | (Form::Plain { .. }, Kind::Model | Kind::Interface | Kind::Record) => {
                    self.definition(id, declaration);
                }
                (Form::Instance { .. }, kind) if class::is_of_elements(kind) => {
                    self.bound_definition(id, declaration);
                }
                (Form::Plain { .. }, kind) if class::is_of_elements(kind) => {
                    let word = describe::kind_word(kind);
                    let name = &declaration.name;
                    self.report(
                        Diagnostic::error(
                            codes::MISPLACED,
                            format!("the {word} `{}` has no list of parameters", name.text),
                        )
                        .at(name.span, "a class has one")
                        .with_help(format!(
                            "write `{word} {}(a: Marker, b: Marker) {{ … }}`; an element of a class belongs in a model or a component",
                            name.text
                        )),
                    );
                }
                _ => self.misplaced(
                    declaration.kind_span,
                    &format!("a {}", describe::kind_word(declaration.kind)),
                    "at the top of a file",
                    "put it into a model or a component",
                ),
            },
        }
    }

    /// Writes the types of the named values of all definitions into the findings.
    fn name_types(&mut self) {
        let named = &mut self.findings.named;
        for (id, table) in &self.tables {
            for (name, owned) in &table.members {
                if !matches!(owned.member, Member::Parameter(_) | Member::Binding(_)) {
                    continue;
                }
                let at_home = (owned.home, (*name).to_owned());
                if let Some(Progress::Done(ty)) = self.values.get(&at_home) {
                    named.insert((*id, at_home.1), ty.exported());
                }
            }
        }
        for (key, progress) in &self.values {
            if let (true, Progress::Done(ty)) = (key.1.is_empty(), progress) {
                named.insert(key.clone(), ty.exported());
            }
        }
    }
}
