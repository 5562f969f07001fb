"""Local volume strain: what became of the flesh between each bit of skin and its bone.

The flesh of a vertex is the cone over the faces around it, with its apex at the closest point of the vertex's
strongest bone: on the segments from that bone's joint to each of its child joints, or from head to tail where it has
none. Strain is the volume of that cone in the pose relative to rest, minus 1; the bone carries the apex rigidly.

Limits: cones of neighbours overlap, a face belongs to as many as it has corners; so strains do not add up to the
error of the whole, but their mean by rest volume does when all cones share one apex. Where the skin is seen edge-on
from its bone (the end of a limb, a fold at rest) the cone is too thin to tell, and the strain is not a number; so it
is at loose vertices and those without a bone.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

# Cones thinner than this part of one with the same faces and distance, seen face-on, are not measured; nor are those
# with their apex this near to the skin, as part of the mesh's size.
LEAST_CONE, LEAST_DISTANCE = 0.15, 1e-6


class Fans:
    """The faces around each vertex, prepared once per topology."""

    def __init__(self, vertex_count: int, face_offsets: NDArray[np.int32], face_corners: NDArray[np.int32]) -> None:
        """Shapes as in `scene.rest.RestMesh`."""
        self.vertex_count = vertex_count
        self._offsets, self._corners = face_offsets, face_corners
        self._sizes = np.diff(face_offsets)
        self._quads = face_corners.reshape(-1, 4) if len(face_corners) and (self._sizes == 4).all() else None
        self._starts = face_offsets[:-1]
        within = np.arange(len(face_corners)) - np.repeat(self._starts, self._sizes)
        step = np.where(within + 1 == np.repeat(self._sizes, self._sizes), -within, 1)
        self._next = face_corners[np.arange(len(face_corners)) + step]
        self._faces = np.repeat(np.arange(len(self._sizes)), self._sizes)

    def cones(self, positions: NDArray[np.float64], apexes: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) signed volumes; positions, apexes: (N, 3). Cones over the bilinear patch of a quad (MATH 1)."""
        middle = positions.mean(axis=0) if len(positions) else np.zeros(3)
        # A cone over face f from a has the volume (c - a) . S / 3, with S the face's area vector.
        areas, heights = self._areas(positions - middle)
        return self._around(heights) - np.einsum("ij,ij->i", apexes - middle, self._around(areas)) / 3.0

    def areas(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) of the faces around each vertex."""
        return self._around(np.linalg.norm(self._areas(positions)[0], axis=1))

    def _areas(self, positions: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(F, 3) area vectors, (F,) volumes of cones from the origin."""
        if not len(self._sizes):
            return np.zeros((0, 3)), np.zeros(0)
        if self._quads is not None:
            a, b, c, d = (positions[column] for column in self._quads.T)
            areas = 0.5 * np.cross(c - a, d - b)
            centres = 0.25 * (a + b + c + d)
        else:
            points = positions[self._corners]
            areas = 0.5 * np.add.reduceat(np.cross(points, positions[self._next]), self._starts, axis=0)
            centres = np.add.reduceat(points, self._starts, axis=0) / self._sizes[:, None]
        return areas, np.einsum("ij,ij->i", centres, areas) / 3.0

    def _around(self, of_faces: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sums over the faces around each vertex, (N,) or (N, 3)."""
        if of_faces.ndim == 2:
            return np.stack([self._around(column) for column in of_faces.T], axis=1)
        return np.bincount(self._corners, of_faces[self._faces], self.vertex_count).astype(np.float64, copy=False)


def strain(
    fans: Fans,
    rest_positions: NDArray[np.float64],
    rest_apexes: NDArray[np.float64],
    posed_positions: NDArray[np.float64],
    posed_apexes: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(N,) relative change of each vertex's cone, nan where there is none worth the name. All (N, 3), object space."""
    rest = fans.cones(rest_positions, rest_apexes)
    distances = np.linalg.norm(rest_positions - rest_apexes, axis=1)
    size = np.ptp(rest_positions, axis=0).max(initial=0.0) if len(rest_positions) else 0.0
    thick = fans.areas(rest_positions) * np.maximum(distances, LEAST_DISTANCE * size) / 3.0
    is_cone = np.abs(rest) > LEAST_CONE * thick
    posed = fans.cones(posed_positions, posed_apexes)
    return np.where(is_cone, posed / np.where(is_cone, rest, 1.0) - 1.0, np.nan)


def closest_on_bones(
    positions: NDArray[np.float64],
    vertex_bones: NDArray[np.int32],
    parents: NDArray[np.int32],
    heads: NDArray[np.float64],
    tails: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(N, 3) closest points of each vertex's bone at rest, see above; nan without a bone.

    vertex_bones: (N,) -1 for none. parents: (B,). heads, tails: (B, 3). All in one space.
    """
    found = np.full(positions.shape, np.nan)
    order = np.argsort(vertex_bones, kind="stable")
    starts = np.searchsorted(vertex_bones[order], np.arange(len(heads) + 1))
    for bone, (start, end) in enumerate(pairwise(starts)):
        if start == end:
            continue
        vertices = order[start:end]
        children = np.flatnonzero(parents == bone)
        ends = heads[children] if len(children) else tails[[bone]]
        found[vertices] = _closest(positions[vertices], heads[bone], ends)
    return found


def _closest(points: NDArray[np.float64], head: NDArray[np.float64], ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """(M, 3) on the nearest of the segments from `head` to each of `ends`."""
    best, best_distances = np.empty_like(points), np.full(len(points), np.inf)
    for end in ends:
        along = end - head
        squared = float(along @ along)
        part = np.clip((points - head) @ along / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(points))
        on = head + part[:, None] * along
        distances = np.linalg.norm(points - on, axis=1)
        is_nearer = distances < best_distances
        best[is_nearer], best_distances[is_nearer] = on[is_nearer], distances[is_nearer]
    return best
