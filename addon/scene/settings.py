"""The settings of a character as arrays: cheap enough for every frame, so that keyframes and drivers count."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray


class JointArrays(NamedTuple):
    """J joints in saved order.

    Presets by their number in `properties.profiles.PRESETS`, blend modes in `properties.joint.BLENDS`: 0 is no blend.
    """

    presets: NDArray[np.int32]  # (J,)
    curve_sources: NDArray[np.int32]  # (J,)
    use_auto_shares: NDArray[np.bool_]  # (J,)
    shares: NDArray[np.float32]  # (J, 3)
    strengths: NDArray[np.float32]  # (J,)
    sizes: NDArray[np.float32]  # (J,)
    flexes: NDArray[np.float32]  # (J,)
    is_muted: NDArray[np.bool_]  # (J,)
    is_solo: NDArray[np.bool_]  # (J,)
    blend_modes: NDArray[np.int32]  # (J,)
    blends: NDArray[np.float32]  # (J,)
    fold_losses: NDArray[np.float32]  # (J,)
    flesh: NDArray[np.float32]  # (J,)
    use_auto_outside: NDArray[np.bool_]  # (J,)
    outside: NDArray[np.float32]  # (J,)
    spread_twists: NDArray[np.float32]  # (J,)
    creases: NDArray[np.float32]  # (J,)


# Of the property, in the order of `JointArrays`: its name, how Blender stores it, and the shape of one.
_FIELDS = (
    ("preset", np.int32, ()),
    ("curve_source", np.int32, ()),
    ("use_auto_shares", bool, ()),
    ("shares", np.float32, (3,)),
    ("strength", np.float32, ()),
    ("size", np.float32, ()),
    ("flex", np.float32, ()),
    ("mute", bool, ()),
    ("is_solo", bool, ()),
    ("blend_mode", np.int32, ()),
    ("blend", np.float32, ()),
    ("fold_loss", np.float32, ()),
    ("flesh", np.float32, ()),
    ("use_auto_outside", bool, ()),
    ("outside", np.float32, ()),
    ("spread_twist", np.float32, ()),
    ("crease", np.float32, ()),
)


class SecondSet(NamedTuple):
    """What a joint blends into; presets by their names."""

    preset: str
    curve_source: str
    use_auto_shares: bool
    shares: tuple[float, float, float]


class BodySettings(NamedTuple):
    """All of a character's settings."""

    joints: JointArrays
    seconds: dict[int, SecondSet]  # by place of the joint, only of those that blend
    solver: str
    fields: str
    flesh: float
    keep_bone_scale: bool
    target_volume: float
    repair_folds: bool


def read_settings(target: bpy.types.Object) -> BodySettings:
    """Read all settings of a character: of the original or, for animated values, of its evaluated copy."""
    saved = target.turgor
    joints = saved.joints
    count = len(joints)
    arrays = JointArrays(*(np.empty((count, *shape), kind) for _, kind, shape in _FIELDS))
    if count:
        for (name, _, _), array in zip(_FIELDS, arrays, strict=True):
            joints.foreach_get(name, array.ravel())
    seconds = {int(place): _read_second(joints[place].second) for place in np.flatnonzero(arrays.blend_modes)}
    return BodySettings(
        arrays,
        seconds,
        saved.solver,
        saved.fields,
        saved.flesh,
        saved.keep_bone_scale,
        saved.target_volume,
        saved.repair_folds,
    )


def may_move(target: bpy.types.Object) -> bool:
    """Whether keyframes or drivers of the object may change its settings from frame to frame."""
    animation = target.animation_data
    if animation is None:
        return False
    has_keys = animation.action is not None or len(animation.nla_tracks) > 0
    return has_keys or any(curve.data_path.startswith("turgor.") for curve in animation.drivers)


def _read_second(profiles: bpy.types.PropertyGroup) -> SecondSet:
    return SecondSet(profiles.preset, profiles.curve_source, profiles.use_auto_shares, tuple(profiles.shares))


def add_joints(target: bpy.types.Object, bone_names: tuple[str, ...], preset: int) -> None:
    """Give each bone a joint; joints of bones that are gone keep their settings, should the bone come back.

    preset: of new ones, by its number in `properties.profiles.PRESETS`.
    """
    joints = target.turgor.joints
    first_new = len(joints)
    for name in bone_names:
        if name not in joints:
            joints.add().name = name
    for setting in ("preset", "curve_source"):
        numbers = np.empty(len(joints), np.int32)
        joints.foreach_get(setting, numbers)
        numbers[first_new:] = preset
        joints.foreach_set(setting, numbers)


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
    """Names of the joints' bones, in the order of `JointArrays`."""
    return tuple(joint.name for joint in target.turgor.joints)
