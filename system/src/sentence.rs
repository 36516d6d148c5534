//! Names in sentences of messages.

/// Names with commas: `a, b, c`. Of more than `most`, the first two and the last: `a, b to z (26 in all)`. So the
/// names should have an order that the reader knows, such as that of the text.
pub fn listed(names: &[&str], most: usize) -> String {
    match names {
        [first, second, .., last] if names.len() > most => {
            format!("{first}, {second} to {last} ({} in all)", names.len())
        }
        _ => names.join(", "),
    }
}

/// Names with `and`: `a`, `a and b`, `a, b and c`. Names beyond `most` are counted: `a, b and 7 more`.
pub fn joined(names: &[&str], most: usize) -> String {
    match names {
        names if names.len() > most => {
            let (shown, more) = names.split_at(most);
            format!("{} and {} more", shown.join(", "), more.len())
        }
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}
