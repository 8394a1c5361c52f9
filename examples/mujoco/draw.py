#!/usr/bin/env python3
"""Draws the arm that digs, as a picture and a film: draw.py ARM.csv PICTURE.png [FILM.gif]

ARM.csv is what arm_digs writes. The soil is stepped again along the blade's path, so that its grains can be drawn, too."""

import sys
from pathlib import Path

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.patches import Ellipse

import haptolith as hp

SOIL_AT_M, SHOULDER_M, UPPER_M, FORE_M = 0.45, 0.25, 0.3, 0.25

for name in sys.argv[2:]:
    if Path(name).exists():
        sys.exit(f"{name} is there already: name another file")

run = np.genfromtxt(sys.argv[1], delimiter=",", names=True)


def elbow(x, z):
    """Position of the elbow (up) for a blade at (x, z)."""
    dz = z - SHOULDER_M
    inner = np.arccos(np.clip((x * x + dz * dz - UPPER_M**2 - FORE_M**2) / (2 * UPPER_M * FORE_M), -1, 1))
    lift = np.arctan2(dz, x) + np.arctan2(FORE_M * np.sin(inner), UPPER_M + FORE_M * np.cos(inner))
    return UPPER_M * np.cos(lift), SHOULDER_M + UPPER_M * np.sin(lift)


# Particles in the central 40 mm, at each line of the file.
grains = []
with hp.Scene("icra2021", soil__name="lunar-0-15cm", bed__start="settled", bed__depth_mm=40, tool__shape="box",
              tool__size_mm=[60, 50, 4]) as scene:
    radius_m, surface_m = scene.info.radius_m, scene.info.surface_m
    ticks = np.arange(0, run["t_s"][-1], 1e-3)
    path = np.tile([0, 0, 0, 1.0, 0, 0, 0], (len(ticks), 1))
    path[:, 0] = np.interp(ticks, run["t_s"], run["x_m"]) - SOIL_AT_M
    path[:, 2] = np.interp(ticks, run["t_s"], run["z_m"])
    scene.place_tool(path[0])
    for first in range(0, len(path), 10):
        places = scene.positions
        grains.append(places[np.abs(places[:, 1]) < 0.02][:, [0, 2]].copy())
        scene.steps(path[first:first + 10])


def draw(axes, line):
    """Draws the arm, the blade and the soil."""
    x, z = run["x_m"][line], run["z_m"][line]
    joint = elbow(x, z)
    for place in grains[min(line, len(grains) - 1)]:
        axes.add_patch(Ellipse((1e3 * (place[0] + SOIL_AT_M), 1e3 * place[1]), 2e3 * radius_m, 2e3 * radius_m, facecolor="#b9a88f",
                               edgecolor="white", linewidth=0.6))
    axes.plot([0, 1e3 * joint[0], 1e3 * x], [1e3 * SHOULDER_M, 1e3 * joint[1], 1e3 * z], "-o", color="#405878", linewidth=5)
    axes.plot([1e3 * x - 30, 1e3 * x + 30], [1e3 * z, 1e3 * z], color="#c03020", linewidth=3, solid_capstyle="butt")
    force = run["force_x_n"][line], run["force_z_n"][line]
    if np.hypot(*force) > 0.1:
        axes.annotate("", (1e3 * x + 4 * force[0], 1e3 * z + 4 * force[1]), (1e3 * x, 1e3 * z),
                      arrowprops={"arrowstyle": "->", "color": "#c03020", "linewidth": 1.5})
    axes.set(xlim=(-20, 560), ylim=(-5, 330), aspect="equal", xlabel="mm", title=f"{run['t_s'][line]:.1f} s")


figure = plt.figure(figsize=(10, 5), layout="constrained")
spaces = figure.add_gridspec(2, 3, height_ratios=[3, 2])
for column, time_s in enumerate((0.4, 1.6, 3.6)):
    draw(figure.add_subplot(spaces[0, column]), int(np.argmin(np.abs(run["t_s"] - time_s))))
force = figure.add_subplot(spaces[1, :])
force.plot(run["t_s"], run["force_x_n"], label="back")
force.plot(run["t_s"], run["force_z_n"], label="up")
force.set(xlabel="time / s", ylabel="soil on the blade / N")
force.legend()
figure.savefig(sys.argv[2], dpi=110)

if len(sys.argv) > 3:
    film, (arm, felt) = plt.subplots(2, figsize=(5.6, 5), height_ratios=[3, 1.4], layout="constrained")

    def frame(line):
        """Draws one frame of the animation."""
        arm.clear()
        draw(arm, line)
        felt.clear()
        felt.plot(run["t_s"][:line + 1], run["force_x_n"][:line + 1], run["t_s"][:line + 1], run["force_z_n"][:line + 1])
        felt.set(xlim=(0, run["t_s"][-1]), ylim=(-6, 18), xlabel="time / s", ylabel="N back, up")

    FuncAnimation(film, frame, range(0, len(run), 6), cache_frame_data=False).save(sys.argv[3], PillowWriter(fps=16), dpi=90)
