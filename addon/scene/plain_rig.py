"""A double of an armature without bendy bones and envelopes, for what knows neither: it does what the artist's does."""

from __future__ import annotations

import bpy

# Custom property that marks such doubles.
MARK = "turgor_plain_rig"


def make(rig: bpy.types.Object) -> bpy.types.Object:
    """A double of `rig` in its collections: each bone copies its own on every frame."""
    data = rig.data.copy()
    data.animation_data_clear()
    for bone in data.bones:
        bone.bbone_segments = 1
        bone.use_envelope_multiply = False
    double = rig.copy()
    double.data, double.name, data.name = data, f"{rig.name} Plain", f"{rig.data.name} Plain"
    double[MARK] = True
    if double.animation_data is not None:
        for curve in list(double.animation_data.drivers):
            if curve.data_path.startswith("pose."):
                double.animation_data.drivers.remove(curve)
    local = [collection for collection in rig.users_collection if collection.library is None]
    for collection in local or [bpy.context.scene.collection]:
        collection.objects.link(double)
    for bone in double.pose.bones:
        for constraint in list(bone.constraints):
            bone.constraints.remove(constraint)
        copying = bone.constraints.new("COPY_TRANSFORMS")
        copying.target, copying.subtarget = rig, bone.name
    double.select_set(False)
    return double


def doubles_of(ob: bpy.types.Object) -> list[bpy.types.Object]:
    """Doubles that the Armature modifiers of an object follow."""
    rigs = [modifier.object for modifier in ob.modifiers if modifier.type == "ARMATURE"]
    return [rig for rig in rigs if rig is not None and rig.get(MARK)]


def discard(double: bpy.types.Object) -> None:
    """Delete a double with its armature, unless somebody else follows it."""
    data = double.data
    bpy.data.objects.remove(double)
    if data.users == 0:
        bpy.data.armatures.remove(data)
