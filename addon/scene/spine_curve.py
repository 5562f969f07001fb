"""A curve object as a spine: the control points of its first spline, with shape keys and hooks, as they are drawn."""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from . import bezier_handles

# What moves control points and is not followed.
FOREIGN_DEFORMERS = frozenset(
    "ARMATURE CAST CURVE LATTICE MESH_DEFORM NODES SHRINKWRAP SIMPLE_DEFORM SMOOTH SOFT_BODY WARP WAVE".split()
)


class SplinePoints(NamedTuple):
    """n control points of one spline; the curve's own space."""

    kind: str  # "BEZIER", "NURBS", "POLY"
    points: NDArray[np.float64]  # (n, 3)
    left: NDArray[np.float64]  # (n, 3) handles, of Bezier splines
    right: NDArray[np.float64]  # (n, 3)
    weights: NDArray[np.float64]  # (n,) of NURBS
    tilts: NDArray[np.float64]  # (n,) radians
    order: int
    use_endpoint: bool
    use_bezier: bool

    def plain(self) -> tuple[object, ...]:
        """All fields in a form that can be compared and hashed."""
        return tuple(part.tobytes() if isinstance(part, np.ndarray) else part for part in self)

    def moved(self, matrix: NDArray[np.float64]) -> SplinePoints:
        """The same control points in another space. matrix: (4, 4), from the points' own."""
        points, left, right = (p @ matrix[:3, :3].T + matrix[:3, 3] for p in (self.points, self.left, self.right))
        return self._replace(points=points, left=left, right=right)


def obstacle(ob: bpy.types.Object | None) -> str | None:
    """Why this curve object cannot be a spine and what to do; None when it can."""
    if ob is None or ob.type != "CURVE":
        return "No curve chosen: pick a curve object as the spine"
    if not ob.data.splines:
        return f"{ob.name} has no spline: draw one"
    spline = ob.data.splines[0]
    if spline.use_cyclic_u:
        return f"{ob.name} is cyclic: a spine has two ends, open its first spline"
    if len(_own_points(spline)) < 2:
        return f"{ob.name} has a single control point: a spine needs 2 or more"
    for modifier in ob.modifiers:
        if not modifier.show_viewport:
            continue
        if modifier.type in FOREIGN_DEFORMERS:
            return f"{modifier.name} of {ob.name} moves the curve, which is not followed: use hooks or shape keys"
        if modifier.type == "HOOK" and modifier.falloff_type != "NONE":
            return f"{modifier.name} of {ob.name} has a falloff, which is not followed: set it to No Falloff"
    return None


def read_curve(data: bpy.types.Curve) -> SplinePoints:
    """The first spline without modifiers, with its shape keys."""
    spline = data.splines[0]
    own = _own_points(spline)
    handles = _coordinates(own)
    tilts = np.empty(len(own), np.float32)
    own.foreach_get("tilt", tilts)
    handles = handles + _shape_key_offsets(data, len(own), spline.type == "BEZIER")
    weights = np.ones(len(own), np.float32)
    if spline.type != "BEZIER":
        weights = np.array([point.co[3] for point in own], np.float64)
    left, points, right = handles[:, 0], handles[:, 1], handles[:, 2]
    return SplinePoints(
        spline.type if spline.type in {"BEZIER", "NURBS"} else "POLY",
        points,
        left,
        right,
        np.asarray(weights, np.float64),
        tilts.astype(np.float64),
        spline.order_u,
        spline.use_endpoint_u,
        spline.use_bezier_u,
    )


def write_curve(data: bpy.types.Curve, read: SplinePoints) -> None:
    """Set the control points of the first spline."""
    spline = data.splines[0]
    for index, point in enumerate(_own_points(spline)):
        if spline.type == "BEZIER":
            point.handle_left_type = point.handle_right_type = "FREE"
            point.handle_left, point.co, point.handle_right = read.left[index], read.points[index], read.right[index]
        else:
            point.co = (*read.points[index], point.co[3])


def read_posed(ob: bpy.types.Object) -> SplinePoints:
    """The first spline of an evaluated curve object, with its shape keys and hooks."""
    read = read_curve(ob.data)
    is_bezier = read.kind == "BEZIER"
    handles = np.stack([read.left, read.points, read.right] if is_bezier else [read.points] * 3, axis=1)
    is_deformed = ob.data.shape_keys is not None
    for modifier in ob.modifiers:
        if modifier.type == "HOOK" and modifier.show_viewport and modifier.object is not None:
            _follow_hook(ob, modifier, handles, is_bezier)
            is_deformed = True
    if is_bezier:
        # Keyframes and drivers that move points alone leave their handles behind, as in Blender.
        settle = bezier_handles.recalculate if is_deformed else bezier_handles.straighten
        settle(handles, *_handle_types(ob.data.splines[0]))
    return read._replace(left=handles[:, 0], points=handles[:, 1], right=handles[:, 2])


def _handle_types(spline: bpy.types.Spline) -> tuple[list[str], list[str]]:
    points = spline.bezier_points
    return [point.handle_left_type for point in points], [point.handle_right_type for point in points]


def _own_points(spline: bpy.types.Spline) -> bpy.types.bpy_prop_collection:
    return spline.bezier_points if spline.type == "BEZIER" else spline.points


def _coordinates(own: bpy.types.bpy_prop_collection) -> NDArray[np.float64]:
    """(n, 3, 3): left handle, point, right handle; thrice the point where there are no handles."""
    count = len(own)
    if hasattr(own[0], "handle_left"):
        rows = np.empty((3, count, 3), np.float32)
        for row, name in zip(rows, ("handle_left", "co", "handle_right"), strict=True):
            own.foreach_get(name, row.ravel())
        return rows.transpose(1, 0, 2).astype(np.float64)
    points = np.empty((count, 4), np.float32)
    own.foreach_get("co", points.ravel())
    return np.repeat(points[:, None, :3], 3, axis=1).astype(np.float64)


def _shape_key_offsets(data: bpy.types.Curve, count: int, is_bezier: bool) -> NDArray[np.float64]:
    offsets = np.zeros((count, 3, 3))
    keys = data.shape_keys
    if keys is None:
        return offsets
    for key in keys.key_blocks[1:]:
        if not key.mute and key.value != 0.0:
            offsets += key.value * (
                _key_points(key, count, is_bezier) - _key_points(key.relative_key, count, is_bezier)
            )
    return offsets


def _key_points(key: bpy.types.ShapeKey, count: int, is_bezier: bool) -> NDArray[np.float64]:
    points = [key.data[index] for index in range(count)]
    names = ("handle_left", "co", "handle_right") if is_bezier else ("co", "co", "co")
    return np.array([[getattr(point, name) for name in names] for point in points], np.float64)


def _follow_hook(
    ob: bpy.types.Object, hook: bpy.types.HookModifier, handles: NDArray[np.float64], is_bezier: bool
) -> None:
    holder = np.array(hook.object.matrix_world, np.float64)
    if hook.subtarget and hook.object.type == "ARMATURE" and hook.subtarget in hook.object.pose.bones:
        holder = holder @ np.array(hook.object.pose.bones[hook.subtarget].matrix, np.float64)
    matrix = np.linalg.inv(np.array(ob.matrix_world, np.float64)) @ holder @ np.array(hook.matrix_inverse, np.float64)
    # Blender counts both handles and the point of a Bezier spline.
    flat = handles.reshape(-1, 3) if is_bezier else handles[:, 1]
    chosen = np.array([index for index in hook.vertex_indices if index < len(flat)], np.int64)
    if len(chosen):
        moved = flat[chosen] @ matrix[:3, :3].T + matrix[:3, 3]
        flat[chosen] += hook.strength * (moved - flat[chosen])
