//! MED files: the same meshes written by gmsh in two formats; one solid of each shape as the library of Salome writes it; the
//! layout of version 2.2; many groups; shells; wrong and damaged files with their messages.

use std::io::Read;
use std::path::Path;

use crate::nastran_deck::{Memory, element_ids, is_consistent, set, set_ids, unread};
use eng_flexible::markers::{MESH_AXES, MarkerRequest};
use eng_flexible::mesh::{Carries, ElementKind, Mesh, Section};
use eng_flexible::read::{ShellGroups, read_mesh_with_shells};
use eng_flexible::reduce::{Interface, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_flexible::{FlexibleError, MeshFormat, read_mesh};
use eng_system::flexible::{ALL_FREEDOMS, MarkerPlace, Selection, Spider};
use eng_system::mesh_files::Stated as _;

/// An unpacked file in `tests/data`.
fn data(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let packed = std::fs::read(folder.join(format!("{name}.gz"))).unwrap();
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(packed.as_slice())
        .read_to_end(&mut bytes)
        .unwrap();
    bytes
}

fn files(name: &str, bytes: Vec<u8>) -> Memory {
    let mut files = Memory::default();
    files.0.insert(name.into(), bytes);
    files
}

fn try_read(bytes: Vec<u8>) -> Result<Mesh, FlexibleError> {
    read_mesh(&files("a.med", bytes), "a.med", MeshFormat::Med)
}

fn mesh(name: &str) -> Mesh {
    match try_read(data(&format!("med/{name}.med"))) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{name}: {error} ({})", error.advice()),
    }
}

fn of_gmsh(name: &str) -> Mesh {
    read_mesh(&files("a.msh", data(name)), "a.msh", MeshFormat::Gmsh).unwrap()
}

/// Mass, inertia, the frequencies of free modes and those of modes with held groups.
fn numbers(mut mesh: Mesh, held: Option<&str>) -> Vec<f64> {
    mesh.convert(&MeshUnits::named("mm_tonne_s").unwrap());
    mesh.set_material(2.1e11, 0.3, 7850.0).unwrap();
    let markers: Vec<MarkerRequest> = held
        .iter()
        .map(|name| MarkerRequest {
            axes: MESH_AXES,
            name: (*name).into(),
            place: MarkerPlace::Gathered {
                nodes: Selection::Set((*name).into()),
                tie: Spider::Averaging,
                center: None,
            },
        })
        .collect();
    let fixed = || {
        let all = 0..markers.len();
        let interface = |marker| Interface {
            marker,
            components: ALL_FREEDOMS,
        };
        all.map(interface).collect::<Vec<_>>()
    };
    let normal = |fixed| Term::Normal {
        modes: Modes::Count(8),
        fixed,
    };
    let mut terms = vec![normal(fixed())];
    if held.is_some() {
        terms.push(Term::Constraint(fixed()));
    }
    let request = Request {
        markers: markers.clone(),
        terms,
        ..Request::default()
    };
    let body = reduce(mesh, &request).unwrap().body;
    let mut found = vec![body.invariants.mass];
    found.extend(body.invariants.inertia.iter().flatten());
    found.extend(&body.frequencies);
    found
}

fn are_equal(name: &str, found: &[f64], exact: &[f64], bound: f64) {
    assert!(found.len() > 15 && found.len() == exact.len(), "{found:?}");
    for (x, y) in found.iter().zip(exact) {
        let scale = y.abs().max(1e-6 * exact[0]);
        assert!((x - y).abs() <= bound * scale, "{name}: {x} {y}");
    }
}

/// Nodes of each element by their numbers, sorted.
fn nodes_of_all(mesh: &Mesh) -> Vec<Vec<u64>> {
    let ids = mesh.elements.iter().map(|e| element_ids(mesh, e.id));
    let mut ids: Vec<Vec<u64>> = ids.collect();
    ids.sort();
    ids
}

/// gmsh writes each block as `.msh` and as `.med`: the same elements, groups, mass, inertia and frequencies.
#[test]
fn blocks_of_gmsh_are_the_same_in_both_formats() {
    use ElementKind::{Hexahedron8, Hexahedron20, Tetrahedron4, Tetrahedron10, Wedge6, Wedge15};
    for (name, kind) in [
        ("tet1", Tetrahedron4),
        ("tet2", Tetrahedron10),
        ("hex1", Hexahedron8),
        ("hex2", Hexahedron20),
        ("wedge1", Wedge6),
        ("wedge2", Wedge15),
    ] {
        let own = mesh(name);
        is_consistent(&own);
        let other = of_gmsh(&format!("universal/{name}.msh"));
        assert!(own.elements.iter().all(|e| e.kind == kind), "{name}");
        assert_eq!(nodes_of_all(&own), nodes_of_all(&other), "{name}");
        for set in ["LEFT", "RIGHT", "BLOCK"] {
            assert_eq!(set_ids(&own, set), set_ids(&other, set), "{name} {set}");
        }
        assert_eq!(own.properties[0].name, "BLOCK");
        let faces = unread(&own);
        assert_eq!(faces.len(), 1, "{faces:?}");
        assert_eq!(
            (faces[0].0, faces[0].2),
            ("points, lines and surfaces on solids", Carries::Nothing)
        );
        for held in [None, Some("LEFT")] {
            let (found, exact) = (numbers(own.clone(), held), numbers(other.clone(), held));
            are_equal(name, &found, &exact, 1e-12);
        }
    }
}

/// One hexahedron, pyramid, wedge and tetrahedron of each order, as the library of Salome writes them in version 4.2, against
/// the file that gmsh makes of them. So Salome and gmsh confirm the orders of nodes.
#[test]
fn every_shape_of_salome() {
    use ElementKind::{
        Hexahedron8, Hexahedron20, Pyramid5, Pyramid13, Tetrahedron4, Tetrahedron10, Wedge6,
        Wedge15,
    };
    for (name, kinds) in [
        ("kinds1", [Tetrahedron4, Hexahedron8, Wedge6, Pyramid5]),
        ("kinds2", [Tetrahedron10, Hexahedron20, Wedge15, Pyramid13]),
    ] {
        let own = mesh(name);
        is_consistent(&own);
        let mut found: Vec<ElementKind> = own.elements.iter().map(|e| e.kind).collect();
        found.sort();
        assert_eq!(found, kinds, "{name}");
        assert_eq!(set(&own, "BODY").elements().len(), 4);
        assert_eq!(set(&own, "HALF").elements().len(), 2);
        assert_eq!(set_ids(&own, "LEFT"), [1, 4, 5, 8]);
        assert_eq!(set_ids(&own, "RIGHT"), [10, 11]);
        let other = of_gmsh(&format!("med/{name}.msh"));
        assert_eq!(nodes_of_all(&own), nodes_of_all(&other), "{name}");
        are_equal(name, &numbers(own, None), &numbers(other, None), 1e-12);
    }
}

/// The same mesh in the layout of MED 2.2, which is an older form of HDF5, too.
#[test]
fn files_of_version_2() {
    let (old, new) = (mesh("old"), mesh("kinds1"));
    assert_eq!(old.nodes, new.nodes);
    assert_eq!(old.connectivity, new.connectivity);
    assert_eq!(old.sets, new.sets);
    assert_eq!(old.properties, new.properties);
}

/// Some files of code_aster have all solids mirrored.
#[test]
fn mirrored_solids() {
    let (mirrored, plain) = (mesh("mirrored"), mesh("kinds2"));
    assert_eq!(mirrored.connectivity, plain.connectivity);
    assert_eq!(mirrored.sets, plain.sets);
}

/// HDF5 keeps the names of 300 families in a heap with a tree.
#[test]
fn many_groups() {
    let many = mesh("many");
    assert_eq!((many.elements.len(), many.sets.len()), (300, 300));
    for cell in 0..300_u32 {
        let own = set(&many, &format!("CELL_{:03}", cell + 1));
        assert_eq!(own.elements(), [cell]);
        let along = own
            .nodes()
            .iter()
            .map(|node| many.nodes[*node as usize].position[0]);
        let first = along.fold(f64::INFINITY, f64::min);
        assert!((first - 10.0 * f64::from(cell)).abs() < 1e-12, "{cell}");
    }
}

/// Surfaces without solids stop a reduction, unless they are stated to be shells.
#[test]
fn surfaces_are_shells_of_a_stated_thickness() {
    let plain = mesh("cover");
    assert_eq!(plain.elements.len(), 1);
    let left_out: Vec<(&str, Carries)> = unread(&plain).iter().map(|u| (u.0, u.2)).collect();
    assert_eq!(
        left_out,
        [
            ("QU4 without solids", Carries::Structure),
            ("TR3 without solids", Carries::Structure),
            ("points, lines and surfaces on solids", Carries::Nothing),
        ]
    );
    assert_eq!(set_ids(&plain, "FOOT"), [1, 2, 3, 4]);
    let with = |group: &str| {
        let groups = [group.to_owned()];
        let shells = ShellGroups {
            groups: &groups,
            thickness: 3.0,
        };
        let files = files("a.med", data("med/cover.med"));
        read_mesh_with_shells(&files, "a.med", MeshFormat::Med, shells)
    };
    let shells = with("COVER").unwrap();
    is_consistent(&shells);
    assert_eq!(set(&shells, "COVER").elements().len(), 2);
    assert_eq!(set_ids(&shells, "COVER"), [6, 7, 9, 10, 11]);
    assert_eq!(unread(&shells).len(), 1);
    let thick = shells.properties.iter().filter_map(|p| match p.section {
        Section::Shell(shell) => Some((p.name.as_str(), shell.thickness)),
        _ => None,
    });
    assert_eq!(thick.collect::<Vec<_>>(), [("COVER", 3.0)]);
    let error = with("LID").unwrap_err();
    assert!(
        error.to_string().contains(
            "the group LID has no triangle and no quadrangle; groups of surfaces are COVER, FOOT"
        ),
        "{error}"
    );
}

/// Each wrong file with the beginning of its message after the name of the file, and a part of the advice. STEP is the folder
/// of the only step.
const WRONG: [(&str, &str, &str); 21] = [
    (
        "version",
        "INFOS_GENERALES: the file has version 5.2 of MED",
        "from 2.2 to 4",
    ),
    (
        "no_version",
        "the HDF5 data state no version of MED",
        "give a MED file",
    ),
    ("no_mesh", "the file has no mesh", "write the mesh"),
    (
        "meshes",
        "the file has 2 meshes: kinds, other",
        "a file of its own",
    ),
    (
        "steps",
        "ENS_MAA/kinds: the mesh changes in 2 computing steps",
        "undeformed",
    ),
    (
        "structured",
        "ENS_MAA/kinds: the mesh is structured",
        "unstructured",
    ),
    (
        "cylindrical",
        "STEP/NOE: the nodes have cylindrical or spherical",
        "Cartesian",
    ),
    (
        "part",
        "STEP/NOE: the mesh is a part of a mesh",
        "the whole mesh",
    ),
    (
        "packed",
        "STEP/NOE/COO: it has datasets in compressed",
        "h5repack -f NONE",
    ),
    (
        "polyhedra",
        "STEP/MAI/POE: the mesh has polygons or polyhedra",
        "tetrahedra",
    ),
    (
        "middle",
        "STEP/MAI/H27: Eng does not read cells H27",
        "order 2 without nodes",
    ),
    (
        "node",
        "STEP/MAI/HE8: cell 1 uses node 13, but the mesh has 12",
        "all its nodes",
    ),
    (
        "no_node",
        "STEP/MAI/HE8: cell 1 uses node 0,",
        "all its nodes",
    ),
    (
        "odd",
        "STEP/MAI/HE8: it has 9 nodes, 1 families and 0 numbers",
        "again",
    ),
    (
        "reals",
        "STEP/MAI/HE8/NOD: its values are no whole numbers",
        "again",
    ),
    (
        "infinite",
        "STEP/NOE/COO: its values are no finite real",
        "again",
    ),
    ("numbers", "STEP/NOE: two nodes have the number 1", "again"),
    ("no_nodes", "STEP: the mesh has no nodes NOE/COO", "again"),
    (
        "no_solids",
        "the file has no solid element",
        "`shells: [\"COVER\"]",
    ),
    (
        "shared",
        "FAS/kinds/ELEME/Shared_5/GRO/NOM: the file is damaged: its datasets share their values",
        "again",
    ),
    (
        "overlap",
        "ENS_MAA/kinds/FAS: the file is damaged: a name has no end",
        "again",
    ),
];

#[test]
fn wrong_files_and_their_messages() {
    let step = "ENS_MAA/kinds/-0000000000000000001-0000000000000000001";
    for (name, problem, advice) in WRONG {
        let error = try_read(data(&format!("med/wrong_{name}.med"))).unwrap_err();
        let text = error.to_string();
        let wanted = format!("a.med: {}", problem.replace("STEP", step));
        // a problem of a whole file has no place after its name
        assert!(text.starts_with(&wanted), "{name}: {text}");
        assert!(
            error.advice().contains(advice),
            "{name}: {}",
            error.advice()
        );
    }
    // another format has its own message
    let deck = Memory::new(&[("a.med", "SOL 103\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\n")]);
    let error = read_mesh(&deck, "a.med", MeshFormat::Med).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("states `med(…)`, but the file holds cards of Nastran")
    );
}

/// Groups are lost if the file does not describe the families of their members. A family without groups loses none.
#[test]
fn families_without_a_description_are_noted() {
    let notes = |nodes: usize, cells: usize| {
        [("nodes", nodes), ("cells", cells)].map(|(members, count)| {
            format!(
                "the file does not describe the families of some {members} ({count}), so their groups are lost"
            )
        })
    };
    // six nodes are in a family without groups
    assert!(mesh("kinds1").doubts.is_empty());
    assert!(mesh("old").doubts.is_empty());
    let rest = mesh("wrong_lost");
    assert_eq!(rest.doubts, notes(2, 2));
    assert_eq!(set(&rest, "BODY").elements().len(), 2);
    let left: Vec<&str> = rest.sets.keys().map(String::as_str).collect();
    assert_eq!(left, ["BODY", "LEFT"]);
    let none = mesh("wrong_no_groups");
    assert_eq!(none.doubts, notes(12, 4));
    assert!(none.sets.is_empty());
}

#[test]
fn unknown_folders_are_noted() {
    let unknown = mesh("wrong_unknown");
    let names: Vec<(&str, Carries)> = unread(&unknown).iter().map(|u| (u.0, u.2)).collect();
    assert!(
        names.contains(&("folder CHA", Carries::Nothing)),
        "{names:?}"
    );
    assert!(
        names.contains(&("folder STRUCT_ELEM", Carries::Unknown)),
        "{names:?}"
    );
}

/// Files cut at any place, and files with changed bytes: each is read, or refused with advice.
#[test]
fn damaged_files() {
    let mut seed = 1_u64;
    let mut below = |end: usize| {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 33) as usize % end.max(1)
    };
    let mut outcomes = [0, 0];
    for name in ["kinds1", "old", "many", "tet2"] {
        let whole = data(&format!("med/{name}.med"));
        for cut in (0..whole.len()).step_by(whole.len() / 150) {
            let error = try_read(whole[..cut].to_vec()).unwrap_err();
            assert!(!error.advice().is_empty(), "{error}");
        }
        let rounds = if name == "many" { 150 } else { 1500 };
        for _ in 0..rounds {
            let mut bytes = whole.clone();
            for _ in 0..=below(6) {
                let place = below(bytes.len());
                bytes[place] = match below(3) {
                    0 => 0xff,
                    1 => 0,
                    _ => bytes[place] ^ (1 << below(8)),
                };
            }
            match try_read(bytes) {
                Ok(mesh) => {
                    is_consistent(&mesh);
                    outcomes[0] += 1;
                }
                Err(error) => {
                    assert!(!error.advice().is_empty(), "{error}");
                    outcomes[1] += 1;
                }
            }
        }
    }
    assert!(outcomes.iter().all(|count| *count > 100), "{outcomes:?}");
}
