"""The mesh at rest as the Armature modifier receives it: the stack before it, evaluated apart from the scene.

A copy of the object, with a copy of its mesh, is evaluated in a scene of its own and removed again: nothing in the
artist's scene is tagged, and shape keys can be set without touching theirs.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import bmesh
import bpy
import numpy as np
from numpy.typing import NDArray

from . import shape_keys


class RestMesh(NamedTuple):
    """N vertices, F faces, C corners, W weights, K shape keys; object space."""

    positions: NDArray[np.float32]  # (N, 3)
    face_offsets: NDArray[np.int32]  # (F + 1,)
    face_corners: NDArray[np.int32]  # (C,)
    weight_offsets: NDArray[np.int32]  # (N + 1,)
    weight_groups: NDArray[np.int32]  # (W,) index of the vertex group, in the order stored per vertex
    weights: NDArray[np.float32]  # (W,)
    shape_deltas: NDArray[np.float32]  # (K, N, 3), without the reference key


class ShapeKeyTopologyError(ValueError):
    """A modifier before the Armature makes other vertices with a shape key on."""


def read_rest(ob: bpy.types.Object, end: bpy.types.Modifier | None, frame: int, *, with_keys: bool = True) -> RestMesh:
    """Modifiers before `end`, all without one, are read as they are at `frame`, shape keys at zero and at one.

    with_keys: False reads none at one.
    """
    with apart(ob, end, frame, ob.data.copy()) as (copy, view_layer):
        keys = copy.data.shape_keys
        shape_keys.set_all(keys, 0.0)
        evaluated = _evaluate(copy, view_layer)
        try:
            positions = read_positions(evaluated)
            offsets, corners = read_faces(evaluated)
            weights = read_weights(evaluated)
        finally:
            copy.evaluated_get(view_layer.depsgraph).to_mesh_clear()
        deltas = np.zeros((shape_keys.count(keys) if with_keys else 0, *positions.shape), np.float32)
        for index in range(len(deltas)):
            shape_keys.set_only(keys, index)
            shaped = read_positions(_evaluate(copy, view_layer))
            copy.evaluated_get(view_layer.depsgraph).to_mesh_clear()
            if shaped.shape != positions.shape:
                name = keys.key_blocks[index + 1].name
                raise ShapeKeyTopologyError(
                    f"Shape key {name} gives {len(shaped)} vertices before the Armature, without it there are"
                    f" {len(positions)}: move the modifier that merges vertices after Turgor Volume"
                )
            deltas[index] = shaped - positions
    return RestMesh(positions, offsets, corners, *weights, deltas)


def read_topology(
    ob: bpy.types.Object, end: bpy.types.Modifier | None, frame: int
) -> tuple[int, NDArray[np.int32], NDArray[np.int32]]:
    """Number of vertices before `end`, all modifiers without one, at `frame`; offsets and corners of its faces."""
    with apart(ob, end, frame, ob.data.copy()) as (copy, view_layer):
        evaluated = _evaluate(copy, view_layer)
        try:
            return len(evaluated.vertices), *read_faces(evaluated)
        finally:
            copy.evaluated_get(view_layer.depsgraph).to_mesh_clear()


def rest_mesh(ob: bpy.types.Object, end: bpy.types.Modifier, frame: int) -> bpy.types.Mesh:
    """A new mesh of the stack before `end` as it is at `frame`, shape keys at zero: the vertices of `read_rest`."""
    with apart(ob, end, frame, ob.data.copy()) as (copy, view_layer):
        shape_keys.set_all(copy.data.shape_keys, 0.0)
        view_layer.update()
        depsgraph = view_layer.depsgraph
        evaluated = copy.evaluated_get(depsgraph)
        return bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=depsgraph)


def read_positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """(N, 3) object space."""
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    if len(positions):
        mesh.attributes["position"].data.foreach_get("vector", positions.ravel())
    return positions


def write_positions(mesh: bpy.types.Mesh, positions: NDArray[np.floating]) -> None:
    """positions: (N, 3) object space."""
    if len(positions):
        mesh.attributes["position"].data.foreach_set("vector", np.ascontiguousarray(positions, np.float32).ravel())


@contextmanager
def apart(
    ob: bpy.types.Object, end: bpy.types.Modifier | None, frame: int, mesh: bpy.types.Mesh
) -> Iterator[tuple[bpy.types.Object, bpy.types.ViewLayer]]:
    """A copy of the object with the modifiers before `end` only, alone in a scene at `frame`.

    mesh: what the copy shows; removed with it unless somebody else uses it.
    """
    modifiers = list(ob.modifiers)
    first_removed = len(modifiers) if end is None else modifiers.index(end)
    user_render = bpy.context.scene.render
    scene = bpy.data.scenes.new("Turgor Bind")
    copy = ob.copy()
    if mesh != ob.data:
        copy.data = mesh
    try:
        scene.frame_current = frame
        scene.render.use_simplify = user_render.use_simplify
        scene.render.simplify_subdivision = user_render.simplify_subdivision
        if mesh != ob.data and mesh.shape_keys is not None:
            mesh.shape_keys.animation_data_clear()
        for modifier in list(copy.modifiers)[first_removed:]:
            remove_with_drivers(copy, modifier)
        copy.hide_viewport = False
        copy.show_only_shape_key = False
        scene.collection.objects.link(copy)
        yield copy, scene.view_layers[0]
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.objects.remove(copy)
        if mesh.users == 0:
            bpy.data.meshes.remove(mesh)


def remove_with_drivers(ob: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Nothing of the modifier is left; keyframes in actions stay, for others may use them."""
    if ob.animation_data is not None:
        prefix = f'modifiers["{bpy.utils.escape_identifier(modifier.name)}"]'
        for curve in list(ob.animation_data.drivers):
            if curve.data_path.startswith(prefix):
                ob.animation_data.drivers.remove(curve)
    ob.modifiers.remove(modifier)


def _evaluate(ob: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> bpy.types.Mesh:
    view_layer.update()
    depsgraph = view_layer.depsgraph
    return ob.evaluated_get(depsgraph).to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph)


def read_faces(mesh: bpy.types.Mesh) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Offsets per face (F + 1,) and corners (C,)."""
    offsets = np.full(len(mesh.polygons) + 1, len(mesh.loops), np.int32)
    corners = np.empty(len(mesh.loops), np.int32)
    if len(mesh.polygons):
        mesh.polygons.foreach_get("loop_start", offsets[:-1])
        mesh.loops.foreach_get("vertex_index", corners)
    return offsets, corners


def read_weights(mesh: bpy.types.Mesh) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float32]]:
    """Offsets per vertex, groups and weights, in stored order. The deform layer of a bmesh is the fastest reader."""
    edited = bmesh.new()
    try:
        edited.from_mesh(mesh)
        layer = edited.verts.layers.deform.active
        rows = [] if layer is None else [vertex[layer].items() for vertex in edited.verts]
    finally:
        edited.free()
    if not rows:
        return np.zeros(len(mesh.vertices) + 1, np.int32), np.zeros(0, np.int32), np.zeros(0, np.float32)
    offsets = np.zeros(len(rows) + 1, np.int32)
    np.cumsum([len(row) for row in rows], out=offsets[1:])
    pairs = np.array([pair for row in rows for pair in row], np.float64).reshape(-1, 2)
    return offsets, pairs[:, 0].astype(np.int32), pairs[:, 1].astype(np.float32)
