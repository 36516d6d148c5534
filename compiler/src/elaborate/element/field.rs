//! Fields of an element: the call of a kernel becomes drives, settings and inputs for its results.

use super::super::scalar::{FieldDraft, Flag, PROVISIONAL, Scalar, Stage};
use super::super::value::{ScopeId, Value};
use super::super::{Elaborator, Entry, Eval};
use crate::codes;
use crate::ir::Node;
use crate::ir::differentiate::uses_fields;
use crate::resolve::suggest::listing;
use crate::typed::types::Type;
use eng_grammar::ast::{self, Expr, ExprKind, ItemKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::field::{Kernel, KernelArgument, Takes};

/// The arguments of a call by their names.
struct Arguments<'a> {
    named: Vec<(&'a str, &'a Expr)>,
}

impl<'a> Arguments<'a> {
    fn get(&self, name: &str) -> Option<&'a Expr> {
        let found = self.named.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| *value)
    }
}

impl<'a> Elaborator<'a, '_> {
    /// The results of a field as a record.
    pub(in super::super) fn field_of_kernel(
        &mut self,
        binding: &'a ast::Binding,
        call: &'a Expr,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let (callee, arguments) = self.called(call)?;
        let name = match &callee.kind {
            ExprKind::Name(name) => name.as_str(),
            _ => "",
        };
        let kernel = self.checked(Kernel::named(name), callee.span, "no kernel")?;
        let arguments = Arguments {
            named: (arguments.iter())
                .filter_map(|a| Some((a.name.as_ref()?.text.as_str(), &a.value)))
                .collect(),
        };
        let mut draft = FieldDraft {
            kernel,
            openings: 0,
            drives: Vec::new(),
            settings: Vec::new(),
            wholes: Vec::new(),
            words: Vec::new(),
            surface: None,
        };
        draft.openings = self.openings_of_field(kernel, &arguments, call.span, scope)?;
        for argument in kernel.arguments {
            let given = arguments.get(argument.name);
            self.argument_of_field(argument, given, (call.span, scope), &mut draft)?;
        }
        let Some(element) = self.graphs.element.as_mut() else {
            return self.checked(None, call.span, "a field outside of an element");
        };
        let layout = element.layout();
        let (answers, readings) = (layout.answers, layout.readings);
        if answers + kernel.answer_count() > PROVISIONAL.answers
            || readings + kernel.reading_count() > PROVISIONAL.readings
        {
            return Err(self.report(
                Diagnostic::error(codes::ELEMENT_TOO_LARGE, "one element has too many fields")
                    .at(binding.name.span, "the limit is reached here")
                    .with_help("divide it into several elements"),
            ));
        }
        element.fields.push(draft);
        self.results_of_field(binding, kernel, [answers, readings])
    }

    /// Refuses readings of fields where derivatives matter: a kernel gives derivatives of its answers alone.
    pub(super) fn refuse_readings(&mut self, numbers: &[Scalar], span: Span) -> Eval<()> {
        let Some(element) = self.graphs.element.as_ref() else {
            return Ok(());
        };
        let nodes: Vec<Node> = (numbers.iter())
            .filter(|number| number.stage == Stage::Motion)
            .map(|number| number.node)
            .collect();
        if !uses_fields(&element.graph, &nodes, &PROVISIONAL, true) {
            return Ok(());
        }
        let answers = element.fields.iter().flat_map(|field| field.kernel.answers);
        let names = listing(answers.map(|row| row.name), 12);
        Err(self.report(
            Diagnostic::error(codes::FIELD, "a load can use only the answers of a field")
                .at(span, "depends on a reading")
                .with_note(format!(
                    "its answers are {names}; the other results have no derivatives"
                ))
                .with_help("show it by an `output`, or use it in a `require`"),
        ))
    }

    /// Refuses a branch that depends on a field: the assembly chooses branches before fields are solved.
    pub(super) fn refuse_branch_by_field(&mut self, flag: Flag, span: Span) -> Eval<()> {
        let Some(element) = self.graphs.element.as_ref() else {
            return Ok(());
        };
        let moves = flag.stage == Stage::Motion;
        if !(moves && uses_fields(&element.graph, &[flag.node], &PROVISIONAL, false)) {
            return Ok(());
        }
        Err(self.report(
            Diagnostic::error(codes::FIELD, "a branch cannot depend on a field")
                .at(span, "a result of a field is here")
                .with_help("choose the branch by positions: the assembly needs it before fields are solved"),
        ))
    }

    /// Number of openings: the length of all lists of a field.
    fn openings_of_field(
        &mut self,
        kernel: &Kernel,
        arguments: &Arguments<'a>,
        span: Span,
        scope: ScopeId,
    ) -> Eval<u32> {
        let mut known: Option<(usize, Span)> = None;
        for argument in kernel.arguments {
            if !matches!(argument.takes, Takes::Drives | Takes::Settings) {
                continue;
            }
            let (count, place) = match arguments.get(argument.name) {
                Some(expr) => {
                    let value = self.evaluate(expr, scope)?;
                    (self.as_components(value, expr.span)?.len(), expr.span)
                }
                None => (0, span),
            };
            match known {
                Some((first, at)) if first != count => {
                    return Err(self.lengths(first, at, count, place));
                }
                _ => known = Some((count, place)),
            }
        }
        Ok(known.map_or(0, |(count, _)| count as u32))
    }

    fn argument_of_field(
        &mut self,
        argument: &'static KernelArgument,
        given: Option<&'a Expr>,
        (call, scope): (Span, ScopeId),
        draft: &mut FieldDraft,
    ) -> Eval<()> {
        let count = match argument.takes {
            Takes::DrivePair => 2,
            Takes::Drives | Takes::Settings => draft.openings as usize,
            _ => 1,
        };
        match argument.takes {
            Takes::Drive | Takes::DrivePair | Takes::Drives => {
                let numbers = self.numbers_of_field(given, count, scope)?;
                self.refuse_readings(&numbers, given.map_or(call, |given| given.span))?;
                for number in numbers {
                    let node = self.graphs.lift(number.stage, number.node);
                    draft.drives.push(node);
                }
            }
            Takes::Setting | Takes::Settings => {
                let numbers = self.numbers_of_field(given, count, scope)?;
                let place = given.map_or(call, |given| given.span);
                let mut nodes = Vec::with_capacity(numbers.len());
                for number in numbers {
                    nodes.push(self.bind_node(number, place)?);
                }
                draft.settings.push((argument.name, nodes));
            }
            Takes::Whole(range) => {
                if let Some(given) = given {
                    let value = self.integer(given, scope)?;
                    let (least, most) = (range.least, range.most);
                    if !(least..=most).contains(&value) {
                        let message = format!("`{}` of a field is {value}", argument.name);
                        let message = Diagnostic::error(codes::FIELD, message)
                            .at(given.span, format!("{value}: it must be {least} to {most}"))
                            .with_help(match value < least {
                                true => range.smaller,
                                false => range.larger,
                            });
                        return Err(self.report(self.with_use(message)));
                    }
                    draft.wholes.push((argument.name, value));
                }
            }
            Takes::Word(words) => {
                let word = match given {
                    Some(given) => {
                        let value = self.evaluate(given, scope)?;
                        let found = self.word_among(&value, words);
                        self.checked(found, given.span, "no word of the kernel")?
                    }
                    None => words.first().copied().unwrap_or(""),
                };
                draft.words.push((argument.name, word));
            }
            Takes::Surface => {
                if let Some(given) = given {
                    let marker = match self.evaluate(given, scope)? {
                        Value::Marker(marker) => Some(marker),
                        _ => None,
                    };
                    let marker = self.checked(marker, given.span, "no marker")?;
                    draft.surface = Some(self.local_marker(marker, Some(given.span))?);
                }
            }
        }
        Ok(())
    }

    /// The numbers of an argument; zeros if it is left out.
    fn numbers_of_field(
        &mut self,
        given: Option<&'a Expr>,
        count: usize,
        scope: ScopeId,
    ) -> Eval<Vec<Scalar>> {
        let Some(given) = given else {
            return Ok((0..count).map(|_| self.graphs.constant(0.0)).collect());
        };
        let value = self.evaluate(given, scope)?;
        let numbers = match value.is_several() {
            true => self.as_components(value, given.span)?,
            false => vec![self.as_scalar(value, given.span)?],
        };
        let fits = (numbers.len() == count).then_some(numbers);
        self.checked(fits, given.span, "another number of numbers")
    }

    /// The word of a choice among those of a kernel.
    fn word_among(
        &self,
        value: &Value<'a>,
        words: &'static [&'static str],
    ) -> Option<&'static str> {
        let Value::Choice(id, at) = value else {
            return None;
        };
        let ItemKind::Choice(choice) = &self.program.item(*id)?.kind else {
            return None;
        };
        let word = choice.words.get(*at as usize)?;
        words.iter().find(|known| **known == word.text).copied()
    }

    /// The record of a field's results, as inputs of the element.
    fn results_of_field(
        &mut self,
        binding: &'a ast::Binding,
        kernel: &'static Kernel,
        [answers, readings]: [u32; 2],
    ) -> Eval<Value<'a>> {
        let place = binding.ty.as_ref().map_or(binding.name.span, |ty| ty.span);
        let record = match self.type_at(place)? {
            Type::Instance(id) | Type::InstanceOf(id) => Some(id),
            _ => None,
        };
        let record = self.checked(record, place, "no record")?;
        let own = self.record_scope(record);
        for row in kernel.answers.iter().chain(kernel.readings) {
            let Some((_, first, answer)) = kernel.result(row.name) else {
                continue;
            };
            let mut values = Vec::with_capacity(row.count as usize);
            for k in first..first + row.count {
                let input = match answer {
                    true => PROVISIONAL.answer(answers + k),
                    false => PROVISIONAL.reading(readings + k),
                };
                let Some(element) = self.graphs.element.as_mut() else {
                    return self.checked(None, place, "a field outside of an element");
                };
                values.push(Value::Scalar(Scalar {
                    stage: Stage::Motion,
                    node: element.graph.input(input),
                }));
            }
            let value = match values.len() {
                1 => values.swap_remove(0),
                _ => Value::List(values),
            };
            self.define(own, row.name, Entry::Value(value));
        }
        Ok(Value::Record(record, own))
    }
}
