//! "Did you mean", and lists of the names that are known.

pub(crate) use eng_grammar::{LONGEST_COMPARED, nearest};

/// Beyond this number of messages, an unknown name is not compared with the known ones. Nobody reads suggestions in
/// more places, and each needs a comparison with all names. The number is a choice.
pub(crate) const EXPLAINED: usize = 100;

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
