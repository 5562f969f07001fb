"""Joints of linked and of overridden characters: what can be edited is kept, what cannot says so."""

from __future__ import annotations

import bpy
import library
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
    return library.linked((ob, rig), tmp_path)


def test_linked_joints_are_measured_and_not_edited(linked, runtime):
    ob = library.shown(linked)
    before = [joint.peak_loss for joint in ob.turgor.joints]
    with bpy.context.temp_override(object=ob):
        for name in ("copy", "mirror", "select", "reset"):
            assert not getattr(bpy.ops.object, f"turgor_joints_{name}").poll()
        assert bpy.ops.object.turgor_volume_measure() == {"FINISHED"}
    assert np.abs(runtime.character(ob.session_uid).motion.joint_losses).max() > 0.1
    assert [joint.peak_loss for joint in ob.turgor.joints] == before


def test_overridden_joints_keep_their_edits(linked, tmp_path):
    ob = library.overridden(linked)
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
    ob = library.opened_override()
    joints = ob.turgor.joints
    assert [joints[name].strength for name in SIDES] == [0.25, 0.25, 1.0]
    assert [joints[name].preset for name in SIDES] == ["MUSCLE", "MUSCLE", "FLESH"]
    assert [joint.peak_loss for joint in joints] == pytest.approx(peaks)
