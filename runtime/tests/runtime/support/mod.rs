//! Hand-made element classes over nested dual numbers, and a builder of systems.

#![allow(dead_code)]

pub mod classes;
pub mod dual;

use dual::{Dual, Scalar};
use eng_system::code::{BindCode, BindError, Bound, Compiled, ElementCode, Function, Pair};
use eng_system::dimension::{Dimension, DisplayUnit};
use eng_system::layout::InputLayout;
use eng_system::reduced::ReducedBody;
use eng_system::system::*;
use eng_system::table::Table;
use std::fmt::Debug;
use std::sync::Arc;

pub type Vec3<S> = [S; 3];

pub fn dot<S: Scalar>(a: Vec3<S>, b: Vec3<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
pub fn cross<S: Scalar>(a: Vec3<S>, b: Vec3<S>) -> Vec3<S> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
pub fn minus<S: Scalar>(a: Vec3<S>, b: Vec3<S>) -> Vec3<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
pub fn times<S: Scalar>(a: Vec3<S>, f: S) -> Vec3<S> {
    a.map(|x| x * f)
}

#[derive(Clone, Copy, Debug)]
pub struct MarkerIn<S> {
    pub x: Vec3<S>,
    pub r: [[S; 3]; 3],
    pub v: Vec3<S>,
    pub w: Vec3<S>,
}

impl<S: Scalar> MarkerIn<S> {
    pub fn axis(&self, i: usize) -> Vec3<S> {
        [self.r[0][i], self.r[1][i], self.r[2][i]]
    }
    /// Angular velocity in inertial axes.
    pub fn spin(&self) -> Vec3<S> {
        let row = |i: usize| dot(self.r[i], self.w);
        [row(0), row(1), row(2)]
    }
    /// An inertial vector in marker axes.
    pub fn local(&self, v: Vec3<S>) -> Vec3<S> {
        [
            dot(self.axis(0), v),
            dot(self.axis(1), v),
            dot(self.axis(2), v),
        ]
    }
    /// Moved along δx, δπ (marker axes), δẋ, δω by the dual unit.
    pub fn moved(&self, seed: [S; 12]) -> MarkerIn<Dual<S>> {
        let [p, q, s] = [seed[3], seed[4], seed[5]];
        let lift = |a: Vec3<S>, at: usize| {
            [0, 1, 2].map(|i| Dual {
                re: a[i],
                du: seed[at + i],
            })
        };
        let turned = |row: [S; 3]| -> [Dual<S>; 3] {
            let t = [
                row[1] * s - row[2] * q,
                row[2] * p - row[0] * s,
                row[0] * q - row[1] * p,
            ];
            [0, 1, 2].map(|i| Dual {
                re: row[i],
                du: t[i],
            })
        };
        MarkerIn {
            x: lift(self.x, 0),
            r: self.r.map(turned),
            v: lift(self.v, 6),
            w: lift(self.w, 9),
        }
    }
}

#[derive(Clone, Debug)]
pub struct In<S> {
    pub time: S,
    pub m: Vec<MarkerIn<S>>,
    pub y: Vec<S>,
    pub references: Vec<f64>,
    pub multipliers: Vec<f64>,
    pub c: Vec<f64>,
}

pub trait Definition: Send + Sync + Debug + 'static {
    fn layout(&self) -> InputLayout;
    fn rows<S: Scalar>(&self, _: &In<S>) -> Vec<S> {
        Vec::new()
    }
    fn loads<S: Scalar>(&self, i: &In<S>) -> Vec<[S; 6]> {
        vec![[S::constant(0.0); 6]; i.m.len()]
    }
    fn rates<S: Scalar>(&self, _: &In<S>) -> Vec<S> {
        Vec::new()
    }
    /// `extra`: accelerations (6 a marker), rates, signals.
    fn outputs(&self, _: &In<f64>, _extra: &[f64]) -> Vec<f64> {
        Vec::new()
    }
    fn conditions(&self, _: &In<f64>) -> Vec<f64> {
        Vec::new()
    }
    fn rotations(&self, _: &In<f64>) -> Vec<f64> {
        Vec::new()
    }
    /// Texts and kinds of the conditions, texts and dimensions of the rows, names of outputs.
    fn describe(&self, class: &mut ElementClass);
}

#[derive(Debug)]
struct Code<D> {
    definition: D,
    layout: InputLayout,
    outputs: usize,
    conditions: usize,
}

fn read(layout: &InputLayout, inputs: &[Pair], lane: usize) -> In<f64> {
    let get = |i: u32| inputs[i as usize][lane];
    let m = (0..layout.markers)
        .map(|k| {
            let at = layout.marker(k);
            let three = |o: u32| [get(at + o), get(at + o + 1), get(at + o + 2)];
            MarkerIn {
                x: three(0),
                r: [three(3), three(6), three(9)],
                v: three(12),
                w: three(15),
            }
        })
        .collect();
    In {
        time: get(0),
        m,
        y: (0..layout.states).map(|k| get(layout.state(k))).collect(),
        references: (0..layout.rotations)
            .map(|k| get(layout.rotation(k)))
            .collect(),
        multipliers: (0..layout.rows)
            .map(|k| get(layout.multiplier(k)))
            .collect(),
        c: (0..layout.constants)
            .map(|k| get(layout.constant(k)))
            .collect(),
    }
}

fn moved<S: Scalar>(i: &In<S>, time: S, seeds: &[[S; 12]], states: &[S]) -> In<Dual<S>> {
    In {
        time: Dual {
            re: i.time,
            du: time,
        },
        m: i.m.iter().zip(seeds).map(|(m, s)| m.moved(*s)).collect(),
        y: i.y
            .iter()
            .zip(states)
            .map(|(y, s)| Dual { re: *y, du: *s })
            .collect(),
        references: i.references.clone(),
        multipliers: i.multipliers.clone(),
        c: i.c.clone(),
    }
}

fn zero<S: Scalar>() -> [S; 12] {
    [S::constant(0.0); 12]
}

impl<D: Definition> Code<D> {
    fn residual<S: Scalar>(&self, i: &In<S>) -> Vec<S> {
        let mut out = self.definition.rows(i);
        let mut loads = self.definition.loads(i);
        let states = vec![S::constant(0.0); i.y.len()];
        if !out.is_empty() {
            for (k, load) in loads.iter_mut().enumerate() {
                for (d, w) in load.iter_mut().enumerate() {
                    let mut seeds = vec![zero(); i.m.len()];
                    seeds[k][d] = S::constant(1.0);
                    let rows = self
                        .definition
                        .rows(&moved(i, S::constant(0.0), &seeds, &states));
                    for (row, multiplier) in rows.iter().zip(&i.multipliers) {
                        *w = *w - row.du * S::constant(*multiplier);
                    }
                }
            }
        }
        out.extend(loads.into_iter().flatten());
        out.extend(self.definition.rates(i));
        out
    }

    fn velocity(&self, i: &In<f64>) -> Vec<f64> {
        let along = |m: &MarkerIn<f64>| {
            let mut s = zero();
            s[..3].copy_from_slice(&m.v);
            s[3..6].copy_from_slice(&m.w);
            s
        };
        let seeds: Vec<[f64; 12]> = i.m.iter().map(along).collect();
        let states = vec![0.0; i.y.len()];
        let once = moved(i, 1.0, &seeds, &states);
        let lifted: Vec<[Dual<f64>; 12]> = seeds.iter().map(|s| s.map(Dual::constant)).collect();
        let twice = moved(
            &once,
            Dual::constant(1.0),
            &lifted,
            &states
                .iter()
                .map(|s| Dual::constant(*s))
                .collect::<Vec<_>>(),
        );
        let rows = self.definition.rows(&twice);
        let mut out: Vec<f64> = rows.iter().map(|r| r.re.du).collect();
        out.extend(rows.iter().map(|r| -r.du.du));
        out
    }
}

impl<D: Definition> ElementCode for Code<D> {
    fn shape(&self, function: Function) -> (usize, usize) {
        let l = &self.layout;
        let common = l.len() as usize;
        match function {
            Function::Residual => (common, l.residual_len() as usize),
            Function::Linearize => (common, common),
            Function::Tangent => (common + l.directions() as usize, l.residual_len() as usize),
            Function::Velocity => (common, 2 * l.rows as usize),
            Function::Outputs => (l.outputs_len() as usize, self.outputs),
            Function::Conditions => (common, self.conditions),
            Function::Rotations => (common, l.rotations as usize),
            Function::Kinks => (common, 0),
        }
    }

    fn call(&self, function: Function, inputs: &[Pair], outputs: &mut [Pair], _: &[Table]) -> bool {
        let (taken, given) = self.shape(function);
        if inputs.len() < taken || outputs.len() < given {
            return false;
        }
        if function == Function::Linearize {
            outputs[..given].copy_from_slice(&inputs[..given]);
            return true;
        }
        let l = &self.layout;
        let common = l.len() as usize;
        for lane in 0..2 {
            let i = read(l, inputs, lane);
            let out = match function {
                Function::Residual => self.residual(&i),
                Function::Tangent => {
                    let seed = |d: u32| inputs[common + d as usize][lane];
                    let seeds: Vec<[f64; 12]> = (0..l.markers)
                        .map(|k| {
                            let mut s = [0.0; 12];
                            for d in 0..6 {
                                s[d as usize] = seed(l.pose_direction(k) + d);
                                s[6 + d as usize] = seed(l.twist_direction(k) + d);
                            }
                            s
                        })
                        .collect();
                    let states: Vec<f64> =
                        (0..l.states).map(|k| seed(l.state_direction(k))).collect();
                    self.residual(&moved(&i, 0.0, &seeds, &states))
                        .iter()
                        .map(|x| x.du)
                        .collect()
                }
                Function::Velocity => self.velocity(&i),
                Function::Outputs => {
                    let extra: Vec<f64> = inputs[common..taken].iter().map(|x| x[lane]).collect();
                    self.definition.outputs(&i, &extra)
                }
                Function::Conditions => self.definition.conditions(&i),
                Function::Rotations => self.definition.rotations(&i),
                Function::Linearize | Function::Kinks => Vec::new(),
            };
            assert_eq!(out.len(), given, "{function:?}");
            for (o, x) in outputs.iter_mut().zip(out) {
                o[lane] = x;
            }
        }
        true
    }

    fn function_bytes(&self, _: Function) -> usize {
        0
    }
}

#[derive(Debug)]
struct Literal(Vec<f64>);

impl BindCode for Literal {
    fn bind(&self, _: &[Option<f64>], _: &[Table]) -> Result<Bound, BindError> {
        Ok(Bound {
            slots: self.0.clone(),
            parameters: Vec::new(),
            advice: Vec::new(),
            nodes: Vec::new(),
        })
    }
}

pub const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// Marker z along inertial or body x: columns are the axes.
pub const Z_ALONG_X: [f64; 9] = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

pub struct Builder {
    pub system: System,
    pub reduced: Vec<Arc<ReducedBody>>,
    code: Vec<Arc<dyn ElementCode>>,
    slots: Vec<f64>,
}

pub struct BodySpec {
    pub mass: f64,
    pub center: [f64; 3],
    pub inertia: [f64; 3],
    pub place: Option<([f64; 3], [f64; 9])>,
}

impl Builder {
    pub fn new(gravity: [f64; 3]) -> Builder {
        let mut b = Builder {
            system: System {
                name: "test".into(),
                bodies: vec![],
                markers: vec![],
                parameters: vec![],
                inputs: vec![],
                moving: vec![],
                slots: 0,
                classes: vec![],
                elements: vec![],
                channels: vec![],
                tables: vec![],
                gravity: [Slot(0); 3],
                cycle: None,
                journals: vec![],
                firings: vec![],
                followed: vec![],
                summaries: vec![],
                resolutions: vec![],
                accepted: vec![],
                stated: Default::default(),
                parts: vec![],
                repeated: Default::default(),
            },
            reduced: vec![],
            code: vec![],
            slots: vec![],
        };
        b.system.gravity = b.three(gravity);
        b
    }
    pub fn slot(&mut self, x: f64) -> Slot {
        self.slots.push(x);
        Slot(self.slots.len() as u32 - 1)
    }
    fn three(&mut self, x: [f64; 3]) -> [Slot; 3] {
        x.map(|x| self.slot(x))
    }
    pub fn body(&mut self, path: &str, spec: BodySpec) -> u32 {
        let mass = self.slot(spec.mass);
        let center_of_mass = self.three(spec.center);
        let [x, y, z] = spec.inertia;
        let inertia = [x, y, z, 0.0, 0.0, 0.0].map(|v| self.slot(v));
        let (position, orientation) = match spec.place {
            Some((p, o)) => (Some(self.three(p)), Some(o.map(|v| self.slot(v)))),
            None => (None, None),
        };
        self.system.bodies.push(Body {
            origin: origin(path),
            inertia: BodyInertia::Rigid {
                mass,
                center_of_mass,
                inertia,
            },
            position,
            orientation,
            guessed_at: Vec::new(),
        });
        self.system.bodies.len() as u32 - 1
    }
    /// A flexible body with its markers, in the order of the reduction.
    pub fn flexible(
        &mut self,
        path: &str,
        reduced: ReducedBody,
        place: ([f64; 3], [f64; 9]),
        axes: &[[f64; 9]],
    ) -> (u32, Vec<u32>) {
        let (position, orientation) = (self.three(place.0), place.1.map(|v| self.slot(v)));
        self.reduced.push(Arc::new(reduced));
        self.system.bodies.push(Body {
            origin: origin(path),
            inertia: BodyInertia::Flexible(self.reduced.len() as u32 - 1),
            position: Some(position),
            orientation: Some(orientation),
            guessed_at: Vec::new(),
        });
        let body = self.system.bodies.len() as u32 - 1;
        let mut markers = Vec::new();
        for (index, axes) in axes.iter().enumerate() {
            let marker = self.marker(&format!("{path}.{index}"), Some(body), [0.0; 3], *axes);
            self.system.markers[marker as usize].shape = Some(index as u32);
            markers.push(marker);
        }
        (body, markers)
    }
    pub fn marker(
        &mut self,
        path: &str,
        body: Option<u32>,
        position: [f64; 3],
        orientation: [f64; 9],
    ) -> u32 {
        let position = self.three(position);
        let orientation = orientation.map(|v| self.slot(v));
        self.system.markers.push(Marker {
            origin: origin(path),
            body: body.map_or(BodyRef::Ground, BodyRef::Body),
            position,
            orientation,
            shape: None,
            placed_at: None,
        });
        self.system.markers.len() as u32 - 1
    }
    pub fn class<D: Definition>(&mut self, name: &str, definition: D) -> u32 {
        let layout = definition.layout();
        let mut class = ElementClass {
            name: name.into(),
            layout,
            rows: vec![],
            states: (0..layout.states)
                .map(|k| StateInfo {
                    name: format!("y{k}"),
                    dimension: Dimension::ONE,
                })
                .collect(),
            outputs: vec![],
            conditions: vec![],
            kinks: vec![],
            facts: ClassFacts {
                kinks_read_accelerations: false,
                kink_phases: 0,
                uses_twist: true,
                applies_load: true,
                loads_over_time: true,
                rows_over_time: false,
                conditions_read_fields: false,
                differentiated: vec![true; layout.answers as usize],
            },
            tape: layout.len(),
        };
        definition.describe(&mut class);
        self.code.push(Arc::new(Code {
            definition,
            layout,
            outputs: class.outputs.len(),
            conditions: class.conditions.len(),
        }));
        self.system.classes.push(class);
        self.system.classes.len() as u32 - 1
    }
    pub fn element(
        &mut self,
        path: &str,
        class: u32,
        role: Role,
        markers: &[u32],
        constants: &[f64],
        start: &[f64],
    ) -> u32 {
        let constants = constants.iter().map(|c| self.slot(*c)).collect();
        let state_start = start.iter().map(|c| self.slot(*c)).collect();
        let state_scale = start
            .iter()
            .map(|c| self.slot(if *c == 0.0 { 1.0 } else { c.abs() }))
            .collect();
        let layout = &self.system.classes[class as usize].layout;
        let rotations = (0..layout.rotations)
            .map(|_| Rotation {
                turning: 0,
                reference: 1,
                stated: None,
            })
            .collect();
        self.system.elements.push(Element {
            origin: origin(path),
            class,
            role,
            markers: markers.to_vec(),
            constants,
            state_start,
            state_scale,
            resolves: vec![],
            places: vec![],
            signals: vec![],
            fields: vec![],
            rotations,
        });
        self.system.elements.len() as u32 - 1
    }
    /// Channels for all outputs of an element; the index of the first.
    pub fn channels(&mut self, element: u32) -> usize {
        let first = self.system.channels.len();
        let e = self.system.elements[element as usize].clone();
        for (k, output) in self.system.classes[e.class as usize]
            .outputs
            .iter()
            .enumerate()
        {
            self.system.channels.push(Channel {
                path: format!("{}.{}", e.origin.path, output.name),
                element,
                output: k as u32,
                dimension: output.dimension,
                display: output.display.clone(),
                frame: String::new(),
                continuous: true,
            });
        }
        first
    }
    pub fn cycle(&mut self, element: u32, period: f64) {
        let period = self.slot(period);
        self.system.cycle = Some(Cycle {
            origin: origin("cycle"),
            element,
            period,
        });
    }
    pub fn finish(mut self) -> Compiled {
        self.system.slots = self.slots.len() as u32;
        Compiled {
            system: Arc::new(self.system),
            code: self.code,
            bind: Arc::new(Literal(self.slots)),
            reduced: self.reduced,
            fields: Arc::new(eng_system::field::NoFields),
            threads: std::num::NonZeroUsize::MIN,
        }
    }
}

pub fn origin(path: &str) -> Origin {
    Origin {
        path: path.into(),
        used_at: None,
        defined_at: None,
    }
}

pub fn row(text: &str, dimension: Dimension) -> Row {
    Row {
        text: text.into(),
        dimension,
        defined_at: None,
    }
}

pub fn output(name: &str) -> OutputInfo {
    OutputInfo {
        name: name.into(),
        dimension: Dimension::ONE,
        display: DisplayUnit::si(Dimension::ONE),
        frame: String::new(),
        depth: eng_system::system::Depth::Acceleration,
    }
}

pub fn condition(kind: ConditionKind, text: &str) -> Condition {
    Condition {
        name: String::new(),
        kind,
        text: text.into(),
        message: Vec::new(),
        dimension: None,
        defined_at: None,
    }
}
