//! The variables of an FMU: chosen parameters, inputs and outputs of a model.

use super::{FmuError, Kind, Variable};
use crate::results::matches;
use crate::{Dimension, DisplayUnit, Interpolation, Model, Program};
use eng_system::code::Bound;
use eng_system::system::{Role, Slot};
use std::collections::BTreeSet;

/// The choice of variables, by paths or patterns such as `main[*].force.*`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selected {
    /// Parameters. Without any, all that decide a number of the model and are not computed from others.
    pub parameters: Vec<String>,
    /// Inputs. Without any, all that no function of time drives.
    pub inputs: Vec<String>,
    /// Channels. Without any, the outputs of the model itself.
    pub outputs: Vec<String>,
}

/// A variable with the facts of its description.
#[derive(Clone, Debug)]
pub(super) struct Described {
    pub variable: Variable,
    pub dimension: Dimension,
    pub display: DisplayUnit,
    /// Open limits (SI).
    pub limits: (f64, f64),
    /// Value at the start (SI); an output has none.
    pub start: Option<f64>,
    /// Of an input.
    pub interpolation: Interpolation,
}

/// The paths that patterns choose among the known, in the order of the known.
fn chosen<'a>(
    noun: &'static str,
    patterns: &[String],
    known: &[&'a str],
) -> Result<Vec<&'a str>, FmuError> {
    for pattern in patterns {
        if !known.iter().any(|path| matches(pattern, path)) {
            let alike = |path: &str| strsim::jaro_winkler(pattern, path);
            let likely = known.iter().map(|path| (alike(path), *path));
            let nearest = likely
                // a choice: names with a mistake or two are as alike, others are not
                .filter(|(likeness, _)| *likeness > 0.8)
                .max_by(|a, b| a.0.total_cmp(&b.0));
            return Err(FmuError::Missing {
                noun,
                pattern: pattern.clone(),
                nearest: nearest.map(|(_, path)| path.to_owned()),
            });
        }
    }
    let wanted = |path: &&&str| patterns.iter().any(|pattern| matches(pattern, path));
    Ok(known.iter().filter(wanted).copied().collect())
}

/// The variables of an FMU: parameters, inputs, outputs. `bound` has the values of all parameters of the model.
pub(super) fn described(
    program: &Program,
    model: &Model,
    bound: &Bound,
    selected: &Selected,
) -> Result<Vec<Described>, FmuError> {
    let mut found = set_by_importers(program, model, bound, selected)?;
    let channels = model.channels();
    let paths: Vec<&str> = channels
        .iter()
        .map(|channel| channel.path.as_str())
        .collect();
    let read = match selected.outputs.is_empty() {
        false => chosen("output", &selected.outputs, &paths)?,
        true => own_outputs(model),
    };
    let given = found.len();
    for channel in channels
        .iter()
        .filter(|channel| read.contains(&channel.path.as_str()))
    {
        // the values of an input are a channel, too
        if found
            .iter()
            .any(|known| known.variable.path == channel.path)
        {
            continue;
        }
        found.push(Described {
            variable: Variable {
                path: channel.path.clone(),
                kind: Kind::Output,
            },
            dimension: channel.dimension,
            display: channel.display.clone(),
            limits: (f64::NEG_INFINITY, f64::INFINITY),
            start: None,
            interpolation: Interpolation::Hold,
        });
    }
    if found.len() == given {
        return Err(FmuError::Refused(
            "the model states no output: choose channels with --outputs; `eng results` lists those of a run"
                .to_owned(),
        ));
    }
    Ok(found)
}

/// The chosen parameters, then the chosen inputs.
fn set_by_importers(
    program: &Program,
    model: &Model,
    bound: &Bound,
    selected: &Selected,
) -> Result<Vec<Described>, FmuError> {
    let (infos, inputs) = (model.parameters(), model.inputs());
    let is_input = |path: &str| inputs.iter().any(|input| input.path == path);
    let known = |path: &&str| !is_input(path);
    let paths = infos.iter().map(|info| info.path.as_str());
    let parameters: Vec<&str> = paths.filter(known).collect();
    let stated = match selected.parameters.is_empty() {
        false => chosen("parameter", &selected.parameters, &parameters),
        true => {
            let free = free(model, bound);
            let free = (0..).zip(&infos).filter(|(index, _)| free.contains(index));
            Ok(free
                .map(|(_, info)| info.path.as_str())
                .filter(known)
                .collect())
        }
    };
    let paths: Vec<&str> = inputs.iter().map(|input| input.path.as_str()).collect();
    let driven = match selected.inputs.is_empty() {
        false => chosen("input", &selected.inputs, &paths),
        true => {
            let free = inputs.iter().filter(|input| input.signal.is_none());
            Ok(free.map(|input| input.path.as_str()).collect())
        }
    };
    let mut found = Vec::new();
    for (kind, wanted) in [(Kind::Parameter, stated), (Kind::Input, driven)] {
        let wanted = wanted.map_err(|missing| explained(program, model, missing))?;
        for (info, value) in infos.iter().zip(&bound.parameters) {
            if !wanted.contains(&info.path.as_str()) {
                continue;
            }
            let input = inputs.iter().find(|input| input.path == info.path);
            let (path, interpolation) = (&info.path, input.map(|input| input.interpolation));
            if let Some(signal) = input.and_then(|input| input.signal.as_ref()) {
                return Err(FmuError::Refused(format!(
                    "{path} is driven by {signal} in the text, so that an importer cannot set it"
                )));
            }
            if interpolation == Some(Interpolation::Cubic) {
                return Err(FmuError::Refused(format!(
                    "{path} has `interpolation: cubic`, whose values cannot jump between two steps as those of an importer do: declare it with `hold` or `linear`"
                )));
            }
            found.push(Described {
                variable: Variable {
                    path: path.clone(),
                    kind,
                },
                dimension: info.dimension,
                display: info.display.clone(),
                limits: info.limits,
                start: Some(*value),
                interpolation: interpolation.unwrap_or_default(),
            });
        }
    }
    Ok(found)
}

/// The parameters that decide a number of the model and are not computed from others, by index.
fn free(model: &Model, bound: &Bound) -> BTreeSet<u32> {
    let bind = &model.compiled().bind;
    let slots = (0..).map(Slot).take(bound.slots.len());
    slots.flat_map(|slot| bind.parameters_of(slot)).collect()
}

/// The channels of the outputs that the model itself states. Those of a part have the part's path before a dot.
fn own_outputs(model: &Model) -> Vec<&str> {
    let system = &model.compiled().system;
    let own = system.channels.iter().filter(|channel| {
        let element = system.elements.get(channel.element as usize);
        element.is_some_and(|element| {
            element.role == Role::Output && !element.origin.path.contains('.')
        })
    });
    own.map(|channel| channel.path.as_str()).collect()
}

/// The error about a missing parameter or input, with the reason if a path of another kind has the name.
fn explained(program: &Program, model: &Model, missing: FmuError) -> FmuError {
    let FmuError::Missing { noun, pattern, .. } = &missing else {
        return missing;
    };
    if let Some(constant) = program.constant(model.name(), pattern) {
        return constant.into();
    }
    match (*noun, model.parameter(pattern), model.input(pattern)) {
        ("input", Ok(_), Err(error)) => error.into(),
        ("parameter", _, Ok(_)) => FmuError::Refused(format!(
            "{pattern} is an input, whose start value an importer sets: name it with --inputs"
        )),
        _ => missing,
    }
}
