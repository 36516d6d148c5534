//! Files, material and damping of a flexible body.

use super::super::typed::RecordScope;
use super::super::value::ScopeId;
use super::super::{Elaborator, Eval, Reported, location};
use super::meaning;
use crate::codes;
use crate::words::{Place, Word, argument, word};
use eng_grammar::ast::ExprKind;
use eng_grammar::{Diagnostic, Span, ast};
use eng_system::flexible::{
    Damping, MaterialSource, MatrixSource, MeshFile, MeshSource, RecoverySource, ShellSurfaces,
};
use eng_system::mesh_files::{MatrixFormat, MeshFormat, Stated as _};
use eng_system::significant::short;

/// Damping ratio of all modes above which a value is implausible for a structure. A choice: steel structures
/// have some per cent, rubber mounts ten and more.
const MUCH_DAMPING: f64 = 0.2;

/// The largest share of a rigid motion that recovered nodes may miss unless the text states another one. A choice: files of
/// five digits miss less, and columns in a wrong order miss far more.
const RIGID_MOTION: f64 = 1e-3;

impl<'a> Elaborator<'a, '_> {
    pub(super) fn mesh_source(&mut self, value: &'a ast::Expr, scope: ScopeId) -> Eval<MeshSource> {
        let (word, arguments) = self.worded(Place::Mesh, value)?;
        if word.word == "stack" {
            return Ok(MeshSource::Stack(self.stack_source(value, scope)?));
        }
        let file = self.text_of(argument(word, arguments, "file"), scope)?;
        let units = argument(word, arguments, "units").and_then(meaning);
        let file = self.checked(file, value.span, "a mesh without a file")?;
        let format = MeshFormat::named(word.word);
        let format = self.checked(format, value.span, "no format of a mesh")?;
        let ignored = self.texts(argument(word, arguments, "ignore"), scope)?;
        let shells = self.shells_of_mesh((word, arguments), value.span, scope)?;
        Ok(MeshSource::File(MeshFile {
            format,
            file,
            units,
            ignored,
            shells,
            at: location(value.span),
        }))
    }

    /// The texts of a list; none without a list.
    fn texts(&mut self, list: Option<&'a ast::Expr>, scope: ScopeId) -> Eval<Vec<String>> {
        let mut texts = Vec::new();
        if let Some(ExprKind::List { items, .. }) = list.map(|list| &list.kind) {
            for item in items {
                texts.extend(self.text_of(Some(item), scope)?);
            }
        }
        Ok(texts)
    }

    /// The surfaces of a mesh that are shells, if the text states any.
    fn shells_of_mesh(
        &mut self,
        (word, arguments): (&'static Word, &'a [ast::Argument]),
        span: Span,
        scope: ScopeId,
    ) -> Eval<Option<ShellSurfaces>> {
        let is_empty_list = |list: &ast::Expr| matches!(&list.kind, ExprKind::List { items, .. } if items.is_empty());
        let groups = argument(word, arguments, "shells").filter(|list| !is_empty_list(list));
        let stated = argument(word, arguments, "shells").is_some();
        let thickness = argument(word, arguments, "thickness");
        let missing = match (groups, thickness) {
            (None, None) if !stated => return Ok(None),
            (Some(_), None) => "the thickness is missing",
            (None, _) => "the groups are missing",
            (Some(groups), Some(stated)) => {
                let groups = self.texts(Some(groups), scope)?;
                let thickness = self.structural_number(stated, scope)?;
                if thickness > 0.0 && thickness.is_finite() {
                    return Ok(Some(ShellSurfaces { groups, thickness }));
                }
                return Err(self.report(
                    Diagnostic::error(
                        codes::FLEXIBLE_NUMBER,
                        format!("`thickness` of `{}` must be positive", word.word),
                    )
                    .at(
                        stated.span,
                        format!("this is {} mm", short(1e3 * thickness, 4)),
                    ),
                ));
            }
        };
        Err(self.report(
            Diagnostic::error(
                codes::FLEXIBLE,
                "shells of a mesh have groups and a thickness",
            )
            .at(span, missing)
            .with_help("write both: `shells: [\"COVER\"], thickness: 3 mm`"),
        ))
    }

    /// A matrix of a file, by a word of [`Place::Matrix`] or [`Place::Recovery`].
    pub(super) fn matrix_source(
        &mut self,
        place: Place,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<MatrixSource> {
        let (word, arguments) = self.worded(place, value)?;
        let file = self.text_of(argument(word, arguments, "file"), scope)?;
        let file = self.checked(file, value.span, "a matrix without a file")?;
        let format = MatrixFormat::named(word.word);
        let format = self.checked(format, value.span, "no format of a matrix")?;
        Ok(MatrixSource {
            format,
            file,
            matrix: self.text_of(argument(word, arguments, "matrix"), scope)?,
            freedoms: self.text_of(argument(word, arguments, "freedoms"), scope)?,
            per_node: match argument(word, arguments, "per_node") {
                Some(expr) => Some(self.freedoms_of_node(expr, scope)?),
                None => None,
            },
            at: location(value.span),
        })
    }

    /// The matrix that recovers nodes, with these nodes.
    pub(super) fn recovery_source(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<RecoverySource> {
        let matrix = self.matrix_source(Place::Recovery, value, scope)?;
        let (word, arguments) = self.worded(Place::Recovery, value)?;
        if matrix.freedoms.is_some() && matrix.per_node.is_some() {
            return Err(self.report(
                Diagnostic::error(
                    codes::FLEXIBLE_MATRICES,
                    "`freedoms` and `per_node` both state the freedoms of the rows",
                )
                .at(value.span, "of this matrix")
                .with_help("leave one out"),
            ));
        }
        let stated = argument(word, arguments, "nodes");
        let stated = self.checked(stated, value.span, "a recovery without nodes")?;
        let MeshSource::File(nodes) = self.mesh_source(stated, scope)? else {
            return Err(self.report(
                Diagnostic::error(
                    codes::FLEXIBLE,
                    "the nodes of a recovery are those of another code",
                )
                .at(stated.span, "stacked sections have nodes of their own")
                .with_help(
                    "name the file of the nodes, such as `csv(\"inner.csv\", units: mm_tonne_s)`",
                ),
            ));
        };
        let tolerance = match argument(word, arguments, "tolerance") {
            Some(expr) => {
                let tolerance = self.structural_number(expr, scope)?;
                if !(tolerance > 0.0 && tolerance.is_finite()) {
                    return Err(self.report(
                        Diagnostic::error(
                            codes::FLEXIBLE_NUMBER,
                            format!("`tolerance` of `{}` must be positive", word.word),
                        )
                        .at(expr.span, format!("this is {}", short(tolerance, 4))),
                    ));
                }
                tolerance
            }
            None => RIGID_MOTION,
        };
        Ok(RecoverySource {
            matrix,
            nodes,
            tolerance,
        })
    }

    /// The number of freedoms of each node, 3 or 6.
    fn freedoms_of_node(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<u8> {
        match self.integer(expr, scope)? {
            3 => Ok(3),
            6 => Ok(6),
            other => Err(self.report(
                Diagnostic::error(codes::FLEXIBLE_NUMBER, "a node has 3 or 6 freedoms")
                    .at(expr.span, format!("this is {other}"))
                    .with_help("3 where the rows are translations alone, 6 with rotations"),
            )),
        }
    }

    /// The message about contradictory statements on the rows of stiffness and mass.
    pub(super) fn rows_of_matrices(
        &mut self,
        stiffness: &MatrixSource,
        mass: &MatrixSource,
        span: Span,
    ) -> Eval<()> {
        let wrong = |problem: &str, help: &str| {
            Diagnostic::error(codes::FLEXIBLE_MATRICES, problem)
                .at(span, "of this body")
                .with_help(help)
        };
        let listed = stiffness.freedoms.is_some() || mass.freedoms.is_some();
        match (stiffness.per_node, mass.per_node) {
            (Some(a), Some(b)) if a != b => Err(self.report(wrong(
                "`per_node` of stiffness and of mass differ",
                "their rows are the same freedoms: state one of them, or the same number twice",
            ))),
            (Some(_), _) | (_, Some(_)) if listed => Err(self.report(wrong(
                "`freedoms` and `per_node` both state the freedoms of the rows",
                "leave one out",
            ))),
            _ => Ok(()),
        }
    }

    pub(super) fn material_source(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<MaterialSource> {
        let record = self.evaluate(value, scope)?;
        let RecordScope(record) = self.read(record, value.span)?;
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

    pub(super) fn damping(&mut self, value: &'a ast::Expr, scope: ScopeId) -> Eval<Damping> {
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
            let ratio = self.structural_number(value, scope)?;
            return Ok(Damping::Modal {
                ratio: not_negative(self, ratio, "the damping ratio")?,
                up_to: f64::INFINITY,
            });
        };
        let (_, arguments) = self.worded(Place::Damping, value)?;
        let mut number = |name: &str| -> Eval<f64> {
            match argument(word, arguments, name) {
                Some(expr) => self.structural_number(expr, scope),
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

    /// Warns of a damping of all modes that no metal part has.
    pub(super) fn much_damping(&mut self, damping: &Damping, path: &str, span: Span) {
        let Damping::Modal { ratio, up_to } = damping else {
            return;
        };
        let whole = up_to.is_infinite() && *ratio > MUCH_DAMPING;
        if !(whole || *ratio > 1.0) || self.accepts(eng_system::lint::DAMPING, path) {
            return;
        }
        self.diagnostics.push(
            Diagnostic::warning(
                codes::MUCH_DAMPING,
                format!("{path}: a damping of {} % of critical in its modes is more than that of any structure", 100.0 * ratio),
            )
            .at(span, format!("{path}: {} %", 100.0 * ratio))
            .with_help("a part of metal has 0.1 to 3 %: write `2 %`; modes that no step resolves are damped by `modal(2 %, up_to: 4000 Hz)`")
            .acceptable(eng_system::lint::DAMPING),
        );
    }
}
