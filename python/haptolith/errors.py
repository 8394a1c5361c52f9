"""What the library did not do, as exceptions."""

from __future__ import annotations

from . import _abi


class HaptolithError(RuntimeError):
    """Something was not done; `status` is the library's number for why."""

    def __init__(self, message: str, status: int = _abi.FAILURE) -> None:
        super().__init__(message)
        self.status = status


class InvalidParameter(HaptolithError, ValueError):
    """A value is not valid: `key` names it, `value` is what was given, `valid` what would be right."""

    def __init__(self, message: str, key: str, value: str, valid: str) -> None:
        super().__init__(message, _abi.INVALID_PARAMETER)
        self.key, self.value, self.valid = key, value, valid

    def __reduce__(self) -> tuple[type[InvalidParameter], tuple[str, str, str, str]]:
        return InvalidParameter, (str(self), self.key, self.value, self.valid)


class Failure(HaptolithError):
    """A valid request that failed: no file, no device, soil that does not settle."""


class Stopped(HaptolithError):
    """The progress function gave up."""


class Busy(HaptolithError):
    """Another thread or a loop is using this."""


class Collapsed(HaptolithError):
    """The soil is no longer soil; only another state helps."""


_KINDS: dict[int, type[HaptolithError]] = {
    _abi.FAILURE: Failure, _abi.STOPPED: Stopped, _abi.BUSY: Busy, _abi.NOT_FINITE: Collapsed,
    _abi.COLLAPSED: Collapsed,
}


def error_of(status: int) -> BaseException:
    """The exception for a status that a function has just given on this thread."""
    error = _abi.sized(_abi.Error)
    _abi.lib.hapto_last_error(error)
    noted = error.status == status
    message = (error.message if noted else b"").decode(errors="replace") or _abi.lib.hapto_status_text(status).decode()
    if status == _abi.NO_MEMORY:
        return MemoryError(message)
    if status == _abi.INVALID_PARAMETER:
        key, value, valid = ((error.key, error.value, error.valid) if noted else (b"", b"", b""))
        return InvalidParameter(message, key.decode(), value.decode(errors="replace"), valid.decode())
    return _KINDS.get(status, HaptolithError)(message, status)


def require(status: int) -> None:
    """Raises the exception of a status, unless it is OK."""
    if status != _abi.OK:
        raise error_of(status)
