"""Handles that Blender sets by itself when shape keys or hooks have moved the points of a curve, or when it draws."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

# Makes four automatic points on a circle a circle, nearly: Blender's own number.
AUTO_LENGTH = 2.5614
# One automatic handle is at most so many times as long as the other.
AUTO_RATIO = 5.0


def recalculate(handles: NDArray[np.float64], left_types: Sequence[str], right_types: Sequence[str]) -> None:
    """Sets automatic and vector handles of (n, 3, 3) rows of left handle, point, right handle, in place.

    Aligned and free handles are left as they are.
    """
    points = handles[:, 1].copy()
    count = len(points)
    for i, (left, right) in enumerate(zip(left_types, right_types, strict=True)):
        before = points[i - 1] if i > 0 else 2 * points[i] - points[i + 1]
        after = points[i + 1] if i + 1 < count else 2 * points[i] - points[i - 1]
        into, out = points[i] - before, after - points[i]
        length_in, length_out = (np.linalg.norm(into) or 1.0), (np.linalg.norm(out) or 1.0)
        tangent = into / length_in + out / length_out
        length = np.linalg.norm(tangent) * AUTO_LENGTH
        if left == "VECTOR":
            handles[i, 0] = points[i] - into / 3.0
        elif left == "AUTO" and length:
            handles[i, 0] = points[i] - tangent * min(length_in, AUTO_RATIO * length_out) / length
        if right == "VECTOR":
            handles[i, 2] = points[i] + out / 3.0
        elif right == "AUTO" and length:
            handles[i, 2] = points[i] + tangent * min(length_out, AUTO_RATIO * length_in) / length


def straighten(handles: NDArray[np.float64], left_types: Sequence[str], right_types: Sequence[str]) -> None:
    """Sets handles of segments between two vector handles, which are drawn straight wherever those are, in place."""
    for i in range(len(handles) - 1):
        if right_types[i] == left_types[i + 1] == "VECTOR":
            third = (handles[i + 1, 1] - handles[i, 1]) / 3.0
            handles[i, 2], handles[i + 1, 0] = handles[i, 1] + third, handles[i + 1, 1] - third
