//! Threads that solve the fields of one evaluation side by side.
//!
//! A film on cells takes as long as all other work of a step, and the films of one evaluation do not depend
//! on each other. Each task owns the fields of one element, with their solvers, and comes back with them. So
//! a solution has the same bits whatever thread makes it, and whatever the number of threads.

use crate::field::Task;
use std::num::NonZeroUsize;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// The tasks of an evaluation.
#[derive(Debug, Default)]
struct Tasks {
    waiting: Vec<Task>,
    ended: Vec<Task>,
    /// Tasks that threads have taken.
    taken: usize,
    closed: bool,
}

/// What the threads share.
#[derive(Debug, Default)]
struct Shared {
    tasks: Mutex<Tasks>,
    /// Tasks wait, or the pool is closed.
    came: Condvar,
    /// The last task that was taken has ended.
    ended: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Tasks> {
        // tasks are whole at every moment, also after a panic elsewhere
        self.tasks.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(on: &Condvar, tasks: MutexGuard<'a, Tasks>) -> MutexGuard<'a, Tasks> {
        on.wait(tasks).unwrap_or_else(PoisonError::into_inner)
    }
}

/// Gives a taken task back, also if its solution panics: then the task is lost, and the caller misses it.
struct Taken<'a> {
    shared: &'a Shared,
    task: Option<Task>,
}

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        let mut tasks = self.shared.lock();
        tasks.taken -= 1;
        tasks.ended.extend(self.task.take());
        if tasks.taken == 0 {
            self.shared.ended.notify_all();
        }
    }
}

/// Works on tasks until none waits; with `stays` until the pool is closed.
fn work(shared: &Shared, stays: bool) {
    let mut tasks = shared.lock();
    loop {
        match tasks.waiting.pop() {
            Some(mut task) => {
                tasks.taken += 1;
                drop(tasks);
                let mut taken = Taken { shared, task: None };
                task.work();
                taken.task = Some(task);
                drop(taken);
                tasks = shared.lock();
            }
            None if stays && !tasks.closed => tasks = Shared::wait(&shared.came, tasks),
            None => return,
        }
    }
}

/// The threads of one model. They start with the first tasks, and wait between evaluations.
#[derive(Debug)]
pub struct ThreadPool {
    shared: Arc<Shared>,
    /// All but the caller's own thread.
    others: usize,
    /// Held by the caller for whom the pool works.
    threads: Mutex<Vec<JoinHandle<()>>>,
}

impl ThreadPool {
    /// A pool of this many threads, the caller's own among them.
    pub fn new(threads: NonZeroUsize) -> ThreadPool {
        ThreadPool {
            shared: Arc::default(),
            others: threads.get() - 1,
            threads: Mutex::default(),
        }
    }

    /// Works on tasks. They come back in any order; one whose solution panics does not. While the pool works
    /// for another caller, this caller's thread does all.
    pub(crate) fn work(&self, tasks: &mut Vec<Task>) {
        let Ok(mut threads) = self.threads.try_lock() else {
            tasks.iter_mut().for_each(Task::work);
            return;
        };
        while threads.len() < self.others {
            let shared = Arc::clone(&self.shared);
            let begun = std::thread::Builder::new()
                .name("fields".into())
                .spawn(move || work(&shared, true));
            match begun {
                Ok(thread) => threads.push(thread),
                // the system has no more threads: those that there are do the work
                Err(_) => break,
            }
        }
        self.shared.lock().waiting.append(tasks);
        self.shared.came.notify_all();
        work(&self.shared, false);
        let mut shared = self.shared.lock();
        while shared.taken > 0 {
            shared = Shared::wait(&self.shared.ended, shared);
        }
        tasks.append(&mut shared.ended);
    }
}

impl Drop for ThreadPool {
    fn drop(&mut self) {
        self.shared.lock().closed = true;
        self.shared.came.notify_all();
        let threads = self.threads.get_mut();
        for thread in threads.unwrap_or_else(PoisonError::into_inner).drain(..) {
            // a thread that panicked has printed its message
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Demand, LaneField, Own, Wanted};
    use eng_system::field::{Accuracy, FieldError, FieldSolver, Past};

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

    fn tasks(drives: &[f64]) -> Vec<Task> {
        let task = |(at, drive): (usize, &f64)| Task {
            at,
            fields: vec![LaneField {
                solver: Box::new(Twice),
                drives: vec![*drive],
                answers: vec![0.0],
                own: Own {
                    drives: 1,
                    answers: 1,
                },
                surface: None,
                readings: Vec::new(),
                is_read: false,
                slopes: vec![0.0],
                has_slopes: false,
                memory: 0,
                before: Vec::new(),
                since: None,
                waits: true,
            }],
            wanted: Wanted::Solution(Demand::Answers),
            done: Ok(()),
        };
        drives.iter().enumerate().map(task).collect()
    }

    #[test]
    fn tasks_come_back_with_their_answers() {
        for threads in 1..=4 {
            let thread_pool = ThreadPool::new(NonZeroUsize::new(threads).unwrap());
            for _ in 0..100 {
                let drives: Vec<f64> = (0..20).map(|k| f64::from(k) - 0.5).collect();
                let mut tasks = tasks(&drives);
                thread_pool.work(&mut tasks);
                tasks.sort_by_key(|task| task.at);
                assert_eq!(tasks.len(), drives.len());
                for (task, drive) in tasks.iter().zip(&drives) {
                    assert_eq!(task.fields[0].answers[0], 2.0 * drive);
                    assert_eq!(task.done.is_ok(), *drive > 0.0);
                }
            }
        }
    }

    /// A panic ends one thread and loses one task. The caller neither waits for it nor takes it for solved.
    #[test]
    fn a_panic_loses_its_task_alone() {
        let thread_pool = ThreadPool::new(NonZeroUsize::new(2).unwrap());
        let mut found = tasks(&[1.0, 2.0, -3.0, 4.0]);
        let worked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            thread_pool.work(&mut found);
        }));
        // without a catch the panic of the caller's own thread goes on
        if worked.is_ok() {
            assert_eq!(found.len(), 3);
        }
        drop(thread_pool);
    }
}
