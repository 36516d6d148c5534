//! Cranelift code of the functions of a class.

use super::addresses::Addresses;
use super::plan::{Area, Constants, Place, Step, plan};
use super::{TABLE, TWO_ARGUMENTS, in_place, table_pair};
use crate::codegen_error::CodegenError;
use crate::ir::{Function, Node, Op};
use cranelift::codegen::ir::{ConstantData, Endianness, FuncRef};
use cranelift::jit::{JITBuilder, JITModule};
use cranelift::module::{FuncId, Linkage, Module, ModuleError};
use cranelift::prelude::*;
use eng_system::code::Pair;
use eng_system::elementary::Elementary;
use std::collections::BTreeMap;

/// Cranelift's module while a class is generated.
pub(super) struct Generator {
    pub(super) module: JITModule,
    externals: BTreeMap<&'static str, FuncId>,
    pub(super) constants: Constants,
    builder_context: FunctionBuilderContext,
}

impl Generator {
    pub(super) fn new() -> Result<Self, CodegenError> {
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
    pub(super) fn function(
        &mut self,
        function: &Function,
    ) -> Result<(FuncId, usize), CodegenError> {
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
