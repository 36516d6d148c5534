//! A compiled model bound to one parameter set: numbers in place of slots, offsets in place of references.

use crate::body::{BodyKind, BodyModel, Rigid};
use crate::error::{NamedRow, RuntimeError};
use crate::flexible::Flexible;
use crate::rotation::{M3, V3, skew};
use crate::shape::MarkerShape;
use eng_system::code::{Compiled, Function};
use eng_system::dimension::Dimension;
use eng_system::reduced::ReducedBody;
use eng_system::system::{Body, BodyInertia, BodyRef, ElementClass, Role, Slot};
use std::sync::Arc;

/// Share of the largest radius of gyration below which the distances of markers are no measure of a model.
const POINTLIKE: f64 = 1e-2;

/// A marker with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerModel {
    /// Index of its body; `None` for ground.
    pub body: Option<usize>,
    /// Place in the body frame (m).
    pub position: V3,
    /// Marker → body.
    pub orientation: M3,
    /// How it follows the modes of a flexible body; `None` where it does not.
    pub shape: Option<MarkerShape>,
    /// The marker it lies on at the start, until assembly has placed it.
    pub placed_at: Option<usize>,
}

impl MarkerModel {
    /// How many numbers of its body's motion it sees: see [`crate::chain`].
    pub fn reach(&self) -> usize {
        crate::chain::reach_of(self.shape.as_ref())
    }
}

/// An element with its numbers and its places in the model's vectors.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementModel {
    /// Index of the class.
    pub class: usize,
    /// Indices of its markers.
    pub markers: Vec<usize>,
    /// Values of its constants.
    pub constants: Vec<f64>,
    /// First of its states.
    pub state: usize,
    /// First of its multipliers, for dynamic elements.
    pub row: usize,
    /// First of its rotation references.
    pub rotation: usize,
    /// First of its wrench numbers, six a marker.
    pub wrench: usize,
    /// First of its entries among the constraint gradients, rows × 6 markers.
    pub gradient: usize,
    /// Whether it takes part in the motion.
    pub dynamic: bool,
}

/// A model with numbers.
#[derive(Clone, Debug)]
pub struct Model {
    /// System and code.
    pub compiled: Compiled,
    /// Values of the slots.
    pub slots: Vec<f64>,
    /// Values of the parameters.
    pub parameters: Vec<f64>,
    /// Messages of the bind graph.
    pub advice: Vec<eng_system::code::Advice>,
    /// Bodies.
    pub bodies: Vec<BodyModel>,
    /// Markers.
    pub markers: Vec<MarkerModel>,
    /// Elements.
    pub elements: Vec<ElementModel>,
    /// Gravity (m/s²).
    pub gravity: V3,
    /// Pose numbers.
    pub poses: usize,
    /// Velocities.
    pub velocities: usize,
    /// States of dynamic elements.
    pub states: usize,
    /// Of each state the size, positive, from which on its errors matter.
    pub state_scales: Vec<f64>,
    /// Circular frequency (rad/s) of the mode behind each velocity; zero where there is none, or where it is not known.
    pub frequencies: Vec<f64>,
    /// Constraint rows of dynamic elements.
    pub rows: usize,
    /// Rotation references.
    pub rotations: usize,
    /// Wrench numbers.
    pub wrenches: usize,
    /// Constraint gradient numbers.
    pub gradients: usize,
    /// Length of the model (m): scales positions against angles. The largest distance of a marker from its body's origin or centre of mass;
    /// the largest radius of gyration where that is a hundred times more.
    pub length: f64,
    /// Largest mass (kg): scales forces.
    pub mass: f64,
    /// Position tolerance (m), physical: see [`Model::bind`].
    pub tolerance: f64,
}

fn malformed(what: impl Into<String>) -> RuntimeError {
    RuntimeError::Malformed { what: what.into() }
}

struct Slots<'a>(&'a [f64]);

impl Slots<'_> {
    fn get(&self, slot: Slot) -> Result<f64, RuntimeError> {
        self.0
            .get(slot.0 as usize)
            .copied()
            .ok_or_else(|| malformed(format!("slot {} does not exist", slot.0)))
    }
    fn vector(&self, slots: &[Slot; 3]) -> Result<V3, RuntimeError> {
        Ok(V3::new(
            self.get(slots[0])?,
            self.get(slots[1])?,
            self.get(slots[2])?,
        ))
    }
    fn matrix(&self, slots: &[Slot; 9]) -> Result<M3, RuntimeError> {
        let mut m = M3::zeros();
        for i in 0..3 {
            for j in 0..3 {
                m[(i, j)] = self.get(slots[3 * i + j])?;
            }
        }
        Ok(m)
    }
}

impl Model {
    /// Binds a parameter set and checks that system and code fit together.
    ///
    /// The position tolerance is 1e-3 of the smallest radial clearance of a journal, or 1e-6 of the model's length.
    pub fn bind(compiled: &Compiled, overrides: &[Option<f64>]) -> Result<Model, RuntimeError> {
        let system = &compiled.system;
        if compiled.code.len() != system.classes.len() {
            return Err(malformed("there is not one code object a class"));
        }
        if !overrides.is_empty() && overrides.len() != system.parameters.len() {
            return Err(RuntimeError::Options {
                message: format!(
                    "{} parameter values are given for {} parameters",
                    overrides.len(),
                    system.parameters.len()
                ),
            });
        }
        let none;
        let overrides = if overrides.is_empty() {
            none = vec![None; system.parameters.len()];
            &none[..]
        } else {
            overrides
        };
        let bound = compiled.bind.bind(overrides, &system.tables)?;
        if bound.slots.len() < system.slots as usize {
            return Err(malformed("the bind graph fills too few slots"));
        }
        let slots = Slots(&bound.slots);
        for (class, code) in system.classes.iter().zip(&compiled.code) {
            check_shapes(class, code.as_ref())?;
        }

        let mut bodies = Vec::with_capacity(system.bodies.len());
        let (mut poses, mut velocities) = (0, 0);
        let mut frequencies = Vec::new();
        for body in &system.bodies {
            let kind = body_kind(body, &slots, &compiled.reduced)?;
            let model = BodyModel {
                origin: body.origin.clone(),
                kind,
                pose: poses,
                velocity: velocities,
            };
            poses += 7 + model.modes();
            velocities += model.width();
            if let BodyInertia::Flexible(index) = &body.inertia
                && let Some(reduced) = compiled.reduced.get(*index as usize)
            {
                frequencies.resize(model.velocity + 6, 0.0);
                let known = reduced.frequencies.iter().take(model.modes());
                frequencies.extend(known.map(|f| f * std::f64::consts::TAU));
            }
            frequencies.resize(velocities, 0.0);
            bodies.push(model);
        }

        let mut markers = Vec::with_capacity(system.markers.len());
        for marker in &system.markers {
            let body = match marker.body {
                BodyRef::Ground => None,
                BodyRef::Body(index) => {
                    if index as usize >= bodies.len() {
                        return Err(malformed(format!(
                            "{}: body does not exist",
                            marker.origin.path
                        )));
                    }
                    Some(index as usize)
                }
            };
            let placed_at = marker.placed_at.map(|m| m as usize);
            if placed_at.is_some_and(|m| m >= system.markers.len())
                || (placed_at.is_some() && body.is_some())
            {
                return Err(malformed(format!(
                    "{}: placed at what does not exist",
                    marker.origin.path
                )));
            }
            let flexible = body.and_then(|b| match &system.bodies[b].inertia {
                BodyInertia::Flexible(reduced) => Some(*reduced as usize),
                BodyInertia::Rigid { .. } => None,
            });
            let shape = match flexible {
                Some(reduced) => marker_shape(
                    &compiled.reduced[reduced],
                    marker.shape,
                    &marker.origin.path,
                )?,
                None => None,
            };
            let (position, orientation) = if placed_at.is_some() {
                (V3::zeros(), M3::identity())
            } else if let (Some(reduced), Some(index)) = (flexible, marker.shape) {
                let place = compiled.reduced[reduced].markers[index as usize].position;
                (V3::from(place), slots.matrix(&marker.orientation)?)
            } else {
                (
                    slots.vector(&marker.position)?,
                    slots.matrix(&marker.orientation)?,
                )
            };
            markers.push(MarkerModel {
                body,
                position,
                orientation,
                shape,
                placed_at,
            });
        }

        let mut elements = Vec::with_capacity(system.elements.len());
        let (mut states, mut rows, mut rotations, mut wrenches, mut gradients) = (0, 0, 0, 0, 0);
        let mut state_scales = Vec::new();
        for element in &system.elements {
            let path = &element.origin.path;
            let class = system
                .classes
                .get(element.class as usize)
                .ok_or_else(|| malformed(format!("{path}: class does not exist")))?;
            let layout = &class.layout;
            if element.markers.len() != layout.markers as usize
                || element.constants.len() != layout.constants as usize
                || element.state_start.len() != layout.states as usize
                || element.state_scale.len() != layout.states as usize
                || element.signals.len() != layout.signals as usize
                || element.rotations.len() != layout.rotations as usize
                || element.markers.iter().any(|m| *m as usize >= markers.len())
                || element
                    .signals
                    .iter()
                    .any(|s| *s as usize >= system.channels.len())
            {
                return Err(malformed(format!("{path}: not as its class's layout says")));
            }
            let mut constants = Vec::with_capacity(element.constants.len());
            for slot in &element.constants {
                constants.push(slots.get(*slot)?);
            }
            let dynamic = element.role == Role::Dynamic;
            if !dynamic && layout.states > 0 {
                return Err(malformed(format!(
                    "{path}: states outside the model's motion"
                )));
            }
            elements.push(ElementModel {
                class: element.class as usize,
                markers: element.markers.iter().map(|m| *m as usize).collect(),
                constants,
                state: states,
                row: rows,
                rotation: rotations,
                wrench: wrenches,
                gradient: gradients,
                dynamic,
            });
            rotations += layout.rotations as usize;
            if dynamic {
                for slot in &element.state_scale {
                    let scale = slots.get(*slot)?;
                    if scale.is_nan() || scale <= 0.0 {
                        return Err(malformed(format!("{path}: a state without a scale")));
                    }
                    state_scales.push(scale);
                }
                states += layout.states as usize;
                rows += layout.rows as usize;
                wrenches += 6 * layout.markers as usize;
                gradients += (layout.rows * 6 * layout.markers) as usize;
            }
        }
        for channel in &system.channels {
            let known = system
                .elements
                .get(channel.element as usize)
                .and_then(|e| system.classes.get(e.class as usize))
                .is_some_and(|c| (channel.output as usize) < c.outputs.len());
            if !known {
                return Err(malformed(format!("{}: no such output", channel.path)));
            }
        }
        if let Some(cycle) = &system.cycle {
            let known = elements
                .get(cycle.element as usize)
                .is_some_and(|e| system.classes[e.class].outputs.len() >= 2);
            if !known || slots.get(cycle.period)? <= 0.0 {
                return Err(malformed("the cycle has no angle, no rate or no period"));
            }
        }

        let mut length: f64 = 0.0;
        let mut mass: f64 = 0.0;
        for (index, body) in bodies.iter().enumerate() {
            mass = mass.max(body.mass());
            let center = body.center();
            length = length.max(center.norm());
            for m in markers.iter().filter(|m| m.body == Some(index)) {
                length = length
                    .max((m.position - center).norm())
                    .max(m.position.norm());
            }
        }
        // Bodies that are all markers at nearly one place have their size from their inertia.
        let gyration = bodies
            .iter()
            .map(|body| libm::sqrt(body.inertia().amax() / body.mass()))
            .filter(|radius| radius.is_finite())
            .fold(0.0, f64::max);
        if length < POINTLIKE * gyration {
            length = gyration;
        }
        if length == 0.0 {
            length = 1.0;
        }
        if mass == 0.0 {
            mass = 1.0;
        }
        let mut tolerance = f64::INFINITY;
        for journal in &system.journals {
            let clearance = slots.get(journal.radial_clearance)?;
            if clearance > 0.0 {
                tolerance = tolerance.min(1e-3 * clearance);
            }
        }
        if !tolerance.is_finite() {
            tolerance = 1e-6 * length;
        }
        let gravity = slots.vector(&system.gravity)?;
        Ok(Model {
            compiled: compiled.clone(),
            slots: bound.slots,
            parameters: bound.parameters,
            advice: bound.advice,
            bodies,
            markers,
            elements,
            gravity,
            poses,
            velocities,
            states,
            state_scales,
            frequencies,
            rows,
            rotations,
            wrenches,
            gradients,
            length,
            mass,
            tolerance,
        })
    }

    /// The class of an element.
    pub fn class(&self, element: usize) -> &ElementClass {
        &self.compiled.system.classes[self.elements[element].class]
    }

    /// Value of a slot; 0 for one that does not exist.
    pub fn slot(&self, slot: Slot) -> f64 {
        self.slots.get(slot.0 as usize).copied().unwrap_or(0.0)
    }

    /// What one unit of a constraint row is in the scaled system: the model's length for a length, else one.
    pub fn row_scale(&self, element: usize, row: usize) -> f64 {
        if self.class(element).rows[row].dimension == Dimension::LENGTH {
            self.length
        } else {
            1.0
        }
    }

    /// Element and row within it of a row of the dynamic system.
    pub fn row_owner(&self, row: usize) -> Option<(usize, usize)> {
        self.elements.iter().enumerate().find_map(|(index, e)| {
            let count = self.compiled.system.classes[e.class].rows.len();
            (e.dynamic && (e.row..e.row + count).contains(&row)).then(|| (index, row - e.row))
        })
    }

    /// A row with its names.
    pub fn named_row(&self, element: usize, row: usize, value: f64) -> NamedRow {
        let info = &self.class(element).rows[row];
        NamedRow {
            origin: self.compiled.system.elements[element].origin.clone(),
            equation: info.text.clone(),
            value,
            is_length: info.dimension == Dimension::LENGTH,
        }
    }

    /// Scale of each velocity: the length for a translation, one for a rotation; for a modal rate what moves a marker by the length.
    pub fn velocity_scales(&self) -> Vec<f64> {
        let mut scales = vec![1.0; self.velocities];
        for body in &self.bodies {
            scales[body.velocity..body.velocity + 3].fill(self.length);
        }
        // an amplitude by what it moves the body's mass on average, or its markers if that is more
        for body in &self.bodies {
            if let BodyKind::Flexible(flexible) = &body.kind {
                let constants = &flexible.constants;
                let n = constants.modes;
                for i in 0..n {
                    let share = constants.modal_mass[i * n + i] / constants.mass;
                    scales[body.velocity + 6 + i] = self.length / libm::sqrt(share);
                }
            }
        }
        for marker in &self.markers {
            let (Some(b), Some(shape)) = (marker.body, &marker.shape) else {
                continue;
            };
            let (first, n) = (self.bodies[b].velocity + 6, self.bodies[b].modes());
            for (i, x) in shape.rows()[..3 * n].iter().enumerate() {
                let reach = self.length / x.abs();
                let scale = &mut scales[first + i % n];
                *scale = scale.min(reach);
            }
        }
        for scale in &mut scales {
            if !scale.is_finite() {
                *scale = 1.0;
            }
        }
        scales
    }

    /// Scale of each constraint row.
    pub fn row_scales(&self) -> Vec<f64> {
        let mut scales = vec![1.0; self.rows];
        for (index, element) in self.elements.iter().enumerate() {
            if element.dynamic {
                for row in 0..self.class(index).rows.len() {
                    scales[element.row + row] = self.row_scale(index, row);
                }
            }
        }
        scales
    }
}

fn check_shapes(
    class: &ElementClass,
    code: &dyn eng_system::code::ElementCode,
) -> Result<(), RuntimeError> {
    let layout = &class.layout;
    let common = layout.len() as usize;
    let rows = layout.rows as usize;
    let residual = layout.residual_len() as usize;
    let tape = class.tape as usize;
    let counts_fit = class.rows.len() == rows && class.states.len() == layout.states as usize;
    let expected = [
        (Function::Residual, common, residual),
        (Function::Linearize, common, tape),
        (
            Function::Tangent,
            tape + layout.directions() as usize,
            residual,
        ),
        (Function::Velocity, common, 2 * rows),
        (
            Function::Outputs,
            layout.outputs_len() as usize,
            class.outputs.len(),
        ),
        (Function::Conditions, common, class.conditions.len()),
        (Function::Rotations, common, layout.rotations as usize),
    ];
    for (function, inputs, outputs) in expected {
        // Functions without a result may be left empty.
        if outputs == 0 && function != Function::Linearize {
            continue;
        }
        if !counts_fit || code.shape(function) != (inputs, outputs) {
            return Err(malformed(format!(
                "class {}: {function:?} has the shape {:?}, not {:?}",
                class.name,
                code.shape(function),
                (inputs, outputs)
            )));
        }
    }
    Ok(())
}

/// Mass properties of a body, checked.
fn body_kind(
    body: &Body,
    slots: &Slots,
    reduced: &[Arc<ReducedBody>],
) -> Result<BodyKind, RuntimeError> {
    let refuse = |message: &str| RuntimeError::Body {
        origin: Box::new(body.origin.clone()),
        message: message.to_string(),
    };
    let (mass, center_of_mass, inertia) = match &body.inertia {
        BodyInertia::Flexible(index) => {
            let reduced = reduced
                .get(*index as usize)
                .ok_or_else(|| malformed(format!("{}: not reduced", body.origin.path)))?;
            if let Some(defect) = reduced.invariants.defect() {
                return Err(refuse(&defect));
            }
            let constants = Arc::new(reduced.invariants.clone());
            return Ok(BodyKind::Flexible(Flexible::new(constants)));
        }
        BodyInertia::Rigid {
            mass,
            center_of_mass,
            inertia,
        } => (mass, center_of_mass, inertia),
    };
    let mass = slots.get(*mass)?;
    let center = slots.vector(center_of_mass)?;
    let mut j = [0.0; 6];
    for (value, slot) in j.iter_mut().zip(inertia) {
        *value = slots.get(*slot)?;
    }
    let about_center = M3::new(j[0], j[3], j[5], j[3], j[1], j[4], j[5], j[4], j[2]);
    if !(mass > 0.0 && mass.is_finite()) {
        return Err(refuse(&format!(
            "the mass is {mass} kg; it must be positive"
        )));
    }
    let moments = about_center.symmetric_eigenvalues();
    let largest = moments.amax();
    let trace: f64 = moments.iter().sum();
    if !largest.is_finite() || moments.iter().any(|m| *m < -1e-9 * largest) {
        return Err(refuse("the inertia tensor has a negative principal moment"));
    }
    if moments.iter().any(|m| 2.0 * m > trace * (1.0 + 1e-6)) {
        return Err(refuse(
            "a principal moment of inertia exceeds the sum of the other two, which no body can have",
        ));
    }
    let c = skew(&center);
    Ok(BodyKind::Rigid(Rigid {
        mass,
        center,
        inertia: about_center - c * c * mass,
    }))
}

/// How a marker of a flexible body follows the modes; one without a place on the mesh moves with the frame.
fn marker_shape(
    reduced: &ReducedBody,
    shape: Option<u32>,
    path: &str,
) -> Result<Option<MarkerShape>, RuntimeError> {
    let Some(index) = shape else {
        return Ok(None);
    };
    let length = 3 * reduced.invariants.modes;
    let marker = reduced
        .markers
        .get(index as usize)
        .filter(|m| m.translation.len() == length && m.rotation.len() == length)
        .ok_or_else(|| malformed(format!("{path}: not among the reduced markers")))?;
    let geometric = reduced.invariants.geometric.iter();
    let loads = geometric
        .flat_map(|geometric| &geometric.loads)
        .filter(|load| load.marker == index as usize);
    // a body without modes is a rigid one
    Ok((length > 0).then(|| MarkerShape::new(marker, loads)))
}
