"""The tools of a scene."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Iterator, Optional, Union, overload

import numpy as np

from . import _abi
from .errors import HaptolithError, InvalidParameter, require
from .values import Floats, PoseLike, Wrench, pose_numbers, require_finite

_lib = _abi.lib
_DRIVES = ("none", "speed", "torque", "free")


@dataclass(frozen=True)
class Joint:
    """Joint of a tool after the last tick. The torques act on the tool about the axis and are means over the tick.

    drive: "speed", "torque" or "free". angle_rad: -pi to pi; at 0 the tool's frame is the hub's."""

    drive: str
    angle_rad: float
    speed_rad_s: float
    soil_torque_nm: float
    motor_torque_nm: float


class Tool:
    """One tool of a scene: scene.tools["left"] or scene.tools[0]."""

    __slots__ = ("_scene", "number", "name")

    def __init__(self, scene: Any, number: int, name: str) -> None:
        self._scene = scene
        self.number = number
        self.name = name

    def _state(self) -> Any:
        state = _abi.sized(_abi.ToolState)
        require(_lib.hapto_scene_tool_get_state(self._scene.address, self.number, state))
        return state

    @property
    def in_soil(self) -> bool:
        """Whether it touches soil. Tools other than the first do so once they are placed or stepped."""
        return bool(self._state().in_soil)

    @property
    def pose(self) -> Floats:
        """scene_T_tool, (7,): x y z in m, w x y z. With a joint: of the hub."""
        return _pose(self._state().scene_T_tool)

    @property
    def turned_pose(self) -> Floats:
        """Pose of the tool's shape, as its joint has turned it, (7,)."""
        return _pose(self._state().scene_T_turned)

    @property
    def wrench(self) -> Wrench:
        """The soil wrench of the last tick, about the origin of `pose`, scene frame."""
        soil = self._state().soil_wrench
        return Wrench(np.array([*soil.force_n, *soil.torque_nm]))

    @property
    def joint(self) -> Optional[Joint]:
        """State of its joint; None without one."""
        state = self._state()
        if state.drive == 0:
            return None
        return Joint(_DRIVES[state.drive], state.angle_rad, state.speed_rad_s, state.soil_torque_nm, state.motor_torque_nm)

    @property
    def contact_stiffness(self) -> Floats:
        """(3, 3) in N/m: as Scene.contact_stiffness."""
        return np.array(self._state().stiffness_n_m).reshape(3, 3)

    @property
    def opening_m(self) -> float:
        """Distance between its jaws."""
        return float(self._state().opening_m)

    @property
    def grip_force(self) -> float:
        """Force of the soil that opened its jaws in the last tick, N."""
        return float(self._state().grip_force_n)

    @property
    def force_band(self) -> Optional[tuple[float, float]]:
        """Range, with a probability of 90 %, of the mean soil force over the last 0.25 s in another specimen with particles
        half as large, N. None in the first 0.25 s, with ICRA 2021 friction and particles of several sizes."""
        state = self._state()
        return None if np.isnan(state.force_low_n) else (float(state.force_low_n), float(state.force_high_n))

    @property
    def fade(self) -> float:
        """Present fraction of the tool: see set_fade()."""
        return float(self._state().fade)

    def place(self, pose: PoseLike) -> None:
        """Puts the tool somewhere without moving it there: place it above the soil."""
        numbers = pose_numbers(pose)
        require_finite(numbers)
        require(_lib.hapto_scene_tool_place(self._scene.address, self.number, numbers.ctypes.data))

    def set_drive(self, value: float) -> None:
        """Sets the speed (rad/s) or the torque (N m) of its joint's drive from the next tick on."""
        status = _lib.hapto_scene_tool_set_drive(self._scene.address, self.number, value)
        if status == _abi.INVALID_PARAMETER:
            joint = self.joint
            driven = joint is not None and joint.drive != "free"
            valid = ("-100 to 100 rad/s" if joint and joint.drive == "speed" else "-1000 to 1000 N m") if driven else \
                "a tool whose joint_drive is speed or torque"
            key = f"drive of tool '{self.name}'"
            raise InvalidParameter(f"{key} = {value} is not valid: must be {valid}", key, str(value), valid)
        require(status)

    def set_opening(self, share: float) -> None:
        """Sets the opening of the jaws at the end of the next tick, 0 to 1."""
        require(_lib.hapto_scene_tool_set_opening(self._scene.address, self.number, share))

    def set_fade(self, share: float) -> None:
        """Sets the present fraction of the tool, 0 to 1, from the next tick on."""
        require(_lib.hapto_scene_tool_set_fade(self._scene.address, self.number, share))

    def __repr__(self) -> str:
        try:
            state = self._state()
        except HaptolithError as error:
            return f"<haptolith.Tool {self.number} '{self.name}': {error}>"
        x, y, z = (1e3 * v for v in state.scene_T_tool.position_m)
        joint = f", {_DRIVES[state.drive]} joint at {np.degrees(state.angle_rad):.1f} deg" if state.drive else ""
        return (f"<haptolith.Tool {self.number} '{self.name}' at ({x:.1f}, {y:.1f}, {z:.1f}) mm{joint}"
                f"{'' if state.in_soil else ', not in the soil yet'}>")


class Tools(Sequence[Tool]):
    """Tools of a scene in their order; an index is a number or a name."""

    def __init__(self, scene: Any, tool_names: Sequence[str]) -> None:
        self._tools = tuple(Tool(scene, i, name) for i, name in enumerate(tool_names))

    @property
    def names(self) -> list[str]:
        """Their names in order."""
        return [tool.name for tool in self._tools]

    @overload
    def __getitem__(self, which: Union[int, str]) -> Tool: ...

    @overload
    def __getitem__(self, which: slice) -> Sequence[Tool]: ...

    def __getitem__(self, which: Union[int, str, slice]) -> Union[Tool, Sequence[Tool]]:
        if not isinstance(which, str):
            return self._tools[which]
        for tool in self._tools:
            if tool.name == which:
                return tool
        raise KeyError(f"no tool '{which}'; there are {', '.join(self.names)}")

    def __len__(self) -> int:
        return len(self._tools)

    def __iter__(self) -> Iterator[Tool]:
        return iter(self._tools)

    def __repr__(self) -> str:
        return f"<haptolith.Tools: {', '.join(self.names)}>"


def tool_names(address: int) -> list[str]:
    """Names of the tools of a scene of the library, in order."""
    count = ctypes.c_uint32()
    require(_lib.hapto_scene_tools(address, ctypes.byref(count)))
    name = ctypes.c_char_p()
    names = []
    for number in range(count.value):
        require(_lib.hapto_scene_tool_name(address, number, ctypes.byref(name)))
        names.append((name.value or b"").decode())
    return names


def _pose(pose: Any) -> Floats:
    return np.array([*pose.position_m, *pose.orientation], dtype=np.float64)


__all__ = ["Joint", "Tool", "Tools"]
