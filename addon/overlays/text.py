"""Text over a viewport in Blender's own style, size and place."""

from __future__ import annotations

from typing import NamedTuple

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader

FONT = 0
Color = tuple[float, float, float, float]
# Of Blender's own texts in the viewport, in widgets.
LINE_HEIGHT, LEFT_MARGIN, TOP_MARGIN = 0.9, 0.5, 0.1
WIDGET = 20.0
# Lines of the statistics overlay, with the gaps around them.
STATISTICS_LINES = 6
# A shadow all around, of the opposite lightness; the level is Blender's for outlines. Over meshes, a ground as well.
OUTLINE_LEVEL, OUTLINE_ALPHA = 6, 0.7
TAG_ALPHA = 0.5


class Rect(NamedTuple):
    """Pixels of a region, from its lower left corner."""

    left: float
    bottom: float
    right: float
    top: float


def scale() -> float:
    """Pixels per pixel at a resolution scale of 1."""
    return bpy.context.preferences.system.ui_scale


def unit() -> float:
    """Pixels of one widget's height."""
    return WIDGET * scale()


def visible_rect(context: bpy.types.Context) -> Rect:
    """What header, toolbar and sidebar leave free."""
    region = context.region
    left, bottom, right, top = 0.0, 0.0, float(region.width), float(region.height)
    for other in context.area.regions:
        if other.type == "WINDOW" or other.width <= 1 or other.height <= 1:
            continue
        x, y = other.x - region.x, other.y - region.y
        if x + other.width <= 0 or y + other.height <= 0 or x >= region.width or y >= region.height:
            continue
        if other.alignment == "TOP":
            top = min(top, y)
        elif other.alignment == "BOTTOM":
            bottom = max(bottom, y + other.height)
        elif other.alignment == "LEFT":
            left = max(left, x + other.width)
        elif other.alignment == "RIGHT":
            right = min(right, x)
    return Rect(left, bottom, right, top)


def first_line(context: bpy.types.Context, rect: Rect) -> tuple[float, float]:
    """Where text may begin: left end and baseline below what Blender itself writes there."""
    overlay = context.space_data.overlay
    lines = 1.0
    if overlay.show_text:
        lines += 2.0
        # The name of the grid's unit.
        lines += float(context.region_data.is_orthographic_side_view)
    if context.space_data.shading.type == "RENDERED":
        lines += 1.0
    if overlay.show_stats:
        lines += STATISTICS_LINES
    return rect.left + LEFT_MARGIN * unit(), rect.top - (TOP_MARGIN + lines * LINE_HEIGHT) * unit()


def theme_color(*, emphasised: bool = True) -> Color:
    """The color of Blender's own texts in the viewport."""
    red, green, blue = bpy.context.preferences.themes[0].view_3d.space.text_hi[:3]
    return red, green, blue, 1.0 if emphasised else 0.8


def size() -> float:
    """Points in pixels."""
    return bpy.context.preferences.ui_styles[0].widget.points * scale()


def width(text: str) -> float:
    """Pixels of a line."""
    blf.size(FONT, size())
    return blf.dimensions(FONT, text)[0]


def fill(rect: Rect, color: Color) -> None:
    """A plain rectangle."""
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    shader.uniform_float("color", color)
    corners = [(rect.left, rect.bottom), (rect.right, rect.bottom), (rect.left, rect.top), (rect.right, rect.top)]
    gpu.state.blend_set("ALPHA")
    batch_for_shader(shader, "TRI_STRIP", {"pos": corners}).draw(shader)
    gpu.state.blend_set("NONE")


def tag(text: str, x: float, y: float, color: Color) -> None:
    """A line that lies over meshes of any color, on a ground of its own."""
    margin = 0.25 * unit()
    opposite = _opposite(color)
    ground = Rect(x - margin, y - margin, x + width(text) + margin, y + 0.75 * size() + margin)
    fill(ground, (opposite, opposite, opposite, TAG_ALPHA))
    write(text, x, y, color)


def _opposite(color: Color) -> float:
    return 0.0 if sum(color[:3]) > 1.5 else 1.0


def write(text: str, x: float, y: float, color: Color) -> float:
    """One line from its left end and baseline; its right end."""
    blf.size(FONT, size())
    blf.enable(FONT, blf.SHADOW)
    opposite = _opposite(color)
    blf.shadow(FONT, OUTLINE_LEVEL, opposite, opposite, opposite, OUTLINE_ALPHA * color[3])
    blf.shadow_offset(FONT, 0, 0)
    blf.color(FONT, *color)
    blf.position(FONT, round(x), round(y), 0)
    blf.draw(FONT, text)
    blf.disable(FONT, blf.SHADOW)
    return x + blf.dimensions(FONT, text)[0]
