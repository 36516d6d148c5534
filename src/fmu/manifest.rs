//! The file `resources/eng.json` of an FMU: its model and its variables. The FMU's library reads it.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The contents of the file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of Eng that wrote the FMU.
    pub eng: String,
    /// The token that description and resources share.
    pub token: String,
    /// The model's file, below the folder of texts.
    pub file: String,
    /// The simulated part of the file.
    pub subject: Subject,
    /// The variables. The value reference of the first is 1, because time has 0.
    pub variables: Vec<Variable>,
    /// SHA-256 of meshes and matrices, by their names. They stay outside: the FMU has their reductions.
    pub outside: BTreeMap<String, String>,
}

/// The simulated part of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Subject {
    /// A model.
    Model(String),
    /// The model of an analysis, with its parameters, steps and start.
    Analysis(String),
}

/// A variable.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Variable {
    /// `main[5].force.x`.
    pub path: String,
    /// Its role.
    pub kind: Kind,
}

/// The role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Fixed from the start on.
    Parameter,
    /// Set between the steps.
    Input,
    /// A channel.
    Output,
}
