"""Recordings, written and read in Python."""

import subprocess
import sys
import time

import numpy as np
import pytest

import haptolith as hp
from conftest import CONTACT, ICRA2021
from haptolith.recording import Recorder, Recording


class Stirs(hp.Device):
    """A hand that stirs."""

    name = "stirs"

    def __init__(self):
        self.ticks = 0

    def read(self):
        self.ticks += 1
        t = 1e-3 * self.ticks
        return hp.DeviceInput(position_m=(0.015 * np.sin(6 * t), 0, -0.02 - 0.01 * np.sin(9 * t)))


def recorded(path, scene, ticks=300):
    with hp.Loop(scene, Stirs(), ticked_by_caller=True, keep_ticks=True) as loop, Recorder(loop, path) as recorder:
        for tick in range(ticks):
            assert loop.tick()
            if tick % 50 == 49:
                recorder.take()
        recorder.note("mark", "the end is near")
    return path


@pytest.mark.parametrize("toml", [ICRA2021, CONTACT], ids=["icra2021", "contact"])
def test_what_was_recorded_is_run_again_to_the_last_bit(tmp_path, toml):
    path = recorded(tmp_path / "run.h5", hp.Scene.from_toml(toml, mapping__offset_mm=[0, 0, 20]))
    with Recording(path) as recording:
        assert recording.finished and len(recording) == 300 and recording.missing_ticks == 0
        replay = recording.verify()
        assert replay.same and replay.ticks == replay.hashes == 300 and not replay.ended_early
        ticks = recording.ticks
        assert ticks["time_s"][-1] == 0.3 and np.all(np.diff(ticks["time_s"]) > 0)
        assert np.abs(ticks["soil"]["force_n"]).max() > 0.1
        time_s, places = recording.frame(-1)
        assert 0 < time_s <= 0.3 and places.shape[1] == 3 and np.isfinite(places).all()
        assert [event["kind"] for event in recording.events] == ["mark"]
        assert recording.header["device"] == "stirs" and "[soil]" in recording.header["scenario"]
        with pytest.raises(IndexError):
            recording.frame(10_000)
    with pytest.raises(hp.HaptolithError, match="closed"):
        recording.ticks


def test_nothing_is_overwritten_unasked(tmp_path):
    path = recorded(tmp_path / "run.h5", hp.Scene.from_toml(ICRA2021), 50)
    scene = hp.Scene.from_toml(ICRA2021)
    with hp.Loop(scene, Stirs(), ticked_by_caller=True, keep_ticks=True) as loop:
        with pytest.raises(hp.Failure, match="run.h5"):
            Recorder(loop, path)
    with hp.Loop(scene, Stirs(), ticked_by_caller=True) as loop:
        with pytest.raises(hp.InvalidParameter, match="KEEPS_TICKS"):
            Recorder(loop, tmp_path / "other.h5")
    with pytest.raises(hp.Failure, match="none.h5"):
        Recording(tmp_path / "none.h5")


def test_the_programs_recordings_are_read_beside_h5py(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = recorded(tmp_path / "run.h5", hp.Scene.from_toml(ICRA2021), 120)
    with h5py.File(path) as file, Recording(path) as recording:
        assert np.array_equal(file["ticks"]["soil_fz_n"][:], recording.ticks["soil"]["force_n"][:, 2])
        assert np.array_equal(file["ticks"]["state_hash"][:], recording.ticks["state_hash"])
        assert recording.verify().same


def test_of_a_started_loop(tmp_path):
    scene = hp.Scene.from_toml(ICRA2021, loop__real_time=False, loop__duration_s=1)
    with hp.Loop(scene, keep_ticks=True) as loop, Recorder(loop, tmp_path / "run.h5", frames_per_s=60) as recorder:
        loop.start()
        while loop.snapshot().running:
            recorder.take()
            time.sleep(0.005)
    with Recording(tmp_path / "run.h5") as recording:
        assert recording.verify().ticks == 1000
        assert recording.events[-1] == {"time_s": 1.0, "tick": 1000, "kind": "end", "text": "duration reached"}


def test_hdf5_is_loaded_only_for_recordings():
    code = "import haptolith; print('libhdf5' in open('/proc/self/maps').read())"
    assert subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout == "False\n"
