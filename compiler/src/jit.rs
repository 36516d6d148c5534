//! Machine code for element classes, by Cranelift: the one module that knows it, and the one with unsafe code.
//!
//! Every value is an `F64X2`, two instances; a flag is a mask in an `I64X2`. A function is one block of straight-line
//! code. What is no single instruction is a call on both lanes in place, to the same `libm` and the same tables as the
//! interpreter's. No operation is fused or reordered, so the results are the interpreter's to the bit (the payload
//! of a NaN aside).

#![allow(unsafe_code)]

use crate::generate::CodegenError;
use crate::ir::interpret::look_up;
use crate::ir::{ClassFunctions, Function, Node, Op};
use cranelift::codegen::ir::immediates::Offset32;
use cranelift::codegen::ir::{ConstantData, Endianness, FuncRef, StackSlot};
use cranelift::jit::{JITBuilder, JITModule};
use cranelift::module::{FuncId, Linkage, Module, ModuleError};
use cranelift::prelude::*;
use eng_system::code::{ElementCode, Function as Which, Pair};
use eng_system::table::Table;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// The tables of a call, as the generated code hands them on.
#[repr(C)]
struct TableContext {
    tables: *const Table,
    count: usize,
}

/// A generated function: inputs, outputs, tables.
type Entry = unsafe extern "C" fn(*const Pair, *mut Pair, *const TableContext);

/// A class in machine code.
pub struct JitClass {
    entries: [Entry; 7],
    shapes: [(usize, usize); 7],
    bytes: [usize; 7],
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
        // from here on the class owns the module, also to free it after an error
        let mut class = JitClass {
            entries: [nothing; 7],
            shapes: [(0, 0); 7],
            bytes: [0; 7],
            module: Mutex::new(None),
        };
        if outcome.is_ok() {
            for (which, (id, bytes)) in Which::ALL.into_iter().zip(list) {
                let function = functions.get(which);
                let code = generator.module.get_finalized_function(id);
                // SAFETY: `code` is the start of a finalized function with exactly the signature of `Entry` in
                // the platform's C convention (see `Generator::function`); it stays mapped and executable until
                // `drop` frees the module, and no copy of the pointer leaves `self`.
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

/// Stands in an entry until the code is there.
///
/// # Safety
///
/// Always safe: it touches nothing.
unsafe extern "C" fn nothing(_: *const Pair, _: *mut Pair, _: *const TableContext) {}

impl Drop for JitClass {
    fn drop(&mut self) {
        let module = self
            .module
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        if let Some(module) = module {
            // SAFETY: `&mut self` in `drop`: no call is running, since `call` borrows `self` for its whole length,
            // and the entries, which never left `self`, go away with it.
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
        let context = TableContext {
            tables: tables.as_ptr(),
            count: tables.len(),
        };
        // SAFETY: the code reads inputs below `takes` (checked when it was generated) and writes outputs below `gives`,
        // both within the slices as just checked; it assumes no more than their own alignment. Input and output do not
        // overlap (`&` and `&mut`). `context` describes a live slice and outlives the call. The code keeps no state, so
        // calls from several threads do not meet.
        unsafe {
            self.entries[function as usize](
                inputs.as_ptr(),
                outputs.as_mut_ptr(),
                &raw const context,
            )
        };
        true
    }

    fn function_bytes(&self, function: Which) -> usize {
        self.bytes[function as usize]
    }
}

/// Defines functions that the generated code calls: they replace the first operand by the result, lane by lane.
macro_rules! in_place {
    ($($name:ident: $function:path;)*) => {
        $(
            /// # Safety
            ///
            /// `io` points to two pairs; the first is read and written.
            unsafe extern "C" fn $name(io: *mut [Pair; 2]) {
                // SAFETY: generated code passes its own stack slot of that size and alignment.
                let io = unsafe { &mut *io };
                io[0] = io[0].map($function);
            }
        )*
    };
}

/// The same with two operands.
macro_rules! in_place_two {
    ($($name:ident: $function:path;)*) => {
        $(
            /// # Safety
            ///
            /// `io` points to two pairs; both are read, the first is written.
            unsafe extern "C" fn $name(io: *mut [Pair; 2]) {
                // SAFETY: generated code passes its own stack slot of that size and alignment.
                let io = unsafe { &mut *io };
                let [a, b] = *io;
                io[0] = [$function(a[0], b[0]), $function(a[1], b[1])];
            }
        )*
    };
}

in_place! {
    sin_pair: libm::sin;
    cos_pair: libm::cos;
    tan_pair: libm::tan;
    asin_pair: libm::asin;
    acos_pair: libm::acos;
    atan_pair: libm::atan;
    tanh_pair: libm::tanh;
    exp_pair: libm::exp;
    log_pair: libm::log;
}

in_place_two! {
    atan2_pair: libm::atan2;
    power_pair: libm::pow;
}

/// Looks up a pair: handles and arguments in, values out in place of the handles.
///
/// # Safety
///
/// `io` points to two pairs, `context` to the tables of the call that is running.
unsafe extern "C" fn table_pair(io: *mut [Pair; 2], context: *const TableContext, order: u64) {
    // SAFETY: generated code passes its own stack slot of that size and alignment.
    let io = unsafe { &mut *io };
    // SAFETY: generated code hands on the pointer that `call` gave it, which lives as long as the call.
    let context = unsafe { &*context };
    // SAFETY: made from a slice in `call`, which borrows it for the call.
    let tables = unsafe { std::slice::from_raw_parts(context.tables, context.count) };
    let [handles, arguments] = *io;
    let order = order.min(u64::from(u8::MAX)) as u8;
    io[0] = [
        look_up(tables, handles[0], arguments[0], order),
        look_up(tables, handles[1], arguments[1], order),
    ];
}

/// Functions outside the generated code, by their names there.
const ONE_ARGUMENT: [(&str, unsafe extern "C" fn(*mut [Pair; 2])); 11] = [
    ("sin", sin_pair),
    ("cos", cos_pair),
    ("tan", tan_pair),
    ("asin", asin_pair),
    ("acos", acos_pair),
    ("atan", atan_pair),
    ("tanh", tanh_pair),
    ("exp", exp_pair),
    ("log", log_pair),
    ("atan2", atan2_pair),
    ("power", power_pair),
];
const TABLE: &str = "table";

/// Cranelift's module while a class is generated.
struct Generator {
    module: JITModule,
    externals: BTreeMap<&'static str, FuncId>,
    builder_context: FunctionBuilderContext,
}

impl Generator {
    fn new() -> Result<Self, CodegenError> {
        let machine = |e: &dyn std::fmt::Display| CodegenError::Machine(e.to_string());
        let mut flags = settings::builder();
        for (name, value) in [
            // our own optimiser has done what there is to do, and its order of operations is the better one
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
        for (name, function) in ONE_ARGUMENT {
            builder.symbol(symbol(name), function as *const u8);
        }
        builder.symbol(symbol(TABLE), table_pair as *const u8);
        let mut generator = Generator {
            module: JITModule::new(builder),
            externals: BTreeMap::new(),
            builder_context: FunctionBuilderContext::new(),
        };
        for (name, _) in ONE_ARGUMENT {
            generator.declare(name, 1)?;
        }
        generator.declare(TABLE, 3)?;
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

    /// Generates a function; its id and its size.
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
        let (inputs, outputs, tables) = match builder.block_params(block) {
            [inputs, outputs, tables] => (*inputs, *outputs, *tables),
            _ => return Err(refuse("a function without its three arguments".into())),
        };
        let mut body = Body {
            module: &mut self.module,
            externals: &self.externals,
            imported: BTreeMap::new(),
            room: None,
            builder,
            inputs,
            tables,
            values: Vec::with_capacity(function.graph.nodes().len()),
            homes: vec![None; function.graph.nodes().len()],
            used: vec![0; function.graph.nodes().len()],
            emitted: 0,
        };
        let stores = stores(function);
        let needed = crate::ir::optimise::dependencies(&function.graph, &function.outputs);
        for (index, op) in function.graph.nodes().iter().enumerate() {
            let value = match *op {
                // never read
                _ if !needed[index] => Lanes::Float(inputs),
                Op::Input(i) if i >= function.inputs => {
                    return Err(refuse(format!("input {i} of {}", function.inputs)));
                }
                // loaded where it is used
                Op::Input(i) => {
                    body.homes[index] = Some((inputs, offset(i).map_err(refuse)?));
                    Lanes::Float(inputs)
                }
                op => body.operation(op).map_err(refuse)?,
            };
            body.values.push(value);
            body.emitted += 1;
            body.used[index] = body.emitted;
            for output in stores.get(&index).into_iter().flatten() {
                let value = body.float(Node(index as u32));
                let offset = offset(*output as u32).map_err(refuse)?;
                body.builder
                    .ins()
                    .store(MemFlagsData::new().with_notrap(), value, outputs, offset);
                if body.homes[index].is_none() {
                    body.homes[index] = Some((outputs, offset));
                }
            }
        }
        let mut builder = body.builder;
        builder.ins().return_(&[]);
        builder.finalize(frontend);
        self.module
            .define_function(id, &mut context)
            .map_err(module_error)?;
        let bytes = context
            .compiled_code()
            .map_or(0, |code| code.code_buffer().len());
        self.module.clear_context(&mut context);
        Ok((id, bytes))
    }
}

fn symbol(name: &str) -> String {
    format!("eng_{name}_pair")
}

/// Which outputs a node is.
fn stores(function: &Function) -> BTreeMap<usize, Vec<usize>> {
    let mut stores: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (output, node) in function.outputs.iter().enumerate() {
        stores.entry(node.0 as usize).or_default().push(output);
    }
    stores
}

/// Bytes from the start of inputs or outputs to a pair.
fn offset(index: u32) -> Result<Offset32, String> {
    i32::try_from(u64::from(index) * size_of::<Pair>() as u64)
        .map(Offset32::new)
        .map_err(|_| format!("input or output {index} is too far away"))
}

/// A value of the graph in the generated code.
#[derive(Clone, Copy)]
enum Lanes {
    /// `F64X2`.
    Float(Value),
    /// `I64X2`, all ones or all zeros in each lane.
    Flag(Value),
}

impl Lanes {
    fn is(self, other: Value) -> bool {
        matches!(self, Lanes::Float(value) if value == other)
    }
}

/// A function's body while it is generated.
struct Body<'a, 'b> {
    module: &'a mut JITModule,
    externals: &'a BTreeMap<&'static str, FuncId>,
    imported: BTreeMap<&'static str, FuncRef>,
    /// Where calls find their operands.
    room: Option<StackSlot>,
    builder: FunctionBuilder<'b>,
    inputs: Value,
    tables: Value,
    values: Vec<Lanes>,
    /// Where in memory a node stands: an input, or an output that is written already.
    homes: Vec<Option<(Value, Offset32)>>,
    /// When a node was last in a register, counted in operations.
    used: Vec<usize>,
    emitted: usize,
}

/// A value with a home that was not used for so many operations is loaded again: cheaper than to keep it in a register, which
/// others then leave for the stack.
const KEPT_FOR: usize = 24;

impl Body<'_, '_> {
    fn float(&mut self, node: Node) -> Value {
        let index = node.0 as usize;
        if let Some((base, offset)) = self.homes[index] {
            let fresh = base == self.inputs && self.values[index].is(base);
            if fresh || self.emitted - self.used[index] > KEPT_FOR {
                let flags = MemFlagsData::new().with_notrap();
                let value = self.builder.ins().load(types::F64X2, flags, base, offset);
                self.values[index] = Lanes::Float(value);
            }
            self.used[index] = self.emitted;
        }
        match self.values[index] {
            Lanes::Float(value) => value,
            Lanes::Flag(mask) => {
                let one = self.constant(1.0);
                let one = self.cast(types::I64X2, one);
                let set = self.builder.ins().band(mask, one);
                self.cast(types::F64X2, set)
            }
        }
    }

    fn flag(&mut self, node: Node) -> Value {
        match self.values[node.0 as usize] {
            Lanes::Flag(mask) => mask,
            Lanes::Float(value) => {
                let zero = self.constant(0.0);
                self.builder.ins().fcmp(FloatCC::NotEqual, value, zero)
            }
        }
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

    fn compare(&mut self, code: FloatCC, a: Node, b: Node) -> Lanes {
        let (a, b) = (self.float(a), self.float(b));
        Lanes::Flag(self.builder.ins().fcmp(code, a, b))
    }

    /// b where `b code a`, else a.
    fn extreme(&mut self, code: FloatCC, a: Node, b: Node) -> Value {
        let (a, b) = (self.float(a), self.float(b));
        let mask = self.builder.ins().fcmp(code, b, a);
        let mask = self.cast(types::F64X2, mask);
        self.builder.ins().bitselect(mask, b, a)
    }

    fn operation(&mut self, op: Op) -> Result<Lanes, String> {
        let value = match op {
            Op::Input(i) => return Err(format!("input {i} has no home")),
            Op::Constant(bits) => self.constant(f64::from_bits(bits)),
            Op::Add(a, b) => {
                let (a, b) = (self.float(a), self.float(b));
                self.builder.ins().fadd(a, b)
            }
            Op::Subtract(a, b) => {
                let (a, b) = (self.float(a), self.float(b));
                self.builder.ins().fsub(a, b)
            }
            Op::Multiply(a, b) => {
                let (a, b) = (self.float(a), self.float(b));
                self.builder.ins().fmul(a, b)
            }
            Op::Divide(a, b) => {
                let (a, b) = (self.float(a), self.float(b));
                self.builder.ins().fdiv(a, b)
            }
            Op::Negate(a) => {
                let a = self.float(a);
                self.builder.ins().fneg(a)
            }
            Op::Abs(a) => {
                let a = self.float(a);
                self.builder.ins().fabs(a)
            }
            Op::Sqrt(a) => {
                let a = self.float(a);
                self.builder.ins().sqrt(a)
            }
            Op::Minimum(a, b) => self.extreme(FloatCC::LessThan, a, b),
            Op::Maximum(a, b) => self.extreme(FloatCC::GreaterThan, a, b),
            Op::Sin(a)
            | Op::Cos(a)
            | Op::Tan(a)
            | Op::Asin(a)
            | Op::Acos(a)
            | Op::Atan(a)
            | Op::Tanh(a)
            | Op::Exp(a)
            | Op::Log(a) => self.external(op.mnemonic(), a, None, None)?,
            Op::Atan2(a, b) | Op::Power(a, b) => self.external(op.mnemonic(), a, Some(b), None)?,
            Op::Table(handle, argument, order) => {
                self.external(TABLE, handle, Some(argument), Some(order))?
            }
            Op::Less(a, b) => return Ok(self.compare(FloatCC::LessThan, a, b)),
            Op::LessEqual(a, b) => return Ok(self.compare(FloatCC::LessThanOrEqual, a, b)),
            Op::Equal(a, b) => return Ok(self.compare(FloatCC::Equal, a, b)),
            Op::And(a, b) => {
                let (a, b) = (self.flag(a), self.flag(b));
                return Ok(Lanes::Flag(self.builder.ins().band(a, b)));
            }
            Op::Or(a, b) => {
                let (a, b) = (self.flag(a), self.flag(b));
                return Ok(Lanes::Flag(self.builder.ins().bor(a, b)));
            }
            Op::Not(a) => {
                let a = self.flag(a);
                return Ok(Lanes::Flag(self.builder.ins().bnot(a)));
            }
            Op::Select(flag, a, b) => {
                let mask = self.flag(flag);
                let mask = self.cast(types::F64X2, mask);
                let (a, b) = (self.float(a), self.float(b));
                self.builder.ins().bitselect(mask, a, b)
            }
        };
        Ok(Lanes::Float(value))
    }

    /// Calls a function on both lanes: operands and result stand in a slot of the stack.
    fn external(
        &mut self,
        name: &str,
        a: Node,
        b: Option<Node>,
        order: Option<u8>,
    ) -> Result<Value, String> {
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
        let room = match self.room {
            Some(room) => room,
            None => {
                let size = size_of::<[Pair; 2]>() as u32;
                let data = StackSlotData::new(StackSlotKind::ExplicitSlot, size, 4);
                let room = self.builder.create_sized_stack_slot(data);
                self.room = Some(room);
                room
            }
        };
        let flags = MemFlagsData::new().with_notrap();
        let address = self.builder.ins().stack_addr(types::I64, room, 0);
        let a = self.float(a);
        self.builder.ins().store(flags, a, address, 0);
        if let Some(b) = b {
            let b = self.float(b);
            self.builder
                .ins()
                .store(flags, b, address, size_of::<Pair>() as i32);
        }
        match order {
            Some(order) => {
                let order = self.builder.ins().iconst(types::I64, i64::from(order));
                self.builder
                    .ins()
                    .call(function, &[address, self.tables, order]);
            }
            None => {
                self.builder.ins().call(function, &[address]);
            }
        }
        Ok(self.builder.ins().load(types::F64X2, flags, address, 0))
    }
}
