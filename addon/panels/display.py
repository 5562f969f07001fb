"""What the viewport shows of a character, in the order of Blender's own overlays; and what a frame costs."""

from __future__ import annotations

import bpy

from .. import runtime
from ..properties.saved import volume_settings
from .volume import VolumeSubpanel


class TURGOR_PT_display(VolumeSubpanel, bpy.types.Panel):
    bl_label = "Viewport Display"
    bl_idname = "TURGOR_PT_display"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        display = volume_settings(context.object).display
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        text = layout.column(heading="Text", align=True)
        text.prop(display, "show_readout")
        text.prop(display, "show_joint_readout")
        guides = layout.column(heading="Guides", align=True)
        guides.prop(display, "show_graph")
        guides.prop(display, "show_axes")
        heat = layout.column()
        heat.prop(display, "heat")
        details = heat.column(align=True)
        details.active = display.heat != "NONE"
        details.prop(display, "heat_range")
        details.prop(display, "opacity", slider=True)


class TURGOR_PT_performance(VolumeSubpanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        ob = context.object
        character = runtime.session.characters.get(ob.session_uid)
        timing = None if character is None else character.timing
        if timing is None:
            self.layout.label(text="Off in the viewport", icon="INFO")
            return
        column = self.layout.column(align=True)
        _line(column, "Read pose and settings", timing.read)
        _line(column, "Engine", timing.engine)
        if timing.write:
            _line(column, "Write offsets", timing.write)
        _draw_modifiers(column, ob.evaluated_get(context.view_layer.depsgraph))


CLASSES = (
    TURGOR_PT_display,
    TURGOR_PT_performance,
)


def _draw_modifiers(column: bpy.types.UILayout, evaluated: bpy.types.Object) -> None:
    """Draw times of modifiers as Blender measured them; it measures none where several run in parallel."""
    ours = runtime.session.find_modifier(evaluated)
    if ours is None:
        return
    if ours.execution_time:
        _line(column, "Add offsets to the mesh", 1e3 * ours.execution_time)
    armatures = [
        modifier for modifier in evaluated.modifiers if modifier.type == "ARMATURE" and modifier.execution_time
    ]
    for armature in armatures[:1]:
        column.separator()
        _line(column, "Armature, for comparison", 1e3 * armature.execution_time)


def _line(column: bpy.types.UILayout, name: str, milliseconds: float) -> None:
    split = column.split(factor=0.65)
    split.label(text=name)
    number = split.row()
    number.alignment = "RIGHT"
    number.label(text=f"{milliseconds:.2f} ms")
