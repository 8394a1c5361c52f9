"""Examples of other languages hold the tool of a running program by UDP, and receive the force that it reports."""
import contextlib
import json
import math
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
EXAMPLES = SOURCE / "examples"
SECONDS = ("4", "8", "16")  # duration of a path; a busy machine gets more time
HEIGHT_MM = "-92"  # of the path, in the device's frame: 7 mm below the soil's surface


def needed(program, package):
    found = shutil.which(program)
    if found is None:
        pytest.skip(f"there is no {program}: apt-get install {package}")
    return found


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        return taken.getsockname()[1]


def wait_for_listener(port, process, tenths=100):
    """An empty packet to an unused port returns an error."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as knock:
        knock.connect(("127.0.0.1", port))
        knock.settimeout(0.2)
        for _ in range(tenths):
            assert process.poll() is None, process.stderr.read()
            try:
                knock.send(b"")
                knock.recv(1)
            except ConnectionRefusedError:
                time.sleep(0.1)
            except TimeoutError:
                return
    raise AssertionError("the network device does not listen")


@contextlib.contextmanager
def running(folder):
    """The program with a network device: (its address, a function that ends it and gives its summary)."""
    port = free_port()
    arguments = ["run", "icra2021", "--device", "network", "--device-address", f"127.0.0.1:{port}", "--json", "--no-serve"]
    process = subprocess.Popen([os.environ["HAPTOLITH"], *arguments], cwd=folder, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def summary():
        process.send_signal(signal.SIGINT)
        return json.loads(process.communicate(timeout=20)[0])

    try:
        wait_for_listener(port, process)
        yield f"127.0.0.1:{port}", summary
    finally:
        process.kill()
        process.wait()


def digs_by_udp(command, folder):
    """Output of an example that is started with address, seconds and height after `command`."""
    for seconds in SECONDS:
        with running(folder) as (address, summary):
            done = subprocess.run(command(address, seconds), cwd=folder, env={**os.environ, "HOME": str(folder)}, text=True,
                                  capture_output=True, timeout=60, check=False)
            rendered = summary()["force_n"]["max"]
        said = done.stdout + done.stderr
        if "the tool has felt nothing" in said:  # each packet was late, or each answer
            continue
        assert done.returncode == 0, said
        found = re.search(r"(\d+) packets sent, (\d+) answers, strongest force (\d+\.\d+) N", done.stdout)
        assert found, said
        received = float(found[3])
        assert received < rendered + 0.001, (said, rendered)  # an answer may be lost; none reports more than was rendered
        if min(int(found[1]), int(found[2])) > 500 and 0.5 * rendered < received and rendered > 0.05:
            return done.stdout
    raise AssertionError(f"the tool was not in the soil, or answers were lost: {rendered} N were rendered; {said}")


def test_c(tmp_path):
    compiler = needed("gcc", "gcc")
    subprocess.run([compiler, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wno-missing-field-initializers", "-Werror",
                    f"-I{SOURCE / 'include'}", EXAMPLES / "c/network_device.c", "-o", tmp_path / "circle", "-lm"], check=True)
    said = digs_by_udp(lambda address, seconds: [tmp_path / "circle", address, seconds, HEIGHT_MM], tmp_path)
    assert "live" in said


def test_csharp(tmp_path):
    compiler, runtime = needed("mcs", "mono-mcs"), needed("mono", "mono-runtime")
    subprocess.run([compiler, "-warnaserror", EXAMPLES / "csharp/NetworkDevice.cs", f"-out:{tmp_path / 'circle.exe'}"], check=True)
    said = digs_by_udp(lambda address, seconds: [runtime, tmp_path / "circle.exe", address, seconds, HEIGHT_MM], tmp_path)
    assert "live" in said


def test_matlab(tmp_path):
    """In Octave, whose package instrument-control has MATLAB's udpport."""
    octave = needed("octave-cli", "octave octave-instrument-control")
    if subprocess.run([octave, "--eval", "pkg load instrument-control"], capture_output=True, check=False).returncode != 0:
        pytest.skip("Octave has no package instrument-control: apt-get install octave-instrument-control")
    folder = EXAMPLES / "matlab"
    digs_by_udp(lambda address, seconds: [octave, "--path", folder, "--eval", "pkg load instrument-control; "
                                 f"circle({address.split(':')[1]}, {seconds}, {HEIGHT_MM})"], tmp_path)


def test_godot(tmp_path):
    """Without a picture."""
    godot = needed("godot3-server", "godot3-server")
    digs_by_udp(lambda address, seconds: [godot, "--path", EXAMPLES / "godot", f"--address={address}", f"--seconds={seconds}",
                                 f"--height-mm={HEIGHT_MM}"], tmp_path)


def test_nobody(tmp_path):
    """Without a listener the example reports so, with a remedy."""
    compiler = needed("gcc", "gcc")
    subprocess.run([compiler, f"-I{SOURCE / 'include'}", EXAMPLES / "c/network_device.c", "-o", tmp_path / "circle", "-lm"], check=True)
    done = subprocess.run([tmp_path / "circle", f"127.0.0.1:{free_port()}", "2"], text=True, capture_output=True, timeout=20, check=False)
    assert done.returncode == 1
    assert "nobody answers" in done.stderr


def test_poses(tmp_path):
    """The Python example follows a file in simulated time: by the number of answers, whatever the clock says."""
    length_m, duration_s = 0.1, 0.4
    (tmp_path / "poses.csv").write_text("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n"
                                        "5,0.02,0.03,0.05,1,0,0,0\n"
                                        f"5.4,0.12,0.03,0.05,{math.cos(math.pi / 4)},0,{math.sin(math.pi / 4)},0\n")
    packets = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
        server.bind(("127.0.0.1", 0))
        server.settimeout(0.5)
        example = subprocess.Popen([sys.executable, EXAMPLES / "network_device.py", "--address", f"127.0.0.1:{server.getsockname()[1]}",
                                    "--poses", tmp_path / "poses.csv", "--origin-mm", "20", "30", "0"], stdout=subprocess.PIPE, text=True)
        try:
            ends = time.monotonic() + 60
            while example.poll() is None and time.monotonic() < ends:
                if len(packets) == 200:
                    time.sleep(0.5)  # the simulation pauses for longer than the file lasts
                with contextlib.suppress(TimeoutError):
                    packet, sender = server.recvfrom(200)
                    tick = len(packets)
                    packets.append(struct.unpack("<4sHHIIQ 3d4d3d3d d", packet))
                    server.sendto(struct.pack("<4sHHIIQ 3d3d d", b"HLAN", 1, 1, 0, tick, time.monotonic_ns(), *[0] * 7), sender)
            assert example.poll() == 0
        finally:
            example.kill()
            said = example.communicate()[0]
    assert "strongest force 0.000 N" in said
    for tick, (_, _, held, _, _, _, x, y, z, w, *axis, vx, vy, vz, wx, wy, wz, _) in enumerate(packets):
        assert held == 1
        assert -1e-9 < x < length_m * min(tick / (1000 * duration_s), 1) + 1e-9
        assert (y, z) == pytest.approx((0, 0.05))
        assert (w, *axis) == pytest.approx((math.cos(math.pi / 4 * x / length_m), 0, math.sin(math.pi / 4 * x / length_m), 0), abs=1e-6)
        if x < 0.99 * length_m:  # it stops within the next millisecond
            assert (vx, vy, vz) == pytest.approx((length_m / duration_s, 0, 0), abs=1e-6)
            assert (wx, wy, wz) == pytest.approx((0, math.pi / 2 / duration_s, 0), abs=1e-3)
    xs = [packet[6] for packet in packets]
    assert xs == sorted(xs)


def passes_a_load(folder):
    """Two network devices lead two scoops; returns the recording, as read by h5py."""
    h5py = pytest.importorskip("h5py", reason="there is no h5py: apt-get install python3-h5py")
    ports = {"left": free_port(), "right": free_port()}
    program = subprocess.Popen(
        [os.environ["HAPTOLITH"], "run", EXAMPLES / "scenes/pass-a-load.toml", "--set", "soil.radius_mm=6", "--set", "coupling.kind=direct",
         "--set", "safety.max_missed_deadlines=1000", "--set", "safety.watchdog_timeout_ms=1000",  # no person feels it
         *[word for hand, port in ports.items() for word in ("--device", f"{hand}=network:{port}")],
         "--record", folder / "run.h5", "--overwrite", "--no-serve"], cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    hands = []
    try:
        for port in ports.values():
            wait_for_listener(port, program, 1000)  # the soil settles first
        hands += [subprocess.Popen([sys.executable, EXAMPLES / "network_device.py", "--address", f"127.0.0.1:{port}",
                                    "--poses", EXAMPLES / f"scenes/network-{hand}.csv"], stdout=subprocess.PIPE, text=True)
                  for hand, port in ports.items()]
        for hand in hands:
            said = hand.communicate(timeout=150)[0]
            assert hand.returncode == 0 and "strongest force" in said, said
        program.send_signal(signal.SIGINT)
        said = program.communicate(timeout=60)
        assert program.returncode == 0, said
    finally:
        for process in (program, *hands):
            process.kill()
            process.wait()
    return h5py.File(folder / "run.h5")


def load(ticks, frame, position):
    """Number of particles in a scoop."""
    tick = ticks[int(frame["tick"]) - 1]
    w, x, y, z = (tick[f"tool_q{axis}"] for axis in "wxyz")
    to_tool = [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
               [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
               [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]]
    first = int(frame["first"])
    places = position[first:first + int(frame["count"])] - [tick[f"tool_{axis}_m"] for axis in "xyz"]
    places = places @ list(zip(*to_tool))
    return sum((abs(places[:, 0]) < 0.03) & (abs(places[:, 1]) < 0.0225) & (places[:, 2] > -0.011) & (places[:, 2] < 0.02))


def test_pass_a_load(tmp_path):
    """One scoop tips its load into the other, each led by a Python program. A tool drops its load when other programs delay
    its hand by 20 ms: the hand trips. Such a run is repeated, and so is one whose hands did not begin together."""
    begin = time.monotonic()
    while time.monotonic() - begin < 200:
        try:
            recording = passes_a_load(tmp_path)
        except subprocess.TimeoutExpired:
            break
        with recording:
            left, right = recording["ticks"][:], recording["tools/right/ticks"][:]
            frames, position = recording["particles/frames"][:], recording["particles/position"][:]
        live = [ticks["device_state"] == 0 for ticks in (left, right)]
        assert live[0].any() and live[1].any(), "a hand was never live"
        held = [hand & (ticks["trip"] == 0) for hand, ticks in zip(live, (left, right))]
        if not (held[0].any() and held[1].any()):
            continue
        first, last = zip(*[hand.nonzero()[0][[0, -1]].tolist() for hand in held])
        if abs(first[0] - first[1]) > 500 or any(not hand[a:b].all() for hand, a, b in zip(held, first, last)):
            continue
        both = [frame for frame in frames if max(first) < frame["tick"] <= min(last)]
        lifted = [frame for frame in both if left["tool_z_m"][int(frame["tick"]) - 1] > 0.1335 and load(right, frame, position) == 0]
        assert max(load(left, frame, position) for frame in lifted) > 15
        assert load(left, both[-1], position) == 0, "tipped out"
        assert right["tool_x_m"][int(both[-1]["tick"]) - 1] > 0.08
        assert load(right, both[-1], position) > 20, "carried away"
        return
    pytest.skip("this machine is too busy to hold two hands for 12 s")
