"""Pictures of Blender's own window: each step sets up the scene, lets Blender draw, and is taken from the screen.

Blender cannot read its own window back from a script, so ImageMagick's `import` takes it from the X server.
"""

from __future__ import annotations

import subprocess
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import bpy

SECONDS_TO_DRAW = 0.6


class Picture(NamedTuple):
    """One picture: what to do first, and what of the window to keep."""

    name: str
    set_up: Callable[[], object]
    crop: Callable[[], tuple[int, int, int, int]]  # left, bottom, width, height in pixels of the window


def take(pictures: Sequence[Picture], folder: Path, end: Callable[[bool], object]) -> None:
    """Take all, one after the other, while Blender's event loop runs; `end` is told whether all went well."""
    folder.mkdir(parents=True, exist_ok=True)
    waiting = [(picture, phase) for picture in pictures for phase in (_set_up, _redraw, _save)]

    def next_phase() -> float | None:
        if not waiting:
            end(True)
            return None
        picture, phase = waiting.pop(0)
        try:
            with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
                phase(picture, folder)
        except Exception:
            traceback.print_exc()
            end(False)
            return None
        return SECONDS_TO_DRAW

    bpy.app.timers.register(next_phase, first_interval=SECONDS_TO_DRAW)


def area(kind: str) -> bpy.types.Area:
    """The largest area of this type."""
    areas = [found for found in bpy.context.window_manager.windows[0].screen.areas if found.type == kind]
    return max(areas, key=lambda found: found.width * found.height)


def of_area(kind: str) -> Callable[[], tuple[int, int, int, int]]:
    """Crops to an area."""

    def crop() -> tuple[int, int, int, int]:
        found = area(kind)
        return found.x, found.y, found.width, found.height

    return crop


def whole() -> tuple[int, int, int, int]:
    """The window as it is."""
    window = bpy.context.window_manager.windows[0]
    return 0, 0, window.width, window.height


def _set_up(picture: Picture, *_arguments: object) -> None:
    picture.set_up()
    _redraw()


def _redraw(*_arguments: object) -> None:
    for found in bpy.context.window_manager.windows[0].screen.areas:
        found.tag_redraw()


def _save(picture: Picture, folder: Path) -> None:
    window = bpy.context.window_manager.windows[0]
    left, bottom, width, height = picture.crop()
    top = window.height - bottom - height
    geometry = f"{width}x{height}+{window.x + left}+{top}"
    path = folder / f"{picture.name}.png"
    subprocess.run(["import", "-window", "root", "-crop", geometry, "+repage", str(path)], check=True)
    print(f"{path.name}: {width} x {height}")
