//! Bodies and markers.

use super::binding::Stated;
use super::scalar::Stage;
use super::value::{ScopeId, Value};
use super::{Elaborator, Entry, Eval, Lazy, location};
use crate::ir::{Node, Op};
use eng_grammar::Span;
use eng_grammar::ast::{self, ExprKind, Form, ItemKind, Kind, Statement};
use eng_system::system::{Body, BodyInertia, BodyRef, Origin, Role};
use eng_system::{Dimension, DisplayUnit};

impl<'a> Elaborator<'a, '_> {
    /// Instances of `body name[index] { … }`.
    pub fn bodies_of(
        &mut self,
        declaration: &'a ast::Declaration,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let Form::Plain { block, .. } = &declaration.form else {
            return self.checked(None, declaration.name.span, "a body without a block");
        };
        let name = &declaration.name.text;
        let base = self.path(scope, name);
        self.instances_of(declaration, scope, &mut |e, inner, position| {
            let path = format!("{base}{}", index_text(position));
            let body = match declaration.kind {
                Kind::Flexible => e.flexible_body(declaration, block, inner, path)?,
                _ => e.body(declaration, block, inner, path)?,
            };
            Ok(Value::Body(body))
        })
    }

    /// Begins a body: the scope of its block.
    pub fn body_scope(
        &mut self,
        declaration: &'a ast::Declaration,
        block: &'a ast::Block,
        outer: ScopeId,
        path: &str,
    ) -> Eval<ScopeId> {
        self.count_instance(declaration.name.span)?;
        let module = self.scope(outer).module;
        let own = self.new_scope(Some(outer), module, path.to_owned());
        self.accepted_in(&block.items, path);
        path.clone_into(&mut self.graphs.bind.owner);
        Ok(own)
    }

    /// Adds a body with its marker `origin`. Returns the indices of both.
    pub fn add_body(
        &mut self,
        declaration: &ast::Declaration,
        inertia: BodyInertia,
        own: ScopeId,
        path: &str,
    ) -> (u32, u32) {
        let body = self.draft.bodies.len() as u32;
        self.draft.bodies.push(Body {
            origin: Origin {
                path: path.to_owned(),
                used_at: Some(location(declaration.name.span)),
                defined_at: None,
            },
            inertia,
            position: None,
            orientation: None,
            guessed_at: Vec::new(),
        });
        self.draft.body_scopes.push(own);
        let origin = self.frame_marker(BodyRef::Body(body), format!("{path}.origin"));
        self.define(own, "origin", Entry::Value(Value::Marker(origin)));
        (body, origin)
    }

    fn body(
        &mut self,
        declaration: &'a ast::Declaration,
        block: &'a ast::Block,
        scope: ScopeId,
        path: String,
    ) -> Eval<u32> {
        let own = self.body_scope(declaration, block, scope, &path)?;
        let zero = self.zero();
        let mut mass = None;
        let mut inertia = None;
        let mut products = [zero; 3];
        let mut center = [zero; 3];
        for item in &block.items {
            if let ItemKind::Attribute(a) = &item.kind {
                let attribute = format!("{path}.{}", a.name.text);
                self.draft
                    .stated
                    .insert(attribute.clone(), location(a.value.span));
                // a mass is a parameter, which looks for a change of its own
                let (written, from) = match a.name.text == "mass" {
                    true => (&a.value, own),
                    false => self.changed(&attribute).unwrap_or((&a.value, own)),
                };
                match a.name.text.as_str() {
                    "mass" => {
                        let value = self.evaluate(&a.value, own)?;
                        let parameter = format!("{path}.mass");
                        let stated = Stated {
                            expr: &a.value,
                            dimension: Dimension::MASS,
                            limits: None,
                            span: a.name.span,
                            scope: own,
                        };
                        let value = self.parameterise(value, &parameter, stated)?;
                        let s = self.as_scalar(value, a.value.span)?;
                        self.define(own, "mass", Entry::Value(Value::Scalar(s)));
                        let node = self.bind_node(s, a.value.span)?;
                        let display = self.natural_unit(Dimension::MASS);
                        self.positive_mass(node, display, &path, a.value.span);
                        mass = Some(node);
                    }
                    "inertia" => {
                        let nodes = self.bind_vector(written, from)?;
                        for i in 0..3 {
                            self.triangle(nodes, i, &path, written.span);
                        }
                        inertia = Some(nodes);
                    }
                    "products_of_inertia" => products = self.bind_vector(written, from)?,
                    "center_of_mass" => center = self.bind_vector(written, from)?,
                    _ => return self.checked(None, a.name.span, "no attribute of a body"),
                }
            }
        }
        let mass = self.checked(mass, declaration.name.span, "a body without mass")?;
        let inertia = self.checked(inertia, declaration.name.span, "a body without inertia")?;
        let mass = self.slot(mass);
        let center_of_mass = self.slots(center);
        let inertia = self.slots([
            inertia[0],
            inertia[1],
            inertia[2],
            products[0],
            products[1],
            products[2],
        ]);
        let inertia = BodyInertia::Rigid {
            mass,
            center_of_mass,
            inertia,
        };
        let (index, origin) = self.add_body(declaration, inertia, own, &path);
        let reference = BodyRef::Body(index);
        // a marker may be placed in the axes of a later one
        for item in &block.items {
            if let ItemKind::Declaration(d) = &item.kind
                && d.kind == Kind::Marker
            {
                let lazy = Lazy::Marker(d, reference);
                self.define(own, &d.name.text, Entry::Lazy(lazy));
            }
        }
        for item in &block.items {
            match &item.kind {
                ItemKind::Declaration(d) if d.kind == Kind::Marker => {
                    // an error in one marker does not hide those of its neighbours
                    let _ = self.entry(own, &d.name.text, d.name.span);
                }
                _ => self.start_in_body(item, index, origin, own),
            }
        }
        Ok(index)
    }

    /// A `start` or `guess` among the items of a body.
    pub fn start_in_body(&mut self, item: &'a ast::Item, body: u32, origin: u32, scope: ScopeId) {
        let (target, value, exact) = match &item.kind {
            ItemKind::Statement(Statement::Start { target, value }) => (target, value, true),
            ItemKind::Statement(Statement::Guess { target, value }) => (target, value, false),
            _ => return,
        };
        let name = match &target.kind {
            ExprKind::Name(n) => n.as_str(),
            _ => "",
        };
        // the error was reported
        let _ = self.body_start(body, origin, (name, target.span), value, scope, exact);
    }

    fn positive_mass(&mut self, node: Node, display: DisplayUnit, path: &str, span: Span) {
        let graph = &mut self.graphs.bind.graph;
        let zero = graph.constant(0.0);
        let flag = graph.less(zero, node);
        let message = vec![
            super::MessagePart::Text("the mass must be positive, not ".into()),
            super::MessagePart::Value(node, display),
        ];
        self.bind_check(flag, message, path, span);
    }

    /// Requires that no principal moment exceeds the sum of the others, as in every real body.
    fn triangle(&mut self, moments: [Node; 3], i: usize, path: &str, span: Span) {
        let graph = &mut self.graphs.bind.graph;
        let others = graph.add(moments[(i + 1) % 3], moments[(i + 2) % 3]);
        // a flat plate is exactly at the limit; this allows for rounding of its sum
        let slack = graph.constant(1.0 + 1e-9);
        let limit = graph.multiply(others, slack);
        let fits = graph.less_equal(moments[i], limit);
        let zero = graph.constant(0.0);
        let not_negative = graph.less_equal(zero, moments[i]);
        let flag = graph.push(Op::And(fits, not_negative));
        let axis = ["x", "y", "z"][i];
        self.bind_check(
            flag,
            vec![super::MessagePart::Text(format!(
                "no body has this inertia: the moment about {axis} is negative or more than the sum of the other two"
            ))],
            path,
            span,
        );
    }

    /// Adds a condition on parameters that the language itself requires.
    pub fn bind_check(
        &mut self,
        flag: Node,
        message: Vec<super::MessagePart>,
        path: &str,
        span: Span,
    ) {
        let holds = self.graphs.flag_number(super::scalar::Flag {
            stage: Stage::Bind,
            node: flag,
        });
        self.draft.checks.push(super::Check {
            holds,
            advise: false,
            name: String::new(),
            message,
            path: path.to_owned(),
            used_at: Some(location(span)),
            defined_at: None,
        });
    }

    /// Evaluates `start` and `guess` inside a body.
    pub fn body_start(
        &mut self,
        body: u32,
        origin: u32,
        (name, place): (&str, Span),
        value: &'a ast::Expr,
        scope: ScopeId,
        exact: bool,
    ) -> Eval<()> {
        let position_role = Role::StartPosition { exact };
        let velocity_role = Role::StartVelocity { exact };
        if !exact && matches!(name, "position" | "rotation") {
            let guessed_at = &mut self.draft.bodies[body as usize].guessed_at;
            guessed_at.push(super::location(place));
        }
        match name {
            "position" => {
                let nodes = self.bind_vector(value, scope)?;
                let slots = self.slots(nodes);
                self.draft.bodies[body as usize].position = Some(slots);
                self.replaced_start(&super::pending::StartTarget::Position(origin));
                if exact {
                    self.pending_start(
                        position_role,
                        super::pending::StartTarget::Position(origin),
                        value,
                        scope,
                    );
                }
            }
            "rotation" => {
                let nodes = self.bind_vector(value, scope)?;
                let matrix = self.rotation_matrix(nodes);
                let slots = self.slots(matrix);
                self.draft.bodies[body as usize].orientation = Some(slots);
                self.replaced_start(&super::pending::StartTarget::Rotation(origin, matrix));
                if exact {
                    self.pending_start(
                        position_role,
                        super::pending::StartTarget::Rotation(origin, matrix),
                        value,
                        scope,
                    );
                }
            }
            "velocity" => self.pending_start(
                velocity_role,
                super::pending::StartTarget::Velocity(origin),
                value,
                scope,
            ),
            "angular_velocity" => self.pending_start(
                velocity_role,
                super::pending::StartTarget::AngularVelocity(origin),
                value,
                scope,
            ),
            _ => {
                return self.checked(None, place, "no start value of a body");
            }
        }
        Ok(())
    }
}

/// `[2]`, `[2,1]`, or nothing.
pub(crate) fn index_text(position: &[usize]) -> String {
    if position.is_empty() {
        return String::new();
    }
    let numbers: Vec<String> = position.iter().map(usize::to_string).collect();
    format!("[{}]", numbers.join(","))
}
