"""A small picture of three profile curves, by which an artist tells one preset from another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

SIZE = 128
MARGIN = 10
LINE = 1.6  # half its width, pixels
# Along the bone, across, into the bend: as the axes in the viewport, red, green, blue.
COLORS = ((0.95, 0.32, 0.35), (0.45, 0.78, 0.2), (0.3, 0.55, 0.98))
GROUND = (0.13, 0.13, 0.14)


def picture(tables: Sequence[NDArray[np.float64]]) -> NDArray[np.float32]:
    """(SIZE, SIZE, 4) RGBA, rows from the bottom up, of three tables over x in [-1, 1] with heights in 0..1."""
    pixels = np.empty((SIZE, SIZE, 4), np.float32)
    pixels[...] = (*GROUND, 1.0)
    places = np.linspace(0.0, 1.0, SIZE - 2 * MARGIN)
    rows = np.arange(SIZE)[:, None]
    inner = pixels[:, MARGIN:-MARGIN, :3]
    for table, color in zip(tables, COLORS, strict=True):
        heights = np.interp(places, np.linspace(0.0, 1.0, len(table)), np.clip(table, 0.0, 1.0))
        line = MARGIN + heights * (SIZE - 2 * MARGIN)
        # Distance across the line, not upwards, so that steep parts are as thick as flat ones.
        distance = np.abs(rows - line) / np.hypot(1.0, np.gradient(line))
        cover = np.clip(LINE + 0.5 - distance, 0.0, 1.0)[..., None]
        inner[...] = inner * (1.0 - cover) + np.asarray(color) * cover
    return pixels
