"""Settings of the active joint; its profile curves have a panel of their own."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..properties.joint import TurgorJoint
from ..properties.joint_names import label
from ..properties.saved import volume_settings
from ..properties.selected_joints import TurgorSelectedJoints
from .joint_presets import TURGOR_PT_joint_presets


def active_joint(ob: bpy.types.Object) -> TurgorJoint | None:
    """The joint chosen in the list."""
    saved = volume_settings(ob)
    joints, place = saved.joints, saved.active_joint
    return joints[place] if 0 <= place < len(joints) else None


def draw_joint(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    """Draw the settings of the joint chosen in the list; nothing without one."""
    joint = active_joint(ob)
    if joint is None:
        return
    edited, title = edited_settings(ob, joint)
    header = layout.row()
    header.label(text=title, icon="BONE_DATA", translate=False)
    TURGOR_PT_joint_presets.draw_panel_header(header)
    column = layout.column()
    column.use_property_split = True
    column.prop(edited, "preset")
    column.prop(edited, "strength")
    column.prop(edited, "size")
    column.prop(edited, "flex")
    if volume_settings(ob).flesh > 0.0:
        _draw_flesh(column, edited, joint.use_auto_outside)
    _draw_silence(column, ob, joint)


def edited_settings(ob: bpy.types.Object, joint: TurgorJoint) -> tuple[TurgorJoint | TurgorSelectedJoints, str]:
    """What sliders change, and its title: the active joint, or with others selected all of them.

    Joints of a library override are edited one by one: what stands for several is not saved, so not overridden.
    """
    saved = volume_settings(ob)
    joints = saved.joints
    flags = [False] * len(joints)
    joints.foreach_get("select", flags)
    others = sum(flags) - joint.select
    name = label(joint.name, iface_)
    if not others or ob.override_library is not None:
        return joint, name
    return saved.several, iface_("{name} and {count} more").format(name=name, count=others)


def _draw_flesh(column: bpy.types.UILayout, edited: TurgorJoint | TurgorSelectedJoints, is_auto: bool) -> None:
    column.prop(edited, "flesh")
    row = column.row(align=True)
    own = row.row(align=True)
    own.active = not is_auto
    own.prop(edited, "outside")
    row.prop(edited, "use_auto_outside", toggle=True)
    column.prop(edited, "spread_twist")
    column.prop(edited, "crease")


def _draw_silence(layout: bpy.types.UILayout, ob: bpy.types.Object, joint: TurgorJoint) -> None:
    if joint.mute:
        layout.label(text="Muted: it gives nothing back", icon="INFO")
    elif not joint.is_solo and any(other.is_solo for other in volume_settings(ob).joints):
        layout.label(text="Another joint is solo: it gives nothing back", icon="INFO")
