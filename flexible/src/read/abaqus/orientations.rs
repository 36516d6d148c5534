//! `*ORIENTATION`: the axes of materials and couplings.

use super::distributions::Distribution;
use super::frames::{Motion, STILL, Transform, about};
use super::lines::Row;
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
    /// The distribution over elements that an `*ORIENTATION` names in the place of its points; `None` for another
    /// orientation, and for one that [`Self::named`] notes as not read.
    ///
    /// # Errors
    /// A distribution that is missing or wrong.
    pub fn distribution<'m>(
        (model, code): (&'m Model, Code),
        place: usize,
        name: &str,
    ) -> Result<Option<Distribution<'m>>, FileProblem> {
        let Some(block) = model.named_block(Some(place), "ORIENTATION", name) else {
            return Ok(None);
        };
        let mut rows = block.rows.iter().filter(|row| !row.is_blank());
        let (Some(first), second) = (rows.next(), rows.next()) else {
            return Ok(None);
        };
        let system = block.keyword.choice("SYSTEM");
        let read = match code {
            // CalculiX turns the axes of each line by another angle (`orientations.f`)
            Code::CalculiX => second.is_none(),
            _ => matches!(system.as_str(), "" | "RECTANGULAR"),
        };
        if !(read && names_distribution(first)) {
            return Ok(None);
        }
        Distribution::named((model, code), place, first.text(0), block)
    }

    /// The `*ORIENTATION` with a name, of the same place as its user. One whose points are in a distribution has those of a
    /// line of it. Without axes that Eng reads it is noted, and the answer is `None`.
    ///
    /// # Errors
    /// No such orientation, text in the place of a number.
    pub fn named(
        (model, code): (&Model, Code),
        place: usize,
        (name, line): (&str, Option<&Row>),
        user: &Block,
        unread: &mut UnreadCards,
    ) -> Result<Option<Self>, FileProblem> {
        let Some(block) = model.named_block(Some(place), "ORIENTATION", name) else {
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
                let second = others.first().copied();
                match (names_distribution(first), line) {
                    (false, _) => Self::read(block, (*first, second), code)?,
                    (true, Some(line)) => match Transform::of_distribution(keyword, line)? {
                        Some(points) => Ok((points, turn_of(second)?)),
                        None => Err("*ORIENTATION of more than two points"),
                    },
                    (true, None) => Err("*ORIENTATION by a distribution"),
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
        Ok(Ok((points, turn_of(second)?)))
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

/// Whether the first line of an `*ORIENTATION` is the name of a distribution.
fn names_distribution(first: &Row) -> bool {
    let text = first.text(0);
    !text.is_empty() && number::real(text).is_none()
}

/// The rotation of the axes by the second line of an `*ORIENTATION`, `axis, degrees`.
fn turn_of(second: Option<&Row>) -> Result<Rotation, FileProblem> {
    let Some(row) = second else {
        return Ok(IDENTITY);
    };
    let axis = match row.text(0) {
        "1" => [1.0, 0.0, 0.0],
        "2" => [0.0, 1.0, 0.0],
        "3" => [0.0, 0.0, 1.0],
        other => {
            return Err(row.at.problem(
                format!("*ORIENTATION turns its axes about \"{other}\", which is no axis"),
                "write 1, 2 or 3, and the angle in degrees",
            ));
        }
    };
    Ok(about(axis, row.real_or_zero(1, "the angle")?))
}
