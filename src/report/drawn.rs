//! Figures on their way into a section.

use crate::figures::Wanted;
use crate::post::Run;
use eng_report::page::Section;

/// Draws figures into a section, each with its caption. A figure that the results do not give is named with the
/// reason; figures with one reason share a sentence.
pub(super) fn drawn(
    mut section: Section,
    wanted: &[(Wanted, String)],
    runs: &[Run<'_>],
) -> Section {
    let mut refused: Vec<(String, Vec<&str>)> = Vec::new();
    for (wanted, caption) in wanted {
        match wanted.draw(runs) {
            Ok(figure) => section = section.figure(figure, caption.as_str()),
            Err(error) => {
                let reason = error.to_string();
                match refused.iter_mut().find(|(known, _)| *known == reason) {
                    Some((_, titles)) => titles.push(&wanted.title),
                    None => refused.push((reason, vec![&wanted.title])),
                }
            }
        }
    }
    for (reason, titles) in refused {
        section = section.warning(format!("Not drawn: {}. {reason}.", titles.join("; ")));
    }
    section
}
