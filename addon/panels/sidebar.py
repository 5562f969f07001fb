"""Turgor in the sidebar of the 3D viewport: in Pose Mode the properties editor is about the armature."""

from __future__ import annotations

import bpy

from .. import runtime
from .before_after import is_after
from .curves import draw_curves
from .joint import draw_joint
from .joints import draw_joints
from .volume import draw_readout, has_volume, state_of

MODES = frozenset({"OBJECT", "POSE", "PAINT_WEIGHT"})


class TURGOR_PT_sidebar(bpy.types.Panel):
    bl_label = "Turgor Volume"
    bl_idname = "TURGOR_PT_sidebar"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Turgor"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode in MODES and bool(shown_characters(context))

    def draw(self, context: bpy.types.Context) -> None:
        for number, ob in enumerate(shown_characters(context)):
            column = self.layout.column()
            # Operators below are about this character, whatever object is active.
            column.context_pointer_set("turgor_character", ob)
            if number:
                column.separator()
            column.label(text=ob.name, translate=False, icon="OUTLINER_OB_MESH")
            draw_readout(column, state_of(ob), is_on=is_after(ob))
            draw_joints(column, context, ob)
            draw_joint(column, ob)
            self.layout.context_pointer_set("turgor_character", ob)
            draw_curves(self.layout, ob)


CLASSES = (TURGOR_PT_sidebar,)


def shown_characters(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The active object, or those that the active armature deforms."""
    ob = context.object
    if ob is None:
        return []
    if has_volume(ob):
        return [ob]
    if ob.type != "ARMATURE":
        return []
    of_rig = [
        (uid, character)
        for uid, character in list(runtime.session.characters.items())
        if character.binding is not None and character.binding.rig == ob.session_uid
    ]
    found = [runtime.object_of(uid, character, bpy.data.objects) for uid, character in of_rig]
    return [target for target in found if target is not None and has_volume(target)]
