//! Outputs of elements, their channels, and the closing of an element's graph.

use super::body::index_text;
use super::element::{Class, Draft, is_marker};
use super::scalar::{ElementBuilder, PROVISIONAL, Scalar, Stage, compact_input};
use super::value::{Axes, ScopeId, Shown, Value};
use super::{
    ClassMeta, Elaborator, ElementDraft, ElementSource, Entry, Eval, OutputShape, Reported,
    location,
};
use crate::codes;
use crate::ir::differentiate::{Place, reads};
use crate::ir::{ClassBody, Graph, KinkPlace, Node, Op};
use eng_grammar::ast::{self, BindingKind, ItemKind, Kind};
use eng_grammar::{Diagnostic, Span};
use eng_system::layout::InputLayout;
use eng_system::system::{Channel, Depth, Origin, OutputInfo, Role, StateInfo};
use eng_system::{Dimension, DisplayUnit};

/// Most operations of one element, without its derivatives. Their compilation takes seconds. A choice: the
/// largest class of the library has some thousand.
const MOST_OPERATIONS: usize = 100_000;

/// The display of the numbers of an output.
#[derive(Clone)]
pub(crate) struct Columns {
    pub dimension: Dimension,
    /// The stated unit; `None` means the natural unit of the dimension.
    pub display: Option<DisplayUnit>,
    /// Whether the text declares the dimension.
    pub declared: bool,
    /// The class's name of the marker whose axes the components have.
    pub frame: Option<String>,
}

impl Columns {
    /// Columns in the natural unit of a dimension.
    pub fn of(dimension: Dimension) -> Columns {
        Columns {
            dimension,
            display: None,
            declared: false,
            frame: None,
        }
    }
}

impl<'a> Elaborator<'a, '_> {
    pub fn class_outputs(
        &mut self,
        items: &'a [ast::Item],
        scope: ScopeId,
        draft: &mut Draft,
    ) -> Eval<()> {
        for item in items {
            let ItemKind::Binding(b) = &item.kind else {
                continue;
            };
            if b.kind != BindingKind::Output {
                continue;
            }
            let Some(expr) = &b.value else { continue };
            // the class gives a value of its own
            if let Some(Entry::In(_)) = self.scope(scope).entries.get(&b.name.text) {
                continue;
            }
            let value = if self.scope(scope).entries.contains_key(&b.name.text) {
                self.entry(scope, &b.name.text, b.name.span)?
            } else {
                self.bound_value(b, expr, scope)?
            };
            let frame = b
                .frame
                .as_ref()
                .map(|f| self.sources.text(f.span).to_owned());
            let place = b.ty.as_ref().map_or(expr.span, |ty| ty.span);
            let shown = Columns {
                dimension: self.dimension_at(place, scope)?,
                display: self.display_of(b)?,
                declared: b.ty.is_some(),
                frame,
            };
            let values = match value {
                Value::Family(values) => values,
                value => vec![(Vec::new(), value)],
            };
            self.as_promised(b, scope, &values)?;
            for (index, value) in values {
                let shown = shown.clone();
                self.add_output((&b.name.text, index), value, expr.span, shown, draft)?;
            }
        }
        Ok(())
    }

    /// The stated unit of an output.
    pub fn display_of(&mut self, output: &ast::Binding) -> Eval<Option<DisplayUnit>> {
        let unit = output.display.as_ref().map(|unit| self.unit(unit));
        Ok(unit.transpose()?.map(DisplayUnit::from))
    }

    /// Adds an output. A vector becomes its components along the stated axes.
    fn add_output(
        &mut self,
        (name, index): (&str, Vec<usize>),
        value: Value<'a>,
        span: Span,
        shown: Columns,
        draft: &mut Draft,
    ) -> Eval<()> {
        let place = index_text(&index);
        let vector = matches!(value, Value::Vector(_) | Value::Shown(_));
        let single = !value.is_several();
        let (components, axes) = match value {
            Value::Vector(v) => (v.to_vec(), Some(Axes::Ground)),
            Value::Shown(shown) => (shown.components.to_vec(), Some(shown.axes)),
            Value::Components(c, axes) => (c, Some(axes)),
            Value::List(_) => (self.as_components(value, span)?, None),
            Value::Flag(flag) => {
                let one = self.graphs.constant(1.0);
                let zero = self.graphs.constant(0.0);
                (vec![self.graphs.select(flag, one, zero)], None)
            }
            Value::Bool(known) => {
                let number = if known { 1.0 } else { 0.0 };
                (vec![self.graphs.constant(number)], None)
            }
            other => (vec![self.as_scalar(other, span)?], None),
        };
        let first = draft.outputs.len() as u32;
        let frame_name = match (shown.frame, axes) {
            (Some(text), _) => text,
            (None, Some(axes)) => self.axes_path(axes),
            (None, None) => String::new(),
        };
        let count = components.len() as u32;
        for (i, s) in components.into_iter().enumerate() {
            let node = self.graphs.lift(s.stage, s.node);
            draft.outputs.push(node);
            draft.frames.push(axes);
            let suffix = match (single, ["x", "y", "z"].get(i)) {
                (true, _) => String::new(),
                (false, Some(axis)) if count <= 3 => format!(".{axis}"),
                _ => format!("[{}]", i + 1),
            };
            draft.infos.push(OutputInfo {
                name: format!("{name}{place}{suffix}"),
                dimension: shown.dimension,
                display: shown
                    .display
                    .clone()
                    .unwrap_or_else(|| self.natural_unit(shown.dimension)),
                frame: frame_name.clone(),
                // known as soon as the class has its functions
                depth: Depth::Acceleration,
            });
        }
        draft.shapes.push(OutputShape {
            name: name.to_owned(),
            index,
            first,
            count: if single { 1 } else { count },
            axes,
            vector,
        });
        Ok(())
    }

    /// Adds the outputs `force` and `torque` of joints and drives: the wrench of the constraints on the first
    /// marker, at its origin, in the second marker's axes.
    pub fn reaction_outputs(&mut self, class: &Class<'a>, draft: &mut Draft) -> Eval<()> {
        if !matches!(class.declaration.kind, Kind::Joint | Kind::Drive) {
            return Ok(());
        }
        let Some(element) = self.graphs.element.as_mut() else {
            return Ok(());
        };
        if element.rows.is_empty() || element.markers.len() < 2 {
            return Ok(());
        }
        let g = &mut element.graph;
        let mut power = g.constant(0.0);
        for (i, row) in element.rows.iter().enumerate() {
            let lambda = g.input(PROVISIONAL.multiplier(i as u32));
            let p = g.multiply(lambda, row.node);
            power = g.add(power, p);
        }
        let first = PROVISIONAL.marker(0);
        let inputs: Vec<u32> = (first..first + 12).collect();
        let gradient = crate::ir::differentiate::gradient(g, power, &inputs);
        let scalar = |node| Scalar {
            stage: Stage::Motion,
            node,
        };
        let newton = Dimension::MASS
            .times(Dimension::LENGTH)
            .over(Dimension::TIME)
            .over(Dimension::TIME);
        let newton_metre = newton.times(Dimension::LENGTH);
        let force = [0, 1, 2].map(|i| {
            let n = g.negate(gradient[i]);
            scalar(n)
        });
        // δR = R δπ~, so torque k in marker axes is Σ ∂/∂R_ij (R e_k~)_ij; R e_k~ consists of columns of R
        let r: Vec<Node> = (0..9).map(|i| g.input(first + 3 + i)).collect();
        let torque = [0usize, 1, 2].map(|k| {
            let (i1, i2) = ((k + 1) % 3, (k + 2) % 3);
            let mut sum = g.constant(0.0);
            for row in 0..3 {
                // column i1 of R e_k~ is column i2 of R; column i2 is minus column i1
                let p = g.multiply(gradient[3 + 3 * row + i1], r[3 * row + i2]);
                sum = g.add(sum, p);
                let q = g.multiply(gradient[3 + 3 * row + i2], r[3 * row + i1]);
                sum = g.subtract(sum, q);
            }
            let n = g.negate(sum);
            scalar(n)
        });
        let second = element.markers[1];
        let torque = self.rotate(0, &torque);
        let mut markers = Vec::new();
        for parameter in class.parameters.iter() {
            if is_marker(&self.type_at(parameter.ty.span)?) {
                markers.push(&parameter.name.text);
            }
        }
        let frame_name = markers.get(1).map_or("reference", |name| name);
        let span = class.declaration.name.span;
        for (name, vector, dimension) in
            [("force", force, newton), ("torque", torque, newton_metre)]
        {
            if draft.shapes.iter().all(|s| s.name != name) {
                let value = self.shown(Value::Vector(vector), Axes::Marker(second), span)?;
                let shown = Columns {
                    frame: Some(frame_name.to_owned()),
                    ..Columns::of(dimension)
                };
                self.add_output((name, Vec::new()), value, span, shown, draft)?;
            }
        }
        Ok(())
    }

    /// Finishes the present element: compact layout, channels, draft of the class.
    pub fn finish_element(
        &mut self,
        origin: Origin,
        span: Span,
        role: Role,
        class_name: String,
        source: Option<ElementSource<'a>>,
        draft: Draft,
    ) -> Eval<u32> {
        let (changing, bound_kinks) = match role {
            Role::Dynamic => self.changing_constants(),
            _ => Default::default(),
        };
        let (bound_kinks, bound_texts) = bound_kinks.into_iter().unzip();
        let Some(mut element) = self.graphs.element.take() else {
            return Err(Reported);
        };
        let layout = element.layout();
        let zero = element.graph.constant(0.0);
        element.loads.resize(element.markers.len(), [zero; 6]);
        if let Some(message) = too_large(&element) {
            return Err(self.report(message.at(span, "this one")));
        }
        let (graph, map) = compact(&element.graph, &layout);
        let at = |n: &Node| map[n.0 as usize];
        let followed = std::mem::take(&mut element.followed);
        let body = ClassBody {
            name: class_name.clone(),
            layout,
            rows: element.rows.iter().map(|r| at(&r.node)).collect(),
            loads: element
                .loads
                .iter()
                .map(|l| [0, 1, 2, 3, 4, 5].map(|i| at(&l[i])))
                .collect(),
            rates: element
                .states
                .iter()
                .filter_map(|s| s.rate.as_ref().map(at))
                .collect(),
            outputs: (draft.outputs.iter())
                .chain(followed.iter().map(|(node, _)| node))
                .map(at)
                .collect(),
            conditions: draft.conditions.iter().map(|c| at(&c.0)).collect(),
            rotations: element.rotations.iter().map(|r| at(&r.2)).collect(),
            drives: (element.fields.iter())
                .flat_map(|field| field.drives.iter().map(at))
                .collect(),
            turns: element.turns.iter().map(at).collect(),
            wraps: (element.wraps.iter())
                .map(|(wrapped, zero)| (at(wrapped), at(zero)))
                .collect(),
            stops: element.stops.iter().map(at).collect(),
            changing,
            bound_kinks,
            graph,
        };
        let jumps = self.jumps(&element);
        let index = self.draft.elements.len() as u32;
        let first_channel = self.draft.channels.len() as u32;
        if matches!(role, Role::Dynamic | Role::Output) {
            self.add_channels(index, role, &origin.path, &draft, |output| {
                !reads(&body.graph, body.outputs[output], &body.layout, &jumps)
            });
        }
        let behind = (index, draft.infos.len() as u32);
        let infos = self.followed_outputs(&followed, behind);
        let meta = ClassMeta {
            rows: element.rows.iter().map(|r| r.row.clone()).collect(),
            states: element
                .states
                .iter()
                .map(|s| StateInfo {
                    name: s.name.clone(),
                    dimension: s.dimension,
                })
                .collect(),
            outputs: [draft.infos, infos].concat(),
            conditions: draft.conditions.into_iter().map(|c| c.1).collect(),
            kinks: (std::mem::take(&mut element.kinks).into_iter())
                .map(|(place, kink)| {
                    let node = at(&place.node);
                    (KinkPlace { node, ..place }, kink)
                })
                .collect(),
            bound_kinks: bound_texts,
        };
        self.draft.elements.push(ElementDraft {
            origin,
            span,
            role,
            source,
            outputs: draft.shapes,
            first_channel,
            class_name,
            body,
            meta,
            markers: element.markers,
            constants: element.constants,
            state_start: element.states.iter().map(|s| s.start).collect(),
            state_scale: element.states.iter().map(|s| s.scale).collect(),
            resolves: element.resolves,
            places: element.places,
            signals: element.signals,
            fields: element.fields,
            applied: element.applied,
            rotations: (0..)
                .zip(&element.rotations)
                .map(|(index, (a, b, _))| {
                    let stated = element.stated.iter().find(|s| s.0 == index);
                    (*a, *b, stated.map(|s| s.1))
                })
                .collect(),
        });
        Ok(index)
    }

    /// Whether an input of an element's outputs is a result or channel that jumps in a continuous motion.
    fn jumps(&self, element: &ElementBuilder) -> impl Fn(Place) -> bool + use<> {
        let readings = (element.fields.iter()).flat_map(|field| field.kernel.readings);
        let readings = readings.flat_map(|row| (0..row.count).map(|_| row.continuous));
        let readings: Vec<bool> = readings.collect();
        let signals = element.signals.iter();
        let signals = signals.map(|at| self.draft.channels.get(*at as usize));
        let signals = signals.map(|source| source.is_none_or(|channel| channel.continuous));
        let signals: Vec<bool> = signals.collect();
        move |place| match place {
            Place::Reading(reading) => readings.get(reading as usize) == Some(&false),
            Place::Signal(signal) => signals.get(signal as usize) == Some(&false),
            _ => false,
        }
    }

    /// The channels of an element's outputs; `continuous` marks the continuous ones.
    fn add_channels(
        &mut self,
        element: u32,
        role: Role,
        of: &str,
        draft: &Draft,
        continuous: impl Fn(usize) -> bool,
    ) {
        for (i, info) in draft.infos.iter().enumerate() {
            let copied = draft.copied.iter().find(|(output, _)| *output == i);
            let frame = match (draft.frames[i], copied) {
                (Some(axes), _) => self.axes_path(axes),
                (None, Some((_, path))) => path.clone(),
                (None, None) => String::new(),
            };
            let path = match (role, info.name.as_str()) {
                // an output of the model is an element of its own
                (Role::Output, name) => match name.find(['.', '[']) {
                    Some(at) => format!("{of}{}", &name[at..]),
                    None => of.to_owned(),
                },
                (_, name) => format!("{of}.{name}"),
            };
            self.draft.channels.push(Channel {
                path,
                element,
                output: i as u32,
                dimension: info.dimension,
                display: info.display.clone(),
                frame,
                continuous: continuous(i),
            });
        }
    }

    /// The value of `joint.output`, or of another name of its class.
    pub fn element_field(&mut self, index: u32, name: &ast::Name) -> Eval<Value<'a>> {
        let draft = &self.draft.elements[index as usize];
        let shapes = draft.outputs.iter().filter(|s| s.name == name.text);
        let shapes: Vec<OutputShape> = shapes.cloned().collect();
        let first_channel = draft.first_channel;
        let source = draft.source.clone();
        let path = draft.origin.path.clone();
        if !shapes.is_empty() && self.context.in_output && !self.context.in_rate {
            let mut family = Vec::with_capacity(shapes.len());
            for shape in shapes {
                let value = self.recorded(first_channel, &shape)?;
                if shape.index.is_empty() {
                    return Ok(value);
                }
                family.push((shape.index, value));
            }
            return Ok(Value::Family(family));
        }
        let Some(source) = source else {
            return Err(Reported);
        };
        let class = self.class_of(source.definition, name.span)?;
        // only parameters are allowed here: the mistake is in the text that passes a quantity of the motion
        let asks = self.graphs.element.is_none() && self.context.asked_from.is_none();
        if asks {
            self.context.asked_from = Some((name.span, format!("{path}.{}", name.text)));
        }
        let own = self
            .class_scope(&source, &class, &path)
            .map(|scope| scope.own);
        let value = own.and_then(
            |own| match self.scope(own).entries.contains_key(&name.text) {
                true => self.entry(own, &name.text, name.span),
                false => Err(self.only_in_outputs(&path, name)),
            },
        );
        if asks {
            self.context.asked_from = None;
        }
        value
    }

    /// An output of an element that is not the present one.
    fn recorded(&mut self, first_channel: u32, shape: &OutputShape) -> Eval<Value<'a>> {
        let mut scalars = Vec::new();
        for k in 0..shape.count {
            let channel = first_channel + shape.first + k;
            let Some(element) = self.graphs.element.as_mut() else {
                return Err(Reported);
            };
            scalars.push(Scalar {
                stage: Stage::Motion,
                node: element.signal(channel),
            });
        }
        Ok(match (scalars.as_slice(), shape.axes) {
            (&[x, y, z], Some(axes)) if shape.vector => Value::Shown(Shown {
                components: [x, y, z],
                axes,
                space: None,
            }),
            (_, Some(axes)) => Value::Components(scalars, axes),
            (&[one], None) => Value::Scalar(one),
            (many, None) => Self::list(many),
        })
    }

    /// The message about a reaction or state of an element outside of outputs.
    fn only_in_outputs(&mut self, path: &str, name: &ast::Name) -> Reported {
        self.report(if self.context.in_rate {
            Diagnostic::error(
                codes::NO_RATE,
                format!("the rate of `{path}.{}` is not known", name.text),
            )
            .at(name.span, "a reaction or state of an element")
            .with_help("positions, angles and velocities have a `der`")
        } else {
            Diagnostic::error(
                codes::OUTPUTS_ONLY,
                format!("`{path}.{}` can be used in outputs only", name.text),
            )
            .at(name.span, "a reaction or state of another element")
            .with_help(
                "an element reads only markers and parameters: compute the quantity from markers",
            )
        })
    }

    /// Adds an element that is only a start condition: rows = value − target.
    pub fn start_element(
        &mut self,
        role: Role,
        path: String,
        span: Span,
        dimension: Dimension,
        rows: Vec<(Scalar, String)>,
    ) -> Eval<()> {
        for (value, text) in rows {
            self.add_row(value, dimension, text, span)?;
        }
        let origin = Origin {
            path,
            used_at: Some(location(span)),
            defined_at: None,
        };
        self.finish_element(origin, span, role, "start".into(), None, Draft::default())?;
        Ok(())
    }

    /// Adds an element with outputs only. A copied component keeps the frame of its channel.
    pub fn output_element(
        &mut self,
        path: String,
        values: Vec<(String, Value<'a>, Columns)>,
        span: Span,
    ) -> Eval<u32> {
        let mut draft = Draft::default();
        let plain = |(_, _, shown): &(String, Value<'a>, Columns)| {
            shown.display.is_none() && !shown.declared
        };
        let as_copied = values.iter().all(plain);
        for (name, value, shown) in values {
            self.add_output((&name, Vec::new()), value, span, shown, &mut draft)?;
        }
        for (i, node) in draft.outputs.iter().enumerate() {
            if let Some(element) = self.graphs.element.as_ref()
                && let Op::Input(input) = element.graph.op(*node)
                && input >= PROVISIONAL.signal(0)
            {
                let channel = element.signals[(input - PROVISIONAL.signal(0)) as usize];
                let copied = &self.draft.channels[channel as usize];
                draft.copied.push((i, copied.frame.clone()));
                if as_copied {
                    draft.infos[i].display = copied.display.clone();
                }
            }
        }
        self.call_conditions(&mut draft);
        let origin = Origin {
            path,
            used_at: Some(location(span)),
            defined_at: None,
        };
        self.finish_element(origin, span, Role::Output, "output".into(), None, draft)
    }
}

/// Copies a graph with its inputs moved to the compact layout.
fn compact(graph: &Graph, layout: &InputLayout) -> (Graph, Vec<Node>) {
    let mut out = Graph::new();
    let mut map: Vec<Node> = Vec::with_capacity(graph.nodes().len());
    for op in graph.nodes() {
        let mapped = match *op {
            Op::Input(i) => Op::Input(compact_input(i, layout)),
            other => other.map_operands(|n| map[n.0 as usize]),
        };
        let node = out.push(mapped);
        map.push(node);
    }
    (out, map)
}

/// The message about an element that is larger than machine code or its inputs allow.
fn too_large(element: &ElementBuilder) -> Option<Diagnostic> {
    if element.constants.len() as u32 > PROVISIONAL.constants
        || element.signals.len() as u32 > PROVISIONAL.signals
    {
        let message = Diagnostic::error(
            codes::ELEMENT_TOO_LARGE,
            format!(
                "one element uses more than {} outputs of others or {} numbers",
                PROVISIONAL.signals, PROVISIONAL.constants
            ),
        );
        return Some(message.with_help("divide it into several elements or outputs"));
    }
    (element.graph.nodes().len() > MOST_OPERATIONS).then(|| {
        Diagnostic::error(
            codes::ELEMENT_TOO_LARGE,
            format!("one element needs more than {MOST_OPERATIONS} operations"),
        )
        .with_help("where functions call each other twice, give values that are used twice a name with `let`; or divide it into several elements or outputs")
    })
}
