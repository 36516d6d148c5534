//! `eng results`.

use super::arguments::ResultsArguments;
use super::table::Table;
use super::{Console, Stop, USAGE_OR_SYSTEM};
use crate::results::{Kind, Listed, Selection, listed};

/// Lists what result files hold. Files that can't be read are told of, and the others listed all the same.
pub(super) fn results(arguments: &ResultsArguments, console: &mut Console<'_>) -> Result<(), Stop> {
    let files = match listed(&arguments.path) {
        Ok(files) => files,
        Err(error) => {
            writeln!(console.errors, "error: {error}")?;
            return Err(Stop::Code(USAGE_OR_SYSTEM));
        }
    };
    if files.is_empty() {
        writeln!(
            console.errors,
            "error: there are no results in {}",
            arguments.path.display()
        )?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
    }
    let selection = Selection::new(arguments.channels.iter().map(String::as_str));
    let mut unread = false;
    for (index, file) in files.iter().enumerate() {
        let read = Listed::read(file).and_then(|mut found| {
            found.results = selection.apply(&found.results)?;
            Ok(found)
        });
        match read {
            Ok(found) => {
                if index > 0 {
                    writeln!(console.output)?;
                }
                show(&found, console)?;
            }
            Err(error) => {
                unread = true;
                writeln!(console.errors, "error: {error}")?;
            }
        }
    }
    if unread {
        Err(Stop::Code(USAGE_OR_SYSTEM))
    } else {
        Ok(())
    }
}

fn show(found: &Listed, console: &mut Console<'_>) -> Result<(), Stop> {
    let results = &found.results;
    let output = &mut console.output;
    writeln!(output, "{} ({})", results.analysis(), results.model())?;
    let state = match &found.kind {
        Kind::Complete => String::new(),
        Kind::Failed(reason) => format!("; the run failed: {reason}"),
        Kind::Unfinished => {
            "; the run goes on or was interrupted: go on with `eng run … --resume`".to_owned()
        }
    };
    writeln!(output, "  {}{state}", found.path.display())?;
    let mut span = format!("{} samples", results.samples());
    let [time, angle] = found.spans();
    if let Some((from, to)) = time {
        span.push_str(&format!(", {} to {} s", short(from), short(to)));
    }
    if let Some((from, to)) = angle {
        let (from, to) = (from.to_degrees(), to.to_degrees());
        span.push_str(&format!(", {} to {} °CA", short(from), short(to)));
    }
    writeln!(output, "  {span}")?;
    for (key, value) in results.metadata() {
        if key == "identity" || key == "state" {
            continue;
        }
        writeln!(output, "  {key}: {value}")?;
    }
    let mut table = Table::new(&[&["channel", "unit", "smallest", "largest", "frame"]]);
    for column in results.columns() {
        let shown = |si: f64| short(column.display.from_si(si));
        let (low, high) = match column.range() {
            Some((low, high)) => (shown(low), shown(high)),
            None => ("–".to_owned(), "–".to_owned()),
        };
        table.row(vec![
            column.path.clone(),
            column.display.symbol.clone(),
            low,
            high,
            column.frame.clone(),
        ]);
    }
    write!(output, "{}", table.render())?;
    Ok(())
}

/// Six significant digits.
fn short(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e9).contains(&magnitude) {
        return format!("{value:.5e}");
    }
    let digits = (5.0 - libm::floor(libm::log10(magnitude))).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (720.0, "720"),
            (0.0123456789, "0.0123457"),
            (-1234567.8, "-1234568"),
            (1e-7, "1.00000e-7"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
