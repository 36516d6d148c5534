//! Tables: numbers from a CSV file of the model or from the text.

use super::value::{ScopeId, Value};
use super::{Elaborator, Eval};
use crate::codes;
use eng_grammar::ast::{self, ExprKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::table::{Extrapolation, Interpolation, Table, TableError};
use eng_system::{Dimension, DisplayUnit};

impl<'a> Elaborator<'a, '_> {
    pub fn table_value(
        &mut self,
        table: &'a ast::Table,
        scope: ScopeId,
        module: u32,
    ) -> Eval<Value<'a>> {
        let argument = match table.parameters.first() {
            Some(p) => self.dimension(&p.ty),
            None => Dimension::ONE,
        };
        let result = table
            .result
            .as_ref()
            .map_or(Dimension::ONE, |t| self.dimension(t));
        let source = &table.source;
        let ExprKind::Call { callee, arguments } = &source.kind else {
            return Err(self.not_a_source(source.span));
        };
        let ExprKind::Name(kind) = &callee.kind else {
            return Err(self.not_a_source(source.span));
        };
        let mut interpolation = Interpolation::Cubic;
        let mut extrapolation = None;
        let mut period = None;
        let mut columns: Option<&'a ast::Expr> = None;
        let mut plain = Vec::new();
        for a in arguments {
            match a.name.as_ref().map(|n| n.text.as_str()) {
                None => plain.push(&a.value),
                Some("columns") => columns = Some(&a.value),
                Some("periodic") => {
                    let value = self.evaluate(&a.value, scope)?;
                    let s = self.as_scalar(value, a.value.span)?;
                    period = Some(self.structural(s, a.value.span)?);
                }
                Some("interpolation") => {
                    interpolation = match &a.value.kind {
                        ExprKind::Name(n) if n == "cubic" => Interpolation::Cubic,
                        ExprKind::Name(n) if n == "monotone" => Interpolation::Monotone,
                        _ => return Err(self.internal(a.value.span, "no interpolation")),
                    }
                }
                Some("extrapolation") => {
                    extrapolation = match &a.value.kind {
                        ExprKind::Name(n) if n == "hold" => Some(Extrapolation::Hold),
                        ExprKind::Name(n) if n == "linear" => Some(Extrapolation::Linear),
                        _ => return Err(self.internal(a.value.span, "no extrapolation")),
                    }
                }
                Some(_) => return Err(self.internal(a.value.span, "no argument of a table")),
            }
        }
        let (x, y) = match (kind.as_str(), plain.as_slice()) {
            ("points", [xs, ys]) => (self.numbers(xs, scope)?, self.numbers(ys, scope)?),
            ("csv", [file]) => {
                let Some(columns) = columns else {
                    return Err(self.internal(source.span, "`csv` without its columns"));
                };
                let text = |ty: Option<&ast::TypeExpr>| {
                    ty.map_or("a number", |t| self.sources.text(t.span))
                        .to_owned()
                };
                let due = [
                    (argument, text(table.parameters.first().map(|p| &p.ty))),
                    (result, text(table.result.as_ref())),
                ];
                self.read_csv(file, columns, module, &due)?
            }
            _ => return Err(self.not_a_source(source.span)),
        };
        // as the text writes them, so that a message can tell them
        let written = plain.first().and_then(|xs| self.literal_unit(xs));
        let units = (
            written.unwrap_or_else(|| self.natural_unit(argument)),
            self.natural_unit(result),
        );
        if let ([xs, ys], true) = (plain.as_slice(), x.len() != y.len()) {
            return Err(self.lengths(x.len(), xs.span, y.len(), ys.span));
        }
        let gap = match (period, interpolation) {
            (Some(period), Interpolation::Cubic) => period_gap(&x, period),
            _ => None,
        };
        if let Some((last, next, usual)) = gap {
            self.diagnostics.push(
                Diagnostic::warning(
                    codes::PERIOD_GAP,
                    format!(
                        "the points of table `{}` leave out a part of its period",
                        table.name.text
                    ),
                )
                .at(
                    source.span,
                    format!(
                        "none from {} to {}, where the next period begins",
                        units.0.text(last),
                        units.0.text(next)
                    ),
                )
                .with_note(format!(
                    "elsewhere they are {} apart; the spline bridges the gap by a curve of its own",
                    units.0.text(usual)
                ))
                .with_help(
                    "state points over the whole period, or take `interpolation: monotone`, which stays between the two values",
                ),
            );
        }
        match Table::new(
            table.name.text.clone(),
            x,
            y,
            interpolation,
            extrapolation,
            period,
        ) {
            Ok(t) => {
                self.tables.push(t);
                let index = self.tables.len() - 1;
                Ok(self.table_handle(index, result))
            }
            Err(error) => Err(self.report(
                Diagnostic::error(
                    codes::TABLE_POINTS,
                    format!("the points of table `{}` make no function", table.name.text),
                )
                .at(source.span, self.points_text(&error, units)),
            )),
        }
    }

    /// What is wrong with the points, in the units of their table.
    fn points_text(&self, error: &TableError, (x, y): (DisplayUnit, DisplayUnit)) -> String {
        match error {
            TableError::NotRising {
                row, before, after, ..
            } => format!(
                "the argument does not rise at point {row}: {} is followed by {}",
                x.text(*before),
                x.text(*after)
            ),
            TableError::NotPeriodic {
                row, first, last, ..
            } => format!(
                "the period closes at point {row}, but the values differ: {} and {}",
                y.text(*first),
                y.text(*last)
            ),
            TableError::PeriodTooShort { span, period, .. } => format!(
                "the points span {}, more than the period of {}",
                x.text(*span),
                x.text(*period)
            ),
            TableError::TooFew { count, .. } => {
                format!("at least 2 points are needed, there is {count}")
            }
            TableError::NotFinite { row, .. } => format!("point {row} is not a finite number"),
            other => other.to_string(),
        }
    }

    fn not_a_source(&mut self, span: Span) -> super::Reported {
        self.internal(span, "neither `csv(…)` nor `points(…)`")
    }

    fn numbers(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<Vec<f64>> {
        let value = self.evaluate(expr, scope)?;
        let components = self.as_components(value, expr.span)?;
        components
            .into_iter()
            .map(|s| self.structural(s, expr.span))
            .collect()
    }

    fn read_csv(
        &mut self,
        file: &'a ast::Expr,
        columns: &'a ast::Expr,
        module: u32,
        due: &[(Dimension, String); 2],
    ) -> Eval<(Vec<f64>, Vec<f64>)> {
        let ExprKind::Text(name) = &file.kind else {
            return Err(self.not_a_source(file.span));
        };
        let names: Vec<(String, Span)> = match &columns.kind {
            ExprKind::List { items, .. } => items
                .iter()
                .filter_map(|i| match &i.kind {
                    ExprKind::Text(t) => Some((t.clone(), i.span)),
                    _ => None,
                })
                .collect(),
            _ => Vec::new(),
        };
        let [x_name, y_name] = names.as_slice() else {
            return Err(self.internal(columns.span, "`columns` is no list of two texts"));
        };
        // a module in a folder reads beside itself
        let module_path = &self.program.modules[module as usize].path;
        let path = match module_path.rsplit_once('.') {
            Some((folder, _)) if !module_path.starts_with("std.") => {
                format!("{}/{name}", folder.replace('.', "/"))
            }
            _ => name.clone(),
        };
        let text = match self.host.read_text(&path) {
            Ok(text) => text,
            Err(error) => {
                return Err(self.report(
                    Diagnostic::error(codes::FILE, format!("the file {path} cannot be read"))
                        .at(file.span, error.to_string())
                        .with_help("data files lie in the folder of the model, or below it"),
                ));
            }
        };
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, l)| !l.trim().is_empty() && !l.trim_start().starts_with('#'));
        let Some((_, header)) = lines.next() else {
            return Err(self.report(
                Diagnostic::error(codes::FILE_CONTENT, format!("{path} is empty"))
                    .at(file.span, "a file begins with the names of its columns"),
            ));
        };
        let separator = if header.contains(';') {
            ';'
        } else if header.contains('\t') {
            '\t'
        } else {
            ','
        };
        let cells = |line: &str| -> Vec<String> {
            line.split(separator)
                .map(|c| c.trim().trim_matches('"').trim().to_owned())
                .collect()
        };
        let header = cells(header);
        let mut index = [0; 2];
        let mut scale = [(1.0, 0.0); 2];
        for (k, (wanted, span)) in [x_name, y_name].into_iter().enumerate() {
            index[k] = match header.iter().position(|h| h == wanted) {
                Some(i) => i,
                None => {
                    return Err(self.report(
                        Diagnostic::error(
                            codes::FILE_CONTENT,
                            format!("{path} has no column {wanted:?}"),
                        )
                        .at(*span, "not in its first row")
                        .with_note(format!("its first row is: {}", header.join(" | "))),
                    ));
                }
            };
            scale[k] = self.column_unit(wanted, *span, &due[k])?;
        }
        let mut x = Vec::new();
        let mut y = Vec::new();
        for (number, line) in lines {
            let row = cells(line);
            // what lies beyond the header, but empty cells of a separator at the end
            if row.iter().skip(header.len()).any(|cell| !cell.is_empty()) {
                let told = Diagnostic::error(
                    codes::FILE_CONTENT,
                    format!(
                        "line {} of {path} has {} cells, but the first row names {}",
                        number + 1,
                        row.len(),
                        header.len()
                    ),
                )
                .at(file.span, format!("the line is {:?}", shortened(line)));
                return Err(self.report(if separator == ',' {
                    told.with_help(
                        "with commas between the cells numbers have a decimal point; with decimal commas, separate the cells by `;` or tabs",
                    )
                } else {
                    told.with_help("name each column in the first row")
                }));
            }
            for k in 0..2 {
                let cell = row.get(index[k]).map_or("", String::as_str);
                // a decimal comma is read where the comma does not separate cells
                let wanted = if k == 0 { &x_name.0 } else { &y_name.0 };
                let plain = if separator == ',' {
                    cell.to_owned()
                } else {
                    cell.replace(',', ".")
                };
                match plain.parse::<f64>() {
                    Ok(v) if v.is_finite() => {
                        let si = v * scale[k].0 + scale[k].1;
                        if k == 0 { x.push(si) } else { y.push(si) }
                    }
                    _ => {
                        return Err(self.report(
                            Diagnostic::error(
                                codes::FILE_CONTENT,
                                format!("line {} of {path} does not hold a number", number + 1),
                            )
                            .at(
                                file.span,
                                if cell.is_empty() {
                                    format!("nothing stands in its column {wanted:?}")
                                } else {
                                    format!("its column {wanted:?} holds {cell:?}")
                                },
                            ),
                        ));
                    }
                }
            }
        }
        Ok((x, y))
    }

    /// Scale and offset of `theta [deg]`.
    fn column_unit(
        &mut self,
        header: &str,
        span: Span,
        (expected, type_text): &(Dimension, String),
    ) -> Eval<(f64, f64)> {
        let unit = header
            .split_once('[')
            .and_then(|(_, rest)| rest.split_once(']'))
            .map_or("1", |(unit, _)| unit.trim());
        if unit == "1" || unit.is_empty() {
            if !expected.without_angle().is_one() {
                return Err(self.report(
                    Diagnostic::error(
                        codes::COLUMN_UNIT,
                        format!("the column states no unit, but {type_text} has one"),
                    )
                    .at(span, "no unit in brackets")
                    .with_help("name the unit in the first row of the file and here: `p [bar]`"),
                ));
            }
            return Ok((1.0, 0.0));
        }
        let mut scratch = eng_grammar::Diagnostics::new();
        let source = self
            .sources
            .add(format!("unit of {header}"), format!("1 {unit}"));
        let parsed = eng_grammar::parse_expression(&format!("1 {unit}"), source, 0, &mut scratch);
        let Some(ast::Expr {
            kind:
                ExprKind::Number {
                    unit: Some(unit_expr),
                    ..
                },
            ..
        }) = parsed
        else {
            return Err(self.report(
                Diagnostic::error(codes::COLUMN_UNIT, format!("{unit:?} is not a unit"))
                    .at(span, "between the brackets of this column's name"),
            ));
        };
        let unit = match self.program.unit(&unit_expr) {
            Ok(u) => u,
            Err((_, name)) => {
                return Err(self.report(
                    Diagnostic::error(codes::COLUMN_UNIT, format!("there is no unit `{name}`"))
                        .at(span, "between the brackets of this column's name"),
                ));
            }
        };
        if unit.dimension.without_angle() != expected.without_angle() {
            return Err(self.report(
                Diagnostic::error(
                    codes::COLUMN_UNIT,
                    format!("a column in {} does not give {type_text}", unit.symbol),
                )
                .at(span, "the unit of this column does not fit"),
            ));
        }
        Ok((unit.scale, unit.offset))
    }
}

/// A gap of a period that is longer than this many usual distances of the points, and than this share of the period, is told.
const GAP_DISTANCES: f64 = 3.0;
const GAP_SHARE: f64 = 0.05;

/// Where the points of a periodic table leave out the end of the period: the last argument, the first of the next period, and the
/// median distance of the points (all in the argument's unit).
fn period_gap(x: &[f64], period: f64) -> Option<(f64, f64, f64)> {
    let next = x.first()? + period;
    let last = *x.last()?;
    let mut distances: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    distances.sort_by(f64::total_cmp);
    let usual = *distances.get(distances.len() / 2)?;
    let gap = next - last;
    (gap > GAP_DISTANCES * usual && gap > GAP_SHARE * period).then_some((last, next, usual))
}

/// A line of a file as a message shows it.
fn shortened(line: &str) -> String {
    const SHOWN: usize = 40;
    let line = line.trim();
    match line.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}
