//! `linear`: eigenvalues, damping and modes about a state, and the matrices of small motions under inputs.

use super::argument::{POSITIVE, RHO, START, STEP, TOLERANCE, argument, limit};
use super::{
    AnalysisKind, Apart, Counted, Extent, Given, Integration, Kind, KindRow, Named, Names, Rows,
    Start, StepControl, Takes, Unplanned,
};
use std::f64::consts::TAU;

/// Eigenvalues and modes of the motion linearised about a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Duration of the transient to the state; `None` if the state is the start.
    pub after: Option<Extent>,
    /// Settings of that transient.
    pub integration: Integration,
    /// Most oscillations, and most motions without oscillation, that are reported: the slowest of each.
    pub number: Option<u32>,
    /// Largest |λ| (rad/s) that is reported.
    pub up_to: Option<f64>,
    /// The period of the motion about which the modes are, where coefficients repeat; `None`: about a state.
    pub over: Option<Extent>,
    /// Whether coefficients that change while bodies turn are held at their values of the moment.
    pub frozen: bool,
    /// The inputs u of the matrices A, B, C, D; without them there are no matrices.
    pub inputs: Vec<Named>,
    /// The outputs y of these matrices.
    pub outputs: Vec<Named>,
}

pub(super) const ROW: KindRow = KindRow {
    name: "linear",
    about: "eigenvalues, damping and modes about a state",
    also_called: &["modes", "modal", "eigen", "eigenmodes"],
    needs_cycle: None,
    arguments: &[
        STEP,
        TOLERANCE,
        RHO,
        argument(
            "number",
            Takes::Count,
            "",
            &[limit(
                // a choice: more than any model has states, and still a number that memory holds
                |x| (1.0..=1e5).contains(&x),
                "at least 1 and at most 100000; without it all modes are given",
            )],
            "the number of the slowest oscillations that are kept; all by default",
        ),
        argument(
            "up_to",
            Takes::Frequency,
            "Hz",
            POSITIVE,
            "the highest frequency that is kept; all by default",
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
        argument(
            "over",
            Takes::Extent(Counted::ByFastest),
            "s",
            POSITIVE,
            "the period of a repeating motion; the modes are those about this motion",
        ),
        argument(
            "inputs",
            Takes::Names(Names::Inputs),
            "",
            &[],
            "inputs of the model, for the matrices A, B, C, D of small motions",
        ),
        argument(
            "outputs",
            Takes::Names(Names::Channels),
            "",
            &[],
            "outputs of these matrices: channels of the model and of its elements",
        ),
        START,
    ],
    apart: &[
        Apart {
            first: ("frozen", "for one moment"),
            second: ("over", "for a motion that repeats"),
            title: "modes are those of a period or of a frozen moment, not of both",
            help: "give one of the two, or none where the coefficients are constant",
        },
        Apart {
            first: ("inputs", "constant matrices"),
            second: ("over", "coefficients that repeat"),
            title: "matrices belong to a state, and `over` to a motion",
            help: "leave one of the two out",
        },
    ],
    plan,
};

fn plan(given: &Given) -> Result<AnalysisKind, Unplanned> {
    let [inputs, outputs] = ["inputs", "outputs"].map(|name| given.names(name));
    if inputs.is_some() != outputs.is_some() {
        let argument = if inputs.is_some() {
            "inputs"
        } else {
            "outputs"
        };
        return Err(Unplanned::Refused {
            argument,
            title: "matrices need `inputs` and `outputs`",
            label: "only one of the two lists is stated",
            help: "write `linear(Model(), inputs: [brake], outputs: [speed])`",
        });
    }
    Ok(AnalysisKind::Linear(Linear {
        // within its limits
        number: given.number("number").map(|x| x as u32),
        up_to: given.number("up_to").map(|hertz| TAU * hertz),
        over: given.extent("over"),
        inputs: inputs.unwrap_or_default(),
        outputs: outputs.unwrap_or_default(),
        ..state(given)
    }))
}

/// The linearisation about the stated state, with all modes and without matrices. The state of the start is a
/// balance, unless something else is stated; a transient to a later one begins as others do.
pub(super) fn state(given: &Given) -> Linear {
    let after = given.extent("after");
    let unstated = match after {
        Some(_) => Start::Automatic,
        None => Start::QuasiStatic,
    };
    Linear {
        after,
        integration: given.integration(unstated),
        number: None,
        up_to: None,
        over: None,
        frozen: given.switch("frozen"),
        inputs: Vec::new(),
        outputs: Vec::new(),
    }
}

impl Kind for Linear {
    fn step(&self) -> Option<StepControl> {
        self.after.map(|_| self.integration.step)
    }

    fn integration(&self) -> Option<&Integration> {
        Some(&self.integration)
    }

    fn integration_mut(&mut self) -> Option<&mut Integration> {
        Some(&mut self.integration)
    }

    fn rows(&self) -> Rows {
        Rows::Modes
    }

    fn named(&self) -> Vec<(&'static str, Names, &[Named])> {
        vec![
            ("inputs", Names::Inputs, &self.inputs),
            ("outputs", Names::Channels, &self.outputs),
        ]
    }
}
