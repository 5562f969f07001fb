"""Bendy bones, envelopes and Envelope Multiply: skinned as Blender does, with the exact volume, by names that last."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import positions, relative_error, volume
from tube import LENGTH, add_turgor, place, rig, select, set_strength, tube_mesh

PARITY = 1e-5
VOLUME_TOLERANCE = 1e-6
SEEDS = range(6)


def _frame_of(ob, runtime):
    """What the engine makes of the frame that Blender shows now."""
    frame = importlib.import_module("addon.live.frame")
    character = runtime.character(ob.session_uid)
    asked = frame.read(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()), character, character.binding)
    return asked.engine.deform(asked.pose_matrices, **asked.options)


def _check(ob, runtime):
    """Skin as Blender's, evaluated mesh as the engine's, and the target volume to rounding."""
    bpy.context.view_layer.update()
    assert runtime.character(ob.session_uid).problem is None
    corrected = positions(ob)
    found = _frame_of(ob, runtime)
    assert relative_error(ob, float(found.report.target_volumes.sum())) < VOLUME_TOLERANCE
    set_strength(ob, 0.0)
    bpy.context.view_layer.update()
    assert np.abs(found.skinned - positions(ob)).max() < PARITY * LENGTH
    assert np.abs(found.positions - corrected).max() < PARITY * LENGTH
    set_strength(ob, 1.0)
    return found


def _random_bends(armature: bpy.types.Object, random: np.random.Generator) -> None:
    """Every setting of bendy bones, at rest."""
    bones = armature.data.bones
    for bone in bones:
        bone.bbone_segments = int(random.integers(1, 12))
        bone.bbone_mapping_mode = str(random.choice(["STRAIGHT", "CURVED"]))
        for name in ("curveinx", "curveinz", "curveoutx", "curveoutz", "rollin", "rollout"):
            setattr(bone, f"bbone_{name}", float(random.normal(scale=0.2)) if random.random() < 0.4 else 0.0)
        bone.bbone_easein, bone.bbone_easeout = random.uniform(0.2, 1.8, 2).tolist()
        for end in ("start", "end"):
            kind = str(random.choice(["AUTO", "ABSOLUTE", "RELATIVE", "TANGENT"]))
            setattr(bone, f"bbone_handle_type_{end}", kind)
            handle = bones[int(random.integers(len(bones)))]
            if kind != "AUTO" and handle != bone and random.random() < 0.8:
                setattr(bone, f"bbone_custom_handle_{end}", handle)
            setattr(bone, f"bbone_handle_use_scale_{end}", (random.random(3) < 0.4).tolist())
            setattr(bone, f"bbone_handle_use_ease_{end}", bool(random.random() < 0.4))
        bone.use_endroll_as_inroll = bool(random.random() < 0.3)
        bone.use_scale_easing = bool(random.random() < 0.3)
        if random.random() < 0.3:
            bone.bbone_scalein, bone.bbone_scaleout = random.uniform(0.8, 1.25, (2, 3)).tolist()


def _random_pose(armature: bpy.types.Object, random: np.random.Generator, *, with_scale: bool = True) -> None:
    for bone in armature.pose.bones:
        bone.rotation_euler = random.normal(scale=0.4, size=3)
        if with_scale and random.random() < 0.4:
            bone.scale = random.uniform(0.85, 1.2, 3)
        for name in ("curveinx", "curveinz", "curveoutx", "curveoutz", "rollin", "rollout"):
            setattr(bone, f"bbone_{name}", float(random.normal(scale=0.2)) if random.random() < 0.4 else 0.0)
        bone.bbone_easein, bone.bbone_easeout = random.uniform(-0.4, 0.6, 2).tolist()
        if with_scale and random.random() < 0.4:
            bone.bbone_scalein, bone.bbone_scaleout = random.uniform(0.85, 1.2, (2, 3)).tolist()


def _random_envelopes(ob: bpy.types.Object, armature: bpy.types.Object, random: np.random.Generator) -> None:
    for bone in armature.data.bones:
        bone.head_radius, bone.tail_radius = random.uniform(0.3, 0.7, 2).tolist()
        bone.envelope_distance, bone.envelope_weight = random.uniform(0.3, 1.0, 2).tolist()
        bone.use_envelope_multiply = bool(random.random() < 0.5)
    modifier = ob.modifiers["Armature"]
    modifier.use_bone_envelopes = bool(random.random() < 0.7)
    modifier.use_vertex_groups = not modifier.use_bone_envelopes or bool(random.random() < 0.6)
    if modifier.use_vertex_groups and modifier.use_bone_envelopes:
        free = np.flatnonzero(random.random(len(ob.data.vertices)) < 0.3).tolist()
        for group in ob.vertex_groups:
            group.remove(free)


def _bent_rest(bone_count: int, random: np.random.Generator) -> bpy.types.Object:
    """A chain that is not straight, of rolled bones, not all connected."""
    armature = rig(bone_count=bone_count)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in armature.data.edit_bones:
        bone.use_connect = bone.use_connect and random.random() < 0.7
        bone.roll = float(random.normal())
        bone.tail.x += float(random.normal(scale=0.1))
    bpy.ops.object.mode_set(mode="OBJECT")
    return armature


@pytest.mark.parametrize("use_dual_quaternions", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_skin_and_volume_are_exact_whatever_bends(runtime, seed, use_dual_quaternions):
    random = np.random.default_rng(seed)
    armature = _bent_rest(4, random)
    ob = place("Tube", tube_mesh(rings=41), armature)
    ob.modifiers["Armature"].use_deform_preserve_volume = use_dual_quaternions
    _random_bends(armature, random)
    if seed % 2:
        ob.location, ob.rotation_euler, ob.scale = (1, 2, 3), (0.3, 0.5, 0.7), (1.5, 0.7, 2.0)
    if seed % 3 == 0:
        _random_envelopes(ob, armature, random)
    bpy.context.view_layer.update()
    add_turgor(ob)
    for _ in range(3):
        _random_pose(armature, random)
        _check(ob, runtime)


@pytest.mark.parametrize("use_dual_quaternions", [False, True])
def test_bending_alone_keeps_the_volume_of_rest(runtime, use_dual_quaternions):
    """Where segments stand to each other is no intent: without scale the target is the rest volume."""
    armature = rig(bone_count=3)
    ob = place("Tube", tube_mesh(rings=41), armature)
    ob.modifiers["Armature"].use_deform_preserve_volume = use_dual_quaternions
    for bone in armature.data.bones:
        bone.bbone_segments = 8
    rest = volume(ob)
    add_turgor(ob)
    random = np.random.default_rng(1)
    for _ in range(4):
        _random_pose(armature, random, with_scale=False)
        _check(ob, runtime)
        assert relative_error(ob, rest) < VOLUME_TOLERANCE


def _bendy_tube(segments: int = 6) -> tuple[bpy.types.Object, bpy.types.Object]:
    armature = rig(bone_count=3)
    for bone in armature.data.bones:
        bone.bbone_segments = segments
    return place("Tube", tube_mesh(rings=41), armature), armature


def _add_key(ob: bpy.types.Object, axis: int, name: str = "Slide") -> None:
    """A key that moves a ring amid the second bone along or across the tube."""
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name=name)
    for point in key.data:
        if 1.8 < point.co.z < 2.2:
            point.co[axis] += 0.2 if axis == 2 else 0.2 * point.co[axis]
    key.value = 0.0


def _found(ob, runtime, name: str):
    return next((found for found in runtime.character(ob.session_uid).findings if found.id == name), None)


def test_keys_that_slide_skin_along_bendy_bones_are_read_as_evaluated(runtime):
    ob, armature = _bendy_tube()
    _add_key(ob, axis=2)
    add_turgor(ob)
    found = _found(ob, runtime, "evaluated")
    assert "Shape key Slide" in found.text
    for value, seed in ((0.0, 2), (0.7, 3), (-0.4, 4)):
        ob.data.shape_keys.key_blocks["Slide"].slider_min = -1.0
        ob.data.shape_keys.key_blocks["Slide"].value = value
        _random_pose(armature, np.random.default_rng(seed))
        _check(ob, runtime)


def test_keys_across_bendy_bones_keep_their_weights(runtime):
    ob, armature = _bendy_tube()
    _add_key(ob, axis=0)
    add_turgor(ob)
    ob.data.shape_keys.key_blocks["Slide"].value = 0.7
    _random_pose(armature, np.random.default_rng(3))
    _check(ob, runtime)


def test_keys_through_an_envelope_are_read_as_evaluated(runtime):
    ob, armature = _bendy_tube(segments=1)
    _add_key(ob, axis=0)
    bone = armature.data.bones["Bone1"]
    bone.use_envelope_multiply, bone.envelope_distance = True, 1.0
    bone.head_radius = bone.tail_radius = 0.2
    add_turgor(ob)
    assert "Shape key Slide" in _found(ob, runtime, "evaluated").text
    ob.data.shape_keys.key_blocks["Slide"].value = 0.6
    _random_pose(armature, np.random.default_rng(5))
    _check(ob, runtime)


def test_a_mesh_moved_along_its_bendy_bones_is_read_as_evaluated(runtime, route):
    ob, armature = _bendy_tube()
    _random_pose(armature, np.random.default_rng(4))
    add_turgor(ob)
    _check(ob, runtime)
    assert _found(ob, runtime, "evaluated") is None
    for height in (0.3, -0.2):
        ob.location.z = height
        # Push lags by one evaluation where Blender evaluates the stack.
        for _ in range(3 if route == "PUSH" else 1):
            ob.update_tag()
            bpy.context.view_layer.update()
        _check(ob, runtime)
        assert "may stand elsewhere" in _found(ob, runtime, "evaluated").text
    ob.location.z = 0.0
    _check(ob, runtime)
    bpy.ops.object.turgor_volume_rebind()
    assert _found(ob, runtime, "evaluated") is None
    # Both together move no weight, however far.
    ob.location = armature.location = (70.0, -300.0, 4.0)
    bpy.context.view_layer.update()
    positions(ob)
    assert runtime.character(ob.session_uid).problem is None
    assert _found(ob, runtime, "evaluated") is None


def test_a_mesh_that_slides_along_its_bendy_bones_is_read_as_evaluated(runtime):
    """Keyed: whatever frame it is bound at, in renders too. Parented to its armature it stands still."""
    ob, armature = _bendy_tube()
    _random_pose(armature, np.random.default_rng(4))
    armature.keyframe_insert("location", frame=1)
    ob.parent = armature
    add_turgor(ob)
    assert _found(ob, runtime, "evaluated") is None
    bpy.ops.object.turgor_volume_remove()
    for frame, height in ((1, 0.0), (20, 0.4)):
        ob.location.z = height
        ob.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    add_turgor(ob)
    assert "may stand elsewhere" in _found(ob, runtime, "evaluated").text
    for frame in (1, 9, 20):
        bpy.context.scene.frame_set(frame)
        _check(ob, runtime)


def test_ease_that_drivers_move_splits_scale_as_blender_does(runtime):
    """By dual quaternions scale is split off along axes at rest, which ease turns where the rest curve is no line."""
    ob, armature = _bendy_tube()
    ob.modifiers["Armature"].use_deform_preserve_volume = True
    for bone in armature.data.bones:
        bone.bbone_curveinx, bone.bbone_curveoutz = 0.4, -0.3
    ob["ease"] = 1.0
    for end in ("bbone_easein", "bbone_easeout"):
        driver = armature.data.driver_add(f'bones["Bone1"].{end}').driver
        driver.type = "AVERAGE"
        variable = driver.variables.new()
        variable.targets[0].id, variable.targets[0].data_path = ob, '["ease"]'
    add_turgor(ob)
    assert "Preserve Volume" in _found(ob, runtime, "evaluated").text
    for seed, ease in ((1, 0.0), (2, 0.5), (3, 2.0)):
        ob["ease"] = ease
        ob.update_tag()
        _random_pose(armature, np.random.default_rng(seed))
        armature.pose.bones["Bone1"].scale = (0.7, 1.3, 1.1)
        _check(ob, runtime)


def test_the_bend_of_a_bone_is_one_joint_of_its_own(runtime):
    names = importlib.import_module("addon.properties.joint_names")
    ob, armature = _bendy_tube()
    armature.pose.bones["Bone1"].rotation_euler = (0.9, 1.4, 0.2)
    armature.pose.bones["Bone2"].rotation_euler = (0.7, 0.9, 0.0)
    add_turgor(ob)
    bend = names.bend_of("Bone1")
    assert {joint.name for joint in ob.turgor.joints} >= {"Bone1", bend}
    bpy.context.view_layer.update()
    whole = _frame_of(ob, runtime).report
    figures = runtime.character(ob.session_uid).figures.joints
    assert set(figures) == {joint.name for joint in ob.turgor.joints}
    percent = 100.0 / runtime.character(ob.session_uid).binding.body.rest_volume
    assert sum(joint.lost for joint in figures.values()) == pytest.approx(whole.joint_losses.sum() * percent, abs=1e-9)
    # Its strength is that of all its segments, and of no other joint.
    lost = figures[bend].lost
    ob.turgor.joints[bend].mute = True
    bpy.context.view_layer.update()
    muted = _frame_of(ob, runtime).report
    kept = (whole.target_volumes.sum() - muted.target_volumes.sum()) * percent
    assert kept == pytest.approx(lost, abs=1e-9)


def test_settings_of_a_bend_follow_its_renamed_bone_and_mirror(runtime):
    names = importlib.import_module("addon.properties.joint_names")
    ob, armature = _bendy_tube()
    add_turgor(ob)
    ob.turgor.joints[names.bend_of("Bone1")].strength = 0.25
    ob.turgor.joints["Bone1"].strength = 0.5
    armature.data.bones["Bone1"].name = "Upper.L"
    bpy.context.view_layer.update()
    positions(ob)
    assert ob.turgor.joints[names.bend_of("Upper.L")].strength == 0.25
    assert ob.turgor.joints["Upper.L"].strength == 0.5
    armature.data.bones["Bone2"].name = "Upper.R"
    bpy.context.view_layer.update()
    positions(ob)
    edits = importlib.import_module("addon.live.joint_edits")
    ob.turgor.active_joint = ob.turgor.joints.find(names.bend_of("Upper.L"))
    assert edits.mirror(ob) == (1, [])
    assert ob.turgor.joints[names.bend_of("Upper.R")].strength == 0.25
    assert ob.turgor.joints["Upper.R"].strength == 1.0


def test_other_segments_are_bound_anew_and_settings_of_bends_come_back(runtime):
    names = importlib.import_module("addon.properties.joint_names")
    ob, armature = _bendy_tube()
    _random_pose(armature, np.random.default_rng(5))
    add_turgor(ob)
    ob.turgor.joints[names.bend_of("Bone1")].size = 1.5
    for segments in (1, 9):
        for bone in armature.data.bones:
            bone.bbone_segments = segments
        _check(ob, runtime)
    assert ob.turgor.joints[names.bend_of("Bone1")].size == 1.5


def _refusal(ob, capfd) -> str:
    """What is told when Turgor Volume cannot be added."""
    select([ob])
    assert bpy.ops.object.turgor_volume_add() == {"CANCELLED"}
    assert [modifier.type for modifier in ob.modifiers] == ["ARMATURE"]
    told = capfd.readouterr()
    return told.out + told.err


def test_too_many_segments_are_refused_with_their_number(runtime, monkeypatch, capfd):
    monkeypatch.setattr(importlib.import_module("addon.live.skin"), "MOST_ROWS", 20)
    ob, _ = _bendy_tube(segments=9)
    # 3 bones, 9 nodes more of each, and where the first two end.
    assert "32 bones and segments" in _refusal(ob, capfd)


def test_an_armature_that_deforms_by_nothing_is_told(runtime, capfd):
    ob, _ = _bendy_tube()
    ob.modifiers["Armature"].use_vertex_groups = False
    assert "turn on Vertex Groups" in _refusal(ob, capfd)


def test_ease_that_is_driven_moves_the_rest_of_curved_bones(runtime):
    """As Rigify drives it: on the armature's data, by a property of the pose."""
    armature = _bent_rest(3, np.random.default_rng(2))
    ob = place("Tube", tube_mesh(rings=41), armature)
    for bone in armature.data.bones:
        bone.bbone_segments, bone.bbone_curveinx = 7, 0.3
        driver = armature.data.driver_add(f'bones["{bone.name}"].bbone_easein').driver
        driver.type = "SUM"
        variable = driver.variables.new()
        variable.targets[0].id, variable.targets[0].data_path = armature, '["rubber"]'
    armature["rubber"] = 0.0
    stack_proof = importlib.import_module("addon.scene.stack_proof")
    bpy.context.view_layer.update()
    add_turgor(ob)
    assert len(runtime.character(ob.session_uid).binding.bones.bends.moving) == 3
    for rubber in (0.0, 1.0, 2.0):
        armature["rubber"] = rubber
        armature.update_tag()
        _random_pose(armature, np.random.default_rng(6))
        bpy.context.view_layer.update()
        # No bind comes of it.
        assert runtime.character(ob.session_uid).signature == stack_proof.signature(ob)
        _check(ob, runtime)


def test_segments_scaled_to_nothing_and_flat_armatures_are_told(runtime, route):
    ob, armature = _bendy_tube()
    add_turgor(ob)
    armature.data.bones["Bone1"].bbone_scalein = (0.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    assert _found(ob, runtime, "flat_segments") is not None
    armature.data.bones["Bone1"].bbone_scalein = (1.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    armature.scale.x = 0.0
    bpy.context.view_layer.update()
    ob.update_tag()
    bpy.context.view_layer.update()
    assert "scale" in runtime.character(ob.session_uid).problem
    armature.scale.x = 1.0
    ob.update_tag()
    _check(ob, runtime)
