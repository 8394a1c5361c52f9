"""The package's idea of the C interface is the header's."""

import ctypes
import json
import os
import re
import subprocess
from pathlib import Path

import pytest

import haptolith as hp
from haptolith import _abi, recording

SOURCE = Path(__file__).resolve().parents[2]
HEADER = SOURCE / "include/haptolith/haptolith.h"
RECORDING = SOURCE / "include/haptolith/recording.h"
both = pytest.mark.parametrize("header, module", [(HEADER, _abi), (RECORDING, recording)], ids=["haptolith", "recording"])


@both
def test_every_function_of_the_header_has_a_signature(header, module):
    declared = re.findall(r"HAPTO_API [\w ]+[ *](hapto_\w+)\(", header.read_text())
    assert len(declared) > 10 and sorted(declared) == sorted(module.SIGNATURES)


@both
def test_signatures_have_as_many_arguments(header, module):
    text = re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S)
    for name, arguments in module.SIGNATURES.items():
        in_header = re.search(rf"\b{name}\(([^;]*)\);", text).group(1)
        count = 0 if in_header.strip() == "void" else in_header.count(",") + 1
        assert count == len(arguments), name


@both
def test_structs_lie_in_memory_as_in_c(header, module, tmp_path):
    lines = []
    for name, struct in module.STRUCTS.items():
        fields = ", ".join(f'\\"{field}\\": %zu' for field, _ in struct._fields_)
        values = ", ".join(f"offsetof({name}, {field})" for field, _ in struct._fields_)
        lines.append(f'printf("\\"{name}\\": [%zu, {{{fields}}}],\\n", sizeof({name}), {values});')
    source = tmp_path / "layout.c"
    source.write_text("#include <haptolith/" + header.name + ">\n#include <stddef.h>\n#include <stdio.h>\nint main(void) {\n"
                      'printf("{");\n' + "\n".join(lines) + '\nprintf("\\"end\\": 0}");\nreturn 0;\n}\n')
    program = tmp_path / "layout"
    includes = [f"-I{SOURCE / 'include'}", f"-I{os.environ['HAPTOLITH_BUILD']}/include"]
    subprocess.run(["cc", "-std=c99", *includes, str(source), "-o", str(program)], check=True)
    layout = json.loads(subprocess.run([str(program)], check=True, capture_output=True, text=True).stdout)
    declared = re.findall(r"typedef struct (hapto_\w+) \{", header.read_text())
    assert sorted(declared) == sorted(module.STRUCTS)
    for name, struct in module.STRUCTS.items():
        size, offsets = layout[name]
        assert ctypes.sizeof(struct) == size, name
        assert {field: getattr(struct, field).offset for field, _ in struct._fields_} == offsets, name


@pytest.mark.parametrize("name", ["HAPTO_TOO_SMALL", "HAPTO_ENDED", "HAPTO_CONTACT_LOAD", "HAPTO_LOOP_KEEPS_TICKS"])
def test_constants(name):
    value = int(re.search(rf"\b{name} = (\d+)", HEADER.read_text()).group(1))
    own = name.removeprefix("HAPTO_").removeprefix("LOOP_")
    assert getattr(_abi, own) == value


@pytest.mark.parametrize("prefix, enum, count", [("HAPTO_TRIP_", hp.Trip, 9), ("HAPTO_TICK_", hp.TickFlag, 14)])
def test_enums_are_the_headers(prefix, enum, count):
    declared = {name: int(value) for name, value in re.findall(rf"\b{prefix}(\w+) = (\d+)", HEADER.read_text())}
    assert len(declared) == count
    assert {name: int(member) for name, member in enum.__members__.items()} == declared  # deprecated names too
