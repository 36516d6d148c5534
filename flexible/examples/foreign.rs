//! Lists what the readers of foreign matrices and modes find in a file: `foreign FILE [NAME]`.

use std::io::{self, Read};

use eng_flexible::Files;
use eng_flexible::read::matrix::{
    MatrixKind, read_frd_modes, read_matrix, read_op2_modes, read_op2_nodes, read_punch_modes,
};

/// The file system.
struct Disk;

impl Files for Disk {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        Ok(Box::new(std::fs::File::open(name)?))
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let (file, name) = (
        arguments.next().unwrap_or_default(),
        arguments.next().unwrap_or_default(),
    );
    match read_matrix(&Disk, &file, &name) {
        Err(problem) => println!("{problem}\n  {}", problem.advice),
        Ok(matrix) => {
            let sum = |weight: &dyn Fn(f64, f64) -> f64| {
                matrix
                    .entries
                    .iter()
                    .map(|(row, column, value)| {
                        weight(f64::from(*row) + 1.0, f64::from(*column) + 1.0) * value
                    })
                    .sum::<f64>()
            };
            println!(
                "matrix {} {}x{} triangle={} entries={} sum={:e} row-weighted={:e} column-weighted={:e} freedoms={:?}",
                matrix.name,
                matrix.rows,
                matrix.columns,
                matrix.symmetric,
                matrix.entries.len(),
                sum(&|_, _| 1.0),
                sum(&|row, _| row),
                sum(&|_, column| column),
                matrix.freedoms.as_ref().map(|freedoms| freedoms.rows.len())
            );
            match matrix.to_symmetric(MatrixKind::Mass) {
                Ok(symmetric) => println!("  symmetric, {} entries", symmetric.values().len()),
                Err(error) => println!("  {error}\n  {}", error.advice()),
            }
        }
    }
    for modes in [
        read_op2_modes(&Disk, &file),
        read_punch_modes(&Disk, &file),
        read_frd_modes(&Disk, &file),
    ] {
        match modes {
            Err(problem) => println!("modes: {problem}\n  {}", problem.advice),
            Ok(modes) => {
                println!(
                    "modes on {} nodes {:?} {:?}",
                    modes.nodes.len(),
                    modes.frame,
                    modes.warnings
                );
                for mode in &modes.modes {
                    let sum = mode
                        .shape
                        .iter()
                        .zip(1..)
                        .map(|(row, i)| {
                            f64::from(i)
                                * row
                                    .iter()
                                    .zip(1..)
                                    .map(|(x, k)| x * f64::from(k))
                                    .sum::<f64>()
                        })
                        .sum::<f64>();
                    println!("  mode {} {:?} {sum:e}", mode.number, mode.eigenvalue);
                }
            }
        }
    }
    match read_op2_nodes(&Disk, &file) {
        Err(problem) => println!("nodes: {problem}"),
        Ok(nodes) => println!(
            "nodes {} first {:?} sum {:?}",
            nodes.len(),
            nodes.first(),
            nodes.iter().flat_map(|(_, place)| place).sum::<f64>()
        ),
    }
}
