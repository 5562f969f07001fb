"""Draws the outline of one picture over another, so that a small change of shape shows."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

# Red, green, blue of the line, and its half width in pixels: that of the word "Without" on the page.
LINE = (0.357, 0.451, 0.565)
HALF_WIDTH = 1.3

Pixels = NDArray[np.float32]


def draw_outline(of: Path, over: Path) -> None:
    """Adds the outline of the picture `of`, where it turns transparent, to the picture `over`, in place."""
    covered = read_picture(of)[..., 3]
    picture = read_picture(over)
    line = outline(covered)[..., None]
    picture[..., :3] += line * (np.array(LINE, np.float32) - picture[..., :3])
    picture[..., 3:] = np.maximum(picture[..., 3:], line)
    write_picture(over, picture)


def outline(covered: Pixels) -> Pixels:
    """(H, W) how much of a line along the border of what is covered lies on each pixel, 0 to 1."""
    inside = np.pad(covered > 0.5, 1, mode="edge")
    is_border = np.zeros_like(inside)
    for axis in (0, 1):
        differs = inside != np.roll(inside, 1, axis)
        is_border |= differs
    is_border = is_border[1:-1, 1:-1]
    reach = int(np.ceil(HALF_WIDTH + 0.5))
    padded = np.pad(is_border, reach)
    line = np.zeros(covered.shape, np.float32)
    rows, columns = covered.shape
    for down in range(-reach, reach + 1):
        for right in range(-reach, reach + 1):
            weight = np.clip(HALF_WIDTH + 0.5 - np.hypot(down, right), 0.0, 1.0)
            shifted = padded[reach + down : reach + down + rows, reach + right : reach + right + columns]
            line = np.maximum(line, weight * shifted)
    return line.astype(np.float32)


def read_picture(path: Path) -> Pixels:
    """(H, W, 4) from 0 to 1, from the bottom up, alpha not multiplied."""
    image = bpy.data.images.load(str(path.resolve()))
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    width, height = image.size
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)


def write_picture(path: Path, pixels: Pixels) -> None:
    """As `read_picture` gives it."""
    height, width, _ = pixels.shape
    image = bpy.data.images.new(path.stem, width, height, alpha=True)
    image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    image.filepath_raw, image.file_format = str(path.resolve()), "PNG"
    image.save()
    bpy.data.images.remove(image)
