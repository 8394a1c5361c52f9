#!/usr/bin/python3
"""Makes all files of a release from a tag: make_release.py [TAG] [--only NAME...], or ./dev release.

TAG is vX.Y.Z, by default the tag of the current commit. The files are in build/releases/X.Y.Z. They are built by the commands of
./dev in build/releases/haptolith-X.Y.Z, a checkout of the tag that the next call uses again. The same tag makes the same bytes:
all times are that of the tag's commit, archives are sorted and without owners, and a file with the checkout's path is refused.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import os
import re
import shutil
import subprocess
import sys
import tarfile
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

SOURCE = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
from archives import Contents, entries, files_of, gzip_of, tar_of, zip_of  # noqa: E402  # pylint: disable=wrong-import-position
from sbom import WINDOWS, WINDOWS_PROGRAM, sbom_of  # noqa: E402  # pylint: disable=wrong-import-position


def say(text: str) -> None:
    print(f"make_release: {text}", file=sys.stderr, flush=True)


def fail(text: str, status: int = 1) -> NoReturn:
    say(f"error: {text}")
    sys.exit(status)


def git(*arguments: str) -> bytes:
    return subprocess.run(["git", "-C", str(SOURCE), *arguments], check=True, capture_output=True).stdout


def sha256(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def section(tag: str) -> str:
    """The part of the changelog about a tag, without its heading."""
    found = re.search(rf"^## \[{re.escape(tag[1:])}\][^\n]*\n(.*?)(?=^## \[|\Z)", git("show", f"{tag}:CHANGELOG.md").decode(), re.M | re.S)
    return found[1].strip() + "\n" if found else ""


def tag_of(wanted: str | None) -> str:
    """A tag that can be released; ends with status 2 for any other."""
    if wanted is None:
        tags = [tag for tag in git("tag", "--points-at", "HEAD").decode().split() if tag.startswith("v")]
        if len(tags) != 1:
            fail(f"the current commit has {'several tags, ' + ' '.join(tags) if tags else 'no tag'}; name one: ./dev release vX.Y.Z", 2)
        wanted = tags[0]
    if not re.fullmatch(r"v\d+\.\d+\.\d+", wanted):
        fail(f"invalid tag: {wanted}; expected vX.Y.Z", 2)
    if wanted not in git("tag").decode().split():
        fail(f"there is no tag {wanted}; see RELEASING.md", 2)
    declared = re.search(r"^project\(haptolith VERSION ([0-9.]+)", git("show", f"{wanted}:CMakeLists.txt").decode(), re.M)
    if declared is None or f"v{declared[1]}" != wanted:
        fail(f"CMakeLists.txt of {wanted} has version {declared[1] if declared else 'unknown'}; see RELEASING.md", 2)
    if not section(wanted):
        fail(f"CHANGELOG.md of {wanted} has no section [{wanted[1:]}]; see RELEASING.md", 2)
    return wanted


class Release:
    """The checkout of a tag, and the files made of it."""

    def __init__(self, tag: str) -> None:
        self.tag = tag
        self.version = tag[1:]
        self.name = f"haptolith-{self.version}"
        self.commit = git("rev-parse", f"{tag}^{{commit}}").decode().strip()
        self.epoch = int(git("log", "-1", "--format=%ct", self.commit))
        self.archive = git("archive", "--format=tar", f"--prefix={self.name}/", self.commit)
        self.folder = SOURCE / "build/releases" / self.version
        self.checkout = SOURCE / "build/releases" / self.name
        self.build = self.checkout / "build"
        self.done: set[str] = set()
        self.environment = dict(os.environ, SOURCE_DATE_EPOCH=str(self.epoch), LC_ALL="C.UTF-8", TZ="UTC")

    def prepare(self) -> None:
        """Unpacks the tag, unless the checkout is already of this commit."""
        mark = self.build / "commit"
        if not mark.exists() or mark.read_text() != self.commit:
            shutil.rmtree(self.checkout, ignore_errors=True)
            self.checkout.parent.mkdir(parents=True, exist_ok=True)
            with tarfile.open(fileobj=io.BytesIO(self.archive)) as archive:
                archive.extractall(self.checkout.parent)
            self.build.mkdir()
            mark.write_text(self.commit)
        self.folder.mkdir(parents=True, exist_ok=True)

    def dev(self, *arguments: str) -> None:
        """Runs ./dev in the checkout, each command once."""
        command = " ".join(["./dev", *arguments])
        if command in self.done:
            return
        say(command)
        environment = dict(self.environment)
        if arguments[0] != "package":  # Debian's flags have this option, and are used where there are no others
            # Compilers name files, such as headers of build/dependencies, as if the checkout were the root folder.
            environment["CFLAGS"] = environment["CXXFLAGS"] = f"-ffile-prefix-map={self.checkout}/="
        if subprocess.run(["./dev", *arguments], cwd=self.checkout, env=environment, stdout=sys.stderr, check=False).returncode != 0:
            fail(f"{command} failed in {self.checkout}")
        self.done.add(command)

    def write(self, name: str, data: bytes) -> None:
        (self.folder / name).write_bytes(data)

    def take(self, folder: Path, pattern: str) -> None:
        """Copies built files, in place of those of an earlier call."""
        found = sorted(folder.glob(pattern))
        if not found:
            fail(f"there is no {folder}/{pattern}")
        for file in [*self.folder.glob(pattern)]:
            file.unlink()
        for file in found:
            shutil.copyfile(file, self.folder / file.name)

    def make_source(self) -> None:
        """The source archive, and the formula for Homebrew with its sum."""
        archive = f"{self.name}.tar.gz"
        self.write(archive, gzip_of(self.archive))
        formula = (self.checkout / "packaging/homebrew/haptolith.rb").read_text()
        formula = formula.replace("@VERSION@", self.version).replace("@SHA256@", sha256(self.folder / archive))
        self.write("haptolith.rb", formula.encode())

    def make_notes(self) -> None:
        self.write("NOTES.md", section(self.tag).encode())

    def make_packages(self) -> None:
        self.dev("package")
        self.take(self.build / "packages", "*.deb")

    def make_wheel(self) -> None:
        self.dev("wheel")
        self.take(self.build / "wheels", "*_x86_64.whl")

    def make_wheel_arm64(self) -> None:
        self.dev("wheel", "arm64")
        self.take(self.build / "wheels", "*_aarch64.whl")

    def windows_licences(self) -> Contents:
        """Texts of the licences of the parts for Windows."""
        packages = [*WINDOWS, *(WINDOWS_PROGRAM if any((self.build / "windows/apps").rglob("*.exe")) else [])]
        texts: Contents = {f"{package}.txt": Path(f"/usr/share/doc/{package}/copyright") for package in packages}
        texts |= {"haptolith.txt": self.checkout / "LICENSE", "page.txt": self.checkout / "debian/copyright"}
        texts |= files_of(self.build / "dependencies/windows/licenses")
        texts.pop("googletest.txt", None)  # only in tests
        return texts

    def make_windows(self) -> None:
        """Zips the installed files, the list of names from which Visual Studio makes an import library, and the C# sources."""
        self.dev("build", "windows")
        prefix = self.build / "windows-prefix"
        shutil.rmtree(prefix, ignore_errors=True)
        subprocess.run(["cmake", "--install", str(self.build / "windows"), "--prefix", str(prefix)], check=True, stdout=subprocess.DEVNULL)
        contents = files_of(prefix)
        contents |= {f"lib/{file.name}": file for file in (self.build / "windows/lib").glob("*.def")}
        contents |= files_of(self.checkout / "contrib/unity/org.haptolith/Runtime", "csharp/")
        contents |= {f"licenses/{name}": text for name, text in self.windows_licences().items()}
        top = f"{self.name}-windows-x86_64"
        self.write(f"{top}.zip", zip_of({f"{top}/{name}": file for name, file in contents.items()}, self.epoch))

    def make_unity(self) -> None:
        """The package as Unity's "Add package from tarball" reads it, in which each file needs a .meta file with a fixed name."""
        self.dev("wheel")
        self.dev("build", "windows")
        contents = files_of(self.checkout / "contrib/unity/org.haptolith")
        for library, strip in (("portable/lib/libhaptolith.so", "strip"), ("windows/lib/haptolith.dll", "x86_64-w64-mingw32-strip")):
            stripped = self.build / Path(library).name
            subprocess.run([strip, "--strip-unneeded", "-o", str(stripped), str((self.build / library).resolve())], check=True, env=self.environment)
            contents[f"Plugins/x86_64/{stripped.name}"] = stripped
        contents["LICENSE.md"] = self.checkout / "LICENSE"
        contents |= {f"Licences~/{name}": text for name, text in self.windows_licences().items()}
        visible = {name for name in contents if "~/" not in name}
        for name in visible | {str(folder) for name in visible for folder in Path(name).parents if folder != Path(".")}:
            identity = hashlib.md5(f"org.haptolith/{name}".encode()).hexdigest()
            contents[f"{name}.meta"] = f"fileFormatVersion: 2\nguid: {identity}\n".encode()
        self.write(f"org.haptolith-{self.version}.tgz", tar_of({f"package/{name}": file for name, file in contents.items()}, self.epoch))

    def make_manual(self) -> None:
        self.dev("docs")
        contents = {name: file for name, file in files_of(self.build / "manual").items() if not name.startswith((".doctrees/", ".buildinfo"))}
        top = f"{self.name}-manual"
        self.write(f"{top}.zip", zip_of({f"{top}/{name}": file for name, file in contents.items()}, self.epoch))

    def make_demo(self) -> None:
        self.dev("demo")
        top = f"{self.name}-demo"
        self.write(f"{top}.zip", zip_of(files_of(self.build / "demo-site", f"{top}/"), self.epoch))

    def make_lists(self) -> None:
        """The bill of materials and the sums of what is there."""
        bill = f"{self.name}.spdx.json"
        files = [file for file in sorted(self.folder.iterdir()) if file.name not in (bill, "NOTES.md", "SHA256SUMS")]
        for file in files:
            leaks = [name for name, data in entries(file) if str(SOURCE).encode() in data]
            if leaks:
                fail(f"{file.name} has the path of this checkout, so another checkout makes other bytes: {', '.join(leaks[:5])}")
        self.write(bill, sbom_of(files, self.name, self.version, self.checkout, self.epoch))
        files = [file for file in sorted(self.folder.iterdir()) if file.name != "SHA256SUMS"]
        self.write("SHA256SUMS", "".join(f"{sha256(file)}  {file.name}\n" for file in files).encode())


ARTEFACTS: dict[str, Callable[[Release], None]] = {
    "source": Release.make_source, "notes": Release.make_notes, "manual": Release.make_manual, "demo": Release.make_demo,
    "wheel": Release.make_wheel, "wheel-arm64": Release.make_wheel_arm64, "windows": Release.make_windows, "unity": Release.make_unity,
    "packages": Release.make_packages,
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="./dev release", description="Make all files of a release from a tag, in build/releases/X.Y.Z")
    parser.add_argument("tag", nargs="?", metavar="TAG", help="Tag vX.Y.Z [the tag of the current commit]")
    parser.add_argument("--only", nargs="+", choices=ARTEFACTS, metavar="NAME", help=f"Make only these and the lists: {', '.join(ARTEFACTS)}")
    options = parser.parse_args()
    release = Release(tag_of(options.tag))
    names = options.only or list(ARTEFACTS)
    if options.only is None:
        shutil.rmtree(release.folder, ignore_errors=True)
    release.prepare()
    for number, name in enumerate(names, 1):
        say(f"{name}, {number} of {len(names)}")
        ARTEFACTS[name](release)
    say("lists")
    release.make_lists()
    for file in sorted(release.folder.iterdir()):
        print(f"{file.stat().st_size / 1e6:8.2f} MB  {file.relative_to(SOURCE)}")


if __name__ == "__main__":
    main()
