//! Scalars in two stages: those of parameters alone are in the bind graph, and those of the motion in an
//! element's graph.
//!
//! If an expression combines both stages, the bind value becomes a constant of the element. So the code of a
//! class is the same for every instance, and the number comes from the instance's slots. Literals of a
//! class's text stay in its code.

use crate::ir::{Graph, KinkPlace, Node, Op};
use eng_system::Dimension;
use eng_system::field::{KERNELS, Kernel};
use eng_system::layout::{InputLayout, MARKER_WIDTH};
use eng_system::system::{FieldSource, Kink};
use std::collections::{BTreeMap, HashMap};

/// The graph of a scalar's node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// The bind graph: parameters alone.
    Bind,
    /// The element's graph: poses, twists, states, time.
    Motion,
}

/// A number (SI). Only the typed tree has its dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scalar {
    pub stage: Stage,
    pub node: Node,
}

/// A truth value whose value may depend on parameters or on the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Flag {
    pub stage: Stage,
    pub node: Node,
}

/// The input layout of every element while it is lowered. At the end it is compacted to the used inputs. The numbers
/// are choices far above those of the library's classes. A message refuses a class that exceeds one of them.
pub(crate) const PROVISIONAL: InputLayout = InputLayout {
    markers: 64,
    states: 64,
    rows: 256,
    rotations: 16,
    drives: 0,
    answers: 64,
    readings: 256,
    constants: 4096,
    signals: 1024,
};

/// First input of the bind graph that is a fixed number instead of a parameter. A power of two above the
/// number of parameters of any model, so that the kinds of inputs do not meet.
pub(crate) const FIXED: u32 = 1 << 24;

/// First input of the bind graph that is a number of a turn without forces, known after the turn alone.
pub(crate) const FOLLOWED: u32 = 1 << 25;

/// First input of the bind graph that is the rate of a parameter: that of parameter k is `RATE + k`.
pub(crate) const RATE: u32 = 1 << 26;

/// Input of the bind graph that is the time (s), for functions of time that give values of inputs.
pub(crate) const TIME: u32 = u32::MAX;

/// The bind graph while it grows.
#[derive(Debug, Default)]
pub(crate) struct BindBuilder {
    pub graph: Graph,
    /// Known numbers that are slots nevertheless: table handles, and literals as arguments of a class.
    pub fixed: Vec<f64>,
    /// Path of the present user of slots.
    pub owner: String,
    /// Path of the first user, by slot.
    pub owners: Vec<String>,
    /// Texts of operations that may have a kink.
    pub kinks: BTreeMap<KinkPlace, Kink>,
    slots: Vec<Node>,
    slot_of: HashMap<Node, u32>,
}

impl BindBuilder {
    /// The slot that holds a node's value.
    pub fn slot(&mut self, node: Node) -> eng_system::system::Slot {
        let next = self.slots.len() as u32;
        let index = *self.slot_of.entry(node).or_insert(next);
        if index == next {
            self.slots.push(node);
            self.owners.push(self.owner.clone());
        }
        eng_system::system::Slot(index)
    }

    /// A number that must not be folded into code.
    pub fn fixed(&mut self, value: f64) -> Node {
        let index = FIXED + self.fixed.len() as u32;
        self.fixed.push(value);
        self.graph.input(index)
    }

    pub fn slots(&self) -> &[Node] {
        &self.slots
    }
}

/// An element while it is lowered.
#[derive(Debug, Default)]
pub(crate) struct ElementBuilder {
    pub graph: Graph,
    /// Global indices of its markers.
    pub markers: Vec<u32>,
    /// Bind nodes of its constants.
    pub constants: Vec<Node>,
    constant_of: HashMap<Node, u32>,
    /// Pairs of local markers and the unwrapped angle's node.
    pub rotations: Vec<(u32, u32, Node)>,
    /// Angles stated by a `start`: index of the rotation, bind node.
    pub stated: Vec<(u32, Node)>,
    /// Channels it reads.
    pub signals: Vec<u32>,
    /// States: name, dimension, start value, rate.
    pub states: Vec<StateDraft>,
    pub rows: Vec<RowDraft>,
    /// Loads by local marker.
    pub loads: Vec<[Node; 6]>,
    /// The local markers of each `apply`: on, against.
    pub applied: Vec<(u32, Option<u32>)>,
    /// Conditions of called functions.
    pub call_conditions: Vec<CallCondition>,
    /// Bind nodes of the lengths that positions at its markers must resolve.
    pub resolves: Vec<Node>,
    /// Places that the assembly prefers: local markers, and the bind node of the height.
    pub places: Vec<(u32, u32, Option<Node>)>,
    /// Texts of operations that may have a kink.
    pub kinks: BTreeMap<KinkPlace, Kink>,
    /// Operations that count turns.
    pub turns: Vec<Node>,
    /// `wrapped` angles, and functions that are zero where they begin anew.
    pub wraps: Vec<(Node, Node)>,
    /// Conditions that end a run, as flags.
    pub stops: Vec<Node>,
    /// Its fields.
    pub fields: Vec<FieldDraft>,
    /// Quantities that lints follow through a turn, with their indices in the model.
    pub followed: Vec<(Node, u32)>,
}

/// A field while its element is lowered.
#[derive(Clone, Debug)]
pub(crate) struct FieldDraft {
    pub kernel: &'static Kernel,
    pub openings: u32,
    /// Nodes of the drives in the element's graph.
    pub drives: Vec<Node>,
    /// Bind nodes of the settings, by the name of the argument.
    pub settings: Vec<(&'static str, Vec<Node>)>,
    pub wholes: Vec<(&'static str, i64)>,
    pub words: Vec<(&'static str, &'static str)>,
    /// The local marker whose surface it presses on.
    pub surface: Option<u32>,
}

impl FieldDraft {
    /// The field with slots in place of nodes.
    pub fn source(self, bind: &mut BindBuilder) -> FieldSource {
        let kernel = KERNELS
            .iter()
            .position(|row| std::ptr::eq(row, self.kernel));
        FieldSource {
            kernel: kernel.unwrap_or(0) as u32,
            openings: self.openings,
            settings: (self.settings.into_iter())
                .map(|(name, nodes)| (name, nodes.iter().map(|n| bind.slot(*n)).collect()))
                .collect(),
            wholes: self.wholes,
            words: self.words,
            surface: self.surface,
        }
    }
}

/// A condition of a function that is called with values of the motion.
#[derive(Debug)]
pub(crate) struct CallCondition {
    pub advise: bool,
    /// Its name for `accept`; empty without a name.
    pub name: String,
    pub flag: Flag,
    pub message: super::requirement::Message,
    /// Place of the condition.
    pub span: eng_grammar::Span,
}

#[derive(Debug)]
pub(crate) struct StateDraft {
    pub name: String,
    pub dimension: Dimension,
    pub start: Node,
    /// The size that its errors are measured by.
    pub scale: Node,
    pub rate: Option<Node>,
}

#[derive(Debug)]
pub(crate) struct RowDraft {
    pub node: Node,
    pub row: eng_system::system::Row,
}

impl ElementBuilder {
    /// The local index of a global marker; `None` if there is no room.
    pub fn marker(&mut self, global: u32) -> Option<u32> {
        if let Some(i) = self.markers.iter().position(|m| *m == global) {
            return Some(i as u32);
        }
        if self.markers.len() as u32 >= PROVISIONAL.markers {
            return None;
        }
        self.markers.push(global);
        Some(self.markers.len() as u32 - 1)
    }

    /// An input of a marker: 0…2 x, 3…11 R, 12…14 ẋ, 15…17 ω in marker axes.
    pub fn marker_input(&mut self, marker: u32, component: u32) -> Node {
        debug_assert!(component < MARKER_WIDTH);
        self.graph.input(PROVISIONAL.marker(marker) + component)
    }

    /// The input of a constant that comes from a bind node.
    pub fn constant(&mut self, bind: Node) -> Node {
        let next = self.constants.len() as u32;
        let index = *self.constant_of.entry(bind).or_insert(next);
        if index == next {
            self.constants.push(bind);
        }
        self.graph.input(PROVISIONAL.constant(index))
    }

    /// The input of a channel.
    pub fn signal(&mut self, channel: u32) -> Node {
        let index = match self.signals.iter().position(|c| *c == channel) {
            Some(i) => i,
            None => {
                self.signals.push(channel);
                self.signals.len() - 1
            }
        };
        self.graph.input(PROVISIONAL.signal(index as u32))
    }

    /// The layout with the used inputs only.
    pub fn layout(&self) -> InputLayout {
        InputLayout {
            markers: self.markers.len() as u32,
            states: self.states.len() as u32,
            rows: self.rows.len() as u32,
            rotations: self.rotations.len() as u32,
            drives: self.fields.iter().map(|f| f.drives.len() as u32).sum(),
            answers: self.fields.iter().map(|f| f.kernel.answer_count()).sum(),
            readings: self.fields.iter().map(|f| f.kernel.reading_count()).sum(),
            constants: self.constants.len() as u32,
            signals: self.signals.len() as u32,
        }
    }
}

/// Maps a provisional input to its place in the compact layout.
pub(crate) fn compact_input(index: u32, to: &InputLayout) -> u32 {
    let p = &PROVISIONAL;
    if index < p.state(0) {
        index
    } else if index < p.multiplier(0) {
        to.state(index - p.state(0))
    } else if index < p.rotation(0) {
        to.multiplier(index - p.multiplier(0))
    } else if index < p.answer(0) {
        to.rotation(index - p.rotation(0))
    } else if index < p.reading(0) {
        to.answer(index - p.answer(0))
    } else if index < p.constant(0) {
        to.reading(index - p.reading(0))
    } else if index < p.len() {
        to.constant(index - p.constant(0))
    } else if index < p.state_rate(0) {
        to.acceleration(0) + (index - p.acceleration(0))
    } else if index < p.signal(0) {
        to.state_rate(index - p.state_rate(0))
    } else {
        to.signal(index - p.signal(0))
    }
}

/// The two graphs under construction.
#[derive(Debug, Default)]
pub(crate) struct GraphBuilder {
    pub bind: BindBuilder,
    pub element: Option<ElementBuilder>,
}

impl GraphBuilder {
    pub fn constant(&mut self, value: f64) -> Scalar {
        Scalar {
            stage: Stage::Bind,
            node: self.bind.graph.constant(value),
        }
    }

    /// The value of a scalar, if it is known while compiling.
    pub fn known(&self, a: Scalar) -> Option<f64> {
        match a.stage {
            Stage::Bind => self.bind.graph.as_constant(a.node),
            Stage::Motion => None,
        }
    }

    /// The node in the element's graph.
    pub fn lift(&mut self, stage: Stage, node: Node) -> Node {
        match (stage, self.element.as_mut()) {
            (Stage::Motion, _) | (_, None) => node,
            (Stage::Bind, Some(element)) => match self.bind.graph.as_constant(node) {
                Some(value) => element.graph.constant(value),
                None => element.constant(node),
            },
        }
    }

    pub fn graph(&mut self, stage: Stage) -> &mut Graph {
        match (stage, self.element.as_mut()) {
            (Stage::Motion, Some(element)) => &mut element.graph,
            _ => &mut self.bind.graph,
        }
    }

    fn join(&mut self, a: (Stage, Node), b: (Stage, Node)) -> (Stage, Node, Node) {
        if a.0 == Stage::Bind && b.0 == Stage::Bind {
            (Stage::Bind, a.1, b.1)
        } else {
            (Stage::Motion, self.lift(a.0, a.1), self.lift(b.0, b.1))
        }
    }

    /// An operation on two numbers.
    pub fn binary(
        &mut self,
        a: Scalar,
        b: Scalar,
        op: impl FnOnce(&mut Graph, Node, Node) -> Node,
    ) -> Scalar {
        let (stage, x, y) = self.join((a.stage, a.node), (b.stage, b.node));
        let node = op(self.graph(stage), x, y);
        Scalar { stage, node }
    }

    /// An operation on one number.
    pub fn unary(&mut self, a: Scalar, op: impl FnOnce(&mut Graph, Node) -> Node) -> Scalar {
        let node = op(self.graph(a.stage), a.node);
        Scalar {
            stage: a.stage,
            node,
        }
    }

    pub fn add(&mut self, a: Scalar, b: Scalar) -> Scalar {
        self.binary(a, b, Graph::add)
    }

    pub fn subtract(&mut self, a: Scalar, b: Scalar) -> Scalar {
        self.binary(a, b, Graph::subtract)
    }

    pub fn multiply(&mut self, a: Scalar, b: Scalar) -> Scalar {
        self.binary(a, b, Graph::multiply)
    }

    pub fn divide(&mut self, a: Scalar, b: Scalar) -> Scalar {
        self.binary(a, b, Graph::divide)
    }

    pub fn negate(&mut self, a: Scalar) -> Scalar {
        self.unary(a, Graph::negate)
    }

    pub fn sqrt(&mut self, a: Scalar) -> Scalar {
        self.unary(a, Graph::sqrt)
    }

    pub fn dot(&mut self, a: &[Scalar], b: &[Scalar]) -> Scalar {
        let mut sum: Option<Scalar> = None;
        for (x, y) in a.iter().zip(b) {
            let p = self.multiply(*x, *y);
            sum = Some(match sum {
                Some(s) => self.add(s, p),
                None => p,
            });
        }
        match sum {
            Some(s) => s,
            None => self.constant(0.0),
        }
    }

    pub fn cross(&mut self, a: &[Scalar; 3], b: &[Scalar; 3]) -> [Scalar; 3] {
        let mut component = |i: usize, j: usize| {
            let p = self.multiply(a[i], b[j]);
            let q = self.multiply(a[j], b[i]);
            self.subtract(p, q)
        };
        [component(1, 2), component(2, 0), component(0, 1)]
    }

    /// A comparison.
    pub fn compare(
        &mut self,
        a: Scalar,
        b: Scalar,
        op: impl FnOnce(&mut Graph, Node, Node) -> Node,
    ) -> Flag {
        let (stage, x, y) = self.join((a.stage, a.node), (b.stage, b.node));
        let node = op(self.graph(stage), x, y);
        Flag { stage, node }
    }

    /// The value of a flag, if it is known while compiling.
    pub fn known_flag(&self, flag: Flag) -> Option<bool> {
        if flag.stage != Stage::Bind {
            return None;
        }
        let graph = &self.bind.graph;
        match graph.op(flag.node) {
            Op::Less(a, b) => Some(graph.as_constant(a)? < graph.as_constant(b)?),
            Op::LessEqual(a, b) => Some(graph.as_constant(a)? <= graph.as_constant(b)?),
            Op::Equal(a, b) => Some(graph.as_constant(a)? == graph.as_constant(b)?),
            _ => None,
        }
    }

    /// `and`, `or` of two flags.
    pub fn logic(&mut self, a: Flag, b: Flag, op: fn(Node, Node) -> Op) -> Flag {
        let (stage, x, y) = self.join_flags(a, b);
        let node = self.graph(stage).push(op(x, y));
        Flag { stage, node }
    }

    pub fn not(&mut self, a: Flag) -> Flag {
        let node = self.graph(a.stage).push(Op::Not(a.node));
        Flag {
            stage: a.stage,
            node,
        }
    }

    fn join_flags(&mut self, a: Flag, b: Flag) -> (Stage, Node, Node) {
        if a.stage == Stage::Bind && b.stage == Stage::Bind {
            (Stage::Bind, a.node, b.node)
        } else {
            (Stage::Motion, self.lift_flag(a), self.lift_flag(b))
        }
    }

    /// A flag in the element's graph. One of the bind stage becomes a constant 1 or 0.
    pub fn lift_flag(&mut self, flag: Flag) -> Node {
        if flag.stage == Stage::Motion || self.element.is_none() {
            return flag.node;
        }
        let number = self.flag_number(flag);
        let lifted = self.lift(Stage::Bind, number);
        match self.element.as_mut() {
            Some(element) => {
                let half = element.graph.constant(0.5);
                element.graph.less(half, lifted)
            }
            None => flag.node,
        }
    }

    /// 1 if a bind flag holds, else 0.
    pub fn flag_number(&mut self, flag: Flag) -> Node {
        let graph = &mut self.bind.graph;
        let one = graph.constant(1.0);
        let zero = graph.constant(0.0);
        graph.select(flag.node, one, zero)
    }

    pub fn select(&mut self, flag: Flag, a: Scalar, b: Scalar) -> Scalar {
        let all_bind = [flag.stage, a.stage, b.stage]
            .iter()
            .all(|s| *s == Stage::Bind);
        if all_bind {
            let node = self.bind.graph.select(flag.node, a.node, b.node);
            return Scalar { node, ..a };
        }
        let f = self.lift_flag(flag);
        let x = self.lift(a.stage, a.node);
        let y = self.lift(b.stage, b.node);
        let node = self.graph(Stage::Motion).select(f, x, y);
        Scalar {
            stage: Stage::Motion,
            node,
        }
    }

    /// The period of a table over its first argument; zero where it has none.
    pub fn table_period(&mut self, handle: Node) -> Scalar {
        self.table(handle, &[])
    }

    /// The derivative of a table of one argument.
    pub fn slope_of_table(&mut self, handle: Node, x: Scalar, order: u8) -> Scalar {
        let value = self.table(handle, &[x]);
        let graph = self.graph(value.stage);
        let mut node = value.node;
        for _ in 0..order {
            let slopes = crate::ir::differentiate::partials(graph, node);
            node = slopes
                .first()
                .map_or(graph.constant(0.0), |(_, slope)| *slope);
        }
        Scalar { node, ..value }
    }

    /// An input in the place of an unknown, until [`GraphBuilder::derivative_at`] replaces it.
    pub fn unknown(&mut self, stage: Stage, input: u32) -> Scalar {
        let node = self.graph(stage).input(input);
        Scalar { stage, node }
    }

    /// The derivative of a value with respect to an input, with x in the place of the input.
    pub fn derivative_at(&mut self, value: Scalar, input: u32, order: u8, x: Node) -> Scalar {
        let graph = self.graph(value.stage);
        let one = graph.constant(1.0);
        let mut node = value.node;
        for _ in 0..order {
            let seeds = |index: u32| (index == input).then_some(one);
            let slopes = crate::ir::forward(graph, &[node], &seeds);
            node = slopes.first().copied().unwrap_or(node);
        }
        let source = graph.clone();
        let put_in = &mut |graph: &mut Graph, index: u32| match index == input {
            true => x,
            false => graph.input(index),
        };
        let copies = crate::ir::copy_into(&source, &[node], graph, put_in);
        Scalar {
            node: copies.first().copied().unwrap_or(node),
            ..value
        }
    }

    /// A table look-up.
    pub fn table(&mut self, handle: Node, arguments: &[Scalar]) -> Scalar {
        let moves = arguments.iter().any(|x| x.stage == Stage::Motion);
        let stage = if moves { Stage::Motion } else { Stage::Bind };
        let mut raised = |from: Stage, node: Node| match (from, stage) {
            (Stage::Bind, Stage::Motion) => self.lift(Stage::Bind, node),
            _ => node,
        };
        let handle = raised(Stage::Bind, handle);
        let nodes: Vec<Node> = arguments.iter().map(|x| raised(x.stage, x.node)).collect();
        let node = self.graph(stage).table(handle, &nodes);
        Scalar { stage, node }
    }
}
