"""Recordings: of a loop, written; of haptolith's, read and run again. Needs libhaptolith_recording, which brings HDF5."""

from __future__ import annotations

import ctypes
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _abi
from ._long import Progress, call_long
from ._owned import Owned
from .errors import require
from .loop import Loop
from .values import text_from

_H, _COUNT = ctypes.c_void_p, ctypes.POINTER(ctypes.c_uint64)


class RecorderInfo(ctypes.Structure):
    """Amount that is safe in the file; see recording.h."""

    _fields_ = [("size", ctypes.c_uint32), ("reserved", ctypes.c_uint32), ("ticks", ctypes.c_uint64),
                ("frames", ctypes.c_uint64), ("events", ctypes.c_uint64), ("bytes", ctypes.c_uint64),
                ("missing", ctypes.c_uint64), ("frames_left_out", ctypes.c_uint64)]

    def __repr__(self) -> str:
        return (f"RecorderInfo(ticks={self.ticks}, frames={self.frames}, events={self.events}, bytes={self.bytes}, "
                f"missing={self.missing}, frames_left_out={self.frames_left_out})")


class _Info(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("finished", ctypes.c_int32), ("ticks", ctypes.c_uint64),
                ("frames", ctypes.c_uint64), ("events", ctypes.c_uint64), ("missing_ticks", ctypes.c_uint64),
                ("start_tick", ctypes.c_uint64), ("tick_s", ctypes.c_double)]


class _Frame(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("reserved", ctypes.c_uint32), ("time_s", ctypes.c_double),
                ("tick", ctypes.c_uint64), ("particles", ctypes.c_uint64)]


class _Report(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("same", ctypes.c_int32), ("ticks", ctypes.c_uint64),
                ("hashes", ctypes.c_uint64), ("different_tick", ctypes.c_uint64), ("different", ctypes.c_char_p),
                ("ended_early", ctypes.c_char_p), ("missing", ctypes.c_uint64)]


STRUCTS = {"hapto_recorder_info": RecorderInfo, "hapto_recording_info": _Info, "hapto_recorded_frame": _Frame,
           "hapto_replay_report": _Report}
SIGNATURES: dict[str, list[Any]] = {
    "hapto_recorder_create": [_H, ctypes.c_char_p, ctypes.c_double, ctypes.c_uint32, ctypes.POINTER(_H)],
    "hapto_recorder_take": [_H],
    "hapto_recorder_note": [_H, ctypes.c_char_p, ctypes.c_char_p],
    "hapto_recorder_finish": [_H],
    "hapto_recorder_get_info": [_H, ctypes.POINTER(RecorderInfo)],
    "hapto_recorder_destroy": [_H],
    "hapto_recording_open": [ctypes.c_char_p, ctypes.POINTER(_H)],
    "hapto_recording_get_info": [_H, ctypes.POINTER(_Info)],
    "hapto_recording_get_header": [_H, _H, ctypes.c_uint64, _COUNT],
    "hapto_recording_get_events": [_H, _H, ctypes.c_uint64, _COUNT],
    "hapto_recording_read_ticks": [_H, ctypes.c_uint64, _H, ctypes.c_uint64, _COUNT],
    "hapto_recording_read_frame": [_H, ctypes.c_uint64, ctypes.POINTER(_Frame), _H, ctypes.c_uint64],
    "hapto_recording_verify": [_H, ctypes.c_uint32, _abi.PROGRESS, _H, ctypes.POINTER(_Report)],
    "hapto_recording_destroy": [_H],
}
_lib = _abi.load("libhaptolith_recording.so.0.2", SIGNATURES, {})


class Recorder(Owned):
    """Records a loop that was made with keep_ticks=True: with hp.Recorder(loop, "run.h5") as recorder: ... take().

    path: ends in .h5. Begun before the first tick, of a scene that nobody has stepped, the recording can be run again.
    frames_per_s: pictures of all particles, 0 to 60. Raises Failure for a file that is there, unless overwrite=True."""

    _destroy = _lib.hapto_recorder_destroy
    _held: Optional[Loop] = None

    def __init__(self, loop: Loop, path: Union[str, os.PathLike[str]], *, frames_per_s: float = 10,
                 overwrite: bool = False) -> None:
        out = ctypes.c_void_p()
        require(_lib.hapto_recorder_create(loop.address, os.fsencode(path), frames_per_s, int(overwrite),
                                           ctypes.byref(out)))
        self._handle = out.value
        self._held = loop
        self.path = Path(path)

    def __repr__(self) -> str:
        if not self._handle:
            return f"<haptolith.Recorder {self.path}, closed>"
        info = self.info
        return f"<haptolith.Recorder {self.path}: {info.ticks} ticks, {info.frames} frames, {info.bytes} bytes>"

    def take(self) -> None:
        """Takes what is new into the file: call it every second or more often. Raises Failure when the disk is full."""
        require(_lib.hapto_recorder_take(self.address))

    def note(self, kind: str, text: str) -> None:
        """Something that happened, at the time of the last tick that was taken; kind is one word."""
        require(_lib.hapto_recorder_note(self.address, kind.encode(), text.encode()))

    def finish(self) -> None:
        """Takes what is new and closes the file. Raises Failure when not all is in it."""
        require(_lib.hapto_recorder_finish(self.address))

    @property
    def info(self) -> RecorderInfo:
        """Amount that is safe in the file: ticks, frames, events, bytes, missing, frames_left_out."""
        info = _abi.sized(RecorderInfo)
        require(_lib.hapto_recorder_get_info(self.address, info))
        return info  # type: ignore[no-any-return]

    def __exit__(self, *raised: Any) -> None:
        try:
            if raised[0] is None:
                self.finish()
        finally:
            self.close()


@dataclass(frozen=True)
class Replay:
    """Result of a replay; see hapto_replay_report. same: every replayed tick was bit-identical."""

    same: bool
    ticks: int
    hashes: int
    different_tick: int
    different: str
    ended_early: str
    missing: int


class Recording(Owned):
    """A recording of haptolith's, also one whose program was killed: recording.ticks["soil_wrench"]["force_n"]
    in the scene frame, recording.ticks["device_wrench"]["force_n"] in the device frame.

    Raises Failure for what is none."""

    _destroy = _lib.hapto_recording_destroy

    def __init__(self, path: Union[str, os.PathLike[str]]) -> None:
        self.path = Path(path)
        out = ctypes.c_void_p()
        require(_lib.hapto_recording_open(os.fsencode(path), ctypes.byref(out)))
        self._handle = out.value
        info = _abi.sized(_Info)
        require(_lib.hapto_recording_get_info(self.address, info))
        self.finished, self.frames, self.missing_ticks = bool(info.finished), int(info.frames), int(info.missing_ticks)
        self.start_tick, self.tick_s, self._ticks = int(info.start_tick), float(info.tick_s), int(info.ticks)

    @property
    def header(self) -> dict[str, Any]:
        """scenario (the scene as TOML), title, program_version, arithmetic, device, host, started_utc, seed, ..."""
        loaded: dict[str, Any] = json.loads(self._text(_lib.hapto_recording_get_header))
        return loaded

    @property
    def events(self) -> list[dict[str, Any]]:
        """Events: time_s, tick, kind, text."""
        loaded: list[dict[str, Any]] = json.loads(self._text(_lib.hapto_recording_get_events))
        return loaded

    def _text(self, get: Any) -> str:
        return text_from(lambda out, room, needed: int(get(self.address, out, room, needed)))[:-1].decode()

    @property
    def ticks(self) -> npt.NDArray[Any]:
        """All ticks, (n,), with the names of hapto_tick: ticks["time_s"], ticks["soil_wrench"]["force_n"][:, 2]."""
        read = np.zeros(self._ticks, dtype=_abi.TICK)
        count = ctypes.c_uint64()
        if self._ticks:
            require(_lib.hapto_recording_read_ticks(self.address, 0, read.ctypes.data, self._ticks, ctypes.byref(count)))
        return read[: count.value]

    def frame(self, index: int) -> tuple[float, npt.NDArray[np.float32]]:
        """A picture of all particles: its time in s, and where they were, (particles, 3) m. Negative: from the end."""
        at = index + self.frames if index < 0 else index
        if not 0 <= at < self.frames:
            raise IndexError(f"picture {index}: there are {self.frames}")
        frame = _abi.sized(_Frame)
        require(_lib.hapto_recording_read_frame(self.address, at, frame, None, 0))
        places = np.empty((frame.particles, 3), np.float32)
        require(_lib.hapto_recording_read_frame(self.address, at, frame, places.ctypes.data, places.size))
        return float(frame.time_s), places

    def verify(self, threads: int = 0, progress: Optional[Progress] = None) -> Replay:
        """Runs it again and compares hashes of the soil and forces in every tick, bit by bit.

        threads: that share a tick; 0: as recorded. Raises Failure when it cannot be run again."""
        report = _abi.sized(_Report)
        address = self.address
        call_long(lambda told: int(_lib.hapto_recording_verify(address, threads, told, None, report)), progress)
        return Replay(bool(report.same), report.ticks, report.hashes, report.different_tick,
                      (report.different or b"").decode(), (report.ended_early or b"").decode(), report.missing)

    def __len__(self) -> int:
        return self._ticks

    def __repr__(self) -> str:
        state = "" if self.finished else ", not finished"
        missing = f", {self.missing_ticks} missing" if self.missing_ticks else ""
        return (f"<haptolith.Recording {self.path}: {self._ticks} ticks, {self._ticks * self.tick_s:g} s, {self.frames} frames"
                f"{missing}{state}{'' if self._handle else ', closed'}>")
