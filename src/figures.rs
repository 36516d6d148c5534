//! The figures that `eng run` and `eng report` draw without a `report` block.
//!
//! They are trees of the same form as the figures of a `report` block; [`post::draw`] draws both.

use crate::indexed::base;
use crate::machine::JournalGeometry;
use crate::post::{self, ORDERS, PostError, Run};
use crate::results::{CYCLE_ANGLE, Column, Results, TIME, display_unit};
use crate::run::RunOutcome;
use crate::tables::response;
use eng_report::figure::Figure;
use eng_system::Dimension;
use eng_system::expression::{Expression, Function, Member, Window};
use eng_system::figure::{self as plan, Averaging, Axis, Picture, SpectrumSettings, Vector};
use std::f64::consts::TAU;

/// The share of its size by which a column must vary to have a spectrum: the rest is rounding. A choice some
/// decades above the rounding unit, because outputs are sums.
const STILL: f64 = 1e-9;
/// The channel of the angle (rad) by which a journal's pin has turned in its shell. The page adds it to results with a motion;
/// its frame is that of the pin's axes.
pub(crate) const TURN: &str = "turn";

/// A figure that is to be drawn.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// Its name for a file.
    pub name: String,
    /// The title above it.
    pub title: String,
    /// The columns, in the order of the curves.
    pub paths: Vec<String>,
    /// Names of columns with the same values.
    pub same: Vec<String>,
    /// The dimension of the columns.
    pub dimension: Dimension,
    /// Its plan, as a `report` block would state it.
    pub figure: plan::Figure,
}

impl Wanted {
    /// Draws it from the results of runs.
    pub fn draw(&self, runs: &[Run<'_>]) -> Result<Figure, PostError> {
        post::draw(&self.figure, &self.title, runs)
    }

    /// ` The same as main[1].force.x to main[5].force.x.` for the end of a caption.
    pub fn same_as(&self) -> String {
        match self.same.is_empty() {
            true => String::new(),
            false => format!(" The same as {}.", self.same.join(", ")),
        }
    }
}

/// The figures of a run. For a sweep the table over its points is more useful; modes and a single state have no figure of
/// their own.
pub(crate) fn of_outcome(outcome: &RunOutcome) -> Vec<Wanted> {
    let results = &outcome.results;
    match outcome.point.is_empty() {
        true if results.are_responses() => of_response(results),
        true if results.are_samples() => of_run(&Run::new(results, &outcome.machine)),
        _ => Vec::new(),
    }
}

/// Titles and drawings of the figures of a run that `eng run` draws without a `report` block, or the reason why the results
/// give none.
pub fn figures_of(outcome: &RunOutcome) -> Vec<(String, Result<Figure, PostError>)> {
    let run = [Run::new(&outcome.results, &outcome.machine)];
    let wanted = of_outcome(outcome).into_iter();
    wanted
        .map(|wanted| (wanted.title.clone(), wanted.draw(&run)))
        .collect()
}

/// The outputs of the model and the forces of its journals over the samples of a run, then the paths of its
/// pins.
fn of_run(run: &Run<'_>) -> Vec<Wanted> {
    let mut wanted = histories(run);
    wanted.extend(orbits(run));
    wanted
}

/// Amplitude and phase of the outputs of a frequency response, with one figure for each unit.
fn of_response(results: &Results) -> Vec<Wanted> {
    let mut families: Vec<Vec<&Column>> = Vec::new();
    for output in response::outputs(results) {
        let same = |family: &&mut Vec<&Column>| {
            family.first().is_some_and(|c| c.display == output.display)
        };
        match families.iter_mut().find(same) {
            Some(family) => family.push(output),
            None => families.push(vec![output]),
        }
    }
    let several = families.len() > 1;
    let families = families.into_iter().enumerate();
    families
        .filter_map(|(index, family)| {
            let first = family.first()?;
            let paths: Vec<String> = family.iter().map(|c| c.path.clone()).collect();
            let members = paths.iter().map(|path| member(results.analysis(), path));
            Some(Wanted {
                name: match several {
                    true => format!("{}-response-{}", results.analysis(), index + 1),
                    false => format!("{}-response", results.analysis()),
                },
                title: match results.metadata().get("to") {
                    Some(input) => format!("Response to {input}"),
                    None => "Response".to_owned(),
                },
                dimension: first.dimension,
                figure: plan::Figure {
                    quantity: match family.len() {
                        1 => first.path.clone(),
                        _ => "amplitude".to_owned(),
                    },
                    display: first.display.clone(),
                    picture: Picture::Bode(plan::Bode::of(members.collect())),
                },
                paths,
                same: Vec::new(),
            })
        })
        .collect()
}

/// The outputs of the model and the forces of its journals.
pub fn histories(run: &Run<'_>) -> Vec<Wanted> {
    let journals = [0, 1].map(|axis| Family::journal_forces(run, axis));
    let wanted = Family::outputs(run.results).into_iter().chain(journals);
    wanted
        .filter_map(|family| family.history(std::slice::from_ref(run)))
        .collect()
}

/// One figure for each family of outputs that several runs have, and one for the forces of the journals. It has
/// a panel for each run, up to four of one model.
pub(crate) fn comparisons(runs: &[Run<'_>]) -> Vec<Wanted> {
    let Some(first) = runs.first() else {
        return Vec::new();
    };
    let compared: Vec<Run<'_>> = runs
        .iter()
        .filter(|run| run.results.model() == first.results.model())
        .copied()
        .collect();
    if !(2..=4).contains(&compared.len()) {
        return Vec::new();
    }
    let mut wanted = Family::outputs(first.results);
    wanted.push(Family::journal_forces(first, 0));
    wanted
        .iter()
        .filter(|family| {
            let has = |run: &Run<'_>| family.paths.iter().all(|p| run.results.column(p).is_some());
            compared.iter().all(has)
        })
        .filter_map(|family| family.history(&compared))
        .collect()
}

/// Columns that share a pair of axes.
#[derive(Debug)]
struct Family {
    /// Name for the file.
    name: String,
    /// The drawn quantity.
    quantity: String,
    paths: Vec<String>,
}

impl Family {
    /// The model's own outputs (no dot in the path). Outputs with one name and different indices form a family.
    fn outputs(results: &Results) -> Vec<Family> {
        let mut families: Vec<Family> = Vec::new();
        for column in results.columns() {
            if column.path.contains('.') || column.path == TIME {
                continue;
            }
            let name = base(&column.path);
            match families.iter_mut().find(|f| f.name == name) {
                Some(family) => family.paths.push(column.path.clone()),
                None => families.push(Family {
                    name: name.to_owned(),
                    quantity: name.replace('_', " "),
                    paths: vec![column.path.clone()],
                }),
            }
        }
        families
    }

    /// The forces along an axis of the shells: 0 is x, 1 is y.
    fn journal_forces(run: &Run<'_>, axis: usize) -> Family {
        let paths = run.machine.journals.iter().map(|j| j.force[axis].clone());
        let axis = ["x", "y"][axis];
        Family {
            name: format!("journal-force-{axis}"),
            quantity: format!("Journal force {axis} on the pin"),
            paths: paths
                .filter(|path| run.results.column(path).is_some())
                .collect(),
        }
    }

    /// Its history with a panel for each run; `None` if there is nothing to draw.
    fn history(&self, runs: &[Run<'_>]) -> Option<Wanted> {
        let column = runs.first()?.results.column(self.paths.first()?)?;
        let names: Vec<&str> = runs.iter().map(|run| run.results.analysis()).collect();
        let panels = names.iter().map(|analysis| {
            let paths = self.paths.iter();
            paths.map(|path| member(analysis, path)).collect()
        });
        let with_angle = |run: &Run<'_>| run.results.column(CYCLE_ANGLE).is_some();
        Some(Wanted {
            name: format!("{}-{}", names.join("-"), self.name),
            title: post::capital(&self.quantity),
            paths: self.paths.clone(),
            same: Vec::new(),
            dimension: column.dimension,
            figure: plan::Figure {
                quantity: self.quantity.clone(),
                display: column.display.clone(),
                picture: Picture::History(plan::History {
                    panels: panels.collect(),
                    by_time: !runs.iter().all(with_angle),
                }),
            },
        })
    }
}

fn channel(analysis: &str, path: &str) -> Expression {
    Expression::Channel {
        analysis: analysis.to_owned(),
        path: path.to_owned(),
    }
}

fn member(analysis: &str, path: &str) -> Member {
    Member {
        analysis: analysis.to_owned(),
        channel: path.to_owned(),
        expression: channel(analysis, path),
    }
}

/// The figures without those that repeat the values of another. A figure that stays also names the columns of those
/// that repeat it. A force that is also an output of the model is drawn as the output.
pub(crate) fn distinct(all: Vec<Wanted>, results: &Results) -> Vec<Wanted> {
    let values = |path: &String| results.column(path).map(|column| &column.values);
    let mut shown: Vec<Wanted> = Vec::new();
    for wanted in all {
        let same = shown.iter_mut().find(|known| {
            let mut pairs = known.paths.iter().zip(&wanted.paths);
            known.dimension == wanted.dimension
                && known.paths.len() == wanted.paths.len()
                && pairs.all(|(a, b)| values(a).is_some() && values(a) == values(b))
        });
        match (same, wanted.paths.as_slice()) {
            (Some(known), [only]) => known.same.push(only.clone()),
            (Some(known), [first, .., last]) => known.same.push(format!("{first} to {last}")),
            _ => shown.push(wanted),
        }
    }
    shown
}

/// The paths of the pins in their shells; `None` if no journal records one.
pub(crate) fn orbits(run: &Run<'_>) -> Option<Wanted> {
    let analysis = run.results.analysis();
    let recorded = |journal: &&JournalGeometry| {
        let mut columns = journal.eccentricity.iter();
        columns.all(|path| run.results.column(path).is_some())
    };
    let journals: plan::Journals = run
        .machine
        .journals
        .iter()
        .filter(recorded)
        .map(|journal| (analysis.to_owned(), journal.path.clone()))
        .collect();
    (!journals.is_empty()).then(|| Wanted {
        name: format!("{analysis}-orbits"),
        title: "Orbits of the pins in their shells".to_owned(),
        paths: Vec::new(),
        same: Vec::new(),
        dimension: Dimension::LENGTH,
        figure: plan::Orbit::figure(journals, None),
    })
}

/// The loads of the pins on their shells, −force on the pin: in the axes of the shells, and in those of the pins
/// where their [`TURN`] is known.
pub(crate) fn loads(run: &Run<'_>) -> Vec<Wanted> {
    let analysis = run.results.analysis();
    let vector = |journal: &JournalGeometry, turned: bool| {
        let known = |path: &str| run.results.column(path).map(|_| channel(analysis, path));
        let load = |path: &str| {
            let force = known(path)?;
            Some(Expression::Map(Function::Negate, Box::new(force)))
        };
        let [x, y] = &journal.force;
        Some(Vector {
            analysis: analysis.to_owned(),
            path: journal.path.clone(),
            load: true,
            x: load(x)?,
            y: load(y)?,
            turned_by: match turned {
                true => Some(known(&format!("{}.{TURN}", journal.path))?),
                false => None,
            },
        })
    };
    // small loads would be all zeros in kN
    let large = |vector: &Vector| {
        let mut found = false;
        for part in [&vector.x, &vector.y] {
            part.channels(&mut |_, path| {
                let values = run.results.column(path).map(|column| column.values.iter());
                // from 1 kN on
                found |= values.into_iter().flatten().any(|v| v.abs() >= 1e3);
            });
        }
        found
    };
    let figure = |turned: bool| {
        let journals = run.machine.journals.iter();
        let vectors: Vec<Vector> = journals.filter_map(|j| vector(j, turned)).collect();
        let (symbol, scale) = match vectors.iter().any(large) {
            true => ("kN", 1e3),
            false => ("N", 1.0),
        };
        (!vectors.is_empty()).then(|| Wanted {
            name: format!("{analysis}-loads"),
            title: "Load of the pins on their shells".to_owned(),
            paths: Vec::new(),
            same: Vec::new(),
            dimension: Dimension::FORCE,
            figure: plan::Figure {
                quantity: "load".to_owned(),
                display: display_unit(symbol, scale),
                picture: Picture::Polar(plan::Polar {
                    vectors,
                    cycles: None,
                }),
            },
        })
    };
    [figure(false), figure(true)]
        .into_iter()
        .flatten()
        .collect()
}

/// The spectra of the curves of a history that vary; `None` if none of them does, and for other quantities than
/// forces and accelerations.
pub fn spectrum(of: &Wanted, run: &Run<'_>) -> Option<Wanted> {
    if ![Dimension::FORCE, Dimension::ACCELERATION].contains(&of.dimension) {
        return None;
    }
    let analysis = run.results.analysis();
    let paths: Vec<String> = of
        .paths
        .iter()
        .filter(|path| run.results.column(path).is_some_and(varies))
        .cloned()
        .collect();
    let members: Vec<Member> = paths.iter().map(|path| member(analysis, path)).collect();
    let axis = match run.results.column(CYCLE_ANGLE) {
        Some(_) => Axis::Order,
        None => Axis::Frequency,
    };
    let settings = SpectrumSettings {
        axis,
        up_to: (axis == Axis::Order).then_some(ORDERS),
        logarithmic: true,
        ..settings(run)
    };
    (!members.is_empty()).then(|| Wanted {
        name: format!("{}-spectrum", of.name),
        title: format!("Spectrum: {}", of.title),
        paths,
        figure: plan::Figure {
            picture: Picture::Spectrum(plan::Spectrum { members, settings }),
            ..of.figure.clone()
        },
        ..of.clone()
    })
}

fn varies(column: &Column) -> bool {
    let values = column.values.iter().copied();
    let size = values.clone().fold(0.0f64, |most, x| most.max(x.abs()));
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    high - low > STILL * size
}

/// Spectra over frequency, in one block: the window is rectangular if the cycle repeats, else Hann.
fn settings(run: &Run<'_>) -> SpectrumSettings {
    SpectrumSettings {
        window: match run.machine.periodic {
            true => Window::Rectangular,
            false => Window::Hann,
        },
        axis: Axis::Frequency,
        up_to: None,
        block: None,
        overlap: 0.5,
        averaging: Averaging::RootMeanSquare,
        remove_mean: true,
        logarithmic: false,
        reference: None,
    }
}

/// The Campbell diagram of a column over the speeds of several runs, in levels over 1 µN or 1 µm/s² (ISO 1683),
/// with the natural frequencies of linear analyses. `None` for other quantities.
pub(crate) fn campbell(path: &str, runs: &[Run<'_>], modes: Vec<String>) -> Option<Wanted> {
    let first = runs.first()?;
    let column = varying(path, runs)?;
    let symbol = match column.dimension {
        Dimension::FORCE => "N",
        Dimension::ACCELERATION => "m/s^2",
        _ => return None,
    };
    let settings = SpectrumSettings {
        // 1 µN and 1 µm/s² of ISO 1683
        reference: Some(1e-6),
        ..settings(first)
    };
    let quantity = path.replace('_', " ");
    Some(Wanted {
        name: format!("campbell-{path}"),
        title: format!("Campbell diagram: {quantity}"),
        paths: vec![path.to_owned()],
        same: Vec::new(),
        dimension: column.dimension,
        figure: plan::Figure {
            quantity,
            display: display_unit(symbol, 1.0),
            picture: Picture::Campbell(plan::Campbell {
                members: over_runs(path, runs),
                settings,
                orders: None,
                modes,
            }),
        },
    })
}

/// The waterfall of a force or an acceleration over the speeds of several runs, up to a frequency (Hz). `None` for
/// other quantities.
pub(crate) fn waterfall(path: &str, runs: &[Run<'_>], up_to: Option<f64>) -> Option<Wanted> {
    let first = runs.first()?;
    let column = varying(path, runs)?;
    if ![Dimension::FORCE, Dimension::ACCELERATION].contains(&column.dimension) {
        return None;
    }
    let settings = SpectrumSettings {
        up_to,
        ..settings(first)
    };
    let quantity = path.replace('_', " ");
    Some(Wanted {
        name: format!("waterfall-{path}"),
        title: format!("Waterfall: {quantity}"),
        paths: vec![path.to_owned()],
        same: Vec::new(),
        dimension: column.dimension,
        figure: plan::Figure {
            quantity,
            display: column.display.clone(),
            picture: Picture::Waterfall(plan::Waterfall {
                members: over_runs(path, runs),
                settings,
            }),
        },
    })
}

/// The column of the first run in which it varies.
fn varying<'r>(path: &str, runs: &[Run<'r>]) -> Option<&'r Column> {
    let columns = runs.iter().filter_map(|run| run.results.column(path));
    columns.into_iter().find(|column| varies(column))
}

/// Columns of the points of a sweep over the column of its variable; a speed is shown in rpm.
pub(crate) fn over_variable(sweep: &str, title: String, x: &Column, columns: &[&Column]) -> Wanted {
    let (quantity, display) = match x.dimension == Dimension::ANGLE.over(Dimension::TIME) {
        true => ("speed".to_owned(), display_unit("rpm", TAU / 60.0)),
        false => (x.path.replace('_', " "), x.display.clone()),
    };
    let paths: Vec<String> = columns.iter().map(|column| column.path.clone()).collect();
    let first = columns.first().copied().unwrap_or(x);
    Wanted {
        name: format!("{sweep}-points"),
        same: Vec::new(),
        dimension: first.dimension,
        figure: plan::Figure {
            quantity: title.clone(),
            display: first.display.clone(),
            picture: Picture::Xy(plan::Xy {
                x: vec![channel(sweep, &x.path); paths.len()],
                shown: plan::Recorded {
                    quantity,
                    display,
                    dimension: x.dimension,
                },
                y: paths.iter().map(|path| member(sweep, path)).collect(),
                cycles: None,
            }),
        },
        title,
        paths,
    }
}

fn over_runs(path: &str, runs: &[Run<'_>]) -> Vec<Member> {
    let analyses = runs.iter().map(|run| run.results.analysis());
    analyses.map(|analysis| member(analysis, path)).collect()
}
