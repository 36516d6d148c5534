//! The `eng` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    eng::cli::run(std::env::args_os())
}
