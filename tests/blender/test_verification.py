"""What a bake says of its error is its distance from the live character, however the bake came to be wrong."""

from __future__ import annotations

import importlib
import json

import bpy
import numpy as np
import pytest
from body import add_spine, body, chain
from measure import positions
from tube import LAST_FRAME, add_turgor, character, select

FRAMES = np.arange(1.0, LAST_FRAME + 1.0)
# Made of what the bake computes; driven keys are learnt from other poses.
METHODS = ["ABSOLUTE", "CORRECTIVE", "REDUCED", "POINT_CACHE"]
FINE, OFF, USAGE, FAILED = range(4)
# Of the size; float32.
EXACT = 1e-6
OFFSET = 0.01


@pytest.fixture
def bake(addon, tmp_path):
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")

    def run(ob, method, frames=FRAMES, **chosen):
        made = job.Job(ob, options.Options(method, frames, **{"folder": tmp_path, "name": "Baked"} | chosen))
        list(made.run())
        return made.baked, made.report

    return run


@pytest.fixture
def engine_off(addon, monkeypatch):
    """The bake's engine moves vertex 7 a little on some frames; the live character's does not."""
    frames = importlib.import_module("addon.bake.volume_frames").VolumeFrames
    right = frames.compute

    def compute(self, samples, positions, folds):
        right(self, samples, positions, folds)
        positions[:, 7, 0] += OFFSET

    monkeypatch.setattr(frames, "compute", compute)


@pytest.mark.parametrize("method", METHODS)
def test_a_wrong_bake_is_told(bake, engine_off, method: str):
    ob, _ = character()
    add_turgor(ob)
    _, report = bake(ob, method, tolerance=1e-3 * 4.0)
    live = max(error.max_error for error in report.live_errors)
    computed = max(error.max_error for error in report.computed_errors)
    assert live == pytest.approx(OFFSET, rel=0.5)
    assert computed < 0.5 * OFFSET
    assert report.max_error == live
    assert any("compared with the live character on 20 of 20 frames" in line for line in report.lines())


@pytest.mark.parametrize("method", ["ABSOLUTE", "POINT_CACHE", "CORRECTIVE"])
def test_a_right_bake_is_told(route, bake, method: str):
    ob, _ = character()
    add_turgor(ob)
    _, report = bake(ob, method)
    assert [error.frame for error in report.live_errors] == FRAMES.tolist()
    assert report.max_error <= EXACT * report.size
    assert abs(report.volume_error_relative) <= EXACT


@pytest.mark.parametrize("how", ["keys", "cache", "engine"])
def test_the_command_finds_a_bake_that_was_changed(addon, tmp_path, capsys, monkeypatch, request, how: str):
    command_line = importlib.import_module("addon.commands.command_line")
    ob, _ = character()
    add_turgor(ob)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    baked, method = tmp_path / "baked.blend", "point-cache" if how == "cache" else "absolute"
    if how == "engine":
        request.getfixturevalue("engine_off")
    assert command_line.main(["bake", "--method", method, "--save", str(baked), "--no-verify"]) == FINE
    monkeypatch.undo()
    bpy.ops.wm.open_mainfile(filepath=str(baked))
    if how != "engine":
        assert command_line.main(["verify"]) == FINE
        assert "with the live character on 20 of 20 frames" in capsys.readouterr().out
    if how == "keys":
        bpy.data.objects["Tube Baked"].data.shape_keys.key_blocks["Frame 5"].points[7].co.x += OFFSET
    elif how == "cache":
        path = tmp_path / "turgor_bake" / "Tube.pc2"
        content = bytearray(path.read_bytes())
        samples = np.frombuffer(content, "<f4", offset=32).reshape(LAST_FRAME, -1, 3)
        samples[4, 7, 0] += OFFSET
        path.write_bytes(content)
    figures = tmp_path / "figures.json"
    assert command_line.main(["verify", "--json", str(figures)]) == OFF
    (found,) = json.loads(figures.read_text())["objects"]
    assert found["max_error_relative"] * found["size"] == pytest.approx(OFFSET, rel=1e-3)


def test_a_sample_of_frames_has_the_ends_and_the_worst_of_joints(bake):
    ob, armature = character()
    bone = armature.pose.bones["Bone2"]
    for frame, turn in ((36, 0.0), (37, 1.9), (38, 0.0), (80, 0.0)):
        bone.rotation_euler = (turn, 0.0, 0.0)
        bone.keyframe_insert("rotation_euler", frame=frame)
    add_turgor(ob)
    _, report = bake(ob, "POINT_CACHE", np.arange(1.0, 61.0), live_frames=8)
    frames = [error.frame for error in report.live_errors]
    assert len(frames) == 8
    assert {1.0, 37.0, 60.0} <= set(frames)
    assert len(report.computed_errors) == 60
    assert any("live character on 8 of 60 frames" in line for line in report.lines())
    _, report = bake(ob, "POINT_CACHE", np.arange(1.0, 61.0), live_frames=0)
    assert len(report.live_errors) == 60


def test_the_artists_scene_stays_whatever_happens(bake, runtime, monkeypatch):
    """Frame, poses without keys, figures of the panel and handlers; also where a comparison is cancelled or fails."""
    ob, armature = character()
    add_turgor(ob)
    scene = bpy.context.scene
    scene.frame_set(9, subframe=0.25)
    armature.pose.bones["Bone1"].rotation_euler.z = 0.777
    bpy.context.view_layer.update()
    verification = importlib.import_module("addon.bake.verification")
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")
    known = runtime.character(ob.session_uid)

    def state():
        events = importlib.import_module("addon.scene.pose_samples").EVENTS
        lists = [sorted(getattr(bpy.data, name).keys()) for name in ("objects", "meshes", "scenes", "actions")]
        handlers = [len(getattr(bpy.app.handlers, event)) for event in events]
        frame = scene.frame_current, scene.frame_subframe, armature.pose.bones["Bone1"].rotation_euler.z
        return lists, handlers, frame, known.measure, positions(ob).tobytes()

    before = state()
    frames = np.arange(1.0, 121.0)
    steps = job.Job(ob, options.Options("ABSOLUTE", frames, name="Cut", live_frames=0)).run()
    while "with the live character" not in next(steps).text:
        pass
    assert state()[1:] == before[1:]
    steps.close()
    assert state() == before

    def fail(*_):
        raise ValueError("cannot be compared")

    monkeypatch.setattr(verification, "_error", fail)
    with pytest.raises(ValueError, match="cannot be compared"):
        list(job.Job(ob, options.Options("ABSOLUTE", frames, name="Cut")).run())
    assert state() == before


def test_hidden_and_switched_off_characters_are_compared(bake):
    """As they would be shown: the panel's Before, and objects that are hidden, change nothing."""
    ob, _ = character()
    add_turgor(ob)
    inputs = importlib.import_module("addon.scene.modifier_inputs")
    inputs.write_input(ob.modifiers["Turgor Volume"], "Socket_4", value=False)
    ob.hide_viewport = True
    _, report = bake(ob, "POINT_CACHE")
    assert len(report.live_errors) == LAST_FRAME
    assert report.max_error <= EXACT * report.size
    assert ob.hide_viewport
    assert not inputs.read_input(ob.modifiers["Turgor Volume"], "Socket_4")


@pytest.mark.parametrize("method", ["ABSOLUTE", "POINT_CACHE"])
def test_frames_on_which_a_character_is_hidden_are_compared(bake, engine_off, method: str):
    """Blender hands out the mesh of the frame before for what is hidden."""
    ob, _ = character()
    add_turgor(ob)
    for frame, is_hidden in ((1, False), (5, True), (9, False)):
        ob.hide_viewport = is_hidden
        ob.keyframe_insert("hide_viewport", frame=frame)
    bpy.context.scene.frame_set(1)
    _, report = bake(ob, method)
    assert max(error.max_error for error in report.computed_errors) <= EXACT * report.size
    assert [error.max_error for error in report.live_errors] == pytest.approx([OFFSET] * LAST_FRAME, rel=1e-3)


def test_repairs_that_only_the_bake_makes_are_compared(bake):
    ob, armature = character()
    for bone in armature.pose.bones:
        bone.rotation_euler = (1.9 * (bone.name != "Bone0"), 0.0, 0.0)
        bone.keyframe_insert("rotation_euler", frame=LAST_FRAME)
    add_turgor(ob)
    _, report = bake(ob, "ABSOLUTE", repair_folds=True)
    assert report.folds_found
    assert report.max_error <= EXACT * report.size
    assert not ob.turgor.repair_folds


def test_modifiers_after_are_part_of_it(bake):
    """What stands after Turgor is compared too, and left out where it makes other vertices."""
    ob, _ = character()
    add_turgor(ob)
    ob.modifiers.new("Finer", "SUBSURF").levels = 1
    ob.modifiers.new("Cloth", "CLOTH")
    _, report = bake(ob, "POINT_CACHE")
    assert len(report.live_errors) == LAST_FRAME
    assert report.max_error <= EXACT * report.size
    assert not report.notes
    ob.modifiers.new("Fewer", "DECIMATE").ratio = 0.5
    baked, _ = bake(ob, "ABSOLUTE")
    baked.modifiers["Fewer"].ratio = 0.4
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")
    made = job.Job(ob, options.Options("ABSOLUTE", FRAMES))
    list(made.verify(baked))
    assert len(made.report.live_errors) == LAST_FRAME
    assert made.report.max_error <= EXACT * made.report.size
    assert "compared without them" in made.report.notes[0]


def test_another_number_of_vertices_is_no_verification(addon, tmp_path, capsys):
    command_line = importlib.import_module("addon.commands.command_line")
    ob, _ = character()
    add_turgor(ob)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    assert command_line.main(["bake", "--save", str(tmp_path / "baked.blend")]) == FINE
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "baked.blend"))
    first = bpy.data.objects["Tube"].modifiers.new("First", "WELD")
    first.merge_threshold = 0.5
    bpy.data.objects["Tube"].modifiers.move(len(bpy.data.objects["Tube"].modifiers) - 1, 0)
    bpy.data.objects["Tube"].hide_viewport = False
    select([bpy.data.objects["Tube"]])
    bpy.ops.object.turgor_volume_rebind()
    capsys.readouterr()
    assert command_line.main(["verify"]) == FAILED
    assert "Tube Baked has 252 vertices, the live character 28: bake it again" in capsys.readouterr().err


@pytest.mark.parametrize("method", ["ABSOLUTE", "POINT_CACHE"])
def test_bodies_along_a_spine_are_compared(route, bake, method: str):
    ob = body()
    add_spine(ob, chain())
    _, report = bake(ob, method)
    assert len(report.live_errors) == LAST_FRAME
    assert report.max_error <= EXACT * report.size
