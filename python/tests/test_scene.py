"""Scenes: what they are made of, and what is wrong with them."""

import json
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from conftest import TEXT, bits

import impactite as im


def test_a_dict_a_text_and_files_are_the_same_scene(tree, file, tmp_path):
    (tmp_path / "disc.json").write_text(json.dumps(tree))
    scenes = [im.Scene(tree), im.Scene.from_toml(TEXT), im.Scene.from_file(file), im.Scene.from_file(tmp_path / "disc.json")]
    found = []
    for scene in scenes:
        assert (scene.title, scene.space, scene.end) == ("Disc on a floor", "plane strain", 2e-3)
        assert scene.parameters == {"radius": 0.01, "speed": 2.0}
        assert scene.measures == {"height": "m", "velocity": "m/s", "mass": "kg/m"}
        simulation = scene.simulation(threads=1)
        simulation.step(50)
        found.append(bits(simulation))
    assert len(set(found)) == 1
    assert im.Scene.from_toml(scenes[0].text).text == scenes[0].text


def test_keys_are_changed_by_values_of_python(scene, tree):
    values = {"parameters.speed": "3 m/s", "end": 1e-3, "bodies.disc.velocity[0]": np.float64(0.5), "only_warn": True}
    changed = scene.changed(values)
    assert (changed.parameters["speed"], changed.end) == (3.0, 1e-3)
    assert scene.parameters["speed"] == 2.0, "the scene itself stays"
    velocities = changed.simulation(threads=1).bodies["disc"].velocities
    assert (velocities == [0.5, -3.0, 0.0]).all()
    assert im.Scene(tree, set=values).text == changed.text
    whole = scene.changed({"method": {"mpm": {"cell": 0.001}}})
    assert len(whole.simulation(threads=1).bodies["disc"]) > 2 * len(scene.simulation(threads=1).bodies["disc"])


def test_a_dict_may_hold_arrays_paths_and_numbers_of_other_kinds(tree):
    disc = tree["bodies"]["disc"]
    disc["velocity"], disc["material"] = np.array([0, -2]), Path("rubber")
    text = im.Scene(tree).text
    for speed in (np.int32(-2), Fraction(-2), np.array(-2)):
        disc["velocity"] = (0, speed)
        assert im.Scene(MappingProxyType(tree)).parameters["speed"] == 2.0
    disc["velocity"] = [0, -2]
    assert im.Scene(tree).text == text
    for half in (0.5, np.float32(0.5), np.float64(0.5), Decimal("0.5"), Fraction(1, 2), np.longdouble(0.5)):
        assert im.Scene(tree, set={"end": half}).end == 0.5
    assert im.Scene(tree, set={"end": np.uint8(2), "only_warn": np.bool_(True), "bodies.disc.velocity": range(2)}).end == 2.0


class Millimetres(np.ndarray):
    unit = "mm"


def nested(levels, inner=1, wrap=lambda value: [value]):
    for _ in range(levels):
        inner = wrap(inner)
    return inner


def itself():
    table = {}
    table["a"] = table
    return table


@pytest.mark.parametrize(
    "value, kind, key, words",
    [
        (None, im.SceneError, "{0}", "`{0}` is None; leave the key out"),
        ([0, None], im.SceneError, "{0}[1]", "`{0}[1]` is None; leave it out of the list"),
        ({"box": None}, im.SceneError, "{0}.box", "`{0}.box` is None"),
        (np.array([0, np.nan]), im.SceneError, "{0}[1]", "`{0}[1]` is NaN; it must be finite"),
        (float("-inf"), im.SceneError, "{0}", "`{0}` is -inf; it must be finite"),
        (10**30, im.SceneError, "{0}", "`{0}` is an integer of more than 64 bits"),
        (np.arange(2).view(Millimetres), im.SceneError, "{0}", "`{0}` is a Millimetres with the unit mm; write a text"),
        ([object()], TypeError, None, "`{0}[0]` is an object; a scene holds dicts, lists, arrays, texts"),
        (b"2 m", TypeError, None, "`{0}` is a bytes; a scene holds"),
        ({1, 2}, TypeError, None, "`{0}` is a set; a scene holds"),
        (2j, TypeError, None, "`{0}` is a complex; a scene holds"),
        (np.datetime64("2020-01-01"), TypeError, None, "`{0}` is a date; a scene holds"),
        ({1: 2}, TypeError, None, "`{0}` has the key 1, which is an int; keys of a scene are texts"),
        (nested(1000), im.SceneError, ..., "below 64 levels of dicts and lists"),
        (nested(100_000), im.SceneError, ..., "below 64 levels of dicts and lists"),
        (nested(1000, wrap=lambda value: {"a": value}), im.SceneError, ..., "below 64 levels of dicts and lists"),
        (itself(), im.SceneError, ..., "does one of them contain itself?"),
    ],
)
def test_values_that_no_scene_has_are_refused_with_their_key(tree, value, kind, key, words):
    scene = im.Scene(tree)
    tree["bodies"]["disc"]["velocity"] = value
    for attempt, start in ((lambda: im.Scene(tree), ""), (lambda: scene.changed({"bodies.disc.velocity": value}), "set: ")):
        with pytest.raises(kind) as caught:
            attempt()
        at = "bodies.disc.velocity"
        assert words.format(at) in str(caught.value) and str(caught.value).startswith(start)
        if key is not ...:
            assert getattr(caught.value, "key", None) == (key and key.format(at))


def test_what_is_no_dict_is_no_scene(file):
    for wrong, words in [
        ([1], "`Scene` does not take a list; a scene is a dict"),
        (None, "`Scene` does not take None"),
        (3, "`Scene` does not take an int"),
        ("title = 1", "`Scene` does not take a str; `Scene.from_file` reads a file, `Scene.from_toml` a text"),
    ]:
        with pytest.raises(TypeError, match=words):
            im.Scene(wrong)
    with pytest.raises(TypeError, match="does not take a list"):
        im.run([1])
    with pytest.raises(TypeError, match="the key 3 is an int"):
        im.Scene.from_file(file, set={3: 1})
    # The levels that are allowed are read: what is wrong is another thing.
    with pytest.raises(im.SceneError, match="unknown field"):
        im.Scene({"a": nested(62)})


def test_what_is_wrong_is_told_with_its_place(file):
    file.write_text(TEXT.replace("velocity = [0,", "velocty = [0,"))
    with pytest.raises(im.SceneError) as caught:
        im.Scene.from_file(file)
    error = caught.value
    assert isinstance(error, ValueError)
    assert (error.file, error.line, error.column) == (str(file), 15, 1)
    assert (error.key, error.help) == ("bodies.disc.velocty", "did you mean `velocity`?")
    assert "unknown field" in error.reason
    for part in (f"{file}:15:1: bodies.disc", 'velocty = [0, "-speed"]', "^^^^^^^", "help: did you mean `velocity`?"):
        assert part in str(error)


@pytest.mark.parametrize(
    "key, value, words",
    [
        ("bodies.disc.velocity", [0, "-speeed"], ["bodies.disc.velocity[1]", "speeed"]),
        ("bodies.disc.material", "rubbr", ["bodies.disc.material", "did you mean `rubber`?"]),
        ("materials.rubber.neo_hookean.young", "1 mm", ["materials.rubber", "pressure", "1 mm"]),
        ("method.mpm.cell", 0, ["method.mpm.cell", "0"]),
        ("checks[0].measure", "heigt", ["checks[0].measure", "did you mean `height`?"]),
        ("parameters.sped", 3, ["set: parameters.sped", "did you mean `speed`?"]),
        ("title", None, ["set: `title` is None"]),
    ],
)
def test_values_that_are_none_are_refused_where_they_enter(scene, key, value, words):
    with pytest.raises(ValueError) as caught:
        scene.changed({key: value}).simulation(threads=1)
    for word in words:
        assert word in str(caught.value)


def test_errors_of_a_dict_show_the_line_of_its_text(tree):
    tree["ends"] = tree.pop("end")
    with pytest.raises(im.SceneError) as caught:
        im.Scene(tree)
    assert (caught.value.file, caught.value.key, caught.value.help) == ("<dict>", "ends", "did you mean `end`?")


def test_files_that_are_not_there_are_not_found(tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        im.Scene.from_file(tmp_path / "none.toml")
    assert caught.value.filename == str(tmp_path / "none.toml")


def test_files_that_a_scene_names_are_beside_it(tree, tmp_path):
    tree["space"], tree["bodies"]["disc"]["velocity"] = "3d", [0, 0, -2]
    tree["conditions"], tree["measures"], tree["checks"] = [], {}, []
    tree["bodies"]["disc"]["shape"] = {"surface": {"file": "tetrahedron.stl", "unit": "1 m"}}
    corners = 0.02 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    lines = ["solid tetrahedron"]
    for facet in [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(map(str, corners[corner])) for corner in facet]
        lines += ["endloop", "endfacet"]
    (tmp_path / "tetrahedron.stl").write_text("\n".join([*lines, "endsolid tetrahedron", ""]))
    body = im.Scene(tree, folder=tmp_path).simulation(threads=1).bodies["disc"]
    # The volume of the tetrahedron, to what cutting cells of 2 mm by its faces leaves.
    assert body.mass == pytest.approx(1000 * 0.02**3 / 6, rel=0.05)
    with pytest.raises(im.SceneError, match="tetrahedron.stl"):
        im.Scene(tree, folder=tmp_path / "elsewhere").simulation(threads=1)


def test_what_scenes_can_say_is_listed():
    assert {"mpm", "fem", "sph", "fpm", "pcmm"} <= {item.name for item in im.list("methods")}
    assert "copper_taylor" in {item.name for item in im.list("materials")}
    assert all(item.name and item.what for item in im.list("templates"))
    with pytest.raises(ValueError, match="methods, parts"):
        im.list("method")
    assert {"title", "bodies", "method"} <= im.schema()["properties"].keys()
