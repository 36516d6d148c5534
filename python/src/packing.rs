//! Runs as bytes, for other processes. Numbers keep their bits.
//!
//! The bytes leave out the machine with its journals, fields and firing order, because the analysis gives it.

use eng::results::Column;
use eng::run::RunOutcome;
use eng::{Analysis, Dimension, DisplayUnit, Gradient, Results};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Bytes that are no run of this analysis.
#[derive(Debug, thiserror::Error)]
pub enum RestoreError {
    /// Damaged bytes, or those of another version.
    #[error("these bytes are no run of this version of englang: {0}")]
    Bytes(#[from] postcard::Error),
    /// Columns that are no table.
    #[error(transparent)]
    Table(#[from] eng::results::ResultsError),
    /// A run of another analysis.
    #[error("these bytes are a run of {found}, not of {wanted}")]
    Other {
        /// The analysis of the bytes.
        found: String,
        /// The analysis that was asked.
        wanted: String,
    },
    /// The model refuses the parameters.
    #[error(transparent)]
    Model(Box<eng::Error>),
}

/// Results with the bits of their numbers.
#[derive(Serialize, Deserialize)]
struct PackedTable {
    analysis: String,
    model: String,
    metadata: BTreeMap<String, String>,
    columns: Vec<PackedColumn>,
}

#[derive(Serialize, Deserialize)]
struct PackedColumn {
    path: String,
    dimension: Dimension,
    display: DisplayUnit,
    frame: String,
    /// SI values.
    values: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
struct PackedRun {
    version: String,
    results: PackedTable,
    motion: Option<PackedTable>,
    /// Parameter, its unit, derivatives.
    gradients: Vec<(String, DisplayUnit, PackedTable)>,
    facts: Vec<String>,
    periodic: Option<(u32, bool)>,
    /// Warnings as JSON.
    messages: String,
}

impl From<&Results> for PackedTable {
    fn from(results: &Results) -> PackedTable {
        let columns = results.columns().iter().map(|column| PackedColumn {
            path: column.path.clone(),
            dimension: column.dimension,
            display: column.display.clone(),
            frame: column.frame.clone(),
            values: column.values.clone(),
        });
        PackedTable {
            analysis: results.analysis().to_owned(),
            model: results.model().to_owned(),
            metadata: results.metadata().clone(),
            columns: columns.collect(),
        }
    }
}

impl PackedTable {
    fn restored(self) -> Result<Results, RestoreError> {
        let mut results = Results::new(self.analysis, self.model);
        for (key, value) in self.metadata {
            results.set_metadata(key, value);
        }
        for column in self.columns {
            results.push(Column {
                path: column.path,
                dimension: column.dimension,
                display: column.display,
                frame: column.frame,
                values: column.values,
            })?;
        }
        Ok(results)
    }
}

/// A run with its warnings (as JSON) as bytes.
///
/// # Errors
/// None that a run can cause.
pub fn packed(outcome: &RunOutcome, messages: &str) -> Result<Vec<u8>, postcard::Error> {
    let gradients = outcome.gradients.iter();
    let gradients = gradients.map(|gradient| {
        let table = PackedTable::from(&gradient.results);
        (gradient.parameter.clone(), gradient.unit.clone(), table)
    });
    let run = PackedRun {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        results: PackedTable::from(&outcome.results),
        motion: outcome.motion.as_ref().map(PackedTable::from),
        gradients: gradients.collect(),
        facts: outcome.facts.clone(),
        periodic: outcome.periodic,
        messages: messages.to_owned(),
    };
    postcard::to_extend(&run, Vec::new())
}

/// The run of an analysis from its bytes, with its warnings as JSON.
///
/// # Errors
/// Bytes that are no run of this analysis.
pub fn restored(bytes: &[u8], analysis: &Analysis) -> Result<(RunOutcome, String), RestoreError> {
    let packed: PackedRun = postcard::from_bytes(bytes)?;
    if packed.version != env!("CARGO_PKG_VERSION") || packed.results.analysis != analysis.name() {
        return Err(RestoreError::Other {
            found: format!("{} of version {}", packed.results.analysis, packed.version),
            wanted: format!(
                "{} of version {}",
                analysis.name(),
                env!("CARGO_PKG_VERSION")
            ),
        });
    }
    let gradients = packed.gradients.into_iter();
    let gradients = gradients.map(|(parameter, unit, table)| {
        let results = table.restored()?;
        Ok(Gradient {
            parameter,
            unit,
            results,
        })
    });
    let results = packed.results.restored()?;
    let machine = eng::run::machine_of(analysis, &results);
    let outcome = RunOutcome {
        machine: machine.map_err(|error| RestoreError::Model(Box::new(error)))?,
        results,
        motion: packed.motion.map(PackedTable::restored).transpose()?,
        diagnostics: Default::default(),
        facts: packed.facts,
        point: analysis.point().to_vec(),
        periodic: packed.periodic,
        gradients: gradients.collect::<Result<_, RestoreError>>()?,
        made_before: false,
        timings: None,
    };
    Ok((outcome, packed.messages))
}
