"""How often each face is split: by what joints ask for, and so that what lies around can follow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .polygons import Faces, edges_of

# Four to the power of this many faces come of one.
MOST_LEVELS = 4


def wanted_levels(
    faces: Faces,
    positions: NDArray[np.floating],
    gamma: NDArray[np.floating],
    edge_lengths: NDArray[np.floating],
    threshold: float,
    levels: int,
    *,
    is_automatic: bool,
) -> NDArray[np.int32]:
    """(F,) levels of the faces where some vertex has more gamma than the threshold, 0 elsewhere.

    positions: (N, 3). gamma, edge_lengths: (N,), as the engine finds them. is_automatic: only as many of `levels` as
    make the longest edge of the face as short as its corners ask for.
    """
    if not len(faces.corners):
        return np.zeros(len(faces.offsets) - 1, np.int32)
    found = np.where(faces.most(gamma[faces.corners]) > threshold, levels, 0)
    if is_automatic:
        points = positions[faces.corners].astype(np.float64)
        longest = faces.most(np.linalg.norm(points[faces.following] - points, axis=1))
        asked = -faces.most(-edge_lengths[faces.corners].astype(np.float64))
        with np.errstate(divide="ignore"):
            needed = np.ceil(np.log2(longest / asked) - 1e-6)
        found = np.minimum(found, np.clip(needed, 0, levels))
    return found.astype(np.int32)


def balanced(faces: Faces, levels: NDArray[np.integer], points: NDArray[np.integer]) -> NDArray[np.int32]:
    """(F,) at least `levels`, and no more than it takes: less asked for is nowhere more.

    Neighbours at a vertex differ by one at most. No triangle or quad is left alone among faces that split nearly all of
    its edges, and no larger face beside any that is split: it would only get more corners, uneven where smooth.
    points: (N,) the vertex that stands for each one.
    """
    found = np.array(levels, np.int32)
    if not found.any():
        return found
    corners, edges = np.asarray(points)[faces.corners], edges_of(faces, points)
    around, counts = np.zeros(int(corners.max()) + 1, np.int32), faces.counts
    while True:
        before = found
        around[:] = 0
        np.maximum.at(around, corners, found[faces.of_corners])
        found = np.maximum(found, faces.most(around[corners]) - 1)
        is_split = np.zeros(len(edges.ends), bool)
        is_split[edges.of_corners[found[faces.of_corners] > 0]] = True
        split_edges = np.add.reduceat(is_split[edges.of_corners].astype(np.int32), faces.offsets[:-1])
        is_surrounded = split_edges >= np.where(counts > 4, 1, 3)
        found = np.maximum(found, is_surrounded.astype(np.int32))
        if np.array_equal(found, before):
            return found
