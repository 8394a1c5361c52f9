"""Examples of other languages hold the tool of a running program by UDP, and feel what it says that the hand felt."""
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
SECONDS = "4"
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
    """An empty packet to a port that nobody listens at comes back as an error."""
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
    arguments = ["run", "paper", "--device", "network", "--device-address", f"127.0.0.1:{port}", "--json", "--no-serve"]
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
    """What an example prints that is started with address, seconds and height behind `command`."""
    with running(folder) as (address, summary):
        done = subprocess.run(command(address), cwd=folder, env={**os.environ, "HOME": str(folder)}, text=True, capture_output=True,
                              timeout=60, check=False)
        felt = summary()["force_n"]["max"]
    assert done.returncode == 0, done.stdout + done.stderr
    told = re.search(r"(\d+) packets sent, (\d+) answers, strongest force (\d+\.\d+) N", done.stdout)
    assert told, done.stdout + done.stderr
    assert min(int(told[1]), int(told[2])) > 500, told[0]
    assert felt > 0.05, "the tool was not in the soil"
    # An answer may be lost, or come with another; none tells of more than was felt.
    assert 0.5 * felt < float(told[3]) < felt + 0.001, (told[0], felt)
    return done.stdout


def test_c(tmp_path):
    compiler = needed("gcc", "gcc")
    subprocess.run([compiler, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wno-missing-field-initializers", "-Werror",
                    f"-I{SOURCE / 'include'}", EXAMPLES / "c/network_device.c", "-o", tmp_path / "circle", "-lm"], check=True)
    said = digs_by_udp(lambda address: [tmp_path / "circle", address, SECONDS, HEIGHT_MM], tmp_path)
    assert "live" in said


def test_csharp(tmp_path):
    compiler, runtime = needed("mcs", "mono-mcs"), needed("mono", "mono-runtime")
    subprocess.run([compiler, "-warnaserror", EXAMPLES / "csharp/NetworkDevice.cs", f"-out:{tmp_path / 'circle.exe'}"], check=True)
    said = digs_by_udp(lambda address: [runtime, tmp_path / "circle.exe", address, SECONDS, HEIGHT_MM], tmp_path)
    assert "live" in said


def test_matlab(tmp_path):
    """In Octave, whose package instrument-control has MATLAB's udpport."""
    octave = needed("octave-cli", "octave octave-instrument-control")
    if subprocess.run([octave, "--eval", "pkg load instrument-control"], capture_output=True, check=False).returncode != 0:
        pytest.skip("Octave has no package instrument-control: apt-get install octave-instrument-control")
    folder = EXAMPLES / "matlab"
    digs_by_udp(lambda address: [octave, "--path", folder, "--eval", "pkg load instrument-control; "
                                 f"circle({address.split(':')[1]}, {SECONDS}, {HEIGHT_MM})"], tmp_path)


def test_godot(tmp_path):
    """Without a picture."""
    godot = needed("godot3-server", "godot3-server")
    digs_by_udp(lambda address: [godot, "--path", EXAMPLES / "godot", f"--address={address}", f"--seconds={SECONDS}",
                                 f"--height-mm={HEIGHT_MM}"], tmp_path)


def test_nobody(tmp_path):
    """Who finds nobody says so, and what to do."""
    compiler = needed("gcc", "gcc")
    subprocess.run([compiler, f"-I{SOURCE / 'include'}", EXAMPLES / "c/network_device.c", "-o", tmp_path / "circle", "-lm"], check=True)
    done = subprocess.run([tmp_path / "circle", f"127.0.0.1:{free_port()}", "2"], text=True, capture_output=True, timeout=20, check=False)
    assert done.returncode == 1
    assert "nobody answers" in done.stderr
