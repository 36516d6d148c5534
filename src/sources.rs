//! Sources of model texts and data files.

use crate::regular::regular;
use eng_system::host::{Host, HostError};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// The files of a model: a folder, or texts in memory. A model can read no file outside.
#[derive(Clone, Debug)]
pub struct Sources {
    kind: Kind,
    cache: Option<PathBuf>,
    /// Texts of an editor, by the paths of their files.
    unsaved: Arc<BTreeMap<PathBuf, String>>,
    /// Why there are no files but the texts.
    absence: Option<Arc<str>>,
    /// Hashes of files that are absent: their reductions are in the cache.
    sealed: Arc<BTreeMap<String, [u8; 32]>>,
    /// The files of the folder that were asked for, by the paths at which they were sought.
    asked: Arc<Mutex<BTreeMap<PathBuf, Asked>>>,
}

/// A file that was asked for.
#[derive(Clone, Debug)]
struct Asked {
    /// Its stamp before it was first opened.
    stamp: Option<Stamp>,
    /// Its canonical path, if there is such a file. No output may replace it.
    found: Option<PathBuf>,
}

/// The state of a file. Another content has another stamp, unless it has the same length and was written within the
/// resolution of the file system's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    modified: Option<SystemTime>,
    length: u64,
}

impl Stamp {
    /// The stamp of the file that a path leads to, links followed; `None` if there is none.
    pub fn of(path: &Path) -> Option<Stamp> {
        let found = std::fs::metadata(path).ok()?;
        Some(Stamp {
            modified: found.modified().ok(),
            length: found.len(),
        })
    }
}

#[derive(Clone, Debug)]
enum Kind {
    Folder(PathBuf),
    Texts(Arc<BTreeMap<String, String>>),
}

impl Sources {
    /// A folder on disk.
    pub fn folder(path: impl AsRef<Path>) -> Result<Sources, HostError> {
        let path = path.as_ref();
        let canonical = path.canonicalize().map_err(|error| HostError::System {
            path: path.display().to_string(),
            message: error.to_string(),
        })?;
        if !canonical.is_dir() {
            return Err(HostError::System {
                path: path.display().to_string(),
                message: "this is not a folder".into(),
            });
        }
        Ok(Sources {
            kind: Kind::Folder(canonical),
            cache: None,
            unsaved: Arc::default(),
            absence: None,
            sealed: Arc::default(),
            asked: Arc::default(),
        })
    }

    /// One text under a file name.
    pub fn from_text(name: impl Into<String>, text: impl Into<String>) -> Sources {
        Sources::from_texts([(name.into(), text.into())])
    }

    /// Several texts of models and data, under their file names.
    pub fn from_texts(texts: impl IntoIterator<Item = (String, String)>) -> Sources {
        Sources {
            kind: Kind::Texts(Arc::new(texts.into_iter().collect())),
            cache: None,
            unsaved: Arc::default(),
            absence: None,
            sealed: Arc::default(),
            asked: Arc::default(),
        }
    }
}

impl Sources {
    /// Keeps reduced flexible bodies in a folder, so that a mesh is reduced only once. The folder is made at
    /// its first use.
    pub fn with_cache(mut self, folder: impl Into<PathBuf>) -> Sources {
        self.cache = Some(folder.into());
        self
    }

    /// Reads these texts in place of files of the folder: those that an editor has not saved. The paths are canonical;
    /// a file need not be there yet.
    pub(crate) fn with_unsaved(
        mut self,
        texts: impl IntoIterator<Item = (PathBuf, String)>,
    ) -> Sources {
        self.unsaved = Arc::new(texts.into_iter().collect());
        self
    }

    /// Gives this reason for a file that is not among the texts, where its message would say that there is no such file.
    #[must_use]
    pub fn with_absence(mut self, reason: impl Into<Arc<str>>) -> Sources {
        self.absence = Some(reason.into());
        self
    }

    /// The error about a file that is not among the texts.
    fn absent(&self, path: &str) -> HostError {
        match &self.absence {
            None => HostError::NotFound(path.into()),
            Some(reason) => HostError::System {
                path: path.into(),
                message: reason.to_string(),
            },
        }
    }

    /// Takes the hashes of meshes and matrices that are not in the folder, because the cache has their reductions.
    pub(crate) fn with_sealed(
        mut self,
        hashes: impl IntoIterator<Item = (String, [u8; 32])>,
    ) -> Sources {
        self.sealed = Arc::new(hashes.into_iter().collect());
        self
    }

    /// The hash of an absent file.
    pub(crate) fn sealed(&self, name: &str) -> Option<[u8; 32]> {
        self.sealed.get(name).copied()
    }

    /// Names, relative to the folder, and contents of the files opened so far.
    pub(crate) fn contents(&self) -> Result<Vec<(String, Vec<u8>)>, HostError> {
        let folder = match &self.kind {
            Kind::Texts(texts) => {
                let texts = texts.iter();
                return Ok(texts
                    .map(|(name, text)| (name.clone(), text.clone().into_bytes()))
                    .collect());
            }
            Kind::Folder(folder) => folder,
        };
        let read = self.opened().into_iter().map(|path| {
            let inner = path.strip_prefix(folder).unwrap_or(&path);
            let parts: Vec<_> = inner
                .components()
                .map(|part| part.as_os_str().to_string_lossy())
                .collect();
            let name = parts.join("/");
            let bytes = std::fs::read(&path).map_err(|error| refused(&name, &error))?;
            Ok((name, bytes))
        });
        read.collect()
    }

    pub(crate) fn cache(&self) -> Option<&Path> {
        self.cache.as_deref()
    }

    /// The canonical paths of the files opened so far.
    pub(crate) fn opened(&self) -> BTreeSet<PathBuf> {
        let asked = self.list();
        asked
            .values()
            .filter_map(|file| file.found.clone())
            .collect()
    }

    /// The files asked for so far, also those that are not there, with their stamps before they were first opened. Another stamp
    /// of one of them may change the model.
    pub(crate) fn asked(&self) -> BTreeMap<PathBuf, Option<Stamp>> {
        let asked = self.list();
        asked
            .iter()
            .map(|(path, file)| (path.clone(), file.stamp))
            .collect()
    }

    fn list(&self) -> MutexGuard<'_, BTreeMap<PathBuf, Asked>> {
        // every entry of the list is complete, even after a panic in another thread
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The canonical path of a file of a folder. Notes the file as asked for.
    fn place(&self, folder: &Path, path: &str) -> Result<PathBuf, HostError> {
        let relative = inner(path)?;
        let sought = folder.join(relative);
        // taken before the file is read, so that no later change is missed
        let stamp = Stamp::of(&sought);
        let found = inside(folder, path);
        let mut list = self.list();
        let asked = list.entry(sought).or_insert(Asked { stamp, found: None });
        if let Ok(real) = &found {
            asked.found = Some(real.clone());
        }
        found
    }

    /// Opens a data file of any kind, under the rules of [`Host::read_text`].
    pub(crate) fn open_data(&self, path: &str) -> Result<Box<dyn std::io::Read>, HostError> {
        match &self.kind {
            Kind::Texts(texts) => match texts.get(path) {
                Some(text) => Ok(Box::new(std::io::Cursor::new(text.clone().into_bytes()))),
                None => Err(self.absent(path)),
            },
            Kind::Folder(folder) => {
                let file = std::fs::File::open(self.place(folder, path)?)
                    .map_err(|error| refused(path, &error))?;
                Ok(Box::new(file))
            }
        }
    }
}

/// A path that leads below its folder.
fn inner(path: &str) -> Result<&Path, HostError> {
    let relative = Path::new(path);
    let stays = relative
        .components()
        .all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    match stays {
        true => Ok(relative),
        false => Err(HostError::Outside(path.into())),
    }
}

/// The canonical path of a file of a folder. Refuses anything but a file.
fn inside(folder: &Path, path: &str) -> Result<PathBuf, HostError> {
    // a link may point outside the folder, so its target counts
    let real = folder
        .join(inner(path)?)
        .canonicalize()
        .map_err(|error| refused(path, &error))?;
    if !real.starts_with(folder) {
        return Err(HostError::Outside(path.into()));
    }
    regular(&real).map_err(|error| refused(path, &error))
}

/// The folder of reduced bodies: `ENG_CACHE` (empty for none), otherwise a folder of the user's caches.
pub(crate) fn cache_folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    if let Some(folder) = variable("ENG_CACHE") {
        return (!folder.is_empty()).then(|| PathBuf::from(folder));
    }
    let set = |name: &str| variable(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    set("XDG_CACHE_HOME")
        .or_else(|| set("LOCALAPPDATA"))
        .or_else(|| {
            let home = set("HOME")?;
            Some(if cfg!(target_os = "macos") {
                home.join("Library").join("Caches")
            } else {
                home.join(".cache")
            })
        })
        .map(|folder| folder.join("eng"))
}

fn refused(path: &str, error: &std::io::Error) -> HostError {
    match error.kind() {
        std::io::ErrorKind::NotFound => HostError::NotFound(path.into()),
        _ => HostError::System {
            path: path.into(),
            message: error.to_string(),
        },
    }
}

impl Host for Sources {
    fn read_text(&self, path: &str) -> Result<String, HostError> {
        match &self.kind {
            Kind::Texts(texts) => texts.get(path).cloned().ok_or_else(|| self.absent(path)),
            Kind::Folder(folder) => {
                let place = self.place(folder, path);
                // a text that was never saved has no file
                let real = place
                    .as_deref()
                    .map_or_else(|_| folder.join(path), Path::to_owned);
                if let Some(text) = self.unsaved.get(&real) {
                    return Ok(text.clone());
                }
                let bytes = std::fs::read(place?).map_err(|error| refused(path, &error))?;
                crate::utf8::text(bytes).map_err(|message| HostError::System {
                    path: path.into(),
                    message,
                })
            }
        }
    }
}
