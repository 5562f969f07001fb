"""What every panel of ours says of its modifier: what is wrong, and what a frame costs."""

from __future__ import annotations

import bpy

from .. import runtime
from .text import draw_wrapped


def draw_problem(
    layout: bpy.types.UILayout, context: bpy.types.Context, known: runtime.Character, rebind_operator: str
) -> None:
    """Why the modifier does nothing, with a button where binding again helps."""
    if known.problem is None:
        return
    box = layout.box()
    box.alert = True
    draw_wrapped(box, context, known.problem, "ERROR")
    if known.needs_rebind:
        button = box.row()
        button.alert = False
        button.operator(rebind_operator, icon="FILE_REFRESH")


def draw_timing(layout: bpy.types.UILayout, known: runtime.Character) -> None:
    """Milliseconds of the last frame."""
    if known.timing is not None:
        line = layout.row()
        line.active = False
        line.label(text=f"{known.timing.total:.2f} ms per frame")
