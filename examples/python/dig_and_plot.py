#!/usr/bin/env python3
"""Presses a shovel into three soils and draws the force against depth: dig_and_plot.py [FILE.png]"""

import sys
from pathlib import Path

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import haptolith as hp

picture = Path(sys.argv[1] if len(sys.argv) > 1 else "dig.png")
if picture.exists():
    sys.exit(f"{picture} is there already: name another file")

settled = {"bed__start": "settled", "bed__depth_mm": 40}  # settled at random, not a crystal
figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for name, keys in {
    "P3, ICRA 2021": {"soil__preset": "P3"},
    "lunar-0-15cm": {"soil__name": "lunar-0-15cm", **settled},
    "dry-sand": {"soil__name": "dry-sand", **settled},
}.items():
    with hp.Scene("icra2021", **keys) as scene:
        surface_m = scene.info.surface_m
        depths_m = np.linspace(-0.01, 0.03, 800)  # 40 mm at 0.05 m/s
        poses = np.zeros((len(depths_m), 7))
        poses[:, 2] = surface_m - depths_m
        poses[:, 3] = 1
        scene.place_tool(poses[0])
        felt = scene.steps(poses)
        axes.plot(1e3 * depths_m, felt[:, 2], label=name)
        print(f"{name:16} {felt[-1, 2]:7.2f} N at {1e3 * depths_m[-1]:.0f} mm")
axes.set(xlabel="depth of the shovel / mm", ylabel="force upwards / N", title="A shovel pressed flat into soil on the Moon")
axes.legend()
figure.savefig(picture, dpi=150)
