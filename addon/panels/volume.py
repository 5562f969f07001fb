"""Turgor Volume in the modifier tab: the readout, the joints, the state."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_iface as iface_

from .. import runtime
from ..messages import signed_percent, volume_error
from ..properties.saved import volume_settings
from ..states import VolumeState
from .before_after import draw_before_after, is_after
from .diagnostics import draw_findings
from .joint import draw_joint
from .joints import draw_joints
from .modifier_tab import ModifierTab

if TYPE_CHECKING:
    from ..logic.character_figures import Folds

PARENT_PANEL = "TURGOR_PT_volume"


class TURGOR_PT_volume(ModifierTab, bpy.types.Panel):
    bl_label = "Turgor Volume"
    bl_idname = PARENT_PANEL

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        return has_volume(ob) or (
            ob is not None and ob.type == "MESH" and any(modifier.type == "ARMATURE" for modifier in ob.modifiers)
        )

    def draw(self, context: bpy.types.Context) -> None:
        ob = context.object
        if not has_volume(ob):
            self.layout.operator("object.turgor_volume_add", text="Add Turgor Volume", icon="ADD")
            return
        character = state_of(ob)
        draw_before_after(self.layout, ob)
        draw_readout(self.layout, character, is_on=is_after(ob))
        draw_findings(self.layout, context, character, "VOLUME")
        draw_joints(self.layout, context, ob)
        draw_joint(self.layout, ob)


class VolumeSubpanel(ModifierTab):
    """A panel below Turgor Volume, shown once a mesh has it."""

    bl_parent_id = PARENT_PANEL

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_volume(context.object)


CLASSES = (TURGOR_PT_volume,)


def has_volume(ob: bpy.types.Object | None) -> bool:
    """Whether the object was given Turgor Volume: settings are stamped then."""
    return ob is not None and ob.type == "MESH" and volume_settings(ob).version > 0


def state_of(ob: bpy.types.Object) -> VolumeState:
    """The state of a character in this session; an empty one when it was never bound."""
    return runtime.session.characters.get(ob.session_uid, VolumeState())


def draw_readout(layout: bpy.types.UILayout, character: VolumeState, *, is_on: bool) -> None:
    """The volume error of the mesh that is shown; on the second line without Turgor, or with it where it is off."""
    figures = character.figures
    if figures is None:
        return
    corrected = volume_error(figures.corrected_deviation)
    skinned = signed_percent(figures.skinned_deviation, 2)
    computed, beside = (corrected, iface_("without Turgor")) if is_on else (skinned, iface_("with Turgor"))
    measured = figures.shown_deviation
    shown = iface_("{error}, computed").format(error=computed) if measured is None else volume_error(measured)
    column = layout.box().column(align=True)
    line = column.row()
    line.alignment = "CENTER"
    line.label(text=iface_("Volume error {error}").format(error=shown), translate=False)
    line = column.row()
    line.alignment = "CENTER"
    line.active = False
    line.label(text=" ".join((beside, skinned if is_on else corrected)), translate=False)
    if figures.folds is not None:
        line = column.row()
        line.alignment = "CENTER"
        line.active = False
        line.label(text=_folds_text(figures.folds), translate=False)


def _folds_text(folds: Folds) -> str:
    if not folds.found_count:
        return iface_("No folds")
    text = iface_("Folds: {found:,}, left: {left:,}, vertices held: {blocked:,}")
    return text.format(found=folds.found_count, left=folds.left_count, blocked=folds.blocked_count)
