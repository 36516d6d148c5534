//! Machine code for element classes, by Cranelift. Only this module uses Cranelift, and only this module has
//! unsafe code.
//!
//! Every value is an `F64X2` with two instances, and a flag is a mask in an `I64X2`. A function is one block
//! of straight-line code, planned in `plan`, with the addresses of `addresses`. An operation without an
//! instruction of its own is a call on both lanes in place, to the same `libm` and the same tables as in the
//! interpreter. No operation is fused or reordered, so the results equal the interpreter's to the bit (except
//! the payload of a NaN).

#![allow(unsafe_code)]

mod addresses;
mod plan;

use crate::codegen_error::CodegenError;
use crate::ir::interpret::Interpreter;
use crate::ir::look_up::{Orders, look_up};
use crate::ir::{ClassFunctions, Function, Node, Op};
use addresses::Addresses;
use cranelift::codegen::ir::{ConstantData, Endianness, FuncRef};
use cranelift::jit::{JITBuilder, JITModule};
use cranelift::module::{FuncId, Linkage, Module, ModuleError};
use cranelift::prelude::*;
use eng_system::code::{ElementCode, Function as Which, Pair};
use eng_system::elementary::Elementary;
use eng_system::elementary_functions;
use eng_system::table::{MOST_ARGUMENTS, Outside, Table};
use plan::{Area, Constants, Place, Step, plan};
use std::collections::BTreeMap;
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
    /// Owns the memory that `entries` point into. Nothing but `drop` touches it; the mutex makes it `Sync`
    /// without a promise of our own.
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

/// Cranelift's module while a class is generated.
struct Generator {
    module: JITModule,
    externals: BTreeMap<&'static str, FuncId>,
    constants: Constants,
    builder_context: FunctionBuilderContext,
}

impl Generator {
    fn new() -> Result<Self, CodegenError> {
        let machine = |e: &dyn std::fmt::Display| CodegenError::Machine(e.to_string());
        let mut flags = settings::builder();
        for (name, value) in [
            // the graph is optimised already, and its order of operations is the planned one
            ("opt_level", "none"),
            ("is_pic", "false"),
            ("use_colocated_libcalls", "false"),
            (
                "enable_verifier",
                if cfg!(debug_assertions) {
                    "true"
                } else {
                    "false"
                },
            ),
            // long functions may need more stack than a guard page covers
            ("enable_probestack", "true"),
            ("probestack_strategy", "inline"),
        ] {
            flags.set(name, value).map_err(|e| machine(&e))?;
        }
        let isa = cranelift::native::builder()
            .map_err(|e| machine(&e))?
            .finish(settings::Flags::new(flags))
            .map_err(|e| machine(&e))?;
        if isa.pointer_type() != types::I64 {
            return Err(CodegenError::Machine(
                "its addresses are not 64 bits wide".into(),
            ));
        }
        let mut builder = JITBuilder::with_isa(isa, cranelift::module::default_libcall_names());
        for function in Elementary::ALL {
            builder.symbol(symbol(function.name()), in_place(*function) as *const u8);
        }
        for (name, function) in TWO_ARGUMENTS {
            builder.symbol(symbol(name), function as *const u8);
        }
        builder.symbol(symbol(TABLE), table_pair as *const u8);
        let mut generator = Generator {
            module: JITModule::new(builder),
            externals: BTreeMap::new(),
            constants: Constants::default(),
            builder_context: FunctionBuilderContext::new(),
        };
        let one = Elementary::ALL.iter().map(|function| function.name());
        for name in one.chain(TWO_ARGUMENTS.iter().map(|(name, _)| *name)) {
            generator.declare(name, 1)?;
        }
        generator.declare(TABLE, 4)?;
        Ok(generator)
    }

    fn declare(&mut self, name: &'static str, arguments: usize) -> Result<(), CodegenError> {
        let mut signature = self.module.make_signature();
        signature
            .params
            .extend((0..arguments).map(|_| AbiParam::new(types::I64)));
        let id = self
            .module
            .declare_function(&symbol(name), Linkage::Import, &signature)
            .map_err(|e| CodegenError::Machine(e.to_string()))?;
        self.externals.insert(name, id);
        Ok(())
    }

    /// Generates a function. Returns its id and its size.
    fn function(&mut self, function: &Function) -> Result<(FuncId, usize), CodegenError> {
        let refuse = |message: String| CodegenError::Function {
            function: function.name.clone(),
            message,
        };
        let module_error = |e: ModuleError| match e {
            ModuleError::Compilation(e) => refuse(format!("{e:?}")),
            e => refuse(e.to_string()),
        };
        let mut context = self.module.make_context();
        context
            .func
            .signature
            .params
            .extend((0..3).map(|_| AbiParam::new(types::I64)));
        let id = self
            .module
            .declare_anonymous_function(&context.func.signature)
            .map_err(module_error)?;
        let frontend = self.module.target_config();
        let mut builder = FunctionBuilder::new(&mut context.func, &mut self.builder_context);
        let block = builder.create_block();
        builder.append_block_params_for_function_params(block);
        builder.switch_to_block(block);
        builder.seal_block(block);
        let (inputs, outputs, surroundings) = match builder.block_params(block) {
            [inputs, outputs, surroundings] => (*inputs, *outputs, *surroundings),
            _ => return Err(refuse("a function without its three arguments".into())),
        };
        let known = self.constants.bits.len();
        let plan = plan(function, &mut self.constants).map_err(refuse)?;
        let room = (plan.room > 0).then(|| {
            let size = plan.room * size_of::<Pair>() as u32;
            builder.create_sized_stack_slot(StackSlotData::new(
                StackSlotKind::ExplicitSlot,
                size,
                4,
            ))
        });
        let mut body = Body {
            module: &mut self.module,
            externals: &self.externals,
            constants: &mut self.constants,
            imported: BTreeMap::new(),
            builder,
            addresses: Addresses::new(inputs, outputs, surroundings, room, &plan.steps),
            surroundings,
            values: vec![None; function.graph.nodes().len()],
            loaded: None,
        };
        for (time, step) in plan.steps.iter().enumerate() {
            body.step(function, time, *step).map_err(refuse)?;
        }
        let mut builder = body.builder;
        builder.ins().return_(&[]);
        builder.finalize(frontend);
        self.module
            .define_function(id, &mut context)
            .map_err(module_error)?;
        let code = context
            .compiled_code()
            .map_or(0, |code| code.code_buffer().len());
        self.module.clear_context(&mut context);
        // a constant counts for the first function that uses it
        let constants = (self.constants.bits.len() - known) * size_of::<Pair>();
        Ok((id, code + constants))
    }
}

fn symbol(name: &str) -> String {
    format!("eng_{name}_pair")
}

/// A value of the graph in the generated code.
#[derive(Clone, Copy)]
enum Lanes {
    /// `F64X2`.
    Float(Value),
    /// `I64X2`, all ones or all zeros in each lane.
    Flag(Value),
}

/// A function's body while it is generated.
struct Body<'a, 'b> {
    module: &'a mut JITModule,
    externals: &'a BTreeMap<&'static str, FuncId>,
    constants: &'a mut Constants,
    imported: BTreeMap<&'static str, FuncRef>,
    builder: FunctionBuilder<'b>,
    addresses: Addresses,
    surroundings: Value,
    /// Values in registers.
    values: Vec<Option<Lanes>>,
    /// The value that the last step loaded.
    loaded: Option<Node>,
}

/// The sign of a float.
const SIGN: u64 = 1 << 63;

impl Body<'_, '_> {
    fn step(&mut self, function: &Function, time: usize, step: Step) -> Result<(), String> {
        match step {
            Step::Load(node, place) => {
                let is_mask = place.area == Area::Room && function.graph.op(node).is_flag();
                let value = if is_mask {
                    Lanes::Flag(self.load(time, place, types::I64X2)?)
                } else {
                    Lanes::Float(self.load(time, place, types::F64X2)?)
                };
                self.values[node.0 as usize] = Some(value);
            }
            Step::Store(node, place) => {
                let value = self.float(node)?;
                self.store(time, place, value)?;
            }
            Step::Keep(node, place) => {
                let (Lanes::Float(value) | Lanes::Flag(value)) = self.value(node)?;
                self.store(time, place, value)?;
            }
            Step::Operate(node) => {
                let value = self.operation(time, function.graph.op(node))?;
                self.values[node.0 as usize] = Some(value);
            }
            Step::Call(node, first) => {
                let address = self.addresses.in_room(&mut self.builder, first)?;
                self.external(function.graph.op(node).mnemonic(), &[address])?;
            }
            Step::LookUp(node, first, result) => {
                let Op::Table(_, _, orders) = function.graph.op(node) else {
                    return Err("a look-up without a table".into());
                };
                let operands = self.addresses.in_room(&mut self.builder, first)?;
                let result = self.addresses.in_room(&mut self.builder, result)?;
                let orders = self
                    .builder
                    .ins()
                    .iconst(types::I64, orders.packed() as i64);
                self.external(TABLE, &[operands, result, self.surroundings, orders])?;
            }
        }
        self.loaded = match step {
            Step::Load(node, _) => Some(node),
            _ => None,
        };
        Ok(())
    }

    fn load(&mut self, time: usize, place: Place, kind: Type) -> Result<Value, String> {
        let (base, offset) = self.addresses.of(&mut self.builder, time, place)?;
        let flags = MemFlagsData::new().with_notrap();
        Ok(self.builder.ins().load(kind, flags, base, offset))
    }

    fn store(&mut self, time: usize, place: Place, value: Value) -> Result<(), String> {
        let (base, offset) = self.addresses.of(&mut self.builder, time, place)?;
        let flags = MemFlagsData::new().with_notrap();
        self.builder.ins().store(flags, value, base, offset);
        Ok(())
    }

    fn value(&self, node: Node) -> Result<Lanes, String> {
        self.values[node.0 as usize].ok_or_else(|| format!("v{} is in no register", node.0))
    }

    fn float(&mut self, node: Node) -> Result<Value, String> {
        Ok(match self.value(node)? {
            Lanes::Float(value) => value,
            Lanes::Flag(mask) => {
                let one = self.constant(1.0);
                let one = self.cast(types::I64X2, one);
                let set = self.builder.ins().band(mask, one);
                self.cast(types::F64X2, set)
            }
        })
    }

    fn two(&mut self, a: Node, b: Node) -> Result<(Value, Value), String> {
        Ok((self.float(a)?, self.float(b)?))
    }

    /// The operands of a commutative operation. Only the second one can be read from memory, so they may be
    /// exchanged.
    fn commuted(&mut self, a: Node, b: Node) -> Result<(Value, Value), String> {
        if self.loaded == Some(a) {
            self.two(b, a)
        } else {
            self.two(a, b)
        }
    }

    fn flag(&mut self, node: Node) -> Result<Value, String> {
        Ok(match self.value(node)? {
            Lanes::Flag(mask) => mask,
            Lanes::Float(value) => {
                let zero = self.constant(0.0);
                self.builder.ins().fcmp(FloatCC::NotEqual, value, zero)
            }
        })
    }

    fn cast(&mut self, to: Type, value: Value) -> Value {
        let flags = MemFlagsData::new().with_endianness(Endianness::Little);
        self.builder.ins().bitcast(to, flags, value)
    }

    fn constant(&mut self, value: f64) -> Value {
        let lane = value.to_le_bytes();
        let data: Vec<u8> = lane.iter().chain(&lane).copied().collect();
        let constant = self
            .builder
            .func
            .dfg
            .constants
            .insert(ConstantData::from(data));
        self.builder.ins().vconst(types::F64X2, constant)
    }

    fn compare(&mut self, code: FloatCC, a: Node, b: Node) -> Result<Lanes, String> {
        let (a, b) = self.two(a, b)?;
        Ok(Lanes::Flag(self.builder.ins().fcmp(code, a, b)))
    }

    /// The bits of a value with a mask of the constants.
    fn masked(
        &mut self,
        time: usize,
        a: Node,
        mask: u64,
        combine: impl FnOnce(&mut FunctionBuilder<'_>, Value, Value) -> Value,
    ) -> Result<Value, String> {
        let a = self.float(a)?;
        let a = self.cast(types::I64X2, a);
        let place = self.constants.place(mask);
        let mask = self.load(time, place, types::I64X2)?;
        let bits = combine(&mut self.builder, a, mask);
        Ok(self.cast(types::F64X2, bits))
    }

    fn operation(&mut self, time: usize, op: Op) -> Result<Lanes, String> {
        let value = match op {
            Op::Add(a, b) => {
                let (a, b) = self.commuted(a, b)?;
                self.builder.ins().fadd(a, b)
            }
            Op::Subtract(a, b) => {
                let (a, b) = self.two(a, b)?;
                self.builder.ins().fsub(a, b)
            }
            Op::Multiply(a, b) => {
                let (a, b) = self.commuted(a, b)?;
                self.builder.ins().fmul(a, b)
            }
            Op::Divide(a, b) => {
                let (a, b) = self.two(a, b)?;
                self.builder.ins().fdiv(a, b)
            }
            Op::Negate(a) => self.masked(time, a, SIGN, |b, x, m| b.ins().bxor(x, m))?,
            Op::Abs(a) => self.masked(time, a, !SIGN, |b, x, m| b.ins().band(x, m))?,
            Op::Sqrt(a) => {
                let a = self.float(a)?;
                self.builder.ins().sqrt(a)
            }
            // these forms become one instruction if the processor has it
            Op::Minimum(a, b) => {
                let (a, b) = self.two(a, b)?;
                let mask = self.builder.ins().fcmp(FloatCC::LessThan, b, a);
                let mask = self.cast(types::F64X2, mask);
                self.builder.ins().bitselect(mask, b, a)
            }
            Op::Maximum(a, b) => {
                let (a, b) = self.two(a, b)?;
                let mask = self.builder.ins().fcmp(FloatCC::LessThan, a, b);
                let mask = self.cast(types::F64X2, mask);
                self.builder.ins().bitselect(mask, b, a)
            }
            Op::Less(a, b) => return self.compare(FloatCC::LessThan, a, b),
            Op::LessEqual(a, b) => return self.compare(FloatCC::LessThanOrEqual, a, b),
            Op::Equal(a, b) => return self.compare(FloatCC::Equal, a, b),
            Op::And(a, b) => {
                let (a, b) = (self.flag(a)?, self.flag(b)?);
                return Ok(Lanes::Flag(self.builder.ins().band(a, b)));
            }
            Op::Or(a, b) => {
                let (a, b) = (self.flag(a)?, self.flag(b)?);
                return Ok(Lanes::Flag(self.builder.ins().bor(a, b)));
            }
            Op::Not(a) => {
                let a = self.flag(a)?;
                return Ok(Lanes::Flag(self.builder.ins().bnot(a)));
            }
            Op::Select(flag, a, b) => {
                let mask = self.flag(flag)?;
                let mask = self.cast(types::F64X2, mask);
                let (a, b) = self.two(a, b)?;
                self.builder.ins().bitselect(mask, a, b)
            }
            op => return Err(format!("{} is no operation on registers", op.mnemonic())),
        };
        Ok(Lanes::Float(value))
    }

    /// Calls a function on both lanes, with addresses of operands and result in the stack room.
    fn external(&mut self, name: &str, arguments: &[Value]) -> Result<(), String> {
        let (name, id) = self
            .externals
            .get_key_value(name)
            .map(|(name, id)| (*name, *id))
            .ok_or_else(|| format!("no function {name}"))?;
        let function = match self.imported.get(name) {
            Some(function) => *function,
            None => {
                let function = self.module.declare_func_in_func(id, self.builder.func);
                self.imported.insert(name, function);
                function
            }
        };
        self.builder.ins().call(function, arguments);
        // no register keeps its value over a call
        self.addresses.forget();
        Ok(())
    }
}
