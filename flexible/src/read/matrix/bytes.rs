//! Fortran's unformatted files: records with their length before and after, in either byte order.

use std::io::{self, BufRead, Read};

use super::CUT;
use crate::error::{FileProblem, Place};
use crate::read::{self, Files};

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// Least first.
    Little,
    /// Most first.
    Big,
}

impl Order {
    /// The 32-bit integer of up to four bytes (fewer: as if zeros followed).
    fn integer32(self, bytes: &[u8]) -> i32 {
        let mut word = [0; 4];
        for (to, from) in word.iter_mut().zip(bytes) {
            *to = *from;
        }
        match self {
            Order::Little => i32::from_le_bytes(word),
            Order::Big => i32::from_be_bytes(word),
        }
    }

    fn word64(self, bytes: &[u8]) -> [u8; 8] {
        let mut word = [0; 8];
        for (to, from) in word.iter_mut().zip(bytes) {
            *to = *from;
        }
        word
    }

    /// The integer of 4 or 8 bytes.
    pub fn integer(self, bytes: &[u8]) -> i64 {
        if bytes.len() <= 4 {
            return i64::from(self.integer32(bytes));
        }
        match self {
            Order::Little => i64::from_le_bytes(self.word64(bytes)),
            Order::Big => i64::from_be_bytes(self.word64(bytes)),
        }
    }

    /// The real of 4 or 8 bytes.
    pub fn real(self, bytes: &[u8]) -> f64 {
        if bytes.len() <= 4 {
            return f64::from(f32::from_bits(self.integer32(bytes) as u32)); // the same bits
        }
        match self {
            Order::Little => f64::from_le_bytes(self.word64(bytes)),
            Order::Big => f64::from_be_bytes(self.word64(bytes)),
        }
    }
}

/// Reads records one after the other.
pub(super) struct Records {
    file: String,
    reader: Box<dyn BufRead>,
    order: Order,
    /// The place of the next byte.
    byte: u64,
    /// Number of the record last read, and where it started.
    record: (u64, u64),
}

impl Records {
    /// Opens a file whose first record has one of the lengths `first`. This length shows the order of bytes;
    /// it is returned too.
    pub fn open(
        files: &dyn Files,
        file: &str,
        first: &[i32],
        what: &str,
    ) -> Result<(Self, i32), FileProblem> {
        let mut reader = read::open(files, file)?;
        let mut records = Records {
            file: file.into(),
            reader: Box::new(io::empty()),
            order: Order::Little,
            byte: 0,
            record: (1, 0),
        };
        let start = reader
            .fill_buf()
            .map_err(|error| records.unreadable(&error))?
            .get(..4)
            .unwrap_or(&[])
            .to_vec();
        records.reader = reader;
        for order in [Order::Little, Order::Big] {
            let length = order.integer32(&start);
            if start.len() == 4 && first.contains(&length) {
                records.order = order;
                return Ok((records, length));
            }
        }
        Err(records.problem(
            format!("this is no {what}: the file begins with the bytes {start:02x?}"),
            format!("give the unformatted {what} that Nastran writes; a copy as text damages it"),
        ))
    }

    /// Order of the bytes.
    pub fn order(&self) -> Order {
        self.order
    }

    /// A problem of the record last read.
    pub fn problem(&self, problem: impl Into<String>, advice: impl Into<String>) -> FileProblem {
        FileProblem {
            file: self.file.clone(),
            place: Place::Record {
                record: self.record.0,
                byte: self.record.1,
            },
            problem: problem.into(),
            advice: advice.into(),
        }
    }

    fn unreadable(&self, error: &io::Error) -> FileProblem {
        self.problem(
            format!("reading stopped here: {error}"),
            "copy the file again; it may be cut or damaged",
        )
    }

    /// Up to `count` bytes, fewer at the end of the file.
    fn bytes(&mut self, count: u64, into: &mut Vec<u8>) -> Result<u64, FileProblem> {
        // grows as bytes come, so that a wrong length asks for no memory
        let read = (&mut self.reader)
            .take(count)
            .read_to_end(into)
            .map_err(|error| self.unreadable(&error))? as u64;
        self.byte += read;
        Ok(read)
    }

    fn length(&mut self) -> Result<Option<i32>, FileProblem> {
        let mut word = Vec::with_capacity(4);
        match self.bytes(4, &mut word)? {
            0 => Ok(None),
            4 => Ok(Some(self.order.integer32(&word))),
            _ => Err(self.cut()),
        }
    }

    /// The file ends too early.
    pub fn cut(&self) -> FileProblem {
        self.problem(
            format!("the file ends inside a record, at byte {}", self.byte),
            CUT,
        )
    }

    /// The file ends inside a record of this length: too early, or the length has its bytes in the other
    /// order.
    fn ended(&self, length: i32) -> FileProblem {
        let other = u64::from(length.swap_bytes().unsigned_abs());
        if self.record.1 + other >= self.byte {
            return self.cut();
        }
        self.problem(
            format!(
                "the record is {} bytes long, beyond the end of the file; in the other order of bytes it is {other} bytes long",
                length.unsigned_abs()
            ),
            "write the file again; it mixes both orders of bytes, as after a partial conversion or a merge of files of two machines",
        )
    }

    /// The next record; `None` at the end of the file. A record in parts (a negative length before a part
    /// says that more follow) is given as a whole.
    pub fn next_record(&mut self) -> Result<Option<Vec<u8>>, FileProblem> {
        let mut data = Vec::new();
        let start = self.byte;
        let mut more = false;
        loop {
            let Some(length) = self.length()? else {
                return if more { Err(self.cut()) } else { Ok(None) };
            };
            if !more {
                self.record = (self.record.0 + u64::from(start > 0), start);
            }
            let count = u64::from(length.unsigned_abs());
            if self.bytes(count, &mut data)? < count {
                return Err(self.ended(length));
            }
            let Some(after) = self.length()? else {
                return Err(self.cut());
            };
            if after.unsigned_abs() != length.unsigned_abs() {
                return Err(self.problem(
                    format!(
                        "the record states {length} bytes at its beginning and {after} bytes at its end"
                    ),
                    "copy the file again as binary; it is damaged, or it was copied as text",
                ));
            }
            more = length < 0;
            if !more {
                return Ok(Some(data));
            }
        }
    }
}
