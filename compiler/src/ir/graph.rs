//! The graph and its builder.

use super::look_up::Orders;
use eng_system::elementary::Elementary;
use eng_system::table::MOST_ARGUMENTS;
use std::collections::HashMap;

/// A value of a [`Graph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Node(pub u32);

/// An operation. Its operands come earlier in the graph.
/// Comparisons and logic give a flag, and `Select` takes one. All other values are 64-bit floats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Op {
    /// The input with this index.
    Input(u32),
    /// The bits of a constant.
    Constant(u64),
    Add(Node, Node),
    Subtract(Node, Node),
    Multiply(Node, Node),
    Divide(Node, Node),
    Negate(Node),
    Abs(Node),
    Sqrt(Node),
    Minimum(Node, Node),
    Maximum(Node, Node),
    Elementary(Elementary, Node),
    /// y, x.
    Atan2(Node, Node),
    /// base, exponent.
    Power(Node, Node),
    /// Flag: a < b.
    Less(Node, Node),
    /// Flag: a <= b.
    LessEqual(Node, Node),
    /// Flag: a == b.
    Equal(Node, Node),
    And(Node, Node),
    Or(Node, Node),
    Not(Node),
    /// flag, value if set, value if not.
    Select(Node, Node, Node),
    /// Table look-up: handle (a float with the table's index), arguments, orders of the derivative. Node 0 fills the
    /// places of arguments that the table does not have.
    Table(Node, [Node; MOST_ARGUMENTS], Orders),
}

impl Op {
    /// The operands in order.
    pub fn operands(self) -> impl DoubleEndedIterator<Item = Node> + Clone {
        let none = Node(0);
        let (list, count) = match self {
            Op::Input(_) | Op::Constant(_) => ([none; 4], 0),
            Op::Negate(a) | Op::Abs(a) | Op::Sqrt(a) | Op::Elementary(_, a) | Op::Not(a) => {
                ([a, none, none, none], 1)
            }
            Op::Add(a, b)
            | Op::Subtract(a, b)
            | Op::Multiply(a, b)
            | Op::Divide(a, b)
            | Op::Minimum(a, b)
            | Op::Maximum(a, b)
            | Op::Atan2(a, b)
            | Op::Power(a, b)
            | Op::Less(a, b)
            | Op::LessEqual(a, b)
            | Op::Equal(a, b)
            | Op::And(a, b)
            | Op::Or(a, b) => ([a, b, none, none], 2),
            Op::Select(a, b, c) => ([a, b, c, none], 3),
            Op::Table(handle, [a, b, c], orders) => ([handle, a, b, c], 1 + orders.arguments()),
        };
        list.into_iter().take(count)
    }

    /// The same operation on other operands.
    pub(crate) fn map_operands(self, mut f: impl FnMut(Node) -> Node) -> Op {
        match self {
            Op::Input(_) | Op::Constant(_) => self,
            Op::Add(a, b) => Op::Add(f(a), f(b)),
            Op::Subtract(a, b) => Op::Subtract(f(a), f(b)),
            Op::Multiply(a, b) => Op::Multiply(f(a), f(b)),
            Op::Divide(a, b) => Op::Divide(f(a), f(b)),
            Op::Negate(a) => Op::Negate(f(a)),
            Op::Abs(a) => Op::Abs(f(a)),
            Op::Sqrt(a) => Op::Sqrt(f(a)),
            Op::Minimum(a, b) => Op::Minimum(f(a), f(b)),
            Op::Maximum(a, b) => Op::Maximum(f(a), f(b)),
            Op::Elementary(function, a) => Op::Elementary(function, f(a)),
            Op::Atan2(a, b) => Op::Atan2(f(a), f(b)),
            Op::Power(a, b) => Op::Power(f(a), f(b)),
            Op::Less(a, b) => Op::Less(f(a), f(b)),
            Op::LessEqual(a, b) => Op::LessEqual(f(a), f(b)),
            Op::Equal(a, b) => Op::Equal(f(a), f(b)),
            Op::And(a, b) => Op::And(f(a), f(b)),
            Op::Or(a, b) => Op::Or(f(a), f(b)),
            Op::Not(a) => Op::Not(f(a)),
            Op::Select(a, b, c) => Op::Select(f(a), f(b), f(c)),
            Op::Table(handle, mut arguments, orders) => {
                let handle = f(handle);
                for argument in arguments.iter_mut().take(orders.arguments()) {
                    *argument = f(*argument);
                }
                Op::Table(handle, arguments, orders)
            }
        }
    }

    /// Whether the result is a flag.
    pub fn is_flag(self) -> bool {
        matches!(
            self,
            Op::Less(..)
                | Op::LessEqual(..)
                | Op::Equal(..)
                | Op::And(..)
                | Op::Or(..)
                | Op::Not(_)
        )
    }
}

/// Builds a graph. Equal operations become one node, and constants are folded.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Op>,
    interned: HashMap<Op, Node>,
    /// Without folding and without hash-consing: the reference for tests of the optimiser.
    plain: bool,
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty graph that neither folds nor shares.
    pub fn plain() -> Self {
        Graph {
            plain: true,
            ..Self::default()
        }
    }

    /// All operations, operands first.
    pub fn nodes(&self) -> &[Op] {
        &self.nodes
    }

    /// The operation behind a node of this graph.
    pub fn op(&self, node: Node) -> Op {
        self.nodes[node.0 as usize]
    }

    /// The node of an operation that the graph has.
    pub(crate) fn known(&self, op: &Op) -> Option<Node> {
        self.interned.get(op).copied()
    }

    /// Adds an operation without folding. Equal operations share a node.
    pub fn push(&mut self, op: Op) -> Node {
        if !self.plain
            && let Some(node) = self.interned.get(&op)
        {
            return *node;
        }
        let node = Node(self.nodes.len() as u32);
        self.nodes.push(op);
        if !self.plain {
            self.interned.insert(op, node);
        }
        node
    }

    /// An input.
    pub fn input(&mut self, index: u32) -> Node {
        self.push(Op::Input(index))
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> Node {
        // -0.0 and 0.0 differ in bits but have the same meaning here, so there is only one zero
        let value = if value == 0.0 { 0.0 } else { value };
        self.push(Op::Constant(value.to_bits()))
    }

    /// The value of a constant node.
    pub(crate) fn as_constant(&self, node: Node) -> Option<f64> {
        match self.op(node) {
            Op::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn is(&self, node: Node, value: f64) -> bool {
        !self.plain && self.as_constant(node) == Some(value)
    }

    fn fold2(&mut self, a: Node, b: Node, f: impl Fn(f64, f64) -> f64) -> Option<Node> {
        if self.plain {
            return None;
        }
        let value = f(self.as_constant(a)?, self.as_constant(b)?);
        value.is_finite().then(|| self.constant(value))
    }

    fn fold1(&mut self, a: Node, f: impl Fn(f64) -> f64) -> Option<Node> {
        if self.plain {
            return None;
        }
        let value = f(self.as_constant(a)?);
        value.is_finite().then(|| self.constant(value))
    }

    /// a + b.
    pub fn add(&mut self, a: Node, b: Node) -> Node {
        if let Some(n) = self.fold2(a, b, |a, b| a + b) {
            return n;
        }
        if self.is(a, 0.0) {
            return b;
        }
        if self.is(b, 0.0) {
            return a;
        }
        if !self.plain {
            if let Op::Negate(c) = self.op(b) {
                return self.subtract(a, c);
            }
            if let Op::Negate(c) = self.op(a) {
                return self.subtract(b, c);
            }
        }
        let (a, b) = if self.plain || a <= b { (a, b) } else { (b, a) };
        self.push(Op::Add(a, b))
    }

    /// a − b.
    pub fn subtract(&mut self, a: Node, b: Node) -> Node {
        if let Some(n) = self.fold2(a, b, |a, b| a - b) {
            return n;
        }
        if self.is(b, 0.0) {
            return a;
        }
        if self.is(a, 0.0) {
            return self.negate(b);
        }
        if !self.plain {
            if a == b {
                return self.constant(0.0);
            }
            if let Op::Negate(c) = self.op(b) {
                return self.add(a, c);
            }
        }
        self.push(Op::Subtract(a, b))
    }

    /// a · b.
    pub fn multiply(&mut self, a: Node, b: Node) -> Node {
        if let Some(n) = self.fold2(a, b, |a, b| a * b) {
            return n;
        }
        if self.is(a, 0.0) || self.is(b, 0.0) {
            return self.constant(0.0);
        }
        if self.is(a, 1.0) {
            return b;
        }
        if self.is(b, 1.0) {
            return a;
        }
        if self.is(a, -1.0) {
            return self.negate(b);
        }
        if self.is(b, -1.0) {
            return self.negate(a);
        }
        if !self.plain {
            match (self.op(a), self.op(b)) {
                (Op::Negate(x), Op::Negate(y)) => return self.multiply(x, y),
                (Op::Negate(x), _) => {
                    let p = self.multiply(x, b);
                    return self.negate(p);
                }
                (_, Op::Negate(y)) => {
                    let p = self.multiply(a, y);
                    return self.negate(p);
                }
                _ => {}
            }
        }
        let (a, b) = if self.plain || a <= b { (a, b) } else { (b, a) };
        self.push(Op::Multiply(a, b))
    }

    /// a / b.
    pub fn divide(&mut self, a: Node, b: Node) -> Node {
        if let Some(n) = self.fold2(a, b, |a, b| a / b) {
            return n;
        }
        if self.is(a, 0.0) {
            return self.constant(0.0);
        }
        if self.is(b, 1.0) {
            return a;
        }
        self.push(Op::Divide(a, b))
    }

    /// −a.
    pub fn negate(&mut self, a: Node) -> Node {
        if let Some(n) = self.fold1(a, |a| -a) {
            return n;
        }
        if !self.plain {
            match self.op(a) {
                Op::Negate(b) => return b,
                Op::Subtract(x, y) => return self.subtract(y, x),
                _ => {}
            }
        }
        self.push(Op::Negate(a))
    }

    /// |a|.
    pub fn abs(&mut self, a: Node) -> Node {
        match self.fold1(a, f64::abs) {
            Some(n) => n,
            None => self.push(Op::Abs(a)),
        }
    }

    /// √a.
    pub fn sqrt(&mut self, a: Node) -> Node {
        match self.fold1(a, f64::sqrt) {
            Some(n) => n,
            None => self.push(Op::Sqrt(a)),
        }
    }

    /// The smaller value; a if they are equal.
    pub fn minimum(&mut self, a: Node, b: Node) -> Node {
        match self.fold2(a, b, |a, b| if b < a { b } else { a }) {
            Some(n) => n,
            None => self.push(Op::Minimum(a, b)),
        }
    }

    /// The larger value; a if they are equal.
    pub fn maximum(&mut self, a: Node, b: Node) -> Node {
        match self.fold2(a, b, |a, b| if b > a { b } else { a }) {
            Some(n) => n,
            None => self.push(Op::Maximum(a, b)),
        }
    }

    /// An elementary function.
    pub fn unary(&mut self, function: Elementary, a: Node) -> Node {
        let known = if self.plain {
            None
        } else {
            self.as_constant(a)
        };
        let folded = known.map(|x| function.value(x));
        match folded.filter(|v| v.is_finite()) {
            Some(v) => self.constant(v),
            None => self.push(Op::Elementary(function, a)),
        }
    }

    /// atan2(y, x).
    pub fn atan2(&mut self, y: Node, x: Node) -> Node {
        match self.fold2(y, x, libm::atan2) {
            Some(n) => n,
            None => self.push(Op::Atan2(y, x)),
        }
    }

    /// base^exponent. Small integers and halves as exponents become products and roots.
    pub fn power(&mut self, base: Node, exponent: Node) -> Node {
        if let Some(n) = self.fold2(base, exponent, libm::pow) {
            return n;
        }
        if self.plain {
            return self.push(Op::Power(base, exponent));
        }
        match self.as_constant(exponent) {
            Some(0.0) => self.constant(1.0),
            // a choice: up to six products are faster and more exact than a power
            Some(e) if e.fract() == 0.0 && e.abs() <= 16.0 => {
                let p = self.integer_power(base, e.abs() as u32);
                if e < 0.0 {
                    let one = self.constant(1.0);
                    self.divide(one, p)
                } else {
                    p
                }
            }
            Some(e) if (e.abs() - 0.5).fract() == 0.0 && e.abs() <= 8.5 => {
                let root = self.sqrt(base);
                let whole = (e.abs() - 0.5) as u32;
                let p = if whole == 0 {
                    root
                } else {
                    let p = self.integer_power(base, whole);
                    self.multiply(p, root)
                };
                if e < 0.0 {
                    let one = self.constant(1.0);
                    self.divide(one, p)
                } else {
                    p
                }
            }
            _ => self.push(Op::Power(base, exponent)),
        }
    }

    fn integer_power(&mut self, base: Node, exponent: u32) -> Node {
        match exponent {
            0 => self.constant(1.0),
            1 => base,
            e => {
                let half = self.integer_power(base, e / 2);
                let square = self.multiply(half, half);
                if e % 2 == 1 {
                    self.multiply(square, base)
                } else {
                    square
                }
            }
        }
    }

    /// Flag a < b.
    pub fn less(&mut self, a: Node, b: Node) -> Node {
        self.push(Op::Less(a, b))
    }

    /// Flag a ≤ b.
    pub fn less_equal(&mut self, a: Node, b: Node) -> Node {
        self.push(Op::LessEqual(a, b))
    }

    /// `then` if `flag` is set, else `otherwise`.
    pub fn select(&mut self, flag: Node, then: Node, otherwise: Node) -> Node {
        if self.plain {
            return self.push(Op::Select(flag, then, otherwise));
        }
        if then == otherwise {
            return then;
        }
        match self.known_flag(flag) {
            Some(true) => return then,
            Some(false) => return otherwise,
            None => {}
        }
        match (self.op(flag), self.op(then), self.op(otherwise)) {
            (Op::Not(f), _, _) => self.select(f, otherwise, then),
            (_, Op::Select(f, inner, _), _) if f == flag => self.select(flag, inner, otherwise),
            (_, _, Op::Select(f, _, inner)) if f == flag => self.select(flag, then, inner),
            _ => self.push(Op::Select(flag, then, otherwise)),
        }
    }

    /// The margin of a flag: a number that is positive if `flag` is set, and measures by how much its
    /// comparisons hold or fail. For `and` it is the smallest margin, for `or` the largest. It is NaN if a
    /// compared number is NaN.
    pub fn margin(&mut self, flag: Node) -> Node {
        let reach = self.reach(flag);
        let tiny = self.constant(f64::MIN_POSITIVE);
        let zero = self.constant(0.0);
        let holds = self.maximum(reach, tiny);
        let fails = self.minimum(reach, zero);
        self.select(flag, holds, fails)
    }

    fn reach(&mut self, flag: Node) -> Node {
        match self.op(flag) {
            Op::Less(a, b) | Op::LessEqual(a, b) => self.subtract(b, a),
            Op::Equal(a, b) => {
                let difference = self.subtract(b, a);
                let distance = self.abs(difference);
                self.negate(distance)
            }
            Op::Not(inner) => {
                let inner = self.reach(inner);
                self.negate(inner)
            }
            Op::And(a, b) => {
                let (x, y) = (self.reach(a), self.reach(b));
                let least = self.minimum(x, y);
                // a failed comparison decides, even if its margin is NaN
                let first = self.select(a, least, x);
                self.select(b, first, y)
            }
            Op::Or(a, b) => {
                let (x, y) = (self.reach(a), self.reach(b));
                let most = self.maximum(x, y);
                let first = self.select(b, most, x);
                self.select(a, first, y)
            }
            _ => {
                let (yes, no) = (self.constant(1.0), self.constant(-1.0));
                self.select(flag, yes, no)
            }
        }
    }

    /// Flag a = b.
    pub fn equal(&mut self, a: Node, b: Node) -> Node {
        self.push(Op::Equal(a, b))
    }

    /// Both flags.
    pub fn and(&mut self, a: Node, b: Node) -> Node {
        if !self.plain && a == b {
            return a;
        }
        self.push(Op::And(a, b))
    }

    /// One flag at least.
    pub fn or(&mut self, a: Node, b: Node) -> Node {
        if !self.plain && a == b {
            return a;
        }
        self.push(Op::Or(a, b))
    }

    /// The opposite flag.
    pub fn not(&mut self, a: Node) -> Node {
        match self.op(a) {
            Op::Not(b) if !self.plain => b,
            _ => self.push(Op::Not(a)),
        }
    }

    /// The value of a comparison of constants.
    fn known_flag(&self, flag: Node) -> Option<bool> {
        let compare =
            |a, b, f: fn(&f64, &f64) -> bool| Some(f(&self.as_constant(a)?, &self.as_constant(b)?));
        match self.op(flag) {
            Op::Less(a, b) => compare(a, b, f64::lt),
            Op::LessEqual(a, b) => compare(a, b, f64::le),
            Op::Equal(a, b) => compare(a, b, f64::eq),
            _ => None,
        }
    }

    /// Adds an operation through the folding builder of its kind.
    pub fn build(&mut self, op: Op) -> Node {
        match op {
            Op::Input(_) | Op::Less(..) | Op::LessEqual(..) | Op::Equal(..) => self.push(op),
            Op::Constant(bits) => self.constant(f64::from_bits(bits)),
            Op::Add(a, b) => self.add(a, b),
            Op::Subtract(a, b) => self.subtract(a, b),
            Op::Multiply(a, b) => self.multiply(a, b),
            Op::Divide(a, b) => self.divide(a, b),
            Op::Negate(a) => self.negate(a),
            Op::Abs(a) => self.abs(a),
            Op::Sqrt(a) => self.sqrt(a),
            Op::Minimum(a, b) => self.minimum(a, b),
            Op::Maximum(a, b) => self.maximum(a, b),
            Op::Elementary(function, a) => self.unary(function, a),
            Op::Atan2(y, x) => self.atan2(y, x),
            Op::Power(base, exponent) => self.power(base, exponent),
            Op::And(a, b) => self.and(a, b),
            Op::Or(a, b) => self.or(a, b),
            Op::Not(a) => self.not(a),
            Op::Select(flag, then, otherwise) => self.select(flag, then, otherwise),
            Op::Table(..) => self.push(op),
        }
    }

    /// The value of a table; arguments beyond the largest number of a table do not count.
    pub fn table(&mut self, handle: Node, arguments: &[Node]) -> Node {
        let mut list = [Node(0); MOST_ARGUMENTS];
        for (place, argument) in list.iter_mut().zip(arguments) {
            *place = *argument;
        }
        self.push(Op::Table(handle, list, Orders::of_value(arguments.len())))
    }
}

/// A function: inputs by index, one graph, outputs in order.
#[derive(Clone, Debug, Default)]
pub struct Function {
    /// Its name in print: `Revolute.residual`.
    pub name: String,
    /// Number of inputs.
    pub inputs: u32,
    /// Its operations.
    pub graph: Graph,
    /// Its results; floats.
    pub outputs: Vec<Node>,
}
