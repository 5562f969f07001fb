"""Masks in the modifier tab: where volume may come back, and what stays as skinned."""

from __future__ import annotations

import bpy

from ..properties.saved import volume_settings
from .volume import VolumeSubpanel


class TURGOR_PT_masks(VolumeSubpanel, bpy.types.Panel):
    bl_label = "Masks"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        ob = context.object
        column = self.layout.column()
        column.use_property_split = True
        _draw_group(column, ob, "vertex_group")
        _draw_group(column, ob, "pin_group")


CLASSES = (TURGOR_PT_masks,)


def _draw_group(layout: bpy.types.UILayout, ob: bpy.types.Object, setting: str) -> None:
    saved = volume_settings(ob)
    name = getattr(saved, setting)
    row = layout.row(align=True)
    picker = row.row(align=True)
    picker.alert = bool(name) and name not in ob.vertex_groups
    picker.prop_search(saved, setting, ob, "vertex_groups")
    if setting == "vertex_group":
        invert = row.row(align=True)
        invert.active = bool(name)
        invert.prop(saved, "invert_vertex_group", text="", icon="ARROW_LEFTRIGHT")
    is_there = name in ob.vertex_groups
    paint = row.operator("object.turgor_mask_paint", text="", icon="WPAINT_HLT" if is_there else "ADD")
    paint.mask = setting
