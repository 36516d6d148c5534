//! `order_track`: orders over speed.

use super::argument::{option, place};
use super::spectrum::{OVERLAP, WINDOW, overlap, window};
use super::{Figure, FigureRow, Given, Kind, Picture, Signals, Takes, Unplanned};
use crate::expression::{Expression, Member, Window};
use std::f64::consts::TAU;

/// Orders over speed.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderTrack {
    /// The signals, one of each run; or one alone over changing speed.
    pub members: Vec<Member>,
    /// The orders.
    pub orders: Vec<f64>,
    /// Weight of a block.
    pub window: Window,
    /// For one run whose speed changes: revolutions of a block, and overlap of blocks.
    pub block: Option<(f64, f64)>,
}

pub(super) const ROW: FigureRow = FigureRow {
    name: "order_track",
    about: "amplitudes of orders over speed, of several runs or along one",
    arguments: &[
        place(
            "signals",
            Takes::AmplitudesOfRunsOr("block"),
            "one signal of several runs; with `block` of one run whose speed changes",
        ),
        place("orders", Takes::Orders, "the orders"),
        WINDOW,
        option(
            "block",
            Takes::Turn,
            "the angle of a block along a run whose speed changes",
        ),
        OVERLAP,
    ],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let of = given.signals("signals")?;
    Ok(Figure::of(
        &of.shown,
        Picture::OrderTrack(OrderTrack {
            members: of.members.clone(),
            orders: given
                .numbers("orders")
                .ok_or(Unplanned::Absent("orders"))?
                .to_vec(),
            window: window(given, of),
            block: given
                .number("block")
                .map(|angle| (angle / TAU, overlap(given))),
        }),
    ))
}

impl Kind for OrderTrack {
    fn expressions(&self) -> Vec<&Expression> {
        Signals::expressions(&self.members)
    }
}
