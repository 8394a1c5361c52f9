"""Scenes: soil in a box and a tool, or several."""

from __future__ import annotations

import ctypes
import os
import re
from dataclasses import dataclass
from typing import Any, Optional, Sequence, Union, overload

import numpy as np
import numpy.typing as npt

from . import _abi
from ._long import Progress, call_long
from .errors import HaptolithError, error_of, require
from .result import names
from .tool import Tools, tool_names
from .values import Floats, Pose, PoseLike, Wrench, overrides_of, pose_numbers, require_finite, text_from

_lib = _abi.lib
_step = _lib.hapto_scene_step
_step_tools = _lib.hapto_scene_step_tools


class _Handle:
    """A scene of the library, for as long as a Scene or a view of it lives."""

    __slots__ = ("address",)

    def __init__(self, address: int) -> None:
        self.address = address

    def __del__(self) -> None:
        _lib.hapto_scene_destroy(self.address)


@dataclass(frozen=True)
class SceneInfo:
    """Numbers of a scene; see hapto_scene_info in haptolith.h."""

    substeps: int
    threads: int
    friction: str
    particles: int
    held: int
    awake: int
    steps: int
    tick_s: float
    radius_m: float
    mass_kg: float
    width_m: float
    length_m: float
    surface_m: float
    opening_m: float
    tool_fade: float
    energy_j: float
    gravity_m_s2: tuple[float, float, float]


def scenes() -> list[str]:
    """Names of the built-in scenes."""
    return names("scenes")


class Scene:
    """A box of soil and a tool in it, or several. One thread at a time; different scenes on any number of threads.

    Of several tools, members without a tool's name act on the first. Another one does not touch the soil until it is
    placed or stepped for the first time.

    name_or_path: a built-in scene (haptolith.scenes()) or a scene file. Keywords override its keys: bed__threads=2.
    "auto" is soil of the Moon in the finest particles that this machine renders at 1 kHz; it measures that once, in a second.
    progress(what, share): told now and then while soil settles; False gives up (Stopped).
    Raises InvalidParameter with key, value and what would be valid; Failure.
    """

    def __init__(self, name_or_path: Union[str, os.PathLike[str]] = "icra2021", *, progress: Optional[Progress] = None,
                 **keys: object) -> None:
        given = overrides_of(keys)
        name = os.fspath(name_or_path).encode()
        self._adopt(_made(lambda told, out: _lib.hapto_scene_from_file(name, _abi.texts(given), len(given), told, None,
                                                                       out), progress))

    def _adopt(self, address: int) -> None:
        self._handle: Optional[_Handle] = _Handle(address)
        self._address = address
        self._pose = np.zeros(7)
        self._felt = np.zeros(6)
        self._tool_names = tool_names(address)
        self._state_room = 0
        self._at_pose = self._pose.ctypes.data
        self._at_felt = self._felt.ctypes.data

    @classmethod
    def _of(cls, address: int) -> Scene:
        scene = cls.__new__(cls)
        scene._adopt(address)
        return scene

    @classmethod
    def from_toml(cls, text: str, *, progress: Optional[Progress] = None, **keys: object) -> Scene:
        """A scene from the text of a scene file; "" is the scene icra2021."""
        given = overrides_of(keys)
        return cls._of(_made(lambda told, out: _lib.hapto_scene_from_toml(text.encode(), None, _abi.texts(given),
                                                                          len(given), told, None, out), progress))

    @classmethod
    def from_state(cls, state: bytes) -> Scene:
        """Returns a scene that continues from `state` with the same bits, without settling again."""
        out = ctypes.c_void_p()
        require(_lib.hapto_scene_from_state(state, len(state), ctypes.byref(out)))
        return cls._of(out.value or 0)

    def clone(self) -> Scene:
        """Returns another scene that continues from here with the same bits."""
        out = ctypes.c_void_p()
        require(_lib.hapto_scene_clone(self.address, ctypes.byref(out)))
        return Scene._of(out.value or 0)

    __copy__ = clone

    def __deepcopy__(self, _memo: dict[int, Any]) -> Scene:
        return self.clone()

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        return Scene.from_state, (self.state,)

    def close(self) -> None:
        """Gives the scene's memory back, as soon as no view of its particles is left."""
        self._handle = None
        self._address = 0

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, *_raised: object) -> None:
        self.close()

    @property
    def address(self) -> int:
        """The library's handle. Raises HaptolithError when the scene has been closed."""
        return self.handle.address

    @property
    def handle(self) -> _Handle:
        """Keeps the library's scene alive. Raises as address."""
        if self._handle is None:
            raise HaptolithError("this scene has been closed", _abi.DESTROYED)
        return self._handle

    # --- moving ---

    @overload
    def step(self, pose: Pose, twist: Optional[npt.ArrayLike] = None) -> Wrench: ...

    @overload
    def step(self, pose: Union[Sequence[Pose], npt.ArrayLike], twist: Optional[npt.ArrayLike] = None) -> Any: ...

    def step(self, pose: Union[PoseLike, Sequence[Pose]], twist: Optional[npt.ArrayLike] = None) -> Union[Wrench, Floats]:
        """One tick of 1 ms: moves the tool in a straight line to the pose while the soil answers.

        Gives the soil wrench: of the soil on the tool, about the tool's origin, scene frame.
        pose: Pose, (3,), (7,) or (4, 4), scene_T_tool; or (n, 7) or a list of Pose, one for each of n tools, which gives an
        array (n, 6) of force and torque. twist: (6,) or (n, 6), m/s and rad/s, scene frame; None: as the way says.
        Raises InvalidParameter for a pose that is nowhere near; ValueError for poses of another number of tools;
        Collapsed."""
        if type(pose) is np.ndarray and pose.shape == (7,):
            self._pose[:] = pose
        else:
            if isinstance(pose, (list, tuple)) and len(pose) > 0 and isinstance(pose[0], Pose):
                return self._step_all(np.stack([pose_numbers(one) for one in pose]), twist)
            if np.ndim(pose) == 2 and np.shape(pose) != (4, 4):  # type: ignore[arg-type]
                return self._step_all(np.asarray(pose, dtype=np.float64), twist)
            self._pose[:] = pose_numbers(pose)  # type: ignore[arg-type]
        moved = None
        if twist is not None:
            numbers = np.ascontiguousarray(twist, dtype=np.float64)
            if numbers.shape != (6,):
                raise ValueError(f"a twist is 6 numbers, not an array of shape {numbers.shape}")
            moved = numbers.ctypes.data
        status = _step(self._address, self._at_pose, moved, self._at_felt)
        if status:
            self.address  # closed?
            require_finite(self._pose)
            raise error_of(status)
        return Wrench(self._felt.copy())

    def _step_all(self, poses: Floats, twists: Optional[npt.ArrayLike]) -> Floats:
        """A tick of all tools."""
        given = np.ascontiguousarray(poses)
        self._require_tools(given, 1)
        moved = None
        if twists is not None:
            numbers = np.ascontiguousarray(twists, dtype=np.float64)
            if numbers.shape != (len(given), 6):
                raise ValueError(f"twists of {len(given)} tools are ({len(given)}, 6), not {numbers.shape}")
            moved = numbers.ctypes.data
        felt = np.empty((len(given), 6))
        status = _step_tools(self._address, given.ctypes.data, moved, len(given), felt.ctypes.data)
        if status:
            self.address  # closed?
            require_finite(given)
            raise error_of(status)
        return felt

    def _require_tools(self, poses: Floats, at: int) -> None:
        """Raises ValueError unless dimension `at` - 1 of poses is that of the tools, and the last one is 7."""
        n = len(self._tool_names)
        if poses.ndim != at + 1 or poses.shape[at - 1] != n or poses.shape[at] != 7:
            shape = f"({n}, 7)" if at == 1 else f"(ticks, {n}, 7)"
            raise ValueError(f"poses of all {n} tools ({', '.join(self._tool_names)}) are {shape}: x y z, w x y z; not "
                             f"{poses.shape}")

    @property
    def tools(self) -> Tools:
        """Its tools: scene.tools["left"].wrench, scene.tools[1].place(pose), scene.tools.names."""
        return Tools(self, self._tool_names)

    def steps(self, poses: npt.ArrayLike) -> Floats:
        """Many ticks: (ticks, 7) poses of the first tool give (ticks, 6) soil wrenches, scene frame; poses of all tools,
        (ticks, tools, 7), give (ticks, tools, 6). Other threads run meanwhile."""
        given = np.ascontiguousarray(poses, dtype=np.float64)
        if given.ndim == 3:
            self._require_tools(given, 2)
            require_finite(given)
            all_felt = np.zeros((*given.shape[:2], 6))
            require(_lib.hapto_scene_steps_tools(self.address, given.shape[0], given.ctypes.data, None, given.shape[1],
                                                 all_felt.ctypes.data, None))
            return all_felt
        if given.ndim != 2 or given.shape[1] != 7:
            raise ValueError(f"poses are (ticks, 7): x y z, w x y z; or (ticks, tools, 7); not {given.shape}")
        require_finite(given)
        felt = np.zeros((len(given), 6))
        require(_lib.hapto_scene_steps(self.address, len(given), given.ctypes.data, None, felt.ctypes.data, None))
        return felt

    def place_tool(self, pose: PoseLike) -> None:
        """Puts the tool somewhere without moving it there: place it above the soil."""
        self._pose[:] = pose_numbers(pose)
        require_finite(self._pose)
        require(_lib.hapto_scene_place_tool(self.address, self._at_pose))

    @property
    def tool_pose(self) -> Floats:
        """(7,): x y z in m, w x y z."""
        pose = np.empty(7)
        require(_lib.hapto_scene_get_tool_pose(self.address, pose.ctypes.data))
        return pose

    @property
    def wrench(self) -> Wrench:
        """The soil wrench of the last tick: of the soil on the tool, about the tool's origin, scene frame."""
        soil = np.empty(6)
        require(_lib.hapto_scene_get_wrench(self.address, soil.ctypes.data))
        return Wrench(soil)

    @property
    def contact_stiffness(self) -> Floats:
        """(3, 3) in N/m: dF = -K dx with unchanged velocities of the soil."""
        k = np.empty((3, 3))
        require(_lib.hapto_scene_get_contact_stiffness(self.address, k.ctypes.data))
        return k

    @property
    def grip_force(self) -> float:
        """Force of the soil that opened the jaws in the last tick, N."""
        n = ctypes.c_double()
        require(_lib.hapto_scene_get_grip_force(self.address, ctypes.byref(n)))
        return n.value

    @property
    def force_band(self) -> Optional[tuple[float, float]]:
        """As Tool.force_band, of the first tool."""
        return self.tools[0].force_band

    def set_opening(self, share: float) -> None:
        """Sets the opening of the jaws at the end of the next tick, 0 to 1."""
        require(_lib.hapto_scene_set_opening(self.address, share))

    def set_tool_fade(self, share: float) -> None:
        """Sets the present fraction of the tool, 0 to 1, from the next tick on."""
        require(_lib.hapto_scene_set_tool_fade(self.address, share))

    def set_gravity(self, m_s2: npt.ArrayLike) -> None:
        """(3,) m/s^2, scene frame, from the next tick on."""
        given = np.ascontiguousarray(m_s2, dtype=np.float64)
        if given.shape != (3,):
            raise ValueError(f"gravity is 3 numbers, not an array of shape {given.shape}")
        require(_lib.hapto_scene_set_gravity(self.address, given.ctypes.data))

    def change(self, **keys: object) -> None:
        """Changes soil, gravity or tools of the soil as it lies: gravity__body="Mars", tool__diameter_mm=40 (every tool),
        tools__left__friction=0.4."""
        given = overrides_of(keys)
        require(_lib.hapto_scene_change(self.address, _abi.texts(given), len(given)))

    # --- looking ---

    @property
    def info(self) -> SceneInfo:
        """Numbers of the scene; goes through all particles."""
        info = _abi.sized(_abi.SceneInfo)
        require(_lib.hapto_scene_get_info(self.address, info))
        numbers = {name: getattr(info, name) for name, _ in _abi.SceneInfo._fields_ if name != "size"}
        numbers["friction"] = "contact" if info.friction else "icra2021"
        numbers["gravity_m_s2"] = tuple(info.gravity_m_s2)
        return SceneInfo(**numbers)

    @property
    def soil(self) -> Optional[str]:
        """Name of its soil or preset; None when it is given by numbers alone."""
        return self._named("preset") or self._named("soil")

    @property
    def body(self) -> Optional[str]:
        """Name of its world; None when gravity is given by its number."""
        return self._named("body")

    def _named(self, key: str) -> Optional[str]:
        found = re.search(rf'^\[names\]\n(?:[^\[\n].*\n)*?{key} = "([^"]+)"', self.toml, re.M)
        return found[1] if found else None

    @property
    def positions(self) -> npt.NDArray[np.float32]:
        """Centres of the particles, (n, 3) m. A read-only view: **old after the next step**; copy() what is to stay."""
        return self._view(_abi.POSITION)

    @property
    def velocities(self) -> npt.NDArray[np.float32]:
        """(n, 3) m/s; a view like positions."""
        return self._view(_abi.VELOCITY)

    def _view(self, field: int) -> npt.NDArray[np.float32]:
        array = _abi.sized(_abi.Array)
        require(_lib.hapto_scene_view(self.address, field, array))
        memory = (ctypes.c_byte * (array.count * array.stride_bytes)).from_address(array.data)
        memory.scene = self._handle  # lives as long as the view
        view: npt.NDArray[np.float32] = np.ndarray((array.count, 3), np.float32, memory, 0, (array.stride_bytes, 4))
        if os.environ.get("HAPTOLITH_CHECK_VIEWS") == "1":
            view = view.copy()
        view.flags.writeable = False
        return view

    @property
    def radii(self) -> npt.NDArray[np.float32]:
        """(n,) m; a copy."""
        return self._copy(_abi.RADIUS, np.float32)

    @property
    def contact_loads(self) -> npt.NDArray[np.float32]:
        """Load of each particle by its neighbours, (n,) N: shows force chains; a copy."""
        return self._copy(_abi.CONTACT_LOAD, np.float32)

    @property
    def asleep(self) -> npt.NDArray[np.bool_]:
        """Which particles are not worked on, since nothing near them moves, (n,); a copy."""
        return self._copy(_abi.ASLEEP, np.uint8).astype(np.bool_)

    @property
    def held(self) -> npt.NDArray[np.bool_]:
        """Which particles stand for ever where a box of settled soil ends, (n,); a copy."""
        return self._copy(_abi.HELD, np.uint8).astype(np.bool_)

    def _copy(self, field: int, dtype: Any) -> npt.NDArray[Any]:
        array = _abi.sized(_abi.Array)
        require(_lib.hapto_scene_view(self.address, _abi.POSITION, array))
        copied = np.empty(array.count, dtype)
        require(_lib.hapto_scene_copy(self.address, field, copied.ctypes.data, copied.nbytes))
        return copied

    # --- the whole of it ---

    @property
    def toml(self) -> str:
        """The scene as a scene file, complete."""
        return text_from(lambda out, room, needed: int(_lib.hapto_scene_get_toml(self.address, out, room, needed)))[:-1].decode()

    @property
    def state(self) -> bytes:
        """The whole scene, parameters included; setting it goes back there, bit for bit.

        For this version of the library and one arithmetic, on any machine."""
        state = text_from(lambda out, room, needed: int(_lib.hapto_scene_get_state(self.address, out, room, needed)),
                          self._state_room)
        self._state_room = len(state) + len(state) // 8  # making it takes long: next time once is enough
        return state

    @state.setter
    def state(self, state: bytes) -> None:
        require(_lib.hapto_scene_set_state(self.address, state, len(state)))

    @property
    def state_hash(self) -> int:
        """64 bits over particles and what their contacts remember, as `haptolith run --json` prints them."""
        out = ctypes.c_uint64()
        require(_lib.hapto_scene_state_hash(self.address, ctypes.byref(out)))
        return out.value

    def __repr__(self) -> str:
        if self._handle is None:
            return "<haptolith.Scene, closed>"
        try:
            info = self.info
        except HaptolithError as error:
            return f"<haptolith.Scene: {error}>"
        gravity = float(np.linalg.norm(info.gravity_m_s2))
        tools = f", tools {', '.join(self._tool_names)}" if len(self._tool_names) > 1 else ""
        return (f"<haptolith.Scene: {self.soil or 'own soil'}, {self.body or f'{gravity:.3g} m/s2'}, {info.particles} particles of "
                f"R = {1e3 * info.radius_m:g} mm, {info.friction} friction{tools}>")


def _made(make: Any, progress: Optional[Progress]) -> int:
    out = ctypes.c_void_p()
    call_long(lambda told: int(make(told, ctypes.byref(out))), progress)
    return out.value or 0


__all__ = ["Pose", "Scene", "SceneInfo", "scenes"]
