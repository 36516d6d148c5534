//! The columns that a run records of a system, in order.

use crate::analysis::{AnalysisKind, Names, Response};
use crate::system::{BodyInertia, Role, System};
use crate::{Dimension, DisplayUnit};
use std::f64::consts::PI;

/// Path of the column of time.
pub const TIME: &str = "time";
/// Path of the column of the unwrapped cycle angle.
pub const CYCLE_ANGLE: &str = "cycle.angle";
/// Path of the column of the cycle angle's rate.
pub const CYCLE_SPEED: &str = "cycle.speed";
/// Path of the column of the torque that a prescribed motion needs.
pub const CYCLE_TORQUE: &str = "cycle.torque";
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

/// Path of the column of a mode's number; the rows of a linear analysis are its modes.
pub const MODE: &str = "mode";
/// Path of the column of the modes' frequencies.
pub const FREQUENCY: &str = "frequency";
/// Path of the column of the modes' damping ratios.
pub const DAMPING_RATIO: &str = "damping_ratio";
/// Path of the column of logarithmic decrements.
pub const LOGARITHMIC_DECREMENT: &str = "logarithmic_decrement";
/// Before the path of a body: its share in the kinetic energy of a mode.
pub const KINETIC: &str = "kinetic.";
/// After the path of a flexible body: the share of its motion as a whole.
pub const RIGID: &str = ".rigid";
/// Before the path of a part that stores energy: its share.
pub const POTENTIAL: &str = "potential.";
/// Before the path of a part that loses energy: its share.
pub const LOST: &str = "lost.";
/// After a channel's path: its phase in a mode, or against an input.
pub const PHASE: &str = ".phase";

/// A column of results without its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// `main[5].force.x`.
    pub path: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
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

/// Time, angle and speed of the cycle if there is one, all channels in the order of the text, and the energy
/// audit.
pub fn recorded(system: &System) -> Vec<Recorded> {
    let mut columns = vec![Recorded::scalar(TIME, Dimension::TIME, "s", 1.0)];
    if system.cycle.is_some() {
        columns.push(Recorded::scalar(
            CYCLE_ANGLE,
            Dimension::ANGLE,
            "deg",
            PI / 180.0,
        ));
        columns.push(cycle_speed());
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

/// The channels that a kinematic analysis can record, in the order of the text. Its pins are in the middle of
/// their shells, where a film carries nothing. So of a film it records the force alone, which is the reaction of
/// the pin, and no output that reads a film.
pub fn channels_of_motion(system: &System) -> Vec<usize> {
    let mut channels_of = vec![Vec::new(); system.elements.len()];
    for (index, channel) in system.channels.iter().enumerate() {
        if let Some(own) = channels_of.get_mut(channel.element as usize) {
            own.push(index);
        }
    }
    let is_film = |element: usize| {
        let places = &system.elements[element].places;
        places.iter().any(|place| place.height.is_none())
    };
    let mut left_out: Vec<bool> = (0..system.elements.len()).map(is_film).collect();
    // outputs that read left-out ones, until no further one is found
    loop {
        let reads = |element: &usize| {
            let mut signals = system.elements[*element].signals.iter();
            signals.any(|signal| {
                let source = system.channels.get(*signal as usize);
                source.is_some_and(|source| left_out[source.element as usize])
            })
        };
        let more: Vec<usize> = (0..left_out.len())
            .filter(|element| !left_out[*element])
            .filter(reads)
            .collect();
        if more.is_empty() {
            break;
        }
        more.into_iter()
            .for_each(|element| left_out[element] = true);
    }
    let force = |channel: usize| {
        let channel = channel as u32;
        let mut journals = system.journals.iter();
        journals.any(|journal| channel == journal.force || channel == journal.force + 1)
    };
    let mut kept: Vec<usize> = (0..system.elements.len())
        .flat_map(|element| channels_of[element].iter().copied())
        .filter(|channel| !left_out[system.channels[*channel].element as usize] || force(*channel))
        .collect();
    kept.sort_unstable();
    kept
}

/// The columns of a kinematic analysis: time, angle and speed of the cycle and the torque that turns it, if there
/// is a cycle, and the channels of [`channels_of_motion`].
pub fn of_motion(system: &System) -> Vec<Recorded> {
    let all = recorded(system);
    let first = all.len() - system.channels.len() - ENERGY.len();
    let mut columns = all[..first].to_vec();
    if system.cycle.is_some() {
        let speed = Dimension::LENGTH.over(Dimension::TIME);
        let torque = Dimension::MASS.times(speed).times(speed);
        columns.push(Recorded::scalar(CYCLE_TORQUE, torque, "N*m", 1.0));
    }
    let channels = channels_of_motion(system).into_iter();
    columns.extend(channels.map(|channel| all[first + channel].clone()));
    columns
}

/// The columns of a linear analysis, in which each row is a mode: number, frequencies, damping, growth, the
/// speed of the cycle if there is one, shares of bodies in the kinetic energy, shares of flexible bodies and
/// loads in the stored and lost energy, amplitude and phase of every channel. The shares of the single modes
/// of a flexible body are missing, because only its reduction knows their number.
pub fn of_modes(system: &System) -> Vec<Recorded> {
    let per_time = Dimension::ONE.over(Dimension::TIME);
    let share = |path: String| Recorded::scalar(&path, Dimension::ONE, "%", 0.01);
    let mut columns = vec![
        Recorded::scalar(MODE, Dimension::ONE, "1", 1.0),
        Recorded::scalar(FREQUENCY, per_time, "Hz", 1.0),
        Recorded::scalar("undamped_frequency", per_time, "Hz", 1.0),
        Recorded::scalar(DAMPING_RATIO, Dimension::ONE, "%", 0.01),
        Recorded::scalar(LOGARITHMIC_DECREMENT, Dimension::ONE, "1", 1.0),
        Recorded::scalar("growth", per_time, "1/s", 1.0),
    ];
    if system.cycle.is_some() {
        columns.push(cycle_speed());
    }
    let mut stores: Vec<&str> = Vec::new();
    for body in &system.bodies {
        let path = body.origin.path.as_str();
        columns.push(share(format!("{KINETIC}{path}")));
        if let BodyInertia::Flexible(_) = body.inertia {
            columns.push(share(format!("{KINETIC}{path}{RIGID}")));
            stores.push(path);
        }
    }
    stores.extend(
        system
            .elements
            .iter()
            .filter(|element| {
                let class = system.classes.get(element.class as usize);
                element.role == Role::Dynamic && class.is_some_and(|class| class.facts.applies_load)
            })
            .map(|element| element.origin.path.as_str()),
    );
    for kind in [POTENTIAL, LOST] {
        columns.extend(stores.iter().map(|path| share(format!("{kind}{path}"))));
    }
    for channel in &system.channels {
        columns.push(Recorded {
            path: channel.path.clone(),
            dimension: channel.dimension,
            // an amplitude has no shifted zero
            display: DisplayUnit {
                offset: 0.0,
                ..channel.display.clone()
            },
            frame: channel.frame.clone(),
        });
        columns.push(phase_of(&channel.path));
    }
    columns
}

/// The columns of an analysis whose kind has columns of its own for each sample or frequency. None of a response
/// whose input or outputs have a mistake.
pub fn of_kind(system: &System, kind: &AnalysisKind) -> Option<Vec<Recorded>> {
    match kind {
        AnalysisKind::Response(response) => Some(of_response(system, response).unwrap_or_default()),
        AnalysisKind::Kinematic(_) => Some(of_motion(system)),
        _ => None,
    }
}

/// The columns of a frequency response, in which each row is a frequency: the frequency, amplitude per unit of
/// the input and phase of each output. `None` if the input or an output does not exist.
pub fn of_response(system: &System, response: &Response) -> Option<Vec<Recorded>> {
    let [inputs, outputs] = [
        (Names::Inputs, &response.about.inputs),
        (Names::Channels, &response.about.outputs),
    ]
    .map(|(names, stated)| names.indices(stated, &system.paths_of(names)).ok());
    let input = system.inputs.get(*inputs?.first()?)?;
    let input = system.parameters.get(input.parameter as usize)?;
    let per_time = Dimension::ONE.over(Dimension::TIME);
    let mut columns = vec![Recorded::scalar(FREQUENCY, per_time, "Hz", 1.0)];
    for output in outputs? {
        let channel = system.channels.get(output)?;
        columns.push(Recorded {
            path: channel.path.clone(),
            dimension: channel.dimension.over(input.dimension),
            display: channel.display.over(&input.display),
            frame: channel.frame.clone(),
        });
        columns.push(phase_of(&channel.path));
    }
    Some(columns)
}

/// The column of a channel's phase.
fn phase_of(path: &str) -> Recorded {
    let path = format!("{path}{PHASE}");
    Recorded::scalar(&path, Dimension::ANGLE, "deg", PI / 180.0)
}

fn cycle_speed() -> Recorded {
    let speed = Dimension::ANGLE.over(Dimension::TIME);
    Recorded::scalar(CYCLE_SPEED, speed, "rpm", PI / 30.0)
}

/// Paths of all columns that do not come from a channel, for a model with or without a cycle.
pub fn of_every_run(cycle: bool) -> impl Iterator<Item = &'static str> {
    let counted = [CYCLE_ANGLE, CYCLE_SPEED]
        .into_iter()
        .filter(move |_| cycle);
    std::iter::once(TIME).chain(counted).chain(ENERGY)
}
