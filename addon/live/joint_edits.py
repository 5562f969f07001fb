"""Edits of joints: copies of their settings, to others and to the other side of the body. Main thread only."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..properties.joint import SETTINGS, TurgorJoint
from ..properties.joint_names import flipped
from ..properties.selected_joints import edited_joints
from . import profiles


def copy(source: TurgorJoint, joint: TurgorJoint) -> None:
    """Give `joint` the settings and curves of `source`, perhaps of another character."""
    profiles.copy(source, joint)
    profiles.copy(source.second, joint.second)
    for name in SETTINGS:
        setattr(joint, name, getattr(source, name))


def copy_to_selected(target: bpy.types.Object) -> int:
    """Copy the active joint's settings to the selected ones; returns how many were given them."""
    source, *others = edited_joints(target.turgor) or [None]
    for joint in others:
        copy(source, joint)
    return len(others)


def mirror(target: bpy.types.Object) -> tuple[int, list[str]]:
    """Give the joints on the other side the settings of the active and selected ones: how many, and who has no other.

    Nothing is turned: the axes of a joint are its bend's own, they are mirrored with the pose. Where both sides are
    chosen the active one's side is kept, else that of the first in the list.
    """
    joints = target.turgor.joints
    done: set[str] = set()
    missing: list[str] = []
    for joint in edited_joints(target.turgor):
        other = flipped(joint.name, bpy.utils.flip_name)
        if other == joint.name or joint.name in done:
            continue
        if other not in joints:
            missing.append(joint.name)
            continue
        copy(joint, joints[other])
        done |= {joint.name, other}
    return len(done) // 2, missing


def reset(joints: Sequence[TurgorJoint]) -> None:
    """Give the joints the settings that a new joint has."""
    for joint in joints:
        joint.second.preset, joint.preset = "ISOTROPIC", joint.id_data.turgor.preset_of_new
        joint.second.use_auto_shares = joint.use_auto_shares = True
        for name in (*SETTINGS, "mute", "is_solo"):
            setattr(joint, name, _default(joint, name))


def _default(joint: TurgorJoint, name: str) -> object:
    return joint.bl_rna.properties[name].default


def select(target: bpy.types.Object, action: str) -> None:
    """action: ALL, NONE or INVERT."""
    for joint in target.turgor.joints:
        joint.select = {"ALL": True, "NONE": False, "INVERT": not joint.select}[action]
