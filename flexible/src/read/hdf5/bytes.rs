//! Numbers in bytes.

use super::Trouble;

/// Bytes that are read from their beginning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bytes<'f>(pub &'f [u8]);

impl<'f> Bytes<'f> {
    /// The next bytes.
    pub fn take(&mut self, count: usize) -> Result<&'f [u8], Trouble> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(Trouble::Cut)?;
        self.0 = rest;
        Ok(taken)
    }

    /// Skips bytes.
    pub fn skip(&mut self, count: usize) -> Result<(), Trouble> {
        self.take(count).map(|_| ())
    }

    /// A whole number of so many bytes, at most eight, the least significant first.
    pub fn number(&mut self, bytes: usize) -> Result<u64, Trouble> {
        let taken = self.take(bytes)?;
        if bytes > 8 {
            return Err(Trouble::NotRead("it has numbers of more than eight bytes"));
        }
        Ok(taken
            .iter()
            .rev()
            .fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }

    /// The same as a count of bytes or values in memory.
    pub fn count(&mut self, bytes: usize) -> Result<usize, Trouble> {
        usize::try_from(self.number(bytes)?).map_err(|_| Trouble::Cut)
    }

    /// One byte.
    pub fn byte(&mut self) -> Result<u8, Trouble> {
        Ok(self.take(1)?.first().copied().unwrap_or(0))
    }

    /// The letters that begin a block.
    pub fn letters(&mut self, wanted: &[u8; 4]) -> Result<(), Trouble> {
        match self.take(4)? == wanted {
            true => Ok(()),
            false => Err(Trouble::Damaged("a block does not begin with its letters")),
        }
    }
}

/// The bytes that hold any number up to this one.
pub(super) fn bytes_up_to(number: u64) -> usize {
    (number.max(1).ilog2() / 8 + 1) as usize // at most 8
}
