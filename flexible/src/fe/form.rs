//! The form of each solid: a table of rules from the names of each code to a stiffness.
//!
//! The first line of `RULES` that fits an element gives its form, or the reason to refuse it. A new form
//! needs a variant of [`Form`], a file with its mechanics, and a line.
//!
//! CalculiX' C3D8R is refused. It has one point, also for its mass, which then lacks the element's own
//! inertia. Its hourglass stiffness resists rigid rotation in elements that are not parallelepipeds. Nastran
//! integrates shear at fewer points by default and does not publish them. So its quadratic elements and
//! wedges are integrated in full, with a warning. A mesh of no code (gmsh) names no rule. Its 8-node
//! hexahedra would lock in bending with full integration, so they have incompatible modes.
//!
//! Sources: Abaqus Theory Guide 3.2.4 and its matrices; CalculiX 2.20 (`e_c3d.f`, `shape8hu.f`, `shape8hr.f`)
//! and its frequencies; MSC Nastran Quick Reference Guide, `PSOLID`; ANSYS Theory Reference 18.2, SOLID185
//! to SOLID187.

use std::collections::BTreeMap;

use super::bubbles;
use super::check::{Role, role};
use super::hexahedron::{self, EnhancedPoint};
use super::rules::{MassRule, Rules, StiffnessRule, Table, shares_equally};
use super::shell::Rotations;
use crate::element::{ElementKind, MOST_NODES, Shape};
use crate::error::FlexibleError;
use crate::mesh::{Code, Element, Mesh, Section, VARIANT_LETTERS, Variant};

/// The form of a solid's stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// Integrated at enough points for full rank.
    Full,
    /// Integrated at fewer points: 2³ for the 20-node hexahedron, 2 for the 6-node wedge.
    Reduced,
    /// 8-node hexahedron with its mean dilatation at all points (B-bar; Abaqus Theory Guide 3.2.4).
    MeanDilatation,
    /// 8-node hexahedron with nine incompatible modes, condensed.
    Incompatible,
    /// 8-node hexahedron with nine incompatible modes that are freedoms with mass.
    Bubbles,
}

/// A function for the terms that a form adds to the strains at an element's points.
///
/// # Errors
/// The Jacobian (m³), if it is not positive.
pub(super) type Correction =
    fn(&Table, &[[f64; 3]; MOST_NODES], &mut [EnhancedPoint]) -> Result<(), f64>;

/// The functions of a form inside an element, in addition to those of its nodes.
pub(super) struct Inner {
    /// Number of functions; each has three amplitudes.
    pub(super) count: u32,
    /// Writes them after the functions of the given number of nodes, at a point of the reference domain.
    /// They are zero at the nodes, where the element's own functions are one.
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

    /// The functions of an element at a point of its reference domain, inner ones after those of its nodes.
    pub(super) fn shape(self, kind: ElementKind, at: [f64; 3]) -> Shape {
        let mut shape = Shape::at(kind, at);
        if let Some(inner) = self.inner() {
            (inner.put)(&mut shape, kind.node_count(), at);
        }
        shape
    }

    /// The terms that it adds to the strains of the shape functions; `None` without such terms.
    pub(super) fn correction(self) -> Option<Correction> {
        match self {
            Form::Full | Form::Reduced | Form::Bubbles => None,
            Form::MeanDilatation => Some(hexahedron::mean_dilatation),
            Form::Incompatible => Some(hexahedron::incompatible),
        }
    }
}

/// The verdict of a rule on an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Form(Form),
    /// A form that differs from that of its code, with the difference for a warning.
    Differing(Form, &'static str),
    /// No form, with the reason and the remedy.
    Refused(&'static str, &'static str),
}

/// The owner of the rules for an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Whose {
    /// The text: full integration of all.
    InFull,
    /// No code: a mesh of gmsh or of a program.
    Nobody,
    Nastran,
    Abaqus,
    CalculiX,
    Ansys,
}

impl Whose {
    /// The owner of the rules for a mesh of a code.
    fn of(mesh: Code, rule: StiffnessRule) -> Self {
        match (rule, mesh) {
            (StiffnessRule::Full, _) => Whose::InFull,
            (StiffnessRule::Named, Code::None) => Whose::Nobody,
            (StiffnessRule::Named, Code::Ansys) => Whose::Ansys,
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
            Whose::Ansys => "ANSYS",
        }
    }
}

/// The variants that a rule covers.
#[derive(Clone, Copy)]
enum For {
    /// All.
    Any,
    /// No letters, and no `PSOLID` except with bubble functions.
    Plain,
    /// These letters and no others.
    Letters(&'static str),
    /// Any letters.
    AnyLetters,
    /// `IN` of `PSOLID`, with `ISOP = FULL`.
    InFull(u8),
    /// `IN` of `PSOLID`: this number of points or more.
    Points(u8),
    /// KEYOPT(2) of a solid of ANSYS.
    Option(u8),
    /// A solid of ANSYS by its number.
    Number(u16),
}

impl For {
    fn fits(self, variant: Variant) -> bool {
        match (self, variant) {
            (For::Any, _)
            | (For::Plain, Variant::Plain | Variant::Network { points: 0, .. })
            | (For::AnyLetters, Variant::Letters(_)) => true,
            (For::Letters(wanted), Variant::Letters(letters)) => {
                // the sum of distinct bits, because each letter occurs once
                let bits = wanted
                    .chars()
                    .filter_map(|letter| VARIANT_LETTERS.find(letter));
                bits.map(|bit| 1 << bit).sum::<u8>() == letters
            }
            (For::InFull(wanted), Variant::Network { points, full }) => full && points == wanted,
            (For::Option(wanted), Variant::Technology { option, .. }) => option == wanted,
            (For::Number(wanted), Variant::Technology { element, .. }) => element == wanted,
            (For::Points(least), Variant::Network { points, .. }) => points >= least,
            _ => false,
        }
    }
}

/// A line of the table.
struct Rule {
    whose: &'static [Whose],
    /// Kinds; an empty list means all.
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

/// The forms of solids by code, kind and variant. The first fitting line counts.
const RULES: &[Rule] = {
    use ElementKind::{
        Hexahedron8, Hexahedron20, Pyramid5, Pyramid13, Tetrahedron4, Tetrahedron10, Wedge6,
        Wedge15,
    };
    use For::{Any, AnyLetters, Letters, Plain, Points};
    use Verdict::{Differing, Form as Made, Refused};
    use Whose::{Abaqus, Ansys, CalculiX, Nastran, Nobody};
    const FULL: Verdict = Made(Form::Full);
    const REDUCED: Verdict = Made(Form::Reduced);
    const BUBBLE: Verdict = Made(Form::Incompatible);
    const ADVICE: &str = "state `element_rules = nastran`, which gives 8-node hexahedra incompatible modes, or write C3D20R in the file";
    const ANSYS_ADVICE: &str = "set KEYOPT(2) = 0 (B-bar) and write the archive again; or state `element_rules = nastran`, which gives 8-node hexahedra incompatible modes";
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
        rule(
            &[Ansys],
            &[],
            For::Number(285),
            Refused(
                "a tetrahedron of four nodes with pressures, by a rule that is not public",
                "mesh with SOLID187",
            ),
        ),
        rule(&[Ansys], &[Tetrahedron4, Tetrahedron10, Wedge15], Any, FULL),
        rule(&[Ansys], &[Hexahedron20], For::Option(0), REDUCED),
        rule(
            &[Ansys],
            &[Hexahedron20],
            Any,
            Refused(
                "its 14 points of integration are not reproduced",
                "set KEYOPT(2) = 0, which is ANSYS' default, and write the archive again",
            ),
        ),
        rule(
            &[Ansys],
            &[Pyramid13],
            Any,
            Differing(Form::Full, "ANSYS takes 2³ points"),
        ),
        rule(
            &[Ansys],
            &[Hexahedron8],
            For::Option(0),
            Made(Form::MeanDilatation),
        ),
        rule(
            &[Ansys],
            &[Wedge6, Pyramid5],
            For::Option(0),
            Differing(
                Form::Full,
                "ANSYS takes the mean of their volume strain (B-bar)",
            ),
        ),
        rule(
            &[Ansys],
            &[],
            For::Option(1),
            Refused(
                "one integration point and an artificial stiffness against hourglasses",
                ANSYS_ADVICE,
            ),
        ),
        rule(
            &[Ansys],
            &[],
            Any,
            Refused(
                "its enhanced strains are not public in all details",
                ANSYS_ADVICE,
            ),
        ),
        rule(&[Abaqus, CalculiX], &[Hexahedron20], Letters("R"), REDUCED),
        rule(
            &[CalculiX],
            &[Hexahedron8],
            Letters("R"),
            Refused(
                "one integration point, also for the mass, and a stiffness against hourglasses that resists the rigid rotation of distorted elements",
                ADVICE,
            ),
        ),
        rule(
            &[Abaqus],
            &[Hexahedron8],
            Letters("R"),
            Refused(
                "one integration point and a stiffness against hourglasses that carries all of its bending and whose rule is not public in all details",
                ADVICE,
            ),
        ),
        rule(
            &[Abaqus, CalculiX, Nastran],
            &[Tetrahedron10],
            Letters("M"),
            Refused(
                "Abaqus' modified functions with freedoms inside are not public",
                "write C3D10 in the file",
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
            Differing(Form::Full, "Abaqus takes fewer points"),
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
            Differing(
                Form::Full,
                "Nastran integrates their shear at fewer points, by a rule that is not public",
            ),
        ),
    ]
};

const IN_FULL: &str = "; or state `element_rules = exact`, which integrates them in full";

/// The verdict of the table on an element.
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
/// A variant without a rule here.
pub(crate) fn form(
    mesh: &Mesh,
    element: &Element,
    rule: StiffnessRule,
) -> Result<Form, FlexibleError> {
    match verdict(element.kind, element.variant, mesh.code, rule) {
        Verdict::Form(form) | Verdict::Differing(form, _) => Ok(form),
        Verdict::Refused(..) => {
            check(mesh, rule)?;
            Ok(Form::Full)
        }
    }
}

/// How the directors of shells of four nodes turn between them: Nastran's have its residual bending flexibility.
pub(super) fn rotations(mesh: &Mesh, rule: StiffnessRule) -> Rotations {
    match Whose::of(mesh.code, rule) {
        Whose::Nastran => Rotations::Parabolic,
        Whose::InFull | Whose::Nobody | Whose::Abaqus | Whose::CalculiX | Whose::Ansys => {
            Rotations::Bilinear
        }
    }
}

/// The mass rule of a solid. If the rules of the file's code apply, a variant can have its own.
pub(super) fn mass_rule(mesh: &Mesh, element: &Element, rules: &Rules) -> MassRule {
    match (rules.stiffness, rules.mass, element.variant, mesh.code) {
        (StiffnessRule::Named, MassRule::Exact, Variant::Letters(_), Code::CalculiX) => {
            MassRule::CalculiX
        }
        (StiffnessRule::Named, MassRule::Exact, Variant::Letters(_), Code::Abaqus) => {
            MassRule::Abaqus
        }
        (StiffnessRule::Named, MassRule::Exact, Variant::Technology { .. }, Code::Ansys) => {
            MassRule::Ansys
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
    if let Variant::Technology { element, option } = variant {
        let shape = match kind.linear() {
            ElementKind::Wedge6 => ", wedge",
            ElementKind::Pyramid5 => ", pyramid",
            ElementKind::Tetrahedron4 if element != 187 && element != 285 => ", tetrahedron",
            _ => "",
        };
        return format!("SOLID{element} (KEYOPT(2) = {option}{shape})");
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

/// The name of a kind of element in the file of a mesh, without its variant.
pub(super) fn plain_name(mesh: &Mesh, kind: ElementKind) -> String {
    name(mesh, kind, Variant::Plain)
}

/// For each type of solid: the count, and the number of the first.
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

/// Refuses a mesh with solids that have no rule here.
///
/// # Errors
/// All such types, with their numbers of elements and the remedy.
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

/// The warnings about the forms and masses of a mesh's elements.
pub fn warnings(mesh: &Mesh, rules: &Rules) -> Vec<String> {
    let rule = rules.stiffness;
    let mut warnings = Vec::new();
    for ((kind, variant), (count, _)) in types(mesh) {
        let name = name(mesh, kind, variant);
        match (verdict(kind, variant, mesh.code, rule), rule) {
            (Verdict::Differing(_, why), _) => warnings.push(format!(
                "{count} × {name} are integrated in full, and {why}: coarse meshes are stiffer here; `element_rules = exact` accepts this"
            )),
            (_, StiffnessRule::Full) if matches!(variant, Variant::Letters(_)) => {
                warnings.push(format!(
                    "{count} × {name} are integrated in full, as `element_rules = exact` states"
                ));
            }
            _ => {}
        }
    }
    warnings.extend(super::shell::too_curved(mesh));
    if rules.for_mesh(mesh).mass == MassRule::Nastran {
        warnings.extend(not_lumped(mesh));
    }
    warnings
}

/// The warning about elements whose lumped mass in Nastran is not public.
fn not_lumped(mesh: &Mesh) -> Option<String> {
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    for element in &mesh.elements {
        let heavy = matches!(
            role(mesh, element),
            Some(Role::Solid(_) | Role::Shell(_) | Role::Coat(_))
        );
        if heavy && !shares_equally(element.kind) {
            let name = name(mesh, element.kind, Variant::Plain);
            *kinds.entry(name).or_default() += 1;
        }
        let property = mesh.properties.get(element.property as usize);
        if property.is_some_and(|property| matches!(property.section, Section::Tapered(_))) {
            *kinds.entry("CBEAM with a taper".into()).or_default() += 1;
        }
    }
    let listed: Vec<String> = kinds
        .into_iter()
        .map(|(name, count)| format!("{count} × {name}"))
        .collect();
    (!listed.is_empty()).then(|| {
        format!(
            "{} have a consistent mass, because Nastran's lumped one is not public: `PARAM,COUPMASS,1` in the deck gives all elements a consistent mass, `element_rules = exact` here alone",
            listed.join(", ")
        )
    })
}
