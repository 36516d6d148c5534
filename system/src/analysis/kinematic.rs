//! `kinematic`: the motion that joints, drives and one speed determine, with the reactions that it needs.

use super::argument::{PLAIN_SAMPLES, POSITIVE, argument, too_many_samples};
use super::{AnalysisKind, Counted, Extent, Given, Kind, KindRow, Rows, Takes, Unplanned};
use std::f64::consts::PI;

/// Distance of samples over the cycle angle (rad) without `sample`: one degree. A choice: a motion of
/// geometry alone is smooth over this.
const PLAIN_ANGLE: f64 = PI / 180.0;

/// The prescribed motion of a mechanism, and the reactions by inverse dynamics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematic {
    /// The range; without it one cycle.
    pub over: Option<Extent>,
    /// Distance of the samples.
    pub sample: Extent,
}

pub(super) const ROW: KindRow = KindRow {
    name: "kinematic",
    about: "the motion by joints and drives at the stated speed, with reactions by inverse dynamics",
    also_called: &["kinematics", "inverse_dynamics", "kinetostatic", "dry_turn"],
    needs_cycle: None,
    arguments: &[
        argument(
            "over",
            Takes::Extent(Counted::ByCycle),
            "deg",
            POSITIVE,
            "the range from the start on, an angle of the cycle or a time; one cycle by default",
        ),
        argument(
            "sample",
            Takes::Extent(Counted::ByCycle),
            "deg",
            POSITIVE,
            "the sampling interval; by default 1° of an angle, a thousandth of a time",
        ),
    ],
    apart: &[],
    plan,
};

fn plan(given: &Given) -> Result<AnalysisKind, Unplanned> {
    let over = given.extent("over");
    let sample = match (given.extent("sample"), over) {
        (Some(sample), _) => sample,
        (None, Some(Extent::Time(whole))) => Extent::Time(whole / PLAIN_SAMPLES),
        (None, _) => Extent::Angle(PLAIN_ANGLE),
    };
    let refuse = |title, label, help| {
        Err(Unplanned::Refused {
            argument: "sample",
            title,
            label,
            help,
        })
    };
    match (over, sample) {
        (Some(over), sample) if too_many_samples(over, sample) => refuse(
            "`sample` must be at least a ten-millionth of `over`",
            "more samples than memory holds",
            "sample more coarsely, or over a shorter range",
        ),
        (None, Extent::Time(_))
        | (Some(Extent::Angle(_)), Extent::Time(_))
        | (Some(Extent::Time(_)), Extent::Angle(_)) => refuse(
            "`sample` and `over` are both angles or both times",
            "one is an angle and the other a time",
            "without `over` the range is one cycle, which is an angle",
        ),
        _ => Ok(AnalysisKind::Kinematic(Kinematic { over, sample })),
    }
}

impl Kind for Kinematic {
    fn sampling(&self) -> Option<(Extent, Option<Extent>)> {
        Some((self.sample, self.over))
    }

    fn rows(&self) -> Rows {
        Rows::Samples
    }

    fn is_prescribed(&self) -> bool {
        true
    }
}
