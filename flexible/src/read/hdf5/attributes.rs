//! Attributes: small values of an object, by name.

use super::bytes::Bytes;
use super::{Hdf5, Object, Trouble, Values};

const ATTRIBUTE: u16 = 0x0c;
const ATTRIBUTE_INFO: u16 = 0x15;

/// The type of a tree of attributes by name. A record begins with the place in the heap.
const ATTRIBUTES_BY_NAME: (u8, usize) = (8, 0);

impl<'f> Hdf5<'f> {
    /// An attribute of an object; `None` without it.
    pub fn attribute(
        &self,
        object: &Object<'f>,
        name: &[u8],
    ) -> Result<Option<Values<'f>>, Trouble> {
        for message in object.all(ATTRIBUTE) {
            if let Some(found) = self.named(message, name)? {
                return Ok(Some(found));
            }
        }
        for message in object.all(ATTRIBUTE_INFO) {
            for message in self.kept_apart(message, 2, ATTRIBUTES_BY_NAME)? {
                if let Some(found) = self.named(message, name)? {
                    return Ok(Some(found));
                }
            }
        }
        Ok(None)
    }

    /// The value of an attribute if it has this name.
    fn named(&self, mut at: Bytes<'f>, wanted: &[u8]) -> Result<Option<Values<'f>>, Trouble> {
        self.spend()?;
        let version = at.byte()?;
        let flags = at.byte()?;
        let sizes = [at.count(2)?, at.count(2)?, at.count(2)?];
        at.skip(if version == 3 { 1 } else { 0 })?;
        let mut parts = [&[][..]; 3];
        for (part, size) in parts.iter_mut().zip(sizes) {
            *part = at.take(size)?;
            if version == 1 {
                at.skip(size.next_multiple_of(8) - size)?;
            }
        }
        let [name, kind, space] = parts;
        let name = name.strip_suffix(&[0]).unwrap_or(name);
        if name != wanted {
            return Ok(None);
        }
        match version {
            1..=3 if version == 1 || flags & 3 == 0 => {}
            1..=3 => {
                return Err(Trouble::NotRead(
                    "it has types that several attributes share",
                ));
            }
            _ => return Err(Trouble::Damaged("an attribute has no version 1, 2 or 3")),
        }
        Values::new(Bytes(kind), self.counts(Bytes(space))?, at.0).map(Some)
    }
}
