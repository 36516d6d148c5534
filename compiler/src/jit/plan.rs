//! The place of values while a function runs: in a register or in memory, and the moves between them.
//!
//! For straight-line code no rule is better than Belady's (IBM Systems J. 5 (1966) 78): the value with the
//! farthest next use leaves its register. A value that is already in memory (input, constant, output, result
//! of a call) leaves at no cost, and an operation may read one operand from memory. So such values seldom get
//! a register.

use crate::ir::optimise::dependencies;
use crate::ir::{Function, Node, Op};
use std::collections::{BTreeMap, BTreeSet};

/// A stretch of memory that generated code uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Area {
    Inputs,
    Outputs,
    Constants,
    /// Own room on the stack.
    Room,
}

/// A pair in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub area: Area,
    /// Counted in pairs.
    pub index: u32,
}

/// A step of a plan.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// Load into a register, or directly into the next operation if the processor can.
    Load(Node, Place),
    /// Store as a number.
    Store(Node, Place),
    /// Keep the contents of the register: a number, or the mask of a flag.
    Keep(Node, Place),
    /// Operate on operands in registers.
    Operate(Node),
    /// Call with operands and result in the room from this pair on.
    Call(Node, u32),
    /// Look-up with operands in the room from the first pair on, and the result in the second one. The operands
    /// stay.
    LookUp(Node, u32, u32),
}

/// A function's steps.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub steps: Vec<Step>,
    /// Pairs of the room.
    pub room: u32,
}

/// Constants of a class, each once.
#[derive(Debug, Default)]
pub(super) struct Constants {
    places: BTreeMap<u64, u32>,
    pub bits: Vec<u64>,
}

impl Constants {
    pub fn place(&mut self, bits: u64) -> Place {
        let next = self.bits.len() as u32;
        let index = *self.places.entry(bits).or_insert(next);
        if index == next {
            self.bits.push(bits);
        }
        Place {
            area: Area::Constants,
            index,
        }
    }
}

/// Registers for values at the same time: as many vector registers as x86-64 has. If an operation needs one
/// more for itself, the register allocator provides it.
const REGISTERS: usize = 16;

/// Least number of future uses for loading a value into a free register. For a single use, an instruction that reads
/// the value from memory is as fast.
const WORTH_LOADING: usize = 2;

/// Plans a function.
pub(super) fn plan(function: &Function, constants: &mut Constants) -> Result<Plan, String> {
    let nodes = function.graph.nodes();
    let needed = dependencies(&function.graph, &function.outputs);
    let mut outputs: BTreeMap<Node, Vec<u32>> = BTreeMap::new();
    for (index, node) in (0..).zip(&function.outputs) {
        outputs.entry(*node).or_default().push(index);
    }
    let mut uses: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    for (index, op) in nodes.iter().enumerate().filter(|(i, _)| needed[*i]) {
        for operand in op.operands() {
            uses[operand.0 as usize].push(index);
        }
    }
    // uses in reverse, so that the next one is at the end
    for list in &mut uses {
        list.reverse();
    }
    let mut planner = Planner {
        plan: Plan::default(),
        homes: vec![None; nodes.len()],
        resident: BTreeSet::new(),
        uses,
        free: BTreeSet::new(),
        looked_up: (0, Vec::new()),
    };
    for (index, op) in nodes.iter().enumerate().filter(|(i, _)| needed[*i]) {
        let node = Node(index as u32);
        match *op {
            Op::Input(i) if i >= function.inputs => {
                return Err(format!("input {i} of {}", function.inputs));
            }
            Op::Input(i) => {
                planner.homes[index] = Some(Place {
                    area: Area::Inputs,
                    index: i,
                });
            }
            Op::Constant(bits) => planner.homes[index] = Some(constants.place(bits)),
            op @ Op::Table(..) => planner.look_up(node, op),
            op if is_call(op) => planner.call(node, op),
            op => planner.operate(node, op),
        }
        for (count, output) in (0..).zip(outputs.get(&node).into_iter().flatten()) {
            let place = Place {
                area: Area::Outputs,
                index: *output,
            };
            if count == 0 {
                planner.load(node, &[]);
            }
            planner.plan.steps.push(Step::Store(node, place));
            if planner.homes[index].is_none() && !op.is_flag() {
                planner.homes[index] = Some(place);
            }
        }
        planner.leave_if_done(node);
    }
    Ok(planner.plan)
}

/// Whether an operation is a call.
pub(super) fn is_call(op: Op) -> bool {
    matches!(
        op,
        Op::Elementary(..) | Op::Atan2(..) | Op::Power(..) | Op::Table(..)
    )
}

/// The operands that the machine can read from memory, the better one first.
fn from_memory(op: Op) -> [Option<Node>; 2] {
    match op {
        Op::Add(a, b) | Op::Multiply(a, b) if a != b => [Some(b), Some(a)],
        Op::Subtract(a, b) | Op::Divide(a, b) | Op::Less(a, b) | Op::LessEqual(a, b) if a != b => {
            [Some(b), None]
        }
        Op::Select(flag, a, b) if a != b && a != flag => [Some(a), None],
        Op::Sqrt(a) => [Some(a), None],
        _ => [None, None],
    }
}

struct Planner {
    plan: Plan,
    /// The place of a value in memory.
    homes: Vec<Option<Place>>,
    resident: BTreeSet<Node>,
    /// Uses ahead, the next one last.
    uses: Vec<Vec<usize>>,
    /// Pairs of the room that are free.
    free: BTreeSet<u32>,
    /// Operands of the last look-up, in the room from this pair on. A value and its derivatives have the same
    /// operands, and tables over the same arguments differ by the handle alone.
    looked_up: (u32, Vec<Node>),
}

impl Planner {
    fn operate(&mut self, node: Node, op: Op) {
        let operands: Vec<Node> = op.operands().collect();
        // one operand may stay in memory: the one with the fewest uses ahead
        let folded = from_memory(op)
            .into_iter()
            .flatten()
            .filter(|n| !self.resident.contains(n))
            .min_by_key(|n| self.uses[n.0 as usize].len())
            .filter(|n| {
                self.uses[n.0 as usize].len() < WORTH_LOADING
                    || self.resident.len() + 1 >= REGISTERS
            });
        for operand in &operands {
            if Some(*operand) != folded {
                self.load(*operand, &operands);
            }
        }
        // an operand after its last use leaves its register to the result
        let last: BTreeSet<Node> = operands
            .iter()
            .copied()
            .filter(|n| {
                let ahead = &self.uses[n.0 as usize];
                self.resident.contains(n) && ahead.iter().all(|i| *i == node.0 as usize)
            })
            .collect();
        self.make_room(&operands, last.len());
        if let Some(operand) = folded
            && let Some(place) = self.homes[operand.0 as usize]
        {
            self.plan.steps.push(Step::Load(operand, place));
        }
        self.plan.steps.push(Step::Operate(node));
        self.used(op);
        self.resident.insert(node);
    }

    fn call(&mut self, node: Node, op: Op) {
        let operands: Vec<Node> = op.operands().collect();
        for operand in &operands {
            self.load(*operand, &operands);
        }
        let first = self.reserve(operands.len() as u32);
        for (k, operand) in (0..).zip(&operands) {
            let place = Place {
                area: Area::Room,
                index: first + k,
            };
            self.plan.steps.push(Step::Store(*operand, place));
        }
        self.used(op);
        // no register keeps its value over a call
        for resident in std::mem::take(&mut self.resident) {
            self.keep(resident);
        }
        self.plan.steps.push(Step::Call(node, first));
        self.homes[node.0 as usize] = Some(Place {
            area: Area::Room,
            index: first,
        });
        self.free
            .extend((1..operands.len() as u32).map(|k| first + k));
    }

    fn look_up(&mut self, node: Node, op: Op) {
        let operands: Vec<Node> = op.operands().collect();
        if self.looked_up.1.len() != operands.len() {
            let (first, count) = (self.looked_up.0, self.looked_up.1.len() as u32);
            self.free.extend(first..first + count);
            self.looked_up = (self.reserve(operands.len() as u32), Vec::new());
        }
        let first = self.looked_up.0;
        let known = std::mem::take(&mut self.looked_up.1);
        let changed = (0..)
            .zip(&operands)
            .filter(|(k, operand)| known.get(*k as usize) != Some(operand));
        for (k, operand) in changed {
            self.load(*operand, &operands);
            let place = Place {
                area: Area::Room,
                index: first + k,
            };
            self.plan.steps.push(Step::Store(*operand, place));
        }
        self.looked_up.1 = operands;
        self.used(op);
        // no register keeps its value over a call
        for resident in std::mem::take(&mut self.resident) {
            self.keep(resident);
        }
        let result = self.reserve(1);
        self.plan.steps.push(Step::LookUp(node, first, result));
        self.homes[node.0 as usize] = Some(Place {
            area: Area::Room,
            index: result,
        });
    }

    /// Removes the present use of each operand.
    fn used(&mut self, op: Op) {
        for operand in op.operands() {
            self.uses[operand.0 as usize].pop();
        }
        for operand in op.operands() {
            self.leave_if_done(operand);
        }
    }

    fn leave_if_done(&mut self, node: Node) {
        let index = node.0 as usize;
        if self.uses[index].is_empty() {
            self.resident.remove(&node);
            if let Some(place) = self.homes[index].take()
                && place.area == Area::Room
            {
                self.free.insert(place.index);
            }
        }
    }

    fn load(&mut self, node: Node, pinned: &[Node]) {
        if self.resident.contains(&node) {
            return;
        }
        self.make_room(pinned, 0);
        if let Some(place) = self.homes[node.0 as usize] {
            self.plan.steps.push(Step::Load(node, place));
        }
        self.resident.insert(node);
    }

    /// Frees a register. `leaving` registers become free anyway: the next operation is the last use of their values.
    fn make_room(&mut self, pinned: &[Node], leaving: usize) {
        while self.resident.len() >= REGISTERS + leaving {
            let farthest = self
                .resident
                .iter()
                .filter(|n| !pinned.contains(n))
                .max_by_key(|n| {
                    let index = n.0 as usize;
                    let next = self.uses[index].last().copied().unwrap_or(usize::MAX);
                    (self.homes[index].is_some(), next)
                })
                .copied();
            let Some(node) = farthest else { return };
            self.keep(node);
            self.resident.remove(&node);
        }
    }

    /// Stores a value that is still needed in memory.
    fn keep(&mut self, node: Node) {
        let index = node.0 as usize;
        if self.homes[index].is_none() && !self.uses[index].is_empty() {
            let place = Place {
                area: Area::Room,
                index: self.reserve(1),
            };
            self.plan.steps.push(Step::Keep(node, place));
            self.homes[index] = Some(place);
        }
    }

    /// Consecutive pairs of the stack memory.
    fn reserve(&mut self, count: u32) -> u32 {
        let run = |first: &u32| (0..count).all(|k| self.free.contains(&(first + k)));
        let first = match self.free.iter().copied().find(|first| run(first)) {
            Some(first) => first,
            None => {
                let first = self.plan.room;
                self.plan.room += count;
                self.free.extend(first..first + count);
                first
            }
        };
        for k in 0..count {
            self.free.remove(&(first + k));
        }
        first
    }
}
