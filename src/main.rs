//! The `eng` command.

use eng::cli::{CheckOutcome, Engine, EngineError, Progress, RunOutcome, Setting};
use std::path::Path;
use std::process::ExitCode;

/// Takes the place of the compiler until it is joined.
struct Unjoined;

impl Engine for Unjoined {
    fn check(&mut self, model: &Path) -> Result<CheckOutcome, EngineError> {
        let refused = |e: std::io::Error| EngineError::System(format!("{}: {e}", model.display()));
        std::fs::read_to_string(model).map_err(refused)?;
        Err(EngineError::System("this build has no compiler".to_owned()))
    }

    fn run(
        &mut self,
        _analysis: &str,
        _settings: &[Setting],
        _progress: &mut dyn FnMut(Progress),
    ) -> Result<RunOutcome, EngineError> {
        Err(EngineError::System("this build has no compiler".to_owned()))
    }
}

fn main() -> ExitCode {
    eng::cli::run(std::env::args_os(), &mut Unjoined)
}
