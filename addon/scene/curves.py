"""Profile curves: three Float Curve nodes per set of a joint in one hidden node tree of the character.

A node's curve runs over 0..1, which stands for x from -1 to 1 of the joint's length, or for |x| where it is symmetric.
Each node remembers what was drawn into it, so that an artist's edit is told from a preset.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from . import curve_points

# Over x in [-1, 1]; a symmetric curve has the middle one and those of one side.
SAMPLE_COUNT = 129
HALF_COUNT = SAMPLE_COUNT // 2 + 1

Table = NDArray[np.float64]
Tables = tuple[Table, Table, Table]

_NAMES = ("curve_along", "curve_sideways", "curve_inside")
# Custom properties of a node: the preset that was drawn, its points then, and what 0..1 stands for.
_PRESET, _POINTS, _IS_SYMMETRIC = "turgor_preset", "turgor_points", "turgor_is_symmetric"
CUSTOM = "CUSTOM"


def nodes(profiles: bpy.types.PropertyGroup, tree: bpy.types.NodeTree | None) -> list[bpy.types.Node] | None:
    """Along the bone, sideways, inside; None when the set has no curves."""
    if tree is None:
        return None
    found = [tree.nodes.get(getattr(profiles, name)) for name in _NAMES]
    return None if None in found else found


def shows(profiles: bpy.types.PropertyGroup, tree: bpy.types.NodeTree | None, preset: str) -> bool:
    """Whether all three curves were drawn for a preset, whatever the artist did since."""
    found = nodes(profiles, tree)
    return found is not None and all(node.get(_PRESET, CUSTOM) == preset for node in found)


def is_edited(profiles: bpy.types.PropertyGroup, tree: bpy.types.NodeTree) -> bool:
    """Whether any of the set's curves is not as it was drawn."""
    found = nodes(profiles, tree) or ()
    return any(_POINTS in node and node[_POINTS] != curve_points.digest(node.mapping) for node in found)


def claim(profiles: bpy.types.PropertyGroup, tree: bpy.types.NodeTree) -> None:
    """The set's curves are the artist's own from now on."""
    for node in nodes(profiles, tree) or ():
        node[_PRESET] = CUSTOM


def digest(profiles: bpy.types.PropertyGroup, tree: bpy.types.NodeTree) -> str:
    """Changes whenever `sample` does."""
    return "".join(curve_points.digest(node.mapping) + str(is_symmetric(node)) for node in nodes(profiles, tree))


def sample(profiles: bpy.types.PropertyGroup, tree: bpy.types.NodeTree) -> Tables:
    """(SAMPLE_COUNT,) each: along the bone, sideways, inside."""
    along, sideways, inside = (sample_node(node) for node in nodes(profiles, tree))
    return along, sideways, inside


def sample_node(node: bpy.types.Node) -> Table:
    """(SAMPLE_COUNT,) over both sides."""
    if not is_symmetric(node):
        return curve_points.sample(node.mapping, SAMPLE_COUNT)
    half = curve_points.sample(node.mapping, HALF_COUNT)
    return np.concatenate([half[:0:-1], half])


def is_symmetric(node: bpy.types.Node) -> bool:
    """Whether the node's curve is that of both sides."""
    return bool(node.get(_IS_SYMMETRIC, False))


def ensure_tree(target: bpy.types.Object) -> bpy.types.ShaderNodeTree:
    """The character's tree, made when it has none; a library override gets its own in place of a linked one."""
    saved = target.turgor
    if saved.curves is None:
        saved.curves = bpy.data.node_groups.new(f".Turgor {target.name}", "ShaderNodeTree")
    elif not is_own(saved.curves):
        saved.curves = saved.curves.copy()
    return saved.curves


def is_own(tree: bpy.types.NodeTree) -> bool:
    """Whether what is drawn into the tree is saved with this file."""
    return tree.library is None and tree.override_library is None


def write(profiles: bpy.types.PropertyGroup, tree: bpy.types.NodeTree, tables: Tables, preset: str) -> None:
    """Give the set its three nodes, drawn after the tables; one-sided ones show their mean over both sides."""
    for axis, name in enumerate(_NAMES):
        node = _own_node(profiles, tree, name)
        write_node(node, tables[axis], is_symmetric=profiles.is_symmetric[axis], preset=preset)


def write_node(node: bpy.types.Node, table: Table, *, is_symmetric: bool, preset: str) -> None:
    """Draw one curve, from (SAMPLE_COUNT,) over both sides."""
    curve_points.draw(node.mapping, folded(table)[HALF_COUNT - 1 :] if is_symmetric else table)
    node[_IS_SYMMETRIC], node[_PRESET] = is_symmetric, preset
    node[_POINTS] = curve_points.digest(node.mapping)


def copy(source: bpy.types.PropertyGroup, profiles: bpy.types.PropertyGroup) -> None:
    """Give `profiles` the curves of `source`, point by point; nothing when that has none."""
    given = nodes(source, source.id_data.turgor.curves)
    if given is None:
        return
    tree = ensure_tree(profiles.id_data)
    for name, node in zip(_NAMES, given, strict=True):
        own = _own_node(profiles, tree, name)
        curve_points.copy(node.mapping, own.mapping)
        for mark in (_PRESET, _POINTS, _IS_SYMMETRIC):
            if mark in node:
                own[mark] = node[mark]


def read_points(profiles: bpy.types.PropertyGroup) -> list[tuple[bool, tuple[tuple[float, float, str], ...]]]:
    """Whether each of the set's three curves is symmetric, and its points; empty without curves."""
    found = nodes(profiles, profiles.id_data.turgor.curves) or ()
    return [(is_symmetric(node), curve_points.read(node.mapping)) for node in found]


def write_points(
    profiles: bpy.types.PropertyGroup, shapes: Sequence[tuple[bool, Sequence[tuple[float, float, str]]]]
) -> None:
    """Give the set three curves of its own, as `read_points` tells them."""
    tree = ensure_tree(profiles.id_data)
    for name, (is_one_sided, points) in zip(_NAMES, shapes, strict=True):
        node = _own_node(profiles, tree, name)
        curve_points.write(node.mapping, points)
        node[_IS_SYMMETRIC], node[_PRESET] = is_one_sided, CUSTOM
        node[_POINTS] = curve_points.digest(node.mapping)


def folded(table: Table) -> Table:
    """The symmetric table that is nearest: the mean of both sides."""
    return 0.5 * (table + table[::-1])


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


def _own_node(profiles: bpy.types.PropertyGroup, tree: bpy.types.NodeTree, name: str) -> bpy.types.Node:
    node = tree.nodes.get(getattr(profiles, name)) or tree.nodes.new("ShaderNodeFloatCurve")
    if getattr(profiles, name) != node.name:
        setattr(profiles, name, node.name)
    return node
