"""Settings of joints, their curves, and what the panel reads."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import add_turgor, character

FRAME = 15
PRESETS = ("RUBBER", "MUSCLE", "FOLDS", "BELLY")


def _shown(ob: bpy.types.Object) -> np.ndarray:
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(FRAME)
    return positions(ob)


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_is_exact_and_looks_different(route, preset):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    isotropic = _shown(ob)
    ob.turgor.joints["Bone1"].preset = preset
    assert (_shown(ob) != isotropic).any()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_strength_of_the_modifier_is_the_part_that_shows(route):
    inputs = importlib.import_module("addon.scene.modifier_inputs")
    node_group = importlib.import_module("addon.scene.node_group")
    ob, _ = character()
    skinned = _shown(ob)
    add_turgor(ob)
    corrected = _shown(ob)
    assert (corrected != skinned).any()
    for strength in (0.0, 0.25, 1.0):
        inputs.write_input(ob.modifiers["Turgor Volume"], node_group.STRENGTH, strength)
        ob.update_tag()
        assert np.abs(_shown(ob) - (skinned + strength * (corrected - skinned))).max() < 1e-6
    assert (_shown(ob) == corrected).all()


@pytest.mark.parametrize("preset", PRESETS[:-1])
def test_custom_starts_from_the_preset_before(route, preset):
    ob, _ = character(rings=61)
    add_turgor(ob)
    plain = _shown(ob)
    joint = ob.turgor.joints["Bone1"]
    joint.preset = preset
    joint.use_auto_shares, joint.shares = False, (0.2, 0.3, 0.5)
    before = _shown(ob)
    joint.preset = "CUSTOM"
    after = _shown(ob)
    assert np.abs(after - before).max() < 0.1 * np.abs(before - plain).max() + 1e-3


def test_edited_curve_counts_and_is_saved(route, tmp_path):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    ob.turgor.joints["Bone1"].preset = "CUSTOM"
    before = _shown(ob)
    tree = ob.turgor.curves
    for name in ("curve_along", "curve_sideways", "curve_inside"):
        mapping = tree.nodes[getattr(ob.turgor.joints["Bone1"], name)].mapping
        assert mapping.extend == "HORIZONTAL"
        for point in mapping.curves[0].points:
            point.location.y = 0.2 if point.location.x < 0.4 else 0.0
        mapping.update()
    tree.update_tag()
    bpy.context.view_layer.update()
    edited = _shown(ob)
    assert (edited != before).any()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert (_shown(bpy.data.objects["Tube"]) == edited).all()


def test_figures_of_the_panel_follow_the_frame(route, runtime):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    # Under the law of flesh joints lose what is missing once it is followed.
    ob.turgor.flesh = 0.0
    bpy.context.scene.frame_set(FRAME)
    known = runtime.character(ob.session_uid)
    lost = sum(joint.lost for joint in known.figures.joints.values())
    assert abs(known.figures.corrected_deviation) < 1e-6
    assert known.figures.skinned_deviation == pytest.approx(-lost, rel=1e-3)
    assert known.figures.joints.keys() <= set(ob.turgor.joints.keys())
    assert known.timing.total > 0.0
    assert rest > 0.0


@pytest.mark.parametrize("breathing", [1.0, 1.3])
def test_figures_tell_what_a_weaker_joint_leaves_out(route, runtime, breathing):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    ob.turgor.target_volume = breathing
    ob.turgor.joints["Bone1"].strength = 0.4
    _shown(ob)
    figures = runtime.character(ob.session_uid).figures
    assert figures.corrected_deviation < -0.1
    assert figures.corrected_deviation == pytest.approx(100.0 * (volume(ob) / (rest * breathing) - 1.0), rel=1e-4)


def test_the_joint_that_loses_most_is_shown_first(runtime):
    ob, _ = character()
    bpy.context.scene.frame_set(FRAME)
    add_turgor(ob)
    lost = {name: abs(joint.lost) for name, joint in runtime.character(ob.session_uid).figures.joints.items()}
    assert ob.turgor.joints[ob.turgor.active_joint].name == max(lost, key=lambda name: lost[name])


@pytest.mark.parametrize("solver", ["SIMULTANEOUS", "SEQUENTIAL"])
def test_both_solvers_are_exact(route, solver):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    ob.turgor.solver = solver
    _shown(ob)
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_panels_draw(runtime):
    """Labels of the classes exist and their polls answer; a window draws them elsewhere."""
    ob, _ = character()
    add_turgor(ob)
    for name in ("TURGOR_PT_volume", "TURGOR_PT_settings"):
        assert getattr(bpy.types, name).poll(bpy.context)


def test_posing_binds_nothing_again(route, monkeypatch):
    ob, rig = character()
    add_turgor(ob)
    rig.animation_data_clear()
    bpy.context.view_layer.update()
    binds: list[bpy.types.Object] = []
    monkeypatch.setattr(importlib.import_module("addon.live.binding"), "bind", binds.append)
    for angle in (0.1, 0.2, 0.3):
        rig.pose.bones["Bone1"].rotation_euler.x = angle
        bpy.context.view_layer.update()
    assert not binds


def test_settings_are_read_by_the_numbers_that_their_names_have():
    """Enums are read as numbers, a whole list at once: each name must come back, and only blends have second sets."""
    read_settings = importlib.import_module("addon.scene.settings").read_settings
    blends = importlib.import_module("addon.properties.joint").BLEND_NAMES
    presets = importlib.import_module("addon.properties.profiles").PRESET_NAMES
    ob, _ = character()
    add_turgor(ob)
    joint = ob.turgor.joints[0]
    for name in blends:
        joint.blend_mode = name
        saved = read_settings(ob)
        assert blends[saved.joints.blend_modes[0]] == name
        assert (0 in saved.seconds) == (name != "NONE")
    for name in presets.values():
        joint.preset = name
        assert presets[read_settings(ob).joints.presets[0]] == name
    assert set(blends) == set(joint.bl_rna.properties["blend_mode"].enum_items.keys())
