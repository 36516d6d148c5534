//! A field of an element: its numbers at a state, and its solution.

use eng_system::field::{Accuracy, FieldError, FieldSolver, Past};

/// The numbers of fields that a caller needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Demand {
    /// Answers of an iterate of Newton's method, from which loads follow.
    Iterate,
    /// Answers.
    Answers,
    /// Answers, and readings without derivatives: conditions are checked at every step.
    Conditions,
    /// Answers and all readings.
    Readings,
}

impl Demand {
    /// Whether answers are enough.
    pub fn is_answers(self) -> bool {
        matches!(self, Demand::Iterate | Demand::Answers)
    }
}

/// The work that fields wait for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// A solution at the drives.
    Solution(Demand),
    /// The derivatives of the last solution.
    Slopes,
}

/// Why a field has no numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Trouble {
    /// Its drives or its results are not finite.
    NotFinite,
    /// The reason of its solver.
    Solver(FieldError),
}

/// A field of the element in a lane, with its numbers at the gathered state.
#[derive(Clone, Debug)]
pub(crate) struct LaneField {
    pub solver: Box<dyn FieldSolver>,
    /// Drives: those that the element computes, then the amplitudes of an elastic surface and their rates.
    pub drives: Vec<f64>,
    /// Answers: those that the element uses, then the forces of the shapes.
    pub answers: Vec<f64>,
    /// Counts of drives and answers without those of the surface.
    pub own: Own,
    /// Index of the elastic surface.
    pub surface: Option<usize>,
    pub readings: Vec<f64>,
    /// Whether the readings without derivatives are those of the last solution.
    pub is_read: bool,
    /// Derivatives of the answers by the drives, answer by answer, and whether they have ever been computed.
    pub slopes: Vec<f64>,
    pub has_slopes: bool,
    /// First of the numbers that the field remembers.
    pub memory: usize,
    /// These numbers at the beginning of the step, and the time since then (s); without a time it is in balance.
    pub before: Vec<f64>,
    pub since: Option<f64>,
    /// Whether a task has to work on it.
    pub waits: bool,
}

/// Numbers of drives and answers that an element has of a field.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Own {
    pub drives: usize,
    pub answers: usize,
}

impl LaneField {
    /// Derivatives of the answers from `first` on by the drives, answer by answer.
    pub fn slopes_from(&self, first: usize) -> impl Iterator<Item = &[f64]> {
        self.slopes.chunks_exact(self.drives.len()).skip(first)
    }

    /// The forces of the shapes.
    pub fn shape_forces(&self) -> &[f64] {
        &self.answers[self.own.answers..]
    }

    /// The change of the answers from `first` on with changes of the drives of the element, and of the
    /// amplitudes of the surface and their rates (empty for none).
    pub fn changes<'a>(
        &'a self,
        first: usize,
        drives: impl Fn(usize) -> f64 + 'a,
        surface: &'a [f64],
    ) -> impl Iterator<Item = f64> + 'a {
        self.slopes_from(first).map(move |row| {
            let (own, of_surface) = row.split_at(self.own.drives);
            let by_element: f64 = own
                .iter()
                .enumerate()
                .map(|(i, slope)| slope * drives(i))
                .sum();
            let by_surface: f64 = of_surface
                .iter()
                .zip(surface)
                .map(|(slope, x)| slope * x)
                .sum();
            by_element + by_surface
        })
    }

    /// Appends the numbers with which it continues: its derivatives, and those of its solver.
    pub fn kept(&self, numbers: &mut Vec<f64>) {
        numbers.push(f64::from(u8::from(self.has_slopes)));
        if self.has_slopes {
            numbers.extend_from_slice(&self.slopes);
        }
        self.solver.kept(numbers);
    }

    /// Takes such numbers, and returns those after them.
    pub fn keep<'n>(&mut self, numbers: &'n [f64]) -> &'n [f64] {
        let Some((known, mut others)) = numbers.split_first() else {
            return &[];
        };
        self.has_slopes = false;
        if *known == 1.0 {
            let Some((slopes, rest)) = others.split_at_checked(self.slopes.len()) else {
                return &[];
            };
            self.slopes.copy_from_slice(slopes);
            (self.has_slopes, others) = (true, rest);
        }
        self.solver.keep(others)
    }

    /// Whether its solution and readings are those of a field with the numbers of another.
    pub fn is_solved_as(&self, other: &LaneField) -> bool {
        let numbers = |field: &LaneField| (field.since, field.memory);
        self.is_read
            && numbers(self) == numbers(other)
            && self.drives == other.drives
            && self.before == other.before
    }

    /// Copies the solution and the readings of another field.
    pub fn copy_from(&mut self, other: &LaneField) {
        self.answers.copy_from_slice(&other.answers);
        self.readings.copy_from_slice(&other.readings);
    }

    /// Solves or differentiates it.
    fn work(&mut self, wanted: Wanted) -> Result<(), Trouble> {
        let finite = |numbers: &[f64]| match numbers.iter().all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err(Trouble::NotFinite),
        };
        let Wanted::Solution(demand) = wanted else {
            self.solver.tangent(&mut self.slopes);
            let known = finite(&self.slopes);
            self.has_slopes = known.is_ok();
            return known;
        };
        self.is_read = false;
        // drives that are not finite come from the element, whose own error names the table
        finite(&self.drives)?;
        let past = self.since.map(|step| Past {
            step,
            memory: &self.before,
        });
        let accuracy = match demand {
            Demand::Iterate => Accuracy::Iterate,
            _ => Accuracy::Full,
        };
        let answers = &mut self.answers;
        let solved = self.solver.solve(&self.drives, past, accuracy, answers);
        solved.map_err(Trouble::Solver)?;
        finite(&self.answers)?;
        if !demand.is_answers() {
            let slopes = demand == Demand::Readings;
            self.solver.read(&mut self.readings, slopes);
        }
        Ok(())
    }
}

/// Works on those fields of an element that wait for it.
pub(crate) fn work(fields: &mut [LaneField], wanted: Wanted) -> Result<(), Trouble> {
    let mut waiting = fields.iter_mut().filter(|field| field.waits);
    waiting.try_for_each(|field| field.work(wanted))
}

/// The fields of an element on their way to a thread and back.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    /// The place of the element's fields.
    pub at: usize,
    pub fields: Vec<LaneField>,
    pub wanted: Wanted,
    pub done: Result<(), Trouble>,
}

impl Task {
    /// Works on the fields.
    pub fn work(&mut self) {
        self.done = work(&mut self.fields, self.wanted);
    }
}
