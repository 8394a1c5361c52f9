"""The software bill of materials of a release, in SPDX 2.3: each file, and what is compiled or copied into it."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import time
import uuid
from collections.abc import Iterable
from pathlib import Path

from archives import entries

# SPDX licences by the name of a Debian package, Debian source or npm package. Their texts are in the files. Packages that are not
# in this table have NOASSERTION.
NLOPT = "MIT AND LGPL-2.1-or-later AND BSD-3-Clause"
LICENCES = {
    "cli11": "BSD-3-Clause", "emscripten": "MIT OR NCSA", "fmtlib": "MIT", "furo": "MIT",
    "g++-mingw-w64-x86-64-posix": "GPL-3.0-or-later WITH GCC-exception-3.1", "hdf5": "BSD-3-Clause", "highway": "Apache-2.0",
    "libboost1.74-dev": "BSL-1.0", "libc++-15-dev": "Apache-2.0 WITH LLVM-exception", "libcli11-dev": "BSD-3-Clause",
    "libeigen3-dev": "MPL-2.0", "libfmt-dev": "MIT", "libfmt9": "MIT", "libhwy-dev": "Apache-2.0", "libhwy1": "Apache-2.0",
    "libnlopt-dev": NLOPT, "libnlopt0": NLOPT, "libsdl2": "Zlib", "libsodium": "ISC", "libsodium23": "ISC", "libspdlog-dev": "MIT",
    "libspdlog1.10": "MIT", "libsqlite3-0": "blessing", "libsqlitecpp-dev": "MIT", "libtomlplusplus-dev": "MIT",
    "libtomlplusplus3": "MIT", "libxxhash-dev": "BSD-2-Clause", "libxxhash0": "BSD-2-Clause", "libz-mingw-w64-dev": "Zlib",
    "nlohmann-json3-dev": "MIT",
    "nlopt": NLOPT, "python3-sphinx": "BSD-2-Clause", "spdlog": "MIT", "sqlite3": "blessing", "sqlitecpp": "MIT", "three": "MIT",
    "uplot": "MIT", "valibot": "MIT", "xxhash": "BSD-2-Clause",
}
HEADERS = ["libboost1.74-dev", "libeigen3-dev", "nlohmann-json3-dev"]  # compiled into the library
PROGRAM_HEADERS = [*HEADERS, "libcli11-dev", "libspdlog-dev", "libsqlitecpp-dev"]
WINDOWS = [*HEADERS, "libtomlplusplus-dev", "g++-mingw-w64-x86-64-posix"]  # the last for the compiler's libraries
WINDOWS_PROGRAM = ["libcli11-dev", "libspdlog-dev", "libz-mingw-w64-dev"]
DEMO = [*HEADERS, "libfmt-dev", "libhwy-dev", "libnlopt-dev", "libtomlplusplus-dev", "libxxhash-dev", "libc++-15-dev", "emscripten"]
MANUAL = ["furo", "python3-sphinx"]

Part = tuple[str, str, str]  # kind (deb, source or npm), name, version


def debian(names: Iterable[str]) -> list[Part]:
    """Debian packages of this machine, with versions."""
    show = ["dpkg-query", "--show", "--showformat=${Version}"]
    return [("deb", name, subprocess.run([*show, name], check=True, capture_output=True, text=True).stdout) for name in names]


def parts_of(file: Path, checkout: Path) -> list[Part]:
    """Lists parts that are compiled or copied into a file of the release."""
    web = json.loads((checkout / "web/package.json").read_text())
    page: list[Part] = [("npm", name, version) for name, version in web["dependencies"].items()]
    found = re.findall(r"^version=(\S+)", (checkout / "packaging/dependencies/make_hdf5").read_text(), re.M)
    hdf5: Part = ("source", "hdf5", found[0])
    names = [name for name, _ in entries(file)]
    if file.suffix == ".whl":  # has the licence of each part
        licences = {Path(name).stem for name in names if "/licenses/" in name} - {"haptolith", "page", "hdf5"}
        return [*page, hdf5, *debian(licences)]
    if file.suffix == ".deb":
        package = file.name.split("_")[0]
        if package == "haptolith":
            return [*page, *debian(PROGRAM_HEADERS)]
        library = package.startswith("libhaptolith") and not package.endswith("-dev")
        return debian(HEADERS if library else MANUAL if package.endswith("-doc") else [])
    if "windows" in file.name or file.suffix == ".tgz":
        text = (checkout / "packaging/dependencies/make_windows_root").read_text()
        sources = [("source", name, version) for name, version in re.findall(r"^  ([\w+.-]+)=([^=\n]+)=[0-9a-f]{64}$", text, re.M)]
        program = any(name.endswith(".exe") for name in names)
        sources = [part for part in sources if part[1] != "googletest"]
        return [*sources, *debian(WINDOWS), *([*page, hdf5, *debian(WINDOWS_PROGRAM)] if program else [])]
    if "demo" in file.name:
        return [*page, *debian(DEMO)]
    return debian(MANUAL if "manual" in file.name else [])


def identifier(*words: str) -> str:
    return "SPDXRef-" + "-".join(re.sub(r"[^A-Za-z0-9.-]", "-", word) for word in words)


def package_of(name: str, identity: str, version: str, licence: str, **more: object) -> dict[str, object]:
    return {"name": name, "SPDXID": identity, "versionInfo": version, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
            "licenseConcluded": "NOASSERTION", "licenseDeclared": licence, "copyrightText": "NOASSERTION", **more}


def sbom_of(files: list[Path], name: str, version: str, checkout: Path, epoch: int) -> bytes:
    """The document; epoch is the time of its creation in s since 1970."""
    packages: dict[str, dict[str, object]] = {}
    relations: list[dict[str, str]] = []

    def relate(one: str, how: str, other: str) -> None:
        relations.append({"spdxElementId": one, "relationshipType": how, "relatedSpdxElement": other})

    for file in files:
        whole = identifier(file.name)
        digest = hashlib.sha256(file.read_bytes()).hexdigest()
        packages[whole] = package_of(file.name, whole, version, "BSD-3-Clause", packageFileName=file.name,
                                     checksums=[{"algorithm": "SHA256", "checksumValue": digest}])
        relate("SPDXRef-DOCUMENT", "DESCRIBES", whole)
        for kind, part, its_version in sorted(set(parts_of(file, checkout))):
            identity = identifier(kind, part, its_version)
            address = f"pkg:{'npm' if kind == 'npm' else 'deb/debian'}/{part}@{its_version.replace(':', '%3A')}"
            address += "?arch=source" if kind == "source" else ""
            packages[identity] = package_of(part, identity, its_version, LICENCES.get(part, "NOASSERTION"), externalRefs=[
                {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": address}])
            relate(whole, "CONTAINS", identity)
    listed = [packages[identity] for identity in sorted(packages)]
    document = {
        "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": name,
        "documentNamespace": f"https://spdx.org/spdxdocs/{name}-{uuid.uuid5(uuid.NAMESPACE_URL, json.dumps(listed))}",
        "creationInfo": {"created": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(epoch)), "creators": ["Tool: haptolith-make_release"]},
        "packages": listed, "relationships": relations,
    }
    return (json.dumps(document, indent=1) + "\n").encode()
