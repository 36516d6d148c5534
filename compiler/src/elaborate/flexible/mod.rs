//! Flexible bodies: the source of the reduction, with its markers and mode set.

mod attributes;
mod markers;
mod modes;
mod stack;

use super::scalar::Scalar;
use super::value::{ScopeId, Value};
use super::{Elaborator, Entry, Eval, location};
use crate::codes;
use crate::words::{DECK, Place, Word, argument, word};
use eng_grammar::ast::{self, ExprKind, ItemKind, Kind};
use eng_grammar::{Diagnostic, Span};
use eng_system::flexible::{
    ALL_FREEDOMS, FlexibleSource, Freedoms, Interface, MarkerSource, MatrixSource, MeshSource,
    ModeCount,
};
use eng_system::mesh_files::{ShapeFormat, Stated};
use eng_system::system::{BodyInertia, BodyRef};
use std::rc::Rc;

/// The markers of a body, each with its number in the system.
type MarkersOnMesh = Vec<(MarkerSource, u32)>;
/// Their names and indices.
type MarkerNames = Vec<(String, Vec<usize>)>;

/// What holds a body.
#[derive(Default)]
struct Supports {
    /// Whole markers.
    markers: Vec<u32>,
    /// Freedoms of markers.
    freedoms: Vec<Interface>,
    /// Whether the supports of its deck do.
    of_deck: bool,
}

/// Markers by name, as written in a mode set. They belong to the body that uses the set.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerName {
    name: String,
    /// Indices in an array of markers.
    index: Option<Vec<i64>>,
    span: Span,
}

impl MarkerName {
    /// Whether it is this name, without an index.
    fn is(&self, name: &str) -> bool {
        self.name == name && self.index.is_none()
    }
}

/// Part of a mode set before its markers are found.
#[derive(Clone, Debug, PartialEq)]
pub struct ModePart {
    kind: PartKind,
    at: Vec<MarkerName>,
    /// The listed freedoms; `None`: those that the model's elements can load.
    freedoms: Option<Freedoms>,
    span: Span,
}

#[derive(Clone, Debug, PartialEq)]
enum PartKind {
    Static,
    Constraint,
    Normal(ModeCount),
    Given { format: ShapeFormat, file: String },
}

/// A flexible body before the elements on its markers are known.
#[derive(Clone, Debug)]
pub(crate) struct FlexibleDraft {
    pub source: FlexibleSource,
    /// Terms with known markers, and with their freedoms if listed.
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
    Given { format: ShapeFormat, file: String },
}

impl<'a> Elaborator<'a, '_> {
    /// Elaborates one flexible body.
    pub fn flexible_body(
        &mut self,
        declaration: &'a ast::Declaration,
        block: &'a ast::Block,
        scope: ScopeId,
        path: String,
    ) -> Eval<u32> {
        let own = self.body_scope(declaration, block, scope, &path)?;
        let index = self.draft.flexible.len() as u32;
        let inertia = BodyInertia::Flexible(index);
        let (body, origin) = self.add_body(declaration, inertia, own, &path);
        let reference = BodyRef::Body(body);
        let place = self.draft.bodies[body as usize].origin.clone();
        // reserves the index while the parts are read
        self.draft.flexible.push(None);
        let (markers, known) = self.markers_of_block(block, reference, own, &path);
        let mut mesh = None;
        let (mut stiffness, mut mass, mut recovery, mut material) = (None, None, None, None);
        let mut element_rules = None;
        let (mut support, mut support_span) = (Supports::default(), None);
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
                "stiffness" => stiffness = Some(self.matrix_source(Place::Matrix, value, own)?),
                "mass" => mass = Some(self.matrix_source(Place::Matrix, value, own)?),
                "recovery" => recovery = Some(self.recovery_source(value, own)?),
                "material" => material = Some(self.material_source(value, own)?),
                "element_rules" => element_rules = meaning(value),
                "support" => {
                    support_span = Some(value.span);
                    support = self.supports(value, own, (&markers, &known), &path)?;
                }
                "modes" => {
                    modes_at = Some(location(value.span));
                    let parts = self.evaluate(value, own)?;
                    let parts: Rc<Vec<ModePart>> = self.read(parts, value.span)?;
                    for part in parts.iter() {
                        terms.push(self.term(part, &known, &path)?);
                    }
                }
                "damping" => {
                    let stated = self.damping(value, own)?;
                    self.much_damping(&stated, &path, value.span);
                    damping = Some(stated);
                }
                "geometric_stiffness" => {
                    let stated = self.evaluate(value, own)?;
                    geometric_stiffness = self.read(stated, value.span)?;
                }
                _ => return self.checked(None, a.name.span, "no attribute of a flexible body"),
            }
        }
        let span = declaration.name.span;
        let mesh = self.checked(mesh, span, "a flexible body without a mesh")?;
        let modes_at = self.checked(modes_at, span, "a flexible body without modes")?;
        let damping = self.checked(damping, span, "a flexible body without damping")?;
        self.both_matrices(stiffness.as_ref(), mass.as_ref(), &path, span)?;
        self.own_shapes(&mesh, &terms)?;
        let (sources, indices): (Vec<MarkerSource>, Vec<u32>) = markers.into_iter().unzip();
        self.draft.flexible[index as usize] = Some(FlexibleDraft {
            source: FlexibleSource {
                origin: place,
                mesh,
                stiffness,
                mass,
                recovery,
                material,
                element_rules,
                markers: sources,
                support: support.markers,
                support_freedoms: support.freedoms,
                support_of_deck: support.of_deck,
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
            self.start_in_body(item, body, origin, own);
        }
        Ok(body)
    }

    /// The markers of a flexible body, and their names. An error in one marker does not hide those of its neighbours.
    fn markers_of_block(
        &mut self,
        block: &'a ast::Block,
        body: BodyRef,
        scope: ScopeId,
        path: &str,
    ) -> (MarkersOnMesh, MarkerNames) {
        let mut markers = Vec::new();
        let mut known = Vec::new();
        for item in &block.items {
            if let ItemKind::Declaration(d) = &item.kind
                && d.kind == Kind::Marker
            {
                let made = self.markers_on_mesh(d, body, scope, path, &mut markers, &mut known);
                let entry = made.map_or(Entry::Failed, Entry::Value);
                self.define(scope, &d.name.text, entry);
            }
        }
        (markers, known)
    }

    /// The supports of a body.
    fn supports(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
        (markers, known): (&MarkersOnMesh, &MarkerNames),
        path: &str,
    ) -> Eval<Supports> {
        let mut found = Supports::default();
        self.gather_supports(value, scope, (known, path), &mut found)?;
        let partly = found.freedoms.iter().map(|held| held.marker);
        for index in found.markers.iter().copied().chain(partly) {
            if let Some((_, marker)) = markers.get(index as usize) {
                self.used_marker(*marker);
            }
        }
        Ok(found)
    }

    /// Adds the supports of an expression: of a list each, `held` with its freedoms, the deck, or whole markers.
    fn gather_supports(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
        (known, path): (&MarkerNames, &str),
        found: &mut Supports,
    ) -> Eval<()> {
        match &value.kind {
            ExprKind::List { items, unit: None } => {
                for item in items {
                    self.gather_supports(item, scope, (known, path), found)?;
                }
            }
            ExprKind::Call { .. } => {
                let (word, arguments) = self.worded(Place::Support, value)?;
                let at = argument(word, arguments, "at");
                let at = self.checked(at, value.span, "a support without markers")?;
                let freedoms = argument(word, arguments, "freedoms");
                let freedoms = freedoms.map_or(ALL_FREEDOMS, modes::freedoms_of);
                for name in self.marker_names(at, scope)? {
                    for marker in self.found(&name, known, path)? {
                        found.freedoms.push(Interface { marker, freedoms });
                    }
                }
            }
            _ => {
                for name in self.marker_names(value, scope)? {
                    if name.is(DECK) && !known.iter().any(|(marker, _)| marker == DECK) {
                        found.of_deck = true;
                        continue;
                    }
                    found.markers.extend(self.found(&name, known, path)?);
                }
            }
        }
        Ok(())
    }

    /// Refuses shapes from a file for a mesh that no file has: they belong to nodes of another mesh.
    fn own_shapes(&mut self, mesh: &MeshSource, terms: &[TermDraft]) -> Eval<()> {
        let given = terms
            .iter()
            .find(|term| matches!(term.kind, TermKind::Given { .. }));
        match (mesh, given) {
            (MeshSource::Stack(_), Some(term)) => Err(self.report(
                Diagnostic::error(
                    codes::FLEXIBLE,
                    "shapes from a file do not belong to stacked sections",
                )
                .at(term.span, "its rows are nodes of another mesh")
                .with_help("leave them out, or read the mesh of the other code"),
            )),
            _ => Ok(()),
        }
    }

    /// Refuses one matrix from a file beside one from the mesh, and matrices of different rows.
    fn both_matrices(
        &mut self,
        stiffness: Option<&MatrixSource>,
        mass: Option<&MatrixSource>,
        path: &str,
        span: Span,
    ) -> Eval<()> {
        match (stiffness, mass) {
            (Some(stiffness), Some(mass)) => self.rows_of_matrices(stiffness, mass, span),
            (None, None) => Ok(()),
            _ => Err(self.report(
                Diagnostic::error(
                    codes::FLEXIBLE_MATRICES,
                    format!("{path} has one matrix from a file and one from its mesh"),
                )
                .at(span, "stiffness and mass belong together")
                .with_help("give both `stiffness` and `mass`, or neither"),
            )),
        }
    }

    /// The called word and its arguments.
    fn worded(
        &mut self,
        place: Place,
        value: &'a ast::Expr,
    ) -> Eval<(&'static Word, &'a [ast::Argument])> {
        let (callee, arguments) = self.called(value)?;
        let word = match &callee.kind {
            ExprKind::Name(name) => word(place, name),
            _ => None,
        };
        let what = format!("this is not {}", place.text());
        Ok((self.checked(word, value.span, &what)?, arguments))
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
        match bare_word(expr) {
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
            let text = self.evaluate(expr, scope)?;
            return self.read(text, expr.span).map(Some);
        }
        let written = crate::words::inside_quotes(self.sources, expr.span);
        let mut text = String::new();
        for part in self.message_at(written.span)? {
            let value = match part {
                eng_grammar::MessagePart::Text(plain) => {
                    text.push_str(plain);
                    continue;
                }
                eng_grammar::MessagePart::Value { value, .. } => value,
            };
            match self.evaluate(value, scope)? {
                Value::Int(i) => text.push_str(&i.to_string()),
                Value::Text(shown) => text.push_str(&shown),
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
        Ok(Some(text))
    }

    /// Welds the frames of bodies with supports to the ground at their start positions.
    pub fn weld_supports(&mut self) {
        let welds: Vec<(String, u32, ScopeId, Span)> = self
            .draft
            .flexible
            .iter()
            .flatten()
            .filter_map(|d| {
                let path = d.source.origin.path.clone();
                Some((path, d.origin, d.scope, d.support_span?))
            })
            .collect();
        for (path, origin, scope, span) in welds {
            let weld = self.program.weld();
            let class = self
                .checked(weld, span, "the library has no weld")
                .and_then(|id| self.class_of(id, span));
            // the error was reported
            let Ok(class) = class else { continue };
            let path = format!("{path}.support");
            let ground = self.ground_at(origin, format!("ground at {path}"), span);
            let markers = [origin, ground].map(|m| super::Argument::Value(Value::Marker(m)));
            let names = class
                .parameters
                .iter()
                .map(|parameter| parameter.name.text.clone());
            let bound = names.zip(markers).collect();
            let caller = self.module_scopes[class.definition.module as usize];
            let made = self.element_of_class(&class, bound, None, caller, path, span);
            self.graphs.element = None;
            let entry = match made {
                Ok(element) => Entry::Value(Value::Element(element)),
                Err(_) => Entry::Failed,
            };
            self.define(scope, "support", entry);
        }
    }
}

/// The word of a bare name; empty for anything else.
fn bare_word(expr: &ast::Expr) -> &str {
    match &expr.kind {
        ExprKind::Name(name) => name,
        _ => "",
    }
}

/// The meaning of a bare word. The checker has tested that the word is known.
fn meaning<T: Stated>(expr: &ast::Expr) -> Option<T> {
    T::named(bare_word(expr))
}
