"""Bind the active character again, as its mesh is now."""

from __future__ import annotations

import bpy

from ..live import binding
from .polling import in_edit_mode, is_allowed, without_own_volume


class OBJECT_OT_turgor_volume_rebind(bpy.types.Operator):
    bl_idname = "object.turgor_volume_rebind"
    bl_label = "Rebind"
    bl_description = "Read the mesh, its weights and its armature again; settings of joints stay"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        return is_allowed(cls, without_own_volume(ob) or in_edit_mode(ob.mode))

    def execute(self, context: bpy.types.Context) -> set[str]:
        binding.rebind(context.object, context.scene.frame_current)
        return {"FINISHED"}


CLASSES = (OBJECT_OT_turgor_volume_rebind,)
