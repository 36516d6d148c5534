//! Markers: places and axes on bodies and the ground.

use super::body::index_text;
use super::scalar::Scalar;
use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, location};
use crate::codes;
use crate::ir::{Graph, Node};
use eng_grammar::ast::{self, ExprKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::elementary::Elementary;
use eng_system::system::{BodyRef, Marker, Origin, Slot};

/// A 3×3 matrix of bind nodes, row-major.
type Matrix = [Node; 9];

/// A matrix (three by three, row-major) times a block of three rows with some columns.
fn product(graph: &mut Graph, matrix: &Matrix, block: &[Node], columns: usize) -> Vec<Node> {
    let mut result = Vec::with_capacity(block.len());
    for row in matrix.chunks(3) {
        for column in 0..columns {
            let mut sum = graph.constant(0.0);
            for (a, b) in row.iter().zip(block.iter().skip(column).step_by(columns)) {
                let term = graph.multiply(*a, *b);
                sum = graph.add(sum, term);
            }
            result.push(sum);
        }
    }
    result
}

impl<'a> Elaborator<'a, '_> {
    pub fn slot(&mut self, node: Node) -> Slot {
        self.graphs.bind.slot(node)
    }

    pub(super) fn slots<const N: usize>(&mut self, nodes: [Node; N]) -> [Slot; N] {
        nodes.map(|n| self.slot(n))
    }

    pub(super) fn zero(&mut self) -> Node {
        self.graphs.bind.graph.constant(0.0)
    }

    fn identity(&mut self) -> Matrix {
        let one = self.graphs.bind.graph.constant(1.0);
        let zero = self.zero();
        [one, zero, zero, zero, one, zero, zero, zero, one]
    }

    /// The marker at the ground's origin with its axes.
    pub fn ground_frame(&mut self) -> u32 {
        if let Some(i) = self.draft.markers.iter().position(|m| {
            m.body == BodyRef::Ground && m.origin.path == "ground" && m.placed_at.is_none()
        }) {
            return i as u32;
        }
        let zero = self.zero();
        let identity = self.identity();
        self.add_marker(BodyRef::Ground, "ground".into(), None, [zero; 3], identity)
    }

    /// The marker on the ground that coincides with a partner at the start.
    pub fn ground_at(&mut self, partner: u32, path: String, span: Span) -> u32 {
        let zero = self.zero();
        let identity = self.identity();
        let marker = self.add_marker(BodyRef::Ground, path, Some(span), [zero; 3], identity);
        self.draft.markers[marker as usize].placed_at = Some(partner);
        self.draft.used_markers[marker as usize] = true;
        marker
    }

    fn add_marker(
        &mut self,
        body: BodyRef,
        path: String,
        span: Option<Span>,
        position: [Node; 3],
        orientation: Matrix,
    ) -> u32 {
        let owner = std::mem::replace(&mut self.graphs.bind.owner, path.clone());
        let position = self.slots(position);
        let orientation = self.slots(orientation);
        self.graphs.bind.owner = owner;
        self.draft.markers.push(Marker {
            origin: Origin {
                path,
                used_at: span.map(location),
                defined_at: None,
            },
            body,
            position,
            orientation,
            shape: None,
            placed_at: None,
        });
        // no warning about an unused marker if the text has no place for it, or if a component offers it
        self.draft
            .used_markers
            .push(span.is_none() || self.context.in_part);
        self.draft.markers.len() as u32 - 1
    }

    /// A body's frame.
    pub fn frame_marker(&mut self, body: BodyRef, path: String) -> u32 {
        let zero = self.zero();
        let identity = self.identity();
        self.add_marker(body, path, None, [zero; 3], identity)
    }

    /// A marker whose position comes from the reduction of a mesh.
    pub fn marker_of_mesh(
        &mut self,
        body: BodyRef,
        path: String,
        span: Span,
        axes: [f64; 9],
        shape: u32,
    ) -> u32 {
        let zero = self.zero();
        let axes = axes.map(|x| self.graphs.bind.graph.constant(x));
        let marker = self.add_marker(body, path, Some(span), [zero; 3], axes);
        self.draft.markers[marker as usize].shape = Some(shape);
        marker
    }

    /// Notes that an item refers to a marker.
    pub fn used_marker(&mut self, marker: u32) {
        if let Some(used) = self.draft.used_markers.get_mut(marker as usize) {
            *used = true;
        }
    }

    /// Instances of `marker name[index] = …` on a body or the ground.
    pub fn markers_of(
        &mut self,
        declaration: &'a ast::Declaration,
        body: BodyRef,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let (value, _) = self.instance(declaration)?;
        let name = &declaration.name.text;
        let base = self.path(scope, name);
        self.instances_of(declaration, scope, &mut |e, inner, position| {
            let path = format!("{base}{}", index_text(position));
            let (place, orientation) = e.placement(value, inner, body)?;
            let marker = e.add_marker(body, path, Some(declaration.name.span), place, orientation);
            Ok(Value::Marker(marker))
        })
    }

    /// Place and axes of a marker on a body.
    fn placement(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
        body: BodyRef,
    ) -> Eval<([Node; 3], Matrix)> {
        let arguments = match &value.kind {
            ExprKind::Call { callee, arguments } if matches!(&callee.kind, ExprKind::Name(n) if n == "at") => {
                arguments
            }
            _ => return Ok((self.place(value, scope)?, self.identity())),
        };
        let zero = self.zero();
        let mut place = [zero; 3];
        let (mut x, mut z, mut base, mut about, mut by) = (None, None, None, None, None);
        for a in arguments {
            match a.name.as_ref().map(|n| n.text.as_str()) {
                None => place = self.place(&a.value, scope)?,
                Some("z") => z = Some(self.direction(&a.value, scope)?),
                Some("x") => x = Some(self.direction(&a.value, scope)?),
                Some("in") => base = Some(self.frame_on(body, &a.value, scope)?),
                Some("about") => about = Some(&a.value),
                Some("by") => {
                    let angle = self.evaluate(&a.value, scope)?;
                    let angle = self.as_scalar(angle, a.value.span)?;
                    by = Some(self.bind_node(angle, a.value.span)?);
                }
                Some(_) => return self.checked(None, a.value.span, "no argument of `at`"),
            }
        }
        self.not_parallel(x, z, value.span, scope)?;
        let mut orientation = self.orientation(x, z);
        if let (Some(about), Some(angle)) = (about, by) {
            let axis = match &about.kind {
                ExprKind::Name(axis) => ["x", "y", "z"].iter().position(|known| known == axis),
                _ => None,
            };
            let axis = self.checked(axis, about.span, "no axis")?;
            orientation = self.turned(&orientation, axis, angle);
        }
        if let Some((from, axes)) = base {
            let graph = &mut self.graphs.bind.graph;
            let along = product(graph, &axes, &place, 1);
            for (part, (from, along)) in place.iter_mut().zip(from.iter().zip(along)) {
                *part = graph.add(*from, along);
            }
            let rows = product(graph, &axes, &orientation, 3);
            orientation = std::array::from_fn(|i| rows.get(i).copied().unwrap_or(zero));
        }
        Ok((place, orientation))
    }

    /// Place and axes of a marker in whose axes another marker of the same body is placed.
    fn frame_on(
        &mut self,
        body: BodyRef,
        expr: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<([Node; 3], Matrix)> {
        let value = self.evaluate(expr, scope)?;
        let index = self.as_marker(value, expr.span)? as usize;
        let found = self.draft.markers.get(index);
        let found = found.map(|m| (m.body == body, m.shape.is_some(), m.position, m.orientation));
        let (on_body, on_mesh, position, orientation) =
            self.checked(found, expr.span, "no marker")?;
        if !on_body || on_mesh {
            let label = match on_mesh {
                true => "its place comes from a mesh",
                false => "this one is on another body",
            };
            return Err(self.report(
                Diagnostic::error(
                    codes::MARKER,
                    "a marker is placed in the axes of a marker of its own body",
                )
                .at(expr.span, label)
                .with_help("connect two bodies by joints or films"),
            ));
        }
        let nodes = self.graphs.bind.slots();
        let of = |slot: &Slot| nodes.get(slot.0 as usize).copied();
        let place: Option<Vec<Node>> = position.iter().map(of).collect();
        let axes: Option<Vec<Node>> = orientation.iter().map(of).collect();
        let place = place.and_then(|list| <[Node; 3]>::try_from(list).ok());
        let axes = axes.and_then(|list| Matrix::try_from(list).ok());
        let found = place.zip(axes);
        self.checked(found, expr.span, "a marker without a place")
    }

    /// Axes turned about one of them (0 to 2) by an angle: M R.
    fn turned(&mut self, matrix: &Matrix, axis: usize, angle: Node) -> Matrix {
        let graph = &mut self.graphs.bind.graph;
        let (sine, cosine) = (
            graph.unary(Elementary::Sin, angle),
            graph.unary(Elementary::Cos, angle),
        );
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turned = *matrix;
        for row in [0, 3, 6] {
            let (a, b) = (matrix[row + next], matrix[row + last]);
            let (ca, sb) = (graph.multiply(cosine, a), graph.multiply(sine, b));
            let (cb, sa) = (graph.multiply(cosine, b), graph.multiply(sine, a));
            turned[row + next] = graph.add(ca, sb);
            turned[row + last] = graph.subtract(cb, sa);
        }
        turned
    }

    fn place(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<[Node; 3]> {
        if matches!(&expr.kind, ExprKind::Name(n) if n == "origin") {
            let zero = self.zero();
            return Ok([zero; 3]);
        }
        self.bind_vector(expr, scope)
    }

    pub fn direction(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<[Scalar; 3]> {
        let value = self.evaluate(expr, scope)?;
        let v = self.as_vector(value, expr.span)?;
        let known: Vec<f64> = v.iter().filter_map(|s| self.graphs.known(*s)).collect();
        if known.len() == 3 && known.iter().all(|x| *x == 0.0) {
            return Err(self.report(
                Diagnostic::error(codes::DIRECTION, "a direction has the length zero")
                    .at(expr.span, "this points nowhere")
                    .with_help(
                        "for instance `z: [0, 0, 1]`; only the direction counts, not the length",
                    ),
            ));
        }
        Ok(self.normalise(&v))
    }

    /// Refuses two stated directions along one line, because x must be made perpendicular to z.
    pub fn not_parallel(
        &mut self,
        x: Option<[Scalar; 3]>,
        z: Option<[Scalar; 3]>,
        span: Span,
        scope: ScopeId,
    ) -> Eval<()> {
        let (Some(x), Some(z)) = (x, z) else {
            return Ok(());
        };
        let across = self.graphs.cross(&x, &z);
        let square = self.graphs.dot(&across, &across);
        // the sine of a hundredth of a degree, squared
        const LEAST_SQUARED_SINE: f64 = 3e-8;
        if let Some(known) = self.graphs.known(square) {
            if known > LEAST_SQUARED_SINE {
                return Ok(());
            }
            return Err(self.report(
                Diagnostic::error(codes::DIRECTION, "the directions x and z are parallel")
                    .at(span, "no axes have both")
                    .with_help("state one of them, or two that are not parallel"),
            ));
        }
        let path = self.scope(scope).path.clone();
        let graph = &mut self.graphs.bind.graph;
        let least = graph.constant(LEAST_SQUARED_SINE);
        let flag = graph.less(least, square.node);
        let text = "the directions x and z of a marker must not be parallel".to_owned();
        self.bind_check(flag, vec![super::MessagePart::Text(text)], &path, span);
        Ok(())
    }

    fn normalise(&mut self, v: &[Scalar; 3]) -> [Scalar; 3] {
        let square = self.graphs.dot(v, v);
        let length = self.graphs.sqrt(square);
        v.map(|s| self.graphs.divide(s, length))
    }

    /// Matrix marker → body from stated x and z directions (unit vectors in body axes). z is kept, and x is
    /// made perpendicular to it.
    pub fn orientation(&mut self, x: Option<[Scalar; 3]>, z: Option<[Scalar; 3]>) -> Matrix {
        let ex = self.unit_vector(0);
        let ey = self.unit_vector(1);
        let ez = self.unit_vector(2);
        let (x, z) = match (x, z) {
            (None, None) => (ex, ez),
            (Some(x), Some(z)) => (x, z),
            (None, Some(z)) => {
                // y nearest to the body's z axis. So a bore in the plane across the crank has y along the
                // crank at any angle. If z is within 26° (cosine 0.9) of the body's z, this direction is
                // ill-defined, and x is nearest to the body's x axis.
                let limit = self.graphs.constant(0.9);
                let along = self.graphs.unary(z[2], crate::ir::Graph::abs);
                let free = self.graphs.compare(along, limit, crate::ir::Graph::less);
                let across = self.graphs.cross(&ez, &z);
                let chosen = match self.graphs.known_flag(free) {
                    Some(true) => across,
                    Some(false) => ex,
                    None => [0, 1, 2].map(|i| self.graphs.select(free, across[i], ex[i])),
                };
                (chosen, z)
            }
            (Some(x), None) => {
                // the body's z axis made perpendicular to x; if x is close to it, the body's y axis
                let limit = self.graphs.constant(0.9);
                let along = self.graphs.unary(x[2], crate::ir::Graph::abs);
                let free = self.graphs.compare(along, limit, crate::ir::Graph::less);
                let about = match self.graphs.known_flag(free) {
                    Some(true) => ez,
                    Some(false) => ey,
                    None => [0, 1, 2].map(|i| self.graphs.select(free, ez[i], ey[i])),
                };
                let z = self.perpendicular_part(&about, &x);
                (x, z)
            }
        };
        let x = self.perpendicular_part(&x, &z);
        let y = self.graphs.cross(&z, &x);
        let mut matrix = [x[0].node; 9];
        for i in 0..3 {
            matrix[3 * i] = x[i].node;
            matrix[3 * i + 1] = y[i].node;
            matrix[3 * i + 2] = z[i].node;
        }
        matrix
    }

    /// The unit vector along the part of v that is perpendicular to the unit vector n.
    fn perpendicular_part(&mut self, v: &[Scalar; 3], n: &[Scalar; 3]) -> [Scalar; 3] {
        let along = self.graphs.dot(v, n);
        let rest = [0, 1, 2].map(|i| {
            let p = self.graphs.multiply(along, n[i]);
            self.graphs.subtract(v[i], p)
        });
        self.normalise(&rest)
    }

    /// Three numbers that depend on parameters alone.
    pub fn bind_vector(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<[Node; 3]> {
        let value = self.evaluate(expr, scope)?;
        let v = self.as_vector(value, expr.span)?;
        let mut nodes = [self.zero(); 3];
        for (node, s) in nodes.iter_mut().zip(v) {
            *node = self.bind_node(s, expr.span)?;
        }
        Ok(nodes)
    }

    /// exp(v~) of a rotation vector (Rodrigues). Near zero it uses the series, because the formula is 0/0
    /// there.
    pub(super) fn rotation_matrix(&mut self, v: [Node; 3]) -> Matrix {
        let g = &mut self.graphs.bind.graph;
        let mut square = g.constant(0.0);
        for n in v {
            let p = g.multiply(n, n);
            square = g.add(square, p);
        }
        // the root keeps a derivative at zero, and no rotation changes by as little
        let tiny = g.constant(1e-300);
        // below a millionth of a radian the sine over its angle is one but for 1e-13
        let small_limit = g.constant(1e-12);
        let safe = g.add(square, tiny);
        let angle = g.sqrt(safe);
        let small = g.less(square, small_limit);
        let sine = g.unary(Elementary::Sin, angle);
        let ratio = g.divide(sine, angle);
        let one = g.constant(1.0);
        let a = g.select(small, one, ratio);
        let cosine = g.unary(Elementary::Cos, angle);
        let versine = g.subtract(one, cosine);
        let ratio = g.divide(versine, safe);
        let half = g.constant(0.5);
        let b = g.select(small, half, ratio);
        let [x, y, z] = v;
        let mut matrix = [one; 9];
        let skew: [(Option<Node>, bool); 9] = [
            (None, false),
            (Some(z), true),
            (Some(y), false),
            (Some(z), false),
            (None, false),
            (Some(x), true),
            (Some(y), true),
            (Some(x), false),
            (None, false),
        ];
        for i in 0..3 {
            for j in 0..3 {
                // R = 1 + a v~ + b (v vᵀ − v² 1)
                let outer = g.multiply(v[i], v[j]);
                let mut second = outer;
                if i == j {
                    second = g.subtract(outer, square);
                }
                let mut entry = g.multiply(b, second);
                if i == j {
                    entry = g.add(entry, one);
                }
                if let (Some(n), negative) = skew[3 * i + j] {
                    let p = g.multiply(a, n);
                    entry = if negative {
                        g.subtract(entry, p)
                    } else {
                        g.add(entry, p)
                    };
                }
                matrix[3 * i + j] = entry;
            }
        }
        matrix
    }
}
