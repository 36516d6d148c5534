//! The uses of a name in all texts of a folder, and its change to another name.

use super::checks::errors;
use super::document::{Document, range};
use super::index::Index;
use super::occurrences::{Occurrence, Target, occurrences};
use super::{Server, document};
use eng_grammar::{Diagnostics, SourceId, parse};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Most folders below each other, and most files, in which uses are sought. The numbers are choices. A name with uses
/// beyond them keeps its name.
const DEEPEST_FOLDER: usize = 4;
const MOST_FILES: usize = 500;

/// The text that has a definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// A text of an editor that is no file, by its name.
    Text(String),
    File(PathBuf),
    /// A module of the library, by its path.
    Library(String),
}

/// The home of a module of an index.
pub(super) fn home(index: &Index<'_>, document: &Document, module: usize) -> Option<Home> {
    let found = index.module(module)?;
    if index.is_library(module) {
        return Some(Home::Library(found.path.clone()));
    }
    match (&found.file_name, &document.path) {
        (Some(name), Some(path)) => Some(Home::File(path.parent()?.join(name))),
        (_, Some(path)) => Some(Home::File(path.clone())),
        (_, None) => Some(Home::Text(document.uri.clone())),
    }
}

/// The name at a place that has a definition.
fn named(index: &Index<'_>, place: usize) -> Option<(Occurrence, Target)> {
    let mut all = occurrences(index).into_iter();
    all.find_map(|one| {
        let at = one.span.start as usize <= place && place <= one.span.end as usize;
        Some((one, one.of.filter(|_| at)?))
    })
}

/// A definition with its name.
struct Definition {
    home: Home,
    start: u32,
    name: String,
    /// The place of the name that was asked for.
    asked: Value,
}

/// The places of a name in one text.
struct Uses {
    document: Document,
    /// First byte, the one after the last, and whether it is the definition.
    places: Vec<(usize, usize, bool)>,
}

impl Server<'_> {
    /// The uses of the name at a place; null if it has no definition.
    pub(super) fn references(&self, document: &Document, place: usize, with: bool) -> Value {
        let Some(definition) = self.defined(document, place) else {
            return Value::Null;
        };
        let mut locations = Vec::new();
        // some uses are better than none, also in a folder with too many texts
        for uses in self.uses(document, &definition, &BTreeMap::new()) {
            let (uri, text) = (self.name_of(&uses.document), &uses.document.text);
            let wanted = uses.places.iter().filter(|(.., defines)| with || !defines);
            locations.extend(
                wanted.map(
                    |(start, end, _)| json!({ "uri": uri, "range": range(text, *start, *end) }),
                ),
            );
        }
        Value::Array(locations)
    }

    /// The place of a name that can be changed.
    ///
    /// # Errors
    /// The reason why it cannot.
    pub(super) fn renamable(&self, document: &Document, place: usize) -> Result<Value, String> {
        let definition = self.own_definition(document, place)?;
        Ok(json!({ "range": definition.asked, "placeholder": definition.name }))
    }

    /// The edits that give the name at a place another one, in all texts that use it.
    ///
    /// # Errors
    /// The reason why it cannot be changed: a name of the library, a text with mistakes, a name that has another meaning
    /// already, or more texts than are read.
    pub(super) fn renamed(
        &self,
        document: &Document,
        place: usize,
        name: &str,
    ) -> Result<Value, String> {
        let definition = self.own_definition(document, place)?;
        let letters = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
        let begins = name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_');
        if !begins || !name.chars().all(letters) || eng_grammar::WORDS.contains(&name) {
            return Err(format!("`{name}` cannot be a name"));
        }
        let (around, whole) = self.texts_around(document, &BTreeMap::new());
        if !whole || !self.has_read(document, &definition) {
            return Err(format!(
                "the folder has more than {MOST_FILES} texts, or `{}` is in a hidden folder or more than {DEEPEST_FOLDER} \
                 folders below it; open a smaller one",
                definition.name
            ));
        }
        let uses = self.uses(document, &definition, &BTreeMap::new());
        for one in &uses {
            let mut messages = Diagnostics::new();
            parse(&one.document.text, SourceId(0), &mut messages);
            if messages.has_errors() {
                let text = self.name_of(&one.document);
                return Err(format!("{text} has mistakes; mend them first"));
            }
        }
        self.keeps_its_meaning(document, &definition, (&uses, &around), name)?;
        let mut changes = Map::new();
        for one in &uses {
            let text = &one.document.text;
            let places = one.places.iter();
            let edits = places.map(
                |(start, end, _)| json!({ "range": range(text, *start, *end), "newText": name }),
            );
            changes.insert(self.name_of(&one.document), Value::Array(edits.collect()));
        }
        Ok(json!({ "changes": changes }))
    }

    /// Makes the change in copies of the texts: they and the texts around have no more errors than before, and the new
    /// name has as many uses as the old one.
    fn keeps_its_meaning(
        &self,
        document: &Document,
        definition: &Definition,
        (uses, around): (&[Uses], &[Document]),
        name: &str,
    ) -> Result<(), String> {
        let count = |uses: &[Uses]| uses.iter().map(|one| one.places.len()).sum::<usize>();
        let mut changed = BTreeMap::new();
        let mut after = Definition {
            home: definition.home.clone(),
            start: definition.start,
            name: name.to_owned(),
            asked: Value::Null,
        };
        let mut asked = document.text.clone();
        for one in uses {
            let mut text = one.document.text.clone();
            for (start, end, _) in one.places.iter().rev() {
                text.replace_range(*start..*end, name);
            }
            if one.places.iter().any(|(.., defines)| *defines) {
                let before = one.places.iter().filter(|(.., defines)| !defines);
                let before = before.filter(|(start, ..)| *start < definition.start as usize);
                let (count, old, new) = (before.count(), definition.name.len(), name.len());
                let start = (definition.start as usize + count * new).saturating_sub(count * old);
                after.start = start as u32;
            }
            if one.document.uri == document.uri {
                asked.clone_from(&text);
            }
            if let Some(path) = &one.document.path {
                changed.insert(path.clone(), text);
            }
        }
        let document = Document {
            uri: document.uri.clone(),
            path: document.path.clone(),
            version: document.version,
            text: asked,
        };
        if count(&self.uses(&document, &after, &changed)) != count(uses) {
            return Err(format!(
                "`{name}` has another meaning at a place of this name"
            ));
        }
        // A class may give the value of an output that the interface in another text requires: its text has the old
        // name, but no use of this definition. A text with `.*` may get the new name from two others.
        let old = definition.name.as_str();
        let concerned =
            |one: &&Document| [old, name, ".*"].iter().any(|part| one.text.contains(part));
        for one in around.iter().filter(concerned) {
            let (sources, file) = self.sources(one);
            let before = errors(sources, file);
            let now = match one.path {
                Some(_) => one,
                None => &document,
            };
            let (sources, file) = self.sources_with(now, &changed);
            if errors(sources, file) > before {
                let text = self.name_of(one);
                return Err(format!(
                    "`{name}` has another meaning in {text}, or this text needs the name `{old}`"
                ));
            }
        }
        Ok(())
    }

    /// The definition of the name at a place, if it is not one of the library.
    fn own_definition(&self, document: &Document, place: usize) -> Result<Definition, String> {
        let definition = self.defined(document, place);
        let definition = definition.ok_or("there is no name with a definition here")?;
        match definition.home {
            Home::Library(module) => Err(format!("`{}` belongs to {module}", definition.name)),
            _ => Ok(definition),
        }
    }

    fn defined(&self, document: &Document, place: usize) -> Option<Definition> {
        let index = self.index(document);
        let (one, of) = named(&index, place)?;
        let (start, end) = (one.span.start as usize, one.span.end as usize);
        Some(Definition {
            home: home(&index, document, of.module)?,
            start: of.start,
            name: document.text.get(start..end)?.to_owned(),
            asked: range(&document.text, start, end),
        })
    }

    /// The uses of a definition in a document, and in the files around it.
    fn uses(
        &self,
        document: &Document,
        definition: &Definition,
        changed: &BTreeMap<PathBuf, String>,
    ) -> Vec<Uses> {
        let mut found = Vec::new();
        let (around, _) = self.texts_around(document, changed);
        for text in around {
            if !text.text.contains(&definition.name) {
                continue;
            }
            let (sources, _) = self.sources_with(&text, changed);
            let index = Index::new(&self.library, &text, &sources);
            let of = |target: Target| {
                target.start == definition.start
                    && home(&index, &text, target.module).as_ref() == Some(&definition.home)
            };
            let all = occurrences(&index).into_iter();
            let all = all.filter(|one| one.of.is_some_and(of));
            let places: Vec<(usize, usize, bool)> = all
                .map(|one| (one.span.start as usize, one.span.end as usize, one.defines))
                .filter(|(start, end, _)| {
                    text.text.get(*start..*end) == Some(definition.name.as_str())
                })
                .collect();
            if !places.is_empty() {
                found.push(Uses {
                    document: text,
                    places,
                });
            }
        }
        found
    }

    /// The folder of the client around a document, otherwise its own folder; none for a text that is no file.
    fn folder_around<'p>(&'p self, document: &'p Document) -> Option<&'p Path> {
        let path = document.path.as_ref()?;
        let mut roots = self.roots.iter().filter(|root| path.starts_with(root));
        roots.next().map(PathBuf::as_path).or(path.parent())
    }

    /// Whether the texts around a document include all that can see a definition, if they are not too many. A text sees
    /// the files of its folder and below. So those that see a file are in its folder and in the ones above.
    fn has_read(&self, document: &Document, definition: &Definition) -> bool {
        let (Home::File(file), Some(folder)) = (&definition.home, self.folder_around(document))
        else {
            return true;
        };
        let below = file.parent().and_then(|of| of.strip_prefix(folder).ok());
        below.is_some_and(|below| {
            below.iter().count() <= DEEPEST_FOLDER && !below.iter().any(is_hidden)
        })
    }

    /// The document, and the files of its folder and of the client's folder around it; and whether these files are not
    /// too many.
    fn texts_around(
        &self,
        document: &Document,
        changed: &BTreeMap<PathBuf, String>,
    ) -> (Vec<Document>, bool) {
        let mut texts = vec![Document {
            uri: document.uri.clone(),
            path: document.path.clone(),
            version: document.version,
            text: document.text.clone(),
        }];
        let Some(path) = &document.path else {
            return (texts, true);
        };
        let mut files = Vec::new();
        let folder = self.folder_around(document);
        let whole = folder.is_none_or(|folder| files_below(folder, DEEPEST_FOLDER, &mut files));
        let open = self.documents.values();
        files.extend(open.filter_map(|open| open.document.path.clone()));
        files.sort();
        files.dedup();
        for file in files.into_iter().filter(|file| file != path) {
            let mut open = self.documents.values();
            let open = open.find(|open| open.document.path.as_ref() == Some(&file));
            let text = match (changed.get(&file), open) {
                (Some(text), _) => Some(text.clone()),
                (None, Some(open)) => Some(open.document.text.clone()),
                (None, None) => std::fs::read_to_string(&file).ok(),
            };
            texts.extend(text.map(|text| Document::of_file(&file, text)));
        }
        (texts, whole)
    }

    /// The client's name of a text.
    fn name_of(&self, document: &Document) -> String {
        let mut open = self.documents.values().map(|open| &open.document);
        let known = open.find(|open| open.path.is_some() && open.path == document.path);
        match (known, &document.path) {
            (Some(open), _) => open.uri.clone(),
            (None, Some(path)) => document::uri(path),
            (None, None) => document.uri.clone(),
        }
    }
}

fn is_hidden(name: &OsStr) -> bool {
    name.to_string_lossy().starts_with('.')
}

/// Adds the `.eng` files of a folder and of those below it, down to a depth. Returns whether they are not too many.
fn files_below(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) -> bool {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.path();
        let hidden = is_hidden(&entry.file_name());
        match entry.file_type() {
            Ok(kind) if kind.is_dir() && !hidden => folders.push(path),
            Ok(kind) if kind.is_file() && path.extension().is_some_and(|end| end == "eng") => {
                if files.len() >= MOST_FILES {
                    return false;
                }
                files.push(path);
            }
            // a link could lead around in a circle
            _ => {}
        }
    }
    let mut folders = folders.iter();
    depth == 0 || folders.all(|folder| files_below(folder, depth - 1, files))
}
