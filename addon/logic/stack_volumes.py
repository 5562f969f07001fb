"""Volumes of one mesh at several places of its modifier stack: what a modifier changes, what rounding explains."""

from __future__ import annotations

import numpy as np
import turgor
from numpy.typing import NDArray

# Largest part of a coordinate that one rounding to float32 changes.
HALF_ULP = 2.0**-24
# Roundings that Blender's mesh and ours may differ by in a coordinate: into armature space and back (8), a weighted sum
# of bones or a dual quaternion (16), the offset added (1), and matrices that are rounded themselves (7).
ROUNDINGS = 32
# A volume that is a smaller part of the mesh's box has no ratio worth telling.
LEAST_PART = 1e-6


# A mesh at one place of the stack: (N, 3) positions in object space, (F + 1,) face offsets, (C,) face corners.
Shape = tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.int32]]


def change(before: Shape, after: Shape, *, is_subdivided: bool) -> float | None:
    """Volume after a modifier by the volume before it, each counted over closed shells, in float64.

    None where there is nothing to compare: other vertices or faces of another body, or no volume. is_subdivided: other
    vertices are those of the same body.
    """
    is_same = len(before[0]) == len(after[0]) and all(map(np.array_equal, before[1:], after[1:]))
    if not is_same and not is_subdivided:
        return None
    if not (len(before[0]) and np.isfinite(before[0]).all() and np.isfinite(after[0]).all()):
        return None
    mesh = turgor.Mesh(*before)
    first, second = _volume(mesh, before[0]), _volume(mesh if is_same else turgor.Mesh(*after), after[0])
    box = float(np.prod(np.ptp(before[0].astype(np.float64), axis=0)))
    return second / first if first > LEAST_PART * box else None


def _volume(mesh: turgor.Mesh, positions: NDArray[np.float32]) -> float:
    is_sound = np.array([part.is_sound for part in mesh.components], bool)
    return float(np.abs(mesh.component_volumes(positions))[is_sound].sum())


def rounding_volume(mesh: turgor.Mesh, positions: NDArray[np.floating], reach: float) -> float:
    """Largest difference of the volume that single precision explains, in cubed units of object space.

    |dV| <= sum of |dV/dp| · |dp| over the vertices, each coordinate of dp off by `ROUNDINGS` roundings of a number as
    large as `reach`, the largest coordinate in object or armature space.
    """
    areas = np.linalg.norm(mesh.volume_gradient(positions), axis=1).sum()
    return float(areas) * np.sqrt(3.0) * ROUNDINGS * HALF_ULP * reach
