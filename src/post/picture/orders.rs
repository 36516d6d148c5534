//! Spectra, their maps over speed, and orders.

use super::{Drawer, named, pairs};
use crate::post::PostError;
use crate::post::natural::Natural;
use crate::post::operation::window_of;
use crate::post::sampling_limits::limit_text;
use crate::post::spectra::{map_of, orders_along, orders_of, spectrum_of};
use crate::post::track::{Track, distinct_names};
use eng_report::figure::{
    Abscissa, Campbell, Curve, Figure, History, Ordinate, Panel, Scale, SweepFigure, Waterfall,
    spectra,
};
use eng_report::readable_unit;
use eng_report::signal::{Level, OrderTrack};
use eng_system::expression::{Limit, Member};
use eng_system::figure as plan;

/// Largest difference of the mean speeds of runs in one figure, as a share. A choice: orders then coincide to
/// the width of a line.
const ALIKE: f64 = 1e-3;

impl Drawer<'_> {
    /// The text below the title of spectra: analyses and filters. The model is left out, because the line
    /// also describes the spectra.
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

    pub(super) fn spectrum(&self, spectrum: &plan::Spectrum) -> Result<Figure, PostError> {
        let plan::Spectrum { members, settings } = spectrum;
        let all: Vec<&Member> = members.iter().collect();
        let names = named(
            distinct_names(pairs(members)),
            members,
            &self.lettered(&all),
        );
        let mut found = Vec::new();
        let mut speeds = Vec::new();
        for (member, name) in members.iter().zip(names) {
            let track = self.evaluator.track(&member.expression)?;
            let (spectrum, speed) = spectrum_of(&track, settings, self.display())?;
            found.push((name, spectrum));
            speeds.push(speed.map(|speed| speed / 60.0));
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
        let mut drawn = spectra(
            self.title,
            &subtitle.join("; "),
            self.amplitudes(&all, settings)?,
            scale,
            settings.up_to,
            &curves,
        );
        // if all shafts have one speed, orders and frequencies convert into each other
        if let Some(Some(speed)) = speeds.first().copied()
            && speeds
                .iter()
                .all(|s| s.is_some_and(|s| (s - speed).abs() <= ALIKE * speed))
        {
            drawn.abscissa = match drawn.abscissa {
                Abscissa::Frequency => Abscissa::FrequencyAt { speed },
                Abscissa::Order => Abscissa::OrderAt { speed },
                other => other,
            };
        }
        Ok(drawn.into())
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

    /// Spectra over speed, with the natural frequencies of linear analyses: lines across for one speed,
    /// a mark each for several. Settings that the text does not state are those of the maps of a page.
    pub(super) fn campbell(&self, campbell: &plan::Campbell) -> Result<Figure, PostError> {
        let plan::Campbell {
            members,
            settings,
            orders,
            modes,
        } = campbell;
        let mut figure = self.map(members, settings)?;
        if settings.reference.is_some() {
            with_floor(&mut figure);
        }
        let highest = ORDERS * figure.map.speeds().last().copied().unwrap_or(0.0) / 60.0;
        let limit = match settings.axis {
            plan::Axis::Frequency => highest,
            plan::Axis::Order => ORDERS,
        };
        figure.limit = figure.limit.or(Some(limit).filter(|limit| *limit > 0.0));
        let orders = match (orders, members.first()) {
            (Some(orders), _) => orders.clone(),
            (None, Some(first)) => {
                let machine = self.evaluator.run(&first.analysis)?.machine;
                main_orders(machine.cycle_period, machine.firing.len())
            }
            (None, None) => Vec::new(),
        };
        Ok(over_speed(figure, orders, &Natural::of(modes, self.evaluator)?).into())
    }

    pub(super) fn waterfall(&self, waterfall: &plan::Waterfall) -> Result<Figure, PostError> {
        let figure = self.map(&waterfall.members, &waterfall.settings)?;
        Ok(Waterfall { figure }.into())
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
        // a row is empty beyond the frequencies that its run resolves
        let filled = |row: &Vec<f64>| row.iter().take_while(|a| !a.is_nan()).count();
        let held = map.amplitudes().iter().map(filled).min().unwrap_or(0);
        let reach = held
            .checked_sub(1)
            .and_then(|last| map.positions().get(last));
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

    pub(super) fn order_track(&self, track: &plan::OrderTrack) -> Result<Figure, PostError> {
        let plan::OrderTrack {
            members,
            orders,
            window,
            block,
        } = track;
        let (window, block) = (*window, *block);
        let all: Vec<&Member> = members.iter().collect();
        let mut panels = Vec::new();
        match block {
            Some(block) => {
                let names = distinct_names(pairs(members));
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
                window_of(window).name()
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
}

/// Highest drawn order if the text states no end of the axis. A choice: gears and films have orders up to
/// some ten.
pub(crate) const ORDERS: f64 = 30.0;
/// Levels this far (dB) below the largest are one colour. A choice: a ten-thousandth of the largest amplitude
/// is near the errors of the steps.
const DYNAMIC: f64 = 80.0;

/// A map with the lines of orders and with natural frequencies, which its subtitle names.
fn over_speed(mut figure: SweepFigure, orders: Vec<f64>, natural: &Natural) -> Campbell {
    if let Some(names) = natural.description() {
        figure.subtitle = format!("{}; {names}", figure.subtitle);
    }
    Campbell {
        figure,
        orders,
        natural_frequencies: natural.lines(),
        modes: natural.marks(),
    }
}

/// Raises levels (dB) to 80 dB below the largest, and states this in the unit. A value that is not a
/// number stays a gap.
fn with_floor(figure: &mut SweepFigure) {
    let levels = || figure.map.amplitudes().iter().flatten().copied();
    let largest = levels()
        .filter(|l| l.is_finite())
        .fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return;
    }
    let lowest = largest - DYNAMIC;
    // a comparison with NaN is false
    let raised = |level| if level < lowest { lowest } else { level };
    figure.map.replace(raised);
    figure.unit.push_str(&format!(", at least {lowest:.0}"));
}

/// Multiples of the firing order (firings per revolution). For a machine that does not fire these are the
/// first orders. `period` is that of its cycle (rad).
fn main_orders(period: Option<f64>, firings: usize) -> Vec<f64> {
    let revolutions = period.map_or(1.0, |period| period / std::f64::consts::TAU);
    let main = match firings {
        0 => 1.0,
        count => count as f64 / revolutions,
    };
    (1..=4).map(|k| main * f64::from(k)).collect()
}

/// The text about an axis whose stated end is beyond the samples, which resolve up to `reach` (Hz, or
/// orders).
fn not_held(settings: &plan::SpectrumSettings, reach: f64) -> Option<String> {
    let limit = |place| match settings.axis {
        plan::Axis::Frequency => Limit::Frequency(place),
        plan::Axis::Order => Limit::Order(place),
    };
    let beyond = settings
        .up_to
        // a limit at the end itself is held, in spite of rounding
        .is_some_and(|up_to| up_to > reach * (1.0 + 1e-6));
    beyond.then(|| {
        format!(
            "the samples resolve no more than {}",
            limit_text(limit(reach))
        )
    })
}
