//! The form of each solid: the table of rules by which a code's name stands for a stiffness.
//!
//! `RULES` is read from above; the first line that fits an element says how it is made, or why it is
//! refused. A new form is a variant of [`Form`], its mechanics in a file of its own, and a line.
//!
//! CalculiX' C3D8R has one point, also for its mass, which then lacks the element's own inertia, and
//! stiffness against hourglasses that resists rigid rotation in elements that are no parallelepipeds. Nastran
//! takes shear at fewer points by default, and does not publish which: its quadratic elements and wedges are
//! computed in full and told. A mesh of no code (gmsh) names no rule. Full integration of its 8-node
//! hexahedra would lock in bending, so they have incompatible modes.
//!
//! Sources: Abaqus Theory Guide 3.2.4 and its matrices; CalculiX 2.20 (`e_c3d.f`, `shape8hu.f`, `shape8hr.f`)
//! and its frequencies; MSC Nastran Quick Reference Guide, `PSOLID`.

use std::collections::BTreeMap;

use super::bubbles;
use super::check::{Role, role};
use super::hexahedron::{self, EnhancedPoint};
use super::rules::{MassRule, Rules, StiffnessRule, Table};
use crate::element::{ElementKind, MOST_NODES, Shape};
use crate::error::FlexibleError;
use crate::mesh::{Code, Element, Material, Mesh, VARIANT_LETTERS, Variant};

/// How the stiffness of a solid is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// At points enough for full rank.
    Full,
    /// At fewer: 2³ for the 20-node hexahedron, 2 for the 6-node wedge.
    Reduced,
    /// 8-node hexahedron whose dilatation is its mean everywhere (B-bar; Abaqus Theory Guide 3.2.4).
    MeanDilatation,
    /// 8-node hexahedron with nine incompatible modes, condensed.
    Incompatible,
    /// 8-node hexahedron with nine incompatible modes that are freedoms with mass.
    Bubbles,
}

/// What a form adds to the strains of an element's points.
///
/// # Errors
/// The Jacobian (m³) where it is not positive.
pub(super) type Correction =
    fn(&Table, &[[f64; 3]; MOST_NODES], &Material, &mut [EnhancedPoint]) -> Result<(), f64>;

/// Functions that a form has inside an element beside those of its nodes.
pub(super) struct Inner {
    /// How many; each has three amplitudes.
    pub(super) count: u32,
    /// Puts them behind the functions of so many nodes, at a point of the reference domain. They are zero
    /// where the element's own functions are one: at its nodes.
    pub(super) put: fn(&mut Shape, usize, [f64; 3]),
}

impl Form {
    /// Its inner functions, if any.
    fn inner(self) -> Option<Inner> {
        match self {
            Form::Full | Form::Reduced | Form::MeanDilatation | Form::Incompatible => None,
            Form::Bubbles => Some(Inner {
                count: 3,
                put: bubbles::put,
            }),
        }
    }

    /// The number of its inner nodes.
    pub(super) fn inner_count(self) -> u32 {
        self.inner().map_or(0, |inner| inner.count)
    }

    /// The functions of an element at a point of its reference domain, inner ones behind those of its nodes.
    pub(super) fn shape(self, kind: ElementKind, at: [f64; 3]) -> Shape {
        let mut shape = Shape::at(kind, at);
        if let Some(inner) = self.inner() {
            (inner.put)(&mut shape, kind.node_count(), at);
        }
        shape
    }

    /// What it adds to the strains of the shape functions; `None`: nothing.
    pub(super) fn correction(self) -> Option<Correction> {
        match self {
            Form::Full | Form::Reduced | Form::Bubbles => None,
            Form::MeanDilatation => Some(hexahedron::mean_dilatation),
            Form::Incompatible => Some(hexahedron::incompatible),
        }
    }
}

/// What a rule makes of an element's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Form(Form),
    /// A form that is not quite its code's: why.
    Told(Form, &'static str),
    /// Why its form can't be had, and what to do.
    Refused(&'static str, &'static str),
}

/// Whose rules give an element its form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Whose {
    /// The text's: all in full.
    InFull,
    /// Nobody's: a mesh of no code.
    Nobody,
    Nastran,
    Abaqus,
    CalculiX,
}

impl Whose {
    /// Whose rules hold for a mesh written for a code.
    fn of(mesh: Code, rule: StiffnessRule) -> Self {
        match (rule, mesh) {
            (StiffnessRule::Full, _) => Whose::InFull,
            (StiffnessRule::Named, Code::None) => Whose::Nobody,
            (StiffnessRule::Nastran, _) | (StiffnessRule::Named, Code::Nastran) => Whose::Nastran,
            (StiffnessRule::Abaqus, _) | (StiffnessRule::Named, Code::Abaqus) => Whose::Abaqus,
            (StiffnessRule::CalculiX, _) | (StiffnessRule::Named, Code::CalculiX) => {
                Whose::CalculiX
            }
        }
    }

    fn title(self) -> &'static str {
        match self {
            Whose::InFull | Whose::Nobody => "their code",
            Whose::Nastran => "Nastran",
            Whose::Abaqus => "Abaqus",
            Whose::CalculiX => "CalculiX",
        }
    }
}

/// The variants that a rule is for.
#[derive(Clone, Copy)]
enum For {
    /// All.
    Any,
    /// No letters, and no `PSOLID` that says more than its bubble functions.
    Plain,
    /// These letters and no others.
    Letters(&'static str),
    /// Any letters.
    AnyLetters,
    /// `IN` of `PSOLID`, with `ISOP = FULL`.
    InFull(u8),
    /// `IN` of `PSOLID`: so many points or more.
    Points(u8),
}

impl For {
    fn fits(self, variant: Variant) -> bool {
        match (self, variant) {
            (For::Any, _)
            | (For::Plain, Variant::Plain | Variant::Network { points: 0, .. })
            | (For::AnyLetters, Variant::Letters(_)) => true,
            (For::Letters(wanted), Variant::Letters(letters)) => {
                // Σ of distinct bits: each letter stands once
                let bits = wanted
                    .chars()
                    .filter_map(|letter| VARIANT_LETTERS.find(letter));
                bits.map(|bit| 1 << bit).sum::<u8>() == letters
            }
            (For::InFull(wanted), Variant::Network { points, full }) => full && points == wanted,
            (For::Points(least), Variant::Network { points, .. }) => points >= least,
            _ => false,
        }
    }
}

/// A line of the table.
struct Rule {
    whose: &'static [Whose],
    /// Kinds; none: all.
    kinds: &'static [ElementKind],
    variants: For,
    verdict: Verdict,
}

const fn rule(
    whose: &'static [Whose],
    kinds: &'static [ElementKind],
    variants: For,
    verdict: Verdict,
) -> Rule {
    Rule {
        whose,
        kinds,
        variants,
        verdict,
    }
}

/// The forms of solids by code, kind and variant. The first line that fits holds.
const RULES: &[Rule] = {
    use ElementKind::{Hexahedron8, Hexahedron20, Tetrahedron4, Tetrahedron10, Wedge6};
    use For::{Any, AnyLetters, Letters, Plain, Points};
    use Verdict::{Form as Made, Refused, Told};
    use Whose::{Abaqus, CalculiX, Nastran, Nobody};
    const FULL: Verdict = Made(Form::Full);
    const REDUCED: Verdict = Made(Form::Reduced);
    const BUBBLE: Verdict = Made(Form::Incompatible);
    const ADVICE: &str = "state `element_rules = nastran`, which gives 8-node hexahedra incompatible modes, or write C3D20R in the file";
    const UNKNOWN: Verdict = Refused(
        "its rule is not reproduced",
        "write the plain type or C3D20R in the file",
    );
    const SHEAR: Verdict = Refused(
        "reduced integration of the shear alone is not public",
        "leave IN and ISOP of their PSOLID blank",
    );
    &[
        rule(&[Whose::InFull], &[], Any, FULL),
        rule(&[Nobody], &[Hexahedron8], Any, BUBBLE),
        rule(&[Nobody], &[], Any, FULL),
        rule(&[Abaqus, CalculiX], &[Hexahedron20], Letters("R"), REDUCED),
        rule(
            &[Abaqus, CalculiX],
            &[Hexahedron8],
            Letters("R"),
            Refused(
                "one integration point and an artificial stiffness against hourglasses, so that bending takes many elements across",
                ADVICE,
            ),
        ),
        rule(
            &[Abaqus],
            &[Hexahedron8],
            Letters("I"),
            Refused("its incompatible modes are not public", ADVICE),
        ),
        rule(
            &[CalculiX],
            &[Hexahedron8],
            Letters("I"),
            Made(Form::Bubbles),
        ),
        rule(&[Abaqus, CalculiX], &[], AnyLetters, UNKNOWN),
        rule(&[Abaqus], &[Hexahedron8], Any, Made(Form::MeanDilatation)),
        rule(&[CalculiX], &[Wedge6], Any, REDUCED),
        rule(
            &[Abaqus],
            &[Wedge6],
            Any,
            Told(Form::Full, "Abaqus takes fewer points"),
        ),
        rule(&[Abaqus, CalculiX], &[], Any, FULL),
        rule(&[Nastran], &[Hexahedron8], For::InFull(2), FULL),
        rule(&[Nastran], &[Hexahedron20], For::InFull(2), REDUCED),
        rule(&[Nastran], &[Hexahedron20], Letters("R"), REDUCED),
        rule(&[Nastran], &[Hexahedron8], Letters("R"), BUBBLE),
        rule(&[Nastran], &[Hexahedron8], Letters("I"), BUBBLE),
        rule(&[Nastran], &[], AnyLetters, UNKNOWN),
        rule(&[Nastran], &[Tetrahedron4, Tetrahedron10], Any, FULL),
        rule(&[Nastran], &[Hexahedron8], Plain, BUBBLE),
        rule(&[Nastran], &[Hexahedron8], Any, SHEAR),
        rule(&[Nastran], &[], For::InFull(3), FULL),
        rule(&[Nastran], &[], Points(1), SHEAR),
        rule(
            &[Nastran],
            &[],
            Any,
            Told(
                Form::Full,
                "Nastran integrates their shear at fewer points, by a rule that is not public",
            ),
        ),
    ]
};

const IN_FULL: &str = "; or state `element_rules = exact`, which integrates them in full";

/// What the table says of an element.
fn verdict(kind: ElementKind, variant: Variant, mesh: Code, stated: StiffnessRule) -> Verdict {
    let whose = Whose::of(mesh, stated);
    RULES
        .iter()
        .find(|rule| {
            rule.whose.contains(&whose)
                && (rule.kinds.is_empty() || rule.kinds.contains(&kind))
                && rule.variants.fits(variant)
        })
        // the last line of each code fits everything
        .map_or(Verdict::Form(Form::Full), |rule| rule.verdict)
}

/// The form of a solid.
///
/// # Errors
/// A variant whose rule is not reproduced.
pub(crate) fn form(
    mesh: &Mesh,
    element: &Element,
    rule: StiffnessRule,
) -> Result<Form, FlexibleError> {
    match verdict(element.kind, element.variant, mesh.code, rule) {
        Verdict::Form(form) | Verdict::Told(form, _) => Ok(form),
        Verdict::Refused(..) => {
            check(mesh, rule)?;
            Ok(Form::Full)
        }
    }
}

/// The mass rule of a solid: a variant's own where the code's rules hold for what its file names.
pub(super) fn mass_rule(mesh: &Mesh, element: &Element, rules: &Rules) -> MassRule {
    match (rules.stiffness, rules.mass, element.variant, mesh.code) {
        (StiffnessRule::Named, MassRule::Exact, Variant::Letters(_), Code::CalculiX) => {
            MassRule::CalculiX
        }
        (StiffnessRule::Named, MassRule::Exact, Variant::Letters(_), Code::Abaqus) => {
            MassRule::Abaqus
        }
        (_, rule, ..) => rule,
    }
}

/// The name of an element's type in its file.
fn name(mesh: &Mesh, kind: ElementKind, variant: Variant) -> String {
    let nodes = kind.node_count();
    let names = kind.description().names;
    if mesh.code == Code::Nastran {
        // every solid has a card
        let card = names.nastran.first().copied().unwrap_or_default();
        return match variant {
            Variant::Network { points, full } => {
                let points = match points {
                    0 => String::new(),
                    n => format!(", IN = {n}"),
                };
                let full = if full { ", ISOP = FULL" } else { "" };
                format!("{card} ({nodes} nodes{points}{full})")
            }
            _ => format!("{card} ({nodes} nodes)"),
        };
    }
    let letters: String = match variant {
        Variant::Letters(letters) => VARIANT_LETTERS
            .chars()
            .enumerate()
            .filter(|(bit, _)| letters & (1 << bit) != 0)
            .map(|(_, letter)| letter)
            .collect(),
        _ => String::new(),
    };
    let plain = names.abaqus.first().copied().unwrap_or_default();
    format!("{plain}{letters}")
}

/// Solids by type: how many, and the number of the first.
fn types(mesh: &Mesh) -> BTreeMap<(ElementKind, Variant), (usize, u64)> {
    let mut types = BTreeMap::new();
    for element in &mesh.elements {
        if matches!(role(mesh, element), Some(Role::Solid(_))) {
            types
                .entry((element.kind, element.variant))
                .or_insert((0, element.id))
                .0 += 1;
        }
    }
    types
}

/// Refuses a mesh with solids whose rule is not reproduced.
///
/// # Errors
/// All such types, with their numbers of elements and what to do.
pub fn check(mesh: &Mesh, rule: StiffnessRule) -> Result<(), FlexibleError> {
    let mut refused = Vec::new();
    let mut advised: Vec<&str> = Vec::new();
    for ((kind, variant), (count, first)) in types(mesh) {
        if let Verdict::Refused(why, advice) = verdict(kind, variant, mesh.code, rule) {
            let name = name(mesh, kind, variant);
            refused.push(format!("{count} × {name} (the first is {first}): {why}"));
            if !advised.contains(&advice) {
                advised.push(advice);
            }
        }
    }
    if refused.is_empty() {
        return Ok(());
    }
    Err(FlexibleError::Structure {
        problem: format!(
            "elements that are not computed as {} does: {}",
            Whose::of(mesh.code, rule).title(),
            refused.join("; ")
        ),
        advice: format!("{}{IN_FULL}", advised.join("; ")),
    })
}

/// What is to be told of the forms that a mesh's solids take.
pub fn told(mesh: &Mesh, rule: StiffnessRule) -> Vec<String> {
    let mut told = Vec::new();
    for ((kind, variant), (count, _)) in types(mesh) {
        let name = name(mesh, kind, variant);
        match (verdict(kind, variant, mesh.code, rule), rule) {
            (Verdict::Told(_, why), _) => told.push(format!(
                "{count} × {name} are integrated in full, and {why}: coarse meshes come out stiffer here; `element_rules = exact` states that this is meant"
            )),
            (_, StiffnessRule::Full) if matches!(variant, Variant::Letters(_)) => {
                told.push(format!(
                    "{count} × {name} are integrated in full, as `element_rules = exact` states"
                ));
            }
            _ => {}
        }
    }
    told
}
