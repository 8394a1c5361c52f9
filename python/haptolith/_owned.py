"""What holds something of the library's."""

from __future__ import annotations

from typing import Any, Callable, ClassVar, Optional, TypeVar

from . import _abi
from .errors import HaptolithError

Self = TypeVar("Self", bound="Owned")


class Owned:
    """Holds a handle of the library until close(), the end of a with block, or its own end."""

    _destroy: ClassVar[Callable[[int], int]]
    _handle: Optional[int] = None

    @property
    def address(self) -> int:
        """The library's handle. Raises HaptolithError when it has been closed."""
        if not self._handle:
            raise HaptolithError(f"this {type(self).__name__.lower()} has been closed", _abi.DESTROYED)
        return self._handle

    def close(self) -> None:
        """Gives back what it holds; a second time does nothing."""
        if self._handle:
            type(self)._destroy(self._handle)
            self._handle = None

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, *_raised: Any) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()
