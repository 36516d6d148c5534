//! The elaboration of one model from start to end, and the resulting flat system.

use super::pending::Pending;
use super::scalar::GraphBuilder;
use super::value::{ScopeId, Value};
use super::{BindProgram, ClassMeta, Elaborator, Entry, Eval, Reported};
use crate::codes;
use crate::ir::depth::depth;
use crate::ir::{ClassBody, ClassFunctions, Function, Node};
use crate::program::DefinitionId;
use crate::typed::{Findings, TypedProgram};
use eng_grammar::ast::{Form, ItemKind, Kind};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap};
use eng_system::flexible::FlexibleSource;
use eng_system::host::Host;
use eng_system::system::{
    Element, ElementClass, Kink, OutputInfo, Placing, Role, Rotation, System,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A model as a flat system, the functions of its classes, and its bind graph.
#[derive(Clone, Debug)]
pub struct Elaborated {
    /// The system.
    pub system: Arc<System>,
    /// Functions of each class, by the same index.
    pub classes: Vec<ClassFunctions>,
    /// The bodies from which the functions were derived, by the same index.
    pub bodies: Vec<ClassBody>,
    /// The bind graph.
    pub bind: Arc<BindProgram>,
    /// Sources of flexible bodies, by the index in the bodies.
    pub flexible: Vec<FlexibleSource>,
}

/// Elements with their classes; functions and bodies by the index of the class.
#[derive(Default)]
struct Shared {
    classes: Vec<ElementClass>,
    functions: Vec<ClassFunctions>,
    bodies: Vec<ClassBody>,
    elements: Vec<Element>,
}

/// The kinks of a class, with the texts that are known.
fn kinks_of(functions: &ClassFunctions, meta: &ClassMeta) -> Vec<Kink> {
    let of_motion = (functions.kink_places.iter())
        .map(|place| meta.kinks.get(place).cloned().unwrap_or_default());
    of_motion
        .chain(meta.bound_kinks.iter().cloned())
        .zip(&functions.kinds_of_kinks)
        .map(|(kink, kind)| Kink {
            table: kind.table,
            constrains: kind.constrains,
            wraps: kind.wraps,
            cut: kind.cut,
            course: kind.course,
            ..kink
        })
        .collect()
}

/// The outputs of a class with their depths.
fn outputs_of(meta: &ClassMeta, body: &ClassBody) -> Vec<OutputInfo> {
    let nodes = body.outputs.iter();
    let known = |(info, node): (&OutputInfo, &Node)| OutputInfo {
        depth: depth(&body.graph, *node, &body.layout),
        ..info.clone()
    };
    meta.outputs.iter().zip(nodes).map(known).collect()
}

/// A structural argument of a model.
#[derive(Clone, Debug, PartialEq)]
pub enum Structural {
    /// A whole number.
    Int(i64),
    /// A truth value.
    Bool(bool),
    /// A text.
    Text(String),
    /// A word of a choice, by its place among the words.
    Choice(DefinitionId, u32),
    /// A number (SI).
    Number(f64),
    /// A list.
    List(Vec<Structural>),
    /// Modes of a flexible body.
    ModeSet(Vec<super::ModePart>),
    /// A class.
    Class(DefinitionId),
    /// A function or table of time that gives the values of an input.
    Signal(DefinitionId),
    /// A record with its fields.
    Record(DefinitionId, Vec<(String, Structural)>),
    /// The condition that ends the runs of an analysis: its item in the root module, and the values of its indices.
    Stop {
        /// The item.
        item: u32,
        /// The indices by name.
        indices: Vec<(String, Structural)>,
    },
}

/// Elaborates a model. `None` after an error.
pub fn elaborate(
    typed: &TypedProgram,
    sources: &mut SourceMap,
    host: &dyn Host,
    model: DefinitionId,
    constants: &[(String, Structural)],
    diagnostics: &mut Diagnostics,
) -> Option<Elaborated> {
    let mut found = Diagnostics::new();
    let mut elaborator = Elaborator::new(typed, sources, host, &mut found);
    let result = elaborator.model(model, constants);
    elaborator.report_advised();
    let failed = found.has_errors();
    diagnostics.extend(found);
    match result {
        Ok(elaborated) if !failed => Some(elaborated),
        _ => None,
    }
}

impl<'a, 'd> Elaborator<'a, 'd> {
    pub fn new(
        typed: &'a TypedProgram,
        sources: &'a mut SourceMap,
        host: &'a dyn Host,
        diagnostics: &'d mut Diagnostics,
    ) -> Self {
        let program = &typed.program;
        let mut elaborator = Elaborator {
            program,
            typed,
            later: Findings::default(),
            sources,
            host,
            diagnostics,
            graphs: GraphBuilder::default(),
            scopes: Vec::new(),
            module_scopes: Vec::new(),
            budget: Default::default(),
            context: Default::default(),
            draft: Default::default(),
            lints: program.lints(),
            turns_reported: Default::default(),
        };
        for module in 0..program.modules.len() as u32 {
            let scope = elaborator.new_scope(None, module, String::new());
            elaborator.lasting(scope);
            elaborator.module_scopes.push(scope);
        }
        elaborator
    }

    /// A value from another elaboration.
    fn structural_value(&mut self, value: &Structural) -> Value<'a> {
        match value {
            Structural::Int(i) => Value::Int(*i),
            Structural::Bool(b) => Value::Bool(*b),
            Structural::Text(t) => Value::Text(t.clone()),
            Structural::Choice(id, word) => Value::Choice(*id, *word),
            Structural::Number(v) => Value::Scalar(self.graphs.constant(*v)),
            Structural::ModeSet(parts) => Value::ModeSet(std::rc::Rc::new(parts.clone())),
            Structural::List(items) => {
                Value::List(items.iter().map(|v| self.structural_value(v)).collect())
            }
            Structural::Class(id) => match self.bound_definition(*id) {
                Some(Ok(bound)) => bound,
                _ => Value::Definition(*id),
            },
            Structural::Signal(id) => Value::Definition(*id),
            // it has no name in the model
            Structural::Stop { .. } => Value::Bool(false),
            Structural::Record(id, fields) => {
                let own = self.record_scope(*id);
                for (name, value) in fields {
                    let value = self.structural_value(value);
                    self.define(own, name, Entry::Value(value));
                }
                Value::Record(*id, own)
            }
        }
    }

    pub fn model(
        &mut self,
        model: DefinitionId,
        constants: &[(String, Structural)],
    ) -> Eval<Elaborated> {
        let (name, span, items) = match self.program.item(model).map(|i| &i.kind) {
            Some(ItemKind::Declaration(d)) if d.kind == Kind::Model => match &d.form {
                Form::Plain { block, .. } => (d.name.text.clone(), d.name.span, &block.items),
                _ => return self.checked(None, d.name.span, "a model without a block"),
            },
            _ => return Err(Reported),
        };
        let scope = self.new_scope(
            Some(self.module_scopes[model.module as usize]),
            model.module,
            String::new(),
        );
        self.lasting(scope);
        self.block_with(items, scope, constants);
        self.weld_supports();
        self.lost_changes();
        self.finish_pending();
        let cycle = self.lower_cycle();
        self.graphs.element = None;
        let cycle = cycle?;
        self.columns_have_names_of_their_own(cycle.is_some())?;
        // after an error, elements are missing, and bodies would falsely seem unconstrained
        if !self.diagnostics.has_errors() {
            self.connections(span);
        }
        self.flatten(name, cycle)
    }

    /// Refuses channels with the names of columns that every run has.
    fn columns_have_names_of_their_own(&mut self, cycle: bool) -> Eval<()> {
        let mut known: BTreeMap<&str, Option<u32>> = eng_system::recorded::of_every_run(cycle)
            .map(|name| (name, None))
            .collect();
        let mut twice = None;
        for channel in &self.draft.channels {
            if let Some(first) = known.insert(&channel.path, Some(channel.element)) {
                twice = Some((channel.path.clone(), channel.element, first));
                break;
            }
        }
        let Some((path, second, first)) = twice else {
            return Ok(());
        };
        let place = |element: u32| self.draft.elements.get(element as usize).map(|e| e.span);
        let (second, first) = (place(second), first.and_then(place));
        let mut message = Diagnostic::error(
            codes::CHANNEL_TWICE,
            format!("two columns of the results are called {path}"),
        );
        message = message.at_if(second, "the second one is here");
        message = match first {
            Some(span) => message.also(span, "the first one is here"),
            None => message.with_note("the first one is a column of every run"),
        };
        Err(self.report(message.with_help("give the output or its element another name")))
    }

    fn block_with(
        &mut self,
        items: &'a [eng_grammar::ast::Item],
        scope: ScopeId,
        constants: &[(String, Structural)],
    ) {
        self.register(items, scope);
        for (name, value) in constants {
            match value {
                Structural::Signal(id) => {
                    self.draft.signals.insert(name.clone(), *id);
                    continue;
                }
                Structural::Stop { item, indices } => {
                    self.stop(*item, indices, scope);
                    continue;
                }
                _ => {}
            }
            let value = self.structural_value(value);
            self.define(scope, name, Entry::Value(value));
        }
        // the error was reported
        let _ = self.block(items, scope);
    }

    /// Notes the condition of an analysis that ends its run. It is evaluated when all elements are known.
    fn stop(&mut self, item: u32, indices: &[(String, Structural)], scope: ScopeId) {
        let Some(condition) = self.stop_condition(item) else {
            return;
        };
        let module = self.scope(scope).module;
        let inner = self.new_scope(Some(scope), module, String::new());
        self.lasting(inner);
        for (name, value) in indices {
            let value = self.structural_value(value);
            self.define(inner, name, Entry::Value(value));
        }
        self.draft.pending.push(Pending::Stop {
            condition,
            scope: inner,
        });
    }

    /// The elements with their shared classes. Two classes are equal if their graphs and messages are equal.
    fn share_classes(&mut self) -> Eval<Shared> {
        let drafts = std::mem::take(&mut self.draft.elements);
        let mut class_of: BTreeMap<String, u32> = BTreeMap::new();
        let mut shared = Shared::default();
        for draft in drafts {
            let body = &draft.body;
            self.graphs.bind.owner.clone_from(&draft.origin.path);
            // the key of a class: its graph and its messages
            let key = format!(
                "{}{:?}{:?}{:?}{:?}{:?}{:?}{:?}{:?}{:?}{:?}{:?}{:?}",
                draft.class_name,
                body.layout,
                body.graph.nodes(),
                body.rows,
                body.loads,
                body.rates,
                body.outputs,
                body.conditions,
                body.rotations,
                body.drives,
                body.changing,
                body.bound_kinks,
                draft.meta,
            );
            let class = match class_of.get(&key) {
                Some(class) => *class,
                None => {
                    let made = match body.functions() {
                        Ok(f) => f,
                        Err(error) => {
                            // the evaluator inserts only operations with a derivative, so this is unreachable
                            let path = &draft.origin.path;
                            let what = format!("{path} cannot be differentiated: {error}");
                            return self.checked(None, draft.span, &what);
                        }
                    };
                    let index = shared.classes.len() as u32;
                    shared.classes.push(ElementClass {
                        name: draft.class_name.clone(),
                        layout: body.layout,
                        rows: draft.meta.rows.clone(),
                        states: draft.meta.states.clone(),
                        outputs: outputs_of(&draft.meta, body),
                        conditions: draft.meta.conditions.clone(),
                        kinks: kinks_of(&made, &draft.meta),
                        facts: made.facts.clone(),
                        tape: made.tape(),
                    });
                    shared.functions.push(made);
                    shared.bodies.push(body.clone());
                    class_of.insert(key, index);
                    index
                }
            };
            shared.elements.push(Element {
                origin: draft.origin,
                class,
                role: draft.role,
                markers: draft.markers,
                constants: draft
                    .constants
                    .iter()
                    .map(|n| self.graphs.bind.slot(*n))
                    .collect(),
                state_start: draft
                    .state_start
                    .iter()
                    .map(|n| self.graphs.bind.slot(*n))
                    .collect(),
                state_scale: draft
                    .state_scale
                    .iter()
                    .map(|n| self.graphs.bind.slot(*n))
                    .collect(),
                resolves: draft
                    .resolves
                    .iter()
                    .map(|n| self.graphs.bind.slot(*n))
                    .collect(),
                places: (draft.places.into_iter())
                    .map(|(moving, on, height)| Placing {
                        moving,
                        on,
                        height: height.map(|n| self.graphs.bind.slot(n)),
                    })
                    .collect(),
                signals: draft.signals,
                rotations: draft
                    .rotations
                    .iter()
                    .map(|(turning, reference, stated)| Rotation {
                        turning: *turning,
                        reference: *reference,
                        stated: stated.map(|n| self.graphs.bind.slot(n)),
                    })
                    .collect(),
                fields: (draft.fields.into_iter())
                    .map(|field| field.source(&mut self.graphs.bind))
                    .collect(),
            });
        }
        Ok(shared)
    }

    fn flatten(
        &mut self,
        name: String,
        cycle: Option<eng_system::system::Cycle>,
    ) -> Eval<Elaborated> {
        let zero = self.graphs.bind.graph.constant(0.0);
        self.graphs.bind.owner = "gravity".into();
        let gravity = self
            .draft
            .gravity
            .unwrap_or([zero; 3])
            .map(|n| self.slot(n));
        let Shared {
            classes,
            functions,
            bodies,
            elements,
        } = self.share_classes()?;
        for check in &mut self.draft.checks {
            // a check of the model itself
            if check.path.is_empty() {
                check.path.clone_from(&name);
            }
        }
        let bind = std::mem::take(&mut self.graphs.bind);
        let parameters = std::mem::take(&mut self.draft.parameters);
        let slots = bind.slots().len() as u32;
        let mut program = BindProgram {
            function: Function {
                name: name.clone(),
                inputs: parameters.len() as u32,
                outputs: bind.slots().to_vec(),
                graph: bind.graph,
            },
            fixed: bind.fixed,
            slot_owners: bind.owners,
            defaults: std::mem::take(&mut self.draft.parameter_defaults),
            rates: (std::mem::take(&mut self.draft.parameter_rates).into_iter())
                .filter_map(|(parameter, rate)| Some((parameter, rate?)))
                .collect(),
            parameters: parameters.clone(),
            checks: std::mem::take(&mut self.draft.checks),
            turned: Vec::new(),
            moving: Vec::new(),
            moving_slots: Vec::new(),
        };
        let mut system = System {
            name,
            bodies: std::mem::take(&mut self.draft.bodies),
            markers: std::mem::take(&mut self.draft.markers),
            parameters,
            inputs: std::mem::take(&mut self.draft.inputs),
            moving: Vec::new(),
            slots,
            classes,
            elements,
            channels: std::mem::take(&mut self.draft.channels),
            tables: std::mem::take(&mut self.draft.tables),
            gravity,
            cycle,
            journals: std::mem::take(&mut self.draft.journals),
            firings: std::mem::take(&mut self.draft.firings),
            summaries: self.finished_summaries(),
            resolutions: std::mem::take(&mut self.draft.resolutions),
            accepted: std::mem::take(&mut self.draft.accepted),
            followed: Vec::new(),
            stated: std::mem::take(&mut self.draft.stated),
            parts: std::mem::take(&mut self.draft.parts),
            repeated: std::mem::take(&mut self.draft.repeated),
        };
        self.lints_of_turn(&mut system, &mut program)?;
        self.follow_inputs(&mut system, &mut program, &bodies)?;
        let mut elaborated = Elaborated {
            system: Arc::new(system),
            classes: functions,
            bodies,
            bind: Arc::new(program),
            flexible: Vec::new(),
        };
        self.flexible_sources(&mut elaborated);
        Ok(elaborated)
    }

    /// Whether an element acts on bodies, for the topology.
    pub fn acts(role: Role) -> bool {
        role == Role::Dynamic
    }
}
