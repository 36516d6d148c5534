//! The text of a function: stable, with one operation on each line and all digits of constants.

use super::graph::{Function, Op};
use std::fmt::{Display, Formatter, Result, Write};

impl Display for Function {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "function {} ", self.name)?;
        self.print_body(f)
    }
}

impl Function {
    /// Prints all but the name.
    pub(crate) fn print_body(&self, f: &mut dyn Write) -> Result {
        writeln!(f, "(inputs: {}) {{", self.inputs)?;
        for (index, op) in self.graph.nodes().iter().enumerate() {
            write!(f, "  v{index} = {}", op.mnemonic())?;
            match *op {
                Op::Input(i) => write!(f, " {i}")?,
                Op::Constant(bits) => write!(f, " {:?}", f64::from_bits(bits))?,
                op => {
                    for (i, operand) in op.operands().enumerate() {
                        write!(f, "{} v{}", if i == 0 { "" } else { "," }, operand.0)?;
                    }
                    if let Op::Table(_, _, orders) = op {
                        write!(f, ", order")?;
                        for order in orders.each() {
                            write!(f, " {order}")?;
                        }
                    }
                }
            }
            writeln!(f)?;
        }
        write!(f, "  return")?;
        for (i, output) in self.outputs.iter().enumerate() {
            write!(f, "{} v{}", if i == 0 { "" } else { "," }, output.0)?;
        }
        writeln!(f, "\n}}")
    }
}

impl Op {
    /// The operation's name in print.
    pub fn mnemonic(&self) -> &'static str {
        match self {
            Op::Input(_) => "input",
            Op::Constant(_) => "constant",
            Op::Add(..) => "add",
            Op::Subtract(..) => "subtract",
            Op::Multiply(..) => "multiply",
            Op::Divide(..) => "divide",
            Op::Negate(_) => "negate",
            Op::Abs(_) => "abs",
            Op::Sqrt(_) => "sqrt",
            Op::Minimum(..) => "minimum",
            Op::Maximum(..) => "maximum",
            Op::Elementary(function, _) => function.name(),
            Op::Atan2(..) => "atan2",
            Op::Power(..) => "power",
            Op::Less(..) => "less",
            Op::LessEqual(..) => "less_equal",
            Op::Equal(..) => "equal",
            Op::And(..) => "and",
            Op::Or(..) => "or",
            Op::Not(_) => "not",
            Op::Select(..) => "select",
            Op::Table(..) => "table",
        }
    }
}
