//! Flexible bodies: what is to be reduced, with its markers and mode set.

use super::body::index_text;
use super::scalar::Scalar;
use super::value::{ScopeId, Value};
use super::{Elaborator, Entry, Eval, Reported, location};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use crate::words::{Place, Word, argument, word};
use eng_grammar::ast::{self, ExprKind, IndexArgument, ItemKind, Kind, Statement};
use eng_grammar::{Diagnostic, Span};
use eng_system::flexible::{
    Damping, FREEDOM_NAMES, FlexibleSource, Freedoms, MarkerPlace, MarkerSource, MaterialSource,
    MatrixSource, MeshSource, ModeCount,
};
use eng_system::system::{Body, BodyInertia, BodyRef, Origin};
use std::rc::Rc;

/// Markers by name, as a mode set writes them; found in the body that uses the set.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerName {
    name: String,
    /// Of an array: these.
    index: Option<Vec<i64>>,
    span: Span,
}

/// Part of a mode set before its markers are found.
#[derive(Clone, Debug, PartialEq)]
pub struct ModePart {
    kind: PartKind,
    at: Vec<MarkerName>,
    /// As listed; else those that the model's elements can load.
    freedoms: Option<Freedoms>,
    span: Span,
}

#[derive(Clone, Debug, PartialEq)]
enum PartKind {
    Static,
    Constraint,
    Normal(ModeCount),
    Given { format: String, file: String },
}

/// A flexible body before it is known which elements stand on its markers.
#[derive(Clone, Debug)]
pub(crate) struct FlexibleDraft {
    pub source: FlexibleSource,
    /// Terms whose markers are known, with their freedoms if listed.
    pub terms: Vec<TermDraft>,
    /// The system's markers, in the order of the source's.
    pub markers: Vec<u32>,
    /// Marker at the frame's origin.
    pub origin: u32,
    /// Names of the body.
    pub scope: ScopeId,
    pub support_span: Option<Span>,
}

/// A term with its markers found.
#[derive(Clone, Debug)]
pub(crate) struct TermDraft {
    pub kind: TermKind,
    pub at: Vec<u32>,
    pub freedoms: Option<Freedoms>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub(crate) enum TermKind {
    Static,
    Constraint,
    Normal(ModeCount),
    Given { format: String, file: String },
}

impl<'a> Elaborator<'a, '_> {
    /// One flexible body.
    pub fn flexible_body(
        &mut self,
        declaration: &'a ast::Declaration,
        block: &'a ast::Block,
        scope: ScopeId,
        path: String,
    ) -> Eval<u32> {
        self.count_instance(declaration.name.span)?;
        let module = self.scope(scope).module;
        let own = self.new_scope(Some(scope), module, path.clone());
        self.bench.bind.owner.clone_from(&path);
        let body = self.bodies.len() as u32;
        let index = self.flexible.len() as u32;
        let place = Origin {
            path: path.clone(),
            used_at: Some(location(declaration.name.span)),
            defined_at: None,
        };
        self.bodies.push(Body {
            origin: place.clone(),
            inertia: BodyInertia::Flexible(index),
            position: None,
            orientation: None,
        });
        self.body_scopes.push(own);
        let reference = BodyRef::Body(body);
        let origin = self.frame_marker(reference, format!("{path}.origin"));
        self.define(own, "origin", Entry::Value(Value::Marker(origin)));
        // holds its place while the parts are read
        self.flexible.push(None);
        let mut markers = Vec::new();
        let mut known = Vec::new();
        for item in &block.items {
            if let ItemKind::Declaration(d) = &item.kind
                && d.kind == Kind::Marker
            {
                // a marker's own message does not hide those of its neighbours
                let entry = match self.markers_on_mesh(
                    d,
                    reference,
                    own,
                    &path,
                    &mut markers,
                    &mut known,
                ) {
                    Ok(marker) => Entry::Value(marker),
                    Err(_) => Entry::Failed,
                };
                self.define(own, &d.name.text, entry);
            }
        }
        let mut mesh = None;
        let (mut stiffness, mut mass, mut material) = (None, None, None);
        let mut element_rules = "exact".to_owned();
        let (mut support, mut support_span) = (Vec::new(), None);
        let (mut terms, mut modes_at) = (Vec::new(), None);
        let mut damping = None;
        let mut geometric_stiffness = false;
        for item in &block.items {
            let ItemKind::Attribute(a) = &item.kind else {
                continue;
            };
            let value = &a.value;
            match a.name.text.as_str() {
                "mesh" => mesh = Some(self.mesh_source(value, own)?),
                "stiffness" => stiffness = Some(self.matrix_source(value, own)?),
                "mass" => mass = Some(self.matrix_source(value, own)?),
                "material" => material = Some(self.material_source(value, own)?),
                "element_rules" => element_rules = bare_word(value),
                "support" => {
                    support_span = Some(value.span);
                    let names = self.marker_names(value, own)?;
                    for name in names {
                        support.extend(self.found(&name, &known, &path)?);
                    }
                    for index in &support {
                        if let Some((_, marker)) = markers.get(*index as usize) {
                            self.used_marker(*marker);
                        }
                    }
                }
                "modes" => {
                    modes_at = Some(location(value.span));
                    let parts = match self.evaluate(value, own)? {
                        Value::ModeSet(parts) => parts,
                        other => return Err(self.unfit(value.span, "a mode set", &other)),
                    };
                    for part in parts.iter() {
                        terms.push(self.term(part, &known, &path)?);
                    }
                }
                "damping" => damping = Some(self.damping(value, own)?),
                "geometric_stiffness" => match self.evaluate(value, own)? {
                    Value::Bool(b) => geometric_stiffness = b,
                    other => return Err(self.unfit(value.span, "true or false", &other)),
                },
                _ => return Err(self.internal(a.name.span, "no attribute of a flexible body")),
            }
        }
        let (Some(mesh), Some(modes_at), Some(damping)) = (mesh, modes_at, damping) else {
            return Err(self.internal(
                declaration.name.span,
                "a flexible body without mesh, modes or damping",
            ));
        };
        if stiffness.is_some() != mass.is_some() {
            return Err(self.report(
                Diagnostic::error(
                    codes::FLEXIBLE_MATRICES,
                    format!("{path} has one matrix from a file and one from its mesh"),
                )
                .at(declaration.name.span, "stiffness and mass belong together")
                .with_help("give both `stiffness` and `mass`, or neither"),
            ));
        }
        let (sources, indices): (Vec<MarkerSource>, Vec<u32>) = markers.into_iter().unzip();
        self.flexible[index as usize] = Some(FlexibleDraft {
            source: FlexibleSource {
                origin: place,
                mesh,
                stiffness,
                mass,
                material,
                element_rules,
                markers: sources,
                support,
                support_at: support_span.map(location),
                modes: Vec::new(),
                modes_at,
                damping,
                geometric_stiffness,
            },
            terms,
            markers: indices,
            origin,
            scope: own,
            support_span,
        });
        for item in &block.items {
            match &item.kind {
                ItemKind::Statement(Statement::Start { target, value }) => {
                    let _ = self.body_start(body, origin, target, value, own, true);
                }
                ItemKind::Statement(Statement::Guess { target, value }) => {
                    let _ = self.body_start(body, origin, target, value, own, false);
                }
                _ => {}
            }
        }
        Ok(body)
    }

    /// Markers of one declaration; `known` gets their names with the positions in their array.
    fn markers_on_mesh(
        &mut self,
        declaration: &'a ast::Declaration,
        body: BodyRef,
        scope: ScopeId,
        path: &str,
        markers: &mut Vec<(MarkerSource, u32)>,
        known: &mut Vec<(String, Vec<usize>)>,
    ) -> Eval<Value<'a>> {
        let ast::Form::Instance { value, .. } = &declaration.form else {
            return Err(self.internal(declaration.name.span, "a marker without a place"));
        };
        let name = &declaration.name.text;
        let mut made = Vec::new();
        self.for_each(&declaration.index, scope, &mut |e, inner, position| {
            let text = format!("{name}{}", index_text(position));
            let (place, rigid, center, axes) = e.place_on_mesh(value, inner)?;
            let shape = markers.len() as u32;
            let marker = e.marker_of_mesh(
                body,
                format!("{path}.{text}"),
                declaration.name.span,
                axes,
                shape,
            );
            markers.push((
                MarkerSource {
                    name: text,
                    at: location(declaration.name.span),
                    place,
                    rigid,
                    center,
                    axes,
                },
                marker,
            ));
            known.push((name.clone(), position.to_vec()));
            made.push((position.to_vec(), Value::Marker(marker)));
            Ok(())
        })?;
        if declaration.index.is_empty() {
            made.pop().map(|m| m.1).ok_or(Reported)
        } else {
            Ok(Value::Family(made))
        }
    }

    #[allow(clippy::type_complexity)]
    fn place_on_mesh(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<(MarkerPlace, bool, Option<[f64; 3]>, [f64; 9])> {
        let (word, arguments) = self.worded(Place::Marker, value)?;
        let get = |name: &str| argument(word, arguments, name);
        let vector = |e: &mut Self, name: &str| -> Eval<Option<[f64; 3]>> {
            get(name).map(|x| e.known_vector(x, scope)).transpose()
        };
        let length = |e: &mut Self, name: &str| -> Eval<Option<f64>> {
            get(name).map(|x| e.known_number(x, scope)).transpose()
        };
        let axis = |e: &mut Self, name: &str| -> Eval<[f64; 3]> {
            match get(name) {
                Some(expr) => e.known_axis(expr, scope),
                None => Err(e.internal(value.span, "a place without its axis")),
            }
        };
        let positive = |e: &mut Self, name: &str| -> Eval<f64> {
            let Some(expr) = get(name) else {
                return Err(e.internal(value.span, &format!("a place without `{name}`")));
            };
            let x = e.known_number(expr, scope)?;
            if x > 0.0 && x.is_finite() {
                return Ok(x);
            }
            Err(e.report(
                Diagnostic::error(
                    codes::FLEXIBLE_NUMBER,
                    format!("`{name}` of `{}` must be positive", word.word),
                )
                .at(expr.span, "this is not"),
            ))
        };
        let text = |e: &mut Self, name: &str| -> Eval<String> {
            e.text_of(get(name), scope)?.ok_or(Reported)
        };
        let center = vector(self, "center")?;
        let rigid = get("tie").is_some_and(|t| bare_word(t) == "rigid");
        let place = match word.word {
            "node" => {
                let Some(id) = get("id") else {
                    return Err(self.internal(value.span, "a node without its number"));
                };
                let number = self.integer(id, scope)?;
                match u64::try_from(number) {
                    Ok(n) if n > 0 => MarkerPlace::Node(n),
                    _ => {
                        return Err(self.report(
                            Diagnostic::error(
                                codes::FLEXIBLE_NUMBER,
                                "the number of a node is positive",
                            )
                            .at(id.span, format!("this is {number}")),
                        ));
                    }
                }
            }
            "set" => MarkerPlace::Set(text(self, "name")?),
            "property" => MarkerPlace::Property(text(self, "name")?),
            "ring" => {
                let radius = positive(self, "radius")?;
                MarkerPlace::Ring {
                    center: center.unwrap_or_default(),
                    axis: axis(self, "axis")?,
                    radius,
                    width: positive(self, "width")?,
                    // chords of coarse facets sink by some percent of the radius; nodes lie on the surface itself
                    tolerance: length(self, "tolerance")?.unwrap_or(1e-3 * radius),
                }
            }
            "patch" => {
                let radius = positive(self, "radius")?;
                MarkerPlace::Patch {
                    center: center.unwrap_or_default(),
                    normal: axis(self, "normal")?,
                    radius,
                    tolerance: length(self, "tolerance")?.unwrap_or(1e-3 * radius),
                }
            }
            "plane" => MarkerPlace::Patch {
                center: vector(self, "point")?.unwrap_or_default(),
                normal: axis(self, "normal")?,
                radius: f64::INFINITY,
                tolerance: length(self, "tolerance")?.unwrap_or(1e-6),
            },
            _ => return Err(self.internal(value.span, "no place on a mesh")),
        };
        // a ring or a patch is named by its middle; a set's is the mean of its nodes unless stated
        let center = match word.word {
            "set" | "property" | "plane" | "ring" | "patch" => center,
            _ => None,
        };
        let x = get("x").map(|x| self.direction(x, scope)).transpose()?;
        let z = get("z").map(|z| self.direction(z, scope)).transpose()?;
        self.not_parallel(x, z, value.span, scope)?;
        let nodes = self.orientation(x, z);
        let mut axes = [0.0; 9];
        for (number, node) in axes.iter_mut().zip(nodes) {
            *number = match self.bench.bind.graph.as_constant(node) {
                Some(known) => known,
                None => {
                    return Err(self.report(
                        Diagnostic::error(
                            codes::NOT_KNOWN,
                            "the axes of a marker on a mesh must be known while compiling",
                        )
                        .at(value.span, "depend on a `param`")
                        .with_help("make the parameter a `const`"),
                    ));
                }
            };
        }
        Ok((place, rigid, center, axes))
    }

    /// The word that is called and its arguments.
    fn worded(
        &mut self,
        place: Place,
        value: &'a ast::Expr,
    ) -> Eval<(&'static Word, &'a [ast::Argument])> {
        if let ExprKind::Call { callee, arguments } = &value.kind
            && let ExprKind::Name(name) = &callee.kind
            && let Some(word) = word(place, name)
        {
            return Ok((word, arguments));
        }
        Err(self.internal(value.span, &format!("this is not {}", place.text())))
    }

    fn known_number(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<f64> {
        let value = self.evaluate(expr, scope)?;
        let scalar = self.as_scalar(value, expr.span)?;
        self.structural(scalar, expr.span)
    }

    fn known_vector(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<[f64; 3]> {
        let value = self.evaluate(expr, scope)?;
        let v = self.as_vector(value, expr.span)?;
        let mut numbers = [0.0; 3];
        for (number, s) in numbers.iter_mut().zip(v) {
            *number = self.structural(s, expr.span)?;
        }
        Ok(numbers)
    }

    fn known_axis(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<[f64; 3]> {
        match bare_word(expr).as_str() {
            "x" => return Ok([1.0, 0.0, 0.0]),
            "y" => return Ok([0.0, 1.0, 0.0]),
            "z" => return Ok([0.0, 0.0, 1.0]),
            _ => {}
        }
        let unit: [Scalar; 3] = self.direction(expr, scope)?;
        let mut numbers = [0.0; 3];
        for (number, s) in numbers.iter_mut().zip(unit) {
            *number = self.structural(s, expr.span)?;
        }
        Ok(numbers)
    }

    fn text_of(&mut self, expr: Option<&'a ast::Expr>, scope: ScopeId) -> Eval<Option<String>> {
        let Some(expr) = expr else {
            return Ok(None);
        };
        if !matches!(expr.kind, ExprKind::Text(_)) {
            return match self.evaluate(expr, scope)? {
                Value::Text(text) => Ok(Some(text)),
                other => Err(self.unfit(expr.span, "a text", &other)),
            };
        }
        let written = crate::words::inside_quotes(self.sources, expr.span);
        let mut text = String::new();
        for part in eng_grammar::parse_message(&written, self.diagnostics) {
            match part {
                eng_grammar::MessagePart::Text(t) => text.push_str(&t),
                eng_grammar::MessagePart::Value { value, .. } => {
                    match self.evaluate_owned(&value, scope)? {
                        Value::Int(i) => text.push_str(&i.to_string()),
                        Value::Text(t) => text.push_str(&t),
                        other => {
                            let found = other.kind();
                            return Err(self.report(
                                Diagnostic::error(
                                    codes::MESSAGE_FORM,
                                    "a name is made of texts and whole numbers",
                                )
                                .at(value.span, format!("this is {found}")),
                            ));
                        }
                    }
                }
            }
        }
        Ok(Some(text))
    }

    fn mesh_source(&mut self, value: &'a ast::Expr, scope: ScopeId) -> Eval<MeshSource> {
        let (word, arguments) = self.worded(Place::Mesh, value)?;
        let file = self.text_of(argument(word, arguments, "file"), scope)?;
        let units = argument(word, arguments, "units").map(bare_word);
        let (Some(file), Some(units)) = (file, units) else {
            return Err(self.internal(value.span, "a mesh without file or units"));
        };
        Ok(MeshSource {
            format: word.word.to_owned(),
            file,
            units,
            at: location(value.span),
        })
    }

    fn matrix_source(&mut self, value: &'a ast::Expr, scope: ScopeId) -> Eval<MatrixSource> {
        let (word, arguments) = self.worded(Place::Matrix, value)?;
        let Some(file) = self.text_of(argument(word, arguments, "file"), scope)? else {
            return Err(self.internal(value.span, "a matrix without a file"));
        };
        Ok(MatrixSource {
            format: word.word.to_owned(),
            file,
            matrix: self.text_of(argument(word, arguments, "matrix"), scope)?,
            freedoms: self.text_of(argument(word, arguments, "freedoms"), scope)?,
            at: location(value.span),
        })
    }

    fn material_source(&mut self, value: &'a ast::Expr, scope: ScopeId) -> Eval<MaterialSource> {
        let record = match self.evaluate(value, scope)? {
            Value::Record(_, record) => record,
            other => return Err(self.unfit(value.span, "a material", &other)),
        };
        let mut field = |name: &str| -> Eval<f64> {
            let v = self.entry(record, name, value.span)?;
            let s = self.as_scalar(v, value.span)?;
            self.structural(s, value.span)
        };
        let material = MaterialSource {
            young: field("young_modulus")?,
            poisson: field("poisson_ratio")?,
            density: field("density")?,
            at: location(value.span),
        };
        let sound = material.young > 0.0
            && material.poisson > -1.0
            && material.poisson < 0.5
            && material.density > 0.0
            && (material.young * material.density).is_finite();
        if !sound {
            return Err(self.report(
                Diagnostic::error(codes::FLEXIBLE_NUMBER, "there is no such material")
                    .at(value.span, "of these values")
                    .with_help("Young's modulus and density are positive, Poisson's ratio is between -1 and 0.5"),
            ));
        }
        Ok(material)
    }

    fn damping(&mut self, value: &'a ast::Expr, scope: ScopeId) -> Eval<Damping> {
        let not_negative = |e: &mut Self, x: f64, what: &str| -> Eval<f64> {
            if x >= 0.0 && x.is_finite() {
                return Ok(x);
            }
            Err(e.report(
                Diagnostic::error(
                    codes::FLEXIBLE_NUMBER,
                    format!("{what} must not be negative"),
                )
                .at(value.span, "this feeds energy into the modes"),
            ))
        };
        let call = match &value.kind {
            ExprKind::Call { callee, .. } => match &callee.kind {
                ExprKind::Name(name) => word(Place::Damping, name),
                _ => None,
            },
            _ => None,
        };
        let Some(word) = call else {
            let ratio = self.known_number(value, scope)?;
            return Ok(Damping::Modal {
                ratio: not_negative(self, ratio, "the damping ratio")?,
                up_to: f64::INFINITY,
            });
        };
        let (_, arguments) = self.worded(Place::Damping, value)?;
        let mut number = |name: &str| -> Eval<f64> {
            match argument(word, arguments, name) {
                Some(expr) => self.known_number(expr, scope),
                None => Err(Reported),
            }
        };
        if word.word == "modal" {
            let (ratio, up_to) = (number("ratio")?, number("up_to")?);
            if up_to.is_nan() || up_to <= 0.0 {
                return Err(self.report(
                    Diagnostic::error(
                        codes::FLEXIBLE_NUMBER,
                        "`up_to` of `modal` must be positive",
                    )
                    .at(value.span, "a ratio up to which frequency?"),
                ));
            }
            Ok(Damping::Modal {
                ratio: not_negative(self, ratio, "the damping ratio")?,
                up_to,
            })
        } else {
            let (mass, stiffness) = (number("mass")?, number("stiffness")?);
            Ok(Damping::Rayleigh {
                mass: not_negative(self, mass, "the factor of the mass")?,
                stiffness: not_negative(self, stiffness, "the factor of the stiffness")?,
            })
        }
    }

    /// `static(…)` and its like, as a value.
    pub fn mode_set(
        &mut self,
        word: &'static Word,
        span: Span,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let get = |name: &str| argument(word, arguments, name);
        let names = |e: &mut Self, name: &str| -> Eval<Vec<MarkerName>> {
            match get(name) {
                Some(expr) => e.marker_names(expr, scope),
                None => Ok(Vec::new()),
            }
        };
        let freedoms = get("freedoms").map(freedoms_of);
        let part = |kind, at| ModePart {
            kind,
            at,
            freedoms,
            span,
        };
        let parts = match word.word {
            "static" => vec![part(PartKind::Static, names(self, "at")?)],
            "constraint" => vec![part(PartKind::Constraint, names(self, "at")?)],
            "normal" => {
                let count = self.mode_count(word, span, arguments, scope)?;
                vec![part(PartKind::Normal(count), names(self, "fixed")?)]
            }
            "craig_bampton" => {
                let count = self.mode_count(word, span, arguments, scope)?;
                let at = names(self, "at")?;
                vec![
                    part(PartKind::Constraint, at.clone()),
                    part(PartKind::Normal(count), at),
                ]
            }
            _ => {
                let file = self.text_of(get("file"), scope)?;
                let format = get("format").map(bare_word);
                let (Some(file), Some(format)) = (file, format) else {
                    return Err(self.internal(span, "shapes without file or format"));
                };
                vec![part(PartKind::Given { format, file }, Vec::new())]
            }
        };
        Ok(Value::ModeSet(Rc::new(parts)))
    }

    fn mode_count(
        &mut self,
        word: &'static Word,
        span: Span,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<ModeCount> {
        if let Some(expr) = argument(word, arguments, "number") {
            let n = self.integer(expr, scope)?;
            return match u32::try_from(n) {
                Ok(n) if (1..=2000).contains(&n) => Ok(ModeCount::Number(n)),
                _ => Err(self.report(
                    Diagnostic::error(
                        codes::FLEXIBLE_NUMBER,
                        "a number of modes is from 1 to 2000",
                    )
                    .at(expr.span, format!("this is {n}")),
                )),
            };
        }
        let Some(expr) = argument(word, arguments, "up_to") else {
            return Err(self.internal(span, "neither a number of modes nor a frequency"));
        };
        let frequency = self.known_number(expr, scope)?;
        if frequency > 0.0 && frequency.is_finite() {
            return Ok(ModeCount::UpTo(frequency));
        }
        Err(self.report(
            Diagnostic::error(codes::FLEXIBLE_NUMBER, "`up_to` must be positive")
                .at(expr.span, "this is not"),
        ))
    }

    fn marker_names(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<Vec<MarkerName>> {
        match &expr.kind {
            ExprKind::List { items, unit: None } => {
                let mut names = Vec::new();
                for item in items {
                    names.extend(self.marker_names(item, scope)?);
                }
                Ok(names)
            }
            ExprKind::Name(name) => Ok(vec![MarkerName {
                name: name.clone(),
                index: None,
                span: expr.span,
            }]),
            ExprKind::Index { base, indices } => {
                let mut names = self.marker_names(base, scope)?;
                for index in indices {
                    let IndexArgument::At(at) = index else {
                        continue;
                    };
                    let chosen = match self.evaluate(at, scope)? {
                        Value::Int(i) => vec![i],
                        Value::List(items) => items
                            .iter()
                            .filter_map(|v| match v {
                                Value::Int(i) => Some(*i),
                                _ => None,
                            })
                            .collect(),
                        other => return Err(self.unfit(at.span, "an index", &other)),
                    };
                    for name in &mut names {
                        name.index = Some(chosen.clone());
                        name.span = expr.span;
                    }
                }
                Ok(names)
            }
            ExprKind::Error => Err(Reported),
            _ => Err(self.internal(expr.span, "no marker's name")),
        }
    }

    /// Indices of the markers of a name.
    fn found(
        &mut self,
        wanted: &MarkerName,
        known: &[(String, Vec<usize>)],
        path: &str,
    ) -> Eval<Vec<u32>> {
        let of_name = |(i, (name, position)): (usize, &(String, Vec<usize>))| {
            (*name == wanted.name).then(|| (i as u32, position.clone()))
        };
        let family: Vec<(u32, Vec<usize>)> = known.iter().enumerate().filter_map(of_name).collect();
        if family.is_empty() {
            let names = || known.iter().map(|(name, _)| name.as_str());
            let mut message = Diagnostic::error(
                codes::MODE_MARKER,
                format!("{path} has no marker `{}`", wanted.name),
            )
            .at(wanted.span, "not among its markers");
            message = match nearest(&wanted.name, names()) {
                Some(near) => message
                    .with_help(format!("did you mean `{near}`?"))
                    .with_fix(format!("write `{near}`"), wanted.span, near),
                None => {
                    let mut distinct: Vec<&str> = names().collect();
                    distinct.dedup();
                    message.with_note(format!("it has {}", listing(distinct, 12)))
                }
            };
            return Err(self.report(message));
        }
        let Some(chosen) = &wanted.index else {
            return Ok(family.into_iter().map(|(i, _)| i).collect());
        };
        let mut found = Vec::with_capacity(chosen.len());
        for index in chosen {
            let marker = family
                .iter()
                .find(|(_, position)| position.iter().map(|p| *p as i64).eq([*index]));
            match marker {
                Some((i, _)) => found.push(*i),
                None => {
                    return Err(self.report(
                        Diagnostic::error(
                            codes::MODE_MARKER,
                            format!("{path} has no marker `{}[{index}]`", wanted.name),
                        )
                        .at(wanted.span, "no such index")
                        .with_note(format!("there are {} of this name", family.len())),
                    ));
                }
            }
        }
        Ok(found)
    }

    fn term(
        &mut self,
        part: &ModePart,
        known: &[(String, Vec<usize>)],
        path: &str,
    ) -> Eval<TermDraft> {
        let mut at = Vec::new();
        for name in &part.at {
            at.extend(self.found(name, known, path)?);
        }
        Ok(TermDraft {
            kind: match &part.kind {
                PartKind::Static => TermKind::Static,
                PartKind::Constraint => TermKind::Constraint,
                PartKind::Normal(count) => TermKind::Normal(*count),
                PartKind::Given { format, file } => TermKind::Given {
                    format: format.clone(),
                    file: file.clone(),
                },
            },
            at,
            freedoms: part.freedoms,
            span: part.span,
        })
    }

    /// Bodies with supports stand on the ground: their frames are welded to it where they are at the start.
    pub fn weld_supports(&mut self) {
        let welds: Vec<(String, u32, ScopeId, Span)> = self
            .flexible
            .iter()
            .flatten()
            .filter_map(|d| {
                let path = d.source.origin.path.clone();
                Some((path, d.origin, d.scope, d.support_span?))
            })
            .collect();
        for (path, origin, scope, span) in welds {
            let class = self
                .program
                .weld()
                .map_or(Err(Reported), |id| self.class_of(id, span));
            let Ok(class) = class else {
                self.internal(span, "the library's weld is not there");
                continue;
            };
            let path = format!("{path}.support");
            let ground = self.ground_at(origin, format!("ground at {path}"), span);
            let bound = vec![
                (
                    "a".to_owned(),
                    super::Argument::Value(Value::Marker(origin)),
                ),
                (
                    "b".to_owned(),
                    super::Argument::Value(Value::Marker(ground)),
                ),
            ];
            let caller = self.module_scopes[class.definition.module as usize];
            let made = self.element_of_class(class, bound, None, caller, path, span);
            self.bench.element = None;
            let entry = match made {
                Ok(element) => Entry::Value(Value::Element(element)),
                Err(_) => Entry::Failed,
            };
            self.define(scope, "support", entry);
        }
    }
}

/// The word of a bare name; empty for anything else.
fn bare_word(expr: &ast::Expr) -> String {
    match &expr.kind {
        ExprKind::Name(name) => name.clone(),
        _ => String::new(),
    }
}

fn freedoms_of(expr: &ast::Expr) -> Freedoms {
    let bit = |e: &ast::Expr| {
        let name = bare_word(e);
        FREEDOM_NAMES
            .iter()
            .position(|n| *n == name)
            .map_or(0, |i| 1 << i)
    };
    match &expr.kind {
        ExprKind::List { items, .. } => items.iter().fold(0, |bits, e| bits | bit(e)),
        _ => bit(expr),
    }
}
