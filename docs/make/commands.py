"""The program's commands, as listed by its help."""

import re
import subprocess
from pathlib import Path
from typing import Iterator


def commands(program: Path, command: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], str]]:
    """Each command, ("lab", "shear"), with its help; the program itself, (), is the first."""
    told = subprocess.run([str(program), *command, "--help"], check=True, capture_output=True, text=True).stdout
    yield command, told
    for listed in re.findall(r"^(?:Subcommands|\w+ commands):\n((?:  .*\n)+)", told, re.M):
        for line in listed.splitlines():
            if not line.startswith("   "):
                yield from commands(program, (*command, line.split()[0]))
