"""Bind the active character again, as its mesh is now."""

from __future__ import annotations

import bpy

from ..live import binding
from ..scene import stack


class OBJECT_OT_turgor_volume_rebind(bpy.types.Operator):
    bl_idname = "object.turgor_volume_rebind"
    bl_label = "Rebind"
    bl_description = "Read the mesh, its weights and its armature again; settings of joints stay"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        if ob is None or ob.library is not None or stack.volume_modifier(ob) is None:
            cls.poll_message_set("The active object has no Turgor Volume of its own")
            return False
        if ob.mode not in {"OBJECT", "POSE"}:
            cls.poll_message_set("Leave the edit or paint mode first")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        binding.rebind(context.object, context.scene.frame_current)
        return {"FINISHED"}
