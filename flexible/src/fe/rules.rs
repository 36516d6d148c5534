//! The quadrature of each element, and the distribution of its mass.

use super::form::Form;
use crate::element::quadrature::{self, Point};
use crate::element::{ElementKind, Shape};
use crate::mesh::Mesh;
use serde::{Deserialize, Serialize};

/// The code whose rules give each solid its form: see [`super::form`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum StiffnessRule {
    /// The code for which the mesh was written.
    #[default]
    Named,
    /// Full integration of every solid, whatever its type in the file:
    ///
    /// | element | points |
    /// | --- | --- |
    /// | tetrahedron 4, 10 | 1, 4 |
    /// | hexahedron 8, 20 | 2³, 3³ |
    /// | wedge 6, 15 | 3 × 2, 3 × 3 |
    /// | pyramid 5, 13 | 2³, 3³ |
    Full,
    /// CalculiX 2.20.
    CalculiX,
    /// Abaqus.
    Abaqus,
    /// Nastran, as far as its rules are public.
    Nastran,
}

/// Integration and form of the elements' mass. The mass of beams is consistent in all rules but that of
/// Nastran.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum MassRule {
    /// Consistent mass, integrated exactly for any element, curved ones included.
    #[default]
    Exact,
    /// CalculiX 2.20: consistent mass integrated at the points of the stiffness. So the mass of the 10-node
    /// tetrahedron is under-integrated at 4 points. Checked against its matrices for C3D8, C3D10 and C3D20,
    /// against its frequencies for C3D6, C3D8I and C3D20R.
    CalculiX,
    /// Abaqus: linear elements are lumped by row sums, the 10-node tetrahedron is exact, and other quadratic
    /// solids are integrated at their full stiffness points. Checked against its matrices for C3D4, C3D8,
    /// C3D10, C3D20 and C3D20R.
    Abaqus,
    /// ANSYS: consistent mass, of the 20-node hexahedron at 14 points, of other solids at the points of the
    /// stiffness. Checked against its frequencies for SOLID186.
    Ansys,
    /// Nastran: a deck with a positive `PARAM,COUPMASS` has the mass of [`MassRule::Coupled`]. In others each node of an element
    /// has an equal share of its mass, in its translations alone; `CBEAM` has half of its inertia about its
    /// axis at each end. Lines are checked against the frequencies of MSC Nastran and MYSTRAN. The rule of
    /// solids and shells is that of MYSTRAN's source. Elements with mid-side nodes keep the exact mass, because
    /// MSC Nastran does not share the mass of its CTETRA of 10 nodes equally, as MYSTRAN does; pyramids, which
    /// MYSTRAN has not, keep it too.
    Nastran,
    /// Diagonal mass. Linear elements have row sums. The row sums of quadratic elements are partly negative,
    /// so these have the exact diagonal, scaled to the element's mass (E. Hinton, T. Rock, O. C. Zienkiewicz,
    /// Earthq. Eng. Struct. Dyn. 4, 1976).
    Lumped,
    /// Nastran with `PARAM,COUPMASS`: exact, but `CBAR` without rotary inertia of its sections and with a mass along its
    /// axis between the lumped and the consistent one. Checked against the frequencies of MSC Nastran.
    Coupled,
}

/// The rules of an assembly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Rules {
    /// Rule for stiffness.
    pub stiffness: StiffnessRule,
    /// Rule for mass.
    pub mass: MassRule,
}

impl Rules {
    /// Full integration of every solid, exact mass.
    pub fn exact() -> Self {
        Rules {
            stiffness: StiffnessRule::Full,
            mass: MassRule::Exact,
        }
    }

    /// The rules of Nastran; see [`MassRule::Nastran`].
    pub fn nastran() -> Self {
        Rules {
            stiffness: StiffnessRule::Nastran,
            mass: MassRule::Nastran,
        }
    }

    /// These rules for a mesh: the mass of Nastran is coupled where the file does not lump it.
    pub(super) fn for_mesh(mut self, mesh: &Mesh) -> Self {
        if self.mass == MassRule::Nastran && !mesh.lumped {
            self.mass = MassRule::Coupled;
        }
        self
    }

    /// The rules of CalculiX; see [`MassRule::CalculiX`].
    pub fn calculix() -> Self {
        Rules {
            stiffness: StiffnessRule::CalculiX,
            mass: MassRule::CalculiX,
        }
    }

    /// The rules of Abaqus; see [`MassRule::Abaqus`].
    pub fn abaqus() -> Self {
        Rules {
            stiffness: StiffnessRule::Abaqus,
            mass: MassRule::Abaqus,
        }
    }
}

/// The step from an element's consistent mass to its mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spread {
    Consistent,
    RowSum,
    ScaledDiagonal,
    /// Equal parts for the nodes.
    Equal,
}

pub(super) fn spread(kind: ElementKind, rule: MassRule) -> Spread {
    let linear = kind.linear() == kind;
    if rule == MassRule::Abaqus && !kind.is_solid() {
        return Spread::Consistent;
    }
    match (rule, linear) {
        (MassRule::Nastran, _) if shares_equally(kind) => Spread::Equal,
        (MassRule::Nastran, _) => Spread::Consistent,
        (MassRule::Exact | MassRule::CalculiX | MassRule::Ansys | MassRule::Coupled, _)
        | (MassRule::Abaqus, false) => Spread::Consistent,
        (MassRule::Abaqus | MassRule::Lumped, true) => Spread::RowSum,
        (MassRule::Lumped, false) => Spread::ScaledDiagonal,
    }
}

/// Whether Nastran's lumped mass of a solid or shell is an equal share for each node.
pub(super) fn shares_equally(kind: ElementKind) -> bool {
    kind.linear() == kind && kind != ElementKind::Pyramid5
}

/// Points for the stiffness of a solid; none for other elements.
pub(super) fn stiffness_points(kind: ElementKind, form: Form) -> Vec<Point> {
    let element = kind.description();
    match form {
        Form::Reduced => (element.reduced)(),
        Form::Full | Form::MeanDilatation | Form::Incompatible | Form::Bubbles => {
            (element.stiffness)()
        }
    }
}

fn mass_points(kind: ElementKind, form: Form, rule: MassRule) -> Vec<Point> {
    let element = kind.description();
    match rule {
        MassRule::Ansys if kind == ElementKind::Hexahedron20 => quadrature::hexahedron_14(),
        MassRule::CalculiX | MassRule::Ansys if kind.is_solid() => stiffness_points(kind, form),
        MassRule::Abaqus => (element.mass_of_abaqus)(),
        _ => (element.mass)(),
    }
}

/// Shape functions at the points of a rule.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    /// Position in the reference domain.
    pub(super) at: [f64; 3],
    pub(super) weight: f64,
    pub(super) shape: Shape,
}

fn samples(kind: ElementKind, form: Form, points: &[Point]) -> Vec<Sample> {
    points
        .iter()
        .map(|point| Sample {
            at: point.at,
            weight: point.weight,
            shape: form.shape(kind, point.at),
        })
        .collect()
}

/// Samples of one kind of element.
#[derive(Clone, Debug)]
pub(super) struct Table {
    /// The form of a solid's stiffness.
    pub(super) form: Form,
    /// The shape functions of the element with corners alone, in the middle of a solid.
    pub(super) corners: Option<Shape>,
    pub(super) stiffness: Vec<Sample>,
    pub(super) mass: Vec<Sample>,
    pub(super) spread: Spread,
}

impl Table {
    pub(super) fn new(kind: ElementKind, form: Form, mass: MassRule) -> Self {
        let middle = || Shape::at(kind.linear(), kind.description().centre);
        Table {
            corners: kind.is_solid().then(middle),
            form,
            stiffness: samples(kind, form, &stiffness_points(kind, form)),
            mass: samples(kind, form, &mass_points(kind, form, mass)),
            spread: spread(kind, mass),
        }
    }
}
