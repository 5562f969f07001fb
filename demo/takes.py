"""What is played: the actions of the file, or fixed random poses for a rig without any."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from dataclasses import dataclass

import bpy
from mathutils import Matrix, Vector

# Frames played in all; with many actions each gets an even part, but never fewer than the second number.
FRAME_COUNT = 240
LEAST_FRAMES_PER_TAKE = 4
POSE_COUNT = 12
LARGEST_ANGLE = math.radians(45.0)


@dataclass(frozen=True)
class Take:
    """One action on one armature, and the frames to look at."""

    name: str
    armature: bpy.types.Object
    action: bpy.types.Action
    frames: tuple[int, ...]

    def begin(self) -> None:
        """Makes the action the only animation of the armature."""
        animation = self.armature.animation_data or self.armature.animation_data_create()
        for track in animation.nla_tracks:
            track.mute = True
        for bone in self.armature.pose.bones:
            bone.matrix_basis.identity()
        animation.action = self.action
        if animation.action_slot is None:
            animation.action_slot = animation.action_suitable_slots[0]


def bone_names(action: bpy.types.Action) -> set[str]:
    """Names of the bones that an action moves."""
    paths = {
        curve.data_path
        for layer in action.layers
        for strip in layer.strips
        for bag in strip.channelbags
        for curve in bag.fcurves
    }
    return {path.split('"')[1] for path in paths if path.startswith('pose.bones["')}


def sampled(action: bpy.types.Action, count: int) -> tuple[int, ...]:
    """At most `count` whole frames, evenly over the action, both ends included."""
    start, end = math.floor(action.frame_range[0]), math.ceil(action.frame_range[1])
    step_count = max(1, min(count - 1, end - start))
    return tuple(sorted({round(start + (end - start) * step / step_count) for step in range(step_count + 1)}))


def random_poses(armature: bpy.types.Object) -> bpy.types.Action:
    """An action of fixed random poses, one per frame from 1; the same for the same bones on every machine."""
    generator = random.Random(",".join(bone.name for bone in armature.pose.bones))
    animation = armature.animation_data or armature.animation_data_create()
    animation.action = bpy.data.actions.new("Random poses")
    for frame in range(1, POSE_COUNT + 1):
        for bone in armature.pose.bones:
            axis = Vector([generator.gauss(0.0, 1.0) for _ in range(3)])
            bone.rotation_mode = "QUATERNION"
            angle = generator.uniform(-LARGEST_ANGLE, LARGEST_ANGLE)
            bone.rotation_quaternion = Matrix.Rotation(angle, 3, axis).to_quaternion()
            bone.keyframe_insert("rotation_quaternion", frame=frame)
    return animation.action


def takes(armatures: list[bpy.types.Object]) -> list[Take]:
    """Every action that moves bones of these armatures; random poses where there is none."""
    found = [
        (armature, action)
        for armature in armatures
        for action in list(bpy.data.actions)
        if bone_names(action) & set(armature.pose.bones.keys())
    ]
    still = [armature for armature in armatures if armature not in {armature for armature, _ in found}]
    found += [(armature, random_poses(armature)) for armature in still]
    count = max(LEAST_FRAMES_PER_TAKE, FRAME_COUNT // max(1, len(found)))
    return [Take(action.name, armature, action, sampled(action, count)) for armature, action in found]


def played(all_takes: list[Take]) -> Iterator[tuple[Take, int]]:
    """Sets the scene to every frame of every take in turn."""
    for take in all_takes:
        take.begin()
        for frame in take.frames:
            bpy.context.scene.frame_set(frame)
            yield take, frame
