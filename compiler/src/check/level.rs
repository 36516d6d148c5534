//! The levels of values: parameters, positions, velocities, accelerations. Constraints may use positions
//! only. Accelerations, reactions and rates of states are known in outputs only.
//!
//! This pass runs after the types of all definitions are right. Every value gets its level. Functions are
//! followed with the levels of their arguments. Each statement has a highest permitted level.

use super::member::{Member, OwnedMember, is_asked};
use super::scope::{Found, Scope};
use super::types::Type;
use super::{Checker, Progress};
use crate::codes;
use crate::program::DefinitionId;
use crate::typed::lineage::{is_parameter, levels};
use eng_grammar::ast::{
    Argument, Binder, Binding, BindingKind, Expr, ExprKind, Function, IndexArgument, ItemKind,
    Kind, Name, Statement,
};
use eng_grammar::{Diagnostic, Span};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Most calls that are followed: each call follows its function again, so functions that call others several
/// times would take a time without limit. Beyond this number a call has the highest level of its arguments.
/// The number is a choice.
const MOST_CALLS: u32 = 100_000;

/// The origin of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cause {
    Velocity,
    Derivative,
    State,
    Field,
    SecondDerivative,
    RateOfState,
    Acceleration,
    Reaction,
}

/// -1: parameters and time; 0: positions; 1: velocities and states; 2: accelerations, reactions and rates of
/// states.
#[derive(Clone, Copy, Debug)]
struct Level {
    order: i8,
    cause: Option<(Span, Cause)>,
}

const FREE: Level = Level {
    order: -1,
    cause: None,
};
const POSITION: Level = Level {
    order: 0,
    cause: None,
};

impl Level {
    fn new(order: i8, span: Span, cause: Cause) -> Level {
        Level {
            order,
            cause: Some((span, cause)),
        }
    }

    fn with(self, other: Level) -> Level {
        if other.order > self.order {
            other
        } else {
            self
        }
    }

    fn rate(self, span: Span) -> Level {
        match self.order {
            ..=-1 => self,
            0 => Level::new(1, span, Cause::Derivative),
            1 => {
                let cause = match self.cause {
                    Some((_, Cause::State)) => Cause::RateOfState,
                    _ => Cause::SecondDerivative,
                };
                Level::new(2, span, cause)
            }
            _ => self,
        }
    }
}

/// A value, reduced to its level.
#[derive(Clone)]
enum Abstract<'p> {
    Number(Level),
    Marker,
    Body,
    Cycle,
    Record(DefinitionId, Rc<BTreeMap<String, Abstract<'p>>>),
    Instance(DefinitionId),
    Class(DefinitionId),
    Function(&'p Function, Rc<Place<'p>>),
    /// A function with some of its arguments, by the names of their parameters.
    Partial(Rc<Abstract<'p>>, Rc<Vec<(String, Abstract<'p>)>>),
    /// A table, or a function that is a parameter.
    Unknown,
}

impl Abstract<'_> {
    fn level(&self) -> Level {
        match self {
            Abstract::Number(level) => *level,
            Abstract::Marker | Abstract::Body | Abstract::Cycle => POSITION,
            Abstract::Record(_, fields) => fields
                .values()
                .fold(FREE, |level, field| level.with(field.level())),
            Abstract::Partial(_, given) => given
                .iter()
                .fold(FREE, |level, (_, given)| level.with(given.level())),
            _ => FREE,
        }
    }
}

/// The surroundings of an expression that is followed.
#[derive(Clone)]
struct Place<'p> {
    scope: Scope<'p>,
    /// The class that provides the items which the surrounding interface requires.
    class: Option<DefinitionId>,
    locals: Vec<(String, Abstract<'p>)>,
}

impl<'p> Place<'p> {
    fn of(scope: Scope<'p>) -> Place<'p> {
        Place {
            scope,
            class: None,
            locals: Vec::new(),
        }
    }

    /// The text of a definition as part of a class.
    fn in_class(definition: DefinitionId, class: DefinitionId) -> Place<'p> {
        Place {
            class: Some(class),
            ..Place::of(Scope::of(definition))
        }
    }
}

struct Levels<'c, 'p> {
    checker: &'c mut Checker<'p>,
    known: BTreeMap<(DefinitionId, String), Progress<Abstract<'p>>>,
    calls: u32,
    depth: u32,
}

/// Checks all statements of all definitions.
pub(super) fn check(checker: &mut Checker<'_>) {
    let program = checker.program;
    let mut following = Levels {
        checker,
        known: BTreeMap::new(),
        calls: 0,
        depth: 0,
    };
    for (module, file) in program.modules.iter().enumerate() {
        for (item, content) in file.file.items.iter().enumerate() {
            if !matches!(content.kind, ItemKind::Declaration(_)) {
                continue;
            }
            let id = DefinitionId {
                module: module as u32,
                item: item as u32,
            };
            // the functions of a class decide the levels of the statements of its interface
            let texts = levels(program, id);
            for (home, item) in texts.iter().flat_map(|level| {
                level
                    .block
                    .items
                    .iter()
                    .map(|item| (level.definition, item))
            }) {
                let place = Place::in_class(home, id);
                match &item.kind {
                    ItemKind::Statement(statement) => following.statement(&place, statement),
                    ItemKind::Binding(binding) if binding.kind == BindingKind::Field => {
                        following.drives(&place, binding);
                    }
                    ItemKind::Declaration(inner)
                        if matches!(
                            inner.kind,
                            Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive
                        ) =>
                    {
                        following.block_of_use(&place, inner);
                    }
                    _ => {}
                }
            }
        }
    }
    for (scope, condition) in std::mem::take(&mut following.checker.stops) {
        following.stop(scope, &condition);
    }
}

impl<'p> Levels<'_, 'p> {
    /// Checks the condition of an analysis that ends its run. Steps end where it changes, and accelerations are not
    /// known there yet. So it may not use them.
    fn stop(&mut self, scope: Scope<'p>, condition: &Expr) {
        let level = self.level(&Place::of(scope), condition);
        self.bear(level, 1, condition.span, "a condition that ends a run");
        if level.order < 0 {
            let message = Diagnostic::error(
                codes::ANALYSIS_VALUE,
                "the condition of `stop` does not depend on the motion",
            );
            self.checker.report(
                message
                    .at(condition.span, "parameters, inputs and time alone")
                    .with_help("a time ends a run by `duration`; name a position, a speed, a state or an output that follows from them"),
            );
        }
    }

    fn block_of_use(&mut self, place: &Place<'p>, declaration: &'p eng_grammar::ast::Declaration) {
        let Some(block) = declaration.block() else {
            return;
        };
        let ty = self.checker.element_type(&place.scope, declaration);
        let at_use = match ty {
            Type::Instance(id) | Type::InstanceOf(id) => Some(id),
            _ => None,
        };
        let mut inner = Place::of(Scope {
            at_use,
            ..place.scope.clone()
        });
        self.bind(&mut inner, &declaration.index);
        for item in &block.items {
            if let ItemKind::Statement(statement) = &item.kind {
                self.statement(&inner, statement);
            }
        }
    }

    /// Checks the arguments of a field.
    fn drives(&mut self, place: &Place<'p>, field: &Binding) {
        let Some(ExprKind::Call { arguments, .. }) = field.value.as_ref().map(|v| &v.kind) else {
            return;
        };
        for argument in arguments {
            let level = self.level(place, &argument.value);
            self.bear(level, 1, argument.value.span, "in a field");
        }
    }

    fn statement(&mut self, place: &Place<'p>, statement: &Statement) {
        match statement {
            Statement::Constrain(equation) => {
                let level = self.level(place, equation);
                self.bear(level, 0, equation.span, "constrained");
            }
            Statement::Branch(condition) => {
                let level = self.level(place, condition);
                self.bear(level, 1, condition.span, "a branch");
            }
            Statement::Start { target, value } | Statement::Guess { target, value } => {
                let level = self.level(place, target).with(self.level(place, value));
                self.bear(level, 1, target.span, "set at the start");
            }
            Statement::Apply { value, .. } => {
                let level = self.level(place, value);
                self.bear(level, 1, value.span, "applied");
            }
            Statement::Require {
                condition, index, ..
            } => {
                let mut place = place.clone();
                self.bind(&mut place, index);
                let level = self.level(&place, condition);
                self.bear(level, 1, condition.span, "a requirement");
            }
            // none of them reads the motion: elaboration requires parameters alone for the length of
            // `resolve`
            Statement::Accept(_)
            | Statement::Resolve(_)
            | Statement::Place { .. }
            | Statement::Change { .. } => {}
            Statement::Rate { value, .. } => {
                let level = self.level(place, value);
                self.bear(level, 1, value.span, "the rate of a state");
            }
        }
    }

    /// Reports a level above the highest permitted one. `use_` is the label of the place that sets the limit.
    fn bear(&mut self, level: Level, most: i8, span: Span, use_: &str) {
        let Some((at, cause)) = level.cause.filter(|_| level.order > most) else {
            return;
        };
        let (code, title, label, help) = match (level.order, cause) {
            (_, Cause::Acceleration) => (
                codes::ACCELERATION,
                "accelerations can be used in outputs only",
                "an acceleration",
                "the mass of the body already gives its force of inertia; show an acceleration by an `output`",
            ),
            (_, Cause::Reaction) => (
                codes::ACCELERATION,
                "reactions can be used in outputs only",
                "a reaction",
                "a law that needs a reaction needs a compliant element instead of the joint",
            ),
            (_, Cause::RateOfState) => (
                codes::DERIVATIVE,
                "the rate of a state can be used in outputs only",
                "the rate of a state",
                "give the right side of its `der(…) = …` a name by `let`, and use that name in both places",
            ),
            (2.., _) => (
                codes::DERIVATIVE,
                "a velocity is differentiated outside of outputs",
                "the second derivative of a position",
                "accelerations are known only when a step is solved; show them by an `output`",
            ),
            (_, Cause::Field) => (
                codes::DERIVATIVE,
                "a constraint holds positions, not the results of a field",
                "a field",
                "apply a force that depends on the field instead",
            ),
            (_, Cause::State) => (
                codes::DERIVATIVE,
                "a constraint holds positions, not states",
                "a state",
                "apply a force that depends on the state instead",
            ),
            _ => (
                codes::DERIVATIVE,
                "a constraint holds positions, not velocities",
                "a velocity",
                "constrain the position that belongs to it: an angle to `speed*time` rather than its rate to `speed`",
            ),
        };
        let mut message = Diagnostic::error(code, title).at(at, label);
        if at != span {
            message = message.also(span, use_.to_owned());
        }
        self.checker.report(message.with_help(help));
    }

    fn level(&mut self, place: &Place<'p>, expr: &Expr) -> Level {
        self.value(place, expr).level()
    }

    fn joined<'e>(
        &mut self,
        place: &Place<'p>,
        parts: impl IntoIterator<Item = &'e Expr>,
    ) -> Level {
        parts
            .into_iter()
            .fold(FREE, |level, part| level.with(self.level(place, part)))
    }

    fn bind(&mut self, place: &mut Place<'p>, binders: &[Binder]) {
        for binder in binders {
            let value = self.value(place, &binder.range);
            place.locals.push((binder.name.text.clone(), value));
        }
    }

    fn value(&mut self, place: &Place<'p>, expr: &Expr) -> Abstract<'p> {
        match &expr.kind {
            ExprKind::Number { .. } | ExprKind::Text(_) | ExprKind::Bool(_) | ExprKind::Error => {
                Abstract::Number(FREE)
            }
            // a word of a choice
            ExprKind::Name(_) | ExprKind::Field { .. }
                if self.checker.findings.words.contains_key(&expr.span) =>
            {
                Abstract::Number(FREE)
            }
            ExprKind::Name(name) => self.name(place, name, expr.span),
            ExprKind::List { items, .. } => match items.as_slice() {
                // A list of bodies, markers or elements is like one of them.
                [only, ..] => {
                    let first = self.value(place, only);
                    match first {
                        Abstract::Number(_) => Abstract::Number(self.joined(place, items)),
                        other => other,
                    }
                }
                [] => Abstract::Number(FREE),
            },
            ExprKind::Comprehension { body, binders, .. } => {
                let mut inner = place.clone();
                self.bind(&mut inner, binders);
                self.value(&inner, body)
            }
            ExprKind::Paren { inner, .. } => self.value(place, inner),
            ExprKind::Field { base, name } => {
                let base = self.value(place, base);
                self.field(base, name)
            }
            ExprKind::Call { callee, arguments } => self.call(place, callee, arguments, expr.span),
            ExprKind::Index { base, indices } => {
                for index in indices {
                    if let IndexArgument::At(at) = index {
                        self.level(place, at);
                    }
                }
                self.value(place, base)
            }
            ExprKind::Unary { operand, .. } => Abstract::Number(self.level(place, operand)),
            ExprKind::Binary { left, right, .. } => {
                Abstract::Number(self.joined(place, [left.as_ref(), right.as_ref()]))
            }
            ExprKind::If {
                condition,
                then,
                otherwise,
            } => {
                let value = self.value(place, then);
                match value {
                    Abstract::Number(level) => Abstract::Number(
                        level.with(
                            self.joined(
                                place,
                                std::iter::once(condition)
                                    .chain(otherwise)
                                    .map(AsRef::as_ref),
                            ),
                        ),
                    ),
                    other => other,
                }
            }
            ExprKind::Range { from, to, by } => {
                let parts = [Some(from), Some(to), by.as_ref()];
                Abstract::Number(self.joined(place, parts.into_iter().flatten().map(AsRef::as_ref)))
            }
        }
    }

    fn name(&mut self, place: &Place<'p>, name: &str, span: Span) -> Abstract<'p> {
        if let Some((_, value)) = place.locals.iter().rev().find(|(n, _)| n == name) {
            return value.clone();
        }
        match self.checker.find(&place.scope, name) {
            Some(Found::Local(_)) => Abstract::Number(FREE),
            Some(Found::BodyMarker(_)) => Abstract::Marker,
            Some(Found::Member(home, member)) => {
                let classes = [place.class, place.scope.at_use];
                let class = classes
                    .into_iter()
                    .flatten()
                    .find(|class| self.checker.program.fills(*class, home))
                    .unwrap_or(home);
                let owned = self
                    .checker
                    .owned_member(class, name)
                    .unwrap_or(OwnedMember { home, member });
                self.member(class, name, owned, span)
            }
            Some(Found::Top(id)) => self.top(id),
            None => match name {
                "ground" | "origin" => Abstract::Marker,
                "cycle" => Abstract::Cycle,
                _ => Abstract::Number(FREE),
            },
        }
    }

    fn top(&mut self, id: DefinitionId) -> Abstract<'p> {
        let Some(item) = self.checker.program.item(id) else {
            return Abstract::Unknown;
        };
        match &item.kind {
            ItemKind::Binding(binding) => self.remembered(id, "", |levels| {
                levels.binding(&Place::of(Scope::top(id.module)), binding)
            }),
            ItemKind::Function(function) => {
                self.function(function, Place::of(Scope::top(id.module)), (id, ""))
            }
            ItemKind::Declaration(_) => Abstract::Class(id),
            _ => Abstract::Unknown,
        }
    }

    fn remembered(
        &mut self,
        id: DefinitionId,
        name: &str,
        find: impl FnOnce(&mut Self) -> Abstract<'p>,
    ) -> Abstract<'p> {
        let key = (id, name.to_owned());
        match self.known.get(&key) {
            Some(Progress::Done(value)) => return value.clone(),
            // circles were reported before, so this value is harmless here
            Some(Progress::Open) => return Abstract::Number(FREE),
            None => {}
        }
        if self.depth > super::DEEPEST_VALUES {
            return Abstract::Number(FREE);
        }
        self.known.insert(key.clone(), Progress::Open);
        self.depth += 1;
        let value = find(self);
        self.depth -= 1;
        self.known.insert(key, Progress::Done(value.clone()));
        value
    }

    /// A member of a class, in the text of the class or of its interface.
    fn member(
        &mut self,
        class: DefinitionId,
        name: &str,
        owned: OwnedMember<'p>,
        span: Span,
    ) -> Abstract<'p> {
        let OwnedMember { home: id, member } = owned;
        let place = Place::in_class(id, class);
        let of_interface = self
            .checker
            .declaration(id)
            .is_some_and(|home| home.kind == Kind::Interface);
        match member {
            Member::Parameter(parameter) => {
                let ty = self
                    .checker
                    .member_type(id, name, member, parameter.name.span);
                self.given(&ty)
            }
            Member::Binding(binding) => match binding.kind {
                BindingKind::State => Abstract::Number(Level::new(1, span, Cause::State)),
                BindingKind::Field => Abstract::Number(Level::new(1, span, Cause::Field)),
                BindingKind::Param | BindingKind::Const
                    if binding.value.is_none() || of_interface && is_parameter(binding) =>
                {
                    let ty = self
                        .checker
                        .member_type(id, name, member, binding.name.span);
                    self.given(&ty)
                }
                // The output of an interface has the highest level that a law may give it outside of outputs.
                BindingKind::Output if binding.value.is_none() => {
                    Abstract::Number(Level::new(1, span, Cause::Velocity))
                }
                _ => self.remembered(class, name, |levels| levels.binding(&place, binding)),
            },
            // the class gives it, and no class is known here
            Member::Function(_) if is_asked(member) => Abstract::Unknown,
            Member::Function(function) => self.function(function, place, (class, name)),
            Member::Table(_) => Abstract::Unknown,
            Member::Length(_) => Abstract::Number(FREE),
            Member::Reaction(_) => Abstract::Number(Level::new(2, span, Cause::Reaction)),
            Member::Declaration(declaration) => match declaration.kind {
                Kind::Body | Kind::Flexible => Abstract::Body,
                Kind::Marker => Abstract::Marker,
                _ => {
                    let ty = self
                        .checker
                        .member_type(id, name, member, declaration.name.span);
                    self.given(&ty)
                }
            },
        }
    }

    /// A function of the text. The value of `fn burn = wiebe(shape: 2)` is remembered under its key.
    fn function(
        &mut self,
        function: &'p Function,
        place: Place<'p>,
        (id, name): (DefinitionId, &str),
    ) -> Abstract<'p> {
        match &function.value {
            Some(value) if function.bound => {
                self.remembered(id, name, |levels| levels.value(&place, value))
            }
            _ => Abstract::Function(function, Rc::new(place)),
        }
    }

    fn binding(&mut self, place: &Place<'p>, binding: &'p Binding) -> Abstract<'p> {
        let Some(value) = &binding.value else {
            return Abstract::Number(FREE);
        };
        let mut inner = place.clone();
        self.bind(&mut inner, &binding.index);
        self.value(&inner, value)
    }

    /// The level of a value of which only the type is known.
    fn given(&mut self, ty: &Type) -> Abstract<'p> {
        match ty {
            Type::Marker => Abstract::Marker,
            Type::Body(_) => Abstract::Body,
            Type::Cycle => Abstract::Cycle,
            Type::Function(_) => Abstract::Unknown,
            Type::List { element, .. } | Type::Range(element) => self.given(element),
            Type::Class(id) | Type::ClassOf(id) => Abstract::Class(*id),
            Type::Instance(id) | Type::InstanceOf(id) => {
                match self.checker.declaration(*id).map(|d| d.kind) {
                    Some(Kind::Record) => Abstract::Record(*id, Rc::new(BTreeMap::new())),
                    _ => Abstract::Instance(*id),
                }
            }
            _ => Abstract::Number(FREE),
        }
    }

    fn field(&mut self, base: Abstract<'p>, name: &Name) -> Abstract<'p> {
        match base {
            Abstract::Number(level) => Abstract::Number(level),
            Abstract::Marker => Abstract::Number(match name.text.as_str() {
                "velocity" | "angular_velocity" => Level::new(1, name.span, Cause::Velocity),
                "acceleration" | "angular_acceleration" => {
                    Level::new(2, name.span, Cause::Acceleration)
                }
                _ => POSITION,
            }),
            Abstract::Body if name.text == "mass" => Abstract::Number(FREE),
            Abstract::Body => Abstract::Marker,
            Abstract::Cycle if name.text == "angle" => Abstract::Number(POSITION),
            Abstract::Cycle => Abstract::Number(FREE),
            Abstract::Record(id, fields) => {
                if let Some(value) = fields.get(&name.text) {
                    return value.clone();
                }
                let Some(OwnedMember { home, member }) = self.checker.owned_member(id, &name.text)
                else {
                    return Abstract::Number(FREE);
                };
                let place = Place {
                    locals: fields.iter().map(|(n, v)| (n.clone(), v.clone())).collect(),
                    ..Place::in_class(home, id)
                };
                match member {
                    Member::Function(function) => Abstract::Function(function, Rc::new(place)),
                    Member::Binding(binding) => self.binding(&place, binding),
                    _ => Abstract::Number(FREE),
                }
            }
            Abstract::Instance(id) => match self.checker.owned_member(id, &name.text) {
                Some(owned) => self.member(id, &name.text, owned, name.span),
                None => Abstract::Number(FREE),
            },
            Abstract::Class(_)
            | Abstract::Function(..)
            | Abstract::Partial(..)
            | Abstract::Unknown => Abstract::Number(FREE),
        }
    }

    fn call(
        &mut self,
        place: &Place<'p>,
        callee: &Expr,
        arguments: &[Argument],
        span: Span,
    ) -> Abstract<'p> {
        let values: Vec<(Option<&str>, Abstract<'p>)> = arguments
            .iter()
            .map(|argument| {
                let name = argument.name.as_ref().map(|n| n.text.as_str());
                (name, self.value(place, &argument.value))
            })
            .collect();
        let all = values
            .iter()
            .fold(FREE, |level, (_, value)| level.with(value.level()));
        if let ExprKind::Name(name) = &callee.kind
            && crate::functions::find(name).is_some()
        {
            let own = matches!(
                self.name(place, name, callee.span),
                Abstract::Function(..) | Abstract::Partial(..) | Abstract::Class(_)
            );
            if !own {
                return Abstract::Number(match name.as_str() {
                    "der" => all.rate(span),
                    "length" => FREE,
                    // a number, if the quantity itself is known in a turn without forces
                    "largest" | "smallest" | "where_largest" if all.order <= 1 => FREE,
                    _ => all,
                });
            }
        }
        let called = self.value(place, callee);
        if self.checker.findings.bound.contains(&span) {
            let named = values.into_iter();
            let named = named.filter_map(|(name, value)| Some((name?.to_owned(), value)));
            return Abstract::Partial(Rc::new(called), Rc::new(named.collect()));
        }
        self.called(called, values, all)
    }

    fn called(
        &mut self,
        called: Abstract<'p>,
        values: Vec<(Option<&str>, Abstract<'p>)>,
        all: Level,
    ) -> Abstract<'p> {
        match called {
            Abstract::Function(function, defined) => self.follow(function, &defined, values, all),
            Abstract::Partial(inner, given) => {
                let all = given
                    .iter()
                    .fold(all, |all, (_, value)| all.with(value.level()));
                let given: Vec<(String, Abstract<'p>)> = Vec::clone(&given);
                let named = given
                    .iter()
                    .map(|(name, value)| (Some(name.as_str()), value.clone()));
                let mut values = values;
                values.extend(named);
                self.called(Abstract::clone(&inner), values, all)
            }
            Abstract::Class(id) => {
                let slots: Vec<String> = self
                    .checker
                    .slots_of(id)
                    .into_iter()
                    .map(|slot| slot.name)
                    .collect();
                let mut fields = BTreeMap::new();
                let mut position = 0;
                for (name, value) in values {
                    let name = match name {
                        Some(name) => Some(name.to_owned()),
                        None => {
                            position += 1;
                            slots.get(position - 1).cloned()
                        }
                    };
                    if let Some(name) = name {
                        fields.insert(name, value);
                    }
                }
                Abstract::Record(id, Rc::new(fields))
            }
            _ => Abstract::Number(all),
        }
    }

    /// The value of a function for these arguments.
    fn follow(
        &mut self,
        function: &'p Function,
        defined: &Place<'p>,
        values: Vec<(Option<&str>, Abstract<'p>)>,
        all: Level,
    ) -> Abstract<'p> {
        self.calls += 1;
        if self.calls > MOST_CALLS || self.depth > super::DEEPEST_VALUES {
            return Abstract::Number(all);
        }
        self.depth += 1;
        let mut inner = defined.clone();
        let mut given: Vec<&str> = Vec::new();
        // arguments by place belong to the parameters without an argument by name
        let named: Vec<&str> = values.iter().filter_map(|(name, _)| *name).collect();
        let mut by_place = function
            .parameters
            .iter()
            .map(|p| p.name.text.as_str())
            .filter(|name| !named.contains(name));
        for (name, value) in &values {
            let name = match name {
                Some(name) => Some(*name),
                None => by_place.next(),
            };
            if let Some(name) = name {
                given.push(name);
                inner.locals.push((name.to_owned(), value.clone()));
            }
        }
        for parameter in &function.parameters {
            if !given.contains(&parameter.name.text.as_str())
                && let Some(default) = &parameter.default
            {
                let value = self.value(defined, default);
                inner.locals.push((parameter.name.text.clone(), value));
            }
        }
        for binding in &function.lets {
            let value = self.binding(&inner, binding);
            inner.locals.push((binding.name.text.clone(), value));
        }
        let value = match &function.value {
            Some(value) => self.value(&inner, value),
            None => Abstract::Number(all),
        };
        self.depth -= 1;
        value
    }
}
