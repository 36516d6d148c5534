//! Fields: `field film: FilmAnswer = reynolds(…)`. The rows of `eng_system::field` decide arguments and results.

use super::Checker;
use super::bound::{Called, Parameter};
use super::member::{Member, OwnedMember};
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{Quantity, Type};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Binding, Expr, ExprKind, Kind, Name};
use eng_grammar::{Diagnostic, Span};
use eng_system::field::{KERNELS, Kernel, KernelArgument, KernelResult, Takes};

/// The type of numbers: one number, or a list of so many.
fn numbers(quantity: Quantity, count: Option<u32>) -> Type {
    match count {
        Some(1) => Type::Scalar(quantity),
        length => Type::List {
            element: Box::new(Type::Scalar(quantity)),
            length,
            framed: false,
        },
    }
}

impl<'p> Checker<'p> {
    /// Checks a field, and gives its type: the record that the text declares.
    pub(super) fn field_of_kernel(
        &mut self,
        scope: &Scope<'p>,
        binding: &Binding,
        declared: Option<&Type>,
    ) -> Type {
        let Some(value) = &binding.value else {
            return declared.cloned().unwrap_or(Type::Error);
        };
        let kernel = self.kernel_call(scope, value);
        let Some(record) = declared else {
            let name = &binding.name;
            self.report(
                Diagnostic::error(
                    codes::FIELD,
                    format!("the field `{}` needs a record for its results", name.text),
                )
                .at(name.span, "no type")
                .with_help(format!(
                    "`field {}: FilmAnswer = …`, where each `let` of the record is one of the results",
                    name.text
                )),
            );
            return Type::Error;
        };
        if let (Some(kernel), Some(ty)) = (kernel, &binding.ty) {
            self.results_of_field(kernel, record, ty.span);
        }
        record.clone()
    }

    /// Checks the call of a kernel.
    fn kernel_call(&mut self, scope: &Scope<'p>, value: &Expr) -> Option<&'static Kernel> {
        let names = || KERNELS.iter().map(|kernel| kernel.name);
        let called = match &value.kind {
            ExprKind::Call { callee, arguments } => match &callee.kind {
                ExprKind::Name(name) => Some((name, callee.span, arguments)),
                _ => None,
            },
            _ => None,
        };
        let Some((name, span, arguments)) = called else {
            self.report(
                Diagnostic::error(codes::FIELD, "a field is a call of a kernel")
                    .at(value.span, "no call")
                    .with_help(format!("for instance `{}(…)`", KERNELS[0].name)),
            );
            return None;
        };
        let Some(kernel) = Kernel::named(name) else {
            let message = Diagnostic::error(codes::FIELD, format!("there is no kernel `{name}`"))
                .at(span, "unknown");
            self.report(match nearest(name, names()) {
                Some(near) => message.meant(span, near),
                None => message.with_note(format!("there is {}", listing(names(), 12))),
            });
            return None;
        };
        let called = Called {
            name: kernel.name,
            parameters: (kernel.arguments.iter())
                .map(|argument| Parameter {
                    name: argument.name,
                    required: !argument.optional,
                    by_place: false,
                    by_name: true,
                })
                .collect(),
            more: false,
            example: None,
        };
        let bound = self.bound_to(&called, arguments, value.span)?;
        for argument in kernel.arguments {
            if let Some(given) = bound.option(argument.name) {
                self.kernel_argument(scope, kernel, argument, given);
            }
        }
        Some(kernel)
    }

    fn kernel_argument(
        &mut self,
        scope: &Scope<'p>,
        kernel: &Kernel,
        argument: &KernelArgument,
        given: &Expr,
    ) {
        let due = Due::new(format!("`{}` of `{}`", argument.name, kernel.name));
        let quantity = Quantity {
            soft: true,
            ..Quantity::hard(argument.dimension)
        };
        let expected = match argument.takes {
            Takes::Drive | Takes::Setting => numbers(quantity, Some(1)),
            Takes::DrivePair => numbers(quantity, Some(2)),
            Takes::Drives | Takes::Settings => numbers(quantity, None),
            Takes::Whole(..) => Type::Int,
            Takes::Surface => Type::Marker,
            Takes::Word(words) => {
                self.word_of_kernel(scope, argument, words, given);
                return;
            }
        };
        self.expect(scope, given, &expected, &due);
    }

    /// Checks a value of a choice whose words are among those of an argument.
    fn word_of_kernel(
        &mut self,
        scope: &Scope<'p>,
        argument: &KernelArgument,
        words: &[&str],
        given: &Expr,
    ) {
        let found = self.infer(scope, given);
        let refused = match &found {
            Type::Error => return,
            Type::Choice(id) => {
                let own = self
                    .choice(*id)
                    .into_iter()
                    .flat_map(|choice| &choice.words);
                let unknown = |word: &&Name| !words.contains(&word.text.as_str());
                own.into_iter().find(unknown).cloned()
            }
            other => {
                let other = other.clone();
                self.not_a(
                    given,
                    &other,
                    &format!("`{}`", argument.name),
                    "a word of a choice",
                );
                return;
            }
        };
        if let Some(word) = refused {
            self.report(
                Diagnostic::error(
                    codes::FIELD,
                    format!("`{}` has no word `{}`", argument.name, word.text),
                )
                .at(given.span, "a value of this choice")
                .also(word.span, "the word")
                .with_note(format!(
                    "its words are {}",
                    listing(words.iter().copied(), 12)
                )),
            );
        }
    }

    /// Checks that each `let` of the record is a result of the kernel.
    fn results_of_field(&mut self, kernel: &'static Kernel, record: &Type, place: Span) {
        let id = match record {
            Type::Instance(id) | Type::InstanceOf(id) => Some(*id),
            _ => None,
        };
        let declaration = id.and_then(|id| Some((id, self.declaration(id)?)));
        let Some((id, declaration)) = declaration.filter(|(_, d)| d.kind == Kind::Record) else {
            if !record.is_error() {
                let found = self.describe(record);
                self.report(
                    Diagnostic::error(
                        codes::FIELD,
                        format!("the results of a field are a record, not {found}"),
                    )
                    .at(place, "no record"),
                );
            }
            return;
        };
        for slot in self.slots_of(id) {
            let Some(OwnedMember {
                home,
                member: Member::Binding(binding),
            }) = self.owned_member(id, &slot.name)
            else {
                continue;
            };
            let name = &binding.name;
            let member = Member::Binding(binding);
            let ty = self.member_type(home, &slot.name, member, name.span);
            match kernel.result(&slot.name) {
                Some((row, ..)) => self.result_type(kernel, row, &ty, name, place),
                None => {
                    let known = || {
                        let rows = kernel.answers.iter().chain(kernel.readings);
                        rows.map(|row| row.name)
                    };
                    let message = Diagnostic::error(
                        codes::FIELD,
                        format!("`{}` has no result `{}`", kernel.name, slot.name),
                    )
                    .at(name.span, "a value of the record")
                    .also(
                        place,
                        format!("the results of a field are a `{}`", declaration.name.text),
                    );
                    self.report(match nearest(&slot.name, known()) {
                        Some(near) => message.meant(name.span, near),
                        None => message.with_note(format!("it has {}", listing(known(), 30))),
                    });
                }
            }
        }
    }

    fn result_type(
        &mut self,
        kernel: &Kernel,
        row: &KernelResult,
        found: &Type,
        name: &Name,
        place: Span,
    ) {
        let fits = match (found, row.count) {
            (Type::Error, _) => true,
            (
                Type::List {
                    element, length, ..
                },
                count,
            ) if count > 1 => {
                *length == Some(count)
                    && (element.quantity()).is_some_and(|q| q.dim.base == row.dimension)
            }
            (ty, 1) => ty.quantity().is_some_and(|q| q.dim.base == row.dimension),
            _ => false,
        };
        if !fits {
            let wanted = self.describe(&numbers(Quantity::hard(row.dimension), Some(row.count)));
            let found = self.describe(found);
            self.report(
                Diagnostic::error(
                    codes::FIELD,
                    format!(
                        "`{}` of `{}` is {wanted}, not {found}",
                        row.name, kernel.name
                    ),
                )
                .at(name.span, format!("this is {found}"))
                .also(place, "the results of this field"),
            );
        }
    }
}
