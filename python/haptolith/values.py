"""Poses, wrenches, and texts for the library."""

from __future__ import annotations

import ctypes
import json
from dataclasses import dataclass
from typing import Any, Callable, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Pose:
    """Pose of the tool's frame in the scene's: scene_T_tool."""

    position_m: Sequence[float]
    orientation: Sequence[float] = (1.0, 0.0, 0.0, 0.0)  # w x y z, of norm 1

    def numbers(self) -> Floats:
        """x y z in m and w x y z: (7,)."""
        return np.array([*self.position_m, *self.orientation], dtype=np.float64)


PoseLike = Union[Pose, npt.ArrayLike]


def pose_numbers(pose: PoseLike) -> Floats:
    """(7,) of a Pose, of 3 numbers (x y z), of 7 (x y z, w x y z), or of a 4x4 matrix."""
    if isinstance(pose, Pose):
        return pose.numbers()
    given = np.asarray(pose, dtype=np.float64)
    if given.shape == (7,):
        return np.ascontiguousarray(given)
    if given.shape == (3,):
        return np.array([*given, 1.0, 0.0, 0.0, 0.0])
    if given.shape == (4, 4):
        return np.concatenate([given[:3, 3], quaternion(given[:3, :3])])
    raise ValueError(f"a pose is 3 or 7 numbers or a 4x4 matrix, not an array of shape {given.shape}")


def require_finite(poses: Floats) -> None:
    """Raises InvalidParameter with the first number of poses (7,), (n, 7) or (ticks, tools, 7) that is not finite."""
    wrong = np.argwhere(~np.isfinite(poses))
    if len(wrong) == 0:
        return
    from .errors import InvalidParameter

    at = tuple(int(i) for i in wrong[0])
    names = ("x", "y", "z", "w of the orientation", "x of the orientation", "y of the orientation", "z of the orientation")
    which = "".join(f" {i}" for i in at[:-1]) if len(at) < 3 else f" {at[0]} of tool {at[1]}"
    key = f"pose{which}, {names[at[-1]]}"
    value = str(poses[at])
    raise InvalidParameter(f"{key} = {value} is not valid: must be finite", key, value, "finite")


def quaternion(rotation: Floats) -> Floats:
    """w x y z of a 3x3 rotation matrix, by the largest of its four numbers (Shepperd 1978).

    Raises ValueError for a matrix that is no rotation."""
    m = np.asarray(rotation, dtype=np.float64)
    if not np.allclose(m @ m.T, np.eye(3), atol=1e-6) or np.linalg.det(m) < 0:
        raise ValueError("the upper left of a 4x4 pose must be a rotation")
    squares = np.array([np.trace(m), m[0, 0], m[1, 1], m[2, 2]])
    largest = int(np.argmax(squares))
    if largest == 0:
        q = np.array([1 + squares[0], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        q = np.empty(4)
        q[0] = m[k, j] - m[j, k]
        q[1 + i] = 1 + m[i, i] - m[j, j] - m[k, k]
        q[1 + j] = m[j, i] + m[i, j]
        q[1 + k] = m[k, i] + m[i, k]
    return np.asarray(q / np.linalg.norm(q), dtype=np.float64)


class Wrench:
    """Force (N) and torque (N m) about a point; what gives one says whose it is and in which frame."""

    __slots__ = ("numbers",)

    def __init__(self, numbers: Floats) -> None:
        self.numbers = numbers  # (6,): force, torque

    @property
    def force_n(self) -> Floats:
        """(3,)"""
        return self.numbers[:3]

    @property
    def torque_nm(self) -> Floats:
        """(3,)"""
        return self.numbers[3:]

    def __repr__(self) -> str:
        return f"Wrench(force_n={self.force_n}, torque_nm={self.torque_nm})"


def toml_value(value: object) -> str:
    """A Python value as TOML writes it."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=True)
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(toml_value(element) for element in value) + "]"
    raise TypeError(f"a value of a scene is a number, text, true or false, or a list, not {type(value).__name__}")


def overrides_of(named: Mapping[str, object]) -> list[str]:
    """bed__threads=2 as "bed.threads=2", tools__left__hand__motion="cut" as "tools.left.hand.motion=..."."""
    return [f"{name.replace('__', '.', -1 if name.startswith('tools__') else 1)}={toml_value(value)}"
            for name, value in named.items()]


def text_from(call: Callable[[Any, int, Any], int], room: int = 0) -> bytes:
    """Output of a function with a size query: the size first, then the data, in one call if there is room."""
    from . import _abi
    from .errors import require

    needed = ctypes.c_uint64()
    while True:
        buffer = ctypes.create_string_buffer(room)
        status = call(buffer, room, ctypes.byref(needed))
        if status != _abi.TOO_SMALL:
            require(status)
            return buffer.raw[: needed.value]
        room = needed.value
