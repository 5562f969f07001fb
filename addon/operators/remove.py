"""Remove Turgor Volume from the selected characters."""

from __future__ import annotations

import bpy

from .. import runtime
from ..live import housekeeping
from ..scene import stack


class OBJECT_OT_turgor_volume_remove(bpy.types.Operator):
    bl_idname = "object.turgor_volume_remove"
    bl_label = "Remove Turgor Volume"
    bl_description = "Remove Turgor Volume from the selected meshes, with its settings and all that it made"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not _chosen(context):
            cls.poll_message_set("No selected mesh has Turgor Volume")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        with runtime.quiet():
            for ob in _chosen(context):
                housekeeping.remove(ob)
        return {"FINISHED"}


CLASSES = (OBJECT_OT_turgor_volume_remove,)


def _chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    objects = {context.object, *context.selected_objects} - {None}
    return [ob for ob in objects if ob.library is None and stack.volume_modifier(ob) is not None]
