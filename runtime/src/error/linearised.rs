//! Reasons why a motion has no modes: its coefficients are not constant, or it does not repeat.

use super::MOST_GAPS;
use eng_system::significant::significant;
use eng_system::system::Origin;

/// The reason for which the coefficients of the linearised motion change while a body turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varies {
    /// It is flexible: its shapes turn with it, but its supports and loads do not.
    Shapes,
    /// Its mass and inertia are not those of a body of revolution about its axis of turning.
    Inertia,
    /// A joint or load acts on it beside its axis, or depends on its angle.
    Loads,
}

/// A body whose turning changes the coefficients of the linearised motion.
#[derive(Clone, Debug, PartialEq)]
pub struct TurningBody {
    /// The body.
    pub origin: Origin,
    /// Its angular speed (rad/s).
    pub speed: f64,
    /// The reason for the change.
    pub varies: Varies,
}

impl TurningBody {
    /// The reason in words, after the name of the body.
    pub fn reason(&self) -> &'static str {
        match self.varies {
            Varies::Shapes => "is flexible: its shapes turn with it, and its supports do not",
            Varies::Inertia => "is no body of revolution about its axis of rotation",
            Varies::Loads => {
                "has a joint or load that acts beside its axis or changes with its angle or with time"
            }
        }
    }
}

/// The way in which a body leaves the state of a linearisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leaving {
    /// It moves (m/s).
    Moves(f64),
    /// Forces do not balance; the largest acceleration of a body (m/s²).
    Unbalanced(f64),
}

/// A body that leaves the state, so that the coefficients of the linearised motion change.
#[derive(Clone, Debug, PartialEq)]
pub struct LeavingBody {
    /// The body.
    pub origin: Origin,
    /// The way in which it leaves.
    pub leaving: Leaving,
}

impl LeavingBody {
    /// The reason in words, after the name of the body.
    pub fn reason(&self) -> &'static str {
        match self.leaving {
            Leaving::Moves(_) => "moves, and its stiffness, damping or inertia changes on its way",
            Leaving::Unbalanced(_) => {
                "is not in balance, and its stiffness, damping or inertia changes on its way there"
            }
        }
    }
}

/// The reason why no motion was found that repeats after a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotBack {
    /// No motion of the period is near.
    OtherPeriod,
    /// A motion of the period is near by the linear equations, but the search from the state does not reach it.
    TooFar,
}

impl NotBack {
    /// The part of the message after the gap.
    pub(super) fn suffix(self) -> &'static str {
        match self {
            NotBack::OtherPeriod => "",
            NotBack::TooFar => {
                "; a motion of this period is near, but the search from the state does not find it"
            }
        }
    }
}

/// The part of an element that changes with time alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Timed {
    /// Its stiffness or damping.
    Coefficients,
    /// Its load, and so the moment of the load on a displaced body.
    Load,
    /// The motion that it imposes.
    Motion,
}

/// An element by which the coefficients of the linearised motion change with time alone.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedElement {
    /// The element.
    pub origin: Origin,
    /// The part that changes.
    pub timed: Timed,
}

impl TimedElement {
    /// The reason in words, after the name of the element.
    pub fn reason(&self) -> &'static str {
        match self.timed {
            Timed::Coefficients => "has a stiffness or damping that changes with time",
            Timed::Load => "has a load that changes with time, and so does its stiffness",
            Timed::Motion => "moves its markers at a speed that changes with time",
        }
    }
}

/// The effect of the changed coefficients in words.
pub(super) fn changed(share: f64) -> String {
    if share.is_finite() {
        format!(
            "their change moves eigenvalues by about {:.2} %",
            100.0 * share
        )
    } else {
        "they differ".to_owned()
    }
}

/// The slope of a load on both sides of a kink, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BothSides {
    /// Its slope on each side; that of the steeper one is positive.
    pub slopes: [f64; 2],
    /// Whether the load is a torque.
    pub torque: bool,
    /// Whether it changes with a turn.
    pub turn: bool,
    /// Whether it changes with the rate.
    pub damping: bool,
}

/// The expression of a kink in quotes.
pub(super) fn quoted(text: &str) -> String {
    match text {
        "" => String::new(),
        text => format!(" (`{text}`)"),
    }
}

/// The slopes of both sides in words.
pub(super) fn both_sides(sides: Option<&BothSides>) -> String {
    let Some(sides) = sides else {
        return "its load, or the rate of a state, jumps or bends there".to_owned();
    };
    let unit = match (sides.torque, sides.turn, sides.damping) {
        (false, false, false) => "N/m",
        (false, false, true) => "N*s/m",
        (false, true, false) => "N/rad",
        (false, true, true) => "N*s/rad",
        (true, false, false) => "N*m/m",
        (true, false, true) => "N*m*s/m",
        (true, true, false) => "N*m/rad",
        (true, true, true) => "N*m*s/rad",
    };
    let kind = if sides.damping {
        "damping"
    } else {
        "stiffness"
    };
    let [a, b] = sides.slopes.map(|slope| significant(slope, 4));
    format!("its {kind} is {a} {unit} on one side and {b} {unit} on the other")
}

/// Paths of the first few, and the number of others.
fn names<'a>(origins: impl ExactSizeIterator<Item = &'a Origin>) -> String {
    let more = match origins.len().saturating_sub(MOST_GAPS) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let named: Vec<&str> = origins.take(MOST_GAPS).map(|o| o.path.as_str()).collect();
    format!("{}{more}", named.join(", "))
}

pub(super) fn list_timed(elements: &[TimedElement]) -> String {
    names(elements.iter().map(|element| &element.origin))
}

pub(super) fn list_turning(bodies: &[TurningBody]) -> String {
    let verb = if bodies.len() == 1 { "turns" } else { "turn" };
    format!("{} {verb}", names(bodies.iter().map(|body| &body.origin)))
}
