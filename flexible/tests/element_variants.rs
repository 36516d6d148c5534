//! Elements that their code does not integrate in full: against CalculiX' frequencies, Abaqus' matrices and beam
//! theory. Refused elements.

use crate::fe_meshes;
use crate::nastran_deck;

use crate::nastran_deck::Memory;
use crate::support::{Data, apart};
use eng_flexible::Files;
use eng_flexible::fe::{MassRule, Rules, assemble, form};
use eng_flexible::mesh::{Code, ElementKind, Mesh, Variant};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::recover::Recovery;
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::store::{Key, StoredBody};
use serde_json::Value;
use std::io::Read;

const DATA: Data = Data("variants");

fn reference() -> Value {
    let mut text = String::new();
    let mut file = DATA.open("reference.json").unwrap();
    file.read_to_string(&mut text).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn of_calculix(name: &str) -> Vec<f64> {
    let found = reference();
    let list = found["calculix"][name].as_array().unwrap();
    list.iter().map(|f| f.as_f64().unwrap()).collect()
}

fn read(name: &str, code: Code) -> Mesh {
    read_inp(&DATA, name, code).unwrap()
}

/// Frequencies (Hz) of a mesh in SI.
fn frequencies(mesh: Mesh, rules: Rules, count: usize) -> Vec<f64> {
    let request = Request {
        rules,
        terms: vec![Term::Normal {
            modes: Modes::Count(count),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    match reduce(mesh, &request) {
        Ok(reduced) => reduced.body.frequencies,
        Err(error) => panic!("{error}"),
    }
}

/// Distorted bars; CalculiX prints seven digits.
#[test]
fn frequencies_are_those_of_calculix() {
    for (name, moved) in [
        ("c3d8", 0.0),
        ("c3d6", 0.02),
        ("c3d20r", 0.002),
        ("c3d8i", 0.2),
    ] {
        let exact = of_calculix(name);
        let mesh = || read(&format!("{name}.inp.gz"), Code::CalculiX);
        let found = frequencies(mesh(), Rules::calculix(), exact.len());
        assert!(apart(&found, &exact) < 1e-6, "{name}: {found:?} {exact:?}");
        // full integration is another element
        let full = frequencies(mesh(), Rules::exact(), exact.len());
        assert!(apart(&full, &exact) > moved, "{name}: {full:?}");
    }
    // the elements that the file names are read in the same way without rules in the text
    for name in ["c3d20r", "c3d8i"] {
        let exact = of_calculix(name);
        let found = frequencies(
            read(&format!("{name}.inp.gz"), Code::CalculiX),
            Rules::default(),
            exact.len(),
        );
        assert!(apart(&found, &exact) < 1e-6, "{found:?}");
    }
}

/// Stiffness (columns of three nodes) and mass that Abaqus 2021 writes for a block of 90 C3D8.
#[test]
fn the_hexahedron_of_abaqus_has_its_matrices() {
    let mesh = read("abaqus_c3d8.inp.gz", Code::Abaqus);
    let structure = assemble(&mesh, &Rules::abaqus()).unwrap();
    let plain = assemble(&mesh, &Rules::exact()).unwrap();
    let index = mesh.node_index();
    let freedom = |entry: &Value, at: usize| {
        let number = |i: usize| entry[i].as_u64().unwrap();
        let node = index[&number(at)];
        structure
            .freedoms
            .freedom(node, number(at + 1) as u8 - 1)
            .unwrap()
    };
    let reference = reference();
    let entries = reference["abaqus_c3d8"]["stiffness"].as_array().unwrap();
    let value = |entry: &Value| entry[4].as_f64().unwrap();
    let largest = entries.iter().map(|e| value(e).abs()).fold(0.0, f64::max);
    let (mut worst, mut of_full) = (0.0f64, 0.0f64);
    let entry_of = |stiffness: &eng_flexible::sparse::SymmetricMatrix, i: usize, j: usize| {
        let (rows, values) = stiffness.column(i.min(j));
        let found = rows.iter().position(|row| *row as usize == i.max(j));
        found.map_or(0.0, |at| values[at])
    };
    for entry in entries {
        let (i, j) = (freedom(entry, 0), freedom(entry, 2));
        worst = worst.max((entry_of(&structure.stiffness, i, j) - value(entry)).abs() / largest);
        of_full = of_full.max((entry_of(&plain.stiffness, i, j) - value(entry)).abs() / largest);
    }
    assert!(worst < 1e-13, "{worst}");
    assert!(of_full > 0.1, "{of_full}");
    let mass = structure.mass.assembled().unwrap();
    for entry in reference["abaqus_c3d8"]["mass"].as_array().unwrap() {
        let i = freedom(entry, 0);
        let exact = entry[2].as_f64().unwrap();
        assert!((entry_of(&mass, i, i) / exact - 1.0).abs() < 1e-13);
    }
}

/// A bar 1 × 0.05 × 0.05 m of 1 × 1 × 20 hexahedra.
fn bar(code: Code) -> Mesh {
    let mut mesh = fe_meshes::bar(ElementKind::Hexahedron8, [20, 1, 1], [1.0, 0.05, 0.05]);
    mesh.code = code;
    mesh
}

/// First bending of the free bar, Bernoulli: 4.730041² / 2π √(E I / ρ A L⁴).
#[test]
fn hexahedra_of_nastran_bend_as_beams() {
    let radius = 0.05 / 12f64.sqrt();
    let speed = (fe_meshes::YOUNG / fe_meshes::DENSITY).sqrt();
    let beam = 4.730_040_744_862_704f64.powi(2) / std::f64::consts::TAU * speed * radius;
    let of = |mesh, rules| frequencies(mesh, rules, 1)[0] / beam - 1.0;
    let found = of(bar(Code::Nastran), Rules::default());
    assert!(found.abs() < 0.005, "{found}");
    // full integration locks
    let full = of(bar(Code::Nastran), Rules::exact());
    assert!((0.22..0.25).contains(&full), "{full}");
    // a mesh of no code names no rule and must not lock either
    assert_eq!(of(bar(Code::None), Rules::default()), found);
    assert_eq!(of(bar(Code::None), Rules::nastran()), found);
    assert_eq!(of(bar(Code::None), Rules::exact()), full);
}

/// Solids whose shear Nastran integrates by a rule of its own, which is not public.
#[test]
fn solids_of_nastran_in_full_are_told() {
    use ElementKind::{Hexahedron20, Tetrahedron10, Wedge6, Wedge15};
    let told = |kind, code, rules: Rules| {
        let mut mesh = fe_meshes::bar(kind, [2, 1, 1], [0.2, 0.1, 0.1]);
        mesh.code = code;
        form::warnings(&mesh, &rules)
    };
    for (kind, name) in [
        (Hexahedron20, "CHEXA (20 nodes)"),
        (Wedge6, "CPENTA (6 nodes)"),
        (Wedge15, "CPENTA (15 nodes)"),
    ] {
        let words = told(kind, Code::Nastran, Rules::default());
        assert!(words.len() == 1 && words[0].contains(name), "{words:?}");
        assert!(told(kind, Code::Nastran, Rules::exact()).is_empty());
        assert!(told(kind, Code::None, Rules::default()).is_empty());
    }
    assert!(told(Tetrahedron10, Code::Nastran, Rules::default()).is_empty());
}

/// Bending of one box by κ about y, u = κ (x z, −ν y z, −(x² + ν (z² − y²))/2): energy ½ E I κ² L for every Poisson's
/// ratio.
#[test]
fn incompatible_modes_bend_a_box_exactly() {
    let size = [0.3, 0.2, 0.1];
    let mut mesh = fe_meshes::bar(ElementKind::Hexahedron8, [1, 1, 1], size);
    let nu = fe_meshes::POISSON;
    let middle: [f64; 3] =
        std::array::from_fn(|k| mesh.nodes.iter().map(|node| node.position[k]).sum::<f64>() / 8.0);
    let energy = |mesh: &Mesh, rules: Rules| {
        let structure = assemble(mesh, &rules).unwrap();
        let mut full = vec![0.0; structure.freedoms.size()];
        for (index, node) in (0u32..).zip(&mesh.nodes) {
            let [x, y, z]: [f64; 3] = std::array::from_fn(|k| node.position[k] - middle[k]);
            let u = [x * z, -nu * y * z, -0.5 * (x * x + nu * (z * z - y * y))];
            let first = structure.freedoms.of(index).start;
            full[first..first + 3].copy_from_slice(&u);
        }
        let mut force = vec![0.0; full.len()];
        use eng_flexible::sparse::SymmetricOperator;
        structure.stiffness.apply(1, &full, &mut force);
        0.5 * full.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>()
    };
    let inertia = size[1] * size[2].powi(3) / 12.0;
    let exact = 0.5 * fe_meshes::YOUNG * inertia * size[0];
    mesh.code = Code::Nastran;
    let found = energy(&mesh, Rules::default());
    assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    assert!(energy(&mesh, Rules::exact()) > 2.0 * exact);
}

/// The hexahedron with modes of its own inside. Its mass is that of its volume. Its energies and stresses include the
/// amplitudes of its modes and are those of its matrices. A stored body keeps the numbering of the modes.
#[test]
fn amplitudes_inside_elements_count_in_mass_energy_and_store() {
    let mesh = read("c3d8i.inp.gz", Code::CalculiX);
    let (nodes, elements) = (mesh.nodes.len(), mesh.elements.len());
    let request = Request {
        terms: vec![Term::Normal {
            modes: Modes::Count(6),
            fixed: Vec::new(),
        }],
        geometric_stiffness: true,
        ..Request::default()
    };
    let reduced = reduce(mesh.clone(), &request).unwrap();
    assert_eq!(reduced.freedoms.size(), 3 * nodes + 9 * elements);
    let exact = eng_flexible::fe::volume::estimate(&mesh).unwrap();
    assert!((reduced.body.invariants.mass / exact.mass - 1.0).abs() < 0.01);
    let plain = assemble(&mesh, &Rules::exact()).unwrap().mass.rigid(&mesh);
    assert!((reduced.body.invariants.mass / plain.mass - 1.0).abs() < 1e-12);
    let stored = StoredBody::new(reduced, request.rules, Key([0; 32]), Vec::new());
    let a = [1e-4, -2e-4, 3e-4, 1e-4, 2e-4, -1e-4];
    let full = Recovery::of_stored(&stored)
        .unwrap()
        .displacements(&a)
        .unwrap();
    let sum = fe_meshes::energy_of_solids(&stored.mesh, &stored.freedoms, &request.rules, &full);
    let energy = fe_meshes::modal_energy(&stored.body, &a);
    assert!((sum / energy - 1.0).abs() < 1e-10, "{sum} {energy}");
    let bytes = stored.to_bytes().unwrap();
    let again = StoredBody::from_bytes(&bytes).unwrap();
    assert_eq!(again.freedoms, stored.freedoms);
    assert_eq!(again.shapes, stored.shapes);
    // a diagonal mass has none inside, and all of the element's
    let rules = Rules {
        mass: MassRule::Lumped,
        ..Rules::calculix()
    };
    let lumped = assemble(&mesh, &rules).unwrap().mass.rigid(&mesh);
    assert!((lumped.mass / plain.mass - 1.0).abs() < 1e-12);
}

/// A deck with one element of a type.
fn deck(name: &str, nodes: usize) -> String {
    let list: Vec<String> = (1..=nodes).map(|n| n.to_string()).collect();
    let mut text = String::from("*NODE\n");
    for n in 1..=nodes {
        text += &format!("{n},{},{},{}\n", n % 3, n / 3 % 3, n / 9);
    }
    text += &format!("*ELEMENT,TYPE={name},ELSET=E\n1,{}\n", list.join(","));
    text + "*MATERIAL,NAME=S\n*ELASTIC\n2.1E11,0.3\n*DENSITY\n7850.\n*SOLID SECTION,ELSET=E,MATERIAL=S\n"
}

#[test]
fn variants_without_their_rule_are_refused_by_name() {
    let mesh = |name: &str, nodes, code| {
        let files = Memory::new(&[("deck.inp", &deck(name, nodes))]);
        read_inp(&files, "deck.inp", code).unwrap()
    };
    for (name, nodes, codes) in [
        ("C3D8R", 8, &[Code::Abaqus, Code::CalculiX][..]),
        ("C3D8I", 8, &[Code::Abaqus]),
        ("C3D8RH", 8, &[Code::Abaqus]),
        ("C3D10M", 10, &[Code::Abaqus]),
        ("C3D10H", 10, &[Code::Abaqus]),
        ("C3D20RH", 20, &[Code::Abaqus]),
    ] {
        for code in codes {
            let mesh = mesh(name, nodes, *code);
            for rules in [Rules::default(), Rules::abaqus(), Rules::calculix()] {
                if name == "C3D8I" && rules == Rules::calculix() {
                    assert!(form::check(&mesh, rules.stiffness).is_ok());
                    continue;
                }
                let error = form::check(&mesh, rules.stiffness).unwrap_err();
                assert!(
                    error.to_string().contains(&format!("1 × {name} ")),
                    "{error}"
                );
                assert!(error.advice().contains("element_rules = exact"), "{error}");
                let why = match (name, code, rules == Rules::calculix()) {
                    ("C3D8R", Code::Abaqus, false) => "carries all of its bending",
                    ("C3D8R", Code::CalculiX, _) if rules != Rules::abaqus() => "also for the mass",
                    ("C3D10M", ..) => "modified functions",
                    _ => "",
                };
                assert!(error.to_string().contains(why), "{error}");
            }
            assert!(form::check(&mesh, Rules::exact().stiffness).is_ok());
            // not without a message
            assert!(form::warnings(&mesh, &Rules::exact())[0].contains(name));
        }
    }
    for (name, nodes, code) in [
        ("C3D20R", 20, Code::Abaqus),
        ("C3D20RT", 20, Code::CalculiX),
        ("C3D8", 8, Code::Abaqus),
        ("C3D10", 10, Code::CalculiX),
        ("C3D8I", 8, Code::CalculiX),
    ] {
        let mesh = mesh(name, nodes, code);
        assert!(
            form::check(&mesh, Rules::default().stiffness).is_ok(),
            "{name}"
        );
        assert!(
            form::warnings(&mesh, &Rules::default()).is_empty(),
            "{name}"
        );
    }
}

#[test]
fn integration_of_psolid_is_read() {
    let of = |network: &str| {
        let deck = format!(
            "BEGIN BULK\nMAT1,1,2.1+11,,.3,7850.\nPSOLID,2,1,{network}\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nGRID,5,,0.,0.,1.\nGRID,6,,1.,0.,1.\nGRID,7,,1.,1.,1.\nGRID,8,,0.,1.,1.\nCHEXA,1,2,1,2,3,4,5,6,+\n+,7,8\nENDDATA\n"
        );
        nastran_deck::mesh(&deck)
    };
    let stiffness = |mesh: &Mesh, rules| assemble(mesh, &rules).unwrap().stiffness;
    let bubble = stiffness(&of(""), Rules::default());
    for network in [",BUBBLE", ",0,,REDUCED", ",,,FULL"] {
        assert_eq!(
            stiffness(&of(network), Rules::default()),
            bubble,
            "{network}"
        );
    }
    let full = of(",TWO,,FULL");
    assert_eq!(
        full.elements[0].variant,
        Variant::Network {
            points: 2,
            full: true
        }
    );
    assert_eq!(
        stiffness(&full, Rules::default()),
        stiffness(&of(""), Rules::exact())
    );
    let reduced = of(",2");
    let error = form::check(&reduced, Rules::default().stiffness).unwrap_err();
    assert!(
        error.to_string().contains("1 × CHEXA (8 nodes, IN = 2)"),
        "{error}"
    );
    let deck = "BEGIN BULK\nPSOLID,2,1,,GAUSS\nGRID,1,,0.,0.,0.\nENDDATA\n";
    assert!(
        nastran_deck::problem(deck)
            .problem
            .contains("IN is \"GAUSS\"")
    );
}

/// CalculiX 2.20 gives the free beam of 1 m with `CIRC`, 0.02 its first bending at 92.73569 Hz: 0.02 m is the
/// diameter. It expands beams into solids, which here are beams.
#[test]
fn sections_of_calculix_are_read_as_it_reads_them() {
    let deck = |section: &str| {
        let mut text = String::from("*NODE\n");
        for n in 0..=40 {
            text += &format!("{},{},0.,0.\n", n + 1, 0.025 * f64::from(n));
        }
        text += "*ELEMENT,TYPE=B32R,ELSET=E\n";
        for e in 0..20 {
            text += &format!("{},{},{},{}\n", e + 1, 2 * e + 1, 2 * e + 2, 2 * e + 3);
        }
        text + &format!(
            "*MATERIAL,NAME=S\n*ELASTIC\n2.1E11,0.3\n*DENSITY\n7850.\n*BEAM SECTION,ELSET=E,MATERIAL=S,SECTION={section}\n0.,1.,0.\n"
        )
    };
    let read = |section: &str, code| {
        let files = Memory::new(&[("deck.inp", &deck(section))]);
        read_inp(&files, "deck.inp", code)
    };
    let first =
        |section: &str, code| frequencies(read(section, code).unwrap(), Rules::default(), 1)[0];
    let found = first("CIRC\n0.02", Code::CalculiX);
    assert!((found / 92.73569 - 1.0).abs() < 0.01, "{found}");
    let radius = first("CIRC\n0.01", Code::Abaqus);
    assert!((radius / found - 1.0).abs() < 1e-9, "{radius}");
    // names of four letters; without the second side the section is a square
    let square = first("RECTANGULAR\n0.02", Code::CalculiX);
    let plain = first("RECT\n0.02,0.02", Code::Abaqus);
    assert!((square / plain - 1.0).abs() < 1e-9, "{square} {plain}");
    assert!(read("RECTANGULAR\n0.02", Code::Abaqus).is_err());
    let ellipse = read("CIRCULAR\n0.02,0.03", Code::CalculiX).unwrap_err();
    assert!(ellipse.to_string().contains("ellipse"), "{ellipse}");
}
