"""The settings of a character as arrays: cheap enough for every frame, so that keyframes and drivers count."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray


class JointArrays(NamedTuple):
    """J joints in saved order."""

    presets: NDArray[np.int32]  # (J,) place in `properties.profiles.PRESETS`
    strengths: NDArray[np.float32]  # (J,)
    sizes: NDArray[np.float32]  # (J,)
    use_auto_shares: NDArray[np.bool_]  # (J,)
    shares: NDArray[np.float32]  # (J, 3)


class BodySettings(NamedTuple):
    """All of a character's settings."""

    joints: JointArrays
    solver: str
    keep_bone_scale: bool
    target_volume: float


def read_settings(target: bpy.types.Object) -> BodySettings:
    """From the original or, for animated values, from the evaluated character."""
    saved = target.turgor
    joints = saved.joints
    count = len(joints)
    arrays = JointArrays(
        np.empty(count, np.int32),
        np.empty(count, np.float32),
        np.empty(count, np.float32),
        np.empty(count, bool),
        np.empty((count, 3), np.float32),
    )
    if count:
        joints.foreach_get("preset", arrays.presets)
        joints.foreach_get("strength", arrays.strengths)
        joints.foreach_get("size", arrays.sizes)
        joints.foreach_get("use_auto_shares", arrays.use_auto_shares)
        joints.foreach_get("shares", arrays.shares.ravel())
    return BodySettings(arrays, saved.solver, saved.keep_bone_scale, saved.target_volume)


def add_joints(target: bpy.types.Object, bone_names: tuple[str, ...]) -> None:
    """Give each bone a joint; joints of bones that are gone keep their settings, should the bone come back."""
    joints = target.turgor.joints
    for name in bone_names:
        if name not in joints:
            joints.add().name = name


def rename_joints(target: bpy.types.Object, new_names: dict[str, str]) -> None:
    """Follow renamed bones."""
    for joint in target.turgor.joints:
        joint.name = new_names.get(joint.name, joint.name)


def rename_groups(target: bpy.types.Object, before: Sequence[str], after: Sequence[str]) -> None:
    """Let masks follow a vertex group that was renamed: it stands where another name stood."""
    if len(before) != len(after):
        return
    new_names = {old: new for old, new in zip(before, after, strict=True) if old not in after and new not in before}
    for setting in ("vertex_group", "pin_group"):
        name = getattr(target.turgor, setting)
        if name in new_names:
            setattr(target.turgor, setting, new_names[name])


def joint_names(target: bpy.types.Object) -> tuple[str, ...]:
    """In the order of `JointArrays`."""
    return tuple(joint.name for joint in target.turgor.joints)
