"""Faces as two arrays, and which edges they share."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Faces(NamedTuple):
    """F faces, C corners in cyclic order."""

    offsets: NDArray[np.int32]  # (F + 1,)
    corners: NDArray[np.int32]  # (C,) vertices

    @property
    def counts(self) -> NDArray[np.int32]:
        """(F,) corners of each."""
        return np.diff(self.offsets)

    @property
    def of_corners(self) -> NDArray[np.intp]:
        """(C,) face of each corner."""
        return np.repeat(np.arange(len(self.offsets) - 1), self.counts)

    @property
    def following(self) -> NDArray[np.intp]:
        """(C,) the next corner around the face."""
        following = np.arange(1, len(self.corners) + 1)
        has_corners = self.counts > 0
        following[self.offsets[1:][has_corners] - 1] = self.offsets[:-1][has_corners]
        return following

    def most(self, values: NDArray) -> NDArray:
        """(F,) largest of the values (C,) of its corners."""
        return np.maximum.reduceat(values, self.offsets[:-1]) if len(self.offsets) > 1 else values[:0]

    def means(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """(F, ...) of values (C, ...) of the corners."""
        flat = np.asarray(values, np.float64)
        sums = np.add.reduceat(flat, self.offsets[:-1], axis=0) if len(self.offsets) > 1 else flat[:0]
        return sums / self.counts.reshape((-1,) + (1,) * (flat.ndim - 1))


class Edges(NamedTuple):
    """E edges of some faces."""

    ends: NDArray[np.int64]  # (E, 2) the lower vertex first
    of_corners: NDArray[np.intp]  # (C,) edge from each corner to the next

    def places(self, pairs: NDArray[np.integer]) -> NDArray[np.intp]:
        """(K,) edge between each pair of vertices (K, 2), -1 where there is none."""
        if not len(self.ends):
            return np.full(len(pairs), -1)
        keys, wanted = _keys(self.ends), _keys(np.sort(np.asarray(pairs, np.int64).reshape(-1, 2), axis=1))
        places = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        return np.where(keys[places] == wanted, places, -1)


def edges_of(faces: Faces, points: NDArray[np.integer] | None = None) -> Edges:
    """Each edge once. points: (N,) the vertex that stands for each one, where several are at one place."""
    corners = faces.corners.astype(np.int64) if points is None else np.asarray(points, np.int64)[faces.corners]
    pairs = np.sort(np.stack([corners, corners[faces.following]], axis=1), axis=1)
    keys, of_corners = np.unique(_keys(pairs), return_inverse=True)
    return Edges(np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1), of_corners.ravel())


def _keys(pairs: NDArray[np.int64]) -> NDArray[np.int64]:
    return (pairs[:, 0] << 32) | pairs[:, 1]
