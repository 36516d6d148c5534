//! Types as written, and declarations with types: bindings, parameters, functions.

use super::Checker;
use super::member::Member;
use super::mismatch::Due;
use super::scope::{Found, Scope};
use super::types::{Dim, FunctionParameter, Kind as PointKind, Quantity, Signature, Type};
use crate::codes;
use crate::program::unit_text;
use crate::resolve::suggest::{EXPLAINED, nearest};
use crate::typed::lineage::{has_functions_only, is_parameter};
use eng_grammar::ast::{
    Binding, BindingKind, Expr, ExprKind, IndexArgument, ItemKind, Kind, Name, Parameter, TypeExpr,
    TypeExprKind,
};
use eng_grammar::{Diagnostic, Span};
use std::sync::Arc;

/// Types of the language itself.
const BUILT_IN_TYPES: [&str; 9] = [
    "Int", "Bool", "Text", "Vector", "Vector2", "Vector3", "Marker", "Body", "ModeSet",
];

/// Most records inside of each other that are searched for structure. A choice: texts have two or three.
const MOST_LEVELS: usize = 8;

/// The unit of an expression, if it is a literal.
pub(super) fn written_unit(expr: &Expr) -> Option<String> {
    match &expr.kind {
        ExprKind::Number { unit, .. } | ExprKind::List { unit, .. } => unit.as_ref().map(unit_text),
        ExprKind::Paren { inner, unit } => {
            unit.as_ref().map(unit_text).or_else(|| written_unit(inner))
        }
        ExprKind::Unary { operand, .. } => written_unit(operand),
        _ => None,
    }
}

impl<'p> Checker<'p> {
    /// The type as written. Stores it in the findings.
    pub(super) fn ty(&mut self, scope: &Scope<'p>, ty: &TypeExpr) -> Type {
        let found = self.type_of_text(scope, ty);
        self.findings.types.insert(ty.span, found.clone());
        found
    }

    fn type_of_text(&mut self, scope: &Scope<'p>, ty: &TypeExpr) -> Type {
        match &ty.kind {
            TypeExprKind::Error => Type::Error,
            TypeExprKind::One => Type::one(),
            TypeExprKind::Name(name) => self.named_type(scope, name),
            TypeExprKind::Generic(name, arguments) => {
                let length = match name.text.as_str() {
                    "Vector" => None,
                    "Vector2" => Some(2),
                    "Vector3" => Some(3),
                    _ => {
                        self.unknown_type(scope, name);
                        return Type::Error;
                    }
                };
                let [argument] = arguments.as_slice() else {
                    self.report(
                        Diagnostic::error(
                            codes::UNKNOWN_TYPE,
                            format!(
                                "`{}` takes one dimension, that of its components",
                                name.text
                            ),
                        )
                        .at(ty.span, format!("{} are given", arguments.len())),
                    );
                    return Type::Error;
                };
                let Some(quantity) = self.quantity(scope, argument) else {
                    return Type::Error;
                };
                match length {
                    None => Type::vector(quantity),
                    length => Type::list(Type::Scalar(quantity), length),
                }
            }
            TypeExprKind::Array(element, length) => {
                let element = self.ty(scope, element);
                self.expect(
                    scope,
                    length,
                    &Type::Int,
                    &Due::new("the length of an array"),
                );
                let known = match &length.kind {
                    ExprKind::Number {
                        value,
                        integer: true,
                        unit: None,
                    } if *value >= 0.0 => Some(*value as u32),
                    _ => None,
                };
                self.structural(scope, length);
                if element.is_error() {
                    Type::Error
                } else {
                    Type::list(element, known)
                }
            }
            TypeExprKind::Product(..) | TypeExprKind::Quotient(..) | TypeExprKind::Power(..) => {
                match self.quantity(scope, ty) {
                    Some(quantity) => Type::Scalar(quantity),
                    None => Type::Error,
                }
            }
            TypeExprKind::Function(parameters, result) => {
                let parameters = parameters
                    .iter()
                    .map(|parameter| FunctionParameter {
                        name: String::new(),
                        ty: self.ty(scope, parameter),
                        optional: false,
                        span: parameter.span,
                    })
                    .collect();
                Type::Function(Arc::new(Signature {
                    name: String::new(),
                    parameters,
                    result: self.ty(scope, result),
                }))
            }
        }
    }

    fn named_type(&mut self, scope: &Scope<'p>, name: &Name) -> Type {
        if let Some((_, number)) = scope.generics.iter().find(|(n, _)| *n == name.text) {
            return Type::Scalar(Quantity {
                dim: Dim::variable(*number),
                soft: false,
                kind: PointKind::Any,
            });
        }
        match name.text.as_str() {
            "Int" => return Type::Int,
            "Bool" => return Type::Bool,
            "Text" => return Type::Text,
            "Marker" => return Type::Marker,
            "Body" => return Type::Body(None),
            "ModeSet" => return Type::ModeSet,
            "Vector" | "Vector2" | "Vector3" => {
                self.report(
                    Diagnostic::error(
                        codes::UNKNOWN_TYPE,
                        format!("`{}` needs the dimension of its components", name.text),
                    )
                    .at(name.span, "of what?")
                    .with_help(format!("for instance `{}<Length>`", name.text)),
                );
                return Type::Error;
            }
            _ => {}
        }
        if let Some(id) = self.find_top(scope.module, &name.text)
            && let Some(item) = self.program.item(id)
        {
            match &item.kind {
                ItemKind::Declaration(declaration) => match declaration.kind {
                    // records fill an interface of functions
                    Kind::Interface if has_functions_only(self.program, id) => {
                        return Type::InstanceOf(id);
                    }
                    Kind::Interface => return Type::ClassOf(id),
                    Kind::Model | Kind::Analysis | Kind::Default | Kind::Flexible => {}
                    _ => {
                        return match self.top_type(id, name.span) {
                            Type::Bound(bound) => Type::Instance(bound.class),
                            Type::Error => Type::Error,
                            _ => Type::Instance(id),
                        };
                    }
                },
                ItemKind::Dimension(_) => return self.dimension(&name.text),
                ItemKind::Choice(_) => return Type::Choice(id),
                _ => {}
            }
        }
        if self.program.dimensions.contains_key(&name.text) {
            return self.dimension(&name.text);
        }
        let defined = self.program.modules.iter().any(|module| {
            module.file.items.iter().any(
                |item| matches!(&item.kind, ItemKind::Dimension(d) if d.name.text == name.text),
            )
        });
        if !defined {
            self.unknown_type(scope, name);
        }
        Type::Error
    }

    fn dimension(&self, name: &str) -> Type {
        let Some(named) = self.program.dimensions.get(name) else {
            return Type::Error;
        };
        let kind = match named.point_of {
            Some(_) => PointKind::Point(name.into()),
            None => self.kind_of(&Dim::known(named.dimension)),
        };
        Type::Scalar(Quantity {
            kind,
            ..Quantity::hard(named.dimension)
        })
    }

    /// The kind of a value declared by a dimension that is no point. If the dimension has points, the value
    /// is a difference of them, whatever the name of the dimension.
    fn kind_of(&self, dim: &Dim) -> PointKind {
        let has_points = dim.is_known()
            && self
                .program
                .dimensions
                .values()
                .any(|other| other.point_of.is_some() && other.dimension == dim.base);
        if has_points {
            PointKind::Difference
        } else {
            PointKind::Any
        }
    }

    fn unknown_type(&mut self, scope: &Scope<'p>, name: &Name) {
        let mut message = Diagnostic::error(
            codes::UNKNOWN_TYPE,
            format!("there is no type `{}`", name.text),
        )
        .at(name.span, "neither a type nor a dimension");
        if self.diagnostics.len() > EXPLAINED {
            return self.report(message);
        }
        let mut known: Vec<&str> = BUILT_IN_TYPES.to_vec();
        known.extend(self.program.dimensions.keys().map(String::as_str));
        known.extend(scope.generics.iter().map(|(n, _)| n.as_str()));
        if let Some(module) = self.program.modules.get(scope.module as usize) {
            known.extend(module.scope.keys().map(String::as_str));
        }
        if let Some(offered) = self.program.offered.get(&name.text) {
            message = self.offer_use(message, scope.module, &offered.module, &name.text);
        } else if let Some(near) = nearest(&name.text, known) {
            message = message.meant(name.span, near);
        } else if let Some(unit) = self.program.units.get(&name.text) {
            let dimension = self.dimension_name(&Dim::known(unit.dimension));
            message = message.with_help(format!(
                "`{}` is a unit; its dimension is {dimension}",
                name.text
            ));
        }
        self.report(message);
    }

    /// The quantity of a type that must be a dimension.
    fn quantity(&mut self, scope: &Scope<'p>, ty: &TypeExpr) -> Option<Quantity> {
        match &ty.kind {
            TypeExprKind::Product(left, right) | TypeExprKind::Quotient(left, right) => {
                let (left, right) = (self.quantity(scope, left), self.quantity(scope, right));
                let (left, right) = (left?.dim, right?.dim);
                let dim = match &ty.kind {
                    TypeExprKind::Product(..) => left.times(&right),
                    _ => left.over(&right),
                };
                Some(Quantity {
                    kind: self.kind_of(&dim),
                    dim,
                    soft: false,
                })
            }
            TypeExprKind::Power(base, numerator, denominator) => {
                let base = self.quantity(scope, base)?;
                let Some(dim) = base.dim.power(*numerator, *denominator) else {
                    self.report(
                        Diagnostic::error(codes::POWER, "this power has no dimension")
                            .at(ty.span, "not a ratio of small whole numbers"),
                    );
                    return None;
                };
                Some(Quantity {
                    kind: self.kind_of(&dim),
                    dim,
                    soft: false,
                })
            }
            _ => match self.ty(scope, ty) {
                Type::Scalar(quantity) => Some(quantity),
                Type::Error => None,
                other => {
                    let found = self.describe(&other);
                    self.report(
                        Diagnostic::error(codes::UNKNOWN_TYPE, "a dimension is expected here")
                            .at(ty.span, format!("this is {found}")),
                    );
                    None
                }
            },
        }
    }

    /// Refuses a `param` in an expression for a count, because counts must be known while compiling.
    pub(super) fn structural(&mut self, scope: &Scope<'p>, expr: &Expr) {
        let mut names: Vec<(String, Span)> = Vec::new();
        // the length of an array is known, whatever its elements are
        collect(expr, false, &mut names);
        for (name, span) in names {
            let binding = match self.find(scope, &name) {
                Some(Found::Member(_, Member::Binding(binding))) => Some(binding),
                Some(Found::Top(id)) => match self.program.item(id).map(|item| &item.kind) {
                    Some(ItemKind::Binding(binding)) => Some(binding),
                    _ => None,
                },
                _ => None,
            };
            let Some(binding) =
                binding.filter(|b| matches!(b.kind, BindingKind::Param | BindingKind::Input))
            else {
                continue;
            };
            // A count that is a `param` is refused at its declaration.
            let ty = self.name(scope, &name, span);
            if ty.is_error() || matches!(ty, Type::Int | Type::Bool | Type::Text | Type::Choice(_))
            {
                continue;
            }
            let message = Diagnostic::error(
                codes::STRUCTURAL,
                format!(
                    "a count depends on the {} `{name}`",
                    if binding.kind == BindingKind::Input {
                        "input"
                    } else {
                        "parameter"
                    }
                ),
            )
            .at(
                span,
                "a count must be a constant, because it decides how many items the compiler makes",
            )
            .also(
                binding.name.span,
                format!("declared as `{}` here", super::input::word(binding)),
            );
            let of_interface = (scope.definition.and_then(|id| self.declaration(id)))
                .is_some_and(|around| around.kind == Kind::Interface);
            self.report(match of_interface {
                true => message
                    .with_help("make it an `Int`, or count the elements of an array: `length(…)`"),
                false => self.const_instead(message, binding),
            });
        }
    }

    /// Adds the fix of writing `const` for `param`.
    fn const_instead(&self, message: Diagnostic, binding: &Binding) -> Diagnostic {
        let message = message.with_help("make it a `const`");
        let word = super::input::word(binding);
        let span = binding.name.span;
        let before = self
            .sources
            .get(span.source)
            .and_then(|source| source.text.get(..span.start as usize))
            .and_then(|text| text.rfind(word));
        message.with_each(before, |message, start| {
            message.with_fix(
                "write `const`",
                Span::new(span.source, start, start + word.len()),
                "const",
            )
        })
    }

    /// Checks a `const`, `param`, `let`, `state` or `output`, and gives its type.
    pub(super) fn binding(&mut self, outer: &Scope<'p>, binding: &Binding) -> Type {
        let mut scope = self.binders(outer, &binding.index);
        scope.output = binding.kind == BindingKind::Output;
        let declared = binding.ty.as_ref().map(|ty| self.ty(&scope, ty));
        if binding.kind == BindingKind::Field {
            self.binding_needs(outer, binding, declared.as_ref().unwrap_or(&Type::Error));
            return self.field_of_kernel(&scope, binding, declared.as_ref());
        }
        let due = || {
            let due = Due::new(format!("`{}`", binding.name.text));
            if let Some(ty) = &binding.ty {
                return due.declared(ty.span, "declared here");
            }
            due
        };
        let found = match (&binding.value, &declared) {
            (Some(value), Some(declared)) => {
                let plain = self.infer_as(&scope, value, declared);
                if matches!((&plain, declared), (Type::List { .. }, Type::Vector { .. }))
                    && binding.frame.is_some()
                {
                    self.report(
                        Diagnostic::error(
                            codes::FRAME,
                            format!(
                                "`{}` is a vector, but its value is a list of components",
                                binding.name.text
                            ),
                        )
                        .at(value.span, "along the stated axes, or along the ground's?")
                        .with_help("make a vector of it: `vector(components, marker)`"),
                    );
                    return Type::Error;
                }
                let found = self.fit(value, &plain, declared, &due());
                if found.is_error() {
                    // Readers of the binding use the declared type, so axes and units of the value do not
                    // matter.
                    self.binding_needs(outer, binding, declared);
                    return if declared.is_error() {
                        Type::Error
                    } else {
                        self.arrayed(&binding.index, declared.clone())
                    };
                }
                let set_by_use = is_parameter(binding) || binding.kind == BindingKind::Const;
                match declared {
                    // The type is the declared one, whatever the value; known lengths of lists add to it. An argument may have
                    // another length than the default.
                    Type::List { .. } if !set_by_use || outer.definition.is_none() => found,
                    _ => declared.clone(),
                }
            }
            (Some(value), None) => self.infer(&scope, value),
            (None, Some(declared)) => declared.clone(),
            (None, None) => Type::Error,
        };
        self.hides_word(&binding.name, &found);
        self.binding_needs(outer, binding, &found);
        let ty = self.output_axes(&scope, outer, binding, found);
        let ty = self.shown(binding, ty);
        if let Some(display) = &binding.display {
            self.display(&scope, &ty, display);
        }
        if binding.kind == BindingKind::State {
            if !self.single_state(binding, &ty) {
                return Type::Error;
            }
            self.scale_of_state(&scope, binding, &ty);
        }
        if binding.kind == BindingKind::Input {
            self.input(binding, &ty);
        }
        if let Some((low, high)) = &binding.limits {
            let due = Due::new(format!("the limit of `{}`", binding.name.text))
                .declared(binding.name.span, "the parameter");
            self.expect(&scope, low, &ty, &due);
            self.expect(&scope, high, &ty, &due);
        }
        if ty.is_error() {
            return Type::Error;
        }
        self.arrayed(&binding.index, ty)
    }

    /// The type of an output, which must be shown as columns of numbers.
    fn shown(&mut self, binding: &Binding, ty: Type) -> Type {
        if binding.kind != BindingKind::Output || ty.is_error() {
            return ty;
        }
        let numbers = match &ty {
            Type::List { element, .. } | Type::Range(element) => element.quantity().is_some(),
            Type::Vector { .. } | Type::Bool => true,
            other => other.quantity().is_some(),
        };
        if numbers {
            return ty;
        }
        let name = &binding.name.text;
        let place = binding
            .value
            .as_ref()
            .map(|v| v.span)
            .or(binding.ty.as_ref().map(|t| t.span))
            .unwrap_or(binding.name.span);
        let text = self.sources.text(place).to_owned();
        let due =
            format!("the output `{name}` is a number, a vector, a list of numbers or a comparison");
        let message = self.mistyped(place, &due, &ty);
        let message = match &ty {
            Type::Marker => message.with_help(format!(
                "show where it is, or how it turns: `output {name} = {text}.origin in ground as mm`"
            )),
            Type::Body(_) => message.with_help(format!(
                "show where its origin is: `output {name} = {text}.origin.origin in ground as mm`"
            )),
            Type::Function(_) => message.with_help(format!("call it: `{text}(…)`")),
            Type::Instance(_) | Type::InstanceOf(_) => {
                message.with_help(format!("show a value of it: `{text}.…`"))
            }
            Type::Cycle => message.with_help("show its angle: `cycle.angle`"),
            Type::List { element, .. } if matches!(**element, Type::Vector { .. }) => message
                .with_help(format!(
                    "one output each: `output {name}[i in 1..2] = … in ground`"
                )),
            _ => message,
        };
        self.report(message);
        Type::Error
    }

    /// Checks that a binding has the parts that its kind needs.
    fn binding_needs(&mut self, scope: &Scope<'p>, binding: &Binding, ty: &Type) {
        let around = scope
            .definition
            .and_then(|id| self.declaration(id))
            .map(|d| d.kind);
        let name = &binding.name;
        let needs_type = || {
            (
                "needs a type",
                format!("for instance `{}: Length`", name.text),
            )
        };
        if binding.value.is_some()
            && binding.ty.is_none()
            && around == Some(Kind::Interface)
            && is_parameter(binding)
        {
            let (what, help) = needs_type();
            self.report(
                Diagnostic::error(codes::MISSING_VALUE, format!("`{}` {what}", name.text))
                    .at(name.span, what)
                    .with_help(help),
            );
        }
        if binding.value.is_none() {
            let in_interface = around == Some(Kind::Interface);
            let without_value = match binding.kind {
                BindingKind::Const => matches!(around, Some(Kind::Model | Kind::Interface)),
                // A `param` at a wrong place gets only the message about its place.
                BindingKind::Param => around.is_some_and(|kind| kind != Kind::Component),
                BindingKind::Let => around == Some(Kind::Record),
                BindingKind::State | BindingKind::Field | BindingKind::Input => false,
                BindingKind::Output => in_interface,
            };
            let missing = match (without_value, &binding.ty) {
                (true, Some(_)) => None,
                (true, None) => Some(needs_type()),
                (false, _) => Some(("needs a value", format!("write `{} = …`", name.text))),
            };
            if let Some((what, help)) = missing {
                self.report(
                    Diagnostic::error(codes::MISSING_VALUE, format!("`{}` {what}", name.text))
                        .at(name.span, what)
                        .with_help(help),
                );
            }
        }
        if binding.kind == BindingKind::Param
            && around != Some(Kind::Interface)
            && let Some((field, of)) = self.structure_in(ty, MOST_LEVELS)
        {
            let found = self.describe(ty);
            let message = Diagnostic::error(
                codes::STRUCTURAL,
                format!(
                    "`{}` is {found} and cannot change without compiling again",
                    name.text
                ),
            )
            .at(name.span, format!("a `param` that is {found}"));
            let message = self.const_instead(message, binding);
            let message = match field.as_str() {
                "" => message,
                field => {
                    let of = self.describe(&of);
                    message.with_note(format!("`{}{field}` is {of}", name.text))
                }
            };
            let message = if *ty == Type::Int && binding.ty.is_none() {
                message.with_note(format!(
                    "a number that may change is written `{}: 1 = …`",
                    name.text
                ))
            } else {
                message
            };
            self.report(message);
        }
    }

    /// The part of a type whose value decides the structure of a model, so that it cannot be a parameter of a run. It
    /// is the type itself, that of the elements, or that of a field of a record. A field comes with its path `.law`.
    fn structure_in(&mut self, ty: &Type, levels: usize) -> Option<(String, Type)> {
        match ty {
            Type::Int
            | Type::Bool
            | Type::Text
            | Type::ModeSet
            | Type::Choice(_)
            | Type::Function(_)
            | Type::Class(_)
            | Type::ClassOf(_)
            | Type::InstanceOf(_)
            | Type::Bound(_) => Some((String::new(), ty.clone())),
            Type::List { element, .. } => self.structure_in(element, levels),
            Type::Instance(id) => {
                let levels = levels.checked_sub(1)?;
                self.declaration(*id).filter(|d| d.kind == Kind::Record)?;
                let mut fields = self.slots_of(*id).into_iter();
                fields.find_map(|field| {
                    let (inner, ty) = self.structure_in(&field.ty, levels)?;
                    Some((format!(".{}{inner}", field.name), ty))
                })
            }
            _ => None,
        }
    }

    /// An output's axes: `in shell`.
    fn output_axes(
        &mut self,
        scope: &Scope<'p>,
        outer: &Scope<'p>,
        binding: &Binding,
        ty: Type,
    ) -> Type {
        let Some(frame) = &binding.frame else {
            let asked_for = binding.value.is_none()
                && outer
                    .definition
                    .and_then(|id| self.declaration(id))
                    .is_some_and(|d| d.kind == Kind::Interface);
            if binding.kind == BindingKind::Output && !asked_for {
                let mut element = &ty;
                while let Type::List { element: inner, .. } = element {
                    element = inner;
                }
                if matches!(element, Type::Vector { framed: false, .. }) {
                    let place = binding.value.as_ref().map_or(binding.name.span, |v| v.span);
                    let end = Span::new(place.source, place.end as usize, place.end as usize);
                    self.report(
                        Diagnostic::error(
                            codes::OUTPUT_WITHOUT_FRAME,
                            format!(
                                "the output `{}` is a vector: along which axes?",
                                binding.name.text
                            ),
                        )
                        .at(place, "a vector carries no axes, a channel must state them")
                        .with_help(format!(
                            "for instance `output {} = … in ground`",
                            binding.name.text
                        ))
                        .with_fix(
                            "along the ground's axes",
                            end,
                            " in ground",
                        ),
                    );
                    return Type::Error;
                }
            }
            return ty;
        };
        let due = Due::new("the value after `in`");
        let marker = self.infer(scope, frame);
        if !marker.is_error() && marker != Type::Marker {
            let found = self.describe(&marker);
            let mut message = Diagnostic::error(
                codes::FRAME,
                format!("{} must be a marker, not {found}", due.what),
            )
            .at(frame.span, format!("this is {found}"));
            if let Type::Body(Some(body)) = &marker {
                let names = self.markers_of(body);
                message = message.with_help(format!(
                    "say which marker: {}",
                    crate::resolve::suggest::listing(names.iter().map(String::as_str), 8)
                ));
            }
            self.report(message);
        }
        match ty {
            Type::Error => Type::Error,
            Type::Vector { quantity, .. } => Type::Vector {
                quantity,
                framed: true,
            },
            // The components are along the stated axes.
            Type::List {
                ref element,
                length,
                ..
            } if ty.components().is_some() => Type::List {
                element: element.clone(),
                length,
                framed: true,
            },
            other => {
                let found = self.describe(&other);
                self.report(
                    Diagnostic::error(codes::FRAME, format!("{found} has no axes to be shown in"))
                        .at(frame.span, "only a vector is shown along axes")
                        .also(
                            binding.value.as_ref().map_or(binding.name.span, |v| v.span),
                            format!("this is {found}"),
                        ),
                );
                Type::Error
            }
        }
    }

    /// Checks a parameter of a class or function, and gives its type.
    pub(super) fn parameter(&mut self, scope: &Scope<'p>, parameter: &Parameter) -> Type {
        let ty = self.ty(scope, &parameter.ty);
        self.hides_word(&parameter.name, &ty);
        if let Some(default) = &parameter.default {
            let mut due = Due::new(format!("`{}`", parameter.name.text))
                .declared(parameter.ty.span, "declared here");
            due.unit = written_unit(default);
            self.expect(scope, default, &ty, &due);
        }
        if let Some((low, high)) = &parameter.limits {
            let due = Due::new(format!("the limit of `{}`", parameter.name.text))
                .declared(parameter.ty.span, "declared here");
            self.expect(scope, low, &ty, &due);
            self.expect(scope, high, &ty, &due);
        }
        ty
    }
}

/// All names that an expression reads.
pub(super) fn collect_names(expr: &Expr, names: &mut Vec<(String, Span)>) {
    collect(expr, true, names);
}

/// Collects the names in an expression; without `lengths`, not those in `length(…)`.
fn collect(expr: &Expr, lengths: bool, names: &mut Vec<(String, Span)>) {
    match &expr.kind {
        ExprKind::Name(name) => names.push((name.clone(), expr.span)),
        ExprKind::List { items, .. } => items.iter().for_each(|item| collect(item, lengths, names)),
        ExprKind::Comprehension { body, binders, .. } => {
            let mut inner = Vec::new();
            collect(body, lengths, &mut inner);
            inner.retain(|(name, _)| binders.iter().all(|binder| binder.name.text != *name));
            names.extend(inner);
            binders
                .iter()
                .for_each(|binder| collect(&binder.range, lengths, names));
        }
        ExprKind::Paren { inner, .. } => collect(inner, lengths, names),
        ExprKind::Field { base, .. } => collect(base, lengths, names),
        ExprKind::Call { callee, .. }
            if !lengths && matches!(&callee.kind, ExprKind::Name(name) if name == "length") => {}
        ExprKind::Call { callee, arguments } => {
            collect(callee, lengths, names);
            arguments
                .iter()
                .for_each(|argument| collect(&argument.value, lengths, names));
        }
        ExprKind::Index { base, indices } => {
            collect(base, lengths, names);
            for index in indices {
                if let IndexArgument::At(at) = index {
                    collect(at, lengths, names);
                }
            }
        }
        ExprKind::Unary { operand, .. } => collect(operand, lengths, names),
        ExprKind::Binary { left, right, .. } => {
            collect(left, lengths, names);
            collect(right, lengths, names);
        }
        ExprKind::If {
            condition,
            then,
            otherwise,
        } => {
            collect(condition, lengths, names);
            collect(then, lengths, names);
            if let Some(otherwise) = otherwise {
                collect(otherwise, lengths, names);
            }
        }
        ExprKind::Range { from, to, by } => {
            collect(from, lengths, names);
            collect(to, lengths, names);
            if let Some(by) = by {
                collect(by, lengths, names);
            }
        }
        ExprKind::Number { .. } | ExprKind::Text(_) | ExprKind::Bool(_) | ExprKind::Error => {}
    }
}
