//! Names with an index, such as `runup[3]`.

/// The name without index: `runup` of `runup[3]`.
pub(crate) fn base(name: &str) -> &str {
    name.split_once('[').map_or(name, |(base, _)| base)
}

/// Names in a list. Neighbours that count on are one entry: `cold, runup[1..12]`.
pub fn listed<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let mut entries: Vec<(&str, Option<[usize; 2]>)> = Vec::new();
    for name in names {
        let Some(index) = index(name) else {
            entries.push((name, None));
            continue;
        };
        match entries.last_mut() {
            Some((known, Some([_, last]))) if *known == base(name) && *last + 1 == index => {
                *last = index;
            }
            _ => entries.push((base(name), Some([index, index]))),
        }
    }
    let texts = entries.iter().map(|(name, range)| match range {
        None => (*name).to_owned(),
        Some([first, last]) if first == last => format!("{name}[{first}]"),
        Some([first, last]) => format!("{name}[{first}..{last}]"),
    });
    texts.collect::<Vec<_>>().join(", ")
}

/// The index of a name: 3 of `runup[3]`.
fn index(name: &str) -> Option<usize> {
    name.strip_suffix(']')?.split_once('[')?.1.parse().ok()
}
