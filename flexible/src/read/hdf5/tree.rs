//! Trees of records of the second version, which find the links or attributes of an object that has many of them.

use super::bytes::{Bytes, bytes_up_to};
use super::{Hdf5, Trouble};

/// Bytes of a node beside its records: letters, version, type, checksum.
const FRAME: usize = 10;

/// A tree: its type, bytes of a record, and for each level above the leaves the bytes of the two counts of a child.
#[derive(Debug)]
struct Tree {
    kind: u8,
    record: usize,
    own: usize,
    below: Vec<usize>,
}

impl<'f> Hdf5<'f> {
    /// The links or attributes that an object keeps in a heap. Their message has flags, an order of creation of so many bytes
    /// if the first flag is set, the addresses of heap and tree. Of each record of the tree, the place in the heap begins
    /// after so many bytes.
    pub(super) fn kept_apart(
        &self,
        mut message: Bytes<'f>,
        order: usize,
        (kind, before): (u8, usize),
    ) -> Result<Vec<Bytes<'f>>, Trouble> {
        message.skip(1)?;
        let flags = message.byte()?;
        message.skip(if flags & 1 != 0 { order } else { 0 })?;
        let (heap, tree) = (self.address(&mut message)?, self.address(&mut message)?);
        let (Some(heap), Some(tree)) = (heap, tree) else {
            return Ok(Vec::new());
        };
        let heap = self.heap(heap)?;
        let mut found = Vec::new();
        for mut record in self.records(tree, kind)? {
            record.skip(before)?;
            found.push(self.in_heap(&heap, record)?);
        }
        Ok(found)
    }

    /// All records of a tree of a type.
    fn records(&self, address: u64, kind: u8) -> Result<Vec<Bytes<'f>>, Trouble> {
        let mut at = self.at(address)?;
        at.letters(b"BTHD")?;
        at.skip(1)?;
        let own_kind = at.byte()?;
        let (node, record, depth) = (at.count(4)?, at.count(2)?, at.number(2)?);
        at.skip(2)?;
        let root = self.address(&mut at)?;
        let count = at.number(2)?;
        if own_kind != kind || record == 0 || depth > 16 {
            return Err(Trouble::Damaged(
                "a tree of names has a wrong type or depth",
            ));
        }
        let leaf = node.checked_sub(FRAME).ok_or(Trouble::Cut)? / record;
        let own = bytes_up_to(leaf as u64);
        // the most records below a node of each level decide the size of their count
        let (mut most, mut below) = (leaf as u64, vec![0]);
        for _ in 1..depth {
            let pointer = self.offset + own + below.last().copied().unwrap_or(0);
            let records = (node - FRAME).saturating_sub(pointer) / (record + pointer);
            let children = (records as u64).saturating_add(1);
            most = children.saturating_mul(most).saturating_add(records as u64);
            below.push(bytes_up_to(most));
        }
        let tree = Tree {
            kind,
            record,
            own,
            below,
        };
        let mut found = Vec::new();
        if let Some(root) = root {
            self.node(&tree, (root, count), depth as usize, &mut found)?; // at most 16
        }
        Ok(found)
    }

    /// The records of a node at an address with so many records, and those below it.
    fn node(
        &self,
        tree: &Tree,
        (address, count): (u64, u64),
        depth: usize,
        found: &mut Vec<Bytes<'f>>,
    ) -> Result<(), Trouble> {
        let mut at = self.at(address)?;
        at.letters(if depth == 0 { b"BTLF" } else { b"BTIN" })?;
        at.skip(1)?;
        if at.byte()? != tree.kind {
            return Err(Trouble::Damaged("a node of a tree has another type"));
        }
        for _ in 0..count {
            self.spend()?;
            found.push(Bytes(at.take(tree.record)?));
        }
        let Some(above) = depth.checked_sub(1) else {
            return Ok(());
        };
        let total = tree.below.get(above).copied().unwrap_or(0);
        for _ in 0..=count {
            let child = (at.number(self.offset)?, at.number(tree.own)?);
            at.skip(total)?;
            self.node(tree, child, above, found)?;
        }
        Ok(())
    }
}
