//! Errors for programs that embed Eng.

use crate::indexed::listed;
use crate::quantity::QuantityError;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::Dimension;
use std::sync::Arc;

/// Any failure between a text and a result.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The text is wrong.
    #[error("{0}")]
    Report(Report),
    /// No such model.
    #[error("there is no model {name}; there are: {}", known.join(", "))]
    NoModel {
        /// The wanted name or value.
        name: String,
        /// The names in the file.
        known: Vec<String>,
    },
    /// No such analysis.
    #[error("there is no analysis {name}; there are: {}", listed(known.iter().map(String::as_str)))]
    NoAnalysis {
        /// The wanted name or value.
        name: String,
        /// The names in the file.
        known: Vec<String>,
    },
    /// No such parameter.
    #[error("there is no parameter {path}{}", hint(nearest))]
    NoParameter {
        /// The wanted name or value.
        path: String,
        /// A name with a similar spelling.
        nearest: Option<String>,
    },
    /// A constant in place of a parameter.
    #[error(
        "{name} is a `const`, not a parameter: it decides the structure; change it in the text, or state it in an analysis: {model}({name}: …)"
    )]
    Constant {
        /// The constant.
        name: String,
        /// The model that states it.
        model: String,
    },
    /// A word that its choice does not have.
    #[error("`{word}` is no word of {path}: its words are {words}")]
    NoWord {
        /// The constant of the model.
        path: String,
        /// The wanted word.
        word: String,
        /// The words of the choice.
        words: String,
    },
    /// A constant of the file in place of a parameter.
    #[error(
        "{name} is a `const` of the file, not a parameter: change it in the text, or make it a `param` of the model"
    )]
    FileConstant {
        /// The constant.
        name: String,
    },
    /// No such channel.
    #[error("there is no channel {path}{}", hint(nearest))]
    NoChannel {
        /// The wanted name or value.
        path: String,
        /// A name with a similar spelling.
        nearest: Option<String>,
    },
    /// No such input.
    #[error("there is no input {path}{}", hint(nearest))]
    NoInput {
        /// The wanted name or value.
        path: String,
        /// A name with a similar spelling.
        nearest: Option<String>,
    },
    /// A simulation of an analysis that takes no steps.
    #[error("{analysis} takes no steps in time; name a transient or periodic analysis")]
    NoSteps {
        /// The analysis.
        analysis: String,
    },
    /// Gradients of an analysis that has none.
    #[error(
        "{analysis} has no gradients: they belong to a motion in time, so name a `transient` or `periodic` analysis"
    )]
    NoGradients {
        /// The analysis.
        analysis: String,
    },
    /// A parameter that gradients name twice.
    #[error("gradients have {path} twice; name it once")]
    GradientTwice {
        /// The path.
        path: String,
    },
    /// No such element, body, marker, parameter or output.
    #[error("there is no {path} in the model{}", hint(nearest))]
    NoItem {
        /// The wanted path.
        path: String,
        /// A path with a similar spelling.
        nearest: Option<String>,
    },
    /// No such index of a repeated item.
    #[error("there is no {path} in the model: {range}")]
    NoIndex {
        /// The wanted item.
        path: String,
        /// The indices that there are, in words.
        range: String,
    },
    /// A handle of a parameter, input or channel of another model.
    #[error("the handle is of another model")]
    OtherModel,
    /// A parameter that the analysis itself varies.
    #[error(
        "{analysis} varies {path} from point to point, so it can't be set to one value; leave it, or run another analysis"
    )]
    Swept {
        /// The parameter.
        path: String,
        /// The analysis.
        analysis: String,
    },
    /// A value of the wrong dimension.
    #[error("{path} is in {expected} ({unit}), the value is in {found}")]
    Dimension {
        /// The parameter.
        path: String,
        /// Its dimension.
        expected: Dimension,
        /// The dimension of the value.
        found: Dimension,
        /// A unit that fits.
        unit: String,
    },
    /// A value in a unit with a shifted zero for a difference, such as 20 degC for a rise of temperature.
    #[error(
        "{path} is a difference, and the value counts from the zero of its unit: write it in {unit}"
    )]
    Counted {
        /// The parameter.
        path: String,
        /// A unit that fits.
        unit: String,
    },
    /// Not a quantity.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
    /// The model cannot be assembled or integrated.
    #[error("{report}")]
    Run {
        /// The cause.
        cause: Box<eng_runtime::RuntimeError>,
        /// The cause with its places in the text.
        report: Report,
    },
    /// The system has no memory for machine code, or the processor is not supported.
    #[error(transparent)]
    Code(#[from] eng_compiler::generate::CodegenError),
    /// An error of files.
    #[error(transparent)]
    Results(#[from] crate::results::ResultsError),
}

impl Error {
    /// The messages about a wrong text or a failed model; `None` for other errors.
    pub fn report(&self) -> Option<&Report> {
        match self {
            Error::Report(report) | Error::Run { report, .. } => Some(report),
            _ => None,
        }
    }

    /// Whether a watch stopped the run.
    pub fn is_stopped(&self) -> bool {
        matches!(self, Error::Run { cause, .. } if matches!(**cause, eng_runtime::RuntimeError::Stopped(_)))
    }

    /// The error with a note under each message.
    pub(crate) fn with_note(mut self, note: &str) -> Error {
        if let Error::Report(report) | Error::Run { report, .. } = &mut self {
            let mut noted = Diagnostics::new();
            for message in report.diagnostics.iter() {
                noted.push(message.clone().with_note(note));
            }
            report.diagnostics = noted;
        }
        self
    }
}

fn hint(nearest: &Option<String>) -> String {
    match nearest {
        Some(n) => format!("; did you mean {n}?"),
        None => String::new(),
    }
}

/// Messages with their texts.
#[derive(Clone, Debug)]
pub struct Report {
    texts: Arc<SourceMap>,
    diagnostics: Diagnostics,
}

impl Report {
    pub(crate) fn new(texts: Arc<SourceMap>, diagnostics: Diagnostics) -> Report {
        Report { texts, diagnostics }
    }

    /// The messages.
    pub fn diagnostics(&self) -> &Diagnostics {
        &self.diagnostics
    }

    /// The texts.
    pub fn texts(&self) -> &SourceMap {
        &self.texts
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&crate::render::human(
            &self.diagnostics,
            &self.texts,
            crate::render::Colors::None,
        ))
    }
}

impl std::error::Error for Report {}
