#!/usr/bin/env python3
"""Writes the numbers of docs/results.toml into the pages that show them: each number is kept in one place.

A page shows a number as <!--=TABLE.KEY-->number<!--/-->: the comments are invisible, and the text between them is replaced.

results.py            writes the pages
results.py --check    writes nothing; exit status 1 and a line for each page whose number differs or whose key is unknown
"""

import re
import sys
import tomllib
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
SOURCE = DOCS.parent
FACTS = {"command", "machine", "commit", "source", "note"}  # keys of a table that describe the source of its numbers


def main() -> None:
    """Reads the command line."""
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    values: dict[str, str] = {}
    faults: list[str] = []
    for table, entries in tomllib.loads((DOCS / "results.toml").read_text()).items():
        if not {"command", "source"} & entries.keys():
            faults.append(f"docs/results.toml: [{table}]: no command or source")
        values |= {f"{table}.{key}": str(value) for key, value in entries.items() if key not in FACTS}
    shown: set[str] = set()
    for page in [SOURCE / "README.md", SOURCE / "CHANGELOG.md", *sorted(DOCS.rglob("*.md"))]:
        text = page.read_text()

        def replaced(match: re.Match[str]) -> str:
            shown.add(match[1])
            if match[1] not in values:
                faults.append(f"{page.relative_to(SOURCE)}: {match[1]} is not in docs/results.toml")
                return match[0]
            if check and match[2] != values[match[1]]:
                faults.append(f"{page.relative_to(SOURCE)}: {match[1]}: shows {match[2]}, docs/results.toml has {values[match[1]]}: run docs/make/results.py")
            return f"<!--={match[1]}-->{values[match[1]]}<!--/-->"

        faults += [f"{page.relative_to(SOURCE)}:{number}: a line that begins with a number's comment is raw HTML in the manual"
                   for number, line in enumerate(text.splitlines(), 1) if line.startswith("<!--=")]
        new = re.sub(r"<!--=([\w.-]+)-->(.*?)<!--/-->", replaced, text)
        if new != text and not check:
            page.write_text(new)
    faults += [f"docs/results.toml: {key} is shown on no page" for key in sorted(values.keys() - shown)]
    if faults:
        sys.exit("\n".join(faults))


if __name__ == "__main__":
    main()
