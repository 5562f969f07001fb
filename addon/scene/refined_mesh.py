"""A mesh read to be refined, and written with more faces: all that it carries goes along.

Values of vertices are mixed by Blender's own bmesh, those of corners by the caller; faces, edges and what cannot be
mixed are copied. Old vertices keep their numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import bmesh
import bpy
import numpy as np
from numpy.typing import NDArray

from . import mesh_selection

# Attributes of corners that have values between two others: what to read, and numbers to each.
_MIXED = {
    "FLOAT": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    # As stored: others would not come back as they were.
    "BYTE_COLOR": ("color_srgb", 4),
    "QUATERNION": ("value", 4),
}
_NORMALS = "custom_normal"
# What only single vertices have: those between two such ones are not such.
_SINGLE = ("crease_vert", "bevel_weight_vert")


class DoubledFaceError(ValueError):
    """Two faces have the same vertices, which bmesh does not make."""


class MeshSurface(NamedTuple):
    """N vertices, F faces, C corners, E creased edges, J creased vertices."""

    positions: NDArray[np.float32]  # (N, 3)
    face_offsets: NDArray[np.int32]  # (F + 1,)
    face_corners: NDArray[np.int32]  # (C,)
    points: NDArray[np.int32]  # (N,) the vertex that stands for each one, where several are at one place
    creased_edges: NDArray[np.int64]  # (E, 2)
    edge_creases: NDArray[np.float32]  # (E,) above 0, up to 1
    creased_vertices: NDArray[np.int64]  # (J,)
    vertex_creases: NDArray[np.float32]  # (J,)


class Level(NamedTuple):
    """New vertices of one level: first between the ends of edges, then amid the corners of faces."""

    edge_ends: NDArray[np.integer]  # (M, 2)
    centre_offsets: NDArray[np.integer]  # (P + 1,)
    centre_corners: NDArray[np.integer]  # vertices


class NewFaces(NamedTuple):
    """All faces afterwards, those that stay as they are first."""

    face_offsets: NDArray[np.integer]  # (F' + 1,)
    face_corners: NDArray[np.integer]  # (C',)
    parents: NDArray[np.integer]  # (F',) old face of each
    is_new: NDArray[np.bool_]  # (F',)
    corner_origins: NDArray[np.integer]  # (C',) an old corner of each


def read_surface(mesh: bpy.types.Mesh) -> MeshSurface:
    """Read the surface of the mesh as it is stored, without modifiers."""
    positions, offsets, corners, points = mesh_selection.read_welded(mesh)
    ends = np.empty((len(mesh.edges), 2), np.int32)
    if len(ends):
        mesh.edges.foreach_get("vertices", ends.ravel())
    of_edges, of_vertices = _read_float(mesh, "crease_edge"), _read_float(mesh, "crease_vert")
    edges, vertices = np.flatnonzero(of_edges), np.flatnonzero(of_vertices)
    creases = (ends[edges].astype(np.int64), of_edges[edges], vertices, of_vertices[vertices])
    return MeshSurface(positions.astype(np.float32), offsets, corners, points, *creases)


def read_key_positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """(K, N, 3) of all shape keys, the reference among them."""
    blocks = [] if mesh.shape_keys is None else mesh.shape_keys.key_blocks
    found = np.empty((len(blocks), len(mesh.vertices), 3), np.float32)
    for row, block in zip(found, blocks, strict=True):
        block.points.foreach_get("co", row.ravel())
    return found


def write(
    mesh: bpy.types.Mesh,
    levels: Sequence[Level],
    faces: NewFaces,
    positions: NDArray[np.floating],
    key_positions: NDArray[np.floating],
    mix_corners: Callable[[NDArray[np.floating]], NDArray[np.float64]],
) -> None:
    """positions: (N', 3), key_positions: (K, N', 3). mix_corners: makes (C', n) of (C, n).

    Raises DoubledFaceError, and the mesh is as it was.
    """
    mixed = {name: mix_corners(values) for name, values in _read_corners(mesh).items()}
    normals = mix_corners(_read_normals(mesh)) if _has_corner_normals(mesh) else None
    edited = bmesh.new()
    try:
        edited.from_mesh(mesh)
        _build(edited, levels, faces)
        edited.to_mesh(mesh)
    finally:
        edited.free()
    _clear_new(mesh, len(positions) - sum(len(level.edge_ends) + len(level.centre_offsets) - 1 for level in levels))
    mesh.attributes["position"].data.foreach_set("vector", np.ascontiguousarray(positions, np.float32).ravel())
    for row, block in zip(key_positions, () if mesh.shape_keys is None else mesh.shape_keys.key_blocks, strict=True):
        block.points.foreach_set("co", np.ascontiguousarray(row, np.float32).ravel())
    for name, values in mixed.items():
        attribute = mesh.attributes[name]
        attribute.data.foreach_set(_MIXED[attribute.data_type][0], np.ascontiguousarray(values, np.float32).ravel())
    if normals is not None:
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        mesh.normals_split_custom_set((normals / np.maximum(lengths, 1e-12)).tolist())
    mesh.update()


def _build(edited: bmesh.types.BMesh, levels: Sequence[Level], faces: NewFaces) -> None:
    vertices = list(edited.verts)
    edges, parents = list(edited.edges), list(edited.faces)
    corners = [corner for face in parents for corner in face.loops]
    by_ends = {frozenset((edge.verts[0].index, edge.verts[1].index)): edge for edge in edges}
    gone = []
    for level in levels:
        gone += _add_vertices(edited, level, vertices, by_ends)
    new = np.flatnonzero(faces.is_new)
    starts, stops = faces.face_offsets[new].tolist(), faces.face_offsets[new + 1].tolist()
    around, origins = faces.face_corners.tolist(), faces.corner_origins.tolist()
    replaced = set()
    for parent_index, start, stop in zip(faces.parents[new].tolist(), starts, stops, strict=True):
        parent = parents[parent_index]
        replaced.add(parent_index)
        try:
            face = edited.faces.new([vertices[vertex] for vertex in around[start:stop]], parent)
        except ValueError as error:
            raise DoubledFaceError from error
        for corner, origin in zip(face.loops, origins[start:stop], strict=True):
            corner.copy_from(corners[origin])
        face.hide, face.select = parent.hide, parent.select
    for index in replaced:
        edited.faces.remove(parents[index])
    for edge in gone:
        edited.edges.remove(edge)


def _add_vertices(
    edited: bmesh.types.BMesh,
    level: Level,
    vertices: list[bmesh.types.BMVert],
    by_ends: dict[frozenset[int], bmesh.types.BMEdge],
) -> list[bmesh.types.BMEdge]:
    """Extends `vertices` and `by_ends`; the edges that are split."""
    gone = []
    for first, second in level.edge_ends.tolist():
        ends = vertices[first], vertices[second]
        middle = _between(edited, ends)
        number = len(vertices)
        vertices.append(middle)
        edge = by_ends.get(frozenset((first, second)))
        if edge is None:
            # Within a face that was split before: it comes with the faces.
            continue
        gone.append(edge)
        middle.hide, middle.select = edge.hide, edge.select
        for end_number, end in ((first, ends[0]), (second, ends[1])):
            half = edited.edges.new((end, middle), edge)
            half.hide, half.select = edge.hide, edge.select
            by_ends[frozenset((end_number, number))] = half
    corners, offsets = level.centre_corners.tolist(), level.centre_offsets.tolist()
    for start, stop in pairwise(offsets):
        vertices.append(_between(edited, [vertices[corner] for corner in corners[start:stop]]))
    return gone


def _between(edited: bmesh.types.BMesh, sources: Sequence[bmesh.types.BMVert]) -> bmesh.types.BMVert:
    """A new vertex with the mean of all that these have."""
    found = edited.verts.new(sources[0].co, sources[0])
    mean = sources[0]
    for count, source in enumerate(sources[1:], 2):
        found.copy_from_vert_interp((mean, source), 1.0 / count)
        mean = found
    return found


def _read_float(mesh: bpy.types.Mesh, name: str) -> NDArray[np.float32]:
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.data_type != "FLOAT":
        return np.zeros(0, np.float32)
    found = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", found)
    return found


def _clear_new(mesh: bpy.types.Mesh, old_count: int) -> None:
    for name in _SINGLE:
        values = _read_float(mesh, name)
        if len(values) == len(mesh.vertices):
            values[old_count:] = 0.0
            mesh.attributes[name].data.foreach_set("value", values)


def _read_corners(mesh: bpy.types.Mesh) -> dict[str, NDArray[np.float32]]:
    found = {}
    for attribute in mesh.attributes:
        if attribute.domain == "CORNER" and attribute.data_type in _MIXED and len(mesh.loops):
            kind, width = _MIXED[attribute.data_type]
            values = np.empty((len(mesh.loops), width), np.float32)
            attribute.data.foreach_get(kind, values.ravel())
            found[attribute.name] = values
    return found


def _has_corner_normals(mesh: bpy.types.Mesh) -> bool:
    """Stored relative to the faces around, so they cannot be mixed as they are stored."""
    attribute = mesh.attributes.get(_NORMALS)
    return mesh.has_custom_normals and (attribute is None or attribute.data_type not in _MIXED)


def _read_normals(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    normals = np.empty((len(mesh.loops), 3), np.float32)
    mesh.corner_normals.foreach_get("vector", normals.ravel())
    return normals
