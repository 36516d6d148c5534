//! From checked definitions to a flat system: instances, paths, numbers, and a graph for every element.
//!
//! Elaboration evaluates the text once for one model with its structural arguments. It relies on the checker
//! for types. If a type is still wrong, it gives an internal error and never a default.

mod analysis;
mod axes;
mod bind_program;
mod binding;
mod body;
mod budget;
mod builtin;
mod change;
mod constants;
mod csv;
mod draft;
mod element;
mod expression;
mod finish;
mod flexible;
mod grid;
mod input;
mod lengths;
mod marker;
mod marker_loads;
mod model;
mod names;
mod output;
mod partial;
mod pending;
mod rates;
mod reference;
mod repeat;
mod requirement;
mod scalar;
mod slope;
mod solve;
mod table;
mod topology;
mod turn;
mod typed;
mod value;

pub use analysis::{AnalysisPlan, analyses};
pub use bind_program::{BindProgram, Check, MessagePart, ParameterDefault};
pub(crate) use constants::Constants;
pub(crate) use draft::{
    Argument, ClassMeta, CycleDraft, Draft, ElementDraft, ElementSource, OutputShape,
};
pub use finish::{Elaborated, Structural, elaborate};
pub use flexible::{MarkerName, ModePart};
pub use marker_loads::without_static_mode;
pub(crate) use names::check_names;

use crate::codes;
use crate::program::Program;
use crate::typed::lineage::ClassParameter;
use crate::typed::types::Solution;
use crate::typed::{Findings, TypedProgram};
use budget::Budget;
use eng_grammar::{Diagnostic, Diagnostics, SourceMap, Span, ast};
use eng_system::host::Host;
use eng_system::system::{BodyRef, Location};
use scalar::GraphBuilder;
use std::collections::HashMap;
use std::rc::Rc;
use value::{ScopeId, Value};

/// An error has been reported, and the value does not exist.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reported;

pub(crate) type Eval<T> = Result<T, Reported>;

/// Messages about values that an item or call gives to a text. Each also shows this item or call.
const OF_VALUES: [&str; 6] = [
    codes::LENGTHS,
    codes::LIST_LENGTH,
    codes::INDEX_OUTSIDE,
    codes::EMPTY_LIST,
    codes::NOT_IN_LIST,
    codes::DIVISION_BY_ZERO,
];

/// The meaning of a name in a scope.
#[derive(Clone, Debug)]
pub(crate) enum Entry<'a> {
    Value(Value<'a>),
    /// Evaluated at its first use.
    Lazy(Lazy<'a>),
    /// The entry of the same name in another scope.
    In(ScopeId),
    /// Its evaluation is in progress, so another use is a circle.
    Busy,
    /// An error has been reported.
    Failed,
}

/// An item that is evaluated at its first use.
#[derive(Clone, Debug)]
pub(crate) enum Lazy<'a> {
    /// A `let`, `const`, or the value of an output.
    Binding(&'a ast::Binding),
    /// A `param` or `input` of a model or component. It becomes a parameter.
    Parameter(&'a ast::Binding),
    /// A default of a parameter of a function.
    Default(&'a ast::Parameter),
    /// A default of a parameter of a class. It becomes a parameter.
    DefaultOf(ClassParameter<'a>),
    /// `fn burn = wiebe(shape: 2)`: its value is the function.
    BoundFunction(&'a ast::Function),
    /// The length of an array, which its default decides.
    LengthOf(ClassParameter<'a>),
    /// A table.
    Table(&'a ast::Table),
    /// `part x = Component(…)`.
    Part(&'a ast::Declaration),
    /// `body x { … }`.
    Body(&'a ast::Declaration),
    /// `marker x = …` on the ground or in a body.
    Marker(&'a ast::Declaration, BodyRef),
    /// `joint x = Class(…)` and its like.
    Element(&'a ast::Declaration),
}

/// Names of a block, a call or a module.
#[derive(Debug)]
pub(crate) struct Scope<'a> {
    pub parent: Option<ScopeId>,
    pub module: u32,
    pub path: String,
    /// The scope outlives the current element, so it keeps no values of the motion.
    pub lasting: bool,
    /// In the body of a generic function: the dimensions of its variables.
    pub solution: Option<Rc<Solution>>,
    pub entries: HashMap<String, Entry<'a>>,
}

/// The surroundings of the expression that is being evaluated. They decide its meaning.
#[derive(Default)]
pub(crate) struct Context {
    /// Conditions under which the current expression counts: those of the surrounding `if`s whose value is
    /// not known yet. Each comes with the number of scopes at that moment, because a name of an older scope
    /// also counts elsewhere.
    pub guards: Vec<(scalar::Flag, usize)>,
    /// The items and calls whose texts are being evaluated, the outermost first, each with the number of scopes
    /// at that moment: a name of an older scope does not belong to them.
    pub uses: Vec<(Span, usize)>,
    /// The names whose values are being evaluated, the outermost first, each with its scope and the place that reads it.
    pub open: Vec<(ScopeId, String, Span)>,
    /// Unknowns of derivatives that are being taken, one inside the other.
    pub unknowns: u32,
    /// Inside an output: accelerations are allowed, and an element's output means its channel.
    pub in_output: bool,
    /// Inside `der(…)`: element outputs are evaluated, not read.
    pub in_rate: bool,
    /// In a start value of a model or component.
    pub in_start: bool,
    /// Inside the block of a component, whose markers are the choice of its author.
    pub in_part: bool,
    /// The text that reads an element's output where no element is lowered, and the output's path.
    pub asked_from: Option<(Span, String)>,
    /// Rates of the states of the element being lowered, when known.
    pub rates: Option<Vec<crate::ir::Node>>,
}

/// The state of elaboration of one model: its inputs, the surroundings of the present expression, and the
/// model as far as it exists.
pub(crate) struct Elaborator<'a, 'd> {
    pub program: &'a Program,
    pub typed: &'a TypedProgram,
    /// Findings on expressions that were checked after the program, which are those of reports.
    pub later: Findings,
    pub sources: &'a mut SourceMap,
    pub host: &'a dyn Host,
    pub diagnostics: &'d mut Diagnostics,
    pub graphs: GraphBuilder,
    pub scopes: Vec<Scope<'a>>,
    pub module_scopes: Vec<ScopeId>,
    budget: Budget,
    pub context: Context,
    pub draft: Draft<'a>,
    /// Names of all lints.
    pub lints: std::collections::BTreeSet<&'a str>,
    /// Calls of `sin` and similar functions that already have a message about a missing angle.
    pub turns_reported: std::collections::HashSet<Span>,
}

impl<'a> Elaborator<'a, '_> {
    pub fn report(&mut self, mut diagnostic: Diagnostic) -> Reported {
        if let (codes::MOTION, Some((span, output))) = (diagnostic.code, &self.context.asked_from) {
            diagnostic = diagnostic.moved_to(*span, format!("`{output}` moves"));
        }
        if OF_VALUES.contains(&diagnostic.code) {
            diagnostic = self.with_use(diagnostic);
        }
        self.diagnostics.push(diagnostic);
        Reported
    }

    /// A message with the item or call that gives a text its values.
    pub fn with_use(&self, diagnostic: Diagnostic) -> Diagnostic {
        match self.context.uses.last() {
            Some((place, _)) if diagnostic.labels.iter().all(|label| label.span != *place) => {
                diagnostic.also(*place, "used here")
            }
            _ => diagnostic,
        }
    }

    /// Notes the lints that a block accepts for the object of a path.
    pub fn accepted_in(&mut self, items: &'a [ast::Item], path: &str) {
        for item in items {
            let ast::ItemKind::Statement(ast::Statement::Accept(names)) = &item.kind else {
                continue;
            };
            for name in names {
                self.draft.accepted.push(eng_system::lint::Accepted {
                    name: name.text.clone(),
                    path: path.to_owned(),
                    at: location(name.span),
                    // a name of no lint has a message of the checker; the findings have the acceptances that suppressed a
                    // message of it
                    used: !self.lints.contains(name.text.as_str())
                        || self.typed.findings.accepted.contains(&name.span),
                });
            }
        }
    }

    /// Whether the text accepts a lint about the object of a path. Marks the accepting items as used.
    pub fn accepts(&mut self, name: &str, path: &str) -> bool {
        let mut found = false;
        for accepted in &mut self.draft.accepted {
            if accepted.covers(name, path) {
                accepted.used = true;
                found = true;
            }
        }
        found
    }

    pub fn scope(&self, id: ScopeId) -> &Scope<'a> {
        &self.scopes[id.0 as usize]
    }

    pub fn new_scope(&mut self, parent: Option<ScopeId>, module: u32, path: String) -> ScopeId {
        self.scopes.push(Scope {
            parent,
            module,
            path,
            lasting: false,
            solution: None,
            entries: HashMap::new(),
        });
        ScopeId(self.scopes.len() as u32 - 1)
    }

    pub fn define(&mut self, scope: ScopeId, name: &str, entry: Entry<'a>) {
        self.scopes[scope.0 as usize]
            .entries
            .insert(name.to_owned(), entry);
    }

    pub fn lasting(&mut self, scope: ScopeId) {
        self.scopes[scope.0 as usize].lasting = true;
    }

    pub fn path(&self, scope: ScopeId, name: &str) -> String {
        let prefix = &self.scope(scope).path;
        if prefix.is_empty() {
            name.to_owned()
        } else {
            format!("{prefix}.{name}")
        }
    }

    pub fn count_instance(&mut self, span: Span) -> Eval<()> {
        let within = self.budget.instance();
        within.map_err(|message| self.report(message.at(span, "the limit is reached here")))
    }

    /// Evaluates a text for an item or a call.
    pub fn used_at<T>(&mut self, place: Span, f: impl FnOnce(&mut Self) -> T) -> T {
        self.context.uses.push((place, self.scopes.len()));
        let result = f(self);
        self.context.uses.pop();
        result
    }

    pub fn deeper<T>(&mut self, span: Span, f: impl FnOnce(&mut Self) -> Eval<T>) -> Eval<T> {
        if let Err(exceeded) = self.budget.enter() {
            return Err(match exceeded {
                Some(message) => self.report(message.at(span, "the limit is reached here")),
                None => Reported,
            });
        }
        let result = f(self);
        self.budget.leave();
        result
    }
}

pub(crate) fn location(span: Span) -> Location {
    Location {
        source: span.source.0,
        start: span.start,
        end: span.end,
    }
}
