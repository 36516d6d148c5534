//! Values of datasets and attributes.

use super::bytes::Bytes;
use super::{Hdf5, Object, Trouble};

const SPACE: u16 = 0x01;
const TYPE: u16 = 0x03;
const LAYOUT: u16 = 0x08;
const FILTERS: u16 = 0x0b;

/// The type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Type {
    /// A whole number, with or without sign.
    Integer { signed: bool },
    /// A number of IEEE 754.
    Real,
    /// Letters.
    Text,
}

/// Values in the bytes of a file.
#[derive(Clone, Copy, Debug)]
pub(in crate::read) struct Values<'f> {
    kind: Type,
    /// Bytes of a value.
    size: usize,
    /// Whether the most significant byte is the first.
    big: bool,
    bytes: &'f [u8],
}

impl<'f> Values<'f> {
    /// Values of a type, so many in all, that begin with these bytes.
    pub(super) fn new(kind: Bytes<'f>, count: usize, bytes: &'f [u8]) -> Result<Self, Trouble> {
        let (base, times) = element(kind)?;
        let total = count
            .checked_mul(times)
            .and_then(|count| count.checked_mul(base.size))
            .ok_or(Trouble::Cut)?;
        Ok(Values {
            bytes: bytes.get(..total).ok_or(Trouble::Cut)?,
            ..base
        })
    }

    /// The number of values.
    pub fn len(&self) -> usize {
        self.bytes.len() / self.size.max(1)
    }

    /// Whole numbers; `None` for other values, and for a number above 2⁶³.
    pub fn integers(&self) -> Option<Vec<i64>> {
        let Type::Integer { signed } = self.kind else {
            return None;
        };
        let values = self.bytes.chunks_exact(self.size).map(|bytes| {
            let number = self.bits(bytes);
            let unused = 64 - 8 * self.size as u32; // a size up to 8
            match signed {
                true => Some((number << unused) as i64 >> unused),
                false => i64::try_from(number).ok(),
            }
        });
        values.collect()
    }

    /// Real numbers; `None` for other values.
    pub fn reals(&self) -> Option<Vec<f64>> {
        let of = |bytes: &[u8]| match self.size {
            4 => f64::from(f32::from_bits(self.bits(bytes) as u32)), // four bytes
            _ => f64::from_bits(self.bits(bytes)),
        };
        (self.kind == Type::Real).then(|| self.bytes.chunks_exact(self.size).map(of).collect())
    }

    /// The bytes of texts, or of numbers of one byte that stand for letters.
    pub fn letters(&self) -> Option<&'f [u8]> {
        let is_text = self.kind == Type::Text || (self.size == 1 && self.kind != Type::Real);
        is_text.then_some(self.bytes)
    }

    /// The bits of a number of at most eight bytes.
    fn bits(&self, bytes: &[u8]) -> u64 {
        let joined = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        match self.big {
            true => bytes.iter().fold(0, joined),
            false => bytes.iter().rev().fold(0, joined),
        }
    }
}

/// The type of a value, and how many of them an array has, which is one value of HDF5.
fn element(mut at: Bytes<'_>) -> Result<(Values<'_>, usize), Trouble> {
    let class = at.byte()?;
    let flags = at.byte()?;
    at.skip(2)?;
    let size = at.count(4)?;
    let kind = match class & 0xf {
        0 if (1..=8).contains(&size) => Type::Integer {
            signed: flags & 8 != 0,
        },
        1 if [4, 8].contains(&size) && flags & 0x40 == 0 => Type::Real,
        3 => Type::Text,
        10 => {
            let rank = usize::from(at.byte()?);
            let old = class >> 4 < 3;
            at.skip(if old { 3 } else { 0 })?;
            let mut times = 1_usize;
            for _ in 0..rank {
                times = times.checked_mul(at.count(4)?).ok_or(Trouble::Cut)?;
            }
            at.skip(if old { 4 * rank } else { 0 })?;
            // an array of arrays does not occur
            if at.0.first().is_some_and(|class| class & 0xf == 10) {
                return Err(Trouble::NotRead("it has arrays of arrays"));
            }
            let (base, _) = element(at)?;
            return Ok((base, times));
        }
        _ => {
            return Err(Trouble::NotRead(
                "it has values that are neither numbers nor letters",
            ));
        }
    };
    let values = Values {
        kind,
        size,
        big: flags & 1 != 0,
        bytes: &[],
    };
    Ok((values, 1))
}

impl<'f> Hdf5<'f> {
    /// The number of values of a dataspace: 1 for a scalar, 0 for one without values.
    pub(super) fn counts(&self, mut at: Bytes<'f>) -> Result<usize, Trouble> {
        let version = at.byte()?;
        let rank = at.byte()?;
        at.skip(1)?;
        let kind = at.byte()?;
        match version {
            1 => at.skip(4)?,
            2 if kind == 2 => return Ok(0),
            2 => {}
            _ => return Err(Trouble::Damaged("a dataspace has no version 1 or 2")),
        }
        let mut count = 1_usize;
        for _ in 0..rank {
            count = count
                .checked_mul(at.count(self.length)?)
                .ok_or(Trouble::Cut)?;
        }
        Ok(count)
    }

    /// The values of a dataset; `None` for a group.
    pub fn values(&self, object: &Object<'f>) -> Result<Option<Values<'f>>, Trouble> {
        let (Some(kind), Some(space)) = (object.one(TYPE)?, object.one(SPACE)?) else {
            return Ok(None);
        };
        let Some(mut at) = object.one(LAYOUT)? else {
            return Ok(None);
        };
        let apart = Trouble::NotRead("it has datasets in compressed or separate pieces");
        if object.all(FILTERS).next().is_some() {
            return Err(apart);
        }
        let count = self.counts(space)?;
        let version = at.byte()?;
        let (class, data) = match version {
            1 | 2 => {
                at.skip(1)?;
                let class = at.byte()?;
                at.skip(5)?;
                (class, None)
            }
            3 | 4 => match at.byte()? {
                0 => {
                    let size = at.count(2)?;
                    (0, Some(at.take(size)?))
                }
                class => (class, None),
            },
            _ => return Err(Trouble::Damaged("a layout has no version 1 to 4")),
        };
        let data = match (class, data) {
            (0, Some(data)) => data,
            // a dataset without values may have no place
            (1, None) => match self.address(&mut at)? {
                Some(address) => self.at(address)?.0,
                None if count == 0 => &[],
                None => return Err(Trouble::Damaged("a dataset has no values")),
            },
            _ => return Err(apart),
        };
        let values = Values::new(kind, count, data)?;
        self.count_values(values.bytes.len())?;
        Ok(Some(values))
    }
}
