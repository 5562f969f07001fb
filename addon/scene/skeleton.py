"""Bones at rest: those that deform a mesh and all their ancestors."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray


class RestBones(NamedTuple):
    """B bones, armature space."""

    names: tuple[str, ...]
    parents: NDArray[np.int32]  # (B,) -1 without one
    rest_matrices: NDArray[np.float64]  # (B, 4, 4)
    pose_indices: NDArray[np.int32]  # (B,) place among all bones of the pose
    is_deform: NDArray[np.bool_]  # (B,) deforms this mesh
    tails: NDArray[np.float64]  # (B, 3)


# Of a mesh that no Armature poses.
NO_BONES = RestBones(
    (),
    np.zeros(0, np.int32),
    np.zeros((0, 4, 4)),
    np.zeros(0, np.int32),
    np.zeros(0, bool),
    np.zeros((0, 3)),
)


def read_bones(rig: bpy.types.Object, group_names: Collection[str]) -> RestBones:
    """Bones whose name is a vertex group and that deform, with their ancestors, in the order of the pose.

    Other bones are left out: nothing makes the dependency graph evaluate them before the correction.
    """
    bones = rig.data.bones
    deform = {bone.name for bone in bones if bone.use_deform and bone.name in group_names}
    needed = deform | {parent.name for name in deform for parent in bones[name].parent_recursive}
    places = [place for place, pose_bone in enumerate(rig.pose.bones) if pose_bone.name in needed]
    names = tuple(rig.pose.bones[place].name for place in places)
    index = {name: number for number, name in enumerate(names)}
    parents = [index[bone.parent.name] if (bone := bones[name]).parent else -1 for name in names]
    rest_matrices = np.array([bones[name].matrix_local for name in names], np.float64).reshape(-1, 4, 4)
    return RestBones(
        names,
        np.array(parents, np.int32),
        rest_matrices,
        np.array(places, np.int32),
        np.array([name in deform for name in names], bool),
        np.array([bones[name].tail_local for name in names], np.float64).reshape(-1, 3),
    )


def signature(armature: bpy.types.Armature) -> list[object]:
    """What of the bones a binding depends on; cheap, for posing updates the armature too."""
    bones = armature.bones
    rest_matrices = np.empty((len(bones), 16), np.float32)
    segments = np.empty(len(bones), np.int32)
    is_deform = np.empty(len(bones), bool)
    is_multiplied = np.empty(len(bones), bool)
    if len(bones):
        bones.foreach_get("matrix_local", rest_matrices.ravel())
        bones.foreach_get("bbone_segments", segments)
        bones.foreach_get("use_deform", is_deform)
        bones.foreach_get("use_envelope_multiply", is_multiplied)
    arrays = (rest_matrices, segments, is_deform, is_multiplied)
    parents = [bone.parent.name if bone.parent else None for bone in bones]
    return [bones.keys(), parents, *(array.tobytes() for array in arrays)]
