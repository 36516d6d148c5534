//! Axes of vectors and of components: whether a value is a vector in space, and the axes of its numbers.

use super::scalar::{Scalar, Stage};
use super::value::{Axes, ScopeId, Shown, Value};
use super::{Elaborator, Eval};
use crate::codes;
use crate::ir::Op;
use crate::typed::types::{Kind, Type};
use eng_grammar::ast;
use eng_grammar::{Diagnostic, Span};
use eng_system::system::{BodyRef, Slot};

/// The meaning of several numbers together.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Sort {
    /// A vector in space: components in ground axes.
    Space,
    /// Components along known axes.
    Along(Axes),
    /// A list.
    Bare,
}

impl<'a> Elaborator<'a, '_> {
    /// A value for an operation in space. An output becomes the vector that it shows.
    pub fn in_space(&mut self, value: Value<'a>, span: Span) -> Eval<Value<'a>> {
        match value {
            Value::Shown(Shown {
                space: Some(space), ..
            }) => Ok(Value::Vector(space)),
            Value::Shown(shown) => self
                .space_of(shown.components, shown.axes, span)
                .map(Value::Vector),
            other => Ok(other),
        }
    }

    /// The vector of components along axes: `v = R c`, R the marker's rotation matrix to ground axes.
    pub fn space_of(
        &mut self,
        components: [Scalar; 3],
        axes: Axes,
        span: Span,
    ) -> Eval<[Scalar; 3]> {
        match axes {
            Axes::Ground => Ok(components),
            Axes::Marker(marker) => {
                let local = self.local_marker(marker, Some(span))?;
                Ok(self.rotate(local, &components))
            }
        }
    }

    /// Components of a vector in space along axes: `c = Rᵀ v`.
    pub fn along(&mut self, axes: Axes, v: &[Scalar; 3], span: Span) -> Eval<[Scalar; 3]> {
        match axes {
            Axes::Ground => Ok(*v),
            Axes::Marker(marker) => {
                let local = self.local_marker(marker, Some(span))?;
                Ok(self.along_axes(local, v))
            }
        }
    }

    /// Components of a vector along axes. Along the recorded axes they are the recorded components.
    pub fn components_along(
        &mut self,
        axes: Axes,
        value: Value<'a>,
        span: Span,
    ) -> Eval<[Scalar; 3]> {
        match value {
            Value::Shown(shown) if self.same_axes(shown.axes, axes) => Ok(shown.components),
            other => {
                let vector = self.as_vector(other, span)?;
                self.along(axes, &vector, span)
            }
        }
    }

    /// The marker, or the ground, whose axes an expression names.
    pub fn axes(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<Axes> {
        match self.evaluate(expr, scope)? {
            Value::Ground => Ok(Axes::Ground),
            other => self.as_marker(other, expr.span).map(Axes::Marker),
        }
    }

    /// Whether axes are parallel at all times for any parameters, to the last bit.
    pub fn same_axes(&self, a: Axes, b: Axes) -> bool {
        let rigid = |axes: Axes| match axes {
            Axes::Ground => true,
            Axes::Marker(m) => self.draft.markers[m as usize].shape.is_none(),
        };
        a == b || (rigid(a) && rigid(b) && self.parallel(a, b))
    }

    /// Whether the text states parallel axes: those of one body with one orientation. Markers of a flexible
    /// body count as parallel too, although its deformation turns them against each other.
    pub fn parallel(&self, a: Axes, b: Axes) -> bool {
        if a == b {
            return true;
        }
        let constants = self.graphs.bind.slots();
        let known = |slot: &Slot| {
            let node = constants.get(slot.0 as usize)?;
            self.graphs.bind.graph.as_constant(*node)
        };
        match (a, b) {
            (Axes::Ground, Axes::Ground) => true,
            (Axes::Ground, Axes::Marker(m)) | (Axes::Marker(m), Axes::Ground) => {
                let marker = &self.draft.markers[m as usize];
                let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
                let mut entries = identity.iter().zip(&marker.orientation);
                let turned = entries.any(|(one, slot)| known(slot) != Some(*one));
                marker.body == BodyRef::Ground && marker.placed_at.is_none() && !turned
            }
            (Axes::Marker(a), Axes::Marker(b)) => {
                // the position of `ground` as an argument is known only at the start
                let (a, b) = (
                    &self.draft.markers[a as usize],
                    &self.draft.markers[b as usize],
                );
                let placed = a.placed_at.is_some() || b.placed_at.is_some();
                a.body == b.body && a.orientation == b.orientation && !placed
            }
        }
    }

    /// The path of the owner of axes: `ground`, `block.main[1]`.
    pub fn axes_path(&self, axes: Axes) -> String {
        match axes {
            Axes::Ground => "ground".to_owned(),
            Axes::Marker(marker) => self.draft.markers[marker as usize].origin.path.clone(),
        }
    }

    /// The common axes of two values in an operation on components. Reports different axes.
    pub fn together(&mut self, (a, a_span): (Sort, Span), (b, b_span): (Sort, Span)) -> Eval<Sort> {
        match (a, b) {
            (Sort::Along(p), Sort::Along(q)) if !self.parallel(p, q) => {
                let (p, q) = (self.axes_path(p), self.axes_path(q));
                Err(self.report(
                    Diagnostic::error(
                        codes::OTHER_AXES,
                        "components along different axes are combined",
                    )
                    .at(b_span, format!("along the axes of {q}"))
                    .also(a_span, format!("along the axes of {p}"))
                    .with_help(format!(
                        "make vectors of both, `vector([x, y, z], marker)` with the marker of each: these are added in space; or take single components, `{}.x`",
                        self.sources.text(a_span)
                    )),
                ))
            }
            (Sort::Space, _) | (_, Sort::Space) => Ok(Sort::Space),
            (Sort::Along(axes), _) | (_, Sort::Along(axes)) => Ok(Sort::Along(axes)),
            (Sort::Bare, Sort::Bare) => Ok(Sort::Bare),
        }
    }

    /// The numbers of a vector or list, and their meaning.
    pub fn sorted(&mut self, value: Value<'a>, span: Span) -> Eval<(Vec<Scalar>, Sort)> {
        Ok(match self.in_space(value, span)? {
            Value::Vector(v) => (v.to_vec(), Sort::Space),
            Value::Components(c, axes) => (c, Sort::Along(axes)),
            other => (self.as_components(other, span)?, Sort::Bare),
        })
    }

    /// A value of one number for each pair of components. Both values have equal lengths and axes.
    pub fn pairwise(
        &mut self,
        (a, a_span): (Value<'a>, Span),
        (b, b_span): (Value<'a>, Span),
        mut number: impl FnMut(&mut Self, Scalar, Scalar) -> Scalar,
    ) -> Eval<Value<'a>> {
        let (x, p) = self.sorted(a, a_span)?;
        let (y, q) = self.sorted(b, b_span)?;
        if x.len() != y.len() {
            return Err(self.lengths(x.len(), a_span, y.len(), b_span));
        }
        let sort = self.together((p, a_span), (q, b_span))?;
        let pairs = x.into_iter().zip(y);
        let numbers = pairs.map(|(x, y)| number(self, x, y)).collect();
        Ok(Self::of_sort(numbers, sort))
    }

    /// The value of numbers with a meaning.
    pub fn of_sort(numbers: Vec<Scalar>, sort: Sort) -> Value<'a> {
        match (<[Scalar; 3]>::try_from(numbers), sort) {
            (Ok(v), Sort::Space) => Value::Vector(v),
            (Ok(v), Sort::Along(axes)) => Value::Components(v.to_vec(), axes),
            (Err(c), Sort::Along(axes)) => Value::Components(c, axes),
            (Ok(v), Sort::Bare) => Self::list(&v),
            (Err(c), _) => Self::list(&c),
        }
    }

    /// Components as a list of numbers.
    pub fn without_axes(value: Value<'a>) -> Value<'a> {
        match value {
            Value::Components(c, _) => Self::list(&c),
            other => other,
        }
    }

    /// A value read as its declared type. In place of a `Vector`, a list of three numbers is a vector in
    /// ground axes.
    pub fn declared(&mut self, value: Value<'a>, ty: Option<&ast::TypeExpr>) -> Eval<Value<'a>> {
        let Some(ty) = ty else { return Ok(value) };
        let ty = self.type_at(ty.span)?;
        Ok(self.read_as(value, &ty))
    }

    /// [`Elaborator::declared`] for a resolved type.
    pub fn read_as(&mut self, value: Value<'a>, ty: &Type) -> Value<'a> {
        match (ty, value) {
            (Type::Vector { .. }, Value::List(items)) => {
                let mut numbers = Vec::with_capacity(3);
                for item in &items {
                    match item {
                        Value::Scalar(s) => numbers.push(*s),
                        Value::Int(i) => numbers.push(self.graphs.constant(*i as f64)),
                        _ => return Value::List(items),
                    }
                }
                match <[Scalar; 3]>::try_from(numbers) {
                    Ok(v) => Value::Vector(v),
                    Err(_) => Value::List(items),
                }
            }
            (Type::Scalar(quantity), Value::Scalar(s)) => {
                if let Kind::Point(_) = quantity.kind {
                    self.counted_from_a_zero(s);
                }
                Value::Scalar(s)
            }
            (Type::List { element, .. }, Value::List(items)) => Value::List(
                items
                    .into_iter()
                    .map(|item| self.read_as(item, element))
                    .collect(),
            ),
            (_, value) => value,
        }
    }

    /// Notes that a parameter is declared as a point, so `--set` may use units with a shifted zero.
    fn counted_from_a_zero(&mut self, value: Scalar) {
        if value.stage == Stage::Bind
            && let Op::Input(index) = self.graphs.bind.graph.op(value.node)
            && let Some(parameter) = self.draft.parameters.get_mut(index as usize)
        {
            parameter.point = true;
        }
    }

    /// The value of an output with its stated axes. The numbers of a list are then components along these
    /// axes.
    pub fn shown(&mut self, value: Value<'a>, axes: Axes, span: Span) -> Eval<Value<'a>> {
        Ok(match value {
            Value::Vector(space) => Value::Shown(Shown {
                components: self.along(axes, &space, span)?,
                axes,
                space: Some(space),
            }),
            Value::Shown(shown) if self.same_axes(shown.axes, axes) => {
                Value::Shown(Shown { axes, ..shown })
            }
            Value::Shown(_) => {
                let space = self.in_space(value, span)?;
                return self.shown(space, axes, span);
            }
            Value::Components(c, own) => {
                if !self.parallel(own, axes) {
                    let (own, axes) = (self.axes_path(own), self.axes_path(axes));
                    return Err(self.report(
                        Diagnostic::error(
                            codes::OTHER_AXES,
                            format!("components along the axes of {own} are shown as those along {axes}"),
                        )
                        .at(span, "`in` turns vectors, not components")
                        .with_help("make a vector of them: `vector([x, y, z], marker)` with the marker along whose axes they are"),
                    ));
                }
                Value::Components(c, axes)
            }
            Value::List(items) => {
                let numbers = self.as_components(Value::List(items), span)?;
                Value::Components(numbers, axes)
            }
            other => other,
        })
    }
}
