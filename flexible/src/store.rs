//! Contents of files that are kept: a reduced body with everything that a run, its tables and the recovery of
//! nodes and stresses need, and other serializable values in the same frame.
//!
//! ```text
//! magic (8 bytes) | version u32 | length of the whole u64 | contents … | SHA-256 of all before (32 bytes)
//! ```
//!
//! The head is little-endian, the contents are in the format of `postcard`, which keeps the bits of every
//! f64: a body that is read has the bits of the body that was written. The reader checks every byte, and
//! needs no more memory than the bytes of the file. The caller writes the file under a temporary name and
//! renames it, so it is whole or absent. It belongs to its [`Key`], a hash over the input. A body with
//! another key is reduced again.

use crate::fe::{FreedomMap, Rules};
use crate::mesh::Mesh;
use crate::reduce::{Reduced, Report};
use crate::surface::Surface;
use eng_system::reduced::ReducedBody;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

/// Version of the format. It also rises when the same input gives other numbers, because it is part of the
/// key.
pub const FORMAT_VERSION: u32 = 24;

/// A byte that no text begins with, a name, and a line's end that a transfer as text would spoil.
const MAGIC: [u8; 8] = *b"\x8bENGRB\r\n";
/// Bytes before the contents: magic, version, length.
const HEAD: usize = 8 + 4 + 8;
/// Bytes of the hash at the end.
const HASH: usize = 32;

/// The reason why bytes are not the contents of a kept file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum StoreError {
    /// The file begins with other bytes.
    #[error("this is not a file of a reduced body")]
    NotABody,
    /// The file has another version.
    #[error(
        "the reduced body is of format {found}, and this program reads format {FORMAT_VERSION}"
    )]
    Version {
        /// The version of the file.
        found: u32,
    },
    /// The length of the file differs from the length in its head.
    #[error(
        "the file of the reduced body has {found} bytes, not {expected}: it was cut off or added to"
    )]
    Length {
        /// Bytes by the head of the file.
        expected: u64,
        /// Bytes of the file.
        found: u64,
    },
    /// The contents have changed since they were written.
    #[error("the file of the reduced body was altered after it was written: its hash differs")]
    Altered,
    /// The sizes in the file contradict each other: a program with a fault wrote it.
    #[error("the file of the reduced body is inconsistent: {problem}")]
    Contents {
        /// The contradiction.
        problem: String,
    },
}

impl StoreError {
    /// The remedy.
    pub fn advice(&self) -> &'static str {
        "remove the file; the body is then reduced again from its mesh"
    }
}

fn senseless(problem: impl std::fmt::Display) -> StoreError {
    StoreError::Contents {
        problem: problem.to_string(),
    }
}

/// SHA-256 of the input of a reduced body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Key(pub [u8; 32]);

impl Key {
    /// The key of a reduction: over the format's version, this crate's version, the contents' hashes of all
    /// files read, in the order given, and the request as text (with units, material and
    /// all other data that decide the result). Names and dates of files do not count.
    pub fn new(files: &[[u8; 32]], request: &str) -> Key {
        let mut hash = Sha256::new();
        hash.update(MAGIC);
        hash.update(FORMAT_VERSION.to_le_bytes());
        for text in [env!("CARGO_PKG_VERSION"), request] {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text.as_bytes());
        }
        hash.update((files.len() as u64).to_le_bytes());
        for file in files {
            hash.update(file);
        }
        Key(hash.finalize().into())
    }

    /// Hexadecimal digits, for a file's name.
    pub fn text(&self) -> String {
        hexadecimal(&self.0)
    }
}

/// SHA-256 of a file's contents.
pub fn content_hash(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}

/// Hexadecimal digits of a hash.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// The bytes of a file with a value.
///
/// # Errors
/// A list without a known length.
pub fn to_bytes(value: &impl Serialize) -> Result<Vec<u8>, StoreError> {
    let mut out = Vec::with_capacity(1 << 16);
    out.extend_from_slice(&MAGIC);
    out.extend_from_slice(&FORMAT_VERSION.to_le_bytes());
    out.extend_from_slice(&[0; 8]);
    let mut out = postcard::to_extend(value, out).map_err(senseless)?;
    let length = (out.len() + HASH) as u64;
    if let Some(place) = out.get_mut(HEAD - 8..HEAD) {
        place.copy_from_slice(&length.to_le_bytes());
    }
    let hash = Sha256::digest(&out);
    out.extend_from_slice(&hash);
    Ok(out)
}

/// The value in the bytes of a file.
///
/// # Errors
/// Bytes of no kept file, of another version, cut off, altered, or of another type.
pub fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, StoreError> {
    let Some(head) = bytes.strip_prefix(&MAGIC) else {
        return Err(StoreError::NotABody);
    };
    let found = bytes.len() as u64;
    let short = |expected| StoreError::Length { expected, found };
    let least = (HEAD + HASH) as u64;
    let (version, head) = head.split_first_chunk().ok_or(short(least))?;
    let version = u32::from_le_bytes(*version);
    if version != FORMAT_VERSION {
        return Err(StoreError::Version { found: version });
    }
    let (length, _) = head.split_first_chunk().ok_or(short(least))?;
    let expected = u64::from_le_bytes(*length);
    if expected != found || found < least {
        return Err(short(expected.max(least)));
    }
    let (signed, hash) = bytes.split_at(bytes.len() - HASH);
    if Sha256::digest(signed).as_slice() != hash {
        return Err(StoreError::Altered);
    }
    let contents = signed.get(HEAD..).unwrap_or_default();
    let (value, rest) = postcard::take_from_bytes(contents).map_err(senseless)?;
    match rest {
        [] => Ok(value),
        _ => Err(senseless("something follows its contents")),
    }
}

/// A reduced body with the data of its reduction.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StoredBody {
    /// The key of its input.
    pub key: Key,
    /// Its origin, as names and values: source files with their SHA-256, the request, versions, units, mass
    /// rule.
    pub provenance: Vec<(String, String)>,
    /// The data of the runtime.
    pub body: ReducedBody,
    /// Integration rules, with which stresses are recovered.
    pub rules: Rules,
    /// The data of tables.
    pub report: Report,
    /// The mesh in SI, with the markers' nodes and ties.
    pub mesh: Mesh,
    /// Its surface, for pictures.
    pub surface: Surface,
    /// Numbering of the full freedoms.
    pub freedoms: FreedomMap,
    /// Shapes over the full freedoms, one after the other (m, rad per unit of amplitude).
    pub shapes: Vec<f64>,
}

impl StoredBody {
    /// The stored body of a reduction, with its key and provenance. The versions of format and crate and the
    /// rules are added to the provenance.
    pub fn new(
        reduced: Reduced,
        rules: Rules,
        key: Key,
        mut provenance: Vec<(String, String)>,
    ) -> StoredBody {
        let own = [
            ("format", FORMAT_VERSION.to_string()),
            ("eng-flexible", env!("CARGO_PKG_VERSION").into()),
            ("stiffness rule", format!("{:?}", rules.stiffness)),
            ("mass rule", format!("{:?}", rules.mass)),
        ];
        provenance.extend(own.map(|(name, value)| (name.to_string(), value)));
        let surface = Surface::new(&reduced.mesh);
        StoredBody {
            key,
            provenance,
            body: reduced.body,
            rules,
            report: reduced.report,
            mesh: reduced.mesh,
            surface,
            freedoms: reduced.freedoms,
            shapes: reduced.shapes,
        }
    }

    /// The body as the bytes of a file.
    ///
    /// # Errors
    /// Its parts contradict each other: nobody could read the file.
    pub fn to_bytes(&self) -> Result<Vec<u8>, StoreError> {
        self.check()?;
        to_bytes(self)
    }

    /// A body from the bytes of a file.
    ///
    /// # Errors
    /// The bytes are no stored body, have another version, are cut off or altered, or contradict each other.
    pub fn from_bytes(bytes: &[u8]) -> Result<StoredBody, StoreError> {
        let stored: StoredBody = from_bytes(bytes)?;
        stored.check()?;
        Ok(stored)
    }

    fn check(&self) -> Result<(), StoreError> {
        match self.defect() {
            Some(problem) => Err(StoreError::Contents { problem }),
            None => Ok(()),
        }
    }

    /// The first contradiction, if there is one.
    fn defect(&self) -> Option<String> {
        let n = self.body.invariants.modes;
        if let Some(defect) = self.body.invariants.defect() {
            return Some(defect);
        }
        if self.body.frequencies.len() != n {
            return Some(format!(
                "{} frequencies of {n} modes",
                self.body.frequencies.len()
            ));
        }
        let wrong = self.body.markers.iter().find(|marker| {
            [&marker.translation, &marker.rotation]
                .iter()
                .any(|rows| rows.len() != 3 * n || rows.iter().any(|x| !x.is_finite()))
        });
        if let Some(marker) = wrong {
            return Some(format!("the shape rows of the marker {}", marker.name));
        }
        let geometric = self.body.invariants.geometric.iter();
        let known =
            |marker: usize, component: u8| marker < self.body.markers.len() && component < 6;
        if !geometric
            .flat_map(|g| &g.loads)
            .all(|load| known(load.marker, load.component))
        {
            return Some("a load at a marker that is not there".into());
        }
        let nodes = self.mesh.nodes.len();
        if self.freedoms.node_count() != nodes {
            return Some("the numbering of freedoms is another mesh's".into());
        }
        if Some(self.shapes.len()) != n.checked_mul(self.freedoms.size()) {
            return Some("shapes of another size than modes and freedoms".into());
        }
        let surface = &self.surface;
        let indices = surface.triangles().as_flattened().iter();
        let known = indices
            .chain(surface.lines().as_flattened())
            .all(|node| (*node as usize) < nodes);
        let elements = self.mesh.elements.len();
        let owned = surface.elements().len() == surface.triangles().len()
            && surface.elements().iter().all(|e| (*e as usize) < elements);
        (!known || !owned).then(|| "a surface of another mesh".into())
    }
}
