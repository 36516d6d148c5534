//! Kinks that fixed steps pass.

use super::{Crossing, Kinks, Limit, same_side};
use crate::error::{AccelerationJump, Moment};
use crate::model::Model;
use eng_system::dimension::Dimension;
use eng_system::system::Origin;

/// A kink that a fixed step overlooked.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlooked {
    /// The element, and the place of the expression with the kink.
    pub origin: Box<Origin>,
    /// The expression with the kink as written; empty if no text states it.
    pub text: String,
    /// Its dimension, if the text shows it.
    pub dimension: Option<Dimension>,
    /// When the step ended.
    pub moment: Moment,
    /// The step (s).
    pub step: f64,
    /// The largest distance beyond the kink within the step, and the limit (SI).
    pub depth: f64,
    /// See [`Overlooked::depth`].
    pub limit: f64,
    /// The jump of the acceleration that a constraint requires there.
    pub jump: Option<AccelerationJump>,
    /// Size of the passage in units of its limit.
    pub weight: f64,
}

impl Kinks {
    /// The kink that a fixed step h (s) overlooks most, in multiples of its limit. The step ends at a time (s).
    ///
    /// Steps that the text states do not end at kinks, and most kinks cost them only accuracy. A kink counts in
    /// three cases: its class states the length that matters there, its far side lies wholly within the step, or
    /// the step passes another kink of the element as well. In the third case the part between the kinks, such as
    /// a thin stop, acts in no step.
    pub fn overlooked(&self, model: &Model, h: f64, time: f64) -> Option<Crossing> {
        let pairs = self.now.iter().zip(&self.next).enumerate();
        let found: Vec<Crossing> = pairs
            .filter(|(item, (from, to))| self.counts(*item) && !same_side(**from, **to, h))
            .filter_map(|(item, _)| {
                let limit = self.limit(item, time, 1.0);
                let found = self.crossing(item, h, [limit; 2], 0.0)?;
                Some(Crossing { item, ..found })
            })
            .collect();
        let kink = |passed: &Crossing| {
            let item = &self.items[passed.item];
            (
                item.element,
                &model.class(item.element).kinks[item.kink].dimension,
            )
        };
        // two functions of one dimension whose kinks are farther apart than their limits
        let between = |a: &Crossing, b: &Crossing| {
            let time = (a.time - b.time).abs();
            let apart = |x: &Crossing| {
                let change = self.next[x.item][0] - self.now[x.item][0];
                time / h * change.abs() > x.limit
            };
            kink(a) == kink(b) && apart(a) && apart(b)
        };
        let counts = found.iter().filter(|kink| {
            let stated = matches!(self.items[kink.item].limit, Limit::Stated(_));
            stated || kink.inside || found.iter().any(|other| between(kink, other))
        });
        counts
            .max_by(|a, b| (a.depth / a.limit).total_cmp(&(b.depth / b.limit)))
            .copied()
    }

    /// A kink with its names.
    pub fn named(
        &self,
        model: &Model,
        passed: &Crossing,
        (h, moment): (f64, Moment),
        (weight, jump): (f64, Option<AccelerationJump>),
    ) -> Option<Overlooked> {
        let item = self.items.get(passed.item)?;
        let kink = model.class(item.element).kinks.get(item.kink)?;
        let (origin, text) = self.place(model, passed.item);
        Some(Overlooked {
            origin: Box::new(origin),
            text,
            dimension: match item.limit == Limit::Time {
                true => Some(Dimension::TIME),
                false => kink.dimension,
            },
            moment,
            step: h,
            depth: passed.depth,
            limit: passed.limit,
            jump,
            weight,
        })
    }
}
