//! The functions of `include/eng.h`.
//!
//! Objects are handles that the caller frees. Numbers are in SI units. A function that fails returns a null pointer or
//! [`FAILED`], and [`eng_last_error`] has the reason.
#![expect(unsafe_code, reason = "functions for C, and memory of the caller")]

mod model;
mod program;
mod simulation;

pub use model::*;
pub use program::*;
pub use simulation::*;

use crate::edge::{self, Refused};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int};

/// The status of a call that did its work.
pub const DONE: c_int = 0;
/// The status of a refused call.
pub const FAILED: c_int = 1;

thread_local! {
    /// The reason of the last refusal in this thread.
    static LAST: RefCell<CString> = RefCell::default();
}

/// The text before the version in the bytes of the library. `eng build` looks for both, so that it packs no other file.
const MARK: &str = "eng-library-version=";

/// The mark and the version.
const MARKED: &CStr = match CStr::from_bytes_with_nul(
    concat!("eng-library-version=", env!("CARGO_PKG_VERSION"), "\0").as_bytes(),
) {
    Ok(marked) => marked,
    // no version has a zero
    Err(_) => c"eng-library-version=",
};

/// The version of the library.
#[unsafe(no_mangle)]
pub extern "C" fn eng_version() -> *const c_char {
    // stays inside: the text begins with the mark
    MARKED.as_ptr().wrapping_add(MARK.len())
}

/// The reason of the last failure in this thread, in UTF-8. It is valid until the next failure in this thread.
#[unsafe(no_mangle)]
pub extern "C" fn eng_last_error() -> *const c_char {
    LAST.with_borrow(|last| last.as_ptr())
}

/// The value of a call, or `failed` with the reason kept.
fn or<R>(failed: R, work: impl FnOnce() -> Result<R, Refused>) -> R {
    edge::caught(work).unwrap_or_else(|refused| {
        LAST.set(edge::c_text(&refused.0));
        failed
    })
}

/// A new object, or a null pointer.
fn object<T>(work: impl FnOnce() -> Result<T, Refused>) -> *mut T {
    or(std::ptr::null_mut(), || work().map(edge::given))
}

/// The status of a call.
fn status(work: impl FnOnce() -> Result<(), Refused>) -> c_int {
    or(FAILED, || work().map(|()| DONE))
}
