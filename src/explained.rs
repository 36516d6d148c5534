//! The parts of a model in words: the kind of a path, the place of its text, and its numbers.

use crate::counted::counted;
use crate::definitions;
use crate::machine::at;
use crate::places::span;
use crate::tables::Table;
use crate::{Error, Model, Program, Report};
use eng_compiler::typed::{ClassText, LevelText};
use eng_grammar::{Diagnostics, SourceMap, nearest};
use eng_runtime::RuntimeError;
use eng_system::code::Bound;
use eng_system::sentence::joined;
use eng_system::significant::short;
use eng_system::system::{
    BodyInertia, BodyRef, Channel, Element, ElementClass, Location, Origin, Role, System,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Most elements that the text about a body or a marker names. A choice: they fit in a few lines.
const MOST: usize = 12;

impl Program {
    /// A text about the element, body, marker, output or parameter with this path, for each model of the file
    /// that has it: its class with the text, its markers, parameters, equations and outputs. The numbers are
    /// those of the defaults, and rigid bodies replace flexible ones. Other paths are names of the text or of
    /// the library: a model, a class, an analysis, a constant, a unit.
    ///
    /// # Errors
    /// A path or an index that no model has; a model with a mistake.
    pub fn explain(&self, path: &str) -> Result<String, Error> {
        let mut texts = Vec::new();
        let mut known = Vec::new();
        let mut repeated = Repeated::new();
        for name in self.models() {
            let model = self.outlined(name)?;
            let bound = bound(&model)?;
            let explained = Explained {
                program: self,
                system: &model.compiled().system,
                bound: &bound,
            };
            texts.extend(explained.of(path).map(|text| match self.models().len() {
                1 => text,
                _ => format!("model {name}\n{text}"),
            }));
            known.extend(explained.paths().map(str::to_owned));
            for (path, indices) in &model.compiled().system.repeated {
                let all = repeated.entry(path.clone()).or_default();
                all.extend(indices.iter().cloned());
            }
        }
        if texts.is_empty() && self.models().contains(&path) {
            return self.model_in_words(path);
        }
        known.extend(self.analyses().into_iter().map(str::to_owned));
        if texts.is_empty()
            && let Some(outside) = index_outside(path, &repeated, &known)
        {
            return Err(outside);
        }
        if texts.is_empty() {
            let modules = self.modules();
            let files = modules.iter().copied();
            texts.extend(definitions::of_modules(files, path, self.texts()));
            known.extend(
                modules
                    .first()
                    .into_iter()
                    .flat_map(|(_, file)| definitions::names(file))
                    .map(str::to_owned),
            );
        }
        if texts.is_empty() {
            texts.extend(definitions::of_library(path));
        }
        if texts.is_empty() {
            let modules = self.modules();
            texts.extend(definitions::lints(
                modules.iter().copied(),
                path,
                self.texts(),
            ));
        }
        if texts.is_empty() {
            return Err(Error::NoItem {
                path: path.to_owned(),
                nearest: nearest(path, known.iter().map(String::as_str)).map(str::to_owned),
            });
        }
        Ok(texts.join("\n"))
    }

    /// The elements and bodies of all models with their classes.
    ///
    /// # Errors
    /// A model with a mistake.
    pub fn items(&self) -> Result<String, Error> {
        let mut text = String::new();
        for name in self.models() {
            text.push_str(&items_of(name, &self.outlined(name)?, self.texts()));
        }
        Ok(text)
    }

    /// The elements, bodies and parameters of a model.
    fn model_in_words(&self, name: &str) -> Result<String, Error> {
        let model = self.outlined(name)?;
        let texts = self.texts();
        let mut text = items_of(name, &model, texts);
        let mut table = Table::new(&[&["parameter", "value", "stated at"]]);
        let parameters = &model.compiled().system.parameters;
        let mut found = false;
        for (parameter, value) in parameters.iter().zip(&bound(&model)?.parameters) {
            // those of elements belong to the texts of the elements
            if !parameter.origin.path.contains('.') {
                found = true;
                table.row(vec![
                    parameter.origin.path.clone(),
                    parameter.display.text(*value),
                    stated_at(texts, parameter.origin.used_at),
                ]);
            }
        }
        if found {
            let _ = write!(text, "\n{}", table.render_left(1));
        }
        Ok(text)
    }
}

/// The elements and bodies of a model with their classes.
fn items_of(name: &str, model: &Model, texts: &SourceMap) -> String {
    let system = &model.compiled().system;
    let mut table = Table::new(&[&["path", "is", "stated at"]]);
    for body in &system.bodies {
        let place = stated_at(texts, body.origin.used_at);
        table.row(vec![body.origin.path.clone(), "body".to_owned(), place]);
    }
    for (element, class) in elements(system) {
        let place = stated_at(texts, element.origin.used_at);
        table.row(vec![element.origin.path.clone(), class.name.clone(), place]);
    }
    format!("model {name}\n{}", table.render_left(1))
}

/// Indices of repeated items, by path without index.
type Repeated = BTreeMap<String, BTreeSet<Vec<usize>>>;

/// The numbers of `2,1`; `None` for other text.
fn index_of(text: &str) -> Option<Vec<usize>> {
    text.split(',').map(|n| n.trim().parse().ok()).collect()
}

/// The error for a path with an index that the models do not make, or at an item that has none. The paths
/// of the models show the indices of parameters and outputs.
fn index_outside(path: &str, repeated: &Repeated, known: &[String]) -> Option<Error> {
    for (end, _) in path.match_indices(']') {
        let part = path.get(..=end)?;
        let (base, index) = path.get(..end)?.rsplit_once('[')?;
        let asked = index_of(index)?;
        let of_paths = known.iter().filter_map(|path| {
            let rest = path.strip_prefix(base)?.strip_prefix('[')?;
            index_of(rest.split_once(']')?.0)
        });
        let (made, stated) = match repeated.get(base) {
            Some(made) => (made.clone(), true),
            None => (of_paths.collect(), false),
        };
        let inside = |path: &str| matches!(path.strip_prefix(base), Some(rest) if rest.is_empty() || rest.starts_with('.'));
        let range = match stated || !made.is_empty() {
            true if made.contains(&asked) => continue,
            true => range_in_words(base, &made),
            false if known.iter().any(|path| inside(path)) => format!("{base} has no index"),
            false => continue,
        };
        return Some(Error::NoIndex {
            path: part.to_owned(),
            range,
        });
    }
    None
}

/// `the indices of rod are 1 to 4`.
fn range_in_words(base: &str, made: &BTreeSet<Vec<usize>>) -> String {
    let shown: Vec<String> = made.iter().map(|index| shown(index)).collect();
    let flat: Option<Vec<usize>> = made
        .iter()
        .map(|index| match index.as_slice() {
            [one] => Some(*one),
            _ => None,
        })
        .collect();
    match flat.as_deref() {
        Some([]) => return format!("the range of the index of {base} is empty"),
        Some([first, .., last]) if last - first + 1 == made.len() => {
            return format!("the indices of {base} are {first} to {last}");
        }
        _ => {}
    }
    let shown: Vec<&str> = shown.iter().map(String::as_str).collect();
    match shown.as_slice() {
        [only] => format!("the one index of {base} is {only}"),
        all => format!("the indices of {base} are {}", joined(all, MOST)),
    }
}

/// An index as a path shows it: `3`, `[2,1]`.
fn shown(index: &[usize]) -> String {
    let numbers: Vec<String> = index.iter().map(usize::to_string).collect();
    match numbers.as_slice() {
        [one] => one.clone(),
        all => format!("[{}]", all.join(",")),
    }
}

/// The values of a model with the defaults of its parameters.
fn bound(model: &Model) -> Result<Bound, Error> {
    let compiled = model.compiled();
    let defaults = vec![None; compiled.system.parameters.len()];
    let bound = compiled.bind.bind(&defaults, &compiled.system.tables);
    bound.map_err(|error| {
        let cause = Box::new(RuntimeError::from(error));
        let mut messages = Diagnostics::new();
        messages.push(crate::failure::diagnostic(&cause, &compiled.system));
        Error::Run {
            cause,
            report: Report::new(model.texts().clone(), messages),
        }
    })
}

/// The elements that the text states, with their classes.
fn elements(system: &System) -> impl Iterator<Item = (&Element, &ElementClass)> {
    let stated = system.elements.iter().filter(|e| e.role == Role::Dynamic);
    stated.filter_map(|element| Some((element, system.classes.get(element.class as usize)?)))
}

/// `engine.eng:84`; empty if the place is not known.
pub(crate) fn stated_at(texts: &SourceMap, place: Option<Location>) -> String {
    let found = place.and_then(|place| {
        let span = span(place);
        let (line, _) = texts.line_column(span.source, span.start)?;
        Some(format!("{}:{line}", texts.get(span.source)?.name))
    });
    found.unwrap_or_default()
}

struct Explained<'a> {
    program: &'a Program,
    system: &'a System,
    bound: &'a Bound,
}

impl Explained<'_> {
    /// The paths that have a text.
    fn paths(&self) -> impl Iterator<Item = &str> {
        let system = self.system;
        let bodies = system.bodies.iter().map(|body| body.origin.path.as_str());
        let markers = system.markers.iter().map(|m| m.origin.path.as_str());
        let elements = elements(system).map(|(element, _)| element.origin.path.as_str());
        let parameters = system.parameters.iter().map(|p| p.origin.path.as_str());
        let channels = system.channels.iter().map(|channel| channel.path.as_str());
        let all = bodies.chain(markers).chain(elements);
        all.chain(parameters).chain(channels)
    }

    fn of(&self, path: &str) -> Option<String> {
        let named = |origin: &Origin| origin.path == path;
        let system = self.system;
        if let Some((element, class)) = elements(system).find(|(e, _)| named(&e.origin)) {
            return Some(self.element(element, class));
        }
        if let Some(body) = system.bodies.iter().position(|body| named(&body.origin)) {
            return Some(self.body(body));
        }
        if let Some(marker) = system.markers.iter().position(|m| named(&m.origin)) {
            return Some(self.marker(marker));
        }
        let texts = self.program.texts();
        let parameters = system.parameters.iter().zip(&self.bound.parameters);
        let mut parameters = (0..).zip(parameters);
        if let Some((index, (parameter, value))) = parameters.find(|(_, (p, _))| named(&p.origin)) {
            let is = match system.inputs.iter().any(|input| input.parameter == index) {
                true => "an input",
                false => "a parameter",
            };
            return Some(format!(
                "{path}: {is}, {}, stated at {}\n",
                parameter.display.text(*value),
                stated_at(texts, parameter.origin.used_at)
            ));
        }
        if let Some(text) = self.group(path) {
            return Some(text);
        }
        // `main[1].force` is the path of three channels
        let part = |channel: &&Channel| {
            let rest = channel.path.strip_prefix(path);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        let channels: Vec<&Channel> = system.channels.iter().filter(part).collect();
        let first = channels.first()?;
        let element = system.elements.get(first.element as usize)?;
        // an output of a model or part is an element of its own
        let of = match (element.role, element.origin.path.rsplit_once('.')) {
            (Role::Output, Some((part, _))) => format!("the part {part}"),
            (Role::Output, None) => format!("the model {}", system.name),
            _ => element.origin.path.clone(),
        };
        let mut text = format!(
            "{path}: an output of {of}, stated at {}\n",
            stated_at(texts, element.origin.used_at)
        );
        for channel in channels {
            let frame = match channel.frame.as_str() {
                "" => String::new(),
                frame => format!(", along {frame}"),
            };
            let unit = &channel.display.symbol;
            let _ = writeln!(text, "  {} in {unit}{frame}", channel.path);
        }
        Some(text)
    }

    /// The text about a part, or about several items of one name: the bodies, elements and markers with this path, and the
    /// outputs of the part.
    fn group(&self, path: &str) -> Option<String> {
        let texts = self.program.texts();
        let rest = |other: &str| {
            let rest = other.strip_prefix(path)?;
            rest.chars().next().filter(|c| matches!(c, '.' | '['))
        };
        let bodies = self.system.bodies.iter().map(|b| (&b.origin, "body"));
        let all = elements(self.system).map(|(e, class)| (&e.origin, class.name.as_str()));
        let mut inside: Vec<(&Origin, &str)> = bodies.chain(all).collect();
        inside.retain(|(origin, _)| rest(&origin.path).is_some());
        if inside.is_empty() {
            // markers of a body, such as `crank.main`
            let markers = self.system.markers.iter().map(|m| (&m.origin, "marker"));
            inside.extend(markers.filter(|(origin, _)| rest(&origin.path) == Some('[')));
        }
        let is = match rest(&inside.first()?.0.path) {
            Some('.') => "a part",
            _ => "several items",
        };
        let mut text = format!("{path}: {is}\n\n");
        let mut table = Table::new(&[&["path", "is", "stated at"]]);
        for (origin, kind) in inside {
            let place = stated_at(texts, origin.used_at);
            table.row(vec![origin.path.clone(), kind.to_owned(), place]);
        }
        text.push_str(&table.render_left(1));
        let outputs = self.system.channels.iter().filter(|channel| {
            let element = self.system.elements.get(channel.element as usize);
            rest(&channel.path) == Some('.') && element.is_some_and(|e| e.role == Role::Output)
        });
        let outputs: Vec<&str> = outputs.map(|channel| channel.path.as_str()).collect();
        if !outputs.is_empty() {
            let _ = writeln!(text, "\n  outputs: {}", outputs.join(", "));
        }
        Some(text)
    }

    /// An element: class, markers, parameters, equations, outputs, text.
    fn element(&self, element: &Element, class: &ElementClass) -> String {
        let texts = self.program.texts();
        let path = &element.origin.path;
        let written = element
            .origin
            .defined_at
            .and_then(|at| self.program.class_at(span(at)));
        let mut text = format!("{path}: {}", class.name);
        if let Some(ClassText { levels, .. }) = &written
            && let Some((own, interfaces)) = levels.split_last()
        {
            let names: Vec<&str> = interfaces.iter().rev().map(|i| i.name.as_str()).collect();
            let fills = match names.is_empty() {
                true => String::new(),
                false => format!(", which fills {}", names.join(" : ")),
            };
            let kind = texts.text(own.span).split_whitespace().next();
            let kind = kind.unwrap_or("use");
            text = format!("{path}: a {kind} of the class {}{fills}", class.name);
        }
        let _ = writeln!(
            text,
            "\n  stated at {}",
            stated_at(texts, element.origin.used_at)
        );
        self.line(&mut text, element.origin.used_at);
        self.markers(&mut text, element, written.as_ref());
        self.parameters(&mut text, path);
        equations(&mut text, class, texts);
        self.outputs(&mut text, element);
        for level in written.iter().flat_map(|written| &written.levels) {
            self.level(&mut text, level);
        }
        text
    }

    /// The line of the text at a place.
    fn line(&self, text: &mut String, place: Option<Location>) {
        let Some(place) = place.map(span) else {
            return;
        };
        let source = self.program.texts().get(place.source);
        let all = source.map_or("", |source| source.text.as_str());
        let start = place.start as usize;
        let before = all.get(..start).unwrap_or_default();
        let begin = before.rfind('\n').map_or(0, |at| at + 1);
        let rest = all.get(begin..).unwrap_or_default();
        let _ = writeln!(
            text,
            "    {}",
            rest.lines().next().unwrap_or_default().trim()
        );
    }

    fn markers(&self, text: &mut String, element: &Element, written: Option<&ClassText>) {
        let mut table = Table::new(&[&["marker", "is", "on"]]);
        for (index, marker) in element.markers.iter().enumerate() {
            let Some(marker) = self.system.markers.get(*marker as usize) else {
                continue;
            };
            let name = written.and_then(|written| written.markers.get(index));
            table.row(vec![
                name.cloned().unwrap_or_default(),
                marker.origin.path.clone(),
                self.body_of(marker.body).to_owned(),
            ]);
        }
        if !element.markers.is_empty() {
            let _ = write!(text, "\n{}", table.render_left(1));
        }
    }

    fn body_of(&self, body: BodyRef) -> &str {
        match body {
            BodyRef::Ground => "ground",
            BodyRef::Body(index) => {
                let body = self.system.bodies.get(index as usize);
                body.map_or("", |body| body.origin.path.as_str())
            }
        }
    }

    /// The parameters of an item: those with its path before their name.
    fn parameters(&self, text: &mut String, path: &str) {
        let texts = self.program.texts();
        let mut table = Table::new(&[&["parameter", "value", "stated at"]]);
        let mut found = false;
        for (parameter, value) in self.system.parameters.iter().zip(&self.bound.parameters) {
            let Some(name) =
                (parameter.origin.path.strip_prefix(path)).and_then(|rest| rest.strip_prefix('.'))
            else {
                continue;
            };
            found = true;
            table.row(vec![
                name.to_owned(),
                parameter.display.text(*value),
                stated_at(texts, parameter.origin.used_at),
            ]);
        }
        if found {
            let _ = write!(text, "\n{}", table.render_left(1));
        }
    }

    fn outputs(&self, text: &mut String, element: &Element) {
        let own = |channel: &&Channel| {
            let owner = self.system.elements.get(channel.element as usize);
            owner.is_some_and(|owner| std::ptr::eq(owner, element))
        };
        let mut table = Table::new(&[&["output", "unit", "along"]]);
        let mut found = false;
        for channel in self.system.channels.iter().filter(own) {
            found = true;
            let name = channel.path.strip_prefix(&element.origin.path);
            table.row(vec![
                name.unwrap_or(&channel.path)
                    .trim_start_matches('.')
                    .to_owned(),
                channel.display.symbol.clone(),
                channel.frame.clone(),
            ]);
        }
        if found {
            let _ = write!(text, "\n{}", table.render_left(1));
        }
    }

    /// The text of a class or an interface with its comment.
    fn level(&self, text: &mut String, level: &LevelText) {
        let texts = self.program.texts();
        let place = Location {
            source: level.span.source.0,
            start: level.span.start,
            end: level.span.end,
        };
        let _ = writeln!(text, "\n  {}", stated_at(texts, Some(place)));
        for line in &level.docs {
            let _ = writeln!(text, "    {}", format!("/// {line}").trim_end());
        }
        for line in texts.text(level.span).lines() {
            let _ = writeln!(text, "    {line}");
        }
    }

    /// A body: mass, freedoms, markers, and the elements that act on it.
    fn body(&self, index: usize) -> String {
        let Some(body) = self.system.bodies.get(index) else {
            return String::new();
        };
        let path = &body.origin.path;
        let value = |slot| at(self.bound, slot);
        let place = stated_at(self.program.texts(), body.origin.used_at);
        let mut text = match &body.inertia {
            BodyInertia::Flexible(_) => format!(
                "{path}: a flexible body, stated at {place}\n  six freedoms, and those of its modes: `eng reduce` lists them\n"
            ),
            BodyInertia::Rigid {
                mass,
                center_of_mass,
                inertia,
            } => {
                let [x, y, z] = center_of_mass.map(|slot| short(1e3 * value(slot), 6));
                let [xx, yy, zz, xy, yz, zx] = inertia.map(|slot| short(value(slot), 6));
                format!(
                    "{path}: a rigid body with six freedoms, stated at {place}\n  mass {} kg, centre of mass [{x}, {y}, {z}] mm\n  inertia about it xx {xx}, yy {yy}, zz {zz}, xy {xy}, yz {yz}, zx {zx} kg m²\n",
                    short(value(*mass), 6)
                )
            }
        };
        let mut table = Table::new(&[
            &["marker", "x", "y", "z", "used by"],
            &["", "mm", "mm", "mm", ""],
        ]);
        let mut found = false;
        for (number, marker) in self.system.markers.iter().enumerate() {
            if marker.body != BodyRef::Body(index as u32) {
                continue;
            }
            found = true;
            // the reduction places a marker of a flexible body
            let position = marker.position.map(|slot| match marker.shape {
                Some(_) => "–".to_owned(),
                None => short(1e3 * value(slot), 6),
            });
            let [x, y, z] = position;
            table.row(vec![
                marker.origin.path.clone(),
                x,
                y,
                z,
                self.users(number),
            ]);
        }
        if found {
            let _ = write!(text, "\n{}", table.render_left(4));
        }
        self.parameters(&mut text, path);
        text
    }

    /// The elements that use a marker.
    fn users(&self, marker: usize) -> String {
        let all = elements(self.system);
        let own = all.filter(|(element, _)| element.markers.contains(&(marker as u32)));
        let paths: Vec<&str> = own
            .map(|(element, _)| element.origin.path.as_str())
            .collect();
        joined(&paths, MOST)
    }

    fn marker(&self, index: usize) -> String {
        let Some(marker) = self.system.markers.get(index) else {
            return String::new();
        };
        let value = |slot| at(self.bound, slot);
        // no text states the origin of a body and the axes of the ground
        let place = match (marker.origin.used_at, marker.body) {
            (None, BodyRef::Ground) => "which every model has".to_owned(),
            (None, BodyRef::Body(_)) => "which every body has".to_owned(),
            (at, _) => format!("stated at {}", stated_at(self.program.texts(), at)),
        };
        let mut text = format!(
            "{}: a marker on {}, {place}\n",
            marker.origin.path,
            self.body_of(marker.body),
        );
        if marker.shape.is_none() && marker.placed_at.is_none() {
            let [x, y, z] = marker.position.map(|slot| short(1e3 * value(slot), 6));
            let _ = writeln!(text, "  at [{x}, {y}, {z}] mm of its body");
        }
        if marker.placed_at.is_none() {
            let r = marker.orientation.map(value);
            for (column, name) in ["x", "y", "z"].into_iter().enumerate() {
                // a rounding error is no direction
                let [a, b, c] = [0, 3, 6].map(|row| {
                    let part = r[row + column];
                    short(if part.abs() < 1e-12 { 0.0 } else { part }, 6)
                });
                let _ = writeln!(text, "  {name} along [{a}, {b}, {c}] of its body");
            }
        }
        let users = self.users(index);
        if !users.is_empty() {
            let _ = writeln!(text, "  used by {users}");
        }
        text
    }
}

/// The equations, states and loads of a class.
fn equations(text: &mut String, class: &ElementClass, texts: &SourceMap) {
    let taken = match class.rows.len() {
        0 => "takes no freedom".to_owned(),
        rows => format!("takes {}", counted(rows, "freedom", "freedoms")),
    };
    let loads = match (class.facts.applies_load, class.facts.uses_twist) {
        (false, _) => "",
        (true, false) => "; applies loads that do not depend on velocities",
        (true, true) => "; applies loads that depend on velocities",
    };
    let _ = writeln!(text, "\n  {taken}{loads}");
    for row in &class.rows {
        let _ = writeln!(
            text,
            "    {}   {}",
            row.text,
            stated_at(texts, row.defined_at)
        );
    }
    for state in &class.states {
        let _ = writeln!(text, "    the state {} has a rate", state.name);
    }
}
