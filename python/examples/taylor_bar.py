"""A copper bar hits a wall: a scene in a dict, run step by step, and drawn.

The cells (# %%) are those of editors that know them; as a program, `python taylor_bar.py`, it writes two pictures where it is run.
"""

# %% [markdown]
# # The Taylor bar
#
# A cylinder of copper, 7.6 mm by 25.4 mm, hits a rigid wall without friction at 190 m/s. Its foot spreads until the plastic work has
# taken the kinetic energy, some 80 microseconds later; how short it is then tells how strong copper is at such rates.

# %%
import matplotlib
import numpy as np

import impactite as im

matplotlib.use("Agg")  # into files; a notebook does without this line
import matplotlib.pyplot as plt
from matplotlib.tri import Triangulation

# %% [markdown]
# ## The scene
#
# A dict has the keys of scene files. Quantities are numbers in SI units, or texts with units and the names of parameters. Around an axis
# the coordinates are (r, z), and one section says all of the bar.

# %%
scene = im.Scene(
    {
        "title": "Taylor bar",
        "space": "axisymmetric",
        "end": "80 us",
        "parameters": {"radius": "3.8 mm", "length": "25.4 mm", "speed": "190 m/s", "cells": 12},
        "method": {"mpm": {"cell": "radius / cells", "for": "impact"}},
        # Constants fitted to such bars: no rate, no heat.
        "materials": {"copper": {"library": "copper_taylor", "bulk_viscosity": [0.06, 1.5]}},
        "bodies": {
            "bar": {
                "material": "copper",
                "shape": {"box": {"from": [0, 0], "to": ["radius", "length"]}},
                "velocity": [0, "-speed"],
            }
        },
        "conditions": [{"symmetry": {"axis": "r", "at": 0}}, {"wall": {"axis": "z", "at": 0}}],
        "measures": {
            "length": {"extent": {"body": "bar", "axis": "z"}},
            "foot_radius": {"extent": {"body": "bar", "axis": "r"}},
        },
    }
)
start = {name: scene.parameters[name] for name in ("radius", "length")}
print(scene)

# %% [markdown]
# A scene is set up on threads, which change no bit of what comes.

# %%
simulation = scene.simulation(threads=2)
bar = simulation.bodies["bar"]
print(f"{simulation.method}; {bar.law}, {len(bar)} points, {2e3 * np.pi * bar.mass:.2f} g")

# %% [markdown]
# ## The run
#
# `step` says how many steps it made, 0 at the end. In between everything may be looked at. Arrays stay as they are when the simulation
# goes on, so that moments are kept by keeping them.

# %%
history, moments = [], []
due = [10e-6, 20e-6, 40e-6, scene.end]
while True:
    energy, measures = simulation.energy(), simulation.measures()
    history.append((simulation.time, energy["kinetic"], energy["internal"], energy["error"], measures["length"]))
    # The first look at or after its time: no step is shortened for a picture.
    if simulation.time >= due[len(moments)]:
        moments.append((simulation.time, bar.positions, bar.widths, bar.state["plastic_strain"]))
    if not simulation.step(10):
        break
time, kinetic, internal, error, length = np.array(history).T
# Per radian so far: of the whole bar 2 pi as much.
kinetic, internal = 2 * np.pi * kinetic, 2 * np.pi * internal
print(f"{simulation.steps} steps, {len(history)} looks; energy within {100 * np.abs(error).max():.2f} %")

# %% [markdown]
# ## Beside the reference
#
# Independent finite elements with the same law ([C] in the book, "The Taylor bar"): length 16.28 mm, foot 13.37 mm.

# %%
reference = {"length": 16.28e-3, "foot": 13.37e-3}
found = {"length": measures["length"], "foot": 2 * measures["foot_radius"]}
print("             here    elements")
for name, value in found.items():
    print(f"{name:8} {1e3 * value:6.2f} mm  {1e3 * reference[name]:6.2f} mm  {100 * (value / reference[name] - 1):+.1f} %")

# %% [markdown]
# ## Pictures
#
# Fields are drawn on triangles between neighbouring points, on both sides of the axis.

# %%
plt.rcParams.update(
    {
        "font.size": 9,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.edgecolor": "0.35",
        "axes.titlesize": 10,
        "figure.dpi": 150,
    }
)
WALL, BLUE, RED, GREY = "0.82", "#20639b", "#c8452f", "0.55"


def triangles(positions, widths):
    """The points and their mirror images, mm, and triangles between those that are close."""
    r, z = 1e3 * positions[:, 0], 1e3 * positions[:, 1]
    net = Triangulation(np.concatenate([r, -r]), np.concatenate([z, z]))
    corners = np.stack([net.x, net.y], axis=1)[net.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    net.set_mask(longest > 4e3 * np.tile(widths, 2)[net.triangles].mean(axis=1))
    return net


figure, axes = plt.subplots(1, len(moments), figsize=(9.5, 4.6), sharex=True, sharey=True, layout="constrained")
for axis, (moment, positions, widths, strain) in zip(axes, moments):
    net = triangles(positions, widths)
    drawn = axis.tripcolor(net, np.tile(strain, 2), shading="gouraud", cmap="viridis", clim=(0, 2))
    axis.axhspan(-1.2, 0, color=WALL, lw=0)
    # Where the bar was.
    r, z = 1e3 * start["radius"], 1e3 * start["length"]
    axis.plot([-r, -r, r, r], [0, z, z, 0], color=GREY, lw=0.8, ls=(0, (4, 3)), zorder=0)
    axis.set(title=f"{1e6 * moment:.0f} µs", aspect="equal", xlim=(-7.6, 7.6), ylim=(-1.2, 26.5), xlabel="r, mm")
axes[0].set_ylabel("height over the wall, mm")
figure.colorbar(drawn, ax=axes, label="equivalent plastic strain", extend="max", shrink=0.8, aspect=30)
figure.suptitle("A copper bar at 190 m/s on a rigid wall", fontsize=11)
figure.savefig("taylor_bar.png")

# %% [markdown]
# The outline is the outermost point at every height. The energy that the method loses is the step of the line at the top, at first contact.

# %%
_, positions, widths, _ = moments[-1]
levels = np.linspace(0, measures["length"], 49)
row = np.clip(np.digitize(positions[:, 1], levels) - 1, 0, len(levels) - 2)
radius = np.zeros(len(levels) - 1)
np.maximum.at(radius, row, positions[:, 0] + widths / 2)
# Up the right side, across the end, and down the left side.
height = np.concatenate([[0], (levels[1:] + levels[:-1]) / 2, [measures["length"]]])
radius = np.concatenate([radius[:1], radius, radius[-1:]])
outline = 1e3 * np.array([np.concatenate([radius, -radius[::-1]]), np.concatenate([height, height[::-1]])])

figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.9), layout="constrained", width_ratios=[1, 1.25])
left.axhspan(-1.2, 0, color=WALL, lw=0, zorder=0)
left.fill(*outline, color=BLUE, alpha=0.15, lw=0)
left.plot(*outline, color=BLUE, lw=1.5)
foot, end = 1e3 * reference["foot"] / 2, 1e3 * reference["length"]
left.plot([-foot, foot, 0], [0, 0, end], ls="none", marker="o", mfc="white", color=RED, clip_on=False, zorder=3)
left.text(0, 8, "material points", color=BLUE, ha="center")
left.annotate(
    "finite elements",
    (0, end),
    (4.6, end + 0.9),
    color=RED,
    va="center",
    arrowprops={"arrowstyle": "-", "color": RED, "shrinkB": 5},
)
left.set(
    title="the bar after 80 µs",
    xlabel="r, mm",
    ylabel="height over the wall, mm",
    aspect="equal",
    xlim=(-9.5, 9.5),
    ylim=(-1.2, 18),
)
left.set(xticks=range(-8, 9, 4), yticks=range(0, 17, 4))

at = 1e6 * time
right.stackplot(at, internal, kinetic, colors=[RED, BLUE], alpha=0.2, lw=0)
right.plot(at, kinetic + internal, color="0.2", lw=1.5)
right.plot(at, internal, color=RED, lw=1.2)
right.text(12, 0.72 * kinetic[0], "kinetic", color=BLUE)
right.text(45, 0.35 * kinetic[0], "internal: plastic work and elastic energy", color=RED, ha="center")
right.text(79, 1.02 * kinetic[0], "sum", color="0.2", ha="right")
right.set(title="energy of the bar", xlabel="time, µs", ylabel="energy, J", xlim=(0, 1e6 * scene.end), ylim=(0, 1.1 * kinetic[0]))
figure.savefig("taylor_bar_outline_energy.png")

# %% [markdown]
# ## The same in a folder
#
# `im.run(scene, out="out/taylor_bar")` runs it whole, with pictures, histories, files for ParaView and a page; and for other speeds
# `im.sweep(scene, {"parameters.speed": ["150 m/s", "190 m/s"]}, out="out/speeds")`.
