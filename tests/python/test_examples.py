"""The examples run, and say what they should."""

import os
import re
import subprocess
import sys
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[2] / "examples/python"


def output_of(name, *arguments, where):
    done = subprocess.run([sys.executable, str(EXAMPLES / name), *arguments], cwd=where, check=True, capture_output=True, text=True,
                          timeout=200)
    assert not done.stderr, done.stderr
    return done.stdout


def test_dig_and_plot(tmp_path):
    forces = [float(n) for n in re.findall(r"([\d.]+) N at 30 mm", output_of("dig_and_plot.py", "dig.png", where=tmp_path))]
    assert len(forces) == 3 and min(forces) > 1
    assert (tmp_path / "dig.png").read_bytes().startswith(b"\x89PNG")


def test_first_hour(tmp_path):
    assert 1 < float(output_of("first_hour.py", where=tmp_path).split()[0]) < 200


def test_many_scenes(tmp_path):
    told = output_of("many_scenes.py", where=tmp_path)
    assert "64 scenes, 400 ticks each" in told
    mean, spread = re.search(r"feels ([\d.]+) \+- ([\d.]+) N", told).groups()
    assert float(mean) > 1 and 0 < float(spread) < float(mean)


def test_own_device(tmp_path):
    told = output_of("own_device.py", where=tmp_path)
    assert "ended: duration reached" in told
    assert max(float(n) for n in re.findall(r"mm +([\d.]+) N", told)) > 0.2


def test_recording_to_figure(tmp_path):
    program = Path(os.environ["HAPTOLITH_BUILD"]) / "apps/haptolith/haptolith"
    subprocess.run([program, "run", "icra2021", "--motion", "scoop", "--no-realtime", "--duration-s", "4", "--record", "run.h5"], cwd=tmp_path,
                   check=True, capture_output=True)
    told = output_of("recording_to_figure.py", "run.h5", "run.png", where=tmp_path)
    assert float(re.search(r"4000 ticks, ([\d.]+) N at most", told).group(1)) > 1
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")
