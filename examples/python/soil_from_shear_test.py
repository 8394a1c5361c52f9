#!/usr/bin/env python3
"""Calibrates particles to the shear test of a soil, and digs in it: soil_from_shear_test.py [specimens]

Takes several minutes with 5 specimens for verification; the minimum is 2."""

import sys
from pathlib import Path

import haptolith as hp

file = Path("my-soil.toml")
if file.exists():
    sys.exit(f"{file} is there already: work in another folder")

specimens = int(sys.argv[1]) if len(sys.argv) > 1 else 5
soil, reached = hp.calibrate(friction_angle_deg=38, cohesion_pa=200, bulk_density_kg_m3=1600, specimens=specimens,
                             name="my-soil", progress=lambda what, share: print(f"\r{what}: {100 * share:3.0f} %  ", end=""))
print(f"\nasked for 38 degrees and 200 Pa; {reached['seeds']} specimens show "
      f"{reached['friction_angle_deg']:.1f} +- {reached['friction_angle_sd_deg']:.1f} degrees and "
      f"{reached['cohesion_pa']:.0f} +- {reached['cohesion_sd_pa']:.0f} Pa")
file.write_text(soil.toml, encoding="utf-8")
with hp.Scene("icra2021", soil__file=str(file), bed__start="settled", bed__depth_mm=40) as scene:
    print(scene)
