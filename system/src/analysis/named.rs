//! Inputs, channels and parameters that an analysis names, such as `inputs: [brake]` of `linear`.

use crate::place::Location;

/// The kind of things that a list of names may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Names {
    /// Inputs of the model.
    Inputs,
    /// Channels: outputs of the model and of its elements. A name may be that of a vector, which has several.
    Channels,
    /// Parameters of the model and of its parts.
    Parameters,
}

/// A name of the text with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// `main[2].force`; `[*]` stands for every index.
    pub path: String,
    /// Its place.
    pub at: Location,
}

/// A name to which nothing belongs, or only something that an earlier name of the list also has.
#[derive(Clone, Debug, PartialEq)]
pub struct Misnamed {
    /// Its index in the list.
    pub index: usize,
    /// Whether the input, channel or parameter of this name also belongs to an earlier name of the list.
    pub again: bool,
}

impl Names {
    /// Indices of the named inputs, channels or parameters among all `paths` of a system, in the order of the names.
    ///
    /// # Errors
    /// The first name to which nothing belongs, or only something that an earlier name has.
    pub fn indices(self, named: &[Named], paths: &[&str]) -> Result<Vec<usize>, Misnamed> {
        let mut found = Vec::new();
        for (index, name) in named.iter().enumerate() {
            let before = found.len();
            for (k, path) in paths.iter().enumerate() {
                if !self.means(&name.path, path) {
                    continue;
                }
                if found.contains(&k) {
                    return Err(Misnamed { index, again: true });
                }
                found.push(k);
            }
            if found.len() == before {
                return Err(Misnamed {
                    index,
                    again: false,
                });
            }
        }
        Ok(found)
    }

    /// Whether a path belongs to a name.
    pub fn means(self, name: &str, path: &str) -> bool {
        let component = |axis: &str| {
            let vector = path.strip_suffix(axis);
            self == Names::Channels && vector.is_some_and(|vector| fits(name, vector))
        };
        fits(name, path) || [".x", ".y", ".z"].into_iter().any(component)
    }
}

/// Whether a path has the form of a name: `[*]` fits every index.
pub fn fits(name: &str, path: &str) -> bool {
    let mut pieces = name.split("[*]");
    let Some(mut rest) = pieces.next().and_then(|first| path.strip_prefix(first)) else {
        return false;
    };
    for piece in pieces {
        let Some((_, after)) = rest.strip_prefix('[').and_then(|r| r.split_once(']')) else {
            return false;
        };
        let Some(after) = after.strip_prefix(piece) else {
            return false;
        };
        rest = after;
    }
    rest.is_empty()
}
