//! The dimension that a place of a text needs, for the units that come first.

use super::index::{Found, Index, What};
use super::place::{Path, call_around, path_at};
use eng_compiler::program::Program;
use eng_grammar::ast::{ItemKind, TypeExpr, TypeExprKind};
use eng_grammar::{Diagnostics, SourceId, parse};
use eng_system::Dimension;

/// The dimension of the argument at a place, otherwise the one that its line states.
pub(super) fn dimension_at(
    index: &Index<'_>,
    program: &Program,
    text: &str,
    place: usize,
) -> Option<Dimension> {
    if let Some(callee) = call_around(text, place) {
        let parameter = parameter(index, &callee, text, place)?;
        return dimension(program, type_of(parameter)?);
    }
    let before = text.get(..place)?;
    let line = before.rsplit('\n').next()?;
    let (_, stated) = line.split_once(':')?;
    // in `param length: Length = 400 ` the type stands between the signs, and is parsed alone
    let stated = stated.split('=').next()?;
    let item = format!("param it: {stated} = 1\n");
    let file = parse(&item, SourceId(0), &mut Diagnostics::new());
    match &file.items.first()?.kind {
        ItemKind::Binding(binding) => dimension(program, binding.ty.as_ref()?),
        _ => None,
    }
}

/// The parameter of the argument at a place in a call.
fn parameter<'i>(
    index: &'i Index<'_>,
    callee: &Path,
    text: &str,
    place: usize,
) -> Option<Found<'i>> {
    let class = index.resolve(&callee.names, callee.start)?;
    let mut parameters = index.parameters(class).into_iter();
    let (count, argument) = argument(text.get(callee.end + 1..place)?);
    match argument.split_once(':') {
        Some((name, _)) => parameters.find(|one| one.name().text == name.trim()),
        None => parameters.nth(count),
    }
}

/// The number of the arguments before the last one, and the last one's text. The text begins after the parenthesis
/// of a call.
pub fn argument(text: &str) -> (usize, &str) {
    let (mut depth, mut count, mut start) = (0usize, 0, 0);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            b',' if depth == 0 => {
                count += 1;
                start = at + 1;
            }
            _ => {}
        }
    }
    (count, text.get(start..).unwrap_or(""))
}

fn type_of(found: Found<'_>) -> Option<&TypeExpr> {
    match found.what {
        What::Parameter(parameter) => Some(&parameter.ty),
        What::Name(_) => None,
        What::Item(item, _) => match &item.kind {
            ItemKind::Binding(binding) => binding.ty.as_ref(),
            _ => None,
        },
    }
}

/// The dimension of a type: of its components or elements for a vector or an array.
fn dimension(program: &Program, ty: &TypeExpr) -> Option<Dimension> {
    match &ty.kind {
        TypeExprKind::Name(name) => {
            let named = program.dimensions.get(&name.text)?;
            Some(named.dimension)
        }
        TypeExprKind::One => Some(Dimension::ONE),
        TypeExprKind::Generic(_, inner) => dimension(program, inner.first()?),
        TypeExprKind::Array(inner, _) => dimension(program, inner),
        TypeExprKind::Product(left, right) => {
            Some(dimension(program, left)?.times(dimension(program, right)?))
        }
        TypeExprKind::Quotient(left, right) => {
            Some(dimension(program, left)?.over(dimension(program, right)?))
        }
        TypeExprKind::Power(base, numerator, denominator) => {
            dimension(program, base)?.power(*numerator, *denominator)
        }
        TypeExprKind::Function(..) | TypeExprKind::Error => None,
    }
}

/// Whether a place in a call begins an argument, so that the names of arguments may come next.
pub fn begins_argument(text: &str, place: usize) -> bool {
    let Some(callee) = call_around(text, place) else {
        return false;
    };
    let start = path_at(text, place).map_or(place, |path| path.start);
    let before = text.get(callee.end + 1..start).unwrap_or("");
    argument(before).1.trim().is_empty()
}
