//! Frequency responses as rows of a table, one row for each frequency.
//!
//! | column | meaning |
//! | --- | --- |
//! | `frequency` | Hz |
//! | an output's path | its amplitude per unit of the input |
//! | `….phase` | its phase against the input; positive: the output is ahead |

use crate::counted::counted;
use crate::modes::{coefficients, linearised_at};
use crate::results::{Column, FREQUENCIES, ROWS, Results, ResultsError};
use eng_runtime::linearised::{FrequencyResponse, Mode};
use eng_system::analysis::Response;
use eng_system::recorded::of_response;
use eng_system::sentence::joined;
use eng_system::significant::short;
use eng_system::system::System;

/// The largest number of frequencies that a line names. A choice.
const NAMED: usize = 6;

/// Columns without values, in the order of [`row`].
pub(crate) fn push_columns(
    results: &mut Results,
    system: &System,
    response: &Response,
) -> Result<(), ResultsError> {
    results.set_metadata(ROWS, FREQUENCIES);
    // the compiler refuses names without an input or an output
    for recorded in of_response(system, response).unwrap_or_default() {
        results.push(Column {
            path: recorded.path,
            dimension: recorded.dimension,
            display: recorded.display,
            frame: recorded.frame,
            values: Vec::new(),
        })?;
    }
    Ok(())
}

/// The values (SI) at a frequency (Hz), in the order of [`push_columns`].
pub(crate) fn rows(found: &FrequencyResponse) -> impl Iterator<Item = Vec<f64>> {
    let all = found.frequencies.iter().zip(&found.outputs);
    all.map(|(frequency, outputs)| {
        let mut row = vec![*frequency];
        for output in outputs {
            row.push(output.norm());
            row.push(libm::atan2(output.im, output.re));
        }
        row
    })
}

/// Keys and values of the metadata: the input, the moment and the coefficients of the linearisation.
pub(crate) fn metadata(
    found: &FrequencyResponse,
    response: &Response,
) -> Vec<(&'static str, String)> {
    let input = response.about.inputs.first();
    vec![
        ("to", input.map_or_else(String::new, |i| i.path.clone())),
        ("linearised", linearised_at(&found.modes)),
        ("coefficients", coefficients(&found.modes).to_owned()),
    ]
}

/// Lines about the response: the modes about the state, and resonances without damping.
pub(crate) fn facts(found: &FrequencyResponse) -> Vec<String> {
    let mut facts = crate::modes::facts(&found.modes);
    // a motion that grows with constant coefficients has no response at all
    if found.modes.modes.iter().any(Mode::grows) {
        facts.push("the response is that of the held coefficients: near the frequency of a growing mode it is no steady vibration".to_owned());
    }
    let named: Vec<String> = found.undamped.iter().map(|f| short(*f, 6)).collect();
    let named: Vec<&str> = named.iter().map(String::as_str).collect();
    if !named.is_empty() {
        facts.push(format!(
            "{} without damping at {} Hz: the response has no bound there, and its largest amplitude is that of the nearest point",
            counted(named.len(), "mode", "modes"),
            joined(&named, NAMED)
        ));
    }
    facts
}
