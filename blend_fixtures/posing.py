"""Keyframes of bones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import radians

import bpy
from mathutils import Vector

from .datablocks import pose_of

Angles = tuple[float, float, float]
"""Bend, twist, sideways: degrees about the bone's local X, Y and Z."""
Pose = Mapping[str, Angles]


def set_frame_range(first: int, last: int, fps: int = 24) -> None:
    """The frames that play, both ends included."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = first, last
    scene.render.fps = fps


def key_pose(armature: bpy.types.Object, frame: int, pose: Pose) -> None:
    """Key the rotations of the bones named in `pose`."""
    for name, angles in pose.items():
        bone = pose_of(armature).bones[name]
        bone.rotation_euler = tuple(radians(angle) for angle in angles)
        bone.keyframe_insert("rotation_euler", frame=frame)


def key_poses(armature: bpy.types.Object, poses: Mapping[int, Pose]) -> None:
    """Key poses by frame; the first and last frame are the scene's range."""
    for frame, pose in poses.items():
        key_pose(armature, frame, pose)
    set_frame_range(min(poses), max(poses))
    bpy.context.scene.frame_set(min(poses))


def key_cycle(
    armature: bpy.types.Object,
    frame_count: int,
    keys: int,
    pose_at: Callable[[float], Pose],
    root: str,
    root_rise_at: Callable[[float], float],
) -> None:
    """Key a cyclic action: `pose_at` and `root_rise_at` (metres upward, the root bone's) have period one.

    Frame `frame_count + 1` repeats frame 1 and lies outside the scene's range.
    """
    for key in range(keys + 1):
        frame = 1 + frame_count * key // keys
        phase = (key % keys) / keys
        key_pose(armature, frame, pose_at(phase))
        bone = pose_of(armature).bones[root]
        bone.location = bone.bone.matrix_local.to_3x3().inverted() @ Vector((0.0, 0.0, root_rise_at(phase)))
        bone.keyframe_insert("location", frame=frame)
    set_frame_range(1, frame_count)
    bpy.context.scene.frame_set(1)
