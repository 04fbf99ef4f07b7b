//! Thread team: parallel loops on a chosen number of threads.

use std::cell::RefCell;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use rayon::prelude::*;

use crate::crew::{self, Crew};

/// Threads that run the stages of a step. A team of one thread runs in the caller.
///
/// The thread that calls a loop takes part in it. Each thread has an index range of the loop, the same in the next loop
/// of equal length, so that its data are in its cache; a finished thread steals from the ranges of others. A loop
/// within a loop runs in its calling thread. An idle thread spins for a moment before it sleeps.
///
/// A forked child process inherits teams without their threads. A team starts as many threads again when the child first uses it; if the
/// operating system refuses them, loops run in the caller, with the same results.
#[derive(Clone, Debug, Default)]
pub struct Team(Threads);

#[derive(Clone, Debug, Default)]
enum Threads {
    /// The caller's thread.
    #[default]
    One,
    /// Threads of a pool.
    Crew(Arc<Crews>),
    /// Threads of the team whose [`Team::run`] the caller is in, else of the pool of rayon that it runs in.
    Ambient,
}

/// Pools of `threads` threads, one per process.
#[derive(Debug)]
struct Crews {
    threads: usize,
    first: OnceLock<Box<Started>>,
}

/// Pool of a process; the next one belongs to a child that was forked from it.
#[derive(Debug)]
struct Started {
    process: u32,
    /// None if the operating system refused threads.
    crew: Option<Crew>,
    next: OnceLock<Box<Started>>,
}

impl Crews {
    /// Return the pool of this process. The list is append-only without a lock: a lock that a thread of the parent held
    /// at the fork would never be released.
    fn here(&self) -> Option<&Crew> {
        let mut place = &self.first;
        let process = process();
        while let Some(started) = place.get() {
            // Check the last entry only, since process IDs are reused.
            if started.next.get().is_none() && started.process == process {
                return started.crew.as_ref();
            }
            place = &started.next;
        }
        place
            .get_or_init(|| Box::new(Started::new(process, Crew::new(self.threads, STACK).ok())))
            .crew
            .as_ref()
    }
}

impl Started {
    fn new(process: u32, crew: Option<Crew>) -> Self {
        Started { process, crew, next: OnceLock::new() }
    }
}

impl Drop for Started {
    fn drop(&mut self) {
        // A child has no threads to end, and mutexes of the crew may have been locked at the fork.
        if self.process != process() {
            std::mem::forget(self.crew.take());
        }
    }
}

thread_local! {
    /// Team whose [`Team::run`] this thread is in.
    static AMBIENT: RefCell<Option<Team>> = const { RefCell::new(None) };
}

/// ID of this process, which differs in a forked child; 0 on systems without fork.
fn process() -> u32 {
    if cfg!(unix) { std::process::id() } else { 0 }
}

/// True if this process was forked from one that used the global pool of rayon, whose threads it does not have.
fn forked() -> bool {
    /// ID of the process that first used the global pool; 0 before.
    static HOME: AtomicU32 = AtomicU32::new(0);
    let process = process();
    let home = HOME.compare_exchange(0, process, Ordering::Relaxed, Ordering::Relaxed);
    home.is_err_and(|home| home != process)
}

/// Stack size of a thread, bytes: kernels compiled without optimisation need much of it.
const STACK: usize = 8 << 20;

/// Error in the creation of a team.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TeamError {
    /// Number of threads out of range.
    #[error("team: threads = {threads} is not allowed; it must be 1 to {}", Team::MOST)]
    Threads {
        /// Requested number of threads.
        threads: usize,
    },
    /// Threads refused by the operating system.
    #[error("team: {threads} threads could not be started: {cause}")]
    Refused {
        /// Requested number of threads.
        threads: usize,
        /// Message of the operating system.
        cause: String,
    },
}

/// Slice shared by tasks, each element accessed by one task alone.
///
/// **Invariant:** `take` and `part` are called from loops of [`Team`] only, with indices that no two tasks share.
struct Shared<'a, X> {
    first: *mut X,
    length: usize,
    slice: PhantomData<&'a mut [X]>,
}

// SAFETY: it stands for a `&mut [X]` of which every task has a part of its own.
unsafe impl<X: Send> Sync for Shared<'_, X> {}

impl<'a, X> Shared<'a, X> {
    fn of(slice: &'a mut [X]) -> Self {
        Shared { first: slice.as_mut_ptr(), length: slice.len(), slice: PhantomData }
    }
    /// # Safety
    /// No other task accesses any of these elements.
    #[allow(clippy::mut_from_ref)]
    unsafe fn part(&self, start: usize, end: usize) -> &mut [X] {
        assert!(start <= end && end <= self.length, "a part of a slice lies in it");
        // SAFETY: within the slice, and nobody else's.
        unsafe { std::slice::from_raw_parts_mut(self.first.add(start), end - start) }
    }
    /// # Safety
    /// No other task accesses this element.
    #[allow(clippy::mut_from_ref)]
    unsafe fn take(&self, place: usize) -> &mut X {
        assert!(place < self.length, "an element of a slice lies in it");
        // SAFETY: within the slice, and nobody else's.
        unsafe { &mut *self.first.add(place) }
    }
}

impl Team {
    /// Largest number of threads of a team: more than the processors of a shared-memory machine, with few exceptions,
    /// beyond which threads wait for each other. So many start in about a second; ten thousand took a minute, and 80 GB
    /// of address space for their stacks.
    pub const MOST: usize = 1024;

    /// Create a team of the caller's thread alone.
    pub fn one() -> Self {
        Team(Threads::One)
    }

    /// Create a team of the threads of the team whose [`Team::run`] the caller is in, else of the pool of rayon that it
    /// runs in, else of rayon's global pool; in a child that was forked when the global pool was in use, of the
    /// caller's thread.
    pub fn ambient() -> Self {
        Team(Threads::Ambient)
    }

    /// Create a team of `threads` threads, 1 to [`Team::MOST`].
    ///
    /// # Errors
    /// A number of threads out of range, or threads refused by the operating system.
    pub fn new(threads: usize) -> Result<Self, TeamError> {
        match threads {
            1 => Ok(Team(Threads::One)),
            2..=Self::MOST => {
                let crew = Crew::new(threads, STACK)
                    .map_err(|e| TeamError::Refused { threads, cause: e.to_string() })?;
                let crews = Crews { threads, first: Box::new(Started::new(process(), Some(crew))).into() };
                Ok(Team(Threads::Crew(Arc::new(crews))))
            }
            _ => Err(TeamError::Threads { threads }),
        }
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        match &self.0 {
            Threads::One => 1,
            Threads::Crew(crews) => crews.threads,
            Threads::Ambient => match Self::around() {
                Some(team) => team.threads(),
                None if forked() => 1,
                None => rayon::current_num_threads(),
            },
        }
    }

    /// Return the team whose [`Team::run`] the caller is in.
    fn around() -> Option<Team> {
        AMBIENT.with_borrow(Clone::clone)
    }

    /// Run `work` in this thread, while loops of the team in other threads use one thread less, at least that of their
    /// caller.
    pub fn lend<R>(&self, work: impl FnOnce() -> R) -> R {
        /// Guard that takes the thread back, also if `work` panics.
        struct Lent<'a>(&'a Crew);
        impl Drop for Lent<'_> {
            fn drop(&mut self) {
                self.0.lend(false);
            }
        }
        let crew = if let Threads::Crew(crews) = &self.0 { crews.here() } else { None };
        let _lent = crew.map(|crew| {
            crew.lend(true);
            Lent(crew)
        });
        work()
    }

    /// Run `work` so that loops of [`Team::ambient`] in it run on this team, too.
    pub fn run<R>(&self, work: impl FnOnce() -> R) -> R {
        /// Guard that restores the previous team, also if `work` panics.
        struct Before(Option<Team>);
        impl Drop for Before {
            fn drop(&mut self) {
                AMBIENT.set(self.0.take());
            }
        }
        if matches!(self.0, Threads::Ambient) {
            return work();
        }
        let _before = Before(AMBIENT.replace(Some(self.clone())));
        work()
    }

    /// Run `task` once for every number below `count`, in any order. Not generic, so that loops over threads are
    /// compiled once and not for each of their tasks.
    #[inline(never)]
    fn each_number(&self, count: usize, task: &(dyn Fn(usize) + Send + Sync)) {
        match &self.0 {
            Threads::Crew(crews) => match crews.here() {
                Some(crew) => crew.each(count, task),
                None => (0..count).for_each(task),
            },
            Threads::Ambient if crew::in_loop() => (0..count).for_each(task),
            Threads::Ambient => match Self::around() {
                Some(team) => team.each_number(count, task),
                None if forked() => (0..count).for_each(task),
                None => (0..count).into_par_iter().for_each(task),
            },
            Threads::One => (0..count).for_each(task),
        }
    }

    /// Run `task` on every element, in any order: a task must access its own element only.
    pub fn each<X: Send>(&self, items: &mut [X], task: impl Fn(usize, &mut X) + Send + Sync) {
        let count = items.len();
        let items = Shared::of(items);
        // SAFETY: every number comes once.
        self.each_number(count, &|i| task(i, unsafe { items.take(i) }));
    }

    /// Run `task` on every part `starts[i]..starts[i + 1]` of `items`, with the matching element of `with`.
    ///
    /// # Panics
    /// Starts that are not sorted, or fewer than one more than the elements of `with`.
    pub fn each_part<X: Send, Y: Send>(
        &self,
        items: &mut [X],
        starts: &[u32],
        with: &mut [Y],
        task: impl Fn(usize, &mut [X], &mut Y) + Send + Sync,
    ) {
        let count = with.len();
        assert!(starts[..=count].is_sorted(), "parts do not overlap");
        let (items, with) = (Shared::of(items), Shared::of(with));
        self.each_number(count, &|i| {
            // SAFETY: every number comes once, and parts do not overlap.
            let (part, with) =
                unsafe { (items.part(starts[i] as usize, starts[i + 1] as usize), with.take(i)) };
            task(i, part, with);
        });
    }

    /// Run `task` on every element with the scratch memory of its thread, one entry of `memory` per thread; the result
    /// of a task must not depend on the previous content.
    pub fn each_with<X: Send, S: Send>(
        &self,
        items: &mut [X],
        memory: &[Mutex<S>],
        task: impl Fn(usize, &mut X, &mut S) + Send + Sync,
    ) {
        self.each(items, |i, x| task(i, x, &mut self.own(memory)));
    }

    /// Lock the scratch memory of the current thread in a task, one entry of `memory` per thread. Release it before the
    /// task ends.
    pub fn own<'a, S>(&self, memory: &'a [Mutex<S>]) -> MutexGuard<'a, S> {
        let thread = match &self.0 {
            Threads::One => 0,
            Threads::Ambient if !crew::in_loop() && Self::around().is_none() => {
                rayon::current_thread_index().unwrap_or(0)
            }
            _ => crew::thread(),
        };
        // No other thread waits for it. No task relies on the content that a panicked task left.
        memory[thread % memory.len()].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Run `task` on every piece of `length` elements of `items`, with the matching element of `with`.
    pub fn each_piece<X: Send, Y: Send>(
        &self,
        items: &mut [X],
        length: usize,
        with: &mut [Y],
        task: impl Fn(usize, &mut [X], &mut Y) + Send + Sync,
    ) {
        let (end, count) = (items.len(), items.len().div_ceil(length).min(with.len()));
        let (items, with) = (Shared::of(items), Shared::of(with));
        self.each_number(count, &|i| {
            let start = i * length;
            // SAFETY: every number comes once, and pieces do not overlap.
            let (piece, with) = unsafe { (items.part(start, (start + length).min(end)), with.take(i)) };
            task(i, piece, with);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_threads_that_no_team_has_are_refused_at_once() {
        for threads in [0, Team::MOST + 1, 10_000, usize::MAX] {
            let said = Team::new(threads).expect_err("refused");
            assert_eq!(said, TeamError::Threads { threads });
            let expected = format!("team: threads = {threads} is not allowed; it must be 1 to 1024");
            assert_eq!(said.to_string(), expected);
        }
        match Team::new(Team::MOST) {
            Ok(many) => assert_eq!((many.threads(), many.run(|| 7)), (Team::MOST, 7)),
            // The machine may not allow as many.
            Err(said) => assert!(matches!(said, TeamError::Refused { threads: Team::MOST, .. }), "{said}"),
        }
    }

    #[test]
    fn a_process_starts_threads_of_its_own() {
        // A pool of the parent, as a forked child finds it: it must neither be used nor ended.
        let dead = Box::new(Started::new(process().wrapping_add(1), Crew::new(2, STACK).ok()));
        let team = Team(Threads::Crew(Arc::new(Crews { threads: 2, first: dead.into() })));
        let Threads::Crew(crews) = &team.0 else { unreachable!("just made") };
        let [first, again] = [0, 1].map(|_| crews.here().map(std::ptr::from_ref));
        let parents = crews.first.get().and_then(|started| started.crew.as_ref()).map(std::ptr::from_ref);
        assert!(first.is_some() && first == again && first != parents);
        assert_eq!((team.threads(), team.run(|| Team::ambient().threads())), (2, 2));
        let refused = Box::new(Started::new(process(), None));
        let alone = Team(Threads::Crew(Arc::new(Crews { threads: 2, first: refused.into() })));
        let mut items = [0; 9];
        alone.each(&mut items, |i, x| *x = i);
        assert_eq!((items[8], alone.run(|| 7)), (8, 7));
    }

    #[test]
    fn every_element_is_taken_once() {
        for team in [Team::one(), Team::new(3).expect("threads"), Team::ambient()] {
            let (mut items, mut with) = (vec![0; 103], vec![0; 11]);
            team.each(&mut items, |i, x| *x += i);
            assert!(items.iter().enumerate().all(|(i, x)| i == *x));
            team.each_piece(&mut items, 10, &mut with, |i, piece, sum| {
                *sum += piece.iter().sum::<usize>();
                piece.iter_mut().for_each(|x| *x = i);
            });
            assert_eq!((with[0], with[10]), (45, 100 + 101 + 102));
            assert!(items.iter().enumerate().all(|(i, x)| i / 10 == *x));
            let starts = [0, 0, 5, 100, 103];
            let mut lengths = [0; 4];
            team.each_part(&mut items, &starts, &mut lengths, |_, part, length| *length = part.len());
            assert_eq!(lengths, [0, 5, 95, 3]);
            assert_eq!(team.run(|| 7), 7);
        }
    }
}
