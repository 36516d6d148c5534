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
