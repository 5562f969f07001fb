"""One frame of a character whose stack Blender evaluates: what the engine is to add to its own skin. Worker threads."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..messages import message
from ..scene import carrier, frame, rest, twin
from ..states import VolumeBinding


def options(
    target: bpy.types.Object,
    bound: VolumeBinding,
    inputs: frame.FrameInputs,
    pose_matrices: NDArray[np.float32],
) -> dict[str, Any]:
    """Arguments of `VolumeSkin.deform` by which the engine starts from what Blender evaluated, for `target` evaluated.

    pose_matrices: (B, 4, 4) of the bones that were bound. Raises frame.FrameError.
    """
    evaluated = bound.evaluated
    assert evaluated is not None
    holder = carrier.carrier_of(target)
    if holder is None or not holder.is_evaluated:
        raise frame.FrameError("The carrier of the character is gone: press Rebind")
    posed = _read(holder, "pose", bound)
    if evaluated.has_body:
        body = _read(holder, "body", bound)
        asked: dict[str, Any] = {"rest_positions": body}
    else:
        body, asked = _shaped(bound, evaluated.shape_deltas, inputs.shape_values), {}
    skinned: NDArray[np.floating] = body
    if len(pose_matrices):
        skinned = bound.body.skinning.deform(body, pose_matrices, inputs.object_from_armature)
    asked["added_offsets"] = np.subtract(posed, skinned, dtype=np.float64).astype(np.float32)
    if bound.fleshed is not None:
        asked["fleshed"] = bound.fleshed
    return asked


def _read(holder: bpy.types.Object, part: twin.Part, bound: VolumeBinding) -> NDArray[np.float32]:
    found = twin.of_carrier(holder, part)
    if found is None or not found.is_evaluated:
        raise frame.FrameError("What Blender evaluates for the character is not there yet: press Rebind")
    mesh = found.data
    positions = rest.read_positions(mesh)
    corners = None if bound.evaluated is None else bound.evaluated.corners
    if len(positions) != bound.body.vertex_count:
        text = message(
            "On this frame the stack makes {found:,} vertices, {bound:,} were bound: apply the modifier that changes"
            " their number, or move it after Turgor Volume",
            found=len(positions),
            bound=bound.body.vertex_count,
        )
        raise frame.FrameError(text)
    if corners is not None and not np.array_equal(rest.read_faces(mesh)[1], corners):
        text = (
            "On this frame the stack makes other faces than were bound: apply the modifier that changes them, or move"
            " it after Turgor Volume"
        )
        raise frame.FrameError(text)
    return positions


def _shaped(bound: VolumeBinding, deltas: NDArray[np.float32], values: NDArray[np.float32]) -> NDArray[np.floating]:
    """(N, 3) the bound body with its shape keys."""
    positions: NDArray[np.floating] = bound.body.rest.positions
    used = np.flatnonzero(values)
    if len(used):
        positions = positions.astype(np.float64)
        for key in used.tolist():
            positions += float(values[key]) * deltas[key]
    return positions
