"""One way of giving weights on one case: objects made, weighted, measured, bent, removed."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from time import perf_counter

import bpy
import numpy as np

from blend_fixtures import build

from ..evaluated import positions
from .cases import Case, Weights
from .motion import Strain, strain
from .shapes import Points

BLENDER, TURGOR = "Blender", "Turgor"
WAYS = (BLENDER, TURGOR)
BEND = radians(50.0)


@dataclass(frozen=True)
class Result:
    """Figures of one way."""

    seconds: float
    vertex_count: int
    unweighted_count: int
    sum_error: float
    law_holds: bool
    strain: Strain

    @property
    def is_good(self) -> bool:
        """Every vertex has weights, and what the case asks for holds; sums are the Armature modifier's affair."""
        return self.unweighted_count == 0 and self.law_holds


@dataclass(frozen=True)
class Posed:
    """For pictures: places and weights of all meshes' vertices, bent."""

    places: Points
    weights: Weights


def weigh(case: Case, way: str) -> tuple[Result, Posed]:
    """Leaves nothing in the scene."""
    meshes, rig = make(case)
    try:
        seconds = parent(meshes, rig, way)
        index = {bone.name: column for column, bone in enumerate(rig.data.bones)}
        weights = np.vstack([weights_of(mesh, index) for mesh in meshes])
        rest = np.vstack([shape.points for shape in case.meshes])
        sums = weights.sum(axis=1)
        normalised = weights / np.where(sums > 0.0, sums, 1.0)[:, None]
        bent = bend(meshes, rig)
        result = Result(
            seconds,
            len(rest),
            int((sums == 0.0).sum()),
            float(np.abs(sums[sums > 0.0] - 1.0).max(initial=0.0)),
            case.law(normalised, rest, index),
            strain(meshes, rig),
        )
        return result, Posed(bent, weights)
    finally:
        for ob in [*meshes, rig]:
            data = ob.data
            bpy.data.objects.remove(ob)
            (bpy.data.meshes if isinstance(data, bpy.types.Mesh) else bpy.data.armatures).remove(data)


def weigh_again(name: str, way: str) -> tuple[Strain, int]:
    """A character of the fixtures, alone in the file, its weights thrown away and made anew; its number of vertices."""
    bpy.ops.wm.read_homefile(use_empty=True)
    body, rig = build(name)
    rig.animation_data_clear()
    body.vertex_groups.clear()
    body.modifiers.clear()
    body.parent = None
    parent([body], rig, way)
    return strain([body], rig), len(body.data.vertices)


def make(case: Case) -> tuple[list[bpy.types.Object], bpy.types.Object]:
    """Mesh objects and the armature, in the scene."""
    collection = bpy.context.scene.collection
    meshes = []
    for number, shape in enumerate(case.meshes):
        data = bpy.data.meshes.new(f"mesh {number}")
        data.from_pydata((shape.points / np.array(case.scale)).tolist(), [], [list(face) for face in shape.faces])
        ob = bpy.data.objects.new(data.name, data)
        ob.scale = case.scale
        collection.objects.link(ob)
        meshes.append(ob)
    armature = bpy.data.armatures.new("rig")
    rig = bpy.data.objects.new("rig", armature)
    collection.objects.link(rig)
    # Blender drops bones that are shorter than it can see.
    size = max(float(np.abs([ends for bone in case.bones.values() for ends in bone]).max()), 1e-30)
    unit = 1.0 if 1e-3 < size < 1e3 else size
    rig.scale = (unit, unit, unit)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    previous = None
    for name, (head, tail) in case.bones.items():
        bone = armature.edit_bones.new(name)
        bone.head, bone.tail = np.array(head, float) / unit, np.array(tail, float) / unit
        bone.roll = 0.0
        if previous is not None and (previous.tail - bone.head).length < 1e-6:
            bone.parent = previous
        previous = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    return meshes, rig


def parent(meshes: list[bpy.types.Object], rig: bpy.types.Object, way: str, resolution: int = 0) -> float:
    """Seconds."""
    bpy.ops.object.select_all(action="DESELECT")
    for ob in [*meshes, rig]:
        ob.select_set(True)
    bpy.context.view_layer.objects.active = rig
    bpy.context.view_layer.update()
    start = perf_counter()
    if way == BLENDER:
        bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    else:
        bpy.ops.object.turgor_weights_parent(resolution=resolution)
    return perf_counter() - start


def weights_of(ob: bpy.types.Object, index: dict[str, int]) -> Weights:
    """(N, B)"""
    column = {group.index: index[group.name] for group in ob.vertex_groups if group.name in index}
    found = np.zeros((len(ob.data.vertices), len(index)))
    for vertex in ob.data.vertices:
        for element in vertex.groups:
            found[vertex.index, column[element.group]] = element.weight
    return found


def bend(meshes: list[bpy.types.Object], rig: bpy.types.Object) -> Points:
    """World places of all vertices, with every bone that has a parent bent."""
    for pose_bone in rig.pose.bones:
        pose_bone.rotation_mode = "XYZ"
        if pose_bone.parent is not None:
            pose_bone.rotation_euler = (BEND, 0.0, 0.0)
    bpy.context.view_layer.update()
    placed = []
    for ob in meshes:
        world = np.array(ob.matrix_world)
        placed.append(positions(ob) @ world[:3, :3].T + world[:3, 3])
    return np.vstack(placed)
