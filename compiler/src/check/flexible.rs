//! Flexible bodies: their attributes, markers on meshes, mode sets.

use super::Checker;
use super::body::{BodyKind, states};
use super::bound::{Called, Parameter};
use super::member::Member;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{Quantity, Type};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use crate::typed::Callee;
use crate::words::{DECK, ELEMENT_RULES, Place, Takes, Word, argument, belongs, word, words};
use eng_grammar::ast::{
    Argument, Attribute, BinaryOp, Declaration, Expr, ExprKind, Form, IndexArgument, ItemKind, Kind,
};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;
use eng_system::flexible::FREEDOM_NAMES;

/// Attributes of a flexible body; the first three are required.
const ATTRIBUTES: [&str; 10] = [
    "mesh",
    "modes",
    "damping",
    "stiffness",
    "mass",
    "recovery",
    "material",
    "support",
    "element_rules",
    "geometric_stiffness",
];

const FLEXIBLE: BodyKind = BodyKind {
    words: "flexible body",
    word: "flexible",
    question: "of which mesh?",
    block: "mesh = …; modes = …; damping = …",
    attributes: &ATTRIBUTES,
    required: &[
        (
            "mesh",
            "for instance `mesh = nastran(\"crank.bdf\", units: mm_tonne_s)`",
        ),
        (
            "modes",
            "for instance `modes = static(at: main) + normal(10)`",
        ),
        ("damping", "for instance `damping = 2 %`"),
    ],
};

impl<'p> Checker<'p> {
    pub(super) fn flexible(&mut self, outer: &Scope<'p>, declaration: &'p Declaration) {
        self.body(
            outer,
            declaration,
            &FLEXIBLE,
            Self::flexible_attribute,
            Self::marker_on_mesh,
        );
        self.stack_attributes(declaration);
    }

    fn flexible_attribute(&mut self, scope: &Scope<'p>, attribute: &'p Attribute) {
        let Attribute { name, value } = attribute;
        let due = Due::new(format!("`{}` of a flexible body", name.text));
        match name.text.as_str() {
            "mesh" => self.worded(scope, Place::Mesh, value),
            "stiffness" | "mass" => self.worded(scope, Place::Matrix, value),
            "recovery" => self.worded(scope, Place::Recovery, value),
            "modes" => self.modes(scope, value),
            "damping" => match &value.kind {
                ExprKind::Call { callee, .. } if called(callee, Place::Damping).is_some() => {
                    self.worded(scope, Place::Damping, value);
                }
                _ => {
                    self.expect(scope, value, &Type::one(), &due);
                }
            },
            "material" => self.material(scope, value),
            "support" => self.supports(scope, value),
            "element_rules" => self.one_of(value, ELEMENT_RULES, "the rules of elements"),
            "geometric_stiffness" => {
                self.expect(scope, value, &Type::Bool, &due);
            }
            _ => {
                let mut message = Diagnostic::error(
                    codes::UNKNOWN_ATTRIBUTE,
                    format!("a flexible body has no attribute `{}`", name.text),
                )
                .at(name.span, "not known");
                message = match (name.text.as_str(), nearest(&name.text, ATTRIBUTES)) {
                    ("inertia" | "center_of_mass" | "products_of_inertia", _) => {
                        message.with_help("mass and inertia follow from the mesh; leave them out")
                    }
                    (_, Some(near)) => message.meant(name.span, near),
                    _ => self
                        .offer_marker(message.clone(), name, value)
                        .unwrap_or_else(|| {
                            message.with_note(format!("it has {}", listing(ATTRIBUTES, 12)))
                        }),
                };
                self.report(message);
            }
        }
    }

    /// A list of records with corners and a length. A corner is a record with its place in the plane and a bend.
    fn sections(&mut self, scope: &Scope<'p>, value: &Expr) {
        let ty = self.infer(scope, value);
        if ty.is_error() {
            return;
        }
        let length = || Quantity::hard(Dimension::LENGTH);
        let angle = || Quantity::hard(Dimension::ANGLE);
        let section = self.element_field(&ty, "corners");
        let fits = match (section, self.element_field(&ty, "length")) {
            (Some(corners), Some(along)) => {
                let place = self.element_field(&corners, "place");
                let bend = self.element_field(&corners, "bend");
                scalar(&along, &length())
                    && bend.is_some_and(|bend| scalar(&bend, &angle()))
                    && place.is_some_and(|place| match &place {
                        Type::List { element, .. } => scalar(element, &length()),
                        _ => false,
                    })
            }
            _ => false,
        };
        if !fits {
            self.report(
                self.mistyped(value.span, "`sections` of `stack` is a list of sections", &ty)
                .with_help("take sections of the library, such as `[disc(20 mm, length: 80 mm)]` with `use std.sections.disc`; a section is a record with `length` and `corners`, and each corner has a `place` and a `bend`"),
            );
        }
    }

    /// The type of a field of the records in a list.
    fn element_field(&mut self, list: &Type, field: &str) -> Option<Type> {
        let Type::List { element, .. } = list else {
            return None;
        };
        let Type::Instance(id) = **element else {
            return None;
        };
        let owned = self.owned_member(id, field)?;
        match owned.member {
            Member::Binding(binding) => {
                let span = binding.name.span;
                self.used.insert((owned.home, field.to_owned()));
                Some(self.member_type(owned.home, field, owned.member, span))
            }
            _ => None,
        }
    }

    /// A body of stacked sections needs a material, and takes nothing that belongs to another code's mesh.
    fn stack_attributes(&mut self, declaration: &'p Declaration) {
        let Some(block) = declaration.block() else {
            return;
        };
        let attribute = |name: &str| {
            block.items.iter().find_map(|item| match &item.kind {
                ItemKind::Attribute(a) if a.name.text == name => Some(a),
                _ => None,
            })
        };
        let stack = attribute("mesh").filter(|mesh| match &mesh.value.kind {
            ExprKind::Call { callee, .. } => {
                called(callee, Place::Mesh).is_some_and(|word| word.word == "stack")
            }
            _ => false,
        });
        let Some(stack) = stack else {
            return;
        };
        if attribute("material").is_none() {
            self.report(
                Diagnostic::error(
                    codes::MISSING_ATTRIBUTE,
                    "a body of stacked sections needs a material",
                )
                .at(stack.value.span, "sections of which material?")
                .with_help("add `material = Steel` with `use std.materials.Steel`"),
            );
        }
        for name in ["stiffness", "mass", "recovery"] {
            if let Some(given) = attribute(name) {
                self.report(
                    Diagnostic::error(
                        codes::FLEXIBLE,
                        format!("`{name}` of another code does not belong to stacked sections"),
                    )
                    .at(given.name.span, "its rows are freedoms of another mesh")
                    .also(stack.value.span, "the mesh is made here")
                    .with_help("leave it out, or read the mesh of the other code"),
                );
            }
        }
    }

    /// A record with density, Young's modulus and Poisson's ratio.
    fn material(&mut self, scope: &Scope<'p>, value: &Expr) {
        let ty = self.infer(scope, value);
        if ty.is_error() {
            return;
        }
        let fits = match &ty {
            Type::Instance(id) => ["density", "young_modulus", "poisson_ratio"]
                .iter()
                .all(|field| matches!(self.member(*id, field), Some(Member::Binding(_)))),
            _ => false,
        };
        if !fits {
            self.report(
                self.mistyped(value.span, "the material must be a `Solid`", &ty)
                .with_help("take one: `use std.materials.Steel`, or make one: `Solid(density: 7850 kg/m^3, young_modulus: 210 GPa, poisson_ratio: 0.3)`"),
            );
        }
    }

    /// `marker name[index] = ring(…)` on a mesh.
    fn marker_on_mesh(&mut self, outer: &Scope<'p>, declaration: &'p Declaration) {
        if declaration.name.text == "support" {
            self.report(
                Diagnostic::error(
                    codes::DEFINED_TWICE,
                    "`support` is the joint that holds a body on the ground",
                )
                .at(declaration.name.span, "another one")
                .with_help("give the marker a name of its own, such as `mount`"),
            );
        }
        let scope = self.binders(outer, &declaration.index);
        self.condition_of(&scope, declaration);
        let name = &declaration.name.text;
        let Form::Instance { value, .. } = &declaration.form else {
            self.report(
                Diagnostic::error(codes::MARKER, format!("the marker `{name}` needs a place"))
                    .at(declaration.name.span, "where on the mesh?")
                    .with_help(format!("for instance `marker {name} = node(9201)`")),
            );
            return;
        };
        match &value.kind {
            ExprKind::Error => {}
            ExprKind::Call { callee, .. } if called(callee, Place::Marker).is_some() => {
                self.worded(&scope, Place::Marker, value);
            }
            ExprKind::Call { callee, .. } if near_word(callee).is_some() => {
                self.no_word(Place::Marker, callee.span, near_word(callee));
            }
            _ => {
                let examples: Vec<&str> = words(Place::Marker).map(|w| w.example).collect();
                self.report(
                    Diagnostic::error(codes::MARKER, format!("`{name}` does not name its nodes"))
                        .at(value.span, "no place on a mesh")
                        .with_note("a marker of a flexible body moves with nodes of its mesh")
                        .with_help(format!(
                            "for instance `{}` or `{}`",
                            examples.first().unwrap_or(&""),
                            examples.get(1).unwrap_or(&""),
                        )),
                );
            }
        }
    }

    /// A call of one of the words of a place.
    fn worded(&mut self, scope: &Scope<'p>, place: Place, value: &Expr) {
        let (callee, arguments) = match &value.kind {
            ExprKind::Error => return,
            ExprKind::Call { callee, arguments } => (callee, arguments.as_slice()),
            _ => {
                self.no_word(place, value.span, None);
                return;
            }
        };
        match called(callee, place) {
            Some(word) => self.word_arguments(scope, word, value.span, arguments),
            None => {
                let name = match &callee.kind {
                    ExprKind::Name(name) => Some(name.as_str()),
                    _ => None,
                };
                self.no_word(place, callee.span, name);
            }
        }
    }

    fn no_word(&mut self, place: Place, span: Span, name: Option<&str>) {
        let mut message = Diagnostic::error(
            codes::FLEXIBLE,
            match name {
                Some(name) => format!("`{name}` is not {}", place.text()),
                None => format!("this is not {}", place.text()),
            },
        )
        .at(span, "not known here");
        let near = name.and_then(|n| nearest(n, words(place).map(|w| w.word)));
        message = match near {
            Some(near) => message.meant(span, near),
            None => message.with_help(format!(
                "write one of: {}",
                words(place)
                    .map(|w| w.example)
                    .collect::<Vec<_>>()
                    .join("; ")
            )),
        };
        self.report(message);
    }

    fn word_arguments(
        &mut self,
        scope: &Scope<'p>,
        word: &'static Word,
        span: Span,
        arguments: &[Argument],
    ) {
        let parameters = word.arguments.iter().map(|argument| Parameter {
            name: argument.name,
            required: argument.required,
            by_place: !argument.named,
            by_name: true,
        });
        let called = Called {
            name: word.word,
            parameters: parameters.collect(),
            more: false,
            example: Some(word.example),
        };
        let given = self.given(&called, arguments);
        for (place, value) in &given.arguments {
            if let Some(slot) = place.and_then(|at| word.arguments.get(at)) {
                self.taken(scope, word, slot.name, slot.takes, value);
            }
        }
        if !given.missing.is_empty() {
            self.report(called.missing(&given.missing, span));
        }
        // how many modes: one of two ways
        if matches!(word.word, "normal" | "craig_bampton") {
            let number = argument(word, arguments, "number");
            let up_to = argument(word, arguments, "up_to");
            match (number, up_to) {
                (None, None) => self.report(
                    Diagnostic::error(
                        codes::MISSING_ARGUMENT,
                        format!("`{}` needs a number of modes or a frequency", word.word),
                    )
                    .at(span, "how many modes?")
                    .with_help(
                        "write `number: 10` for the ten lowest, or `up_to: 3000 Hz` for all below",
                    ),
                ),
                (Some(_), Some(second)) => self.report(
                    Diagnostic::error(
                        codes::ARGUMENT_TWICE,
                        format!("`{}` takes a number of modes or a frequency", word.word),
                    )
                    .at(second.span, "both are given")
                    .with_help("leave one out"),
                ),
                _ => {}
            }
        }
    }

    /// An argument of a word.
    fn taken(&mut self, scope: &Scope<'p>, word: &Word, name: &str, takes: Takes, value: &Expr) {
        let mut due = Due::new(format!("`{name}` of `{}`", word.word));
        let per_time = || Dimension::ONE.over(Dimension::TIME);
        let (ty, unit) = match takes {
            Takes::Text => {
                // `"MAIN{j}"` shows values as a message does
                if matches!(value.kind, ExprKind::Text(_)) {
                    let shown = crate::words::inside_quotes(self.sources, value.span);
                    self.message(scope, &shown);
                    return;
                }
                (Type::Text, None)
            }
            Takes::Texts => {
                let ExprKind::List { items, unit: None } = &value.kind else {
                    self.report(
                        Diagnostic::error(
                            codes::FLEXIBLE,
                            format!("`{name}` of `{}` is a list of texts", word.word),
                        )
                        .at(value.span, "no list")
                        .with_help(format!("for instance `{name}: [\"CBEND\", \"*GAP\"]`")),
                    );
                    return;
                };
                for item in items {
                    self.taken(scope, word, name, Takes::Text, item);
                }
                return;
            }
            Takes::Count => (Type::Int, None),
            Takes::Length => (Type::Scalar(Quantity::hard(Dimension::LENGTH)), Some("mm")),
            Takes::Place => (Type::vector(Quantity::hard(Dimension::LENGTH)), Some("mm")),
            Takes::Direction => (Type::vector(Quantity::one()), None),
            Takes::Axis => {
                if matches!(&value.kind, ExprKind::Name(n) if ["x", "y", "z"].contains(&n.as_str()))
                {
                    return;
                }
                (Type::vector(Quantity::one()), None)
            }
            Takes::Frequency => (Type::Scalar(Quantity::hard(per_time())), Some("Hz")),
            Takes::PerTime => (Type::Scalar(Quantity::hard(per_time())), Some("1/s")),
            Takes::Time => (Type::Scalar(Quantity::hard(Dimension::TIME)), Some("s")),
            Takes::Ratio => (Type::one(), None),
            Takes::Word(known) => {
                self.one_of(value, known, &format!("`{name}`"));
                return;
            }
            Takes::Markers => {
                self.markers_named(scope, value);
                return;
            }
            Takes::Freedoms => {
                self.freedoms(value);
                return;
            }
            Takes::Surface => {
                self.worded(scope, Place::Surface, value);
                return;
            }
            Takes::Mesh => {
                self.worded(scope, Place::Mesh, value);
                return;
            }
            Takes::Sections => {
                self.sections(scope, value);
                return;
            }
        };
        due.unit = unit.map(str::to_owned);
        self.expect(scope, value, &ty, &due);
    }

    /// A bare word out of some.
    fn one_of(&mut self, value: &Expr, known: &[&'static str], what: &str) {
        let ExprKind::Name(name) = &value.kind else {
            if !matches!(value.kind, ExprKind::Error) {
                self.report(
                    Diagnostic::error(codes::FLEXIBLE, format!("{what} is a word"))
                        .at(value.span, "no word")
                        .with_help(format!("one of {}", listing(known.iter().copied(), 12))),
                );
            }
            return;
        };
        if known.contains(&name.as_str()) {
            return;
        }
        let mut message =
            Diagnostic::error(codes::FLEXIBLE, format!("`{name}` is not known for {what}"))
                .at(value.span, "not known")
                .with_note(format!("known are {}", listing(known.iter().copied(), 12)));
        message = message.meant_if(value.span, nearest(name, known.iter().copied()));
        self.report(message);
    }

    /// Markers, `held` with freedoms of markers, and `deck` if no marker has this name: the supports of the mesh's file.
    fn supports(&mut self, scope: &Scope<'p>, value: &Expr) {
        match &value.kind {
            ExprKind::List { items, unit: None } => {
                for item in items {
                    self.supports(scope, item);
                }
            }
            ExprKind::Name(name) if name == DECK => {
                if scope.body.is_some_and(|body| names_marker(body, DECK)) {
                    self.markers_named(scope, value);
                }
            }
            ExprKind::Call { .. } => self.worded(scope, Place::Support, value),
            _ => self.markers_named(scope, value),
        }
    }

    /// `[x, y, rz]`, or one of them.
    fn freedoms(&mut self, value: &Expr) {
        match &value.kind {
            ExprKind::List { items, unit: None } if items.is_empty() => self.report(
                Diagnostic::error(codes::FLEXIBLE, "a list of freedoms names at least one")
                    .at(value.span, "this list is empty")
                    .with_help("write `freedoms: [x, y]`, or leave the argument out"),
            ),
            ExprKind::List { items, unit: None } => {
                for item in items {
                    self.one_of(item, &FREEDOM_NAMES, "a freedom of a marker");
                }
            }
            _ => self.one_of(value, &FREEDOM_NAMES, "a freedom of a marker"),
        }
    }

    /// `main`, `main[1]`, `main[2..4]`, or a list of such: markers of the flexible body that uses it.
    fn markers_named(&mut self, scope: &Scope<'p>, value: &Expr) {
        match &value.kind {
            ExprKind::Error => {}
            ExprKind::List { items, unit: None } => {
                for item in items {
                    self.markers_named(scope, item);
                }
            }
            ExprKind::Index { base, indices } => {
                self.markers_named(scope, base);
                for index in indices {
                    if let IndexArgument::At(at) = index {
                        let ty = self.infer(scope, at);
                        let counts = match &ty {
                            Type::Range(inner) => **inner == Type::Int,
                            Type::Int | Type::Error => true,
                            _ => false,
                        };
                        if !counts {
                            let found = self.describe(&ty);
                            self.report(
                                Diagnostic::error(
                                    codes::INDEX,
                                    "an index of markers is a whole number or a range of them",
                                )
                                .at(at.span, format!("this is {found}")),
                            );
                        }
                    }
                }
            }
            ExprKind::Name(name) => {
                let Some(body) = scope.body else {
                    return;
                };
                let known: Vec<&str> = body
                    .block()
                    .into_iter()
                    .flat_map(|b| &b.items)
                    .filter_map(|item| match &item.kind {
                        ItemKind::Declaration(d) if d.kind == Kind::Marker => {
                            Some(d.name.text.as_str())
                        }
                        _ => None,
                    })
                    .collect();
                if known.contains(&name.as_str()) {
                    return;
                }
                let mut message = Diagnostic::error(
                    codes::NO_MEMBER,
                    format!("the body `{}` has no marker `{name}`", body.name.text),
                )
                .at(value.span, "not among its markers");
                message = match nearest(name, known.iter().copied()) {
                    Some(near) => message.meant(value.span, near),
                    None => message.with_note(format!("it has {}", listing(known, 12))),
                };
                self.report(message);
            }
            ExprKind::Field { name, .. } => self.report(
                Diagnostic::error(codes::FLEXIBLE, "markers are named without their body here")
                    .at(value.span, "a path")
                    .with_help(format!(
                        "write `{}`: names are looked up in the body that uses them",
                        name.text
                    ))
                    .with_fix("the name alone", value.span, name.text.clone()),
            ),
            _ => self.report(
                Diagnostic::error(codes::FLEXIBLE, "names of markers are expected here")
                    .at(value.span, "no marker's name")
                    .with_help("for instance `main`, `main[1]`, `[main, pin[2..4]]`"),
            ),
        }
    }

    /// The attribute `modes`: terms, or constants of the type `ModeSet`.
    fn modes(&mut self, scope: &Scope<'p>, value: &Expr) {
        // a sum is looked at term by term, so that names are found in this body
        match &value.kind {
            ExprKind::Binary {
                op: BinaryOp::Add,
                left,
                right,
                ..
            } => {
                self.modes(scope, left);
                self.modes(scope, right);
            }
            ExprKind::Paren { inner, unit: None } => self.modes(scope, inner),
            _ => {
                self.expect(
                    scope,
                    value,
                    &Type::ModeSet,
                    &Due::new("`modes` of a flexible body"),
                );
            }
        }
    }

    /// A call that no name of the model explains: a term of a mode set, or a word in the wrong place.
    pub(super) fn call_of_word(
        &mut self,
        scope: &Scope<'p>,
        name: &str,
        callee: Span,
        span: Span,
        arguments: &[Argument],
    ) -> Option<Type> {
        if let Some(term) = word(Place::Modes, name) {
            self.word_arguments(scope, term, span, arguments);
            self.findings.callees.insert(span, Callee::Modes(term));
            return Some(Type::ModeSet);
        }
        let other = belongs(name)?;
        self.report(
            Diagnostic::error(codes::MISPLACED, format!("`{name}` is no function"))
                .at(callee, format!("it is {}", other.place.text()))
                .with_help(format!("for instance `{}`", other.example)),
        );
        Some(Type::Error)
    }
}

/// Whether a type is a number of a quantity.
fn scalar(ty: &Type, due: &Quantity) -> bool {
    matches!(ty, Type::Scalar(quantity) if quantity.fits(due).is_ok())
}

/// Whether a body has a marker of this name.
fn names_marker(body: &Declaration, name: &str) -> bool {
    body.block()
        .into_iter()
        .flat_map(|block| &block.items)
        .any(|item| matches!(&item.kind, ItemKind::Declaration(d) if d.kind == Kind::Marker && d.name.text == name))
}

/// The name that is called, if it is much like a word for a place on a mesh.
fn near_word(callee: &Expr) -> Option<&str> {
    match &callee.kind {
        ExprKind::Name(name) => {
            nearest(name, words(Place::Marker).map(|w| w.word)).map(|_| name.as_str())
        }
        _ => None,
    }
}

/// The word that is called, if it belongs to the place.
fn called(callee: &Expr, place: Place) -> Option<&'static Word> {
    match &callee.kind {
        ExprKind::Name(name) => word(place, name),
        _ => None,
    }
}

/// Whether a body has a support on the ground.
pub(super) fn has_support(body: &Declaration) -> bool {
    body.kind == Kind::Flexible && states(body, "support")
}
