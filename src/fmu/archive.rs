//! The archive of an FMU.

use super::description::{About, Experiment, Version, description};
use super::variables::{Described, Selected, described};
use super::{BODIES, FmuError, Kind, MANIFEST, Manifest, Subject, TEXTS, at, open, page};
use crate::results::replace_file;
use crate::{Program, SimulationBuilder};
use eng_flexible::store::hexadecimal;
use eng_system::system::Extent;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::{CompressionMethod, ZipArchiveWriter};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// An FMU to be written.
#[derive(Clone, Debug)]
pub struct Export<'a> {
    /// The checked text.
    pub program: &'a Program,
    /// The simulated part of it.
    pub subject: Subject,
    /// The variables.
    pub selected: Selected,
    /// The version of the standard.
    pub version: Version,
    /// The library of Eng for FMUs.
    pub library: &'a Path,
}

/// The facts of a written FMU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// Numbers of parameters, inputs and outputs.
    pub variables: [usize; 3],
    /// Parameters that were not chosen and are left out, because the text computes them from others.
    pub left_out: usize,
}

/// A folder of its own that is removed at the end.
struct Staged(PathBuf);

impl Drop for Staged {
    fn drop(&mut self) {
        // files that remain are in the system's folder for temporary files
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

impl Export<'_> {
    /// Writes the archive. Before, it opens the model from the resources alone, as an importer does.
    ///
    /// # Errors
    /// A choice of variables that the model does not have; files that cannot be read or written.
    pub fn write(&self, out: &Path) -> Result<Written, FmuError> {
        let (builder, experiment) = self.prepared()?;
        let model = builder.model();
        let variables = described(self.program, model, &builder.bound()?, &self.selected)?;
        let staged = staged(out)?;
        let resources = &staged.0;
        let bodies = resources.join(BODIES);
        let mut manifest = Manifest {
            eng: env!("CARGO_PKG_VERSION").to_owned(),
            token: String::new(),
            file: self.program.file().to_owned(),
            subject: self.subject.clone(),
            variables: variables
                .iter()
                .map(|known| known.variable.clone())
                .collect(),
            outside: self
                .program
                .keep_bodies(model.reductions(), &bodies)
                .map_err(at(&bodies))?,
        };
        for (name, bytes) in self.program.sources().contents()? {
            if !manifest.outside.contains_key(&name) {
                put(&resources.join(TEXTS).join(name), &bytes)?;
            }
        }
        manifest.token = token(self.program, &manifest)?;
        put(
            &resources.join(MANIFEST),
            &serde_json::to_vec_pretty(&manifest)?,
        )?;
        let again = open(resources)?;
        if again.builder.parameter_values()? != builder.parameter_values()? {
            return Err(FmuError::Refused(
                "the files changed while the FMU was written; build it again".to_owned(),
            ));
        }
        let about = About {
            model: model.name(),
            token: &manifest.token,
            variables: &variables,
            experiment,
        };
        let pages = [
            (
                "modelDescription.xml".to_owned(),
                description(&about, self.version).into_bytes(),
            ),
            (
                "documentation/index.html".to_owned(),
                page::page(model.name(), self.program.file(), &self.subject, &variables)
                    .into_bytes(),
            ),
            (
                binary(self.version, model.name())?,
                crate::regular::read(self.library).map_err(at(self.library))?,
            ),
        ];
        replace_file(out, |file| zipped(file, &pages, resources))?;
        Ok(self.written(&variables, model))
    }

    /// A simulation as the text states it, with duration and interval (s) of its samples.
    fn prepared(&self) -> Result<(SimulationBuilder, Experiment), FmuError> {
        match &self.subject {
            Subject::Model(name) => Ok((self.program.model(name)?.simulation(), (None, None))),
            Subject::Analysis(name) => {
                let analysis = self.program.analysis(name)?;
                let sampling = analysis.kind().sampling();
                let time = |extent: Option<Extent>| match extent {
                    Some(Extent::Time(time)) => Some(time),
                    _ => None,
                };
                let experiment = sampling.map_or((None, None), |(sample, whole)| {
                    (time(whole), time(Some(sample)))
                });
                Ok((analysis.simulation()?, experiment))
            }
        }
    }

    fn written(&self, variables: &[Described], model: &crate::Model) -> Written {
        let count = |kind| {
            let of_kind = variables.iter().filter(|known| known.variable.kind == kind);
            of_kind.count()
        };
        let [parameters, inputs, outputs] = [Kind::Parameter, Kind::Input, Kind::Output].map(count);
        let all = model.parameters().len() - model.inputs().len();
        Written {
            variables: [parameters, inputs, outputs],
            left_out: match self.selected.parameters.is_empty() {
                true => all - parameters,
                false => 0,
            },
        }
    }
}

/// A new folder for the resources.
fn staged(out: &Path) -> Result<Staged, FmuError> {
    let name = out.file_name().unwrap_or_default().to_string_lossy();
    let unique = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let unique = unique.map_or(0, |since| since.as_nanos());
    let folder = std::env::temp_dir().join(format!("eng-{}-{unique}-{name}", std::process::id()));
    std::fs::create_dir_all(folder.join(TEXTS)).map_err(at(&folder))?;
    Ok(Staged(folder))
}

fn put(path: &Path, bytes: &[u8]) -> Result<(), FmuError> {
    let folder = path.parent().unwrap_or(path);
    std::fs::create_dir_all(folder).map_err(at(folder))?;
    std::fs::write(path, bytes).map_err(at(path))
}

/// The hash of texts and manifest.
fn token(program: &Program, manifest: &Manifest) -> Result<String, FmuError> {
    use sha2::Digest;
    let mut hash = sha2::Sha256::new();
    hash.update(program.source_hash());
    hash.update(serde_json::to_vec(manifest)?);
    Ok(hexadecimal(&hash.finalize()))
}

/// The place of the library in the archive, by the names of the standard for this platform.
fn binary(version: Version, model: &str) -> Result<String, FmuError> {
    use std::env::consts::{ARCH, DLL_SUFFIX, OS};
    let folder = match (version, ARCH, OS) {
        (Version::Two, "x86_64", "linux") => "linux64".to_owned(),
        (Version::Two, "x86_64", "windows") => "win64".to_owned(),
        (Version::Two, "x86_64", "macos") => "darwin64".to_owned(),
        (Version::Two, ..) => {
            return Err(FmuError::Refused(format!(
                "FMI 2.0 has no name for the platform {ARCH} {OS}: build for --fmi 3"
            )));
        }
        (Version::Three, _, "macos") => format!("{ARCH}-darwin"),
        (Version::Three, ..) => format!("{ARCH}-{OS}"),
    };
    Ok(format!("binaries/{folder}/{model}{DLL_SUFFIX}"))
}

/// Writes pages and resources, compressed.
fn zipped(
    file: &mut File,
    pages: &[(String, Vec<u8>)],
    resources: &Path,
) -> Result<(), rawzip::Error> {
    let mut archive = ZipArchiveWriter::new(BufWriter::new(file));
    for (name, bytes) in pages {
        add(&mut archive, name, bytes)?;
    }
    for (name, path) in files(resources)? {
        add(
            &mut archive,
            &format!("resources/{name}"),
            &std::fs::read(path)?,
        )?;
    }
    archive.finish()?.flush()?;
    Ok(())
}

/// Adds a file to an archive.
fn add<W: Write>(
    archive: &mut ZipArchiveWriter<W>,
    name: &str,
    bytes: &[u8],
) -> Result<(), rawzip::Error> {
    let file = archive
        .new_file(name)
        .compression_method(CompressionMethod::DEFLATE);
    let (mut entry, config) = file.start()?;
    let mut writer = config.wrap(DeflateEncoder::new(&mut entry, Compression::default()));
    writer.write_all(bytes)?;
    let (encoder, summary) = writer.finish()?;
    encoder.finish()?;
    entry.finish(summary)?;
    Ok(())
}

/// All files below a folder in a fixed order, with their names in the archive.
fn files(folder: &Path) -> std::io::Result<BTreeMap<String, PathBuf>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![(String::new(), folder.to_owned())];
    while let Some((prefix, folder)) = folders.pop() {
        for entry in std::fs::read_dir(&folder)? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let name = format!("{prefix}{name}");
            match path.is_dir() {
                true => folders.push((format!("{name}/"), path)),
                false => drop(found.insert(name, path)),
            }
        }
    }
    Ok(found)
}
