//! Numbers as bulk data writes them: reals with or without the letter of their exponent, integers, lists of
//! freedoms.

/// A real: `1.5`, `.5`, `1.5E+3`, `1.5D+3`, `1.5+3`, `-1.-3`. An integer counts as a real, as in most
/// readers. `None`: no number, or one that isn't finite.
pub fn real(text: &str) -> Option<f64> {
    let mut plain = String::with_capacity(text.len() + 1);
    let mut characters = text.chars().peekable();
    if let Some(sign) = characters.next_if(|c| matches!(c, '+' | '-')) {
        plain.push(sign);
    }
    let (mut digits, mut point) = (0, false);
    while let Some(c) = characters.next_if(|c| c.is_ascii_digit() || *c == '.') {
        if c == '.' && std::mem::replace(&mut point, true) {
            return None;
        }
        digits += usize::from(c != '.');
        plain.push(c);
    }
    if digits == 0 {
        return None;
    }
    if characters.peek().is_some() {
        let letter = characters
            .next_if(|c| matches!(c.to_ascii_uppercase(), 'E' | 'D'))
            .is_some();
        plain.push('e');
        match characters.next_if(|c| matches!(c, '+' | '-')) {
            Some(sign) => plain.push(sign),
            None if letter => {}
            None => return None,
        }
        let mut exponent = 0;
        for c in characters {
            if !c.is_ascii_digit() {
                return None;
            }
            exponent += 1;
            plain.push(c);
        }
        if exponent == 0 {
            return None;
        }
    }
    plain.parse::<f64>().ok().filter(|value| value.is_finite())
}

/// An integer.
pub fn integer(text: &str) -> Option<i64> {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    text.parse().ok()
}

/// Whether a field is meant as a real: a number with a decimal point.
pub fn is_real(text: &str) -> bool {
    text.contains('.') && real(text).is_some()
}

/// Freedoms `1`…`6` in any order as bits 0…5, blanks between them or not; `0` is no freedom.
pub fn components(text: &str) -> Option<u8> {
    if text.is_empty() {
        return None;
    }
    if text == "0" {
        return Some(0);
    }
    let mut digits = text.bytes().filter(|digit| *digit != b' ');
    digits.try_fold(0u8, |bits, digit| match digit {
        b'1'..=b'6' => Some(bits | 1 << (digit - b'1')),
        _ => None,
    })
}
