#!/usr/bin/env python3
"""Makes the manual: make_manual.py BUILD_FOLDER OUT_FOLDER, with Debian's Sphinx, MyST and furo, offline.

The pages are those of docs/, in the same folders. Generated: the reference of the C header, the help of every command, and a page for
each file that a page links to. Warnings are errors. The text in a comment "<!-- manual ... -->" is in the manual only: tables of contents
and listings, which a repository's web page shows as raw text.
"""

import base64
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from commands import commands

MAKE = Path(__file__).resolve().parent
DOCS = MAKE.parent
SOURCE = DOCS.parent

LANGUAGES = {".toml": "toml", ".c": "c", ".h": "c", ".hpp": "cpp", ".cpp": "cpp", ".cs": "csharp", ".gd": "gdscript", ".m": "matlab", ".mjs": "javascript",
             ".py": "python", ".sh": "bash"}


# --- the C header -----------------------------------------------------------------------------------------------------

def text_of(comment: str) -> str:
    """A comment of the header as Markdown: lines "name  description" become a list, indented lines continue an item."""
    paragraphs: list[str] = []
    for line in re.sub(r"^/\*|\*/$", "", comment.strip()).splitlines():
        line = re.sub(r"^ \* ?", "", line.rstrip())
        parameter = re.match(r"(\w+)  +(\S.*)", line)
        if parameter:
            paragraphs.append(f"- **{parameter[1]}**: {parameter[2]}")
        elif line.startswith("    ") and paragraphs and paragraphs[-1].startswith("- "):
            paragraphs[-1] += " " + line.strip()
        elif line.startswith(("Errors:", "  - ")) or not paragraphs or not line.strip():
            paragraphs.append(line.strip())
        elif paragraphs[-1].startswith("- **"):
            paragraphs += ["", line.strip()]
        else:
            paragraphs[-1] += " " + line.strip()
    text = ""
    for paragraph in paragraphs:
        listed = paragraph.startswith("- ")
        text += ("" if listed and text.rstrip().rsplit("\n", 1)[-1].startswith("- ") else "\n") + paragraph + "\n"
    return re.sub(r"(?<![`\w])(hapto_\w+\(\)|HAPTO_[A-Z_0-9]+|scene_T_tool)", r"`\1`", text).replace("[1 kHz]", "**[1 kHz]**").strip()


def items_of(header: str) -> list[tuple[str, str]]:
    """(comment, declaration) one after the other; a section is a comment "/* --- name --- */" without one."""
    header = re.sub(r"HAPTO_RENAMED\((.*), .*\);", r"\1;", header)  # by their new names
    body = header.split('extern "C" {', 1)[1].split("#ifdef __cplusplus", 1)[0].split("#endif", 1)[1]
    found: list[tuple[str, str]] = []
    comment = ""
    lines = iter(body.splitlines())
    for line in lines:
        if line.startswith("/*"):
            while "*/" not in line:
                line += "\n" + next(lines)
            if line.startswith("/* ---"):
                found.append((line.strip("/*- "), ""))
                comment = ""
            else:
                comment = line
        elif line.strip():
            declaration = line
            block = "{" in line and "}" not in line
            while not re.search(r"^\}.*;" if block else r";", declaration.splitlines()[-1]):
                declaration += "\n" + next(lines)
            found.append((comment, declaration))
            comment = ""
    return found


def c_reference() -> str:
    """The header as a page."""
    header = (SOURCE / "include/haptolith/haptolith.h").read_text()
    introduction = header.split("*/", 1)[0]
    conventions = introduction.split("Conventions", 1)[1]
    page = ["# C reference", "", "`#include <haptolith/haptolith.h>`. This page is made of the header. What is marked **[1 kHz]** may be called in "
            "a loop that must keep time.", "", "## Conventions", ""]
    for line in conventions.splitlines():
        line = re.sub(r"^ \*( ?)", "", line.rstrip())
        line = re.sub(r"^ +- ", "- ", line)
        page.append(line if line.startswith("- ") or not line.strip() else "  " + line.strip() if page[-1].startswith(("-", "  ")) else line)
    page += items_as_page(items_of(header))
    recording = (SOURCE / "include/haptolith/recording.h").read_text()
    page += ["", "## Recordings", "", "`#include <haptolith/recording.h>`, libhaptolith_recording ([why it is a library of its own](../how-to/library.md#recordings)).", ""]
    page += items_as_page(items_of(recording), "###")
    return "\n".join(page) + "\n"


def items_as_page(items: list[tuple[str, str]], level: str = "##") -> list[str]:
    """Comments and declarations as lines of Markdown; sections are headings of that level."""
    page: list[str] = []
    for comment, declaration in items:
        if not declaration:
            page += ["", f"{level} {comment[:1].upper()}{comment[1:]}", ""]
            continue
        tail = re.search(r";\s*/\*\s*(.*?)\s*\*/$", declaration, re.S)
        text = text_of(comment) if comment else ""
        if tail and "HAPTO_API" in declaration:
            text = (text + "\n\n" + text_of(f"/* {tail[1]} */")).strip()
            declaration = declaration[: tail.start() + 1]
        function = re.search(r"HAPTO_API (.*);", declaration, re.S)
        if function:
            signature = re.sub(r"\s+", " ", function[1])
            page += [f"```{{c:function}} {signature}", "", text, "```", ""]
            continue
        struct = re.match(r"typedef struct (\w+)", declaration)
        callback = re.match(r"typedef int32_t \(\*(\w+)\)", declaration)
        if callback:
            page += [f"````{{c:type}} {callback[1]}", "", text, "", "```c", declaration, "```", "````", ""]
            continue
        name = struct[1] if struct else ""
        if struct and "{" not in declaration:
            page += [f"```{{c:type}} {name}", "", text or "A handle.", "```", ""]
            continue
        if struct:
            page += [f"````{{c:struct}} {name}", "", text, "", "```c", declaration, "```", "````", ""]
        else:
            page += [text, "", "```c", declaration, "```", ""]
    return page


# --- the command line -------------------------------------------------------------------------------------------------

def command_line(program: Path) -> str:
    """The help of every command."""
    page = ["# Command line", "", "Each command explains itself with `--help`; this page is made of that.", ""]

    for command, told in commands(program):
        page.extend([f"{'#' * (2 if len(command) < 2 else 3)} {' '.join(['haptolith', *command])}", "", "```text", told.rstrip(), "```", ""])
    return "\n".join(page)


# --- targets of links ----------------------------------------------------------------------------------------------

def page_for(path: str, staged: Path) -> str:
    """The page of a file outside docs/: a Markdown file as it is, others as a listing."""
    file = SOURCE / path
    plain = path.strip("/").replace("/", "-")
    name = f"files/{file.stem if file.suffix == '.ipynb' else plain if file.suffix == '.md' else plain.replace('.', '-')}"
    name = name if name.endswith(".md") else f"{name}.md"
    target = staged / name
    if target.exists():
        return name
    target.parent.mkdir(exist_ok=True)
    target.touch()  # before its links are followed, which may be circular
    if file.is_dir():
        inside = sorted(p.relative_to(SOURCE).as_posix() for p in file.rglob("*") if p.is_file() and p.suffix in LANGUAGES)
        text = f"# {path}\n\n" + "".join(f"- [{p}](../{page_for(p, staged)})\n" for p in inside)
    elif file.suffix == ".md":
        text = linked(file.read_text(), file.parent, staged, "../")
    elif file.suffix == ".ipynb":
        text = linked(notebook(file, staged / "files"), file.parent, staged, "../")
    else:
        text = f"# {path}\n\n````{LANGUAGES.get(file.suffix, 'none')}\n{file.read_text()}````\n"
    target.write_text("---\norphan: true\n---\n" + text)
    return name


def notebook(file: Path, folder: Path) -> str:
    """A notebook as it was last run: text, code, its output, and its figures, which are written to the folder."""
    folder.mkdir(exist_ok=True)
    page: list[str] = []
    for number, cell in enumerate(json.loads(file.read_text())["cells"]):
        source = "".join(cell["source"])
        page += [source, ""] if cell["cell_type"] == "markdown" else ["```python", source, "```", ""]
        for output in cell.get("outputs", []):
            if "text" in output:
                page += ["```text", "".join(output["text"]).rstrip(), "```", ""]
            if picture := output.get("data", {}).get("image/png"):
                name = f"{file.stem}-{number}.png"
                (folder / name).write_bytes(base64.b64decode(picture))
                page += [f"![what the cell above draws]({name})", ""]
    return "\n".join(page)


def listing(match: re.Match[str]) -> str:
    """A file of the project as it is: "@listing examples/c/dig.c" in a page."""
    file = SOURCE / match[1]
    return f"````{LANGUAGES[file.suffix]}\n{file.read_text()}````"


def linked(text: str, folder: Path, staged: Path, up: str = "") -> str:
    """A page with its links to files outside docs/ turned to pages of the manual; `up` leads to the manual's top."""

    def turned(match: re.Match[str]) -> str:
        to, _, anchor = match[1].partition("#")
        if "://" in to or not to:
            return match[0]
        file = (folder / to).resolve()
        if not file.exists():
            return match[0]
        inside = DOCS in file.parents and MAKE not in file.parents
        page = file.relative_to(DOCS).as_posix() if inside else page_for(file.relative_to(SOURCE).as_posix(), staged)
        return f"]({up}{page}{'#' + anchor if anchor else ''})"

    text = re.sub(r"^<!-- manual\n(.*?)^-->$", r"\1", text, flags=re.M | re.S)
    return re.sub(r"\]\(([^)\s]+)\)", turned, re.sub(r"^@listing (\S+)$", listing, text, flags=re.M))


def main() -> None:
    """Reads the command line."""
    build, out = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    if out.exists() and any(out.iterdir()) and not (out / ".buildinfo").exists():
        sys.exit(f"make_manual.py: {out} holds something else than a manual")
    with tempfile.TemporaryDirectory() as folder:
        make(build, out, Path(folder))


def make(build: Path, out: Path, staged: Path) -> None:
    """Puts the sources together in a folder and runs Sphinx."""
    shutil.copy(MAKE / "conf.py", staged)
    shutil.copytree(DOCS / "images", staged / "images")
    (staged / "static").mkdir()
    shutil.copy(MAKE / "manual.css", staged / "static")
    (staged / "doctrees").mkdir()
    for page in sorted(DOCS.rglob("*.md")):
        name = page.relative_to(DOCS)
        (staged / name).parent.mkdir(parents=True, exist_ok=True)
        (staged / name).write_text(linked(page.read_text(), page.parent, staged, "../" * (len(name.parts) - 1)))
    (staged / "reference/c-reference.md").write_text(c_reference())
    program = build / "apps/haptolith/haptolith"
    (staged / "reference/command-line.md").write_text(command_line(program))
    version = subprocess.run([str(program), "--version"], check=True, capture_output=True, text=True).stdout.split()[-1]
    environment = {**os.environ, "HAPTOLITH_VERSION": version, "PYTHONPATH": str(SOURCE / "python"), "PYTHONDONTWRITEBYTECODE": "1",
                   "HAPTOLITH_LIBRARY": str(build / "lib/libhaptolith.so")}
    subprocess.run(["/usr/bin/python3", "-m", "sphinx", "-q", "-W", "--keep-going", "-n", "-b", "html", "-d", str(staged / "doctrees"), str(staged), str(out)],
                   check=True, env=environment)
    bundle_theme(out / "_static")


def bundle_theme(static: Path) -> None:
    """Adapts Debian's furo, which ships its sources, to browsers, both from a server and from a file. Its script is a module with an
import, its style imports a file of the server, and lacks the dark colour scheme. Search results have no excerpts when read from a file."""
    script, imported = static / "scripts/furo.js", static / "scripts/gumshoe-patched.js"
    text = re.sub(r'^import Gumshoe from "[^"]*";\n', "", script.read_text(), flags=re.M)
    if imported.exists() and text != script.read_text():
        script.write_text(f"{imported.read_text()}\n(function () {{\n{text}}})();\n")
        imported.unlink()
    if re.search(r"^import ", script.read_text(), re.M):
        sys.exit("make_manual.py: the theme's script is a module, which no page loads")
    style = static / "styles/furo.css"
    text = re.sub(r"@import url\((/javascript/[^)]+)\);", lambda match: Path("/usr/share" + match[1]).read_text(), style.read_text())
    dark = re.search(r'body\[data-theme="dark"\] (\{.*?\})', text, re.S)
    if dark and "prefers-color-scheme" not in text:
        text += '\n@media not print { @media (prefers-color-scheme: dark) { body[data-theme="auto"] ' + dark[1] + " } }\n"
    style.write_text(text)
    with (static / "documentation_options.js").open("a") as options:
        options.write("DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = location.protocol !== 'file:';\n")


if __name__ == "__main__":
    main()
