//! Fractal heaps, which keep the links or attributes of an object that has many of them.

use super::bytes::{Bytes, bytes_up_to};
use super::{Hdf5, Trouble};

/// A heap. Its blocks are in rows of one size each: the first two rows have the smallest blocks, and each further row has
/// blocks twice as large as the row before.
#[derive(Debug)]
pub(super) struct Heap {
    /// Bytes of an object's place and of its length.
    place: usize,
    size: usize,
    /// Blocks of a row.
    width: u64,
    /// Bytes of the smallest block.
    smallest: u64,
    /// Rows whose blocks hold objects. Blocks of further rows hold addresses of blocks.
    direct_rows: u64,
    root: u64,
    /// Rows of the root; 0 if it holds objects.
    rows: u64,
}

impl Heap {
    /// Bytes of a block of a row.
    fn block(&self, row: u64) -> Result<u64, Trouble> {
        let doubled = u32::try_from(row.saturating_sub(1)).ok();
        let size = doubled.and_then(|power| self.smallest.checked_mul(2_u64.checked_pow(power)?));
        size.ok_or(Trouble::Damaged("a heap has more rows than addresses"))
    }
}

impl<'f> Hdf5<'f> {
    /// The heap at an address.
    pub(super) fn heap(&self, address: u64) -> Result<Heap, Trouble> {
        let mut at = self.at(address)?;
        at.letters(b"FRHP")?;
        at.skip(3)?;
        let filters = at.number(2)?;
        if filters != 0 {
            return Err(Trouble::NotRead("it has compressed names"));
        }
        at.skip(1)?;
        let largest_object = at.number(4)?;
        at.skip(10 * self.length + 2 * self.offset)?;
        let width = at.number(2)?;
        let (smallest, largest) = (at.number(self.length)?, at.number(self.length)?);
        let bits = at.count(2)?;
        at.skip(2)?;
        let root = at.number(self.offset)?;
        let rows = at.number(2)?;
        let sizes = smallest.is_power_of_two() && largest.is_power_of_two() && smallest <= largest;
        if !sizes || width == 0 || bits > 64 {
            return Err(Trouble::Damaged("a heap of names has wrong sizes"));
        }
        Ok(Heap {
            place: bits.div_ceil(8),
            size: bytes_up_to(largest).min(bytes_up_to(largest_object)),
            width,
            smallest,
            direct_rows: u64::from(largest.ilog2() - smallest.ilog2()) + 2,
            root,
            rows,
        })
    }

    /// The object of a heap that a record names.
    pub(super) fn in_heap(&self, heap: &Heap, mut record: Bytes<'f>) -> Result<Bytes<'f>, Trouble> {
        let kind = record.byte()?;
        if kind >> 4 != 0 {
            return Err(Trouble::NotRead(
                "it has names in a form other than that of MED",
            ));
        }
        let place = record.number(heap.place)?;
        let size = record.count(heap.size)?;
        let (block, inside) = self.block_of(heap, place)?;
        let mut at = self.at(block)?;
        at.skip(usize::try_from(inside).map_err(|_| Trouble::Cut)?)?;
        Ok(Bytes(at.take(size)?))
    }

    /// The address of the block that holds a place of a heap, and the place inside it.
    fn block_of(&self, heap: &Heap, place: u64) -> Result<(u64, u64), Trouble> {
        let (mut block, mut rows, mut start) = (heap.root, heap.rows, 0);
        while rows > 0 {
            let mut at = self.at(block)?;
            at.letters(b"FHIB")?;
            at.skip(1 + self.offset + heap.place)?;
            let (row, size) = self.row_of(heap, rows, place, &mut start)?;
            let column = (place - start) / size;
            start += column * size;
            let before = (row * heap.width + column).checked_mul(self.offset as u64);
            let before = before.and_then(|bytes| usize::try_from(bytes).ok());
            at.skip(before.ok_or(Trouble::Cut)?)?;
            block = at.number(self.offset)?;
            rows = match row < heap.direct_rows {
                true => 0,
                // a block of blocks is as large as all of its rows
                false => {
                    let first = heap.smallest.saturating_mul(heap.width).max(1);
                    u64::from((size / first).max(1).ilog2()) + 1
                }
            };
        }
        Ok((block, place - start))
    }

    /// The row of a block of blocks in which a place is, and the size of its blocks. `start` is the place of the first row, and
    /// becomes that of the found row.
    fn row_of(
        &self,
        heap: &Heap,
        rows: u64,
        place: u64,
        start: &mut u64,
    ) -> Result<(u64, u64), Trouble> {
        for row in 0..rows {
            let size = heap.block(row)?;
            let end = size
                .checked_mul(heap.width)
                .and_then(|all| start.checked_add(all))
                .ok_or(Trouble::Cut)?;
            if place < end {
                return Ok((row, size));
            }
            *start = end;
        }
        Err(Trouble::Damaged("a name is outside of its heap"))
    }
}
