//! Constraint rows of single elements as dense numbers, for assembly and rank.

use crate::chain::{self, MarkerKinematics};
use crate::elements;
use crate::error::RuntimeError;
use crate::model::Model;
use eng_system::code::{Function, Pair};
use eng_system::layout::InputLayout;
use nalgebra::{DMatrix, DVector};

/// Which derivative of the rows is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Poses: δr inertial, δπ in body axes.
    Pose,
    /// Velocities.
    Velocity,
}

/// A list of rows: elements in order, all rows of each.
#[derive(Clone, Debug)]
pub struct Rows {
    /// The elements.
    pub elements: Vec<usize>,
    /// (element, row) of each row.
    pub owners: Vec<(usize, usize)>,
    /// Scale of each row.
    pub scales: Vec<f64>,
}

/// The pose of the whole model at rest or in motion.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Time (s).
    pub time: f64,
    /// Pose numbers.
    pub pose: &'a [f64],
    /// Velocities.
    pub velocity: &'a [f64],
    /// Start values of states.
    pub states: &'a [f64],
    /// Rotation references.
    pub rotations: &'a [f64],
}

impl Rows {
    /// Rows of elements.
    pub fn new(model: &Model, elements: Vec<usize>) -> Rows {
        let mut owners = Vec::new();
        let mut scales = Vec::new();
        for e in &elements {
            for row in 0..model.class(*e).rows.len() {
                owners.push((*e, row));
                scales.push(model.row_scale(*e, row));
            }
        }
        Rows {
            elements,
            owners,
            scales,
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.owners.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.owners.is_empty()
    }

    /// Values of the rows, and their derivatives by all velocities of the model (rows × velocities).
    pub fn evaluate(
        &self,
        model: &Model,
        at: &At,
        along: Along,
    ) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let mut values = DVector::zeros(self.len());
        let mut matrix = DMatrix::zeros(self.len(), model.velocities);
        let mut first = 0;
        for element in &self.elements {
            let rows = model.class(*element).rows.len();
            if rows == 0 {
                continue;
            }
            let inputs = inputs(model, *element, at);
            let class = &model.compiled.system.classes[model.elements[*element].class];
            let layout = &class.layout;
            let length = layout.residual_len() as usize;
            let mut out = vec![[0.0; 2]; length];
            elements::call(
                model,
                model.elements[*element].class,
                Function::Residual,
                &inputs,
                &mut out,
            )?;
            for i in 0..rows {
                values[first + i] = out[i][0];
            }
            let tape = class.tape as usize;
            let mut work = vec![[0.0; 2]; tape + layout.directions() as usize];
            elements::call(
                model,
                model.elements[*element].class,
                Function::Linearize,
                &inputs,
                &mut work[..tape],
            )?;
            for (k, marker) in model.elements[*element].markers.iter().enumerate() {
                let Some(b) = model.markers[*marker].body else {
                    continue;
                };
                let body = &model.bodies[b];
                let width = body.width();
                let frame = body.frame(at.pose);
                let mut jacobian = vec![0.0; 6 * width];
                chain::jacobian(body, &frame, &model.markers[*marker], &mut jacobian);
                let base = match along {
                    Along::Pose => layout.pose_direction(k as u32),
                    Along::Velocity => layout.twist_direction(k as u32),
                } as usize;
                for d in 0..6 {
                    work[tape + base + d] = [1.0; 2];
                    elements::call(
                        model,
                        model.elements[*element].class,
                        Function::Tangent,
                        &work,
                        &mut out,
                    )?;
                    work[tape + base + d] = [0.0; 2];
                    for i in 0..rows {
                        for w in 0..width {
                            matrix[(first + i, body.velocity + w)] +=
                                out[i][0] * jacobian[d * width + w];
                        }
                    }
                }
            }
            first += rows;
        }
        Ok((values, matrix))
    }

    /// Φ̇ of the rows at the given velocities.
    pub fn rates(&self, model: &Model, at: &At) -> Result<DVector<f64>, RuntimeError> {
        let mut values = DVector::zeros(self.len());
        let mut first = 0;
        for element in &self.elements {
            let rows = model.class(*element).rows.len();
            if rows == 0 {
                continue;
            }
            let mut out = vec![[0.0; 2]; 2 * rows];
            elements::call(
                model,
                model.elements[*element].class,
                Function::Velocity,
                &inputs(model, *element, at),
                &mut out,
            )?;
            for i in 0..rows {
                values[first + i] = out[i][0];
            }
            first += rows;
        }
        Ok(values)
    }

    /// Divides values and rows by the rows' scales, and translations' columns by 1/length: everything in angles.
    pub fn scale(&self, model: &Model, values: &mut DVector<f64>, matrix: &mut DMatrix<f64>) {
        let columns = model.velocity_scales();
        for (i, scale) in self.scales.iter().enumerate() {
            values[i] /= scale;
            for j in 0..model.velocities {
                matrix[(i, j)] *= columns[j] / scale;
            }
        }
    }
}

/// Kinematics of a marker at a state.
pub fn marker(model: &Model, index: usize, pose: &[f64], velocity: &[f64]) -> MarkerKinematics {
    let marker = &model.markers[index];
    match marker.body {
        None => chain::ground(marker),
        Some(b) => {
            let body = &model.bodies[b];
            chain::kinematics(&body.frame(pose), marker, &velocity[body.velocity..])
        }
    }
}

/// Common inputs of one element in both lanes, multipliers zero.
pub fn inputs(model: &Model, index: usize, at: &At) -> Vec<Pair> {
    let element = &model.elements[index];
    let layout = model.compiled.system.classes[element.class].layout;
    let mut inputs = vec![[0.0; 2]; layout.len() as usize];
    inputs[InputLayout::TIME as usize] = [at.time; 2];
    for (k, m) in element.markers.iter().enumerate() {
        let m = marker(model, *m, at.pose, at.velocity);
        let first = layout.marker(k as u32) as usize;
        for i in 0..3 {
            inputs[first + i] = [m.position[i]; 2];
            for j in 0..3 {
                inputs[first + 3 + 3 * i + j] = [m.rotation[(i, j)]; 2];
            }
            inputs[first + 12 + i] = [m.velocity[i]; 2];
            inputs[first + 15 + i] = [m.angular_velocity[i]; 2];
        }
    }
    for k in 0..layout.states {
        inputs[layout.state(k) as usize] = [at.states[element.state + k as usize]; 2];
    }
    for k in 0..layout.rotations {
        inputs[layout.rotation(k) as usize] = [at.rotations[element.rotation + k as usize]; 2];
    }
    for (k, constant) in element.constants.iter().enumerate() {
        inputs[layout.constant(k as u32) as usize] = [*constant; 2];
    }
    inputs
}

/// Values of an element's conditions.
pub fn conditions(model: &Model, index: usize, at: &At) -> Result<Vec<f64>, RuntimeError> {
    let count = model.class(index).conditions.len();
    if count == 0 {
        return Ok(Vec::new());
    }
    let mut out = vec![[0.0; 2]; count];
    elements::call(
        model,
        model.elements[index].class,
        Function::Conditions,
        &inputs(model, index, at),
        &mut out,
    )?;
    Ok(out.iter().map(|o| o[0]).collect())
}

/// The smallest solution x of `A x = b` in the least-squares sense; singular values below 1e-9 of the largest count as zero.
pub fn smallest_solution(matrix: &DMatrix<f64>, rhs: &DVector<f64>) -> Option<DVector<f64>> {
    if matrix.nrows() == 0 || matrix.ncols() == 0 {
        return Some(DVector::zeros(matrix.ncols()));
    }
    if matrix.iter().chain(rhs.iter()).any(|x| !x.is_finite()) {
        return None;
    }
    let svd = matrix.clone().try_svd(true, true, f64::EPSILON, 10_000)?;
    let threshold = 1e-9 * svd.singular_values.amax();
    svd.solve(rhs, threshold.max(f64::MIN_POSITIVE)).ok()
}
