//! Thread pool for parallel loops (fork and join, work stealing): its threads run loops together with the calling
//! thread.

use std::any::Any;
use std::cell::{Cell, UnsafeCell};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Spin time of an idle thread before it sleeps.
const WATCHES: Duration = Duration::from_micros(100);
/// Number of spin iterations between clock reads.
const TURNS: usize = 64;
/// Divisor: a thread takes 1 / `PART` of its remaining range at once.
const PART: u32 = 8;

type Task<'a> = dyn Fn(usize) + Send + Sync + 'a;

thread_local! {
    /// Index of this thread in its current loop; none outside of loops.
    static THREAD: Cell<Option<usize>> = const { Cell::new(None) };
}

/// Return the index of this thread in its current loop; 0 outside of loops.
pub(crate) fn thread() -> usize {
    THREAD.get().unwrap_or(0)
}

/// True if this thread is in a loop.
pub(crate) fn in_loop() -> bool {
    THREAD.get().is_some()
}

/// Thread pool.
#[derive(Debug)]
pub(crate) struct Crew {
    shared: Arc<Shared>,
    workers: Vec<JoinHandle<()>>,
    /// Lock of the thread that runs a loop.
    lead: Mutex<()>,
}

/// Shared state of the threads of a pool.
struct Shared {
    /// Number of the loop, the flags [`OPEN`] and `OVER`, and number of workers in the loop.
    state: AtomicU64,
    /// Task of the open loop.
    task: UnsafeCell<Option<&'static Task<'static>>>,
    ranges: Vec<Range>,
    /// Number of threads that are lent to other work.
    lent: AtomicUsize,
    /// Number of threads of the open loop: those with smaller indices. Written by the leader, like the task.
    active: AtomicUsize,
    /// Number of threads asleep until the next loop.
    sleeping: AtomicUsize,
    wake: Condvar,
    /// Number of inactive threads asleep until more are active.
    out: AtomicUsize,
    back: Condvar,
    lock: Mutex<()>,
    /// First panic in the loop.
    panic: Mutex<Option<Box<dyn Any + Send>>>,
}

// SAFETY: the task is written by the leader alone while the loop is closed and no worker is in it, and read by workers
// that are in an open loop.
unsafe impl Sync for Shared {}
// SAFETY: as above; everything else is `Send`.
unsafe impl Send for Shared {}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("threads", &self.ranges.len()).finish_non_exhaustive()
    }
}

/// Bits of the state with the number of workers in the loop.
const WORKERS: u64 = (1 << 16) - 1;
/// Flag of the state: workers may enter the loop.
const OPEN: u64 = 1 << 16;
/// Flag of the state: the pool shuts down.
const OVER: u64 = 1 << 17;
/// Increment of the loop number in the state.
const LOOP: u64 = 1 << 18;

/// Remaining index range of a thread, from the lower half of the bits to the upper half, on a cache line of its own.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Range(AtomicU64);

impl Range {
    fn set(&self, from: u32, to: u32) {
        self.0.store(u64::from(to) << 32 | u64::from(from), Ordering::Relaxed);
    }
    /// Take indices from the front (own thread) or from the back (work stealing).
    fn take(&self, front: bool) -> Option<std::ops::Range<u32>> {
        let mut now = self.0.load(Ordering::Relaxed);
        loop {
            let (from, to) = (now as u32, (now >> 32) as u32);
            if from >= to {
                return None;
            }
            let part = (to - from).div_ceil(PART);
            let (rest, taken) = if front {
                ((from + part, to), from..from + part)
            } else {
                ((from, to - part), to - part..to)
            };
            let next = u64::from(rest.1) << 32 | u64::from(rest.0);
            match self.0.compare_exchange_weak(now, next, Ordering::Relaxed, Ordering::Relaxed) {
                Ok(_) => return Some(taken),
                Err(other) => now = other,
            }
        }
    }
}

impl Crew {
    /// Start a pool of `threads` threads, including that of the caller of each loop.
    pub(crate) fn new(threads: usize, stack: usize) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            state: AtomicU64::new(0),
            task: UnsafeCell::new(None),
            ranges: (0..threads).map(|_| Range::default()).collect(),
            lent: AtomicUsize::new(0),
            active: AtomicUsize::new(threads),
            sleeping: AtomicUsize::new(0),
            wake: Condvar::new(),
            out: AtomicUsize::new(0),
            back: Condvar::new(),
            lock: Mutex::new(()),
            panic: Mutex::new(None),
        });
        let mut crew = Crew { shared, workers: Vec::with_capacity(threads - 1), lead: Mutex::new(()) };
        for thread in 1..threads {
            let shared = crew.shared.clone();
            let builder = thread::Builder::new().name(format!("crew {thread}")).stack_size(stack);
            crew.workers.push(builder.spawn(move || shared.work(thread))?);
        }
        Ok(crew)
    }

    /// Run `task` once for every number below `count`, in any order.
    ///
    /// # Panics
    /// With the first panic of a task, after all other tasks have ended.
    pub(crate) fn each(&self, count: usize, task: &Task<'_>) {
        let shared = &*self.shared;
        let all = shared.ranges.len();
        let active = all - shared.lent.load(Ordering::Relaxed).min(all - 1);
        // This thread runs the whole loop if it is in one already, if another thread runs one, or if parallel execution
        // does not pay.
        let alone = count <= 1 || active == 1 || THREAD.get().is_some();
        let (false, Ok(length), Ok(lead)) = (alone, u32::try_from(count), self.lead.try_lock()) else {
            return (0..count).for_each(task);
        };
        let place = |t: usize| (u64::from(length) * t.min(active) as u64 / active as u64) as u32;
        for (t, range) in shared.ranges.iter().enumerate() {
            range.set(place(t), place(t + 1));
        }
        let more = active > shared.active.swap(active, Ordering::SeqCst);
        // SAFETY: the loop is closed and no worker is in it. Workers use the task in the open loop only, which is closed, and left by all,
        // before this returns: its life is long enough.
        unsafe { *shared.task.get() = Some(std::mem::transmute::<&Task<'_>, &'static Task<'static>>(task)) };
        let before = shared.state.load(Ordering::Relaxed);
        shared.state.store((before & !(LOOP - 1)).wrapping_add(LOOP) | OPEN, Ordering::SeqCst);
        let [sleeping, out] = [&shared.sleeping, &shared.out].map(|n| n.load(Ordering::SeqCst) > 0);
        if sleeping || more && out {
            let _lock = shared.lock.lock().unwrap_or_else(PoisonError::into_inner);
            shared.wake.notify_all();
            if more {
                shared.back.notify_all();
            }
        }
        shared.make(0, task);
        // Close the loop to new workers; those in it finish the indices they took.
        shared.state.fetch_and(!OPEN, Ordering::AcqRel);
        let mut turns = 0_u64;
        while shared.state.load(Ordering::Acquire) & WORKERS > 0 {
            turns += 1;
            if turns.is_multiple_of(1000_u64) { thread::yield_now() } else { std::hint::spin_loop() }
        }
        // SAFETY: as above.
        unsafe { *shared.task.get() = None };
        let panic = shared.panic.lock().unwrap_or_else(PoisonError::into_inner).take();
        drop(lead);
        if let Some(panic) = panic {
            resume_unwind(panic);
        }
    }

    /// Lend one thread to other work, or take it back.
    pub(crate) fn lend(&self, out: bool) {
        let lent = &self.shared.lent;
        let _ = if out { lent.fetch_add(1, Ordering::Relaxed) } else { lent.fetch_sub(1, Ordering::Relaxed) };
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        self.shared.state.fetch_or(OVER, Ordering::SeqCst);
        drop(self.shared.lock.lock().unwrap_or_else(PoisonError::into_inner));
        self.shared.wake.notify_all();
        self.shared.back.notify_all();
        for worker in self.workers.drain(..) {
            // A worker passes on panics of tasks, and has none of its own.
            let _ = worker.join();
        }
    }
}

impl Shared {
    /// Run the thread's own range, then steal from those of others.
    fn make(&self, thread: usize, task: &Task<'_>) {
        let before = THREAD.replace(Some(thread));
        let made = catch_unwind(AssertUnwindSafe(|| {
            while let Some(part) = self.ranges[thread].take(true) {
                part.for_each(|n| task(n as usize));
            }
            let threads = self.active.load(Ordering::Relaxed);
            for other in (1..threads).map(|n| (thread + n) % threads) {
                while let Some(part) = self.ranges[other].take(false) {
                    part.for_each(|n| task(n as usize));
                }
            }
        }));
        THREAD.set(before);
        if let Err(panic) = made {
            // Empty all ranges, so that the other threads stop soon.
            self.ranges.iter().for_each(|range| range.set(0, 0));
            let mut first = self.panic.lock().unwrap_or_else(PoisonError::into_inner);
            match &*first {
                None => *first = Some(panic),
                // The payload may panic when dropped.
                Some(_) => std::mem::forget(panic),
            }
        }
    }

    /// Wait for a loop other than `known` that is open to this thread, and enter it. None after shutdown.
    fn enter(&self, thread: usize, known: u64) -> Option<u64> {
        let open = |state: u64| {
            state & OPEN != 0 && state / LOOP != known && thread < self.active.load(Ordering::Relaxed)
        };
        let mut watched: Option<Instant> = None;
        let mut turns = 0;
        loop {
            let state = self.state.load(Ordering::Acquire);
            if state & OVER != 0 {
                return None;
            }
            if open(state) {
                let entered =
                    self.state.compare_exchange(state, state + 1, Ordering::AcqRel, Ordering::Relaxed);
                if entered.is_ok() {
                    return Some(state / LOOP);
                }
                continue;
            }
            std::hint::spin_loop();
            turns += 1;
            if turns % TURNS != 0 {
                continue;
            }
            if watched.get_or_insert_with(Instant::now).elapsed() < WATCHES {
                continue;
            }
            let lock = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
            let is_out = || thread >= self.active.load(Ordering::SeqCst);
            let out = is_out();
            let (asleep, signal) = if out { (&self.out, &self.back) } else { (&self.sleeping, &self.wake) };
            asleep.fetch_add(1, Ordering::SeqCst);
            let state = self.state.load(Ordering::SeqCst);
            // A leader that has opened a loop since either sees this thread asleep, or is seen here.
            if state & OVER == 0 && !open(state) && out == is_out() {
                drop(signal.wait(lock).unwrap_or_else(PoisonError::into_inner));
            }
            asleep.fetch_sub(1, Ordering::SeqCst);
            watched = None;
        }
    }

    fn work(&self, thread: usize) {
        let mut known = u64::MAX;
        while let Some(this) = self.enter(thread, known) {
            known = this;
            // SAFETY: this thread is in the loop, which the leader does not leave before it.
            if let Some(task) = unsafe { *self.task.get() } {
                self.make(thread, task);
            }
            self.state.fetch_sub(1, Ordering::AcqRel);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(crew: &Crew, count: usize) -> usize {
        let sum = AtomicUsize::new(0);
        crew.each(count, &|n| {
            sum.fetch_add(n + 1, Ordering::Relaxed);
        });
        sum.into_inner()
    }

    #[test]
    fn every_number_comes_once() {
        for threads in [2, 3, 8] {
            let crew = Crew::new(threads, 1 << 20).expect("threads");
            for round in 0..2000 {
                let count = round % 67;
                assert_eq!(sum(&crew, count), count * (count + 1) / 2);
            }
            // Long enough for workers to sleep.
            for _ in 0..5 {
                thread::sleep(3 * WATCHES);
                assert_eq!(sum(&crew, 1000), 500_500);
            }
        }
    }

    #[test]
    fn lent_threads_make_no_loops() {
        let crew = Crew::new(3, 1 << 20).expect("threads");
        for lent in [1, 2, 3] {
            crew.lend(true);
            for _ in 0..200 {
                crew.each(50, &|_| assert!(thread() < 3 - lent.min(2)));
                assert_eq!(sum(&crew, 50), 1275);
            }
        }
        (0..3).for_each(|_| crew.lend(false));
        assert_eq!(sum(&crew, 50), 1275);
    }

    #[test]
    fn loops_within_loops_and_of_other_threads_are_made() {
        let crew = Crew::new(3, 1 << 20).expect("threads");
        let total = AtomicUsize::new(0);
        crew.each(20, &|_| {
            assert!(thread() < 3);
            total.fetch_add(sum(&crew, 10), Ordering::Relaxed);
        });
        assert_eq!(total.into_inner(), 20 * 55);
        assert_eq!(thread(), 0);
        thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..200).for_each(|_| assert_eq!(sum(&crew, 50), 1275)));
            }
        });
    }

    #[test]
    fn a_panic_comes_to_the_caller_and_the_crew_goes_on() {
        let crew = Crew::new(2, 1 << 20).expect("threads");
        for n in [0, 37, 99] {
            let made = catch_unwind(AssertUnwindSafe(|| {
                crew.each(100, &|i| assert!(i != n, "number {n}"));
            }));
            let said = made.expect_err("it panics");
            assert_eq!(said.downcast_ref::<String>().map(String::as_str), Some(&*format!("number {n}")));
            assert_eq!(sum(&crew, 100), 5050);
        }
    }
}
