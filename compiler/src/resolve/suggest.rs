//! "Did you mean": the nearest known name.

/// Number of messages above which an unknown name is no longer compared with the known ones: nobody reads
/// suggestions in more places, and each needs a comparison with all names. The number is a choice.
pub(crate) const EXPLAINED: usize = 100;

/// Longest name that gets suggestions. The work grows with the square of the length. The number is a choice.
pub(crate) const LONGEST: usize = 100;

/// The known name nearest to an unknown one, if it is near enough to be the intended one.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().take(LONGEST + 1).count();
    let allowed = match length {
        0..=1 => 0,
        _ if length > LONGEST => return None,
        2..=3 => 1,
        4..=6 => 2,
        _ => length / 3,
    };
    let mut best: Option<(usize, &str)> = None;
    for candidate in known {
        // the distance is at least the difference of the lengths
        let apart = candidate.chars().take(2 * LONGEST).count().abs_diff(length);
        if candidate == name || apart > allowed {
            continue;
        }
        let distance = if candidate.eq_ignore_ascii_case(name) {
            0
        } else {
            strsim::damerau_levenshtein(name, candidate)
        };
        let shared = distance < candidate.chars().count().max(length);
        let better = best.is_none_or(|(d, text)| (distance, candidate) < (d, text));
        if distance <= allowed && shared && better {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// "a, b and c"; at most `limit` names, then "…".
pub fn listing<'a>(names: impl IntoIterator<Item = &'a str>, limit: usize) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    let shown: Vec<String> = names
        .iter()
        .take(limit)
        .map(|name| format!("`{name}`"))
        .collect();
    if names.len() > limit {
        return format!("{}, …", shown.join(", "));
    }
    match shown.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        Some((last, _)) => last.clone(),
        None => "none".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_found() {
        let known = ["Revolute", "Spherical", "Fixed"];
        assert_eq!(nearest("Revolut", known), Some("Revolute"));
        assert_eq!(nearest("fixed", known), Some("Fixed"));
        assert_eq!(nearest("Gear", known), None);
        assert_eq!(nearest("mn", ["mm", "N", "kg"]), Some("mm"));
    }

    #[test]
    fn lists_read_like_sentences() {
        assert_eq!(listing([], 3), "none");
        assert_eq!(listing(["a"], 3), "`a`");
        assert_eq!(listing(["a", "b", "c"], 3), "`a`, `b` and `c`");
        assert_eq!(listing(["a", "b", "c"], 2), "`a`, `b`, …");
    }
}
