//! Lints: probable mistakes, the objects that they concern, and their acceptance by the text.

mod assembled;
mod axes;
mod cycle;
mod idle;
mod measured;
mod numbers;
mod rods;
mod turned;
mod weights;

pub(crate) use turned::turned as of_turn;

use crate::codes;
use crate::places::{MOST_PLACES, decided, related, span, with_part};
use eng_grammar::Diagnostic;
use eng_runtime::model::Model;
use eng_runtime::state::State;
use eng_runtime::{FAILS, Warning};
use eng_system::code::{Advice, Bound, Compiled};
use eng_system::lint::{Accepted, OF_MODEL};
use eng_system::sentence;
use eng_system::significant::short;
use eng_system::system::{AnalysisKind, ConditionKind, Location, Origin, Part, Role, System};

/// A lint's finding about one object.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Finding {
    /// The message's code.
    pub code: &'static str,
    /// Its name for `accept`; empty without a name.
    pub name: String,
    /// The object and its places.
    pub origin: Origin,
    /// The message, with values.
    pub message: String,
    /// The label at its place, after the path of the object; empty if the path needs no more words.
    pub label: String,
    /// The remedy.
    pub help: String,
    /// The parameters and tables that decide it.
    pub decided_by: Vec<Origin>,
    /// The part of a component of the library, if the object is inside of one.
    pub part: Option<Part>,
}

impl Finding {
    /// The finding of a failed `advise` on parameters.
    pub fn of_parameters(advice: &Advice) -> Finding {
        Finding {
            code: codes::PARAMETER_ADVISED,
            name: advice.name.clone(),
            origin: advice.origin.clone(),
            message: advice.message.clone(),
            label: FAILS.to_owned(),
            decided_by: advice.decided_by.clone(),
            ..Finding::default()
        }
    }

    /// The finding of an `advise` that failed during a run. For markers that are apart it has their places.
    pub fn of_run(warning: &Warning, system: &System) -> Finding {
        let mut finding = Finding {
            code: codes::ADVISED,
            name: warning.name.clone(),
            origin: warning.origin.clone(),
            message: format!("{} at {}", warning.message, warning.moment),
            label: warning.label.to_owned(),
            ..Finding::default()
        };
        let mut elements = system.elements.iter();
        let element = elements.find(|element| element.origin.path == warning.origin.path);
        if let Some(element) = element.filter(|_| warning.name == eng_system::lint::APART) {
            let markers = element.markers.iter();
            let markers = markers.filter_map(|m| system.markers.get(*m as usize));
            decide(&mut finding, markers.map(|m| m.origin.clone()).collect());
        }
        finding
    }

    /// Whether two findings are equal except for numbers, and concern objects at one place or of one law.
    pub fn like(&self, other: &Finding) -> bool {
        self.code == other.code
            && self.name == other.name
            && self.origin.defined_at == other.origin.defined_at
            && (self.origin.defined_at.is_some() || self.origin.used_at == other.origin.used_at)
            && without_numbers(&self.message) == without_numbers(&other.message)
    }
}

/// Adds the first places that decide a finding, each once, as many as a message shows.
fn decide(finding: &mut Finding, places: Vec<Origin>) {
    for place in places {
        let known = |p: &Origin| p.used_at == place.used_at;
        let new = place.used_at.is_some() && !finding.decided_by.iter().any(known);
        if new && finding.decided_by.len() < MOST_PLACES {
            finding.decided_by.push(place);
        }
    }
}

/// A text without its digits. Messages of one kind then have equal texts.
pub(crate) fn without_numbers(text: &str) -> String {
    text.chars()
        .filter(|c| !matches!(c, '0'..='9' | '.' | '-' | 'e'))
        .collect()
}

/// The findings on the numbers of a bound model.
pub(crate) fn of_numbers(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    bound: &Bound,
) -> Vec<Finding> {
    let advice = bound.advice.iter().map(Finding::of_parameters);
    let mut found: Vec<Finding> = advice.collect();
    // if a number is the name of a constant, the place of the constant decides it
    for finding in &mut found {
        let constants = finding.decided_by.iter().filter_map(|origin| {
            let at = compiled.system.stated.get(&origin.path)?;
            Some(Origin {
                used_at: Some(*at),
                ..origin.clone()
            })
        });
        let constants: Vec<Origin> = constants.collect();
        if finding.decided_by.len() + constants.len() <= MOST_PLACES {
            decide(finding, constants);
        }
    }
    found.extend(numbers::numbers(compiled, overrides, bound));
    found
}

/// The findings on the assembled model of an analysis.
pub(crate) fn of_start(
    model: &Model,
    state: &State,
    kind: &AnalysisKind,
    analysis: &Origin,
) -> Vec<Finding> {
    let start = assembled::Start { model, state };
    let mut found = assembled::assembled(&start);
    found.extend(cycle::step(&start, kind, analysis));
    found.extend(cycle::sampling(&start, kind, analysis));
    found
}

/// Findings to report, and findings that the text accepts, with the index of the acceptance.
pub(crate) struct Sifted {
    pub reported: Vec<Finding>,
    pub accepted: Vec<Covered>,
}

/// An acceptance, by its index in the system, and a finding that it covers.
pub(crate) type Covered = (usize, Finding);

/// Separates accepted findings from others.
pub(crate) fn sift(findings: Vec<Finding>, system: &System) -> Sifted {
    let mut sifted = Sifted {
        reported: Vec::new(),
        accepted: Vec::new(),
    };
    for mut finding in findings {
        finding.part = system.part_of(&finding.origin).cloned();
        let covering = |a: &Accepted| a.covers(&finding.name, &finding.origin.path);
        match system.accepted.iter().position(covering) {
            Some(index) => sifted.accepted.push((index, finding)),
            None => sifted.reported.push(finding),
        }
    }
    sifted
}

/// One message for each kind of finding, however many objects it concerns.
pub(crate) fn diagnostics(findings: &[Finding]) -> Vec<Diagnostic> {
    let mut groups: Vec<Vec<&Finding>> = Vec::new();
    for finding in findings {
        match groups.iter_mut().find(|group| group[0].like(finding)) {
            Some(group) if group.contains(&finding) => {}
            Some(group) => group.push(finding),
            None => groups.push(vec![finding]),
        }
    }
    groups.iter().map(|group| diagnostic(group)).collect()
}

fn diagnostic(group: &[&Finding]) -> Diagnostic {
    let first = group[0];
    let paths: Vec<&str> = group.iter().map(|f| f.origin.path.as_str()).collect();
    let alike = group.iter().all(|f| f.message == first.message);
    let about = if alike {
        listed(&paths)
    } else {
        first.origin.path.clone()
    };
    let title = match about.as_str() {
        "" => first.message.clone(),
        about => format!("{about}: {}", first.message),
    };
    let mut message = Diagnostic::warning(first.code, title);
    let mut places: Vec<Location> = Vec::new();
    for finding in group {
        let Some(at) = finding.origin.used_at.filter(|at| !places.contains(at)) else {
            continue;
        };
        places.push(at);
        let label = match (finding.origin.path.as_str(), finding.label.as_str()) {
            ("", label) => label.to_owned(),
            (path, "") => path.to_owned(),
            (path, label) => format!("{path}: {label}"),
        };
        message = if places.len() == 1 {
            message.at(span(at), label)
        } else {
            message.also(span(at), label)
        };
    }
    let law = match first.code == codes::ADVISED && first.label != FAILS {
        true => "this function",
        false => "this should hold",
    };
    message = match (places.is_empty(), first.origin.defined_at) {
        (true, Some(at)) => message.at(span(at), law),
        _ => related(message, &first.origin, law),
    };
    message = with_part(message, first.part.as_ref());
    message = decided(message, &first.decided_by);
    if !alike {
        message = likewise(message, group);
    }
    if !first.help.is_empty() {
        message = message.with_help(first.help.as_str());
    }
    if OF_MODEL.contains(&first.name.as_str()) || first.origin.path == "cycle" {
        message.acceptable_in_model(&first.name)
    } else {
        message.acceptable(&first.name)
    }
}

/// Names the other objects of a group. An indexed condition fails several times for one object: there only the
/// messages differ.
fn likewise(mut message: Diagnostic, group: &[&Finding]) -> Diagnostic {
    let first = group[0];
    let mut paths: Vec<&str> = Vec::new();
    let mut texts: Vec<&str> = Vec::new();
    for finding in &group[1..] {
        let path = finding.origin.path.as_str();
        if path == first.origin.path {
            texts.push(&finding.message);
        } else if !paths.contains(&path) {
            paths.push(path);
        }
    }
    for text in texts.iter().take(MOST_PLACES) {
        message = message.with_note(format!("likewise: {text}"));
    }
    if texts.len() > MOST_PLACES {
        let more = texts.len() - MOST_PLACES;
        message = message.with_note(format!("likewise {more} more"));
    }
    if !paths.is_empty() {
        message = message.with_note(format!("likewise {}", listed(&paths)));
    }
    message
}

/// An angle (rad) with its unit: degrees, unless the number of degrees is too large for a float.
fn degrees(angle: f64, digits: usize) -> String {
    match angle.to_degrees() {
        degrees if degrees.is_finite() => format!("{} deg", short(degrees, digits)),
        _ => format!("{} rad", short(angle, digits)),
    }
}

/// Paths as a list in a sentence.
fn listed(paths: &[&str]) -> String {
    sentence::listed(paths, 3)
}

/// A line for each acceptance in a model, with its findings.
pub(crate) fn accepted(system: &System, covered: &[Covered]) -> Vec<String> {
    let mut places: Vec<(Location, Vec<usize>)> = Vec::new();
    for (index, accepted) in system.accepted.iter().enumerate() {
        match places.iter_mut().find(|(at, _)| *at == accepted.at) {
            Some((_, indices)) => indices.push(index),
            None => places.push((accepted.at, vec![index])),
        }
    }
    places
        .iter()
        .filter_map(|(_, indices)| {
            let first = system.accepted.get(*indices.first()?)?;
            let found: Vec<&Finding> = covered
                .iter()
                .filter(|(index, _)| indices.contains(index))
                .map(|(_, finding)| finding)
                .collect();
            let of = |paths: Vec<&str>| match listed(&paths).as_str() {
                "" => system.name.clone(),
                text => text.to_owned(),
            };
            match found.first() {
                Some(finding) => {
                    let paths = found.iter().map(|f| f.origin.path.as_str()).collect();
                    Some(format!(
                        "{} of {}: {}",
                        first.name,
                        of(paths),
                        finding.message
                    ))
                }
                // an acceptance without a finding is one of the motion, which only a run can decide
                None => {
                    let paths = indices.iter().filter_map(|i| system.accepted.get(*i));
                    let paths = paths.map(|a| a.path.as_str()).collect();
                    depends_on_a_run(system, first)
                        .then(|| format!("{} of {}", first.name, of(paths)))
                }
            }
        })
        .collect()
}

/// The acceptances of a model, and whether a finding needs them. An acceptance of a lint of the motion counts
/// as needed, because only a run can decide.
pub(crate) fn needed<'s>(system: &'s System, covered: &[Covered]) -> Vec<(&'s Accepted, bool)> {
    let needs = |(index, accepted): (usize, &'s Accepted)| {
        let needed = accepted.used
            || covered.iter().any(|(known, _)| *known == index)
            || depends_on_a_run(system, accepted);
        (accepted, needed)
    };
    system.accepted.iter().enumerate().map(needs).collect()
}

/// The warning about an acceptance that no finding needs.
pub(crate) fn needless(accepted: &Accepted) -> Diagnostic {
    Diagnostic::warning(
        codes::ACCEPT_UNUSED,
        format!("no warning `{}` appears here", accepted.name),
    )
    .at(span(accepted.at), "accepts nothing")
    .with_help("remove it, so that a later mistake of this kind is reported")
}

/// Whether a covered element has an `advise` of this name on its motion.
fn depends_on_a_run(system: &System, accepted: &Accepted) -> bool {
    system.elements.iter().any(|element| {
        element.role == Role::Dynamic
            && accepted.covers(&accepted.name, &element.origin.path)
            && system
                .classes
                .get(element.class as usize)
                .is_some_and(|class| {
                    class.conditions.iter().any(|condition| {
                        condition.kind == ConditionKind::Advise && condition.name == accepted.name
                    })
                })
    })
}
