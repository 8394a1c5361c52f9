#!/usr/bin/env python3
"""Overhead of a step through Python over that in C: medians of interleaved rounds, in microseconds."""

import statistics
import time

import numpy as np

import haptolith as hp

SCENE = "[bed]\nparticles = 16\nlayers = 1\n"  # asleep without tool contact: almost only the call
STEPS = 20_000
pose = np.array([0, 0, 0.3, 1, 0, 0, 0], dtype=np.float64)
poses = np.tile(pose, (STEPS, 1))
ways = {"steps (in C)": [], "step(ndarray)": [], "step(list of 3)": []}
with hp.Scene.from_toml(SCENE) as scene:
    for _ in range(15):
        for way, do in (("steps (in C)", lambda: scene.steps(poses)),
                        ("step(ndarray)", lambda: [scene.step(pose) for _ in range(STEPS)]),
                        ("step(list of 3)", lambda: [scene.step([0, 0, 0.3]) for _ in range(STEPS)])):
            begin = time.perf_counter()
            do()
            ways[way].append((time.perf_counter() - begin) / STEPS * 1e6)
in_c = statistics.median(ways["steps (in C)"])
for way, took in ways.items():
    print(f"{way:16} {statistics.median(took):6.3f} us  {statistics.median(took) - in_c:+.3f} us")
