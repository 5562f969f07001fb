"""The local volume of a map at points: how far its derivative's determinant is from one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..enclosed_volume import Points

# Of the finite differences, fourth order, where lengths are about one.
STEP = 1e-3


def determinant_error(mapped: Callable[[Points], Points], points: Points) -> float:
    """Largest |det J − 1| over points (N, 3) of a map of arrays of points."""
    columns = []
    for axis in np.eye(3):
        near, far = (mapped(points + step * axis) - mapped(points - step * axis) for step in (STEP, 2.0 * STEP))
        columns.append((8.0 * near - far) / (12.0 * STEP))
    return float(np.abs(np.linalg.det(np.stack(columns, axis=2)) - 1.0).max())


def points_in_tube(start: float, end: float, radius: float, count: int) -> Points:
    """(N, 3) anywhere in a round tube about the X axis; the same every time."""
    generator = np.random.default_rng(1)
    angle, reach = generator.uniform(0.0, 2.0 * np.pi, count), radius * np.sqrt(generator.uniform(0.0, 1.0, count))
    return np.stack([generator.uniform(start, end, count), reach * np.cos(angle), reach * np.sin(angle)], axis=1)
