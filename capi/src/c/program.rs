//! Checked programs.

use super::object;
use crate::edge::{self, Refused};
use std::ffi::{CString, c_char};
use std::path::Path;

/// A checked text.
#[derive(Debug)]
pub struct EngProgram {
    pub(super) inner: eng::Program,
    warnings: CString,
}

fn program(checked: eng::Checked) -> Result<EngProgram, Refused> {
    let report = checked.report();
    let warnings = match report.diagnostics().is_empty() {
        true => CString::default(),
        false => edge::c_text(&report.to_string()),
    };
    let inner = checked.into_program();
    let inner = inner.map_err(|report| Refused(report.to_string()))?;
    Ok(EngProgram { inner, warnings })
}

/// Reads and checks a model's file with all that it uses from its folder.
///
/// # Safety
/// `path` ends with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_load(path: *const c_char) -> *mut EngProgram {
    object(|| {
        // SAFETY: by the promise of the caller
        let path = unsafe { edge::text(path, "path")? };
        let opened = eng::open(Path::new(path));
        program(opened.map_err(|error| Refused(error.to_string()))?)
    })
}

/// Checks a text under a file name.
///
/// # Safety
/// Both end with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_from_text(
    name: *const c_char,
    text: *const c_char,
) -> *mut EngProgram {
    object(|| {
        // SAFETY: by the promise of the caller
        let (name, text) = unsafe { (edge::text(name, "name")?, edge::text(text, "text")?) };
        program(eng::check(&eng::Sources::from_text(name, text), name))
    })
}

/// Warnings and notes of the check as `eng check` prints them; empty if there is none.
///
/// # Safety
/// `program` is null or of [`eng_load`] or [`eng_from_text`]. The text is valid as long as the program.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_warnings(program: *const EngProgram) -> *const c_char {
    super::or(std::ptr::null(), || {
        // SAFETY: by the promise of the caller
        let program = unsafe { edge::shared(program, "program")? };
        Ok(program.warnings.as_ptr())
    })
}

/// Frees a program. Models made of it stay.
///
/// # Safety
/// `program` is null or of [`eng_load`] or [`eng_from_text`], and not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_free_program(program: *mut EngProgram) {
    // SAFETY: by the promise of the caller
    unsafe { edge::taken(program) }
}
