//! Objects: groups and datasets, as the messages of their headers.

use super::bytes::Bytes;
use super::{Hdf5, Trouble};

/// A message of a header.
#[derive(Clone, Copy, Debug)]
pub(super) struct Message<'f> {
    /// Its type.
    pub kind: u16,
    /// Whether its contents are elsewhere.
    pub shared: bool,
    /// Its contents.
    pub data: Bytes<'f>,
}

/// A group or a dataset.
#[derive(Clone, Debug)]
pub(in crate::read) struct Object<'f> {
    pub(super) messages: Vec<Message<'f>>,
}

/// The message that continues a header in another block.
const CONTINUATION: u16 = 0x10;

impl<'f> Hdf5<'f> {
    /// The root group.
    pub fn root(&self) -> Result<Object<'f>, Trouble> {
        self.object(self.root_address())
    }

    /// The object at an address.
    pub fn object(&self, address: u64) -> Result<Object<'f>, Trouble> {
        let mut at = self.at(address)?;
        match at.0.starts_with(b"OHDR") {
            true => self.new_header(&mut at),
            false => self.old_header(&mut at),
        }
    }

    /// Version 1: messages of eight bytes of head.
    fn old_header(&self, at: &mut Bytes<'f>) -> Result<Object<'f>, Trouble> {
        if at.byte()? != 1 {
            return Err(Trouble::Damaged(
                "a header of an object has no version 1 or 2",
            ));
        }
        at.skip(1)?;
        let mut left = at.number(2)?;
        at.skip(4)?;
        let size = at.count(4)?;
        at.skip(4)?;
        let mut blocks = vec![Bytes(at.take(size)?)];
        let mut messages = Vec::new();
        while let Some(mut block) = blocks.pop() {
            while block.0.len() >= 8 && left > 0 {
                self.spend()?;
                left -= 1;
                let (kind, size) = (block.number(2)? as u16, block.count(2)?); // two bytes
                let flags = block.byte()?;
                block.skip(3)?;
                let data = Bytes(block.take(size)?);
                match kind {
                    CONTINUATION => blocks.push(Bytes(self.continuation(data)?)),
                    _ => messages.push(Message {
                        kind,
                        shared: flags & 2 != 0,
                        data,
                    }),
                }
            }
        }
        Ok(Object { messages })
    }

    /// Version 2: messages of four bytes of head, and two more for the order of their creation.
    fn new_header(&self, at: &mut Bytes<'f>) -> Result<Object<'f>, Trouble> {
        at.letters(b"OHDR")?;
        if at.byte()? != 2 {
            return Err(Trouble::Damaged(
                "a header of an object has no version 1 or 2",
            ));
        }
        let flags = at.byte()?;
        at.skip(if flags & 0x20 != 0 { 16 } else { 0 })?;
        at.skip(if flags & 0x10 != 0 { 4 } else { 0 })?;
        let size = at.count(1 << (flags & 3))?;
        let order = if flags & 4 != 0 { 2 } else { 0 };
        let mut blocks = vec![Bytes(at.take(size)?)];
        let mut messages = Vec::new();
        while let Some(mut block) = blocks.pop() {
            while block.0.len() >= 4 + order {
                self.spend()?;
                let (kind, size) = (u16::from(block.byte()?), block.count(2)?);
                let flags = block.byte()?;
                block.skip(order)?;
                let data = Bytes(block.take(size)?);
                match kind {
                    CONTINUATION => {
                        let mut next = Bytes(self.continuation(data)?);
                        next.letters(b"OCHK")?;
                        // a checksum ends the block
                        let messages = next.0.len().checked_sub(4).ok_or(Trouble::Cut)?;
                        blocks.push(Bytes(next.take(messages)?));
                    }
                    _ => messages.push(Message {
                        kind,
                        shared: flags & 2 != 0,
                        data,
                    }),
                }
            }
        }
        Ok(Object { messages })
    }

    /// The block that a message names by address and length.
    fn continuation(&self, mut data: Bytes<'f>) -> Result<&'f [u8], Trouble> {
        let address = data.number(self.offset)?;
        let length = data.count(self.length)?;
        self.at(address)?.take(length)
    }
}

impl<'f> Object<'f> {
    /// The messages of a type.
    pub(super) fn all(&self, kind: u16) -> impl Iterator<Item = Bytes<'f>> {
        let found = self.messages.iter().filter(move |m| m.kind == kind);
        found.map(|message| message.data)
    }

    /// The message of a type. Its contents must be its own.
    pub(super) fn one(&self, kind: u16) -> Result<Option<Bytes<'f>>, Trouble> {
        match self.messages.iter().find(|message| message.kind == kind) {
            None => Ok(None),
            Some(Message { shared: true, .. }) => {
                Err(Trouble::NotRead("it has types that several datasets share"))
            }
            Some(message) => Ok(Some(message.data)),
        }
    }
}
