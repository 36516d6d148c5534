//! The functions that the page calls, and the two that it offers.
//!
//! The page and this module share one memory. The page allocates room for a request ([`playground_allocate`]), writes
//! it, and releases it after the call. An answer belongs to the page, which reads its text and numbers where they are
//! and releases it ([`playground_release_answer`]).
#![expect(unsafe_code, reason = "memory of the page")]

use crate::check::check;
use crate::request::{Request, refusal};
use crate::run::{Ran, run};
use std::panic::PanicHookInfo;

/// An answer: text, and the numbers of a run.
#[derive(Debug)]
pub enum Answer {
    /// Of a check or a page.
    Text(String),
    /// Of a run.
    Ran(Box<Ran>),
}

impl Answer {
    fn text(&self) -> &str {
        match self {
            Answer::Text(text) => text,
            Answer::Ran(ran) => &ran.text,
        }
    }

    fn numbers(&self) -> &[f64] {
        match self {
            Answer::Text(_) => &[],
            Answer::Ran(ran) => &ran.numbers,
        }
    }

    fn given(self) -> *mut Answer {
        Box::into_raw(Box::new(self))
    }
}

/// The functions of the page.
#[cfg(target_family = "wasm")]
mod page {
    #[link(wasm_import_module = "page")]
    unsafe extern "C" {
        /// Whether a run goes on: its finished part, and its steps.
        pub safe fn goes_on(fraction: f64, steps: f64) -> i32;
        /// Takes the text of a panic, which ends the module.
        pub fn panicked(text: *const u8, length: usize);
    }
}

/// For tests without a page: no run is stopped, and panics are those of the test.
#[cfg(not(target_family = "wasm"))]
mod page {
    pub fn goes_on(_: f64, _: f64) -> i32 {
        1
    }

    pub unsafe fn panicked(_: *const u8, _: usize) {}
}

fn tell_panic(info: &PanicHookInfo<'_>) {
    let text = info.to_string();
    // SAFETY: pointer and length are those of a text that outlives the call
    unsafe { page::panicked(text.as_ptr(), text.len()) };
}

/// Gives the texts of panics to the page. The page calls it once.
#[unsafe(no_mangle)]
pub extern "C" fn playground_begin() {
    std::panic::set_hook(Box::new(tell_panic));
}

/// Room for `length` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn playground_allocate(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Releases room.
///
/// # Safety
/// `room` is from [`playground_allocate`] with this `length`, and not released.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_release(room: *mut u8, length: usize) {
    let room = std::ptr::slice_from_raw_parts_mut(room, length);
    // SAFETY: by the promise of the caller it is from `Box::into_raw` of a slice of this length
    drop(unsafe { Box::from_raw(room) });
}

/// The request in a room.
///
/// # Safety
/// See [`playground_check`].
unsafe fn request(room: *const u8, length: usize) -> Result<Request, String> {
    // SAFETY: by the promise of the caller
    Request::read(unsafe { std::slice::from_raw_parts(room, length) })
}

/// Checks the text of a request: [`crate::check`].
///
/// # Safety
/// `room` is from [`playground_allocate`] with this `length`, and does not change during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_check(room: *const u8, length: usize) -> *mut Answer {
    // SAFETY: by the promise of the caller
    let request = unsafe { request(room, length) };
    Answer::Text(request.map_or_else(|refused| refused, |request| check(&request))).given()
}

/// Runs the analyses of the text of a request: [`crate::run`].
///
/// # Safety
/// That of [`playground_check`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_run(room: *const u8, length: usize) -> *mut Answer {
    // SAFETY: by the promise of the caller
    match unsafe { request(room, length) } {
        Ok(request) => {
            let ran = run(&request, &mut |progress| {
                page::goes_on(progress.fraction, progress.steps as f64) != 0
            });
            Answer::Ran(Box::new(ran)).given()
        }
        Err(refused) => Answer::Text(refused).given(),
    }
}

/// The page of `eng report` about the runs of an answer: HTML, or the JSON of a refusal.
///
/// # Safety
/// `answer` is from [`playground_run`], and not released.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_page(answer: *const Answer) -> *mut Answer {
    // SAFETY: by the promise of the caller
    let page = match unsafe { answer.as_ref() } {
        Some(Answer::Ran(ran)) => ran.page(),
        _ => Err("nothing has run".to_owned()),
    };
    Answer::Text(page.unwrap_or_else(|reason| refusal(&reason))).given()
}

/// The text of an answer, in UTF-8.
///
/// # Safety
/// `answer` is from a function of this module, and not released. The text is valid until it is released.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_text(answer: *const Answer) -> *const u8 {
    // SAFETY: by the promise of the caller
    let answer = unsafe { answer.as_ref() };
    answer.map_or(std::ptr::null(), |answer| answer.text().as_ptr())
}

/// The number of bytes of this text.
///
/// # Safety
/// That of [`playground_text`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_text_length(answer: *const Answer) -> usize {
    // SAFETY: by the promise of the caller
    let answer = unsafe { answer.as_ref() };
    answer.map_or(0, |answer| answer.text().len())
}

/// The numbers of an answer.
///
/// # Safety
/// That of [`playground_text`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_numbers(answer: *const Answer) -> *const f64 {
    // SAFETY: by the promise of the caller
    let answer = unsafe { answer.as_ref() };
    answer.map_or(std::ptr::null(), |answer| answer.numbers().as_ptr())
}

/// How many numbers these are.
///
/// # Safety
/// That of [`playground_text`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_numbers_length(answer: *const Answer) -> usize {
    // SAFETY: by the promise of the caller
    let answer = unsafe { answer.as_ref() };
    answer.map_or(0, |answer| answer.numbers().len())
}

/// Releases an answer with its text and its numbers. A null pointer is nothing.
///
/// # Safety
/// `answer` is null or from a function of this module, and not released.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn playground_release_answer(answer: *mut Answer) {
    if !answer.is_null() {
        // SAFETY: by the promise of the caller it is from `Box::into_raw`
        drop(unsafe { Box::from_raw(answer) });
    }
}
