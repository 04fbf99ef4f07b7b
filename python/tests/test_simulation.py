"""Simulations step by step: bits, arrays, checkpoints, interruptions."""

import gc
import os
import signal
import threading
import time

import numpy as np
import pytest
from conftest import bits

import impactite as im


def test_steps_go_to_the_end_and_no_further(scene):
    simulation = scene.simulation(threads=1)
    assert (simulation.time, simulation.steps, simulation.dt, simulation.reached_end) == (0.0, 0, None, False)
    assert simulation.step() == 1 and simulation.dt == simulation.time > 0
    assert simulation.step(10) == 10 and simulation.steps == 11
    left = simulation.step(10**9)
    assert left > 0 and simulation.steps == 11 + left
    assert simulation.reached_end and simulation.time == scene.end
    assert simulation.step() == 0 and simulation.run() is None
    simulation.run_until(1.25 * scene.end)
    assert simulation.time == 1.25 * scene.end and simulation.step() == 0
    for t in (0.0, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="not before the time reached"):
            simulation.run_until(t)
    with pytest.raises(OverflowError):
        simulation.step(-1)


def test_bits_are_the_same_for_any_number_of_threads_and_any_looks(scene):
    whole = scene.simulation(threads=1)
    whole.run()
    looked = scene.simulation(threads=2)
    assert (whole.threads, looked.threads) == (1, 2)
    while looked.step(7):
        bits(looked)
    assert bits(whole) == bits(looked)
    with pytest.raises(ValueError, match="threads = 0 is not allowed; it must be 1 to 1024"):
        scene.simulation(threads=0)


def test_arrays_have_a_row_a_point_in_the_order_of_numbers(scene):
    simulation = scene.simulation(threads=1)
    simulation.step(100)
    (name, disc), n = *simulation.bodies.items(), len(simulation.bodies["disc"])
    assert name == disc.name == "disc" and disc.law and n > 50
    shapes = {"positions": (n, 3), "velocities": (n, 3), "stress": (n, 6)}
    for field in ("positions", "velocities", "stress", "masses", "volumes", "widths", "pressure", "von_mises"):
        array = getattr(disc, field)
        assert array.shape == shapes.get(field, (n,)) and array.dtype == np.float64 and array.flags.c_contiguous, field
        assert np.isfinite(array).all(), field
    assert disc.numbers.dtype == np.int64 and (disc.numbers == np.arange(n)).all()
    assert disc.failed.dtype == np.bool_ and not disc.failed.any()
    assert [*disc.state] == disc.state_names and all(column.shape == (n,) for column in disc.state.values())
    assert (disc.positions[:, 2] == 0).all() and (disc.velocities[:, 2] == 0).all()


def test_arrays_agree_with_sums_of_the_simulation(scene):
    simulation = scene.simulation(threads=1)
    simulation.step(100)
    disc = simulation.bodies["disc"]
    # Sums of a hundred points in another order.
    close = pytest.approx
    kinetic = 0.5 * (disc.masses * (disc.velocities**2).sum(axis=1)).sum()
    assert disc.masses.sum() == close(disc.mass, rel=1e-13)
    assert kinetic == close(disc.kinetic, rel=1e-13) and kinetic == close(simulation.energy()["kinetic"], rel=1e-13)
    momentum = disc.masses @ disc.velocities
    assert momentum[1] == close(disc.momentum[1], rel=1e-13)
    measures = simulation.measures()
    assert (disc.masses @ disc.positions[:, 1]) / disc.mass == close(measures["height"], rel=1e-13)
    xx, yy, zz, yz, xz, xy = disc.stress.T
    assert -(xx + yy + zz) / 3 == close(disc.pressure, rel=1e-13)
    # Differences of stresses cancel digits.
    square = ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (yz**2 + xz**2 + xy**2)
    assert np.sqrt(square) == close(disc.von_mises, rel=1e-9)
    energy = simulation.energy()
    assert energy["total"] == energy["kinetic"] + energy["internal"] and disc.internal == energy["internal"]


def test_arrays_are_gathered_once_a_state_and_fresh_after_a_step(scene):
    simulation = scene.simulation(threads=1)
    simulation.step(20)
    disc = simulation.bodies["disc"]
    before, copy = disc.positions, disc.positions.copy()
    assert disc.positions is before and np.shares_memory(simulation.bodies["disc"].positions, before)
    assert disc.stress is disc.stress
    simulation.step()
    after = disc.positions
    assert not np.shares_memory(before, after) and (before != after).any()
    assert (before == copy).all(), "an array stays as it was"


def test_arrays_cannot_be_written_to(scene):
    disc = scene.simulation(threads=1).bodies["disc"]
    for array in (disc.numbers, disc.positions, disc.masses, disc.failed, *disc.state.values()):
        assert not array.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.flags.writeable = True


def test_arrays_outlive_their_simulation(scene):
    simulation = scene.simulation(threads=1)
    disc = simulation.bodies["disc"]
    positions, copy = disc.positions, disc.positions.copy()
    del simulation, disc
    gc.collect()
    [np.full(positions.shape, np.nan) for _ in range(100)]
    assert (positions == copy).all()


def test_a_checkpoint_goes_on_bit_for_bit(scene, tmp_path):
    whole, part = scene.simulation(threads=1), scene.simulation(threads=2)
    whole.run()
    part.step(123)
    part.save(tmp_path / "half")
    saved = bits(part)
    part.run()
    resumed = scene.simulation(threads=1)
    old = resumed.bodies["disc"].positions
    resumed.resume(tmp_path / "half")
    assert bits(resumed) == saved and (resumed.bodies["disc"].positions != old).any()
    resumed.run()
    assert bits(whole) == bits(part) == bits(resumed)


def test_a_simulation_that_cannot_resume_is_not_used(scene, tmp_path):
    scene.simulation(threads=1).save(tmp_path / "here")
    other = scene.changed({"materials.rubber.neo_hookean.young": "2 MPa"}).simulation(threads=1)
    with pytest.raises(im.RunError, match="another scene"):
        other.resume(tmp_path / "here")
    with pytest.raises(im.RunError, match="half resumed"):
        other.step()
    with pytest.raises(im.RunError, match="none"):
        scene.simulation(threads=1).resume(tmp_path / "none")
    with pytest.raises(im.RunError, match="there"):
        scene.simulation(threads=1).save(tmp_path / "not" / "there")


def test_a_run_that_breaks_says_where(scene):
    # Steps far beyond the stable one.
    simulation = scene.changed({"time_step": {"fixed": "2 ms"}, "end": "1 s"}).simulation(threads=1)
    with pytest.raises(im.RunError) as caught:
        simulation.run()
    error = caught.value
    assert isinstance(error, RuntimeError)
    assert error.body == "disc" and error.step >= 1 and error.number >= 0 and len(error.position) == 3
    assert f"step {error.step} at t = " in str(error) and "body `disc`" in str(error)
    with pytest.raises(im.RunError):
        simulation.step()


@pytest.fixture
def endless(scene):
    """More steps than a test waits for."""
    return scene.changed({"end": "1000 s"})


def interrupt_soon(seconds=0.3):
    """Press Ctrl-C in a moment. The thread that does can only do so while the interpreter is free."""
    # Programs that a shell starts in the background ignore it, and hand that on.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)).start()


def test_ctrl_c_stops_between_steps_and_the_simulation_goes_on(endless):
    simulation = endless.simulation(threads=2)
    interrupt_soon()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        simulation.run()
    assert time.monotonic() - start < 30
    steps = simulation.steps
    assert steps > 0 and simulation.step(5) == 5 and simulation.steps == steps + 5
    undisturbed = endless.simulation(threads=1)
    undisturbed.step(steps + 5)
    assert bits(undisturbed) == bits(simulation)


def test_other_threads_look_while_it_steps(endless):
    simulation = endless.simulation(threads=1)
    seen = []

    def look():
        disc = simulation.bodies["disc"]
        while len(seen) < 3:
            seen.append((simulation.steps, disc.positions.copy()))
            time.sleep(0.1)
        os.kill(os.getpid(), signal.SIGINT)

    watcher = threading.Thread(target=look)
    watcher.start()
    with pytest.raises(KeyboardInterrupt):
        simulation.run()
    watcher.join()
    steps = [step for step, _ in seen]
    assert steps == sorted(set(steps)) and len(steps) == 3
