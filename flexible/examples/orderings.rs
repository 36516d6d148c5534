//! Fill, operations and times of the orders of elimination, on three-dimensional grids of cubes with three
//! freedoms a node (each node coupled with its 26 neighbours):
//! `cargo run --release -p eng-flexible --example orderings -- 20 30 40`; a number with an `f` after it is a
//! grid of one freedom a node coupled with 6 neighbours (finite differences).

use eng_flexible::FlexibleError;
use eng_flexible::solve::{Analysis, Definiteness, Factorization, Method, Ordering};
use eng_flexible::sparse::SymmetricMatrix;
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), FlexibleError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments = if arguments.is_empty() {
        vec!["12".into(), "20".into(), "40f".into()]
    } else {
        arguments
    };
    println!("grid  method            order s   fill M   operations G   factor s   solve 8 s");
    for argument in arguments {
        let differences = argument.ends_with('f');
        let Ok(side) = argument.trim_end_matches('f').parse::<u32>() else {
            eprintln!("not a number of nodes: {argument}");
            continue;
        };
        let matrix = grid(side, differences)?;
        for method in [Method::MinimumDegree, Method::NestedDissection] {
            let start = Instant::now();
            let ordering = Ordering::with_method(&matrix, method)?;
            let order = start.elapsed().as_secs_f64();
            let (fill, operations) = (ordering.entries(), ordering.operations());
            let analysis = Arc::new(Analysis::new(&matrix, ordering)?);
            let start = Instant::now();
            let factor = Factorization::new(&analysis, &matrix, Definiteness::Positive)?;
            let factored = start.elapsed().as_secs_f64();
            let mut right = vec![1.0; 8 * matrix.size()];
            let start = Instant::now();
            factor.solve_in_place(&mut right)?;
            println!(
                "{argument:4}  {:16} {order:8.3} {:8.2} {:14.2} {factored:10.3} {:11.3}",
                format!("{method:?}"),
                fill / 1e6,
                operations / 1e9,
                start.elapsed().as_secs_f64()
            );
        }
    }
    Ok(())
}

/// A diagonally dominant matrix of a grid of `side`³ nodes.
fn grid(side: u32, differences: bool) -> Result<SymmetricMatrix, FlexibleError> {
    let freedoms: u32 = if differences { 1 } else { 3 };
    let mut entries = Vec::new();
    let node = |x: u32, y: u32, z: u32| (z * side + y) * side + x;
    for z in 0..side {
        for y in 0..side {
            for x in 0..side {
                for (dz, dy, dx) in steps() {
                    if differences && dx.abs() + dy.abs() + dz.abs() > 1 {
                        continue;
                    }
                    let place = [x as i64 + dx, y as i64 + dy, z as i64 + dz];
                    if place.iter().any(|&at| at < 0 || at >= i64::from(side)) {
                        continue;
                    }
                    let one = node(x, y, z);
                    let two = node(place[0] as u32, place[1] as u32, place[2] as u32);
                    for i in 0..freedoms {
                        for j in 0..freedoms {
                            let (row, column) = (one * freedoms + i, two * freedoms + j);
                            if row == column {
                                entries.push((row, column, 82.0));
                            } else if row > column {
                                entries.push((row, column, -1.0));
                            }
                        }
                    }
                }
            }
        }
    }
    SymmetricMatrix::from_triplets(
        (node(side - 1, side - 1, side - 1) + 1) as usize * freedoms as usize,
        &entries,
    )
}

/// To a node's neighbours and itself.
fn steps() -> impl Iterator<Item = (i64, i64, i64)> {
    (0..27).map(|step| (step / 9 - 1, step / 3 % 3 - 1, step % 3 - 1))
}
