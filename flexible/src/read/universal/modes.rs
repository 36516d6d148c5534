//! Mode shapes in universal files: the results at nodes of datasets 55 and 2414.
//!
//! A dataset is one mode. It begins with lines of text, the kind of its values, the number of the mode and its frequency.
//! Then each node has a line with its number and lines with its values, up to six on each. Eng reads displacements of normal
//! modes and skips other results. Complex modes without imaginary parts are real ones, as NX writes them.
//!
//! Sources: SDRC I-DEAS universal file formats, datasets 55 and 2414; files of PERMAS 18 and NX 2021.

use super::lines::{AGAIN, BRACKET, Head, Lines, Record};
use crate::error::FileProblem;
use crate::read::Files;
use crate::read::matrix::{COMPLEX, DOUBLE_DIGITS, ForeignModes, ShapeFrame};

/// The type of an analysis for normal modes.
const NORMAL_MODES: i64 = 2;
/// The characteristics of translations, and of translations with rotations.
const MOTIONS: [i64; 2] = [2, 3];
/// The type of a result that is a displacement.
const DISPLACEMENT: i64 = 8;
/// The types of data of complex numbers, in single and in double precision.
const COMPLEX_NUMBERS: [i64; 2] = [5, 6];
/// The types of data of double precision, real and complex.
const DOUBLE_PRECISION: [i64; 2] = [4, 6];
/// The location of results at nodes in dataset 2414.
const AT_NODES: i64 = 1;
/// Digits of a value in single precision, which has 13 columns with an exponent.
const SINGLE_DIGITS: u32 = 6;

/// The heading of a mode.
struct Heading {
    /// Number of the mode; zero if the file does not number its modes.
    number: i64,
    /// In the inverse of the file's unit of time.
    frequency: f64,
    kind: Kind,
}

/// The kind of the values of a mode.
struct Kind {
    /// Values of a node, 3 or 6.
    values: usize,
    /// Numbers of a value: 2 for a complex one.
    parts: usize,
    /// Whether the values have double precision.
    double: bool,
}

/// Reads the shapes of the normal modes of a universal file.
///
/// # Errors
/// With file, line and dataset: a file that can't be read or is cut, text in the place of a number, complex shapes; modes on
/// different nodes, or none.
pub fn read_unv_modes(files: &dyn Files, file: &str) -> Result<ForeignModes, FileProblem> {
    let mut lines = Lines::open(files, file)?;
    let mut modes = ForeignModes::new(file, ShapeFrame::Basic, DOUBLE_DIGITS);
    while let Some(head) = lines.next()? {
        let heading = match head.number {
            55 => heading_of_55(&mut lines, &head)?,
            2414 => heading_of_2414(&mut lines, &head)?,
            _ => None,
        };
        match heading {
            Some(heading) => shape(&mut lines, &heading, &mut modes)?,
            None => lines.skip(&head)?,
        }
    }
    modes.finish("write the displacements of normal modes at nodes, as dataset 55 or 2414")
}

fn cut(head: &Head) -> FileProblem {
    let problem = format!("dataset {}: it ends inside its heading", head.number);
    head.at.problem(problem, AGAIN)
}

/// A record of the heading.
fn heading_record(lines: &mut Lines, head: &Head) -> Result<Record, FileProblem> {
    lines.record()?.ok_or_else(|| cut(head))
}

/// Skips lines of text, which may be blank.
fn skip_text(lines: &mut Lines, head: &Head, count: usize) -> Result<(), FileProblem> {
    for _ in 0..count {
        if lines.name()? == BRACKET {
            return Err(cut(head));
        }
    }
    Ok(())
}

/// Dataset 55: five lines of text; the kind of the values; numbers of whole and of real numbers, of the load case and of the
/// mode; the frequency and further real numbers. `None` for other results.
fn heading_of_55(lines: &mut Lines, head: &Head) -> Result<Option<Heading>, FileProblem> {
    skip_text(lines, head, 5)?;
    let stated = heading_record(lines, head)?;
    let Some(kind) = kind_of(&stated)? else {
        return Ok(None);
    };
    let title = "a mode";
    let record = lines.more(&stated, title)?;
    let numbers = record.whole_numbers()?;
    let reals = numbers
        .get(1)
        .and_then(|count| usize::try_from(*count).ok());
    // the dataset has at most twelve
    let Some(reals) = reals.filter(|count| (1..=12).contains(count)) else {
        return Err(record.problem("the number of real numbers is not 1 to 12", AGAIN));
    };
    let reals = real_numbers(lines, &record, (title, reals))?;
    Ok(Some(Heading {
        number: numbers.get(3).copied().unwrap_or(0),
        frequency: reals.first().copied().unwrap_or(0.0),
        kind,
    }))
}

/// Dataset 2414: number and name of the result; its location; five lines of text; the kind of the values; ten whole numbers
/// on two lines, of which the sixth is that of the mode; twelve real ones on two lines, of which the second is the frequency.
/// `None` for other results.
fn heading_of_2414(lines: &mut Lines, head: &Head) -> Result<Option<Heading>, FileProblem> {
    heading_record(lines, head)?;
    skip_text(lines, head, 1)?;
    let location = heading_record(lines, head)?;
    let [place] = location.head()?;
    skip_text(lines, head, 5)?;
    let stated = heading_record(lines, head)?;
    let Some(kind) = kind_of(&stated)?.filter(|_| place == AT_NODES) else {
        return Ok(None);
    };
    let title = "a mode";
    let numbers = lines.more(&stated, title)?.whole_numbers()?;
    lines.more(&stated, title)?;
    let reals = real_numbers(lines, &stated, (title, 12))?;
    Ok(Some(Heading {
        number: numbers.get(5).copied().unwrap_or(0),
        frequency: reals.get(1).copied().unwrap_or(0.0),
        kind,
    }))
}

/// The kind of the values, from the model, the analysis, the characteristic, the type of the result, that of the data, and the
/// number of values. `None` if they are no displacements of normal modes.
fn kind_of(record: &Record) -> Result<Option<Kind>, FileProblem> {
    let [_, analysis, characteristic, result, data, count] = record.head()?;
    if analysis != NORMAL_MODES || result != DISPLACEMENT || !MOTIONS.contains(&characteristic) {
        return Ok(None);
    }
    let parts = match COMPLEX_NUMBERS.contains(&data) {
        true => 2,
        false => 1,
    };
    let values = match count {
        3 => 3,
        6 => 6,
        _ => {
            return Err(record.problem(
                format!("a node has {count} values"),
                "write three translations, or three translations and three rotations, at each node",
            ));
        }
    };
    let double = DOUBLE_PRECISION.contains(&data);
    Ok(Some(Kind {
        values,
        parts,
        double,
    }))
}

/// Reads the nodes of a mode. A program may write double precision with few digits: the shape has those of its longest value.
fn shape(
    lines: &mut Lines,
    heading: &Heading,
    modes: &mut ForeignModes,
) -> Result<(), FileProblem> {
    let mut rows = Vec::new();
    let mut digits = SINGLE_DIGITS;
    let kind = &heading.kind;
    while let Some(record) = lines.record()? {
        let [node] = record.head()?;
        let node = record.label(node, "a node")?;
        let title = format!("node {node}");
        let count = kind.values * kind.parts;
        let mut values = Vec::with_capacity(count);
        while values.len() < count {
            let line = more_numbers(lines, &record, (&title, count), &mut values)?;
            if kind.double {
                digits = digits.max(line.digits());
            }
        }
        let mut row = [0.0; 6];
        for (to, value) in row.iter_mut().zip(values.chunks_exact(kind.parts)) {
            let [real, imaginary @ ..] = value else {
                continue;
            };
            if imaginary.iter().any(|x| *x != 0.0) {
                return Err(record.problem(format!("the shape of {title} is complex"), COMPLEX));
            }
            *to = *real;
        }
        rows.push((node, row));
    }
    modes.digits = modes.digits.min(digits);
    let following = modes.modes.len() as u64 + 1;
    let number = u64::try_from(heading.number).ok().filter(|n| *n > 0);
    let angular = 2.0 * std::f64::consts::PI * heading.frequency;
    modes.push(number.unwrap_or(following), Some(angular * angular), rows)
}

/// As many real numbers, on one or several lines, of an object that `first` begins.
fn real_numbers(
    lines: &mut Lines,
    first: &Record,
    (title, count): (&str, usize),
) -> Result<Vec<f64>, FileProblem> {
    let mut found = Vec::with_capacity(count);
    while found.len() < count {
        more_numbers(lines, first, (title, count), &mut found)?;
    }
    Ok(found)
}

/// Adds the real numbers of the next line to those of an object that `first` begins.
fn more_numbers(
    lines: &mut Lines,
    first: &Record,
    (title, count): (&str, usize),
    found: &mut Vec<f64>,
) -> Result<Record, FileProblem> {
    let record = lines.more(first, title)?;
    found.extend(record.real_numbers()?);
    if found.len() > count {
        return Err(record.problem(
            format!("{title} has {} numbers instead of {count}", found.len()),
            AGAIN,
        ));
    }
    Ok(record)
}
