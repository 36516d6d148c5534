//! What a run records of a system: the columns of its results, in order.

use crate::system::System;
use crate::{Dimension, DisplayUnit};
use std::f64::consts::PI;

/// Path of the column of time.
pub const TIME: &str = "time";
/// Path of the column of the unwrapped cycle angle.
pub const CYCLE_ANGLE: &str = "cycle.angle";
/// Path of the column of the cycle angle's rate.
pub const CYCLE_SPEED: &str = "cycle.speed";
/// Paths of the energy audit's columns.
pub const ENERGY: [&str; 7] = [
    "energy.kinetic",
    "energy.gravity",
    "energy.strain",
    "energy.damping",
    "energy.work_of_loads",
    "energy.work_of_drives",
    "energy.imbalance",
];

/// A column of results without its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// `main[5].force.x`.
    pub path: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// How it is shown.
    pub display: DisplayUnit,
    /// The axes that a component is along, as a path; empty for a scalar.
    pub frame: String,
}

impl Recorded {
    fn scalar(path: &str, dimension: Dimension, symbol: &str, scale: f64) -> Recorded {
        Recorded {
            path: path.to_owned(),
            dimension,
            display: DisplayUnit {
                symbol: symbol.to_owned(),
                scale,
                offset: 0.0,
            },
            frame: String::new(),
        }
    }
}

/// Time, the cycle's angle and speed where there is a cycle, all channels in the order of the text, the energy audit.
pub fn recorded(system: &System) -> Vec<Recorded> {
    let mut columns = vec![Recorded::scalar(TIME, Dimension::TIME, "s", 1.0)];
    if system.cycle.is_some() {
        let speed = Dimension::ANGLE.over(Dimension::TIME);
        columns.push(Recorded::scalar(
            CYCLE_ANGLE,
            Dimension::ANGLE,
            "deg",
            PI / 180.0,
        ));
        columns.push(Recorded::scalar(CYCLE_SPEED, speed, "rpm", PI / 30.0));
    }
    columns.extend(system.channels.iter().map(|channel| Recorded {
        path: channel.path.clone(),
        dimension: channel.dimension,
        display: channel.display.clone(),
        frame: channel.frame.clone(),
    }));
    let speed = Dimension::LENGTH.over(Dimension::TIME);
    let energy = Dimension::MASS.times(speed).times(speed);
    columns.extend(ENERGY.map(|path| Recorded::scalar(path, energy, "J", 1.0)));
    columns
}

/// Paths of all columns that no channel gives, of a model with or without a cycle.
pub fn of_every_run(cycle: bool) -> impl Iterator<Item = &'static str> {
    let counted = [CYCLE_ANGLE, CYCLE_SPEED]
        .into_iter()
        .filter(move |_| cycle);
    std::iter::once(TIME).chain(counted).chain(ENERGY)
}
