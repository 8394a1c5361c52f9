#!/usr/bin/python3
"""Makes a Python wheel of an installed haptolith: make_wheel.py PREFIX VERSION OUT [--root ROOT] [--hdf5 LICENCE].

PREFIX is what `cmake --install` made: libexec/haptolith, lib/libhaptolith*.so and lib/python3/dist-packages.
ROOT has the libraries of the processor that PREFIX is for, if that is not this machine's (packaging/dependencies/make_root).
The wheel has all shared libraries that these need and not every Linux brings, with names of their own, as auditwheel would
give them, and the licence of each. The same input makes the same bytes; SOURCE_DATE_EPOCH is the time of all files.
Needs Debian's binutils and patchelf.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent.parent

# Libraries of every Linux: PEP 600, the policy of manylinux.
EVERYWHERE = re.compile(r"(linux-vdso|ld-linux.*|libc|libm|libdl|librt|libpthread|libresolv|libutil|libgcc_s|libz|libstdc\+\+)\.so.*")
# Packages whose headers are compiled into ours, for their licences.
HEADERS = ["libeigen3-dev", "libboost1.74-dev", "nlohmann-json3-dev", "libcli11-dev", "libsqlitecpp-dev", "libspdlog-dev"]
PROGRAM = "haptolith/_program/haptolith"  # its place in the wheel


def output(*command: str | Path) -> str:
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def processor_of(file: Path) -> str:
    """The processor of a program or library, as Linux calls it: x86_64, aarch64."""
    return {62: "x86_64", 183: "aarch64"}[int.from_bytes(file.read_bytes()[18:20], "little")]


def needed(files: list[Path], root: Path) -> dict[str, Path]:
    """Libraries that files need, directly or not, by name, without the files and those of every Linux."""
    found: dict[str, Path] = {}
    folders = [root / lib / f"{processor_of(files[0])}-linux-gnu" for lib in ("usr/lib", "lib")]
    names = {file.name for file in files}
    left = list(files)
    while left:
        file = left.pop()
        for name in re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "--dynamic", "--wide", file)):
            if name in names or EVERYWHERE.fullmatch(name):
                continue
            path = next((folder / name for folder in folders if (folder / name).exists()), None)
            if path is None:
                raise SystemExit(f"make_wheel: {file} needs {name}, which is not in {folders[0]}")
            names.add(name)
            found[name] = path.resolve()
            left.append(found[name])
    return found


def package_of(library: str) -> str:
    """The Debian package of a library, by its name; this machine has those of the same name."""
    try:
        return output("dpkg-query", "-S", f"*/{library}").split(":")[0]
    except subprocess.CalledProcessError:
        raise SystemExit(f"make_wheel: {library} is in no Debian package, so its licence is not known") from None


def patch(file: Path, names: dict[str, str], run_path: str) -> None:
    # One change a call: patchelf 0.14.3 confuses names when it makes several at once.
    here = output("patchelf", "--print-needed", file).split()
    for old, new in names.items():
        if old in here:
            output("patchelf", "--replace-needed", old, new, file)
    output("patchelf", "--force-rpath", "--set-rpath", run_path, file)


def glibc_of(files: list[Path]) -> int:
    """The y of the newest GLIBC_2.y that a file asks for."""
    versions = {int(v) for file in files for v in re.findall(r"GLIBC_2\.(\d+)", output("readelf", "--version-info", file))}
    return max(versions)


def add_program(prefix: Path, tree: Path) -> list[Path]:
    """The workbench has the commands of `haptolith`, too."""
    target = tree / PROGRAM
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(prefix / "libexec/haptolith/haptolith-workbench", target)
    return [target]


def add_package(prefix: Path, tree: Path) -> list[Path]:
    shutil.copytree(prefix / "lib/python3/dist-packages/haptolith", tree / "haptolith",
                    ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(HERE / "__main__.py", tree / "haptolith/__main__.py")
    files = []
    for library in sorted(prefix.glob("lib/libhaptolith*.so.?.?")):
        target = tree / "haptolith" / library.name
        shutil.copy(library.resolve(), target)
        files.append(target)
    return files


def add_libraries(files: list[Path], tree: Path, root: Path) -> tuple[list[Path], set[str]]:
    """Copies what the files need, and sets their run paths. Returns the copies and the names of their Debian packages."""
    libraries = needed(files, root)
    folder = tree / "haptolith.libs"
    folder.mkdir()
    names, copies, packages = {}, [], set()
    for name, path in sorted(libraries.items()):
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:8]
        base, _, rest = name.partition(".so")
        names[name] = f"{base}-{digest}.so{rest}"
        copy = folder / names[name]
        shutil.copy(path, copy)
        copies.append(copy)
        packages.add(package_of(path.name))
    for file in files + copies:
        file.chmod(0o755)
        output(f"{processor_of(file).replace('_', '-')}-linux-gnu-strip", "--strip-unneeded", file)
    for copy in copies:
        output("patchelf", "--set-soname", copy.name, copy)
        patch(copy, names, "$ORIGIN")
    for file in files:
        to_libs = os.path.relpath(folder, file.parent)
        patch(file, names, f"$ORIGIN/{to_libs}:$ORIGIN/{os.path.relpath(tree / 'haptolith', file.parent)}")
    return copies, packages


def add_licences(info: Path, packages: set[str], hdf5: Path | None) -> None:
    folder = info / "licenses"
    folder.mkdir()
    shutil.copy(SOURCE / "LICENSE", folder / "haptolith.txt")
    shutil.copy(SOURCE / "debian/copyright", folder / "page.txt")
    for package in sorted(packages | set(HEADERS)):
        shutil.copy(f"/usr/share/doc/{package}/copyright", folder / f"{package}.txt")
    if hdf5 is not None:
        shutil.copy(hdf5, folder / "hdf5.txt")


def add_metadata(info: Path, version: str, tag: str) -> None:
    (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: haptolith\nRoot-Is-Purelib: false\nTag: {tag}\n")
    (info / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: haptolith\n"
        f"Version: {version}\n"
        "Summary: Haptic rendering of lunar and planetary regolith at 1 kHz\n"
        "License: BSD-3-Clause\n"
        "Keywords: haptics,granular,regolith,soil,discrete element method\n"
        "Classifier: Operating System :: POSIX :: Linux\n"
        "Classifier: Programming Language :: Python :: 3\n"
        "Classifier: Topic :: Scientific/Engineering\n"
        "Requires-Python: >=3.9\nRequires-Dist: numpy\n"
        "Description-Content-Type: text/markdown\n\n" + (HERE / "description.md").read_text())
    (info / "entry_points.txt").write_text("[console_scripts]\nhaptolith = haptolith.__main__:main\n")
    (info / "top_level.txt").write_text("haptolith\n")


def pack(tree: Path, info: Path, target: Path) -> None:
    """The archive, with its record; files in order, with one time."""
    record = []
    for file in sorted(path for path in tree.rglob("*") if path.is_file()):
        data = file.read_bytes()
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record.append(f"{file.relative_to(tree)},sha256={digest},{len(data)}")
    record_file = info / "RECORD"
    record_file.write_text("\n".join([*record, f"{record_file.relative_to(tree)},,", ""]))
    moment = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", "315532800")), 315532800))  # 1980, ZIP's beginning
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for file in sorted(path for path in tree.rglob("*") if path.is_file()):
            entry = zipfile.ZipInfo(str(file.relative_to(tree)), moment[:6])
            executable = file.read_bytes()[:4] == b"\x7fELF"
            entry.external_attr = (0o100755 if executable else 0o100644) << 16
            entry.create_system = 3
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, file.read_bytes(), compresslevel=9)


def main() -> None:
    parser = argparse.ArgumentParser(description="Make a Python wheel of an installed haptolith")
    parser.add_argument("prefix", type=Path)
    parser.add_argument("version")
    parser.add_argument("out", type=Path)
    parser.add_argument("--root", type=Path, default=Path("/"))
    parser.add_argument("--hdf5", type=Path, help="licence of the HDF5 inside, if it is not Debian's library")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder)
        files = add_package(options.prefix, tree) + add_program(options.prefix, tree)
        copies, packages = add_libraries(files, tree, options.root)
        tag = f"py3-none-manylinux_2_{glibc_of(files + copies)}_{processor_of(files[0])}"
        info = tree / f"haptolith-{options.version}.dist-info"
        info.mkdir()
        add_licences(info, packages, options.hdf5)
        add_metadata(info, options.version, tag)
        options.out.mkdir(parents=True, exist_ok=True)
        target = options.out / f"haptolith-{options.version}-{tag}.whl"
        pack(tree, info, target)
    print(target)


main()
