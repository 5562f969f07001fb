"""New folds as Blender sees them: candidates from its own tree, decided by numpy; the engine is not asked."""

from __future__ import annotations

import numpy as np
from mathutils.bvhtree import BVHTree

from ..enclosed_volume import Indices, Points

# Part of the longest side by which pairs may differ that single precision leaves in doubt.
DOUBT = 1e-4


def new_folds(before: Points, after: Points, triangles: Indices) -> Indices:
    """(K, 2) pairs of triangles that pass through each other after, and before do not even touch."""
    pairs = candidates(after, triangles)
    pairs = pairs[passing(after, triangles, pairs, -DOUBT)]
    return pairs[~passing(before, triangles, pairs, DOUBT)]


def folds(points: Points, triangles: Indices) -> Indices:
    """(K, 2) all pairs that pass through each other."""
    pairs = candidates(points, triangles)
    return pairs[passing(points, triangles, pairs, -DOUBT)]


def candidates(points: Points, triangles: Indices) -> Indices:
    """(K, 2) pairs without two corners in common that Blender's tree says meet, smaller number first."""
    tree = BVHTree.FromPolygons(points.tolist(), triangles.tolist(), all_triangles=True)
    pairs = np.array(tree.overlap(tree), np.intp).reshape(-1, 2)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    shared = (triangles[pairs[:, 0]][:, :, None] == triangles[pairs[:, 1]][:, None]).sum(axis=(1, 2))
    return pairs[shared < 2]


def passing(points: Points, triangles: Indices, pairs: Indices, slack: float) -> np.ndarray:
    """(K,) whether a side of one goes through the other.

    slack: part of the longest side by which it may miss the border, or must stay within it and go through.
    """
    found = np.zeros(len(pairs), bool)
    for a, b in (pairs.T, pairs[:, ::-1].T):
        for corner in range(3):
            side = triangles[a][:, [corner, (corner + 1) % 3]]
            is_apart = (side[:, :, None] != triangles[b][:, None]).all(axis=(1, 2))
            found |= is_apart & _goes_through(points[side[:, 0]], points[side[:, 1]], points[triangles[b]], slack)
    return found


def _goes_through(start: Points, end: Points, triangle: Points, slack: float) -> np.ndarray:
    a, b, c = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    longest = np.max([np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a), (start, end))], axis=0)
    deep = max(-slack, 0.0) * longest * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    first, second = _volume(a, b, c, start), _volume(a, b, c, end)
    turns = np.stack([_volume(start, end, *pair) for pair in ((a, b), (b, c), (c, a))])
    room = slack * longest**3
    is_through = (turns >= -room).all(axis=0) | (turns <= room).all(axis=0)
    return is_through & (np.minimum(first, second) < -deep) & (np.maximum(first, second) > deep)


def _volume(a: Points, b: Points, c: Points, d: Points) -> Points:
    return np.einsum("ni,ni->n", np.cross(b - a, c - a), d - a)
