//! A state of an FMU that its importer keeps.

use super::slave::Phase;
use crate::edge::Refused;
use serde::{Deserialize, Serialize};

/// The first bytes of a serialised state.
const MARK: &[u8; 8] = b"engfmu01";

/// A state of an FMU.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// The FMU that it belongs to.
    pub(super) token: String,
    pub(super) phase: Phase,
    /// Values that the importer has set, by value reference.
    pub(super) stated: Vec<Option<f64>>,
    /// The set values with which the simulation began, by value reference.
    pub(super) begun: Vec<Option<f64>>,
    /// The state of the simulation, once it has started.
    pub(super) checkpoint: Option<Vec<u8>>,
}

impl Saved {
    /// The state as bytes.
    pub fn bytes(&self) -> Result<Vec<u8>, Refused> {
        postcard::to_extend(self, MARK.to_vec())
            .map_err(|error| Refused(format!("the state has no bytes: {error}")))
    }

    /// The state of bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Saved, Refused> {
        let rest = bytes.strip_prefix(MARK).ok_or_else(|| {
            Refused::new("the bytes are no state of an FMU of this version of Eng")
        })?;
        let read = postcard::take_from_bytes(rest);
        let (saved, left) =
            read.map_err(|error| Refused(format!("the bytes of the state are damaged: {error}")))?;
        match left {
            [] => Ok(saved),
            _ => Err(Refused::new(
                "the bytes of the state are damaged: they are too many",
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_give_the_state_back() {
        let saved = Saved {
            token: "a".to_owned(),
            phase: Phase::Stepping,
            stated: vec![None, Some(-0.0), Some(1e-308)],
            begun: vec![None, None, Some(f64::MAX)],
            checkpoint: Some(vec![1, 2, 3]),
        };
        let bytes = saved.bytes().expect("bytes");
        assert_eq!(Saved::from_bytes(&bytes).expect("the state"), saved);
        for length in 0..bytes.len() {
            assert!(Saved::from_bytes(&bytes[..length]).is_err(), "{length}");
        }
        let longer = [bytes.as_slice(), &[0]].concat();
        assert!(Saved::from_bytes(&longer).is_err());
    }
}
