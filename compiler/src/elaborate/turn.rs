//! `largest(x)`, `smallest(x)`, `where_largest(x)`: numbers of a turn of the machine without forces.
//!
//! x is a further output of the present element, or of an element of its own in the text of a model or component. Its
//! number in the turn is an input of the bind graph. So a lint of such numbers is a check on parameters that is made
//! after the turn.

use super::binding::span_of;
use super::scalar::{ElementBuilder, FOLLOWED, PROVISIONAL, Scalar, Stage, TIME};
use super::value::{ScopeId, Value};
use super::{BindProgram, Check, Elaborator, Eval, MessagePart, Reported, element, location};
use crate::codes;
use crate::ir::Node;
use crate::ir::differentiate::uses_fields;
use eng_grammar::ast::Argument;
use eng_grammar::{Diagnostic, Span};
use eng_system::lint::{Extreme, Followed};
use eng_system::system::{Origin, OutputInfo, Role, System};

/// A quantity that a lint follows, before its element is finished.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FollowedDraft {
    pub extreme: Extreme,
    /// The element and its output, when they are known.
    pub place: Option<(u32, u32)>,
    /// The call.
    pub span: Span,
}

impl<'a> Elaborator<'a, '_> {
    /// A number of the turn.
    pub(super) fn of_turn(
        &mut self,
        name: &str,
        span: Span,
        arguments: &'a [Argument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let mut named = Extreme::NAMED.iter();
        let extreme = named.find(|(known, _)| *known == name);
        let (_, extreme) = *self.checked(extreme, span, "no extreme of this name")?;
        let argument = self.checked(arguments.first(), span, "no quantity is given")?;
        let x = &argument.value;
        let within = self.graphs.element.is_some();
        let before = self.context.in_output;
        if !within {
            self.graphs.element = Some(ElementBuilder::default());
            self.context.in_output = true;
        }
        let found = self
            .evaluate(x, scope)
            .and_then(|value| self.as_scalar(value, x.span));
        self.context.in_output = before;
        let found = match found {
            Ok(found) => found,
            Err(reported) => {
                if !within {
                    self.graphs.element = None;
                }
                return Err(reported);
            }
        };
        let number = match found.stage {
            Stage::Bind if extreme == Extreme::WhereLargest => {
                return Err(self.report(
                    Diagnostic::error(
                        codes::OF_TURN,
                        "`where_largest` needs a quantity that changes",
                    )
                    .at(x.span, "this depends on parameters alone")
                    .with_help("`largest(x)` gives the value; a constant has no angle of its largest value"),
                ));
            }
            Stage::Bind => found,
            Stage::Motion => {
                self.refuse_fields_of_turn(found.node, x.span)?;
                let same = match within {
                    false => self.same_quantity(found.node, scope),
                    true => None,
                };
                if let Some(Ok(place)) = same {
                    self.graphs.element = None;
                    return Ok(Value::Scalar(self.followed_at(extreme, place, span)));
                }
                let number = self.followed(extreme, found.node, span)?;
                if let Some(Err(key)) = same {
                    let element = self.draft.elements.len() as u32;
                    self.draft.turned.insert(key, (element, 0));
                }
                number
            }
        };
        if !within {
            self.element_of_turn(scope, span)?;
        }
        Ok(Value::Scalar(number))
    }

    /// The element and output of the same quantity, if a lint of the model follows it already, or else the key of this
    /// quantity. `None` for a quantity whose functions have conditions, because their messages name the call.
    fn same_quantity(&self, node: Node, scope: ScopeId) -> Option<Result<(u32, u32), String>> {
        let element = self.graphs.element.as_ref()?;
        if !element.call_conditions.is_empty() {
            return None;
        }
        let key = format!(
            "{} {node:?}{:?}{:?}{:?}{:?}{:?}",
            self.scope(scope).path,
            element.graph.nodes(),
            element.markers,
            element.constants,
            element.rotations,
            element.signals,
        );
        Some(self.draft.turned.get(&key).copied().ok_or(key))
    }

    /// The input of the bind graph that has a number of a quantity which another lint follows.
    fn followed_at(&mut self, extreme: Extreme, place: (u32, u32), span: Span) -> Scalar {
        let same = |draft: &FollowedDraft| draft.place == Some(place) && draft.extreme == extreme;
        let index = match self.draft.followed.iter().position(same) {
            Some(known) => known,
            None => {
                self.draft.followed.push(FollowedDraft {
                    extreme,
                    place: Some(place),
                    span,
                });
                self.draft.followed.len() - 1
            }
        };
        Scalar {
            stage: Stage::Bind,
            node: self.graphs.bind.graph.input(FOLLOWED + index as u32),
        }
    }

    /// Refuses results of fields: the pins of a machine without forces are in the middle of their shells.
    fn refuse_fields_of_turn(&mut self, node: Node, span: Span) -> Eval<()> {
        let Some(element) = self.graphs.element.as_ref() else {
            return Ok(());
        };
        let of_field = |channel: &u32| {
            let source = self.draft.channels.get(*channel as usize);
            let source = source.and_then(|c| self.draft.elements.get(c.element as usize));
            source.is_some_and(|element| !element.fields.is_empty())
        };
        if !uses_fields(&element.graph, &[node], &PROVISIONAL, false)
            && !element.signals.iter().any(of_field)
        {
            return Ok(());
        }
        Err(self.report(
            Diagnostic::error(
                codes::OF_TURN,
                "the turn of a machine without forces has no films",
            )
            .at(span, "depends on the results of a field")
            .with_help(
                "the result of a field exists only during a run: check it by `require`, or by `advise` without `largest` or `smallest`",
            ),
        ))
    }

    /// The input of the bind graph that has the number of a quantity of the present element.
    fn followed(&mut self, extreme: Extreme, node: Node, span: Span) -> Eval<Scalar> {
        let index = self.draft.followed.len() as u32;
        let Some(element) = self.graphs.element.as_mut() else {
            return self.checked(None, span, "a quantity outside of an element");
        };
        let known = element.followed.iter().find(|(same, known)| {
            let draft = self.draft.followed.get(*known as usize);
            *same == node && draft.is_some_and(|draft| draft.extreme == extreme)
        });
        let index = match known {
            Some((_, known)) => *known,
            None => {
                element.followed.push((node, index));
                self.draft.followed.push(FollowedDraft {
                    extreme,
                    place: None,
                    span,
                });
                index
            }
        };
        Ok(Scalar {
            stage: Stage::Bind,
            node: self.graphs.bind.graph.input(FOLLOWED + index),
        })
    }

    /// Finishes the element of a quantity in the text of a model or component. It has no channel.
    fn element_of_turn(&mut self, scope: ScopeId, span: Span) -> Eval<()> {
        let mut draft = element::Draft::default();
        self.call_conditions(&mut draft);
        let origin = Origin {
            path: self.scope(scope).path.clone(),
            used_at: Some(location(span)),
            defined_at: None,
        };
        let name = "turn".to_owned();
        self.finish_element(origin, span, Role::Output, name, None, draft)?;
        Ok(())
    }

    /// The followed quantities of the present element, as outputs after its own.
    pub(super) fn followed_outputs(
        &mut self,
        followed: &[(Node, u32)],
        (element, first): (u32, u32),
    ) -> Vec<OutputInfo> {
        let mut infos = Vec::with_capacity(followed.len());
        for (place, (_, index)) in (first..).zip(followed) {
            if let Some(draft) = self.draft.followed.get_mut(*index as usize) {
                draft.place = Some((element, place));
            }
            let dimension = eng_system::Dimension::ONE;
            infos.push(OutputInfo {
                name: String::new(),
                dimension,
                display: eng_system::DisplayUnit::si(dimension),
                frame: String::new(),
                depth: eng_system::system::Depth::Acceleration,
            });
        }
        infos
    }

    /// Moves the lints of the turn into a list of their own, and refuses numbers of the turn that decide anything but lints.
    pub(super) fn lints_of_turn(
        &mut self,
        system: &mut System,
        program: &mut BindProgram,
    ) -> Eval<()> {
        let drafts = std::mem::take(&mut self.draft.followed);
        if drafts.is_empty() {
            return Ok(());
        }
        let after = program.depends(|k| (FOLLOWED..TIME).contains(&k));
        let is_after = |node: Node| after.get(node.0 as usize) == Some(&true);
        let decides = program.function.outputs.iter().chain(&program.defaults);
        let decided_too_early = |check: &&Check| !check.advise && check_reads(check, &is_after);
        let early = program.checks.iter().find(decided_too_early);
        let node = decides.copied().find(|node| is_after(*node));
        if let Some(node) = node.or(early.map(|check| check.holds)) {
            let of = |index: u32| program.depends(|k| k == FOLLOWED + index);
            let mut indices = 0..drafts.len() as u32;
            let first = indices.find(|index| of(*index).get(node.0 as usize) == Some(&true));
            let draft = first.and_then(|index| drafts.get(index as usize));
            let message = Diagnostic::error(
                codes::OF_TURN,
                "only lints may use numbers of a turn without forces",
            );
            let message = match (draft, early.and_then(|check| check.defined_at)) {
                (Some(draft), Some(at)) => message
                    .at(draft.span, "a number of the turn")
                    .also(span_of(at), "a requirement, which every run checks"),
                (Some(draft), None) => message.at(draft.span, "not in an `advise`"),
                (None, Some(at)) => {
                    message.at(span_of(at), "a requirement, which every run checks")
                }
                (None, None) => message,
            };
            return Err(self.report(message.with_help(
                "`eng check` turns the machine without forces, and has the number after this turn; write `advise` in place of `require`, and compute loads and outputs from the motion",
            )));
        }
        for draft in &drafts {
            // after an error, elements are missing
            if draft.place.is_none() && self.diagnostics.has_errors() {
                return Err(Reported);
            }
            let (element, output) = self.checked(draft.place, draft.span, "no output")?;
            system.followed.push(Followed {
                element,
                output,
                extreme: draft.extreme,
            });
        }
        let checks = std::mem::take(&mut program.checks);
        (program.turned, program.checks) = checks
            .into_iter()
            .partition(|check| check_reads(check, &is_after));
        Ok(())
    }
}

/// Whether the condition or the message of a check reads a node.
fn check_reads(check: &Check, read: &impl Fn(Node) -> bool) -> bool {
    let shown = |part: &MessagePart| match part {
        MessagePart::Text(_) => false,
        MessagePart::Value(node, _) => read(*node),
    };
    read(check.holds) || check.message.iter().any(shown)
}
