//! Parameters that differ between the results of one report.

use super::Described;
use crate::results::Results;
use std::collections::BTreeSet;

/// Messages about results of one model with different values of a parameter because of `--set`. Results of
/// another text are skipped, because another message reports them.
pub(crate) fn mixed(runs: &[(&Results, &Described)]) -> Vec<String> {
    let current: Vec<&(&Results, &Described)> = runs
        .iter()
        .filter(|(results, described)| {
            results.metadata().get("source_hash") == Some(&described.source_hash)
        })
        .collect();
    let set: BTreeSet<(&str, &str)> = current
        .iter()
        .flat_map(|(results, described)| {
            let paths = described.set.keys();
            paths.map(|path| (results.model(), path.as_str()))
        })
        .collect();
    set.into_iter()
        .filter_map(|(model, path)| {
            let mut groups: Vec<(Option<&String>, Vec<&str>)> = Vec::new();
            for (results, described) in &current {
                if results.model() != model {
                    continue;
                }
                let value = described.set.get(path);
                match groups.iter_mut().find(|(known, _)| *known == value) {
                    Some((_, names)) => names.push(results.analysis()),
                    None => groups.push((value, vec![results.analysis()])),
                }
            }
            if groups.len() < 2 {
                return None;
            }
            let values: Vec<String> = groups
                .iter()
                .map(|(value, names)| {
                    let value = match value {
                        Some(value) => format!("set to {value}"),
                        None => "as the text states".to_owned(),
                    };
                    format!("{value} in those of {}", names.join(", "))
                })
                .collect();
            Some(format!(
                "the results are of different parameters: {path} is {}; run them again with equal parameters",
                values.join(", ")
            ))
        })
        .collect()
}
