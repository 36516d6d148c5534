//! The bind graph as a program: evaluated once for each parameter set, it gives the slots and the messages of failed
//! conditions.

use super::scalar::{FIXED, FOLLOWED, RATE, TIME};
use crate::ir::{Function, Node, Op};
use eng_system::DisplayUnit;
use eng_system::code::{Advice, BindCode, BindError, Bound, Pair};
use eng_system::system::{Location, Origin, Parameter, Slot};
use eng_system::table::{Outside, Table};
use std::collections::{BTreeMap, BTreeSet};

/// The largest number that a model may hold (SI). Its square does not overflow. A choice: no quantity of an engine
/// comes near. A larger number would overflow within a formula, where no message names it.
const LARGEST_SLOT: f64 = 1e150;

/// The node with the default of a parameter.
pub type ParameterDefault = Node;

/// Part of a message with numbers in it.
#[derive(Clone, Debug, PartialEq)]
pub enum MessagePart {
    /// Plain text.
    Text(String),
    /// A value in a unit.
    Value(Node, DisplayUnit),
}

/// A `require` or `advise` on parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// A number that is 1 if the condition holds.
    pub holds: Node,
    /// A lint.
    pub advise: bool,
    /// The name of a lint for `accept`; empty without a name.
    pub name: String,
    /// The author's message.
    pub message: Vec<MessagePart>,
    /// Path of the element.
    pub path: String,
    /// The user's line.
    pub used_at: Option<Location>,
    /// The law's line.
    pub defined_at: Option<Location>,
}

/// Numbers that the bind graph gets from outside, beside the parameters.
#[derive(Clone, Copy, Default)]
struct Outer<'o> {
    /// The time (s).
    time: f64,
    /// Rates of the parameters that are inputs with stated values (1/s); zero beyond the end.
    rates: &'o [f64],
    /// Numbers of a turn without forces.
    followed: &'o [f64],
}

/// The bind graph as a program.
#[derive(Clone, Debug, Default)]
pub struct BindProgram {
    /// All operations, operands first; inputs below 2²⁴ are parameters, from there fixed numbers.
    pub function: Function,
    /// Fixed numbers.
    pub fixed: Vec<f64>,
    /// Path of the body, marker or element that each slot belongs to.
    pub slot_owners: Vec<String>,
    /// Defaults of the parameters.
    pub defaults: Vec<ParameterDefault>,
    /// Rates of the defaults of parameters that follow inputs.
    pub rates: BTreeMap<u32, Node>,
    /// Paths, units and limits of the parameters.
    pub parameters: Vec<Parameter>,
    /// Conditions.
    pub checks: Vec<Check>,
    /// Lints of numbers that are known after a turn without forces.
    pub turned: Vec<Check>,
    /// Operations that change with the inputs, operands first; empty for a system without inputs.
    pub moving: Vec<Node>,
    /// Slots that change with them.
    pub moving_slots: Vec<Slot>,
}

impl BindProgram {
    /// The first table that is evaluated outside its points, given the values of all nodes.
    fn outside(&self, values: &[Pair], tables: &[Table]) -> Option<Box<Outside>> {
        let nodes = self.function.graph.nodes();
        let [outside, _] = crate::ir::interpret::outside(nodes, values, tables);
        outside.map(Box::new)
    }

    /// Parameters in a node, ascending. A parameter whose default depends on others is replaced by these.
    fn leaves(&self, node: Node) -> Vec<u32> {
        let nodes = self.function.graph.nodes();
        let mut seen = vec![false; nodes.len()];
        let mut found = std::collections::BTreeSet::new();
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            let at = node.0 as usize;
            let (Some(op), Some(seen)) = (nodes.get(at), seen.get_mut(at)) else {
                continue;
            };
            if std::mem::replace(seen, true) {
                continue;
            }
            match *op {
                Op::Input(k) if k >= FIXED => {}
                Op::Input(k) => {
                    let inner = match self.defaults.get(k as usize) {
                        Some(default) => self.leaves(*default),
                        None => Vec::new(),
                    };
                    if inner.is_empty() {
                        found.insert(k);
                    }
                    found.extend(inner);
                }
                op => open.extend(op.operands()),
            }
        }
        found.into_iter().collect()
    }
}

impl BindProgram {
    /// The parameters and tables that decide a value. A parameter whose default depends on others is replaced
    /// by these.
    fn decided_by(&self, value: Node, tables: &[Table]) -> Vec<Origin> {
        let graph = &self.function.graph;
        let mut waiting = vec![value];
        let mut seen = BTreeSet::new();
        let mut found: Vec<Origin> = Vec::new();
        let mut add = |origin: Origin| {
            if !found.iter().any(|known| known.used_at == origin.used_at) {
                found.push(origin);
            }
        };
        while let Some(node) = waiting.pop() {
            if !seen.insert(node) {
                continue;
            }
            match graph.op(node) {
                Op::Input(k) if k < FIXED => {
                    let (Some(parameter), Some(default)) = (
                        self.parameters.get(k as usize),
                        self.defaults.get(k as usize),
                    ) else {
                        continue;
                    };
                    match self.is_stated(*default) {
                        true => add(parameter.origin.clone()),
                        false => waiting.push(*default),
                    }
                }
                Op::Table(handle, ..) => {
                    let index = match graph.op(handle) {
                        Op::Input(k) if k >= FIXED => self.fixed.get((k - FIXED) as usize).copied(),
                        _ => graph.as_constant(handle),
                    };
                    let table = index.and_then(|index| tables.get(index as usize));
                    if let Some(table) = table {
                        add(Origin {
                            path: table.name().to_owned(),
                            used_at: table.stated_at(),
                            defined_at: None,
                        });
                    }
                    waiting.extend(graph.op(node).operands().skip(1));
                }
                op => waiting.extend(op.operands()),
            }
        }
        found.retain(|origin| origin.used_at.is_some());
        found.sort_by_key(|origin| origin.used_at.map(|at| (at.source, at.start)));
        found
    }

    /// Whether a default is a number of the text, without parameters or tables.
    fn is_stated(&self, default: Node) -> bool {
        let graph = &self.function.graph;
        let mut waiting = vec![default];
        while let Some(node) = waiting.pop() {
            match graph.op(node) {
                Op::Input(k) if k < FIXED => return false,
                Op::Table(..) => return false,
                op => waiting.extend(op.operands()),
            }
        }
        true
    }
}

impl BindProgram {
    /// The value of an operation with the values of those before it.
    fn value(
        &self,
        op: Op,
        values: &[Pair],
        overrides: &[Option<f64>],
        outside: Outer<'_>,
        tables: &[Table],
    ) -> Pair {
        let Outer {
            time,
            rates,
            followed,
        } = outside;
        let value = match op {
            Op::Input(TIME) => Some(time),
            Op::Input(k) if k >= RATE => {
                let k = k - RATE;
                match overrides.get(k as usize).copied().flatten() {
                    // a stated value has the rate of its input, if it is one
                    Some(_) => Some(rates.get(k as usize).copied().unwrap_or(0.0)),
                    None => (self.rates.get(&k))
                        .and_then(|n| values.get(n.0 as usize))
                        .map(|pair| pair[0]),
                }
            }
            Op::Input(k) if k >= FOLLOWED => followed.get((k - FOLLOWED) as usize).copied(),
            Op::Input(k) if k >= FIXED => self.fixed.get((k - FIXED) as usize).copied(),
            Op::Input(k) => {
                let default = self
                    .defaults
                    .get(k as usize)
                    .and_then(|n| values.get(n.0 as usize))
                    .map(|pair| pair[0]);
                overrides.get(k as usize).copied().flatten().or(default)
            }
            other => Some(crate::ir::interpret::operate(other, values, tables)[0]),
        };
        // both lanes hold the same number, so these are the operations of the generated code
        [value.unwrap_or(f64::NAN); 2]
    }

    /// Checks that a parameter has a finite value within its limits.
    fn within_limits(
        &self,
        parameter: &Parameter,
        value: f64,
        values: &[Pair],
        tables: &[Table],
    ) -> Result<(), BindError> {
        if !value.is_finite() {
            return Err(BindError::NotFinite {
                path: parameter.origin.path.clone(),
                outside: self.outside(values, tables),
            });
        }
        let (low, high) = parameter.limits;
        if value <= low || value >= high {
            let d = &parameter.display;
            return Err(BindError::Limits {
                path: parameter.origin.path.clone(),
                value: d.text(value).into(),
                low: d.text(low).into(),
                high: d.text(high).into(),
            });
        }
        Ok(())
    }

    /// Checks conditions with the values of all operations. Returns the failed `advise`s. `parameter` gives the value
    /// of a parameter.
    fn conditions<'c>(
        &self,
        checks: impl Iterator<Item = &'c Check>,
        values: &[Pair],
        parameter: impl Fn(u32) -> f64,
        tables: &[Table],
    ) -> Result<Vec<Advice>, BindError> {
        let at = |n: &Node| values.get(n.0 as usize).map_or(f64::NAN, |pair| pair[0]);
        let mut advice = Vec::new();
        for check in checks {
            if at(&check.holds) == 1.0 {
                continue;
            }
            // a number that does not exist (beyond the end of a table, a root of a negative number) cannot be
            // shown
            let known = |part: &MessagePart| match part {
                MessagePart::Text(_) => true,
                MessagePart::Value(n, _) => at(n).is_finite(),
            };
            if !check.message.iter().all(known) {
                if check.advise {
                    continue;
                }
                if let outside @ Some(_) = self.outside(values, tables) {
                    return Err(BindError::NotFinite {
                        path: check.path.clone(),
                        outside,
                    });
                }
            }
            let message: String = check
                .message
                .iter()
                .map(|part| match part {
                    MessagePart::Text(t) => t.clone(),
                    MessagePart::Value(n, unit) => unit.text(at(n)),
                })
                .collect();
            if check.advise {
                advice.push(Advice {
                    name: check.name.clone(),
                    origin: Origin {
                        path: check.path.clone(),
                        used_at: check.used_at,
                        defined_at: check.defined_at,
                    },
                    message,
                    decided_by: self.decided_by(check.holds, tables),
                });
            } else {
                return Err(BindError::Require {
                    path: check.path.clone(),
                    message,
                    used_at: check.used_at,
                    defined_at: check.defined_at,
                    parameters: self
                        .leaves(check.holds)
                        .into_iter()
                        .map(|k| (k, parameter(k)))
                        .collect(),
                });
            }
        }
        Ok(advice)
    }
}

impl BindCode for BindProgram {
    fn bind(&self, overrides: &[Option<f64>], tables: &[Table]) -> Result<Bound, BindError> {
        let nodes = self.function.graph.nodes();
        let mut values: Vec<Pair> = Vec::with_capacity(nodes.len());
        for op in nodes {
            // a run begins at the time zero
            values.push(self.value(*op, &values, overrides, Outer::default(), tables));
        }
        let at = |n: &Node| values.get(n.0 as usize).map_or(f64::NAN, |pair| pair[0]);
        let mut parameters = Vec::with_capacity(self.parameters.len());
        for (i, parameter) in self.parameters.iter().enumerate() {
            let value = match (overrides.get(i).copied().flatten(), self.defaults.get(i)) {
                (Some(v), _) => v,
                (None, Some(n)) => at(n),
                (None, None) => f64::NAN,
            };
            self.within_limits(parameter, value, &values, tables)?;
            parameters.push(value);
        }
        let parameter = |k: u32| parameters.get(k as usize).copied().unwrap_or(f64::NAN);
        let advice = self.conditions(self.checks.iter(), &values, parameter, tables)?;
        let slots: Vec<f64> = self.function.outputs.iter().map(at).collect();
        let owner = |slot| {
            let owner: Option<&String> = self.slot_owners.get(slot);
            owner.unwrap_or(&self.function.name).clone()
        };
        if let Some(i) = slots.iter().position(|v| !v.is_finite()) {
            return Err(BindError::NotFinite {
                path: owner(i),
                outside: self.outside(&values, tables),
            });
        }
        if let Some(i) = slots.iter().position(|v| v.abs() > LARGEST_SLOT) {
            return Err(BindError::TooLarge {
                path: owner(i),
                value: slots[i],
            });
        }
        if self.moving.is_empty() {
            values.clear();
        }
        Ok(Bound {
            slots,
            parameters,
            advice,
            nodes: values,
        })
    }

    fn renew(
        &self,
        nodes: &mut [Pair],
        (overrides, rates): (&[Option<f64>], &[f64]),
        time: f64,
        tables: &[Table],
        moving: &mut [f64],
    ) {
        let outside = Outer {
            time,
            rates,
            followed: &[],
        };
        let operations = self.function.graph.nodes();
        for node in &self.moving {
            let at = node.0 as usize;
            if let Some(op) = operations.get(at)
                && at < nodes.len()
            {
                nodes[at] = self.value(*op, nodes, overrides, outside, tables);
            }
        }
        let slots = self.moving_slots.iter().zip(moving);
        for (slot, value) in slots {
            let node = self.function.outputs.get(slot.0 as usize);
            let found = node.and_then(|node| nodes.get(node.0 as usize));
            *value = found.map_or(f64::NAN, |pair| pair[0]);
        }
    }

    fn after_turn(
        &self,
        overrides: &[Option<f64>],
        followed: &[f64],
        tables: &[Table],
    ) -> Vec<Advice> {
        let nodes = self.function.graph.nodes();
        let mut values: Vec<Pair> = Vec::with_capacity(nodes.len());
        let outside = Outer {
            followed,
            ..Outer::default()
        };
        for op in nodes {
            values.push(self.value(*op, &values, overrides, outside, tables));
        }
        // the parameters of a failed `require`; these are lints
        let none = |_| f64::NAN;
        let advice = self.conditions(self.turned.iter(), &values, none, tables);
        advice.unwrap_or_default()
    }

    fn check(&self, nodes: &[Pair], tables: &[Table]) -> Result<Vec<Advice>, BindError> {
        let moves = |node: &Node| self.moving.binary_search(node).is_ok();
        // the node of a parameter has its value, whether stated or by default
        let graph = &self.function.graph;
        let value = |node: &Node| nodes.get(node.0 as usize).map_or(f64::NAN, |pair| pair[0]);
        for node in &self.moving {
            if let Op::Input(k) = graph.op(*node)
                && let Some(parameter) = self.parameters.get(k as usize)
            {
                self.within_limits(parameter, value(node), nodes, tables)?;
            }
        }
        let parameter = |k: u32| {
            let input = self.moving.iter().find(|n| graph.op(**n) == Op::Input(k));
            let default = self.defaults.get(k as usize);
            input.or(default).map_or(f64::NAN, value)
        };
        let checks = self.checks.iter().filter(|check| moves(&check.holds));
        self.conditions(checks, nodes, parameter, tables)
    }

    fn parameters_of(&self, slot: Slot) -> Vec<u32> {
        match self.function.outputs.get(slot.0 as usize) {
            Some(node) => self.leaves(*node),
            None => Vec::new(),
        }
    }
}
