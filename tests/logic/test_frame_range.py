"""Ranges of frames, as farms write them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.logic.frame_range import FrameRangeError, even_step, parse, steps, text_of


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("7", [7]),
        ("1-5", [1, 2, 3, 4, 5]),
        ("1-10x4", [1, 5, 9]),
        ("-2--1", [-2, -1]),
        ("1-2x0.25", [1, 1.25, 1.5, 1.75, 2]),
        ("5, 1-3 ,2", [1, 2, 3, 5]),
    ],
)
def test_ranges_name_frames(text: str, expected: list[float]):
    assert parse(text).tolist() == expected


@pytest.mark.parametrize("text", ["", "a", "5-1", "1-5x0", "1-", "1-2-3", "1-1e9", "1-9999999999", "1,,2"])
def test_what_names_no_frames_is_refused(text: str):
    with pytest.raises(FrameRangeError):
        parse(text)


@given(st.lists(st.integers(-4096, 40960), min_size=1, max_size=60, unique=True))
def test_text_and_frames_go_round(quarters: list[int]):
    frames = np.sort(np.array(quarters) / 4.0)
    assert parse(text_of(frames)).tolist() == frames.tolist()


@given(st.integers(-1000, 1000), st.integers(1, 16), st.integers(1, 300))
def test_even_steps_are_found_and_uneven_ones_are_not(first: int, part: int, count: int):
    frames = steps(first, first + count, 1.0 / part)
    assert len(frames) == count * part + 1
    assert even_step(frames) == pytest.approx(1.0 / part, rel=1e-3)
    if len(frames) > 3:
        assert even_step(np.delete(frames, 1)) is None
