//! From texts to checked programs and compiled models.

use crate::error::{Error, Report};
use crate::fields::Fields;
use crate::indexed::base;
use crate::model::{Model, hexadecimal};
use crate::reduction::{Asked, Inspections, Reducer, Reduction};
use crate::sources::{Sources, Stamp, cache_folder};
use crate::timings::{CheckTimings, Clock};
use eng_compiler::elaborate::{AnalysisPlan, Structural, analyses};
use eng_compiler::models::SharedModels;
use eng_compiler::program::{DefinitionId, Program as Resolved};
use eng_compiler::typed::TypedProgram;
use eng_grammar::ast::{BindingKind, ItemKind, Kind};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap};
use eng_system::code::Compiled;
use eng_system::host::HostError;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// The result of a check: messages, and the program if there is no error.
#[derive(Clone, Debug)]
pub struct Checked {
    texts: Arc<SourceMap>,
    diagnostics: Diagnostics,
    program: Option<Program>,
    sources: Sources,
    timings: CheckTimings,
}

/// Parses and checks a file with all files that it uses: names, units, and every model with its default
/// constants. Always returns; see [`Checked::into_program`].
///
/// ```
/// let sources = eng::Sources::from_text("empty.eng", "model Empty { }");
/// let program = eng::check(&sources, "empty.eng").into_program()?;
/// assert_eq!(program.models(), ["Empty"]);
/// # Ok::<(), eng::Report>(())
/// ```
pub fn check(sources: &Sources, file: &str) -> Checked {
    let mut clock = Clock::new();
    let mut spent = CheckTimings::default();
    let mut texts = SourceMap::new();
    let mut diagnostics = Diagnostics::new();
    let resolved = eng_compiler::resolve::resolve(
        file,
        sources,
        eng_compiler::library::LIBRARY,
        &mut texts,
        &mut diagnostics,
    );
    spent.reading = clock.since();
    if diagnostics.has_errors() {
        return Checked {
            texts: Arc::new(texts),
            diagnostics,
            program: None,
            sources: sources.clone(),
            timings: spent,
        };
    }
    let typed = eng_compiler::check::check(resolved, &texts, &mut diagnostics);
    spent.types = clock.since();
    let (shared, inspections) = (SharedModels::default(), Inspections::default());
    let mut plans = Vec::new();
    if !diagnostics.has_errors() {
        plans = analyses(&typed, &mut texts, sources, &mut diagnostics);
        // errors that need instances: paths, indices, files, connections, meshes
        for model in models_of(&typed.program) {
            let made = shared.model(&typed, &mut texts, sources, model, &[], &mut diagnostics);
            spent.elaboration += clock.since();
            for flexible in made.iter().flat_map(|made| &made.elaborated.flexible) {
                for found in inspections.inspect(sources, flexible) {
                    diagnostics.push(found);
                }
            }
            spent.meshes += clock.since();
        }
        // warnings about the arguments of an analysis, such as a mode set; its errors come with its run
        for plan in plans.iter().filter(|plan| !plan.constants.is_empty()) {
            let (model, constants) = (plan.model, &plan.constants);
            let mut found = Diagnostics::new();
            shared.model(&typed, &mut texts, sources, model, constants, &mut found);
            if !found.has_errors() {
                diagnostics.extend(found);
            }
        }
    }
    if !diagnostics.has_errors() {
        shared.names(&typed, &mut texts, sources, &plans, &mut diagnostics);
    }
    spent.elaboration += clock.since();
    let mut reports = Vec::new();
    if !diagnostics.has_errors() {
        reports = eng_compiler::check::reports(
            &typed,
            &texts,
            sources,
            &plans,
            &shared,
            &mut diagnostics,
        );
    }
    spent.reports = clock.since();
    let failed = diagnostics.has_errors();
    let texts = Arc::new(texts);
    let program = (!failed).then(|| Program {
        inner: Arc::new(Inner {
            sources: sources.clone(),
            typed,
            shared,
            plans,
            reports,
            texts: Arc::clone(&texts),
            file: file.to_owned(),
            reducer: Reducer::default(),
            inspections,
            checked: spent,
            source_hash: OnceLock::new(),
        }),
    });
    Checked {
        texts,
        diagnostics,
        program,
        sources: sources.clone(),
        timings: spent,
    }
}

/// Reads a model's file and everything that it uses from the file's folder, and checks it. Reduced bodies are kept in the
/// folder that `ENG_CACHE` names, otherwise in the user's caches.
///
/// # Errors
/// A file or folder that cannot be read.
pub fn open(model: &Path) -> Result<Checked, HostError> {
    let path = model.display().to_string();
    let refused = |path: String, error: &std::io::Error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => HostError::NotFound(path),
        _ => HostError::System {
            path,
            message: error.to_string(),
        },
    };
    let found = match std::fs::metadata(model) {
        Ok(found) => found,
        Err(error) => return Err(refused(path, &error)),
    };
    let name = model.file_name().and_then(|name| name.to_str());
    let Some(file) = name.filter(|_| found.is_file()) else {
        let message = "this is no file".to_owned();
        return Err(HostError::System { path, message });
    };
    // a file that the system does not let us read is no mistake of the text
    if let Err(error) = std::fs::File::open(model) {
        return Err(refused(path, &error));
    }
    let folder = match model.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut sources = Sources::folder(folder)?;
    if let Some(cache) = cache_folder(|name| std::env::var_os(name)) {
        sources = sources.with_cache(cache);
    }
    Ok(check(&sources, file))
}

/// The start of the `///` lines before an item that begins at the byte `item`.
fn documented(text: &str, item: usize) -> usize {
    let mut begin = item;
    while let Some(before) = text.get(..begin).map(str::trim_end) {
        let line = before.rfind('\n').map_or(0, |end| end + 1);
        let docs = before.get(line..).map(str::trim_start);
        if line >= begin || !docs.is_some_and(|text| text.starts_with("///")) {
            break;
        }
        begin = line;
    }
    begin
}

fn models_of(resolved: &Resolved) -> Vec<DefinitionId> {
    let root = resolved.root();
    let Some(module) = resolved.modules.get(root as usize) else {
        return Vec::new();
    };
    module
        .file
        .items
        .iter()
        .enumerate()
        .filter(|(_, item)| matches!(&item.kind, ItemKind::Declaration(d) if d.kind == Kind::Model))
        .map(|(i, _)| DefinitionId {
            module: root,
            item: i as u32,
        })
        .collect()
}

impl Checked {
    /// All messages, including warnings and notes.
    pub fn report(&self) -> Report {
        Report::new(Arc::clone(&self.texts), self.diagnostics.clone())
    }

    /// Processor time of its phases so far; [`Program::assemble`] has the later ones.
    pub fn timings(&self) -> CheckTimings {
        self.timings
    }

    /// The files asked for so far, with their stamps: see [`Sources::asked`]. Runs of the program may add further ones.
    pub(crate) fn asked(&self) -> BTreeMap<PathBuf, Option<Stamp>> {
        self.sources.asked()
    }

    /// The program, if there is no error.
    pub fn program(&self) -> Option<&Program> {
        self.program.as_ref()
    }

    /// The program, or the messages.
    pub fn into_program(self) -> Result<Program, Report> {
        match self.program {
            Some(program) => Ok(program),
            None => Err(Report::new(self.texts, self.diagnostics)),
        }
    }
}

#[derive(Debug)]
struct Inner {
    sources: Sources,
    typed: TypedProgram,
    shared: SharedModels,
    plans: Vec<AnalysisPlan>,
    reports: Vec<eng_system::report::Report>,
    texts: Arc<SourceMap>,
    file: String,
    reducer: Reducer,
    inspections: Inspections,
    /// Processor time of its check.
    checked: CheckTimings,
    /// [`Program::source_hash`] after its first use: each point of a sweep needs it.
    source_hash: OnceLock<String>,
}

/// The form of the flexible bodies in a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bodies {
    /// Reduced bodies.
    Reduced,
    /// Rigid bodies with the same mass and markers. They suffice for a check.
    Rigid,
    /// Bodies whose markers move independently, as joints on a bending body allow.
    Loose,
}

/// A checked program: models and analyses.
#[derive(Clone, Debug)]
pub struct Program {
    inner: Arc<Inner>,
}

impl Program {
    /// Names of the models of the file.
    pub fn models(&self) -> Vec<&str> {
        models_of(&self.inner.typed.program)
            .into_iter()
            .filter_map(|id| self.name_of(id))
            .collect()
    }

    /// Names of the analyses, in the order of the text.
    pub fn analyses(&self) -> Vec<&str> {
        self.inner
            .plans
            .iter()
            .map(|p| p.analysis.origin.path.as_str())
            .collect()
    }

    /// Processor time of the check.
    pub(crate) fn timings(&self) -> CheckTimings {
        self.inner.checked
    }

    /// The reports, in the order of the text; see [`crate::post::evaluate`].
    pub fn reports(&self) -> &[eng_system::report::Report] {
        &self.inner.reports
    }

    /// The file's name.
    pub fn file(&self) -> &str {
        &self.inner.file
    }

    /// The canonical paths of the files opened so far: the model, the files that it uses, its data.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        self.inner.sources.opened().into_iter().collect()
    }

    /// Names, relative to the folder, and contents of the files that it has opened so far. A program of these files is the
    /// same program. To compile a model may open further files.
    ///
    /// # Errors
    /// A file that the system cannot read any more.
    pub fn contents(&self) -> Result<Vec<(String, Vec<u8>)>, HostError> {
        self.inner.sources.contents()
    }

    /// The files.
    pub(crate) fn sources(&self) -> &Sources {
        &self.inner.sources
    }

    /// Keeps reductions in a folder, with the facts of all meshes of the file. Returns the hashes of the meshes and matrices,
    /// in hexadecimal digits, by their names.
    pub(crate) fn keep_bodies(
        &self,
        reductions: &[Reduction],
        folder: &Path,
    ) -> std::io::Result<BTreeMap<String, String>> {
        let keep = self.inner.sources.clone().with_cache(folder);
        reductions
            .iter()
            .try_for_each(|reduction| reduction.save(&keep))?;
        self.inner.inspections.save(&keep)?;
        Ok(self.inner.inspections.files())
    }

    /// Whether a model of the file has flexible bodies.
    pub(crate) fn is_flexible(&self) -> bool {
        !self.inner.inspections.is_empty()
    }

    /// Hashes of the meshes and matrices by their names.
    pub(crate) fn meshes(&self) -> BTreeMap<String, String> {
        self.inner.inspections.files()
    }

    /// The texts that messages point into.
    pub fn texts(&self) -> &Arc<SourceMap> {
        &self.inner.texts
    }

    /// SHA-256 of all texts, those of the library and of the user, as hexadecimal digits. It excludes report
    /// blocks, because a change of one changes no result.
    pub fn source_hash(&self) -> String {
        let hash = &self.inner.source_hash;
        hash.get_or_init(|| self.hash_of_sources()).clone()
    }

    fn hash_of_sources(&self) -> String {
        use sha2::Digest;
        let mut hash = sha2::Sha256::new();
        // file names are excluded, because a copy under another name is the same model
        for (id, source) in self.inner.texts.iter() {
            let modules = self.inner.typed.program.modules.iter();
            let mut at = 0;
            for item in modules
                .filter(|module| module.source == id)
                .flat_map(|module| &module.file.items)
                .filter(|item| matches!(item.kind, ItemKind::Report(_)))
            {
                let kept = source
                    .text
                    .get(at..documented(&source.text, item.span.start as usize));
                hash.update(kept.unwrap_or_default().as_bytes());
                at = item.span.end as usize;
            }
            hash.update(source.text.get(at..).unwrap_or_default().as_bytes());
            hash.update([0]);
        }
        hexadecimal(&hash.finalize())
    }

    /// The paths and trees of all texts: the main file first, then those that it uses.
    pub(crate) fn modules(&self) -> Vec<(&str, &eng_grammar::ast::File)> {
        let modules = &self.inner.typed.program.modules;
        let modules = modules.iter().rev();
        modules.map(|m| (m.path.as_str(), &m.file)).collect()
    }

    /// The text of the class whose name is at a place.
    pub(crate) fn class_at(
        &self,
        name: eng_grammar::Span,
    ) -> Option<eng_compiler::typed::ClassText> {
        self.inner.typed.class_at(name)
    }

    fn name_of(&self, id: DefinitionId) -> Option<&str> {
        match &self.inner.typed.program.item(id)?.kind {
            ItemKind::Declaration(d) => Some(&d.name.text),
            _ => None,
        }
    }

    /// A model for inspection only: rigid bodies replace its flexible ones.
    pub(crate) fn outlined(&self, name: &str) -> Result<Model, Error> {
        self.compile(self.model_of(name)?, &[], Bodies::Rigid)
    }

    /// Compiles a model with its default constants.
    pub fn model(&self, name: &str) -> Result<Model, Error> {
        self.compile(self.model_of(name)?, &[], Bodies::Reduced)
    }

    fn model_of(&self, name: &str) -> Result<DefinitionId, Error> {
        models_of(&self.inner.typed.program)
            .into_iter()
            .find(|id| self.name_of(*id) == Some(name))
            .ok_or_else(|| Error::NoModel {
                name: name.to_owned(),
                known: self.models().iter().map(ToString::to_string).collect(),
            })
    }

    /// The flexible bodies of all models with their default constants, and warnings about them.
    ///
    /// # Errors
    /// Failures that no change of the text can repair: no memory for code.
    pub fn reduce(&self) -> Result<(Vec<Reduction>, Diagnostics), Error> {
        let (mut reductions, mut diagnostics) = (Vec::new(), Diagnostics::new());
        for name in self.models() {
            match self.model(name) {
                Ok(model) => {
                    for reduction in model.reductions() {
                        reduction.doubts().for_each(|d| diagnostics.push(d));
                        reductions.push(reduction.clone());
                    }
                }
                Err(Error::Report(report)) => diagnostics.extend(report.diagnostics().clone()),
                Err(other) => return Err(other),
            }
        }
        Ok((reductions, diagnostics))
    }

    /// Whether an analysis with an index gives a parameter other values at other points.
    pub(crate) fn sweeps(&self, analysis: &str, path: &str) -> bool {
        let mut values = self
            .inner
            .plans
            .iter()
            .map(|plan| &plan.analysis)
            .filter(|a| !a.point.is_empty() && base(&a.origin.path) == base(analysis))
            .map(|a| {
                let stated = a.set.iter().find(|(p, _)| p == path);
                stated.map(|(_, value)| value.to_bits())
            });
        // a sweep of one point does not show which arguments vary, so all stated ones count
        match (values.next().flatten(), values.next()) {
            (None, _) => false,
            (Some(_), None) => true,
            (Some(first), Some(second)) => {
                second != Some(first) || values.any(|value| value != Some(first))
            }
        }
    }

    /// Whether an analysis with an index gives a constant other values at other points.
    pub(crate) fn varies(&self, analysis: &str, path: &str) -> bool {
        let mut values = self
            .inner
            .plans
            .iter()
            .filter(|plan| {
                !plan.analysis.point.is_empty()
                    && base(&plan.analysis.origin.path) == base(analysis)
            })
            .map(|plan| plan.constants.iter().find(|(known, _)| known == path));
        let first = values.next();
        values.any(|value| Some(value) != first)
    }

    /// The checked texts.
    pub(crate) fn typed(&self) -> &TypedProgram {
        &self.inner.typed
    }

    /// The error about a missing parameter, if a constant of the model or of the file has this name.
    pub(crate) fn constant(&self, model: &str, name: &str) -> Option<Error> {
        let is_constant = |item: &eng_grammar::ast::Item| {
            matches!(&item.kind, ItemKind::Binding(binding)
                if binding.kind == BindingKind::Const && binding.name.text == name)
        };
        let resolved = &self.inner.typed.program;
        let file = &resolved.modules.get(resolved.root() as usize)?.file;
        // the model may come from another file
        let mut items = resolved.modules.iter().flat_map(|m| &m.file.items);
        let of_model = items.any(|item| match &item.kind {
            ItemKind::Declaration(declaration) if declaration.name.text == model => {
                let block = declaration.block();
                block.is_some_and(|block| block.items.iter().any(is_constant))
            }
            _ => false,
        });
        let name = name.to_owned();
        if of_model {
            let model = model.to_owned();
            Some(Error::Constant { name, model })
        } else if file.items.iter().any(is_constant) {
            Some(Error::FileConstant { name })
        } else {
            None
        }
    }

    pub(crate) fn plan(&self, name: &str) -> Result<&AnalysisPlan, Error> {
        self.inner
            .plans
            .iter()
            .find(|p| p.analysis.origin.path == name)
            .ok_or_else(|| Error::NoAnalysis {
                name: name.to_owned(),
                known: self.analyses().iter().map(ToString::to_string).collect(),
            })
    }

    pub(crate) fn compile(
        &self,
        id: DefinitionId,
        constants: &[(String, Structural)],
        bodies: Bodies,
    ) -> Result<Model, Error> {
        let mut texts = SourceMap::clone(&self.inner.texts);
        let mut diagnostics = Diagnostics::new();
        let model = self.inner.shared.model(
            &self.inner.typed,
            &mut texts,
            &self.inner.sources,
            id,
            constants,
            &mut diagnostics,
        );
        let Some(model) = model else {
            return Err(Error::Report(Report::new(Arc::new(texts), diagnostics)));
        };
        let (mut reductions, mut reduced) = (Vec::new(), Vec::new());
        let elaborated = &model.elaborated;
        let Inner {
            sources,
            reducer,
            inspections,
            ..
        } = &*self.inner;
        let failed = |diagnostic: Box<Diagnostic>| {
            let mut diagnostics = Diagnostics::new();
            diagnostics.push(*diagnostic);
            Error::Report(Report::new(Arc::clone(&self.inner.texts), diagnostics))
        };
        let asked: Vec<Asked<'_>> = (0..)
            .zip(&elaborated.flexible)
            .map(|(index, source)| (index as usize, source, elaborated.turned_markers(index)))
            .collect();
        if bodies == Bodies::Reduced {
            for made in reducer.reduce_all(sources, asked) {
                let reduction = made.map_err(failed)?;
                reduced.push(Arc::clone(&reduction.body));
                reductions.push(reduction);
            }
        } else {
            for (_, source, turned) in asked {
                let outline = inspections
                    .outline(sources, source, &turned)
                    .map_err(failed)?;
                reduced.push(Arc::new(match bodies {
                    Bodies::Loose => outline.loose(),
                    _ => outline.rigid(),
                }));
            }
        }
        Ok(Model::new(
            Compiled {
                system: Arc::clone(&elaborated.system),
                code: self.inner.shared.code(&model)?,
                bind: elaborated.bind.clone(),
                reduced,
                fields: Arc::new(Fields),
                threads: NonZeroUsize::MIN,
            },
            Arc::clone(&self.inner.texts),
            reductions,
            Arc::clone(&model),
        ))
    }
}
