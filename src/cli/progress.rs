//! The progress bars of runs, and below them the words about the files that remain after Ctrl-C.

use crate::Progress;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// One bar for each analysis that runs.
pub struct Bars {
    all: MultiProgress,
    shown: Vec<Option<ProgressBar>>,
    /// The words below the bars. They stay on the terminal when Ctrl-C ends the command.
    advice: Option<&'static str>,
    /// The line with the words, while a bar is drawn.
    pub below: Option<ProgressBar>,
}

impl Bars {
    /// Bars for a number of analyses on the process's standard error. Hidden bars draw nothing.
    pub fn new(analyses: usize, hidden: bool, advice: Option<&'static str>) -> Bars {
        let target = match hidden {
            true => ProgressDrawTarget::hidden(),
            false => ProgressDrawTarget::stderr(),
        };
        Bars {
            all: MultiProgress::with_draw_target(target),
            shown: vec![None; analyses],
            advice,
            below: None,
        }
    }

    /// Moves the bar of an analysis. The first call draws it.
    pub fn show(&mut self, index: usize, name: &str, progress: Progress) {
        let Some(bar) = self.shown.get_mut(index) else {
            return;
        };
        if self.below.is_none()
            && let Some(advice) = self.advice
        {
            let below = self.all.add(line());
            below.set_message(advice);
            self.below = Some(below);
        }
        let bar = bar.get_or_insert_with(|| match &self.below {
            Some(below) => self.all.insert_before(below, progress_bar(name)),
            None => self.all.add(progress_bar(name)),
        });
        show_progress(bar, progress);
    }

    /// Removes the bar of an analysis, and with the last one the words below.
    pub fn end(&mut self, index: usize) {
        if let Some(bar) = self.shown.get_mut(index).and_then(Option::take) {
            bar.finish_and_clear();
            self.all.remove(&bar);
        }
        if self.shown.iter().all(Option::is_none)
            && let Some(below) = self.below.take()
        {
            below.finish_and_clear();
            self.all.remove(&below);
        }
    }

    /// Writes a text while no bar is drawn.
    pub fn suspend(&self, write: impl FnOnce()) {
        self.all.suspend(write);
    }
}

/// Length of a full bar: a run advances it in thousandths.
const BAR: u64 = 1000;

/// The bar of an analysis.
pub fn progress_bar(analysis: &str) -> ProgressBar {
    let target = ProgressDrawTarget::hidden();
    let bar = ProgressBar::with_draw_target(Some(BAR), target).with_prefix(analysis.to_owned());
    let template = "{prefix} {wide_bar} {percent:>3} %  {msg}  {eta} left";
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style.progress_chars("━╸─")),
        Err(_) => bar,
    }
}

/// A line of words.
fn line() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
    match ProgressStyle::with_template("{msg}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Moves a bar, and states the place of the run beside it.
pub fn show_progress(bar: &ProgressBar, progress: Progress) {
    bar.set_message(place(progress));
    bar.set_position((progress.fraction.clamp(0.0, 1.0) * BAR as f64) as u64);
}

/// `1260 °CA`, or the time of a model without cycle.
pub fn place(progress: Progress) -> String {
    if let Some((cycles, change)) = progress.cycles {
        return match change {
            Some(change) => format!("{cycles} cycles, {:.3} % change", 100.0 * change),
            None => format!("{cycles} cycles"),
        };
    }
    match progress.cycle_angle {
        Some(angle) => format!("{:.0} °CA", angle.to_degrees()),
        None => format!("{:.6} s", progress.time),
    }
}
