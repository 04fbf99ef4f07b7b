"""Runs in folders, and results of them."""

from __future__ import annotations

import csv
import json
import os
import time
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _impactite
from ._impactite import RunError, Scene
from ._progress import Progress, ProgressLike, showing

if TYPE_CHECKING:
    import pandas as pd

#: A scene, a dict like a scene file, or the path of a file.
SceneLike = Union[Scene, Mapping[str, Any], str, "os.PathLike[str]"]


class RunWarning(UserWarning):
    """Warning of a run: lost energy or momentum, numerical fracture, locking."""


@dataclass(frozen=True)
class Check:
    """A measure and its reference."""

    name: str
    #: Value of this run, in ``unit``.
    value: float
    unit: str
    #: Reference value.
    reference: float
    #: Largest allowed difference from the reference, relative to it (absolute if the reference is 0).
    tolerance: float
    #: Source of the reference.
    source: str
    #: True if the check is met.
    met: bool


@dataclass(frozen=True)
class Result:
    """Result of a run in a folder."""

    title: str
    #: Measures at the end in SI units, by name.
    measures: dict[str, float]
    #: Their units.
    units: dict[str, str]
    checks: tuple[Check, ...]
    #: Points at the end.
    points: int
    steps: int
    #: Simulated time, s.
    time: float
    #: Time on the clock in steps, s.
    wall_seconds: float
    #: The largest change of the total energy that nothing explains, over the largest energy so far.
    energy_error: float
    #: The largest change of momentum that nothing explains, over the largest sum of m |v| so far.
    momentum_error: float
    #: Method, space, threads and parameters in SI units.
    settings: dict[str, Any]
    #: Folder of its files.
    folder: Path
    #: Warnings of the run; of a run that was resumed, those since then.
    warnings: tuple[str, ...] = field(default=())

    @property
    def met(self) -> bool:
        """True if all checks are met."""
        return all(check.met for check in self.checks)

    @property
    def report(self) -> Path | None:
        """The page of the run; None if none was made."""
        page = self.folder / "report.html"
        return page if page.exists() else None

    def history(self) -> dict[str, NDArray[np.float64]]:
        """Time, s, and the measures over time in SI units, by name: the columns of ``measures.csv``; empty without measures."""
        path = self.folder / "measures.csv"
        if not self.measures and not path.exists():
            return {}
        with path.open(newline="", encoding="utf-8") as file:
            heading, *rows = csv.reader(file)
        columns = np.array(rows, dtype=float).reshape(len(rows), len(heading)).T
        # `name [unit]`; a name may have brackets of its own.
        return {title.rpartition(" [")[0]: column.copy() for title, column in zip(heading, columns)}

    def to_dataframe(self) -> pd.DataFrame:
        """The history as a DataFrame of pandas: a row a time, ``time`` in s and the measures in SI units.

        Raises ``ImportError`` where pandas is not installed; ``history`` needs none.
        """
        frame: pd.DataFrame = pandas("Result.to_dataframe()", "Result.history()").DataFrame(self.history())
        return frame

    @classmethod
    def _of(cls, told: tuple[str, list[str]], folder: Path) -> Result:
        text, warned = told
        record = json.loads(text)
        numbers = ("value", "reference", "tolerance")
        checks = (
            Check(name=c["name"], unit=c["unit"], source=c["source"], met=c["pass"], **{n: _real(c[n]) for n in numbers})
            for c in record["checks"]
        )
        return cls(
            title=record["case"],
            measures={name: _real(value) for name, value, _ in record["measures"]},
            units={name: unit for name, _, unit in record["measures"]},
            checks=tuple(checks),
            points=record["particles"],
            steps=record["steps"],
            time=record["simulated_seconds"],
            wall_seconds=record["wall_seconds"],
            energy_error=_real(record["energy_error"]),
            momentum_error=_real(record["momentum_error"]),
            settings=record["settings"],
            folder=folder,
            warnings=tuple(warned),
        )


def run(
    scene: SceneLike,
    out: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    pictures: bool = True,
    report: bool = True,
    checkpoint: float = 300.0,
    progress: ProgressLike = None,
) -> Result:
    """Run a scene to its end in the folder ``out``, as the program ``impactite run`` does.

    There are then ``report.html``, ``run.json``, ``result.json``, ``measures.csv``, pictures and files for ParaView. ``out`` is
    ``out/NAME`` if none is given, NAME that of the scene file. ``set`` changes keys; ``threads`` are all processors if none are given,
    and change no bit of the results; ``checkpoint`` are seconds on the clock between checkpoints.

    ``progress`` is a callable that gets a :class:`Progress` some 20 times a second, True for a line on the standard error stream, False
    for none; by default there is one in terminals and notebooks.

    Ctrl-C, and an exception of ``progress``, stop the run with a checkpoint, from which :func:`resume` goes on; while the scene is set up,
    before any file is written.

    Warnings of the run are ``RunWarning`` and in ``Result.warnings``. Raises ``SceneError`` for what is wrong with the scene, ``RunError``
    for a run that breaks, ``OSError`` for files. A missed check is no error: see ``Result.met``.
    """
    scene, folder = scene_and_folder(scene, out, set)
    how = options(threads, pictures, report, checkpoint)
    try:
        with showing(scene.title, progress) as show:
            told = _impactite.run(scene, folder, how, _shown(show))
    except RunError as error:
        _warn(scene.title, error.warnings or ())
        raise
    _warn(scene.title, told[1])
    return Result._of(told, folder)


def resume(
    folder: str | os.PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    checkpoint: float = 300.0,
    progress: ProgressLike = None,
) -> Result:
    """Go on with the run in a folder that was stopped, bit for bit, with the pictures and the page that it was called with.

    ``set`` changes keys that no step depends on: ``end``, which lengthens the run, ``title``, ``description``, ``checks``. The other
    options are those of :func:`run`.

    Raises ``RunError`` where there is no checkpoint, and as :func:`run`.
    """
    folder = Path(folder)
    how = options(threads, None, None, checkpoint)
    try:
        with showing(folder.name, progress) as show:
            told = _impactite.resume(folder, how, _shown(show), list((set or {}).items()))
    except RunError as error:
        _warn(folder.name, error.warnings or ())
        raise
    _warn(folder.name, told[1])
    return Result._of(told, folder)


def _shown(show: Any) -> Any:
    """Callable for the compiled part."""
    if show is None:
        return None
    start = time.monotonic()

    def shown(now: float, end: float, steps: int, rate: float, energy_error: float) -> None:
        show(Progress(now, end, steps, rate, energy_error, time.monotonic() - start))

    return shown


def _warn(title: str, texts: Iterable[str]) -> None:
    for text in texts:
        # Warn at the line that called `run`.
        warnings.warn(f"{title}: {text}", RunWarning, stacklevel=3)


def scene_and_folder(scene: SceneLike, out: str | os.PathLike[str] | None, set: Mapping[str, Any] | None) -> tuple[Scene, Path]:
    """The scene, and the folder for its files."""
    name = "scene"
    changes = dict(set) if set else None
    if isinstance(scene, Scene):
        scene = scene.changed(changes) if changes else scene
    elif isinstance(scene, (str, os.PathLike)):
        name = Path(scene).stem
        scene = Scene.from_file(scene, set=changes)
    else:
        scene = Scene(scene, set=changes)
    return scene, Path(out) if out is not None else Path("out", name)


def options(threads: int | None, pictures: bool | None, report: bool | None, checkpoint: float) -> dict[str, Any]:
    """Options of a job."""
    return {"threads": threads, "pictures": pictures, "report": report, "checkpoint": checkpoint}


def pandas(what: str, otherwise: str) -> Any:
    """The module pandas, for ``what``."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError(f"{what} needs pandas: `pip install pandas`; {otherwise} does not") from error
    return pandas


def _real(number: float | str | None) -> float:
    """Number of a record; JSON has none that are not finite."""
    return float("nan") if number is None else float(number)
