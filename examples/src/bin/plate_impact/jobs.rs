//! Independent runs, distributed over threads.

use std::sync::Mutex;

use examples::CaseError;

/// Run all jobs on `threads` threads; the results are in the order of the jobs. A row of cells is too small for several threads, so that
/// each run uses one.
pub fn on_threads<R: Send>(
    threads: usize,
    jobs: Vec<Box<dyn FnOnce() -> Result<R, CaseError> + Send + '_>>,
) -> Result<Vec<R>, CaseError> {
    let count = jobs.len();
    let queue = Mutex::new(jobs.into_iter().enumerate());
    let done = Mutex::new(Vec::with_capacity(count));
    let broken = || CaseError::Other("a run on another thread broke off".into());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    // The guard is dropped before the job runs.
                    let next = queue.lock().ok().and_then(|mut queue| queue.next());
                    let Some((place, job)) = next else { break };
                    let result = job();
                    if let Ok(mut done) = done.lock() {
                        done.push((place, result));
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().map_err(|_| broken())?;
    done.sort_by_key(|(place, _)| *place);
    if done.len() < count {
        return Err(broken());
    }
    done.into_iter().map(|(_, result)| result).collect()
}
