"""Bodies that automatic weights are asked for: surfaces as the engine takes them, bones as pairs of ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import turgor
from numpy.typing import NDArray
from surfaces import Surface

Points = NDArray[np.float64]
MeshArrays = tuple[Points, NDArray[np.int32], NDArray[np.int32]]


@dataclass(frozen=True)
class Body:
    """meshes: surfaces in one space; heads, tails: (B, 3)."""

    meshes: Sequence[Surface]
    heads: Points
    tails: Points

    @property
    def positions(self) -> Points:
        return np.vstack([mesh.positions for mesh in self.meshes])

    def weights(self, **settings) -> turgor.Weights:
        arrays = [arrays_of(mesh) for mesh in self.meshes]
        return turgor.automatic_weights(arrays, self.heads, self.tails, **settings)

    def matrix(self, **settings) -> NDArray[np.float64]:
        """(N, B) weights."""
        return dense(self.weights(**settings), len(self.heads))

    def moved(self, move) -> Body:
        """Everything moved by a function of (N, 3) points."""
        meshes = [mesh.moved(move(mesh.positions)) for mesh in self.meshes]
        return Body(meshes, move(self.heads), move(self.tails))


def arrays_of(mesh: Surface) -> MeshArrays:
    return mesh.positions, mesh.face_offsets, mesh.face_corners


def dense(weights: turgor.Weights, bone_count: int) -> NDArray[np.float64]:
    """(N, B) weights as a matrix."""
    rows = np.repeat(np.arange(len(weights.offsets) - 1), np.diff(weights.offsets))
    matrix = np.zeros((len(weights.offsets) - 1, bone_count))
    matrix[rows, weights.bones] = weights.weights
    return matrix


def bones(*chains: Sequence[Sequence[float]]) -> tuple[Points, Points]:
    """Heads and tails of chains given by their joints."""
    heads = np.array([joint for chain in chains for joint in chain[:-1]], dtype=float)
    tails = np.array([joint for chain in chains for joint in chain[1:]], dtype=float)
    return heads, tails


def limb_bones(count: int, length: float = 4.0) -> tuple[Points, Points]:
    """A straight chain along x from 0."""
    return bones([[length * i / count, 0.0, 0.0] for i in range(count + 1)])


def box(low: Sequence[float], high: Sequence[float], cuts: int = 8) -> Surface:
    """A closed box of quads, `cuts` per side."""
    points: dict[tuple[int, int, int], int] = {}
    faces: list[list[int]] = []

    def point(cell: tuple[int, int, int]) -> int:
        return points.setdefault(cell, len(points))

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, cuts):
            for i in range(cuts):
                for j in range(cuts):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        cell = [0, 0, 0]
                        cell[axis], cell[u], cell[v] = side, i + di, j + dj
                        corners.append(point((cell[0], cell[1], cell[2])))
                    faces.append(corners if side else corners[::-1])
    low_corner, high_corner = np.asarray(low, float), np.asarray(high, float)
    positions = low_corner + np.array(list(points), dtype=float) / cuts * (high_corner - low_corner)
    return Surface(positions, faces)


def mouth() -> Body:
    """A C of one shell, open at the front (+x): palate above, tongue and jaw below, hinged at the back.

    Bones: the skull along the upper part, the jaw along the lower one.
    """
    profile = [
        (0.0, -1.0),
        (4.0, -1.0),
        (4.0, -0.5),  # the lower lip
        (3.0, -0.5),
        (3.0, -0.08),  # the tip of the tongue, close to the palate
        (1.5, -0.08),
        (1.0, -0.5),
        (1.0, 0.08),  # the palate
        (4.0, 0.08),
        (4.0, 1.0),
        (0.0, 1.0),
    ]
    heads, tails = bones(
        [[0.5, 0.0, 0.0], [0.8, 0.6, 0.0], [3.8, 0.6, 0.0]], [[0.5, 0.0, 0.0], [0.8, -0.75, 0.0], [3.8, -0.75, 0.0]]
    )
    return Body([drawn(profile, np.linspace(-0.6, 0.6, 13))], heads, tails)


def drawn(profile: Sequence[tuple[float, float]], depths: Points) -> Surface:
    """An outline of the x y plane, counter-clockwise, drawn along z, with points at most 0.1 apart."""
    outline = subdivided(np.array(profile), 0.1)
    count = len(outline)
    positions = np.array([[x, y, z] for z in depths for x, y in outline])
    faces: list[list[int]] = [
        [k * count + i, k * count + (i + 1) % count, (k + 1) * count + (i + 1) % count, (k + 1) * count + i]
        for k in range(len(depths) - 1)
        for i in range(count)
    ]
    faces += [list(range(count))[::-1], list(range((len(depths) - 1) * count, len(depths) * count))]
    return Surface(positions, faces)


def subdivided(loop: Points, step: float) -> Points:
    """A closed loop with points at most `step` apart."""
    parts = []
    for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / step)))
        parts.append(a + (b - a) * (np.arange(count) / count)[:, None])
    return np.vstack(parts)
