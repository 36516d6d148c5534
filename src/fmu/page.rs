//! The page of an FMU for people: `documentation/index.html`.

use super::variables::Described;
use super::{Kind, Subject};
use eng_report::escape::escaped;
use std::fmt::Write;

/// The page.
pub(super) fn page(model: &str, file: &str, subject: &Subject, variables: &[Described]) -> String {
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"UTF-8\"><title>{0}</title></head>\n<body>\n<h1>{0}</h1>\n",
        escaped(model)
    );
    let of = match subject {
        Subject::Model(_) => "with the parameters and steps of the model itself".to_owned(),
        Subject::Analysis(name) => {
            format!("with parameters, steps and start of the analysis {name}")
        }
    };
    let _ = writeln!(
        text,
        "<p>Made of {} by Eng {}, {}. All values are in SI units. \
         A simulation begins at 0 s. Limits are open: the limits themselves are refused.</p>",
        escaped(file),
        env!("CARGO_PKG_VERSION"),
        escaped(&of)
    );
    for (title, kind) in [
        ("Inputs", Kind::Input),
        ("Outputs", Kind::Output),
        ("Parameters", Kind::Parameter),
    ] {
        let mut rows = variables
            .iter()
            .filter(|known| known.variable.kind == kind)
            .peekable();
        if rows.peek().is_none() {
            continue;
        }
        let _ = writeln!(
            text,
            "<h2>{title}</h2>\n<table>\n<tr><th>name</th><th>SI unit</th><th>shown in</th><th>start</th><th>above</th><th>below</th></tr>"
        );
        for known in rows {
            let shown = |value: f64| match value.is_finite() {
                true => value.to_string(),
                false => String::new(),
            };
            let _ = writeln!(
                text,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                escaped(&known.variable.path),
                escaped(&known.dimension.to_string()),
                escaped(&known.display.symbol),
                known.start.map_or_else(String::new, shown),
                shown(known.limits.0),
                shown(known.limits.1)
            );
        }
        text.push_str("</table>\n");
    }
    text.push_str("</body>\n</html>\n");
    text
}
