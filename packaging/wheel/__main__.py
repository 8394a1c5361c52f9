"""The program `haptolith` of the wheel: python3 -m haptolith."""

import os
import sys
from pathlib import Path


def main() -> None:
    program = Path(__file__).parent / "_program/haptolith"
    os.execv(program, ["haptolith", *sys.argv[1:]])


if __name__ == "__main__":
    main()
