//! Links: the members of a group, by name.

use super::bytes::Bytes;
use super::{Hdf5, Object, Trouble};

const LINK_INFO: u16 = 0x02;
const LINK: u16 = 0x06;
const SYMBOL_TABLE: u16 = 0x11;

/// The type of a tree of links by name. Four bytes of a record before the place in the heap are the hash of the name.
const LINKS_BY_NAME: (u8, usize) = (5, 4);

/// Most bytes of a name. Those of MED have 64; without a limit, names that overlap would ask for much memory.
const LONGEST: usize = 1024;

/// A name and the address of an object.
pub(in crate::read) type Link<'f> = (&'f [u8], u64);

impl<'f> Hdf5<'f> {
    /// The members of a group, sorted by name. Links to names, in this or in another file, are left out.
    pub fn links(&self, group: &Object<'f>) -> Result<Vec<Link<'f>>, Trouble> {
        let mut links = Vec::new();
        for message in group.all(LINK) {
            links.extend(self.link(message)?);
        }
        for message in group.all(LINK_INFO) {
            for message in self.kept_apart(message, 8, LINKS_BY_NAME)? {
                links.extend(self.link(message)?);
            }
        }
        for mut message in group.all(SYMBOL_TABLE) {
            let (tree, heap) = (message.number(self.offset)?, message.number(self.offset)?);
            let names = self.names(heap)?;
            self.symbols(tree, None, names, &mut links)?;
        }
        links.sort_unstable();
        if links
            .windows(2)
            .any(|pair| matches!(pair, [(a, _), (b, _)] if a == b))
        {
            return Err(Trouble::Damaged("two members of a group have one name"));
        }
        Ok(links)
    }

    /// A link; `None` if it leads to a name.
    fn link(&self, mut at: Bytes<'f>) -> Result<Option<Link<'f>>, Trouble> {
        if at.byte()? != 1 {
            return Err(Trouble::Damaged("a link has no version 1"));
        }
        let flags = at.byte()?;
        let kind = if flags & 8 != 0 { at.byte()? } else { 0 };
        at.skip(if flags & 4 != 0 { 8 } else { 0 })?;
        at.skip(if flags & 0x10 != 0 { 1 } else { 0 })?;
        let length = at.count(1 << (flags & 3))?;
        if length > LONGEST {
            return Err(Trouble::Damaged("a name has no end"));
        }
        let name = at.take(length)?;
        match kind {
            0 => Ok(Some((name, at.number(self.offset)?))),
            _ => Ok(None),
        }
    }

    /// The names of a group of the old form.
    fn names(&self, heap: u64) -> Result<&'f [u8], Trouble> {
        let mut at = self.at(heap)?;
        at.letters(b"HEAP")?;
        at.skip(4)?;
        let size = at.count(self.length)?;
        at.skip(self.length)?;
        let data = at.number(self.offset)?;
        self.at(data)?.take(size)
    }

    /// The links of a node of a tree of the old form, which must have the stated level.
    fn symbols(
        &self,
        address: u64,
        level: Option<u8>,
        names: &'f [u8],
        links: &mut Vec<Link<'f>>,
    ) -> Result<(), Trouble> {
        let mut at = self.at(address)?;
        at.letters(b"TREE")?;
        let (kind, own) = (at.byte()?, at.byte()?);
        // a tree of 16 levels has 32 children at each, more than any file
        if kind != 0 || own > 16 || level.is_some_and(|level| level != own) {
            return Err(Trouble::Damaged("a tree of names has a wrong level"));
        }
        let entries = at.number(2)?;
        at.skip(2 * self.offset)?;
        for _ in 0..entries {
            at.skip(self.length)?;
            let child = at.number(self.offset)?;
            match own.checked_sub(1) {
                Some(below) => self.symbols(child, Some(below), names, links)?,
                None => self.symbol_node(child, names, links)?,
            }
        }
        Ok(())
    }

    fn symbol_node(
        &self,
        address: u64,
        names: &'f [u8],
        links: &mut Vec<Link<'f>>,
    ) -> Result<(), Trouble> {
        let mut at = self.at(address)?;
        at.letters(b"SNOD")?;
        at.skip(2)?;
        for _ in 0..at.number(2)? {
            self.spend()?;
            let name = at.count(self.length)?;
            let object = at.number(self.offset)?;
            let kind = at.number(4)?;
            at.skip(20)?;
            let name = names.get(name..).ok_or(Trouble::Cut)?;
            let name = name.get(..LONGEST).unwrap_or(name);
            let end = name.iter().position(|byte| *byte == 0);
            let end = end.ok_or(Trouble::Damaged("a name has no end"))?;
            let name = name.get(..end).unwrap_or(&[]);
            // a link to a name
            if kind != 2 {
                links.push((name, object));
            }
        }
        Ok(())
    }
}
