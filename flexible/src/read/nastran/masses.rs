//! Point masses and springs: `CONM1`, `CONM2`, `CMASS1` to `CMASS4`, `PMASS`, `CELAS1` to `CELAS4`, `PELAS`.

use std::collections::BTreeMap;

use super::card::Card;
use super::frames::Systems;
use super::grids::Lookup;
use super::lines::At;
use super::vector::{IDENTITY, Rotation, product, rotate};
use crate::error::FileProblem;
use crate::fe::vector::subtract;
use crate::mesh::{Frame, Node, PointMass, Spring};

type Matrix3 = [[f64; 3]; 3];
type Matrix6 = [[f64; 6]; 6];

/// Grid point and freedom; `None`: the ground. A scalar point has no freedom number.
type End = Option<(u64, Option<u8>)>;

#[derive(Clone, Debug)]
enum Kind {
    /// Mass, offset of its centre, inertia about the centre.
    Rigid {
        mass: f64,
        offset: [f64; 3],
        inertia: Matrix3,
        /// The offset is a place in the basic frame.
        absolute: bool,
    },
    /// The whole matrix.
    Matrix(Box<Matrix6>),
    /// A mass at one freedom of the analysis frame.
    Freedom { mass: f64, freedom: u8 },
}

/// A card of a mass.
#[derive(Clone, Debug)]
pub(super) struct MassCard {
    order: u64,
    id: u64,
    grid: u64,
    system: u64,
    kind: Kind,
    at: At,
}

/// A card of a spring, or of a mass at two freedoms or a scalar point.
#[derive(Clone, Debug)]
pub(super) struct SpringCard {
    order: u64,
    id: u64,
    stiffness: SpringStiffness,
    inert: bool,
    ends: [End; 2],
    at: At,
}

#[derive(Clone, Copy, Debug)]
enum SpringStiffness {
    Value(f64),
    Property(u64),
}

/// Cards of masses and springs.
#[derive(Debug, Default)]
pub(super) struct Masses {
    masses: Vec<MassCard>,
    springs: Vec<SpringCard>,
    stiffness: BTreeMap<u64, f64>,
    /// Masses of `PMASS`.
    mass: BTreeMap<u64, f64>,
}

impl Masses {
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        match card.name.as_str() {
            "CONM2" => self.rigid(card)?,
            "CONM1" => self.matrix(card)?,
            "CMASS1" | "CMASS2" | "CMASS3" | "CMASS4" | "CELAS1" | "CELAS2" | "CELAS3"
            | "CELAS4" => {
                self.spring(card)?;
            }
            "PELAS" => values(card, &[0, 4], "springs", &mut self.stiffness)?,
            "PMASS" => values(card, &[0, 2, 4, 6], "point masses", &mut self.mass)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// `CONM2 EID G CID M X1 X2 X3 / I11 I21 I22 I31 I32 I33`: moments about the centre of mass; products are
    /// given as the positive integral ∫ x y dm, and the matrix has them with a minus. With CID = -1 the
    /// offset is a place in the basic frame.
    fn rigid(&mut self, card: &Card) -> Result<(), FileProblem> {
        let absolute = card.text(2) == "-1";
        let system = if absolute {
            0
        } else {
            card.optional_id(2, "CID")?.unwrap_or(0)
        };
        let moment = |i: usize, name: &str| card.real_or_zero(i, name);
        let (i11, i21, i22) = (moment(8, "I11")?, moment(9, "I21")?, moment(10, "I22")?);
        let (i31, i32, i33) = (moment(11, "I31")?, moment(12, "I32")?, moment(13, "I33")?);
        self.masses.push(MassCard {
            order: card.order,
            id: card.id(0, "EID")?,
            grid: card.id(1, "G")?,
            system,
            kind: Kind::Rigid {
                mass: card.real_or_zero(3, "M")?,
                offset: card.vector(4, "X")?,
                inertia: [[i11, -i21, -i31], [-i21, i22, -i32], [-i31, -i32, i33]],
                absolute,
            },
            at: card.at.clone(),
        });
        Ok(())
    }

    /// `CONM1 EID G CID M11 M21 M22 M31 … M66`: the lower triangle by rows.
    fn matrix(&mut self, card: &Card) -> Result<(), FileProblem> {
        let mut matrix = [[0.0; 6]; 6];
        let lower = (0..6_usize).flat_map(|i| (0..=i).map(move |j| (i, j)));
        for (field, (i, j)) in lower.enumerate() {
            let value = card.real_or_zero(3 + field, &format!("M{}{}", i + 1, j + 1))?;
            matrix[i][j] = value;
            matrix[j][i] = value;
        }
        self.masses.push(MassCard {
            order: card.order,
            id: card.id(0, "EID")?,
            grid: card.id(1, "G")?,
            system: card.optional_id(2, "CID")?.unwrap_or(0),
            kind: Kind::Matrix(Box::new(matrix)),
            at: card.at.clone(),
        });
        Ok(())
    }

    /// `CELAS1 EID PID G1 C1 G2 C2`, `CELAS2 EID K G1 C1 G2 C2`, `CELAS3 EID PID S1 S2`, `CELAS4 EID K S1
    /// S2`, and `CMASS1` to `CMASS4` alike: a blank end is the ground. A mass between the ground and one
    /// freedom of a grid point is a point mass.
    fn spring(&mut self, card: &Card) -> Result<(), FileProblem> {
        let id = card.id(0, "EID")?;
        let inert = card.name.starts_with("CMASS");
        let stiffness = if card.name.ends_with(['2', '4']) {
            SpringStiffness::Value(card.real(1, if inert { "M" } else { "K" })?)
        } else {
            SpringStiffness::Property(
                card.optional_id(1, "PID")?
                    .filter(|id| *id > 0)
                    .unwrap_or(id),
            )
        };
        let ends = match card.name.ends_with(['1', '2']) {
            true => ends(card, 2)?,
            false => scalar_ends(card, 2)?,
        };
        if ends == [None, None] {
            return Err(card.problem(
                &format!("the {} has no end at a grid point", kind(inert)),
                "give a grid point and its freedom in G1 and C1, or in G2 and C2",
            ));
        }
        if let (true, SpringStiffness::Value(mass)) = (inert, stiffness)
            && let [Some((grid, Some(freedom))), None] | [None, Some((grid, Some(freedom)))] = ends
        {
            self.masses.push(MassCard {
                order: card.order,
                id,
                grid,
                system: 0,
                kind: Kind::Freedom { mass, freedom },
                at: card.at.clone(),
            });
            return Ok(());
        }
        self.springs.push(SpringCard {
            order: card.order,
            id,
            stiffness,
            inert,
            ends,
            at: card.at.clone(),
        });
        Ok(())
    }

    /// The point masses of a mesh.
    pub fn point_masses(
        &mut self,
        nodes: &[Node],
        frames: &[Frame],
        systems: &Systems,
        lookup: &Lookup,
        mass_scale: f64,
    ) -> Result<Vec<PointMass>, FileProblem> {
        self.masses.sort_by_key(|card| card.order);
        distinct("mass", self.masses.iter().map(|card| (card.id, &card.at)))?;
        let mut points = Vec::with_capacity(self.masses.len());
        for card in &self.masses {
            let user = || format!("mass {}", card.id);
            let index = lookup.require(card.grid, &user, &card.at)?;
            let Some(node) = nodes.get(index as usize) else {
                continue;
            };
            let axes = systems.axes_at(card.system, node.position, &user, &card.at)?;
            let matrix = match &card.kind {
                Kind::Rigid {
                    mass,
                    offset,
                    inertia,
                    absolute,
                } => {
                    let offset = if *absolute {
                        subtract(*offset, node.position)
                    } else {
                        rotate(&axes, *offset)
                    };
                    rigid_matrix(*mass, offset, &turned(&axes, inertia))
                }
                Kind::Matrix(matrix) => turned_matrix(&axes, matrix),
                Kind::Freedom { mass, freedom } => {
                    let mut matrix = [[0.0; 6]; 6];
                    for (i, row) in matrix.iter_mut().enumerate() {
                        for (j, value) in row.iter_mut().enumerate() {
                            let here = usize::from(*freedom);
                            *value = if i == here && j == here { *mass } else { 0.0 };
                        }
                    }
                    let frame = node.frame.and_then(|frame| frames.get(frame as usize));
                    turned_matrix(&frame.map_or(IDENTITY, |frame| frame.rotation), &matrix)
                }
            };
            points.push(PointMass {
                id: card.id,
                node: index,
                matrix: matrix.map(|row| row.map(|value| value * mass_scale)),
            });
        }
        Ok(points)
    }

    /// The springs of a mesh, and its masses at two freedoms or at scalar points.
    pub fn springs(
        &mut self,
        lookup: &Lookup,
        scalars: &mut Vec<u64>,
        mass_scale: f64,
    ) -> Result<[Vec<Spring>; 2], FileProblem> {
        self.springs.sort_by_key(|card| card.order);
        for inert in [false, true] {
            let alike = self.springs.iter().filter(|card| card.inert == inert);
            distinct(kind(inert), alike.map(|card| (card.id, &card.at)))?;
        }
        let mut springs = [Vec::new(), Vec::new()];
        for card in &self.springs {
            let (what, properties, named) = match card.inert {
                true => (kind(true), &self.mass, "PMASS"),
                false => (kind(false), &self.stiffness, "PELAS"),
            };
            let stiffness = match card.stiffness {
                SpringStiffness::Value(stiffness) => stiffness,
                SpringStiffness::Property(id) => *properties.get(&id).ok_or_else(|| {
                    card.at.problem(
                        format!("{what} {} uses property {id}, which is missing", card.id),
                        format!("add its {named} card, or INCLUDE the file that holds it"),
                    )
                })?,
            };
            let user = || format!("{what} {}", card.id);
            let mut ends = Vec::with_capacity(2);
            for (grid, freedom) in card.ends.into_iter().flatten() {
                ends.push(lookup.freedom(grid, freedom, scalars, &user, &card.at)?);
            }
            if let [first, ref rest @ ..] = *ends.as_slice() {
                let second = rest.first().copied();
                let value = if card.inert {
                    stiffness * mass_scale
                } else {
                    stiffness
                };
                let [of_springs, of_masses] = &mut springs;
                let list = if card.inert { of_masses } else { of_springs };
                list.push(Spring::between(card.id, value, first, second));
            }
        }
        Ok(springs)
    }
}

/// The word for messages.
fn kind(inert: bool) -> &'static str {
    if inert { "mass" } else { "spring" }
}

/// Values of a card that holds several properties, each a number and a value.
fn values(
    card: &Card,
    fields: &[usize],
    what: &str,
    into: &mut BTreeMap<u64, f64>,
) -> Result<(), FileProblem> {
    for &i in fields {
        if i > 0 && card.is_blank(i) {
            break;
        }
        let id = card.id(i, "PID")?;
        let value = card.real_or_zero(i + 1, "value")?;
        if into.insert(id, value).is_some() {
            return Err(card.problem(
                &format!("property {id} of {what} is defined twice"),
                "renumber or remove one of them",
            ));
        }
    }
    Ok(())
}

/// Two ends `G1 C1 G2 C2` from field `i`; a blank or zero grid point is the ground.
fn ends(card: &Card, i: usize) -> Result<[End; 2], FileProblem> {
    let end = |i: usize, name: &str| {
        let grid = card.optional_id(i, name)?.filter(|id| *id > 0);
        let freedom = card.freedom(i + 1, "C")?;
        Ok::<_, FileProblem>(grid.map(|grid| (grid, freedom)))
    };
    Ok([end(i, "G1")?, end(i + 2, "G2")?])
}

/// Two ends `S1 S2` at scalar points from field `i`; a blank one or zero is the ground.
fn scalar_ends(card: &Card, i: usize) -> Result<[End; 2], FileProblem> {
    let end = |i: usize, name: &str| {
        let point = card.optional_id(i, name)?.filter(|id| *id > 0);
        Ok::<_, FileProblem>(point.map(|point| (point, None)))
    };
    Ok([end(i, "S1")?, end(i + 1, "S2")?])
}

/// Refuses two of the same number.
pub(super) fn distinct<'c>(
    what: &str,
    cards: impl Iterator<Item = (u64, &'c At)>,
) -> Result<(), FileProblem> {
    let mut sorted = cards.collect::<Vec<_>>();
    sorted.sort_by_key(|(id, _)| *id);
    for pair in sorted.windows(2) {
        if let [(id, first), (again, at)] = *pair
            && id == again
        {
            return Err(at.problem(
                format!(
                    "{what} {id} is defined twice, first in {}, line {}",
                    first.file, first.line
                ),
                "renumber or remove one of them",
            ));
        }
    }
    Ok(())
}

/// R · matrix · Rᵀ.
fn turned(rotation: &Rotation, matrix: &Matrix3) -> Matrix3 {
    product(&product(rotation, matrix), &transposed(rotation))
}

fn transposed(a: &Matrix3) -> Matrix3 {
    super::vector::from_axes(a[0], a[1], a[2])
}

/// The matrix about the node of a rigid mass (kg, m, kg m² in SI) whose centre is at `offset` from it, all in
/// the basic frame. The centre moves with v − x̃ ω, so that M = [m 1, −m x̃; m x̃, J − m x̃ x̃].
fn rigid_matrix(mass: f64, offset: [f64; 3], inertia: &Matrix3) -> Matrix6 {
    let [x, y, z] = offset;
    let tilde = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let steiner = product(&tilde, &tilde);
    let mut matrix = [[0.0; 6]; 6];
    for i in 0..3 {
        matrix[i][i] = mass;
        for j in 0..3 {
            matrix[i][3 + j] = -mass * tilde[i][j];
            matrix[3 + i][j] = mass * tilde[i][j];
            matrix[3 + i][3 + j] = inertia[i][j] - mass * steiner[i][j];
        }
    }
    matrix
}

/// A 6×6 matrix of translations and rotations turned from a frame into the basic one.
fn turned_matrix(rotation: &Rotation, matrix: &Matrix6) -> Matrix6 {
    let mut result = [[0.0; 6]; 6];
    for block in [(0, 0), (0, 3), (3, 0), (3, 3)] {
        let (row, column) = block;
        let mut part = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                part[i][j] = matrix[row + i][column + j];
            }
        }
        let part = turned(rotation, &part);
        for i in 0..3 {
            for j in 0..3 {
                result[row + i][column + j] = part[i][j];
            }
        }
    }
    result
}
