"""Soil that a hand, a robot or a learner can dig in: haptolith for Python.

    import haptolith as hp

    with hp.Scene("icra2021", soil__preset="P3") as scene:
        for tick in range(300):                              # down into the soil, at 0.1 m/s
            felt = scene.step([0, 0, 0.06 - 1e-4 * tick])    # one tick of 1 ms: what the soil does to the tool
        print(felt.force_n, scene.positions[:, 2].max())

SI units, right-handed frames, z up, quaternions w x y z; a pose is scene_T_tool. Parameters are the keys of scene
files, as keywords with two underscores: bed__threads=2 is [bed] threads = 2.
"""

from ._abi import library_version as _library_version
from .batch import Batch
from .errors import (Busy, Collapsed, Failure, HaptolithError, InvalidParameter, Stopped)
from .lab import lab_test, lab_tests, trust
from .loop import Device, DeviceInput, Limits, Loop, Snapshot, TickFlag, Trip
from .psychometrics import fit_psychometric
from .safety import Safety, SafetyInfo
from .scene import Scene, SceneInfo, scenes
from .soil import Soil, calibrate, presets, soils
from .tool import Joint, Tool, Tools
from .values import Pose, Wrench

__version__ = _library_version()

__all__ = [
    "Batch", "Busy", "Collapsed", "Device", "DeviceInput", "Failure", "HaptolithError", "InvalidParameter", "Joint", "Limits",
    "Loop", "Pose", "Safety", "SafetyInfo", "Scene", "SceneInfo", "Snapshot", "Soil", "Stopped", "TickFlag", "Tool", "Tools", "Trip",
    "Wrench",
    "calibrate", "fit_psychometric", "lab_test", "lab_tests", "presets", "scenes", "soils", "trust",
]
