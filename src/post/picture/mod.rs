//! Figures of reports.

mod bode;
mod film;
pub(crate) mod labels;
mod orders;
mod plane;
mod tornado;
mod xy;

pub(crate) use labels::capital;
pub(crate) use orders::ORDERS;

use super::evaluate::Evaluator;
use super::operation::filter_of;
use super::track::{Track, distinct_names};
use super::{PostError, Run};
use eng_report::figure::{Abscissa, Curve, Figure, History, Mark, Ordinate, Panel, Scale};
use eng_report::readable_unit;
use eng_system::DisplayUnit;
use eng_system::expression::{Expression, Member};
use eng_system::figure::{self as plan, Picture};
use labels::{common_frame, letters};

/// Draws a figure.
pub(super) fn figure(
    figure: &plan::Figure,
    title: &str,
    evaluator: &Evaluator<'_>,
) -> Result<Figure, PostError> {
    let drawer = Drawer {
        title,
        figure,
        evaluator,
    };
    match &figure.picture {
        Picture::History(history) => drawer.history(history),
        Picture::Spectrum(spectrum) => drawer.spectrum(spectrum),
        Picture::Orbit(orbit) => drawer.orbit(orbit),
        Picture::Polar(polar) => drawer.polar(polar),
        Picture::OrderTrack(track) => drawer.order_track(track),
        Picture::Waterfall(waterfall) => drawer.waterfall(waterfall),
        Picture::Campbell(campbell) => drawer.campbell(campbell),
        Picture::Xy(xy) => drawer.xy(xy),
        Picture::Bode(bode) => drawer.bode(bode),
        Picture::Film(map) => drawer.film(map),
        Picture::Tornado(tornado) => drawer.tornado(tornado),
    }
}

struct Drawer<'d> {
    title: &'d str,
    figure: &'d plan::Figure,
    evaluator: &'d Evaluator<'d>,
}

impl Drawer<'_> {
    fn display(&self) -> &DisplayUnit {
        &self.figure.display
    }

    /// The model and the analyses of a figure.
    fn about(&self, analyses: &[&str]) -> Result<String, PostError> {
        let mut names: Vec<&str> = Vec::new();
        for name in analyses {
            if !names.contains(name) {
                names.push(name);
            }
        }
        let mut models: Vec<&str> = Vec::new();
        for name in &names {
            let model = self.evaluator.run(name)?.results.model();
            if !models.contains(&model) {
                models.push(model);
            }
        }
        let shown = match names.as_slice() {
            [] => String::new(),
            [one] => format!("analysis {one}"),
            [first, .., last] if names.len() > 4 => {
                format!("analyses {first} to {last} ({} runs)", names.len())
            }
            names => format!("analyses {}", names.join(", ")),
        };
        Ok(format!("{}, {shown}", models.join(" and ")))
    }

    /// The text below the title of signals: model, analyses, filters.
    fn subtitle(&self, members: &[&Member]) -> Result<String, PostError> {
        let mut analyses = Vec::new();
        let mut filters: Vec<String> = Vec::new();
        for member in members {
            member
                .expression
                .channels(&mut |analysis, _| analyses.push(analysis));
            self.filters(&member.expression, &mut filters)?;
        }
        let filters = if filters.is_empty() {
            "not filtered".to_owned()
        } else {
            filters.join("; ")
        };
        Ok(format!("{}, {filters}", self.about(&analyses)?))
    }

    /// The descriptions of an expression's filters, each once.
    fn filters(&self, expression: &Expression, found: &mut Vec<String>) -> Result<(), PostError> {
        for part in expression.parts() {
            self.filters(part, found)?;
        }
        if let Expression::Filter(filter, of) = expression {
            let track = self.evaluator.track(of)?;
            if let Some((made, sampled)) = filter_of(filter, &track)? {
                let text = made.description(sampled.sampling);
                if !found.contains(&text) {
                    found.push(text);
                }
            }
        }
        Ok(())
    }

    /// The axes of components.
    fn frame<'e>(&self, expressions: impl IntoIterator<Item = &'e Expression>) -> String {
        let mut frames = Vec::new();
        for expression in expressions {
            expression.channels(&mut |analysis, path| {
                let run = self.evaluator.run(analysis).ok();
                if let Some(column) = run.and_then(|run| run.results.column(path)) {
                    frames.push(column.frame.as_str());
                }
            });
        }
        common_frame(&frames)
    }

    fn ordinate(&self, members: &[&Member]) -> Ordinate {
        Ordinate {
            quantity: capital(&self.figure.quantity),
            unit: readable_unit(&self.display().symbol),
            frame: self.frame(members.iter().map(|member| &member.expression)),
        }
    }

    /// The letter of the journal for each signal, if the signals are in the axes of different journals. With
    /// a single journal letters would not distinguish curves.
    fn lettered<'m>(&self, members: &[&'m Member]) -> Vec<(&'m Member, String)> {
        let found: Vec<(&Member, String)> = members
            .iter()
            .filter_map(|member| Some((*member, self.letter(&member.expression)?)))
            .collect();
        match found.first() {
            Some((_, first)) if found.iter().any(|(_, letter)| letter != first) => found,
            _ => Vec::new(),
        }
    }

    /// The letter of the journal whose axes an expression uses.
    fn letter(&self, of: &Expression) -> Option<String> {
        let mut found: Vec<String> = Vec::new();
        let mut known = true;
        of.channels(&mut |analysis, path| {
            let letter = self.evaluator.run(analysis).ok().and_then(|run| {
                let frame = &run.results.column(path)?.frame;
                let letters = letters(run.results, &run.machine.journals);
                let own = letters.into_iter().find(|(axes, _)| axes == frame)?;
                Some(own.1)
            });
            match letter {
                Some(letter) => found.push(letter),
                None => known = false,
            }
        });
        let first = found.first()?.clone();
        (known && found.iter().all(|letter| *letter == first)).then_some(first)
    }

    /// Firing dead centres, if all runs have the same.
    fn marks(&self, members: &[&Member]) -> Result<Vec<Mark>, PostError> {
        let mut runs: Vec<Run<'_>> = Vec::new();
        for member in members {
            runs.push(self.evaluator.run(&member.analysis)?);
        }
        let Some(first) = runs.first().map(|run| run.machine) else {
            return Ok(Vec::new());
        };
        let same = runs.iter().all(|run| {
            run.machine.firing == first.firing && run.machine.cycle_period == first.cycle_period
        });
        let Some(period) = first.cycle_period.filter(|_| same) else {
            return Ok(Vec::new());
        };
        let period = period.to_degrees();
        let firing = first.firing.iter();
        Ok(firing
            .map(|(cylinder, angle)| Mark::firing_tdc(*cylinder, angle.to_degrees(), period))
            .collect())
    }

    fn history(&self, history: &plan::History) -> Result<Figure, PostError> {
        let plan::History { panels, by_time } = history;
        let by_time = *by_time;
        let all: Vec<&Member> = panels.iter().flatten().collect();
        let mut drawn = Vec::new();
        let lettered = self.lettered(&all);
        for members in panels {
            let names = named(distinct_names(pairs(members)), members, &lettered);
            // curves with different samples are in different panels
            let mut own: Vec<(Vec<f64>, Vec<&Member>, Vec<Curve>)> = Vec::new();
            for (member, name) in members.iter().zip(names) {
                let track = self.evaluator.track(&member.expression)?;
                let x = abscissa(&track, by_time);
                let curve = Curve {
                    name,
                    values: shown(&track.values, self.display()),
                };
                let alike = own.iter_mut().find(|(other, ..)| alike(other, &x));
                match alike {
                    Some((_, shown, curves)) => {
                        shown.push(member);
                        curves.push(curve);
                    }
                    None => own.push((x, vec![member], vec![curve])),
                }
            }
            let several = panels.len() > 1 || own.len() > 1;
            drawn.extend(own.into_iter().map(|(x, shown, curves)| Panel {
                title: panel_title(&shown, several),
                x,
                curves,
            }));
        }
        Ok(History {
            title: self.title.to_owned(),
            subtitle: self.subtitle(&all)?,
            abscissa: if by_time {
                Abscissa::Time
            } else {
                Abscissa::CrankAngle
            },
            ordinate: self.ordinate(&all),
            scale: Scale::Linear,
            marks: if by_time {
                Vec::new()
            } else {
                self.marks(&all)?
            },
            panels: drawn,
        }
        .into())
    }
}

/// The analysis of one of several panels; for several analyses their common channel.
fn panel_title(members: &[&Member], several: bool) -> String {
    let Some(first) = members.first() else {
        return String::new();
    };
    if several && members.iter().all(|m| m.analysis == first.analysis) {
        first.analysis.clone()
    } else if members.len() > 1 && members.iter().all(|m| m.channel == first.channel) {
        first.channel.clone()
    } else {
        String::new()
    }
}

/// Names with the letters before them.
fn named(names: Vec<String>, members: &[Member], lettered: &[(&Member, String)]) -> Vec<String> {
    names
        .into_iter()
        .zip(members)
        .map(|(name, member)| {
            let letter = lettered
                .iter()
                .find(|(other, _)| std::ptr::eq(*other, member));
            match letter {
                Some((_, letter)) => format!("{letter} {name}"),
                None => name,
            }
        })
        .collect()
}

fn pairs(members: &[Member]) -> impl Iterator<Item = (&str, &str)> + Clone {
    members
        .iter()
        .map(|m| (m.analysis.as_str(), m.channel.as_str()))
}

/// Crank angle (°) or time (s) of the samples.
fn abscissa(track: &Track, by_time: bool) -> Vec<f64> {
    match (&track.samples.angle, by_time) {
        (Some(_), false) => degrees(track),
        _ => track.samples.time.clone(),
    }
}

/// Cycle angle (°) of the samples; empty without a cycle.
fn degrees(track: &Track) -> Vec<f64> {
    let angle = track.samples.angle.as_deref().unwrap_or_default();
    angle.iter().map(|a| a.to_degrees()).collect()
}

/// Whether two lists can share an axis because they differ only by rounding.
fn alike(a: &[f64], b: &[f64]) -> bool {
    let span = match (a.first(), a.last()) {
        (Some(first), Some(last)) => (last - first).abs(),
        _ => 0.0,
    };
    // a choice: a millionth of an axis is far below a pixel
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * span)
}

fn shown(values: &[f64], display: &DisplayUnit) -> Vec<f64> {
    values.iter().map(|value| display.from_si(*value)).collect()
}
