"""Baking in the modifier tab: below Turgor Volume, below Turgor Spine, and on baked copies."""

from __future__ import annotations

import bpy

from .. import runtime
from ..properties.saved import bake_settings
from .modifier_tab import ModifierTab
from .spine import PARENT_PANEL as SPINE_PANEL
from .spine import has_spine
from .text import draw_wrapped
from .volume import VolumeSubpanel, has_volume

CORRECTIVE_METHODS = frozenset({"CORRECTIVE", "REDUCED", "DRIVEN"})


class BakePanel(ModifierTab):
    bl_label = "Bake"
    bl_options = {"DEFAULT_CLOSED"}


class TURGOR_PT_bake(BakePanel, VolumeSubpanel, bpy.types.Panel):
    bl_order = 90

    def draw(self, context: bpy.types.Context) -> None:
        draw_bake(self.layout, context, context.object)


class TURGOR_PT_spine_bake(BakePanel, bpy.types.Panel):
    bl_parent_id = SPINE_PANEL
    bl_order = 90

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_spine(context.object) and not has_volume(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        draw_bake(self.layout, context, context.object)


class TURGOR_PT_baked(ModifierTab, bpy.types.Panel):
    bl_label = "Turgor Bake"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        is_live = has_volume(ob) or has_spine(ob)
        return ob is not None and ob.type == "MESH" and not is_live and bool(bake_settings(ob).report)

    def draw(self, context: bpy.types.Context) -> None:
        ob = context.object
        live = bake_settings(ob).other
        if live is not None:
            self.layout.label(text=live.name, icon="OBJECT_DATA", translate=False)
        draw_report(self.layout, context, ob)
        self.layout.operator("object.turgor_bake_remove", icon="TRASH")


CLASSES = (
    TURGOR_PT_bake,
    TURGOR_PT_spine_bake,
    TURGOR_PT_baked,
)


def draw_bake(layout: bpy.types.UILayout, context: bpy.types.Context, ob: bpy.types.Object) -> None:
    """Settings, the button, and what the last bake came to."""
    saved = bake_settings(ob)
    column = layout.column()
    column.use_property_split, column.use_property_decorate = True, False
    column.prop(saved, "method", text="Method")
    column.prop(saved, "frames")
    if saved.method in {"REDUCED", "DRIVEN"}:
        column.prop(saved, "error_percent" if saved.unit == "PERCENT" else "error_length")
        column.prop(saved, "unit", text="In")
    if saved.method == "REDUCED":
        column.prop(saved, "local_keys")
        column.prop(saved, "unit_values")
    if saved.method == "DRIVEN":
        column.prop(saved, "most_keys")
    if saved.method in CORRECTIVE_METHODS:
        column.separator()
        column.prop(saved, "influences")
        column.prop(saved, "use_linear")
    column.separator()
    if has_volume(ob):
        column.prop(saved, "repair_folds")
    column.prop(saved, "folder")
    column.prop(saved, "verify")
    every = column.row()
    every.active = saved.verify
    every.prop(saved, "every_frame")
    column.prop(saved, "hide_original")
    running = runtime.session.bake
    if running is not None:
        layout.progress(factor=running.part, text=running.text)
        return
    row = layout.row(align=True)
    row.scale_y = 1.2
    row.operator("object.turgor_bake", icon="RENDER_ANIMATION")
    if saved.report:
        row.operator("object.turgor_bake_remove", text="", icon="TRASH")
        draw_report(layout, context, ob)


def draw_report(layout: bpy.types.UILayout, context: bpy.types.Context, ob: bpy.types.Object) -> None:
    """The last bake, line by line."""
    column = layout.box().column(align=True)
    column.active = False
    for line in bake_settings(ob).report.splitlines():
        draw_wrapped(column, context, line, "NONE")
