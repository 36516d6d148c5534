//! glTF 2.0, binary (Khronos Group, "glTF 2.0 Specification", 2021): mode shapes are morph targets, whose
//! weights over time are the modal amplitudes times the scale; poses move nodes. The file is exact within
//! single precision at the given times.

use super::film::PRESSURE;
use super::quaternion::{nearer, normalised, rotated};
use super::solid::Solid;
use super::{Animation, AnimationError, FilmSurface, FlexibleBody, Pose, Surface, Up, kind_of};
use serde_json::{Map, Value, json};

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const LINES: u32 = 1;
/// Colours of kinds of bodies in turn, linear; distinct in lightness, too.
const COLORS: [[f32; 4]; 6] = [
    [0.27, 0.42, 0.60, 1.0],
    [0.62, 0.62, 0.62, 1.0],
    [0.78, 0.48, 0.16, 1.0],
    [0.15, 0.45, 0.33, 1.0],
    [0.62, 0.32, 0.50, 1.0],
    [0.30, 0.30, 0.30, 1.0],
];

impl Animation {
    /// The bytes of a `.glb` file.
    ///
    /// Each body is a node below a node that turns the model's upward axis to y, the upward axis of glTF. The
    /// `extras` of bodies name modes and fields. A film has a morph target for each of its moments. The
    /// `extras` of the scene hold scale, slowdown, crank angles, and centre and radius of a ball around all
    /// bodies.
    ///
    /// # Errors
    /// Data that do not fit together, or more than 4 GiB of data.
    pub fn to_glb(&self) -> Result<Vec<u8>, AnimationError> {
        self.check()?;
        let mut file = File {
            kinds: self.kinds().into_iter().map(str::to_owned).collect(),
            ..File::default()
        };
        let time = self.times.first().copied().unwrap_or_default();
        let times: Vec<f32> = self
            .times
            .iter()
            .map(|t| ((t - time) * self.slowdown) as f32)
            .collect();
        let times = file.scalars(&times, true);
        for body in &self.flexible {
            file.flexible(body, times, self);
        }
        for body in &self.rigid {
            let mesh = file.solid(&Solid::of(&body.parts), &body.name);
            file.node(&body.name, mesh, &body.poses, times, json!({}));
        }
        for film in &self.films.surfaces {
            file.film(film, times, self);
        }
        let (center, radius) = self.bounds();
        let first = file.nodes.len();
        let rotation = self.up.rotation();
        file.nodes.push(json!({
            "name": "model",
            "children": (0..first).collect::<Vec<_>>(),
            "rotation": gltf_rotation(rotation),
        }));
        let extras = json!({
            "deformation_scale": self.scale,
            "slowdown": self.slowdown,
            "start": time,
            "times": self.times,
            "crank_angles": self.angles,
            "center": rotated(rotation, center),
            "radius": radius,
            "length_unit": "m",
        });
        file.finish(&self.title, first, extras)
    }

    /// Centre and radius of a ball around all undeformed bodies at all times, in the inertial axes (m).
    pub(super) fn bounds(&self) -> ([f64; 3], f64) {
        let solids: Vec<Solid> = self.rigid.iter().map(|b| Solid::of(&b.parts)).collect();
        let rigid = self.rigid.iter().zip(&solids).map(|(body, solid)| {
            let mut nodes = solid.surface.nodes.clone();
            nodes.extend(&solid.segments);
            (nodes, &body.poses)
        });
        let flexible = self
            .flexible
            .iter()
            .map(|body| (body.surface.nodes.clone(), &body.poses));
        let films = self.films.surfaces.iter();
        let films = films.map(|film| (film.surface.nodes.clone(), &film.poses));
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (nodes, poses) in flexible.chain(rigid).chain(films) {
            // 24 poses are enough for the ball
            let every = poses.len().div_ceil(24).max(1);
            for pose in poses.iter().step_by(every) {
                for node in &nodes {
                    let place = pose.place(*node);
                    for axis in 0..3 {
                        low[axis] = low[axis].min(place[axis]);
                        high[axis] = high[axis].max(place[axis]);
                    }
                }
            }
        }
        if !low.iter().chain(&high).all(|v| v.is_finite()) {
            return ([0.0; 3], 1.0);
        }
        let center = [0, 1, 2].map(|i| (low[i] + high[i]) / 2.0);
        let diagonal: f64 = (0..3)
            .map(|i| (high[i] - low[i]) * (high[i] - low[i]))
            .sum();
        // a model of one point has a radius (m), too, so that a viewer can set its distance. A choice
        (center, (diagonal.sqrt() / 2.0).max(1e-6))
    }
}

impl Up {
    /// Turns the upward axis to y.
    pub(super) fn rotation(self) -> [f64; 4] {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        match self {
            Up::X => [half, 0.0, 0.0, half],
            Up::Y => [1.0, 0.0, 0.0, 0.0],
            Up::Z => [half, -half, 0.0, 0.0],
        }
    }
}

/// (x, y, z, w).
fn gltf_rotation([w, x, y, z]: [f64; 4]) -> [f32; 4] {
    [x as f32, y as f32, z as f32, w as f32]
}

#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    nodes: Vec<Value>,
    samplers: Vec<Value>,
    channels: Vec<Value>,
    /// Kinds of bodies, which have a colour each.
    kinds: Vec<String>,
}

impl File {
    fn view(&mut self, bytes: impl Iterator<Item = [u8; 4]>, target: Option<u32>) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes.flatten());
        let mut view = json!({
            "buffer": 0,
            "byteOffset": offset,
            "byteLength": self.bytes.len() - offset,
        });
        if let (Some(target), Some(object)) = (target, view.as_object_mut()) {
            object.insert("target".to_owned(), json!(target));
        }
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, value: Value) -> usize {
        self.accessors.push(value);
        self.accessors.len() - 1
    }

    fn scalars(&mut self, values: &[f32], bounded: bool) -> usize {
        let view = self.view(values.iter().map(|v| v.to_le_bytes()), None);
        let mut accessor = json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": "SCALAR",
        });
        if let (true, Some(object)) = (bounded, accessor.as_object_mut()) {
            let low = values.iter().copied().fold(f32::INFINITY, f32::min);
            let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            object.insert("min".to_owned(), json!([low]));
            object.insert("max".to_owned(), json!([high]));
        }
        self.accessor(accessor)
    }

    /// Values at the nodes, one float each.
    fn node_scalars(&mut self, values: &[f64]) -> usize {
        let view = self.view(
            values.iter().map(|v| (*v as f32).to_le_bytes()),
            Some(34962),
        );
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": "SCALAR",
        }))
    }

    fn vectors(&mut self, values: &[[f64; 3]]) -> usize {
        let single: Vec<[f32; 3]> = values.iter().map(|v| v.map(|c| c as f32)).collect();
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for vector in &single {
            for axis in 0..3 {
                low[axis] = low[axis].min(vector[axis]);
                high[axis] = high[axis].max(vector[axis]);
            }
        }
        let view = self.view(
            single.iter().flatten().map(|v| v.to_le_bytes()),
            Some(34962),
        );
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": single.len(), "type": "VEC3",
            "min": low, "max": high,
        }))
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let view = self.view(indices.iter().map(|i| i.to_le_bytes()), Some(34963));
        self.accessor(json!({
            "bufferView": view, "componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR",
        }))
    }

    fn material(&mut self, name: &str) -> usize {
        let kind = self.kinds.iter().position(|kind| kind == kind_of(name));
        let color = COLORS[kind.unwrap_or(0) % COLORS.len()];
        self.materials.push(json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": {
                // a choice: dull and painted; bright metal would reflect surroundings that a page does not
                // have
                "baseColorFactor": color, "metallicFactor": 0.1, "roughnessFactor": 0.7,
            },
        }));
        self.materials.len() - 1
    }

    fn triangles(&mut self, surface: &Surface) -> Option<Map<String, Value>> {
        if surface.triangles.is_empty() {
            return None;
        }
        let position = self.vectors(&surface.nodes);
        let indices: Vec<u32> = surface.triangles.iter().flatten().copied().collect();
        let indices = self.indices(&indices);
        let mut primitive = Map::new();
        primitive.insert("attributes".to_owned(), json!({ "POSITION": position }));
        primitive.insert("indices".to_owned(), json!(indices));
        Some(primitive)
    }

    fn flexible(&mut self, body: &FlexibleBody, times: usize, animation: &Animation) {
        let mut extras = json!({});
        let mesh = self.triangles(&body.surface).map(|mut primitive| {
            let material = self.material(&body.name);
            primitive.insert("material".to_owned(), json!(material));
            let targets: Vec<Value> = body
                .shapes
                .iter()
                .map(|shape| json!({ "POSITION": self.vectors(&shape.displacements) }))
                .collect();
            let mut fields = Vec::new();
            for (index, field) in body.fields.iter().enumerate() {
                // application-specific attributes start with an underscore
                let attribute = format!("_FIELD_{index}");
                let accessor = self.node_scalars(&field.values);
                let low = field.values.iter().copied().fold(f64::INFINITY, f64::min);
                let high = field
                    .values
                    .iter()
                    .copied()
                    .fold(f64::NEG_INFINITY, f64::max);
                if let Some(attributes) = primitive
                    .get_mut("attributes")
                    .and_then(Value::as_object_mut)
                {
                    attributes.insert(attribute.clone(), json!(accessor));
                }
                fields.push(json!({
                    "attribute": attribute, "name": field.name, "unit": field.unit,
                    "low": low, "high": high,
                }));
            }
            let names: Vec<&str> = body.shapes.iter().map(|s| s.name.as_str()).collect();
            extras = json!({
                "fields": fields,
                "largest_displacement": body.largest_displacement(),
            });
            let mut mesh = Map::new();
            mesh.insert("name".to_owned(), json!(body.name));
            if !targets.is_empty() {
                primitive.insert("targets".to_owned(), Value::Array(targets));
                mesh.insert("weights".to_owned(), json!(vec![0.0; body.shapes.len()]));
                mesh.insert("extras".to_owned(), json!({ "targetNames": names }));
            }
            mesh.insert("primitives".to_owned(), json!([primitive]));
            self.meshes.push(Value::Object(mesh));
            self.meshes.len() - 1
        });
        let node = self.node(&body.name, mesh, &body.poses, times, extras);
        if mesh.is_some() && !body.shapes.is_empty() {
            let weights: Vec<f32> = body
                .amplitudes
                .iter()
                .flatten()
                .map(|a| (a * animation.scale) as f32)
                .collect();
            let output = self.scalars(&weights, false);
            self.channel(node, "weights", times, output);
        }
    }

    fn film(&mut self, film: &FilmSurface, times: usize, animation: &Animation) {
        let Some(mut primitive) = self.triangles(&film.surface) else {
            return;
        };
        let films = &animation.films;
        let [low, high] = films.range();
        let hills = film.pressures.iter().map(|p| films.hill(film, p));
        let targets: Vec<Value> = hills
            .map(|hill| json!({ "POSITION": self.vectors(&hill) }))
            .collect();
        let names: Vec<String> = film
            .moments
            .iter()
            .filter_map(|moment| animation.times.get(*moment))
            .map(|time| format!("pressure at {:.3} ms", 1e3 * time))
            .collect();
        let material = self.material(&film.name);
        primitive.insert("material".to_owned(), json!(material));
        primitive.insert("targets".to_owned(), Value::Array(targets));
        self.meshes.push(json!({
            "name": film.name,
            "weights": vec![0.0; film.moments.len()],
            "extras": { "targetNames": names },
            "primitives": [primitive],
        }));
        let mesh = self.meshes.len() - 1;
        let extras = json!({ "film": {
            "name": PRESSURE, "unit": films.unit, "low": low, "high": high, "height": films.height,
        }});
        let node = self.node(&film.name, Some(mesh), &film.poses, times, extras);
        let shares = (0..animation.times.len()).flat_map(|time| film.shares(time));
        let weights: Vec<f32> = shares.map(|share| share as f32).collect();
        let output = self.scalars(&weights, false);
        self.channel(node, "weights", times, output);
    }

    fn solid(&mut self, solid: &Solid, name: &str) -> Option<usize> {
        let material = self.material(name);
        let mut primitives = Vec::new();
        if let Some(mut primitive) = self.triangles(&solid.surface) {
            primitive.insert("material".to_owned(), json!(material));
            primitives.push(Value::Object(primitive));
        }
        if !solid.segments.is_empty() {
            let position = self.vectors(&solid.segments);
            primitives.push(json!({
                "attributes": { "POSITION": position }, "mode": LINES, "material": material,
            }));
        }
        if primitives.is_empty() {
            return None;
        }
        self.meshes
            .push(json!({ "name": name, "primitives": primitives }));
        Some(self.meshes.len() - 1)
    }

    fn node(
        &mut self,
        name: &str,
        mesh: Option<usize>,
        poses: &[Pose],
        times: usize,
        extras: Value,
    ) -> usize {
        let index = self.nodes.len();
        let first = poses.first().copied().unwrap_or(Pose::HOME);
        let mut node = json!({
            "name": name,
            "translation": first.position.map(|c| c as f32),
            "rotation": gltf_rotation(normalised(first.rotation)),
            "extras": extras,
        });
        if let (Some(mesh), Some(object)) = (mesh, node.as_object_mut()) {
            object.insert("mesh".to_owned(), json!(mesh));
        }
        self.nodes.push(node);
        if poses.len() > 1 {
            let places: Vec<[f64; 3]> = poses.iter().map(|pose| pose.position).collect();
            let mut rotations = Vec::with_capacity(poses.len());
            let mut before = normalised(first.rotation);
            for pose in poses {
                before = nearer(before, normalised(pose.rotation));
                rotations.push(gltf_rotation(before));
            }
            let translation = self.animated(places.iter().map(|p| p.map(|c| c as f32)), "VEC3");
            let rotation = self.animated(rotations.into_iter(), "VEC4");
            self.channel(index, "translation", times, translation);
            self.channel(index, "rotation", times, rotation);
        }
        index
    }

    fn animated<const N: usize>(
        &mut self,
        values: impl Iterator<Item = [f32; N]>,
        kind: &str,
    ) -> usize {
        let values: Vec<f32> = values.flatten().collect();
        let view = self.view(values.iter().map(|v| v.to_le_bytes()), None);
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len() / N, "type": kind,
        }))
    }

    fn channel(&mut self, node: usize, path: &str, input: usize, output: usize) {
        self.samplers
            .push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        self.channels.push(json!({
            "sampler": self.samplers.len() - 1,
            "target": { "node": node, "path": path },
        }));
    }

    fn finish(self, title: &str, root: usize, extras: Value) -> Result<Vec<u8>, AnimationError> {
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("eng ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "name": title, "nodes": [root], "extras": extras }],
            "nodes": self.nodes,
            "buffers": [{ "byteLength": self.bytes.len() }],
            "bufferViews": self.views,
            "accessors": self.accessors,
        });
        if let Some(object) = document.as_object_mut() {
            // lists in glTF must not be empty
            for (name, list) in [("meshes", self.meshes), ("materials", self.materials)] {
                if !list.is_empty() {
                    object.insert(name.to_owned(), Value::Array(list));
                }
            }
            if !self.channels.is_empty() {
                let animation = json!([{
                    "name": title, "samplers": self.samplers, "channels": self.channels,
                }]);
                object.insert("animations".to_owned(), animation);
            }
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = self.bytes;
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        let total = 12 + 8 + text.len() as u64 + 8 + bytes.len() as u64;
        let Ok(length) = u32::try_from(total) else {
            return Err(AnimationError::TooLarge { bytes: total });
        };
        let mut file = Vec::with_capacity(length as usize);
        file.extend(b"glTF");
        file.extend(2u32.to_le_bytes());
        file.extend(length.to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bytes)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        Ok(file)
    }
}
