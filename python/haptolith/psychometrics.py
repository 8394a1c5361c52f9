"""Psychometric functions, fitted to answers."""

from __future__ import annotations

import ctypes

import numpy as np
import numpy.typing as npt

from . import _abi
from .errors import require
from .result import Result, take
from .values import toml_value


def fit_psychometric(x: npt.ArrayLike, k: npt.ArrayLike, n: npt.ArrayLike, **options: object) -> Result:
    """Fits a psychometric function to k positive ones of n answers to each stimulus x, as `haptolith study fit` does.

    x, k, n: (m,); n may be one number. For single trials k is 0 or 1 and n is 1. options: sigmoid ("weber", "norm",
    "logistic", "weibull", ...), design ("equal-asymptote", "yesno", "2afc", "nafc" with alternatives), reference, lapse,
    guess, overdispersion (a number or "free"), log_x, falling, method ("map", "median", "ml"), confidence, simulations.
    The result has threshold, width, jnd, weber_fraction, intervals, p_value, ...; columns x, psi, psi_low, psi_high are
    the function and its band. Raises InvalidParameter for what makes no sense."""
    stimuli, positive, answers = np.broadcast_arrays(np.atleast_1d(x), k, n)
    levels = np.ascontiguousarray(np.column_stack([stimuli, positive, answers]), dtype=np.float64)
    text = "".join(f"{key} = {toml_value(value)}\n" for key, value in options.items()).encode()
    out = ctypes.c_void_p()
    require(_abi.lib.hapto_psychometric_fit(levels.ctypes.data, len(levels), text, ctypes.byref(out)))
    return take(out)
