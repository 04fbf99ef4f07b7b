"""Progress of runs: for a callable, or as a line on the standard error stream."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Callable, Optional, TypeVar, Union


@dataclass(frozen=True)
class Progress:
    """Progress of a run."""

    #: Simulated time, s.
    time: float
    #: Simulated time at the end of the run, s.
    end: float
    #: Steps made.
    steps: int
    #: Point updates per second of wall-clock time in steps.
    rate: float
    #: The change of the total energy that nothing explains, over the largest energy so far.
    energy_error: float
    #: Wall-clock time since the call, s.
    seconds: float

    @property
    def fraction(self) -> float:
        """Simulated time over that at the end, 0 to 1."""
        return min(max(self.time / self.end, 0.0), 1.0)

    def __str__(self) -> str:
        """The text of the default line."""
        return (
            f"{100 * self.fraction:3.0f} %  t = {self.time:.4g} of {self.end:.4g} s, step {self.steps}, "
            f"{1e-6 * self.rate:.1f} M updates/s, energy error {100 * self.energy_error:+.2f} %"
        )


@dataclass(frozen=True)
class SweepProgress:
    """Progress of a sweep."""

    #: Runs of the sweep.
    points: int
    #: Runs that are done, including those of earlier calls.
    done: int
    #: Runs that failed.
    failed: int
    #: Runs in progress.
    running: int
    #: Simulated time of all runs over that at their ends, 0 to 1.
    fraction: float
    #: Wall-clock time since the call, s.
    seconds: float

    def __str__(self) -> str:
        """The text of the default line."""
        failed = f", {self.failed} failed" if self.failed else ""
        return f"{100 * self.fraction:3.0f} %  {self.done} of {self.points} runs done{failed}, {self.running} running"


#: True for a line, False for none, a callable for every :class:`Progress`; None for a line in terminals and notebooks.
ProgressLike = Union[bool, Callable[[Progress], object], None]
SweepProgressLike = Union[bool, Callable[[SweepProgress], object], None]

_P = TypeVar("_P", Progress, SweepProgress)

#: Wall-clock time before the first line, between updates of a redrawn line, and between lines of a log, s.
_FIRST, _AGAIN, _LOG = 0.5, 0.2, 10.0


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return hasattr(shell, "kernel")


class _Line:
    """Line that is redrawn in a terminal or a notebook, else lines of a log."""

    def __init__(self, title: str, wanted: bool | None) -> None:
        self.title = title
        self.stream = sys.stderr
        terminal = self.stream is not None and self.stream.isatty()
        self.redrawn = terminal or (self.stream is not None and _in_notebook())
        self.shown = self.stream is not None and (self.redrawn if wanted is None else wanted)
        self.width = shutil.get_terminal_size().columns - 1 if terminal else 140
        self.next = time.monotonic() + (_FIRST if self.redrawn else _LOG)
        self.last = ""

    def __call__(self, progress: Progress | SweepProgress) -> None:
        now = time.monotonic()
        # The end is shown if progress was shown before.
        ends = self.last and progress.fraction >= 1
        if not self.shown or (now < self.next and not ends):
            return
        self.next = now + (_AGAIN if self.redrawn else _LOG)
        text = str(progress)
        title = self.title if len(self.title) <= 40 else self.title[:39] + "…"
        text = f"{title}: {text}"[: self.width]
        try:
            if self.redrawn:
                self.stream.write("\r" + text.ljust(len(self.last)))
                self.last = text
            else:
                self.stream.write(text + "\n")
            self.stream.flush()
        except (OSError, ValueError, UnicodeError):
            # A closed stream or an unsuitable encoding ends the line, not the run.
            self.shown = False

    def end(self) -> None:
        if self.last and self.shown:
            self.stream.write("\n")
            self.stream.flush()


@contextmanager
def showing(title: str, progress: bool | Callable[[_P], object] | None) -> Iterator[Optional[Callable[[_P], object]]]:
    """Callable for the progress of a run with this title; None if nothing is shown."""
    if progress is not None and not isinstance(progress, bool) and not callable(progress):
        raise TypeError(f"progress = {progress!r} is not allowed; it must be True, False, None or a callable")
    if callable(progress):
        yield progress
        return
    line = _Line(title, progress)
    try:
        yield line if line.shown else None
    finally:
        line.end()
