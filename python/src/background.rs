//! Background thread for long calls, which Python can interrupt.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Interval between checks for signals.
const ASKED: Duration = Duration::from_millis(50);
/// Stack size, bytes: that of the main thread.
const STACK: usize = 8 << 20;

/// Run `work` in a thread of its own and return its result. `meanwhile` is called between checks for signals. If it or a signal handler
/// raises an exception, `stop` is called. If `stop` returns true, the work ends soon and is waited for; if not, the thread is abandoned and
/// its result dropped. In both cases the exception is returned. A second signal ends the wait.
pub fn run<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> R + Send + 'static,
    mut meanwhile: impl FnMut(Python<'_>) -> PyResult<()>,
    stop: impl Fn() -> bool,
) -> PyResult<R> {
    let (sender, mut receiver) = mpsc::channel();
    std::thread::Builder::new().name("impactite".into()).stack_size(STACK).spawn(move || {
        // The receiver is gone if the work was abandoned.
        let _ = sender.send(work());
    })?;
    let mut interrupted = None;
    loop {
        let (received, back) = py.detach(move || (receiver.recv_timeout(ASKED), receiver));
        receiver = back;
        match received {
            Ok(result) => return interrupted.map_or(Ok(result), Err),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the run broke off; its thread said why"));
            }
            Err(RecvTimeoutError::Timeout) if interrupted.is_none() => {
                if let Err(error) = py.check_signals().and_then(|()| meanwhile(py)) {
                    if !stop() {
                        return Err(error);
                    }
                    interrupted = Some(error);
                }
            }
            // A second Ctrl-C ends the wait.
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
        }
    }
}
