"""Refining in the modifier tab: where, how finely, and what comes of it."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from .. import runtime
from ..properties.saved import volume_settings
from .volume import VolumeSubpanel


class TURGOR_PT_refine(VolumeSubpanel, bpy.types.Panel):
    bl_label = "Refine"
    bl_idname = "TURGOR_PT_refine"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        ob = context.object
        saved = volume_settings(ob).refine
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(saved, "threshold", slider=True)
        layout.prop(saved, "use_automatic")
        layout.prop(saved, "levels", text="Most Levels" if saved.use_automatic else "Levels")
        layout.row().prop(saved, "method", expand=True)
        layout.prop(saved, "show_preview")
        _draw_counts(layout, ob)
        layout.operator("object.turgor_refine", icon="MOD_SUBSURF")


CLASSES = (TURGOR_PT_refine,)


def _draw_counts(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    region = runtime.session.look_refined(ob)
    if region is None:
        return
    column = layout.box().column(align=True)
    # Automatic levels look at the denser mesh again.
    afterwards = iface_("{vertices:,} vertices afterwards")
    if volume_settings(ob).refine.use_automatic:
        afterwards = iface_("{vertices:,} vertices or more afterwards")
    lines = (
        iface_("{count:,} of {all:,} faces").format(count=region.face_count, all=region.all_face_count),
        afterwards.format(vertices=region.vertex_count),
    )
    for text in lines:
        line = column.row()
        line.alignment = "CENTER"
        line.label(text=text, translate=False)
