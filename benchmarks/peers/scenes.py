"""Scenes of the programs beside this file, and what they print: plain numpy, no package of a peer.

Each is a scene of ours, told again: two blocks (`benchmarks/benches/results/scenes.rs`), the cube S1
(`examples/src/throughput.rs`), and V3 in the plane (`tests/verification/src/problems/axis_aligned.rs`).
"""
import argparse
import json
import math
import time

import numpy as np


class Elastic:
    """Elastic particles in a box of nodes of spacing 1, for throughput. Eight particles a cell, density 1."""

    def __init__(self, positions, velocities, nodes, dt, moduli):
        self.positions, self.velocities, self.nodes, self.dt = positions, velocities, nodes, dt
        self.lame, self.shear = moduli

    def __len__(self):
        return len(self.positions)


def block(low, cells):
    """Particles of a block of so many cells along x, y, z, x fastest."""
    k, j, i = np.meshgrid(*(np.arange(2 * n) for n in reversed(cells)), indexing="ij")
    return np.stack([(a.ravel() + 0.5) * 0.5 + at for a, at in zip((i, j, k), low)], 1)


def blocks():
    """Two blocks of 25 x 25 x 20 cells, head-on: E = 100, nu = 0.3, v = +-0.3 along z, dt = 0.3 h/c."""
    young, poisson = 100.0, 0.3
    lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    shear = young / 2 / (1 + poisson)
    halves = [block((3, 3, z), (25, 25, 20)) for z in (3.5, 24.5)]
    v = np.zeros((2 * len(halves[0]), 3))
    v[: len(halves[0]), 2], v[len(halves[0]) :, 2] = 0.3, -0.3
    return Elastic(np.concatenate(halves), v, (34, 34, 50), 0.3 / math.sqrt(lame + 2 * shear), (lame, shear))


# Steps after which the cube starts anew: it moves by less than two cells, so that a dense box of nodes need not be
# much larger than it.
CUBE_STEPS = 100


def cube(particles):
    """A cube of about so many particles in a smooth field of velocity: lambda = 1, G = 0.8, dt = 0.19."""
    cells = max(1, round((particles / 8) ** (1 / 3)))
    low = 3
    x = block((low,) * 3, (cells,) * 3)
    # Ours has its corner at 8.
    wave = 0.1 * (0.4 + 0.6 * np.sin((x + 8 - low) * 6.0 / cells))
    return Elastic(x, np.roll(wave, -1, axis=1), (cells + 10,) * 3, 0.19, (1.0, 0.8))


def throughput_options(threads):
    """What the programs of throughput are asked; `threads`: can there be more than one?"""
    parser = argparse.ArgumentParser()
    parser.add_argument("scheme", choices=["musl", "mls"])
    parser.add_argument("--precision", choices=["f32", "f64"], default="f64")
    parser.add_argument("--threads", type=int, choices=None if threads else [1], default=1)
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--cube", type=int, metavar="N", help="the cube of about N particles instead of two blocks")
    options = parser.parse_args()
    options.scene = blocks() if options.cube is None else cube(options.cube)
    return options


def measure(options, program, start, step, wait, memory, speeds):
    """Time the steps of a scene, as often as asked, and print one line. Before each run one step is not timed."""
    most = options.steps if options.cube is None else CUBE_STEPS
    start()
    step()
    wait()
    rates = []
    for _ in range(options.repeat):
        seconds, left = 0.0, options.steps
        while left > 0:
            start()
            step()
            wait()
            clock = time.perf_counter()
            for _ in range(min(left, most)):
                step()
            wait()
            seconds += time.perf_counter() - clock
            left -= most
        rates.append(len(options.scene) * options.steps / seconds)
    print(json.dumps({
        "program": program,
        "scheme": options.scheme,
        "particles": len(options.scene),
        "threads": options.threads,
        "steps": options.steps,
        "particle_updates_per_second": rates,
        "total_bytes_per_particle": memory / len(options.scene),
        "kinetic_energy": 0.5 * 0.125 * float((speeds().astype(float) ** 2).sum()),
    }))


class Axes:
    """V3 in the plane: a unit square that pulsates with strains of 31 %; manufactured, exact, E = rho = 1."""

    AMPLITUDE, K, OMEGA = 0.05, 2 * math.pi, math.pi
    PHASES = (0.0, math.pi)
    LAME, SHEAR = 0.3 / (1.3 * 0.4), 1 / 2.6
    # Layers of nodes around the square.
    PAD = 2

    def __init__(self, case):
        self.case = case
        _, per_axis, cells, courant = case
        self.h = 1.0 / cells
        self.steps = math.ceil(cells / courant)
        self.dt = 1.0 / self.steps
        self.every = max(1, self.steps // 20)
        self.nodes = cells + 1 + 2 * self.PAD
        at = (np.arange(cells * per_axis) + 0.5) / per_axis * self.h
        y, x = np.meshgrid(at, at, indexing="ij")
        self.starts = np.stack([x.ravel(), y.ravel()], 1)
        self.mass = (self.h / per_axis) ** 2
        # Velocities belong to half a step before the positions.
        self.velocities = self.motion(-0.5 * self.dt)[1]
        self.errors = {"u": 0.0, "u largest": 0.0, "v": 0.0, "stress": 0.0}
        self.failure = None

    def __len__(self):
        return len(self.starts)

    def motion(self, t):
        """Displacement, velocity and stretch along the axes."""
        phase = self.OMEGA * t + np.array(self.PHASES)
        sin = np.sin(self.K * self.starts)
        return (
            self.AMPLITUDE * sin * np.sin(phase),
            self.AMPLITUDE * self.OMEGA * sin * np.cos(phase),
            1 + self.AMPLITUDE * self.K * np.cos(self.K * self.starts) * np.sin(phase),
        )

    def stretches(self):
        """Steps between looks, as numbers of the first and the one after the last."""
        return [(n, min(n + self.every, self.steps)) for n in range(0, self.steps, self.every)]

    def look(self, steps, x, v, deformation, lost):
        """Take the errors after so many steps. A run that lost particles, or in which one is turned inside out, has failed."""
        if lost > 0:
            self.failure = "a particle left the nodes"
            return
        j = np.linalg.det(deformation)
        if not (j > 0).all():
            self.failure = "a particle is inverted"
            return
        t = steps * self.dt
        u, _, stretch = self.motion(t)
        _, velocity, _ = self.motion(t - 0.5 * self.dt)
        exact = self.stress(stretch[:, 0] * stretch[:, 1], stretch**2)
        left = np.einsum("nij,nij->ni", deformation, deformation)
        found = self.stress(j, left)
        of_u = np.linalg.norm(x - self.starts - u, axis=1) / self.AMPLITUDE
        of_v = np.linalg.norm(v - velocity, axis=1) / (self.AMPLITUDE * self.OMEGA)
        of_s = np.linalg.norm(found - exact, axis=1) / (self.AMPLITUDE * self.K)
        now = {"u": rms(of_u), "u largest": float(of_u.max()), "v": rms(of_v), "stress": rms(of_s)}
        for name, error in now.items():
            self.errors[name] = float(np.maximum(self.errors[name], error))  # keeps what is not a number

    def stress(self, j, left):
        """Cauchy stress along the axes, of the volume ratio and the diagonal of F F^T."""
        return (self.LAME * np.log(j)[:, None] + self.SHEAR * (left - 1)) / j[:, None]


def rms(values):
    return math.sqrt(np.mean(values**2))


def run_axes(program, schemes):
    """Run the cases that are asked for, as `linear FLIP-MUSL/2/16/0.2`: scheme, particles a cell and axis, cells, Courant
    number. `schemes`: by name what sets a scene up. That returns what makes the steps from one number to another one,
    and what returns positions, velocities and deformation gradients. Prints a line a case."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--repeat", type=int, default=1, help="runs, the shortest time of which is kept")
    parser.add_argument("--brief", type=float, default=0.0, help="runs that last longer, s, are not repeated")
    parser.add_argument("case", nargs="+")
    options = parser.parse_args()
    warm = set()
    for text in options.case:
        scheme, per_axis, cells, courant = text.split("/")
        case = (scheme, int(per_axis), int(cells), float(courant))
        if scheme not in warm:
            warm.add(scheme)
            run_axes_once(Axes((scheme, 2, 4, 0.5)), schemes)
        seconds = math.inf
        for _ in range(options.repeat):
            scene = Axes(case)
            seconds = min(seconds, run_axes_once(scene, schemes))
            if seconds >= options.brief:
                break
        print(json.dumps({
            "program": program,
            "scheme": scheme,
            "per_axis": case[1],
            "cells": case[2],
            "courant": case[3],
            "particles": len(scene),
            "steps": scene.steps,
            "core_seconds": seconds,
            "failure": scene.failure,
            # What is not a number is no JSON.
            "errors": {name: error if math.isfinite(error) else None for name, error in scene.errors.items()},
        }), flush=True)


def run_axes_once(scene, schemes):
    """Processor seconds of the steps alone."""
    advance, state = schemes[scene.case[0]](scene)
    seconds = 0.0
    for first, end in scene.stretches():
        before = time.process_time()
        advance(first, end)
        seconds += time.process_time() - before
        scene.look(end, *state())
        if scene.failure:
            scene.steps = end
            break
    return seconds
