//! `bode`: amplitude and phase of frequency responses.

use super::argument::place;
use super::{Figure, FigureRow, Given, Kind, Picture, Signals, Takes, Unplanned};
use crate::expression::{Expression, Member};
use crate::recorded::PHASE;

/// Amplitudes and phases over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Bode {
    /// The amplitudes: columns of `response` analyses.
    pub members: Vec<Member>,
    /// The phase of each.
    pub phases: Vec<Expression>,
}

pub(super) const ROW: FigureRow = FigureRow {
    name: "bode",
    about: "amplitude and phase of frequency responses",
    arguments: &[place(
        "x",
        Takes::Responses,
        "outputs of `response` analyses",
    )],
    plan,
};

impl Bode {
    /// The figure of amplitudes, each a recorded column.
    pub fn of(members: Vec<Member>) -> Bode {
        let phase = |member: &Member| match &member.expression {
            Expression::Channel { analysis, path } => Expression::Channel {
                analysis: analysis.clone(),
                path: format!("{path}{PHASE}"),
            },
            other => other.clone(),
        };
        Bode {
            phases: members.iter().map(phase).collect(),
            members,
        }
    }
}

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let of = given.signals("x")?;
    let bode = Bode::of(of.members.clone());
    Ok(Figure::of(&of.shown, Picture::Bode(bode)))
}

impl Kind for Bode {
    fn expressions(&self) -> Vec<&Expression> {
        let mut all = Signals::expressions(&self.members);
        all.extend(&self.phases);
        all
    }
}
