//! Evaluation of functions without generated code: the reference of the tests, and the fallback.
//!
//! Its arithmetic equals that of the generated code bit for bit: single IEEE operations, and `libm` for the
//! rest.

use super::class::ClassFunctions;
use super::graph::{Function, Node, Op};
use super::look_up;
use eng_system::code::{ElementCode, Function as Which, Pair};
use eng_system::table::{Outside, Table};
use std::sync::{Mutex, PoisonError};

/// A function made ready for evaluation.
#[derive(Clone, Debug)]
pub struct Interpreter {
    inputs: usize,
    operations: Vec<Op>,
    outputs: Vec<Node>,
}

impl Interpreter {
    /// Takes the operations of a function that its outputs need.
    pub fn new(function: &Function) -> Self {
        let needed = super::optimise::dependencies(&function.graph, &function.outputs);
        let mut places = vec![Node(0); needed.len()];
        let mut operations = Vec::new();
        for (index, op) in function.graph.nodes().iter().enumerate() {
            if needed[index] {
                places[index] = Node(operations.len() as u32);
                operations.push(op.map_operands(|n| places[n.0 as usize]));
            }
        }
        Interpreter {
            inputs: function.inputs as usize,
            operations,
            outputs: function
                .outputs
                .iter()
                .map(|n| places[n.0 as usize])
                .collect(),
        }
    }

    /// Numbers of inputs and outputs.
    pub fn shape(&self) -> (usize, usize) {
        (self.inputs, self.outputs.len())
    }

    /// Evaluates two instances; `false`, without writing, if a slice is too short. `scratch` holds
    /// intermediate values.
    pub fn evaluate(
        &self,
        inputs: &[Pair],
        outputs: &mut [Pair],
        tables: &[Table],
        scratch: &mut Vec<Pair>,
    ) -> bool {
        if inputs.len() < self.inputs || outputs.len() < self.outputs.len() {
            return false;
        }
        scratch.clear();
        scratch.reserve(self.operations.len());
        for op in &self.operations {
            let pair = match *op {
                Op::Input(i) => inputs.get(i as usize).copied().unwrap_or([f64::NAN; 2]),
                op => operate(op, scratch, tables),
            };
            scratch.push(pair);
        }
        for (output, node) in outputs.iter_mut().zip(&self.outputs) {
            *output = scratch[node.0 as usize];
        }
        true
    }

    /// Whether it reads tables.
    pub fn reads_tables(&self) -> bool {
        self.operations.iter().any(|op| matches!(op, Op::Table(..)))
    }

    /// The first table that is evaluated outside its points, for each instance.
    pub fn outside(&self, inputs: &[Pair], tables: &[Table]) -> [Option<Outside>; 2] {
        let mut values = Vec::with_capacity(self.operations.len());
        let mut outputs = vec![[0.0; 2]; self.outputs.len()];
        self.evaluate(inputs, &mut outputs, tables, &mut values);
        outside(&self.operations, &values, tables)
    }
}

/// One operation on the values so far. Flags are 1 and 0.
pub(crate) fn operate(op: Op, values: &[Pair], tables: &[Table]) -> Pair {
    let of = |n: Node| values[n.0 as usize];
    match op {
        Op::Input(_) => [f64::NAN; 2],
        Op::Constant(bits) => [f64::from_bits(bits); 2],
        Op::Add(a, b) => both(of(a), of(b), |a, b| a + b),
        Op::Subtract(a, b) => both(of(a), of(b), |a, b| a - b),
        Op::Multiply(a, b) => both(of(a), of(b), |a, b| a * b),
        Op::Divide(a, b) => both(of(a), of(b), |a, b| a / b),
        Op::Negate(a) => of(a).map(|a| -a),
        Op::Abs(a) => of(a).map(f64::abs),
        Op::Sqrt(a) => of(a).map(f64::sqrt),
        Op::Minimum(a, b) => both(of(a), of(b), |a, b| if b < a { b } else { a }),
        Op::Maximum(a, b) => both(of(a), of(b), |a, b| if b > a { b } else { a }),
        Op::Elementary(function, a) => of(a).map(|x| function.value(x)),
        Op::Atan2(y, x) => both(of(y), of(x), libm::atan2),
        Op::Power(base, exponent) => both(of(base), of(exponent), libm::pow),
        Op::Less(a, b) => both(of(a), of(b), |a, b| flag(a < b)),
        Op::LessEqual(a, b) => both(of(a), of(b), |a, b| flag(a <= b)),
        Op::Equal(a, b) => both(of(a), of(b), |a, b| flag(a == b)),
        Op::And(a, b) => both(of(a), of(b), |a, b| flag(a != 0.0 && b != 0.0)),
        Op::Or(a, b) => both(of(a), of(b), |a, b| flag(a != 0.0 || b != 0.0)),
        Op::Not(a) => of(a).map(|a| flag(a == 0.0)),
        Op::Select(f, a, b) => {
            let (f, a, b) = (of(f), of(a), of(b));
            let pick = |k: usize| if f[k] != 0.0 { a[k] } else { b[k] };
            [pick(0), pick(1)]
        }
        Op::Table(handle, arguments, orders) => {
            let handle = of(handle);
            let lane = |k: usize| {
                look_up::look_up(tables, handle[k], &arguments.map(|a| of(a)[k]), orders)
            };
            [lane(0), lane(1)]
        }
    }
}

#[inline]
fn both(a: Pair, b: Pair, f: impl Fn(f64, f64) -> f64) -> Pair {
    [f(a[0], b[0]), f(a[1], b[1])]
}

fn flag(set: bool) -> f64 {
    if set { 1.0 } else { 0.0 }
}

/// The first table that is evaluated outside its points, for each instance. `values` are those of the
/// operations.
pub(crate) fn outside(
    operations: &[Op],
    values: &[Pair],
    tables: &[Table],
) -> [Option<Outside>; 2] {
    [0, 1].map(|lane| {
        operations.iter().find_map(|op| {
            let Op::Table(handle, arguments, orders) = *op else {
                return None;
            };
            let of = |node: Node| {
                let pair = values.get(node.0 as usize);
                pair.map_or(f64::NAN, |pair| pair[lane])
            };
            look_up::outside(tables, of(handle), &arguments.map(of), orders)
        })
    })
}

/// An interpreted class.
#[derive(Debug)]
pub struct InterpretedClass {
    functions: [Interpreter; Which::ALL.len()],
    /// Scratch, one for each simultaneous caller.
    scratch: Mutex<Vec<Vec<Pair>>>,
}

impl InterpretedClass {
    /// Prepares the functions of a class.
    pub fn new(functions: &ClassFunctions) -> Self {
        InterpretedClass {
            functions: Which::ALL.map(|which| Interpreter::new(functions.get(which))),
            scratch: Mutex::new(Vec::new()),
        }
    }

    fn of(&self, function: Which) -> &Interpreter {
        &self.functions[function as usize]
    }
}

impl ElementCode for InterpretedClass {
    fn shape(&self, function: Which) -> (usize, usize) {
        self.of(function).shape()
    }

    fn call(
        &self,
        function: Which,
        inputs: &[Pair],
        outputs: &mut [Pair],
        tables: &[Table],
    ) -> bool {
        // scratch holds no data between calls, so one from a panicking thread is good too
        let pool = || self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let mut scratch = pool().pop().unwrap_or_default();
        let done = self
            .of(function)
            .evaluate(inputs, outputs, tables, &mut scratch);
        pool().push(scratch);
        done
    }

    fn outside(&self, which: Which, inputs: &[Pair], tables: &[Table]) -> [Option<Outside>; 2] {
        self.of(which).outside(inputs, tables)
    }

    fn function_bytes(&self, _: eng_system::code::Function) -> usize {
        0
    }
}
