"""Examples of other languages hold the tool of a running program by UDP, and receive the force that it reports."""
import contextlib
import json
import os
import re
import shutil
import signal
import socket
import subprocess
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


def wait_for_listener(port, process):
    """An empty packet to an unused port returns an error."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as knock:
        knock.connect(("127.0.0.1", port))
        knock.settimeout(0.2)
        for _ in range(100):
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
