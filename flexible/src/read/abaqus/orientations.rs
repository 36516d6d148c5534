//! `*ORIENTATION`: the axes of materials and couplings.

use super::frames::{Motion, STILL, Transform, about};
use super::lines::{Row, key};
use super::model::Model;
use super::scope::Block;
use crate::error::FileProblem;
use crate::mesh::{Carries, Code, Coordinates, LocalAxes};
use crate::read::number;
use crate::read::unread::UnreadCards;
use crate::read::vector::{IDENTITY, Rotation, product};

/// The axes of an `*ORIENTATION`.
pub(super) struct Orientation {
    points: Transform,
    /// Rotation of the axes within those of the points.
    turn: Rotation,
    motion: Motion,
}

impl Orientation {
    /// The `*ORIENTATION` with a name, of the same place as its user. Without axes that Eng reads it is noted, and the
    /// answer is `None`.
    ///
    /// # Errors
    /// No such orientation, text in the place of a number.
    pub fn named(
        (model, code): (&Model, Code),
        place: usize,
        name: &str,
        user: &Block,
        unread: &mut UnreadCards,
    ) -> Result<Option<Self>, FileProblem> {
        let found = model.blocks().find(|(of, block)| {
            let keyword = &block.keyword;
            let own = keyword.get("NAME").map(key);
            *of == place && keyword.key == "ORIENTATION" && own == Some(key(name))
        });
        let Some((_, block)) = found else {
            return Err(user.keyword.problem(
                &format!("the orientation {name} is missing"),
                "add its *ORIENTATION, or correct the name",
            ));
        };
        let keyword = &block.keyword;
        let motion = model.places.get(place).map(|placed| placed.motion());
        let rows: Vec<&Row> = block.rows.iter().filter(|row| !row.is_blank()).collect();
        let told = match (keyword.choice("DEFINITION").as_str(), rows.as_slice()) {
            ("" | "COORDINATES", [first, others @ ..]) if others.len() <= 1 => {
                let text = first.text(0);
                match text.is_empty() || number::real(text).is_some() {
                    true => Self::read(block, (*first, others.first().copied()), code)?,
                    false => Err("*ORIENTATION by a distribution"),
                }
            }
            ("" | "COORDINATES", []) => Transform::of_orientation(keyword, &block.rows)
                .map(|_| Err("*ORIENTATION without points"))?,
            _ => Err("*ORIENTATION of more than two points"),
        };
        match told {
            Ok((points, turn)) => Ok(Some(Orientation {
                points,
                turn,
                motion: motion.unwrap_or(STILL),
            })),
            Err(name) => {
                unread.note(name, &keyword.at, Carries::Structure);
                Ok(None)
            }
        }
    }

    /// The points `a, b[, c]` and the second line `axis, degrees`, which turns the axes about one of them. Abaqus takes c as
    /// the origin of a and b in a rectangular system. CalculiX reads no third point, and turns only rectangular axes.
    /// The inner error names what is not read.
    fn read(
        block: &Block,
        (first, second): (&Row, Option<&Row>),
        code: Code,
    ) -> Result<Result<(Transform, Rotation), &'static str>, FileProblem> {
        let Some(points) = Transform::of_orientation(&block.keyword, &block.rows)? else {
            return Ok(Err("*ORIENTATION of more than two points"));
        };
        let rectangular = points.is_rectangular();
        let more = first.fields().len() > 6;
        let lost = match code {
            Code::CalculiX => more || second.is_some() && !rectangular,
            _ => more && !rectangular,
        };
        if lost {
            return Ok(Err("*ORIENTATION of more than two points"));
        }
        let points = match more {
            true => points.counted_from(first.vector(6, "point c")?),
            false => points,
        };
        let turn = match second {
            None => IDENTITY,
            Some(row) => {
                let axis = match row.text(0) {
                    "1" => [1.0, 0.0, 0.0],
                    "2" => [0.0, 1.0, 0.0],
                    "3" => [0.0, 0.0, 1.0],
                    other => {
                        return Err(row.at.problem(
                            format!(
                                "*ORIENTATION turns its axes about \"{other}\", which is no axis"
                            ),
                            "write 1, 2 or 3, and the angle in degrees",
                        ));
                    }
                };
                about(axis, row.real_or_zero(1, "the angle")?)
            }
        };
        Ok(Ok((points, turn)))
    }

    /// The axes at a place of the model on the axis of a cylinder.
    pub fn on_axis(&self, place: [f64; 3]) -> Option<Rotation> {
        let axes = self.points.axes_on_axis(self.motion.back(place))?;
        Some(self.moved(&axes))
    }

    /// The axes at a place of the model.
    pub fn at(&self, place: [f64; 3]) -> Option<Rotation> {
        let axes = self.points.axes_at(self.motion.back(place))?;
        Some(self.moved(&axes))
    }

    fn moved(&self, axes: &Rotation) -> Rotation {
        let own = product(&self.motion.rotation, axes);
        match self.turn == IDENTITY {
            true => own,
            false => product(&own, &self.turn),
        }
    }

    /// The axes as a function of the place; `None` if its points determine none. On the axis of a cylinder they are
    /// CalculiX'.
    pub fn axes(&self) -> Option<LocalAxes> {
        if self.points.is_rectangular() {
            return self.at([0.0; 3]).map(LocalAxes::fixed);
        }
        let origin = self.points.origin();
        let own = self.points.axes_on_axis(origin)?;
        Some(LocalAxes {
            coordinates: Coordinates::Cylindrical,
            origin: self.motion.place(origin),
            rotation: product(&self.motion.rotation, &own),
            turn: self.turn,
        })
    }
}
