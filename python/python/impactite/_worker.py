"""Process of a run of a sweep: started by ``_sweep``, connected by pipes."""

from __future__ import annotations

import _thread
import json
import os
import pickle
import signal
import sys
import threading
from pathlib import Path
from typing import Any, NamedTuple

from . import _impactite
from ._impactite import RunError, Scene

#: Program of the interpreter. It takes the module path of its parent before it imports anything but these two.
PROGRAM = """\
import pickle, sys
path, job = pickle.load(sys.stdin.buffer)
sys.path[:] = path
from impactite._worker import main
main(job)
"""


class Job(NamedTuple):
    """A run of a sweep."""

    scene: Scene
    folder: Path
    how: dict[str, Any]
    #: Go on from the checkpoint in the folder, if there is one of this scene.
    resume: bool


def packed(job: Job) -> bytes:
    """Input of the interpreter. The scene is unpickled after the path is set."""
    return pickle.dumps((sys.path, pickle.dumps(job)))


def main(job: bytes) -> None:
    """Run a job. The standard output has lines in JSON: progress, and the outcome in the end."""
    # The output of other code goes to the standard error stream.
    lines = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    # Programs that a shell starts in the background ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Thread(target=_interrupt_at_end_of_input, daemon=True).start()

    def say(**what: Any) -> None:
        lines.write(json.dumps(what) + "\n")
        lines.flush()

    def shown(time: float, end: float, steps: int, rate: float, energy_error: float) -> None:
        say(fraction=min(max(time / end, 0.0), 1.0))

    try:
        say(told=perform(pickle.loads(job), shown))
    except KeyboardInterrupt:
        say(interrupted=True)
    except Exception as error:
        say(error=str(error) or type(error).__name__)


def perform(job: Job, shown: Any = None) -> tuple[str, list[str]]:
    """Run a job in this process."""
    if job.resume:
        try:
            return _impactite.resume(job.folder, job.how, shown)
        except RunError as error:
            # A missing checkpoint, or one of another version.
            if "cannot resume" not in str(error) and "nothing to resume" not in str(error):
                raise
    return _impactite.run(job.scene, job.folder, job.how, shown)


def _interrupt_at_end_of_input() -> None:
    """Interrupt the main thread when the parent closes the pipe or ends."""
    # Not by `sys.stdin`: the interpreter would wait for its lock at exit.
    while os.read(0, 1 << 10):
        pass
    _thread.interrupt_main()
