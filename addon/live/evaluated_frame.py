"""One frame of a character whose stack Blender evaluates: what the engine is to add to its own skin. Worker threads."""

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

# Part of the largest coordinate up to which Blender's float32 skin and the engine's are the same.
ROUNDING = 8.0 * float(np.finfo(np.float32).eps)


def options(
    target: bpy.types.Object,
    bound: VolumeBinding,
    inputs: frame.FrameInputs,
    pose_matrices: NDArray[np.float32],
    *,
    is_off: bool,
) -> dict[str, Any]:
    """Arguments of `VolumeSkin.deform` by which the engine starts from what Blender evaluated, for `target` evaluated.

    pose_matrices: (B, 4, 4) of the bones that were bound. Raises frame.FrameError, and BindError where a modifier makes
    other vertices now.

    is_off: our modifier is off in this evaluation, and then Blender evaluates no twins.
    """
    evaluated = bound.evaluated
    assert evaluated is not None
    holder = carrier.carrier_of(target)
    if holder is None or not holder.is_evaluated:
        raise frame.FrameError("The carrier of the character is gone: press Rebind")
    posed = _shown(target, bound) if is_off else _read(holder, "pose", bound)
    if evaluated.has_body:
        body = _read(holder, "body", bound)
        asked: dict[str, Any] = {"rest_positions": body}
    else:
        body, asked = _shaped(bound, evaluated.shape_deltas, inputs.shape_values), {}
    skinned: NDArray[np.floating] = body
    if len(pose_matrices):
        skinned = bound.body.skinning.deform(body, pose_matrices, inputs.object_from_armature)
    added = np.subtract(posed, skinned, dtype=np.float64).astype(np.float32)
    # What rounding leaves is no deformation, and has no place where its volume was lost.
    if np.abs(added).max(initial=0.0) > ROUNDING * np.abs(posed).max(initial=0.0):
        asked["added_offsets"] = added
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


def _shaped(bound: VolumeBinding, deltas: NDArray[np.float32], values: NDArray[np.float32]) -> NDArray[np.floating]:
    """(N, 3) the bound body with its shape keys."""
    positions: NDArray[np.floating] = bound.body.rest.positions
    used = np.flatnonzero(values)
    if len(used):
        positions = positions.astype(np.float64)
        for key in used.tolist():
            positions += float(values[key]) * deltas[key]
    return positions
