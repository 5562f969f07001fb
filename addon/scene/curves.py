"""Profile curves: three Float Curve nodes per joint in one hidden node tree of the character.

A node's curve runs over 0..1, which stands for x from -1 to 1 of the joint's length.
"""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

SAMPLE_COUNT = 129
# A curve gets points until it is this close to the table, in heights of the widget, but for the spacing below.
FIT_TOLERANCE = 0.01
MAX_POINTS = 48
# Samples between two points at least: closer ones are no help to an artist.
MIN_SPACING = 2

Tables = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]

_NAMES = ("curve_along", "curve_sideways", "curve_inside")


def has_curves(joint: bpy.types.PropertyGroup, tree: bpy.types.NodeTree | None) -> bool:
    """Whether the joint was Custom once."""
    return tree is not None and all(getattr(joint, name) in tree.nodes for name in _NAMES)


def sample(joint: bpy.types.PropertyGroup, tree: bpy.types.NodeTree) -> Tables:
    """(SAMPLE_COUNT,) each: along the bone, sideways, inside."""
    along, sideways, inside = (_sample_node(tree.nodes[getattr(joint, name)]) for name in _NAMES)
    return along, sideways, inside


def ensure_tree(target: bpy.types.Object) -> bpy.types.ShaderNodeTree:
    """The character's tree, made when it has none."""
    saved = target.turgor
    if saved.curves is None:
        saved.curves = bpy.data.node_groups.new(f".Turgor {target.name}", "ShaderNodeTree")
    return saved.curves


def write(joint: bpy.types.PropertyGroup, tree: bpy.types.NodeTree, tables: Tables) -> None:
    """Give the joint its three nodes, drawn after the tables."""
    for name, table in zip(_NAMES, tables, strict=True):
        node = tree.nodes.get(getattr(joint, name)) or tree.nodes.new("ShaderNodeFloatCurve")
        node.label = f"{joint.name} {name.removeprefix('curve_')}"
        setattr(joint, name, node.name)
        _fit(node.mapping, table)


def copy(source: bpy.types.PropertyGroup, profiles: bpy.types.PropertyGroup) -> None:
    """Give `profiles` the curves of `source`, point by point; nothing when that has none."""
    given = source.id_data.turgor.curves
    if not has_curves(source, given):
        return
    tree = ensure_tree(profiles.id_data)
    for name in _NAMES:
        node = tree.nodes.get(getattr(profiles, name)) or tree.nodes.new("ShaderNodeFloatCurve")
        setattr(profiles, name, node.name)
        _copy_mapping(given.nodes[getattr(source, name)].mapping, node.mapping)


def _copy_mapping(given: bpy.types.CurveMapping, mapping: bpy.types.CurveMapping) -> None:
    for name in ("extend", "clip_min_x", "clip_min_y", "clip_max_x", "clip_max_y", "use_clip"):
        setattr(mapping, name, getattr(given, name))
    points = given.curves[0].points
    _write_points(mapping.curves[0], [tuple(point.location) for point in points])
    for point, own in zip(points, mapping.curves[0].points, strict=True):
        own.handle_type = point.handle_type
    mapping.update()


def make_single_user(target: bpy.types.Object, others: list[bpy.types.Object]) -> None:
    """After Shift-D: a tree of its own for the copy."""
    tree = target.turgor.curves
    if tree is not None and any(other.turgor.curves == tree for other in others):
        target.turgor.curves = tree.copy()


def remove_tree(target: bpy.types.Object) -> None:
    """Unless another object uses it."""
    tree = target.turgor.curves
    target.turgor.curves = None
    if tree is not None and tree.library is None and tree.users == 0:
        bpy.data.node_groups.remove(tree)


def _sample_node(node: bpy.types.ShaderNodeFloatCurve) -> NDArray[np.float64]:
    mapping = node.mapping
    mapping.initialize()
    curve = mapping.curves[0]
    return np.array([max(mapping.evaluate(curve, float(x)), 0.0) for x in np.linspace(0.0, 1.0, SAMPLE_COUNT)])


def _fit(mapping: bpy.types.CurveMapping, table: NDArray[np.float64]) -> None:
    """Draw the curve through the ends and the peak, then through where it is farthest from the table.

    Points that later ones made needless are taken away again: artists drag few points better than many.
    """
    mapping.extend = "HORIZONTAL"
    mapping.use_clip = True
    mapping.clip_min_x, mapping.clip_min_y, mapping.clip_max_x, mapping.clip_max_y = 0.0, 0.0, 1.0, 1.0
    peak = int(np.argmax(table))
    places = {0, peak, len(table) - 1}
    errors = _draw_through(mapping, table, places)
    while errors.max() > FIT_TOLERANCE and len(places) < MAX_POINTS:
        places.add(int(np.argmax(errors)))
        errors = _draw_through(mapping, table, places)
    for place in sorted(places - {0, peak, len(table) - 1}):
        if _draw_through(mapping, table, places - {place}).max() <= FIT_TOLERANCE:
            places.remove(place)
    _draw_through(mapping, table, places)


def _draw_through(mapping: bpy.types.CurveMapping, table: NDArray[np.float64], places: set[int]) -> NDArray[np.float64]:
    """Distance from the table at each of its samples, 0 at the places."""
    xs = np.linspace(0.0, 1.0, len(table))
    _write_points(mapping.curves[0], [(xs[place], table[place]) for place in sorted(places)])
    mapping.update()
    errors = np.abs([mapping.evaluate(mapping.curves[0], float(x)) for x in xs] - table)
    for place in places:
        errors[max(place - MIN_SPACING, 0) : place + MIN_SPACING + 1] = 0.0
    return errors


def _write_points(curve: bpy.types.CurveMap, points: list[tuple[float, float]]) -> None:
    while len(curve.points) > 2:
        curve.points.remove(curve.points[1])
    while len(curve.points) < len(points):
        curve.points.new(0.5, 0.5)
    for point, (x, y) in zip(curve.points, points, strict=True):
        point.location = (x, y)
        point.handle_type = "AUTO_CLAMPED"
