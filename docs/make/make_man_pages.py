#!/usr/bin/env python3
"""Makes a man page of each command's help: make_man_pages.py PROGRAM FOLDER, with Debian's help2man."""

import subprocess
import sys
import tempfile
from pathlib import Path

from commands import commands


def examples_apart(text: str) -> str:
    """Help whose examples are paragraphs: help2man runs lines into one another."""
    before, heading, examples = text.partition("\nExamples:\n")
    return before + heading + "\n\n".join(examples.splitlines()) + "\n"


def main() -> None:
    """haptolith.1, haptolith-run.1, haptolith-lab-shear.1, ..."""
    program, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    version = subprocess.run([str(program), "--version"], check=True, capture_output=True, text=True).stdout.split()[-1]
    told = {"-".join(["haptolith", *command]): (command, text) for command, text in commands(program)}
    with tempfile.TemporaryDirectory() as temporary:
        for name, (command, text) in told.items():
            # help2man uses the name of the started program as the page's name.
            stand_in = Path(temporary) / name
            (Path(temporary) / f"{name}.txt").write_text(examples_apart(text))
            stand_in.write_text('#!/bin/sh\ncat "$0.txt"\n')
            stand_in.chmod(0o755)
            above = "-".join(["haptolith", *command[:-1]])
            below = [other for other, (subcommand, _) in told.items() if subcommand[:-1] == command and subcommand]
            see = ", ".join(f"\\fB{other}\\fR(1)" for other in ([above] if command else []) + below)
            added = Path(temporary) / "added"
            added.write_text(f"[see also]\n{see}{'.' if see else ''}\n.PP\nThe manual: /usr/share/doc/haptolith/html/index.html, "
                             "where the package haptolith-doc is installed.\n")
            summary = text.splitlines()[0].removeprefix("haptolith: ")
            subprocess.run(["help2man", "--no-info", f"--version-string={version}", f"--name={summary}", "--source=haptolith",
                            "--manual=haptolith", f"--include={added}", f"--output={folder / (name + '.1')}", str(stand_in)], check=True)


if __name__ == "__main__":
    main()
