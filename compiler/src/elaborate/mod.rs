//! From checked definitions to a flat system: instances, paths, numbers, and a graph for every element.
//!
//! Elaboration evaluates the text once for one model with its structural arguments. It relies on the checker
//! for types. If a type is still wrong, it gives an internal error and never a default.

mod analysis;
mod axes;
mod binding;
mod body;
mod builtin;
mod constants;
mod csv;
mod element;
mod expression;
mod finish;
mod flexible;
mod grid;
mod model;
mod output;
mod reference;
mod repeat;
mod scalar;
mod slope;
mod table;
mod topology;
mod transmit;
mod typed;
mod value;

pub use analysis::{AnalysisPlan, analyses};
pub use binding::{BindProgram, Check, MessagePart, ParameterDefault};
pub(crate) use constants::Constants;
pub use finish::{Elaborated, Structural, elaborate};
pub use flexible::{MarkerName, ModePart};

use crate::codes;
use crate::program::{DefinitionId, Program};
use crate::typed::types::Solution;
use crate::typed::{Findings, TypedProgram};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap, Span, ast};
use eng_system::host::Host;
use eng_system::system::{Location, Origin};
use scalar::Workbench;
use std::collections::HashMap;
use std::rc::Rc;
use value::{ScopeId, Value};

/// An error has been reported, and the value does not exist.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reported;

pub(crate) type Eval<T> = Result<T, Reported>;

/// Most instances of one model. A text with more is refused.
const MOST_INSTANCES: usize = 20_000;
/// Deepest nesting of calls, lets and parts.
const DEEPEST: u32 = 100;
/// Most calls and named values that are evaluated for one model. Elaboration inserts a function at each call,
/// so thirty functions that each call the next one twice would be inserted a billion times.
const MOST_USES: usize = 1_000_000;

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
    /// A `param` of a model or component. It becomes a parameter.
    Parameter(&'a ast::Binding),
    /// A default of a class parameter.
    Default(&'a ast::Parameter),
    /// A table.
    Table(&'a ast::Table),
    /// `part x = Component(…)`.
    Part(&'a ast::Declaration),
    /// `body x { … }`.
    Body(&'a ast::Declaration),
    /// `marker x = …` in a model or component.
    Marker(&'a ast::Declaration),
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

/// A finished element, before elements share classes.
#[derive(Debug)]
pub(crate) struct ElementDraft<'a> {
    pub origin: Origin,
    pub span: Span,
    pub role: eng_system::system::Role,
    /// The definition and arguments, to evaluate its names again in another element.
    pub source: Option<ElementSource<'a>>,
    /// Outputs: name, first scalar, shape.
    pub outputs: Vec<OutputShape>,
    /// First channel of its outputs.
    pub first_channel: u32,
    pub class_name: String,
    pub body: crate::ir::ClassBody,
    pub meta: ClassMeta,
    pub markers: Vec<u32>,
    pub constants: Vec<crate::ir::Node>,
    pub state_start: Vec<crate::ir::Node>,
    pub state_scale: Vec<crate::ir::Node>,
    pub signals: Vec<u32>,
    /// Pairs of local markers, and the bind node of a stated angle.
    pub rotations: Vec<(u32, u32, Option<crate::ir::Node>)>,
    /// The local markers of each `apply`: on, against.
    pub applied: Vec<(u32, Option<u32>)>,
}

/// The facts of a class besides its graph.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ClassMeta {
    pub rows: Vec<eng_system::system::Row>,
    pub states: Vec<eng_system::system::StateInfo>,
    pub outputs: Vec<eng_system::system::OutputInfo>,
    pub conditions: Vec<eng_system::system::Condition>,
}

/// The data to evaluate an element's names once more.
#[derive(Clone, Debug)]
pub(crate) struct ElementSource<'a> {
    pub definition: DefinitionId,
    /// Evaluated arguments; those of the motion stage are evaluated again.
    pub arguments: Vec<(String, Argument<'a>)>,
}

#[derive(Clone, Debug)]
pub(crate) enum Argument<'a> {
    Value(Value<'a>),
    /// A value of the motion, evaluated again in its scope for each element.
    Again(&'a ast::Expr, ScopeId),
}

/// An output's scalars.
#[derive(Clone, Debug)]
pub(crate) struct OutputShape {
    pub name: String,
    pub first: u32,
    /// 1 for a scalar, else the number of components.
    pub count: u32,
    /// The axes of the components, if the text states them.
    pub axes: Option<value::Axes>,
    /// A vector in space rather than components.
    pub vector: bool,
}

/// The state of elaboration of one model.
pub(crate) struct Elaborator<'a, 'd> {
    pub program: &'a Program,
    pub typed: &'a TypedProgram,
    /// Findings on expressions that were checked after the program, which are those of reports.
    pub later: Findings,
    pub sources: &'a mut SourceMap,
    pub host: &'a dyn Host,
    pub diagnostics: &'d mut Diagnostics,
    pub bench: Workbench,
    pub scopes: Vec<Scope<'a>>,
    pub module_scopes: Vec<ScopeId>,
    pub depth: u32,
    pub instances: usize,
    /// Number of calls and named values evaluated so far.
    pub uses: usize,
    /// Conditions under which the current expression counts: those of the surrounding `if`s whose value is
    /// not known yet. Each comes with the number of scopes at that moment, because a name of an older scope
    /// also counts elsewhere.
    pub guards: Vec<(scalar::Flag, usize)>,

    pub bodies: Vec<eng_system::system::Body>,
    pub body_scopes: Vec<ScopeId>,
    pub flexible: Vec<Option<flexible::FlexibleDraft>>,
    pub markers: Vec<eng_system::system::Marker>,
    pub used_markers: Vec<bool>,
    pub parameters: Vec<eng_system::system::Parameter>,
    pub parameter_defaults: Vec<crate::ir::Node>,
    pub checks: Vec<Check>,
    pub tables: Vec<eng_system::table::Table>,
    pub elements: Vec<ElementDraft<'a>>,
    pub channels: Vec<eng_system::system::Channel>,
    pub journals: Vec<eng_system::system::JournalInfo>,
    pub firings: Vec<eng_system::system::FiringInfo>,
    /// Lengths that positions must resolve.
    pub resolutions: Vec<eng_system::system::Slot>,
    pub accepted: Vec<eng_system::lint::Accepted>,
    /// Failed `advise`s on values known while compiling, with the paths of their subjects.
    pub advised: Vec<(Diagnostic, Vec<String>)>,
    /// Names of all lints.
    pub lints: std::collections::BTreeSet<&'a str>,
    /// Places of stated attributes, by path. If an argument of a class is the name of a constant, it is the
    /// place of this constant.
    pub stated: std::collections::BTreeMap<String, Location>,
    /// Calls of `sin` and similar functions that already have a message about a missing angle.
    pub turns_told: std::collections::HashSet<Span>,
    /// Unknowns of derivatives that are being taken, one inside the other.
    pub unknowns: u32,
    /// Places of the `let`s and `const`s of models and components, by scope and name.
    pub named: HashMap<(usize, String), Location>,
    pub gravity: Option<[crate::ir::Node; 3]>,
    pub cycle: Option<CycleDraft<'a>>,
    pub pending: Vec<model::Pending<'a>>,
    /// Inside an output: accelerations are allowed, and an element's output means its channel.
    pub in_output: bool,
    /// Inside `der(…)`: element outputs are evaluated, not read.
    pub in_rate: bool,
    /// The text that asks for an element's output where no element is lowered, and the output's path.
    pub asked_from: Option<(Span, String)>,
    /// Inside the block of a component, whose markers are the choice of its author.
    pub in_part: bool,
    /// Rates of the states of the element being lowered, when known.
    pub rates: Option<Vec<crate::ir::Node>>,
}

#[derive(Clone, Debug)]
pub(crate) struct CycleDraft<'a> {
    pub declaration: &'a ast::Declaration,
    pub scope: ScopeId,
    pub period: crate::ir::Node,
}

impl<'a> Elaborator<'a, '_> {
    pub fn report(&mut self, mut diagnostic: Diagnostic) -> Reported {
        if let (codes::MOTION, Some((span, output))) = (diagnostic.code, &self.asked_from) {
            diagnostic.moved_to(*span, format!("`{output}` moves"));
        }
        self.diagnostics.push(diagnostic);
        Reported
    }

    /// Notes the lints that a block accepts for the object of a path.
    pub fn accepted_in(&mut self, items: &'a [ast::Item], path: &str) {
        for item in items {
            let ast::ItemKind::Statement(ast::Statement::Accept(names)) = &item.kind else {
                continue;
            };
            for name in names {
                self.accepted.push(eng_system::lint::Accepted {
                    name: name.text.clone(),
                    path: path.to_owned(),
                    at: location(name.span),
                    // the checker reports a name that is not a lint's
                    used: !self.lints.contains(name.text.as_str()),
                });
            }
        }
    }

    /// Whether the text accepts a lint about the object of a path. Marks the accepting items as used.
    pub fn accepts(&mut self, name: &str, path: &str) -> bool {
        let mut found = false;
        for accepted in &mut self.accepted {
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
        self.instances += 1;
        if self.instances > MOST_INSTANCES {
            return Err(self.report(
                Diagnostic::error(
                    codes::TOO_MANY_INSTANCES,
                    format!("the model has more than {MOST_INSTANCES} instances"),
                )
                .at(span, "the limit is reached here")
                .with_help("bodies, elements, parts and values of binders count; is a range longer than was meant?"),
            ));
        }
        Ok(())
    }

    pub fn deeper<T>(&mut self, span: Span, f: impl FnOnce(&mut Self) -> Eval<T>) -> Eval<T> {
        if self.depth >= DEEPEST {
            return Err(self.report(
                Diagnostic::error(
                    codes::ENDLESS,
                    format!("more than {DEEPEST} uses are nested in each other"),
                )
                .at(span, "the limit is reached here")
                .with_help("does a function or a component use itself?"),
            ));
        }
        self.uses += 1;
        // the branch below reported it when the limit was passed
        if self.uses > MOST_USES + 1 {
            return Err(Reported);
        }
        if self.uses > MOST_USES {
            return Err(self.report(
                Diagnostic::error(
                    codes::TOO_MANY_USES,
                    format!("functions and values of this model are put in more than {MOST_USES} times"),
                )
                .at(span, "the limit is reached here")
                .with_help("where a function calls another one twice, give its value a name with `let` and use that twice"),
            ));
        }
        self.depth += 1;
        let result = f(self);
        self.depth -= 1;
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
