//! The blocks of an OP2: records of keys (one integer) and of data. A key above zero is the number of words
//! in the next record. A key below zero ends a record of the block and counts it. Zero ends the block.
//!
//! ```text
//! 3 date 7 title 2 version [6 release] -1 0                head of the file, or nothing
//! 2 name [6 release] -1 7 trailer -2 1 0 n head -3         head of a block; MSC adds its release from 2014
//! 1 0 n data [n data…] -4                                  a record of a table
//! 1 1 n row+values [n row+values…] -5                      a column of a matrix; its n leaves out the row
//! 1 0 0                                                    end of the block
//! ```

use super::super::CUT;
use super::super::bytes::Records;
use crate::error::FileProblem;
use crate::read::Files;

/// The head of a block.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Its name.
    pub name: String,
    /// Its trailer.
    pub trailer: Vec<i64>,
}

/// The next part of a block.
#[derive(Clone, Debug)]
pub(super) enum Step {
    /// A record of a table ended.
    Table,
    /// A column of a matrix begins.
    Column,
    /// Data of it.
    Data(Vec<u8>),
}

/// The position within a block.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stand {
    Outside,
    BetweenRecords,
    InTable,
    InColumn,
}

/// Reads blocks one after the other.
pub(super) struct Blocks {
    records: Records,
    key_bytes: usize,
    stand: Stand,
    name: String,
}

impl Blocks {
    /// Opens a file.
    pub fn open(files: &dyn Files, file: &str) -> Result<Self, FileProblem> {
        let (records, length) = Records::open(files, file, &[4, 8], "OP2 file")?;
        Ok(Blocks {
            records,
            key_bytes: if length == 4 { 4 } else { 8 },
            stand: Stand::Outside,
            name: String::new(),
        })
    }

    /// Bytes of a key and of a word.
    pub fn key_bytes(&self) -> usize {
        self.key_bytes
    }

    /// The integer of a word.
    pub fn integer(&self, bytes: &[u8]) -> i64 {
        self.records.order().integer(bytes)
    }

    /// The real of 4 or 8 bytes.
    pub fn real(&self, bytes: &[u8]) -> f64 {
        self.records.order().real(bytes)
    }

    /// The words of a record as integers.
    pub fn integers(&self, data: &[u8]) -> Vec<i64> {
        data.chunks_exact(self.key_bytes)
            .map(|bytes| self.integer(bytes))
            .collect()
    }

    /// A problem of the record last read.
    pub fn problem(&self, problem: impl Into<String>, advice: impl Into<String>) -> FileProblem {
        self.records.problem(problem, advice)
    }

    fn data(&mut self) -> Result<Vec<u8>, FileProblem> {
        match self.records.next_record()? {
            Some(data) => Ok(data),
            None => Err(self.ends()),
        }
    }

    fn ends(&self) -> FileProblem {
        let place = if self.name.is_empty() {
            "before its first block".to_string()
        } else {
            format!("inside or after block {}", self.name)
        };
        self.problem(format!("the file ends {place}"), CUT)
    }

    /// A key; `None` at the end of the file.
    fn key_or_end(&mut self) -> Result<Option<i64>, FileProblem> {
        match self.records.next_record()? {
            None => Ok(None),
            Some(data) if data.len() == self.key_bytes => Ok(Some(self.integer(&data))),
            Some(data) => Err(self.problem(
                format!(
                    "a record of {1} bytes stands in the place of a key of {0} bytes{2}",
                    self.key_bytes,
                    data.len(),
                    self.where_it_is()
                ),
                "write or copy the file again; it is damaged, or it is no OP2",
            )),
        }
    }

    fn key(&mut self) -> Result<i64, FileProblem> {
        match self.key_or_end()? {
            Some(key) => Ok(key),
            None => Err(self.ends()),
        }
    }

    fn where_it_is(&self) -> String {
        if self.name.is_empty() {
            String::new()
        } else {
            format!(" (block {})", self.name)
        }
    }

    fn expect(&mut self, expected: i64) -> Result<(), FileProblem> {
        let key = self.key()?;
        if key == expected {
            return Ok(());
        }
        Err(self.problem(
            format!(
                "the key is {key} in the place of {expected}{}",
                self.where_it_is()
            ),
            "write or copy the file again; it is damaged, or it is no OP2",
        ))
    }

    /// Data with the number of words of the key before it, plus `more`.
    fn words(&mut self, key: i64, more: usize) -> Result<Vec<u8>, FileProblem> {
        let data = self.data()?;
        let expected = usize::try_from(key)
            .ok()
            .and_then(|words| words.checked_add(more)?.checked_mul(self.key_bytes));
        if expected == Some(data.len()) {
            return Ok(data);
        }
        Err(self.problem(
            format!(
                "the length of a record, {} bytes, does not fit its key of {key} words{}",
                data.len(),
                self.where_it_is()
            ),
            "write or copy the file again; it is damaged",
        ))
    }

    /// All data up to the key that ends their record.
    fn whole_record(&mut self, end: i64) -> Result<Vec<u8>, FileProblem> {
        let mut all = Vec::new();
        loop {
            let key = self.key()?;
            if key == end {
                return Ok(all);
            }
            if key <= 0 {
                return Err(self.problem(
                    format!(
                        "the key is {key} in the place of {end}{}",
                        self.where_it_is()
                    ),
                    "write or copy the file again; it is damaged, or it is no OP2",
                ));
            }
            all.extend(self.words(key, 0)?);
        }
    }

    /// The next block. It skips the rest of the block before. `None` at the end of the file.
    pub fn next_block(&mut self) -> Result<Option<Block>, FileProblem> {
        while self.stand != Stand::Outside {
            self.next_step()?;
        }
        loop {
            match self.key_or_end()? {
                None if self.name.is_empty() => return Err(self.ends()),
                None => return Ok(None),
                Some(0) => {}
                Some(3) => {
                    self.words(3, 0)?;
                    self.whole_record(-1)?;
                    self.expect(0)?;
                }
                Some(2) => break,
                Some(key) => {
                    return Err(self.problem(
                        format!("a block begins with the key {key} in the place of 2"),
                        "write or copy the file again; it is damaged, or it is no OP2",
                    ));
                }
            }
        }
        let name = self.words(2, 0)?;
        self.name = text(&name, self.key_bytes);
        self.whole_record(-1)?;
        let trailer = self.whole_record(-2)?;
        self.expect(1)?;
        self.expect(0)?;
        self.whole_record(-3)?;
        self.stand = Stand::BetweenRecords;
        Ok(Some(Block {
            name: self.name.clone(),
            trailer: self.integers(&trailer),
        }))
    }

    /// The next step in the block; `None` at its end.
    pub fn next_step(&mut self) -> Result<Option<Step>, FileProblem> {
        loop {
            match self.stand {
                Stand::Outside => return Ok(None),
                Stand::BetweenRecords => match (self.key()?, self.key()?) {
                    (1, 1) => {
                        self.stand = Stand::InColumn;
                        return Ok(Some(Step::Column));
                    }
                    (1, 0) => {
                        let key = self.key()?;
                        if key == 0 {
                            self.stand = Stand::Outside;
                            return Ok(None);
                        }
                        // an empty record
                        if key < 0 {
                            return Ok(Some(Step::Table));
                        }
                        self.stand = Stand::InTable;
                        return self.words(key, 0).map(|data| Some(Step::Data(data)));
                    }
                    (first, second) => {
                        return Err(self.problem(
                            format!(
                                "a record begins with the keys {first} and {second} in the place of 1 and 0, or 1 and 1{}",
                                self.where_it_is()
                            ),
                            "write or copy the file again; it is damaged, or it is no OP2",
                        ));
                    }
                },
                Stand::InTable | Stand::InColumn => {
                    let key = self.key()?;
                    if key == 0 {
                        return Err(self.problem(
                            format!("a record has no end{}", self.where_it_is()),
                            "write or copy the file again; it is damaged",
                        ));
                    }
                    if key < 0 {
                        let table = self.stand == Stand::InTable;
                        self.stand = Stand::BetweenRecords;
                        if table {
                            return Ok(Some(Step::Table));
                        }
                        continue;
                    }
                    let more = usize::from(self.stand == Stand::InColumn);
                    return self.words(key, more).map(|data| Some(Step::Data(data)));
                }
            }
        }
    }

    /// The next whole record of a table; `None` at the end of the block. It skips columns of a matrix.
    pub fn next_table(&mut self) -> Result<Option<Vec<u8>>, FileProblem> {
        let mut all = Vec::new();
        while let Some(step) = self.next_step()? {
            match step {
                Step::Data(data) if self.stand == Stand::InTable => all.extend(data),
                Step::Data(_) | Step::Column => {}
                Step::Table => return Ok(Some(all)),
            }
        }
        Ok(None)
    }
}

/// The text of a name; 64-bit files blank-fill every 4 characters to 8.
fn text(bytes: &[u8], key_bytes: usize) -> String {
    bytes
        .chunks(key_bytes)
        .flat_map(|word| word.iter().take(4))
        .map(|&byte| {
            if byte.is_ascii_graphic() {
                char::from(byte)
            } else {
                ' '
            }
        })
        .collect::<String>()
        .trim()
        .to_string()
}
