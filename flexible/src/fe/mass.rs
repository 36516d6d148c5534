//! The mass of a structure: as an operator, as a matrix, and as a rigid body.

use super::freedoms::FreedomMap;
use crate::error::FlexibleError;
use crate::mesh::{Mesh, scalar_index};
use crate::sparse::product::{Lanes, TOGETHER, pack, unpack};
use crate::sparse::{SymmetricMatrix, SymmetricOperator};
use faer::traits::pulp::{Arch, Simd, WithSimd};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The mass matrix over full freedoms, M = M_s ⊗ I₃ + M_g: the mass of solids, shells and plain point masses
/// is the same in all directions and needs one number for each pair of nodes. M_g is general.
#[derive(Clone, Debug, PartialEq)]
pub struct Mass {
    freedoms: FreedomMap,
    /// M_s over nodes (kg).
    pub solid: SymmetricMatrix,
    /// M_g over full freedoms (kg, kg m, kg m²): beams, offset shells and point masses, rotary
    /// inertia.
    pub general: Option<SymmetricMatrix>,
}

/// Mass properties of a structure that moves as a rigid body, about the origin of the basic frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RigidMass {
    /// Mass (kg).
    pub mass: f64,
    /// First moment ∫ r dm (kg m).
    pub first_moment: [f64; 3],
    /// Inertia ∫ (r·r I − r rᵀ) dm (kg m²).
    pub inertia: [[f64; 3]; 3],
}

impl RigidMass {
    /// Centre of mass (m); not finite for a structure without mass.
    pub fn centre(&self) -> [f64; 3] {
        self.first_moment.map(|x| x / self.mass)
    }
}

/// The six rigid motions as full vectors one after the other: unit translations (m/m) along x, y, z, then
/// small unit rotations (m/rad, rad/rad) about axes x, y, z through the origin of the basic frame, e × r.
pub fn rigid_motions(mesh: &Mesh, freedoms: &FreedomMap) -> Vec<f64> {
    let size = freedoms.size();
    let mut motions = vec![0.0; 6 * size];
    for (node, range) in mesh
        .nodes
        .iter()
        .zip((0..freedoms.node_count()).map(|node| freedoms.of(node as u32)))
    {
        let [x, y, z] = node.position;
        let turned = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        for freedom in range.clone() {
            let component = freedom - range.start;
            if component < 3 {
                motions[component * size + freedom] = 1.0;
                for (axis, displacement) in turned.iter().enumerate() {
                    motions[(3 + axis) * size + freedom] = displacement[component];
                }
            } else {
                motions[component * size + freedom] = 1.0;
            }
        }
    }
    motions
}

impl Mass {
    /// Makes the mass from its parts.
    ///
    /// # Errors
    /// When the sizes don't fit the freedoms.
    pub fn new(
        freedoms: FreedomMap,
        solid: SymmetricMatrix,
        general: Option<SymmetricMatrix>,
    ) -> Result<Self, FlexibleError> {
        let fits = solid.size() == freedoms.all_nodes()
            && general
                .as_ref()
                .is_none_or(|general| general.size() == freedoms.size());
        if !fits {
            return Err(FlexibleError::Matrix {
                problem: "the mass matrix has another size than the mesh".into(),
                advice: String::new(),
            });
        }
        Ok(Mass {
            freedoms,
            solid,
            general,
        })
    }

    /// The whole matrix over full freedoms.
    ///
    /// # Errors
    /// None for a mass from [`Mass::new`].
    pub fn assembled(&self) -> Result<SymmetricMatrix, FlexibleError> {
        let size = self.freedoms.size();
        let general = self.general.as_ref();
        let entries = 3 * self.solid.rows().len() + general.map_or(0, |g| g.rows().len());
        let (mut row, mut value) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
        let mut column_start = Vec::with_capacity(size + 1);
        column_start.push(0usize);
        for node in 0..self.solid.size() {
            let own = self.freedoms.of(node as u32);
            let (others, masses) = self.solid.column(node);
            for column in own.clone() {
                let component = column - own.start;
                let (rows, values) = general.map_or((&[][..], &[][..]), |g| g.column(column));
                let mut extra = rows.iter().copied().zip(values.iter().copied()).peekable();
                if component < 3 {
                    for (&other, &mass) in others.iter().zip(masses) {
                        let second = self.freedoms.of(other);
                        // a scalar point has one freedom
                        if second.len() <= component {
                            continue;
                        }
                        let target = (second.start + component) as u32;
                        while let Some((before, x)) = extra.next_if(|(r, _)| *r < target) {
                            row.push(before);
                            value.push(x);
                        }
                        let same = extra.next_if(|(r, _)| *r == target).map_or(0.0, |(_, x)| x);
                        row.push(target);
                        value.push(mass + same);
                    }
                }
                for (r, x) in extra {
                    row.push(r);
                    value.push(x);
                }
                column_start.push(row.len());
            }
        }
        SymmetricMatrix::from_parts(size, column_start, row, value)
    }

    /// Mass properties of the structure in rigid motion, exactly those of its matrix: Rᵀ M R with R of
    /// [`rigid_motions`].
    pub fn rigid(&self, mesh: &Mesh) -> RigidMass {
        self.rigid_along(mesh).0
    }

    /// The mass properties of [`Mass::rigid`], and the mass (kg) for each translation along x, y, z. The
    /// three are equal, except in matrices of models whose masses act along some axes only.
    pub fn rigid_along(&self, mesh: &Mesh) -> (RigidMass, [f64; 3]) {
        let size = self.freedoms.size();
        let motions = rigid_motions(mesh, &self.freedoms);
        let mut inertial = vec![0.0; motions.len()];
        self.apply(6, &motions, &mut inertial);
        let entry = |i: usize, j: usize| -> f64 {
            motions[i * size..(i + 1) * size]
                .iter()
                .zip(&inertial[j * size..(j + 1) * size])
                .map(|(x, y)| x * y)
                .sum()
        };
        // the motion e_k × r has the momentum m (e_k × c), so c follows from the entries (y; rotation x) and
        // so on
        let mut inertia = [[0.0; 3]; 3];
        for (i, line) in inertia.iter_mut().enumerate() {
            for (j, x) in line.iter_mut().enumerate() {
                *x = entry(3 + i.min(j), 3 + i.max(j));
            }
        }
        let along = [entry(0, 0), entry(1, 1), entry(2, 2)];
        let rigid = RigidMass {
            mass: (along[0] + along[1] + along[2]) / 3.0,
            first_moment: [entry(1, 5), entry(2, 3), entry(0, 4)],
            inertia,
        };
        (rigid, along)
    }
}

/// Difference of the masses along x, y and z of a pair of nodes, by the largest mass, above which the mass
/// does not act alike. Files with few digits have less. A choice: a smaller limit would take the digits of a
/// file for a direction, a larger one would ignore a mass that really acts along one axis.
const ALIKE: f64 = 1e-5;

impl Mass {
    /// Whether the mass acts alike on the displacements along x, y and z, and on nothing else, as a
    /// consistent or lumped mass of solids does: `m_ij 1` for each pair of nodes.
    pub fn acts_alike(&self) -> bool {
        let Some(general) = &self.general else {
            return true;
        };
        let mut pairs: BTreeMap<(u32, u32), [f64; 3]> = BTreeMap::new();
        let (mut most, mut beside) = (0.0f64, 0.0f64);
        for column in 0..general.size() {
            let Some((node, component)) = self.freedoms.owner(column) else {
                continue;
            };
            let (rows, values) = general.column(column);
            for (row, value) in rows.iter().zip(values) {
                let Some((other, its)) = self.freedoms.owner(*row as usize) else {
                    continue;
                };
                let block = pairs.entry((node.min(other), node.max(other))).or_default();
                match block.get_mut(usize::from(component)) {
                    Some(own) if component == its && scalar_index(node).is_none() => {
                        *own += value;
                        most = most.max(value.abs());
                    }
                    _ => beside = beside.max(value.abs()),
                }
            }
        }
        let apart = |[x, y, z]: &[f64; 3]| x.max(*y).max(*z) - x.min(*y).min(*z);
        let differ = pairs.values().map(apart).fold(beside, f64::max);
        differ <= ALIKE * most
    }
}

impl SymmetricOperator for Mass {
    fn size(&self) -> usize {
        self.freedoms.size()
    }

    fn apply(&self, columns: usize, x: &[f64], y: &mut [f64]) {
        match &self.general {
            Some(general) => general.apply(columns, x, y),
            None => y.fill(0.0),
        }
        self.add_alike(columns, x, y);
    }
}

impl Mass {
    /// Adds `M_s ⊗ I₃ x`, the part that is the same in all directions, to `y` for `columns` vectors one after
    /// the other.
    pub fn add_alike(&self, columns: usize, x: &[f64], y: &mut [f64]) {
        let size = self.freedoms.size();
        let length = size * columns;
        let (Some(x), Some(y)) = (x.get(..length), y.get_mut(..length)) else {
            return;
        };
        if length == 0 {
            return;
        }
        let mut packed = vec![[0.0; TOGETHER]; size];
        let mut product = packed.clone();
        let chunk = size * TOGETHER;
        for (x, y) in x.chunks(chunk).zip(y.chunks_mut(chunk)) {
            pack(x, &mut packed);
            pack(y, &mut product);
            Arch::new().dispatch(Alike {
                mass: self,
                x: &packed,
                y: &mut product,
            });
            unpack(&product, y);
        }
    }

    /// Adds the product of the solids' mass with several vectors.
    #[inline(always)]
    fn add_solid(&self, x: &[Lanes], y: &mut [Lanes]) {
        for node in 0..self.solid.size() {
            let first = self.freedoms.of(node as u32);
            // a scalar point has one freedom, and no mass in here
            if first.len() < 3 {
                continue;
            }
            let first = first.start;
            let own = [x[first], x[first + 1], x[first + 2]];
            let mut sum = [[0.0; TOGETHER]; 3];
            let (others, masses) = self.solid.column(node);
            for (&other, &mass) in others.iter().zip(masses) {
                let second = self.freedoms.of(other);
                // a spring may couple the node with a scalar point, without mass in here
                if second.len() < 3 {
                    continue;
                }
                let second = second.start;
                for axis in 0..3 {
                    for lane in 0..TOGETHER {
                        sum[axis][lane] += mass * x[second + axis][lane];
                    }
                    if second != first {
                        for lane in 0..TOGETHER {
                            y[second + axis][lane] += mass * own[axis][lane];
                        }
                    }
                }
            }
            for (y, sum) in y[first..].iter_mut().zip(sum) {
                for (y, sum) in y.iter_mut().zip(sum) {
                    *y += sum;
                }
            }
        }
    }
}

/// [`Mass::add_alike`] of packed vectors, with the widest vectors that the processor has.
struct Alike<'a> {
    mass: &'a Mass,
    x: &'a [Lanes],
    y: &'a mut [Lanes],
}

impl WithSimd for Alike<'_> {
    type Output = ();

    // inlined code is compiled for the processor's own instructions
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.mass.add_solid(self.x, self.y);
    }
}
