#!/usr/bin/env python3
"""Checks the size and the links of the pages in docs/: exit status 1 and a line for each fault.

- A user page (tutorials, how-to, reference, explanation, docs/*.md) has at most PAGE_WORDS words, all of them together USER_WORDS.
- Reports have at most REPORT_WORDS words together.
- Each row of docs/explanation/comparison.md that states a feature of haptolith links to a file of this repository.
- Each number of docs/results.toml is shown as it is there (results.py --check).

A word has a letter or a digit. Tables and listings count; their bars and dashes do not.
"""

import re
import subprocess
import sys
from pathlib import Path
from typing import Iterator

from check_words import DOCS, MAKE, SOURCE, USER_KINDS, words_in

PAGE_WORDS = 1200
USER_WORDS = 40_000
REPORT_WORDS = 20_000
COMPARISON = DOCS / "explanation/comparison.md"
PROGRAM = "haptolith"  # the column of the features that need a link


def kind_of(page: Path) -> str:
    """The folder of a page in docs/, "." for a page at its top."""
    parts = page.relative_to(DOCS).parts
    return parts[0] if len(parts) > 1 else "."


def sizes() -> Iterator[str]:
    """Faults of pages and kinds of pages that are too long."""
    user = reports = 0
    for page in sorted(DOCS.rglob("*.md")):
        kind = kind_of(page)
        words = words_in(page.read_text())
        if kind in USER_KINDS:
            user += words
            if words > PAGE_WORDS:
                yield f"{page.relative_to(SOURCE)}: {words} words; at most {PAGE_WORDS}"
        elif kind == "reports":
            reports += words
    if user > USER_WORDS:
        yield f"user pages: {user} words; at most {USER_WORDS}"
    if reports > REPORT_WORDS:
        yield f"docs/reports: {reports} words; at most {REPORT_WORDS}"


def cells(line: str) -> list[str]:
    """Cells of a line of a table; empty for another line."""
    return [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []


def leads_somewhere(page: Path, cell: str) -> bool:
    """Whether a cell of a page links to a file of this repository."""
    targets = re.findall(r"\]\(([^)\s#]+)[^)]*\)", cell)
    return any("://" not in to and (page.parent / to).exists() for to in targets)


def feature_links(page: Path) -> Iterator[str]:
    """Rows of tables with a column of haptolith whose cell there has no link to an existing file."""
    column = None
    rows = 0
    for number, line in enumerate(page.read_text().splitlines(), 1):
        row = cells(line)
        if not row:
            column = None
        elif column is None:
            column = next((i for i, cell in enumerate(row) if i > 0 and cell.split()[:1] == [PROGRAM]), -1)
        elif column > 0 and not re.fullmatch(r"[-: |]+", line):
            rows += 1
            if column >= len(row) or not leads_somewhere(page, row[column]):
                yield f"{page.relative_to(SOURCE)}:{number}: \"{row[0]}\" of {PROGRAM} links to no file of this repository"
    if rows == 0:
        yield f"{page.relative_to(SOURCE)}: no table with a column \"{PROGRAM}\""


def numbers() -> Iterator[str]:
    """Faults reported by results.py --check."""
    done = subprocess.run([sys.executable, str(MAKE / "results.py"), "--check"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        yield from (done.stdout + done.stderr).strip().splitlines()


def main() -> None:
    """Prints the faults."""
    if sys.argv[1:]:
        sys.exit(__doc__)
    faults = [*sizes(), *feature_links(COMPARISON), *numbers()]
    if faults:
        sys.exit("\n".join(faults))


if __name__ == "__main__":
    main()
