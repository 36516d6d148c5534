//! Quantities in the cells of films.

use super::labels::capital;
use super::{Drawer, PostError};
use crate::cycle::cycle_angle;
use crate::motion::{At, moments};
use crate::post::track::distinct_names;
use eng_report::figure::{Figure, FilmMap, FilmPanel};
use eng_report::readable_unit;
use eng_system::Dimension;
use eng_system::field::FILM_CELLS;
use eng_system::figure as plan;
use eng_system::significant::{short, significant};
use std::f64::consts::TAU;

impl Drawer<'_> {
    pub(super) fn film(&self, map: &plan::FilmMap) -> Result<Figure, PostError> {
        let wanted = self.evaluator.number(&map.at)?;
        let at = match map.by_time {
            true => At::Time(wanted),
            false => At::Angle(wanted),
        };
        let pairs = || map.journals.iter().map(|(a, p)| (a.as_str(), p.as_str()));
        let mut panels = Vec::new();
        for ((analysis, path), name) in map.journals.iter().zip(distinct_names(pairs())) {
            let name = if name.is_empty() { path.clone() } else { name };
            panels.push(self.film_of(map.quantity, at, (analysis, path), name)?);
        }
        let analyses: Vec<&str> = pairs().map(|(analysis, _)| analysis).collect();
        let open = panels.iter().any(|panel| !panel.openings.is_empty());
        let outlines = if open { "outlines are openings, " } else { "" };
        Ok(FilmMap {
            title: self.title.to_owned(),
            subtitle: format!(
                "{}; {outlines}a ring is at the extreme",
                self.about(&analyses)?
            ),
            quantity: capital(&self.figure.quantity),
            unit: readable_unit(&self.display().symbol),
            panels,
        }
        .into())
    }

    /// The cells of one journal.
    fn film_of(
        &self,
        quantity: usize,
        at: At,
        (analysis, path): (&str, &str),
        name: String,
    ) -> Result<FilmPanel, PostError> {
        let run = self.evaluator.run(analysis)?;
        let no_film = || PostError::NoFilm {
            analysis: analysis.to_owned(),
            path: path.to_owned(),
        };
        let motion = run.motion;
        let motion = motion.ok_or_else(|| PostError::NoMotion(analysis.to_owned()))?;
        let field = run.machine.fields.iter().find(|field| field.path == path);
        let field = field.ok_or_else(no_film)?;
        let (times, angles) = moments(motion);
        let degrees: Vec<f64> = (angles.iter().flatten()).map(|a| a.to_degrees()).collect();
        let nearest = at.nearest(&times, &degrees, run.machine.cycle_period);
        let sample = nearest.ok_or_else(|| PostError::NoMoment {
            analysis: analysis.to_owned(),
            moment: at.to_string(),
        })?;
        let numbers = field.columns_of(motion).ok_or_else(no_film)?;
        let with = field.at(&numbers, sample).ok_or_else(no_film)?;
        let solver = field.solve(&with).map_err(|source| PostError::Film {
            analysis: analysis.to_owned(),
            path: path.to_owned(),
            source,
        })?;
        let grid = field.grid();
        let mut values = vec![0.0; grid.cells()];
        solver.cells(quantity, &mut values);
        let display = self.display();
        values.iter_mut().for_each(|x| *x = display.from_si(*x));
        let shown = |number: Option<&f64>, unit: &str| {
            number.map(|number| format!("{} {unit}", short(*number, 6)))
        };
        let moment = match at {
            At::Angle(_) => shown(degrees.get(sample), "°CA"),
            At::Time(_) => shown(times.get(sample).map(|t| 1e3 * t).as_ref(), "ms"),
        };
        let journal = run.machine.journals.iter().find(|j| j.path == path);
        let force = journal.and_then(|journal| run.results.column(&journal.force[0]));
        let millimetres = |lines: &[f64]| lines.iter().map(|z| 1e3 * z).collect();
        let turned = |lines: &[f64]| lines.iter().map(|angle| angle.to_degrees()).collect();
        let openings = grid
            .openings
            .iter()
            .map(|[around, across]| [around.map(f64::to_degrees), across.map(|z| 1e3 * z)]);
        let [middles, places] = grid.middles();
        // of the gap the least number matters
        let least = FILM_CELLS
            .get(quantity)
            .is_some_and(|shown| shown.dimension == Dimension::LENGTH);
        let order = |a: &(usize, &f64), b: &(usize, &f64)| match least {
            true => b.1.total_cmp(a.1),
            false => a.1.total_cmp(b.1),
        };
        let extreme = values.iter().enumerate().max_by(order);
        let extreme = extreme.and_then(|(cell, value)| {
            let angle = *middles.get(cell / places.len().max(1))?;
            let angle = cycle_angle(angle, Some(TAU)).to_degrees();
            let place = 1e3 * places.get(cell % places.len().max(1))?;
            // the middle of an odd number of cells is zero but for rounding
            let place = if place.abs() < 1e-9 { 0.0 } else { place };
            Some((*value, angle, place))
        });
        let facts = extreme.map(|(value, angle, place)| {
            format!(
                "{} cell: {}{} at {}°, {} mm",
                if least { "least" } else { "largest" },
                significant(value, 4),
                match display.symbol.as_str() {
                    "1" => String::new(),
                    unit => format!(" {}", readable_unit(unit)),
                },
                significant(angle, 4),
                significant(place, 3)
            )
        });
        Ok(FilmPanel {
            name,
            mark: extreme.map(|(_, angle, place)| (angle, place)),
            facts: facts.unwrap_or_default(),
            moment: moment.unwrap_or_default(),
            frame: force.map_or_else(String::new, |column| column.frame.clone()),
            around: turned(&grid.around),
            across: millimetres(&grid.across),
            values,
            openings: openings.collect(),
        })
    }
}
