"""The part of ``impactite`` that is compiled. Import from ``impactite``."""

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from ._progress import ProgressLike
from ._runs import Result

__all__ = [
    "Body",
    "RunError",
    "Scene",
    "SceneError",
    "Simulation",
    "__version__",
    "chart",
    "items",
    "resume",
    "run",
    "schema",
]
__version__: str

class SceneError(ValueError):
    """What is wrong with a scene. The message shows its place; the attributes are its parts, None where there is none."""

    #: What the scene is called: the file.
    file: str | None
    #: Line of the text, from 1.
    line: int | None
    #: Column in characters, from 1.
    column: int | None
    #: The key, as ``bodies.rod.velocity``.
    key: str | None
    #: What is wrong.
    reason: str | None
    #: What to do.
    help: str | None

class RunError(RuntimeError):
    """A run that cannot go on. The attributes say what stopped a step, None where it was none or no point of a body."""

    #: Number of the step.
    step: int | None
    #: Time at its start, s.
    time: float | None
    #: The body.
    body: str | None
    #: Number of the point.
    number: int | None
    #: Its position, m.
    position: tuple[float, float, float] | None
    #: Warnings of a run in a folder before it.
    warnings: list[str] | None

@final
class Scene:
    """A scene: bodies of materials, how they are computed, what acts on them, how long.

    Made of a dict, or by ``Scene.from_file`` and ``Scene.from_toml``, of the keys of scene files. Quantities are numbers in SI units or
    texts with units. ``set`` changes keys: ``{"parameters.speed": "227 m/s"}``. Files that the scene names are looked for in
    ``folder``.

    Raises ``SceneError`` for what is wrong, with its place. A dict is read as the TOML text that ``text`` shows. Scenes can be pickled.
    """

    def __new__(
        cls, tree: Mapping[str, Any], *, set: dict[str, Any] | None = None, folder: str | os.PathLike[str] | None = None
    ) -> Scene: ...
    @classmethod
    def from_file(cls, path: str | os.PathLike[str], *, set: dict[str, Any] | None = None) -> Scene:
        """The scene of a file: TOML, or JSON if its name ends with ``.json``."""

    @classmethod
    def from_toml(cls, text: str, *, set: dict[str, Any] | None = None, folder: str | os.PathLike[str] | None = None) -> Scene:
        """The scene of a TOML text."""

    def changed(self, set: dict[str, Any]) -> Scene:
        """The same scene with other values of some keys; this one stays as it is."""

    def simulation(self, *, threads: int | None = None) -> Simulation:
        """The scene set up, ready to step on so many threads (all processors if none are given). Results are the same bits for any
        number."""

    def run(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        set: Mapping[str, Any] | None = None,
        threads: int | None = None,
        pictures: bool = True,
        report: bool = True,
        checkpoint: float = 300.0,
        progress: ProgressLike = None,
    ) -> Result:
        """Run the scene to its end in the folder ``out``: ``impactite.run(scene, out, ...)``, with its options."""

    @classmethod
    def _of(cls, name: str, text: str) -> Scene: ...
    def __reduce__(self) -> tuple[Any, tuple[str, str]]: ...
    def __copy__(self) -> Scene: ...
    def __deepcopy__(self, _memo: object, /) -> Scene: ...
    @property
    def title(self) -> str:
        """Its title."""

    @property
    def description(self) -> str:
        """What it says of itself."""

    @property
    def space(self) -> str:
        """``"3d"``, ``"plane strain"``, ``"plane stress"`` or ``"axisymmetric"``."""

    @property
    def end(self) -> float:
        """When it ends, s."""

    @property
    def text(self) -> str:
        """Its text, in TOML."""

    @property
    def parameters(self) -> dict[str, float]:
        """Its parameters in SI units, by name."""

    @property
    def measures(self) -> dict[str, str]:
        """SI units of its measures, by name; ``"-"`` of plain numbers."""

@final
class Simulation:
    """A scene that is set up and goes on by steps, made by ``Scene.simulation``.

    A step that cannot be made raises ``RunError``. While it steps other threads of Python run; one that asks it for something waits for
    a step to end. Ctrl-C stops it between two steps, after which it may go on.
    """

    def step(self, n: int = 1) -> int:
        """Make ``n`` steps, or fewer where the scene ends. Returns how many were made: 0 at the end."""

    def run_until(self, t: float) -> None:
        """Step until the time ``t``, s, which is met exactly: the last steps are shortened for it. It may be after the end of the
        scene."""

    def run(self) -> None:
        """Step until the scene ends: the same bits as ``impactite.run``."""

    @property
    def time(self) -> float:
        """Simulated time, s."""

    @property
    def steps(self) -> int:
        """Steps made."""

    @property
    def dt(self) -> float | None:
        """Size of the last step, s; None before the first."""

    @property
    def reached_end(self) -> bool:
        """Has the scene come to its end?"""

    @property
    def end(self) -> float:
        """When the scene ends, s."""

    @property
    def method(self) -> str:
        """The method, in a line of words."""

    @property
    def dimensions(self) -> int:
        """Dimensions of the scene, 2 or 3."""

    @property
    def threads(self) -> int:
        """Threads that it steps on."""

    @property
    def bodies(self) -> dict[str, Body]:
        """The bodies, by name. They show the simulation as it is when they are asked."""

    @property
    def warnings(self) -> list[str]:
        """What the run warned of so far."""

    def measures(self) -> dict[str, float]:
        """The measures of the scene as it stands, in SI units, by name. Of a quarter model they are those of the quarter."""

    def energy(self) -> dict[str, float]:
        """Energies, J (per radian around an axis, per metre of depth in the plane).

        ``kinetic``, ``internal``, ``total`` (their sum), ``work`` of loads, ``friction``, ``impacts``, ``damping``, ``viscosity``
        (numerical), ``viscous_heat`` (of laws, part of ``internal``), ``unexplained``; and ``error``,
        what nothing explains over the largest energy so far.
        """

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a checkpoint to the file ``path``, which is the old one or the new one at any time."""

    def resume(self, path: str | os.PathLike[str]) -> None:
        """Go on from the checkpoint ``path`` that a simulation of the same scene saved, bit for bit. After a ``RunError`` this simulation
        is not to be used any more."""

@final
class Body:
    """A body of a simulation, as it is when it is asked.

    Its arrays have a row a point (a particle, or an element), in the order of ``numbers``. They are gathered once a state, all in one
    pass, and handed over without a copy; later steps do not change them. They cannot be written to: that would change nothing in the
    simulation.
    """

    def __len__(self) -> int:
        """How many points it has; none of a wall."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def law(self) -> str:
        """The name of its law; empty without one."""

    @property
    def mass(self) -> float:
        """Mass, kg (per radian around an axis, per metre of depth in the plane)."""

    @property
    def momentum(self) -> tuple[float, float, float]:
        """Momentum along x, y, z, kg m/s."""

    @property
    def kinetic(self) -> float:
        """Kinetic energy, J."""

    @property
    def internal(self) -> float:
        """Internal energy, plastic work and heat included, J."""

    @property
    def numbers(self) -> NDArray[np.int64]:
        """Numbers of the points, which stay the same over a run; shape (n,)."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """Positions, m; shape (n, 3), (r, z, 0) around an axis."""

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities, m/s; shape (n, 3)."""

    @property
    def stress(self) -> NDArray[np.float64]:
        """Cauchy stress xx, yy, zz, yz, xz, xy, tension positive, Pa; shape (n, 6)."""

    @property
    def masses(self) -> NDArray[np.float64]:
        """Masses, kg (per radian, per metre of depth); shape (n,)."""

    @property
    def volumes(self) -> NDArray[np.float64]:
        """Volumes, m^3 (per radian, per metre of depth); shape (n,)."""

    @property
    def widths(self) -> NDArray[np.float64]:
        """How wide points are drawn, m: edges of cubes or squares of their volume; shape (n,)."""

    @property
    def pressure(self) -> NDArray[np.float64]:
        """Pressure, compression positive, Pa; shape (n,)."""

    @property
    def von_mises(self) -> NDArray[np.float64]:
        """Von Mises equivalent stress, Pa; shape (n,)."""

    @property
    def failed(self) -> NDArray[np.bool_]:
        """Which points have failed; shape (n,), bool."""

    @property
    def state_names(self) -> list[str]:
        """The names in ``state``."""

    @property
    def state(self) -> dict[str, NDArray[np.float64]]:
        """What the law keeps of each point, by the names in ``state_names``; shapes (n,)."""

def run(
    scene: Scene,
    folder: str | os.PathLike[str],
    how: dict[str, Any],
    shown: Callable[[float, float, int, float, float], object] | None = None,
) -> tuple[str, list[str]]: ...
def resume(
    folder: str | os.PathLike[str],
    how: dict[str, Any],
    shown: Callable[[float, float, int, float, float], object] | None = None,
    set: Sequence[tuple[str, Any]] = (),
) -> tuple[str, list[str]]: ...
def chart(
    path: str | os.PathLike[str],
    title: str,
    key: str,
    values: Sequence[Any],
    measures: Sequence[tuple[str, str, Sequence[float]]],
) -> bool: ...
def schema() -> str: ...
def items(topic: str) -> list[tuple[str, str, list[str]]]: ...
