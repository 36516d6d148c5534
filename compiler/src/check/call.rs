//! Calls of functions, tables and records; arguments of any call.

use super::Checker;
use super::bound::{Called, Parameter, as_shown};
use super::declare::written_unit;
use super::member::Member;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{BoundClass, Misfit, Quantity, Signature, Solution, Type};
use crate::codes;
use crate::functions::Kind as FunctionKind;
use crate::program::DefinitionId;
use crate::resolve::suggest::listing;
use crate::typed::Callee;
use crate::typed::lineage::parameters;
use eng_grammar::ast::{Argument, BindingKind, Declaration, Expr, ExprKind, Form, Kind};
use eng_grammar::{Diagnostic, Span};
use std::sync::Arc;

/// A parameter that takes an argument.
#[derive(Clone, Debug)]
pub(super) struct Slot {
    pub name: String,
    pub ty: Type,
    pub optional: bool,
    /// The place of its declaration.
    pub span: Option<Span>,
    /// The unit of its default.
    pub unit: Option<String>,
    /// Whether it takes an argument by name only.
    pub named_only: bool,
    /// The argument that it has already.
    pub given: Option<Span>,
    /// Whether it also takes a function of time: an input of a model.
    pub over_time: bool,
}

/// Words with a meaning only in certain places, and these places.
const PLACED: [(&str, &str); 4] = [
    (
        "at",
        "the place of a marker: `marker pin = at(origin, z: [1, 0, 0])`",
    ),
    ("csv", "the source of a table"),
    ("points", "the source of a table"),
    ("origin", "a marker of every body"),
];

impl<'p> Checker<'p> {
    /// Reports a form that the grammar reads and nothing evaluates.
    pub(super) fn not_built(&mut self, span: Span, what: &str) {
        self.report(
            Diagnostic::error(
                codes::NOT_BUILT,
                format!("{what} are reserved for a later version"),
            )
            .at(span, "reserved for later"),
        );
    }

    pub(super) fn call(
        &mut self,
        scope: &Scope<'p>,
        span: Span,
        callee: &Expr,
        arguments: &[Argument],
    ) -> Type {
        // the context expects a function as the value of this call, not in its arguments
        let function_due = std::mem::replace(&mut self.function_due, false);
        if let ExprKind::Name(name) = &callee.kind {
            let found = self.find(scope, name).is_some();
            let built_in = crate::functions::find(name);
            // A value called like a function of the language does not hide the function in a call.
            if let Some(built_in) = built_in
                && (!found
                    || !matches!(
                        self.name(scope, name, callee.span),
                        Type::Function(_) | Type::Class(_) | Type::ClassOf(_) | Type::Bound(_)
                    ))
            {
                let called = Callee::BuiltIn(built_in);
                self.findings.callees.insert(span, called);
                if function_due && matches!(built_in.kind, FunctionKind::Functions) {
                    return self.derivative_as_function(scope, built_in, span, arguments);
                }
                return self.built_in(scope, built_in, span, arguments);
            }
            if !found && let Some(ty) = self.call_of_word(scope, name, callee.span, span, arguments)
            {
                return ty;
            }
            let analysis = eng_system::analysis::kind(name);
            let placed = PLACED.iter().find(|(word, _)| word == name);
            let place = placed.map(|(_, place)| *place);
            let place = place.or(analysis.map(|_| "the right side of an analysis"));
            if !found && let Some(place) = place {
                self.report(
                    Diagnostic::error(codes::MISPLACED, format!("`{name}` is no function"))
                        .at(callee.span, format!("it is {place}")),
                );
                return Type::Error;
            }
        }
        if let ExprKind::Name(name) = &callee.kind
            && crate::functions::only_of_reports(name)
            && self.find(scope, name).is_none()
        {
            self.report(
                Diagnostic::error(
                    codes::MISPLACED,
                    format!("`{name}` is a function of results"),
                )
                .at(callee.span, "only reports have it: `report name { … }`"),
            );
            return Type::Error;
        }
        match self.infer_due(scope, callee, None) {
            Type::Error => {
                for argument in arguments {
                    self.infer(scope, &argument.value);
                }
                Type::Error
            }
            Type::Function(signature) => {
                let signature = self.named_by_call(signature, callee);
                if self.names_for_places(scope, &signature, arguments) {
                    Type::Error
                } else if function_due {
                    self.function_of_call(scope, span, &signature, arguments)
                } else {
                    self.call_of_function(scope, span, &signature, arguments)
                }
            }
            Type::Class(id) => self.call_of_class(scope, span, id, arguments),
            Type::Bound(bound) if self.class_due => {
                self.bound_class(scope, bound.class, &bound.given, arguments, span)
            }
            other => {
                let found = self.describe(&other);
                let shown = self.sources.text(callee.span).to_owned();
                let mut message = Diagnostic::error(
                    codes::NOT_CALLABLE,
                    format!("`{shown}` cannot be called: it is {found}"),
                )
                .at(callee.span, "neither a function nor a record");
                if other.quantity().is_some() {
                    message = message.with_help(format!("for a product write `{shown} * (…)`"));
                }
                self.report(message);
                Type::Error
            }
        }
    }

    /// A signature with the name of its call, because a parameter `law: fn(Length) -> Force` states no name. A
    /// function that calls itself has no signature yet.
    fn named_by_call(&self, signature: Arc<Signature>, callee: &Expr) -> Arc<Signature> {
        if !signature.name.is_empty() || signature.result.is_error() {
            return signature;
        }
        Arc::new(Signature {
            name: self.sources.text(callee.span).to_owned(),
            ..Signature::clone(&signature)
        })
    }

    /// Reports a named argument of a function whose type states no names: `fn(Length) -> Force`.
    fn names_for_places(
        &mut self,
        scope: &Scope<'p>,
        signature: &Signature,
        arguments: &[Argument],
    ) -> bool {
        let mut parameters = signature.parameters.iter();
        let (Some(first), Some(name)) = (
            signature.parameters.first(),
            arguments.iter().find_map(|argument| argument.name.as_ref()),
        ) else {
            return false;
        };
        if signature.result.is_error() || parameters.any(|p| !p.name.is_empty()) {
            return false;
        }
        let called = &signature.name;
        let values = arguments.iter().map(|a| self.sources.text(a.value.span));
        let values: Vec<&str> = values.collect();
        let form = format!("{called}({})", values.join(", "));
        self.report(
            Diagnostic::error(
                codes::UNKNOWN_ARGUMENT,
                format!("`{called}` has no parameter `{}`", name.text),
            )
            .at(name.span, "its arguments have no names")
            .also(first.span, "this type states no names")
            .with_help(format!("give the arguments by place: `{form}`")),
        );
        for argument in arguments {
            self.infer(scope, &argument.value);
        }
        true
    }

    /// The type of a call of a class inside an expression.
    fn call_of_class(
        &mut self,
        scope: &Scope<'p>,
        span: Span,
        id: DefinitionId,
        arguments: &[Argument],
    ) -> Type {
        match self.declaration(id).map(|d| d.kind) {
            Some(Kind::Record) => {
                self.arguments_of_class(scope, id, &[], arguments, span);
                Type::Instance(id)
            }
            Some(kind) if self.class_due && super::class::is_of_elements(kind) => {
                self.bound_class(scope, id, &[], arguments, span)
            }
            Some(kind) => {
                let word = super::describe::kind_word(kind);
                let class = self.class_name(id);
                let form = match kind {
                    Kind::Component => format!("part name = {class}(…)"),
                    Kind::Model => {
                        format!("analysis name = transient({class}(…), duration: …)")
                    }
                    _ => format!("{word} name = {class}(…)"),
                };
                let message = Diagnostic::error(
                    codes::MISPLACED,
                    format!("the {word} `{class}` is no value"),
                )
                .at(span, "used inside an expression")
                .with_help(format!("it is an item of its own: `{form}`"));
                let interface = self.program.interface_of(id);
                self.report(match interface {
                        Some(interface) if kind != Kind::Model => {
                            let interface = self.class_name(interface);
                            message.with_help(format!(
                                "a class with some of its arguments needs a stated type: `law: {interface} = {class}(…)`, `laws: {interface}[2] = [{class}(…), …]`"
                            ))
                        }
                        _ => message,
                    });
                Type::Error
            }
            None => Type::Error,
        }
    }

    pub(super) fn call_of_function(
        &mut self,
        scope: &Scope<'p>,
        span: Span,
        signature: &Signature,
        arguments: &[Argument],
    ) -> Type {
        if signature.name.is_empty() && signature.result.is_error() {
            // The function calls itself, or its definition has a message.
            for argument in arguments {
                self.infer(scope, &argument.value);
            }
            return Type::Error;
        }
        let slots = slots_of_function(signature);
        let mut solution = Solution::default();
        let ok = self.arguments(
            scope,
            &signature.name,
            &slots,
            arguments,
            span,
            &mut solution,
        );
        if !ok && has_variables(&signature.result) {
            return Type::Error;
        }
        let result = signature.result.with(&solution);
        self.solved(span, solution);
        result
    }

    /// Stores the dimensions of the variables of a function at a use.
    pub(super) fn solved(&mut self, place: Span, solution: Solution) {
        if !solution.is_empty() {
            self.findings.solutions.insert(place, solution);
        }
    }

    /// The parameters of a class, component, model, interface or record, in order.
    pub(super) fn slots_of(&mut self, id: DefinitionId) -> Vec<Slot> {
        let Some(declaration) = self.declaration(id) else {
            return Vec::new();
        };
        let mut slots = Vec::new();
        if matches!(declaration.form, Form::Class { .. }) || declaration.kind == Kind::Interface {
            for parameter in parameters(self.program, id) {
                let name = parameter.name;
                // a repeated name was reported, and has the type of its first place
                let ty = match self.owned_member(parameter.home, &name.text) {
                    Some(owned) => {
                        self.member_type(owned.home, &name.text, owned.member, name.span)
                    }
                    None => Type::Error,
                };
                slots.push(Slot {
                    name: name.text.clone(),
                    ty,
                    optional: parameter.default.is_some(),
                    span: Some(name.span),
                    unit: parameter.default.and_then(written_unit),
                    named_only: false,
                    given: None,
                    over_time: false,
                });
            }
            return slots;
        }
        for binding in crate::typed::settable(declaration) {
            let name = &binding.name;
            let ty = self.member_type(id, &name.text, Member::Binding(binding), name.span);
            slots.push(Slot {
                name: name.text.clone(),
                ty,
                optional: binding.value.is_some(),
                span: Some(name.span),
                unit: binding.value.as_ref().and_then(written_unit),
                named_only: false,
                given: None,
                over_time: binding.kind == BindingKind::Input,
            });
        }
        slots
    }

    /// Checks the arguments of a use of a class.
    pub(super) fn arguments_of_class(
        &mut self,
        scope: &Scope<'p>,
        id: DefinitionId,
        given: &[(usize, Span)],
        arguments: &[Argument],
        span: Span,
    ) -> bool {
        if self.lacks_parameters(scope, id, arguments) {
            return false;
        }
        let slots = self.slots_with(id, given);
        let name = self.class_name(id);
        let solution = &mut Solution::default();
        self.arguments(scope, &name, &slots, arguments, span, solution)
    }

    /// Whether a class lacks parameters because it names an interface that it cannot have. The message about the
    /// interface is enough.
    fn lacks_parameters(
        &mut self,
        scope: &Scope<'p>,
        class: DefinitionId,
        arguments: &[Argument],
    ) -> bool {
        let lacks = self.lacks_interface(Some(class));
        for argument in arguments.iter().filter(|_| lacks) {
            self.infer(scope, &argument.value);
        }
        lacks
    }

    /// The parameters of a class, with the places of the arguments that some have already.
    fn slots_with(&mut self, id: DefinitionId, given: &[(usize, Span)]) -> Vec<Slot> {
        let mut slots = self.slots_of(id);
        for (at, place) in given {
            if let Some(slot) = slots.get_mut(*at) {
                slot.given = Some(*place);
                slot.optional = true;
            }
        }
        slots
    }

    /// A class with some of its arguments, as a value: `Impedance(viscosity: 10 mPa*s)`.
    fn bound_class(
        &mut self,
        scope: &Scope<'p>,
        class: DefinitionId,
        before: &[(usize, Span)],
        arguments: &[Argument],
        span: Span,
    ) -> Type {
        if self.lacks_parameters(scope, class, arguments) {
            return Type::Error;
        }
        let mut slots = self.slots_with(class, before);
        for slot in &mut slots {
            slot.optional = true;
        }
        let name = self.class_name(class);
        let solution = &mut Solution::default();
        if !self.arguments(scope, &name, &slots, arguments, span, solution) {
            return Type::Error;
        }
        let places = self.findings.calls.get(&span).cloned();
        let places = places.iter().flat_map(|places| places.iter());
        let mut given = before.to_vec();
        given.extend(
            places
                .zip(arguments)
                .map(|(place, argument)| (*place as usize, argument.value.span)),
        );
        Type::Bound(Arc::new(BoundClass { class, given }))
    }

    /// The class that a definition `journal OurMain = Impedance(viscosity: …)` makes.
    pub(super) fn bound_by(&mut self, module: u32, declaration: &'p Declaration) -> Type {
        let Form::Instance { value, .. } = &declaration.form else {
            return Type::Error;
        };
        let scope = Scope::top(module);
        let outer = std::mem::replace(&mut self.class_due, true);
        let ty = match &value.kind {
            ExprKind::Call { .. } => self.element_type(&scope, declaration),
            _ => Type::Error,
        };
        let ty = match ty {
            Type::Error => Type::Error,
            _ => self.infer(&scope, value),
        };
        self.class_due = outer;
        ty
    }

    /// Checks a definition `journal OurMain = Impedance(viscosity: …)`.
    pub(super) fn bound_definition(&mut self, id: DefinitionId, declaration: &'p Declaration) {
        let Form::Instance { value, block } = &declaration.form else {
            return;
        };
        let name = &declaration.name;
        let odd = match (declaration.index.first(), block) {
            (Some(binder), _) => Some((binder.name.span, "an index")),
            (None, Some(block)) => Some((block.span, "a block")),
            (None, None) => None,
        };
        if let Some((place, what)) = odd {
            self.misplaced(
                place,
                what,
                "at a definition",
                "a class with arguments is a definition; the index and the block belong to its uses",
            );
        }
        if !matches!(value.kind, ExprKind::Call { .. }) {
            let word = super::describe::kind_word(declaration.kind);
            self.report(
                Diagnostic::error(
                    codes::MISSING_ARGUMENT,
                    format!("`{}` is defined without arguments", name.text),
                )
                .at(value.span, "this is a class with some of its arguments")
                .with_help(format!(
                    "write `{word} {} = Class(parameter: …)`, or put an element into a model",
                    name.text
                )),
            );
            return;
        }
        self.top_type(id, name.span);
    }

    /// Checks arguments against parameters: names, number, types. Returns whether all are right.
    pub(super) fn arguments(
        &mut self,
        scope: &Scope<'p>,
        callee: &str,
        slots: &[Slot],
        arguments: &[Argument],
        span: Span,
        solution: &mut Solution,
    ) -> bool {
        let again = arguments.iter().find_map(|argument| {
            let name = argument.name.as_ref()?;
            let mut slots = slots.iter().filter(|slot| slot.name == name.text);
            Some((name, argument.value.span, slots.next()?.given?))
        });
        if let Some((name, again, first)) = again {
            self.report(
                Diagnostic::error(
                    codes::ARGUMENT_TWICE,
                    format!("`{}` of `{callee}` is given twice", name.text),
                )
                .at(again, "again here")
                .also(first, "this class has it already"),
            );
            return false;
        }
        let parameters = slots.iter().map(|slot| Parameter {
            name: &slot.name,
            required: !slot.optional,
            by_place: !slot.named_only && slot.given.is_none(),
            by_name: true,
        });
        let called = Called {
            name: callee,
            parameters: parameters.collect(),
            more: false,
            example: None,
        };
        let given = self.given(&called, arguments);
        let mut ok = given.odd.is_empty() && given.missing.is_empty();
        for value in &given.odd {
            self.infer(scope, value);
        }
        let mut places = Vec::with_capacity(arguments.len());
        for (place, value) in &given.arguments {
            if let Some((place, slot)) = place.and_then(|at| Some((at, slots.get(at)?))) {
                places.push(place as u32);
                ok &= self.argument(scope, callee, slot, value, solution);
            }
        }
        if let Some(first) = given.missing.first().and_then(|at| slots.get(*at)) {
            let mut message = called.missing(&given.missing, span);
            message = message.also_if(first.span, "declared here");
            if !first.ty.is_error() {
                let name = as_shown(&format!("`{}`", first.name));
                message = message.with_note(format!("{name} is {}", self.describe(&first.ty)));
            }
            self.report(message);
        }
        if ok {
            self.findings.calls.insert(span, places.into());
        }
        ok
    }

    fn argument(
        &mut self,
        scope: &Scope<'p>,
        callee: &str,
        slot: &Slot,
        value: &Expr,
        solution: &mut Solution,
    ) -> bool {
        let found = self.infer_as(scope, value, &slot.ty);
        if found.is_error() {
            return false;
        }
        solve(&slot.ty, &found, solution);
        let expected = slot.ty.with(solution);
        let what = if callee.is_empty() {
            slot.name.clone()
        } else {
            let name = as_shown(&format!("`{}`", slot.name));
            format!("{name} of `{callee}`")
        };
        let mut due = Due::new(what);
        if let Some(span) = slot.span {
            due = due.declared(span, "declared here");
        }
        due.unit = slot.unit.clone();
        if expected.is_error() {
            return true;
        }
        if let (true, Type::Function(signature)) = (slot.over_time, &found) {
            return self.over_time(value, signature, &expected, &due);
        }
        !self.fit(value, &found, &expected, &due).is_error()
    }

    /// Checks a function or table against a needed signature.
    pub(super) fn function_for(
        &mut self,
        expr: &Expr,
        wanted: &Signature,
        given: &Signature,
        due: &Due,
    ) -> Type {
        let mut solution = Solution::default();
        let count = given
            .parameters
            .iter()
            .filter(|parameter| !parameter.optional)
            .count();
        let mut fits =
            count <= wanted.parameters.len() && wanted.parameters.len() <= given.parameters.len();
        for (a, b) in wanted.parameters.iter().zip(&given.parameters) {
            solve(&b.ty, &a.ty, &mut solution);
            fits &= self.assignable(&a.ty, &b.ty.with(&solution));
        }
        let result = given.result.with(&solution);
        if result.is_error() {
            return Type::Error;
        }
        fits &= self.assignable(&result, &wanted.result);
        if fits {
            // a call that gives a generic function some of its arguments has found some of its variables
            let known = self.findings.solutions.get(&expr.span);
            let solution = known.map_or(solution.clone(), |known| solution.and(known));
            self.solved(expr.span, solution);
            return Type::Function(wanted.clone().into());
        }
        let shape = |signature: &Signature, result: &Type| {
            let unnamed = Signature {
                name: String::new(),
                parameters: signature.parameters.clone(),
                result: result.clone(),
            };
            Type::Function(unnamed.into())
        };
        let expected_text = self.describe(&shape(wanted, &wanted.result));
        let found_text = self.describe(&shape(given, &result));
        let mut message = Diagnostic::error(
            codes::WRONG_TYPE,
            format!("{} is {expected_text}", due.what),
        )
        .at(expr.span, format!("this is {found_text}"));
        if let Some((span, text)) = &due.declared {
            message = message.also(*span, text.clone());
        }
        self.report(message);
        Type::Error
    }

    /// Checks a class against a needed interface.
    pub(super) fn class_for(
        &mut self,
        expr: &Expr,
        interface: DefinitionId,
        class: DefinitionId,
        given: &[(usize, Span)],
        due: &Due,
    ) -> Type {
        let (interface_name, class_name) = (self.class_name(interface), self.class_name(class));
        let is_interface = self
            .declaration(class)
            .is_some_and(|d| d.kind == Kind::Interface);
        if is_interface || !self.program.fills(class, interface) {
            let mut message = Diagnostic::error(
                codes::NOT_OF_INTERFACE,
                format!(
                    "{} is a class of `{interface_name}`; `{class_name}` is not",
                    due.what
                ),
            )
            .at(
                expr.span,
                match is_interface {
                    true => "an interface, and no class",
                    false => "does not state this interface",
                },
            );
            if let Some((span, text)) = &due.declared {
                message = message.also(*span, text.clone());
            }
            let all: Vec<DefinitionId> = self
                .program
                .modules
                .iter()
                .enumerate()
                .flat_map(|(module, m)| {
                    (0..m.file.items.len()).map(move |item| DefinitionId {
                        module: module as u32,
                        item: item as u32,
                    })
                })
                .collect();
            let mut fitting = Vec::new();
            for id in all {
                let declaration = self.declaration(id);
                let is_class = declaration.is_some_and(|d| matches!(d.form, Form::Class { .. }));
                if is_class && self.program.fills(id, interface) {
                    fitting.push(self.class_name(id));
                }
            }
            if !fitting.is_empty() {
                message = message.with_help(format!(
                    "classes of `{interface_name}`: {}",
                    listing(fitting.iter().map(String::as_str), 8)
                ));
            }
            self.report(message);
            return Type::Error;
        }
        let promised = self.slots_of(interface);
        let own = self.slots_with(class, given);
        let taken = own.iter().find_map(|slot| {
            let asked = promised.iter().any(|promise| promise.name == slot.name);
            Some((slot.name.clone(), slot.given.filter(|_| asked)?))
        });
        if let Some((name, place)) = taken {
            let message = Diagnostic::error(
                codes::NOT_OF_INTERFACE,
                format!("`{name}` of `{interface_name}` is given already"),
            )
            .at(
                expr.span,
                format!("each use as `{interface_name}` states `{name}` itself"),
            )
            .also(place, "given here");
            self.report(message.with_help(format!(
                "give a class of `{interface_name}` only arguments that `{interface_name}` does not have"
            )));
            return Type::Error;
        }
        let extra = own.into_iter().find(|slot| {
            !slot.optional && promised.iter().all(|promise| promise.name != slot.name)
        });
        if let Some(extra) = extra {
            let mut message = Diagnostic::error(
                codes::NOT_OF_INTERFACE,
                format!(
                    "`{class_name}` needs `{}`, which `{interface_name}` does not give",
                    extra.name
                ),
            )
            .at(expr.span, format!("nothing states `{}`", extra.name));
            message = message.also_if(extra.span, "has no default");
            self.report(message.with_help(format!(
                "write `{class_name}({}: …)` here (in an analysis, the name of such a definition), or give the parameter a default",
                extra.name
            )));
            return Type::Error;
        }
        Type::ClassOf(interface)
    }
}

/// The parameters of a function.
pub(super) fn slots_of_function(signature: &Signature) -> Vec<Slot> {
    let parameters = signature.parameters.iter().enumerate();
    parameters
        .map(|(index, parameter)| Slot {
            name: if parameter.name.is_empty() {
                format!("argument {}", index + 1)
            } else {
                parameter.name.clone()
            },
            ty: parameter.ty.clone(),
            optional: parameter.optional,
            span: Some(parameter.span),
            unit: None,
            named_only: false,
            given: None,
            over_time: false,
        })
        .collect()
}

fn has_variables(ty: &Type) -> bool {
    match ty {
        Type::Scalar(quantity) | Type::Vector { quantity, .. } => !quantity.dim.is_known(),
        Type::List { element, .. } | Type::Range(element) => has_variables(element),
        _ => false,
    }
}

/// Finds the dimensions of a parameter's variables from an argument.
pub(super) fn solve(parameter: &Type, found: &Type, solution: &mut Solution) {
    match (parameter, found) {
        (Type::Scalar(quantity), _) => {
            if let Some(found) = found.quantity() {
                solve_quantity(quantity, &found, solution);
            }
        }
        (
            Type::Vector { quantity, .. },
            Type::Vector {
                quantity: found, ..
            },
        ) => solve_quantity(quantity, found, solution),
        (Type::Vector { quantity, .. }, Type::List { .. }) => {
            if let Some((found, _)) = found.components() {
                solve_quantity(quantity, &found, solution);
            }
        }
        (Type::List { element, .. }, Type::List { element: found, .. }) => {
            solve(element, found, solution);
        }
        (Type::Function(wanted), Type::Function(given)) => {
            for (a, b) in wanted.parameters.iter().zip(&given.parameters) {
                solve(&a.ty, &b.ty, solution);
            }
            solve(&wanted.result, &given.result, solution);
        }
        _ => {}
    }
}

/// Finds the dimension of the one variable of a quantity that is not known yet. Exponents of dimensions count
/// in sixtieths, so 60 is the first power.
fn solve_quantity(parameter: &Quantity, found: &Quantity, solution: &mut Solution) {
    let alone = parameter.dim.base.is_one() && matches!(parameter.dim.variables(), [(_, 60)]);
    let unsolved: Vec<(u32, i32)> = parameter
        .dim
        .variables()
        .iter()
        .copied()
        .filter(|(number, _)| solution.get(*number).is_none())
        .collect();
    match unsolved.as_slice() {
        [(number, exponent)] => {
            if alone {
                solution.set(*number, found.clone());
                return;
            }
            let known = parameter.dim.with(solution);
            let own = super::types::Dim::variable(*number)
                .power(*exponent, 60)
                .unwrap_or_default();
            let rest = found.dim.over(&known.over(&own));
            let (n, d) = if *exponent < 0 {
                (-60, -exponent)
            } else {
                (60, *exponent)
            };
            if let Some(dim) = rest.power(n, d) {
                solution.set(*number, Quantity::soft(dim));
            }
        }
        [] if alone => {
            // An argument with a more definite quantity decides the variable.
            if let [(number, _)] = parameter.dim.variables()
                && let Some(old) = solution.get(*number)
            {
                match old.join(found) {
                    Ok(joined) => solution.set(*number, joined),
                    Err(Misfit::Dimension | Misfit::Angle | Misfit::Point) => {}
                }
            }
        }
        _ => {}
    }
}
