//! Inputs: parameters that change during a run, and all values that change with them.
//!
//! An input is a parameter of the bind graph. Elaboration marks the operations and slots that depend on one. The
//! runtime computes these again when an input changes. A slot that decides structure, geometry, mass, a start or a
//! constraint must not be among them.

use super::BindProgram;
use super::binding::{Stated, span_of};
use super::body::index_text;
use super::finish::Structural;
use super::output::Columns;
use super::partial::{Passed, all_arguments};
use super::scalar::{ElementBuilder, PROVISIONAL, RATE, Scalar, Stage, TIME};
use super::value::{ScopeId, Value};
use super::{Elaborator, Eval};
use crate::codes;
use crate::ir::{ClassBody, Node, Op, dependencies};
use crate::program::DefinitionId;
use eng_grammar::ast::{self, BindingKind, ExprKind, ItemKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::DisplayUnit;
use eng_system::input::{Input, Interpolation};
use eng_system::system::{BodyInertia, ConditionKind, Location, Origin, Role, Slot, System};

/// A use of a slot that must not change during a run.
struct Fixed<'s> {
    /// Path of the body, marker or element.
    path: &'s str,
    /// Place of the use.
    at: Option<Location>,
    slot: Slot,
    decides: &'static str,
}

impl<'a> Elaborator<'a, '_> {
    /// The value of a `param` or `input`: a parameter, or one for each number of a list or place of an index.
    pub fn changeable(&mut self, binding: &'a ast::Binding, scope: ScopeId) -> Eval<Value<'a>> {
        let expr = binding.value.as_ref();
        let expr = self.checked(expr, binding.name.span, "a parameter without a value")?;
        let path = self.path(scope, &binding.name.text);
        if binding.index.is_empty() {
            return self.changeable_at(binding, expr, path, scope);
        }
        let mut values = Vec::new();
        self.for_each(&binding.index, scope, &mut |e, inner, position| {
            let own = format!("{path}{}", index_text(position));
            values.push((
                position.to_vec(),
                e.changeable_at(binding, expr, own, inner)?,
            ));
            Ok(())
        })?;
        Ok(Value::Family(values))
    }

    fn changeable_at(
        &mut self,
        binding: &'a ast::Binding,
        expr: &'a ast::Expr,
        path: String,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let signal = match binding.kind {
            BindingKind::Input => self.draft.signals.get(&path).copied(),
            _ => None,
        };
        let value = match signal {
            Some(signal) => self.over_time(signal, binding.name.span)?,
            None => self.evaluate(expr, scope)?,
        };
        let place = binding.ty.as_ref().map_or(expr.span, |ty| ty.span);
        let stated = Stated {
            expr,
            dimension: self.dimension_at(place, scope)?,
            limits: binding.limits.as_ref(),
            span: binding.name.span,
            scope,
        };
        let first = self.draft.parameters.len();
        let value = self.parameterise(value, &path, stated)?;
        if binding.kind == BindingKind::Input {
            let word = binding.interpolation.as_ref();
            let interpolation = word.and_then(|word| Interpolation::named(&word.text));
            for parameter in first..self.draft.parameters.len() {
                self.draft.inputs.push(Input {
                    parameter: parameter as u32,
                    interpolation: interpolation.unwrap_or_default(),
                    differentiated: false,
                    signal: signal
                        .and_then(|id| self.program.item(id))
                        .and_then(name_of),
                });
            }
        }
        let value = self.declared(value, binding.ty.as_ref())?;
        self.binding_as_stated(binding, expr, &value, scope)?;
        Ok(value)
    }

    /// The function or table of time that an analysis gives to an input, by its name.
    pub fn signal(
        &mut self,
        expr: &ast::Expr,
        value: &Value<'a>,
        scope: ScopeId,
    ) -> Eval<Structural> {
        let module = self.scope(scope).module;
        let named = match &expr.kind {
            ExprKind::Name(name) => self.program.lookup(module, name),
            _ => None,
        };
        if is_derivative_of_table(value) {
            return Err(self.report(
                Diagnostic::error(codes::NOT_HANDED_ON, "the derivative of a table gives no input")
                    .at(expr.span, "an input takes a function, or a table itself")
                    .with_help(
                        "define a function of it at the top of the file: `fn rate(t: Time) -> Force = slope(table, t)`",
                    ),
            ));
        }
        // the values of the input come from the definition, which does not know the dimensions that are found
        // here
        let here = self.solution_at(expr.span, scope);
        let generic = here.is_some_and(|solution| !solution.is_empty());
        match named.filter(|_| !generic) {
            Some(id) => Ok(Structural::Signal(id)),
            None => Err(self.report(
                Diagnostic::error(
                    codes::NOT_HANDED_ON,
                    "an input takes a function of time by its name",
                )
                .at(expr.span, "no function or table with a name of its own, or one of any dimension")
                .with_help(
                    "define it at the top of the file: `fn ramp(t: Time) -> Torque = …` or `table ramp(t: Time) -> Torque = points(…)`",
                ),
            )),
        }
    }

    /// The value of a function or table at the time of the run.
    fn over_time(&mut self, signal: DefinitionId, span: Span) -> Eval<Value<'a>> {
        let time = Scalar {
            stage: Stage::Bind,
            node: self.graphs.bind.graph.input(TIME),
        };
        let function = self.definition(signal, span)?;
        let scope = self.module_scopes[signal.module as usize];
        let passed = vec![Passed {
            place: 0,
            value: Value::Scalar(time),
            span,
            scope,
        }];
        let (function, passed) = match &function {
            Value::Partial(partial) if partial.order == 0 => {
                (&partial.function, all_arguments(partial, passed))
            }
            other => (other, passed),
        };
        match function {
            Value::Table(table) => self.table_at(*table, passed, span).map(Value::Scalar),
            function => self.apply(function, passed, span, scope),
        }
    }

    /// The indices of the inputs that values depend on, ascending: values of the bind stage, or of the present element.
    pub fn inputs_in(&self, values: &[Scalar]) -> Vec<usize> {
        let mut found = Vec::new();
        if self.draft.inputs.is_empty() {
            return found;
        }
        let mut waiting: Vec<Node> = Vec::new();
        let mut motion: Vec<Node> = Vec::new();
        for value in values {
            match value.stage {
                Stage::Bind => waiting.push(value.node),
                Stage::Motion => motion.push(value.node),
            }
        }
        if let Some(element) = &self.graphs.element {
            let needed = dependencies(&element.graph, &motion);
            let used = element.graph.nodes().iter().zip(&needed);
            for (op, _) in used.filter(|(_, needed)| **needed) {
                if let Op::Input(input) = op
                    && let Some(constant) = input.checked_sub(PROVISIONAL.constant(0))
                {
                    waiting.extend(element.constants.get(constant as usize));
                }
            }
        }
        let graph = &self.graphs.bind.graph;
        let mut seen = vec![false; graph.nodes().len()];
        while let Some(node) = waiting.pop() {
            if std::mem::replace(&mut seen[node.0 as usize], true) {
                continue;
            }
            match graph.op(node) {
                Op::Input(index) => {
                    let mut inputs = self.draft.inputs.iter();
                    found.extend(inputs.position(|input| input.parameter == index));
                    // an argument of a class is a parameter of its own, whose default reads the input
                    waiting.extend(self.draft.parameter_defaults.get(index as usize));
                }
                op => waiting.extend(op.operands()),
            }
        }
        found.sort_unstable();
        found
    }

    /// The channels of an input.
    pub fn lower_input(&mut self, binding: &'a ast::Binding, scope: ScopeId) -> Eval<()> {
        let name = &binding.name;
        let base = self.path(scope, &name.text);
        let value = self.entry(scope, &name.text, name.span)?;
        let place = binding.ty.as_ref().map(|ty| ty.span);
        let place = place.or(binding.value.as_ref().map(|value| value.span));
        let dimension = self.dimension_at(place.unwrap_or(name.span), scope)?;
        let stated = self.display_of(binding)?;
        let members = match value {
            Value::Family(members) => members,
            value => vec![(Vec::new(), value)],
        };
        for (index, value) in members {
            let path = format!("{base}{}", index_text(&index));
            self.graphs.element = Some(ElementBuilder::default());
            self.context.in_output = true;
            self.graphs.bind.owner.clone_from(&path);
            let display = stated.clone().or_else(|| self.unit_of_input(&path));
            let shown = Columns {
                display,
                declared: true,
                ..Columns::of(dimension)
            };
            self.output_element(path, vec![(name.text.clone(), value, shown)], name.span)?;
            self.graphs.element = None;
            self.context.in_output = false;
        }
        Ok(())
    }

    /// The unit of an input, or of the first number of a list.
    fn unit_of_input(&self, path: &str) -> Option<DisplayUnit> {
        let first = format!("{path}[1]");
        let mut parameters = self.draft.parameters.iter();
        let found = parameters.find(|p| p.origin.path == path || p.origin.path == first);
        found.map(|parameter| parameter.display.clone())
    }

    /// Marks everything that changes with the inputs, and refuses inputs that decide constant quantities.
    pub fn follow_inputs(
        &mut self,
        system: &mut System,
        program: &mut BindProgram,
        bodies: &[ClassBody],
    ) -> Eval<()> {
        if system.inputs.is_empty() {
            return Ok(());
        }
        let all: Vec<u32> = system.inputs.iter().map(|i| i.parameter).collect();
        let moves = program.depends(|k| k == TIME || all.contains(&k));
        let slot_moves = |slot: Slot| {
            let node = program.function.outputs.get(slot.0 as usize);
            node.is_some_and(|node| moves[node.0 as usize])
        };
        let refused = fixed_uses(system, bodies)
            .into_iter()
            .find(|fixed| slot_moves(fixed.slot));
        if let Some(fixed) = refused {
            let node = program.function.outputs.get(fixed.slot.0 as usize);
            let deciding = system.inputs.iter().find(|input| {
                let moves = program.depends(|k| k == input.parameter);
                node.is_some_and(|node| moves[node.0 as usize])
            });
            let parameter = deciding.and_then(|i| system.parameters.get(i.parameter as usize));
            return Err(self.decided_by_input(&fixed, parameter.map(|p| &p.origin)));
        }
        system.moving = (0..system.slots)
            .map(Slot)
            .filter(|s| slot_moves(*s))
            .collect();
        // loads that a function of time drives change with time itself
        let over_time = program.depends(|k| k == TIME);
        for element in system.elements.iter().filter(|e| e.role == Role::Dynamic) {
            let timed = element.constants.iter().any(|slot| {
                let node = program.function.outputs.get(slot.0 as usize);
                node.is_some_and(|node| over_time[node.0 as usize])
            });
            if timed && let Some(class) = system.classes.get_mut(element.class as usize) {
                class.facts.loads_over_time = true;
            }
        }
        program.moving = (0..)
            .zip(&moves)
            .filter(|(_, moves)| **moves)
            .map(|(node, _)| Node(node))
            .collect();
        program.moving_slots.clone_from(&system.moving);
        Ok(())
    }

    fn decided_by_input(&mut self, fixed: &Fixed<'_>, input: Option<&Origin>) -> super::Reported {
        let name = input.map_or("an input", |input| input.path.as_str());
        let title = format!(
            "the input `{name}` decides {} of `{}`, which cannot change during a run",
            fixed.decides,
            // the path of a start value has the same words
            fixed.path.trim_start_matches("start of ")
        );
        let mut message = Diagnostic::error(codes::INPUT_DECIDES, title);
        message = message.at_if(
            fixed.at.map(span_of),
            format!("`{name}` decides {} here", fixed.decides),
        );
        if let Some(declared) = input.and_then(|input| input.used_at) {
            message = message.also(span_of(declared), "declared as `input` here");
        }
        let message =
            message.with_help("make it a `param`: `--set` and a program set it before a run");
        self.report(match fixed.decides {
            "a constraint" => message.with_help(
                "let a torque or force follow the input: a constraint would need its acceleration, and an input has none",
            ),
            _ => message,
        })
    }
}

impl BindProgram {
    /// For each operation, whether it depends on an input of the graph for which `changes` holds: a parameter, or
    /// [`TIME`]. A parameter depends on its default.
    pub(super) fn depends(&self, changes: impl Fn(u32) -> bool) -> Vec<bool> {
        let nodes = self.function.graph.nodes();
        let mut moves: Vec<bool> = Vec::with_capacity(nodes.len());
        let known = |moves: &[bool], node: Node| moves.get(node.0 as usize) == Some(&true);
        for op in nodes {
            let moved = match *op {
                Op::Input(k) => {
                    // a rate follows the inputs that its parameter follows
                    let k = match k {
                        TIME => k,
                        RATE.. => k - RATE,
                        k => k,
                    };
                    let default = self.defaults.get(k as usize);
                    changes(k) || default.is_some_and(|default| known(&moves, *default))
                }
                op => op.operands().any(|operand| known(&moves, operand)),
            };
            moves.push(moved);
        }
        moves
    }
}

/// Whether a function is the slope or curvature of a table.
fn is_derivative_of_table(value: &Value<'_>) -> bool {
    let (mut inner, mut order) = (value, 0);
    while let Value::Partial(partial) = inner {
        order = partial.order.max(order);
        inner = &partial.function;
    }
    order > 0 && matches!(inner, Value::Table(_))
}

/// The name of a function or table; `None` for another item.
fn name_of(item: &ast::Item) -> Option<String> {
    match &item.kind {
        ItemKind::Function(function) => Some(function.name.text.clone()),
        ItemKind::Table(table) => Some(table.name.text.clone()),
        _ => None,
    }
}

/// All slots that must not change during a run.
fn fixed_uses<'s>(system: &'s System, bodies: &[ClassBody]) -> Vec<Fixed<'s>> {
    let mut found = Vec::new();
    let mut add = |origin: &'s Origin, decides: &'static str, slots: &[Slot]| {
        let stated = |name: &str| {
            system
                .stated
                .get(&format!("{}.{name}", origin.path))
                .copied()
        };
        let at = match decides {
            "the mass" => stated("mass"),
            "the inertia" => stated("inertia"),
            "the centre of mass" => stated("center_of_mass"),
            _ => None,
        };
        found.extend(slots.iter().map(|slot| Fixed {
            path: &origin.path,
            at: at.or(origin.used_at),
            slot: *slot,
            decides,
        }));
    };
    for body in &system.bodies {
        if let BodyInertia::Rigid {
            mass,
            center_of_mass,
            inertia,
        } = &body.inertia
        {
            add(&body.origin, "the mass", &[*mass]);
            add(&body.origin, "the centre of mass", center_of_mass);
            add(&body.origin, "the inertia", inertia);
        }
        add(
            &body.origin,
            "the place",
            body.position.as_ref().map_or(&[], |p| p),
        );
        add(
            &body.origin,
            "the place",
            body.orientation.as_ref().map_or(&[], |o| o),
        );
    }
    for marker in &system.markers {
        add(&marker.origin, "the place", &marker.position);
        add(&marker.origin, "the place", &marker.orientation);
    }
    if let Some(cycle) = &system.cycle {
        add(&cycle.origin, "the period", &[cycle.period]);
    }
    let element = |index: u32| system.elements.get(index as usize).map(|e| &e.origin);
    for journal in &system.journals {
        if let Some(origin) = element(journal.element) {
            add(origin, "the clearance", &[journal.clearance]);
        }
    }
    for firing in &system.firings {
        if let Some(origin) = element(firing.element) {
            add(
                origin,
                "the bore or the firing angle",
                &[firing.angle, firing.bore],
            );
        }
    }
    let in_rows: Vec<Vec<bool>> = bodies
        .iter()
        .zip(&system.classes)
        .map(|(body, class)| {
            let branches = body.conditions.iter().zip(&class.conditions);
            let branches = branches.filter(|(_, c)| c.kind == ConditionKind::Branch);
            let roots = body
                .rows
                .iter()
                .copied()
                .chain(branches.map(|(node, _)| *node));
            constants_in(body, roots.collect())
        })
        .collect();
    for element in &system.elements {
        let origin = &element.origin;
        add(origin, "the start", &element.state_start);
        add(origin, "the scale", &element.state_scale);
        add(origin, "the resolution", &element.resolves);
        for place in &element.places {
            add(origin, "the height", place.height.as_slice());
        }
        for (_, slots) in element.fields.iter().flat_map(|field| &field.settings) {
            add(origin, "the geometry of a field", slots);
        }
        for rotation in &element.rotations {
            add(origin, "the start", rotation.stated.as_slice());
        }
        match element.role {
            Role::StartPosition { .. } | Role::StartVelocity { .. } => {
                add(origin, "the start", &element.constants);
            }
            Role::Dynamic => {
                let of_rows = in_rows.get(element.class as usize);
                let constants = element.constants.iter().zip(of_rows.into_iter().flatten());
                for (slot, _) in constants.filter(|(_, in_rows)| **in_rows) {
                    add(origin, "a constraint", &[*slot]);
                }
            }
            Role::Output => {}
        }
    }
    found.extend(system.gravity.iter().map(|slot| Fixed {
        path: &system.name,
        at: system.stated.get("gravity").copied(),
        slot: *slot,
        decides: "the gravity",
    }));
    found
}

/// Whether each constant of a class is in one of the expressions.
fn constants_in(body: &ClassBody, roots: Vec<Node>) -> Vec<bool> {
    let layout = &body.layout;
    let mut found = vec![false; layout.constants as usize];
    let mut seen = vec![false; body.graph.nodes().len()];
    let mut waiting = roots;
    while let Some(node) = waiting.pop() {
        if std::mem::replace(&mut seen[node.0 as usize], true) {
            continue;
        }
        match body.graph.op(node) {
            Op::Input(input) => {
                let constant = input.checked_sub(layout.constant(0));
                if let Some(place) = constant.and_then(|k| found.get_mut(k as usize)) {
                    *place = true;
                }
            }
            op => waiting.extend(op.operands()),
        }
    }
    found
}
