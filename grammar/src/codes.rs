//! The codes of this stage's messages.

/// Code and title of every message that reading a text can give.
pub const CODES: &[(&str, &str)] = &[
    ("E0101", "the text is not what the language expects here"),
    ("E0102", "two items stand on one line"),
    ("E0103", "a bracket or brace has no partner"),
    (
        "E0104",
        "a space stands before the bracket of a call or an index",
    ),
    ("E0105", "no such kind of declaration"),
    ("E0106", "nested too deep"),
    ("E0107", "a number or a unit is malformed"),
    ("E0108", "a text is not closed or has an unknown escape"),
    ("E0109", "comparisons do not chain"),
    ("E0110", "too many mistakes to show"),
];
