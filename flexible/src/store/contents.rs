//! The fields of what is stored, in the order in which they lie in the file.

use super::bytes::{Source, Stored, fields, variants};
use super::{Key, StoreError};
use crate::fe::{FreedomMap, MassRule, Rules, StiffnessRule};
use crate::mesh::{
    BeamAxes, Carries, Code, Element, ElementKind, Frame, Material, Mesh, Node, PointMass,
    Property, Section, Set, Spring, Support, SupportCards, Tie, Unread, Variant,
};
use crate::modes::Dropped;
use crate::recover::Surface;
use crate::reduce::{BodyMass, ModeReport, Report, Served, Unserved};
use crate::solve::SturmCount;
use eng_system::reduced::{
    Block, Geometric, Invariants, MarkerStiffness, ReducedBody, ReducedMarker,
};
use std::collections::BTreeMap;

impl Stored for Key {
    const LEAST: usize = 32;
    fn write(&self, out: &mut Vec<u8>) {
        self.0.write(out);
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        Ok(Key(<[u8; 32]>::read(source)?))
    }
}

fields!(MarkerStiffness {
    marker: usize,
    component: u8,
    stiffness: Block,
});
fields!(Geometric {
    spin: [Block; 6],
    turn: [Block; 3],
    acceleration: [Block; 3],
    loads: Vec<MarkerStiffness>,
});
fields!(Invariants {
    modes: usize,
    mass: f64,
    first_moment: [f64; 3],
    inertia: [[f64; 3]; 3],
    translation: Block,
    rotation: Block,
    rotation_by_shape: [Block; 3],
    coriolis: [Block; 3],
    centrifugal: [Block; 6],
    modal_mass: Block,
    stiffness: Block,
    damping: Block,
    geometric: Option<Geometric>,
});
fields!(ReducedMarker {
    name: String,
    position: [f64; 3],
    translation: Block,
    rotation: Block,
});
fields!(ReducedBody {
    invariants: Invariants,
    frequencies: Vec<f64>,
    markers: Vec<ReducedMarker>,
});

fields!(Dropped {
    label: String,
    remains: f64,
});
fields!(SturmCount {
    count: usize,
    below: f64,
});
fields!(Report {
    nodes: usize,
    elements: usize,
    freedoms: usize,
    sources: Vec<String>,
    dropped: Vec<Dropped>,
    sturm: Vec<SturmCount>,
    supported: bool,
    rigid_residual: f64,
    warnings: Vec<String>,
    modes: Vec<ModeReport>,
    body: BodyMass,
    estimate: Option<BodyMass>,
    served: Vec<Served>,
    unserved: Vec<Unserved>,
});
fields!(ModeReport {
    frequency: f64,
    description: String,
    sources: Vec<(usize, f64)>,
    effective_mass: [f64; 6],
});
fields!(BodyMass {
    mass: f64,
    centre: [f64; 3],
    inertia: [[f64; 3]; 3],
});
fields!(Served {
    mode: String,
    marker: usize,
    component: u8,
    flexibility: Option<f64>,
    kept: bool,
});
fields!(Unserved {
    label: String,
    marker: usize,
    component: u8,
    missing: f64,
});

variants!(StiffnessRule {
    Named,
    Full,
    CalculiX,
    Abaqus,
    Nastran,
});
variants!(MassRule {
    Exact,
    CalculiX,
    Abaqus,
    Lumped,
});
fields!(Rules {
    stiffness: StiffnessRule,
    mass: MassRule,
});

impl Stored for FreedomMap {
    const LEAST: usize = 8;
    fn write(&self, out: &mut Vec<u8>) {
        self.starts().len().write(out);
        for start in self.starts() {
            start.write(out);
        }
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        FreedomMap::from_starts(Vec::read(source)?)
            .ok_or_else(|| source.senseless("a numbering of freedoms that is none"))
    }
}

fields!(Surface {
    triangles: Vec<[u32; 3]>,
    elements: Vec<u32>,
    lines: Vec<[u32; 2]>,
});

fields!(Node {
    id: u64,
    position: [f64; 3],
    frame: Option<u32>,
});
fields!(Frame {
    rotation: [[f64; 3]; 3],
});
variants!(ElementKind {
    Tetrahedron4,
    Tetrahedron10,
    Hexahedron8,
    Hexahedron20,
    Wedge6,
    Wedge15,
    Pyramid5,
    Pyramid13,
    Triangle3,
    Triangle6,
    Quadrilateral4,
    Quadrilateral8,
    Beam2,
});
variants!(Code {
    None,
    Nastran,
    Abaqus,
    CalculiX,
});
impl Stored for Variant {
    const LEAST: usize = 1;
    fn write(&self, out: &mut Vec<u8>) {
        match self {
            Variant::Plain => 0u8.write(out),
            Variant::Letters(letters) => (1u8, *letters).write(out),
            Variant::Network { points, full } => (2u8, *points, *full).write(out),
        }
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        match u8::read(source)? {
            0 => Ok(Variant::Plain),
            1 => Ok(Variant::Letters(u8::read(source)?)),
            2 => Ok(Variant::Network {
                points: u8::read(source)?,
                full: bool::read(source)?,
            }),
            _ => Err(source.senseless("no such variant of an element")),
        }
    }
}
fields!(Element {
    id: u64,
    kind: ElementKind,
    variant: Variant,
    property: u32,
    first: u32,
    beam: Option<u32>,
});
fields!(BeamAxes {
    orientation: [f64; 3],
    offsets: [[f64; 3]; 2],
    released: [u8; 2],
});
fields!(Property {
    name: String,
    material: Option<u32>,
    section: Section,
});
fields!(Material {
    name: String,
    young: f64,
    poisson: f64,
    density: f64,
});
fields!(PointMass {
    id: u64,
    node: u32,
    matrix: [[f64; 6]; 6],
});
fields!(Spring {
    id: u64,
    stiffness: f64,
    first: (u32, u8),
    second: Option<(u32, u8)>,
});
fields!(Support {
    node: u32,
    components: u8,
});
fields!(Set {
    nodes: Vec<u32>,
    elements: Vec<u32>,
});
variants!(Carries {
    Nothing,
    Structure,
    Unknown,
});
fields!(Unread {
    name: String,
    count: u64,
    first: (String, u64),
    carries: Carries,
});
fields!(SupportCards {
    name: String,
    count: u64,
    first: (String, u64),
    moved: Option<(String, u64)>,
});
fields!(Mesh {
    code: Code,
    nodes: Vec<Node>,
    frames: Vec<Frame>,
    elements: Vec<Element>,
    connectivity: Vec<u32>,
    beam_axes: Vec<BeamAxes>,
    properties: Vec<Property>,
    materials: Vec<Material>,
    point_masses: Vec<PointMass>,
    springs: Vec<Spring>,
    ties: Vec<Tie>,
    supports: Vec<Support>,
    support_cards: Vec<SupportCards>,
    interface: Vec<Support>,
    sets: BTreeMap<String, Set>,
    unread: Vec<Unread>,
    doubts: Vec<String>,
});

impl Stored for Section {
    const LEAST: usize = 1;
    fn write(&self, out: &mut Vec<u8>) {
        match self {
            Section::Solid => 0u8.write(out),
            Section::Shell {
                thickness,
                mass_per_area,
            } => {
                1u8.write(out);
                (*thickness, *mass_per_area).write(out);
            }
            Section::Beam {
                area,
                moment_z,
                moment_y,
                product,
                torsion,
                shear,
                mass_per_length,
            } => {
                2u8.write(out);
                [*area, *moment_z, *moment_y, *product, *torsion].write(out);
                (*shear, *mass_per_length).write(out);
            }
        }
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        match u8::read(source)? {
            0 => Ok(Section::Solid),
            1 => Ok(Section::Shell {
                thickness: f64::read(source)?,
                mass_per_area: f64::read(source)?,
            }),
            2 => Ok(Section::Beam {
                area: f64::read(source)?,
                moment_z: f64::read(source)?,
                moment_y: f64::read(source)?,
                product: f64::read(source)?,
                torsion: f64::read(source)?,
                shear: <[f64; 2]>::read(source)?,
                mass_per_length: f64::read(source)?,
            }),
            _ => Err(source.senseless("no such section")),
        }
    }
}

impl Stored for Tie {
    const LEAST: usize = 1;
    fn write(&self, out: &mut Vec<u8>) {
        match self {
            Tie::Rigid {
                id,
                independent,
                dependent,
            } => {
                0u8.write(out);
                (*id, *independent).write(out);
                dependent.write(out);
            }
            Tie::Averaging {
                id,
                reference,
                reference_components,
                independent,
            } => {
                1u8.write(out);
                (*id, *reference, *reference_components).write(out);
                independent.write(out);
            }
            Tie::Equation { id, terms } => {
                2u8.write(out);
                id.write(out);
                terms.write(out);
            }
        }
    }
    fn read(source: &mut Source) -> Result<Self, StoreError> {
        match u8::read(source)? {
            0 => Ok(Tie::Rigid {
                id: u64::read(source)?,
                independent: u32::read(source)?,
                dependent: Vec::read(source)?,
            }),
            1 => Ok(Tie::Averaging {
                id: u64::read(source)?,
                reference: u32::read(source)?,
                reference_components: u8::read(source)?,
                independent: Vec::read(source)?,
            }),
            2 => Ok(Tie::Equation {
                id: u64::read(source)?,
                terms: Vec::read(source)?,
            }),
            _ => Err(source.senseless("no such tie")),
        }
    }
}
