"""Measuring over frames says what each frame says, and leaves the scene alone."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import positions
from tube import LAST_FRAME, add_turgor, character, volume_modifier

FRAMES = range(1, LAST_FRAME + 1)


@pytest.fixture
def sampling(package):
    return importlib.import_module("addon.live.sampling")


def _measure(ob):
    with bpy.context.temp_override(object=ob):
        assert bpy.ops.object.turgor_volume_measure() == {"FINISHED"}


def _key(ob, path, *values):
    owner, _, name = path.rpartition(".")
    for frame, value in zip((1, LAST_FRAME), values, strict=True):
        setattr(ob.path_resolve(owner), name, value)
        ob.keyframe_insert(path, frame=frame)


def test_figures_are_those_of_the_panel_at_each_frame(route, runtime):
    ob, rig = character()
    add_turgor(ob)
    rig.scale = (2.0, 2.0, 2.0)
    _key(ob, 'turgor.joints["Bone1"].strength', 0.2, 1.0)
    _key(ob, "turgor.target_volume", 1.0, 1.3)
    ob.turgor.joints["Bone2"].preset = "MUSCLE"
    _measure(ob)
    known = runtime.character(ob.session_uid)
    motion = known.motion
    assert motion.frames.tolist() == list(FRAMES)
    for row, frame in enumerate(FRAMES):
        bpy.context.scene.frame_set(frame)
        positions(ob)
        shown = known.figures
        assert motion.corrected_deviations[row] == pytest.approx(shown.corrected_deviation, abs=1e-9)
        assert motion.skinned_deviations[row] == pytest.approx(shown.skinned_deviation, abs=1e-9)
        for column, name in enumerate(motion.joint_names):
            assert motion.joint_losses[row, column] == pytest.approx(shown.joints[name].lost, abs=1e-9)
    for column, name in enumerate(motion.joint_names):
        peak = np.abs(motion.joint_losses[:, column]).max()
        assert ob.turgor.joints[name].peak_loss == pytest.approx(peak, rel=1e-6)


def test_the_preview_range_counts_when_it_is_used(runtime):
    ob, _ = character()
    add_turgor(ob)
    scene = bpy.context.scene
    scene.use_preview_range, scene.frame_preview_start, scene.frame_preview_end = True, 3, 7
    _measure(ob)
    assert runtime.character(ob.session_uid).motion.frames.tolist() == [3, 4, 5, 6, 7]


def test_long_motions_are_the_sum_of_their_batches(runtime, sampling, monkeypatch):
    ob, _ = character()
    add_turgor(ob)
    _measure(ob)
    whole = runtime.character(ob.session_uid).motion
    monkeypatch.setattr(sampling, "BATCH", 3)
    _measure(ob)
    parts = runtime.character(ob.session_uid).motion
    assert (parts.joint_losses == whole.joint_losses).all()
    assert (parts.corrected_deviations == whole.corrected_deviations).all()
    assert parts.fold_losses == whole.fold_losses


def test_adding_measures_and_shows_the_joint_that_loses_most(route, runtime):
    ob, _ = character()
    add_turgor(ob)
    joints = ob.turgor.joints
    peaks = {joint.name: joint.peak_loss for joint in joints}
    assert min(peaks.values()) >= 0.0
    assert max(peaks.values()) > 0.1
    assert joints[ob.turgor.active_joint].name == max(peaks, key=lambda name: peaks[name])
    assert bpy.context.scene.frame_current == 1


def test_rigs_without_animation_are_tried_out(runtime):
    """Each joint is turned: all of them matter, and the frame shown does not count."""
    ob, rig = character()
    rig.animation_data_clear()
    for bone in rig.pose.bones:
        bone.rotation_euler = (0.3, 0.0, 0.0)
    add_turgor(ob)
    motion = runtime.character(ob.session_uid).motion
    assert motion.frames is None
    assert ob.turgor.joints["Bone1"].peak_loss > 0.1
    assert ob.turgor.joints["Bone2"].peak_loss > 0.1
    assert [tuple(bone.rotation_euler) for bone in rig.pose.bones] == [(pytest.approx(0.3), 0.0, 0.0)] * 3


def test_fewer_frames_where_nobody_asked(sampling, runtime):
    ob, _ = character()
    add_turgor(ob)
    frames = list(range(1, 100001))
    few = sampling.quick_frames(ob, frames)
    assert few[0] == 1
    assert few[-1] == 100000
    assert len(few) == sampling.QUICK_POSES
    steps = np.diff(few)
    assert steps.max() - steps.min() <= 1
    assert sampling.quick_frames(ob, [5]) == [5]
    assert sampling.quick_frames(ob, list(FRAMES)) == list(FRAMES)


def test_a_loss_in_the_unit_of_folding_folds_fully(runtime):
    """What is offered as `fold_loss` is the loss at which the second set is just reached, at any scale of the rig."""
    found = []
    for scale in (1.0, 0.01):
        ob, rig = character()
        rig.data.transform(__import__("mathutils").Matrix.Scale(1.0 / scale, 4))
        rig.scale = (scale,) * 3
        bpy.context.view_layer.update()
        add_turgor(ob)
        # Little is lost by what follows the law of flesh.
        ob.turgor.flesh = 0.0
        assert bpy.ops.object.turgor_volume_measure() == {"FINISHED"}
        found.append(runtime.character(ob.session_uid).motion.fold_losses)
    assert found[0].keys() == found[1].keys()
    for name, value in found[0].items():
        assert found[1][name] == pytest.approx(value, rel=1e-3, abs=1e-6)
    assert max(found[0].values()) > 0.005


def test_measuring_tells_what_is_missing(runtime):
    ob, _ = character()
    add_turgor(ob)
    ob.modifiers.remove(ob.modifiers["Armature"])
    bpy.context.view_layer.update()
    positions(ob)
    with bpy.context.temp_override(object=ob), pytest.raises(RuntimeError, match="Armature"):
        bpy.ops.object.turgor_volume_measure()
    ob.modifiers.remove(volume_modifier(ob))
    assert not bpy.ops.object.turgor_volume_measure.poll()


def test_figures_of_fleshed_characters_are_those_of_their_frames(runtime):
    ob, rig = character(rings=41)
    add_turgor(ob)
    for other in (rig, ob):
        other.select_set(True)
    bpy.context.view_layer.objects.active = ob
    assert bpy.ops.object.turgor_spine_add() == {"FINISHED"}
    _measure(ob)
    known = runtime.character(ob.session_uid)
    for row in (0, 9, 19):
        bpy.context.scene.frame_set(row + 1)
        positions(ob)
        assert known.motion.skinned_deviations[row] == pytest.approx(known.figures.skinned_deviation, abs=1e-9)
        assert known.motion.corrected_deviations[row] == pytest.approx(known.figures.corrected_deviation, abs=1e-9)
