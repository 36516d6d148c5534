//! Signals, numbers and conditions.

use super::Reporter;
use super::channel::root_name;
use crate::check::declare::collect_names;
use crate::check::mismatch::Due;
use crate::check::scope::BUILT_IN_NAMES;
use crate::check::signal::Shape;
use crate::check::types::{Quantity, SignalRows, Type};
use crate::codes;
use crate::functions;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{BinaryOp, Expr, ExprKind, IndexArgument, UnaryOp};
use eng_grammar::{Diagnostic, Span};
use eng_system::DisplayUnit;
use eng_system::expression::{Expression, Function, Member, Operator, Reduction};
use eng_system::recorded::Recorded;

/// Members of one type.
#[derive(Clone, Debug)]
pub(super) struct Typed {
    pub members: Vec<Member>,
    /// Whether it is a list, even of one member.
    pub list: bool,
    /// The type of each member: a signal, a number or a truth value.
    pub ty: Type,
    /// The display unit of its channels.
    pub display: Option<DisplayUnit>,
    /// The reference, for a level in decibels.
    pub level: Option<String>,
}

impl Typed {
    /// Signals with the dimension and display unit of the channel `like`.
    pub fn signals(members: Vec<Member>, list: bool, like: &Recorded, rows: SignalRows) -> Typed {
        let quantity = Quantity::hard(like.dimension);
        Typed {
            members,
            list,
            ty: Type::Signal { quantity, rows },
            display: Some(like.display.clone()),
            level: None,
        }
    }

    pub fn shape(&self) -> Shape {
        Shape::of(&self.ty)
    }

    /// The quantity of each number.
    pub fn quantity(&self) -> Quantity {
        self.ty.each().unwrap_or_default()
    }

    /// Whether it is a signal of one row.
    fn is_state(&self) -> bool {
        matches!(&self.ty, Type::Signal { rows, .. } if *rows == SignalRows::State)
    }

    /// A signal of one row as its number.
    pub fn settled(self) -> Typed {
        if !self.is_state() {
            return self;
        }
        let ty = self.ty.row();
        self.mapped(ty, |of| Expression::Reduce(Reduction::Mean, Box::new(of)))
    }

    /// Wraps each member; the type remains.
    pub fn kept(self, wrap: impl Fn(Expression) -> Expression) -> Typed {
        let ty = self.ty.clone();
        self.mapped(ty, wrap)
    }

    /// Wraps each member and sets another type.
    pub fn mapped(mut self, ty: Type, wrap: impl Fn(Expression) -> Expression) -> Typed {
        self.ty = ty;
        for member in &mut self.members {
            let inner = std::mem::replace(&mut member.expression, Expression::Number(0.0));
            member.expression = wrap(inner);
        }
        self.level = None;
        self
    }
}

impl<'a> Reporter<'a, '_> {
    /// The type and members of an expression; `None` after a message.
    pub(super) fn expression(&mut self, expr: &'a Expr) -> Option<Typed> {
        if self.is_constant(expr) {
            return self.known(expr);
        }
        match &expr.kind {
            ExprKind::Paren { inner, unit: None } => self.expression(inner),
            ExprKind::Paren {
                inner,
                unit: Some(unit),
            } => {
                self.diagnose(
                    Diagnostic::error(
                        codes::UNIT_TWICE,
                        "a value made of results already has its unit",
                    )
                    .at(unit.span, "a second one")
                    .also(inner.span, "of this")
                    .with_help("to convert the shown value, use `as`"),
                );
                None
            }
            ExprKind::Name(name) if self.names.contains_key(name.as_str()) => {
                self.named(name, expr.span)
            }
            ExprKind::Name(_) | ExprKind::Field { .. } | ExprKind::Index { .. } => self.place(expr),
            ExprKind::Call { callee, arguments } => match &callee.kind {
                ExprKind::Name(name) => self.call(expr.span, name, callee.span, arguments),
                _ => {
                    self.diagnose(
                        Diagnostic::error(codes::NOT_CALLABLE, "this is no function")
                            .at(callee.span, "cannot be called"),
                    );
                    None
                }
            },
            ExprKind::List { items, unit: None } => self.list(expr.span, items),
            ExprKind::Unary { op, operand } => {
                let of = self.expression(operand)?;
                if *op == UnaryOp::Not {
                    self.shaped(operand, &of, Shape::Truth, "the operand of `not`")?;
                }
                let ty = self.checker.signed(*op, operand, of.ty.clone());
                (!ty.is_error()).then(|| {
                    of.mapped(ty, |of| match op {
                        UnaryOp::Negate => Expression::Map(Function::Negate, Box::new(of)),
                        UnaryOp::Not => Expression::Not(Box::new(of)),
                    })
                })
            }
            ExprKind::Binary {
                op,
                op_span,
                left,
                right,
            } => self.binary(*op, *op_span, left, right),
            ExprKind::Error => None,
            _ => {
                self.diagnose(
                    Diagnostic::error(
                        codes::REPORT_SHAPE,
                        "a report computes with signals and numbers, by operators and functions",
                    )
                    .at(expr.span, "neither a signal nor a number of one"),
                );
                None
            }
        }
    }

    /// Whether an expression reads no results, so that the rules outside of reports apply.
    pub(super) fn is_constant(&self, expr: &Expr) -> bool {
        let mut names = Vec::new();
        collect_names(expr, &mut names);
        names.iter().all(|(name, _)| {
            !self.names.contains_key(name.as_str())
                && self.models.named(name).is_empty()
                && !functions::only_of_reports(name)
        })
    }

    /// A constant, or a list of constants.
    fn known(&mut self, expr: &'a Expr) -> Option<Typed> {
        self.all_known(expr)?;
        let ty = self.checker.infer(&self.scope, expr);
        if ty.is_error() {
            return None;
        }
        let (ty, list) = match ty {
            Type::Int | Type::Scalar(_) => (ty, false),
            Type::List { element, .. } if element.quantity().is_some() => (*element, true),
            ty => {
                let found = self.checker.describe(&ty);
                self.diagnose(
                    Diagnostic::error(
                        codes::REPORT_SHAPE,
                        format!("a report computes with signals and numbers, not with {found}"),
                    )
                    .at(expr.span, format!("this is {found}")),
                );
                return None;
            }
        };
        let numbers = self
            .constants
            .numbers(expr, std::mem::take(&mut self.checker.findings))?;
        Some(Typed {
            members: numbers
                .into_iter()
                .map(|value| Member {
                    analysis: String::new(),
                    channel: String::new(),
                    expression: Expression::Number(value),
                })
                .collect(),
            list,
            ty,
            display: None,
            level: None,
        })
    }

    /// Gives a message about a name in an expression that a report cannot read.
    pub(super) fn all_known(&mut self, expr: &Expr) -> Option<()> {
        let mut names = Vec::new();
        collect_names(expr, &mut names);
        let found = names.into_iter().find(|(name, _)| {
            !BUILT_IN_NAMES.contains(&name.as_str())
                && functions::find(name).is_none()
                && self.checker.find(&self.scope, name).is_none()
        });
        let Some((name, span)) = found else {
            return Some(());
        };
        let mut message =
            Diagnostic::error(codes::UNKNOWN_NAME, format!("there is no `{name}` here"))
                .at(span, "not known");
        let analyses = self.models.names();
        let own: Vec<&str> = self.names.keys().copied().collect();
        let module = self.checker.program.modules.get(self.scope.module as usize);
        let top = module.into_iter().flat_map(|m| m.scope.keys());
        let near = nearest(&name, analyses.iter().copied().chain(own))
            .or_else(|| nearest(&name, top.map(String::as_str)));
        message = match near {
            Some(near) => message.meant(span, near),
            None => message.with_note(format!("the analyses are {}", listing(analyses, 12))),
        };
        self.diagnose(message);
        None
    }

    /// A constant number.
    pub(super) fn constant(
        &mut self,
        expr: &'a Expr,
        wanted: &Quantity,
        what: &str,
    ) -> Option<f64> {
        let (quantity, value) = self.constant_of(expr, what)?;
        match quantity.fits(wanted) {
            Ok(()) => Some(value),
            Err(misfit) => {
                self.checker
                    .misfit(expr, misfit, &quantity, wanted, &Due::new(what));
                None
            }
        }
    }

    /// A constant number with its quantity.
    pub(super) fn constant_of(&mut self, expr: &'a Expr, what: &str) -> Option<(Quantity, f64)> {
        if !self.is_constant(expr) {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    format!("{what} is a number that is known before the run"),
                )
                .at(expr.span, "made of results"),
            );
            return None;
        }
        let typed = self.known(expr)?;
        match (typed.list, typed.members.first().map(|m| &m.expression)) {
            (false, Some(Expression::Number(value))) => Some((typed.quantity(), *value)),
            _ => {
                self.diagnose(
                    Diagnostic::error(codes::REPORT_SHAPE, format!("{what} is one number"))
                        .at(expr.span, "this is a list"),
                );
                None
            }
        }
    }

    /// Channels of an analysis, or an element of a list of this report.
    fn place(&mut self, expr: &'a Expr) -> Option<Typed> {
        if let ExprKind::Index { base, indices } = &expr.kind
            && let ExprKind::Name(name) = &base.kind
            && self.names.contains_key(name.as_str())
        {
            return self.element(name, base, indices, expr.span);
        }
        match root_name(expr) {
            Some(root) if !self.models.named(root).is_empty() => self.channels(expr),
            Some(root) if self.names.contains_key(root) => {
                self.diagnose(
                    Diagnostic::error(codes::NO_MEMBER, format!("`{root}` has no members"))
                        .at(expr.span, "it is made of results, not a run itself"),
                );
                None
            }
            _ => {
                // neither an analysis nor a value, so the checker of expressions gives the message
                let ty = self.checker.infer(&self.scope, expr);
                if !ty.is_error() {
                    self.diagnose(
                        Diagnostic::error(codes::REPORT_SHAPE, "this is not of an analysis")
                            .at(expr.span, "no recorded channel"),
                    );
                }
                None
            }
        }
    }

    fn element(
        &mut self,
        name: &'a str,
        base: &'a Expr,
        indices: &'a [IndexArgument],
        span: Span,
    ) -> Option<Typed> {
        let whole = self.named(name, base.span)?;
        if !whole.list {
            self.diagnose(
                Diagnostic::error(codes::INDEX, format!("`{name}` is no list"))
                    .at(span, "indexed here"),
            );
            return None;
        }
        let [IndexArgument::At(at)] = indices else {
            return Some(whole);
        };
        let (numbers, many) = self.index(at)?;
        let mut members = Vec::new();
        for number in numbers {
            let member = usize::try_from(number)
                .ok()
                .and_then(|n| n.checked_sub(1))
                .and_then(|n| whole.members.get(n));
            let Some(member) = member else {
                self.diagnose(
                    Diagnostic::error(
                        codes::INDEX_OUTSIDE,
                        format!("there is no `{name}` with the index {number}"),
                    )
                    .at(span, "outside")
                    .with_note(format!("it has {} elements", whole.members.len())),
                );
                return None;
            };
            members.push(member.clone());
        }
        Some(Typed {
            members,
            list: many,
            ..whole
        })
    }

    fn list(&mut self, span: Span, items: &'a [Expr]) -> Option<Typed> {
        let mut whole: Option<Typed> = None;
        for item in items {
            let next = self.expression(item)?;
            whole = Some(match whole {
                None => Typed { list: true, ..next },
                Some(mut whole) => {
                    self.shaped(item, &next, whole.shape(), "this element of a list")?;
                    let (a, b) = ((&whole.ty, span), (&next.ty, item.span));
                    whole.ty = self.checker.join(a, b, "the elements of a list");
                    if whole.ty.is_error() {
                        return None;
                    }
                    whole.members.extend(next.members);
                    whole
                }
            });
        }
        whole
    }

    /// Gives a message if an expression has another shape than the place needs.
    pub(super) fn shaped(
        &mut self,
        expr: &Expr,
        found: &Typed,
        due: Shape,
        what: &str,
    ) -> Option<()> {
        self.checker.shaped(expr, &found.ty, due, what)
    }

    fn binary(
        &mut self,
        op: BinaryOp,
        op_span: Span,
        left: &'a Expr,
        right: &'a Expr,
    ) -> Option<Typed> {
        let (a, b) = (self.expression(left), self.expression(right));
        let (mut a, mut b) = (a?, b?);
        let compared = !matches!(
            op,
            BinaryOp::Add
                | BinaryOp::Subtract
                | BinaryOp::Multiply
                | BinaryOp::Divide
                | BinaryOp::Power
        );
        let signals = [&a, &b].map(|side| side.shape() == Shape::Signal);
        if compared || (a.is_state() != b.is_state() && signals == [true; 2]) {
            (a, b) = (a.settled(), b.settled());
        }
        let ty = if matches!(op, BinaryOp::And | BinaryOp::Or) {
            self.shaped(left, &a, Shape::Truth, "a side of `and` and `or`")?;
            self.shaped(right, &b, Shape::Truth, "a side of `and` and `or`")?;
            Type::Bool
        } else {
            for (side, of) in [(left, &a), (right, &b)] {
                if of.shape() == Shape::Truth {
                    self.shaped(side, of, Shape::Number, "an operand")?;
                }
            }
            let sides = ((left, &a.ty), (right, &b.ty));
            self.checker.operated(op, op_span, sides.0, sides.1)
        };
        (!ty.is_error()).then(|| self.paired(operator(op), op_span, a, b, ty))?
    }

    /// Combines two values member by member. A single member is combined with every member of a list.
    pub(super) fn paired(
        &mut self,
        operator: Operator,
        span: Span,
        a: Typed,
        b: Typed,
        ty: Type,
    ) -> Option<Typed> {
        let count = match (a.list, b.list) {
            (true, true) if a.members.len() != b.members.len() => {
                self.diagnose(
                    Diagnostic::error(
                        codes::REPORT_RUNS,
                        format!(
                            "a list of {} is paired with a list of {}",
                            a.members.len(),
                            b.members.len()
                        ),
                    )
                    .at(span, "element by element"),
                );
                return None;
            }
            (true, _) => a.members.len(),
            (_, true) => b.members.len(),
            _ => 1,
        };
        let of = |side: &Typed, at: usize| {
            let at = if side.list { at } else { 0 };
            side.members.get(at).cloned()
        };
        let mut members = Vec::with_capacity(count);
        for at in 0..count {
            let (x, y) = (of(&a, at)?, of(&b, at)?);
            if matches!(operator, Operator::Add | Operator::Subtract) {
                self.of_one_frame(span, &x.expression, &y.expression)?;
            }
            let (mut analysis, channel) = joined(&x, &y, operator);
            if a.shape() != Shape::Signal && b.shape() == Shape::Signal {
                // the result has the samples of this run
                analysis.clone_from(&y.analysis);
            }
            let sides = (Box::new(x.expression), Box::new(y.expression));
            members.push(Member {
                analysis,
                channel,
                expression: Expression::Binary(operator, sides.0, sides.1),
            });
        }
        // a sum and a multiple are shown as their parts are
        let dimension = ty.each().map(|quantity| quantity.dim);
        let display = [&a, &b]
            .into_iter()
            .filter(|side| Some(side.quantity().dim) == dimension)
            .find_map(|side| side.display.clone());
        Some(Typed {
            members,
            list: a.list || b.list,
            ty,
            display,
            level: None,
        })
    }
}

/// The analysis and the channel text of an operator between two members.
fn joined(a: &Member, b: &Member, operator: Operator) -> (String, String) {
    let own = |member: &Member| (member.analysis.clone(), member.channel.clone());
    if b.analysis.is_empty() {
        return own(a);
    }
    if a.analysis.is_empty() {
        return own(b);
    }
    let sign = match operator {
        Operator::Add => "+",
        Operator::Subtract => "-",
        Operator::Multiply => "*",
        Operator::Divide => "/",
        _ => ",",
    };
    let channel = match (a.channel == b.channel, a.analysis == b.analysis) {
        (true, true) => a.channel.clone(),
        (true, false) => format!("{} ({} {sign} {})", a.channel, a.analysis, b.analysis),
        (false, true) => format!("{} {sign} {}", a.channel, b.channel),
        (false, false) => format!(
            "{}.{} {sign} {}.{}",
            a.analysis, a.channel, b.analysis, b.channel
        ),
    };
    (a.analysis.clone(), channel)
}

fn operator(op: BinaryOp) -> Operator {
    match op {
        BinaryOp::Or => Operator::Or,
        BinaryOp::And => Operator::And,
        BinaryOp::Equal => Operator::Equal,
        BinaryOp::NotEqual => Operator::NotEqual,
        BinaryOp::Less => Operator::Less,
        BinaryOp::LessEqual => Operator::LessEqual,
        BinaryOp::Greater => Operator::Greater,
        BinaryOp::GreaterEqual => Operator::GreaterEqual,
        BinaryOp::Add => Operator::Add,
        BinaryOp::Subtract => Operator::Subtract,
        BinaryOp::Multiply => Operator::Multiply,
        BinaryOp::Divide => Operator::Divide,
        BinaryOp::Power => Operator::Power,
    }
}
