"""Settings of the whole character in the modifier tab, and its binding."""

from __future__ import annotations

import bpy

from ..properties.saved import volume_settings
from .volume import VolumeSubpanel


class TURGOR_PT_settings(VolumeSubpanel, bpy.types.Panel):
    bl_label = "Settings"

    def draw(self, context: bpy.types.Context) -> None:
        saved = volume_settings(context.object)
        column = self.layout.column()
        column.use_property_split = True
        column.prop(saved, "target_volume")
        column.prop(saved, "flesh")
        column.prop(saved, "keep_bone_scale")
        column.prop(saved, "fields")
        column.prop(saved, "solver")
        column.prop(saved, "repair_folds")
        buttons = self.layout.row(align=True)
        buttons.operator("object.turgor_volume_rebind", icon="FILE_REFRESH")
        buttons.operator("object.turgor_volume_remove", text="Remove", icon="X")


CLASSES = (TURGOR_PT_settings,)
