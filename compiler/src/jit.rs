//! Machine code for element classes, by Cranelift.
//!
//! Only this module and the modules inside of it use Cranelift, and no other module of the crate has unsafe
//! code.
//!
//! Every value is an `F64X2` with two instances, and a flag is a mask in an `I64X2`. A function is one block of
//! straight-line code, planned in `plan`, with the addresses of `addresses`. An operation without an instruction of
//! its own is a call, which replaces both lanes. It uses the same `libm` and the same tables as the interpreter. No
//! operation is fused or reordered, so the results equal the interpreter's to the bit (except the payload of a NaN).

#![allow(unsafe_code)]

mod addresses;
mod generator;
mod plan;

use crate::codegen_error::CodegenError;
use crate::ir::ClassFunctions;
use crate::ir::interpret::Interpreter;
use crate::ir::look_up::{Orders, look_up};
use cranelift::jit::JITModule;
use eng_system::code::{ElementCode, Function as Which, Pair};
use eng_system::elementary::Elementary;
use eng_system::elementary_functions;
use eng_system::table::{MOST_ARGUMENTS, Outside, Table};
use generator::Generator;
use std::sync::{Mutex, PoisonError};

/// The data of a call besides inputs and outputs.
#[repr(C)]
struct Surroundings {
    /// Constants of the class, which generated code reads.
    constants: *const Pair,
    /// Tables of the system, which generated code passes on.
    tables: *const Table,
    count: usize,
}

/// A generated function: inputs, outputs, surroundings.
type Entry = unsafe extern "C" fn(*const Pair, *mut Pair, *const Surroundings);

/// A class in machine code.
pub struct JitClass {
    entries: [Entry; Which::ALL.len()],
    shapes: [(usize, usize); Which::ALL.len()],
    bytes: [usize; Which::ALL.len()],
    /// Constants, which the code reads by their position.
    constants: Vec<Pair>,
    /// Interpreters of the functions that read tables, to find a table that is evaluated outside its points.
    readers: [Option<Interpreter>; Which::ALL.len()],
    /// Owns the memory that `entries` point into. Nothing but `drop` touches it. The mutex makes it `Sync`, so no
    /// unsafe code must promise that.
    module: Mutex<Option<JITModule>>,
}

impl JitClass {
    /// Generates the code of all functions of a class.
    pub fn new(functions: &ClassFunctions) -> Result<Self, CodegenError> {
        let mut generator = Generator::new()?;
        let mut list = Vec::with_capacity(Which::ALL.len());
        let outcome = Which::ALL
            .iter()
            .try_for_each(|which| {
                list.push(generator.function(functions.get(*which))?);
                Ok(())
            })
            .and_then(|()| {
                generator
                    .module
                    .finalize_definitions()
                    .map_err(|e| CodegenError::Memory(e.to_string()))
            });
        // from here on the class owns the module, so that it is freed after an error too
        let mut class = JitClass {
            entries: [nothing; Which::ALL.len()],
            shapes: [(0, 0); Which::ALL.len()],
            bytes: [0; Which::ALL.len()],
            constants: generator
                .constants
                .bits
                .iter()
                .map(|bits| [f64::from_bits(*bits); 2])
                .collect(),
            readers: Which::ALL.map(|which| {
                Some(Interpreter::new(functions.get(which))).filter(Interpreter::reads_tables)
            }),
            module: Mutex::new(None),
        };
        if outcome.is_ok() {
            for (which, (id, bytes)) in Which::ALL.into_iter().zip(list) {
                let function = functions.get(which);
                let code = generator.module.get_finalized_function(id);
                // SAFETY: `code` is the start of a finalized function with exactly the signature of `Entry`
                // in the platform's C convention (see `Generator::function`); it stays mapped and executable
                // until `drop` frees the module, and no copy of the pointer leaves `self`.
                class.entries[which as usize] =
                    unsafe { std::mem::transmute::<*const u8, Entry>(code) };
                class.shapes[which as usize] = (function.inputs as usize, function.outputs.len());
                class.bytes[which as usize] = bytes;
            }
        }
        class.module = Mutex::new(Some(generator.module));
        outcome.map(|()| class)
    }
}

/// The value of an entry before its code exists.
///
/// # Safety
///
/// Always safe: it touches nothing.
unsafe extern "C" fn nothing(_: *const Pair, _: *mut Pair, _: *const Surroundings) {}

impl Drop for JitClass {
    fn drop(&mut self) {
        let module = self
            .module
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        if let Some(module) = module {
            // SAFETY: `&mut self` in `drop`: no call is running, since `call` borrows `self` for its whole
            // length, and the entries, which never left `self`, go away with it.
            unsafe { module.free_memory() };
        }
    }
}

impl std::fmt::Debug for JitClass {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("JitClass")
            .field("shapes", &self.shapes)
            .field("bytes", &self.bytes)
            .finish_non_exhaustive()
    }
}

impl ElementCode for JitClass {
    fn shape(&self, function: Which) -> (usize, usize) {
        self.shapes[function as usize]
    }

    fn call(
        &self,
        function: Which,
        inputs: &[Pair],
        outputs: &mut [Pair],
        tables: &[Table],
    ) -> bool {
        let (takes, gives) = self.shape(function);
        if inputs.len() < takes || outputs.len() < gives {
            return false;
        }
        let context = Surroundings {
            constants: self.constants.as_ptr(),
            tables: tables.as_ptr(),
            count: tables.len(),
        };
        // SAFETY: the code reads inputs below `takes` (checked when it was generated) and writes outputs
        // below `gives`, both within the slices as just checked, and constants that stood in the generator's
        // list; it assumes no more than their own alignment. Input and output do not overlap (`&` and
        // `&mut`). `context` describes live slices and outlives the call. The code keeps no state, so calls
        // from several threads do not meet.
        unsafe {
            self.entries[function as usize](
                inputs.as_ptr(),
                outputs.as_mut_ptr(),
                &raw const context,
            )
        };
        true
    }

    fn outside(&self, which: Which, inputs: &[Pair], tables: &[Table]) -> [Option<Outside>; 2] {
        match &self.readers[which as usize] {
            Some(reader) => reader.outside(inputs, tables),
            None => [None, None],
        }
    }

    fn function_bytes(&self, function: Which) -> usize {
        self.bytes[function as usize]
    }
}

/// Defines the functions that the generated code calls for elementary functions. They replace the operand by the
/// result, lane by lane.
macro_rules! in_place {
    ($($variant:ident $name:literal $function:path;)*) => {
        fn in_place(function: Elementary) -> unsafe extern "C" fn(*mut Pair) {
            match function {
                $(Elementary::$variant => {
                    /// # Safety
                    ///
                    /// `io` points to a pair that is read and written.
                    unsafe extern "C" fn pair(io: *mut Pair) {
                        // SAFETY: generated code passes a pair of its own stack slot, which is aligned for it.
                        let io = unsafe { &mut *io };
                        *io = io.map($function);
                    }
                    pair
                })*
            }
        }
    };
}

elementary_functions!(in_place);

/// Defines functions of two operands. They replace the first one by the result.
macro_rules! in_place_two {
    ($($name:ident: $function:path;)*) => {
        $(
            /// # Safety
            ///
            /// `io` points to two pairs; both are read, the first is written.
            unsafe extern "C" fn $name(io: *mut [Pair; 2]) {
                // SAFETY: generated code passes two pairs of its own stack slot, which is aligned for them.
                let io = unsafe { &mut *io };
                let [a, b] = *io;
                io[0] = [$function(a[0], b[0]), $function(a[1], b[1])];
            }
        )*
    };
}

in_place_two! {
    atan2_pair: libm::atan2;
    power_pair: libm::pow;
}

/// Looks up a pair: handles and arguments in, values out.
///
/// # Safety
///
/// `operands` points to a pair and one more for each argument that `orders` counts, `result` to a pair that is none
/// of them, `context` to the tables of the call that is running.
unsafe extern "C" fn table_pair(
    operands: *const Pair,
    result: *mut Pair,
    context: *const Surroundings,
    orders: u64,
) {
    let orders = Orders::unpacked(orders);
    // SAFETY: generated code passes this many pairs of its own stack slot, which is aligned for them.
    let operands = unsafe { std::slice::from_raw_parts(operands, 1 + orders.arguments()) };
    // SAFETY: another pair of the same slot, which the plan has taken for the result.
    let result = unsafe { &mut *result };
    // SAFETY: generated code hands on the pointer that `call` gave it, which lives as long as the call.
    let context = unsafe { &*context };
    // SAFETY: made from a slice in `call`, which borrows it for the call.
    let tables = unsafe { std::slice::from_raw_parts(context.tables, context.count) };
    let lane = |k: usize| {
        let mut arguments = [0.0; MOST_ARGUMENTS];
        for (argument, pair) in arguments.iter_mut().zip(&operands[1..]) {
            *argument = pair[k];
        }
        look_up(tables, operands[0][k], &arguments, orders)
    };
    *result = [lane(0), lane(1)];
}

/// Functions of two operands outside the generated code, by their names in it. Each works in place.
const TWO_ARGUMENTS: [(&str, unsafe extern "C" fn(*mut [Pair; 2])); 2] =
    [("atan2", atan2_pair), ("power", power_pair)];
const TABLE: &str = "table";
