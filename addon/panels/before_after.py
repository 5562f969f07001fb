"""Before / After: the mesh without Turgor and with it."""

from __future__ import annotations

import bpy

from .. import runtime


def draw_before_after(layout: bpy.types.UILayout, ob: bpy.types.Object) -> None:
    """Switches the effect in the viewport; renders and keyed strength stay as they are."""
    modifier = runtime.session.find_modifier(ob)
    if modifier is not None:
        row = layout.row(align=True)
        row.prop(modifier, "show_viewport", text="Before", icon="NONE", toggle=1, invert_checkbox=True)
        row.prop(modifier, "show_viewport", text="After", icon="NONE", toggle=1)


def is_after(ob: bpy.types.Object) -> bool:
    """Whether the viewport shows the effect."""
    modifier = runtime.session.find_modifier(ob)
    return modifier is None or modifier.show_viewport
