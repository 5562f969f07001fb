"""Volumes written into the viewport: of each character below Blender's own texts, of joints where they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from .. import runtime
from ..messages import VISIBLE_PERCENT, signed_percent, volume_error
from ..properties.joint_names import label
from ..states import VolumeState
from . import text
from .characters import active_joint, is_after

if TYPE_CHECKING:
    from ..logic.character_figures import JointFigures

# Joints are written that took at least this part of what the joint that took most did, and this many at most.
NOTABLE_PART, MOST_JOINTS = 0.1, 12


def draw(ob: bpy.types.Object, character: VolumeState, x: float, y: float) -> float:
    """Write the volume error of one character on the baseline `y`, in pixels; returns the next baseline."""
    figures = character.figures
    if figures is None:
        return y
    corrected = volume_error(figures.corrected_deviation)
    skinned = signed_percent(figures.skinned_deviation, 2)
    computed = corrected if is_after(ob) else skinned
    measured = figures.shown_deviation
    error = iface_("{error}, computed").format(error=computed) if measured is None else volume_error(measured)
    if is_after(ob):
        shown = iface_("volume {error}").format(error=error)
        beside = iface_("without Turgor {error}").format(error=skinned)
    else:
        shown = iface_("volume {error}, Turgor is off").format(error=error)
        beside = iface_("with Turgor {error}").format(error=corrected)
    gap = 0.6 * text.unit()
    end = text.write(f"{ob.name}  {shown}", x, y, text.theme_color())
    text.write(beside, end + gap, y, text.theme_color(emphasised=False))
    return y - text.LINE_HEIGHT * text.unit()


def draw_joints(context: bpy.types.Context, ob: bpy.types.Object, character: VolumeState) -> None:
    """Write at each notable joint what skinning took and Turgor gave back; at the active one always, with its name."""
    figures, frame = character.figures, runtime.session.look(ob)
    if figures is None or frame is None:
        return
    active = active_joint(ob)
    taken: list[text.Rect] = []
    for name in _notable(figures.joints, active):
        origin = frame.joint_origin(name)
        place = None if origin is None else _on_screen(context, ob, origin)
        if place is not None:
            _draw_joint(name, figures.joints[name], place, taken, is_active=name == active)


def _draw_joint(name: str, joint: JointFigures, place: Vector, taken: list[text.Rect], *, is_active: bool) -> None:
    lost, regained = (signed_percent(value, 2) for value in (-joint.lost, joint.regained))
    line = f"{label(name, iface_)}  {lost} / {regained}" if is_active else f"{lost} / {regained}"
    width, height = text.width(line), text.size()
    gap = 0.6 * text.unit()
    wanted = text.Rect(place.x + gap, place.y, place.x + gap + width, place.y + height)
    if any(_overlap(wanted, other) for other in taken):
        return
    taken.append(wanted)
    text.write("•", place.x - 0.5 * text.width("•"), place.y, text.theme_color(emphasised=is_active))
    text.tag(line, wanted.left, wanted.bottom, text.theme_color(emphasised=is_active))


def _notable(joints: dict[str, JointFigures], active: str) -> list[str]:
    """The active one first, then by what they took: those that come later give way."""
    names = sorted(joints, key=lambda name: -abs(joints[name].lost))
    least = max(VISIBLE_PERCENT, NOTABLE_PART * abs(joints[names[0]].lost)) if names else 0.0
    chosen = [name for name in names if abs(joints[name].lost) >= least and name != active][:MOST_JOINTS]
    return [active, *chosen] if active in joints else chosen


def _on_screen(context: bpy.types.Context, ob: bpy.types.Object, point: np.ndarray) -> Vector | None:
    return location_3d_to_region_2d(context.region, context.region_data, ob.matrix_world @ Vector(point))


def _overlap(one: text.Rect, other: text.Rect) -> bool:
    return one.left < other.right and other.left < one.right and one.bottom < other.top and other.bottom < one.top
