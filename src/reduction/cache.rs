//! Keeps reductions, and the facts of meshes that a check needs, on disk under the hash of their
//! input.
//!
//! A file is named by the hash of the request and of the files that the text names. It lists every file that
//! was read, included files too, with their hashes. If one of them has changed, the file is useless.

use crate::Sources;
use eng_flexible::Files;
use eng_flexible::store::{
    Key, StoreError, StoredBody, content_hash, from_bytes, hexadecimal, to_bytes,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::cell::RefCell;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Files, with a list of those that were opened.
pub(super) struct Recorded<'a> {
    sources: &'a Sources,
    opened: RefCell<Vec<String>>,
}

impl<'a> Recorded<'a> {
    pub fn new(sources: &'a Sources) -> Self {
        Recorded {
            sources,
            opened: RefCell::new(Vec::new()),
        }
    }

    pub fn sources(&self) -> &Sources {
        self.sources
    }

    /// The files that were opened and are there, with the hashes of their contents.
    pub fn read_files(&self) -> Vec<(String, String)> {
        let mut names = self.opened.borrow().clone();
        names.sort();
        names.dedup();
        names
            .into_iter()
            .filter_map(|name| {
                let hash = hash_of(self.sources, &name)?;
                Some((format!("{FILE}{name}"), hexadecimal(&hash)))
            })
            .collect()
    }
}

impl Files for Recorded<'_> {
    fn open(&self, name: &str) -> std::io::Result<Box<dyn Read>> {
        let file = self.sources.open(name)?;
        self.opened.borrow_mut().push(name.to_owned());
        Ok(file)
    }
}

/// The beginning of the names of files in a provenance.
const FILE: &str = "file ";

/// Names and hashes of the files among the entries of a provenance.
pub(super) fn named(entries: &[(String, String)]) -> impl Iterator<Item = (String, String)> + '_ {
    let files = entries
        .iter()
        .filter_map(|(name, hash)| Some((name.strip_prefix(FILE)?, hash)));
    files.map(|(name, hash)| (name.to_owned(), hash.clone()))
}

/// The hash of a file's contents.
fn hash_of(sources: &Sources, name: &str) -> Option<[u8; 32]> {
    if let Some(hash) = sources.sealed(name) {
        return Some(hash);
    }
    let mut bytes = Vec::new();
    sources.open(name).ok()?.read_to_end(&mut bytes).ok()?;
    Some(content_hash(&bytes))
}

/// The key of a request and the files that the text names; `None` if a file cannot be read.
pub(super) fn key(sources: &Sources, request: &str, files: &[&str]) -> Option<Key> {
    let hashes: Option<Vec<[u8; 32]>> = files.iter().map(|name| hash_of(sources, name)).collect();
    Some(Key::new(&hashes?, request))
}

/// A value that the cache keeps. Each type has files of its own ending.
pub(super) trait Kept: Serialize + DeserializeOwned {
    const ENDING: &str;

    fn key(&self) -> Key;

    /// Names and values; those of files that were read have the names and hashes of [`Recorded::read_files`].
    fn files(&self) -> &[(String, String)];

    /// From the bytes of a file.
    fn from_bytes(bytes: &[u8]) -> Result<Self, StoreError> {
        from_bytes(bytes)
    }
}

impl Kept for StoredBody {
    const ENDING: &str = "reduced";

    fn key(&self) -> Key {
        self.key
    }

    fn files(&self) -> &[(String, String)] {
        &self.provenance
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, StoreError> {
        StoredBody::from_bytes(bytes)
    }
}

fn place<T: Kept>(folder: &Path, key: &Key) -> PathBuf {
    folder.join(format!("{}.{}", key.text(), T::ENDING))
}

/// The kept value of a key, if all its files are unchanged. A damaged value is made again.
pub(super) fn load<T: Kept>(sources: &Sources, key: &Key) -> Option<T> {
    let bytes = crate::regular::read(&place::<T>(sources.cache()?, key)).ok()?;
    let kept = T::from_bytes(&bytes).ok()?;
    let unchanged = kept.files().iter().all(|(name, value)| {
        let Some(file) = name.strip_prefix(FILE) else {
            return true;
        };
        hash_of(sources, file).is_some_and(|hash| hexadecimal(&hash) == *value)
    });
    (kept.key() == *key && unchanged).then_some(kept)
}

/// Keeps a value, whole or not at all. A failure to keep it is no error of the model.
pub(super) fn save<T: Kept>(sources: &Sources, kept: &T) -> Result<(), std::io::Error> {
    let Some(folder) = sources.cache() else {
        return Ok(());
    };
    let bytes = to_bytes(kept).map_err(std::io::Error::other)?;
    // threads that make the same at once write to files of their own
    crate::results::replace_file(&place::<T>(folder, &kept.key()), |file| {
        file.write_all(&bytes)
    })
}
