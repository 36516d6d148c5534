//! Lints of the assembled machine: markers far apart, swapped pins and shells, bodies that nothing holds.

use super::{Finding, short};
use crate::codes;
use eng_runtime::assembly::rows;
use eng_runtime::chain::MarkerKinematics;
use eng_runtime::loose::{Loose, loose};
use eng_runtime::model::Model;
use eng_runtime::rotation::V3;
use eng_runtime::state::State;
use eng_system::Dimension;
use eng_system::lint;
use eng_system::system::{Origin, Role};

/// A speed below this share of the other counts as zero. A choice above the effect of small tilts.
const STANDS: f64 = 1e-3;
/// The pin counts as the part that does not turn if its speed is below this share of the shell's. A choice:
/// in most films one of both does not turn at all.
const SLOWER: f64 = 0.5;
/// Share of the cycle's speed below which a shell swings with a rod and does not turn with a shaft. A rod
/// that is twice as long as its throw reaches it at a dead centre, and most rods are longer.
const SWINGS: f64 = 0.5;
/// Least offset along a line, in radii of gyration, of two bodies that are beside each other. For a piston
/// under gas the offset counts in bores: rods that share a pin are an eighth of a bore to its sides, and a
/// small end with a width of a quarter of a bore would touch the pin's bosses. Twice a radius of gyration is
/// a choice: a body ends at about that.
const BESIDE: f64 = 2.0;
const BESIDE_IN_BORES: f64 = 0.2;
/// A body does not turn if its speed is below this share of the cycle's. A choice: gears and chains of
/// engines have ratios far above it, and a start at rest leaves only rounding.
const STANDS_STILL: f64 = 0.01;
/// A body falls in a direction with at least this share of gravity. A choice: directions across gravity are
/// so by construction, up to a slight slope.
const FALLS: f64 = 0.1;
/// A direction is across an axis of rotation if its part along the axis is below this share. A choice, 6°.
const ACROSS: f64 = 0.1;
/// A part of a direction below this share counts as zero in texts of two digits.
const NO_PART: f64 = 5e-4;
/// A slide without a stated position gets a message from this distance (m) on. A choice: nearer ones are at
/// the place that was meant.
const UNPLACED: f64 = 0.01;

/// A model at its start.
pub(super) struct Start<'a> {
    pub model: &'a Model,
    pub state: &'a State,
}

/// The probable mistakes in an assembled model.
pub(super) fn assembled(start: &Start<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    for element in 0..start.model.elements.len() {
        if start.model.elements[element].dynamic {
            found.extend(start.beside(element));
            found.extend(start.unplaced(element));
            found.extend(start.slips(element));
            found.extend(start.between_welded(element));
            found.extend(start.measured_and_loaded(element));
        }
    }
    found.extend(start.swapped());
    found.extend(start.askew());
    found.extend(start.useless());
    found.extend(start.loose());
    found.extend(start.sinks().or_else(|| start.pushed_down()));
    found
}

pub(super) fn mm(x: f64) -> String {
    short(1e3 * x, 3)
}

pub(super) fn rpm(x: f64) -> String {
    // a rounding error is no motion
    let x = if x.abs() < 1e-6 { 0.0 } else { x };
    short(x * 30.0 / std::f64::consts::PI, 4)
}

/// A direction in words.
fn axis(direction: &V3) -> String {
    let names = ["x", "y", "z"];
    // 2.6° of an axis: its name is clearer than its numbers. A choice
    match (0..3).find(|i| direction[*i].abs() > 0.999) {
        Some(i) => names[i].to_owned(),
        None => {
            // the null space has rounding of some 1e-16
            let part = |i: usize| match direction[i].abs() > NO_PART {
                true => short(direction[i], 2),
                false => "0".to_owned(),
            };
            let [a, b, c] = [0, 1, 2].map(part);
            format!("[{a}, {b}, {c}]")
        }
    }
}

impl Start<'_> {
    pub(super) fn origin(&self, element: usize) -> &Origin {
        &self.model.compiled.system.elements[element].origin
    }

    pub(super) fn finding(
        &self,
        code: &'static str,
        name: &str,
        element: usize,
        message: String,
    ) -> Finding {
        Finding {
            code,
            name: name.to_owned(),
            // the mistake is not in the class
            origin: Origin {
                defined_at: None,
                ..self.origin(element).clone()
            },
            message,
            ..Finding::default()
        }
    }

    pub(super) fn marker(&self, marker: usize) -> MarkerKinematics {
        rows::marker(self.model, marker, &self.state.pose, &self.state.velocity)
    }

    pub(super) fn path(&self, marker: usize) -> &str {
        &self.model.compiled.system.markers[marker].origin.path
    }

    /// The markers of an element with two markers.
    pub(super) fn pair(&self, element: usize) -> Option<[usize; 2]> {
        match self.model.elements[element].markers.as_slice() {
            [a, b] => Some([*a, *b]),
            _ => None,
        }
    }

    /// Radius of gyration of a marker's body (m); none for the ground and flexible bodies.
    fn gyration(&self, marker: usize) -> Option<f64> {
        let body = &self.model.bodies[self.model.markers[marker].body?];
        let about_center =
            body.inertia().diagonal().max() - body.mass() * body.center().norm_squared();
        (body.modes() == 0 && body.mass() > 0.0)
            .then(|| libm::sqrt(about_center.max(0.0) / body.mass()))
    }

    /// A point on a line that is far from the other marker and never moves along the line: a rod beside its
    /// piston.
    fn beside(&self, element: usize) -> Option<Finding> {
        let rows = &self.model.class(element).rows;
        let on_line = rows.len() == 2 && rows.iter().all(|row| row.dimension == Dimension::LENGTH);
        let markers = self.pair(element).filter(|_| on_line)?;
        let [a, b] = markers.map(|marker| self.marker(marker));
        let offset = a.position - b.position;
        let size = offset.norm();
        let radius = markers
            .iter()
            .filter_map(|marker| self.gyration(*marker))
            .fold(f64::INFINITY, f64::min);
        let moves = a.velocity.norm() + b.velocity.norm();
        let of_b = b.velocity + (b.rotation * b.angular_velocity).cross(&offset);
        let along = (a.velocity - of_b).dot(&offset).abs() / size;
        let bore = self
            .bore(&markers)
            .map_or(f64::INFINITY, |bore| BESIDE_IN_BORES * bore);
        let far = (BESIDE * radius).min(bore);
        if !(size > far && far > 0.0 && moves > 0.0 && along < STANDS * moves) {
            return None;
        }
        let message = format!(
            "{} is {} mm beside {}, along the axis of the joint",
            self.path(markers[0]),
            mm(size),
            self.path(markers[1])
        );
        let mut finding = self.finding(codes::APART, lint::APART, element, message);
        finding.help = "are these markers of the same cylinder or bearing?".to_owned();
        let places = markers.map(|m| self.model.compiled.system.markers[m].origin.clone());
        super::decide(&mut finding, places.into());
        Some(finding)
    }

    /// The bore (m) of the gas on a piston, if one of the markers is on this piston.
    fn bore(&self, markers: &[usize; 2]) -> Option<f64> {
        let body = |marker: &usize| self.model.markers[*marker].body;
        let firings = &self.model.compiled.system.firings;
        let own = firings.iter().find(|firing| {
            let gas = &self.model.elements[firing.element as usize].markers;
            let piston = gas.get(firing.piston as usize).and_then(body);
            piston.is_some() && markers.iter().any(|marker| body(marker) == piston)
        })?;
        Some(self.model.slot(own.bore))
    }

    /// A slide that only its guide places. It is far from the other marker, because the text states no
    /// position along the guide.
    fn unplaced(&self, element: usize) -> Option<Finding> {
        let system = &self.model.compiled.system;
        let rows = self.model.class(element).rows.len();
        let markers = self.pair(element).filter(|_| (2..6).contains(&rows))?;
        let body = self.model.markers[markers[0]]
            .body
            .or(self.model.markers[markers[1]].body)?;
        let info = system.bodies.get(body)?;
        let touches = |e: usize| {
            (self.model.elements[e].markers.iter())
                .any(|m| self.model.markers[*m].body == Some(body))
        };
        let placed = (0..self.model.elements.len()).any(|e| {
            let of_start = matches!(system.elements[e].role, Role::StartPosition { .. });
            let holds = self.model.constrains(e);
            // the assembly puts a pin into the middle of its shell, and a contact to its reach
            let places = !system.elements[e].places.is_empty();
            e != element && touches(e) && (of_start || holds || places)
        });
        if info.position.is_some() || placed {
            return None;
        }
        let [a, b] = markers.map(|marker| self.marker(marker));
        let offset = (a.position - b.position).norm();
        (offset > UNPLACED).then(|| {
            let message = format!(
                "{} has no stated position, so it begins at the origin; {} is then {} mm from {}",
                info.origin.path,
                self.path(markers[0]),
                mm(offset),
                self.path(markers[1])
            );
            let mut finding = self.finding(codes::APART, lint::APART, element, message);
            finding.help = format!(
                "state it: `start position = […] mm` in `{}`, or `guess`",
                info.origin.path
            );
            finding
        })
    }

    /// Journals whose shell turns in a pin that does not.
    fn swapped(&self) -> Vec<Finding> {
        let system = &self.model.compiled.system;
        let mut found = Vec::new();
        for journal in &system.journals {
            let element = journal.element as usize;
            let own = &self.model.elements[element].markers;
            let (Some(pin), Some(shell)) = (
                own.get(journal.pin as usize),
                own.get(journal.shell as usize),
            ) else {
                continue;
            };
            let [a, b] = [*pin, *shell].map(|marker| self.marker(marker));
            let about = b.rotation.column(2).into_owned();
            let [of_pin, of_shell] =
                [a, b].map(|m| (m.rotation * m.angular_velocity).dot(&about).abs());
            // a rod turns slower than its crank, and swings about a wrist pin that does not turn at all
            let swings = SWINGS * self.cycle_speed().unwrap_or(0.0);
            if of_pin >= SLOWER * of_shell || of_shell < swings.max(1.0) {
                continue;
            }
            let message = format!(
                "the shell {} turns at {} rpm, the pin {} at {} rpm: are pin and shell swapped?",
                self.path(*shell),
                rpm(of_shell),
                self.path(*pin),
                rpm(of_pin)
            );
            found.push(self.finding(codes::SWAPPED, lint::SWAPPED, element, message));
        }
        found
    }

    /// Bodies that nothing holds in some direction.
    fn loose(&self) -> Vec<Finding> {
        // if it cannot be evaluated, the run reports the error
        let Ok(found) = loose(self.model, self.state) else {
            return Vec::new();
        };
        let on_ground = self.joined_to_ground();
        found
            .iter()
            .filter(|motion| motion.bodies.iter().all(|b| on_ground[*b]))
            .filter(|motion| self.is_asked_for(motion))
            .map(|motion| self.loose_motion(motion))
            .collect()
    }

    /// Whether the model should prevent this motion. A machine with a cycle, and a shaft on films, should
    /// only turn.
    fn is_asked_for(&self, motion: &Loose) -> bool {
        let system = &self.model.compiled.system;
        let cycle = self.cycle_speed().is_some();
        // weight or spin may hold a body that swings about an axis, but not a body at rest while the machine
        // turns: a shaft without its gear
        if matches!(motion.about, Some((_, true))) {
            let slow = STANDS_STILL * self.cycle_speed().unwrap_or(0.0);
            return cycle && motion.bodies.iter().all(|body| self.spin_of(*body) < slow);
        }
        // a rotor that turns freely coasts, or a torque drives it, if its start states the speed
        if let Some((axis, _)) = motion.about
            && (motion.bodies.iter()).all(|body| self.spin_about(*body, &axis) > 1.0)
        {
            return false;
        }
        // the rotation of its carrier holds a pendulum that moves across the axis of rotation
        if let Some(along) = motion.along
            && (motion.bodies.iter()).all(|body| {
                let spin = self.spin_of(*body);
                spin > 1.0 && self.spin_about(*body, &along) < ACROSS * spin
            })
        {
            return false;
        }
        // another message reports a body that moves in all directions
        if motion.directions == 3 {
            return false;
        }
        // a shaft that turns and falls along its axis
        if let Some(along) = motion.along
            && along.dot(&self.gravity()).abs() > FALLS * self.gravity().norm()
            && motion.bodies.iter().any(|body| self.spin_of(*body) > 1.0)
        {
            return true;
        }
        let of_film = system.journals.iter().any(|journal| {
            let own = &self.model.elements[journal.element as usize].markers;
            own.iter().any(|m| {
                let body = self.model.markers[*m].body;
                body.is_some_and(|body| motion.bodies.contains(&body))
            })
        });
        of_film || cycle
    }

    /// Angular speed of a body about an axis (inertial, unit length) at the start (rad/s).
    fn spin_about(&self, body: usize, axis: &V3) -> f64 {
        let body = &self.model.bodies[body];
        let rates = &self.state.velocity[body.velocity + 3..body.velocity + 6];
        let rotation = body.frame(&self.state.pose).rotation;
        (rotation * V3::from_column_slice(rates)).dot(axis).abs()
    }

    /// Angular speed of a body at the start (rad/s).
    pub(super) fn spin_of(&self, body: usize) -> f64 {
        let first = self.model.bodies[body].velocity;
        V3::from_column_slice(&self.state.velocity[first + 3..first + 6]).norm()
    }

    pub(super) fn gravity(&self) -> V3 {
        V3::from(
            self.model
                .compiled
                .system
                .gravity
                .map(|slot| self.model.slot(slot)),
        )
    }

    fn loose_motion(&self, motion: &Loose) -> Finding {
        let system = &self.model.compiled.system;
        let origin = |body: &usize| &system.bodies[*body].origin;
        let first = origin(&motion.bodies[0]).clone();
        let directions = match (&motion.along, &motion.about, motion.motions) {
            (Some(direction), _, _) => format!("along {}", axis(direction)),
            (_, Some((direction, _)), _) => format!("about {}", axis(direction)),
            (_, _, count) => format!("in {count} directions"),
        };
        let others: Vec<&str> = motion.bodies[1..]
            .iter()
            .map(|body| origin(body).path.as_str())
            .collect();
        let with = match others.as_slice() {
            [] => String::new(),
            others => format!("; with it move {}", super::listed(others)),
        };
        Finding {
            code: codes::LOOSE,
            name: lint::LOOSE.to_owned(),
            origin: first,
            message: format!("no joint, spring or film holds this body {directions}{with}"),
            label: "moves freely".to_owned(),
            help: "hold it by a joint, a spring or a film; a shaft on films needs a thrust bearing: a joint that \
                   holds it along its axis"
                .to_owned(),
 ..Finding::default()
}
    }

    /// Whether each body is connected with the ground. The compiler reports the others.
    fn joined_to_ground(&self) -> Vec<bool> {
        let ground = self.model.bodies.len();
        let mut group: Vec<usize> = (0..=ground).collect();
        for element in self.model.elements.iter().filter(|e| e.dynamic) {
            let bodies: Vec<usize> = (element.markers.iter())
                .map(|m| self.model.markers[*m].body.unwrap_or(ground))
                .collect();
            for pair in bodies.windows(2) {
                let (from, to) = (group[pair[0]], group[pair[1]]);
                group
                    .iter_mut()
                    .filter(|g| **g == from)
                    .for_each(|g| *g = to);
            }
        }
        group
            .iter()
            .take(ground)
            .map(|g| *g == group[ground])
            .collect()
    }
}
