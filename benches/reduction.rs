//! Reduction of large bodies of ten-node tetrahedra, phase by phase, beside CalculiX where it is installed.
//!
//! `cargo bench -p eng-flexible --bench reduction [-- ROUNDS] [crank | block | bulky]`. Three bodies: the crankshaft of
//! the test data (31,277 nodes), an engine block of walls, deck and four liners that is made here (more than 100,000
//! nodes), and a bulky one of as many nodes, solid between its bores. Each gets 20 static and 20 free normal modes and
//! its invariants; CalculiX (`ccx`) gets the same elements and computes the same free modes alone. Both work on one
//! thread where this can be set, in processes of their own, alternating. Times are CPU seconds (user and system), the
//! least of all rounds, because other programs disturb them less than clock time. Memory is the largest use of a
//! process. This works only on Linux, because `/proc` gives both.

use eng_flexible::fe::mass::rigid_motions;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::invariants::{Full, invariants};
use eng_flexible::markers::{MESH_AXES, MarkerPlace, MarkerRequest, Selection, Spider, place};
use eng_flexible::mesh::{Element, ElementKind, Material, Mesh, Node, Property, Section, Variant};
use eng_flexible::modes::normal::normal_modes;
use eng_flexible::modes::statics::attachment_modes_by;
use eng_flexible::modes::{Boundary, Candidate, Load, ModeSet, Structure};
use eng_flexible::read::Files;
use eng_flexible::reduce::{Interface, Request, Term, reduce};
use eng_flexible::solve::{Modes, Shifted};
use eng_flexible::sparse::SymmetricMatrix;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{Read, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

type Failure = Box<dyn std::error::Error>;

/// Elastic modes; a free body has six more.
const NORMAL: usize = 20;
const RIGID: usize = 6;

const CASES: [&str; 3] = ["crank", "block", "bulky"];

struct Here;

impl Files for Here {
    fn open(&self, name: &str) -> std::io::Result<Box<dyn Read>> {
        Ok(Box::new(std::fs::File::open(name)?))
    }
}

/// A mesh in SI and 20 freedoms of markers.
struct Case {
    mesh: Mesh,
    markers: Vec<MarkerRequest>,
    at: Vec<Interface>,
}

impl Case {
    fn new(name: &str) -> Result<Case, Failure> {
        let marker = |name: String, nodes: Selection| MarkerRequest {
            name,
            place: MarkerPlace::Gathered {
                nodes,
                tie: Spider::Averaging,
                center: None,
            },
            axes: MESH_AXES,
        };
        if name == "crank" {
            let deck = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/crank_m.bdf.gz");
            let ring = |j: u32| Selection::Ring {
                center: [0.013 + 0.096 * f64::from(j), 0.0, 0.0],
                axis: [1.0, 0.0, 0.0],
                radius: 0.0275,
                width: 0.026,
                tolerance: 1e-5,
            };
            return Ok(Case {
                mesh: eng_flexible::read::nastran::read_bulk(&Here, deck)?,
                markers: (0..5)
                    .map(|j| marker(format!("main[{}]", j + 1), ring(j)))
                    .collect(),
                // across the axis, and bending
                at: (0..5)
                    .map(|marker| Interface {
                        marker,
                        components: 0b11_0110,
                    })
                    .collect(),
            });
        }
        let patch = |x: f64, y: f64, z: f64| Selection::Patch {
            center: [x, y, z],
            normal: [0.0, 0.0, 1.0],
            radius: 0.03,
            tolerance: 1e-6,
        };
        let cells = if name == "bulky" { BULKY } else { CELLS };
        let size = cells.map(|n| f64::from(n) * SIDE);
        let mut markers = Vec::new();
        let mut at = Vec::new();
        for (z, components) in [(0.0, 0b111), (size[2], 0b11)] {
            for x in [0.0, size[0]] {
                for y in [0.0, size[1]] {
                    at.push(Interface {
                        marker: markers.len(),
                        components,
                    });
                    markers.push(marker(
                        format!("corner[{}]", markers.len() + 1),
                        patch(x, y, z),
                    ));
                }
            }
        }
        Ok(Case {
            mesh: if name == "bulky" {
                cubes(BULKY, is_bulky)
            } else {
                cubes(CELLS, is_solid)
            },
            markers,
            at,
        })
    }
}

/// Cells of the block along x, y and z, their side (m), and radius and places of its bores (cells).
const CELLS: [u32; 3] = [56, 26, 29];
const SIDE: f64 = 0.008;
const BORE: f64 = 5.5;
const BORES: [f64; 4] = [7.5, 21.5, 35.5, 49.5];
/// Bearing walls, one cell thick, and how high they and the crankcase are.
const WALLS: [u32; 5] = [0, 14, 28, 42, 55];
const CRANKCASE: u32 = 14;

/// Cells of the bulky block; radius and places of its bores, height of its crankcase, middles of the bearing
/// walls there.
const BULKY: [u32; 3] = [50, 16, 22];
const BULKY_BORE: f64 = 4.0;
const BULKY_BORES: [f64; 4] = [6.25, 18.75, 31.25, 43.75];
const BULKY_CRANKCASE: u32 = 8;
const BULKY_WALLS: [f64; 5] = [1.0, 12.5, 25.0, 37.5, 49.0];

/// Whether the bulky block has a cell: all but the bores above the crankcase, and walls of two cells about and in it.
fn is_bulky([x, y, z]: [u32; 3]) -> bool {
    let [across, along] = [x, y].map(|n| f64::from(n) + 0.5);
    if z >= BULKY_CRANKCASE {
        let off = |center: &f64| (across - center).hypot(along - 0.5 * f64::from(BULKY[1]));
        return BULKY_BORES.iter().all(|center| off(center) >= BULKY_BORE);
    }
    let outside = [(x, BULKY[0]), (y, BULKY[1])]
        .iter()
        .any(|(at, count)| *at < 2 || at + 2 >= *count);
    outside || BULKY_WALLS.iter().any(|wall| (across - wall).abs() <= 1.0)
}

/// Whether the block of walls has a cell: outer walls, deck, liners above the crankcase, bearing walls in it.
fn is_solid([x, y, z]: [u32; 3]) -> bool {
    let [across, along] = [x, y].map(|n| f64::from(n) + 0.5);
    let off = |center: &f64| (across - center).hypot(along - 0.5 * f64::from(CELLS[1]));
    let distance = BORES.iter().map(off).fold(f64::INFINITY, f64::min);
    let outside = [(x, CELLS[0]), (y, CELLS[1])]
        .iter()
        .any(|(at, count)| *at == 0 || at + 1 == *count);
    let deck = z + 1 == CELLS[2] && distance >= BORE;
    let liner = z >= CRANKCASE && (BORE..BORE + 1.0).contains(&distance);
    outside || deck || liner || (z < CRANKCASE && WALLS.contains(&x))
}

/// The cubes of a block that are there, each six tetrahedra about its diagonal (H. W. Kuhn, 1960: they fit
/// from cube to cube).
fn cubes(cells: [u32; 3], is_there: impl Fn([u32; 3]) -> bool) -> Mesh {
    let mut corners: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let mut mesh = Mesh {
        materials: vec![Material {
            name: "iron".into(),
            young: 1.1e11,
            poisson: 0.26,
            density: 7200.0,
            sheet: None,
            solid: None,
        }],
        properties: vec![Property {
            name: "block".into(),
            material: Some(0),
            section: Section::Solid,
        }],
        ..Mesh::default()
    };
    let add = |nodes: &mut Vec<Node>, position: [f64; 3]| {
        nodes.push(Node {
            id: nodes.len() as u64 + 1,
            position,
            frame: None,
        });
        nodes.len() as u32 - 1
    };
    // paths along three edges from corner to corner; the odd ones make tetrahedra of the other hand
    let paths = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [1, 0, 2],
        [0, 2, 1],
        [2, 1, 0],
    ];
    for z in 0..cells[2] {
        for y in 0..cells[1] {
            for x in 0..cells[0] {
                if !is_there([x, y, z]) {
                    continue;
                }
                for (hand, path) in paths.iter().enumerate() {
                    let mut place = [x, y, z];
                    let mut four = [0; 4];
                    for (k, node) in four.iter_mut().enumerate() {
                        if k > 0 {
                            place[path[k - 1]] += 1;
                        }
                        *node = *corners.entry(place).or_insert_with(|| {
                            add(&mut mesh.nodes, place.map(|n| f64::from(n) * SIDE))
                        });
                    }
                    if hand >= 3 {
                        four.swap(1, 2);
                    }
                    let first = mesh.connectivity.len() as u32;
                    mesh.connectivity.extend(four);
                    for [i, j] in [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]] {
                        let ends = [four[i].min(four[j]), four[i].max(four[j])];
                        let [a, b] = ends.map(|n| mesh.nodes[n as usize].position);
                        let middle = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
                        let node = *middles
                            .entry(ends)
                            .or_insert_with(|| add(&mut mesh.nodes, middle));
                        mesh.connectivity.push(node);
                    }
                    mesh.elements.push(Element {
                        id: mesh.elements.len() as u64 + 1,
                        kind: ElementKind::Tetrahedron10,
                        variant: Variant::Plain,
                        property: 0,
                        first,
                        beam: None,
                        shell: None,
                    });
                }
            }
        }
    }
    mesh
}

/// CPU seconds of a process and of its children that have ended, from `/proc/self/stat` (100 ticks a second on Linux).
fn processor_time() -> Result<[f64; 2], Failure> {
    let text = std::fs::read_to_string("/proc/self/stat")?;
    let after = text.rsplit(')').next().ok_or("no name")?;
    let fields: Vec<f64> = after
        .split_whitespace()
        .skip(11)
        .take(4)
        .map(str::parse)
        .collect::<Result<_, _>>()?;
    match fields[..] {
        [user, system, of_children, system_of_children] => Ok([
            (user + system) / 100.0,
            (of_children + system_of_children) / 100.0,
        ]),
        _ => Err("fields are missing".into()),
    }
}

/// The most memory that a process has held (MB).
fn peak(process: &str) -> Option<f64> {
    let text = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

/// Prints CPU and clock seconds and the peak so far, phase by phase.
struct Clock {
    begin: Instant,
    spent: f64,
}

impl Clock {
    fn new() -> Result<Clock, Failure> {
        Ok(Clock {
            begin: Instant::now(),
            spent: processor_time()?[0],
        })
    }

    fn tell(&mut self, phase: &str) -> Result<(), Failure> {
        let spent = processor_time()?[0];
        println!(
            "  {phase:<34} {:>8.2} {:>8.2} {:>8.0}",
            spent - self.spent,
            self.begin.elapsed().as_secs_f64(),
            peak("self").unwrap_or(f64::NAN)
        );
        // the time of the look-up is not counted
        *self = Clock::new()?;
        Ok(())
    }
}

/// The phases of [`reduce`] one by one.
fn phases(name: &str) -> Result<(), Failure> {
    let mut clock = Clock::new()?;
    let Case {
        mut mesh,
        markers,
        at,
    } = Case::new(name)?;
    clock.tell("read, or make")?;
    let places = place(&mut mesh, &markers)?;
    let mut full = assemble(&mesh, &Rules::default())?;
    clock.tell("assemble")?;
    let reduction = Reduction::new(&mesh, &full, &[])?;
    let stiffness = reduction.reduce_stiffness(&full.stiffness)?;
    let mass = reduction.reduce_mass(&full.mass)?;
    full.stiffness = SymmetricMatrix::default();
    let motions = rigid_motions(&mesh, &full.freedoms);
    let structure = Structure::free(&stiffness, &mass, reduction.restrict(&motions))?;
    clock.tell("take ties out")?;
    let analysis = structure.analysis()?;
    clock.tell("order, and structure of the factor")?;
    let ordering = analysis.ordering();
    println!(
        "    {:?}: {:.1} million entries in {:.1} million places, {:.0} thousand million operations",
        ordering.method(),
        ordering.entries() / 1e6,
        analysis.stored() as f64 / 1e6,
        ordering.operations() / 1e9
    );
    let mut factor = Some(Shifted::new(&stiffness, &mass, &analysis)?);
    clock.tell("factor")?;
    let mut loads = Vec::new();
    for interface in &at {
        for component in (0..6u8).filter(|c| interface.components & (1 << c) != 0) {
            let freedom = full.freedoms.freedom(places[interface.marker], component);
            let (rows, factors) = reduction.row(freedom.ok_or("a marker does not turn")?);
            loads.push(Load {
                label: format!("{}.{component}", markers[interface.marker].name),
                entries: rows.iter().copied().zip(factors.iter().copied()).collect(),
            });
        }
    }
    let answers = attachment_modes_by(&mut factor, &structure, &loads)?;
    clock.tell(&format!("{} static modes", loads.len()))?;
    let found = normal_modes(factor, &structure, Modes::Count(NORMAL), &Boundary::AsIs)?;
    clock.tell(&format!("{NORMAL} normal modes and their count"))?;
    let size = structure.size();
    let vectors = answers
        .chunks_exact(size)
        .chain(found.vectors.chunks_exact(size));
    let candidates = vectors
        .enumerate()
        .map(|(index, vector)| Candidate {
            label: format!("{index}"),
            vector: vector.to_vec(),
            noise: 0.0,
        })
        .collect();
    drop((answers, found));
    let set = ModeSet::new(&structure, candidates)?;
    clock.tell("orthonormal set")?;
    let shapes = reduction.expand(set.len(), &set.vectors);
    let constants = invariants(
        &Full {
            freedoms: &full.freedoms,
            mass: &full.mass,
            condensed: false,
            rigid: &motions,
        },
        &shapes,
        &set.stiffness,
    );
    clock.tell("invariants")?;
    println!("    {} modes, {:.3} kg", constants.modes, constants.mass);
    Ok(())
}

/// The whole reduction, as for a model. The last line is for the parent process: CPU seconds, MB, frequencies.
fn whole(name: &str) -> Result<(), Failure> {
    let Case { mesh, markers, at } = Case::new(name)?;
    let request = Request {
        markers,
        terms: vec![
            Term::Static(at),
            Term::Normal {
                modes: Modes::Count(NORMAL),
                fixed: vec![],
            },
        ],
        damping_up_to: f64::INFINITY,
        ..Request::default()
    };
    let reduced = reduce(mesh, &request)?;
    let mut line = format!(
        "{} {}",
        processor_time()?[0],
        peak("self").unwrap_or(f64::NAN)
    );
    // the lowest modes of the set are the normal modes themselves: static modes add higher ones
    for frequency in reduced.body.frequencies.iter().take(NORMAL) {
        write!(line, " {frequency:.9e}")?;
    }
    println!("{line}");
    Ok(())
}

/// The output of a run: CPU seconds, MB, frequencies (Hz).
#[derive(Clone, Debug)]
struct Figures {
    seconds: f64,
    memory: f64,
    frequencies: Vec<f64>,
}

impl Figures {
    /// The better of two in each respect.
    fn least(self, other: Option<Figures>) -> Figures {
        match other {
            None => self,
            Some(other) => Figures {
                seconds: self.seconds.min(other.seconds),
                memory: self.memory.min(other.memory),
                frequencies: self.frequencies,
            },
        }
    }
}

fn ours(name: &str) -> Result<Figures, Failure> {
    let output = Command::new(std::env::current_exe()?)
        .args(["whole", name])
        .stderr(Stdio::inherit())
        .output()?;
    let text = String::from_utf8(output.stdout)?;
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(str::parse)
        .collect::<Result<_, _>>()?;
    match numbers[..] {
        [seconds, memory, ref frequencies @ ..] => Ok(Figures {
            seconds,
            memory,
            frequencies: frequencies.to_vec(),
        }),
        _ => Err("the run failed".into()),
    }
}

/// The deck of the elements for CalculiX, which computes the free modes.
fn write_deck(mesh: &Mesh, path: &Path) -> Result<(), Failure> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "*NODE, NSET=ALL")?;
    for node in &mesh.nodes {
        let [x, y, z] = node.position;
        writeln!(file, "{}, {x:.12e}, {y:.12e}, {z:.12e}", node.id)?;
    }
    writeln!(file, "*ELEMENT, TYPE=C3D10, ELSET=SOLID")?;
    for element in &mesh.elements {
        let ids: Vec<String> = mesh
            .nodes_of(element)
            .iter()
            .map(|node| mesh.nodes[*node as usize].id.to_string())
            .collect();
        writeln!(file, "{}, {}", element.id, ids.join(", "))?;
    }
    let material = mesh.materials.first().ok_or("no material")?;
    writeln!(
        file,
        "*MATERIAL, NAME=M\n*ELASTIC\n{:e}, {}\n*DENSITY\n{}\n*SOLID SECTION, ELSET=SOLID, MATERIAL=M\n*STEP\n*FREQUENCY\n{}\n*END STEP",
        material.young,
        material.poisson,
        material.density,
        NORMAL + RIGID
    )?;
    Ok(file.flush()?)
}

/// A folder of its own for CalculiX, removed when it is dropped.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        // the system removes the remaining temporary files
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// `None` if CalculiX is not installed.
fn calculix(name: &str) -> Result<Option<Figures>, Failure> {
    let folder = Folder(std::env::temp_dir().join(format!("reduction-{}", std::process::id())));
    std::fs::create_dir_all(&folder.0)?;
    write_deck(&Case::new(name)?.mesh, &folder.0.join("body.inp"))?;
    let before = processor_time()?[1];
    let started = Command::new("ccx")
        .arg("body")
        .current_dir(&folder.0)
        .env("OMP_NUM_THREADS", "1")
        .env("OPENBLAS_NUM_THREADS", "1")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let mut child = match started {
        Ok(child) => child,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let mut memory = 0.0_f64;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        memory = memory.max(peak(&child.id().to_string()).unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(20));
    };
    if !status.success() {
        return Err(format!("ccx: {status}").into());
    }
    let seconds = processor_time()?[1] - before;
    // lines of the table: number, eigenvalue, rad/s, Hz, imaginary part
    let table = std::fs::read_to_string(folder.0.join("body.dat"))?;
    let mut frequencies = Vec::new();
    for line in table.lines() {
        let numbers: Option<Vec<f64>> = line.split_whitespace().map(|x| x.parse().ok()).collect();
        match numbers.as_deref() {
            Some([number, _, _, frequency, _]) if *number as usize == frequencies.len() + 1 => {
                frequencies.push(*frequency);
            }
            _ => {}
        }
    }
    Ok(Some(Figures {
        seconds,
        memory,
        frequencies: frequencies.split_off(RIGID.min(frequencies.len())),
    }))
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["whole", name] => return whole(name),
        ["phases", name] => return phases(name),
        _ => {}
    }
    let rounds: u32 = arguments.iter().find_map(|a| a.parse().ok()).unwrap_or(2);
    let asked = |name: &&str| arguments.iter().any(|a| a == name);
    let all = !CASES.iter().any(asked);
    for name in CASES.into_iter().filter(|name| all || asked(name)) {
        let mesh = Case::new(name)?.mesh;
        println!(
            "{name}: {} nodes, {} elements; CPU s, clock s, most memory so far MB",
            mesh.nodes.len(),
            mesh.elements.len()
        );
        drop(mesh);
        let status = Command::new(std::env::current_exe()?)
            .args(["phases", name])
            .status()?;
        if !status.success() {
            return Err(format!("{name}: {status}").into());
        }
        let (mut own, mut other) = (None, None);
        for _ in 0..rounds.max(1) {
            own = Some(ours(name)?.least(own));
            other = calculix(name)?.map(|found| found.least(other));
        }
        let Some(own) = own else { continue };
        println!("  whole: {:.2} s, {:.0} MB", own.seconds, own.memory);
        let Some(other) = other else {
            println!("  CalculiX is not installed here (no ccx on the path): not compared");
            continue;
        };
        let apart = own.frequencies.iter().zip(&other.frequencies);
        let apart = apart.fold(0.0_f64, |worst, (a, b)| worst.max((a / b - 1.0).abs()));
        println!(
            "  CalculiX, {NORMAL} normal modes alone: {:.2} s, {:.0} MB; whole/CalculiX {:.3}; frequencies apart by {apart:.1e}",
            other.seconds,
            other.memory,
            own.seconds / other.seconds
        );
    }
    Ok(())
}
