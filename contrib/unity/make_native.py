#!/usr/bin/env python3
"""Writes the C# declarations of the C interface, org.haptolith/Runtime/Native.cs, from include/haptolith/haptolith.h.

make_native.py                writes the file.
make_native.py --check        fails when the file is not what the header says.
make_native.py --layout OUT   writes OUT/layout.c and OUT/Layout.cs, two programs that print where each field lies in memory: the
                              test compares what they print.
"""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape

SOURCE = Path(__file__).resolve().parents[2]
HEADER = SOURCE / "include/haptolith/haptolith.h"
NATIVE = SOURCE / "contrib/unity/org.haptolith/Runtime/Native.cs"

sys.path.insert(0, str(SOURCE / "docs/make"))
sys.dont_write_bytecode = True
from make_manual import items_of  # noqa: E402  # pylint: disable=wrong-import-position

NUMBERS = {"int32_t": "int", "uint32_t": "uint", "uint64_t": "ulong", "double": "double", "float": "float", "char": "byte", "void": "void"}
KEYWORDS = {"in", "out", "ref", "params", "base", "object", "string", "event", "lock", "fixed", "checked", "operator"}


@dataclass
class Field:
    """A field of a struct, or an argument of a function."""

    name: str
    type: str
    count: int = 0  # length of an array in the struct; 0: no array
    comment: str = ""


@dataclass
class Header:
    """Declarations of a header."""

    handles: set[str] = field(default_factory=set)
    callbacks: set[str] = field(default_factory=set)
    structs: dict[str, list[Field]] = field(default_factory=dict)

    def type_of(self, c_type: str) -> str:
        """C# type of a C type: handles and functions are IntPtr, everything else is a number, a struct or a pointer."""
        name = re.sub(r"\bconst\b|\*|\s", "", c_type)
        stars = c_type.count("*")
        if name in self.handles:
            return "IntPtr" + "*" * (stars - 1)
        if name in self.callbacks:
            return "IntPtr"
        if name in self.structs:
            return name + "*" * stars
        if name not in NUMBERS:
            sys.exit(f"make_native.py: the header has a type that this script does not know: {c_type!r}")
        return NUMBERS[name] + "*" * stars

    def argument(self, declared: str) -> Field:
        """Parses an argument such as "const double m_s2[3]"."""
        match = re.fullmatch(r"(.*?)(\w+)(\[\d+\])?", declared.strip())
        assert match, declared
        return Field(match[2], self.type_of(match[1] + ("*" if match[3] else "")))

    def arguments(self, declared: str) -> list[Field]:
        """Parses all arguments of a function."""
        return [] if declared.strip() == "void" else [self.argument(one) for one in declared.split(",")]


def one_line(comment: str) -> str:
    """Text of a C comment without its delimiters."""
    lines = re.sub(r"^/\*|\*/$", "", comment.strip()).splitlines()
    return " ".join(re.sub(r"^\s*\* ?", "", line).strip() for line in lines).strip()


def safe(name: str) -> str:
    """Name, escaped if it is a keyword of C#."""
    return "@" + name if name in KEYWORDS else name


def list_of(arguments: list[Field]) -> str:
    """Arguments as declared in C#."""
    return ", ".join(f"{one.type} {safe(one.name)}" for one in arguments)


def summary(comment: str, indent: str) -> list[str]:
    """C# documentation comment from a C comment."""
    lines = [re.sub(r"^ \* ?", "", line.rstrip()) for line in re.sub(r"^/\*|\*/$", "", comment.strip()).strip().splitlines()]
    if not lines:
        return []
    inside = [f"{indent}/// {escape(line)}".rstrip() for line in lines]
    if len(inside) == 1:
        return [f"{indent}/// <summary>{escape(lines[0])}</summary>"]
    return [f"{indent}/// <summary>", *inside, f"{indent}/// </summary>"]


def struct(header: Header, name: str, declaration: str) -> tuple[list[str], list[str]]:
    """Declaration of a struct, and the types of its function pointers."""
    body = declaration[declaration.index("{") + 1 : declaration.rindex("}")]
    body = re.sub(r"^\s*/\*.*?\*/", "", body, flags=re.S)  # the comment after the brace is written above the struct
    fields: list[Field] = []
    delegates: list[str] = []
    for declared, comment in re.findall(r"([^;]+);[ \t]*(/\*.*?\*/)?", body, flags=re.S):
        declared = " ".join(declared.split())
        said = one_line(comment)
        function = re.fullmatch(r"(\w+) \(\*(\w+)\)\((.*)\)", declared)
        if function:
            arguments = list_of(header.arguments(function[3]))
            delegates += [delegate(f"{name}_{function[2]}", header.type_of(function[1]), arguments)]
            fields.append(Field(function[2], "IntPtr", 0, f"{name}_{function[2]}" + (f"; {said}" if said else "")))
            continue
        match = re.fullmatch(r"((?:const )?\w+)\s+(.*)", declared)
        assert match, declared
        for number, one in enumerate(match[2].split(",")):
            parts = re.fullmatch(r"\s*(\**)(\w+)(?:\[(\d+)\])?", one)
            assert parts, declared
            fields.append(Field(parts[2], header.type_of(match[1] + parts[1]), int(parts[3] or 0), said if number == 0 else ""))
    header.structs[name] = fields
    behind = re.match(r"[^{]*\{ */\*(.*?)\*/", declaration)
    lines = summary(behind[1], "  ") if behind else []
    lines += ["  [StructLayout(LayoutKind.Sequential)]", f"  public unsafe struct {name}", "  {"]
    for one in fields:
        fixed = f"fixed {one.type} {safe(one.name)}[{one.count}]" if one.count else f"{one.type} {safe(one.name)}"
        lines.append(f"    public {fixed};" + (f"  // {one.comment}" if one.comment else ""))
    return lines + ["  }", ""], delegates


def delegate(name: str, result: str, arguments: str) -> str:
    """Declaration of the type of a callback."""
    return f"  [UnmanagedFunctionPointer(CallingConvention.Cdecl)]\n  public unsafe delegate {result} {name}({arguments});\n"


def native(header: Header) -> str:
    """Text of the complete file; fills the header."""
    types: list[str] = []
    constants: list[str] = []
    functions: list[str] = []
    section = ""
    for comment, declaration in items_of(HEADER.read_text()):
        handle = re.fullmatch(r"typedef struct (\w+) (\w+);", declaration)
        callback = re.fullmatch(r"typedef (\w+) \(\*(\w+)\)\((.*)\);", declaration)
        named = re.match(r"typedef struct (\w+) \{", declaration)
        function = re.match(r"HAPTO_API ([\w ]+[ *]+?)(hapto_\w+)\((.*?)\);", declaration, re.S)
        if not declaration:
            section = comment
        elif handle:
            header.handles.add(handle[1])
        elif callback:
            header.callbacks.add(callback[2])
            types += summary(comment, "  ")
            types.append(delegate(callback[2], header.type_of(callback[1]), list_of(header.arguments(callback[3]))))
        elif named:
            lines, delegates = struct(header, named[1], declaration)
            types += delegates + summary(comment, "  ") + lines
        elif declaration.startswith("enum"):
            for name, value, said in re.findall(r"(HAPTO_\w+) = (\d+),?[ \t]*(/\*.*?\*/)?", declaration, re.S):
                constants.append(f"    public const int {name} = {value};" + (f"  // {one_line(said)}" if said else ""))
            constants.append("")
        elif function:
            tail = re.search(r";\s*(/\*.*\*/)$", declaration, re.S)
            functions += [f"    // {section}", ""] if section else []
            section = ""
            functions += summary(comment or (tail[1] if tail else ""), "    ")
            arguments = list_of(header.arguments(" ".join(function[3].split())))
            functions += ["    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]",
                          f"    public static extern {header.type_of(function[1])} {function[2]}({arguments});", ""]
        else:
            sys.exit(f"make_native.py: the header has a declaration that this script does not know: {declaration!r}")
    major, minor = re.search(r"project\(haptolith VERSION (\d+)\.(\d+)\.", (SOURCE / "CMakeLists.txt").read_text()).groups()  # type: ignore[union-attr]
    return "\n".join([
        "// Made by contrib/unity/make_native.py from include/haptolith/haptolith.h: do not edit. It names everything as C does, and explains it in",
        "// C's words. Handles and functions are IntPtr; structs are plain memory and go to the library as they are.",
        "#pragma warning disable IDE1006, CS0649",
        "using System;", "using System.Runtime.InteropServices;", "", "namespace Haptolith", "{", *types,
        "  /// <summary>The functions of libhaptolith, as they are in C.</summary>", "  public static unsafe class Native", "  {",
        "    /// <summary>The system makes libhaptolith.so of it.</summary>", '    public const string Library = "haptolith";', "",
        "    /// <summary>1000 * major + minor of the header: a library of another minor version is laid out otherwise.</summary>",
        f"    public const uint HeaderVersion = {1000 * int(major) + int(minor)};", "",
        *constants, *functions[:-1], "  }", "}", ""])


def layout(header: Header, out: Path) -> None:
    """Writes two programs that print "struct size" and "struct.field offset", in C and in C#."""
    c = ["#include <haptolith/haptolith.h>", "#include <stddef.h>", "#include <stdio.h>", "int main(void) {"]
    cs = ["using System;", "using Haptolith;", "static unsafe class Layout", "{", "  static void Main()", "  {"]
    for name, fields in header.structs.items():
        c.append(f'  printf("{name} %zu\\n", sizeof({name}));')
        cs += ["    {", f"      {name} it;", "      byte* start = (byte*)&it;", f'      Console.WriteLine("{name} " + sizeof({name}));']
        for one in fields:
            c.append(f'  printf("{name}.{one.name} %zu\\n", offsetof({name}, {one.name}));')
            address = f"it.{safe(one.name)}" if one.count else f"&it.{safe(one.name)}"
            cs.append(f'      Console.WriteLine("{name}.{one.name} " + ((byte*){address} - start));')
        cs.append("    }")
    (out / "layout.c").write_text("\n".join([*c, "  return 0;", "}", ""]))
    (out / "Layout.cs").write_text("\n".join([*cs, "  }", "}", ""]))


def main() -> None:
    """Reads the command line."""
    header = Header()
    text = native(header)
    if sys.argv[1:] == ["--check"]:
        if not NATIVE.exists() or NATIVE.read_text() != text:
            sys.exit(f"{NATIVE.relative_to(SOURCE)} is not what {HEADER.relative_to(SOURCE)} says: run contrib/unity/make_native.py")
    elif sys.argv[1:2] == ["--layout"] and len(sys.argv) == 3:
        layout(header, Path(sys.argv[2]))
    elif len(sys.argv) == 1:
        NATIVE.write_text(text)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
