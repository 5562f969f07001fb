"""The mesh, weights and bones that were bound, and what follows from them alone; for what looks at a frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from . import strain


@dataclass(frozen=True, eq=False)
class RestGeometry:
    """A character at rest: N vertices, F faces, B bones. Object space, armature space where said.

    What is derived is worked out when it is first looked at, then kept with the binding.
    """

    positions: NDArray[np.float32]  # (N, 3)
    face_offsets: NDArray[np.int32]  # (F + 1,)
    face_corners: NDArray[np.int32]  # (C,)
    weight_offsets: NDArray[np.int32]  # (N + 1,)
    weight_bones: NDArray[np.int32]  # (W,)
    weights: NDArray[np.float32]  # (W,)
    parents: NDArray[np.int32]  # (B,)
    heads: NDArray[np.float64]  # (B, 3) armature space
    tails: NDArray[np.float64]  # (B, 3) armature space
    object_from_armature: NDArray[np.float64]  # (4, 4) at rest

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """(T, 3) vertices: fans of all faces."""
        offsets, corners = self.face_offsets, self.face_corners
        counts = np.maximum(np.diff(offsets) - 2, 0)
        first = np.repeat(offsets[:-1], counts)
        within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        return np.stack([corners[first], corners[first + within + 1], corners[first + within + 2]], axis=1)

    @cached_property
    def edge_length(self) -> float:
        """Median length of an edge, object space; 0 without faces."""
        ends = self.positions[self.triangles[:, :2]]
        return float(np.median(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))) if len(ends) else 0.0

    @cached_property
    def fans(self) -> strain.Fans:
        """Faces around each vertex, for its strain."""
        return strain.Fans(len(self.positions), self.face_offsets, self.face_corners)

    @cached_property
    def vertex_bones(self) -> NDArray[np.int32]:
        """(N,) the bone with the largest weight, -1 without any."""
        count = len(self.positions)
        vertices = np.repeat(np.arange(count), np.diff(self.weight_offsets))
        order = np.lexsort((-self.weights, vertices))
        is_first = np.ones(len(order), bool)
        is_first[1:] = np.diff(vertices[order]) > 0
        found = np.full(count, -1, np.int32)
        found[vertices[order][is_first]] = self.weight_bones[order][is_first]
        return found

    @cached_property
    def apexes(self) -> NDArray[np.float64]:
        """(N, 3) apexes of the cones of strain: where each vertex is closest to its bone, object space."""
        place = self.object_from_armature
        heads, tails = (ends @ place[:3, :3].T + place[:3, 3] for ends in (self.heads, self.tails))
        return strain.closest_on_bones(self.positions.astype(np.float64), self.vertex_bones, self.parents, heads, tails)
