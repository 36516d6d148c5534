//! The type of message codes, and the codes of this stage's messages.

/// A message code with its meaning and remedy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// `E0302`. A code has one meaning, which never changes.
    pub code: &'static str,
    /// The mistake in general.
    pub title: &'static str,
    /// The meaning and the remedy, in a sentence or two.
    pub meaning: &'static str,
    /// An example with the mistake; empty if a few lines cannot show it.
    pub wrong: &'static str,
    /// The corrected example; empty if `wrong` is.
    pub right: &'static str,
}

/// Defines a constant for each code of a group, and the named list of all, in order.
///
/// ```
/// eng_grammar::codes! {
///     CODES:
///     EMPTY = "E9901", "the text is empty", "There is nothing to read.", "", "";
/// }
/// assert_eq!(EMPTY, "E9901");
/// assert_eq!(CODES[0].title, "the text is empty");
/// ```
#[macro_export]
macro_rules! codes {
    ($list:ident: $($name:ident = $code:literal, $title:literal, $meaning:literal, $wrong:literal, $right:literal;)*) => {
        $(#[doc = $title] pub const $name: &str = $code;)*

        /// All codes of this group, in order.
        pub const $list: &[$crate::Code] = &[$($crate::Code {
            code: $code,
            title: $title,
            meaning: $meaning,
            wrong: $wrong,
            right: $right,
        }),*];
    };
}

codes! {
    CODES:

    UNEXPECTED = "E0101", "unexpected text",
        "Something is missing, misplaced or not of this language. The message lists what is possible at this place.",
        "let area = pi/4*",
        "let area = pi/4*bore^2";
    TWO_ITEMS = "E0102", "two items are on one line",
        "An item ends at the end of its line or at a semicolon.",
        "mass = 5 kg inertia = [1, 2, 3] g*m^2",
        "mass = 5 kg; inertia = [1, 2, 3] g*m^2";
    UNPAIRED = "E0103", "a bracket or brace has no matching one",
        "Every bracket that opens must close. The message shows the place of the open one.",
        "let sum = (a + b",
        "let sum = (a + b)";
    SPACE_BEFORE_BRACKET = "E0104", "a space before the bracket of a call or an index",
        "The bracket of a call or an index follows its name without a space. After a space it would begin a new value.",
        "let lift = cam (angle)",
        "let lift = cam(angle)";
    NO_SUCH_KIND = "E0105", "no such kind of declaration",
        "A declaration begins with its kind: body, joint, force, journal, drive, marker, part, param, let and so on.",
        "jiont big_end = Revolute(a, b)",
        "joint big_end = Revolute(a, b)";
    NESTED = "E0106", "nested too deep",
        "More than 100 brackets are open at once, one sum has more than 256 terms, or an expression is more than 256 levels deep. Each bracket and each operator is a level. Give parts of the expression a name with `let`.",
        "", "";
    NUMBER = "E0107", "a number or a unit is malformed",
        "A decimal point has digits on both sides. An exponent of a unit is a whole number or a fraction in parentheses.",
        "let bore = .5 mm",
        "let bore = 0.5 mm";
    TEXT = "E0108", "a text is not closed or has an unknown escape",
        "A text ends with its quotation mark on the same line. The escapes are \\n, \\t, \\\" and \\\\.",
        "let file = \"gas.csv",
        "let file = \"gas.csv\"";
    CHAIN = "E0109", "comparisons do not chain",
        "A comparison has two sides. Write two and join them.",
        "let fits = 1 < ratio < 2",
        "let fits = 1 < ratio and ratio < 2";
    TOO_MANY = "E0110", "too many mistakes to show",
        "Reading stops after many mistakes, because the first ones often cause the later ones. Correct the mistakes that are shown and check again.",
        "", "";
}
