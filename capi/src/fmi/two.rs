//! The functions of FMI 2.0. Texts, references and values are memory of the importer, by the rules of the standard.
#![expect(unsafe_code, reason = "functions for importers, and their memory")]

use super::instance::{self, ERROR, Instance, Log, OK, refuse};
use super::three::category;
use crate::edge::{self, Refused};
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::PathBuf;

/// Takes a message as a format of `printf` with its arguments.
type Logger = Option<
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...),
>;

/// The functions of the importer.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Callbacks {
    logger: Logger,
    /// The instance has memory of its own.
    allocate: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    free: Option<unsafe extern "C" fn(*mut c_void)>,
    finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    environment: *mut c_void,
}

/// The kind of `fmi2Instantiate` for co-simulation.
const CO_SIMULATION: c_int = 1;
/// The kind of `fmi2GetRealStatus` for the time that was reached.
const LAST_TIME: c_int = 2;
/// The kind of `fmi2GetBooleanStatus` for a simulation that wants to end.
const TERMINATED: c_int = 3;

fn log(callbacks: Option<Callbacks>, name: CString) -> Log {
    Box::new(move |status, text| {
        if let Some(Callbacks {
            logger: Some(logger),
            environment,
            ..
        }) = callbacks
        {
            // the text is a format, whose percent signs stand for themselves only in pairs
            let text = edge::c_text(&text.replace('%', "%%"));
            // SAFETY: the standard lets an instance call it with the environment that the importer gave
            unsafe {
                logger(
                    environment,
                    name.as_ptr(),
                    status,
                    category(status).as_ptr(),
                    text.as_ptr(),
                )
            };
        }
    })
}

/// The path of a location such as `file:///tmp/resources`.
fn path(location: &str) -> Result<PathBuf, Refused> {
    let Some(rest) = location.strip_prefix("file:") else {
        return Ok(PathBuf::from(location));
    };
    let rest = match rest.strip_prefix("//") {
        Some(rest) => rest.strip_prefix("localhost").unwrap_or(rest),
        None => rest,
    };
    let mut bytes = Vec::with_capacity(rest.len());
    let mut letters = rest.bytes();
    while let Some(letter) = letters.next() {
        if letter != b'%' {
            bytes.push(letter);
            continue;
        }
        let digits = [letters.next(), letters.next()]
            .map(|digit| char::from(digit.unwrap_or(b' ')).to_digit(16));
        match digits {
            [Some(high), Some(low)] => bytes.push((16 * high + low) as u8),
            _ => {
                return Err(Refused(format!(
                    "the location {location} of the resources is damaged"
                )));
            }
        }
    }
    let text = String::from_utf8(bytes).map_err(|_| {
        Refused(format!(
            "the location {location} of the resources is not in UTF-8"
        ))
    })?;
    // `/C:/folder` on Windows
    let drive = text.as_bytes().get(2) == Some(&b':');
    Ok(PathBuf::from(if drive {
        text.trim_start_matches('/')
    } else {
        &text
    }))
}

/// The platform of the types.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Switches the messages about warnings on or off.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    instance: *mut Instance,
    logging: c_int,
    _: usize,
    _: *const *const c_char,
) -> c_int {
    // SAFETY: by the promise of the caller
    match unsafe { edge::changed(instance, "instance") } {
        Ok(instance) => {
            instance.logging = logging != 0;
            OK
        }
        Err(_) => ERROR,
    }
}

/// A new instance.
///
/// # Safety
/// The texts are null or end with a zero byte; `callbacks` is null or points to the functions of the standard.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    token: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    logging: c_int,
) -> *mut Instance {
    // SAFETY: by the promise of the caller
    let callbacks = unsafe { callbacks.as_ref() }.copied();
    // SAFETY: by the promise of the caller
    let named = unsafe { edge::text(name, "name") }.map(edge::c_text);
    let resources = || {
        if kind != CO_SIMULATION {
            return Err(Refused::new(
                "the FMU is for co-simulation, not for model exchange",
            ));
        }
        // SAFETY: by the promise of the caller
        path(unsafe { edge::text(resources, "location of the resources")? })
    };
    // SAFETY: by the promise of the caller
    let token = || Ok(unsafe { edge::text(token, "GUID")? }.to_owned());
    Instance::made(
        resources,
        token,
        log(callbacks, named.unwrap_or_default()),
        logging != 0,
    )
}

/// Frees an instance.
///
/// # Safety
/// `instance` is null or an instance that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(instance: *mut Instance) {
    // SAFETY: by the promise of the caller
    unsafe { edge::taken(instance) }
}

/// States the start. The tolerance of the importer is not used: the text states that of the steps.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    instance: *mut Instance,
    _tolerance_defined: c_int,
    _tolerance: f64,
    start: f64,
    _stop_defined: c_int,
    _stop: f64,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, |slave| slave.begins_at(start)) }
}

/// Begins the initialization.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(instance: *mut Instance) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, |slave| slave.initialize(0.0)) }
}

/// Ends the initialization.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(instance: *mut Instance) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, |slave| slave.begin()) }
}

/// Ends the simulation.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(instance: *mut Instance) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, |slave| slave.terminate()) }
}

/// Makes an instance as new.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(instance: *mut Instance) -> c_int {
    let work = |slave: &mut super::slave::Slave| {
        slave.reset();
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, work) }
}

/// Reads variables.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses; the pointers have `count` values behind
/// them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *mut f64,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::get(instance, references, count, values) }
}

/// Sets variables.
///
/// # Safety
/// As [`fmi2GetReal`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *const f64,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::set(instance, references, count, values) }
}

/// Sets the rates that inputs have in the next step.
///
/// # Safety
/// As [`fmi2GetReal`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    rates: *const f64,
) -> c_int {
    let work = |slave: &mut super::slave::Slave| {
        // SAFETY: by the promise of the caller
        let references = unsafe { edge::numbers(references, count, "value references")? };
        // SAFETY: by the promise of the caller
        let orders = unsafe { edge::numbers(orders, count, "orders")? };
        // SAFETY: by the promise of the caller
        let rates = unsafe { edge::numbers(rates, count, "rates")? };
        for ((reference, order), rate) in references.iter().zip(orders).zip(rates) {
            slave.set_rate(*reference, *order, *rate)?;
        }
        Ok(())
    };
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, work) }
}

/// One communication step.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    instance: *mut Instance,
    from: f64,
    length: f64,
    _no_set_before: c_int,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::step(instance, |slave| slave.step(from, length)) }
}

/// Writes the time that the last step has reached.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses; `value` is null or points to room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    instance: *mut Instance,
    kind: c_int,
    value: *mut f64,
) -> c_int {
    let work = |slave: &mut super::slave::Slave| match kind {
        // SAFETY: by the promise of the caller
        LAST_TIME => unsafe { edge::written(value, slave.time(), "status") },
        _ => Err(Refused::new(
            "fmi2GetRealStatus has the time of the last step alone",
        )),
    };
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, work) }
}

/// Writes whether the simulation wants to end: the condition of its analysis has ended it.
///
/// # Safety
/// As [`fmi2GetRealStatus`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    instance: *mut Instance,
    kind: c_int,
    value: *mut c_int,
) -> c_int {
    let work = |slave: &mut super::slave::Slave| match kind {
        TERMINATED => {
            let ended = c_int::from(slave.stopped().is_some());
            // SAFETY: by the promise of the caller
            unsafe { edge::written(value, ended, "status") }
        }
        _ => Err(Refused::new(
            "fmi2GetBooleanStatus tells alone whether the simulation wants to end",
        )),
    };
    // SAFETY: by the promise of the caller
    unsafe { instance::call(instance, work) }
}

/// Gives the present state to the importer.
///
/// # Safety
/// `instance` is null, or an instance that is not freed and that no other call uses; `state` is null, or points to a null
/// pointer or a state that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(
    instance: *mut Instance,
    state: *mut *mut c_void,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::save(instance, state) }
}

/// Continues from a state.
///
/// # Safety
/// As [`fmi2GetFMUstate`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(instance: *mut Instance, state: *mut c_void) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::restore(instance, state) }
}

/// Frees a state.
///
/// # Safety
/// As [`fmi2GetFMUstate`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(
    instance: *mut Instance,
    state: *mut *mut c_void,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::free(instance, state) }
}

/// Writes the number of bytes of a state.
///
/// # Safety
/// As [`fmi2GetFMUstate`]; `size` is null or points to room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
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
/// As [`fmi2GetFMUstate`]; `bytes` points to room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    instance: *mut Instance,
    state: *mut c_void,
    bytes: *mut c_char,
    size: usize,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::serialize(instance, state, bytes.cast(), size) }
}

/// Gives the state of bytes to the importer.
///
/// # Safety
/// As [`fmi2GetFMUstate`]; `bytes` points to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    instance: *mut Instance,
    bytes: *const c_char,
    size: usize,
    state: *mut *mut c_void,
) -> c_int {
    // SAFETY: by the promise of the caller
    unsafe { instance::deserialize(instance, bytes.cast(), size, state) }
}

refuse! {
    "all variables of the FMU are real numbers":
    fmi2GetInteger(*const u32, usize, *mut c_int);
    fmi2GetBoolean(*const u32, usize, *mut c_int);
    fmi2GetString(*const u32, usize, *mut *const c_char);
    fmi2SetInteger(*const u32, usize, *const c_int);
    fmi2SetBoolean(*const u32, usize, *const c_int);
    fmi2SetString(*const u32, usize, *const *const c_char);
    "the FMU is for co-simulation":
    fmi2EnterEventMode();
    fmi2NewDiscreteStates(*mut c_void);
    fmi2EnterContinuousTimeMode();
    fmi2CompletedIntegratorStep(c_int, *mut c_int, *mut c_int);
    fmi2SetTime(f64);
    fmi2SetContinuousStates(*const f64, usize);
    fmi2GetDerivatives(*mut f64, usize);
    fmi2GetEventIndicators(*mut f64, usize);
    fmi2GetContinuousStates(*mut f64, usize);
    fmi2GetNominalsOfContinuousStates(*mut f64, usize);
    "the FMU gives no derivatives":
    fmi2GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, *mut f64);
    fmi2GetRealOutputDerivatives(*const u32, usize, *const c_int, *mut f64);
    "a step ends before its call returns":
    fmi2CancelStep();
    fmi2GetStatus(c_int, *mut c_int);
    fmi2GetIntegerStatus(c_int, *mut c_int);
    fmi2GetStringStatus(c_int, *mut *const c_char);
}

#[cfg(test)]
mod tests {
    use super::path;
    use std::path::Path;

    #[test]
    fn locations_are_paths() {
        for (location, wanted) in [
            ("file:///tmp/a/resources", "/tmp/a/resources"),
            ("file://localhost/tmp/a", "/tmp/a"),
            ("file:/tmp/a", "/tmp/a"),
            ("file:///tmp/mit%20Leer%C3%BC", "/tmp/mit Leerü"),
            ("file:///C:/fmu/resources", "C:/fmu/resources"),
            ("/tmp/100%", "/tmp/100%"),
        ] {
            assert_eq!(path(location).expect(location), Path::new(wanted));
        }
        assert!(path("file:///tmp/%4").is_err());
        assert!(path("file:///tmp/%ff").is_err());
    }
}
