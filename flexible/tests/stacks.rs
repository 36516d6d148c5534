//! Bodies of stacked sections against closed forms, beam theory, and other meshes of the same shapes.

use eng_flexible::markers::{MESH_AXES, MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::Mesh;
use eng_flexible::read::{Files, nastran::read_bulk};
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::stack::stack_mesh;
use eng_flexible::units::MeshUnits;
use eng_system::mesh_files::Stated as _;
use eng_system::stack::{Corner, Section, Stack};
use serde_json::Value;
use std::f64::consts::PI;
use std::io::Read;
use std::path::{Path, PathBuf};

const YOUNG: f64 = 206e9;
const POISSON: f64 = 0.29;
const DENSITY: f64 = 7850.0;

fn corner(x: f64, y: f64, bend: f64) -> Corner {
    Corner {
        place: [x, y],
        bend,
    }
}

fn disc(center: [f64; 2], radius: f64, length: f64) -> Section {
    Section {
        corners: vec![
            corner(center[0] + radius, center[1], PI),
            corner(center[0] - radius, center[1], PI),
        ],
        length,
    }
}

fn made(size: f64, begin: f64, sections: Vec<Section>) -> Mesh {
    let stack = Stack {
        axis: 2,
        begin,
        size,
        sections,
    };
    let mut mesh = stack_mesh(&stack).unwrap_or_else(|error| panic!("{error}"));
    mesh.set_material(YOUNG, POISSON, DENSITY).unwrap();
    mesh
}

fn normal(count: usize) -> Term {
    Term::Normal {
        modes: Modes::Count(count),
        fixed: vec![],
    }
}

fn reduced(mesh: Mesh, markers: Vec<MarkerRequest>, terms: Vec<Term>) -> Reduced {
    let request = Request {
        markers,
        terms,
        ..Request::default()
    };
    reduce(mesh, &request).unwrap_or_else(|error| panic!("{error} ({})", error.advice()))
}

/// Mass, centre along z, inertia about the origin, and frequencies of a free body.
fn free(mesh: Mesh, modes: usize) -> Reduced {
    reduced(mesh, vec![], vec![normal(modes)])
}

fn near(found: f64, exact: f64, within: f64, what: &str) {
    let off = found / exact - 1.0;
    println!("{what}: {found:.8} for {exact:.8}, {:.4} %", 100.0 * off);
    assert!(off.abs() <= within, "{what}: {found} for {exact}");
}

/// Lowest symmetric bending frequencies (rad/s) of a free Timoshenko beam of length 2 h.
///
/// w = C₁ cos βx + C₂ cosh αx, ψ′ = w″ + a w with a = ρω²/(κG), and M = 0, w′ = ψ at the ends give
/// `(α² + a)/β · tan βh + (β² − a)/α · tanh αh = 0`. With c = ρω²/E, β² and −α² are the roots of
/// `λ² − (a + c) λ + a c − ρAω²/(EI) = 0`.
fn timoshenko(half: f64, radius: f64, count: usize) -> Vec<f64> {
    let area = PI * radius * radius;
    let inertia = PI * radius.powi(4) / 4.0;
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    // of a circle (J. R. Hutchinson, J. Appl. Mech. 68 (2001) 87-92)
    let factor =
        6.0 * (1.0 + POISSON) * (1.0 + POISSON) / (7.0 + 12.0 * POISSON + 4.0 * POISSON * POISSON);
    let value = |omega: f64| {
        let a = DENSITY * omega * omega / (factor * shear);
        let c = DENSITY * omega * omega / YOUNG;
        let root =
            ((a - c) * (a - c) + 4.0 * DENSITY * area * omega * omega / (YOUNG * inertia)).sqrt();
        let beta = (0.5 * (root + a + c)).sqrt();
        let alpha = (0.5 * (root - a - c)).sqrt();
        // times cos βh, so that it has no poles
        (alpha * alpha + a) / beta * (beta * half).sin()
            + (beta * beta - a) / alpha * (alpha * half).tanh() * (beta * half).cos()
    };
    let (mut found, step) = (Vec::new(), 20.0);
    let mut omega = step;
    while found.len() < count {
        if value(omega) * value(omega + step) < 0.0 {
            let (mut low, mut high) = (omega, omega + step);
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if value(low) * value(middle) <= 0.0 {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            found.push(low);
        }
        omega += step;
    }
    found
}

/// A steel cylinder of 40 mm by 400 mm: closed forms of mass, inertia, torsion and stretch, and beam theory
/// for bending.
#[test]
fn a_plain_cylinder() {
    let (radius, long) = (0.02, 0.4);
    let reduced = free(made(0.01, 0.0, vec![disc([0.0; 2], radius, long)]), 14);
    let c = &reduced.body.invariants;
    let mass = DENSITY * PI * radius * radius * long;
    // the quadratic facets of 22.5° lose θ⁴/480 of the area
    let facet = 5e-5;
    near(c.mass, mass, facet, "mass");
    near(c.first_moment[2] / c.mass, 0.5 * long, 1e-9, "centre");
    near(
        c.inertia[2][2],
        0.5 * mass * radius * radius,
        2.0 * facet,
        "polar inertia",
    );
    near(
        c.inertia[0][0],
        mass * (radius * radius / 4.0 + long * long / 3.0),
        facet,
        "transverse inertia",
    );
    let hz = &reduced.body.frequencies;
    let shear_speed = (YOUNG / (2.0 * (1.0 + POISSON)) / DENSITY).sqrt();
    let bar_speed = (YOUNG / DENSITY).sqrt();
    // torsion of a circular bar is exact; Rayleigh's correction of the first stretching mode for lateral inertia
    let torsion = [1.0, 2.0].map(|n| n * shear_speed / (2.0 * long));
    let lateral = POISSON * PI * radius / (2.0 * long);
    let stretch = bar_speed / (2.0 * long) / (1.0 + 2.0 * lateral * lateral).sqrt();
    let bending = timoshenko(0.5 * long, radius, 2).map_hz();
    let nearest = |exact: f64| {
        let apart = |x: &&f64| (**x - exact).abs();
        *hz.iter()
            .min_by(|a, b| apart(a).total_cmp(&apart(b)))
            .unwrap()
    };
    near(nearest(torsion[0]), torsion[0], 2e-4, "torsion 1");
    near(nearest(torsion[1]), torsion[1], 2e-4, "torsion 2");
    near(nearest(stretch), stretch, 3e-4, "stretch 1");
    near(hz[0], bending[0], 5e-4, "bending 1");
    near(hz[1], bending[0], 5e-4, "bending 1, across");
    near(nearest(bending[1]), bending[1], 2e-3, "bending 3");
}

trait Hertz {
    fn map_hz(self) -> Vec<f64>;
}

impl Hertz for Vec<f64> {
    fn map_hz(self) -> Vec<f64> {
        self.into_iter().map(|omega| omega / (2.0 * PI)).collect()
    }
}

/// Three cylinders of two diameters: closed forms of mass and inertia; the theory of torsion by sections
/// leaves out that the thick parts are not twisted near their corners.
#[test]
fn a_stepped_cylinder() {
    let (thin, thick) = (0.02, 0.03);
    let (end, middle) = (0.15, 0.2);
    let sections = vec![
        disc([0.0; 2], thick, end),
        disc([0.0; 2], thin, middle),
        disc([0.0; 2], thick, end),
    ];
    let reduced = free(made(0.01, -0.25, sections), 12);
    let c = &reduced.body.invariants;
    let square = |r: f64| PI * r * r * DENSITY;
    let (ends, between) = (2.0 * square(thick) * end, square(thin) * middle);
    near(c.mass, ends + between, 5e-5, "mass");
    let polar = 0.5 * (ends * thick * thick + between * thin * thin);
    near(c.inertia[2][2], polar, 1e-4, "polar inertia");
    let distance = 0.5 * (middle + end);
    let transverse = ends * (thick * thick / 4.0 + end * end / 12.0 + distance * distance)
        + between * (thin * thin / 4.0 + middle * middle / 12.0);
    near(c.inertia[0][0], transverse, 5e-5, "transverse inertia");
    // antisymmetric twist: J₁ sin(k b)·… : thin cot(k m/2) = thick tan(k e), J ~ r⁴
    let speed = (YOUNG / (2.0 * (1.0 + POISSON)) / DENSITY).sqrt();
    let value = |omega: f64| {
        let k = omega / speed;
        thin.powi(4) / (0.5 * k * middle).tan() - thick.powi(4) * (k * end).tan()
    };
    let (mut low, mut high) = (100.0, 0.5 * PI * speed / end * 0.999);
    for _ in 0..100 {
        let at = 0.5 * (low + high);
        if value(at) > 0.0 { low = at } else { high = at }
    }
    let torsion = low / (2.0 * PI);
    let hz = &reduced.body.frequencies;
    let apart = |x: &&f64| (**x - torsion).abs();
    let found = *hz
        .iter()
        .min_by(|a, b| apart(a).total_cmp(&apart(b)))
        .unwrap();
    near(found, torsion, 0.02, "torsion 1");
    assert!(
        found < torsion,
        "the corners are not twisted, so theory is stiffer"
    );
}

/// A web that points along the first axis (`turn` about it): round the pin, a waist, a sector as counterweight.
fn web(turn: f64, length: f64) -> Section {
    let throw = 0.043;
    let deg = PI / 180.0;
    let at = |[x, y]: [f64; 2], bend: f64| {
        let (sine, cosine) = turn.sin_cos();
        corner(cosine * x - sine * y, sine * x + cosine * y, bend)
    };
    let pin = |angle: f64| {
        [
            throw + 0.034 * (angle * deg).cos(),
            0.034 * (angle * deg).sin(),
        ]
    };
    let weight = |angle: f64| [0.073 * (angle * deg).cos(), 0.073 * (angle * deg).sin()];
    Section {
        corners: vec![
            at(pin(-100.0), 200.0 * deg),
            at(pin(100.0), 0.0),
            at([0.004, 0.037], 0.0),
            at(weight(106.0), 148.0 * deg),
            at(weight(-106.0), 0.0),
            at([0.004, -0.037], 0.0),
        ],
        length,
    }
}

/// The crank of examples/paper/mesh/make.py.
fn crank(size: f64) -> Mesh {
    let main = disc([0.0; 2], 0.027, 0.024);
    let neck = disc([0.0; 2], 0.023, 0.024);
    let flange = disc([0.0; 2], 0.04, 0.01);
    let mut sections = vec![flange.clone(), neck.clone(), main.clone()];
    for side in [1.0, -1.0, -1.0, 1.0] {
        let turn = if side > 0.0 { 0.0 } else { PI };
        sections.push(web(turn, 0.02));
        sections.push(disc([0.043 * side, 0.0], 0.024, 0.028));
        sections.push(web(turn, 0.02));
        sections.push(main.clone());
    }
    sections.extend([neck, flange]);
    made(size, -0.23, sections)
}

struct Paper;

impl Paper {
    fn folder() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/paper/mesh")
    }
}

impl Files for Paper {
    fn open(&self, name: &str) -> std::io::Result<Box<dyn Read>> {
        Ok(Box::new(std::fs::File::open(Paper::folder().join(name))?))
    }
}

fn gathered(name: &str, nodes: Selection) -> MarkerRequest {
    MarkerRequest {
        axes: MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Gathered {
            nodes,
            tie: Spider::Averaging,
            center: None,
        },
    }
}

/// Mains, pins and flange, and their static modes.
fn interfaces() -> (Vec<MarkerRequest>, Vec<Term>) {
    let ring = |name: String, center: [f64; 3], radius: f64, width: f64| {
        let ring = Selection::Ring {
            center,
            axis: [0.0, 0.0, 1.0],
            radius,
            width,
            tolerance: 1e-3 * radius,
        };
        gathered(&name, ring)
    };
    let mut markers: Vec<MarkerRequest> = (0..5)
        .map(|j| {
            let along = 0.092 * (f64::from(j) - 2.0);
            ring(format!("main[{}]", j + 1), [0.0, 0.0, along], 0.027, 0.024)
        })
        .collect();
    for (i, side) in [1.0, -1.0, -1.0, 1.0].into_iter().enumerate() {
        let center = [0.043 * side, 0.0, 0.092 * (i as f64 - 1.5)];
        markers.push(ring(format!("pin[{}]", i + 1), center, 0.024, 0.028));
    }
    let flange = Selection::Patch {
        center: [0.0, 0.0, 0.23],
        normal: [0.0, 0.0, 1.0],
        radius: 0.04,
        tolerance: 1e-5,
    };
    markers.push(gathered("flange", flange));
    let mut at: Vec<Interface> = (0..9)
        .map(|marker| Interface {
            marker,
            components: 0b11,
        })
        .collect();
    at.push(Interface {
        marker: 9,
        components: 0b10_0000,
    });
    (markers, vec![Term::Static(at), normal(12)])
}

/// The flexibilities of the static modes: the displacement at each load.
fn flexibilities(reduced: &Reduced) -> Vec<(String, f64)> {
    let served = reduced.report.served.iter();
    served
        .filter_map(|served| Some((served.mode.clone(), served.flexibility?)))
        .collect()
}

/// The paper's crank of stacked sections against its delivered mesh of ten-node tetrahedra, of about as many nodes.
///
/// Neither mesh is converged at the corners between journals and webs, which have no fillets: at a size of 9 mm (53,043
/// nodes) the first frequency of the stack is 0.66 % below that of the tetrahedra. A marker has the mean motion of its
/// nodes, which lie differently on the journals of the two meshes.
#[test]
fn the_papers_crank_against_its_tetrahedra() {
    let mut delivered = read_bulk(&Paper, "crank.bdf.gz").unwrap();
    delivered.convert(&MeshUnits::named("mm_tonne_s").unwrap());
    let (markers, terms) = interfaces();
    let exact = reduced(delivered, markers, terms);
    let reference: Value = serde_json::from_str(
        &std::fs::read_to_string(Paper::folder().join("reference.json")).unwrap(),
    )
    .unwrap();
    let independent: Vec<f64> = reference["crank"]["free_hz_exact_mass"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    for size in [0.011] {
        let (markers, terms) = interfaces();
        let mesh = crank(size);
        println!(
            "{} mm: {} nodes, {} elements",
            1e3 * size,
            mesh.nodes.len(),
            mesh.elements.len()
        );
        let stacked = reduced(mesh.clone(), markers, terms);
        let within = 3e-3;
        let (c, d) = (&stacked.body.invariants, &exact.body.invariants);
        near(c.mass, d.mass, 5e-4, "mass");
        for k in 0..3 {
            near(c.inertia[k][k], d.inertia[k][k], 5e-4, "inertia");
        }
        let modes = free(mesh, 12);
        for (k, (found, known)) in modes.body.frequencies.iter().zip(&independent).enumerate() {
            near(*found, *known, within, &format!("frequency {}", k + 1));
        }
        let mut worst: f64 = 0.0;
        for ((mode, found), (same, known)) in
            flexibilities(&stacked).iter().zip(flexibilities(&exact))
        {
            assert_eq!(*mode, same);
            let off = found / known - 1.0;
            println!("{mode}: {:.4} %", 100.0 * off);
            worst = worst.max(off.abs());
        }
        assert!(worst <= 4e-3, "{worst}");
    }
}
