"""A body bends along a curve object: every way in which a curve moves is followed."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from body import add_spine, body, bow, chain, curve
from measure import positions, volume
from test_exact import VOLUME_TOLERANCE
from tube import LENGTH, select


@pytest.mark.parametrize("kind", ["BEZIER", "NURBS", "POLY"])
def test_bends_with_its_volume(route, runtime, kind):
    ob, spine = body(), curve(kind, 5)
    rest, target = positions(ob), volume(ob)
    saved = add_spine(ob, spine)
    assert runtime.spine(ob.session_uid).problem is None
    assert np.abs(positions(ob) - rest).max() <= 1e-6
    bow(spine)
    bent = positions(ob)
    assert np.abs(bent - rest).max() > 0.2
    assert abs(volume(ob) / target - 1.0) <= VOLUME_TOLERANCE
    saved.keep_volume = False
    bpy.context.view_layer.update()
    assert abs(volume(ob) / target - 1.0) <= 5e-3


def test_a_moved_object_carries_the_body(route):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    bow(spine)
    before = positions(ob)
    spine.location = (1.0, 2.0, 3.0)
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - before - np.array([1.0, 2.0, 3.0], np.float32)).max() <= 1e-5


def test_edit_mode_is_live(route):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    before = positions(ob)
    select([spine])
    bpy.ops.object.mode_set(mode="EDIT")
    spine.data.splines[0].bezier_points[1].select_control_point = True
    bpy.ops.transform.translate(value=(0.5, 0.0, 0.0))
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - before).max() > 0.1
    bpy.ops.object.mode_set(mode="OBJECT")


def test_keyframes_shape_keys_and_hooks(route):
    ob, spine = body(), curve()
    hook = bpy.data.objects.new("Hook", None)
    bpy.context.scene.collection.objects.link(hook)
    add_spine(ob, spine)
    rest = positions(ob)
    point = spine.data.splines[0].bezier_points[2]
    for frame, x in ((1, 0.0), (10, 0.7)):
        point.co.x = x
        point.keyframe_insert("co", frame=frame)
    bpy.context.scene.frame_set(10)
    assert np.abs(positions(ob) - rest).max() > 0.3
    spine.data.animation_data_clear()
    point.co.x = 0.0
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - rest).max() <= 1e-6

    spine.shape_key_add(name="Basis")
    key = spine.shape_key_add(name="Bow")
    key.data[1].co = (0.8, 0.0, key.data[1].co.z)
    key.value = 1.0
    select([ob])
    bpy.ops.object.turgor_spine_rebind()
    key.value = 0.0
    bpy.context.view_layer.update()
    unbowed = positions(ob)
    assert np.abs(unbowed - rest).max() > 0.2
    key.value = 1.0
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - rest).max() <= 1e-5

    modifier = spine.modifiers.new("Hook", "HOOK")
    modifier.object, modifier.falloff_type = hook, "NONE"
    modifier.vertex_indices_set([6, 7, 8])
    select([ob])
    bpy.ops.object.turgor_spine_rebind()
    hook.location = (0.6, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - rest).max() > 0.2


def test_a_body_on_a_shaped_curve_is_bound_anew_and_saved(tmp_path):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    spine.shape_key_add(name="Basis")
    spine.shape_key_add(name="Bow")
    select([ob])
    for _ in range(2):
        bpy.ops.object.turgor_spine_rebind()
    assert [key.user for key in bpy.data.shape_keys] == [spine.data]
    path = str(tmp_path / "shaped.blend")
    assert bpy.ops.wm.save_as_mainfile(filepath=path) == {"FINISHED"}


def test_hooks_are_followed_as_blender_draws_them(route):
    """The control points that we read are those that Blender makes of the curve with its modifiers."""
    spine = curve()
    holder = bpy.data.objects.new("Hook", None)
    bpy.context.scene.collection.objects.link(holder)
    spine.location = (0.3, 0.2, -0.5)
    modifier = spine.modifiers.new("Hook", "HOOK")
    modifier.object, modifier.falloff_type, modifier.strength = holder, "NONE", 0.7
    modifier.vertex_indices_set([3, 4, 5, 9, 10, 11])
    holder.location, holder.rotation_euler = (0.4, 0.1, 0.2), (0.3, 0.2, 0.1)
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = spine.evaluated_get(depsgraph)
    import importlib

    read = importlib.import_module("addon.scene.spine_curve").read_posed(evaluated)
    expected = evaluated.to_curve(depsgraph, apply_modifiers=True).splines[0].bezier_points
    assert np.abs(read.points - np.array([point.co for point in expected])).max() <= 1e-6
    assert np.abs(read.left - np.array([point.handle_left for point in expected])).max() <= 1e-6
    evaluated.to_curve_clear()


def test_tilt_twists_the_body(route):
    ob, spine = body(), curve()
    saved = add_spine(ob, spine)
    saved.keep_volume = False
    for point in spine.data.splines[0].bezier_points:
        point.tilt = 0.5
    bpy.context.view_layer.update()
    top = positions(ob)[-12:]
    assert abs(abs(np.arctan2(top[0, 1], top[0, 0])) - 0.5) <= 1e-4


@pytest.mark.parametrize("slide", [0.0, 1.0, 2.5])
def test_a_body_along_its_axis_swims_on_a_path(route, runtime, slide):
    """As Blender's Curve modifier, with the body's own length and volume."""
    ob = body()
    target = volume(ob)
    spine = curve(points=4)
    for index, point in enumerate(spine.data.splines[0].bezier_points):
        point.co = (3.0 * np.sin(0.9 * index), 4.0 * index, 3.0 * np.cos(0.7 * index))
    saved = add_spine(ob, spine)
    saved.rest, saved.slide, saved.keep_volume = "Z", slide, False
    bpy.context.view_layer.update()
    assert runtime.spine(ob.session_uid).problem is None
    assert abs(volume(ob) / target - 1.0) <= 1e-3
    first = spine.data.splines[0].bezier_points[0].co
    reached = np.linalg.norm(positions(ob) - np.array(first), axis=1).min()
    assert reached <= 0.6 + slide
    assert np.ptp(positions(ob), axis=0).max() <= LENGTH + 1.0


def test_a_copy_keeps_its_own_rest(route):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    select([ob])
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    bpy.context.view_layer.update()
    assert copy.turgor_spine.bound_curve != ob.turgor_spine.bound_curve
    select([ob])
    bpy.ops.object.turgor_spine_remove()
    bow(spine)
    assert np.abs(positions(copy) - positions(ob)).max() > 0.3
    select([copy])
    bpy.ops.object.turgor_spine_remove()
    assert len(bpy.data.curves) == 1


def test_another_spine_is_followed_from_where_it_is(route, runtime):
    """Choosing another curve, or bones instead, moves nothing until that moves."""
    ob, first = body(), curve()
    rest = positions(ob)
    saved = add_spine(ob, first)
    bow(first)
    second = curve(points=6)
    second.location = (0.2, 0.1, 0.0)
    for point in second.data.splines[0].bezier_points:
        point.co.x += 0.1 * point.co.z
    bpy.context.view_layer.update()
    saved.curve = second
    bpy.context.view_layer.update()
    assert runtime.spine(ob.session_uid).problem is None
    assert np.abs(positions(ob) - rest).max() <= 1e-6
    bow(second)
    assert np.abs(positions(ob) - rest).max() > 0.1
    rig = chain()
    saved.rig, saved.first_bone, saved.last_bone, saved.source = rig, "Bone0", "Bone4", "BONES"
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - rest).max() <= 1e-6
    bpy.context.scene.frame_set(20)
    assert np.abs(positions(ob) - rest).max() > 0.1


def test_a_renamed_spine_keeps_its_rest(route):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    bow(spine)
    bent = positions(ob)
    spine.name = "Another Name"
    bpy.context.view_layer.update()
    bow(spine)
    assert np.abs(positions(ob) - bent).max() <= 1e-6


@pytest.mark.parametrize("kind", ["BEZIER", "NURBS", "POLY"])
def test_points_deleted_from_the_curve_leave_the_body_along_it(route, runtime, kind):
    """The rest has many more points than the curve has now; lengths match."""
    ob, many = body(), curve(kind, points=60)
    target = volume(ob)
    add_spine(ob, many)
    few = curve(kind, points=5)
    bow(few)
    bent = few.data.copy()
    bpy.data.objects.remove(few)
    many.data = bent
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(2)
    assert runtime.spine(ob.session_uid).problem is None
    shown = positions(ob)
    assert np.isfinite(shown).all()
    assert np.ptp(shown[:, 0]) > 1.2
    assert abs(volume(ob) / target - 1.0) <= VOLUME_TOLERANCE
