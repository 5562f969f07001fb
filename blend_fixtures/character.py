"""A character: one mesh, one armature, one Armature modifier."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import bpy
import numpy as np
from mathutils import Vector

from .datablocks import data_of, of_kind, pose_of

Point = tuple[float, float, float]
LEFT: Point = (1.0, 0.0, 0.0)


class Character(NamedTuple):
    """The objects of a fixture."""

    body: bpy.types.Object
    armature: bpy.types.Object


@dataclass(frozen=True)
class Bone:
    """A deform bone in rest pose, in metres; turning about its local X bends it about `bend_axis`."""

    name: str
    head: Point
    tail: Point
    parent: str | None = None
    bend_axis: Point = LEFT


def side_name(name: str, side: int) -> str:
    """`name.L` for side 1, `name.R` for side -1."""
    return f"{name}.{'L' if side > 0 else 'R'}"


def both_sides(name: str, head: Point, tail: Point, parent: str, bend_axis: Point = LEFT) -> list[Bone]:
    """The left bone as given and its mirror image; a parent named `leg_...` is the one of the same side."""
    return [
        Bone(
            side_name(name, side),
            (side * head[0], head[1], head[2]),
            (side * tail[0], tail[1], tail[2]),
            side_name(parent, side) if parent.startswith("leg_") else parent,
            bend_axis,
        )
        for side in (1, -1)
    ]


def make_mesh(name: str, points: np.ndarray, faces: Iterable[Sequence[int]] | np.ndarray) -> bpy.types.Mesh:
    """A smooth-shaded mesh of points (N, 3) and faces."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], [tuple(int(i) for i in face) for face in faces])
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))
    mesh.update()
    return mesh


def make_armature(name: str, bones: Sequence[Bone]) -> bpy.types.Object:
    """An armature object, linked to the scene, all bones deforming, Euler angles in pose."""
    skeleton = bpy.data.armatures.new(name)
    armature = bpy.data.objects.new(name, skeleton)
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in bones:
        edit_bone = skeleton.edit_bones.new(bone.name)
        edit_bone.head, edit_bone.tail = bone.head, bone.tail
        edit_bone.align_roll(Vector(np.cross(bone.bend_axis, np.subtract(bone.tail, bone.head)).tolist()))
        if bone.parent is not None:
            parent = skeleton.edit_bones[bone.parent]
            edit_bone.parent = parent
            edit_bone.use_connect = (parent.tail - edit_bone.head).length < 1e-6
    bpy.ops.object.mode_set(mode="OBJECT")
    for pose_bone in pose_of(armature).bones:
        pose_bone.rotation_mode = "XYZ"
    return armature


def make_character(name: str, mesh: bpy.types.Mesh, bones: Sequence[Bone], weights: np.ndarray) -> Character:
    """Mesh and bones, bound by blend weights (N, bone count), rows summing to one."""
    armature = make_armature(f"{name}_rig", bones)
    armature.show_in_front = True
    data_of(armature, bpy.types.Armature).display_type = "STICK"
    body = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(body)
    body.parent = armature
    modifier = of_kind(body.modifiers.new("Armature", "ARMATURE"), bpy.types.ArmatureModifier)
    modifier.object = armature
    for bone, column in zip(bones, weights.T, strict=True):
        group = body.vertex_groups.new(name=bone.name)
        for vertex in np.flatnonzero(column):
            group.add([int(vertex)], float(column[vertex]), "REPLACE")
    bpy.context.view_layer.objects.active = body
    return Character(body, armature)
