//! Compiled models, and their parameters, inputs and channels by index.

use super::{EngProgram, object, or, status};
use crate::edge::{self, Refused};
use eng::{Channel, ChannelInfo, Dimension, Input, Parameter, ParameterInfo, SimulationBuilder};
use std::ffi::{CString, c_char, c_int};
use std::sync::Arc;

/// Names for C, in the order of the model.
#[derive(Debug)]
struct Names {
    noun: &'static str,
    paths: Vec<CString>,
    units: Vec<CString>,
}

impl Names {
    fn new<'a>(
        noun: &'static str,
        items: impl Iterator<Item = (&'a str, Dimension)> + Clone,
    ) -> Names {
        Names {
            noun,
            paths: items.clone().map(|(path, _)| edge::c_text(path)).collect(),
            units: items
                .map(|(_, dimension)| edge::c_text(&dimension.to_string()))
                .collect(),
        }
    }

    fn missing(&self, index: usize) -> Refused {
        let (noun, count) = (self.noun, self.paths.len());
        Refused(format!(
            "there is no {noun} {index}: the model has {count}, and the first is 0"
        ))
    }

    /// One of the paths or of the units.
    fn at(&self, texts: &[CString], index: usize) -> Result<*const c_char, Refused> {
        let text = texts.get(index).map(|text| text.as_ptr());
        text.ok_or_else(|| self.missing(index))
    }

    fn index(&self, path: &str) -> Result<usize, Refused> {
        let found = self
            .paths
            .iter()
            .position(|known| known.as_bytes() == path.as_bytes());
        found.ok_or_else(|| Refused(format!("there is no {} {path}", self.noun)))
    }
}

/// A compiled model, or that of an analysis with its parameters, steps and start.
#[derive(Debug)]
pub struct EngModel(pub(super) Arc<Described>);

/// A model with names for C. Its simulations share it.
#[derive(Debug)]
pub(super) struct Described {
    /// A simulation as the text states it.
    pub(super) prototype: SimulationBuilder,
    infos: Vec<ParameterInfo>,
    parameters: Names,
    inputs: Names,
    channels: Names,
}

impl Described {
    fn new(prototype: SimulationBuilder) -> Described {
        let model = prototype.model();
        let infos = model.parameters();
        let of = |info: &ChannelInfo| (info.path.clone(), info.dimension);
        let channels: Vec<_> = model.channels().iter().map(of).collect();
        let inputs = model.inputs();
        Described {
            parameters: Names::new(
                "parameter",
                infos
                    .iter()
                    .map(|info| (info.path.as_str(), info.dimension)),
            ),
            inputs: Names::new(
                "input",
                inputs
                    .iter()
                    .map(|info| (info.path.as_str(), info.dimension)),
            ),
            channels: Names::new(
                "channel",
                channels
                    .iter()
                    .map(|(path, dimension)| (path.as_str(), *dimension)),
            ),
            infos,
            prototype,
        }
    }

    /// The parameter of an index, with its dimension.
    pub(super) fn parameter(&self, index: usize) -> Result<(Parameter, Dimension), Refused> {
        let info = self.infos.get(index);
        let info = info.ok_or_else(|| self.parameters.missing(index))?;
        let parameter = self.prototype.model().parameter(&info.path)?;
        Ok((parameter, info.dimension))
    }

    /// The input of an index.
    pub(super) fn input(&self, index: usize) -> Result<Input, Refused> {
        let path = path_at(&self.inputs, index)?;
        Ok(self.prototype.model().input(path)?)
    }

    /// The channel of an index.
    pub(super) fn channel(&self, index: usize) -> Result<Channel, Refused> {
        let path = path_at(&self.channels, index)?;
        Ok(self.prototype.model().channel(path)?)
    }
}

impl EngModel {
    fn of(prototype: SimulationBuilder) -> EngModel {
        EngModel(Arc::new(Described::new(prototype)))
    }
}

fn path_at(names: &Names, index: usize) -> Result<&str, Refused> {
    let path = names.paths.get(index).and_then(|path| path.to_str().ok());
    path.ok_or_else(|| names.missing(index))
}

/// Compiles a model of a program.
///
/// # Safety
/// `program` is a program that is not freed; `name` ends with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_model(
    program: *const EngProgram,
    name: *const c_char,
) -> *mut EngModel {
    object(|| {
        // SAFETY: by the promise of the caller
        let (program, name) =
            unsafe { (edge::shared(program, "program")?, edge::text(name, "name")?) };
        Ok(EngModel::of(program.inner.model(name)?.simulation()))
    })
}

/// Compiles the model of an analysis. Its simulations have the parameters, steps and start of the analysis.
///
/// # Safety
/// `program` is a program that is not freed; `name` ends with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_analysis(
    program: *const EngProgram,
    name: *const c_char,
) -> *mut EngModel {
    object(|| {
        // SAFETY: by the promise of the caller
        let (program, name) =
            unsafe { (edge::shared(program, "program")?, edge::text(name, "name")?) };
        let analysis = program.inner.analysis(name)?;
        Ok(EngModel::of(analysis.simulation()?))
    })
}

/// Frees a model. Simulations made of it stay.
///
/// # Safety
/// `model` is null or a model that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn eng_free_model(model: *mut EngModel) {
    // SAFETY: by the promise of the caller
    unsafe { edge::taken(model) }
}

/// Number, paths and units of one kind of names, and the index of a path.
macro_rules! names {
    ($($field:ident by $found:ident: $count:ident, $path:ident, $unit:ident, $index:ident;)*) => {$(
        /// The number of them.
        ///
        /// # Safety
        /// `model` is a model that is not freed.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $count(model: *const EngModel) -> usize {
            // SAFETY: by the promise of the caller
            or(0, || Ok(unsafe { edge::shared(model, "model")? }.0.$field.paths.len()))
        }

        /// The path of one, valid as long as the model; a null pointer beyond the last.
        ///
        /// # Safety
        /// `model` is a model that is not freed.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $path(model: *const EngModel, index: usize) -> *const c_char {
            or(std::ptr::null(), || {
                // SAFETY: by the promise of the caller
                let names = &unsafe { edge::shared(model, "model")? }.0.$field;
                names.at(&names.paths, index)
            })
        }

        /// The SI unit of one, valid as long as the model; a null pointer beyond the last.
        ///
        /// # Safety
        /// `model` is a model that is not freed.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $unit(model: *const EngModel, index: usize) -> *const c_char {
            or(std::ptr::null(), || {
                // SAFETY: by the promise of the caller
                let names = &unsafe { edge::shared(model, "model")? }.0.$field;
                names.at(&names.units, index)
            })
        }

        /// Writes the index of a path.
        ///
        /// # Safety
        /// `model` is a model that is not freed, `path` ends with a zero byte, and `index` points to room.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $index(
            model: *const EngModel,
            path: *const c_char,
            index: *mut usize,
        ) -> c_int {
            status(|| {
                // SAFETY: by the promise of the caller
                let model = unsafe { edge::shared(model, "model")? };
                // SAFETY: by the promise of the caller
                let path = unsafe { edge::text(path, "path")? };
                let found = model.0.$field.index(path).or_else(|missing| {
                    // the model's own message names the nearest path
                    let own = model.0.prototype.model().$found(path);
                    own.map_err(Refused::from).and(Err(missing))
                })?;
                // SAFETY: by the promise of the caller
                unsafe { edge::written(index, found, "index") }
            })
        }
    )*};
}

names! {
    parameters by parameter: eng_parameter_count, eng_parameter_path, eng_parameter_unit, eng_parameter;
    inputs by input: eng_input_count, eng_input_path, eng_input_unit, eng_input;
    channels by channel: eng_channel_count, eng_channel_path, eng_channel_unit, eng_channel;
}
