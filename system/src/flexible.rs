//! The description of a flexible body: the compiler writes it, the host reduces it, and the runtime sees only
//! the result.
//!
//! Numbers are SI; all are known while compiling.

use crate::mesh_files::{ElementRules, MatrixFormat, MeshFormat, MeshUnits, ShapeFormat};
use crate::stack::Stack;
use crate::surface::SurfaceShapes;
use crate::system::{Location, Origin};

/// Freedoms of a marker: bits 0…5 are x, y, z and the rotations about them, along the marker's own axes.
pub type Freedoms = u8;

/// All six freedoms.
pub const ALL_FREEDOMS: Freedoms = 0b11_1111;

/// Names of the freedoms, by their bits.
pub const FREEDOM_NAMES: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

/// The names of freedoms: `x, y`.
pub fn freedom_text(freedoms: Freedoms) -> String {
    let named: Vec<&str> = FREEDOM_NAMES
        .iter()
        .enumerate()
        .filter(|(bit, _)| freedoms & (1 << bit) != 0)
        .map(|(_, name)| *name)
        .collect();
    named.join(", ")
}

/// A flexible body as the text describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct FlexibleSource {
    /// Path and place of the body.
    pub origin: Origin,
    /// The mesh.
    pub mesh: MeshSource,
    /// Stiffness from a file; `None`: from the mesh's elements.
    pub stiffness: Option<MatrixSource>,
    /// Mass from a file; `None`: from the mesh's elements.
    pub mass: Option<MatrixSource>,
    /// Nodes whose motion follows from the freedoms of stiffness and mass by a matrix of a file.
    pub recovery: Option<RecoverySource>,
    /// The material for a mesh without one.
    pub material: Option<MaterialSource>,
    /// The integration of elements; `None`: by the rules of the file's code, with exact mass.
    pub element_rules: Option<ElementRules>,
    /// Markers, in the order of the text. A marker of the system has its index in this list.
    pub markers: Vec<MarkerSource>,
    /// Markers that the ground holds. Without any, without freedoms and without supports of the deck, the body is free.
    pub support: Vec<u32>,
    /// Freedoms of further markers that the ground holds, along the axes of each.
    pub support_freedoms: Vec<Interface>,
    /// Whether the supports of the mesh's file hold the body.
    pub support_of_deck: bool,
    /// Place of the attribute `support`.
    pub support_at: Option<Location>,
    /// The mode set is the sum of these.
    pub modes: Vec<ModeTerm>,
    /// Place of the attribute `modes`.
    pub modes_at: Location,
    /// Damping.
    pub damping: Damping,
    /// Whether stresses from spin and loads change the stiffness.
    pub geometric_stiffness: bool,
}

/// The source of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshSource {
    /// A file.
    File(MeshFile),
    /// Sections stacked along an axis.
    Stack(StackSource),
}

impl MeshSource {
    /// Place of the source in the text.
    pub fn at(&self) -> Location {
        match self {
            MeshSource::File(file) => file.at,
            MeshSource::Stack(stack) => stack.at,
        }
    }

    /// The file, if there is one.
    pub fn file(&self) -> Option<&MeshFile> {
        match self {
            MeshSource::File(file) => Some(file),
            MeshSource::Stack(_) => None,
        }
    }

    /// Cards and keywords that may be left out.
    pub fn ignored(&self) -> &[String] {
        match self {
            MeshSource::File(file) => &file.ignored,
            MeshSource::Stack(_) => &[],
        }
    }
}

/// A stack with its places in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct StackSource {
    /// The sections and the size of the elements.
    pub stack: Stack,
    /// Place of each section.
    pub sections: Vec<Location>,
    /// Place of the source in the text.
    pub at: Location,
}

/// A mesh in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Its format.
    pub format: MeshFormat,
    /// The file, from the model's folder.
    pub file: String,
    /// Units of the file; `None`: those that it states itself.
    pub units: Option<MeshUnits>,
    /// Cards and keywords that may be left out although they carry stiffness, mass or constraints.
    pub ignored: Vec<String>,
    /// The surfaces of a mesh of gmsh or of a MED file that are shells.
    pub shells: Option<ShellSurfaces>,
    /// Place of the source in the text.
    pub at: Location,
}

/// Surfaces that are shells.
#[derive(Clone, Debug, PartialEq)]
pub struct ShellSurfaces {
    /// Names of their groups in the file, or `physical:TAG`.
    pub groups: Vec<String>,
    /// Their thickness (m).
    pub thickness: f64,
}

/// The source of a matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct MatrixSource {
    /// Its format.
    pub format: MatrixFormat,
    /// The file, from the model's folder.
    pub file: String,
    /// Name of the matrix in a file with several.
    pub matrix: Option<String>,
    /// A file that lists the freedoms of the rows.
    pub freedoms: Option<String>,
    /// If rows are all nodes by ascending number: the number of freedoms of each node, 3 or 6.
    pub per_node: Option<u8>,
    /// Place of the source in the text.
    pub at: Location,
}

/// Nodes whose motion a matrix of a file recovers.
#[derive(Clone, Debug, PartialEq)]
pub struct RecoverySource {
    /// The matrix, with the freedoms of its rows. Its columns follow the rows of the stiffness.
    pub matrix: MatrixSource,
    /// The nodes, with cells for pictures.
    pub nodes: MeshFile,
    /// The largest share of a rigid motion that the nodes may miss.
    pub tolerance: f64,
}

/// An isotropic material, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialSource {
    /// Young's modulus (Pa).
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density (kg/m³).
    pub density: f64,
    /// Place of the attribute.
    pub at: Location,
}

/// A marker on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerSource {
    /// Its name in the body: `main[2]`.
    pub name: String,
    /// Place in the text.
    pub at: Location,
    /// Its place on the mesh.
    pub place: MarkerPlace,
    /// Whether the text states the tie of its nodes.
    pub tied: bool,
    /// Rotation matrix marker → mesh, row-major. The columns are the directions of its freedoms.
    pub axes: [f64; 9],
    /// The shapes of its surface, if the text states that the surface yields to the pressure of a film.
    pub surface: Option<SurfaceShapes>,
}

/// The place of a marker on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum MarkerPlace {
    /// The node of this id.
    Node(u64),
    /// Several nodes, tied to a centre.
    Gathered {
        /// The nodes.
        nodes: Selection,
        /// The kind of tie.
        tie: Spider,
        /// Position of the centre (m, axes of the mesh). `None`: the mean position of the nodes, or the middle of
        /// a ring.
        center: Option<[f64; 3]>,
    },
}

/// The kind of tie between nodes and a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Spider {
    /// The marker follows the mean motion of the nodes (least squares) and adds no stiffness: RBE3.
    #[default]
    Averaging,
    /// The nodes follow the marker as a rigid piece: RBE2.
    Rigid,
}

/// A selection of nodes of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Selection {
    /// A named set of the file.
    Set(String),
    /// The nodes on a cylinder's surface.
    Ring {
        /// Middle of the axis (m).
        center: [f64; 3],
        /// Direction of the axis.
        axis: [f64; 3],
        /// Radius (m).
        radius: f64,
        /// Length along the axis (m).
        width: f64,
        /// Distance from the surface within which a node counts (m).
        tolerance: f64,
    },
    /// The nodes in a plane within a distance of one of its points.
    Patch {
        /// The point (m).
        center: [f64; 3],
        /// Normal of the plane.
        normal: [f64; 3],
        /// Distance from the point (m); infinite for the whole plane.
        radius: f64,
        /// Distance from the plane within which a node counts (m).
        tolerance: f64,
    },
    /// The nodes of the elements of a property of the file.
    Property(String),
}

/// Freedoms of a marker that a term of a mode set uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interface {
    /// Index among the body's markers.
    pub marker: u32,
    /// Its freedoms, along its axes.
    pub freedoms: Freedoms,
}

/// The number of normal modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModeCount {
    /// This number of the lowest modes.
    Number(u32),
    /// All up to a frequency (Hz).
    UpTo(f64),
}

/// Part of a mode set.
#[derive(Clone, Debug, PartialEq)]
pub enum ModeTerm {
    /// Attachment modes: the displacement under each unit load.
    Static(Vec<Interface>),
    /// Constraint modes: the displacement for each unit displacement with the others held.
    Constraint(Vec<Interface>),
    /// Normal modes, with held freedoms if any are listed.
    Normal {
        /// Their number.
        count: ModeCount,
        /// Held besides the supports.
        fixed: Vec<Interface>,
    },
    /// Shapes from another code.
    Given {
        /// Their format.
        format: ShapeFormat,
        /// The file.
        file: String,
        /// Place of the source in the text.
        at: Location,
    },
}

/// Damping of the modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damping {
    /// A ratio for each mode up to a frequency (Hz; infinite: for all). It rises to one at five times that
    /// frequency.
    Modal {
        /// Ratio to critical damping.
        ratio: f64,
        /// Frequency up to which it holds (Hz).
        up_to: f64,
    },
    /// `α M + β K`.
    Rayleigh {
        /// α (1/s).
        mass: f64,
        /// β (s).
        stiffness: f64,
    },
}
