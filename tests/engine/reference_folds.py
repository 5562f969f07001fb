"""Folds counted by numpy alone: pairs of triangles that pass through each other, all against all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from surfaces import Surface

Pairs = set[tuple[int, int]]
# Part of the longest side by which two that are found by other means may differ.
DOUBT = 1e-5
# Pairs that are looked at together.
CHUNK = 1 << 20


def triangles_of(surface: Surface) -> NDArray[np.int64]:
    """(T, 3) of triangles and quads, these from their first corner to the third."""
    found = []
    for start, end in zip(surface.face_offsets, surface.face_offsets[1:], strict=False):
        face = surface.face_corners[start:end]
        assert len(face) <= 4
        found += [[face[0], face[i], face[i + 1]] for i in range(1, len(face) - 1)]
    return np.array(found, np.int64).reshape(-1, 3)


def new_pairs(before: NDArray[np.float64], after: NDArray[np.float64], triangles: NDArray[np.int64]) -> Pairs:
    """Pairs that pass through each other beyond doubt after, and before do not even touch."""
    return crossing_pairs(after, triangles, -DOUBT) - crossing_pairs(before, triangles, DOUBT)


def crossing_pairs(points: NDArray[np.float64], triangles: NDArray[np.int64], slack: float = 0.0) -> Pairs:
    """All pairs of which one has a side that goes through the other; those with two corners in common never do.

    slack: part of the longest side by which a line may miss the other triangle's border, or must stay within it.
    """
    corners = points[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    found: Pairs = set()
    rows = max(CHUNK // max(len(triangles), 1), 1)
    for start in range(0, len(triangles), rows):
        part = slice(start, start + rows)
        meets = (low[part, None] <= high[None]).all(axis=2) & (low[None] <= high[part, None]).all(axis=2)
        first, second = np.nonzero(meets)
        first += start
        first, second = first[first < second], second[first < second]
        shared = (triangles[first][:, :, None] == triangles[second][:, None]).sum(axis=(1, 2))
        passes = np.zeros(len(first), bool)
        for a, b in ((first, second), (second, first)):
            for corner in range(3):
                side = triangles[a][:, [corner, (corner + 1) % 3]]
                is_apart = (side[:, :, None] != triangles[b][:, None]).all(axis=(1, 2))
                passes |= is_apart & _goes_through(points[side[:, 0]], points[side[:, 1]], corners[b], slack)
        passes &= shared < 2
        found |= set(zip(first[passes].tolist(), second[passes].tolist(), strict=True))
    return found


def _goes_through(
    start: NDArray[np.float64], end: NDArray[np.float64], triangle: NDArray[np.float64], slack: float
) -> NDArray[np.bool_]:
    """(P,) whether a line from one side to the other of a triangle, (P, 3, 3), goes through it."""
    a, b, c = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    longest = np.max([np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a), (start, end))], axis=0)
    normal = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    deep = np.maximum(-slack, 0.0) * longest * normal
    first, second = _volume(a, b, c, start), _volume(a, b, c, end)
    is_apart = (np.minimum(first, second) < -deep) & (np.maximum(first, second) > deep)
    room = slack * longest**3
    turns = np.stack([_volume(start, end, *pair) for pair in ((a, b), (b, c), (c, a))])
    return is_apart & ((turns >= -room).all(axis=0) | (turns <= room).all(axis=0))


def _volume(a, b, c, d) -> NDArray[np.float64]:
    return np.einsum("ni,ni->n", np.cross(b - a, c - a), d - a)
