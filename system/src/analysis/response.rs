//! `response`: the steady vibration of outputs under a sinusoidal input, over frequency.

use super::argument::{POSITIVE, RHO, START, STEP, TOLERANCE, argument, limit};
use super::linear::state;
use super::{
    AnalysisKind, Argument, Counted, Given, Integration, Kind, KindRow, Linear, Named, Names, Rows,
    StepControl, Takes, Unplanned,
};

/// Points of a decade of frequency without `points`. A choice: 2.3 % from one to the next; resonances have
/// points of their own.
const PLAIN_POINTS: u32 = 100;

/// Most points of a response: nothing can stop their computation. A choice: a thousand decades of the plain
/// number of points, far more than any plot can show.
const MOST_POINTS: f64 = 1e5;

/// Amplitudes and phases of outputs per unit of an input, over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// The linearisation, with the input and the outputs as those of its matrices.
    pub about: Linear,
    /// Lowest and highest frequency (Hz).
    pub range: [f64; 2],
    /// Points of a decade, besides those at the resonances.
    pub points: u32,
}

pub(super) const ROW: KindRow = KindRow {
    name: "response",
    about: "amplitude and phase of outputs under a sinusoidal input, over frequency",
    also_called: &["frequency_response", "frf", "transfer", "bode"],
    needs_cycle: None,
    arguments: &[
        STEP,
        TOLERANCE,
        RHO,
        Argument {
            required: true,
            ..argument(
                "to",
                Takes::Names(Names::Inputs),
                "",
                &[],
                "the input of the model that vibrates",
            )
        },
        Argument {
            required: true,
            ..argument(
                "of",
                Takes::Names(Names::Channels),
                "",
                &[],
                "the outputs: channels of the model and of its elements",
            )
        },
        Argument {
            required: true,
            ..argument(
                "from",
                Takes::Frequency,
                "Hz",
                POSITIVE,
                "the lowest frequency",
            )
        },
        Argument {
            required: true,
            ..argument(
                "up_to",
                Takes::Frequency,
                "Hz",
                POSITIVE,
                "the highest frequency",
            )
        },
        argument(
            "points",
            Takes::Count,
            "",
            &[limit(
                // a choice: a step of 0.02 % in frequency, finer than any curve can show
                |x| (1.0..=1e4).contains(&x),
                "at least 1 and at most 10000; 100 is the default",
            )],
            "the points of a decade, 100 by default; each resonance has points of its own",
        ),
        argument(
            "frozen",
            Takes::Switch,
            "",
            &[],
            "whether coefficients that change keep their values of the moment",
        ),
        argument(
            "after",
            Takes::Extent(Counted::ByCycle),
            "s",
            POSITIVE,
            "the duration of a transient that leads to the state; without it, the state is the start",
        ),
        START,
    ],
    apart: &[],
    plan,
};

fn plan(given: &Given) -> Result<AnalysisKind, Unplanned> {
    let stated = |name: &'static str| given.number(name).ok_or(Unplanned::Absent(name));
    let named = |name: &'static str| given.names(name).ok_or(Unplanned::Absent(name));
    let range = [stated("from")?, stated("up_to")?];
    if range[0] >= range[1] {
        return Err(Unplanned::Refused {
            argument: "up_to",
            title: "`up_to` must be above `from`",
            label: "not above the lowest frequency",
            help: "write for instance `from: 10 Hz, up_to: 2 kHz`",
        });
    }
    // within its limits
    let points = given
        .number("points")
        .map_or(PLAIN_POINTS, |points| points as u32);
    let decades = libm::log10(range[1] / range[0]);
    if decades * f64::from(points) > MOST_POINTS {
        return Err(Unplanned::Refused {
            argument: "up_to",
            title: "a response has at most 100000 points",
            label: "too many decades above `from` for this number of points",
            help: "state a narrower range, or fewer `points`",
        });
    }
    let inputs = named("to")?;
    if inputs.len() != 1 || inputs.iter().any(|input| input.path.contains("[*]")) {
        return Err(Unplanned::Refused {
            argument: "to",
            title: "`to` is one input",
            label: "several inputs",
            help: "make an analysis for each input",
        });
    }
    Ok(AnalysisKind::Response(Response {
        about: Linear {
            inputs,
            outputs: named("of")?,
            ..state(given)
        },
        range,
        points,
    }))
}

impl Kind for Response {
    fn step(&self) -> Option<StepControl> {
        self.about.step()
    }

    fn integration(&self) -> Option<&Integration> {
        self.about.integration()
    }

    fn integration_mut(&mut self) -> Option<&mut Integration> {
        self.about.integration_mut()
    }

    fn rows(&self) -> Rows {
        Rows::Frequencies
    }

    fn named(&self) -> Vec<(&'static str, Names, &[Named])> {
        vec![
            ("to", Names::Inputs, &self.about.inputs),
            ("of", Names::Channels, &self.about.outputs),
        ]
    }
}
