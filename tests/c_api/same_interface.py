#!/usr/bin/env python3
"""Compares today's C headers with those of the first version of this minor version: same_interface.py FIRST_FOLDER [TODAY_FOLDER]

Every function keeps its name and types, every constant its value, and every struct its members, after which only structs that
begin with `size` may have more. With `c_api.consumer.symbols`, which compares headers with libraries, this checks in a second
what `./dev abi` finds in two debug builds.
"""

import re
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "contrib/unity"))
sys.dont_write_bytecode = True
import make_native  # noqa: E402  # pylint: disable=wrong-import-position

FIXED = {"hapto_array", "hapto_device_limits", "hapto_tick"}  # inside other structs or in arrays


class Interface:
    """Functions, constants and structs of the two headers in a folder, in the types of make_native.py."""

    def __init__(self, folder: Path) -> None:
        header = make_native.Header()
        self.functions: dict[str, str] = {}
        self.constants: dict[str, str] = {}
        for name in ("haptolith.h", "recording.h"):
            make_native.HEADER = folder / name
            text = make_native.native(header)
            for result, function, arguments in re.findall(r"public static extern (\S+) (\w+)\((.*)\);", text):
                self.functions[function] = f"{result} ({', '.join(one.split()[0] for one in arguments.split(', ') if one)})"
            self.constants |= dict(re.findall(r"public const int (\w+) = (\d+);", text))
        self.structs = {name: [f"{one.type}[{one.count}]" for one in fields] for name, fields in header.structs.items()}
        self.sized = {name for name, fields in header.structs.items() if fields[0].name == "size"} - FIXED


def faults(first: Interface, today: Interface) -> list[str]:
    """Changes that break a program which was built with the first version."""
    found = []
    for kind in ("functions", "constants"):
        now = getattr(today, kind)
        found += [f"{name}: {was} is now {now.get(name, 'missing')}" for name, was in getattr(first, kind).items() if now.get(name) != was]
    for name, was in first.structs.items():
        now = today.structs.get(name, [])
        if now[: len(was)] != was or (len(now) > len(was) and name not in first.sized):
            found.append(f"{name}: {' '.join(was)} is now {' '.join(now) or 'missing'}")
    return found


def main() -> None:
    """Reads the command line."""
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    first = Interface(Path(sys.argv[1]))
    found = faults(first, Interface(Path(sys.argv[2]) if len(sys.argv) == 3 else SOURCE / "include/haptolith"))
    if found:
        sys.exit("same_interface.py: programs built with the first version break:\n" + "\n".join(found))
    print(f"{len(first.functions)} functions, {len(first.constants)} constants, {len(first.structs)} structs: compatible")


if __name__ == "__main__":
    main()
