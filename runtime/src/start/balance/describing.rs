//! Descriptions of the obstacles to a balance, and of the forces on held directions.

use super::{Balance, Place, Stop, UNHELD};
use crate::body::BodyModel;
use crate::error::Undefined;
use crate::model::Model;
use crate::start::motion::NoMotion;
use crate::start::{Held, Obstacle};
use eng_system::system::Origin;
use nalgebra::DVector;

impl Balance<'_> {
    /// The body or constraint whose residual is largest.
    pub(super) fn worst(&self, residual: &DVector<f64>) -> (Origin, String) {
        let model = self.model;
        let n = model.velocities;
        let row =
            residual
                .iter()
                .take(n + model.rows)
                .enumerate()
                .fold((0, 0.0_f64), |best, (i, r)| {
                    if r.abs() > best.1 { (i, r.abs()) } else { best }
                });
        if row.0 < n {
            for body in &model.bodies {
                if (body.velocity..body.velocity + body.width()).contains(&row.0) {
                    let what = match row.0 - body.velocity {
                        0..3 => "forces",
                        3..6 => "torques",
                        _ => "bending",
                    };
                    return (body.origin.clone(), format!("its {what} find no balance"));
                }
            }
        } else if let Some((element, local)) = model.row_owner(row.0 - n) {
            let named = model.named_row(element, local, row.1);
            return (named.origin, format!("{} does not close", named.equation));
        }
        (Origin::default(), "nothing moves".to_owned())
    }

    /// A body that nothing holds against its load, and so has no steady motion.
    pub(super) fn unheld(&self, place: &Place) -> Option<Obstacle> {
        let first = self.holding.len();
        (0..self.neutral.nrows()).find_map(|k| {
            let effort = place.efforts.get(first + k)?;
            let row = self.neutral.row(k);
            let share = |body: &BodyModel| row.columns(body.velocity, body.width()).norm();
            let body = self
                .model
                .bodies
                .iter()
                .max_by(|a, b| share(a).total_cmp(&share(b)))?;
            let part = |first: usize| row.columns(body.velocity + first, 3).norm();
            let message = if part(3) > part(0) {
                "it turns freely, and nothing drives it against its load"
            } else {
                "it moves freely, and nothing holds it against its load"
            };
            (effort.abs() > UNHELD[usize::from(self.again)]).then(|| Obstacle {
                origin: body.origin.clone(),
                message: message.to_owned(),
                carried: 0.0,
            })
        })
    }

    /// The held directions with their forces, by their rows.
    pub(super) fn held_directions(&self, place: &Place) -> Vec<Held> {
        let model = self.model;
        let owners: Vec<(Origin, bool)> = self
            .stated
            .owners
            .iter()
            .map(|(element, row)| {
                let named = model.named_row(*element, *row, 0.0);
                (named.origin, named.is_length)
            })
            .chain(self.fixed_names.iter().cloned())
            .collect();
        let mut held: Vec<Held> = Vec::new();
        for (k, i) in self.holding.iter().enumerate() {
            let Some((origin, is_length)) = owners.get(*i).cloned() else {
                continue;
            };
            let effort = -place.efforts[k] * self.factors[*i] * self.unit;
            // a smaller effort is below a millionth of the inertia of the motion: it comes from the end of
            // the iterations, and a report of it would hide those that matter. A choice
            if effort.abs() * (if is_length { model.length } else { 1.0 }) > 1e-6 * self.unit {
                held.push(Held {
                    origin,
                    effort,
                    is_length,
                });
            }
        }
        held
    }
}

pub(super) fn locked(model: &Model, error: NoMotion) -> Stop {
    match error {
        NoMotion::Singular => Stop::Obstacle(Obstacle {
            origin: Origin {
                path: model.compiled.system.name.clone(),
                ..Origin::default()
            },
            message: "its velocities are not determined at the start: the mechanism is in a position where it locks".to_owned(),
            carried: 0.0,
        }),
        NoMotion::Error(error) => error.into(),
    }
}

/// The reason for an element's force that is no number.
pub(super) fn no_number(because: &Option<Box<Undefined>>) -> String {
    match because {
        Some(because) => because.to_string(),
        None => "its force is no number here".to_owned(),
    }
}

pub(super) fn not_finite(model: &Model) -> Stop {
    Stop::Obstacle(Obstacle {
        origin: Origin {
            path: model.compiled.system.name.clone(),
            ..Origin::default()
        },
        message: "its stiffness at the start is no number".to_owned(),
        carried: 0.0,
    })
}
