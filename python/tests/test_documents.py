"""What the documents say: the tutorial, the example of the package, and the types."""

import ast
import doctest
import inspect
import re
import runpy
import struct
from pathlib import Path

import pytest

import impactite as im

HERE = Path(__file__).parents[1]


def test_the_tutorial_runs_and_meets_the_reference(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    told = runpy.run_path(str(HERE / "examples" / "taylor_bar.py"))
    # Tolerances of the scene file `scenes/taylor_bar.toml`: the finite elements are good to 0.5 % and 2 %, and as much for ours.
    for name, tolerance in [("length", 0.015), ("foot", 0.04)]:
        assert abs(told["found"][name] / told["reference"][name] - 1) < tolerance, name
    said = capsys.readouterr().out
    assert re.search(r"^length +16\.\d\d mm +16\.28 mm", said, re.M) and re.search(r"^foot +13\.\d\d mm +13\.37 mm", said, re.M)
    assert abs(told["error"]).max() < 0.01
    for name in ("taylor_bar.png", "taylor_bar_outline_energy.png"):
        picture = (tmp_path / name).read_bytes()
        width, height = struct.unpack(">II", picture[16:24])
        assert picture.startswith(b"\x89PNG") and width > 1000 and height > 500
        # An empty page of this size has a tenth of it.
        assert len(picture) > 30_000


def test_the_example_of_the_package_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    failures, examples = doctest.testmod(im)
    assert failures == 0 and examples > 5


def test_the_programs_of_the_documents_run(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    for page in (HERE / "README.md", HERE.parent / "docs" / "book" / "src" / "python.md"):
        folder = tmp_path / page.stem
        folder.mkdir()
        (folder / "taylor_bar.toml").write_text((HERE.parent / "scenes" / "taylor_bar.toml").read_text())
        monkeypatch.chdir(folder)
        programs = re.findall(r"```python\n(.*?)```", page.read_text(), re.S)
        assert programs, page
        spoken = {}
        for program in programs:
            exec(program, spoken)


def plain(text):
    """The words, without what marks code."""
    return " ".join(text.replace("`", "").replace('"', "").split())


def test_the_types_say_what_there_is():
    stub = ast.parse((Path(im.__file__).parent / "_impactite.pyi").read_text())
    classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
    for name in ("Scene", "Simulation", "Body"):
        said = {node.name: ast.get_docstring(node) for node in classes[name].body if isinstance(node, ast.FunctionDef)}
        there = {key: value for key, value in vars(getattr(im, name)).items() if not key.startswith("_")}
        assert {key for key in said if not key.startswith("_")} == there.keys()
        assert plain(ast.get_docstring(classes[name])) == plain(getattr(im, name).__doc__)
        for key, value in there.items():
            assert plain(said[key]) == plain(value.__doc__), f"{name}.{key}"
    for name in ("SceneError", "RunError"):
        fields = {node.target.id for node in classes[name].body if isinstance(node, ast.AnnAssign)}
        assert fields == {key for key, value in vars(getattr(im, name)).items() if value is None}
    (method,) = [node for node in classes["Scene"].body if isinstance(node, ast.FunctionDef) and node.name == "run"]
    options = [each.arg for each in method.args.args[1:] + method.args.kwonlyargs]
    assert options == [*inspect.signature(im.run).parameters][1:]
    undocumented = [name for name in im.__all__ if not getattr(im, name).__doc__]
    assert undocumented == []
