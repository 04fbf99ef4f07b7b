"""Scenes: what they are made of, and what is wrong with them."""

import json
from pathlib import Path

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


def test_a_dict_may_hold_arrays_and_paths(tree):
    tree["bodies"]["disc"]["velocity"] = np.array([0, -2])
    tree["bodies"]["disc"]["material"] = Path("rubber")
    im.Scene(tree)
    tree["bodies"]["disc"]["velocity"] = [0, object()]
    with pytest.raises(TypeError, match="a scene holds dicts, lists, .*not object"):
        im.Scene(tree)


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
        ("title", None, ["set: title"]),
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
    with pytest.raises(ValueError, match="methods, laws"):
        im.list("method")
    assert {"title", "bodies", "method"} <= im.schema()["properties"].keys()
