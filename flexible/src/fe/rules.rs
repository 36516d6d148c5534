//! Which quadrature each element uses, and how mass is spread.

use super::form::Form;
use super::quadrature::{self, Point};
use super::shape::{self, Shape};
use crate::mesh::ElementKind;

/// Which code's rules give each solid its form: see [`super::form`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum StiffnessRule {
    /// Those of the code that the mesh was written for.
    #[default]
    Named,
    /// Full integration of every solid, whatever the file names:
    ///
    /// | element | points |
    /// | --- | --- |
    /// | tetrahedron 4, 10 | 1, 4 |
    /// | hexahedron 8, 20 | 2³, 3³ |
    /// | wedge 6, 15 | 3 × 2, 3 × 3 |
    /// | pyramid 5, 13 | 2³, 3³ |
    Full,
    /// Those of CalculiX 2.20.
    CalculiX,
    /// Those of Abaqus.
    Abaqus,
    /// Those of Nastran, as far as they are public.
    Nastran,
}

/// Integration and form of the elements' mass. The foreign rules differ in solids only. Beams are consistent in all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum MassRule {
    /// Consistent mass, integrated exactly for any element, curved ones included.
    #[default]
    Exact,
    /// CalculiX 2.20: consistent mass integrated at the points of the stiffness, so that the 10-node tetrahedron's is
    /// under-integrated at 4 points. Checked against its matrices for C3D8, C3D10 and C3D20, against its frequencies for C3D6, C3D8I
    /// and C3D20R.
    CalculiX,
    /// Abaqus: linear elements lumped by row sums, the 10-node tetrahedron exact, other quadratic solids at their full
    /// stiffness points. Checked against its matrices for C3D4, C3D8, C3D10, C3D20 and C3D20R.
    Abaqus,
    /// Diagonal mass: row sums for linear elements; the exact diagonal scaled to the element's mass for quadratic ones (E. Hinton,
    /// T. Rock, O. C. Zienkiewicz, Earthq. Eng. Struct. Dyn. 4, 1976), whose row sums are partly negative.
    Lumped,
}

/// The rules of an assembly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Rules {
    /// For stiffness.
    pub stiffness: StiffnessRule,
    /// For mass.
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

    /// The forms of Nastran, exact mass.
    pub fn nastran() -> Self {
        Rules {
            stiffness: StiffnessRule::Nastran,
            mass: MassRule::Exact,
        }
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

/// How an element's consistent mass becomes its mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spread {
    Consistent,
    RowSum,
    ScaledDiagonal,
}

pub(super) fn spread(kind: ElementKind, rule: MassRule) -> Spread {
    let linear = shape::edges(kind).is_empty();
    if rule == MassRule::Abaqus && !shape::is_solid(kind) {
        return Spread::Consistent;
    }
    match (rule, linear) {
        (MassRule::Exact | MassRule::CalculiX, _) | (MassRule::Abaqus, false) => Spread::Consistent,
        (MassRule::Abaqus | MassRule::Lumped, true) => Spread::RowSum,
        (MassRule::Lumped, false) => Spread::ScaledDiagonal,
    }
}

/// Points for the stiffness of a solid; none for other elements.
pub fn stiffness_points(kind: ElementKind, form: Form) -> Vec<Point> {
    match kind {
        ElementKind::Tetrahedron4 => quadrature::tetrahedron_1(),
        ElementKind::Tetrahedron10 => quadrature::tetrahedron_4(),
        ElementKind::Hexahedron8 => quadrature::hexahedron(2),
        ElementKind::Hexahedron20 => quadrature::hexahedron(match form {
            Form::Reduced => 2,
            _ => 3,
        }),
        ElementKind::Wedge6 => match form {
            Form::Reduced => quadrature::wedge(&quadrature::triangle_1(), 2),
            _ => quadrature::wedge(&quadrature::triangle_3(), 2),
        },
        ElementKind::Wedge15 => quadrature::wedge(&quadrature::triangle_3(), 3),
        ElementKind::Pyramid5 => quadrature::pyramid(2),
        ElementKind::Pyramid13 => quadrature::pyramid(3),
        _ => Vec::new(),
    }
}

/// Points that integrate N_a N_b det J exactly for any place of the nodes. Degrees of the integrand: tetrahedra 2 and 7;
/// hexahedra 4 and 9 a coordinate; wedges 4 and 9 at most; pyramids 4 and 9 in the collapsed coordinates. For surfaces, whose
/// area element is a root, exact when flat, straight and (quadrilaterals) with any corners.
fn exact_points(kind: ElementKind) -> Vec<Point> {
    match kind {
        ElementKind::Tetrahedron4 => quadrature::tetrahedron(2),
        ElementKind::Tetrahedron10 => quadrature::tetrahedron(4),
        ElementKind::Hexahedron8 => quadrature::hexahedron(3),
        ElementKind::Hexahedron20 => quadrature::hexahedron(5),
        ElementKind::Wedge6 => quadrature::wedge(&quadrature::triangle(3), 3),
        ElementKind::Wedge15 => quadrature::wedge(&quadrature::triangle(5), 5),
        ElementKind::Pyramid5 => quadrature::pyramid(3),
        ElementKind::Pyramid13 => quadrature::pyramid(5),
        ElementKind::Triangle3 => quadrature::triangle(2),
        ElementKind::Triangle6 => quadrature::triangle(4),
        ElementKind::Quadrilateral4 => quadrature::quadrilateral(3),
        ElementKind::Quadrilateral8 => quadrature::quadrilateral(5),
        ElementKind::Beam2 => Vec::new(),
    }
}

fn mass_points(kind: ElementKind, form: Form, rule: MassRule) -> Vec<Point> {
    match rule {
        _ if !shape::is_solid(kind) => exact_points(kind),
        MassRule::CalculiX => stiffness_points(kind, form),
        MassRule::Abaqus
            if matches!(
                kind,
                ElementKind::Hexahedron20 | ElementKind::Wedge15 | ElementKind::Pyramid13
            ) =>
        {
            stiffness_points(kind, Form::Full)
        }
        _ => exact_points(kind),
    }
}

/// Shape functions at the points of a rule.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    /// Place in the reference domain.
    pub(super) at: [f64; 3],
    pub(super) weight: f64,
    pub(super) shape: Shape,
}

pub(super) fn samples(kind: ElementKind, points: &[Point]) -> Vec<Sample> {
    points
        .iter()
        .map(|point| Sample {
            at: point.at,
            weight: point.weight,
            shape: Shape::at(kind, point.at),
        })
        .collect()
}

/// Samples of one kind of element.
#[derive(Clone, Debug)]
pub(super) struct Table {
    /// How the stiffness of a solid is made of its samples.
    pub(super) form: Form,
    /// The element of the corners alone, in the middle of a solid.
    pub(super) corners: Option<Shape>,
    pub(super) stiffness: Vec<Sample>,
    pub(super) mass: Vec<Sample>,
    pub(super) spread: Spread,
}

impl Table {
    pub(super) fn new(kind: ElementKind, form: Form, mass: MassRule) -> Self {
        let centre = match shape::linear(kind) {
            ElementKind::Tetrahedron4 => Some([0.25; 3]),
            ElementKind::Hexahedron8 => Some([0.0; 3]),
            ElementKind::Wedge6 => Some([1.0 / 3.0, 1.0 / 3.0, 0.0]),
            ElementKind::Pyramid5 => Some([0.0, 0.0, 0.25]),
            _ => None,
        };
        Table {
            corners: centre.map(|at| Shape::at(shape::linear(kind), at)),
            form,
            stiffness: samples(kind, &stiffness_points(kind, form)),
            mass: samples(kind, &mass_points(kind, form, mass)),
            spread: spread(kind, mass),
        }
    }
}
