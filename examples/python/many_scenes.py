#!/usr/bin/env python3
"""Runs 64 scenes in parallel on all threads, each dug at a different place, and prints the effect of the place."""

import time

import numpy as np

import haptolith as hp

first = hp.Scene("icra2021")
scenes = [first] + [first.clone() for _ in range(63)]  # equal soil, made once
surface_m = first.info.surface_m

ticks = 400
random = np.random.default_rng(1)
poses = np.zeros((len(scenes), ticks, 7))
poses[:, :, :2] = random.uniform(-0.03, 0.03, (len(scenes), 1, 2))
poses[:, :, 2] = surface_m + np.linspace(0.01, -0.02, ticks)
poses[:, :, 3] = 1
for scene, path in zip(scenes, poses):
    scene.place_tool(path[0])

with hp.Batch(scenes) as batch:
    begin = time.perf_counter()
    felt = batch.step(poses)
    took_s = time.perf_counter() - begin
force_n = felt[:, -1, 2]
print(f"{len(scenes)} scenes, {ticks} ticks each, in {took_s:.2f} s: {len(scenes) * ticks / took_s / 1e3:.0f} thousand ticks a second")
print(f"20 mm deep the shovel feels {force_n.mean():.1f} +- {force_n.std():.1f} N")
