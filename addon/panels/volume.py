"""Turgor Volume in the modifier tab: the readout, the joints, the state."""

from __future__ import annotations

import textwrap

import bpy

from .. import runtime
from .percent import signed_percent

PARENT_PANEL = "TURGOR_PT_volume"
ROUTE_NAMES = {"PULL": "Live by pull", "PUSH": "Live by push", "": "Not started"}
# Pixels of the panel per character of text, at a user interface scale of 1.
CHARACTER_WIDTH = 7.0


class TURGOR_PT_volume(bpy.types.Panel):
    bl_label = "Turgor Volume"
    bl_idname = PARENT_PANEL
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "modifier"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.type == "MESH"

    def draw(self, context: bpy.types.Context) -> None:
        ob = context.object
        if not has_volume(ob):
            self.layout.operator("object.turgor_volume_add", text="Add Turgor Volume", icon="ADD")
            return
        known = runtime.session.characters.get(ob.session_uid, runtime.Character())
        _draw_problem(self.layout, context, known)
        _draw_readout(self.layout, known)
        _draw_joints(self.layout, ob)
        _draw_settings(self.layout, ob)
        _draw_state(self.layout, context, known)


def has_volume(ob: bpy.types.Object | None) -> bool:
    """Whether the object was given Turgor Volume: settings are stamped then."""
    return ob is not None and ob.type == "MESH" and ob.turgor.version > 0


def _draw_problem(layout: bpy.types.UILayout, context: bpy.types.Context, known: runtime.Character) -> None:
    if known.problem is None:
        return
    box = layout.box()
    box.alert = True
    _draw_wrapped(box, context, known.problem, "ERROR")
    if known.needs_rebind:
        box.operator("object.turgor_volume_rebind", icon="FILE_REFRESH")


def _draw_readout(layout: bpy.types.UILayout, known: runtime.Character) -> None:
    figures = known.figures
    box = layout.box()
    big = box.row()
    big.scale_y = 1.6
    big.alignment = "CENTER"
    if figures is None:
        big.label(text="Volume –")
        return
    big.label(text=f"Volume {signed_percent(figures.corrected_deviation, 4)}")
    small = box.row()
    small.alignment = "CENTER"
    small.active = False
    small.label(text=f"Plain skinning {signed_percent(figures.skinned_deviation, 2)}")


def _draw_joints(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    header = layout.row()
    header.active = False
    header.label(text="Joint")
    names = header.row()
    names.alignment = "RIGHT"
    names.label(text="Lost    Regained")
    layout.template_list("TURGOR_UL_joints", "", ob.turgor, "joints", ob.turgor, "active_joint", rows=6)


def _draw_settings(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    column = layout.column()
    column.prop(ob.turgor, "keep_bone_scale")
    column.use_property_split = True
    column.prop(ob.turgor, "target_volume")
    column.prop(ob.turgor, "solver")


def _draw_state(layout: bpy.types.UILayout, context: bpy.types.Context, known: runtime.Character) -> None:
    column = layout.column(align=True)
    for note in known.notes:
        _draw_wrapped(column, context, note, "INFO")
    state = layout.row()
    state.active = False
    text = ROUTE_NAMES[runtime.session.route]
    if known.timing is not None:
        text += f", {known.timing.total:.2f} ms per frame"
    state.label(text=text)
    if runtime.session.route == "PUSH":
        _draw_wrapped(column, context, f"Push: {runtime.session.route_reason}", "INFO")
    buttons = layout.row(align=True)
    buttons.operator("object.turgor_volume_rebind", icon="FILE_REFRESH")
    buttons.operator("object.turgor_volume_remove", text="Remove", icon="X")


def _draw_wrapped(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    width = context.region.width / (CHARACTER_WIDTH * context.preferences.system.ui_scale)
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, max(int(width) - 8, 20))):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")
