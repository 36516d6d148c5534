//! Figures of reports.

use super::evaluate::{Evaluator, filter_of};
use super::natural::Natural;
use super::reach::limit_text;
use super::spectra::{map_of, orders_along, orders_of, spectrum_of};
use super::track::{Track, told_apart};
use super::{PostError, Run};
use crate::cli::figures::common_frame;
use crate::report::firing_marks;
use eng_report::figure::{
    Abscissa, Campbell, Curve, Figure, FixedTo, History, Mark, Orbit, Orbits, Ordinate, Panel,
    Polar, PolarCurve, Scale, SweepFigure, Waterfall, spectra,
};
use eng_report::readable_unit;
use eng_report::signal::{Level, OrderTrack};
use eng_system::DisplayUnit;
use eng_system::report::{self as plan, Expression, Limit, Member, Part, Picture, Vector};

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
        Picture::History(panels, by_time) => drawer.history(panels, *by_time),
        Picture::Spectrum(members, settings) => drawer.spectrum(members, settings),
        Picture::Orbit(journals, cycles) => drawer.orbit(journals, *cycles),
        Picture::Polar(vectors, cycles) => drawer.polar(vectors, *cycles),
        Picture::OrderTrack {
            members,
            orders,
            window,
            block,
        } => drawer.order_track(members, orders, *window, *block),
        Picture::Waterfall(members, settings) => Ok(Waterfall {
            figure: drawer.map(members, settings)?,
        }
        .into()),
        Picture::Campbell {
            members,
            settings,
            orders,
            modes,
        } => drawer.campbell(members, settings, orders, modes),
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

    /// Model and analyses of what is drawn.
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

    /// What stands under the title of spectra: analyses, and filters where there are any; the line is long enough with what made
    /// the spectra.
    fn short_subtitle(&self, members: &[&Member]) -> Result<String, PostError> {
        let mut parts: Vec<String> = Vec::new();
        match members {
            [] => {}
            [one] => parts.push(one.analysis.clone()),
            [first, .., last] if first.analysis == last.analysis => {
                parts.push(first.analysis.clone());
            }
            [first, .., last] => parts.push(format!("{} to {}", first.analysis, last.analysis)),
        }
        for member in members {
            self.filters(&member.expression, &mut parts)?;
        }
        Ok(parts.join("; "))
    }

    /// What stands under the title of signals: model, analyses, filters.
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

    /// What the filters of an expression do, each once.
    fn filters(&self, expression: &Expression, found: &mut Vec<String>) -> Result<(), PostError> {
        match expression {
            Expression::Filter(filter, of) => {
                self.filters(of, found)?;
                let track = self.evaluator.track(of)?;
                if let Some((made, sampled)) = filter_of(filter, &track)? {
                    let text = made.description(sampled.sampling);
                    if !found.contains(&text) {
                        found.push(text);
                    }
                }
                Ok(())
            }
            Expression::Map(_, of)
            | Expression::Last(_, of)
            | Expression::Decibel(_, of)
            | Expression::Reduce(_, of)
            | Expression::Amplitude(_, _, of) => self.filters(of, found),
            Expression::Binary(_, left, right) | Expression::Resample(left, right) => {
                self.filters(left, found)?;
                self.filters(right, found)
            }
            Expression::Fold(_, members) => members.iter().try_for_each(|m| self.filters(m, found)),
            _ => Ok(()),
        }
    }

    /// The axes that components are along.
    fn frame(&self, members: &[&Member]) -> String {
        let mut frames = Vec::new();
        for member in members {
            member.expression.channels(&mut |analysis, path| {
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
            frame: self.frame(members),
        }
    }

    /// Firing dead centres, where all runs have the same.
    fn marks(&self, members: &[&Member]) -> Result<Vec<Mark>, PostError> {
        let mut runs: Vec<Run<'_>> = Vec::new();
        for member in members {
            runs.push(self.evaluator.run(&member.analysis)?);
        }
        let Some(first) = runs.first().map(|run| run.model) else {
            return Ok(Vec::new());
        };
        let same = runs.iter().all(|run| {
            run.model.firing == first.firing && run.model.cycle_period == first.cycle_period
        });
        let Some(period) = first.cycle_period.filter(|_| same) else {
            return Ok(Vec::new());
        };
        Ok(firing_marks(&first.firing, period))
    }

    fn history(&self, panels: &[Vec<Member>], by_time: bool) -> Result<Figure, PostError> {
        let all: Vec<&Member> = panels.iter().flatten().collect();
        let mut drawn = Vec::new();
        for members in panels {
            let names = told_apart(pairs(members));
            let title = match members.first() {
                Some(first)
                    if panels.len() > 1 && members.iter().all(|m| m.analysis == first.analysis) =>
                {
                    first.analysis.clone()
                }
                Some(first) if members.len() > 1 => {
                    let same = members.iter().all(|m| m.channel == first.channel);
                    if same {
                        first.channel.clone()
                    } else {
                        String::new()
                    }
                }
                _ => String::new(),
            };
            // curves over samples of their own stand in panels of their own
            let mut own: Vec<(Vec<f64>, Vec<Curve>)> = Vec::new();
            for (member, name) in members.iter().zip(names) {
                let track = self.evaluator.track(&member.expression)?;
                let x = abscissa(&track, by_time);
                let curve = Curve {
                    name,
                    values: shown(&track.values, self.display()),
                };
                let alike = own.iter_mut().find(|(other, _)| alike(other, &x));
                match alike {
                    Some((_, curves)) => curves.push(curve),
                    None => own.push((x, vec![curve])),
                }
            }
            drawn.extend(own.into_iter().map(|(x, curves)| Panel {
                title: title.clone(),
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

    fn spectrum(
        &self,
        members: &[Member],
        settings: &plan::SpectrumSettings,
    ) -> Result<Figure, PostError> {
        let all: Vec<&Member> = members.iter().collect();
        let names = told_apart(pairs(members));
        let mut found = Vec::new();
        for (member, name) in members.iter().zip(names) {
            let track = self.evaluator.track(&member.expression)?;
            let (spectrum, _) = spectrum_of(&track, settings, self.display())?;
            found.push((name, spectrum));
        }
        let mut subtitle = vec![self.short_subtitle(&all)?];
        let reach = found.iter().map(|(_, s)| s.reach());
        subtitle.extend(not_held(settings, reach.fold(f64::INFINITY, f64::min)));
        let curves: Vec<_> = found.iter().map(|(name, s)| (name.clone(), s)).collect();
        let scale = if settings.logarithmic && settings.reference.is_none() {
            Scale::Logarithmic
        } else {
            Scale::Linear
        };
        Ok(spectra(
            self.title,
            &subtitle.join("; "),
            self.amplitudes(&all, settings)?,
            scale,
            settings.up_to,
            &curves,
        )
        .into())
    }

    /// The ordinate of amplitudes, or of their levels.
    fn amplitudes(
        &self,
        members: &[&Member],
        settings: &plan::SpectrumSettings,
    ) -> Result<Ordinate, PostError> {
        let mut ordinate = self.ordinate(members);
        ordinate.quantity.push_str(", 0-peak");
        if let Some(reference) = settings.reference {
            let display = self.display();
            let level = Level::new(reference / display.scale, readable_unit(&display.symbol))
                .map_err(|source| PostError::Signal {
                    analysis: self.title.to_owned(),
                    source,
                })?;
            ordinate.unit = level.label();
        }
        Ok(ordinate)
    }

    /// Spectra over speed, with the natural frequencies of linear analyses: of one speed lines across, of several a mark each.
    fn campbell(
        &self,
        members: &[Member],
        settings: &plan::SpectrumSettings,
        orders: &[f64],
        modes: &[String],
    ) -> Result<Figure, PostError> {
        let mut figure = self.map(members, settings)?;
        let natural = Natural::of(modes, self.evaluator)?;
        if let Some(said) = natural.said() {
            figure.subtitle = format!("{}; {said}", figure.subtitle);
        }
        Ok(Campbell {
            figure,
            orders: orders.to_vec(),
            natural_frequencies: natural.lines(),
            modes: natural.marks(),
        }
        .into())
    }

    fn map(
        &self,
        members: &[Member],
        settings: &plan::SpectrumSettings,
    ) -> Result<SweepFigure, PostError> {
        let all: Vec<&Member> = members.iter().collect();
        let (map, description) = map_of(members, settings, self.display(), self.evaluator)?;
        let ordinate = self.amplitudes(&all, settings)?;
        let mut subtitle = vec![self.short_subtitle(&all)?, description];
        // beyond the samples of a run its row is empty
        let filled = |row: &Vec<f64>| row.iter().take_while(|a| !a.is_nan()).count();
        let held = map.amplitudes.iter().map(filled).min().unwrap_or(0);
        let reach = held.checked_sub(1).and_then(|last| map.positions.get(last));
        subtitle.extend(not_held(settings, reach.copied().unwrap_or_default()));
        Ok(SweepFigure {
            title: self.title.to_owned(),
            subtitle: subtitle.join("; "),
            quantity: ordinate.quantity,
            unit: ordinate.unit,
            frame: ordinate.frame,
            map,
            limit: settings.up_to,
        })
    }

    fn order_track(
        &self,
        members: &[Member],
        orders: &[f64],
        window: plan::Window,
        block: Option<(f64, f64)>,
    ) -> Result<Figure, PostError> {
        let all: Vec<&Member> = members.iter().collect();
        let mut panels = Vec::new();
        match block {
            Some(block) => {
                let names = told_apart(pairs(members));
                for (member, name) in members.iter().zip(names) {
                    let track = self.evaluator.track(&member.expression)?;
                    let found = orders_along(&track, orders, window, block)?;
                    panels.push(self.panel(name, &found));
                }
            }
            None => {
                let mut channels: Vec<(&str, Vec<Track>)> = Vec::new();
                for member in members {
                    let track = self.evaluator.track(&member.expression)?;
                    match channels
                        .iter_mut()
                        .find(|(name, _)| *name == member.channel)
                    {
                        Some((_, tracks)) => tracks.push(track),
                        None => channels.push((&member.channel, vec![track])),
                    }
                }
                for (name, tracks) in &channels {
                    let found = orders_of(tracks, orders, window)?;
                    panels.push(self.panel((*name).to_owned(), &found));
                }
            }
        }
        let mut ordinate = self.ordinate(&all);
        ordinate.quantity.push_str(", 0-peak");
        let blocks = match block {
            Some((revolutions, overlap)) => format!(
                ", blocks of {revolutions} revolutions, overlap {:.0} %",
                100.0 * overlap
            ),
            None => String::new(),
        };
        Ok(History {
            title: self.title.to_owned(),
            subtitle: format!(
                "{}; {} window{blocks}",
                self.subtitle(&all)?,
                super::evaluate::window_of(window).name()
            ),
            abscissa: Abscissa::Speed,
            ordinate,
            scale: Scale::Linear,
            marks: Vec::new(),
            panels,
        }
        .into())
    }

    fn panel(&self, title: String, found: &OrderTrack) -> Panel {
        let scale = self.display().scale;
        Panel {
            title,
            x: found.speeds.clone(),
            curves: found
                .orders
                .iter()
                .zip(&found.components)
                .map(|(order, components)| Curve {
                    name: format!("order {order}"),
                    values: components.iter().map(|c| c.amplitude / scale).collect(),
                })
                .collect(),
        }
    }

    fn orbit(
        &self,
        journals: &[(String, String)],
        cycles: Option<u32>,
    ) -> Result<Figure, PostError> {
        let names = told_apart(journals.iter().map(|(a, p)| (a.as_str(), p.as_str())));
        let mut orbits = Vec::new();
        for ((analysis, path), name) in journals.iter().zip(names) {
            let run = self.evaluator.run(analysis)?;
            let geometry = run
                .model
                .journals
                .iter()
                .find(|journal| journal.path == *path)
                .ok_or_else(|| PostError::NoJournal {
                    analysis: analysis.clone(),
                    path: path.clone(),
                })?;
            let axis = |axis: &str| Expression::Channel {
                analysis: analysis.clone(),
                path: format!("{path}.eccentricity.{axis}"),
            };
            let (x, y) = self.plane(&axis("x"), &axis("y"), cycles)?;
            let frame = run
                .results
                .column(&format!("{path}.eccentricity.x"))
                .map_or("", |column| column.frame.as_str());
            orbits.push(Orbit {
                name,
                frame: frame.to_owned(),
                clearance: geometry.radial_clearance,
                angle: degrees(&x),
                x: x.values,
                y: y.values,
            });
        }
        let analyses: Vec<&str> = journals.iter().map(|(a, _)| a.as_str()).collect();
        let (period, upright) = self.view(&analyses)?;
        Ok(Orbits {
            title: self.title.to_owned(),
            subtitle: format!("{}, not filtered", self.about(&analyses)?),
            period,
            upright,
            orbits,
        }
        .into())
    }

    fn polar(&self, vectors: &[Vector], cycles: Option<u32>) -> Result<Figure, PostError> {
        let names = told_apart(
            vectors
                .iter()
                .map(|v| (v.analysis.as_str(), v.path.as_str())),
        );
        let display = self.display();
        let mut fixed_to = FixedTo::Housing;
        let mut curves = Vec::new();
        for (vector, name) in vectors.iter().zip(names) {
            let (x, y) = self.plane(&vector.x, &vector.y, cycles)?;
            let mut frames = Vec::new();
            vector.x.channels(&mut |analysis, path| {
                let run = self.evaluator.run(analysis).ok();
                if let Some(column) = run.and_then(|run| run.results.column(path)) {
                    frames.push(column.frame.as_str());
                }
            });
            let frame = common_frame(&frames);
            let mut curve = PolarCurve {
                name,
                frame,
                angle: degrees(&x),
                // a vector has no shifted zero
                x: x.values.iter().map(|v| v / display.scale).collect(),
                y: y.values.iter().map(|v| v / display.scale).collect(),
            };
            if let Some(turned_by) = &vector.turned_by {
                let turn = self.part(turned_by, cycles)?;
                if let Some(detail) = x.samples.differ(&turn.samples) {
                    return Err(PostError::Samples {
                        first: x.samples.analysis.clone(),
                        second: turn.samples.analysis.clone(),
                        detail,
                    });
                }
                let turn: Vec<f64> = turn.values.iter().map(|v| v.to_degrees()).collect();
                let frame = format!("{}, turned about z", curve.frame);
                curve = curve.turned(&turn, frame);
                fixed_to = FixedTo::Journal;
            }
            curves.push(curve);
        }
        let analyses: Vec<&str> = vectors.iter().map(|v| v.analysis.as_str()).collect();
        let (period, upright) = self.view(&analyses)?;
        let said = if vectors.iter().any(|vector| vector.load) {
            "load of the pins on their shells: the tip points at the side that carries it"
        } else {
            "as recorded: forces of joints and journals are those on the first marker"
        };
        Ok(Polar {
            title: self.title.to_owned(),
            subtitle: format!("{}, not filtered; {said}", self.about(&analyses)?),
            quantity: capital(&self.figure.quantity),
            unit: readable_unit(&display.symbol),
            fixed_to,
            period,
            upright,
            limit: None,
            curves,
        }
        .into())
    }

    /// A signal, or its last cycles.
    fn part(&self, expression: &Expression, cycles: Option<u32>) -> Result<Track, PostError> {
        let track = self.evaluator.track(expression)?;
        match cycles {
            Some(count) => self.evaluator.last(Part::Cycles(count), track),
            None => Ok(track),
        }
    }

    fn plane(
        &self,
        x: &Expression,
        y: &Expression,
        cycles: Option<u32>,
    ) -> Result<(Track, Track), PostError> {
        Ok((self.part(x, cycles)?, self.part(y, cycles)?))
    }

    /// The period (°) and the upward axis of the first run; 360° without a cycle.
    fn view(&self, analyses: &[&str]) -> Result<(f64, crate::plot::Upright), PostError> {
        let first = analyses.first().copied().unwrap_or_default();
        let model = self.evaluator.run(first)?.model;
        let period = model.cycle_period.map_or(360.0, f64::to_degrees);
        Ok((period, model.upright))
    }
}

/// What is said where an axis is asked to go on beyond what samples hold, up to `reach` (Hz, or orders).
fn not_held(settings: &plan::SpectrumSettings, reach: f64) -> Option<String> {
    let limit = |place| match settings.axis {
        plan::Axis::Frequency => Limit::Frequency(place),
        plan::Axis::Order => Limit::Order(place),
    };
    let beyond = settings
        .up_to
        .is_some_and(|up_to| up_to > reach * (1.0 + 1e-6));
    beyond.then(|| format!("the samples hold no more than {}", limit_text(limit(reach))))
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

/// Whether two rows can share an axis: the same but for rounding.
fn alike(a: &[f64], b: &[f64]) -> bool {
    let span = match (a.first(), a.last()) {
        (Some(first), Some(last)) => (last - first).abs(),
        _ => 0.0,
    };
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * span)
}

fn shown(values: &[f64], display: &DisplayUnit) -> Vec<f64> {
    values.iter().map(|value| display.from_si(*value)).collect()
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
