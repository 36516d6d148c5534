//! Evaluation of functions without generated code: the tests' oracle, and the fallback.
//!
//! Its arithmetic is the generated code's, bit for bit: IEEE operations one at a time, `libm` for the rest.

use super::class::ClassFunctions;
use super::graph::{Function, Node, Op};
use eng_system::code::{ElementCode, Function as Which, Pair};
use eng_system::table::Table;
use std::sync::{Mutex, PoisonError};

/// A function made ready for evaluation.
#[derive(Clone, Debug)]
pub struct Interpreter {
    inputs: usize,
    operations: Vec<Op>,
    outputs: Vec<Node>,
}

impl Interpreter {
    /// Takes what the outputs need of a function.
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

    /// How many inputs and outputs it has.
    pub fn shape(&self) -> (usize, usize) {
        (self.inputs, self.outputs.len())
    }

    /// Evaluates two instances; `false`, and nothing written, if a slice is too short. `scratch` is only room to work in.
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
            let lane = |k: usize| {
                let of = |n: &Node| scratch[n.0 as usize][k];
                match op {
                    Op::Input(i) => inputs.get(*i as usize).map_or(f64::NAN, |pair| pair[k]),
                    op => operate(op, of, tables),
                }
            };
            let pair = [lane(0), lane(1)];
            scratch.push(pair);
        }
        for (output, node) in outputs.iter_mut().zip(&self.outputs) {
            *output = scratch[node.0 as usize];
        }
        true
    }
}

/// One operation; flags are 1 and 0.
pub(crate) fn operate(op: &Op, of: impl Fn(&Node) -> f64, tables: &[Table]) -> f64 {
    let flag = |set: bool| if set { 1.0 } else { 0.0 };
    match op {
        Op::Input(_) => f64::NAN,
        Op::Constant(bits) => f64::from_bits(*bits),
        Op::Add(a, b) => of(a) + of(b),
        Op::Subtract(a, b) => of(a) - of(b),
        Op::Multiply(a, b) => of(a) * of(b),
        Op::Divide(a, b) => of(a) / of(b),
        Op::Negate(a) => -of(a),
        Op::Abs(a) => of(a).abs(),
        Op::Sqrt(a) => of(a).sqrt(),
        Op::Minimum(a, b) => {
            let (a, b) = (of(a), of(b));
            if b < a { b } else { a }
        }
        Op::Maximum(a, b) => {
            let (a, b) = (of(a), of(b));
            if b > a { b } else { a }
        }
        Op::Sin(a) => libm::sin(of(a)),
        Op::Cos(a) => libm::cos(of(a)),
        Op::Tan(a) => libm::tan(of(a)),
        Op::Asin(a) => libm::asin(of(a)),
        Op::Acos(a) => libm::acos(of(a)),
        Op::Atan(a) => libm::atan(of(a)),
        Op::Tanh(a) => libm::tanh(of(a)),
        Op::Exp(a) => libm::exp(of(a)),
        Op::Log(a) => libm::log(of(a)),
        Op::Atan2(y, x) => libm::atan2(of(y), of(x)),
        Op::Power(base, exponent) => libm::pow(of(base), of(exponent)),
        Op::Less(a, b) => flag(of(a) < of(b)),
        Op::LessEqual(a, b) => flag(of(a) <= of(b)),
        Op::Equal(a, b) => flag(of(a) == of(b)),
        Op::And(a, b) => flag(of(a) != 0.0 && of(b) != 0.0),
        Op::Or(a, b) => flag(of(a) != 0.0 || of(b) != 0.0),
        Op::Not(a) => flag(of(a) == 0.0),
        Op::Select(f, a, b) => {
            if of(f) != 0.0 {
                of(a)
            } else {
                of(b)
            }
        }
        Op::Table(handle, argument, order) => look_up(tables, of(handle), of(argument), *order),
    }
}

/// The value of a table by its handle; NaN if there is none.
pub(crate) fn look_up(tables: &[Table], handle: f64, argument: f64, order: u8) -> f64 {
    // the comparison also keeps NaN out
    if !(handle >= 0.0 && handle < tables.len() as f64) {
        return f64::NAN;
    }
    tables
        .get(handle as usize)
        .map_or(f64::NAN, |table| table.evaluate(argument, order))
}

/// A class that is interpreted.
#[derive(Debug)]
pub struct InterpretedClass {
    functions: [Interpreter; 7],
    /// Room to work in, one for each caller at a time.
    scratch: Mutex<Vec<Vec<Pair>>>,
}

impl InterpretedClass {
    /// Makes the functions of a class ready.
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
        // scratch holds nothing between calls, so one left by a panicking thread is as good as any
        let pool = || self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let mut scratch = pool().pop().unwrap_or_default();
        let done = self
            .of(function)
            .evaluate(inputs, outputs, tables, &mut scratch);
        pool().push(scratch);
        done
    }

    fn code_bytes(&self) -> usize {
        0
    }
}
