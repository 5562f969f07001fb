"""Take back what was drawn into the shown profile curves."""

from __future__ import annotations

import bpy

from ..live import profiles
from .character import character_of
from .polling import is_allowed, without_own_volume


class OBJECT_OT_turgor_curves_reset(bpy.types.Operator):
    bl_idname = "object.turgor_curves_reset"
    bl_label = "Reset Curves"
    bl_description = "Go back to the preset that the shown profile curves were drawn from"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = character_of(context)
        if not is_allowed(cls, without_own_volume(ob)):
            return False
        shown = profiles.shown_set(ob)
        if shown is None or shown.preset != "CUSTOM":
            cls.poll_message_set("The shown profile curves are those of a preset")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        shown = profiles.shown_set(character_of(context))
        shown.preset = shown.curve_source
        return {"FINISHED"}


CLASSES = (OBJECT_OT_turgor_curves_reset,)
