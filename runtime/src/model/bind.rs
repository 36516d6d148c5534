//! Numbers in place of slots: a compiled model becomes a [`Model`], or it is refused.

use super::{ElementModel, LEAST_ERROR, MarkerModel, Model, STEP_SHARE, TOLERANCE_OF_LENGTH};
use crate::body::{BodyKind, BodyModel, Rigid};
use crate::error::RuntimeError;
use crate::flexible::Flexible;
use crate::rotation::{M3, V3, skew};
use crate::shape::MarkerShape;
use crate::surface::SurfaceModel;
use crate::thread_pool::ThreadPool;
use eng_system::code::{Compiled, Function};
use eng_system::field::{FieldKernel, FieldNumbers};
use eng_system::reduced::{ReducedBody, ReducedSurface};
use eng_system::significant::short;
use eng_system::system::{
    Body, BodyInertia, BodyRef, Element, ElementClass, Marker, Role, Slot, System,
};
use std::sync::Arc;

/// Share of the largest radius of gyration below which the distances of markers are no measure of a model. A
/// choice: a body of a hundred times the lever of its markers turns little by their forces.
const POINTLIKE: f64 = 1e-2;

/// Position tolerance as a part of the smallest length that a class resolves. A choice: forces of a film
/// change by about this share when its gap does.
const OF_RESOLUTION: f64 = 1e-3;

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
    /// The position tolerance is 1e-3 of the smallest length that a class resolves, and at most 1e-6 of the
    /// model's length. The error of one step may be a tenth of it.
    ///
    /// # Errors
    /// Parameters that the bind graph refuses; physically impossible bodies; a length to resolve below rounding; a
    /// system whose parts do not fit each other.
    pub fn bind(compiled: &Compiled, overrides: &[Option<f64>]) -> Result<Model, RuntimeError> {
        let system = &compiled.system;
        if compiled.code.len() != system.classes.len() {
            return Err(malformed("there is not one code object a class"));
        }
        for (class, code) in system.classes.iter().zip(&compiled.code) {
            check_shapes(class, code.as_ref())?;
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
        let mut model = Model {
            compiled: compiled.clone(),
            gravity: slots.vector(&system.gravity)?,
            slots: Vec::new(),
            parameters: bound.parameters,
            overrides: overrides.to_vec(),
            nodes: bound.nodes,
            advice: bound.advice,
            bodies: Vec::with_capacity(system.bodies.len()),
            markers: Vec::with_capacity(system.markers.len()),
            elements: Vec::with_capacity(system.elements.len()),
            kernels: Vec::with_capacity(system.elements.len()),
            thread_pool: (compiled.threads.get() > 1)
                .then(|| Arc::new(ThreadPool::new(compiled.threads))),
            memory: 0,
            surfaces: Vec::new(),
            poses: 0,
            velocities: 0,
            states: 0,
            state_scales: Vec::new(),
            frequencies: Vec::new(),
            rows: 0,
            rotations: 0,
            wrenches: 0,
            gradients: 0,
            length: 0.0,
            mass: 0.0,
            tolerance: 0.0,
        };
        for body in &system.bodies {
            model.add_body(body, &slots)?;
        }
        for marker in &system.markers {
            let marker = model.marker(marker, &slots)?;
            model.markers.push(marker);
        }
        for element in &system.elements {
            model.add_element(element, &slots)?;
            let kernels = model.fields_of(element, &slots)?;
            let memory = kernels.iter().map(|kernel| kernel.memory()).sum::<usize>();
            if memory > 0 && element.role != Role::Dynamic {
                return Err(RuntimeError::Field {
                    origin: Box::new(element.origin.clone()),
                    message: "only outputs read this field, but it has a memory and must follow the motion: apply a load that uses its results".into(),
                });
            }
            model.memory += memory;
            model.kernels.push(kernels);
        }
        check_readers(system, &slots)?;
        model.length = model.largest_length();
        let masses = model.bodies.iter().map(BodyModel::mass);
        let mass = masses.fold(0.0, f64::max);
        model.mass = if mass == 0.0 { 1.0 } else { mass };
        model.tolerance = position_tolerance(system, &slots, model.length)?;
        model.slots = bound.slots;
        Ok(model)
    }

    /// Adds a body after all others.
    fn add_body(&mut self, body: &Body, slots: &Slots) -> Result<(), RuntimeError> {
        let reduced = &self.compiled.reduced;
        let model = BodyModel {
            origin: body.origin.clone(),
            kind: body_kind(body, slots, reduced)?,
            pose: self.poses,
            velocity: self.velocities,
        };
        self.poses += 7 + model.modes();
        self.velocities += model.width();
        if let BodyInertia::Flexible(index) = &body.inertia
            && let Some(reduced) = reduced.get(*index as usize)
        {
            self.frequencies.resize(model.velocity + 6, 0.0);
            let known = reduced.frequencies.iter().take(model.modes());
            self.frequencies
                .extend(known.map(|f| f * std::f64::consts::TAU));
        }
        self.frequencies.resize(self.velocities, 0.0);
        self.bodies.push(model);
        Ok(())
    }

    /// A marker on the ground or on a body that is already in the model.
    fn marker(&self, marker: &Marker, slots: &Slots) -> Result<MarkerModel, RuntimeError> {
        let Compiled {
            system, reduced, ..
        } = &self.compiled;
        let path = &marker.origin.path;
        let body = match marker.body {
            BodyRef::Ground => None,
            BodyRef::Body(index) if (index as usize) < self.bodies.len() => Some(index as usize),
            BodyRef::Body(_) => return Err(malformed(format!("{path}: body does not exist"))),
        };
        let placed_at = marker.placed_at.map(|m| m as usize);
        if placed_at.is_some_and(|m| m >= system.markers.len() || body.is_some()) {
            return Err(malformed(format!(
                "{path}: its place is no marker of another body"
            )));
        }
        let reduced = body.and_then(|b| match &system.bodies[b].inertia {
            BodyInertia::Flexible(index) => Some(&reduced[*index as usize]),
            BodyInertia::Rigid { .. } => None,
        });
        let shape = match reduced {
            Some(reduced) => marker_shape(reduced, marker.shape, path)?,
            None => None,
        };
        let (position, orientation) = if placed_at.is_some() {
            (V3::zeros(), M3::identity())
        } else {
            let position = match (reduced, marker.shape) {
                (Some(reduced), Some(index)) => V3::from(reduced.markers[index as usize].position),
                _ => slots.vector(&marker.position)?,
            };
            (position, slots.matrix(&marker.orientation)?)
        };
        if let (Some(body), false) = (body, is_measurable(&position)) {
            return Err(RuntimeError::Body {
                origin: Box::new(self.bodies[body].origin.clone()),
                message: format!("its marker {path} is too far away"),
            });
        }
        Ok(MarkerModel {
            body,
            position,
            orientation,
            shape,
            placed_at,
        })
    }

    /// Adds an element after all others.
    fn add_element(&mut self, element: &Element, slots: &Slots) -> Result<(), RuntimeError> {
        let path = &element.origin.path;
        let system = &self.compiled.system;
        let class = system
            .classes
            .get(element.class as usize)
            .ok_or_else(|| malformed(format!("{path}: class does not exist")))?;
        let layout = &class.layout;
        let unknown_marker = |m: &u32| *m as usize >= self.markers.len();
        let unknown_signal = |s: &u32| *s as usize >= system.channels.len();
        if element.markers.len() != layout.markers as usize
            || element.constants.len() != layout.constants as usize
            || element.state_start.len() != layout.states as usize
            || element.state_scale.len() != layout.states as usize
            || element.signals.len() != layout.signals as usize
            || element.rotations.len() != layout.rotations as usize
            || element.markers.iter().any(unknown_marker)
            || element.signals.iter().any(unknown_signal)
        {
            return Err(malformed(format!(
                "{path}: it does not fit the layout of its class"
            )));
        }
        let dynamic = element.role == Role::Dynamic;
        if !dynamic && layout.states > 0 {
            return Err(malformed(format!(
                "{path}: states outside the model's motion"
            )));
        }
        let constants = element.constants.iter().map(|slot| slots.get(*slot));
        let moving = element.constants.iter().enumerate();
        let moving =
            moving.filter_map(|(k, slot)| Some((k, system.moving.binary_search(slot).ok()?)));
        self.elements.push(ElementModel {
            class: element.class as usize,
            markers: element.markers.iter().map(|m| *m as usize).collect(),
            constants: constants.collect::<Result<_, _>>()?,
            moving: moving.collect(),
            state: self.states,
            row: self.rows,
            rotation: self.rotations,
            wrench: self.wrenches,
            gradient: self.gradients,
            memory: self.memory,
            dynamic,
        });
        self.rotations += layout.rotations as usize;
        if dynamic {
            for slot in &element.state_scale {
                let scale = slots.get(*slot)?;
                if scale.is_nan() || scale <= 0.0 {
                    return Err(malformed(format!("{path}: a state without a scale")));
                }
                self.state_scales.push(scale);
            }
            self.states += layout.states as usize;
            self.rows += layout.rows as usize;
            self.wrenches += 6 * layout.markers as usize;
            self.gradients += (layout.rows * 6 * layout.markers) as usize;
        }
        Ok(())
    }

    /// The kernels of the fields of the last element. Adds the elastic surfaces that they press on.
    fn fields_of(
        &mut self,
        element: &Element,
        slots: &Slots,
    ) -> Result<Vec<Arc<dyn FieldKernel>>, RuntimeError> {
        let index = self.elements.len() - 1;
        let mut kernels: Vec<Arc<dyn FieldKernel>> = Vec::with_capacity(element.fields.len());
        for (field, source) in element.fields.iter().enumerate() {
            let mut settings = Vec::with_capacity(source.settings.len());
            for (name, places) in &source.settings {
                let values: Result<Vec<f64>, RuntimeError> =
                    places.iter().map(|slot| slots.get(*slot)).collect();
                settings.push((*name, values?));
            }
            let compiled = &self.compiled;
            let marker = source.surface.and_then(|m| element.markers.get(m as usize));
            let found = marker.and_then(|marker| surface_of(compiled, *marker as usize));
            let made = compiled.fields.make(&FieldNumbers {
                source,
                settings,
                surface: found.map(|(_, surface)| surface),
            });
            let kernel = made.map_err(|error| RuntimeError::Field {
                origin: Box::new(element.origin.clone()),
                message: error.to_string(),
            })?;
            if let (Some((body, surface)), shapes @ 1..) = (found, kernel.shapes()) {
                let flexible = &self.bodies[body];
                let modes = flexible.modes();
                if surface.content.len() != shapes * modes {
                    let path = &element.origin.path;
                    return Err(malformed(format!(
                        "{path}: its surface has other modes than its body"
                    )));
                }
                // each film finds the rest of the deflection for its own pressure alone
                let same =
                    |known: &&SurfaceModel| (known.body, known.marker) == (body, surface.marker);
                if let Some(other) = self.surfaces.iter().find(same) {
                    let other = &self.compiled.system.elements[other.element].origin.path;
                    return Err(RuntimeError::Field {
                        origin: Box::new(element.origin.clone()),
                        message: format!(
                            "{other} presses on the same elastic surface: a surface carries one film, so give each film a marker of its own"
                        ),
                    });
                }
                let before = self.surfaces.last();
                self.surfaces.push(SurfaceModel {
                    element: index,
                    field,
                    body,
                    marker: surface.marker,
                    modes,
                    content: surface.content.clone(),
                    pose: flexible.pose + 7,
                    velocity: flexible.velocity + 6,
                    first: before.map_or(0, |last| last.first + last.shapes),
                    shapes,
                });
            }
            kernels.push(kernel);
        }
        Ok(kernels)
    }

    /// See [`Model::length`]; one if nothing has a size.
    fn largest_length(&self) -> f64 {
        let mut length: f64 = 0.0;
        for (index, body) in self.bodies.iter().enumerate() {
            let center = body.center();
            length = length.max(center.norm());
            for m in self.markers.iter().filter(|m| m.body == Some(index)) {
                length = length
                    .max((m.position - center).norm())
                    .max(m.position.norm());
            }
        }
        // if all markers of the bodies lie at nearly one place, the size comes from the inertia
        let gyration = self
            .bodies
            .iter()
            .map(|body| libm::sqrt(body.inertia().amax() / body.mass()))
            .filter(|radius| radius.is_finite())
            .fold(0.0, f64::max);
        if length < POINTLIKE * gyration {
            length = gyration;
        }
        if length == 0.0 { 1.0 } else { length }
    }
}

/// The elastic surface of a marker, and its body.
fn surface_of(compiled: &Compiled, marker: usize) -> Option<(usize, &ReducedSurface)> {
    let system = &compiled.system;
    let marker = system.markers.get(marker)?;
    let BodyRef::Body(body) = marker.body else {
        return None;
    };
    let BodyInertia::Flexible(index) = &system.bodies.get(body as usize)?.inertia else {
        return None;
    };
    let reduced = compiled.reduced.get(*index as usize)?;
    let own = |surface: &&ReducedSurface| Some(surface.marker as u32) == marker.shape;
    Some((body as usize, reduced.surfaces.iter().find(own)?))
}

/// The position tolerance (m) of a model of this length (m).
fn position_tolerance(system: &System, slots: &Slots, length: f64) -> Result<f64, RuntimeError> {
    // a class can require finer positions than the model's length gives, never coarser ones: it does not know
    // the other classes of the model, and a length in a wrong unit would make the positions of all coarse
    let mut tolerance = TOLERANCE_OF_LENGTH * length;
    // a step at the usual tolerance must be able to keep its share of it
    let least = LEAST_ERROR * length / (STEP_SHARE * OF_RESOLUTION);
    for resolution in &system.resolutions {
        // the compiler adds a condition that each is positive
        let resolved = slots.get(resolution.length)?;
        if resolved < least {
            return Err(RuntimeError::Resolution {
                origin: Box::new(resolution.origin.clone()),
                length: resolved,
                least: 2.0 * least,
            });
        }
        tolerance = tolerance.min(OF_RESOLUTION * resolved);
    }
    Ok(tolerance)
}

/// Checks that channels and the cycle read existing outputs.
fn check_readers(system: &System, slots: &Slots) -> Result<(), RuntimeError> {
    let outputs = |element: u32| {
        let element = system.elements.get(element as usize)?;
        let class = system.classes.get(element.class as usize)?;
        Some(class.outputs.len())
    };
    for channel in &system.channels {
        if outputs(channel.element).is_none_or(|count| channel.output as usize >= count) {
            return Err(malformed(format!("{}: no such output", channel.path)));
        }
    }
    if let Some(cycle) = &system.cycle {
        // its angle and its rate
        let known = outputs(cycle.element).is_some_and(|count| count >= 2);
        if !known || slots.get(cycle.period)? <= 0.0 {
            return Err(malformed("the cycle has no angle, no rate or no period"));
        }
    }
    Ok(())
}

/// Checks that the functions of a class take and return as many numbers as its layout says.
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
        (
            Function::Kinks,
            if class.facts.kinks_read_accelerations {
                layout.outputs_len() as usize
            } else {
                common
            },
            class.kink_outputs(),
        ),
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

/// Whether squares of a place (m), and their products with masses and stiffnesses, are numbers.
fn is_measurable(place: &V3) -> bool {
    // a choice: its square is 1e200, which leaves 1e108 for a mass or a stiffness below the largest double
    place.amax() < 1e100
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
    if !is_measurable(&center) {
        return Err(refuse(&format!(
            "the centre of mass is {} m from the origin of the body, which is too far to compute with",
            short(center.norm(), 3)
        )));
    }
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
    let mut rising = [moments[0], moments[1], moments[2]];
    rising.sort_by(f64::total_cmp);
    let shown = format!("{} kg m²", rising.map(|m| short(m, 4)).join(", "));
    // rounding of a tensor in a text with nine digits or more
    if !largest.is_finite() || moments.iter().any(|m| *m < -1e-9 * largest) {
        return Err(refuse(&format!(
            "the inertia tensor has the principal moments {shown}; none may be negative: check signs and order of its numbers"
        )));
    }
    // a flat plate is exactly at the limit, and a tensor of a text may have seven digits. The compiler
    // compares stated principal moments more strictly
    if moments.iter().any(|m| 2.0 * m > trace * (1.0 + 1e-6)) {
        return Err(refuse(&format!(
            "the principal moments of inertia are {shown}: one exceeds the sum of the other two, which is impossible for a body"
        )));
    }
    let c = skew(&center);
    Ok(BodyKind::Rigid(Rigid {
        mass,
        center,
        inertia: about_center - c * c * mass,
    }))
}

/// The motion of a marker of a flexible body with the modes. A marker without a place on the mesh moves with
/// the frame.
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
