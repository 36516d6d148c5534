//! Messages about geometry: open loops, locks, and bodies that nothing holds.

use super::diagnostic;
use crate::codes;
use crate::places::{place, related, span};
use eng_grammar::Diagnostic;
use eng_runtime::error::Chain;
use eng_runtime::joint::Joint;
use eng_runtime::start::hanging::Hanging;
use eng_runtime::{NamedRow, RuntimeError};
use eng_system::Dimension;
use eng_system::significant::{fixed, short};
use eng_system::system::{BodyRef, Element, Location, Origin, Parameter, Role, System};

/// The warning about bodies that nothing holds.
pub(crate) fn hanging(found: &Hanging) -> Diagnostic {
    let name = &found.origin.path;
    let message = Diagnostic::warning(codes::HANGING, format!("nothing holds {name}"));
    let message = place(message, &found.origin, "free to move in every direction");
    let message = match found.others.as_slice() {
        [] => message,
        others => {
            let shown: Vec<&str> = others.iter().take(8).map(String::as_str).collect();
            let more = match others.len() - shown.len() {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            message.with_note(format!(
                "they are connected to it and to nothing else: {}{more}",
                shown.join(", ")
            ))
        }
    };
    message.with_help(
        "mount it: `joint mount = Fixed(block.origin, ground)`, bushings, or `support` of a flexible body",
    )
}

/// The warning about a machine that locks within its cycle.
pub(crate) fn does_not_turn(locked: &RuntimeError, system: &System) -> Diagnostic {
    let mut message = diagnostic(locked, system);
    message.severity = eng_grammar::Severity::Warning;
    message.code = codes::NO_TURN;
    message
}

/// A loop that does not close.
pub(super) fn open_loop(
    mut message: Diagnostic,
    rows: &[NamedRow],
    chain: Option<&Chain>,
    system: &System,
) -> Diagnostic {
    for (i, row) in rows.iter().take(3).enumerate() {
        message = if i == 0 {
            place(message, &row.origin, "stays open here")
        } else {
            related(message, &row.origin, "and here")
        };
    }
    let message = with_lengths(message, chain, system);
    let message = message.with_each(rows.first(), |message, row| {
        with_markers(message, &row.origin, system)
    });
    let message = with_guesses(message, chain, system);
    let starts = starts(chain, system);
    let open = |at: &Location| rows.iter().any(|row| row.origin.used_at == Some(*at));
    let others = starts.iter().filter(|(_, at)| !open(at));
    let message = others.take(MOST_STARTS).fold(message, |message, (of, at)| {
        message.also(span(*at), format!("{}: it must hold exactly", of.path))
    });
    let message = with_angle(message, chain, system);
    if let Some(short) = chain.and_then(too_short) {
        return message.with_help(short);
    }
    let message = message.with_help(PLACING);
    message.with_help(match starts.is_empty() {
        true => GUESSING,
        false => "each `start` must hold exactly: remove one that the loop decides, or replace it by a `guess`, where the search only begins",
    })
}

/// Share of the longest length of a loop by which the others may miss it by rounding. A choice above the
/// rounding of lengths that a text computes.
const ROUNDING: f64 = 1e-9;

/// The remedy if a loop has one length that all others together do not reach. A polygon closes if its longest side is at most the
/// sum of the others, whatever its angles are.
fn too_short(chain: &Chain) -> Option<String> {
    if !chain.of_points {
        return None;
    }
    let bodies = chain.bodies.iter();
    let sides = bodies.map(|body| (body.origin.path.as_str(), body.length));
    let ground = chain.ground.map(|length| ("the ground", length));
    let mut sides: Vec<(&str, f64)> = sides.chain(ground).collect();
    sides.sort_by(|a, b| b.1.total_cmp(&a.1));
    let ((longest, length), others) = sides.split_first()?;
    let sum: f64 = others.iter().map(|(_, length)| length).sum();
    if length - sum <= ROUNDING * length {
        return None;
    }
    let mm = |length: f64| short(1e3 * length, 4);
    let named: Vec<&str> = others.iter().map(|(path, _)| *path).collect();
    let reach = match named.as_slice() {
        [rest @ .., last] if !rest.is_empty() => {
            format!("{} and {last} together reach", rest.join(", "))
        }
        all => format!("{} reaches", all.concat()),
    };
    Some(format!(
        "no position closes this loop: the joints of {longest} are {} mm apart, and {reach} {} mm. Change lengths by {} mm or more",
        mm(*length),
        mm(sum),
        mm(length - sum)
    ))
}

/// Starts and drives that state different positions.
pub(super) fn contradiction(message: Diagnostic, starts: &[Origin], system: &System) -> Diagnostic {
    let message = starts.iter().fold(message, |message, origin| {
        place(message, origin, "states the position")
    });
    let drive = system.elements.iter().find(|e| {
        let class = system.classes.get(e.class as usize);
        starts.contains(&e.origin) && class.is_some_and(|class| class.facts.rows_over_time)
    });
    message.with_help(match drive {
        Some(drive) => leave_to_drive(drive, system),
        None => "remove one of them, or replace it by a `guess`, where the search only begins"
            .to_owned(),
    })
}

/// The remedy if a drive states the position at the start, too: its angles or lengths.
fn leave_to_drive(drive: &Element, system: &System) -> String {
    let path = &drive.origin.path;
    let own = |parameter: &Parameter| {
        let name = (parameter.origin.path.strip_prefix(path.as_str()))?.strip_prefix('.')?;
        let of_place = [Dimension::ANGLE, Dimension::LENGTH].contains(&parameter.dimension);
        (of_place && !name.contains('.')).then(|| format!("`{name}:`"))
    };
    let names: Vec<String> = system.parameters.iter().filter_map(own).collect();
    let change = match names.as_slice() {
        [] => "change the motion of the drive".to_owned(),
        names => format!("state it as {} of the drive", names.join(" or ")),
    };
    format!(
        "the drive {path} states where its motion begins: leave the `start` of this freedom out, and {change}"
    )
}

/// A loop that closes only on the wrong branch.
pub(super) fn wrong_branch(
    message: Diagnostic,
    origin: &Origin,
    chain: Option<&Chain>,
    system: &System,
) -> Diagnostic {
    let message = place(message, origin, "assembled in another position");
    let message = with_markers(message, origin, system);
    let message = with_lengths(message, chain, system);
    let message = with_guesses(message, chain, system);
    with_angle(message, chain, system)
        .with_help(PLACING)
        .with_help(GUESSING)
        .with_help("or state another `branch` in the block of the joint")
}

/// Velocities of the start that contradict each other.
pub(super) fn start_velocity(
    mut message: Diagnostic,
    rows: &[NamedRow],
    chain: Option<&Chain>,
    system: &System,
) -> Diagnostic {
    for row in rows.iter().take(3) {
        message = place(message, &row.origin, "contradicts the others");
    }
    // the guide or the drive; rows of the start have no markers of their own
    if let Some(row) = rows.first() {
        message = with_markers(message, &row.origin, system);
        message = with_angle(message, chain, system);
    }
    let message = message.with_each(chain, |message, chain| {
        with_axes(message, chain).with_help(format!(
            "check that the joints of {chain} allow this motion; an axis may be turned by 90°, or a bore parallel to the axis of the crank"
        ))
    });
    message.with_help("a driven part and its start velocity must agree; leave one of them out")
}

/// A mechanism that reaches the end of its motion.
pub(super) fn locked(
    mut message: Diagnostic,
    rows: &[NamedRow],
    chain: Option<&Chain>,
    system: &System,
) -> Diagnostic {
    let mut places: Vec<&Origin> = Vec::new();
    for row in rows {
        if !places.contains(&&row.origin) && places.len() < 3 {
            places.push(&row.origin);
            message = place(message, &row.origin, "resists the others here");
        }
    }
    let message = with_lengths(message, chain, system);
    message.with_each(chain, with_axes).with_help(
        "change a length or an axis, or take a joint with fewer equations; forces play no part",
    )
}

/// The remedy if the assembly finds no position.
const PLACING: &str = "check the lengths, sides and axes of the loop; for a marker `at(…, z:)` without `x:`, Eng chooses the x axis";

/// The remedy if the search begins at a wrong place.
const GUESSING: &str =
    "if they are right, state a `guess` near the position: the search begins there";

/// The largest number of parameters that a message points to. A choice: more places hide the likely ones.
pub(super) const MOST_PARAMETERS: usize = 3;

/// The largest number of markers that a message points to. A choice: two for each side of a triangle.
const MOST_MARKERS: usize = 6;

/// Adds the lengths of a loop and the parameters that decide them.
fn with_lengths(message: Diagnostic, chain: Option<&Chain>, system: &System) -> Diagnostic {
    let Some(chain) = chain else {
        return message;
    };
    // bodies with both joints on one axis have a length of rounding, and none that a message could name
    let lengths: Vec<String> = chain
        .bodies
        .iter()
        .filter(|body| body.length > 1e-9)
        .map(|body| format!("{} {} mm", body.origin.path, short(1e3 * body.length, 4)))
        .collect();
    let message = match lengths.is_empty() {
        true => message,
        false => message.with_note(format!(
            "lengths of the bodies in the loop, from joint to joint, perpendicular to the axis of the loop: {}",
            lengths.join(", ")
        )),
    };
    let mut shown = Vec::new();
    let message = chain
        .bodies
        .iter()
        // a length of rounding; see above
        .filter(|body| body.length > 1e-9)
        .flat_map(|body| body.parameters.iter().map(move |p| (body, *p)))
        .fold(message, |message, (body, index)| {
            let Some(parameter) = system.parameters.get(index as usize) else {
                return message;
            };
            match parameter.origin.used_at {
                Some(at) if !shown.contains(&index) && shown.len() < MOST_PARAMETERS => {
                    shown.push(index);
                    message.also(span(at), format!("a length of {}", body.origin.path))
                }
                _ => message,
            }
        });
    // a length written as a number is at the marker in the text
    let written = chain.bodies.iter();
    let written = written.filter(|body| body.parameters.is_empty() && body.length > 1e-9);
    written
        .flat_map(|body| body.markers.iter().map(move |marker| (body, marker)))
        .filter(|(body, marker)| marker.path != format!("{}.origin", body.origin.path))
        .filter_map(|(body, marker)| Some((body, marker, marker.used_at?)))
        .take(MOST_MARKERS)
        .fold(message, |message, (body, marker, at)| {
            let length = short(1e3 * body.length, 4);
            message.also(
                span(at),
                format!(
                    "{}: an end of the {length} mm of {}",
                    marker.path, body.origin.path
                ),
            )
        })
}

/// Adds the places of an element's markers. Their positions and axes decide whether the loop closes.
pub(super) fn with_markers(message: Diagnostic, element: &Origin, system: &System) -> Diagnostic {
    let mut elements = system.elements.iter();
    let Some(element) = elements.find(|e| e.origin.path == element.path) else {
        return message;
    };
    let markers = element.markers.iter();
    let stated = markers.filter_map(|m| {
        let marker = system.markers.get(*m as usize)?;
        Some((marker, marker.origin.used_at?))
    });
    stated.fold(message, |message, (marker, at)| {
        let label = format!(
            "{}: a marker of {}",
            marker.origin.path, element.origin.path
        );
        message.also(span(at), label)
    })
}

/// The largest number of starts that a message points to. A choice.
const MOST_STARTS: usize = 3;

/// The starts of positions that must hold, with their places: those of the bodies of a loop, or all without a loop.
fn starts<'a>(chain: Option<&Chain>, system: &'a System) -> Vec<(&'a Origin, Location)> {
    let in_loop = |marker: &u32| {
        let body = system
            .markers
            .get(*marker as usize)
            .map(|marker| marker.body);
        let Some(BodyRef::Body(body)) = body else {
            return false;
        };
        let body = system.bodies.get(body as usize);
        chain.is_none_or(|chain| {
            let mut bodies = chain.bodies.iter();
            body.is_some_and(|body| bodies.any(|other| other.origin == body.origin))
        })
    };
    let elements = system.elements.iter();
    elements
        .filter(|e| e.role == Role::StartPosition { exact: true })
        .filter(|e| e.markers.iter().any(in_loop))
        .filter_map(|e| Some((&e.origin, e.origin.used_at?)))
        .collect()
}

/// The largest number of guesses that a message points to. A choice.
const MOST_GUESSES: usize = 4;

/// Adds the guesses of the text: those for the bodies of the loop, or all guesses if these bodies have none.
/// The assembly begins there, so a wrong guess can lead to a wrong position.
fn with_guesses(message: Diagnostic, chain: Option<&Chain>, system: &System) -> Diagnostic {
    let guesses = system.elements.iter();
    let guesses = guesses.filter(|e| e.role == Role::StartPosition { exact: false });
    let body_of = |marker: u32| match system.markers.get(marker as usize)?.body {
        BodyRef::Body(body) => Some(body),
        BodyRef::Ground => None,
    };
    let of_elements = guesses.filter_map(|guess| {
        let bodies = guess.markers.iter();
        let body = bodies
            .filter_map(|m| body_of(*m))
            .find_map(|body| system.bodies.get(body as usize));
        Some((body.map(|body| &body.origin), guess.origin.used_at?))
    });
    let of_bodies = system.bodies.iter().flat_map(|body| {
        let places = body.guessed_at.iter();
        places.map(move |at| (Some(&body.origin), *at))
    });
    let stated: Vec<(Option<&Origin>, Location)> = of_bodies.chain(of_elements).collect();
    let in_loop = |body: &Option<&Origin>| {
        body.is_some_and(|body| chain.is_some_and(|c| c.bodies.iter().any(|b| b.origin == *body)))
    };
    let any = stated.iter().any(|(body, _)| in_loop(body));
    let chosen = stated.iter().filter(|(body, _)| !any || in_loop(body));
    chosen
        .take(MOST_GUESSES)
        .fold(message, |message, (body, at)| {
            let of = body.map_or(String::new(), |body| format!(" of {}", body.path));
            message.also(span(*at), format!("a guess{of}: the search begins here"))
        })
}

/// Adds the z axes of the joints of a loop.
fn with_axes(message: Diagnostic, chain: &Chain) -> Diagnostic {
    let axes: Vec<String> = chain
        .joints
        .iter()
        .filter_map(|(joint, axis)| {
            let [x, y, z] = axis.as_ref()?.map(|x| fixed(x, 3));
            Some(format!("{} ({x}, {y}, {z})", joint.path))
        })
        .collect();
    message.with_note(format!(
        "z axes of the joints, in the axes of the ground: {}",
        axes.join("; ")
    ))
}

/// Two axes are parallel from this cosine on: 2.6°. A choice: axes that are meant to be parallel differ by
/// less.
const PARALLEL: f64 = 0.999;
/// An axis is not perpendicular to another if it deviates by an angle of at least this sine, one degree. A
/// choice.
const NOT_SQUARE: f64 = 0.0175;

fn joint(of: &Origin, system: &System) -> Joint {
    let mut elements = system.elements.iter();
    let element = elements.find(|e| e.origin.path == of.path);
    let class = element.and_then(|e| system.classes.get(e.class as usize));
    class.map_or(Joint::Other, Joint::of)
}

/// Adds a guide that is not perpendicular to the hinges of its loop, or a hinge that is not parallel to them,
/// with the angle between the axes. The axis of the hinges is the one that most of them share.
fn with_angle(message: Diagnostic, chain: Option<&Chain>, system: &System) -> Diagnostic {
    let joints: Vec<(&str, &[f64; 3], Joint)> = chain
        .into_iter()
        .flat_map(|chain| &chain.joints)
        .filter_map(|(of, axis)| Some((of.path.as_str(), axis.as_ref()?, joint(of, system))))
        .collect();
    let cosine =
        |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>().abs();
    let hinges = || joints.iter().filter(|(.., joint)| *joint == Joint::Hinge);
    let along = |axis: &[f64; 3]| {
        let same = hinges().filter(|(_, other, _)| cosine(axis, other) > PARALLEL);
        same.map(|(path, ..)| *path).collect::<Vec<_>>()
    };
    let Some((paths, shared)) = hinges()
        .map(|(_, axis, _)| (along(axis), *axis))
        .max_by_key(|(paths, _)| paths.len())
        .filter(|(paths, _)| paths.len() > 1)
    else {
        return message;
    };
    let wrong = joints.iter().find_map(|(path, axis, joint)| {
        let cosine = cosine(axis, shared);
        let (what, due) = match joint {
            Joint::Guide if cosine > NOT_SQUARE => ("guide", "perpendicular (90°)"),
            Joint::Hinge if cosine < PARALLEL => ("hinge", "parallel (0°)"),
            _ => return None,
        };
        let angle = fixed(libm::acos(cosine.min(1.0)).to_degrees(), 1);
        Some(format!(
            "the axis of the {what} {path} is at {angle}° to that of {}: in a plane loop it must be {due}",
            paths.join(", ")
        ))
    });
    message.note_if(wrong)
}
