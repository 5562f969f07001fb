"""Values that are worked out when somebody looks."""

from __future__ import annotations

import pytest

from addon.logic.lazy import Lazy


def test_value_is_worked_out_once_and_only_when_asked():
    found = []
    value = Lazy(lambda: found.append(1) or len(found))
    assert not found
    assert value() == value() == 1


def test_value_that_failed_is_asked_for_again():
    answers = iter([ValueError("not yet"), None])

    def work() -> None:
        answer = next(answers)
        if answer is not None:
            raise answer

    value = Lazy(work)
    with pytest.raises(ValueError, match="not yet"):
        value()
    assert value() is None
    assert value() is None
