//! Short addresses.
//!
//! A place up to 128 bytes from a register takes one byte in an instruction, and any other place takes four.
//! So frequently used places share a register that points to their middle. After each call this register is
//! set again.

use super::plan::{Area, Place, Step};
use cranelift::codegen::ir::StackSlot;
use cranelift::prelude::*;
use eng_system::code::Pair;
use std::collections::BTreeMap;

const PAIR: i64 = size_of::<Pair>() as i64;

/// Reach of a one-byte offset to either side.
const REACH: i64 = 128;

/// Least number of uses for a base register. Setting it takes seven bytes, and each use saves three. So three uses
/// save two bytes, and four save five. A choice: the instruction that sets the register also takes time. The number
/// changes the length of the code alone, and no result.
const WORTH_A_BASE: usize = 4;

/// Most registers for bases at the same time. A choice: of the sixteen of x86-64, the rest serve for the
/// stack, inputs, outputs and calls.
const BASES: usize = 6;

/// Bases and their future uses.
pub(super) struct Addresses {
    inputs: Value,
    outputs: Value,
    surroundings: Value,
    room: Option<StackSlot>,
    constants: Option<Value>,
    /// Register in the middle of a stretch, by area and number of the stretch.
    bases: BTreeMap<(Area, i64), Value>,
    /// Times of the uses of a stretch, ascending.
    uses: BTreeMap<(Area, i64), Vec<usize>>,
    calls: Vec<usize>,
}

impl Addresses {
    pub fn new(
        inputs: Value,
        outputs: Value,
        surroundings: Value,
        room: Option<StackSlot>,
        steps: &[Step],
    ) -> Self {
        let mut uses: BTreeMap<(Area, i64), Vec<usize>> = BTreeMap::new();
        let mut calls = Vec::new();
        for (time, step) in steps.iter().enumerate() {
            match step {
                Step::Load(_, place) | Step::Store(_, place) | Step::Keep(_, place) => {
                    uses.entry(stretch(*place)).or_default().push(time);
                }
                Step::Call(..) | Step::LookUp(..) => calls.push(time),
                Step::Operate(_) => {}
            }
        }
        Addresses {
            inputs,
            outputs,
            surroundings,
            room,
            constants: None,
            bases: BTreeMap::new(),
            uses,
            calls,
        }
    }

    /// Base and offset of a place.
    pub fn of(
        &mut self,
        builder: &mut FunctionBuilder<'_>,
        time: usize,
        place: Place,
    ) -> Result<(Value, i32), String> {
        let offset = i64::from(place.index) * PAIR;
        let key = stretch(place);
        let middle = middle(key);
        let short = |offset: i64| {
            i32::try_from(offset).map_err(|_| format!("pair {} is too far away", place.index))
        };
        if let Some(base) = self.bases.get(&key) {
            return Ok((*base, short(offset - middle)?));
        }
        if (middle == 0 && place.area != Area::Room) || self.uses_ahead(key, time) < WORTH_A_BASE {
            return if place.area == Area::Room {
                Ok((self.in_room(builder, place.index)?, 0))
            } else {
                Ok((self.start(builder, place.area)?, short(offset)?))
            };
        }
        let base = match (place.area, self.room) {
            (Area::Room, Some(room)) => builder.ins().stack_addr(types::I64, room, short(middle)?),
            _ => {
                let start = self.start(builder, place.area)?;
                builder.ins().iadd_imm_s(start, middle)
            }
        };
        let base = hidden(builder, base);
        if self.bases.len() >= BASES {
            let farthest = self
                .bases
                .keys()
                .copied()
                .max_by_key(|key| self.next_use(*key, time));
            if let Some(key) = farthest {
                self.bases.remove(&key);
            }
        }
        self.bases.insert(key, base);
        Ok((base, short(offset - middle)?))
    }

    /// The address of a pair of the room.
    pub fn in_room(&self, builder: &mut FunctionBuilder<'_>, index: u32) -> Result<Value, String> {
        let room = self.room.ok_or("a function without room")?;
        let offset = i32::try_from(i64::from(index) * PAIR)
            .map_err(|_| format!("pair {index} of the room is too far away"))?;
        Ok(builder.ins().stack_addr(types::I64, room, offset))
    }

    /// Drops the bases, because otherwise a call would save and restore them.
    pub fn forget(&mut self) {
        self.bases.clear();
        self.constants = None;
    }

    fn start(&mut self, builder: &mut FunctionBuilder<'_>, area: Area) -> Result<Value, String> {
        match area {
            Area::Inputs => Ok(self.inputs),
            Area::Outputs => Ok(self.outputs),
            Area::Constants => Ok(match self.constants {
                Some(constants) => constants,
                None => {
                    let flags = MemFlagsData::new().with_notrap();
                    let start = builder.ins().load(types::I64, flags, self.surroundings, 0);
                    self.constants = Some(start);
                    start
                }
            }),
            Area::Room => Err("the room has no start of its own".into()),
        }
    }

    /// Uses of a stretch up to the next call.
    fn uses_ahead(&self, key: (Area, i64), time: usize) -> usize {
        let next = self.calls.partition_point(|call| *call < time);
        let end = self.calls.get(next).copied().unwrap_or(usize::MAX);
        self.uses.get(&key).map_or(0, |uses| {
            uses.partition_point(|u| *u < end) - uses.partition_point(|u| *u < time)
        })
    }

    fn next_use(&self, key: (Area, i64), time: usize) -> usize {
        self.uses
            .get(&key)
            .and_then(|uses| uses.get(uses.partition_point(|u| *u < time)))
            .copied()
            .unwrap_or(usize::MAX)
    }
}

/// The stretch of a place. The start of an area is a base itself, so its first stretch reaches to one side only. No register
/// has the start of the stack room, so each of its stretches reaches to both sides.
fn stretch(place: Place) -> (Area, i64) {
    let offset = i64::from(place.index) * PAIR;
    let first = if place.area == Area::Room { 0 } else { REACH };
    (place.area, (offset + first) / (2 * REACH))
}

/// Position of the base of a stretch, in bytes from the start of its area.
fn middle((area, number): (Area, i64)) -> i64 {
    let first = if area == Area::Room { REACH } else { 0 };
    first + 2 * REACH * number
}

/// The same value, computed so that the generator does not see the sum: it would write the sum into every address.
fn hidden(builder: &mut FunctionBuilder<'_>, value: Value) -> Value {
    let both = builder.ins().iconcat(value, value);
    builder.ins().isplit(both).0
}
