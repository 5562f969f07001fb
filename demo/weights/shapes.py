"""Surfaces that the cases are put together from: points (N, 3) and faces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


@dataclass(frozen=True)
class Shape:
    """Faces as corner lists, counter-clockwise seen from outside."""

    points: Points
    faces: Sequence[Sequence[int]]

    def joined(self, *others: Shape) -> Shape:
        """All in one mesh, in this order."""
        points, faces = [self.points], [list(face) for face in self.faces]
        for other in others:
            start = sum(len(part) for part in points)
            points.append(other.points)
            faces += [[corner + start for corner in face] for face in other.faces]
        return Shape(np.vstack(points), faces)

    def moved(self, move: Callable[[Points], Points]) -> Shape:
        """Every point moved."""
        return Shape(move(self.points), self.faces)

    def inverted(self) -> Shape:
        """Inside out."""
        return Shape(self.points, [list(face)[::-1] for face in self.faces])

    def split(self) -> Shape:
        """Every face with points of its own, as importers leave hard seams."""
        ends = np.cumsum([len(face) for face in self.faces])
        corners = np.concatenate([list(face) for face in self.faces])
        own = [list(range(end - len(face), end)) for face, end in zip(self.faces, ends, strict=True)]
        return Shape(self.points[corners], own)


def limb(
    start: Sequence[float], end: Sequence[float], radius: float = 0.5, rings: int = 33, sides: int = 20, caps: int = 2
) -> Shape:
    """A tube of quads. caps: how many of its ends are closed, the first one first, by rings that shrink."""
    low, high = np.array(start, float), np.array(end, float)
    along = (high - low) / np.linalg.norm(high - low)
    across = np.cross(along, [0.0, 0.0, 1.0] if abs(along[2]) < 0.9 else [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    above = np.cross(along, across)
    angle = np.arange(sides) * 2 * np.pi / sides
    circle = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * above
    sleeve = [(t, radius) for t in np.linspace(0.0, 1.0, rings)]
    shrunk = [0.75 * radius, 0.5 * radius, 0.25 * radius]
    stations = [
        *([(0.0, r) for r in shrunk[::-1]] if caps > 0 else []),
        *sleeve,
        *([(1.0, r) for r in shrunk] if caps > 1 else []),
    ]
    points = np.vstack([low + t * (high - low) + r * circle for t, r in stations])
    faces: list[list[int]] = [
        [k * sides + i, k * sides + (i + 1) % sides, (k + 1) * sides + (i + 1) % sides, (k + 1) * sides + i]
        for k in range(len(stations) - 1)
        for i in range(sides)
    ]
    if caps > 0:
        faces.append(list(range(sides))[::-1])
    if caps > 1:
        faces.append(list(range((len(stations) - 1) * sides, len(stations) * sides)))
    return Shape(points, faces)


def box(low: Sequence[float], high: Sequence[float], cuts: Sequence[int] = (4, 4, 4)) -> Shape:
    """A closed box, cut along its axes."""
    index: dict[tuple[int, ...], int] = {}
    faces: list[list[int]] = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, cuts[axis]):
            for i in range(cuts[u]):
                for j in range(cuts[v]):
                    face = []
                    for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        cell = [0, 0, 0]
                        cell[axis], cell[u], cell[v] = side, i + du, j + dv
                        face.append(index.setdefault(tuple(cell), len(index)))
                    faces.append(face if side else face[::-1])
    corner, size = np.array(low, float), np.array(high, float) - np.array(low, float)
    return Shape(corner + np.array(list(index), float) / np.array(cuts) * size, faces)


def ball(centre: Sequence[float], radius: float, cuts: int = 8) -> Shape:
    """A box blown up."""
    cube = box((-1, -1, -1), (1, 1, 1), (cuts, cuts, cuts))
    return cube.moved(lambda p: np.array(centre) + radius * p / np.linalg.norm(p, axis=1, keepdims=True))


def drawn(outline: Sequence[tuple[float, float]], step: float, depths: Points) -> Shape:
    """An outline of the x z plane drawn along y: its sides are cells of squares, so that they bend."""
    cells = [
        (i, k)
        for i in range(round(min(x for x, _ in outline) / step), round(max(x for x, _ in outline) / step))
        for k in range(round(min(z for _, z in outline) / step), round(max(z for _, z in outline) / step))
        if _within(outline, ((i + 0.5) * step, (k + 0.5) * step))
    ]
    solid, index, faces = set(cells), {}, []

    def point(i: int, k: int, j: int) -> int:
        return index.setdefault((i, k, j), len(index))

    last = len(depths) - 1
    for i, k in cells:
        ring = [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)]
        faces.append([point(*corner, 0) for corner in ring])
        faces.append([point(*corner, last) for corner in ring[::-1]])
        beyond = [(i, k - 1), (i + 1, k), (i, k + 1), (i - 1, k)]
        for side, cell in enumerate(beyond):
            if cell not in solid:
                a, b = ring[side], ring[(side + 1) % 4]
                faces += [[point(*b, j), point(*a, j), point(*a, j + 1), point(*b, j + 1)] for j in range(last)]
    return Shape(np.array([(i * step, depths[j], k * step) for i, k, j in index]), faces)


def _within(outline: Sequence[tuple[float, float]], place: tuple[float, float]) -> bool:
    x, z = place
    inside = False
    for (ax, az), (bx, bz) in zip(outline, [*outline[1:], outline[0]], strict=True):
        if (az > z) != (bz > z) and x < ax + (bx - ax) * (z - az) / (bz - az):
            inside = not inside
    return inside
