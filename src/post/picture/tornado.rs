//! Changes of a value by parameters.

use super::Drawer;
use crate::post::PostError;
use crate::results::display_unit;
use eng_report::figure::{Figure, Tornado, TornadoBar};
use eng_system::expression::Member;
use eng_system::figure as plan;

impl Drawer<'_> {
    pub(super) fn tornado(&self, tornado: &plan::Tornado) -> Result<Figure, PostError> {
        let plan::Tornado { members, change } = tornado;
        let mut bars = Vec::new();
        let mut analyses = Vec::new();
        for member in members {
            let value = self.evaluator.number(&member.expression)?;
            if !value.is_finite() {
                return Err(PostError::NotFinite(member.channel.clone()));
            }
            bars.push(TornadoBar {
                name: member.channel.clone(),
                value: self.display().from_si(value),
            });
            member
                .expression
                .channels(&mut |analysis, _| analyses.push(analysis));
        }
        bars.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
        let about = self.about(&analyses)?;
        let percent = display_unit("%", 0.01);
        let subtitle = match change {
            Some(share) => format!("{about}, {} more of each parameter", percent.text(*share)),
            None => about,
        };
        let all: Vec<&Member> = members.iter().collect();
        Ok(Tornado {
            title: self.title.to_owned(),
            subtitle,
            abscissa: self.ordinate(&all),
            bars,
        }
        .into())
    }
}
