//! Work in a thread of its own, while Python runs and may be interrupted.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Time between checks for signals.
const ASKED: Duration = Duration::from_millis(50);
/// Bytes of stack, as the main thread has.
const STACK: usize = 8 << 20;

/// Result of `work`, which runs in a thread of its own. Between checks for signals `meanwhile` is called. If it or the handler of a signal
/// raises an exception, `stop` is called: if that returns true, the work ends soon and is waited for; if not, the thread is abandoned and its
/// result dropped. In both cases the exception is returned. A second signal ends the waiting.
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
            // A second Ctrl-C ends the waiting.
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
        }
    }
}
