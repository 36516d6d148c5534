//! The start of flexible bodies that turn: a motion that repeats, at equal parts of its period.
//!
//! In the axes of a turning body a load fixed in space turns, and a load that turns with the body is
//! constant. The two cause different bending: with ȧ = 0 and ä = 0 the sag of a shaft under its weight would
//! be too large by the factor `1/(1 − Ω²/ω²)`. The repeating motion distinguishes them. Its positions q_j at
//! N equal parts of the period T obey
//!
//! ```text
//! M v̇_j − Q(q_j, v_j) + Gᵀλ_j + Eᵀσ_j = 0        Φ(q_j) = 0        E_j δq_j = 0
//! v_j = w_j − Hᵀ(HHᵀ)⁻¹(H w_j + c)               v̇ = D v
//! ```
//!
//! w_j are the rates along the positions themselves (`ṙ = D r`, `ω = 2 q̄ ∘ D q`, `ȧ = D a`, D the derivative
//! of [`derivative`]), H and c the conditions on velocities: `Φ̇ = 0` and stated speeds
//! (`SteadyMotion::along_path`). All velocities are scaled in this projection. Loads of each order have their
//! own flexibility: `(k − Ω²n)⁻¹` if they turn with the body, `(k − Ω²n − Ω²m + iΩ(d + Ωg))⁻¹` if they are
//! fixed in space, with the body's stiffness k, centrifugal softening Ω²n, modal mass m, damping d and
//! gyroscopic matrix Ωg at the speed Ω. Orders from N/2 on are quasi-static.
//!
//! Newton's method solves all angles together with [`krylov::gmres`]. The preconditioner is the matrix of the
//! balance at each angle without the centrifugal softening, which would make it singular when the speed
//! equals a frequency.
//!
//! In films the motion is integrated instead ([repeating]).

mod angles;
pub(crate) mod derivative;
pub(crate) mod krylov;
mod mean_speeds;
mod path;
mod repeating;
mod reused;
mod tangent;

use super::{Balance, Place, Stop};
use crate::start::motion::NoMotion;
use crate::start::{Equilibrium, Turning};
use crate::state::State;
use angles::Angles;
use eng_system::system::Origin;
use path::Path;

/// Share of the motion's rate above which a body turns. Slower turns are rounding, or come from the tilt of a
/// leaning shaft. A choice: bodies that turn a million times slower than the others have no bending by it.
const TURNS: f64 = 1e-6;

/// The reason for a missing repeating motion.
#[derive(Debug)]
pub(super) enum NoOrbit {
    /// A reason.
    Reason(String),
    /// The model cannot be evaluated.
    Stop(Stop),
}

impl NoOrbit {
    /// The reason in words; an error is returned as such.
    fn reason(self) -> Result<String, Stop> {
        match self {
            NoOrbit::Reason(reason) => Ok(reason),
            NoOrbit::Stop(Stop::Obstacle(stop)) => {
                Ok(format!("{}: {}", stop.origin.path, stop.message))
            }
            NoOrbit::Stop(error) => Err(error),
        }
    }
}

impl<E: Into<Stop>> From<E> for NoOrbit {
    fn from(error: E) -> NoOrbit {
        NoOrbit::Stop(error.into())
    }
}

fn singular(error: NoMotion) -> NoOrbit {
    match error {
        NoMotion::Singular => {
            NoOrbit::Reason("its velocities are not determined at every angle of a turn".to_owned())
        }
        NoMotion::Error(error) => NoOrbit::Stop(error.into()),
    }
}

impl Balance<'_> {
    /// Whether a flexible body turns in the steady motion.
    pub(super) fn turns(&self) -> bool {
        self.turning_body().is_some()
    }

    fn turning_body(&self) -> Option<&Origin> {
        let fast = |x: &[f64], motion_rate: f64| x.iter().any(|x| x.abs() > TURNS * motion_rate);
        let found = self.model.bodies.iter().find(|body| {
            let turn = body.velocity + 3..body.velocity + 6;
            body.modes() > 0
                && (fast(&self.velocity[turn.clone()], self.motion_rate)
                    || fast(
                        &self.acceleration[turn],
                        self.motion_rate * self.motion_rate,
                    ))
        });
        found.map(|body| &body.origin)
    }

    /// Brings a state with turning flexible bodies into the repeating motion. Without such a motion it takes
    /// the balance in which all loads turn with the bodies.
    pub(super) fn turning(&mut self, state: &mut State) -> Result<Equilibrium, Stop> {
        if !self.model.compiled.system.journals.is_empty() {
            return self.turning_in_films(state);
        }
        let (place, mut found, obstacle) = match self.balanced(state) {
            Ok((place, found)) => (place, found, None),
            Err(Stop::Obstacle(obstacle)) => {
                let place = self.assembled(state)?;
                (place, self.nothing_found(), Some(obstacle))
            }
            Err(error) => return Err(error),
        };
        let orbit = self.orbit(&place, &mut found);
        self.turned = None;
        let reason = match orbit {
            Ok(orbit) => {
                found.turning = Some(orbit.turning);
                found.portions = found.portions.max(1);
                self.velocity = orbit.velocity;
                self.acceleration = orbit.acceleration;
                return self.adopt(state, &orbit.place, found);
            }
            Err(none) => none.reason()?,
        };
        if let Some(mut obstacle) = obstacle {
            obstacle.message = format!("{}; {reason}", obstacle.message);
            return Err(Stop::Obstacle(obstacle));
        }
        let origin = self.turning_body().cloned().unwrap_or_default();
        found.turning = Some(Turning::WithTheBody { origin, reason });
        self.adopt(state, &place, found)
    }

    /// The start in films. The motion is integrated from a balance without the inertia of bending. With this
    /// inertia there may be no balance when the speed is near a frequency.
    fn turning_in_films(&mut self, state: &mut State) -> Result<Equilibrium, Stop> {
        self.softened = false;
        let begun = self.balanced(state);
        self.softened = true;
        let reason = match begun {
            Ok((place, mut found)) => match self.follow(&place) {
                Ok(followed) => {
                    found.turning = Some(followed.turning);
                    self.velocity = followed.velocity;
                    return self.adopt(state, &followed.place, found);
                }
                Err(none) => none.reason()?,
            },
            Err(Stop::Obstacle(stop)) => format!("{}: {}", stop.origin.path, stop.message),
            Err(error) => return Err(error),
        };
        let (place, mut found) = self.balanced(state)?;
        let origin = self.turning_body().cloned().unwrap_or_default();
        found.turning = Some(Turning::WithTheBody { origin, reason });
        self.adopt(state, &place, found)
    }

    /// The repeating motion, from a position in it.
    fn orbit(&mut self, place: &Place, found: &mut Equilibrium) -> Result<Orbit, NoOrbit> {
        let path = Path::new(self, place)?;
        let mut coarse = Angles::along(self, &path, 2, place)?;
        coarse.solve(self, found)?;
        let mut fine = coarse.refined(self, &path)?;
        fine.solve(self, found)?;
        let change = fine.change(self.model, &coarse);
        Ok(fine.first(self, path.period, change))
    }
}

/// The start of the repeating motion.
struct Orbit {
    place: Place,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    turning: Turning,
}
