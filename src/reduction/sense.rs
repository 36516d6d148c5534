//! What is doubtful about a mesh: units that make no engine part, cards that were not read, markers that cannot turn.

use super::{failed, span};
use crate::codes;
use crate::significant::short;
use eng_flexible::FlexibleError;
use eng_flexible::mesh::{Carries, Mesh};
use eng_grammar::Diagnostic;
use eng_system::flexible::{FlexibleSource, MarkerPlace};
use eng_system::reduced::ReducedBody;

/// Sizes of parts that engines and rigs have (m).
const SIZES: (f64, f64) = (1e-3, 50.0);
/// Densities of solids (kg/m³).
const DENSITIES: (f64, f64) = (50.0, 25_000.0);
/// Young's moduli of solids (Pa).
const MODULI: (f64, f64) = (1e6, 2e12);

/// Doubts about a mesh in SI.
pub(super) fn doubts(mesh: &Mesh, source: &FlexibleSource) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for node in &mesh.nodes {
        for ((l, h), x) in low.iter_mut().zip(&mut high).zip(node.position) {
            *l = l.min(x);
            *h = h.max(x);
        }
    }
    let size = low
        .iter()
        .zip(&high)
        .map(|(l, h)| h - l)
        .fold(0.0, f64::max);
    let outside = |x: f64, (least, most): (f64, f64)| x.is_nan() || x < least || x > most;
    let mut odd = Vec::new();
    if outside(size, SIZES) {
        odd.push(format!("the body is {} m long", short(size, 6)));
    }
    for material in &mesh.materials {
        if outside(material.density, DENSITIES) {
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
        found.push(
            Diagnostic::warning(
                codes::MESH_UNITS,
                format!(
                    "{}: with `units: {}`, {}",
                    source.origin.path,
                    source.mesh.units,
                    odd.join(", ")
                ),
            )
            .at(span(source.mesh.at), "are these the units of the file?")
            .with_help(
                "finite-element files don't state their units; common are mm_tonne_s and m_kg_s",
            ),
        );
    }
    for unread in &mesh.unread {
        let effect = match unread.carries {
            Carries::Nothing => continue,
            Carries::Structure => "carries mass, stiffness or a constraint",
            Carries::Unknown => "may carry mass, stiffness or a constraint",
        };
        let (file, line) = &unread.first;
        found.push(
            Diagnostic::warning(
                codes::UNREAD,
                format!(
                    "{}: {} × {} is not read and {effect}",
                    source.origin.path, unread.count, unread.name
                ),
            )
            .at(span(source.mesh.at), "of this mesh")
            .with_note(format!("the first is at {file}:{line}")),
        );
    }
    found
}

/// A marker that elements turn stands on a node that does not turn.
pub(super) fn bare_markers(
    body: &ReducedBody,
    source: &FlexibleSource,
    turned: &[bool],
) -> Result<(), Box<Diagnostic>> {
    for ((marker, reduced), turned) in source.markers.iter().zip(&body.markers).zip(turned) {
        let bare = matches!(marker.place, MarkerPlace::Node(_))
            && reduced.rotation.iter().all(|x| *x == 0.0)
            && reduced.translation.iter().any(|x| *x != 0.0);
        if *turned && bare {
            return Err(failed(
                codes::MESH_MARKER,
                &FlexibleError::Structure {
                    problem: format!(
                        "{}: an element uses the axes of this marker or turns it, but the node of a solid does not turn",
                        marker.name
                    ),
                    advice: "gather nodes by `ring`, `patch` or `set`: the middle of what they tie turns".into(),
                },
                marker.at,
                "this marker",
            ));
        }
    }
    Ok(())
}
