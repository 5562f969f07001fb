"""Turgor Spine in the modifier tab: the spine, the flesh, the readout, the state."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from .. import runtime
from ..messages import signed_percent, volume_error
from ..properties.saved import spine_settings
from ..properties.spine import TurgorSpine
from ..states import SpineState
from .diagnostics import draw_findings
from .modifier_tab import ModifierTab
from .state import draw_timing

PARENT_PANEL = "TURGOR_PT_spine"
BLEND_NAMES = ("Radial", "Normal", "Binormal")


class TURGOR_PT_spine(ModifierTab, bpy.types.Panel):
    bl_label = "Turgor Spine"
    bl_idname = PARENT_PANEL

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_spine(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        ob = context.object
        state = _state_of(ob)
        _draw_readout(self.layout, ob, state)
        draw_findings(self.layout, context, state, "SPINE")
        _draw_source(self.layout, spine_settings(ob))
        _draw_flesh(self.layout, ob)


class TURGOR_PT_spine_settings(ModifierTab, bpy.types.Panel):
    bl_label = "Reach and Rest"
    bl_parent_id = PARENT_PANEL
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_spine(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        ob = context.object
        saved = spine_settings(ob)
        column = self.layout.column()
        column.use_property_split = True
        reach = column.column(align=True)
        reach.prop(saved, "start", slider=True)
        reach.prop(saved, "end", slider=True)
        group = column.row(align=True)
        group.prop_search(saved, "vertex_group", ob, "vertex_groups")
        group.prop(saved, "invert_vertex_group", text="", icon="ARROW_LEFTRIGHT")
        buttons = self.layout.row(align=True)
        buttons.operator("object.turgor_spine_rebind", icon="FILE_REFRESH")
        buttons.operator("object.turgor_spine_remove", text="Remove", icon="X")
        draw_timing(self.layout, _state_of(ob))


CLASSES = (
    TURGOR_PT_spine,
    TURGOR_PT_spine_settings,
)


def has_spine(ob: bpy.types.Object | None) -> bool:
    return ob is not None and ob.type == "MESH" and spine_settings(ob).version > 0


def _state_of(ob: bpy.types.Object) -> SpineState:
    return runtime.session.spines.get(ob.session_uid, SpineState())


def _draw_readout(layout: bpy.types.UILayout, ob: bpy.types.Object, state: SpineState) -> None:
    figures = state.figures
    if figures is None:
        return
    column = layout.box().column(align=True)
    if figures.kept_deviation is not None:
        line = column.row()
        line.alignment = "CENTER"
        computed = volume_error(figures.kept_deviation)
        measured = figures.shown_deviation
        error = iface_("{error}, computed").format(error=computed) if measured is None else volume_error(measured)
        line.label(text=iface_("Volume error {error}").format(error=error), translate=False)
        if figures.fleshed_deviation != figures.kept_deviation:
            line = column.row()
            line.alignment = "CENTER"
            line.active = False
            error = signed_percent(figures.fleshed_deviation, 4)
            line.label(text=iface_("of the fleshing alone {error}").format(error=error), translate=False)
    if spine_settings(ob).show_overlay and state.local_error is not None:
        found = state.local_error()
        line = column.row()
        line.alignment = "CENTER"
        line.active = False
        text = iface_("of small chunks {mean:.4f} %, at most {most:.3f} %")
        line.label(text=text.format(mean=100 * found.mean, most=100 * found.most), translate=False)


def _draw_source(layout: bpy.types.UILayout, saved: TurgorSpine) -> None:
    layout.row().prop(saved, "source", expand=True)
    column = layout.column()
    column.use_property_split = True
    if saved.source == "CURVE":
        column.prop(saved, "curve")
        column.prop(saved, "rest")
        return
    column.prop(saved, "rig")
    if saved.rig is not None and saved.rig.type == "ARMATURE":
        bones = column.column(align=True)
        bones.prop_search(saved, "first_bone", saved.rig.data, "bones")
        bones.prop_search(saved, "last_bone", saved.rig.data, "bones")
    column.prop(saved, "course")
    if saved.course == "BONES":
        column.prop(saved, "bend_width", slider=True)
    column.prop(saved, "use_roll")


def _draw_flesh(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    saved = spine_settings(ob)
    column = layout.column()
    column.use_property_split = True
    column.prop(saved, "kind")
    if saved.kind == "BLEND":
        blend = column.column(align=True)
        for index, name in enumerate(BLEND_NAMES):
            blend.prop(saved, "blend", index=index, text=name, slider=True)
    twist = column.column(align=True)
    twist.prop(saved, "twist_start", text="Twist Start")
    twist.prop(saved, "twist", text="End")
    column.prop(saved, "slide")
    column.prop(saved, "stretch")
    column.prop(saved, "keep_volume")
    column.prop(saved, "show_overlay")
