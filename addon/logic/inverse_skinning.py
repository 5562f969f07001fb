"""Corrective keys: where a point must stand before skinning, to be at a given place after it.

Skinning moves each vertex by an affine map that the pose alone decides. Linear blends of far turned bones flatten
space; there the inverse is clamped, and what cannot be reached is told.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

from .weights import BoneWeights

# Space that skinning flattens to less than this part of what it stretches most is not undone any further.
FLATTEST = 0.05


class Maps(NamedTuple):
    """Where skinning takes each of N vertices in one pose: linear @ p + place, object space."""

    linear: NDArray[np.float64]  # (N, 3, 3)
    places: NDArray[np.float64]  # (N, 3) of the origin

    def moved(self, positions: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N, 3) positions, one per vertex, skinned."""
        return np.einsum("nij,nj->ni", self.linear, positions) + self.places


class Inverse(NamedTuple):
    """Displacements before skinning, and how well they do."""

    deltas: NDArray[np.float64]  # (N, 3)
    is_clamped: NDArray[np.bool_]  # (N,)
    error: float  # largest distance after skinning from where the points were to be


class TargetSkin:
    """The skinning that will play the keys. Immutable; safe to call from several threads."""

    def __init__(
        self,
        parents: NDArray[np.int32],
        rest_matrices: NDArray[np.float64],
        weights: BoneWeights,
        *,
        mode: Literal["linear", "dual_quaternion"] = "linear",
        vertex_mask: NDArray[np.float32] | None = None,
    ) -> None:
        """Shapes as in `turgor.Skinning`, weights as the target has them: see `largest_influences`."""
        self._skinning = turgor.Skinning(
            turgor.Skeleton(parents, rest_matrices), *weights, mode=mode, vertex_mask=vertex_mask
        )

    def maps(self, pose_matrices: NDArray[np.floating], object_from_armature: NDArray[np.float64]) -> Maps:
        """Affine maps of all vertices in one pose, read off where skinning takes the origin and the axes.

        Arguments as in `turgor.Skinning.deform`.
        """
        count = self._skinning.vertex_count
        probes = np.concatenate([np.zeros((1, 3)), np.eye(3)])
        origin, *axes = (
            self._skinning.deform(np.broadcast_to(probe, (count, 3)), pose_matrices, object_from_armature)
            for probe in probes
        )
        return Maps(np.stack([axis - origin for axis in axes], axis=-1), origin)


def largest_influences(weights: BoneWeights, count: int) -> BoneWeights:
    """The `count` largest of each vertex, in stored order, with their sum as before: what game engines keep.

    Of equal ones the first stored stay.
    """
    rows = np.repeat(np.arange(len(weights.offsets) - 1), np.diff(weights.offsets))
    order = np.lexsort((np.arange(len(rows)), -weights.weights, rows))
    rank = np.empty(len(rows), np.int64)
    rank[order] = np.arange(len(rows)) - weights.offsets[:-1][rows[order]]
    is_kept = rank < count
    sums = np.bincount(rows, weights.weights, len(weights.offsets) - 1)
    kept_sums = np.bincount(rows[is_kept], weights.weights[is_kept], len(weights.offsets) - 1)
    growth = np.divide(sums, kept_sums, out=np.ones_like(sums), where=kept_sums > 0.0)
    kept_before = np.concatenate([[0], np.cumsum(is_kept)]).astype(np.int32)
    kept = (weights.weights[is_kept] * growth[rows[is_kept]]).astype(np.float32)
    return BoneWeights(kept_before[weights.offsets], weights.bones[is_kept], kept)


def inverse(maps: Maps, rest: NDArray[np.floating], wanted: NDArray[np.floating]) -> Inverse:
    """Displacements d with maps(rest + d) = wanted; all (N, 3)."""
    ahead = wanted - maps.moved(rest)
    columns = np.moveaxis(maps.linear, -1, 0)
    normals = np.stack([np.cross(columns[(axis + 1) % 3], columns[(axis + 2) % 3]) for axis in range(3)], axis=1)
    determinants = np.einsum("ni,ni->n", columns[0], normals[:, 0])
    # The smallest over the largest singular value is at least the determinant over the cube of the norm.
    bound = FLATTEST * np.einsum("nij,nij->n", maps.linear, maps.linear) ** 1.5
    is_safe = np.abs(determinants) > bound
    factors = np.divide(1.0, determinants, out=np.zeros_like(determinants), where=is_safe)
    deltas = factors[:, None] * np.einsum("nij,nj->ni", normals, ahead)
    is_clamped = np.zeros(len(ahead), bool)
    doubtful = np.flatnonzero(~is_safe)
    error = 0.0
    if len(doubtful):
        u, sizes, v = np.linalg.svd(maps.linear[doubtful])
        least = np.maximum(FLATTEST * sizes[:, :1], np.finfo(float).tiny)
        parts = np.einsum("nji,nj->ni", u, ahead[doubtful]) / np.maximum(sizes, least)
        deltas[doubtful] = np.einsum("nji,nj->ni", v, parts)
        is_clamped[doubtful] = sizes[:, 2] < least[:, 0]
        missed = ahead[doubtful] - np.einsum("nij,nj->ni", maps.linear[doubtful], deltas[doubtful])
        error = float(np.linalg.norm(missed, axis=1).max())
    return Inverse(deltas, is_clamped, error)


def growth(maps: Maps) -> NDArray[np.float64]:
    """(N,) at most how many times longer skinning makes a displacement of each vertex."""
    squares = np.einsum("nji,njk->nik", maps.linear, maps.linear)
    return np.sqrt(np.abs(squares).sum(axis=2).max(axis=1))
