"""The character that an operator is about: the one a panel shows, else the active object."""

from __future__ import annotations

import bpy

from ..properties.selected_joints import edited_joints

# Panels that show a character which is not the active object hand it on by this name.
CONTEXT_MEMBER = "turgor_character"


def character_of(context: bpy.types.Context) -> bpy.types.Object | None:
    """The mesh that an operator is about, with or without Turgor Volume: that of its panel, else the active object.

    None where that is no mesh.
    """
    shown = getattr(context, CONTEXT_MEMBER, None)
    ob = context.object if shown is None else shown
    return ob if ob is not None and ob.type == "MESH" else None


def edited(context: bpy.types.Context) -> list:
    """The active joint of the shown character and the selected ones, the active first."""
    ob = character_of(context)
    return [] if ob is None or ob.library is not None else edited_joints(ob.turgor)


class EditsJoints:
    """An operator for the joints that are `edited`."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not edited(context):
            cls.poll_message_set("The active object has no joints of Turgor Volume of its own")
            return False
        return True
