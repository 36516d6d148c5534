//! The derivatives of a run's channels by a parameter, and the names of their columns and of their file.

use super::file::has_ending;
use super::{CYCLE_ANGLE, CYCLE_SPEED, Results, TIME, file_stem};
use eng_system::DisplayUnit;
use std::path::{Path, PathBuf};

/// The end of the names of files with gradients.
const ENDING: &str = ".gradients.parquet";
/// The columns of the samples themselves, and the names of their derivatives. No channel has such a name.
const OF_SAMPLES: [(&str, &str); 3] = [
    (TIME, "time.gradient"),
    (CYCLE_ANGLE, "cycle.angle.gradient"),
    (CYCLE_SPEED, "cycle.speed.gradient"),
];

/// The name of the column with the derivatives of a column. It is the name of the column itself, except for
/// time and cycle, whose columns hold their values.
pub(crate) fn derivative_of(path: &str) -> &str {
    let own = OF_SAMPLES.iter().find(|(of, _)| *of == path);
    own.map_or(path, |(_, name)| name)
}

/// The column of results whose derivatives a column has; `None` for time and cycle.
pub(crate) fn derived_from(path: &str) -> Option<&str> {
    if OF_SAMPLES.iter().any(|(of, _)| *of == path) {
        return None;
    }
    let own = OF_SAMPLES.iter().find(|(_, name)| *name == path);
    Some(own.map_or(path, |(of, _)| of))
}

/// The derivatives of the channels of a run by a parameter, over its samples.
#[derive(Clone, Debug)]
pub struct Gradient {
    /// Path of the parameter.
    pub parameter: String,
    /// Its display unit.
    pub unit: DisplayUnit,
    /// Time, cycle, their derivatives as `time.gradient`, `cycle.angle.gradient` and `cycle.speed.gradient`, and the
    /// derivative of each channel under the channel's name.
    pub results: Results,
}

/// The file with the gradients of an analysis in a folder.
pub(crate) fn gradients_file(folder: &Path, analysis: &str) -> PathBuf {
    folder.join(format!("{}{ENDING}", file_stem(analysis)))
}

/// Whether a file has the name of one with gradients.
pub(super) fn is_gradients(path: &Path) -> bool {
    has_ending(path, ENDING)
}
