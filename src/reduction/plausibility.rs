//! Doubts about a mesh: units that make no engine part, cards that were not read, markers that cannot turn.

use super::failed;
use super::inspection::MeshFacts;
use crate::codes;
use crate::places::span;
use eng_flexible::FlexibleError;
use eng_flexible::mesh::{Carries, Code, Element, ElementKind, Mesh, Unread, Variant};
use eng_flexible::units::{MeshUnits, differ};
use eng_grammar::Diagnostic;
use eng_system::flexible::{FlexibleSource, MarkerPlace, MeshFile};
use eng_system::mesh_files::MeshFormat;
use eng_system::reduced::ReducedMarker;
use eng_system::significant::short;

/// Sizes of parts that engines and rigs have (m). A choice, from a shim to a marine crankshaft.
const SIZES: (f64, f64) = (1e-3, 50.0);
/// Densities of solids (kg/m³). A choice from foam to osmium, 22 600.
const DENSITIES: (f64, f64) = (50.0, 25_000.0);
/// Young's moduli of solids (Pa). A choice from rubber to diamond, 1.2e12.
const MODULI: (f64, f64) = (1e6, 2e12);

/// Doubts about a mesh in SI.
pub(super) fn doubts(mesh: &MeshFacts, source: &FlexibleSource) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let size = mesh.size;
    let outside = |x: f64, (least, most): (f64, f64)| x.is_nan() || x < least || x > most;
    let mut odd = Vec::new();
    if outside(size, SIZES) {
        odd.push(format!("the body is {} m long", short(size, 6)));
    }
    for material in &mesh.materials {
        // the reduction refuses a body without mass; no units give zero
        if material.density != 0.0 && outside(material.density, DENSITIES) {
            odd.push(format!(
                "material {} has a density of {} kg/m³",
                material.name,
                short(material.density, 6)
            ));
        }
        if outside(material.young, MODULI) {
            odd.push(format!(
                "material {} has a Young's modulus of {} Pa",
                material.name,
                short(material.young, 6)
            ));
        }
    }
    if !odd.is_empty() {
        let (title, label, help) = match source.mesh.file() {
            Some(file) => (
                match file.units {
                    Some(units) => format!("with `units: {}`, {}", units.name, odd.join(", ")),
                    None => format!("with the units of the file, {}", odd.join(", ")),
                },
                "are these the units of the file?",
                "finite-element files don't state their units; common are mm_tonne_s and m_kg_s",
            ),
            None => (
                odd.join(", "),
                "are these the units of the sections?",
                "lengths of sections have units of their own, such as `20 mm`",
            ),
        };
        found.push(
            Diagnostic::warning(
                codes::MESH_UNITS,
                format!("{}: {title}", source.origin.path),
            )
            .at(span(source.mesh.at()), label)
            .with_help(help),
        );
    }
    found.extend(supports_left_out(mesh, source));
    for doubt in &mesh.doubts {
        found.push(
            Diagnostic::warning(
                codes::MESH_DOUBT,
                format!("{}: {doubt}", source.origin.path),
            )
            .at(span(source.mesh.at()), "of this mesh"),
        );
    }
    found.extend(ignored_for_nothing(mesh, source));
    found
}

/// The note that the mass is exact, although the code of the mesh has another one by its own rules.
pub(super) fn own_mass(mesh: &Mesh) -> Option<&'static str> {
    if mesh.lumped && !mesh.elements.is_empty() {
        return Some(
            "the mass of its elements is consistent; Nastran lumps it without `PARAM,COUPMASS,1` in the deck, and its frequencies of coarse meshes differ: `element_rules = nastran` computes as it does",
        );
    }
    mass_is_not_calculix(mesh).then_some(
        "the mass of its solids is exact; CalculiX takes it at fewer points, and its frequencies of coarse or distorted meshes differ (of C3D6 by up to 15 %): `element_rules = calculix` computes as it does",
    )
}

/// Whether a mesh of CalculiX has solids whose mass it takes at fewer points than an exact one: all but
/// C3D20R.
fn mass_is_not_calculix(mesh: &Mesh) -> bool {
    use ElementKind::{Beam2, Hexahedron20, Quadrilateral4, Quadrilateral8, Triangle3, Triangle6};
    let no_solids = [Beam2, Quadrilateral4, Quadrilateral8, Triangle3, Triangle6];
    let plain =
        |element: &Element| element.kind != Hexahedron20 || element.variant == Variant::Plain;
    let mut solids = mesh
        .elements
        .iter()
        .filter(|e| !no_solids.contains(&e.kind));
    mesh.code == Code::CalculiX && solids.any(plain)
}

/// Whether a text of `ignore` means a card or keyword: its name without asterisk, in upper or lower case,
/// with or without the words after the name.
fn means(ignored: &str, name: &str) -> bool {
    let plain = |text: &str| text.trim().trim_start_matches('*').to_ascii_uppercase();
    let (ignored, name) = (plain(ignored), plain(name));
    !ignored.is_empty()
        && name
            .strip_prefix(ignored.as_str())
            .is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_'))
}

/// Whether the text leaves out the units that a universal file states.
pub(super) fn units_are_ignored(file: &MeshFile) -> bool {
    file.format == MeshFormat::Universal && file.ignored.iter().any(|i| means(i, "164"))
}

/// The units of a mesh: those of the text, or those of the file. Only universal files state units of which
/// values are made, and the text must not contradict them.
pub(super) fn units(mesh: &mut Mesh, file: &MeshFile) -> Result<MeshUnits, FlexibleError> {
    if units_are_ignored(file) {
        mesh.units = None;
    }
    let wrong = |problem: String, advice: &str| {
        Err(FlexibleError::Structure {
            problem,
            advice: advice.into(),
        })
    };
    match (file.units, &mesh.units) {
        (Some(units), Some((name, own)))
            if file.format == MeshFormat::Universal && differ(*own, &units) =>
        {
            let [length, mass, time] = own.map(|unit| short(unit, 6));
            wrong(
                format!(
                    "dataset 164 of the file states units of {length} m, {mass} kg and {time} s ({name}), but the model states `units: {}`",
                    units.name
                ),
                "correct `units:` or leave it out; if the program that wrote the file states the same units in each file, as Salome and FreeCAD do, add `ignore: [\"164\"]`",
            )
        }
        (Some(units), _) => Ok(units),
        (None, Some((_, [length, mass, time]))) => Ok(MeshUnits {
            name: "of the file",
            length: *length,
            mass: *mass,
            time: *time,
        }),
        (None, None) => wrong(
            "neither the file nor the model states the units of the mesh".into(),
            "write `units: mm_tonne_s` or other units in the mesh",
        ),
    }
}

/// The supports of the deck, if the body does not use them.
fn supports_left_out(mesh: &MeshFacts, source: &FlexibleSource) -> Option<Diagnostic> {
    if source.support_of_deck || source.stiffness.is_some() {
        return None;
    }
    let named: Vec<String> = mesh
        .support_cards
        .iter()
        .filter(|cards| !source.mesh.ignored().iter().any(|i| means(i, &cards.name)))
        .map(|cards| {
            let (file, line) = &cards.first;
            format!(
                "{} × {} (the first at {file}:{line})",
                cards.count, cards.name
            )
        })
        .collect();
    let first = mesh.support_cards.first()?;
    if named.is_empty() {
        return None;
    }
    Some(
        Diagnostic::warning(
            codes::DECK_SUPPORT,
            format!(
                "{}: the supports of the deck are not used: {}",
                source.origin.path,
                named.join(", ")
            ),
        )
        .at(span(source.mesh.at()), "of this mesh")
        .with_help(format!(
            "write `support = deck` to hold the supports of the deck, or `ignore: [\"{}\"]` in the mesh to leave it out",
            first.name
        )),
    )
}

/// Texts of `ignore` that mean nothing in the file.
fn ignored_for_nothing<'a>(
    mesh: &'a MeshFacts,
    source: &'a FlexibleSource,
) -> impl Iterator<Item = Diagnostic> + 'a {
    let nothing = |ignored: &&String| {
        let unread = mesh.unread.iter().map(|unread| &unread.name);
        let held = mesh.support_cards.iter().map(|cards| &cards.name);
        !unread.chain(held).any(|name| means(ignored, name))
    };
    source.mesh.ignored().iter().filter(nothing).map(|ignored| {
        Diagnostic::warning(
            codes::IGNORED_NOTHING,
            format!(
                "{}: `ignore` names {ignored}, which is no unread content of the mesh",
                source.origin.path
            ),
        )
        .at(span(source.mesh.at()), "`ignore` names it")
        .with_help("remove it from the list, or correct the name")
    })
}

/// The reasons against the reduction of a mesh: stiffness, mass and constraints that are not read, elements
/// whose rules are not reproduced. With matrices of another code none of this matters.
pub(super) fn refusal(mesh: &Mesh, source: &FlexibleSource) -> Option<Box<Diagnostic>> {
    unread(&mesh.unread, source).or_else(|| {
        if source.stiffness.is_some() {
            return None;
        }
        let rules = super::request::rules(source.element_rules);
        let error = eng_flexible::fe::form::check(mesh, rules.stiffness).err()?;
        Some(failed(
            codes::ELEMENT_RULE,
            &error,
            source.mesh.at(),
            "in this mesh",
        ))
    })
}

/// Cards and keywords that are not read and not ignored, unless another code gives the matrices.
pub(super) fn unread(unread: &[Unread], source: &FlexibleSource) -> Option<Box<Diagnostic>> {
    if source.stiffness.is_some() {
        return None;
    }
    let lost: Vec<_> = unread
        .iter()
        .filter(|unread| unread.carries != Carries::Nothing)
        .filter(|unread| !source.mesh.ignored().iter().any(|i| means(i, &unread.name)))
        .collect();
    if lost.is_empty() {
        return None;
    }
    let mut message = Diagnostic::error(
        codes::UNREAD,
        format!(
            "{}: the mesh has contents that Eng does not read and that may carry stiffness, mass or constraints",
            source.origin.path
        ),
    )
    .at(span(source.mesh.at()), "this mesh");
    for unread in &lost {
        let (file, line) = &unread.first;
        let effect = match unread.carries {
            Carries::Unknown => "not known",
            _ => "stiffness, mass or a constraint",
        };
        // files of binary data have no lines
        let first = match line {
            0 => String::new(),
            line => format!(" (the first at {file}:{line})"),
        };
        message = message.with_note(format!(
            "{} × {}{first}: {effect}",
            unread.count, unread.name
        ));
    }
    let names: Vec<String> = lost
        .iter()
        .map(|unread| format!("{:?}", unread.name))
        .collect();
    Some(Box::new(message.with_help(format!(
        "remove it from the file and state it in the model; or, if the body does not need it, write `ignore: [{}]` in the mesh",
        names.join(", ")
    ))))
}

/// Whether the shapes of a reduced body turn a marker, as far as they move it at all.
pub(super) fn turns(marker: &ReducedMarker) -> bool {
    marker.rotation.iter().any(|x| *x != 0.0) || marker.translation.iter().all(|x| *x == 0.0)
}

/// A message if elements turn a marker on a node without rotation. `turns` states which nodes have rotations.
pub(super) fn bare_markers(
    turns: &[bool],
    source: &FlexibleSource,
    turned: &[bool],
) -> Result<(), Box<Diagnostic>> {
    for ((marker, turns), turned) in source.markers.iter().zip(turns).zip(turned) {
        let bare = matches!(marker.place, MarkerPlace::Node(_)) && !turns;
        if *turned && bare {
            return Err(failed(
                codes::MESH_MARKER,
                &FlexibleError::Structure {
                    problem: format!(
                        "{}: an element uses the axes of this marker or turns it, but the node of a solid does not turn",
                        marker.name
                    ),
                    advice: "gather nodes by `ring`, `patch` or `set`: the reference point of several nodes turns".into(),
                },
                marker.at,
                "this marker",
            ));
        }
    }
    Ok(())
}
