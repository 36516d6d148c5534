//! Reduces a Nastran deck in SI and prints times: `cargo run --release -p eng-flexible --example reduce -- DECK`.

use eng_flexible::fe::Rules;
use eng_flexible::markers::{MarkerRequest, Place, Selection, Spider};
use eng_flexible::read::Files;
use eng_flexible::reduce::{Interface, Request, Term, reduce};
use eng_flexible::solve::Modes;
use std::io::Read;
use std::time::Instant;

struct Here;

impl Files for Here {
    fn open(&self, name: &str) -> std::io::Result<Box<dyn Read>> {
        Ok(Box::new(std::fs::File::open(name)?))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let deck = std::env::args().nth(1).ok_or("give a deck")?;
    let start = Instant::now();
    let mesh = eng_flexible::read::nastran::read_bulk(&Here, &deck)?;
    println!(
        "read {:.2} s: {} nodes, {} elements",
        start.elapsed().as_secs_f64(),
        mesh.nodes.len(),
        mesh.elements.len()
    );
    let markers: Vec<MarkerRequest> = (0..5)
        .map(|j| MarkerRequest {
            name: format!("main[{}]", j + 1),
            place: Place::Gathered {
                nodes: Selection::Ring {
                    center: [0.013 + 0.096 * f64::from(j), 0.0, 0.0],
                    axis: [1.0, 0.0, 0.0],
                    radius: 0.0275,
                    width: 0.026,
                    tolerance: 1e-5,
                },
                tie: Spider::Averaging,
                center: None,
            },
        })
        .collect();
    let at = (0..5)
        .map(|marker| Interface {
            marker,
            components: 0b110,
        })
        .collect();
    let request = Request {
        rules: if std::env::args().nth(2).is_some() {
            Rules::calculix()
        } else {
            Rules::default()
        },
        markers,
        support: vec![],
        terms: vec![
            Term::Static(at),
            Term::Normal {
                modes: Modes::Count(20),
                fixed: vec![],
            },
        ],
        damping_ratio: 0.02,
        damping_up_to: 3000.0,
        ..Request::default()
    };
    let begin = Instant::now();
    let reduced = reduce(mesh, &request)?;
    println!("reduce {:.2} s", begin.elapsed().as_secs_f64());
    let c = &reduced.body.invariants;
    println!(
        "mass {} kg, first moment {:?}, inertia {:?}",
        c.mass, c.first_moment, c.inertia
    );
    println!("frequencies {:?}", reduced.body.frequencies);
    println!("dropped {:?}", reduced.report.dropped);
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(line) = status.lines().find(|l| l.starts_with("VmHWM")) {
        println!("peak memory {}", line.trim_start_matches("VmHWM:").trim());
    }
    Ok(())
}
