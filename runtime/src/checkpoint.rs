//! Checkpoints: bytes in little-endian order with a header and a check sum.
//!
//! Header: `ENGCHECK`, the version of the format, a fingerprint of the model and its parameters. The FNV-1a
//! sum of all these bytes is at the end.

use crate::error::RuntimeError;
use crate::model::Model;
use eng_system::system::Slot;

const MAGIC: &[u8; 8] = b"ENGCHECK";
/// Version of the format.
pub const VERSION: u32 = 13;

fn refuse(reason: impl Into<String>) -> RuntimeError {
    RuntimeError::Checkpoint {
        reason: reason.into(),
    }
}

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
fn fnv(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// A number that differs between models and between parameter sets. A checkpoint has the values of inputs, so they
/// and all that follows them are left out.
pub fn fingerprint(model: &Model) -> u64 {
    let system = &model.compiled.system;
    let mut text = format!("{system:?}").into_bytes();
    let mut add = |value: f64| text.extend(value.to_bits().to_le_bytes());
    if system.inputs.is_empty() {
        model
            .slots
            .iter()
            .chain(&model.parameters)
            .copied()
            .for_each(add);
        return fnv(text);
    }
    for (index, value) in model.slots.iter().enumerate() {
        let moves = system.moving.binary_search(&Slot(index as u32)).is_ok();
        add(if moves { 0.0 } else { *value });
    }
    let set_by_program = |index: usize| {
        let mut inputs = system.inputs.iter();
        inputs.any(|input| input.parameter as usize == index && input.signal.is_none())
    };
    for (index, stated) in model.overrides.iter().enumerate() {
        let stated = stated.filter(|_| !set_by_program(index));
        add(f64::from(u8::from(stated.is_some())));
        add(stated.unwrap_or_default());
    }
    fnv(text)
}

/// Writes a checkpoint.
#[derive(Clone, Debug)]
pub struct Writer(Vec<u8>);

impl Writer {
    /// With the header.
    pub fn new(fingerprint: u64) -> Writer {
        let mut writer = Writer(MAGIC.to_vec());
        writer.0.extend(VERSION.to_le_bytes());
        writer.integer(fingerprint);
        writer
    }
    /// One integer.
    pub fn integer(&mut self, value: u64) {
        self.0.extend(value.to_le_bytes());
    }
    /// One number.
    pub fn number(&mut self, value: f64) {
        self.integer(value.to_bits());
    }
    /// Numbers with their count.
    pub fn numbers(&mut self, values: &[f64]) {
        self.integer(values.len() as u64);
        for value in values {
            self.number(*value);
        }
    }
    /// The bytes.
    pub fn finish(mut self) -> Vec<u8> {
        let sum = fnv(self.0.iter().copied());
        self.integer(sum);
        self.0
    }
}

/// Reads a checkpoint.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// Checks header and sum.
    pub fn new(bytes: &'a [u8], fingerprint: u64) -> Result<Reader<'a>, RuntimeError> {
        if bytes.len() < 28 || &bytes[..8] != MAGIC {
            return Err(refuse(
                "these bytes are no checkpoint, or only the beginning of one",
            ));
        }
        let mut version = [0; 4];
        version.copy_from_slice(&bytes[8..12]);
        let version = u32::from_le_bytes(version);
        if version != VERSION {
            return Err(refuse(format!(
                "its format has version {version}; this program reads version {VERSION}"
            )));
        }
        let (content, sum) = bytes.split_at(bytes.len() - 8);
        let stated = (Reader { rest: sum }).integer()?;
        if fnv(content.iter().copied()) != stated {
            return Err(refuse("it is truncated or damaged"));
        }
        let mut reader = Reader {
            rest: &content[12..],
        };
        if reader.integer()? != fingerprint {
            return Err(refuse("it belongs to another model or other parameters"));
        }
        Ok(reader)
    }
    /// One integer.
    pub fn integer(&mut self) -> Result<u64, RuntimeError> {
        let (head, rest) = self
            .rest
            .split_first_chunk::<8>()
            .ok_or_else(|| refuse("it is too short"))?;
        self.rest = rest;
        Ok(u64::from_le_bytes(*head))
    }
    /// One number.
    pub fn number(&mut self) -> Result<f64, RuntimeError> {
        Ok(f64::from_bits(self.integer()?))
    }
    /// Numbers into a slice of the same length.
    pub fn numbers(&mut self, out: &mut [f64]) -> Result<(), RuntimeError> {
        if self.integer()? != out.len() as u64 {
            return Err(refuse("its vectors have other lengths"));
        }
        for value in out {
            *value = self.number()?;
        }
        Ok(())
    }
    /// As many numbers as there are.
    pub fn all_numbers(&mut self) -> Result<Vec<f64>, RuntimeError> {
        let count = self.integer()?;
        // a wrong count must not take memory for it
        if count > self.rest.len() as u64 / 8 {
            return Err(refuse("it is too short"));
        }
        (0..count).map(|_| self.number()).collect()
    }
    /// Checks that no byte is left.
    pub fn finish(self) -> Result<(), RuntimeError> {
        if self.rest.is_empty() {
            Ok(())
        } else {
            Err(refuse("it is longer than this model's"))
        }
    }
}
