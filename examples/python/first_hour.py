#!/usr/bin/env python3
"""Presses a shovel 30 mm into dry sand on Mars."""

import haptolith as hp

with hp.Scene("icra2021", soil__name="dry-sand", bed__start="settled", bed__depth_mm=50, gravity__body="Mars") as scene:
    surface_m = scene.info.surface_m
    for tick in range(400):
        felt = scene.step([0, 0, surface_m + 0.01 - 1e-4 * tick])  # 40 mm in 0.4 s
    print(f"{felt.force_n[2]:.1f} N upwards, 30 mm deep")
