//! Forces and moments of a shell as functions of its strains.

use super::laminate::{self, Ply};
use super::{CORNERS, STRAINS};
use crate::element::MOST_NODES;
use crate::fe::sheet::Sheet;
use crate::fe::vector::{Vector, dot};
use crate::mesh::{Layup, Material, ShellAxis, ShellShape};

/// Of a section without shear flexibility: the bending stiffness by the shear stiffness and the element's
/// area. The deflection of one element by shear is then 1e-5 of that by bending.
const RIGID: f64 = 1e-5 / 12.0;

/// `C` of `[N; M; Q; k δ] = C [ε; κ; γ; δ]` (N/m, N, N m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::fe) struct Law(pub [[f64; STRAINS]; STRAINS]);

impl Law {
    /// Bending stiffness (N m) for a curvature along the unit direction in the surface.
    pub fn bending_along(&self, [cosine, sine]: [f64; 2]) -> f64 {
        let curvature = [cosine * cosine, sine * sine, 2.0 * cosine * sine];
        let mut bending = 0.0;
        for (a, first) in curvature.iter().enumerate() {
            for (b, second) in curvature.iter().enumerate() {
                bending += first * second * self.0[3 + a][3 + b];
            }
        }
        bending
    }

    /// Stiffness (N/m) of shear across the shell along the unit direction in the surface.
    pub fn shear_along(&self, [cosine, sine]: [f64; 2]) -> f64 {
        let [c2, s2, cs] = [cosine * cosine, sine * sine, cosine * sine];
        c2 * self.0[6][6] + s2 * self.0[7][7] + 2.0 * cs * self.0[6][7]
    }
}

/// Stiffness in plane stress (Pa): 11, 22, 12 of stress for those of strain, with engineering shear.
pub(in crate::fe) type Plane = [[f64; 3]; 3];

/// Stiffness of shear across the plate (Pa).
pub(super) type Across = [[f64; 2]; 2];

/// A surface of a shell or of one of its layers: its stress is `Q_s ε + z Q_b κ` at the height z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::fe) struct Face {
    pub height: f64,
    pub stretching: Plane,
    pub bending: Plane,
}

impl Face {
    fn new(height: f64, stretching: Plane, bending: Plane) -> Self {
        Face {
            height,
            stretching,
            bending,
        }
    }
}

/// Section, materials and position of a shell. The stiffness is that of a unit of thickness t, in the
/// section's axes: `N = t A ε + t² B κ`, `M = t² B ε + t³/12 D κ`, `Q = t S γ`.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::fe) struct Plate {
    /// Thickness at the corners (m); linear between them.
    thickness: [f64; CORNERS],
    /// From the corners to the middle surface along the normal (m); linear between them.
    pub offsets: [f64; CORNERS],
    stretching: Plane,
    coupling: Plane,
    bending: Plane,
    /// `None`: without shear flexibility.
    across: Option<Across>,
    /// Surfaces on which stresses are found, in the section's axes.
    faces: Vec<Face>,
    membrane: bool,
    /// The first axis of the section (its part in the surface; without one, that of the element's side),
    /// and its turn about the normal (rad). An isotropic section has none.
    axis: Option<(Option<Vector>, f64)>,
    /// Density ρ (kg/m³) over the height ζ t: `∫ ρ dζ`, `∫ ρ ζ dζ`, `12 ∫ ρ ζ² dζ`.
    density: [f64; 3],
    mass_per_area: f64,
}

/// A material in plane stress, of an isotropic one `E/(1 − ν²)` and `E/(2 (1 + ν))`, and its stiffness of
/// shear across the sheet.
pub(super) fn elasticity(material: &Material) -> (Plane, Option<Across>) {
    if let Some(sheet) = &material.sheet {
        return (sheet.plane, sheet.across);
    }
    let Material { young, poisson, .. } = *material;
    let plane = young / (1.0 - poisson * poisson);
    let modulus = 0.5 * young / (1.0 + poisson);
    let stiffness = [
        [plane, plane * poisson, 0.0],
        [plane * poisson, plane, 0.0],
        [0.0, 0.0, modulus],
    ];
    (stiffness, Some([[modulus, 0.0], [0.0, modulus]]))
}

fn times<const N: usize>(factor: f64, matrix: [[f64; N]; N]) -> [[f64; N]; N] {
    matrix.map(|row| row.map(|x| factor * x))
}

/// `Tᵀ C T`.
fn congruent<const N: usize>(turn: &[[f64; N]; N], matrix: &[[f64; N]; N]) -> [[f64; N]; N] {
    let mut out = [[0.0; N]; N];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            for (k, line) in matrix.iter().enumerate() {
                for (l, x) in line.iter().enumerate() {
                    *entry += turn[k][i] * x * turn[l][j];
                }
            }
        }
    }
    out
}

/// Cosine and sine of the angle from the element's first axis to that of the section.
#[derive(Clone, Copy)]
pub(super) struct Turn(pub f64, pub f64);

impl Turn {
    pub fn plane(self, matrix: &Plane) -> Plane {
        let Turn(c, s) = self;
        let strains = [
            [c * c, s * s, c * s],
            [s * s, c * c, -c * s],
            [-2.0 * c * s, 2.0 * c * s, c * c - s * s],
        ];
        congruent(&strains, matrix)
    }

    pub fn across(self, matrix: &Across) -> Across {
        let Turn(c, s) = self;
        congruent(&[[c, s], [-s, c]], matrix)
    }
}

impl Plate {
    pub fn new(sheet: &Sheet<'_>) -> Self {
        let Sheet {
            section, material, ..
        } = *sheet;
        let shape = sheet.shape.copied().unwrap_or_default();
        let (bending, shear) = match section.layup {
            Layup::One if section.shear == 0.0 => (Some(material), None),
            Layup::One => (Some(material), Some(material)),
            Layup::Layers(_) => (None, None),
            Layup::Apart { .. } => (sheet.bending, sheet.shear.filter(|_| section.shear > 0.0)),
        };
        let across = shear
            .and_then(|material| elasticity(material).1)
            .map(|across| times(section.shear, across));
        let density = material.density;
        let rotary = if section.is_membrane() { 0.0 } else { density };
        let ShellShape {
            offsets, thickness, ..
        } = shape;
        let mut plate = Plate {
            thickness: thickness.unwrap_or([section.thickness; CORNERS]),
            offsets,
            stretching: elasticity(material).0,
            coupling: [[0.0; 3]; 3],
            bending: bending.map_or([[0.0; 3]; 3], |material| {
                times(section.bending, elasticity(material).0)
            }),
            across,
            faces: match bending {
                None => vec![Face::new(0.0, elasticity(material).0, [[0.0; 3]; 3])],
                Some(bending) => [-0.5, 0.5]
                    .map(|height| Face::new(height, elasticity(material).0, elasticity(bending).0))
                    .to_vec(),
            },
            membrane: section.is_membrane(),
            axis: None,
            density: [density, 0.0, rotary],
            mass_per_area: section.mass_per_area,
        };
        if let Layup::Layers(_) = section.layup {
            plate.pile(&laminate::layers(sheet));
        }
        if sheet.is_directed() {
            plate.axis = Some(match shape.axis {
                ShellAxis::Side(turn) => (None, turn),
                ShellAxis::Direction(direction, turn) => (Some(direction), turn),
            });
        }
        plate
    }

    /// Puts layers in the place of one material.
    fn pile(&mut self, layers: &[Ply]) {
        self.stretching = laminate::moment(layers, 0);
        self.coupling = laminate::moment(layers, 1);
        self.bending = times(12.0, laminate::moment(layers, 2));
        self.across = laminate::across(layers);
        self.density = [0, 1, 2].map(|power| {
            let own = layers
                .iter()
                .map(|layer| layer.density * layer.moment(power));
            own.sum::<f64>()
        });
        self.density[2] *= 12.0;
        let both = |layer: &Ply| {
            layer
                .height
                .map(|height| Face::new(height, layer.plane, layer.plane))
        };
        self.faces = layers.iter().flat_map(both).collect();
    }

    /// Whether it resists no bending.
    pub fn is_membrane(&self) -> bool {
        self.membrane
    }

    /// Thickness (m) at a place with these functions of the corners.
    fn thickness(&self, values: &[f64; MOST_NODES]) -> f64 {
        let [first, others @ ..] = &self.thickness;
        if others.iter().all(|other| other == first) {
            return *first;
        }
        self.thickness.iter().zip(values).map(|(t, n)| t * n).sum()
    }

    /// Mass per area (kg/m²), its first moment (kg/m) and rotary inertia per area (kg) about the middle surface,
    /// at a place with these functions of the corners.
    pub fn inertia(&self, values: &[f64; MOST_NODES]) -> [f64; 3] {
        let thickness = self.thickness(values);
        let [own, first, second] = self.density;
        let square = thickness * thickness;
        [
            own * thickness + self.mass_per_area,
            first * square,
            second * square * thickness / 12.0,
        ]
    }

    /// The turn of the section's axes from those of the element.
    fn turn(&self, axes: &[Vector; 3], side: Vector) -> Option<Turn> {
        let (axis, turn) = self.axis?;
        let axis = axis.unwrap_or(side);
        let [x, y] = [dot(axis, axes[0]), dot(axis, axes[1])];
        let length = libm::hypot(x, y);
        let (x, y) = (x / length, y / length);
        let (c, s) = (libm::cos(turn), libm::sin(turn));
        Some(Turn(c * x - s * y, s * x + c * y))
    }

    /// The surfaces on which stresses are found, from the lower to the upper, at a place with these functions of the corners
    /// and axes, and with this side of the element. Their heights are in m.
    pub fn faces(&self, values: &[f64; MOST_NODES], axes: &[Vector; 3], side: Vector) -> Vec<Face> {
        let thickness = self.thickness(values);
        let turn = self.turn(axes, side);
        let turned = |matrix: &Plane| turn.map_or(*matrix, |turn| turn.plane(matrix));
        let own = self.faces.iter().map(|face| Face {
            height: thickness * face.height,
            stretching: turned(&face.stretching),
            bending: turned(&face.bending),
        });
        own.collect()
    }

    /// The law at a place with these functions of the corners and axes (two tangents, normal), and with this side of the
    /// element, in an element whose size has this square (m²). An isotropic plate has the membrane stiffness `E t/(1 − ν²)`, that of bending
    /// `b E t³/(12 (1 − ν²))` with the section's factor b, and that of shear `k G t` with its factor k.
    pub fn law(
        &self,
        values: &[f64; MOST_NODES],
        axes: &[Vector; 3],
        side: Vector,
        square: f64,
    ) -> Law {
        let thickness = self.thickness(values);
        let turn = self.turn(axes, side);
        let turned = |matrix: &Plane| turn.map_or(*matrix, |turn| turn.plane(matrix));
        let (stretching, bending) = (turned(&self.stretching), turned(&self.bending));
        let cube = thickness * thickness * thickness / 12.0;
        let mut law = [[0.0; STRAINS]; STRAINS];
        for i in 0..3 {
            for j in 0..3 {
                law[i][j] = thickness * stretching[i][j];
                law[3 + i][3 + j] = cube * bending[i][j];
            }
        }
        if self.coupling != [[0.0; 3]; 3] {
            let coupling = turned(&self.coupling);
            for i in 0..3 {
                for j in 0..3 {
                    let x = thickness * thickness * coupling[i][j];
                    law[i][3 + j] = x;
                    law[3 + i][j] = x;
                }
            }
        }
        if self.membrane {
            return Law(law);
        }
        let across = match &self.across {
            None => {
                let rigid = law[3][3].max(law[4][4]) / (RIGID * square);
                [[rigid, 0.0], [0.0, rigid]]
            }
            Some(across) => {
                let own = turn.map_or(*across, |turn| turn.across(across));
                times(thickness, own)
            }
        };
        for (row, own) in law[6..].iter_mut().zip(across) {
            row[6..8].copy_from_slice(&own);
        }
        let drilling = (thickness * thickness / square).min(1.0);
        law[8][8] = drilling * self.stretching[2][2] * thickness;
        Law(law)
    }
}
