"""Quad grids that close a loop of vertices."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

Grid = list[list[int]]


def grid_boundary(width: int, height: int) -> list[tuple[int, int]]:
    """(row, column) of the boundary vertices of a grid of width x height quads, once around."""
    top = [(0, column) for column in range(width)]
    right = [(row, width) for row in range(height)]
    bottom = [(height, width - column) for column in range(width)]
    left = [(height - row, 0) for row in range(height)]
    return top + right + bottom + left


def fill_loop(loop: np.ndarray, width: int, height: int) -> np.ndarray:
    """Points (height + 1, width + 1, 3) inside a loop (2 width + 2 height, 3) that starts at a corner.

    Transfinite (Coons) interpolation of the boundary.
    """
    points = np.zeros((height + 1, width + 1, 3))
    for (row, column), point in zip(grid_boundary(width, height), loop, strict=True):
        points[row, column] = point
    for row in range(1, height):
        for column in range(1, width):
            s, t = column / width, row / height
            along = (1 - s) * points[row, 0] + s * points[row, width]
            across = (1 - t) * points[0, column] + t * points[height, column]
            corners = (1 - t) * ((1 - s) * points[0, 0] + s * points[0, width])
            corners = corners + t * ((1 - s) * points[height, 0] + s * points[height, width])
            points[row, column] = along + across - corners
    return points


def grid_quads(grid: Grid) -> list[tuple[int, int, int, int]]:
    """Quads of a grid of vertex indices, row by row, wound as the boundary runs."""
    return [
        (upper[column], upper[column + 1], lower[column + 1], lower[column])
        for upper, lower in pairwise(grid)
        for column in range(len(upper) - 1)
    ]
