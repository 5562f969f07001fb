"""What each kind of modifier does with a frame: writes offsets to an address, or says that there is nothing to show."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from . import frame, spine_frame

# The evaluated target, address of its offsets (N, 3) float32, N.
FRAMES: dict[str, Callable[[bpy.types.Object, int, int], bool]] = {
    "VOLUME": frame.correct,
    "SPINE": spine_frame.flesh_frame,
}
