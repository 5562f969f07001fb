"""Meshes that get weights, and the bones they get them from: read in world space, written as vertex groups."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import bmesh
import bpy
import numpy as np
from mathutils.kdtree import KDTree
from numpy.typing import NDArray

from . import rest, shape_keys

# Vertices this part of the body's size apart are at the same place.
SAME_VERTEX = 1e-5
# Bones with ends closer than this part of their length lie in the same place.
SAME_PLACE = 1e-4


class Faces(NamedTuple):
    """A surface in world space."""

    positions: NDArray[np.float64]  # (N, 3)
    face_offsets: NDArray[np.int32]  # (F + 1,)
    face_corners: NDArray[np.int32]  # (C,)


class Target(NamedTuple):
    """One mesh. The body is what its modifiers make of it, None where that has the same vertices."""

    surface: Faces
    body: Faces | None
    body_vertices: NDArray[np.int32]  # (N,) vertex of the body at the same place, -1 where none is
    group_names: tuple[str, ...]
    locked_names: frozenset[str]
    weight_offsets: NDArray[np.int32]  # (N + 1,)
    weight_groups: NDArray[np.int32]  # (W,)
    weights: NDArray[np.float32]  # (W,)
    is_selected: NDArray[np.bool_]  # (N,)


def read_target(ob: bpy.types.Object) -> Target:
    """The mesh with shape keys at rest, as the Armature modifier gets it."""
    mesh = ob.data
    surface, body = _surfaces(ob)
    is_selected = np.ones(len(mesh.vertices), bool)
    if mesh.use_paint_mask_vertex and ob.mode == "WEIGHT_PAINT":
        mesh.vertices.foreach_get("select", is_selected)
    return Target(
        surface,
        body,
        _same_vertices(surface, body),
        tuple(ob.vertex_groups.keys()),
        frozenset(group.name for group in ob.vertex_groups if group.lock_weight),
        *(rest.read_weights(mesh) if ob.vertex_groups else _no_weights(mesh)),
        is_selected,
    )


def read_bone_ends(rig: bpy.types.Object, names: Sequence[str]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Heads and tails (B, 3) at rest, world space."""
    bones = rig.data.bones
    heads, tails = (
        np.array([getattr(bones[name], end) for name in names], np.float64).reshape(-1, 3)
        for end in ("head_local", "tail_local")
    )
    return _in_world(rig, heads), _in_world(rig, tails)


def read_parents(rig: bpy.types.Object, names: Sequence[str]) -> NDArray[np.int32]:
    """(B,) the nearest ancestor among the named bones, -1 for none.

    Control rigs parent deform bones to others that do not deform but lie in the same place as one that does.
    """
    bones = rig.data.bones
    index = {name: number for number, name in enumerate(names)}
    ends = np.array([_ends(bones[name]) for name in names]).reshape(-1, 6)

    def standing_for(ancestor: bpy.types.Bone) -> int:
        if ancestor.name in index:
            return index[ancestor.name]
        distances = np.abs(ends - _ends(ancestor)).max(axis=1, initial=0.0)
        nearest = int(distances.argmin())
        return nearest if distances[nearest] <= SAME_PLACE * ancestor.length else -1

    def parent(name: str) -> int:
        found = (standing_for(ancestor) for ancestor in bones[name].parent_recursive)
        return next((number for number in found if number not in (-1, index[name])), -1)

    return np.array([parent(name) for name in names], np.int32)


def _ends(bone: bpy.types.Bone) -> NDArray[np.float64]:
    """(6,)"""
    return np.array([*bone.head_local, *bone.tail_local], np.float64)


def read_stiffness(rig: bpy.types.Object, names: Sequence[str]) -> NDArray[np.float64]:
    """(B,) how strongly bones hold the skin, 1 unless the artist says otherwise."""
    return np.array([rig.data.bones[name].turgor_stiffness for name in names], np.float64)


def deform_bone_names(rig: bpy.types.Object) -> tuple[str, ...]:
    return tuple(bone.name for bone in rig.data.bones if bone.use_deform)


def selected_bone_names(rig: bpy.types.Object) -> set[str]:
    """Names of the selected bones; from Blender 5.0 on each pose of an armature has its own selection."""
    return {
        pose_bone.name
        for pose_bone in rig.pose.bones
        if (pose_bone.select if hasattr(pose_bone, "select") else pose_bone.bone.select)
    }


def mirror_plane(rig: bpy.types.Object) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Point and normal, in world space, of the plane between left and right of an armature."""
    world = np.array(rig.matrix_world, np.float64)
    y, z = world[:3, 1], world[:3, 2]
    return world[:3, 3], np.cross(y, z)


def mirrored_bones(names: Sequence[str]) -> NDArray[np.int32]:
    """(B,) the bone of the other side, itself for one in the middle, -1 where there is none."""
    index = {name: number for number, name in enumerate(names)}
    return np.array([index.get(bpy.utils.flip_name(name), -1) for name in names], np.int32)


def write_weights(
    ob: bpy.types.Object,
    names: Sequence[str],
    rows: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float32]],
) -> None:
    """Replaces the weights of these bones on vertices that have a row: offsets (N + 1,), bones (W,), weights (W,).

    A bmesh is the fastest writer; locks, other groups and vertices without a row stay as they are.
    """
    offsets, bones, weights = rows
    used = set(np.unique(bones).tolist())
    groups = _groups(ob, [name for bone, name in enumerate(names) if bone in used])
    replaced = {group.index for name in names if (group := ob.vertex_groups.get(name)) is not None}
    index = np.array([groups.get(name, -1) for name in names], np.int64)
    new_groups, new_weights = index[bones].tolist(), weights.tolist()
    edited = bmesh.new()
    try:
        edited.from_mesh(ob.data)
        layer = edited.verts.layers.deform.verify()
        for vertex, start, stop in zip(edited.verts, offsets[:-1].tolist(), offsets[1:].tolist(), strict=True):
            if start == stop:
                continue
            held = vertex[layer]
            kept = [pair for pair in held.items() if pair[0] not in replaced]
            held.clear()
            for group, weight in kept:
                held[group] = weight
            for place in range(start, stop):
                held[new_groups[place]] = new_weights[place]
        edited.to_mesh(ob.data)
    finally:
        edited.free()
    ob.data.update()


def _no_weights(mesh: bpy.types.Mesh) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float32]]:
    return np.zeros(len(mesh.vertices) + 1, np.int32), np.zeros(0, np.int32), np.zeros(0, np.float32)


def _groups(ob: bpy.types.Object, names: Sequence[str]) -> Mapping[str, int]:
    """Index of the group of each name, made where there is none."""
    active = ob.vertex_groups.active_index
    found = {name: ob.vertex_groups.get(name) or ob.vertex_groups.new(name=name) for name in names}
    ob.vertex_groups.active_index = max(active, 0)
    return {name: group.index for name, group in found.items()}


def _surfaces(ob: bpy.types.Object) -> tuple[Faces, Faces | None]:
    plain = _faces(ob, ob.data)
    end = next((modifier for modifier in ob.modifiers if modifier.type == "ARMATURE"), None)
    before = list(ob.modifiers)[: None if end is None else list(ob.modifiers).index(end)]
    if not any(modifier.show_viewport for modifier in before):
        return plain, None
    with rest.apart(ob, end, bpy.context.scene.frame_current, ob.data.copy()) as (copy, view_layer):
        shape_keys.set_all(copy.data.shape_keys, 0.0)
        view_layer.update()
        made = _faces(ob, copy.evaluated_get(view_layer.depsgraph).data)
    if len(made.positions) != len(plain.positions) or not np.array_equal(made.face_corners, plain.face_corners):
        return plain, made
    return made, None


def _same_vertices(surface: Faces, body: Faces | None) -> NDArray[np.int32]:
    if body is None or not len(body.positions):
        return np.full(len(surface.positions), -1, np.int32)
    tree = KDTree(len(body.positions))
    for vertex, place in enumerate(body.positions.tolist()):
        tree.insert(place, vertex)
    tree.balance()
    nearest = np.array([tree.find(place)[1] for place in surface.positions.tolist()], np.int32)
    size = float(np.linalg.norm(np.ptp(body.positions, axis=0)))
    far = np.linalg.norm(surface.positions - body.positions[nearest], axis=1)
    return np.where(far <= SAME_VERTEX * size, nearest, np.int32(-1))


def _faces(ob: bpy.types.Object, mesh: bpy.types.Mesh) -> Faces:
    keys = mesh.shape_keys
    positions = rest.read_positions(mesh)
    if keys is not None and len(positions) == len(mesh.vertices):
        # What is shown may be another key.
        keys.reference_key.data.foreach_get("co", positions.ravel())
    return Faces(_in_world(ob, positions.astype(np.float64)), *rest.read_faces(mesh))


def _in_world(ob: bpy.types.Object, points: NDArray[np.float64]) -> NDArray[np.float64]:
    world = np.array(ob.matrix_world, np.float64)
    return points @ world[:3, :3].T + world[:3, 3]
