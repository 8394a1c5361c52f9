"""The loop that joins a scene and a device at 1 kHz."""

from __future__ import annotations

import ctypes
import sys
import traceback
from dataclasses import dataclass, field
from enum import IntEnum, IntFlag
from typing import Any, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _abi
from ._owned import Owned
from .errors import require
from .scene import Scene
from .values import Floats, overrides_of

_lib = _abi.lib


@dataclass
class Limits:
    """Limits that a device declares: fields of hapto_device_limits; absent ones are those of an ideal device."""

    declared: dict[str, Any] = field(default_factory=dict)

    def __init__(self, **declared: Any) -> None:
        known = {name for name, _ in _abi.DeviceLimits._fields_}
        for name in declared:
            if name not in known or name == "size":
                raise TypeError(f"a device's limits have no {name}; they have {', '.join(sorted(known - {'size'}))}")
        self.declared = declared

    def struct(self) -> Any:
        """For the library."""
        limits = _abi.DeviceLimits()
        require(_lib.hapto_device_limits_init(limits))
        for name, value in self.declared.items():
            if isinstance(value, (list, tuple, np.ndarray)):
                getattr(limits, name)[:] = [float(v) for v in value]
            else:
                setattr(limits, name, value)
        return limits


@dataclass
class DeviceInput:
    """State of the handle from a device, device frame."""

    position_m: npt.ArrayLike = (0.0, 0.0, 0.0)
    orientation: npt.ArrayLike = (1.0, 0.0, 0.0, 0.0)  # w x y z
    linear_m_s: npt.ArrayLike = (0.0, 0.0, 0.0)
    angular_rad_s: npt.ArrayLike = (0.0, 0.0, 0.0)
    gripper_open: float = 0
    buttons: int = 0
    lost: bool = False  # the device is gone


class Device:
    """A device in Python, for trying things out: subclass it. The loop's thread calls read() and write() every tick and
    waits for Python meanwhile, so a busy interpreter makes it late; what either raises ends the run."""

    name = "device in Python"
    limits = Limits(simulated=1)  # no person's hand is at it

    def read(self) -> DeviceInput:
        """Returns the current state of the handle."""
        raise NotImplementedError

    def write(self, force_n: Floats, torque_nm: Floats) -> None:
        """Renders force and torque, (3,) each, about the handle's origin, device frame."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} '{self.name}'>"


class Trip(IntEnum):
    """Why the safety layer makes the hand feel nothing: `trip` of ticks, as HAPTO_TRIP_... in haptolith.h."""

    NONE = 0
    DEVICE_NOT_FINITE = 1
    STALE = 2
    LOST = 3
    WORKSPACE = 4
    MISSED_DEADLINES = 5
    HEARTBEAT = 6
    FORCE_NOT_FINITE = 7
    IMPLAUSIBLE = 8


class TickFlag(IntFlag):
    """Events in a tick or before it: `flags` of ticks, as HAPTO_TICK_... in haptolith.h."""

    LATE = 1
    ZEROED = 2
    SATURATED = 4
    RATE_LIMITED = 8
    SOFT_START = 16
    DAMPED = 32
    RESUMED = 64
    HEARTBEAT_LOST = 128
    SCENE_CHANGED = 256
    SOFT_STOP = 512
    FAILED = 1024
    SOIL_ADJUSTED = 2048
    PARTICLE_MOVED = 4096
    GRAIN_MOVED = 4096  # deprecated


@dataclass(frozen=True, repr=False)
class Snapshot:
    """A picture of a running scene; positions (n, 3) m, scene frame, is a copy.

    soil_force_n, soil_torque_nm: of the soil on the tool in the last tick, (3,) each, about the tool's origin, scene
    frame, unfiltered. device_force_n, device_torque_nm: sent to the device in the last tick, (3,) each, about the
    handle's origin, device frame. felt_n, felt_nm (deprecated): the same turned into the scene's axes.
    tool_pose: scene_T_tool, (7,): x y z in m, w x y z."""

    running: bool
    end: str
    trip: str
    trips: int
    paused: bool
    ticks: int
    deadline_misses: int
    awake: int
    time_s: float
    tool_pose: Floats
    opening_m: float
    felt_n: Floats
    felt_nm: Floats
    success_rate: float
    tick_us_p50: float
    tick_us_p99: float
    tick_us_max: float
    largest_speed_m_s: float
    positions: npt.NDArray[np.float32]
    misses_too_long: int
    misses_woken_late: int
    misses_preempted: int
    soil_force_n: Floats
    soil_torque_nm: Floats
    device_force_n: Floats
    device_torque_nm: Floats

    def __repr__(self) -> str:
        state = "paused" if self.paused else "running" if self.running else f"ended ({self.end or 'not started'})"
        trip = f", no force: {self.trip}" if self.trip else ""
        tool = ", ".join(f"{1e3 * v:.1f}" for v in self.tool_pose[:3])
        return (f"<haptolith.Snapshot: {state}{trip}, {self.time_s:.3f} s, {self.ticks} ticks, {self.deadline_misses} late, tool at "
                f"({tool}) mm, soil force {np.array2string(self.soil_force_n, precision=3)} N, {len(self.positions)} particles>")


class Loop(Owned):
    """Joins a scene and a device at 1 kHz: mapping, coupling, filter and safety layer as the scene says.

    device: None: the one that the scene names, a virtual hand by default. A list has one for each tool of the scene, and
    ticks have the number of their `tool` then. The scene belongs to the loop until close().
    ticked_by_caller: tick() in a loop of yours instead of start(). keep_ticks: for take_ticks() and for a Recorder."""

    _destroy = _lib.hapto_loop_destroy
    _held: Optional[object] = None

    def __init__(self, scene: Scene, device: Union[Device, Sequence[Optional[Device]], None] = None, *,
                 ticked_by_caller: bool = False, keep_ticks: bool = False) -> None:
        self.scene = scene
        self._held = scene.handle  # a scene closed before the loop lives on until then
        self.device = device
        self._raised: list[BaseException] = []
        self._own: Any = None
        flags = (_abi.TICKED_BY_CALLER if ticked_by_caller else 0) | (_abi.KEEPS_TICKS | _abi.HASHES if keep_ticks else 0)
        out = ctypes.c_void_p()
        if device is None or isinstance(device, Device):
            self._own = _own_device(device, self._raised) if device is not None else None
            status = _lib.hapto_loop_create(scene.address, self._own, flags, ctypes.byref(out))
        else:
            owns = [None if one is None else ctypes.pointer(_own_device(one, self._raised)) for one in device]
            self._own = owns  # keeps alive the targets of the pointers
            pointers = (ctypes.POINTER(_abi.Device) * max(1, len(owns)))(*[own or ctypes.POINTER(_abi.Device)() for own in owns])
            status = _lib.hapto_loop_create_tools(scene.address, pointers, len(owns), flags, ctypes.byref(out))
        require(status)
        self._handle = out.value

    def start(self) -> None:
        """Runs it on a separate thread, in step with the clock unless the scene sets loop.real_time = false."""
        require(_lib.hapto_loop_start(self.address))

    def tick(self, late: bool = False) -> bool:
        """One tick with ticked_by_caller; False: it was the last."""
        status = _lib.hapto_loop_tick(self.address, int(late))
        if self._raised:
            raise self._raised.pop()
        if status == _abi.ENDED:
            return False
        require(status)
        return True

    def stop(self) -> None:
        """Ends a started loop; its thread has ended on return."""
        require(_lib.hapto_loop_stop(self.address))
        if self._raised:
            raise self._raised.pop()

    def pause(self, on: bool = True) -> None:
        """Pauses time, or resumes it."""
        require(_lib.hapto_loop_pause(self.address, int(on)))

    def change(self, **keys: object) -> None:
        """As Scene.change() while it runs: no hand feels a jump."""
        given = overrides_of(keys)
        require(_lib.hapto_loop_change(self.address, _abi.texts(given), len(given)))

    def snapshot(self) -> Snapshot:
        """The newest snapshot, at about 60 Hz."""
        now = _abi.sized(_abi.Snapshot)
        require(_lib.hapto_loop_snapshot(self.address, now))
        if self._raised:
            raise self._raised.pop()
        positions = np.empty((0, 3), np.float32)
        if now.position.count:
            memory = (ctypes.c_byte * (now.position.count * now.position.stride_bytes)).from_address(now.position.data)
            positions = np.ndarray((now.position.count, 3), np.float32, memory, 0, (now.position.stride_bytes, 4)).copy()
        pose = np.array([*now.scene_T_tool.position_m, *now.scene_T_tool.orientation])
        return Snapshot(bool(now.running), now.end.decode(), now.trip.decode(), now.trips, bool(now.paused), now.ticks,
                        now.deadline_misses, now.awake, now.time_s, pose, now.opening_m, np.array(now.felt.force_n),
                        np.array(now.felt.torque_nm), now.success_rate, now.tick_us_p50, now.tick_us_p99,
                        now.tick_us_max, now.largest_speed_m_s, positions, now.misses_too_long, now.misses_woken_late,
                        now.misses_preempted, np.array(now.soil_wrench.force_n), np.array(now.soil_wrench.torque_nm),
                        np.array(now.device_wrench.force_n), np.array(now.device_wrench.torque_nm))

    def take_ticks(self, most: int = 100_000) -> npt.NDArray[Any]:
        """The ticks that wait, the oldest first, as a structured array with the names of hapto_tick; with keep_ticks.

        soil_wrench is in the scene frame; rendered and device_wrench in the device frame. flags are TickFlag,
        trip is Trip. Take them every second or more often, or some are lost."""
        ticks = (_abi.Tick * most)()
        count = ctypes.c_uint64()
        require(_lib.hapto_loop_take_ticks(self.address, ticks, most, ctypes.byref(count), None))
        taken: npt.NDArray[Any] = np.frombuffer(memoryview(ticks), dtype=_abi.TICK)[: count.value].copy()
        return taken

    def __repr__(self) -> str:
        if not self._handle:
            return "<haptolith.Loop, closed>"
        devices = self.device if isinstance(self.device, (list, tuple)) else [self.device]
        device = ", ".join(one.name if one is not None else "the scene's device" for one in devices)
        now = _abi.sized(_abi.Snapshot)
        if _lib.hapto_loop_snapshot(self._handle, now) != _abi.OK:  # another thread takes a snapshot
            return f"<haptolith.Loop with {device}>"
        state = "paused" if now.paused else "running" if now.running else f"ended: {now.end.decode()}" if now.end else "not started"
        trip = f", no force: {now.trip.decode()}" if now.trip else ""
        return f"<haptolith.Loop with {device}: {state}, {now.ticks} ticks, {now.deadline_misses} late{trip}>"

    def close(self) -> None:
        """Stops it and gives the scene back."""
        super().close()
        self._held = None


def _own_device(device: Device, raised: list[BaseException]) -> Any:
    """The device as the library calls it; what it raises is kept, and the device is gone then."""

    def failed(error: BaseException) -> None:
        if not raised:
            raised.append(error)
            traceback.print_exception(type(error), error, error.__traceback__, file=sys.stderr)

    def read(_user: object, out: Any) -> None:
        told = out.contents
        try:
            now = device.read()
            told.pose.position_m[:] = [float(v) for v in np.asarray(now.position_m)]
            told.pose.orientation[:] = [float(v) for v in np.asarray(now.orientation)]
            told.twist.linear_m_s[:] = [float(v) for v in np.asarray(now.linear_m_s)]
            told.twist.angular_rad_s[:] = [float(v) for v in np.asarray(now.angular_rad_s)]
            told.gripper_open, told.buttons = now.gripper_open, now.buttons
            told.state = 2 if now.lost or raised else 0
        except BaseException as error:  # pylint: disable=broad-except
            failed(error)
            told.state = 2

    def write(_user: object, force: Any) -> None:
        try:
            device.write(np.array(force.contents.wrench.force_n), np.array(force.contents.wrench.torque_nm))
        except BaseException as error:  # pylint: disable=broad-except
            failed(error)

    own = _abi.sized(_abi.Device)
    own.name = device.name.encode()
    own.limits = device.limits.struct()
    own.read, own.write = _abi.READ(read), _abi.WRITE(write)
    return own
