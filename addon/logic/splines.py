"""Curves of Blender, and straight axes, as spines."""

from __future__ import annotations

import numpy as np
import turgor
from numpy.typing import NDArray

# Least part of a spine along which a body bends.
LEAST_REACH = 0.01


def spline(
    kind: str,
    points: NDArray[np.float64],
    left: NDArray[np.float64],
    right: NDArray[np.float64],
    weights: NDArray[np.float64],
    order: int,
    use_endpoint: bool,
    use_bezier: bool,
    resolution: int | None = None,
) -> turgor.Spine:
    """Fields of `scene.spine_curve.SplinePoints` without tilts. resolution: that of the rest, so that poses keep it."""
    if kind == "BEZIER":
        return turgor.Spine.from_bezier(points, left, right, resolution=resolution)
    if kind == "NURBS":
        return turgor.Spine.from_nurbs(
            points, weights, order=order, use_endpoint=use_endpoint, use_bezier=use_bezier, resolution=resolution
        )
    return turgor.Spine.from_poly(points)


def axis_spine(box: NDArray[np.float64], axis: int) -> turgor.Spine:
    """Through the middle of a box, (2, 3) least and greatest coordinates, along one of its axes."""
    ends = np.repeat(box.mean(axis=0)[None], 2, axis=0)
    ends[:, axis] = box[:, axis]
    return turgor.Spine(ends, normal=np.roll([0.0, 1.0, 0.0], axis))


def trimmed(spine: turgor.Spine, start: float, end: float) -> turgor.Spine:
    """Between two parts of its parameters; all of it from 0 to 1."""
    if start <= 0.0 and end >= 1.0:
        return spine
    low, high = spine.parameter_range
    return spine.trimmed(low + (high - low) * start, low + (high - low) * max(end, start + LEAST_REACH))


def first_angle(rest: turgor.Spine, posed: turgor.Spine) -> float:
    """Radians from the first normal of `posed` to that of `rest`, turned as little as turns the tangent."""
    before = rest.evaluate([rest.parameter_range[0]])
    after = posed.evaluate([posed.parameter_range[0]])
    tangent, normal = before.tangents[0], before.normals[0]
    axis = np.cross(tangent, after.tangents[0])
    cosine = float(tangent @ after.tangents[0])
    if cosine > -1.0 + 1e-12:  # else a half turn about the normal itself
        normal = cosine * normal + np.cross(axis, normal) + axis * (axis @ normal) / (1.0 + cosine)
    return float(np.arctan2(normal @ after.binormals[0], normal @ after.normals[0]))


def at_stations(values: NDArray[np.float64], spine: turgor.Spine) -> NDArray[np.float64]:
    """Values of control points, spread evenly over a spine that has others."""
    if len(values) == spine.station_count:
        return values
    return np.interp(np.linspace(0, 1, spine.station_count), np.linspace(0, 1, len(values)), values)
