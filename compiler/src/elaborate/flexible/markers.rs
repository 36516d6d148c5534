//! Markers on meshes: their nodes, ties and axes.

use super::super::body::index_text;
use super::super::value::{ScopeId, Value};
use super::super::{Elaborator, Eval, Reported, location};
use super::bare_word;
use crate::codes;
use crate::words::{Place, argument};
use eng_grammar::{Diagnostic, ast};
use eng_system::flexible::{MarkerPlace, MarkerSource, Selection, Spider};
use eng_system::significant::short;
use eng_system::surface::SurfaceShapes;
use eng_system::system::BodyRef;

/// Most waves of a surface around, and its highest degree across. Choices: shapes make columns of dense
/// matrices, and meshes of bearings are too coarse for more.
const MOST_WAVES: i64 = 40;
const MOST_DEGREE: i64 = 8;

impl<'a> Elaborator<'a, '_> {
    /// Markers of one declaration. `known` gets their names with the positions in their array.
    pub(super) fn markers_on_mesh(
        &mut self,
        declaration: &'a ast::Declaration,
        body: BodyRef,
        scope: ScopeId,
        path: &str,
        markers: &mut Vec<(MarkerSource, u32)>,
        known: &mut Vec<(String, Vec<usize>)>,
    ) -> Eval<Value<'a>> {
        let (value, _) = self.instance(declaration)?;
        let name = &declaration.name.text;
        self.instances_of(declaration, scope, &mut |e, inner, position| {
            let text = format!("{name}{}", index_text(position));
            let (place, tied, axes) = e.place_on_mesh(value, inner)?;
            let surface = e.surface_of_marker(value, inner)?;
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
                    tied,
                    axes,
                    surface,
                },
                marker,
            ));
            known.push((name.clone(), position.to_vec()));
            Ok(Value::Marker(marker))
        })
    }

    /// The shapes of a marker's surface, if the text states one.
    fn surface_of_marker(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<Option<SurfaceShapes>> {
        let (word, arguments) = self.worded(Place::Marker, value)?;
        let Some(stated) = argument(word, arguments, "surface") else {
            return Ok(None);
        };
        let (word, arguments) = self.worded(Place::Surface, stated)?;
        let mut count = |name: &str, most: i64| -> Eval<u32> {
            let given = argument(word, arguments, name);
            let given = self.checked(given, stated.span, "a surface without its shapes")?;
            let number = self.integer(given, scope)?;
            match u32::try_from(number) {
                Ok(count) if number <= most => Ok(count),
                _ => Err(self.report(
                    Diagnostic::error(
                        codes::FLEXIBLE_NUMBER,
                        format!("`{name}` of `{}` is {number}", word.word),
                    )
                    .at(given.span, format!("it must be 0 to {most}")),
                )),
            }
        };
        let shapes = SurfaceShapes {
            around: count("waves_around", MOST_WAVES)?,
            across: count("degree_across", MOST_DEGREE)?,
        };
        // a number of waves that an analysis states can leave the surface rigid
        Ok((shapes.around > 0).then_some(shapes))
    }

    /// The place of a marker, whether the text states its tie, and its axes.
    pub(super) fn place_on_mesh(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<(MarkerPlace, bool, [f64; 9])> {
        let (word, arguments) = self.worded(Place::Marker, value)?;
        let get = |name: &str| argument(word, arguments, name);
        let vector = |e: &mut Self, name: &str| -> Eval<Option<[f64; 3]>> {
            get(name).map(|x| e.known_vector(x, scope)).transpose()
        };
        let length = |e: &mut Self, name: &str| -> Eval<Option<f64>> {
            get(name).map(|x| e.structural_number(x, scope)).transpose()
        };
        let axis = |e: &mut Self, name: &str| -> Eval<[f64; 3]> {
            let expr = e.checked(get(name), value.span, "a place without its axis")?;
            e.known_axis(expr, scope)
        };
        // a length
        let positive = |e: &mut Self, name: &str| -> Eval<f64> {
            let expr = e.checked(get(name), value.span, &format!("a place without `{name}`"))?;
            let x = e.structural_number(expr, scope)?;
            if x > 0.0 && x.is_finite() {
                return Ok(x);
            }
            Err(e.report(
                Diagnostic::error(
                    codes::FLEXIBLE_NUMBER,
                    format!("`{name}` of `{}` must be positive", word.word),
                )
                .at(expr.span, format!("this is {} mm", short(1e3 * x, 4))),
            ))
        };
        let text = |e: &mut Self, name: &str| -> Eval<String> {
            e.text_of(get(name), scope)?.ok_or(Reported)
        };
        let center = vector(self, "center")?;
        let tie = match get("tie").map(bare_word) {
            Some("rigid") => Spider::Rigid,
            _ => Spider::Averaging,
        };
        // a ring or a patch states its middle; that of a set is the mean of its nodes unless stated
        let gathered = |nodes| MarkerPlace::Gathered { nodes, tie, center };
        let place = match word.word {
            "node" => {
                let id = self.checked(get("id"), value.span, "a node without its number")?;
                let number = self.integer(id, scope)?;
                match u64::try_from(number) {
                    Ok(n) if n > 0 => MarkerPlace::Node(n),
                    _ => {
                        return Err(self.report(
                            Diagnostic::error(
                                codes::FLEXIBLE_NUMBER,
                                "the number of a node must be positive",
                            )
                            .at(id.span, format!("this is {number}")),
                        ));
                    }
                }
            }
            "set" => gathered(Selection::Set(text(self, "name")?)),
            "property" => gathered(Selection::Property(text(self, "name")?)),
            "ring" => {
                let radius = positive(self, "radius")?;
                gathered(Selection::Ring {
                    center: center.unwrap_or_default(),
                    axis: axis(self, "axis")?,
                    radius,
                    width: positive(self, "width")?,
                    // only chords of coarse facets are inside the surface by some per cent; nodes are on the
                    // surface itself
                    tolerance: length(self, "tolerance")?.unwrap_or(1e-3 * radius),
                })
            }
            "patch" => {
                let radius = positive(self, "radius")?;
                gathered(Selection::Patch {
                    center: center.unwrap_or_default(),
                    normal: axis(self, "normal")?,
                    radius,
                    tolerance: length(self, "tolerance")?.unwrap_or(1e-3 * radius),
                })
            }
            "plane" => gathered(Selection::Patch {
                center: vector(self, "point")?.unwrap_or_default(),
                normal: axis(self, "normal")?,
                radius: f64::INFINITY,
                // a choice: nodes of a plane are on it but for the digits of their file
                tolerance: length(self, "tolerance")?.unwrap_or(1e-6),
            }),
            _ => return self.checked(None, value.span, "no place on a mesh"),
        };
        let x = get("x").map(|x| self.direction(x, scope)).transpose()?;
        let z = get("z").map(|z| self.direction(z, scope)).transpose()?;
        self.not_parallel(x, z, value.span, scope)?;
        let nodes = self.orientation(x, z);
        let mut axes = [0.0; 9];
        for (number, node) in axes.iter_mut().zip(nodes) {
            *number = match self.graphs.bind.graph.as_constant(node) {
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
        Ok((place, get("tie").is_some(), axes))
    }
}
