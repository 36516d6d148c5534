//! Units as people read them.

/// `m/s²` of `m/s^2`, `N·m` of `N*m`, `µm` of `um`, `°C` of `degC`: a unit of the language with the signs of print.
pub fn readable_unit(symbol: &str) -> String {
    let mut text = String::with_capacity(symbol.len());
    let mut word = String::new();
    let mut raised = false;
    for character in symbol.chars().chain(std::iter::once(' ')) {
        if character.is_ascii_alphabetic() {
            raised = false;
            word.push(character);
            continue;
        }
        text.push_str(match word.as_str() {
            "um" => "µm",
            "us" => "µs",
            "deg" => "°",
            "degC" => "°C",
            other => other,
        });
        word.clear();
        match character {
            '^' => raised = true,
            '*' => text.push('·'),
            '-' if raised => text.push('⁻'),
            digit if raised && digit.is_ascii_digit() => {
                const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
                let index = digit.to_digit(10).unwrap_or_default() as usize;
                text.extend(RAISED.get(index));
            }
            other => {
                raised = false;
                text.push(other);
            }
        }
    }
    text.truncate(text.trim_end().len());
    text
}
