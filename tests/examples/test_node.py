"""The protocol's package, packed as it would be published: its examples against the program, and its types."""
import json
import os
import re
import shutil
import signal
import subprocess
import tarfile
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
WEB = SOURCE / "web"
TOKEN = "a-token-of-24-characters"


@pytest.fixture(scope="module", name="folder")
def a_folder_with_the_package(tmp_path_factory):
    """As `npm install` would make it, without a network."""
    for program in ("node", "npm"):
        if shutil.which(program) is None:
            pytest.skip(f"there is no {program}: apt-get install {program.replace('node', 'nodejs')}")
    if not (WEB / "node_modules/ws").exists():
        pytest.skip("the page's packages are not installed: cd web && npm ci")
    folder = tmp_path_factory.mktemp("node")
    environment = {**os.environ, "npm_config_cache": str(folder / "cache"), "npm_config_update_notifier": "false"}
    subprocess.run(["npm", "pack", "--silent", "--workspace", "haptolith-protocol", "--pack-destination", folder], cwd=WEB,
                   env=environment, check=True)
    packages = folder / "node_modules"
    packages.mkdir()
    with tarfile.open(next(folder.glob("haptolith-protocol-*.tgz"))) as packed:
        packed.extractall(folder)
    (folder / "package").rename(packages / "haptolith-protocol")
    for name in ("valibot", "ws"):
        (packages / name).symlink_to(WEB / "node_modules" / name)
    shutil.copy(SOURCE / "examples/node/watch.mjs", folder)
    return folder


@pytest.fixture(name="program")
def a_running_program(tmp_path):
    """A scoop that is watched by who knows the token: (address of its WebSocket, a function that ends it and gives its summary)."""
    process = subprocess.Popen([os.environ["HAPTOLITH"], "run", "icra2021", "--motion", "scoop", "--serve", "--port", "0", "--json"],
                               cwd=tmp_path, env={**os.environ, "HAPTOLITH_TOKEN": TOKEN}, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def summary():
        process.send_signal(signal.SIGINT)
        return json.loads(process.communicate(timeout=20)[0])

    try:
        for line in process.stderr:
            if found := re.search(r"http://(127\.0\.0\.1:\d+)/", line):
                break
        else:
            raise AssertionError("the program does not say where its page is")
        yield f"ws://{found[1]}/ws", summary
    finally:
        process.kill()
        process.wait()


def watch(folder, *options):
    return subprocess.run(["node", "watch.mjs", *options], cwd=folder, text=True, capture_output=True, timeout=60, check=False)


def test_example_sees_what_the_program_says(folder, program):
    address, summary = program
    done = watch(folder, "--address", address, "--token", TOKEN, "--seconds", "4")
    told = summary()
    assert done.returncode == 0, done.stdout + done.stderr
    seen = re.search(r"(\d+) frames, .*: (\d+) particles, (\d+) awake, force \S+ N, strongest (\S+) N", done.stdout)
    assert seen, done.stdout
    assert "The scene of the ICRA 2021 paper: 256 particles" in done.stdout
    assert "refused" not in done.stdout
    assert int(seen[1]) > 20
    assert int(seen[2]) == told["particles"] == 256
    # Frames are pictures of some ticks only.
    assert 0 < float(seen[4]) <= told["force_n"]["max"] + 1e-4


def test_example_says_why_it_sees_nothing(folder, program):
    address, _ = program
    for options in ([], ["--token", "another-token-of-30-characters"]):
        done = watch(folder, "--address", address, *options)
        assert done.returncode == 1, done.stdout
        assert "no connection" in done.stderr and "nothing came" in done.stderr


def test_readme(folder, program):
    """Its example prints the requested data, until it is ended."""
    address, _ = program
    code = re.search(r"```js\n(.*?)```", (WEB / "protocol/README.md").read_text(), re.DOTALL)[1]
    (folder / "readme.mjs").write_text(code)
    example = subprocess.Popen(["node", "readme.mjs", f"{address}?token={TOKEN}"], cwd=folder, text=True, stdout=subprocess.PIPE)
    try:
        lines = [example.stdout.readline() for _ in range(5)]
    finally:
        example.kill()
        example.wait()
    assert lines[0] == "The scene of the ICRA 2021 paper 256\n"
    assert re.fullmatch(r"[\d.]+ s \d+ awake( -?[\d.e-]+){3} N\n", lines[4]), lines


def test_types(folder):
    """They come with the package: what is wrong does not compile."""
    compiler = WEB / "node_modules/.bin/tsc"
    options = ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext"]

    def complaints(text):
        (folder / "use.mts").write_text("import { decodeFrame, encodeCommand, type Scene } from 'haptolith-protocol';\n" + text)
        return subprocess.run([compiler, *options, "use.mts"], cwd=folder, text=True, capture_output=True, check=False).stdout

    assert complaints("export const time_s: number = decodeFrame(new ArrayBuffer(128)).time_s;\n"
                      "export const title = (scene: Scene): string => scene.title;\n"
                      "encodeCommand({ do: 'step', ticks: 3 }, 1);\n") == ""
    assert "TS2322" in complaints("encodeCommand({ do: 'step', ticks: 'three' });\n")
