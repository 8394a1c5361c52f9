"""The safety layer alone, for hosts with their own loop and device."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Optional

import numpy as np
import numpy.typing as npt

from . import _abi
from ._owned import Owned
from .errors import require
from .loop import Limits
from .values import PoseLike, Wrench, overrides_of, pose_numbers


@dataclass(frozen=True)
class SafetyInfo:
    """trip: why the hand feels nothing just now; "" when it does. flags: TickFlag, of the last step.
    injected_j: energy given beyond what was taken."""

    trip: str
    trips: int
    flags: int
    injected_j: float


class Safety(Owned):
    """Plausibility, soft start, the device's limits and rates, passivity (docs/explanation/safety.md).

    tick_s: of your loop. stiffness_n_m: of the softest spring that stores what the hand presses with. Keywords are keys
    of [safety]: Safety(limits, soft_start_s=1)."""

    _destroy = _abi.lib.hapto_safety_destroy

    def __init__(self, limits: Optional[Limits] = None, *, tick_s: float = 1e-3, stiffness_n_m: float = 100,
                 **keys: object) -> None:
        given = overrides_of({f"safety__{key}": value for key, value in keys.items()})
        out = ctypes.c_void_p()
        require(_abi.lib.hapto_safety_create((limits or Limits()).struct(), _abi.texts(given), len(given), tick_s,
                                             stiffness_n_m, ctypes.byref(out)))
        self._handle = out.value
        self._told = _abi.sized(_abi.DeviceInput)
        self._shown = _abi.sized(_abi.DeviceOutput)

    def step(self, pose: PoseLike, force: npt.ArrayLike, late: bool = False) -> Wrench:
        """Returns the permitted part of a force (3,) N or wrench (6,) for a hand at `pose`, all device frame. Call it every tick."""
        numbers = pose_numbers(pose)
        wanted = np.zeros(6)
        given = np.asarray(force, dtype=np.float64)
        wanted[: len(given)] = given
        self._told.pose.position_m[:] = numbers[:3].tolist()
        self._told.pose.orientation[:] = numbers[3:].tolist()
        self._shown.wrench.force_n[:] = wanted[:3].tolist()
        self._shown.wrench.torque_nm[:] = wanted[3:].tolist()
        require(_abi.lib.hapto_safety_step(self.address, self._told, int(late), self._shown))
        return Wrench(np.array([*self._shown.wrench.force_n, *self._shown.wrench.torque_nm]))

    def __repr__(self) -> str:
        if not self._handle:
            return "<haptolith.Safety, closed>"
        info = self.info
        return f"<haptolith.Safety: {f'no force: {info.trip}' if info.trip else 'force is on'}, {info.trips} trips>"

    def stop(self) -> None:
        """Force goes to nothing softly and stays there."""
        require(_abi.lib.hapto_safety_stop(self.address))

    @property
    def info(self) -> SafetyInfo:
        """State of the safety layer."""
        info = _abi.sized(_abi.SafetyInfo)
        require(_abi.lib.hapto_safety_get_info(self.address, info))
        return SafetyInfo((info.trip or b"").decode(), info.trips, info.flags, info.injected_j)
