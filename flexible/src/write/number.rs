//! Numbers in the fixed forms of Fortran.

/// A number with so many digits after the point and the letter of its exponent: `-1.2345D+01`. An exponent
/// has at least two digits. One of three digits takes the place of the letter, as Fortran writes it.
pub(super) fn fortran(value: f64, digits: usize, letter: char) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, size) = match exponent.strip_prefix('-') {
        Some(size) => ('-', size),
        None => ('+', exponent),
    };
    match size.len() {
        0..=2 => format!("{mantissa}{letter}{sign}{size:0>2}"),
        _ => format!("{mantissa}{sign}{size}"),
    }
}

/// A number in a field of 16 columns of Nastran, in double precision, with as many digits as fit.
pub(super) fn field(value: f64) -> String {
    let fits = |digits: usize| {
        let text = short(value, digits);
        (text.len() <= 16).then_some(text)
    };
    (1..=13)
        .rev()
        .find_map(fits)
        .unwrap_or_else(|| "0.0D0".into())
}

/// A number with the shortest exponent.
fn short(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{mantissa}D{exponent}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_into_their_fields() {
        assert_eq!(fortran(-12.5, 16, 'E'), "-1.2500000000000000E+01");
        assert_eq!(fortran(0.0, 16, 'E'), "0.0000000000000000E+00");
        assert_eq!(fortran(f64::MAX, 16, 'E'), "1.7976931348623157+308");
        for value in [1.0 / 3.0, -1e5 / 3.0, 2e-7 / 3.0, -1e-11 / 3.0, 1e100 / 3.0] {
            let text = field(value);
            assert!(text.len() <= 16 && text.len() >= 15, "{text}");
            let back: f64 = text.replace('D', "e").parse().expect("a number");
            assert!((back / value - 1.0).abs() < 1e-9, "{text}");
        }
    }
}
