//! The same meshes through the readers of three formats.

use crate::support::DATA;
use std::collections::BTreeMap;

use eng_flexible::mesh::{Carries, Code, ElementKind, Mesh};
use eng_flexible::{Files, FlexibleError, MeshFormat, read_mesh};
use eng_system::mesh_files::Stated as _;

fn read(name: &str, format: &str) -> Mesh {
    let format = MeshFormat::named(format).expect("a format");
    match read_mesh(&DATA, name, format) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error} ({})", error.advice()),
    }
}

/// Sets of nodes as the generator listed them.
fn listed(model: &str) -> BTreeMap<String, Vec<u64>> {
    let file = DATA
        .open(&format!("{model}_sets.json.gz"))
        .expect("test data");
    let listed: serde_json::Value =
        serde_json::from_reader(flate2::read::GzDecoder::new(file)).expect("JSON");
    listed["sets"]
        .as_object()
        .expect("sets")
        .iter()
        .map(|(name, set)| {
            let nodes = set["nodes"].as_array().expect("nodes");
            let nodes = nodes.iter().map(|node| node.as_u64().expect("a number"));
            (name.clone(), nodes.collect())
        })
        .collect()
}

/// Numbers of the nodes of a set.
fn set_ids(mesh: &Mesh, name: &str) -> Vec<u64> {
    let set = &mesh.sets[name];
    let mut ids = set
        .nodes()
        .iter()
        .map(|node| mesh.nodes[*node as usize].id)
        .collect::<Vec<_>>();
    ids.sort_unstable();
    ids
}

/// Node numbers of each element in canonical order.
fn elements(mesh: &Mesh) -> Vec<(ElementKind, Vec<u64>)> {
    mesh.elements
        .iter()
        .map(|element| {
            let nodes = mesh.nodes_of(element).iter();
            let nodes = nodes.map(|node| mesh.nodes[*node as usize].id);
            (element.kind, nodes.collect())
        })
        .collect()
}

fn compare(model: &str, sets: usize) {
    let nastran = read(&format!("{model}.bdf.gz"), "nastran");
    let abaqus = read(&format!("{model}.inp.gz"), "abaqus");
    let mut calculix = read(&format!("{model}.inp.gz"), "calculix");
    assert_eq!((abaqus.code, calculix.code), (Code::Abaqus, Code::CalculiX));
    calculix.code = Code::Abaqus;
    assert!(abaqus == calculix);
    let mut gmsh = read(&format!("{model}.msh.gz"), "gmsh");
    assert!(gmsh.materials.is_empty());
    gmsh.set_material(2.06e11, 0.3, 7850.0).expect("a material");
    let listed = listed(model);
    assert_eq!(listed.len(), sets);
    for mesh in [&abaqus, &gmsh] {
        // bit for bit, in the same order
        assert_eq!(mesh.nodes, nastran.nodes);
        assert_eq!(elements(mesh), elements(&nastran));
        for (name, nodes) in &listed {
            assert_eq!(&set_ids(mesh, name), nodes, "{name}");
        }
        assert_eq!(mesh.materials.len(), 1);
        let (found, expected) = (&mesh.materials[0], &nastran.materials[0]);
        assert_eq!(
            (found.young, found.poisson, found.density),
            (expected.young, expected.poisson, expected.density)
        );
        assert!(
            mesh.properties
                .iter()
                .all(|property| property.material == Some(0))
        );
    }
    assert_eq!(abaqus.unread, []);
    assert!(
        gmsh.unread
            .iter()
            .all(|unread| unread.carries == Carries::Nothing)
    );
    assert_eq!(abaqus.sets["EALL"].elements().len(), nastran.elements.len());
    assert_eq!(abaqus.sets["NALL"].nodes().len(), nastran.nodes.len());
    assert_eq!(gmsh.sets["SOLID"].elements().len(), nastran.elements.len());
    assert_eq!(gmsh.sets["SOLID"].nodes().len(), nastran.nodes.len());
    assert_eq!(gmsh.sets["physical:1"], gmsh.sets["SOLID"]);
}

#[test]
fn bar_of_20_node_hexahedra() {
    compare("bar20", 2);
}

#[test]
fn bar_of_8_node_hexahedra() {
    compare("bar8", 2);
}

#[test]
fn crankshaft() {
    compare("crank_m", 11);
}

#[test]
fn a_material_is_given_once() {
    let mut mesh = read("bar8.msh.gz", "gmsh");
    for (young, poisson, density) in [
        (0.0, 0.3, 1.0),
        (1.0, 0.5, 1.0),
        (1.0, f64::NAN, 1.0),
        (1.0, 0.3, -1.0),
    ] {
        assert!(mesh.set_material(young, poisson, density).is_err());
    }
    assert!(mesh.materials.is_empty());
    mesh.set_material(2.06e11, 0.3, 7850.0).expect("a material");
    let Err(FlexibleError::Structure { problem, .. }) = mesh.set_material(1.0, 0.3, 1.0) else {
        panic!("two materials");
    };
    assert!(problem.contains("material of its own"), "{problem}");
    let mut own = read("bar8.inp.gz", "abaqus");
    assert!(own.set_material(1.0, 0.3, 1.0).is_err());
    // a density alone is taken from it, but not for another material
    own.materials[0].density = 0.0;
    let young = own.materials[0].young;
    assert!(own.set_material(0.5 * young, 0.3, 2700.0).is_err());
    assert_eq!(own.materials[0].density, 0.0);
    own.set_material(1.01 * young, 0.3, 7800.0)
        .expect("a density");
    assert_eq!(own.materials[0].density, 7800.0);
    assert_eq!(own.materials[0].young, young);
}

#[test]
fn formats_have_names() {
    assert_eq!(MeshFormat::named("calculix"), Some(MeshFormat::CalculiX));
    assert_eq!(MeshFormat::named("Nastran"), None);
}
