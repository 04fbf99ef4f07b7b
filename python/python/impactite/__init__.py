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

from ._impactite import Body, RunError, Scene, SceneError, Simulation, __version__
from ._progress import Progress, SweepProgress
from ._reference import Item, list, schema
from ._runs import Check, Result, RunWarning, resume, run
from ._sweep import Sweep, SweepPoint, sweep

__all__ = [
    "Body",
    "Check",
    "Item",
    "Progress",
    "Result",
    "RunError",
    "RunWarning",
    "Scene",
    "SceneError",
    "Simulation",
    "Sweep",
    "SweepPoint",
    "SweepProgress",
    "__version__",
    "list",
    "resume",
    "run",
    "schema",
    "sweep",
]

for _name in __all__:
    # The public name in messages and pickles.
    if isinstance(globals()[_name], type):
        globals()[_name].__module__ = __name__
del _name


def __dir__():  # type: ignore[no-untyped-def]
    # Without the modules of the package.
    return [*__all__, "__doc__", "__file__", "__name__", "__path__"]
