"""Text that is too long for one line of a panel."""

from __future__ import annotations

import textwrap

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..messages import translated

# Pixels of the panel per character of text, at a user interface scale of 1.
CHARACTER_WIDTH = 6.4


def draw_wrapped(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """Draw a text in the artist's language, wrapped to the panel's width, with an icon before its first line."""
    width = context.region.width / (CHARACTER_WIDTH * context.preferences.system.ui_scale)
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(translated(text, iface_), max(int(width) - 8, 20))):
        column.label(text=line, translate=False, icon=icon if number == 0 else "BLANK1")
