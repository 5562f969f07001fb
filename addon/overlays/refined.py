"""The faces that would be refined, colored, and the edges that there would be."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, NamedTuple

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from .. import runtime
from ..properties.saved import volume_settings
from . import text
from .characters import MODES
from .over_skin import draw_front, over_skin

if TYPE_CHECKING:
    from ..logic.overlay_frame import OverlayFrame
    from ..logic.refined_region import Region

COLOR, LINE_COLOR = (0.2, 0.65, 1.0, 0.28), (0.05, 0.3, 0.6, 0.9)
LINE_WIDTH = 1.0


class _Drawn(NamedTuple):
    """What is on the graphics card for one character."""

    frame: OverlayFrame
    region: Region
    faces: gpu.types.GPUBatch
    lines: gpu.types.GPUBatch


# By session uid.
_drawn: dict[int, _Drawn] = {}


def is_wanted(ob: bpy.types.Object) -> bool:
    """Whether the object shows its preview now."""
    return volume_settings(ob).refine.show_preview and ob.mode in MODES


def draw(context: bpy.types.Context, ob: bpy.types.Object) -> None:
    """Draw the faces that would be refined and their new edges, in world space."""
    drawn = _prepare(ob)
    if drawn is None:
        return
    plain, wide = gpu.shader.from_builtin("UNIFORM_COLOR"), gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    with over_skin(context, ob, drawn.frame.rest.edge_length):
        plain.uniform_float("color", COLOR)
        draw_front(drawn.faces, plain)
        wide.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
        wide.uniform_float("lineWidth", LINE_WIDTH * text.scale())
        wide.uniform_float("color", LINE_COLOR)
        drawn.lines.draw(wide)


def keep_only(uids: Collection[int]) -> None:
    """Drop what is on the graphics card for objects whose session uid is not among `uids`."""
    for uid in [uid for uid in _drawn if uid not in uids]:
        del _drawn[uid]


def free(ob: bpy.types.Object) -> None:
    """Drop what is on the graphics card for a character that shows no preview."""
    _drawn.pop(ob.session_uid, None)


def _prepare(ob: bpy.types.Object) -> _Drawn | None:
    frame, region = runtime.session.look(ob), runtime.session.look_refined(ob)
    if frame is None or region is None or not len(region.triangles):
        _drawn.pop(ob.session_uid, None)
        return None
    before = _drawn.get(ob.session_uid)
    if before is not None and before.frame is frame and before.region is region:
        return before
    positions = frame.positions
    faces = batch_for_shader(
        gpu.shader.from_builtin("UNIFORM_COLOR"), "TRIS", {"pos": positions[region.triangles].reshape(-1, 3)}
    )
    lines = batch_for_shader(
        gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR"), "LINES", {"pos": region.lines(positions)}
    )
    drawn = _drawn[ob.session_uid] = _Drawn(frame, region, faces, lines)
    return drawn
