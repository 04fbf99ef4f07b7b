"""Sweeps: runs of a scene for many values, in processes."""

from __future__ import annotations

import builtins
import csv
import hashlib
import itertools
import json
import os
import queue
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Callable, NamedTuple

from . import _impactite
from ._impactite import Scene, __version__
from ._progress import SweepProgress, SweepProgressLike, showing
from ._runs import Result, SceneLike, options, pandas, scene_and_folder
from ._worker import PROGRAM, Job, packed, perform

if TYPE_CHECKING:
    import pandas as pd

#: Record of a run for later calls, in its folder.
_RECORD = "point.json"
#: Time limit for checkpoints of runs that are stopped, s.
_PATIENCE = 60.0
#: Time between updates of the progress, s.
_LOOK = 0.1


class SweepPoint(NamedTuple):
    """A run of a sweep."""

    #: A value a key.
    values: dict[str, Any]
    #: Result; None if the run failed.
    result: Result | None
    #: Cause of a failure; None if there was none.
    error: str | None


class Sweep(builtins.list[SweepPoint]):
    """The points of a sweep, a list in the order of the values; the last key's vary fastest."""

    #: Folder of the files.
    folder: Path

    def __init__(self, points: Iterable[SweepPoint], folder: Path, parameters: Iterable[Mapping[str, float]]) -> None:
        super().__init__(points)
        self.folder = folder
        self._parameters = [*parameters]

    def __reduce__(self) -> tuple[Any, ...]:
        return Sweep, ([*self], self.folder, self._parameters)

    def values(self) -> builtins.list[dict[str, Any]]:
        """The values by key, a dict a point: of parameters in SI units, of other keys as they were given."""
        return [
            {key: parameters.get(key, value) for key, value in point.values.items()} for point, parameters in zip(self, self._parameters)
        ]

    def rows(self) -> builtins.list[dict[str, Any]]:
        """A dict a point: values by key (of parameters in SI units), measures in SI units by name, ``met`` (all checks), ``steps``,
        ``points``, ``energy_error``, ``wall_seconds``, ``folder``, and ``error``, None of a run that did not fail; of one that did all
        others but the values are None.

        A measure with one of these names, or that of a key, is ``measures.NAME``.
        """
        names = {name: None for point in self if point.result for name in point.result.measures}
        others = ("met", "steps", "points", "energy_error", "wall_seconds", "folder", "error")
        rows = []
        for values, (_, result, error) in zip(self.values(), self):
            row = dict(values)
            for name in names:
                column = f"measures.{name}" if name in others or name in values else name
                row[column] = result.measures.get(name) if result else None
            for name in others:
                row[name] = error if name == "error" else getattr(result, name, None)
            rows.append(row)
        return rows

    def to_dataframe(self) -> pd.DataFrame:
        """The rows as a DataFrame of pandas.

        Raises ``ImportError`` where pandas is not installed; ``rows`` needs none.
        """
        frame: pd.DataFrame = pandas("Sweep.to_dataframe()", "Sweep.rows()").DataFrame(self.rows())
        return frame

    def histories(self) -> pd.DataFrame:
        """The histories of all runs as one DataFrame of pandas: ``point`` (the place in this list), the values by key, ``time`` and the
        measures.

        Raises ``ImportError`` where pandas is not installed; ``Result.history`` needs none.
        """
        concat, none = (getattr(pandas("Sweep.histories()", "Result.history()"), name) for name in ("concat", "DataFrame"))
        frames = []
        for place, (values, (_, result, _)) in enumerate(zip(self.values(), self)):
            if result is None:
                continue
            frame = result.to_dataframe()
            for column, (key, value) in enumerate(values.items()):
                name = f"set.{key}" if key in frame.columns else key
                # A value may be a list.
                frame.insert(column, name, [value] * len(frame))
            frame.insert(0, "point", place)
            frames.append(frame)
        all_: pd.DataFrame = concat(frames, ignore_index=True) if frames else none()
        return all_

    def _repr_html_(self) -> str | None:
        try:
            html: str = self.to_dataframe().to_html()
        except ImportError:
            return None
        return html


def sweep(
    scene: SceneLike,
    over: Mapping[str, Iterable[Any]],
    out: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    processes: int | None = None,
    threads: int | None = None,
    pictures: bool = True,
    report: bool = True,
    checkpoint: float = 300.0,
    fresh: bool = False,
    progress: SweepProgressLike = None,
) -> Sweep:
    """Run a scene for all combinations of values of keys: ``over={"parameters.speed": ["150 m/s", "200 m/s"]}``.

    Each run has a folder in ``out``, which has the table ``sweep.csv``, too, and the chart ``sweep.png`` of one key. A run that fails is a
    point that says so; the others go on. Further options are those of :func:`run`.

    Runs are made by ``processes`` at a time, each on ``threads``; together they take all processors if none are given. Processes are new
    interpreters: scripts need no ``if __name__ == "__main__"``, and notebooks work. ``processes=0`` runs one after another in this process.

    Another call with the same ``out`` runs only what is not done: values that failed or are new, also after a change of ``over``; runs that
    were stopped go on from their checkpoints. A scene that was changed, or whose files were, is run again; with ``fresh`` all are.

    ``progress`` is a callable that gets :class:`SweepProgress`, or True, False or None as of :func:`run`. Ctrl-C, and an exception of
    ``progress``, stop all runs with checkpoints.

    Raises ``SceneError`` for what is wrong with a scene, before the first run.
    """
    scene, folder = scene_and_folder(scene, out, set)
    values = {key: _values(key, each) for key, each in over.items()}
    points = [dict(zip(values, each)) for each in itertools.product(*values.values())]
    scenes = [scene.changed(point) if point else scene for point in points]
    _check_numbers(processes, threads)
    folder.mkdir(parents=True, exist_ok=True)
    prints = [_fingerprint(each) for each in scenes]
    known = {} if fresh else _records(folder)
    runs: dict[str, _Run] = {}
    for place, (each, print_, point) in enumerate(zip(scenes, prints, points), 1):
        if print_ not in runs:
            runs[print_] = _Run(each, print_, point, place, known.get(print_))
    _place(folder, runs.values(), known)
    waiting = [each for each in runs.values() if each.told is None]
    for run in waiting:
        run.how = options(threads, pictures, report, checkpoint)
    processes, threads = _shares(len(waiting), processes, threads)
    with showing(scene.title, progress) as show:
        try:
            _perform(waiting, processes, threads, _Shown(runs.values(), show))
        finally:
            ended = [_point(point, runs[print_]) for point, print_ in zip(points, prints)]
            result = Sweep(ended, folder, [{f"parameters.{name}": x for name, x in each.parameters.items()} for each in scenes])
            _write(result, scene.title, values)
    return result


def _values(key: str, values: Iterable[Any]) -> builtins.list[Any]:
    if isinstance(values, (str, bytes, Mapping)):
        raise TypeError(f"over: `{key}` = {values!r} is not allowed; it must be a list of values")
    values = [*values]
    if not values:
        raise ValueError(f"over: `{key}` has no values; it must have at least one")
    return values


def _check_numbers(processes: int | None, threads: int | None) -> None:
    """Refuse numbers that no run can have."""
    if processes is not None and processes < 0:
        raise ValueError(f"processes = {processes} is not allowed; it must be at least 0")
    if threads is not None and not 1 <= threads <= 1024:
        raise ValueError(f"threads = {threads} is not allowed; it must be 1 to 1024")


def _shares(runs: int, processes: int | None, threads: int | None) -> tuple[int, int]:
    """Number of processes, and of threads of each."""
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not sys.executable:
        # Python embedded in another program.
        processes = 0
    if processes is None:
        processes = max(1, min(runs, processors // (threads or 1)))
    return processes, threads or max(1, processors // max(1, min(processes, runs)))


class _Run:
    """A run of a sweep."""

    def __init__(self, scene: Scene, print_: str, values: dict[str, Any], place: int, record: dict[str, Any] | None) -> None:
        self.scene, self.print, self.values, self.place = scene, print_, values, place
        self.folder: Path | None = record["folder"] if record else None
        self.stopped_with: dict[str, Any] | None = None
        self.how: dict[str, Any] = {}
        self.told: tuple[str, list[str]] | None = None
        self.error: str | None = None
        #: Share of the work that is done; None before its start.
        self.fraction: float | None = None
        if record and record["state"] == "done":
            self.told, self.fraction = record["told"], 1.0
        elif record and record["state"] == "started":
            self.stopped_with = record["how"]

    def job(self, threads: int) -> Job:
        """Job of the run, recorded as started in the folder."""
        assert self.folder is not None
        # A checkpoint fits a run with the same observers.
        resume = self.stopped_with is not None and self.stopped_with.get("pictures") == self.how["pictures"]
        self.folder.mkdir(parents=True, exist_ok=True)
        self.record("started")
        self.fraction = 0.0
        return Job(self.scene, self.folder, {**self.how, "threads": threads}, resume)

    def ended(self, what: dict[str, Any]) -> None:
        """Record the outcome."""
        if "told" in what:
            text, warned = what["told"]
            self.told = (text, warned)
            self.record("done", told=self.told)
        else:
            self.error = what["error"]
            self.record("failed", error=self.error)
        self.fraction = 1.0

    def record(self, state: str, **more: Any) -> None:
        assert self.folder is not None
        values = {key: str(value) for key, value in self.values.items()}
        record = {"state": state, "fingerprint": self.print, "values": values, "how": self.how, **more}
        path = self.folder / _RECORD
        part = path.with_suffix(".part")
        part.write_text(json.dumps(record, indent=1), encoding="utf-8")
        part.replace(path)


def _fingerprint(scene: Scene) -> str:
    """Hash of the version, the scene, and the files that it names."""
    found = hashlib.sha256(f"{__version__}\n{scene.text}".encode())
    name, text = scene.__reduce__()[1]
    beside = Path(name).parent
    for double, single in re.findall(r'"([^"\n]{1,500})"|\'([^\'\n]{1,500})\'', text):
        try:
            content = (beside / (double or single)).read_bytes()
        except (OSError, ValueError):
            continue
        found.update(hashlib.sha256(content).digest())
    return found.hexdigest()


def _records(folder: Path) -> dict[str, dict[str, Any]]:
    """Records of earlier calls, by fingerprint."""
    known: dict[str, dict[str, Any]] = {}
    for path in sorted(folder.glob(f"*/{_RECORD}")):
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
            print_, state = record["fingerprint"], record["state"]
            if state == "done":
                Result._of(record["told"], path.parent)
        except (OSError, ValueError, KeyError, TypeError):
            # No record, or an incomplete one.
            continue
        if known.get(print_, {}).get("state") != "done":
            known[print_] = {**record, "folder": path.parent}
    return known


def _place(folder: Path, runs: Iterable[_Run], known: dict[str, dict[str, Any]]) -> None:
    """Assign a folder to each run: its number if that is free. Folders of earlier calls are kept."""
    runs = [*runs]
    taken = {record["folder"].name for record in known.values()} | {run.folder.name for run in runs if run.folder}
    free = (f"{n:03}" for n in itertools.count(1))
    for run in runs:
        if run.folder is None:
            name = f"{run.place:03}"
            while name in taken:
                name = next(free)
            taken.add(name)
            run.folder = folder / name


class _Shown:
    """Progress of all runs."""

    def __init__(self, runs: Iterable[_Run], show: Callable[[SweepProgress], object] | None) -> None:
        self.runs, self.show, self.start = [*runs], show, time.monotonic()

    def __call__(self) -> None:
        if self.show is None:
            return
        shares = [run.fraction for run in self.runs]
        done = sum(run.told is not None for run in self.runs)
        failed = sum(run.error is not None for run in self.runs)
        started = sum(share is not None for share in shares)
        fraction = sum(share or 0.0 for share in shares) / max(1, len(shares))
        seconds = time.monotonic() - self.start
        self.show(SweepProgress(len(self.runs), done, failed, started - done - failed, fraction, seconds))


def _perform(waiting: Sequence[_Run], processes: int, threads: int, shown: _Shown) -> None:
    if processes == 0:
        for run in waiting:
            _here(run, threads, shown)
        return
    left, workers = deque(waiting), builtins.set[_Worker]()
    said: queue.SimpleQueue[tuple[_Worker, dict[str, Any]]] = queue.SimpleQueue()
    try:
        while left or workers:
            while left and len(workers) < processes:
                run = left.popleft()
                workers.add(_Worker(run, run.job(threads), said))
            shown()
            try:
                worker, what = said.get(timeout=_LOOK)
            except queue.Empty:
                continue
            if "fraction" in what:
                worker.run.fraction = what["fraction"]
            else:
                worker.process.wait()
                workers.discard(worker)
                worker.close()
                worker.run.ended(what)
        shown()
    finally:
        _stop(workers)
        # Outcomes of runs that ended meanwhile.
        while workers and not said.empty():
            worker, what = said.get()
            if "told" in what:
                worker.run.ended(what)


def _here(run: _Run, threads: int, shown: _Shown) -> None:
    def fraction(time: float, end: float, *_: Any) -> None:
        run.fraction = min(max(time / end, 0.0), 1.0)
        shown()

    try:
        run.ended({"told": perform(run.job(threads), fraction)})
    except (RuntimeError, ValueError, OSError) as error:
        run.ended({"error": str(error)})


def _stop(workers: Iterable[_Worker]) -> None:
    """Stop all processes with checkpoints. Another Ctrl-C ends the waiting and the processes."""
    workers = [*workers]
    try:
        for worker in workers:
            worker.interrupt()
        end = time.monotonic() + _PATIENCE
        for worker in workers:
            try:
                worker.process.wait(max(0.0, end - time.monotonic()))
            except subprocess.TimeoutExpired:
                pass
    finally:
        for worker in workers:
            worker.process.kill()
            worker.process.wait()
            worker.close()


class _Worker:
    """Process of a run."""

    def __init__(self, run: _Run, job: Job, said: queue.SimpleQueue[tuple[_Worker, dict[str, Any]]]) -> None:
        self.run, self.said = run, said
        self.errors: IO[bytes] = tempfile.TemporaryFile()
        # Ctrl-C in a terminal interrupts this process alone, which stops the others.
        alone: dict[str, Any] = (
            {"creationflags": vars(subprocess)["CREATE_NEW_PROCESS_GROUP"]} if os.name == "nt" else {"start_new_session": True}
        )
        self.process = subprocess.Popen(
            [sys.executable, "-I", "-c", PROGRAM],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.errors,
            **alone,
        )
        self.reader = threading.Thread(target=self._read, args=(packed(job),), daemon=True)
        self.reader.start()

    def _read(self, job: bytes) -> None:
        assert self.process.stdin and self.process.stdout
        last: dict[str, Any] = {}
        try:
            self.process.stdin.write(job)
            self.process.stdin.flush()
            for line in self.process.stdout:
                last = json.loads(line)
                if "fraction" in last:
                    self.said.put((self, last))
        except (OSError, ValueError):
            pass
        if "told" not in last and "error" not in last:
            last = {"error": self._cause(self.process.wait())}
        self.said.put((self, last))

    def _cause(self, code: int) -> str:
        """Cause of the end of a process without an outcome."""
        try:
            how = f"by {signal.Signals(-code).name}" if code < 0 else f"with the exit code {code}"
        except ValueError:
            how = f"by the signal {-code}"
        self.errors.seek(0)
        lines = self.errors.read().decode(errors="replace").strip().splitlines()[-5:]
        memory = "; was there enough memory for so many processes?" if code == -9 else ""
        return "\n".join([f"the process of the run ended {how}{memory}", *lines])

    def interrupt(self) -> None:
        """Stop the run with a checkpoint."""
        try:
            assert self.process.stdin
            self.process.stdin.close()
        except OSError:
            pass

    def close(self) -> None:
        self.interrupt()
        self.reader.join()
        if self.process.stdout:
            self.process.stdout.close()
        self.errors.close()


def _point(values: dict[str, Any], run: _Run) -> SweepPoint:
    if run.told is not None and run.folder is not None:
        return SweepPoint(values, Result._of(run.told, run.folder), None)
    return SweepPoint(values, None, run.error or "the sweep was stopped before this run ended")


def _write(points: Sweep, title: str, values: dict[str, builtins.list[Any]]) -> None:
    """The table and, of one key, the chart."""
    rows = points.rows()
    units = {name: unit for point in points if point.result for name, unit in point.result.units.items()}
    units.update(energy_error="-", wall_seconds="s")
    heading = [f"{name} [{units[name]}]" if name in units else name for name in rows[0]]
    with (points.folder / "sweep.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(heading)
        table.writerows(["" if cell is None else cell for cell in row.values()] for row in rows)
    done = [(point.values, point.result) for point in points if point.result]
    if len(values) == 1 and len(done) > 1:
        ((key, _),) = values.items()
        measures = [(name, unit, [r.measures[name] for _, r in done]) for name, unit in done[0][1].units.items()]
        _impactite.chart(points.folder / "sweep.png", f"{title} over {key}", key, [v[key] for v, _ in done], measures)
