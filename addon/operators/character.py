"""The character that an operator is about: the one a panel shows, else the active object."""

from __future__ import annotations

import bpy

# Panels that show a character which is not the active object hand it on by this name.
CONTEXT_MEMBER = "turgor_character"


def character_of(context: bpy.types.Context) -> bpy.types.Object | None:
    """With or without Turgor Volume."""
    shown = getattr(context, CONTEXT_MEMBER, None)
    ob = context.object if shown is None else shown
    return ob if ob is not None and ob.type == "MESH" else None
