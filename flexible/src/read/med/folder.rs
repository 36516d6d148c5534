//! Folders of a MED file, which are groups of HDF5, and the numbers in them.

use crate::error::FileProblem;
use crate::read::hdf5::{Hdf5, Object, Trouble, Values};
use crate::read::source::whole;

/// Advice about damaged files.
pub(super) const AGAIN: &str = "write or copy the file again; it may be cut or damaged";

/// A file with its name.
pub(super) struct File<'f> {
    pub name: &'f str,
    pub data: Hdf5<'f>,
}

/// A folder: its path in messages, its members by name.
pub(super) struct Folder<'f> {
    pub path: String,
    object: Object<'f>,
    members: Vec<(String, u64)>,
}

impl<'f> File<'f> {
    /// A problem of a place in the file.
    pub fn problem(&self, path: &str, problem: &str, advice: &str) -> FileProblem {
        let place = if path.is_empty() { "" } else { ": " };
        whole(self.name, format!("{path}{place}{problem}"), advice)
    }

    /// A problem of the data of a place.
    pub fn trouble(&self, path: &str, trouble: &Trouble) -> FileProblem {
        let advice = match trouble {
            Trouble::NotRead(_) => {
                "write it again with plain datasets: `h5repack -f NONE -l CONTI old.med new.med`, or save it by Salome"
            }
            Trouble::Cut | Trouble::Damaged(_) => AGAIN,
        };
        self.problem(path, &trouble.to_string(), advice)
    }

    /// The folder of all others.
    pub fn root(&self) -> Result<Folder<'f>, FileProblem> {
        let root = self.data.root();
        self.folder(String::new(), root.map_err(|t| self.trouble("", &t))?)
    }

    fn folder(&self, path: String, object: Object<'f>) -> Result<Folder<'f>, FileProblem> {
        let links = self.data.links(&object);
        let links = links.map_err(|trouble| self.trouble(&path, &trouble))?;
        let named = |(name, at): &(&[u8], u64)| (text(name), *at);
        Ok(Folder {
            members: links.iter().map(named).collect(),
            path,
            object,
        })
    }

    /// A member of a folder; `None` without it.
    fn member(
        &self,
        folder: &Folder<'f>,
        name: &str,
    ) -> Result<Option<(String, Object<'f>)>, FileProblem> {
        let Some((_, address)) = folder.members.iter().find(|(own, _)| own == name) else {
            return Ok(None);
        };
        let path = match folder.path.is_empty() {
            true => name.to_owned(),
            false => format!("{}/{name}", folder.path),
        };
        let object = self.data.object(*address);
        Ok(Some((
            path.clone(),
            object.map_err(|trouble| self.trouble(&path, &trouble))?,
        )))
    }

    /// A folder in a folder; `None` without it.
    pub fn open(&self, folder: &Folder<'f>, name: &str) -> Result<Option<Folder<'f>>, FileProblem> {
        let found = self.member(folder, name)?;
        found
            .map(|(path, object)| self.folder(path, object))
            .transpose()
    }

    /// The values of a dataset in a folder, with its path; `None` without it.
    fn values(
        &self,
        folder: &Folder<'f>,
        name: &str,
    ) -> Result<Option<(String, Values<'f>)>, FileProblem> {
        let Some((path, object)) = self.member(folder, name)? else {
            return Ok(None);
        };
        let values = self.data.values(&object);
        match values.map_err(|trouble| self.trouble(&path, &trouble))? {
            Some(values) => Ok(Some((path, values))),
            None => Err(self.problem(&path, "it is no dataset", AGAIN)),
        }
    }

    /// The whole numbers of a dataset; `None` without it.
    pub fn integers(
        &self,
        folder: &Folder<'f>,
        name: &str,
    ) -> Result<Option<Vec<i64>>, FileProblem> {
        let Some((path, values)) = self.values(folder, name)? else {
            return Ok(None);
        };
        let numbers = values.integers();
        let wrong = || self.problem(&path, "its values are no whole numbers", AGAIN);
        numbers.ok_or_else(wrong).map(Some)
    }

    /// The real numbers of a dataset, all finite; `None` without it.
    pub fn reals(&self, folder: &Folder<'f>, name: &str) -> Result<Option<Vec<f64>>, FileProblem> {
        let Some((path, values)) = self.values(folder, name)? else {
            return Ok(None);
        };
        let numbers = values.reals();
        let numbers = numbers.filter(|all| all.iter().all(|x| x.is_finite()));
        let wrong = || self.problem(&path, "its values are no finite real numbers", AGAIN);
        numbers.ok_or_else(wrong).map(Some)
    }

    /// The letters of a dataset; `None` without it.
    pub fn letters(
        &self,
        folder: &Folder<'f>,
        name: &str,
    ) -> Result<Option<&'f [u8]>, FileProblem> {
        let Some((path, values)) = self.values(folder, name)? else {
            return Ok(None);
        };
        let wrong = || self.problem(&path, "its values are no letters", AGAIN);
        values.letters().ok_or_else(wrong).map(Some)
    }

    /// The number of values of a dataset; `None` without it.
    pub fn count(&self, folder: &Folder<'f>, name: &str) -> Result<Option<usize>, FileProblem> {
        Ok(self.values(folder, name)?.map(|(_, values)| values.len()))
    }

    /// A whole number that is an attribute; `None` without it.
    pub fn attribute(&self, folder: &Folder<'f>, name: &str) -> Result<Option<i64>, FileProblem> {
        self.attribute_of(&folder.path, &folder.object, name)
    }

    /// The same of a dataset in a folder.
    pub fn attribute_of_dataset(
        &self,
        folder: &Folder<'f>,
        dataset: &str,
        name: &str,
    ) -> Result<Option<i64>, FileProblem> {
        match self.member(folder, dataset)? {
            Some((path, object)) => self.attribute_of(&path, &object, name),
            None => Ok(None),
        }
    }

    fn attribute_of(
        &self,
        path: &str,
        object: &Object<'f>,
        name: &str,
    ) -> Result<Option<i64>, FileProblem> {
        let found = self.data.attribute(object, name.as_bytes());
        let Some(values) = found.map_err(|trouble| self.trouble(path, &trouble))? else {
            return Ok(None);
        };
        match values.integers().as_deref() {
            Some([number]) => Ok(Some(*number)),
            _ => {
                let problem = format!("its attribute {name} is no whole number");
                Err(self.problem(path, &problem, AGAIN))
            }
        }
    }
}

impl Folder<'_> {
    /// The names of its members, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.members.iter().map(|(name, _)| name.as_str())
    }

    /// Whether it has a member.
    pub fn has(&self, name: &str) -> bool {
        self.names().any(|own| own == name)
    }
}

/// Whether a list has an entry for each of so many nodes or cells, or no entry.
pub(super) fn fits(list: &[i64], count: usize) -> bool {
    list.is_empty() || list.len() == count
}

/// A name in a field that blanks or zero bytes fill.
pub(super) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0);
    let bytes = bytes.get(..end.unwrap_or(bytes.len())).unwrap_or(&[]);
    String::from_utf8_lossy(bytes).trim().to_owned()
}
