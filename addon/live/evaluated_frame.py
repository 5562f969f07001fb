"""One frame of a character whose stack Blender evaluates: its body, and where the skin is left. Worker threads."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..messages import message
from ..scene import carrier, frame, rest, stack, twin
from ..scene.obstacles import Obstacle
from ..states import EvaluatedStack, VolumeBinding
from .binding_rules import BindError


def options(
    target: bpy.types.Object,
    bound: VolumeBinding,
    *,
    is_off: bool,
) -> dict[str, Any]:
    """Arguments of `VolumeSkin.deform` by which the engine starts from what Blender evaluated, for `target` evaluated.

    is_off: our modifier is off in this evaluation, and then Blender evaluates no twins.

    Raises frame.FrameError, and BindError where a modifier makes other vertices now.
    """
    evaluated = bound.evaluated
    assert evaluated is not None
    holder = carrier.carrier_of(target)
    if holder is None or not holder.is_evaluated:
        raise frame.FrameError("The carrier of the character is gone: press Rebind")
    asked: dict[str, Any] = {"posed_positions": _shown(target, bound) if is_off else _read(holder, "pose", bound)}
    if evaluated.has_body:
        asked["rest_positions"] = _read(holder, "body", bound)
    if bound.fleshed is not None:
        asked["fleshed"] = bound.fleshed
    return asked


def _shown(target: bpy.types.Object, bound: VolumeBinding) -> NDArray[np.float32]:
    """(N, 3) what the viewport shows without ours, where that is what ours would start from."""
    assert bound.evaluated is not None
    modifiers = list(target.modifiers)
    ours = stack.volume_modifier(target)
    is_last = ours is not None and not any(map(stack.is_on, modifiers[modifiers.index(ours) + 1 :]))
    if bound.evaluated.has_body or not is_last or len(target.data.vertices) != bound.body.vertex_count:
        raise frame.FrameError("Turgor Volume is off: turn it on to see its figures for this stack")
    return rest.read_positions(target.data)


def _read(holder: bpy.types.Object, part: twin.Part, bound: VolumeBinding) -> NDArray[np.float32]:
    found = twin.of_carrier(holder, part)
    if found is None or not found.is_evaluated:
        raise frame.FrameError("What Blender evaluates for the character is not there yet: press Rebind")
    mesh = found.data
    positions = rest.read_positions(mesh)
    evaluated = bound.evaluated
    assert evaluated is not None
    is_alike = len(positions) == bound.body.vertex_count
    if is_alike and evaluated.corners is not None:
        is_alike = np.array_equal(rest.read_faces(mesh)[1], evaluated.corners)
    if not is_alike:
        raise BindError(_other_topology(evaluated, len(positions), bound.body.vertex_count))
    return positions


def _other_topology(evaluated: EvaluatedStack, found: int, bound: int) -> Obstacle:
    text = message(
        "On this frame the stack makes {found:,} vertices or other faces, {bound:,} vertices were bound: press Rebind",
        found=found,
        bound=bound,
    )
    if not evaluated.suspect:
        return Obstacle("other_topology", text, "REBIND")
    text = message(
        "{modifier} makes other vertices or faces on this frame ({found:,} vertices, {bound:,} were bound): apply it,"
        " or move it after Turgor Volume",
        modifier=evaluated.suspect,
        found=found,
        bound=bound,
    )
    return Obstacle("other_topology", text, "MOVE_AFTER", evaluated.suspect)
