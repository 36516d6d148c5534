//! Axes of signals: components along different axes are not added.

use super::Reporter;
use super::recorded::Channels;
use crate::codes;
use eng_grammar::{Diagnostic, Span};
use eng_system::expression::{Expression, Function, Operator};
use eng_system::system::{BodyRef, Slot, System};
use std::rc::Rc;

/// Groups of parallel frames among the columns of a model.
pub(super) struct Frames(Vec<(String, Group)>);

/// Markers of one body at one orientation have parallel axes, up to the body's deformation.
#[derive(Clone, Debug, PartialEq)]
enum Group {
    Ground,
    Turned(BodyRef, [Slot; 9]),
    /// A marker on the ground that takes the pose of its partner at the start.
    Alone,
}

impl Frames {
    pub fn of(system: &System) -> Frames {
        // every body has a marker `origin`, whose axes are the body's
        let identity = system
            .markers
            .iter()
            .find(|m| m.origin.path.ends_with(".origin"))
            .map(|m| m.orientation);
        let group = |frame: &str| {
            let marker = system.markers.iter().find(|m| m.origin.path == frame)?;
            Some(match marker.body {
                _ if marker.placed_at.is_some() => Group::Alone,
                BodyRef::Ground if Some(marker.orientation) == identity => Group::Ground,
                body => Group::Turned(body, marker.orientation),
            })
        };
        let mut known: Vec<(String, Group)> = vec![("ground".to_owned(), Group::Ground)];
        for channel in &system.channels {
            let frame = &channel.frame;
            if !frame.is_empty() && known.iter().all(|(name, _)| name != frame) {
                known.push((frame.clone(), group(frame).unwrap_or(Group::Alone)));
            }
        }
        Frames(known)
    }

    fn group(&self, frame: &str) -> Option<&Group> {
        self.0.iter().find(|(name, _)| name == frame).map(|k| &k.1)
    }
}

/// The channel of which an expression is a component or a multiple of one; `None` for other expressions.
fn component(expression: &Expression) -> Option<(&str, &str)> {
    match expression {
        Expression::Channel { analysis, path } => Some((analysis, path)),
        Expression::Map(Function::Negate, of)
        | Expression::Last(_, of)
        | Expression::Filter(_, of)
        | Expression::Resample(of, _) => component(of),
        Expression::Binary(Operator::Add | Operator::Subtract, a, b) => {
            component(a).or_else(|| component(b))
        }
        Expression::Binary(Operator::Multiply, a, b) => match (a.as_ref(), b.as_ref()) {
            (Expression::Number(_), of) | (of, Expression::Number(_)) => component(of),
            _ => None,
        },
        Expression::Binary(Operator::Divide, of, by) => {
            matches!(by.as_ref(), Expression::Number(_)).then(|| component(of))?
        }
        Expression::Fold(Operator::Add, members) => members.iter().find_map(component),
        _ => None,
    }
}

impl Reporter<'_, '_> {
    /// Refuses the sum or difference of components along different axes.
    pub(super) fn of_one_frame(
        &mut self,
        span: Span,
        a: &Expression,
        b: &Expression,
    ) -> Option<()> {
        let (Some(a), Some(b)) = (self.frame(a), self.frame(b)) else {
            return Some(());
        };
        let same = if Rc::ptr_eq(&a.1, &b.1) {
            let group = |of: &(String, Rc<Channels>)| of.1.frames.group(&of.0).cloned();
            let (p, q) = (group(&a), group(&b));
            a.0 == b.0 || (p == q && p != Some(Group::Alone))
        } else {
            // frames of two models can only be compared by name
            let ground =
                |of: &(String, Rc<Channels>)| of.1.frames.group(&of.0) == Some(&Group::Ground);
            a.0 == b.0 || (ground(&a) && ground(&b))
        };
        if same {
            return Some(());
        }
        self.diagnose(
            Diagnostic::error(
                codes::OTHER_AXES,
                "components along different axes are added",
            )
            .at(
                span,
                format!("along the axes of {} and of {}", a.0, b.0),
            )
            .with_help("add the vectors in the model, where they are turned: `output total = first.force + second.force in ground`"),
        );
        None
    }

    /// The frame of a component, with the channels of its model.
    fn frame(&mut self, expression: &Expression) -> Option<(String, Rc<Channels>)> {
        let (analysis, path) = component(expression)?;
        let plan = self.models.plan(analysis)?;
        let channels = self.models.channels(plan)?;
        let frame = channels.frame(path)?.to_owned();
        Some((frame, channels))
    }
}
