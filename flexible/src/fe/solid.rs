//! Stiffness and mass of one solid: linear elastic, small displacements.

use super::elastic::{PlacedMaterial, dot, strain_of};
use super::hexahedron;
use super::rules::{Sample, Spread, Table};
use super::stress::Components;
use super::vector::{cross, determinant, norm, subtract};
use crate::element::{MOST_NODES, Shape};
use crate::error::FlexibleError;
use crate::mesh::{ABSENT, ElementKind, Material, Mesh};
use eng_system::significant::short;

/// The count of numbers for a pair of nodes: the nine of its stiffness block by rows, then its mass.
pub(super) const PAIR: usize = 10;

/// Index of a pair of local nodes, `a` ≤ `b`.
pub(super) fn pair(a: usize, b: usize) -> usize {
    b * (b + 1) / 2 + a
}

/// Lamé's constants λ and μ (Pa) of a material.
pub fn lame(material: &Material) -> (f64, f64) {
    let (young, poisson) = (material.young, material.poisson);
    (
        young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        young / (2.0 * (1.0 + poisson)),
    )
}

/// The existing nodes of an element. Mid-side nodes may be missing.
#[derive(Clone, Debug)]
pub(super) struct Present {
    kind: ElementKind,
    /// Local numbers of the missing mid-side nodes.
    absent: Vec<usize>,
    /// Local numbers of the existing nodes, ascending.
    local: [u8; MOST_NODES],
    pub(super) nodes: [u32; MOST_NODES],
    pub(super) count: usize,
    /// Number of inner nodes. They are the last ones.
    pub(super) inner: usize,
}

impl Present {
    pub(super) fn new(kind: ElementKind, connectivity: &[u32]) -> Self {
        let mut present = Present {
            kind,
            absent: Vec::new(),
            local: [0; MOST_NODES],
            nodes: [ABSENT; MOST_NODES],
            count: 0,
            inner: 0,
        };
        for (local, &node) in connectivity.iter().take(MOST_NODES).enumerate() {
            if node == ABSENT {
                present.absent.push(local);
            } else {
                present.local[present.count] = local as u8;
                present.nodes[present.count] = node;
                present.count += 1;
            }
        }
        present
    }

    /// The nodes with inner nodes added after the element's own.
    pub(super) fn with_inner(mut self, inner: std::ops::Range<u32>) -> Self {
        for node in inner.take(MOST_NODES - self.count) {
            self.nodes[self.count] = node;
            self.count += 1;
            self.inner += 1;
        }
        self
    }

    pub(super) fn nodes(&self) -> &[u32] {
        &self.nodes[..self.count]
    }

    /// The element's own nodes.
    pub(super) fn own(&self) -> &[u32] {
        &self.nodes[..self.count - self.inner]
    }

    /// Local numbers of the existing nodes, ascending.
    pub(super) fn locals(&self) -> impl Iterator<Item = usize> {
        let own = self.count - self.inner;
        self.local.iter().take(own).map(|local| usize::from(*local))
    }

    /// The shape functions of the existing nodes, in their order.
    pub(super) fn shape(&self, full: &Shape) -> Shape {
        let mut shape = *full;
        if self.absent.is_empty() {
            return shape;
        }
        for &local in &self.absent {
            shape.remove_midside(self.kind, local);
        }
        for (place, &local) in self.local.iter().enumerate().take(self.count) {
            shape.values[place] = shape.values[usize::from(local)];
            shape.slopes[place] = shape.slopes[usize::from(local)];
        }
        for place in self.count..MOST_NODES {
            shape.values[place] = 0.0;
            shape.slopes[place] = [0.0; 3];
        }
        shape
    }

    /// Position of the first node (m).
    pub(super) fn origin(&self, mesh: &Mesh) -> [f64; 3] {
        mesh.nodes[self.nodes[0] as usize].position
    }

    /// Positions of the nodes relative to the first one (m). Such small numbers lose fewer digits.
    pub(super) fn places(&self, mesh: &Mesh) -> [[f64; 3]; MOST_NODES] {
        let origin = self.origin(mesh);
        let mut places = [[0.0; 3]; MOST_NODES];
        // an inner node has no position
        for (place, &node) in places.iter_mut().zip(self.own()) {
            *place = subtract(mesh.nodes[node as usize].position, origin);
        }
        places
    }
}

/// Derivatives of the shape functions in space, and the volume of the reference domain's unit.
pub(super) struct Gradients {
    /// ∂N/∂x (1/m).
    pub(super) slope: [[f64; 3]; MOST_NODES],
    /// det ∂x/∂ξ (m³).
    pub(super) jacobian: f64,
}

/// Rows ∂x/∂ξ_i (m).
pub(crate) fn tangents(
    shape: &Shape,
    places: &[[f64; 3]; MOST_NODES],
    count: usize,
) -> [[f64; 3]; 3] {
    let mut rows = [[0.0; 3]; 3];
    for (slopes, place) in shape.slopes.iter().zip(places).take(count) {
        for (row, slope) in rows.iter_mut().zip(slopes) {
            for (x, place) in row.iter_mut().zip(place) {
                *x += slope * place;
            }
        }
    }
    rows
}

/// Gradients in space at a point.
///
/// # Errors
/// The Jacobian's determinant (m³), if it does not exceed zero by more than rounding errors.
pub(super) fn gradients(
    shape: &Shape,
    places: &[[f64; 3]; MOST_NODES],
    count: usize,
) -> Result<Gradients, f64> {
    let rows = tangents(shape, places, count);
    let jacobian = determinant(&rows);
    let size = norm(rows[0]) * norm(rows[1]) * norm(rows[2]);
    // the determinant of flat tangents is rounding
    if jacobian.is_nan() || jacobian <= 1e-12 * size {
        return Err(jacobian);
    }
    // ∂N/∂x = Σ ∂N/∂ξ_i (r_j × r_k)/det for the rows r of ∂x/∂ξ
    let dual = [
        cross(rows[1], rows[2]),
        cross(rows[2], rows[0]),
        cross(rows[0], rows[1]),
    ];
    let mut slope = [[0.0; 3]; MOST_NODES];
    for (slope, [r, s, t]) in slope.iter_mut().zip(shape.slopes).take(count) {
        for (axis, x) in slope.iter_mut().enumerate() {
            *x = (r * dual[0][axis] + s * dual[1][axis] + t * dual[2][axis]) / jacobian;
        }
    }
    Ok(Gradients { slope, jacobian })
}

/// As [`gradients`] at a point of an element's stiffness. The slopes of inner functions are turned into space
/// by the Jacobian at the middle of the element, as `table` has it.
///
/// # Errors
/// As [`gradients`].
pub(super) fn gradients_with_inner(
    table: &Table,
    shape: &Shape,
    places: &[[f64; 3]; MOST_NODES],
    (count, inner): (usize, usize),
) -> Result<Gradients, f64> {
    let own = count - inner;
    let mut found = gradients(shape, places, own)?;
    if let (1.., Some(middle)) = (inner, &table.corners) {
        let rows = tangents(middle, places, own);
        let dual = dual(&rows, determinant(&rows));
        for (slope, local) in found
            .slope
            .iter_mut()
            .zip(shape.slopes)
            .take(count)
            .skip(own)
        {
            for (axis, x) in slope.iter_mut().enumerate() {
                *x = local.iter().zip(&dual).map(|(s, row)| s * row[axis]).sum();
            }
        }
    }
    Ok(found)
}

/// Rows ∂ξ_i/∂x (1/m) for the rows ∂x/∂ξ_i and their determinant.
pub(super) fn dual(rows: &[[f64; 3]; 3], jacobian: f64) -> [[f64; 3]; 3] {
    [
        cross(rows[1], rows[2]),
        cross(rows[2], rows[0]),
        cross(rows[0], rows[1]),
    ]
    .map(|row| row.map(|x| x / jacobian))
}

/// Adds stiffness and mass of an element to zeroed `blocks` ([`PAIR`] numbers a pair of its nodes, see
/// [`pair`]):
///
/// K_ab = ∫ λ g_a g_bᵀ + μ g_b g_aᵀ + μ (g_a·g_b) I dV (N/m), m_ab = ∫ ρ N_a N_b dV (kg) (M = m ⊗ I₃), with g
/// = ∂N/∂x: the principle of virtual work for σ = λ tr ε I + 2 μ ε. An anisotropic material has K_ab = ∫ B_aᵀ D
/// B_b dV with the strains B of unit displacements and the stiffness D at each point. If the form changes the strains,
/// the matrices come from [`hexahedron`].
///
/// # Errors
/// A Jacobian (m³) that is not positive: that of the corners alone, or that of the first such point of the
/// stiffness.
pub(super) fn add_matrices(
    table: &Table,
    present: &Present,
    places: &[[f64; 3]; MOST_NODES],
    material: PlacedMaterial<'_>,
    blocks: &mut [f64],
) -> Result<(), f64> {
    let count = present.count;
    // mid-side nodes in the right places can hide corners in the wrong order
    if let Some(corners) = &table.corners {
        gradients(corners, places, present.kind.corner_count())?;
    }
    if table.form.correction().is_some() {
        hexahedron::add_stiffness(table, places, material, blocks)?;
    } else if material.material.solid.is_some() {
        add_anisotropic(table, present, places, material, blocks)?;
    } else {
        add_stiffness(table, present, places, material.material, blocks)?;
    }
    let mass = |sample: &Sample| {
        let shape = present.shape(&sample.shape);
        // a curved element may be folded at its edge; the signed volume is still right
        let jacobian = determinant(&tangents(&shape, places, count));
        (
            shape.values,
            material.material.density * sample.weight * jacobian,
        )
    };
    add_mass(table, (count, present.inner), mass, blocks);
    Ok(())
}

/// Adds ∫ λ g_a g_bᵀ + μ g_b g_aᵀ + μ (g_a·g_b) I dV (N/m) at the points of the stiffness.
fn add_stiffness(
    table: &Table,
    present: &Present,
    places: &[[f64; 3]; MOST_NODES],
    material: &Material,
    blocks: &mut [f64],
) -> Result<(), f64> {
    let count = present.count;
    for sample in &table.stiffness {
        let shape = present.shape(&sample.shape);
        let gradients = gradients_with_inner(table, &shape, places, (count, present.inner))?;
        let volume = sample.weight * gradients.jacobian;
        for b in 0..count {
            let second = gradients.slope[b].map(|x| volume * x);
            for a in 0..=b {
                let first = gradients.slope[a];
                let block = &mut blocks[PAIR * pair(a, b)..][..9];
                for i in 0..3 {
                    for j in 0..3 {
                        block[3 * i + j] += first[i] * second[j];
                    }
                }
            }
        }
    }
    let (lambda, mu) = lame(material);
    for block in blocks.chunks_exact_mut(PAIR) {
        let mut product = [0.0; 9];
        product.copy_from_slice(&block[..9]);
        let trace = mu * (product[0] + product[4] + product[8]);
        for i in 0..3 {
            for j in 0..3 {
                let isotropic = if i == j { trace } else { 0.0 };
                block[3 * i + j] =
                    lambda * product[3 * i + j] + mu * product[3 * j + i] + isotropic;
            }
        }
    }
    Ok(())
}

/// Adds ∫ B_aᵀ D B_b dV (N/m) at the points of the stiffness, with D in the material's axes at each point.
fn add_anisotropic(
    table: &Table,
    present: &Present,
    places: &[[f64; 3]; MOST_NODES],
    material: PlacedMaterial<'_>,
    blocks: &mut [f64],
) -> Result<(), f64> {
    let (count, own) = (present.count, present.count - present.inner);
    let mut strains = Vec::with_capacity(3 * count);
    for sample in &table.stiffness {
        let shape = present.shape(&sample.shape);
        let gradients = gradients_with_inner(table, &shape, places, (count, present.inner))?;
        let volume = sample.weight * gradients.jacobian;
        let law = material.law(&shape, places, own);
        strains.clear();
        for slope in gradients.slope.iter().take(count) {
            strains.extend([0, 1, 2].map(|axis| strain_of(*slope, axis)));
        }
        let stresses: Vec<Components> = (strains.iter())
            .map(|strain| law.stress(strain).map(|x| volume * x))
            .collect();
        add_products(&strains, &stresses, blocks);
    }
    Ok(())
}

/// Adds the work of stresses on strains to the blocks of the nodes, each of which has three of both.
pub(super) fn add_products(strains: &[Components], stresses: &[Components], blocks: &mut [f64]) {
    for b in 0..stresses.len() / 3 {
        for a in 0..=b {
            let block = &mut blocks[PAIR * pair(a, b)..][..9];
            for (i, line) in block.chunks_exact_mut(3).enumerate() {
                for (j, x) in line.iter_mut().enumerate() {
                    *x += dot(&strains[3 * a + i], &stresses[3 * b + j]);
                }
            }
        }
    }
}

/// Adds the mass ∫ N_a N_b dm, given the values and the mass dm (kg) of each sample, in the table's form.
/// With a diagonal mass, inner nodes have none. They do not move in a rigid motion, so their share would be
/// missing at the other nodes.
pub(super) fn add_mass(
    table: &Table,
    (count, inner): (usize, usize),
    mut sampled: impl FnMut(&Sample) -> ([f64; MOST_NODES], f64),
    blocks: &mut [f64],
) {
    let mut total = 0.0;
    for sample in &table.mass {
        let (values, mass) = sampled(sample);
        total += mass;
        for b in 0..count {
            let second = mass * values[b];
            for a in 0..=b {
                blocks[PAIR * pair(a, b) + 9] += values[a] * second;
            }
        }
    }
    if table.spread == Spread::Consistent {
        return;
    }
    let count = count - inner;
    let mut diagonal = [0.0; MOST_NODES];
    let entry = |a: usize, b: usize| PAIR * pair(a.min(b), a.max(b)) + 9;
    for (a, sum) in diagonal.iter_mut().enumerate().take(count) {
        *sum = match table.spread {
            Spread::Equal => total / count as f64,
            Spread::RowSum => (0..count).map(|b| blocks[entry(a, b)]).sum(),
            _ => blocks[entry(a, a)],
        };
    }
    if table.spread == Spread::ScaledDiagonal {
        let sum: f64 = diagonal.iter().sum();
        for x in diagonal.iter_mut() {
            *x *= total / sum;
        }
    }
    for block in blocks.chunks_exact_mut(PAIR) {
        block[9] = 0.0;
    }
    for (a, mass) in diagonal.iter().enumerate().take(count) {
        blocks[entry(a, a)] = *mass;
    }
}

/// The error for inverted or flat elements, with their ids and Jacobians (m³).
pub(super) fn inverted(faults: &[(u64, f64)]) -> FlexibleError {
    FlexibleError::structure(
        format!(
            "{} inverted or degenerate: {}",
            match faults.len() {
                1 => "1 element is".to_owned(),
                count => format!("{count} elements are"),
            },
            super::check::list(faults.iter().map(|(id, jacobian)| format!(
                "element {id} (Jacobian {} m³)",
                short(*jacobian, 4)
            )))
        ),
        "repair the mesh; if all elements are inverted, their nodes have the order of another program",
    )
}
