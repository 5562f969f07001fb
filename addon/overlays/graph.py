"""Volume over the measured frames, with Turgor and without, along the lower edge of a viewport."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import bpy
import gpu
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from gpu_extras.batch import batch_for_shader
from numpy.typing import ArrayLike, NDArray

from ..messages import signed_percent
from ..states import VolumeState
from . import text

if TYPE_CHECKING:
    from ..logic.character_figures import Motion, VolumeFigures

# In widgets.
HEIGHT, MARGIN, LABELS_WIDTH = 4.0, 1.0, 3.5
BACKGROUND = (0.0, 0.0, 0.0, 0.35)
SKINNED_COLOR, CORRECTED_COLOR = (1.0, 0.62, 0.2, 1.0), (0.35, 0.75, 1.0, 1.0)
SKINNED_WIDTH, CORRECTED_WIDTH, AXIS_WIDTH = 1.5, 2.5, 1.0
POINT_SIZE = 7.0
# The scale never shows less than this many percent, or rounding would fill it.
LEAST_RANGE = 0.1
WHITE = (1.0, 1.0, 1.0)


def draw(context: bpy.types.Context, ob: bpy.types.Object, character: VolumeState) -> None:
    """Draw the graph of one character along the lower edge of the region, in pixels."""
    free = text.visible_rect(context)
    unit = text.unit()
    frame = text.Rect(free.left + MARGIN * unit, free.bottom + 1.6 * unit, free.right - MARGIN * unit, 0.0)
    frame = frame._replace(top=frame.bottom + HEIGHT * unit)
    plot = frame._replace(left=frame.left + LABELS_WIDTH * unit, right=frame.right - 0.5 * unit)
    if plot.right - plot.left < 4.0 * unit or frame.top > free.top - 4.0 * unit:
        return
    motion = character.motion
    text.fill(frame._replace(bottom=free.bottom + 0.3 * unit, top=frame.top + 1.3 * unit), BACKGROUND)
    gpu.state.blend_set("ALPHA")
    title = f"{ob.name}  {iface_('Volume')}"
    if motion is None or motion.frames is None or not len(motion.frames):
        hint = iface_("press Measure Volume over Frames in the Turgor Volume panel")
        text.write(f"{title}: {hint}", plot.left, frame.top + 0.3 * unit, (*WHITE, 1.0))
    else:
        _draw_motion(context, motion, motion.frames, character.figures, plot)
        end = text.write(title, plot.left, frame.top + 0.3 * unit, (*WHITE, 1.0))
        label = iface_("with Turgor") if motion.is_measured else iface_("with Turgor, computed")
        end = text.write(label, end + unit, frame.top + 0.3 * unit, CORRECTED_COLOR)
        text.write(iface_("without Turgor"), end + unit, frame.top + 0.3 * unit, SKINNED_COLOR)
    gpu.state.blend_set("NONE")


def _draw_motion(
    context: bpy.types.Context,
    motion: Motion,
    frames: NDArray[np.float64],
    figures: VolumeFigures | None,
    plot: text.Rect,
) -> None:
    scene = context.scene
    first, last = (
        (scene.frame_preview_start, scene.frame_preview_end)
        if scene.use_preview_range
        else (scene.frame_start, scene.frame_end)
    )
    last = max(last, first + 1)
    values = np.concatenate([motion.seen_deviations, motion.skinned_deviations])
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    if high - low < LEAST_RANGE:
        low, high = low - 0.5 * LEAST_RANGE, high + 0.5 * LEAST_RANGE

    def place(frames: ArrayLike, percents: ArrayLike) -> np.ndarray:
        x = plot.left + (np.asarray(frames, float) - first) / (last - first) * (plot.right - plot.left)
        y = plot.bottom + (np.asarray(percents, float) - low) / (high - low) * (plot.top - plot.bottom)
        return np.stack(np.broadcast_arrays(x, y), axis=-1).astype(np.float32)

    now = scene.frame_current_final
    _line(place([first, last], 0.0), (*WHITE, 0.5), AXIS_WIDTH)
    if first <= now <= last:
        _line(place(now, [low, high]), (*WHITE, 0.8), AXIS_WIDTH)
    inside = (frames >= first) & (frames <= last)
    pairs = (
        (motion.skinned_deviations, SKINNED_COLOR, SKINNED_WIDTH),
        (motion.seen_deviations, CORRECTED_COLOR, CORRECTED_WIDTH),
    )
    for percents, color, width in pairs:
        _line(place(frames[inside], percents[inside]), color, width)
    if figures is not None and first <= now <= last:
        _points(place(now, np.clip([figures.skinned_deviation], low, high)), SKINNED_COLOR)
        seen = figures.corrected_deviation if figures.shown_deviation is None else figures.shown_deviation
        _points(place(now, np.clip([seen], low, high)), CORRECTED_COLOR)
    _label(plot, place, (low, 0.0, high), (first, now, last))


def _label(
    plot: text.Rect,
    place: Callable[[ArrayLike, ArrayLike], np.ndarray],
    percents: Sequence[float],
    frames: Sequence[float],
) -> None:
    unit, faint = text.unit(), (*WHITE, 0.8)
    first, now, last = frames
    taken: list[float] = []
    for percent in (percents[1], percents[0], percents[2]):
        y = place(first, percent)[1] - 0.35 * text.size()
        if all(abs(y - other) > text.size() for other in taken):
            taken.append(y)
            label = signed_percent(percent, 1)
            text.write(label, plot.left - 0.3 * unit - text.width(label), y, faint)
    ends = [(first, 0.0), (last, 1.0)]
    if first <= now <= last:
        ends.insert(0, (now, 0.5))
    written: list[tuple[float, float]] = []
    for frame, part in ends:
        label = f"{frame:g}"
        width = text.width(label)
        left = place(frame, 0.0)[0] - part * width
        if all(left > other_right + 0.3 * unit or left + width < other - 0.3 * unit for other, other_right in written):
            written.append((left, left + width))
            text.write(label, left, plot.bottom - 0.9 * unit, (*WHITE, 1.0) if frame == now else faint)


def _line(points: np.ndarray, color: text.Color, width: float) -> None:
    if len(points) < 2:
        return
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", width * text.scale())
    shader.uniform_float("color", color)
    flat = np.concatenate([points, np.zeros((len(points), 1), np.float32)], axis=1)
    batch_for_shader(shader, "LINE_STRIP", {"pos": flat}).draw(shader)


def _points(points: np.ndarray, color: text.Color) -> None:
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    shader.uniform_float("color", color)
    gpu.state.point_size_set(POINT_SIZE * text.scale())
    batch_for_shader(shader, "POINTS", {"pos": points}).draw(shader)
