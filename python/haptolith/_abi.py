"""libhaptolith as ctypes sees it: structs and signatures of haptolith.h, name by name."""

from __future__ import annotations

import ctypes
import os
from ctypes import (CFUNCTYPE, POINTER, Structure, c_char_p, c_double, c_int32, c_uint32, c_uint64, c_void_p)
from pathlib import Path
from typing import Any

import numpy as np

SONAME = "libhaptolith.so.0.2"


class Error(Structure):
    _fields_ = [("size", c_uint32), ("status", c_int32), ("message", c_char_p), ("key", c_char_p),
                ("value", c_char_p), ("valid", c_char_p)]


class Pose(Structure):
    _fields_ = [("position_m", c_double * 3), ("orientation", c_double * 4)]


class Twist(Structure):
    _fields_ = [("linear_m_s", c_double * 3), ("angular_rad_s", c_double * 3)]


class Wrench(Structure):
    _fields_ = [("force_n", c_double * 3), ("torque_nm", c_double * 3)]


class Array(Structure):
    _fields_ = [("size", c_uint32), ("type", c_int32), ("count", c_uint64), ("components", c_uint32),
                ("stride_bytes", c_uint32), ("data", c_void_p)]


class SceneInfo(Structure):
    _fields_ = [("size", c_uint32), ("substeps", c_uint32), ("threads", c_uint32), ("friction", c_uint32),
                ("particles", c_uint64), ("held", c_uint64), ("awake", c_uint64), ("steps", c_uint64),
                ("tick_s", c_double), ("radius_m", c_double), ("mass_kg", c_double), ("width_m", c_double),
                ("length_m", c_double), ("surface_m", c_double), ("opening_m", c_double), ("tool_fade", c_double),
                ("energy_j", c_double), ("gravity_m_s2", c_double * 3)]


class ToolState(Structure):
    _fields_ = [("size", c_uint32), ("in_soil", c_int32), ("drive", c_int32), ("reserved", c_uint32),
                ("scene_T_tool", Pose), ("scene_T_turned", Pose), ("soil_wrench", Wrench), ("angle_rad", c_double),
                ("speed_rad_s", c_double), ("soil_torque_nm", c_double), ("motor_torque_nm", c_double),
                ("opening_m", c_double), ("grip_force_n", c_double), ("fade", c_double), ("stiffness_n_m", c_double * 9),
                ("force_low_n", c_double), ("force_high_n", c_double)]


class DeviceLimits(Structure):
    _fields_ = [("size", c_uint32), ("turns", c_int32), ("shows_force", c_int32), ("grips", c_int32),
                ("delay_known", c_int32), ("simulated", c_int32), ("max_force_n", c_double),
                ("max_torque_nm", c_double), ("max_gripper_force_n", c_double), ("max_force_rate_n_s", c_double),
                ("max_torque_rate_nm_s", c_double), ("max_gripper_rate_n_s", c_double),
                ("max_stiffness_n_m", c_double), ("max_stiffness_nm_rad", c_double), ("damping_n_s_m", c_double),
                ("turn_rad", c_double * 3), ("workspace_centre_m", c_double * 3), ("workspace_radius_m", c_double),
                ("rate_hz", c_double), ("delay_s", c_double), ("resolution_m", c_double)]


class DeviceInput(Structure):
    _fields_ = [("size", c_uint32), ("state", c_int32), ("pose", Pose), ("twist", Twist), ("gripper_open", c_double),
                ("buttons", c_uint32), ("reserved", c_uint32)]


class DeviceOutput(Structure):
    _fields_ = [("size", c_uint32), ("reserved", c_uint32), ("wrench", Wrench), ("gripper_force_n", c_double)]


PROGRESS = CFUNCTYPE(c_int32, c_void_p, c_char_p, c_double)
READ = CFUNCTYPE(None, c_void_p, POINTER(DeviceInput))
WRITE = CFUNCTYPE(None, c_void_p, POINTER(DeviceOutput))
RELEASE = CFUNCTYPE(None, c_void_p)


class Device(Structure):
    _fields_ = [("size", c_uint32), ("reserved", c_uint32), ("user", c_void_p), ("name", c_char_p),
                ("limits", DeviceLimits), ("read", READ), ("write", WRITE), ("release_force", RELEASE),
                ("resume_force", RELEASE)]


class Snapshot(Structure):
    _fields_ = [("size", c_uint32), ("running", c_int32), ("end", c_char_p), ("trip", c_char_p), ("trips", c_uint32),
                ("paused", c_int32), ("ticks", c_uint64), ("deadline_misses", c_uint64), ("awake", c_uint64),
                ("time_s", c_double), ("scene_T_tool", Pose), ("opening_m", c_double), ("felt", Wrench),
                ("success_rate", c_double), ("tick_us_p50", c_double), ("tick_us_p99", c_double),
                ("tick_us_max", c_double), ("largest_speed_m_s", c_double), ("position", Array),
                ("misses_too_long", c_uint64), ("misses_woken_late", c_uint64), ("misses_preempted", c_uint64),
                ("soil_wrench", Wrench), ("device_wrench", Wrench)]


class Tick(Structure):
    _fields_ = [("size", c_uint32), ("flags", c_uint32), ("trip", c_uint32), ("buttons", c_uint32),
                ("device_state", c_int32), ("tool", c_uint32), ("time_s", c_double), ("device_pose", Pose),
                ("device_twist", Twist), ("gripper_open", c_double), ("scene_T_tool", Pose),
                ("soil_wrench", Wrench), ("rendered", Wrench), ("rendered_gripper_n", c_double),
                ("device_wrench", Wrench), ("device_gripper_n", c_double), ("injected_j", c_double),
                ("quick_injected_j", c_double), ("tick_us", c_double), ("late_us", c_double),
                ("state_hash", c_uint64)]


def _tick_dtype() -> "np.dtype[Any]":
    """hapto_tick, with the names that its fields had before as well (deprecated)."""
    now = np.dtype(Tick)
    assert now.fields is not None
    was = {"soil": "soil_wrench", "felt": "device_wrench", "felt_gripper_n": "device_gripper_n"}
    names = {name: now.fields[name] for name in now.fields} | {old: now.fields[new] for old, new in was.items()}
    return np.dtype({"names": list(names), "formats": [field[0] for field in names.values()],
                     "offsets": [field[1] for field in names.values()], "itemsize": now.itemsize})


TICK = _tick_dtype()


class SafetyInfo(Structure):
    _fields_ = [("size", c_uint32), ("trips", c_uint32), ("flags", c_uint32), ("reserved", c_uint32),
                ("trip", c_char_p), ("injected_j", c_double)]


# The structs by their names in C, for the test that compares their layout.
STRUCTS: dict[str, type[Structure]] = {
    "hapto_error": Error, "hapto_pose": Pose, "hapto_twist": Twist, "hapto_wrench": Wrench, "hapto_array": Array,
    "hapto_scene_info": SceneInfo, "hapto_tool_state": ToolState, "hapto_device_limits": DeviceLimits, "hapto_device_input": DeviceInput,
    "hapto_device_output": DeviceOutput, "hapto_device": Device, "hapto_snapshot": Snapshot, "hapto_tick": Tick,
    "hapto_safety_info": SafetyInfo,
}

OK, INVALID_PARAMETER, FAILURE, STOPPED, NOT_FINITE, COLLAPSED, BUSY, DESTROYED = range(8)
NULL, WRONG_SIZE, TOO_SMALL, NO_MEMORY, ENDED, WRONG_TOOL = range(8, 14)
POSITION, VELOCITY, RADIUS, ASLEEP, HELD, CONTACT_LOAD = range(1, 7)
TICKED_BY_CALLER, KEEPS_TICKS, HASHES = 1, 2, 4

_H = c_void_p  # a handle, or an address
_OUT = POINTER(c_void_p)
_TEXTS = POINTER(c_char_p)
_COUNT = POINTER(c_uint64)
_DOUBLE = POINTER(c_double)

# Arguments of each function; all give a status but those of RESULTS.
SIGNATURES: dict[str, list[Any]] = {
    "hapto_version": [],
    "hapto_version_string": [],
    "hapto_last_error": [POINTER(Error)],
    "hapto_note_error": [c_int32, c_char_p, c_char_p, c_char_p, c_char_p],
    "hapto_status_text": [c_int32],
    "hapto_result_json": [_H, POINTER(c_char_p)],
    "hapto_result_value": [_H, c_char_p, _DOUBLE],
    "hapto_result_column": [_H, c_char_p, POINTER(Array)],
    "hapto_result_destroy": [_H],
    "hapto_list": [c_char_p, _OUT],
    "hapto_scene_from_toml": [c_char_p, c_char_p, _TEXTS, c_uint32, PROGRESS, _H, _OUT],
    "hapto_scene_from_file": [c_char_p, _TEXTS, c_uint32, PROGRESS, _H, _OUT],
    "hapto_scene_clone": [_H, _OUT],
    "hapto_scene_destroy": [_H],
    "hapto_scene_get_info": [_H, POINTER(SceneInfo)],
    "hapto_scene_get_toml": [_H, _H, c_uint64, _COUNT],
    "hapto_scene_place_tool": [_H, _H],
    "hapto_scene_get_tool_pose": [_H, _H],
    "hapto_scene_step": [_H, _H, _H, _H],
    "hapto_scene_steps": [_H, c_uint64, _H, _H, _H, _COUNT],
    "hapto_scene_get_wrench": [_H, _H],
    "hapto_scene_get_contact_stiffness": [_H, _H],
    "hapto_scene_set_opening": [_H, c_double],
    "hapto_scene_get_grip_force": [_H, _DOUBLE],
    "hapto_scene_set_tool_fade": [_H, c_double],
    "hapto_scene_set_gravity": [_H, _H],
    "hapto_scene_change": [_H, _TEXTS, c_uint32],
    "hapto_scene_tools": [_H, POINTER(c_uint32)],
    "hapto_scene_tool_name": [_H, c_uint32, POINTER(c_char_p)],
    "hapto_scene_find_tool": [_H, c_char_p, POINTER(c_uint32)],
    "hapto_scene_step_tools": [_H, _H, _H, c_uint32, _H],
    "hapto_scene_steps_tools": [_H, c_uint64, _H, _H, c_uint32, _H, _COUNT],
    "hapto_scene_tool_place": [_H, c_uint32, _H],
    "hapto_scene_tool_set_opening": [_H, c_uint32, c_double],
    "hapto_scene_tool_set_fade": [_H, c_uint32, c_double],
    "hapto_scene_tool_set_drive": [_H, c_uint32, c_double],
    "hapto_scene_tool_get_state": [_H, c_uint32, POINTER(ToolState)],
    "hapto_scene_view": [_H, c_int32, POINTER(Array)],
    "hapto_scene_copy": [_H, c_int32, _H, c_uint64],
    "hapto_scene_get_state": [_H, _H, c_uint64, _COUNT],
    "hapto_scene_set_state": [_H, _H, c_uint64],
    "hapto_scene_from_state": [_H, c_uint64, _OUT],
    "hapto_scene_state_hash": [_H, _COUNT],
    "hapto_batch_create": [_OUT, c_uint32, c_uint32, _OUT],
    "hapto_batch_step": [_H, c_uint64, _H, _H, _H, _H],
    "hapto_batch_step_tools": [_H, c_uint64, _H, _H, c_uint64, _H, _H],
    "hapto_batch_destroy": [_H],
    "hapto_soil_find": [c_char_p, _OUT],
    "hapto_soil_from_toml": [c_char_p, c_char_p, _OUT],
    "hapto_soil_destroy": [_H],
    "hapto_soil_get": [_H, c_char_p, _DOUBLE],
    "hapto_soil_get_toml": [_H, _H, c_uint64, _COUNT],
    "hapto_soil_profile": [_H, c_double, c_double, _OUT],
    "hapto_soil_calibrate": [c_char_p, PROGRESS, _H, _OUT, _OUT],
    "hapto_scene_trust": [_H, c_char_p, PROGRESS, _H, _OUT],
    "hapto_lab_test": [c_char_p, _H, c_char_p, PROGRESS, _H, _OUT],
    "hapto_psychometric_fit": [_H, c_uint64, c_char_p, _OUT],
    "hapto_device_limits_init": [POINTER(DeviceLimits)],
    "hapto_loop_create": [_H, POINTER(Device), c_uint32, _OUT],
    "hapto_loop_create_tools": [_H, POINTER(POINTER(Device)), c_uint32, c_uint32, _OUT],
    "hapto_loop_start": [_H],
    "hapto_loop_tick": [_H, c_int32],
    "hapto_loop_stop": [_H],
    "hapto_loop_destroy": [_H],
    "hapto_loop_snapshot": [_H, POINTER(Snapshot)],
    "hapto_loop_get_tool": [_H, c_uint32, POINTER(ToolState)],
    "hapto_loop_take_ticks": [_H, _H, c_uint64, _COUNT, _COUNT],
    "hapto_loop_get_header": [_H, c_void_p, c_uint64, _COUNT],
    "hapto_loop_pause": [_H, c_int32],
    "hapto_loop_change": [_H, _TEXTS, c_uint32],
    "hapto_safety_create": [POINTER(DeviceLimits), _TEXTS, c_uint32, c_double, c_double, _OUT],
    "hapto_safety_step": [_H, POINTER(DeviceInput), c_int32, POINTER(DeviceOutput)],
    "hapto_safety_get_info": [_H, POINTER(SafetyInfo)],
    "hapto_safety_stop": [_H],
    "hapto_safety_destroy": [_H],
}
RESULTS: dict[str, Any] = {"hapto_version": c_uint32, "hapto_version_string": c_char_p, "hapto_status_text": c_char_p}


def load(soname: str, signatures: dict[str, list[Any]], results: dict[str, Any]) -> ctypes.CDLL:
    """Finds a library: at HAPTOLITH_LIBRARY, in the prefix of this package, or by the system."""
    named = os.environ.get("HAPTOLITH_LIBRARY")
    folders = [Path(named).resolve().parent] if named else list(Path(__file__).resolve().parents[:5])
    found = next((str(folder / soname) for folder in folders if (folder / soname).exists()), soname)
    try:
        loaded = ctypes.CDLL(named if named and soname == SONAME else found)
    except OSError as error:
        raise ImportError(f"{error}; install it (./dev install, or its Debian package), or name libhaptolith.so in "
                          "HAPTOLITH_LIBRARY") from error
    for name, arguments in signatures.items():
        function = getattr(loaded, name)
        function.argtypes = arguments
        function.restype = results.get(name, c_int32)
    return loaded


lib = load(SONAME, SIGNATURES, RESULTS)


def library_version() -> str:
    """The library's version, for example "0.2.0"."""
    text: bytes = lib.hapto_version_string()
    return text.decode()


def sized(struct: type[Any]) -> Any:
    """A struct with its size in it."""
    value = struct()
    value.size = ctypes.sizeof(struct)
    return value


def texts(given: list[str]) -> Any:
    """An array of C texts."""
    return (c_char_p * len(given))(*[text.encode() for text in given])
