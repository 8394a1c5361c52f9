"""Archives whose bytes depend on names and contents of files alone: sorted, without owners, all files with one time."""

from __future__ import annotations

import gzip
import io
import subprocess
import tarfile
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Union

Contents = dict[str, Union[Path, bytes]]  # files or texts by their names in the archive


def files_of(folder: Path, prefix: str = "") -> Contents:
    """Files of a folder by their names in an archive."""
    return {prefix + str(file.relative_to(folder)): file for file in folder.rglob("*") if file.is_file()}


def read(contents: Contents) -> Iterator[tuple[str, bytes, int]]:
    """(name, bytes, mode) of each file, in order."""
    for name, file in sorted(contents.items()):
        data = file if isinstance(file, bytes) else file.read_bytes()
        program = data[:4] == b"\x7fELF" or data[:2] in (b"MZ", b"#!")
        yield name, data, 0o755 if program else 0o644


def gzip_of(data: bytes) -> bytes:
    """Compressed data without name and time."""
    archive = io.BytesIO()
    with gzip.GzipFile(filename="", mode="wb", fileobj=archive, compresslevel=9, mtime=0) as file:
        file.write(data)
    return archive.getvalue()


def tar_of(contents: Contents, epoch: int) -> bytes:
    """A .tar.gz; epoch is the time of all files in s since 1970."""
    archive = io.BytesIO()
    with tarfile.open(fileobj=archive, mode="w", format=tarfile.USTAR_FORMAT) as file:
        for name, data, mode in read(contents):
            entry = tarfile.TarInfo(name)
            entry.size, entry.mtime, entry.mode = len(data), epoch, mode
            file.addfile(entry, io.BytesIO(data))
    return gzip_of(archive.getvalue())


def zip_of(contents: Contents, epoch: int) -> bytes:
    """A .zip; epoch is the time of all files in s since 1970."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file:
        for name, data, mode in read(contents):
            entry = zipfile.ZipInfo(name, time.gmtime(epoch)[:6])
            entry.create_system = 3
            entry.external_attr = (0o100000 | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            file.writestr(entry, data, compresslevel=9)
    return archive.getvalue()


def entries(file: Path) -> Iterator[tuple[str, bytes]]:
    """Files in a .zip, .whl, .tar.gz, .tgz or .deb, or the file."""
    if file.suffix in (".zip", ".whl"):
        with zipfile.ZipFile(file) as archive:
            for name in archive.namelist():
                yield name, archive.read(name)
    elif file.suffix in (".gz", ".tgz", ".deb"):
        data = file.read_bytes()
        if file.suffix == ".deb":
            data = subprocess.run(["dpkg-deb", "--fsys-tarfile", str(file)], check=True, capture_output=True).stdout
        with tarfile.open(fileobj=io.BytesIO(data)) as archive:
            for member in archive.getmembers():
                content = archive.extractfile(member) if member.isfile() else None
                if content is not None:
                    yield member.name, content.read()
    else:
        yield file.name, file.read_bytes()
