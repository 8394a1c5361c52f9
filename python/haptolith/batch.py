"""Many scenes on several threads."""

from __future__ import annotations

import ctypes
from typing import Sequence

import numpy as np
import numpy.typing as npt

from . import _abi
from ._owned import Owned
from .errors import require
from .scene import Scene
from .values import Floats


class Batch(Owned):
    """Steps scenes on separate threads, bit-identical to one by one. threads=0: as many as the machine has."""

    _destroy = _abi.lib.hapto_batch_destroy
    _held: Sequence[object] = ()

    def __init__(self, scenes: Sequence[Scene], threads: int = 0) -> None:
        self.scenes = list(scenes)
        self._held = [scene.handle for scene in self.scenes]  # a scene closed before the batch lives on until then
        handles = (ctypes.c_void_p * len(self.scenes))(*[scene.address for scene in self.scenes])
        out = ctypes.c_void_p()
        require(_abi.lib.hapto_batch_create(handles, len(self.scenes), threads, ctypes.byref(out)))
        self._handle = out.value

    def step(self, poses: npt.ArrayLike) -> Floats:
        """(scenes, ticks, 7) or (scenes, 7) poses give (scenes, ticks, 6) or (scenes, 6) soil wrenches, scene frame.

        (scenes, ticks, tools, 7) are poses of all tools, in scenes with the same number of them.
        Other threads of Python run meanwhile. Raises what the first scene that failed raises."""
        given = np.ascontiguousarray(poses, dtype=np.float64)
        if given.ndim == 4:
            return self._step_tools(given)
        one_tick = given.ndim == 2
        if one_tick:
            given = given[:, None, :]
        if given.ndim != 3 or given.shape[0] != len(self.scenes) or given.shape[2] != 7:
            raise ValueError(f"poses of {len(self.scenes)} scenes are ({len(self.scenes)}, ticks, 7), not {given.shape}")
        for scene in self.scenes:
            scene.address  # raises for one that has been closed
        felt = np.zeros((*given.shape[:2], 6))
        require(_abi.lib.hapto_batch_step(self.address, given.shape[1], given.ctypes.data, None, felt.ctypes.data, None))
        return felt[:, 0] if one_tick else felt

    def _step_tools(self, given: Floats) -> Floats:
        for scene in self.scenes:
            if given.shape[0] != len(self.scenes) or given.shape[2:] != (len(scene.tools), 7):
                raise ValueError(f"poses of {len(self.scenes)} scenes with {len(scene.tools)} tools are ({len(self.scenes)}, ticks, "
                                 f"{len(scene.tools)}, 7), not {given.shape}")
            scene.address  # raises for one that has been closed
        felt = np.zeros((*given.shape[:3], 6))
        require(_abi.lib.hapto_batch_step_tools(self.address, given.shape[1], given.ctypes.data, None,
                                                felt.size // 6, felt.ctypes.data, None))
        return felt

    def __len__(self) -> int:
        return len(self.scenes)

    def __repr__(self) -> str:
        counts = {len(scene.tools) for scene in self.scenes}
        tools = f" with {' or '.join(str(n) for n in sorted(counts))} tools" if counts != {1} else ""
        return f"<haptolith.Batch of {len(self)} scenes{tools}{'' if self._handle else ', closed'}>"

    def close(self) -> None:
        """Ends its threads; the scenes stay."""
        super().close()
        self._held = ()
