"""Where the armature stands to the mesh: now, and as it stood when the character was bound.

The binding uses the saved place, so that it is the same in every session, whatever frame is opened first.
"""

from __future__ import annotations

from math import inf

import bpy
import numpy as np
from numpy.typing import NDArray

IDENTITY = np.eye(4)
# Part of the mesh's size by which it may stand elsewhere without other weights of bendy bones or envelopes.
STILL = 1e-6
NO_INVERSE = "Object is scaled to zero: give it a scale other than 0 on every axis"


class PlacementError(ValueError):
    """The object's matrix has no inverse; says what to do."""


def object_from_armature(target: bpy.types.Object, rig: bpy.types.Object) -> NDArray[np.float64]:
    """(4, 4) as both stand now; the same for a curve."""
    world_from_object, world_from_armature = target.matrix_world, rig.matrix_world
    # Most meshes stand where their armature stands.
    if world_from_object == world_from_armature and 0.0 < abs(world_from_object.determinant()) < inf:
        return IDENTITY.copy()
    try:
        return np.linalg.solve(np.array(world_from_object, np.float64), np.array(world_from_armature, np.float64))
    except np.linalg.LinAlgError:
        raise PlacementError(NO_INVERSE) from None


def corners(positions: NDArray[np.floating]) -> NDArray[np.float64]:
    """(8, 3) of the box around positions, (N, 3)."""
    low, high = positions.min(axis=0), positions.max(axis=0)
    chosen = (np.arange(8)[:, None] >> np.arange(3)) & 1
    return np.where(chosen, high, low).astype(np.float64)


def is_elsewhere(
    target: bpy.types.Object, now: NDArray[np.float64], bound: NDArray[np.float64], box: NDArray[np.float64]
) -> bool:
    """Whether the mesh stands elsewhere to its armature than when it was bound, by more than single precision.

    now, bound: object_from_armature. box: `corners` of the mesh.
    """
    if np.linalg.det(now[:3, :3]) == 0.0:
        return False  # the engine refuses it, and says why
    before, after = (box @ m[:3, :3].T + m[:3, 3] for m in (np.linalg.inv(bound), np.linalg.inv(now)))
    size = np.linalg.norm(before[7] - before[0])
    far = max(target.matrix_world.translation.length / max(target.matrix_world.median_scale, 1e-30), 1e-30)
    return bool(np.abs(after - before).max() > STILL * size + 8.0 * np.finfo(np.float32).eps * far)


def bound_object_from_armature(settings: bpy.types.PropertyGroup) -> NDArray[np.float64] | None:
    """(4, 4) as saved in an object's `turgor` or `turgor_spine`; None when nothing was saved."""
    saved = np.array(settings.bound_placement, np.float64).reshape(4, 4)
    return saved if saved.any() else None


def save(settings: bpy.types.PropertyGroup, rig: bpy.types.Object) -> None:
    """Bind with the armature, or the curve, where it stands now."""
    target = settings.id_data
    matrix = object_from_armature(target, rig)
    if not np.isfinite(matrix).all() or np.linalg.det(matrix) == 0.0:
        raise PlacementError(f"{rig.name} is scaled to zero or stands nowhere: correct its transform and press Rebind")
    settings.bound_placement = matrix.ravel()
