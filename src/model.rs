//! Compiled models, and handles to their parameters and channels.

use crate::counted::counted;
use crate::places::without_places;
use crate::{Error, Quantity, Report};
use eng_compiler::elaborate::{BindProgram, Elaborated};
use eng_compiler::models::SharedModel;
use eng_grammar::{Diagnostics, SourceMap, nearest};
use eng_system::code::{Compiled, Function};
use eng_system::input::Interpolation;
use eng_system::system::{Body, BodyInertia};
use eng_system::{Dimension, DisplayUnit};
use std::num::NonZeroUsize;
use std::sync::{Arc, OnceLock};

/// A compiled model. Cheap to clone; clones on several threads share the code.
#[derive(Clone, Debug)]
pub struct Model {
    compiled: Compiled,
    texts: Arc<SourceMap>,
    reductions: Arc<[crate::Reduction]>,
    /// Its system with all graphs.
    shared: Arc<SharedModel>,
    /// Equal for models with interchangeable handles.
    handles: u64,
    /// [`Model::system_hash`], when a run has asked for it.
    system_hash: Arc<OnceLock<String>>,
    /// [`Model::numbers_hash`], when it was asked for.
    numbers_hash: Arc<OnceLock<String>>,
}

/// A number of a model that can change without compiling again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    pub(crate) index: usize,
    /// The model that gave it.
    model: u64,
}

/// A column of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    index: usize,
    /// The model that gave it.
    model: u64,
}

/// A number of a model that a program sets while a simulation runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    pub(crate) index: usize,
    /// Its start value.
    pub(crate) parameter: Parameter,
    /// The model that gave it.
    model: u64,
}

/// Description of an input.
#[derive(Clone, Debug, PartialEq)]
pub struct InputInfo {
    /// `brake`.
    pub path: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
    pub display: DisplayUnit,
    /// Open limits (SI).
    pub limits: (f64, f64),
    /// Its values between two points.
    pub interpolation: Interpolation,
    /// Name of the function of time in the text that gives its values.
    pub signal: Option<String>,
}

/// Description of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterInfo {
    /// `main[5].radial_clearance`.
    pub path: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
    pub display: DisplayUnit,
    /// Open limits (SI).
    pub limits: (f64, f64),
}

/// Description of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelInfo {
    /// `main[5].force.x`.
    pub path: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
    pub display: DisplayUnit,
    /// The axes of a component, as a path; empty for a scalar.
    pub frame: String,
}

impl Input {
    /// The parameter that gives its start value.
    pub fn parameter(self) -> Parameter {
        self.parameter
    }
}

impl Model {
    pub(crate) fn new(
        compiled: Compiled,
        texts: Arc<SourceMap>,
        reductions: Vec<crate::Reduction>,
        shared: Arc<SharedModel>,
    ) -> Model {
        Model {
            handles: fingerprint(&compiled.system),
            compiled,
            texts,
            reductions: reductions.into(),
            shared,
            system_hash: Arc::default(),
            numbers_hash: Arc::default(),
        }
    }

    /// SHA-256 of its system, as hexadecimal digits. A system is large, and all points of a sweep share it.
    pub(crate) fn system_hash(&self) -> &str {
        self.system_hash.get_or_init(|| {
            use sha2::Digest;
            hexadecimal(&sha2::Sha256::digest(format!("{:?}", self.compiled.system)))
        })
    }

    /// SHA-256 of its system, of the graphs of its classes and parameters, and of the sources of its flexible bodies, as
    /// hexadecimal digits. Places in the text are left out: a comment that moves them changes no number.
    pub(crate) fn numbers_hash(&self) -> &str {
        self.numbers_hash.get_or_init(|| {
            use sha2::Digest;
            let Elaborated {
                system,
                classes,
                // the functions of the classes follow from them
                bodies: _,
                bind,
                flexible,
            } = &self.shared.elaborated;
            let mut hash = sha2::Sha256::new();
            let mut add = |text: String| hash.update(without_places(&text));
            add(format!("{system:?} {flexible:?}"));
            for class in classes {
                for function in Function::ALL.map(|which| class.get(which)) {
                    let nodes = function.graph.nodes();
                    add(format!(
                        "{} {:?} {nodes:?}",
                        function.inputs, function.outputs
                    ));
                }
                add(format!(
                    "{:?} {:?}",
                    class.kink_places, class.kinds_of_kinks
                ));
            }
            let BindProgram {
                function,
                fixed,
                slot_owners,
                defaults,
                rates,
                parameters,
                checks,
                turned,
                moving,
                moving_slots,
            } = &**bind;
            let nodes = function.graph.nodes();
            add(format!("{:?} {nodes:?} {fixed:?}", function.outputs));
            add(format!("{slot_owners:?} {defaults:?} {rates:?}"));
            add(format!("{parameters:?} {checks:?} {turned:?}"));
            add(format!("{moving:?} {moving_slots:?}"));
            hexadecimal(&hash.finalize())
        })
    }

    /// The reductions of its flexible bodies.
    pub fn reductions(&self) -> &[crate::Reduction] {
        &self.reductions
    }

    /// Lets so many threads solve the films on cells of a simulation side by side. It changes no bit of a
    /// result. Without this there is one thread.
    #[must_use]
    pub fn threads(mut self, threads: NonZeroUsize) -> Model {
        self.compiled.threads = threads;
        self
    }

    pub(crate) fn compiled(&self) -> &Compiled {
        &self.compiled
    }

    pub(crate) fn texts(&self) -> &Arc<SourceMap> {
        &self.texts
    }

    /// The model's name.
    pub fn name(&self) -> &str {
        &self.compiled.system.name
    }

    /// The parameter with a path.
    pub fn parameter(&self, path: &str) -> Result<Parameter, Error> {
        let all = &self.compiled.system.parameters;
        match all.iter().position(|p| p.origin.path == path) {
            Some(index) => Ok(Parameter {
                index,
                model: self.handles,
            }),
            None => Err(Error::NoParameter {
                path: path.to_owned(),
                nearest: nearest(path, all.iter().map(|p| p.origin.path.as_str()))
                    .map(str::to_owned),
            }),
        }
    }

    /// The input with a path.
    pub fn input(&self, path: &str) -> Result<Input, Error> {
        let system = &self.compiled.system;
        let path_of = |input: &eng_system::input::Input| {
            let parameter = system.parameters.get(input.parameter as usize);
            parameter.map_or("", |parameter| parameter.origin.path.as_str())
        };
        let inputs = &system.inputs;
        match inputs.iter().position(|input| path_of(input) == path) {
            Some(index) => Ok(Input {
                index,
                parameter: Parameter {
                    index: inputs[index].parameter as usize,
                    model: self.handles,
                },
                model: self.handles,
            }),
            None => match system.parameters.iter().find(|p| p.origin.path == path) {
                Some(parameter) => {
                    let message = crate::failure::no_input(parameter);
                    let mut diagnostics = Diagnostics::new();
                    diagnostics.push(message);
                    Err(Error::Report(Report::new(self.texts.clone(), diagnostics)))
                }
                None => Err(Error::NoInput {
                    path: path.to_owned(),
                    nearest: nearest(path, inputs.iter().map(path_of)).map(str::to_owned),
                }),
            },
        }
    }

    /// All inputs, in a fixed order.
    pub fn inputs(&self) -> Vec<InputInfo> {
        let parameters = self.parameters();
        let inputs = self.compiled.system.inputs.iter();
        inputs
            .filter_map(|input| {
                let parameter = parameters.get(input.parameter as usize)?;
                Some(InputInfo {
                    path: parameter.path.clone(),
                    dimension: parameter.dimension,
                    display: parameter.display.clone(),
                    limits: parameter.limits,
                    interpolation: input.interpolation,
                    signal: input.signal.clone(),
                })
            })
            .collect()
    }

    /// The channel with a path.
    pub fn channel(&self, path: &str) -> Result<Channel, Error> {
        let all = &self.compiled.system.channels;
        match all.iter().position(|c| c.path == path) {
            Some(index) => Ok(Channel {
                index,
                model: self.handles,
            }),
            None => Err(Error::NoChannel {
                path: path.to_owned(),
                nearest: nearest(path, all.iter().map(|c| c.path.as_str())).map(str::to_owned),
            }),
        }
    }

    /// All parameters, in a fixed order.
    pub fn parameters(&self) -> Vec<ParameterInfo> {
        let parameters = self.compiled.system.parameters.iter();
        parameters.map(described).collect()
    }

    /// The description of a parameter.
    ///
    /// # Errors
    /// A parameter of another model.
    pub fn describe(&self, parameter: Parameter) -> Result<ParameterInfo, Error> {
        let parameters = &self.compiled.system.parameters;
        let own = parameters.get(parameter.index);
        let own = own.filter(|_| parameter.model == self.handles);
        own.map(described).ok_or(Error::OtherModel)
    }

    /// All channels, in a fixed order.
    pub fn channels(&self) -> Vec<ChannelInfo> {
        self.compiled
            .system
            .channels
            .iter()
            .map(|c| ChannelInfo {
                path: c.path.clone(),
                dimension: c.dimension,
                display: c.display.clone(),
                frame: c.frame.clone(),
            })
            .collect()
    }

    /// One line: bodies, elements, unknowns, journals, bytes of code.
    pub fn summary(&self) -> String {
        let system = &self.compiled.system;
        let dynamic = || {
            system
                .elements
                .iter()
                .filter(|e| e.role == eng_system::system::Role::Dynamic)
        };
        let classes: std::collections::BTreeSet<u32> = dynamic().map(|e| e.class).collect();
        let rows: usize = dynamic()
            .map(|e| system.classes[e.class as usize].rows.len())
            .sum();
        let modes: usize = self
            .compiled
            .reduced
            .iter()
            .map(|b| b.invariants.modes)
            .sum();
        let bytes: usize = self.compiled.code.iter().map(|c| c.code_bytes()).sum();
        format!(
            "{}: {} with {}{}, {} of {}, {}, {}, {}{}, {}; {} kB of machine code",
            system.name,
            counted(system.bodies.len(), "body", "bodies"),
            counted(6 * system.bodies.len() + modes, "velocity", "velocities"),
            self.besides(),
            counted(dynamic().count(), "element", "elements"),
            counted(classes.len(), "class", "classes"),
            counted(rows, "constraint equation", "constraint equations"),
            counted(system.journals.len(), "journal", "journals"),
            counted(system.parameters.len(), "parameter", "parameters"),
            match system.inputs.len() {
                0 => String::new(),
                inputs => format!(" ({})", counted(inputs, "input", "inputs")),
            },
            counted(system.channels.len(), "channel", "channels"),
            bytes / 1024,
        )
    }

    /// Whether rigid outlines replace the flexible bodies.
    pub(crate) fn is_outlined(&self) -> bool {
        let flexible = |body: &Body| matches!(body.inertia, BodyInertia::Flexible(_));
        self.reductions.is_empty() && self.compiled.system.bodies.iter().any(flexible)
    }

    /// A note on the modes that a count of velocities or freedoms leaves out.
    pub(crate) fn besides(&self) -> &'static str {
        match self.is_outlined() {
            true => " besides those of modes",
            false => "",
        }
    }

    /// Bytes of machine code of each class of element.
    pub fn code_bytes(&self) -> Vec<(String, usize)> {
        self.compiled
            .system
            .classes
            .iter()
            .zip(&self.compiled.code)
            .map(|(class, code)| (class.name.clone(), code.code_bytes()))
            .collect()
    }

    /// The index of an input. Refuses an input of another model.
    pub(crate) fn index_of_input(&self, input: Input) -> Result<usize, Error> {
        if input.model == self.handles {
            Ok(input.index)
        } else {
            Err(Error::OtherModel)
        }
    }

    /// The index of a channel. Refuses a channel of another model.
    pub(crate) fn index_of(&self, channel: Channel) -> Result<usize, Error> {
        if channel.model == self.handles {
            Ok(channel.index)
        } else {
            Err(Error::OtherModel)
        }
    }

    /// A parameter's value (SI). Refuses a wrong dimension, a unit with a shifted zero for a difference, and
    /// a parameter of another model.
    pub(crate) fn checked(&self, parameter: Parameter, value: Quantity) -> Result<f64, Error> {
        let parameters = &self.compiled.system.parameters;
        let p = parameters
            .get(parameter.index)
            .filter(|_| parameter.model == self.handles)
            .ok_or(Error::OtherModel)?;
        if p.dimension != value.dimension() {
            return Err(Error::Dimension {
                path: p.origin.path.clone(),
                expected: p.dimension,
                found: value.dimension(),
                unit: p.display.symbol.clone(),
            });
        }
        if value.is_counted_from_a_zero() && !p.point {
            return Err(Error::Counted {
                path: p.origin.path.clone(),
                unit: p.display.symbol.clone(),
            });
        }
        Ok(value.value())
    }
}

/// Bytes as hexadecimal digits.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn described(parameter: &eng_system::system::Parameter) -> ParameterInfo {
    ParameterInfo {
        path: parameter.origin.path.clone(),
        dimension: parameter.dimension,
        display: parameter.display.clone(),
        limits: parameter.limits,
    }
}

/// A hash of the name, and of path and dimension of every parameter and channel.
fn fingerprint(system: &eng_system::system::System) -> u64 {
    use sha2::Digest;
    let mut hash = sha2::Sha256::new();
    hash.update(system.name.as_bytes());
    let parameters = system
        .parameters
        .iter()
        .map(|p| (&p.origin.path, p.dimension));
    let channels = system.channels.iter().map(|c| (&c.path, c.dimension));
    for (path, dimension) in parameters.chain(channels) {
        hash.update(format!("\0{path}\0{dimension}").as_bytes());
    }
    hash.finalize()
        .iter()
        .take(8)
        .fold(0, |bits, byte| bits << 8 | u64::from(*byte))
}
