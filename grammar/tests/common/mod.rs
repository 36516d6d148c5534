//! Messages and trees as plain text.

use eng_grammar::ast::*;
use eng_grammar::{Diagnostic, Diagnostics, Severity, SourceId, SourceMap, parse};
use std::fmt::Write;

/// Parses a text as the only source.
pub fn parsed(text: &str) -> (File, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let file = parse(text, SourceId(0), &mut diagnostics);
    (file, diagnostics)
}

/// One message with the lines it points at.
pub fn message(sources: &SourceMap, diagnostic: &Diagnostic) -> String {
    let severity = match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let mut out = format!("{severity}[{}]: {}\n", diagnostic.code, diagnostic.title);
    for label in &diagnostic.labels {
        let span = label.span;
        let (line, column) = sources
            .line_column(span.source, span.start)
            .expect("a label lies in the source");
        let text = &sources.get(span.source).expect("a known source").text;
        let whole = text.lines().nth(line - 1).unwrap_or("");
        let shown = sources.text(span);
        let width = shown.lines().next().unwrap_or("").chars().count().max(1);
        let mark = if label.primary { "^" } else { "-" };
        let _ = writeln!(out, "{line:4} | {whole}");
        let _ = writeln!(
            out,
            "     | {}{} {}",
            " ".repeat(column - 1),
            mark.repeat(width),
            label.message
        );
    }
    for note in &diagnostic.notes {
        let _ = writeln!(out, "     = note: {note}");
    }
    for help in &diagnostic.help {
        let _ = writeln!(out, "     = help: {help}");
    }
    for fix in &diagnostic.fixes {
        let (line, column) = sources
            .line_column(fix.span.source, fix.span.start)
            .expect("a fix lies in the source");
        let _ = writeln!(
            out,
            "     = fix: {} ({line}:{column} `{}` -> `{}`)",
            fix.title,
            sources.text(fix.span),
            fix.replacement
        );
    }
    out
}

/// All messages of a text.
pub fn messages(text: &str) -> String {
    let (_, diagnostics) = parsed(text);
    let mut sources = SourceMap::new();
    sources.add("model.eng", text);
    diagnostics
        .iter()
        .map(|diagnostic| message(&sources, diagnostic))
        .collect::<Vec<_>>()
        .join("\n")
}

/// The items of a tree, one a line, blocks indented.
pub fn tree(items: &[Item]) -> String {
    let mut out = String::new();
    write_items(&mut out, items, 0);
    out
}

fn write_items(out: &mut String, items: &[Item], level: usize) {
    for item in items {
        let pad = "  ".repeat(level);
        for doc in &item.docs {
            let _ = writeln!(out, "{pad};; {doc}");
        }
        match &item.kind {
            ItemKind::Declaration(declaration) => write_declaration(out, declaration, level),
            other => {
                let _ = writeln!(out, "{pad}{}", item_text(other));
            }
        }
    }
}

fn write_declaration(out: &mut String, declaration: &Declaration, level: usize) {
    let pad = "  ".repeat(level);
    let word = format!("{:?}", declaration.kind).to_lowercase();
    let mut head = format!(
        "{word} {}{}",
        declaration.name.text,
        binders(&declaration.index)
    );
    if let Some(condition) = &declaration.condition {
        let _ = write!(head, " if {}", expr(condition));
    }
    let block = match &declaration.form {
        Form::Class {
            parameters: list,
            interface,
            block,
        } => {
            let _ = write!(head, " class {}", parameters(list));
            if let Some(interface) = interface {
                let _ = write!(head, " : {}", interface.text);
            }
            Some(block)
        }
        Form::Instance { value, block } => {
            let _ = write!(head, " = {}", expr(value));
            block.as_ref()
        }
        Form::Plain { interface, block } => {
            if let Some(interface) = interface {
                let _ = write!(head, " : {}", interface.text);
            }
            Some(block)
        }
    };
    let _ = write!(out, "{pad}({head}");
    if let Some(block) = block {
        out.push_str(" {\n");
        write_items(out, &block.items, level + 1);
        let _ = write!(out, "{pad}}}");
    }
    out.push_str(")\n");
}

fn item_text(kind: &ItemKind) -> String {
    match kind {
        ItemKind::Use(item) => {
            let path: Vec<_> = item.path.iter().map(|name| name.text.as_str()).collect();
            let names = match &item.names {
                UseNames::All => "*".to_string(),
                UseNames::Some(names) => names
                    .iter()
                    .map(|name| name.text.as_str())
                    .collect::<Vec<_>>()
                    .join(" "),
            };
            format!("(use {} {names})", path.join("."))
        }
        ItemKind::Dimension(item) => format!(
            "(dimension {}{}{})",
            item.name.text,
            if item.point { " point" } else { "" },
            item.definition
                .as_ref()
                .map_or(String::new(), |ty| format!(" {}", type_text(ty)))
        ),
        ItemKind::Unit(item) => format!(
            "(unit {}{}{}{})",
            item.name.text,
            item.dimension
                .as_ref()
                .map_or(String::new(), |ty| format!(" : {}", type_text(ty))),
            item.definition
                .as_ref()
                .map_or(String::new(), |e| format!(" = {}", expr(e))),
            item.offset
                .as_ref()
                .map_or(String::new(), |e| format!(" from {}", expr(e))),
        ),
        ItemKind::Choice(item) => {
            let words: Vec<_> = item.words.iter().map(|word| word.text.as_str()).collect();
            format!("(choice {} {})", item.name.text, words.join(" "))
        }
        ItemKind::Binding(item) => binding(item),
        ItemKind::Function(item) => {
            let generics: Vec<_> = item
                .generics
                .iter()
                .map(|name| name.text.as_str())
                .collect();
            let mut lets: Vec<_> = item.lets.iter().map(binding).collect();
            lets.extend(item.requirements.iter().map(|r| {
                let word = if r.advise { "advise" } else { "require" };
                let name = lint_name(&r.name);
                format!("({word}{name} {} {:?})", expr(&r.condition), r.message.text)
            }));
            format!(
                "(fn {}<{}> {}{} {{{}}} {})",
                item.name.text,
                generics.join(" "),
                parameters(&item.parameters),
                item.result
                    .as_ref()
                    .map_or(String::new(), |ty| format!(" -> {}", type_text(ty))),
                lets.join(" "),
                item.value.as_ref().map_or(String::from("-"), expr)
            )
        }
        ItemKind::Table(item) => format!(
            "(table {} {}{} {})",
            item.name.text,
            parameters(&item.parameters),
            item.result
                .as_ref()
                .map_or(String::new(), |ty| format!(" -> {}", type_text(ty))),
            expr(&item.source)
        ),
        ItemKind::Statement(statement) => statement_text(statement),
        ItemKind::Attribute(item) => format!("({} = {})", item.name.text, expr(&item.value)),
        ItemKind::Report(item) => {
            let title = item.title.as_ref().map_or("", |title| title.text.as_str());
            format!(
                "(report {} {title:?}\n{})",
                item.name.text,
                tree(&item.block.items)
            )
        }
        ItemKind::Entry(item) => {
            let title = item.title.as_ref().map_or("", |title| title.text.as_str());
            let display = item
                .display
                .as_ref()
                .map_or(String::new(), |u| format!(" as {}", unit(u)));
            format!(
                "({:?} {} {title:?} = {}{display})",
                item.kind,
                item.name.text,
                expr(&item.value)
            )
        }
        ItemKind::Declaration(_) => String::new(),
        ItemKind::Error => "(error)".to_string(),
    }
}

fn statement_text(statement: &Statement) -> String {
    match statement {
        Statement::Constrain(e) => format!("(constrain {})", expr(e)),
        Statement::Branch(e) => format!("(branch {})", expr(e)),
        Statement::Start { target, value } => format!("(start {} {})", expr(target), expr(value)),
        Statement::Guess { target, value } => format!("(guess {} {})", expr(target), expr(value)),
        Statement::Apply {
            torque,
            value,
            on,
            against,
        } => format!(
            "(apply-{} {} on {}{})",
            if *torque { "torque" } else { "force" },
            expr(value),
            expr(on),
            against
                .as_ref()
                .map_or(String::new(), |e| format!(" against {}", expr(e)))
        ),
        Statement::Require {
            advise,
            index,
            name,
            condition,
            message,
        } => format!(
            "({}{}{} {} {:?})",
            if *advise { "advise" } else { "require" },
            binders(index),
            lint_name(name),
            expr(condition),
            message.text
        ),
        Statement::Resolve(e) => format!("(resolve {})", expr(e)),
        Statement::Change { target, value } => {
            format!("(change {} {})", expr(target), expr(value))
        }
        Statement::Place { moving, on, height } => {
            let height = height
                .as_ref()
                .map_or(String::new(), |height| format!(" at {}", expr(height)));
            format!("(place {} on {}{height})", expr(moving), expr(on))
        }
        Statement::Accept(names) => {
            let names: Vec<_> = names.iter().map(|name| name.text.as_str()).collect();
            format!("(accept {})", names.join(" "))
        }
        Statement::Rate { state, value } => format!("(der {} {})", state.text, expr(value)),
    }
}

fn lint_name(name: &Option<Name>) -> String {
    name.as_ref()
        .map_or(String::new(), |name| format!(" {}:", name.text))
}

fn binding(item: &Binding) -> String {
    let mut out = format!(
        "({} {}{}",
        format!("{:?}", item.kind).to_lowercase(),
        item.name.text,
        binders(&item.index)
    );
    if let Some(ty) = &item.ty {
        let _ = write!(out, " : {}", type_text(ty));
    }
    if let Some(value) = &item.value {
        let _ = write!(out, " = {}", expr(value));
    }
    if let Some(frame) = &item.frame {
        let _ = write!(out, " frame {}", expr(frame));
    }
    if let Some(display) = &item.display {
        let _ = write!(out, " as {}", unit(display));
    }
    if let Some((low, high)) = &item.limits {
        let _ = write!(out, " limits {} {}", expr(low), expr(high));
    }
    if let Some(scale) = &item.scale {
        let _ = write!(out, " scale {}", expr(scale));
    }
    out + ")"
}

fn binders(list: &[Binder]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let inner: Vec<_> = list
        .iter()
        .map(|binder| format!("{} in {}", binder.name.text, expr(&binder.range)))
        .collect();
    format!("[{}]", inner.join(", "))
}

fn parameters(list: &[Parameter]) -> String {
    let inner: Vec<_> = list
        .iter()
        .map(|parameter| {
            let mut out = format!("{}: {}", parameter.name.text, type_text(&parameter.ty));
            if let Some(default) = &parameter.default {
                let _ = write!(out, " = {}", expr(default));
            }
            if let Some((low, high)) = &parameter.limits {
                let _ = write!(out, " limits {} {}", expr(low), expr(high));
            }
            for doc in &parameter.docs {
                let _ = write!(out, " ;; {doc}");
            }
            out
        })
        .collect();
    format!("({})", inner.join(", "))
}

/// A type in prefix form.
pub fn type_text(ty: &TypeExpr) -> String {
    match &ty.kind {
        TypeExprKind::Name(name) => name.text.clone(),
        TypeExprKind::One => "1".to_string(),
        TypeExprKind::Generic(name, types) => {
            let inner: Vec<_> = types.iter().map(type_text).collect();
            format!("{}<{}>", name.text, inner.join(", "))
        }
        TypeExprKind::Array(of, length) => format!("(array {} {})", type_text(of), expr(length)),
        TypeExprKind::Product(a, b) => format!("(* {} {})", type_text(a), type_text(b)),
        TypeExprKind::Quotient(a, b) => format!("(/ {} {})", type_text(a), type_text(b)),
        TypeExprKind::Power(a, n, d) => format!("(^ {} {n}/{d})", type_text(a)),
        TypeExprKind::Function(types, value) => {
            let inner: Vec<_> = types.iter().map(type_text).collect();
            format!("(fn ({}) {})", inner.join(", "), type_text(value))
        }
        TypeExprKind::Error => "(error)".to_string(),
    }
}

/// A unit as factors with exponents.
pub fn unit(unit: &UnitExpr) -> String {
    let inner: Vec<_> = unit
        .factors
        .iter()
        .map(|factor| match (factor.numerator, factor.denominator) {
            (1, 1) => factor.name.text.clone(),
            (n, 1) => format!("{}^{n}", factor.name.text),
            (n, d) => format!("{}^{n}/{d}", factor.name.text),
        })
        .collect();
    format!("<{}>", inner.join(" "))
}

fn unit_after(given: &Option<UnitExpr>) -> String {
    given.as_ref().map_or(String::new(), unit)
}

/// An expression in prefix form; `5` is an integer, `5.` is not.
pub fn expr(e: &Expr) -> String {
    match &e.kind {
        ExprKind::Number {
            value,
            integer,
            unit,
        } => format!(
            "{value}{}{}",
            if *integer { "" } else { "~" },
            unit_after(unit)
        ),
        ExprKind::Text(text) => format!("{text:?}"),
        ExprKind::Bool(value) => format!("{value}"),
        ExprKind::Name(name) => name.clone(),
        ExprKind::List { items, unit } => {
            let inner: Vec<_> = items.iter().map(expr).collect();
            format!("[{}]{}", inner.join(", "), unit_after(unit))
        }
        ExprKind::Comprehension {
            body,
            binders: list,
            unit,
        } => format!("(for {} {}){}", binders(list), expr(body), unit_after(unit)),
        ExprKind::Paren { inner, unit } => format!("(paren {}){}", expr(inner), unit_after(unit)),
        ExprKind::Field { base, name } => format!("{}.{}", expr(base), name.text),
        ExprKind::Call { callee, arguments } => {
            let inner: Vec<_> = arguments
                .iter()
                .map(|argument| {
                    let name = argument
                        .name
                        .as_ref()
                        .map_or(String::new(), |name| format!("{}: ", name.text));
                    format!("{name}{}", expr(&argument.value))
                })
                .collect();
            format!("(call {} ({}))", expr(callee), inner.join(", "))
        }
        ExprKind::Index { base, indices } => {
            let inner: Vec<_> = indices
                .iter()
                .map(|index| match index {
                    IndexArgument::At(e) => expr(e),
                    IndexArgument::All(_) => "*".to_string(),
                })
                .collect();
            format!("(at {} {})", expr(base), inner.join(" "))
        }
        ExprKind::Unary { op, operand } => {
            let sign = match op {
                UnaryOp::Negate => "neg",
                UnaryOp::Not => "not",
            };
            format!("({sign} {})", expr(operand))
        }
        ExprKind::Binary {
            op, left, right, ..
        } => {
            let sign = match op {
                BinaryOp::Or => "or",
                BinaryOp::And => "and",
                BinaryOp::Equal => "==",
                BinaryOp::NotEqual => "!=",
                BinaryOp::Less => "<",
                BinaryOp::LessEqual => "<=",
                BinaryOp::Greater => ">",
                BinaryOp::GreaterEqual => ">=",
                BinaryOp::Add => "+",
                BinaryOp::Subtract => "-",
                BinaryOp::Multiply => "*",
                BinaryOp::Divide => "/",
                BinaryOp::Power => "^",
            };
            format!("({sign} {} {})", expr(left), expr(right))
        }
        ExprKind::If {
            condition,
            then,
            otherwise,
        } => format!(
            "(if {} {}{})",
            expr(condition),
            expr(then),
            otherwise
                .as_ref()
                .map_or(String::new(), |otherwise| format!(" {}", expr(otherwise)))
        ),
        ExprKind::Range { from, to, by } => format!(
            "(range {} {}{})",
            expr(from),
            expr(to),
            by.as_ref()
                .map_or(String::new(), |by| format!(" by {}", expr(by)))
        ),
        ExprKind::Error => "(error)".to_string(),
    }
}
