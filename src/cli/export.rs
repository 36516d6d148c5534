//! `eng export`.

use super::arguments::{ExportArguments, Target};
use super::outputs::{Output, apart};
use super::terminal::Terminal;
use super::{Stop, USAGE_OR_SYSTEM};
use crate::results::{CsvForm, Results, ResultsError, Selection};
use std::path::PathBuf;

/// Writes a result file in another format, beside it or at the place of `--out`.
pub(super) fn export(arguments: &ExportArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
    match write(arguments) {
        Ok(path) => {
            writeln!(console.output, "wrote {}", path.display())?;
            Ok(())
        }
        Err(error) => {
            writeln!(console.errors, "error: {error}")?;
            Err(Stop::Code(USAGE_OR_SYSTEM))
        }
    }
}

/// The reason why nothing was exported.
#[derive(Debug, thiserror::Error)]
enum Refused {
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The output is an input, or a file that the command may not write.
    #[error("{0}")]
    Output(String),
}

fn write(arguments: &ExportArguments) -> Result<PathBuf, Refused> {
    if let Some(path) = &arguments.out {
        let out = Output::new("--out", path);
        let inputs = std::slice::from_ref(&arguments.file);
        apart(inputs, std::slice::from_ref(&out))
            .and_then(|()| out.is_foreign())
            .map_err(Refused::Output)?;
    }
    let form = CsvForm::new(arguments.separator, arguments.decimal)?;
    let selection = Selection::new(arguments.channels.iter().map(String::as_str));
    let results = selection.apply(&Results::read(&arguments.file)?)?;
    let ending = match arguments.to {
        Target::Csv => "csv",
        Target::Uff58 => "uff",
        Target::Mat => "mat",
    };
    let path = arguments.out.clone().unwrap_or_else(|| {
        arguments
            .file
            .with_file_name(format!("{}.{ending}", results.stem()))
    });
    match arguments.to {
        Target::Csv => results.write_csv_as(&path, form)?,
        Target::Uff58 => results.write_universal(&path)?,
        Target::Mat => results.write_mat(&path)?,
    }
    Ok(path)
}
