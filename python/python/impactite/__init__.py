"""Impactite: impact, penetration and large deformation of solids.

A scene is what a scene file says, in a dict, a TOML text or a file; quantities are numbers in SI units or texts with units. It is run
step by step, with NumPy arrays of what its points hold:

>>> import impactite as im
>>> scene = im.Scene({
...     "title": "A ball on a wall", "space": "axisymmetric", "end": "1 us",
...     "parameters": {"radius": "2 mm"},
...     "method": {"mpm": {"cell": "radius / 4"}},
...     "materials": {"copper": {"library": "copper_taylor"}},
...     "bodies": {"ball": {
...         "material": "copper", "velocity": [0, "-200 m/s"],
...         "shape": {"ball": {"centre": [0, "radius"], "radius": "radius"}},
...     }},
...     "conditions": [{"symmetry": {"axis": "r", "at": 0}}, {"wall": {"axis": "z", "at": 0}}],
... })
>>> simulation = scene.simulation(threads=1)
>>> simulation.run()
>>> ball = simulation.bodies["ball"]
>>> ball.positions.shape == (len(ball), 3)
True
>>> bool(ball.state["plastic_strain"].max() > 0)
True

or whole in a folder, with pictures, histories, files for ParaView and a page, as the program `impactite run` does:

>>> result = im.run(scene, out="out/ball")
>>> result.report.as_posix()
'out/ball/report.html'
"""

from __future__ import annotations

import builtins
import itertools
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Union

from . import _impactite
from ._impactite import Body, RunError, Scene, SceneError, Simulation, __version__

__all__ = [
    "Body",
    "Check",
    "Item",
    "Result",
    "RunError",
    "Scene",
    "SceneError",
    "Simulation",
    "SweepPoint",
    "__version__",
    "list",
    "resume",
    "run",
    "schema",
    "sweep",
]

#: What is a scene: one, a dict like a scene file, or the path of a file.
SceneLike = Union[Scene, dict[str, Any], str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Check:
    """A measure beside what it should be."""

    name: str
    #: This run's, in ``unit``.
    value: float
    unit: str
    #: What it should be.
    reference: float
    #: How far from the reference it may be, relative to it (absolute where the reference is 0).
    tolerance: float
    #: Where the reference is from.
    source: str
    #: Is it met?
    met: bool


@dataclass(frozen=True)
class Result:
    """What a run in a folder came to."""

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
    #: Where its files are.
    folder: Path

    @property
    def met(self) -> bool:
        """Are all checks met?"""
        return all(check.met for check in self.checks)

    @property
    def report(self) -> Path | None:
        """The page of the run; None if none was made."""
        page = self.folder / "report.html"
        return page if page.exists() else None

    @classmethod
    def _of(cls, text: str, folder: Path) -> Result:
        told = json.loads(text)
        numbers = ("value", "reference", "tolerance")
        checks = (
            Check(name=c["name"], unit=c["unit"], source=c["source"], met=c["pass"], **{n: _real(c[n]) for n in numbers})
            for c in told["checks"]
        )
        return cls(
            title=told["case"],
            measures={name: _real(value) for name, value, _ in told["measures"]},
            units={name: unit for name, _, unit in told["measures"]},
            checks=tuple(checks),
            points=told["particles"],
            steps=told["steps"],
            time=told["simulated_seconds"],
            wall_seconds=told["wall_seconds"],
            energy_error=_real(told["energy_error"]),
            momentum_error=_real(told["momentum_error"]),
            settings=told["settings"],
            folder=folder,
        )


class SweepPoint(NamedTuple):
    """A run of a sweep."""

    #: A value a key.
    values: dict[str, Any]
    #: What came; None if the run failed.
    result: Result | None
    #: Why it failed; None if it did not.
    error: str | None


class Item(NamedTuple):
    """Something that scene files can say."""

    name: str
    #: What it is.
    what: str
    #: Its options; ``?`` after those that may be left out.
    options: tuple[str, ...]


def run(
    scene: SceneLike,
    out: str | os.PathLike[str] | None = None,
    *,
    set: dict[str, Any] | None = None,
    threads: int | None = None,
    pictures: bool = True,
    report: bool = True,
    checkpoint: float = 300.0,
) -> Result:
    """Run a scene to its end in the folder ``out``, as the program ``impactite run`` does.

    There are then ``report.html``, ``run.json``, ``result.json``, ``measures.csv``, pictures and files for ParaView. ``out`` is
    ``out/NAME`` if none is given, NAME that of the scene file. ``set`` changes keys; ``threads`` are all processors if none are given,
    and change no bit of the results; ``checkpoint`` are seconds on the clock between checkpoints.

    Ctrl-C stops the run with a checkpoint, from which :func:`resume` goes on.

    Raises ``SceneError`` for what is wrong with the scene, ``RunError`` for a run that breaks, ``OSError`` for files. A missed check
    is no error: see ``Result.met``.
    """
    scene, folder = _scene(scene, out, set)
    return Result._of(_impactite.run(scene, folder, _how(threads, pictures, report, checkpoint)), folder)


def resume(
    folder: str | os.PathLike[str],
    *,
    threads: int | None = None,
    pictures: bool = True,
    report: bool = True,
    checkpoint: float = 300.0,
) -> Result:
    """Go on with the run in a folder that was stopped, bit for bit. The options are those of :func:`run`.

    Raises ``RunError`` where there is no checkpoint, and as :func:`run`.
    """
    folder = Path(folder)
    return Result._of(_impactite.resume(folder, _how(threads, pictures, report, checkpoint)), folder)


def sweep(
    scene: SceneLike,
    over: Mapping[str, Iterable[Any]],
    out: str | os.PathLike[str] | None = None,
    *,
    set: dict[str, Any] | None = None,
    threads: int | None = None,
    pictures: bool = True,
    report: bool = True,
    checkpoint: float = 300.0,
) -> builtins.list[SweepPoint]:
    """Run a scene for all combinations of values of keys: ``over={"parameters.speed": ["150 m/s", "200 m/s"]}``.

    Each run has a folder in ``out``, which has the table ``sweep.csv``, too, and the chart ``sweep.png`` of one key. A run that fails
    is a point that says so. The options are those of :func:`run`.

    Raises as :func:`run` for what is wrong with a scene before the first run.
    """
    scene, folder = _scene(scene, out, set)
    values = {key: [*each] for key, each in over.items()}
    points = _impactite.sweep(scene, [*values.items()], folder, _how(threads, pictures, report, checkpoint))
    return [
        SweepPoint(dict(zip(values, combination)), Result._of(told, folder / f"{n:03}") if told else None, error)
        for n, (combination, (told, error)) in enumerate(zip(itertools.product(*values.values()), points), 1)
    ]


def schema() -> dict[str, Any]:
    """The JSON Schema of scene files: every key with what it is."""
    return json.loads(_impactite.schema())


def list(topic: str) -> builtins.list[Item]:
    """What scene files can say of a topic.

    Topics are ``methods``, ``laws``, ``materials``, ``contacts``, ``conditions``, ``shapes``, ``measures``, ``templates``.
    """
    return [Item(name, what, tuple(options)) for name, what, options in _impactite.items(topic)]


def _scene(scene: SceneLike, out: str | os.PathLike[str] | None, set: dict[str, Any] | None) -> tuple[Scene, Path]:
    """The scene, and the folder for its files."""
    name = "scene"
    if isinstance(scene, Scene):
        scene = scene.changed(set) if set else scene
    elif isinstance(scene, dict):
        scene = Scene(scene, set=set)
    else:
        name = Path(scene).stem
        scene = Scene.from_file(scene, set=set)
    return scene, Path(out) if out is not None else Path("out", name)


def _how(threads: int | None, pictures: bool, report: bool, checkpoint: float) -> dict[str, Any]:
    return {"threads": threads, "pictures": pictures, "report": report, "checkpoint": checkpoint}


def _real(number: float | str | None) -> float:
    """A number of a record, in which JSON has no word for one that is not finite."""
    return float("nan") if number is None else float(number)
