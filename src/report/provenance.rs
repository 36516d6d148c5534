//! The origin of results: versions, texts, files and reductions with their hashes.

use super::Entry;
use super::describe::Matter;
use eng_flexible::store::hexadecimal;
use eng_report::page::{Provenance, Section};

/// The section. `command` is the command line.
pub(super) fn section(entries: &[Entry], command: &str) -> Section {
    let mut versions = vec![(
        "eng, this report".to_owned(),
        env!("CARGO_PKG_VERSION").to_owned(),
    )];
    let mut hashes = Vec::new();
    if let Some(entry) = entries.first() {
        hashes.push((
            "texts of the model, now".to_owned(),
            format!("sha256:{}", entry.described.source_hash),
        ));
    }
    // facts that several analyses share appear once
    let mut facts: Vec<(String, String, Vec<&str>)> = Vec::new();
    let mut add = |what: &str, value: String, analysis| {
        let same = facts.iter_mut().find(|(w, v, _)| w == what && *v == value);
        match same {
            Some((_, _, names)) => names.push(analysis),
            None => facts.push((what.to_owned(), value, vec![analysis])),
        }
    };
    for entry in entries {
        let metadata = entry.outcome.results.metadata();
        if let Some(version) = metadata.get("version") {
            add("eng", version.clone(), entry.name());
        }
        if let Some(hash) = metadata.get("source_hash") {
            add("texts of the model", sha256(hash), entry.name());
        }
        for (key, value) in metadata {
            if let Some(name) = key.strip_prefix("override.") {
                add(
                    &format!("{name} over the text's"),
                    value.clone(),
                    entry.name(),
                );
            }
        }
        for body in &entry.described.bodies {
            let Matter::Flexible(reduction) = &body.matter else {
                continue;
            };
            let stored = &reduction.stored;
            let key = hexadecimal(&stored.key.0);
            add(
                &format!("reduction of {}", body.path),
                sha256(&key),
                entry.name(),
            );
            for (name, hash) in &stored.provenance {
                if name.starts_with("file ") {
                    add(name, sha256(hash), entry.name());
                }
            }
        }
    }
    for (what, value, names) in facts {
        let row = (format!("{what}, {}", names.join(", ")), value);
        if what == "eng" {
            versions.push(row);
        } else {
            hashes.push(row);
        }
    }
    for entry in entries {
        let files = entry.files.iter();
        hashes.extend(files.map(|(name, hash)| (name.clone(), sha256(hash))));
    }
    let provenance = Provenance {
        command: command.to_owned(),
        versions,
        hashes,
        notes: Vec::new(),
    };
    Section::new("Provenance").table(provenance.table("How this came to be"))
}

fn sha256(hash: &str) -> String {
    format!("sha256:{hash}")
}
