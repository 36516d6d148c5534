//! The edge to foreign code: its memory, and panics, which must not leave a function.
#![expect(unsafe_code, reason = "memory of the caller")]

use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A refused call, in words for the user.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub struct Refused(pub String);

impl Refused {
    /// The refusal of a call.
    pub fn new(text: impl Into<String>) -> Refused {
        Refused(text.into())
    }
}

impl From<eng::Error> for Refused {
    fn from(error: eng::Error) -> Refused {
        Refused(error.to_string())
    }
}

/// Calls a function. A panic becomes an error.
pub fn caught<R>(work: impl FnOnce() -> Result<R, Refused>) -> Result<R, Refused> {
    // the objects that a panic leaves behind own their memory; a call on them finds their invariants checked again
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = (panic.downcast_ref::<String>().map(String::as_str))
            .or_else(|| panic.downcast_ref::<&str>().copied())
            .unwrap_or("a panic without a text");
        Err(Refused(format!("internal error, please report it: {text}")))
    })
}

/// A text for C; a zero byte would end it, so it is left out.
pub fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

/// Gives a new object to the caller.
pub fn given<T>(object: T) -> *mut T {
    Box::into_raw(Box::new(object))
}

/// Takes an object of [`given`] back and drops it. A null pointer is nothing.
///
/// # Safety
/// `object` is null, or from [`given`] and not yet taken back.
pub unsafe fn taken<T>(object: *mut T) {
    if !object.is_null() {
        // SAFETY: the caller promises that it is from `Box::into_raw` and is not used again
        drop(unsafe { Box::from_raw(object) });
    }
}

/// The object behind a handle.
///
/// # Safety
/// `object` is null, or from [`given`], not taken back, and not in use by a call that changes it.
pub unsafe fn shared<'a, T>(object: *const T, what: &str) -> Result<&'a T, Refused> {
    // SAFETY: by the promise of the caller
    unsafe { object.as_ref() }.ok_or_else(|| Refused(format!("the {what} is a null pointer")))
}

/// The object behind a handle, to be changed.
///
/// # Safety
/// `object` is null, or from [`given`], not taken back, and not in use by another call.
pub unsafe fn changed<'a, T>(object: *mut T, what: &str) -> Result<&'a mut T, Refused> {
    // SAFETY: by the promise of the caller
    unsafe { object.as_mut() }.ok_or_else(|| Refused(format!("the {what} is a null pointer")))
}

/// A text of the caller.
///
/// # Safety
/// `text` is null, or ends with a zero byte and does not change during the call.
pub unsafe fn text<'a>(text: *const c_char, what: &str) -> Result<&'a str, Refused> {
    if text.is_null() {
        return Err(Refused(format!("the {what} is a null pointer")));
    }
    // SAFETY: by the promise of the caller
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str()
        .map_err(|_| Refused(format!("the {what} is not in UTF-8")))
}

/// `count` numbers of the caller. No numbers may be a null pointer.
///
/// # Safety
/// `first` points to `count` values that do not change during the call.
pub unsafe fn numbers<'a, T: Copy>(
    first: *const T,
    count: usize,
    what: &str,
) -> Result<&'a [T], Refused> {
    match count {
        0 => Ok(&[]),
        _ if first.is_null() => Err(Refused(format!("the {what} are a null pointer"))),
        // SAFETY: by the promise of the caller
        _ => Ok(unsafe { std::slice::from_raw_parts(first, count) }),
    }
}

/// Room of the caller for `count` numbers. No room may be a null pointer.
///
/// # Safety
/// `first` points to `count` initialised values that nothing else uses during the call.
pub unsafe fn room<'a, T: Copy>(
    first: *mut T,
    count: usize,
    what: &str,
) -> Result<&'a mut [T], Refused> {
    match count {
        0 => Ok(&mut []),
        _ if first.is_null() => Err(Refused(format!("the {what} are a null pointer"))),
        // SAFETY: by the promise of the caller
        _ => Ok(unsafe { std::slice::from_raw_parts_mut(first, count) }),
    }
}

/// Writes a value where the caller wants it.
///
/// # Safety
/// `place` is null, or points to room for a value.
pub unsafe fn written<T>(place: *mut T, value: T, what: &str) -> Result<(), Refused> {
    if place.is_null() {
        return Err(Refused(format!(
            "the place of the {what} is a null pointer"
        )));
    }
    // SAFETY: by the promise of the caller
    unsafe { place.write(value) };
    Ok(())
}
