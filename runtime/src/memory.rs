//! Numbers that fields keep from step to step, such as the oil in the cells of a film.
//!
//! Within a step and in its samples, fields continue from their memory at the beginning of the step. An accepted
//! step writes a new memory for the next step. So rejected trials change nothing, and a sample at the end of a
//! step has the field that the step had there.

use crate::model::Model;
use eng_system::field::Past;

/// Shortest time that a field continues over (s). At the beginning of a step the content of a film has had no
/// time to change. A choice far below any step, so that divisions by the time remain finite.
const SHORTEST: f64 = 1e-10;

/// The memory of all fields of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memory {
    /// Beginning of the present step (s); none before the first step, when all fields are in balance.
    begin: Option<f64>,
    before: Vec<f64>,
    /// The last accepted moment (s).
    reached: f64,
    after: Vec<f64>,
}

impl Memory {
    /// Memory for a model's fields, without a past.
    pub fn new(model: &Model) -> Memory {
        Memory {
            begin: None,
            before: vec![0.0; model.memory],
            reached: 0.0,
            after: vec![0.0; model.memory],
        }
    }

    /// Begins a step at the last accepted moment.
    pub fn begin_step(&mut self) {
        self.begin = Some(self.reached);
        self.before.copy_from_slice(&self.after);
    }

    /// The numbers at an accepted moment (s), for writing.
    pub fn accept(&mut self, time: f64) -> &mut [f64] {
        self.reached = time;
        &mut self.after
    }

    /// The memory of a field of `count` numbers from `first` on, for a solution at a time (s).
    pub fn past(&self, time: f64, first: usize, count: usize) -> Option<Past<'_>> {
        let begin = self.begin?;
        Some(Past {
            step: (time - begin).max(SHORTEST),
            memory: self.before.get(first..first + count)?,
        })
    }

    /// All numbers, for a checkpoint.
    pub fn numbers(&self) -> Vec<f64> {
        let mut numbers = vec![
            f64::from(u8::from(self.begin.is_some())),
            self.begin.unwrap_or_default(),
            self.reached,
        ];
        numbers.extend(self.before.iter().chain(&self.after));
        numbers
    }

    /// Takes the numbers of a checkpoint of the same model.
    pub fn set_numbers(&mut self, numbers: &[f64]) {
        let [known, begin, reached, rest @ ..] = numbers else {
            return;
        };
        self.begin = (*known != 0.0).then_some(*begin);
        self.reached = *reached;
        for (place, number) in self.before.iter_mut().chain(&mut self.after).zip(rest) {
            *place = *number;
        }
    }
}
