"""Custom profile curves of a character: made from the preset before, sampled for the engine. Main thread only."""

from __future__ import annotations

import bpy

from ..logic import joints
from ..scene import curves


def tables(target: bpy.types.Object) -> dict[int, joints.Tables]:
    """Sampled curves of all Custom joints, by place of the joint."""
    saved = target.turgor
    found = {}
    for place, joint in enumerate(saved.joints):
        if joint.preset != "CUSTOM":
            continue
        if not curves.has_curves(joint, saved.curves):
            start = joints.preset_tables(joint.curve_source.lower())
            if target.library is not None:
                found[place] = start
                continue
            curves.write(joint, curves.ensure_tree(target), start)
        found[place] = curves.sample(joint, saved.curves)
    return found


def has_custom(target: bpy.types.Object) -> bool:
    """Whether any joint uses curves of its own."""
    return any(joint.preset == "CUSTOM" for joint in target.turgor.joints)


def copy(source: bpy.types.PropertyGroup, profiles: bpy.types.PropertyGroup) -> None:
    """Make `profiles` what `source` is, perhaps of another character: preset, directions and curves."""
    profiles.preset = source.preset
    profiles.curve_source = source.curve_source
    profiles.use_auto_shares = source.use_auto_shares
    profiles.shares = source.shares
    if profiles.preset == "CUSTOM":
        curves.copy(source, profiles)
