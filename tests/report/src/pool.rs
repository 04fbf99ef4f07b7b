//! Parallel execution of independent work items on threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Process each item on `threads` threads, and pass each result to `done`, one at a time, with the number of completed
/// items. Stops at the first error of `done`.
///
/// # Errors
/// The first error of `done`.
pub fn each<I: Sync, R: Send, E: Send>(
    threads: usize,
    items: &[I],
    work: impl Fn(&I) -> R + Sync,
    done: impl FnMut(usize, &I, R) -> Result<(), E> + Send,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let state = Mutex::new((0, done, Ok(())));
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some(item) = items.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let result = work(item);
                    let Ok(mut state) = state.lock() else { return };
                    let (count, done, ended) = &mut *state;
                    *count += 1;
                    if ended.is_ok() {
                        *ended = done(*count, item, result);
                    }
                    if ended.is_err() {
                        next.store(items.len(), Ordering::Relaxed);
                    }
                }
            });
        }
    });
    state.into_inner().map_or(Ok(()), |state| state.2)
}
