//! From a class's functions to something callable: machine code where there is a generator, else the interpreter.

pub use crate::codegen_error::CodegenError;
use crate::ir::{ClassFunctions, InterpretedClass};
use eng_system::code::ElementCode;
use std::sync::Arc;

/// Makes a class callable. Without the feature `jit`, or if it is not asked for, the class is interpreted: the same
/// numbers to the bit, 3 to 25 times slower.
pub fn compile_class(
    functions: &ClassFunctions,
    use_jit: bool,
) -> Result<Arc<dyn ElementCode>, CodegenError> {
    #[cfg(feature = "jit")]
    if use_jit {
        return Ok(Arc::new(crate::jit::JitClass::new(functions)?));
    }
    let _ = use_jit;
    Ok(Arc::new(InterpretedClass::new(functions)))
}
