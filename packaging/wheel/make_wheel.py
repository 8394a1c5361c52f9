#!/usr/bin/python3
"""Makes a Python wheel of an installed haptolith: make_wheel.py PREFIX VERSION OUT.

PREFIX is what `cmake --install` made: libexec/haptolith, lib/libhaptolith*.so and lib/python3/dist-packages.
The wheel has all shared libraries that these need and not every Linux brings, with names of their own, as auditwheel would
give them, and the licence of each. The same input makes the same bytes; SOURCE_DATE_EPOCH is the time of all files.
Needs Debian's binutils and patchelf.
"""

from __future__ import annotations

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


def needed(file: Path, ours: set[str]) -> dict[str, Path]:
    """Libraries that a file needs, directly or not, by name, without ours and those of every Linux."""
    found = {}
    for line in output("ldd", file).splitlines():
        words = line.split()
        if len(words) >= 3 and words[1] == "=>" and words[0] not in ours:
            if words[2] == "not":
                raise SystemExit(f"make_wheel: {file} needs {words[0]}, which is not there")
            if not EVERYWHERE.fullmatch(words[0]):
                found[words[0]] = Path(words[2]).resolve()
    return found


def package_of(library: Path) -> str | None:
    """The Debian package of a library; files there may be listed below / or below /usr."""
    for path in (library, Path("/usr") / library.relative_to("/"), Path("/") / str(library).removeprefix("/usr/")):
        try:
            return output("dpkg-query", "-S", path).split(":")[0]
        except subprocess.CalledProcessError:
            continue
    return None


def patch(file: Path, names: dict[str, str], run_path: str) -> None:
    # One change a call: patchelf 0.14.3 confuses names when it makes several at once.
    here = output("patchelf", "--print-needed", file).split()
    for old, new in names.items():
        if old in here:
            output("patchelf", "--replace-needed", old, new, file)
    output("patchelf", "--force-rpath", "--set-rpath", run_path, file)


def glibc_of(files: list[Path]) -> int:
    """The y of the newest GLIBC_2.y that a file asks for."""
    versions = {int(v) for file in files for v in re.findall(r"GLIBC_2\.(\d+)", output("objdump", "-T", file))}
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


def add_libraries(files: list[Path], tree: Path) -> tuple[list[Path], set[str]]:
    """Copies what the files need, and sets their run paths. Returns the copies and the names of their Debian packages."""
    libraries: dict[str, Path] = {}
    ours = {file.name for file in files}
    for file in files:
        libraries.update(needed(file, ours))
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
        package = package_of(path)
        if package is None:
            raise SystemExit(f"make_wheel: {path} is in no Debian package, so its licence is not known")
        packages.add(package)
    for file in files + copies:
        file.chmod(0o755)
        output("strip", "--strip-unneeded", file)
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
    if len(sys.argv) not in (4, 5):
        raise SystemExit("usage: make_wheel.py PREFIX VERSION OUT [HDF5_LICENCE]")
    prefix, version, out = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder)
        files = add_package(prefix, tree) + add_program(prefix, tree)
        copies, packages = add_libraries(files, tree)
        tag = f"py3-none-manylinux_2_{glibc_of(files + copies)}_{os.uname().machine}"
        info = tree / f"haptolith-{version}.dist-info"
        info.mkdir()
        add_licences(info, packages, Path(sys.argv[4]) if len(sys.argv) == 5 else None)
        add_metadata(info, version, tag)
        out.mkdir(parents=True, exist_ok=True)
        target = out / f"haptolith-{version}-{tag}.whl"
        pack(tree, info, target)
    print(target)


main()
