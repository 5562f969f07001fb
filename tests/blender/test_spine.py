"""A body bends along a chain of bones: at rest it rests, posed it keeps its volume, however the frame was reached."""

from __future__ import annotations

import importlib
import itertools
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import turgor
from body import add_spine, body, chain
from measure import mesh_positions, positions, volume
from test_exact import VOLUME_TOLERANCE
from tube import LAST_FRAME, select


def _problem(runtime, ob: bpy.types.Object) -> str | None:
    return runtime.spine(ob.session_uid).problem


def _at(ob: bpy.types.Object, frame: int) -> np.ndarray:
    bpy.context.scene.frame_set(frame)
    return positions(ob)


def test_nothing_moves_until_the_bones_do(route, runtime):
    ob = body()
    rest = positions(ob)
    add_spine(ob, chain())
    bpy.context.view_layer.update()
    assert _problem(runtime, ob) is None
    assert np.abs(positions(ob) - rest).max() <= 1e-6


@pytest.mark.parametrize("kind", ["RADIAL", "NORMAL", "BINORMAL", "BLEND"])
@pytest.mark.parametrize("course", ["JOINTS", "BONES"])
def test_volume_is_kept_on_every_frame(route, runtime, kind, course):
    ob = body()
    target = volume(ob)
    saved = add_spine(ob, chain(amount=0.15))
    saved.kind, saved.course, saved.bend_width = kind, course, 0.95
    for frame in range(1, LAST_FRAME + 1):
        bpy.context.scene.frame_set(frame)
        assert abs(volume(ob) / target - 1.0) <= VOLUME_TOLERANCE
    assert _problem(runtime, ob) is None
    saved.keep_volume = False
    bpy.context.view_layer.update()
    # What is left is the coarseness of the mesh alone.
    assert abs(volume(ob) / target - 1.0) <= 2e-3
    figures = runtime.spine(ob.session_uid).figures
    assert (figures.point_count, figures.clamped_count) == (len(ob.data.vertices), 0)


def test_the_mesh_is_what_the_engine_makes_of_the_joints(route):
    ob, rig = body(), chain()
    rest = positions(ob).astype(np.float64)
    saved = add_spine(ob, rig)
    saved.keep_volume = saved.use_roll = False
    found = _at(ob, LAST_FRAME)
    bones = rig.pose.bones
    before = np.array([*(bone.bone.head_local for bone in bones), bones[-1].bone.tail_local], np.float64)
    after = np.array([*(bone.head for bone in bones), bones[-1].tail], np.float64)
    spine = turgor.Spine(before, normal=np.array(bones[0].bone.matrix_local, np.float64)[:3, 0])
    posed = spine.posed(after, normal=np.array(bones[0].matrix, np.float64)[:3, 0])
    assert np.abs(found - turgor.flesh(rest, spine, posed)).max() <= 1e-5


def test_rolling_bones_twist_the_body(route):
    ob, rig = body(), chain(amount=0.0)
    rig.animation_data_clear()
    add_spine(ob, rig)
    for bone in rig.pose.bones:
        bone.rotation_euler = (0.0, 0.4, 0.0)
    bpy.context.view_layer.update()
    top = positions(ob)[-12:]
    # The bones stand along Z: each rolls a bit further than its parent, the last 5 · 0.4 in all.
    turned = np.arctan2(top[0, 1], top[0, 0])
    assert abs(turned - 5 * 0.4) <= 1e-4


def test_moving_the_armature_carries_the_body(route):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    before = _at(ob, LAST_FRAME)
    rig.location = (0.5, -1.0, 2.0)
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - before - np.array([0.5, -1.0, 2.0], np.float32)).max() <= 1e-5


def test_scale_of_the_armature_counts(route):
    """A rig at a hundred times the scale of its mesh, as importers make it."""
    ob, rig = body(), chain()
    add_spine(ob, rig)
    expected = _at(ob, LAST_FRAME)
    bpy.ops.object.turgor_spine_remove()
    select([rig])
    rig.scale = (100.0,) * 3
    bpy.ops.object.transform_apply(scale=True)
    rig.scale = (0.01,) * 3
    bpy.context.scene.frame_set(1)
    add_spine(ob, rig)
    assert np.abs(_at(ob, LAST_FRAME) - expected).max() <= 1e-4


def test_settings_are_seen_at_once(route):
    ob = body()
    saved = add_spine(ob, chain())
    shown = _at(ob, LAST_FRAME)
    for name, value in {
        "twist": 0.7,
        "twist_start": -0.4,
        "slide": 0.6,
        "kind": "BINORMAL",
        "course": "BONES",
        "bend_width": 0.9,
        "use_roll": False,
        "start": 0.25,
        "end": 0.75,
        "stretch": False,
    }.items():
        setattr(saved, name, value)
        bpy.context.view_layer.update()
        now = positions(ob)
        assert np.isfinite(now).all()
        assert name in {"bend_width", "stretch"} or np.abs(now - shown).max() > 1e-4, name
        shown = now


def test_keyframes_on_settings_count(route):
    ob = body()
    saved = add_spine(ob, chain())
    for frame, value in ((1, 0.0), (LAST_FRAME, 1.5)):
        saved.slide = value
        ob.keyframe_insert("turgor_spine.slide", frame=frame)
    slid = _at(ob, LAST_FRAME)
    ob.animation_data_clear()
    saved.slide = 0.0
    still = _at(ob, LAST_FRAME)
    assert np.abs(slid - still).max() > 0.5


def test_a_vertex_group_says_who_follows(route):
    ob = body()
    group = ob.vertex_groups.new(name="Follows")
    group.add([vertex.index for vertex in ob.data.vertices if vertex.co.z > 2.0], 1.0, "REPLACE")
    rest = positions(ob)
    saved = add_spine(ob, chain())
    saved.vertex_group, saved.keep_volume = "Follows", False
    bent = _at(ob, LAST_FRAME)
    below = rest[:, 2] <= 2.0
    assert (bent[below] == rest[below]).all()
    assert np.abs(bent[~below] - rest[~below]).max() > 0.3


def test_shape_keys_are_bent_along(route):
    """A key's bump rides on the bent body, and the volume kept is that of the body with its bump."""
    ob = body()
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Fat")
    for point, vertex in zip(key.data, ob.data.vertices, strict=True):
        point.co = (1.4 * vertex.co.x, 1.4 * vertex.co.y, vertex.co.z)
    key.value = 1.0
    target = volume(ob)
    add_spine(ob, chain())
    _at(ob, LAST_FRAME)
    assert abs(volume(ob) / target - 1.0) <= VOLUME_TOLERANCE
    key.value = 0.0
    bpy.context.view_layer.update()
    assert abs(volume(ob) / (target / 1.4**2) - 1.0) <= 1e-5


def test_frames_agree_however_they_were_reached(route, tmp_path):
    ob = body()
    add_spine(ob, chain())
    expected = _at(ob, 13)
    for frame in (1, 20, 7, 12):
        _at(ob, frame)
    assert (_at(ob, 13) == expected).all()
    path = str(tmp_path / "body.blend")
    bpy.context.scene.frame_set(5)
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert (_at(bpy.data.objects["Tube"], 13) == expected).all()


def test_halving_the_step_halves_the_motion(route):
    ob = body()
    add_spine(ob, chain())

    def largest_step(parts: int) -> float:
        shown = []
        for index in range(8 * parts + 1):
            frame = 4 + index / parts
            bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
            shown.append(positions(ob))
        return max(np.abs(b - a).max() for a, b in itertools.pairwise(shown))

    assert largest_step(4) <= 0.3 * largest_step(1)


def test_removal_leaves_nothing(route):
    ob, rig = body(), chain()
    rest = positions(ob)
    objects = set(bpy.data.objects)
    add_spine(ob, rig)
    _at(ob, LAST_FRAME)
    assert bpy.ops.object.turgor_spine_remove() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert (positions(ob) == rest).all()
    assert set(bpy.data.objects) == objects
    assert not bpy.data.node_groups
    assert not ob.modifiers
    assert ob.turgor_spine.version == 0


def test_a_copy_has_a_spine_of_its_own(route):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    select([ob])
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    bpy.context.view_layer.update()
    copy.turgor_spine.twist = 2.0
    bent, twisted = _at(ob, LAST_FRAME), positions(copy)
    assert np.abs(bent - twisted).max() > 0.1
    copy.turgor_spine.twist = 0.0
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - positions(copy)).max() == 0.0


def test_without_the_extension_the_body_rests(route, addon, tmp_path):
    ob = body()
    rest = positions(ob)
    add_spine(ob, chain())
    _at(ob, LAST_FRAME)
    path = str(tmp_path / "body.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    addon.unregister()
    try:
        bpy.ops.wm.open_mainfile(filepath=path)
        assert (_at(bpy.data.objects["Tube"], LAST_FRAME) == rest).all()
    finally:
        addon.register()


def test_undo(route):
    ob, rig = body(), chain()
    bpy.ops.ed.undo_push(message="before")
    add_spine(ob, rig)
    bpy.ops.ed.undo_push(message="added")
    expected = _at(ob, LAST_FRAME)
    bpy.ops.ed.undo_push(message="posed")
    bpy.data.objects["Tube"].turgor_spine.twist = 1.0
    bpy.ops.ed.undo_push(message="twisted")
    bpy.ops.ed.undo()
    assert (_at(bpy.data.objects["Tube"], LAST_FRAME) == expected).all()


def test_segments_of_bendy_bones_are_followed(route, runtime):
    """One bone that bends by its handles carries the body along its curve."""
    ob, rig = body(), chain(bone_count=1, amount=0.0)
    rig.animation_data_clear()
    rig.data.bones[0].bbone_segments = 8
    rest = positions(ob)
    saved = add_spine(ob, rig)
    saved.use_roll = saved.keep_volume = False
    bpy.context.view_layer.update()
    assert np.abs(positions(ob) - rest).max() <= 1e-5
    bone = rig.pose.bones[0]
    bone.bbone_curveinx = bone.bbone_curveoutx = 0.6
    bpy.context.view_layer.update()
    assert runtime.spine(ob.session_uid).problem is None
    depsgraph = bpy.context.evaluated_depsgraph_get()
    posed = rig.evaluated_get(depsgraph).pose.bones[0]
    middle = (posed.matrix @ posed.bbone_segment_matrix(4)).translation
    centres = positions(ob).reshape(-1, 12, 3).mean(axis=1)
    assert abs(middle.x) > 0.2
    assert np.linalg.norm(centres - np.array(middle), axis=1).min() <= 0.05
    assert np.abs(centres[[0, -1], :2]).max() <= 0.15


@pytest.mark.parametrize("is_deleted", [False, True], ids=["modifier removed by its X", "body deleted"])
def test_what_is_left_behind_is_swept_up(route, tmp_path, is_deleted):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    if is_deleted:
        select([ob])
        bpy.ops.object.delete()
    else:
        ob.modifiers.remove(ob.modifiers["Turgor Spine"])
    bpy.context.view_layer.update()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "swept.blend"))
    assert not [held for held in bpy.data.objects if held.turgor.carrier.mesh is not None]
    assert not [group for group in bpy.data.node_groups if group.name.startswith("Turgor")]
    assert is_deleted or ob.turgor_spine.version == 0


def test_converting_makes_the_bent_body_the_mesh(route):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    expected = _at(ob, LAST_FRAME)
    select([ob])
    bpy.ops.object.convert(target="MESH")
    assert np.abs(positions(ob) - expected).max() <= 1e-6
    assert not ob.modifiers


def test_two_evaluations_see_their_own_frame():
    """With pull a second scene at another frame has its own offsets."""
    ob, rig = body(), chain()
    add_spine(ob, rig)
    early, late = _at(ob, 5), _at(ob, LAST_FRAME)
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(ob)
    other.collection.objects.link(rig)
    other.frame_set(5)
    shown = mesh_positions(ob.evaluated_get(other.view_layers[0].depsgraph).data)
    assert np.abs(early - late).max() > 0.1
    assert (shown == early).all()
    assert (positions(ob) == late).all()


def test_the_overlay_follows_the_body_and_not_its_name(runtime):
    """Renamed, with another body under its old name: each obeys its own switch."""
    overlay = importlib.import_module("addon.overlays.spine")
    ob, rig = body(), chain()
    add_spine(ob, rig).show_overlay = True
    _at(ob, 3)
    state = runtime.spine(ob.session_uid)
    old_name, ob.name = ob.name, "Renamed"
    other = bpy.data.objects.new(old_name, ob.data.copy())
    bpy.context.scene.collection.objects.link(other)
    assert (state.name, other.name) == (old_name, old_name)
    overlays = SimpleNamespace(overlay=SimpleNamespace(show_overlays=True))
    context = SimpleNamespace(space_data=overlays, view_layer=bpy.context.view_layer)
    assert list(overlay.shown(context)) == [state]
    ob.turgor_spine.show_overlay = False
    other.turgor_spine.show_overlay = True
    assert not list(overlay.shown(context))
    overlays.overlay.show_overlays = False
    assert not list(overlay.shown(context))
