"""Bendy bones, envelopes and Envelope Multiply: skinned as Blender does, with the exact volume, by names that last."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import positions, relative_error, volume
from tube import LENGTH, add_turgor, place, rig, set_strength, tube_mesh

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
