"""The engine skins as Blender's Armature modifier does, to 1e-5 of the mesh's size."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import positions
from tube import LENGTH, add_turgor, character, set_strength

PARITY = 1e-5
FRAME = 15


def _transformed(ob, rig):
    ob.location, ob.rotation_euler, ob.scale = (1, 2, 3), (0.3, 0.5, 0.7), (1.5, 0.7, 2.0)
    rig.location, rig.rotation_euler, rig.scale = (-0.5, 0.3, 0.2), (0.1, -0.4, 0.2), (1.2, 1.2, 0.8)


def _masked(ob, rig, *, is_inverted=False):
    group = ob.vertex_groups.new(name="Mask")
    for vertex in ob.data.vertices:
        if vertex.index % 3:
            group.add([vertex.index], (vertex.index % 7) / 6, "REPLACE")
    ob.modifiers["Armature"].vertex_group = "Mask"
    ob.modifiers["Armature"].invert_vertex_group = is_inverted


def _masked_inverted(ob, rig):
    _masked(ob, rig, is_inverted=True)


def _unnormalised(ob, rig):
    ob.vertex_groups["Bone1"].add(range(200), 0.9, "ADD")
    ob.vertex_groups.new(name="Not a bone").add(range(100), 1.0, "REPLACE")
    ob.vertex_groups["Bone0"].remove(range(12))


def _scaled_bones(ob, rig):
    rig.pose.bones["Bone1"].scale = (1.4, 0.8, 1.2)


def _bone_without_deform(ob, rig):
    rig.data.bones["Bone1"].use_deform = False


def _plain(ob, rig):
    pass


@pytest.mark.parametrize("use_dual_quaternions", [False, True])
@pytest.mark.parametrize(
    "change", [_plain, _transformed, _masked, _masked_inverted, _unnormalised, _scaled_bones, _bone_without_deform]
)
def test_skinning_agrees_with_blender(runtime, change, use_dual_quaternions):
    ob, rig = character()
    ob.modifiers["Armature"].use_deform_preserve_volume = use_dual_quaternions
    change(ob, rig)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    corrected = positions(ob)
    set_strength(ob, 0.0)
    bpy.context.view_layer.update()
    blender = positions(ob)
    skinned = _engine_frame(ob, runtime)
    assert np.abs(skinned.skinned - blender).max() < PARITY * LENGTH
    assert np.abs(skinned.positions - corrected).max() < PARITY * LENGTH


def _engine_frame(ob, runtime):
    frame = importlib.import_module("addon.scene.frame")
    bound = runtime.character(ob.session_uid).binding
    inputs = frame.read_frame(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()), bound.bones)
    engine = bound.body.current_engine
    return engine.deform(inputs.pose_matrices, object_from_armature=inputs.object_from_armature)
