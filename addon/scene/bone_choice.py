"""Which bone of an armature is chosen: read, and chosen in Pose Mode."""

from __future__ import annotations

import bpy


class ChoiceError(ValueError):
    """Why a bone cannot be chosen, and what to do."""


def active_bone_name(rig: bpy.types.Object) -> str:
    """Name of the armature's active bone; empty without one."""
    bone = rig.data.bones.active
    return "" if bone is None else bone.name


def choose_bone(context: bpy.types.Context, rig: bpy.types.Object, name: str) -> None:
    """Enter Pose Mode and make this bone the only selected and the active one."""
    if rig.name not in context.view_layer.objects or not rig.visible_get():
        raise ChoiceError(f"{rig.name} is hidden: show the armature first")
    if name not in rig.data.bones:
        raise ChoiceError(f"{rig.name} has no bone {name} any more")
    if context.object is not None and context.object != rig and context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    context.view_layer.objects.active = rig
    rig.select_set(True)
    if rig.mode != "POSE":
        bpy.ops.object.mode_set(mode="POSE")
    for pose_bone in rig.pose.bones:
        _select(pose_bone, pose_bone.name == name)
    rig.data.bones.active = rig.data.bones[name]


def _select(pose_bone: bpy.types.PoseBone, is_selected: bool) -> None:
    """Select or deselect a bone of a pose; from Blender 5.0 on each pose of an armature has its own selection."""
    holder = pose_bone if hasattr(pose_bone, "select") else pose_bone.bone
    holder.select = is_selected
