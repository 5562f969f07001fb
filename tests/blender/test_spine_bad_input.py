"""Spines that are none: the body rests, one message in the log and the panel, no exception."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from body import add_spine, body, bow, chain, curve
from measure import positions
from tube import LAST_FRAME, select, subdivide


def _check(ob: bpy.types.Object, runtime, logged, words: str) -> None:
    for frame in range(10, 14):
        bpy.context.scene.frame_set(frame)
        bpy.context.view_layer.update()
    assert words in (runtime.spine(ob.session_uid).problem or "")
    assert len([line for line in logged() if words in line]) == 1
    shown = positions(ob)
    for modifier in ob.modifiers:
        modifier.show_viewport = modifier.type != "NODES"
    bpy.context.view_layer.update()
    assert (positions(ob) == shown).all()


def _no_armature(ob, rig):
    ob.turgor_spine.rig = None


def _no_such_bone(ob, rig):
    ob.turgor_spine.first_bone = "Nothing"


def _wrong_order(ob, rig):
    ob.turgor_spine.first_bone, ob.turgor_spine.last_bone = "Bone3", "Bone1"


def _armature_before(ob, rig):
    other = bpy.data.objects.new("Other", bpy.data.armatures.new("Other"))
    ob.modifiers.new("Early", "ARMATURE").object = other
    ob.modifiers.move(1, 0)


def _moving_before(ob, rig):
    ob.modifiers.new("Waves", "WAVE")
    ob.modifiers.move(1, 0)


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (_no_armature, "No armature chosen"),
        (_no_such_bone, "no bone Nothing"),
        (_wrong_order, "does not hang on"),
        (_armature_before, "Early deforms the body before"),
        (_moving_before, "Waves can move the body"),
    ],
)
def test_a_chain_that_is_none(route, runtime, warnings_logged, harm, words):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    harm(ob, rig)
    bpy.context.view_layer.update()
    _check(ob, runtime, warnings_logged, words)


def _cyclic(spine):
    spine.data.splines[0].use_cyclic_u = True


def _collapsed(spine):
    for point in spine.data.splines[0].bezier_points:
        point.co = point.handle_left = point.handle_right = (0.0, 0.0, 0.0)


def _bent_by_lattice(spine):
    spine.modifiers.new("Lattice", "LATTICE")


def _falloff(spine):
    spine.modifiers.new("Hook", "HOOK").falloff_type = "SMOOTH"


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (_cyclic, "cyclic"),
        (_bent_by_lattice, "Lattice of Curve moves the curve"),
        (_falloff, "has a falloff"),
    ],
)
def test_a_curve_that_is_no_spine(route, runtime, warnings_logged, harm, words):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    harm(spine)
    select([ob])
    bpy.ops.object.turgor_spine_rebind()
    _check(ob, runtime, warnings_logged, words)


def test_a_curve_that_collapses(route, runtime):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    _collapsed(spine)
    bpy.context.view_layer.update()
    assert runtime.spine(ob.session_uid).problem is not None
    assert np.isfinite(positions(ob)).all()


def test_volume_is_not_added_to_a_body_without_skin(route):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    select([ob])
    with pytest.raises(RuntimeError, match="turn on its Exact Volume"):
        bpy.ops.object.turgor_volume_add()


def test_no_curve_yet(route, runtime):
    ob = body()
    select([ob])
    bpy.ops.object.turgor_spine_add()
    assert "pick" in runtime.spine(ob.session_uid).problem
    spine = curve()
    ob.turgor_spine.source, ob.turgor_spine.curve = "CURVE", spine
    bpy.context.view_layer.update()
    assert runtime.spine(ob.session_uid).problem is None
    before = positions(ob)
    bow(spine)
    assert np.abs(positions(ob) - before).max() > 0.3


def test_a_removed_curve(route, runtime):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    bow(spine)
    bpy.data.objects.remove(spine)
    bpy.context.view_layer.update()
    rest = np.array([vertex.co for vertex in ob.data.vertices], np.float32)
    assert (positions(ob) == rest).all()
    assert "curve" in runtime.spine(ob.session_uid).problem.lower()


def test_another_mesh_asks_for_rebinding(route, runtime):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    subdivide(ob)
    bpy.context.scene.frame_set(LAST_FRAME)
    assert runtime.spine(ob.session_uid).needs_rebind
    rest = np.array([vertex.co for vertex in ob.data.vertices], np.float32)
    assert (positions(ob) == rest).all()
    bpy.ops.object.turgor_spine_rebind()
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - rest).max() > 0.3


def test_a_spine_that_folds_back_is_finite(route, runtime):
    ob, rig = body(), chain(amount=0.0)
    rig.animation_data_clear()
    add_spine(ob, rig)
    for angle in (0.8, 1.6, 3.1):
        for bone in rig.pose.bones:
            bone.rotation_euler = (angle, 0.0, 0.0)
        bpy.context.view_layer.update()
        assert np.isfinite(positions(ob)).all()


def test_a_pose_that_is_not_finite(route, runtime, warnings_logged):
    ob, rig = body(), chain(amount=0.0)
    rig.animation_data_clear()
    add_spine(ob, rig)
    rest = positions(ob)
    rig.pose.bones["Bone2"].rotation_euler.x = math.nan
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - rest).max() <= 1e-6
    assert "not finite" in runtime.spine(ob.session_uid).problem
    assert len([line for line in warnings_logged() if "not finite" in line]) == 1
    rig.pose.bones["Bone2"].rotation_euler.x = 0.3
    bpy.context.view_layer.update()
    assert runtime.spine(ob.session_uid).problem is None
    assert np.abs(positions(ob) - rest).max() > 0.1


def test_a_body_scaled_to_nothing(route, runtime):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    ob.scale = (1.0, 0.0, 1.0)
    bpy.context.scene.frame_set(LAST_FRAME)
    assert "scaled to zero" in runtime.spine(ob.session_uid).problem
    assert np.isfinite(positions(ob)).all()


def test_a_body_far_from_its_spine_is_finite(route, runtime):
    ob, rig = body(), chain()
    rig.location = (50.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    add_spine(ob, rig)
    bpy.context.scene.frame_set(LAST_FRAME)
    assert np.isfinite(positions(ob)).all()
    assert runtime.spine(ob.session_uid).figures.clamped_count > 0


def test_a_mesh_without_vertices(route, runtime):
    ob, rig = body(), chain()
    ob.data.clear_geometry()
    add_spine(ob, rig)
    bpy.context.scene.frame_set(LAST_FRAME)
    assert "no vertices" in runtime.spine(ob.session_uid).problem
