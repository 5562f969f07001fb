"""Profile curves of the active joint: what shape the volume has that it gives back."""

from __future__ import annotations

from typing import NamedTuple

import bpy

from ..properties.joint import TurgorJoint
from ..properties.profiles import ProfileSet
from ..properties.saved import volume_settings
from .joint import active_joint, edited_settings
from .volume import VolumeSubpanel


class Axis(NamedTuple):
    """One axis of a joint in words: what is at the left and the right end of its curve."""

    curve: str  # property of the set with the node's name
    title: str
    share: str
    ends: tuple[str, str]
    symmetric_end: str


AXES = (
    Axis("curve_along", "Along the Bone", "Along", ("Parent", "Child"), "Parent, Child"),
    Axis("curve_sideways", "Across, Seen from Inside", "Across", ("Left", "Right"), "Left, Right"),
    Axis("curve_inside", "Into the Bend", "Inside", ("Outside", "Inside"), "Outside, Inside"),
)


class TURGOR_PT_curves(VolumeSubpanel, bpy.types.Panel):
    bl_label = "Profile Curves"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return super().poll(context) and active_joint(context.object) is not None

    def draw(self, context: bpy.types.Context) -> None:
        draw_curves(self.layout, context.object)


CLASSES = (TURGOR_PT_curves,)


def draw_curves(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    """Draw the profile curves of the active joint: both sets and what leads from one to the other."""
    joint = active_joint(ob)
    if joint is None:
        return
    profiles = joint.shown
    edited, _ = edited_settings(ob, joint)
    column = layout.column()
    column.use_property_split = True
    _draw_blend(column, joint, edited)
    if profiles != joint:
        column.prop(profiles, "preset")
    # As volume is lost only curves change, directions stay those of the first set.
    if profiles == joint or joint.blend_mode == "VALUE":
        _draw_direction(column, profiles, edited if profiles == joint else profiles)
    _draw_set(layout, ob, profiles)


def _draw_blend(column: bpy.types.UILayout, joint: TurgorJoint, edited: bpy.types.PropertyGroup) -> None:
    column.prop(edited, "blend_mode")
    if joint.blend_mode == "NONE":
        return
    if joint.blend_mode == "VALUE":
        column.prop(edited, "blend")
    else:
        row = column.row(align=True)
        row.prop(edited, "fold_loss")
        row.operator("object.turgor_fold_loss_measure", text="", icon="VIEWZOOM")
    switch = column.row()
    switch.use_property_split = False
    switch.prop(joint, "shown_set", expand=True)


def _draw_direction(column: bpy.types.UILayout, profiles: ProfileSet, edited: bpy.types.PropertyGroup) -> None:
    column.prop(edited, "use_auto_shares")
    if not profiles.use_auto_shares:
        shares = column.column(align=True)
        for index, axis in enumerate(AXES):
            shares.prop(edited, "shares", index=index, text=axis.share, slider=True)


def _draw_set(layout: bpy.types.UILayout, ob: bpy.types.Object, profiles: ProfileSet) -> None:
    tree = volume_settings(ob).curves
    for index, axis in enumerate(AXES):
        node = None if tree is None else tree.nodes.get(getattr(profiles, axis.curve))
        if node is None:
            # Linked, and never shown where it is from.
            continue
        header, body = layout.panel(f"TURGOR_PT_{axis.curve}")
        header.label(text=axis.title)
        header.prop(profiles, "is_symmetric", index=index, text="", icon="MOD_MIRROR", emboss=False)
        if body is None:
            continue
        column = body.column(align=True)
        column.template_curve_mapping(node, "mapping")
        _draw_ends(column, axis, is_symmetric=profiles.is_symmetric[index])
    if profiles.preset == "CUSTOM":
        layout.operator("object.turgor_curves_reset", icon="LOOP_BACK")


def _draw_ends(column: bpy.types.UILayout, axis: Axis, *, is_symmetric: bool) -> None:
    left, right = ("Joint", axis.symmetric_end) if is_symmetric else axis.ends
    ends = column.row()
    ends.active = False
    ends.label(text=left)
    middle = ends.row()
    middle.alignment = "RIGHT"
    middle.label(text=right)
