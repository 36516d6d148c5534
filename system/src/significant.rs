//! Numbers for people: significant digits, and no sign before a zero.

/// A number with `digits` significant digits. It has an exponent if that is shorter than zeros.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return format!("{value}");
    }
    let decimals = digits.max(1) - 1;
    let scientific = format!("{value:.decimals$e}");
    // the exponent of the rounded number: 99.9999 becomes 100.0
    let exponent = scientific
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse::<i64>().ok());
    match exponent {
        Some(exponent @ -4..=8) => {
            let decimals = usize::try_from(decimals as i64 - exponent).unwrap_or(0);
            format!("{value:.decimals$}")
        }
        _ => scientific,
    }
}

/// [`significant`] without zeros at the end.
pub fn short(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    let (digits, exponent) = text.split_at(text.find('e').unwrap_or(text.len()));
    if digits.contains('.') {
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        format!("{digits}{exponent}")
    } else {
        text
    }
}

/// A number with `decimals` decimals. A number that rounds to zero has no sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    without_sign_of_zero(format!("{value:.decimals$}"))
}

/// The text of a number; `-0.00` becomes `0.00`.
pub fn without_sign_of_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.contains('0') && rest.chars().all(|c| matches!(c, '0' | '.' | ',')) => {
            rest.to_owned()
        }
        _ => text,
    }
}
