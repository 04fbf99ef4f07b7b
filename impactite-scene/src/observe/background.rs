//! A thread for files and pictures, which a run does not wait for.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use impactite_output::OutputError;
use impactite_simd::Team;

/// A piece of work: a picture to draw, a frame to write.
type Work = Box<dyn FnOnce() -> Result<(), OutputError> + Send>;

/// Pieces of work that wait at most, each with its snapshot; a run that makes more waits for the thread.
const WAITING: usize = 2;
/// Bytes of stack of the thread.
const STACK: usize = 8 << 20;

/// A thread that draws and writes, in order, what observers took from a run: [`Pictures`](super::Pictures) and [`VtkSeries`](super::VtkSeries)
/// of one run share one. At most four snapshots wait or are in work. Files are the same as without it. It is one of the threads of a team: while it
/// works, loops of the team run on one less.
///
/// An error stops the run when the next piece of work is given, at the next checkpoint, or at the end of the run; from then on nothing more is done, and
/// all that is given has the same error. Work must not hold the `Background` that it is given to.
#[derive(Clone, Debug, Default)]
pub struct Background(Option<Arc<Worker>>);

#[derive(Debug)]
struct Worker {
    /// None once the worker is dropped.
    queue: Mutex<Option<SyncSender<Message>>>,
    thread: Mutex<Option<JoinHandle<()>>>,
    failed: Failed,
    /// Process that has the thread: a forked child does not.
    process: u32,
}

/// First error.
type Failed = Arc<Mutex<Option<Arc<OutputError>>>>;

enum Message {
    Work(Work),
    /// Answer when all work before is done.
    Wait(SyncSender<()>),
}

/// Lock of a mutex; one that a panic poisoned holds what it held.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Background {
    /// No thread: work is done where it is given.
    #[must_use]
    pub fn none() -> Self {
        Background(None)
    }

    /// A thread of this team; none if it has one alone, or where the operating system refuses one.
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

    /// Have this done, after what was given before. Waits while the queue is full.
    ///
    /// # Errors
    /// The first error of work given before; without a thread, that of this work.
    ///
    /// # Panics
    /// With the panic of work given before.
    pub fn run(
        &self,
        work: impl FnOnce() -> Result<(), OutputError> + Send + 'static,
    ) -> Result<(), OutputError> {
        let Some(worker) = &self.0 else { return work() };
        worker.send(Message::Work(Box::new(work)));
        worker.error()
    }

    /// Wait until all work is done.
    ///
    /// # Errors
    /// The first error of work given before.
    ///
    /// # Panics
    /// With the panic of work given before.
    pub fn wait(&self) -> Result<(), OutputError> {
        let Some(worker) = &self.0 else { return Ok(()) };
        let (answer, answers) = sync_channel(1);
        worker.send(Message::Wait(answer));
        // A thread that ended answers by hanging up.
        if answers.recv().is_err() {
            worker.end();
        }
        worker.error()
    }
}

/// Work until the queue is closed. Once something failed, what follows is left out, as a run would have stopped there.
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
            // Nobody waits any more.
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

    /// Close the queue, let the thread finish, and pass on its panic.
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
            // Without a thread, each piece of work has its own.
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
        // And dropped in peace.
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
