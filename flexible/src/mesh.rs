//! A finite-element mesh in the form of its files: nodes, elements, masses, springs, ties, supports, sets.
//!
//! Positions are in the basic (global) frame of the file. [`Mesh::frames`] holds the nodes' analysis frames;
//! foreign matrices, supports and tie components refer to them. Node and element *indices* (`u32`) count from
//! 0 in the order of the file; *ids* are the file's own numbers. Quantities are in the units of the file
//! until [`Mesh::convert`] makes them SI.

use eng_system::significant::short;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

pub use crate::axes::{Coordinates, LocalAxes};
pub use crate::elasticity::{SheetElasticity, SolidElasticity};
pub use crate::element::{ABSENT, ElementKind};
use crate::error::FlexibleError;

/// Bit of the indices of scalar points where an index of a node stands: the other bits are the index into
/// [`Mesh::scalar_points`].
pub const SCALAR: u32 = 1 << 31;

/// Index into [`Mesh::scalar_points`] of an index with the bit [`SCALAR`]; `None` for a node.
pub(crate) const fn scalar_index(node: u32) -> Option<usize> {
    match node & SCALAR {
        0 => None,
        _ => Some((node & !SCALAR) as usize),
    }
}

/// A node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// The file's number.
    pub id: u64,
    /// Position in the basic frame.
    pub position: [f64; 3],
    /// Index into [`Mesh::frames`] of its analysis frame; `None`: the basic frame.
    pub frame: Option<u32>,
}

/// An analysis frame at a node: the rotation matrix frame → basic, row-major (columns are the frame's axes).
/// A cylindrical or spherical frame has one such entry for each node, evaluated at the node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Rotation frame → basic.
    pub rotation: [[f64; 3]; 3],
}

/// The code for which a mesh was written. One name means different elements in different codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Code {
    /// No code: gmsh, or a mesh made by a program.
    #[default]
    None,
    /// Nastran (MSC, NX).
    Nastran,
    /// Abaqus.
    Abaqus,
    /// CalculiX.
    CalculiX,
    /// ANSYS Mechanical APDL.
    Ansys,
}

/// The variant of an element as its file names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Variant {
    /// The shape alone: `C3D8`, `CTETRA`. The code decides its meaning.
    #[default]
    Plain,
    /// The letters after the number of nodes in Abaqus and CalculiX, such as `R` of `C3D20R`, with a bit for
    /// each of [`VARIANT_LETTERS`].
    Letters(u8),
    /// `IN` and `ISOP` of Nastran's `PSOLID`, if stated.
    Network {
        /// Points along a direction. Zero means bubble functions, which are the default.
        points: u8,
        /// Full integration of the shear.
        full: bool,
    },
    /// A shell whose membrane has rotations about the normal: `CTRIAR`, `CQUADR`.
    Drilling,
    /// `CBEAM` of Nastran: its lumped mass has inertia about its axis, that of `CBAR` has none.
    Beam,
    /// A solid of ANSYS.
    Technology {
        /// Its number: 186 of SOLID186.
        element: u16,
        /// KEYOPT(2) of its type.
        option: u8,
    },
}

/// Letters of element types that change the mechanics of a solid, in the order in which they are written:
/// modified, reduced, incompatible modes, hybrid, improved stresses, others.
pub const VARIANT_LETTERS: &str = "MRIHSO";

/// An element.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Element {
    /// The file's number.
    pub id: u64,
    /// Shape and order of nodes.
    pub kind: ElementKind,
    /// Its integration as the file names it.
    pub variant: Variant,
    /// Index into [`Mesh::properties`].
    pub property: u32,
    /// Start of its nodes in [`Mesh::connectivity`].
    pub first: u32,
    /// For a beam: index into [`Mesh::beam_axes`].
    pub beam: Option<u32>,
    /// For a shell: index into [`Mesh::shell_shapes`]. Without one its nodes lie in its middle surface, its
    /// thickness is that of its section, and the section's first axis lies along the side from its first node
    /// to the second.
    pub shell: Option<u32>,
}

/// Position, thickness and axes of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShellShape {
    /// From each corner to the middle surface, along the normal by which the nodes run counter-clockwise.
    pub offsets: [f64; 4],
    /// Thickness at the corners; `None`: that of the section.
    pub thickness: Option<[f64; 4]>,
    /// First axis of the section.
    pub axis: ShellAxis,
}

impl Default for ShellShape {
    fn default() -> Self {
        ShellShape {
            offsets: [0.0; 4],
            thickness: None,
            axis: ShellAxis::Side(0.0),
        }
    }
}

/// First axis of a shell's section, in the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ShellAxis {
    /// The side from the first node to the second, turned by an angle (rad) about the normal.
    Side(f64),
    /// The part in the surface of a direction (basic frame), turned by an angle (rad) about the normal.
    Direction([f64; 3], f64),
}

/// Position and direction of a beam's section.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeamAxes {
    /// Vector in the section's first plane (basic frame), not parallel to the beam.
    pub orientation: [f64; 3],
    /// From each node to the beam's end (basic frame). The line between the ends is that of the shear centres.
    pub offsets: [[f64; 3]; 2],
    /// From this line to the centroids of the sections, along y and z.
    pub centroid: [f64; 2],
    /// Freedoms 1…6 (bit 0 … bit 5, element axes) released at each end.
    pub released: [u8; 2],
}

/// Material and section of elements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Property {
    /// The file's number or name.
    pub name: String,
    /// Index into [`Mesh::materials`]; `None` for elements without stiffness and mass (facets).
    pub material: Option<u32>,
    /// Section.
    pub section: Section,
}

impl Property {
    /// Indices of its materials in a mesh of these laminates.
    pub(crate) fn materials(&self, laminates: &[Vec<Layer>]) -> Vec<u32> {
        let mut found: Vec<u32> = self.material.into_iter().collect();
        if let Section::Shell(section) = self.section {
            match section.layup {
                Layup::One => {}
                Layup::Apart { bending, shear } => {
                    found.extend([bending, shear].into_iter().flatten());
                }
                Layup::Layers(index) => {
                    let layers = laminates.get(index as usize).into_iter().flatten();
                    found.extend(layers.map(|layer| layer.material));
                }
            }
        }
        found
    }
}

/// Section of an element.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Section {
    /// A solid.
    Solid,
    /// A shell.
    Shell(ShellSection),
    /// A beam.
    Beam(BeamSection),
    /// A beam whose section changes along it: index into [`Mesh::tapers`].
    Tapered(u32),
}

/// Section of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShellSection {
    /// Thickness.
    pub thickness: f64,
    /// Mass per area in addition to the material's.
    pub mass_per_area: f64,
    /// Bending stiffness by that of a plate of the thickness: 12 I/t³.
    pub bending: f64,
    /// Thickness that resists shear across the plate, by the thickness. Zero means no shear flexibility.
    pub shear: f64,
    /// Its materials.
    pub layup: Layup,
}

/// Materials of a shell's section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Layup {
    /// The property's material alone.
    One,
    /// The property's material stretches, others bend and shear.
    Apart {
        /// Index of the material that bends. Without one the section is a membrane: it resists no bending and
        /// no shear across, and its nodes have no rotations.
        bending: Option<u32>,
        /// Index of the material that resists shear across the plate. Without one there is no shear
        /// flexibility.
        shear: Option<u32>,
    },
    /// Layers: index into [`Mesh::laminates`]. The thickness of the section is their sum.
    Layers(u32),
}

/// A layer of a laminate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Index of its material.
    pub material: u32,
    /// Thickness.
    pub thickness: f64,
    /// From the first axis of the section to that of the layer, about the normal (rad).
    pub angle: f64,
}

impl ShellSection {
    /// A homogeneous plate of a thickness: shear factor 5/6, no added mass.
    pub const fn plate(thickness: f64) -> Self {
        ShellSection {
            thickness,
            mass_per_area: 0.0,
            bending: 1.0,
            shear: 5.0 / 6.0,
            layup: Layup::One,
        }
    }

    /// Whether it is a membrane.
    pub const fn is_membrane(&self) -> bool {
        matches!(self.layup, Layup::Apart { bending: None, .. })
    }
}

/// Section of a beam: x along the beam, y in the plane of the orientation vector.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeamSection {
    /// Area.
    pub area: f64,
    /// Second moment for bending in the x–y plane (about z).
    pub moment_z: f64,
    /// Second moment for bending in the x–z plane (about y).
    pub moment_y: f64,
    /// Product of inertia of the area, ∫ y z dA.
    pub product: f64,
    /// Torsion constant.
    pub torsion: f64,
    /// Shear area factors for y and z. Zero means no shear flexibility.
    pub shear: [f64; 2],
    /// Mass per length in addition to the material's.
    pub mass_per_length: f64,
}

/// The section at a place of a beam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Station {
    /// Share of the way from the first end to the second, 0 to 1.
    pub place: f64,
    /// Section there.
    pub section: BeamSection,
}

/// The section at a share of the way from the first end to the second, linear between the stations, which are in
/// ascending order.
pub(crate) fn section_at(stations: &[Station], share: f64) -> BeamSection {
    let after = stations.partition_point(|station| station.place <= share);
    let [before, after] = [after.saturating_sub(1), after].map(|i| stations.get(i));
    match (before, after) {
        (Some(a), Some(b)) if b.place > a.place => {
            let t = (share - a.place) / (b.place - a.place);
            let (a, b) = (&a.section, &b.section);
            let between = |a: f64, b: f64| a + t * (b - a);
            BeamSection {
                area: between(a.area, b.area),
                moment_z: between(a.moment_z, b.moment_z),
                moment_y: between(a.moment_y, b.moment_y),
                product: between(a.product, b.product),
                torsion: between(a.torsion, b.torsion),
                shear: [0, 1].map(|i: usize| between(a.shear[i], b.shear[i])),
                mass_per_length: between(a.mass_per_length, b.mass_per_length),
            }
        }
        (Some(own), _) | (None, Some(own)) => own.section,
        (None, None) => BeamSection::default(),
    }
}

/// A linear elastic material, isotropic unless it has the elasticity of a sheet or of an anisotropic solid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// The file's number or name.
    pub name: String,
    /// Young's modulus; that along the first axis of a sheet or of an anisotropic solid.
    pub young: f64,
    /// Poisson's ratio; of an anisotropic solid the contraction along its second axis by a pull along the first.
    pub poisson: f64,
    /// Density.
    pub density: f64,
    /// Elasticity of an anisotropic sheet. Only shells can be made of it.
    pub sheet: Option<SheetElasticity>,
    /// Elasticity of an anisotropic solid with its axes. Only solids can be made of it.
    pub solid: Option<SolidElasticity>,
}

/// A mass at a node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointMass {
    /// The file's number.
    pub id: u64,
    /// Index of the node.
    pub node: u32,
    /// 6×6 symmetric mass matrix about the node, basic frame (translations, rotations), row-major.
    pub matrix: [[f64; 6]; 6],
}

/// The components of a vector in the basic frame along the axes of a node's analysis frame.
pub(crate) fn along_axes(
    nodes: &[Node],
    frames: &[Frame],
    node: u32,
    vector: [f64; 3],
) -> [f64; 3] {
    let own = nodes.get(node as usize).and_then(|node| node.frame);
    match own.and_then(|frame| frames.get(frame as usize)) {
        Some(Frame { rotation, .. }) => [0, 1, 2].map(|axis: usize| {
            let along = rotation.iter().zip(vector);
            along.map(|(row, x)| row[axis] * x).sum()
        }),
        None => vector,
    }
}

/// A spring. Its extension is a sum of displacements and rotations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spring {
    /// The file's number.
    pub id: u64,
    /// Stiffness: force per extension.
    pub stiffness: f64,
    /// The terms of the extension: index of the node, freedom 0…5 in the node's analysis frame, coefficient (1 of
    /// displacements, a length of rotations).
    pub terms: Vec<(u32, u8, f64)>,
    /// Whether it holds to the ground.
    pub grounded: bool,
}

impl Spring {
    /// A spring between two freedoms, or a freedom and the ground: force or torque per difference.
    pub fn between(id: u64, stiffness: f64, first: (u32, u8), second: Option<(u32, u8)>) -> Self {
        let ends = [(Some(first), 1.0), (second, -1.0)];
        let terms = ends.into_iter().filter_map(|(end, sign)| {
            let (node, freedom) = end?;
            Some((node, freedom, sign))
        });
        Spring {
            id,
            stiffness,
            terms: terms.collect(),
            grounded: second.is_none(),
        }
    }
}

/// A rule that makes freedoms depend on others. Components are bits 0…5 of freedoms 1…6 in the node's
/// analysis frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Tie {
    /// The dependent components move as if on a rigid body with the six freedoms of `independent`.
    Rigid {
        /// The file's number.
        id: u64,
        /// Index of the node that moves the others.
        independent: u32,
        /// Dependent nodes, and their dependent components.
        dependent: Vec<(u32, u8)>,
    },
    /// The reference node follows the weighted mean motion of the others (least squares).
    Averaging {
        /// The file's number.
        id: u64,
        /// Index of the dependent node.
        reference: u32,
        /// Dependent components of the reference node.
        reference_components: u8,
        /// Nodes, weights, and the components that take part.
        independent: Vec<(u32, f64, u8)>,
    },
    /// Σ coefficient · freedom = 0; the first term's freedom depends on the others.
    Equation {
        /// The file's number, or the position in the file.
        id: u64,
        /// Node, freedom 0…5, coefficient.
        terms: Vec<(u32, u8, f64)>,
    },
}

impl Tie {
    /// The file's number.
    pub fn id(&self) -> u64 {
        match self {
            Tie::Rigid { id, .. } | Tie::Averaging { id, .. } | Tie::Equation { id, .. } => *id,
        }
    }

    /// Visits each node with the components (bits 0…5) that the tie names, the independent or reference node
    /// first.
    pub fn each(&self, mut visit: impl FnMut(u32, u8)) {
        match self {
            Tie::Rigid {
                independent,
                dependent,
                ..
            } => {
                visit(*independent, 0b11_1111);
                dependent
                    .iter()
                    .for_each(|(node, mask)| visit(*node, *mask));
            }
            Tie::Averaging {
                reference,
                reference_components,
                independent,
                ..
            } => {
                visit(*reference, *reference_components);
                (independent.iter()).for_each(|(node, _, mask)| visit(*node, *mask));
            }
            Tie::Equation { terms, .. } => {
                for (node, component, _) in terms {
                    visit(*node, 1u8.checked_shl(u32::from(*component)).unwrap_or(0));
                }
            }
        }
    }
}

/// Entries of one triangle of a symmetric matrix: number of the node and freedom 1…6 of row and column, 0 for
/// a scalar point; and the value.
pub type Pair = ((u64, u8), (u64, u8), f64);

/// A matrix of a deck.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckMatrix {
    /// Its file.
    pub file: String,
    /// Its name in messages.
    pub name: String,
    /// Its entries.
    pub pairs: Vec<Pair>,
}

/// Stiffness and mass of a deck without elements.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckMatrices {
    /// K in the units of the deck.
    pub stiffness: DeckMatrix,
    /// M in the units of the deck.
    pub mass: DeckMatrix,
}

/// Freedoms held at zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Support {
    /// Index of the node.
    pub node: u32,
    /// Bits 0…5 of freedoms 1…6 in the node's analysis frame.
    pub components: u8,
}

/// Cards or keywords of one name that hold freedoms.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SupportCards {
    /// Name of the card or keyword: `SPC1`, `*BOUNDARY`.
    pub name: String,
    /// Number of them.
    pub count: u64,
    /// File and line of the first.
    pub first: (String, u64),
    /// File and line of the first that moves a freedom instead of holding it.
    pub moved: Option<(String, u64)>,
}

/// A named set. Its indices are sorted, each member once.
#[derive(Clone, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Set {
    nodes: Vec<u32>,
    elements: Vec<u32>,
}

impl Set {
    /// The set of these members, which may be in any order and may be repeated.
    pub fn new(mut nodes: Vec<u32>, mut elements: Vec<u32>) -> Set {
        for list in [&mut nodes, &mut elements] {
            list.sort_unstable();
            list.dedup();
        }
        Set { nodes, elements }
    }

    /// Indices of its nodes, sorted.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Indices of its elements, sorted.
    pub fn elements(&self) -> &[u32] {
        &self.elements
    }

    /// This set with the members of another one.
    pub(crate) fn joined(self, other: &Set) -> Set {
        Set::new(
            [self.nodes, other.nodes.clone()].concat(),
            [self.elements, other.elements.clone()].concat(),
        )
    }
}

/// The kind of content of an unread card or keyword.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Carries {
    /// Output requests, loads, comments. The reduction does not need them.
    Nothing,
    /// Mass, stiffness or a constraint. Results are wrong without it.
    Structure,
    /// Unknown content.
    Unknown,
}

/// Cards or keywords of one name that were not read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unread {
    /// Name of the card or keyword.
    pub name: String,
    /// Number of them.
    pub count: u64,
    /// File and line of the first; 0 for a file of binary data.
    pub first: (String, u64),
    /// The kind of lost content.
    pub carries: Carries,
}

/// The mass of a mesh as its file states it, beside the elements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WeightCheck {
    /// Mass.
    pub mass: f64,
    /// Centre of mass in the basic frame, if the file states the point to which it refers.
    pub centre: Option<[f64; 3]>,
    /// File and line.
    pub place: (String, u64),
}

/// A mesh, as its file states it. All fields are open: readers fill them, and indices may be wrong. Assembly,
/// recovery and reduction check a mesh before they use it.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Mesh {
    /// The code for which it was written.
    pub code: Code,
    /// Whether this code lumps the masses of the elements here: Nastran without `PARAM,COUPMASS,1`.
    pub lumped: bool,
    /// Whether this code holds freedoms without stiffness beside the supports here: Nastran without
    /// `PARAM,AUTOSPC,NO`.
    pub autospc: bool,
    /// Nodes in the order of the file.
    pub nodes: Vec<Node>,
    /// Analysis frames of nodes.
    pub frames: Vec<Frame>,
    /// Elements in the order of the file.
    pub elements: Vec<Element>,
    /// Node indices of the elements.
    pub connectivity: Vec<u32>,
    /// Axes of beams.
    pub beam_axes: Vec<BeamAxes>,
    /// Positions, thicknesses and axes of shells.
    pub shell_shapes: Vec<ShellShape>,
    /// Layers of shells, each list from the lower surface to the upper.
    pub laminates: Vec<Vec<Layer>>,
    /// Sections of tapered beams, each list by ascending place, from 0 to 1.
    pub tapers: Vec<Vec<Station>>,
    /// Properties.
    pub properties: Vec<Property>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Numbers of scalar points, which have one freedom and no place (`SPOINT`). Springs, equations, supports
    /// and foreign matrices name them by indices with the bit [`SCALAR`] and component 0.
    pub scalar_points: Vec<u64>,
    /// Point masses.
    pub point_masses: Vec<PointMass>,
    /// Springs.
    pub springs: Vec<Spring>,
    /// Masses of a difference of freedoms, or of a freedom of a scalar point: their `stiffness` is a mass,
    /// and the rate of the extension gives the kinetic energy.
    pub inerters: Vec<Spring>,
    /// Ties.
    pub ties: Vec<Tie>,
    /// Supports in the file.
    pub supports: Vec<Support>,
    /// The cards or keywords of the supports.
    pub support_cards: Vec<SupportCards>,
    /// Freedoms the file names as its interface (`ASET`).
    pub interface: Vec<Support>,
    /// Freedoms of matrices beside the file, in the order of their rows (`EXTRN`): number of the point, and
    /// freedom 1…6; 0 for a scalar point.
    pub boundary: Vec<(u64, u8)>,
    /// Freedoms of the rows of a recovery matrix beside the file (`DTI,TUG1`), in the form of [`Mesh::boundary`]; not
    /// stored.
    #[serde(skip)]
    pub recovered: Vec<(u64, u8)>,
    /// Matrices of the deck itself (`*MATRIX ASSEMBLE`); not stored.
    #[serde(skip)]
    pub matrices: Option<Box<DeckMatrices>>,
    /// Sets by name.
    pub sets: BTreeMap<String, Set>,
    /// Unread cards and keywords.
    pub unread: Vec<Unread>,
    /// Units that the file itself names: the word, and metres, kilograms, seconds of its units.
    pub units: Option<(String, [f64; 3])>,
    /// Notes on contents that were read by the rules of their code but may have another intention.
    pub doubts: Vec<String>,
    /// The mass that the file states, by a check of its own code.
    pub weight_check: Option<WeightCheck>,
}

impl Mesh {
    /// The name of a freedom 0…5 of a node or scalar point, for messages.
    pub(crate) fn freedom_name(&self, node: u32, component: u8) -> String {
        match scalar_index(node) {
            Some(index) => {
                let id = self.scalar_points.get(index).copied().unwrap_or_default();
                format!("scalar point {id}")
            }
            None => {
                let id = self.nodes.get(node as usize).map_or(0, |node| node.id);
                format!("component {} of node {id}", component + 1)
            }
        }
    }

    /// The sections of a beam with this section; none for another element.
    pub(crate) fn stations(&self, section: &Section) -> Vec<Station> {
        match *section {
            Section::Beam(section) => vec![Station {
                place: 0.0,
                section,
            }],
            Section::Tapered(index) => self.tapers.get(index as usize).cloned().unwrap_or_default(),
            Section::Solid | Section::Shell(_) => Vec::new(),
        }
    }

    /// The node indices of an element.
    pub fn nodes_of(&self, element: &Element) -> &[u32] {
        let first = element.first as usize;
        self.connectivity
            .get(first..first + element.kind.node_count())
            .unwrap_or(&[])
    }

    /// The nodes of the elements with these indices, sorted.
    pub(crate) fn nodes_of_all(&self, elements: &[u32]) -> Vec<u32> {
        let known = elements
            .iter()
            .filter_map(|index| self.elements.get(*index as usize));
        let nodes = known.flat_map(|element| self.nodes_of(element)).copied();
        let mut nodes: Vec<u32> = nodes.filter(|node| *node != ABSENT).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Gives a material to all solids and shells of a mesh without materials. Materials of the file that lack only the
    /// density take the density of this one.
    ///
    /// # Errors
    /// When the mesh has complete materials of its own, or one with another elasticity (by 5 % of Young's
    /// modulus, 0.05 of Poisson's ratio); when the mesh has no element that takes a material; when the values
    /// are not those of an isotropic material (Young's modulus positive, Poisson's ratio above -1 and below
    /// 1/2, density not negative).
    pub fn set_material(
        &mut self,
        young: f64,
        poisson: f64,
        density: f64,
    ) -> Result<(), FlexibleError> {
        let wrong = |problem: String, advice: &str| {
            Err(FlexibleError::Structure {
                problem,
                advice: advice.into(),
            })
        };
        let sound = young > 0.0
            && young.is_finite()
            && poisson > -1.0
            && poisson < 0.5
            && density >= 0.0
            && density.is_finite();
        if !sound {
            return wrong(
                format!(
                    "Young's modulus {young}, Poisson's ratio {poisson} and density {density} make no material"
                ),
                "give Young's modulus above zero, Poisson's ratio between -1 and 0.5, and a density that is not negative",
            );
        }
        if let Some(own) = self.materials.first() {
            let name = own.name.clone();
            let mut lacking = false;
            for own in self.materials.iter_mut().filter(|own| own.density == 0.0) {
                lacking = true;
                if own.sheet.is_some() || own.solid.is_some() {
                    return wrong(
                        format!(
                            "the mesh's material {} lacks a density, and is not isotropic",
                            own.name
                        ),
                        "give the density in the file",
                    );
                }
                // a choice: one material has such differences from data sheet to data sheet, and steel and
                // aluminium far larger ones
                if (own.young - young).abs() > 0.05 * young || (own.poisson - poisson).abs() > 0.05
                {
                    return wrong(
                        format!(
                            "the mesh's material {} lacks a density, and its Young's modulus of {} Pa or its Poisson's ratio of {} differs from the given material's {} Pa and {poisson}",
                            own.name,
                            short(own.young, 5),
                            own.poisson,
                            short(young, 5)
                        ),
                        "give a material with the constants of the mesh, or state the density in the file",
                    );
                }
                own.density = density;
            }
            if lacking {
                return Ok(());
            }
            return wrong(
                format!("the mesh has a material of its own, {name}"),
                "remove the material from the body or from the file",
            );
        }
        let mut taken = false;
        let without_code = self.code == Code::None;
        for property in &mut self.properties {
            let has_body = match property.section {
                Section::Solid => true,
                // a shell without material of another code has only its added mass, and a facet has no thickness
                Section::Shell(shell) => without_code && shell.thickness > 0.0,
                _ => false,
            };
            if has_body && property.material.is_none() {
                property.material = Some(0);
                taken = true;
            }
        }
        if !taken {
            return wrong(
                "the mesh has no solid element to take the material".into(),
                "give a mesh of volumes",
            );
        }
        self.materials.push(Material {
            name: "given".into(),
            young,
            poisson,
            density,
            sheet: None,
            solid: None,
        });
        Ok(())
    }

    /// Index of each node id.
    pub fn node_index(&self) -> BTreeMap<u64, u32> {
        self.nodes
            .iter()
            .enumerate()
            .map(|(index, node)| (node.id, index as u32))
            .collect()
    }
}
