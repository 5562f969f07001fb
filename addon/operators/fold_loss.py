"""Let the second set of profile curves be reached where the joint loses most."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..live import measuring, sampling
from ..messages import of_error, translated
from ..properties.joint import TurgorJoint
from .character import character_of
from .polling import is_allowed, without_own_volume

LEAST_LOSS = TurgorJoint.__annotations__["fold_loss"].keywords["min"]


class OBJECT_OT_turgor_fold_loss_measure(bpy.types.Operator):
    bl_idname = "object.turgor_fold_loss_measure"
    bl_label = "Measure"
    bl_description = "Take the largest loss of the active joint over the scene's frames, or its preview range"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = character_of(context)
        return is_allowed(cls, without_own_volume(ob)) and 0 <= ob.turgor.active_joint < len(ob.turgor.joints)

    def execute(self, context: bpy.types.Context) -> set[str]:
        ob = character_of(context)
        joint = ob.turgor.joints[ob.turgor.active_joint]
        try:
            motion = measuring.measure(ob, sampling.scene_frames(context.scene))
        except ValueError as error:
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        loss = motion.fold_losses.get(joint.name, 0.0)
        if loss < LEAST_LOSS:
            self.report({"WARNING"}, "The joint loses no volume in these frames")
            return {"CANCELLED"}
        joint.fold_loss = loss
        return {"FINISHED"}


CLASSES = (OBJECT_OT_turgor_fold_loss_measure,)
