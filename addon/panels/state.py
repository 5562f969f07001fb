"""What every panel of ours says of its modifier: what a frame costs."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..states import AnyState


def draw_timing(layout: bpy.types.UILayout, state: AnyState) -> None:
    """Milliseconds of the last frame."""
    if state.timing is not None:
        line = layout.row()
        line.active = False
        line.label(text=iface_("{time:.2f} ms per frame").format(time=state.timing.total), translate=False)
