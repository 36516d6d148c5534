//! The functions of FMI 3.0. Texts, references and values are memory of the importer, by the rules of the standard.
#![expect(unsafe_code, reason = "functions for importers, and their memory")]

use super::instance::{self, ERROR, Instance, Log, OK, refuse};
use crate::edge::{self, Refused};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::path::PathBuf;

/// Takes a message with its status and category.
type LogMessage = Option<unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char)>;
/// Takes intermediate values, which the FMU does not give.
type IntermediateUpdate = Option<unsafe extern "C" fn()>;

/// The log of an importer.
fn log(message: LogMessage, environment: *mut c_void) -> Log {
    Box::new(move |status, text| {
        if let Some(message) = message {
            let text = edge::c_text(text);
            // SAFETY: the standard lets an instance call it with the environment that the importer gave
            unsafe {
                message(
                    environment,
                    status,
                    category(status).as_ptr(),
                    text.as_ptr(),
                )
            };
        }
    })
}

/// The category of a message in the description.
pub(super) fn category(status: c_int) -> &'static CStr {
    match status {
        ERROR => c"logStatusError",
        _ => c"logStatusWarning",
    }
}

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Switches the messages about warnings on or off.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: *mut Instance,
    logging: bool,
    _: usize,
    _: *const *const c_char,
) -> c_int {
    // SAFETY: by the promise of the caller
    match unsafe { edge::changed(instance, "instance") } {
        Ok(instance) => {
            instance.logging = logging;
            OK
        }
        Err(_) => ERROR,
    }
}

/// A new instance for co-simulation.
///
/// # Safety
/// The texts are null or end with a zero byte; the functions and the environment are those of the standard.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    logging: bool,
    event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    intermediate: usize,
    environment: *mut c_void,
    message: LogMessage,
    _update: IntermediateUpdate,
) -> *mut Instance {
    let resources = || {
        if event_mode || intermediate > 0 {
            return Err(Refused::new(
                "the FMU has neither an event mode nor intermediate values: see its description",
            ));
        }
        // SAFETY: by the promise of the caller
        Ok(PathBuf::from(unsafe {
            edge::text(resources, "path of the resources")?
        }))
    };
    // SAFETY: by the promise of the caller
    let token = || Ok(unsafe { edge::text(token, "instantiation token")? }.to_owned());
    Instance::made(resources, token, log(message, environment), logging)
}

/// Refuses: the FMU is for co-simulation.
///
/// # Safety
/// The function and the environment are those of the standard.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging: bool,
    environment: *mut c_void,
    message: LogMessage,
) -> *mut Instance {
    log(message, environment)(
        ERROR,
        "the FMU is for co-simulation, not for model exchange",
    );
    std::ptr::null_mut()
}

/// Refuses: the FMU is for co-simulation.
///
/// # Safety
/// The functions and the environment are those of the standard.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging: bool,
    environment: *mut c_void,
    message: LogMessage,
    _clock: Option<unsafe extern "C" fn()>,
    _lock: Option<unsafe extern "C" fn()>,
    _unlock: Option<unsafe extern "C" fn()>,
) -> *mut Instance {
    log(message, environment)(
        ERROR,
        "the FMU is for co-simulation, not for scheduled execution",
    );
    std::ptr::null_mut()
}

/// Frees an instance.
///
/// # Safety
/// `instance` is null or an instance that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut Instance) {
    // SAFETY: by the promise of the caller
    unsafe { edge::taken(instance) }
}

/// Begins the initialization. The tolerance of the importer is not used: the text states that of the steps.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut Instance,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    _stop_defined: bool,
    _stop: f64,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, |slave| slave.initialize(start)) }
}

/// Ends the initialization.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut Instance) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, |slave| slave.begin()) }
}

/// Ends the simulation.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: *mut Instance) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, |slave| slave.terminate()) }
}

/// Makes an instance as new.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: *mut Instance) -> c_int {
    let work = |slave: &mut super::slave::Slave| {
        slave.reset();
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, work) }
}

/// Refuses another number of values than of references: no variable is an array.
unsafe fn counted(
    instance: *mut Instance,
    (references, values): (usize, usize),
    work: impl FnOnce() -> c_int,
) -> c_int {
    if references == values {
        return work();
    }
    let refused = Refused(format!(
        "{values} values for {references} value references: each variable is one number"
    ));
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, |_| Err(refused)) }
}

/// Reads variables.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses; the pointers have the stated numbers
/// of values behind them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *mut f64,
    room: usize,
) -> c_int {
    // SAFETY: by the promise of the caller
    let work = || unsafe { instance::get(instance, references, count, values) };
    // SAFETY: by the promise of the caller
    unsafe { counted(instance, (count, room), work) }
}

/// Sets variables.
///
/// # Safety
/// As [`fmi3GetFloat64`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *const f64,
    given: usize,
) -> c_int {
    // SAFETY: by the promise of the caller
    let work = || unsafe { instance::set(instance, references, count, values) };
    // SAFETY: by the promise of the caller
    unsafe { counted(instance, (count, given), work) }
}

/// One communication step.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses; the other pointers are null or point to
/// room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: *mut Instance,
    from: f64,
    length: f64,
    _no_set_before: bool,
    event_needed: *mut bool,
    terminate: *mut bool,
    early: *mut bool,
    last: *mut f64,
) -> c_int {
    let work = |slave: &mut super::slave::Slave| {
        let done = slave.step(from, length);
        let ended = done.is_ok() && slave.stopped().is_some();
        for (flag, value) in [(event_needed, false), (terminate, ended), (early, false)] {
            // SAFETY: by the promise of the caller
            if let Some(flag) = unsafe { flag.as_mut() } {
                *flag = value;
            }
        }
        // SAFETY: by the promise of the caller
        if let Some(last) = unsafe { last.as_mut() } {
            *last = slave.time();
        }
        done
    };
    // SAFETY: by the promise of the caller
    unsafe { instance::step(instance, work) }
}

/// Gives the present state to the importer.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses; `state` is null, or points to a null
/// pointer or a state that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(
    instance: *mut Instance,
    state: *mut *mut c_void,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::save(instance, state) }
}

/// Continues from a state.
///
/// # Safety
/// As [`fmi3GetFMUState`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: *mut Instance, state: *mut c_void) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::restore(instance, state) }
}

/// Frees a state.
///
/// # Safety
/// As [`fmi3GetFMUState`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    instance: *mut Instance,
    state: *mut *mut c_void,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::free(instance, state) }
}

/// Writes the number of bytes of a state.
///
/// # Safety
/// As [`fmi3GetFMUState`]; `size` is null or points to room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: *mut Instance,
    state: *mut c_void,
    size: *mut usize,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::size(instance, state, size) }
}

/// Writes the bytes of a state.
///
/// # Safety
/// As [`fmi3GetFMUState`]; `bytes` points to room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: *mut Instance,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::serialize(instance, state, bytes, size) }
}

/// Gives the state of bytes to the importer.
///
/// # Safety
/// As [`fmi3GetFMUState`]; `bytes` points to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: *mut Instance,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::deserialize(instance, bytes, size, state) }
}

refuse! {
    "all variables of the FMU are 64-bit floating-point numbers":
    fmi3GetFloat32(*const u32, usize, *mut f32, usize);
    fmi3GetInt8(*const u32, usize, *mut i8, usize);
    fmi3GetUInt8(*const u32, usize, *mut u8, usize);
    fmi3GetInt16(*const u32, usize, *mut i16, usize);
    fmi3GetUInt16(*const u32, usize, *mut u16, usize);
    fmi3GetInt32(*const u32, usize, *mut i32, usize);
    fmi3GetUInt32(*const u32, usize, *mut u32, usize);
    fmi3GetInt64(*const u32, usize, *mut i64, usize);
    fmi3GetUInt64(*const u32, usize, *mut u64, usize);
    fmi3GetBoolean(*const u32, usize, *mut bool, usize);
    fmi3GetString(*const u32, usize, *mut *const c_char, usize);
    fmi3GetBinary(*const u32, usize, *mut usize, *mut *const u8, usize);
    fmi3GetClock(*const u32, usize, *mut bool);
    fmi3SetFloat32(*const u32, usize, *const f32, usize);
    fmi3SetInt8(*const u32, usize, *const i8, usize);
    fmi3SetUInt8(*const u32, usize, *const u8, usize);
    fmi3SetInt16(*const u32, usize, *const i16, usize);
    fmi3SetUInt16(*const u32, usize, *const u16, usize);
    fmi3SetInt32(*const u32, usize, *const i32, usize);
    fmi3SetUInt32(*const u32, usize, *const u32, usize);
    fmi3SetInt64(*const u32, usize, *const i64, usize);
    fmi3SetUInt64(*const u32, usize, *const u64, usize);
    fmi3SetBoolean(*const u32, usize, *const bool, usize);
    fmi3SetString(*const u32, usize, *const *const c_char, usize);
    fmi3SetBinary(*const u32, usize, *const usize, *const *const u8, usize);
    fmi3SetClock(*const u32, usize, *const bool);
    "the FMU has no event mode":
    fmi3EnterEventMode();
    fmi3EvaluateDiscreteStates();
    fmi3UpdateDiscreteStates(*mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64);
    fmi3EnterStepMode();
    "the FMU has no clocks":
    fmi3GetIntervalDecimal(*const u32, usize, *mut f64, *mut c_int);
    fmi3GetIntervalFraction(*const u32, usize, *mut u64, *mut u64, *mut c_int);
    fmi3GetShiftDecimal(*const u32, usize, *mut f64);
    fmi3GetShiftFraction(*const u32, usize, *mut u64, *mut u64);
    fmi3SetIntervalDecimal(*const u32, usize, *const f64);
    fmi3SetIntervalFraction(*const u32, usize, *const u64, *const u64);
    fmi3SetShiftDecimal(*const u32, usize, *const f64);
    fmi3SetShiftFraction(*const u32, usize, *const u64, *const u64);
    fmi3ActivateModelPartition(u32, f64);
    "the FMU is for co-simulation":
    fmi3EnterContinuousTimeMode();
    fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool);
    fmi3SetTime(f64);
    fmi3SetContinuousStates(*const f64, usize);
    fmi3GetContinuousStateDerivatives(*mut f64, usize);
    fmi3GetEventIndicators(*mut f64, usize);
    fmi3GetContinuousStates(*mut f64, usize);
    fmi3GetNominalsOfContinuousStates(*mut f64, usize);
    fmi3GetNumberOfEventIndicators(*mut usize);
    fmi3GetNumberOfContinuousStates(*mut usize);
    "the FMU gives no derivatives":
    fmi3GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3GetAdjointDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3GetOutputDerivatives(*const u32, usize, *const i32, *mut f64, usize);
    "an output may depend on every input and parameter":
    fmi3GetNumberOfVariableDependencies(u32, *mut usize);
    fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut c_int, usize);
    "the FMU has no structural parameter":
    fmi3EnterConfigurationMode();
    fmi3ExitConfigurationMode();
}
