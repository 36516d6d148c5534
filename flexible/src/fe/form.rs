//! The form of each solid: what its file names, by the rules of a code.
//!
//! | element | CalculiX 2.20 | Abaqus | Nastran | without code, or all in full |
//! | --- | --- | --- | --- | --- |
//! | 8-node hexahedron | full | mean dilatation | incompatible modes; full with `IN = 2`, `ISOP = 1` | incompatible modes; all in full: full |
//! | … `R` | refused | refused | incompatible modes | full |
//! | … `I` | refused | refused | incompatible modes | full |
//! | 20-node hexahedron | full | full | full, told; full with `IN = 3`, `ISOP = 1` | full |
//! | … `R` | reduced | reduced | reduced; so with `IN = 2`, `ISOP = 1` | full |
//! | 6-node wedge | reduced (2 points) | full, told | full, told | full |
//! | 15-node wedge, pyramids | full | full | full, told | full |
//! | tetrahedra | full | full | full | full |
//! | other variants (`H`, `M`, …) | refused | refused | refused | full |
//!
//! CalculiX' C3D8R has one point, also for its mass, which then lacks the element's own inertia, and stiffness against hourglasses that
//! resists rigid rotation in elements that are no parallelepipeds. The incompatible modes of its C3D8I are freedoms with mass. Nastran
//! takes shear at fewer points by default, and does not publish which: its quadratic elements and wedges are computed in full and told.
//! A mesh of no code (gmsh) names no rule. Full integration of its 8-node hexahedra would lock in bending, so they have incompatible modes.
//!
//! Sources: Abaqus Theory Guide 3.2.4 and its matrices; CalculiX 2.20 (`e_c3d.f`, `shape8hu.f`, `shape8hr.f`) and its frequencies; MSC
//! Nastran Quick Reference Guide, `PSOLID`.

use std::collections::BTreeMap;

use super::check::{Role, role};
use super::rules::{MassRule, Rules, StiffnessRule};
use crate::error::FlexibleError;
use crate::mesh::{Code, Element, ElementKind, Mesh, VARIANT_LETTERS, Variant};

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

const INCOMPATIBLE: &str = "state `element_rules = nastran`, which gives 8-node hexahedra incompatible modes, or write C3D20R in the file";
const IN_FULL: &str = "; or state `element_rules = exact`, which integrates them in full";

/// The code whose rules hold for a mesh written for `mesh`.
fn code(mesh: Code, rule: StiffnessRule) -> Code {
    match rule {
        StiffnessRule::Named => mesh,
        StiffnessRule::Full => Code::None,
        StiffnessRule::CalculiX => Code::CalculiX,
        StiffnessRule::Abaqus => Code::Abaqus,
        StiffnessRule::Nastran => Code::Nastran,
    }
}

/// The bit of a letter.
fn letter(wanted: char) -> u8 {
    VARIANT_LETTERS
        .chars()
        .position(|c| c == wanted)
        .map_or(0, |bit| 1 << bit)
}

fn verdict(kind: ElementKind, variant: Variant, mesh: Code, rule: StiffnessRule) -> Verdict {
    use ElementKind::{Hexahedron8, Hexahedron20, Wedge6};
    use Verdict::{Refused, Told};
    let full = Verdict::Form(Form::Full);
    let reduced = Verdict::Form(Form::Reduced);
    let letters = match variant {
        Variant::Letters(letters) => letters,
        _ => 0,
    };
    match (code(mesh, rule), kind) {
        (Code::None, Hexahedron8) if rule == StiffnessRule::Named => {
            Verdict::Form(Form::Incompatible)
        }
        (Code::None, _) => full,
        (Code::Nastran, kind) => nastran(kind, variant),
        (_, Hexahedron20) if letters == letter('R') => reduced,
        (_, Hexahedron8) if letters == letter('R') => Refused(
            "one integration point and an artificial stiffness against hourglasses, so that bending takes many elements across",
            INCOMPATIBLE,
        ),
        (Code::Abaqus, Hexahedron8) if letters == letter('I') => {
            Refused("its incompatible modes are not public", INCOMPATIBLE)
        }
        (_, Hexahedron8) if letters == letter('I') => Refused(
            "its incompatible modes are freedoms with mass",
            INCOMPATIBLE,
        ),
        (_, _) if letters != 0 => Refused(
            "its rule is not reproduced",
            "write the plain type or C3D20R in the file",
        ),
        (Code::Abaqus, Hexahedron8) => Verdict::Form(Form::MeanDilatation),
        (Code::CalculiX, Wedge6) => reduced,
        (Code::Abaqus, Wedge6) => Told(Form::Full, "Abaqus takes fewer points"),
        _ => full,
    }
}

/// The rules of `PSOLID`, as far as they are public, and what comes nearest for the letters of other codes.
fn nastran(kind: ElementKind, variant: Variant) -> Verdict {
    use ElementKind::{Hexahedron8, Hexahedron20, Tetrahedron4, Tetrahedron10};
    let in_full = Variant::Network {
        points: 2,
        full: true,
    };
    let refused = Verdict::Refused(
        "reduced integration of the shear alone is not public",
        "leave IN and ISOP of their PSOLID blank",
    );
    match (kind, variant) {
        (Hexahedron8, _) if variant == in_full => Verdict::Form(Form::Full),
        (Hexahedron20, _) if variant == in_full => Verdict::Form(Form::Reduced),
        (Hexahedron20, Variant::Letters(letters)) if letters == letter('R') => {
            Verdict::Form(Form::Reduced)
        }
        (Tetrahedron4 | Tetrahedron10, Variant::Network { .. }) => Verdict::Form(Form::Full),
        (Hexahedron8, Variant::Plain | Variant::Network { points: 0, .. }) => {
            Verdict::Form(Form::Incompatible)
        }
        (Hexahedron8, Variant::Letters(letters))
            if [letter('R'), letter('I')].contains(&letters) =>
        {
            Verdict::Form(Form::Incompatible)
        }
        (_, Variant::Letters(_)) => Verdict::Refused(
            "its rule is not reproduced",
            "write the plain type or C3D20R in the file",
        ),
        (Hexahedron8, Variant::Network { .. }) => refused,
        (
            _,
            Variant::Network {
                points: 3,
                full: true,
            },
        ) => Verdict::Form(Form::Full),
        (_, Variant::Network { points: 1.., .. }) => refused,
        (Tetrahedron4 | Tetrahedron10, _) => Verdict::Form(Form::Full),
        _ => Verdict::Told(
            Form::Full,
            "Nastran integrates their shear at fewer points, by a rule that is not public",
        ),
    }
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
    if mesh.code == Code::Nastran {
        let card = match kind.corner_count() {
            4 => "CTETRA",
            5 => "CPYRAM",
            6 => "CPENTA",
            _ => "CHEXA",
        };
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
    format!("C3D{nodes}{letters}")
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
            title(code(mesh.code, rule)),
            refused.join("; ")
        ),
        advice: format!("{}{IN_FULL}", advised.join("; ")),
    })
}

fn title(code: Code) -> &'static str {
    match code {
        Code::None => "their code",
        Code::Nastran => "Nastran",
        Code::Abaqus => "Abaqus",
        Code::CalculiX => "CalculiX",
    }
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
