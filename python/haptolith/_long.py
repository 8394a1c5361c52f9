"""Calls that take long: their progress, and Ctrl-C."""

from __future__ import annotations

import threading
from typing import Any, Callable, Optional

from . import _abi
from .errors import error_of

Progress = Callable[[str, float], Optional[bool]]


def call_long(function: Callable[[Any], int], progress: Optional[Progress]) -> None:
    """Calls function(callback) on a thread of its own, so that this one hears Ctrl-C; raises what went wrong.

    progress(what, share) may return False to give up; what it raises ends the work and is raised here."""
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
    if raised:
        raise raised[0]
    if outcome[0] is not None:
        raise outcome[0]
