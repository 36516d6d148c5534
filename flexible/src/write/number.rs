//! Numbers in the fixed forms of Fortran.

/// A number with so many digits after the point and the letter of its exponent: `-1.2345D+01`. An exponent
/// has at least two digits. One of three digits takes the place of the letter, as Fortran writes it.
pub fn fortran(value: f64, digits: usize, letter: char) -> String {
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
pub fn field(value: f64) -> String {
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
