//! A chosen number of threads.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

/// The threads that the stages of a step run on. One thread runs in the caller, without a pool.
#[derive(Clone, Debug, Default)]
pub struct Team(Option<Arc<rayon::ThreadPool>>);

/// Bytes of stack of a thread: kernels compiled without optimisation take much of it.
const STACK: usize = 8 << 20;

/// Why a team could not be made.
#[derive(Debug, thiserror::Error)]
#[error("could not start {threads} threads: {cause}")]
pub struct TeamError {
    threads: usize,
    cause: String,
}

impl Team {
    /// The caller's thread alone.
    pub fn one() -> Self {
        Team(None)
    }

    /// `threads` threads, at least one.
    ///
    /// # Errors
    /// Zero threads, or the operating system refuses.
    pub fn new(threads: usize) -> Result<Self, TeamError> {
        match threads {
            0 => Err(TeamError { threads, cause: "at least one is needed".into() }),
            1 => Ok(Team(None)),
            _ => rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .stack_size(STACK)
                .build()
                .map(|pool| Team(Some(Arc::new(pool))))
                .map_err(|e| TeamError { threads, cause: e.to_string() }),
        }
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.0.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// Run `work`, which makes many loops, on one of the threads: no loop then waits for the caller to fall
    /// asleep and wake up.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            None => work(),
            Some(pool) => pool.install(work),
        }
    }

    /// `task` on every element, in any order: a task must touch only what it is given.
    pub fn each<X: Send>(&self, items: &mut [X], task: impl Fn(usize, &mut X) + Send + Sync) {
        match &self.0 {
            None => items.iter_mut().enumerate().for_each(|(i, x)| task(i, x)),
            Some(pool) => {
                pool.install(|| items.par_iter_mut().enumerate().for_each(|(i, x)| task(i, x)));
            }
        }
    }

    /// `task` on every part `starts[i]..starts[i + 1]` of `items`, with the matching element of `with`.
    pub fn each_part<X: Send, Y: Send>(
        &self,
        items: &mut [X],
        starts: &[u32],
        with: &mut [Y],
        task: impl Fn(usize, &mut [X], &mut Y) + Send + Sync,
    ) {
        match &self.0 {
            None => parts(items, starts, 0, with, usize::MAX, &task),
            Some(pool) => {
                let grain = with.len() / (16 * pool.current_num_threads()) + 1;
                pool.install(|| parts(items, starts, 0, with, grain, &task));
            }
        }
    }

    /// `task` on every element with memory of the thread it runs on, of which there must be one for each thread; what
    /// the task makes must not depend on what it finds there.
    pub fn each_with<X: Send, S: Send>(
        &self,
        items: &mut [X],
        memory: &[Mutex<S>],
        task: impl Fn(usize, &mut X, &mut S) + Send + Sync,
    ) {
        self.each(items, |i, x| task(i, x, &mut self.own(memory)));
    }

    /// In a task: the memory of the thread it runs on, of which there must be one for each thread. To be let go before
    /// the task ends.
    pub fn own<'a, S>(&self, memory: &'a [Mutex<S>]) -> MutexGuard<'a, S> {
        let thread = rayon::current_thread_index().filter(|_| self.0.is_some()).unwrap_or(0);
        // No other thread waits for it. A task that panicked leaves nothing that the next would trust.
        memory[thread % memory.len()].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// `task` on every piece of `length` elements of `items`, with the matching element of `with`.
    pub fn each_piece<X: Send, Y: Send>(
        &self,
        items: &mut [X],
        length: usize,
        with: &mut [Y],
        task: impl Fn(usize, &mut [X], &mut Y) + Send + Sync,
    ) {
        match &self.0 {
            None => {
                let pairs = items.chunks_mut(length).zip(with.iter_mut());
                pairs.enumerate().for_each(|(i, (x, y))| task(i, x, y));
            }
            Some(pool) => pool.install(|| {
                let pairs = items.par_chunks_mut(length).zip(with.par_iter_mut());
                pairs.enumerate().for_each(|(i, (x, y))| task(i, x, y));
            }),
        }
    }
}

/// The parts from `first` on, in halves until they are few.
fn parts<X: Send, Y: Send>(
    items: &mut [X],
    starts: &[u32],
    first: usize,
    with: &mut [Y],
    grain: usize,
    task: &(impl Fn(usize, &mut [X], &mut Y) + Send + Sync),
) {
    let start = |part: usize| (starts[part] - starts[first]) as usize;
    if with.len() <= grain {
        let mut rest = items;
        for (i, with) in with.iter_mut().enumerate() {
            let length = start(first + i + 1) - start(first + i);
            let (part, after) = rest.split_at_mut(length);
            task(first + i, part, with);
            rest = after;
        }
        return;
    }
    let middle = with.len() / 2;
    let (left, right) = items.split_at_mut(start(first + middle));
    let (with_left, with_right) = with.split_at_mut(middle);
    rayon::join(
        || parts(left, starts, first, with_left, grain, task),
        || parts(right, starts, first + middle, with_right, grain, task),
    );
}
