//! All errors between binding and the last sample.

mod linearised;
mod step_limit;

use eng_system::code::BindError;
use eng_system::field::FieldError;
use eng_system::sentence;
use eng_system::significant::short;
use eng_system::system::Origin;
use eng_system::table::Outside;
use eng_system::{Dimension, DisplayUnit};
pub use linearised::{
    BothSides, Leaving, LeavingBody, NotBack, Timed, TimedElement, TurningBody, Varies,
};
use linearised::{changed, list_timed, list_turning};
pub use step_limit::{Jump, Jumping, Slow, StepLimit};

/// The moment of an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time (s).
    pub time: f64,
    /// Unwrapped cycle angle (rad), if the model has a cycle.
    pub cycle_angle: Option<f64>,
}

impl std::fmt::Display for Moment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "t = {} s", short(self.time, 9))?;
        if let Some(angle) = self.cycle_angle {
            write!(f, " ({:.2} °CA)", angle.to_degrees())?;
        }
        Ok(())
    }
}

/// One constraint equation of one element, with a number.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedRow {
    /// The element.
    pub origin: Origin,
    /// The equation as written.
    pub equation: String,
    /// Its residual, or its share in a dependence (SI).
    pub value: f64,
    /// Whether `value` is a length (m).
    pub is_length: bool,
}

/// A jump of the acceleration that a constraint requires within a fixed step.
#[derive(Clone, Debug, PartialEq)]
pub struct AccelerationJump {
    /// The equation, with the jump of its second rate (1/s² of its unit).
    pub size: Box<NamedRow>,
    /// The equation, with the largest error of a position over the step that the jump makes.
    pub error: Box<NamedRow>,
}

impl std::fmt::Display for NamedRow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.origin.path, self.equation)
    }
}

impl NamedRow {
    /// The residual with its unit. Equations that are no lengths are products of unit axes; for small gaps
    /// these are angles.
    pub fn gap(&self, per: &str) -> String {
        let value = self.value.abs();
        match (self.is_length, per) {
            (true, _) => format!("{} mm{per}", short(1e3 * value, 4)),
            (false, "") => format!("{}°", short(value.to_degrees(), 4)),
            (false, _) => format!("{} rad{per}", short(value, 4)),
        }
    }
}

/// A closed chain of bodies and the joints between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Joints and films, with the z axis of the reference marker of each (unit vector, inertial).
    pub joints: Vec<(Origin, Option<[f64; 3]>)>,
    /// Its bodies without the ground.
    pub bodies: Vec<ChainBody>,
    /// Distance of its two joints on the ground, measured like the length of a body (m).
    pub ground: Option<f64>,
    /// Whether each joint holds a point, so that bodies meet in points alone.
    pub of_points: bool,
}

/// A body of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainBody {
    /// The body.
    pub origin: Origin,
    /// Distance of its two joints across the chain's axis (m).
    pub length: f64,
    /// Indices of the parameters that place its two markers.
    pub parameters: Vec<u32>,
    /// Its two markers in the chain.
    pub markers: [Origin; 2],
}

impl std::fmt::Display for Chain {
    /// `crank, rod[1] and piston[1]`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, body) in self.bodies.iter().enumerate() {
            let joint = match i {
                0 => "",
                _ if i + 1 == self.bodies.len() => " and ",
                _ => ", ",
            };
            write!(f, "{joint}{}", body.origin.path)?;
        }
        Ok(())
    }
}

fn whose(chain: Option<&Chain>) -> String {
    chain.map_or_else(
        || "the mechanism".to_owned(),
        |chain| format!("the loop of {chain}"),
    )
}

fn standing(moment: &Moment, angle: f64) -> String {
    if moment.time == 0.0 {
        "the cycle does not turn: it is at rest at the start, and nothing accelerates it".to_owned()
    } else {
        format!(
            "the cycle angle reached at most {:.3}° by {moment}",
            angle.to_degrees()
        )
    }
}

/// The amount by which a branch condition fails, in words.
fn missed(value: f64, dimension: Option<Dimension>) -> String {
    if value.abs() <= 1e-9 {
        "in the only position found, the branch condition is exactly at its limit".to_owned()
    } else {
        format!("the condition fails by {}", gap(-value, dimension))
    }
}

/// A gap with its unit: lengths in mm, angles in degrees, numbers without a unit, and all other values in SI units.
pub fn gap(value: f64, dimension: Option<Dimension>) -> String {
    match dimension {
        Some(Dimension::LENGTH) => format!("{} mm", short(1e3 * value, 4)),
        Some(Dimension::ONE) => short(value, 4),
        Some(Dimension::ANGLE) => format!("{}°", short(value.to_degrees(), 4)),
        Some(dimension) => {
            let unit = DisplayUnit::si(dimension);
            format!("{} {}", short(value, 4), unit.symbol)
        }
        None => format!("{} in SI units", short(value, 4)),
    }
}

/// Equations that repeat each other.
#[derive(Clone, Debug, PartialEq)]
pub struct RedundantGroup {
    /// The equation that follows from the others.
    pub redundant: NamedRow,
    /// The equations that it follows from.
    pub repeats: Vec<NamedRow>,
}

impl std::fmt::Display for RedundantGroup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.redundant)?;
        if !self.repeats.is_empty() {
            let names: Vec<String> = self.repeats.iter().map(ToString::to_string).collect();
            write!(f, " repeats {}", names.join(", "))?;
        }
        Ok(())
    }
}

/// The largest number of equations that a message names. A choice: the worst three; the others follow from
/// them.
const MOST_GAPS: usize = 3;

/// The residuals of equations. `per` is added to the units: `/s` for velocities.
fn gaps(rows: &[NamedRow], per: &str) -> String {
    let mut text = rows
        .iter()
        .take(MOST_GAPS)
        .map(|r| format!("{} at {r}", r.gap(per)))
        .collect::<Vec<_>>()
        .join("; ");
    if rows.len() > MOST_GAPS {
        text.push_str(&format!("; and {} more", rows.len() - MOST_GAPS));
    }
    text
}

/// The paths of elements as a list.
fn together(elements: &[Origin]) -> String {
    let paths: Vec<&str> = elements.iter().map(|e| e.path.as_str()).collect();
    sentence::joined(&paths, usize::MAX)
}

/// A body that resists no motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Massless {
    /// The body.
    pub origin: Origin,
    /// `mass` or `inertia`.
    pub lacks: &'static str,
}

fn undetermined(massless: &[Massless], repeated: &[RedundantGroup]) -> String {
    let more = |count: usize| match count.saturating_sub(MOST_GAPS) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    if !repeated.is_empty() {
        let first = repeated.get(..MOST_GAPS).unwrap_or(repeated);
        format!(
            "constraint equations depend on each other at this position: {}{}",
            list_groups(first),
            more(repeated.len())
        )
    } else if !massless.is_empty() {
        let named: Vec<String> = massless
            .iter()
            .take(MOST_GAPS)
            .map(|body| format!("{} has no {}", body.origin.path, body.lacks))
            .collect();
        format!("{}{}", named.join("; "), more(massless.len()))
    } else {
        "a movable part has no mass or inertia, or the mechanism is locked".to_owned()
    }
}

fn repeating(count: usize) -> String {
    match count {
        1 => "1 constraint equation repeats others".to_owned(),
        _ => format!("{count} constraint equations repeat others"),
    }
}

fn list_groups(groups: &[RedundantGroup]) -> String {
    groups
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .join("; ")
}

/// The reason why an element has no number.
#[derive(Clone, Debug, PartialEq)]
pub enum Undefined {
    /// A table is read outside its points.
    Table(Outside),
    /// A field has no solution.
    Field(FieldError),
}

impl std::fmt::Display for Undefined {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Undefined::Table(outside) => outside.fmt(f),
            Undefined::Field(error) => error.fmt(f),
        }
    }
}

fn undefined(origin: &Origin, because: &Option<Box<Undefined>>, moment: &Moment) -> String {
    match because {
        Some(because) => format!("{}: {because} ({moment})", origin.path),
        None => format!(
            "{} is not finite at {moment}: a division by zero, or a root or a logarithm of a number that has none",
            origin.path
        ),
    }
}

/// The reason why an analysis stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RuntimeError {
    /// The parameters cannot be used.
    #[error(transparent)]
    Bind(#[from] BindError),
    /// System and code do not fit together, or code has failed: a fault of Eng, not of the model.
    #[error("{what}: this is a fault of Eng; please report it together with the model")]
    Malformed {
        /// The parts that do not fit, or the failure.
        what: String,
    },
    /// An option has no meaning.
    #[error("{message}")]
    Options {
        /// The mistake and its remedy.
        message: String,
    },
    /// A program sets an input in a way that has no meaning.
    #[error("{}: {message}", origin.path)]
    Input {
        /// The input.
        origin: Box<Origin>,
        /// The mistake and its remedy.
        message: String,
    },
    /// The inputs break a limit or a condition of parameters during a run.
    #[error("at {moment}: {cause}")]
    Inputs {
        /// The moment.
        moment: Moment,
        /// The limit or condition.
        cause: Box<BindError>,
    },
    /// A body has a mass or inertia that is physically impossible.
    #[error("{}: {message}", origin.path)]
    Body {
        /// The body.
        origin: Box<Origin>,
        /// The mistake.
        message: String,
    },
    /// Positions cannot satisfy every constraint.
    #[error("the assembly does not close: gaps of {}", gaps(rows, ""))]
    OpenLoop {
        /// The rows that stay open, the widest first.
        rows: Vec<NamedRow>,
        /// The loop of the first row.
        chain: Option<Box<Chain>>,
    },
    /// Starts and drives state positions that contradict each other.
    #[error(
        "the assembly does not close: {} contradict each other",
        together(starts)
    )]
    Contradiction {
        /// A smallest set: without any one of them the others hold.
        starts: Vec<Origin>,
    },
    /// The assembled positions are on the wrong branch.
    #[error("{}: no start position with {condition} was found: {}", origin.path, missed(*value, *dimension))]
    Branch {
        /// The element.
        origin: Box<Origin>,
        /// The condition as written.
        condition: String,
        /// Its dimension, if all the compared values have the same one.
        dimension: Option<Dimension>,
        /// Its value. The condition holds for a positive value.
        value: f64,
        /// The loop of the element.
        chain: Option<Box<Chain>>,
    },
    /// The `guess` for a body is beyond the reach of its joints.
    #[error(
        "the guess of {} is {} m away from the bodies that it is joined to, but the model is at most {} m large",
        origin.path,
        short(*distance, 4),
        short(*length, 4)
    )]
    FarGuess {
        /// The body.
        origin: Box<Origin>,
        /// Its distance from the ground's markers and the stated bodies (m).
        distance: f64,
        /// Size of the largest body (m).
        length: f64,
    },
    /// Start velocities contradict the constraints or each other.
    #[error("the start velocities contradict each other: {}", gaps(rows, "/s"))]
    StartVelocity {
        /// The rows that stay unsatisfied, the worst first.
        rows: Vec<NamedRow>,
        /// The loop that the stated motion does not fit, if a joint is among the rows.
        chain: Option<Box<Chain>>,
    },
    /// The mechanism has reached a position beyond which its geometry does not let it move.
    #[error("{} locks at {moment}", whose(chain.as_deref()))]
    Locked {
        /// When.
        moment: Moment,
        /// Constraint equations that depend on each other there, the most concerned first.
        rows: Vec<NamedRow>,
        /// The loop.
        chain: Option<Box<Chain>>,
    },
    /// Constraint equations repeat each other.
    #[error("{}: {}", repeating(groups.len()), list_groups(groups))]
    Redundant {
        /// One group for each excess equation.
        groups: Vec<RedundantGroup>,
    },
    /// The system of accelerations has no unique solution.
    #[error(
        "the accelerations are not determined at {moment}: {}",
        undetermined(massless, repeated)
    )]
    Singular {
        /// When.
        moment: Moment,
        /// Bodies without mass or inertia; empty if equations depend on each other.
        massless: Vec<Massless>,
        /// Constraint equations that repeat others at this position.
        repeated: Vec<RedundantGroup>,
    },
    /// A field cannot be made of the model's numbers.
    #[error("{}: {message}", origin.path)]
    Field {
        /// The element.
        origin: Box<Origin>,
        /// The reason.
        message: String,
    },
    /// An element returned something that is not a number.
    #[error("{}", undefined(origin, because, moment))]
    NotFinite {
        /// The element.
        origin: Box<Origin>,
        /// The reason, if it is known.
        because: Option<Box<Undefined>>,
        /// When.
        moment: Moment,
    },
    /// The condition that should end the run holds before its first step.
    #[error("the condition of `stop` holds at the start already, at {moment}: {condition}")]
    StopsAtStart {
        /// The condition's place.
        origin: Box<Origin>,
        /// The condition as written.
        condition: String,
        /// When.
        moment: Moment,
    },
    /// Newton's iteration fails even with the smallest step.
    #[error("the equations of a step of {} s at {moment} have no solution: the largest residual is {} {unit} in {} ({equation})", short(*step, 3), short(*size, 3), origin.path)]
    Newton {
        /// When.
        moment: Moment,
        /// The last step tried (s).
        step: f64,
        /// The element or body of the worst row.
        origin: Box<Origin>,
        /// The equation of the worst row.
        equation: String,
        /// Residual of that row.
        size: f64,
        /// Its unit.
        unit: String,
    },
    /// A tolerance is smaller than the rounding error of the solution.
    #[error(
        "a tolerance of {} is smaller than the rounding errors of the motion{}: the smallest possible one is about {}",
        short(*tolerance, 4),
        moment.as_ref().map_or(String::new(), |m| format!(" at {m}")),
        short(*least, 1)
    )]
    Rounding {
        /// The moment of the finding; `None` if it holds from the start.
        moment: Option<Moment>,
        /// The factor on the tolerances.
        tolerance: f64,
        /// The smallest factor that the run can satisfy.
        least: f64,
    },
    /// A class resolves a length below the rounding error of positions.
    #[error(
        "the length {} m after `resolve` in {} is smaller than the rounding errors of positions in a model of this size; the least possible length is about {} m",
        short(*length, 4),
        origin.path,
        short(*least, 1)
    )]
    Resolution {
        /// The element, with the place of the length in its class.
        origin: Box<Origin>,
        /// The length (m).
        length: f64,
        /// The smallest length that a model of this size resolves (m).
        least: f64,
    },
    /// Error control requires steps that floating-point numbers cannot resolve.
    #[error(
        "the step falls below {} s at {moment}; {} is not smooth there: {}{}",
        short(*step, 3),
        state.as_ref().map_or("the motion".to_owned(), |name| format!("the state `{name}`")),
        origin.path,
        acting(loads)
    )]
    StepTooSmall {
        /// When.
        moment: Moment,
        /// The step (s).
        step: f64,
        /// The body with the largest error, or the element whose state has the largest error.
        origin: Box<Origin>,
        /// The name of that state.
        state: Option<String>,
        /// Paths of the elements whose loads act on that body.
        loads: Vec<String>,
    },
    /// A load or a rate jumps at the present motion, and no step passes the jump.
    #[error("{jump} at {moment}; the motion stays at the jump, and steps are only {} s long", short(*step, 3))]
    Jumps {
        /// When.
        moment: Moment,
        /// The step (s).
        step: f64,
        /// The jump.
        jump: Jump,
    },
    /// A constraint requires a velocity or a position that jumps.
    #[error(
        "the {} that {} demands jumps by {} at {moment}",
        if *velocity { "velocity" } else { "position" },
        origin.path,
        row.gap(if *velocity { "/s" } else { "" })
    )]
    Demanded {
        /// When.
        moment: Moment,
        /// The element, and the place of the expression with the kink.
        origin: Box<Origin>,
        /// The expression with the kink as written; empty if no text states it.
        text: String,
        /// The equation, with the jump of its rate or of its value.
        row: Box<NamedRow>,
        /// Whether it is the velocity.
        velocity: bool,
    },
    /// The observer ended the run before its end.
    #[error("the run was stopped at {moment}; its {slow}", moment = .0.moment, slow = .0)]
    Stopped(Slow),
    /// A stated step turns a body further than angles can be followed.
    #[error("a step of {} s turns {} by {degrees:.0}°; the limit is 90° a step", short(*step, 3), origin.path)]
    TurnsTooFar {
        /// When.
        moment: Moment,
        /// The step (s).
        step: f64,
        /// The turn (°).
        degrees: f64,
        /// The body.
        origin: Box<Origin>,
    },
    /// A body runs away from the model: its distance grows without bound.
    #[error(
        "{} has run away at {moment}: it is {} m from the origin, {} times the size of the model",
        origin.path,
        short(*distance, 2),
        short(*lengths, 1)
    )]
    Runaway {
        /// When.
        moment: Moment,
        /// The body.
        origin: Box<Origin>,
        /// Its distance from the ground's origin (m).
        distance: f64,
        /// The same distance in lengths of the model.
        lengths: f64,
    },
    /// A condition that must hold at every state does not.
    #[error("{}: {message} at {moment}", origin.path)]
    Require {
        /// The element.
        origin: Box<Origin>,
        /// The author's message.
        message: String,
        /// When.
        moment: Moment,
        /// The value that should be positive.
        value: f64,
        /// Its dimension, if all the compared values have the same one.
        dimension: Option<Dimension>,
    },
    /// An output position or velocity does not come back to the constraints.
    #[error(
        "the output at {moment} cannot be projected on the constraints: {}",
        gaps(std::slice::from_ref(row.as_ref()), "")
    )]
    Projection {
        /// When.
        moment: Moment,
        /// The worst row.
        row: Box<NamedRow>,
    },
    /// The iteration did not find the eigenvalues.
    #[error("the eigenvalues of the linearised motion ({size} unknowns) were not found: {what}")]
    Eigenvalues {
        /// Rows of the matrix.
        size: usize,
        /// Why.
        what: String,
    },
    /// The coefficients of the linearised motion are not constant.
    #[error(
        "the linearised motion at {moment} has no constant coefficients: {}",
        list_turning(bodies)
    )]
    Turning {
        /// When.
        moment: Moment,
        /// The bodies that change them.
        bodies: Vec<TurningBody>,
    },
    /// The coefficients of the linearised motion change with time alone.
    #[error(
        "the coefficients of the linearised motion at {moment} depend on time through {}; {} s later, {}",
        list_timed(elements), short(*later, 2), changed(*change)
    )]
    OverTime {
        /// When.
        moment: Moment,
        /// The elements that change them.
        elements: Vec<TimedElement>,
        /// Time after which they differ (s).
        later: f64,
        /// Bound on the effect on each eigenvalue, as a share of its size; infinite without a bound.
        change: f64,
    },
    /// A field of an element has a memory, and linearised equations have no unknowns for it.
    #[error("{}: this film keeps its oil, or the shape of its elastic surface, from step to step, and Eng has no linear equations of such a film", origin.path)]
    Remembers {
        /// The element.
        origin: Box<Origin>,
    },
    /// A field has other derivatives on both sides of the state.
    #[error("{}: the film has no pressure at {moment}; how it ruptures then depends on the direction of the motion, so it has no linear equations", origin.path)]
    Undecided {
        /// The element.
        origin: Box<Origin>,
        /// When.
        moment: Moment,
    },
    /// An element is at a kink, and its loads or rates have other derivatives on both sides.
    #[error("{} is at a kink{} at {moment}: {}, so the motion has no linear equations there", origin.path, linearised::quoted(text), linearised::both_sides(sides.as_ref()))]
    Kinked {
        /// The element, with the place of the kink in its class.
        origin: Box<Origin>,
        /// The expression with the kink; empty if no text states it.
        text: String,
        /// The slopes of a load on both sides, if they differ.
        sides: Option<BothSides>,
        /// When.
        moment: Moment,
    },
    /// A load or a rate jumps at a kink that a repeating motion passes.
    #[error(
        "{jump} at {moment} and again in each period: a small motion meets the jump earlier or later, so linear equations do not describe it, and no modes are given"
    )]
    JumpsInPeriod {
        /// When.
        moment: Moment,
        /// The jump.
        jump: Jump,
    },
    /// An output has other slopes on both sides of the state.
    #[error(
        "the output {path} has a kink at {moment}: its slopes on both sides of the state differ, so a linear model cannot have this output"
    )]
    KinkedOutput {
        /// Its channel.
        path: String,
        /// When.
        moment: Moment,
    },
    /// The state is neither at rest nor in a steady motion.
    #[error("linear equations need rest or a steady motion, but at {moment} {} {}", body.origin.path, body.reason())]
    Unsteady {
        /// When.
        moment: Moment,
        /// The body that moves on.
        body: Box<LeavingBody>,
    },
    /// A small motion grows, so that no vibration about the state is steady.
    #[error("the motion at {moment} is unstable: a mode of {} Hz grows by {} 1/s{}", short(*frequency, 5), short(*growth, 4), part.as_ref().map_or(String::new(), |part| format!(", most of it in {part}")))]
    Grows {
        /// When.
        moment: Moment,
        /// The frequency of the mode (Hz).
        frequency: f64,
        /// The rate at which it grows (1/s).
        growth: f64,
        /// The part with the most kinetic energy of the mode.
        part: Option<String>,
    },
    /// A motion that should repeat does not.
    #[error("the motion from {moment} on does not repeat after {} s: {what}{}", short(*period, 6), why.suffix())]
    NotRepeating {
        /// The beginning of the period.
        moment: Moment,
        /// The period (s).
        period: f64,
        /// The body that is farthest off, if it is one.
        origin: Option<Box<Origin>>,
        /// The quantity with the largest deviation, and this deviation.
        what: String,
        /// Why.
        why: NotBack,
    },
    /// The model gives no period.
    #[error("{message}")]
    NoPeriod {
        /// Why.
        message: String,
    },
    /// Nothing balances the loads.
    #[error(
        "there is no equilibrium{}: {}{message}",
        if *turning { "" } else { " at rest" },
        if origin.path.is_empty() { String::new() } else { format!("{}: ", origin.path) }
    )]
    NoEquilibrium {
        /// The journal, body or element that prevents the balance.
        origin: Box<Origin>,
        /// Its effect.
        message: String,
        /// Part of the load with a balance, 0…1.
        carried: f64,
        /// Whether the motion that the text states was taken.
        turning: bool,
        /// Whether there are films.
        films: bool,
    },
    /// A mechanism has no kinematic analysis.
    #[error("{message}")]
    NotKinematic {
        /// The body, element or cycle that prevents it.
        origin: Option<Box<Origin>>,
        /// The reason, with its name.
        message: String,
        /// The remedy.
        remedy: &'static str,
    },
    /// The analysis needs an angle, but the model states no cycle.
    #[error("the analysis counts in angles of the cycle, but the model has no cycle")]
    NoCycle,
    /// The cycle does not advance.
    #[error("{}", standing(moment, *angle))]
    CycleStands {
        /// When.
        moment: Moment,
        /// The angle (rad).
        angle: f64,
    },
    /// A time outside the last step.
    #[error("t = {time} s is outside the last step, {from}…{to} s")]
    OutsideStep {
        /// The requested time (s).
        time: f64,
        /// Beginning of the last step (s).
        from: f64,
        /// End of the last step (s).
        to: f64,
    },
    /// The bytes are no checkpoint of this model.
    #[error("the checkpoint cannot be used: {reason}")]
    Checkpoint {
        /// Why.
        reason: String,
    },
}

/// The elements whose loads act on a body, in words.
fn acting(loads: &[String]) -> String {
    let paths: Vec<&str> = loads.iter().map(String::as_str).collect();
    let verb = match paths.as_slice() {
        [] => return String::new(),
        [_] => "acts",
        _ => "act",
    };
    format!(", on which {} {verb}", sentence::listed(&paths, 3))
}
