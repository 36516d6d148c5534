//! Finds the modules of a program, gives every module its scope, and makes the tables of dimensions and
//! units.
//!
//! This stage uses names of modules, items, dimensions and units. It must not use types of values.

mod definitions;
mod modules;
pub use modules::{RETURN_ALONE, lone_return};
mod scopes;
pub(crate) use scopes::defined_name;
pub(crate) mod suggest;
mod trees;
mod units;

use crate::program::Program;
pub(crate) use crate::program::{JOURNAL_LAW, WELD};
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::host::Host;
pub use trees::Trees;

/// The module that every file uses.
pub const PRELUDE: &str = "std.prelude";
/// Reads the root file and every module that it uses. `root` is a file's name for `host`. `library` maps the
/// paths of modules (`std.joints`) to their texts. Modules come before their users, and the root is the last.
pub fn resolve(
    root: &str,
    host: &dyn Host,
    library: &[(&str, &str)],
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
) -> Program {
    resolve_with(root, host, library, None, sources, diagnostics)
}

/// [`resolve`] for a program that is read again and again: `trees` keeps those of the library.
pub fn resolve_with(
    root: &str,
    host: &dyn Host,
    library: &[(&str, &str)],
    trees: Option<&mut Trees>,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
) -> Program {
    let mut program = Program {
        offered: modules::offered(library),
        ..Program::default()
    };
    modules::load(
        root,
        host,
        library,
        trees,
        (sources, diagnostics, &mut program),
    );
    scopes::fill(&mut program, diagnostics);
    units::dimensions(&mut program, diagnostics);
    units::units(&mut program, diagnostics);
    program
}
