"""Enclosed volume of a mesh as Blender shows it, measured without the engine: float64 numpy, bilinear faces.

Points split at seams are welded, openings closed by a fan to the mean of their rim, each shell counted on its own
(docs/ARCHITECTURE.md, Volume).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Indices = NDArray[np.intp]

# Points of open edges closer than this, relative to the mesh's diagonal, are one point.
WELD_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Shells:
    """What is needed to measure the shells of one mesh in any pose.

    welded: (N,) welded point of each vertex. first, second: (E,) welded points of every corner edge, face by face, caps
    included, whose centres are numbered after the points. face_of_edge: (E,). rims: points around each opening.
    face_shells: (F,) shell of each face. vertex_shells: (N,) shell of each vertex, -1 for a loose one. is_open: (K,).
    """

    welded: Indices
    first: Indices
    second: Indices
    face_of_edge: Indices
    rims: tuple[Indices, ...]
    face_shells: Indices
    vertex_shells: Indices
    is_open: NDArray[np.bool_]

    @property
    def count(self) -> int:
        """Number of shells."""
        return len(self.is_open)

    def volumes(self, positions: Points) -> Points:
        """(K,) signed volume of each shell; V = 1/6 Σ_f Σ_edges det(face mean, a, b), about the centroid."""
        counts = np.bincount(self.welded)
        points = np.stack([np.bincount(self.welded, axis) / counts for axis in positions.T], axis=1)
        points -= points.mean(axis=0)
        centres = np.array([points[rim].mean(axis=0) for rim in self.rims]).reshape(-1, 3)
        points = np.concatenate([points, centres])

        corners = np.bincount(self.face_of_edge)
        a, b = points[self.first], points[self.second]
        means = np.stack([np.bincount(self.face_of_edge, axis) / corners for axis in a.T], axis=1)
        six_volumes = np.einsum("ei,ei->e", means[self.face_of_edge], np.cross(a, b))
        return np.bincount(self.face_shells[self.face_of_edge], six_volumes, minlength=self.count) / 6.0


def shells(rest_positions: Points, face_sizes: Indices, corners: Indices) -> Shells:
    """Welds, groups and closes a mesh once, in its undeformed shape.

    rest_positions: (N, 3); face_sizes: (F,); corners: (sum of sizes,) vertex of each corner.
    """
    face_of_edge = np.repeat(np.arange(len(face_sizes)), face_sizes)
    welded = weld(rest_positions, corners, following(corners, face_sizes))
    first = welded[corners]
    second = following(first, face_sizes)
    point_labels = connected(welded.max() + 1, first, second)

    opening = unpaired(first, second)
    rim_first, rim_second = second[opening], first[opening]
    rim_points, rim_local = np.unique(np.concatenate([rim_first, rim_second]), return_inverse=True)
    half = len(rim_first)
    rim_labels = connected(len(rim_points), rim_local[:half], rim_local[half:])
    rims = tuple(rim_points[rim_labels == label] for label in range(rim_labels.max(initial=-1) + 1))

    # A cap is a fan of triangles (a, b, centre): three corner edges each.
    centre = welded.max() + 1 + rim_labels[rim_local[:half]]
    cap_first = np.stack([rim_first, rim_second, centre], axis=1).ravel()
    cap_second = np.stack([rim_second, centre, rim_first], axis=1).ravel()
    cap_faces = len(face_sizes) + np.repeat(np.arange(half), 3)

    used, shell_of_label = np.unique(point_labels[first], return_inverse=True)
    face_starts = np.concatenate([[0], np.cumsum(face_sizes)[:-1]])
    vertex_shells = np.full(len(welded), -1)
    vertex_shells[corners] = shell_of_label
    cap_shells = shell_of_label[opening]
    is_open = np.zeros(len(used), dtype=np.bool_)
    is_open[cap_shells] = True
    return Shells(
        welded=welded,
        first=np.concatenate([first, cap_first]),
        second=np.concatenate([second, cap_second]),
        face_of_edge=np.concatenate([face_of_edge, cap_faces]),
        rims=rims,
        face_shells=np.concatenate([shell_of_label[face_starts], cap_shells]),
        vertex_shells=vertex_shells,
        is_open=is_open,
    )


def following(corners: Indices, face_sizes: Indices) -> Indices:
    """The next corner in the same face, for each corner."""
    ends = np.cumsum(face_sizes)
    result = np.roll(corners, -1)
    result[ends - 1] = corners[ends - face_sizes]
    return result


def unpaired(first: Indices, second: Indices) -> Indices:
    """Indices of the directed edges that no face runs through the other way."""
    span = max(first.max(initial=0), second.max(initial=0)) + 1
    return np.flatnonzero(~np.isin(first * span + second, second * span + first))


def weld(positions: Points, first: Indices, second: Indices) -> Indices:
    """(N,) compact index of the point each vertex belongs to; only vertices on open edges are joined."""
    open_edges = unpaired(first, second)
    candidates = np.unique(np.concatenate([first[open_edges], second[open_edges]]))
    cell = 2.0 * WELD_TOLERANCE * np.linalg.norm(np.ptp(positions, axis=0))
    links = []
    # Two points within half a cell share a cell of at least one of the eight grids shifted by half.
    for shift in product((0.0, 0.5), repeat=3):
        cells = np.floor(positions[candidates] / cell + shift)
        _, chosen, group = np.unique(cells, axis=0, return_index=True, return_inverse=True)
        links.append(candidates[chosen[group.ravel()]])
    return connected(len(positions), np.tile(candidates, len(links)), np.concatenate(links))


def connected(count: int, one: Indices, other: Indices) -> Indices:
    """(count,) label 0, 1, … of the connected part each of `count` nodes is in, for undirected edges one-other."""
    labels = np.arange(count)
    while True:
        lowest = labels.copy()
        np.minimum.at(lowest, one, labels[other])
        np.minimum.at(lowest, other, labels[one])
        lowest = lowest[lowest]
        if np.array_equal(lowest, labels):
            return np.unique(labels, return_inverse=True)[1]
        labels = lowest
