"""Spines of bodies that show them: where they rest and lie, frames, the tube within which the map is exact."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from numpy.typing import NDArray

from .. import runtime
from ..properties.saved import spine_settings
from ..states import SpineState

if TYPE_CHECKING:
    from ..logic.spine_sketch import Sketch

REST_COLOR = (0.55, 0.55, 0.6, 0.8)
SPINE_COLOR = (1.0, 0.62, 0.2, 1.0)
NORMAL_COLOR = (0.25, 0.75, 1.0, 0.9)
TUBE_COLOR = (0.35, 0.85, 0.45, 0.35)
OUTSIDE_COLOR = (1.0, 0.2, 0.25, 1.0)
LINE_WIDTH, SPINE_WIDTH, POINT_SIZE = 1.0, 2.5, 6.0

_handle: Any = None


def draw() -> None:
    """Draw all spines that a viewport shows, in world space over the mesh; returns at once where none is wanted."""
    for state in shown(bpy.context):
        if state.sketch is not None:
            _draw(state.sketch())


def shown(context: bpy.types.Context) -> Iterator[SpineState]:
    """States of visible bodies whose overlay is on, in a viewport that shows overlays."""
    if not runtime.session.spines or not context.space_data.overlay.show_overlays:
        return
    for uid, state in list(runtime.session.spines.items()):
        ob = runtime.object_of(uid, state, context.view_layer.objects)
        if ob is not None and spine_settings(ob).show_overlay and ob.visible_get():
            yield state


def _draw(sketch: Sketch) -> None:
    gpu.state.blend_set("ALPHA")
    try:
        _lines(_segments(sketch.rest), REST_COLOR, LINE_WIDTH)
        _lines(sketch.rings, TUBE_COLOR, LINE_WIDTH)
        _lines(sketch.normals, NORMAL_COLOR, LINE_WIDTH)
        _lines(_segments(sketch.posed), SPINE_COLOR, SPINE_WIDTH)
        _points(sketch.outside, OUTSIDE_COLOR)
    finally:
        gpu.state.blend_set("NONE")


def _segments(line: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.repeat(line, 2, axis=0)[1:-1]


def _lines(pairs: NDArray[np.float32], color: tuple[float, float, float, float], width: float) -> None:
    if not len(pairs):
        return
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", width * bpy.context.preferences.system.ui_scale)
    shader.uniform_float("color", color)
    batch_for_shader(shader, "LINES", {"pos": pairs}).draw(shader)


def _points(points: NDArray[np.float32], color: tuple[float, float, float, float]) -> None:
    if not len(points):
        return
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    shader.uniform_float("color", color)
    gpu.state.point_size_set(POINT_SIZE * bpy.context.preferences.system.ui_scale)
    batch_for_shader(shader, "POINTS", {"pos": points}).draw(shader)


def register() -> None:
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW")


def unregister() -> None:
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
