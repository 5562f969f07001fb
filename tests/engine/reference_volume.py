"""Enclosed volume by other ways than the engine's, in plain numpy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from surfaces import Surface

GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)


def mean_of_fans(surface: Surface, positions: NDArray[np.float64] | None = None) -> float:
    """Every face cut into a fan from each of its corners in turn, the mean of the volumes of all fans."""
    points = surface.positions if positions is None else positions
    points = points - points.mean(axis=0)
    total = 0.0
    for face in surface.faces:
        for start in range(len(face)):
            apex, *rest = points[np.roll(face, -start)]
            first, second = np.array(rest[:-1]), np.array(rest[1:])
            total += np.sum(np.cross(first, second) @ apex) / len(face)
    return total / 6.0


def bilinear_patches(surface: Surface) -> float:
    """Divergence theorem over bilinear quads by Gauss quadrature, exact for their degree; quads only."""
    total = 0.0
    for a, b, c, d in surface.positions[np.array(surface.faces)]:
        for u in GAUSS:
            for v in GAUSS:
                point = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
                along_u = (1 - v) * (b - a) + v * (c - d)
                along_v = (1 - u) * (d - a) + u * (c - b)
                total += point @ np.cross(along_u, along_v) / 12.0
    return total
