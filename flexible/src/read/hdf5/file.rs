//! A file: the superblock, and blocks at addresses.

use std::cell::Cell;

use super::Trouble;
use super::bytes::Bytes;

/// The first bytes of a file of HDF5.
pub(in crate::read) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// A file.
#[derive(Debug)]
pub(in crate::read) struct Hdf5<'f> {
    bytes: &'f [u8],
    /// Bytes of an address.
    pub(super) offset: usize,
    /// Bytes of a length.
    pub(super) length: usize,
    /// Address to which all others are relative.
    base: u64,
    root: u64,
    /// Blocks and messages that may still be read. A damaged file may lead in a circle.
    left: Cell<usize>,
    /// Bytes of values that may still be read. The datasets of a sound file share none.
    unread: Cell<usize>,
}

impl<'f> Hdf5<'f> {
    /// Reads the superblock.
    ///
    /// # Errors
    /// Bytes that are no file of HDF5, one of a version after 3, or one that is longer by its own statement.
    pub fn open(bytes: &'f [u8]) -> Result<Self, Trouble> {
        let mut at = Bytes(bytes);
        if at.take(SIGNATURE.len())? != SIGNATURE {
            return Err(Trouble::Damaged("it does not begin as HDF5 data"));
        }
        let version = at.byte()?;
        match version {
            0 | 1 => at.skip(4)?,
            2 | 3 => {}
            _ => return Err(Trouble::NotRead("it has a superblock after version 3")),
        }
        let (offset, length) = (usize::from(at.byte()?), usize::from(at.byte()?));
        if ![2, 4, 8].contains(&offset) || ![2, 4, 8].contains(&length) {
            return Err(Trouble::Damaged(
                "addresses have no size of 2, 4 or 8 bytes",
            ));
        }
        at.skip(match version {
            0 => 9,
            1 => 13,
            _ => 1,
        })?;
        let base = at.number(offset)?;
        // the address of the extension or of free space
        at.skip(offset)?;
        let end = at.number(offset)?;
        if base
            .checked_add(end)
            .is_none_or(|end| end > bytes.len() as u64)
        {
            return Err(Trouble::Cut);
        }
        if version < 2 {
            // the address of the driver, then the place of the name of the root, which the library writes as a length
            at.skip(offset + length)?;
        }
        let root = at.number(offset)?;
        Ok(Hdf5 {
            bytes,
            offset,
            length,
            base,
            root,
            left: Cell::new(bytes.len() / 2 + 1000),
            // a dataset may be read a few times
            unread: Cell::new(bytes.len().saturating_mul(4)),
        })
    }

    /// The address of the root group.
    pub(super) fn root_address(&self) -> u64 {
        self.root
    }

    /// Counts bytes of values.
    ///
    /// # Errors
    /// More bytes than datasets without shared values have. Their numbers would take more memory than a multiple of the file.
    pub(super) fn count_values(&self, bytes: usize) -> Result<(), Trouble> {
        let left = self.unread.get().checked_sub(bytes);
        self.unread
            .set(left.ok_or(Trouble::Damaged("its datasets share their values"))?);
        Ok(())
    }

    /// The bytes of the file from an address on.
    pub(super) fn at(&self, address: u64) -> Result<Bytes<'f>, Trouble> {
        self.spend()?;
        let place = self.base.checked_add(address).ok_or(Trouble::Cut)?;
        let place = usize::try_from(place).map_err(|_| Trouble::Cut)?;
        self.bytes.get(place..).map(Bytes).ok_or(Trouble::Cut)
    }

    /// Counts a block or message.
    pub(super) fn spend(&self) -> Result<(), Trouble> {
        let left = self.left.get().checked_sub(1);
        self.left
            .set(left.ok_or(Trouble::Damaged("its blocks lead in a circle"))?);
        Ok(())
    }

    /// An address; `None` if it is that of nothing.
    pub(super) fn address(&self, at: &mut Bytes<'f>) -> Result<Option<u64>, Trouble> {
        let address = at.number(self.offset)?;
        let nothing = u64::MAX >> (64 - 8 * self.offset);
        Ok(Some(address).filter(|address| *address != nothing))
    }
}
