//! "Did you mean": the known name nearest to a misspelt one.

use std::cmp::Reverse;

/// Longest name that gets suggestions. The work grows with the square of the length. The number is a choice.
pub const LONGEST_COMPARED: usize = 100;

/// The known name nearest to another one, if it is near enough to be the intended one.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = match name.chars().take(LONGEST_COMPARED + 1).count() {
        0..=1 => 0,
        2..=3 => 1,
        4..=6 => 2,
        length => length / 3,
    };
    let others = known.into_iter().filter(|candidate| *candidate != name);
    nearest_within(name, others, allowed)
}

/// The nearest known name that differs in at most `allowed` letters. Case alone is no difference. Among equally
/// near names it is the one that shares the longer beginning.
pub(crate) fn nearest_within<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
    allowed: usize,
) -> Option<&'a str> {
    let length = name.chars().take(LONGEST_COMPARED + 1).count();
    if length > LONGEST_COMPARED {
        return None;
    }
    let near = known.into_iter().filter_map(|candidate| {
        let other = candidate.chars().take(2 * LONGEST_COMPARED).count();
        // the distance is at least the difference of the lengths
        if other.abs_diff(length) > allowed {
            return None;
        }
        let distance = if candidate.eq_ignore_ascii_case(name) {
            0
        } else {
            strsim::damerau_levenshtein(name, candidate)
        };
        let letters = name.chars().zip(candidate.chars());
        let beginning = letters.take_while(|(a, b)| a == b).count();
        // `bore` differs in half of the letters of `nope`, so it is another word and no slip
        let slip = distance < 2 || 2 * distance < other.max(length) || beginning > 0;
        let close = distance <= allowed && distance < other.max(length) && slip;
        close.then_some((distance, Reverse(beginning), candidate))
    });
    near.min().map(|(.., candidate)| candidate)
}
