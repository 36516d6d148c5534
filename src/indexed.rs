//! Names with an index, such as `runup[3]`.

/// The name without index: `runup` of `runup[3]`.
pub(crate) fn base(name: &str) -> &str {
    name.split_once('[').map_or(name, |(base, _)| base)
}
