"""Joints of linked and of overridden characters: what can be edited is kept, what cannot says so."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from tube import add_turgor, character

SIDES = ("Arm.L", "Arm.R", "Hand.L")


@pytest.fixture
def linked(tmp_path):
    """The collection of a character with sides, linked into an empty file."""
    ob, rig = character()
    for bone, name in zip(rig.data.bones, SIDES, strict=True):
        bone.name = name
    add_turgor(ob)
    collection = bpy.data.collections.new("Character")
    bpy.context.scene.collection.children.link(collection)
    for member in (ob, rig):
        collection.objects.link(member)
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, into):
        into.collections = ["Character"]
    return into.collections[0]


def _mesh(objects):
    return next(member for member in objects if member.type == "MESH")


def test_linked_joints_are_measured_and_not_edited(linked, runtime):
    bpy.context.scene.collection.children.link(linked)
    bpy.context.view_layer.update()
    ob = _mesh(linked.all_objects)
    before = [joint.peak_loss for joint in ob.turgor.joints]
    with bpy.context.temp_override(object=ob):
        for name in ("copy", "mirror", "select", "reset"):
            assert not getattr(bpy.ops.object, f"turgor_joints_{name}").poll()
        assert bpy.ops.object.turgor_volume_measure() == {"FINISHED"}
    assert np.abs(runtime.character(ob.session_uid).motion.joint_losses).max() > 0.1
    assert [joint.peak_loss for joint in ob.turgor.joints] == before


def test_overridden_joints_keep_their_edits(linked, tmp_path):
    override = linked.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer, do_fully_editable=True)
    bpy.context.view_layer.update()
    ob = _mesh(override.all_objects)
    ob.turgor.joints["Arm.L"].strength = 0.25
    ob.turgor.joints["Arm.L"].preset = "MUSCLE"
    ob.turgor.active_joint = ob.turgor.joints.find("Arm.L")
    with bpy.context.temp_override(object=ob):
        assert bpy.ops.object.turgor_joints_mirror() == {"FINISHED"}
        assert bpy.ops.object.turgor_volume_measure() == {"FINISHED"}
    peaks = [joint.peak_loss for joint in ob.turgor.joints]
    path = str(tmp_path / "scene.blend")
    for _ in range(2):
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
    ob = next(member for member in bpy.context.scene.objects if member.type == "MESH" and member.override_library)
    joints = ob.turgor.joints
    assert [joints[name].strength for name in SIDES] == [0.25, 0.25, 1.0]
    assert [joints[name].preset for name in SIDES] == ["MUSCLE", "MUSCLE", "ISOTROPIC"]
    assert [joint.peak_loss for joint in joints] == pytest.approx(peaks)
