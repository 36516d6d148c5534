//! The text of a class: its own, and that of its interfaces.
//!
//! The parts of a class come in the order of its lineage: those of the most general interface first. Each part
//! keeps its place, and the names in it have the meaning that they have there.

use super::settable;
use crate::program::{DefinitionId, Program};
use eng_grammar::Span;
use eng_grammar::ast::{
    Binding, BindingKind, Block, Declaration, Expr, ExprKind, Form, ItemKind, Kind, Name, TypeExpr,
    TypeExprKind, UnitExpr,
};
use std::collections::BTreeSet;

/// One definition of a lineage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level<'p> {
    pub definition: DefinitionId,
    pub declaration: &'p Declaration,
    pub block: &'p Block,
}

/// The definitions of a class or record with their blocks: its interfaces, the eldest first, then itself.
pub(crate) fn levels(program: &Program, id: DefinitionId) -> Vec<Level<'_>> {
    let definitions = program.lineage(id).into_iter();
    let level = |definition| {
        let declaration = program.declaration(definition)?;
        let (Form::Class { block, .. } | Form::Plain { block, .. }) = &declaration.form else {
            return None;
        };
        Some(Level {
            definition,
            declaration,
            block,
        })
    };
    definitions.filter_map(level).collect()
}

/// A parameter of a class, from its own list or from an interface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClassParameter<'p> {
    /// The definition that declares it.
    pub home: DefinitionId,
    pub name: &'p Name,
    pub ty: &'p TypeExpr,
    pub default: Option<&'p Expr>,
    pub limits: Option<&'p (Expr, Expr)>,
    /// The unit that the text states for tables.
    pub display: Option<&'p UnitExpr>,
    pub span: Span,
}

/// Whether a value of an interface is a parameter of its classes.
pub(crate) fn is_parameter(binding: &Binding) -> bool {
    match binding.kind {
        BindingKind::Param => true,
        BindingKind::Const => binding.value.is_none(),
        BindingKind::Input
        | BindingKind::Let
        | BindingKind::State
        | BindingKind::Field
        | BindingKind::Output => false,
    }
}

/// Whether an item of an interface only requires an item of the class: a parameter, output or function without
/// a value.
pub(crate) fn asks(item: &ItemKind) -> bool {
    match item {
        ItemKind::Binding(binding) => binding.value.is_none(),
        ItemKind::Function(function) => function.value.is_none(),
        _ => false,
    }
}

/// Whether an interface, with the one that it extends, has nothing but functions. Records fill it.
pub(crate) fn has_functions_only(program: &Program, interface: DefinitionId) -> bool {
    let levels = levels(program, interface);
    let mut items = levels
        .iter()
        .flat_map(|level| &level.block.items)
        .peekable();
    items.peek().is_some()
        && items.all(|item| matches!(item.kind, ItemKind::Function(_) | ItemKind::Error))
}

/// The class that `part name = Class(…)` names, if it is a definition.
pub(crate) fn used_class(
    program: &Program,
    module: u32,
    declaration: &Declaration,
) -> Option<DefinitionId> {
    let Form::Instance { value, .. } = &declaration.form else {
        return None;
    };
    let ExprKind::Call { callee, .. } = &value.kind else {
        return None;
    };
    match &callee.kind {
        ExprKind::Name(name) => program.lookup(module, name),
        _ => None,
    }
}

/// Whether a model or component states a cycle, itself or in its parts. A part whose class is a parameter
/// states none.
pub(crate) fn has_cycle(program: &Program, id: DefinitionId) -> bool {
    let mut waiting = vec![id];
    let mut seen = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        if !seen.insert(id) {
            continue;
        }
        // a class with arguments: `component Engine = Crank(throw: 40 mm)`
        let declaration = program.declaration(id);
        waiting.extend(declaration.and_then(|known| used_class(program, id.module, known)));
        for item in levels(program, id)
            .iter()
            .flat_map(|level| &level.block.items)
        {
            let ItemKind::Declaration(inner) = &item.kind else {
                continue;
            };
            match inner.kind {
                Kind::Cycle => return true,
                Kind::Part => waiting.extend(used_class(program, id.module, inner)),
                _ => {}
            }
        }
    }
    false
}

/// Whether a type is `Int`.
pub(crate) fn is_int(ty: &TypeExpr) -> bool {
    matches!(&ty.kind, TypeExprKind::Name(name) if name.text == "Int")
}

/// The word that is the length of an array, with its place: `n` of `Length[n]`.
pub(crate) fn word_of_length(ty: &TypeExpr) -> Option<(&String, Span)> {
    match &ty.kind {
        TypeExprKind::Array(_, length) => match &length.kind {
            ExprKind::Name(name) => Some((name, length.span)),
            _ => None,
        },
        _ => None,
    }
}

/// The parameters of a class or interface in their order: those of its interface, then those that it adds. If a class
/// repeats all parameters of its interface, the order is that of its own list.
pub(crate) fn parameters(program: &Program, id: DefinitionId) -> Vec<ClassParameter<'_>> {
    let mut found: Vec<ClassParameter<'_>> = Vec::new();
    for level in levels(program, id) {
        let mut own = parameters_of(level);
        let place = |own: &[ClassParameter<'_>], elder: &ClassParameter<'_>| {
            own.iter().position(|own| own.name.text == elder.name.text)
        };
        if found.iter().any(|elder| place(&own, elder).is_none()) {
            for elder in &mut found {
                if let Some(at) = place(&own, elder) {
                    *elder = own.remove(at);
                }
            }
            found.extend(own);
        } else {
            found = own;
        }
    }
    found
}

fn parameters_of(level: Level<'_>) -> Vec<ClassParameter<'_>> {
    let home = level.definition;
    match &level.declaration.form {
        Form::Class { parameters, .. } => parameters
            .iter()
            .map(|parameter| ClassParameter {
                home,
                name: &parameter.name,
                ty: &parameter.ty,
                default: parameter.default.as_ref(),
                limits: parameter.limits.as_ref(),
                display: None,
                span: parameter.span,
            })
            .collect(),
        _ if level.declaration.kind == Kind::Interface => settable(level.declaration)
            .filter(|binding| is_parameter(binding))
            .filter_map(|binding| {
                Some(ClassParameter {
                    home,
                    name: &binding.name,
                    ty: binding.ty.as_ref()?,
                    default: binding.value.as_ref(),
                    limits: binding.limits.as_ref(),
                    display: binding.display.as_ref(),
                    span: binding.name.span,
                })
            })
            .collect(),
        _ => Vec::new(),
    }
}
