//! How values become bytes: little-endian, in the order of fields, lists after their length. Reading asks for every byte and
//! never takes more room than the bytes that are there can fill.

use super::StoreError;

/// What a file's bytes are read from.
#[derive(Debug)]
pub(super) struct Source<'a> {
    bytes: &'a [u8],
    /// Where it stands.
    at: usize,
}

impl<'a> Source<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Source { bytes, at: 0 }
    }

    /// How many bytes are left.
    pub(super) fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }

    /// The next so many bytes.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], StoreError> {
        let found = self
            .at
            .checked_add(count)
            .and_then(|end| self.bytes.get(self.at..end));
        match found {
            Some(bytes) => {
                self.at += count;
                Ok(bytes)
            }
            None => Err(self.senseless("it ends in the middle of a value")),
        }
    }

    /// The error for what makes no sense here.
    pub(super) fn senseless(&self, what: &str) -> StoreError {
        StoreError::Contents {
            byte: self.at,
            problem: what.into(),
        }
    }
}

/// A value that can be written and read.
pub(super) trait Stored: Sized {
    /// The fewest bytes that one takes: a list's claimed length is checked against it.
    const LEAST: usize;
    fn write(&self, out: &mut Vec<u8>);
    fn read(source: &mut Source) -> Result<Self, StoreError>;
}

macro_rules! number {
    ($($kind:ty),*) => {$(
        impl Stored for $kind {
            const LEAST: usize = size_of::<$kind>();
            fn write(&self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
            fn read(source: &mut Source) -> Result<Self, StoreError> {
                let mut bytes = [0; size_of::<$kind>()];
                bytes.copy_from_slice(source.take(size_of::<$kind>())?);
                Ok(<$kind>::from_le_bytes(bytes))
            }
        }
    )*};
}
number!(u8, u32, u64, f64);

impl Stored for usize {
    const LEAST: usize = 8;
    fn write(&self, out: &mut Vec<u8>) {
        (*self as u64).write(out);
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        usize::try_from(u64::read(source)?)
            .map_err(|_| source.senseless("a count is too large for this machine"))
    }
}

impl Stored for bool {
    const LEAST: usize = 1;
    fn write(&self, out: &mut Vec<u8>) {
        u8::from(*self).write(out);
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        match u8::read(source)? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(source.senseless("a mark is neither yes nor no")),
        }
    }
}

impl Stored for String {
    const LEAST: usize = 8;
    fn write(&self, out: &mut Vec<u8>) {
        self.len().write(out);
        out.extend_from_slice(self.as_bytes());
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        let length = usize::read(source)?;
        let bytes = source.take(length)?;
        match std::str::from_utf8(bytes) {
            Ok(text) => Ok(text.into()),
            Err(_) => Err(source.senseless("a name is not text")),
        }
    }
}

impl<T: Stored> Stored for Option<T> {
    const LEAST: usize = 1;
    fn write(&self, out: &mut Vec<u8>) {
        self.is_some().write(out);
        if let Some(value) = self {
            value.write(out);
        }
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        Ok(match bool::read(source)? {
            true => Some(T::read(source)?),
            false => None,
        })
    }
}

impl<T: Stored> Stored for Vec<T> {
    const LEAST: usize = 8;
    fn write(&self, out: &mut Vec<u8>) {
        self.len().write(out);
        for value in self {
            value.write(out);
        }
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        let count = usize::read(source)?;
        if count > source.left() / T::LEAST.max(1) {
            return Err(source.senseless("a list is longer than the file"));
        }
        (0..count).map(|_| T::read(source)).collect()
    }
}

impl<T: Stored, const N: usize> Stored for [T; N] {
    const LEAST: usize = N * T::LEAST;
    fn write(&self, out: &mut Vec<u8>) {
        for value in self {
            value.write(out);
        }
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        let values: Vec<T> = (0..N).map(|_| T::read(source)).collect::<Result<_, _>>()?;
        Self::try_from(values).map_err(|_| source.senseless("a list of the wrong length"))
    }
}

impl<A: Stored, B: Stored> Stored for (A, B) {
    const LEAST: usize = A::LEAST + B::LEAST;
    fn write(&self, out: &mut Vec<u8>) {
        self.0.write(out);
        self.1.write(out);
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        Ok((A::read(source)?, B::read(source)?))
    }
}

impl<A: Stored, B: Stored, C: Stored> Stored for (A, B, C) {
    const LEAST: usize = A::LEAST + B::LEAST + C::LEAST;
    fn write(&self, out: &mut Vec<u8>) {
        self.0.write(out);
        self.1.write(out);
        self.2.write(out);
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        Ok((A::read(source)?, B::read(source)?, C::read(source)?))
    }
}

impl<T: Stored + Ord, U: Stored> Stored for std::collections::BTreeMap<T, U> {
    const LEAST: usize = 8;
    fn write(&self, out: &mut Vec<u8>) {
        self.len().write(out);
        for (key, value) in self {
            key.write(out);
            value.write(out);
        }
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        Ok(Vec::<(T, U)>::read(source)?.into_iter().collect())
    }
}

/// A struct as the sequence of its fields; a field that is forgotten is a compile error.
macro_rules! fields {
    ($kind:ty { $($field:ident: $inner:ty),* $(,)? }) => {
        impl $crate::store::bytes::Stored for $kind {
            const LEAST: usize = 0 $(+ <$inner as $crate::store::bytes::Stored>::LEAST)*;
            fn write(&self, out: &mut Vec<u8>) {
                $($crate::store::bytes::Stored::write(&self.$field, out);)*
            }
            fn read(
                source: &mut $crate::store::bytes::Source,
            ) -> Result<Self, $crate::store::StoreError> {
                Ok(Self {
                    $($field: <$inner as $crate::store::bytes::Stored>::read(source)?,)*
                })
            }
        }
    };
}
pub(super) use fields;

/// An enum without contents, by its variants' places in the list.
macro_rules! variants {
    ($kind:ident { $($variant:ident),* $(,)? }) => {
        impl $crate::store::bytes::Stored for $kind {
            const LEAST: usize = 1;
            fn write(&self, out: &mut Vec<u8>) {
                // a variant that the list lacks is a compile error here
                match self {
                    $($kind::$variant => {})*
                }
                let all = [$($kind::$variant),*];
                let place = all.iter().position(|one| one == self).unwrap_or(all.len());
                (place as u8).write(out);
            }
            fn read(
                source: &mut $crate::store::bytes::Source,
            ) -> Result<Self, $crate::store::StoreError> {
                let all = [$($kind::$variant),*];
                let place = usize::from(u8::read(source)?);
                match all.get(place) {
                    Some(found) => Ok(*found),
                    None => Err(source.senseless(concat!("no such ", stringify!($kind)))),
                }
            }
        }
    };
}
pub(super) use variants;
