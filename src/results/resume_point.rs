//! The point where an interrupted analysis continues: the runtime's state, the number of earlier samples, the
//! warnings.
//!
//! The file: `ENGRUN` and the version of the format (a byte), the length of the description (8 bytes,
//! little-endian), the description as JSON, the runtime's checkpoint, and the SHA-256 of all of these.

use super::file::refuse_link;
use super::{ResultsError, replace_file};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::io::{self, Write};
use std::path::Path;

/// First bytes of the file: a name, and the version of the format.
const MAGIC: &[u8; 7] = b"ENGRUN\x01";
/// Bytes of the SHA-256 sum at the end of the file.
const SUM: usize = 32;

/// A warning from before the interruption.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeptWarning {
    /// Path of the element.
    pub path: String,
    /// The user's line: source, first byte, one past the last byte.
    pub used_at: Option<(u32, u32, u32)>,
    /// The class's line.
    pub defined_at: Option<(u32, u32, u32)>,
    /// The name with which a text accepts it.
    pub name: String,
    /// The author's message.
    pub message: String,
    /// Bits of the time (s), so that reading gives exactly the same number.
    pub time: u64,
    /// Bits of the cycle angle (rad).
    pub cycle_angle: Option<u64>,
}

/// The contents of a checkpoint file.
#[derive(Clone, Debug, PartialEq)]
pub struct ResumePoint {
    /// The identity of the run: texts, parameters, plan, channels, version.
    pub identity: String,
    /// Number of samples before the checkpoint.
    pub samples: u64,
    /// Warnings before the checkpoint.
    pub warnings: Vec<KeptWarning>,
    /// The runtime's checkpoint.
    pub state: Vec<u8>,
}

#[derive(Serialize, Deserialize)]
struct Description {
    identity: String,
    samples: u64,
    warnings: Vec<KeptWarning>,
}

impl ResumePoint {
    /// Replaces the file. A whole file exists at every moment.
    pub fn write(&self, path: &Path) -> Result<(), ResultsError> {
        let refused = |source| ResultsError::File {
            path: path.to_owned(),
            source,
        };
        refuse_link(path).map_err(refused)?;
        replace_file(path, |file| -> io::Result<()> {
            let description = serde_json::to_vec(&Description {
                identity: self.identity.clone(),
                samples: self.samples,
                warnings: self.warnings.clone(),
            })?;
            let mut bytes = MAGIC.to_vec();
            bytes.extend((description.len() as u64).to_le_bytes());
            bytes.extend(description);
            bytes.extend(&self.state);
            let sum = Sha256::digest(&bytes);
            bytes.extend(sum.iter());
            file.write_all(&bytes)
        })
        .map_err(refused)
    }

    /// Reads a file of [`ResumePoint::write`]; `None` if there is no file.
    pub fn read(path: &Path) -> Result<Option<ResumePoint>, ResultsError> {
        let bytes = match crate::regular::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => {
                return Err(ResultsError::File {
                    path: path.to_owned(),
                    source,
                });
            }
        };
        match parse(&bytes) {
            Some(point) => Ok(Some(point)),
            None => Err(ResultsError::Foreign {
                path: path.to_owned(),
                message:
                    "this checkpoint is damaged or of another version; run again without --resume"
                        .to_owned(),
            }),
        }
    }
}

/// The contents of a file; `None` if it is damaged or of another version.
pub fn parse(bytes: &[u8]) -> Option<ResumePoint> {
    let (content, sum) = bytes.split_at_checked(bytes.len().checked_sub(SUM)?)?;
    if Sha256::digest(content).as_slice() != sum {
        return None;
    }
    let rest = content.strip_prefix(MAGIC)?;
    let (length, rest) = rest.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (description, state) = rest.split_at_checked(length)?;
    let Description {
        identity,
        samples,
        warnings,
    } = serde_json::from_slice(description).ok()?;
    Some(ResumePoint {
        identity,
        samples,
        warnings,
        state: state.to_vec(),
    })
}
