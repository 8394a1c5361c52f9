"""Calls that take long: their progress, and Ctrl-C."""

from __future__ import annotations

import sys
import threading
import time
from typing import Any, Callable, Optional

from . import _abi
from .errors import error_of

Progress = Callable[[str, float], Optional[bool]]


def _interactive() -> bool:
    return hasattr(sys, "ps1") or "ipykernel" in sys.modules


class ProgressLine:
    """One line on standard error, written over and over, from the second second of long work on."""

    def __init__(self) -> None:
        self._began = self._next = time.monotonic()
        self._next += 2
        self._shown = False

    def __call__(self, what: str, share: float) -> None:
        now = time.monotonic()
        if now >= self._next:
            sys.stderr.write(f"\r{what}: {100 * share:.0f} %, {now - self._began:.0f} s ")
            sys.stderr.flush()
            self._shown, self._next = True, now + 0.5

    def end(self) -> None:
        """Ends the line, if there is one."""
        if self._shown:
            sys.stderr.write("\n")


def call_long(function: Callable[[Any], int], progress: Optional[Progress]) -> None:
    """Calls function(callback) on a separate thread, so that this one receives Ctrl-C; raises its exception.

    progress(what, share) may return False to give up; what it raises ends the work and is raised here. Without one, an interactive session
    shows a line."""
    line = ProgressLine() if progress is None and _interactive() else None
    progress = line or progress
    given_up = threading.Event()
    raised: list[BaseException] = []
    outcome: list[Optional[BaseException]] = []

    def told(_user: object, what: bytes, share: float) -> int:
        if given_up.is_set():
            return 0
        try:
            if progress is not None and progress(what.decode(), share) is False:
                return 0
        except BaseException as error:  # pylint: disable=broad-except
            raised.append(error)
            return 0
        return 1

    callback = _abi.PROGRESS(told)

    def work() -> None:
        try:
            status = function(callback)
            outcome.append(None if status == _abi.OK else error_of(status))  # the error is this thread's
        except BaseException as error:  # pylint: disable=broad-except
            outcome.append(error)  # wrong arguments, before the library was called

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(0.05)
    except BaseException:
        given_up.set()
        thread.join()
        raise
    finally:
        if line is not None:
            line.end()
    if raised:
        raise raised[0]
    if outcome[0] is not None:
        raise outcome[0]
