//! Three-dimensional Timoshenko beams: stiffness from the flexibility of a cantilever, mass from the
//! displacements that the stiffness' own deformation gives.
//!
//! Element axes: x from the first end to the second (offsets included), y in the plane of x and the
//! orientation vector, z = x × y. A section at (y, z) moves by u_x = u + z θ_y − y θ_z; section forces and
//! strains are
//!
//! ```text
//! N = EA u'    T = GJ θ_x'    V_y = k_y GA (v' − θ_z)    V_z = k_z GA (w' + θ_y)
//! ⎡M_y⎤     ⎡ I_y  −I_yz⎤ ⎡θ_y'⎤
//! ⎣M_z⎦ = E ⎣−I_yz  I_z ⎦ ⎣θ_z'⎦      I_y = ∫ z² dA, I_z = ∫ y² dA, I_yz = ∫ y z dA
//! ```
//!
//! (J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, ch. 5 and 11, is the case without a
//! product of moments). The ends lie at the shear centre. Where the centroid is beside it, N and the moments
//! are those about the centroid. Where a section changes along the beam, its constants are linear between
//! stations, and the flexibilities are integrated over the intervals between them. With a shear factor of
//! zero the section does not shear. A section without a second moment carries no bending in that plane, and
//! one without a torsion constant carries no torque: rods and cables.

use super::vector::{add, cross, norm, scale, subtract};
use crate::element::quadrature::unit_interval;
use crate::mesh::{BeamAxes, BeamSection, Material, Station, section_at};

/// A matrix over the twelve freedoms of two ends.
pub type EndMatrix = [[f64; 12]; 12];

/// Stiffness and mass over the nodes' twelve freedoms (translations and rotations of the first node, then of
/// the second) in basic axes (N/m, N, N m; kg, kg m, kg m²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamMatrices {
    /// Stiffness.
    pub stiffness: EndMatrix,
    /// Mass: consistent with the rotary inertia of the sections, or lumped.
    pub mass: EndMatrix,
}

/// Freedoms of an end that bending moves: v, w, θ_y, θ_z.
const BENDING: [usize; 4] = [1, 2, 4, 5];

/// The constants of a section.
#[derive(Clone, Copy)]
struct Constants {
    /// EA (N) and GJ (N m²).
    axial: f64,
    torsional: f64,
    /// Section flexibilities 1/(k GA) (1/N) for y and z.
    shear: [f64; 2],
    /// Inverse of the bending stiffness for (M_y, M_z) (1/(N m²)); zero for a section without it.
    bending: [[f64; 2]; 2],
    /// Mass per length (kg/m), and inertia of the section per length about y and z, with their product (kg
    /// m).
    mass: f64,
    inertia: [[f64; 2]; 2],
}

impl Constants {
    fn new(section: &BeamSection, material: &Material) -> Self {
        let BeamSection {
            area,
            moment_z,
            moment_y,
            product,
            torsion,
            shear,
            mass_per_length,
        } = *section;
        let modulus = material.young / (2.0 * (1.0 + material.poisson));
        let inverse = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
        let bending = if product == 0.0 {
            [
                [inverse(material.young * moment_y), 0.0],
                [0.0, inverse(material.young * moment_z)],
            ]
        } else {
            let determinant = material.young * (moment_y * moment_z - product * product);
            [
                [moment_z / determinant, product / determinant],
                [product / determinant, moment_y / determinant],
            ]
        };
        Constants {
            axial: material.young * area,
            torsional: modulus * torsion,
            shear: shear.map(|factor| inverse(factor * modulus * area)),
            bending,
            mass: material.density * area + mass_per_length,
            inertia: [
                [material.density * moment_y, -material.density * product],
                [-material.density * product, material.density * moment_z],
            ],
        }
    }
}

/// A beam along its axis.
#[derive(Clone)]
struct Beam<'a> {
    length: f64,
    /// Its sections, by ascending place; one of a uniform beam.
    stations: &'a [Station],
    material: &'a Material,
    /// The freedoms among v, w, θ_y, θ_z that bending couples.
    active: [bool; 4],
    /// From the line of the ends, which is that of the shear centres, to the centroids along y and z (m).
    centroid: [f64; 2],
}

/// Points for each interval of a tapered beam in which no constant changes by more than half. A flexibility is one over a
/// linear constant, whose zero is then at least an interval away: the error of n points is below 5.8⁻²ⁿ.
const TAPER_POINTS: usize = 8;

/// The shares of the way between two stations between which no constant changes by more than half.
fn intervals(a: &BeamSection, b: &BeamSection) -> Vec<f64> {
    let constants = |own: &BeamSection| [own.area, own.moment_z, own.moment_y, own.torsion];
    let (mut down, mut up) = (1.0_f64, 1.0_f64);
    for (a, b) in constants(a).into_iter().zip(constants(b)) {
        if a > 0.0 && b > 0.0 {
            down = down.max(a / b);
            up = up.max(b / a);
        }
    }
    // halves of the way to the end with the smaller constant
    let halves = |ratio: f64| {
        let (mut shares, mut left) = (Vec::new(), ratio);
        // a choice: 60 halves are a ratio of 1e18, a beam that ends in a point
        while left > 1.0 && shares.len() < 60 {
            shares.push(shares.last().map_or(0.5, |share| 0.5 * share));
            left *= 0.5;
        }
        shares
    };
    let mut shares = vec![0.0, 1.0];
    shares.extend(halves(down).into_iter().map(|share| 1.0 - share));
    shares.extend(halves(up));
    shares.sort_by(f64::total_cmp);
    shares.dedup();
    shares
}

impl<'a> Beam<'a> {
    fn new(
        length: f64,
        stations: &'a [Station],
        material: &'a Material,
        centroid: [f64; 2],
    ) -> Option<Self> {
        let first = &stations.first()?.section;
        let (about_y, about_z) = (first.moment_y > 0.0, first.moment_z > 0.0);
        Some(Beam {
            length,
            stations,
            material,
            active: [about_z, about_y, about_y, about_z],
            centroid,
        })
    }

    /// The constants of the section at a distance from the first end.
    fn constants(&self, s: f64) -> Constants {
        let share = s / self.length;
        Constants::new(&section_at(self.stations, share), self.material)
    }

    /// The points and weights of an integral from the first end to a distance `to` from it, with the
    /// constants there. `uniform` is the number of points of a uniform beam.
    fn points(&self, to: f64, uniform: usize) -> Vec<(f64, f64, Constants)> {
        let rule = |from: f64, to: f64, count: usize| {
            let points = unit_interval(count).into_iter();
            points.map(move |(t, weight)| (from + t * (to - from), weight * (to - from)))
        };
        if self.stations.len() < 2 {
            let same = self.constants(0.0);
            return rule(0.0, to, uniform)
                .map(|(at, weight)| (at, weight, same))
                .collect();
        }
        let mut points = Vec::new();
        for pair in self.stations.windows(2) {
            let [a, b] = [0, 1].map(|i: usize| pair[i].place);
            let shares = intervals(&pair[0].section, &pair[1].section);
            for ends in shares.windows(2) {
                let [from, until] = [0, 1].map(|i: usize| (a + ends[i] * (b - a)) * self.length);
                if from < to {
                    points.extend(rule(from, until.min(to), TAPER_POINTS));
                }
            }
        }
        points
            .into_iter()
            .map(|(at, weight)| (at, weight, self.constants(at)))
            .collect()
    }

    /// Flexibilities in tension and torsion from the first end to a distance: ∫ dx/(EA), ∫ dx/(GJ); zero
    /// torsion for a section without it. `to` in m; the results in m/N and rad/(N m).
    fn flexibility(&self, to: f64) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (_, weight, own) in self.points(to, 1) {
            for (sum, stiffness) in sums.iter_mut().zip([own.axial, own.torsional]) {
                *sum += if stiffness > 0.0 {
                    weight / stiffness
                } else {
                    0.0
                };
            }
        }
        sums
    }

    /// Displacement (v, w, θ_y, θ_z) at `s` of a cantilever clamped at the first end, for a unit of each
    /// force (F_y, F_z, M_y, M_z) at the second end: columns are the forces.
    fn cantilever(&self, s: f64) -> [[f64; 4]; 4] {
        let mut displacement = [[0.0; 4]; 4];
        // the integrands of a uniform beam are quadratic: two points are exact
        for (at, weight, own) in self.points(s, 2) {
            let arm = self.length - at;
            // section forces V_y, V_z, M_y, M_z: M = M_B + (L − s) e_x × F
            let moments = [[0.0, -arm, 1.0, 0.0], [arm, 0.0, 0.0, 1.0]];
            for force in 0..4 {
                let (my, mz) = (moments[0][force], moments[1][force]);
                let curvature_y = own.bending[0][0] * my + own.bending[0][1] * mz;
                let curvature_z = own.bending[1][0] * my + own.bending[1][1] * mz;
                let shear = |axis: usize| if force == axis { own.shear[axis] } else { 0.0 };
                let rest = s - at;
                displacement[0][force] += weight * (shear(0) + curvature_z * rest);
                displacement[1][force] += weight * (shear(1) - curvature_y * rest);
                displacement[2][force] += weight * curvature_y;
                displacement[3][force] += weight * curvature_z;
            }
        }
        displacement
    }

    /// Forces (F_y, F_z, M_y, M_z) at the second end for unit displacements of this end, with the first end
    /// clamped.
    fn end_stiffness(&self) -> [[f64; 4]; 4] {
        let flexibility = self.cantilever(self.length);
        let index: Vec<usize> = (0..4).filter(|i| self.active[*i]).collect();
        // Gauss–Jordan without pivoting: the matrix is positive definite
        let n = index.len();
        let mut work = [[0.0; 8]; 4];
        for (i, &row) in index.iter().enumerate() {
            for (j, &column) in index.iter().enumerate() {
                work[i][j] = 0.5 * (flexibility[row][column] + flexibility[column][row]);
            }
            work[i][4 + i] = 1.0;
        }
        for pivot in 0..n {
            let divisor = work[pivot][pivot];
            let line = work[pivot].map(|x| x / divisor);
            work[pivot] = line;
            for (row, values) in work.iter_mut().enumerate().take(n) {
                let factor = values[pivot];
                if row != pivot {
                    for (x, y) in values.iter_mut().zip(line) {
                        *x -= factor * y;
                    }
                }
            }
        }
        let mut stiffness = [[0.0; 4]; 4];
        for (i, &row) in index.iter().enumerate() {
            for (j, &column) in index.iter().enumerate() {
                stiffness[row][column] = 0.5 * (work[i][4 + j] + work[j][4 + i]);
            }
        }
        stiffness
    }

    /// The rigid motion of the bending freedoms at distance `s` from the first end: v += s θ_z, w −= s θ_y.
    /// `s` in m; rotations in rad. Shape: 4 × 4 over (v, w, θ_y, θ_z).
    fn transfer(s: f64) -> [[f64; 4]; 4] {
        [
            [1.0, 0.0, 0.0, s],
            [0.0, 1.0, -s, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]
    }

    /// Deformation of the second end against the first: 4 × 8 over (v, w, θ_y, θ_z) of both. In m and rad.
    fn deformation(&self) -> [[f64; 8]; 4] {
        let rigid = Self::transfer(self.length);
        let mut deformation = [[0.0; 8]; 4];
        for (i, row) in deformation.iter_mut().enumerate() {
            for j in 0..4 {
                row[j] = -rigid[i][j];
            }
            row[4 + i] = 1.0;
        }
        deformation
    }

    fn stiffness(&self) -> EndMatrix {
        let end = self.end_stiffness();
        let deformation = self.deformation();
        let mut stiffness = [[0.0; 12]; 12];
        for i in 0..8 {
            for j in 0..8 {
                let mut sum = 0.0;
                for k in 0..4 {
                    for l in 0..4 {
                        sum += deformation[k][i] * end[k][l] * deformation[l][j];
                    }
                }
                stiffness[bending(i)][bending(j)] = sum;
            }
        }
        let inverse = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
        let [axial, torsional] = self.flexibility(self.length).map(inverse);
        for (freedom, value) in [(0, axial), (3, torsional)] {
            stiffness[freedom][freedom] = value;
            stiffness[freedom + 6][freedom + 6] = value;
            stiffness[freedom][freedom + 6] = -value;
            stiffness[freedom + 6][freedom] = -value;
        }
        self.of_neutral_axis(stiffness, false)
    }

    /// Transforms a matrix whose displacement u is that of the centroid, `u + z θ_y − y θ_z`, to the freedoms
    /// of the ends. With `across` its v and w are also those of the centroid, `v − z θ_x` and `w + y θ_x`.
    /// Shear and torque act in the line of the ends, axial force and moments in the line of the centroids.
    fn of_neutral_axis(&self, matrix: EndMatrix, across: bool) -> EndMatrix {
        let [y, z] = self.centroid;
        if y == 0.0 && z == 0.0 {
            return matrix;
        }
        let mut shift = [[0.0; 12]; 12];
        for (i, row) in shift.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        for end in [0, 6] {
            shift[end][end + 4] = z;
            shift[end][end + 5] = -y;
            if across {
                shift[end + 1][end + 3] = -z;
                shift[end + 2][end + 3] = y;
            }
        }
        turned(&matrix, &shift)
    }

    /// Displacements and rotations of the section at `s`: 6 × 12.
    fn section_shape(&self, s: f64, force: &[[f64; 8]; 4]) -> [[f64; 12]; 6] {
        let mut shape = [[0.0; 12]; 6];
        let share = s / self.length;
        let (own, whole) = (self.flexibility(s), self.flexibility(self.length));
        for (freedom, (own, whole)) in [0, 3].into_iter().zip(own.into_iter().zip(whole)) {
            let share = if whole > 0.0 { own / whole } else { share };
            shape[freedom][freedom] = 1.0 - share;
            shape[freedom][freedom + 6] = share;
        }
        let (rigid, cantilever) = (Self::transfer(s), self.cantilever(s));
        for i in 0..4 {
            if !self.active[i] {
                // nothing bends here: the ends' translations share the mass between them
                if i < 2 {
                    shape[BENDING[i]][BENDING[i]] = 1.0 - share;
                    shape[BENDING[i]][BENDING[i] + 6] = share;
                }
                continue;
            }
            for j in 0..8 {
                let mut sum = if j < 4 { rigid[i][j] } else { 0.0 };
                for k in 0..4 {
                    sum += cantilever[i][k] * force[k][j];
                }
                shape[BENDING[i]][bending(j)] = sum;
            }
        }
        shape
    }

    /// Forces (F_y, F_z, M_y, M_z) at the second end for a unit of each bending freedom of both ends: 4 × 8.
    fn end_forces(&self) -> [[f64; 8]; 4] {
        let (end, deformation) = (self.end_stiffness(), self.deformation());
        let mut force = [[0.0; 8]; 4];
        for (row, line) in force.iter_mut().enumerate() {
            for (column, x) in line.iter_mut().enumerate() {
                *x = (0..4).map(|k| end[row][k] * deformation[k][column]).sum();
            }
        }
        force
    }

    /// The consistent mass, with the rotary inertia of the sections or without.
    fn mass(&self, rotary: bool) -> EndMatrix {
        let force = self.end_forces();
        let mut mass = [[0.0; 12]; 12];
        // cubic displacements of a uniform beam: products of degree 6, exact with four points
        for (at, weight, own) in self.points(self.length, 4) {
            let mut shape = self.section_shape(at, &force);
            let (turn, [y, z]) = (shape[3], self.centroid);
            for (i, turn) in turn.into_iter().enumerate() {
                shape[1][i] -= z * turn;
                shape[2][i] += y * turn;
            }
            for (i, row) in mass.iter_mut().enumerate() {
                for (j, x) in row.iter_mut().enumerate() {
                    let translation: f64 = (0..3).map(|k| shape[k][i] * shape[k][j]).sum();
                    if !rotary {
                        *x += weight * own.mass * translation;
                        continue;
                    }
                    let mut sum = own.mass * translation
                        + (own.inertia[0][0] + own.inertia[1][1]) * shape[3][i] * shape[3][j];
                    for k in 0..2 {
                        for l in 0..2 {
                            sum += shape[4 + k][i] * own.inertia[k][l] * shape[4 + l][j];
                        }
                    }
                    *x += weight * sum;
                }
            }
        }
        self.of_neutral_axis(mass, false)
    }
}

impl Beam<'_> {
    /// Coupled mass of Nastran's `CBAR`: the consistent one without rotary inertia of the sections, about all three axes,
    /// and along the axis the mean of the lumped and the consistent one, ρ A L (5/12, 1/12) (MSC Nastran, Basic Dynamic
    /// Analysis User's Guide, ch. 2). A rod has the consistent one.
    fn coupled(&self) -> EndMatrix {
        if self.active == [false; 4] {
            return self.mass(true);
        }
        let mut mass = self.mass(false);
        let whole = self.constants(0.0).mass * self.length;
        for (i, j) in [(0, 6), (6, 0)] {
            mass[i][i] = whole * 5.0 / 12.0;
            mass[i][j] = whole / 12.0;
        }
        mass
    }

    /// Lumped mass of Nastran: half of the mass at each end (MSC Nastran, Basic Dynamic Analysis User's Guide;
    /// MYSTRAN `BREL1.f90`), and half of the inertia ρ (I_y + I_z) L (kg m²) about the axis if it `turns`.
    fn lumped(&self, turns: bool) -> EndMatrix {
        let mut mass = [[0.0; 12]; 12];
        let own = self.constants(0.0);
        for end in [0, 6] {
            for axis in 0..3 {
                mass[end + axis][end + axis] = 0.5 * own.mass * self.length;
            }
            if turns {
                mass[end + 3][end + 3] =
                    0.5 * (own.inertia[0][0] + own.inertia[1][1]) * self.length;
            }
        }
        self.of_neutral_axis(mass, true)
    }

    /// Geometric stiffness per unit of tension (1/m, –, m): `∫ v'v'ᵀ + w'w'ᵀ + (I_y + I_z)/A θ_x'θ_x'ᵀ dx`
    /// with the slopes of the stiffness' own deformation, v' = θ_z + V_y/(k_y GA) and w' = −θ_y + V_z/(k_z
    /// GA) (Przemieniecki, ch. 15; the last term is H. Wagner's, of the fibres that a turn inclines). Shear
    /// forces and moments at rest add nothing here.
    fn tension(&self) -> EndMatrix {
        let force = self.end_forces();
        let shear = self.constants(0.0).shear;
        let mut matrix = [[0.0; 12]; 12];
        // quadratic slopes: products of degree 4, exact with three points
        for (t, weight) in unit_interval(3) {
            let shape = self.section_shape(t * self.length, &force);
            let weight = weight * self.length;
            let mut slopes = [[0.0; 12]; 2];
            for (axis, slope) in slopes.iter_mut().enumerate() {
                if self.active[axis] {
                    let turn = if axis == 0 { (5, 1.0) } else { (4, -1.0) };
                    for (x, theta) in slope.iter_mut().zip(&shape[turn.0]) {
                        *x = turn.1 * theta;
                    }
                    for (j, f) in force[axis].iter().enumerate() {
                        slope[bending(j)] += shear[axis] * f;
                    }
                } else {
                    slope[BENDING[axis]] = -1.0 / self.length;
                    slope[BENDING[axis] + 6] = 1.0 / self.length;
                }
            }
            for (i, row) in matrix.iter_mut().enumerate() {
                for (j, x) in row.iter_mut().enumerate() {
                    *x += weight * (slopes[0][i] * slopes[0][j] + slopes[1][i] * slopes[1][j]);
                }
            }
        }
        let section = section_at(self.stations, 0.0);
        let twist = (section.moment_y + section.moment_z) / section.area / self.length;
        for (i, j, sign) in [(3, 3, 1.0), (9, 9, 1.0), (3, 9, -1.0), (9, 3, -1.0)] {
            matrix[i][j] += sign * twist;
        }
        matrix
    }
}

/// Index among the twelve freedoms of both ends of their bending freedom 0…7.
fn bending(index: usize) -> usize {
    6 * (index / 4) + BENDING[index % 4]
}

/// Stiffness and a second matrix over the same freedoms: mass or geometric stiffness. Where an end is
/// released, the second matrix is condensed by the stiffness.
struct Pair {
    stiffness: EndMatrix,
    other: EndMatrix,
}

/// Releases a freedom of an end: no force passes through it, so it follows the others, K ← K − k kᵀ/K_rr and
/// M ← Tᵀ M T with the same T, also for the geometric matrix (static condensation, R. J. Guyan, AIAA J. 3,
/// 1965). r is the freedom, k its column of K, and `whole` is K_rr before any release.
///
/// # Errors
/// In words, if other releases have removed its stiffness: K_rr is rounding of `whole`.
fn release(matrices: &mut Pair, freedom: usize, whole: f64) -> Result<(), String> {
    let row = matrices.stiffness[freedom];
    let pivot = row[freedom];
    // a choice above the rounding of the differences by other releases
    if pivot <= 1e-12 * whole {
        // the freedom had no stiffness, or the other releases removed it
        return if whole == 0.0 {
            Ok(())
        } else {
            Err("its released freedoms make it a mechanism".into())
        };
    }
    let mut follow = row.map(|x| -x / pivot);
    follow[freedom] = 0.0;
    for i in 0..12 {
        for j in 0..12 {
            matrices.stiffness[i][j] -= row[i] * row[j] / pivot;
        }
    }
    for i in 0..12 {
        matrices.stiffness[i][freedom] = 0.0;
        matrices.stiffness[freedom][i] = 0.0;
    }
    let old = matrices.other;
    for i in 0..12 {
        for j in 0..12 {
            matrices.other[i][j] = if i == freedom || j == freedom {
                0.0
            } else {
                old[i][j]
                    + follow[i] * old[freedom][j]
                    + old[i][freedom] * follow[j]
                    + follow[i] * old[freedom][freedom] * follow[j]
            };
        }
    }
    Ok(())
}

/// The stiffness and a second matrix of a beam in element axes, and the transformation to them from the
/// nodes' freedoms in basic axes.
fn placed(
    positions: [[f64; 3]; 2],
    axes: &BeamAxes,
    stations: &[Station],
    material: &Material,
    other: impl Fn(&Beam) -> EndMatrix,
) -> Result<(Pair, EndMatrix), String> {
    let ends = [
        add(positions[0], axes.offsets[0]),
        add(positions[1], axes.offsets[1]),
    ];
    let along = subtract(ends[1], ends[0]);
    let length = norm(along);
    if !(length > 0.0 && length.is_finite()) {
        return Err(format!(
            "both of its ends, with their offsets, are at {:?}",
            ends[0]
        ));
    }
    let x = scale(1.0 / length, along);
    let normal = cross(x, axes.orientation);
    let across = norm(normal);
    // a choice: files with six or seven digits that mean a vector along the beam have less
    if across <= 1e-6 * norm(axes.orientation) {
        return Err("its orientation vector is zero or along the beam".into());
    }
    let z = scale(1.0 / across, normal);
    let frame = [x, cross(z, x), z];
    let beam = Beam::new(length, stations, material, axes.centroid)
        .ok_or("its section is no beam section")?;
    let mut local = Pair {
        stiffness: beam.stiffness(),
        other: other(&beam),
    };
    let whole: [f64; 12] = std::array::from_fn(|i| local.stiffness[i][i]);
    for (end, released) in axes.released.into_iter().enumerate() {
        for component in 0..6 {
            if released >> component & 1 == 1 {
                let freedom = 6 * end + component;
                release(&mut local, freedom, whole[freedom])?;
            }
        }
    }
    // end freedoms in element axes from node freedoms in basic ones: e·(u + θ × o) = e·u + (o × e)·θ
    let mut transformation = [[0.0; 12]; 12];
    for (end, offset) in axes.offsets.into_iter().enumerate() {
        for (i, axis) in frame.into_iter().enumerate() {
            let arm = cross(offset, axis);
            for k in 0..3 {
                transformation[6 * end + i][6 * end + k] = axis[k];
                transformation[6 * end + i][6 * end + 3 + k] = arm[k];
                transformation[6 * end + 3 + i][6 * end + 3 + k] = axis[k];
            }
        }
    }
    Ok((local, transformation))
}

/// The mass of a beam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeamMass {
    /// From the displacements between the ends, with the rotary inertia of the sections.
    Consistent,
    /// That of Nastran's `CBAR` with `PARAM,COUPMASS`.
    Coupled,
    /// Half of it at each end; with half of the inertia about the axis if it turns.
    Lumped {
        /// Whether there is inertia about the axis.
        turns: bool,
    },
}

/// Stiffness and mass of a beam between two nodes, with the sections at its stations.
///
/// # Errors
/// In words: no length, an orientation along the beam, releases that leave a mechanism, a section that isn't
/// a beam's.
pub fn matrices(
    positions: [[f64; 3]; 2],
    axes: &BeamAxes,
    stations: &[Station],
    material: &Material,
    mass: BeamMass,
) -> Result<BeamMatrices, String> {
    let mass = |beam: &Beam| match mass {
        BeamMass::Consistent => beam.mass(true),
        BeamMass::Coupled => beam.coupled(),
        BeamMass::Lumped { turns } => beam.lumped(turns),
    };
    let (local, transformation) = placed(positions, axes, stations, material, mass)?;
    Ok(BeamMatrices {
        stiffness: turned(&local.stiffness, &transformation),
        mass: turned(&local.other, &transformation),
    })
}

/// The effect of a beam's tension, over the nodes' twelve freedoms in basic axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamTension {
    /// Mean tension (N) per unit of each freedom.
    pub tension: [f64; 12],
    /// Geometric stiffness per unit of tension (1/m, –, m).
    pub stiffness: EndMatrix,
}

/// Tension and geometric stiffness of a beam between two nodes.
///
/// # Errors
/// As [`matrices`].
pub fn tension(
    positions: [[f64; 3]; 2],
    axes: &BeamAxes,
    stations: &[Station],
    material: &Material,
) -> Result<BeamTension, String> {
    if stations.len() > 1 {
        return Err(
            "its geometric stiffness is not computed, because its section changes along it".into(),
        );
    }
    if axes.centroid != [0.0; 2] {
        return Err("its geometric stiffness is not computed, because its centroid is beside its shear centre".into());
    }
    let (local, transformation) = placed(positions, axes, stations, material, |beam: &Beam| {
        beam.tension()
    })?;
    let mut tension = [0.0; 12];
    for (force, line) in local.stiffness[6].iter().zip(&transformation) {
        for (sum, x) in tension.iter_mut().zip(line) {
            *sum += force * x;
        }
    }
    Ok(BeamTension {
        tension,
        stiffness: turned(&local.other, &transformation),
    })
}

/// Tᵀ A T, symmetric to the bit.
fn turned(matrix: &EndMatrix, transformation: &EndMatrix) -> EndMatrix {
    let mut half = [[0.0; 12]; 12];
    for (i, row) in half.iter_mut().enumerate() {
        for (j, x) in row.iter_mut().enumerate() {
            *x = (0..12).map(|k| matrix[i][k] * transformation[k][j]).sum();
        }
    }
    let mut result = [[0.0; 12]; 12];
    for i in 0..12 {
        for j in 0..=i {
            let sum: f64 = (0..12).map(|k| transformation[k][i] * half[k][j]).sum();
            result[i][j] = sum;
            result[j][i] = sum;
        }
    }
    result
}
