"""Faults of a mesh that can be shown in Edit Mode, found on points that are welded as the engine welds them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection

import bmesh
import bpy
import numpy as np
from numpy.typing import NDArray

# Coincident: vertices within this part of the mesh's size, which are one point; the engine's own tolerance.
WELD_TOLERANCE = 1e-6
# Blender leaves vertices alone whose weights sum to less.
LEAST_SUM = 1e-4


def read_welded(
    mesh: bpy.types.Mesh,
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """Positions (N, 3), offsets of faces (F + 1,), their corners (C,), the vertex that stands for each one (N,)."""
    edited = bmesh.new()
    try:
        edited.from_mesh(mesh)
        welded = np.array(_welded(edited), np.int32)
    finally:
        edited.free()
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    offsets = np.full(len(mesh.polygons) + 1, len(mesh.loops), np.int32)
    corners = np.empty(len(mesh.loops), np.int32)
    if len(mesh.polygons):
        mesh.attributes["position"].data.foreach_get("vector", positions.ravel())
        mesh.polygons.foreach_get("loop_start", offsets[:-1])
        mesh.loops.foreach_get("vertex_index", corners)
    return positions.astype(np.float64), offsets, corners, welded


def select_edges(ob: bpy.types.Object, is_fault: Callable[[int], bool]) -> None:
    """Go to Edit Mode with the edges selected whose number of faces is a fault."""
    edited = bmesh.new()
    try:
        edited.from_mesh(ob.data)
        welded = _welded(edited)
        keys = [tuple(sorted(welded[vertex.index] for vertex in edge.verts)) for edge in edited.edges]
        users: Counter[tuple[int, ...]] = Counter()
        for key, edge in zip(keys, edited.edges, strict=True):
            users[key] += len(edge.link_faces)
        _deselect(edited)
        for key, edge in zip(keys, edited.edges, strict=True):
            if key[0] != key[-1] and is_fault(users[key]):
                edge.hide_set(False)
                edge.select_set(True)
        edited.to_mesh(ob.data)
    finally:
        edited.free()
    _edit(ob, (False, True, False))


def select_unweighted(ob: bpy.types.Object, group_names: Collection[str]) -> None:
    """Go to Edit Mode with the vertices selected that none of these groups hold."""
    groups = {group.index for group in ob.vertex_groups if group.name in group_names}
    edited = bmesh.new()
    try:
        edited.from_mesh(ob.data)
        layer = edited.verts.layers.deform.active
        _deselect(edited)
        for vertex in edited.verts:
            held = () if layer is None else vertex[layer].items()
            if sum(weight for group, weight in held if group in groups) <= LEAST_SUM:
                vertex.hide_set(False)
                vertex.select_set(True)
        edited.to_mesh(ob.data)
    finally:
        edited.free()
    _edit(ob, (True, False, False))


def turn_faces(mesh: bpy.types.Mesh, faces: NDArray[np.intp]) -> None:
    """Let these look to the other side."""
    edited = bmesh.new()
    try:
        edited.from_mesh(mesh)
        edited.faces.ensure_lookup_table()
        bmesh.ops.reverse_faces(edited, faces=[edited.faces[int(face)] for face in faces])
        edited.to_mesh(mesh)
    finally:
        edited.free()
    mesh.update()


def _welded(edited: bmesh.types.BMesh) -> list[int]:
    corners = np.array([vertex.co for vertex in edited.verts]).reshape(-1, 3)
    size = float(np.linalg.norm(np.ptp(corners, axis=0))) if len(corners) else 0.0
    coincident = bmesh.ops.find_doubles(edited, verts=edited.verts[:], dist=WELD_TOLERANCE * size)["targetmap"]
    return [coincident.get(vertex, vertex).index for vertex in edited.verts]


def _deselect(edited: bmesh.types.BMesh) -> None:
    for elements in (edited.verts, edited.edges, edited.faces):
        for element in elements:
            element.select = False


def _edit(ob: bpy.types.Object, select_mode: tuple[bool, bool, bool]) -> None:
    bpy.context.tool_settings.mesh_select_mode = select_mode
    ob.data.update()
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
