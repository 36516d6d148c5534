//! Evaluation of the functions of the language.

use super::axes::Sort;
use super::scalar::{GraphBuilder, Scalar, Stage};
use super::typed::MarkerIndex;
use super::value::{Axes, ScopeId, Value};
use super::{Elaborator, Eval};
use crate::codes;
use crate::functions::{BuiltIn, Kind};
use crate::ir::{Graph, Node, Op};
use crate::typed::types::Type;
use eng_grammar::ast;
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;
use eng_system::elementary::Elementary;
use eng_system::significant::short;

/// The whole numbers of arguments that are counts or lists of counts; `None` if another number is among them.
fn whole_numbers(values: &[(Value<'_>, Span)]) -> Option<Vec<i64>> {
    let mut found = Vec::new();
    for (value, _) in values {
        match value {
            Value::Int(i) => found.push(*i),
            Value::List(items) => {
                for item in items {
                    let Value::Int(i) = item else { return None };
                    found.push(*i);
                }
            }
            _ => return None,
        }
    }
    Some(found)
}

impl<'a> Elaborator<'a, '_> {
    /// Warns of `cos(16)`: a number of the text that is more than a turn in rad and has no unit of angle.
    fn angle_without_unit(
        &mut self,
        name: &str,
        x: Scalar,
        argument: Span,
        span: Span,
        scope: ScopeId,
    ) -> Eval<()> {
        let known = match x.stage {
            Stage::Bind => self.graphs.bind.graph.as_constant(x.node),
            Stage::Motion => None,
        };
        let Some(value) = known.filter(|value| value.abs() > std::f64::consts::TAU) else {
            return Ok(());
        };
        let path = self.scope(scope).path.clone();
        if self.dimension_at(argument, scope)? == Dimension::ANGLE
            || self.accepts(eng_system::lint::TURNS, &path)
            || !self.turns_reported.insert(span)
        {
            return Ok(());
        }
        let turns = value.abs() / std::f64::consts::TAU;
        let shown = format!("{value:.6}");
        let shown = shown.trim_end_matches('0').trim_end_matches('.');
        self.diagnostics.push(
            Diagnostic::warning(
                codes::MANY_TURNS,
                format!(
                    "`{name}` of {shown}, which is no angle: it is taken in rad, {turns:.1} turns"
                ),
            )
            .at(span, "are degrees meant?")
            .with_help("give the angle its unit where it is stated: `deg` or `rad`")
            .acceptable(eng_system::lint::TURNS),
        );
        Ok(())
    }

    pub fn builtin(
        &mut self,
        function: &BuiltIn,
        span: Span,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        // `der` changes the evaluation of its argument, so it comes before the arguments
        if let Kind::Rate = function.kind {
            return self.rate(span, arguments, scope);
        }
        let name = function.name;
        if let Kind::Turn = function.kind {
            return self.of_turn(name, span, arguments, scope);
        }
        let mut values: Vec<(Value<'a>, Span)> = Vec::new();
        // no function of equations has a second parameter that takes an argument by name
        let mut option = None;
        for argument in arguments {
            let value = self.evaluate(&argument.value, scope)?;
            match argument.name {
                Some(_) => option = Some(self.as_scalar(value, argument.value.span)?),
                None => values.push((value, argument.value.span)),
            }
        }
        match function.kind {
            Kind::Plain(op) | Kind::ToAngle(op) => {
                let x = self.only_scalar(values, span)?;
                let value = self.graphs.unary(x, |g, n| g.unary(op, n));
                if matches!(op, Elementary::Acos | Elementary::Asin) {
                    self.note_kink(value.stage, value.node, 0, span, span, scope)?;
                }
                Ok(Value::Scalar(value))
            }
            Kind::OfAngle(op) => {
                let argument = values.first().map_or(span, |(_, place)| *place);
                let x = self.only_scalar(values, span)?;
                self.angle_without_unit(name, x, argument, span, scope)?;
                Ok(Value::Scalar(self.graphs.unary(x, |g, n| g.unary(op, n))))
            }
            Kind::Numbers if name == "wrapped" => {
                let path = self.scope(scope).path.clone();
                let near = self.wrapped(values, option, &path, span)?;
                self.note_kink(near.stage, near.node, 0, span, span, scope)?;
                Ok(Value::Scalar(near))
            }
            Kind::Numbers if name == "atan2" => {
                let y = values.first().map_or(span, |(_, place)| *place);
                let [a, b] = self.scalars::<2>(values, span)?;
                let angle = self.graphs.binary(a, b, Graph::atan2);
                self.note_kink(angle.stage, angle.node, 0, y, span, scope)?;
                Ok(Value::Scalar(angle))
            }
            Kind::Numbers => {
                let value = self.of_numbers(name, values, span)?;
                self.kink_of(value, span, scope)
            }
            Kind::Vectors => self.of_vectors(name, values, option, span),
            Kind::List => {
                let value = self.of_list(name, values, span)?;
                self.kink_of(value, span, scope)
            }
            Kind::Functions => self.of_functions(name, values, span, scope),
            Kind::Rate | Kind::Turn | Kind::Results => self.arguments(span),
        }
    }

    /// The value of `abs`, `min` or `max`, after its text is kept.
    fn kink_of(&mut self, value: Value<'a>, span: Span, scope: ScopeId) -> Eval<Value<'a>> {
        let Value::Scalar(Scalar { stage, mut node }) = value else {
            return Ok(value);
        };
        // of three and more numbers the operation is a chain
        loop {
            self.note_kink(stage, node, 0, span, span, scope)?;
            let before = match (stage, self.graphs.element.as_ref()) {
                (Stage::Bind, _) => self.graphs.bind.graph.op(node),
                (Stage::Motion, Some(element)) => element.graph.op(node),
                _ => return Ok(value),
            };
            match before {
                Op::Minimum(first, _) | Op::Maximum(first, _) => node = first,
                _ => return Ok(value),
            }
        }
    }

    /// `wrapped(angle, period, from: …)`: angle − n period with the whole number n that brings it into
    /// [from, from + period), rad; −π where `from` is absent. Its slope over the angle is 1: n is a sum of
    /// chosen constants, which have no derivative. At the ends of the interval it jumps. An angle 2²⁴ periods
    /// away from the interval gives no number.
    fn wrapped(
        &mut self,
        values: Vec<(Value<'a>, Span)>,
        from: Option<Scalar>,
        path: &str,
        span: Span,
    ) -> Eval<Scalar> {
        let place = values.last().map_or(span, |(_, place)| *place);
        let [angle, period] = self.scalars::<2>(values, span)?;
        let from = from.unwrap_or_else(|| self.graphs.constant(-std::f64::consts::PI));
        let node = self.bind_node(period, place)?;
        let message = "the period of `wrapped` must be positive".to_owned();
        match self.graphs.known(period) {
            Some(known) if known > 0.0 && known.is_finite() => {}
            Some(known) => {
                let message = Diagnostic::error(codes::REQUIRED, message);
                let found = format!("this is {} deg", short(known.to_degrees(), 4));
                return Err(self.report(message.at(place, found)));
            }
            None => {
                let graph = &mut self.graphs.bind.graph;
                let zero = graph.constant(0.0);
                let positive = graph.less(zero, node);
                let message = vec![super::MessagePart::Text(message)];
                self.bind_check(positive, message, path, place);
            }
        }
        let graphs = &mut self.graphs;
        let operations = |graphs: &GraphBuilder| {
            graphs
                .element
                .as_ref()
                .map_or(0, |e| e.graph.nodes().len() as u32)
        };
        let before = operations(graphs);
        let offset = graphs.subtract(angle, from);
        let periods = graphs.divide(offset, period);
        let count = graphs.unary(periods, whole_number_below);
        let shift = graphs.multiply(count, period);
        let near = graphs.subtract(angle, shift);
        // rounding may leave the angle at the upper end, which belongs to the next period, or below the lower
        let end = graphs.add(from, period);
        let beyond = graphs.binary(near, end, |graph, near, end| {
            let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
            let inside = graph.less(near, end);
            graph.select(inside, zero, one)
        });
        let shift = graphs.multiply(beyond, period);
        let near = graphs.subtract(near, shift);
        let near = graphs.binary(near, from, Graph::maximum);
        let after = operations(graphs);
        // a function that is zero at the ends of the interval and changes there at the rate of the angle
        let half_turn = graphs.constant(std::f64::consts::PI);
        let half_turns = graphs.multiply(periods, half_turn);
        let sine = graphs.unary(half_turns, |graph, x| graph.unary(Elementary::Sin, x));
        let size = graphs.divide(period, half_turn);
        let ends = graphs.multiply(size, sine);
        if let Some(element) = graphs.element.as_mut() {
            element.turns.extend((before..after).map(Node));
            if near.stage == Stage::Motion {
                element.wraps.push((near.node, ends.node));
            }
        }
        Ok(near)
    }

    fn of_numbers(
        &mut self,
        name: &str,
        mut values: Vec<(Value<'a>, Span)>,
        span: Span,
    ) -> Eval<Value<'a>> {
        match name {
            "abs" => match values.pop() {
                Some((Value::Int(i), _)) if i != i64::MIN => Ok(Value::Int(i.abs())),
                Some((v, s)) => {
                    let x = self.as_scalar(v, s)?;
                    Ok(Value::Scalar(self.graphs.unary(x, Graph::abs)))
                }
                None => self.arguments(span),
            },
            "sqrt" => {
                let x = self.only_scalar(values, span)?;
                Ok(Value::Scalar(self.graphs.sqrt(x)))
            }
            _ => self.checked(None, span, &format!("there is no `{name}`")),
        }
    }

    fn of_vectors(
        &mut self,
        name: &str,
        values: Vec<(Value<'a>, Span)>,
        floor: Option<Scalar>,
        span: Span,
    ) -> Eval<Value<'a>> {
        match name {
            "dot" => {
                let [a, b] = self.exactly::<2>(values, span)?;
                let (x, p) = self.sorted(a.0, a.1)?;
                let (y, q) = self.sorted(b.0, b.1)?;
                if x.len() != y.len() {
                    return Err(self.lengths(x.len(), a.1, y.len(), b.1));
                }
                self.together((p, a.1), (q, b.1))?;
                Ok(Value::Scalar(self.graphs.dot(&x, &y)))
            }
            "cross" => {
                let [a, b] = self.exactly::<2>(values, span)?;
                let (x, p) = self.sorted(a.0, a.1)?;
                let (y, q) = self.sorted(b.0, b.1)?;
                let x = self.three(x, a.1)?;
                let y = self.three(y, b.1)?;
                let sort = self.together((p, a.1), (q, b.1))?;
                let c = self.graphs.cross(&x, &y);
                Ok(Self::of_sort(c.to_vec(), sort))
            }
            "norm" => {
                let [a] = self.exactly::<1>(values, span)?;
                // the length is the same in all axes, so the recorded components serve
                let x = match a.0 {
                    Value::Shown(shown) => shown.components.to_vec(),
                    other => self.as_components(other, a.1)?,
                };
                let mut square = self.graphs.dot(&x, &x);
                if let Some(f) = floor {
                    let f2 = self.graphs.multiply(f, f);
                    square = self.graphs.add(square, f2);
                }
                Ok(Value::Scalar(self.graphs.sqrt(square)))
            }
            "perpendicular" => {
                let [a] = self.exactly::<1>(values, span)?;
                let (c, sort) = self.sorted(a.0, a.1)?;
                let &[x, y] = c.as_slice() else {
                    return self.arguments(span);
                };
                let minus_y = self.graphs.negate(y);
                Ok(Self::of_sort(vec![minus_y, x], sort))
            }
            "local" | "vector" => {
                let [v, m] = self.exactly::<2>(values, span)?;
                let axes = match m.0 {
                    Value::Ground => Axes::Ground,
                    other => Axes::Marker(self.as_marker(other, m.1)?),
                };
                if name == "local" {
                    let components = self.components_along(axes, v.0, v.1)?;
                    return Ok(Value::Components(components.to_vec(), axes));
                }
                let (components, sort) = self.sorted(v.0, v.1)?;
                let components = self.three(components, v.1)?;
                self.together((sort, v.1), (Sort::Along(axes), m.1))?;
                self.space_of(components, axes, v.1).map(Value::Vector)
            }
            "rotation" => {
                let [a, b] = self.exactly::<2>(values, span)?;
                let a_marker = self.as_marker(a.0, a.1)?;
                let b_marker = self.as_marker(b.0, b.1)?;
                let a = self.local_marker(a_marker, Some(a.1))?;
                let b = self.local_marker(b_marker, Some(b.1))?;
                self.rotation(a, b, span).map(Value::Scalar)
            }
            _ => self.checked(None, span, &format!("there is no `{name}`")),
        }
    }

    fn of_list(
        &mut self,
        name: &str,
        mut values: Vec<(Value<'a>, Span)>,
        span: Span,
    ) -> Eval<Value<'a>> {
        match name {
            "min" | "max" => {
                if let Some(whole) = whole_numbers(&values) {
                    let extreme = match name {
                        "min" => whole.into_iter().min(),
                        _ => whole.into_iter().max(),
                    };
                    return extreme
                        .map(Value::Int)
                        .ok_or_else(|| self.nothing(name, span));
                }
                let list = self.numbers_of(values)?;
                let op = if name == "min" {
                    Graph::minimum
                } else {
                    Graph::maximum
                };
                let mut rest = list.into_iter();
                let Some(mut best) = rest.next() else {
                    return Err(self.nothing(name, span));
                };
                for x in rest {
                    best = self.graphs.binary(best, x, op);
                }
                Ok(Value::Scalar(best))
            }
            "sum" => {
                if let Some(whole) = whole_numbers(&values)
                    && !whole.is_empty()
                {
                    let sum = whole
                        .into_iter()
                        .try_fold(0_i64, |sum, i| sum.checked_add(i));
                    return sum.map(Value::Int).ok_or_else(|| self.not_countable(span));
                }
                let list = self.numbers_of(values)?;
                let mut rest = list.into_iter();
                let Some(mut sum) = rest.next() else {
                    // the type of the list states the dimension
                    return Ok(match self.type_at(span)? {
                        Type::Int => Value::Int(0),
                        _ => Value::Scalar(self.graphs.constant(0.0)),
                    });
                };
                for x in rest {
                    sum = self.graphs.add(sum, x);
                }
                Ok(Value::Scalar(sum))
            }
            "length" => match values.pop() {
                Some((Value::List(items), _)) => Ok(Value::Int(items.len() as i64)),
                Some((Value::Components(c, _), _)) => Ok(Value::Int(c.len() as i64)),
                _ => self.arguments(span),
            },
            "index_of" => self.index_of(values, span),
            "distinct" => match values.pop().map(|(v, s)| (Self::without_axes(v), s)) {
                Some((Value::List(items), s)) => {
                    let mut seen: Vec<f64> = Vec::new();
                    for item in items {
                        let x = self.as_scalar(item, s)?;
                        let v = self.structural(x, s)?;
                        if seen.contains(&v) {
                            return Ok(Value::Bool(false));
                        }
                        seen.push(v);
                    }
                    Ok(Value::Bool(true))
                }
                _ => self.arguments(span),
            },
            _ => self.checked(None, span, &format!("there is no `{name}`")),
        }
    }

    /// The place of a number in a list, from 1. Numbers that differ by rounding alone are the same.
    fn index_of(&mut self, values: Vec<(Value<'a>, Span)>, span: Span) -> Eval<Value<'a>> {
        // numbers of different units are converted with different rounding
        const CONVERSION_ROUNDING: f64 = 1e-12;
        let [list, value] = self.exactly::<2>(values, span)?;
        let (place, value_place) = (list.1, value.1);
        let value = self.as_scalar(value.0, value_place)?;
        let value = self.structural(value, value_place)?;
        for (index, item) in self.numbers_of(vec![list])?.into_iter().enumerate() {
            let item = self.structural(item, place)?;
            if (item - value).abs() <= CONVERSION_ROUNDING * value.abs() {
                return Ok(Value::Int(index as i64 + 1));
            }
        }
        Err(self.report(
            Diagnostic::error(
                codes::NOT_IN_LIST,
                "no number of the list is equal to this one",
            )
            .at(value_place, "this number")
            .also(place, "not in this list"),
        ))
    }

    /// Reports `min` or `max` of an empty list.
    fn nothing(&mut self, name: &str, span: Span) -> super::Reported {
        self.report(
            Diagnostic::error(codes::EMPTY_LIST, format!("`{name}` of an empty list"))
                .at(span, "an empty list has no smallest and no largest number")
                .with_help(format!(
                    "state its value for an empty list: `if length(list) > 0 then {name}(list) else 0 mm`, with the intended unit"
                )),
        )
    }

    fn arguments<T>(&mut self, span: Span) -> Eval<T> {
        self.checked(None, span, "the arguments do not fit")
    }

    fn exactly<const N: usize>(
        &mut self,
        values: Vec<(Value<'a>, Span)>,
        span: Span,
    ) -> Eval<[(Value<'a>, Span); N]> {
        let values = <[(Value<'a>, Span); N]>::try_from(values).ok();
        self.checked(values, span, "the arguments do not fit")
    }

    fn scalars<const N: usize>(
        &mut self,
        values: Vec<(Value<'a>, Span)>,
        span: Span,
    ) -> Eval<[Scalar; N]> {
        let mut scalars = Vec::with_capacity(N);
        for (value, s) in values {
            scalars.push(self.as_scalar(value, s)?);
        }
        let scalars = <[Scalar; N]>::try_from(scalars).ok();
        self.checked(scalars, span, "the arguments do not fit")
    }

    fn only_scalar(&mut self, values: Vec<(Value<'a>, Span)>, span: Span) -> Eval<Scalar> {
        let [x] = self.scalars::<1>(values, span)?;
        Ok(x)
    }

    fn numbers_of(&mut self, values: Vec<(Value<'a>, Span)>) -> Eval<Vec<Scalar>> {
        let mut list = Vec::new();
        for (value, s) in values {
            match Self::without_axes(value) {
                Value::List(items) => {
                    for item in items {
                        list.push(self.as_scalar(item, s)?);
                    }
                }
                other => list.push(self.as_scalar(other, s)?),
            }
        }
        Ok(list)
    }

    /// The marker of a value; `ground` is the marker at the ground's origin.
    pub fn as_marker(&mut self, value: Value<'a>, span: Span) -> Eval<u32> {
        match value {
            Value::Ground => Ok(self.ground_frame()),
            other => {
                let MarkerIndex(marker) = self.read(other, span)?;
                self.used_marker(marker);
                Ok(marker)
            }
        }
    }

    /// Unwrapped angle of marker a about b.z, from b.x to a.x: the reference (the angle at the last accepted state)
    /// plus the difference in (−π, π]. It is smooth as long as a step turns by less than half a turn.
    pub fn rotation(&mut self, a: u32, b: u32, span: Span) -> Eval<Scalar> {
        let known = self
            .graphs
            .element
            .as_ref()
            .and_then(|e| e.rotations.iter().find(|r| r.0 == a && r.1 == b))
            .map(|r| r.2);
        let scalar = |node| Scalar {
            stage: Stage::Motion,
            node,
        };
        if let Some(node) = known {
            return Ok(scalar(node));
        }
        let ax = self.marker_axis(a, 0);
        let bx = self.marker_axis(b, 0);
        let by = self.marker_axis(b, 1);
        let sine = self.graphs.dot(&ax, &by).node;
        let cosine = self.graphs.dot(&ax, &bx).node;
        let Some(element) = self.graphs.element.as_mut() else {
            return Err(super::Reported);
        };
        let index = element.rotations.len() as u32;
        if index >= super::scalar::PROVISIONAL.rotations {
            return Err(self.report(
                Diagnostic::error(
                    codes::ELEMENT_TOO_LARGE,
                    format!(
                        "one element measures more than {} rotations",
                        super::scalar::PROVISIONAL.rotations
                    ),
                )
                .at(span, "the limit is reached here")
                .with_help("divide it into several elements or outputs"),
            ));
        }
        let g = &mut element.graph;
        let reference = g.input(super::scalar::PROVISIONAL.rotation(index));
        let cr = g.unary(Elementary::Cos, reference);
        let sr = g.unary(Elementary::Sin, reference);
        let (p, q) = (g.multiply(sine, cr), g.multiply(cosine, sr));
        let s = g.subtract(p, q);
        let (p, q) = (g.multiply(cosine, cr), g.multiply(sine, sr));
        let c = g.add(p, q);
        let difference = g.atan2(s, c);
        let node = g.add(reference, difference);
        // no step turns so far that it reaches the cut
        element.turns.push(difference);
        element.rotations.push((a, b, node));
        Ok(scalar(node))
    }

    fn rate(
        &mut self,
        span: Span,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let [argument] = arguments else {
            return self.arguments(span);
        };
        let outer = std::mem::replace(&mut self.context.in_rate, true);
        let value = self.evaluate(&argument.value, scope);
        self.context.in_rate = outer;
        self.rate_of(value?, argument.value.span)
    }

    /// The time derivative of a value.
    pub fn rate_of(&mut self, value: Value<'a>, span: Span) -> Eval<Value<'a>> {
        let (components, sort) = match value {
            Value::Int(_) => return Ok(Value::Scalar(self.graphs.constant(0.0))),
            value if value.is_several() => {
                let (components, sort) = self.sorted(value, span)?;
                (components, Some(sort))
            }
            other => (vec![self.as_scalar(other, span)?], None),
        };
        self.rates_known(&components, span)?;
        let nodes: Vec<Node> = components
            .iter()
            .map(|s| self.graphs.lift(s.stage, s.node))
            .collect();
        let rates = self.context.rates.clone();
        let changing = self.rates_of_constants(&nodes);
        let Some(element) = self.graphs.element.as_mut() else {
            // a value of parameters alone changes with inputs alone
            let known: Vec<Scalar> = nodes
                .iter()
                .map(|node| match self.rate_of_bound(*node) {
                    Some(node) => Scalar {
                        stage: Stage::Bind,
                        node,
                    },
                    None => self.graphs.constant(0.0),
                })
                .collect();
            return Ok(match sort {
                None => Value::Scalar(known[0]),
                Some(sort) => Self::of_sort(known, sort),
            });
        };
        let derivative = crate::ir::differentiate::time_derivative(
            &mut element.graph,
            &super::scalar::PROVISIONAL,
            &nodes,
            rates.as_deref(),
            &changing,
        );
        let derivative = match derivative {
            Ok(d) => d,
            Err(error) => {
                return Err(self.report(
                    Diagnostic::error(codes::NO_RATE, "the argument of `der` has no known time derivative")
                        .at(span, error.to_string())
                        .with_help("positions, angles and velocities have a `der`; of a velocity, in outputs only"),
                ));
            }
        };
        let uses_acceleration = crate::ir::differentiate::uses_acceleration(
            &element.graph,
            &derivative,
            &super::scalar::PROVISIONAL,
        );
        if uses_acceleration && !self.context.in_output {
            return Err(self.report(
                Diagnostic::error(
                    codes::LATE_ACCELERATION,
                    "accelerations can be used in outputs only",
                )
                .at(span, "this is the rate of a velocity where it is used")
                .with_help("use it in outputs; a force that needs a rate takes it of a position"),
            ));
        }
        let scalars: Vec<Scalar> = derivative
            .into_iter()
            .map(|node| Scalar {
                stage: Stage::Motion,
                node,
            })
            .collect();
        Ok(match sort {
            None => Value::Scalar(scalars[0]),
            Some(sort) => Self::of_sort(scalars, sort),
        })
    }
}

/// Binary digits of a count of periods. A choice: sixteen million periods are more than a run has, and each
/// digit is an operation of the element.
const DIGITS: i32 = 24;

/// The largest whole number that is not above x, as a sum of chosen powers of two, so that its derivative is
/// zero; not a number unless −2²⁴ ≤ x < 2²⁴.
fn whole_number_below(graph: &mut Graph, x: Node) -> Node {
    let limit = f64::from(1 << DIGITS);
    let (zero, lowest) = (graph.constant(0.0), graph.constant(-limit));
    let negative = graph.less(x, zero);
    let mut whole = graph.select(negative, lowest, zero);
    for digit in (0..DIGITS).rev() {
        let power = graph.constant(f64::from(1 << digit));
        let next = graph.add(whole, power);
        let fits = graph.less_equal(next, x);
        whole = graph.select(fits, next, whole);
    }
    let (highest, nothing) = (graph.constant(limit), graph.constant(f64::NAN));
    let above = graph.less_equal(lowest, x);
    let below = graph.less(x, highest);
    let inside = graph.push(Op::And(above, below));
    graph.select(inside, whole, nothing)
}
