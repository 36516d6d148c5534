//! An instance as an importer holds it: the FMU with its log, and the calls that both versions share.
#![expect(unsafe_code, reason = "memory of the importer")]

use super::Saved;
use super::slave::Slave;
use crate::edge::{self, Refused};
use std::ffi::{c_int, c_void};
use std::path::Path;

/// The call did its work.
pub const OK: c_int = 0;
/// A doubt is reported to the importer.
pub const WARNING: c_int = 1;
/// A step ended before its end, because the condition of the analysis ends the simulation.
pub const DISCARD: c_int = 2;
/// The call is refused.
pub const ERROR: c_int = 3;

/// Tells the importer a message with its status.
pub type Log = Box<dyn Fn(c_int, &str)>;

/// An instance of an FMU with the log of its importer.
pub struct Instance {
    slave: Slave,
    log: Log,
    /// Whether warnings are reported. Errors always are.
    pub(super) logging: bool,
}

impl Instance {
    /// A new instance, or a null pointer after a message.
    pub(super) fn made(
        resources: impl FnOnce() -> Result<std::path::PathBuf, Refused>,
        token: impl FnOnce() -> Result<String, Refused>,
        log: Log,
        logging: bool,
    ) -> *mut Instance {
        let made = edge::caught(|| {
            let (resources, token) = (resources()?, token()?);
            Slave::new(Path::new(&resources), &token)
        });
        match made {
            Ok((slave, warnings)) => {
                if logging && !warnings.is_empty() {
                    log(WARNING, &warnings);
                }
                edge::given(Instance {
                    slave,
                    log,
                    logging,
                })
            }
            Err(refused) => {
                log(ERROR, &refused.0);
                std::ptr::null_mut()
            }
        }
    }
}

/// A call on an instance. The importer gets the text of a refusal.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
pub(super) unsafe fn call(
    instance: *mut Instance,
    work: impl FnOnce(&mut Slave) -> Result<(), Refused>,
) -> c_int {
    // SAFETY: by the promise of the caller
    let Ok(instance) = (unsafe { edge::changed(instance, "instance") }) else {
        return ERROR;
    };
    let slave = &mut instance.slave;
    let done = edge::caught(|| work(slave));
    if instance.logging {
        for warning in instance.slave.warnings() {
            (instance.log)(WARNING, &warning);
        }
    }
    match done {
        Ok(()) => OK,
        Err(refused) => {
            (instance.log)(ERROR, &refused.0);
            ERROR
        }
    }
}

/// A step. `DISCARD` tells that the condition of the analysis has ended the simulation within it.
///
/// # Safety
/// As [`call`].
pub(super) unsafe fn step(
    instance: *mut Instance,
    work: impl FnOnce(&mut Slave) -> Result<(), Refused>,
) -> c_int {
    let mut stopped = None;
    let stepped = |slave: &mut Slave| {
        work(slave)?;
        stopped = slave.stopped();
        Ok(())
    };
    // SAFETY: by the promise of the caller
    let status = unsafe { call(instance, stepped) };
    let Some(reason) = stopped.filter(|_| status == OK) else {
        return status;
    };
    // SAFETY: by the promise of the caller
    if let Ok(instance) = unsafe { edge::shared(instance, "instance") } {
        (instance.log)(DISCARD, &reason);
    }
    DISCARD
}

/// Reads variables.
///
/// # Safety
/// As [`call`]; `references` points to `count` value references, `values` to room for as many numbers.
pub(super) unsafe fn get(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *mut f64,
) -> c_int {
    let work = |slave: &mut Slave| {
        // SAFETY: by the promise of the caller
        let references = unsafe { edge::numbers(references, count, "value references")? };
        // SAFETY: by the promise of the caller
        let values = unsafe { edge::room(values, count, "values")? };
        for (reference, value) in references.iter().zip(values) {
            *value = slave.get(*reference)?;
        }
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { call(instance, work) }
}

/// Sets variables.
///
/// # Safety
/// As [`call`]; `references` and `values` point to `count` numbers.
pub(super) unsafe fn set(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *const f64,
) -> c_int {
    let work = |slave: &mut Slave| {
        // SAFETY: by the promise of the caller
        let references = unsafe { edge::numbers(references, count, "value references")? };
        // SAFETY: by the promise of the caller
        let values = unsafe { edge::numbers(values, count, "values")? };
        for (reference, value) in references.iter().zip(values) {
            slave.set(*reference, *value)?;
        }
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { call(instance, work) }
}

/// Gives the present state to the importer, in place of an earlier one if there is one.
///
/// # Safety
/// As [`call`]; `state` is null, or points to a null pointer or to a state of this function that is not freed.
pub(super) unsafe fn save(instance: *mut Instance, state: *mut *mut c_void) -> c_int {
    let work = |slave: &mut Slave| {
        // SAFETY: by the promise of the caller
        let place = unsafe { edge::changed(state, "place of the state")? };
        let saved = slave.save();
        // SAFETY: by the promise of the caller
        match unsafe { place.cast::<Saved>().as_mut() } {
            Some(earlier) => *earlier = saved,
            None => *place = edge::given(saved).cast(),
        }
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { call(instance, work) }
}

/// Continues from a state.
///
/// # Safety
/// As [`call`]; `state` is null, or of [`save`] or [`deserialize`] and not freed.
pub(super) unsafe fn restore(instance: *mut Instance, state: *mut c_void) -> c_int {
    let work = |slave: &mut Slave| {
        // SAFETY: by the promise of the caller
        slave.restore(unsafe { edge::shared(state.cast::<Saved>(), "state")? })
    };
    // SAFETY: by the promise of the caller
    unsafe { call(instance, work) }
}

/// Frees a state. A null pointer is nothing.
///
/// # Safety
/// As [`call`]; `state` is null, or points to a null pointer or to a state that is not freed.
pub(super) unsafe fn free(instance: *mut Instance, state: *mut *mut c_void) -> c_int {
    let work = |_: &mut Slave| {
        // SAFETY: by the promise of the caller
        if let Some(place) = unsafe { state.as_mut() } {
            let state = std::mem::replace(place, std::ptr::null_mut());
            // SAFETY: by the promise of the caller
            unsafe { edge::taken(state.cast::<Saved>()) };
        }
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { call(instance, work) }
}

/// Writes the number of bytes of a state.
///
/// # Safety
/// As [`restore`]; `size` is null or points to room.
pub(super) unsafe fn size(instance: *mut Instance, state: *mut c_void, size: *mut usize) -> c_int {
    let work = |_: &mut Slave| {
        // SAFETY: by the promise of the caller
        let state = unsafe { edge::shared(state.cast::<Saved>(), "state")? };
        let bytes = state.bytes()?;
        // SAFETY: by the promise of the caller
        unsafe { edge::written(size, bytes.len(), "size") }
    };
    // SAFETY: by the promise of the caller
    unsafe { call(instance, work) }
}

/// Writes the bytes of a state.
///
/// # Safety
/// As [`restore`]; `bytes` points to room for `size` bytes.
pub(super) unsafe fn serialize(
    instance: *mut Instance,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    let work = |_: &mut Slave| {
        // SAFETY: by the promise of the caller
        let state = unsafe { edge::shared(state.cast::<Saved>(), "state")? };
        let made = state.bytes()?;
        // SAFETY: by the promise of the caller
        let room = unsafe { edge::room(bytes, size, "bytes")? };
        if room.len() != made.len() {
            return Err(Refused(format!(
                "the state has {} bytes, and there is room for {size}",
                made.len()
            )));
        }
        room.copy_from_slice(&made);
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { call(instance, work) }
}

/// Gives the state of bytes to the importer.
///
/// # Safety
/// As [`save`]; `bytes` points to `size` bytes.
pub(super) unsafe fn deserialize(
    instance: *mut Instance,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> c_int {
    let work = |_: &mut Slave| {
        // SAFETY: by the promise of the caller
        let bytes = unsafe { edge::numbers(bytes, size, "bytes")? };
        let saved = Saved::from_bytes(bytes)?;
        // SAFETY: by the promise of the caller
        let place = unsafe { edge::changed(state, "place of the state")? };
        *place = edge::given(saved).cast();
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { call(instance, work) }
}

/// Functions of a standard that an FMU does not offer: each refuses its call with a reason.
macro_rules! refuse {
    ($($reason:literal: $($name:ident($($argument:ty),*);)*)*) => {$($(
        /// Refuses its call: the FMU does not offer it.
        ///
        /// # Safety
        /// `instance` is null, or an instance that is not freed and that no other call uses.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut Instance $(, _: $argument)*) -> c_int {
            let refusal = Refused::new(concat!(stringify!($name), " is refused: ", $reason));
            // SAFETY: by the promise of the caller
            unsafe { instance::call(instance, |_| Err(refusal)) }
        }
    )*)*};
}
pub(super) use refuse;
