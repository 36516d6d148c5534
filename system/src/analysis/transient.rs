//! `transient`: the motion in time.

use super::argument::{
    GRADIENTS, INTEGRATOR, PLAIN_ANGLE, PLAIN_SAMPLES, POSITIVE, RHO, START, STEP, TOLERANCE,
    argument, too_many_samples,
};
use super::{
    AnalysisKind, Apart, Argument, Counted, Extent, Given, Integration, Kind, KindRow, Method,
    Named, Names, Rows, Start, Takes, Unplanned,
};

/// The argument with the condition that ends a run.
pub const STOP: &str = "stop";

/// A transient analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct Transient {
    /// Its duration.
    pub duration: Extent,
    /// Distance of the samples.
    pub sample: Extent,
    /// Settings of its integration.
    pub integration: Integration,
    /// Parameters by which the channels are differentiated.
    pub gradients: Vec<Named>,
    /// The condition that ends it early, as written.
    pub stop: Option<String>,
}

pub(super) const ROW: KindRow = KindRow {
    name: "transient",
    about: "the motion in time",
    also_called: &[],
    needs_cycle: None,
    arguments: &[
        STEP,
        TOLERANCE,
        INTEGRATOR,
        RHO,
        Argument {
            required: true,
            ..argument(
                "duration",
                Takes::Extent(Counted::ByCycle),
                "s",
                POSITIVE,
                "the duration of the run, a time or an angle of the cycle",
            )
        },
        argument(
            "sample",
            Takes::Extent(Counted::ByCycle),
            "ms",
            POSITIVE,
            "the sampling interval; by default 0.5° of an angle, a thousandth of a time",
        ),
        GRADIENTS,
        argument(
            STOP,
            Takes::Condition,
            "",
            &[],
            "a condition on the motion that ends the run early, at the moment at which it begins to hold",
        ),
        START,
    ],
    apart: &[Apart {
        first: (STOP, "its moment depends on the parameters"),
        second: ("gradients", "derivatives at fixed times"),
        title: "a run with `gradients` has no `stop`",
        help: "leave `stop` out, and state the `duration`",
    }],
    plan,
};

fn plan(given: &Given) -> Result<AnalysisKind, Unplanned> {
    let duration = given.extent("duration");
    let duration = duration.ok_or(Unplanned::Absent("duration"))?;
    let sample = match (given.extent("sample"), duration) {
        (Some(sample), _) => sample,
        (None, Extent::Time(whole)) => Extent::Time(whole / PLAIN_SAMPLES),
        (None, Extent::Angle(_)) => Extent::Angle(PLAIN_ANGLE),
    };
    if given.extent("sample").is_some() && too_many_samples(duration, sample) {
        return Err(Unplanned::Refused {
            argument: "sample",
            title: "`sample` must be at least a ten-millionth of `duration`",
            label: "more samples than memory holds",
            help: "sample more coarsely, or run for a shorter time",
        });
    }
    let integration = given.integration(Start::Automatic);
    let gradients = given.names("gradients").unwrap_or_default();
    if integration.method == Method::Radau {
        only_with_alpha(given, &gradients)?;
    }
    Ok(AnalysisKind::Transient(Transient {
        duration,
        sample,
        integration,
        gradients,
        stop: given.condition(STOP),
    }))
}

/// Refuses arguments that Radau IIA does not take.
fn only_with_alpha(given: &Given, gradients: &[Named]) -> Result<(), Unplanned> {
    let refuse = |argument, title, label, help| {
        Err(Unplanned::Refused {
            argument,
            title,
            label,
            help,
        })
    };
    if given.number(STEP.name).is_some() {
        return refuse(
            STEP.name,
            "`integrator: radau` chooses its steps by their error",
            "a fixed step",
            "leave `step` out, and state a `tolerance`",
        );
    }
    if given.number(RHO.name).is_some() {
        return refuse(
            RHO.name,
            "`integrator: radau` has no spectral radius",
            "a coefficient of generalised-α",
            "leave `rho` out",
        );
    }
    if !gradients.is_empty() {
        return refuse(
            "gradients",
            "`gradients` follow the steps of generalised-α alone",
            "not with `integrator: radau`",
            "leave `integrator` out for this analysis",
        );
    }
    Ok(())
}

impl Kind for Transient {
    fn integration(&self) -> Option<&Integration> {
        Some(&self.integration)
    }

    fn integration_mut(&mut self) -> Option<&mut Integration> {
        Some(&mut self.integration)
    }

    fn sampling(&self) -> Option<(Extent, Option<Extent>)> {
        Some((self.sample, Some(self.duration)))
    }

    fn named(&self) -> Vec<(&'static str, Names, &[Named])> {
        vec![("gradients", Names::Parameters, &self.gradients)]
    }

    fn gradients(&self) -> Option<&[Named]> {
        Some(&self.gradients)
    }

    fn gradients_mut(&mut self) -> Option<&mut Vec<Named>> {
        Some(&mut self.gradients)
    }

    fn rows(&self) -> Rows {
        Rows::Samples
    }
}
