//! Writers of the matrix and mode files of other codes, in all their variants, for the tests of their readers.

use std::io::{self, Read};

use eng_flexible::mesh::{Mesh, Node};
use eng_flexible::read::matrix::{ForeignMatrix, MatrixFormat, read_matrix};
use eng_flexible::{FileProblem, Files, FlexibleError};

/// A mesh of nodes alone, for matrices whose file gives no mesh.
pub fn mesh_of_nodes(nodes: &[(u64, [f64; 3])]) -> Mesh {
    Mesh {
        nodes: nodes
            .iter()
            .map(|&(id, position)| Node {
                id,
                position,
                frame: None,
            })
            .collect(),
        ..Mesh::default()
    }
}

/// The format that the end of a file's name means.
pub fn format_of(file: &str) -> MatrixFormat {
    let file = file.to_ascii_lowercase();
    let plain = file.strip_suffix(".gz").unwrap_or(&file);
    match plain.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "op4" => MatrixFormat::Op4,
        "op2" => MatrixFormat::Op2,
        "mtx" => MatrixFormat::Abaqus,
        "sti" | "mas" => MatrixFormat::CalculiX,
        _ => MatrixFormat::Dmig,
    }
}

/// Reads a matrix in the format that the end of the file's name means.
pub fn read_by_name(
    files: &dyn Files,
    file: &str,
    name: &str,
) -> Result<ForeignMatrix, FileProblem> {
    match read_matrix(files, file, format_of(file), name) {
        Ok(matrix) => Ok(matrix),
        Err(FlexibleError::File(problem)) => Err(problem),
        Err(other) => panic!("no problem of the file: {other}"),
    }
}

/// One file in memory, under any name.
pub struct OneFile(pub Vec<u8>);

impl Files for OneFile {
    fn open(&self, _: &str) -> io::Result<Box<dyn Read>> {
        Ok(Box::new(io::Cursor::new(self.0.clone())))
    }
}

/// A dense matrix by columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    pub name: &'static str,
    pub rows: usize,
    pub columns: Vec<Vec<f64>>,
}

impl Dense {
    /// Symmetric, positive diagonal, about a third of the entries, the fourth row and column empty; values
    /// that fill a double.
    pub fn symmetric(name: &'static str, size: usize) -> Self {
        let mut columns = vec![vec![0.0; size]; size];
        let mut state = 12345_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let places = (0..size).flat_map(|i| (0..=i).map(move |j| (i, j)));
        for (i, j) in places.filter(|(i, j)| *i != 3 && *j != 3) {
            let value = match (random(), random()) {
                (value, _) if i == j => 1e7 * (1.0 + value),
                (value, third) if third < 0.34 => 1e6 * (value - 0.5),
                _ => 0.0,
            };
            columns[i][j] = value;
            columns[j][i] = value;
        }
        Dense {
            name,
            rows: size,
            columns,
        }
    }

    /// Rectangular, all entries there.
    pub fn rectangular(name: &'static str, rows: usize, count: usize) -> Self {
        let entry = |row: usize, column: usize| ((row * 7 + column * 3) as f64 + 0.1).recip();
        Dense {
            name,
            rows,
            columns: (0..count)
                .map(|column| (0..rows).map(|row| entry(row, column)).collect())
                .collect(),
        }
    }

    /// With entries rounded to single precision.
    pub fn single(mut self) -> Self {
        for value in self.columns.iter_mut().flatten() {
            *value = f64::from(*value as f32);
        }
        self
    }

    /// Runs of entries that are not zero in a column: first row from 0, values.
    fn runs(&self, column: usize) -> Vec<(usize, Vec<f64>)> {
        let mut runs: Vec<(usize, Vec<f64>)> = Vec::new();
        for (row, value) in self.columns[column].iter().enumerate() {
            match runs.last_mut() {
                _ if *value == 0.0 => {}
                Some((first, values)) if *first + values.len() == row => values.push(*value),
                _ => runs.push((row, vec![*value])),
            }
        }
        runs
    }

    /// From the first to the last entry that isn't zero.
    fn span(&self, column: usize) -> Option<(usize, Vec<f64>)> {
        let values = &self.columns[column];
        let first = values.iter().position(|value| *value != 0.0)?;
        let last = values.iter().rposition(|value| *value != 0.0)?;
        Some((first, values[first..=last].to_vec()))
    }

    /// The whole matrix of a reader. Entries at the same place are refused.
    pub fn read(matrix: &ForeignMatrix) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; matrix.rows]; matrix.columns];
        for (row, column, value) in &matrix.entries {
            let (row, column) = (*row as usize, *column as usize);
            assert_eq!(columns[column][row], 0.0, "twice at {row}, {column}");
            columns[column][row] = *value;
            if matrix.symmetric {
                columns[row][column] = *value;
            }
        }
        columns
    }
}

/// How entries of an OP4 lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    Dense,
    Strings,
    Big,
}

/// Bytes of Fortran's unformatted files.
pub struct Binary {
    pub big_endian: bool,
    /// Integers of 8 bytes.
    pub wide: bool,
    pub bytes: Vec<u8>,
}

impl Binary {
    pub fn new(big_endian: bool, wide: bool) -> Self {
        Binary {
            big_endian,
            wide,
            bytes: Vec::new(),
        }
    }

    pub fn word(&self) -> usize {
        if self.wide { 8 } else { 4 }
    }

    fn ordered<const N: usize>(&self, mut little: [u8; N]) -> Vec<u8> {
        if self.big_endian {
            little.reverse();
        }
        little.to_vec()
    }

    pub fn integer(&self, value: i64) -> Vec<u8> {
        if self.wide {
            self.ordered(value.to_le_bytes())
        } else {
            self.ordered((value as i32).to_le_bytes())
        }
    }

    pub fn integers(&self, values: &[i64]) -> Vec<u8> {
        values
            .iter()
            .flat_map(|value| self.integer(*value))
            .collect()
    }

    /// A real in double precision, or single where it is asked for and integers have 4 bytes.
    pub fn real(&self, value: f64, single: bool) -> Vec<u8> {
        if single && !self.wide {
            self.ordered((value as f32).to_le_bytes())
        } else {
            self.ordered(value.to_le_bytes())
        }
    }

    /// Text, every 4 characters filled to a word.
    pub fn text(&self, text: &str) -> Vec<u8> {
        let mut bytes = Vec::new();
        for four in text.as_bytes().chunks(4) {
            let mut word = four.to_vec();
            word.resize(self.word(), b' ');
            bytes.extend(word);
        }
        bytes
    }

    pub fn record(&mut self, data: &[u8]) {
        let length = self.ordered((data.len() as i32).to_le_bytes());
        self.bytes.extend(&length);
        self.bytes.extend(data);
        self.bytes.extend(&length);
    }

    pub fn key(&mut self, key: i64) {
        let data = self.integer(key);
        self.record(&data);
    }
}

/// An OP4 in binary.
pub fn op4_binary(
    matrices: &[Dense],
    layout: Layout,
    single: bool,
    big_endian: bool,
    wide: bool,
) -> Vec<u8> {
    let mut file = Binary::new(big_endian, wide);
    let words = if wide || single { 1 } else { 2 }; // an entry
    for matrix in matrices {
        let rows = matrix.rows as i64;
        let rows = if layout == Layout::Big { -rows } else { rows };
        let kind = if single { 1 } else { 2 };
        let mut head = file.integers(&[matrix.columns.len() as i64, rows, 6, kind]);
        head.extend(file.text(&format!("{:8}", matrix.name)));
        file.record(&head);
        for column in 0..matrix.columns.len() {
            let mut data = Vec::new();
            let mut first = 0;
            if layout == Layout::Dense {
                let Some((row, values)) = matrix.span(column) else {
                    continue;
                };
                first = row as i64 + 1;
                data.extend(values.iter().flat_map(|value| file.real(*value, single)));
            } else {
                for (row, values) in matrix.runs(column) {
                    let length = (values.len() * words) as i64 + 1;
                    let row = row as i64 + 1;
                    data.extend(match layout {
                        Layout::Big => file.integers(&[length, row]),
                        _ => file.integer((length << 16) + row),
                    });
                    data.extend(values.iter().flat_map(|value| file.real(*value, single)));
                }
                if data.is_empty() {
                    continue;
                }
            }
            let count = (data.len() / file.word()) as i64;
            let mut record = file.integers(&[column as i64 + 1, first, count]);
            record.extend(data);
            file.record(&record);
        }
        let count = words as i64;
        let mut last = file.integers(&[matrix.columns.len() as i64 + 1, 1, count]);
        last.extend(file.real(1.0, single));
        file.record(&last);
    }
    file.bytes
}

/// A real as Fortran's `1P,Ew.d`.
fn fortran(value: f64, width: usize, digits: usize) -> String {
    let text = format!("{value:.digits$E}");
    let (mantissa, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if exponent < 0 { '-' } else { '+' };
    format!(
        "{:>width$}",
        format!("{mantissa}E{sign}{:02}", exponent.abs())
    )
}

/// An OP4 as text with 16 digits after the point, three values a line.
pub fn op4_text(matrices: &[Dense], layout: Layout, single: bool) -> String {
    let words = if single { 1 } else { 2 };
    let mut text = String::new();
    for matrix in matrices {
        let rows = matrix.rows as i64;
        let rows = if layout == Layout::Big { -rows } else { rows };
        let kind = if single { 1 } else { 2 };
        let count = matrix.columns.len();
        text += &format!(
            "{count:8}{rows:8}{:8}{kind:8}{:8}1P,3E23.16\n",
            6, matrix.name
        );
        let lines = |values: &[f64]| {
            let mut text = String::new();
            for three in values.chunks(3) {
                text.extend(three.iter().map(|value| fortran(*value, 23, 16)));
                text.push('\n');
            }
            text
        };
        for column in 0..count {
            if layout == Layout::Dense {
                if let Some((row, values)) = matrix.span(column) {
                    text += &format!("{:8}{:8}{:8}\n", column + 1, row + 1, values.len());
                    text += &lines(&values);
                }
                continue;
            }
            let runs = matrix.runs(column);
            let heading = if layout == Layout::Big { 2 } else { 1 };
            let total = runs
                .iter()
                .map(|(_, values)| values.len() * words + heading)
                .sum::<usize>();
            if total == 0 {
                continue;
            }
            text += &format!("{:8}{:8}{total:8}\n", column + 1, 0);
            for (row, values) in runs {
                let length = values.len() * words + 1;
                text += &match layout {
                    Layout::Big => format!("{length:8}{:8}\n", row + 1),
                    _ => format!("{:8}\n", (length << 16) + row + 1),
                };
                text += &lines(&values);
            }
        }
        text += &format!("{:8}{:8}{:8}\n{}", count + 1, 1, 1, lines(&[1.0]));
    }
    text
}

/// `DMIG` in large fields, as punched.
pub fn dmig(matrix: &Dense, points: &[(u64, u8)], one_triangle: bool) -> String {
    let form = if one_triangle { 6 } else { 1 };
    let mut text = format!(
        "DMIG    {:8}{:8}{form:8}{:8}{:8}{:8}{:8}{:8}\n",
        matrix.name,
        0,
        2,
        0,
        "",
        "",
        matrix.columns.len()
    );
    for (column, values) in matrix.columns.iter().enumerate() {
        let (node, freedom) = points[column];
        let mut lines = String::new();
        for (row, value) in values.iter().enumerate() {
            if *value != 0.0 && (!one_triangle || row <= column) {
                let (node, freedom) = points[row];
                lines += &format!(
                    "*       {node:16}{freedom:16}{:>16}\n",
                    fortran(*value, 16, 9)
                );
            }
        }
        if !lines.is_empty() {
            text += &format!("DMIG*   {:16}{node:16}{freedom:16}\n{lines}", matrix.name);
        }
    }
    text
}

/// An OP2 with the head of a file; MSC's from 2014 on say their release again and again.
pub struct Op2(pub Binary, bool);

impl Op2 {
    pub fn new(big_endian: bool, wide: bool, release: bool) -> Self {
        let mut file = Binary::new(big_endian, wide);
        file.key(3);
        let date = file.integers(&[1, 2, 24]);
        file.record(&date);
        file.key(7);
        let title = file.text("NASTRAN FORT TAPE ID CODE - ");
        file.record(&title);
        file.key(2);
        let version = file.text("XXXXXXXX");
        file.record(&version);
        let mut op2 = Op2(file, release);
        op2.release();
        op2.0.key(-1);
        op2.0.key(0);
        op2
    }

    fn release(&mut self) {
        if self.1 {
            self.0.key(6);
            let data = self.0.integers(&[1, 2, 3, 4, 5, 6]);
            self.0.record(&data);
        }
    }

    fn begin(&mut self, name: &str, trailer: [i64; 7]) {
        let name = self.0.text(&format!("{name:8}"));
        self.0.key(2);
        self.0.record(&name);
        self.release();
        self.0.key(-1);
        self.0.key(7);
        let trailer = self.0.integers(&trailer);
        self.0.record(&trailer);
        self.0.key(-2);
        self.0.key(1);
        self.0.key(0);
        self.0.key(2);
        self.0.record(&name);
        self.0.key(-3);
    }

    fn end(&mut self) {
        self.0.key(1);
        self.0.key(0);
        self.0.key(0);
    }

    /// A table of records, each in two parts where it is long.
    pub fn table(&mut self, name: &str, trailer: [i64; 7], records: &[Vec<u8>]) {
        self.begin(name, trailer);
        for (i, record) in records.iter().enumerate() {
            self.0.key(1);
            self.0.key(0);
            let half = (record.len() / 2).next_multiple_of(self.0.word()).max(64);
            for part in record.chunks(half) {
                self.0.key((part.len() / self.0.word()) as i64);
                self.0.record(part);
            }
            self.0.key(-4 - i as i64);
        }
        self.end();
    }

    /// A matrix.
    pub fn matrix(&mut self, matrix: &Dense, kind: i64) {
        let (rows, count) = (matrix.rows as i64, matrix.columns.len() as i64);
        self.begin(matrix.name, [101, count, rows, 6, kind, 80, 1191]);
        for column in 0..matrix.columns.len() {
            self.0.key(1);
            self.0.key(1);
            for (row, values) in matrix.runs(column) {
                let mut data = self.0.integer(row as i64 + 1);
                let reals = values
                    .iter()
                    .flat_map(|value| self.0.real(*value, kind == 1));
                data.extend(reals.collect::<Vec<_>>());
                self.0.key((data.len() / self.0.word()) as i64 - 1);
                self.0.record(&data);
            }
            self.0.key(-4 - column as i64);
        }
        self.end();
    }

    /// `EQEXIN` of points (number, kind 1 grid, 2 scalar) in the internal order.
    pub fn points(&mut self, points: &[(i64, i64)]) {
        let mut first = 1;
        let mut rows = Vec::new();
        for (place, (number, kind)) in points.iter().enumerate() {
            rows.push((*number, 10 * first + kind, place as i64 + 1));
            first += if *kind == 1 { 6 } else { 1 };
        }
        rows.sort_unstable();
        let order = rows
            .iter()
            .flat_map(|row| [row.0, row.2])
            .collect::<Vec<_>>();
        let codes = rows
            .iter()
            .flat_map(|row| [row.0, row.1])
            .collect::<Vec<_>>();
        let records = [self.0.integers(&order), self.0.integers(&codes)];
        self.table(
            "EQEXIN",
            [101, points.len() as i64, 0, 0, 0, 0, 0],
            &records,
        );
    }

    /// One block of modes: number, eigenvalue, subcase, rows of (node, shape).
    pub fn modes(&mut self, name: &str, modes: &[(i64, f64, i64)], nodes: &[i64], shape: Shape) {
        let mut records = Vec::new();
        for &(mode, eigenvalue, subcase) in modes {
            let mut words = vec![0; 146];
            words[..5].copy_from_slice(&[21, 7, 0, subcase, mode]);
            words[8..10].copy_from_slice(&[1, 8]);
            let mut data = self.0.integers(&words);
            let word = self.0.word();
            data.splice(5 * word..6 * word, self.0.real(eigenvalue, true));
            records.push(data);
            let mut data = Vec::new();
            for node in nodes {
                data.extend(self.0.integers(&[10 * node + 1, 1]));
                for freedom in 0..6 {
                    data.extend(self.0.real(shape(mode, *node, freedom), true));
                }
            }
            // a scalar point after them
            data.extend(self.0.integers(&[10 * 9999 + 1, 2, 0, 0, 0, 0, 0, 0]));
            records.push(data);
        }
        self.table(name, [101, 0, 0, 0, 0, 0, 0], &records);
    }

    /// `LAMA` of modes and eigenvalues.
    pub fn eigenvalues(&mut self, modes: &[(i64, f64)]) {
        let mut data = Vec::new();
        for (mode, value) in modes {
            data.extend(self.0.integers(&[*mode, *mode]));
            for value in [*value, value.sqrt(), 0.0, 1.0, *value] {
                data.extend(self.0.real(value, true));
            }
        }
        let identification = self.0.integers(&[0; 146]);
        self.table("LAMA", [101; 7], &[identification, data]);
    }

    pub fn finish(mut self) -> Vec<u8> {
        self.0.key(0);
        self.0.bytes
    }
}

/// Value of a mode at a node's freedom.
pub type Shape = fn(i64, i64, usize) -> f64;

/// A shape whose values single precision and 7 digits hold.
pub fn plain_shape(mode: i64, node: i64, freedom: usize) -> f64 {
    (mode * 100 + node * 8) as f64 * 0.125 - freedom as f64
}

/// Punched modes.
pub fn punch(modes: &[(i64, f64)], nodes: &[i64]) -> String {
    let mut text = String::new();
    let mut number = 0;
    let mut line = |content: String| {
        number += 1;
        text += &format!("{content:72}{number:8}\n");
    };
    for (mode, eigenvalue) in modes {
        line("$TITLE   =".into());
        line("$EIGENVECTOR".into());
        line("$REAL OUTPUT".into());
        line("$SUBCASE ID =           1".into());
        line(format!(
            "$EIGENVALUE = {}  MODE = {mode:5}",
            fortran(*eigenvalue, 14, 7)
        ));
        for node in nodes {
            let value = |freedom| fortran(plain_shape(*mode, *node, freedom), 18, 6);
            line(format!(
                "{node:10}       G{}{}{}",
                value(0),
                value(1),
                value(2)
            ));
            line(format!(
                "-CONT-            {}{}{}",
                value(3),
                value(4),
                value(5)
            ));
        }
    }
    text
}

/// Modes of CalculiX.
pub fn frd(modes: &[(i64, f64)], nodes: &[i64]) -> String {
    let mut text = String::from("    1C\n    1UDATE\n");
    text += &format!("    2C{:18}{:12}{:37}1\n", "", nodes.len(), "");
    for node in nodes {
        text += &format!(" -1{node:10}{}\n", fortran(0.0, 12, 5).repeat(3));
    }
    text += " -3\n";
    for (mode, frequency) in modes {
        text += &format!("    1PGM                {}\n", fortran(2.0, 12, 6));
        let stiffness = 2.0 * (2.0 * std::f64::consts::PI * frequency).powi(2);
        text += &format!("    1PGK                {}\n", fortran(stiffness, 12, 6));
        text += &format!("    1PMODE{mode:26}\n");
        text += &format!(
            "  100CL{:5}{}{:12}{:20}{:2}{:5}{:10}{:2}\n",
            100 + mode,
            fortran(*frequency, 12, 5),
            nodes.len(),
            "",
            2,
            mode,
            "MODE",
            1
        );
        text += " -4  DISP        4    1\n -5  D1          1    2    1    0\n";
        for node in nodes {
            let value = |freedom| fortran(plain_shape(*mode, *node, freedom), 12, 5);
            text += &format!(" -1{node:10}{}{}{}\n", value(0), value(1), value(2));
        }
        text += " -3\n  100CL  101 1.00000E+00           1                     2    1          1\n -4  STRESS      6    1\n -1         1";
        text += &fortran(1.0, 12, 5).repeat(6);
        text += "\n -3\n";
    }
    text + " 9999\n"
}
