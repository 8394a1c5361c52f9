"""Results of the library with more than one number."""

from __future__ import annotations

import ctypes
import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _abi
from .errors import require
from .values import Floats


@dataclass(frozen=True)
class Result:
    """Numbers by name (`values`, as JSON has them) and columns of a table, each (n,)."""

    values: dict[str, Any]
    columns: dict[str, Floats]

    def __getitem__(self, name: str) -> Any:
        return self.columns[name] if name in self.columns else self.values[name]

    def __repr__(self) -> str:
        told = [f"{name}={value:.4g}" if isinstance(value, float) else f"{name}={value!r}"
                for name, value in self.values.items() if isinstance(value, (str, int, float))]
        told += [f"{name}=..." for name, value in self.values.items() if isinstance(value, (dict, list))]
        told += [f"{name}=array of {len(numbers)}" for name, numbers in self.columns.items()]
        return f"<haptolith.Result: {', '.join(told)}>"


def take(handle: ctypes.c_void_p) -> Result:
    """A result of the library as Python objects; the library's is destroyed."""
    try:
        text = ctypes.c_char_p()
        require(_abi.lib.hapto_result_json(handle, ctypes.byref(text)))
        values: dict[str, Any] = json.loads(text.value or b"{}")
        columns: dict[str, Floats] = {}
        for name in values.pop("columns", []):
            array = _abi.sized(_abi.Array)
            require(_abi.lib.hapto_result_column(handle, name.encode(), array))
            numbers = (ctypes.c_double * array.count).from_address(array.data) if array.count else (ctypes.c_double * 0)()
            columns[name] = np.array(numbers, dtype=np.float64)
        return Result(values, columns)
    finally:
        _abi.lib.hapto_result_destroy(handle)


def names(what: str) -> list[str]:
    """hapto_list(): "scenes", "soils", "presets", "bodies", "lab tests"."""
    handle = ctypes.c_void_p()
    require(_abi.lib.hapto_list(what.encode(), ctypes.byref(handle)))
    listed: list[str] = take(handle).values["names"]
    return listed
