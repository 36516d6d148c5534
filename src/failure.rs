//! Failures of the runtime as messages with their places in the text.

use eng_grammar::{Diagnostic, SourceId, Span};
use eng_runtime::RuntimeError;
use eng_system::code::BindError;
use eng_system::system::{Location, Origin};

/// The message of a failure: the user's line first, the law's second.
pub(crate) fn diagnostic(error: &RuntimeError) -> Diagnostic {
    use RuntimeError as R;
    let d = |code: &'static str| Diagnostic::error(code, error.to_string());
    match error {
        R::Bind(bind) => bind_diagnostic(bind),
        R::Body { origin, .. } => place(d("E0702"), origin, "this body"),
        R::OpenLoop { rows } => {
            let mut message = d("E0703");
            for (i, row) in rows.iter().take(3).enumerate() {
                message = if i == 0 {
                    place(message, &row.origin, "stays open here")
                } else {
                    related(message, &row.origin, "and here")
                };
            }
            message
                .with_help("check lengths and marker places; state `start` or `guess` values that are near the assembled position")
        }
        R::Branch { origin, .. } => place(d("E0704"), origin, "assembled the other way round")
            .with_help("state a `guess` nearer to the wanted position, or another `branch` at the use"),
        R::StartVelocity { rows } => {
            let mut message = d("E0705");
            for row in rows.iter().take(3) {
                message = place(message, &row.origin, "cannot hold together with the others");
            }
            message.with_help("a driven part and its start velocity must agree; leave one of them out")
        }
        R::Redundant { groups } => redundant(groups),
        R::NotFinite { origin, .. } => place(d("E0708"), origin, "this element"),
        R::Newton { origin, .. } => place(d("E0709"), origin, "the largest residual is here"),
        R::StepTooSmall { origin, .. } => place(d("E0710"), origin, "the largest error is here"),
        R::Require { origin, .. } => place(d("E0711"), origin, "this must hold at every step"),
        R::Projection { row, .. } => place(d("E0712"), &row.origin, "stays open here"),
        R::NoCycle => d("E0713").with_help(
            "state one: `cycle angle = rotation(crank.flange, ground) { period = 720 deg }`, or give times",
        ),
        R::CycleStands { .. } => d("E0714").with_help("give the duration as a time, or start the crank turning"),
        R::Singular { .. } => d("E0707"),
        R::Options { .. } => d("E0701"),
        _ => d("E0700"),
    }
}

/// One label and one note a joint, however many of its equations repeat others.
fn redundant(groups: &[eng_runtime::RedundantGroup]) -> Diagnostic {
    let mut message = Diagnostic::error(
        "E0706",
        match groups.len() {
            1 => "a constraint equation repeats others".to_owned(),
            n => format!("{n} constraint equations repeat others"),
        },
    );
    let mut joints: Vec<&Origin> = Vec::new();
    for group in groups {
        if !joints.contains(&&group.redundant.origin) {
            joints.push(&group.redundant.origin);
        }
    }
    joints.sort_by(|a, b| a.path.cmp(&b.path));
    let mut places = Vec::new();
    for joint in joints {
        let own = groups.iter().filter(|g| g.redundant.origin == *joint);
        let (mut equations, mut others) = (Vec::new(), Vec::new());
        for group in own {
            equations.push(group.redundant.equation.clone());
            for repeated in &group.repeats {
                if !others.contains(&repeated.origin.path) {
                    others.push(repeated.origin.path.clone());
                }
            }
        }
        message = message.with_note(format!(
            "{}: {} already {} from {}",
            joint.path,
            equations.join(", "),
            if equations.len() == 1 {
                "follows"
            } else {
                "follow"
            },
            others.join(", "),
        ));
        if !places.contains(&joint.used_at) {
            places.push(joint.used_at);
            message = place(message, joint, "repeats what other joints hold");
        }
    }
    message.with_help(
        "reactions of repeated equations are not unique: keep one of the joints, and let the others hold less (PointOnLine, PointOnPlane) or replace them by journals",
    )
}

fn bind_diagnostic(error: &BindError) -> Diagnostic {
    let message = Diagnostic::error("E0720", error.to_string());
    match error {
        BindError::Require {
            used_at,
            defined_at,
            path,
            ..
        } => {
            let origin = Origin {
                path: path.clone(),
                used_at: *used_at,
                defined_at: *defined_at,
            };
            place(message, &origin, "here")
        }
        _ => message,
    }
}

fn place(message: Diagnostic, origin: &Origin, label: &str) -> Diagnostic {
    let message = match origin.used_at {
        Some(at) => message.at(span(at), format!("{}: {label}", origin.path)),
        None => message,
    };
    related(message, origin, "defined here")
}

fn related(message: Diagnostic, origin: &Origin, label: &str) -> Diagnostic {
    match origin.defined_at {
        Some(at) => message.also(span(at), label),
        None => message,
    }
}

fn span(at: Location) -> Span {
    Span {
        source: SourceId(at.source),
        start: at.start,
        end: at.end,
    }
}

/// An `advise` that did not hold.
pub(crate) fn advice(warning: &eng_runtime::Warning) -> Diagnostic {
    let message = Diagnostic::warning(
        "W0711",
        format!(
            "{}: {} at {}",
            warning.origin.path, warning.message, warning.moment
        ),
    );
    place(message, &warning.origin, "said by this element")
}
