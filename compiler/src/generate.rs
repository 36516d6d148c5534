//! From a class's functions to something callable: machine code where there is a generator, else the interpreter.

pub use crate::codegen_error::CodegenError;
use crate::ir::{ClassFunctions, InterpretedClass};
use eng_system::code::ElementCode;
use std::collections::BTreeMap;
use std::sync::{Arc, Weak};

/// Makes a class callable. Without the feature `jit`, or if it is not asked for, the class is interpreted: the same
/// numbers to the bit, 3 to 25 times slower.
pub fn compile_class(
    functions: ClassFunctions,
    use_jit: bool,
) -> Result<Arc<dyn ElementCode>, CodegenError> {
    #[cfg(feature = "jit")]
    if use_jit {
        return Ok(Arc::new(crate::jit::JitClass::new(&functions)?));
    }
    let _ = use_jit;
    Ok(Arc::new(InterpretedClass::new(&functions)))
}

/// Classes that are in use, so that equal ones are compiled once.
#[derive(Debug, Default)]
pub struct CodeCache {
    classes: BTreeMap<(u128, bool), Weak<dyn ElementCode>>,
}

impl CodeCache {
    /// An empty cache.
    pub fn new() -> Self {
        Self::default()
    }

    /// The code of a class: that of an equal one which is still in use, or new.
    pub fn compile(
        &mut self,
        functions: ClassFunctions,
        use_jit: bool,
    ) -> Result<Arc<dyn ElementCode>, CodegenError> {
        let key = (functions.fingerprint(), use_jit);
        if let Some(code) = self.classes.get(&key).and_then(Weak::upgrade) {
            return Ok(code);
        }
        let code = compile_class(functions, use_jit)?;
        self.classes.retain(|_, code| code.strong_count() > 0);
        self.classes.insert(key, Arc::downgrade(&code));
        Ok(code)
    }
}
