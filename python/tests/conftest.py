"""A small scene for all tests: a rubber disc falls on a floor, in the plane."""

import copy

import pytest

import impactite as im

DISC = {
    "title": "Disc on a floor",
    "space": "plane strain",
    "end": "2 ms",
    "method": {"mpm": {"cell": "2 mm"}},
    "materials": {"rubber": {"neo_hookean": {"density": "1 g/cm^3", "young": "1 MPa", "poisson": 0.4}}},
    "conditions": [{"wall": {"axis": "y", "at": 0}}],
    "parameters": {"radius": "10 mm", "speed": "2 m/s"},
    "bodies": {
        "disc": {
            "material": "rubber",
            "shape": {"ball": {"centre": [0, "radius + 1 mm"], "radius": "radius"}},
            "velocity": [0, "-speed"],
        }
    },
    "measures": {
        "height": {"centre": {"body": "disc", "axis": "y"}},
        "velocity": {"mean_velocity": {"body": "disc", "axis": "y"}},
        "mass": {"mass": {"body": "disc"}},
    },
    # A metre of it; points of a lattice in a circle have its area to a cell in its circumference.
    "checks": [{"measure": "mass", "reference": "314.16 g", "tolerance": 0.02, "source": "density times area"}],
}

#: The same as a file.
TEXT = """\
title = "Disc on a floor"
space = "plane strain"
end = "2 ms"
method.mpm = { cell = "2 mm" }
materials.rubber.neo_hookean = { density = "1 g/cm^3", young = "1 MPa", poisson = 0.4 }
conditions = [{ wall = { axis = "y", at = 0 } }]

[parameters]
radius = "10 mm"
speed = "2 m/s"

[bodies.disc]
material = "rubber"
shape.ball = { centre = [0, "radius + 1 mm"], radius = "radius" }
velocity = [0, "-speed"]

[measures]
height = { centre = { body = "disc", axis = "y" } }
velocity = { mean_velocity = { body = "disc", axis = "y" } }
mass = { mass = { body = "disc" } }

[[checks]]
measure = "mass"
reference = "314.16 g"
tolerance = 0.02
source = "density times area"
"""


@pytest.fixture
def tree():
    """The scene as a dict of one's own."""
    return copy.deepcopy(DISC)


@pytest.fixture
def scene(tree):
    return im.Scene(tree)


@pytest.fixture
def file(tmp_path):
    """The scene as a file."""
    path = tmp_path / "disc.toml"
    path.write_text(TEXT)
    return path


def bits(simulation):
    """All that a simulation shows, as bytes."""
    said = [repr((simulation.time, simulation.steps, simulation.measures(), simulation.energy())).encode()]
    for body in simulation.bodies.values():
        arrays = [body.numbers, body.positions, body.velocities, body.stress, body.masses, body.volumes, *body.state.values()]
        said += [array.tobytes() for array in arrays]
    return b"".join(said)
