//! Kinematic analyses as rows of a table, one row for each sample.
//!
//! | column | meaning |
//! | --- | --- |
//! | `time`, `cycle.angle`, `cycle.speed` | the moment |
//! | `cycle.torque` | the torque on the cycle that the motion needs, positive in the sense of its angle |
//! | a channel's path | its value; of a film the force alone, which is the reaction of its pin |

use crate::codes;
use crate::places::{place, span};
use crate::results::{Column, Results, ResultsError};
use eng_grammar::{Diagnostic, Diagnostics};
use eng_runtime::{Determined, Shared};
use eng_system::recorded::{channels_of_motion, of_motion};
use eng_system::sentence;
use eng_system::system::{Location, Origin, System};

/// The largest number of names in a line. A choice.
const NAMED: usize = 6;

/// Columns without values: those of the analysis whose channels have a value.
pub(crate) fn push_columns(
    results: &mut Results,
    system: &System,
    determined: &Determined,
) -> Result<(), ResultsError> {
    let columns = of_motion(system);
    let channels = channels_of_motion(system);
    let first = columns.len() - channels.len();
    for (index, recorded) in columns.into_iter().enumerate() {
        let channel = index.checked_sub(first).map(|place| channels[place]);
        if channel.is_some_and(|channel| !determined.channels.contains(&channel)) {
            continue;
        }
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

/// Adds the lines about the assumptions of an analysis, and the warning of shared reactions.
pub(crate) fn tell(
    determined: &Determined,
    (system, analysis): (&System, &Origin),
    lines: &mut Vec<String>,
    diagnostics: &mut Diagnostics,
) {
    lines.extend(facts(determined));
    if let Some(warning) = shared(determined, system, analysis) {
        diagnostics.push(warning);
    }
}

/// Lines about the assumptions of an analysis.
fn facts(determined: &Determined) -> Vec<String> {
    let mut facts = Vec::new();
    facts.push(match determined.turned {
        true => "the cycle turns at the speed that `start` states; `cycle.torque` is the torque that this needs".to_owned(),
        false => "drives determine the motion".to_owned(),
    });
    if !determined.centred.is_empty() {
        facts.push(format!(
            "pins in the middle of their shells, without friction: {}",
            listed(&determined.centred)
        ));
    }
    if !determined.rigid.is_empty() {
        facts.push(format!("as rigid bodies: {}", listed(&determined.rigid)));
    }
    facts
}

/// The warning of shared reactions.
fn shared(determined: &Determined, system: &System, analysis: &Origin) -> Option<Diagnostic> {
    let groups: Vec<String> = determined.shared.iter().map(group).collect();
    if groups.is_empty() {
        return None;
    }
    let message = Diagnostic::warning(
        codes::SHARED,
        format!(
            "the balance of forces does not decide how these elements share their load: {}",
            groups.join("; ")
        ),
    );
    let message = place(message, analysis, "by this analysis");
    // instances of one line have one place
    let mut places: Vec<Location> = Vec::new();
    for element in determined.shared.iter().flat_map(|shared| &shared.elements) {
        places.extend(element.used_at.filter(|at| !places.contains(at)));
    }
    let places = places.into_iter().take(2);
    let message = places.fold(message, |message, at| message.also(span(at), "has a share"));
    let paths: Vec<&str> = (determined.left_out.iter())
        .filter_map(|channel| Some(system.channels.get(*channel)?.path.as_str()))
        .collect();
    let message = message.note_if((!paths.is_empty()).then(|| {
        format!(
            "without a value, and so not in the results: {}",
            sentence::joined(&paths, NAMED)
        )
    }));
    Some(message.with_help("replace joints by such with fewer equations; or let `transient` or `periodic` compute these reactions, with films or flexible bodies"))
}

fn group(shared: &Shared) -> String {
    listed(&shared.elements)
}

fn listed(elements: &[Origin]) -> String {
    let paths: Vec<&str> = elements.iter().map(|e| e.path.as_str()).collect();
    sentence::joined(&paths, NAMED)
}
