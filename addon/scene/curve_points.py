"""A curve widget's points: drawn through a table with few of them, sampled, recognised."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

# A curve gets points until it is this close to the table, in heights of the widget, but for the spacing below.
FIT_TOLERANCE = 0.006
MAX_POINTS = 48
# Samples between two points at least: closer ones are no help to an artist.
MIN_SPACING = 1

Points = tuple[tuple[float, float], ...]

# Points of the tables that were drawn before, by content: those of presets come again with every joint.
_fitted: dict[bytes, Points] = {}
MOST_FITTED = 64


def sample(mapping: bpy.types.CurveMapping, count: int) -> NDArray[np.float64]:
    """(count,) heights at even places of the widget, from its left to its right end; nothing is below 0."""
    mapping.initialize()
    curve = mapping.curves[0]
    return np.array([max(mapping.evaluate(curve, float(x)), 0.0) for x in np.linspace(0.0, 1.0, count)])


def digest(mapping: bpy.types.CurveMapping) -> str:
    """Changes whenever a point does; takes microseconds."""
    points = mapping.curves[0].points
    places, handles = np.empty((len(points), 2), np.float32), np.empty(len(points), np.int32)
    points.foreach_get("location", places.ravel())
    points.foreach_get("handle_type", handles)
    content = places.tobytes() + handles.tobytes() + mapping.extend.encode()
    return hashlib.blake2b(content, digest_size=12).hexdigest()


def draw(mapping: bpy.types.CurveMapping, table: NDArray[np.float64]) -> None:
    """Draw the curve through the ends and the peak, then through where it is farthest from the table.

    Points that later ones made needless are taken away again: artists drag few points better than many.
    """
    _set_range(mapping)
    key = table.tobytes()
    if key not in _fitted:
        if len(_fitted) >= MOST_FITTED:
            _fitted.clear()
        _fitted[key] = _fit(mapping, table)
    _write_points(mapping.curves[0], _fitted[key])
    mapping.update()


def copy(source: bpy.types.CurveMapping, mapping: bpy.types.CurveMapping) -> None:
    """Give `mapping` the points, handles and limits of `source`."""
    handles = [point.handle_type for point in source.curves[0].points]
    _write_points(mapping.curves[0], tuple(tuple(point.location) for point in source.curves[0].points), handles)
    mapping.extend, mapping.use_clip = source.extend, source.use_clip
    for name in ("clip_min_x", "clip_min_y", "clip_max_x", "clip_max_y"):
        setattr(mapping, name, getattr(source, name))
    mapping.update()


def read(mapping: bpy.types.CurveMapping) -> tuple[tuple[float, float, str], ...]:
    """Place, height and handle type of each point."""
    return tuple((*point.location, point.handle_type) for point in mapping.curves[0].points)


def write(mapping: bpy.types.CurveMapping, points: Sequence[tuple[float, float, str]]) -> None:
    """Draw the curve through at least two points, in 0..1, as `read` gives them."""
    _set_range(mapping)
    _write_points(mapping.curves[0], tuple((x, y) for x, y, _ in points), [handle for *_, handle in points])
    mapping.update()


def _set_range(mapping: bpy.types.CurveMapping) -> None:
    mapping.extend = "HORIZONTAL"
    mapping.use_clip = True
    mapping.clip_min_x, mapping.clip_min_y, mapping.clip_max_x, mapping.clip_max_y = 0.0, 0.0, 1.0, 1.0


def _fit(mapping: bpy.types.CurveMapping, table: NDArray[np.float64]) -> Points:
    peak = int(np.argmax(table))
    places = {0, peak, len(table) - 1}
    errors = _draw_through(mapping, table, places)
    while errors.max() > FIT_TOLERANCE and len(places) < MAX_POINTS:
        places.add(int(np.argmax(errors)))
        errors = _draw_through(mapping, table, places)
    for place in sorted(places - {0, peak, len(table) - 1}):
        if _draw_through(mapping, table, places - {place}).max() <= FIT_TOLERANCE:
            places.remove(place)
    return _points(table, places)


def _points(table: NDArray[np.float64], places: set[int]) -> Points:
    xs = np.linspace(0.0, 1.0, len(table))
    return tuple((float(xs[place]), float(table[place])) for place in sorted(places))


def _draw_through(mapping: bpy.types.CurveMapping, table: NDArray[np.float64], places: set[int]) -> NDArray[np.float64]:
    """Distance from the table at each of its samples, 0 at the places."""
    _write_points(mapping.curves[0], _points(table, places))
    mapping.update()
    xs = np.linspace(0.0, 1.0, len(table))
    errors = np.abs([mapping.evaluate(mapping.curves[0], float(x)) for x in xs] - table)
    for place in places:
        errors[max(place - MIN_SPACING, 0) : place + MIN_SPACING + 1] = 0.0
    return errors


def _write_points(curve: bpy.types.CurveMap, points: Points, handles: Sequence[str] | None = None) -> None:
    while len(curve.points) > max(len(points), 2):
        curve.points.remove(curve.points[1])
    while len(curve.points) < len(points):
        curve.points.new(0.5, 0.5)
    for number, (point, (x, y)) in enumerate(zip(curve.points, points, strict=True)):
        point.location = (x, y)
        point.handle_type = "AUTO_CLAMPED" if handles is None else handles[number]
