"""Processes: forked children, pickles, and sweeps in interpreters of their own."""

import copy
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest
from conftest import bits
from test_simulation import interrupt_soon

import impactite as im

forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="no os.fork")

#: More than a child needs, s.
PATIENCE = 60


@pytest.fixture(scope="module")
def alone():
    """The bits of 20 steps of the disc."""
    return stepped(1, 20)


def stepped(threads, steps=20):
    """Bits of a simulation that this process makes."""
    from conftest import DISC

    simulation = im.Scene(DISC).simulation(threads=threads)
    simulation.step(steps)
    return bits(simulation)


def forked(work):
    """What `work` returns in a forked child, or the text of what it raises."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            said = work()
        except BaseException as error:  # noqa: BLE001
            said = f"{type(error).__name__}: {error}"
        try:
            with os.fdopen(write, "wb") as pipe:
                pickle.dump(said, pipe)
        finally:
            os._exit(0)
    os.close(write)
    timer = threading.Timer(PATIENCE, os.kill, (child, signal.SIGKILL))
    timer.start()
    with os.fdopen(read, "rb") as pipe:
        said = pipe.read()
    timer.cancel()
    os.waitpid(child, 0)
    assert said, "the child hangs"
    return pickle.loads(said)


@forks
@pytest.mark.parametrize("threads", [1, 2])
def test_a_forked_child_makes_simulations(alone, threads):
    for parent in (1, 2):
        assert stepped(parent) == alone
        assert forked(lambda: stepped(threads)) == alone
        # And a child of the child.
        assert forked(lambda: (stepped(threads), forked(lambda: stepped(threads)))) == (alone, alone)


@forks
@pytest.mark.parametrize("threads", [1, 2])
def test_a_forked_child_goes_on_with_a_simulation_of_its_parent(scene, alone, tmp_path, threads):
    simulation = scene.simulation(threads=threads)
    simulation.step(10)
    simulation.save(tmp_path / "ten")

    def on():
        simulation.step(10)
        return bits(simulation)

    def resumed():
        simulation.resume(tmp_path / "ten")
        return on()

    assert forked(on) == alone and forked(resumed) == alone and on() == alone


@forks
def test_a_forked_child_runs_in_a_folder(scene, tmp_path):
    whole = im.run(scene, tmp_path / "parent", threads=2, pictures=False).measures
    assert forked(lambda: im.run(scene, tmp_path / "child", threads=2).measures) == whole


@forks
def test_pools_of_forked_processes_work(alone):
    stepped(2)
    context = multiprocessing.get_context("fork")
    with ProcessPoolExecutor(2, mp_context=context) as pool:
        assert [*pool.map(stepped, [1, 2, 1], timeout=PATIENCE)] == [alone] * 3


@forks
def test_a_simulation_that_was_forked_within_a_step_is_refused(scene, alone):
    simulation = scene.changed({"end": "1000 s"}).simulation(threads=2)
    stop = threading.Event()

    def step():
        while not stop.is_set():
            simulation.step(1000)

    stepping = threading.Thread(target=step)
    stepping.start()
    try:
        # Between two pieces of its work it is free: then the child goes on with it.
        said = [forked(lambda: simulation.steps >= 0) for _ in range(5)]
        # One of its own it makes at any time.
        assert forked(lambda: stepped(2)) == alone
    finally:
        stop.set()
        stepping.join()
    assert all(s is True or 'set_start_method("spawn")' in s for s in said) and any(s is not True for s in said)
    assert simulation.step() == 1


def test_scenes_and_results_are_pickled_and_copied(scene, tmp_path, tree):
    changed = im.Scene(tree, folder=tmp_path).changed({"parameters.speed": "3 m/s"})
    for same in (pickle.loads(pickle.dumps(changed)), copy.copy(changed), copy.deepcopy([changed])[0]):
        assert (same.text, same.parameters, repr(same)) == (changed.text, changed.parameters, repr(changed))
    # With the name that errors show.
    copied = pickle.loads(pickle.dumps(changed))
    assert pickle.dumps(copied) == pickle.dumps(changed)
    result = im.run(scene, tmp_path / "out", pictures=False, report=False)
    assert pickle.loads(pickle.dumps(result)) == result
    with pytest.raises(im.SceneError) as caught:
        scene.changed({"bodies.disc.material": "rubbr"}).simulation()
    sent = pickle.loads(pickle.dumps(caught.value))
    assert (type(sent), str(sent), sent.key, sent.line) == (im.SceneError, str(caught.value), caught.value.key, caught.value.line)


def test_simulations_are_not_pickled(scene):
    simulation = scene.simulation(threads=1)
    for shared in (simulation, simulation.bodies["disc"]):
        for attempt in (pickle.dumps, copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match=r"cannot be pickled or copied; .*simulation.save\(path\)"):
                attempt(shared)


HOW = {"pictures": False, "report": False, "progress": False}


def test_a_sweep_runs_only_what_is_not_done(scene, tmp_path, monkeypatch):
    started = []
    perform = im._sweep._Run.job
    monkeypatch.setattr(im._sweep._Run, "job", lambda run, threads: started.append(run.place) or perform(run, threads))
    out, key = tmp_path / "sweep", "parameters.speed"
    one, two, three = "1 m/s", "200 cm/s", "3 m/s"
    first = im.sweep(scene, {key: [one, two]}, out, processes=2, **HOW)
    assert sorted(started) == [1, 2]
    again = im.sweep(scene, {key: [one, two]}, out, **HOW)
    assert sorted(started) == [1, 2] and again == first
    more = im.sweep(scene, {key: [three, two, one, two]}, out, processes=0, **HOW)
    assert started[2:] == [1] and [*more[1:3]] == first[::-1] and more[3].result == more[1].result
    assert more[0].result.folder == out / "003"
    im.sweep(scene.changed({"end": "1 ms"}), {key: [one]}, out, **HOW)
    im.sweep(scene, {key: [one]}, out, fresh=True, **HOW)
    assert len(started) == 5
    # Files that a scene names belong to it.
    named = out / "named"
    (named.parent / "shape.stl").write_text("1")
    shaped = im.Scene.from_toml('title = "shape.stl"\n' + scene.text.partition("\n")[2], folder=out)
    before = im._sweep._fingerprint(shaped)
    (named.parent / "shape.stl").write_text("2")
    assert im._sweep._fingerprint(shaped) != before


def test_a_point_that_fails_is_a_row(scene, tmp_path, monkeypatch):
    over = {"time_step": [{"fixed": "80 us"}, {"factor": 0.5}]}
    points = im.sweep(scene.changed({"end": "4 ms"}), over, tmp_path, processes=2, **HOW)
    assert points[0].result is None and "step " in points[0].error and points[1].error is None
    bad, good = points.rows()
    assert bad["error"] == points[0].error and bad["height"] is None and bad["time_step"] == {"fixed": "80 us"}
    assert good["error"] is None and good["height"] == points[1].result.measures["height"] and good["met"] is True
    table = (tmp_path / "sweep.csv").read_text().splitlines()
    assert table[0].startswith("time_step,height [m],") and any("body `disc`" in line for line in table[1:])
    # A process that ends without a word is a row, too.
    monkeypatch.setattr(im._sweep, "PROGRAM", "import os; print('a last word', file=__import__('sys').stderr); os._exit(9)")
    (lost,) = im.sweep(scene, {"parameters.speed": ["1 m/s"]}, tmp_path / "lost", **HOW)
    assert "exit code 9" in lost.error and "a last word" in lost.error


def test_a_sweep_is_a_table_of_pandas(scene, tmp_path, monkeypatch):
    points = im.sweep(scene, {"parameters.speed": ["1 m/s", "2 m/s"]}, tmp_path, processes=2, **HOW)
    assert (tmp_path / "sweep.png").read_bytes().startswith(b"\x89PNG")
    assert pickle.loads(pickle.dumps(points)) == points and pickle.loads(pickle.dumps(points)).folder == tmp_path
    history = points[0].result.history()
    assert [*history] == ["time", "height", "velocity", "mass"] and history["time"][-1] == scene.end
    assert history["height"][-1] == points[0].result.measures["height"] and len(history["time"]) > 100
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "pandas", None)
        for table in (points.to_dataframe, points.histories, points[0].result.to_dataframe):
            with pytest.raises(ImportError, match="pip install pandas"):
                table()
        assert points._repr_html_() is None
    pytest.importorskip("pandas")
    table = points.to_dataframe()
    # In SI units.
    assert (
        [*table["parameters.speed"]] == [1.0, 2.0]
        and points[0].values == {"parameters.speed": "1 m/s"}
        and table["height"][1] == points[1].result.measures["height"]
    )
    assert [*table.columns][:4] == ["parameters.speed", "height", "velocity", "mass"]
    histories = points.histories()
    assert [*histories.columns] == ["point", "parameters.speed", "time", "height", "velocity", "mass"]
    assert len(histories) == sum(len(p.result.history()["time"]) for p in points) and "<table" in points._repr_html_()


def test_ctrl_c_stops_a_sweep_which_goes_on_later(scene, tmp_path):
    endless = scene.changed({"end": "1000 s"})
    seen, begun = [], time.time_ns()
    histories = [tmp_path / name / "measures.csv" for name in ("001", "002")]

    def stop(progress):
        seen.append(progress)
        # Both make steps.
        if all(path.exists() and path.stat().st_mtime_ns > begun for path in histories):
            raise KeyboardInterrupt

    how = {**HOW, "progress": stop, "processes": 2}
    checkpoints = [path.with_name("run.checkpoint") for path in histories]
    written = [0, 0]
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            im.sweep(endless, {"parameters.speed": ["1 m/s", "2 m/s", "3 m/s"]}, tmp_path, **how)
        assert time.time_ns() - begun < 1e9 * PATIENCE
        assert (seen[-1].points, seen[-1].running, seen[-1].done, seen[-1].failed) == (3, 2, 0, 0)
        before, written = written, [path.stat().st_mtime_ns for path in checkpoints]
        assert all(new > old for new, old in zip(written, before)) and not (tmp_path / "003").exists()
        begun = time.time_ns()
    # The second call went on from the checkpoints of the first one.
    table = [path.read_text().splitlines() for path in histories]
    assert all(line.startswith(("time", "0,")) or float(line.split(",")[0]) > 0 for lines in table for line in lines)
    assert "stopped before" in (tmp_path / "sweep.csv").read_text()


def test_values_that_are_no_list_are_refused(scene, tmp_path):
    for over, words in [("1 m/s", "must be a list"), ([], "has no values")]:
        with pytest.raises((TypeError, ValueError), match=f"over: `parameters.speed`.*{words}"):
            im.sweep(scene, {"parameters.speed": over}, tmp_path)
    with pytest.raises(ValueError, match="processes = -1"):
        im.sweep(scene, {"parameters.speed": ["1 m/s"]}, tmp_path, processes=-1)


def test_a_script_without_a_guard_sweeps(file, tmp_path):
    # Where it is started it would find a module of this name.
    (tmp_path / "pickle.py").write_text("raise SystemExit('the wrong one')\n")
    script = tmp_path / "scripts" / "script.py"
    script.parent.mkdir()
    script.write_text(
        textwrap.dedent(
            """
            import impactite as im
            points = im.sweep("disc.toml", {"parameters.speed": ["1 m/s", "2 m/s"]}, "out", set={"end": "0.1 ms"}, pictures=False, progress=True)
            print([point.error for point in points])
            """
        )
    )
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
    assert (done.returncode, done.stdout) == (0, "[None, None]\n"), done.stderr


def test_progress_is_shown(scene, tmp_path, capsys):
    seen = []
    longer = scene.changed({"end": "1000 s"})

    def stop(progress):
        seen.append(progress)
        if len(seen) == 3:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        longer.run(tmp_path / "out", pictures=False, progress=stop)
    assert (tmp_path / "out" / "run.checkpoint").exists()
    assert 0 <= seen[0].steps < seen[2].steps and 0 < seen[2].fraction < 1 and seen[2].end == 1000 and seen[2].seconds > 0
    assert "step" in str(seen[2]) and capsys.readouterr().err == ""
    # The end is a progress, too.
    seen.clear()
    result = scene.run(tmp_path / "short", pictures=False, report=False, progress=seen.append)
    assert (seen[-1].time, seen[-1].fraction, seen[-1].steps) == (scene.end, 1.0, result.steps)
    with pytest.raises(TypeError, match="progress = 3"):
        im.run(scene, tmp_path / "out", progress=3)


class Screen:
    """A terminal."""

    def __init__(self):
        self.text = ""

    def isatty(self):
        return True

    def write(self, text):
        self.text += text

    def flush(self):
        pass


def test_a_line_is_drawn_in_a_terminal(scene, tmp_path, monkeypatch):
    longer = scene.changed({"end": "1000 s"})
    for progress in (None, False):
        monkeypatch.setattr(sys, "stderr", Screen())
        interrupt_soon(1.2)
        with pytest.raises(KeyboardInterrupt):
            im.run(longer, tmp_path, pictures=False, report=False, progress=progress)
        text = sys.stderr.text
        assert (text == "") if progress is False else (text.startswith("\rDisc on a floor:   0 %  t = ") and text.endswith("\n"))


@pytest.mark.parametrize("way", ["simulation", "run"])
def test_ctrl_c_in_set_up_is_obeyed_at_once(tree, tmp_path, way):
    # Three million points: seconds of set-up.
    tree["method"]["mpm"]["cell"] = "0.04 mm"
    tree["bodies"]["disc"]["shape"]["ball"]["radius"] = "20 mm"
    scene = im.Scene(tree)
    # With threads that stay.
    stepped(1)
    before = threads()
    interrupt_soon()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        scene.simulation(threads=1) if way == "simulation" else im.run(scene, tmp_path / "out", threads=1)
    assert time.monotonic() - start < 1.5
    # The thread that was abandoned writes nothing later, either.
    end = time.monotonic() + PATIENCE
    while threads() > before and time.monotonic() < end:
        time.sleep(0.1)
    assert not (tmp_path / "out").exists()


def threads():
    """Number of threads of this process, where the system lists them."""
    return len([*Path("/proc/self/task").glob("*")])


def test_warnings_of_a_run_are_warnings(scene, tmp_path, monkeypatch):
    # It is torn, and contact takes more than half of its energy.
    fast = scene.changed({"parameters.speed": "60 m/s", "only_warn": True})
    with pytest.warns(im.RunWarning, match="^Disc on a floor: after step ") as caught:
        result = im.run(fast, tmp_path, pictures=False, report=False)
    assert [str(w.message) for w in caught] == [f"{result.title}: {text}" for text in result.warnings] and caught[0].filename == __file__
    with pytest.raises(im.RunError) as stopped:
        im.run(fast.changed({"time_step": {"fixed": "24 us"}}), tmp_path, pictures=False, report=False)
    assert stopped.value.warnings == []
    # Those before a run broke, too.
    stopped.value.warnings = ["it will break"]
    monkeypatch.setattr(im._runs._impactite, "run", lambda *_: (_ for _ in ()).throw(stopped.value))
    with pytest.warns(im.RunWarning, match="floor: it will break"), pytest.raises(im.RunError):
        im.run(fast, tmp_path)


def test_names_are_those_that_are_public():
    assert [name for name in dir(im) if not name.startswith("__")] == sorted(n for n in im.__all__ if not n.startswith("__"))
    assert all(getattr(im, name).__module__ in ("impactite", "builtins") for name in im.__all__ if isinstance(getattr(im, name), type))
