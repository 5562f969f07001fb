"""A body with two holes, of quads: a plate of cells, two of them missing, subdivided until it is round."""

from __future__ import annotations

from itertools import product

import numpy as np

from .cage import Surface
from .subdivision import limit_points, subdivide

CELLS = (5, 3)
HOLES = {(1, 1), (3, 1)}
SIZE = (4.0, 2.0, 0.7)
"""Length, width and height of the plate of cells, metres; the round body is a little smaller."""


def surface(levels: int) -> Surface:
    """The body about the origin, its length along X; 3,198 vertices at three levels, 12,798 at four."""
    across, along = (np.array(SIZE[axis]) / CELLS[axis] for axis in (1, 0))
    cells = [cell for cell in product(range(CELLS[0]), range(CELLS[1])) if cell not in HOLES]
    numbers: dict[tuple[int, int, int], int] = {}

    def corner(x: int, y: int, z: int) -> int:
        return numbers.setdefault((x, y, z), len(numbers))

    quads = []
    for x, y in cells:
        quads.append([corner(x, y, 1), corner(x + 1, y, 1), corner(x + 1, y + 1, 1), corner(x, y + 1, 1)])
        quads.append([corner(x, y, 0), corner(x, y + 1, 0), corner(x + 1, y + 1, 0), corner(x + 1, y, 0)])
        for (dx, dy), start, end in (
            ((0, -1), (0, 0), (1, 0)),
            ((1, 0), (1, 0), (1, 1)),
            ((0, 1), (1, 1), (0, 1)),
            ((-1, 0), (0, 1), (0, 0)),
        ):
            if (x + dx, y + dy) not in cells:
                (a, b), (c, d) = (x + start[0], y + start[1]), (x + end[0], y + end[1])
                quads.append([corner(a, b, 0), corner(c, d, 0), corner(c, d, 1), corner(a, b, 1)])
    points = np.array(list(numbers), dtype=float) * [along, across, SIZE[2]]
    points -= (points.min(axis=0) + points.max(axis=0)) / 2
    faces = np.array(quads)
    for _ in range(levels):
        points, faces, _ = subdivide(points, faces)
    return Surface(limit_points(points, faces), faces, ["body"] * len(faces))
