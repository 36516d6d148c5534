//! Spectra as curves.

use super::abscissa::Abscissa;
use super::axes::Scale;
use super::history::{Curve, History, Ordinate, Panel};
use crate::signal::{Axis, Spectrum};

/// A figure of spectra with one axis and resolution. Window, resolution and overlap are below the title.
/// `limit` ends the axis (Hz, or orders). Spectra that differ in axis or resolution from the first get a
/// panel of their own.
pub fn spectra(
    title: &str,
    subtitle: &str,
    ordinate: Ordinate,
    scale: Scale,
    limit: Option<f64>,
    curves: &[(String, &Spectrum)],
) -> History {
    let mut panels: Vec<(&Spectrum, Panel)> = Vec::new();
    for (name, spectrum) in curves {
        let count = spectrum
            .positions()
            .iter()
            // positions are multiples of a step, and round
            .take_while(|p| limit.is_none_or(|limit| **p <= limit * (1.0 + 1e-9)))
            .count();
        let curve = Curve {
            name: name.clone(),
            values: spectrum.amplitudes.iter().take(count).copied().collect(),
        };
        let same = panels.iter_mut().find(|(other, panel)| {
            other.axis == spectrum.axis && other.step == spectrum.step && panel.x.len() == count
        });
        match same {
            Some((_, panel)) => panel.curves.push(curve),
            None => panels.push((
                spectrum,
                Panel {
                    title: String::new(),
                    x: spectrum.positions().into_iter().take(count).collect(),
                    curves: vec![curve],
                },
            )),
        }
    }
    let several = panels.len() > 1;
    let description = panels.first().map(|(s, _)| s.description());
    let subtitle = [Some(subtitle.to_owned()), description.filter(|_| !several)]
        .into_iter()
        .flatten()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join("; ");
    let abscissa = match panels.first().map(|(s, _)| s.axis) {
        Some(Axis::Order) => Abscissa::Order,
        _ => Abscissa::Frequency,
    };
    History {
        title: title.to_owned(),
        subtitle,
        abscissa,
        ordinate,
        scale,
        marks: Vec::new(),
        panels: panels
            .into_iter()
            .map(|(spectrum, mut panel)| {
                if several {
                    panel.title = spectrum.description();
                }
                panel
            })
            .collect(),
    }
}
