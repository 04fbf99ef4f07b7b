//! Background thread for files and pictures, so that a run does not wait for them.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use impactite_output::OutputError;
use impactite_simd::Team;

/// Task of the thread: draw a picture or write a frame.
type Work = Box<dyn FnOnce() -> Result<(), OutputError> + Send>;

/// Capacity of the task queue; each task owns its snapshot. A run that adds more waits for the thread.
const WAITING: usize = 2;
/// Stack size of the thread, bytes.
const STACK: usize = 8 << 20;

/// Background thread that draws and writes the snapshots of observers, in order: [`Pictures`](super::Pictures) and
/// [`VtkSeries`](super::VtkSeries) of one run share one. At most four snapshots are queued or in work. Files are the same as without it. It
/// is one of the threads of a thread pool: during a task, loops of the pool run on one thread less.
///
/// An error stops the run at the next task, at the next checkpoint, or at the end of the run; after it no task is executed, and all calls
/// return the same error. A task must not own the `Background` that executes it.
#[derive(Clone, Debug, Default)]
pub struct Background(Option<Arc<Worker>>);

#[derive(Debug)]
struct Worker {
    /// None after the worker was dropped.
    queue: Mutex<Option<SyncSender<Message>>>,
    thread: Mutex<Option<JoinHandle<()>>>,
    failed: Failed,
    /// Process of the thread: a forked child does not have it.
    process: u32,
}

/// First error.
type Failed = Arc<Mutex<Option<Arc<OutputError>>>>;

enum Message {
    Work(Work),
    /// Answer when all earlier tasks are done.
    Wait(SyncSender<()>),
}

/// Lock a mutex; poisoning by a panic is ignored.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Background {
    /// Create no thread: tasks run in the calling thread.
    #[must_use]
    pub fn none() -> Self {
        Background(None)
    }

    /// Create a thread of this thread pool; none if the pool has one thread only, or if the operating system refuses one.
    #[must_use]
    pub fn new(team: &Team) -> Self {
        if team.threads() == 1 {
            return Background::none();
        }
        let team = team.clone();
        let (queue, messages) = sync_channel(WAITING);
        let failed = Failed::default();
        let errors = failed.clone();
        let thread = std::thread::Builder::new()
            .name("output".into())
            .stack_size(STACK)
            .spawn(move || work(&team, &messages, &errors));
        Background(thread.ok().map(|thread| {
            let (queue, thread) = (Mutex::new(Some(queue)), Mutex::new(Some(thread)));
            Arc::new(Worker { queue, thread, failed, process: std::process::id() })
        }))
    }

    /// Execute a task after all earlier ones. Waits while the queue is full.
    ///
    /// # Errors
    /// The first error of earlier tasks; without a thread, the error of this task.
    ///
    /// # Panics
    /// With the panic of an earlier task.
    pub fn run(
        &self,
        work: impl FnOnce() -> Result<(), OutputError> + Send + 'static,
    ) -> Result<(), OutputError> {
        let Some(worker) = &self.0 else { return work() };
        worker.send(Message::Work(Box::new(work)));
        worker.error()
    }

    /// Wait until all tasks are done.
    ///
    /// # Errors
    /// The first error of earlier tasks.
    ///
    /// # Panics
    /// With the panic of an earlier task.
    pub fn wait(&self) -> Result<(), OutputError> {
        let Some(worker) = &self.0 else { return Ok(()) };
        let (answer, answers) = sync_channel(1);
        worker.send(Message::Wait(answer));
        // The end of the thread closes the channel.
        if answers.recv().is_err() {
            worker.end();
        }
        worker.error()
    }
}

/// Execute tasks until the queue is closed. After an error the remaining tasks are skipped, as a run would have stopped there.
fn work(team: &Team, messages: &Receiver<Message>, failed: &Mutex<Option<Arc<OutputError>>>) {
    let mut stopped = false;
    for message in messages {
        match message {
            Message::Work(work) if !stopped => {
                if let Err(error) = team.lend(work) {
                    stopped = true;
                    *locked(failed) = Some(Arc::new(error));
                }
            }
            Message::Work(_) => {}
            // An error means that the caller no longer waits.
            Message::Wait(answer) => drop(answer.send(())),
        }
    }
}

impl Worker {
    fn send(&self, message: Message) {
        let queue = locked(&self.queue).clone();
        if queue.is_none_or(|queue| queue.send(message).is_err()) {
            self.end();
        }
    }

    fn error(&self) -> Result<(), OutputError> {
        match &*locked(&self.failed) {
            Some(error) => Err(OutputError::Earlier(error.clone())),
            None if locked(&self.queue).is_none() => Err(OutputError::Ended),
            None => Ok(()),
        }
    }

    /// Close the queue, join the thread, and propagate its panic.
    fn end(&self) {
        drop(locked(&self.queue).take());
        if self.process != std::process::id() {
            return std::mem::forget(locked(&self.thread).take());
        }
        let thread = locked(&self.thread).take();
        if let Some(Err(panic)) = thread.map(JoinHandle::join)
            && !std::thread::panicking()
        {
            std::panic::resume_unwind(panic);
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn two() -> Team {
        Team::new(2).expect("threads")
    }

    fn failure() -> OutputError {
        impactite_output::picture::Picture::new(0, 1, [0; 3]).expect_err("no picture")
    }

    #[test]
    fn work_is_done_in_order_and_errors_stay() {
        for background in [Background::none(), Background::new(&two())] {
            let list = Arc::new(Mutex::new(Vec::new()));
            for n in 0..20 {
                let list = list.clone();
                let given = background.run(move || {
                    locked(&list).push(n);
                    Ok(())
                });
                given.expect("nothing fails");
            }
            background.wait().expect("nothing failed");
            assert_eq!(*locked(&list), (0..20).collect::<Vec<_>>());
            let said = background.run(|| Err(failure())).and_then(|()| background.wait());
            assert_eq!(said.expect_err("it failed").to_string(), failure().to_string());
            let again = background.wait().map_err(|e| e.to_string());
            // Without a thread, each task has its own error.
            assert_eq!(again, if background.0.is_some() { Err(failure().to_string()) } else { Ok(()) });
        }
    }

    #[test]
    fn what_follows_an_error_is_left_out() {
        let (background, count) = (Background::new(&two()), Arc::new(AtomicUsize::new(0)));
        let mut said = background.run(|| Err(failure()));
        for _ in 0..5 {
            let count = count.clone();
            let given = background.run(move || {
                count.fetch_add(1, Ordering::Relaxed);
                Ok(())
            });
            said = said.and(given);
        }
        assert!(said.and(background.wait()).is_err());
        assert_eq!(count.load(Ordering::Relaxed), 0);
    }

    #[test]
    fn a_panic_is_passed_on() {
        let background = Background::new(&two());
        let given = background.run(|| panic!("a picture"));
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| given.and(background.wait())));
        assert!(caught.is_err());
        assert!(matches!(background.run(|| Ok(())), Err(OutputError::Ended)));
        // Drop does not panic again.
        drop(background);
    }

    #[test]
    fn all_is_done_when_it_is_dropped() {
        let count = Arc::new(AtomicUsize::new(0));
        let background = Background::new(&two());
        for _ in 0..3 {
            let count = count.clone();
            let given = background.run(move || {
                std::thread::sleep(std::time::Duration::from_millis(5));
                count.fetch_add(1, Ordering::Relaxed);
                Ok(())
            });
            given.expect("nothing fails");
        }
        drop(background);
        assert_eq!(count.load(Ordering::Relaxed), 3);
    }
}
