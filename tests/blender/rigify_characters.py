"""Makes characters of Blender's bundled Rigify, in a Blender of its own: that add-on cannot be turned on twice.

    python rigify_characters.py FOLDER METARIG...

writes FOLDER/METARIG.blend: a body of one closed skin around the deforming bones, weighted by distance, on the rig that
Rigify generates, without Turgor.
"""

from __future__ import annotations

import importlib
import os
import sys
from pathlib import Path

import bpy
import numpy as np

METARIGS = ("basic_human", "basic_quadruped", "bird", "cat", "horse", "human", "shark", "wolf")
# The body: as thick as this part of a bone, and voxels as large as this part of its height.
THICKNESS, VOXEL = 0.22, 1.0 / 90.0
SIDES, RINGS = 12, 8
# Weights fall with this power of the distance; the largest of a vertex are kept.
POWER, INFLUENCES = 6, 4


def generate(metarig: str) -> bpy.types.Object:
    """The rig that Rigify makes of one of its own metarigs."""
    getattr(bpy.ops.object, f"armature_{metarig}_metarig_add")()
    made = bpy.context.active_object
    assert bpy.ops.pose.rigify_generate() == {"FINISHED"}
    rig = bpy.context.active_object
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.data.objects.remove(made)
    return rig


def body(rig: bpy.types.Object) -> bpy.types.Object:
    """One closed skin around the deforming bones."""
    bones = [bone for bone in rig.data.bones if bone.use_deform]
    points, faces = [], []
    for bone in bones:
        head, tail = np.array(bone.head_local), np.array(bone.tail_local)
        _add_capsule(points, faces, head, tail, np.array(bone.matrix_local)[:3, :3])
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(np.concatenate(points).tolist(), [], faces)
    ob = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(ob)
    size = max(ob.dimensions)
    remesh = ob.modifiers.new("Remesh", "REMESH")
    remesh.mode, remesh.voxel_size = "VOXEL", VOXEL * size
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    skin = bpy.data.meshes.new_from_object(evaluated)
    ob.modifiers.clear()
    ob.data = skin
    weigh(ob, bones)
    ob.modifiers.new("Armature", "ARMATURE").object = rig
    ob.parent = rig
    return ob


def _add_capsule(
    points: list[np.ndarray],
    faces: list[tuple[int, ...]],
    head: np.ndarray,
    tail: np.ndarray,
    axes: np.ndarray,
) -> None:
    length = float(np.linalg.norm(tail - head))
    radius = THICKNESS * length
    first = sum(len(each) for each in points)
    angles = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    circle = np.outer(np.cos(angles), axes[:, 0]) + np.outer(np.sin(angles), axes[:, 2])
    for place in np.linspace(-1.0, 1.0, RINGS):
        wide = radius * np.sqrt(max(1.0 - abs(place) ** 6, 0.04))
        points.append(0.5 * (head + tail) + place * (0.5 * length + radius) * axes[:, 1] + wide * circle)
    for ring in range(RINGS - 1):
        for side in range(SIDES):
            low, high, after = first + ring * SIDES, first + (ring + 1) * SIDES, (side + 1) % SIDES
            faces.append((low + side, low + after, high + after, high + side))
    faces += [tuple(first + side for side in reversed(range(SIDES)))]
    faces += [tuple(first + (RINGS - 1) * SIDES + side for side in range(SIDES))]


def weigh(ob: bpy.types.Object, bones: list[bpy.types.Bone]) -> None:
    """By distance to the bones' segments."""
    places = np.empty(3 * len(ob.data.vertices), np.float32)
    ob.data.attributes["position"].data.foreach_get("vector", places)
    places = places.reshape(-1, 3).astype(np.float64)
    distances = np.empty((len(places), len(bones)))
    for number, bone in enumerate(bones):
        head, along = np.array(bone.head_local), np.array(bone.tail_local) - np.array(bone.head_local)
        part = np.clip((places - head) @ along / (along @ along), 0.0, 1.0)
        distances[:, number] = np.linalg.norm(places - head - part[:, None] * along, axis=1) / np.sqrt(bone.length)
    weights = (distances / distances.min(axis=1, keepdims=True)) ** -POWER
    least = np.sort(weights, axis=1)[:, -INFLUENCES - 1 : -INFLUENCES]
    weights = np.where(weights > least, weights, 0.0)
    weights /= weights.sum(axis=1, keepdims=True)
    for number, bone in enumerate(bones):
        group = ob.vertex_groups.new(name=bone.name)
        for vertex in np.flatnonzero(weights[:, number] > 1e-3).tolist():
            group.add([vertex], weights[vertex, number], "REPLACE")


def main(folder: Path, names: list[str]) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    importlib.import_module("addon_utils").enable("rigify", default_set=True)
    for name in names:
        bpy.data.batch_remove([*bpy.data.objects, *bpy.data.armatures, *bpy.data.meshes, *bpy.data.texts])
        for collection in list(bpy.context.scene.collection.children):
            bpy.context.scene.collection.children.unlink(collection)
        bpy.data.batch_remove(list(bpy.data.collections))
        body(generate(name))
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}.blend"), check_existing=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
    sys.stdout.flush()
    os._exit(0)
