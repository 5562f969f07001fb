"""Drivers that name the scene: refused where they would be sampled wrong, and only there."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from tube import LAST_FRAME, add_turgor, character, skin_bones

FRAMES = (1.0, 7.5, float(LAST_FRAME))


def _driven(owner, path, index, source_path, *, by_name: bool = True) -> None:
    """By a property of the scene, by its name or as that of whatever scene is evaluated."""
    driver = owner.driver_add(path, index).driver
    variable = driver.variables.new()
    target = variable.targets[0]
    if by_name:
        target.id_type, target.id = "SCENE", bpy.context.scene
    else:
        variable.type = "CONTEXT_PROP"
    target.data_path = source_path
    driver.expression = f"0.1 * {variable.name}"


def _keyed() -> str:
    scene = bpy.context.scene
    for frame in (1, LAST_FRAME):
        scene["swing"] = float(frame)
        scene.keyframe_insert('["swing"]', frame=frame)
    return '["swing"]'


def _bone(rig):
    return rig.pose.bones["Bone1"]


def _frame(ob, rig):
    _driven(_bone(rig), "rotation_euler", 2, "frame_current")


def _key(ob, rig):
    _driven(_bone(rig), "rotation_euler", 2, _keyed())


def _driver(ob, rig):
    bpy.context.scene["swing"] = 0.0
    bpy.context.scene.driver_add('["swing"]').driver.expression = "frame"
    _driven(_bone(rig), "rotation_euler", 2, '["swing"]')


def _goal(ob, rig):
    goal = bpy.data.objects.new("Goal", None)
    _driven(goal, "rotation_euler", 0, "frame_current")
    rig.pose.bones["Bone2"].constraints.new("COPY_ROTATION").target = goal


def _strength(ob, rig):
    joint = ob.turgor.joints[1].name
    _driven(ob, f'turgor.joints["{joint}"].strength', -1, "frame_current")


@pytest.mark.parametrize(
    "prepare", [_frame, _key, _driver, _goal, _strength], ids=lambda case: case.__name__.strip("_")
)
def test_what_would_be_sampled_wrong_is_refused_and_told(package, prepare):
    ob, rig = character()
    add_turgor(ob)
    prepare(ob, rig)
    pose_samples = importlib.import_module("addon.scene.pose_samples")
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")
    check = importlib.import_module("addon.commands.check")
    with pytest.raises(ValueError, match=r"reads .* of the scene by its name.*Context Property"):
        pose_samples.sample_poses(ob, FRAMES, skin_bones(ob))
    with pytest.raises(options.BakeError, match="Active Scene"):
        job.Job(ob, options.Options("ABSOLUTE", np.array(FRAMES)))
    found = check.run(_arguments(check))
    assert "scene_driver" in {each["id"] for each in found.data["objects"][0]["findings"]}
    assert found.is_fine


def _arguments(check):
    import argparse

    parser = argparse.ArgumentParser()
    check.add_arguments(parser)
    return parser.parse_args([])


def _still(ob, rig):
    bpy.context.scene["lean"] = 3.0
    _driven(_bone(rig), "rotation_euler", 2, '["lean"]')


def _frame_of_context(ob, rig):
    _driven(_bone(rig), "rotation_euler", 2, "frame_current", by_name=False)


def _key_of_context(ob, rig):
    _driven(_bone(rig), "rotation_euler", 2, _keyed(), by_name=False)


def _color(ob, rig):
    _driven(ob, "color", 0, "frame_current")


@pytest.mark.parametrize(
    "prepare", [_still, _frame_of_context, _key_of_context, _color], ids=lambda case: case.__name__.strip("_")
)
def test_all_else_is_sampled_as_the_scene_shows_it(package, prepare):
    ob, rig = character()
    prepare(ob, rig)
    add_turgor(ob)
    pose_samples, frame = (importlib.import_module(f"addon.scene.{name}") for name in ("pose_samples", "frame"))
    samples = pose_samples.sample_poses(ob, FRAMES, skin_bones(ob))
    for sampled, number in zip(samples.pose_matrices, FRAMES, strict=True):
        bpy.context.scene.frame_set(int(number), subframe=number % 1.0)
        shown = frame.read_frame(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()), skin_bones(ob)).pose_matrices
        assert np.array_equal(sampled, shown)
