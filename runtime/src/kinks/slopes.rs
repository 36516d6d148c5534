//! Slopes of kink functions over places: how much such a function changes when a body moves by a metre.
//!
//! A condition such as `sin(place/(1 mm)) > 0.9` or `stiffness*depth > preload` changes its sign at a place, and this place must be as
//! exact as that of a condition on a length. The slope turns the limit of a length into one of the function. The rate of such a function
//! is linear in the twists of its markers, so its rates at unit twists are the slopes.

use super::Kinks;
use super::crossing::same_side;
use crate::dynamics::Dynamics;
use crate::elements;
use crate::error::RuntimeError;
use crate::model::Model;
use eng_system::code::{Function, Pair};
use eng_system::layout::VELOCITY;
use std::ops::Range;

/// Index of a marker's twist among its inputs, and the number of its components along axes and about them.
const TWIST: u32 = VELOCITY;
const COMPONENTS: u32 = 6;
const ALONG: u32 = 3;

/// Share of its largest value from which on the limit of a function matters, so that its slope is computed. A
/// choice far above the limits, 1e-5 of the value or less, so that a function does not come from outside of
/// this share to its kink within a step unnoticed.
const NEAR: f64 = 1e-2;

/// A kink function of places that is no length.
#[derive(Clone, Debug)]
pub(super) struct Sloped {
    /// The pair of elements among those of its batch, the lane, and the index of the function in the class.
    place: [usize; 3],
    /// Its items.
    items: Range<usize>,
    /// Rate without twists, and squares of the slopes along and about the axes of a marker.
    still: f64,
    squares: [f64; 2],
    slope: f64,
}

impl Sloped {
    /// A function whose slope is not known yet.
    pub fn new(place: [usize; 3], items: Range<usize>) -> Sloped {
        Sloped {
            place,
            items,
            still: 0.0,
            squares: [0.0; 2],
            slope: 0.0,
        }
    }
}

impl Kinks {
    /// Computes the slopes (1/m, times the unit of the function) of a group at the state at which its functions were evaluated. A turn by
    /// one over the model's length counts as a metre. A function far from its kink keeps its slope at the
    /// last accepted state.
    pub(super) fn measure_slopes(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        group: usize,
    ) -> Result<(), RuntimeError> {
        let group = &self.groups[group];
        let batch = group.batch(dynamics);
        let class = &model.compiled.system.classes[batch.class];
        let out = &mut self.out[..class.kink_outputs()];
        let inputs = &mut self.inputs;
        let rates = |inputs: &[Pair], out: &mut [Pair]| {
            elements::call(model, batch.class, Function::Kinks, inputs, out)
        };
        let rate = |sloped: &Sloped, out: &[Pair]| {
            let [_, lane, kink] = sloped.place;
            out[class.kinks.len() + kink][lane]
        };
        let twist = |marker: u32, k: u32| (class.layout.marker(marker) + TWIST + k) as usize;
        let h = self.times[1] - self.times[0];
        let is_near = |item: usize| {
            let (from, to) = (self.now[item], self.next[item]);
            !same_side(from, to, h) || to[0].abs() <= NEAR * self.peaks[item]
        };
        let sloped = &mut self.sloped[group.sloped.clone()];
        for members in sloped.chunk_by_mut(|a, b| a.place[0] == b.place[0]) {
            if !members.iter().any(|s| s.items.clone().any(is_near)) {
                let [known, next] = &mut self.slopes;
                for items in members.iter().map(|sloped| sloped.items.clone()) {
                    next[items.clone()].copy_from_slice(&known[items]);
                }
                continue;
            }
            inputs.clear();
            inputs.extend_from_slice(batch.inputs(members[0].place[0]));
            for marker in 0..class.layout.markers {
                inputs[twist(marker, 0)..twist(marker, COMPONENTS)].fill([0.0; 2]);
            }
            rates(inputs, out)?;
            for sloped in members.iter_mut() {
                (sloped.still, sloped.slope) = (rate(sloped, out), 0.0);
            }
            for marker in 0..class.layout.markers {
                for k in 0..COMPONENTS {
                    inputs[twist(marker, k)] = [1.0; 2];
                    rates(inputs, out)?;
                    inputs[twist(marker, k)] = [0.0; 2];
                    for sloped in members.iter_mut() {
                        let change = rate(sloped, out) - sloped.still;
                        sloped.squares[usize::from(k >= ALONG)] += change * change;
                    }
                }
                for sloped in members.iter_mut() {
                    let [along, about] = std::mem::take(&mut sloped.squares).map(libm::sqrt);
                    sloped.slope = sloped.slope.max(along).max(about / model.length);
                }
            }
            for sloped in members {
                // an infinite slope, such as that of a root at zero, would allow any depth; that at the other end of the step serves
                let slope = Some(sloped.slope).filter(|slope| slope.is_finite());
                self.slopes[1][sloped.items.clone()].fill(slope.unwrap_or(0.0));
            }
        }
        Ok(())
    }
}
