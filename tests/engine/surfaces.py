"""Small closed and open surfaces: points and faces as the engine takes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import turgor
from numpy.typing import NDArray


@dataclass(frozen=True)
class Surface:
    """positions: (N, 3); faces: corner lists, counter-clockwise seen from outside."""

    positions: NDArray[np.float64]
    faces: Sequence[Sequence[int]]

    @property
    def face_offsets(self) -> NDArray[np.int32]:
        return np.cumsum([0, *(len(face) for face in self.faces)], dtype=np.int32)

    @property
    def face_corners(self) -> NDArray[np.int32]:
        return np.array([corner for face in self.faces for corner in face], dtype=np.int32)

    def mesh(self, dtype: type[np.floating] = np.float64) -> turgor.Mesh:
        return turgor.Mesh(self.positions.astype(dtype), self.face_offsets, self.face_corners)

    def moved(self, positions: NDArray[np.float64]) -> Surface:
        return Surface(positions, self.faces)

    def reversed(self) -> Surface:
        return Surface(self.positions, [face[::-1] for face in self.faces])

    def joined(self, other: Surface) -> Surface:
        """Both surfaces in one, the other's points after ours."""
        start = len(self.positions)
        shifted = [[corner + start for corner in face] for face in other.faces]
        return Surface(np.vstack([self.positions, other.positions]), [*self.faces, *shifted])

    def roughened(self, rng: np.random.Generator, amount: float) -> Surface:
        """Every point moved at random, so that no quad or n-gon stays flat."""
        return self.moved(self.positions + rng.uniform(-amount, amount, self.positions.shape))

    def split_apart(self) -> Surface:
        """Every face with points of its own, as importers leave hard seams."""
        own = [list(range(start, stop)) for start, stop in pairwise(self.face_offsets)]
        return Surface(self.positions[self.face_corners], own)


def cube() -> Surface:
    """The unit cube, six quads."""
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Surface(corners, faces)


def open_tube(rings: int = 9, sides: int = 8, length: float = 4.0, radius: float = 0.5) -> Surface:
    """Quads along x from 0 to `length`, both ends open."""
    x, angle = np.meshgrid(np.linspace(0.0, length, rings), np.arange(sides) * 2 * np.pi / sides, indexing="ij")
    positions = np.stack([x, radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 3)
    faces = [
        [ring * sides + side, ring * sides + after, (ring + 1) * sides + after, (ring + 1) * sides + side]
        for ring in range(rings - 1)
        for side, after in ((side, (side + 1) % sides) for side in range(sides))
    ]
    return Surface(positions, faces)


def tube(rings: int = 9, sides: int = 8, length: float = 4.0, radius: float = 0.5) -> Surface:
    """The open tube closed by an n-gon at each end."""
    sleeve = open_tube(rings, sides, length, radius)
    last = (rings - 1) * sides
    start, end = list(range(sides))[::-1], list(range(last, last + sides))
    return Surface(sleeve.positions, [*sleeve.faces, start, end])


def shells_on_common_points(rng: np.random.Generator, count: int) -> Surface:
    """Tetrahedra about corners of a few points, so that some share points, edges or faces; along x from 0 to 4."""
    positions = rng.normal(size=(int(rng.integers(5, 5 + 3 * count)), 3)) * [1.0, 0.4, 0.4] + [2.0, 0.0, 0.0]
    faces: list[list[int]] = []
    for _ in range(count):
        a, b, c, d = (int(corner) for corner in rng.permutation(len(positions))[:4])
        if np.linalg.det(positions[[b, c, d]] - positions[a]) < 0.0:
            b, c = c, b
        faces += [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]
    return Surface(positions, faces)


def strip(length: int = 6) -> Surface:
    """A flat strip of quads: no inside."""
    x, y = np.meshgrid(np.arange(length + 1.0), [0.0, 1.0], indexing="ij")
    positions = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    return Surface(positions, [[2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1] for i in range(length)])
