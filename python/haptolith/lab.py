"""The soil laboratory, and how far a force can be believed."""

from __future__ import annotations

import ctypes
from typing import Optional, Union

from . import _abi
from ._long import Progress, call_long
from .result import Result, names, take
from .scene import Scene
from .soil import Soil
from .values import toml_value


def lab_tests() -> list[str]:
    """Names of the tests."""
    return names("lab tests")


def trust(scene: Scene, *, progress: Optional[Progress] = None, **options: object) -> Result:
    """Finds out how far the force of a scene's movement can be believed, as `haptolith trust` does: trust(scene, minutes=2).

    options: tool, duration_s, specimens, minutes, threads. The result has "sentence", "mean_within", "peak_within", "complaints" and
    "effects". Takes minutes; Ctrl-C ends it."""
    text = "".join(f"{key} = {toml_value(value)}\n" for key, value in options.items()).encode()
    out = ctypes.c_void_p()
    call_long(lambda told: int(_abi.lib.hapto_scene_trust(scene.address, text, told, None, ctypes.byref(out))), progress)
    return take(out)


def lab_test(test: str, soil: Union[str, Soil], *, progress: Optional[Progress] = None, **options: object) -> Result:
    """Makes a test on a soil, as `haptolith lab TEST` does: lab_test("shear", "dry-sand", body="Earth", seed=2).

    options: those of the command with _ for -. The result has the numbers that --json prints, "findings" beside what
    they should be, and the trace as columns. Ctrl-C ends it."""
    specimen = Soil(soil) if isinstance(soil, str) else soil
    text = "".join(f"{key} = {toml_value(value)}\n" for key, value in options.items()).encode()
    out = ctypes.c_void_p()
    call_long(lambda told: int(_abi.lib.hapto_lab_test(test.encode(), specimen.address, text, told, None, ctypes.byref(out))),
              progress)
    return take(out)
