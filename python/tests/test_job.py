"""Whole runs in folders."""

import csv
import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from test_simulation import endless, interrupt_soon  # noqa: F401

import impactite as im

ROOT = Path(__file__).parents[2]


def test_a_run_leaves_its_files_and_the_bits_of_steps(scene, tmp_path):
    result = im.run(scene, tmp_path / "out", threads=2)
    simulation = scene.simulation(threads=1)
    simulation.run()
    assert result.measures == simulation.measures() and result.units == scene.measures
    assert (result.steps, result.time, result.points) == (simulation.steps, scene.end, len(simulation.bodies["disc"]))
    assert result.title == scene.title and result.settings["parameters"] == scene.parameters
    assert result.settings["threads"] in (1, 2) and result.wall_seconds > 0
    # The largest of the run is at least that of its end.
    assert abs(result.energy_error) >= abs(simulation.energy()["error"]) > 0
    (check,) = result.checks
    assert result.met and check.met and (check.name, check.reference, check.source) == ("mass", 0.31416, "density times area")
    assert result.report == tmp_path / "out" / "report.html" and scene.title in result.report.read_text()
    assert (result.folder / "paraview" / "scene.pvd").exists()
    rows = [*csv.reader((result.folder / "measures.csv").open())]
    assert len(rows) > 100


def test_a_missed_check_is_no_error(file, tmp_path):
    values = {"checks[0].reference": "1 kg"}
    result = im.run(file, tmp_path / "out", set=values, pictures=False, report=False)
    assert not result.met and not result.checks[0].met and result.report is None
    assert not (tmp_path / "out" / "pictures").exists() or not [*(tmp_path / "out" / "pictures").iterdir()]


def test_the_folder_has_the_name_of_the_file(file, tree, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    how = {"pictures": False, "report": False, "set": {"end": "10 us"}}
    assert im.run("disc.toml", **how).folder == Path("out/disc")
    assert im.run(tree, **how).folder == Path("out/scene")
    with pytest.raises(ValueError, match="checkpoint = -1"):
        im.run(tree, checkpoint=-1)
    with pytest.raises(ValueError, match="threads"):
        im.run(tree, threads=0)


def program():
    """The program `impactite`: IMPACTITE in the environment, or where it is built or installed."""
    built = ROOT / "target" / "release" / "impactite"
    named = os.environ.get("IMPACTITE")
    return named or (str(built) if built.exists() else shutil.which("impactite"))


@pytest.mark.skipif(program() is None, reason="no program `impactite`: set IMPACTITE to it")
def test_the_program_gets_the_same_bits(file, tmp_path):
    out = tmp_path / "program"
    subprocess.run([program(), "run", file, "--out", out, "--no-report", "--quiet"], check=True, capture_output=True)
    theirs = json.loads((out / "result.json").read_text())
    ours = im.run(file, tmp_path / "python", report=False)
    assert [[name, value] for name, value, _ in theirs["measures"]] == [[*pair] for pair in ours.measures.items()]
    assert (theirs["steps"], theirs["energy_error"]) == (ours.steps, ours.energy_error)
    assert (out / "measures.csv").read_bytes() == (ours.folder / "measures.csv").read_bytes()


def test_ctrl_c_leaves_a_checkpoint_from_which_it_goes_on(scene, endless, tmp_path):  # noqa: F811
    out = tmp_path / "out"
    interrupt_soon()
    with pytest.raises(KeyboardInterrupt):
        im.run(endless, out, threads=2, pictures=False)
    assert (out / "run.checkpoint").exists() and (out / "report.html").exists()
    interrupt_soon()
    with pytest.raises(KeyboardInterrupt):
        im.resume(out)
    with pytest.raises(im.RunError, match="nothing to resume"):
        im.resume(tmp_path / "nothing")
    with pytest.raises(ValueError, match="keeps its scene"):
        im.resume(out, set={"parameters.speed": "3 m/s"})


def test_a_sweep_has_a_run_a_value(scene, tmp_path):
    how = {"pictures": False, "report": False, "processes": 2}
    over = {"parameters.speed": ["1 m/s", "2 m/s"], "bodies.disc.velocity[0]": [0, 0.5]}
    points = im.sweep(scene, over, tmp_path / "sweep", **how)
    assert [(*point.values.values(),) for point in points] == [("1 m/s", 0), ("1 m/s", 0.5), ("2 m/s", 0), ("2 m/s", 0.5)]
    assert (tmp_path / "sweep" / "sweep.csv").exists()
    for n, point in enumerate(points, 1):
        assert point.error is None and point.result.folder == tmp_path / "sweep" / f"{n:03}"
        alone = scene.changed(point.values).simulation(threads=1)
        alone.run()
        assert point.result.measures == alone.measures()
    with pytest.raises(im.SceneError, match="speed"):
        im.sweep(scene, {"parameters.sped": ["1 m/s"]}, tmp_path / "none", **how)


def test_a_measure_ends_a_run_and_a_simulation_alike(tree, tmp_path):
    tree["until"] = {"measure": "velocity", "above": 0}
    tree["measures"]["peak"] = {"over_time": {"of": "floor", "take": "largest"}}
    tree["measures"]["floor"] = {"condition_force": {"axis": "y"}}
    scene = im.Scene(tree)
    result = im.run(scene, tmp_path / "out", pictures=False, report=False)
    simulation = scene.simulation(threads=1)
    simulation.run()
    assert simulation.time == result.time < scene.end and simulation.measures() == result.measures
    assert simulation.reached_end and simulation.step() == 0 and result.measures["peak"] > 0
    # What is known over time is in checkpoints of runs alone.
    simulation.save(tmp_path / "checkpoint")
    with pytest.raises(ValueError, match="over time"):
        scene.simulation().resume(tmp_path / "checkpoint")
