"""Settings of the active joint, with its curves when they are its own."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

SHARE_NAMES = ("Along Bone", "Sideways", "Inside")
CURVES = (("curve_along", "Along Bone"), ("curve_sideways", "Sideways"), ("curve_inside", "Inside"))


def draw_joint(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    """Of the joint chosen in the list; nothing without one."""
    joints = ob.turgor.joints
    if not 0 <= ob.turgor.active_joint < len(joints):
        return
    joint = joints[ob.turgor.active_joint]
    edited, title = edited_settings(ob, joint)
    layout.label(text=title, icon="BONE_DATA", translate=False)
    column = layout.column()
    column.use_property_split = True
    column.prop(edited, "preset")
    column.prop(edited, "strength")
    column.prop(edited, "size")
    column.prop(edited, "use_auto_shares")
    if not joint.use_auto_shares:
        shares = column.column(align=True)
        for index, name in enumerate(SHARE_NAMES):
            shares.prop(edited, "shares", index=index, text=name, slider=True)
    if joint.preset == "CUSTOM":
        _draw_curves(layout, joint, ob.turgor.curves)


def edited_settings(ob: bpy.types.Object, joint: bpy.types.PropertyGroup) -> tuple[bpy.types.PropertyGroup, str]:
    """What sliders change, and its title: the active joint, or with others selected all of them.

    Joints of a library override are edited one by one: what stands for several is not saved, so not overridden.
    """
    joints = ob.turgor.joints
    flags = [False] * len(joints)
    joints.foreach_get("select", flags)
    others = sum(flags) - joint.select
    if not others or ob.override_library is not None:
        return joint, joint.name
    return ob.turgor.several, iface_("{name} and {count} more").format(name=joint.name, count=others)


def _draw_curves(layout: bpy.types.UILayout, joint: bpy.types.PropertyGroup, tree: bpy.types.NodeTree | None) -> None:
    for name, title in CURVES:
        node = None if tree is None else tree.nodes.get(getattr(joint, name))
        if node is not None:
            layout.label(text=title)
            layout.template_curve_mapping(node, "mapping")
