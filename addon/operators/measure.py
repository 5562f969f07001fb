"""Measure how much volume the joints of a character lose over the scene's frames."""

from __future__ import annotations

import bpy

from ..live import measuring, sampling
from .character import character_of
from .modal import progress_shown
from .polling import is_allowed, without_volume


class OBJECT_OT_turgor_volume_measure(bpy.types.Operator):
    bl_idname = "object.turgor_volume_measure"
    bl_label = "Measure Volume over Frames"
    bl_description = (
        "Find the volume that skinning takes at each joint over the scene's frames, or its preview range;"
        " rigs without animation are tried out by turning each joint"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_allowed(cls, without_volume(character_of(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        frames = sampling.scene_frames(context.scene)
        try:
            with progress_shown(context, 2 * len(frames)) as tell:
                motion = measuring.measure(character_of(context), frames, tell=tell, is_evaluated=True)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if motion.frames is None:
            self.report({"INFO"}, "Nothing moves in these frames: each joint was turned in turn instead")
        return {"FINISHED"}


CLASSES = (OBJECT_OT_turgor_volume_measure,)
