//! Reduces the crankshaft of the test data (or a similar deck in SI) and prints the results:
//! `cargo run --release -p eng-flexible --example reduce -- DECK [static | constraint | held]`: static modes at the
//! journals and free normal modes, constraint modes and fixed-interface modes, or static modes with the first journal
//! held.

use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
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
            axes: eng_flexible::markers::MESH_AXES,
            name: format!("main[{}]", j + 1),
            place: MarkerPlace::Gathered {
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
    let at: Vec<Interface> = (0..5)
        .map(|marker| Interface {
            marker,
            components: 0b110,
        })
        .collect();
    let normal = |fixed: Vec<Interface>| Term::Normal {
        modes: Modes::Count(20),
        fixed,
    };
    let kind = std::env::args().nth(2);
    let (support, terms) = match kind.as_deref() {
        None | Some("static") => (vec![], vec![Term::Static(at), normal(vec![])]),
        Some("constraint") => (vec![], vec![Term::Constraint(at.clone()), normal(at)]),
        Some("held") => {
            let first = Interface {
                marker: 0,
                components: 0b11_1111,
            };
            (
                vec![first],
                vec![Term::Static(at[1..].to_vec()), normal(vec![])],
            )
        }
        Some(other) => return Err(format!("{other} is none of static, constraint, held").into()),
    };
    let request = Request {
        markers,
        support,
        terms,
        damping_ratio: 0.02,
        damping_up_to: 3000.0,
        asked: (0..5)
            .map(|marker| Interface {
                marker,
                components: 0b11_1111,
            })
            .collect(),
        ..Request::default()
    };
    let begin = Instant::now();
    let reduced = reduce(mesh, &request)?;
    println!("reduce {:.2} s", begin.elapsed().as_secs_f64());
    let report = &reduced.report;
    println!(
        "{} kg, centre {:?} m, inertia {:?} kg m²",
        report.body.mass, report.body.centre, report.body.inertia
    );
    if let Some(estimate) = &report.estimate {
        println!("between straight edges {} kg", estimate.mass);
    }
    println!(
        "rigid motion leaves {:.1e} of the forces",
        report.rigid_residual
    );
    for mode in &report.modes {
        let effective: Vec<String> = mode
            .effective_mass
            .iter()
            .map(|x| format!("{x:.1e}"))
            .collect();
        println!(
            "{:10.2} Hz  {}  {}",
            mode.frequency,
            effective.join(" "),
            mode.description
        );
    }
    for served in &report.served {
        println!("{served:?}");
    }
    for dropped in &report.dropped {
        println!("{dropped:?}");
    }
    for load in &report.unserved {
        println!("{} is not served: {:.1e} missing", load.label, load.missing);
    }
    for warning in &report.warnings {
        println!("warning: {warning}");
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(line) = status.lines().find(|l| l.starts_with("VmHWM")) {
        println!("peak memory {}", line.trim_start_matches("VmHWM:").trim());
    }
    Ok(())
}
