#!/usr/bin/env python3
"""The package is complete: what Unity reads is JSON that names what there is, and no binary is committed. check_package.py VERSION"""

import json
import shutil
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PACKAGE = SOURCE / "contrib/unity/org.haptolith"


def main() -> None:
    """Checks one thing after the other."""
    package = json.loads((PACKAGE / "package.json").read_text())
    assert package["name"] == PACKAGE.name, "the folder has the package's name"
    assert package["version"] == sys.argv[1], f"package.json has version {package['version']}, the project {sys.argv[1]}"
    for sample in package["samples"]:
        folder = PACKAGE / sample["path"]
        assert list(folder.glob("*.cs")) and list(folder.glob("*.asmdef")), f"{folder} is a sample"
    assemblies = {}
    for file in PACKAGE.rglob("*.asmdef"):
        assembly = json.loads(file.read_text())
        assert assembly["name"] == file.stem, file
        assemblies[file.stem] = assembly
    assert assemblies["Haptolith"]["allowUnsafeCode"]
    for assembly in assemblies.values():
        assert set(assembly.get("references", [])) <= set(assemblies), assembly["name"]
    if shutil.which("git") and (SOURCE / ".git").exists():
        listed = subprocess.run(["git", "-C", str(SOURCE), "ls-files", "contrib/unity"], check=True, capture_output=True, text=True).stdout.split()
        assert not [name for name in listed if name.endswith((".so", ".dll"))], "no binary is committed"


if __name__ == "__main__":
    main()
