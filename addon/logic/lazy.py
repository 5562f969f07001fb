"""A value that is worked out when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Lazy(Generic[Value]):
    """Calls `work` once, when it is first called itself; work that raised is tried again.

    Several are made in every frame, and making one takes less time than `functools.cache`.
    """

    __slots__ = ("_value", "_work")

    _value: Value

    def __init__(self, work: Callable[[], Value]) -> None:
        self._work: Callable[[], Value] | None = work

    def __call__(self) -> Value:
        """The value, worked out when this is called for the first time. Raises whatever `work` raises."""
        work = self._work
        if work is not None:
            self._value = work()
            self._work = None
        return self._value
