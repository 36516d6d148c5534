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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_at_the_end_are_left_out() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (720.0, "720"),
            (0.0123456789, "0.0123457"),
            (-1234567.8, "-1234568"),
            (1e-7, "1e-7"),
            (-7.85e-9, "-7.85e-9"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(short(value, 6), text);
        }
        for (value, text) in [
            (1000.0, "1000"),
            (99.5, "99.5"),
            (1234.56, "1234.6"),
            (0.012345678, "0.012346"),
            (1.5e9, "1.5e9"),
        ] {
            assert_eq!(short(value, 5), text);
        }
    }

    #[test]
    fn digits_are_counted_and_zeros_kept() {
        for (value, text) in [
            (1.0, "1.0000"),
            (12345.6, "12346"),
            (0.00012345678, "0.00012346"),
            (-3.2e-9, "-3.2000e-9"),
            (4e12, "4.0000e12"),
            (99.999999999, "100.00"),
            (-0.00099999999, "-0.0010000"),
        ] {
            assert_eq!(significant(value, 5), text);
        }
        assert_eq!(significant(7.0, 0), "7");
    }

    #[test]
    fn zeros_have_no_sign() {
        assert_eq!(fixed(-1e-9, 3), "0.000");
        assert_eq!(fixed(-0.0006, 3), "-0.001");
        assert_eq!(without_sign_of_zero("-0".into()), "0");
        assert_eq!(without_sign_of_zero("-0,00".into()), "0,00");
        for kept in ["-", "-.", "–", "-0.1", "-0 N", "-10"] {
            assert_eq!(without_sign_of_zero(kept.into()), kept);
        }
    }
}
