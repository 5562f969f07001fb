"""Heat maps: the skin, as the modifier leaves it, in colors; and the legend that says what they mean."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, NamedTuple

import bpy
import gpu
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from gpu_extras.batch import batch_for_shader
from numpy.typing import NDArray

from .. import runtime
from ..messages import signed_percent
from ..properties.saved import volume_settings
from . import text
from .characters import MODES, active_joint
from .over_skin import draw_front, over_skin

if TYPE_CHECKING:
    from ..logic.overlay_frame import Colors, OverlayFrame

# Of the legend, in widgets.
BAR_WIDTH, BAR_HEIGHT = 9.0, 0.5


class _Drawn(NamedTuple):
    """What is on the graphics card for one character."""

    frame: OverlayFrame
    key: tuple[object, ...]
    colors: Colors
    triangles: NDArray[np.int32]
    elements: gpu.types.GPUIndexBuf
    batch: gpu.types.GPUBatch


# By session uid.
_drawn: dict[int, _Drawn] = {}


def draw(context: bpy.types.Context, ob: bpy.types.Object) -> None:
    """Draw the skin of a character in the colors of its heat map, in world space."""
    drawn = _prepare(ob)
    if drawn is None:
        return
    with over_skin(context, ob, drawn.frame.rest.edge_length):
        draw_front(drawn.batch, gpu.shader.from_builtin("SMOOTH_COLOR"))


def draw_legend(context: bpy.types.Context, ob: bpy.types.Object, x: float, y: float) -> float:
    """Draw the legend below the baseline `y`, in pixels; returns the next baseline."""
    drawn = _drawn.get(ob.session_uid)
    if drawn is None or not is_wanted(ob):
        return y
    unit, line = text.unit(), text.LINE_HEIGHT * text.unit()
    display = volume_settings(ob).display
    title = iface_(display.bl_rna.properties["heat"].enum_items[display.heat].name)
    if display.heat == "WEIGHT":
        title = f"{title}: {active_joint(ob)}"
    text.write(f"{ob.name}  {title}", x, y, text.theme_color())
    top = y - 0.35 * line
    _draw_bar(drawn.colors.color_map, x, top - BAR_HEIGHT * unit, BAR_WIDTH * unit, BAR_HEIGHT * unit)
    y = top - BAR_HEIGHT * unit - 0.8 * line
    low, high = (_value(context, display.heat, value) for value in (drawn.colors.lowest, drawn.colors.highest))
    color = text.theme_color(emphasised=False)
    text.write(low, x, y, color)
    text.write(high, x + BAR_WIDTH * unit - text.width(high), y, color)
    return y - 1.3 * line


def is_wanted(ob: bpy.types.Object) -> bool:
    """Whether the object shows a heat map now."""
    return volume_settings(ob).display.heat != "NONE" and ob.mode in MODES


def keep_only(uids: Collection[int]) -> None:
    """Free what belongs to no character any more."""
    for uid in [uid for uid in _drawn if uid not in uids]:
        del _drawn[uid]


def free(ob: bpy.types.Object) -> None:
    """Heat maps are large: none is kept of a character that shows none."""
    _drawn.pop(ob.session_uid, None)


def _prepare(ob: bpy.types.Object) -> _Drawn | None:
    frame = runtime.session.look(ob)
    if frame is None:
        _drawn.pop(ob.session_uid, None)
        return None
    display, joint = volume_settings(ob).display, active_joint(ob)
    world = np.array(ob.matrix_world, np.float64)
    key = (display.heat, joint, display.heat_range, display.opacity, world[:3, :3].tobytes())
    before = _drawn.get(ob.session_uid)
    if before is not None and before.frame is frame and before.key == key:
        return before
    colors = frame.heat(display.heat, joint, world, display.heat_range, display.opacity)
    if colors is None:
        _drawn.pop(ob.session_uid, None)
        return None
    triangles = frame.rest.triangles
    if before is not None and before.triangles is triangles:
        elements = before.elements
    else:
        elements = gpu.types.GPUIndexBuf(type="TRIS", seq=np.ascontiguousarray(triangles))
    batch = _batch(frame.positions, colors.colors, elements)
    drawn = _drawn[ob.session_uid] = _Drawn(frame, key, colors, triangles, elements, batch)
    return drawn


def _batch(
    positions: NDArray[np.float32], colors: NDArray[np.float32], elements: gpu.types.GPUIndexBuf
) -> gpu.types.GPUBatch:
    layout = gpu.types.GPUVertFormat()
    layout.attr_add(id="pos", comp_type="F32", len=3, fetch_mode="FLOAT")
    layout.attr_add(id="color", comp_type="F32", len=4, fetch_mode="FLOAT")
    vertices = gpu.types.GPUVertBuf(format=layout, len=len(positions))
    vertices.attr_fill(id="pos", data=np.ascontiguousarray(positions))
    vertices.attr_fill(id="color", data=np.ascontiguousarray(colors))
    return gpu.types.GPUBatch(type="TRIS", buf=vertices, elem=elements)


def _value(context: bpy.types.Context, heat: str, value: float) -> str:
    if heat == "STRAIN":
        return signed_percent(100.0 * value, 0 if abs(value) >= 0.1 else 2)
    if heat == "WEIGHT":
        return f"{value:.2f}"
    units = context.scene.unit_settings
    if units.system == "NONE":
        return f"{value:.4g}"
    return bpy.utils.units.to_string(units.system, "LENGTH", value * units.scale_length, precision=3)


def _draw_bar(color_map: NDArray[np.float32], x: float, y: float, width: float, height: float) -> None:
    at = x + np.linspace(0.0, width, len(color_map))
    points = np.zeros((len(at), 2, 2), np.float32)
    points[:, :, 0] = at[:, None]
    points[:, :, 1] = (y, y + height)
    colors = np.ones((len(at), 2, 4), np.float32)
    colors[:, :, :3] = color_map[:, None]
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    data = {"pos": points.reshape(-1, 2), "color": colors.reshape(-1, 4)}
    batch_for_shader(shader, "TRI_STRIP", data).draw(shader)
