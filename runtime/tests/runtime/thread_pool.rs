//! Fields solved by several threads.

use eng_runtime::internals::{ThreadPool, answers};
use eng_system::field::{Accuracy, FieldError, FieldSolver, Past};
use std::num::NonZeroUsize;

/// Answers twice its drive. Without a positive one it has no solution, and none at all below -1: then it panics.
#[derive(Clone, Debug)]
struct Twice;

impl FieldSolver for Twice {
    fn solve(
        &mut self,
        drives: &[f64],
        _: Option<Past<'_>>,
        _: Accuracy,
        answers: &mut [f64],
    ) -> Result<(), FieldError> {
        assert!(drives[0] > -1.0, "this panic belongs to the test");
        answers[0] = 2.0 * drives[0];
        match drives[0] > 0.0 {
            true => Ok(()),
            false => Err(FieldError("none".into())),
        }
    }
    fn accept(&self, _: &mut [f64]) {}
    fn undecided(&self) -> f64 {
        0.0
    }
    fn tangent(&mut self, slopes: &mut [f64]) {
        slopes.fill(2.0);
    }
    fn read(&mut self, _: &mut [f64], _: bool) {}
    fn cells(&self, _: usize, _: &mut [f64]) {}
    fn boxed(&self) -> Box<dyn FieldSolver> {
        Box::new(self.clone())
    }
}

#[test]
fn tasks_come_back_with_their_answers() {
    for threads in 1..=4 {
        let thread_pool = ThreadPool::new(NonZeroUsize::new(threads).unwrap());
        for _ in 0..100 {
            let drives: Vec<f64> = (0..20).map(|k| f64::from(k) - 0.5).collect();
            let mut found = answers(&thread_pool, &Twice, &drives);
            found.sort_by_key(|(at, _)| *at);
            assert_eq!(found.len(), drives.len());
            for ((_, answer), drive) in found.iter().zip(&drives) {
                assert_eq!(*answer, (*drive > 0.0).then_some(2.0 * drive));
            }
        }
    }
}

/// A panic ends one thread and loses one task. The caller neither waits for it nor takes it for solved.
#[test]
fn a_panic_loses_its_task_alone() {
    let thread_pool = ThreadPool::new(NonZeroUsize::new(2).unwrap());
    let worked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        answers(&thread_pool, &Twice, &[1.0, 2.0, -3.0, 4.0])
    }));
    // without a catch the panic of the caller's own thread goes on
    if let Ok(found) = worked {
        assert_eq!(found.len(), 3);
    }
    drop(thread_pool);
}
