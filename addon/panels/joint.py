"""Settings of the active joint, with its curves when they are its own."""

from __future__ import annotations

import bpy

SHARE_NAMES = ("Along Bone", "Sideways", "Inside")
CURVES = (("curve_along", "Along Bone"), ("curve_sideways", "Sideways"), ("curve_inside", "Inside"))


def draw_joint(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    """Of the joint chosen in the list; nothing without one."""
    joints = ob.turgor.joints
    if not 0 <= ob.turgor.active_joint < len(joints):
        return
    joint = joints[ob.turgor.active_joint]
    layout.label(text=joint.name, icon="BONE_DATA")
    column = layout.column()
    column.use_property_split = True
    column.prop(joint, "preset")
    column.prop(joint, "strength")
    column.prop(joint, "size")
    column.prop(joint, "use_auto_shares")
    if not joint.use_auto_shares:
        shares = column.column(align=True)
        for index, name in enumerate(SHARE_NAMES):
            shares.prop(joint, "shares", index=index, text=name, slider=True)
    if joint.preset == "CUSTOM":
        _draw_curves(layout, joint, ob.turgor.curves)


def _draw_curves(layout: bpy.types.UILayout, joint: bpy.types.PropertyGroup, tree: bpy.types.NodeTree | None) -> None:
    for name, title in CURVES:
        node = None if tree is None else tree.nodes.get(getattr(joint, name))
        if node is not None:
            layout.label(text=title)
            layout.template_curve_mapping(node, "mapping")
