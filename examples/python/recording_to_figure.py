#!/usr/bin/env python3
"""Draws the device wrench, and the height of the soil at the end: recording_to_figure.py RUN.h5 FIGURE.png

Make a recording with: haptolith run icra2021 --motion scoop --no-realtime --duration-s 8 --record run.h5"""

import sys
from pathlib import Path

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from haptolith.recording import Recording

if len(sys.argv) != 3:
    sys.exit(__doc__)
file, picture = Path(sys.argv[1]), Path(sys.argv[2])
if picture.exists():
    sys.exit(f"{picture} is there already: name another file")

with Recording(file) as recording:
    ticks, title = recording.ticks, recording.header["title"]
    _, grains = recording.frame(-1)

figure, (force, soil) = plt.subplots(2, figsize=(7, 6), layout="constrained")
for axis, name in enumerate(("to the right", "away", "upwards")):
    force.plot(ticks["time_s"], ticks["device_wrench"]["force_n"][:, axis], linewidth=1, label=name)
force.set(xlabel="time / s", ylabel="force at the device / N", title=title)
force.legend()

# Central slab of the box, front view.
slab = grains[np.abs(grains[:, 1]) < 0.02]
soil.scatter(1e3 * slab[:, 0], 1e3 * slab[:, 2], s=60, color="tab:brown", edgecolors="white", linewidths=0.5)
soil.set(xlabel="x / mm", ylabel="height / mm", title="centres of the grains in the middle 40 mm, at the end")
soil.set_aspect("equal")
figure.savefig(picture, dpi=150)
print(f"{len(ticks)} ticks, {np.abs(ticks['device_wrench']['force_n']).max():.1f} N at most")
