"""What one frame of the correction reads, from evaluated data only; safe on a worker thread."""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from . import obstacles, placement, shape_keys, skeleton, stack


class FrameInputs(NamedTuple):
    """The pose, where the armature stands, and the shape keys."""

    pose_matrices: NDArray[np.float32]  # (R, 4, 4) `skeleton.read_pose`
    object_from_armature: NDArray[np.float64]  # (4, 4)
    shape_values: NDArray[np.float32]  # (K,)


class FrameError(ValueError):
    """The evaluated objects cannot be read; says what to do."""


def read_frame(target: bpy.types.Object, bones: skeleton.RestBones) -> FrameInputs:
    """`target`: the evaluated character; its bones as they were bound."""
    return read_inputs(target, rig_of(target), bones)


def read_inputs(target: bpy.types.Object, rig: bpy.types.Object | None, bones: skeleton.RestBones) -> FrameInputs:
    """Read what one frame is made of; `target` and `rig` must be evaluated copies. No rig: nothing poses by bones.

    Raises skeleton.PoseError where the armature is another than was bound.
    """
    if rig is None:
        return FrameInputs(np.zeros((0, 4, 4), np.float32), placement.IDENTITY, shape_keys.read_values(target))
    return FrameInputs(
        skeleton.read_pose(rig, bones), placement.object_from_armature(target, rig), shape_keys.read_values(target)
    )


def rig_of(target: bpy.types.Object) -> bpy.types.Object | None:
    """The armature's object, evaluated if the character is; None where other modifiers alone pose it."""
    place = armature_place(target)
    return None if place is None else target.modifiers[place].object


def armature_place(target: bpy.types.Object) -> int | None:
    """Place in the stack of the Armature that divides it; None where other modifiers alone pose the character."""
    armature = stack.armature_modifier(target)
    if armature is None and obstacles.obstacle(target) is None:
        return None
    if armature is None or armature.object is None:
        found = obstacles.obstacle(target)
        raise FrameError("No armature" if found is None else found.text)
    return list(target.modifiers).index(armature)
