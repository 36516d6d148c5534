//! Messages for failures of the runtime, with their places in the text.

use crate::codes;
use crate::counted::counted;
use crate::places::{place, related, span, with_part};
use eng_grammar::Diagnostic;
use eng_runtime::{
    Damped, FAILS, Jump, Jumping, Leaving, NotBack, Overlooked, PeriodicSummary, RuntimeError,
    Slow, StartReport, StepLimit, Turning, Undefined, Unstable,
};
use eng_system::code::BindError;
use eng_system::sentence;
use eng_system::significant::significant;
use eng_system::system::{Location, Origin, Parameter, System};
use eng_system::table::Outside;

mod geometry;
use geometry::{
    MOST_PARAMETERS, contradiction, locked, open_loop, start_velocity, with_markers, wrong_branch,
};
pub(crate) use geometry::{does_not_turn, hanging};

/// The warning of a vibration that the steps damped away, at the line of its analysis.
pub(crate) fn damped(damped: &Damped, analysis: &Origin) -> Diagnostic {
    let body = &damped.body;
    let share = 100.0 * (damped.taken / damped.energy).min(1.0);
    let message = Diagnostic::warning(
        codes::DAMPED_AWAY,
        format!(
            "the steps damp a vibration of {} at about {} Hz: they took {} % of the energy of its motion",
            body.path,
            significant(damped.frequency / std::f64::consts::TAU, 2),
            significant(share, 2)
        ),
    );
    let label = format!(
        "a step of {} s is too long for it",
        significant(damped.step, 2)
    );
    let message = place(message, analysis, &label);
    let message = message.also_if(body.used_at.or(body.defined_at).map(span), "this body");
    message
        .with_note("the amplitude of this vibration and the forces of its stiffness are wrong; motions with periods of many steps are right")
        .with_help("take a smaller `step` or `tolerance`, give that stiffness damping, or begin where its forces are in balance: `start: quasi_static`")
}

/// The warning of a kink that fixed steps pass, at the line of its analysis.
pub(crate) fn overlooked(kink: &Overlooked, analysis: &Origin) -> Diagnostic {
    let shown = |value: f64| eng_runtime::error::gap(value, kink.dimension);
    let of = match kink.text.as_str() {
        "" => String::new(),
        text => format!(" (`{text}`)"),
    };
    let message = Diagnostic::warning(
        codes::OVERLOOKED,
        format!(
            "a step of {} s passes a kink of {}{of} by {} at {}",
            significant(kink.step, 3),
            kink.origin.path,
            shown(kink.depth),
            kink.moment
        ),
    );
    let message = place(
        message,
        analysis,
        "its steps are fixed, so they do not end at kinks",
    );
    let message = message.also_if(kink.origin.used_at.map(span), "this element");
    let message = message.also_if(
        kink.origin.defined_at.map(span),
        match kink.jump {
            Some(_) => "the acceleration that it demands jumps here",
            None => "its load or rate bends here",
        },
    );
    let note = match &kink.jump {
        Some(jump) => format!(
            "the demanded acceleration jumps by {}: positions in this step are wrong by up to {}, and the force lies between those of both sides",
            jump.size.gap("/s²"),
            jump.error.gap("")
        ),
        None => format!("the depth that matters there is {}", shown(kink.limit)),
    };
    message
        .with_note(note)
        .with_help("leave out `step`: under error control steps end at kinks")
}

/// The message of a failure. It shows the user's line first and the line of the law second.
pub(crate) fn diagnostic(error: &RuntimeError, system: &System) -> Diagnostic {
    use RuntimeError as R;
    let d = |code: &'static str| Diagnostic::error(code, error.to_string());
    match error {
        R::Bind(bind) => bind_diagnostic(bind, system),
        R::Input { origin, .. } => place(d(codes::INPUT), origin, "this input"),
        R::Inputs { moment, cause } => bind_diagnostic(cause, system)
            .with_note(format!("this follows from the values of the inputs at {moment}")),
        R::Body { origin, .. } => place(d(codes::BODY), origin, "this body")
            .with_help("check the unit, the signs of the products, and that the inertia is about the centre of mass"),
        R::OpenLoop { rows, chain } => open_loop(d(codes::OPEN_LOOP), rows, chain.as_deref(), system),
        R::Contradiction { starts } => contradiction(d(codes::OPEN_LOOP), starts, system),
        R::Branch { origin, chain, .. } => {
            wrong_branch(d(codes::WRONG_BRANCH), origin, chain.as_deref(), system)
        }
        R::FarGuess { origin, .. } => place(d(codes::FAR_GUESS), origin, "guessed far away")
            .with_help("check the unit of its `guess position`; `start position` states a place that is far away on purpose"),
        R::StartVelocity { rows, chain } => {
            start_velocity(d(codes::START_VELOCITY), rows, chain.as_deref(), system)
        }
        R::Locked { rows, chain, .. } => locked(d(codes::LOCKED), rows, chain.as_deref(), system),
        R::Redundant { groups } => match groups.first() {
            Some(group) => with_markers(redundant(groups), &group.redundant.origin, system),
            None => redundant(groups),
        },
        R::NotFinite {
            origin,
            because: Some(because),
            ..
        } => match because.as_ref() {
            Undefined::Table(outside) => {
                outside_table(place(d(codes::OUTSIDE_TABLE), origin, "reads the table"), outside)
            }
            Undefined::Field(_) => place(d(codes::NO_FIELD), origin, "this field has no solution"),
        },
        R::Field { origin, .. } => place(d(codes::NO_FIELD), origin, "this field has no solution"),
        R::NotFinite { origin, .. } => place(d(codes::NOT_FINITE), origin, "this element")
            .with_help("keep a divisor from zero, such as by `norm(v, floor: 1 um)`, and a root's argument from below"),
        R::Newton { origin, .. } => place(d(codes::NO_STEP), origin, "the largest residual is here")
            .with_help("a force that jumps, or a mechanism at the end of its reach, has no solution: look at the outputs just before"),
        R::Rounding { .. } => d(codes::ROUNDING)
            .with_help("state a larger `tolerance`, or a fixed `step`, which needs no tolerance"),
        R::Resolution { origin, .. } => place(d(codes::ROUNDING), origin, "resolves this length")
            .with_help("state the length that matters after `resolve`, such as `resolve 1 um`"),
        R::StepTooSmall { origin, state: Some(state), .. } => {
            place(d(codes::STEP_TOO_SMALL), origin, "the largest error is in its state")
                .with_help(format!("make the rate of `{state}` continuous; or state a larger `scale` for `{state}`: the error of a step may be 1e-5 of the scale"))
        }
        R::StepTooSmall { origin, state: None, .. } => {
            place(d(codes::STEP_TOO_SMALL), origin, "the largest error is here")
                .with_help("look at the motion just before: a contact may have lost its partner; make every force that jumps continuous; give an `extrapolation` to a table that ends here")
        }
        R::Jumps { jump, .. } => jumps(d(codes::JUMPS), jump),
        R::Demanded { origin, text, row, velocity, .. } => {
            demanded(d(codes::DEMANDED), (origin, text), &row.equation, *velocity)
        }
        R::Stopped(slow) => paced(d(codes::STOPPED), &slow.limit),
        R::TurnsTooFar { origin, step, degrees, .. } => place(d(codes::OPTIONS), origin, "turns this fast")
            .with_help(format!("state a `step` below {} s, or none: then error control chooses the steps", significant(step * 90.0 / degrees, 2))),
        R::Runaway { origin, .. } => place(d(codes::RUNAWAY), origin, "moves away ever faster")
            .with_help("a force accelerates it: check the signs of the forces on this body and the units of their arguments"),
        // conditions on several dimensions have no common unit
        R::Require { origin, value, dimension, .. } => {
            let message = condition(d(codes::REQUIRED), origin, "this must hold at every step");
            with_part(message, system.part_of(origin)).note_if(
                dimension.map(|one| format!("the condition fails by {}", eng_runtime::error::gap(-value, Some(one)))),
            )
        }
        R::Projection { row, .. } => place(d(codes::PROJECTION), &row.origin, "stays open here")
            .with_help("take a smaller `step`, or a smaller `tolerance`; if this does not help, the mechanism locks here or comes to the end of its reach"),
        R::CycleStands { .. } => {
            let message = d(codes::CYCLE_STANDS);
            let message = message.with_each(&system.cycle, |message, cycle| {
                place(message, &cycle.origin, "this angle is counted")
            });
            message.with_help("such a duration never passes: give it as a time, or start the crank turning; `eng check` warns of an angle that the joints hold (W0765)")
        }
        R::NotRepeating { origin, why, .. } => not_repeating(d(codes::NOT_REPEATING), origin.as_deref(), why),
        R::NoEquilibrium { origin, carried, turning, films, .. } => {
            let message = place(d(codes::NO_EQUILIBRIUM), origin, "the obstacle");
            no_equilibrium(message, *carried, *turning, *films)
        }
        R::NotKinematic { origin, remedy, .. } => {
            let message = d(codes::NOT_KINEMATIC).with_help(*remedy);
            message.with_each(origin.as_deref(), |message, origin| place(message, origin, "the obstacle"))
        }
        R::NoPeriod { .. } => d(codes::NO_PERIOD).with_help("give the period as a time, such as `over: 20 ms`"),
        R::Turning { bodies, .. } => turning(d(codes::TURNING), bodies),
        R::OverTime { elements, .. } => over_time(d(codes::TURNING), elements),
        R::Remembers { origin } => place(d(codes::TURNING), origin, "a film with memory")
            .with_help("a rigid film with the rule `reynolds` has no memory; `transient` and `periodic` compute the other films"),
        R::Undecided { origin, .. } => place(d(codes::TURNING), origin, "a film without pressure")
            .with_help("linearise the film under a load: leave out `start: assembled`, or state a load"),
        R::Kinked { origin, .. } => place(d(codes::KINKED), origin, "is at its kink")
            .with_help("move the state away from the kink, by a load or a play; or round the law there, such as by `positive` of `std.math` in place of `max`"),
        R::JumpsInPeriod { jump, .. } => place(d(codes::KINKED), &jump.origin, "jumps on the way")
            .with_help("round the jump over a short way or a range of low speeds, such as by `tanh(v/(1 mm/s))` in place of the sign of v"),
        R::KinkedOutput { .. } => d(codes::KINKED)
            .with_help("ask for a quantity that is smooth there, such as a component in place of a distance or an absolute value; or move the state away by a load or a play"),
        R::Grows { .. } => d(codes::GROWS)
            .with_help("`linear` about the same state shows the mode; remove its cause, or linearise about another state by `after:`"),
        R::Unsteady { body, .. } => unsteady(d(codes::UNSTEADY), body),
        R::Singular { massless, repeated, .. } => singular(d(codes::SINGULAR), massless, repeated),
        R::StopsAtStart { origin, .. } => stops_at_start(d(codes::OPTIONS), origin),
        R::Options { .. } => d(codes::OPTIONS),
        R::Checkpoint { .. } => d(codes::CHECKPOINT),
        // the checker refuses an angle without a cycle earlier, and the other errors are faults of the
        // compiler or of the run itself
        R::NoCycle | R::Malformed { .. } | R::OutsideStep { .. } | R::Eigenvalues { .. } => d(codes::INTERNAL)
            .with_help("please report this together with the model"),
    }
}

/// The message about accelerations that masses and constraints do not determine.
fn singular(
    message: Diagnostic,
    massless: &[eng_runtime::error::Massless],
    repeated: &[eng_runtime::RedundantGroup],
) -> Diagnostic {
    if !repeated.is_empty() {
        let message = repeated.iter().take(3).fold(message, |message, group| {
            place(
                message,
                &group.redundant.origin,
                "repeats others at this position",
            )
        });
        return message.with_help("at this position the mechanism is stretched, locks, or can continue in two ways: begin a few degrees away, or keep the motion away from it");
    }
    let message = massless.iter().take(3).fold(message, |message, body| {
        place(message, &body.origin, &format!("has no {}", body.lacks))
    });
    message.with_help(
        "give an inertia to every body that can turn, and a mass to every body that can move",
    )
}

/// The message about a condition that ends a run before its first step.
fn stops_at_start(message: Diagnostic, origin: &Origin) -> Diagnostic {
    message
        .at_if(origin.used_at.map(span), "true before the first step")
        .with_help("reverse the comparison, or state another limit. If the motion begins beyond the limit and returns, state two parts, such as `speed > limit and time > 1 s`")
}

/// The message about a motion that does not come back after the period.
fn not_repeating(message: Diagnostic, origin: Option<&Origin>, why: &NotBack) -> Diagnostic {
    let message = message.with_each(origin, |message, origin| {
        place(
            message,
            origin,
            "has the largest deviation after the period",
        )
    });
    message.with_help(match why {
        NotBack::OtherPeriod => "check the period that `over` states (a four-stroke cycle has two turns), and the loads that depend on time. A longer `after:` or a finer `tolerance` begins the search nearer to the steady motion",
        NotBack::TooFar => "the period may be right. Begin nearer to the motion that repeats: leave out `start: assembled`, or let the ringing of the start die out with `after:`; a shorter `step` resolves faster vibrations",
    })
}

/// The message about a constraint that requires a jump at a kink, with the place of the kink and its text.
fn demanded(
    message: Diagnostic,
    (origin, text): (&Origin, &str),
    equation: &str,
    velocity: bool,
) -> Diagnostic {
    let used = Origin {
        defined_at: None,
        ..origin.clone()
    };
    let message = place(message, &used, "demands the jump");
    let label = match text.is_empty() {
        true => "its kink is here",
        false => "it jumps where this changes",
    };
    let message = message.also_if(origin.defined_at.map(span), label);
    let message = message.with_note(format!("the equation is `{equation}`"));
    message.with_help(match velocity {
        true => "a jump of the velocity needs an impulse, which Eng does not model: ramp the speed over some time, such as by `step((time - 1 s)/(10 ms))` of `std.math`, round the corner, or read a table with `interpolation: monotone` whose last two values are equal",
        false => "bodies do not move at once: move them in some time, such as by `step((time - 1 s)/(10 ms))` of `std.math`",
    })
}

/// The message about a missing equilibrium.
fn no_equilibrium(message: Diagnostic, carried: f64, turning: bool, films: bool) -> Diagnostic {
    let found = |carried| {
        let balance = balance_with(carried);
        format!("from the assembled place the search finds {balance}")
    };
    let message = message.note_if((carried > 0.0).then(|| found(carried)));
    match (turning, films) {
        (false, true) => message
            .with_note("a film carries no load while its pin is at rest")
            .with_help("state `turning: true`: then films carry in the motion that the text states; or hold the pins by a joint or a spring"),
        (false, false) => message.with_help(
            "hold the free motion by a joint, a spring or a drive; `at:` with an angle holds the cycle; a `guess` nearer to the equilibrium helps the search",
        ),
        (true, _) => message.with_help(
            "state the speeds by `start` or by drives, and load the model less; a `guess` nearer to the equilibrium helps the search",
        ),
    }
}

/// Adds the bodies whose turning changes the coefficients, each with its reason.
fn turning(message: Diagnostic, bodies: &[eng_runtime::TurningBody]) -> Diagnostic {
    bodies
        .iter()
        .take(3)
        .fold(message, |message, body| {
            place(message, &body.origin, &format!("turns at {} rpm and {}", significant(body.speed*30.0/std::f64::consts::PI, 4), body.reason()))
        })
        .with_help("if the motion repeats, state its period as an angle or a time: `over: 1 rev` gives its modes. Otherwise `frozen: true` holds the coefficients at this moment: frequencies well above the speed are then useful, but whirl, damping and stability are wrong")
}

/// The remedy of a failure to linearise for a frequency response. A response has no `over:`.
pub(crate) fn help_of_response(error: &RuntimeError) -> Option<&'static str> {
    match error {
        RuntimeError::Turning { .. } => Some(
            "a response needs constant coefficients: linearise the model at rest, without its speed; or hold the coefficients at this moment by `frozen: true`: the response is about right at frequencies well above the speed",
        ),
        RuntimeError::OverTime { .. } => Some(
            "a response needs constant coefficients: `frozen: true` holds time at this moment; a load or a motion that only excites can be left out of the model for this analysis",
        ),
        RuntimeError::Unsteady { .. } => Some(
            "linearise at rest: let `start: quasi_static` find the balance, without a `start` item that holds the freedom, or let the motion die out with a longer `after:`; `frozen: true` holds the coefficients at this moment",
        ),
        _ => None,
    }
}

/// The warning of outputs that an input does not move, at the line of the analysis.
pub(crate) fn independent(outputs: &[String], inputs: &[String], analysis: &Origin) -> Diagnostic {
    let verb = if outputs.len() == 1 { "does" } else { "do" };
    let title = format!(
        "{} {verb} not depend on {}: the response is zero at all frequencies",
        listed(outputs),
        listed(inputs)
    );
    let message = Diagnostic::warning(codes::INDEPENDENT, title);
    place(message, analysis, "in this analysis")
        .with_help("check the loads that read the input, and the paths of the outputs; `eng results` lists them")
}

/// Names joined for a sentence.
fn listed(names: &[String]) -> String {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    sentence::joined(&names, 4)
}

/// Adds the elements that change the coefficients with time, and the remedy.
fn over_time(message: Diagnostic, elements: &[eng_runtime::TimedElement]) -> Diagnostic {
    elements
        .iter()
        .take(3)
        .fold(message, |message, element| place(message, &element.origin, element.reason()))
        .with_help("where it repeats, `over:` with its period, such as `over: 20 ms`, gives the modes of that period; `frozen: true` holds time at this moment; a load or a motion that only excites can be left out of the model for this analysis")
}

/// Adds the body that leaves the state, and the remedy.
fn unsteady(message: Diagnostic, body: &eng_runtime::LeavingBody) -> Diagnostic {
    let label = match body.leaving {
        Leaving::Moves(speed) => format!("moves at {} m/s", significant(speed, 4)),
        Leaving::Unbalanced(a) => format!("bodies gain speed by up to {} m/s^2", significant(a, 4)),
    };
    place(message, &body.origin, &label)
        .with_help("linearise at rest: let `start: quasi_static` find the balance, without a `start` item that holds the freedom, or let the motion die out with a longer `after:`; where it repeats, `over:` with its period gives its modes; `frozen: true` holds the coefficients at this moment")
}

/// Adds the place of a jump and the remedy.
fn jumps(message: Diagnostic, jump: &Jump) -> Diagnostic {
    let message = place(message, &jump.origin, "jumps");
    match &jump.of {
        Jumping::Force | Jumping::Torque => message.with_help("the motion returns to the jump from both sides, so no step passes it. Join the branches of the `if` by a slope, such as `tanh(v/(1 mm/s))` in place of a sign"),
        Jumping::Rate { .. } => message.with_help("the motion returns to the jump from both sides, so no step passes it. Let the rate change over a range, such as `min(max((limit - x)/width, 0), 1)` in place of `if x < limit then 1 else 0`; or switch by a second state, which gives a hysteresis"),
    }
}

/// The warning about a run that continues in short steps, because of a jump or because it slows down. `rest`
/// is the remaining time in words of a run that slows down. Without `rest` only a jump gives a warning.
pub(crate) fn slow(slow: &Slow, analysis: &str, rest: Option<&str>) -> Option<Diagnostic> {
    let (code, title) = match (&*slow.limit, rest) {
        (StepLimit::Jump(_), _) => (
            codes::JUMPING,
            format!("{analysis} advances slowly at {}; its {slow}", slow.moment),
        ),
        (_, Some(rest)) => (
            codes::SLOWING,
            format!(
                "{analysis} slows down at {}: at this pace the rest takes {rest}; its {slow}",
                slow.moment
            ),
        ),
        (_, None) => return None,
    };
    Some(paced(Diagnostic::warning(code, title), &slow.limit))
}

/// Adds the cause of the short steps and the remedy.
fn paced(message: Diagnostic, limit: &StepLimit) -> Diagnostic {
    match limit {
        StepLimit::Stated => message.with_help("take a longer `step`, or none: then error control chooses the steps"),
        StepLimit::Samples => message.with_help("state a longer `sample`: this is the sampling interval"),
        StepLimit::Turn => message.with_help("a step turns a body by a quarter radian at most. Look whether a body turns faster than intended; if not, state a shorter `duration`"),
        StepLimit::Sines => message.with_help("look whether a frequency in an `if`, `min`, `max` or `abs` is higher than intended; if not, state a shorter `duration`"),
        StepLimit::Jump(jump) => jumps(message, jump),
        StepLimit::Error { origin, .. } => place(message, origin, "its motion needs these steps")
            .with_help("something is very stiff or fast, or grows without bound: look at stiffness, damping (its sign, too), mass and clearance around this body"),
        StepLimit::Unsolved { origin, .. } => place(message, origin, "the largest residual is here")
            .with_help("something is very stiff, or a mechanism comes to the end of its reach: look at the outputs just before"),
    }
}

/// Adds the place of the table that is read outside its points, and the remedy.
fn outside_table(message: Diagnostic, outside: &Outside) -> Diagnostic {
    let message = message.also_if(outside.at.map(span), "its points are stated here");
    message.with_help(match &outside.of {
        None => "add points farther out, or state `periodic:`, or a rule for values outside: `extrapolation: hold` or `linear`".to_owned(),
        Some(of) => format!(
            "add points farther out, or state how the table continues: `{of}: hold`, `linear`, `even`, `odd` or `periodic(…)`"
        ),
    })
}

/// Redundant equations. Each joint gets one label and one note, however many of its equations repeat others.
fn redundant(groups: &[eng_runtime::RedundantGroup]) -> Diagnostic {
    let mut message = Diagnostic::error(
        codes::REDUNDANT,
        match groups.len() {
            1 => "a constraint equation repeats others".to_owned(),
            n => format!("{n} constraint equations repeat others"),
        },
    );
    let mut joints: Vec<&Origin> = Vec::new();
    for group in groups {
        if !joints.contains(&&group.redundant.origin) {
            joints.push(&group.redundant.origin);
        }
    }
    joints.sort_by(|a, b| a.path.cmp(&b.path));
    let mut places = Vec::new();
    for joint in joints {
        let own = groups.iter().filter(|g| g.redundant.origin == *joint);
        let (mut equations, mut others) = (Vec::new(), Vec::new());
        for group in own {
            equations.push(group.redundant.equation.clone());
            for repeated in &group.repeats {
                if !others.contains(&repeated.origin.path) {
                    others.push(repeated.origin.path.clone());
                }
            }
        }
        message = message.with_note(format!(
            "{}: {} already {} from {}",
            joint.path,
            equations.join(", "),
            if equations.len() == 1 {
                "follows"
            } else {
                "follow"
            },
            others.join(", "),
        ));
        if !places.contains(&joint.used_at) {
            places.push(joint.used_at);
            message = place(message, joint, "repeats equations of other joints");
        }
    }
    message.with_help(
        "keep one of these joints, and replace the others by joints with fewer equations (PointOnLine, PointOnPlane) or by journals: the reactions of repeated equations are not unique",
    )
}

/// The error for a parameter that is named where an input is needed.
pub(crate) fn no_input(parameter: &Parameter) -> Diagnostic {
    let path = &parameter.origin.path;
    let message = Diagnostic::error(
        codes::INPUT,
        format!("`{path}` is a parameter, which keeps its value during a run"),
    );
    place(message, &parameter.origin, "no `input`").with_help(
        "declare it as `input` in its model; as the argument of a class, state an input of the model",
    )
}

fn bind_diagnostic(error: &BindError, system: &System) -> Diagnostic {
    match error {
        BindError::Require {
            used_at,
            defined_at,
            path,
            parameters,
            ..
        } => {
            let origin = Origin {
                path: path.clone(),
                used_at: *used_at,
                defined_at: *defined_at,
            };
            let message = Diagnostic::error(codes::PARAMETER_REQUIRED, error.to_string());
            let message = condition(message, &origin, "this must hold");
            let message = with_part(message, system.part_of(&origin));
            // the parameters that decide it, if the text states them
            let stated = parameters.iter().rev().filter_map(|(index, value)| {
                let parameter = system.parameters.get(*index as usize)?;
                let value = format!(
                    "{} = {}",
                    parameter.origin.path,
                    parameter.display.text(*value)
                );
                Some((parameter.origin.used_at?, value))
            });
            // the numbers of one place, such as those of a record, share a label
            let mut elsewhere: Vec<(Location, Vec<String>)> = Vec::new();
            for (at, value) in stated.filter(|(at, _)| Some(*at) != *used_at) {
                match elsewhere.iter_mut().find(|(known, _)| *known == at) {
                    Some((_, others)) => others.push(value),
                    None => elsewhere.push((at, vec![value])),
                }
            }
            match elsewhere.len() {
                1..=MOST_PARAMETERS => elsewhere.iter().fold(message, |message, (at, values)| {
                    let label = match values.as_slice() {
                        [rest @ .., first] if !rest.is_empty() => {
                            let more = counted(rest.len(), "more number", "more numbers");
                            format!("{first} and {more}")
                        }
                        one => one.concat(),
                    };
                    message.moved_to(span(*at), label)
                }),
                _ => message,
            }
        }
        BindError::NotFinite {
            path,
            outside: Some(outside),
        } => {
            let message = Diagnostic::error(codes::OUTSIDE_TABLE, format!("{path}: {outside}"));
            let message =
                message.at_if(place_of(path, system).map(span), "needs the table's value");
            outside_table(message, outside)
        }
        BindError::NotFinite { path, .. } => {
            let message = Diagnostic::error(
                codes::PARAMETER_NOT_FINITE,
                format!("with these parameters {path} has a number that is not finite"),
            );
            let at = place_of(path, system).map(span);
            let message = message.at_if(at, "has a number that is not finite");
            message.with_help(
                "look for a division by zero, a root of a negative number, or a direction of length zero",
            )
        }
        BindError::TooLarge { path, .. } => {
            let message = Diagnostic::error(codes::PARAMETER_NOT_FINITE, error.to_string());
            let at = place_of(path, system).map(span);
            let message = message.at_if(at, "has a number that is too large");
            message.with_help("check its exponent and its unit")
        }
        BindError::Limits { path, .. } => {
            let message = Diagnostic::error(codes::PARAMETER_LIMITS, error.to_string());
            message.at_if(
                place_of(path, system).map(span),
                "its limits are stated here",
            )
        }
    }
}

/// The place in the text of the object with a path.
fn place_of(path: &str, system: &System) -> Option<Location> {
    let parameters = system.parameters.iter().map(|p| &p.origin);
    let markers = system.markers.iter().map(|m| &m.origin);
    let bodies = system.bodies.iter().map(|b| &b.origin);
    let elements = system.elements.iter().map(|e| &e.origin);
    parameters
        .chain(markers)
        .chain(bodies)
        .chain(elements)
        .find(|origin| origin.path == path && origin.used_at.is_some())
        .and_then(|origin| origin.used_at)
}

/// The warning about a start that differs from the wanted one.
pub(crate) fn start_advice(start: &StartReport) -> Option<Diagnostic> {
    let obstacle = match start {
        StartReport::NoBalance(obstacle) => obstacle,
        StartReport::QuasiStatic(found) => {
            if let Some(Turning::WithTheBody { origin, reason }) = &found.turning {
                let message = Diagnostic::warning(
                    codes::BENT_AS_IF_LOADS_TURNED,
                    format!("{} starts bent as if all loads turned with it", origin.path),
                );
                return Some(
                    place(message, origin, "turns")
                        .with_note(reason.clone())
                        .with_help("`start: assembled` takes the straight body without a warning"),
                );
            }
            return found
                .unstable
                .as_ref()
                .map(|unstable| upside_down(unstable, "the balance of the start"));
        }
        StartReport::Equilibrium(found) => {
            let unstable = found.unstable.as_ref();
            return unstable.map(|unstable| upside_down(unstable, "the equilibrium"));
        }
        StartReport::Assembled | StartReport::Resumed => return None,
    };
    let message = Diagnostic::warning(
        codes::NO_BALANCE,
        format!(
            "no quasi-static start was found: {}: {}",
            obstacle.origin.path, obstacle.message
        ),
    );
    Some(
        place(message, &obstacle.origin, "the obstacle")
            .with_note(format!(
                "the search found {}; the run starts as assembled",
                balance_with(obstacle.carried)
            ))
            .with_help("`start: assembled` takes this start without a warning"),
    )
}

/// The balance that a search found, in words. `carried` is its part of the load, 0…1. A balance with the
/// whole load is refused only because it breaks a condition.
fn balance_with(carried: f64) -> String {
    match carried < 1.0 {
        true => format!("an equilibrium with {:.3} % of the load", 100.0 * carried),
        false => {
            "an equilibrium with the whole load, in which a condition does not hold".to_owned()
        }
    }
}

/// The warning about an unstable balance: the smallest disturbance leads away from it. `what` names the
/// balance.
fn upside_down(unstable: &Unstable, what: &str) -> Diagnostic {
    let message = Diagnostic::warning(
        codes::UPSIDE_DOWN,
        format!("{what} is unstable: {} leaves it", unstable.origin.path),
    );
    place(message, &unstable.origin, "leaves the balance").with_note(format!(
        "a small deviation grows by the factor e in {} s",
        significant(unstable.time, 3)
    ))
}

/// Facts and warnings about a periodic analysis, besides the statement whether it repeats.
pub(crate) fn periodic(
    found: &PeriodicSummary,
    system: &System,
    bound: &eng_system::code::Bound,
) -> (Vec<String>, Vec<Diagnostic>) {
    let name = |channel: usize| system.channels.get(channel).map_or("", |c| c.path.as_str());
    let mut facts = Vec::new();
    let mut warnings: Vec<Diagnostic> = found
        .unstable
        .iter()
        .map(|unstable| upside_down(unstable, "the steady motion"))
        .collect();
    let decay = found.decay.as_ref().filter(|_| !found.erratic);
    if let Some((decay, mode)) = decay.and_then(|d| Some((d, d.mode?))) {
        // in a motion that repeats, deviations that do not shrink are below the `change` that counts as a
        // repetition
        let shrinking = match found.repeats && mode.factor >= crate::repetition::HARDLY_SHRINKS {
            true => "are as small as the errors of the steps".to_owned(),
            false => crate::repetition::decay_in_words(mode.factor),
        };
        facts.push(format!(
            "slowest decay: deviations of the motion {shrinking}; they are largest in {}",
            name(decay.channel),
        ));
    }
    if found.leaps > 0 {
        facts.push(format!(
            "leapt {} over the decay of a slow motion: if several motions repeat, this may be another one than that of the start",
            match found.leaps {
                1 => "once".to_owned(),
                times => format!("{times} times"),
            }
        ));
    }
    for growth in &found.growing {
        let unit = system
            .channels
            .get(growth.channel)
            .map(|c| c.display.clone());
        if let Some(unit) = unit {
            facts.push(format!(
                "{} grows by {:.6} {} per cycle",
                name(growth.channel),
                growth.by / unit.scale,
                unit.symbol
            ));
        }
    }
    // the orbits of a run that repeats early still contain its start, so they show no whirl
    for whirl in found.whirl.iter().filter(|_| !found.repeats) {
        let Some(journal) = system.journals.get(whirl.journal) else {
            continue;
        };
        let Some(element) = system.elements.get(journal.element as usize) else {
            continue;
        };
        let clearance = bound
            .slots
            .get(journal.clearance.0 as usize)
            .copied()
            .unwrap_or(0.0);
        if !whirl.is_seen(clearance) {
            continue;
        }
        let fact = format!(
            "besides its repeating orbit, {} moves by {:.3} µm at {:.3} times the crank's speed",
            element.origin.path,
            1e6 * whirl.radius,
            whirl.order
        );
        if whirl.is_sustained() {
            let message = Diagnostic::warning(
                codes::WHIRL,
                format!("{} whirls at about half speed", element.origin.path),
            );
            warnings.push(
                place(message, &element.origin, "half-speed whirl")
                    .with_note(fact)
                    .with_help("load the film more, or take a larger clearance, thinner oil or a shorter bearing: a film with little load whirls"),
            );
        } else {
            facts.push(fact);
        }
    }
    (facts, warnings)
}

/// Adds the condition, and the user's line if the condition belongs to a class.
fn condition(message: Diagnostic, origin: &Origin, label: &str) -> Diagnostic {
    match (origin.used_at, origin.defined_at) {
        (Some(at), _) => related(
            message.at(span(at), format!("{}: {FAILS}", origin.path)),
            origin,
            label,
        ),
        (None, Some(at)) => message.at(span(at), label),
        (None, None) => message,
    }
}
