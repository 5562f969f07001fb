"""Which frames to bake: ranges as farms write them, and steps within frames."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

_NUMBER = r"[+-]?\d+(?:\.\d+)?"
_PART = re.compile(rf"({_NUMBER})(?:-({_NUMBER})(?:x(\d+(?:\.\d+)?))?)?")
# More times than anybody means; a step written wrongly must not fill the memory.
MOST_FRAMES = 1_000_000
# Times are whole multiples of this part of a frame: equal times are found equal.
GRAIN = 1.0 / 4096.0


class FrameRangeError(ValueError):
    """The text or the steps name no frames; says what is needed."""


def parse(text: str) -> NDArray[np.float64]:
    """`1-100x2`, `-5-5`, `1,7,20-30x0.5`: (F,) rising times in frames, each once.

    x gives the step, 1 when there is none; a range holds its first frame and those a whole number of steps later.
    Raises FrameRangeError.
    """
    found: list[NDArray[np.float64]] = []
    for part in text.replace(" ", "").split(","):
        match = _PART.fullmatch(part)
        if match is None:
            raise FrameRangeError(f"Frames {text!r}: need numbers and ranges like 1-100, 1-100x2 or 3,7,20-30")
        first, last, step = match.groups()
        found.append(steps(float(first), float(last or first), float(step or 1.0)))
    return np.unique(np.concatenate(found))


def steps(first: float, last: float, step: float) -> NDArray[np.float64]:
    """(F,) times from `first` to `last`, both in frames, a step apart. Raises FrameRangeError."""
    if not (np.isfinite([first, last, step]).all() and step > 0.0):
        raise FrameRangeError(f"Frames {first:g}-{last:g}x{step:g}: need a step above 0")
    if last < first:
        raise FrameRangeError(f"Frames {first:g}-{last:g}: the last comes before the first, swap them")
    count = np.floor((last - first) / step + GRAIN) + 1.0
    if count > MOST_FRAMES:
        raise FrameRangeError(f"Frames {first:g}-{last:g}x{step:g}: {count:.0f} of them, need at most {MOST_FRAMES}")
    return np.round((first + step * np.arange(int(count))) / GRAIN) * GRAIN


def even_step(frames: NDArray[np.float64]) -> float | None:
    """The one step between all frames; 1 for a single frame, None where steps differ."""
    if len(frames) < 2:
        return 1.0
    gaps = np.diff(frames)
    mean = float(frames[-1] - frames[0]) / len(gaps)
    return mean if np.abs(gaps - mean).max() <= 2.0 * GRAIN else None


def text_of(frames: NDArray[np.float64]) -> str:
    """The shortest range that `parse` reads as these frames."""
    parts: list[str] = []
    start = 0
    while start < len(frames):
        end = start + 1
        while end + 1 < len(frames) and frames[end + 1] - frames[end] == frames[start + 1] - frames[start]:
            end += 1
        if end < len(frames) and end - start > 1:
            step = frames[start + 1] - frames[start]
            parts.append(f"{_plain(frames[start])}-{_plain(frames[end])}" + (f"x{_plain(step)}" if step != 1.0 else ""))
            start = end + 1
        else:
            parts.append(_plain(frames[start]))
            start += 1
    return ",".join(parts)


def _plain(number: float) -> str:
    return np.format_float_positional(number, trim="-")
