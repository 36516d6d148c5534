//! Makes the functions of a class callable: as machine code if there is a generator, else with the
//! interpreter.

pub use crate::codegen_error::CodegenError;
use crate::ir::{ClassFunctions, InterpretedClass};
use eng_system::code::ElementCode;
use std::sync::Arc;

/// Makes a class callable. Without the feature `jit`, or without a request for it, the class is interpreted.
/// The interpreter gives the same bits and is 3 to 25 times slower.
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
