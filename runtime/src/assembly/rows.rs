//! Constraint rows of single elements as dense numbers, for assembly and rank.

use super::gradients::Gradients;
use super::independent;
use crate::chain::{self, MarkerKinematics};
use crate::elements;
use crate::error::RuntimeError;
use crate::model::{Model, TOLERANCE_OF_LENGTH};
use crate::rotation::{M3, V3};
use eng_system::code::{Function, Pair};
use eng_system::dense::add_scaled;
use eng_system::layout::InputLayout;
use eng_system::system::Role;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// The kind of derivative of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Poses: δr inertial, δπ in body axes.
    Pose,
    /// Velocities.
    Velocity,
}

/// A preference of the assembly, which the motion does not contain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preference {
    /// Element that has the preference.
    pub element: usize,
    /// Marker of the pin or of the turning body.
    pub pin: usize,
    /// Marker of the shell, or of the reference; its z is the axis.
    pub shell: usize,
    /// The preferred relation of both.
    pub relation: Relation,
}

/// A relation of two markers that the assembly prefers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relation {
    /// The pin's origin is on the shell's axis, and both axes are parallel, in either sense.
    Inside {
        /// Distance from the axis up to which the preference counts as fulfilled (m).
        reach: f64,
    },
    /// The pin's origin is at a height above the shell's xy plane.
    Above {
        /// The height (m).
        height: f64,
        /// Distance from the height up to which the preference counts as fulfilled (m).
        reach: f64,
    },
    /// Both axes are parallel, in the same sense, because an angle is measured about the reference's z.
    Parallel,
}

/// All rows that preferences have: the pin's position along the shell's x and y (m), the pin's axis along both,
/// and the pin's height above that of the preference (m).
const ROWS_OF_PIN: usize = 5;

/// A list of rows: all rows of each element in order, then the rows of preferences.
#[derive(Clone, Debug)]
pub struct Rows {
    /// The elements.
    pub(crate) elements: Vec<usize>,
    /// Preferences, after the elements.
    preferences: Vec<Preference>,
    /// (element, row) of each row that belongs to an element.
    pub(crate) owners: Vec<(usize, usize)>,
    /// Scale of each row.
    pub(crate) scales: Vec<f64>,
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
            preferences: Vec::new(),
            owners,
            scales,
        }
    }

    /// The same rows with those of preferences added.
    pub fn with(mut self, model: &Model, preferences: &[Preference]) -> Rows {
        for preference in preferences {
            self.preferences.push(*preference);
            let length = model.length;
            let scales = [length, length, 1.0, 1.0, length];
            self.scales.extend(&scales[preference.range()]);
        }
        self
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.scales.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.scales.is_empty()
    }

    /// Values of the rows.
    pub fn values(&self, model: &Model, at: &At) -> Result<DVector<f64>, RuntimeError> {
        self.numbers(model, at, Function::Residual)
    }

    /// Φ̇ of the rows at the given velocities.
    pub fn rates(&self, model: &Model, at: &At) -> Result<DVector<f64>, RuntimeError> {
        self.numbers(model, at, Function::Velocity)
    }

    /// The first outputs of a function of each element, one for each of its rows.
    fn numbers(
        &self,
        model: &Model,
        at: &At,
        function: Function,
    ) -> Result<DVector<f64>, RuntimeError> {
        let mut values = DVector::zeros(self.len());
        let mut first = 0;
        for element in &self.elements {
            let rows = model.class(*element).rows.len();
            if rows == 0 {
                continue;
            }
            let class = model.elements[*element].class;
            let layout = &model.compiled.system.classes[class].layout;
            let length = match function {
                Function::Velocity => 2 * rows,
                _ => layout.residual_len() as usize,
            };
            let mut out = vec![[0.0; 2]; length];
            let inputs = inputs(model, *element, at);
            elements::call(model, class, function, &inputs, &mut out)?;
            for i in 0..rows {
                values[first + i] = out[i][0];
            }
            first += rows;
        }
        Ok(values)
    }

    /// [`Rows::gradients`] with the zeros of the derivatives.
    pub fn evaluate(
        &self,
        model: &Model,
        at: &At,
        along: Along,
    ) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let (values, gradients) = self.gradients(model, at, along)?;
        Ok((values, gradients.dense()))
    }

    /// Values of the rows, and their derivatives by all velocities of the model (rows × velocities).
    pub fn gradients(
        &self,
        model: &Model,
        at: &At,
        along: Along,
    ) -> Result<(DVector<f64>, Gradients), RuntimeError> {
        let mut values = DVector::zeros(self.len());
        let mut matrix = Gradients::new(self.len(), model.velocities);
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
                let mut lines = vec![0.0; rows * width];
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
                    for (line, out) in lines.chunks_exact_mut(width).zip(&out) {
                        add_scaled(line, out[0], &jacobian[d * width..][..width]);
                    }
                }
                for (i, line) in lines.chunks_exact(width).enumerate() {
                    matrix.add(first + i, body.velocity, line);
                }
            }
            first += rows;
        }
        if along == Along::Pose {
            for preference in &self.preferences {
                preference.add(model, at, first, &mut values, &mut matrix);
                first += preference.range().len();
            }
        }
        Ok((values, matrix))
    }

    /// [`Rows::scale`] of derivatives without zeros.
    pub fn scale_gradients(
        &self,
        model: &Model,
        values: &mut DVector<f64>,
        matrix: &mut Gradients,
    ) {
        let columns = model.velocity_scales();
        for (value, scale) in values.iter_mut().zip(&self.scales) {
            *value /= scale;
        }
        matrix.scale(|i, j| columns[j] / self.scales[i]);
    }

    /// Divides values and rows by the rows' scales, and the columns of translations by 1/length. Then all
    /// numbers are angles.
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

impl Preference {
    /// The rows of the preference, among all rows that preferences have.
    pub fn range(&self) -> Range<usize> {
        match self.relation {
            Relation::Inside { .. } => 0..4,
            Relation::Above { .. } => 4..5,
            Relation::Parallel => 2..4,
        }
    }

    /// Whether the preference places a pin in its shell.
    pub fn is_inside(&self) -> bool {
        matches!(self.relation, Relation::Inside { .. })
    }

    /// Position of the pin in its shell: x and y (m), x and y of its axis, and its height (m) above that of the
    /// preference. In a shell the axis may point either way.
    ///
    /// With the shell's axes S and position s, and the pin's axes P and position p: `e = Sᵀ(p − s)`,
    /// `a = Sᵀ P z`.
    fn values(&self, model: &Model, at: &At) -> ([f64; ROWS_OF_PIN], [M3; 2], V3, V3, f64) {
        let pin = marker(model, self.pin, at.pose, at.velocity);
        let shell = marker(model, self.shell, at.pose, at.velocity);
        let back = shell.rotation.transpose();
        let arm = back * (pin.position - shell.position);
        let turned = back * pin.rotation;
        let axis: V3 = turned.column(2).into_owned();
        let sign = match self.relation {
            Relation::Inside { .. } if axis.z < 0.0 => -1.0,
            _ => 1.0,
        };
        let height = match self.relation {
            Relation::Above { height, .. } => height,
            _ => 0.0,
        };
        (
            [arm.x, arm.y, sign * axis.x, sign * axis.y, arm.z - height],
            [back, turned],
            arm,
            axis,
            sign,
        )
    }

    /// Whether the pin is within its reach, and its axis within a hundredth of a radian where it matters.
    pub fn is_fulfilled(&self, model: &Model, at: &At) -> bool {
        let ([x, y, a, b, z], .., axis, _) = self.values(model, at);
        // a choice: as far as an axis tilts in the clearance of a bearing
        let along = libm::hypot(a, b) <= 0.01;
        match self.relation {
            Relation::Inside { reach } => libm::hypot(x, y) <= reach && along,
            Relation::Above { reach, .. } => z.abs() <= reach,
            Relation::Parallel => along && axis.z > 0.0,
        }
    }

    /// The way of the pin (m, inertial axes) to the height of the preference; zero for other preferences.
    pub fn way_up(&self, model: &Model, at: &At) -> V3 {
        if !matches!(self.relation, Relation::Above { .. }) {
            return V3::zeros();
        }
        let ([.., above], [back, _], ..) = self.values(model, at);
        back.transpose() * V3::new(0.0, 0.0, -above)
    }

    /// Values and derivatives from row `first` on: `δe = Sᵀ(δp − δs) − δσ × e`,
    /// `δa = Sᵀ P (δπ × z) − δσ × a`, δπ and δσ in the axes of pin and shell.
    fn add(
        &self,
        model: &Model,
        at: &At,
        first: usize,
        values: &mut DVector<f64>,
        matrix: &mut Gradients,
    ) {
        let (now, [back, turned], arm, axis, sign) = self.values(model, at);
        let range = self.range();
        for (i, value) in now[range.clone()].iter().enumerate() {
            values[first + i] = *value;
        }
        for (marker, of_shell) in [(self.pin, false), (self.shell, true)] {
            let marker = &model.markers[marker];
            let Some(b) = marker.body else { continue };
            let body = &model.bodies[b];
            let width = body.width();
            let mut jacobian = vec![0.0; 6 * width];
            chain::jacobian(body, &body.frame(at.pose), marker, &mut jacobian);
            for w in 0..width {
                let part = |row: usize| V3::from_fn(|i, _| jacobian[(row + i) * width + w]);
                let (moves, turns) = (back * part(0), part(3));
                let (e, a) = if of_shell {
                    (-moves - turns.cross(&arm), -turns.cross(&axis))
                } else {
                    (moves, turned * turns.cross(&V3::z()))
                };
                let column = body.velocity + w;
                let rates = [e.x, e.y, sign * a.x, sign * a.y, e.z];
                for (i, rate) in rates[range.clone()].iter().enumerate() {
                    matrix.add(first + i, column, &[*rate]);
                }
            }
        }
    }
}

/// The preferences that the classes of a model's elements state.
pub fn preferences(model: &Model) -> Vec<Preference> {
    let mut found = Vec::new();
    for (e, element) in model.compiled.system.elements.iter().enumerate() {
        if element.places.is_empty() || !model.elements[e].dynamic {
            continue;
        }
        let markers = &model.elements[e].markers;
        let follows = |m: usize| model.markers[m].placed_at.is_some();
        let stated = element.resolves.iter().map(|slot| model.slot(*slot));
        let reach = stated
            .reduce(f64::min)
            .unwrap_or(TOLERANCE_OF_LENGTH * model.length);
        for place in &element.places {
            let [Some(pin), Some(shell)] =
                [place.moving, place.on].map(|m| markers.get(m as usize).copied())
            else {
                continue;
            };
            if follows(pin) || follows(shell) {
                continue;
            }
            let reach = reach.max(0.0);
            found.push(Preference {
                element: e,
                pin,
                shell,
                relation: match place.height {
                    None => Relation::Inside { reach },
                    Some(height) => Relation::Above {
                        height: model.slot(height),
                        reach,
                    },
                },
            });
        }
    }
    found
}

/// Pins in their shells, as the classes of a model's elements state them: elements, and markers of pin and shell.
pub fn pins(model: &Model) -> Vec<Preference> {
    let mut found = preferences(model);
    found.retain(Preference::is_inside);
    found
}

/// The preferences of elements that measure angles. An angle about the reference's z has a meaning only if the
/// axes are parallel. Without the preference, a body that lies across or upside down would also solve the equation
/// of a drive.
pub fn axes(model: &Model, elements: &[usize]) -> Vec<Preference> {
    let mut found = Vec::new();
    for e in elements {
        let element = &model.compiled.system.elements[*e];
        if element.role != Role::Dynamic {
            continue;
        }
        let marker = |index: u32| model.elements[*e].markers.get(index as usize).copied();
        let pairs = element.rotations.iter();
        found.extend(pairs.filter_map(|rotation| {
            let preference = Preference {
                element: *e,
                pin: marker(rotation.turning)?,
                shell: marker(rotation.reference)?,
                relation: Relation::Parallel,
            };
            Some(preference)
        }));
    }
    found.dedup();
    found
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
        for lane in 0..2 {
            elements::write_marker(&mut inputs, first, lane, &m);
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

/// The smallest solution x of `A x = b` in the least-squares sense; singular values below 1e-9 of the largest
/// count as zero. Many rows that are clearly independent need no singular values.
pub fn smallest_solution(matrix: &Gradients, rhs: &DVector<f64>) -> Option<DVector<f64>> {
    if matrix.nrows() == 0 || matrix.ncols() == 0 {
        return Some(DVector::zeros(matrix.ncols()));
    }
    if rhs.iter().any(|x| !x.is_finite()) {
        return None;
    }
    if matrix.nrows() > independent::FEW
        && let Some(solution) = independent::solution(matrix, rhs)
    {
        return Some(solution);
    }
    let svd = crate::singular::decompose(matrix.dense())?;
    // as [`independent::DEPENDENT`] in the other method: a combination of rows below it is a repetition, and
    // dividing by it would move bodies by rounding
    let threshold = 1e-9 * svd.singular_values.amax();
    svd.solve(rhs, threshold.max(f64::MIN_POSITIVE)).ok()
}
