//! The end of a run that takes too long for a page.

use eng::Progress;

/// The most steps of a request that states none. A choice: minutes of a small model in a browser.
const MOST_STEPS: u64 = 5_000_000;

/// Counts the steps of all analyses of a request, and asks the page after each whether its time is over.
pub struct Limits<'h> {
    most: u64,
    /// Steps of the analyses that have ended.
    before: u64,
    /// Steps of the present analysis.
    now: u64,
    /// Takes the finished part of the present analysis and its steps; false ends the run.
    goes_on: &'h mut dyn FnMut(f64, u64) -> bool,
    over: Option<String>,
}

impl<'h> Limits<'h> {
    /// A limit on the number of steps, besides that of the page.
    pub fn new(most: Option<u64>, goes_on: &'h mut dyn FnMut(f64, u64) -> bool) -> Limits<'h> {
        Limits {
            most: most.unwrap_or(MOST_STEPS),
            before: 0,
            now: 0,
            goes_on,
            over: None,
        }
    }

    /// Notes progress of the present analysis. Returns whether it goes on.
    pub fn stepped(&mut self, progress: Progress) -> bool {
        // the first steps of an analysis have less than those of the one before it
        if progress.steps < self.now {
            self.before += self.now;
        }
        self.now = progress.steps;
        let (steps, percent) = (self.before + self.now, 100.0 * progress.fraction);
        let reached = if steps > self.most {
            format!("{} steps, the most of the playground", self.most)
        } else if !(self.goes_on)(progress.fraction, self.now) {
            "the time of the playground".to_owned()
        } else {
            return true;
        };
        self.over = Some(format!(
            "stopped after {reached}, at {percent:.1} % of the run: shorten it, or run the text with the command `eng`, which has no such limit and is several times faster"
        ));
        false
    }

    /// Ends the count of an analysis.
    pub fn ended(&mut self) {
        self.before += std::mem::take(&mut self.now);
    }

    /// Why the runs were stopped.
    pub fn over(&self) -> Option<&str> {
        self.over.as_deref()
    }
}
