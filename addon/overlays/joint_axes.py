"""The three directions of the active joint, named as the profile curves name them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import gpu
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.batch import batch_for_shader

from .. import runtime
from . import text
from .characters import active_joint

if TYPE_CHECKING:
    from turgor import JointField

NAMES = ("Along the parent", "Hinge", "Inside of the bend")
# Of Blender's axes in the theme: the colors artists know.
COLORS = ("axis_x", "axis_y", "axis_z")
LINE_WIDTH = 2.5
# Of the arrow, as parts of its length.
HEAD_LENGTH, HEAD_WIDTH = 0.12, 0.04
# In a straight pose the hinge may lie anywhere across the bone: then it fades, but can still be seen.
FAINTEST = 0.15


def draw(context: bpy.types.Context, ob: bpy.types.Object) -> None:
    """Draw the three directions of the active joint as arrows, in world space over everything."""
    field = _field(ob)
    if field is None:
        return
    world = np.array(ob.matrix_world, np.float64)
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("NONE")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", LINE_WIDTH * text.scale())
    for axis in range(3):
        shader.uniform_float("color", _color(axis, field.axes_share))
        batch_for_shader(shader, "LINES", {"pos": _arrow(field, axis, world)}).draw(shader)
    gpu.state.blend_set("NONE")


def draw_names(context: bpy.types.Context, ob: bpy.types.Object) -> None:
    """Write the names of the three directions at the arrows' tips, in pixels."""
    field = _field(ob)
    if field is None:
        return
    world = np.array(ob.matrix_world, np.float64)
    for axis, name in enumerate(NAMES):
        start, tip = (
            location_3d_to_region_2d(context.region, context.region_data, point)
            for point in _arrow(field, axis, world)[:2]
        )
        if start is None or tip is None:
            continue
        gap, label = 0.5 * text.unit(), iface_(name)
        # Beyond the tip, never over the arrow.
        left = tip.x + gap if tip.x >= start.x else tip.x - gap - text.width(label)
        color = (*text.theme_color()[:3], _color(axis, field.axes_share)[3])
        text.tag(label, left, tip.y - 0.35 * text.size(), color)


def _field(ob: bpy.types.Object) -> JointField | None:
    frame = runtime.session.look(ob)
    return None if frame is None else frame.joint_field(active_joint(ob))


def _color(axis: int, share: float) -> text.Color:
    red, green, blue = getattr(bpy.context.preferences.themes[0].user_interface, COLORS[axis])[:3]
    # The direction along the parent is the same in a straight pose.
    return red, green, blue, 1.0 if axis == 0 else max(float(share), FAINTEST)


def _arrow(field: JointField, axis: int, world: np.ndarray) -> np.ndarray:
    """(10, 3) pairs of points of the shaft and the head, world space; the second is the tip."""
    tip, start = field.origin + field.length * field.axes[axis], field.origin
    along = field.length * field.axes[axis]
    sides = [sign * HEAD_WIDTH * field.length * field.axes[(axis + step) % 3] for step in (1, 2) for sign in (1, -1)]
    points = [start, tip]
    for side in sides:
        points += [tip, tip - HEAD_LENGTH * along + side]
    return (np.array(points) @ world[:3, :3].T + world[:3, 3]).astype(np.float32)
