//! Work shared out among threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Do something for each item on so many threads, and hand each result to `done`, one at a time, with the number of those
/// done. Stops at the first error of `done`.
///
/// # Errors
/// That one.
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
