"""Mend what diagnostics found, by the button beside it."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.app.translations import pgettext_tip as tip_
from bpy.props import EnumProperty, StringProperty

from ..live import fixes, refusals
from ..messages import of_error, translated
from ..properties.fixes import DESCRIPTIONS, FIXES
from ..scene import modifier_places, spine_stack, stack
from .polling import in_edit_mode, is_allowed, linked

HIDDEN = {"HIDDEN", "SKIP_SAVE"}


class OBJECT_OT_turgor_volume_fix(bpy.types.Operator):
    bl_idname = "object.turgor_volume_fix"
    bl_label = "Fix"
    bl_description = "Mend what diagnostics found"
    bl_options = {"REGISTER", "UNDO"}

    fix: EnumProperty(items=FIXES, options=HIDDEN)
    subject: StringProperty(options=HIDDEN)
    kind: EnumProperty(items=(("VOLUME", "Turgor Volume", ""), ("SPINE", "Turgor Spine", "")), options=HIDDEN)
    refusal: StringProperty(options=HIDDEN)

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        text = tip_(DESCRIPTIONS[properties.fix])
        return f"{text}.\n{tip_(properties.refusal)}" if properties.refusal else text

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        if ob is None or ob.type != "MESH":
            cls.poll_message_set("Make a mesh with Turgor active")
            return False
        if stack.volume_modifier(ob) is None and spine_stack.spine_modifier(ob) is None:
            cls.poll_message_set("The active object has no Turgor")
            return False
        return is_allowed(cls, linked(ob) or in_edit_mode(ob.mode))

    def execute(self, context: bpy.types.Context) -> set[str]:
        refusal = refusals.refusal(context.object, self.fix, self.subject)
        if refusal:
            self.report({"ERROR"}, refusal)
            return {"CANCELLED"}
        try:
            fixes.apply(context.object, self.fix, self.subject, self.kind)
        except (fixes.FixError, modifier_places.PlaceError) as error:
            self.report({"WARNING"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (OBJECT_OT_turgor_volume_fix,)
