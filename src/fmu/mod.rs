//! FMUs for co-simulation: the archive that `eng build` writes, and the model inside of it.
//!
//! ```text
//! modelDescription.xml           variables, units, abilities
//! binaries/x86_64-linux/M.so     the library of Eng, the same in every FMU
//! resources/eng.json             the manifest
//! resources/texts/               the model's file, all that it uses, tables
//! resources/bodies/              reduced bodies, without their meshes
//! documentation/index.html       the variables in words
//! ```

mod archive;
pub(crate) mod description;
mod manifest;
mod page;
mod variables;

pub use archive::{Export, Written};
pub use description::Version;
pub use manifest::{Kind, Manifest, Subject, Variable};
pub use variables::Selected;

use crate::{Error, HostError, Report, SimulationBuilder, Sources};
use std::path::{Path, PathBuf};

/// Texts below the resources.
const TEXTS: &str = "texts";
/// Reduced bodies below the resources.
const BODIES: &str = "bodies";
/// The manifest in the resources.
const MANIFEST: &str = "eng.json";

/// A failure to write or to open an FMU.
#[derive(Debug, thiserror::Error)]
pub enum FmuError {
    /// A file.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The archive.
    #[error("the archive cannot be made: {0}")]
    Archive(#[from] rawzip::Error),
    /// A manifest that is damaged.
    #[error("resources/eng.json of the FMU is damaged: {0}")]
    Manifest(#[from] serde_json::Error),
    /// A library and resources of two versions.
    #[error("Eng {written} wrote the FMU, and its library is of Eng {here}: build the FMU again")]
    OtherVersion {
        /// The version of the writer.
        written: String,
        /// The version of the library.
        here: String,
    },
    /// A hash that is none.
    #[error("resources/eng.json of the FMU is damaged: the hash of {0} has not 64 digits")]
    Hash(String),
    /// The texts in the FMU have a mistake.
    #[error("{0}")]
    Report(Report),
    /// The folder of the texts.
    #[error(transparent)]
    Host(#[from] HostError),
    /// The model.
    #[error(transparent)]
    Model(#[from] Error),
    /// A pattern that no path matches.
    #[error("there is no {noun} {pattern}{}", nearest.as_ref().map_or_else(String::new, |path| format!("; did you mean {path}?")))]
    Missing {
        /// Input, output or parameter.
        noun: &'static str,
        /// The pattern.
        pattern: String,
        /// A path with a similar spelling.
        nearest: Option<String>,
    },
    /// A selection that cannot be an FMU.
    #[error("{0}")]
    Refused(String),
}

fn at(path: &Path) -> impl FnOnce(std::io::Error) -> FmuError + '_ {
    |source| FmuError::File {
        path: path.to_owned(),
        source,
    }
}

/// The model inside of an FMU.
#[derive(Debug)]
pub struct Opened {
    /// The manifest.
    pub manifest: Manifest,
    /// A simulation as the FMU states it.
    pub builder: SimulationBuilder,
    /// Warnings and notes of its check; empty if there is none.
    pub warnings: String,
}

/// Checks and compiles the model in the resources of an FMU.
///
/// # Errors
/// Resources that are damaged, or of another version of Eng.
pub fn open(resources: &Path) -> Result<Opened, FmuError> {
    let path = resources.join(MANIFEST);
    let text = crate::regular::read(&path).map_err(at(&path))?;
    let manifest: Manifest = serde_json::from_slice(&text)?;
    if manifest.eng != env!("CARGO_PKG_VERSION") {
        return Err(FmuError::OtherVersion {
            written: manifest.eng,
            here: env!("CARGO_PKG_VERSION").to_owned(),
        });
    }
    let outside = manifest.outside.iter().map(|(name, digits)| {
        let hash = bytes_of(digits).ok_or_else(|| FmuError::Hash(name.clone()))?;
        Ok((name.clone(), hash))
    });
    let outside = outside.collect::<Result<Vec<_>, FmuError>>()?;
    let sources = Sources::folder(resources.join(TEXTS))?
        .with_cache(resources.join(BODIES))
        .with_sealed(outside);
    let checked = crate::check(&sources, &manifest.file);
    let report = checked.report();
    let warnings = match report.diagnostics().is_empty() {
        true => String::new(),
        false => report.to_string(),
    };
    let program = checked.into_program().map_err(FmuError::Report)?;
    let builder = match &manifest.subject {
        Subject::Model(name) => program.model(name)?.simulation(),
        Subject::Analysis(name) => program.analysis(name)?.simulation()?,
    };
    Ok(Opened {
        manifest,
        builder,
        warnings,
    })
}

/// The bytes of a hash in hexadecimal digits.
fn bytes_of(digits: &str) -> Option<[u8; 32]> {
    let mut bytes = [0; 32];
    if digits.len() != 64 {
        return None;
    }
    for (place, byte) in bytes.iter_mut().enumerate() {
        *byte = u8::from_str_radix(digits.get(2 * place..2 * place + 2)?, 16).ok()?;
    }
    Some(bytes)
}
