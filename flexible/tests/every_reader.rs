//! Real files with damage, given to every reader, also to those of other formats. Each reader reads them, or refuses
//! them with the remedy. None panics. The damage is the same in every run.

use std::io::{self, Cursor, Read};
use std::path::PathBuf;

use eng_flexible::read::matrix::{
    MatrixFormat, MatrixKind, ShapeFormat, read_calculix_freedoms, read_matrix, read_modes,
};
use eng_flexible::{Files, FlexibleError, MeshFormat, read_mesh};
use eng_system::mesh_files::Stated as _;

/// Damages of each file.
const DAMAGES: u64 = 12;
/// Most bytes of a file that are kept: its beginning and its end.
const KEPT: usize = 6000;

/// Every name gives this file; a file that it includes does not exist.
struct Only(Vec<u8>);

impl Files for Only {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        match name {
            "file" => Ok(Box::new(Cursor::new(self.0.clone()))),
            _ => Err(io::ErrorKind::NotFound.into()),
        }
    }
}

/// Numbers that are the same on every machine (D. E. Knuth's generator).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % end.max(1)
    }
}

fn data(name: &str) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    std::fs::read(path.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The unpacked file. Long files lose their middle.
fn short(name: &str) -> Vec<u8> {
    let packed = data(name);
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(packed.as_slice())
        .read_to_end(&mut bytes)
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    if bytes.len() > KEPT {
        let end = bytes.split_off(bytes.len() - KEPT / 2);
        bytes.truncate(KEPT / 2);
        bytes.extend(end);
    }
    bytes
}

fn damaged(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    const PUT: &[u8] = b"0123456789.+-*,ED$ \n\r\tG\0\xff";
    let mut bytes = bytes.to_vec();
    for _ in 0..=numbers.below(4) {
        let place = numbers.below(bytes.len());
        let end = (place + numbers.below(50)).min(bytes.len());
        match numbers.below(6) {
            0 => bytes.truncate(place),
            1 => bytes[place] ^= 1 << numbers.below(8),
            2 => bytes[place] = PUT[numbers.below(PUT.len())],
            3 => drop(bytes.drain(place..end)),
            4 => {
                let part = bytes[place..end].to_vec();
                bytes.splice(place..place, part);
            }
            _ => {
                let number = numbers.below(usize::MAX).to_string();
                bytes.splice(place..end, number.into_bytes());
            }
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

fn refused(error: &FlexibleError) {
    let (problem, advice) = (error.to_string(), error.advice());
    assert!(!problem.is_empty() && !advice.is_empty(), "{problem}");
}

fn through_every_reader(bytes: Vec<u8>) {
    let files = Only(bytes);
    for (_, format) in MeshFormat::NAMED {
        match read_mesh(&files, "file", *format) {
            Ok(mesh) => {
                for element in &mesh.elements {
                    let count = element.kind.node_count();
                    assert_eq!(mesh.nodes_of(element).len(), count);
                }
            }
            Err(error) => refused(&error),
        }
    }
    for (_, format) in MatrixFormat::NAMED {
        match read_matrix(&files, "file", *format, "") {
            Ok(matrix) => {
                for (row, column, value) in &matrix.entries {
                    assert!((*row as usize) < matrix.rows && (*column as usize) < matrix.columns);
                    assert!(value.is_finite());
                }
                // a few lines may name a row of many digits: a matrix of that size is not made
                if matrix.rows < 100_000
                    && let Err(error) = matrix.to_symmetric(MatrixKind::Stiffness)
                {
                    refused(&error);
                }
            }
            Err(error) => refused(&error),
        }
    }
    for (_, format) in ShapeFormat::NAMED {
        if let Err(error) = read_modes(&files, "file", *format) {
            refused(&error);
        }
    }
    if let Err(problem) = read_calculix_freedoms(&files, "file") {
        refused(&problem.into());
    }
}

#[test]
fn damaged_files_through_every_reader() {
    let unpacked = [
        "bar8.bdf.gz",
        "bar8.inp.gz",
        "bar8.msh.gz",
        "crank_m_rbe3.bdf.gz",
        "calculix/tied.inp.gz",
        "calculix/twisted.sti.gz",
        "calculix/twisted.dof.gz",
        "calculix/twisted.frd.gz",
        "ansys/hexbeam.cdb.gz",
        "ansys/hypermesh.cdb.gz",
        "universal/wedge2.unv.gz",
        "med/old.med.gz",
        "med/wedge1.med.gz",
    ];
    let mut samples: Vec<Vec<u8>> = unpacked.iter().map(|name| short(name)).collect();
    // the compressed file, too
    samples.push(data("calculix/held.dof.gz"));
    let mut numbers = Numbers(1);
    for sample in samples {
        through_every_reader(sample.clone());
        for _ in 0..DAMAGES {
            through_every_reader(damaged(&sample, &mut numbers));
        }
    }
}

/// The stated word decides, not the name of the file. The error about a file with other contents names the word that
/// reads it.
#[test]
fn files_of_another_format_are_named_as_such() {
    let said = |error: FlexibleError| (error.to_string(), error.advice().to_owned());
    let deck = Only(short("bar8.inp.gz"));
    let (problem, advice) =
        said(read_mesh(&deck, "file", MeshFormat::Gmsh).expect_err("an input file of Abaqus"));
    assert!(problem.contains("states `gmsh(…)`"), "{problem}");
    assert!(problem.contains("keywords of an Abaqus"), "{problem}");
    assert!(advice.contains("`abaqus(…)` or `calculix(…)`"), "{advice}");
    let matrix = Only(short("calculix/twisted.sti.gz"));
    for format in [MatrixFormat::Op2, MatrixFormat::Op4, MatrixFormat::Dmig] {
        let (problem, advice) =
            said(read_matrix(&matrix, "file", format, "K").expect_err("lines of numbers"));
        assert!(
            problem.contains("in lines \"row column value\""),
            "{problem}"
        );
        assert!(advice.contains("`abaqus(…)` or `calculix(…)`"), "{advice}");
    }
    let (problem, advice) =
        said(read_modes(&matrix, "file", ShapeFormat::Op2).expect_err("no shapes"));
    assert!(problem.contains("states `format: op2`"), "{problem}");
    assert!(advice.contains("`format: frd`"), "{advice}");
    // the head of a MED file
    let med = Only(b"\x89HDF\r\n\x1a\n\x02\x08\x08\x00\x00\x00".to_vec());
    for (_, format) in MeshFormat::NAMED {
        let (problem, advice) = said(read_mesh(&med, "file", *format).expect_err("no mesh"));
        let (own, remedy) = match format {
            MeshFormat::Med => ("the file ends before its contents", "give a MED file"),
            _ => (
                "holds HDF5 data, as the MED files of code_aster and Salome",
                "write `med(…)` for this file",
            ),
        };
        assert!(problem.contains(own), "{problem}");
        assert!(advice.contains(remedy), "{advice}");
    }
    // a wrong file of the right format keeps its own message
    let (problem, _) = said(
        read_mesh(
            &Only(b"GRID,1,,x,0.,0.\n".to_vec()),
            "file",
            MeshFormat::Nastran,
        )
        .expect_err("no number"),
    );
    assert!(problem.starts_with("file:1: GRID: field X1"), "{problem}");
    // the text from a damaged compressed file is not used
    let mut packed = data("bar8.bdf.gz");
    let half = packed.len() / 2;
    packed.truncate(half);
    let (problem, _) =
        said(read_mesh(&Only(packed), "file", MeshFormat::Nastran).expect_err("half a file"));
    assert!(
        problem.contains("the compressed file is damaged"),
        "{problem}"
    );
}
