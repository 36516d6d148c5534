//! MED files of Salome, code_aster and gmsh (`.med`, `.mmed`): nodes, solids, shells of stated thickness, groups.
//!
//! MED is a layout of HDF5 data. The file has no material, so the properties, one for each first group of solids or shells,
//! have none either; [`Mesh::set_material`] sets it. Points, lines and surfaces on solids only add their nodes to groups.
//!
//! Sources: `med-fichier` documentation, versions 2.3 to 4.1 (EDF, CEA); order of nodes: files of gmsh 4.15 and of
//! medcoupling 9.14.
//!
//! ```text
//! hdf5 ─▶ folder (paths, messages) ─┬▶ families ─┬▶ mesh
//!                                   └▶ cells ────┘
//! ```

mod cells;
mod families;
mod folder;
mod model;

use std::io::Read;

use crate::error::{FileProblem, FlexibleError};
use crate::mesh::Mesh;
use crate::read::hdf5::Hdf5;
use crate::read::source::whole;
use crate::read::{Files, ShellGroups};
use folder::{AGAIN, File, Folder};

/// The largest file in bytes, unpacked. A choice: a mesh of ten million nodes has half of it.
const LARGEST: u64 = 1 << 31;

/// Reads a MED file. A mesh with shells may have no volume. Values keep the units of the file.
///
/// # Errors
/// With the path in the file: a file that can't be read or is damaged, compressed datasets, a version before 2.2 or after 4,
/// several meshes or steps, structured or partitioned meshes, coordinates that are not Cartesian, a missing node, solids that
/// Eng does not know, a file without solids and shells, a group of shells without triangles and quadrangles.
pub(super) fn read_med(
    files: &dyn Files,
    name: &str,
    shells: ShellGroups<'_>,
) -> Result<Mesh, FlexibleError> {
    let mut bytes = Vec::new();
    let mut stream = crate::read::open(files, name)?.take(LARGEST);
    let read = stream.read_to_end(&mut bytes);
    read.map_err(|error| whole(name, format!("reading stopped: {error}"), AGAIN))?;
    if bytes.len() as u64 == LARGEST {
        let problem = "the file is larger than 2 GB";
        return Err(whole(name, problem, "remove results from it, or divide the model").into());
    }
    let data = Hdf5::open(&bytes);
    let data = data.map_err(|trouble| {
        let advice = "give a MED file of Salome, code_aster or gmsh (.med)";
        whole(name, trouble.to_string(), advice)
    })?;
    let file = File { name, data };
    let root = file.root()?;
    let version = version(&file, &root)?;
    let mesh = only_mesh(&file, &root)?;
    let step = only_step(&file, &mesh, version)?;
    let families = families(&file, &root, &mesh)?;
    let mut model = model::Model::new(&file, shells, families);
    model.nodes(&mesh, step.as_ref().unwrap_or(&mesh))?;
    model.cells(step.as_ref().unwrap_or(&mesh))?;
    model.others(&root);
    Ok(model.into_mesh()?)
}

/// The first number of the version.
fn version(file: &File<'_>, root: &Folder<'_>) -> Result<i64, FileProblem> {
    let about = file.open(root, "INFOS_GENERALES")?;
    let number = |name| match &about {
        Some(about) => file.attribute(about, name),
        None => Ok(None),
    };
    match (number("MAJ")?, number("MIN")?) {
        (Some(major @ 3..=4), _) | (Some(major @ 2), Some(2..)) => Ok(major),
        (None, _) => Err(file.problem(
            "",
            "the HDF5 data state no version of MED in INFOS_GENERALES",
            "give a MED file of Salome, code_aster or gmsh (.med)",
        )),
        (Some(major), minor) => Err(file.problem(
            "INFOS_GENERALES",
            &format!("the file has version {major}.{} of MED", minor.unwrap_or(0)),
            "write it in a version from 2.2 to 4; Salome offers the version when it exports a mesh",
        )),
    }
}

/// The mesh of the file, which must be the only one.
fn only_mesh<'f>(file: &File<'f>, root: &Folder<'f>) -> Result<Folder<'f>, FileProblem> {
    let meshes = file.open(root, "ENS_MAA")?;
    let names: Vec<&str> = meshes.iter().flat_map(Folder::names).collect();
    let (Some(meshes), [only]) = (&meshes, names.as_slice()) else {
        let (problem, advice) = match names.len() {
            0 => (
                "the file has no mesh".to_owned(),
                "write the mesh, not results alone",
            ),
            count => (
                format!("the file has {count} meshes: {}", names.join(", ")),
                "write the mesh of the body into a file of its own",
            ),
        };
        return Err(file.problem("", &problem, advice));
    };
    let Some(mesh) = file.open(meshes, only)? else {
        return Err(file.problem("ENS_MAA", "its mesh is missing", AGAIN));
    };
    if file.attribute(&mesh, "TYP")?.unwrap_or(0) != 0 {
        return Err(file.problem(
            &mesh.path,
            "the mesh is structured",
            "convert it to an unstructured mesh and write it again",
        ));
    }
    let joints = file.open(root, "JNT")?;
    let partitioned = joints.is_some_and(|joints| joints.has(only)) || mesh.has("JNT");
    if partitioned {
        return Err(file.problem(
            &mesh.path,
            "the mesh is a part of a mesh that was divided for several processors",
            "give the whole mesh",
        ));
    }
    Ok(mesh)
}

/// The step of the mesh, which must be the only one; `None` before version 3, which has no steps.
fn only_step<'f>(
    file: &File<'f>,
    mesh: &Folder<'f>,
    version: i64,
) -> Result<Option<Folder<'f>>, FileProblem> {
    if version < 3 {
        return Ok(None);
    }
    let is_step = |name: &&str| name.starts_with(|c: char| c == '-' || c.is_ascii_digit());
    let steps: Vec<&str> = mesh.names().filter(is_step).collect();
    match steps.as_slice() {
        [only] => file.open(mesh, only),
        [] => Err(file.problem(
            &mesh.path,
            "the mesh has no nodes and cells",
            "write the mesh again with its nodes and cells",
        )),
        several => Err(file.problem(
            &mesh.path,
            &format!("the mesh changes in {} computing steps", several.len()),
            "write the mesh of the undeformed body alone",
        )),
    }
}

/// The families of a mesh. Files of version 2 have them in the folder of the mesh.
fn families<'f>(
    file: &File<'f>,
    root: &Folder<'f>,
    mesh: &Folder<'f>,
) -> Result<families::Families, FileProblem> {
    let name = mesh.path.rsplit('/').next().unwrap_or("");
    let of_all = match file.open(root, "FAS")? {
        Some(all) => file.open(&all, name)?,
        None => None,
    };
    let folder = match of_all {
        Some(own) => Some(own),
        None => file.open(mesh, "FAS")?,
    };
    match folder {
        Some(folder) => families::Families::read(file, &folder),
        None => Ok(families::Families::default()),
    }
}
