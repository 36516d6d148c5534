//! Numbers with a noun in the singular or the plural.

/// `1 body`, `2 bodies`.
pub(crate) fn counted(count: usize, one: &str, many: &str) -> String {
    let noun = if count == 1 { one } else { many };
    format!("{count} {noun}")
}
