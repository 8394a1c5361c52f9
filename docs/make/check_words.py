#!/usr/bin/env python3
"""Looks for words that this project does not use (words.txt), and counts those that it does.

check_words.py FILE ...           hits in these files, one per line; exit status 1 when there are any
check_words.py --new COMMIT       hits in lines that have been added since a commit
check_words.py --share FOLDER ... lines of comments with a hit, of all lines of comments, per folder
check_words.py --pages            words and words per sentence of each page of docs/, and sums by kind
"""

import re
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Iterator

MAKE = Path(__file__).resolve().parent
DOCS = MAKE.parent
SOURCE = DOCS.parent
USER_KINDS = ("tutorials", "how-to", "reference", "explanation", ".")
C_LIKE = {".h", ".hpp", ".cpp", ".c", ".ts", ".mjs", ".cs"}
HASH_LIKE = {".py", ".sh", ".toml", ".cmake"}

Rule = tuple[re.Pattern[str], str]


def rules() -> tuple[list[Rule], list[Rule]]:
    """Rules for all texts, and rules only for comments."""
    found: tuple[list[Rule], list[Rule]] = ([], [])
    kind = 0
    for line in (MAKE / "words.txt").read_text().splitlines():
        if line == "@comment":
            kind = 1
        elif line and not line.startswith("#"):
            pattern, instead = line.split("\t")
            found[kind].append((re.compile(pattern, re.I), instead))
    return found


def prose(text: str) -> Iterator[tuple[int, str]]:
    """Lines of a page without code, with their numbers; a line of code is empty."""
    fenced = ""
    paragraph = False
    for number, line in enumerate(text.splitlines(), 1):
        fence = re.match(r"\s*(`{3,}|~{3,})", line)
        if fence:
            fenced = "" if fenced and fence[1].startswith(fenced) else fenced or fence[1]
            line = ""
        elif fenced or line.startswith("    ") or line.startswith("<!--"):
            line = ""
        line = re.sub(r"`[^`]*`", "`", re.sub(r"\]\([^)]*\)", "]", line))
        begins = not line.strip() or re.match(r"\s*([-*>#|]|\d+\.) ", line) is not None
        yield number, line if begins or not paragraph else f"… {line}"
        paragraph = bool(line.strip())


def comments(file: Path, text: str) -> Iterator[tuple[int, str, bool]]:
    """(line, text, is a comment) of the comments and of the strings of a source; a line that continues a comment begins with "…"."""
    last = 0
    for number, line, comment in parts(file, text):
        alone = comment and not line.startswith(("@", "-", "<"))
        line = line.removeprefix("<").lstrip()
        line = re.sub(r"`[^`]*`", "`", line) if comment else line
        yield number, f"… {line}" if alone and last == number - 1 else line, comment
        last = number if alone and line.strip() and not line.endswith(".") else 0


def parts(file: Path, text: str) -> Iterator[tuple[int, str, bool]]:
    """(line, text, is a comment) of the comments and of the strings of a source."""
    block = False
    for number, line in enumerate(text.splitlines(), 1):
        if file.suffix in C_LIKE:
            if block:
                end = line.find("*/")
                yield number, re.sub(r"^\s*\*? ?", "", line if end < 0 else line[:end]), True
                block = end < 0
                continue
            bare = re.sub(r'"(?:[^"\\]|\\.)*"', lambda match: '"' + "x" * (len(match[0]) - 2) + '"', line)
            for match in re.finditer(r'"((?:[^"\\]|\\.)*)"', line):
                if " " in match[1] and not line.lstrip().startswith(("//", "*")):
                    yield number, match[1], False
            found = re.search(r"(?<!:)//[/!]?<?\s?(.*)$|/\*\*?<?\s?(.*)$", bare)
            if found:
                tail = line[found.start() :]
                block = tail.startswith("/*") and "*/" not in tail
                yield number, re.sub(r"^(//[/!]?|/\*\*?)\s*|\s*\*/.*$", "", tail), True
        else:
            match = re.search(r"(?:^|\s)#\s?(?!!)(.*)$", line)
            if match:
                yield number, match[1], True
            elif file.suffix == ".py" and re.match(r'\s*"""', line):
                yield number, line.strip().strip('"'), True


def hits(file: Path, text: str) -> Iterator[tuple[int, str, str, bool]]:
    """(line, match, replacement, whether in a comment)."""
    everywhere, in_comments = rules()
    lines = ((n, line, False) for n, line in prose(text)) if file.suffix == ".md" else comments(file, text)
    for number, line, comment in lines:
        if not comment and ("tests" in file.parts or line.startswith("### ")):  # expected messages, and headings that quote them
            continue
        for pattern, instead in everywhere + (in_comments if comment else []):
            if match := pattern.search(line):
                yield number, match[0].strip(), instead, comment


def files_in(names: list[str]) -> list[Path]:
    """The tracked texts among these files and folders."""
    tracked = subprocess.run(["git", "-C", str(SOURCE), "ls-files", "--", *[str(Path(name).resolve()) for name in names]], check=True, capture_output=True, text=True)
    return [SOURCE / name for name in tracked.stdout.splitlines()
            if Path(name).suffix in C_LIKE | HASH_LIKE | {".md"} and not re.search("first_version|tests/data|fuzz/corpus", name) and (SOURCE / name).exists()]


def check(files: list[Path], lines: dict[Path, set[int]] | None = None) -> int:
    """Prints the hits, or those in some lines; returns their number."""
    count = 0
    for file in files:
        for number, found, instead, _ in hits(file, file.read_text()):
            if lines is None or number in lines.get(file, set()):
                print(f"{file.relative_to(SOURCE)}:{number}: \"{found}\": write {instead}")
                count += 1
    return count


def added_since(commit: str) -> dict[Path, set[int]]:
    """Lines that have been added since a commit, by file."""
    difference = subprocess.run(["git", "-C", str(SOURCE), "diff", "-U0", "-M", commit], check=True, capture_output=True, text=True).stdout
    added: dict[Path, set[int]] = {}
    file = None
    for line in difference.splitlines():
        if line.startswith("+++ "):
            file = SOURCE / line[6:] if line != "+++ /dev/null" else None
        elif file and (match := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line)):
            first, length = int(match[1]), int(match[2] or 1)
            added.setdefault(file, set()).update(range(first, first + length))
    return added


def words_in(text: str) -> int:
    """Number of words in a page, without the bars of tables and dashes."""
    return sum(1 for word in re.sub(r"<!--.*?-->", "", text, flags=re.S).split() if re.search(r"\w", word))


def sentences(text: str) -> list[int]:
    """Words of each sentence of a page's paragraphs and lists; tables, headings and code are left out."""
    kept: list[str] = []
    for _, line in prose(text):
        outside = not line.strip() or line.lstrip().startswith(("|", "#", "!", "<", ":", "@"))
        item = re.match(r"\s*(?:[-*]|\d+\.)\s+", line)
        line = line.removeprefix("… ")
        kept.append("\n" if outside else ("\n" + line[item.end() :] if item else line))
    counts: list[int] = []
    for paragraph in "\n".join(kept).split("\n\n"):
        for item in re.split(r"\n\n|\n(?=\n)", paragraph):
            counts += [len(one.split()) for one in re.split(r"(?<=[.!?])\s+", item.strip()) if len(one.split()) > 2]
    return counts


def pages() -> None:
    """Prints the table of pages."""
    sums: dict[str, int] = {}
    medians: list[float] = []
    for page in [SOURCE / "README.md", *sorted(DOCS.rglob("*.md"))]:
        text = page.read_text()
        kind = page.relative_to(DOCS).parts[0] if DOCS in page.parents else "."
        kind = "." if kind.endswith(".md") else kind
        words = words_in(text)
        sums[kind] = sums.get(kind, 0) + words
        counts = sentences(text)
        mean = statistics.mean(counts) if counts else 0.0
        medians.append(mean)
        print(f"{page.relative_to(SOURCE)}: {words} words, {mean:.1f} per sentence, {sum(1 for _ in hits(page, text))} hits")
    print({**sums, "user pages": sum(sums.get(kind, 0) for kind in USER_KINDS)}, f"median page: {statistics.median(medians):.1f} words per sentence")


def share(folders: list[str]) -> None:
    """Prints the fraction of comment lines with a hit."""
    for folder in folders:
        lines = found = 0
        for file in files_in([folder]):
            if file.suffix == ".md":
                continue
            text = file.read_text()
            lines += len({number for number, _, comment in comments(file, text) if comment})
            found += len({number for number, _, _, comment in hits(file, text) if comment})
        print(f"{folder}: {found} of {lines} lines of comments, {100 * found / max(lines, 1):.1f} %")


def main() -> None:
    """Reads the command line."""
    arguments = sys.argv[1:]
    if arguments[:1] == ["--pages"]:
        pages()
    elif arguments[:1] == ["--share"]:
        share(arguments[1:])
    elif arguments[:1] == ["--new"]:
        added = added_since(arguments[1])
        sys.exit(1 if check([file for file in files_in([str(SOURCE)]) if file in added], added) else 0)
    elif arguments:
        sys.exit(1 if check(files_in(arguments)) else 0)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
