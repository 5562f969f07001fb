"""Poses sampled apart are those of the artist's scene, and leave it as it is."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import positions
from tube import LAST_FRAME, add_turgor, character, skin_bones

COLLECTION = bpy.types.Collection
FRAMES = (1.0, 4.0, 7.5, 13.0, 12.25, float(LAST_FRAME), -3.0)


@pytest.fixture
def pose_samples(package):
    return importlib.import_module("addon.scene.pose_samples")


@pytest.fixture
def frame(package):
    return importlib.import_module("addon.scene.frame")


def _keyed(ob, **values):
    """Different at frame 1 and at the last."""
    for name, (first, last) in values.items():
        for number, value in ((1, first), (LAST_FRAME, last)):
            setattr(ob, name, value)
            ob.keyframe_insert(name, frame=number)


def _driven(owner, path, source, source_path, *index):
    driver = owner.driver_add(path, *index).driver
    variable = driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = source, source_path
    driver.expression = variable.name
    return driver


def _empty(name):
    ob = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def _moved_objects(ob, rig):
    _keyed(rig, location=((0, 0, 0), (1, 2, 3)), scale=((1, 1, 1), (2, 2, 2)))
    parent = _empty("Parent")
    _keyed(parent, rotation_euler=((0, 0, 0), (1, 2, 0.5)))
    ob.parent = parent


def _ik_and_constraints(ob, rig):
    goal, eye = _empty("Goal"), _empty("Eye")
    _keyed(goal, location=((0, 0, 4), (2, 1, 1)))
    _keyed(eye, location=((3, 0, 0), (0, 3, 5)))
    eye.parent = goal
    ik = rig.pose.bones["Bone2"].constraints.new("IK")
    ik.target, ik.chain_count = goal, 2
    rig.pose.bones["Bone0"].constraints.new("DAMPED_TRACK").target = eye
    ob.constraints.new("COPY_LOCATION").target = goal


def _drivers(ob, rig):
    goal = _empty("Goal")
    _keyed(goal, location=((0, 0, 0), (0.5, 1, 1)))
    _driven(rig.pose.bones["Bone1"], "rotation_euler", goal, "location.x", 0)
    _driven(rig.pose.bones["Bone2"], "rotation_euler", rig, 'pose.bones["Bone1"].rotation_euler[0]', 1)
    rig.pose.bones["Bone0"].driver_add("location", 2).driver.expression = "frame / 10"


def _nla(ob, rig):
    action, slot = rig.animation_data.action, rig.animation_data.action_slot
    rig.animation_data.action = None
    track = rig.animation_data.nla_tracks.new()
    strip = track.strips.new("Bend", 3, action)
    strip.action_slot = slot
    strip.scale, strip.repeat = 0.5, 2
    strip.use_animated_influence = True
    strip.influence = 0.3
    strip.keyframe_insert("influence", frame=1)
    strip.influence = 1.0
    strip.keyframe_insert("influence", frame=LAST_FRAME)


def _shape_keys(ob, rig):
    for name in ("Basis", "Wide", 'Odd "name"\\', "Quiet"):
        ob.shape_key_add(name=name)
    keys = ob.data.shape_keys.key_blocks
    for key in keys:
        key.value = 0.0
    _keyed(keys["Wide"], value=(0, 1))
    _driven(keys[2], "value", rig, 'pose.bones["Bone1"].rotation_euler[0]')
    keys["Quiet"].value, keys["Quiet"].mute = 1.0, True


def _hidden(ob, rig):
    rig.hide_viewport = True
    _moved_objects(ob, rig)


def _unkeyed(ob, rig):
    rig.animation_data_clear()
    rig.pose.bones["Bone1"].rotation_euler = (0.5, 0.2, 0.1)
    rig.location.x = 0.3


def _bendy(ob, rig):
    rig.pose.bones["Bone1"].bone.bbone_segments = 4
    _keyed(rig.pose.bones["Bone1"], bbone_curveinx=(0, 0.2))


def _plain(ob, rig):
    pass


CASES = (
    _plain,
    _moved_objects,
    _ik_and_constraints,
    _drivers,
    _nla,
    _shape_keys,
    _hidden,
    _unkeyed,
)


@pytest.mark.parametrize("is_live", [False, True], ids=["plain", "live"])
@pytest.mark.parametrize("prepare", [*CASES, _bendy], ids=lambda case: case.__name__.strip("_<>"))
def test_samples_are_the_frames_of_the_scene(pose_samples, frame, prepare, is_live):
    ob, rig = character()
    prepare(ob, rig)
    if is_live:
        add_turgor(ob)
    bones = skin_bones(ob)
    ob.hide_viewport = True
    samples = pose_samples.sample_poses(ob, FRAMES, bones)
    ob.hide_viewport = False
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert samples.frames.tolist() == list(FRAMES)
    for index, number in enumerate(FRAMES):
        bpy.context.scene.frame_set(int(np.floor(number)), subframe=number % 1.0)
        for sampled, shown in zip(samples[1:], frame.read_frame(ob.evaluated_get(depsgraph), bones), strict=True):
            assert sampled[index].shape == shown.shape
            assert (sampled[index] == shown).all()
    if prepare is not _unkeyed:
        assert any((rows != rows[0]).any() for rows in samples[1:])


def test_retimed_scenes_agree(pose_samples, frame):
    ob, _ = character()
    bpy.context.scene.render.frame_map_old, bpy.context.scene.render.frame_map_new = 100, 50
    samples = pose_samples.sample_poses(ob, [9.0], skin_bones(ob))
    bpy.context.scene.frame_set(9)
    shown = frame.read_frame(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()), skin_bones(ob))
    assert (samples.pose_matrices[0] == shown.pose_matrices).all()


def test_nothing_of_the_artist_changes(pose_samples, route):
    """Poses and values changed by hand without a key, evaluated data, handlers, data-blocks, selection."""
    ob, rig = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(6, subframe=0.25)
    rig.pose.bones["Bone1"].rotation_euler = (0.7, -0.3, 0.9)
    _keyed(ob, hide_render=(False, True))
    ob.turgor.target_volume = 1.2
    ob.turgor.keyframe_insert("target_volume", frame=1)
    ob.turgor.target_volume = 1.1
    bpy.context.view_layer.update()
    calls: list[object] = []
    bpy.app.handlers.frame_change_pre.append(lambda *_: calls.append("frame"))
    # That scenes came and went is told, but nothing is evaluated again.
    bpy.app.handlers.depsgraph_update_post.append(
        lambda _, depsgraph: calls.extend(
            update.id.name
            for update in depsgraph.updates
            if update.is_updated_transform or (update.is_updated_geometry and not isinstance(update.id, COLLECTION))
        )
    )
    handlers = {event: list(getattr(bpy.app.handlers, event)) for event in pose_samples.EVENTS}
    bones = skin_bones(ob)
    before = _state(ob, rig)
    pose_samples.sample_poses(ob, FRAMES, bones)
    assert _state(ob, rig) == before
    assert not calls
    assert {event: list(getattr(bpy.app.handlers, event)) for event in pose_samples.EVENTS} == handlers
    bpy.context.view_layer.update()
    assert _state(ob, rig) == before
    assert not calls


def _state(ob, rig):
    scene = bpy.context.scene
    shown = positions(ob).tobytes()
    blocks = [block.name_full for block in bpy.data.user_map()]
    values = [tuple(bone.rotation_euler) + tuple(v for row in bone.matrix for v in row) for bone in rig.pose.bones]
    kept = (scene.frame_current, scene.frame_subframe, ob.turgor.target_volume, ob.hide_render)
    return sorted(blocks), values, kept, shown, bpy.context.object, ob.select_get(), ob.data.users


def test_meshes_and_corrections_are_not_evaluated(pose_samples, monkeypatch):
    """No mesh is deformed for a sample: that is what makes them cheap."""
    ob, _ = character()
    add_turgor(ob)
    ticks: list[object] = []
    carrier = importlib.import_module("addon.properties.carrier")
    monkeypatch.setattr(carrier.TurgorCarrier, "on_tick", staticmethod(ticks.append))
    bones = skin_bones(ob)
    pose_samples.sample_poses(ob, FRAMES, bones)
    assert not ticks


def test_settings_are_those_of_the_frame(pose_samples):
    ob, _ = character()
    add_turgor(ob)
    _keyed(ob.turgor, target_volume=(1.0, 1.5))
    found = [evaluated.turgor.target_volume for evaluated in pose_samples.evaluated_apart(ob, FRAMES)]
    for number, value in zip(FRAMES, found, strict=True):
        bpy.context.scene.frame_set(int(np.floor(number)), subframe=number % 1.0)
        assert ob.turgor.target_volume == value


def test_an_interruption_leaves_nothing_behind(pose_samples, frame):
    ob, rig = character()
    before = _state(ob, rig)
    samples = pose_samples.evaluated_apart(ob, FRAMES)
    next(samples)
    samples.close()
    assert _state(ob, rig) == before
    bones = skin_bones(ob)
    ob.modifiers.clear()
    with pytest.raises(frame.FrameError, match="Nothing poses the mesh"):
        pose_samples.sample_poses(ob, FRAMES, bones)
