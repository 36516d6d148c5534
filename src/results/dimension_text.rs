//! Reads the text that `Display` of [`Dimension`] prints: `kg*m/s^2`, `m^(1/2)`, `1/s`, `1`.

use eng_system::Dimension;
use eng_system::dimension::{BASE_SYMBOLS, BASES};

/// The dimension of a text in SI base symbols; `None` if it is not one.
pub fn parse(text: &str) -> Option<Dimension> {
    let mut dimension = Dimension::ONE;
    let mut rest = text;
    let mut sign = 1;
    loop {
        let end = factor_end(rest);
        let (factor, tail) = rest.split_at_checked(end)?;
        dimension = dimension.times(parse_factor(factor, sign)?);
        let mut characters = tail.chars();
        sign = match characters.next() {
            None => return Some(dimension),
            Some('*') => 1,
            Some('/') => -1,
            Some(_) => return None,
        };
        rest = characters.as_str();
    }
}

/// Byte of the next `*` or `/` outside parentheses.
fn factor_end(text: &str) -> usize {
    let mut depth = 0;
    for (index, character) in text.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            '*' | '/' if depth == 0 => return index,
            _ => {}
        }
    }
    text.len()
}

fn parse_factor(factor: &str, sign: i32) -> Option<Dimension> {
    if factor == "1" {
        return Some(Dimension::ONE);
    }
    let (symbol, exponent) = factor.split_once('^').unwrap_or((factor, "1"));
    let index = BASE_SYMBOLS.iter().position(|base| *base == symbol)?;
    debug_assert!(index < BASES);
    let inside = exponent
        .strip_prefix('(')
        .and_then(|e| e.strip_suffix(')'))
        .unwrap_or(exponent);
    let (numerator, denominator) = match inside.split_once('/') {
        Some((n, d)) => (n.parse::<i32>().ok()?, d.parse::<i32>().ok()?),
        None => (inside.parse::<i32>().ok()?, 1),
    };
    Dimension::base(index).power(numerator.checked_mul(sign)?, denominator)
}
