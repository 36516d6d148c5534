//! Signals over other signals.

use super::labels::capital;
use super::{Drawer, degrees, named, pairs, shown};
use crate::post::PostError;
use crate::post::track::distinct_names;
use eng_report::figure::{Figure, Ordinate, Xy, XyCurve};
use eng_report::readable_unit;
use eng_system::expression::Member;
use eng_system::figure as plan;

impl Drawer<'_> {
    pub(super) fn xy(&self, xy: &plan::Xy) -> Result<Figure, PostError> {
        let plan::Xy {
            x,
            shown: abscissa,
            y,
            cycles,
        } = xy;
        let all: Vec<&Member> = y.iter().collect();
        let names = named(distinct_names(pairs(y)), y, &self.lettered(&all));
        let mut curves = Vec::new();
        for ((of_x, of_y), name) in x.iter().zip(y).zip(names) {
            let (x, y) = self.plane(of_x, &of_y.expression, *cycles)?;
            if let Some(detail) = x.samples.differ(&y.samples) {
                return Err(PostError::Samples {
                    first: x.samples.analysis.clone(),
                    second: y.samples.analysis.clone(),
                    detail,
                }
                .of(of_x, &of_y.expression));
            }
            curves.push(XyCurve {
                name,
                x: shown(&x.values, &abscissa.display),
                y: shown(&y.values, self.display()),
                angle: degrees(&y),
            });
        }
        let part = super::plane::part(*cycles);
        let mut filtered: Vec<String> = Vec::new();
        let expressions = || x.iter().chain(y.iter().map(|y| &y.expression));
        for expression in expressions() {
            self.filters(expression, &mut filtered)?;
        }
        let filtered = match filtered.is_empty() {
            true => "not filtered".to_owned(),
            false => filtered.join("; "),
        };
        let mut analyses = Vec::new();
        for expression in expressions() {
            expression.channels(&mut |analysis, _| analyses.push(analysis));
        }
        Ok(Xy {
            title: self.title.to_owned(),
            subtitle: format!("{}{part}, {filtered}", self.about(&analyses)?),
            x: Ordinate {
                quantity: capital(&abscissa.quantity),
                unit: readable_unit(&abscissa.display.symbol),
                frame: self.frame(x),
            },
            y: self.ordinate(&all),
            curves,
        }
        .into())
    }
}
